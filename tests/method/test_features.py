"""Features: of exact orbits, read off records, and as read off a plot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.features import (
    FEATURE_COLUMNS,
    Features,
    of_numbers,
    of_orbit,
    of_orbits,
    side_by_side,
    stack,
)
from dampbalance.model import BaseMotion, Oscillator
from dampbalance.motion.orbit import steady_orbit
from dampbalance.motion.orbits import steady_orbits
from dampbalance.replication.clean import of_record
from dampbalance.replication.read_out import ReadOut
from dampbalance.replication.record import SimulatedRecord
from dampbalance.replication.sampled import integral
from paper_case import FREQUENCIES_HZ, OMEGA, PAPER


def orbit(Y=0.008, osc=PAPER, omega=OMEGA):
    return steady_orbit(osc, BaseMotion(Y=Y, omega=omega))


def sampled(orbit, per_cycle, cycles=2.3, start=0.03):
    """An exact record of the orbit; per_cycle samples a cycle, not necessarily whole."""
    t = start + np.arange(int(cycles * per_cycle)) * orbit.motion.period / per_cycle
    state = orbit.state(t)
    return SimulatedRecord(t, orbit.motion.y(t), state.x, state.v, state.acceleration)


def worst(read, exact, *names):
    """Largest relative difference of the features named (all, if none is)."""
    return max(
        abs(getattr(read, name)[0] / getattr(exact, name)[0] - 1.0)
        for name in names or FEATURE_COLUMNS
    )


# ---- the table of features ------------------------------------------------------------------------------------------


def test_what_does_not_fit_together_is_refused():
    one = of_orbit(orbit())
    Y = np.arange(1.0, 7.0).reshape(3, 2)
    for refused, message in (
        (lambda: stack([]), "at least one"),
        (lambda: one.with_phase("peak"), "phase must be one of reversal, "),
        (lambda: one.replaced(X=[1.0, 2.0]), r"Features\.X has shape"),
        (lambda: of_numbers(20.0, list("abc"), Y=Y), r"Features\.regime has shape \(3,\), Y"),
        (lambda: one.replaced(X=["a"]), "Features.X must hold numbers"),
        (lambda: one.replaced(Z=1.0), r"unknown features \['Z'\]"),
        (lambda: Features.from_frame(one.to_frame().drop(columns="X_m")), r"the columns \['X_m'\]"),
        (lambda: Features.from_frame(one.to_frame().drop(columns="regime")), r"\['regime'\]"),
        (lambda: Features.from_frame(one.to_frame().iloc[:0]), "at least one"),
    ):
        with pytest.raises(ValueError, match=message):
            refused()


def test_responses_share_the_integrals_that_all_of_them_have():
    one, other = of_orbit(orbit()), of_orbit(orbit(0.004))
    one = replace(one, integrals={"eta": np.array([3.0]), "c_2": np.array([5.0])})
    other = replace(other, integrals={"eta": np.array([4.0])})
    for first, second in ((one, other), (other, one)):
        levels, cases = stack([first, second]), side_by_side([first, second])
        assert list(levels.integrals) == list(cases.integrals) == ["eta"]
        expected = [first.integrals["eta"][0], second.integrals["eta"][0]]
        assert levels.integrals["eta"].tolist() == expected
        assert cases.integrals["eta"].tolist() == [expected]


# ---- levels by cases ------------------------------------------------------------------------------------------------


@pytest.fixture
def by_case():
    """Three levels of four oscillators, (3, 4): the lowest level does not slip in the first two of them."""
    Y = np.array([[5e-4], [0.004], [0.012]]) * np.ones(4)
    F_k, omega = np.array([3.0, 2.0, 0.5, 1.28]), np.array([OMEGA, 20.0, 25.0, 40.0])
    orbits = steady_orbits(PAPER, F_k=F_k, Y=Y, omega=omega)
    return of_orbits(orbits, Y, omega), F_k


def test_features_of_orbits_are_theirs_and_frames_keep_every_bit(by_case):
    features, F_k = by_case
    for level, case in np.ndindex(3, 4):
        osc, omega = replace(PAPER, F_k=float(F_k[case])), float(features.omega[level, case])
        exact = orbit(features.Y[level, case], osc, omega)
        alone = of_orbit(exact)
        for name in ("X", "X_s", "V_s", "t_s", "phi", "a", "b", "W"):
            np.testing.assert_array_equal(getattr(alone, name)[0], getattr(exact, name), name)
        assert alone.X_r[0] == pytest.approx(-exact.X_s, rel=0, abs=0, nan_ok=True)
        for name in ("omega", *FEATURE_COLUMNS):
            found, expected = getattr(features, name)[level, case], getattr(alone, name)[0]
            assert found == pytest.approx(expected, rel=1e-15, nan_ok=True), name
        assert features.regime[level, case] == alone.regime[0] == str(exact.regime)
    lowest = [False, False, True, False]
    for name in ("X_s", "V_s", "t_s", "X_r", "V_r", "t_r"):
        assert np.isfinite(getattr(features, name)).tolist() == [lowest, [True] * 4, [True] * 4]
    one = features[:, 0]
    frame = one.to_frame()
    assert {"Y_m", "V_s_m_per_s", "t_s_s", "phi_rad", "b_m2_per_s", "W_J"} <= set(frame.columns)
    again = Features.from_frame(frame)
    for name in ("omega", *FEATURE_COLUMNS, "regime"):
        np.testing.assert_array_equal(getattr(again, name), getattr(one, name), name)


def test_what_has_fewer_axes_is_broadcast():
    """A frequency per case, a word for all, and the features that are not given: all in the shape of Y."""
    Y = np.arange(1.0, 7.0).reshape(3, 2)
    features = of_numbers([20.0, 30.0], "drawn", Y=Y, X=Y[:, :1], phi=1.5)
    assert features.omega.tolist() == [[20.0, 30.0]] * 3
    assert features.X.tolist() == [[1.0, 1.0], [3.0, 3.0], [5.0, 5.0]]
    assert features.regime.shape == features.t_s.shape == features.phi.shape == (3, 2)
    assert set(features.regime.ravel()) == {"drawn"}
    assert np.isnan(features.t_s).all()
    with pytest.raises(ValueError, match="read-only"):
        features.X[0, 0] = 1.0
    changed = features.replaced(t_s=0.1, phi=[1.0, 2.0])
    assert changed.t_s.tolist() == [[0.1, 0.1]] * 3
    assert changed.phi.tolist() == [[1.0, 2.0]] * 3


def test_an_index_is_that_of_arrays(by_case):
    features, _ = by_case
    assert features[[2, 0]].W.tolist() == [features.W[2].tolist(), features.W[0].tolist()]
    assert features[:, 1].X.tolist() == features.X[:, 1].tolist()
    assert features[:, 1].regime.tolist() == features.regime[:, 1].tolist()
    assert features[:, None].Y.shape == (3, 1, 4)
    cases = side_by_side([features[:, case] for case in range(4)])
    levels = stack([features[[level]] for level in range(3)])
    for name in ("omega", *FEATURE_COLUMNS, "regime"):
        for again in (cases, levels):
            np.testing.assert_array_equal(getattr(again, name), getattr(features, name), name)


def test_common_values_are_means_over_the_levels_that_have_them_case_by_case(by_case):
    features, _ = by_case
    common = features.with_common("phi", "t_s")
    for case in range(4):
        has = np.isfinite(features.t_s[:, case])
        assert common.phi[:, case] == pytest.approx(features.phi[:, case].mean(), rel=1e-15)
        mean = np.where(has, features.t_s[has, case].mean(), np.nan)
        assert common.t_s[:, case] == pytest.approx(mean, rel=1e-15, nan_ok=True)
    np.testing.assert_array_equal(common.phi_reversal, features.phi)
    for kind in ("reversal", "zero_crossing", "fundamental"):  # phases are chosen by name
        of_kind = getattr(features, f"phi_{kind}")
        np.testing.assert_array_equal(features.with_phase(kind).phi, of_kind)
    nowhere = features.replaced(t_s=np.where(np.arange(4) == 2, np.nan, features.t_s))
    assert np.isnan(nowhere.with_common("t_s").t_s[:, 2]).all()


# ---- reading records ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("Y", "frequency_hz"), [*zip((0.004, 0.012, 0.006), FREQUENCIES_HZ.values(), strict=True)]
)
def test_interpolated_reading_of_an_exact_record_is_exact(Y, frequency_hz):
    motion_orbit = orbit(Y, omega=2.0 * math.pi * frequency_hz)
    read = of_record(sampled(motion_orbit, 10000.3), motion_orbit.motion.omega, PAPER.k)
    # Fourth order in the step; the corner is 40 to 150 samples after the reversal and the least well read.
    assert worst(read, of_orbit(motion_orbit)) < 2e-7
    assert read.regime.tolist() == ["one slip onset per half cycle"]


def test_a_sample_at_the_reversal_itself_comes_after_it():
    """So that the interval between two samples that holds a reversal is one and the same for all that follows."""
    exact = orbit()
    t = exact.t_1 + np.arange(-7, 2300) * exact.motion.period / 1000
    state = exact.state(t)
    v = np.where(np.arange(t.size) % 500 == 7, 0.0, state.v)  # rounding of the exact zeros
    record = SimulatedRecord(t, exact.motion.y(t), state.x, v, state.acceleration)
    features = of_record(record, OMEGA, PAPER.k)
    # a thousandth of a cycle between samples, to the fourth power, and t_s is a hundredth of the cycle
    assert worst(features, of_orbit(exact), "X", "X_s", "t_s", "phi_reversal") < 1e-4


def test_sample_reading_is_the_first_sample_at_or_after_the_event():
    exact, record = orbit(), sampled(orbit(), 4000.3)
    read = of_record(record, OMEGA, PAPER.k, reading="sample")
    h = record.dt
    late_1 = (read.phi[0] - exact.phi) / OMEGA
    assert 0.0 <= late_1 < h
    # The break shows largest at the sample nearest to it: the onset is read half a step early to half a step late, and
    # 1 % more, as the acceleration is curved.
    assert abs(read.t_s[0] + late_1 - exact.t_s) <= 0.5 * h * 1.01
    assert abs(read.X_s[0] - exact.X_s) <= 0.51 * h * exact.V_s
    assert worst(read, of_orbit(exact), "X", "b", "W") < 1e-6  # flat at the reversal: (h ω)² / 2
    # a starts a sample after the break: up to a step and a half late, 2 V_s for each
    assert -3.1 * h * exact.V_s < read.a[0] - exact.a < 0.0


def test_phases_count_from_the_base_motion_whatever_its_own_phase():
    record = sampled(orbit(), 5000.3)
    shifted = replace(record, t=record.t - 0.0123)
    read, moved = (of_record(r, OMEGA, PAPER.k) for r in (record, shifted))
    for name in ("phi_reversal", "phi_zero_crossing", "phi_fundamental", "Y"):
        assert getattr(moved, name)[0] == pytest.approx(getattr(read, name)[0], rel=1e-10), name


def test_lock_in_uses_all_whole_cycles():
    def off(cycles):
        record = sampled(orbit(), 2000.3, cycles=cycles)
        x = record.x + 1e-5 * np.cos(0.5 * OMEGA * record.t)  # which two cycles average out
        read = of_record(replace(record, x=x), OMEGA, PAPER.k)
        return abs(read.X_1[0] - orbit().harmonic(1)[0])

    assert off(2.2) > 1e-7
    # Three whole cycles after the first reversal, or two: an odd number leaves a third of what one leaves.
    assert off(4.4) < 0.5 * off(2.2)


@pytest.mark.parametrize(
    ("F_k", "Y", "reading"), [(1.28, 1e-5, "sample"), (0.0, 0.008, "interpolated")]
)
def test_a_record_without_a_corner_has_no_slip_onset(F_k, Y, reading):
    osc = replace(PAPER, F_k=F_k)  # the first never slips
    exact = orbit(Y, osc)
    read = of_record(sampled(exact, 4000.3), OMEGA, osc.k, reading=reading)
    assert read.regime.tolist() == ["no slip onset: the acceleration has no corner"]
    for name in ("X_s", "V_s", "t_s", "X_r", "V_r", "t_r", "a"):
        assert np.isnan(getattr(read, name)[0]), name
    assert worst(read, of_orbit(exact), "Y", "X", "b", "X_1") < 1e-6  # (h ω)² / 2 for "sample"
    # Whole steps leave out up to half a step of k y v at the reversal, where v < h ẍ: of the work, a part up to
    # (h ω)² / (2π sin φ); the mass that only sticks has sin φ = 0.013.
    assert worst(read, of_orbit(exact), "W") < 3e-5
    assert abs(read.phi[0] - exact.phi) < 1.01 * 2.0 * math.pi / 4000.3  # one step


def test_a_response_with_several_reversals_has_no_single_onset():
    osc = Oscillator(m=2.0, c=3.6, k=2000.0, K_z=5660.0, F_k=1.0)
    exact = orbit(7.3e-4, osc, omega=0.5 * osc.omega_n)
    assert "several" in of_orbit(exact).regime[0]
    read = of_record(sampled(exact, 20000.3), exact.motion.omega, osc.k)
    assert "the velocity reverses 6 times a cycle" in read.regime[0]
    assert np.isnan(read.X_s[0])
    assert worst(read, of_orbit(exact), "X", "b", "W") < 1e-6  # X is that of a sample: (h ω)² / 2


def test_records_that_cannot_be_read_are_refused():
    record = sampled(orbit(), 1000.0)
    for one, omega, reading, message in (
        (sampled(orbit(), 1000.0, cycles=0.9), OMEGA, "interpolated", "no whole cycle"),
        (replace(record, y=0.0 * record.y), OMEGA, "interpolated", "y has no fundamental"),
        (record, OMEGA, "by eye", "reading must be one of"),
        (record, 0.0, "interpolated", "omega must be positive"),
    ):
        with pytest.raises(ValueError, match=message):
            of_record(one, omega, PAPER.k, reading=reading)


# ---- integrals ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("start", "stop"),
    [(0, 40), (0, 39), (3.3, 36.8), (2, 4), (3.3, 3.9), (2.7, 3.2)],
)
def test_integral_is_exact_for_cubics(start, stop):
    t = np.arange(41.0)
    f = 1.0 + t - 0.3 * t**2 + 0.01 * t**3

    def primitive(s):
        return s + s**2 / 2 - 0.1 * s**3 + 0.0025 * s**4

    exact = primitive(stop) - primitive(start)
    # an odd number of intervals: the last rule is exact for quadratics only
    odd = (math.floor(stop) - math.ceil(start)) % 2
    assert integral(f, 1.0, start, stop) == pytest.approx(exact, rel=1e-4 if odd else 1e-12)
    doubled = integral(f + 2j * f, 0.5, start, stop).imag
    assert doubled == pytest.approx(integral(f, 1.0, start, stop), rel=1e-12)
    with pytest.raises(ValueError, match="leaves the samples"):
        integral(f, 1.0, start, 40.5)


# ---- reading off a plot ---------------------------------------------------------------------------------------------


EXACT = {
    "X": 0.0060473738, "phi": 1.5462469, "X_1": 0.0060312345, "X_3": 5.5512e-5, "X_5": 1.2345e-5,
    "X_s": -0.0060350661, "V_s": 0.0117259, "t_s": 2.0333e-3, "phi_fundamental": 1.5724689,
    "X_r": 0.0060350661, "V_r": -0.0117259, "t_r": 2.0333e-3,
}  # fmt: skip
READ = [
    ({}, EXACT),
    ({"X_decimals": 6, "X_s_decimals": 6}, EXACT | {"X": 0.006047, "X_s": -0.006035, "X_r": 0.006035}),
    # 12.3 marks: 13 below 0.006047; a whole mark is that mark
    ({"X_decimals": 6, "X_s_mark": 1e-6}, {"X_s": -0.006034, "X_r": 0.006034}),
    ({"V_s_decimals": 4}, EXACT | {"V_s": 0.0117, "V_r": -0.0117}),
    ({"phi_decimals": 2}, EXACT | {"phi": 1.55, "phi_fundamental": 1.57}),
    ({"X_n_decimals": 5}, EXACT | {"X_1": 0.00603, "X_3": 6e-5, "X_5": 1e-5}),
    ({"t_s_unit": 1e-4}, EXACT | {"t_s": 2.0e-3, "t_r": 2.0e-3}),
    ({"t_s_inset": 4e-5, "t_s_unit": 1e-4}, {"t_s": 1.9e-3}),
]  # fmt: skip


@pytest.mark.parametrize(("rules", "read"), READ)
def test_each_rule_reads_its_features_and_no_other(rules, read):
    found = ReadOut(**rules).apply(of_numbers(OMEGA, "one slip onset per half cycle", **EXACT))
    assert {name: getattr(found, name)[0] for name in read} == pytest.approx(read, rel=1e-12)


def test_common_values_are_read_first_and_rounded_last():
    read = ((1.51, 2.96e-3), (1.53, 2.47e-3), (1.55, 1.99e-3))
    features = stack([of_numbers(OMEGA, "", phi=phi, t_s=t_s) for phi, t_s in read])
    common = ReadOut(t_s_unit=1e-4, common_phi_decimals=1, common_t_s_decimals=4).common(features)
    assert common.phi == pytest.approx([1.5] * 3, rel=1e-15)
    # (2.9 + 2.4 + 1.9)/3, not (2.96 + 2.47 + 1.99)/3
    assert common.t_s == pytest.approx([2.4e-3] * 3, rel=1e-12)


SENSELESS = {
    "ReadOut.X_decimals must not be negative": {"X_decimals": -1},
    "ReadOut.t_s_unit must be positive": {"t_s_unit": 0.0},
    "not both": {"X_s_mark": 1e-6, "X_s_decimals": 6},
}


@pytest.mark.parametrize("message", SENSELESS)
def test_rules_that_make_no_sense_are_refused(message):
    with pytest.raises(ValueError, match=message):
        ReadOut(**SENSELESS[message])
