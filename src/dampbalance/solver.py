"""From rows of the energy balance to F_k and c: Eqs. (8), (9) and the corrected (10).

One solver serves every approach and both uses: A p = W with A = [a b], p = (F_k, c), solved by a QR factorisation of
the matrix with its columns scaled to unit length. With two rows the solution is the pair-wise one of (8), of which
(15)–(19) are special cases; with more it is the least squares of (9). The normal equations written in (9) would square
a condition number that is 20 to 100 for the paper's levels and grows without bound as levels approach each other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .balance import Rows

if TYPE_CHECKING:
    pass

Pair = tuple[int, int]

# Responses are one and the same when the columns of A, scaled to unit length, enclose an angle below this: what
# tells them apart is rounding. Two levels that differ by one part in a million enclose 5e-7.
SINGULAR = 1e-12


@dataclass(frozen=True, slots=True)
class Estimate:
    """Friction force and viscous damping identified from n rows.

    F_k : N.   c : N s/m.   residual : ‖A p − W‖ / ‖W‖, the paper's normalised root mean squared residual.
    covariance : of (F_k, c), shape (2, 2), from the scatter of the rows about the fit; NaN for n = 2.
    n : number of rows that entered.
    """

    F_k: float
    c: float
    residual: float
    covariance: NDArray[np.float64]
    n: int

    @property
    def standard_errors(self) -> tuple[float, float]:
        """Standard errors of F_k (N) and c (N s/m): roots of the diagonal of the covariance."""
        return math.sqrt(self.covariance[0, 0]), math.sqrt(self.covariance[1, 1])


class Statistics(NamedTuple):
    """Mean and standard deviation of several estimates: F_k in N, c in N s/m."""

    F_k_mean: float
    c_mean: float
    F_k_std: float
    c_std: float


def least_squares(rows: Rows) -> Estimate:
    """F_k and c that fit all usable rows best: p = (AᵀA)⁻¹ Aᵀ W, Eq. (9). Rows with a NaN are left out.

    Raises ValueError for fewer than two usable rows, or when all usable rows describe the same response.
    """
    usable = rows.usable
    if np.count_nonzero(usable) < 2:
        raise ValueError(
            f"F_k and c need at least two usable responses, got {np.count_nonzero(usable)} of {usable.size}: "
            "the others lack a feature (nothing slips); raise their excitation or add levels"
        )
    kept = rows.take(np.flatnonzero(usable).tolist())
    estimate = _solve(kept)
    if estimate is None:
        raise ValueError(
            f"the {len(kept.a)} usable responses are one and the same, or nothing slides in any of them: "
            "F_k and c cannot be told apart; use levels that differ and slip"
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
    estimate = _solve(rows.take([i, j]))
    if estimate is None:
        raise ValueError(
            f"pair {pair_label(i, j)}: levels {i + 1} and {j + 1} give the same response, or nothing slides in either: "
            "F_k and c cannot be told apart; use two levels that differ and slip"
        )
    return estimate


def pairs(rows: Rows, chosen: Iterable[Pair]) -> list[Estimate]:
    """The pair-wise estimates of (8) for each pair (i, j) of responses counted from 0."""
    return [pair(rows, i, j) for i, j in chosen]


def mean_and_deviation(estimates: Sequence[Estimate]) -> Statistics:
    """Mean and standard deviation (divisor n − 1, NaN for n = 1) of estimates, as the paper takes over its pairs.

    Raises ValueError when there are none.
    """
    if not estimates:
        raise ValueError("mean of no estimates: give at least one pair of responses that slip")
    values = np.array([(estimate.F_k, estimate.c) for estimate in estimates])
    mean = values.mean(axis=0)
    deviation = values.std(axis=0, ddof=1) if len(values) > 1 else np.full(2, np.nan)
    return Statistics(float(mean[0]), float(mean[1]), float(deviation[0]), float(deviation[1]))


def contact_stiffness(F_k: ArrayLike, X: ArrayLike, X_s: ArrayLike) -> NDArray[np.float64]:
    """Stiffness of the contact from the length of its microstick line, K_z = 2F_k/(X + X_s), N/m.

    Eq. (10), corrected: from the reversal at −X to the onset of slip at X_s the contact spring swings from −Z_m to +Z_m
    with F_k = K_z Z_m. The paper prints the inverse without the 2, which has the unit of a compliance.

    F_k : N.   X, X_s : m (X_s < 0), any shapes that broadcast; NaN where X_s is NaN.
    Raises ValueError where X_s lies at or beyond −X: a microstick line without length has no stiffness.
    """
    swing = np.asarray(X, dtype=float) + np.asarray(X_s, dtype=float)
    if np.any(swing <= 0.0):
        raise ValueError(
            f"X + X_s must be positive to give a contact stiffness, got {float(np.nanmin(swing)):.3g} m: "
            "read X and X_s with more digits, or take the contact as rigid"
        )
    stiffness: NDArray[np.float64] = np.asarray(2.0 * np.asarray(F_k, dtype=float) / swing)
    return stiffness


def pair_label(i: int, j: int) -> str:
    """The paper's name of the pair of responses i, j: levels counted from 1, e.g. "1-2"."""
    return f"{i + 1}-{j + 1}"


def _solve(rows: Rows) -> Estimate | None:
    """Solve A p = W in the sense of least squares; None if the columns of A are parallel or one of them is zero."""
    A = np.column_stack([rows.a, rows.b])
    W = rows.W
    scale = np.linalg.norm(A, axis=0)
    if not np.all(scale > 0.0):
        return None
    Q, R = np.linalg.qr(A / scale)
    if abs(R[1, 1]) < SINGULAR:  # sine of the angle between the columns, which have unit length
        return None
    R_inverse = np.array([[1.0 / R[0, 0], -R[0, 1] / (R[0, 0] * R[1, 1])], [0.0, 1.0 / R[1, 1]]])
    p = R_inverse @ (Q.T @ W) / scale
    p += (
        R_inverse @ (Q.T @ (W - A @ p)) / scale
    )  # keeps the digits of a small row beside a large one
    misfit = float(np.linalg.norm(A @ p - W))
    n = len(W)
    if n > 2:
        half = R_inverse / scale[:, None]  # (AᵀA)⁻¹ = half halfᵀ
        covariance = misfit**2 / (n - 2) * (half @ half.T)
    else:
        covariance = np.full((2, 2), np.nan)
    return Estimate(float(p[0]), float(p[1]), misfit / float(np.linalg.norm(W)), covariance, n)
