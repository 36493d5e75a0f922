"""The point where the likelihood of records is largest, with its errors and intervals: the result of every fit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import special

from ..arrays import Array
from .parameters import Parameters


@dataclass(frozen=True, eq=False)
class Fit:
    """The model of largest likelihood, and the problem that it solves.

    parameters : with the values of the fit.   covariance : of all of them, in their order, (p, p); zero where one was
    given.   chi_square : sum of the squares of the residuals (model − data)/σ, χ².   freedom : its degrees of freedom.
    problem : whose residuals these are, see `fit.multistart`.   minima : others that are nearly as likely.
    evaluations : of the problem during the search.   promise : gain in −log L of another step of the climb, if the
    residuals were linear.
    """

    parameters: Parameters
    covariance: Array
    chi_square: float
    freedom: float
    problem: Any
    minima: tuple[Fit, ...] = ()
    evaluations: int = 0
    promise: float = 0.0

    @property
    def point(self) -> Array:
        """The values of all parameters, (p,)."""
        return self.parameters.values

    def value(self, key: str) -> float:
        """Return a parameter, in its unit."""
        return self.parameters[key].value

    def error(self, key: str) -> float:
        """Return the standard error of a parameter, in its unit; 0 where it was given."""
        return math.sqrt(self.covariance_of(key)[0, 0])

    def covariance_of(self, *keys: str) -> Array:
        """Return the covariance of some parameters, in their units."""
        at = [self.parameters.places[key] for key in keys]
        return self.covariance[np.ix_(at, at)]

    def freedom_of(self, key: str) -> float:
        """Return the degrees of freedom of the error of a parameter."""
        return self.freedom

    def reach(self, key: str) -> float:
        """Return half the width of the 95 % interval of a parameter, in its unit: its standard error times Student's
        t."""
        return float(special.stdtrit(max(self.freedom_of(key), 1.0), 0.975)) * self.error(key)

    def interval(self, key: str) -> tuple[float, float]:
        """Return the 95 % interval of a parameter, in its unit."""
        value, reach = self.value(key), self.reach(key)
        return value - reach, value + reach

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom; 1 where the residual is noise."""
        return self.chi_square / max(self.freedom, 1.0)


class OscillatorFit(Fit):
    """A fit of one oscillator to records, steady or free: its problem has the stiffness k of the spring, N/m, and its
    parameters are F_k, c, rho and m among others, ρ = K_z^{−1/2}."""

    @property
    def k(self) -> float:
        """Stiffness of the spring, N/m, given."""
        return float(self.problem.k)

    @property
    def rigid(self) -> bool:
        """Whether ρ is at its lower limit, which stands for a rigid contact."""
        rho = self.parameters["rho"]
        return rho.value <= rho.low

    @property
    def F_k(self) -> float:
        """Friction force, N."""
        return self.value("F_k")

    @property
    def c(self) -> float:
        """Viscous damping, N s/m; 0 where the law has none."""
        return self.value("c") if "c" in self.parameters else 0.0

    @property
    def rho(self) -> float:
        """ρ = K_z^{−1/2}, (m/N)^{1/2}; 0 for a rigid contact."""
        return 0.0 if self.rigid else self.value("rho")

    @property
    def K_z(self) -> float:
        """Contact stiffness, N/m; infinite for a rigid contact."""
        return math.inf if self.rigid else self.rho**-2

    @property
    def K_z_error(self) -> float:
        """Standard error of K_z, N/m; infinite where the contact is rigid."""
        return math.inf if self.rigid else 2.0 * self.K_z**1.5 * self.error("rho")

    @property
    def K_z_interval(self) -> tuple[float, float]:
        """95 % interval of K_z, N/m, from that of ρ; unbounded above where that reaches ρ = 0."""
        low, high = self.interval("rho")
        return high**-2, (low**-2 if low > 0.0 else math.inf)

    @property
    def m(self) -> float:
        """Mass, kg."""
        return self.value("m")

    @property
    def natural_frequency_hz(self) -> float:
        """√(k/m)/2π, Hz, the natural frequency while the contact slips."""
        return math.sqrt(self.k / self.m) / (2.0 * math.pi)
