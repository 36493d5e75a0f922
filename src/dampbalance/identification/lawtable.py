"""Which laws the records support, in words and numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..law.terms import named_with_unit
from .evidence import ALPHA, Comparison, Evidence, Probability
from .result import unit_of


def laws_document(laws: Comparison) -> dict[str, Any]:
    """The comparison of laws, for JSON."""
    return {
        "chosen": None if laws.chosen is None else list(laws.chosen),
        "by": "balance" if laws.by_balance else "balance and waveforms",
        "not_told_apart": [list(terms) for terms in laws.alike],
        "chance_to_reject_a_true_law": ALPHA,
        "words": laws.words(),
        "tested": [_evidence(evidence) for evidence in laws.evidence],
    }


def laws_in_lines(laws: Comparison) -> list[str]:
    """The comparison of laws for a screen: what it says, then a table of the laws with their evidence."""
    table = [["law", "balance", "waveforms", "", "coefficients"]]
    for e in laws.evidence:
        word = "rejected" if e.rejected else "possible"
        if laws.chosen == e.terms:
            word = "chosen"
        elif laws.by_balance:
            word = "rejected" if e.rejected_by_balance else "possible"
        values = ", ".join(
            f"{key} = {value:.5g} ± {error:.2g}" for key, (value, error) in e.coefficients.items()
        )
        shown = [_in_words(e.balance), _in_words(e.waveforms)]
        table.append([", ".join(e.terms), *shown, word, "" if word == "rejected" else values])
    sentences = [f"{words[0].upper()}{words[1:]}." for words in laws.words()]
    return [
        *sentences,
        "Probability in noise of what each law leaves, of the balance and of the waveforms:",
        "",
        *aligned(table),
    ]


def aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table with columns of equal width."""
    widths = [max(len(line[i]) for line in table) for i in range(len(table[0]))]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in table
    ]


def _in_words(test: Probability | None) -> str:
    if test is None:
        return "no such motion"
    if math.isnan(test.p):
        return "no more rows"
    return "< 1e-6" if test.p < 1e-6 else f"{test.p:.2g}"


def _evidence(e: Evidence) -> dict[str, Any]:
    coefficients: dict[str, float] = {}
    for key, (value, error) in e.coefficients.items():
        coefficients[named_with_unit(key, unit_of(key))] = value
        coefficients[named_with_unit(f"{key}_standard_error", unit_of(key))] = error
    return {
        "terms": list(e.terms),
        **coefficients,
        "balance": _test(e.balance),
        "waveforms": _test(e.waveforms),
        "rejected": e.rejected,
        "rejected_by_balance": e.rejected_by_balance,
    }


def _test(test: Probability | None) -> dict[str, Any] | None:
    if test is None:
        return None
    p = None if math.isnan(test.p) else test.p
    return {"chi_square": test.chi_square, "degrees_of_freedom": test.freedom, "p": p}
