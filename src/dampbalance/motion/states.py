"""The state along an orbit or a transient, at any times, from the rows of its phases."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model import Parameters
from .events import PHASE_T, PHASE_X, read_phase
from .flow import Phase, move, phase_start, unit
from .jit import jit


class State(NamedTuple):
    """State of the oscillator at the times asked for, each an array of their shape.

    x : displacement, m.   v : velocity, m/s.   acceleration : m/s².   z : deflection of the contact spring, m.
    """

    x: Array
    v: Array
    acceleration: Array
    z: Array


@jit
def states_in_phases(
    times: Array, phases: Array, theta: float, par: Parameters, out: Array
) -> None:
    """Write x, ẋ, ẍ, z at `times` (n,) into the rows of `out` (4, n).

    phases : (count, 5), rows (t, s, x, ẋ, z).   theta : phase of the base at t = 0.   Times before the first phase
    are not allowed.
    """
    Z_m = par.F_k / par.K_z
    for j in range(times.size):
        t = times[j]
        i = max(0, np.searchsorted(phases[:, PHASE_T], t, side="right") - 1)
        start, s, x0, v0, z0 = read_phase(phases, i)
        phase = phase_start(s, x0, v0, z0, unit(theta + par.omega * start), par)
        u, v = move(t - start, phase)
        x = x0 + u
        z = z0 + u if s == 0.0 else s * Z_m
        force = par.k * (par.Y * math.cos(theta + par.omega * t) - x) - par.c * v - par.K_z * z
        out[0, j], out[1, j], out[2, j], out[3, j] = x, v, force / par.m, z


@jit
def zero_crossing(phases: Array, count: int, theta: float, par: Parameters) -> float:
    """Time from the reversal at −X to the first upward zero of x, s; `phases` holds the half cycle from that
    reversal."""
    for i in range(count):
        start, s, x, v, z = read_phase(phases, i)
        end = phases[i + 1, PHASE_T] if i + 1 < count else math.pi / par.omega
        x_end = phases[i + 1, PHASE_X] if i + 1 < count else -phases[0, PHASE_X]
        if x < 0.0 <= x_end:
            phase = phase_start(s, x, v, z, unit(theta + par.omega * start), par)
            return float(start + _time_of(-x, end - start, phase))
    return math.nan


@jit
def _time_of(level: float, end: float, phase: Phase) -> float:
    """The time before `end` at which a phase has moved by `level`, which it has passed at `end`: by Newton's method,
    kept inside the bracket."""
    low, high, t = 0.0, end, 0.5 * end
    for _ in range(100):
        u, v = move(t, phase)
        if u > level:
            high = t
        else:
            low = t
        step = (level - u) / v if v != 0.0 else math.inf
        if not low <= t + step <= high:
            step = 0.5 * (low + high) - t
        t += step
        if abs(step) <= 1e-9 * t:  # the next step would be its square
            break
    return t
