"""The paper's least squares as checksums of its tables: they show whether a printed digit is the one that was used.

The text prints F_k, c and the residual of the least squares of every approach, computed from Tables 1 and 2 as they
stand. Put back into the paper's equations, the printed tables give these numbers to the last digit. A residual of five
digits hardly ever survives a changed digit in a table; where it does not, and where one other last digit in a cell
restores every one of the printed results, that cell is refuted by the paper itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Literal

from ...balance import APPROACHES
from ...project.case import Case
from ...solver import least_squares
from ..claim_ids import statistic
from ..printed import Printed
from ..printed_tables import RESIDUAL, UNKNOWNS
from .from_print import printed_features
from .inputs import HARMONIC
from .published import Published

Table = Literal["table1", "table2_integrals"]
TABLES: dict[Table, tuple[str, ...]] = {"table1": HARMONIC, "table2_integrals": ("direct",)}
"""The tables and the approaches whose least squares start from them."""

_OTHER_DIGITS = [sign * step for step in range(1, 10) for sign in (1, -1)]


def refuted(published: Published, case: Case, table: Table) -> Mapping[tuple[str, str], str]:
    """The cells of a table that the printed least squares refute, by column and level, with a sentence on each.

    Only ω, k and the equations come from outside the print.
    """
    approaches = TABLES[table]
    if _restored(published, case, approaches):
        return {}
    return {
        (column, level): sentence
        for column, level, sentence in _culprits(published, case, table, approaches)
    }


def agrees(value: float, printed: str) -> bool:
    """Whether a value, rounded or cut off, has the printed digits."""
    number = Printed(printed)
    computed, units = value / number.unit, number.value / number.unit
    return abs(computed - units) <= 0.5 or math.trunc(computed) == round(units)


def _restored(published: Published, case: Case, approaches: Iterable[str]) -> bool:
    """Whether the printed tables give every printed result of these least squares."""
    features = printed_features(published, case.omega("omega1"))
    for approach in approaches:
        estimate = least_squares(APPROACHES[approach](features, case.oscillator.k))
        for symbol in [*(q.symbol for q in UNKNOWNS), RESIDUAL.symbol]:
            value = estimate.residual if symbol == RESIDUAL.symbol else estimate[symbol]
            name = statistic(symbol, approach, "least_squares")
            if not agrees(float(value), published.text_values["printed"][name]):
                return False
    return True


def _culprits(
    published: Published, case: Case, table: Table, approaches: tuple[str, ...]
) -> Iterator[tuple[str, str, str]]:
    """Every cell of the table that, with another last digit, restores all printed results."""
    frame = getattr(published, table)
    for column in frame.columns.drop("Y_m"):
        for level in frame.index:
            for step in _OTHER_DIGITS:
                other = Printed(frame[column][level]).moved(step)
                changed = frame.copy()
                changed.loc[level, column] = other
                if _restored(replace(published, **{table: changed}), case, approaches):
                    sentence = f"The least squares that the paper prints come out with {other} here, not as printed."
                    yield column, level, sentence
                    break
