"""All minima of χ² of free decays that matter, and the intervals that they leave.

The ringing of a mass that sticks makes χ² oscillate along K_z: a fit whose ringing is a cycle off over the record is a
side minimum. The search has four stages, each of which passes on what is lowest: starts, from a grid of losses, shares
of friction and stiffnesses, from lines of the spectrum after the mass came to rest, and along K_z and F_k; climbs on
thinned samples; climbs on all samples, with starts on the other side of kinks of χ², where an event appears or
vanishes; and climbs to the end. A minimum that is found lower is searched around again.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from ..arrays import Array
from ..motion.climb import Climb
from ..motion.events import PHASE_V
from ..solver import NORMAL_95
from .decay import COMMON, Decay, RingFit, Samples, fit_decays

_F_K, _C, _RHO, _M = range(4)
_SHARES = (0.05, 0.35, 0.65, 0.95)  # of friction in the loss
_LOSSES = tuple(np.geomspace(0.75, 1.4, 12).tolist())  # relative to that of the fit
_FINER = tuple(np.linspace(0.1, 1.0, 16).tolist())  # shares of friction next to these
_STIFFNESSES = (3.0, 8.0, 20.0, 50.0, 120.0, 300.0, 1000.0)  # of K_z/k
_FRICTIONS = np.geomspace(0.75, 1.33, 30)  # relative to that of the fit
_MASSES = (0.82, 0.9, 0.95, 1.05, 1.1, 1.2)  # relative, where the fit is not adequate
_SCANNED = tuple(np.geomspace(0.5, 1e5, 45).tolist())  # of K_z/k, the last as good as rigid
_LOADS, _OTHER = (0.0, 0.5, 1.0, 1.5, 2.0), 0.2  # of w, and how far off another start is
_ASIDE = 1.5  # standard errors
_LINES = 24  # of the spectrum of the ringing
_BELOW = 10.0  # of the likelihood's logarithm: lines that fall so far behind the first are left out
_RESTS = 16  # samples of a mass at rest that show a line
_THINNED = 1500  # samples, about, of a thinned record
_TRIED, _POLISHED = 20, 12  # starts that are climbed from, on thinned samples and on all
_WITHIN = 30.0  # of χ²: minima that are kept
_SAME = 1.0  # standard errors: two climbs that end so close ended in one minimum
_LOWER = 0.05  # of χ²: what another minimum must be lower by to be searched around again
_ROUNDS = 6
_COARSE = 1e-2  # of half of χ², where a climb on the way ends
_LEVEL = NORMAL_95**2  # of χ² above the least, at the ends of an interval
_REST = 0.025  # of the likelihood, that minima left out may have
_PROFILES = 8  # climbs to an end of an interval
_NEAR = 0.1  # of its distance: where an end is taken as found


End = TypeVar("End", RingFit, Climb)


def minima_of(fit: RingFit, *, wide: bool = True) -> list[RingFit]:
    """The minima of χ² that a search finds, the lowest first, up to 30 above it; `fit` is where it starts.

    wide : whether to search over the loss of energy as well, and on around what is found until nothing lower is.
    """
    thin = [_thinned(one, _THINNED // len(fit.decays)) for one in fit.decays]
    minima = [fit]
    for turn in range(_ROUNDS if wide else 1):
        best = minima[0]
        grid = [] if turn and best.adequate else [*_grid(best, wide)]
        ends = (fit_decays(fit.decays, fit.k, start) for start in _promising(thin, best, grid))
        minima = _distinct([*minima, *filter(None, ends)], best)
        if best.chi_square - minima[0].chi_square < _LOWER:
            break
    return minima


def _distinct(ends: Sequence[End], fit: RingFit) -> list[End]:
    """The lowest ends of climbs that differ from each other by more than standard errors of a fit, the lowest first."""
    kept: list[End] = []
    for end in sorted(ends, key=lambda end: end.chi_square):
        if kept and end.chi_square > kept[0].chi_square + _WITHIN:
            break
        apart = (np.abs(end.point - other.point)[: len(COMMON)] for other in kept)
        if all((distance > _SAME * fit.errors).any() for distance in apart):
            kept.append(end)
    return kept


def _promising(thin: Sequence[Decay], fit: RingFit, grid: Sequence[Array]) -> list[Array]:
    """Where climbs on all samples nearly end, apart from each other: from the points of a grid that are best on thinned
    samples, from other contacts and frictions, and from the other side of kinks."""
    samples, whole = (Samples.of(of, fit.k, fit.point.size) for of in (thin, fit.decays))
    rough = samples.climbs(grid, range(len(COMMON)), gain=1.0, most=3)
    stiffnesses = np.array([*_SCANNED, *(K_z / fit.k for K_z, _ in ringing(fit, fit.decays))])
    tried = [*rough[:_TRIED], *_along(samples, fit, _RHO, 1.0 / np.sqrt(stiffnesses * fit.k))]
    if fit.F_k > 0.0 and fit.free[_F_K]:
        tried += _along(samples, fit, _F_K, fit.F_k * _FRICTIONS)
    ends = samples.climbs((end.point for end in tried), gain=_COARSE, most=12)
    near = [*(end.point for end in _distinct(ends, fit)[:_POLISHED]), *_aside(fit)]
    ends = _distinct(whole.climbs(near, gain=_COARSE, most=12), fit)
    return [end.point for end in ends[:_POLISHED]]


def _along(samples: Samples, fit: RingFit, j: int, values: Array) -> list[Climb]:
    """The local minima of χ² along values of unknown j, up to 30 above the least; the others follow from that of the
    fit on, either way."""
    given = {*np.flatnonzero(~fit.free).tolist(), j}
    values = np.sort(np.append(values, fit.point[j]))
    ends = []
    for some in (values[values >= fit.point[j]], values[values < fit.point[j]][::-1]):
        point = fit.point
        for value in some:
            start = point.copy()
            start[j] = value
            end = samples.climb(start, given, gain=0.5, most=3)
            if end is not None:
                ends.append(end)
                point = end.point
    ends.sort(key=lambda end: float(end.point[j]))
    level = np.array([math.inf, *(end.chi_square for end in ends), math.inf])
    lowest = (level[1:-1] <= level[:-2]) & (level[1:-1] <= level[2:])
    lowest &= level[1:-1] < level.min() + _WITHIN
    some = [ends[i] for i in np.flatnonzero(lowest)]
    return sorted(some, key=lambda end: end.chi_square)[:_LINES]


def ringing(fit: RingFit, decays: Sequence[Decay], wait: float = 0.0) -> list[tuple[float, float]]:
    """K_z = mΩ² − k of the contacts on which the mass at rest rings at a line of the spectrum, and what each line gains
    in the likelihood's logarithm, the largest first.

    decays : those of the fit, or longer ones.   wait : s after the mass came to rest.
    """
    tails = []
    for i, one in enumerate(decays):
        since = one.start + fit.sticks_from(i, one.end) + wait
        for signal in one.signals if since < one.end else ():
            tail = signal.between(since, one.end)
            if tail.t.size >= _RESTS:
                tails.append(((tail.values - tail.values.mean()) / tail.noise, tail.dt))
    if not tails:
        return []
    longest = max(values.size * dt for values, dt in tails)
    slipping = math.sqrt(fit.k / fit.m)
    Omega = np.arange(1.2 * slipping, math.pi / min(dt for _, dt in tails), 0.5 * math.pi / longest)
    gain = np.zeros(Omega.size)  # by a line of any phase in each of the tails
    for values, dt in tails:
        size = 4 << (values.size - 1).bit_length()
        power = np.abs(np.fft.rfft(values, size)) ** 2 / values.size
        gain += np.interp(Omega * (dt * size / (2.0 * math.pi)), np.arange(power.size), power)
    around = np.concatenate([[0.0], gain, [0.0]])
    peaks = np.flatnonzero((gain >= around[:-2]) & (gain >= around[2:]))
    peaks = peaks[np.argsort(-gain[peaks], kind="stable")][:_LINES]
    peaks = peaks[gain[peaks] > gain[peaks[:1]].sum() - _BELOW]
    lines = zip(fit.m * Omega[peaks] ** 2 - fit.k, gain[peaks], strict=True)
    return [(float(K_z), float(by)) for K_z, by in lines if K_z > 0.1 * fit.k]


def _grid(fit: RingFit, wide: bool) -> Iterator[Array]:
    """Points of a grid over the stiffness of the contact and the share of friction in the loss of energy.

    In a wide search the loss itself is varied as well: with each half cycle more or fewer until the mass sticks, χ² has
    another minimum. Where the fit is not adequate, so is the mass, which rings on its contact as fast as that of the
    fit.
    """
    loss, ratio = loss_of(fit)
    own, stiffnesses = fit.point[_RHO] ** -2, [fit.k * by for by in _STIFFNESSES]
    shares = (fit.F_k / loss, *_SHARES) if loss > 0.0 else _SHARES
    grids: list[tuple[Sequence[float], ...]] = [((1.0,), shares, (own, *stiffnesses), (1.0,))]
    if wide:
        grids.append((_LOSSES, _FINER, (own,), (1.0,)))
    if wide and not fit.adequate:
        grids.append((_LOSSES[::2], _SHARES, (own,), _MASSES))
    for of_loss, share, stiffness, mass in itertools.chain(*(itertools.product(*g) for g in grids)):
        together = mass * (fit.k + stiffness) - fit.k
        start = fit.point.copy()
        start[_F_K], start[_C] = of_loss * share * loss, of_loss * (1.0 - share) * loss / ratio
        start[_RHO], start[_M] = max(together, 0.1 * fit.k) ** -0.5, mass * fit.m
        yield start


def loss_of(fit: RingFit) -> tuple[float, float]:
    """Loss of energy of the first decay over its travel, N, and ∫ ẋ² dt over it, m/s: F_k + ratio · c is the loss."""
    # ∫ ẋ² dt of half a cycle is π/4 of the top speed times the travel
    ratio = 0.25 * math.pi * float(np.abs(fit.phases(0)[:, PHASE_V]).max())
    return fit.F_k + ratio * fit.c, max(ratio, 1e-300)


def _aside(fit: RingFit) -> Iterator[Array]:
    """Points on the other side of kinks next to a fit: with the contact spring of a decay loaded differently at its
    start, and some standard errors away along each common unknown."""
    for j, side in itertools.product((_F_K, _C, _RHO), (-_ASIDE, _ASIDE)):
        if fit.errors[j] > 0.0:
            start = fit.point + side * fit.covariance[:, j] / fit.errors[j]
            if (start[: len(COMMON)] > 0.0).all():
                yield start
    for i, w in itertools.product(range(len(fit.decays)), _LOADS):
        place = fit.places(i).stop - 1
        if abs(fit.point[place] - w) > _OTHER:
            start = fit.point.copy()
            start[place] = w
            yield start


def _thinned(one: Decay, most: int) -> Decay:
    """A decay with every n-th sample, about as many as asked for."""
    n = max(1, one.samples // most)
    signals = tuple(replace(s, t=s.t[::n], values=s.values[::n]) for s in one.signals)
    return replace(one, signals=signals)


def with_intervals(fits: Sequence[RingFit]) -> RingFit:
    """The lowest of some minima, with the intervals that all of them leave.

    An interval is the hull of {χ² − χ²_min < 3.84} over all minima: profiled over the other unknowns at the lowest,
    from the standard errors at the others. Noise lowers one minimum of many by more than that: minima higher up count
    until those left out have less than a fortieth of the likelihood of all, integrated over the unknowns.
    """
    best = fits[0]
    others = [
        one for one, share in zip(fits[1:], _shares_above(fits), strict=True) if share > _REST
    ]
    ranges = {}
    for j, name in enumerate(COMMON[:_M]):
        if not best.error(name) > 0.0:
            continue
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
        common = one.covariance[: len(COMMON), : len(COMMON)][np.ix_(free, free)]
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
    distance = side * NORMAL_95 * math.sqrt(fit.covariance[j, j])
    given = {i for i in range(fit.point.size) if fit.covariance[i, i] == 0.0}
    near = fit.point + fit.covariance[:, j] * (distance / fit.covariance[j, j])
    near[: len(COMMON)] = np.maximum(near[: len(COMMON)], 1e-3 * fit.point[: len(COMMON)])
    for _ in range(_PROFILES):
        if fit.point[j] + distance <= 0.0:
            break
        rises = []
        for point in (near, fit.point):
            start = point.copy()
            start[j] = fit.point[j] + distance
            held = fit_decays(fit.decays, fit.k, start, given={*given, j}, gain=_COARSE, most=12)
            if held is not None:
                rises.append((held.chi_square - fit.chi_square, held))
                if rises[-1][0] < 2.0 * _LEVEL:
                    break
        if not rises:
            break
        rise, held = min(rises, key=lambda one: one[0])
        near = held.point
        # where χ² does not rise, the end is farther away
        factor = min(max(NORMAL_95 / math.sqrt(max(rise, 1e-3)), 0.4), 2.5)
        distance *= factor
        if abs(factor - 1.0) < _NEAR:
            break
    return float(fit.point[j]) + distance
