"""What a test engineer compares damping by: damping ratio, loss factor, quality factor and equivalent viscous damping.

The first is a property of the oscillator. The others are those of a level: friction takes less of a large motion than
of a small one, so each of them belongs to the amplitude at which it was measured. Use them to compare with other rigs,
or in a linear model at about that amplitude; F_k and c hold at all of them.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple


class Level(NamedTuple):
    """A cycle of the motion, measured.

    name : of the record, or of the decay and the time.   X : amplitude, m.   omega : ω, rad/s.   W : energy that the
    cycle loses, J.   friction : the part of it that friction takes, J.
    """

    name: str
    X: float
    omega: float
    W: float
    friction: float


def damping_ratio(c: float, k: float, m: float) -> float:
    """Fraction of critical damping, ζ = c/(2√(km)): of the oscillator with its contact loose.

    Inman, Engineering Vibration, Sec. 1.3.   c : N s/m.   k : N/m.   m : kg.

    >>> damping_ratio(c=40.0, k=100.0, m=4.0)  # critical
    1.0
    """
    return c / (2.0 * math.sqrt(k * m))


def equivalent_damping(W: float, omega: float, X: float) -> float:
    """The viscous damper that takes as much energy of a harmonic motion, c_eq = W/(πωX²), N s/m.

    Jacobsen, Trans. ASME 52 (1930): friction F_k alone, W = 4 F_k X, has c_eq = 4F_k/(πωX).

    W : energy lost in a cycle, J.   omega : rad/s.   X : amplitude, m.
    """
    return W / (math.pi * omega * X**2)


def loss_factor(W: float, k: float, X: float) -> float:
    """Energy lost in a cycle over 2π times the largest energy in the spring, η = W/(πkX²) = c_eq ω/k; Q = 1/η.

    Nashif, Jones & Henderson, Vibration Damping (1985), Sec. 3. A viscous damper at the natural frequency has η = 2ζ.

    W : J.   k : of the spring, N/m; what the contact stores is not counted.   X : amplitude, m.
    """
    return W / (math.pi * k * X**2)


def of_level(level: Level, k: float, m: float) -> dict[str, Any]:
    """The measures of a level for the document.   m : kg; NaN where it is not known, and the damping ratio with it."""
    c = equivalent_damping(level.W, level.omega, level.X)
    eta = loss_factor(level.W, k, level.X)
    return {
        "level": level.name,
        "X_m": level.X,
        "frequency_Hz": level.omega / (2.0 * math.pi),
        "W_J": level.W,
        "friction_share": level.friction / level.W if level.W else math.nan,
        "equivalent_damping_N_s_per_m": c,
        "equivalent_damping_ratio": damping_ratio(c, k, m),
        "loss_factor": eta,
        "Q": 1.0 / eta if eta else math.inf,
    }
