"""Where a periodic motion turns and crosses zero, from the harmonics of many means at once.

A symmetric motion, x(t + T/2) = −x(t), has odd harmonics alone: its lowest point is the mirror image of its highest.
Even harmonics have the period T/2, so that they shift both ends alike; each is then looked for by itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complexes

_POINTS = 1024  # of a cycle, where its peak is looked for
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
        squares: Array = np.abs(self.x) ** 2 - self.variance
        return squares

    def motion(self, theta: Array) -> tuple[Array, Array, Array]:
        """x, dx/dωt, d²x/dωt² at one phase for each mean, (r,)."""
        turn = np.empty(
            self.x.shape, dtype=np.complex128
        )  # e^{inθ}: products cost less than exponentials
        turn[:, :1], turn[:, 1:] = (
            np.exp(1j * np.outer(theta, self.n[:1])),
            np.exp(2j * theta)[:, None],
        )
        turn = np.multiply.accumulate(turn, axis=1) * self.x
        return turn.real.sum(axis=1), -(turn.imag @ self.n), -(turn.real @ self.n**2)


def turning_points(odd: Series, even: Series) -> tuple[Array, Array]:
    """(ωt, X) of r means, (r,): X is half the way from the lowest to the highest point, and ωt, with even harmonics,
    halfway between the phase of the highest and that of the lowest, half a cycle before."""
    if not even.n.size:
        return _peak([odd], 1.0)
    high, top = _peak([odd, even], 1.0)
    low, depth = _peak([odd, even], -1.0)
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


def _peak(parts: list[Series], sign: float) -> tuple[Array, Array]:
    """(ωt, x) at the largest value of sign·x, (r,): by Newton's method on the velocity, from the largest of 1,024
    points."""
    series = np.zeros(_POINTS // 2 + 1, dtype=np.complex128)
    for part in parts:
        series[part.n.astype(np.intp)] = sign * part.x.mean(axis=0)
    count = len(parts[0].x)
    at = np.full(count, 2.0 * math.pi / _POINTS * int(np.argmax(np.fft.irfft(series))))
    limit = 2.0 * math.pi / _POINTS

    def motion(at: Array) -> Array:
        moved: Array = sign * np.sum([part.motion(at) for part in parts], axis=0)
        return moved

    for _ in range(4):
        _, rate, bend = motion(at)
        step = np.where(bend < 0.0, -rate / np.where(bend < 0.0, bend, -1.0), 0.0)
        at = at + np.clip(step, -limit, limit)
        if np.all(np.abs(step) < _REACHED):
            break
    return at, motion(at)[0]
