"""One oscillator for all records: the exact steady waveforms that fit their harmonics best.

The waveform of a record is the steady response of the oscillator (m, k, K_z, F_k) with a damping law, F_k and c unless
told otherwise, under y = Y cos ωt. The stiffness k is given; the coefficients of the law, ρ = K_z^{−1/2} and, unless
it is given, the mass m are common to all records, Y and the phase ψ of the base are each record's own. Where the noise
is white, harmonics taken by least squares over whole cycles hold all that a record tells of a steady motion, so that

    χ² = Σ |x_n(model) e^{inψ} − x_n|²/σ_n² + (Y(model) − Y)²/σ_Y² + (Yψ)²/σ_Y²

is that of the fit to all samples, whatever drives, whatever answers and however long the record is. Its minimum is the
estimate of largest likelihood; χ² itself says whether the records are those of such an oscillator. Any regime has its
exact waveform: one slip onset per half cycle, several, none. In ρ the rigid contact, ρ = 0, is a regular point.

The harmonics tell the phase of the base, too: a time by which the response lags the base in the record (a skew between
two channels) turns harmonic n by n times its angle, and can be left free.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Complexes, Integers, Mask
from ..law.law import Law
from ..law.steady import Response
from ..law.terms import FRICTION, parted
from ..motion.jit import interpreted
from ..motion.orbit import NoSteadyOrbit
from ..solver import NORMAL_95
from .climb import Climb, Evaluation, NoConvergence, NoStart, climb
from .lines import Lines, improbable, starts
from .unknowns import Unknowns, worth

_HARMONICS = 128  # odd ones of the waveform: beyond them lies less than 1e-6 of its velocity
_STARTS = (4, 12)  # of the candidates, the closest first, and of those of more masses
_SOFTENING = (1e-2, 1e-3, 0.0)  # parts of the amplitudes added to their errors: a smooth way down
_GAIN = 5e-8  # of half of χ², where the climb ends
_STIFFEST = 1e12  # of K_z/k: the contact that stands for a rigid one
_MOST = 30  # evaluations at each softening: a climb to where the records are takes about ten
_MOST_PHASES = 64  # of half a cycle: to follow a contact that rattles on takes long


@dataclass(frozen=True, eq=False)
class Fit:
    """The oscillator whose waveforms fit the harmonics of n records best.

    lines : of the records.   unknowns : names and places of its p unknowns.   point : their values, SI, (p,).
    covariance : of the point, (p, p); zero where an unknown was given.
    response : of the point to the data in units of their errors, (p, data): dp = response · d(data)/σ; the data of a
    record are |Y|, its phase, Re x_n, Im x_n.   places : where the data of each record are.
    residual : (model − data)/σ, (data,).   chi_square : its square.   freedom : its degrees of freedom.
    rigid : whether ρ is at zero.   undamped : keys of the coefficients that are at zero.
    """

    lines: tuple[Lines, ...]
    unknowns: Unknowns
    point: Array
    covariance: Array
    response: Array
    places: tuple[slice, ...]
    residual: Array
    chi_square: float
    freedom: int
    rigid: bool
    undamped: tuple[str, ...]

    @property
    def law(self) -> Law:
        """Whose coefficients were fitted."""
        return self.unknowns.law

    @property
    def k(self) -> float:
        """Stiffness, N/m."""
        return self.unknowns.k

    def value(self, name: str) -> float:
        """A common unknown, in its unit: a coefficient by its key, rho, m or delay."""
        return float(self.point[self.unknowns.names.index(name)])

    @property
    def F_k(self) -> float:
        """Friction force, N; the mean over the groups where it has some."""
        return float(self.unknowns.friction(self.point))

    @property
    def c(self) -> float:
        """Viscous damping, N s/m; 0 where the law has none."""
        return self.value("c") if "c" in self.unknowns.names else 0.0

    @property
    def rho(self) -> float:
        """K_z^{−1/2}, (m/N)^{1/2}; 0 for a rigid contact."""
        return 0.0 if self.rigid else self.value("rho")

    @property
    def K_z(self) -> float:
        """Contact stiffness, N/m; infinite for a rigid contact."""
        return math.inf if self.rigid else self.rho**-2

    @property
    def m(self) -> float:
        """Mass, kg."""
        return self.value("m")

    @property
    def delay(self) -> float:
        """Time by which the response lags the base in the records beside what the motion makes it, s."""
        return self.value("delay")

    def error(self, name: str) -> float:
        """Standard error of a common unknown, in its unit; 0 where it was given."""
        at = self.unknowns.names.index(name)
        return math.sqrt(self.covariance[at, at])

    @property
    def K_z_error(self) -> float:
        """Standard error of K_z, N/m; infinite where the contact is rigid."""
        return math.inf if self.rigid else 2.0 * self.K_z**1.5 * self.error("rho")

    @property
    def K_z_interval(self) -> tuple[float, float]:
        """95 % interval of K_z, N/m, from ρ ± 1.96 standard errors; unbounded above where ρ = 0 is within."""
        spread = NORMAL_95 * self.error("rho")
        low, high = self.rho - spread, self.rho + spread
        return high**-2, (low**-2 if low > 0.0 else math.inf)

    @property
    def natural_frequency_hz(self) -> float:
        """√(k/m)/2π, Hz: of the oscillator while its contact slips."""
        return math.sqrt(self.k / self.m) / (2.0 * math.pi)

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom."""
        return self.chi_square / max(1, self.freedom)

    @property
    def adequate(self) -> bool:
        """Whether the records may be those of such an oscillator, as far as their noise tells."""
        return not improbable(self.chi_square, self.freedom, self.lines)

    @property
    def misfits(self) -> Array:
        """χ² of each record per datum, (n,)."""
        return np.array([np.mean(self.residual[place] ** 2) for place in self.places])

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        responses: list[Response] = []
        for i, one in enumerate(self.lines):
            responses.append(self.unknowns.response(self.point, i, one.omega))
        return tuple(responses)

    @property
    def slips(self) -> Mask:
        """Which records slip."""
        return np.array([response.slips for response in self.responses])

    @cached_property
    def waveforms(self) -> tuple[Waveform, ...]:
        """What is read off the motion of each record."""
        return tuple(_waveform(self, i) for i in range(len(self.lines)))


@dataclass(frozen=True, eq=False)
class Waveform:
    """What features take from the motion of one record, with derivatives by the unknowns of the fit.

    fit : that it belongs to.   index : of the record.   response : its motion.
    onset : (V_s, t_s, λ), SI, λ = 4X − a the travel that sticking takes from 4X: 2L for one slip onset per half cycle.
    onset_slope : (3, p).   tail : harmonics x_n, n = 1, 3, 5 …, phases counted from the peak of y, m; tail_slope :
    their derivatives, (harmonics, p).
    """

    fit: Fit
    index: int
    response: Response
    onset: Array
    onset_slope: Array
    tail: Complexes
    tail_slope: Complexes

    @property
    def F_k(self) -> float:
        """Friction force of the record, N."""
        return float(self.fit.point[self.fit.unknowns.at(self.index)[FRICTION]])

    @property
    def length(self) -> float:
        """L = 2F_k/K_z, m, freed of its bias of second order."""
        return 2.0 * self.F_k * (self.fit.rho**2 - self.fit.error("rho") ** 2)

    @property
    def length_error(self) -> float:
        """Standard error of L, m."""
        slope = self.length_slope
        return math.sqrt(float(slope @ self.fit.covariance @ slope))

    @property
    def length_slope(self) -> Array:
        """Derivatives of L by the unknowns, (p,)."""
        slope, at = np.zeros(self.fit.point.size), self.fit.unknowns.at(self.index)
        slope[at[FRICTION]] = 2.0 * self.fit.rho**2
        slope[at["rho"]] = 4.0 * self.F_k * self.fit.rho
        return slope

    @property
    def length_bound(self) -> float:
        """L is below it with 97.5 % confidence, m."""
        return 2.0 * self.F_k * (self.fit.rho + NORMAL_95 * self.fit.error("rho")) ** 2


def fit_oscillator(
    lines: Sequence[Lines],
    k: float,
    law: Law | None = None,
    *,
    near: Fit | None = None,
    thorough: bool = True,
) -> Fit | None:
    """The oscillator of largest likelihood; None where no oscillator that slips responds like the records.

    lines : of n ≥ 1 records.   k : stiffness, N/m.   law : whose coefficients are fitted; default, F_k and c.
    near : a fit with another law, to start from.   thorough : whether more and more starts are tried until one leads
    to an oscillator that the records may be of.
    """
    unknowns = Unknowns(law or Law(), len(lines), k)
    if near is None and unknowns.law.nonlinear:  # the way there is shorter with exact orbits alone
        near = fit_oscillator(lines, k, Law(groups=_of_friction(unknowns.law)), thorough=thorough)
    relative = _relative_friction(lines, unknowns.law)
    best: Fit | None = None
    with interpreted(False) if unknowns.law.nonlinear else nullcontext():
        for start in _starting_points(lines, unknowns, relative, near, thorough):
            reached = _climbed(lines, unknowns, start, {"delay"}, _SOFTENING)
            if reached is not None and (best is None or reached.chi_square < best.chi_square):
                best = reached
                if best.adequate:
                    return best
    return best


def _of_friction(law: Law) -> dict[str, tuple[str, ...]]:
    return {FRICTION: law.groups[FRICTION]} if FRICTION in law.groups else {}


def _starting_points(
    lines: Sequence[Lines], unknowns: Unknowns, relative: Array, near: Fit | None, thorough: bool
) -> Iterator[Array]:
    """Points from which to climb, one after the other."""
    if near is not None:
        damping = sum(
            near.value(key) / worth(parted(key)[0], one, near.k)
            for key in near.law.keys
            for one in lines[:1]
            if parted(key)[0] != FRICTION
        )
        rho = max(near.rho, _STIFFEST**-0.5 * near.k**-0.5)
        candidate = np.array([near.F_k, damping, rho**-2, near.m])
        yield unknowns.start(lines, candidate, relative)
        if not thorough:
            return
    for wide in (False, True)[: 1 + thorough]:
        if wide and unknowns.law.nonlinear:
            return  # each climb takes seconds
        for candidate in starts(lines, unknowns.k, relative, wide=wide)[: _STARTS[wide]]:
            yield unknowns.start(lines, candidate, relative)


def _relative_friction(lines: Sequence[Lines], law: Law) -> Array:
    """Friction of the group of each record over the mean of all, were all work taken by friction, (n,)."""
    labels = law.groups.get(FRICTION)
    if labels is None:
        return np.ones(len(lines))
    alone = np.array([max(-one.Y * one.x[0].imag / abs(one.x[0]), 1e-9 * one.Y) for one in lines])
    means = {label: alone[[other == label for other in labels]].mean() for label in labels}
    force = np.array([means[label] for label in labels])
    relative: Array = force / np.mean(list(means.values()))
    return relative


def with_delay(fit: Fit) -> Fit | None:
    """The fit with the delay between base and response left free, from there on."""
    given = set() if fit.error("m") else {"m"}
    return _climbed(fit.lines, fit.unknowns, fit.point, given, (0.0,))


def with_mass(fit: Fit, m: float) -> Fit | None:
    """The fit with the mass given, kg, from there on; None where nothing slips with that mass."""
    start = fit.point.copy()
    start[fit.unknowns.names.index("m")] = m
    return _climbed(fit.lines, fit.unknowns, start, {"m", "delay"}, _SOFTENING)


def _climbed(
    lines: Sequence[Lines],
    unknowns: Unknowns,
    start: Array,
    given: set[str],
    softenings: Sequence[float],
) -> Fit | None:
    """The fit that a climb from there ends in; Y and ψ start as they were read."""
    names, law = unknowns.names, unknowns.law
    point = start.copy()
    point[len(names) :] = np.ravel([(one.Y, 0.0) for one in lines])
    rigid = 1.0 / math.sqrt(_STIFFEST * unknowns.k)
    lower, scale = unknowns.lower(point, lines, rigid), unknowns.scale(point, lines)
    fixed = given | set(law.given)
    free = np.array([i for i in range(point.size) if not fixed & set(names[i : i + 1])])
    climbed: Climb[Evaluation] | None = None
    for softening in softenings:
        problem = _Problem(lines, unknowns, point, free, softening)
        try:
            climbed = climb(
                problem.evaluate, point[free], lower[free], scale[free], gain=_GAIN, most=_MOST
            )
        except NoStart:
            return None
        except NoConvergence as stuck:
            climbed = stuck.best
        point = point.copy()
        point[free] = climbed.point
    assert climbed is not None
    here = climbed.evaluation
    assert here.residual is not None
    assert here.jacobian is not None
    solution = np.linalg.pinv(here.jacobian)
    size = point.size
    covariance, response = np.zeros((size, size)), np.zeros((size, here.residual.size))
    covariance[np.ix_(free, free)] = solution @ solution.T
    response[free] = solution
    ends = np.cumsum([2 + 2 * one.n.size for one in lines])
    starts_at = [0, *ends[:-1]]
    return Fit(
        lines=tuple(lines),
        unknowns=unknowns,
        point=point,
        covariance=covariance,
        response=response,
        places=tuple(slice(int(a), int(b)) for a, b in zip(starts_at, ends, strict=True)),
        residual=here.residual,
        chi_square=2.0 * here.value,
        freedom=here.residual.size - free.size,
        rigid=bool(point[names.index("rho")] <= rigid),
        undamped=tuple(key for key in law.unknowns if point[names.index(key)] <= 0.0),
    )


@dataclass(frozen=True, eq=False)
class _Problem:
    """Residuals (model − data)/σ of all records as functions of the unknowns that are free.

    point : all unknowns.   free : which of them are.   softening : part of the amplitudes added to the errors.
    """

    lines: Sequence[Lines]
    unknowns: Unknowns
    point: Array
    free: Integers
    softening: float

    def evaluate(self, free: Array) -> Evaluation | None:
        """Half of χ² with its derivatives; None where nothing slips, there is no orbit, or the contact rattles."""
        point, unknowns = self.point.copy(), self.unknowns
        point[self.free] = free
        delay = unknowns.names.index("delay")
        residuals, slopes, slips = [], [], False
        for i, one in enumerate(self.lines):
            try:
                response = unknowns.response(point, i, one.omega)
                if len(response.orbit.phases) > _MOST_PHASES:
                    return None
                x, by = unknowns.harmonics(point, i, one, response, one.n.size)
            except (NoSteadyOrbit, ValueError):
                return None
            slips |= response.slips
            at = unknowns.at(i)
            Y, psi = point[at["Y"]], point[at["psi"]]
            error = np.hypot(one.x_error, self.softening * abs(one.x[0]))
            Y_error = math.hypot(one.Y_error, self.softening * one.Y)
            off, slope = (x - one.x) / error, by / error[:, None]
            lag = psi + one.omega * point[delay]
            of_base = np.zeros((2, point.size))
            of_base[0, at["Y"]] = 1.0 / Y_error
            of_base[1, at["psi"]], of_base[1, delay] = one.Y / Y_error, one.omega * one.Y / Y_error
            base = [(Y - one.Y) / Y_error, lag * one.Y / Y_error]
            residuals += [base, off.real, off.imag]
            slopes += [of_base, slope.real, slope.imag]
        if not slips:
            return None
        return Evaluation.of_residuals(np.concatenate(residuals), np.vstack(slopes)[:, self.free])


def _waveform(fit: Fit, i: int) -> Waveform:
    """What features take from the motion of record i."""
    one, response = fit.lines[i], fit.responses[i]
    onset, slope = fit.unknowns.onset(fit.point, i, one, response)
    tail, tail_slope = fit.unknowns.harmonics(fit.point, i, one, response, _HARMONICS)
    return Waveform(fit, i, response, onset, slope, tail, tail_slope)
