"""The oscillator and its excitation: Eqs. (1)–(3) of Liang & Feeny (2010), in SI units.

A mass m on a spring k and a damper c, excited through the spring by the base motion y = Y cos ωt, rubs against
a contact that is a spring K_z in series with a Coulomb slider F_k (a Jenkins element):

    slip    m ẍ + c ẋ + k x + F_k sgn ẋ = k Y cos ωt                                          (1)
    stick   m ẍ + c ẋ + k x + K_z z     = k Y cos ωt,   z = Z_m sgn ẋ(t_1⁻) + x − X_t         (2), (3)

z is the deflection of the contact spring, |z| ≤ Z_m = F_k/K_z; X_t is the displacement of the last reversal.

Symbols used throughout the package, with their units:

    m  kg         mass                           ω (omega)  rad/s  drive frequency
    c  N s/m      viscous damping                Y    m      amplitude of the base
    k  N/m        spring                         X    m      peak displacement of the mass
    K_z  N/m      contact stiffness              X_s  m      displacement at forward slip onset
    F_k  N        friction force in slip         V_s  m/s    velocity at forward slip onset
    Z_m  m        largest contact deflection     t_s  s      duration from the reversal at −X to slip onset
    φ (phi)  rad  lag of x behind y              a  m, b  m²/s, W  J   terms of the energy balance a F_k + b c = W

`UNITS` has them for programs; `named_with_unit` names columns of tables.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .arguments import NUMBERS, instance, number, numbers
from .arrays import Array

UNITS = {
    **{"m": "kg", "c": "N s/m", "k": "N/m", "K_z": "N/m", "F_k": "N", "Y": "m", "omega": "rad/s"},
    **{"X": "m", "X_s": "m", "V_s": "m/s", "t_s": "s", "phi": "rad", "phi_zero_crossing": "rad"},
    **{"a": "m", "b": "m²/s", "W": "J", "X_1": "m", "phi_1": "rad", "X_3": "m", "phi_3": "rad"},
    **{"X_5": "m", "phi_5": "rad", "t": "s", "x": "m", "v": "m/s", "acceleration": "m/s²"},
    **{"z": "m", "y": "m"},
}
"""The unit of each symbol: an oscillator and its excitation, the features of its orbits, and its motion in time."""

_EXPONENTS = str.maketrans("²³⁴⁵⁶⁷⁸⁹", "23456789", "^")


def named_with_unit(name: str, unit: str) -> str:
    """Return a name for a column or key: what it holds, then its unit, as in c_N_s_per_m; no unit, no ending."""
    name = name.replace("[", "_").replace("]", "").replace(" ", "_")
    ending = unit.replace(" ", "_").replace("/", "_per_").translate(_EXPONENTS)
    return f"{name}_{ending}" if ending else name


class NoOscillator(ValueError):
    """A value outside the bounds of an oscillator or of its base motion; the message names the field and its bounds."""


@dataclass(frozen=True, slots=True)
class Oscillator:
    """A mass on a spring and a viscous damper with a compliant friction contact, the system of Eqs. (1)–(3).

    `steady_orbit`, `steady_orbits` and `transient` compute its motion, `study` the errors of its identification. For a
    rigid contact choose a large finite K_z, 1000 k for example; F_k = 0 removes the contact, c = 0 the damper. To vary
    one number use `dataclasses.replace(oscillator, F_k=2.0)`.

    m : mass, kg, > 0.
    c : viscous damping coefficient, N s/m, ≥ 0.
    k : stiffness of the spring to the base, N/m, > 0.
    K_z : stiffness of the contact, N/m, > 0 and finite.
    F_k : friction force while the contact slips, N, ≥ 0.

    Raises NoOscillator, a ValueError, naming the field and its bounds.
    """

    m: float
    c: float
    k: float
    K_z: float
    F_k: float

    def __post_init__(self) -> None:
        _require_numbers(self)

    @property
    def omega_n(self) -> float:
        """Undamped natural frequency of the mass on the spring k, ω_n = √(k/m), rad/s."""
        return math.sqrt(self.k / self.m)

    @property
    def zeta(self) -> float:
        """Viscous damping ratio, ζ = c / (2 √(k m))."""
        return self.c / (2.0 * math.sqrt(self.k * self.m))

    @property
    def Z_m(self) -> float:
        """Largest deflection of the contact spring, Z_m = F_k / K_z, m."""
        return self.F_k / self.K_z


@dataclass(frozen=True, slots=True)
class BaseMotion:
    """The harmonic motion of the base that drives an oscillator through its spring, y(t) = Y cos ωt.

    A force of the amplitude F on the mass is the same drive, with Y = F/k.

    Y : amplitude, m, > 0.   omega : circular frequency ω = 2πf, rad/s, > 0; the paper gives f in Hz.

    Raises NoOscillator, a ValueError, naming the field and its bounds.
    """

    Y: float
    omega: float

    def __post_init__(self) -> None:
        _require_numbers(self)

    @property
    def period(self) -> float:
        """Period of the drive, T = 2π/ω, s."""
        return 2.0 * math.pi / self.omega

    def y(self, t: ArrayLike) -> Array:
        """Return the displacement of the base, m, at the times t, s (any shape)."""
        return self.Y * np.cos(self.omega * numbers("t", t))


class Parameters(NamedTuple):
    """An oscillator and its excitation as the plain numbers that compiled kernels take; already checked."""

    m: float
    c: float
    k: float
    K_z: float
    F_k: float
    Y: float
    omega: float


def parameters(oscillator: Oscillator, motion: BaseMotion | None) -> Parameters:
    """Return the numbers of an oscillator and its excitation, those of a base at rest, Y = 0, without one.

    Raises ValueError for objects of other classes.
    """
    o = instance("oscillator", oscillator, Oscillator)
    if motion is not None:
        instance("motion", motion, BaseMotion)
    Y, omega = (0.0, 0.0) if motion is None else (motion.Y, motion.omega)
    return Parameters(o.m, o.c, o.k, o.K_z, o.F_k, Y, omega)


def _require_numbers(model: Oscillator | BaseMotion) -> None:
    # __match_args__ names the fields, and `dataclasses.fields` costs more than the checks
    for field in model.__match_args__:
        try:
            value = number(f"{type(model).__name__}.{field}", getattr(model, field), NUMBERS[field])
        except ValueError as error:
            raise NoOscillator(str(error)) from None
        object.__setattr__(model, field, value)
