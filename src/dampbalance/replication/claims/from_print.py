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
from ..printed import Printed
from ..printed_tables import TABLE_2, UNKNOWNS
from .inputs import HARMONIC, PAIR_LABELS, PAIRS, RouteTables
from .published import Published, numbers


def printed_features(published: Published, omega: float) -> Features:
    """Tables 1 and 2 as features: each printed number as it stands, everything the paper does not print NaN.

    omega : drive frequency, rad/s.
    """
    table1, integrals = published.table1, published.table2_integrals
    arrays = {column: numbers(table1, column) for column in table1.columns}
    arrays |= {q.column: numbers(integrals, q.column) for q in TABLE_2}
    missing = np.full(len(table1), np.nan)
    features = {name: arrays.get(column, missing) for name, column in COLUMNS.items()}
    return of_numbers(omega, "as printed", **features)


def from_print(published: Published, case: Case) -> RouteTables:
    """Estimates at ω1 from the printed features, pair-wise with the φ = 1.542 and t_s = 2.1 ms that the text states.

    Only ω, k and the pairs come from outside the print.
    """
    features = printed_features(published, case.omega("omega1"))
    common = features.replaced(
        phi=Printed(published.text_values["printed"]["phi_mean"]).value,
        t_s=Printed(published.text_values["printed"]["t_s_mean"]).value,
    )
    estimates = estimate_table(features, case.oscillator.k, PAIRS, common=common)
    return RouteTables({"omega1": features.to_frame()}, {"omega1": estimates})


def printed_pair_statistics(published: Published) -> Statistics:
    """Mean and standard deviation (n − 1) of the five pairs that Table 2 prints."""
    F_k = numbers(published.table2_pairs, "direct_F_k_N")
    c = numbers(published.table2_pairs, "direct_c_N_s_per_m")
    return mean_and_deviation([{"F_k": p, "c": q} for p, q in zip(F_k, c, strict=True)])


def printed_estimates(published: Published) -> RouteTables:
    """The printed pairs of Tables 2 and 3 as a table of estimates, to ask it for its largest errors."""
    records = []
    for approach, phase, table in (
        ("direct", "individual", published.table2_pairs),
        *((name, "common", published.table3) for name in HARMONIC),
    ):
        for label in PAIR_LABELS:
            estimate = {
                q.column: Printed(table[f"{approach}_{q.column}"][label]).value for q in UNKNOWNS
            }
            records.append(
                {"approach": approach, "kind": "pair", "phase": phase, "pair": label} | estimate
            )
    return RouteTables({}, {"omega1": pd.DataFrame.from_records(records)})
