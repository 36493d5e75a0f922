"""The harmonics that an oscillator is fitted to, with their errors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.record_harmonics import RecordHarmonics
from dampbalance.signals.thresholds import CERTAIN
from paper_case import NEAR, PAPER, orbits_at


def of_record(
    noise: float, *, start: float = 0.0, seed: int = 1, Y: float = 0.008
) -> RecordHarmonics:
    (orbit,) = orbits_at(NEAR, (Y,))
    measurement = measured_orbit(
        orbit, rate_hz=2000.0, cycles=40.0, noise=noise, seed=seed, start=start
    )
    return RecordHarmonics.of(condition(measurement, PAPER.k))


def test_they_are_those_of_the_motion_wherever_the_record_begins():
    exact = orbits_at(NEAR, (0.008,))[0].harmonics(20)
    for start in (0.0, 0.0317, 0.15):
        lines = of_record(0.0, start=start)
        assert lines.n.tolist() == list(range(1, 2 * lines.n.size, 2))
        # phases count from the peak of the base; rounding, and the aliases of the harmonics beyond
        assert lines.x == pytest.approx(exact[: lines.n.size], abs=2e-6 * abs(exact[0]))
        assert abs(lines.Y / 0.008 - 1.0) < 1e-9
        assert lines.omega == pytest.approx(2.0 * math.pi * NEAR, rel=1e-9)


def test_their_errors_are_those_of_the_scatter():
    (orbit,) = orbits_at(NEAR, (0.008,))
    read = [of_record(0.01, seed=seed) for seed in range(40)]
    count = min(lines.n.size for lines in read)
    x = np.array([lines.x[:count] for lines in read]) - orbit.harmonics(count)
    # the phase of the base moves harmonic n by n of its errors: taken off to first order by that of the fundamental
    errors = np.sqrt(np.mean([lines.x_error[:count] ** 2 for lines in read], axis=0))
    beyond = slice(2, None)  # small ones, which that phase does not move
    scatter = np.sqrt(np.mean(np.abs(x) ** 2 / 2.0, axis=0))
    # 40 draws of two parts know a scatter to 8 %
    assert scatter[beyond] == pytest.approx(errors[beyond], rel=0.3)
    assert read[0].rows == pytest.approx(40, abs=2)


def test_what_stands_out_of_the_noise_is_clear_and_the_fundamental_always_is():
    x = np.array([0.5, CERTAIN * 1.01, CERTAIN * 0.99, 30.0])
    lines = RecordHarmonics(1.0, 1.0, 0.1, np.arange(1, 8, 2), x.astype(complex), np.ones(4), 10)
    assert lines.clear.tolist() == [True, True, False, True]
