"""From blocks of axes to the values of any stretch of cases, without ever making a list of all cases.

The cases of a study are the product of its blocks, the last block running fastest. A block is one axis, several paired
(zipped) axes of equal length, or a sample of points in the box that several parameters span.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..arrays import Array, Integers, Mask, Words

# 2³² points at most; with more bits scipy cannot skip to the first point of a chunk.
SOBOL_BITS = 32
SAME = 1e-12  # relative: values of an axis that differ by less are equal except for rounding
Spacing = Literal["linear", "log"]


@dataclass(frozen=True)
class Listed:
    """Paired axes: name → values, all of the same length. A plain axis has one name."""

    values: Mapping[str, Sequence[float | int | str]]

    @property
    def count(self) -> int:
        """The number of points in the block."""
        return len(next(iter(self.values.values())))

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that the block sets."""
        return tuple(self.values)

    def at(self, index: Integers) -> dict[str, Words]:
        """The values of each parameter at the points `index`."""
        return {name: np.asarray(values)[index] for name, values in self.values.items()}


@dataclass(frozen=True)
class Range:
    """Bounds of one parameter of a sample; `spacing` says whether the values or their logarithms are spread evenly."""

    low: float
    high: float
    spacing: Spacing

    def at(self, share: Array) -> Array:
        """The value at a share 0 … 1 of the way from low to high."""
        if self.spacing == "linear":
            return np.asarray(self.low + share * (self.high - self.low))
        low, high = math.log(self.low), math.log(self.high)
        return np.clip(np.exp(low + share * (high - low)), self.low, self.high)


@dataclass(frozen=True)
class Sampled:
    """Points in the box of `ranges`: a scrambled Sobol sequence, or independent random ones.

    The points depend only on method, seed and their place in the sequence: any stretch can be computed by itself.
    """

    method: Literal["sobol", "random"]
    count: int
    seed: int
    ranges: Mapping[str, Range]

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that the block sets."""
        return tuple(self.ranges)

    def at(self, index: Integers) -> dict[str, Words]:
        """The values of each parameter at the points `index`."""
        if index.size == 0:
            return {name: np.empty(0) for name in self.ranges}
        first = int(index.min())
        shares = self._shares(first, int(index.max()) - first + 1)[index - first]
        return {
            name: limits.at(shares[:, i]) for i, (name, limits) in enumerate(self.ranges.items())
        }

    def _shares(self, start: int, count: int) -> Array:
        dimension = len(self.ranges)
        if self.method == "random":
            bits = np.random.PCG64(self.seed).advance(start * dimension)  # one draw a number
            return np.random.Generator(bits).random((count, dimension))
        from scipy.stats import qmc  # slow to import: longer than a chunk takes to compute

        points = qmc.Sobol(dimension, scramble=True, bits=SOBOL_BITS, rng=self.seed)
        if start:
            points.fast_forward(start)
        with warnings.catch_warnings():  # the whole sequence matters, not the length of a stretch
            warnings.filterwarnings("ignore", "The balance properties", UserWarning)
            return np.asarray(points.random(count), dtype=np.float64)


Block = Listed | Sampled


def case_values(blocks: Sequence[Block], start: int, stop: int) -> dict[str, Words]:
    """The value of every axis in the cases start … stop − 1, each an array of length stop − start."""
    remaining = np.arange(start, stop, dtype=np.int64)
    values: dict[str, Words] = {}
    for block in reversed(blocks):
        remaining, index = np.divmod(remaining, block.count)
        values = block.at(index) | values
    return values


def spread(spec: Mapping[str, Any]) -> list[float]:
    """The values of an axis that is given by its ends, which it includes, and their number: evenly spaced themselves or
    in their logarithms, with further values, `also`, in ascending order; such a value replaces one that equals it
    except for rounding."""
    spaced = np.geomspace if spec.get("spacing") == "log" else np.linspace
    values = spaced(float(spec["from"]), float(spec["to"]), spec["count"]).tolist()
    if "also" not in spec:
        return values
    also = np.array(spec["also"], float)
    return sorted([*(x for x in values if not is_value(also, x).any()), *also.tolist()])


def is_value(values: Words, wanted: float) -> Mask:
    """Which values equal the wanted one, except for rounding."""
    return np.abs(values.astype(float) - wanted) <= SAME * abs(wanted)


def selected(values: Mapping[str, Words], spec: Mapping[str, Any]) -> Mask:
    """Which points have the values of axes that a fact or a figure names in `at`, and lie in its bounds, `between`;
    axes that have no values here do not count."""
    kept = np.ones(len(next(iter(values.values()))), dtype=bool)
    for name, wanted in spec.get("at", {}).items():
        if name in values:
            here = values[name]
            kept &= here == wanted if isinstance(wanted, str) else is_value(here, wanted)
    for name, (low, high) in spec.get("between", {}).items():
        if name in values:
            kept &= (values[name] >= low) & (values[name] <= high)
    return kept
