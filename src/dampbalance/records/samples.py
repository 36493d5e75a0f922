"""What the samples of a column show of it, and how two columns belong together, where names and units do not say it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Array

_ENOUGH = 64  # samples that show whether they are noise, and whether a motion dies out
_PARTS = 4  # of a record, each with most of a cycle at least
_DIED = 0.35  # of the largest range in a part, left in the last
_BAND = 0.02  # of the strongest line: weaker ones show noise
_ALIKE = 0.95  # correlation of two columns that are one motion
_OUTSIDE = 0.1  # of half the range: nearer to its middle a loop may rest
_NEAR = 4.0  # times slower or faster than a response: what swings within may drive it
_ARC = 0.9  # share of the variance that a parabola of another coordinate explains


def aside(values: Array) -> str:
    """Say why a column is no motion; "" for one that moves."""
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
    """Return the step of values that rise in equal steps, as times and counters do; None for others."""
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


def strikes(values: Array) -> bool:
    """Return whether a channel rests but for short blows one way; a spike of one or two samples is none."""
    if values.size < _ENOUGH:
        return False
    low, high = np.minimum(values[:-2], values[1:-1]), np.maximum(values[:-2], values[1:-1])
    middle = np.maximum(low, np.minimum(high, values[2:]))
    off = middle - np.median(middle)
    peak, other = sorted([off.max(), -off.min()], reverse=True)
    # 0.05 of its peak: a blow leaves a channel this near to rest for 95 % of the time
    rests = np.quantile(np.abs(off), 0.95) <= 0.05 * peak
    # 0.3 of its peak, that a blow goes the other way at the most
    return bool(rests and other <= 0.3 * peak)


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
    """Return whether a motion swings less and less up to the end of its record, as a decay does: one that is driven and
    stops at the end goes on before."""
    finite = values[np.isfinite(values)]
    if finite.size < _ENOUGH or np.count_nonzero(np.diff(finite > np.median(finite))) < _PARTS:
        return False
    ranges = np.array([np.ptp(part) for part in np.array_split(finite, _PARTS)]) / np.ptp(finite)
    after = ranges[int(np.argmax(ranges)) :]
    # 0.95 of the range in a part, left in the next of a decay
    falls = (after[1:] < 0.95 * after[:-1]) | (after[:-1] < _DIED)
    return bool(after[-1] < _DIED and falls.all())


def slope(values: Array, other: Array, dt: float, order: int = 1) -> float | None:
    """Return by how much another column is more than the time derivative of one; None where it is none.

    Only lines that both have are compared, so that noise counts little.   dt : s.   order : 2 for the second one.
    """
    if values.size != other.size or values.size < _ENOUGH:
        return None
    taper = np.hanning(values.size)
    A, B = (np.fft.rfft(np.nan_to_num(of - np.nanmean(of)) * taper) for of in (values, other))
    D = (2j * math.pi * np.fft.rfftfreq(values.size, dt)) ** order * A
    product = np.abs(A * B)
    clear = product > _BAND * product.max()
    common = float(np.sum(D[clear].conj() * B[clear]).real)
    own, its = (float(np.sum(np.abs(of[clear]) ** 2)) for of in (D, B))
    alike = own > 0.0 and its > 0.0 and abs(common) > _ALIKE * math.sqrt(own * its)
    return common / own if alike else None


def _together(values: Array, other: Array) -> tuple[Array, Array] | None:
    """Return the samples that both columns have; None where they are few, or one column does not move."""
    both = np.isfinite(values) & np.isfinite(other) if values.size == other.size else np.zeros(0)
    if np.count_nonzero(both) < _ENOUGH or not np.ptp(values[both]) or not np.ptp(other[both]):
        return None
    return values[both], other[both]


def same_motion(values: Array, other: Array) -> bool:
    """Return whether two columns move in proportion."""
    both = _together(values, other)
    return both is not None and bool(abs(np.corrcoef(*both)[0, 1]) > _ALIKE)


def along(values: Array, axes: Sequence[Array]) -> float:
    """Return by how much more a body moves along its own direction than along one axis, by the strong lines of it."""
    taper = np.hanning(values.size)
    first, *others = (
        np.fft.rfft(np.nan_to_num(of - np.nanmean(of)) * taper) for of in (values, *axes)
    )
    power = np.abs(first) ** 2
    clear = power > _BAND * power.max()
    total = float(power[clear].sum()) or 1.0
    return math.hypot(*(float((first.conj() * of)[clear].sum().real) / total for of in others))


def may_drive(values: Array, response: Array) -> bool:
    """Return whether a column swings at about the rate of a response, not in proportion: what drives it may do so."""
    if values.size != response.size or values.size < _ENOUGH or same_motion(values, response):
        return False
    taper = np.hanning(values.size)
    both = (np.nan_to_num(of - np.nanmean(of)) * taper for of in (values, response))
    own, its = (np.abs(np.fft.rfft(of)[1:]) ** 2 for of in both)
    line = int(np.argmax(its)) + 1
    near = own[math.ceil(line / _NEAR) - 1 : math.floor(line * _NEAR)]
    return bool(near.sum() > 0.5 * own.sum())


def is_arc(values: Array, other: Array) -> bool:
    """Return whether a column is the height of a bob whose other coordinate is given: a parabola over it, no line."""
    if (both := _together(values, other)) is None:
        return False
    y, x = both[0], both[1] - both[1].mean()
    left = [float(np.var(y - np.polyval(np.polyfit(x, y, n), x))) for n in (1, 2)]
    whole = float(np.var(y))
    return left[1] < (1.0 - _ARC) * whole and left[0] > 0.5 * whole


def steady_speeds(values: Array) -> bool:
    """Return whether velocities are of both directions, each steady: they do not pass through zero again and again
    after several samples each, as those of a motion do."""
    way = values[np.isfinite(values) & (values != 0.0)] > 0.0
    passes = np.count_nonzero(np.diff(way))
    # more than three passes through zero, with four samples for each, are of a motion in time
    moves = way.size >= _ENOUGH and 3 < passes < way.size / 4
    return bool(passes and not moves)


def go_round(values: Array, other: Array) -> bool:
    """Return whether two columns go round their middle in each period."""
    if (both := _together(values, other)) is None:
        return False
    x, y = ((2.0 * of - of.max() - of.min()) / np.ptp(of) for of in both)
    outside = np.hypot(x, y) > _OUTSIDE
    angle = np.unwrap(np.arctan2(y[outside], x[outside]))
    turns = abs(float(angle[0] - angle[-1])) / (2.0 * math.pi)
    sides = np.sign(x[np.abs(x) > _OUTSIDE])
    periods = 0.5 * np.count_nonzero(np.diff(sides))
    return bool(turns > _ARC * max(1.0, periods - 0.5))
