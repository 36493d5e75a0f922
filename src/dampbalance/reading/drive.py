"""The drive of a record: whether it moves, from when on, and at which frequency."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from ..arrays import Array
from .checks import require_signal
from .cycles import Samples, drive_frequency

SampleBlocks = Callable[[], Iterable[Samples]]

LEADING = 1 << 18  # samples from which the drive frequency is first estimated
_ENOUGH = 8  # cycles of these; from fewer the spectrum may take one number of cycles for another
_COARSER = 4  # times: samples that are averaged where the cycles are too few
_STRETCH = 1 << 16  # samples that show whether a drive moves
_STRETCHES = 16  # of a record that are looked at
# A part of the largest deviation: a drive that is this near to rest for 95 % of the time strikes; a steady one is for
# 3 %.
_AT_REST = 0.05
# Amplitude before the onset over that after it; a line through one cycle of a sine leaves 39 % of it.
_STILL = 0.25
_LINE_OF_NOISE = 25.0  # times its mean, that no line of 32,768 in white noise has by chance


def stands_still(values: Array) -> bool:
    """Whether a drive channel holds nothing but noise, or single blows: no stretch of it has a line in its spectrum.

    Stretches from the whole record are looked at: a recorder may begin long before the drive does. Blows are brief; a
    spike of one or two samples is none.
    """
    if values.size > 2:
        # the middle one of each three neighbours
        low, high = np.minimum(values[:-1], values[1:]), np.maximum(values[:-1], values[1:])
        middle = np.maximum(low[:-1], np.minimum(high[:-1], values[2:]))
        off = np.abs(middle - np.median(middle))
        if np.quantile(off, 0.95) <= _AT_REST * off.max():
            return True
    last = max(0, values.size - _STRETCH)
    for begin in dict.fromkeys(np.linspace(0, last, _STRETCHES).astype(int).tolist()):
        stretch = values[begin : begin + _STRETCH]
        power = np.abs(np.fft.rfft(stretch - np.mean(stretch))[1:]) ** 2
        if power.max() > _LINE_OF_NOISE * power.mean():
            return False
    return True


def onset(values: Array) -> int:
    """The sample at which a drive has begun: the first by which it has gone through half of its range."""
    low, high = np.quantile(values, [0.05, 0.95])
    gone = np.maximum.accumulate(values) - np.minimum.accumulate(values)
    return int(np.argmax(gone > 0.5 * (high - low)))


def frequency_of(blocks: SampleBlocks, quantity: str) -> tuple[float, float, int, float]:
    """ω of a drive, its standard error, rad/s, cycles that they come from, and the time from which on it moves, s; −∞
    where it does from the first sample on.

    It is sought in the leading samples, after those in which the drive stands still. Where these hold too few cycles,
    it is sought in averages of more and more of them.
    """
    every, begin = 1, -math.inf
    while True:
        t, values = leading_samples(blocks(), LEADING, begin, every)
        step, ended = step_of(t, quantity), t.size < LEADING
        if ended:
            require_signal(quantity, values)
        elif stands_still(values):
            begin = float(t[-1])
            continue
        try:
            omega, error, late = _frequency_in(t, values, step)
            cycles = math.floor((t[-1] - t[late]) / (2.0 * math.pi / omega))
            if cycles >= _ENOUGH or ended:
                return omega, error, cycles, float(t[late]) if late else begin
        except ValueError as problem:
            if ended:
                raise ValueError(f"{quantity}: {problem}") from problem
        every *= _COARSER


def _frequency_in(t: Array, values: Array, step: float) -> tuple[float, float, int]:
    """ω of a drive, its standard error, and the sample from which on it moves, if it stands still for a cycle or more
    before; otherwise 0."""
    begins, first = onset(values), None
    try:
        omega, error = drive_frequency(t, values, step)
        if t[begins] - t[0] <= 2.0 * math.pi / omega:
            return omega, error, 0
    except ValueError as problem:
        first = problem
    try:
        later, its_error = drive_frequency(t[begins:], values[begins:], step)
    except ValueError:
        if first is not None:
            raise first from None
        return omega, error, 0
    before = int(np.searchsorted(t, t[begins] - 2.0 * math.pi / later))
    parts = slice(0, before), slice(begins, None)
    still, moving = (_amplitude(t[part], values[part], later) for part in parts)
    if still < _STILL * moving:
        return later, its_error, begins
    if first is not None:
        raise first
    return omega, error, 0


def _amplitude(t: Array, values: Array, omega: float) -> float:
    """About the amplitude of a signal at ω, without a slow drift; ∞ where there is less than a cycle of it."""
    if t.size < 3 or t[-1] - t[0] < 2.0 * math.pi / omega:
        return math.inf
    line = np.polyval(np.polyfit(t - t[0], values, 1), t - t[0])
    return 2.0 * float(np.abs(np.mean((values - line) * np.exp(-1j * omega * t))))


def leading_samples(
    blocks: Iterable[Samples], count: int, begin: float = -math.inf, every: int = 1
) -> Samples:
    """The first samples of a channel from a time on, s, or the means of each `every` of them: `count` if there are as
    many."""
    parts, size, rest = [], 0, (np.empty(0), np.empty(0))
    for block in blocks:
        first = int(np.searchsorted(block[0], begin))
        t, values = (
            np.append(old, new[first : first + (count - size) * every])
            for old, new in zip(rest, block, strict=True)
        )
        whole = min(len(t) // every, count - size)
        rest = t[whole * every :], values[whole * every :]
        parts.append([of[: whole * every].reshape(-1, every).mean(axis=1) for of in (t, values)])
        size += whole
        if size >= count:
            break
    t, values = (np.concatenate(of) for of in zip(*parts, strict=True))
    return t, values


def step_of(t: Array, quantity: str) -> float:
    """Sampling interval, s: the mean over the steps that are no gaps."""
    if t.size < 3:
        raise ValueError(f"{quantity} has only {t.size} samples")
    steps = np.diff(t)
    if np.ptp(steps) >= 0.5 * steps.min():
        median = np.median(steps)
        steps = steps[np.abs(steps - median) < 0.5 * median]
    return float(np.mean(steps))
