"""The damping of one cycle in the measures by which engineers compare it: loss factor, equivalent damping."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple


class Column(NamedTuple):
    """A column of the table of measured quantities of each level.

    symbol, unit : of its head.   error : key of the standard error; empty for a number without one.
    """

    symbol: str
    unit: str = ""
    error: str = ""


class Level(NamedTuple):
    """The measured amplitude and energy loss of a cycle, and the damping that follows from them.

    Loss factor, quality factor and equivalent viscous damping depend on the amplitude, as friction dissipates a smaller
    share of the energy of a large motion. Use them to compare with other rigs, or in a linear model near that
    amplitude; F_k and c are valid at all amplitudes.

    name : of the record, or of the decay and the time.
    X : amplitude, m.
    omega : ω, rad/s; NaN without times.
    W : energy lost in the cycle, J.
    friction : the part of it that friction dissipates, J.
    more : further measured quantities, by the keys of the document; they replace those computed here.
    """

    name: str
    X: float
    omega: float
    W: float
    friction: float
    more: Mapping[str, Any] = {}

    @property
    def equivalent_damping(self) -> float:
        """The viscous damping that dissipates the same energy in a harmonic motion, c_eq = W/(πωX²), N s/m.

        Jacobsen, Trans. ASME 52 (1930): friction F_k alone, W = 4 F_k X, has c_eq = 4F_k/(πωX).
        """
        return self.W / (math.pi * self.omega * self.X**2)

    def loss_factor(self, k: float) -> float:
        """Return the loss factor, the energy lost in a cycle over 2π times the peak energy of the spring.

        η = W/(πkX²) = c_eq ω/k = 1/Q; Nashif, Jones & Henderson, Vibration Damping (1985), Sec. 3. A viscous damper at
        the natural frequency has η = 2ζ.

        k : stiffness of the spring, N/m; the energy stored in the contact is not counted.
        """
        return self.W / (math.pi * k * self.X**2)

    def document(self, k: float, m: float) -> dict[str, Any]:
        """Return all quantities by the keys of the document.   m : kg; if it is NaN, so is the damping ratio."""
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
    """Return the fraction of critical damping, ζ = c/(2√(km)), of the oscillator with the contact loose.

    Inman, Engineering Vibration, Sec. 1.3.   c : N s/m.   k : N/m.   m : kg.

    >>> damping_ratio(c=40.0, k=100.0, m=4.0)  # critical
    1.0
    """
    return c / (2.0 * math.sqrt(k * m))
