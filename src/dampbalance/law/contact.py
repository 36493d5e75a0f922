"""A contact that yields gradually: sliders in parallel, each a spring of κ that slips at a deflection of r.

    F(x) = Σ κ_j z_j,    ż_j = ẋ while |z_j| < r_j, else z_j = ±r_j

The contact of the paper is one of them, κ = K_z and r = Z_m = F_k/K_z; bolted joints need a distribution (Iwan 1966,
J. Appl. Mech. 33, 893; Segalman 2005, J. Appl. Mech. 72, 752). Under a harmonic motion of amplitude X the fundamental
of the force is Σ κ_j D(X/r_j) times the motion,

    D = 1 for X ≤ r;    Re D = (ϑ − sin ϑ cos ϑ)/π,  Im D = (4/π)(r/X)(1 − r/X),  cos ϑ = 1 − 2r/X  for X > r

and the energy lost per cycle Σ 4κ_j r_j (X − r_j)₊ = πX² Σ κ_j Im D.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complexes


def secant(X: Array, r: Array) -> Complexes:
    """Return D, the fundamental of a slider's deflection as a part of a harmonic motion's, (n, j).

    X : amplitudes, m, (n,).   r : deflections at which sliders slip, m, (j,).
    """
    ratio = np.minimum(r / np.asarray(X)[:, None], 1.0)
    root = np.sqrt(ratio)
    theta = 2.0 * np.arcsin(root)  # accurate for small ones
    in_phase = theta - 2.0 * root * np.sqrt(1.0 - ratio) * (1.0 - 2.0 * ratio)
    return np.asarray((in_phase + 4j * ratio * (1.0 - ratio)) / np.pi)


@dataclass(frozen=True, eq=False)
class Sliders:
    """Sliders in parallel.   r : deflections at which they slip, m, (j,).   kappa : stiffnesses, N/m, (j,)."""

    r: Array
    kappa: Array

    @property
    def K_z(self) -> float:
        """Stiffness of the contact before anything slips, N/m."""
        return float(np.sum(self.kappa))

    @property
    def F_k(self) -> float:
        """Force at which everything slips, N."""
        return float(self.kappa @ self.r)

    def secant(self, X: Array) -> Complexes:
        """Return Σ κ_j D(X/r_j), N/m, (n,): stiffness of the fundamental; πX² times the imaginary part is the loss."""
        return secant(X, self.r) @ self.kappa

    def loss(self, X: Array) -> Array:
        """Return energy lost per cycle of a harmonic motion, J, (n,)."""
        return 4.0 * np.maximum(np.subtract.outer(X, self.r), 0.0) @ (self.kappa * self.r)
