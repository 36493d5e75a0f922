"""Where a fit starts: from the harmonics of the records, by energy balance for each of many contact stiffnesses.

Harmonics 1, 3, 5 of x and the fundamental of y are fitted to each record. For each K_z of a grid the Fourier energy
balance

    W = πkYX₁ sin φ₁ = 4(X − F_k/K_z) F_k + πω Σ n²X_n² c

gives F_k and c, by least squares over the records and for several shares of friction in the work (a single level does
not tell the two apart). The exact orbits of all these candidates are compared with the harmonics; the closest starts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import special  # scipy.stats has the same functions, and takes seconds to import
from scipy.optimize import nnls

from ..arrays import Array, Complexes
from ..model import Oscillator
from ..motion.orbits import steady_orbits
from ..motion.regime import Regime
from ..record import Record
from .information import NotIdentifiable, products

_HARMONICS = (1, 3, 5)
_STIFFNESSES = np.geomspace(0.1, 1e5, 13)  # of K_z/k
_SHARES = (0.03, 0.2, 0.5, 0.8, 0.97)  # of friction in the work
_ROUNDING = 1e-9  # of the rms of a signal: noise below it is rounding
_LEVEL = 1e-3  # of the probability at which a linear oscillator is rejected


class Lines(NamedTuple):
    """Harmonics of n records, y = Re[Y e^{i(ωτ + ψ)}], x = Re Σ X_n e^{in(ωτ + ψ)}, n = 1, 3, 5.

    Y : m, (n,).   psi : rad, (n,).   X : complex, m, (n, 3), 0 beyond the reach of the sampling.
    deviation : standard deviation of the real and imaginary part of X_n from noise, m, (n,).
    """

    Y: Array
    psi: Array
    X: Complexes
    deviation: Array


def lines_of(records: Sequence[Record], tau: Sequence[Array], omegas: Sequence[float]) -> Lines:
    """Least-squares harmonics of records at the times τ, s, ω in rad/s.

    Raises ValueError where a record is shorter than one cycle or sampled fewer than 3 times in it.
    """
    each = [_of_record(*one) for one in zip(records, tau, omegas, strict=True)]
    return Lines(*map(np.array, zip(*each, strict=True)))


def _of_record(record: Record, tau: Array, omega: float) -> tuple[float, float, Complexes, float]:
    per_cycle = 2.0 * math.pi / (omega * record.dt)
    if per_cycle < 3.0 or tau.size < per_cycle:
        raise ValueError(
            f"a record of {tau.size} samples, {per_cycle:.3g} to the cycle: a fit needs a whole cycle, "
            "sampled 3 times or more; check the frequency and its unit"
        )
    reach = [n for n in _HARMONICS if 2.2 * n < per_cycle]
    (p,), sigma_y = _amplitudes(record.y, omega * tau, (1,))
    amplitudes, sigma_x = _amplitudes(record.x, omega * tau, reach)
    Y, psi = abs(p), float(np.angle(p))
    if not Y > 0.0:
        raise ValueError("Record.y does not move at the drive frequency: check channel and units")
    X = np.zeros(len(_HARMONICS), dtype=np.complex128)
    X[: len(reach)] = amplitudes * np.exp(-1j * psi * np.array(reach))
    gain = abs(X[0]) / Y
    return Y, psi, X, math.hypot(sigma_x, gain * sigma_y) * math.sqrt(2.0 / tau.size)


def starting_point(lines: Lines, omegas: Sequence[float], m: float, k: float) -> Oscillator:
    """The oscillator among the candidates whose orbits have harmonics closest to the records'."""
    Y, omega, harmonics, X1 = lines.Y, np.array(omegas), lines.X, lines.X[:, 0]
    W = -math.pi * k * Y * X1.imag
    if not np.all(W > 0.0):
        level = int(np.argmin(W))
        raise ValueError(
            f"record {level + 1}: the response takes no work from the base (W = {W[level]:.3g} J per cycle, where "
            "damping needs a positive one); check sign and order of the channels, their time skew and the frequency"
        )
    order = np.array(_HARMONICS)
    b = math.pi * omega * np.sum(np.abs(order * harmonics) ** 2, axis=1)
    phases = np.exp(1j * np.outer(order, np.linspace(0.0, 2.0 * math.pi, 256)))
    X = np.max((harmonics @ phases).real, axis=1)
    candidates = _candidates(W, b, X, k)
    F_k, c, K_z = candidates.T[:, :, None]
    orbits = steady_orbits(m=m, c=c, k=k, K_z=K_z, F_k=F_k, Y=Y, omega=omega)
    misfit = np.zeros(len(candidates))
    for i, n in enumerate(_HARMONICS):
        if not np.any(harmonics[:, i]):
            continue
        amplitude, lag = getattr(orbits, f"X_{n}"), getattr(orbits, f"phi_{n}")
        error = amplitude * np.exp(-1j * lag) - harmonics[:, i]
        misfit += np.sum(np.abs(error / X1) ** 2, axis=1)
    slips = np.isin(orbits.regime, (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS)).any(axis=1)
    misfit[~slips | ~np.isfinite(misfit)] = math.inf
    best = int(np.argmin(misfit))
    if not math.isfinite(misfit[best]):
        raise NotIdentifiable(
            "no oscillator with this mass and stiffness slips and responds like the records: "
            "check m, k, the frequency and the units of x and y, or give a start"
        )
    return Oscillator(m, float(c[best, 0]), k, float(K_z[best, 0]), float(F_k[best, 0]))


def refuse_linear(lines: Lines, omegas: Sequence[float], m: float, k: float) -> None:
    """NotIdentifiable where a linear oscillator explains the harmonics within their noise: F_k leaves no trace then.

    It obeys (k + K − mω² + icω) X₁ = kY with K ≥ 0 the stiffness of a contact that only sticks (0: none), and has no
    X₃, X₅. The squared misfit over its variance is χ² with two degrees of freedom per harmonic, less two.
    """
    omega, Y, X = np.array(omegas), lines.Y, lines.X
    unexplained = (k * Y - (k - m * omega**2) * X[:, 0]) / X[:, 0]
    weight = np.abs(X[:, 0])
    K = max(float(np.average(unexplained.real, weights=weight**2)), 0.0)
    c = float(np.average(unexplained.imag * omega, weights=weight**2))
    c /= float(np.average(omega**2, weights=weight**2))
    error = X.copy()
    error[:, 0] -= k * Y / (k + K - m * omega**2 + 1j * c * omega)
    sigma = np.maximum(lines.deviation, _ROUNDING * weight)
    statistic = float(np.sum(np.abs(error / sigma[:, None]) ** 2))
    dof = 2 * np.count_nonzero(X) - 2
    if dof > 0 and special.chdtrc(dof, statistic) > _LEVEL:
        raise NotIdentifiable(
            f"the records are those of a linear oscillator within their noise (stiffness k + {K:.4g} N/m, c = {c:.4g} "
            "N s/m): the contact only sticks, or there is no friction, and F_k cannot be identified; "
            "raise the excitation"
        )


def _amplitudes(signal: Array, phase: Array, orders: Sequence[int]) -> tuple[Complexes, float]:
    """Complex amplitudes of the harmonics, beside a constant, and the standard deviation of what is left."""
    basis = np.ones((2 * len(orders) + 1, phase.size))
    for i, n in enumerate(orders):
        np.cos(n * phase, out=basis[2 * i])
        np.sin(n * phase, out=basis[2 * i + 1])
    q = np.linalg.solve(products(basis, basis), products(basis, signal[None])[:, 0])
    rest = signal - np.einsum("i,in->n", q, basis)
    sigma = math.sqrt(float(np.sum(rest * rest)) / max(phase.size - q.size, 1))
    return q[:-1:2] - 1j * q[1::2], sigma


def _candidates(W: Array, b: Array, X: Array, k: float) -> Array:
    """(F_k, c, K_z) that balance the work, (n, 3)."""
    rows = []
    for K_z in k * _STIFFNESSES:
        for share in (None, *_SHARES):
            F_k, c = 0.0, 0.0
            for _ in range(6):  # the travel a depends on F_k through Z_m
                a = 4.0 * np.maximum(X - F_k / K_z, 0.05 * X)
                if share is None:
                    (F_k, c), _ = nnls(np.column_stack([a, b]) / W[:, None], np.ones(W.size))
                else:
                    F_k, c = share * float(np.mean(W / a)), (1.0 - share) * float(np.mean(W / b))
            rows.append((F_k, max(c, 0.0), K_z))
    return np.array(rows)
