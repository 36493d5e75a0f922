"""When the drive of a record moves, and at which frequencies: slow drives, fast recorders, still starts, dwells."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, steady_orbit, transient
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.drive import frequency_of, onset, stands_still, step_of
from dampbalance.signals.dwells import Swept, dwells_of
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)


@pytest.mark.parametrize(("hertz", "cycles"), [(1.0, 11.3), (0.5, 9.6), (0.5, 3.2)])
def test_a_slow_drive_is_found_in_a_fast_record(hertz, cycles):
    t = np.arange(round(cycles * 51200.0 / hertz)) / 51200.0
    noise = 0.01 * np.random.default_rng(2).standard_normal(t.size)
    y = np.cos(2.0 * math.pi * hertz * t + 0.3) + noise
    omega, error, used, begin = frequency_of(t, y, "y")
    # the bound of Rife and Boorstyn, of as much noise; of three cycles the error itself is known to half
    bound = math.sqrt(24.0 * 0.01**2 / t.size) / (t[-1] - t[0])
    assert abs(omega - 2.0 * math.pi * hertz) < 5.0 * bound
    assert bound / 10.0 < error < 10.0 * bound
    assert used >= min(8, math.floor(cycles))
    assert begin == -math.inf


@pytest.mark.parametrize(
    ("still", "rate", "noise"),
    [(2.0, 51200.0, 0.004), (9.0, 51200.0, 0.0), (2.0, 1000.0, 0.0), (2.0, 1000.0, 0.04)],
)
def test_a_still_start_is_left_out_and_said(still, rate, noise):
    """The record begins so many seconds before the drive does, from rest."""
    t = np.arange(round((still + 20.0 * MOTION.period) * rate)) / rate
    since = np.maximum(t - still, 0.0)
    x = transient(PAPER, MOTION, float(since[-1])).state(since).x
    off = 1e-3 + noise * MOTION.Y * np.random.default_rng(0).standard_normal((2, t.size))
    y, x = np.where(t >= still, [MOTION.y(since), x], 0.0) + off
    assert not stands_still(y)
    channels = [Channel("base_displacement", t, y), Channel("displacement", t, x)]
    steady = condition(Record.of("late", channels), PAPER.k, skip_cycles=5)
    assert steady.frequency_hz == pytest.approx(NEAR, rel=1e-4)
    (late,) = (one for one in steady.warnings if one.code == "starts late")
    assert late.numbers["begin"] == pytest.approx(still, abs=MOTION.period)
    # within a cycle of the onset, and the five that were asked for
    assert still - 1e-3 < steady.start - 5.0 * MOTION.period < still + MOTION.period
    assert steady.cycles == pytest.approx(14.5, abs=0.6)
    assert abs(steady.mean(steady.Y)[1]) == pytest.approx(MOTION.Y, rel=0.01)


def test_a_drift_is_no_still_start():
    record = measured_orbit(steady_orbit(PAPER, MOTION), rate_hz=1000.0, cycles=30.0, noise=0.001)
    y = record["base_displacement"]
    # half of the range is passed after twelve cycles
    drifting = y.values + 4.0 * MOTION.Y * np.linspace(0.0, 1.0, y.t.size) ** 3
    assert y.t[onset(drifting)] > 10.0 * MOTION.period
    omega, _, cycles, begin = frequency_of(y.t, drifting, "y")
    assert (cycles, begin) == (30, -math.inf)
    # the drift turns the phase by less than a tenth of a cycle in 30
    assert omega == pytest.approx(OMEGA, rel=0.1 / 30.0)


T = np.arange(40_000) / 5000.0
NOISE = np.random.default_rng(4).standard_normal(T.size)


@pytest.mark.parametrize(
    ("values", "still"),
    [
        (0.0 * T, True),
        (NOISE + 100.0 * (np.abs(T - 1.0) < 0.005), True),  # a blow
        (NOISE + 100.0 * (np.abs(T % 2.0 - 1.0) < 0.005), True),  # four
        (np.cos(20.0 * T), False),
        (np.cos(2.0 * T) + 0.1 * NOISE, False),
        (0.1 * np.cos(200.0 * T) + NOISE, False),  # below the noise, 100 times above its spectrum
        (np.where(T < 1.0, np.cos(20.0 * T), 0.01 * NOISE), False),
        (np.cos(20.0 * T) + 500.0 * (np.arange(T.size) == 77), False),  # a spike
    ],
)
def test_noise_and_blows_stand_still(values, still):
    assert stands_still(values) == still
    assert stands_still(values * 1e-6 + 3.0) == still


def test_a_step_needs_three_samples():
    assert step_of(np.array([0.0, 0.4, 1.0]), "y") == 0.5
    with pytest.raises(ValueError, match="y has only 2 samples"):
        step_of(T[:2], "y")


# --- dwells are found where the amplitude or the frequency steps, and nowhere else -------------------

RATE, SECONDS = 500.0, 40.0
TIMES = np.arange(int(RATE * SECONDS)) / RATE


def drive(amplitude, hertz, noise=0.01, seed=0):
    """A drive with these amplitudes and frequencies, one for each sample or for all."""
    turns = np.cumsum(np.broadcast_to(hertz, TIMES.shape)) / RATE
    y = amplitude * np.cos(2.0 * np.pi * turns)
    return y + noise * np.std(y) * np.random.default_rng(seed).standard_normal(TIMES.size)


def steps(values):
    return np.repeat(values, TIMES.size // len(values))


@pytest.mark.parametrize("noise", [0.0, 0.05])
@pytest.mark.parametrize("values", [(2.0, 3.0, 5.0, 8.0), (8.0, 5.0, 3.0, 2.0), (3.0, 3.6)])
def test_levels_of_amplitude(values, noise):
    dwells = dwells_of(TIMES, drive(steps(values), 4.0, noise))
    lasts = SECONDS / len(values)
    for i, (dwell, value) in enumerate(zip(dwells, values, strict=True)):
        # noise of the mean of 40 cycles; what it adds to the rms is a part of noise²
        assert dwell.amplitude == pytest.approx(value, rel=0.02 + 2.0 * noise**2 * 16.0)
        assert dwell.hertz == pytest.approx(4.0, rel=0.01)
        assert i * lasts <= dwell.start < dwell.end <= (i + 1) * lasts
        assert dwell.end - dwell.start > lasts - 5.0 / 4.0  # five cycles beside the steps are left


def test_levels_that_are_reached_along_ramps_and_levels_of_frequency():
    ramp = np.ones(int(RATE)) / RATE  # of four cycles
    amplitude = np.convolve(np.pad(steps((2.0, 4.0, 8.0, 8.0)), 250, "edge"), ramp, "valid")
    found = dwells_of(TIMES, drive(amplitude[: TIMES.size], 4.0))
    assert [round(one.amplitude, 1) for one in found] == [2.0, 4.0, 8.0]
    found = dwells_of(TIMES, drive(1.0, steps((3.0, 4.0, 5.0, 6.0))))
    assert [one.hertz for one in found] == pytest.approx([3.0, 4.0, 5.0, 6.0], rel=0.01)


@pytest.mark.parametrize("hertz", [1.1, 4.0, 17.3])
@pytest.mark.parametrize("noise", [0.0, 0.1, 0.6])
@pytest.mark.parametrize(("change", "beat", "third"), [(0.1, 0.0, 0.0), (-0.1, 0.05, 0.2)])
def test_one_level_that_drifts_beats_or_is_distorted_is_one(hertz, noise, change, beat, third):
    amplitude = (1.0 + change * TIMES / SECONDS) * (1.0 + beat * np.sin(0.7 * TIMES))
    y = drive(amplitude, hertz, noise) + third * np.cos(6.0 * np.pi * hertz * TIMES)
    assert len(dwells_of(TIMES, y)) < 2


@pytest.mark.parametrize(("begin", "end"), [(2.0, 12.0), (12.0, 2.0), (5.0, 7.0)])
def test_a_sweep_is_refused_with_its_range(begin, end):
    with pytest.raises(Swept, match=r"sweeps from ([\d.]+) to ([\d.]+) Hz") as error:
        dwells_of(TIMES, drive(1.0, begin + (end - begin) * TIMES / SECONDS))
    said = [float(word) for word in str(error.value).split() if word.replace(".", "").isdigit()]
    # the first and last cycles are read in a fiftieth of the sweep
    assert said[:2] == pytest.approx([begin, end], rel=0.25)


def test_noise_and_short_records_have_none():
    assert dwells_of(TIMES[:1000], drive(1.0, 4.0)[:1000]) == []
    assert len(dwells_of(TIMES, np.random.default_rng(1).standard_normal(TIMES.size))) < 2
