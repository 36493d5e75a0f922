"""Maximum-likelihood fit of one oscillator to free decays: the exact motions that fit their samples best.

From the start of a decay on, the base being at rest, the mass follows

    m ẍ + c ẋ + k x + K_z z = 0,   ż = ẋ within |z| ≤ F_k/K_z

with x counted from the rest position of the spring. c, ρ = K_z^{−1/2} and m are common to all decays, and so is F_k
unless decays are numbered as having friction forces of their own: F_k is then their mean. Each channel of a record has
a separate offset, which for a displacement holds the rest position of the spring; each decay has its start state
(x, ẋ, w), z = (w − 1) F_k/K_z with 0 ≤ w ≤ 2. The noise is white, and the maximum of the likelihood
is the least sum of squares over all samples. The stiffness k is given.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask
from ..model import Parameters
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
from ..motion.unknowns import OSCILLATOR_UNKNOWNS, RHO
from ..project.wording import times
from ..signals.bursts import Signal, least_noise
from ..signals.whiteness import averages, chance_of_averages, chance_of_lines, louder
from ..solver import NORMAL_95
from .climb import GAIN, MOST_EVALUATIONS, Climb, ClimbBounds, climb
from .oscillator_fit import OscillatorFit
from .scattering_mean import ScatteringMean

STATE = 3
"""Number of unknowns of a start state: x, ẋ and the preload w."""

_LOOSEST, _STIFFEST = 1e-4, 1e8  # of K_z/k: contacts that stand for none and for a rigid one
# Bounds for a motion that oscillates: c over √(km), and the mass over that of the start, either way.
_DAMPED, _MASS_RANGE = 2.0, 10.0
_UNNOTICED = 1e-9  # of the force of the spring: a friction that no motion shows
P_MOTION_LEFT = 1e-4  # probability in white noise of a residual so much like a motion
_PRELOAD_ERROR = 1.0  # it lies between 0 and 2
# That probability, and standard deviations of the correlation of neighbouring residuals.
_DOUBTFUL, _CORRELATED = 0.02, 3.0
_BINS_OF_A_CYCLE = 12  # of a cycle, in which the residual is averaged
_LEVEL = NORMAL_95**2  # of χ² above the least, at the ends of an interval
NEGLECTED_LIKELIHOOD = 0.025  # share of the integrated likelihood that neglected minima may hold
_PROFILES, _COARSE = 8, 1e-2  # climbs to an end of an interval, and where they end, in half of χ²
_CLOSE_END = 0.1  # of its distance: where an end is close enough


@dataclass(frozen=True, eq=False)
class Decay:
    """The samples of one free decay.

    source : of its record.   start, end : s.   signals : its channels, cut to the decay.   period : of the motion, s,
    about.   friction : number of its friction force, 0 for the first, which all decays share by default.
    """

    source: str
    start: float
    end: float
    signals: tuple[Signal, ...]
    period: float
    friction: int = 0

    def cut(self, start: float, end: float) -> Decay:
        """The part of the decay between two times, s."""
        signals = tuple(one.between(start, end) for one in self.signals)
        return replace(self, start=start, end=end, signals=signals)

    @property
    def samples(self) -> int:
        """Number of samples in all channels."""
        return sum(one.t.size for one in self.signals)

    @property
    def last_sample(self) -> float:
        """Time of the last sample, s; just after the start where there are none."""
        last = max((float(one.t[-1]) for one in self.signals if one.t.size), default=self.start)
        return max(last, self.start + 1e-9 * self.period)

    def grid(self, signal: Signal) -> tuple[float, float, int]:
        """Time of the first sample of a channel after the start, s, interval, s, and number of samples."""
        n = signal.t.size
        first = float(signal.t[0]) - self.start if n else 0.0
        return first, signal.dt if n > 1 else self.period, n


@dataclass(frozen=True, eq=False)
class RingFit(OscillatorFit):
    """The oscillator whose free decays fit the samples of n decays best.

    The unknowns are those of the oscillator, the offsets, the friction forces after the first, and x, ẋ, w of
    each decay; the residuals run decay by decay, channel by channel.

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
        K_z = self.point[RHO] ** -2

        def samples(i: int, signal: Signal) -> Array:
            one, par = self.decays[i], numbers_of(self.point_of(i), self.k)
            phases = self.phases(i, one.last_sample)
            slopes = phase_slopes(phases, float(self.point[self.places(i)][2]), par)
            return decay_samples(one.grid(signal), signal.order, phases, slopes, par)[:, :-1]

        whole = residual_columns(self.decays, self.point, len(OSCILLATOR_UNKNOWNS), samples)
        whole[:, RHO] *= 1.0 + 0.5 * contact_chord(K_z**-0.5, self.k) / self.point[RHO]
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

    @property
    def names(self) -> tuple[str, ...]:
        """F_k, c, rho, m."""
        return OSCILLATOR_UNKNOWNS

    @property
    def errors(self) -> Array:
        """Standard errors of the common unknowns at this minimum, (4,); NaN of those that it does not determine."""
        with np.errstate(invalid="ignore"):
            return np.sqrt(np.diag(self.covariance)[: len(OSCILLATOR_UNKNOWNS)])

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.samples - self.point.size

    @property
    def friction_places(self) -> list[int]:
        """Place of the friction force of each decay in the point."""
        return friction_places(self.decays, self.point.size)

    @property
    def _forces(self) -> list[int]:
        return [*dict.fromkeys(self.friction_places)]

    @property
    def frictions(self) -> Array:
        """The friction forces, N: one, or that of each decay."""
        return self.point[self._forces]

    @property
    def friction(self) -> ScatteringMean:
        """The mean of the friction forces."""
        covariance = self.covariance[np.ix_(self._forces, self._forces)]
        return ScatteringMean.of(self.frictions, covariance)

    def value(self, name: str) -> float:
        """A common unknown, in its unit; of several friction forces their mean."""
        return self.friction.value if name == "F_k" else super().value(name)

    @property
    def common_covariance(self) -> Array:
        """Covariance of the common unknowns; that of F_k includes the scatter of several friction forces."""
        if self.frictions.size == 1:
            return super().common_covariance
        means = np.eye(len(self.names), self.point.size)
        means[0, self._forces] = 1.0 / self.frictions.size
        covariance = means @ self.covariance @ means.T
        covariance[0, 0] = self.friction.error**2
        return covariance

    def point_of(self, i: int) -> Array:
        """The point with the friction force of decay i in the place of F_k."""
        point = self.point.copy()
        point[0] = point[self.friction_places[i]]
        return point

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of a common unknown, in its unit."""
        return self.ranges.get(name) or super().interval(name)

    def error(self, name: str) -> float:
        """Standard error of a common unknown; where several minima are as good, that of the interval over them."""
        if self.minima == 1 or name not in self.ranges:
            return super().error(name)
        low, high = self.ranges[name]
        return 0.5 * (high - low) / NORMAL_95

    def places(self, i: int) -> slice:
        """Places of the start state x, ẋ, w of decay i in the point."""
        first = self.point.size - STATE * (len(self.decays) - i)
        return slice(first, first + STATE)

    def phases(self, i: int, end: float | None = None) -> Array:
        """Rows (t, s, x, ẋ, z) of the motion of decay i, t from its start on, to its end or to another one, s."""
        one = self.decays[i]
        until = (one.end if end is None else end) - one.start
        return phases_of(self.point_of(i), self.point[self.places(i)], self.k, until)

    def sticks_from(self, i: int, end: float | None = None) -> float:
        """The time, s after its start, from which on the mass of decay i sticks; infinite where it moves up to the end
        of the decay, or to another one, s."""
        last = self.phases(i, end)[-1]
        return float(last[PHASE_T]) if last[PHASE_S] == 0.0 else math.inf

    def residuals(self) -> list[tuple[int, Signal, Array]]:
        """Number of the decay, channel and residual of each channel of each decay."""
        channels = [(i, signal) for i, one in enumerate(self.decays) for signal in one.signals]
        ends = np.cumsum([signal.t.size for _, signal in channels])
        return [(*channels[j], r) for j, r in enumerate(np.split(self.residual, ends[:-1]))]

    @cached_property
    def _parts(self) -> tuple[list[Array], list[int], int]:
        """Residuals of the channels, samples in a part of a cycle there, and what the fit takes of their freedom."""
        channels = self.residuals()
        widths = [
            max(2, round(self.decays[i].period / (_BINS_OF_A_CYCLE * signal.dt)))
            for i, signal, _ in channels
        ]
        fitted = self.point.size - len(self.names) + len(OSCILLATOR_UNKNOWNS)
        return [residual for *_, residual in channels], widths, fitted

    @cached_property
    def misfit(self) -> float:
        """Mean square of the residual averaged over parts of a cycle, relative to white noise, which gives 1."""
        return averages(*self._parts)[0]

    @cached_property
    def slow_chance(self) -> float:
        """Probability that averages of white noise over parts of a cycle, down to two samples, are as large."""
        return chance_of_averages(*self._parts)

    @cached_property
    def chance(self) -> float:
        """Probability that white noise leaves a residual as similar to a motion, slow or fast."""
        return min(1.0, 2.0 * min(self.slow_chance, chance_of_lines(self._parts[0])))

    @property
    def adequate(self) -> bool:
        """Whether the residual is white, so that such an oscillator may have made the records."""
        return self.chance >= P_MOTION_LEFT

    @property
    def doubtful(self) -> bool:
        """Whether the climb may have missed the best fit: neighbouring residuals are correlated, or their averages too
        large. Coloured noise has the same effect."""
        products = math.fsum(float(one[1:] @ one[:-1]) for one in self._parts[0])
        alike = products / max(self.chi_square, 1e-300) * math.sqrt(self.samples)
        return self.chance < _DOUBTFUL or alike > _CORRELATED

    @cached_property
    def shortcomings(self) -> tuple[str, ...]:
        """In which ways the decays are not those of such an oscillator with white noise, in words; empty where they may
        be."""
        words = []
        if self.slow_chance < P_MOTION_LEFT:
            words.append(
                "the decays are not those of one mass on a spring, a damper and one friction contact within white "
                f"noise: what is left is {times(self.misfit)} as large as noise would leave it over a twelfth of a "
                f"cycle, or over fewer samples, with a probability of {self.slow_chance:.1g}"
            )
        elif not self.adequate:
            words.append(
                "what is left of the decays has a spectral line, which white noise has not"
            )
        loud = max(louder(r, signal.values, signal.noise) for _, signal, r in self.residuals())
        if loud > 1.0:
            words.append(
                f"what is left of the decays is {times(loud)} the noise that their samples themselves show"
            )
        return tuple(words)


def residual_columns(
    decays: Sequence[Decay], point: Array, common: int, samples: Callable[[int, Signal], Array]
) -> Array:
    """Derivatives of the residuals (model − sample)/σ by the unknowns of a point, and these residuals,
    (samples, unknowns + 1).

    common : number of the unknowns common to all decays, F_k first.
    samples : (number of a decay, channel) → samples and their derivatives by the common unknowns and the start state.
    """
    blocks = []
    for i, (one, friction) in enumerate(
        zip(decays, friction_places(decays, point.size), strict=True)
    ):
        begin = point.size - STATE * (len(decays) - i)
        places = [friction, *range(1, common), *range(begin, begin + STATE)]
        for signal in one.signals:
            part, offset = samples(i, signal), common + signal.offset
            block = np.zeros((signal.t.size, point.size + 1))
            block[:, places] = part[:, 1:]
            block[:, offset] = 1.0
            block[:, -1] = part[:, 0] + point[offset] - signal.values
            blocks.append(block / signal.noise)
    return np.vstack(blocks)


def friction_places(decays: Sequence[Decay], size: int) -> list[int]:
    """Place of the friction force of each decay in a point of so many unknowns: F_k, or one before the start states."""
    further = size - STATE * len(decays) - max(one.friction for one in decays)
    return [further + one.friction - 1 if one.friction else 0 for one in decays]


def fit_decays(
    decays: Sequence[Decay],
    k: float,
    start: Array,
    *,
    given: Collection[int] = (),
    gain: float = GAIN,
    most: int = MOST_EVALUATIONS,
) -> RingFit | None:
    """The fit in which a climb from a start point ends; None where the model has no motion there.

    given : numbers of the unknowns that keep their values.   gain : of half of χ², where the climb ends.
    most : evaluations.
    """
    samples = DecaySamples.of(decays, k, start.size)
    end = samples.climb(start, given, gain=gain, most=most)
    if end is None:
        return None
    free = np.ones(start.size, dtype=np.bool_)
    free[[*given]] = False
    return RingFit(
        k=k,
        point=end.point,
        covariance=inverse_information(
            end.products[:-1, :-1] * np.outer(free, free), preload_errors(start.size, len(decays))
        ),
        chi_square=end.chi_square,
        rigid=bool(end.point[RHO] <= samples.rigid),
        decays=tuple(decays),
        free=free,
    )


class DecaySamples(NamedTuple):
    """The samples of decays as kernels take them, and climbs on them.

    offsets : number of offsets and friction forces after the first.   channels : table, decay by decay.   values : of
    all samples.
    """

    decays: Sequence[Decay]
    k: float
    offsets: int
    channels: Array
    values: Array

    @classmethod
    def of(cls, decays: Sequence[Decay], k: float, unknowns: int) -> DecaySamples:
        """Pack the samples of decays for a fit with so many unknowns."""
        rows, end = [], 0
        for i, (one, friction) in enumerate(
            zip(decays, friction_places(decays, unknowns), strict=True)
        ):
            for signal in one.signals:
                begin, end = end, end + signal.t.size
                of, (first, step, _) = (i, signal.order, signal.offset), one.grid(signal)
                until = one.last_sample - one.start
                rows.append((*of, first, step, signal.noise, begin, end, until, friction))
        values = np.concatenate([signal.values for one in decays for signal in one.signals])
        offsets = unknowns - len(OSCILLATOR_UNKNOWNS) - STATE * len(decays)
        return cls(decays, k, offsets, np.array(rows, dtype=float), values)

    @property
    def rigid(self) -> float:
        """The ρ that stands for a rigid contact."""
        return 1.0 / math.sqrt(_STIFFEST * self.k)

    def bounds(self, start: Array, given: Collection[int] = ()) -> ClimbBounds:
        """The bounds of a climb from a start; `given` are the numbers of the unknowns that keep their values."""
        free = np.ones(start.size, dtype=np.bool_)
        free[[*given]] = False
        first_state = len(OSCILLATOR_UNKNOWNS) + self.offsets
        F_k, _, rho, m = start[: len(OSCILLATOR_UNKNOWNS)].tolist()
        critical, omega = math.sqrt(self.k * m), math.sqrt(self.k / m)
        lower, upper = np.full(start.size, -math.inf), np.full(start.size, math.inf)
        scale = np.ones(start.size)
        # with no contact at all, a mass this light is critically damped, even if the period is that of two turns
        light = self.k * (min(one.period for one in self.decays) / (8.0 * math.pi)) ** 2
        lower[:4] = 1e-9 * F_k, 0.0, self.rigid, max(m / _MASS_RANGE, min(light, m))
        upper[1:4] = _DAMPED * critical, 1.0 / math.sqrt(_LOOSEST * self.k), m * _MASS_RANGE
        states = start[first_state:].reshape(-1, STATE)
        size = np.maximum(np.maximum(np.abs(states[:, 0]), np.abs(states[:, 1]) / omega), 1e-300)
        scale[first_state::STATE], scale[first_state + 1 :: STATE] = size, size * omega
        # an earlier climb may have left no friction
        least = _UNNOTICED * self.k * float(size.max())
        scale[:4] = max(F_k, least), 1e-3 * critical, 1e-3 * rho, m
        frictions = friction_places(self.decays, start.size)
        lower[frictions], scale[frictions] = lower[0], scale[0]
        lower[first_state + 2 :: STATE], upper[first_state + 2 :: STATE] = 0.0, 2.0
        for offset, noise in self.channels[:, (OFFSET, NOISE)].tolist():
            scale[len(OSCILLATOR_UNKNOWNS) + int(offset)] = noise
        return ClimbBounds(free, lower, upper, scale)

    def climb(
        self, start: Array, given: Collection[int] = (), *, gain: float, most: int
    ) -> Climb | None:
        """The end of a climb from a start; None where the model has no motion there."""
        # a motion with more phases is none that the samples show
        most_phases = 64 + max(one.samples for one in self.decays) // 4
        rows = np.empty((min(most_phases, MOST_PHASES), 5))

        def evaluate(point: Array, out: Array) -> bool:
            return decay_products(
                point, self.k, self.offsets, self.channels, self.values, rows, out
            )

        return climb(evaluate, start, self.bounds(start, given), gain=gain, most=most)

    def climbs(
        self, starts: Iterable[Array], given: Collection[int] = (), *, gain: float, most: int
    ) -> list[Climb]:
        """The ends of climbs from many starts, the lowest first; those without a motion are left out."""
        ends = (self.climb(start, given, gain=gain, most=most) for start in starts)
        return sorted(filter(None, ends), key=lambda end: end.chi_square)


def with_intervals(fits: Sequence[RingFit]) -> RingFit:
    """The lowest of some minima, with the intervals that all of them leave.

    An interval is the hull of {χ² − χ²_min < 3.84} over all minima: profiled over the other unknowns at the lowest,
    from the standard errors at the others. Noise lowers one minimum of many by more than that: minima higher up count
    until those left out have less than a fortieth of the likelihood of all, integrated over the unknowns.
    """
    best = fits[0]
    others = [
        one
        for one, share in zip(fits[1:], _shares_above(fits), strict=True)
        if share > NEGLECTED_LIKELIHOOD
    ]
    ranges = {}
    for j, name in enumerate(OSCILLATOR_UNKNOWNS[:-1]):
        if not best.error(name) > 0.0:
            continue
        if name == "F_k" and best.frictions.size > 1:
            low, high = best.friction.interval
        else:
            low, high = _end(best, j, -1.0), _end(best, j, 1.0)
        for one in others:
            left = max(_LEVEL - (one.chi_square - best.chi_square), 0.0)
            reach = math.sqrt(left) * one.error(name)
            low, high = min(low, one.value(name) - reach), max(high, one.value(name) + reach)
        ranges[name] = (low, high)
    return replace(best, ranges=ranges, minima=1 + len(others))


def _shares_above(fits: Sequence[RingFit]) -> Array:
    """The share in the likelihood, integrated over the unknowns, of each minimum but the lowest with those above it."""
    sizes = []
    for one in fits:
        errors, free = one.errors, one.errors > 0.0
        common = one.covariance[: len(OSCILLATOR_UNKNOWNS), : len(OSCILLATOR_UNKNOWNS)][
            np.ix_(free, free)
        ]
        _, logarithm = np.linalg.slogdet(common / np.outer(errors[free], errors[free]))
        volume = float(np.log(errors[free]).sum()) + 0.5 * logarithm
        sizes.append(volume - 0.5 * (one.chi_square - fits[0].chi_square))
    parts = np.exp(np.array(sizes) - max(sizes))
    return np.cumsum(parts[::-1])[::-1][1:] / parts.sum()


def _end(fit: RingFit, j: int, side: float) -> float:
    """Where χ², with unknown j held and the others free, has risen by 3.84.

    The root of the rise is nearly proportional to the distance: each trial gives the next one. The first starts along
    the covariance, the next ones where the others have followed before.
    """
    samples, size = DecaySamples.of(fit.decays, fit.k, fit.point.size), len(OSCILLATOR_UNKNOWNS)
    distance = side * NORMAL_95 * math.sqrt(fit.covariance[j, j])
    given = {*np.flatnonzero(np.diag(fit.covariance) == 0.0).tolist(), j}
    near = fit.point + fit.covariance[:, j] * (distance / fit.covariance[j, j])
    near[:size] = np.maximum(near[:size], 1e-3 * fit.point[:size])
    for _ in range(_PROFILES):
        if fit.point[j] + distance <= 0.0:
            break
        best = None
        for start in (near.copy(), fit.point.copy()):
            start[j] = fit.point[j] + distance
            held = samples.climb(start, given, gain=_COARSE, most=12)
            if held is not None and (best is None or held.chi_square < best.chi_square):
                best = held
            if best is not None and best.chi_square - fit.chi_square < 2.0 * _LEVEL:
                break
        if best is None:
            break
        near, rise = best.point, best.chi_square - fit.chi_square
        # where χ² does not rise, the end is farther away
        factor = min(max(NORMAL_95 / math.sqrt(max(rise, 1e-3)), 0.4), 2.5)
        distance *= factor
        if abs(factor - 1.0) < _CLOSE_END:
            break
    return float(fit.point[j]) + distance


def inverse_information(information: Array, errors: Array) -> Array:
    """The covariance of unknowns with this information, (p, p), and prior standard errors, (p,); zero for an unknown on
    which nothing depends."""
    sizes = np.diag(information)
    free = np.flatnonzero(sizes > 1e-150)  # on what is smaller nothing depends
    some = information[np.ix_(free, free)] + np.diag(errors[free] ** -2)
    length = np.sqrt(np.diag(some))
    scaled = some / np.outer(length, length)
    covariance = np.zeros_like(information)
    # what rounding cannot tell apart is uncertain, not certain
    inverse = np.linalg.inv(scaled + 1e-14 * np.eye(free.size))
    covariance[np.ix_(free, free)] = 0.5 * (inverse + inverse.T) / np.outer(length, length)
    return covariance


def preload_errors(size: int, decays: int) -> Array:
    """Prior standard errors of the unknowns, (p,): w lies between 0 and 2; the others have no prior."""
    errors = np.full(size, math.inf)
    errors[size - STATE * decays + 2 :: STATE] = _PRELOAD_ERROR
    return errors


def with_noise_of(fit: RingFit) -> RingFit:
    """The fit repeated with the noise of each channel estimated from its residual."""
    sums: dict[int, Array] = {}
    for _, signal, residual in fit.residuals():
        total = sums.setdefault(signal.offset, np.zeros(2))
        total += float(residual @ residual) * signal.noise**2, residual.size
    share = fit.samples / max(1, fit.freedom)
    noise = {offset: math.sqrt(square / n * share) for offset, (square, n) in sums.items()}

    def with_noise(signal: Signal) -> Signal:
        return replace(signal, noise=max(noise[signal.offset], least_noise(signal.values)))

    decays = [replace(one, signals=tuple(map(with_noise, one.signals))) for one in fit.decays]
    return fit_decays(decays, fit.k, fit.point) or fit


def numbers_of(point: Array, k: float) -> Parameters:
    """The oscillator of a point."""
    F_k, c, rho, m = point[: len(OSCILLATOR_UNKNOWNS)].tolist()
    return Parameters(m, c, k, rho**-2, F_k, 0.0, 0.0)


def phases_of(point: Array, state: Array, k: float, until: float) -> Array:
    """Rows (t, s, x, ẋ, z) of the motion from a start state (x, ẋ, w) at t = 0 on.

    Raises ValueError where the contact rattles on.
    """
    par = numbers_of(point, k)
    x, v, preload = state.tolist()
    rows = np.empty((MOST_PHASES, 5))
    Z_m = par.F_k / par.K_z
    z = min(max((preload - 1.0) * Z_m, -Z_m), Z_m)
    count, t, *_ = run(x, v, z, 0.0, until, 0.0, par, rows)
    if t < until:
        raise ValueError("the contact slips on and on")
    return rows[:count]
