"""Free decays of one oscillator as a problem of maximum likelihood, in all their band or in that of the mode.

From the start of a decay on, the base being at rest, the mass follows

    m ẍ + c ẋ + k x + f + (further terms) = 0,   ḟ = K_z ẋ within |f| ≤ F_k

with x counted from the rest position of the spring (`motion.law_decays`); a pendulum has k sin x. c, ρ = K_z^{−1/2}
and m are common to all decays, and so is F_k unless groups of decays have separate friction forces: F_k is
then their mean. Further terms are zero unless they are freed: another law is the same problem with other free unknowns.
Each channel of a record has a separate offset, which for a displacement holds the rest position of the spring; each
decay has its start state (x, ẋ, w), f = (w − 1) F_k with 0 ≤ w ≤ 2. The stiffness k is given.

The noise is white, in all the band of the samples or in that of the mode, where the same filter acts on samples and
model: what lies outside says nothing of F_k and c. Samples at the ends of a converter's range are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers, Mask
from ..model import Parameters as Numbers
from ..motion.events import PHASE_S, PHASE_T
from ..motion.law_decays import ADDED, DECAY_UNKNOWNS, LINEAR_UNKNOWNS, law_decay
from ..motion.unknowns import OSCILLATOR_UNKNOWNS, RHO, M
from ..signals.band import NOISE_PASSED, Band, filtered
from ..signals.band import freedom as freedom_in_band
from ..signals.bursts import Signal, least_noise
from ..signals.coupling import ac_coupled, ac_start
from ..signals.thresholds import P_OF_THE_MODEL
from ..signals.whiteness import chance_of_averages, chance_of_lines, excess_over_noise
from ..solver import NORMAL_95
from .climb import GAIN, MOST_EVALUATIONS, Climb
from .errors import inverse_information
from .fit import OscillatorFit
from .multistart import Trail, climb_on
from .parameters import Parameter, Parameters
from .scattering_mean import ScatteringMean

CORNER = "corner"
"""Corner of an AC coupling of the channels, a high-pass of first order iω/(iω + 2πf_c), Hz; 0 for none."""

FURTHER = (*ADDED, CORNER)
"""The unknowns that are zero unless they are freed; a speed over which friction falls stands ready."""

STATE = ("x", "v", "w")
"""The unknowns of a start state: x, ẋ and the preload w."""

FALLS = (0.1, 0.03, 0.3)
"""Speeds over which friction falls, relative to the largest one, that a search tries: the friction of bearings and
slides is said to fall within the slowest tenth. The motion hardly differs from one of these speeds to the next."""

FRICTION_FORCE = "F_k"
_LEVEL = "offset"
_START = [DECAY_UNKNOWNS.index(name) for name in STATE[:2]]
SHARED = (*OSCILLATOR_UNKNOWNS, *FURTHER)
_ANY = (-math.inf, math.inf)
_OF_A_DECAY = (*DECAY_UNKNOWNS, CORNER)  # in the order of its motion
_LOOSEST, _STIFFEST = 1e-4, 1e5  # of K_z/k: for none, and for a rigid one to 1e-5 of F_k/k
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
_MOST_ROUNDED = 0.95  # of F_k, by which friction may be less at rest: the contact still sticks
_SLOWEST = 0.01  # of the largest speed: sooner, friction has fallen in all samples but a few


@dataclass(frozen=True, eq=False)
class Decay:
    """The samples of one free decay.

    source : of its record.   start, end : s.   signals : its channels, cut to the decay.   period : of the motion, s,
    about.   friction : group of its friction force; empty where all decays share one.   whole : the decay with all
    samples of its record, of which this one is a part, up to the next release.   of_cycles : cycles of the long decay
    of which this is an excerpt, 0 for none.
    """

    source: str
    start: float
    end: float
    signals: tuple[Signal, ...]
    period: float
    friction: str = ""
    whole: Decay | None = None
    of_cycles: int = 0

    @property
    def label(self) -> str:
        """Group of its start state, whichever part of the decay this is."""
        return f"{channel_of(self.signals[0])}, {(self.whole or self).start:.9g} s"

    def key(self, name: str) -> str:
        """Return the key of an unknown of this decay."""
        return Parameter(name, 0.0, group=self.group(name)).key

    def group(self, name: str) -> str:
        """Return the group that has an unknown of this decay."""
        return self.label if name in STATE else self.friction if name == FRICTION_FORCE else ""

    def state(self, x: float, v: float, w: float) -> dict[str, float]:
        """Return a start state by key."""
        return dict(zip(map(self.key, STATE), (x, v, w), strict=True))

    def cut(self, start: float, end: float) -> Decay:
        """Return the part of the decay between two times, s."""
        signals = tuple(one.between(start, end) for one in self.signals)
        return replace(self, start=start, end=end, signals=signals, whole=self.whole or self)

    def recut(self, start: float, end: float) -> Decay:
        """Return the decay between two other times, s, up to the next release at most."""
        whole = self.whole or self
        pairs = zip(whole.signals, self.signals, strict=True)
        signals = tuple(replace(one, noise=own.noise) for one, own in pairs)
        return replace(self, signals=signals).cut(start, min(end, whole.end))

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


def channel_of(signal: Signal) -> str:
    """Return the group of the offset of a channel."""
    return f"channel {signal.offset + 1}"


def offset_of(signal: Signal) -> str:
    """Return the key of the offset of a channel."""
    return Parameter(_LEVEL, 0.0, group=channel_of(signal)).key


@dataclass(frozen=True, eq=False)
class DecayProblem:
    """Residuals of the samples of one oscillator's decays as functions of its unknowns: what is fitted.

    k : N/m.   band : in which the decays are fitted; None for all of it.   pendulum : whether the restoring torque is
    k sin x.   slips : number of slips over which friction that fades does so.
    """

    decays: tuple[Decay, ...]
    k: float
    band: Band | None = None
    pendulum: bool = False
    slips: float = 1.0

    @cached_property
    def _unknowns(self) -> Mapping[str, tuple[str, str]]:
        """Name and group of each unknown by its key, in their order."""
        channels = (channel_of(signal) for one in self.decays for signal in one.signals)
        pairs = [(name, one.group(name)) for name in SHARED for one in self.decays]
        pairs += [(_LEVEL, channel) for channel in channels]
        pairs += [(name, one.label) for one in self.decays for name in STATE]
        return {Parameter(name, 0.0, group=group).key: (name, group) for name, group in pairs}

    @cached_property
    def _order(self) -> Mapping[str, int]:
        return {key: i for i, key in enumerate(self._unknowns)}

    @cached_property
    def _places(self) -> Integers:
        """Place of each of `_OF_A_DECAY` of each decay among the unknowns."""
        keys = [map(one.key, _OF_A_DECAY) for one in self.decays]
        return np.array([[self._order[key] for key in of] for of in keys])

    @property
    def samples(self) -> int:
        """Number of samples in all decays."""
        return sum(one.samples for one in self.decays)

    @property
    def rigid(self) -> float:
        """The ρ that stands for a rigid contact."""
        return 1.0 / math.sqrt(_STIFFEST * self.k)

    def thinned(self) -> DecayProblem:
        """Return the problem with as many samples as a search needs."""
        most = _THINNED // len(self.decays)
        return replace(self, decays=tuple(one.thinned(most) for one in self.decays))

    def parameters(
        self, values: Mapping[str, float], free: Iterable[str] = OSCILLATOR_UNKNOWNS
    ) -> Parameters:
        """Return the unknowns from values by key or by name, zero without one, and their limits about these: F_k, c
        and damping that grows with the speed are not negative.

        free : names of those that a fit moves among all that decays share. Start states and offsets always move, except
        the offsets in the band of the mode, which has none, and the preload of a contact that nothing determines.
        """
        k, unknowns = self.k, self._unknowns
        own = {key: values.get(key, values.get(name, 0.0)) for key, (name, _) in unknowns.items()}
        m, first = own["m"], np.array([*own.values()])
        own["falling_speed"] = own["falling_speed"] or FALLS[0] * self.speed(first)
        critical, omega = math.sqrt(k * m), math.sqrt(k / m)
        # with no contact at all, a mass this light is critically damped, even if the period is that of two turns
        light = k * (min(one.period for one in self.decays) / (8.0 * math.pi)) ** 2
        places, speeds = np.abs(first[self._places[:, _START]].T)
        sizes = np.maximum(np.maximum(places, speeds / omega), 1e-300).tolist()
        x = max(sizes)
        v = x * omega
        weakest = min(own[one.key(FRICTION_FORCE)] for one in self.decays)
        # an earlier climb may have left no friction
        least = _UNNOTICED * k * x
        # as much as a critical damper, or the spring itself: no motion that oscillates has more
        most = {"c_2": critical / v, "k_3": k / x**2, "falling": k * x, "falling_speed": v}
        most |= {"gradual": 1.0, "fading": 1.0, CORNER: omega / (2.0 * math.pi)}
        ends = {name: (0.0, top, _SMALL * top) for name, top in most.items()} | {
            "c": (0.0, _DAMPED * critical, _SMALL * critical),
            "rho": (self.rigid, 1.0 / math.sqrt(_LOOSEST * k), 1e-3 * own["rho"]),
            "m": (max(m / _MASS_RANGE, min(light, m)), m * _MASS_RANGE, m),
            "k_3": (-most["k_3"], most["k_3"], _SMALL * most["k_3"]),
            "falling_speed": (_SLOWEST * v, v, _SMALL * v),
            "fading": (-1.0, 1.0, _SMALL),
            # less at rest than in motion: by no more than nearly all of it
            "falling": (-_MOST_ROUNDED * weakest, most["falling"], _SMALL * most["falling"]),
            "w": (0.0, 2.0, 1.0),
        }
        for one, size in zip(self.decays, sizes, strict=True):
            friction = one.key(FRICTION_FORCE)
            ends[friction] = 1e-3 * least, math.inf, max(own[friction], least)
            ends[one.key("x")], ends[one.key("v")] = (*_ANY, size), (*_ANY, size * omega)
            ends |= {offset_of(signal): (*_ANY, signal.noise) for signal in one.signals}
        moving = {name for name in free if name in SHARED}
        moving |= {"x", "v", *["w"] * bool({FRICTION_FORCE, "rho"} & moving)}
        moving |= {_LEVEL} if self.band is None else set()
        rows = []
        for key, (name, group) in unknowns.items():
            low, high, scale = ends.get(key) or ends[name]
            prior = _PRELOAD_ERROR if name == "w" else math.inf
            row = Parameter(name, own[key], low, high, name in moving, scale, group, prior)
            rows.append(row)
        return Parameters.of(rows)

    def posed(self, as_in: Parameters) -> Parameters:
        """Return the unknowns with the values of those of another problem, and the same of them free."""
        free = (one.name for one in as_in if one.free)
        return self.parameters(as_in.by_key, free)

    def speed(self, values: Array) -> float:
        """Return the largest speed of the decays, about, m/s."""
        omega = math.sqrt(self.k / values[self._places[0, M]])
        x, v = values[self._places[:, _START]].T
        return float(np.hypot(omega * x, v).max())

    def _motion(
        self, of: Array, times: Array, order: int, count: int, phases: Array = _NO_PHASES
    ) -> Array:
        """Return what `law_decay` does at times from the start of a decay on.   of : the values of `_OF_A_DECAY`.
        count : of the derivatives."""
        F_k, c, rho, m, x, v, w = of[:LINEAR_UNKNOWNS].tolist()
        par = Numbers(m, c, self.k, rho**-2, F_k, 0.0, 0.0)
        added, gravity = of[LINEAR_UNKNOWNS:-1], float(self.pendulum)
        return law_decay(times, order, x, v, w, par, added, count, gravity, self.slips, phases)

    def phases(self, values: Array, i: int, until: float) -> Array:
        """Return rows (t, s, x, ẋ, z) of the motion of decay i, t from its start, to a time, s.

        Raises ValueError where the contact rattles on.
        """
        rows, times = np.full((_MOST_PHASES, 5), math.nan), np.array([until])
        motion = self._motion(values[self._places[i]], times, 0, LINEAR_UNKNOWNS, rows)
        if not np.isfinite(motion).all():
            raise ValueError("the contact slips on and on")
        return rows[np.isfinite(rows[:, PHASE_T])]

    def columns(self, values: Array, *, added: bool = False) -> Array:
        """Return derivatives of the residuals (model − sample)/σ by the unknowns, and these residuals, (samples, p +
        1), decay by decay, channel by channel; NaN where the contact rattles.   added : whether derivatives by
        `FURTHER` are wanted."""
        count, blocks = len(DECAY_UNKNOWNS) if added else LINEAR_UNKNOWNS, []
        for one, at in zip(self.decays, self._places, strict=True):
            of = values[at]
            corner = float(of[-1])
            for signal in one.signals:
                offset = self._order[offset_of(signal)]
                part = self._motion(of, signal.t - one.start, signal.order, count)
                if added or corner:
                    part = ac_coupled(part, signal.dt, corner)
                    part = part if added else part[:, :-1]
                # what the coupling still holds of the time before decays exponentially
                level, start = np.ones(signal.t.size), ac_start(signal.t.size, signal.dt, corner)
                part = np.column_stack([part, level, start])
                part[:, 0] += values[offset] - signal.values
                part[signal.left_out] = 0.0
                if self.band is not None:
                    part = filtered(part, signal.dt, self.band)
                part, start = part[:, :-1], part[:, -1]
                if corner:
                    part -= np.outer(start, start @ part / (start @ start))
                block = np.zeros((signal.t.size, values.size + 1))
                block[:, [-1, *at[: part.shape[1] - 2], offset]] = part / signal.noise
                blocks.append(block)
        whole, rho = np.vstack(blocks), self._places[0, RHO]
        whole[:, rho] *= 1.0 + 0.5 * contact_chord(float(values[rho]), self.k) / values[rho]
        return whole

    def products(self, values: Array, free: Mask, trail: Trail, out: Array) -> bool:
        """Set `out` to JᵀJ bordered by Jᵀr and χ²; false where the contact rattles."""
        added = bool(free[self._places[0, LINEAR_UNKNOWNS:]].any())
        with np.errstate(over="ignore", invalid="ignore"):  # of a motion that grows without bound
            whole = self.columns(values, added=added)
            np.matmul(whole.T, whole, out=out)
        return bool(np.isfinite(out).all())

    def scan(self, parameters: Parameters) -> Array:
        """Return values of ρ at which χ² may have a minimum: coarse over all contacts, and fine about that of a point,
        whose ringing after the mass came to rest is a quarter of a cycle more or less from one to the next."""
        stiffness, m = self.k * _SCAN, parameters["m"].value
        one = self.decays[0]
        t = self.phases(parameters.values, 0, one.end - one.start)[-1, PHASE_T]
        rest = one.end - one.start - float(t)
        if rest > 0.0 and self.band is None:  # the ringing is in no other
            here = math.sqrt((self.k + parameters["rho"].value ** -2) / m)
            Omega = here + 2.0 * math.pi * _FINE / rest
            fine = m * np.maximum(Omega, 0.0) ** 2 - self.k
            stiffness = np.append(stiffness, fine[fine > self.k * _SCAN[0]])
        return np.asarray(1.0 / np.sqrt(stiffness))

    @property
    def independent(self) -> float:
        """Number of independent values that the decays hold."""
        if self.band is None:
            return self.samples
        lasts = (signal.t.size * signal.dt for one in self.decays for signal in one.signals)
        return math.fsum(NOISE_PASSED * freedom_in_band(self.band, duration) for duration in lasts)

    def fit(self, end: Climb) -> DecayFit:
        """Return the fit at the end of a climb."""
        parameters, free = end.parameters, end.parameters.free
        return DecayFit(
            parameters,
            inverse_information(end.products[:-1, :-1] * np.outer(free, free), parameters.prior),
            end.chi_square,
            max(self.independent - int(free.sum()), 1.0),
            self,
            evaluations=end.evaluations,
            promise=end.promise,
        )

    def climb(
        self, start: Parameters, *, gain: float = GAIN, most: int = MOST_EVALUATIONS
    ) -> DecayFit | None:
        """Return the fit in which a climb from a start ends; None where the model has no motion there."""
        end = climb_on(self, start, gain=gain, most=most)
        return None if end is None else self.fit(end)


class DecayFit(OscillatorFit):
    """The oscillator whose free decays fit the samples of n decays best; among its minima are points along K_z that are
    as good (`search.profiled`)."""

    problem: DecayProblem
    minima: tuple[DecayFit, ...]

    @property
    def decays(self) -> tuple[Decay, ...]:
        """The decays."""
        return self.problem.decays

    @property
    def shared(self) -> dict[str, float]:
        """Value of what all decays share, by key."""
        return {one.key: one.value for one in self.parameters if not one.group}

    @property
    def free(self) -> set[str]:
        """Names of the unknowns that were not given."""
        return {one.name for one in self.parameters if one.free}

    @property
    def further(self) -> list[str]:
        """Those of `FURTHER` that were not given."""
        return [name for name in FURTHER if name in self.free]

    @cached_property
    def residual(self) -> Array:
        """(model − sample)/σ, (samples,), in the band of the fit."""
        return self.problem.columns(self.point)[:, -1]

    @property
    def _forces(self) -> Integers:
        return np.flatnonzero([name == FRICTION_FORCE for name in self.parameters.names])

    @property
    def frictions(self) -> Array:
        """The friction forces, N: one, or that of each group of decays."""
        return self.point[self._forces]

    @property
    def friction(self) -> ScatteringMean:
        """The mean of the friction forces."""
        covariance = self.covariance[np.ix_(self._forces, self._forces)]
        return ScatteringMean.of(self.frictions, covariance)

    def value(self, key: str) -> float:
        """Return a parameter, in its unit; of several friction forces their mean, and of a contact that yields
        gradually the ρ = [K_z (1 + g)]^{−1/2} of its stiffness after a reversal."""
        if key == FRICTION_FORCE:
            return self.friction.value
        return super().value(key) / (self._stiffer**0.5 if key == "rho" else 1.0)

    @property
    def _stiffer(self) -> float:
        return 1.0 + self.parameters["gradual"].value

    @property
    def at_once(self) -> float:
        """K_z of the contact that yields where this one does, and at once, N/m."""
        return self.K_z / self._stiffer

    def covariance_of(self, *keys: str) -> Array:
        """Return the covariance of some parameters; that of F_k includes the scatter of several friction forces."""
        slopes = np.zeros((len(keys), self.point.size))
        for slope, key in zip(slopes, keys, strict=True):
            of = self._forces if key == FRICTION_FORCE else [self.parameters.places[key]]
            slope[of] = 1.0 / len(of)
            if key == "rho":
                slope /= self._stiffer**0.5
                slope[self.parameters.places["gradual"]] = -0.5 * self.value(key) / self._stiffer
        covariance = slopes @ self.covariance @ slopes.T
        if self.frictions.size > 1:
            own = [key == FRICTION_FORCE for key in keys]
            covariance[np.ix_(own, own)] = self.friction.error**2
        return covariance

    def interval(self, key: str) -> tuple[float, float]:
        """Return the 95 % interval of a parameter, in its unit, over all minima that are within its χ²."""
        if key == FRICTION_FORCE and self.frictions.size > 1:
            return self.friction.interval
        low, high = super().interval(key)
        for one in self.minima:
            if one.chi_square > self.chi_square + _NEGLECTED:
                continue
            reach = math.sqrt(max(NORMAL_95**2 - (one.chi_square - self.chi_square), 0.0))
            reach *= one.error(key)
            low, high = min(low, one.value(key) - reach), max(high, one.value(key) + reach)
        as_rigid = key == "rho" and low * math.sqrt(_AS_RIGID * self.k) < 1.0
        return (0.0 if as_rigid else low), high

    @cached_property
    def slips(self) -> float:
        """Number of slips of the longest motion."""
        many = 1.0
        with suppress(ValueError):  # the contact rattles on
            for i in range(len(self.decays)):
                many = max(many, float(np.count_nonzero(self.phases(i)[:, PHASE_S])))
        return many

    def phases(self, i: int, end: float | None = None) -> Array:
        """Return rows (t, s, x, ẋ, z) of the motion of decay i, t from its start, to its end or another one, s."""
        one = self.decays[i]
        until = (one.end if end is None else end) - one.start
        return self.problem.phases(self.point, i, until)

    def sticks_from(self, i: int, end: float | None = None) -> float:
        """Return the time, s after its start, from which on the mass of decay i sticks; infinite where it moves up to
        the end of the decay, or to another one, s."""
        try:
            last = self.phases(i, end)[-1]
        except ValueError:  # the contact rattles on
            return math.inf
        return float(last[PHASE_T]) if last[PHASE_S] == 0.0 else math.inf

    def at_rest(self, i: int, end: float | None = None) -> float:
        """Return the time, s, one cycle after the mass of decay i came to rest; infinite where it moves to the end."""
        one = self.decays[i]
        return one.start + self.sticks_from(i, end) + _AFTER_REST * one.period

    def residuals(self, *, of_samples: bool = False) -> list[tuple[int, Signal, Array]]:
        """Return the number of the decay, channel and residual of each channel of each decay.

        of_samples : whether that of the samples as they are, also where the fit is one in the band of the mode.
        """
        residual = self.residual
        if of_samples and self.problem.band is not None:
            residual = replace(self.problem, band=None).columns(self.point)[:, -1]
        channels = [(i, signal) for i, one in enumerate(self.decays) for signal in one.signals]
        ends = np.cumsum([signal.t.size for _, signal in channels])
        return [(*channels[j], r) for j, r in enumerate(np.split(residual, ends[:-1]))]

    @cached_property
    def chance(self) -> float:
        """Probability that white noise leaves a residual as similar to a motion, in averages over parts of a cycle,
        down to two samples, or in lines; 1 for a fit in the band of the mode, which does not describe what lies
        outside."""
        if self.problem.band is not None:
            return 1.0
        channels = self.residuals()
        cycles = (self.decays[i].period / signal.dt for i, signal, _ in channels)
        widths = [max(2, round(cycle / _BINS_OF_A_CYCLE)) for cycle in cycles]
        parts = [residual for *_, residual in channels]
        slow = chance_of_averages(parts, widths, int(self.parameters.free.sum()))
        return min(1.0, 2.0 * min(slow, chance_of_lines(parts)))

    @property
    def adequate(self) -> bool:
        """Whether the residual is white, so that the records may be those of such an oscillator."""
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

    def with_noise(signal: Signal) -> Signal:
        square, n = sums[signal.offset]
        # each channel has its share of the freedom
        sigma = math.sqrt(square / (n * fit.freedom / problem.samples))
        return replace(signal, noise=max(sigma, least_noise(signal.values)))

    decays = [replace(one, signals=tuple(map(with_noise, one.signals))) for one in fit.decays]
    problem = replace(problem, decays=tuple(decays))
    starts = (fit.parameters.at(one.point) for one in (fit, *fit.minima))
    ends = filter(None, map(problem.climb, starts))
    best, *others = sorted(ends, key=lambda one: one.chi_square) or [fit]
    return replace(best, minima=tuple(others))


def contact_chord(rho: float, k: float) -> float:
    """Return the step in ρ over which its derivative is taken; 0 where that is the derivative itself.

    Close to a rigid contact the motion depends on K_z^{−1} = ρ², and a chord replaces the slope, which vanishes.
    """
    chord = _CHORD / math.sqrt(k)
    return chord if rho < 0.3 * chord else 0.0
