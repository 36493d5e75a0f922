"""Turning points of motions with and without even harmonics, against a fine search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.reading.turning import Series, turning_points, upward_zero


def series(first: int, *harmonics: complex) -> Series:
    """Harmonics first, first + 2, … of one mean, without noise."""
    n = first + 2.0 * np.arange(len(harmonics))
    return Series(n, np.array([harmonics], dtype=np.complex128).reshape(1, -1), np.zeros(n.size))


ODD = series(1, 1.0 * np.exp(-0.7j), 0.15 * np.exp(2.0j), 0.04j)


def of_time(theta, *parts):
    return sum((np.exp(1j * np.outer(theta, p.n)) @ p.x[0]).real for p in parts)


@pytest.mark.parametrize("even", [series(2), series(2, 0.2j), series(2, 0.1 + 0.2j, 0.05j)])
def test_half_the_range_and_the_middle_of_the_turning_points(even):
    theta = np.linspace(0.0, 2.0 * math.pi, 2_000_001)
    x = of_time(theta, ODD, even)
    at, X = turning_points(ODD, even)
    # a grid of two million points misses a peak of curvature ~1 by (1.6e-6)²/2
    assert X[0] == pytest.approx(0.5 * np.ptp(x), abs=1e-11)
    turns = np.exp(1j * theta[[np.argmax(x), np.argmin(x)]]) * [1.0, -1.0]
    middle = np.sqrt(turns[0] * turns[1])
    middle = middle if (middle / turns[0]).real > 0.0 else -middle
    assert abs(np.exp(1j * at[0]) - middle) < 1e-5


def test_each_mean_has_its_own():
    many = Series(ODD.n, ODD.x * np.array([[1.0], [2.0], [1.5]]), ODD.variance)
    even = Series(np.array([2.0]), np.array([[0.1j], [0.2j], [-0.1]]), np.zeros(1))
    at, X = turning_points(many, even)
    for i in range(3):
        one = turning_points(
            Series(many.n, many.x[i : i + 1], many.variance),
            Series(even.n, even.x[i : i + 1], even.variance),
        )
        assert (at[i], X[i]) == pytest.approx((one[0][0], one[1][0]), abs=1e-9)


def test_the_upward_zero_is_that_of_the_odd_harmonics():
    at = upward_zero(ODD, np.array([0.7]))
    assert of_time(at, ODD)[0] == pytest.approx(0.0, abs=1e-12)
    assert of_time(at + 1e-3, ODD)[0] > 0.0


def test_squares_lose_the_variance_and_may_be_negative():
    some = Series(np.array([1.0, 3.0]), np.array([[2.0j, 0.1]]), np.array([1.0, 0.02]))
    assert some.squares[0] == pytest.approx([3.0, -0.01])
