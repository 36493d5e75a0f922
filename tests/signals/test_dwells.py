"""Dwells of a drive are found where its amplitude or frequency steps, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.signals.dwells import Swept, dwells_of

RATE, SECONDS = 500.0, 40.0
T = np.arange(int(RATE * SECONDS)) / RATE


def drive(amplitude, hertz, noise=0.01, seed=0):
    """A drive with these amplitudes and frequencies, one for each sample or for all."""
    turns = np.cumsum(np.broadcast_to(hertz, T.shape)) / RATE
    y = amplitude * np.cos(2.0 * np.pi * turns)
    return y + noise * np.std(y) * np.random.default_rng(seed).standard_normal(T.size)


def steps(values):
    return np.repeat(values, T.size // len(values))


@pytest.mark.parametrize("noise", [0.0, 0.05])
@pytest.mark.parametrize("values", [(2.0, 3.0, 5.0, 8.0), (8.0, 5.0, 3.0, 2.0), (3.0, 3.6)])
def test_levels_of_amplitude(values, noise):
    dwells = dwells_of(T, drive(steps(values), 4.0, noise))
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
    found = dwells_of(T, drive(amplitude[: T.size], 4.0))
    assert [round(one.amplitude, 1) for one in found] == [2.0, 4.0, 8.0]
    found = dwells_of(T, drive(1.0, steps((3.0, 4.0, 5.0, 6.0))))
    assert [one.hertz for one in found] == pytest.approx([3.0, 4.0, 5.0, 6.0], rel=0.01)


@pytest.mark.parametrize("hertz", [1.1, 4.0, 17.3])
@pytest.mark.parametrize("noise", [0.0, 0.1, 0.6])
@pytest.mark.parametrize(("change", "beat", "third"), [(0.1, 0.0, 0.0), (-0.1, 0.05, 0.2)])
def test_one_level_that_drifts_beats_or_is_distorted_is_one(hertz, noise, change, beat, third):
    amplitude = (1.0 + change * T / SECONDS) * (1.0 + beat * np.sin(0.7 * T))
    y = drive(amplitude, hertz, noise) + third * np.cos(6.0 * np.pi * hertz * T)
    assert len(dwells_of(T, y)) < 2


@pytest.mark.parametrize(("begin", "end"), [(2.0, 12.0), (12.0, 2.0), (5.0, 7.0)])
def test_a_sweep_is_refused_with_its_range(begin, end):
    with pytest.raises(Swept, match=r"sweeps from ([\d.]+) to ([\d.]+) Hz") as error:
        dwells_of(T, drive(1.0, begin + (end - begin) * T / SECONDS))
    said = [float(word) for word in str(error.value).split() if word.replace(".", "").isdigit()]
    # the first and last cycles are read in a fiftieth of the sweep
    assert said[:2] == pytest.approx([begin, end], rel=0.25)


def test_noise_and_short_records_have_none():
    assert dwells_of(T[:1000], drive(1.0, 4.0)[:1000]) == []
    assert len(dwells_of(T, np.random.default_rng(1).standard_normal(T.size))) < 2
