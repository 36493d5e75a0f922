"""Free decays under damping and springs that are not linear, with their derivatives.

    m ẍ + c ẋ + c_2 |ẋ| ẋ + k x + k_3 x³ + G (sin x − x) + f = 0
    ḟ = K_z ẋ within |f| ≤ F_k + p e^(−|ẋ|/v)

The base is at rest. G = k is a pendulum, whose angle is x, and G = 0 any other oscillator. The linear part of a phase
is followed by its exact flow, the rest by the Runge–Kutta method of order 4 in the frame of that flow (Lawson 1967):
where only F_k and c act, the motion is exact. Derivatives follow the linearised equations; x, ẋ and their derivatives
are continuous at events, since the force of the contact is. Where the friction changes with the speed, F_k is what it
tends to: a mass at rest breaks loose at F_k + p > 0. Friction that fades, as of bodies that run in
or get warm, changes from one slip to the next,

    F_n = F_k [1 − q ((n + ½)/N − ½)],   n = 0, 1, … N − 1,

by a share q of its mean F_k in N slips, and stays as it is after these.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..arrays import Array
from ..jit import jit
from ..model import Parameters
from .events import contact_state, write_phase
from .flow import step_response
from .unknowns import F_K, OSCILLATOR_UNKNOWNS, RHO, C, M

ADDED = ("c_2", "k_3", "falling", "falling_speed", "fading", "gradual")
"""Coefficients of what is not linear: N s²/m², N/m³; p, N, by which friction is larger at rest, and the speed v, m/s,
over which that falls by a factor e, 0 for at once; q, the share of friction that fades; and how much of `rounding` the
force of the contact has, whose own events stay where they are without it."""

DECAY_UNKNOWNS = (*OSCILLATOR_UNKNOWNS, "x", "v", "w", *ADDED)
"""The unknowns by which derivatives are taken: those of the oscillator, the start state, z = (w − 1) F_k/K_z with the
preload w of the contact spring, and `ADDED`."""

LINEAR_UNKNOWNS = len(OSCILLATOR_UNKNOWNS) + 3
"""Number of these that a fit of friction and viscous damping needs."""

Coefficients = tuple[float, float, float, float, float, float, float]
"""Values of the coefficients in `ADDED`, and G, N m."""

_START_X, _START_V, _START_PRELOAD = range(len(OSCILLATOR_UNKNOWNS), LINEAR_UNKNOWNS)
_FIRST_ADDED = LINEAR_UNKNOWNS
_C_2, _K_3, _FALLING, _SPEED, _FADING, _GRADUAL, _GRAVITY = range(len(ADDED) + 1)
# Rows of the work space, (15, 1 + n): a row is the motion, or a force on it, and its n derivatives. It is handed on
# whole, as each array that is handed on costs as much as a tenth of a step.
_STAGE, _HALF = 0, 4  # accelerations of the four stages of a step; x and ẋ after half of it
_HELD, _CONSTANT = 6, 7  # constants of a phase, see `_hold`
_STATE = 8  # x − x₀ and ẋ here, and there
_FLOW = 12  # h, J, S, R over h/2, J, S, R over h: of slip, of stick, of a step to an event
_RADIANS = 0.3  # longest step, in radians of a phase: derivatives are then exact to 1e-5
_OF_A_PENDULUM = (
    0.08  # the same, times the amplitude, of a pendulum: exact to 1e-6 of it over a hundred cycles
)
_EQUAL = 1e-10  # relative difference of two steps that rounding makes between thousands of times
_NEWTONS = 20
_REACHED = 1e-13  # steps: an event is located to this
_MOST_EVENTS = 4096  # samples do not resolve a motion with more


@jit
def rounding(u: Any, F_k: float, K_z: float) -> Any:
    """Return the force of an Iwan contact of stiffness 2K_z, less that of a Jenkins contact of stiffness K_z, at a
    distance u ≥ 0 from a reversal, N: 2F_k s(1 − s), s = K_z u/(2F_k) ≤ 1. Both have yielded there; a number or an
    array."""
    s = np.minimum(0.5 * K_z / F_k * u, 1.0)
    return 2.0 * F_k * s * (1.0 - s)


@jit
def _persisting(v: float, p: Coefficients) -> float:
    """Return the part e^(−|ẋ|/v) of the excess of friction at rest that persists at a speed."""
    return math.exp(-abs(v) / p[_SPEED]) if p[_SPEED] > 0.0 else 0.0


@jit
def _added(x: float, v: float, sticks: bool, p: Coefficients) -> tuple[float, float, float]:
    """Return the force that is not linear, and its derivatives by x and ẋ."""
    size = abs(v)
    force = p[_C_2] * size * v + p[_K_3] * x * x * x
    by_x = 3.0 * p[_K_3] * x * x
    by_v = 2.0 * p[_C_2] * size
    if p[_GRAVITY] != 0.0:
        force += p[_GRAVITY] * (math.sin(x) - x)
        by_x += p[_GRAVITY] * (math.cos(x) - 1.0)
    if not sticks and p[_FALLING] != 0.0 and p[_SPEED] > 0.0:
        left, sign = _persisting(v, p), 1.0 if v > 0.0 else (-1.0 if v < 0.0 else 0.0)
        force -= sign * p[_FALLING] * (1.0 - left)
        by_v -= p[_FALLING] * left / p[_SPEED]
    return force, by_x, by_v


@jit
def _accelerations(
    w: Array, at: int, rows: int, sticks: bool, par: Parameters, p: Coefficients, stage: int
) -> None:
    """Set the row of a stage to what the linear flow of a phase leaves out of the accelerations of the motion and its
    derivatives.

    at : row of the state.   rows : 1 for the motion alone, else 1 + n.
    """
    u, v = w[at, 0], w[at + 1, 0]
    x = w[_HELD, 0] + u
    force, by_x, by_v = _added(x, v, sticks, p)
    stiff = par.k + (par.K_z if sticks else 0.0)
    by_u = rounded = by_force = 0.0
    if sticks and par.F_k > 0.0:  # since the reversal at u = 0
        s = min(0.5 * par.K_z / par.F_k * abs(u), 1.0)
        rounded = math.copysign(rounding(abs(u), par.F_k, par.K_z), u)
        by_u = p[_GRADUAL] * par.K_z * (1.0 - 2.0 * s)
        by_force = p[_GRADUAL] * math.copysign(2.0 * s * s, u)
        force += p[_GRADUAL] * rounded
    w[stage, 0] = -force / par.m
    if rows == 1:
        return
    per_x, per_u, per_v = by_x / par.m, (by_x + by_u) / par.m, by_v / par.m
    for j in range(1, rows):
        w[stage, j] = -(per_x * w[_HELD, j] + per_u * w[at, j] + per_v * w[at + 1, j])
    w[stage, 1 + F_K] -= by_force / par.m
    w[stage, 1 + C] -= v / par.m
    w[stage, 1 + M] += (stiff * u + par.c * v + force) / (par.m * par.m)
    if sticks:
        w[stage, 1 + RHO] += 2.0 * math.sqrt(par.K_z) * (par.K_z + by_u) * u / par.m
    if rows == 1 + LINEAR_UNKNOWNS:
        return
    size = abs(v)
    first = 1 + _FIRST_ADDED
    w[stage, first + _C_2] -= size * v / par.m
    w[stage, first + _K_3] -= x * x * x / par.m
    if not sticks:
        left = _persisting(v, p)
        w[stage, first + _FALLING] += math.copysign(1.0 - left, v) / par.m
        if left > 0.0:
            by_speed = p[_FALLING] * left * size / p[_SPEED] ** 2
            w[stage, first + _SPEED] -= math.copysign(by_speed, v) / par.m
    else:
        w[stage, first + _GRADUAL] -= rounded / par.m


@jit
def _linear_step(
    w: Array,
    here: int,
    there: int,
    rows: int,
    flow: int,
    Omega2: float,
    by_rho: float,
    par: Parameters,
) -> None:
    """Take a step like that of `_step` without `ADDED`: the motion is exact, and Simpson's rule integrates what acts on
    the derivatives by c, ρ and m.   by_rho : acceleration that ρ adds by displacement."""
    h, J, S, R = w[flow, 0], w[flow, 4], w[flow, 5], w[flow, 6]
    C, D = 1.0 - Omega2 * J, -Omega2 * S
    for i in range(rows):
        w[there, i] = C * w[here, i] + S * w[here + 1, i] + J * w[_CONSTANT, i]
        w[there + 1, i] = D * w[here, i] + R * w[here + 1, i] + S * w[_CONSTANT, i]
    w[_STAGE + 3, 0] = 0.0
    if rows == 1:
        return
    x, v, f = w[here, 0], w[here + 1, 0], w[_CONSTANT, 0]
    _drive(w, there, x, v, h / 6.0 * S, h / 6.0 * R, Omega2, by_rho, par)
    J, S, R = w[flow, 1], w[flow, 2], w[flow, 3]
    x, v = (1.0 - Omega2 * J) * x + S * v + J * f, -Omega2 * S * x + R * v + S * f
    _drive(w, there, x, v, h / 1.5 * S, h / 1.5 * R, Omega2, by_rho, par)
    x, v = w[there, 0], w[there + 1, 0]
    _drive(w, there, x, v, 0.0, h / 6.0, Omega2, by_rho, par)


@jit
def _drive(
    w: Array,
    at: int,
    x: float,
    v: float,
    S: float,
    R: float,
    Omega2: float,
    by_rho: float,
    par: Parameters,
) -> None:
    """Add to the derivatives of a state by c, ρ and m what acts on them at a place and a speed.   S, R : weights."""
    force = -v / par.m
    w[at, 1 + C] += S * force
    w[at + 1, 1 + C] += R * force
    force = by_rho * x
    w[at, 1 + RHO] += S * force
    w[at + 1, 1 + RHO] += R * force
    force = (Omega2 * x + par.c * v / par.m) / par.m
    w[at, 1 + M] += S * force
    w[at + 1, 1 + M] += R * force


@jit
def _step(
    w: Array,
    here: int,
    there: int,
    rows: int,
    h: float,
    sticks: bool,
    flow: int,
    par: Parameters,
    p: Coefficients,
    linear: bool,
) -> None:
    """Take a step of length h of the motion and its derivatives.

    here, there : rows of the states.   rows : of a state, 1 for the motion alone, else 1 + n.
    flow : row of the responses of the phase, which are computed unless they are those of such a step.
    """
    Omega2 = (par.k + (par.K_z if sticks else 0.0)) / par.m
    if abs(h - w[flow, 0]) > _EQUAL * h:
        J, S, R = step_response(0.5 * h, 0.5 * par.c / par.m, Omega2)
        w[flow, 0], w[flow, 1], w[flow, 2], w[flow, 3] = h, J, S, R
        w[flow, 4] = (2.0 - Omega2 * J) * J + S * S
        w[flow, 5] = S * (1.0 + R - Omega2 * J)
        w[flow, 6] = R * R - Omega2 * S * S
    if linear:
        by_rho = 2.0 * par.K_z * math.sqrt(par.K_z) / par.m if sticks else 0.0
        _linear_step(w, here, there, rows, flow, Omega2, by_rho, par)
        return
    J, S, R = w[flow, 1], w[flow, 2], w[flow, 3]
    C, D = 1.0 - Omega2 * J, -Omega2 * S
    for i in range(rows):
        w[_HALF, i] = C * w[here, i] + S * w[here + 1, i] + J * w[_CONSTANT, i]
        w[_HALF + 1, i] = D * w[here, i] + R * w[here + 1, i] + S * w[_CONSTANT, i]
    at = here
    for stage in range(_STAGE, _STAGE + 4):
        _accelerations(w, at, rows, sticks, par, p, stage)
        at = there
        if stage < _STAGE + 2:
            by_x, by_v = (0.5 * h * S, 0.5 * h * R) if stage == _STAGE else (0.0, 0.5 * h)
            for i in range(rows):
                w[there, i] = w[_HALF, i] + by_x * w[stage, i]
                w[there + 1, i] = w[_HALF + 1, i] + by_v * w[stage, i]
        elif stage == _STAGE + 2:
            for i in range(rows):
                x, v, f, more = w[_HALF, i], w[_HALF + 1, i], w[_CONSTANT, i], h * w[stage, i]
                w[there, i] = C * x + S * (v + more) + J * f
                w[there + 1, i] = D * x + R * (v + more) + S * f
    for i in range(rows):
        first, last = h / 6.0 * w[_STAGE, i], h / 6.0 * w[_STAGE + 3, i]
        x, f = w[_HALF, i] + S * first, w[_CONSTANT, i]
        v = w[_HALF + 1, i] + R * first + h / 3.0 * (w[_STAGE + 1, i] + w[_STAGE + 2, i])
        w[there, i] = C * x + S * v + J * f
        w[there + 1, i] = D * x + R * v + S * f + last


@jit
def _with_friction(par: Parameters, F_k: float) -> Parameters:
    """Return the oscillator with another friction force, N."""
    return Parameters(par.m, par.c, par.k, par.K_z, F_k, par.Y, par.omega)


@jit
def _faded(par: Parameters, age: float, p: Coefficients) -> Parameters:
    """Return the oscillator with the friction of one slip.   age : (n + ½)/N − ½."""
    return _with_friction(par, par.F_k * (1.0 - p[_FADING] * age))


@jit
def _hold(
    w: Array,
    at: int,
    rows: int,
    s: float,
    side: float,
    first: bool,
    age: float,
    par: Parameters,
    p: Coefficients,
) -> None:
    """Begin a phase at a state: add its place to what is held, and set its constant accelerations.

    side : force of the contact there, over the friction.   first : whether it is the first phase, whose side is that of
    w.   age : (n + ½)/N − ½ of that friction.
    """
    m, level = par.m, 1.0 - p[_FADING] * age
    for i in range(rows):
        w[_HELD, i] += w[at, i]
        w[at, i] = 0.0
        w[_CONSTANT, i] = -par.k * w[_HELD, i] / m
    w[_CONSTANT, 0] -= side * level * par.F_k / m
    w[_CONSTANT, 1 + F_K] -= side * level / m
    w[_CONSTANT, 1 + M] -= w[_CONSTANT, 0] / m
    if first and s == 0.0:
        w[_CONSTANT, 1 + _START_PRELOAD] -= level * par.F_k / m
    if rows > 1 + LINEAR_UNKNOWNS:
        w[_CONSTANT, 1 + _FIRST_ADDED + _FADING] += side * age * par.F_k / m


@jit
def law_decay(
    times: Array,
    order: int,
    x: float,
    v: float,
    preload: float,
    par: Parameters,
    coefficients: Array,
    unknowns: int,
    gravity: float,
    slips: float,
    phases: Array,
) -> Array:
    """Return x, ẋ or ẍ (order 0, 1, 2) of a free decay at ascending times ≥ 0, and derivatives, (n, 1 + unknowns).

    NaN from where the contact rattles on.

    x, v, preload : at t = 0.   coefficients : of `ADDED`, (6,).   gravity : G/k.   slips : N.   phases : receives (t,
    s, x, ẋ, z) at the start of each phase, (n, 5), as many as it has rows.
    unknowns : how many of `DECAY_UNKNOWNS` to differentiate by: all, or `LINEAR_UNKNOWNS` in a third of the time.
    """
    rows = 1 + unknowns
    out = np.full((times.size, rows), math.nan)
    w = np.zeros((15, rows))
    c = coefficients
    p = (c[0], c[1], c[2], c[3], c[4], c[5], gravity * par.k)
    # a literal would have each kernel compiled once more
    here, there, stage = int(np.int64(_STATE)), int(np.int64(_STATE + 2)), int(np.int64(_STAGE))
    w[_HELD, 0], w[here + 1, 0] = x, v
    w[_HELD, 1 + _START_X], w[here + 1, 1 + _START_V] = 1.0, 1.0
    # up to the end, F_k is that at rest
    par = _with_friction(par, par.F_k + p[_FALLING])
    slipped, age = 0.0, 0.5 / slips - 0.5
    now = then = mean = _faded(par, age, p)  # in the contact, of the next slip, of both
    Z_m = now.F_k / par.K_z
    side = min(max(preload - 1.0, -1.0), 1.0)
    s = contact_state(x, v, side * Z_m, 0.0, now)
    if s != 0.0:
        side = s
    bent = coefficients[:_SPEED].any() or p[_GRADUAL] != 0.0 or gravity != 0.0
    t, events, linear = 0.0, 0, unknowns <= LINEAR_UNKNOWNS and not bent
    _hold(w, here, rows, s, side, events == 0, age, par, p)
    if phases.size:
        write_phase(phases, 0, t, s, x, v, side * Z_m)
    for n in range(times.size):
        while True:
            sticks = s == 0.0
            stiff = par.k + (par.K_z if sticks else 0.0)
            h = times[n] - t
            if h <= 0.0:
                break
            steps = h / _RADIANS * math.sqrt(stiff / par.m)
            if gravity != 0.0:
                swing = math.sqrt(par.k / par.m) * (w[_HELD, 0] + w[here, 0])
                steps = max(steps, h / _OF_A_PENDULUM * math.hypot(swing, w[here + 1, 0]))
            h /= math.ceil(steps)
            # an event is beyond `high` or `low`; it is located by Newton's method kept inside the bracket
            other = then.F_k / par.K_z
            high = (Z_m if side == 1.0 else other) - side * Z_m if sticks else 0.0
            low = -(Z_m if side == -1.0 else other) - side * Z_m if sticks else 0.0
            # with which a contact that yields gradually does so up to the next slip
            mean = _with_friction(par, 0.5 * (now.F_k + then.F_k))
            before, after, part, up, crosses = 0.0, h, h, s < 0.0, False
            many, flow = rows, _FLOW + int(sticks)
            for attempt in range(_NEWTONS):
                _step(w, here, there, many, part, sticks, flow, mean, p, linear)
                u, rate = w[there, 0], w[there + 1, 0]
                # a contact that is loaded while the mass moves yields earlier than at rest
                early = math.copysign((1.0 - _persisting(rate, p)) * p[_FALLING] / par.K_z, rate)
                most, least = high - max(early, 0.0), low - min(early, 0.0)
                if attempt == 0:
                    crosses = not least <= u <= most if sticks else s * rate < 0.0
                    if not crosses:
                        break
                    up = u > most if sticks else up
                error = (u - (most if up else least)) if sticks else rate
                slope = w[_CONSTANT, 0] + w[_STAGE + 3, 0] - (par.c * rate + stiff * u) / par.m
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
                # the derivatives are not needed on the way to an event
                many, flow = 1, _FLOW + 2
                w[flow, 0] = 0.0
            if crosses:
                w[flow, 0] = 0.0
                _step(w, here, there, rows, part, sticks, flow, mean, p, linear)
            here, there = there, here
            t += part
            if not crosses:
                continue
            events += 1
            if events > _MOST_EVENTS:
                return out
            if sticks:
                s = 1.0 if up else -1.0
                if s != side:
                    age = min((slipped + 0.5) / slips, 1.0) - 0.5
                    now, Z_m = then, other
                side = s
            else:
                w[here + 1, 0], side = 0.0, s
                s = contact_state(w[_HELD, 0] + w[here, 0], 0.0, side * Z_m, 0.0, now)
                if s != 0.0:
                    side = s
                slipped += 1.0
                then = _faded(par, min((slipped + 0.5) / slips, 1.0) - 0.5, p)
            _hold(w, here, rows, s, side, events == 0, age, par, p)
            if events < len(phases):
                write_phase(phases, events, t, s, w[_HELD, 0], w[here + 1, 0], side * Z_m)
        for i in range(rows):
            out[n, i] = w[here + order, i] if order < 2 else 0.0
            if order == 0:
                out[n, i] += w[_HELD, i]
        if order == 2:
            _accelerations(w, here, rows, s == 0.0, mean, p, stage)
            stiff = par.k + (par.K_z if s == 0.0 else 0.0)
            for i in range(rows):
                flowing = w[_CONSTANT, i] - (par.c * w[here + 1, i] + stiff * w[here, i]) / par.m
                out[n, i] = flowing + w[_STAGE, i]
        if unknowns > LINEAR_UNKNOWNS:  # F_k is that at high speed
            out[n, 1 + _FIRST_ADDED + _FALLING] += out[n, 1 + F_K]
    return out
