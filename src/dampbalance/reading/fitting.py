"""The search for the oscillator of largest likelihood, by climbs from several starts."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..law.law import Law
from ..law.steady import Response
from ..law.terms import FRICTION, parted
from ..motion.jit import interpreted
from ..motion.orbit import NoSteadyOrbit, Orbit
from .climb import MOST, Evaluation, climb
from .lines import Lines, Shares, starts
from .waveforms import MOST_RADIANS, Unknowns, WaveformFit, equivalent_coefficient

_STARTS = (4, 12)  # of the candidates, the closest first, and of those of more masses
_SOFTENING = (1e-2, 1e-3, 0.0)  # parts of the amplitudes added to their errors: a smooth way down
_HOPELESS = 4.0  # χ² per datum, softened
_EFFORT = 600.0  # evaluations after which no other start is tried: to end where the records are takes about 40
# Of K_z/k: the contact that stands for a rigid one. It sticks for 10⁻⁵ rad of the cycle or so, by which friction comes
# late: to tell that from nothing takes noise below 10⁻⁶ of the motion.
_STIFFEST = 1e10
_FEWER = 12  # evaluations at each softening, to see whether a climb comes near the records
_SAME = 1e-3  # relative: two ends whose χ² differ by less are taken for one
_REFINED = 3  # of the climbs that ended far from the records, those whose ends are nearest to them
_TO_THE_END = 300  # for the nearest of all, so that its place hangs on no other start
_REACH = math.log(5.0)  # of ln K_z to either side, where others are tried
_MOST_STEPS = 64
_SCANS = 3  # along K_z, each from the best end of the one before
_DEAR = 200.0  # turns of the fastest motion, which cost as much as the rest of an evaluation
_MOST_TURNS = 2e4  # of an orbit whose derivatives are computed: 0.1 s
_MOST_PHASES = 64  # of half a cycle: to follow a contact that rattles on takes long


def fit_oscillator(
    lines: Sequence[Lines], k: float, law: Law | None = None, *, thorough: bool = True
) -> WaveformFit | None:
    """The oscillator of largest likelihood; None where no oscillator that slips responds like the records.

    lines : of n ≥ 1 records.   k : stiffness, N/m.   law : whose coefficients are fitted; default, F_k and c.
    thorough : whether more and more starts are tried until one leads to an oscillator that the records may be of, or so
    many evaluations were made that there hardly is one. Of those that end far from the records the three nearest are
    refined, for which of them is the best shows only then. The ringing of the stuck mass makes χ² oscillate along K_z:
    from the best, K_z is varied in steps that miss no minimum, again and again as long as that leads to a better one,
    which climbs on to its optimum.
    """
    unknowns = Unknowns(law or Law(), tuple(lines), k)
    shares = _shares_of(unknowns)
    wide = (True,) if thorough and not unknowns.law.nonlinear else ()  # else each climb takes long
    points = (
        unknowns.start(candidate, shares.friction)
        for search in (False, *wide)
        for candidate in starts(lines, k, shares, wide=search)[: _STARTS[search]]
    )
    ends = _ends(unknowns, points, MOST)
    if ends and not ends[0].adequate:
        different = [b for a, b in pairwise(ends) if b.chi_square > a.chi_square * (1.0 + _SAME)]
        refined = [
            _climbed(unknowns, end.point, softenings=_SOFTENING[1:])
            for end in (ends[0], *different)[:_REFINED]
        ]
        ends += filter(None, refined)
        for _ in wide * _SCANS:
            so_far = min(ends, key=lambda end: end.chi_square)
            others = _ends(unknowns, _other_stiffnesses(so_far), _FEWER)
            ends += others
            if not others or others[0].chi_square > so_far.chi_square * (1.0 - _SAME):
                break
    best = min(ends, key=lambda end: end.chi_square, default=None)
    if best is not None and not (best.adequate and best.converged):
        last = _climbed(unknowns, best.point, softenings=(0.0,), last=_TO_THE_END)
        ends += filter(None, [last])
    return _nearest(ends)


def climb_on(fit: WaveformFit, lines: Sequence[Lines]) -> WaveformFit | None:
    """The fit to other harmonics of the same records, from there on; what was given keeps its value."""
    given = {name for name in ("m", "delay") if not fit.error(name)}
    reached = _climbed(replace(fit.unknowns, lines=tuple(lines)), fit.point, given, (0.0,))
    return reached and replace(reached, evaluations=fit.evaluations + reached.evaluations)


def fit_quickly(
    lines: Sequence[Lines], k: float, law: Law, near: Sequence[WaveformFit]
) -> WaveformFit | None:
    """Like `fit_oscillator`, but from two candidates of `lines.starts` and from fits with other laws only; not refined
    where it ends far from the records. Use it to compare many laws."""
    unknowns = Unknowns(law, tuple(lines), k)
    shares = _shares_of(unknowns)
    candidates = starts(lines, k, shares)
    known = [*candidates[:1], *(_as_candidate(fit) for fit in near), *candidates[1:2]]
    points = (unknowns.start(candidate, shares.friction) for candidate in known)
    return _nearest(_ends(unknowns, points, _FEWER))


def _ends(unknowns: Unknowns, points: Iterable[Array], most: int) -> list[WaveformFit]:
    """The fits that climbs from these points end in, up to one that is adequate, that with the smallest χ² first.

    most : evaluations at each softening.
    """
    ends: list[WaveformFit] = []
    left = np.array([_EFFORT])
    with interpreted(False) if unknowns.law.nonlinear else nullcontext():
        for point in points:
            reached = _climbed(unknowns, point, hopeless=_HOPELESS, most=most, left=left)
            if reached is not None:
                ends.append(reached)
            if left[0] <= 0.0 or (ends and ends[-1].adequate):
                break
    return sorted(ends, key=lambda end: end.chi_square)


def _other_stiffnesses(end: WaveformFit) -> Iterator[Array]:
    """Points beside the end of a climb, with K_z from a fifth to five times as large, the nearest first.

    A contact that sticks for N swings rings in step with the records at every K_z that changes N by one,
    Δ ln K_z = 2/N: four steps lead from one of them to the next.
    """
    swings = max(_swings(response.orbit) for response in end.responses)
    step = max(0.5 / max(swings, 1.0), 2.0 * _REACH / _MOST_STEPS)
    for i in range(1, 1 + int(_REACH / step)):
        for side in (1.0, -1.0):
            point = end.point.copy()
            point[end.names.index("rho")] *= math.exp(0.5 * side * i * step)
            yield point


def _nearest(ends: Sequence[WaveformFit]) -> WaveformFit | None:
    """The fit with the smallest χ², with the evaluations of all."""
    best = min(ends, key=lambda end: end.chi_square, default=None)
    return best and replace(best, evaluations=sum(end.evaluations for end in ends))


def _as_candidate(fit: WaveformFit) -> Array:
    """(F_k, c, K_z, m) of an oscillator that loses about as much."""
    damping = math.fsum(
        fit.value(key) / equivalent_coefficient(symbol, fit.lines[0], fit.k)
        for key in fit.law.keys
        if (symbol := parted(key)[0]) != FRICTION
    )
    rho = max(fit.rho, (_STIFFEST * fit.k) ** -0.5)
    return np.array([fit.F_k, damping, rho**-2, fit.m])


def _shares_of(unknowns: Unknowns) -> Shares:
    """Shares of F_k and c in each record: the friction of its group over the mean of all groups, if all work went into
    friction; the work of the terms that are not given, over the median of the records."""
    law, lines = unknowns.law, unknowns.lines
    labels = law.groups.get(FRICTION, ("",) * len(lines))
    alone = np.array([max(-one.Y * one.x[0].imag / abs(one.x[0]), 1e-9 * one.Y) for one in lines])
    means = {label: alone[[other == label for other in labels]].mean() for label in labels}
    force = np.array([means[label] for label in labels])
    free = [s for s in law.terms[1:] if s not in law.given]
    equivalents = np.array([unknowns.equivalents(symbol) for symbol in free])
    damping = np.ones(len(lines))
    if free:
        damping = np.mean(np.median(equivalents, axis=1, keepdims=True) / equivalents, axis=0)
    return Shares(force / np.mean(list(means.values())), damping)


def with_delay(fit: WaveformFit) -> WaveformFit | None:
    """The fit with the delay between base and response left free, from there on."""
    given = set() if fit.error("m") else {"m"}
    return _climbed(fit.unknowns, fit.point, given, (0.0,))


def with_mass(fit: WaveformFit, m: float) -> WaveformFit | None:
    """The fit with the mass given, kg, from there on; None where nothing slips with that mass."""
    start = fit.point.copy()
    start[fit.unknowns.names.index("m")] = m
    reached = _climbed(fit.unknowns, start, {"m", "delay"})
    return reached and replace(reached, evaluations=fit.evaluations + reached.evaluations)


def _climbed(
    unknowns: Unknowns,
    start: Array,
    given: Collection[str] = ("delay",),
    softenings: Sequence[float] = _SOFTENING,
    hopeless: float = math.inf,
    most: int = MOST,
    last: int = MOST,
    left: Array | None = None,
) -> WaveformFit | None:
    """The fit that a climb from there ends in; Y and ψ start as they were read.

    given : names of common unknowns that keep their values, in addition to those of the law.
    hopeless : χ² per datum from which on it is not refined.
    most : evaluations at each softening.   last : evaluations without any.
    left : as for `HarmonicResiduals`; default, as many as it may make at most.
    """
    names, law, lines = unknowns.names, unknowns.law, unknowns.lines
    point = start.copy()
    point[len(names) :] = np.ravel([(one.Y, 0.0) for one in lines])
    rigid = 1.0 / math.sqrt(_STIFFEST * unknowns.k)
    lower, scale = unknowns.lower(point, rigid), unknowns.scale(point)
    fixed = {*given, *law.given}
    free = np.array([i for i in range(point.size) if not fixed & set(names[i : i + 1])])
    sizes = [2 + 2 * one.n.size for one in lines]
    here: Evaluation | None = None
    evaluations, promise = 0, math.inf
    if left is None:
        left = np.array([float(most * (len(softenings) - 1) + last)])
    for softening in softenings:
        softened = HarmonicResiduals(unknowns, softening, left)
        limit = most if softening else last
        reached = climb(softened.evaluate, point, free, lower, scale, most=limit)
        if reached is None:
            break
        here, residuals, point = reached.evaluation, softened, reached.point
        evaluations, promise = evaluations + reached.iterations, reached.promise
        if 2.0 * here.value > hopeless * sum(sizes):
            break
    # the errors as they are, and derivatives that hold to 1e-6
    if here is not None and (residuals.softening or law.nonlinear):
        here = replace(residuals, softening=0.0, left=_unlimited(), quickly=False).evaluate(point)
    if here is None:
        return None
    solution = np.linalg.pinv(here.jacobian[:, free])
    size = point.size
    covariance, response = np.zeros((size, size)), np.zeros((size, here.residual.size))
    covariance[np.ix_(free, free)] = solution @ solution.T
    response[free] = solution
    ends = np.cumsum(sizes).tolist()
    return WaveformFit(
        k=unknowns.k,
        point=point,
        covariance=covariance,
        residual=here.residual,
        rigid=bool(point[names.index("rho")] <= rigid),
        unknowns=unknowns,
        response=response,
        places=tuple(slice(end - n, end) for end, n in zip(ends, sizes, strict=True)),
        freedom=here.residual.size - free.size,
        promise=promise,
        undamped=tuple(key for key in law.unknowns if point[names.index(key)] <= 0.0),
        evaluations=evaluations,
    )


def _unlimited() -> Array:
    return np.array([math.inf])


def _swings(orbit: Orbit) -> float:
    """How often the mass swings on contact and spring in half a cycle, while it sticks."""
    rows, stuck = orbit.phases.tolist(), 0.0
    for i, (t, s, *_) in enumerate(rows):
        if s == 0.0:
            stuck += (rows[i + 1][0] if i + 1 < len(rows) else 0.5 * orbit.motion.period) - t
    osc = orbit.oscillator
    return stuck * math.sqrt((osc.k + osc.K_z) / osc.m) / (2.0 * math.pi)


def _turns(orbit: Orbit) -> float:
    """How many turns of its fastest motion half a cycle takes to follow: swings in stick, or the decay of a velocity by
    e^{2π} where a light mass creeps in a strong damper."""
    osc = orbit.oscillator
    return max(_swings(orbit), 0.5 * orbit.motion.period * osc.c / osc.m / (2.0 * math.pi))


@dataclass(frozen=True, eq=False)
class HarmonicResiduals:
    """Residuals (model − data)/σ of the harmonics of all records as functions of the unknowns.

    softening : part of the amplitudes added to the errors.
    left : evaluations that may still be made, (1,), changed by each: a light mass that swings on while it sticks takes
    as long as many others, and ends the climb early.
    near : the last motion of each record, from which the next starts.
    quickly : as for `Unknowns.harmonics`.
    """

    unknowns: Unknowns
    softening: float
    left: Array = field(default_factory=_unlimited)
    near: dict[int, Response] = field(default_factory=dict)
    quickly: bool = True

    def evaluate(self, point: Array) -> Evaluation | None:
        """Residuals and derivatives; None where nothing slips, there is no orbit, the contact rattles, or no evaluation
        is left."""
        if self.left[0] <= 0.0:
            return None
        unknowns = self.unknowns
        delay = unknowns.names.index("delay")
        residuals, slopes, slips = [], [], False
        for i, one in enumerate(unknowns.lines):
            try:
                response = unknowns.response(point, i, self.near.get(i))
            except NoSteadyOrbit:  # perhaps after a long search
                self.left[0] -= MOST_RADIANS / (2.0 * math.pi * _DEAR) / len(unknowns.lines)
                return None
            except ValueError:
                return None
            try:
                turns = _turns(response.orbit)
                if len(response.orbit.phases) > _MOST_PHASES or turns > _MOST_TURNS:
                    return None
                self.left[0] -= (1.0 + turns / _DEAR) / len(unknowns.lines)
                self.near[i] = replace(response, matrix=None)
                x, by = unknowns.harmonics(point, i, response, one.n.size, quickly=self.quickly)
            except (NoSteadyOrbit, ValueError):
                return None
            slips |= response.slips
            at = unknowns.at[i]
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
        return Evaluation(np.concatenate(residuals), np.vstack(slopes))
