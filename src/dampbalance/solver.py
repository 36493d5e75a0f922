"""From rows of the energy balance to its coefficients: Eqs. (8), (9) and the corrected (10).

One solver serves every approach and every use: A p = W with a column of A for each term that is not given, solved by an
orthogonal factorisation of the matrix with its columns scaled to unit length. With as many rows as columns the solution
is the pair-wise one of (8), of which (15)–(19) are special cases; with more it is the least squares of (9). The normal
equations written in (9) would square a condition number that is 20 to 100 for the paper's levels and grows without
bound as levels approach each other.

Equation (9) weighs all rows alike, and so the highest level, whose misfit has the largest error, weighs most. Rows of
which the covariance of their errors is known weigh as much as they are sure: with the inverse of the variance of
Σ g_j p_j − W. It depends on the p_j, and so the solution is repeated with the weights that the last one gives.

A case is solved by itself: the cases beside it change no bit of its estimate.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from .arguments import numbers
from .arrays import Array, Integers
from .balance import Rows
from .factorisation import solve_cases
from .law.terms import listed

Pair = tuple[int, int]

NORMAL_95 = 1.959963984540054
"""Standard errors on either side that hold 95 % of a normal distribution."""

_MOST_WEIGHINGS = 20  # each brings the weights nearer by a factor of 100 or so
_SETTLED = 1e-9  # relative change of the weights


@dataclass(frozen=True, eq=False, slots=True)
class Estimate:
    """Coefficients identified from rows of the balance, for one case or an array of cases.

    values : symbol → coefficient, SI unit, in the shape of the cases; NaN where the rows do not tell.
    residual : ‖A p − W‖ / ‖W‖, the paper's normalised root mean squared residual, of rows times the root of their
    weights.   covariance : of the values in their order, (p, p, …), from the scatter of the rows about the fit; NaN
    without more rows than values.   n : number of rows that entered.
    """

    values: Mapping[str, Array]
    residual: Array
    covariance: Array
    n: Integers

    def __getitem__(self, symbol: str) -> Array:
        return self.values[symbol]

    @property
    def cases(self) -> list[Estimate]:
        """The estimates of the cases of a one-dimensional array of them, each by itself."""
        return [
            Estimate(
                {symbol: values[case] for symbol, values in self.values.items()},
                self.residual[case],
                self.covariance[..., case],
                self.n[case],
            )
            for case in range(len(self.residual))
        ]

    def standard_error(self, symbol: str) -> Array:
        """Standard error of a coefficient: root of the diagonal of the covariance."""
        j = list(self.values).index(symbol)
        error: Array = np.sqrt(self.covariance[j, j])
        return error


def solve(rows: Rows) -> Estimate:
    """The coefficients that fit the usable rows of each case best, p = (AᵀA)⁻¹ Aᵀ W, Eq. (9).

    rows : of shape (L, …), the cases behind the first axis. Rows with a NaN are left out. A case with fewer usable rows
    than unknowns, or whose rows describe one and the same response, has NaN. Where the rows have a covariance, each
    case is solved again and again until its weights stay as they are.
    """
    if rows.covariance is None:
        return _solved(rows)
    with np.errstate(divide="ignore"):
        weights = rows.W**-2.0  # errors grow with the work, nearly
    moving = np.ones(rows.W.shape[1:], dtype=np.bool_)
    for _ in range(_MOST_WEIGHINGS):
        current = replace(rows, weights=weights, covariance=None)
        estimate = _solved(current)
        again = rows.weighted(estimate.values).weights
        assert again is not None
        again = np.where(np.isfinite(again), again, weights)  # of rows without errors
        change = np.where(rows.usable, np.abs(again / weights - 1.0), 0.0).max(axis=0)
        moving &= change > _SETTLED  # a case that has settled stays, whatever the others do
        if not moving.any():
            break
        weights = np.where(moving, again, weights)
    return estimate


def _solved(rows: Rows) -> Estimate:
    """As `solve`, with the weights that the rows have."""
    symbols = [symbol for symbol in rows.terms if symbol not in rows.given]
    shape, cases = rows.W.shape, rows.W.shape[1:]
    flat = (shape[0], math.prod(cases))
    usable = rows.usable
    kept = usable if rows.weights is None else np.where(usable, np.sqrt(rows.weights), 0.0)
    columns = np.empty((len(symbols), *shape))
    with np.errstate(invalid="ignore"):  # ∞ · 0 in a row that is left out
        for column, symbol in zip(columns, symbols, strict=True):
            np.multiply(rows.terms[symbol], kept, out=column)
        right = full = rows.W * kept
        if rows.given:
            right = full - kept * sum(p * rows.terms[symbol] for symbol, p in rows.given.items())
    if not usable.all():  # NaN · 0
        for array in (columns, right, full):
            array[..., ~usable] = 0.0
    n = np.asarray(np.count_nonzero(usable, axis=0))
    values, residual, covariance = solve_cases(
        columns.reshape(len(symbols), *flat), right.reshape(flat), full.reshape(flat), n.ravel()
    )
    return Estimate(
        {symbol: v.reshape(cases)[()] for symbol, v in zip(symbols, values, strict=True)},
        residual.reshape(cases)[()],
        covariance.reshape(len(symbols), len(symbols), *cases),
        n[()],
    )


def least_squares(rows: Rows) -> Estimate:
    """The coefficients that fit all usable rows of one case best: `solve`, with an error where there is no solution.

    Raises ValueError for fewer usable rows than unknowns, or when all usable rows describe the same response.
    """
    estimate = solve(rows)
    unknowns, usable = list(estimate.values), int(np.count_nonzero(rows.usable))
    if usable < len(unknowns):
        raise ValueError(
            f"{listed(unknowns)} need at least {_number(len(unknowns))} usable responses, got {usable} of "
            f"{rows.usable.size}: the others lack a feature (nothing slips); raise their excitation or add levels"
        )
    if math.isnan(estimate.residual):
        raise ValueError(
            f"the {usable} usable responses are one and the same, or nothing slides in any of them: "
            f"{listed(unknowns)} cannot be told apart; use levels that differ and slip"
        )
    return estimate


def pair(rows: Rows, i: int, j: int) -> Estimate:
    """F_k and c from the two responses i and j (counted from 0), Eq. (8).

        F_k = (b_j W_i − b_i W_j)/Δ,   c = (a_i W_j − a_j W_i)/Δ,   Δ = a_i b_j − a_j b_i

    Raises ValueError naming the levels (counted from 1, as in the paper) when one lacks a feature or the two are equal.
    """
    for index in (i, j):
        if not rows.usable[index]:
            raise ValueError(
                f"pair {pair_label(i, j)}: level {index + 1} lacks a feature of the balance (nothing slips there); "
                "choose pairs among the levels that slip"
            )
    estimate = solve(rows[[i, j]])
    if math.isnan(estimate.residual):
        unknowns = list(estimate.values)
        if len(unknowns) > 2:
            raise ValueError(
                f"pair {pair_label(i, j)}: two levels do not tell {listed(unknowns)} apart; give all but two of them"
            )
        raise ValueError(
            f"pair {pair_label(i, j)}: levels {i + 1} and {j + 1} give the same response, or nothing slides in either: "
            f"{listed(unknowns)} cannot be told apart; use two levels that differ and slip"
        )
    return estimate


def mean_and_deviation(
    estimates: Sequence[Mapping[str, ArrayLike]],
) -> tuple[dict[str, float], dict[str, float]]:
    """Mean and standard deviation (divisor n − 1, NaN for n = 1) of estimates by symbol, as the paper has of its pairs.

    estimates : the values of each, by symbol. Raises ValueError when there are none.
    """
    if not estimates:
        raise ValueError("mean of no estimates: give at least one pair of responses that slip")
    values = {s: np.array([estimate[s] for estimate in estimates]) for s in estimates[0]}
    mean = {s: float(v.mean()) for s, v in values.items()}
    return mean, {s: float(v.std(ddof=1)) if len(v) > 1 else math.nan for s, v in values.items()}


def contact_stiffness(F_k: ArrayLike, X: ArrayLike, X_s: ArrayLike) -> Array:
    """Stiffness of the contact from the length of its microstick line, K_z = 2F_k/(X + X_s), N/m.

    Eq. (10), corrected: from the reversal at −X to the onset of slip at X_s the contact spring swings from −Z_m to +Z_m
    with F_k = K_z Z_m. The paper prints the inverse without the 2, which has the unit of a compliance.

    F_k : N.   X, X_s : m (X_s < 0), any shapes that broadcast; NaN where X_s is NaN.
    Raises ValueError where X_s lies at or beyond −X: a microstick line without length has no stiffness.
    """
    swing = numbers("X", X, missing=True) + numbers("X_s", X_s, missing=True)
    if np.any(swing <= 0.0):
        raise ValueError(
            f"X + X_s must be positive to give a contact stiffness, got {float(np.nanmin(swing)):.3g} m: "
            "read X and X_s with more digits, or take the contact as rigid"
        )
    stiffness: Array = np.asarray(2.0 * numbers("F_k", F_k, missing=True, signed=True) / swing)
    return stiffness


def pair_label(i: int, j: int) -> str:
    """The paper's name of the pair of responses i, j: levels counted from 1, e.g. "1-2"."""
    return f"{i + 1}-{j + 1}"


def _number(n: int) -> str:
    return {1: "one", 2: "two", 3: "three"}.get(n, str(n))
