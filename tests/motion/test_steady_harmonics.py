"""The harmonics of steady orbits, against an integrator of another make, and limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.motion.orbit import NoSteadyOrbit

COUNT = 9
PAPER = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
MOTION = BaseMotion(0.006, 2.0 * math.pi * 4.92)
# far below resonance and lightly damped: several slips per half cycle
SEVERAL = Oscillator(m=2.42, c=4.0, k=2310.0, K_z=60000.0, F_k=2.0), BaseMotion(0.004, 7.0)


def test_they_add_up_to_the_motion_itself():
    """Over contacts from soft to stiff, in slip and stick: the energy of all harmonics is that of the velocity."""
    for osc, motion in [(PAPER, MOTION), SEVERAL, (replace(PAPER, K_z=1e9), MOTION)]:
        orbit, n = steady_orbit(osc, motion), np.arange(1, 800, 2)
        squares = np.abs(orbit.harmonics(n.size)) ** 2
        # x_n falls as n⁻³: the squares of n x_n beyond n leave n⁻³ or so
        assert math.pi * motion.omega * float(squares @ n**2) == pytest.approx(orbit.b, rel=1e-8)


def test_where_nothing_slips_there_is_one():
    osc = replace(PAPER, F_k=1e4)
    orbit = steady_orbit(osc, MOTION)
    assert orbit.regime is Regime.NO_SLIP
    x, omega = orbit.harmonics(3), MOTION.omega
    impedance = osc.k + osc.K_z - omega**2 * osc.m + 1j * omega * osc.c
    assert x[0] == pytest.approx(osc.k * MOTION.Y / impedance)
    assert not x[1:].any()


def test_an_orbit_that_takes_long_is_given_up_on_request():
    stiff = replace(SEVERAL[0], K_z=1e9), SEVERAL[1]
    with pytest.raises(NoSteadyOrbit):
        steady_orbit(*stiff, most_radians=1e4)  # half a cycle alone has 9,000
    # the closed form follows nothing
    assert steady_orbit(replace(PAPER, K_z=1e9), MOTION, most_radians=1e4).regime is Regime.ONE_SLIP
