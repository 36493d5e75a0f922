"""Common part of every fit of one oscillator to records, steady or free: values, errors, intervals."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import special

from ..arrays import Array
from ..solver import NORMAL_95
from .parameters import Parameter, Parameters


@dataclass(frozen=True, eq=False)
class OscillatorFit(ABC):
    """The oscillator that fits records best: results that every such fit has, whatever the records are.

    k : stiffness, N/m, given.
    point : all p unknowns, SI, (p,), those common to all records first.
    covariance : covariance of the point, (p, p); zero where an unknown was given.
    chi_square : sum of the squares of the residuals (model − data)/σ, χ².
    rigid : whether ρ = K_z^{−1/2} is at its lower limit, which stands for a rigid contact.
    """

    k: float
    point: Array
    covariance: Array
    chi_square: float
    rigid: bool

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the common unknowns, in the order of the point."""

    @property
    @abstractmethod
    def misfit(self) -> float:
        """How far the residual is from noise; 1 where it is noise."""

    @property
    def parameters(self) -> Parameters:
        """The common unknowns, for callers that are ported; to be replaced."""
        values = zip(self.names, self.point.tolist(), strict=False)
        return Parameters.of(Parameter(name, value) for name, value in values)

    @property
    def common_covariance(self) -> Array:
        """Covariance of the common unknowns, in the order of their names."""
        return self.covariance[: len(self.names), : len(self.names)]

    def covariance_of(self, *names: str) -> Array:
        """Return the covariance of some unknowns, in their units."""
        at = [self.names.index(name) for name in names]
        return self.common_covariance[np.ix_(at, at)]

    def value(self, name: str) -> float:
        """Return a common unknown, in its unit."""
        return float(self.point[self.names.index(name)])

    def error(self, name: str) -> float:
        """Return the standard error of a common unknown, in its unit; 0 where it was given."""
        at = self.names.index(name)
        return math.sqrt(self.common_covariance[at, at])

    def interval(self, name: str) -> tuple[float, float]:
        """Return the 95 % interval of a common unknown, in its unit."""
        reach = NORMAL_95 * self.error(name)
        return self.value(name) - reach, self.value(name) + reach

    @property
    def F_k(self) -> float:
        """Friction force, N."""
        return self.value("F_k")

    @property
    def c(self) -> float:
        """Viscous damping, N s/m; 0 where the law has none."""
        return self.value("c") if "c" in self.names else 0.0

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


@dataclass(frozen=True, eq=False)
class NamedFit(OscillatorFit):
    """The oscillator of largest likelihood, and the problem that it solves.

    freedom : degrees of freedom of χ².   problem : evaluates residuals and motion, see `fit.minimise`.
    """

    freedom: float
    problem: Any

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the common unknowns, in the order of the point."""
        return tuple(self.problem.names)

    def interval(self, name: str) -> tuple[float, float]:
        """Return the 95 % interval of a common unknown, in its unit, with Student's t: the residual shows the noise."""
        reach = float(special.stdtrit(max(self.freedom, 1.0), 0.975)) * self.error(name)
        return self.value(name) - reach, self.value(name) + reach

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom."""
        return self.chi_square / max(self.freedom, 1.0)
