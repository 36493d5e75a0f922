"""Which damping law do records support? The laws of a few terms, each with its weight.

A law has friction or not, and up to `MOST_TERMS` further terms. Its coefficients p have the prior sizes τ of
`PRIORS["law"]`, in units of the coefficient that alone would take all of the work, and are not negative. With the fit
p̂ of covariance C and its χ², both in the noise that the best law leaves, and T = diag τ²,

    ln E = −½ χ² + ½ ln |C|/|C + T| − ½ p̂ᵀ (C + T)⁻¹ p̂ + Σ ln 2Φ(μ_j/σ_j)

is the logarithm of its evidence (`fit.select.evidence_of`), and its weight is in proportion to E Π π/(1 − π), a factor
for each term, π the share of the rigs that have it.

Few laws need a fit. To first order a fit shows those with one term more (score test), one fewer (Wald), and one in
place of another: the fit to the heaviest law that has none is computed until none of them weighs more than `REFITTED`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array
from ..findings.finding import Finding
from ..fit.decay import DecayFit, departures_of
from ..fit.fit import Fit
from ..fit.multistart import Trail, multistart
from ..fit.score import Departure, departures_from
from ..fit.select import PRIORS, REFITTED, bayes_factor, evidence_of, noise_of
from ..fit.steady_search import fit_quickly, refit
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..law.terms import FRICTION, KNOWN_TERMS, Term, in_order, term
from ..signals.mean_harmonics import Reading
from ..signals.one_thread import one_thread

MOST_TERMS = 2
"""Most terms of a law that is tried, in addition to friction."""

DECAY_TERMS = (FRICTION, "c", "c_2")
"""Terms that free decays distinguish: base at rest and at one frequency, c_r and eta act as c does."""

_PRIOR = PRIORS["law"]
_ODDS = math.log(_PRIOR.share / (1.0 - _PRIOR.share))
_NO_FIT = (
    4.0  # times the noise squared: a residual twice as large as the noise is that of another model
)
_NO_FORCE = 1e-9  # of k times the smallest base motion: a friction force that stands for none
_ALIKE = 1.001  # of frequencies: closer ones count as one

Terms = tuple[Term, ...]


@dataclass(frozen=True, eq=False)
class LawWeight:
    """A law with its weight.

    coefficients : by key, (value, standard error), SI units; empty of a law that is known to first order.
    chi_square, freedom : of its fit, in units of the noise of the records; NaN to first order.
    """

    terms: Terms
    weight: float
    coefficients: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    chi_square: float = math.nan
    freedom: float = math.nan


@dataclass(frozen=True, eq=False)
class LawComparison:
    """The weights of all laws.

    laws : the heaviest first.   noise : square of the scale of the noise that the best of them leaves.   left_out :
    findings on terms that these records cannot distinguish from others.   decays : whether the records are such.
    """

    laws: tuple[LawWeight, ...]
    noise: float
    left_out: tuple[Finding, ...] = ()
    decays: bool = False

    @property
    def chosen(self) -> Terms | None:
        """The heaviest law; None where even that does not fit."""
        return self.laws[0].terms if self.laws and self.noise < _NO_FIT else None

    @property
    def alike(self) -> tuple[Terms, ...]:
        """The other laws of some weight."""
        return tuple(one.terms for one in self.laws[1:] if one.weight > REFITTED)

    @property
    def findings(self) -> list[Finding]:
        """What follows from the weights."""
        if not self.laws:
            return [*self.left_out, Finding("no law tested")]
        best = {"law": self.laws[0].terms, "weight": self.laws[0].weight}
        if self.chosen is None:
            of = {"times": math.sqrt(self.noise), "most": MOST_TERMS, "decays": self.decays}
            return [*self.left_out, Finding("no law", best | of)]
        found = [*self.left_out, Finding("law", best)]
        if self.alike:
            found.append(Finding("laws alike", {"laws": self.alike, "decays": self.decays}))
        return found


def weighed(
    starts: Iterable[Terms],
    laws: Sequence[Terms],
    sizes: Mapping[str, float],
    fitted: Callable[[Terms, Fit | None], Fit | None],
    scored: Callable[[Terms, Fit], Mapping[str, Sequence[Departure]]],
) -> tuple[tuple[LawWeight, ...], float]:
    """Return the weights of laws, the heaviest first, and the square of the scale of the noise.

    starts : laws to fit first, until one has a fit.   sizes : coefficient of each term that takes all of the work.
    fitted : fit of a law, with the best one so far.   scored : what each term that a fit lacks would explain.
    """
    first = next(((law, fit) for law in starts if (fit := fitted(law, None)) is not None), None)
    if first is None:
        return (), 1.0
    fits, tests, failed = dict([first]), dict[Terms, Any](), set[Terms]()

    def weights_in(noise: float) -> dict[Terms, float]:
        logs = dict[Terms, float]()
        own = {law: _evidence(law, fit, sizes, noise) for law, fit in fits.items()}
        for law in sorted(fits, key=own.__getitem__):  # the best last: nearest to what is true
            for other, by in _neighbours(law, fits[law], tests[law], sizes, noise):
                logs[other] = own[law] + by
        logs = {law: of for law, of in (logs | own).items() if law in laws and law not in failed}
        powers = np.exp(np.array([*logs.values()]) - max(logs.values()))
        return dict(zip(logs, (powers / powers.sum()).tolist(), strict=True))

    while True:
        tests |= {law: scored(law, fit) for law, fit in fits.items() if law not in tests}
        noise = min(noise_of(fit.chi_square, fit.freedom) for fit in fits.values())
        # what a law far from the records leaves is no noise: the way to the best one is sought without
        for weights in map(weights_in, (1.0, noise)):
            asked = [law for law in weights if law not in fits and weights[law] > REFITTED]
            if asked:
                break
        else:
            every = [_weight(law, weights.get(law, 0.0), fits.get(law), noise) for law in laws]
            return tuple(sorted(every, key=lambda one: -one.weight)), noise
        law = max(asked, key=weights.__getitem__)
        if (fit := fitted(law, min(fits.values(), key=lambda one: one.chi_square))) is None:
            failed.add(law)
        else:
            fits[law] = fit


def _keys(law: Iterable[str], fit: Fit) -> list[str]:
    """Return the keys of the coefficients that a law has in a fit, those that are free."""
    return [one.key for one in fit.parameters if one.free and one.name in {*map(str, law)}]


def _evidence(law: Terms, fit: Fit, sizes: Mapping[str, float], noise: float) -> float:
    """Return ln of evidence and prior of a law that is fitted."""
    keys = _keys(law, fit)
    tau = [_PRIOR.size * sizes[term(key).symbol] for key in keys]
    values = np.array([fit.value(key) for key in keys])
    covariance = noise * fit.covariance_of(*keys)
    return evidence_of(fit.chi_square / noise, values, covariance, tau) + _ODDS * len(law)


def _neighbours(
    law: Terms,
    fit: Fit,
    tested: Mapping[str, Sequence[Departure]],
    sizes: Mapping[str, float],
    noise: float,
) -> Iterable[tuple[Terms, float]]:
    """Yield laws that differ from one by a term more, one fewer, or one in place of another, each with how much more
    ln of evidence and prior it has, to first order."""

    def factor(symbol: str, value: float, square: float) -> float:
        prior = _PRIOR._replace(size=_PRIOR.size * sizes[symbol])
        return bayes_factor(value, math.sqrt(noise * square), prior)[0] if square > 0.0 else 0.0

    def without(symbol: str, added: Sequence[Departure] = ()) -> float:
        lost = -_ODDS
        for key in _keys([symbol], fit):
            value = fit.value(key) + math.fsum(
                one.value * one.slopes.get(key, 0.0) for one in added
            )
            moved = math.fsum((one.error * one.slopes.get(key, 0.0)) ** 2 for one in added)
            lost -= factor(symbol, value, fit.error(key) ** 2 + moved)
        return lost

    if FRICTION not in law:  # what it would explain is not known: it has to be fitted
        yield in_order((FRICTION, *law)), 0.0
    for symbol in law:
        yield in_order({*law} - {symbol}), without(symbol)
    for more, of in tested.items():
        gained = _ODDS + math.fsum(factor(more, one.value, one.error**2) for one in of)
        yield in_order((*law, more)), gained
        for symbol in law:
            yield in_order({*law, more} - {symbol}), gained + without(symbol, of)


def _weight(law: Terms, weight: float, fit: Fit | None, noise: float) -> LawWeight:
    if fit is None:
        return LawWeight(law, weight)
    scale = math.sqrt(noise)
    values = {key: (fit.value(key), scale * fit.error(key)) for key in _keys(law, fit)}
    return LawWeight(law, weight, values, fit.chi_square, fit.freedom)


def laws_of(terms: Sequence[str], given: Iterable[str] = ()) -> list[Terms]:
    """Return the laws of up to `MOST_TERMS` of some terms in addition to those that are given, with friction and
    without, the smallest first."""
    laws = {
        in_order((*friction, *given, *some))
        for friction in ((FRICTION,), given)
        for size in range(MOST_TERMS + 1)
        for some in itertools.combinations(terms, size)
    }
    return sorted(filter(None, laws), key=lambda law: (len(law), law))


@one_thread
def compare_laws(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    mass: float | None = None,
) -> LawComparison:
    """Weigh the laws of up to two terms in addition to friction, or without it, on forced records.

    Use it where the damping is not known to be viscous: on records of several amplitudes, and of two frequencies or
    more to distinguish c from eta.

    readings, k, mass : as for `identify`.   law : its given coefficients are part of every law, and
    its groups apply to the terms that have some.
    """
    asked, lines = law or Law(), tuple(reading.lines for reading in readings)
    frequencies = [reading.steady.frequency_hz for reading in readings]
    left_out: tuple[Finding, ...] = ()
    every = in_order((*KNOWN_TERMS, *asked.terms))
    terms = [s for s in every if s not in (FRICTION, *asked.given)]
    if max(frequencies) < _ALIKE * min(frequencies) and {"c", "eta"} <= {*terms}:
        terms.remove(term("eta"))
        left_out = (Finding("eta like c"),)
    none = {FRICTION: _NO_FORCE * k * min(one.Y for one in lines)}

    def problem_of(kept: Iterable[str]) -> HarmonicProblem:
        given = asked.given if FRICTION in kept else {**asked.given, **none}
        groups = {s: of for s, of in asked.groups.items() if s in kept}
        return HarmonicProblem(Law(in_order((FRICTION, *kept)), given, groups), lines, k)

    def fitted(kept: Terms, near: Any) -> WaveformFit | None:
        fit = fit_quickly(problem_of(kept), near)
        if fit is not None and mass is not None and fit.parameters["m"].free:
            fit = refit(fit, given={"m": mass}) or fit
        return fit

    def scored(kept: Terms, fit: Any) -> dict[str, Sequence[Departure]]:
        rest = [s for s in terms if s not in kept]
        tests = {s: _of_term(s, problem_of((*kept, s)), fit) for s in rest}
        return {s: of for s, of in tests.items() if of}

    laws = [
        one
        for one in laws_of(terms, asked.given)
        if len(problem_of(one).law.unknowns) <= len(readings)
    ]
    starts = [one for one in laws if FRICTION in one and len({*one} & {*terms}) == 1] or laws
    sizes = _sizes(problem_of((FRICTION, *terms)))
    return LawComparison(*weighed(starts, laws, sizes, fitted, scored), left_out)


def _of_term(symbol: str, problem: HarmonicProblem, fit: WaveformFit) -> Sequence[Departure]:
    """Return what the coefficients of one more term would explain of the residual of a fit, to first order; nothing
    where the motion under it cannot be followed."""
    start = problem.like(fit)
    start = start if fit.parameters["m"].free else start.held("m")
    whole = problem.evaluate(start.values, start.free, Trail())
    if whole is None:
        return ()
    added = {one.key: whole[:, start.places[one.key]] for one in start if one.name == symbol}
    free = [one for one in start if one.free and one.name != symbol]
    free.sort(key=lambda one: one.name in ("Y", "psi"))
    known = whole[:, [start.places[one.key] for one in free]]
    return departures_from(whole[:, -1], known, added, [one.key for one in free], noise_known=True)


def _sizes(problem: HarmonicProblem) -> dict[str, float]:
    """Return the coefficient of each term that alone takes the work of a record, the median of the records."""
    dampers: Array = np.array(  # c = kY sin φ/(ωX), and F_k = πkY sin φ/4
        [
            problem.k * one.Y * abs(one.x[0].imag) / abs(one.x[0]) ** 2 / one.omega
            for one in problem.lines
        ]
    )
    speeds = np.array([one.omega * abs(one.x[0]) for one in problem.lines])
    of = {str(s): problem.equivalents(s) * dampers for s in problem.law.terms}
    of[FRICTION] = 0.25 * math.pi * dampers * speeds
    return {s: float(np.median(values)) for s, values in of.items()}


@one_thread
def compare_decay_laws(fit: DecayFit) -> LawComparison:
    """Weigh the laws of c and c_2 in addition to friction, or without it, on free decays.

    Use it where the damping is not known to be viscous.

    fit : of the oscillator with friction and viscous damping to all decays.
    """
    speed = fit.problem.speed(fit.point)
    orders = {s: KNOWN_TERMS[s].order for s in DECAY_TERMS}
    force = math.fsum(fit.value(s) * speed**n for s, n in orders.items())
    sizes = {s: force / speed**n for s, n in orders.items()}

    def fitted(kept: Terms, near: Any) -> DecayFit | None:
        if near is None:
            return fit
        return fit_law(fit, kept, [near.parameters, fit.parameters])

    def scored(kept: Terms, of: Any) -> dict[str, Sequence[Departure]]:
        return {one.symbol: [one] for one in departures_of(of) if one.symbol in DECAY_TERMS}

    own = in_order(s for s in DECAY_TERMS if s in fit.free)
    laws = laws_of([s for s in DECAY_TERMS if s != FRICTION])
    left_out = (Finding("damping alike in decays"),)
    return LawComparison(*weighed([own], laws, sizes, fitted, scored), left_out, decays=True)


def fit_law(fit: DecayFit, terms: Sequence[str], starts: Sequence[Any] = ()) -> DecayFit | None:
    """Return the oscillator with a law, no coefficient negative, to the decays of a fit; None where no climb leads to
    one.

    terms : of `DECAY_TERMS`.   starts : to climb from; default, that of the fit.
    """
    kept = {s for s in fit.free if s not in DECAY_TERMS and (s != "rho" or FRICTION in terms)}
    out = {one.key: 0.0 for one in fit.parameters if one.name in {*DECAY_TERMS} - {*terms}}
    points = (start.by_key | out for start in starts or (fit.parameters,))
    free = kept | {*map(str, terms)}
    ends = multistart(fit.problem, [fit.problem.parameters(one, free) for one in points])
    return ends[0] if ends else None
