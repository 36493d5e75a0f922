"""Statements of the paper, bounds and words, each judged by what is printed: another number or word, another verdict.

A bound is judged on both sides. "Less than 1.5 %" holds where the value is below 1.5 %, and says something only where
it is not far below: a bound more than half a decade off, a factor of √10, is not reproduced. A word holds where the
comparison that it names does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ..printed import Printed

LOOSEST = math.sqrt(10.0)
"""How far a bound may lie from the value that it bounds, as a factor: half a decade, so that it tells the size."""

_BOUNDS = {"less than": "from above", "more than": "from below"}
_CHANGES: dict[str, Callable[[float, float], bool]] = {
    "degraded": lambda error, near: error > near,
    "improved": lambda error, near: error < near,
}
_TRUTHS = {"true": True, "false": False}


class Judged(NamedTuple):
    """Whether a statement holds, by route, and how that was judged, in a sentence."""

    holds: dict[str, bool]
    how: str


def bound(name: str, quantity: str, printed: str, values: Mapping[str, float]) -> Judged:
    """A bound, "…: less than" or "…: more than" a number.

    name : of the statement, for errors.   quantity : what the paper says is bounded, with these words at its end.
    values : what is bounded, by route.   Raises ValueError when the quantity ends otherwise.
    """
    word = next((word for word in _BOUNDS if quantity.endswith(word)), None)
    if word is None:
        raise ValueError(
            f"text_values.csv: {name}: the quantity must end with {' or '.join(map(repr, _BOUNDS))}, "
            f"which says how {printed} bounds it"
        )
    limit = Printed(printed).value

    def holds(value: float) -> bool:
        ratio = limit / value if word == "less than" else value / limit
        return 1.0 < ratio <= LOOSEST

    return Judged(
        {route: holds(value) for route, value in values.items()},
        f"Judged as a bound {_BOUNDS[word]}, at most half a decade from the value.",
    )


def change(
    name: str, printed: str, errors: Mapping[str, float], near: Mapping[str, float]
) -> Judged:
    """Whether errors have become larger or smaller than near resonance, by the printed word.

    errors, near : the largest error off and near resonance, by route.   Raises ValueError for an unknown word.
    """
    comparison = _known(name, printed, _CHANGES)
    return Judged(
        {route: comparison(error, near[route]) for route, error in errors.items()},
        f'Judged by the word "{printed}": the error against that near resonance.',
    )


def truth(name: str, printed: str, facts: Mapping[str, bool]) -> Judged:
    """Whether a comparison comes out as printed, "true" or "false".

    facts : how it comes out, by route.   Raises ValueError for another word.
    """
    wanted = _known(name, printed, _TRUTHS)
    return Judged(
        {route: fact == wanted for route, fact in facts.items()},
        f'Judged by the word "{printed}".',
    )


def _known(name: str, printed: str, words: Mapping[str, Any]) -> Any:
    if printed not in words:
        raise ValueError(
            f"text_values.csv: {name}: cannot judge the word {printed!r}; known are {', '.join(words)}"
        )
    return words[printed]
