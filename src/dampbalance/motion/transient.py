"""The exact response from any initial state, event by event."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import number, numbers
from ..arrays import Array
from ..model import BaseMotion, Oscillator, parameters
from .events import PHASE_T, run
from .states import State, states_in_phases

_MOST_RADIANS = 1e8  # half a minute of computing


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Motion from an initial state, phase by phase.

    motion : of the base; None where it is at rest.
    phases : (n, 5), rows (t, s, x, ẋ, z) at the start of each phase, absolute time; s = ±1 in slip, 0 in stick.
    end : time up to which the motion was computed, s.
    """

    oscillator: Oscillator
    motion: BaseMotion | None
    phases: Array = field(repr=False)
    end: float

    def state(self, t: ArrayLike) -> State:
        """Return (x, ẋ, ẍ, z) at the times t, s, any shape, within the span of the trajectory."""
        times = numbers("t", t)
        start = self.phases[0, PHASE_T]
        if times.size and not (times.min() >= start and times.max() <= self.end):
            raise ValueError(f"times must lie within [{start}, {self.end}] s")
        par = parameters(self.oscillator, self.motion)
        rows = states_in_phases(times.ravel(), self.phases, 0.0, par)
        return State(*(row.reshape(times.shape) for row in rows))


def transient(
    oscillator: Oscillator,
    motion: BaseMotion | None,
    end: float,
    *,
    x: float = 0.0,
    v: float = 0.0,
    z: float = 0.0,
    start: float = 0.0,
) -> Trajectory:
    """Return the exact motion from the state (x, ẋ, z) at time `start` to `end`, s; y = Y cos ωt.

    motion : of the base; None for a free decay, y = 0.
    x : displacement, m.   v : velocity, m/s.   z : deflection of the contact spring, m, |z| ≤ Z_m.

    Raises ValueError naming the argument that is not a number, a deflection beyond Z_m, an end that is not later than
    the start, and a span too long to be followed.

    >>> from dampbalance import Oscillator, transient
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> decay = transient(osc, None, end=0.5, x=0.01)
    >>> [f"{1000 * x:.3f}" for x in decay.state([0.0, 0.1, 0.2]).x]
    ['10.000', '0.095', '-0.312']
    """
    par = parameters(oscillator, motion)
    given = {"x": x, "v": v, "z": z, "start": start, "end": end}
    x, v, z, start, end = (number(name, value) for name, value in given.items())
    if abs(z) > oscillator.Z_m:
        raise ValueError(f"z must lie within ±Z_m = ±{oscillator.Z_m:.6g} m, got {z!r}")
    if not end > start:
        raise ValueError(f"end must be later than start = {start!r}, got {end!r}")
    radians = (end - start) * max(par.omega, math.sqrt((par.k + par.K_z) / par.m), par.c / par.m)
    if radians > _MOST_RADIANS:
        raise ValueError(
            f"{end - start:g} s are {radians:.2g} radians of the fastest motion of this oscillator, and no more than "
            f"{_MOST_RADIANS:g} are followed: choose an earlier end"
        )
    kept = []
    t = start
    while t < end:
        # phases computed per call
        rows = np.empty((1024, 5))
        count, t, x, v, z = run(x, v, z, t, end, 0.0, par, rows)
        kept.append(rows[:count])
    return Trajectory(oscillator, motion, np.concatenate(kept), end)
