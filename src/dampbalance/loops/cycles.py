"""Cycles of measured loops: reversals, sharp corners between samples, velocity, and the sign of the force."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers, Mask

FEWEST_CYCLES = 4
"""Complete cycles, the first left out: of fewer the scatter between them says nothing."""

# of the range of x: a reversal is a return by more, so that levels of 1 : 20 are read
_SWING = 0.04
_CLOSED = 0.05  # of the range of a cycle, between its ends
# noise of x over its range from which on it is smoothed: else z reverses with it
_SMOOTHED = 1e-3
_SHARP = 4.0  # standard deviations of noise, from which on a bend of x is a corner
_OF_PERIOD, _OF_PERIOD_V = 40, 16  # windows of x and ẋ are these parts of a period
_CERTAIN = 4.0  # standard errors by which energy is gained


def turning_points(x: Array, least: float) -> Integers:
    """Return the indices of the reversals of x that are followed by a return of more than `least`."""
    found, at, way = list[int](), 0, 0
    for i, value in enumerate(x.tolist()):
        ahead = (value - x[at]) * (way or 1.0)
        if way == 0 and abs(value - x[at]) > least:
            way, at = (1 if value > x[at] else -1), i
        elif way and ahead >= 0.0:
            at = i
        elif way and ahead < -least:
            found.append(at)
            way, at = -way, i
    return np.array(found, dtype=int)


def corners(x: Array, turns: Integers, noise: float) -> Array:
    """Return the displacement through which x passes between two samples, (n − 1,): of a sharp reversal that falls
    between them, as a triangle has, that of its corner; else of the later sample.

    The second differences of a kink of size S at a part φ of a step are S(1 − φ) and Sφ, beyond those of the smooth
    motion around, and the corner lies ½ S min(φ, 1 − φ) above the larger sample.
    """
    through, bend = x[1:].copy(), np.zeros(x.size)
    bend[1:-1] = np.diff(x, 2)
    for p in turns[(turns > 2) & (turns < x.size - 3)]:
        way = -math.copysign(1.0, bend[p])
        first = p if abs(bend[p + 1]) > abs(bend[p - 1]) else p - 1
        around = -way * bend[first - 1 : first + 3]
        smooth = float(np.mean(around[[0, 3]]))
        above = 0.5 * (float(around[1:3].min()) - smooth)
        if above > max(_SHARP * noise, abs(smooth)):
            through[first] = x[p] + way * above
    return through


@dataclass(frozen=True, eq=False)
class Loop:
    """A record of force and displacement, ready for the fit.

    t : s.   x : displacement, smoothed where it is noisy, m.   through : that of corners between samples, m.   v :
    velocity, m/s.   f : force, N, its sign such that energy is lost.   cycle : number of the cycle of each sample; −1
    outside of those that are fitted.   N : normal force, N, where it was measured.   load : friction force of the
    record over that of all, as the normal force makes it.
    """

    name: str
    t: Array
    x: Array
    through: Array
    v: Array
    f: Array
    cycle: Integers
    flipped: bool = False
    N: Array | None = None
    load: float = 1.0

    @classmethod
    def of(cls, name: str, t: Array, x: Array, f: Array, missing: Mask | None = None) -> Loop:
        """Return the loop of samples in equal steps, without the cycles with samples that are missing.

        Raises ValueError for too few cycles.
        """
        from scipy.signal import savgol_filter  # slow to import

        third = np.diff(x, 3)  # σ√20 of white noise
        noise = 1.4826 * float(np.median(np.abs(third - np.median(third)))) / math.sqrt(20.0)
        least = _SWING * float(np.ptp(x))
        turns = turning_points(x, least)
        minima = turns[int(x[turns[0]] > x[turns[1]]) :: 2] if turns.size > 2 else turns[:0]
        if minima.size < FEWEST_CYCLES + 2:
            raise ValueError(
                f"{name}: the displacement makes {max(minima.size - 1, 0)} cycles between reversals, and "
                f"{FEWEST_CYCLES + 1} are needed at least: a contact shows its stiffness after a reversal, and its "
                "scatter from cycle to cycle"
            )
        period = float(np.median(np.diff(minima)))
        smooth, smooth_v = (2 * int(period / of / 2) + 1 for of in (_OF_PERIOD, _OF_PERIOD_V))
        v = np.gradient(x, t)
        if smooth_v > 3:
            v = savgol_filter(x, smooth_v, 3, deriv=1, delta=(t[-1] - t[0]) / (t.size - 1))
        if noise > _SMOOTHED * np.ptp(x) and smooth > 3:
            x = savgol_filter(x, smooth, 3)
        cycle = np.searchsorted(minima[1:], np.arange(x.size), side="right") - 1
        cycle[minima[-1] :] = -1
        if missing is not None:
            cycle[np.isin(cycle, cycle[missing])] = -1
            left = np.unique(cycle[cycle >= 0])
            if left.size < FEWEST_CYCLES:
                raise ValueError(
                    f"{name}: {left.size} cycles have no missing samples, and {FEWEST_CYCLES} are needed at least"
                )
            cycle = np.where(cycle < 0, -1, np.searchsorted(left, cycle))
        loop = cls(name, t, x, corners(x, turns, noise), np.asarray(v), f, cycle)
        lost = loop.lost
        gains = lost.mean() < -_CERTAIN * lost.std(ddof=1) / math.sqrt(lost.size)
        return replace(loop, f=-f, flipped=True) if gains else loop

    @cached_property
    def cycles(self) -> int:
        """Number of cycles that are fitted."""
        return int(self.cycle.max()) + 1

    def excerpt(self, share: float, runs: int) -> Loop:
        """Return about that share of the cycles, in runs that are spread evenly; the cycle before each run settles the
        contact, and does not count."""
        length = max(1, round(share * self.cycles / runs))
        first = np.linspace(0, self.cycles - length, runs).astype(int)
        number = np.full(self.cycles + 1, -2)  # the last entry is that of the samples outside
        number[first - 1] = -1
        kept = np.unique(np.add.outer(first, np.arange(length)))
        number[kept] = np.arange(kept.size)
        (own,) = np.nonzero(number[self.cycle] > -2)
        arrays = {name: getattr(self, name)[own] for name in ("t", "x", "v", "f")}
        through = self.through[own[1:] - 1]
        return replace(self, **arrays, through=through, cycle=number[self.cycle[own]], N=None)

    def scaled(self, X: float) -> Loop:
        """Return the cycle of median amplitude, scaled to X and run through twice; the second time counts."""
        (own,) = np.nonzero(self.cycle == np.argsort(self.amplitudes)[self.cycles // 2])
        part = X / self.amplitudes[self.cycle[own[0]]]
        x, v = (part * np.tile(of, 2) for of in (self.x[own] - self.x[own].mean(), self.v[own]))
        cycle = np.repeat([-1, 0], own.size)
        t = float(self.t[1] - self.t[0]) * np.arange(x.size)
        return replace(self, t=t, x=x, through=x[1:], v=v, f=0.0 * x, cycle=cycle)

    @cached_property
    def own(self) -> Integers:
        """Indices of the samples of the cycles."""
        return np.flatnonzero(self.cycle >= 0)

    @cached_property
    def slices(self) -> list[slice]:
        """The samples of each cycle, among those of `own`."""
        ends = np.searchsorted(self.cycle[self.own], np.arange(self.cycles + 1)).tolist()
        return [slice(*pair) for pair in itertools.pairwise(ends)]

    def _reduced(self, by: np.ufunc, values: Array) -> Array:
        """Return values of each cycle taken together, (cycles,)."""
        return np.asarray(by.reduceat(values[self.own], [own.start for own in self.slices]))

    def means(self, values: Array) -> Array:
        """Return the mean of values in each cycle, (cycles,)."""
        return self._reduced(np.add, values) / [own.stop - own.start for own in self.slices]

    def by_cycle(self, values: Array) -> Array:
        """Return ∮ values dx of each cycle, (cycles,)."""
        pieces = np.append(0.5 * (values[1:] + values[:-1]) * np.diff(self.x), 0.0)
        return self._reduced(np.add, pieces)

    @cached_property
    def lost(self) -> Array:
        """Energy lost in each cycle, ∮ f dx without the drift of the force, J."""
        t, f = self.t[self.own], self.f[self.own]
        return self.by_cycle(self.f - np.polyval(np.polyfit(t, f, 1), self.t))

    @property
    def closed(self) -> Mask:
        """Which cycles end where they began, by a part of their amplitude."""
        x = self.x[self.own]
        ends = np.array([x[own.stop - 1] - x[own.start] for own in self.slices])
        return np.asarray(np.abs(ends) < 2.0 * _CLOSED * self.amplitudes)

    @cached_property
    def amplitudes(self) -> Array:
        """X of each cycle, m."""
        return 0.5 * (self._reduced(np.maximum, self.x) - self._reduced(np.minimum, self.x))
