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
from ...solver import Statistics, mean_and_deviation
from ..claim_ids import of_text
from ..printed_tables import COLUMN_OF, TABLE_1, TABLE_2
from ..route_tables import RouteTables
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


def printed_pair_statistics(published: Published) -> Statistics:
    """Mean and standard deviation (n − 1) of the five pairs that Table 2 prints."""
    F_k, c = (published.column("table2", symbol) for symbol in ("F_k", "c"))
    return mean_and_deviation([{"F_k": p, "c": q} for p, q in zip(F_k, c, strict=True)])


def printed_estimates(published: Published) -> RouteTables:
    """The printed pairs of Tables 2 and 3 as a table of estimates, to ask it for its largest errors."""
    pairs: dict[tuple[str, str], dict[str, float]] = {}
    for row in published.rows.values():
        if row.rule in ("direct pair", "harmonic pair"):
            pair = pairs.setdefault((row.approach, row.line), {})
            pair[COLUMN_OF[row.symbol]] = published[row.id].value
    frame = pd.DataFrame.from_records(
        [{"approach": name, "pair": label, **pair} for (name, label), pair in pairs.items()]
    )
    phase = np.where(frame["approach"] == "direct", "individual", "common")
    return RouteTables({}, {"omega1": frame.assign(kind="pair", phase=phase)})
