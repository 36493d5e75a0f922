"""Times with too few digits: 20,000 samples a second with stamps in ms, say. The line through them has the digits."""

from __future__ import annotations

import warnings

import numpy as np

from ...arrays import Array
from ...record import GRID_TOLERANCE
from ..errors import RecordWarning

_DECIMALS = range(13)
_INTEGER = (
    0.01  # of the resolution: what a multiple of it may be off by, as floating-point numbers are
)
_WITHIN = 1.5  # resolutions; rounding, and what the line is off by itself
_ACCURATE = 1e-3  # of the rate, that it may be off by at the most: c is then off by as much


def in_equal_steps(t: Array, where: str) -> Array:
    """The times of a channel: t_i = t_0 + i Δt by least squares, where it holds these rounded to too few digits.

    It does if all are multiples of a decimal resolution q apart and none is further than that from the line. Rounding
    errors of up to q/2 put the slope off by 3q/2T at the most, T being the length of the record; they rarely conspire
    like that, and a hundredth of it is common. A warning tells the bound. Any other times are returned as they are.

    t : s.   where : file and channel, for the warning.
    """
    steps = np.diff(t)
    if t.size < 3 or not steps.min() >= 0.0 or not t[-1] > t[0]:
        return t
    even = np.linspace(t[0], t[-1], t.size)
    if np.abs(t - even).max() <= GRID_TOLERANCE * (even[1] - even[0]):
        return t
    q = next((q for n in _DECIMALS if _are_multiples(steps, q := 10.0**-n)), None)
    if q is None:
        return t
    i = np.arange(t.size) - 0.5 * (t.size - 1)
    middle = float(t.mean())
    step = float(i @ (t - middle)) / float(i @ i)
    line = np.asarray(middle + step * i)
    bound = 1.5 * q / (step * t.size)
    if np.ptp(t - line) > _WITHIN * q or bound > _ACCURATE:
        return t
    warnings.warn(
        f"{where} is rounded to {q:.3g} s, its samples are {step:.3g} s apart: {1.0 / step:.9g} samples a second are "
        f"taken, from the line through it, off by {1e6 * bound:.3g} ppm at the most; give sample_rate_hz if known",
        RecordWarning,
        stacklevel=2,
    )
    return line


def _are_multiples(steps: Array, q: float) -> bool:
    """Whether all steps are multiples of q, none but zero being lost."""
    multiples = np.round(steps / q)
    return not np.any((multiples == 0.0) & (steps > 0.0)) and bool(
        np.abs(steps / q - multiples).max() < _INTEGER
    )
