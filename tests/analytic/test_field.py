"""The sets of records as laboratories have them: motion against closed forms and other integrators, each imperfection
in what it does to force or signal, and the simple analysis and the score on values worked out by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from blind import field, field_score
from blind.cycles import steady_cycle
from blind.other_motion import ring_down
from blind.truths import ANSWERS

SEED = 11
# Kinks cost 6e-6 of the displacement and 5e-5 of the acceleration with 2048 steps a period, measured against 8192.
MOTION, ACCELERATION = 2e-5, 2e-4


def of_kind(kind: str, forced: bool = False, turn: int = 0) -> field.Field:
    """A set of a kind; forced ones are damped more, so that they settle in 40 cycles."""
    kinds = field.FORCED if forced else field.DECAYS
    one = field.draw(kinds.index(kind) + turn * len(kinds), forced, SEED)
    assert one.kind == kind
    return replace(one, c=2.0 * 0.04 * math.sqrt(one.k * one.m)) if forced else one


def signals(one: field.Field, level: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times since the release or phase 0 of the drive, (x, x′, x″) from the release on, and what the sensor adds."""
    t, moved = field.motion(one, level)
    added = field.sensed(one, t, moved, level) - moved[ANSWERS.index(one.answer)]
    after = t > -1e-12
    return t[after], moved[:, after], added[after]


def contact_force(one: field.Field) -> np.ndarray:
    """Force of the contact over F_k, from the equation of motion of a mass on a rigid frame."""
    t, (x, v, a), _ = signals(one)
    Y = one.Y[0] if one.forced else 0.0
    return (one.k * (Y * np.cos(one.omega * t) - x) - one.c * v - one.m * a) / one.F_k


def amplitude(t: np.ndarray, values: np.ndarray, omega: float) -> complex:
    """Complex amplitude of a line, by least squares."""
    columns = [np.cos(omega * t), np.sin(omega * t), np.ones(t.size)]
    a, b, _ = np.linalg.lstsq(np.column_stack(columns), values, rcond=None)[0]
    return complex(a, -b)


def test_without_a_contact_a_decay_is_the_closed_form():
    one = replace(of_kind(field.CLEAN), K_z=0.0, F_k=0.0, blow=False, X=0.003)
    t, (x, v, _), _ = signals(one)
    delta = one.c / (2.0 * one.m)
    damped = math.sqrt(one.omega_n**2 - delta**2)
    decays = one.X * np.exp(-delta * t)
    exact = decays * (np.cos(damped * t) + delta / damped * np.sin(damped * t))
    # Runge and Kutta of order 4, (2π/2048)⁴ = 1e-10 a radian
    assert np.abs(x - exact).max() < 1e-8 * one.X
    speed = -decays * one.omega_n**2 / damped * np.sin(damped * t)
    assert np.abs(v - speed).max() < 1e-8 * one.X * one.omega_n


def test_a_clean_decay_is_that_of_another_integrator():
    one = replace(of_kind(field.CLEAN), blow=False)
    t, moved, _ = signals(one)
    z = math.copysign(one.F_k / one.K_z, one.X)
    other = ring_down(one, one.X, t[1] - t[0], t[-1] + t[1], z=z)[:, : t.size]
    scale = np.abs(other).max(axis=1)
    assert (np.abs(moved - other).max(axis=1) < [MOTION, MOTION, ACCELERATION] * scale).all()


def test_a_clean_forced_motion_is_the_steady_cycle():
    one = of_kind(field.CLEAN, forced=True)
    t, moved, _ = signals(one)
    Y = one.Y[0]
    numbers = (one.zeta, one.omega / one.omega_n, one.K_z / one.k, one.F_k / (one.k * Y))
    exact = steady_cycle(*numbers).state(one.omega * t) * (Y * one.omega_n ** np.arange(3))[:, None]
    scale = np.abs(exact).max(axis=1)
    late = t > t[0] + 20.0 * 2.0 * math.pi / one.omega  # where the record begins
    errors = np.abs(moved - exact)[:, late].max(axis=1)
    # of the transient e^(−2π (1.5 + 20 · 0.04/1.6)) = 4e-6 is left besides
    assert (errors < [MOTION, MOTION, ACCELERATION] * scale).all()


@pytest.mark.parametrize("forced", [False, True])
def test_the_contact_force_shows_what_departs(forced):
    force = contact_force(of_kind(field.CLEAN, forced))
    assert np.abs([force.max() - 1.0, force.min() + 1.0]).max() < 1e-6
    force = contact_force(of_kind(field.ASYMMETRY, forced))
    assert force.max() - force.min() == pytest.approx(2.0, abs=1e-6)
    assert 0.02 <= abs(force.max() + force.min()) / 2.0 <= 0.1
    force = contact_force(of_kind(field.STRIBECK, forced))
    assert 1.01 < np.abs(force).max() <= 1.3
    for turn in (0, 1, 2):
        force = contact_force(of_kind(field.MODULATED, forced, turn))
        assert 1.001 < np.abs(force).max() < 1.11
    # a gradual contact takes its whole force only far from the last reversal, and none of it at once
    assert 0.5 < np.abs(contact_force(of_kind(field.GRADUAL, forced))).max() < 1.0 + 1e-6
    one = of_kind(field.CUBIC, forced)
    _, (x, _, _), _ = signals(one)
    k_3 = field.rig_of(one)[0].k_3
    assert 0.01 <= abs(k_3) * one.X**2 / one.k <= 0.05
    rest = contact_force(one) - k_3 * x**3 / one.F_k
    assert np.abs([rest.max() - 1.0, rest.min() + 1.0]).max() < 1e-6


def test_a_frame_that_yields_lowers_the_frequency_to_that_of_the_stiffness_given():
    one = replace(of_kind(field.SUPPORT), blow=False, F_k=0.0, K_z=0.0)
    t, (x, _, _), _ = signals(one)
    k = field.stiffness_given(one)
    assert 0.01 < one.k / k - 1.0 < 0.051
    lines = np.linspace(0.9, 1.02, 481) * one.omega_n
    window = np.hanning(t.size)
    heights = [abs(np.sum(window * x * np.exp(-1j * omega * t))) for omega in lines]
    # mass of the frame: it adds (k/k_s)² m_s/m, at most (k/k_s)/(2 · 9) = 0.003, besides a line of 2.5e-4
    assert lines[np.argmax(heights)] == pytest.approx(math.sqrt(k / one.m), rel=4e-3)


@pytest.mark.parametrize("forced", [False, True])
def test_what_sensor_and_amplifier_add_has_the_size_stated(forced):
    def added(kind: str, turn: int = 0) -> tuple[field.Field, np.ndarray, np.ndarray, np.ndarray]:
        one = of_kind(kind, forced, turn)
        t, moved, extra = signals(one)
        clean = moved[ANSWERS.index(one.answer)]
        peak = np.abs(clean).max()
        return one, t, clean / peak, extra / peak

    _, _, _, extra = added(field.CLEAN)
    assert not extra.any()
    _, t, _, extra = added(field.HUM)
    lines = [abs(amplitude(t, extra, 2.0 * math.pi * hertz)) for hertz in (50.0, 100.0, 150.0)]
    assert 0.0009 < lines[0] < 0.011
    assert lines[1] < lines[2] < lines[0]
    _, t, _, extra = added(field.DRIFT)
    assert 0.0199 < abs(extra[0]) < 0.16
    assert 0.001 < abs(extra[-1] - extra[0]) < 0.05
    assert np.abs(np.diff(extra, 2)).max() < 1e-4  # slow
    for turn in (0, 1, 2):
        one, t, _, extra = added(field.MODE, turn)
        assert 0.008 < np.abs(extra).max() < 0.051
        window = np.hanning(t.size)
        spectrum = np.abs(np.fft.rfft(window * extra, 4 * t.size))
        omega = 2.0 * math.pi * np.argmax(spectrum) / (4 * t.size * (t[1] - t[0]))
        assert 3.8 < omega / one.omega < 9.2  # a line of the spectrum is up to 0.1 wide
    one, _, clean, extra = added(field.THIRD)
    ratio = extra[np.abs(clean) > 0.1] / clean[np.abs(clean) > 0.1] ** 3
    assert np.ptp(ratio) < 1e-9
    assert 0.008 <= ratio[0] <= 0.04


def test_a_coupling_and_a_filter_turn_the_fundamental_as_their_responses_do():
    one = of_kind(field.AC, forced=True)
    t, moved, added = signals(one)
    late = t > t[0] + 20.0 * 2.0 * math.pi / one.omega
    clean = moved[ANSWERS.index(one.answer)]
    response = amplitude(t[late], (clean + added)[late], one.omega)
    response /= amplitude(t[late], clean[late], one.omega)
    corner = math.tan(np.angle(response))  # 1/(1 − i f_c/f)
    assert 0.019 < corner < 0.151
    assert abs(response) == pytest.approx(1.0 / math.hypot(1.0, corner), rel=1e-3)
    one = of_kind(field.FILTER, forced=True)
    t, moved, added = signals(one)
    clean = moved[ANSWERS.index(one.answer)]
    response = amplitude(t, clean + added, one.omega) / amplitude(t, clean, one.omega)
    delay = -np.angle(response) / one.omega * one.rate_hz
    # Butterworth of order 4 to 8: Σ sin of the poles' angles, 2.61 to 5.13, over the corner, in samples
    assert 2.61 / (2.0 * math.pi * 0.45) * 0.9 < delay < 5.13 / (2.0 * math.pi * 0.3) * 1.1
    assert abs(response) == pytest.approx(1.0, abs=1e-2)


def test_converter_and_range():
    (record,) = field.records(of_kind(field.BITS))
    values = np.unique(record.responses[0].values)
    codes = values / np.diff(values).min()
    assert np.abs(codes - np.round(codes)).max() < 1e-6
    assert 2**11 / 4.1 < np.abs(codes).max() < 2**11 / 1.2
    (record,) = field.records(of_kind(field.CLIPPED))
    values = np.abs(record.responses[0].values)
    assert np.count_nonzero(values == values.max()) > 3
    (record,) = field.records(of_kind(field.CLEAN))
    values = np.abs(record.responses[0].values)
    assert np.count_nonzero(values == values.max()) == 1


def test_how_records_begin():
    t, (_, v, _), _ = signals(of_kind(field.DOUBLE))
    one = of_kind(field.DOUBLE)
    jumps = np.abs(np.diff(v)) / (abs(one.X) * one.omega_n)
    assert np.count_nonzero(jumps > 0.15) == 1
    assert 0.2 < jumps.max() < 0.65
    one = of_kind(field.LEAD)
    t, (x, v, _) = field.motion(one)
    resting = t < t[0] + 0.5 * 2.0 * math.pi / one.omega
    assert not x[resting].any()
    assert not v[resting].any()
    one = of_kind(field.UNSETTLED, forced=True)
    heights = []
    for measured in field.records(one):
        channel = measured.responses[0]
        cycle = round(one.rate_hz * 2.0 * math.pi / one.omega)
        heights.append(np.ptp(channel.values[:cycle]) / np.ptp(channel.values[-cycle:]))
    assert max(abs(height - 1.0) for height in heights) > 0.05


def test_sets_are_drawn_in_turn_and_again_alike():
    kinds = [field.kind_of(i, False) for i in range(200)]
    assert {kinds.count(kind) for kind in field.DECAYS[1:]} == {10}
    assert kinds.count(field.CLEAN) == 20
    kinds = [field.kind_of(i, True) for i in range(180)]
    assert {kinds.count(kind) for kind in field.FORCED} == {10}
    one, other = (field.records(field.draw(5, False, SEED))[0].responses[0] for _ in range(2))
    assert np.array_equal(one.values, other.values)
    assert field.draw(5, False, SEED + 1) != field.draw(5, False, SEED)
    ratio = field.stiffness_given(of_kind(field.STIFFNESS)) / of_kind(field.STIFFNESS).k
    assert abs(ratio - 1.0) == pytest.approx(0.03)


def test_the_simple_analysis_is_right_on_clean_records():
    right = 0
    for index in range(190, 200):
        one = field.draw(index, False, SEED)
        # twenty half cycles of a displacement: fewer leave no line to fit beside the edge of the filter
        left = math.exp(-math.pi * 20.0 * 0.01)
        F_k = one.k * abs(one.X) * left / (1.0 + 2.0 * (1.0 - left) / (math.pi * 0.01))
        c = 2.0 * 0.01 * math.sqrt(one.k * one.m)
        one = replace(one, F_k=F_k, c=c, answer="displacement", cycles=(13.0,), noise=0.001)
        F_k, c = field_score.simple_decay(field.records(one)[0], one.k, None)
        right += abs(F_k / one.F_k - 1.0) < 0.1 and abs(c / one.c - 1.0) < 0.1
    assert right == 10
    for turn in (3, 8):  # soon steady: ζ above 2 %, at resonance
        one = field.draw(turn * len(field.FORCED), True, SEED)
        numbers = field_score.simple_forced(field.records(one), one.k, one.omega)
        assert numbers == pytest.approx((one.F_k, one.c), rel=0.1)


def test_the_score_counts_as_its_definition_says():
    usable, doubtful = {f"{s}_verdict": "usable" for s in ("F_k", "c")}, {"F_k_verdict": "usable"}
    doubtful["c_verdict"] = "doubtful"
    near = {f"{s}_off": 0.05 for s in ("F_k", "c")} | {"F_k_low": 2.0, "F_k_high": 3.0}
    far = {"F_k_off": 0.05, "c_off": 0.5, "F_k_low": 2.0, "F_k_high": 3.0}
    simple = {f"{s}_simple": 0.09 for s in ("F_k", "c")}
    not_simple = {"F_k_simple": 0.09, "c_simple": math.nan}
    around, beside = {"c_low": 0.5, "c_high": 1.6}, {"c_low": 1.4, "c_high": 1.6}
    cases = {
        "helps": usable | near | beside | not_simple,
        "helps by its interval": usable | far | around | not_simple,
        "silent": usable | far | beside | not_simple,
        "silent and lost": usable | far | beside | simple,
        "doubtful": doubtful | near | beside | simple,
        "refused": {"refused": "no decay"} | simple,
    }
    common = {"records": "decays", "F_k_true": 1.0, "c_true": 1.0, "seconds": 0.5, "refused": ""}
    rows = pd.DataFrame([common | {"kind": name} | case for name, case in cases.items()])
    lines = field_score.table(rows).splitlines()
    counts = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if "|" in line]
    head = ["decays", "sets", "helps", "no help, simple right", "silent", "refused"]
    assert counts[0] == [*head, "simple right", "lost"]
    assert {row[0]: "".join(row[1:]) for row in counts[2:]} == {
        "helps": "1100000",
        "helps by its interval": "1100000",
        "silent": "1001000",
        "silent and lost": "1001011",
        "doubtful": "1010011",
        "refused": "1010111",
        "all": "6222133",
    }
