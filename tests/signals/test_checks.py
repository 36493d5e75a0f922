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


def on_cycles(fundamental, weights=EQUAL, **channel):
    """The findings on a record of one channel, with rows of one cycle each with these fundamentals."""
    rows = np.outer(fundamental, [0.0j, 1.0])
    weights = np.resize(weights, len(fundamental))
    more = {"bad_cycles": (), "span": 1.0, "clipped": 0.0} | channel
    harmonics = CycleHarmonics(OMEGA, 0.0, 1e-3, rows, 1, weights, np.zeros((2, 2)), **more)
    return list(checks.checked_cycles({"x": harmonics}, weights, OMEGA, TRANSLATION))


# ±1 about the mean: its standard error is 1/√16, five of them 1.25
TURNS = np.tile([1.0, -1.0], 8)


def test_a_channel_must_vary_and_oscillate():
    checks.require_signal("x", np.array([0.0, 1e-12]))
    with pytest.raises(ValueError, match=r"x is constant \(0\.25\): the transducer"):
        checks.require_signal("x", np.full(5, 0.25))
    with pytest.raises(ValueError, match="x is constant: the transducer"):
        on_cycles(np.ones(10), span=0.0)
    assert on_cycles(1.26 + TURNS) == []
    with pytest.raises(ValueError, match=r"drive frequency of 5 Hz: amplitude 1\.24 ± 0\.25"):
        on_cycles(1.24 + TURNS)
    # a row without usable cycles has no say
    assert on_cycles(np.append(np.full(10, 2.0), math.nan), [*np.ones(10), 0.0]) == []


def test_a_response_that_is_the_drive_itself_is_refused():
    y = np.sin(np.arange(50.0))
    other = y + 2e-9 * np.cos(np.arange(50.0))
    checks.require_distinct("x", other, "y", y)
    with pytest.raises(ValueError, match="x is y times -2:"):
        checks.require_distinct("x", 3.0 - 2.0 * y, "y", y[:40])


def test_cycles_that_are_few_left_out_or_clipped():
    for weights in ([1.0, 1.0, 0.0], [2.0, 2.0, 0.0]):
        with pytest.raises(ValueError, match="usable whole cycles of 5 Hz"):
            on_cycles(np.ones(3), weights)
    for count in (3, 9, 10):
        found = [(one.code, one.numbers["cycles"]) for one in on_cycles(np.ones(count))]
        assert found == [("few cycles", count)] * (count < 10)
    gap = (4, 0.8, Finding("gap"))
    (one,) = on_cycles(np.ones(10), bad_cycles=(gap, gap))
    numbers = {"quantity": "x", "count": 2, "first": 5, "time": 0.8, "why": gap[2]}
    assert one == Finding("spikes", numbers)
    for part in (0.49, 0.5):
        found = [(one.code, one.numbers["cycles"]) for one in on_cycles(np.ones(10), clipped=part)]
        assert found == [("clipped", part)] * (part == 0.5)


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
        (0.049, 0.0, 3, True),
    ],
)
def test_a_frequency_that_differs_is_named(off, error, cycles, differs):
    assert list(checks.frequency(OMEGA * (1.0 + off), OMEGA * error, cycles, None)) == []
    found = list(checks.frequency(OMEGA * (1.0 + off), OMEGA * error, cycles, 5.0))
    assert [one.effect[""] for one in found] == pytest.approx([abs(off)] * differs)
    assert [one.numbers["off"] for one in found] == pytest.approx([off] * differs)


def test_another_frequency_is_refused():
    for given in (5.0 / 1.051, 5.0 / 0.949, 0.0, math.nan, math.inf):
        other = "wrong frequency, wrong column" if 4.0 < given < 6.0 else "must be positive"
        with pytest.raises(ValueError, match=other):
            list(checks.frequency(OMEGA, 0.0, 20, given))


# --- consistency: nine cycles, four of whose ratios scatter by ±d about their mean: its error is √(4d²/(2 · 8 · 9)) ---


def pair_of_responses(gain, phase, error=1e-3):
    """x, harmonics 0 … 3, and v as a displacement that is larger and later, scattering about that."""
    x = np.tile([0.0, 2.0, 0.3j, 0.1], (9, 1)).astype(np.complex128)
    v = gain * x * np.exp(1j * np.arange(4) * phase)
    v[[0, 1, 2, 3], 1] += 2.0j * 6.0 * error * np.array([1.0, -1.0, 1.0, -1.0])
    return {"x": x, "v": v}


@pytest.mark.parametrize(("off", "counts"), [(0.0048, False), (0.0053, True)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_skew_and_gain_count_from_five_standard_errors_on(off, counts, sign):
    late, larger = pair_of_responses(1.0, sign * off), pair_of_responses(1.0 + sign * off, 0.0)
    for one in (found := list(checks.consistency(late, EQUAL, OMEGA))):
        by, error = (OMEGA * one.numbers[name] for name in ("by", "error"))
        assert (one.numbers["lags"], by) == (sign < 0.0, pytest.approx(off))
        assert error == pytest.approx(1e-3, rel=0.05)
    assert len(found) == len(list(checks.consistency(larger, EQUAL, OMEGA))) == counts
    # harmonic n turns back n times as far
    left = 1.0 if counts else 1.0 + sign * off
    np.testing.assert_allclose(larger["v"][:, 2:], left * larger["x"][:, 2:], rtol=2e-4)
    if counts:
        np.testing.assert_allclose(late["v"][:, 2:], late["x"][:, 2:], rtol=2e-4)


def test_differences_count_from_a_size_that_matters_on_and_are_refused_beyond_another():
    for gain, phase, count in (
        (1.00009, 1.8e-5, 0),
        (1.00011, 0.0, 1),
        (1.0, 2.2e-5, 1),
        (1.09, 0.49, 2),
    ):
        found = list(checks.consistency(pair_of_responses(gain, phase, 0.0), EQUAL, OMEGA))
        assert len(found) == count
    for gain, phase in ((1.11, 0.0), (0.89, 0.0), (1.0, 0.51), (1.0, -0.51), (-1.0, 0.0)):
        with pytest.raises(ValueError, match="v contradicts x: at the drive frequency"):
            list(checks.consistency(pair_of_responses(gain, phase), EQUAL, OMEGA))


# --- steadiness -----------------------------------------------------------------------------------------------------

LINE = np.linspace(-0.5, 0.5, 40)
STILL = np.ones(40) + 0j


def steadiness(Y, X, cycles_per_row=1, skipped=0):
    period = 2.0 * math.pi / OMEGA
    times = cycles_per_row * period * (0.5 + np.arange(len(Y)))
    return checks.steadiness(Y, X, times, np.ones(len(Y)), period, skipped)[1]


@pytest.mark.parametrize("drive", [True, False])
def test_steady_noise_rarely_looks_like_a_change(drive, monkeypatch):
    """At the level of 10 % false alarms are 10 % at most, and, the level being cautious, not much fewer than 2 %."""
    monkeypatch.setattr(checks, "P_DRIFT", 0.1)
    monkeypatch.setattr(checks, "_SMALLEST_CHANGE", 0.0)
    noise = 1e-3 * np.random.default_rng(7).standard_normal((1000, 64, 2)).view(complex)[..., 0]
    alarms = 0
    for one in noise:
        Y, X = (1.0 + one, 2j * (1.0 + one)) if drive else (np.ones(64) + 0j, 2j + one)
        alarms += any(found.numbers["drive"] == drive for found in steadiness(Y, X))
    # 1000 draws: one standard deviation is 1 % at 10 %
    assert 20 < alarms < 120


def test_a_change_is_told_from_four_rows_on_and_refused_from_a_tenth_on():
    X = np.array([1.0, 1.0, 1.05, 1.05]) + 0j
    assert steadiness(STILL[:3], X[1:]) == []
    (one,) = steadiness(STILL[:4], X)
    assert (one.numbers["drive"], one.numbers["phase"]) == (False, False)
    assert one.numbers["change"] == pytest.approx(0.049, abs=5e-4)
    (one,) = steadiness(STILL, 1.0 + 0.095 * LINE + 0j)
    assert one.numbers["change"] == pytest.approx(0.095)
    # a change in proportion to time has this standard deviation
    assert one.effect[""] == pytest.approx(0.095 / math.sqrt(12.0), rel=0.01)
    with pytest.raises(ValueError, match="record again after the motion has settled"):
        steadiness(STILL, 1.0 + 0.105 * LINE + 0j)


def test_a_response_may_follow_a_drive_which_hunts_or_turns():
    """Near resonance it changes by more than a tenth, and is no transient."""
    hunts = 0.03 * np.sin(np.linspace(0.0, 5.0, 40))
    found = steadiness(1.0 + hunts + 0j, 1.0 + 4.0 * hunts + 0j)
    assert [one.numbers["drive"] for one in found] == [True, False]
    assert found[1].effect[""] > 0.05
    with pytest.raises(ValueError, match="the response is not steady"):
        steadiness(STILL, 1.0 + 4.0 * hunts + 0j)
    turning = np.exp(3j * LINE)  # the drive is not quite at the ω assumed
    assert steadiness(turning, 2.0 * turning) == []
    (one,) = steadiness(STILL, np.exp(1e-2j * LINE))
    assert (one.numbers["phase"], one.numbers["turn"]) == (True, pytest.approx(0.005, abs=5e-5))


@pytest.mark.parametrize(("cycles_per_row", "skipped"), [(1, 0), (4, 3)])
def test_it_says_when_the_motion_has_settled(cycles_per_row, skipped):
    rng = np.random.default_rng(3)
    X = 1.0 + 1e-6 * (rng.standard_normal(80) + 1j * rng.standard_normal(80))
    X[:5] += 0.01
    (one,) = steadiness(np.ones(80) + 0j, X, cycles_per_row, skipped)
    assert one.numbers["after"] == one.numbers["skip"] - skipped == 5 * cycles_per_row
    assert steadiness(STILL, 1.0 + 0.01 * LINE + 0j)[0].numbers["skip"] == 0  # it never does


# --- what amplitudes and harmonics say -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("Y", "X", "omega", "bases"),
    [
        (0.49, 0.49, 1.0, []),
        (0.51, 0.49, 1.0, [True]),
        (0.49, 0.51, 1.0, [False]),
        (0.1, 0.1, 99.9, []),
        (0.1, 0.1, 100.1, [True, False]),
        (3e-5, 3e-5, 2.0 * math.pi * 2000.0, []),  # 500 g
    ],
)
def test_sizes_that_no_bench_has(Y, X, omega, bases):
    found = list(checks.plausible(Y, X, omega, "base_displacement"))
    sizes = [(one.numbers["base"], one.numbers["amplitude"]) for one in found]
    assert sizes == [(base, Y if base else X) for base in bases]
    # a force over the stiffness is no motion
    assert list(checks.plausible(Y, X, omega, "force")) == found[sum(bases) :]


@pytest.mark.parametrize(
    ("gain", "confused"),
    [(99.0, None), (1.0 / 99.0, None), (101.0, "cm"), (301.0, "cm"), (1000.0, "mm"), (2e-4, "mm")],
)
def test_a_unit_is_asked_for_by_the_sizes_of_two_channels_alone(gain, confused):
    for coordinate in (TRANSLATION, ROTATION):
        found = list(checks.ratio(0.01, 0.01 * gain, "force", coordinate))
        assert [one.numbers["confused"][:2] for one in found] == [confused] * bool(confused)
        assert all(one.numbers["angle"] == (coordinate is ROTATION) for one in found)
        assert all(one.numbers["rare"] == (1.0 / 300.0 < gain < 300.0) for one in found)
        assert all(bool(one.effect) != one.numbers["rare"] for one in found)


def test_distortion_is_that_of_the_harmonics_that_count():
    error = np.array([1e-3, 1e-3, 2e-3, 1e-3, 1e-3])
    mean = np.array([5.0, 2.0, 0.008j, 0.06, 0.08], dtype=np.complex128)
    # 3 % and 4 %: 5 % together; the second harmonic is four errors
    for drive in ("base_displacement", "force"):
        (one,) = checks.harmonic_drive(mean, error, drive)
        expected = {"distortion": 0.05, "order": 4, "share": 0.04, "by_force": drive == "force"}
        assert {name: one.numbers[name] for name in expected} == pytest.approx(expected)
    assert list(checks.harmonic_drive(mean[:3], error[:3], "force")) == []
    # six errors, but 0.04 % does not matter
    assert list(checks.harmonic_drive(mean[:3] * [1, 10, 1], error[:3] / 1.5, "force")) == []


def test_even_harmonics_are_asymmetry_and_odd_ones_are_not():
    error, mean = np.full(6, 1e-3), np.array([5.0, 2.0, 0.01, 0.5, -0.04, 0.3 + 0.0j])
    odd = mean * [1, 1, 0, 1, 0, 1]
    (one,) = checks.symmetry(mean, error, odd, error)
    assert (one.numbers["order"], one.numbers["share"]) == (4, pytest.approx(0.02))
    assert list(checks.symmetry(odd, error, mean, error)) == []
    # those of the base itself act in second order
    (of_drive,) = checks.symmetry(mean, error, mean, error)
    assert of_drive.effect[""] == pytest.approx(one.effect[""] ** 2)


def test_the_base_puts_work_in_where_the_response_lags():
    error = 0.003 * math.sqrt(0.5)
    for lag in (0.5, 0.0, -0.0149, -0.0151, -2.0):
        X = 3.0 * np.exp(-1j * (lag + 0.4))
        found = list(checks.work(np.exp(-0.4j), complex(X), error, 3.0 * error))
        assert len(found) == (lag < -0.015), lag


@pytest.mark.parametrize(
    ("step", "noise", "bits"),
    [(1e-3, 0.0, 11.0), (1e-3, 4e-4, 11.0), (1e-3, 6e-4, 0.0), (4e-4, 0.0, 0.0), (0.02, 0.0, 6.6)],
)
def test_a_converter_below_12_bits_without_noise_is_reported(step, noise, bits):
    values = 0.3 + np.cos(0.0237 * np.arange(5000))
    assert list(checks.few_bits("displacement", values, noise)) == []
    found = list(checks.few_bits("displacement", step * np.round(values / step), noise))
    assert [one.numbers["bits"] for one in found] == pytest.approx([bits] * (bits > 0.0), abs=0.05)
    assert [one.effect[""] for one in found] == pytest.approx([step / 2.0] * (bits > 0.0), rel=0.02)
