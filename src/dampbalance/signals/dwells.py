"""Dwells of a drive: stretches of a record with constant amplitude and frequency, as in a staircase of levels.

The drive is cut into cycles at the upward crossings of its mean; noise causes no crossings, since the signal must leave
a band about the mean in between. Each cycle has a period and an amplitude, √2 times its rms.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from ..arrays import Array

# Half the width of the band about the mean, relative to the largest deviation: without noise, and at most.
_BAND, _WIDEST = 0.05, 0.4
# smallest step of amplitude or frequency that begins a new dwell; smaller ones are drifts and beats
_STEP = math.log(1.15)
_FEWEST_CYCLES = 8  # of a dwell, of which the motion needs some to settle
_HELD = 0.6  # smallest share of cycles in dwells, in a record that consists of them


class Dwell(NamedTuple):
    """A stretch with one amplitude and frequency.   start, end : s.   amplitude : unit of the drive.   hertz : Hz."""

    start: float
    end: float
    amplitude: float
    hertz: float


class Swept(ValueError):
    """The frequency of a drive changes continuously."""


def dwells_of(t: Array, values: Array) -> list[Dwell]:
    """Return the dwells of a drive; none if amplitude and frequency do not step.

    t : s, in equal steps, (n,).   values : of the drive, (n,).

    Raises Swept if the frequency changes continuously.
    """
    edges, amplitude, period = _cycles(t, values)
    if amplitude.size < 2 * _FEWEST_CYCLES:
        return []
    logs = np.log(np.stack([amplitude, period]))
    smooth = median_filter(logs, size=(1, 5), mode="nearest")
    noise = 1.5 * np.median(np.abs(logs - smooth), axis=1, keepdims=True)
    # within a dwell, ln amplitude and ln period have a standard deviation of at most 0.02 plus noise
    limit = 0.02 + 2.0 * noise[:, 0]
    dwells: list[Dwell] = []
    held = first = 0
    for last in [*(_steps(smooth) + 1), amplitude.size]:
        inside = slice(first + 1, last - 1)  # the cycles next to a step belong to neither
        if last - first >= _FEWEST_CYCLES and (np.std(logs[:, inside], axis=1) <= limit).all():
            a, p = np.exp(np.median(logs[:, inside], axis=1)).tolist()
            dwell = Dwell(float(edges[first + 1]), float(edges[last - 1]), a, 1.0 / p)
            if dwells and _alike(dwells[-1], dwell):  # separated by a disturbance
                dwell = dwells.pop()._replace(end=dwell.end)
            dwells.append(dwell)
            held += last - first
        first = last
    if len(dwells) > 1 and held > _HELD * amplitude.size:
        return dwells
    part = max(3, amplitude.size // 50)
    begin, end = (float(np.exp(np.median(logs[1, of]))) for of in (slice(part), slice(-part, None)))
    # a drive that sweeps changes its frequency by a fifth from end to end
    if abs(math.log(begin / end)) > math.log(1.2) and held < _HELD * amplitude.size:
        raise Swept(
            f"the drive sweeps from {1.0 / begin:.3g} to {1.0 / end:.3g} Hz: steady responses are needed, each at one "
            "frequency; let the drive dwell there for 20 cycles or more"
        )
    return []


def _alike(one: Dwell, other: Dwell) -> bool:
    """Return whether two dwells have the same amplitude and frequency."""
    steps = (one.amplitude / other.amplitude, one.hertz / other.hertz)
    return all(abs(math.log(step)) < 0.5 * _STEP for step in steps)


def _steps(smooth: Array) -> Array:
    """Return the numbers of the cycles before a step, where the medians on both sides differ most and by more than
    `_STEP`.   smooth : ln amplitude and ln period of each cycle, without single outliers, (2, n)."""
    ahead = smooth[:, 3:] - smooth[:, :-3]  # over three cycles, as a step is seldom within one
    size = np.abs(ahead).max(axis=0)
    steps = []
    while size.size and size.max() > _STEP:
        at = int(np.argmax(size))
        steps.append(at + 1)
        size[max(0, at - 3) : at + 4] = 0.0
    return np.array(sorted(steps), dtype=np.intp)


def _cycles(t: Array, values: Array) -> tuple[Array, Array, Array]:
    """Return times of the upward crossings, s, (n + 1,), and amplitude and period of the cycles between, (n,)."""
    s = values - 0.5 * np.sum(np.quantile(values, (0.02, 0.98)))
    power = np.abs(np.fft.rfft(s)[1:]) ** 2
    # lines of the motion exceed the median, which is noise, and a part of the largest line
    clear = power > max(20.0 * float(np.median(power)), 0.003 * float(power.max()))
    fastest = 1 + int(np.flatnonzero(clear)[-1]) if clear.any() else power.size
    # a tenth of the shortest cycle, over which a moving average reduces a sine by 2 %
    width = int(0.1 * s.size / fastest)
    smooth = uniform_filter1d(s, width) if width > 1 else s
    noise = float(np.std(s - smooth)) / math.sqrt(max(1, width))
    largest = float(np.quantile(np.abs(smooth), 0.99))
    band = max(_BAND * largest, 4.0 * noise)
    side = np.where(smooth > band, 1, np.where(smooth < -band, -1, 0))
    outside = np.flatnonzero(side)
    rises = outside[1:][(side[outside[1:]] > 0) & (side[outside[:-1]] < 0)]
    # in a wider band noise would cause crossings
    if rises.size < 2 or band > _WIDEST * largest:
        return np.empty(0), np.empty(0), np.empty(0)
    sums = np.concatenate([[[0.0], [0.0]], np.cumsum([s, s**2], axis=1)], axis=1)
    count = np.diff(rises)
    mean, square = np.diff(sums[:, rises], axis=1) / count
    return t[rises], np.sqrt(2.0 * np.maximum(square - mean**2, 0.0)), np.diff(t[rises])
