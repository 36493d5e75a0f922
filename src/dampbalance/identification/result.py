"""What an identification from measured responses hands over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from ..arrays import Array
from ..balance import Rows
from ..features import Features, Phase
from ..reading.noisy import Reading

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

    coefficients : of the balance's terms, by symbol, SI units.   K_z : N/m; its interval comes from that of the
    compliance 1/K_z.   correlations : of the errors of two coefficients, by their symbols.
    residual : ‖A p − W‖/‖W‖ of the rows.   misfit : χ² of the rows about the fit, over their noise, per degree of
    freedom: 1 where the balance holds for every level alike; NaN where there are no more rows than coefficients.
    rows : of the balance, one per response.   row_errors : standard deviation of the misfit Σ g_j p_j − W, J, one per
    response.   notes : what a reader of this approach must know; why something is missing.
    """

    approach: str
    coefficients: Mapping[str, ParameterEstimate]
    K_z: ParameterEstimate
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

    resolved : whether it stands out of its noise; else the contact is taken as rigid.
    bound : it is below that with 97.5 % confidence.   misfit : χ² of the records' own lengths about the mean, per
    degree of freedom; NaN for one record, or where the length is not resolved.
    rigid_bias : relative error of F_k if the line is as long as `bound` and the contact was taken as rigid; 0 where
    the line is resolved.
    """

    length: float
    standard_error: float
    resolved: bool
    bound: float
    misfit: float
    rigid_bias: float = 0.0


@dataclass(frozen=True, eq=False)
class Identification:
    """Estimates by approach, and all that they come from.

    k : N/m.   phase : of the harmonic approaches.   features : of the records, (n,), with the microstick length they
    share.   warnings : of the records, and of how the approaches agree.
    """

    k: float
    phase: Phase
    readings: tuple[Reading, ...]
    features: Features
    microstick: Microstick
    estimates: Mapping[str, ApproachResult]
    replicates: int
    seed: int
    warnings: tuple[str, ...]
