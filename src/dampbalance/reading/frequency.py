"""The drive frequency, from the excitation itself.

A first guess from the highest line of a windowed spectrum; then the phase of the fundamental, cycle by cycle, against
time: its slope is the error of the guess. For white noise this is least squares on the sinusoid, whose variance is

    var ω = 12 σ² · 2/(A² n) / duration²       (the Cramér–Rao bound: Rife & Boorstyn 1974)

with n samples of standard deviation σ about an amplitude A.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from ..arrays import Array
from .cycles import CycleHarmonics, accumulate

FEWEST_CYCLES = 3
_LONGEST_SPECTRUM = 1 << 18
_REFINEMENTS = 4
_LEADING = 1 << 16  # samples that show whether a drive moves
_LINE_OF_NOISE = 25.0  # times its mean, that no line of 32,768 in white noise has by chance


def drive_frequency(t: Array, values: Array, dt: float) -> tuple[float, float]:
    """(ω, standard error of ω), rad/s, of the strongest sinusoid of a signal in steps of dt.

    Raises ValueError when there is none or the signal is shorter than three of its cycles.
    """
    omega = _strongest_line(values[:_LONGEST_SPECTRUM], dt)
    error = math.nan
    for _ in range(_REFINEMENTS):
        hertz, per_cycle = omega / (2.0 * math.pi), 2.0 * math.pi / omega / dt
        cycles = math.floor((t[-1] - t[0] + dt * (1.0 + 1e-6)) * omega / (2.0 * math.pi))
        if cycles < FEWEST_CYCLES:
            raise ValueError(
                f"the signal is {t[-1] - t[0]:.4g} s long, {cycles} whole cycles of the {hertz:.4g} Hz found in it; at "
                f"least {FEWEST_CYCLES} are needed"
            )
        highest = min(3, math.floor(per_cycle / 4.0))
        if highest < 1:
            raise ValueError(
                f"{per_cycle:.1f} samples per cycle of the {hertz:.4g} Hz found are too few"
            )
        harmonics = accumulate(
            [(t, values)], omega, start=float(t[0]), dt=dt, harmonics=highest, cycles=cycles
        )
        correction, error = frequency_offset(harmonics)
        omega += correction
        # each correction is thousands of times smaller than the one before
        if abs(correction) <= 0.1 * error or abs(correction) < 1e-13 * omega:
            break
    return omega, error


def stands_still(values: Array) -> bool:
    """Whether a drive channel holds nothing but noise: the spectrum of its leading samples has no line."""
    values = values[:_LEADING] - np.mean(values[:_LEADING])
    power = np.abs(np.fft.rfft(values)[1:]) ** 2
    return bool(power.max() < _LINE_OF_NOISE * power.mean())


def frequency_offset(harmonics: CycleHarmonics) -> tuple[float, float]:
    """(Δω, its standard error), rad/s: by how much the drive is faster than the ω that the harmonics were taken at.

    The slope of the phase of the fundamental over the rows, by least squares.
    """
    usable = harmonics.weights > 0.0
    if np.count_nonzero(usable) < FEWEST_CYCLES:
        return 0.0, math.nan
    phase = np.unwrap(np.angle(harmonics.coefficients[usable, 1]))
    times, weights = harmonics.times[usable], harmonics.weights[usable]
    total = weights.sum()
    time, phase = times - weights @ times / total, phase - weights @ phase / total
    spread = float(weights @ time**2)
    slope = float((weights * time) @ phase) / spread
    variance = float(weights @ (phase - slope * time) ** 2) / (len(phase) - 2)
    return slope, math.sqrt(variance / spread)


@lru_cache(maxsize=2)  # records of a set have one length
def _window(size: int) -> Array:
    """Hann's window."""
    return np.hanning(size)


def _strongest_line(values: Array, dt: float) -> float:
    """Angular frequency of the highest line of the spectrum (Hann window), between lines by a parabola of the logs."""
    size = values.size
    # a transform of any other length can take ten times as long
    padded = 1 << (size - 1).bit_length()
    spectrum = np.abs(np.fft.rfft((values - values.mean()) * _window(size), padded))
    spectrum[0] = 0.0
    line = int(np.argmax(spectrum[:-1])) if size > 4 else 0
    if line == 0 or not spectrum[line] > 0.0:
        raise ValueError("the signal does not oscillate: its spectrum has no line")
    low, middle, high = np.log(np.maximum(spectrum[line - 1 : line + 2], 1e-300))
    shift = 0.5 * (low - high) / (low - 2.0 * middle + high) if line > 1 else 0.0
    return 2.0 * math.pi * (line + min(max(shift, -0.5), 0.5)) / (padded * dt)
