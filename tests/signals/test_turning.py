"""Turning points of motions with and without even harmonics, against a fine search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.signals.turning import Series, turning_points, upward_zero


def series(first: int, *harmonics: complex) -> Series:
    """Harmonics first, first + 2, … of one mean, without noise."""
    n = first + 2.0 * np.arange(len(harmonics))
    return Series(
        n, np.array([harmonics], dtype=np.complex128).reshape(1, -1), np.zeros((1, n.size))
    )


def both(odd: Series, even: Series) -> Series:
    """A motion of the odd and the even harmonics."""
    variance = np.concatenate([odd.variance, even.variance], axis=1)
    return Series(np.concatenate([odd.n, even.n]), np.hstack([odd.x, even.x]), variance)


def row(of: Series, i: int) -> Series:
    """One mean of several."""
    return Series(of.n, of.x[i : i + 1], of.variance)


ODD = series(1, 1.0 * np.exp(-0.7j), 0.15 * np.exp(2.0j), 0.04j)


def of_time(theta, *parts):
    return sum((np.exp(1j * np.outer(theta, p.n)) @ p.x[0]).real for p in parts)


@pytest.mark.parametrize("even", [series(2), series(2, 0.2j), series(2, 0.1 + 0.2j, 0.05j)])
def test_half_the_range_and_the_middle_of_the_turning_points(even):
    theta = np.linspace(0.0, 2.0 * math.pi, 2_000_001)
    x = of_time(theta, ODD, even)
    at, X = turning_points(both(ODD, even), rests=True)
    # a grid of two million points misses a peak of curvature ~1 by (1.6e-6)²/2
    assert X[0] == pytest.approx(0.5 * np.ptp(x), abs=1e-11)
    turns = np.exp(1j * theta[[np.argmax(x), np.argmin(x)]]) * [1.0, -1.0]
    middle = np.sqrt(turns[0] * turns[1])
    middle = middle if (middle / turns[0]).real > 0.0 else -middle
    assert abs(np.exp(1j * at[0]) - middle) < 1e-5


def test_each_mean_has_its_own():
    many = Series(ODD.n, ODD.x * np.array([[1.0], [2.0], [1.5]]), ODD.variance)
    even = Series(np.array([2.0]), np.array([[0.1j], [0.2j], [-0.1]]), np.zeros((1, 1)))
    motion = both(many, even)
    at, X = turning_points(motion, rests=True)
    for i in range(3):
        one = turning_points(row(motion, i), rests=True)
        assert (at[i], X[i]) == pytest.approx((one[0][0], one[1][0]), abs=1e-9)


def resting(part: float, count: int = 31) -> Series:
    """Harmonics of a motion between −1 and 1 that rests for a part of the cycle at each end, from its samples."""
    theta = (np.arange(1 << 14) + 0.5) / (1 << 14)
    along = np.clip((theta % 0.5) / (0.5 - part), 0.0, 1.0)
    x = np.where(theta < 0.5, 1.0, -1.0) * np.cos(math.pi * along)
    spectrum = 2.0 * np.fft.fft(x)[: count + 1] / x.size
    spectrum *= np.exp(-0.5j * np.arange(count + 1) * 2.0 * math.pi / x.size)
    return series(1, *spectrum[1::2])


@pytest.mark.parametrize("part", [0.12, 0.2, 0.35])
def test_the_level_of_a_rest_is_free_of_ringing_and_of_noise(part):
    odd = resting(part)
    _, level = turning_points(odd, rests=True)
    _, highest = turning_points(odd, rests=False)
    assert level[0] == pytest.approx(1.0, abs=2e-5)  # 31 harmonics, beyond which lies 1e-4
    rng, error = np.random.default_rng(2), 1e-3
    noise = error * (rng.standard_normal((400, 16)) + 1j * rng.standard_normal((400, 16)))
    drawn = [Series(odd.n, odd.x + one, np.full((1, 16), 2.0 * error**2)) for one in noise]
    levels = np.array([turning_points(one, rests=True)[1][0] for one in drawn])
    peaks = np.array([turning_points(one, rests=False)[1][0] for one in drawn])
    assert abs(levels.mean() - 1.0) < 4.0 * levels.std() / 20.0 + 2e-5  # 400 draws
    assert peaks.mean() - 1.0 > 10.0 * abs(levels.mean() - 1.0)  # what this is for
    assert highest[0] > level[0]


def test_a_peak_is_no_rest():
    # the flattest peak that two harmonics make, 1.5 times as long near its end as a harmonic one
    for odd in (series(1, 1.0), series(1, 1.0, -1.0 / 9.0), series(1, 1.0, 0.1)):
        rests, peak = (turning_points(odd, rests=flag)[1][0] for flag in (True, False))
        # the mean over the middle half of what is within half a percent of the range
        assert rests == pytest.approx(peak, abs=2e-4)
    _, X = turning_points(series(1, 1.0), rests=True)
    assert X[0] == pytest.approx(1.0, abs=1e-12)


def test_the_upward_zero_is_that_of_the_odd_harmonics():
    at = upward_zero(ODD, np.array([0.7]))
    assert of_time(at, ODD)[0] == pytest.approx(0.0, abs=1e-12)
    assert of_time(at + 1e-3, ODD)[0] > 0.0


def test_replicates_with_many_harmonics_turn_and_cross_zero_where_a_fine_search_says():
    # a motion with corners of its acceleration, like those of a contact: x_n falls as n^−3 up to the 255th
    n = np.arange(1.0, 256.0, 2.0)
    rng = np.random.default_rng(3)
    x = np.exp(-1j * n * 0.4) * (1.0 + 0.3j * (n > 1.0)) / n**3
    scatter = 0.005 * (rng.standard_normal((40, 3)) + 1j * rng.standard_normal((40, 3)))
    drawn = np.tile(x, (40, 1))
    drawn[:, :3] += scatter / n[:3] ** 3
    many = Series(n, drawn, np.zeros((1, n.size)))
    at, X = turning_points(many, rests=False)
    zero = upward_zero(many, -np.angle(drawn[:, 0]))
    for i in range(40):
        rate = np.exp(1j * np.outer([at[i], zero[i]], n)) @ (1j * n * drawn[i])
        assert abs(rate[0].real) < 1e-9  # at rest, to what a step of 1e-9 leaves
        grid = at[i] + np.linspace(-math.pi, math.pi, 4096, endpoint=False)
        one = row(many, i)
        assert of_time(grid, one).max() <= X[i] + 1e-15 * n.size
        assert of_time(zero[i : i + 1], one)[0] == pytest.approx(0.0, abs=1e-12)
        assert rate[1].real > 0.0


def test_squares_lose_the_variance_and_may_be_negative():
    some = Series(np.array([1.0, 3.0]), np.array([[2.0j, 0.1]]), np.array([1.0, 0.02]))
    assert some.squares[0] == pytest.approx([3.0, -0.01])
