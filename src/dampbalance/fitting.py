"""F_k and c of many cases at once: the solver of `solver.py`, one column of rows per case."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .balance import Rows
from .solver import SINGULAR

Array = NDArray[np.float64]


class Estimates(NamedTuple):
    """F_k (N), c (N s/m) and the residual ‖A p − W‖/‖W‖ of n cases, each (n,); NaN where they cannot be told apart."""

    F_k: Array
    c: Array
    residual: Array


def least_squares_of_cases(rows: Rows) -> Estimates:
    """F_k and c that fit the usable rows of each case best, Eq. (9); with two rows the pair-wise solution of (8).

    rows : a, b, W of shape (L, n), a column per case. Rows with a NaN are left out; a case with fewer than two usable
    rows, or with rows that describe one and the same response, has NaN.

    A = QR by Gram–Schmidt on columns of unit length, and one step of iterative refinement, as `identify.least_squares`.
    """
    usable = rows.usable
    a, b, W = (np.where(usable, array, 0.0) for array in rows)
    with np.errstate(divide="ignore", invalid="ignore"):  # nothing usable or nothing slides: NaN
        length_a, length_b = np.sqrt(_dot(a, a)), np.sqrt(_dot(b, b))
        q1 = a / length_a
        unit_b = b / length_b
        r12 = _dot(q1, unit_b)
        q2 = unit_b - r12 * q1
        r22 = np.sqrt(_dot(q2, q2))
        q2 /= r22
        solvable = (np.count_nonzero(usable, axis=0) >= 2) & (r22 >= SINGULAR)

        F_k = c = np.zeros(a.shape[1])
        rest = W
        for _ in range(2):
            along_1, along_2 = _dot(q1, rest), _dot(q2, rest)
            c_step = along_2 / r22
            F_k = F_k + (along_1 - r12 * c_step) / length_a
            c = c + c_step / length_b
            rest = W - a * F_k - b * c
        residual = np.sqrt(_dot(rest, rest)) / np.sqrt(_dot(W, W))
    nothing = np.where(solvable, 0.0, np.nan)
    return Estimates(F_k + nothing, c + nothing, residual + nothing)


def _dot(u: Array, v: Array) -> Array:
    """Σ u v over the levels, in their order: the sum of a case does not depend on the cases beside it."""
    total: Array = u[0] * v[0]
    for i in range(1, len(u)):
        total += u[i] * v[i]
    return total
