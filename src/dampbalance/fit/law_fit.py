"""Free decays under other laws: what a further term would explain, and the oscillator of largest likelihood.

The residual of a fit with friction and viscous damping is tested against what one more coefficient would change in the
samples (`score.py`). A law is fitted by climbs, as the oscillator is; χ² of nested laws differ as χ² of as many degrees
of freedom as coefficients.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Mask
from ..law.terms import FRICTION
from ..motion.law_decays import ADDED, law_decay
from ..motion.unknowns import F_K, OSCILLATOR_UNKNOWNS, RHO, M
from ..signals.bursts import Signal
from .climb import ClimbBounds, climb
from .decay import (
    STATE,
    Decay,
    DecaySamples,
    RingFit,
    friction_places,
    inverse_information,
    numbers_of,
    preload_errors,
    residual_columns,
)
from .score import Departure, departures_from

DECAY_TERMS = (FRICTION, "c", "c_2", "c_3")
"""Terms that free decays distinguish: base at rest and at one frequency, c_r and eta act as c does."""

_LAW_UNKNOWNS = (*OSCILLATOR_UNKNOWNS, *ADDED)
_MASS_FACTOR = 2.0  # of the mass over that of the fit, either way
_MOST_EVALUATIONS, _LAST_GAIN = (
    40,
    1e-4,
)  # of a climb: evaluations, and what the last step would gain in half of χ²
# Of what a law leaves out, and of a climb on the way: the end in half of χ², and evaluations.
_PARTS, _COARSE_GAIN, _FEW_EVALUATIONS = (0.25, 0.5, 0.75, 1.0), 1e-2, 10
_SMALL = 1e-3  # of the damping of the fit: a coefficient below that counts as zero
_DENSE = 64  # instants of a period, of which a loss of energy is summed


@dataclass(frozen=True, eq=False, kw_only=True)
class LawFit(RingFit):
    """The oscillator with a law whose decays fit the samples best.

    The unknowns are those of the oscillator, `ADDED`, the offsets, and the start state of each decay.

    terms : of its damping.
    """

    terms: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """F_k, c, rho, m, and the symbols of `ADDED`."""
        return _LAW_UNKNOWNS

    @cached_property
    def _columns(self) -> Array:
        whole = _columns(self.decays, self.k, self.point)
        assert whole is not None  # a climb ended there
        return whole

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.samples - int(self.free.sum())

    def without(self, symbols: Sequence[str]) -> float:
        """What χ² rises by without the coefficients of some terms, to first order: pᵀ C⁻¹ p (Wald's test)."""
        places = [_LAW_UNKNOWNS.index(symbol) for symbol in symbols]
        covariance = self.covariance[np.ix_(places, places)]
        errors = np.sqrt(np.diag(covariance))
        z = self.point[places] / errors
        return float(z @ np.linalg.lstsq(covariance / np.outer(errors, errors), z)[0])

    def coefficient(self, symbol: str) -> tuple[float, float]:
        """Value and standard error of the coefficient of a term, SI."""
        return self.value(symbol), self.error(symbol)


def law_departures(fit: RingFit) -> list[Departure]:
    """What each of `ADDED` would explain (`departures_from`); empty where the motion cannot be followed."""
    whole = _columns(fit.decays, fit.k, _with_added(fit.point, 0.0))
    if whole is None:
        return []
    own = np.flatnonzero(_with_added(np.abs(fit.jacobian).max(axis=0), 0.0))
    # of several friction forces, by their mean and by the others' distance from the first
    further = [*dict.fromkeys(friction_places(fit.decays, whole.shape[1] - 1))][1:]
    first_force = whole[:, [F_K]]
    whole[:, [F_K]] += whole[:, further].sum(axis=1, keepdims=True)
    whole[:, further] -= first_force
    first = len(OSCILLATOR_UNKNOWNS)
    added = {symbol: whole[:, first + j] for j, symbol in enumerate(ADDED)}
    names = [OSCILLATOR_UNKNOWNS[at] for at in own if at < first]
    return departures_from(whole[:, -1], whole[:, own], added, names, noise_known=False)


def fit_law(fit: RingFit, terms: Sequence[str], starts: Iterable[Array] = ()) -> LawFit | None:
    """The oscillator with a law, no coefficient negative, to the decays of a fit; None where no climb leads to one.

    What the law leaves out is taken from the fit in steps, each of which the other terms make up for.

    terms : of `DECAY_TERMS`.   starts : points of other laws, to climb from as well.
    """
    losses = _losses(fit)
    others = [
        at
        for at, symbol in enumerate(_LAW_UNKNOWNS)
        if symbol in DECAY_TERMS and symbol not in terms
    ]
    if FRICTION not in terms:
        others += friction_places(fit.decays, fit.point.size + len(ADDED))
    free = _with_added(fit.free, 0.0).astype(np.bool_)
    free[[_LAW_UNKNOWNS.index(s) for s in terms]] = True
    free[others] = False
    if FRICTION not in terms:
        free[[RHO, *range(free.size - STATE * len(fit.decays) + 2, free.size, STATE)]] = False
    bounds = _bounds(fit, free, losses)

    def evaluate(point: Array, out: Array) -> bool:
        whole = _columns(fit.decays, fit.k, point)
        if whole is not None:
            np.matmul(whole.T, whole, out=out)
        return whole is not None

    def towards(start: Array) -> Array:
        """The start without what the law leaves out, which its terms make up for."""
        lost = math.fsum(
            start[_LAW_UNKNOWNS.index(s)] / losses[s] for s in DECAY_TERMS if s not in terms
        )
        point = start
        for part in _PARTS if lost > 0.0 else ():
            point = point.copy()
            for s in terms:
                point[_LAW_UNKNOWNS.index(s)] += losses[s] * lost / len(_PARTS) / len(terms)
            point[others] = (1.0 - part) * start[others]
            reached = climb(evaluate, point, bounds, gain=_COARSE_GAIN, most=_FEW_EVALUATIONS)
            point = point if reached is None else reached.point
        point = point.copy()
        point[others] = 0.0
        return point

    ends = (
        climb(evaluate, towards(start), bounds, gain=_LAST_GAIN, most=_MOST_EVALUATIONS)
        for start in (_with_added(fit.point, 0.0), *starts)
    )
    best = min(filter(None, ends), key=lambda end: end.chi_square, default=None)
    if best is None:
        return None
    information, priors = best.products[:-1, :-1], preload_errors(free.size, len(fit.decays))
    return LawFit(
        k=fit.k,
        point=best.point,
        covariance=inverse_information(information * np.outer(free, free), priors),
        chi_square=best.chi_square,
        rigid=False,
        decays=fit.decays,
        free=free,
        terms=tuple(terms),
    )


def _with_added(of_fit: Array | Mask, value: float) -> Array:
    """What belongs to the unknowns of a fit, with a value for each of `ADDED` in its place."""
    return np.insert(of_fit, len(OSCILLATOR_UNKNOWNS), [value] * len(ADDED))


def _losses(fit: RingFit) -> dict[str, float]:
    """Coefficient of each term that alone would take the energy that friction and damping take in the fit."""
    powers = dict.fromkeys(DECAY_TERMS, 0.0)
    for i, one in enumerate(fit.decays):
        par = numbers_of(fit.point_of(i), fit.k)
        times = np.arange(0.0, one.end - one.start, one.period / _DENSE)
        x, v, preload = fit.point[fit.places(i)].tolist()
        speed = np.abs(law_decay(times, 1, x, v, preload, par, np.zeros(len(ADDED)))[:, 0])
        for order, symbol in enumerate(DECAY_TERMS):
            powers[symbol] += float(np.nansum(speed ** (order + 1)))
    loss = fit.F_k * powers[FRICTION] + fit.c * powers["c"]
    return {symbol: loss / power for symbol, power in powers.items()}


def _bounds(fit: RingFit, free: Mask, losses: Mapping[str, float]) -> ClimbBounds:
    """The bounds of a climb: no coefficient is negative.   losses : of `_losses`."""
    of_fit = DecaySamples.of(fit.decays, fit.k, fit.point.size).bounds(fit.point)
    lower, upper, scale = map(_with_added, of_fit[1:], (0.0, math.inf, 0.0))
    lower[friction_places(fit.decays, free.size)] = 0.0
    lower[M], upper[M] = fit.m / _MASS_FACTOR, fit.m * _MASS_FACTOR
    for symbol, alone in losses.items():
        scale[_LAW_UNKNOWNS.index(symbol)] = _SMALL * alone
    return ClimbBounds(free, lower, upper, scale)


def _columns(decays: Sequence[Decay], k: float, point: Array) -> Array | None:
    """Derivatives of the residuals (model − sample)/σ by all unknowns of a law, and these residuals, (samples, p + 1);
    None where the contact rattles."""
    p, places = (
        point[len(OSCILLATOR_UNKNOWNS) : len(_LAW_UNKNOWNS)],
        friction_places(decays, point.size),
    )
    states = point[point.size - STATE * len(decays) :].reshape(-1, STATE).tolist()

    def samples(i: int, signal: Signal) -> Array:
        x, v, preload = states[i]
        par = numbers_of(np.concatenate([point[[places[i]]], point[1:]]), k)
        return law_decay(signal.t - decays[i].start, signal.order, x, v, preload, par, p)

    whole = residual_columns(decays, point, len(_LAW_UNKNOWNS), samples)
    return whole if np.isfinite(whole).all() else None
