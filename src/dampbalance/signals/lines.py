"""The harmonics of a record that a fit of the oscillator takes, with their errors.

Phases count from the peak of the base: y = Y cos ωt, x = Re Σ x_n e^{inωt}, n odd.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, Complexes, Integers, Mask
from ..records.measurement import ORDERS, RESPONSES
from .bursts import LEAST_NOISE
from .conditioning import CLEAR_HARMONIC, SteadyRecord
from .thresholds import SIGNIFICANT

# Degrees of freedom that a row adds to an error, which is smoothed over five harmonics.
_NEIGHBOURS = 6

# Degrees of freedom of a variance that is computed and not seen: its root is known to 30 %.
_HIDDEN = 6.0
_EXTRA = 4  # odd harmonics beyond the bandwidth that are taken: they bound the waveform


@dataclass(frozen=True, eq=False)
class Lines:
    """Harmonics of one record.

    omega : rad/s.   Y : amplitude of the base, m.   n : odd orders, (h,).   x : x_n, m, (h,).
    Y_error, x_error : standard deviations of the real and of the imaginary part of Y and of what was measured of x_n,
    m.
    rows : independent rows that would know the standard deviations as well as they are known.   aliased : what
    harmonics beyond half the sampling rate add, as a part of the noise, at its largest; it is counted in x_error.
    base : y_n, n = 2, 3 …, m, likewise, zero where they do not stand out of the noise; empty for a harmonic base.
    of_base : how many times the base motion was added to what was measured of the response, 1 for one measured against
    the base.
    """

    omega: float
    Y: float
    Y_error: float
    n: Integers
    x: Complexes
    x_error: Array
    rows: int
    aliased: float = 0.0
    base: Complexes = field(default_factory=lambda: np.empty(0, dtype=np.complex128))
    of_base: float = 0.0

    @property
    def relative_error(self) -> float:
        """Relative standard deviation of Y/x_1: the measured response has an independent error, and the base
        that was added to it that of the base."""
        of_base = self.Y_error * abs(1.0 / self.Y - self.of_base / self.x[0])
        return math.hypot(self.x_error[0] / abs(self.x[0]), of_base)

    @property
    def clear(self) -> Mask:
        """Mask of the harmonics that stand out of the noise; the fundamental always does."""
        return (np.abs(self.x) > CLEAR_HARMONIC * self.x_error) | (self.n == 1)

    @property
    def error_freedom(self) -> int:
        """Degrees of freedom with which the standard deviations are known."""
        return _NEIGHBOURS * max(1, self.rows - 1)

    @classmethod
    def of(cls, steady: SteadyRecord) -> Lines:
        """Return the harmonics of a record up to a little beyond its bandwidth."""
        highest = min(steady.bandwidth + 2 * _EXTRA, len(steady.X_error) - 1)
        n = np.arange(1, highest + 1, 2)
        y = steady.mean(steady.Y[:, : steady.base_bandwidth + 1])
        base, higher = y[1], np.arange(2, y.size)
        clear = np.abs(y[higher]) > SIGNIFICANT * steady.Y_error[higher]
        x = steady.x_of(n)
        noise = steady.X_error[n]
        aliased = _aliased(steady, n)
        return cls(
            omega=steady.omega,
            Y=float(abs(base)),
            Y_error=float(steady.Y_error[1]),
            n=n,
            x=x,
            x_error=np.hypot(noise, aliased),
            rows=_rows(steady, n),
            aliased=float(np.max(aliased / np.maximum(noise, LEAST_NOISE * abs(x[0])))),
            base=np.where(clear, y[higher] * np.exp(-1j * higher * np.angle(base)), 0.0),
            of_base=steady.added,
        )


def _rows(steady: SteadyRecord, n: Integers) -> int:
    """Return independent rows that know the variances of the harmonics as well as they are known (Welch–Satterthwaite):
    that of noise from the scatter of the rows, what this does not show, as an unsteady motion, to a factor."""
    rows = len(steady.weights)
    hidden = float(np.mean((steady.X_hidden[n] / steady.X_error[n]) ** 2))
    scatter = (1.0 - hidden) ** 2 / (_NEIGHBOURS * max(1, rows - 1))
    return 1 + max(1, round(1.0 / (scatter + hidden**2 / _HIDDEN) / _NEIGHBOURS))


def _aliased(steady: SteadyRecord, n: Integers) -> Array:
    """Return the size of what harmonics beyond half the sampling rate add to the mean of the harmonics n, m.

    With M samples to the cycle, harmonic M ∓ n looks like harmonic n, turned from cycle to cycle by the part of a turn
    by which M is no whole number; over the record that leaves |sin πf/πf| of it, f = cycles · (M − round M). Where the
    contact begins to slip the jerk jumps, so that the harmonics of the acceleration fall as n^{−2} in the end; their
    size is that of the highest ones read.
    """
    total = np.zeros(n.size)
    for quantity in RESPONSES.keys() & steady.channels.keys():
        channel, order = steady.channels[quantity], ORDERS[quantity]
        samples = 2.0 * math.pi / (steady.omega * channel.dt)
        left = abs(float(np.sinc(steady.cycles * (samples - round(samples)))))
        highest = np.arange(1, channel.coefficients.shape[1], 2)[-3:]
        size = np.median(np.abs(steady.mean(steady.X)[highest]) * highest**order)
        fallen = size * (float(highest[-1]) / (samples - n)) ** (4 - order)
        total = np.maximum(total, math.sqrt(0.5) * left * fallen / n.astype(np.float64) ** order)
    return total
