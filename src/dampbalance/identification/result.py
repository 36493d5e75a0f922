"""What an identification from measured responses hands over."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ..arrays import Array
from ..balance import Rows
from ..features import Features, Phase
from ..law.law import Law
from ..law.terms import term
from ..reading.noisy import Reading
from ..solver import NORMAL_95
from .evidence import Comparison
from .oscillator import Whole

CONFIDENCE = 0.95


class Interval(NamedTuple):
    """Interval that holds the true value with probability CONFIDENCE; an end that is not known is infinite."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One identified number, SI units.

    standard_error : by bootstrap.   propagated_error : the same by propagation.   interval : at CONFIDENCE.
    NaN where it could not be identified.
    """

    value: float
    standard_error: float
    propagated_error: float
    interval: Interval


@dataclass(frozen=True, eq=False)
class ApproachResult:
    """The estimates of one approach.

    coefficients : of the law's terms that are not given, by key, SI units, each row weighing as much as it is
    sure.   equal : the same with all rows weighing alike, Eq. (9) as published.   K_z : N/m; its interval comes from
    that of K_z^{−1/2}.   correlations : of the errors of two parameters, by their symbols.   shape_bias : relative
    error that the shape of x(t) which the approach assumes makes in each coefficient, for the oscillator that was
    found; empty where none was. residual : ‖A p − W‖/‖W‖ of the rows.   misfit : χ² of the rows about the fit, over
    their noise, per degree of freedom: 1 where the balance holds for every level alike; NaN where there are no more
    rows than coefficients. rows : of the balance, one per response.   row_errors : standard deviation of the misfit Σ
    g_j p_j − W, J, one per response.   notes : what a reader of this approach must know; why something is missing.
    """

    approach: str
    coefficients: Mapping[str, ParameterEstimate]
    equal: Mapping[str, ParameterEstimate]
    K_z: ParameterEstimate
    shape_bias: Mapping[str, float]
    correlations: Mapping[tuple[str, str], float]
    residual: float
    misfit: float
    rows: Rows
    row_errors: Array
    notes: tuple[str, ...] = ()

    @property
    def parameters(self) -> dict[str, ParameterEstimate]:
        """The coefficients, and K_z."""
        return {**self.coefficients, "K_z": self.K_z}


@dataclass(frozen=True, slots=True)
class Microstick:
    """Length of the microstick line X + X_s = 2F_k/K_z that all records share, m.

    resolved : whether its root stands out of its noise.   bound : it is below that with 97.5 % confidence.
    All NaN where the waveforms of the records are not known.
    """

    length: float
    standard_error: float
    resolved: bool
    bound: float


@dataclass(frozen=True, eq=False)
class Identification:
    """Estimates by approach, and all that they come from.

    k : N/m.   law : whose coefficients were identified.   phase : of the harmonic approaches.   whole : the fit of the
    oscillator to all records, the yardstick.   features : of the records, (n,), with the onset of slip of that
    oscillator.   warnings : of the records, and of how the estimates agree.   laws : which laws the records support,
    where that was asked.
    """

    k: float
    law: Law
    phase: Phase
    readings: tuple[Reading, ...]
    whole: Whole
    features: Features
    microstick: Microstick
    estimates: Mapping[str, ApproachResult]
    replicates: int
    seed: int
    warnings: tuple[str, ...]
    laws: Comparison | None = None


def parameters_of(whole: Whole) -> dict[str, ParameterEstimate]:
    """What the fit of the whole oscillator identifies, by symbol; nothing where no oscillator that slips was found."""
    fit = whole.fit
    if fit is None or whole.linear:
        return {}
    found = {}
    for key in fit.law.unknowns:
        value, error = fit.value(key), fit.error(key)
        interval = Interval(value - NORMAL_95 * error, value + NORMAL_95 * error)
        found[key] = ParameterEstimate(value, error, math.nan, interval)
    of_contact = Interval(*fit.K_z_interval)
    found["K_z"] = ParameterEstimate(fit.K_z, fit.K_z_error, math.nan, of_contact)
    return found


def unit_of(key: str) -> str:
    """SI unit of an identified parameter: a coefficient by its key, or K_z."""
    return "N/m" if key == "K_z" else term(key).unit
