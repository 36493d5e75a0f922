"""Free decays: against closed forms and an independent integrator; their derivatives against differences, the products
of these against matrices, and climbs by them against SciPy's."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from blind.decays import clean, draw
from dampbalance import Oscillator, transient
from dampbalance.fit.climb import ClimbBounds, climb
from dampbalance.model import Parameters
from dampbalance.motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, run
from dampbalance.motion.free_decay import (
    DECAY_UNKNOWNS,
    contact_chord,
    decay_products,
    decay_samples,
    phase_slopes,
)
from dampbalance.motion.jit import interpreted
from dampbalance.motion.states import states_in_phases

M, K = 2.0, 800.0
PERIOD = 2.0 * math.pi * math.sqrt(M / K)
OFFSETS = 2
SIGMA = 5e-7


def motion(point: np.ndarray, until: float) -> tuple[np.ndarray, Parameters]:
    """Phases of the decay with these unknowns, the start state the last of them, and its oscillator."""
    F_k, c, rho, m = point[:4].tolist()
    x, v, w = point[-3:].tolist()
    par = Parameters(m, c, K, rho**-2, F_k, 0.0, 0.0)
    rows = np.empty((400, 5))
    count, *_ = run(x, v, (w - 1.0) * F_k * rho**2, 0.0, until, 0.0, par, rows)
    return rows[:count], par


def test_without_friction_it_is_a_damped_cosine():
    osc = Oscillator(m=2.0, c=0.8, k=500.0, K_z=5000.0, F_k=0.0)
    delta = osc.c / (2.0 * osc.m)
    omega = math.sqrt(osc.omega_n**2 - delta**2)
    t = np.linspace(0.0, 3.0, 400)
    x = 0.01 * np.exp(-delta * t) * (np.cos(omega * t) + delta / omega * np.sin(omega * t))
    found = transient(osc, None, 3.0, x=0.01).state(t)
    np.testing.assert_allclose(found.x, x, rtol=0, atol=1e-13)  # rounding of 0.01 over 24 radians


@pytest.mark.parametrize("index", [0, 2, 6, 11, 21])
def test_it_is_the_motion_of_an_integrator_of_another_make(index):
    decay = draw(index)
    osc = Oscillator(decay.m, decay.c, decay.k, decay.K_z, decay.F_k)
    signals, free = clean(decay)
    first = round(free[0] * decay.rate_hz)
    count = round(decay.lasts[0] * decay.rate_hz) - 1
    kind, size = decay.starts[0]
    start = {"x": size, "z": math.copysign(osc.Z_m, size)} if kind == "pluck" else {"v": size}
    t = np.arange(count) / decay.rate_hz
    found = transient(osc, None, t[-1] + 1.0, **start).state(t)
    truth = signals[:, first : first + count]
    # 8192 steps of order 2 to a cycle at the kinks of the contact
    for one, other in zip((found.x, found.v, found.acceleration), truth, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=3e-5 * np.abs(other).max())


def test_energy_between_turns_is_that_of_friction_and_damper():
    osc = Oscillator(m=1.0, c=0.0, k=400.0, K_z=4000.0, F_k=0.4)
    phases = transient(osc, None, 20.0, x=0.02, z=osc.Z_m).phases
    turns = phases[(phases[:, PHASE_V] == 0.0), PHASE_X]
    lost = 0.5 * osc.k * (turns[:-1] ** 2 - turns[1:] ** 2)
    travel = np.abs(np.diff(turns)) - 2.0 * osc.Z_m
    assert len(turns) > 5
    np.testing.assert_allclose(lost, osc.F_k * travel, rtol=1e-12)  # rounding


def test_a_mass_that_rings_on_its_contact_is_followed_at_once():
    # a million swings on the contact, which has too little energy to slip again
    osc = Oscillator(m=1.0, c=1e-3, k=100.0, K_z=1e10, F_k=1.0)
    path = transient(osc, None, 100.0, x=0.012, z=osc.Z_m)
    assert path.phases[-1, PHASE_S] == 0.0
    assert path.phases[-1, PHASE_T] < 1.0
    assert abs(path.state(100.0).z) <= osc.Z_m


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(
    ("F_k", "c", "stiffness", "x", "v", "w", "cycles"),
    [
        (0.2, 1.0, 30.0, 5e-3, 0.0, 1.7, 4.0),
        (0.2, 1.0, 3.0, 5e-3, 0.02, 0.4, 9.0),  # sticks at the end, and rings
        (0.2, 0.0, 300.0, -5e-3, -0.05, 1.0, 3.0),
        (0.02, 100.0, 30.0, 5e-3, 0.0, 1.5, 1.5),  # over-damped while it slips, ζ = 1.25
        (0.02, 80.0, 30.0, 5e-3, 0.0, 1.5, 1.5),  # critical
    ],
    ids=["slips", "rings", "undamped", "over-damped", "critical"],
)
def test_derivatives_are_those_of_differences(order, F_k, c, stiffness, x, v, w, cycles):
    """Off the samples between two events that a difference moves: there, accelerations have a jump in their slope."""
    point = np.array([F_k, c, (stiffness * K) ** -0.5, M, x, v, w])
    times = np.linspace(0.0, cycles * PERIOD, 401)[1:-1]
    phases, par = motion(point, times[-1])
    assert len(phases) > 1
    grid = times[0], times[1] - times[0], times.size
    found = decay_samples(grid, order, phases, phase_slopes(phases, w, par), par)
    expected = states_in_phases(times, phases, 0.0, par)[order]
    np.testing.assert_allclose(found[:, 0], expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    near = np.zeros(times.size, dtype=bool)
    for t in phases[1:, 0]:
        near |= np.abs(times - t) < 2e-4 * PERIOD
    assert near.mean() < 0.2
    sizes = np.array([F_k, max(c, 1.0), point[2], M, 5e-3, 0.1, 1.0])
    for j, name in enumerate(DECAY_UNKNOWNS):
        step = 1e-5 * sizes[j]
        sides = []
        for sign in (1.0, -1.0):
            moved = point.copy()
            moved[j] += sign * step
            there, other = motion(moved, times[-1])
            assert len(there) == len(phases)
            sides.append(states_in_phases(times, there, 0.0, other)[order])
        difference = (sides[0] - sides[1]) / (2.0 * step)
        scale = max(np.abs(difference).max(), 1e-9 * np.abs(expected).max() / sizes[j])
        # second differences, 1e-10 times a curvature of some tens; rounding, 1e-12 of the motion over 1e-5
        bound = 1e-6 * scale + 1e-7 * np.abs(expected).max() / sizes[j]
        assert np.abs(found[~near, j + 1] - difference[~near]).max() < bound, name


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
            [0, 0, 0, 0.0, dt, SIGMA, 0, n, last, 0],
            [0, 1, 1, 0.3 * dt, 1.7 * dt, 20.0 * SIGMA, n, n + n // 2, last, 0],
            [1, 2, 1, 0.0, dt, 400.0 * SIGMA, n + n // 2, 2 * n + n // 2, last, 0],
        ]
    )


def columns(point: np.ndarray, table: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Derivatives of all residuals by the unknowns, and the residuals, row by row from `decay_samples`."""
    whole = np.zeros((values.size, point.size + 1))
    for row in table:
        begin, end = int(row[6]), int(row[7])
        state = 4 + OFFSETS + 3 * int(row[0])
        of_decay = np.append(point[:4], point[state : state + 3])
        phases, par = motion(of_decay, 12.0 * PERIOD)
        derivatives = phase_slopes(phases, of_decay[-1], par)
        grid = row[3], row[4], end - begin
        part = decay_samples(grid, int(row[1]), phases, derivatives, par)
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


def open_bounds(size: int) -> ClimbBounds:
    """Bounds that only keep positive what is positive, and w between 0 and 2."""
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    lower[:4] = 1e-9, 0.0, 1e-6, 0.1
    lower[8::3], upper[8::3] = 0.0, 2.0
    scale = np.array([0.1, 0.1, 1e-4, M, 1e-3, 1e-2, *2 * [5e-3, 0.1, 1.0]])
    return ClimbBounds(np.ones(size, dtype=bool), lower, upper, scale)


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
