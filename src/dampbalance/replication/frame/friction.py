"""The friction force against the displacement, from records; laws of friction and speed fitted to it.

    f = k(y − x) − mẍ − Σ p_j h_j(ẋ, ẏ)

of the mean cycle, from its harmonics. Each displacement transducer has an unknown zero, and so has f: it is chosen so
that friction does the same work in both directions. A true difference between them cannot be separated from it.

    constant      F = F_k
    linear        F = F_0 + F_1 |ẋ|
    logarithmic   F = F_0 + a ln(u/V) + b ln(c + V/u),   u = |ẋ| + ε,   F(0) = F_s

All of them do the work of F_k over the way slid, so that the energy balance holds for each; what is left of them comes
from the shape of the loop, by least squares where the mass slides well away from its stops.

The contact is rigid, the limit of a stiff one, and rubs on a wall that stands still, so that F_1|ẋ| sgn ẋ = F_1ẋ is a
viscous damper between mass and ground: the term c of a damping law (`law/terms.py`). One amplitude gives one row of the
balance, which determines F_0 a + F_1 b; only the shape of the loop, or a second amplitude, separates the two.

The logarithmic law, its V and its ε are those that the authors of the records fit to the force and velocity that their
model infers (their script `switching_GPLFM_main.m`), with the static force F_s from the ends of the rests.

In a prediction of held-out cycles the mass slides against ∓F(|ẋ|), and where it comes to rest it stays until

    |k(y − x + d) − Σ p_j h_j(0, ẏ)| > F(0),

d the difference of the zeros of the two transducers. The ends of slip are events of scipy's DOP853, those of rest are
roots of the push; the base between samples is a cubic spline through them.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, least_squares

from ...arrays import Array, Mask
from ...law.terms import KNOWN_TERMS
from ...likelihood.mean_harmonics import Means, Reading

_POINTS = 4096  # of a cycle
AT_REST = 0.02
"""Share of the largest speed below which the mass counts as at rest: 31 harmonics do not resolve less."""

_SLIDING = 0.25  # of the largest speed: above it neither the onset nor the end of slip plays a part
# a pass takes a sixth of a second: slower ones are trends
_RIPPLES_HZ = np.linspace(8.0, 30.0, 221)


@dataclass(frozen=True, eq=False)
class Loop:
    """Displacement, velocity and friction force over the mean cycle at equal steps of phase; m, m/s, N, (p,).

    level : N, that was taken off the force.   omega : rad/s.   X : half the range of x, m.
    """

    omega: float
    x: Array
    v: Array
    force: Array
    level: float

    @property
    def X(self) -> float:
        """Half the way from the lowest to the highest point, m."""
        return 0.5 * float(np.ptp(self.x))

    @property
    def at_rest(self) -> Mask:
        """Where the mass stands."""
        return np.abs(self.v) < AT_REST * np.abs(self.v).max()

    @property
    def sliding(self) -> Mask:
        """Where it slides, well away from the ends of slip."""
        return np.abs(self.v) > _SLIDING * np.abs(self.v).max()


def friction_loop(
    reading: Reading, m: float, damping: Mapping[str, float], mean: Means | None = None
) -> Loop:
    """The loop of the mean cycle of a record.

    m : kg.   damping : coefficients of terms other than friction, SI.   mean : of some cycles; default, of all.
    """
    steady, mean = reading.steady, reading.mean if mean is None else mean
    series = reading.series(mean)
    n, x_n = series.n, series.x[0]
    y_n = np.concatenate([mean.Y, mean.base[0]])
    theta = np.linspace(0.0, 2.0 * math.pi, _POINTS, endpoint=False)

    def derivatives(count: int, n: Array, x: Array) -> list[Array]:  # of Re Σ x_n e^{inθ}, by time
        turns, rates = np.exp(1j * np.outer(theta, n)), 1j * n * steady.omega
        return [(turns @ (rates**order * x)).real for order in range(count)]

    x, v, acceleration = derivatives(3, n, x_n)
    y, w = derivatives(2, np.arange(1.0, y_n.size + 1.0), y_n)
    force = steady.k * (y - x) - m * acceleration
    force = force - viscous(damping, v, w, steady.k, steady.omega)
    level = float(np.sum(force * np.abs(v)) / np.sum(np.abs(v)))
    return Loop(steady.omega, x, v, force - level, level)


def viscous(
    damping: Mapping[str, float], v: Array | float, w: Array | float, k: float, omega: float
) -> Array | float:
    """Σ p_j h_j, N, of the velocities v of the mass and w of the base, m/s."""
    of_terms: Array | float = 0.0
    for symbol, p in damping.items():
        force = KNOWN_TERMS[symbol].force
        if force is not None:
            of_terms = of_terms + p * force(v, w, k, omega)
    return of_terms


def shape(loop: Loop, F_k: float) -> dict[str, float | list[float]]:
    """How the loop departs from that of a contact of constant friction force F_k, N.

    Where the mass slides, well away from its stops: `rms`, `highest` and `lowest` of |f|/F_k − 1, the first per length;
    `along` and `speed`, by how much it changes from one end to the other and from rest to the largest speed, by least
    squares; `ripple_hz`, the frequency that, next to a constant in each direction, explains most of it, with its
    amplitude `ripple` and the `explained` share of the mean square. `part_at_rest` of the cycle is spent at rest;
    `given_way_m`: by how far the mass moves there, at the lower and at the upper stop, while the force grows by 2F_k,
    by least squares; an elastic contact gives way by 2F_k/K_z.
    """
    slid = np.abs(loop.v)
    off = np.sign(loop.v) * loop.force / F_k - 1.0
    on = loop.sliding
    ends = np.column_stack([np.ones(on.sum()), loop.x[on] / loop.X, slid[on] / slid.max()])
    _, along, speed = np.linalg.lstsq(ends, off[on])[0]
    frequency, amplitude, explained = _ripple(loop, off)
    stops = [loop.at_rest & (sign * loop.x > 0.0) for sign in (-1.0, 1.0)]
    return {
        "rms": math.sqrt(float(np.sum(off[on] ** 2 * slid[on]) / np.sum(slid[on]))),
        "highest": float(off[on].max()),
        "lowest": float(off[on].min()),
        "along": 2.0 * float(along),
        "speed": float(speed),
        "ripple_hz": frequency,
        "ripple": amplitude,
        "explained": explained,
        "part_at_rest": float(np.mean(loop.at_rest)),
        "given_way_m": [
            2.0 * F_k * float(np.polynomial.polynomial.polyfit(loop.force[at], loop.x[at], 1)[1])
            for at in stops
        ],
    }


def _ripple(loop: Loop, off: Array) -> tuple[float, float, float]:
    """Frequency, Hz, amplitude and share of the mean square of the oscillation that explains `off` best in slip."""
    t = np.arange(loop.x.size) * (2.0 * math.pi / loop.omega / loop.x.size)
    best = (math.nan, 0.0, 0.0)
    # the two directions, each with a separate phase
    passes = [loop.sliding & (sign * loop.v > 0.0) for sign in (1.0, -1.0)]
    total = math.fsum(float(np.sum((off[on] - off[on].mean()) ** 2)) for on in passes)
    for hz in _RIPPLES_HZ:
        left, square = 0.0, 0.0
        for on in passes:
            angle = 2.0 * math.pi * hz * t[on]
            columns = np.column_stack([np.ones(angle.size), np.cos(angle), np.sin(angle)])
            fit = np.linalg.lstsq(columns, off[on])[0]
            left += float(np.sum((off[on] - columns @ fit) ** 2))
            square += float(fit[1] ** 2 + fit[2] ** 2)
        if (explained := 1.0 - left / total) > best[2]:
            best = (float(hz), math.sqrt(square / len(passes)), explained)
    return best


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
    speed, force, path = _slipping(loop)
    F_s = static_force(loop)

    def law(a: float, c: float) -> SpeedLaw:
        def shapes(v: Array) -> tuple[Array, Array]:
            u = v + _LEAST
            return np.log(u / _V), np.log(c + _V / u)

        (log, late), (log_0, late_0) = shapes(np.abs(loop.v)), shapes(np.zeros(1))
        mean, mean_late = float(path @ log), float(path @ late)
        b = (F_k - F_s - a * (mean - float(log_0[0]))) / (mean_late - float(late_0[0]))
        F_0 = F_k - a * mean - b * mean_late

        def at(v: Array) -> Array:
            log, late = shapes(v)
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


_METHOD: Mapping[str, Any] = {"method": "DOP853", "rtol": 1e-7, "atol": 1e-11}


@dataclass(frozen=True)
class Mass:
    """The mass with its spring and damping, in SI.

    friction : friction force F, N, at a speed, m/s.
    damping : coefficients of the other terms, by symbol.
    zero : the difference d of the transducers' zeros, m.
    """

    m: float
    k: float
    friction: Callable[[Any], Any]
    damping: Mapping[str, float]
    zero: float = 0.0


def predicted(mass: Mass, t: Array, y: Array, x: float, v: float, omega: float) -> Array:
    """Displacement at the times t under the base y measured there, m, (n,), from x and v at the first of them.

    t : s, increasing.   y : m.   x, v : m, m/s.   omega : drive frequency, rad/s.
    """
    base = CubicSpline(t, y)
    speed, knots, pieces = base.derivative(), t.tolist(), base.c.T.tolist()
    out = np.full(t.size, np.nan)
    now, end = float(t[0]), float(t[-1])
    at_rest = float(mass.friction(0.0))

    def push(y: Any, w: Any, x: float, v: float = 0.0) -> Any:
        return mass.k * (y - x + mass.zero) - viscous(mass.damping, v, w, mass.k, omega)

    def pushed(at: float, x: float, v: float = 0.0) -> float:
        # a call of the spline takes as long as ten of these
        i = max(bisect_left(knots, at) - 1, 0)
        since, (a, b, c, d) = at - knots[i], pieces[i]
        y, w = ((a * since + b) * since + c) * since + d, (3.0 * a * since + 2.0 * b) * since + c
        return float(push(y, w, x, v))

    def over(at: float, x: float) -> float:
        return abs(pushed(at, x)) - at_rest

    def rate(at: float, state: Array, sign: float) -> tuple[float, float]:
        x, v = state.tolist()
        return v, (pushed(at, x, v) - sign * float(mass.friction(abs(v)))) / mass.m

    def still(at: float, state: Array, sign: float) -> float:
        return sign * float(state[1])

    end_of_slip: Any = still  # as SciPy marks an event that ends the integration
    end_of_slip.terminal, end_of_slip.direction = True, -1.0
    sign = float(np.sign(v))
    while now < end:
        if sign == 0.0:  # at rest until the push first exceeds the friction
            ahead = np.append(now, t[t > now])
            free = np.flatnonzero(np.abs(push(base(ahead), speed(ahead), x)) > at_rest)
            last = float(ahead[free[0]]) if free.size else end
            if free.size and free[0] > 0:
                last = float(brentq(over, ahead[free[0] - 1], last, args=(x,)))
            out[(t >= now) & (t <= last)] = x
            sign, now = float(np.sign(pushed(last, x))), last
            continue
        run = solve_ivp(
            rate, (now, end), [x, v], events=end_of_slip, args=(sign,), dense_output=True, **_METHOD
        )
        assert run.sol is not None
        last = float(run.t[-1])
        inside = (t >= now) & (t <= last)
        out[inside] = run.sol(t[inside])[0]
        x, v, sign, now = float(run.y[0, -1]), 0.0, 0.0, last
    return out
