"""Oscillators that several test modules share, by their four dimensionless numbers."""

from __future__ import annotations

import math

from hypothesis import strategies as st
from scipy.stats import qmc

from dampbalance import BaseMotion, Oscillator, steady_orbit
from paper_case import FREQUENCIES_HZ, LEVELS, PAPER, motions_at

PAPER_MOTIONS = [motion for hertz in FREQUENCIES_HZ.values() for motion in motions_at(hertz)]


def case(zeta, r, K, F):
    """The oscillator with ζ, ω/ω_n = r, K_z/k = K and F_k/kY = F, on the mass, stiffness and amplitude of the paper."""
    m, k, Y = PAPER.m, PAPER.k, LEVELS[0]
    oscillator = Oscillator(m=m, c=2.0 * zeta * math.sqrt(k * m), k=k, K_z=K * k, F_k=F * k * Y)
    return oscillator, BaseMotion(Y=Y, omega=r * math.sqrt(k / m))


def orbit_of(m, c, k, K_z, F_k, Y, omega):
    """The steady orbit of one case in the arguments of `steady_orbits`."""
    return steady_orbit(Oscillator(m, c, k, K_z, F_k), BaseMotion(Y, omega))


def spread(n, seed, *ranges):
    """n points (a power of 2) that fill the box of the ranges evenly by their logarithms; one array per range."""
    columns = qmc.Sobol(len(ranges), seed=seed).random(n).T
    return [low * (high / low) ** u for u, (low, high) in zip(columns, ranges, strict=True)]


def drawn(*ranges):
    """Strategies of hypothesis: numbers between the ends of each range, spread by their logarithms."""
    return [st.floats(math.log(low), math.log(high)).map(math.exp) for low, high in ranges]


def dimensions(zeta, r, K, F):
    """The same as keyword arguments of `steady_orbits` with m = k = Y = 1; the four numbers may be arrays."""
    return {"m": 1.0, "c": 2.0 * zeta, "k": 1.0, "K_z": K, "F_k": F, "Y": 1.0, "omega": r}


# Several slip onsets per half cycle: (ζ, ω/ω_n, K_z/k, F_k/kY), number of phases of the half cycle.
SEVERAL_SLIPS = {
    (0.04417, 0.4204, 21.1, 0.4329): 4,
    (0.288, 0.4085, 131.7, 0.4648): 4,
    (0.02377, 0.3433, 132.3, 0.03655): 6,
    (0.06701, 0.348, 24.12, 0.1335): 8,
    (0.02, 0.31, 70.0, 0.34): 8,
    (0.02036, 0.3119, 254.3, 0.07134): 12,
    (2.625, 4.362, 2.505e4, 0.8762): 4,  # over-damped in slip
}
