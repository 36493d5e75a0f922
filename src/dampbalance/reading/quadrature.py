"""Simpson's rule between places of a sampled signal, on or between samples."""

from __future__ import annotations

import math
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complexes

_ROUNDING = 1e-9  # samples


@overload
def integral(f: Array, dt: float, start: float, stop: float) -> float: ...
@overload
def integral(f: Complexes, dt: float, start: float, stop: float) -> complex: ...
def integral(f: NDArray[Any], dt: float, start: float, stop: float) -> float | complex:
    """∫ f dt from place `start` to place `stop`, counted in samples from 0 and not necessarily whole.

    Between whole samples: Simpson's composite rule (an odd number of intervals ends with the three-point rule for
    the last one). The parts of an interval at the two ends: the cubic through the four samples around it. Error
    O(dt⁴) for a smooth f.

    f : samples, real or complex, shape (n ≥ 4,).   dt : s.   Raises ValueError when the range leaves the samples.
    """
    if not 0 <= start <= stop <= f.size - 1:
        raise ValueError(f"range {start:g} … {stop:g} leaves the samples 0 … {f.size - 1}")
    first, last = math.ceil(start), math.floor(stop)
    if last <= first:
        total = dt * _cubic_part(f, start, stop)
    else:
        from scipy.integrate import simpson  # slow to import

        total = simpson(f[first : last + 1], dx=dt)
        total += dt * (_cubic_part(f, start, first) + _cubic_part(f, last, stop))
    return complex(total) if np.iscomplexobj(f) else float(total)


def integrals(f: Array, dt: float, places: Array) -> Array:
    """∫ f dt from each place to the next, by Simpson's rule alone and for many places at once.

    Each parabola through the samples 2j, 2j + 1, 2j + 2 is integrated as far as the places reach into it. Error O(dt⁴)
    for a smooth f.

    f : samples, shape (…, n ≥ 3).   dt : s.   places : ascending, counted in samples from 0, shape (p,).
    Returns shape (…, p − 1). Raises ValueError when a place leaves the parabolas.
    """
    pairs = (f.shape[-1] - 1) // 2
    if not (pairs > 0 and places[0] >= 0 and places[-1] <= 2 * pairs + _ROUNDING):
        raise ValueError(
            f"places {places[0]:g} … {places[-1]:g} leave the pairs of intervals 0 … {2 * pairs}"
        )
    first, middle, last = f[..., : 2 * pairs : 2], f[..., 1 : 2 * pairs : 2], f[..., 2::2]
    whole = np.cumsum((first + 4.0 * middle + last) / 3.0, axis=-1)
    j = np.minimum(places // 2.0, pairs - 1).astype(np.intp)
    first, middle, last, u = first[..., j], middle[..., j], last[..., j], places - 2.0 * j
    before = np.where(j > 0, whole[..., j - 1], 0.0)
    slope, bend = 4.0 * middle - 3.0 * first - last, first - 2.0 * middle + last
    reached = before + u * (first + u * (slope / 4.0 + u * bend / 6.0))
    return np.asarray(dt * np.diff(reached, axis=-1))


def _cubic_part(f: NDArray[Any], start: float, stop: float) -> Any:
    """∫ of the cubic through the four samples around [start, stop], a range within one or two intervals."""
    if start == stop:
        return 0.0
    first = min(max(math.floor(start) - 1, 0), f.size - 4)
    coefficients = np.linalg.solve(np.vander(np.arange(4.0), increasing=True), f[first : first + 4])
    powers = np.arange(1, 5)
    return coefficients @ (((stop - first) ** powers - (start - first) ** powers) / powers)
