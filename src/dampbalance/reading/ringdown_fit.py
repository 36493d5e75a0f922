"""Maximum-likelihood fit of one oscillator to all free decays: the exact motions that fit their samples best.

From the start of a stretch on, the base being at rest, the mass follows

    m ẍ + c ẋ + k x + K_z z = 0,   ż = ẋ within |z| ≤ F_k/K_z

with x counted from the rest position of the spring. F_k, c, ρ = K_z^{−1/2} and m are common to all stretches. Each
channel of a record has a separate offset, which for a displacement holds the rest position of the spring; each stretch
has its start state (x, ẋ, w), z = (w − 1) F_k/K_z with 0 ≤ w ≤ 2. The noise is white, and the maximum of the likelihood
is the least sum of squares over all samples. The stiffness k is given.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers
from .climb import Evaluation, climb
from .oscillator_fit import OscillatorFit
from .ringdown_motion import COMMON, STATE, STEP, Stretch, contact_step, phases_of, samples_of

_STIFFEST = 1e8  # of K_z/k: the contact that stands for a rigid one
# Bounds for a motion that oscillates: c over √(km), and the mass over that of the start, either way.
_DAMPED, _MASSES = 4.0, 10.0
_MOST = 30  # evaluations of a climb
_GAIN = 5e-8  # of half of χ², where a climb ends
_CHANCE = 1e-4  # probability in white noise of a residual so much like a motion
_W_ERROR = 1.0  # of w, which lies between 0 and 2
# That probability, and standard deviations of the correlation of neighbouring residuals.
_DOUBTFUL, _ALIKE = 0.02, 3.0
_ROUNDING = 0.1  # of the variance of the noise
_BINS = 12  # of a cycle, in which the residual is averaged


@dataclass(frozen=True, eq=False)
class RingFit(OscillatorFit):
    """The oscillator whose free decays fit the samples of n stretches best.

    The unknowns are COMMON, the offsets, and x, ẋ, w of each stretch; the residuals run stretch by stretch, channel by
    channel.

    jacobian : derivatives of the residual by the unknowns, (samples, p); zero where one was given.
    """

    stretches: tuple[Stretch, ...]
    jacobian: Array

    @property
    def names(self) -> tuple[str, ...]:
        """F_k, c, rho, m."""
        return COMMON

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.residual.size - self.point.size

    def state(self, i: int) -> Array:
        """x, ẋ, w at the start of stretch i."""
        at = self.point.size - STATE * (len(self.stretches) - i)
        return self.point[at : at + STATE]

    def phases(self, i: int, end: float | None = None) -> Array:
        """Rows (t, s, x, ẋ, z) of the motion of stretch i, t from its start on, to its end or to another one, s."""
        one = self.stretches[i]
        until = (one.end if end is None else end) - one.start
        return phases_of(self.point, self.state(i), self.k, until)

    def residuals(self) -> list[list[Array]]:
        """The residuals of each stretch, channel by channel."""
        parts, at = [], 0
        for one in self.stretches:
            row = []
            for signal in one.signals:
                row.append(self.residual[at : at + signal.t.size])
                at += signal.t.size
            parts.append(row)
        return parts

    @cached_property
    def misfit(self) -> float:
        """Mean square of the residual averaged over parts of a cycle, relative to white noise, which gives 1."""
        return self._likeness()[0]

    @property
    def chance(self) -> float:
        """Probability that white noise leaves a residual as similar to a motion."""
        from scipy import special  # slow to import

        ratio, bins, rest = self._likeness()
        return float(special.fdtrc(bins, rest, ratio))

    @property
    def doubtful(self) -> bool:
        """Whether the climb may have missed the best fit: neighbouring residuals are correlated, or their averages too
        large. Coloured noise has the same effect."""
        products = squares = 0.0
        for row in self.residuals():
            for residual in row:
                products += float(residual[1:] @ residual[:-1])
                squares += float(residual @ residual)
        alike = products / max(squares, 1e-300) * math.sqrt(self.residual.size)
        return self.chance < _DOUBTFUL or alike > _ALIKE

    @property
    def adequate(self) -> bool:
        """Whether the residual is white, so that such an oscillator may have made the records."""
        return self.chance >= _CHANCE

    def _likeness(self) -> tuple[float, int, int]:
        """F ratio of the averages to the scatter about them, and its two numbers of degrees of freedom."""
        between = within = 0.0
        bins = count = 0
        for one, row in zip(self.stretches, self.residuals(), strict=True):
            for signal, residual in zip(one.signals, row, strict=True):
                per_bin = max(2, round(one.period / (_BINS * signal.dt)))
                n = residual.size // per_bin
                parts = residual[: n * per_bin].reshape(n, per_bin)
                means = parts.mean(axis=1)
                between += per_bin * float(means @ means)
                within += float(np.sum((parts - means[:, None]) ** 2))
                bins, count = bins + n, count + n * per_bin
        first, rest = max(1, bins - self.point.size), max(1, count - bins)
        # a record without noise leaves rounding, far below the least noise that is assumed
        return (between / first) / max(within / rest, _ROUNDING), first, rest


def fit_stretches(
    stretches: Sequence[Stretch],
    k: float,
    start: Array,
    *,
    given: Collection[int] = (),
    gain: float = _GAIN,
    most: int = _MOST,
) -> RingFit | None:
    """The fit in which a climb from a start point ends; None where the model has no motion there.

    given : numbers of the unknowns that keep their values.
    """
    free = np.array([i for i in range(start.size) if i not in set(given)])
    rigid = 1.0 / math.sqrt(_STIFFEST * k)
    first_state = start.size - STATE * len(stretches)
    m = float(start[3])
    omega = math.sqrt(k / m)
    lower = np.full(start.size, -math.inf)
    upper = np.full(start.size, math.inf)
    scale = np.ones(start.size)
    lower[:4] = 1e-9 * start[0], 0.0, rigid, m / _MASSES
    upper[1], upper[3] = _DAMPED * math.sqrt(k * m), m * _MASSES
    scale[:4] = start[0], 1e-3 * math.sqrt(k * m), 1e-3 * start[2], m
    for one in stretches:
        for signal, offset in zip(one.signals, one.offsets, strict=True):
            scale[len(COMMON) + offset] = max(float(np.ptp(signal.values)), signal.noise)
    for i in range(first_state, start.size, STATE):
        size = max(abs(start[i]), abs(start[i + 1]) / omega, 1e-300)
        scale[i : i + STATE] = size, size * omega, 1.0
        lower[i + 2], upper[i + 2] = 0.0, 2.0
    residuals = _SampleResiduals(tuple(stretches), k, free, scale)
    climbed = climb(residuals.evaluate, start, free, lower, scale, upper, gain=gain, most=most)
    if climbed is None:
        return None
    point, here = climbed.point, climbed.evaluation
    solution = linear_solution(here.jacobian, w_errors(point.size, first_state))
    return RingFit(
        k=k,
        point=point,
        covariance=solution @ solution.T,
        residual=here.residual,
        rigid=bool(point[2] <= rigid),
        stretches=tuple(stretches),
        jacobian=here.jacobian,
    )


def w_errors(size: int, first_state: int) -> Array:
    """Prior standard errors of the unknowns, (p,): w lies between 0 and 2; the others have no prior."""
    errors = np.full(size, math.inf)
    errors[first_state + 2 :: STATE] = _W_ERROR
    return errors


def linear_solution(design: Array, errors: Array) -> Array:
    """The pseudo-inverse, (p, samples + p), of a design (samples, p) with prior standard errors, (p,); zero for an
    unknown on which nothing depends.

    Its product with (residuals, 0) is the least-squares solution, that with its own transpose the covariance.
    """
    known = np.where(np.any(design != 0.0, axis=0), 1.0 / errors, 0.0)
    length = np.sqrt(np.sum(design**2, axis=0) + known**2)
    length[length == 0.0] = 1.0
    solution: Array = np.linalg.pinv(np.vstack([design, np.diag(known)]) / length, rcond=1e-9)
    solution /= length[:, None]
    return solution


def with_noise_of(fit: RingFit) -> RingFit:
    """The fit repeated with the noise of each channel estimated from its residual."""
    sums: dict[int, list[float]] = {}
    for one, row in zip(fit.stretches, fit.residuals(), strict=True):
        for signal, offset, residual in zip(one.signals, one.offsets, row, strict=True):
            total = sums.setdefault(offset, [0.0, 0.0])
            total[0] += float(residual @ residual) * signal.noise**2
            total[1] += residual.size
    share = fit.residual.size / max(1, fit.freedom)
    noise = {offset: math.sqrt(square / n * share) for offset, (square, n) in sums.items()}
    stretches = []
    for one in fit.stretches:
        signals = []
        for signal, offset in zip(one.signals, one.offsets, strict=True):
            floor = 3e-6 * float(np.ptp(signal.values))  # rounding
            signals.append(replace(signal, noise=max(noise[offset], floor)))
        stretches.append(replace(one, signals=tuple(signals)))
    return fit_stretches(stretches, fit.k, fit.point) or fit


@dataclass(frozen=True, eq=False)
class _SampleResiduals:
    """Residuals (model − sample)/σ of all stretches as functions of the unknowns.

    free : numbers of the unknowns by which derivatives are needed.   scale : of all unknowns.
    """

    stretches: tuple[Stretch, ...]
    k: float
    free: Integers
    scale: Array

    def evaluate(self, point: Array) -> Evaluation | None:
        """Residuals and derivatives; None where the contact rattles."""
        wanted = set(self.free.tolist())
        sizes = [one.samples for one in self.stretches]
        residual, jacobian = np.empty(sum(sizes)), np.zeros((sum(sizes), point.size))
        first = point.size - STATE * len(self.stretches)
        steps = self._steps(point)
        at = 0
        for i, one in enumerate(self.stretches):
            here = slice(at, at + sizes[i])
            own = slice(first + STATE * i, first + STATE * (i + 1))
            lengths = [s.t.size for s in one.signals]
            error = np.repeat([s.noise for s in one.signals], lengths)
            offset = np.repeat(point[[len(COMMON) + j for j in one.offsets]], lengths)
            place = at
            for signal, number in zip(one.signals, one.offsets, strict=True):
                part = slice(place, place + signal.t.size)
                if len(COMMON) + number in wanted:
                    jacobian[part, len(COMMON) + number] = 1.0 / signal.noise
                place = part.stop
            values = np.concatenate([s.values for s in one.signals])
            try:
                model = samples_of(point, point[own], self.k, one)
                for j in (*range(len(COMMON)), *range(own.start, own.stop)):
                    if j in wanted:
                        moved = point.copy()
                        moved[j] += steps[j]
                        there = samples_of(moved, moved[own], self.k, one)
                        jacobian[here, j] = (there - model) / (steps[j] * error)
            except (ValueError, ArithmeticError):
                return None
            residual[here] = (model + offset - values) / error
            at += sizes[i]
        if not (np.isfinite(residual).all() and np.isfinite(jacobian).all()):
            return None
        return Evaluation(residual, jacobian)

    def _steps(self, point: Array) -> Array:
        """Steps of the differences: a part of each unknown, or of the size that matters where it is close to zero."""
        F_k, c, _, m = point[: len(COMMON)].tolist()
        steps = STEP * np.maximum(np.abs(point), self.scale)
        damping = max(c, 2e-2 * math.sqrt(self.k * m))
        steps[: len(COMMON)] = (
            STEP * F_k,
            STEP * damping,
            contact_step(point, self.k),
            STEP * m,
        )
        first = point.size - STATE * len(self.stretches) + 2
        steps[first::STATE] = np.where(point[first::STATE] > 1.0, -STEP, STEP)
        return steps
