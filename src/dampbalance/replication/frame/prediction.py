"""The displacement that an identified law predicts under a measured base motion, for cycles held out of the fit.

The contact is rigid, the limit of a stiff one: the mass slides against ∓F(|ẋ|), and where it comes to rest it stays
until

    |k(y − x + d) − Σ p_j h_j(0, ẏ)| > F(0),

d the difference of the zeros of the two transducers. The ends of slip are events of scipy's DOP853, those of rest are
roots of the push; the base between samples is a cubic spline through them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from ...arrays import Array
from .measured_loop import viscous

_RTOL, _ATOL = 1e-9, 1e-13


@dataclass(frozen=True)
class Mass:
    """The mass with its spring and damping, in SI.

    friction : friction force F, N, at a speed, m/s.
    damping : coefficients of the other terms, by symbol.
    zero : the difference d of the transducers' zeros, m.
    """

    m: float
    k: float
    friction: Callable[[Array], Array]
    damping: Mapping[str, float]
    zero: float = 0.0


def predicted(mass: Mass, t: Array, y: Array, x: float, v: float, omega: float) -> Array:
    """Displacement at the times t under the base y measured there, m, (n,), from x and v at the first of them.

    t : s, increasing.   y : m.   x, v : m, m/s.   omega : drive frequency, rad/s.
    """
    base = CubicSpline(t, y)
    speed = base.derivative()
    out = np.full(t.size, np.nan)
    now, end = float(t[0]), float(t[-1])
    at_rest = float(mass.friction(np.asarray(0.0)))

    def push(at: float, x: float, v: float) -> float:
        of_terms = viscous(mass.damping, np.asarray(v), speed(at), mass.k, omega)
        return float(mass.k * (base(at) - x + mass.zero) - of_terms)

    sign = float(np.sign(v))
    while now < end:
        if sign == 0.0:
            last = _released(at_rest, partial(push, x=x, v=0.0), t[t > now], now)
            out[(t >= now) & (t <= last)] = x
            sign, now = float(np.sign(push(last, x, 0.0))), last
            continue

        def rate(at: float, state: Array, sign: float = sign) -> list[float]:
            x, v = state.tolist()
            force = push(at, x, v) - sign * float(mass.friction(np.asarray(abs(v))))
            return [v, force / mass.m]

        def still(at: float, state: Array, sign: float = sign) -> float:
            return sign * float(state[1])

        still.terminal, still.direction = True, -1.0  # type: ignore[attr-defined]
        run = solve_ivp(
            rate,
            (now, end),
            [x, v],
            method="DOP853",
            events=still,
            dense_output=True,
            rtol=_RTOL,
            atol=_ATOL,
        )
        assert run.sol is not None
        last = float(run.t[-1])
        inside = (t >= now) & (t <= last)
        out[inside] = run.sol(t[inside])[0]
        x, v, sign, now = float(run.y[0, -1]), 0.0, 0.0, last
    return out


def _released(F: float, push: Callable[[float], float], times: Array, now: float) -> float:
    """When a rest that began `now` ends: where the push first exceeds F, at the last time at the latest."""
    before = now
    for at in [now, *times.tolist()]:
        if abs(push(at)) > F:
            return before if at == now else float(brentq(lambda t: abs(push(t)) - F, before, at))
        before = at
    return before
