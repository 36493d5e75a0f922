"""The from-print route: the paper's own printed inputs put into its own equations.

Table 1 and the integrals of Table 2 go through the same rows and the same solver as everything else. For the least
squares, the residuals, the means and the deviations the printed numbers come out: the paper's arithmetic is sound.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from ...estimates import estimate_table
from ...features import COLUMNS, Features, of_numbers
from ...project.case import Case
from ..claim_verdicts import of_text
from ..printed_tables import TABLE_1, TABLE_2, UNKNOWNS
from ..route_tables import HARMONIC, RouteTables
from .published import LEVELS, PAIRS, Published


def printed_features(published: Published, omega: float) -> Features:
    """Tables 1 and 2 as features: each printed number as it stands, everything the paper does not print NaN.

    omega : drive frequency, rad/s.
    """
    arrays = {"Y_m": published.column("table1", "Y")}
    for table, quantities in (("table1", TABLE_1), ("table2", TABLE_2)):
        arrays |= {q.column: published.column(table, q.symbol) for q in quantities}
    missing = np.full(LEVELS, np.nan)
    features = {name: arrays.get(column, missing) for name, column in COLUMNS.items()}
    return of_numbers(omega, "as printed", **features)


def from_print(published: Published, case: Case) -> RouteTables:
    """Estimates at ω1 from the printed features, pair-wise with the φ = 1.542 and t_s = 2.1 ms that the text states.

    Only ω, k and the pairs come from outside the print.
    """
    features = printed_features(published, case.omega("omega1"))
    common = features.replaced(
        phi=published[of_text("phi_mean")].value, t_s=published[of_text("t_s_mean")].value
    )
    estimates = estimate_table(features, case.oscillator.k, PAIRS, common=common)
    return RouteTables({"omega1": features.to_frame()}, {"omega1": estimates})


def printed_estimates(published: Published) -> RouteTables:
    """The printed pairs of Tables 2 and 3 as a table of estimates."""

    def pairs(phase: str, table: str, name: str, *approach: str) -> pd.DataFrame:
        columns = {q.column: published.column(table, q.symbol, *approach) for q in UNKNOWNS}
        return pd.DataFrame(columns).assign(approach=name, kind="pair", phase=phase)

    tables = [pairs("individual", "table2", "direct")]
    tables += [pairs("common", "table3", name, name) for name in HARMONIC]
    return RouteTables({}, {"omega1": pd.concat(tables)})
