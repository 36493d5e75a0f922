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
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask
from ..model import Parameters
from ..motion.climb import GAIN, MOST, Bounds, climb
from ..motion.events import PHASE_S, PHASE_T, run
from ..motion.free_decay import (
    MOST_PHASES,
    NOISE,
    OFFSET,
    contact_chord,
    decay_products,
    decay_samples,
    phase_slopes,
)
from ..motion.states import states_in_phases
from ..reading.bursts import Signal, rounding
from ..reading.oscillator_fit import OscillatorFit
from ..reading.whiteness import averages, chance_of_averages, chance_of_lines, louder
from ..solver import NORMAL_95

COMMON = ("F_k", "c", "rho", "m")
"""Unknowns common to all decays; the offsets and the start states follow."""

STATE = 3
"""Number of unknowns of a start state: x, ẋ, w."""

STEP = 1e-6
"""Relative step of finite differences: motions are exact to 1e-12."""

_RHO = COMMON.index("rho")
_LOOSEST, _STIFFEST = 1e-4, 1e8  # of K_z/k: contacts that stand for none and for a rigid one
# Bounds for a motion that oscillates: c over √(km), and the mass over that of the start, either way.
_DAMPED, _MASSES = 2.0, 10.0
_CHANCE = 1e-4  # probability in white noise of a residual so much like a motion
_W_ERROR = 1.0  # of w, which lies between 0 and 2
# That probability, and standard deviations of the correlation of neighbouring residuals.
_DOUBTFUL, _ALIKE = 0.02, 3.0
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
class Whiteness:
    """How much residuals of decays are like white noise.

    residuals : of each channel of each decay.   widths : samples in a part of a cycle there.   unknowns : fitted ones.
    """

    residuals: tuple[Array, ...]
    widths: tuple[int, ...]
    unknowns: int

    @classmethod
    def of(cls, decays: Sequence[Decay], residual: Array, unknowns: int) -> Whiteness:
        """Split the residual of decays into those of their channels."""
        channels = [(one, signal) for one in decays for signal in one.signals]
        ends = np.cumsum([signal.t.size for _, signal in channels])
        widths = (max(2, round(one.period / (_BINS * signal.dt))) for one, signal in channels)
        return cls(tuple(np.split(residual, ends[:-1])), tuple(widths), unknowns)

    @cached_property
    def misfit(self) -> float:
        """Mean square of the residual averaged over parts of a cycle, relative to white noise, which gives 1."""
        return averages(self.residuals, self.widths, self.unknowns)[0]

    @cached_property
    def chance(self) -> float:
        """Probability that white noise leaves a residual as similar to a motion, slow or fast."""
        return min(1.0, 2.0 * min(self.slow_chance, chance_of_lines(self.residuals)))

    @cached_property
    def slow_chance(self) -> float:
        """Probability that averages of white noise over parts of a cycle, down to two samples, are as large."""
        return chance_of_averages(self.residuals, self.widths, self.unknowns)

    @property
    def adequate(self) -> bool:
        """Whether the residual is white, so that such an oscillator may have made the records."""
        return self.chance >= _CHANCE


@dataclass(frozen=True, eq=False)
class RingFit(OscillatorFit):
    """The oscillator whose free decays fit the samples of n decays best.

    The unknowns are COMMON, the offsets, and x, ẋ, w of each decay; the residuals run decay by decay, channel by
    channel.

    free : which unknowns were not given, (p,).
    ranges : 95 % intervals of common unknowns that a search has profiled, by name.
    minima : number of minima of χ² that lie within such intervals.
    """

    decays: tuple[Decay, ...]
    free: Mask
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    minima: int = 1

    @cached_property
    def _columns(self) -> Array:
        par = numbers_of(self.point, self.k)
        states = [self.point[self.places(i)] for i in range(len(self.decays))]
        pairs = zip(self.decays, states, strict=True)
        phases = [_phases_to_last(self.point, state, self.k, one) for one, state in pairs]

        def samples(i: int, times: Array, order: int) -> Array:
            slopes = phase_slopes(phases[i], float(states[i][2]), par)
            return decay_samples(times, order, phases[i], slopes, par)

        whole = columns_of(self.decays, self.point, self.point.size, samples)
        whole[:, _RHO] *= 1.0 + 0.5 * contact_chord(par.K_z**-0.5, self.k) / self.point[_RHO]
        whole[:, :-1] *= self.free
        return whole

    @property
    def jacobian(self) -> Array:
        """Derivatives of the residual by the unknowns, (samples, p); zero where one was given."""
        return self._columns[:, :-1]

    @property
    def residual(self) -> Array:
        """(model − sample)/σ, (samples,)."""
        return self._columns[:, -1]

    @property
    def samples(self) -> int:
        """Number of samples in all decays."""
        return sum(one.samples for one in self.decays)

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
        return self.samples - self.point.size

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
        channels = ((i, signal) for i, one in enumerate(self.decays) for signal in one.signals)
        for (i, signal), residual in zip(channels, self.whiteness.residuals, strict=True):
            yield i, signal, residual

    @cached_property
    def whiteness(self) -> Whiteness:
        """How much the residual is like white noise."""
        return Whiteness.of(self.decays, self.residual, self.point.size)

    @property
    def misfit(self) -> float:
        """As `Whiteness` has it."""
        return self.whiteness.misfit

    @property
    def adequate(self) -> bool:
        """As `Whiteness` has it."""
        return self.whiteness.adequate

    @property
    def doubtful(self) -> bool:
        """Whether the climb may have missed the best fit: neighbouring residuals are correlated, or their averages too
        large. Coloured noise has the same effect."""
        products = math.fsum(float(one[1:] @ one[:-1]) for one in self.whiteness.residuals)
        alike = products / max(self.chi_square, 1e-300) * math.sqrt(self.samples)
        return self.whiteness.chance < _DOUBTFUL or alike > _ALIKE

    @cached_property
    def shortcomings(self) -> tuple[str, ...]:
        """In which ways the decays are not those of such an oscillator with white noise, in words; empty where they may
        be."""
        words = []
        if self.whiteness.slow_chance < _CHANCE:
            words.append(
                "the decays are not those of one mass on a spring, a damper and one friction contact within white "
                f"noise: what is left is {self.misfit:.3g} times as large as noise would leave it over a twelfth of a "
                f"cycle, or over fewer samples, with a probability of {self.whiteness.slow_chance:.1g}"
            )
        elif not self.adequate:
            words.append(
                "what is left of the decays has a spectral line, which white noise has not"
            )
        loud = max(louder(r, signal.values, signal.noise) for _, signal, r in self.residuals())
        if loud > 1.0:
            words.append(
                f"what is left of the decays is {loud:.3g} times the noise that their samples themselves show"
            )
        return tuple(words)


def columns_of(
    decays: Sequence[Decay], point: Array, size: int, samples: Callable[[int, Array, int], Array]
) -> Array:
    """Derivatives of the residuals (model − sample)/σ by the unknowns of a point, and these residuals,
    (samples, unknowns + 1).

    size : number of the unknowns of a `RingFit`; any others follow.
    samples : (number of a decay, times after its start, order of the derivative) → samples and their derivatives by
    COMMON, the start state, and the other unknowns, as columns.
    """
    blocks = []
    for i, one in enumerate(decays):
        begin = size - STATE * (len(decays) - i)
        places = [*range(len(COMMON)), *range(begin, begin + STATE), *range(size, point.size)]
        for signal in one.signals:
            part, offset = (
                samples(i, signal.t - one.start, signal.order),
                len(COMMON) + signal.offset,
            )
            block = np.zeros((signal.t.size, point.size + 1))
            block[:, places] = part[:, 1:]
            block[:, offset] = 1.0
            block[:, -1] = part[:, 0] + point[offset] - signal.values
            blocks.append(block / signal.noise)
    return np.vstack(blocks)


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
    samples = Samples.of(decays, start.size)
    bounds, rigid = bounds_of(decays, samples, k, start, given)
    reached = climb(samples.evaluation(k), start, bounds, gain=gain, most=most)
    if reached is None:
        return None
    point, information = reached.point, reached.products[:-1, :-1]
    information = information * np.outer(bounds.free, bounds.free)
    return RingFit(
        k=k,
        point=point,
        covariance=_covariance(information, w_errors(start.size, len(COMMON) + samples.offsets)),
        chi_square=reached.chi_square,
        rigid=bool(point[_RHO] <= rigid),
        decays=tuple(decays),
        free=bounds.free,
    )


def rough_ends(
    decays: Sequence[Decay],
    k: float,
    starts: Array,
    *,
    given: Collection[int] = (),
    gain: float,
    most: int,
    following: bool = False,
) -> Array:
    """Where climbs from many starts (n, p) end and χ² there, (n, p + 1), the lowest first; those that the model has no
    motion at are left out.

    following : whether each start takes the unknowns that are not given from the end before; the order then stays.
    """
    if not len(starts):
        return np.empty((0, 0))
    samples = Samples.of(decays, starts.shape[1])
    bounds, _ = bounds_of(decays, samples, k, starts[0], given)
    evaluate = samples.evaluation(k)
    ends = np.full((len(starts), starts.shape[1] + 1), math.inf)
    reached = None
    for start, end in zip(starts, ends, strict=True):
        if following and reached is not None:
            start = np.where(bounds.free, reached.point, start)
        reached = climb(evaluate, start, bounds, gain=gain, most=most)
        if reached is not None:
            end[:-1], end[-1] = reached.point, reached.chi_square
    if following:
        return ends
    ends = ends[np.isfinite(ends[:, -1])]
    return ends[np.argsort(ends[:, -1], kind="stable")]


class Samples(NamedTuple):
    """The samples of decays as kernels take them: number of offsets, table of channels, values of all of them."""

    offsets: int
    channels: Array
    values: Array

    @classmethod
    def of(cls, decays: Sequence[Decay], unknowns: int) -> Samples:
        """Pack the samples of decays for a fit with so many unknowns."""
        rows, end = [], 0
        for i, one in enumerate(decays):
            for signal in one.signals:
                begin, end = end, end + signal.t.size
                first = float(signal.t[0]) - one.start if signal.t.size else 0.0
                step = signal.dt if signal.t.size > 1 else 1.0
                rows.append((i, signal.order, signal.offset, first, step, signal.noise, begin, end))
        values = np.concatenate([signal.values for one in decays for signal in one.signals])
        offsets = unknowns - len(COMMON) - STATE * len(decays)
        return cls(offsets, np.array(rows, dtype=float), values)

    def evaluation(self, k: float) -> Callable[[Array, Array], bool]:
        """What sets the products at a point, as `climb` takes it."""
        rows = np.empty((MOST_PHASES, 5))
        return lambda point, out: decay_products(point, k, *self, rows, out)


def bounds_of(
    decays: Sequence[Decay],
    samples: Samples,
    k: float,
    start: Array,
    given: Collection[int] = (),
) -> tuple[Bounds, float]:
    """The bounds of a climb from a start, and the ρ that stands for a rigid contact."""
    free = np.ones(start.size, dtype=np.bool_)
    free[[*given]] = False
    rigid = 1.0 / math.sqrt(_STIFFEST * k)
    first_state = len(COMMON) + samples.offsets
    F_k, _, rho, m = start[: len(COMMON)].tolist()
    omega = math.sqrt(k / m)
    lower = np.full(start.size, -math.inf)
    upper = np.full(start.size, math.inf)
    scale = np.ones(start.size)
    # with no contact at all, a mass this light is critically damped, even if the period is that of two turns
    light = k * (min(one.period for one in decays) / (8.0 * math.pi)) ** 2
    lower[:4] = 1e-9 * F_k, 0.0, rigid, max(m / _MASSES, min(light, m))
    upper[1:4] = _DAMPED * math.sqrt(k * m), 1.0 / math.sqrt(_LOOSEST * k), m * _MASSES
    scale[:4] = F_k, 1e-3 * math.sqrt(k * m), 1e-3 * rho, m
    states = start[first_state:].reshape(-1, STATE)
    size = np.maximum(np.maximum(np.abs(states[:, 0]), np.abs(states[:, 1]) / omega), 1e-300)
    scale[first_state::STATE], scale[first_state + 1 :: STATE] = size, size * omega
    lower[first_state + 2 :: STATE], upper[first_state + 2 :: STATE] = 0.0, 2.0
    for offset, noise in samples.channels[:, (OFFSET, NOISE)].tolist():
        scale[len(COMMON) + int(offset)] = noise
    return Bounds(free, lower, upper, scale), rigid


def _covariance(information: Array, errors: Array) -> Array:
    """The covariance of unknowns with this information, (p, p), and prior standard errors, (p,); zero for an unknown on
    which nothing depends."""
    sizes = np.diag(information)
    free = np.flatnonzero(sizes > 0.0)
    some = information[np.ix_(free, free)] + np.diag(errors[free] ** -2)
    length = np.sqrt(np.diag(some))
    scaled = some / np.outer(length, length)
    covariance = np.zeros_like(information)
    # what rounding cannot tell apart is uncertain, not certain
    inverse = np.linalg.inv(scaled + 1e-14 * np.eye(free.size))
    covariance[np.ix_(free, free)] = 0.5 * (inverse + inverse.T) / np.outer(length, length)
    return covariance


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
    share = fit.samples / max(1, fit.freedom)
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
    rho = float(point[_RHO])
    return contact_chord(rho, k) or STEP * rho


def phases_of(point: Array, state: Array, k: float, until: float) -> Array:
    """Rows (t, s, x, ẋ, z) of the motion from a start state (x, ẋ, w) at t = 0 on.

    Raises ValueError where the contact rattles on.
    """
    par = numbers_of(point, k)
    x, v, w = state.tolist()
    rows = np.empty((MOST_PHASES, 5))
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
