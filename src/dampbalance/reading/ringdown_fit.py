"""Maximum-likelihood fit of one oscillator to free decays: the exact motions that fit their samples best.

From the start of a decay on, the base being at rest, the mass follows

    m ẍ + c ẋ + k x + K_z z = 0,   ż = ẋ within |z| ≤ F_k/K_z

with x counted from the rest position of the spring. F_k, c, ρ = K_z^{−1/2} and m are common to all decays. Each
channel of a record has a separate offset, which for a displacement holds the rest position of the spring; each decay
has its start state (x, ẋ, w), z = (w − 1) F_k/K_z with 0 ≤ w ≤ 2. The noise is white, and the maximum of the likelihood
is the least sum of squares over all samples. The stiffness k is given.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..model import Parameters
from ..motion.decays import decay_samples, phase_slopes
from ..motion.events import PHASE_S, PHASE_T, run
from ..motion.states import states_in_phases
from ..solver import NORMAL_95
from .climb import GAIN, MOST, Evaluation, OscillatorFit, climb
from .ringdown_bursts import Signal, rounding

COMMON = ("F_k", "c", "rho", "m")
"""Unknowns common to all decays; the offsets and the start states follow."""

STATE = 3
"""Number of unknowns of a start state: x, ẋ, w."""

STEP = 1e-6
"""Relative step of finite differences: motions are exact to 1e-12."""

_CHORD = 3e-2  # of ρ√k: K_z = 1100 k
_MOST_PHASES = 4096  # of a decay: a motion that slips more often than that is none
_STIFFEST = 1e8  # of K_z/k: the contact that stands for a rigid one
# Bounds for a motion that oscillates: c over √(km), and the mass over that of the start, either way.
_DAMPED, _MASSES = 4.0, 10.0
_CHANCE = 1e-4  # probability in white noise of a residual so much like a motion
_W_ERROR = 1.0  # of w, which lies between 0 and 2
# That probability, and standard deviations of the correlation of neighbouring residuals.
_DOUBTFUL, _ALIKE = 0.02, 3.0
_ROUNDING = 0.1  # of the variance of the noise
_BINS = 12  # of a cycle, in which the residual is averaged


@dataclass(frozen=True, eq=False)
class Decay:
    """The samples of one free decay.

    source : of its record.   start, end : s.   signals : its channels, cut to the decay.   period : of the motion, s,
    about.
    """

    source: str
    start: float
    end: float
    signals: tuple[Signal, ...]
    period: float

    def cut(self, start: float, end: float) -> Decay:
        """The part of the decay between two times, s."""
        signals = tuple(one.between(start, end) for one in self.signals)
        return replace(self, start=start, end=end, signals=signals)

    @property
    def samples(self) -> int:
        """Number of samples in all channels."""
        return sum(one.t.size for one in self.signals)


@dataclass(frozen=True, eq=False)
class RingFit(OscillatorFit):
    """The oscillator whose free decays fit the samples of n decays best.

    The unknowns are COMMON, the offsets, and x, ẋ, w of each decay; the residuals run decay by decay, channel by
    channel.

    jacobian : derivatives of the residual by the unknowns, (samples, p); zero where one was given.
    ranges : 95 % intervals of common unknowns that a search has profiled, by name.
    minima : number of minima of χ² that lie within such intervals.
    """

    decays: tuple[Decay, ...]
    jacobian: Array
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    minima: int = 1

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of a common unknown, in its unit."""
        return self.ranges.get(name) or super().interval(name)

    def error(self, name: str) -> float:
        """Standard error of a common unknown; where several minima are as good, that of the interval over them."""
        if self.minima == 1 or name not in self.ranges:
            return super().error(name)
        low, high = self.ranges[name]
        return 0.5 * (high - low) / NORMAL_95

    @property
    def names(self) -> tuple[str, ...]:
        """F_k, c, rho, m."""
        return COMMON

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.residual.size - self.point.size

    def places(self, i: int) -> slice:
        """Places of the start state x, ẋ, w of decay i in the point."""
        first = self.point.size - STATE * (len(self.decays) - i)
        return slice(first, first + STATE)

    def phases(self, i: int, end: float | None = None) -> Array:
        """Rows (t, s, x, ẋ, z) of the motion of decay i, t from its start on, to its end or to another one, s."""
        one = self.decays[i]
        until = (one.end if end is None else end) - one.start
        return phases_of(self.point, self.point[self.places(i)], self.k, until)

    def sticks_from(self, i: int, end: float | None = None) -> float:
        """The time, s after its start, from which on the mass of decay i sticks; infinite where it moves up to the end
        of the decay, or to another one, s."""
        last = self.phases(i, end)[-1]
        return float(last[PHASE_T]) if last[PHASE_S] == 0.0 else math.inf

    def residuals(self) -> Iterator[tuple[int, Signal, Array]]:
        """Number of the decay, channel and residual of each channel of each decay."""
        at = 0
        for i, one in enumerate(self.decays):
            for signal in one.signals:
                yield i, signal, self.residual[at : at + signal.t.size]
                at += signal.t.size

    @property
    def misfit(self) -> float:
        """Mean square of the residual averaged over parts of a cycle, relative to white noise, which gives 1."""
        return self._likeness[0]

    @property
    def chance(self) -> float:
        """Probability that white noise leaves a residual as similar to a motion."""
        from scipy import special  # slow to import

        ratio, bins, rest = self._likeness
        return float(special.fdtrc(bins, rest, ratio))

    @property
    def doubtful(self) -> bool:
        """Whether the climb may have missed the best fit: neighbouring residuals are correlated, or their averages too
        large. Coloured noise has the same effect."""
        products = squares = 0.0
        for _, _, residual in self.residuals():
            products += float(residual[1:] @ residual[:-1])
            squares += float(residual @ residual)
        alike = products / max(squares, 1e-300) * math.sqrt(self.residual.size)
        return self.chance < _DOUBTFUL or alike > _ALIKE

    @property
    def adequate(self) -> bool:
        """Whether the residual is white, so that such an oscillator may have made the records."""
        return self.chance >= _CHANCE

    @cached_property
    def _likeness(self) -> tuple[float, int, int]:
        """F ratio of the averages to the scatter about them, and its two numbers of degrees of freedom."""
        between = within = 0.0
        bins = count = 0
        for i, signal, residual in self.residuals():
            per_bin = max(2, round(self.decays[i].period / (_BINS * signal.dt)))
            n = residual.size // per_bin
            parts = residual[: n * per_bin].reshape(n, per_bin)
            means = parts.mean(axis=1)
            between += per_bin * float(means @ means)
            within += float(np.sum((parts - means[:, None]) ** 2))
            bins, count = bins + n, count + n * per_bin
        first, rest = max(1, bins - self.point.size), max(1, count - bins)
        # a record without noise leaves rounding, far below the least noise that is assumed
        return (between / first) / max(within / rest, _ROUNDING), first, rest


def fit_decays(
    decays: Sequence[Decay],
    k: float,
    start: Array,
    *,
    given: Collection[int] = (),
    gain: float = GAIN,
    most: int = MOST,
) -> RingFit | None:
    """The fit in which a climb from a start point ends; None where the model has no motion there.

    given : numbers of the unknowns that keep their values.   gain : of half of χ², where the climb ends.
    most : evaluations.
    """
    free = np.array([i for i in range(start.size) if i not in given])
    rigid = 1.0 / math.sqrt(_STIFFEST * k)
    first_state = start.size - STATE * len(decays)
    m = float(start[3])
    omega = math.sqrt(k / m)
    lower = np.full(start.size, -math.inf)
    upper = np.full(start.size, math.inf)
    scale = np.ones(start.size)
    lower[:4] = 1e-9 * start[0], 0.0, rigid, m / _MASSES
    upper[1], upper[3] = _DAMPED * math.sqrt(k * m), m * _MASSES
    scale[:4] = start[0], 1e-3 * math.sqrt(k * m), 1e-3 * start[2], m
    for signal in (signal for one in decays for signal in one.signals):
        scale[len(COMMON) + signal.offset] = max(float(np.ptp(signal.values)), signal.noise)
    for i in range(first_state, start.size, STATE):
        size = max(abs(start[i]), abs(start[i + 1]) / omega, 1e-300)
        scale[i : i + STATE] = size, size * omega, 1.0
        lower[i + 2], upper[i + 2] = 0.0, 2.0

    def triangle(point: Array) -> Evaluation | None:
        # as many residuals as unknowns, and one, which have the χ² and the steps of all samples
        whole = _columns(decays, k, point)
        return None if whole is None else _split(_triangle(whole))

    climbed = climb(triangle, start, free, lower, scale, upper, gain=gain, most=most)
    whole = None if climbed is None else _columns(decays, k, climbed.point)
    if climbed is None or whole is None:
        return None
    here, point = _split(whole), climbed.point
    jacobian = np.zeros_like(here.jacobian)
    jacobian[:, free] = here.jacobian[:, free]
    solution = linear_solution(_triangle(jacobian), w_errors(point.size, first_state))
    return RingFit(
        k=k,
        point=point,
        covariance=solution @ solution.T,
        residual=here.residual,
        rigid=bool(point[2] <= rigid),
        decays=tuple(decays),
        jacobian=jacobian,
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
    length[length < 1e-150] = 1.0  # nothing depends on these
    scaled = np.vstack([design, np.diag(known)]) / length
    return np.linalg.pinv(scaled, rcond=1e-9) / length[:, None]


def with_noise_of(fit: RingFit) -> RingFit:
    """The fit repeated with the noise of each channel estimated from its residual."""
    sums: dict[int, Array] = {}
    for _, signal, residual in fit.residuals():
        total = sums.setdefault(signal.offset, np.zeros(2))
        total += float(residual @ residual) * signal.noise**2, residual.size
    share = fit.residual.size / max(1, fit.freedom)
    noise = {offset: math.sqrt(square / n * share) for offset, (square, n) in sums.items()}

    def with_noise(signal: Signal) -> Signal:
        return replace(signal, noise=max(noise[signal.offset], rounding(signal.values)))

    decays = [replace(one, signals=tuple(map(with_noise, one.signals))) for one in fit.decays]
    return fit_decays(decays, fit.k, fit.point) or fit


def numbers_of(point: Array, k: float) -> Parameters:
    """The oscillator of a point."""
    F_k, c, rho, m = point[: len(COMMON)].tolist()
    return Parameters(m, c, k, rho**-2, F_k, 0.0, 0.0)


def contact_step(point: Array, k: float) -> float:
    """Step of a difference by ρ: close to a rigid contact the motion depends on ρ², and a chord replaces the slope."""
    rho, chord = float(point[COMMON.index("rho")]), _CHORD / math.sqrt(k)
    return chord if rho < 0.3 * chord else STEP * rho


def phases_of(point: Array, state: Array, k: float, until: float) -> Array:
    """Rows (t, s, x, ẋ, z) of the motion from a start state (x, ẋ, w) at t = 0 on.

    Raises ValueError where the contact rattles on.
    """
    par = numbers_of(point, k)
    x, v, w = state.tolist()
    rows = np.empty((_MOST_PHASES, 5))
    Z_m = par.F_k / par.K_z
    z = min(max((w - 1.0) * Z_m, -Z_m), Z_m)
    count, t, *_ = run(x, v, z, 0.0, until, 0.0, par, rows)
    if t < until:
        raise ValueError("the contact slips on and on")
    return rows[:count]


def samples_of(point: Array, state: Array, k: float, one: Decay) -> Array:
    """Samples of all channels of a decay without noise and offset, (samples,)."""
    phases, par = _phases_to_last(point, state, k, one), numbers_of(point, k)
    parts = [states_in_phases(s.t - one.start, phases, 0.0, par)[s.order] for s in one.signals]
    return np.concatenate(parts)


def _phases_to_last(point: Array, state: Array, k: float, one: Decay) -> Array:
    """The phases of a motion up to the last sample of a decay."""
    longest = max(float(s.t[-1]) for s in one.signals if s.t.size)
    return phases_of(point, state, k, max(longest - one.start, 1e-9 * one.period))


def _with_slopes(point: Array, state: Array, k: float, one: Decay) -> list[Array]:
    """Samples of each channel without noise and offset, and their derivatives by COMMON and the start state, (n, 8).

    Close to a rigid contact the motion depends on ρ², and a chord replaces the derivative by ρ.
    """
    phases, par = _phases_to_last(point, state, k, one), numbers_of(point, k)
    slopes = phase_slopes(phases, float(state[2]), par)
    parts = [decay_samples(s.t - one.start, s.order, phases, slopes, par) for s in one.signals]
    rho = COMMON.index("rho")
    step = contact_step(point, k)
    if step > point[rho]:
        moved = point.copy()
        moved[rho] += step
        there = np.split(samples_of(moved, state, k, one), np.cumsum([len(p) for p in parts])[:-1])
        for part, other in zip(parts, there, strict=True):
            part[:, rho + 1] = (other - part[:, 0]) / step
    return parts


def _columns(decays: Sequence[Decay], k: float, point: Array) -> Array | None:
    """Derivatives of the residuals (model − sample)/σ by all unknowns, and these residuals, (samples, p + 1).

    None where the contact rattles.
    """
    whole = np.zeros((sum(one.samples for one in decays), point.size + 1))
    first, at = point.size - STATE * len(decays), 0
    for i, one in enumerate(decays):
        own = slice(first + STATE * i, first + STATE * (i + 1))
        try:
            parts = _with_slopes(point, point[own], k, one)
        except (ValueError, ArithmeticError):
            return None
        for signal, part in zip(one.signals, parts, strict=True):
            block, offset = whole[at : at + signal.t.size], len(COMMON) + signal.offset
            block[:, : len(COMMON)] = part[:, 1 : len(COMMON) + 1]
            block[:, own] = part[:, len(COMMON) + 1 :]
            block[:, offset] = 1.0
            block[:, -1] = part[:, 0] + point[offset] - signal.values
            block /= signal.noise
            at += signal.t.size
    return whole if np.isfinite(whole).all() else None


def _triangle(columns: Array) -> Array:
    """The triangle of a QR factorisation: the same sums of products in as many rows as there are columns."""
    return np.asarray(np.linalg.qr(columns, mode="r"))


def _split(columns: Array) -> Evaluation:
    """Residuals and derivatives, from `_columns` or their triangle."""
    return Evaluation(columns[:, -1], columns[:, :-1])
