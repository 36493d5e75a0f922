"""Integrals of samples between arbitrary places, by Simpson's rule."""

from __future__ import annotations

import numpy as np

from ..arrays import Array


def integrals(f: Array, dt: float, places: Array) -> Array:
    """Return ∫ f dt from each place to the next by Simpson's rule, shape (…, p − 1).

    Each parabola through the samples 2j, 2j + 1, 2j + 2 is integrated as far as the places reach into it. The error is
    O(dt⁴) for a smooth f.

    f : samples, shape (…, n ≥ 3).   dt : s.   places : ascending, in samples counted from 0, up to the end of the last
    pair of intervals, shape (p,).
    """
    end = (f.shape[-1] - 1) // 2 * 2
    first, middle, last = f[..., :end:2], f[..., 1:end:2], f[..., 2 : end + 1 : 2]
    # integral up to each pair, in samples
    whole = np.zeros((*f.shape[:-1], end // 2 + 1))
    np.cumsum((first + 4.0 * middle + last) / 3.0, axis=-1, out=whole[..., 1:])
    pair = np.minimum(places.astype(np.intp) // 2, end // 2 - 1)
    into = places - 2.0 * pair
    first, middle, last = first[..., pair], middle[..., pair], last[..., pair]
    bend, slope = first - 2.0 * middle + last, 4.0 * middle - 3.0 * first - last
    within = into * (first + into * (slope / 4.0 + into * bend / 6.0))
    return dt * np.diff(whole[..., pair] + within)
