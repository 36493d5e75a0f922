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
    the cases of a block: these are what a processor does several at a time. Loops, not expressions of arrays, which
    take several times as long to compile.
    """
    p, levels, cases = columns.shape
    values, residual = np.empty((p, cases)), np.empty(cases)
    covariance = np.empty((p, p, cases))
    size = min(_BLOCK, max(cases, 1))
    A, Q, W = np.zeros((p, levels, size)), np.empty((p, levels, size)), np.zeros((levels, size))
    rest, scale = np.empty((levels, size)), np.empty((p, size))
    step, found = np.empty((p, size)), np.empty((p, size))
    R, H = np.zeros((p, p, size)), np.zeros((p, p, size))
    left, total, smallest = np.empty(size), np.empty(size), np.empty(size)
    for start in range(0, cases, size):
        stop = min(start + size, cases)
        m = stop - start
        for row in range(levels):
            for i in range(m):
                W[row, i] = rest[row, i] = right[row, start + i]
            for j in range(p):
                for i in range(m):
                    A[j, row, i] = columns[j, row, start + i]
        _factorise(A, Q, R, scale, total, smallest)
        for j in range(p):
            for i in range(size):
                found[j, i] = 0.0
        for _ in range(2):
            _add_step(Q, R, scale, rest, step, found)
            for row in range(levels):
                for i in range(size):
                    rest[row, i] = W[row, i]
            for j in range(p):
                _subtract(found[j], A[j], rest)
        _dot(rest, rest, left)
        for i in range(m):
            total[i] = 0.0
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
def _factorise(A: Array, Q: Array, R: Array, scale: Array, along: Array, smallest: Array) -> None:
    """Write Q, R and the reciprocal lengths of the columns of A (p, L, cases), and the smallest sine of the angle that
    a column makes with those before it, NaN for a column of zeros; `along` (cases,) is scratch."""
    p, levels, cases = A.shape
    for i in range(cases):
        smallest[i] = 1.0
    for j in range(p):
        _dot(A[j], A[j], along)
        for i in range(cases):
            scale[j, i] = _ratio(1.0, math.sqrt(along[i]))
        for row in range(levels):
            for i in range(cases):
                Q[j, row, i] = A[j, row, i] * scale[j, i]
        for other in range(j):
            for i in range(cases):
                R[other, j, i] = 0.0
        for _ in range(2):
            for other in range(j):
                _dot(Q[other], Q[j], along)
                for i in range(cases):
                    R[other, j, i] += along[i]
                _subtract(along, Q[other], Q[j])
        _dot(Q[j], Q[j], along)
        for i in range(cases):
            length = math.sqrt(along[i])
            R[j, j, i] = length
            if length < smallest[i] or math.isnan(length):
                smallest[i] = length
            along[i] = _ratio(1.0, length)
        for row in range(levels):
            for i in range(cases):
                Q[j, row, i] *= along[i]


@jit
def _add_step(Q: Array, R: Array, scale: Array, rest: Array, step: Array, values: Array) -> None:
    """Add R⁻¹ Qᵀ rest, in the units of the unscaled columns, to `values`; `step` is scratch."""
    p, cases = step.shape
    for j in range(p - 1, -1, -1):
        _dot(Q[j], rest, step[j])
        for other in range(j + 1, p):
            for i in range(cases):
                step[j, i] -= R[j, other, i] * step[other, i]
        for i in range(cases):
            step[j, i] = _ratio(step[j, i], R[j, j, i])
            values[j, i] += step[j, i] * scale[j, i]


@jit
def _inverse(R: Array, scale: Array, H: Array) -> None:
    """Write H, the inverse of the upper triangular R of each case, in the units of the unscaled columns:
    (AᵀA)⁻¹ = H Hᵀ."""
    p, cases = scale.shape
    for column in range(p):
        for i in range(cases):
            H[column, column, i] = _ratio(1.0, R[column, column, i])
        for j in range(column - 1, -1, -1):
            for i in range(cases):
                total = R[j, j + 1, i] * H[j + 1, column, i]
                for other in range(j + 2, column + 1):
                    total += R[j, other, i] * H[other, column, i]
                H[j, column, i] = -_ratio(total, R[j, j, i])
    for column in range(p):
        for j in range(column + 1):
            for i in range(cases):
                H[j, column, i] *= scale[j, i]


@jit
def _dot(u: Array, v: Array, out: Array) -> None:
    """Write Σ u v over the rows, case by case, of arrays (L, cases)."""
    for i in range(len(out)):
        out[i] = 0.0
    for row in range(len(u)):
        for i in range(len(out)):
            out[i] += u[row, i] * v[row, i]


@jit
def _subtract(factor: Array, u: Array, out: Array) -> None:
    """Subtract factor · u from the rows of `out`, case by case."""
    for row in range(len(u)):
        for i in range(u.shape[1]):
            out[row, i] -= factor[i] * u[row, i]


@jit
def _ratio(x: float, y: float) -> float:
    """x/y; NaN over zero, which a singular case has anyhow."""
    return x / y if y != 0.0 else math.nan
