"""The numbers of the chart of errors, which is drawn once for print and once for the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..balance import TERMS
from ..law.terms import Term
from ..model import Oscillator

if TYPE_CHECKING:
    import pandas as pd

COMMON, INDIVIDUAL = "common", "individual"
ALL = "all"  # what the tables name in place of a pair: least squares over all levels
EXACT = 1e-5  # %: an approach nowhere worse than this is exact to rounding (which uneven levels magnify)
ROUNDING = 1e-11  # %: the least bound stated for rounding; below it the errors are chance
FLOOR = 1e-14  # %: a smaller error, zero too, counts as this on a logarithmic axis

Errors = dict[tuple[str, str, str], float]
"""(approach, phase, pair or ALL) → size of the relative error, %."""


@dataclass(frozen=True, slots=True)
class ErrorsOfTerm:
    """How wrong the estimates of one coefficient are.

    errors : by frequency, those that exist.   exact : approach that is exact to rounding → bound of its error, %.
    """

    term: Term
    errors: Mapping[str, Errors]
    exact: Mapping[str, float]

    @property
    def sizes(self) -> Array:
        """All errors, %, of the approaches that are not exact."""
        known = (item for one in self.errors.values() for item in one.items())
        return np.array([error for (approach, *_), error in known if approach not in self.exact])


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
        worst[approach] = max(error, worst.get(approach, 0.0))
    exact = {key: max(error, ROUNDING) for key, error in worst.items() if error < EXACT}
    return ErrorsOfTerm(term, errors, exact)


def _relative_errors(table: pd.DataFrame, column: str, true: float) -> Errors:
    """|estimate/true − 1| in %, of the pairs and of the least squares, those that exist."""
    errors: Errors = {}
    for row in table[table["kind"].isin(["pair", "least_squares"])].to_dict("records"):
        error = 100.0 * abs(float(row[column]) / true - 1.0)
        if math.isfinite(error):
            errors[row["approach"], row["phase"], row["pair"]] = max(error, FLOOR)
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


def _in_order(tables: Iterable[pd.DataFrame], column: str) -> list[str]:
    """The different entries of a column, in the order in which they first come."""
    return list(dict.fromkeys(value for table in tables for value in table[column]))


def _levels(pair: str, levels_m: Sequence[float]) -> str:
    """The pair "i-j" by its two excitation levels in mm."""
    return "–".join(f"{levels_m[int(level) - 1] * 1e3:g}" for level in pair.split("-"))
