"""One steady orbit, reached from everywhere, and the half-period map by which Newton's method finds it: README.md,
section 9."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from analytic.cases import SEVERAL_SLIPS, case, drawn
from dampbalance import Regime, steady_orbit, transient
from dampbalance.model import parameters
from dampbalance.motion.period_map import half_period_map
from dampbalance.motion.steady import MAX_PHASES

unit = st.floats(-1.0, 1.0)


def start_at(oscillator, motion, x, v, z):
    """An initial state from three numbers in [−1, 1], up to some times the motion that follows."""
    return {
        "x": 3.0 * motion.Y * x,
        "v": 3.0 * motion.Y * motion.omega * v,
        "z": oscillator.Z_m * z,
    }


@settings(max_examples=60)
@given(
    st.tuples(*drawn((1e-3, 4.0), (0.2, 3.0), (0.1, 1e3), (1e-3, 2.0))),
    st.tuples(unit, unit, unit),
    st.tuples(unit, unit, unit),
)
def test_two_motions_never_part(chosen, one, other):
    # d/dt [½mΔẋ² + ½kΔx² + ½K_zΔz²] = −cΔẋ² − (a term ≥ 0 while either slips)
    oscillator, motion = case(*chosen)
    end = 2.0 * motion.period
    first = transient(oscillator, motion, end, **start_at(oscillator, motion, *one))
    second = transient(oscillator, motion, end, **start_at(oscillator, motion, *other))
    t, o = np.linspace(0.0, end, 400), oscillator

    def energy_of(x, v, z):
        return 0.5 * (o.m * v**2 + o.k * x**2 + o.K_z * z**2)

    states = [np.array(path.state(t))[[0, 1, 3]] for path in (first, second)]
    energy = energy_of(*(states[1] - states[0]))
    # rounding of each state, measured by the energy of the motion itself
    size = energy_of(*states[0]).max() + energy_of(0.0, 0.0, o.Z_m)
    slack = 1e-12 * (energy[0] + math.sqrt(energy[0] * size)) + 1e-24 * size
    assert np.all(np.diff(energy) <= slack)


@settings(max_examples=25)
@given(
    st.tuples(*drawn((0.15, 2.0), (0.3, 2.0), (2.0, 300.0), (0.01, 0.5))),
    st.tuples(unit, unit, unit),
)
def test_every_start_leads_to_the_steady_orbit(chosen, start):
    oscillator, motion = case(*chosen)
    orbit = steady_orbit(oscillator, motion)
    assume(orbit.regime is not Regime.NO_SLIP)  # there, where the spring comes to rest is arbitrary
    end = 400.0 * motion.period  # where there is little slip, differences die slowly
    path = transient(oscillator, motion, end, **start_at(oscillator, motion, *start))
    t = end - motion.period * np.linspace(0.0, 1.0, 50)
    reached, expected = path.state(t), orbit.state(t)
    # of a thousand events, each with its rounding, and of that of ωt
    for name, size in (("x", orbit.X), ("v", motion.omega * orbit.X), ("z", orbit.X)):
        off = getattr(reached, name) - getattr(expected, name)
        assert np.abs(off).max() < 1e-10 * size


def some_states(oscillator, motion):
    """States (x, ẋ, z) and base phases θ of a motion on the way to the steady orbit, and of the orbit amid a stick."""
    path, orbit = (
        transient(oscillator, motion, 3.0 * motion.period, x=motion.Y),
        steady_orbit(oscillator, motion),
    )
    times = np.random.default_rng(5).uniform(0.0, path.end, 12)
    amid = orbit.t_1 + 0.5 * orbit.t_s
    states = np.column_stack([path.state(times), orbit.state(amid)])
    return states[[0, 1, 3]].T, motion.omega * np.append(times, amid)


@pytest.mark.parametrize(
    "numbers", [(0.1, 0.8, 2.0, 0.6), (2.0, 0.7, 30.0, 0.1), *[*SEVERAL_SLIPS][::3]]
)
def test_the_map_is_half_a_period_of_motion_and_its_derivative_a_difference(numbers):
    oscillator, motion = case(*numbers)
    size = motion.Y * np.array([1.0, motion.omega, 1.0])
    scale = np.append(size[:2], oscillator.Z_m)

    def image(state, theta):
        phases, jacobian = np.empty((MAX_PHASES, 5)), np.empty((3, 3))
        par = parameters(oscillator, motion)
        count, *after = half_period_map(*state, theta, par, phases, jacobian)
        assert count > 0
        return np.array(after) / size, jacobian * scale / size[:, None]

    for state, theta in zip(*some_states(oscillator, motion), strict=True):
        after, jacobian = image(state, theta)
        given = dict(zip("xvz", state.tolist(), strict=True))
        start, end = np.array([0.0, 0.5 * motion.period]) + theta / motion.omega
        path = transient(oscillator, motion, end, **given, start=start)
        reached = np.array(path.state(end))[[0, 1, 3]] / size
        # rounding of ωt, and that of some ten events
        np.testing.assert_allclose(after, reached, atol=1e-11)
        for j in range(3):
            # a step inward: z has an end to either side
            step = 1e-9 * (-1.0 if state[j] > 0.0 else 1.0)
            moved, _ = image(state + step * scale * np.eye(3)[j], theta)
            # One-sided difference: the step, 1e-9, times second derivatives, which are large where a slip onset is slow
            # (some 1e3), and rounding, 1e-15 over the step. z is measured by Y, like x.
            np.testing.assert_allclose((moved - after) / step, jacobian[:, j], rtol=1e-5, atol=1e-5)
    assert np.abs(jacobian[2]).max() > 0.0  # the last state ends amid a stick, where z moves with x
