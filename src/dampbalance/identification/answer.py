"""An answer: numbers with their intervals, what they are good for, and the rows of the balance that they come from.

Every approach to forced records or free decays ends in an `Answer`, and so does the fit of maximum likelihood; all
answers to a set of records make an `Outcome`. Table, document, figures and studies read these and nothing else, so that
none of them asks what kind of record it was.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..balance import Rows
from ..fit.oscillator_fit import OscillatorFit
from ..law.terms import term
from ..model import named_with_unit
from ..project.wording import Remark, number_text, with_unit
from ..solver import NORMAL_95

CONFIDENCE = 0.95

REFERENCE = "maximum likelihood"
"""Name of the answer of the fit to all records, against which the approaches are checked."""

FUNDAMENTALS = "fundamentals"
"""Name of the answer of the fit to the fundamental of each record alone, where the waveforms hold no oscillator."""

SHAPE = "shape"
"""Name of a row of the balance that no cycle gives, but the shape of the motion."""

USABLE, DOUBTFUL, NONE = "usable", "doubtful", "none"


class Interval(NamedTuple):
    """Interval that holds the true value with probability CONFIDENCE; an end that is not known is infinite."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One identified number, SI units; NaN where it could not be identified.

    doubt : why it is not to be trusted though it has an interval; empty where nothing speaks against it.
    standard_error : by the jackknife, or of the fit.   interval : at CONFIDENCE.
    """

    value: float
    standard_error: float
    interval: Interval
    doubt: str = ""


UNKNOWN = ParameterEstimate(math.nan, math.nan, Interval(math.nan, math.nan))
"""The estimate of a number that the records do not determine."""


class Verdict(NamedTuple):
    """usable: value and interval hold.   doubtful: a value with a reason not to trust it.   none: no value."""

    verdict: str
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Balance:
    """Rows of the energy balance, as an answer solved them.

    errors : standard deviation of the misfit Σ g_j p_j − W of each row, J, (n,).   names : of the records or decays
    that the rows belong to.   labels : further columns of a table of the rows.
    """

    rows: Rows
    errors: Array
    names: tuple[str, ...]
    labels: Mapping[str, Sequence[Any]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Answer:
    """What one approach, or the fit of maximum likelihood, identifies.

    name : of the approach.
    parameters : by symbol, SI units: the coefficients of the law (F_k in N, c in N s/m, …) and K_z, N/m.
    covariance : of their errors, in the order of `parameters`, (n, n), in the products of their units; NaN where it is
    not known.
    notes : what a reader must know before using the numbers, and why something is missing.
    balance : the rows that were solved; None for the fit.
    shape_bias : relative error that the shape of x(t) which the approach assumes makes in each coefficient, for the
    oscillator of the fit; empty where that does not hold.
    merit : how well the rows or the records are met, and what else the fit identifies, by the keys of the document.
    """

    name: str
    parameters: Mapping[str, ParameterEstimate]
    covariance: Array
    notes: tuple[Remark, ...] = ()
    balance: Balance | None = None
    shape_bias: Mapping[str, float] = field(default_factory=dict)
    merit: Mapping[str, Any] = field(default_factory=dict)

    @property
    def coefficients(self) -> dict[str, ParameterEstimate]:
        """The parameters of the law, without K_z."""
        return {symbol: p for symbol, p in self.parameters.items() if symbol != "K_z"}

    @property
    def K_z(self) -> ParameterEstimate:
        """The contact stiffness, N/m; its interval comes from that of K_z^{−1/2}."""
        return self.parameters["K_z"]

    @property
    def values(self) -> dict[str, float]:
        """Each value by its symbol, SI units."""
        return {symbol: p.value for symbol, p in self.parameters.items()}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Each standard error by its symbol, SI units."""
        return {symbol: p.standard_error for symbol, p in self.parameters.items()}

    @property
    def intervals(self) -> dict[str, Interval]:
        """Each interval of 95 % by its symbol, SI units."""
        return {symbol: p.interval for symbol, p in self.parameters.items()}

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """Whether each value is usable, doubtful or missing, by its symbol, and why."""
        return {symbol: _judged(symbol, p, self.notes) for symbol, p in self.parameters.items()}

    @property
    def misfit(self) -> float:
        """χ² of the rows about the solution per degree of freedom; NaN where there is no degree of freedom left."""
        return float(self.merit.get("misfit", math.nan))

    @property
    def rows(self) -> dict[str, Array]:
        """The rows of the balance, a column each, (rows,): the integrals, the input work W, its standard error, and the
        misfit that the values leave; empty for the fit."""
        if self.balance is None:
            return {}
        rows = self.balance.rows
        columns = {term(key).integral_column: g for key, g in rows.terms.items()}
        columns |= {"W_J": rows.W, "standard_error_J": self.balance.errors}
        return columns | {"misfit_J": self.row_misfit}

    @property
    def row_misfit(self) -> Array:
        """Σ g_j p_j − W of each row with the values of this answer, J, (rows,)."""
        assert self.balance is not None
        rows = self.balance.rows
        own = {s: p.value for s, p in self.coefficients.items() if s in rows.terms}
        return rows.misfit({**rows.given, **own})


def answer_of_fit(
    fit: OscillatorFit,
    coefficients: Iterable[str],
    notes: Iterable[Remark],
    *,
    doubt: str = "",
    **merit: Any,
) -> Answer:
    """The answer of a fit of maximum likelihood.

    coefficients : keys.   doubt : why K_z is not to be trusted.   merit : what else the fit identifies.
    """
    keys = list(coefficients)
    numbers = {key: (fit.value(key), fit.error(key), fit.interval(key), "") for key in keys}
    numbers["K_z"] = fit.K_z, fit.K_z_error, fit.K_z_interval, doubt
    parameters = {
        key: ParameterEstimate(value, error, Interval(*ends), why)
        for key, (value, error, ends, why) in numbers.items()
    }
    places = [fit.names.index(key) for key in (*keys, "rho")]
    # K_z = ρ^{−2}, dK_z = −2ρ^{−3} dρ
    slopes = [1.0] * len(keys) + [-2.0 * fit.K_z**1.5]
    with np.errstate(invalid="ignore"):
        covariance = fit.common_covariance[np.ix_(places, places)] * np.outer(slopes, slopes)
    of_fit = {
        "m_kg": fit.m,
        "m_standard_error_kg": fit.error("m"),
        "natural_frequency_Hz": fit.natural_frequency_hz,
        "misfit": fit.misfit,
    }
    return Answer(REFERENCE, parameters, covariance, tuple(notes), merit=of_fit | merit)


def normal(value: float, error: float) -> ParameterEstimate:
    """A number whose error has a normal distribution."""
    reach = NORMAL_95 * error
    return ParameterEstimate(value, error, Interval(value - reach, value + reach))


_NONE = np.empty((0, 0))


def covariance_of(
    parameters: Mapping[str, ParameterEstimate], symbols: Sequence[str] = (), known: Array = _NONE
) -> Array:
    """Return the covariance of the errors of all parameters from that of some, by symbol; NaN where it is not known."""
    matrix = np.full((len(parameters), len(parameters)), np.nan)
    np.fill_diagonal(matrix, [p.standard_error**2 for p in parameters.values()])
    at = [[*parameters].index(symbol) for symbol in symbols]
    matrix[np.ix_(at, at)] = known
    return matrix


def unit_of(key: str) -> str:
    """SI unit of an identified parameter: a coefficient by its key, or K_z."""
    return "N/m" if key == "K_z" else term(key).unit


def column(symbol: str, what: str = "") -> str:
    """F_k_standard_error_N: what a number says of a parameter, and its unit."""
    return named_with_unit(f"{symbol}{what}", unit_of(symbol))


def _judged(symbol: str, parameter: ParameterEstimate, notes: Sequence[str]) -> Verdict:
    """The verdict on a number by itself, and by the notes on its answer: the only place that decides it."""
    if math.isnan(parameter.value):
        return Verdict(NONE, "; ".join(notes) or f"these records do not determine {symbol}")
    low, high = parameter.interval
    reasons = [*notes, *filter(None, [parameter.doubt])]
    if math.isinf(parameter.value) or math.isinf(high):
        reasons.append(
            f"a lower limit only: {symbol} is above {with_unit(number_text(low, 4), unit_of(symbol))}"
        )
    elif not high - low <= abs(parameter.value):
        reasons.append("its interval is wider than its value")
    return Verdict(DOUBTFUL, "; ".join(reasons)) if reasons else Verdict(USABLE)
