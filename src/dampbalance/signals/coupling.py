"""AC coupling, a high-pass filter of first order, applied to the samples of a model that starts at rest, so that they
compare with a channel that is AC-coupled.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array


def ac_coupled(columns: Array, dt: float, corner: float) -> Array:
    """Return a motion and its derivatives after an AC coupling that starts at rest, (n, u + 1).

    The last column is the derivative of the motion by the corner; for a corner of 0, the integral of the motion without
    its trend. Integrals follow the trapezoidal rule.

    columns : (n, u), the motion first.   dt : s.   corner : Hz, 0 for no coupling.
    """
    from scipy.signal import lfilter  # slow to import

    half = math.pi * corner * dt
    poles = [1.0 + half, half - 1.0]
    if corner:
        columns = lfilter([1.0, -1.0], poles, columns, axis=0)
    integral = lfilter([0.5 * dt, 0.5 * dt], poles, columns[:, 0])
    if not corner:
        n = np.arange(integral.size) - 0.5 * (integral.size - 1)
        integral -= integral.mean() + n * (n @ integral / (n @ n))
    return np.column_stack([columns, -2.0 * math.pi * integral])


def ac_start(count: int, dt: float, corner: float) -> Array:
    """Return the free decay of an AC coupling over `count` samples, relative to its first value."""
    half = math.pi * corner * dt
    return np.asarray(((1.0 - half) / (1.0 + half)) ** np.arange(count))
