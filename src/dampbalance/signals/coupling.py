"""Signals behind a coupling by a capacitor (AC), a high-pass filter of first order, from a start at rest on.

Use it on the samples of a model, to be compared with those of a channel that is coupled so.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array


def ac_coupled(columns: Array, dt: float, corner: float) -> Array:
    """Return a motion and its derivatives behind an AC coupling that starts at rest, with the derivative of the motion
    by the corner appended, (n, u + 1): without a coupling the integral of the motion, less its trend.

    columns : (n, u), the motion first.   dt : s.   corner : Hz. The integrals are those of the trapezoidal rule.
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
    """Return the decay of what an AC coupling holds at the first of some samples, relative to its start."""
    half = math.pi * corner * dt
    return np.asarray(((1.0 - half) / (1.0 + half)) ** np.arange(count))
