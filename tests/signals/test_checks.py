"""Each check on numbers for which the answer is known: just inside its border, and just outside."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.findings.finding import Finding
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from dampbalance.signals import checks
from dampbalance.signals.cycles import CycleHarmonics

OMEGA = 2.0 * math.pi * 5.0
EQUAL = np.ones(9)


def channel(fundamental, *, weights=None, span=1.0, clipped=0.0, bad=()):
    """Rows of one cycle each with these fundamentals."""
    rows = np.zeros((len(fundamental), 2), dtype=np.complex128)
    rows[:, 1] = fundamental
    weights = np.ones(len(fundamental)) if weights is None else weights
    drift = np.zeros((2, 2), dtype=np.complex128)
    return CycleHarmonics(OMEGA, 0.0, 1e-3, rows, 1, weights, drift, bad, span, clipped)


def on_cycles(harmonics, weights=None):
    """The findings on a record of one channel."""
    weights = harmonics.weights if weights is None else np.array(weights)
    return list(checks.checked_cycles({"x": harmonics}, weights, OMEGA, TRANSLATION))


# ±1 about the mean: its standard error is 1/√16, five of them 1.25
TURNS = np.tile([1.0, -1.0], 8)


def test_a_channel_must_vary_and_oscillate():
    checks.require_signal("x", np.array([0.0, 1e-12]))
    with pytest.raises(ValueError, match=r"x is constant \(0\.25\): the transducer"):
        checks.require_signal("x", np.full(5, 0.25))
    with pytest.raises(ValueError, match="x is constant: the transducer"):
        on_cycles(channel(np.ones(10), span=0.0))
    assert on_cycles(channel(1.26 + TURNS)) == []
    with pytest.raises(ValueError, match=r"drive frequency of 5 Hz: amplitude 1\.24 ± 0\.25"):
        on_cycles(channel(1.24 + TURNS))
    # a row without usable cycles has no say
    silent = np.append(np.full(10, 2.0), math.nan)
    assert on_cycles(channel(silent, weights=np.append(np.ones(10), 0.0))) == []


def test_fewest_cycles_and_rows():
    (few,) = on_cycles(channel(np.ones(3)))
    assert (few.code, few.numbers["cycles"]) == ("few cycles", 3)
    for weights in ([1.0, 1.0, 0.0], [2.0, 2.0, 0.0]):
        with pytest.raises(ValueError, match="usable whole cycles of 5 Hz"):
            on_cycles(channel(np.ones(3)), weights)
    assert on_cycles(channel(np.ones(10))) == []
    assert [one.numbers["cycles"] for one in on_cycles(channel(np.ones(9)))] == [9]


@pytest.mark.parametrize(
    ("off", "error", "cycles", "differs"),
    [
        (19e-6, 0.0, 100, False),  # two sound clocks
        (21e-6, 0.0, 100, True),
        (-50e-6, 8e-6, 1000, True),
        (50e-6, 11e-6, 1000, False),  # not resolved
        # nor where 10 degrees of freedom know the error badly: 11 standard errors are needed
        (50e-6, 8e-6, 12, False),
        (50e-6, 4e-6, 12, True),
        (0.0055, 0.0, 3, True),
    ],
)
def test_a_frequency_that_differs_is_named(off, error, cycles, differs):
    found = list(checks.frequency(OMEGA * (1.0 + off), OMEGA * error, cycles, 5.0))
    assert len(found) == differs
    for one in found:
        assert one.numbers["off"] == pytest.approx(off)
        assert one.effect[""] == pytest.approx(abs(off))


def test_another_frequency_is_refused():
    assert list(checks.frequency(OMEGA, 0.0, 20, None)) == []
    assert len(list(checks.frequency(1.049 * OMEGA, 0.0, 20, 5.0))) == 1
    for factor in (1.051, 0.949):
        with pytest.raises(ValueError, match="wrong frequency, wrong column"):
            list(checks.frequency(factor * OMEGA, 0.0, 20, 5.0))
    for given in (0.0, -5.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="the drive frequency must be positive"):
            list(checks.frequency(OMEGA, 0.0, 20, given))


def test_cycles_left_out_are_counted():
    gap = (4, 0.8, Finding("gap"))
    for count in (1, 2):
        (one,) = on_cycles(channel(np.ones(10), bad=(gap,) * count))
        numbers = {"quantity": "x", "count": count, "first": 5, "time": 0.8, "why": gap[2]}
        assert one == Finding("spikes", numbers)


@pytest.mark.parametrize(("part", "warned"), [(0.49, False), (0.5, True), (1.0, True)])
def test_clipping_in_half_of_the_cycles(part, warned):
    found = on_cycles(channel(np.ones(10), clipped=part))
    assert [(one.code, one.numbers["cycles"]) for one in found] == [("clipped", part)] * warned


# --- consistency: nine cycles whose ratios scatter by ±d about their mean, so that its error is d/√16 ---------------

SCATTERED = 0.004 * math.sqrt(9.0 / 8.0)


def pair_of_responses(gain, phase, d=SCATTERED):
    """x, harmonics 0 … 3, and v as a displacement that is larger and later, scattering about that."""
    x = np.tile([0.0, 2.0, 0.3j, 0.1], (9, 1)).astype(np.complex128)
    n = np.arange(4)
    v = gain * x * np.exp(1j * n * phase)
    v[:, 1] += 2.0j * d * np.array([1.0, -1.0, 1.0, -1.0, 0.0, 1.0, -1.0, 1.0, -1.0])
    return {"x": x, "v": v}


@pytest.mark.parametrize(("off", "counts"), [(0.0048, False), (0.0053, True)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_skew_and_gain_count_from_five_standard_errors_on(off, counts, sign):
    late, larger = pair_of_responses(1.0, sign * off), pair_of_responses(1.0 + sign * off, 0.0)
    found = list(checks.consistency(late, EQUAL, OMEGA))
    assert len(found) == counts
    for one in found:
        assert one.numbers["lags"] == (sign < 0.0)
        assert one.numbers["by"] == pytest.approx(off / OMEGA)
    assert len(list(checks.consistency(larger, EQUAL, OMEGA))) == counts
    # harmonic n turns back n times as far
    for moved, factor in ((late, 1.0), (larger, 1.0 if counts else 1.0 + sign * off)):
        if moved is larger or counts:
            np.testing.assert_allclose(moved["v"][:, 2:], factor * moved["x"][:, 2:], rtol=2e-4)


def test_differences_too_small_to_matter_do_not_count_however_significant():
    for gain, phase, count in ((1.00009, 1.8e-5, 0), (1.00011, 0.0, 1), (1.0, 2.2e-5, 1)):
        words = checks.consistency(pair_of_responses(gain, phase, 0.0), EQUAL, OMEGA)
        assert len(list(words)) == count


@pytest.mark.parametrize(
    ("gain", "phase"), [(1.11, 0.0), (0.89, 0.0), (1.0, 0.51), (1.0, -0.51), (-1.0, 0.0)]
)
def test_signals_of_two_motions_are_refused(gain, phase):
    with pytest.raises(ValueError, match="v contradicts x: at the drive frequency"):
        list(checks.consistency(pair_of_responses(gain, phase), EQUAL, OMEGA))
    list(checks.consistency(pair_of_responses(1.09, 0.49), EQUAL, OMEGA))


# --- steadiness -----------------------------------------------------------------------------------------------------


def steadiness(Y, X, cycles_per_row=1):
    period = 2.0 * math.pi / OMEGA
    times = cycles_per_row * period * (0.5 + np.arange(len(Y)))
    return checks.steadiness(Y, X, times, np.ones(len(Y)), period)[1]


@pytest.mark.parametrize("which", ["the excitation", "the response"])
def test_steady_noise_rarely_looks_like_a_change(which, monkeypatch):
    """At the level of 10 % false alarms are 10 % at most, and, the level being cautious, not much fewer than 2 %."""
    monkeypatch.setattr(checks, "P_DRIFT", 0.1)
    monkeypatch.setattr(checks, "_SMALLEST_CHANGE", 0.0)
    rng = np.random.default_rng(7)
    alarms, runs, size = 0, 1000, 64
    for _ in range(runs):
        noise = 1e-3 * (rng.standard_normal(size) + 1j * rng.standard_normal(size))
        Y, X = np.ones(size) + 0j, np.full(size, 2j)
        Y, X = (Y + noise, X * (1.0 + noise)) if which == "the excitation" else (Y, X + noise)
        drive = which == "the excitation"
        alarms += any(one.numbers["drive"] == drive for one in steadiness(Y, X))
    # 1000 draws: one standard deviation is 1 % at 10 %
    assert 0.02 < alarms / runs < 0.12


def test_a_change_of_three_rows_cannot_be_told_and_of_four_it_can():
    Y = np.ones(4) + 0j
    X = np.array([1.0, 1.0, 1.05, 1.05]) + 0j
    assert steadiness(Y[1:], X[1:]) == []
    (one,) = steadiness(Y, X)
    assert not one.numbers["drive"]
    assert one.numbers["change"] == pytest.approx(0.049, abs=5e-4)


def test_a_change_of_a_tenth_is_refused():
    Y = np.ones(40) + 0j
    line = np.linspace(-0.5, 0.5, 40)
    (one,) = steadiness(Y, 1.0 + 0.095 * line + 0j)
    assert one.numbers["change"] == pytest.approx(0.095)
    with pytest.raises(ValueError, match="record again after the motion has settled"):
        steadiness(Y, 1.0 + 0.105 * line + 0j)


def test_a_response_that_follows_a_drive_which_hunts_is_averaged():
    """Near resonance it changes by more than a tenth, and is no transient."""
    hunts = 0.03 * np.sin(np.linspace(0.0, 5.0, 40))
    found = steadiness(1.0 + hunts + 0j, 1.0 + 4.0 * hunts + 0j)
    assert [one.numbers["drive"] for one in found] == [True, False]
    assert found[1].effect[""] > 0.05
    with pytest.raises(ValueError, match="the response is not steady"):
        steadiness(np.ones(40) + 0j, 1.0 + 4.0 * hunts + 0j)


def test_only_the_amplitude_of_the_excitation_may_not_change():
    turning = np.exp(1j * np.linspace(0.0, 3.0, 40))  # the drive is not quite at the ω assumed
    assert steadiness(turning, 2.0 * turning) == []
    (one,) = steadiness(np.ones(40) + 0j, np.exp(1e-2j * np.linspace(0.0, 1.0, 40)))
    assert one.numbers["phase"]
    assert one.numbers["turn"] == pytest.approx(0.005, abs=5e-5)


@pytest.mark.parametrize("cycles_per_row", [1, 4])
def test_it_says_when_the_motion_has_settled(cycles_per_row):
    rng = np.random.default_rng(3)
    X = 1.0 + 1e-6 * (rng.standard_normal(80) + 1j * rng.standard_normal(80))
    X[:5] += 0.01
    (one,) = steadiness(np.ones(80) + 0j, X, cycles_per_row)
    assert one.numbers["after"] == one.numbers["skip"] == 5 * cycles_per_row
    late = 1.0 + 0.01 * np.linspace(0.0, 1.0, 80) + 0j  # it never does
    assert steadiness(np.ones(80) + 0j, late)[0].numbers["skip"] == 0


# --- what amplitudes and harmonics say -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("Y", "X", "omega", "count"),
    [
        (0.004, 0.006, OMEGA, 0),
        (0.49, 0.49, 1.0, 0),
        (0.51, 0.49, 1.0, 1),
        (0.49, 0.51, 1.0, 1),
        (0.1, 0.1, 99.9, 0),
        (0.1, 0.1, 100.1, 2),
        # 500 g at 2 kHz, and amplitudes that differ a thousandfold
        (3e-5, 3e-5, 2.0 * math.pi * 2000.0, 0),
        (1e-4, 0.1, OMEGA, 0),
        (0.1, 1e-4, OMEGA, 0),
    ],
)
def test_sizes_that_no_bench_has(Y, X, omega, count):
    found = list(checks.plausible(Y, X, omega, "base_displacement"))
    assert len(found) == count
    # a force over the stiffness is no motion
    of_mass = [one for one in found if not one.numbers["base"]]
    assert list(checks.plausible(Y, X, omega, "force")) == of_mass


@pytest.mark.parametrize(
    ("gain", "confused"),
    [
        (1.0, None),
        (99.0, None),
        (1.0 / 99.0, None),
        (101.0, "cm taken for m"),
        (301.0, "cm taken for m"),
        (1000.0, "mm taken for m"),
        (2e-4, "mm taken for m"),
    ],
)
def test_a_unit_is_asked_for_by_the_sizes_of_two_channels_alone(gain, confused):
    for coordinate in (TRANSLATION, ROTATION):
        found = list(checks.ratio(0.01, 0.01 * gain, "force", coordinate))
        assert [one.numbers["confused"] for one in found] == [confused] * bool(confused)
        assert all(one.numbers["angle"] == (coordinate is ROTATION) for one in found)
        assert all(one.numbers["rare"] == (1.0 / 300.0 < gain < 300.0) for one in found)
        assert all(bool(one.effect) != one.numbers["rare"] for one in found)


def test_distortion_is_that_of_the_harmonics_that_count():
    error = np.array([1e-3, 1e-3, 2e-3, 1e-3, 1e-3])
    mean = np.array([5.0, 2.0, 0.008j, 0.06, 0.08], dtype=np.complex128)
    # 3 % and 4 %: 5 % together; the second harmonic is four errors
    for drive in ("base_displacement", "force"):
        (one,) = checks.harmonic_drive(mean, error, drive)
        assert one.numbers["distortion"] == pytest.approx(0.05)
        assert (one.numbers["order"], one.numbers["share"]) == (4, pytest.approx(0.04))
        assert one.numbers["by_force"] == (drive == "force")
    assert list(checks.harmonic_drive(mean[:3], error[:3], "force")) == []
    # six errors, but 0.04 % does not matter
    assert list(checks.harmonic_drive(mean[:3] * [1, 10, 1], error[:3] / 1.5, "force")) == []


def test_even_harmonics_are_asymmetry_and_odd_ones_are_not():
    error = np.full(6, 1e-3)
    mean = np.array([5.0, 2.0, 0.01, 0.5, -0.04, 0.3], dtype=np.complex128)
    one = next(checks.symmetry(mean, error, mean, error))
    assert (one.numbers["order"], one.numbers["share"]) == (4, pytest.approx(0.02))
    assert list(checks.symmetry(mean * [1, 1, 0, 1, 0, 1], error, mean, error)) == []
    # those of the base itself act in second order
    (of_rig,), (of_drive,) = (
        list(checks.symmetry(mean, error, base, error))
        for base in (mean * [1, 1, 0, 1, 0, 1], mean)
    )
    assert of_drive.effect[""] == pytest.approx(of_rig.effect[""] ** 2)


def test_the_base_puts_work_in_where_the_response_lags():
    error = 0.003 * math.sqrt(0.5)
    for lag in (0.5, 0.0, -0.0149, -0.0151, -2.0):
        X = 3.0 * np.exp(-1j * (lag + 0.4))
        words = list(checks.work(np.exp(-0.4j), complex(X), error, 3.0 * error))
        assert len(words) == (lag < -0.015), lag


def test_a_weighted_mean_divides_by_its_weights():
    rows = np.array([[1.0, 2.0j], [4.0, 8.0j]])
    assert checks.weighted_mean(rows, np.array([2.0, 1.0])) == pytest.approx([2.0, 4.0j])
