"""The damping of one cycle of the motion in the measures that engineers compare: loss factor, equivalent damping."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple


class Column(NamedTuple):
    """A column of the table of what is measured of each level.

    symbol, unit : in its head.   error : the key of the standard error; none of a number without one.
    """

    symbol: str
    unit: str = ""
    error: str = ""


class Level(NamedTuple):
    """A cycle of the motion, measured, and what a test engineer compares its damping by.

    Loss factor, quality factor and equivalent viscous damping are those of a level: friction takes less of a large
    motion than of a small one. Use them to compare with other rigs, or in a linear model at about that amplitude; F_k
    and c hold at all of them.

    name : of the record, or of the decay and the time.   X : amplitude, m.   omega : ω, rad/s; NaN without times.   W :
    energy that the cycle loses, J.   friction : the part of it that friction takes, J.   more : what else is measured,
    or otherwise, by the keys of the document.
    """

    name: str
    X: float
    omega: float
    W: float
    friction: float
    more: Mapping[str, Any] = {}

    @property
    def equivalent_damping(self) -> float:
        """The viscous damper that takes as much energy of a harmonic motion, c_eq = W/(πωX²), N s/m.

        Jacobsen, Trans. ASME 52 (1930): friction F_k alone, W = 4 F_k X, has c_eq = 4F_k/(πωX).
        """
        return self.W / (math.pi * self.omega * self.X**2)

    def loss_factor(self, k: float) -> float:
        """Return the energy lost in a cycle over 2π times the largest energy in the spring, η = W/(πkX²) = c_eq ω/k; Q
        = 1/η.

        Nashif, Jones & Henderson, Vibration Damping (1985), Sec. 3. A viscous damper at the natural frequency has
        η = 2ζ.   k : of the spring, N/m; what the contact stores is not counted.
        """
        return self.W / (math.pi * k * self.X**2)

    def document(self, k: float, m: float) -> dict[str, Any]:
        """Return all measures for the document.   m : kg; NaN where it is not known, and the damping ratio with it."""
        eta = self.loss_factor(k)
        return {
            "level": self.name,
            "X_m": self.X,
            "frequency_Hz": self.omega / (2.0 * math.pi),
            "W_J": self.W,
            "friction_share": self.friction / self.W if self.W else math.nan,
            "equivalent_damping_N_s_per_m": self.equivalent_damping,
            "equivalent_damping_ratio": damping_ratio(self.equivalent_damping, k, m),
            "loss_factor": eta,
            "Q": 1.0 / eta if eta else math.inf,
            **self.more,
        }


def damping_ratio(c: float, k: float, m: float) -> float:
    """Return the fraction of critical damping, ζ = c/(2√(km)): of the oscillator with its contact loose.

    Inman, Engineering Vibration, Sec. 1.3.   c : N s/m.   k : N/m.   m : kg.

    >>> damping_ratio(c=40.0, k=100.0, m=4.0)  # critical
    1.0
    """
    return c / (2.0 * math.sqrt(k * m))
