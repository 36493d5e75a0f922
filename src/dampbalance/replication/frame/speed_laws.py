"""How the friction force depends on the speed in slip: laws fitted to the loop of a record, to compare by prediction.

    constant      F = F_k
    linear        F = F_0 + F_1 |ẋ|
    logarithmic   F = F_0 + a ln(u/V) + b ln(c + V/u),   u = |ẋ| + ε,   F(0) = F_s

All of them do the work of F_k over the way slid, so that the energy balance holds for each; what is left of them comes
from the shape of the loop, by least squares where the mass slides well away from its stops.

The contact is rigid and rubs on a wall that stands still, so that F_1|ẋ| sgn ẋ = F_1ẋ is a viscous damper between mass
and ground: the term c of a damping law (`law/terms.py`). One amplitude gives one row of the balance, which tells
F_0 a + F_1 b; only the shape of the loop, or a second amplitude, tells the two apart.

The logarithmic law, its V and its ε are those that the authors of the records fit to the force and velocity that their
model infers (their script `switching_GPLFM_main.m`), with the static force F_s from the ends of the rests.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from .measured_loop import Loop

_V, _LEAST = 3e-3, 1e-6  # m/s: V and ε
_LARGEST = (0.1, 0.1)  # a, N, and c: the authors' bounds
_START = (0.04, 0.02)


@dataclass(frozen=True)
class SpeedLaw:
    """The friction force, N, as a function of the speed, m/s, which may be an array; what the mass must overcome to
    leave a rest is its value at zero.   coefficients : by the names of columns, with units."""

    force: Callable[[Array], Array]
    coefficients: Mapping[str, float]


def constant(loop: Loop, F_k: float) -> SpeedLaw:
    """F = F_k."""
    return SpeedLaw(lambda speed: F_k + 0.0 * speed, {"F_k_N": F_k})


def linear(loop: Loop, F_k: float) -> SpeedLaw:
    """F = F_0 + F_1|ẋ|.

    F_0 = F_k − F_1 ∮ẋ² dt/∮|ẋ| dt by the work, and F_1 by least squares.
    """
    speed, force, path = _slipping(loop)
    of_path = float(path @ np.abs(loop.v))
    x = speed - of_path
    F_1 = float(x @ (force - F_k) / (x @ x))
    F_0 = F_k - F_1 * of_path
    return SpeedLaw(lambda v: F_0 + F_1 * v, {"F_0_N": F_0, "F_1_N_s_per_m": F_1})


def logarithmic(loop: Loop, F_k: float) -> SpeedLaw:
    """The authors' form: F_0 and b by the work and by the static force, a and c by least squares in their bounds."""
    from scipy.optimize import least_squares  # slow to import

    speed, force, path = _slipping(loop)
    F_s = static_force(loop)

    def shapes(v: Array, c: float) -> tuple[Array, Array]:
        u = v + _LEAST
        return np.log(u / _V), np.log(c + _V / u)

    def solved(a: float, c: float) -> tuple[float, float]:
        (log, late), (log_0, late_0) = shapes(np.abs(loop.v), c), shapes(np.zeros(1), c)
        mean, mean_late = float(path @ log), float(path @ late)
        b = (F_k - F_s - a * (mean - float(log_0[0]))) / (mean_late - float(late_0[0]))
        return F_k - a * mean - b * mean_late, b

    def law(a: float, c: float) -> SpeedLaw:
        F_0, b = solved(a, c)

        def at(v: Array) -> Array:
            log, late = shapes(v, c)
            return F_0 + a * log + b * late

        return SpeedLaw(at, {"F_0_N": F_0, "F_s_N": F_s, "a_N": a, "b_N": b, "c": c})

    def off(p: Array) -> Array:
        return law(*p.tolist()).force(speed) - force

    bounds = ((0.0, 0.0), _LARGEST)
    return law(*least_squares(off, _START, bounds=bounds, x_scale=_LARGEST).x.tolist())


SPEED_LAWS: Mapping[str, Callable[[Loop, float], SpeedLaw]] = {
    "constant": constant,
    "linear": linear,
    "logarithmic": logarithmic,
}
"""Name → the law fitted to a loop, given F_k, the friction force that does its work."""


def static_force(loop: Loop) -> float:
    """The force at the ends of the rests, from which the mass leaves in either direction, N, in the mean of both."""
    forces = []
    for sign in (1.0, -1.0):
        on = np.flatnonzero(loop.sliding & (sign * loop.v > 0.0))
        gaps = np.diff(on, append=on[0] + loop.v.size)
        first = int(on[(int(np.argmax(gaps)) + 1) % on.size])  # after the longest time without slip
        before = (first - np.arange(loop.v.size)) % loop.v.size
        left = before[np.argmax(loop.at_rest[before])]
        forces.append(sign * float(loop.force[left]))
    return math.fsum(forces) / len(forces)


def _slipping(loop: Loop) -> tuple[Array, Array, Array]:
    """Speed and force against the motion where the mass slides, (s,), and the share of each point of the cycle in the
    way slid, (p,)."""
    speed, on = np.abs(loop.v), loop.sliding
    path = np.where(loop.at_rest, 0.0, speed)
    return speed[on], (np.sign(loop.v) * loop.force)[on], path / path.sum()
