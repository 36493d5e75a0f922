"""Levenberg–Marquardt steps for a likelihood, with lower limits on the unknowns.

At a point p the caller gives −log L, its information I and its gradient g = −∂(−log L)/∂p. A step solves

    (I + λ diag I) δ = g

over the unknowns that are not held at their limit by the gradient. λ falls after a step that helps, and rises after one
that does not. The climb ends when a full step (λ ≈ 0) would gain less than 10⁻⁸ in −log L, that is, move less than
10⁻⁴ of a standard error, or no unknown by more than 10⁻¹¹ of itself. −log L has kinks, where the onset of slip
passes a sample: a maximum at a kink, where no step helps, is one if a full step promises less than 0.005, that is, a
tenth of a standard error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..motion.orbit import NoSteadyOrbit

Array = NDArray[np.float64]

_MOST = 100  # evaluations
_GAIN = 1e-8
_RELATIVE = 1e-11
_KINK = 5e-3
_STALLED = 1e-7  # of an unknown: rounding may refuse a step below this
_SHRINK = (
    0.2  # no positive unknown falls below this part of itself in one step, unless zero is allowed
)


class NoConvergence(ArithmeticError):
    """The likelihood has no maximum within reach of the start."""


class Evaluation(NamedTuple):
    """−log L (infinite where the model does not apply), information (p, p) and gradient (p,)."""

    value: float
    information: Array
    gradient: Array


class Climb(NamedTuple):
    """Where a climb ended; `active` marks the unknowns at their lower limit."""

    point: Array
    evaluation: Evaluation
    active: NDArray[np.bool_]
    iterations: int


def climb(
    evaluate: Callable[[Array], Evaluation], start: Array, lower: Array, scale: Array
) -> Climb:
    """Maximise the likelihood from `start`.

    lower : least value of each unknown, −∞ for a phase.   scale : below it an unknown counts as zero, and steps are
    measured against it.

    Raises ValueError where nothing slips at the start; NoConvergence where no step helps or too many are needed.
    """
    point = np.maximum(start, lower)
    here = _evaluated(evaluate, point)
    if not math.isfinite(here.value):
        raise ValueError(
            "nothing slips in any record with the F_k, c and K_z of the start, or it has no steady orbit; start with a "
            "smaller F_k, or leave the start to the fit"
        )
    signed = np.isneginf(lower)  # a phase
    damping = 1e-3
    for count in range(1, _MOST + 1):
        active = (point <= lower) & (here.gradient <= 0.0)
        full = _step(here, active, 0.0)
        step = _step(here, active, damping)
        size = float(np.max(np.abs(full) / np.maximum(np.abs(point), scale)))
        if full @ here.gradient < 2.0 * _GAIN or size < _RELATIVE:
            return Climb(point, here, active, count)
        least = np.where(signed | (lower == 0.0), lower, np.maximum(lower, _SHRINK * point))
        trial = np.maximum(point + step, least)
        there = _evaluated(evaluate, trial)
        if there.value < here.value:
            point, here = trial, there
            damping = max(damping * 0.1, 1e-12)
        elif size < _STALLED:
            return Climb(point, here, active, count)
        else:
            damping *= 10.0
        if damping > 1e10:
            if full @ here.gradient < 2.0 * _KINK:
                return Climb(point, here, active, count)
            break
    raise NoConvergence(
        f"the fit did not converge ({count} iterations, the last step {size:.1g} of the unknowns): check m, k, ω and "
        "the channels' units, or give a start closer to the answer"
    )


def _evaluated(evaluate: Callable[[Array], Evaluation], point: Array) -> Evaluation:
    """The evaluation, or an infinite −log L where there is no orbit."""
    try:
        return evaluate(point)
    except NoSteadyOrbit:
        blank = np.zeros((point.size, point.size))
        return Evaluation(math.inf, blank, blank[0])


def _step(here: Evaluation, active: NDArray[np.bool_], damping: float) -> Array:
    """Solution of the damped equations in the unknowns that are not active, scaled to unit diagonal."""
    free = np.flatnonzero(~active)
    diagonal = np.sqrt(np.diag(here.information)[free])
    diagonal[diagonal == 0.0] = 1.0
    scaled = here.information[np.ix_(free, free)] / np.outer(diagonal, diagonal)
    scaled[np.diag_indices_from(scaled)] += damping
    step = np.zeros(active.size)
    solution = np.linalg.lstsq(scaled, here.gradient[free] / diagonal, rcond=1e-14)[0]
    step[free] = solution / diagonal
    return step
