"""Free decays of one oscillator as a problem of maximum likelihood, in all their band or in that of the mode.

From the start of a decay on, the base being at rest, the mass follows

    m ẍ + c ẋ + k x + f + (further terms) = 0,   ḟ = K_z ẋ within |f| ≤ F_k

with x counted from the rest position of the spring (`motion.law_decays`); a pendulum has k sin x. c, ρ = K_z^{−1/2}
and m are common to all decays, and so is F_k unless decays are numbered as having friction forces of their own: F_k is
then their mean. Further terms are zero unless they are freed: another law is the same problem with other free unknowns.
Each channel of a record has a separate offset, which for a displacement holds the rest position of the spring; each
decay has its start state (x, ẋ, w), f = (w − 1) F_k with 0 ≤ w ≤ 2. The stiffness k is given.

The noise is white, in all the band of the samples or in that of the mode, where the same filter acts on samples and
model: what lies outside says nothing of F_k and c. Samples at the ends of a converter's range are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..arrays import Array, Mask
from ..model import Parameters
from ..motion.events import PHASE_S, PHASE_T
from ..motion.law_decays import ADDED, DECAY_UNKNOWNS, LINEAR_UNKNOWNS, law_decay
from ..motion.unknowns import F_K, OSCILLATOR_UNKNOWNS, RHO, C, M
from ..signals.band import NOISE_PASSED, Band, filtered
from ..signals.band import freedom as freedom_in_band
from ..signals.bursts import Signal, least_noise
from ..signals.coupling import ac_coupled, ac_start
from ..signals.thresholds import P_OF_THE_MODEL
from ..signals.whiteness import chance_of_averages, chance_of_lines, excess_over_noise
from ..solver import NORMAL_95
from .climb import GAIN, MOST_EVALUATIONS, Climb, ClimbBounds
from .minimise import climb_on, inverse_information
from .oscillator_fit import NamedFit
from .scattering_mean import ScatteringMean
from .score import Departure, departures_from

CORNER = "corner"
"""Corner of an AC coupling of the channels, a high-pass of first order iω/(iω + 2πf_c), Hz; 0 for none."""

FURTHER = (*ADDED, CORNER)
"""The unknowns that are zero unless they are freed; a speed over which friction falls stands ready."""

COMMON = (*OSCILLATOR_UNKNOWNS, *FURTHER)
"""The unknowns that all decays share, first in every point."""

FALLS = (0.1, 0.03, 0.3)
"""Speeds over which friction falls, relative to the largest one, that a search tries: bearings and slides are said to
fall within the slowest tenth. Between two of them the motion hardly differs."""

STATE = 3
"""Number of unknowns of a start state: x, ẋ and the preload w."""

_LOOSEST, _STIFFEST = (
    1e-4,
    1e5,
)  # of K_z/k: contacts that stand for none and for a rigid one, to 1e-5 of F_k/k
_AS_RIGID = 1e4  # of K_z/k: a higher limit is none, as on it a mass rings between samples
_DAMPED = 2.0  # of c over √(km): a motion that still oscillates
_MASS_RANGE = 10.0  # of the mass over that of the start, either way: three times the period
_UNNOTICED = 1e-9  # of the force of the spring: a friction that no motion shows
_PRELOAD_ERROR = 1.0  # a priori: w lies between 0 and 2
_BINS_OF_A_CYCLE = 12  # of a cycle, in which the residual is averaged
_A_CYCLE, _THINNED = 64, 2500  # samples of a cycle, and of a decay, that a search looks at
_AFTER_REST = 1.0  # of a cycle after the mass came to rest that shows its level
_MOST_PHASES = 4097  # of a motion, with the first
_NO_PHASES = np.empty((0, 5))
_NEGLECTED = 2.0 * math.log(40.0)  # of χ²: a minimum so far up has a fortieth of the likelihood
_SCAN = np.geomspace(0.5, 1e5, 45)  # K_z/k, from a contact that hardly acts to one as good as rigid
_FINE = np.arange(-30, 31) * 0.25  # cycles of ringing, a quarter of one from one to the next
_CHORD = 3e-2  # of ρ√k, K_z = 1100 k: the motion of stiffer contacts depends on ρ², so that the slope by ρ vanishes
_SMALL = 1e-3  # of √(km): damping that counts as none where a climb ends
_SLOWEST = (
    0.01  # of the largest speed: a friction that falls sooner has fallen in all samples but a few
)


@dataclass(frozen=True, eq=False)
class Decay:
    """The samples of one free decay.

    source : of its record.   start, end : s.   signals : its channels, cut to the decay.   period : of the motion, s,
    about.   friction : number of its friction force, 0 for the first, which all decays share by default.   whole : the
    decay with all samples of its record, of which this one is a part, up to the next release.   of_cycles : cycles of
    the long decay of which this is an excerpt, 0 for none.
    """

    source: str
    start: float
    end: float
    signals: tuple[Signal, ...]
    period: float
    friction: int = 0
    whole: Decay | None = None
    of_cycles: int = 0

    def cut(self, start: float, end: float) -> Decay:
        """Return the part of the decay between two times, s."""
        signals = tuple(one.between(start, end) for one in self.signals)
        return replace(self, start=start, end=end, signals=signals, whole=self.whole or self)

    def until(self, end: float) -> Decay:
        """Return the decay up to a later time, s, at most the next release."""
        whole = self.whole or self
        pairs = zip(whole.signals, self.signals, strict=True)
        signals = tuple(replace(one, noise=own.noise) for one, own in pairs)
        return replace(self, signals=signals).cut(self.start, min(end, whole.end))

    def thinned(self, most: int = _THINNED) -> Decay:
        """Return the decay with every n-th sample, about 64 a cycle and no more than `most`."""
        signals = []
        for one in self.signals:
            n = max(1, int(self.period / (_A_CYCLE * one.dt)), round(one.t.size / most))
            signals.append(one.part(slice(None, None, n)))
        return replace(self, signals=tuple(signals))

    @property
    def samples(self) -> int:
        """Number of samples in all channels."""
        return sum(one.t.size for one in self.signals)


@dataclass(frozen=True, eq=False)
class DecayProblem:
    """The samples of decays, and which unknowns of the oscillator are to be found.

    k : N/m.   band : in which the decays are fitted; None for all of it.   free : names of the common unknowns that
    move.   pendulum : whether the restoring torque is k sin x.
    """

    decays: tuple[Decay, ...]
    k: float
    band: Band | None = None
    free: tuple[str, ...] = OSCILLATOR_UNKNOWNS
    names: tuple[str, ...] = COMMON
    pendulum: bool = False

    @property
    def offsets(self) -> int:
        """Number of channels of all records."""
        return 1 + max(signal.offset for one in self.decays for signal in one.signals)

    @property
    def size(self) -> int:
        """Number of all unknowns."""
        frictions = max(one.friction for one in self.decays)
        return len(COMMON) + self.offsets + frictions + STATE * len(self.decays)

    @property
    def samples(self) -> int:
        """Number of samples in all decays."""
        return sum(one.samples for one in self.decays)

    @property
    def rigid(self) -> float:
        """The ρ that stands for a rigid contact."""
        return 1.0 / math.sqrt(_STIFFEST * self.k)

    @property
    def friction_places(self) -> list[int]:
        """Place of the friction force of each decay in the point: F_k, or one before the start states."""
        first = len(COMMON) + self.offsets - 1
        return [first + one.friction if one.friction else F_K for one in self.decays]

    def places(self, i: int) -> slice:
        """Return places of the start state x, ẋ, w of decay i in the point."""
        first = self.size - STATE * (len(self.decays) - i)
        return slice(first, first + STATE)

    def is_free(self, name: str) -> bool:
        """Return whether a common unknown is to be found."""
        return name in self.free

    def thinned(self) -> DecayProblem:
        """Return the problem with as many samples as a search needs."""
        most = _THINNED // len(self.decays)
        return replace(self, decays=tuple(one.thinned(most) for one in self.decays))

    def with_free(self, *names: str) -> DecayProblem:
        """Return the problem with further unknowns free."""
        return replace(self, free=(*self.free, *(s for s in names if s not in self.free)))

    def point(self, common: Array, offsets: Array, states: Iterable[Array]) -> Array:
        """Return the point of an oscillator (F_k, c, ρ, m, …), offsets and start states, without further terms."""
        point = np.zeros(self.size)
        point[: common.size] = common
        point[len(COMMON) : len(COMMON) + offsets.size] = offsets
        point[len(COMMON) + self.offsets : self.size - STATE * len(self.decays)] = common[F_K]
        point[self.size - STATE * len(self.decays) :] = np.concatenate([*states])
        given = point[COMMON.index("falling_speed")] > 0.0
        return point if given else self.falling_over(point, FALLS[0])

    def falling_over(self, point: Array, part: float) -> Array:
        """Return the point with a part of the largest speed of the decays as that over which friction falls."""
        states = point[point.size - STATE * len(self.decays) :].reshape(-1, STATE)
        top = np.hypot(states[:, 0] * math.sqrt(self.k / point[M]), states[:, 1]).max()
        moved = point.copy()
        moved[COMMON.index("falling_speed")] = part * top
        return moved

    def _motion(
        self,
        point: Array,
        i: int,
        times: Array,
        order: int,
        count: int,
        phases: Array = _NO_PHASES,
    ) -> Array:
        """Return what `law_decay` does of decay i at times from its start on.   count : of the derivatives."""
        _, c, rho, m = point[: len(OSCILLATOR_UNKNOWNS)].tolist()
        x, v, w = point[self.places(i)].tolist()
        F_k, gravity = float(point[self.friction_places[i]]), float(self.pendulum)
        par = Parameters(m, c, self.k, rho**-2, F_k, 0.0, 0.0)
        added = point[len(OSCILLATOR_UNKNOWNS) : len(OSCILLATOR_UNKNOWNS) + len(ADDED)]
        return law_decay(times, order, x, v, w, par, added, count, gravity, phases)

    def phases(self, point: Array, i: int, until: float) -> Array:
        """Return rows (t, s, x, ẋ, z) of the motion of decay i, t from its start, to a time, s.

        Raises ValueError where the contact rattles on.
        """
        rows, times = np.full((_MOST_PHASES, 5), math.nan), np.array([until])
        if not np.isfinite(self._motion(point, i, times, 0, LINEAR_UNKNOWNS, rows)).all():
            raise ValueError("the contact slips on and on")
        return rows[np.isfinite(rows[:, PHASE_T])]

    def columns(self, point: Array, *, added: bool = False) -> Array:
        """Return derivatives of the residuals (model − sample)/σ by the unknowns, and these residuals, (samples, p +
        1), decay by decay, channel by channel; NaN where the contact rattles.

        added : whether derivatives by `FURTHER` are wanted that are not free.
        """
        added = added or any(symbol in self.free for symbol in FURTHER)
        corner = float(point[COMMON.index(CORNER)])
        blocks = []
        for i, one in enumerate(self.decays):
            own = self.places(i)
            at = [self.friction_places[i], C, RHO, M, *range(own.start, own.stop)]
            at += [COMMON.index(symbol) for symbol in FURTHER] if added else []
            for signal in one.signals:
                offset, count = len(COMMON) + signal.offset, LINEAR_UNKNOWNS
                count = len(DECAY_UNKNOWNS) if added else count
                part = self._motion(point, i, signal.t - one.start, signal.order, count)
                if added or corner:
                    part = ac_coupled(part, signal.dt, corner)
                    part = part if added else part[:, :-1]
                # what the coupling still holds of the time before decays exponentially
                level, start = np.ones(signal.t.size), ac_start(signal.t.size, signal.dt, corner)
                part = np.column_stack([part, level, start])
                part[:, 0] += point[offset] - signal.values
                part[signal.left_out] = 0.0
                if self.band is not None:
                    part = filtered(part, signal.dt, self.band)
                part, start = part[:, :-1], part[:, -1]
                if corner:
                    part -= np.outer(start, start @ part / (start @ start))
                block = np.zeros((signal.t.size, point.size + 1))
                block[:, [-1, *at, offset]] = part / signal.noise
                blocks.append(block)
        whole = np.vstack(blocks)
        whole[:, RHO] *= 1.0 + 0.5 * contact_chord(float(point[RHO]), self.k) / point[RHO]
        return whole

    def products(self, point: Array, out: Array) -> bool:
        """Set `out` to JᵀJ bordered by Jᵀr and χ²; false where the contact rattles."""
        with np.errstate(over="ignore", invalid="ignore"):  # of a motion that grows without bound
            whole = self.columns(point)
            np.matmul(whole.T, whole, out=out)
        return bool(np.isfinite(out).all())

    def moving(self) -> Mask:
        """Return which unknowns move: in the band of the mode there is no offset."""
        free = np.ones(self.size, dtype=np.bool_)
        free[: len(COMMON)] = [symbol in self.free for symbol in COMMON]
        if self.band is not None:
            free[len(COMMON) : len(COMMON) + self.offsets] = False
        if "F_k" not in self.free:
            free[self.friction_places] = False
            for i in range(len(self.decays)):
                free[self.places(i).stop - 1] = free[RHO]
        return free

    def bounds(self, start: Array) -> ClimbBounds:
        """Return the bounds of a climb from a start: F_k, c, damping that grows with the speed and friction that falls
        with it are not negative."""
        F_k, _, rho, m = start[: len(OSCILLATOR_UNKNOWNS)].tolist()
        critical, omega = math.sqrt(self.k * m), math.sqrt(self.k / m)
        lower, upper = np.full(start.size, -math.inf), np.full(start.size, math.inf)
        scale = np.ones(start.size)
        # with no contact at all, a mass this light is critically damped, even if the period is that of two turns
        light = self.k * (min(one.period for one in self.decays) / (8.0 * math.pi)) ** 2
        first = self.size - STATE * len(self.decays)
        states = start[first:].reshape(-1, STATE)
        size = np.maximum(np.maximum(np.abs(states[:, 0]), np.abs(states[:, 1]) / omega), 1e-300)
        scale[first::STATE], scale[first + 1 :: STATE] = size, size * omega
        x = float(size.max())
        v = x * omega
        # an earlier climb may have left no friction
        least, frictions = _UNNOTICED * self.k * x, [F_K, *self.friction_places]
        lower[frictions], scale[frictions] = 1e-3 * least, max(F_k, least)
        lower[C], lower[RHO] = 0.0, self.rigid
        lower[M], upper[M] = max(m / _MASS_RANGE, min(light, m)), m * _MASS_RANGE
        upper[C], upper[RHO] = _DAMPED * critical, 1.0 / math.sqrt(_LOOSEST * self.k)
        scale[C : M + 1] = _SMALL * critical, 1e-3 * rho, m
        lower[first + 2 :: STATE], upper[first + 2 :: STATE] = 0.0, 2.0
        by_speed, by_place = _SMALL * critical, _SMALL * self.k
        of_law = (by_speed / v, by_place / x**2)
        of_contact = (by_place * x, _SMALL * v, _SMALL, _SMALL * omega / (2.0 * math.pi))
        scale[len(OSCILLATOR_UNKNOWNS) : len(COMMON)] = (*of_law, *of_contact)
        # as much as a critical damper, or the spring itself: no motion that oscillates has more
        at = slice(len(OSCILLATOR_UNKNOWNS), len(COMMON))
        lower[at], upper[at] = -scale[at] / _SMALL, scale[at] / _SMALL
        for symbol in ("c_2", "falling", "gradual", CORNER):
            lower[COMMON.index(symbol)] = 0.0
        lower[COMMON.index("falling_speed")] = _SLOWEST * v
        for signal in (signal for one in self.decays for signal in one.signals):
            scale[len(COMMON) + signal.offset] = signal.noise
        return ClimbBounds(self.moving(), lower, upper, scale)

    def scan(self, point: Array) -> Array:
        """Return values of ρ at which χ² may have a minimum: coarse over all contacts, and fine about that of a point,
        whose ringing after the mass came to rest is a quarter of a cycle more or less from one to the next."""
        stiffness, m = self.k * _SCAN, float(point[M])
        one = self.decays[0]
        t = self.phases(point, 0, one.end - one.start)[-1, PHASE_T]
        rest = one.end - one.start - float(t)
        if rest > 0.0:
            Omega = math.sqrt((self.k + point[RHO] ** -2) / m) + 2.0 * math.pi * _FINE / rest
            fine = m * np.maximum(Omega, 0.0) ** 2 - self.k
            stiffness = np.append(stiffness, fine[fine > self.k * _SCAN[0]])
        return np.asarray(1.0 / np.sqrt(stiffness))

    @property
    def prior_errors(self) -> Array:
        """Prior standard errors of the unknowns, (p,): w lies between 0 and 2; the others have no prior."""
        errors = np.full(self.size, math.inf)
        errors[self.size - STATE * len(self.decays) + 2 :: STATE] = _PRELOAD_ERROR
        return errors

    @property
    def values(self) -> float:
        """Number of independent values that the decays hold."""
        if self.band is None:
            return self.samples
        lasts = (signal.t.size * signal.dt for one in self.decays for signal in one.signals)
        return math.fsum(NOISE_PASSED * freedom_in_band(self.band, duration) for duration in lasts)

    def fit(self, end: Climb) -> DecayFit:
        """Return the fit at the end of a climb."""
        moving = self.moving()
        products = end.products[:-1, :-1] * np.outer(moving, moving)
        return DecayFit(
            k=self.k,
            point=end.point,
            covariance=inverse_information(products, self.prior_errors),
            chi_square=end.chi_square,
            rigid=bool(end.point[RHO] <= self.rigid),
            freedom=max(self.values - int(moving.sum()), 1.0),
            problem=self,
        )

    def climb(
        self, start: Array, *, gain: float = GAIN, most: int = MOST_EVALUATIONS
    ) -> DecayFit | None:
        """Return the fit in which a climb from a start ends; None where the model has no motion there."""
        end = climb_on(self, start, gain=gain, most=most)
        return None if end is None else self.fit(end)


@dataclass(frozen=True, eq=False)
class DecayFit(NamedFit):
    """The oscillator whose free decays fit the samples of n decays best.

    minima : other minima of χ² that are nearly as good, and points along K_z that are (`search.profiled`).
    """

    problem: DecayProblem
    minima: tuple[DecayFit, ...] = field(default=())

    @property
    def decays(self) -> tuple[Decay, ...]:
        """The decays."""
        return self.problem.decays

    @property
    def free(self) -> Mask:
        """Which unknowns were not given, (p,)."""
        return self.problem.moving()

    @cached_property
    def _columns(self) -> Array:
        return self.problem.columns(self.point) * np.append(self.free, True)

    @property
    def jacobian(self) -> Array:
        """Derivatives of the residual by the unknowns, (samples, p); zero where one was given."""
        return self._columns[:, :-1]

    @property
    def residual(self) -> Array:
        """(model − sample)/σ, (samples,), in the band of the fit."""
        return self._columns[:, -1]

    @property
    def samples(self) -> int:
        """Number of samples in all decays."""
        return self.problem.samples

    @property
    def friction_places(self) -> list[int]:
        """Place of the friction force of each decay in the point."""
        return self.problem.friction_places

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
        """Return a common unknown, in its unit; of several friction forces their mean."""
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
        """Return the point with the friction force of decay i in the place of F_k."""
        point = self.point.copy()
        point[F_K] = point[self.friction_places[i]]
        return point

    def interval(self, name: str) -> tuple[float, float]:
        """Return the 95 % interval of a common unknown, in its unit, over all minima that are within its χ²."""
        low, high = super().interval(name)
        if name == "F_k" and self.frictions.size > 1:
            return self.friction.interval
        for one in self.minima:
            if one.chi_square > self.chi_square + _NEGLECTED:
                continue
            reach = math.sqrt(max(NORMAL_95**2 - (one.chi_square - self.chi_square), 0.0))
            reach *= one.error(name)
            low, high = min(low, one.value(name) - reach), max(high, one.value(name) + reach)
        as_rigid = name == "rho" and low * math.sqrt(_AS_RIGID * self.k) < 1.0
        return (0.0 if as_rigid else low), high

    def places(self, i: int) -> slice:
        """Return places of the start state x, ẋ, w of decay i in the point."""
        return self.problem.places(i)

    def phases(self, i: int, end: float | None = None) -> Array:
        """Return rows (t, s, x, ẋ, z) of the motion of decay i, t from its start, to its end or another one, s."""
        one = self.decays[i]
        until = (one.end if end is None else end) - one.start
        return self.problem.phases(self.point, i, until)

    def sticks_from(self, i: int, end: float | None = None) -> float:
        """Return the time, s after its start, from which on the mass of decay i sticks; infinite where it moves up to
        the end of the decay, or to another one, s."""
        last = self.phases(i, end)[-1]
        return float(last[PHASE_T]) if last[PHASE_S] == 0.0 else math.inf

    def at_rest(self, i: int, end: float | None = None) -> float:
        """Return the time, s, one cycle after the mass of decay i came to rest; infinite where it moves to the end."""
        one = self.decays[i]
        return one.start + self.sticks_from(i, end) + _AFTER_REST * one.period

    def residuals(self) -> list[tuple[int, Signal, Array]]:
        """Return the number of the decay, channel and residual of each channel of each decay."""
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
        return [residual for *_, residual in channels], widths, int(self.free.sum())

    @cached_property
    def slow_chance(self) -> float:
        """Probability that averages of white noise over parts of a cycle, down to two samples, are as large."""
        return chance_of_averages(*self._parts)

    @cached_property
    def chance(self) -> float:
        """Probability that white noise leaves a residual as similar to a motion, slow or fast; 1 in the band of the
        mode, where what lies outside is none of the fit's business."""
        if self.problem.band is not None:
            return 1.0
        return min(1.0, 2.0 * min(self.slow_chance, chance_of_lines(self._parts[0])))

    @property
    def adequate(self) -> bool:
        """Whether the residual is white, so that such an oscillator may have made the records."""
        return self.chance >= P_OF_THE_MODEL and self.loudness <= 1.0

    @property
    def white(self) -> bool:
        """Whether all the band of the samples is fitted, and the residual is white there."""
        return self.problem.band is None and self.adequate

    @cached_property
    def loudness(self) -> float:
        """How many times the noise that the samples show themselves the residual is; 1 where it is that noise."""
        if self.problem.band is not None:
            return 1.0
        return max(
            excess_over_noise(r, signal.values, signal.noise) for _, signal, r in self.residuals()
        )

    @cached_property
    def residual_share(self) -> float:
        """Root mean square of the residual over that of the motion, in the band of the fit."""
        motion = np.concatenate([signal.values / signal.noise for _, signal, _ in self.residuals()])
        left = float(np.sum(self.residual**2))
        return math.sqrt(left / max(float(np.sum((motion - motion.mean()) ** 2)), 1e-300))


def with_noise_of(fit: DecayFit) -> DecayFit:
    """Return the fit with the noise of each channel estimated from its residual: climbed on where the channels are
    several."""
    problem, sums = fit.problem, dict[int, Array]()
    for _, signal, residual in fit.residuals():
        total = sums.setdefault(signal.offset, np.zeros(2))
        total += float(residual @ residual) * signal.noise**2, residual.size
    # each channel has its share of the freedom
    lost = fit.freedom / problem.values
    per_sample = problem.values / problem.samples

    def with_noise(signal: Signal) -> Signal:
        square, n = sums[signal.offset]
        sigma = math.sqrt(square / (n * lost * per_sample))
        return replace(signal, noise=max(sigma, least_noise(signal.values)))

    decays = [replace(one, signals=tuple(map(with_noise, one.signals))) for one in fit.decays]
    problem = replace(problem, decays=tuple(decays))
    ends = filter(None, (problem.climb(one.point) for one in (fit, *fit.minima)))
    best, *others = sorted(ends, key=lambda one: one.chi_square) or [fit]
    return replace(best, minima=tuple(others))


def departures_of(fit: DecayFit) -> list[Departure]:
    """Test what each of `FURTHER` that is not free would explain in the band of the fit; empty where the motion cannot
    be followed."""
    problem = fit.problem
    whole = problem.columns(fit.point, added=True)
    if not np.isfinite(whole).all():
        return []
    moving = problem.moving()
    # of several friction forces, by their mean and by the others' distance from the first
    further = [*dict.fromkeys(problem.friction_places)][1:]
    first_force = whole[:, [F_K]]
    whole[:, [F_K]] += whole[:, further].sum(axis=1, keepdims=True)
    whole[:, further] -= first_force
    own = np.flatnonzero(moving & (np.abs(whole[:, :-1]).max(axis=0) > 0.0))
    added = {s: whole[:, COMMON.index(s)] for s in FURTHER if s not in problem.free}
    names = [COMMON[at] for at in own if at < len(COMMON)]
    return departures_from(
        whole[:, -1], whole[:, own], added, names, noise_known=False, freedom=fit.freedom
    )


def contact_chord(rho: float, k: float) -> float:
    """Return the step in ρ over which its derivative is taken; 0 where that is the derivative itself.

    Close to a rigid contact the motion depends on K_z^{−1} = ρ², and a chord replaces the slope, which vanishes.
    """
    chord = _CHORD / math.sqrt(k)
    return chord if rho < 0.3 * chord else 0.0
