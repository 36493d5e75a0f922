"""All minima of χ² of free decays that matter, and the intervals that they leave.

The ringing of a mass that sticks makes χ² oscillate along K_z: a fit whose ringing is a cycle off over the record is a
side minimum. The search starts from stiffnesses whose ringing has some cycles more or fewer or is a spectral line
after the mass came to rest, from a sequence of stiffnesses up to the rigid contact, and from a
grid of stiffnesses, of losses and of shares of friction in them, on thinned samples; what comes close is climbed to the
end on all of them. Kinks of χ², where an event appears or vanishes, are passed by starts with the contact spring loaded
differently and some standard errors aside. A minimum that is found lower is searched around again.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..motion.events import PHASE_V, PHASE_X
from ..solver import NORMAL_95
from .decay import COMMON, STATE, Decay, RingFit, fit_decays, rough_ends

_F_K, _C, _RHO, _M = range(4)
_SHARES = (0.05, 0.35, 0.65, 0.95)  # of friction in the loss
_LOSSES = tuple(np.geomspace(0.75, 1.4, 12).tolist())  # relative to that of the fit
_FINER = tuple(np.linspace(0.1, 1.0, 16).tolist())  # shares of friction next to these
_STIFFNESSES = (3.0, 8.0, 20.0, 50.0, 120.0, 300.0, 1000.0)  # of K_z/k
_FRICTIONS = tuple(np.geomspace(0.75, 1.33, 30).tolist())  # relative to that of the fit
_MASSES = (0.82, 0.9, 0.95, 1.05, 1.1, 1.2)  # relative, where the fit is not adequate
_SCANNED = tuple(np.geomspace(0.5, 1e5, 45).tolist())  # of K_z/k, the last as good as rigid
_LOADS, _OTHER = (0.0, 0.5, 1.0, 1.5, 2.0), 0.2  # of w, and how far off another start is
_ASIDE = 1.5  # standard errors
_CYCLES, _PER_CYCLE = 5, 3  # of ringing, more or fewer, and starts in each
_LINES = 24  # of the spectrum of the ringing
_BELOW = 10.0  # of the likelihood's logarithm: lines that fall so far behind the first are left out
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


def minima_of(fit: RingFit, *, wide: bool = True) -> list[RingFit]:
    """The minima of χ² that a search finds, the lowest first, up to 30 above it; `fit` is where it starts.

    wide : whether to search over the loss of energy as well, and on around what is found until nothing lower is.
    """
    thin = [_thinned(one, _THINNED // len(fit.decays)) for one in fit.decays]
    found = [fit]
    for turn in range(_ROUNDS if wide else 1):
        best = found[0]
        starts = [] if turn and best.adequate else [*_starts(best, wide)]
        for end in _promising(thin, best, starts):
            _keep(found, fit_decays(fit.decays, fit.k, end))
        found.sort(key=lambda one: one.chi_square)
        if best.chi_square - found[0].chi_square < _LOWER:
            break
    return [one for one in found if one.chi_square < found[0].chi_square + _WITHIN]


def _keep(found: list[RingFit], other: RingFit | None) -> None:
    """Add a fit unless it is one of those found; of two climbs to one minimum the lower stays."""
    if other is None:
        return
    for i, one in enumerate(found):
        errors = np.sqrt(np.diag(one.covariance)[: len(COMMON)])
        apart = np.abs(other.point - one.point)[: len(COMMON)]
        if (apart <= _SAME * errors).all():
            if other.chi_square < one.chi_square:
                found[i] = other
            return
    found.append(other)


def _promising(thin: Sequence[Decay], fit: RingFit, starts: Sequence[Array]) -> list[Array]:
    """Where climbs on all samples nearly end, apart from each other and from the fit: from the starts that are best on
    thinned samples, from other contacts, and from the other side of kinks."""
    k = fit.k
    common = set(range(len(COMMON)))
    rough = rough_ends(thin, k, np.array(starts), given=common, gain=1.0, most=3)
    tried = [*rough[:_TRIED, :-1], *_other_contacts(thin, fit)]
    if fit.F_k > 0.0 and fit.free[_F_K]:
        tried += _along(thin, fit, _F_K, fit.F_k * np.array(_FRICTIONS))
    ends = rough_ends(thin, k, np.array(tried), gain=_COARSE, most=12)
    near = [*_apart(ends, fit), *_aside(fit)]
    return _apart(rough_ends(fit.decays, k, np.array(near), gain=_COARSE, most=12), fit)


def _apart(ends: Array, fit: RingFit) -> list[Array]:
    """The lowest ends of climbs that differ from each other and, unless they are lower, from a fit."""
    errors = np.sqrt(np.diag(fit.covariance)[: len(COMMON)])
    kept: list[Array] = []
    for end in ends:
        if len(kept) == _POLISHED or end[-1] > ends[0, -1] + _WITHIN:
            break
        point = end[: len(COMMON)]
        if all((np.abs(point - other[: len(COMMON)]) > _SAME * errors).any() for other in kept):
            kept.append(end[:-1])
    return kept


def _other_contacts(thin: Sequence[Decay], fit: RingFit) -> list[Array]:
    """The local minima of χ² along a sequence of contacts."""
    stiffnesses = np.array([*_SCANNED, *_next_cycles(fit), *_lines(fit)])
    return _along(thin, fit, _RHO, 1.0 / np.sqrt(stiffnesses * fit.k))


def _along(thin: Sequence[Decay], fit: RingFit, j: int, values: Array) -> list[Array]:
    """The local minima of χ² along values of unknown j, the others following, up to 30 above the least."""
    own = float(fit.point[j])
    values = np.sort(np.append(values, own))
    middle = int(np.searchsorted(values, own))
    given = {i for i in range(fit.point.size) if not fit.free[i]} | {j}
    parts = []
    for some in (values[middle:], values[middle::-1]):
        starts = np.tile(fit.point, (some.size, 1))
        starts[:, j] = some
        parts.append(rough_ends(thin, fit.k, starts, given=given, gain=0.5, most=3, following=True))
    ends = np.concatenate([parts[1][:0:-1], parts[0]])
    level = np.concatenate([[math.inf], ends[:, -1], [math.inf]])
    lowest = (level[1:-1] <= level[:-2]) & (level[1:-1] <= level[2:])
    lowest &= level[1:-1] < np.min(level) + _WITHIN
    some = ends[lowest]
    return list(some[np.argsort(some[:, -1], kind="stable"), :-1][:_LINES])


def _rests(fit: RingFit) -> list[float]:
    """How long the mass of each decay sticks at its end, s."""
    return [max(one.end - one.start - fit.sticks_from(i), 0.0) for i, one in enumerate(fit.decays)]


def _next_cycles(fit: RingFit) -> list[float]:
    """K_z/k of contacts on which the mass that sticks rings some cycles more or fewer."""
    rings = max(_rests(fit))
    Omega = math.sqrt((fit.k + fit.point[_RHO] ** -2) / fit.m)
    if not rings * Omega > 2.0 * math.pi:
        return []
    cycles = np.arange(-_CYCLES * _PER_CYCLE, _CYCLES * _PER_CYCLE + 1) / _PER_CYCLE
    stiffness = fit.m / fit.k * (Omega + 2.0 * math.pi * cycles[cycles != 0.0] / rings) ** 2 - 1.0
    return [one for one in stiffness.tolist() if one > 0.1]


def _lines(fit: RingFit) -> list[float]:
    """K_z/k of contacts on which the mass rings at a line of the spectrum of the samples after it came to rest."""
    tails = []
    for i, one in enumerate(fit.decays):
        since = one.start + fit.sticks_from(i)
        for signal in one.signals if since < one.end else ():
            tail = signal.between(since, one.end)
            if tail.t.size >= 16:
                tails.append(((tail.values - tail.values.mean()) / tail.noise, tail.dt))
    if not tails:
        return []
    longest = max(values.size * dt for values, dt in tails)
    slipping = math.sqrt(fit.k / fit.m)
    Omega = np.arange(1.2 * slipping, math.pi / min(dt for _, dt in tails), 0.5 * math.pi / longest)
    gain = np.zeros(Omega.size)  # of −log L, by a line of any phase in each of the tails
    for values, dt in tails:
        size = 4 << (values.size - 1).bit_length()
        power = np.abs(np.fft.rfft(values, size)) ** 2 / values.size
        gain += np.interp(Omega * (dt * size / (2.0 * math.pi)), np.arange(power.size), power)
    around = np.concatenate([[0.0], gain, [0.0]])
    peaks = np.flatnonzero((gain >= around[:-2]) & (gain >= around[2:]))
    peaks = peaks[np.argsort(-gain[peaks], kind="stable")][:_LINES]
    peaks = peaks[gain[peaks] > gain[peaks[:1]].sum() - _BELOW]
    stiffness = fit.m * Omega[peaks] ** 2 / fit.k - 1.0
    return [one for one in stiffness.tolist() if one > 0.1]


def _starts(fit: RingFit, wide: bool) -> Iterator[Array]:
    """Points of a grid over the stiffness of the contact and the share of friction in the loss of energy.

    In a wide search the loss itself is varied as well: with each half cycle more or fewer until the mass sticks, χ² has
    another minimum.
    """
    phases = fit.phases(0)
    travel = float(np.abs(np.diff(phases[:, PHASE_X])).sum())
    # ∫ ẋ² dt of half a cycle is π/4 of the top speed times the travel
    ratio = 0.25 * math.pi * float(np.abs(phases[:, PHASE_V]).max())
    loss = fit.F_k + ratio * fit.c  # of energy, over the travel
    pairs = [(fit.F_k, fit.c)]
    if ratio > 0.0 and travel > 0.0:
        pairs += [(share * loss, (1.0 - share) * loss / ratio) for share in _SHARES]
    stiffnesses = [fit.point[_RHO], *(1.0 / math.sqrt(stiff * fit.k) for stiff in _STIFFNESSES)]
    grid = list(itertools.product(stiffnesses, pairs))
    if wide and len(pairs) > 1:
        closer = itertools.product((fit.point[_RHO],), _LOSSES, _FINER)
        grid += [(rho, (f * s * loss, f * (1.0 - s) * loss / ratio)) for rho, f, s in closer]
    points = [(F_k, c, rho, fit.m) for rho, (F_k, c) in grid]
    if wide and not fit.adequate:
        # another mass, which rings on its contact as fast as this one
        together = fit.k + fit.point[_RHO] ** -2
        for mass, f, s in itertools.product(_MASSES, _LOSSES[::2], _SHARES):
            rho = max(mass * together - fit.k, 0.1 * fit.k) ** -0.5
            points.append(
                (f * s * loss, f * (1.0 - s) * loss / max(ratio, 1e-300), rho, mass * fit.m)
            )
    for point in points:
        start = fit.point.copy()
        start[: len(COMMON)] = point
        yield start


def _aside(fit: RingFit) -> Iterator[Array]:
    """Points on the other side of kinks next to a fit: with the contact spring of a decay loaded differently at its
    start, and some standard errors away along each common unknown."""
    for j, side in itertools.product((_F_K, _C, _RHO), (-_ASIDE, _ASIDE)):
        if fit.covariance[j, j] > 0.0:
            step = side * fit.covariance[:, j] / math.sqrt(fit.covariance[j, j])
            start = fit.point + step
            if (start[: len(COMMON)] > 0.0).all():
                yield start
    first = fit.point.size - STATE * len(fit.decays)
    for i, w in itertools.product(range(len(fit.decays)), _LOADS):
        place = first + STATE * i + 2
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
        errors = np.sqrt(np.diag(one.covariance)[: len(COMMON)])
        free = errors > 0.0
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
