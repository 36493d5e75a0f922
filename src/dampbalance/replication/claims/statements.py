"""Statements of the paper, bounds and words, each judged by what is printed: another number or word, another verdict.

All are judged by one route, as published: they speak of what the authors computed. "Less than 1.5 %" holds where the
value is less, and the bound is the value rounded as it is printed, or one unit looser; any looser, it would say nothing
of the value. A word holds where the comparison that it names does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from ..claim_verdicts import ROUTE_NAMES
from .published import FILE, Row

ROUTE = "as_published"
"""The route that judges every statement."""

_BOUNDS = {"less than": +1.0, "more than": -1.0}
WORDS: dict[str, dict[str, Callable[[float, float], bool]]] = {
    "change": {
        "degraded": lambda one, other: one > other,
        "improved": lambda one, other: one < other,
    },
    "truth": {"true": lambda one, other: one < other, "false": lambda one, other: not one < other},
}
"""Rule → printed word → when it holds of two errors."""


class Judged(NamedTuple):
    """Whether a statement holds, and how that was judged, in a sentence."""

    holds: bool
    how: str


def bound(row: Row, value: float) -> Judged:
    """A bound on the value of ROUTE, "…: less than" or "…: more than" the printed number.

    Raises ValueError when the quantity, which says what is bounded, does not end with either.
    """
    word = next((word for word in _BOUNDS if row.quantity.endswith(word)), None)
    if word is None:
        raise ValueError(
            f"{FILE}: {row.id}: the quantity must end with {' or '.join(map(repr, _BOUNDS))}, "
            f"which says how {row.printed} bounds it"
        )
    limit, side = row.number, _BOUNDS[word]
    value, units = side * value / limit.unit, side * limit.value / limit.unit
    tight = value < units <= value + 1.5  # rounded, at most half a unit above it, or one more
    return _judged(
        tight, f'"{word}": the bound is the value rounded as it is printed, or one unit looser'
    )


def word(row: Row, one: float, other: float) -> Judged:
    """A word for how two errors of ROUTE compare: one off and one near resonance, or one of direct integration and the
    least of all other approaches.

    Raises ValueError for a word that the rule of the row does not know.
    """
    words = WORDS[row.rule]
    if row.printed not in words:
        raise ValueError(
            f"{FILE}: {row.id}: cannot judge the word {row.printed!r}; known are {', '.join(words)}"
        )
    what = ": the error against that near resonance" if row.rule == "change" else ""
    return _judged(words[row.printed](one, other), f'"{row.printed}"{what}')


def _judged(holds: bool, rule: str) -> Judged:
    outcome = "holds" if holds else "does not hold"
    return Judged(holds, f"Judged {ROUTE_NAMES[ROUTE]}, by {rule}. It {outcome}.")
