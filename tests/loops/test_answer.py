"""Answers to measured loops: numbers, words, and what is not determined."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify, identify_loops, steady_orbit
from folders import ROOT
from loops.test_fit import F_K, K_Z, SINE, TRIANGLE, C, T, X, loop

DATA = ROOT.parent / "shared/data/loops"


def table(x=SINE, **more):
    return {"time_s": T, "displacement_m": x, "force_N": loop(x, **more).f}


def test_loops_are_recognised_by_force_and_displacement_without_a_stiffness():
    found = identify(table())
    assert found.options["kind"] == "loops"
    assert found.verdicts["F_k"].verdict == found.verdicts["K_z"].verdict == "usable"
    for symbol, true in {"F_k": F_K, "c": C, "K_z": K_Z}.items():
        low, high = found.intervals[symbol]
        assert low < true < high, symbol


def test_a_stiffness_is_refused_with_the_remedy():
    with pytest.raises(ValueError, match="leave it out, a spring in parallel"):
        identify_loops(table(), 2310.0)


def test_the_friction_coefficient_has_the_uncertainties_of_both_forces():
    mu, (low, high) = identify_loops(table(), normal_force=(20.0, 1.0)).friction_coefficient
    assert mu == pytest.approx(0.5, rel=0.01)
    assert 0.5 * (high - low) == pytest.approx(1.96 * 0.5 / 20.0, rel=0.05)  # that of N dominates


def test_a_fixture_in_series_makes_the_contact_look_softer():
    stiff = identify_loops(table(c=0.0), fixture_stiffness=2e5)
    # springs in series: 1/K_z + 1/k_s of the fixture is what the loop shows; the spring k adds 1 %
    assert 1.0 / (1.0 / stiff.values["K_z"] + 1.0 / 2e5) == pytest.approx(K_Z, rel=0.03)


def test_what_is_not_determined_is_said():
    found = identify_loops(table(TRIANGLE))
    assert math.isnan(found.values["c"])
    assert "c is not determined, and F_k includes c times this speed" in found.text()
    stuck = identify_loops(table(0.15 * SINE, noise=1e-3))
    assert "does not slip in these loops: raise the amplitude" in stuck.no_answer


def test_the_contact_goes_into_a_response():
    found = identify_loops(table())
    of = [
        steady_orbit(Oscillator(m=2.0, k=2310.0, **law), BaseMotion(Y=0.01, omega=30.0)).X
        for law in (found.law, {"F_k": F_K, "K_z": K_Z, "c": C})
    ]
    assert of[0] == pytest.approx(of[1], rel=0.01)  # as F_k is within 1 %


def test_the_history_follows_a_friction_force_that_falls():
    worn = table(c=0.0)
    fall = 1.0 - 0.2 * T / T[-1]
    worn["force_N"] = worn["force_N"] * fall
    F = identify_loops(worn).history()["F_k_N"]
    assert F.iloc[-1] / F.iloc[0] == pytest.approx(0.81 / 0.985, rel=0.02)  # middles of the cycles


def test_another_shape_is_doubtful_and_not_silent():
    odd = table(c=0.0)
    odd["force_N"] = odd["force_N"] * np.where(odd["force_N"] > 0.0, 1.6, 1.0)
    odd["force_N"] += 4.0 * np.sin(14.0 * np.pi * T)
    found = identify_loops(odd)
    assert found.verdicts["F_k"].verdict == "doubtful"


def test_a_friction_that_falls_with_the_speed_is_doubtful():
    v = np.gradient(SINE, T)
    force = np.zeros(T.size)
    for i in range(1, T.size):  # 40 % more at rest than at speed
        top = F_K * (1.0 + 0.4 * math.exp(-((v[i] / (0.3 * np.abs(v).max())) ** 2)))
        force[i] = min(max(force[i - 1] + K_Z * (SINE[i] - SINE[i - 1]), -top), top)
    noisy = force + 0.01 * F_K * np.random.default_rng(3).normal(size=T.size)
    found = identify_loops({"time_s": T, "displacement_m": SINE, "force_N": noisy})
    assert found.verdicts["F_k"].verdict == "doubtful"
    assert "larger than at speed" in found.text()


def test_report_and_pictures_are_written(tmp_path):
    found = identify_loops(table())
    written = {path.name for path in found.save(tmp_path)}
    assert {"loops.png", "history.svg", "report.html", "identification.json"} <= written
    assert found.document()["history"]["X_m"][0] == pytest.approx(X, rel=1e-3)


@pytest.mark.skipif(not DATA.is_dir(), reason="the measured loops lie outside of the project")
def test_measured_loops_agree_with_readings_by_hand():
    """The README of the data: K_z 42.2 kN/m by the slope, 39 by the loss, F_k 2.3 to 2.5 N; a dead band of 5 mm."""
    raw = np.loadtxt(DATA / "tribometer.txt", skiprows=1)
    t = raw[0, 0] + 0.005 * np.arange(len(raw))
    wear = {"time_s": t, "displacement_mm": raw[:, 2], "force_N": 1e-6 * raw[:, 3]}
    found = identify_loops(wear, normal_force=5.0)
    assert 39e3 < found.values["K_z"] < 42.2e3
    assert 2.2 < found.values["F_k"] < 2.4
    assert "has the other sign" in found.text()
    dampers = [str(DATA / f"damper_{name}in.csv") for name in ("0_5", "1", "1_5")]
    damper = identify_loops(dampers)
    assert 4e-3 < damper.answer.merit["gap_m"] < 5.5e-3
    assert 14e3 < damper.values["F_k"] < 17e3
    assert damper.verdicts["F_k"].verdict == "doubtful"


def test_the_history_has_no_friction_for_a_cycle_between_two_levels():
    t = np.arange(0.0, 40.0, 0.005)
    x = np.where(t < 20.0, 0.0005, 0.0015) * np.sin(np.pi * t)
    z, K_z, F_k = 0.0, 2e5, 12.0
    f = []
    for step in np.diff(x, prepend=0.0):
        z = min(max(z + step, -F_k / K_z), F_k / K_z)
        f.append(K_z * z)
    history = identify_loops({"time_s": t, "displacement_m": x, "force_N": np.array(f)}).history()
    known = history["F_k_N"].dropna()
    assert history["F_k_N"].isna().sum() == 1  # where the level steps
    np.testing.assert_allclose(known, F_k, rtol=0.01)  # samples do not meet the reversals
