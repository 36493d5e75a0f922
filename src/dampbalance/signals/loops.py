"""Cycles of measured loops: reversals, corners between samples, velocity, and the sign of the force."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.polynomial.legendre import legvander

from ..arrays import Array, Integers, Mask
from .thresholds import CERTAIN

FEWEST_CYCLES = 4
"""Fewest cycles in all records to which a contact is fitted; the scatter of fewer is unknown."""

# relative to the range of x, the smallest return that makes a reversal, so that levels of 1 : 20 are read
_SWING = 0.04
# relative to X, the distance at which a motion counts as passing its middle before the first or after the last reversal
_NEAR_MIDDLE = 0.05
# relative to X, the last part of the way to a reversal over which its force is averaged
_NEAR_PEAK = 0.01
_AROUND_PEAK = 0.6  # steps from the largest sample; a peak farther off is noise
_OF_PERIOD, _CLOSE = 40, 0.01  # windows per period that show reversals; relative error of ẋ
# standard deviations of the noise that a periodic motion may deviate from its mean cycle: 1 for white noise, more with
# quantization
_PERIODIC = 1.5
# highest degree of a polynomial between two turns, and standard deviations by which a term must be significant
_DEGREE, _STANDS_OUT = 24, 3.0
# samples of a run, and standard deviations of the largest of all runs
_RUN, _STANDS_OUT_OF_ALL = 8, 4.5
_FEWEST_POINTS, _ROUNDS = 16, 3  # points of a mean cycle, and iterations for its period
_DRAWS = 4  # pairs of drawings of noise
SAME_LEVEL = 0.05  # largest relative difference of the amplitudes of one level


def turning_points(x: Array, least: float) -> Integers:
    """Return the indices of the reversals of x, each followed by a return of more than `least`."""
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
    """Return the displacement that x passes through between two samples, (n − 1,): the peak if a reversal lies between
    them, otherwise the later sample.

    The peak is that of a parabola through three samples or, in a motion with kinks, such as a triangle, the corner.

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
        if above > max(CERTAIN * noise, abs(smooth)):
            through[first] = x[p] + way * above
        elif abs(slope := 0.5 * float(x[p + 1] - x[p - 1])) < _AROUND_PEAK * abs(bend[p]):
            through[p - (slope * way < 0.0)] = x[p] - 0.5 * slope**2 / bend[p]
    return through


def middles(x: Array, turns: Integers) -> Integers:
    """Return the samples at which cycles begin and the last one ends, (cycles + 1,), where x passes its middle in the
    same direction as the first time.

    The middle lies between two reversals; the median of three follows a drifting mean, but not a growing amplitude.
    """
    from scipy.ndimage import median_filter  # slow to import

    if turns.size < 2:
        return turns[:0]
    low, high = np.sort([x[turns[1:]], x[turns[:-1]]], axis=0)
    middle = np.clip(median_filter(0.5 * (low + high), 3, mode="nearest"), low, high)
    between = [np.arange(*of) for of in itertools.pairwise(turns.tolist())]
    paths = [np.arange(turns[0], -1, -1), *between, np.arange(turns[-1], x.size)]
    passes = list[int]()
    for path, level in zip(paths, middle[[0, *range(middle.size), -1]], strict=True):
        ahead = np.sign(x[path[0]] - level) * (x[path] - level)
        nearest = float(ahead.min())
        if nearest <= _NEAR_MIDDLE * ahead[0]:
            passes.append(int(path[np.argmax(ahead <= max(nearest, 0.0))]))
    return np.array(passes[::2], dtype=int)


@lru_cache(maxsize=8)
def _polynomials(size: int) -> Array:
    """Return orthonormal polynomials on `size` samples, (size, degrees)."""
    of = legvander(np.linspace(-1.0, 1.0, size), min(_DEGREE, size // 2))
    return np.asarray(np.linalg.qr(of)[0])


def _is_noise(left: Array, noise: float) -> bool:
    """Return whether a residual is white noise of a standard deviation everywhere."""
    runs = np.diff(np.cumsum(left)[::_RUN])
    worst = float(np.abs(runs).max(initial=0.0)) < _STANDS_OUT_OF_ALL * math.sqrt(_RUN) * noise
    return worst and float(np.std(left)) < _PERIODIC * noise


def mean_cycles(x: Array, begins: Integers, noise: float) -> tuple[Array, float, Array]:
    """Return a motion with each cycle replaced by the mean one, a_j x̄(φ) + b_j + d_j φ, the standard deviation of the
    remaining noise, smaller by √n for n cycles, and drawings of such noise, m, (draws, samples), each with both signs.
    A motion whose cycles differ by more than the noise is returned unchanged.

    begins : see `middles`.   noise : standard deviation, m.
    """
    from scipy.interpolate import CubicSpline  # slow to import

    count, first = begins.size - 1, int(begins[0])
    period = float(np.polyfit(np.arange(begins.size), begins, 1)[0])
    points, number = round(period), np.arange(count)
    drawn = np.random.default_rng(0).normal(0.0, noise, (_DRAWS, x.size))
    drawn = np.concatenate([drawn, -drawn])
    if count < 2 or points < _FEWEST_POINTS:
        return x, noise, drawn
    of = CubicSpline(np.arange(x.size), x)
    phase = np.arange(points) / points
    turn = np.exp(-2j * math.pi * phase)
    # the fundamental of each cycle, about its straight line, lags by the error of the period
    for _ in range(_ROUNDS):
        at = first + period * np.add.outer(number, phase)
        every = of(np.minimum(at, x.size - 1.0))
        lines = np.outer(every[:, -1] - every[:, 0], phase)
        late = np.unwrap(np.angle((every - lines) @ turn))
        period -= period * float(np.polyfit(number, late, 1)[0]) / (2.0 * math.pi)
    left, other = noise / math.sqrt(count), drawn[:, :points] / math.sqrt(count)
    mean = (every - lines).mean(axis=0)
    terms = np.array([mean, np.ones(points), phase])
    cycles = np.linalg.lstsq(terms.T, every.T)[0].T @ terms
    inside = np.arange(first, min(x.size, math.ceil(at[-1, -1])))
    smooth = CubicSpline(at.ravel(), cycles.ravel())(inside)
    if float(np.std(x[inside] - smooth)) > _PERIODIC * noise:
        return x, noise, drawn
    same = ((np.arange(x.size) - first) * points / period).astype(int) % points
    smooth = np.concatenate([x[:first], smooth, x[inside[-1] + 1 :]])
    return smooth, left, other[:, same]


def between_turns(
    x: Array, turns: Integers, noise: float, step: float, drawn: Array
) -> tuple[Array, Array, Array]:
    """Return a smoothed motion that reverses only at its turns, since a slider would follow every reversal of the
    noise, its velocity, m/s, and the errors that other drawings of the noise would have left, (draws, n).

    Between two turns it is a sum of the significant Legendre polynomials: a line for a triangle, a few for a sine. If
    the residual is more than noise, the motion stays unchanged, and parabolas give its velocity.

    noise : standard deviation, m.   step : of time, s.   drawn : other noise, m, (draws, n).
    """
    from scipy.signal import savgol_filter  # slow to import

    turns = np.array([-1, *turns, x.size - 1])
    # number of samples for which the slope of a parabola has an error of 1 % of the mean speed
    way = _CLOSE * float(np.mean(np.abs(np.diff(x[turns[1:]])) / np.diff(turns[1:])))
    window = 1 + 2 * max(1, round(0.5 * (12.0 * (noise / way) ** 2) ** (1.0 / 3.0)))
    smooth, v, errors = x.copy(), np.gradient(x, step), drawn.copy()
    for before, turn in itertools.pairwise(turns.tolist()):
        own = slice(before + 1, turn + 1)
        part = x[own]
        if part.size < window:
            continue
        Q = _polynomials(part.size)
        stands_out = np.abs(part @ Q) > _STANDS_OUT * noise
        Q = Q[:, : 1 + int(np.flatnonzero(stands_out).max(initial=0))]
        model = Q @ (Q.T @ part)
        if _is_noise(part - model, noise):
            smooth[own], v[own] = model, np.gradient(model, step)
            errors[:, own] = drawn[:, own] @ Q @ Q.T
        else:
            v[own] = savgol_filter(part, window, 2, deriv=1, delta=step)
    return smooth, v, errors


@dataclass(frozen=True, eq=False)
class Loop:
    """A record of force and displacement, prepared for the fit.

    t : s; numbers of the samples if `timed` is false.   x : smoothed displacement, m.   through : displacement passed
    through between samples, m, as `corners`.   v : velocity, m/s.   f : force, N, with the sign that dissipates energy.
    cycle : number of the cycle of each sample; −1 outside.   errors : errors of x for other drawings of its noise, m,
    (draws, n).   flipped : whether the sign of the force was changed.   N : normal force, N, if measured.
    load : friction force of the record relative to that of all records, because of its normal force.
    first : number in the record of the first cycle, counted from 1.
    """

    name: str
    t: Array
    x: Array
    through: Array
    v: Array
    f: Array
    cycle: Integers
    errors: Array
    flipped: bool = False
    N: Array | None = None
    load: float = 1.0
    timed: bool = True
    first: int = 1

    @classmethod
    def of(
        cls, name: str, t: Array, x: Array, f: Array, missing: Mask | None = None, skipped: int = 0
    ) -> Loop:
        """Return the loop of samples in equal steps, without cycles with missing samples.

        skipped : cycles to leave out at the start.

        Raises ValueError if no cycle remains.
        """
        from scipy.signal import savgol_filter  # slow to import

        third = np.diff(x, 3)  # σ√20 of white noise
        noise = 1.4826 * float(np.median(np.abs(third - np.median(third)))) / math.sqrt(20.0)
        turns = turning_points(x, _SWING * float(np.ptp(x)))
        begins = middles(x, turns)
        if begins.size < 2 + skipped:
            raise ValueError(
                f"{name}: the displacement makes {max(begins.size - 1, 0)} complete cycles, to one side, to the other "
                f"and back, and {1 + skipped} are needed at least"
            )
        period = float(np.median(np.diff(begins)))
        window = max(2 * int(period / _OF_PERIOD / 2) + 1, 3)
        x, noise, drawn = mean_cycles(x, begins, noise)
        if window > 3:
            turns = turning_points(savgol_filter(x, window, 3), _SWING * float(np.ptp(x)))
        step = float(t[-1] - t[0]) / (t.size - 1)
        x, v, errors = between_turns(x, turns, noise, step, drawn)
        cycle = np.searchsorted(begins[skipped:], np.arange(x.size), side="right") - 1
        cycle[begins[-1] :] = -1
        if missing is not None:
            cycle[np.isin(cycle, cycle[missing])] = -1
            left = np.unique(cycle[cycle >= 0])
            if not left.size:
                raise ValueError(f"{name}: samples are missing in each of its cycles")
            cycle = np.where(cycle < 0, -1, np.searchsorted(left, cycle))
        through = corners(x, turns, noise)
        loop = cls(name, t, x, through, v, f, cycle, errors, first=skipped + 1)
        lost = loop.lost / loop.amplitudes
        scatter = lost.std(ddof=1) / math.sqrt(lost.size) if lost.size > 1 else 0.0
        gains = lost.mean() < -CERTAIN * scatter
        return replace(loop, f=-f, flipped=True) if gains else loop

    def settled(self) -> Loop:
        """Return the loop without the first cycle of the record, before which the state of the contact is unknown."""
        if self.first > 1:
            return self
        return replace(self, cycle=np.maximum(self.cycle - 1, -1), first=2)

    @cached_property
    def cycles(self) -> int:
        """Number of cycles that are fitted."""
        return int(self.cycle.max()) + 1

    def excerpt(self, share: float, runs: int) -> Loop:
        """Return a share of the cycles in evenly spread runs; the cycle before each run settles the contact and does
        not count."""
        length = max(1, round(share * self.cycles / runs))
        first = np.linspace(0, self.cycles - length, runs).astype(int)
        number = np.full(self.cycles + 1, -2)  # the last entry is that of the samples outside
        number[first - 1] = -1
        kept = np.unique(np.add.outer(first, np.arange(length)))
        number[kept] = np.arange(kept.size)
        (own,) = np.nonzero(number[self.cycle] > -2)
        arrays = {name: getattr(self, name)[own] for name in ("t", "x", "v", "f")}
        through, errors = self.through[own[1:] - 1], self.errors[:, own]
        return replace(
            self, **arrays, through=through, errors=errors, cycle=number[self.cycle[own]], N=None
        )

    def scaled(self, X: float) -> Loop:
        """Return the cycle of median amplitude, scaled to X and repeated once; only the repetition counts."""
        (own,) = np.nonzero(self.cycle == np.argsort(self.amplitudes)[self.cycles // 2])
        part = X / self.amplitudes[self.cycle[own[0]]]
        x, v = (part * np.tile(of, 2) for of in (self.x[own] - self.x[own].mean(), self.v[own]))
        cycle = np.repeat([-1, 0], own.size)
        t = float(self.t[1] - self.t[0]) * np.arange(x.size)
        return replace(self, t=t, x=x, through=x[1:], v=v, f=0.0 * x, cycle=cycle)

    @property
    def drawn(self) -> list[Loop]:
        """The loop with other drawings of the noise of its displacement."""
        return [replace(self, x=self.x + of, through=self.through + of[1:]) for of in self.errors]

    @cached_property
    def own(self) -> Integers:
        """Indices of the samples of the cycles."""
        return np.flatnonzero(self.cycle >= 0)

    @cached_property
    def slices(self) -> list[slice]:
        """The samples of each cycle, as slices of `own`."""
        ends = np.searchsorted(self.cycle[self.own], np.arange(self.cycles + 1)).tolist()
        return [slice(*pair) for pair in itertools.pairwise(ends)]

    def means(self, values: Array) -> Array:
        """Return the means of values over each cycle, (cycles,)."""
        cycle = self.cycle[self.own]
        return np.asarray(np.bincount(cycle, values[self.own]) / np.bincount(cycle))

    def by_cycle(self, values: Array) -> Array:
        """Return ∮ values dx of each cycle, closed by a straight line from the last sample to the first, (cycles,)."""
        x, values, after = self.x[self.own], values[self.own], np.arange(1, self.own.size + 1)
        after[[own.stop - 1 for own in self.slices]] = [own.start for own in self.slices]
        pieces = 0.5 * (values[after] + values) * (x[after] - x)
        return np.asarray(np.add.reduceat(pieces, [own.start for own in self.slices]))

    @cached_property
    def lost(self) -> Array:
        """Energy lost in each cycle, ∮ f dx, J."""
        return self.by_cycle(self.f)

    @cached_property
    def peaks(self) -> Array:
        """Largest and smallest displacement of each cycle, m, and the force just before each, N, (cycles, 4)."""
        peaks = []
        for own in self.slices:
            x, f = self.x[self.own[own]], self.f[self.own[own]]
            ends, X = [int(x.argmax()), int(x.argmin())], 0.5 * np.ptp(x)
            near = [np.abs(x[: end + 1] - x[end]) <= _NEAR_PEAK * X for end in ends]
            peaks.append([*x[ends], *(f[: of.size][of].mean() for of in near)])
        return np.array(peaks)

    @cached_property
    def amplitudes(self) -> Array:
        """X of each cycle, m."""
        return np.asarray(0.5 * (self.peaks[:, 0] - self.peaks[:, 1]))

    @cached_property
    def closed(self) -> Mask:
        """Whether each cycle ends within an amplitude of its start; otherwise the mean drifts, and X is no
        amplitude."""
        x = self.x[self.own]
        travel = [x[own.stop - 1] - x[own.start] for own in self.slices]
        return np.asarray(np.abs(travel) <= self.amplitudes)


def levels_of(X: Array) -> list[Integers]:
    """Return the cycles of each level, whose amplitudes differ by 5 % at most, in ascending order of amplitude."""
    order, levels = np.argsort(X, kind="stable"), list[Integers]()
    while order.size:
        same = X[order] <= (1.0 + SAME_LEVEL) * X[order[0]]
        levels.append(np.sort(order[same]))
        order = order[~same]
    return levels


def measures(X: Any, W: Any, peaks: Array) -> dict[str, Any]:
    """Return model-free measures of loops, by keys of `identification.json`: W/(4X), the friction force of a rigid
    contact with this loss; the secant stiffness k_s between the forces at the largest displacements, NaN if these
    forces do not oppose each other; ζ_eq = W/(4π · ½ k_s X²) (Chopra, Dynamics of Structures, Sec. 3.9); and the
    backbone.

    X : amplitude, m; NaN for a cycle that does not close.   W : energy lost in a cycle, J.   peaks : as `Loop.peaks`.
    """
    high, low, up, down = peaks.T
    stiffness = np.where((up > down) & (X > 0.0), (up - down) / (high - low), math.nan)
    return {
        "W_over_4X_N": W / (4.0 * X),
        "secant_stiffness_N_per_m": stiffness,
        "equivalent_damping_ratio": W / (2.0 * math.pi * stiffness * X**2),
        "largest_displacement_m": high,
        "force_at_largest_displacement_N": up,
        "smallest_displacement_m": low,
        "force_at_smallest_displacement_N": down,
    }
