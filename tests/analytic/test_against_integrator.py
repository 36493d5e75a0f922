"""Steady orbits and transients in every regime against a stick/slip state machine on DOP853: README.md, section 3."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.cases import SEVERAL_SLIPS, case
from analytic.integrator import integrate
from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit, transient
from dampbalance.motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X

# DOP853 is asked for 1e-12 a step and takes a few hundred steps a period; events are found on its dense output, of
# order 7. Measured: below 1e-12 on states and times, 2e-12 on the integrals.
TOLERANCE = 1e-11

CASES = {
    (0.6, 1.0, 90.0, 0.14): Regime.ONE_SLIP,
    (6.0, 2.0, 10.0, 0.02): Regime.ONE_SLIP,  # both phases over-damped
    (0.0, 0.5, 3.0, 0.79): Regime.ONE_SLIP,  # no viscous damping
    (0.3, 1.2, 0.5, 2.0): Regime.NO_SLIP,
    (0.05, 1.25, 1.0, 1.5): Regime.ONE_SLIP,  # F_k > kY: it slips by resonance
    (0.4, 0.8, 10.0, 0.0): Regime.NO_FRICTION,
} | dict.fromkeys([*SEVERAL_SLIPS][::3], Regime.SEVERAL_SLIPS)


@pytest.mark.parametrize("numbers", CASES, ids=str)
def test_steady_orbit_is_periodic_and_has_its_integrals(numbers):
    oscillator, motion = case(*numbers)
    orbit = steady_orbit(oscillator, motion)
    assert orbit.regime is CASES[numbers]
    scale, speed = orbit.X, motion.omega * orbit.X

    # integrate one period from the reversal at −X
    z = float(orbit.state(orbit.t_1).z)
    run = integrate(oscillator, motion, motion.period, -orbit.X, 0.0, z, orbit.theta)
    assert run.x == pytest.approx(-orbit.X, rel=0, abs=TOLERANCE * scale)
    assert run.v == pytest.approx(0.0, abs=TOLERANCE * speed)
    assert run.peak <= orbit.X * (1.0 + TOLERANCE)
    assert run.b == pytest.approx(orbit.b, rel=TOLERANCE)
    assert pytest.approx(orbit.W, rel=TOLERANCE) == run.W
    if oscillator.F_k == 0.0:
        return  # without a contact, whether the contact slips is a manner of speaking
    assert run.a == pytest.approx(orbit.a, rel=TOLERANCE)

    # the pattern, and each event of the first half cycle
    inner = len(orbit.phases) - 1
    assert len(run.events) in (2 * inner + 1, 2 * inner + 2) if inner else not run.events
    rows = orbit.phases[1:, [PHASE_T, PHASE_S, PHASE_X, PHASE_V]]
    for event, row in zip(run.events, rows, strict=False):
        off = np.abs(row - event)
        assert np.all(off <= TOLERANCE * np.array([motion.period, 0.0, scale, speed]))


def assert_same_path(path, run, size, late=TOLERANCE):
    """A transient and a run pass the same events, in the same states."""
    motion = path.motion
    times, states, x, v = np.array(run.events).T
    rows = path.phases[1:]
    assert rows[:, PHASE_S].tolist() == states.tolist()
    since = rows[:, PHASE_T] - path.phases[0, PHASE_T]
    np.testing.assert_allclose(since, times, rtol=0, atol=late * motion.period)
    np.testing.assert_allclose(rows[:, PHASE_X], x, rtol=0, atol=late * size)
    np.testing.assert_allclose(rows[:, PHASE_V], v, rtol=0, atol=late * size * motion.omega)
    end = path.state(path.end)
    assert [end.x, end.z] == pytest.approx([run.x, run.z], rel=0, abs=late * size)


@pytest.mark.parametrize("seed", range(4))
def test_transient_from_a_random_state(seed):
    rng = np.random.default_rng(seed)
    numbers = 10 ** rng.uniform([-2.0, -0.5, 0.0, -1.5], [0.3, 0.4, 2.0, -0.3])
    oscillator, motion = case(*numbers.tolist())
    x, v = motion.Y * rng.uniform(-5, 5), motion.Y * motion.omega * rng.uniform(-5, 5)
    start = {"x": x, "v": v, "z": oscillator.Z_m * rng.uniform(-1, 1)}
    end = 3.0 * motion.period
    run = integrate(oscillator, motion, end, **start)
    assert_same_path(transient(oscillator, motion, end, **start), run, 5.0 * motion.Y)


def test_transient_that_overstretches_the_spring_for_a_moment():
    # a soft contact and a small friction force: between 0.02 and 0.16 rad the spring is at its limit, then lets go and
    # soon reaches the other limit; seen from steps of 0.3 rad only the other limit is ever exceeded
    oscillator, motion = case(1.0, 1.0, 1.0, math.exp(-5.0))
    start = {"x": -3.0 * motion.Y, "v": -0.375 * motion.Y * motion.omega}
    end = 0.5 * motion.period
    run = integrate(oscillator, motion, end, **start, step=0.01)
    assert [event[1] for event in run.events[:3]] == [-1, 0, 1]
    assert_same_path(transient(oscillator, motion, end, **start), run, 3.0 * motion.Y)


def test_transient_that_only_just_reaches_the_limit_of_the_spring():
    # ẋ dips below zero from t = 0.086 to 0.114 s, so z passes a maximum, of which Z_m is just short. Within a single
    # step of the search the velocity has the same sign at both ends, and z is beyond Z_m at the later one.
    v, a, jerk = 0.0049, -0.1, 1.0  # at the start: ẋ = v + a t + jerk t²/2 + …
    k = K_z = 0.5
    first_turn = 0.086
    highest = v * first_turn + a * first_turn**2 / 2.0 + jerk * first_turn**3 / 6.0
    motion = BaseMotion(Y=(jerk + v) / k, omega=1.0)
    oscillator = Oscillator(m=1.0, c=0.0, k=k, K_z=K_z, F_k=K_z * (highest - 1e-6))
    state, start, end = {"x": -a / k, "v": v, "z": 0.0}, -0.5 * math.pi, 0.3
    run = integrate(oscillator, motion, end, **state, theta=start, step=1e-3)
    times = [event[0] for event in run.events]
    assert times[0] < first_turn < times[1]  # it slips before the turn, and a moment later sticks
    path = transient(oscillator, motion, start + end, **state, start=start)
    # the velocity is some 1e-4 of its later size where it changes sign: times lose as many digits
    assert_same_path(path, run, motion.Y, late=2e-10)
