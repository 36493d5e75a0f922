"""The one multi-start: climbs from several starts, a scan along the contact stiffness, the end on all samples.

A problem has these: `products(point, out)` sets JᵀJ bordered by Jᵀr and χ², false where it has no motion;
`bounds(point)`, see `ClimbBounds`; `names` of the first unknowns; `is_free(name)`; `scan(point)`, values of the unknown
that is scanned; `thinned()`, a cheaper copy, or itself; `samples`; `fit(climb)`, its `Fit`.

χ² oscillates along ρ = K_z^{−1/2} where a stuck mass rings, as it does in the estimation of a frequency: the scan goes
through all stiffnesses from the best point either way, each a start for the next, and climbs on from each minimum.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ..arrays import Array
from .climb import GAIN, Climb, as_parameters, climb

KEPT = 10
"""Distinct points that a search carries along."""

WAY = 1e-2
"""Gain in −log L, at which a climb on the way ends: it is a tenth of a standard error off."""

_ON_THEWAY = 12  # evaluations of such a climb: twice what one in a valley takes
_ABOVE = 30.0  # of χ²: a minimum so far up has a likelihood of 3e-7
_SAME = 0.5  # standard errors: two climbs that end so close ended in one minimum


def climb_on(problem: Any, start: Array, held: Sequence[int] = (), **options: Any) -> Climb | None:
    """Return the end of a climb from a start on a problem.   held : unknowns that keep their values."""
    bounds = problem.bounds(start)
    bounds.free[[*held]] = False
    return climb(problem.products, as_parameters(start, bounds), **options)


def distinct(ends: Iterable[Climb | None], names: int, above: float = _ABOVE) -> list[Climb]:
    """Return the lowest ends of climbs that differ in their common unknowns, at most ten, the lowest first.

    names : number of common unknowns.   above : of χ², beyond the lowest, from where on ends are left out.
    """
    kept: list[Climb] = []
    errors = np.ones(names)
    for end in sorted(filter(None, ends), key=lambda one: one.chi_square):
        if kept and (end.chi_square > kept[0].chi_square + above or len(kept) == KEPT):
            break
        apart = (np.abs(end.point - other.point)[:names] for other in kept)
        if all((distance > _SAME * errors).any() for distance in apart):
            kept.append(end)
        if len(kept) == 1:
            information = end.products[:-1, :-1]
            covariance = inverse_information(information, np.full(len(information), math.inf))
            errors = np.sqrt(np.diag(covariance))[:names]
    return kept


def inverse_information(information: Array, errors: Array) -> Array:
    """Return the covariance of unknowns with this information, (p, p), and prior standard errors, (p,); zero for an
    unknown on which nothing depends."""
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


def climbs(problem: Any, starts: Iterable[Array], above: float = _ABOVE) -> list[Climb]:
    """Return the distinct ends of climbs from some starts, not quite to the end."""
    ends = (climb_on(problem, start, gain=WAY, most=_ON_THEWAY) for start in starts)
    return distinct(ends, len(problem.names), above)


def minimise(problem: Any, starts: Iterable[Array], scanned: str = "rho") -> list[Any]:
    """Return the minima that climbs from some starts and a scan find, the lowest first; empty where there is no motion.

    Use it for the last fit of a search; the first of the list is the answer, the others are as good within 30 of χ².

    scanned : unknown along which χ² has several minima, a K_z^{−1/2}; empty for none.
    """
    thin = problem.thinned()
    ends = climbs(thin, starts)
    if ends and scanned and problem.is_free(scanned):
        ends = distinct(
            [*ends, *climbs(thin, minima_along(thin, ends[0].point, scanned))], len(thin.names)
        )
    if not ends:
        return []
    near = likely(ends, problem, thin)
    last = near if thin is problem else climbs(problem, [one.point for one in near])
    full = (climb_on(problem, one.point, gain=GAIN) for one in last)
    return [problem.fit(one) for one in distinct(full, len(problem.names))]


def likely(ends: Sequence[Climb], problem: Any, thin: Any) -> list[Climb]:
    """Return the ends of climbs on a thinned problem that may be the lowest on all samples."""
    # there χ² differs by as much more as there are more of them
    share = max(1.0, problem.samples / thin.samples)
    level = min(one.chi_square for one in ends) + 2.0 + _ABOVE / share
    return [one for one in ends if one.chi_square < level]


def minima_along(problem: Any, point: Array, name: str) -> list[Array]:
    """Return points at the minima of χ² along the stiffness whose inverse root is an unknown, the lowest ten."""
    ends = profile(problem, point, name, problem.scan(point))
    level = np.array([math.inf, *(end.chi_square for end in ends), math.inf])
    low = np.flatnonzero((level[1:-1] <= level[:-2]) & (level[1:-1] <= level[2:]))
    return [ends[i].point for i in low[np.argsort(level[1 + low], kind="stable")][:KEPT]]


def profile(problem: Any, point: Array, name: str, values: Array) -> list[Climb]:
    """Return the ends of short climbs with an unknown held at some values, from the best point either way, in the order
    of the unknown."""
    j = problem.names.index(name)
    values = np.sort(np.append(values, point[j]))
    ends: list[Climb] = []
    for some in (values[values >= point[j]], values[values < point[j]][::-1]):
        here = point
        for value in some:
            start = here.copy()
            start[j] = value
            end = climb_on(problem, start, [j], gain=0.5, most=3)
            if end is not None:
                ends.append(end)
                here = end.point
    return sorted(ends, key=lambda end: float(end.point[j]))
