"""Which damping law do the records support? Every law of a few terms is tested; the smallest not rejected is kept.

A law is tested in two ways, both with the onset of slip of the oscillator that has this law:

    balance      e = A p − W of the rows, p their generalised least squares; eᵀ C⁻¹ e, C the covariance of e by the
                 jackknife over the cycles of all records, all rows together: a common K_z moves them all
    waveforms    χ² of the harmonics of all records about the steady responses of the oscillator

each against the F distribution with its degrees of freedom. The p-value of a law is the smaller of the two, times two.
A law without friction is tested with a friction force too small to show. Laws are rejected by Holm's procedure, which
keeps the probability of rejecting any true law, superfluous terms or not, below `BUDGET`. The smallest law that is not
rejected is the answer; it has a superfluous term with a probability below `BUDGET`. Where the waveforms reject every
law, the balance decides, and of laws with the same loss those are kept that have the stiffness of the records.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy import special

from ..findings.finding import Finding
from ..fit.goodness import as_good, probability
from ..fit.steady_search import fit_quickly, refit
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..law.terms import FRICTION, KNOWN_TERMS, Term, in_order
from ..signals.mean_harmonics import Reading
from ..signals.one_thread import one_thread
from ..signals.thresholds import BUDGET
from .balance_rows import solved_forced
from .oscillator import CommonFit, with_common_fit

MOST_TERMS = 2
"""Most terms of a law that is tried, in addition to friction."""


@dataclass(frozen=True, slots=True)
class Probability:
    """A χ² with its degrees of freedom and its p-value, that of one as large in noise; NaN without freedom."""

    chi_square: float
    degrees_of_freedom: float
    p: float


@dataclass(frozen=True, eq=False)
class LawTest:
    """The tests of one law.

    terms : of the law.   coefficients : by key, (value, standard error), SI units.   tests : those that count, by name,
    "balance" and "waveforms"; None where there is no such motion.   rejected, rejected_by_balance : by all of these, by
    the balance alone.   explains : whether what it leaves is noise by the rules of the fit that is the answer.
    in_phase : squares of what the waveforms leave of each record's stiffness, in standard errors.
    """

    terms: tuple[str, ...]
    coefficients: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    tests: Mapping[str, Probability | None] = field(
        default_factory=lambda: {"balance": None, "waveforms": None}
    )
    rejected: bool = True
    rejected_by_balance: bool = True
    explains: bool = True
    in_phase: tuple[float, ...] = ()

    @property
    def balance(self) -> Probability | None:
        """The test by the balance; None where it has no degree of freedom left, or cannot be made."""
        test = self.tests.get("balance")
        return None if test is None or math.isnan(test.p) else test

    def p_of(self, *names: str) -> float:
        """Return the p-value of tests together, of all unless some are named: the smallest one, times their number; 0
        where one cannot be made."""
        tests = [self.tests.get(name) for name in names or self.tests]
        known = [t.p for t in tests if t is not None and not math.isnan(t.p)]
        return 0.0 if None in tests else min([1.0, *(len(known) * p for p in known)])


@dataclass(frozen=True, eq=False)
class LawComparison:
    """The tests of all laws, the smallest law first, and what follows from them.

    tests : of each law.
    chosen : terms of the smallest law that is not rejected; None where all are.
    by_balance : whether the waveforms reject every law, so that the balance alone decides.
    alike : other laws as small that are not rejected.   by_stiffness : those that the balance does not reject, and that
    do not have the stiffness of the records, while the chosen one has.
    left_out : findings on terms that these records cannot distinguish from others.
    """

    tests: tuple[LawTest, ...]
    chosen: tuple[str, ...] | None
    by_balance: bool
    alike: tuple[tuple[str, ...], ...]
    left_out: tuple[Finding, ...]
    by_stiffness: tuple[tuple[str, ...], ...] = ()

    @property
    def by(self) -> str:
        """The tests that decide: "balance and waveforms", or one of the two."""
        return "balance" if self.by_balance else " and ".join(self.names)

    @property
    def names(self) -> tuple[str, ...]:
        """The tests that any law was given."""
        return max((tuple(test.tests) for test in self.tests), key=len)

    @property
    def findings(self) -> list[Finding]:
        """What follows from the tests."""
        decays = "balance" not in self.names
        if self.chosen is None:
            return [*self.left_out, self._nothing_fits(decays)]
        law = {"law": self.chosen}
        found = [*self.left_out, Finding("law by the balance" if self.by_balance else "law", law)]
        if self.alike:
            found.append(Finding("laws alike", {"laws": self.alike, "decays": decays}))
        if self.by_stiffness:
            found.append(Finding("laws of the same loss", {"laws": self.by_stiffness}))
        return found

    def _nothing_fits(self, decays: bool) -> Finding:
        if decays:
            best = max(self.tests, key=LawTest.p_of)
            of = {"law": best.terms, "p": best.p_of(), "most": MOST_TERMS}
            return Finding("no law of decays", of)
        tested = [(test.p, e.terms, test) for e in self.tests if (test := e.balance) is not None]
        if not tested:
            return Finding("no law tested")
        _, terms, test = max(tested, key=lambda one: one[0])
        size = math.sqrt(test.chi_square / test.degrees_of_freedom)
        return Finding("no law", {"law": terms, "times": size, "most": MOST_TERMS})


_NO_FORCE = 1e-9  # of k times the smallest base motion: a friction force that stands for none
_SURE = 1e-9  # probability of a balance below which the waveforms are not asked
_APART = 4.0  # of squares of in-phase misfits in standard errors: less is noise
_ALIKE = 1.001  # of frequencies: closer ones count as one


def compared(
    terms: Sequence[str],
    test: Callable[[tuple[Term, ...], Any], tuple[LawTest, Any] | None],
    left_out: tuple[Finding, ...],
    *,
    given: Collection[str] = (),
) -> LawComparison:
    """Test every law of no, one or two terms in addition to friction, and of one or two without it, the smallest first.

    Once a law is not rejected, of the larger laws only those that contain it are tested: it may be the one, and only
    what more terms would add to it is of interest.

    terms : to choose from, besides friction.   test : of a law, with the best fit of the laws that it contains, or
    None: its tests and its fit, or None; None where the records cannot test it.   given : terms that all laws have.
    left_out : of the comparison.
    """
    laws = [
        in_order((*friction, *given, *some))
        for friction in ((FRICTION,), ())[: 1 if FRICTION in given else 2]
        for size in range(MOST_TERMS + 1)
        for some in itertools.combinations(terms, size)
        if friction or given or some
    ]
    tests: list[LawTest] = []
    fits: dict[tuple[Term, ...], Any] = {}
    for _, alike in itertools.groupby(sorted(laws, key=len), len):
        enough = [set(e.terms) for e in tests if e.explains and e.p_of() > BUDGET / len(laws)]
        for law in alike:
            if enough and not any(smaller < set(law) for smaller in enough):
                continue
            within = [fit for smaller, fit in fits.items() if set(smaller) < set(law)]
            near = min(within, key=lambda fit: float(fit.chi_square), default=None)
            tested = test(law, near)
            if tested is not None:
                tests.append(tested[0])
                if tested[1] is not None:
                    fits[law] = tested[1]
    return chosen_of(tests, left_out)


@one_thread
def compare_laws(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    mass: float | None = None,
) -> LawComparison:
    """Test the laws of up to two terms in addition to friction, or without it, on forced records, see `compared`.

    Use it where the damping is not known to be viscous: on records of several amplitudes, and of two frequencies or
    more to distinguish c from eta.

    readings, k, mass : as for `identify`.   law : its given coefficients are part of every law, and
    its groups apply to the terms that have some.
    """
    asked, lines = law or Law(), tuple(reading.lines for reading in readings)
    frequencies = [reading.steady.frequency_hz for reading in readings]
    left_out: tuple[Finding, ...] = ()
    every = in_order((*KNOWN_TERMS, *asked.terms))
    terms: list[str] = [s for s in every if s not in (FRICTION, *asked.given)]
    if max(frequencies) < _ALIKE * min(frequencies) and {"c", "eta"} <= {*terms}:
        terms.remove("eta")
        left_out = (Finding("eta like c"),)
    none = {FRICTION: _NO_FORCE * k * min(one.Y for one in lines)}

    def test(kept: tuple[Term, ...], near: WaveformFit | None) -> tuple[LawTest, Any] | None:
        rubs = FRICTION in kept
        given = asked.given if rubs else {**asked.given, **none}
        groups = {s: of for s, of in asked.groups.items() if s in kept}
        tried = Law(in_order((FRICTION, *kept)), given, groups)
        if len(tried.unknowns) > len(readings):
            return None
        # the onset of a slip that stands for none has errors beyond first order, and enters no row
        alone = LawTest(kept) if rubs else _by_balance(kept, tried, readings, CommonFit(None))
        if alone.balance is not None and alone.balance.p < _SURE:
            return alone, None  # where there is friction, the balance shows it at once
        fit = fit_quickly(HarmonicProblem(tried, lines, k), near)
        if fit is not None and mass is not None and fit.parameters["m"].free:
            fit = refit(fit, given={"m": mass}) or fit
        if fit is None:
            return LawTest(kept), None
        balance = _by_balance(kept, tried, readings, CommonFit.of(fit)) if rubs else alone
        p = probability(fit.chi_square, fit.freedom, fit.lines)
        waveforms = {"waveforms": Probability(fit.chi_square, fit.freedom, p)}
        in_phase = tuple(fit.in_phase.tolist())
        return replace(balance, tests={**balance.tests, **waveforms}, in_phase=in_phase), fit

    return compared(terms, test, left_out, given=asked.given)


def chosen_of(tests: Sequence[LawTest], left_out: tuple[Finding, ...] = ()) -> LawComparison:
    """Return what follows from the tests of laws: Holm's procedure, and the smallest law that it does not reject."""
    both, alone = (_rejected([e.p_of(*names) for e in tests]) for names in ((), ["balance"]))
    tests = [
        replace(e, rejected=one or not e.explains, rejected_by_balance=other)
        for e, one, other in zip(tests, both, alone, strict=True)
    ]
    with_balance = any("balance" in e.tests for e in tests)
    by_balance = with_balance and all(both)
    kept = [e for e in tests if not (e.rejected_by_balance if by_balance else e.rejected)]
    if with_balance:
        kept = [e for e in kept if e.balance is not None]
    smallest = [e for e in kept if len(e.terms) == min(len(k.terms) for k in kept)]
    smallest.sort(key=lambda e: -e.p_of(*["balance"] * by_balance))
    if by_balance:  # none has the waveforms: the stiffness is the second witness
        best = min(smallest, key=lambda e: float(np.mean(e.in_phase or math.inf)), default=None)
        smallest = [e for e in smallest if best is None or _as_stiff(e, best)]
    found = [e.terms for e in smallest]
    chosen, alike = (found[0], tuple(found[1:])) if found else (None, ())
    by_stiffness = tuple(
        e.terms
        for e in tests
        if e.balance is not None
        and not (e.rejected_by_balance or e in smallest)
        and len(e.terms) == len(chosen or ())
        and not _as_stiff(e, smallest[0])
    )
    by_balance = by_balance and bool(kept)
    return LawComparison(tuple(tests), chosen, by_balance, alike, left_out, by_stiffness)


def _as_stiff(test: LawTest, best: LawTest) -> bool:
    """Return whether a law has the stiffness of the records as well as another does, or none was fitted to tell."""
    a, b = np.array(test.in_phase), np.array(best.in_phase)
    return a.size != b.size or a.size < 2 or as_good(a, b) or float(np.mean(a - b)) < _APART


def _by_balance(
    terms: tuple[str, ...], law: Law, readings: Sequence[Reading], common: CommonFit
) -> LawTest:
    """Return the test of one law by the balance.

    terms : of it; `law` may have a friction force that stands for none.   common : with the oscillator that has it, or
    none, whose rows need no onset of slip.
    """
    readings = with_common_fit(readings, common, law)
    frictionless = common.fit is None
    _, of = solved_forced(
        *(readings, law, readings[0].steady.k), frictionless=frictionless, correlated=True
    )
    if not of.estimates:
        return LawTest(terms, {}, {"balance": None})
    # the covariance comes from as many degrees of freedom as there are cycles, less one
    cycles = min(len(reading.steady.weights) for reading in readings)
    p = float(special.fdtrc(of.freedom, cycles - 1, of.misfit)) if of.freedom else math.nan
    coefficients = {key: (one.value, one.standard_error) for key, one in of.estimates.items()}
    return LawTest(terms, coefficients, {"balance": Probability(of.chi_square, of.freedom, p)})


def _rejected(p: Sequence[float]) -> list[bool]:
    """Return Holm's procedure: the smallest p, the second … are rejected while below BUDGET/n, BUDGET/(n − 1) …"""
    order = sorted(range(len(p)), key=lambda i: p[i])
    rejected = [False] * len(p)
    for rank, i in enumerate(order):
        if p[i] > BUDGET / (len(p) - rank):
            break
        rejected[i] = True
    return rejected
