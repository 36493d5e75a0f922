"""Turning points and zero crossings of a periodic motion, from the harmonics of many means at once.

A symmetric motion, x(t + T/2) = −x(t), has odd harmonics alone: its lowest point is the mirror image of its highest.
Even harmonics have the period T/2, so that they shift both ends alike; each end is then located separately.

Where the mass rests at an end, the measured harmonics ring about its level and are noisy, and their maximum would lie
too far out: the level is then the mean over the middle half of the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complexes

_POINTS = 1024  # of a cycle, where its peak is looked for
_NEAR_END = 0.005  # of the range: so close to an end, and four times the noise, a mass counts as resting there
_NOISE = 4.0
_RESTING = 2.0  # times as long as a harmonic motion is as close to its end
_REACHED = 1e-9  # rad: the next of Newton's steps would be about its square


@dataclass(frozen=True, eq=False)
class Series:
    """The odd or the even harmonics of r means of a motion, x = Re Σ x_n e^{inωt}.

    n : orders, in steps of two, (h,).   x : m, (r, h).   variance : of each x_n as a complex number, m², (h,).
    """

    n: Array
    x: Complexes
    variance: Array

    @property
    def squares(self) -> Array:
        """|x_n|² freed of the bias of noise, m², (r, h): may fall below zero, cutting that off would be a bias."""
        return np.abs(self.x) ** 2 - self.variance

    def motion(self, theta: Array) -> tuple[Array, Array, Array]:
        """x, dx/dωt, d²x/dωt² at one phase for each mean, (r,)."""
        # e^{inθ}: products cost less than exponentials
        turn = np.empty(self.x.shape, dtype=np.complex128)
        turn[:, :1] = np.exp(1j * np.outer(theta, self.n[:1]))
        turn[:, 1:] = np.exp(2j * theta)[:, None]
        turn = np.multiply.accumulate(turn, axis=1) * self.x
        return turn.real.sum(axis=1), -(turn.imag @ self.n), -(turn.real @ self.n**2)

    def mean_between(self, begin: float, end: float) -> Array:
        """Mean of x from one phase ωt to the other, rad, for each mean, (r,)."""
        turned = (np.exp(1j * self.n * end) - np.exp(1j * self.n * begin)) / (1j * self.n)
        return (self.x @ turned).real / (end - begin)


def turning_points(odd: Series, even: Series, *, rests: bool) -> tuple[Array, Array]:
    """(ωt, X) of r means, (r,): X is half the way from the lowest to the highest point, and ωt, with even harmonics,
    halfway between the phase of the highest and that of the lowest, half a cycle before.

    rests : whether the mass may rest at its ends, and the harmonics are as they were measured.
    """
    if not even.n.size:
        return _end([odd], 1.0, rests)
    high, top = _end([odd, even], 1.0, rests)
    low, depth = _end([odd, even], -1.0, rests)
    asymmetry = (low - high) % (2.0 * math.pi) - math.pi  # of the times from one to the other
    return high + 0.5 * asymmetry, 0.5 * (top + depth)


def upward_zero(odd: Series, lag: Array) -> Array:
    """ωt of the upward zero of the symmetric part, (r,).   lag : of the fundamental, rad, (r,)."""
    at = lag - 0.5 * math.pi
    for _ in range(5):
        value, rate, _ = odd.motion(at)
        step = value / np.where(rate > 0.0, rate, np.inf)
        at = at - np.clip(step, -0.5, 0.5)
        if np.all(np.abs(step) < _REACHED):
            break
    return at


def _end(parts: list[Series], sign: float, rests: bool) -> tuple[Array, Array]:
    """(ωt, x) at the largest value of sign·x, (r,): by Newton's method on the velocity, from the largest of 1,024
    points; where the mass rests there, the middle of the rest and its level."""
    spectrum = np.zeros(_POINTS // 2 + 1, dtype=np.complex128)
    for part in parts:
        spectrum[part.n.astype(np.intp)] = sign * part.x.mean(axis=0)
    values = np.fft.irfft(spectrum) * (0.5 * _POINTS)
    highest = int(np.argmax(values))
    noise = math.sqrt(0.5 * math.fsum(float(part.variance.sum()) for part in parts))
    rest = _rest(values, highest, noise) if rests else None
    if rest is not None:
        begin, end = (2.0 * math.pi / _POINTS * place for place in rest)
        middle = np.full(len(parts[0].x), 0.5 * (begin + end))
        return middle, sign * np.sum([part.mean_between(begin, end) for part in parts], axis=0)

    def motion(at: Array) -> Array:
        return sign * np.sum([part.motion(at) for part in parts], axis=0)

    limit = 2.0 * math.pi / _POINTS
    at = np.full(len(parts[0].x), limit * highest)
    for _ in range(4):
        _, rate, bend = motion(at)
        step = -rate / np.where(bend < 0.0, bend, -np.inf)
        at = at + np.clip(step, -limit, limit)
        if np.all(np.abs(step) < _REACHED):
            break
    return at, motion(at)[0]


def _rest(values: Array, highest: int, noise: float) -> tuple[float, float] | None:
    """Begin and end of the middle half of the rest about the highest point, in points; None where there is no rest.

    noise : standard deviation of the values.
    """
    reach = float(np.ptp(values))
    near = min(_NEAR_END * reach + _NOISE * noise, 0.5 * reach)
    off = np.roll(values, -highest) < values[highest] - near
    after, before = int(np.argmax(off)), int(np.argmax(off[::-1]))
    harmonic = math.acos(1.0 - 2.0 * near / reach) / math.pi * values.size
    if after + before < _RESTING * harmonic:
        return None
    middle, quarter = highest + 0.5 * (after - before), 0.25 * (after + before)
    return middle - quarter, middle + quarter
