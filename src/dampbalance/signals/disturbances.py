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

from ..arrays import Array, Complexes
from ..project.wording import part

P_LINE = 1e-5
"""Probability with which white noise may show a line, all lines and stretches together. The floor of the spectrum is an
estimate itself: 1 of 1,800 residuals of noise was measured. Nothing is doubted for a line that is named."""

_FLOOR_BINS = 100  # lines of the spectrum whose median is the noise about them: known to 14 %
_SHORTEST = 128  # samples of the shortest stretch that is looked at, for the sake of such a median
_MOST_LINES = 8  # that are taken off: more are no list that anyone reads
_LOWEST_BIN = 3  # below it a drift and the offset of the record are left over
_APART = 0.1  # relative distance from a frequency of the model, within which its own residual lies
_OWN = (
    0.05  # likewise from a line taken off before: its sidebands, where it is not a pure exponential
)
_BLOCKS = 512  # in which the demodulated residual is averaged before a line is fitted to it
_MAINS_HZ, _MAINS_OFF = (50.0, 60.0), 0.005  # grids hold ±0.4 %, the clock of a recorder ±0.01 %
_ERRORS = (
    3.0  # standard errors within which a rate is taken for zero, a frequency for that of the mains
)
_STEADY = 0.5  # βT of a line that changes too little over the record, T, to be called a decay
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


def lines_of(residual: Array, dt: float, model_hz: Sequence[float] = ()) -> list[Line]:
    """The lines in the residual of a decay, the likeliest first.

    residual : record less model, from the start of the decay on, not filtered, (n,).   dt : sampling interval, s.
    model_hz : frequencies of the model itself, sliding and sticking, with those harmonics that the contact makes.
    Within a tenth of them a residual is one of the fit: it is taken off, and not named.
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
        width = max(_OWN * frequency, _LOWEST_BIN / (rest.size * dt))
        taken_off.append((frequency, width))
        if line is not None and all(abs(frequency - f) > _APART * f for f in model_hz):
            lines.append(line)
    return lines


def _floor(power: Array) -> Array:
    """Mean power of the noise about each line of a spectrum, from medians of neighbouring ones."""
    count = max(1, power.size // _FLOOR_BINS)
    width = power.size // count
    # the median of |noise|², which is distributed exponentially, is ln 2 times its mean
    levels = np.median(power[: count * width].reshape(count, width), axis=1) / math.log(2.0)
    middles = width * (np.arange(count) + 0.5)
    return np.exp(np.interp(np.arange(power.size), middles, np.log(np.maximum(levels, 1e-300))))


def _clearest(
    rest: Array, dt: float, floor: Array, without: Sequence[tuple[float, float]]
) -> float | None:
    """Frequency at which a spectrum stands out of its floor most clearly, Hz; None where noise would do it.

    floor : power of the noise per sample, at the lines of the whole spectrum.   without : frequencies and the distances
    from them that are left out, Hz.
    """
    sizes = [rest.size]
    while sizes[-1] >= 2 * _SHORTEST:
        sizes.append(sizes[-1] // 2)
    best, clearest = None, -math.log(P_LINE / len(sizes))
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
    """The line near a frequency, fitted by least squares, and its samples; no line where it is none."""
    from scipy.optimize import least_squares  # slow to import

    t = dt * np.arange(rest.size)
    duration, omega = rest.size * dt, 2.0 * math.pi * frequency
    every = max(1, rest.size // _BLOCKS)
    count = rest.size // every
    turned = (2.0 * rest * np.exp(-1j * omega * t))[: count * every].reshape(count, every)
    z, at = turned.mean(axis=1), t[: count * every].reshape(count, every).mean(axis=1)

    def parted(p: Array) -> tuple[complex, Complexes]:
        """C and the residual of z = C e^{(−β + iδ)t}, in units of the duration."""
        wave = np.exp((-p[0] + 1j * p[1]) * at / duration)
        factor = complex(np.vdot(wave, z) / np.vdot(wave, wave).real)
        return factor, z - factor * wave

    def left(p: Array) -> Array:
        """Real and imaginary parts of the residual."""
        return parted(p)[1].view(np.float64)

    ends = [least_squares(left, [rate, 0.0], x_scale=[1.0, 1.0]) for rate in (0.1, 3.0, 30.0)]
    end = min(ends, key=lambda each: float(each.cost))
    variance = 2.0 * float(end.cost) / max(1, 2 * count - 4)
    jacobian = np.asarray(end.jac)
    errors = np.sqrt(variance * np.diag(np.linalg.pinv(jacobian.T @ jacobian)))
    rate, shift, rate_error, shift_error = (np.append(end.x, errors) / duration).tolist()
    omega = omega + shift
    if rate > _BROAD * omega:
        return None, rest
    steady = rate * duration < max(_STEADY, _ERRORS * rate_error * duration)
    factor = parted(end.x)[0]
    wave = (factor * np.exp((-rate + 1j * omega) * t)).real
    hertz, hertz_error = omega / (2.0 * math.pi), shift_error / (2.0 * math.pi)
    near = [base * max(1, round(hertz / base)) for base in _MAINS_HZ]
    mains = min(abs(hertz - each) - _MAINS_OFF * each for each in near) < _ERRORS * hertz_error
    if steady:
        size = math.sqrt(2.0 * float(np.mean(wave**2)))
        return Line(hertz, size, 0.0, "mains" if mains else "tone"), wave
    return Line(hertz, abs(factor), rate, "mode"), wave
