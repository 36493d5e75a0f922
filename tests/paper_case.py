"""The paper's oscillator, frequencies and levels, entered once for all tests; as printed, not configured."""

from __future__ import annotations

import math

from dampbalance import BaseMotion, Orbit, Oscillator, steady_orbit
from dampbalance.features import Features, of_orbit, stack

PAPER = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
LEVELS = (0.004, 0.006, 0.008, 0.010, 0.012)  # m
# near, below and above the resonance
FREQUENCIES_HZ = {"omega1": 4.92, "omega2": 3.5, "omega3": 11.1}
PAIRS = [(0, 1), (1, 2), (2, 3), (3, 4), (0, 4)]  # of levels, as in Table 3
NEAR = FREQUENCIES_HZ["omega1"]
OMEGA = 2.0 * math.pi * NEAR


def motions_at(hertz=NEAR, levels=LEVELS) -> list[BaseMotion]:
    """The base at these levels."""
    return [BaseMotion(Y=Y, omega=2.0 * math.pi * hertz) for Y in levels]


def orbits_at(hertz=NEAR, levels=LEVELS, osc=PAPER) -> list[Orbit]:
    """The steady orbits at these levels."""
    return [steady_orbit(osc, motion) for motion in motions_at(hertz, levels)]


def features_at(hertz=NEAR, levels=LEVELS, osc=PAPER) -> Features:
    """The features of the steady orbits at these levels."""
    return stack([of_orbit(orbit) for orbit in orbits_at(hertz, levels, osc)])
