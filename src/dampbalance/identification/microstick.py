"""The microstick line, whose length X + X_s = 2F_k/K_z (10) is the same for all records of a contact.

The weighted mean of the records' own lengths serves each of them, also those that do not resolve it alone. Where the
mean does not stand out of its noise either, the contact is taken as rigid.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Mask
from ..features import Features, stack
from ..reading.noisy import RESOLVED, Reading
from ..reading.onset import Waveform
from .result import Microstick


@dataclass(frozen=True, eq=False)
class SharedLine:
    """Features of n records with the microstick line that they share.

    microstick : its length, error and bound.   length : the one in use, m, 0 for a rigid contact; drawn_length : of the
    r replicates, (r,), and left_lengths without each group of cycles of the record j, (g_j,).
    point : features as read, (n,).   drawn : of the replicates, (n, r).   left : without groups of cycles of the record
    j, (n, g_j) for each j.   fitted : whether a waveform was fitted, so that V_s and t_s were read, (n,).
    """

    microstick: Microstick
    length: float
    drawn_length: Array
    left_lengths: tuple[Array, ...]
    point: Features
    drawn: Features
    left: tuple[Features, ...]
    fitted: Mask


def share_line(
    readings: Sequence[Reading], drawn: Sequence[Features], left: Sequence[Features] = ()
) -> SharedLine:
    """Give all records the weighted mean of their microstick lengths, or none where it is not resolved.

    drawn : replicates of each reading, (r,).   left : jackknife replicates of each, (g,); or none.
    """
    points = stack([reading.with_onset(True) for reading in readings])
    replicates = stack([features[None] for features in drawn])
    fitted = np.array([reading.waveform is not None for reading in readings])
    weights = _weights(readings)
    own = points.X + points.X_s
    length = float(_weighted(weights, own))
    drawn_length = _weighted(weights, replicates.X + replicates.X_s)
    left_lengths = tuple(
        length + weight * (f.X + f.X_s - at)
        for weight, f, at in zip(weights, left, own, strict=False)
    )
    microstick = _microstick(readings, length, drawn_length)
    if not microstick.resolved:
        length, drawn_length = 0.0, 0.0 * drawn_length
        left_lengths = tuple(0.0 * lengths for lengths in left_lengths)
    return SharedLine(
        microstick,
        length,
        drawn_length,
        left_lengths,
        with_length(points, length, fitted),
        with_length(replicates, drawn_length, fitted[:, None]),
        tuple(
            with_length(_replaced(points, j, f), lengths, fitted[:, None])
            for j, (f, lengths) in enumerate(zip(left, left_lengths, strict=True))
        ),
        fitted,
    )


def with_length(features: Features, length: float | Array, fitted: Mask) -> Features:
    """The features with the shared length of the microstick line: X_s = L − X, a = 2(X − X_s).

    length : m; 0 for a rigid contact.   fitted : whether V_s and t_s were read; a contact that is not rigid has others
    than 0, which are then unknown.
    """
    if not np.any(length):
        return features.rigid()
    X_s = length - features.X
    onset = {
        name: np.where(fitted, getattr(features, name), np.nan)
        for name in ("V_s", "t_s", "V_r", "t_r")
    }
    return features.replaced(X_s=X_s, X_r=-X_s, a=2.0 * (features.X - X_s), **onset)


def _replaced(points: Features, record: int, left: Features) -> Features:
    """Each record as read, except one, which stands with its jackknife replicates: (n, g)."""
    others = points[:, None][:, [0] * len(left)]
    return stack([others[:record], left[None], others[record + 1 :]])


def _weighted(weights: Array, values: Array) -> Array:
    """Σ w_i values_i over the records, in their order."""
    return np.asarray(sum(w * value for w, value in zip(weights, values, strict=True)))


def _weights(readings: Sequence[Reading]) -> Array:
    """Weight of each record's microstick length in their mean; 0 where no waveform was fitted.

    The standard error of a length grows with the root of the length found. Inverse variances at one common length,
    L_i/σ_i², do not favour the records that happen to find a short one.
    """
    precision = np.array(
        [_length(r.waveform) / r.waveform.length_error**2 if r.waveform else 0.0 for r in readings]
    )
    total = precision.sum()
    weights: Array = precision / total if total > 0.0 else precision
    return weights


def _length(waveform: Waveform) -> float:
    """Length of the microstick line of the fitted waveform itself, m."""
    return waveform.orbit.X + waveform.orbit.X_s


def _microstick(readings: Sequence[Reading], length: float, drawn: Array) -> Microstick:
    """The shared length, and whether it stands out of the scatter of its replicates."""
    waveforms = [r.waveform for r in readings if r.waveform is not None]
    if not waveforms:
        return Microstick(math.nan, math.nan, False, math.nan, math.nan)
    error = float(drawn.std(ddof=1))
    resolved = length > RESOLVED * error
    misfit = math.nan
    if len(waveforms) > 1 and resolved:
        apart = [
            (w.length - length) ** 2 * _length(w) / (length * w.length_error**2) for w in waveforms
        ]
        misfit = math.fsum(apart) / (len(waveforms) - 1)
    bound = max(length, 0.0) + 1.96 * error
    if not resolved:
        bound = min(bound, *(w.length_bound for w in waveforms))
    return Microstick(length, error, resolved, bound, misfit)
