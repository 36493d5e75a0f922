"""Detection of the free decays (bursts) of a record, each from a push, a blow or a release until the next.

In every channel the swing over a little more than half a cycle jumps to a larger value and then decays. The period
comes from the spectrum, weighted so that neither the displacement at which the mass was held nor the ringing of the
stuck mass dominates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array, Mask
from .thresholds import RARE_LINE, SIGNIFICANT

_BAND = 1.25  # ratio of the upper end of a band to its centre; a decay is no sharp line


@dataclass(frozen=True, eq=False)
class Signal:
    """A channel of the mass.

    order : of the derivative, 0 displacement, 1 velocity, 2 acceleration.   t : s.   values : SI.
    noise : standard deviation.   offset : index of the channel among those of all records, each with its own offset.
    limits : smallest and largest value of the converter, at which samples are clipped.
    missing : mask of the samples that the record lacks, whose values are interpolated; None for none.
    """

    quantity: str
    order: int
    t: Array
    values: Array
    noise: float
    offset: int = 0
    limits: tuple[float, float] = (-math.inf, math.inf)
    missing: Mask | None = None

    @property
    def left_out(self) -> Mask:
        """Mask of the samples that are clipped or missing, (n,)."""
        at_limit = (self.values <= self.limits[0]) | (self.values >= self.limits[1])
        return at_limit if self.missing is None else at_limit | self.missing

    @property
    def dt(self) -> float:
        """Sampling interval, s."""
        return float(self.t[-1] - self.t[0]) / (self.t.size - 1)

    def between(self, start: float, end: float) -> Signal:
        """Return the samples from `start` to `end`, s."""
        return self.part(slice(*np.searchsorted(self.t, [start, end])))

    def part(self, samples: slice) -> Signal:
        """Return some of the samples."""
        missing = None if self.missing is None else self.missing[samples]
        return replace(self, t=self.t[samples], values=self.values[samples], missing=missing)


@dataclass(frozen=True, slots=True)
class Burst:
    """The approximate location of a free decay.

    turn : time of a turn of the free motion, s.   swing : distance to the next turn, m.   period : of the motion, s.
    earliest, end : times between which the decay begins and ends, s.   last : whether it is the last of the record.
    """

    turn: float
    swing: float
    period: float
    earliest: float
    end: float
    last: bool


QUIET_PARTS = 8
"""Parts of a record, the quietest of which gives the noise."""

SAMPLES_A_CYCLE = 10
"""Fewest samples per cycle of a decay. With fewer, three of ten fits fail: kinks of the motion and the ringing of the
stuck mass lie between the samples, and third differences, which measure the noise, consist mostly of motion."""


class NoDecay(ValueError):
    """The record contains no free decay; the message says why."""


def too_few_samples(a_cycle: float) -> str:
    """Return a message if a cycle has fewer samples than a decay needs; otherwise ""."""
    if a_cycle >= SAMPLES_A_CYCLE:
        return ""
    return f"it has {a_cycle:.2g} samples a cycle, {SAMPLES_A_CYCLE} are needed: sample faster"


def noise_of(values: Array) -> float:
    """Return the standard deviation of the white noise of a smooth signal.

    It follows from third differences in the quietest part of the record or, with few samples per cycle, from the median
    of the spectrum, and is at least that of rounding and quantization.
    """
    steps = np.diff(np.unique(values))
    digits = float(steps.min()) / math.sqrt(12.0) if steps.size else 0.0
    third = np.abs(np.diff(values, 3))
    # 200 or more in a part, whose median is then known to 11 %
    parts = np.array_split(third, max(1, min(QUIET_PARTS, third.size // 200)))
    # third differences of white noise have 1 + 9 + 9 + 1 times its variance; 1.4826 medians are a standard deviation
    quiet = 1.4826 * min(float(np.median(part)) for part in parts) / math.sqrt(20.0)
    power = np.abs(np.fft.rfft(values - values.mean())) ** 2
    # with fewer than 14 samples per cycle, third differences are motion
    if 14 * int(np.argmax(power)) > values.size:
        quiet = min(quiet, math.sqrt(float(np.median(power)) / values.size / math.log(2.0)))
    return max(quiet, digits, least_noise(values))


def sharpest(signals: Sequence[Signal]) -> Signal:
    """Return the channel with the largest ratio of motion to noise."""
    return max(signals, key=lambda one: float(np.ptp(one.values)) / one.noise)


def least_noise(values: Array) -> float:
    """Return the smallest standard deviation assumed for the noise of a signal, that of the best transducers."""
    return 3e-6 * float(np.ptp(values))


def bursts_of(signal: Signal) -> list[Burst]:
    """Return the bursts of a channel in order of time. Raises NoDecay if there are none.

    If fewer than half of them remain without higher modes, the others were beats of these.
    """
    # smoothed over an eighth of a cycle, in which a parabola follows a turn to 1e-4 of its swing
    bursts = _bursts_of(signal, 0.125)
    if len(bursts) > 1:
        # over half a cycle to a tenth of the swing, but without a mode of three times the frequency and its beats
        smoother = _bursts_of(signal, 0.5)
        bursts = smoother if 2 * len(smoother) < len(bursts) else bursts
    return bursts


def _bursts_of(signal: Signal, smooth_over: float) -> list[Burst]:
    """Return the bursts of a channel smoothed over a part of a cycle."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # slow to import, all of them
    from scipy.signal import savgol_filter

    period = 1.0 / _frequency(signal)
    width = max(5, 2 * round(0.5 * smooth_over * period / signal.dt) + 1)
    # 0.6 cycles, in which a decay passes two turns
    length = max(4, round(0.6 * period / signal.dt))
    if signal.values.size < 2 * max(width, length):
        raise NoDecay("it is shorter than a cycle of its motion")
    # mode "nearest": a polynomial through the first samples would overshoot if a blow falls among them
    smooth = savgol_filter(signal.values, width, 2, mode="nearest")
    # the filters cover the samples from each one on
    ahead = -(length // 2)
    swing = maximum_filter1d(smooth, length, origin=ahead, mode="nearest")
    swing -= minimum_filter1d(smooth, length, origin=ahead, mode="nearest")
    # eight standard deviations of the smoothed signal, 1.5 σ/√width
    clear = 12.0 * signal.noise / math.sqrt(width)
    # bursts below 3 % of the largest determine F_k poorly
    least = max(0.03 * float(swing.max()), clear)
    peaks = _peaks(swing, length, least, clear)
    if not peaks:
        raise NoDecay("no decaying motion in it exceeds the noise")
    # two windows contain a whole cycle and its largest swing; two cycles are too few to show a steady motion
    widest = maximum_filter1d(swing, length, origin=ahead, mode="nearest")
    parts = [slice(i, max(j - 2 * length, i + 1)) for i, j in pairwise([*peaks, swing.size])]
    # a decay falls below 85 % of its first swing, a steady motion with noise does not
    steady = all(widest[part].min() > 0.85 * swing[part.start] for part in parts)
    first = swing[peaks[0] : [*peaks, swing.size][1] - length]
    falls = _falls(first, round(0.5 * period / signal.dt))
    if swing.size - peaks[0] > 4 * length and steady and not falls:
        raise NoDecay("it swings as far at its end as at its start")
    bursts = []
    for before, i, stop in zip([0, *peaks], peaks, [*peaks[1:], swing.size - 1], strict=False):
        part = smooth[i : i + length]
        one, other = sorted((int(np.argmax(part)) + i, int(np.argmin(part)) + i))
        turn = other
        if signal.order == 1:
            half = 0.5 * (smooth[one] + smooth[other]) * (smooth[one] * smooth[other] > 0.0)
            turn = one + int(np.argmax((smooth[one:other] - half) * (smooth[one] - half) <= 0.0))
        bursts.append(
            Burst(
                turn=float(signal.t[turn]),
                swing=float(swing[i]) * (period / (2.0 * math.pi)) ** signal.order,
                period=period,
                earliest=float(signal.t[before]),
                end=float(signal.t[stop]),
                last=i == peaks[-1],
            )
        )
    return bursts


def _falls(swing: Array, half: int) -> bool:
    """Return whether swings fall significantly, and do not level off as those of a motion that settles do.

    half : samples of a half cycle.
    """
    sizes = np.log(np.maximum.reduceat(swing, np.arange(0, swing.size - half + 1, half)))
    if sizes.size < 4:
        return False
    fall, error = slope_of(np.arange(float(sizes.size)), -sizes)
    middle, n = sizes.size // 2, sizes.size - 1
    settles = sizes[middle] - sizes[n] < 0.3 * fall * (n - middle)
    # 4 %: a smaller fall is no decay
    return fall * n > max(0.04, SIGNIFICANT * error * n) and not settles


def _peaks(swing: Array, length: int, least: float, clear: float) -> list[int]:
    """Return the indices of local maxima of the swing above `least` that follow a swing smaller by much more than the
    noise, which is half of `clear`."""
    from scipy.ndimage import maximum_filter1d

    around = maximum_filter1d(swing, 4 * length + 1, mode="nearest")
    # the largest of the preceding half cycle, as the swing over the window is a third smaller in between
    calm = maximum_filter1d(swing, length, origin=(length - 1) // 2, mode="nearest")
    peaks: list[int] = []
    for i in np.flatnonzero((swing >= around) & (swing >= least)):
        before = calm[max(0, i - 5 * length) : i + 1]
        # the largest swing of a record begins a decay, even if it follows a blow during the first one; with seven
        # samples per cycle a tenth of a swing may be missed
        largest = swing[i] >= swing.max() and not (peaks and swing[peaks[-1]] > 0.9 * swing[i])
        # the motion before a burst is smaller than 0.6 of its swing; otherwise it is a beat
        rises = i < length or before.min() < 0.6 * (swing[i] - 0.5 * clear) or largest
        if rises and (not peaks or i - peaks[-1] > 2 * length):
            peaks.append(int(i))
    return peaks


def _frequency(signal: Signal) -> float:
    """Return the frequency of the motion, Hz, the weighted mean over the band with the most energy."""
    values = signal.values - signal.values.mean()
    size = values.size
    power = np.abs(np.fft.rfft(values, 1 << (size - 1).bit_length())) ** 2
    f = np.arange(power.size) / (2.0 * (power.size - 1) * signal.dt)
    clear = power > RARE_LINE * size * signal.noise**2
    # below 1.5 cycles in the record lies the step of a release; a decay that slips in two half cycles has 1.5
    clear[f < 1.5 / (size * signal.dt)] = False
    energy = np.where(clear, power, 0.0)
    energy[1:] *= f[1:] ** (1.0 - signal.order)
    total = np.concatenate([[0.0], np.cumsum(energy)])
    low, high = np.searchsorted(f, f / _BAND), np.searchsorted(f, f * _BAND, side="right")
    band = total[high] - total[low]
    best = int(np.argmax(band))
    if not band[best] > 0.0:
        raise NoDecay(
            f"no oscillation in it exceeds the noise; with fewer than {SAMPLES_A_CYCLE} samples a cycle one may be lost"
        )
    inside = slice(low[best], high[best])
    return float(np.sum(f[inside] * energy[inside]) / np.sum(energy[inside]))


def slope_of(along: Array, values: Array) -> tuple[float, float]:
    """Return the slope of a straight line and its standard error, for residuals with correlated neighbours."""
    off = along - along.mean()
    slope = float(off @ values / (off @ off))
    left = values - values.mean() - slope * off
    square = max(float(left @ left), 1e-300)
    alike = min(max(float(left[1:] @ left[:-1]) / square, 0.0), 0.95)
    wider = (1.0 + alike) / (1.0 - alike)
    return slope, math.sqrt(wider * square / (left.size - 2) / float(off @ off))
