"""Motion with long stops, by an integrator that shares nothing with the package: a rigid friction contact whose force
may differ with the direction and along the way, under a base of any harmonics.

    m x″ + c_r (x′ − y′) + k (x − y) + F(x) sgn x′ = 0,   F = F₊(1 + s x) forward, F₋(1 + s x) back

The mass stays where it stops as long as |k (x − y) − c_r y′| is no more than the F of the direction it is pushed in.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp

_MOST_PERIODS = 2000
_TIGHT = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-15}


@dataclass(frozen=True)
class Stopping:
    """An oscillator and its base, SI.   base : n → y_n of y = Re Σ y_n e^{inωt}.   slope : s, 1/m."""

    m: float = 3.08
    k: float = 1191.0
    c_r: float = 0.669
    forward: float = 1.0
    back: float = 1.0
    slope: float = 0.0
    omega: float = 2.0 * math.pi
    base: dict[int, complex] = field(default_factory=lambda: {1: 1.82e-3}, hash=False)

    def y(self, t, order=0):
        """The base displacement, or its derivative of that order."""
        exp, total = (cmath.exp if isinstance(t, float) else np.exp), 0.0
        for n, y in self.base.items():
            rate = 1j * n * self.omega
            total = total + (rate**order * y * exp(rate * t)).real
        return total

    def friction(self, x, sign):
        """Friction force against motion in that direction, N."""
        return sign * (self.forward if sign > 0.0 else self.back) * (1.0 + self.slope * x)

    def push(self, t, x, v):
        """Force of spring and damper on the mass, N."""
        return self.k * (self.y(t) - x) + self.c_r * (self.y(t, 1) - v)


@dataclass(frozen=True)
class Steady:
    """One period of the steady motion. x(t) at any times; integrals over the period: travel ∮|ẋ| dt, b = ∮ẋ² dt,
    relative = ∮ẏẋ dt, W = ∮kyẋ dt; stopped : part of the period at rest; range : x_max − x_min."""

    of: Stopping
    pieces: tuple
    travel: float
    b: float
    relative: float
    W: float
    stopped: float
    range: float

    def x(self, t):
        """Displacement at the times t, m."""
        period = 2.0 * math.pi / self.of.omega
        start = self.pieces[0][0]
        local = start + (np.asarray(t, dtype=float) - start) % period
        inside = [(local >= begin) & (local <= end) for begin, end, _ in self.pieces]
        return np.piecewise(local, inside, [motion for _, _, motion in self.pieces])


@cache  # tests draw the noise of many records of one motion
def steady(of: Stopping) -> Steady:
    """The first period from rest that repeats the one before."""
    period = 2.0 * math.pi / of.omega
    state, sign = np.zeros(8), 0.0
    for _ in range(_MOST_PERIODS):
        before = state.copy()
        state, sign, pieces = _period(of, state, sign, period)
        if np.all(np.abs(state - before)[:2] < [1e-12, 1e-11]):
            break
    else:
        raise ArithmeticError(f"no steady motion of {of}")
    travel, b, relative, W, rubbed, stopped = state[2:] - before[2:]
    lost = rubbed + of.c_r * (b - relative)
    assert abs(lost / W - 1.0) < 1e-7, f"W = {W} J, lost = {lost} J"
    # turning points are ends of pieces
    ends = [pieces[0][2](pieces[0][0]), *(float(motion(end)) for _, end, motion in pieces)]
    return Steady(of, pieces, travel, b, relative, W, stopped / period, max(ends) - min(ends))


def _period(of: Stopping, state, sign: float, period: float):
    """State and direction after a period, and its pieces (from, to, x or its interpolant)."""
    t, pieces = 0.0, []
    while t < period - 1e-12:
        begin = t
        if sign == 0.0:
            t, sign = _released(of, state[0], t, period)
            state = state + np.array([0.0] * 7 + [t - begin])
            pieces.append((begin, t, lambda at, x=state[0]: np.full_like(at, x)))
            continue

        def rate(t, s, sign=sign):
            x, v = s[:2].tolist()
            y, w, friction = of.y(t), of.y(t, 1), of.friction(x, sign)
            a = (of.k * (y - x) + of.c_r * (w - v) - friction) / of.m
            return [v, a, abs(v), v * v, w * v, of.k * y * v, friction * v, 0.0]

        def still(t, s, sign=sign):
            return sign * s[1]

        still.terminal, still.direction = True, -1.0
        more = {"events": still, "dense_output": True, "max_step": period / 50}
        run = solve_ivp(rate, (t, period), state, **more, **_TIGHT)
        t, state = float(run.t[-1]), run.y[:, -1].copy()
        pieces.append((begin, t, lambda at, of=run.sol: of(at)[0]))
        if run.status == 1:
            state[1] = 0.0
            sign = _direction(of, state[0], t)
    return state, sign, tuple(pieces)


def _direction(of: Stopping, x: float, t: float) -> float:
    """Where the mass goes from rest; 0 where it stays."""
    push = of.push(t, x, 0.0)
    return next((s for s in (1.0, -1.0) if s * (push - of.friction(x, s)) > 0.0), 0.0)


def _released(of: Stopping, x: float, t: float, period: float) -> tuple[float, float]:
    """When a stop ends, at the end of the period at the latest, and where the mass goes then; 0 where it stays."""
    grid = np.linspace(t, period, 2001)
    push = of.push(grid, x, 0.0)
    free = np.flatnonzero((push > of.friction(x, 1.0)) | (push < of.friction(x, -1.0)))
    if not free.size:
        return period, 0.0
    low, high = grid[max(free[0] - 1, 0)], grid[free[0]]
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _direction(of, x, middle) else (middle, high)
    return high, _direction(of, x, high)
