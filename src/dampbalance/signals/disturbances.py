"""Lines in the residual of a decay: hum of the mains, further modes of the rig, steady tones of machines nearby.

They stand out of the noise around them in the spectrum of the residual, or of its first half, quarter …, where a mode
that decays quickly is loudest. Each is then fitted by A e^{−βt} cos(ωt + φ), taken off, and the next one is sought.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import Array
from ..project.wording import part
from .drive import averaged
from .thresholds import P_LINE_IN_NOISE

_FLOOR_BINS = 100  # lines of the spectrum whose median is the noise about them: known to 14 %
_MOST_LINES = 8  # that are taken off: more are no list that anyone reads
_LOWEST_BIN = 3  # below it a drift and the offset of the record are left over
# Distance within which a line is one of the model, relative to f_n about its multiples, and relative to a line that was
# taken off before: a twentieth of all frequencies is lost, and no contact's harmonics are taken for tones.
_APART = 0.05
# Hum is at the first six multiples, of which rectifiers leave more than 1 %, and folded by the sampling at the first
# three; grids hold ±0.1 %, and clocks of recorders are off by 0.01 %.
_MAINS_HZ, _MULTIPLES, _FOLDED, _MAINS_OFF = (50.0, 60.0), 6, 3, 0.002
_ERRORS = 3.0  # standard errors within which a decay rate is taken for zero
_STEADY = 0.5  # βT of a line that changes too little over the record, T, to be called a decay
_OF_CYCLE = 0.125  # so long means of samples leave 97 % of a line
_BROAD = 0.3  # damping ratio above which it is no line but a pulse


@dataclass(frozen=True, slots=True)
class Line:
    """A line A e^{−βt} cos(ωt + φ) in a residual.

    frequency_hz : ω/2π.   amplitude : A, at the start where it decays, in the unit of the samples.
    decay_rate : β, 1/s, 0 where it is steady.   kind : hum of the mains or a multiple of it, a mode, which decays, or
    another steady tone.
    """

    frequency_hz: float
    amplitude: float
    decay_rate: float
    kind: Literal["mains", "mode", "tone"]

    def words(self, motion: float) -> str:
        """Name the line with its size.   motion : amplitude of the decay at its start, in the unit of the samples."""
        size = f"{part(self.amplitude / motion)} of the motion"
        if self.kind == "mains":
            return f"hum of {self.frequency_hz:.3g} Hz, {size}"
        hertz = f"{self.frequency_hz:.4g} Hz"
        if self.kind == "tone":
            return f"a steady tone of {hertz}, {size}"
        ratio = self.decay_rate / math.hypot(self.decay_rate, 2.0 * math.pi * self.frequency_hz)
        return f"a further mode of {hertz} with a damping ratio of {part(ratio)}, {size}"


def lines_of(residual: Array, dt: float, f_n: float, f_stuck: float = 0.0) -> list[Line]:
    """Return the lines in the residual of a decay, the clearest first.

    A line at the frequencies of the model is a residual of the fit itself: it is taken off, and not named.

    residual : record less model, from the start of the decay on, not filtered, (n,).   dt : sampling interval, s.
    f_n, f_stuck : natural frequencies with the contact slipping and, where it rings visibly, stuck, Hz.
    """
    rest = residual - residual.mean()
    floor = _floor(np.abs(np.fft.rfft(rest)) ** 2) / rest.size
    taken_off: list[tuple[float, float]] = []
    lines: list[Line] = []
    for _ in range(_MOST_LINES):
        frequency = _clearest(rest, dt, floor, taken_off)
        if frequency is None:
            break
        line, wave = _fitted(rest, dt, frequency)
        rest = rest - wave
        width = max(_APART * frequency, _LOWEST_BIN / (rest.size * dt))
        taken_off.append((frequency, width))
        multiple = round(frequency / f_n)
        of_model = abs(frequency - f_n * multiple) < _APART * f_n
        of_model &= multiple % 2 == 1 or multiple == 2  # odd: a contact alike in both directions
        of_model |= abs(frequency - f_stuck) < width
        # hum is as steady at a multiple as elsewhere; at the frequency itself it looks like a residual
        if line is not None and (not of_model or (line.kind == "mains" and multiple > 1)):
            lines.append(line)
    return lines


def _floor(power: Array) -> Array:
    """Return the mean power of the noise about each line of a spectrum, from medians of neighbouring ones."""
    count = max(1, power.size // _FLOOR_BINS)
    width = power.size // count
    # the median of |noise|², which is distributed exponentially, is ln 2 times its mean
    levels = np.median(power[: count * width].reshape(count, width), axis=1) / math.log(2.0)
    middles = width * (np.arange(count) + 0.5)
    return np.exp(np.interp(np.arange(power.size), middles, np.log(np.maximum(levels, 1e-300))))


def _clearest(
    rest: Array, dt: float, floor: Array, without: Sequence[tuple[float, float]]
) -> float | None:
    """Return the frequency at which a spectrum stands out of its floor most clearly, Hz; None where noise would do it.

    The floor is an estimate itself: 2 of 3,000 residuals of white noise had a line, where the threshold says 0.3.

    floor : power of the noise per sample, at the lines of the whole spectrum.   without : frequencies and the distances
    from them that are left out, Hz.
    """
    sizes = [rest.size]
    while sizes[-1] >= 2 * _FLOOR_BINS:
        sizes.append(sizes[-1] // 2)
    best, clearest = None, -math.log(P_LINE_IN_NOISE / len(sizes))
    for size in sizes:
        power = np.abs(np.fft.rfft(rest[:size])) ** 2
        place = np.arange(power.size)
        noise = size * np.interp(place * (rest.size / size), np.arange(floor.size), floor)
        f = place / (size * dt)
        usable = place >= _LOWEST_BIN
        usable[-1] = False  # real: its square has another distribution
        for centre, half in without:
            usable &= np.abs(f - centre) > half
        ratio = np.where(usable, power, 0.0) / np.maximum(noise, _floor(power))
        clear = float(ratio.max()) - math.log(f.size)
        if clear > clearest:
            best, clearest = float(f[int(np.argmax(ratio))]), clear
    return best


def _fitted(rest: Array, dt: float, frequency: float) -> tuple[Line | None, Array]:
    """Return the line near a frequency, fitted by least squares, and its samples; None instead of the line where it is
    a pulse."""
    from scipy.optimize import least_squares  # slow to import

    t = np.arange(rest.size) / rest.size
    duration = rest.size * dt
    # means of an eighth of a cycle determine frequency and decay as well
    every = max(1, math.floor(_OF_CYCLE / (frequency * dt)))
    means, times = averaged(rest, every), averaged(t, every)
    scale = math.sqrt(float(means @ means))

    def wave_of(p: Array, at: Array, values: Array) -> tuple[complex, Array]:
        """Return C and the samples of Re C e^{(−β + iω)t}, the closest one with βT, ωT = p."""
        wave = np.exp((-p[0] + 1j * p[1]) * at)
        pair = np.stack([wave.real, -wave.imag])
        real, imaginary = np.linalg.solve(pair @ pair.T, pair @ values)
        return complex(real, imaginary), pair.T @ [real, imaginary]

    def left(p: Array) -> Array:
        """Return the residual of the closest wave, in units in which its sum of squares is about 1."""
        return (means - wave_of(p, times, means)[1]) / scale

    turns = 2.0 * math.pi * frequency * duration
    starts = [np.array([rate, turns]) for rate in (0.0, 1.0, 3.0, 10.0, 30.0, 100.0)]
    end = least_squares(left, min(starts, key=lambda p: float(np.sum(left(p) ** 2))))
    jacobian = np.asarray(end.jac)
    variance = 2.0 * float(end.cost) / means.size * np.linalg.pinv(jacobian.T @ jacobian)
    rate, omega = (end.x / duration).tolist()
    if rate > _BROAD * omega:
        return None, 0.0 * rest
    factor, wave = wave_of(end.x, t, rest)
    hertz = omega / (2.0 * math.pi)
    if end.x[0] >= max(_STEADY, _ERRORS * math.sqrt(variance[0, 0])):
        return Line(hertz, abs(factor), rate, "mode"), wave
    size = math.sqrt(2.0 * float(np.mean(wave**2)))
    return Line(hertz, size, 0.0, "mains" if _of_mains(hertz, 1.0 / dt) else "tone"), wave


def _of_mains(hertz: float, sampling_hz: float) -> bool:
    """Return whether a frequency is that of the mains, a multiple, or one that was folded by the sampling."""
    for base in _MAINS_HZ:
        for n in range(1, _MULTIPLES + 1):
            folded = abs(n * base - sampling_hz * round(n * base / sampling_hz))
            if (folded == n * base or n <= _FOLDED) and abs(hertz - folded) < _MAINS_OFF * n * base:
                return True
    return False
