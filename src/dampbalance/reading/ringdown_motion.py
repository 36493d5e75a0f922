"""Simulation of free decays: an oscillator on a base at rest, released from a start state."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..model import Parameters
from ..motion.events import PHASE_S, PHASE_T, run
from ..motion.states import states_in_phases
from .ringdown_bursts import Signal

COMMON = ("F_k", "c", "rho", "m")
"""Unknowns common to all stretches; the offsets and the start states follow."""

STATE = 3
"""Number of unknowns of a start state: x, ẋ, w."""

STEP = 1e-6
"""Relative step of finite differences: motions are exact to 1e-12."""

_CHORD = 3e-2  # of ρ√k: K_z = 1100 k
_MOST_PHASES = 4096  # of a stretch: a decay that slips more often than that is none


@dataclass(frozen=True, eq=False)
class Stretch:
    """The samples of one free decay.

    source : of its record.   start, end : s.   signals : its channels, cut to the stretch.   offsets : number of each
    channel's offset, counted through all records.   period : of the motion, s, about.
    """

    source: str
    start: float
    end: float
    signals: tuple[Signal, ...]
    offsets: tuple[int, ...]
    period: float

    def cut(self, start: float, end: float) -> Stretch:
        """The part of the stretch between two times, s."""
        parts = []
        for one in self.signals:
            inside = one.between(start, end)
            parts.append(replace(one, t=one.t[inside], values=one.values[inside]))
        return replace(self, start=start, end=end, signals=tuple(parts))

    @property
    def samples(self) -> int:
        """Number of samples in all channels."""
        return sum(one.t.size for one in self.signals)


def numbers_of(point: Array, k: float) -> Parameters:
    """The oscillator of a point."""
    F_k, c, rho, m = point[: len(COMMON)].tolist()
    return Parameters(m, c, k, rho**-2, F_k, 0.0, 0.0)


def contact_step(point: Array, k: float) -> float:
    """Step of a difference by ρ: close to a rigid contact the motion depends on ρ², and a chord replaces the slope."""
    rho, chord = float(point[COMMON.index("rho")]), _CHORD / math.sqrt(k)
    return chord if rho < 0.3 * chord else STEP * rho


def phases_of(point: Array, state: Array, k: float, until: float) -> Array:
    """Rows (t, s, x, ẋ, z) of the motion from a start state (x, ẋ, w) at t = 0 on.

    Raises ValueError where the contact rattles on.
    """
    par = numbers_of(point, k)
    x, v, w = state.tolist()
    rows = np.empty((_MOST_PHASES, 5))
    Z_m = par.F_k / par.K_z
    z = min(max((w - 1.0) * Z_m, -Z_m), Z_m)
    count, t, *_ = run(x, v, z, 0.0, until, 0.0, par, rows)
    if t < until:
        raise ValueError("the contact slips on and on")
    return rows[:count]


def slips(phases: Array) -> bool:
    """Whether a motion slips."""
    return bool(np.any(phases[:, PHASE_S] != 0.0))


def stuck_from(phases: Array, end: float) -> float:
    """The time from which on the mass stays stuck, `end` where it does not."""
    return float(phases[-1, PHASE_T]) if phases[-1, PHASE_S] == 0.0 else end


def samples_of(point: Array, state: Array, k: float, one: Stretch) -> Array:
    """Samples of all channels of a stretch without noise and offset, (samples,)."""
    longest = max(float(s.t[-1]) for s in one.signals if s.t.size)
    phases = phases_of(point, state, k, max(longest - one.start, 1e-9 * one.period))
    par = numbers_of(point, k)
    parts = [states_in_phases(s.t - one.start, phases, 0.0, par)[s.order] for s in one.signals]
    return np.concatenate(parts)
