"""Levenberg–Marquardt steps towards the maximum of a likelihood, with limits on the unknowns.

At a point p the caller gives −log L, its information I and its gradient g = −∂(−log L)/∂p. A step solves

    (I + λ diag I) δ = g

over the unknowns that the gradient does not hold at a limit. λ falls after a step that helps, and rises after
one that does not. The climb ends when a full step (λ ≈ 0) would gain less than a given amount in −log L: 10⁻⁸ unless
the caller says otherwise, that is, move less than 10⁻⁴ of a standard error; or no unknown by more than 10⁻¹¹ of itself.
−log L may have kinks, as where the onset of slip passes a sample: a maximum at a kink, where no step helps, counts as
one if a full step promises less than 0.005, that is, a tenth of a standard error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Self, TypeVar

import numpy as np

from ..arrays import Array, Mask

MOST = 100
"""Evaluations of a climb, at the most."""

_GAIN = 1e-8
_RELATIVE = 1e-11
_KINK = 5e-3
_STALLED = 1e-7  # of an unknown: rounding may refuse a step below this
# Unless zero is allowed, no positive unknown falls below this part of itself in one step.
_SHRINK = 0.2


class NoStart(ValueError):
    """The model does not apply where the climb starts."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """−log L at a point, information (p, p) and gradient (p,).

    residual, jacobian : where −log L is half the sum of squares of (n,) residuals, these and their derivatives (n, p):
    a step from them keeps the digits that the information, JᵀJ, has lost.
    """

    value: float
    information: Array
    gradient: Array
    residual: Array | None = None
    jacobian: Array | None = None

    @classmethod
    def of_residuals(cls, residual: Array, jacobian: Array) -> Self:
        """That of half the sum of squares of residuals."""
        value, gradient = 0.5 * float(residual @ residual), -jacobian.T @ residual
        return cls(value, jacobian.T @ jacobian, gradient, residual, jacobian)


E = TypeVar("E", bound=Evaluation)


@dataclass(frozen=True, eq=False)
class Climb(Generic[E]):
    """Where a climb ended.

    active : which unknowns are held at a limit.   step : the next one, not taken.
    """

    point: Array
    evaluation: E
    active: Mask
    step: Array
    iterations: int


class NoConvergence(ArithmeticError):
    """The likelihood has no maximum within reach of the start; `best` is the best point on the way."""

    def __init__(self, message: str, best: Climb[Any]) -> None:
        super().__init__(message)
        self.best = best


def climb(
    evaluate: Callable[[Array], E | None],
    start: Array,
    lower: Array,
    scale: Array,
    upper: Array | float = math.inf,
    *,
    gain: float = _GAIN,
    most: int = MOST,
) -> Climb[E]:
    """Maximise the likelihood from `start`.

    evaluate : None where the model does not apply.
    lower : least value of each unknown, −∞ for one that may be negative, a phase or a logarithm.
    scale : below it an unknown counts as zero, and steps are measured against it.   upper : greatest values.
    gain : what a full step must promise in −log L for the climb to go on.   most : evaluations.

    Raises NoStart; NoConvergence where no step helps or too many are needed.
    """
    point = np.clip(start, lower, upper)
    here = evaluate(point)
    if here is None:
        raise NoStart("the model does not apply where the climb starts")
    signed = np.isneginf(lower)
    damping = 1e-3
    for count in range(1, most + 1):
        active = (point <= lower) & (here.gradient <= 0.0)
        active |= (point >= upper) & (here.gradient >= 0.0)
        full = _step(here, active, 0.0)
        step = _step(here, active, damping)
        size = float(np.max(np.abs(full) / np.maximum(np.abs(point), scale)))
        reached = Climb(point, here, active, step, count)
        if full @ here.gradient < 2.0 * gain or size < _RELATIVE:
            return reached
        least = np.where(signed | (lower == 0.0), lower, np.maximum(lower, _SHRINK * point))
        trial = np.clip(point + step, least, upper)
        there = evaluate(trial)
        if there is not None and there.value < here.value:
            point, here = trial, there
            damping = max(damping * 0.1, 1e-12)
        elif size < _STALLED:
            return reached
        else:
            damping = max(10.0 * damping, 1e-6)
        if damping > 1e10:
            if full @ here.gradient < 2.0 * _KINK:
                return reached
            break
    raise NoConvergence(
        f"the fit did not converge ({count} iterations, the last step {size:.1g} of the unknowns): check m, k, ω and "
        "the channels' units, or give a start closer to the answer",
        reached,
    )


def _step(here: Evaluation, active: Mask, damping: float) -> Array:
    """Solution of the damped equations in the unknowns that are not active, scaled to unit diagonal."""
    free = np.flatnonzero(~active)
    diagonal = np.sqrt(np.diag(here.information)[free])
    diagonal[diagonal == 0.0] = 1.0
    if here.residual is not None and here.jacobian is not None:
        matrix = np.vstack(
            [here.jacobian[:, free] / diagonal, math.sqrt(damping) * np.eye(free.size)]
        )
        right = np.concatenate([-here.residual, np.zeros(free.size)])
    else:
        matrix = here.information[np.ix_(free, free)] / np.outer(diagonal, diagonal)
        matrix[np.diag_indices_from(matrix)] += damping
        right = here.gradient[free] / diagonal
    step = np.zeros(active.size)
    step[free] = np.linalg.lstsq(matrix, right, rcond=1e-14)[0] / diagonal
    return step
