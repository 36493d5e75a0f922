"""Turning points of motions with and without even harmonics, against a fine search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.signals.turning import Series, turning_points, upward_zero


def series(odd, even=(), variance=0.0) -> Series:
    """Odd and even harmonics, n = 1, 3, … and 2, 4, …, of one mean or of several, with a variance of each."""
    odd, even = (np.atleast_2d(np.array(of, dtype=np.complex128)) for of in (odd, even))
    n = np.concatenate([2.0 * np.arange(of.shape[1]) + 1.0 + i for i, of in enumerate((odd, even))])
    x = np.hstack([odd, np.resize(even, (len(odd), even.shape[1]))])
    return Series(n, x, np.full((1, n.size), variance))


def of_time(theta, motion):
    return (np.exp(1j * np.outer(theta, motion.n)) @ motion.x[0]).real


ODD = [np.exp(-0.7j), 0.15 * np.exp(2.0j), 0.04j]


@pytest.mark.parametrize("even", [(), (0.2j,), (0.1 + 0.2j, 0.05j)])
def test_half_the_range_and_the_middle_of_the_turning_points(even):
    motion, theta = series(ODD, even), np.linspace(0.0, 2.0 * math.pi, 200_001)
    x = of_time(theta, motion)
    at, X = turning_points(motion, rests=True)
    # a grid of 200,000 points misses a peak of curvature ~1 by (1.6e-5)²/2
    assert X[0] == pytest.approx(0.5 * np.ptp(x), abs=1e-9)
    turns = np.exp(1j * theta[[np.argmax(x), np.argmin(x)]]) * [1.0, -1.0]
    middle = np.sqrt(turns[0] * turns[1])
    middle = middle if (middle / turns[0]).real > 0.0 else -middle
    assert abs(np.exp(1j * at[0]) - middle) < 1e-4


def resting(part: float, count: int = 31) -> np.ndarray:
    """Harmonics of a motion between −1 and 1 that rests for a part of the cycle at each end, from its samples."""
    theta = (np.arange(1 << 14) + 0.5) / (1 << 14)
    along = np.clip((theta % 0.5) / (0.5 - part), 0.0, 1.0)
    x = np.where(theta < 0.5, 1.0, -1.0) * np.cos(math.pi * along)
    spectrum = 2.0 * np.fft.fft(x)[: count + 1] / x.size
    return (spectrum * np.exp(-0.5j * np.arange(count + 1) * 2.0 * math.pi / x.size))[1::2]


@pytest.mark.parametrize("part", [0.12, 0.35])
def test_the_level_of_a_rest_is_free_of_ringing_and_of_noise(part):
    odd, error = resting(part), 1e-3
    (at,), (level,) = turning_points(series(odd), rests=True)
    assert level == pytest.approx(1.0, abs=2e-5)  # 31 harmonics, beyond which lies 1e-4
    # it ends in the mean at the beginning of the cycle and begins a part of it before, on the grid of the search
    assert at % (2.0 * math.pi) == pytest.approx(2.0 * math.pi - math.pi * part, abs=0.02)
    assert turning_points(series(odd), rests=False)[1][0] > level
    noise = error * np.random.default_rng(2).standard_normal((400, 16, 2)).view(complex)[..., 0]
    drawn = series(odd + noise, variance=2.0 * error**2)
    levels, peaks = (turning_points(drawn, rests=flag)[1] for flag in (True, False))
    assert abs(levels.mean() - 1.0) < 4.0 * levels.std() / 20.0 + 2e-5  # 400 draws
    assert peaks.mean() - 1.0 > 10.0 * abs(levels.mean() - 1.0)  # what this is for


def test_squares_lose_the_variance_and_may_be_negative_and_a_peak_is_no_rest():
    assert series([2.0j, 0.1], variance=0.02).squares[0] == pytest.approx([3.98, -0.01])
    # the flattest peak that two harmonics make, 1.5 times as long near its end as a harmonic one
    for odd in ([1.0], [1.0, -1.0 / 9.0], [1.0, 0.1]):
        rests, peak = (turning_points(series(odd), rests=flag)[1][0] for flag in (True, False))
        # the mean over the middle half of what is within half a percent of the range
        assert rests == pytest.approx(peak, abs=2e-4 if len(odd) > 1 else 1e-12)


def test_replicates_with_many_harmonics_turn_and_cross_zero_where_a_fine_search_says():
    # a motion with corners of its acceleration, like those of a contact: x_n falls as n^−3 up to the 255th
    n, count = np.arange(1.0, 256.0, 2.0), 10
    scatter = 0.005 * np.random.default_rng(3).standard_normal((count, 3, 2)).view(complex)[..., 0]
    drawn = np.tile(np.exp(-1j * n * 0.4) * (1.0 + 0.3j * (n > 1.0)) / n**3, (count, 1))
    drawn[:, :3] += scatter / n[:3] ** 3
    at, X = turning_points(series(drawn), rests=False)
    zero = upward_zero(series(drawn, [0.3j]), -np.angle(drawn[:, 0]))  # of the odd ones alone
    for i, one in enumerate(drawn):
        rate = np.exp(1j * np.outer([at[i], zero[i]], n)) @ (1j * n * one)
        assert abs(rate[0].real) < 1e-9  # at rest, to what a step of 1e-9 leaves
        assert rate[1].real > 0.0
        grid = at[i] + np.linspace(-math.pi, math.pi, 4096, endpoint=False)
        assert of_time(grid, series(one)).max() <= X[i] + 1e-15 * n.size
        assert of_time(zero[i : i + 1], series(one))[0] == pytest.approx(0.0, abs=1e-12)
