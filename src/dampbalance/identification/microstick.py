"""The microstick line, whose length X + X_s = 2F_k/K_z (10) is the same for all records of a contact.

The weighted mean of the records' own lengths serves each of them, also those that do not resolve it alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..features import Features
from ..reading.noisy import RESOLVED, Reading
from ..reading.onset import Waveform
from .result import Microstick

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Lengths:
    """Shared length of the microstick line, m: as estimated (1,), of the bootstrap (r,), and without each group of
    cycles of the record j, (g,) for each j."""

    point: Array
    drawn: Array
    left: tuple[Array, ...]

    @classmethod
    def of(
        cls,
        points: Sequence[Features],
        drawn: Sequence[Features],
        left: Sequence[Features],
        weights: Array,
    ) -> Lengths:
        """Weighted means. points, drawn : a response, and r replicates, per record.   left : per record, or empty."""
        each = [f.X + f.X_s for f in points]
        point = np.atleast_1d(sum(w * length for w, length in zip(weights, each, strict=True)))
        return cls(
            point=point,
            drawn=np.asarray(sum(w * (f.X + f.X_s) for w, f in zip(weights, drawn, strict=True))),
            left=tuple(point + weights[j] * (f.X + f.X_s - each[j]) for j, f in enumerate(left)),
        )

    @classmethod
    def rigid(cls, like: Lengths) -> Lengths:
        """No length at all."""
        return cls(0.0 * like.point, 0.0 * like.drawn, tuple(0.0 * a for a in like.left))


def weights_of(readings: Sequence[Reading]) -> Array:
    """Weight of each record's microstick length in their mean; 0 where no waveform was fitted.

    The standard error of a length grows with the root of the length found. Inverse variances at one common length,
    L_i/σ_i², do not favour the records that happen to find a short one.
    """
    precision = np.array(
        [
            0.0 if r.waveform is None else _found(r.waveform) / r.waveform.length_error**2
            for r in readings
        ]
    )
    total = precision.sum()
    weights: Array = precision / total if total > 0.0 else precision
    return weights


def _found(waveform: Waveform) -> float:
    """Length of the microstick line of the fitted waveform itself, m."""
    return waveform.orbit.X + waveform.orbit.X_s


def microstick_of(readings: Sequence[Reading], lengths: Lengths) -> Microstick:
    """The shared length, and whether it is resolved."""
    waveforms = [r.waveform for r in readings if r.waveform is not None]
    if not waveforms:
        return Microstick(math.nan, math.nan, False, math.nan, math.nan)
    length, error = float(lengths.point[0]), float(lengths.drawn.std(ddof=1))
    resolved = length > RESOLVED * error
    misfit = math.nan
    if len(waveforms) > 1 and resolved:
        apart = [
            (w.length - length) ** 2 * _found(w) / (length * w.length_error**2) for w in waveforms
        ]
        misfit = math.fsum(apart) / (len(waveforms) - 1)
    bound = max(length, 0.0) + 1.96 * error
    if not resolved:
        bound = min(bound, *(w.length_bound for w in waveforms))
    return Microstick(length, error, resolved, bound, misfit)


def with_length(features: Features, length: Array, known: bool) -> Features:
    """The features with the shared length of the microstick line: X_s = L − X, a = 2(X − X_s).

    length : m, (1,) or one per response.   known : whether V_s and t_s were read; a contact that is not rigid has
    others than 0.
    """
    count = max(len(features), length.size)
    if len(features) < count:
        features = features.take([0] * count)
    X_s = length - features.X
    changed: dict[str, ArrayLike] = {
        "X_s": X_s,
        "X_r": -X_s,
        "a": 2.0 * (features.X - X_s),
    }
    if not length.any():
        changed |= dict.fromkeys(("V_s", "t_s", "V_r", "t_r"), 0.0)
    elif not known:
        changed |= dict.fromkeys(("V_s", "t_s", "V_r", "t_r"), math.nan)
    return features.replaced(**changed)
