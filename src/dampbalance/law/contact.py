"""The contact: Jenkins elements in parallel, each a spring of κ that slips at a deflection of r, in any motion.

    F = Σ κ_j z_j,    ż_j = ẋ while |z_j| < r_j, else z_j = ±r_j

The contact of the paper is one of them, κ = K_z and r = Z_m = F_k/K_z; bolted joints need a distribution (Iwan 1966,
J. Appl. Mech. 33, 893; Segalman 2005, J. Appl. Mech. 72, 752). Under a harmonic motion of amplitude X the fundamental
of the force is Σ κ_j D(r_j/X) times the motion (Caughey 1960, J. Appl. Mech. 27, 640),

    D = 1 for X ≤ r;    Re D = (ϑ − sin ϑ cos ϑ)/π,  Im D = (4/π)(r/X)(1 − r/X),  cos ϑ = 1 − 2r/X  for X > r

and the energy lost per cycle Σ 4κ_j r_j (X − r_j)₊ = πX² Σ κ_j Im D.

In a given motion an element may be extended:

- a dead band of half width g in series, as the backlash of a fixture makes it: the deflection of spring and gap is that
  of an element of r + g, and the spring takes the part beyond the gap;
- a friction force that falls with the speed, F_k + F_S e^{−(ẋ/v_S)²} (Stribeck);
- a rounded knee of sharpness n, the slider for n → ∞ (Bouc; Wen 1976, J. Eng. Mech. Div. 102, 249, with β = γ):

    dz/dx = 1 − |z/r|ⁿ  where |z| grows,  1 where it falls

- its exponential, dz/dx = 1 − (z/r) sgn ẋ in either direction (Dahl 1968), for which n = 0 stands;
- a force of the speed alone, r κ tanh(ẋ/v_0), as fluids with a yield stress have it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complexes
from ..jit import jit


def describing(part: Array) -> Complexes:
    """Return D, the fundamental of the deflection of an element that slips at this part r/X of the amplitude of a
    harmonic motion, as a part of the motion's; any shape."""
    part = np.clip(part, 0.0, 1.0)  # X ≤ r sticks
    root = np.sqrt(part)
    theta = 2.0 * np.arcsin(root)  # accurate for small ones
    in_phase = theta - 2.0 * root * np.sqrt(1.0 - part) * (1.0 - 2.0 * part)
    # ϑ below which two terms of a series are closer than the difference
    in_phase = np.where(theta > 1e-2, in_phase, theta**3 * (1.0 - 0.2 * theta**2) / 1.5)
    return np.asarray((in_phase + 4j * part * (1.0 - part)) / np.pi)


def secant(X: Array, r: Array) -> Complexes:
    """Return D of elements at some amplitudes, (n, j).

    X : amplitudes, m, (n,).   r : deflections at which elements slip, m, (j,).
    """
    return describing(r / np.asarray(X)[:, None])


@jit
def _moved(z: float, dx: float, r: float, n: float) -> float:
    """Return the deflection after a motion without reversal."""
    if math.isinf(n):
        return min(max(z + dx, -r), r)
    way = math.copysign(1.0, dx)
    if n == 0.0:
        return way * r + (z - way * r) * math.exp(-abs(dx) / r)
    back = min(abs(z), abs(dx)) if z * way < 0.0 else 0.0
    # a step of fourth order, 0.1 r, around a rounded knee: its error is 1e-6
    steps = 1 + int((abs(dx) - back) / (0.1 * r))
    h, u = (abs(dx) - back) / r / steps, min(way * (z + way * back) / r, 1.0)
    for _ in range(steps if abs(dx) > back else 0):
        a = 1.0 - abs(u) ** n
        # the deflection hardly grows
        if a < 1e-12:
            break
        b = 1.0 - abs(u + 0.5 * h * a) ** n
        c = 1.0 - abs(u + 0.5 * h * b) ** n
        u += h / 6.0 * (a + 2.0 * b + 2.0 * c + 1.0 - abs(u + h * c) ** n)
        u = min(u, 1.0)
    return way * r * u


@jit
def _deflections(x: Array, through: Array, r: Array, g: float, n: float, top: Array) -> Array:
    """Return what `play` does.   top : r of each sample over r, (i,)."""
    z, out = np.zeros(r.size), np.zeros((x.size, r.size))
    for i in range(1, x.size):
        for j in range(r.size):  # the innermost: one does not wait for the other
            limit = r[j] * top[i] + g
            z[j] = _moved(z[j], through[i - 1] - x[i - 1], limit, n)
            if x[i] != through[i - 1]:
                z[j] = _moved(z[j], x[i] - through[i - 1], limit, n)
            out[i, j] = math.copysign(max(abs(z[j]) - g, 0.0), z[j])
    return out.T


def play(
    x: Array,
    r: Array,
    through: Array | None = None,
    *,
    g: float = 0.0,
    top: Array | None = None,
    n: float = math.inf,
) -> Array:
    """Return the deflections z of elements that start relaxed, m, (j, i), exact for a motion that turns only at
    `through`.

    x : displacement, m, (i,).   r : deflections at which elements slip, m, (j,).   through : displacement that is
    passed between two samples, as the corner of a sharp reversal, m, (i − 1,); default, that of the later one.   g :
    half width of a gap in series, m.   top : friction of each sample over that at which r is, (i,); default, ones.
    n : sharpness of the knee.
    """
    through = x[1:] if through is None else through
    top = np.ones(x.size) if top is None else top
    return np.asarray(_deflections(x, through, np.atleast_1d(r), g, n, top))


@dataclass(frozen=True, eq=False)
class Sliders:
    """Jenkins elements in parallel, and how they are extended in a given motion.

    r : deflections at which they slip, m, (j,).   kappa : stiffnesses, N/m, (j,).   g : half width of a gap in series,
    m.   fall, v_S : F_S/F_k and speed, m/s, of a friction that falls with it.   n : sharpness of the knee, ∞ of a
    slider, 0 of Dahl's.   v_0 : speed that rounds a friction of the speed alone, m/s; 0 of all others.
    """

    r: Array
    kappa: Array
    g: float = 0.0
    fall: float = 0.0
    v_S: float = 1.0
    n: float = math.inf
    v_0: float = 0.0

    @property
    def plain(self) -> bool:
        """Whether the elements are sliders in any motion."""
        return math.isinf(self.n) and not self.v_0

    @property
    def present(self) -> tuple[Array, Array]:
        """r and κ of the elements whose stiffness is not zero."""
        own = self.kappa > 0.0
        return self.r[own], self.kappa[own]

    @property
    def K_z(self) -> float:
        """Stiffness of the contact before anything slips, N/m."""
        return float(np.sum(self.kappa))

    @property
    def F_k(self) -> float:
        """Force at which everything slips, N."""
        return float(self.kappa @ self.r)

    def secant(self, X: Array) -> Complexes:
        """Return Σ κ_j D(r_j/X), N/m, (n,): stiffness of the fundamental; πX² times the imaginary part is the loss."""
        return secant(X, self.r) @ self.kappa

    def loss(self, X: Array) -> Array:
        """Return energy lost per cycle of a harmonic motion, J, (n,)."""
        return 4.0 * np.maximum(np.subtract.outer(X, self.r), 0.0) @ (self.kappa * self.r)

    def deflections(
        self, x: Array, v: Array | None = None, through: Array | None = None, load: float = 1.0
    ) -> Array:
        """Return the deflection of each spring in a motion, m, (j, n), see `play`.

        x, v : displacement, m, and velocity, m/s, (n,); the latter matters to a friction that falls.   load : friction
        over that of the elements, as the normal force of a record makes it.
        """
        if v is not None and self.v_0:
            return np.multiply.outer(self.r * load, np.tanh(v / self.v_0))
        top = (
            None if v is None or not self.fall else 1.0 + self.fall * np.exp(-((v / self.v_S) ** 2))
        )
        return play(x, self.r * load, through, g=self.g, top=top, n=self.n)
