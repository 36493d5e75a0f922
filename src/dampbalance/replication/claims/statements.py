"""Statements of the paper, bounds and words, each judged by what is printed: another number or word, another verdict.

All are judged by one route, as published: they speak of what the authors computed. "Less than 1.5 %" holds where the
value is less, and the bound is the value rounded as it is printed, or one unit looser; any looser, it would say nothing
of the value. A word holds where the comparison that it names does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ...balance import TERMS
from ...estimates import estimate_table
from ...features import Features
from ..claim_verdicts import ROUTE_NAMES
from ..comparison import largest_errors, relative_errors
from ..readout import ReadOut
from ..route_tables import HARMONIC, RouteTables
from .judging import Claim
from .published import FILE, PAIRS, Row
from .sources import Sources

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


def bound_holds(row: Row, value: float) -> tuple[bool, str]:
    """Whether a bound on the value of ROUTE holds, "…: less than" or "…: more than" the printed number, and its rule.

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
    return tight, f'"{word}": the bound is the value rounded as it is printed, or one unit looser'


def word_holds(row: Row, one: float, other: float) -> tuple[bool, str]:
    """Whether a word holds for how two errors of ROUTE compare, and the rule that judges it.

    one, other : the error off and near resonance, or that of direct integration and the least of the other approaches.
    Raises ValueError for a word that the rule of the row does not know.
    """
    words = WORDS[row.rule]
    if row.printed not in words:
        raise ValueError(
            f"{FILE}: {row.id}: cannot judge the word {row.printed!r}; known are {', '.join(words)}"
        )
    what = ": the error against that near resonance" if row.rule == "change" else ""
    return words[row.printed](one, other), f'"{row.printed}"{what}'


def bound(sources: Sources, row: Row) -> Claim:
    """Bounds on the errors of the two-point formulas with common φ and t_s, at ω1 and at other frequencies."""
    if row.symbol in TERMS:
        osc = sources.case.oscillator
        values = {
            name: largest_errors(tables.pairs(), osc)[row.symbol]
            for name, tables in sources.pairs.items()
        }
        cause = f"Largest error in the fifteen pairs: {_each(values)}."
    else:
        values = _worst(sources, sources.routes, frequency=row.symbol)
        cause = _largest_with_sign(sources, row.symbol)
    return _stated(row, values, bound_holds(row, values[ROUTE]), cause)


def change(sources: Sources, row: Row) -> Claim:
    """Words for how accurate the two-point formulas are off resonance."""
    hz = sources.case.frequencies_hz
    values = _worst(sources, sources.routes, frequency=row.symbol)
    error, near = (of[ROUTE] for of in (values, _worst(sources, sources.routes)))
    cause = (
        f"Largest error of the two-point formulas: {error:.1f} % at {hz[row.symbol]:g} Hz, "
        f"{near:.1f} % at {hz['omega1']:g} Hz."
    )
    return _stated(row, values, word_holds(row, error, near), cause)


def truth(sources: Sources, row: Row) -> Claim:
    """That direct integration is the most accurate approach."""
    direct, *harmonic = (
        _worst(sources, sources.pairs, (approach,)) for approach in ("direct", *HARMONIC)
    )
    best = {route: min(errors[route] for errors in harmonic) for route in direct}
    cause = f"Largest error in the pairs, direct: {_each(direct)}; best harmonic approach: {_each(best)}."
    return _stated(row, direct, word_holds(row, direct[ROUTE], best[ROUTE]), cause)


def _largest_with_sign(sources: Sources, frequency: str) -> str:
    """The largest error of F_k at a frequency by several ways to the features, a sentence."""

    def largest(tables: RouteTables) -> str:
        errors = relative_errors(tables.pairs(frequency=frequency), sources.case.oscillator)
        of_F_k = errors["F_k"].to_numpy()
        signless = np.abs(of_F_k)
        return "" if np.isnan(signless).all() else f"{of_F_k[np.nanargmax(signless)]:+.1f} %"

    return (
        f"Largest error of F_k by the recipe that gives Table 3: {largest(sources.as_published)}; by exact features "
        f"{largest(sources.exact)}, with six decimals {largest(_with_decimals(sources, frequency, 6))}, with the five "
        f"of Table 1 {largest(_with_decimals(sources, frequency, 5))}. The paper prints no number at this frequency to "
        "hold against it."
    )


def _worst(
    sources: Sources,
    routes: Mapping[str, RouteTables],
    approaches: tuple[str, ...] = HARMONIC,
    frequency: str = "omega1",
) -> dict[str, float]:
    """By each route, the larger of the largest errors of F_k and c over the pairs, per cent."""
    osc = sources.case.oscillator
    return {
        name: max(largest_errors(tables.pairs(approaches, frequency), osc).values())
        for name, tables in routes.items()
    }


def _with_decimals(sources: Sources, frequency: str, decimals: int) -> RouteTables:
    """Pairs from exact features of a frequency, X, X_s and V_s with so many decimals; nothing if there are none."""
    frame = sources.exact.features.get(frequency)
    if frame is None:
        return RouteTables({}, {})
    read = ReadOut(X_decimals=decimals, X_s_decimals=decimals, V_s_decimals=decimals)
    features = read.apply(Features.from_frame(frame))
    return RouteTables({}, {frequency: estimate_table(features, sources.case.oscillator.k, PAIRS)})


def _stated(row: Row, values: Mapping[str, float], judged: tuple[bool, str], cause: str) -> Claim:
    holds, rule = judged
    outcome = "holds" if holds else "does not hold"
    how = f"Judged {ROUTE_NAMES[ROUTE]}, by {rule}. It {outcome}."
    return Claim(row, values, ROUTE, holds=holds, cause=f"{how} {cause}")


def _each(values: Mapping[str, float]) -> str:
    """The errors by the routes in words."""
    return ", ".join(
        f"{value:.3f} % {ROUTE_NAMES[route]}"
        for route, value in values.items()
        if not math.isnan(value)
    )
