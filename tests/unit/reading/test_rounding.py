"""The error that a converter leaves in harmonics, against what rounding does to many signals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.reading.conditioning import converter_step, rounding_error
from dampbalance.reading.cycles import accumulate

CYCLES, HARMONICS = 50, 20


def harmonics(values, t, dt):
    record = accumulate(iter([(t, values)]), 2.0 * math.pi, start=0.0, dt=dt, harmonics=HARMONICS)
    return record.coefficients[:CYCLES]


def errors(amplitude, samples, noise):
    """Rms of what rounding to steps of 1 leaves in each part of the harmonics above the third, and what is foretold."""
    rng = np.random.default_rng(7)
    dt = 1.0 / samples
    t = np.arange(int(samples * CYCLES) + 2) * dt
    squares, expected = [], []
    for _ in range(20):
        size, phase = amplitude * rng.uniform(0.97, 1.03), rng.uniform(0.0, 6.28)
        clean = size * np.cos(2.0 * math.pi * t + phase) + rng.uniform(-0.5, 0.5)
        clean += 0.05 * size * np.cos(6.0 * math.pi * t + rng.uniform(0.0, 6.28))
        clean += noise * rng.standard_normal(t.size)
        rows = harmonics(np.round(clean), t, dt)
        off = (rows - harmonics(clean, t, dt)).mean(axis=0)[4:]
        squares.append(np.mean(np.abs(off) ** 2) / 2.0)
        scatter = math.sqrt(float(np.median(rows[:, 4:].var(axis=0))) / 2.0 * samples / 2.0)
        expected.append(rounding_error(1.0, np.ptp(clean), samples, CYCLES, scatter))
    return math.sqrt(np.mean(squares)), float(np.mean(expected))


@pytest.mark.parametrize("amplitude", [10.3, 50.7, 300.2, 1500.0])
@pytest.mark.parametrize("samples", [100.0, 100.37, 100.5, 353.3])
def test_the_error_is_that_of_signals_without_noise(amplitude, samples):
    found, expected = errors(amplitude, samples, 0.0)
    # 20 drawings of 17 harmonics, neighbours not independent; near-coincident phases of few steps are counted twice
    assert 0.7 * found < expected < 1.6 * found


def test_noise_of_half_a_step_makes_it_random():
    _, expected = errors(50.7, 100.0, 0.5)
    # e^{−2π²/4} of an amplitude of 0.04, beside 0.006 of rounding that scatters
    assert expected < 1e-3


def test_averaging_does_not_reduce_what_repeats():
    same = [rounding_error(1.0, 100.0, 100.0, cycles, 0.0) for cycles in (1, 10, 1000)]
    assert same == pytest.approx([math.sqrt(2.0 / 12.0 / 100.0)] * 3)
    assert rounding_error(1.0, 1e6, 100.37, 100, 0.0) == pytest.approx(same[0] / 10.0, rel=0.01)


def test_the_step_is_found_where_there_is_one():
    rng = np.random.default_rng(3)
    values = 0.3 + 0.01 * rng.standard_normal(4096)
    assert converter_step(values) == 0.0
    assert converter_step(2e-4 * np.round(values / 2e-4)) == pytest.approx(2e-4)
    assert converter_step(np.ones(100)) == 0.0
    assert rounding_error(0.0, 1.0, 100.0, 10, 0.1) == 0.0
