"""The drive of a record: whether and when it moves, and its frequency."""

from __future__ import annotations

import math
from contextlib import suppress

import numpy as np

from ..arrays import Array
from ..records.samples import blows
from .checks import require_signal
from .cycles import drive_frequency
from .thresholds import RARE_LINE

LEADING = 1 << 18  # samples for the first estimate of the drive frequency
_STRETCH = 1 << 16  # samples of a stretch that shows whether a drive moves


def stands_still(values: Array) -> bool:
    """Return whether a drive channel holds only noise or single blows: no stretch of it has a line in its spectrum.

    Stretches are taken from the whole record, since a recorder may start long before the drive does.
    """
    if values.size > 2 and blows(values)[0]:
        return True
    last = max(0, values.size - _STRETCH)
    # 16 stretches, spread over the record
    for begin in dict.fromkeys(np.linspace(0, last, 16).astype(int).tolist()):
        stretch = values[begin : begin + _STRETCH]
        power = np.abs(np.fft.rfft(stretch - np.mean(stretch))[1:]) ** 2
        if power.max() > (RARE_LINE + math.log(power.size)) * power.mean():
            return False
    return True


def onset(values: Array) -> int:
    """Return the first sample by which a drive has passed through half of its range."""
    low, high = np.quantile(values, [0.05, 0.95])
    gone = np.maximum.accumulate(values) - np.minimum.accumulate(values)
    return int(np.argmax(gone > 0.5 * (high - low)))


def frequency_of(t: Array, values: Array, quantity: str) -> tuple[float, float, int, float]:
    """Return ω of a drive and its standard error, rad/s, the number of cycles used, and the time at which the drive
    begins to move, s; −∞ if it moves from the first sample on.

    The leading samples are used, after those in which the drive stands still. If they hold too few cycles, a longer
    part of the record is averaged down to as many samples.
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
    """Return the means of successive groups of `every` values; an incomplete group at the end is left out."""
    return values[: values.size // every * every].reshape(-1, every).mean(axis=1)


def _frequency_in(t: Array, values: Array, step: float) -> tuple[float, float, int]:
    """Return ω of a drive, its standard error, and the first sample that moves, if the drive stands still for at least
    a cycle before; otherwise 0."""
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
    """Return the approximate amplitude of a signal at ω, freed of a linear drift; ∞ for less than a cycle."""
    if t.size < 3 or t[-1] - t[0] < 2.0 * math.pi / omega:
        return math.inf
    line = np.polyval(np.polyfit(t - t[0], values, 1), t - t[0])
    return 2.0 * float(np.abs(np.mean((values - line) * np.exp(-1j * omega * t))))


def step_of(t: Array, quantity: str) -> float:
    """Return the sampling interval, s. Raises ValueError for fewer than three samples."""
    if t.size < 3:
        raise ValueError(f"{quantity} has only {t.size} samples")
    return float(np.mean(np.diff(t)))
