"""The products of decays' derivatives and residuals against those of matrices, and climbs by them against SciPy's."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from dampbalance.model import Parameters
from dampbalance.motion.climb import Bounds, climb
from dampbalance.motion.events import run
from dampbalance.motion.free_decay import (
    contact_chord,
    decay_products,
    decay_samples,
    phase_slopes,
)
from dampbalance.motion.jit import interpreted

M, K = 2.0, 800.0
PERIOD = 2.0 * math.pi * math.sqrt(M / K)
OFFSETS = 2
SIGMA = 5e-7


def numbers(c: float = 0.6) -> np.ndarray:
    """F_k, c, ρ, m, two offsets, and the start states of two decays."""
    states = [5e-3, 0.0, 1.7, -4e-3, 0.02, 0.6]
    return np.array([0.2, c, (30.0 * K) ** -0.5, M, 1e-4, -2e-3, *states])


def channels(n: int = 300) -> np.ndarray:
    """Displacement and velocity of the first decay, the latter sampled later, and acceleration of the second."""
    dt = 6.0 * PERIOD / n
    last = (n - 1) * dt
    return np.array(
        [
            [0, 0, 0, 0.0, dt, SIGMA, 0, n, last],
            [0, 1, 1, 0.3 * dt, 1.7 * dt, 20.0 * SIGMA, n, n + n // 2, last],
            [1, 2, 1, 0.0, dt, 400.0 * SIGMA, n + n // 2, 2 * n + n // 2, last],
        ]
    )


def columns(point: np.ndarray, table: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Derivatives of all residuals by the unknowns, and the residuals, row by row from `decay_samples`."""
    whole = np.zeros((values.size, point.size + 1))
    F_k, c, rho, m = point[:4].tolist()
    par = Parameters(m, c, K, rho**-2, F_k, 0.0, 0.0)
    for row in table:
        begin, end = int(row[6]), int(row[7])
        state = 4 + OFFSETS + 3 * int(row[0])
        x, v, w = point[state : state + 3].tolist()
        rows = np.empty((400, 5))
        count, *_ = run(x, v, (w - 1.0) * F_k * rho**2, 0.0, 12.0 * PERIOD, 0.0, par, rows)
        phases = rows[:count]
        grid = row[3], row[4], end - begin
        part = decay_samples(grid, int(row[1]), phases, phase_slopes(phases, w, par), par)
        block, offset = whole[begin:end], 4 + int(row[2])
        block[:, :4] = part[:, 1:5]
        block[:, state : state + 3] = part[:, 5:8]
        block[:, offset] = 1.0
        block[:, -1] = part[:, 0] + point[offset] - values[begin:end]
        block /= row[5]
    return whole


def noisy(point: np.ndarray, table: np.ndarray) -> np.ndarray:
    """Samples of the decays with white noise of the channels' size."""
    count = int(table[-1, 7])
    sigma = np.repeat(table[:, 5], (table[:, 7] - table[:, 6]).astype(int))
    exact = columns(point, table, np.zeros(count))[:, -1] * sigma
    return exact + sigma * np.random.default_rng(3).standard_normal(count)


def evaluation(table: np.ndarray, values: np.ndarray):
    """The products at a point, as a climb takes them."""
    rows = np.empty((400, 5))
    return lambda point, out: decay_products(point, K, OFFSETS, table, values, rows, out)


def open_bounds(size: int) -> Bounds:
    """Bounds that only keep positive what is positive, and w between 0 and 2."""
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    lower[:4] = 1e-9, 0.0, 1e-6, 0.1
    lower[8::3], upper[8::3] = 0.0, 2.0
    scale = np.array([0.1, 0.1, 1e-4, M, 1e-3, 1e-2, *2 * [5e-3, 0.1, 1.0]])
    return Bounds(np.ones(size, dtype=bool), lower, upper, scale)


# slip phases above the critical damping, 80 N s/m, take the responses without a rotation
@pytest.mark.parametrize("c", [0.6, 100.0], ids=["under-damped", "over-damped"])
def test_products_are_those_of_the_derivatives(c):
    point, table = numbers(c), channels()
    values = noisy(numbers(), table)
    expected = columns(point, table, values)
    expected = expected.T @ expected
    found = np.empty_like(expected)
    assert evaluation(table, values)(point, found)
    # a rotation by a few hundred samples loses a few hundred roundings
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(
        found / scale / scale[:, None], expected / scale / scale[:, None], rtol=0, atol=1e-11
    )


def test_close_to_a_rigid_contact_the_slope_by_rho_is_a_chord():
    """There x depends on ρ²: ∂x/∂ρ = 2ρ ∂x/∂(ρ²), and (2ρ + h) ∂x/∂(ρ²) over a step h."""
    point, table = numbers(), channels()
    point[2] = (1e6 * K) ** -0.5
    values = noisy(numbers(), table)
    exact = columns(point, table, values)
    found = np.empty((point.size + 1, point.size + 1))
    assert evaluation(table, values)(point, found)
    step = contact_chord(point[2], K)
    assert step > point[2]
    assert contact_chord((1e3 * K) ** -0.5, K) == 0.0
    expected = (exact[:, 2] @ exact[:, 2]) * (1.0 + 0.5 * step / point[2]) ** 2
    assert found[2, 2] == pytest.approx(expected, rel=1e-9)


def test_a_climb_ends_where_that_of_scipy_does():
    truth, table = numbers(), channels()
    values = noisy(truth, table)
    start = truth * np.array([1.01, 0.95, 0.99, 1.0005, *4 * [1.0, 1.0]])
    bounds = open_bounds(truth.size)
    end = climb(evaluation(table, values), start, bounds, gain=1e-9, most=60)
    point, reached = end.point, end.products
    assert 3 < end.evaluations < 60
    other = least_squares(
        lambda p: columns(p, table, values)[:, -1],
        point,
        lambda p: columns(p, table, values)[:, :-1],
        x_scale=np.maximum(np.abs(truth), bounds.scale),
        bounds=(bounds.lower, bounds.upper),
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    # what a full step must promise, and kinks where an event passes a sample
    assert reached[-1, -1] < 2.0 * other.cost + 1e-6
    errors = np.sqrt(np.diag(np.linalg.inv(reached[:-1, :-1])))
    assert (np.abs(point - other.x) < 1e-3 * errors).all()
    assert (np.abs(point - truth) < 4.0 * errors).all()


def test_interpreted_they_are_the_same():
    truth, table = numbers(), channels(40)
    values = noisy(truth, table)
    compiled, again = np.empty((2, truth.size + 1, truth.size + 1))
    assert evaluation(table, values)(truth, compiled)
    with interpreted():
        assert evaluation(table, values)(truth, again)
    # sines and fused products may round otherwise
    scale = np.sqrt(np.diag(compiled))
    scale = np.outer(scale, scale)
    np.testing.assert_allclose(again / scale, compiled / scale, rtol=0, atol=1e-11)


def test_a_start_that_is_no_number_has_no_products():
    truth, table = numbers(), channels(40)
    values, found = noisy(truth, table), np.empty((truth.size + 1, truth.size + 1))
    truth[4 + OFFSETS] = np.nan
    assert not evaluation(table, values)(truth, found)
