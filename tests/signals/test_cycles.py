"""Harmonics cycle by cycle, and the drive frequency: exact on clean signals, efficient on noisy ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.findings.finding import Finding
from dampbalance.signals.cycles import _held, cycle_harmonics, drive_frequency
from paper_case import OMEGA

DT = 1.0 / 997.0  # 202.6 samples per cycle
OMEGA_1 = 2.0 * math.pi  # one cycle a second


def _signal(t: np.ndarray) -> np.ndarray:
    even = 0.3 + 0.5 * np.cos(2 * OMEGA * t + 1.0)
    return even + 2.0 * np.cos(OMEGA * t - 0.4) - 0.1 * np.sin(3 * OMEGA * t)


def rows_of(t, s, start=0.0, dt=DT, harmonics=5, omega=OMEGA):
    return cycle_harmonics(t, s, omega, start=start, dt=dt, harmonics=harmonics)


def test_harmonics_are_exact_for_any_number_of_samples_per_cycle():
    t = 0.123 + DT * np.arange(4001)
    found = rows_of(t, _signal(t), 0.13)
    expected = [0.3, 2.0 * np.exp(-0.4j), 0.5 * np.exp(1.0j), 0.1j, 0.0, 0.0]
    # least squares on a signal of the model: rounding, times the condition of the normal matrix (about 2)
    np.testing.assert_allclose(found.coefficients, np.tile(expected, (19, 1)), atol=1e-11)
    period = 2.0 * math.pi / OMEGA
    assert found.times == pytest.approx(0.13 + period * (0.5 + np.arange(19)), rel=1e-14)
    assert (found.span, found.first) == (np.ptp(_signal(t)), t[0])
    assert (found.clipped, found.bad_cycles) == (0.0, ())


def test_many_cycles_are_joined_into_bounded_rows():
    dt = 2.0 * math.pi / OMEGA / 16.3
    t = dt * np.arange(16.3 * 5000)
    found = rows_of(t, 2.0 * np.cos(OMEGA * t - 0.4), dt=dt, harmonics=3)
    assert found.weights.tolist() == [4.0] * 1250
    assert found.cycles_per_row == 4
    np.testing.assert_allclose(found.coefficients[:, 1], 2.0 * np.exp(-0.4j), atol=1e-10)


def test_a_cycle_needs_more_samples_than_it_has_unknowns():
    """N harmonics and the mean are 2N + 1 numbers; the shorter ones of uneven cycles must have one sample more."""
    t = np.arange(34)
    enough, few = (
        (t / rate, np.cos(OMEGA_1 * t / rate), 0.0, 1.0 / rate, 3, OMEGA_1) for rate in (8.1, 7.9)
    )
    np.testing.assert_allclose(rows_of(*enough).coefficients[:, 1], 1.0, atol=1e-12)
    with pytest.raises(ValueError, match=r"7\.9 samples per cycle are too few for 3 harm"):
        rows_of(*few)


CYCLE = 200  # samples in a cycle of the records below


def _faulty(spoil=lambda values: None, noise=0.0, missing=None):
    """Twelve cycles of a sinusoid with `spoil` done to its samples; 200 samples and one second a cycle."""
    t = np.arange(12 * CYCLE) / CYCLE
    values = np.cos(OMEGA_1 * t) + noise * np.random.default_rng(3).standard_normal(t.size)
    spoil(values)
    more = {"start": 0.0, "dt": 1.0 / CYCLE, "harmonics": 5, "missing": missing}
    return cycle_harmonics(t, values, OMEGA_1, **more)


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("cycle", [0, 7, 11])
def test_a_spike_is_named_by_its_value_its_time_and_what_is_expected(noise, cycle):
    found = _faulty(lambda values: values.put(cycle * CYCLE + 33, 3.25), noise)
    ((number, time, reason),) = found.bad_cycles
    assert (number, time) == (cycle, pytest.approx(cycle))
    assert (reason.code, reason.numbers["value"]) == ("spike", 3.25)
    # the harmonics bend towards the spike: by 11 unknowns of 200 samples
    expected = math.cos(2.0 * math.pi * 33 / CYCLE)
    assert reason.numbers["expected"] == pytest.approx(expected, abs=0.2)
    assert found.weights.tolist() == [float(j != cycle) for j in range(12)]


def test_a_spike_stands_out_of_the_noise_and_cycles_that_lack_samples_are_left_out():
    for spike, seen in ((0.08, 0), (0.3, 1)):  # of a noise of 0.01
        spiked = spike * (np.arange(12 * CYCLE) == 5 * CYCLE + 33)
        found = _faulty(lambda values, of=spiked: np.add(values, of, out=values), 0.01)
        assert len(found.bad_cycles) == seen
    missing = np.isin(np.arange(12 * CYCLE), [3 * CYCLE, 6 * CYCLE - 1])
    found = _faulty(missing=missing)
    assert found.bad_cycles == ((3, 3.0, Finding("gap")), (5, 5.0, Finding("gap")))
    assert found.weights.sum() == 10.0


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize(("length", "at"), [(0, 30), (12, 30), (40, 120)])
@pytest.mark.parametrize("step", [0.0, 2.0**-12, 2.0**-5])
def test_samples_that_stand_still_are_no_steps_of_a_converter(noise, length, at, step):
    def spoil(values):
        first = 4 * CYCLE + at
        values[:] = step * np.round(values / step) if step else values
        values[first : first + length] = values[first]

    bad = _faulty(spoil, noise).bad_cycles
    found = [(j, why.code, why.numbers["samples"]) for j, _, why in bad]
    # a step may be longer than that
    assert [one[:2] for one in found] == [(4, "drop-out")] * bool(length)
    assert all(length <= samples <= length + 20 * (step > 0.0) for _, _, samples in found)


RISING = np.concatenate([10.0 * np.arange(20), 191.0 + np.arange(80)])
FALLING = np.concatenate([np.arange(80.0), 80.0 + 10.0 * np.arange(20)])


@pytest.mark.parametrize(
    ("cycle", "start", "samples", "rms", "value"),
    [
        # within 6 samples, less one at either end, the other cycles move on by 3: by a step and 5 · 0.4
        (RISING, 60, 6, 0.39, 231),
        (RISING, 60, 6, 0.41, None),
        # held for 8 samples it goes on with a jump of 8: by 1 a sample it moves there, if by 10 farther off
        (RISING, 60, 8, 0.0, 231),
        (RISING, 24, 8, 0.0, None),
        # a stop begins and ends a little earlier or later in each cycle: fast motion within the length of the held
        # samples on either side explains the jump, motion farther off does not
        (RISING, 26, 8, 0.0, None),
        (RISING, 27, 8, 0.0, 198),
        (FALLING, 64, 8, 0.0, 64),
        (FALLING, 65, 8, 0.0, None),
    ],
)
def test_a_drop_out_jumps_more_than_noise_or_motion_nearby(cycle, start, samples, rms, value):
    spoiled = cycle.copy()
    spoiled[start : start + samples] = cycle[start]
    held = Finding("drop-out", {"samples": samples, "value": value})
    found = _held(spoiled, np.tile(cycle, (8, 1)), rms)
    assert found == (None if value is None else held)


@pytest.mark.parametrize(
    ("low", "high", "clipped"),
    [
        (-math.inf, math.inf, 0.0),
        (-math.inf, 0.97, 1.0),
        (-0.97, math.inf, 1.0),
        # only those at the highest level of the record hold it as a clipped signal does: the rest may be smaller
        (-math.inf, np.repeat([0.97, 0.99], 6 * CYCLE), 0.5),
    ],
)
def test_a_flat_top_is_no_drop_out_and_a_clipped_one_is_counted(low, high, clipped):
    found = _faulty(lambda values: np.clip(values, low, high, out=values))
    assert (found.clipped, found.bad_cycles) == (clipped, ())


def test_a_drifting_offset_adds_what_the_drift_says():
    t = DT * np.arange(9000)
    found = rows_of(t, 5.0 * t + 0.7 * t**2, harmonics=4)
    rate = 5.0 + 1.4 * found.times
    expected = (np.outer(rate, found.drift[0]) + 0.7 * found.drift[1])[:, 1:].mean(axis=0)
    # the middle of a cycle's samples is up to half a sample, 0.25 %, off the middle of the cycle
    off = np.abs(found.coefficients[:, 1:].mean(axis=0) - expected)
    assert off.max() < 1e-3 * np.abs(expected).mean()


@pytest.mark.parametrize("cycles", [5.3, 60.0])
def test_frequency_of_a_clean_signal_is_exact(cycles):
    t = 3.0 + np.arange(0.0, cycles * 2 * math.pi / OMEGA, DT)
    assert drive_frequency(t, _signal(t), DT)[0] == pytest.approx(OMEGA, rel=1e-10)


def test_frequency_of_a_noisy_signal_scatters_by_its_bound():
    t = DT * np.arange(8000)
    noise = 0.1 * np.random.default_rng(2).standard_normal((100, t.size))
    found = np.array([drive_frequency(t, 2.0 * np.cos(OMEGA * t) + one, DT) for one in noise])
    bound = math.sqrt(24.0 * 0.1**2 / (2.0**2 * t.size)) / t[-1]
    # 100 runs: the scatter is known to 7 %, its mean to 10 %; the whole cycles are 97 % of the record
    assert found[:, 0].std() == pytest.approx(bound, rel=0.25)
    assert abs(found[:, 0].mean() - OMEGA) < 0.4 * bound
    assert found[:, 1].mean() == pytest.approx(bound, rel=0.2)


def test_a_signal_without_cycles_is_refused():
    t = DT * np.arange(500)
    for omega, why in (
        (OMEGA, "2 whole cycles of .*; at least 3"),
        (0.0, "no line"),
        (2.5e3, "fast"),
    ):
        with pytest.raises(ValueError, match=why):
            drive_frequency(t, np.cos(omega * t), DT)
