"""What the samples of columns show where names and units do not say it: what one holds, and how two are related."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Array, Complexes

_ENOUGH = 64  # samples, the fewest that show noise or a decay
_PARTS = 4  # parts of a record, each at least most of a cycle long
_DIED = 0.35  # largest range of the last part of a decay, relative to the widest part
_BAND = 0.02  # relative to the strongest line; weaker ones show noise
_ALIKE = 0.95  # least correlation of two columns that show one motion
_OUTSIDE = 0.1  # relative to half the range; a loop may rest nearer to its middle
_NEAR = 4.0  # a drive swings at most this many times slower or faster than the response
_ARC = 0.9  # least share of the variance that a parabola explains, or turns per period


def aside(values: Array) -> str:
    """Return why a column is no motion; "" if it is one."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "it is empty" if values.size else "it does not hold numbers"
    if not np.ptp(finite):
        return "constant"
    if (step := equal_step(finite)) is not None:
        kind = "a counter" if counts(finite) else "a time"
        return f"rises by {step:.6g} from sample to sample: {kind}"
    if strikes(finite):
        return "short blows and rest: a hammer"
    return "noise without a motion" if _is_noise(finite) else ""


def equal_step(values: Array) -> float | None:
    """Return the step of values that rise in equal steps, as times and counters do; None for other values."""
    # fewer samples do not show whether they rise in equal steps
    if values.size < 4:
        return None
    line = np.linspace(values[0], values[-1], values.size)
    step = float(line[1] - line[0])
    rises = step > 0.0 and np.diff(values).min() >= 0.0
    # 0.6 steps; times with too few digits are off by less
    return step if rises and np.abs(values - line).max() < 0.6 * step else None


def counts(values: Array) -> bool:
    """Return whether values rise by one, in whole numbers."""
    return equal_step(values) == 1.0 and not np.any(values % 1.0)


def blows(values: Array) -> tuple[bool, Array]:
    """Return whether a channel rests except for brief blows, and its deviations from rest, (n − 2,).

    Of each three neighbours the middle one counts, so that a spike of one or two samples is no blow.
    """
    low, high = np.minimum(values[:-2], values[1:-1]), np.maximum(values[:-2], values[1:-1])
    middle = np.maximum(low, np.minimum(high, values[2:]))
    off = middle - np.median(middle)
    # a blow leaves a channel within 5 % of its peak from rest for 95 % of the time, a steady motion for 3 %
    return bool(np.quantile(np.abs(off), 0.95) <= 0.05 * np.abs(off).max()), off


def strikes(values: Array) -> bool:
    """Return whether a channel rests except for brief blows in one direction, as that of a hammer."""
    if values.size < _ENOUGH:
        return False
    rests, off = blows(values)
    # a blow swings back by at most 0.3 of its peak
    return rests and bool(min(off.max(), -off.min()) <= 0.3 * np.abs(off).max())


def _is_noise(values: Array) -> bool:
    """Return whether samples are white: no correlation from one to the next, and no line in the spectrum."""
    n = values.size
    if n < _ENOUGH:
        return False
    at = np.arange(n)
    off = values - np.polyval(np.polyfit(at, values, 1), at)
    total = float(off @ off) or 1.0
    # noise is uncorrelated over eight lags
    lags = [float(off[lag:] @ off[:-lag]) / total for lag in range(1, 9)]
    power = np.abs(np.fft.rfft(off)[1:]) ** 2
    # a line of the periodogram of white noise exceeds ln n + 7 in one of a thousand
    quiet = power.max() < (math.log(power.size) + 7.0) * power.mean()
    # 4.0 standard errors of a correlation
    return bool(quiet and max(map(abs, lags)) < 4.0 / math.sqrt(n))


def dies_out(values: Array) -> bool:
    """Return whether a motion swings less and less until the end of the record, as a decay does."""
    finite = values[np.isfinite(values)]
    if finite.size < _ENOUGH or np.count_nonzero(np.diff(finite > np.median(finite))) < _PARTS:
        return False
    ranges = np.array([np.ptp(part) for part in np.array_split(finite, _PARTS)]) / np.ptp(finite)
    after = ranges[int(np.argmax(ranges)) :]
    # 0.95 of the range in a part, left in the next of a decay
    falls = (after[1:] < 0.95 * after[:-1]) | (after[:-1] < _DIED)
    return bool(after[-1] < _DIED and falls.all())


def slope(values: Array, other: Array, dt: float, order: int = 1) -> float | None:
    """Return the ratio of another column to the time derivative of a column; None if they are not proportional.

    Only lines that both spectra have are compared, so that noise counts little.   dt : s.   order : of the derivative.
    """
    if values.size != other.size or values.size < _ENOUGH:
        return None
    A, B = _spectrum(values), _spectrum(other)
    D = (2j * math.pi * np.fft.rfftfreq(values.size, dt)) ** order * A
    product = np.abs(A * B)
    clear = product > _BAND * product.max()
    common = float(np.sum(D[clear].conj() * B[clear]).real)
    own, its = (float(np.sum(np.abs(of[clear]) ** 2)) for of in (D, B))
    alike = own > 0.0 and its > 0.0 and abs(common) > _ALIKE * math.sqrt(own * its)
    return common / own if alike else None


def _spectrum(values: Array) -> Complexes:
    """Return the spectrum of samples under a Hann window, missing ones replaced by the mean."""
    return np.fft.rfft(np.nan_to_num(values - np.nanmean(values)) * np.hanning(values.size))


def _together(values: Array, other: Array) -> tuple[Array, Array] | None:
    """Return the samples that both columns have; None if they are few or one column does not move."""
    both = np.isfinite(values) & np.isfinite(other) if values.size == other.size else np.zeros(0)
    if np.count_nonzero(both) < _ENOUGH or not np.ptp(values[both]) or not np.ptp(other[both]):
        return None
    return values[both], other[both]


def same_motion(values: Array, other: Array) -> bool:
    """Return whether two columns move in proportion."""
    both = _together(values, other)
    return both is not None and bool(abs(np.corrcoef(*both)[0, 1]) > _ALIKE)


def along(values: Array, axes: Sequence[Array]) -> float:
    """Return the ratio of a body's motion to its part along one axis, from the strong lines of the spectra."""
    first, *others = map(_spectrum, (values, *axes))
    power = np.abs(first) ** 2
    clear = power > _BAND * power.max()
    total = float(power[clear].sum()) or 1.0
    return math.hypot(*(float((first.conj() * of)[clear].sum().real) / total for of in others))


def may_drive(values: Array, response: Array) -> bool:
    """Return whether a column may drive a response: it swings at about its rate, but not in proportion to it."""
    if values.size != response.size or values.size < _ENOUGH or same_motion(values, response):
        return False
    own, its = (np.abs(_spectrum(of)[1:]) ** 2 for of in (values, response))
    line = int(np.argmax(its)) + 1
    near = own[math.ceil(line / _NEAR) - 1 : math.floor(line * _NEAR)]
    return bool(near.sum() > 0.5 * own.sum())


def is_arc(values: Array, other: Array) -> bool:
    """Return whether a column is a parabola over another, as the height of a bob is over its horizontal coordinate."""
    if (both := _together(values, other)) is None:
        return False
    y, x = both[0], both[1] - both[1].mean()
    left = [float(np.var(y - np.polyval(np.polyfit(x, y, n), x))) for n in (1, 2)]
    whole = float(np.var(y))
    return left[1] < (1.0 - _ARC) * whole and left[0] > 0.5 * whole


def steady_speeds(values: Array) -> bool:
    """Return whether velocities are steady speeds in both directions, and not samples of a motion, which pass through
    zero repeatedly after several samples each."""
    way = values[np.isfinite(values) & (values != 0.0)] > 0.0
    passes = np.count_nonzero(np.diff(way))
    # more than three passes through zero, with four samples for each, are of a motion in time
    moves = way.size >= _ENOUGH and 3 < passes < way.size / 4
    return bool(passes and not moves)


def go_round(values: Array, other: Array) -> bool:
    """Return whether two columns trace a loop about their middle in each period."""
    if (both := _together(values, other)) is None:
        return False
    x, y = ((2.0 * of - of.max() - of.min()) / np.ptp(of) for of in both)
    outside = np.hypot(x, y) > _OUTSIDE
    angle = np.unwrap(np.arctan2(y[outside], x[outside]))
    turns = abs(float(angle[0] - angle[-1])) / (2.0 * math.pi)
    sides = np.sign(x[np.abs(x) > _OUTSIDE])
    periods = 0.5 * np.count_nonzero(np.diff(sides))
    return bool(turns > _ARC * max(1.0, periods - 0.5))
