"""The state along an orbit or a transient, at any times, from the rows of its phases."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..jit import jit
from ..model import Parameters
from .events import PHASE_T, read_phase
from .flow import move, phase_start, unit


class State(NamedTuple):
    """State of the oscillator at the times asked for, each an array of their shape.

    x : displacement, m.   v : velocity, m/s.   acceleration : m/s².   z : deflection of the contact spring, m.
    """

    x: Array
    v: Array
    acceleration: Array
    z: Array


@jit
def states_in_phases(times: Array, phases: Array, theta: float, par: Parameters) -> Array:
    """Return x, ẋ, ẍ, z at `times` (n,), the rows of an array (4, n).

    phases : (count, 5), rows (t, s, x, ẋ, z).   theta : phase of the base at t = 0.   Times before the first phase
    are not allowed.
    """
    Z_m = par.F_k / par.K_z
    out = np.empty((4, times.size))
    i = 0
    start, s, x0, v0, z0 = read_phase(phases, i)
    phase = phase_start(s, x0, v0, z0, unit(theta + par.omega * start), par)
    for j in range(times.size):
        t = times[j]
        here = max(0, np.searchsorted(phases[:, PHASE_T], t, side="right") - 1)
        if (
            here != i
        ):  # successive times mostly lie in one phase, whose start costs more than the move
            i = here
            start, s, x0, v0, z0 = read_phase(phases, i)
            phase = phase_start(s, x0, v0, z0, unit(theta + par.omega * start), par)
        u, v = move(t - start, phase)
        x = x0 + u
        z = z0 + u if s == 0.0 else s * Z_m
        force = par.k * (par.Y * math.cos(theta + par.omega * t) - x) - par.c * v - par.K_z * z
        out[0, j], out[1, j], out[2, j], out[3, j] = x, v, force / par.m, z
    return out
