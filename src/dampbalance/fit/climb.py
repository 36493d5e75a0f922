"""Levenberg–Marquardt steps towards the least sum of squares of residuals, with limits on the unknowns: one climb for
forced records, free decays and their laws.

Use it where the noise is Gaussian: half the sum of squares of r = (model − data)/σ is then −log L up to a constant. At
a point p with residuals r and derivatives J a step solves

    (JᵀJ + λ diag JᵀJ) δ = −Jᵀr

over the unknowns that the gradient does not hold at a limit. λ falls after a step that helps and rises after one that
does not. The climb ends when a full step (λ ≈ 0) would gain less than a given amount in −log L, or would move no
unknown by more than 10⁻¹¹ of itself, where no step helps (−log L has kinks, as where the onset of slip passes a
sample), and after a number of evaluations.

Normal equations hold half of the digits of a factorisation of J. That suffices: the gradient Jᵀr, which says where the
climb ends, is exact, and only the steps towards there are approximate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Integers
from ..jit import jit
from .parameters import Limits, Parameters

MOST_EVALUATIONS = 30
"""Default limit on the evaluations of a climb: one to where the records are takes about ten."""

GAIN = 5e-8
"""Default of what a full step must promise in −log L: less than 4·10⁻⁴ of a standard error is then left."""

_RIDGE = 1e-13  # of the diagonal of the information, in which rounding is as large
_RELATIVE = 1e-11
_STALLED = 1e-7  # of an unknown: rounding may refuse a step below this
_STEEPEST = 1e10  # damping at which no step has helped
# Unless zero is allowed, no positive unknown falls below this part of itself in one step.
_SHRINK = 0.2


@dataclass(frozen=True, eq=False)
class Climb:
    """Where a climb ended, the products there, and the number of evaluations.

    parameters : where it ended.   products : (p + 1, p + 1), JᵀJ bordered by Jᵀr, with χ² = rᵀr in the last corner.
    promise : what a full step from there would gain in −log L, were the residuals linear: little at an optimum.
    """

    parameters: Parameters
    products: Array
    evaluations: int
    promise: float

    @property
    def point(self) -> Array:
        """The values of the parameters, (p,)."""
        return self.parameters.values

    @property
    def chi_square(self) -> float:
        """Sum of the squares of the residuals."""
        return float(self.products[-1, -1])


def climb(
    evaluate: Callable[[Array, Array], bool],
    start: Parameters,
    *,
    gain: float = GAIN,
    most: int = MOST_EVALUATIONS,
    known: Array | None = None,
) -> Climb | None:
    """Maximise the likelihood from `start`; None where the model does not apply there.

    evaluate : sets its second argument to the products at a point, see `Climb`; false where the model does not apply.
    gain : what a full step must promise in −log L for the climb to go on.
    most : evaluations after which the climb ends wherever it is.   known : the products at the start, if they are.
    """
    limits, first = start.limits, start.values
    within = np.minimum(np.maximum(first, limits.low), limits.high)
    point, trial = np.where(limits.free, within, first), np.empty(first.size)
    here, there = np.empty((2, first.size + 1, first.size + 1))
    if known is not None:
        here[:] = known
    elif not evaluate(point, here):
        return None
    damping, count = 1e-3, int(known is None)
    while True:
        promise, size = _step(point, here, damping, limits, trial)
        if count >= most or not promise >= gain or size < _RELATIVE:
            break
        count += 1
        if evaluate(trial, there) and there[-1, -1] < here[-1, -1]:
            point, trial, here, there = trial, point, there, here
            damping = max(0.1 * damping, 1e-12)
        elif size < _STALLED or damping >= _STEEPEST:
            break
        else:
            damping = max(10.0 * damping, 1e-6)
    return Climb(start.at(point), here, count, promise)


@jit
def _step(
    point: Array, products: Array, damping: float, limits: Limits, trial: Array
) -> tuple[float, float]:
    """Return what a full step promises in −log L, and its largest change of an unknown relative to it; `trial` receives
    the point after a damped step."""
    p = point.size
    moving, n = np.empty(p, dtype=np.int64), 0
    for j in range(p):
        trial[j] = point[j]
        falls, rises = products[j, p] >= 0.0, products[j, p] <= 0.0
        held = (point[j] <= limits.low[j] and falls) or (point[j] >= limits.high[j] and rises)
        if limits.free[j] and not held and products[j, j] > 0.0:
            moving[n] = j
            n += 1
    full = _damped(products, moving[:n], 0.0)
    damped = _damped(products, moving[:n], damping)
    promise = size = 0.0
    for i in range(n):
        j = moving[i]
        promise -= 0.5 * full[i] * products[j, p]
        size = max(size, abs(full[i]) / max(abs(point[j]), limits.scale[j]))
        least = limits.low[j]
        if least > 0.0:
            least = max(least, _SHRINK * point[j])
        trial[j] = min(max(point[j] + damped[i], least), limits.high[j])
    return promise, size


@jit
def _damped(products: Array, moving: Integers, damping: float) -> Array:
    """Return the solution of the damped equations in the unknowns that move, by Cholesky's factorisation of their
    information scaled to unit diagonal."""
    n, p = moving.size, products.shape[0] - 1
    root, step, length = np.zeros((n, n)), np.empty(n), np.empty(n)
    for i in range(n):
        length[i] = math.sqrt(products[moving[i], moving[i]])
        for j in range(i + 1):
            entry = products[moving[i], moving[j]] / length[i] / length[j]
            for l in range(j):
                entry -= root[i, l] * root[j, l]
            if j < i:
                root[i, j] = entry / root[j, j]
            else:
                root[i, i] = math.sqrt(max(entry + max(damping, _RIDGE), _RIDGE))
        step[i] = -products[moving[i], p] / length[i]
        for l in range(i):
            step[i] -= root[i, l] * step[l]
        step[i] /= root[i, i]
    for i in range(n - 1, -1, -1):
        for l in range(i + 1, n):
            step[i] -= root[l, i] * step[l]
        step[i] /= root[i, i]
    for i in range(n):
        step[i] /= length[i]
    return step
