"""The half-period map and its derivative, by which Newton's method finds orbits: README.md, section 9."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.cases import SEVERAL_SLIPS, case
from dampbalance import State, steady_orbit, transient
from dampbalance.model import parameters
from dampbalance.motion.period_map import half_period_map
from dampbalance.motion.steady import MAX_PHASES

CASES = [(0.6, 1.0, 90.0, 0.14), (0.1, 0.8, 2.0, 0.6), (2.0, 0.7, 30.0, 0.1)]
CASES += [*SEVERAL_SLIPS][::3]
PHASES = np.empty((MAX_PHASES, 5))


def image(numbers, state, theta):
    oscillator, motion = case(*numbers)
    jacobian = np.empty((3, 3))
    par = parameters(oscillator, motion)
    count, *after = half_period_map(*state, theta, par, PHASES, jacobian)
    assert count > 0
    return np.array(after), jacobian


def some_states(numbers):
    """States (x, ẋ, z) and base phases θ of a motion on the way to the steady orbit, and of the orbit amid a stick."""
    oscillator, motion = case(*numbers)
    rng = np.random.default_rng(5)
    path = transient(oscillator, motion, 3.0 * motion.period, x=motion.Y)
    orbit = steady_orbit(oscillator, motion)
    t = np.append(rng.uniform(0.0, path.end, 12), orbit.t_1 + 0.5 * orbit.t_s)
    state = State(
        *(
            np.append(before[:-1], after[-1])
            for before, after in zip(path.state(np.abs(t)), orbit.state(t), strict=True)
        )
    )
    return np.column_stack([state.x, state.v, state.z]), motion.omega * t


@pytest.mark.parametrize("numbers", CASES, ids=str)
def test_the_map_is_half_a_period_of_motion_and_its_derivative_a_difference(numbers):
    oscillator, motion = case(*numbers)
    size = motion.Y * np.array([1.0, motion.omega, 1.0])
    scale = np.append(size[:2], oscillator.Z_m)
    checked = 0
    for state, theta in zip(*some_states(numbers), strict=True):
        after, jacobian = image(numbers, state, theta)
        x, v, z = state.tolist()
        start, end = np.array([0.0, 0.5 * motion.period]) + theta / motion.omega
        path = transient(oscillator, motion, end, x=x, v=v, z=z, start=start)
        reached = np.array(path.state(end))[[0, 1, 3]]
        # rounding of ωt, and that of some ten events
        np.testing.assert_allclose(after / size, reached / size, atol=1e-11)
        for j in range(3):
            step = np.zeros(3)
            step[j] = 1e-9 * scale[j]
            # a step inward: z has an end to either side
            direction = -1.0 if state[j] > 0.0 else 1.0
            moved, _ = image(numbers, state + direction * step, theta)
            quotient = direction * (moved - after) / step[j]
            # One-sided difference: the step, 1e-9, times second derivatives, which are large where a slip onset is slow
            # (some 1e3), and rounding, 1e-15 over the step. z is measured by Y, like x.
            found, expected = jacobian[:, j] * scale[j] / size, quotient * scale[j] / size
            np.testing.assert_allclose(expected, found, rtol=1e-5, atol=1e-5)
            checked += np.abs(jacobian[2, j]) > 0.0
    assert checked > 0  # the last state, at least, ends amid a stick, where z moves with x
