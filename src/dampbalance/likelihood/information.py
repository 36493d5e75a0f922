"""How much a record tells: Fisher information and the Cramér–Rao bound of (F_k, c, K_z).

Signals u_j of independent white Gaussian noise σ_u about their exact values carry the information

    I = Σ_u σ_u^{−2} Σ_j (∂u_j/∂p)(∂u_j/∂p)ᵀ

on the parameters p: (F_k, c, ρ = K_z^{−1/2}[, m]) common to all records, (Y, ψ[, ω]) and an offset of each channel of
each record. No unbiased estimate of F_k, c, K_z from the same records has a smaller covariance than their block of I⁻¹
(Cramér–Rao; Kay, *Fundamentals of Statistical Signal Processing: Estimation Theory*, 1993, chapter 3). Not knowing σ_u
costs nothing: its information is orthogonal to that on the means. An offset costs what its projection takes out: all
derivatives are centred.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model import BaseMotion, Oscillator
from ..motion.orbit import steady_orbit
from .derivatives import CHANNELS, FREE, compliance_root, response

Noise = Mapping[str, float | Sequence[float]]

# Of the smallest eigenvalue of I scaled to unit diagonal: below it only rounding is left.
_SINGULAR = 1e-13
_DENSE = 4096  # phases of a cycle that stand for all; slip onset lies between two of them: good to about 1e-4


class NotIdentifiable(ValueError):
    """The records hold no information on one of the unknowns."""


class Terms(NamedTuple):
    """Sums over the samples of one channel of one record, centred (an unknown offset is thereby eliminated).

    square : Σ JJᵀ, (p, p).   slope : Σ J r, (p,).   rss : Σ r², of n samples.
    """

    square: Array
    slope: Array
    rss: float
    n: int


@dataclass(frozen=True, eq=False)
class Coefficients:
    """F_k (N), c (N s/m), K_z (N/m), their covariance (3, 3) in SI units, and the standard error of the mass, kg."""

    F_k: float
    c: float
    K_z: float
    covariance: Array
    m_standard_error: float

    @property
    def standard_errors(self) -> tuple[float, float, float]:
        """Of F_k (N), c (N s/m), K_z (N/m)."""
        F_k, c, K_z = np.sqrt(np.diag(self.covariance)).tolist()
        return F_k, c, K_z


@dataclass(frozen=True, eq=False)
class Bound(Coefficients):
    """Smallest covariance that an unbiased estimate can have.

    F_k (N), c (N s/m), K_z (N/m) : where it holds.   covariance : (3, 3), of (F_k, c, K_z) in SI units.
    m_standard_error : kg; 0 where the mass is known.   samples : of a channel, all records together.
    """

    samples: int

    @property
    def relative(self) -> tuple[float, float, float]:
        """Standard errors as parts of F_k, c, K_z."""
        F_k, c, K_z = self.standard_errors
        return F_k / self.F_k, c / self.c if self.c else math.inf, K_z / self.K_z


def cramer_rao(
    osc: Oscillator,
    motions: Sequence[BaseMotion],
    *,
    rate_hz: float,
    cycles: float,
    noise: Noise,
    free: Collection[str] = (),
) -> Bound:
    """Bound of records sampled at rate_hz for `cycles` periods each, from the base's peak on.

    motions : one per record; frequencies may differ.   noise : standard deviation of each channel that is measured
    (of y, x, v, acceleration; SI), one for all records or one per record.   free : unknown besides, "m", "omega".

    Raises NotIdentifiable where nothing slips, ValueError for a channel or a noise that makes no sense.
    """
    require_known(noise, free)
    channels = [name for name in CHANNELS if name in noise]
    terms, weights, samples = [], [], 0
    for i, motion in enumerate(motions):
        n = round(rate_hz * cycles * motion.period)
        if n < 3:
            raise ValueError(f"{cycles:g} cycles at {rate_hz:g} Hz are {n} samples; give 3 or more")
        t = np.arange(n) / rate_hz
        middle = float(t.mean())
        u = response(osc, motion, motion.omega * middle, t - middle, channels, free)
        terms.append({name: channel_terms(u.jacobian[name], np.zeros(n)) for name in channels})
        weights.append(
            {name: 1.0 / deviation(noise, name, i, len(motions)) ** 2 for name in channels}
        )
        samples += n
    covariance = inverse(assemble(terms, weights, 3 + ("m" in free))[0])
    return Bound(
        osc.F_k,
        osc.c,
        osc.K_z,
        covariance_of_K_z(covariance, osc.K_z),
        math.sqrt(covariance[3, 3]) if "m" in free else 0.0,
        samples,
    )


def noise_of_rms(
    osc: Oscillator, motions: Sequence[BaseMotion], fraction: float, channels: Sequence[str]
) -> dict[str, tuple[float, ...]]:
    """Standard deviations that are a given part of the rms of each clean channel, per record: 0.01 is 1 %."""
    deviations: dict[str, list[float]] = {name: [] for name in channels}
    for motion in motions:
        t = (np.arange(_DENSE) + 0.5) * motion.period / _DENSE
        state = steady_orbit(osc, motion).state(t)
        for name in channels:
            signal = motion.y(t) if name == "y" else getattr(state, name)
            deviations[name].append(fraction * float(np.sqrt(np.mean(signal**2))))
    return {name: tuple(values) for name, values in deviations.items()}


def deviation(noise: Noise, channel: str, record: int, records: int) -> float:
    """σ of one channel of one record, checked."""
    given = np.atleast_1d(np.asarray(noise[channel], dtype=float))
    if given.size not in (1, records):
        raise ValueError(
            f"noise of {channel!r} has {given.size} values for {records} records; give one, or one per record"
        )
    sigma = float(given[record if given.size > 1 else 0])
    if not (math.isfinite(sigma) and sigma > 0.0):
        raise ValueError(f"noise of {channel!r} must be positive, got {sigma!r}")
    return sigma


def require_known(noise: Noise, free: Collection[str]) -> None:
    """ValueError naming a channel or an unknown that does not exist."""
    for names, allowed in ((noise, CHANNELS), (free, FREE)):
        wrong = sorted(set(names) - set(allowed))
        if wrong:
            raise ValueError(f"unknown names {wrong}; known are {', '.join(allowed)}")


def channel_terms(jacobian: Array, residual: Array) -> Terms:
    """The centred sums of one channel; jacobian (p, n), residual (n,)."""
    J = jacobian - jacobian.mean(axis=1, keepdims=True)
    r = residual - residual.mean()
    return Terms(products(J, J), products(J, r[None])[:, 0], float(np.sum(r * r)), r.size)


def products(A: Array, B: Array) -> Array:
    """A Bᵀ of few long rows, (p, n) and (q, n), without a linear algebra library: its sums, and its speed beside other
    work, depend on the number of threads."""
    product: Array = np.einsum("in,jn->ij", A, B)
    return product


def assemble(
    terms: Sequence[Mapping[str, Terms]], weights: Sequence[Mapping[str, float]], common: int
) -> tuple[Array, Array]:
    """Information I and gradient Σ J r / σ² of all unknowns: `common` ones first, then those of each record in turn.

    terms : per record and channel.   weights : 1/σ², likewise.
    """
    own = next(iter(terms[0].values())).slope.size - common
    size = common + own * len(terms)
    information, gradient = np.zeros((size, size)), np.zeros(size)
    for i, channels in enumerate(terms):
        start = common + own * i
        place = np.r_[0:common, start : start + own]
        for name, sums in channels.items():
            information[np.ix_(place, place)] += weights[i][name] * sums.square
            gradient[place] += weights[i][name] * sums.slope
    return information, gradient


def inverse(information: Array) -> Array:
    """I⁻¹, by its eigenvalues after scaling to unit diagonal. Raises NotIdentifiable where I is singular."""
    scale = np.sqrt(np.diag(information))
    if np.all(scale > 0.0) and np.all(np.isfinite(information)):
        values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
        if values[0] > _SINGULAR * len(values):
            inverted: Array = (vectors / values) @ vectors.T / np.outer(scale, scale)
            return inverted
    raise NotIdentifiable(
        "the records do not tell F_k, c and K_z apart: nothing slips in them, or too little is measured; "
        "raise the excitation or add levels"
    )


def covariance_of_K_z(covariance: Array, K_z: float) -> Array:
    """Covariance of (F_k, c, K_z) from that of (F_k, c, ρ, …): dK_z = −2 K_z^{3/2} dρ."""
    turn = np.array([1.0, 1.0, -2.0 * K_z / compliance_root(K_z)])
    return covariance[:3, :3] * np.outer(turn, turn)
