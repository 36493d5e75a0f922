"""One steady orbit, reached from everywhere: the theorem behind `motion/period_map.py` (README.md, section 9)."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from analytic.cases import case, drawn
from dampbalance import Regime, steady_orbit, transient

unit = st.floats(-1.0, 1.0)


def start_at(oscillator, motion, x, v, z):
    """An initial state from three numbers in [−1, 1], up to some times the motion that follows."""
    return {
        "x": 3.0 * motion.Y * x,
        "v": 3.0 * motion.Y * motion.omega * v,
        "z": oscillator.Z_m * z,
    }


def energy_of_difference(oscillator, first, second):
    dx, dv, dz = first.x - second.x, first.v - second.v, first.z - second.z
    o = oscillator
    return 0.5 * (o.m * dv**2 + o.k * dx**2 + o.K_z * dz**2)


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
    t = np.linspace(0.0, end, 400)
    energy = energy_of_difference(oscillator, first.state(t), second.state(t))
    # rounding of each state, measured by the energy of the motion itself
    state = first.state(t)
    size = 0.5 * (oscillator.m * state.v**2 + oscillator.k * state.x**2).max()
    size += 0.5 * oscillator.K_z * oscillator.Z_m**2
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
