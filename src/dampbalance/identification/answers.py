"""What each way to an answer says, in one form for forced records and free decays: values, errors, covariance, rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..balance import Rows
from ..law.terms import term
from ..reading.ringdown_motion import COMMON
from ..reading.ringdown_rows import W
from .limits import REFERENCE
from .notes import notes_of
from .result import (
    ApproachResult,
    Identification,
    Interval,
    ParameterEstimate,
    parameters_of,
)
from .ringdown import BALANCE, RingDown
from .verdicts import Verdict, judged_by_notes


@dataclass(frozen=True, eq=False)
class Answer:
    """What one approach, or the fit of maximum likelihood, identifies.

    name : of the approach.   parameters : by symbol, SI units: the coefficients of the law (F_k in N, c in N s/m, …)
    and K_z, N/m; NaN where there is none.   covariance : of their errors, in the order of `parameters`, (n, n), in the
    products of their units; NaN where it is not known.   rows : of the balance, a column each, (rows,): the integrals,
    the input work W, its standard error, and what the answer leaves of the row; none for the fit.
    row_names : of the records or decays that the rows belong to.   notes : what a reader must know of it.
    """

    name: str
    parameters: Mapping[str, ParameterEstimate]
    covariance: Array
    rows: Mapping[str, Array]
    row_names: tuple[str, ...]
    notes: tuple[str, ...]

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
        """What each value is worth, by its symbol: usable, doubtful or none, and why."""
        return judged_by_notes(self.parameters, self.notes)


def answers_of_forced(result: Identification) -> dict[str, Answer]:
    """The answers to forced records by name: each approach, then the fit, where there is one."""
    sources = tuple(reading.steady.source for reading in result.readings)
    found = {name: _of_approach(e, sources) for name, e in result.estimates.items()}
    parameters, fit = parameters_of(result.whole), result.whole.fit
    if parameters and fit is not None:
        covariance = _of_fit(tuple(parameters), fit.unknowns.names, fit.covariance, fit.K_z)
        notes = notes_of(result.whole)
        found[REFERENCE] = Answer(REFERENCE, parameters, covariance, {}, (), notes)
    return found


def answers_of_decays(result: RingDown) -> dict[str, Answer]:
    """The answers to free decays by name: the balance, and the fit."""
    rows, fit = result.rows, result.fit
    columns = {term(symbol).integral_column: g for symbol, g in rows.terms.items()}
    columns |= {"W_J": rows.columns[:, W], "standard_error_J": np.sqrt(np.diag(rows.covariance))}
    values = {symbol: result.coefficients[symbol].value for symbol in rows.terms}
    columns["misfit_J"] = Rows(rows.terms, columns["W_J"]).misfit(values)
    decays = tuple(f"decay {i + 1}" if i >= 0 else "shape" for i in rows.stretch.tolist())
    one, other = rows.terms
    covariance = _covariance(result.coefficients, {(one, other): result.correlation})
    of_fit = _of_fit(tuple(result.of_fit), COMMON, fit.covariance, fit.K_z)
    return {
        BALANCE: Answer(BALANCE, result.coefficients, covariance, columns, decays, result.notes),
        REFERENCE: Answer(REFERENCE, result.of_fit, of_fit, {}, (), result.fit_notes),
    }


def _of_approach(estimated: ApproachResult, sources: tuple[str, ...]) -> Answer:
    rows = estimated.rows
    columns = {term(key).integral_column: g for key, g in rows.terms.items()}
    values = {symbol: p.value for symbol, p in estimated.coefficients.items()}
    columns |= {"W_J": rows.W, "standard_error_J": estimated.row_errors}
    columns["misfit_J"] = rows.misfit({**rows.given, **values})
    covariance = _covariance(estimated.parameters, estimated.correlations)
    return Answer(
        estimated.approach, estimated.parameters, covariance, columns, sources, estimated.notes
    )


def _covariance(
    parameters: Mapping[str, ParameterEstimate], correlations: Mapping[tuple[str, str], float]
) -> Array:
    """The covariance that standard errors and correlations make."""
    errors = np.array([p.standard_error for p in parameters.values()])
    known = np.full((errors.size, errors.size), np.nan)
    np.fill_diagonal(known, 1.0)
    at = {symbol: i for i, symbol in enumerate(parameters)}
    for (one, other), correlation in correlations.items():
        known[at[one], at[other]] = known[at[other], at[one]] = correlation
    covariance: Array = known * np.outer(errors, errors)
    return covariance


def _of_fit(symbols: Sequence[str], names: Sequence[str], covariance: Array, K_z: float) -> Array:
    """The covariance of the coefficients and K_z = ρ^{−2}, dK_z = −2ρ^{−3} dρ, from that of the unknowns of a fit."""
    places = [names.index("rho" if symbol == "K_z" else symbol) for symbol in symbols]
    slopes = np.array([-2.0 * K_z**1.5 if symbol == "K_z" else 1.0 for symbol in symbols])
    with np.errstate(invalid="ignore"):
        found: Array = covariance[np.ix_(places, places)] * np.outer(slopes, slopes)
    return found
