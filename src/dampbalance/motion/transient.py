"""The exact response from any initial state, event by event."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..model import BaseMotion, Oscillator, finite_number, parameters
from .events import PHASE_T, run
from .states import State, states_in_phases

_CHUNK = 1024  # phases computed per call


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
        """(x, ẋ, ẍ, z) at the times t, s, any shape, within the span of the trajectory."""
        times = np.asarray(t, dtype=float)
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
    """The exact motion from the state (x, ẋ, z) at time `start` to `end`, s; y = Y cos ωt.

    motion : of the base; None for a free decay, y = 0.
    x : displacement, m.   v : velocity, m/s.   z : deflection of the contact spring, m, |z| ≤ Z_m.

    Raises ValueError for a state that the contact cannot have or an end before the start, TypeError for a value that
    is not a number; both name the argument.

    >>> from dampbalance import Oscillator, transient
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> decay = transient(osc, None, end=0.5, x=0.01)
    >>> [f"{1000 * x:.3f}" for x in decay.state([0.0, 0.1, 0.2]).x]
    ['10.000', '0.095', '-0.312']
    """
    x, v, z = finite_number("x", x), finite_number("v", v), finite_number("z", z)
    start, end = finite_number("start", start), finite_number("end", end)
    if abs(z) > oscillator.Z_m:
        raise ValueError(f"z must lie within ±Z_m = ±{oscillator.Z_m:.6g} m, got {z!r}")
    if not end > start:
        raise ValueError(f"end must be later than start = {start!r}, got {end!r}")
    par = parameters(oscillator, motion)
    kept = []
    t = start
    while t < end:
        rows = np.empty((_CHUNK, 5))
        count, t, x, v, z = run(x, v, z, t, end, 0.0, par, rows)
        kept.append(rows[:count])
    return Trajectory(oscillator, motion, np.concatenate(kept), end)
