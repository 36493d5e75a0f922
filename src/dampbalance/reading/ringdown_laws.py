"""Free decays under other laws: what a further term would explain, and the oscillator of largest likelihood.

The residual r of a fit with friction and viscous damping is tested against what one more coefficient p would change in
the samples, g = ∂r/∂p: with the unknowns of the fit adjusted, p = −gᵀr/gᵀg with the variance 1/gᵀg, g taken orthogonal
to the derivatives by them. This is the score test, and costs one evaluation. A law is fitted by climbs, as the
oscillator is; χ² of nested laws differ as χ² of as many degrees of freedom as coefficients.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..law.terms import FRICTION
from ..motion.law_decays import ADDED, law_decay
from .climb import Evaluation, climb
from .ringdown_fit import COMMON, STATE, Decay, RingFit, numbers_of

TERMS = (FRICTION, "c", "c_2", "c_3")
"""Terms that free decays distinguish: base at rest and at one frequency, c_r and eta act as c does."""

_F_K, _C, _RHO, _M = range(4)
_RANK = 1e-9  # of the largest singular value
_SHOWN = 1e-10  # of the square of a derivative, that must be orthogonal to the others
_RIGID = 1e-8  # of k/K_z: the contact that stands for a rigid one
_MASSES = 2.0  # of the mass over that of the fit, either way
_MOST, _GAIN = 40, 1e-4  # of a climb: evaluations, and what the last step would gain in half of χ²
# Of what a law leaves out, and of a climb on the way: the end in half of χ², and evaluations.
_PARTS, _COARSE, _FEW = (0.25, 0.5, 0.75, 1.0), 1e-2, 10
_SMALL = 1e-3  # of the damping of the fit: a coefficient below that counts as zero
_DENSE = 64  # instants of a period, of which a loss of energy is summed


@dataclass(frozen=True, slots=True)
class Departure:
    """What a further coefficient would explain of the samples.

    symbol : of `ADDED`.   value, error : SI.   p : probability in noise of a coefficient as large.
    slopes : change of F_k and c with the coefficient.
    """

    symbol: str
    value: float
    error: float
    p: float
    slopes: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class LawFit:
    """The oscillator with a law whose decays fit the samples best.

    terms : of its damping.   point : unknowns of the fit, then `ADDED`.   covariance : of these, zero where one is
    held.   residual : (model − sample)/σ.   free : number of unknowns.
    """

    terms: tuple[str, ...]
    point: Array
    covariance: Array
    residual: Array
    free: int

    @property
    def chi_square(self) -> float:
        """Sum of squares of the residuals."""
        return float(self.residual @ self.residual)

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.residual.size - self.free

    def without(self, symbols: Sequence[str]) -> float:
        """What χ² rises by without the coefficients of some terms, to first order: pᵀ C⁻¹ p (Wald's test)."""
        places = [_place(symbol, self.point.size - len(ADDED)) for symbol in symbols]
        covariance = self.covariance[np.ix_(places, places)]
        errors = np.sqrt(np.diag(covariance))
        z = self.point[places] / errors
        return float(z @ np.linalg.lstsq(covariance / np.outer(errors, errors), z)[0])

    def coefficient(self, symbol: str) -> tuple[float, float]:
        """Value and standard error of the coefficient of a term, SI."""
        at = _place(symbol, self.point.size - len(ADDED))
        return float(self.point[at]), math.sqrt(self.covariance[at, at])


def departures(fit: RingFit) -> list[Departure]:
    """What each of `ADDED` would explain, those that the decays do not show left out.

    Use it to see whether friction and viscous damping account for the decays; the values hold to first order.
    """
    from scipy import special  # slow to import

    whole = _columns(fit.decays, fit.k, np.append(fit.point, np.zeros(len(ADDED))))
    if whole is None:
        return []
    own = np.flatnonzero(fit.jacobian.any(axis=0))
    first = fit.point.size
    length = np.linalg.norm(whole, axis=0)
    length[length == 0.0] = 1.0
    columns = [*own, *range(first, first + len(ADDED) + 1)]
    triangle = _triangle(whole[:, columns] / length[columns])
    known, added, residual = triangle[:, : own.size], triangle[:, own.size : -1], triangle[:, -1]
    basis, sizes, turn = np.linalg.svd(known, full_matrices=False)
    rank = int(np.count_nonzero(sizes > _RANK * sizes[0]))
    basis, inverse = basis[:, :rank], turn[:rank].T / sizes[:rank]
    rest = residual - basis @ (basis.T @ residual)
    freedom = whole.shape[0] - rank - 1
    found = []
    for j, symbol in enumerate(ADDED):
        g = added[:, j] - basis @ (basis.T @ added[:, j])
        square = float(g @ g)
        if not square > _SHOWN * float(added[:, j] @ added[:, j]):
            continue
        unit = length[-1] / length[first + j]
        slope = -float(g @ rest) / square
        left = float(rest @ rest) - slope**2 * square
        error = math.sqrt(max(left, 0.0) / max(freedom, 1) / square)
        p = 2.0 * float(special.stdtr(freedom, -abs(slope) / error)) if error > 0.0 else 1.0
        moved = -inverse @ (basis.T @ added[:, j]) * length[first + j] / length[own]
        slopes = {COMMON[at]: float(by) for at, by in zip(own, moved, strict=True) if at <= _C}
        found.append(Departure(symbol, slope * unit, error * unit, p, slopes))
    return found


def fit_law(fit: RingFit, terms: Sequence[str], starts: Iterable[Array] = ()) -> LawFit | None:
    """The oscillator with a law, no coefficient negative, to the decays of a fit; None where no climb leads to one.

    What the law leaves out is taken from the fit in steps, each of which the other terms make up for.

    terms : of `TERMS`.   starts : points of other laws, to climb from as well.
    """
    size = fit.point.size
    places = {symbol: _place(symbol, size) for symbol in TERMS}
    free = set(np.flatnonzero(fit.jacobian.any(axis=0)).tolist()) - set(places.values())
    free |= {places[s] for s in terms}
    if FRICTION not in terms:
        free -= {_RHO, *range(size - STATE * len(fit.decays) + 2, size, STATE)}
    at = np.array(sorted(free))
    losses, others = _losses(fit), [places[s] for s in TERMS if s not in terms]
    sizes = _sizes(fit, losses)
    lower, upper = np.full(sizes.size, -math.inf), np.full(sizes.size, math.inf)
    lower[_RHO], lower[_M], upper[_M] = math.sqrt(_RIGID / fit.k), fit.m / _MASSES, fit.m * _MASSES
    lower[list(places.values())] = 0.0
    for i in range(len(fit.decays)):
        place = fit.places(i).start + 2
        lower[place], upper[place] = 0.0, 2.0

    def triangle(point: Array) -> Evaluation | None:
        whole = _columns(fit.decays, fit.k, point)
        if whole is None:
            return None
        small = _triangle(whole)
        return Evaluation(small[:, -1], small[:, :-1])

    def towards(start: Array) -> Array:
        """The start without what the law leaves out, which its terms make up for."""
        lost = math.fsum(start[places[s]] / losses[s] for s in TERMS if s not in terms)
        point = start
        for part in _PARTS if lost > 0.0 else ():
            point = point.copy()
            for s in terms:
                point[places[s]] += losses[s] * lost / len(_PARTS) / len(terms)
            point[others] = (1.0 - part) * start[others]
            reached = climb(triangle, point, at, lower, sizes, upper, gain=_COARSE, most=_FEW)
            point = point if reached is None else reached.point
        point = point.copy()
        point[others] = 0.0
        return point

    ends = []
    for start in (np.append(fit.point, np.zeros(len(ADDED))), *starts):
        reached = climb(triangle, towards(start), at, lower, sizes, upper, gain=_GAIN, most=_MOST)
        ends += [] if reached is None else [reached]
    best = min(ends, key=lambda end: end.evaluation.value, default=None)
    whole = None if best is None else _columns(fit.decays, fit.k, best.point)
    if best is None or whole is None:
        return None
    covariance = np.zeros((sizes.size, sizes.size))
    length = np.linalg.norm(whole[:, at], axis=0)
    length[length == 0.0] = 1.0
    solution = np.linalg.pinv(_triangle(whole[:, at] / length), rcond=1e-9)
    covariance[np.ix_(at, at)] = solution @ solution.T / np.outer(length, length)
    return LawFit(tuple(terms), best.point, covariance, whole[:, -1], at.size)


def _place(symbol: str, size: int) -> int:
    """Place of a coefficient in a point.   size : of that of the fit."""
    return COMMON.index(symbol) if symbol in COMMON else size + ADDED.index(symbol)


def _losses(fit: RingFit) -> dict[str, float]:
    """Coefficient of each term that alone would take the energy that friction and damping take in the fit."""
    powers = dict.fromkeys(TERMS, 0.0)
    par = numbers_of(fit.point, fit.k)
    for i, one in enumerate(fit.decays):
        times = np.arange(0.0, one.end - one.start, one.period / _DENSE)
        x, v, w = fit.point[fit.places(i)].tolist()
        speed = np.abs(law_decay(times, 1, x, v, w, par, np.zeros(len(ADDED)))[:, 0])
        for order, symbol in enumerate(TERMS):
            powers[symbol] += float(np.nansum(speed ** (order + 1)))
    loss = fit.F_k * powers[FRICTION] + fit.c * powers["c"]
    return {symbol: loss / power for symbol, power in powers.items()}


def _sizes(fit: RingFit, losses: Mapping[str, float]) -> Array:
    """Size below which each unknown counts as zero.   losses : of `_losses`."""
    sizes = np.ones(fit.point.size + len(ADDED))
    sizes[_RHO], sizes[_M] = 1e-3 * fit.point[_RHO], fit.m
    for symbol, alone in losses.items():
        sizes[_place(symbol, fit.point.size)] = _SMALL * alone
    for one in fit.decays:
        for signal in one.signals:
            sizes[len(COMMON) + signal.offset] = float(np.ptp(signal.values))
    omega = math.sqrt(fit.k / fit.m)
    for i in range(len(fit.decays)):
        place = fit.places(i).start
        size = max(abs(fit.point[place]), abs(fit.point[place + 1]) / omega)
        sizes[place : place + 2] = size, size * omega
    return sizes


def _triangle(columns: Array) -> Array:
    """The triangle of a QR factorisation: the same sums of products in as many rows as there are columns."""
    return np.asarray(np.linalg.qr(columns, mode="r"))


def _columns(decays: Sequence[Decay], k: float, point: Array) -> Array | None:
    """Derivatives of the residuals (model − sample)/σ by all unknowns, and these residuals, (samples, p + 1); None
    where the contact rattles.

    point : unknowns of the fit, then `ADDED`.
    """
    first = point.size - len(ADDED)
    par, p = numbers_of(point[:first], k), point[first:]
    blocks = []
    for i, one in enumerate(decays):
        begin = first - STATE * (len(decays) - i)
        own = slice(begin, begin + STATE)
        x, v, w = point[own].tolist()
        for signal in one.signals:
            part = law_decay(signal.t - one.start, signal.order, x, v, w, par, p)
            block, offset = np.zeros((signal.t.size, point.size + 1)), len(COMMON) + signal.offset
            block[:, : len(COMMON)] = part[:, 1 : len(COMMON) + 1]
            block[:, own] = part[:, len(COMMON) + 1 : len(COMMON) + 1 + STATE]
            block[:, first:-1] = part[:, len(COMMON) + 1 + STATE :]
            block[:, offset] = 1.0
            block[:, -1] = part[:, 0] + point[offset] - signal.values
            blocks.append(block / signal.noise)
    whole = np.vstack(blocks)
    return whole if np.isfinite(whole).all() else None
