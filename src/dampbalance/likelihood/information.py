"""Fisher information in records, and the Cramér–Rao bound of (F_k, c, K_z).

White Gaussian noise of standard deviation σ leaves the variance 2σ²/n in the real and in the imaginary part of every
harmonic of n samples, and the harmonics hold all the information on a steady motion: it is JᵀJ with the derivatives J
of the residuals of the maximum-likelihood fit (`HarmonicResiduals`) by F_k, c, ρ = K_z^{−1/2}[, m] and the (Y, ψ) of
each record. No unbiased estimate has a smaller covariance than its inverse (Kay, *Fundamentals of Statistical Signal
Processing: Estimation Theory*, 1993, chapter 3). Unknown offsets and an unknown σ cost nothing: their information is
orthogonal.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..law.law import Law
from ..model import BaseMotion, Oscillator
from ..motion.orbit import steady_orbit
from ..reading.lines import Lines
from ..reading.one_thread import one_thread
from .waveforms import HarmonicResiduals, Unknowns

_HARMONICS = 64  # odd ones: those of ∂x/∂ρ fall as n⁻³
_SINGULAR = 1e-12  # eigenvalue of I scaled to unit diagonal, below which only rounding is left


class NotIdentifiable(ValueError):
    """The records hold no information on one of the unknowns."""


@dataclass(frozen=True, eq=False)
class Bound:
    """The smallest covariance of (F_k, c, K_z[, m]) that an unbiased estimate can have, SI, (3, 3) or (4, 4)."""

    oscillator: Oscillator
    covariance: Array

    @property
    def standard_errors(self) -> tuple[float, ...]:
        """Standard errors of F_k (N), c (N s/m), K_z (N/m)."""
        return tuple(np.sqrt(np.diag(self.covariance))[:3].tolist())

    @property
    def relative(self) -> tuple[float, ...]:
        """Standard errors as parts of F_k, c, K_z."""
        values = (self.oscillator.F_k, self.oscillator.c, self.oscillator.K_z)
        errors = zip(self.standard_errors, values, strict=True)
        return tuple(error / value if value else math.inf for error, value in errors)


@one_thread
def cramer_rao(
    osc: Oscillator,
    motions: Sequence[BaseMotion],
    *,
    rate_hz: float,
    cycles: float,
    noise: Mapping[str, float | Sequence[float]],
    free: Collection[str] = (),
) -> Bound:
    """The bound of records of base displacement and displacement: use it to judge how much an estimate makes of them.

    motions : one per record; frequencies may differ.
    rate_hz, cycles : sampling rate and length of each record; the cycles should be whole, or many.
    noise : standard deviation of "y" and of "x", m, one for all records or one per record.
    free : "m" where the mass is unknown, too.

    Raises NotIdentifiable where nothing slips, ValueError for a noise or a length that makes no sense.
    """
    sigma = [np.broadcast_to(noise[name], len(motions)) for name in ("y", "x")]
    if not all(math.isfinite(s) and s > 0.0 for s in np.ravel(sigma)):
        raise ValueError(f"the noise must be positive, got {dict(noise)}")
    n, lines = np.arange(1, 2 * _HARMONICS, 2), []
    for motion, of_y, of_x in zip(motions, *sigma, strict=True):
        samples = round(rate_hz * cycles * motion.period)
        if samples < 3:
            too_few = f"{cycles:g} cycles at {rate_hz:g} Hz are {samples} samples; give 3 or more"
            raise ValueError(too_few)
        part, x = math.sqrt(2.0 / samples), steady_orbit(osc, motion).harmonics(_HARMONICS)
        errors = np.full(n.size, part * of_x)
        lines.append(Lines(motion.omega, motion.Y, part * of_y, n, x, errors, samples))
    unknowns = Unknowns(Law(), tuple(lines), osc.k)
    point = unknowns.start(np.array([osc.F_k, osc.c, osc.K_z, osc.m]), np.ones(len(lines)))
    here = HarmonicResiduals(unknowns, 0.0).evaluate(point)
    if here is not None:
        common = 3 + ("m" in free)
        kept = [*range(common), *range(len(unknowns.names), point.size)]
        J = here[:, kept]
        scale = np.linalg.norm(J, axis=0)
        values, vectors = np.linalg.eigh(J.T @ J / np.outer(scale, scale))
        if values[0] > _SINGULAR:
            scale[2] *= -0.5 * osc.K_z**-1.5  # dK_z = −2 ρ⁻³ dρ
            covariance = (vectors / values) @ vectors.T / np.outer(scale, scale)
            return Bound(osc, covariance[:common, :common])
    raise NotIdentifiable(
        "the records do not tell F_k, c and K_z apart: nothing slips in them, or too little is measured; "
        "raise the excitation or add levels"
    )


def noise_of_rms(
    osc: Oscillator, motions: Sequence[BaseMotion], fraction: float
) -> dict[str, list[float]]:
    """Standard deviations of "y" and "x" that are a part of the rms of each clean channel, per record; 0.01 is 1 %."""
    part = fraction / math.sqrt(2.0)
    x = [np.linalg.norm(steady_orbit(osc, motion).harmonics(_HARMONICS)) for motion in motions]
    return {"y": [part * motion.Y for motion in motions], "x": [part * float(X) for X in x]}
