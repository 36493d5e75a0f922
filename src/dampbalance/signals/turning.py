"""Turning points and zero crossings of a periodic motion, from the harmonics of many means at once.

A symmetric motion, x(t + T/2) = −x(t), has only odd harmonics, and its lowest point mirrors its highest. Even harmonics
have the period T/2 and shift both ends in the same direction; each end is then located separately.

If the mass rests at an end, the measured harmonics ring about its level and are noisy, so that their maximum would be
too large: the level is then the mean over the middle half of the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complexes

# Points of the search for a peak: five for each of the highest harmonics, 91 and less.
_POINTS_OF_CYCLE = 1024


@dataclass(frozen=True, eq=False)
class Series:
    """Harmonics of r means of a motion, x = Re Σ x_n e^{inωt}.

    n : orders, the odd ones first, (h,).   x : m, (r, h).   variance : of each x_n as a complex number, m², (r, h).
    """

    n: Array
    x: Complexes
    variance: Array

    @property
    def squares(self) -> Array:
        """|x_n|² without the noise bias, m², (r, h); negative values are kept, since clipping them would be a bias."""
        return np.abs(self.x) ** 2 - self.variance

    def mean_between(self, begin: float, end: float) -> Array:
        """Return the mean of x between two phases ωt, rad, (r,)."""
        turned = (np.exp(1j * self.n * end) - np.exp(1j * self.n * begin)) / (1j * self.n)
        return (self.x @ turned).real / (end - begin)


def turning_points(series: Series, *, rests: bool) -> tuple[Array, Array]:
    """Return (ωt, X) of r means, (r,): X is half the distance between the lowest and the highest point; ωt is the phase
    of the highest or, with even harmonics, the middle between it and that of the lowest, half a cycle earlier.

    rests : whether the mass may rest at its ends, because the harmonics are the measured ones.
    """
    high, top = _end(series, 1.0, rests)
    if np.all(series.n % 2.0):
        return high, top
    low, depth = _end(series, -1.0, rests)
    asymmetry = (low - high) % (2.0 * math.pi) - math.pi  # one way takes longer than the other
    return high + 0.5 * asymmetry, 0.5 * (top + depth)


def upward_zero(series: Series, lag: Array) -> Array:
    """Return ωt of the upward zero of the symmetric part, (r,).   lag : of the fundamental, rad, (r,)."""
    odd = series.n % 2.0 > 0.0
    # 0.5 rad: the longest step towards a zero
    return _zero(series.n[odd], series.x[:, odd], lag - 0.5 * math.pi, 0.5)


def _zero(n: Array, x: Complexes, at: Array, reach: float) -> Array:
    """Return the upward zero of Re Σ x_n e^{inθ} near θ = at, (r,), by Halley's method.   reach : of a step, rad."""
    # three or four steps suffice, unless a contact is so stiff that the motion nearly stops
    for _ in range(8):
        turned = x * np.exp(1j * np.outer(at, n))
        value, rate, bent = turned.real.sum(axis=1), -turned.imag @ n, -turned.real @ n**2
        rate = np.where(rate > 0.0, rate, np.inf)
        step = value / rate
        step = step / np.maximum(1.0 - 0.5 * step * bent / rate, 0.5)
        at = at - np.clip(step, -reach, reach)
        # the next step of Halley's method would be about a hundred times the cube of this one
        if np.all(np.abs(step) < 1e-6):
            break
    return at


def _end(series: Series, sign: float, rests: bool) -> tuple[Array, Array]:
    """Return (ωt, x) at the largest value of sign·x, (r,): the zero of the velocity near the largest of 1,024 points,
    or the middle and the level of a rest."""
    variances = np.broadcast_to(series.variance, series.x.shape).sum(axis=1)
    known = variances <= variances.min()  # the mean itself, if there are replicates
    spectrum = np.zeros(_POINTS_OF_CYCLE // 2 + 1, dtype=np.complex128)
    spectrum[series.n.astype(np.intp)] = sign * series.x[known].mean(axis=0)
    values = np.fft.irfft(spectrum) * (0.5 * _POINTS_OF_CYCLE)
    highest, noise = int(np.argmax(values)), math.sqrt(0.5 * float(variances.min()))
    rest = _rest(values, highest, noise) if rests else None
    if rest is not None:
        begin, end = (2.0 * math.pi / _POINTS_OF_CYCLE * place for place in rest)
        return np.full(len(series.x), 0.5 * (begin + end)), sign * series.mean_between(begin, end)
    limit = 2.0 * math.pi / _POINTS_OF_CYCLE
    slowing = -1j * sign * series.n * series.x  # −dx/dωt, which rises through zero there
    at = _zero(series.n, slowing, np.full(len(series.x), limit * highest), limit)
    return at, sign * (series.x * np.exp(1j * np.outer(at, series.n))).real.sum(axis=1)


def _rest(values: Array, highest: int, noise: float) -> tuple[float, float] | None:
    """Return begin and end of the middle half of the rest about the highest point, in points; None if there is no rest.

    noise : standard deviation of the values.
    """
    reach = float(np.ptp(values))
    # a mass this close to an end counts as resting; one sample in 16,000 deviates by four standard deviations
    near = min(0.005 * reach + 4.0 * noise, 0.5 * reach)
    off = np.roll(values, -highest) < values[highest] - near
    after, before = int(np.argmax(off)), int(np.argmax(off[::-1]))
    harmonic = math.acos(1.0 - 2.0 * near / reach) / math.pi * values.size
    # a rest lasts at least twice as long as a harmonic motion is this close to its end
    if after + before < 2.0 * harmonic:
        return None
    middle, quarter = highest + 0.5 * (after - before), 0.25 * (after + before)
    return middle - quarter, middle + quarter
