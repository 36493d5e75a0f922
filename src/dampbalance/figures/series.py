"""Axes for errors and for logarithmic values, and the two ways of sharing φ and t_s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array

COMMON, INDIVIDUAL = "common", "individual"
SHARINGS = {INDIVIDUAL: r"own $\varphi$, $t_s$", COMMON: r"mean $\varphi$, $t_s$"}
"""Whether levels share φ and t_s, as legends say it: each level's own, or the mean of all levels."""
EXACT = 1e-5  # %: an approach nowhere worse than this is exact to rounding (which uneven levels magnify)


def decades(
    sizes: Sequence[Array], floor: float = 0.0, ceiling: float = math.inf, cut: float = 0.0
) -> tuple[float, float]:
    """Return limits of a logarithmic axis: whole decades around sizes, within bounds.

    cut : share of the sizes, the smallest, that may lie below the axis.
    """
    known = np.concatenate([np.empty(0), *sizes])
    known = known[np.isfinite(known) & (known > 0.0)]
    low, high = (np.quantile(known, cut), known.max()) if known.size else (0.1, 10.0)
    bottom = max(floor, 10.0 ** math.floor(math.log10(low)))
    return bottom, max(10.0 * bottom, min(ceiling, 10.0 ** math.ceil(math.log10(high))))


class SignedScale(NamedTuple):
    """An axis of errors of either sign: linear within ±linear, logarithmic beyond, from low to high; all are powers of
    ten, low a negative one."""

    linear: float
    low: float
    high: float

    @property
    def ticks(self) -> list[float]:
        """Zero and, of either sign, the powers of ten."""
        first = round(math.log10(self.linear))
        sides = (-self.low, self.high)
        below, above = (range(first, round(math.log10(side)) + 1) for side in sides)
        powers = [-float(f"1e{power}") for power in reversed(below)]
        return [*powers, 0.0, *(float(f"1e{power}") for power in above)]


def signed_scale(
    errors: Sequence[Array], floor: float, ceiling: float, cut: float = 0.0
) -> SignedScale:
    """Return the axis that holds errors, whole decades around those of either sign; the arguments are those of
    `decades`."""
    linear, top = decades([np.abs(some) for some in errors], floor, ceiling, cut)
    known = np.concatenate([np.empty(0), *errors])
    known = known[np.isfinite(known)]
    sides = (
        max(linear, known.max(initial=0.0, where=known > 0.0)),
        max(linear, -known.min(initial=0.0)),
    )
    high, low = (min(top, 10.0 ** math.ceil(math.log10(side) - 1e-9)) for side in sides)
    return SignedScale(linear, -low, high)


def is_logarithmic(places: Sequence[float] | Array) -> bool:
    """Return whether the logarithms of values, in ascending order, are spread evenly rather than the values
    themselves."""
    if len(places) < 3 or places[0] <= 0.0 or places[-1] / places[0] < 5.0:
        return False
    return is_even(np.log(places))


def is_even(places: Array) -> bool:
    """Return whether most steps between values, in ascending order, are alike; single values in between do not
    matter."""
    steps = np.diff(places)
    usual = np.median(steps)
    return bool(np.median(np.abs(steps - usual)) < 0.05 * usual)
