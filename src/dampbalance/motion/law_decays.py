"""Free decays under damping and springs that are not linear, with their derivatives.

    m ẍ + c ẋ + c_2 |ẋ| ẋ + c_3 ẋ³ + c_a |ẋ| + k x + k_2 x² + k_3 x³ + f = 0,   ḟ = K_z ẋ within |f| ≤ F_k

The base is at rest. The linear part of a phase is followed by its exact flow, the rest by the Runge–Kutta method of
order 4 in the frame of that flow (Lawson 1967): where only F_k and c act, the motion is exact. Derivatives follow the
linearised equations; x, ẋ and their derivatives are continuous at events, since the force of the contact is.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..arrays import Array
from ..model import Parameters
from .events import contact_state
from .flow import step_response
from .jit import jit
from .unknowns import F_K, OSCILLATOR_UNKNOWNS, RHO, C, M

ADDED = ("c_2", "c_3", "c_a", "k_2", "k_3", "gradual")
"""Coefficients of what is not linear: N s²/m², N s³/m³, N s/m, N/m², N/m³, and how much of `rounding` the force of the
contact has, by which only derivatives are taken: it stays zero."""

_FIRST_ADDED = len(OSCILLATOR_UNKNOWNS)
_START_X, _START_V, _START_PRELOAD = range(_FIRST_ADDED + len(ADDED), _FIRST_ADDED + len(ADDED) + 3)
_COUNT = _START_PRELOAD + 1
_RADIANS = 0.3  # of a phase that a step takes at the most: derivatives are then exact to 1e-5
_NEWTONS = 20
_REACHED = 1e-13  # of a step: an event is located
_MOST_EVENTS = 20000


@jit
def rounding(u: Any, F_k: float, K_z: float) -> Any:
    """Force of an Iwan contact of stiffness 2K_z, less that of a Jenkins contact of stiffness K_z, at a distance u ≥ 0
    from a reversal, N: 2F_k s(1 − s), s = K_z u/(2F_k) ≤ 1. Both have yielded there; a number or an array."""
    s = np.minimum(0.5 * K_z / F_k * u, 1.0)
    return 2.0 * F_k * s * (1.0 - s)


@jit
def _added(x: float, v: float, p: Array) -> tuple[float, float, float]:
    """The force that is not linear, and its derivatives by x and ẋ."""
    size = abs(v)
    sign = 1.0 if v > 0.0 else (-1.0 if v < 0.0 else 0.0)
    force = (p[0] * size + p[1] * v * v) * v + p[2] * size + (p[3] + p[4] * x) * x * x
    by_x = (2.0 * p[3] + 3.0 * p[4] * x) * x
    return force, by_x, 2.0 * p[0] * size + 3.0 * p[1] * v * v + p[2] * sign


@jit
def _accelerations(
    y: Array, sticks: bool, held: Array, par: Parameters, p: Array, out: Array
) -> None:
    """What the linear flow of a phase leaves out of the accelerations of the motion and of its derivatives, (1 + n,).

    y : (1 + n, 2), x − x₀ and ẋ, and their derivatives.   held : x₀ and its derivatives, (1 + n,).
    """
    u, v = y[0, 0], y[0, 1]
    x = held[0] + u
    force, by_x, by_v = _added(x, v, p)
    out[0] = -force / par.m
    for j in range(1, y.shape[0]):
        out[j] = -(by_x * (held[j] + y[j, 0]) + by_v * y[j, 1]) / par.m
    stiff = par.k + (par.K_z if sticks else 0.0)
    out[1 + C] -= v / par.m
    out[1 + M] += (stiff * u + par.c * v + force) / (par.m * par.m)
    if sticks:
        out[1 + RHO] += 2.0 * par.K_z * math.sqrt(par.K_z) * u / par.m
    size = abs(v)
    first = 1 + _FIRST_ADDED
    out[first] -= size * v / par.m
    out[first + 1] -= v * v * v / par.m
    out[first + 2] -= size / par.m
    out[first + 3] -= x * x / par.m
    out[first + 4] -= x * x * x / par.m
    if sticks and par.F_k > 0.0:  # since the reversal at u = 0
        out[first + 5] -= math.copysign(rounding(abs(u), par.F_k, par.K_z), u) / par.m


@jit
def _step(
    y: Array,
    h: float,
    sticks: bool,
    held: Array,
    constant: Array,
    par: Parameters,
    p: Array,
    work: Array,
    out: Array,
) -> None:
    """A step of length h of the motion and its derivatives, from y to `out`, (1 + n, 2).

    constant : part of the accelerations that is constant in the phase, (1 + n,).   work : (6, 1 + n).
    """
    Omega2 = (par.k + (par.K_z if sticks else 0.0)) / par.m
    J, S, R = step_response(0.5 * h, par.c / (2.0 * par.m), Omega2)
    C, D = 1.0 - Omega2 * J, -Omega2 * S
    half_x, half_v = work[4], work[5]
    rows = y.shape[0]
    _accelerations(y, sticks, held, par, p, work[0])
    for i in range(rows):
        half_x[i] = C * y[i, 0] + S * y[i, 1] + J * constant[i]
        half_v[i] = D * y[i, 0] + R * y[i, 1] + S * constant[i]
        out[i, 0] = half_x[i] + 0.5 * h * S * work[0, i]
        out[i, 1] = half_v[i] + 0.5 * h * R * work[0, i]
    _accelerations(out, sticks, held, par, p, work[1])
    for i in range(rows):
        out[i, 0] = half_x[i]
        out[i, 1] = half_v[i] + 0.5 * h * work[1, i]
    _accelerations(out, sticks, held, par, p, work[2])
    for i in range(rows):
        x, v = half_x[i], half_v[i]
        out[i, 0] = C * x + S * v + J * constant[i] + h * S * work[2, i]
        out[i, 1] = D * x + R * v + S * constant[i] + h * R * work[2, i]
    _accelerations(out, sticks, held, par, p, work[3])
    for i in range(rows):
        x = half_x[i] + h / 6.0 * S * work[0, i]
        v = half_v[i] + h / 6.0 * R * work[0, i] + h / 3.0 * (work[1, i] + work[2, i])
        out[i, 0] = C * x + S * v + J * constant[i]
        out[i, 1] = D * x + R * v + S * constant[i] + h / 6.0 * work[3, i]


@jit
def _hold(
    y: Array, s: float, side: float, first: bool, par: Parameters, held: Array, constant: Array
) -> None:
    """Begin a phase at y: its place goes to `held`, its constant accelerations to `constant`.

    side : force of the contact there, over F_k.   first : whether it is the first phase, whose side is that of w.
    """
    m = par.m
    for i in range(y.shape[0]):
        held[i] += y[i, 0]
        y[i, 0] = 0.0
        constant[i] = -par.k * held[i] / m
    constant[0] -= side * par.F_k / m
    constant[1 + F_K] -= side / m
    constant[1 + M] -= constant[0] / m
    if first and s == 0.0:
        constant[1 + _START_PRELOAD] -= par.F_k / m


@jit
def law_decay(
    times: Array, order: int, x: float, v: float, w: float, par: Parameters, p: Array
) -> Array:
    """x, ẋ or ẍ (order 0, 1, 2) of a free decay at ascending times ≥ 0, and derivatives by the unknowns, (n, 1 + 13).

    The unknowns are F_k, c, ρ, m, `ADDED` and the start x, ẋ, w, see `motion.free_decay`. Use it where the
    damping or the spring is not linear, or for the derivatives by those coefficients where it is; a decay with
    friction and viscous damping alone is followed faster by `decay_samples`. NaN from where the contact rattles on.

    p : coefficients of `ADDED`, (6,).
    """
    rows = 1 + _COUNT
    out = np.full((times.size, rows), math.nan)
    y, there = np.zeros((rows, 2)), np.zeros((rows, 2))
    held, constant, work = np.zeros(rows), np.zeros(rows), np.empty((6, rows))
    held[0], y[0, 1] = x, v
    held[1 + _START_X], y[1 + _START_V, 1] = 1.0, 1.0
    Z_m = par.F_k / par.K_z
    side = min(max(w - 1.0, -1.0), 1.0)
    s = contact_state(x, v, side * Z_m, 0.0, par)
    if s != 0.0:
        side = s
    t, events = 0.0, 0
    _hold(y, s, side, events == 0, par, held, constant)
    for n in range(times.size):
        while True:
            sticks = s == 0.0
            stiff = par.k + (par.K_z if sticks else 0.0)
            h = min(times[n] - t, _RADIANS * math.sqrt(par.m / stiff))
            if h <= 0.0:
                break
            # an event is beyond `high` or `low`; it is located by Newton's method kept inside the bracket
            high = Z_m - side * Z_m if sticks else 0.0
            low = -Z_m - side * Z_m if sticks else 0.0
            before, after, part, up, crosses = 0.0, h, h, s < 0.0, False
            for attempt in range(_NEWTONS):
                _step(y, part, sticks, held, constant, par, p, work, there)
                u, rate = there[0, 0], there[0, 1]
                if attempt == 0:
                    crosses = not low <= u <= high if sticks else s * rate < 0.0
                    if not crosses:
                        break
                    up = u > high if sticks else up
                error = (u - (high if up else low)) if sticks else rate
                slope = rate
                if not sticks:
                    slope = constant[0] + work[3, 0] - (par.c * rate + par.k * u) / par.m
                if error == 0.0:
                    break
                if (error > 0.0) == up:
                    after = part
                else:
                    before = part
                newton = part - error / slope if slope != 0.0 else before
                if not before < newton < after:
                    newton = 0.5 * (before + after)
                if abs(newton - part) <= _REACHED * h:
                    break
                part = newton
            y, there = there, y
            t += part
            if not crosses:
                continue
            events += 1
            if events > _MOST_EVENTS:
                return out
            if sticks:
                side = 1.0 if up else -1.0
                s = side
            else:
                y[0, 1], side = 0.0, s
                s = contact_state(held[0] + y[0, 0], 0.0, side * Z_m, 0.0, par)
                if s != 0.0:
                    side = s
            _hold(y, s, side, events == 0, par, held, constant)
        for i in range(rows):
            out[n, i] = y[i, order] if order < 2 else 0.0
            if order == 0:
                out[n, i] += held[i]
        if order == 2:
            _accelerations(y, s == 0.0, held, par, p, work[0])
            stiff = par.k + (par.K_z if s == 0.0 else 0.0)
            for i in range(rows):
                out[n, i] = constant[i] + work[0, i] - (par.c * y[i, 1] + stiff * y[i, 0]) / par.m
    return out
