"""The harmonics that an oscillator is fitted to, with their errors."""

from __future__ import annotations

import math

import numpy as np

from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.record_harmonics import RecordHarmonics
from dampbalance.signals.thresholds import CERTAIN
from paper_case import NEAR, PAPER, orbits_at

(ORBIT,) = orbits_at(NEAR, (0.008,))


def of_record(noise: float, start: float = 0.0, seed: int = 1) -> RecordHarmonics:
    taken = {"rate_hz": 2000.0, "cycles": 40.0, "noise": noise, "seed": seed, "start": start}
    return RecordHarmonics.of(condition(measured_orbit(ORBIT, **taken), PAPER.k))


def test_they_are_those_of_the_motion_wherever_the_record_begins():
    for start in (0.0, 0.0317, 0.15):
        lines = of_record(0.0, start)
        assert lines.n.tolist() == list(range(1, 2 * lines.n.size, 2))
        # phases count from the peak of the base; rounding, and the aliases of the harmonics beyond
        off = np.abs(lines.x - ORBIT.harmonics(lines.n.size)) / abs(lines.x[0])
        assert off.max() < 2e-6
        assert abs(lines.Y / 0.008 - 1.0) < 1e-9
        assert abs(lines.omega / (2.0 * math.pi * NEAR) - 1.0) < 1e-9
        assert lines.interval == 5e-4


def test_their_errors_are_those_of_the_scatter():
    read = [of_record(0.01, seed=seed) for seed in range(40)]
    count = min(lines.n.size for lines in read)
    x = np.array([lines.x[:count] for lines in read]) - ORBIT.harmonics(count)
    errors = np.sqrt(np.mean([lines.x_error[:count] ** 2 for lines in read], axis=0))
    scatter = np.sqrt(np.mean(np.abs(x) ** 2 / 2.0, axis=0))
    # small ones, which the phase of the base does not move; 40 draws of two parts know a scatter to 8 %
    np.testing.assert_allclose(scatter[2:], errors[2:], rtol=0.3)
    amplitudes = np.array([lines.Y for lines in read])
    # a scatter of 40 draws is known to 11 %
    assert abs(amplitudes.std() / read[0].Y_error - 1.0) < 0.4
    assert 38 <= read[0].rows <= 42


def test_what_stands_out_of_the_noise_is_clear_and_the_fundamental_always_is():
    x = np.array([0.5, CERTAIN * 1.01, CERTAIN * 0.99, 30.0])
    lines = RecordHarmonics(1.0, 1.0, 0.1, np.arange(1, 8, 2), x.astype(complex), np.ones(4), 10)
    assert lines.clear.tolist() == [True, True, False, True]
    # of x_1 = 0.5 ± 1, and of Y = 1 ± 0.1, once and where it was added to x
    assert lines.relative_error == math.hypot(2.0, 0.1)
