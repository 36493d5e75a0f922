"""Joint fit of one oscillator to all bursts of all records, starting from the separate fits."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..motion.events import PHASE_S
from .ringdown_fit import RingFit, fit_stretches
from .ringdown_motion import COMMON, STATE, Stretch
from .ringdown_starts import refit_from_other_starts

_MOST_TURNS = 4  # half cycles that slip, of a burst that may be the work of a hand


def joint_start(fits: Sequence[RingFit], offsets: int) -> Array:
    """Start point of the joint fit: the common unknowns averaged, weighted by their information, the rest unchanged.

    offsets : how many there are in all.
    """
    size = len(COMMON)
    information, right = np.zeros((size, size)), np.zeros(size)
    levels, weights = np.zeros(offsets), np.zeros(offsets)
    k, m = fits[0].k, fits[0].m
    unit = np.array([fits[0].F_k, 1e-2 * math.sqrt(k * m), 1e-1 / math.sqrt(k), m])
    for fit in fits:
        scaled = fit.covariance[:size, :size] / np.outer(unit, unit)
        one = np.linalg.pinv(scaled, rcond=1e-12, hermitian=True)
        information += one
        right += one @ (fit.point[:size] / unit)
        for number in fit.stretches[0].offsets:
            levels[number] += fit.point[size + number] * fit.stretches[0].samples
            weights[number] += fit.stretches[0].samples
    common = unit * np.linalg.lstsq(information, right)[0]
    if not (common > 0.0).all():
        common = max(fits, key=lambda fit: fit.stretches[0].samples).point[:size]
    levels = levels / np.maximum(weights, 1.0)
    return np.concatenate([common, levels, *(fit.point[-STATE:] for fit in fits)])


def fit_all(fits: Sequence[RingFit], offsets: int) -> tuple[RingFit | None, list[Stretch]]:
    """One oscillator for the bursts with these separate fits, and the stretches that are not decays of it.

    A hand that moves the mass from one place to another can look like half a cycle of another oscillator. Where no
    oscillator fits all bursts, as few as possible are left out, those that slip least first, if one then fits the rest.
    """
    whole = _joined(fits, offsets)
    if whole is not None and whole.doubtful:
        # from the oscillator of each alone, and from other shares of friction
        others = [_joined(fits, offsets, fit.point[: len(COMMON)]) for fit in fits]
        whole = min(
            (refit_from_other_starts(whole), *(other for other in others if other is not None)),
            key=lambda one: one.chi_square,
        )
    if whole is None or whole.adequate or len(fits) == 1:
        return whole, []
    turns = [int(np.count_nonzero(fit.phases(0)[:, PHASE_S])) for fit in fits]
    order = np.argsort(turns, kind="stable").tolist()
    for count in range(1, len(fits)):
        if turns[order[count - 1]] > _MOST_TURNS:
            break
        for some in itertools.combinations(order[: count + 1], count):
            rest = [fit for i, fit in enumerate(fits) if i not in some]
            if any(turns[i] > _MOST_TURNS for i in some):
                continue
            fit = _joined(rest, offsets)
            if fit is not None and fit.adequate:
                return fit, [fits[i].stretches[0] for i in sorted(some)]
    return whole, []


def _joined(fits: Sequence[RingFit], offsets: int, common: Array | None = None) -> RingFit | None:
    """The fit of all bursts.   common : common unknowns of the start, instead of the weighted mean."""
    stretches = [fit.stretches[0] for fit in fits]
    start = joint_start(fits, offsets)
    if common is not None:
        start[: len(COMMON)] = common
    return fit_stretches(stretches, fits[0].k, start)
