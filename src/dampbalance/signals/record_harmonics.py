"""The harmonics of a record that a fit of the oscillator takes, with their errors.

Phases count from the peak of the base: y = Y cos ωt, x = Re Σ x_n e^{inωt}, n odd.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, Complexes, Integers, Mask
from ..records.channel import ORDERS, Correction
from .conditioning import SteadyRecord
from .thresholds import CERTAIN, SIGNIFICANT

# Degrees of freedom that a row adds to an error, which is smoothed over five harmonics.
_NEIGHBOURS = 6


@dataclass(frozen=True, eq=False)
class Folds:
    """The share of harmonics x_p beyond half the sampling rate in the x_n of a record, where no filter took them off.

    orders : p, (…, 2, h), those of one multiple of the rate and either sign of n together.   factors : of x_p or its
    conjugate.   mirrored : which is conjugate.
    """

    orders: Integers
    factors: Complexes
    mirrored: Mask

    def of(self, x: Complexes) -> Complexes:
        """Return what is added to each x_n, m, (h,).   x : x_p, m."""
        return np.asarray(np.sum(self.factors * np.where(self.mirrored, x.conj(), x), axis=(0, 1)))


@dataclass(frozen=True, eq=False)
class RecordHarmonics:
    """Harmonics of one record.

    omega : rad/s.   Y : amplitude of the base, m.   n : odd orders, (h,).   x : x_n, m, (h,).
    Y_error, x_error : standard deviations of the real and of the imaginary part of Y and of what was measured of x_n,
    m.
    rows : independent rows that would know the standard deviations as well as they are known.
    base : y_n, n = 2, 3 …, m, likewise, zero where they do not stand out of the noise; empty for a harmonic base.
    of_base : how many times the base motion was added to what was measured of the response, 1 for one measured against
    the base.
    folds : what harmonics beyond half the sampling rate may add; None where that is far below the errors.
    interval : between samples, s; that of the slowest channel.
    """

    omega: float
    Y: float
    Y_error: float
    n: Integers
    x: Complexes
    x_error: Array
    rows: int
    base: Complexes = field(default_factory=lambda: np.empty(0, dtype=np.complex128))
    of_base: float = 0.0
    folds: Folds | None = None
    interval: float = 1e-3  # of usual recorders

    @property
    def relative_error(self) -> float:
        """Relative standard deviation of Y/x_1: the measured response has an independent error, and the base
        that was added to it that of the base."""
        of_base = self.Y_error * abs(1.0 / self.Y - self.of_base / self.x[0])
        return math.hypot(self.x_error[0] / abs(self.x[0]), of_base)

    @property
    def clear(self) -> Mask:
        """Mask of the harmonics that stand out of the noise; the fundamental always does."""
        return (np.abs(self.x) > CERTAIN * self.x_error) | (self.n == 1)

    @property
    def error_freedom(self) -> int:
        """Degrees of freedom with which the standard deviations are known."""
        return _NEIGHBOURS * max(1, self.rows - 1)

    @classmethod
    def of(cls, steady: SteadyRecord) -> RecordHarmonics:
        """Return the harmonics of a record up to a little beyond its bandwidth."""
        # four odd harmonics beyond the bandwidth bound the waveform
        highest = min(steady.bandwidth + 8, len(steady.X_error) - 1)
        n = np.arange(1, highest + 1, 2)
        y = steady.mean(steady.Y[:, : steady.base_bandwidth + 1])
        base, higher = y[1], np.arange(2, y.size)
        clear = np.abs(y[higher]) > SIGNIFICANT * steady.Y_error[higher]
        x = steady.x_of(n)
        noise = steady.X_error[n]
        folds = _folds(steady, n)
        size = _size(folds, steady)
        return cls(
            omega=steady.omega,
            Y=float(abs(base)),
            Y_error=float(steady.Y_error[1]),
            n=n,
            x=x,
            # part of what folds that is not known: the sum over multiples ends
            x_error=np.hypot(noise, 0.005 * size),
            rows=_rows(steady, n),
            base=np.where(clear, y[higher] * np.exp(-1j * higher * np.angle(base)), 0.0),
            of_base=steady.added,
            # what folds and is less than a tenth of an error makes no difference
            folds=folds if (size > 0.1 * noise).any() else None,
            interval=max(channel.dt for channel in steady.channels.values()),
        )


def _rows(steady: SteadyRecord, n: Integers) -> int:
    """Return independent rows that know the variances of the harmonics as well as they are known (Welch–Satterthwaite):
    that of noise from the scatter of the rows, what this does not show, as an unsteady motion, to a factor."""
    rows = len(steady.weights)
    hidden = float(np.mean((steady.X_hidden[n] / steady.X_error[n]) ** 2))
    scatter = (1.0 - hidden) ** 2 / (_NEIGHBOURS * max(1, rows - 1))
    # six degrees of freedom of a variance that is computed and not seen: its root is known to 30 %
    return 1 + max(1, round(1.0 / (scatter + hidden**2 / 6.0) / _NEIGHBOURS))


def _folds(steady: SteadyRecord, n: Integers) -> Folds:
    """Return what the harmonics beyond half the sampling rate add to the mean of the harmonics n of a record.

    With M samples to the cycle, the harmonic p next to jM ± n looks like harmonic n, or its conjugate, turned by where
    in the cycle the samples lie and, from cycle to cycle, by the part of a turn εT by which p is not jM ± n; over the
    record sin(πf)/πf of it is left, f = ε cycles.
    """
    # multiples of the sampling rate, about which harmonics fold: beyond 16 lies a hundredth of what does
    j, sign = np.arange(1, 17)[:, None, None], np.array([1, -1])[:, None]
    base = steady.mean(steady.Y[:, 1:2])[0]
    middle = math.pi * steady.cycles + float(
        np.angle(base)
    )  # phase of the base in the middle of the record
    orders, adds = [], []
    for quantity, share in steady.shares.items():
        channel, order = steady.channels[quantity], ORDERS[quantity]
        correction = channel.correction or Correction()
        samples = 2.0 * math.pi / (steady.omega * channel.dt)
        near = j * samples + sign * n
        p = 2 * np.round((near - 1.0) / 2.0).astype(np.intp) + 1
        # of a sample from the peak of the base on
        first = steady.omega * (channel.first - steady.start) + float(np.angle(base))
        turned = np.exp(1j * (j * samples * first + (p - near) * middle))
        rate, own = 1j * steady.omega * p, 1j * steady.omega * n
        factor = turned * np.sinc((p - near) * steady.cycles)
        factor = factor * rate**order * correction.response(steady.omega * p)
        factor = np.where(sign > 0, factor, factor.conj())
        orders.append(p)
        adds.append(factor * share[n] / (own**order * correction.response(steady.omega * n)))
    return Folds(np.concatenate(orders), np.concatenate(adds), sign < 0)


def _size(folds: Folds, steady: SteadyRecord) -> Array:
    """Return the size of what folds, m, at its largest. Where the contact begins to slip the jerk jumps, so that the
    harmonics of the acceleration fall as n^{−2} in the end: as much as the highest ones read have it."""
    highest = np.arange(1, steady.X.shape[1], 2)[-3:]
    size = np.median(np.abs(steady.mean(steady.X)[highest]) * highest**4.0)
    return np.asarray(np.sum(np.abs(folds.factors) * (size / folds.orders**4.0), axis=(0, 1)))
