"""How much of a record's information on F_k and c an approach uses.

The efficiency of an estimate is the Cramér–Rao bound of its variance over its variance: 1 for the reference fit, for
many samples; 0.25 for an approach that needs four times the record for the same standard error. The bound is that of
the same records (`information.py`), so that it counts the channels which an approach leaves unused.

The variance of an approach comes from a Monte Carlo study (`score`), or, for the Fourier balance, from propagation:

    white noise σ_x, σ_y, N samples over whole cycles: real and imaginary part of each line of x, y have the variances
        s_x² = 2σ_x²/N,  s_y² = 2σ_y²/N,   that is  var X_n = s_x²,  var φ_n = s_x²/X_n²,   all independent

    W = πkYX₁ sin φ₁         var W = (πk)² (Y² s_x² + X₁² s_y²)
    b = πω Σ n²X_n²          var b = (2πω)² s_x² Σ n⁴X_n²
    a = 4(X − Z_m)           var a = 16 H s_x²,  X the largest value of the sum of H odd harmonics, Z_m known

They share the lines of x. With x_n = X_n e^{−iφ_n} and α the phase of the reversal at +X (y = Y cos ωt), an error of
the line x_n moves the misfit e = W − a F_k − b c by Re(g_n dx_n),

    g_n = iπkY [n = 1] − 4 e^{inα} F_k − 2πω n² X_n e^{iφ_n} c,       var e = s_x² Σ |g_n|² + (πkX₁)² s_y²

and least squares over the levels, p = A⁺ W with A = [a b], have the covariance A⁺ diag(var e) A⁺ᵀ to first order in
the noise. (In second order |x_n|² is too large by 2s_x², and b with it: a bias to take off.) For the approaches that
read single samples (the peak, X_s, V_s, t_s) the errors depend on how they are read: `score` measures them.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special  # scipy.stats has the same functions, and takes seconds to import

from ..motion.orbit import Orbit
from .information import Bound, Noise, deviation, require_known

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Score:
    """What Monte Carlo says of an approach; each array (p,), for F_k, c[, K_z].

    bias : mean error, SI.   bias_error : its standard error.   standard_error : standard deviation of the estimates.
    rms_error : bias and scatter together.   efficiency : variance of the bound over that of the estimates.
    efficiency_interval : (2, p), 95 %, from the χ² distribution of a variance of normal estimates.
    runs, failed : estimates that entered, and that were not finite.
    """

    bias: Array
    bias_error: Array
    standard_error: Array
    rms_error: Array
    efficiency: Array
    efficiency_interval: Array
    runs: int
    failed: int


def efficiency(bound: Bound, covariance: ArrayLike) -> Array:
    """Variances of the bound over those of an estimator of (F_k, c) or (F_k, c, K_z), (p,).

    covariance : (p, p), SI.   Above 1 only by chance, or for an estimator with bias or with knowledge of its own.
    """
    variances = np.diag(np.asarray(covariance, dtype=float))
    if variances.size not in (2, 3) or not np.all(variances > 0.0):
        raise ValueError(
            "a covariance of (F_k, c) or (F_k, c, K_z) with positive variances is needed, got the "
            f"variances {variances.tolist()}"
        )
    ratio: Array = np.diag(bound.covariance)[: variances.size] / variances
    return ratio


def score(estimates: ArrayLike, truth: Sequence[float], bound: Bound) -> Score:
    """Bias, standard error and efficiency of an approach from its estimates of repeated, simulated records.

    estimates : (runs, p), columns F_k, c[, K_z]; rows that are not finite count as failed.   truth : (p,).
    Raises ValueError for fewer than two finite rows or other shapes.
    """
    given, expected = np.asarray(estimates, dtype=float), np.asarray(truth, dtype=float)
    if given.ndim != 2 or given.shape[1] not in (2, 3) or expected.shape != given.shape[1:]:
        raise ValueError(
            f"estimates must be (runs, 2) or (runs, 3) and truth as long as a row, got "
            f"{given.shape} and {expected.shape}"
        )
    finite = np.isfinite(given).all(axis=1)
    errors = given[finite] - expected
    runs = len(errors)
    if runs < 2:
        raise ValueError(f"a scatter needs two finite estimates, got {runs} of {len(given)}")
    variance = errors.var(axis=0, ddof=1)
    ratio = np.diag(bound.covariance)[: expected.size] / variance
    dof = runs - 1
    return Score(
        bias=errors.mean(axis=0),
        bias_error=np.sqrt(variance / runs),
        standard_error=np.sqrt(variance),
        rms_error=np.sqrt(np.mean(errors**2, axis=0)),
        efficiency=ratio,
        efficiency_interval=np.outer(special.chdtri(dof, np.array([0.975, 0.025])) / dof, ratio),
        runs=runs,
        failed=int(np.count_nonzero(~finite)),
    )


def fourier_balance_covariance(
    orbits: Sequence[Orbit],
    *,
    samples: int,
    noise: Noise,
    harmonics: Sequence[int] = (1, 3, 5),
) -> Array:
    """Covariance (2, 2) of (F_k, c) by least squares of the Fourier balance over levels, to first order in the noise.

    orbits : one per level, of one oscillator.   samples : N of each record, whole cycles.   harmonics : of x, summed in
    b and in the peak.   noise : standard deviation of "y" and "x", m, one for all levels or one per level.
    """
    require_known(noise, ())
    A, variances = [], []
    for i, orbit in enumerate(orbits):
        osc, motion = orbit.oscillator, orbit.motion
        s_x, s_y = (
            deviation(noise, name, i, len(orbits)) * math.sqrt(2.0 / samples) for name in ("x", "y")
        )
        square, b = 0.0, 0.0
        for n in harmonics:
            X_n, phi_n = orbit.harmonic(n)
            g = -4.0 * osc.F_k * cmath.exp(1j * n * orbit.phi)
            g -= 2.0 * math.pi * motion.omega * n**2 * osc.c * cmath.rect(X_n, phi_n)
            if n == 1:
                g += 1j * math.pi * osc.k * motion.Y
            square += abs(g) ** 2
            b += math.pi * motion.omega * n**2 * X_n**2
        X_1 = orbit.harmonic(1)[0]
        A.append((orbit.a, b))
        variances.append(s_x**2 * square + (math.pi * osc.k * X_1 * s_y) ** 2)
    inverse = np.linalg.pinv(np.array(A))
    covariance: Array = (inverse * np.array(variances)) @ inverse.T
    return covariance
