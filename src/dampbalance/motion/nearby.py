"""The steady orbit of an oscillator from that of another nearby, for searches that try one after the other.

An orbit with several slips per half cycle is its own mirror image half a period later,

    −Φ_θ(x, 0, −Z_m) = (x, 0, −Z_m),      x = −X and θ of the reversal there.

Newton's method in these two, from those of the other orbit, takes three or four half periods where
`dampbalance.motion.steady` takes a dozen from rest. A change of θ moves the start and the end along the motion,

    ∂Φ/∂θ = (f_1 − DΦ f_0)/ω,      f = (ẋ, ẍ, ż) at the end and at the start.

The half-period map never expands, so that its fixed points are a convex set: one at which Newton's method converges is
the only one.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..model import BaseMotion, Oscillator, Parameters, parameters
from .events import MOST_RADIANS, PHASE_T, PHASE_X
from .orbit import Orbit, steady_orbit
from .period_map import half_period_map
from .regime import Regime
from .steady import NO_CLOSED_FORM, solve_closed

_MOST_MAPS = 8


def steady_orbit_near(
    oscillator: Oscillator,
    motion: BaseMotion,
    near: Orbit | None,
    *,
    most_radians: float = MOST_RADIANS,
) -> Orbit:
    """Return `steady_orbit`, to rounding, of an oscillator that differs little from that of an orbit `near`: several
    times faster where both slip more than once in a half cycle. One that is far away, or None, costs little time."""
    if near is not None and near.regime is Regime.SEVERAL_SLIPS:
        # phases of half a cycle
        par, phases = parameters(oscillator, motion), np.empty((256, 5))
        fastest = max(math.sqrt((par.k + par.K_z) / par.m), par.c / par.m, par.omega)
        few = _MOST_MAPS * math.pi * fastest <= most_radians * par.omega
        if few and solve_closed(par, phases)[0] == NO_CLOSED_FORM:
            count, theta = _follow(par, phases, near)
            if count:
                regime = Regime.ONE_SLIP if count == 2 else Regime.SEVERAL_SLIPS
                return Orbit(oscillator, motion, regime, theta, phases[:count].copy())
    return steady_orbit(oscillator, motion, most_radians=most_radians)


def _follow(par: Parameters, phases: Array, near: Orbit) -> tuple[int, float]:
    """Return (number of phases, θ) of the orbit by Newton's method from the reversal of another; `phases` receives its
    half cycle. The number is 0 where that leads to no orbit, or to a reversal that is not its farthest."""
    x, theta, before = float(near.phases[0, PHASE_X]), near.theta, math.inf
    half, Z_m, D = math.pi / par.omega, par.F_k / par.K_z, np.empty((3, 3))
    for _ in range(_MOST_MAPS):
        count, x1, v1, z1 = half_period_map(x, 0.0, -Z_m, theta, par, phases, D)
        off, size = _size(x + x1, v1, z1 - Z_m, par), _size(x, 0.0, Z_m, par)
        helps = count > 0 and off < 0.5 * before
        # as in `period_map`
        if off <= (1e-14 if helps else 1e-12) * size:
            # as in `steady`
            while count > 1 and half - phases[count - 1, PHASE_T] < 1e-12 * half:
                count -= 1
            farthest = np.abs(phases[:count, PHASE_X]).max(initial=0.0) <= -x
            return (count if farthest else 0), theta
        if not helps:
            break
        before = off
        drive = par.k * par.Y * math.cos(theta)
        a = (drive - par.k * x + par.F_k) / par.m
        a1 = -(drive + par.k * x1 + par.c * v1 + par.K_z * z1) / par.m
        p, q = 1.0 + D[0, 0], (v1 - D[0, 1] * a) / par.omega
        r, s = D[1, 0], (a1 - D[1, 1] * a) / par.omega
        det = p * s - q * r
        if det == 0.0:
            break
        x, theta = x - (s * (x + x1) - q * v1) / det, theta - (p * v1 - r * (x + x1)) / det
    return 0, theta


def _size(x: float, v: float, z: float, par: Parameters) -> float:
    return math.sqrt(par.k * x * x + par.m * v * v + par.K_z * z * z)
