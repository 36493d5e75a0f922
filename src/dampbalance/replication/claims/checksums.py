"""The paper's least squares as checksums of its tables: they show whether a printed digit is the one that was used.

The text prints F_k, c and the residual of the least squares of every approach, computed from Tables 1 and 2 as they
stand. Put back into the paper's equations, the printed tables give these numbers to the last digit. A residual of five
digits hardly ever survives a changed digit in a table; where it does not, and where one other last digit in a cell
restores every one of the printed results, that cell is refuted by the paper itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Literal

from ...balance import APPROACHES
from ...project.case import Case
from ...solver import least_squares
from ..claim_ids import of_text, statistic
from ..printed import Printed
from ..printed_tables import RESIDUAL, TABLE_1, TABLE_2, UNKNOWNS, Quantity
from ..route_tables import HARMONIC
from .from_print import printed_features
from .published import Published, column_ids

Table = Literal["table1", "table2"]
TABLES: dict[Table, tuple[tuple[str, ...], tuple[Quantity, ...]]] = {
    "table1": (HARMONIC, TABLE_1),
    "table2": (("direct",), TABLE_2),
}
"""Per table the approaches whose least squares start from it, and the columns from which they do."""

_OTHER_DIGITS = [sign * step for step in range(1, 10) for sign in (1, -1)]


def refuted(published: Published, case: Case, table: Table) -> Mapping[str, str]:
    """The cells of a table that the printed least squares refute: by the id of each, a sentence.

    Only ω, k and the equations come from outside the print.
    """
    approaches, quantities = TABLES[table]
    if _restored(published, case, approaches):
        return {}
    cells = (cell for q in quantities for cell in column_ids(table, q.symbol))
    digits = ((cell, _right_digits(published, case, cell, approaches)) for cell in cells)
    return {
        cell: f"The least squares that the paper prints come out with {other} here, not as printed."
        for cell, other in digits
        if other
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
            printed = published[of_text(statistic(symbol, approach, "least_squares"))]
            if not agrees(float(value), printed.text):
                return False
    return True


def _right_digits(published: Published, case: Case, cell: str, approaches: tuple[str, ...]) -> str:
    """The text of a cell with the other last digit that restores all printed results; "" for none."""
    others = (published[cell].moved(step) for step in _OTHER_DIGITS)
    restoring = (o for o in others if _restored(published.changed({cell: o}), case, approaches))
    return next(restoring, "")
