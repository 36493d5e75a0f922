"""Derivatives of free decays, against differences of exact motions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.model import Parameters
from dampbalance.motion.events import run
from dampbalance.motion.free_decay import UNKNOWNS, decay_samples, phase_slopes
from dampbalance.motion.states import states_in_phases

M, K, PERIOD = 2.0, 800.0, 2.0 * math.pi * math.sqrt(2.0 / 800.0)


def motion(point: np.ndarray, until: float) -> tuple[np.ndarray, Parameters]:
    """Phases of the decay with these unknowns, and its oscillator."""
    F_k, c, rho, m, x, v, w = point.tolist()
    par = Parameters(m, c, K, rho**-2, F_k, 0.0, 0.0)
    rows = np.empty((200, 5))
    count, *_ = run(x, v, (w - 1.0) * F_k * rho**2, 0.0, until, 0.0, par, rows)
    return rows[:count], par


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
    for j, name in enumerate(UNKNOWNS):
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
