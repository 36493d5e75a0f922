"""The drive of a record: whether it moves, from when on, and at which frequency."""

from __future__ import annotations

import math
from contextlib import suppress

import numpy as np

from ..arrays import Array
from .checks import require_signal
from .cycles import drive_frequency
from .thresholds import RARE_LINE

LEADING = 1 << 18  # samples from which the drive frequency is first estimated
_STRETCH = 1 << 16  # samples that show whether a drive moves


def stands_still(values: Array) -> bool:
    """Return whether a drive channel holds nothing but noise, or single blows: no stretch of it has a line in its
    spectrum.

    Stretches from the whole record are looked at: a recorder may begin long before the drive does. Blows are brief; a
    spike of one or two samples is no blow.
    """
    if values.size > 2:
        # the middle one of each three neighbours
        low, high = np.minimum(values[:-1], values[1:]), np.maximum(values[:-1], values[1:])
        middle = np.maximum(low[:-1], np.minimum(high[:-1], values[2:]))
        off = np.abs(middle - np.median(middle))
        # a drive that is within 5 % of its largest deviation from rest for 95 % of the time strikes; a steady one is
        # for 3 %
        if np.quantile(off, 0.95) <= 0.05 * off.max():
            return True
    last = max(0, values.size - _STRETCH)
    # 16 stretches of a record that are examined
    for begin in dict.fromkeys(np.linspace(0, last, 16).astype(int).tolist()):
        stretch = values[begin : begin + _STRETCH]
        power = np.abs(np.fft.rfft(stretch - np.mean(stretch))[1:]) ** 2
        if power.max() > (RARE_LINE + math.log(power.size)) * power.mean():
            return False
    return True


def onset(values: Array) -> int:
    """Return the sample at which a drive has begun: the first by which it has gone through half of its range."""
    low, high = np.quantile(values, [0.05, 0.95])
    gone = np.maximum.accumulate(values) - np.minimum.accumulate(values)
    return int(np.argmax(gone > 0.5 * (high - low)))


def frequency_of(t: Array, values: Array, quantity: str) -> tuple[float, float, int, float]:
    """Return ω of a drive, its standard error, rad/s, cycles that they come from, and the time from which on it moves,
    s; −∞ where it does from the first sample on.

    It is sought in the leading samples, after those in which the drive stands still. Where these hold too few cycles,
    it is sought in averages of more and more of them.
    """
    require_signal(quantity, values)
    every, first, begin = 1, 0, -math.inf
    while True:
        leading, s = (averaged(of[first : first + LEADING * every], every) for of in (t, values))
        ended = leading.size < LEADING
        if not ended and stands_still(s):
            first += (leading.size - 1) * every
            begin = float(leading[-1])
            continue
        try:
            omega, error, late = _frequency_in(leading, s, step_of(leading, quantity))
            cycles = math.floor((leading[-1] - leading[late]) / (2.0 * math.pi / omega))
            # from fewer than eight cycles the spectrum may take one number of cycles for another
            if cycles >= 8 or ended:
                return omega, error, cycles, float(leading[late]) if late else begin
        except ValueError as problem:
            if ended:
                raise ValueError(f"{quantity}: {problem}") from problem
        # average more samples where the cycles are too few
        every *= 4


def averaged(values: Array, every: int) -> Array:
    """Return the means of each `every` values; the rest at the end is left out."""
    return values[: values.size // every * every].reshape(-1, every).mean(axis=1)


def _frequency_in(t: Array, values: Array, step: float) -> tuple[float, float, int]:
    """Return ω of a drive, its standard error, and the sample from which on it moves, if it stands still for a cycle or
    more before; otherwise 0."""
    begins = onset(values)
    whole: tuple[float, float, int] | ValueError
    try:
        whole = (*drive_frequency(t, values, step), 0)
        if t[begins] - t[0] <= 2.0 * math.pi / whole[0]:
            return whole
    except ValueError as problem:
        whole = problem
    with suppress(ValueError):
        omega, error = drive_frequency(t[begins:], values[begins:], step)
        before = int(np.searchsorted(t, t[begins] - 2.0 * math.pi / omega))
        parts = slice(0, before), slice(begins, None)
        still, moving = (_amplitude(t[part], values[part], omega) for part in parts)
        # amplitude before the onset over that after it; a line through one cycle of a sine leaves 39 % of it
        if still < 0.25 * moving:
            return omega, error, begins
    if isinstance(whole, ValueError):
        raise whole
    return whole


def _amplitude(t: Array, values: Array, omega: float) -> float:
    """Return roughly the amplitude of a signal at ω, without a slow drift; ∞ where there is less than a cycle of it."""
    if t.size < 3 or t[-1] - t[0] < 2.0 * math.pi / omega:
        return math.inf
    line = np.polyval(np.polyfit(t - t[0], values, 1), t - t[0])
    return 2.0 * float(np.abs(np.mean((values - line) * np.exp(-1j * omega * t))))


def step_of(t: Array, quantity: str) -> float:
    """Return the sampling interval, s. Raises ValueError for fewer than three samples."""
    if t.size < 3:
        raise ValueError(f"{quantity} has only {t.size} samples")
    return float(np.mean(np.diff(t)))
