"""Statements of the paper, bounds and words, each judged by what is printed: another number or word, another verdict.

All are judged by one route, as published: they speak of what the authors computed. "Less than 1.5 %" holds where the
value is less, and the bound is the value rounded as it is printed, or one unit looser; any looser, it would say nothing
of the value. A word holds where the comparison that it names does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ..claim_verdicts import ROUTE_NAMES
from ..printed import Printed
from .published import FILE

ROUTE = "as_published"
"""The route that judges every statement."""

_BOUNDS = {"less than": +1.0, "more than": -1.0}
_CHANGES: dict[str, Callable[[float, float], bool]] = {
    "degraded": lambda error, near: error > near,
    "improved": lambda error, near: error < near,
}
_TRUTHS = {"true": True, "false": False}


class Judged(NamedTuple):
    """Whether a statement holds, and how that was judged, in a sentence."""

    holds: bool
    how: str


def bound(name: str, quantity: str, printed: str, values: Mapping[str, float]) -> Judged:
    """A bound, "…: less than" or "…: more than" a number.

    name : of the statement, for errors.   quantity : what the paper says is bounded, with these words at its end.
    values : what is bounded, by route.   Raises ValueError when the quantity ends otherwise.
    """
    word = next((word for word in _BOUNDS if quantity.endswith(word)), None)
    if word is None:
        raise ValueError(
            f"{FILE}: {name}: the quantity must end with {' or '.join(map(repr, _BOUNDS))}, "
            f"which says how {printed} bounds it"
        )
    limit, side = Printed(printed), _BOUNDS[word]
    value = side * values.get(ROUTE, float("nan")) / limit.unit
    units = side * limit.value / limit.unit
    tight = (
        value < units <= value + 1.5
    )  # rounded, at most half a unit above the value, or one more
    how = f'"{word}": the bound is the value rounded as it is printed, or one unit looser'
    return _judged(tight, how)


def change(
    name: str, printed: str, errors: Mapping[str, float], near: Mapping[str, float]
) -> Judged:
    """Whether errors have become larger or smaller than near resonance, by the printed word.

    errors, near : the largest error off and near resonance, by route.   Raises ValueError for an unknown word.
    """
    comparison = _known(name, printed, _CHANGES)
    missing = float("nan")
    holds = comparison(errors.get(ROUTE, missing), near.get(ROUTE, missing))
    return _judged(holds, f'"{printed}": the error against that near resonance')


def truth(name: str, printed: str, facts: Mapping[str, bool]) -> Judged:
    """Whether a comparison comes out as printed, "true" or "false".

    facts : how it comes out, by route.   Raises ValueError for another word.
    """
    wanted = _known(name, printed, _TRUTHS)
    return _judged(facts.get(ROUTE) is wanted, f'"{printed}"')


def _judged(holds: bool, rule: str) -> Judged:
    """With the route and the rule in words."""
    outcome = "holds" if holds else "does not hold"
    return Judged(holds, f"Judged {ROUTE_NAMES[ROUTE]}, by {rule}. It {outcome}.")


def _known(name: str, printed: str, words: Mapping[str, Any]) -> Any:
    if printed not in words:
        raise ValueError(
            f"{FILE}: {name}: cannot judge the word {printed!r}; known are {', '.join(words)}"
        )
    return words[printed]
