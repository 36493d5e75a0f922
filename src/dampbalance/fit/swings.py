"""The swings of a burst in the band of the mode: where its fit begins, and with which oscillator."""

from __future__ import annotations

import itertools
import math

import numpy as np

from ..arrays import Array
from ..signals.band import Band
from ..signals.bursts import Burst, Signal
from ..signals.log_decrement import displacement_in

_WINDOW = 0.6  # of a cycle before the turn of a burst: its first swing
SLOWER = 0.6  # of the period in the spectrum: that of the swings is no other than this either way
_SHORTEST = 3.0  # samples of a period, of which a band can be cut
_FEWEST_SWINGS = 4  # that give the period better than the spectrum
# of one swing to the next; lost of the first where there is no second
_LEAST_RATIO, _LOST_UNKNOWN = 0.3, 0.2
_SMALL_SWING = 0.08  # of the largest swing: below it sticking bends the line


class Swings:
    """The swings of a burst in the band of the mode.

    zeros : times at which the displacement passes its mean, s.   speeds : there, m/s.   sizes : of the swings between
    its turns, m.   swing : of the burst, m.   period : s.
    """

    def __init__(self, lead: Signal, burst: Burst, pendulum: bool = False) -> None:
        """Read the swings of a channel, the period first from the spectrum and then from the zeros.   pendulum :
        whether the restoring torque is k sin x."""
        part = lead.between(burst.earliest, burst.end)
        self.swing, self.period = burst.swing, burst.period
        for _ in range(2):
            band = Band.about(1.0 / max(self.period, _SHORTEST * part.dt), part.dt)
            x = displacement_in(part, band)
            at = np.flatnonzero(x[:-1] * x[1:] <= 0.0)
            share = x[at] / np.where(x[at] == x[at + 1], 1.0, x[at] - x[at + 1])
            zeros = part.t[at] + share * part.dt
            turns = np.array([np.abs(x[i + 1 : j + 1]).max() for i, j in itertools.pairwise(at)])
            clear = turns > _SMALL_SWING * turns.max(initial=0.0)
            clear = np.flatnonzero(clear & (zeros[:-1] >= burst.turn - _WINDOW * burst.period))
            if clear.size >= _FEWEST_SWINGS:
                period = 2.0 * float(np.median(np.diff(zeros)[clear]))
                self.period = float(np.clip(period, SLOWER * burst.period, burst.period / SLOWER))
        inside = slice(clear[0], clear[-1] + 2) if clear.size else slice(0)
        tops = turns[clear[0] : clear[-1] + 1] if clear.size else turns[:0]
        self.zeros, self.sizes = zeros[inside], tops[:-1] + tops[1:]
        signs = np.sign(x[at + 1] - x[at])[inside]
        if pendulum:  # by its energy
            tops = 2.0 * np.sin(0.5 * np.minimum(tops, math.pi))
        self.speeds = signs * np.append(tops, tops[-1:]) * 2.0 * math.pi / self.period

    def start_at(self, t: float) -> Array:
        """Return the state x, ẋ, w at the zero next to a time."""
        v = float(self.speeds[int(np.argmin(np.abs(self.zeros - t)))])
        return np.array([0.0, v, 1.0 + math.copysign(1.0, v)])

    def oscillator(self, k: float) -> tuple[float, float, float]:
        """Return F_k, c and m by the line through the pairs of swings; friction and damping in halves where that
        bends."""
        D = self.sizes if self.sizes.size > 1 else self.swing * np.array([1.0, 1.0 - _LOST_UNKNOWN])
        ratio, lost = np.polyfit(D[:-1], D[1:], 1) if D.size > 2 else (1.0, 0.0)
        if not (_LEAST_RATIO < ratio < 1.0 and lost < 0.0):
            fall = max(1.0 - float(D[-1] / D[0]) ** (1.0 / (D.size - 1)), 1e-3)
            ratio, lost = max(1.0 - 0.5 * fall, _LEAST_RATIO), -0.5 * fall * float(D.mean())
        beta = -math.log(ratio) / math.pi
        zeta = beta / math.hypot(1.0, beta)
        m = k * (self.period / (2.0 * math.pi)) ** 2 * (1.0 - zeta**2)
        return -k * float(lost) / (2.0 * (1.0 + ratio)), 2.0 * zeta * math.sqrt(k * m), m
