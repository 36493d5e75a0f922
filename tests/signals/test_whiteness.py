"""Tests of a residual for white noise: they let noise pass as often as they say, and see motions slow and fast."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.signals.bursts import noise_of
from dampbalance.signals.whiteness import (
    averages,
    chance_of_averages,
    chance_of_lines,
    excess_over_noise,
)

SIZE, WIDTH = 4000, 16


def chances(left: np.ndarray) -> list[float]:
    """Of averages and of lines."""
    return [chance_of_averages([left], [WIDTH], 0), chance_of_lines([left])]


def noise(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(SIZE)


def test_noise_is_unlikely_as_seldom_as_a_chance_says_and_rounding_never():
    """Of 400 drawings 20 below 5 %, at most 33 within three standard deviations; both bounds are not sharp."""
    drawn = np.array([chances(noise(seed)) for seed in range(400)])
    few = np.count_nonzero(drawn < 0.05, axis=0)
    assert np.all((few >= 2) & (few <= 33))
    assert drawn.min() > 1e-4
    # of a record without noise, in units of the least noise that is assumed
    assert min(chances(1e-3 * np.sin(0.01 * np.arange(SIZE)))) > 0.5


# A motion of a tenth of the noise's variance: of 100 samples a cycle, of a cycle in each average and of 3.7 samples.
@pytest.mark.parametrize(("per_cycle", "averaged"), [(100.0, True), (16.0, True), (3.7, False)])
def test_a_motion_shows_whatever_its_frequency(per_cycle, averaged):
    left = noise(1) + np.sqrt(0.2) * np.sin(2.0 * np.pi / per_cycle * np.arange(SIZE))
    assert [chance < 1e-4 for chance in chances(left)] == [averaged, True]


def test_averages_over_one_cycle_miss_what_shorter_ones_see():
    left = noise(2) + 0.5 * np.sin(2.0 * np.pi / WIDTH * np.arange(SIZE))
    assert averages([left], [WIDTH], 0)[0] < 1.2  # white noise gives 1 ± 0.1
    ratio, first, rest = averages([left, left], [WIDTH // 2, WIDTH // 2], 4)
    assert ratio > 1.5
    assert (first, rest) == (2 * SIZE // 8 - 4, 2 * SIZE - 2 * SIZE // 8)
    # averages ±2, each of two samples ±1 about it: 16/2 over 4/2
    assert averages([np.array([3.0, 1.0, -1.0, -3.0])], [2], 0) == (4.0, 2, 2)


def test_the_chance_of_a_line_of_a_short_residual_is_that_of_fisher():
    turn = 2.0 * np.pi * np.arange(10) / 10
    # of four lines, one with 80 % of the power: 4 (1 − 0.8)³
    assert chance_of_lines([2.0 * np.cos(turn) + np.cos(2.0 * turn)]) == pytest.approx(0.032)


@pytest.mark.parametrize("digits", [0.0, 0.02], ids=["real", "digitised"])
def test_a_residual_louder_than_the_samples_is_named(digits):
    """A decay with ringing that a fit has not caught: its residual is 5.3 times the noise of the samples."""
    t = np.linspace(0.0, 40.0, SIZE)
    samples = np.exp(-0.1 * t) * np.cos(6.0 * t) + 0.01 * noise(3)
    samples = digits * np.round(samples / digits) if digits else samples
    own, left = noise_of(samples), noise(4)
    assert own < 0.02 if digits else own == pytest.approx(0.01, rel=0.25)
    assert excess_over_noise(left, samples, 0.01) == 1.0
    assert excess_over_noise(left, samples, 0.053) == pytest.approx(0.053 / own, rel=0.05)
    assert excess_over_noise(left[:100], samples[:100], 0.053) == 1.0  # too few to tell
