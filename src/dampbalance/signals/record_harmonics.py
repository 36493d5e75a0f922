"""The harmonics of a record to which the oscillator is fitted, with their errors.

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
    """Aliases: what harmonics x_p beyond half the sampling rate add to the x_n of a record without an anti-alias
    filter.

    orders : p, (…, 2, h), for each multiple of the rate and either sign of n.   factors : of x_p or its conjugate.
    mirrored : mask of the conjugates.
    """

    orders: Integers
    factors: Complexes
    mirrored: Mask

    def of(self, x: Complexes) -> Complexes:
        """Return the aliases in each x_n, m, (h,).   x : x_p, m."""
        return np.asarray(np.sum(self.factors * np.where(self.mirrored, x.conj(), x), axis=(0, 1)))


@dataclass(frozen=True, eq=False)
class RecordHarmonics:
    """Harmonics of one record.

    omega : rad/s.   Y : amplitude of the base, m.   n : odd orders, (h,).   x : x_n, m, (h,).
    Y_error, x_error : standard deviations of the real and of the imaginary part of Y and of the measured x_n, m.
    rows : number of independent rows that determine the standard deviations equally well.
    base : y_n, n = 2, 3 …, m, zero if not significant; empty for a harmonic base.
    of_base : multiple of the base motion that was added to the measured response; 1 if measured against the base.
    folds : aliases; None if they are far below the errors.
    interval : between samples of the slowest channel, s.
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
        """Relative standard deviation of Y/x_1, from independent errors of the base and of the measured response."""
        of_base = self.Y_error * abs(1.0 / self.Y - self.of_base / self.x[0])
        return math.hypot(self.x_error[0] / abs(self.x[0]), of_base)

    @property
    def clear(self) -> Mask:
        """Mask of the significant harmonics; the fundamental always is."""
        return (np.abs(self.x) > CERTAIN * self.x_error) | (self.n == 1)

    @property
    def error_freedom(self) -> int:
        """Degrees of freedom of the standard deviations."""
        return _NEIGHBOURS * max(1, self.rows - 1)

    @classmethod
    def of(cls, steady: SteadyRecord) -> RecordHarmonics:
        """Return the harmonics of a record up to four odd ones beyond its bandwidth."""
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
            # 0.5 % of the aliases are unknown, since the sum over multiples is truncated
            x_error=np.hypot(noise, 0.005 * size),
            rows=_rows(steady, n),
            base=np.where(clear, y[higher] * np.exp(-1j * higher * np.angle(base)), 0.0),
            of_base=steady.added,
            # aliases below a tenth of an error make no difference
            folds=folds if (size > 0.1 * noise).any() else None,
            interval=max(channel.dt for channel in steady.channels.values()),
        )


def _rows(steady: SteadyRecord, n: Integers) -> int:
    """Return the number of independent rows that determine the variances of the harmonics equally well
    (Welch–Satterthwaite): noise is known from the scatter of the rows, hidden errors only roughly."""
    rows = len(steady.weights)
    hidden = float(np.mean((steady.X_hidden[n] / steady.X_error[n]) ** 2))
    scatter = (1.0 - hidden) ** 2 / (_NEIGHBOURS * max(1, rows - 1))
    # a hidden variance has six degrees of freedom: its root is known to 30 %
    return 1 + max(1, round(1.0 / (scatter + hidden**2 / 6.0) / _NEIGHBOURS))


def _folds(steady: SteadyRecord, n: Integers) -> Folds:
    """Return the aliases in the mean of the harmonics n of a record.

    With M samples per cycle, the harmonic p nearest to jM ± n appears as harmonic n or its conjugate. Its phase depends
    on where in the cycle the samples lie and advances from cycle to cycle by ε = p − (jM ± n) turns, so that a share
    sin(πf)/πf with f = ε · cycles remains in the mean over the record.
    """
    # aliases about the multiples of the sampling rate beyond 16 make a hundredth of all
    j, sign = np.arange(1, 17)[:, None, None], np.array([1, -1])[:, None]
    base = steady.mean(steady.Y[:, 1:2])[0]
    of_base = float(np.angle(base))
    middle = math.pi * steady.cycles + of_base  # phase of the base in the middle of the record
    orders, adds = [], []
    for quantity, share in steady.shares.items():
        channel, order = steady.channels[quantity], ORDERS[quantity]
        correction = channel.correction or Correction()
        samples = 2.0 * math.pi / (steady.omega * channel.dt)
        near = j * samples + sign * n
        p = 2 * np.round((near - 1.0) / 2.0).astype(np.intp) + 1
        # phase of a sample, counted from the peak of the base
        first = steady.omega * (channel.first - steady.start) + of_base
        turned = np.exp(1j * (j * samples * first + (p - near) * middle))
        rate, own = 1j * steady.omega * p, 1j * steady.omega * n
        factor = turned * np.sinc((p - near) * steady.cycles)
        factor = factor * rate**order * correction.response(steady.omega * p)
        factor = np.where(sign > 0, factor, factor.conj())
        orders.append(p)
        adds.append(factor * share[n] / (own**order * correction.response(steady.omega * n)))
    return Folds(np.concatenate(orders), np.concatenate(adds), sign < 0)


def _size(folds: Folds, steady: SteadyRecord) -> Array:
    """Return the largest size of the aliases, m. At the onset of slip the jerk jumps, so that x_n falls as n^{−4}; the
    highest harmonics read give its size."""
    highest = np.arange(1, steady.X.shape[1], 2)[-3:]
    size = np.median(np.abs(steady.mean(steady.X)[highest]) * highest**4.0)
    return np.asarray(np.sum(np.abs(folds.factors) * (size / folds.orders**4.0), axis=(0, 1)))
