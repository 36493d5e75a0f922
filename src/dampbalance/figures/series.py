"""The numbers of the figure of errors, and the axis that they need."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array
from ..balance import TERMS
from ..law.terms import Term
from ..model import Oscillator

if TYPE_CHECKING:
    import pandas as pd

COMMON, INDIVIDUAL = "common", "individual"
SHARINGS = {INDIVIDUAL: "of each level", COMMON: "common to all levels"}
"""Whether levels share φ and t_s, in words, in the order of legends."""
ALL = "all"  # what the tables name in place of a pair: least squares over all levels
EXACT = 1e-5  # %: an approach nowhere worse than this is exact to rounding (which uneven levels magnify)
ROUNDING = 1e-11  # %: the least bound stated for rounding; below it the errors are chance
FLOOR = 1e-4  # %: a smaller error is drawn on the linear part of an axis

Errors = dict[tuple[str, str, str], float]
"""(approach, phase, pair or ALL) → relative error, %, with its sign."""


@dataclass(frozen=True, slots=True)
class ErrorsOfTerm:
    """How wrong the estimates of one coefficient are.

    errors : by frequency, those that exist.   exact : approach that is exact to rounding → bound of its error, %.
    """

    term: Term
    errors: Mapping[str, Errors]
    exact: Mapping[str, float]

    @property
    def scale(self) -> SignedScale:
        """The axis of all errors, %, of the approaches that are not exact."""
        known = (item for one in self.errors.values() for item in one.items())
        drawn = [error for (approach, *_), error in known if approach not in self.exact]
        return signed_scale([np.array(drawn)], FLOOR, math.inf, cut=0.02)


@dataclass(frozen=True, slots=True)
class ErrorsByLevel:
    """Errors of all approaches, pairs of levels, frequencies and terms.

    approaches : in the order of the tables.   places : the pairs of the tables, then ALL.   names : theirs, by the
    excitation levels in mm.
    """

    approaches: tuple[str, ...]
    places: tuple[str, ...]
    names: tuple[str, ...]
    terms: tuple[ErrorsOfTerm, ...]

    @property
    def exact(self) -> dict[str, float]:
        """Approach that is exact for every term → bound of its error, %."""
        return {
            key: max(of_term.exact[key] for of_term in self.terms)
            for key in self.approaches
            if all(key in of_term.exact for of_term in self.terms)
        }


def errors_by_level(
    estimates: Mapping[str, pd.DataFrame],
    oscillator: Oscillator,
    frequencies_hz: Mapping[str, float],
    levels_m: Sequence[float],
) -> ErrorsByLevel:
    """Relative errors, %, of every pair of levels and of all levels together, for each term of the oscillator.

    estimates : frequency → table of `estimates.estimate_table`.   oscillator : with the true coefficients.
    frequencies_hz : frequency → f, Hz, in the order of the charts.   levels_m : excitation levels Y_i, m, that a pair
    "i-j" names.

    An estimate that does not exist (nothing slips) is left out.
    Raises ValueError for a frequency without estimates, and for no frequency at all.
    """
    missing = sorted(set(frequencies_hz) - set(estimates))
    if missing or not frequencies_hz:
        raise ValueError(
            f"estimates needed for the frequencies {missing or '(none named)'}, "
            f"there are tables for {sorted(estimates)}"
        )
    tables = {name: estimates[name] for name in frequencies_hz}
    pairs = [pair for pair in _in_order(tables.values(), "pair") if pair != ALL]
    terms = [term for term in TERMS.values() if hasattr(oscillator, term.symbol)]
    return ErrorsByLevel(
        approaches=tuple(_in_order(tables.values(), "approach")),
        places=(*pairs, ALL),
        names=(*(_levels(pair, levels_m) for pair in pairs), ALL),
        terms=tuple(_of_term(term, tables, getattr(oscillator, term.symbol)) for term in terms),
    )


def _of_term(term: Term, tables: Mapping[str, pd.DataFrame], true: float) -> ErrorsOfTerm:
    """The errors of one coefficient against its true value."""
    errors = {name: _relative_errors(table, term.column, true) for name, table in tables.items()}
    worst: dict[str, float] = {}
    for (approach, *_), error in (item for one in errors.values() for item in one.items()):
        worst[approach] = max(abs(error), worst.get(approach, 0.0))
    exact = {key: max(error, ROUNDING) for key, error in worst.items() if error < EXACT}
    return ErrorsOfTerm(term, errors, exact)


def _relative_errors(table: pd.DataFrame, column: str, true: float) -> Errors:
    """estimate/true − 1 in %, of the pairs and of the least squares, those that exist."""
    errors: Errors = {}
    for row in table[table["kind"].isin(["pair", "least_squares"])].to_dict("records"):
        error = 100.0 * (float(row[column]) / true - 1.0)
        if math.isfinite(error):
            errors[row["approach"], row["phase"], row["pair"]] = error
    return errors


def decades(
    sizes: Sequence[Array], floor: float = 0.0, ceiling: float = math.inf, cut: float = 0.0
) -> tuple[float, float]:
    """Limits of a logarithmic axis: whole decades around sizes, within bounds.

    cut : share of the sizes, the smallest, that may lie below the axis.
    """
    known = np.concatenate([np.empty(0), *sizes])
    known = known[np.isfinite(known) & (known > 0.0)]
    low, high = (np.quantile(known, cut), known.max()) if known.size else (0.1, 10.0)
    bottom = max(floor, 10.0 ** math.floor(math.log10(low)))
    return bottom, max(10.0 * bottom, min(ceiling, 10.0 ** math.ceil(math.log10(high))))


class SignedScale(NamedTuple):
    """An axis of errors of either sign: linear within ±linear, logarithmic beyond, from low to high; all are powers of
    ten, low a negative one."""

    linear: float
    low: float
    high: float

    @property
    def ticks(self) -> list[float]:
        """Zero and, of either sign, the powers of ten."""
        first = round(math.log10(self.linear))
        sides = (-self.low, self.high)
        below, above = (range(first, round(math.log10(side)) + 1) for side in sides)
        powers = [-float(f"1e{power}") for power in reversed(below)]
        return [*powers, 0.0, *(float(f"1e{power}") for power in above)]


def signed_scale(
    errors: Sequence[Array], floor: float, ceiling: float, cut: float = 0.0
) -> SignedScale:
    """The axis that holds errors, whole decades around those of either sign; the arguments are those of `decades`."""
    linear, top = decades([np.abs(some) for some in errors], floor, ceiling, cut)
    known = np.concatenate([np.empty(0), *errors])
    known = known[np.isfinite(known)]
    sides = (
        max(linear, known.max(initial=0.0, where=known > 0.0)),
        max(linear, -known.min(initial=0.0)),
    )
    high, low = (min(top, 10.0 ** math.ceil(math.log10(side) - 1e-9)) for side in sides)
    return SignedScale(linear, -low, high)


def _in_order(tables: Iterable[pd.DataFrame], column: str) -> list[str]:
    """The different entries of a column, in the order in which they first come."""
    return list(dict.fromkeys(value for table in tables for value in table[column]))


def _levels(pair: str, levels_m: Sequence[float]) -> str:
    """The pair "i-j" by its two excitation levels in mm."""
    return "–".join(f"{levels_m[int(level) - 1] * 1e3:g}" for level in pair.split("-"))
