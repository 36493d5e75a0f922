"""What a channel does to a signal on its way into the file, as far as it is known, and its inverse.

A channel with gain G, delay d and filters turns a harmonic e^{iωt} into H(iω) e^{iωt},

    H(s) = G e^{−sd} ∏ −p/(s − p) ∏ s/(s − q)

with the poles p of its low-pass filter and q of its high-pass filter. A Butterworth filter of order n has its poles on
the circle of its corner, 2πf e^{iπ(2j + n + 1)/(2n)}, j = 0 … n − 1. Harmonics divided by H are those of the signal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Complexes


@dataclass(frozen=True, slots=True)
class Correction:
    """Gain, delay (s) and poles (rad/s, each with its conjugate) of the filters of a channel."""

    gain: float = 1.0
    delay: float = 0.0
    low_pass: tuple[complex, ...] = ()
    high_pass: tuple[complex, ...] = ()

    def response(self, omega: ArrayLike) -> Complexes:
        """H(iω) at any ω, rad/s; where a high-pass filter lets nothing through (ω = 0), without it."""
        s = 1j * np.asarray(omega, dtype=np.float64)
        response: Complexes = self.gain * np.exp(-s * self.delay)
        for p in self.low_pass:
            response = response * (-p / (s - p))
        for q in self.high_pass:
            response = response * np.where(s == 0.0, 1.0, s / (s - q))
        return response
