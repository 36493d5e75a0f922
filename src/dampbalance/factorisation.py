"""Least squares of many small systems by an orthogonal factorisation: the compiled part of the solver."""

from __future__ import annotations

import math

import numpy as np

from .arrays import Array, Integers
from .motion.jit import jit

# Responses are one and the same when a column of A, scaled to unit length, encloses with those before it an angle below
# this: what tells them apart is rounding. Two levels that differ by one part in a million enclose 5e-7.
SINGULAR = 1e-12

_BLOCK = 256  # cases whose factors stay in the processor's cache


@jit
def solve_cases(
    columns: Array, right: Array, full: Array, n: Integers
) -> tuple[Array, Array, Array]:
    """(values (p, cases), residual (cases,), covariance (p, p, cases)) of n usable rows of each case, the others zero.

    columns : of A, (p, L, cases).   right : W without what is given, full : all of W, (L, cases).

    A = QR by Gram–Schmidt, each column orthogonalised twice, on columns of unit length; one step of iterative
    refinement keeps the digits of a small row beside a large one. Cases go through in blocks, the innermost loops over
    the cases of a block: these are what a processor does several at a time.
    """
    p, levels, cases = columns.shape
    values, residual = np.empty((p, cases)), np.empty(cases)
    covariance = np.empty((p, p, cases))
    size = min(_BLOCK, max(cases, 1))
    A, Q, W = np.zeros((p, levels, size)), np.empty((p, levels, size)), np.zeros((levels, size))
    rest, scale, step = np.empty_like(W), np.empty((p, size)), np.empty((p, size))
    R, H = np.zeros((p, p, size)), np.zeros((p, p, size))
    total = np.zeros(size)
    for start in range(0, cases, size):
        stop = min(start + size, cases)
        m = stop - start
        for row in range(levels):
            W[row, :m] = right[row, start:stop]
            for j in range(p):
                A[j, row, :m] = columns[j, row, start:stop]
        smallest = _factorise(A, Q, R, scale)
        found = np.zeros((p, size))
        rest[:] = W
        for _ in range(2):
            _add_step(Q, R, scale, rest, step, found)
            rest[:] = W
            for j in range(p):
                _subtract(found[j], A[j], rest)
        left = _dot(rest, rest)
        total[:] = 0.0
        for row in range(levels):
            for i in range(m):
                total[i] += full[row, start + i] * full[row, start + i]
        _inverse(R, scale, H)
        for i in range(m):
            freedom = n[start + i] - p
            solved = 0.0 if freedom >= 0 and smallest[i] >= SINGULAR else math.nan
            residual[start + i] = (
                math.sqrt(left[i] / total[i]) + solved if total[i] > 0.0 else math.nan
            )
            left[i] = left[i] / freedom + solved if freedom > 0 else math.nan
            for j in range(p):
                values[j, start + i] = found[j, i] + solved
        for j in range(p):
            for other in range(j + 1):
                for i in range(m):
                    product = 0.0
                    for column in range(j, p):
                        product += H[j, column, i] * H[other, column, i]
                    product *= left[i]
                    covariance[j, other, start + i] = product
                    covariance[other, j, start + i] = product
    return values, residual, covariance


@jit
def _factorise(A: Array, Q: Array, R: Array, scale: Array) -> Array:
    """Write Q, R and the reciprocal lengths of the columns of A (p, L, cases); returns the smallest sine of the angle
    that a column makes with those before it, NaN for a column of zeros."""
    smallest = np.ones(A.shape[2])
    for j in range(len(A)):
        scale[j] = 1.0 / np.sqrt(_dot(A[j], A[j]))
        for row in range(len(A[j])):
            Q[j, row] = A[j, row] * scale[j]
        R[:j, j] = 0.0
        for _ in range(2):
            for other in range(j):
                along = _dot(Q[other], Q[j])
                R[other, j] += along
                _subtract(along, Q[other], Q[j])
        R[j, j] = np.sqrt(_dot(Q[j], Q[j]))
        smallest = np.minimum(smallest, R[j, j])
        inverse = 1.0 / R[j, j]
        for row in range(len(A[j])):
            Q[j, row] *= inverse
    return smallest


@jit
def _add_step(Q: Array, R: Array, scale: Array, rest: Array, step: Array, values: Array) -> None:
    """Add R⁻¹ Qᵀ rest, in the units of the unscaled columns, to `values`; `step` is scratch."""
    p = len(Q)
    for j in range(p - 1, -1, -1):
        step[j] = _dot(Q[j], rest)
        for other in range(j + 1, p):
            step[j] -= R[j, other] * step[other]
        step[j] /= R[j, j]
        values[j] += step[j] * scale[j]


@jit
def _inverse(R: Array, scale: Array, H: Array) -> None:
    """Write H, the inverse of the upper triangular R of each case, in the units of the unscaled columns:
    (AᵀA)⁻¹ = H Hᵀ."""
    for column in range(len(R)):
        H[column, column] = 1.0 / R[column, column]
        for j in range(column - 1, -1, -1):
            H[j, column] = R[j, j + 1] * H[j + 1, column]
            for other in range(j + 2, column + 1):
                H[j, column] += R[j, other] * H[other, column]
            H[j, column] /= -R[j, j]
    for column in range(len(R)):
        for j in range(column + 1):
            H[j, column] *= scale[j]


@jit
def _dot(u: Array, v: Array) -> Array:
    """Σ u v over the rows, case by case, of arrays (L, cases)."""
    total = np.zeros(u.shape[1])
    for row in range(len(u)):
        for i in range(u.shape[1]):
            total[i] += u[row, i] * v[row, i]
    return total


@jit
def _subtract(factor: Array, u: Array, out: Array) -> None:
    """Subtract factor · u from the rows of `out`, case by case."""
    for row in range(len(u)):
        for i in range(u.shape[1]):
            out[row, i] -= factor[i] * u[row, i]
