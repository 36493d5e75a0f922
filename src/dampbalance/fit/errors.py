"""Errors of what is fitted, by two rules: from the information of the data where their noise is known, or from the
scatter between blocks of them where what a model leaves is no white noise."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array


def inverse_information(information: Array, prior: Array) -> Array:
    """Return the covariance of unknowns with this information, JᵀJ of residuals in standard errors, (p, p), and prior
    standard errors, (p,); zero for an unknown on which nothing depends."""
    sizes = np.diag(information)
    free = np.flatnonzero(sizes > 1e-150)  # on what is smaller nothing depends
    some = information[np.ix_(free, free)] + np.diag(prior[free] ** -2)
    length = np.sqrt(np.diag(some))
    scaled = some / np.outer(length, length)
    covariance = np.zeros_like(information)
    # what rounding cannot tell apart is uncertain, not certain
    inverse = np.linalg.inv(scaled + 1e-14 * np.eye(free.size))
    covariance[np.ix_(free, free)] = 0.5 * (inverse + inverse.T) / np.outer(length, length)
    return covariance


def jackknifed(left: Sequence[Array]) -> Array:
    """Return the covariance of n numbers, which leaving out blocks of the data gives:

        C = Σ_j (g_j − 1)/g_j Σ_i (p_ji − p̄_j)(p_ji − p̄_j)ᵀ

    (Efron & Stein, Ann. Stat. 9, 1981).   left : for each record j, the numbers p_ji without its block i, (n, …, g_j).
    """
    parts = []
    for values in left:
        off, groups = values - values.mean(axis=-1, keepdims=True), values.shape[-1]
        parts.append((groups - 1) / groups * np.einsum("i...g,j...g->ij...", off, off))
    covariance: Array = np.sum(parts, axis=0)
    return covariance


def welch_satterthwaite(variances: Array, freedoms: ArrayLike) -> float:
    """Return the degrees of freedom of a sum of independent variances v_i with f_i degrees of freedom each,
    (Σ v_i)²/Σ v_i²/f_i; infinite where all are zero."""
    spread = float(np.sum(variances**2 / np.asarray(freedoms)))
    return float(np.sum(variances)) ** 2 / spread if spread > 0.0 else math.inf
