"""The point where the likelihood of records is largest, with its errors and intervals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scipy import special

from .oscillator_fit import OscillatorFit


@dataclass(frozen=True, eq=False)
class Fit(OscillatorFit):
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
