"""Harmonics of a signal, cycle by cycle, by least squares: any number of samples per cycle, in bounded memory.

Cycle j is the time from start + jT to start + (j + 1)T, T = 2π/ω. Its samples are fitted by

    s(t) = Re Σ c_n e^{inωt},   n = 0 … N

The normal equations of samples in equal steps depend on how many there are in the cycle alone, which is one of two
numbers: two small systems serve the whole record, and all that is done sample by sample is one matrix product.

Records of any length pass through in blocks. When more than 2,048 rows (cycles) have gathered, neighbours are
averaged and a row stands for twice as many cycles.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complexes, Mask
from ..project.wording import Remark

Samples = tuple[Array, Array]  # times, values

_MOST_ROWS = 2048
_CYCLES_AT_ONCE = 256
_MOST_AT_ONCE = 1 << 20  # samples worked on at once: 8 MB an array
_OUTLYING = 1.5  # mean square of a cycle about its harmonics, relative to that of the others
_HELD = 5  # equal samples in a row that may be a drop-out
# Ratio of a jump to the steps nearby: a signal that was held goes on with a jump of five of them or more.
_JUMPS = 2.0
# Steps of a converter: farther from a level, rounding does not hide how a signal approaches it.
_CLEAR_STEPS = 6.0
_CLEAR_SAMPLES = 4  # likewise
_STOPPING = 2.85  # ratio of distances, between the 2.2 to 2.8 of a cut, whose end lies between two samples, and 4
_SCATTERED = 1.25  # samples at the level over those in a row: noise on a cut scatters them
_AROUND = 8  # cycles that a cycle is compared with
# Rms of the residual, as a part of the range, that a signal without noise may leave (because of drift, say).
_HARMLESS = 1e-3
_LONGEST_CYCLE = 1 << 22  # samples; beyond it the drive is not what it seems


@dataclass(frozen=True, eq=False)
class CycleHarmonics:
    """Harmonics of one channel, row by row; a row is a cycle, or the mean of several successive ones.

    omega : rad/s.   start : of the first cycle, s.   dt : sampling interval, s.
    coefficients : c_n, shape (rows, N + 1), unit of the channel; c_0 is the mean.
    cycles_per_row : cycles that a row stands for.   weights : usable cycles in each row, shape (rows,).
    drift : what a signal τ, and what τ² adds to c_n, τ in s from the middle of the cycle, shape (2, N + 1).
    bad_cycles : cycles left out and why, (number, time s, reason).
    span : difference between the highest and the lowest value.
    clipped : part of the usable cycles whose highest or lowest value is held as a clipped signal holds it.
    """

    omega: float
    start: float
    dt: float
    coefficients: Complexes
    cycles_per_row: int
    weights: Array
    drift: Complexes
    bad_cycles: tuple[tuple[int, float, Remark], ...]
    span: float
    clipped: float

    @property
    def times(self) -> Array:
        """Middle of each row, s."""
        duration = self.cycles_per_row * 2.0 * math.pi / self.omega
        return self.start + duration * (np.arange(len(self.weights), dtype=np.float64) + 0.5)


def accumulate(
    blocks: Iterable[Samples],
    omega: float,
    *,
    start: float,
    dt: float,
    harmonics: int,
    cycles: int = sys.maxsize,
) -> CycleHarmonics:
    """The harmonics of every cycle of a signal that comes in blocks.

    blocks : (t, values), successive; t in steps of dt, gaps apart.   omega : rad/s.   start : of the first cycle, s.
    dt : sampling interval, s.   harmonics : N.   cycles : how many to take at the most.

    A cycle with a gap, or with samples that are held or spike, is left out and listed. Raises ValueError when a cycle
    has too few samples for N.
    """
    work = _Accumulator(omega, start, dt, harmonics, cycles)
    for t, values in blocks:
        work.add(t, values)
        if work.next_cycle >= cycles:
            break
    return work.result()


class _Accumulator:
    """Takes blocks of a signal, keeps the rows of its harmonics and the samples of the cycle that is not complete."""

    def __init__(self, omega: float, start: float, dt: float, harmonics: int, cycles: int) -> None:
        self.omega, self.start, self.dt, self.cycles = omega, start, dt, cycles
        self.period = 2.0 * math.pi / omega
        self.count = harmonics + 1
        self.shortest = math.floor(self.period / dt * (1.0 - 1e-9))
        if self.shortest < 2 * harmonics + 2:
            raise ValueError(
                f"{self.period / dt:.1f} samples per cycle are too few for {harmonics} harmonics"
            )
        if self.shortest > _LONGEST_CYCLE:
            raise ValueError(f"{self.shortest} samples per cycle are more than can be worked on")
        self.longest = self.shortest + 2  # rounding of times may give and take a sample
        self.next_cycle = 0
        self.carry: Samples = (np.empty(0), np.empty(0))
        self.rows: list[Complexes] = []  # sums of harmonics, number of usable cycles
        self.waiting = np.zeros((0, self.count + 1), dtype=np.complex128)  # cycles for the next row
        self.cycles_per_row = 1
        self.drift = np.zeros((2, self.count), dtype=np.complex128)
        self.drift_cycles = 0
        self.bad: list[tuple[int, float, Remark]] = []
        self.held_at_extreme = 0
        self.highest, self.lowest = -math.inf, math.inf
        self.usable = 0
        angle = omega * dt * np.outer(np.arange(self.longest), np.arange(self.count))
        # s @ fourier = Re, Im of Σ s e^{−inωt}
        self.fourier = np.hstack([np.cos(angle), -np.sin(angle)])
        self.systems: dict[int, tuple[Complexes, Complexes]] = {}

    def _system(self, length: int) -> tuple[Complexes, Complexes]:
        """For cycles of so many samples: the inverse normal matrix, and the harmonics of a drift."""
        if length in self.systems:
            return self.systems[length]
        # Σ e^{−iqωr dt} over the samples r of the cycle, q = −2N … 2N, is all that the normal matrix holds
        q = np.arange(2 - 2 * self.count, 2 * self.count - 1)
        half = 0.5 * self.omega * self.dt * q
        sums = np.full(q.size, float(length), dtype=np.complex128)
        ratio = np.sin(length * half[q != 0]) / np.sin(half[q != 0])
        sums[q != 0] = np.exp(-1j * (length - 1) * half[q != 0]) * ratio
        n = np.arange(1 - self.count, self.count)
        inverse = np.linalg.inv(sums[n[:, None] - n[None, :] + 2 * self.count - 2])
        inverse = inverse[self.count - 1 :]
        inverse[1:] *= 2.0  # c_n is twice the coefficient of e^{inωt}, c_0 the mean
        tau = self.dt * (np.arange(length) - 0.5 * (length - 1))
        product = np.array([tau, tau**2]) @ self.fourier[:length]
        drift = product[:, : self.count] + 1j * product[:, self.count :]
        drift = np.hstack([drift[:, :0:-1].conj(), drift]) @ inverse.T
        self.systems[length] = inverse, drift
        return inverse, drift

    def add(self, t: Array, values: Array) -> None:
        """Take one block."""
        t, values = np.asarray(t, dtype=np.float64), np.asarray(values, dtype=np.float64)
        if values.size:
            self.highest = max(self.highest, float(values.max()))
            self.lowest = min(self.lowest, float(values.min()))
        if self.carry[0].size:
            t, values = np.concatenate([self.carry[0], t]), np.concatenate([self.carry[1], values])
        if t.size == 0:
            return
        # a cycle is complete when the next sample would lie beyond it
        complete = math.floor((t[-1] + self.dt * (1.0 + 1e-6) - self.start) / self.period)
        last = min(complete, self.cycles)
        at_once = max(1, min(_CYCLES_AT_ONCE, _MOST_AT_ONCE // self.longest))
        while self.next_cycle < last:
            number = np.arange(self.next_cycle, min(last, self.next_cycle + at_once) + 1)
            edges = np.searchsorted(
                t, self.start + number * self.period - 1e-6 * self.dt, side="left"
            )
            self._cycles(t, values, number[:-1], edges)
            self.next_cycle = int(number[-1])
        first = int(np.searchsorted(t, self.start + self.next_cycle * self.period - 1e-6 * self.dt))
        self.carry = (t[first:].copy(), values[first:].copy())

    def _cycles(
        self, t: Array, values: Array, number: NDArray[np.int_], edges: NDArray[np.intp]
    ) -> None:
        """The harmonics of the cycles whose samples lie between successive edges."""
        begin, length = edges[:-1], np.diff(edges)
        whole = (length >= self.shortest) & (length <= self.longest)
        end = np.minimum(begin + np.maximum(length, 1), t.size) - 1
        begin = np.minimum(begin, t.size - 1)
        whole &= np.abs(t[end] - t[begin] - (length - 1) * self.dt) < 0.5 * self.dt
        steps = np.arange(self.longest)
        at = np.minimum(begin[:, None] + steps, t.size - 1)
        inside = steps < length[:, None]
        s = np.where(inside, values[at], 0.0)
        # the time of a cycle's first sample, from all of them: time stamps may be rounded
        t0 = np.where(inside, t[at] - self.dt * steps, 0.0).sum(axis=1) / np.maximum(length, 1)

        product = s @ self.fourier
        sums = product[:, : self.count] + 1j * product[:, self.count :]
        both = np.hstack([sums[:, :0:-1].conj(), sums])
        local = np.zeros((len(number), self.count), dtype=np.complex128)
        turn = np.exp(-1j * self.omega * np.outer(t0, np.arange(self.count)))
        for n_samples in np.unique(length[whole]):
            chosen = whole & (length == n_samples)
            inverse, drift = self._system(int(n_samples))
            local[chosen] = both[chosen] @ inverse.T
            self.drift += drift * turn[chosen].sum(axis=0)
        self.drift_cycles += int(whole.sum())
        fitted = np.einsum("jn,jn->j", local.conj(), sums).real
        square = np.maximum(np.einsum("jr,jr->j", s, s) - fitted, 0.0)
        square /= np.maximum(length - 2 * self.count + 1, 1)

        due = self.period / self.dt
        gap = partial(Remark, "a gap: {} samples where there should be {:.1f}")
        faults = {int(j): gap(int(length[j]), due) for j in np.flatnonzero(~whole)}
        faults |= self._faults(s, inside, local, square, whole)
        for j, reason in faults.items():
            when = float(self.start + number[j] * self.period)
            self.bad.append((int(number[j]), when, reason))
        whole[list(faults)] = False
        self._extremes(s, inside, whole)
        self.usable += int(whole.sum())
        self._gather(local * turn, whole)

    def _faults(
        self, s: Array, inside: Mask, local: Complexes, square: Array, whole: Mask
    ) -> dict[int, Remark]:
        """Which cycles hold samples that stand still while the signal moves on, or that lie far off it."""
        if not whole.any():
            return {}
        rms = math.sqrt(float(np.median(square[whole])))
        usual = max(rms, _HARMLESS * float(np.ptp(s[inside])))
        still = _three_in_a_row((s[:, 1:] == s[:, :-1]) & inside[:, 1:])  # four equal samples
        outlying = square > _OUTLYING * usual**2
        suspect = whole & (still | outlying)
        if not suspect.any():
            return {}
        model = np.hstack([local.real, local.imag]) @ self.fourier.T
        off = np.where(inside, np.abs(s - model), 0.0)
        good = np.flatnonzero(whole & ~outlying)
        limit = max(8.0 * usual, 2.0 * float(np.max(off[good[:_AROUND]], initial=0.0)))
        faults = {}
        for j in np.flatnonzero(suspect).tolist():
            size, worst = inside[j].sum(), int(np.argmax(off[j]))
            around = good[good != j]
            around = around[np.argsort(np.abs(around - j), kind="stable")[:_AROUND]]
            reason = _held(s[j, :size], s[around] if around.size > 2 else model[j : j + 1], rms)
            if not reason and outlying[j] and off[j, worst] > limit:
                reason = Remark(
                    "a spike: {:.6g} where {:.6g} is expected", s[j, worst], model[j, worst]
                )
            if reason:
                faults[j] = reason
        return faults

    def _extremes(self, s: Array, inside: Mask, whole: Mask) -> None:
        """Count the cycles whose highest or lowest value is held as a clipped signal holds it."""
        if not whole.any():
            return
        s, inside = s[whole], inside[whole]
        clipped = np.zeros(len(s), dtype=np.bool_)
        for sign in (1.0, -1.0):
            high = np.where(inside, sign * s, -np.inf)
            top = high.max(axis=1)
            highest = np.flatnonzero(top == top.max())
            clipped[highest] |= _cut_off(high[highest])
        self.held_at_extreme += int(clipped.sum())

    def _gather(self, harmonics: Complexes, whole: Mask) -> None:
        """Append cycles to the rows, as many to a row as it stands for; join rows when there are many."""
        weights = whole.astype(np.float64)
        waiting = np.column_stack([harmonics * weights[:, None], weights])
        waiting = np.concatenate([self.waiting, waiting])
        full = len(waiting) // self.cycles_per_row * self.cycles_per_row
        self.rows.append(_joined(waiting[:full], self.cycles_per_row))
        self.waiting = waiting[full:]
        rows = sum(map(len, self.rows))
        while rows > _MOST_ROWS and rows % 2 == 0:
            self.rows = [_joined(np.concatenate(self.rows), 2)]
            self.cycles_per_row *= 2
            rows //= 2

    def result(self) -> CycleHarmonics:
        """The rows; cycles that do not fill a row at the end are left out."""
        rows = np.concatenate([self.waiting[:0], *self.rows])
        weights = rows[:, -1].real
        with np.errstate(invalid="ignore", divide="ignore"):
            coefficients = rows[:, :-1] / weights[:, None]
        return CycleHarmonics(
            omega=self.omega,
            start=self.start,
            dt=self.dt,
            coefficients=coefficients,
            cycles_per_row=self.cycles_per_row,
            weights=weights,
            drift=self.drift / max(1, self.drift_cycles),
            bad_cycles=tuple(self.bad),
            span=max(0.0, self.highest - self.lowest),
            clipped=self.held_at_extreme / max(1, self.usable),
        )


def _three_in_a_row(true: Mask) -> Mask:
    """Mask of the rows that are true at three neighbouring places."""
    return np.asarray((true[:, 2:] & true[:, 1:-1] & true[:, :-2]).any(axis=1))


def _cut_off(high: Array) -> Mask:
    """Which rows hold their highest value as a clipped signal does.   high : rows × samples, −∞ after the last one."""
    top = high.max(axis=1)
    at_top = high == top[:, None]
    count = at_top.sum(axis=1)
    # A sinusoid in steps of a converter dwells at its top level at most 1/(√2 − 1) = 2.4 times as long as at the next;
    # noise shortens that. A clipped one dwells there alone, and so does a motion that stops.
    below = np.where(at_top, -np.inf, high)
    next_level = below.max(axis=1)
    next_count = (below == next_level[:, None]).sum(axis=1)
    held: Mask = _three_in_a_row(at_top) & (count > 4 * next_count)
    for j in np.flatnonzero(held).tolist():
        size = int(np.isfinite(high[j]).sum())
        held[j] = not _comes_to_rest(high[j, :size], top[j] - next_level[j])
    return held


def clipped(values: Array) -> bool:
    """Whether a free motion is held at its highest or its lowest value as a clipped signal is; what it begins with or
    ends at does not count: it may have been held there, or have come to rest."""
    for high in (values, -values):
        below = np.flatnonzero(high < high.max())
        if below.size and _cut_off(high[None, below[0] : below[-1] + 1])[0]:
            return True
    return False


def _joined(rows: Complexes, count: int) -> Complexes:
    """Sums of `count` successive rows."""
    return rows.reshape(-1, count, rows.shape[1]).sum(axis=1)


def _held(s: Array, others: Array, rms: float) -> Remark:
    """Whether samples of a cycle hold one value while the signal moves on; nothing if not.

    A converter repeats a value while the signal stays within one of its steps, in every cycle at the same place. A
    drop-out repeats it in this cycle alone: in the cycles around, the signal moves on by more than a step and five
    times its noise. A step is at most the smaller of those into and out of the equal samples. Cycles begin up to a
    sample apart, so the first and the last of these are left out. Nor do the highest and the lowest value count: what
    is held there is clipped.

    s : samples of the cycle, (n,).   others : of cycles around, (cycles, ≥ n).   rms : of the noise.
    """
    steps = np.abs(np.diff(s, prepend=np.nan, append=np.nan))
    edges = np.flatnonzero(steps)  # NaN counts
    starts, stops = edges[:-1], edges[1:]
    long = (stops - starts >= _HELD) & (s[starts] < s.max()) & (s[starts] > s.min())
    starts, stops = starts[long], stops[long]
    moved = np.abs(np.median(others[:, stops - 2] - others[:, starts + 1], axis=0))
    held = moved > np.fmin(steps[starts], steps[stops]) + 5.0 * rms
    # A motion that stops goes on as it came, gently; what is held jumps to where the signal has gone meanwhile, by
    # more than it moves there from sample to sample. Stops begin and end a little earlier or later in each cycle.
    pace = np.abs(np.diff(others[:, : s.size], axis=1)).max(axis=0)
    for i in np.flatnonzero(held).tolist():
        jump = np.fmax(steps[starts[i]], steps[stops[i]])
        length = stops[i] - starts[i]
        near = pace[max(starts[i] - length, 0) : stops[i] + length]
        held[i] = jump > _JUMPS * near.max() + 5.0 * rms
    if not held.any():
        return Remark("")
    longest = int(np.argmax(np.where(held, stops - starts, 0)))
    value = s[starts[longest]]
    size = int(stops[longest] - starts[longest])
    return Remark("a drop-out: {} samples hold the value {:.6g}", size, value)


def _comes_to_rest(s: Array, step: float) -> bool:
    """Whether the longest run of samples at the highest value is a stop, which the signal nears and leaves without
    speed, and no cut through its peak.

    At q and 2q samples from a stop the signal is lower by amounts in the ratio of 1 to 4, or more; from the ends of a
    cut of p samples by 1 to 2(p + 2q)/(p + q), 2.2 for q = p/8. q is long enough for four samples and for six steps of
    the converter, which round the ends away, and p at least 4q: a shorter one is taken for a cut.

    s : samples of a cycle, (n,), its first following its last.   step : to the next lower value.
    """
    size, drop = s.size, s.max() - s
    ends = np.flatnonzero(drop == 0.0)
    gaps = np.diff(ends, append=ends[0] + size)
    breaks = np.flatnonzero(gaps > 1)
    if not breaks.size:
        return False
    lengths = np.diff(breaks, prepend=breaks[-1] - ends.size)
    last = int(np.argmax(lengths))
    length, stop = int(lengths[last]), int(ends[breaks[last]])
    if ends.size > _SCATTERED * length:
        return False
    ratios = []
    for edge, way in ((stop, 1), (stop - length + 1, -1)):
        along = drop[(edge + way * np.arange(1, size - length + 1)) % size]
        far = np.flatnonzero(along >= _CLEAR_STEPS * step)
        q = max(length // 8, _CLEAR_SAMPLES, int(far[0]) + 1 if far.size else size)
        if 4 * q > length or 2 * q > along.size or not along[q - 1] > 0.0:
            return False
        ratios.append(along[2 * q - 1] / along[q - 1])
    return bool(min(ratios) > _STOPPING)
