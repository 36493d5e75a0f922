"""Harmonics of a signal, cycle by cycle, and its frequency, by least squares for any number of samples per cycle.

Cycle j is the time from start + jT to start + (j + 1)T, T = 2π/ω. Its samples are fitted by

    s(t) = Re Σ c_n e^{inωt},   n = 0 … N

For samples in equal steps the normal equations depend only on the number of samples in the cycle, which is one of two:
two small systems serve the whole record, and only one matrix product involves all samples.

If a record has more than 2,048 rows (cycles), neighbouring rows are averaged.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ..arrays import Array, Complexes, Integers, Mask
from ..findings.finding import Finding
from ..records.channel import Correction

Numbers = TypeVar("Numbers", Array, Complexes)

_MOST_AT_ONCE = 1 << 20  # samples processed at once, 8 MB per array
_OUTLYING = 1.5  # a cycle whose residual variance exceeds that of the others by this factor may contain a spike
# cycles that a cycle is compared with: enough for a median, and few enough for a slow change
_AROUND = 8
FEWEST_CYCLES = 3  # whose scatter has two degrees of freedom


@dataclass(frozen=True, eq=False)
class CycleHarmonics:
    """Harmonics of one channel, row by row; a row is a cycle, or the mean of several successive ones.

    omega : rad/s.   start : of the first cycle, s.   dt : sampling interval, s.   first : time of a sample, s.
    coefficients : c_n, shape (rows, N + 1), unit of the channel; c_0 is the mean.
    cycles_per_row : cycles that a row stands for.   weights : usable cycles in each row, shape (rows,).
    drift : harmonics c_n of the signals τ and τ², τ in s from the middle of the cycle, shape (2, N + 1).
    bad_cycles : cycles left out and why, (number, time s, reason).
    span : difference between the highest and the lowest value.
    clipped : share of the usable cycles that are flat at the highest or the lowest value of the signal.
    correction : known effect of the channel, not yet removed; None for none.
    """

    omega: float
    start: float
    dt: float
    coefficients: Complexes
    cycles_per_row: int
    weights: Array
    drift: Complexes
    bad_cycles: tuple[tuple[int, float, Finding], ...]
    span: float
    clipped: float
    first: float = 0.0
    correction: Correction | None = None

    @property
    def times(self) -> Array:
        """Middle of each row, s."""
        duration = self.cycles_per_row * 2.0 * math.pi / self.omega
        return self.start + duration * (np.arange(len(self.weights), dtype=np.float64) + 0.5)


def cycle_harmonics(
    t: Array,
    values: Array,
    omega: float,
    *,
    start: float,
    dt: float,
    harmonics: int,
    cycles: int = sys.maxsize,
    missing: Mask | None = None,
) -> CycleHarmonics:
    """Return the harmonics of every whole cycle of a signal.

    t : s, in steps of dt.   omega : rad/s.   start : of the first cycle, s.   harmonics : N.   cycles : most cycles to
    take.   missing : mask of the samples that the record lacks.

    Cycles with missing samples, drop-outs or spikes are left out and listed. Raises ValueError if a cycle has too few
    samples for N.
    """
    work = _Cycles(omega, dt, harmonics)
    # a cycle is complete if the next sample would lie beyond it
    complete = math.floor((t[-1] + dt * (1.0 + 1e-6) - start) / work.period)
    starts = start + np.arange(min(complete, cycles) + 1) * work.period
    edges = np.searchsorted(t, starts - 1e-6 * dt)
    count = max(0, edges.size - 1)
    at_once = max(1, _MOST_AT_ONCE // work.longest)
    rows, clipped = np.zeros((count, harmonics + 2), dtype=np.complex128), 0
    bad: list[tuple[int, float, Finding]] = []
    for first in range(0, count, at_once):
        chosen = slice(first, first + at_once)
        of_chosen = edges[first : first + at_once + 1]
        rows[chosen], faults, flat = work.rows(t, values, of_chosen, missing)
        clipped += flat
        bad += [(first + j, start + (first + j) * work.period, why) for j, why in faults.items()]
    per_row = 1
    # more rows do not improve the estimate of the scatter, but slow down each bootstrap
    while len(rows) // per_row > 2048:
        per_row *= 2
    rows = rows[: len(rows) // per_row * per_row].reshape(-1, per_row, harmonics + 2).sum(axis=1)
    weights = rows[:, -1].real
    with np.errstate(invalid="ignore", divide="ignore"):
        coefficients = rows[:, :-1] / weights[:, None]
    return CycleHarmonics(
        omega=omega,
        start=start,
        dt=dt,
        coefficients=coefficients,
        cycles_per_row=per_row,
        weights=weights,
        drift=work.drift / max(1, count),
        bad_cycles=tuple(bad),
        span=float(np.ptp(values)) if values.size else 0.0,
        clipped=clipped / max(1, count - len(bad)),
        first=float(t[0]),
    )


def drive_frequency(t: Array, values: Array, dt: float) -> tuple[float, float]:
    """Return (ω, standard error of ω), rad/s, of the strongest sinusoid of a signal in steps of dt.

    The highest line of a windowed spectrum is a first guess; its error is the slope of the phase of the fundamental,
    cycle by cycle, over time. For white noise this is least squares on the sinusoid and reaches the Cramér–Rao bound
    (Rife & Boorstyn 1974), var ω = 12σ² · 2/(A²n)/duration², for n samples with noise σ and an amplitude A.

    Raises ValueError if there is no sinusoid, or if the signal is shorter than three of its cycles.
    """
    omega = _strongest_line(values, dt)
    error = math.nan
    # two corrections suffice, except for few cycles
    for _ in range(4):
        hertz, per_cycle = omega / (2.0 * math.pi), 2.0 * math.pi / omega / dt
        cycles = math.floor((t[-1] - t[0] + dt * (1.0 + 1e-6)) * hertz)
        if cycles < FEWEST_CYCLES:
            raise ValueError(
                f"the signal is {t[-1] - t[0]:.4g} s long, {cycles} whole cycles of its {hertz:.4g} Hz; at "
                f"least {FEWEST_CYCLES} are needed: record longer"
            )
        highest = min(3, math.floor(per_cycle / 4.0))
        if highest < 1:
            raise ValueError(
                f"{per_cycle:.1f} samples per cycle at {hertz:.4g} Hz are too few: sample faster"
            )
        harmonics = cycle_harmonics(
            t, values, omega, start=float(t[0]), dt=dt, harmonics=highest, cycles=cycles
        )
        correction, error = frequency_offset(harmonics)
        omega += correction
        # each correction is thousands of times smaller than the one before
        if abs(correction) <= 10.0 * error or abs(correction) < 1e-13 * omega:
            return omega, error
    return omega, error


def frequency_offset(harmonics: CycleHarmonics) -> tuple[float, float]:
    """Return (Δω, its standard error), rad/s, by which the drive exceeds the ω of the harmonics: the slope of the phase
    of the fundamental over time, by least squares."""
    usable = harmonics.weights > 0.0
    if np.count_nonzero(usable) < FEWEST_CYCLES:
        return 0.0, math.nan
    phase = np.unwrap(np.angle(harmonics.coefficients[usable, 1]))
    w = np.sqrt(harmonics.weights[usable])
    (slope, _), covariance = np.polyfit(harmonics.times[usable], phase, 1, w=w, cov=True)
    return float(slope), math.sqrt(covariance[0, 0])


def _strongest_line(values: Array, dt: float) -> float:
    """Return the angular frequency of the highest line of the spectrum (Hann window), interpolated by a parabola
    through the logarithms."""
    size = values.size
    # a transform of another length can take ten times as long
    padded = 1 << (size - 1).bit_length()
    spectrum = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(size), padded))
    spectrum[0] = 0.0
    line = int(np.argmax(spectrum[:-1])) if size > 4 else 0
    if line == 0 or not spectrum[line] > 0.0:
        raise ValueError("the signal does not oscillate: its spectrum has no line")
    low, middle, high = np.log(np.maximum(spectrum[line - 1 : line + 2], 1e-300))
    shift = 0.5 * (low - high) / (low - 2.0 * middle + high) if line > 1 else 0.0
    return 2.0 * math.pi * (line + min(max(shift, -0.5), 0.5)) / (padded * dt)


class _Cycles:
    """Least-squares harmonics of cycles in steps of dt, and the sum of those of a drift (`drift`)."""

    def __init__(self, omega: float, dt: float, harmonics: int) -> None:
        self.omega, self.dt, self.period = omega, dt, 2.0 * math.pi / omega
        self.shortest = math.floor(self.period / dt * (1.0 - 1e-9))
        if self.shortest < 2 * harmonics + 2:
            raise ValueError(
                f"{self.period / dt:.1f} samples per cycle are too few for {harmonics} harmonics"
            )
        if self.shortest > _MOST_AT_ONCE:  # the frequency of the drive is wrong
            raise ValueError(f"{self.shortest} samples per cycle are more than {_MOST_AT_ONCE}")
        self.longest = self.shortest + 2  # with rounded times a cycle may gain a sample
        self.drift = np.zeros((2, harmonics + 1), dtype=np.complex128)
        self.n, self.last = np.arange(harmonics + 1), np.arange(self.shortest, self.longest)
        # e^{−inωr dt} of sample r, (longest, N + 1)
        self.fourier = powers(np.exp(-1j * omega * dt * np.arange(self.longest)), self.n.size)
        self.system = cache(self._system)

    def _system(self, length: int) -> tuple[Array, Array, Complexes, Complexes]:
        """Return, for cycles of `length` samples and the time τ from the middle, the inverse normal matrices of the
        cosines and of the sines, e^{−inωτ} of the first sample, and the harmonics of τ and τ²."""
        # the normal matrices consist of Σ cos qωτ, q = 0 … 2N; cosines and sines are orthogonal
        n, angle = self.n, self.omega * self.dt
        half = 0.5 * angle * np.arange(1, 2 * n.size - 1)
        sums = np.concatenate([[float(length)], np.sin(length * half) / np.sin(half)])
        apart, together = sums[np.abs(n[:, None] - n)], sums[n[:, None] + n]
        normal = np.stack([apart + together, apart - together])
        normal[1, 0, 0] = 1.0  # the mean has no sine
        cosines, sines = 2.0 * np.linalg.inv(normal)
        lead = np.exp(0.5j * angle * (length - 1) * n)
        tau = self.dt * (np.arange(length) - 0.5 * (length - 1))
        along = np.array([tau, tau**2]) @ self.fourier[:length].view(np.float64)
        along = along.view(np.complex128) * lead
        drift = np.array([1j * (along[0].imag @ sines), along[1].real @ cosines])
        return cosines, sines, lead, drift

    def rows(
        self, t: Array, values: Array, edges: NDArray[np.intp], missing: Mask | None = None
    ) -> tuple[Complexes, dict[int, Finding], int]:
        """Return the harmonics of cycles, whose samples lie between successive edges, with a last column of 1 for a
        usable cycle; the faults of the others, by number; and how many of the usable ones are clipped."""
        size = np.diff(edges)
        padded = np.append(values[edges[0] : edges[-1]], np.zeros(self.longest))
        s = sliding_window_view(padded, self.longest)[edges[:-1] - edges[0]]
        s[:, self.shortest :][self.last >= size[:, None]] = 0.0
        # the middle from all time stamps, as they may be rounded
        middle = np.add.reduceat(t[edges[0] : edges[-1]], edges[:-1] - edges[0]) / size
        turn = powers(np.exp(-1j * self.omega * middle), self.n.size)
        local, square = self._fitted(s, size, turn)
        held = s[:, 1 : self.shortest] == s[:, : self.shortest - 1]
        faults = self._faults(s, size, local, square, held)
        if missing is not None:
            lacking = np.diff(np.append(0, np.cumsum(missing))[edges]).tolist()
            faults |= {j: Finding("gap") for j, n in enumerate(lacking) if n}
        rows = np.column_stack([local * turn, np.ones(size.size)])
        rows[list(faults)] = 0.0
        good = [s[j, : size[j]] for j in range(size.size) if j not in faults] if held.any() else []
        return rows, faults, _clipped_of(good)

    def _fitted(self, s: Array, size: NDArray[np.intp], turn: Complexes) -> tuple[Complexes, Array]:
        """Return the harmonics of cycles, with time counted from the middle, and the mean squares of the residuals.

        s : samples, zero beyond `size` of them, (cycles, longest).   turn : e^{−inωt} of the middle.
        """
        sums = (s @ self.fourier.view(np.float64)).view(np.complex128)
        local = np.zeros_like(sums)
        for samples in sorted(set(size.tolist())):
            chosen = size == samples
            cosines, sines, lead, drift = self.system(samples)
            sums[chosen] *= lead
            local.real[chosen] = sums.real[chosen] @ cosines
            local.imag[chosen] = sums.imag[chosen] @ sines
            self.drift += drift * turn[chosen].sum(axis=0)
        left = np.einsum("jr,jr->j", s, s) - np.einsum("jn,jn->j", local.conj(), sums).real
        return local, np.maximum(left, 0.0) / np.maximum(size - 2 * self.n.size + 1, 1)

    def _faults(
        self, s: Array, size: NDArray[np.intp], local: Complexes, square: Array, held: Mask
    ) -> dict[int, Finding]:
        """Return the faults of cycles, by number: samples that are held while the signal moves on, and spikes."""
        rms = math.sqrt(float(np.median(square)))
        if not held.any() and float(square.max()) <= _OUTLYING * rms**2:
            return {}
        # without noise, the residual may be 1e-3 of the range because of a drift
        usual = max(rms, 1e-3 * float(np.ptp(s[:, : self.shortest])))
        outlying = square > _OUTLYING * usual**2
        suspect = _three_in_a_row(held) | outlying  # four equal samples
        if not suspect.any():
            return {}
        first = powers(np.exp(-0.5j * self.omega * self.dt * (size - 1)), self.n.size)
        model = ((local * first) @ self.fourier.conj().T).real
        off = np.where(np.arange(self.longest) < size[:, None], np.abs(s - model), 0.0)
        good = np.flatnonzero(~outlying)
        limit = max(8.0 * usual, 2.0 * float(np.max(off[good[:_AROUND]], initial=0.0)))
        faults = {}
        for j in np.flatnonzero(suspect).tolist():
            worst = int(np.argmax(off[j]))
            around = good[good != j]
            around = around[np.argsort(np.abs(around - j), kind="stable")[:_AROUND]]
            others = s[around] if around.size > 2 else model[j : j + 1]
            reason = _held(s[j, : size[j]], others, rms)
            if not reason and outlying[j] and off[j, worst] > limit:
                of = {"value": float(s[j, worst]), "expected": float(model[j, worst])}
                reason = Finding("spike", of)
            if reason:
                faults[j] = reason
        return faults


def powers(base: Numbers, count: int) -> Numbers:
    """Return b^0 … b^{count − 1} for each b, (…, count); e^{inθ} from e^{iθ} without further exponentials."""
    return np.vander(base, count, increasing=True)


def _three_in_a_row(true: Mask) -> Mask:
    """Return the mask of the rows that are true at three successive places."""
    return np.asarray((true[..., 2:] & true[..., 1:-1] & true[..., :-2]).any(axis=-1))


def _clipped_of(cycles: Sequence[Array]) -> int:
    """Return how many cycles are clipped at the highest or the lowest value of all."""
    ends = np.array([(s.max(), -s.min()) for s in cycles]).reshape(-1, 2)
    at_end = (ends == ends.max(axis=0, initial=-np.inf)).tolist()
    return sum(
        (high and _cut_off(s)) or (low and _cut_off(-s))
        for s, (high, low) in zip(cycles, at_end, strict=True)
    )


def _cut_off(s: Array) -> bool:
    """Return whether samples of a cycle are clipped at their highest value, at least three in a row.

    A quantized sinusoid has its highest level at most 1/(√2 − 1) = 2.4 times as long as the next one, or shorter with
    noise. A clipped one has it longer.
    """
    levels, counts = np.unique(s, return_counts=True)
    return bool(
        levels.size > 1 and counts[-1] > 4 * counts[-2] and _three_in_a_row(s == levels[-1])
    )


def flat_tops(values: Array) -> tuple[float, float]:
    """Return the lowest and the highest value of a free motion if it is clipped there; −∞ and ∞ if it is not.

    Values at the beginning and the end do not count, since the mass may be held or at rest there.
    """
    limits = []
    for high in (-values, values):
        below = np.flatnonzero(high < high.max())
        cut = below.size and _cut_off(high[below[0] : below[-1] + 1])
        limits.append(float(high.max()) if cut else math.inf)
    return -limits[0], limits[1]


def clipped(values: Array) -> bool:
    """Return whether a free motion is clipped at its lowest or highest value."""
    return bool(np.isfinite(flat_tops(values)).any())


def _held(s: Array, others: Array, rms: float) -> Finding | None:
    """Return a finding if samples of a cycle are held at one value while the signal moves on (a drop-out).

    A converter repeats a value while the signal stays within one step, at the same place in every cycle. A drop-out
    does so in this cycle only: in the cycles around, the signal moves on by more than a step and five times its noise.
    A step is at most the smaller of those into and out of the equal samples. As cycles begin up to a sample apart, the
    first and the last of these are left out. The highest and the lowest value do not count, since the signal may be
    clipped there.

    s : samples of the cycle, (n,).   others : of cycles around, (cycles, ≥ n).   rms : of the noise.
    """
    steps = np.abs(np.diff(s, prepend=np.nan, append=np.nan))
    edges = np.flatnonzero(steps)  # NaN counts
    starts, stops = edges[:-1], edges[1:]
    # fewer than five equal samples in a row are noise in the steps of a converter
    long = (stops - starts >= 5) & (s[starts] < s.max()) & (s[starts] > s.min())
    starts, stops = starts[long], stops[long]
    moved = np.abs(np.median(others[:, stops - 2] - others[:, starts + 1], axis=0))
    held = moved > np.fmin(steps[starts], steps[stops]) + 5.0 * rms
    # A motion that stops continues gradually; after a drop-out the signal jumps by more than it moves there from sample
    # to sample. Stops begin and end a little earlier or later in each cycle.
    pace = np.abs(np.diff(others[:, : s.size], axis=1)).max(axis=0)
    for i in np.flatnonzero(held).tolist():
        jump = np.fmax(steps[starts[i]], steps[stops[i]])
        length = stops[i] - starts[i]
        near = pace[max(starts[i] - length, 0) : stops[i] + length]
        # the jump after a drop-out is more than twice the steps nearby
        held[i] = jump > 2.0 * near.max() + 5.0 * rms
    if not held.any():
        return None
    longest = int(np.argmax(np.where(held, stops - starts, 0)))
    value = s[starts[longest]]
    size = int(stops[longest] - starts[longest])
    return Finding("drop-out", {"samples": size, "value": float(value)})


def bootstrap(rows: int, count: int, rng: np.random.Generator) -> tuple[Integers, float]:
    """Return how often each row occurs in each of `count` drawings with replacement, (count, rows), and the factor
    √(n/(n − 1)), for n rows, by which the bootstrap underestimates the scatter of the mean."""
    drawn = rng.integers(rows, size=(count, rows)) + rows * np.arange(count)[:, None]
    times = np.bincount(drawn.ravel(), minlength=rows * count).reshape(count, rows)
    return times, math.sqrt(rows / max(1, rows - 1))
