"""The integrals g = ∮ h ẋ dt of a law's terms over a period, from the harmonics of a motion."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Complexes
from .terms import FRICTION, KNOWN_TERMS

_POINTS = 512  # of a cycle, at least; |ẋ|³ has a jump in its third derivative, and the rule an error of 1e-9
_PER_HARMONIC = 8


def of_harmonics(
    symbol: str,
    n: Array,
    x: Complexes,
    y_n: Array,
    y: Complexes,
    omega: float,
    k: float,
    variance: Array | None = None,
) -> Array:
    """g of a term from the harmonics of r motions x = Re Σ x_n e^{inωt}, y likewise, (r,).

    Terms that are linear in ẋ and ẏ by Parseval's theorem, ∮ẋ² dt = πω Σ n²|x_n|² and ∮ẏẋ dt = πω Σ n² Re x_n y_n*;
    others from the velocity at equidistant phases.

    n : orders, (h,).   x : m, (r, h).   y_n, y : the same of the base, (l,) and (r, l).   omega : rad/s.   k : N/m.
    variance : of the noise in each complex x_n, m², (h,); what it adds to the powers of ẋ in the mean is taken off:
    ẋ² by σ², |ẋ|³ by 3σ²|ẋ|, ẋ⁴ by 6σ²ẋ², σ² = ½ω² Σ n² var x_n.

    Raises ValueError for friction, whose travel no harmonics tell.
    """
    of_term = KNOWN_TERMS[symbol]
    if of_term.force is None:
        raise ValueError(f"{FRICTION} has no integral that harmonics tell")
    variance = np.zeros(n.size) if variance is None else variance
    if of_term.linear:
        square = math.pi * omega * ((np.abs(x) ** 2 - variance) @ n**2)
        factor, of_base = (float(of_term.force(*at, k, omega)) for at in ((1.0, 0.0), (0.0, 1.0)))
        if not of_base:
            return np.asarray(factor * square)
        shared, of_x, of_y = np.intersect1d(n, y_n, assume_unique=True, return_indices=True)
        product = (x[:, of_x] * y[:, of_y].conj()).real @ shared**2
        return np.asarray(factor * square + of_base * math.pi * omega * product)
    points = max(_POINTS, 1 << math.ceil(math.log2(_PER_HARMONIC * float(n.max()))))
    spectrum = np.zeros((len(x), points // 2 + 1), dtype=np.complex128)
    spectrum[:, n.astype(np.intp)] = 0.5j * omega * points * n * x
    v = np.fft.irfft(spectrum, points, axis=1)
    sigma2 = 0.5 * omega**2 * float(variance @ n**2)
    power = of_term.order + 1
    mean = np.mean(of_term.force(v, 0.0, k, omega) * v, axis=1)
    mean -= 0.5 * power * (power - 1) * sigma2 * np.mean(np.abs(v) ** (power - 2), axis=1)
    return np.asarray(2.0 * math.pi / omega * mean)
