"""What the records say of the laws that they may have: the evidence for each, and what follows from it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..law.law import Law
from ..law.terms import term
from ..project.wording import listed

ALPHA = 0.05
"""Chance to reject any law that is true."""

MOST_TERMS = 2
"""Of a law that is tried, beside friction."""


@dataclass(frozen=True, slots=True)
class Probability:
    """χ² with its degrees of freedom, and the probability of one as large in noise; NaN without freedom."""

    chi_square: float
    freedom: int
    p: float


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the records say of one law.

    coefficients : by key, (value, standard error), SI, of the balance.   balance, waveforms : its two tests; None where
    no oscillator with this law was found.   rejected : by both together, by the balance alone.
    """

    law: Law
    coefficients: Mapping[str, tuple[float, float]]
    balance: Probability | None
    waveforms: Probability | None
    rejected: bool = True
    rejected_by_balance: bool = True

    @property
    def terms(self) -> tuple[str, ...]:
        """Its terms."""
        return self.law.terms

    @property
    def p(self) -> float:
        """Probability of the less probable of the two tests, times two."""
        if self.balance is None or self.waveforms is None:
            return 0.0
        known = [t.p for t in (self.balance, self.waveforms) if not math.isnan(t.p)]
        return min(1.0, len(known) * min(known)) if known else 1.0

    @property
    def p_of_balance(self) -> float:
        """Probability of its balance alone."""
        if self.balance is None:
            return 0.0
        return 1.0 if math.isnan(self.balance.p) else self.balance.p


@dataclass(frozen=True, eq=False)
class Comparison:
    """Evidence for each law, the smallest first, and what follows from it.

    chosen : terms of the smallest law that is not rejected, None where all are.   by_balance : whether the waveforms
    reject every law, so that the balance alone decides.   alike : other laws as small that are not rejected.
    left_out : terms that these records cannot tell from others, and why.
    """

    evidence: tuple[Evidence, ...]
    chosen: tuple[str, ...] | None
    by_balance: bool
    alike: tuple[tuple[str, ...], ...]
    left_out: str

    def words(self) -> list[str]:
        """What the records say, in sentences."""
        said = [self.left_out] if self.left_out else []
        if self.chosen is None:
            return [*said, *self._nothing_fits()]
        named = _words(self.chosen)
        if self.by_balance:
            said.append(
                f"the records support {named}, by the balance alone: their waveforms are those of no oscillator with "
                "such a law and one friction contact; the contact may yield gradually, or a channel be filtered"
            )
        else:
            said.append(f"the records support {named}: the smallest law that they do not reject")
        if self.alike:
            others = " or ".join(_words(terms) for terms in self.alike)
            said.append(
                f"they do not tell it from {others}: add records at other amplitudes or another frequency"
            )
        return said

    def _nothing_fits(self) -> list[str]:
        tested = [e for e in self.evidence if e.balance is not None and not math.isnan(e.balance.p)]
        if not tested:
            return [
                "no law can be tested: there are no more records than coefficients; add records at other amplitudes"
            ]
        best = max(tested, key=lambda e: e.p_of_balance)
        assert best.balance is not None
        times = math.sqrt(best.balance.chi_square / best.balance.freedom)
        return [
            f"no law of {MOST_TERMS} terms or fewer beside friction fits: the rows lie {times:.2g} times as far from "
            f"the balance of the nearest, {_words(best.terms)}, as noise explains; the levels may differ in more than "
            "their amplitude (a coefficient for each group of records may help), a gain may be wrong, or another term "
            "is missing"
        ]


def _words(terms: Sequence[str]) -> str:
    """Friction with viscous damping: F_k, c"""
    words = listed([term(symbol).words for symbol in terms])
    return f"{words} ({', '.join(terms)})"
