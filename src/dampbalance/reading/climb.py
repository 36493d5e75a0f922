"""Levenberg–Marquardt steps towards the least sum of squares of residuals, with limits on the unknowns, and the fit of
an oscillator that they end in.

Use it where the noise is Gaussian: half the sum of squares of r = (model − data)/σ is then −log L up to a constant. At
a point p with residuals r and derivatives J a step solves

    (JᵀJ + λ diag JᵀJ) δ = −Jᵀr

over the unknowns that the gradient does not hold at a limit. λ falls after a step that helps and rises after one that
does not. The climb ends when a full step (λ ≈ 0) would gain less than a given amount in −log L, or would move no
unknown by more than 10⁻¹¹ of itself, and where no step helps: −log L has kinks, as where the onset of slip passes a
sample.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers, Mask
from ..solver import NORMAL_95

MOST = 30
"""Default limit on the evaluations of a climb: one to where the records are takes about ten."""

GAIN = 5e-8
"""Default of what a full step must promise in −log L: less than 4·10⁻⁴ of a standard error is then left."""

_RELATIVE = 1e-11
_STALLED = 1e-7  # of an unknown: rounding may refuse a step below this
_STEEPEST = 1e10  # damping at which no step has helped
# Unless zero is allowed, no positive unknown falls below this part of itself in one step.
_SHRINK = 0.2


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Residuals (n,) at a point and their derivatives (n, p)."""

    residual: Array
    jacobian: Array

    @property
    def value(self) -> float:
        """Half the sum of squares, −log L."""
        return 0.5 * float(self.residual @ self.residual)

    @cached_property
    def gradient(self) -> Array:
        """Direction of steepest descent, −Jᵀr, (p,)."""
        return -self.jacobian.T @ self.residual

    @cached_property
    def lengths(self) -> Array:
        """Lengths of the columns of J, (p,): square roots of the diagonal of the information JᵀJ."""
        return np.sqrt(np.diag(self.jacobian.T @ self.jacobian))

    def by(self, free: Integers) -> Evaluation:
        """The evaluation with the derivatives by some of the unknowns only."""
        return Evaluation(self.residual, self.jacobian[:, free])


@dataclass(frozen=True, eq=False)
class Climb:
    """The point where a climb ended, (p,), the evaluation there, and the number of evaluations.

    promise : what a full step from there would gain in −log L, were the residuals linear: little at an optimum.
    """

    point: Array
    evaluation: Evaluation
    iterations: int
    promise: float


def climb(
    evaluate: Callable[[Array], Evaluation | None],
    start: Array,
    free: Integers,
    lower: Array,
    scale: Array,
    upper: Array | float = math.inf,
    *,
    gain: float = GAIN,
    most: int = MOST,
) -> Climb | None:
    """Maximise the likelihood from `start`; None where the model does not apply there.

    evaluate : residuals and derivatives at a point, (p,); None where the model does not apply.
    free : numbers of the unknowns that move; the others keep their values.
    lower : least value of each unknown, (p,), −∞ for one that may be negative, a phase or a logarithm.
    scale : size below which an unknown counts as zero, (p,); steps are measured against it.
    upper : greatest values, (p,).
    gain : what a full step must promise in −log L for the climb to go on.
    most : evaluations after which the climb ends wherever it is.
    """

    def moved(values: Array) -> Array:
        point = start.copy()
        point[free] = values
        return point

    lower, scale = lower[free], scale[free]
    upper = np.broadcast_to(upper, start.shape)[free]
    point = np.clip(start[free], lower, upper)
    whole = evaluate(moved(point))
    if whole is None:
        return None
    here = whole.by(free)
    signed = np.isneginf(lower)
    damping = 1e-3
    for count in range(1, most + 1):
        active = (point <= lower) & (here.gradient <= 0.0)
        active |= (point >= upper) & (here.gradient >= 0.0)
        full = _step(here, active, 0.0)
        size = float(np.max(np.abs(full) / np.maximum(np.abs(point), scale)))
        reached = Climb(moved(point), whole, count, 0.5 * float(full @ here.gradient))
        if reached.promise < gain or size < _RELATIVE:
            break
        least = np.where(signed | (lower == 0.0), lower, np.maximum(lower, _SHRINK * point))
        trial = np.clip(point + _step(here, active, damping), least, upper)
        there = evaluate(moved(trial))
        if there is not None and there.value < here.value:
            point, whole, here = trial, there, there.by(free)
            damping = max(damping * 0.1, 1e-12)
        elif size < _STALLED:
            break
        else:
            damping = max(10.0 * damping, 1e-6)
        if damping > _STEEPEST:
            break
    return reached


def _step(here: Evaluation, active: Mask, damping: float) -> Array:
    """Solution of the damped equations in the unknowns that are not active, scaled to unit diagonal.

    By the derivatives themselves: their product, the information, has lost half of the digits.
    """
    free = np.flatnonzero(~active)
    lengths = here.lengths[free]
    lengths[lengths == 0.0] = 1.0
    matrix = np.vstack([here.jacobian[:, free] / lengths, math.sqrt(damping) * np.eye(free.size)])
    right = np.concatenate([-here.residual, np.zeros(free.size)])
    step = np.zeros(active.size)
    step[free] = np.linalg.lstsq(matrix, right, rcond=1e-14)[0] / lengths
    return step


@dataclass(frozen=True, eq=False)
class OscillatorFit(ABC):
    """The oscillator that fits records best: results that every such fit has, whatever the records are.

    k : stiffness, N/m, given.
    point : all p unknowns, SI, (p,), those common to all records first.
    covariance : covariance of the point, (p, p); zero where an unknown was given.
    residual : (model − data)/σ, (n,).
    rigid : whether ρ = K_z^{−1/2} is at its lower limit, which stands for a rigid contact.
    """

    k: float
    point: Array
    covariance: Array
    residual: Array
    rigid: bool

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the common unknowns, in the order of the point."""

    @property
    @abstractmethod
    def misfit(self) -> float:
        """How far the residual is from noise; 1 where it is noise."""

    def value(self, name: str) -> float:
        """A common unknown, in its unit."""
        return float(self.point[self.names.index(name)])

    def error(self, name: str) -> float:
        """Standard error of a common unknown, in its unit; 0 where it was given."""
        at = self.names.index(name)
        return math.sqrt(self.covariance[at, at])

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of a common unknown, in its unit."""
        reach = NORMAL_95 * self.error(name)
        return self.value(name) - reach, self.value(name) + reach

    @property
    def F_k(self) -> float:
        """Friction force, N."""
        return self.value("F_k")

    @property
    def c(self) -> float:
        """Viscous damping, N s/m; 0 where the law has none."""
        return self.value("c") if "c" in self.names else 0.0

    @property
    def rho(self) -> float:
        """ρ = K_z^{−1/2}, (m/N)^{1/2}; 0 for a rigid contact."""
        return 0.0 if self.rigid else self.value("rho")

    @property
    def K_z(self) -> float:
        """Contact stiffness, N/m; infinite for a rigid contact."""
        return math.inf if self.rigid else self.rho**-2

    @property
    def K_z_error(self) -> float:
        """Standard error of K_z, N/m; infinite where the contact is rigid."""
        return math.inf if self.rigid else 2.0 * self.K_z**1.5 * self.error("rho")

    @property
    def K_z_interval(self) -> tuple[float, float]:
        """95 % interval of K_z, N/m, from that of ρ; unbounded above where that reaches ρ = 0."""
        low, high = self.interval("rho")
        return high**-2, (low**-2 if low > 0.0 else math.inf)

    @property
    def m(self) -> float:
        """Mass, kg."""
        return self.value("m")

    @property
    def natural_frequency_hz(self) -> float:
        """√(k/m)/2π, Hz, the natural frequency while the contact slips."""
        return math.sqrt(self.k / self.m) / (2.0 * math.pi)

    @property
    def chi_square(self) -> float:
        """Sum of the squares of the residuals, χ²."""
        return float(self.residual @ self.residual)
