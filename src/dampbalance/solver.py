"""The coefficients of the energy balance from its rows: Eqs. (8), (9) and the corrected (10).

One solver serves every approach and every use: A p = W with a column of A for each term that is not given, solved by an
orthogonal factorisation of the matrix with its columns scaled to unit length. With as many rows as columns the solution
is the pair-wise one of (8), of which (15)–(19) are special cases; with more it is the least squares of (9). The normal
equations written in (9) would square a condition number that is 20 to 100 for the paper's levels and grows without
bound as levels approach each other.

Equation (9) weights all rows alike, so that the highest level, whose misfit has the largest error, dominates. Rows
whose error covariance is known are weighted by inverse variance, 1/var(Σ g_j p_j − W). The variance depends on the p_j,
so that the solution is repeated with the weights of the last one.

A case is solved by itself: the cases next to it change no bit of its estimate.
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
from .law.terms import symbols_in_words

Pair = tuple[int, int]

NORMAL_95 = 1.959963984540054
"""Standard errors on either side that hold 95 % of a normal distribution."""

# Responses are one and the same when a column of A, scaled to unit length, encloses with those before it an angle below
# this: they differ by rounding. Two levels that differ by one part in a million enclose 5e-7.
SINGULAR = 1e-12


@dataclass(frozen=True, eq=False, slots=True)
class Estimate:
    """Coefficients identified from rows of the balance, for one case or an array of cases.

    values : symbol → coefficient, SI unit, in the shape of the cases; NaN where the rows do not determine it.
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

    def standard_error(self, symbol: str) -> Array:
        """Return the standard error of a coefficient, the root of its diagonal element of the covariance."""
        j = list(self.values).index(symbol)
        error: Array = np.sqrt(self.covariance[j, j])
        return error


def solve(rows: Rows) -> Estimate:
    """Return the least-squares coefficients of each case from its usable rows, p = (AᵀA)⁻¹ Aᵀ W, Eq. (9).

    rows : of shape (L, …), the cases along the further axes. Rows with a NaN are left out. A case with fewer usable
    rows than unknowns, or whose rows describe the same response, is NaN. Rows with a covariance are solved repeatedly,
    until the weights have settled.
    """
    if rows.covariance is None:
        return _solved(rows)
    with np.errstate(divide="ignore"):
        weights = rows.W**-2.0  # errors grow with the work, nearly
    moving = np.ones(rows.W.shape[1:], dtype=np.bool_)
    # each brings the weights nearer by a factor of 100 or so
    for _ in range(20):
        current = replace(rows, weights=weights, covariance=None)
        estimate = _solved(current)
        again = rows.weighted(estimate.values).weights
        assert again is not None
        again = np.where(np.isfinite(again), again, weights)  # rows without errors keep theirs
        change = np.where(rows.usable, np.abs(again / weights - 1.0), 0.0).max(axis=0)
        # 1e-9 relative change of the weights
        moving &= change > 1e-9  # a case that has settled stays, whatever the others do
        if not moving.any():
            break
        weights = np.where(moving, again, weights)
    return estimate


def _solved(rows: Rows) -> Estimate:
    """Solve rows with the weights that they have."""
    symbols = [symbol for symbol in rows.terms if symbol not in rows.given]
    usable = rows.usable
    kept = usable if rows.weights is None else np.where(usable, np.sqrt(rows.weights), 0.0)
    columns = np.empty((len(symbols), *rows.W.shape))
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
    values, residual, covariance = _solve_cases(columns, right, full, n)
    found = {symbol: value[()] for symbol, value in zip(symbols, values, strict=True)}
    return Estimate(found, residual[()], covariance, n[()])


@np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore")
def _solve_cases(A: Array, W: Array, full: Array, n: Integers) -> tuple[Array, Array, Array]:
    """Return (values (p, …), residual (…), covariance (p, p, …)) of n usable rows of each case, the others zero.

    A : columns, (p, L, …).   W : without what is given, full : all of it, (L, …).

    A = QR by Gram–Schmidt, each column orthogonalised twice, on columns of unit length; one step of iterative
    refinement keeps the digits of a small row next to a large one. Every operation works case by case, and sums over
    rows are taken in their order: a case has the same bits in any company.
    """
    Q, R, scale, smallest = _factorised(A)
    values, rest = np.zeros(scale.shape), W
    for _ in range(2):
        step = np.empty(scale.shape)
        for j in reversed(range(len(A))):  # R step = Qᵀ rest
            step[j] = _dot(Q[j], rest)
            for other in range(j + 1, len(A)):
                step[j] -= R[j, other] * step[other]
            step[j] = _ratio(step[j], R[j, j])
            values[j] += step[j] * scale[j]
        rest = W
        for column, value in zip(A, values, strict=True):
            rest = rest - value * column
    left, total, freedom = _dot(rest, rest), _dot(full, full), n - len(A)
    solved = np.where((freedom >= 0) & (smallest >= SINGULAR), 0.0, np.nan)
    residual = np.where(total > 0.0, np.sqrt(left / total) + solved, np.nan)
    variance = np.where(freedom > 0, left / freedom + solved, np.nan)
    return values + solved, residual, _inverse_of_normal(R, scale) * variance


def _factorised(A: Array) -> tuple[Array, Array, Array, Array]:
    """Return (Q, R, scale, smallest) of A (p, L, …): reciprocal lengths of its columns, and the smallest sine of the
    angle of a column to those before it, NaN for a column of zeros."""
    p, _, *cases = A.shape
    Q, R, scale = np.empty(A.shape), np.zeros((p, p, *cases)), np.empty((p, *cases))
    smallest = np.ones(cases)
    for j in range(p):
        scale[j] = _ratio(1.0, np.sqrt(_dot(A[j], A[j])))
        q = A[j] * scale[j]
        for _ in range(2):
            for other in range(j):
                along = _dot(Q[other], q)
                R[other, j] += along
                q = q - along * Q[other]
        R[j, j] = length = np.sqrt(_dot(q, q))
        smallest = np.where((length < smallest) | np.isnan(length), length, smallest)
        Q[j] = q * _ratio(1.0, length)
    return Q, R, scale, smallest


def _inverse_of_normal(R: Array, scale: Array) -> Array:
    """Return (AᵀA)⁻¹ = H Hᵀ, (p, p, …); H: inverse of the upper triangular R, in the units of the unscaled columns."""
    p = len(scale)
    H, product = np.zeros(R.shape), np.empty(R.shape)
    for column in range(p):
        H[column, column] = _ratio(1.0, R[column, column])
        for j in reversed(range(column)):
            total = sum(R[j, other] * H[other, column] for other in range(j + 1, column + 1))
            H[j, column] = -_ratio(total, R[j, j])
    H *= scale[:, None]
    for j in range(p):
        for other in range(j + 1):
            product[j, other] = sum(H[j, column] * H[other, column] for column in range(j, p))
            product[other, j] = product[j, other]
    return product


def _dot(u: Array, v: Array) -> Array:
    """Return Σ u v over the rows of arrays (L, …), in their order."""
    total = np.zeros(u.shape[1:])
    for a, b in zip(u, v, strict=True):
        total += a * b
    return total


def _ratio(x: Array | float, y: Array) -> Array:
    """Return x/y; NaN over zero, which a singular case has anyhow."""
    return np.where(y != 0.0, x / y, np.nan)


def least_squares(rows: Rows) -> Estimate:
    """Return the least-squares coefficients of one case, like `solve`, or raise an error that says why there are none.

    Raises ValueError for fewer usable rows than unknowns, or when all usable rows describe the same response.
    """
    estimate = solve(rows)
    unknowns, usable = list(estimate.values), int(np.count_nonzero(rows.usable))
    if usable < len(unknowns):
        raise ValueError(
            f"{symbols_in_words(unknowns)} need at least {_number(len(unknowns))} usable responses, got {usable} of "
            f"{rows.usable.size}: the others lack a feature (nothing slips); raise their excitation or add levels"
        )
    if math.isnan(estimate.residual):
        raise ValueError(
            f"the {usable} usable responses are one and the same, or nothing slides in any of them: "
            f"{symbols_in_words(unknowns)} cannot be distinguished; use levels that differ and slip"
        )
    return estimate


def pair(rows: Rows, i: int, j: int) -> Estimate:
    """Return F_k and c from the two responses i and j (counted from 0), Eq. (8).

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
                f"pair {pair_label(i, j)}: two levels do not distinguish {symbols_in_words(unknowns)}; "
                "give all but two of them"
            )
        raise ValueError(
            f"pair {pair_label(i, j)}: levels {i + 1} and {j + 1} give the same response, or nothing slides in either: "
            f"{symbols_in_words(unknowns)} cannot be distinguished; use two levels that differ and slip"
        )
    return estimate


def mean_and_deviation(
    estimates: Sequence[Mapping[str, ArrayLike]],
) -> tuple[dict[str, float], dict[str, float]]:
    """Return mean and standard deviation (divisor n − 1, NaN for n = 1) of estimates by symbol, as the paper states for
    its pairs.

    estimates : the values of each, by symbol. Raises ValueError when there are none.
    """
    if not estimates:
        raise ValueError("mean of no estimates: give at least one pair of responses that slip")
    values = {s: np.array([estimate[s] for estimate in estimates]) for s in estimates[0]}
    mean = {s: float(v.mean()) for s, v in values.items()}
    return mean, {s: float(v.std(ddof=1)) if len(v) > 1 else math.nan for s, v in values.items()}


def contact_stiffness(F_k: ArrayLike, X: ArrayLike, X_s: ArrayLike) -> Array:
    """Return the stiffness of the contact from the length of its microstick line, K_z = 2F_k/(X + X_s), N/m.

    Eq. (10), corrected: from the reversal at −X to the onset of slip at X_s the contact spring swings from −Z_m to +Z_m
    with F_k = K_z Z_m. The paper prints the inverse without the 2, which has the unit of a compliance.

    F_k : N.   X, X_s : m (X_s < 0), any shapes that broadcast. NaN where X_s is NaN, and where it lies at or beyond −X,
    as a microstick line without length has no stiffness; read X and X_s with more digits, or assume a rigid contact.
    """
    swing = numbers("X", X, missing=True) + numbers("X_s", X_s, missing=True)
    force = numbers("F_k", F_k, missing=True, signed=True)
    return np.asarray(2.0 * force / np.where(swing > 0.0, swing, np.nan))


def pair_label(i: int, j: int) -> str:
    """Return the paper's name of the pair of responses i, j: levels counted from 1, e.g. "1-2"."""
    return f"{i + 1}-{j + 1}"


def levels_of(label: str) -> tuple[int, ...]:
    """Return the levels, counted from 1, of a pair by its label."""
    return tuple(map(int, label.split("-")))


def _number(n: int) -> str:
    return {1: "one", 2: "two", 3: "three"}.get(n, str(n))
