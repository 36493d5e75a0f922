"""The one search: climbs from several starts, a scan along the contact stiffness, the end on all data.

A start is a point with limits and scales, `Parameters`; a problem has no state between evaluations, and provides:
`products(values, free, trail, out)` sets JᵀJ bordered by Jᵀr and χ² at a point, by the unknowns that are free, and is
false where there is no motion; `thinned()`, a cheaper copy, or itself; `softened(part)`, a copy with a part of the
amplitudes added to the errors; `scan(parameters)`, values of the parameter that is scanned; `samples`, the number of
its data; `fit(end)`, the `Fit` where a climb ended, None where there is no motion. What a climb learns on its way and
what it may cost is in its `Trail`, which belongs to the search.

χ² oscillates along ρ = K_z^{−1/2} where a stuck mass rings, as it does in the estimation of a frequency: the scan goes
through all stiffnesses from the best point either way, each a start for the next, and climbs on from each minimum.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Array
from .climb import MOST_EVALUATIONS, Climb, climb
from .errors import inverse_information
from .parameters import Parameters

KEPT = 10
"""Distinct points that a search carries along."""

WAY = 1e-2
"""Gain in −log L, at which a climb on the way ends: it is a tenth of a standard error off."""

_ON_THE_WAY = 12  # evaluations of such a climb: twice what one in a valley takes
_ABOVE = 30.0  # of χ²: a minimum so far up has a likelihood of 3e-7
_NEARLY = 1.001  # of χ²: two ends that differ by less are taken for one
_SAME = 0.5  # standard errors: two climbs that end so close ended in one minimum


class Trail:
    """The budget of a search and the motions that it can start from.

    near : the last motion of each record, by its number: where the next one starts.   left : evaluations that are left;
    a motion that takes long counts as several.   made : evaluations of all climbs.
    """

    def __init__(self, left: float = math.inf) -> None:
        self.near: dict[int, Any] = {}
        self.left = left
        self.made = 0


def climb_on(
    problem: Any, start: Parameters, trail: Trail | None = None, **options: Any
) -> Climb | None:
    """Return the end of a climb from a start on a problem; None where there is no motion.   options : of `climb`."""
    trail = trail or Trail()

    def evaluate(values: Array, out: Array) -> bool:
        return bool(problem.products(values, start.free, trail, out))

    end = climb(evaluate, start, **options)
    trail.made += 1 if end is None else end.evaluations
    return end


def distinct(ends: Iterable[Climb | None], above: float = _ABOVE) -> list[Climb]:
    """Return the lowest ends of climbs that differ, at most ten, the lowest first.

    above : of χ², beyond the lowest, from where on ends are left out.
    """
    kept: list[Climb] = []
    errors = np.ones(0)
    for end in sorted(filter(None, ends), key=lambda one: one.chi_square):
        if kept and (end.chi_square > kept[0].chi_square + above or len(kept) == KEPT):
            break
        if all((np.abs(end.point - other.point) > _SAME * errors).any() for other in kept):
            kept.append(end)
        if len(kept) == 1:
            none = np.full(end.point.size, math.inf)
            covariance = inverse_information(end.products[:-1, :-1], none)
            errors = np.sqrt(np.diag(covariance))
    return kept


def climbs(
    problem: Any, starts: Iterable[Parameters], above: float = _ABOVE, trail: Trail | None = None
) -> list[Climb]:
    """Return the distinct ends of climbs from some starts, not quite to the end."""
    ends = (climb_on(problem, start, trail, gain=WAY, most=_ON_THE_WAY) for start in starts)
    return distinct(ends, above)


def multistart(
    problem: Any,
    starts: Iterable[Parameters],
    *,
    scan: str = "",
    softening: Sequence[float] = (),
    hopeless: float = math.inf,
    refined: int = 0,
    budget: float = math.inf,
    most: int = _ON_THE_WAY,
    enough: Callable[[Climb], bool] | None = None,
) -> list[Any]:
    """Return the minima that climbs from some starts and a scan find, the lowest first; empty where there is no motion.

    Use it for the last fit of a search; the first of the list is the answer, the others are as good within 30 of χ².

    scan : parameter along which χ² has several minima, a K_z^{−1/2}; empty for none.
    softening : parts of the amplitudes added to the errors, one after the other: a smooth way down.
    hopeless : χ² per datum from which on a climb does not go on to less softening, unless none is enough and it is one
    of the nearest: which of them is the best shows only then.   refined : number of these.
    budget : evaluations after which no other start is tried.   most : evaluations of each climb on the way down.
    enough : whether an end needs no other start.
    """
    thin, trail = problem.thinned(), Trail(budget)
    ends: list[Climb] = []
    for start in starts:
        trail.near = {}
        end = _down(thin, start, softening, hopeless, most, trail)
        ends += [end] if end is not None else []
        if trail.left <= 0.0 or (end is not None and enough is not None and enough(end)):
            break
    ends.sort(key=lambda one: one.chi_square)
    if ends and refined and not (enough is not None and enough(ends[0])):
        different = [b for a, b in pairwise(ends) if b.chi_square > a.chi_square * _NEARLY]
        for one in (ends[0], *different)[:refined]:
            own = Trail(MOST_EVALUATIONS * (1.0 + len(softening[1:])))
            ends += filter(None, [_down(thin, one.parameters, softening[1:], math.inf, most, own)])
            trail.made += own.made
    found = distinct(ends)
    if found and scan and found[0].parameters[scan].free:
        points = minima_along(thin, found[0].parameters, scan, trail)
        found = distinct([*found, *climbs(thin, points, trail=trail)])
    if not found:
        return []
    near, trail.left = likely(found, problem, thin), max(trail.left, MOST_EVALUATIONS)
    if thin is not problem:
        near = climbs(problem, [one.parameters for one in near], trail=trail)
    far = math.inf if refined else hopeless * thin.samples
    full = [
        climb_on(problem, one.parameters, trail, known=one.products, most=most)
        for one in near
        for most in [MOST_EVALUATIONS if one.chi_square < far else 0]
    ]
    fits = filter(None, (problem.fit(one) for one in distinct(full)))
    return [replace(one, evaluations=trail.made) for one in fits]


def _down(
    problem: Any,
    start: Parameters,
    softening: Sequence[float],
    hopeless: float,
    most: int,
    trail: Trail,
) -> Climb | None:
    """Return where climbs from a start lead, with less and less softening; hopeless ones go no further."""
    for part in softening:
        end = climb_on(problem.softened(part), start, trail, gain=WAY, most=most)
        if end is None:
            break
        start = end.parameters
        if end.chi_square > hopeless * problem.samples:
            most = 1
            break
    return climb_on(problem, start, trail, gain=WAY, most=most)


def likely(ends: Sequence[Climb], problem: Any, thin: Any) -> list[Climb]:
    """Return the ends of climbs on a thinned problem that may be the lowest on all samples."""
    # there χ² differs by as much more as there are more of them
    share = max(1.0, problem.samples / thin.samples)
    level = min(one.chi_square for one in ends) + 2.0 + _ABOVE / share
    return [one for one in ends if one.chi_square < level]


def minima_along(
    problem: Any, start: Parameters, key: str, trail: Trail | None = None
) -> list[Parameters]:
    """Return points at the minima of χ² along a parameter, an inverse root of a stiffness, the lowest ten."""
    ends = profile(problem, start, key, problem.scan(start), trail)
    level = np.array([math.inf, *(end.chi_square for end in ends), math.inf])
    low = np.flatnonzero((level[1:-1] <= level[:-2]) & (level[1:-1] <= level[2:]))
    order = low[np.argsort(level[1 + low], kind="stable")][:KEPT]
    return [start.at(ends[i].point) for i in order]


def profile(
    problem: Any, start: Parameters, key: str, values: Array, trail: Trail | None = None, **of: Any
) -> list[Climb]:
    """Return the ends of climbs, short ones by default, with a parameter held at some values, from the best point
    either way, each the start of the next, in the order of the parameter.   of : options of `climb`."""
    of = {"gain": 0.5, "most": 3} | of
    j, held = start.places[key], start.held(key)
    values = np.sort(np.append(values, start.values[j]))
    ends: list[Climb] = []
    for some in (values[values >= start.values[j]], values[values < start.values[j]][::-1]):
        here = held
        for value in some.tolist():
            end = climb_on(problem, here.moved(**{key: value}), trail, **of)
            if end is not None:
                ends.append(end)
                here = end.parameters
    return sorted(ends, key=lambda end: float(end.point[j]))
