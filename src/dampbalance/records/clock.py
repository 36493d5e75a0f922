"""The clock of a record: from the times that a logger wrote to samples in equal steps.

Each row of a table gets a number, its place in equal steps counted from the first sample:

- equal steps, or time stamps with too few digits: rows are numbered in order, and a straight line through the stamps
  restores the digits;
- rows that a logger lost, or a lower rate for a while: the numbers are integers, and some are missing;
- jitter, a drifting clock, two rates, a row for each tick of an encoder: the numbers are not integers, and the samples
  at integers are interpolated.

Where the times leave it open, the signals decide, since they are smooth if their times are right. No sample is
invented: one in a gap is missing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Integers, Mask
from ..findings.finding import Finding
from .equal_steps import GRID_TOLERANCE, HALF_A_STEP, uneven
from .errors import HIGHEST_RATE, LOWEST_RATE, RecordError

_GAP = 1.5  # usual intervals; samples are missing in a longer one
# quantile of the intervals that is the usual one, and its largest value in steps
_USUAL, _WIDEST = 0.95, 2.0
_LONG = 10  # steps; in a longer interval the clock may have jumped instead
_APART = 3  # most rows at an end that are dropped because a long pause separates them
_LARGEST = 20  # samples per row; a longer gap separates two records
_MAX_RATE_ERROR = 1e-2  # relative; a hundred times a common one, and c has the same
_AROUND = 8  # samples on either side of a place that a polynomial is fitted to
_PLACES = 100  # places at which signals are compared with their times
_CLEAR = 5.0  # log-likelihood ratio of a clear decision
_SHOWN = 3  # places that a message lists


@dataclass(frozen=True, eq=False)
class Clock:
    """Sampling times in equal steps, and the place of each row of a table among them.

    t : s, (n,).   rows : indices of the rows that are used, (r,).   number : place of each, in steps from t_0, (r,).
    gap : mask of the samples in gaps, (n,).   findings : what is odd about the times.
    """

    t: Array
    rows: Integers
    number: Array
    gap: Mask
    findings: tuple[Finding, ...] = ()

    @classmethod
    def plain(cls, t: Array) -> Clock:
        """Return the clock of rows that are in equal steps already."""
        rows = np.arange(t.size)
        return cls(t, rows, rows.astype(np.float64), np.zeros(t.size, dtype=np.bool_))

    def onto(self, signal: Array) -> tuple[Array, Mask | None]:
        """Return the samples of a signal, and the mask of those that are missing, None for none. Missing samples have
        interpolated values, which pictures and spectra need.

        Between rows the signal is a cubic spline. With a row for each tick of an encoder, the count is half a tick
        behind at each row and within half a tick of the last row in between; both are used.
        """
        number, values, at = self.number, signal[self.rows], np.arange(self.t.size)
        if np.array_equal(number, at) and not np.isnan(values).any():
            return values, None
        from scipy.interpolate import CubicSpline  # slow to import

        after = np.searchsorted(number, at).clip(1, number.size - 1)
        nearest = after - (at - number[after - 1] < number[after] - at)
        missing = self.gap | np.isnan(values[nearest])
        present = ~np.isnan(values)
        number, values = number[present], values[present]
        whole = number == np.rint(number)
        if (tick := _tick(values)) and not whole.all():
            way = np.sign(np.diff(values, prepend=2.0 * values[0] - values[1]))
            counted = values[np.searchsorted(number, at, side="right") - 1]
            samples = CubicSpline(number, values - 0.5 * tick * way)(at)
            return samples.clip(counted - 0.5 * tick, counted + 0.5 * tick), None
        samples = CubicSpline(number, values)(at.clip(number[0], number[-1]))
        samples[number[whole].astype(np.intp)] = values[whole]
        return samples, missing if missing.any() else None


def clock_of(t: Array, signals: Sequence[Array], name: str, place: Callable[[int], str]) -> Clock:
    """Return the clock of times, s, (n,), NaN for an empty cell.

    signals : sampled at these times.   name : of the times, for messages.   place : gives the place in the file of a
    row, counted from 0.

    Raises RecordError if the times go back, jump while the signals go on, have too long a gap, too few digits, or steps
    that no recorder has.
    """
    copies = _copies(t, signals)
    rows = np.flatnonzero(np.isfinite(t) & ~copies)
    step = _usual_step(t[rows]) if rows.size > 2 else 0.0
    if 0.0 <= step < 1.0 / HIGHEST_RATE or step > 1.0 / LOWEST_RATE:
        what = f"{name} has steps of {step:g} s, which no recorder has; check its unit"
        raise RecordError(f"{what}, or give sample_rate_hz")
    if rows.size == t.size and not uneven(t, GRID_TOLERANCE):
        return Clock.plain(t)
    ticks = any(_tick(one[rows]) > 0.0 for one in signals)
    joined = slice(None) if ticks else _joined(t[rows], step)
    found = left_out("rows twice", name, np.flatnonzero(copies), place)
    found += left_out("rows apart", name, np.delete(rows, joined), place)
    rows = rows[joined]
    order = np.cumsum(~copies)[rows].astype(np.float64)
    t, signals = t[rows], [one[rows] for one in signals]
    _require_increase(t, rows, step, name, place)
    step = max(step, float(np.ptp(t)) / (_LARGEST * t.size)) if ticks else step
    number, grid, odd = _numbered(t, order - order[0], signals, step, name, ticks)
    steps = np.diff(number)
    longest = _GAP * min(max(float(np.quantile(steps, _USUAL)), 1.0), _WIDEST)
    wide = np.flatnonzero((steps > longest) & (not ticks))
    long = wide[(steps[wide] > _LONG) | (wide.size <= _SHOWN)]
    jumps = np.array([i for i in long.tolist() if _goes_on(signals, number, i)], dtype=np.intp)
    if jumps.size or number[-1] > _LARGEST * number.size:
        what = "jumps, while the signals go on," if jumps.size else "has a gap too long"
        where = _steps(t, jumps if jumps.size else long, rows, place)
        raise RecordError(f"{name} {what} {where}; use the part before or after it")
    at = np.arange(grid.size)
    after = np.searchsorted(number, at).clip(1, number.size - 1)
    near = np.minimum(np.abs(at - number[after - 1]), np.abs(number[after] - at))
    gap = np.isin(after - 1, wide) & (near > HALF_A_STEP)
    found += odd + left_out("rows missing", name, rows[wide + 1], place, int(gap.sum()))
    clock = Clock(grid, rows, number, gap, tuple(found))
    if np.all(gap | (near == 0.0)):
        return clock
    bound = max(_interpolation_error(clock, one) for one in signals)
    apart = np.diff(t)
    sizes = {"least": apart.min(), "most": apart.max(), "step": grid[1] - grid[0], "bound": bound}
    said = Finding("uneven steps", {"where": name, **sizes}, {"": bound})
    return replace(clock, findings=(*found, said))


def left_out(
    code: str, channel: str, rows: Integers, place: Callable[[int], str], count: int = 0
) -> list[Finding]:
    """Return the finding that rows of a channel are left out, with the first places; none if there are no rows.

    count : number of samples left out, if it differs from that of the rows.
    """
    places = [place(int(i)) for i in rows[:_SHOWN]] + ["…"] * (rows.size > _SHOWN)
    count = count or rows.size
    of = {"channel": channel, "count": count, "many": count > 1, "places": ", ".join(places)}
    return [Finding(code, of)] if rows.size else []


def _usual_step(t: Array) -> float:
    """Return the median of the mean steps over 100 rows, which rounding, a few gaps and jitter do not affect."""
    m = min(100, max(1, t.size // 4))
    return float(np.median(t[m:] - t[:-m])) / m


def _tick(signal: Array) -> float:
    """Return the tick of an encoder that has a row for each tick; 0 for any other signal."""
    steps = np.abs(np.diff(signal))
    tick = float(np.median(steps)) if steps.size and not np.isnan(steps).any() else 0.0
    alike = np.abs(steps - tick) < 0.01 * tick
    # of the steps of an encoder 90 % are one tick or more
    return tick if steps.min(initial=tick) > 0.0 and alike.mean() > 0.9 else 0.0


def _copies(t: Array, signals: Sequence[Array]) -> Mask:
    """Return the mask of rows that repeat the time and the values of the row before.

    They count only if no other rows share a time, or if they are the last rows and more than those of any other time.
    """
    kept = np.flatnonzero(np.isfinite(t))
    stops = np.diff(t[kept], prepend=np.nan) == 0.0
    again = stops & np.all([one[kept] == np.roll(one[kept], 1) for one in signals], axis=0)
    if not np.array_equal(again, stops):
        starts = np.flatnonzero(~stops)
        *others, last = np.diff(np.append(starts, kept.size))
        again[: starts[-1]] = False
        again &= last > 2 * max(others, default=1) and bool(again[starts[-1] + 1 :].all())
    copies = np.zeros(t.size, dtype=np.bool_)
    copies[kept[again]] = True
    return copies


def _joined(t: Array, step: float) -> slice:
    """Return the rows without the few at either end that a long pause separates from the others."""
    if t.size < 4 * _APART:
        return slice(None)
    steps = np.abs(np.diff(t))
    long = np.flatnonzero(steps > max(_LONG * abs(step), 2.0 * steps[_APART:-_APART].max()))
    first, last = long[long < _APART], long[long >= t.size - 1 - _APART]
    return slice(int(first[-1]) + 1 if first.size else 0, int(last[0]) + 1 if last.size else None)


def _steps(t: Array, which: Integers, rows: Integers, place: Callable[[int], str]) -> str:
    """Return the first steps of some, with their places, as a text."""
    shown = [
        f"from {t[i]:.9g} s to {t[i + 1]:.9g} s at {place(int(rows[i + 1]))}"
        for i in which[:_SHOWN].tolist()
    ]
    return ", ".join(shown) + f", and {which.size - _SHOWN} times more" * (which.size > _SHOWN)


def _require_increase(
    t: Array, rows: Integers, step: float, name: str, place: Callable[[int], str]
) -> None:
    """Raise RecordError if times go back, naming these places and those of pauses."""
    steps = np.diff(t)
    back, pauses = np.flatnonzero(steps < 0.0), np.flatnonzero(steps > _LONG * abs(step))
    if not back.size:
        return
    # another run begins where times go back to the first tenth of this one
    runs = back[t[back + 1] < t[0] + 0.1 * (t[back] - t[0])]
    fault = f"{name} goes back {_steps(t, back, rows, place)}"
    fault += f" and pauses {_steps(t, pauses, rows, place)}" if pauses.size else ""
    # a file holds 20 runs at most: times that go back more often are in no order
    if back.size > 20 or not runs.size:
        raise RecordError(f"{fault}; use the part before or after it, or put its rows in order")
    first, last, again = (place(int(rows[i])) for i in (0, runs[0], runs[0] + 1))
    remedy = (
        f"a second run begins at {again}; give each run a file, the first from {first} to {last}"
    )
    raise RecordError(f"{fault}: {remedy}")


def _closed(number: Array) -> Array:
    """Return the numbers of rows with each gap closed to one step."""
    steps = np.diff(number)
    return np.append(0.0, np.cumsum(np.where(steps > _GAP, 1.0, steps)))


def _numbered(
    t: Array, order: Array, signals: Sequence[Array], step: float, name: str, ticks: bool
) -> tuple[Array, Array, list[Finding]]:
    """Return the numbers of rows, times in equal steps from the first integer on, and what is odd about the times.

    The numbers are integers, some of which may be missing; the order of rows whose times have too few digits; or
    real numbers, as the times say. A missing row and a clock that jumps or is rounded may show the same times; the
    signals then decide.

    t : increasing, s.   order : of the rows.   step : usual one, s.   ticks : whether each row is a tick of an encoder.
    """
    steps = np.diff(t)
    usual = steps[np.abs(steps - step) < HALF_A_STEP * step]
    step = step if ticks or not usual.size else float(usual.mean())
    counted = None if ticks or not usual.size else _counted((t - t[0]) / step)
    lined = None if ticks else _on_a_line(t, order, name)
    if counted is not None and (gaps := np.flatnonzero(np.diff(counted) > 1)).size:
        # rounding seldom makes one step
        least = _CLEAR if gaps.size > 1 else -_CLEAR
        if lined and _likelier(signals, counted, _closed(counted), gaps) < least:
            counted = None
    if counted is not None and (placed := _on_a_line(t, counted, name)):
        return counted, *placed
    if lined:
        return order, *lined
    if steps.min() <= 0.0 and 1.5 * np.median(steps[steps > 0.0]) > _MAX_RATE_ERROR * np.ptp(t):
        raise RecordError(f"{name} has too few digits; give sample_rate_hz instead")
    t, off = _apart(t), np.abs(t - np.linspace(t[0], t[-1], t.size)).max()
    at = (t - t[0]) / step
    places = np.linspace(_AROUND, t.size - _AROUND, _PLACES).astype(np.intp)
    near = off < HALF_A_STEP * step
    if near and _likelier(signals, at, order, places) < -_CLEAR:
        return order, np.interp(np.arange(int(order[-1]) + 1), order, t), []
    at -= np.median(at - np.rint(at))
    at = np.where(np.abs(at - np.rint(at)) < 1e-6, np.rint(at), at)
    first = math.ceil(at[0])
    size = min(int(at[-1]) - first + 1, _LARGEST * t.size + 1)
    return at - first, t[0] + step * (np.arange(size) + first - at[0]), []


def _counted(at: Array) -> Array | None:
    """Return increasing integers near times in steps; None if there are none."""
    at = np.rint(np.polyval(np.polyfit(at, np.rint(at), 1), at))
    most = _LARGEST * at.size
    return at - at[0] if np.diff(at).min() >= 1.0 and at[-1] - at[0] < most else None


def _likelier(signals: Sequence[Array], one: Array, other: Array, places: Integers) -> float:
    """Return the log-likelihood ratio of the samples around some rows, numbered in one way or in another."""
    ratios = [
        _rough(signal, other, i) - _rough(signal, one, i)
        for signal in signals
        for i in places[:_PLACES].tolist()
    ]
    return float(np.nansum(ratios))


def _rough(signal: Array, number: Array, i: int, degree: int = 2) -> float:
    """Return the negative log-likelihood of the samples around row i, from the residual of a polynomial; NaN if there
    are few samples."""
    own = slice(max(0, i + 1 - _AROUND), i + 1 + _AROUND)
    values = signal[own] - signal[min(i, signal.size - 1)]
    size = float(np.abs(values).max(initial=0.0))
    if values.size <= _AROUND or not size > 0.0:  # NaN is not
        return math.nan
    left = np.polyfit(number[own] - number[own].mean(), values / size, degree, full=True)[1].sum()
    # sum of squares relative to that of the signal: less is rounding
    return _AROUND * (math.log(left + 1e-20) + 2.0 * math.log(size))


def _goes_on(signals: Sequence[Array], number: Array, i: int) -> bool:
    """Return whether signals are as smooth across a gap as before and after it if the gap is closed, but not if it is
    left open."""
    closed, breaks = _closed(number), list[float]()
    for one in signals:
        own, before, after = (_rough(one, closed, j, 4) for j in (i, i - _AROUND, i + _AROUND))
        breaks.append(own - np.fmax(before, after))
    alone = np.array([i])
    return bool(np.nansum(breaks) < _CLEAR and _likelier(signals, number, closed, alone) < -_CLEAR)


def _on_a_line(t: Array, number: Array, name: str) -> tuple[Array, list[Finding]] | None:
    """Return the times of all integers, s, if the rows are in equal steps; None if they are not.

    Times with too few digits, as stamps in ms of 20,000 samples a second, are replaced by t_i = t_0 + i Δt from least
    squares, with a finding that bounds the relative error of Δt. They are taken as rounded if none is further from the
    line than the resolution q, by which the two shortest kinds of steps differ. Rounding errors of up to q/2 change the
    slope by 3q/2T at most, T being the length of the record; a hundredth of that is common.
    """
    every = np.arange(int(number[-1]) + 1)
    even = np.interp(every, number, t)
    if not uneven(even, GRID_TOLERANCE):
        return even, []
    i, middle = number - number.mean(), float(t.mean())
    step = float(i @ (t - middle)) / float(i @ i)
    steps = np.sort(np.diff(t))
    longer = steps[steps > steps[0] + 0.01 * step]
    q = 10.0 ** round(math.log10(longer[0] - steps[0])) if longer.size else 0.0
    bound = 1.5 * q / (step * every.size)
    multiples = np.abs((steps - steps[0]) / q - np.rint((steps - steps[0]) / q)).max() if q else 1.0
    # 1.5 resolutions: rounding, and the error of the line
    if multiples > 0.01 or np.ptp(t - step * i) > 1.5 * q or bound > _MAX_RATE_ERROR:
        return None
    of = {"where": name, "resolution": q, "step": step, "rate": 1.0 / step, "bound": bound}
    line = np.asarray(middle + step * (every - number.mean()))
    return line, [Finding("rounded times", of, {"": bound})]


def _apart(t: Array) -> Array:
    """Return times with each group of equal ones spread evenly until the next group."""
    first = np.flatnonzero(np.diff(t, prepend=-np.inf) > 0.0)
    if first.size == t.size:
        return t
    size = np.diff(first).max()
    at = np.append(first, first[-1] + size)
    of = np.append(t[first], 2.0 * t[first[-1]] - t[first[-2]])
    return np.interp(np.arange(t.size), at, of)


def _interpolation_error(clock: Clock, signal: Array) -> float:
    """Return a bound on the error of interpolated samples, relative to the signal (rms).

    For a harmonic of ω, a cubic spline through samples at most h apart has an error of at most (5/384) (ωh)⁴ of the
    amplitude, whatever the intervals (Hall and Meyer 1976), and never much more than the amplitude. The influence of
    further intervals falls by four with each, so that h is the longest of five. Each harmonic of the spectrum is
    weighted by the share of the time that intervals of each length fill. The spectrum includes white noise, so that the
    bound is not below its part at high frequencies. For an encoder the error is half a tick.

    At worst the error acts on the numbers like a gain of that size; errors that differ from sample to sample are noise,
    which the fit sees.
    """
    from scipy.ndimage import maximum_filter1d  # slow to import

    samples, _ = clock.onto(signal)
    samples = samples - samples.mean()
    if not samples.any():
        return 0.0
    if tick := _tick(signal):
        return 0.5 * tick / float(samples.std())
    # squares of the smallest numbers would be 0
    samples = samples / np.abs(samples).max() * np.hanning(samples.size)
    power = np.abs(np.fft.rfft(samples)) ** 2
    omega = 2.0 * math.pi * np.fft.rfftfreq(samples.size)
    steps = np.minimum(np.diff(clock.number), _GAP * _WIDEST)
    h = maximum_filter1d(steps, 5)
    lengths, of = np.unique(np.ceil(20.0 * h) / 20.0, return_inverse=True)
    parts = np.bincount(of, steps) / steps.sum()
    errors = sum(
        # error of a cubic spline
        p * np.minimum(1.0, (5.0 / 384.0) * (omega * h) ** 4) ** 2
        for p, h in zip(parts, lengths, strict=True)
    )
    return math.sqrt(float(power @ errors) / float(power.sum()))
