"""Which damping law do the records support? All laws of a few terms, weighed by their evidence.

A law has friction or not, and up to `MOST_TERMS` further terms. Its coefficients p are not negative, with prior sizes τ
from `PRIORS["law"]` in units of the coefficient that would take all of the work by itself. With the fit p̂, its
covariance C and χ², both scaled by the residual of the best law, and T = diag τ²,

    ln E = −½ χ² + ½ ln |C|/|C + T| − ½ p̂ᵀ (C + T)⁻¹ p̂ + Σ ln 2Φ(μ_j/σ_j)

is the logarithm of its evidence (`fit.select.evidence_of`), and its weight is in proportion to E Π π/(1 − π), with one
factor for each term and π the share of rigs that have it.

Few laws need a fit. To first order, a fit also gives the evidence of the laws with one term more (score test), one
fewer (Wald test), and one in place of another. The heaviest law without a fit is fitted until each of these weighs
less than `REFITTED`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..findings.finding import Finding
from ..fit.decay import DecayFit
from ..fit.decay_departures import departures_of
from ..fit.multistart import Trail, multistart
from ..fit.score import Departure, departures_from
from ..fit.search import sound
from ..fit.select import NOISE_ALONE, PRIORS, REFITTED, bayes_factor, evidence_of, noise_of
from ..fit.steady_search import fit_quickly, refit
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..law.terms import FRICTION, KNOWN_TERMS, Term, in_order, term
from ..signals.mean_harmonics import Reading
from ..signals.one_thread import one_thread

MOST_TERMS = 2
"""Most terms of a law in addition to friction."""

DECAY_TERMS = (FRICTION, "c", "c_2")
"""Terms that free decays distinguish: with the base at rest and one frequency, c_r and eta act as c does."""

_PRIOR = PRIORS["law"]
_ODDS = math.log(_PRIOR.share / (1.0 - _PRIOR.share))

Terms = tuple[Term, ...]
Tests = Mapping[str, Sequence[Departure]]


@dataclass(frozen=True, eq=False)
class LawWeight:
    """A law with its weight.

    fit : None where its evidence is known to first order only.   noise : square of the scale of the noise.
    """

    terms: Terms
    weight: float
    fit: Any
    noise: float

    @property
    def coefficients(self) -> dict[str, tuple[float, float]]:
        """Value and standard error of each coefficient, by its key, SI units; empty to first order."""
        keys = [] if self.fit is None else _keys(self.terms, self.fit)
        scale = math.sqrt(self.noise)
        return {key: (self.fit.value(key), scale * self.fit.error(key)) for key in keys}


@dataclass(frozen=True, eq=False)
class LawComparison:
    """The weights of all laws.

    laws : the heaviest first.   noise : square of the scale of the residual of the best law.   left_out : findings on
    terms that these records cannot distinguish from others.   decays : whether the records are free decays.
    """

    laws: tuple[LawWeight, ...]
    noise: float
    left_out: tuple[Finding, ...]
    decays: bool = False

    @property
    def fits(self) -> bool:
        """Whether the heaviest law fits: its residual is less than twice the noise of the records or, for decays, no
        further coefficient explains any of it."""
        fit = self.laws[0].fit
        if not self.decays:
            return self.noise < 4.0
        return sound(fit) and all(one.p > NOISE_ALONE for one in departures_of(fit))

    @property
    def chosen(self) -> Terms | None:
        """The heaviest law; None where it does not fit."""
        return self.laws[0].terms if self.laws and self.fits else None

    @property
    def alike(self) -> tuple[Terms, ...]:
        """The other laws that weigh more than `REFITTED`."""
        return tuple(one.terms for one in self.laws[1:] if one.weight > REFITTED)

    @property
    def findings(self) -> list[Finding]:
        """Which laws the records support, and which terms were left out."""
        if not self.laws:
            return [*self.left_out, Finding("no law tested")]
        of = {"law": self.laws[0].terms, "weight": self.laws[0].weight, "laws": self.alike}
        of |= {"times": math.sqrt(self.noise), "most": MOST_TERMS, "decays": self.decays}
        codes = (["law"] + ["laws alike"] * bool(self.alike)) if self.fits else ["no law"]
        return [*self.left_out, *(Finding(code, of) for code in codes)]


def weighed(
    laws: Sequence[Terms],
    first: tuple[Terms, Any],
    sizes: Mapping[str, float],
    fitted: Callable[[Terms, Any], Any],
    scored: Callable[[Terms, Any], Tests],
) -> tuple[tuple[LawWeight, ...], float]:
    """Return laws with their weights, the heaviest first, and the square of the scale of the noise.

    first : a law with its fit.   sizes : for each term, the coefficient that alone takes all of the work.
    fitted : returns the fit of a law, started at the closest so far; None without one.   scored : returns, for each
    term that a law lacks, the score tests of its coefficients.
    """
    fits, tests, failed = dict([first]), dict[Terms, Tests](), set[Terms]()

    def weights_in(noise: float) -> dict[Terms, float]:
        own = {law: _evidence(law, fit, sizes, noise) for law, fit in fits.items()}
        logs = dict[Terms, float]()
        for law in sorted(
            fits, key=own.__getitem__
        ):  # neighbours of the best overwrite those of others
            nearby = _neighbours(law, fits[law], tests[law], sizes, noise)
            logs |= {other: own[law] + by for other, by in nearby}
        logs = {law: value for law, value in (logs | own).items() if law in {*laws} - failed}
        powers = np.exp(np.array([*logs.values()]) - max(logs.values()))
        return dict(zip(logs, (powers / powers.sum()).tolist(), strict=True))

    while True:
        tests |= {law: scored(law, fit) for law, fit in fits.items() if law not in tests}
        noise = min(noise_of(fit.chi_square, fit.freedom) for fit in fits.values())
        # the residual of a law far from the records is no noise: the best law is sought without scaling first
        for weights in map(weights_in, (1.0, noise)):
            asked = [law for law in weights if law not in fits and weights[law] > REFITTED]
            if asked:
                break
        else:
            break
        law = max(asked, key=weights.__getitem__)
        fit = fitted(law, min(fits.values(), key=lambda one: one.chi_square))
        fits |= {} if fit is None else {law: fit}
        failed |= {law} if fit is None else set()
    found = [LawWeight(law, weights.get(law, 0.0), fits.get(law), noise) for law in laws]
    return tuple(sorted(found, key=lambda one: -one.weight)), noise


def _keys(law: Iterable[str], fit: Any) -> list[str]:
    """Return the keys of the free coefficients of some terms."""
    return [one.key for one in fit.parameters if one.free and one.name in {*map(str, law)}]


def _evidence(law: Terms, fit: Any, sizes: Mapping[str, float], noise: float) -> float:
    """Return ln of evidence times prior of a fitted law."""
    keys = _keys(law, fit)
    values = np.array([fit.value(key) for key in keys])
    tau = [_PRIOR.size * sizes[term(key).symbol] for key in keys]
    covariance = noise * fit.covariance_of(*keys)
    fall = -fit.chi_square / noise
    return evidence_of(fall, values, covariance, tau, positive=True) + _ODDS * len(law)


def _neighbours(
    law: Terms, fit: Any, tests: Tests, sizes: Mapping[str, float], noise: float
) -> Iterator[tuple[Terms, float]]:
    """Yield the laws with a term more, one fewer, or one in place of another, and to first order by how much their ln
    of evidence times prior is larger."""

    def gained(symbol: str, value: float, square: float) -> float:
        prior = _PRIOR._replace(size=_PRIOR.size * sizes[symbol])
        return bayes_factor(value, math.sqrt(noise * square), prior)[0] if square else 0.0

    def lost(symbol: str, added: Sequence[Departure] = ()) -> float:
        total, of = _ODDS, np.array([(one.value, one.error) for one in added]).reshape(-1, 2)
        for key in _keys([symbol], fit):
            by = np.array([one.slopes.get(key, 0.0) for one in added])[:, None] * of
            square = fit.error(key) ** 2 + float(np.sum(by[:, 1] ** 2))
            total += gained(symbol, fit.value(key) + float(np.sum(by[:, 0])), square)
        return total

    if FRICTION not in law:  # friction has no score test: it has to be fitted
        yield in_order((FRICTION, *law)), 0.0
    yield from ((in_order({*law} - {symbol}), -lost(symbol)) for symbol in law)
    for more, added in tests.items():
        by = _ODDS + math.fsum(gained(more, one.value, one.error**2) for one in added)
        yield in_order((*law, more)), by
        for symbol in law:
            yield in_order({*law, more} - {symbol}), by - lost(symbol, added)


def _laws(terms: Sequence[str], given: Iterable[str] = ()) -> list[Terms]:
    """Return the laws of up to `MOST_TERMS` terms in addition to given ones, with friction and without, the smallest
    first."""
    sizes = range(MOST_TERMS + 1)
    some = [one for size in sizes for one in itertools.combinations(terms, size)]
    laws = {in_order((*of, *given, *one)) for of in ((FRICTION,), ()) for one in some}
    return sorted(filter(None, laws), key=lambda law: (len(law), law))


def _sizes(force: float, speed: float, k: float, omega: float) -> dict[str, float]:
    """Return, for each term, the coefficient whose force at a speed is the given one."""
    others = {s: of.force for s, of in KNOWN_TERMS.items() if of.force is not None}
    return {FRICTION: force} | {s: force / of(speed, 0.0, k, omega) for s, of in others.items()}


@one_thread
def compare_laws(
    readings: Sequence[Reading], k: float, *, law: Law | None = None, mass: float | None = None
) -> LawComparison:
    """Weigh the laws of up to two terms in addition to friction, or without it, on forced records.

    Use it where the damping may not be viscous: on records of several amplitudes, and at two frequencies or more to
    distinguish c from eta.

    readings, k, mass : as for `identify_readings`.   law : its given coefficients are part of every law, and its groups
    apply to the terms that have groups.
    """
    asked, lines = law or Law(), tuple(reading.lines for reading in readings)
    frequencies = [reading.steady.frequency_hz for reading in readings]
    # at one frequency, to a part in a thousand, eta acts as c does
    alone = max(frequencies) < 1.001 * min(frequencies) and "c" not in asked.given
    terms = [
        s for s in KNOWN_TERMS if s not in (FRICTION, *asked.given, *(("eta",) if alone else ()))
    ]

    def problem_of(kept: Iterable[str]) -> HarmonicProblem:
        # 1e-9 of k times the smallest base motion stands for no friction
        none = {} if FRICTION in kept else {FRICTION: 1e-9 * k * min(one.Y for one in lines)}
        groups = {s: of for s, of in asked.groups.items() if s in kept}
        own = Law(in_order((FRICTION, *kept)), {**asked.given, **none}, groups)
        return HarmonicProblem(own, lines, k)

    def fitted(kept: Terms, near: WaveformFit | None) -> WaveformFit | None:
        fit = fit_quickly(problem_of(kept), near)
        if fit is not None and mass is not None and fit.parameters["m"].free:
            fit = refit(fit, given={"m": mass}) or fit
        return fit

    def scored(kept: Terms, fit: WaveformFit) -> Tests:
        tests = {s: _of_term(s, problem_of((*kept, s)), fit) for s in terms if s not in kept}
        return {s: of for s, of in tests.items() if of}

    laws = _laws(terms, asked.given)
    laws = [one for one in laws if 0 < len(problem_of(one).law.unknowns) <= len(readings)]
    # friction and one other term are closer to most rigs than friction alone
    begun = ((one, fitted(one, None)) for one in sorted(laws, key=lambda one: abs(len(one) - 2)))
    first = next((of for of in begun if of[1] is not None), None)
    left_out = (Finding("eta like c"),) if alone else ()
    if first is None:
        return LawComparison((), 1.0, left_out)
    fast = max(lines, key=lambda one: one.omega * abs(one.x[0]))
    force, speed = k * fast.Y * abs(fast.x[0].imag / fast.x[0]), fast.omega * abs(fast.x[0])
    sizes = _sizes(force, speed, k, fast.omega)
    return LawComparison(*weighed(laws, first, sizes, fitted, scored), left_out)


def _of_term(symbol: str, problem: HarmonicProblem, fit: WaveformFit) -> list[Departure]:
    """Return the score tests of the coefficients of one more term; none where the motion under it cannot be
    followed."""
    start = problem.like(fit)
    start = start if fit.parameters["m"].free else start.held("m")
    whole = problem.evaluate(start.values, start.free, Trail())
    if whole is None:
        return []
    free = sorted((one for one in start if one.free), key=lambda one: one.name in ("Y", "psi"))
    columns = {one.key: whole[:, start.places[one.key]] for one in free}
    added = {one.key: columns.pop(one.key) for one in free if one.name == symbol}
    known = np.column_stack([*columns.values()])
    return departures_from(whole[:, -1], known, added, [*columns], noise_known=True)


@one_thread
def compare_decay_laws(fit: DecayFit) -> LawComparison:
    """Weigh the laws of c and c_2 in addition to friction, or without it, on free decays.

    Use it where the damping may not be viscous.

    fit : of the oscillator with friction and viscous damping to all decays.
    """
    speed = fit.problem.speed(fit.point)
    units = _sizes(1.0, speed, fit.k, 1.0)
    force = math.fsum(fit.value(s) / units[s] for s in DECAY_TERMS)
    sizes = {s: force * unit for s, unit in units.items()}

    def fitted(kept: Terms, near: DecayFit) -> DecayFit | None:
        others = {s for s in fit.free if s not in DECAY_TERMS and (s != "rho" or FRICTION in kept)}
        out = {one.key: 0.0 for one in fit.parameters if one.name in {*DECAY_TERMS} - {*kept}}
        points = (start.by_key | out for start in (near.parameters, fit.parameters))
        free = others | {*map(str, kept)}
        ends = multistart(fit.problem, [fit.problem.parameters(one, free) for one in points])
        return ends[0] if ends else None

    def scored(kept: Terms, of: DecayFit) -> Tests:
        return {one.symbol: [one] for one in departures_of(of) if one.symbol in DECAY_TERMS}

    first = in_order(s for s in DECAY_TERMS if s in fit.free), fit
    laws = weighed(_laws(DECAY_TERMS[1:]), first, sizes, fitted, scored)
    return LawComparison(*laws, (Finding("damping alike in decays"),), decays=True)
