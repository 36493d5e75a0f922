"""Event-located motion: from any state, phase by phase, each event located to rounding.

A state is (x, ẋ, z) with |z| ≤ Z_m. In slip, the phase ends where the velocity changes sign; in stick, where the
deflection z of the contact spring reaches ±Z_m. Events are bracketed by steps short beside every time scale of the
phase, divided at the extrema inside them so that a touch and go is not stepped over, and located by Newton's method
kept inside the bracket. A free motion, the base at rest, has closed forms of its turns.
"""

from __future__ import annotations

import math

from ..arrays import Array
from ..jit import jit
from ..model import Parameters
from .flow import Phase, move, phase_start, unit

PHASE_T, PHASE_S, PHASE_X, PHASE_V, PHASE_Z = range(5)
"""Columns of an array of phases, a row for the start of each: time, state of the contact, x, ẋ, z."""

MOST_RADIANS = 2e7
"""Radians of the fastest motion of an oscillator that are followed to find an orbit: seconds of computing."""


_Motion = tuple[float, float, float, float, float]  # u, u̇, ü and the next two derivatives


@jit
def contact_state(x: float, v: float, z: float, theta: float, par: Parameters) -> float:
    """Return the state s of the contact at (x, ẋ, z): slip when z is at its limit and the mass moves on, or is about
    to."""
    Z_m = par.F_k / par.K_z
    if abs(z) < Z_m:
        return 0.0
    s = 1.0 if z > 0.0 else -1.0
    if Z_m == 0.0:
        s = 1.0 if v > 0.0 else -1.0
    if v == 0.0:
        push = par.k * par.Y * math.cos(theta) - par.k * x
        if Z_m == 0.0:
            return 1.0 if push > 0.0 else -1.0
        return s if s * push > par.F_k else 0.0
    return s if s * v > 0.0 else 0.0


@jit
def _motion(t: float, phase: Phase) -> _Motion:
    """Return u and its derivatives at time t of a phase."""
    u, v = move(t, phase)
    omega, damping = phase.omega, 2.0 * phase.delta
    force = phase.A * unit(omega * t)
    a = phase.f0 + force.real - damping * v - phase.Omega2 * u
    jerk = -omega * force.imag - damping * a - phase.Omega2 * v
    return u, v, a, jerk, -omega * omega * force.real - damping * jerk - phase.Omega2 * a


@jit
def locate(which: int, level: float, low: float, high: float, start: float, phase: Phase) -> float:
    """Return the time at which the derivative of u of order `which`, 0 to 3, crosses `level`, by Newton's method kept
    inside the bracket; it is beyond the level at `high` alone.   start : a time near it; one outside stands for the
    middle."""
    beyond = _motion(high, phase)[which] > level
    t = start if low < start < high else 0.5 * (low + high)
    for _ in range(100):
        values = _motion(t, phase)
        error, slope = values[which] - level, values[which + 1]
        if error == 0.0:
            break
        if (error > 0.0) == beyond:
            high = t
        else:
            low = t
        newton = t - error / slope if slope != 0.0 else low
        before = t
        t = newton if low < newton < high else 0.5 * (low + high)
        if abs(t - before) <= 2.3e-16 * high or high - low <= 2.3e-16 * high:
            break
    return t


@jit
def _turns(
    which: int, low: float, high: float, at_low: _Motion, at_high: _Motion, phase: Phase
) -> tuple[float, float]:
    """Return the times in (low, high) at which u (which = 0) or u̇ (which = 1) has an extremum, at most two; `high` for
    none.

    at_low, at_high : `_motion` at both ends.
    """
    slope = which + 1
    start, end = at_low[slope], at_high[slope]
    bend_start, bend_end = at_low[slope + 1], at_high[slope + 1]
    if start == 0.0:  # from rest: the slope just after
        start = bend_start
    if start * end < 0.0:
        return locate(slope, 0.0, low, high, 0.0, phase), high
    if start * bend_start < 0.0 < end * bend_end:  # the slope falls towards zero and rises again
        between = locate(slope + 1, 0.0, low, high, 0.0, phase)
        if start * _motion(between, phase)[slope] < 0.0:
            first = locate(slope, 0.0, low, between, 0.0, phase)
            return first, locate(slope, 0.0, between, high, 0.0, phase)
    return high, high


@jit
def _just_inside(which: int, lower: float, upper: float, before: float, phase: Phase) -> float:
    """Return a time before `before` at which a motion that starts on the edge of [lower, upper] is within it; 0 if it
    leaves at once."""
    t = before
    # 60 halvings reach the last bit
    for _ in range(60):
        t *= 0.5
        if lower < _motion(t, phase)[which] < upper:
            return t
    return 0.0


@jit
def _first_turn(v0: float, f0: float, delta: float, w: float) -> tuple[float, float]:
    """Return (time, ±1): when a free motion first turns, and which way it goes until then.

    u̇ = e^{−δt} (v₀ cos wt + (f₀ − δv₀)/w sin wt) with w² = Ω² − δ² > 0.
    """
    side = math.copysign(1.0, v0 if v0 != 0.0 else f0)
    return math.atan2(abs(v0), side * (delta * v0 - f0) / w) / w, side


@jit
def _free_end(which: int, lower: float, upper: float, phase: Phase) -> tuple[float, float]:
    """Return (duration, level): when u (which = 0) or u̇ (which = 1) of a free under-damped motion leaves [lower,
    upper], and at which bound; infinite where it never does.

    Its velocity has its zeros half a period apart, and each swing about the rest position is smaller than the one
    before: a contact that sticks slips in one of the first two swings, or never again.
    """
    v0, f0, _, delta, Omega2, _ = phase
    if v0 == 0.0 and f0 == 0.0:
        return math.inf, 0.0
    w = math.sqrt(Omega2 - delta * delta)
    turn, side = _first_turn(v0, f0, delta, w)
    if which == 1:
        return turn, 0.0
    low = 0.0
    for _ in range(2):
        u = move(turn, phase)[0]
        level = upper if side > 0.0 else lower
        if side * (u - level) > 0.0:
            # as if it were not damped and turned there
            rest = f0 / Omega2
            cosine = (level - rest) / (u - rest) if u != rest else 0.0
            near = turn - math.acos(min(max(cosine, -1.0), 1.0)) / math.sqrt(Omega2)
            return locate(which, level, low, turn, near, phase), level
        low, turn, side = turn, turn + math.pi / w, -side
    return math.inf, 0.0


@jit
def leaving(
    which: int, lower: float, upper: float, limit: float, phase: Phase
) -> tuple[bool, float, float]:
    """Return (whether, t, level): whether u (which = 0) or u̇ (which = 1) leaves [lower, upper] before `limit`, s,
    when, and at which of the two; t is the limit, except for rounding, where it stays within."""
    # 0.999 of the critical damping: a free motion below it has closed forms of its turns
    if phase.A == 0j and phase.delta < 0.999 * math.sqrt(phase.Omega2):
        t, level = _free_end(which, lower, upper, phase)
        return t < limit, min(t, limit), level
    fastest = max(phase.omega, math.sqrt(phase.Omega2), phase.delta)
    # 2.5 steps per radian of the fastest motion
    n = max(1, math.ceil(2.5 * limit * fastest))
    low, at_low = 0.0, _motion(0.0, phase)
    for i in range(1, n + 1):
        high = limit * i / n
        at_high = _motion(high, phase)
        first, second = _turns(which, low, high, at_low, at_high, phase)
        inside, out, value = low, high, at_high[which]
        for turn in (first, second):
            if turn < high:
                at_turn = _motion(turn, phase)[which]
                if not lower <= at_turn <= upper:
                    out, value = turn, at_turn
                    break
                inside = turn
        if not lower <= value <= upper:
            if inside == 0.0 and (at_low[which] == lower or at_low[which] == upper):
                inside = _just_inside(which, lower, upper, out, phase)
            level = upper if value > upper else lower
            return True, locate(which, level, inside, out, 0.0, phase), level
        low, at_low = high, at_high
    return False, low, 0.0


@jit
def phase_end(
    s: float, x: float, v: float, z: float, theta: float, limit: float, par: Parameters
) -> tuple[float, float, float, float]:
    """Return (duration, x, ẋ, z) at the end of the phase that starts at (x, ẋ, z) with the contact in state s, or at
    `limit`.

    A stick phase lasts while −Z_m ≤ z ≤ Z_m, a slip phase while ẋ does not change sign; at the event the equality
    is exact.
    theta : phase of the base at the start, rad.   limit : longest duration, s.
    """
    Z_m = par.F_k / par.K_z
    phase = phase_start(s, x, v, z, unit(theta), par)
    if s == 0.0:
        which, lower, upper = 0, -Z_m - z, Z_m - z
    elif s > 0.0:
        which, lower, upper = 1, 0.0, math.inf
    else:
        which, lower, upper = 1, -math.inf, 0.0
    left, t, level = leaving(which, lower, upper, limit, phase)
    u, rate = move(t, phase)
    if not left:
        return limit, x + u, rate, (z + u if s == 0.0 else s * Z_m)
    if s == 0.0:
        return t, x + level, rate, (Z_m if level == upper else -Z_m)
    return t, x + u, 0.0, s * Z_m


@jit
def write_phase(phases: Array, i: int, t: float, s: float, x: float, v: float, z: float) -> None:
    """Set row i of `phases`."""
    phases[i, PHASE_T], phases[i, PHASE_S] = t, s
    phases[i, PHASE_X], phases[i, PHASE_V], phases[i, PHASE_Z] = x, v, z


@jit
def read_phase(phases: Array, i: int) -> tuple[float, float, float, float, float]:
    """Return (t, s, x, ẋ, z) of row i of `phases`."""
    return (
        phases[i, PHASE_T],
        phases[i, PHASE_S],
        phases[i, PHASE_X],
        phases[i, PHASE_V],
        phases[i, PHASE_Z],
    )


@jit
def run(
    x: float, v: float, z: float, t: float, end: float, theta: float, par: Parameters, phases: Array
) -> tuple[int, float, float, float, float]:
    """Follow the motion from (x, ẋ, z) at time t to `end`: (number of phases, t, x, ẋ, z) reached.

    Row i of `phases` receives (t, s, x, ẋ, z) at the start of phase i. The run stops short of `end` when the rows
    are used up.
    theta : phase of the base at t = 0, rad.
    """
    count = 0
    while t < end and count < phases.shape[0]:
        s = contact_state(x, v, z, theta + par.omega * t, par)
        write_phase(phases, count, t, s, x, v, z)
        duration, x, v, z = phase_end(s, x, v, z, theta + par.omega * t, end - t, par)
        t = end if duration >= end - t else t + duration
        count += 1
    return count, t, x, v, z
