"""Frequency and damping of a free decay over its amplitude, from the swings alone, without a damping law or a
stiffness.

In the band of a mode the mean of |x| between two zeros is 2/π times the amplitude X there. Over a range of amplitudes,
the slope of ln X over the cycles is the logarithmic decrement, and that of the cycles over the time is the frequency
(Inman, Engineering Vibration, Sec. 1.6):

    δ = ln(X_i/X_{i+1}),   ζ = δ/√(4π² + δ²),   η = 2ζ

Friction F_k alone has ζ = 2F_k/(πkX). Standard errors follow from the scatter about the lines.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Array
from .band import NOISE_PASSED, Band, filtered
from .bursts import Burst, Signal, slope_of
from .simpson import integrals

_FEWEST_HALVES = 4  # half cycles in a range
_FEWEST_SAMPLES, _FEWEST_IN_CYCLE = 20, 3.0  # samples of a decay, and of its cycle


@dataclass(frozen=True, slots=True)
class SwingDamping:
    """Frequency and damping of a mode in a range of amplitudes.

    mode : its number, 1 for the largest.   X : amplitude in the middle of the range, m.   cycles : in the range.
    hertz, ratio : frequency, Hz, and damping ratio ζ, with their standard errors.
    """

    mode: int
    X: float
    cycles: float
    hertz: float
    hertz_error: float
    ratio: float
    ratio_error: float

    def document(self, *_: float) -> dict[str, Any]:
        """Return the entry in `identification.json`."""
        return {
            "mode": self.mode,
            "X_m": self.X,
            "cycles": self.cycles,
            "frequency_Hz": self.hertz,
            "frequency_standard_error_Hz": self.hertz_error,
            "damping_ratio": self.ratio,
            "damping_ratio_standard_error": self.ratio_error,
            "loss_factor": 2.0 * self.ratio,
        }


def displacement_in(part: Signal, band: Band) -> Array:
    """Return the displacement in a band, m, of a channel of any order."""
    x = filtered(part.values, part.dt, band)
    for _ in range(part.order):
        x = filtered(np.cumsum(x) * part.dt, part.dt, band)
    return np.asarray(x)


def damping_of(signal: Signal, bursts: Sequence[Burst]) -> list[SwingDamping]:
    """Return the damping of each mode over the amplitude, in the largest burst of a channel; if the bursts that follow
    are beats of two modes, in all of these."""
    burst = max(bursts, key=lambda one: one.swing)
    part = signal.between(burst.turn, bursts[-1].end)
    if part.values.size < _FEWEST_SAMPLES or burst.period < _FEWEST_IN_CYCLE * signal.dt:
        return []
    frequencies = _modes(part, 1.0 / burst.period)
    apart = np.diff([one.turn for one in bursts if one.turn >= burst.turn])
    if apart.size:
        beats = [abs(one - frequencies[0]) * float(np.median(apart)) for one in frequencies[1:]]
        # the bursts of a beat come at its period to a fifth
        if not any(abs(beat - 1.0) < 0.2 for beat in beats):
            part = signal.between(burst.turn, burst.end)
            frequencies = _modes(part, 1.0 / burst.period)
    rows = []
    for mode, f in enumerate(frequencies, 1):
        about = Band.about(f, part.dt)
        half = 0.5 * min((abs(f - one) for one in frequencies if one != f), default=math.inf)
        band = Band(max(about.low, f - half), min(about.high, f + half))
        # about five ranges of amplitudes in all modes together
        ranges = _ranges(part, band, f, mode, 1 + 4 // len(frequencies))
        rows += [one for one in ranges if one.ratio > 0.0]
    return rows


def _modes(part: Signal, first: float) -> list[float]:
    """Return the frequencies of up to three modes, Hz, in descending order of the speed at their spectral peaks."""
    from scipy.signal import find_peaks  # slow to import

    n = part.values.size
    # falls smoothly to zero, so that the end of the record causes no peaks
    fading = np.cos(0.5 * math.pi * np.arange(n) / n) ** 2
    power = np.abs(np.fft.rfft((part.values - part.values.mean()) * fading)) ** 2
    f = np.fft.rfftfreq(n, part.dt)
    power[1:] *= f[1:] ** (2.0 - 2.0 * part.order)
    power[f < 0.3 * first] = 0.0
    # 1e-2 of the largest power in the spectrum: a tenth of the speed
    least = 1e-2 * power.max()
    logs = np.log(np.maximum(power, 1e-3 * least))
    # a peak has ten times the power of the valley before a larger one
    peaks = find_peaks(logs, height=math.log(least), prominence=math.log(10.0))[0]
    highest = f[peaks[np.argsort(-power[peaks])]]
    # the frequency of a burst is off by less than a quarter
    near = np.append(highest[np.abs(np.log(highest / first)) < math.log(1.25)], first)
    modes = [float(near[0])]
    for one in highest.tolist():
        ratios = [max(one / of, of / one) for of in modes]
        # within 2 % of a multiple of another mode lies a harmonic of its motion
        apart = all(abs(ratio / max(round(ratio), 2) - 1.0) > 0.02 for ratio in ratios)
        if (
            apart
            # modes differ by at least four lines of the spectrum
            and min(abs(one - of) for of in modes) * n * part.dt > 4.0
            and one < 0.4 / part.dt
        ):
            modes.append(one)
    return modes[:3]


def _ranges(part: Signal, band: Band, f: float, mode: int, most: int) -> list[SwingDamping]:
    """Return the damping in at most `most` ranges of the amplitude, down to the noise."""
    x = displacement_in(part, band)
    i = np.flatnonzero(x[:-1] * x[1:] < 0.0)
    # half cycles that the filter disturbs at either end, over one period of its bandwidth
    ends = max(1, math.ceil(2.0 * f / (band.high - band.low)))
    if i.size < _FEWEST_HALVES + 2 * ends:
        return []
    zeros = i + x[i] / (x[i] - x[i + 1])
    X = 0.5 * math.pi * np.abs(integrals(x, 1.0, zeros)) / np.diff(zeros)
    noise = part.noise * math.sqrt(2.0 * NOISE_PASSED * (band.high - band.low) * part.dt)
    noise /= (2.0 * math.pi * f) ** part.order
    # the duration of a half cycle may deviate by 0.4 of it
    regular = np.abs(2.0 * f * part.dt * np.diff(zeros) - 1.0) < 0.4
    # until the amplitude falls to five times the noise
    goes_on = regular & (5.0 * noise < X)
    first = int(np.argmax(goes_on)) + ends
    count = int(np.argmin(np.append(goes_on[first:], False))) - ends
    if count < _FEWEST_HALVES:
        return []
    t, logs = part.dt * zeros[first : first + count + 1], np.log(X[first : first + count])
    # if there are several ranges, the amplitudes in each span a ratio of at least 1.6
    many = int((logs[0] - logs[-1]) / math.log(1.6))
    edges = np.linspace(logs[0], logs[-1], max(1, min(many, most)) + 1)[1:-1]
    cuts = [0]
    for edge in edges:
        cut = int(np.argmax(logs < edge))
        if min(cut - cuts[-1], count - cut) >= _FEWEST_HALVES:
            cuts.append(cut)
    rows = []
    for start, end in pairwise([*cuts, count]):
        cycles = np.arange(end - start + 1) / 2.0
        hertz, hertz_error = slope_of(t[start : end + 1], cycles)
        fall, fall_error = slope_of(cycles[:-1], -logs[start:end])
        ratio = fall / math.hypot(2.0 * math.pi, fall)
        X_middle = math.exp(float(logs[start:end].mean()))
        error = fall_error / (2.0 * math.pi) * (1.0 - ratio**2) ** 1.5
        hertz_error = math.hypot(hertz_error, hertz * ratio**2)  # shift by the filter
        rows.append(
            SwingDamping(mode, X_middle, float(cycles[-1]), hertz, hertz_error, ratio, error)
        )
    return rows
