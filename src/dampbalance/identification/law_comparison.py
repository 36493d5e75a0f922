"""Which damping law do the records support? Every law of a few terms is tested; the smallest not rejected is kept.

A law is tested in two ways, both with the onset of slip of the oscillator that has this law:

    balance      e = A p − W of the rows, p their generalised least squares; eᵀ C⁻¹ e, C the covariance of e over the
                 replicates of the records, all rows together: a common K_z moves them all
    waveforms    χ² of the harmonics of all records about the steady responses of the oscillator

each against the F distribution with its degrees of freedom. The p-value of a law is the smaller of the two, times two.
Laws are rejected by Holm's procedure, which keeps the probability of rejecting any true law, superfluous terms or not,
below `ALPHA`. The smallest law that is not rejected is the answer; it has a superfluous term with a probability below
`ALPHA`. Where the waveforms reject every law, the balance alone decides.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from ..balance import APPROACHES, Rows
from ..law.law import Law
from ..law.terms import FRICTION, KNOWN_TERMS, term
from ..project.wording import listed
from ..reading.fitting import fit_quickly, with_mass
from ..reading.lines import probability
from ..reading.mean_harmonics import Means, Reading
from ..reading.one_thread import one_thread
from ..reading.recorded import settled
from ..reading.waveforms import WaveformFit
from ..solver import solve
from .answer import column
from .law_rows import LawRows
from .microstick import sample_of
from .oscillator import JointFit, joined
from .remarks import DIRECT

ALPHA = 0.05
"""Probability of rejecting any true law."""

MOST_TERMS = 2
"""Most terms of a law that is tried, in addition to friction."""


@dataclass(frozen=True, slots=True)
class Probability:
    """A χ² with its degrees of freedom and its p-value, that of one as large in noise; NaN without freedom."""

    chi_square: float
    degrees_of_freedom: int
    p: float


@dataclass(frozen=True, eq=False)
class LawTest:
    """The tests of one law.

    fit : the oscillator with this law; None where there is none.   coefficients : by key, (value, standard error), SI
    units, of the balance.   balance : its test.   rejected, rejected_by_balance : by both tests, by the balance alone.
    """

    law: Law
    fit: WaveformFit | None
    coefficients: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    balance: Probability | None = None
    rejected: bool = True
    rejected_by_balance: bool = True

    @property
    def terms(self) -> tuple[str, ...]:
        """Its terms."""
        return self.law.terms

    @property
    def waveforms(self) -> Probability | None:
        """The test of the waveforms."""
        if self.fit is None:
            return None
        chi_square, freedom = self.fit.chi_square, self.fit.freedom
        return Probability(chi_square, freedom, probability(chi_square, freedom, self.fit.lines))

    @property
    def p(self) -> float:
        """The p-value of both tests together: the smaller one, times two."""
        if self.balance is None or self.waveforms is None:
            return 0.0
        both = [t.p for t in (self.balance, self.waveforms) if not math.isnan(t.p)]
        return min(1.0, len(both) * min(both)) if both else 1.0

    @property
    def p_of_balance(self) -> float:
        """The p-value of the balance alone."""
        if self.balance is None:
            return 0.0
        return 1.0 if math.isnan(self.balance.p) else self.balance.p

    def document(self) -> dict[str, Any]:
        """The tests for JSON."""
        return {
            "terms": self.terms,
            **{
                column(key, what): number
                for key, numbers in self.coefficients.items()
                for what, number in zip(("", "_standard_error"), numbers, strict=True)
            },
            "balance": self.balance and asdict(self.balance),
            "waveforms": self.waveforms and asdict(self.waveforms),
            "rejected": self.rejected,
            "rejected_by_balance": self.rejected_by_balance,
        }


@dataclass(frozen=True, eq=False)
class LawComparison:
    """The tests of all laws, the smallest law first, and what follows from them.

    tests : of each law.
    chosen : terms of the smallest law that is not rejected; None where all are.
    by_balance : whether the waveforms reject every law, so that the balance alone decides.
    alike : other laws as small that are not rejected.
    left_out : terms that these records cannot distinguish from others, and why.
    """

    tests: tuple[LawTest, ...]
    chosen: tuple[str, ...] | None
    by_balance: bool
    alike: tuple[tuple[str, ...], ...]
    left_out: str

    def words(self) -> list[str]:
        """What follows from the tests, in sentences."""
        sentences = [self.left_out] if self.left_out else []
        if self.chosen is None:
            return [*sentences, self._nothing_fits()]
        law = _words(self.chosen)
        if self.by_balance:
            sentences.append(
                f"the records support {law}, by the balance alone: their waveforms are those of no oscillator with "
                "such a law and one friction contact; the contact may yield gradually, or a channel be filtered"
            )
        else:
            sentences.append(f"the records support {law}: the smallest law that they do not reject")
        if self.alike:
            others = " or ".join(_words(terms) for terms in self.alike)
            sentences.append(
                f"they do not distinguish it from {others}: add records at other amplitudes or another frequency"
            )
        return sentences

    def _nothing_fits(self) -> str:
        tested = [e for e in self.tests if e.balance is not None and not math.isnan(e.balance.p)]
        if not tested:
            return "no law can be tested: there are no more records than coefficients; add records at other amplitudes"
        best = max(tested, key=lambda e: e.p_of_balance)
        assert best.balance is not None
        times = math.sqrt(best.balance.chi_square / best.balance.degrees_of_freedom)
        return (
            f"no law of {MOST_TERMS} terms or fewer in addition to friction fits: the rows lie {times:.2g} times as far"
            f" from the balance of the nearest, {_words(best.terms)}, as noise explains; the levels may differ in more "
            "than their amplitude (a coefficient for each group of records may help), a gain may be wrong, or another "
            "term is missing"
        )

    def document(self) -> dict[str, Any]:
        """The comparison for JSON."""
        return {
            "chosen": self.chosen,
            "by": "balance" if self.by_balance else "balance and waveforms",
            "not_told_apart": self.alike,
            "chance_to_reject_a_true_law": ALPHA,
            "words": self.words(),
            "tested": [test.document() for test in self.tests],
        }


def _words(terms: Sequence[str]) -> str:
    """Friction with viscous damping: F_k, c"""
    words = listed([term(symbol).words for symbol in terms])
    return f"{words} ({', '.join(terms)})"


_REPEATS = 4  # of generalised least squares, since its covariance depends on the solution
_ALIKE = 1.001  # of frequencies: closer ones count as one


@one_thread
def compare_laws(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    mass: float | None = None,
    replicates: int = 1000,
    seed: int = 2010,
) -> LawComparison:
    """Test every law of no, one or two terms in addition to friction.

    Once a law is not rejected, of the larger laws only those that contain it are tested. Use it where the damping is
    not known to be viscous: on records of several amplitudes, and of two frequencies or more to distinguish c from eta.

    readings, k, mass, replicates, seed : as for `identify`.   law : its given coefficients are part of every law, and
    its groups apply to the terms that have some.
    """
    if replicates <= len(readings):
        raise ValueError(
            "laws are compared by the covariance of all rows, which takes more replicates than records: "
            f"ask for more than {len(readings)} replicates, got {replicates}"
        )
    asked = law or Law()
    frequencies = [reading.steady.frequency_hz for reading in readings]
    left_out = ""
    terms = [s for s in KNOWN_TERMS if s != FRICTION and s not in asked.given]
    if max(frequencies) < _ALIKE * min(frequencies) and {"c", "eta"} & set(terms) == {"c", "eta"}:
        terms.remove("eta")
        left_out = "at one frequency structural damping eta acts as viscous damping c does, and is not tried"
    random = np.random.default_rng(seed)
    means = [reading.resampled(replicates, random) for reading in readings]
    lines = [reading.lines for reading in readings]
    tests: list[LawTest] = []
    count = sum(math.comb(len(terms), size) for size in range(MOST_TERMS + 1))
    for size in range(MOST_TERMS + 1):
        enough = [set(e.terms) for e in tests if e.p > ALPHA / count]
        for some in itertools.combinations(terms, size):
            if enough and not any(smaller < {FRICTION, *asked.given, *some} for smaller in enough):
                continue  # a smaller law may be the one: only what more terms would add to it is of interest
            tried = Law(
                (FRICTION, *asked.given, *some),
                asked.given,
                {s: of for s, of in asked.groups.items() if s in (FRICTION, *some)},
            )
            if len(tried.unknowns) > len(readings):
                continue
            within = [e.fit for e in tests if e.fit and set(e.terms) < set(tried.terms)]
            near = sorted(within, key=lambda fit: fit.chi_square)[:1]
            fit = fit_quickly(near[0].lines if near else lines, k, tried, near)
            fit = fit and settled(fit, lines)
            if mass is not None and fit is not None:
                fit = with_mass(fit, mass) or fit
            tests.append(_tested(tried, readings, means, fit))
    both, alone = _rejected([e.p for e in tests]), _rejected([e.p_of_balance for e in tests])
    tests = [
        replace(e, rejected=one, rejected_by_balance=other)
        for e, one, other in zip(tests, both, alone, strict=True)
    ]
    by_balance = all(e.rejected for e in tests)
    kept = [e for e in tests if not (e.rejected_by_balance if by_balance else e.rejected)]
    kept = [e for e in kept if e.balance is not None and not math.isnan(e.balance.p)]
    smallest = [e for e in kept if len(e.terms) == min(len(k.terms) for k in kept)]
    smallest.sort(key=lambda e: -(e.p_of_balance if by_balance else e.p))
    chosen = smallest[0].terms if smallest else None
    alike = tuple(e.terms for e in smallest[1:])
    return LawComparison(tuple(tests), chosen, by_balance and bool(kept), alike, left_out)


def _tested(
    law: Law, readings: Sequence[Reading], means: Sequence[Means], fit: WaveformFit | None
) -> LawTest:
    """The tests of one law.   fit : the oscillator that has it."""
    if fit is None:
        return LawTest(law, None)
    mine = joined(readings, JointFit(fit, False, None), law)
    rows_of = LawRows(APPROACHES[DIRECT], law, fit.k, "reversal", linear=False)
    rows = rows_of(sample_of(mine, [reading.mean for reading in mine]).features)[:, 0]
    drawn = rows_of(sample_of(mine, means).features)
    cycles = min(len(reading.steady.weights) for reading in readings)
    balance, coefficients = _generalised(rows, drawn, cycles)
    return LawTest(law, fit, coefficients, balance)


def _generalised(
    rows: Rows, drawn: Rows, cycles: int
) -> tuple[Probability | None, dict[str, tuple[float, float]]]:
    """Test of the rows by generalised least squares, and the coefficients.   drawn : replicates of the rows, (L, r)."""
    from scipy import special  # slow to import

    used = rows.usable
    rows, drawn = rows[used], drawn[used]
    symbols = [key for key in rows.terms if key not in rows.given]
    freedom = int(used.sum()) - len(symbols)
    estimate = solve(replace(rows, covariance=drawn.scatter()))
    values = {symbol: float(estimate[symbol]) for symbol in symbols}
    if freedom < 0 or not all(map(math.isfinite, values.values())):
        return None, {}
    A = np.column_stack([rows.terms[symbol] for symbol in symbols])
    right = rows.W - sum(p * rows.terms[key] for key, p in rows.given.items())
    for _ in range(_REPEATS):
        misfits = drawn.misfit({**rows.given, **values})
        factor = np.linalg.cholesky(np.atleast_2d(np.cov(misfits)))
        white, aim = np.linalg.solve(factor, A), np.linalg.solve(factor, right)
        size = np.linalg.norm(white, axis=0)
        solution = np.linalg.lstsq(white / size, aim)[0] / size
        values = dict(zip(symbols, solution.tolist(), strict=True))
    chi_square = float(np.sum((white @ solution - aim) ** 2))
    inverse = np.linalg.pinv(white / size) / size[:, None]
    errors = np.sqrt(np.sum(inverse**2, axis=1)).tolist()
    # the covariance comes from as many degrees of freedom as there are cycles, less one
    p = float(special.fdtrc(freedom, cycles - 1, chi_square / freedom)) if freedom else math.nan
    coefficients = {s: (values[s], error) for s, error in zip(symbols, errors, strict=True)}
    return Probability(chi_square, freedom, p), coefficients


def _rejected(p: Sequence[float]) -> list[bool]:
    """Holm's procedure: the smallest p, the second … are rejected while below ALPHA/n, ALPHA/(n − 1) …"""
    order = sorted(range(len(p)), key=lambda i: p[i])
    rejected = [False] * len(p)
    for rank, i in enumerate(order):
        if p[i] > ALPHA / (len(p) - rank):
            break
        rejected[i] = True
    return rejected
