"""The paper's least squares as checksums of its tables: they show whether a printed digit is the one that was used.

The text prints F_k, c and the residual of the least squares of every approach, computed from Tables 1 and 2 as they
stand. Put back into the paper's equations, the printed tables give these numbers to the last digit. A residual of five
digits hardly ever survives a changed digit in a table; where it does not, and where one other last digit in a cell
restores every one of the printed results, that cell is refuted by the paper itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from ...balance import APPROACHES
from ...project.case import Case
from ...solver import least_squares
from ..claim_verdicts import of_text, statistic
from ..printed import Printed
from ..printed_tables import RESIDUAL, TABLE_1, TABLE_2
from ..route_tables import HARMONIC
from .from_print import printed_features
from .published import Published, column_ids

_TABLES = (("table1", TABLE_1, HARMONIC), ("table2", TABLE_2, ("direct",)))
"""Per table its columns and the approaches whose least squares start from them."""

_OTHER_DIGITS = [sign * step for step in range(1, 10) for sign in (1, -1)]


def refuted(published: Published, case: Case) -> dict[str, str]:
    """The cells of Tables 1 and 2 that the printed least squares refute: by the id of each, a sentence.

    Only ω, k and the equations come from outside the print.
    """
    refutations = {}
    for table, quantities, approaches in _TABLES:
        if _restored(published, case, approaches):
            continue
        for cell in (cell for q in quantities for cell in column_ids(table, q.symbol)):
            others = (published[cell].moved(step) for step in _OTHER_DIGITS)
            restoring = (
                o for o in others if _restored(published.changed({cell: o}), case, approaches)
            )
            if other := next(restoring, ""):
                refutations[cell] = (
                    f"The least squares that the paper prints come out with {other} here, not as printed."
                )
    return refutations


def agrees(value: float, number: Printed) -> bool:
    """Whether a value, rounded or cut off, has the printed digits."""
    computed, units = value / number.unit, number.value / number.unit
    return abs(computed - units) <= 0.5 or math.trunc(computed) == round(units)


def _restored(published: Published, case: Case, approaches: Iterable[str]) -> bool:
    """Whether the printed tables give every printed result of these least squares."""
    features = printed_features(published, case.omega("omega1"))
    for approach in approaches:
        estimate = least_squares(APPROACHES[approach](features, case.oscillator.k))
        results = {**estimate.values, RESIDUAL.symbol: estimate.residual}
        for symbol, value in results.items():
            printed = published[of_text(statistic(symbol, approach, "least_squares"))]
            if not agrees(float(value), printed):
                return False
    return True
