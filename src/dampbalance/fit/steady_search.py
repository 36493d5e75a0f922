"""The search for the oscillator of largest likelihood in steady records, by climbs from several starts."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..law.law import Law
from ..law.terms import FRICTION
from ..signals.lines import Lines
from .climb import MOST_EVALUATIONS
from .minimise import WAY, climb_on, minimise
from .starts import Shares, starts
from .waveforms import STIFFEST, HarmonicProblem, WaveformFit, equivalent_coefficient

_STARTS = (4, 12)  # of the candidates, the closest first, and of those of more masses
_SOFTENING = (1e-2, 1e-3, 0.0)  # parts of the amplitudes added to their errors: a smooth way down
_HOPELESS = 4.0  # χ² per datum, softened
_EFFORT = 600.0  # evaluations after which no other start is tried: to end where the records are takes about 40
_FEWER = 12  # evaluations at each softening under a law that is compared with others
_SAME = 1e-3  # relative: two ends whose χ² differ by less are taken for one
_REFINED = 3  # of the climbs that ended far from the records, those whose ends are nearest to them
_TO_THE_END = 300  # for the nearest of all, so that its place hangs on no other start
_RINGING_SWINGS = 1.0  # swings in a stick, from which on a fit that holds is not the only one
# What a minimum must be lower by, in χ² and as a part of it, for a scan from there.
_LOWER, _NEARER = 0.05, 0.02


def fit_records(
    lines: Sequence[Lines],
    k: float,
    law: Law | None = None,
    *,
    thorough: bool = True,
    near: WaveformFit | None = None,
) -> WaveformFit | None:
    """Return the oscillator of largest likelihood; None where no oscillator that slips responds like the records.

    lines : of n ≥ 1 records.   k : stiffness, N/m.   law : whose coefficients are fitted; default, F_k and c.
    thorough : whether more and more starts are tried until one leads to an oscillator that the records may be of, or so
    many evaluations were made that there hardly is one. Of those that end far from the records the three nearest are
    refined, for which of them is the best shows only then. The ringing of the stuck mass makes χ² oscillate along K_z:
    the best is searched for among all K_z (`of_all_stiffnesses`), and climbs on to its optimum.
    near : what a search that is not thorough ended with: its starts are not tried again.
    """
    problem = HarmonicProblem(law or Law(), tuple(lines), k)
    shares = _shares_of(problem)
    wide = (True,) if thorough and not problem.law.nonlinear else ()  # else each climb takes long
    points = (
        problem.start(candidate, shares.friction)
        for search in (*(False,) * (near is None), *wide)
        for candidate in starts(lines, k, shares, wide=search)[: _STARTS[search]]
    )
    ends = _ends(problem, points, MOST_EVALUATIONS)
    if near is not None:
        ends = sorted([*ends, near], key=lambda end: end.chi_square)
    if ends and not ends[0].adequate:
        different = [b for a, b in pairwise(ends) if b.chi_square > a.chi_square * (1.0 + _SAME)]
        refined = [
            _climbed(problem, end.point, softenings=_SOFTENING[1:])
            for end in (ends[0], *different)[:_REFINED]
        ]
        ends += filter(None, refined)
    best = _best(ends)
    if best is None:
        return None
    if wide:
        best = of_all_stiffnesses(best)
    if thorough and not (best.adequate and best.converged):
        last = _climbed(problem, best.point, softenings=(0.0,), last=_TO_THE_END)
        best = _best([best, *filter(None, [last])])
    return best


def of_all_stiffnesses(fit: WaveformFit) -> WaveformFit:
    """Return the best fit that is found along K_z, from a fifth to five times that of a fit, in steps that miss no
    minimum, and from one that is nearer to the records again; the fit itself where none is better, or the mass hardly
    swings while it sticks."""
    budget, evaluations = np.array([_EFFORT]), fit.evaluations
    problem, chi_square = replace(fit.problem, budget=budget, near={}), math.inf
    while fit.chi_square < (1.0 - _NEARER) * chi_square - _LOWER:
        if max(one.swings for one in fit.responses) < _RINGING_SWINGS and fit.adequate:
            break
        chi_square = fit.chi_square
        others = filter(None, minimise(problem, [fit.point]))
        fit = min([fit, *others], key=lambda one: one.chi_square)
    return replace(fit, evaluations=evaluations + round(_EFFORT - float(budget[0])))


def fit_quickly(problem: HarmonicProblem, near: WaveformFit | None) -> WaveformFit | None:
    """Return the fit of a law, to compare many: from the optimum of one that it contains, where that is adequate; else
    from the closest candidate of `starts`, and from the other fit again where that is closer to the records. It is not
    refined where it ends far from them.

    near : the fit with the other law, if there is one.
    """
    if near is not None and near.adequate and near.law.given == problem.law.given:
        common = [near.value(s) if s in near.names else 0.0 for s in problem.names]
        point = np.array([*common, *near.point[len(near.names) :]])
        return fit_from(replace(near.problem, law=problem.law), point)
    shares, lines = _shares_of(problem), problem.lines
    candidates = [*starts(lines, problem.k, shares)[:1], *([_as_candidate(near)] if near else [])]
    points = (problem.start(candidate, shares.friction) for candidate in candidates)
    return _best(_ends(problem, points, _FEWER, near.chi_square if near else math.inf))


def _ends(
    problem: HarmonicProblem, points: Iterable[Array], most: int, enough: float = 0.0
) -> list[WaveformFit]:
    """Return the fits that climbs from these points end in, up to one that is adequate, that with the smallest χ²
    first.

    most : evaluations at each softening.   enough : χ² below which no other start is tried.
    """
    ends: list[WaveformFit] = []
    budget = np.array([_EFFORT])
    for point in points:
        reached = _climbed(problem, point, hopeless=_HOPELESS, most=most, budget=budget)
        if reached is not None:
            ends.append(reached)
        if budget[0] <= 0.0 or (ends and (ends[-1].adequate or ends[-1].chi_square < enough)):
            break
    return sorted(ends, key=lambda end: end.chi_square)


def _best(ends: Sequence[WaveformFit]) -> WaveformFit | None:
    """Return the fit with the smallest χ², with the evaluations of all."""
    best = min(ends, key=lambda end: end.chi_square, default=None)
    return best and replace(best, evaluations=sum(end.evaluations for end in ends))


def _as_candidate(fit: WaveformFit) -> Array:
    """Return (F_k, c, K_z, m) of an oscillator that loses about as much."""
    damping = math.fsum(
        fit.value(key) / equivalent_coefficient(key, fit.lines[0], fit.k)
        for key in fit.law.keys
        if key.symbol != FRICTION
    )
    rho = max(fit.rho, (STIFFEST * fit.k) ** -0.5)
    return np.array([fit.F_k, damping, rho**-2, fit.m])


def _shares_of(problem: HarmonicProblem) -> Shares:
    """Return shares of F_k and c in each record: the friction of its group over the mean of all groups, if all work
    went into friction; the work of the terms that are not given, over the median of the records."""
    law, lines = problem.law, problem.lines
    labels = law.groups.get(FRICTION, ("",) * len(lines))
    alone = np.array([max(-one.Y * one.x[0].imag / abs(one.x[0]), 1e-9 * one.Y) for one in lines])
    means = {label: alone[[other == label for other in labels]].mean() for label in labels}
    force = np.array([means[label] for label in labels])
    free = [s for s in law.terms[1:] if s not in law.given]
    equivalents = np.array([problem.equivalents(symbol) for symbol in free])
    damping = np.ones(len(lines))
    if free:
        damping = np.mean(np.median(equivalents, axis=1, keepdims=True) / equivalents, axis=0)
    return Shares(force / np.mean(list(means.values())), damping)


def refit(
    fit: WaveformFit, free: Collection[str] = (), given: Mapping[str, float] | None = None
) -> WaveformFit | None:
    """Return the fit that a climb from a fit leads to with nuisances left free, or with unknowns given; None where it
    has no motion, or nothing slips.

    Use it to ask what a departure would explain: `fit.chi_square` falls by its share of χ², `value(name)` and
    `error(name)` are its size, and F_k, c and K_z those without it. What was fitted or given before stays so.

    free : names of `nuisances`, or rho and m.   given : values of common unknowns to keep from now on, by name.
    """
    given, start = given or {}, fit.point.copy()
    for name, value in given.items():
        start[fit.names.index(name)] = value
    freed = tuple(name for name in (*fit.problem.freed, *free) if name not in given)
    # what is moved away from its optimum starts on a smooth way down
    softenings = _SOFTENING if given else (0.0,)
    reached = _climbed(replace(fit.problem, freed=freed), start, softenings)
    return reached and replace(reached, evaluations=fit.evaluations + reached.evaluations)


def fit_from(problem: HarmonicProblem, start: Array) -> WaveformFit | None:
    """Return the fit that a climb from a point ends in; None where it has no motion, or nothing slips."""
    return _climbed(problem, start, (0.0,))


def _climbed(
    problem: HarmonicProblem,
    start: Array,
    softenings: Sequence[float] = _SOFTENING,
    hopeless: float = math.inf,
    most: int = MOST_EVALUATIONS,
    last: int = MOST_EVALUATIONS,
    budget: Array | None = None,
) -> WaveformFit | None:
    """Return the fit that a climb from there ends in.

    hopeless : χ² per datum from which on it is not refined.
    most : evaluations at each softening.   last : evaluations without any.
    budget : as for `HarmonicProblem`; default, as many as it may make at most.
    """
    end, evaluations = None, 0
    if budget is None:
        budget = np.array([float(most * (len(softenings) - 1) + last)])
    problem = replace(problem, budget=budget, near={})
    for softening in softenings:
        softened = replace(problem, softening=softening)
        enough = {"gain": WAY, "most": most} if softening else {"most": last}
        reached = climb_on(softened, end.point if end else start, **enough)
        if reached is None:
            break
        evaluations += reached.evaluations
        end = replace(reached, evaluations=evaluations)
        if end.chi_square > hopeless * problem.samples:
            break
    return None if end is None else problem.fit(end)
