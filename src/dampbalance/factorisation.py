"""Least squares of many small systems at once by an orthogonal factorisation: the arithmetic of the solver."""

from __future__ import annotations

import numpy as np

from .arrays import Array, Integers

# Responses are one and the same when a column of A, scaled to unit length, encloses with those before it an angle below
# this: what tells them apart is rounding. Two levels that differ by one part in a million enclose 5e-7.
SINGULAR = 1e-12

_BLOCK = 16384  # cases at once: enough of them for arrays to be quick, few enough for the processor's cache


def solve_cases(
    columns: Array, right: Array, full: Array, n: Integers
) -> tuple[Array, Array, Array]:
    """(values (p, cases), residual (cases,), covariance (p, p, cases)) of n usable rows of each case, the others zero.

    columns : of A, (p, L, cases).   right : W without what is given, full : all of W, (L, cases).

    A = QR by Gram–Schmidt, each column orthogonalised twice, on columns of unit length; one step of iterative
    refinement keeps the digits of a small row beside a large one. Every operation is one of all cases of a block, each
    by itself, and sums over rows are taken in their order: a case has the same bits in any company.
    """
    p, _, cases = columns.shape
    values, residual = np.empty((p, cases)), np.empty(cases)
    covariance = np.empty((p, p, cases))
    for start in range(0, cases, _BLOCK):
        some = slice(start, start + _BLOCK)
        values[:, some], residual[some], covariance[:, :, some] = _solved(
            columns[:, :, some], right[:, some], full[:, some], n[some]
        )
    return values, residual, covariance


@np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore")
def _solved(A: Array, W: Array, full: Array, n: Integers) -> tuple[Array, Array, Array]:
    """As `solve_cases`, of one block."""
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
    """(Q, R, scale, smallest) of A (p, L, cases): the reciprocal lengths of its columns, and the smallest sine of the
    angle that a column makes with those before it, NaN for a column of zeros."""
    p, _, cases = A.shape
    Q, R, scale = np.empty(A.shape), np.zeros((p, p, cases)), np.empty((p, cases))
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
    """(AᵀA)⁻¹ = H Hᵀ, (p, p, cases); H: inverse of the upper triangular R, in the units of the unscaled columns."""
    p, cases = scale.shape
    H, product = np.zeros((p, p, cases)), np.empty((p, p, cases))
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
    """Σ u v over the rows of arrays (L, cases), in their order."""
    total = np.zeros(u.shape[1:])
    for a, b in zip(u, v, strict=True):
        total += a * b
    return total


def _ratio(x: Array | float, y: Array) -> Array:
    """x/y; NaN over zero, which a singular case has anyhow."""
    return np.where(y != 0.0, x / y, np.nan)
