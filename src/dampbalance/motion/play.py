"""The deflection of a contact under a prescribed motion: play operator, rounded knee, friction that varies with time.

A slider of Jenkins has ż = ẋ while |z| < r, else z = ±r. Bouc and Wen's contact rounds the knee,

    dz/dx = 1 − |z/r|ⁿ  where |z| grows,  1 where it falls,

and becomes the slider for n → ∞ (Wen 1976, J. Eng. Mech. Div. 102, 249, with β = γ).
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from .jit import jit

_STEP = 0.1  # of r, of a step of fourth order: its error is 1e-6


@jit
def _moved(z: float, dx: float, r: float, n: float) -> float:
    """Return the deflection after a motion without reversal."""
    if math.isinf(n):
        return min(max(z + dx, -r), r)
    way = math.copysign(1.0, dx)
    back = min(abs(z), abs(dx)) if z * way < 0.0 else 0.0
    steps = 1 + int((abs(dx) - back) / (_STEP * r))
    h, u = (abs(dx) - back) / r / steps, min(way * (z + way * back) / r, 1.0)
    for _ in range(steps if abs(dx) > back else 0):
        a = 1.0 - abs(u) ** n
        b = 1.0 - abs(u + 0.5 * h * a) ** n
        c = 1.0 - abs(u + 0.5 * h * b) ** n
        u += h / 6.0 * (a + 2.0 * b + 2.0 * c + 1.0 - abs(u + h * c) ** n)
        u = min(u, 1.0)
    return way * r * u


@jit
def play(x: Array, through: Array, r: float, n: float, top: Array) -> Array:
    """Return the deflection z of a contact that starts relaxed, exact for a motion that turns only at `through`.

    x : displacement, m, (i,).   through : displacement that is passed between two samples, as the corner of a sharp
    reversal, m, (i − 1,).   r : deflection at which it slips, m.   n : sharpness of the knee, ∞ for a slider.   top : r
    of each sample over r, (i,).   Returns z, m, (i,).
    """
    z = np.zeros(x.size)
    for i in range(1, x.size):
        limit = r * top[i]
        z[i] = _moved(z[i - 1], through[i - 1] - x[i - 1], limit, n)
        z[i] = _moved(z[i], x[i] - through[i - 1], limit, n)
    return z
