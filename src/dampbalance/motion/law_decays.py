"""Free decays under damping and springs that are not linear, with their derivatives.

    m ẍ + c ẋ + c_2 |ẋ| ẋ + c_3 ẋ³ + c_a |ẋ| + k x + k_2 x² + k_3 x³ + f = 0
    ḟ = K_z ẋ within |f| ≤ F_k + p e^(−|ẋ|/v)

The base is at rest. The linear part of a phase is followed by its exact flow, the rest by the Runge–Kutta method of
order 4 in the frame of that flow (Lawson 1967): where only F_k and c act, the motion is exact. Derivatives follow the
linearised equations; x, ẋ and their derivatives are continuous at events, since the force of the contact is. Where the
friction falls with the speed, F_k is what it falls to: a mass at rest breaks loose at F_k + p, one that moves at less.
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

ADDED = ("c_2", "c_3", "c_a", "k_2", "k_3", "falling", "falling_speed", "gradual")
"""Coefficients of what is not linear: N s²/m², N s³/m³, N s/m, N/m², N/m³; p, N, by which friction is larger at rest,
and the speed v, m/s, over which that falls by a factor e, 0 for at once; and how much of `rounding` the force of the
contact has, whose own events stay where they are without it."""

DECAY_UNKNOWNS = (*OSCILLATOR_UNKNOWNS, "x", "v", "w", *ADDED)
"""The unknowns by which derivatives are taken: those of the oscillator, the start state, z = (w − 1) F_k/K_z with the
preload w of the contact spring, and `ADDED`."""

LINEAR_UNKNOWNS = len(OSCILLATOR_UNKNOWNS) + 3
"""How many of these a fit of friction and viscous damping needs."""

_START_X, _START_V, _START_PRELOAD = range(len(OSCILLATOR_UNKNOWNS), LINEAR_UNKNOWNS)
_FIRST_ADDED = LINEAR_UNKNOWNS
_FALLING, _SPEED, _GRADUAL = range(5, len(ADDED))
_RADIANS = 0.3  # of a phase that a step takes at the most: derivatives are then exact to 1e-5
_NEWTONS = 20
_REACHED = 1e-13  # of a step: an event is located
_MOST_EVENTS = 4096  # a motion with more is none that samples show


@jit
def rounding(u: Any, F_k: float, K_z: float) -> Any:
    """Force of an Iwan contact of stiffness 2K_z, less that of a Jenkins contact of stiffness K_z, at a distance u ≥ 0
    from a reversal, N: 2F_k s(1 − s), s = K_z u/(2F_k) ≤ 1. Both have yielded there; a number or an array."""
    s = np.minimum(0.5 * K_z / F_k * u, 1.0)
    return 2.0 * F_k * s * (1.0 - s)


@jit
def _persisting(v: float, p: Array) -> float:
    """The part e^(−|ẋ|/v) of what friction is larger by at rest that persists at a speed."""
    return math.exp(-abs(v) / p[_SPEED]) if p[_SPEED] > 0.0 else 0.0


@jit
def _added(x: float, v: float, sticks: bool, p: Array) -> tuple[float, float, float]:
    """The force that is not linear, and its derivatives by x and ẋ."""
    size = abs(v)
    sign = 1.0 if v > 0.0 else (-1.0 if v < 0.0 else 0.0)
    force = (p[0] * size + p[1] * v * v) * v + p[2] * size + (p[3] + p[4] * x) * x * x
    by_x = (2.0 * p[3] + 3.0 * p[4] * x) * x
    by_v = 2.0 * p[0] * size + 3.0 * p[1] * v * v + p[2] * sign
    if not sticks and p[_FALLING] != 0.0 and p[_SPEED] > 0.0:
        left = _persisting(v, p)
        force -= sign * p[_FALLING] * (1.0 - left)
        by_v -= p[_FALLING] * left / p[_SPEED]
    return force, by_x, by_v


@jit
def _accelerations(
    y: Array, sticks: bool, held: Array, par: Parameters, p: Array, out: Array
) -> None:
    """What the linear flow of a phase leaves out of the accelerations of the motion and of its derivatives, (1 + n,).

    y : (1 + n, 2), x − x₀ and ẋ, and their derivatives.   held : x₀ and its derivatives, (1 + n,).
    """
    u, v = y[0, 0], y[0, 1]
    x = held[0] + u
    force, by_x, by_v = _added(x, v, sticks, p)
    out[0] = -force / par.m
    for j in range(1, y.shape[0]):
        out[j] = -(by_x * (held[j] + y[j, 0]) + by_v * y[j, 1]) / par.m
    stiff = par.k + (par.K_z if sticks else 0.0)
    out[1 + C] -= v / par.m
    out[1 + M] += (stiff * u + par.c * v + force) / (par.m * par.m)
    if sticks:
        out[1 + RHO] += 2.0 * par.K_z * math.sqrt(par.K_z) * u / par.m
    if sticks and p[_GRADUAL] != 0.0 and par.F_k > 0.0:  # since the reversal at u = 0
        s = min(0.5 * par.K_z / par.F_k * abs(u), 1.0)
        force = math.copysign(rounding(abs(u), par.F_k, par.K_z), u) * p[_GRADUAL] / par.m
        stiffness = p[_GRADUAL] * par.K_z * (1.0 - 2.0 * s) / par.m
        out[0] -= force
        for j in range(1, y.shape[0]):
            out[j] -= stiffness * y[j, 0]
        out[1 + M] += force / par.m
        out[1 + F_K] -= math.copysign(2.0 * s * s, u) * p[_GRADUAL] / par.m
        out[1 + RHO] += 2.0 * math.sqrt(par.K_z) * stiffness * u
    if y.shape[0] == 1 + LINEAR_UNKNOWNS:
        return
    size = abs(v)
    first = 1 + _FIRST_ADDED
    out[first] -= size * v / par.m
    out[first + 1] -= v * v * v / par.m
    out[first + 2] -= size / par.m
    out[first + 3] -= x * x / par.m
    out[first + 4] -= x * x * x / par.m
    if not sticks:
        left = _persisting(v, p)
        out[first + _FALLING] += math.copysign(1.0 - left, v) / par.m
        if left > 0.0:
            by_speed = p[_FALLING] * left * size / p[_SPEED] ** 2
            out[first + _SPEED] -= math.copysign(by_speed, v) / par.m
    elif par.F_k > 0.0:  # since the reversal at u = 0
        out[first + _GRADUAL] -= math.copysign(rounding(abs(u), par.F_k, par.K_z), u) / par.m


@jit
def _linear_step(
    y: Array,
    h: float,
    sticks: bool,
    constant: Array,
    par: Parameters,
    work: Array,
    out: Array,
) -> None:
    """A step like that of `_step` without `ADDED`: the motion is exact, and Simpson's rule integrates what acts on the
    derivatives by c, ρ and m."""
    Omega2 = (par.k + (par.K_z if sticks else 0.0)) / par.m
    half = step_response(0.5 * h, 0.5 * par.c / par.m, Omega2)
    whole = step_response(h, 0.5 * par.c / par.m, Omega2)
    J, S, R = whole
    for i in range(y.shape[0]):
        x, v = y[i, 0], y[i, 1]
        out[i, 0] = (1.0 - Omega2 * J) * x + S * v + J * constant[i]
        out[i, 1] = -Omega2 * S * x + R * v + S * constant[i]
    work[3, 0] = 0.0
    if y.shape[0] == 1:
        return
    J, S, R = half
    u = (1.0 - Omega2 * J) * y[0, 0] + S * y[0, 1] + J * constant[0]
    v = -Omega2 * S * y[0, 0] + R * y[0, 1] + S * constant[0]
    by_rho = 2.0 * par.K_z * math.sqrt(par.K_z) / par.m if sticks else 0.0
    _drive(out, y[0], h / 6.0 * whole[1], h / 6.0 * whole[2], by_rho, Omega2, par)
    work[5, 0], work[5, 1] = u, v
    _drive(out, work[5], h / 1.5 * half[1], h / 1.5 * half[2], by_rho, Omega2, par)
    _drive(out, out[0], 0.0, h / 6.0, by_rho, Omega2, par)


@jit
def _drive(
    y: Array, at: Array, S: float, R: float, by_rho: float, Omega2: float, par: Parameters
) -> None:
    """Add to the derivatives by c, ρ and m, y, what acts on them where the motion is `at`.   S, R : weights."""
    x, v = at[0], at[1]
    force = -v / par.m
    y[1 + C, 0] += S * force
    y[1 + C, 1] += R * force
    force = by_rho * x
    y[1 + RHO, 0] += S * force
    y[1 + RHO, 1] += R * force
    force = (Omega2 * x + par.c * v / par.m) / par.m
    y[1 + M, 0] += S * force
    y[1 + M, 1] += R * force


@jit
def _step(
    y: Array,
    h: float,
    sticks: bool,
    held: Array,
    constant: Array,
    par: Parameters,
    p: Array,
    linear: bool,
    work: Array,
    out: Array,
) -> None:
    """A step of length h of the motion and its derivatives, from y to `out`, (1 + n, 2).

    constant : part of the accelerations that is constant in the phase, (1 + n,).   work : (6, 1 + n).
    """
    if linear:
        _linear_step(y, h, sticks, constant, par, work, out)
        return
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
    times: Array, order: int, x: float, v: float, w: float, par: Parameters, p: Array, unknowns: int
) -> Array:
    """x, ẋ or ẍ (order 0, 1, 2) of a free decay at ascending times ≥ 0, and derivatives, (n, 1 + unknowns).

    NaN from where the contact rattles on.

    p : coefficients of `ADDED`, (8,).
    unknowns : how many of `DECAY_UNKNOWNS` to differentiate by: all, or `LINEAR_UNKNOWNS` in half the time.
    """
    rows = 1 + unknowns
    out = np.full((times.size, rows), math.nan)
    y, there = np.zeros((rows, 2)), np.zeros((rows, 2))
    held, constant, work = np.zeros(rows), np.zeros(rows), np.empty((6, rows))
    held[0], y[0, 1] = x, v
    held[1 + _START_X], y[1 + _START_V, 1] = 1.0, 1.0
    # up to the end, F_k is that at rest
    par = Parameters(par.m, par.c, par.k, par.K_z, par.F_k + p[_FALLING], par.Y, par.omega)
    Z_m = par.F_k / par.K_z
    side = min(max(w - 1.0, -1.0), 1.0)
    s = contact_state(x, v, side * Z_m, 0.0, par)
    if s != 0.0:
        side = s
    bent = p[:_SPEED].any() or p[_GRADUAL] != 0.0
    t, events, linear = 0.0, 0, unknowns <= LINEAR_UNKNOWNS and not bent
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
                _step(y, part, sticks, held, constant, par, p, linear, work, there)
                u, rate = there[0, 0], there[0, 1]
                # a contact that is loaded while the mass moves yields earlier than at rest
                early = math.copysign((1.0 - _persisting(rate, p)) * p[_FALLING] / par.K_z, rate)
                most, least = high - max(early, 0.0), low - min(early, 0.0)
                if attempt == 0:
                    crosses = not least <= u <= most if sticks else s * rate < 0.0
                    if not crosses:
                        break
                    up = u > most if sticks else up
                error = (u - (most if up else least)) if sticks else rate
                slope = constant[0] + work[3, 0] - (par.c * rate + stiff * u) / par.m
                if sticks:
                    by_rate = _persisting(rate, p) * p[_FALLING] / par.K_z
                    slope = rate + (by_rate * slope / p[_SPEED] if by_rate > 0.0 else 0.0)
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
    if unknowns > LINEAR_UNKNOWNS:
        out[:, 1 + _FIRST_ADDED + _FALLING] += out[:, 1 + F_K]
    return out
