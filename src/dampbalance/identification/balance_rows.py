"""The energy balance for all kinds of records: rows Σ g_j p_j = W with correlated errors, solved together.

    p minimises eᵀ C⁻¹ e,    e = Σ g_j p_j − W,    C the covariance of e,

which depends on p where the g_j have errors, so that the solution is repeated with the C of the last one. Rows of
decays share half cycles, and C follows from the noise. Rows of forced records share the onset of slip of one
oscillator; C is that of the jackknife over the cycles of each record, and each row is weighted by its own variance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import special

from ..arrays import Array
from ..balance import APPROACHES, Rows
from ..features import Features, stack
from ..fit.errors import jackknifed, welch_satterthwaite
from ..law.law import Law
from ..law.terms import FRICTION
from ..signals.mean_harmonics import Means, Reading
from ..solver import solve
from .answer import CONFIDENCE, DIRECT, Answer, Balance, Interval, ParameterEstimate, covariance_of

Errors = Callable[[Mapping[str, float]], Sequence[Array]]
"""Covariances of the misfits of rows with these coefficients, J², (n, n), of errors that are independent of each
other."""

_MOST_REPEATS = 20  # each reduces the error of C about a hundredfold
_SETTLED = 1e-9  # change of C, relative to the errors of two rows
# Share of the work beyond the highest harmonic: the error of cycles without noise, which may repeat to the last bit.
_EXACT = 1e-8
_UNKNOWN = ("X_s", "V_s", "t_s", "X_r", "V_r", "t_r")
_ONE_ROW = 1e-10  # of the largest variance: rows that share half cycles may nearly be one


@dataclass(frozen=True, eq=False)
class Balanced:
    """Coefficients from rows of the balance.

    estimates : by key; empty where the rows do not determine them.   covariance : of their errors, (p, p).
    errors : standard deviation of the misfit of each row, J, (n,).   chi_square, freedom : of the misfits.
    """

    estimates: Mapping[str, ParameterEstimate]
    covariance: Array
    errors: Array
    chi_square: float
    freedom: int

    @property
    def values(self) -> dict[str, float]:
        """The coefficients by key, SI units."""
        return {key: p.value for key, p in self.estimates.items()}

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom; NaN without one."""
        return self.chi_square / self.freedom if self.freedom > 0 else math.nan

    def scaled(self) -> Balanced:
        """Return the coefficients with errors from the scatter of the rows, where these are larger."""
        more = max(1.0, self.misfit if self.freedom > 0 else 1.0) - 1.0
        wider = {s: p.wider(math.sqrt(more) * p.standard_error) for s, p in self.estimates.items()}
        return replace(self, estimates=wider, covariance=(1.0 + more) * self.covariance)


def estimate_of(value: float, variances: Array, freedoms: Sequence[float]) -> ParameterEstimate:
    """Return a number with standard error and interval, from independent parts of its variance with their degrees of
    freedom."""
    freedom, error = welch_satterthwaite(variances, freedoms), math.sqrt(math.fsum(variances))
    reach = float(special.stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE)) * error
    return ParameterEstimate(value, error, Interval(value - reach, value + reach))


def solved(
    rows: Rows, errors: Errors, freedoms: Sequence[float], *, free: int = 0, correlated: bool = True
) -> Balanced:
    """Return the coefficients from rows.

    freedoms : degrees of freedom of each part of the errors.   free : number of further unknowns, which the covariance
    leaves free.   correlated : whether rows are weighted by their whole covariance, or each by its own variance.
    """
    keys, used = [key for key in rows.terms if key not in rows.given], rows.usable
    right = -rows.misfit(rows.given)
    columns = np.column_stack([right, *(rows.terms[key] for key in keys)])[used]
    of_rows = np.full(len(used), math.nan)

    def parts_at(values: Mapping[str, float]) -> list[Array]:
        parts = [part[np.ix_(used, used)] for part in errors({**rows.given, **values})]
        of_rows[used] = np.sqrt(np.sum([np.diag(part) for part in parts], axis=0))
        return parts

    parts, exact = parts_at({}), np.diag((_EXACT * rows.W[used]) ** 2)
    covariance = exact  # errors grow with the work, nearly
    for _ in range(_MOST_REPEATS):
        root, last = _root(covariance), covariance
        white = root @ columns
        estimate = solve(Rows(dict(zip(keys, white.T[1:], strict=True)), white[:, 0]))
        if math.isnan(estimate.residual):
            return Balanced({}, np.empty((0, 0)), of_rows, math.nan, 0)
        found = {key: float(value) for key, value in estimate.values.items()}
        parts = parts_at(found)
        total = np.nan_to_num(np.sum(parts, axis=0))
        covariance = exact + (total if correlated else np.diag(np.diag(total)))
        size = np.sqrt(np.diag(last))
        if (np.abs(covariance - last) <= _SETTLED * np.outer(size, size)).all():
            break
    misfit = white @ [-1.0, *found.values()]
    size = np.linalg.norm(white[:, 1:], axis=0)
    inverse = np.linalg.pinv(white[:, 1:] / size) / size[:, None] @ root
    of_values = np.array([inverse @ part @ inverse.T for part in parts])
    of_values = 0.5 * (of_values + of_values.transpose(0, 2, 1))  # to the last bit
    estimates = {
        key: estimate_of(value, of_values[:, j, j], freedoms)
        for j, (key, value) in enumerate(found.items())
    }
    freedom = len(white) - len(keys) - free
    return Balanced(estimates, of_values.sum(axis=0), of_rows, float(misfit @ misfit), freedom)


def solved_again(rows: Rows, errors: Array) -> dict[str, float]:
    """Return the coefficients from other rows with the same weights.   errors : of the rows, as in `Balanced`."""
    weights = np.where(errors > 0.0, errors, 1.0) ** -2.0
    estimate = solve(replace(rows, weights=weights))
    return {key: float(value) for key, value in estimate.values.items()}


def _root(covariance: Array) -> Array:
    """Return R with RᵀR = C⁻¹, (n, n), which makes rows independent."""
    scale = np.sqrt(np.diag(covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    sizes, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    least = _ONE_ROW * sizes.max(initial=0.0)
    return np.asarray((vectors / np.sqrt(np.maximum(sizes, least))).T / scale)


def as_answer(
    name: str,
    of: Balanced,
    rows: Rows,
    names: tuple[str, ...],
    parameters: Mapping[str, ParameterEstimate],
    labels: Mapping[str, Sequence[Any]] | None = None,
    **more: Any,
) -> Answer:
    """Return the answer of the balance.

    names, labels : of the rows.   parameters : all, also those that the rows do not determine.   more : notes and merit
    of the answer.
    """
    parameters = {**parameters, **of.estimates}
    covariance = covariance_of(parameters, [*of.estimates], of.covariance)
    balance = Balance(rows, of.errors, names, labels or {})
    return Answer(name, parameters, covariance, balance=balance, **more)


# --- rows of forced records -----------------------------------------------------------------------


def rows_of(features: Features, law: Law, k: float, *, frictionless: bool = False) -> Rows:
    """Return the rows of features by direct integration, with a column for each coefficient of the law except those
    none of whose records has a row.   k : N/m.   frictionless : whether friction has no column."""
    rows = APPROACHES[DIRECT](features, k, law.terms)
    if frictionless:
        rows = replace(rows, terms={**rows.terms, FRICTION: np.zeros(rows.W.shape)})
    rows = rows.of_law(law)
    kept = rows.usable
    empty = [key for key, g in rows.terms.items() if not np.where(kept, g, 0.0).any()]
    return replace(rows, given={**rows.given, **dict.fromkeys(empty, 0.0)})


def features_of(
    readings: Sequence[Reading], means: Sequence[Means], moved: Array | None = None
) -> Features:
    """Return the features of n readings that share the waveforms of a fit (`with_common_fit`) from r means of each,
    (n, r); the waveforms of all records follow.   moved : changes of the unknowns of the fit, (p, r); default, those by
    all means."""
    pairs = [*zip(readings, means, strict=True)]
    if moved is None:
        moved = np.sum([reading.moved(mean) for reading, mean in pairs], axis=0)
    features = stack([reading.features_of(mean, moved)[None] for reading, mean in pairs])
    held = any(reading.waveform is not None for reading in readings)
    return features if held else features.replaced(**dict.fromkeys(_UNKNOWN, math.nan))


def features_left_out(readings: Sequence[Reading]) -> list[Features]:
    """Return the features of all readings, (n, r), for each reading without each of its groups of rows in turn, and
    with each of its errors that the scatter between rows does not show."""
    each = []
    for j, reading in enumerate(readings):
        for others in (reading.left_out(), *reading.with_hidden_errors()):
            means = [one.mean[[0] * len(others.Y)] for one in readings]
            each.append(features_of(readings, [*means[:j], others, *means[j + 1 :]]))
    return each


def solved_forced(
    readings: Sequence[Reading], law: Law, k: float, *, frictionless: bool
) -> tuple[Rows, Balanced]:
    """Return the rows of readings that share the waveforms of a fit, and their solution."""
    means = [reading.mean for reading in readings]
    rows, *left = (
        rows_of(features, law, k, frictionless=frictionless)
        for features in (features_of(readings, means)[:, 0], *features_left_out(readings))
    )

    def errors(values: Mapping[str, float]) -> list[Array]:
        return [jackknifed([part.misfit(values)]) for part in left]

    freedoms = [part.W.shape[-1] - 1.0 for part in left]
    return rows, solved(rows, errors, freedoms, correlated=False)
