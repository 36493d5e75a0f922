"""Everything the balances say of one frequency: every approach, pair by pair and by least squares, as one table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .balance import APPROACHES, Approach, Rows, takes_phase
from .solver import (
    Estimate,
    Pair,
    contact_stiffness,
    least_squares,
    mean_and_deviation,
    pair,
    pair_label,
)

if TYPE_CHECKING:
    import pandas as pd

    from .features import Features

ESTIMATE_COLUMNS = (
    "approach",  # a key of APPROACHES
    "kind",  # pair, mean, std (of the pairs: F_k_N and c_N_s_per_m hold the deviations) or least_squares
    "phase",  # individual φ and t_s of each level, or common to all levels
    "pair",  # "1-2" …; "all" for the other kinds
    "levels",  # number of responses that entered
    "F_k_N",
    "c_N_s_per_m",
    "F_k_standard_error_N",  # least squares of three or more levels only
    "c_standard_error_N_s_per_m",
    "residual",  # ‖A p − W‖ / ‖W‖
    "K_z_N_per_m",  # from F_k and the mean length of the microstick line
    "note",  # why a number is missing
)


def estimate_table(
    features: Features,
    k: float,
    chosen: Sequence[Pair],
    *,
    common: Features | None = None,
    common_approaches: Mapping[str, Approach] = APPROACHES,
) -> pd.DataFrame:
    """Everything the balances say of one frequency: each approach, pair-wise and least squares, one tidy row each.

    features : of n responses with their individual φ and t_s.   k : stiffness, N/m.   chosen : pairs, counted from 0.
    common : the same responses with one φ and one t_s; default: the means over the responses that slip.
    common_approaches : the row functions to use with `common`, by name.

    Approaches that know no choice of φ and t_s (`balance.takes_phase`) appear as "individual" only. What cannot be
    estimated, because a level lacks a feature, stays in the table with NaN and the reason as its note: one level
    without slip stops nothing.
    Columns: ESTIMATE_COLUMNS; the order of the rows is fixed.
    """
    import pandas as pd  # slow to import, and needed for tables only

    if common is None:
        common = features.with_common("phi", "t_s")
    records: list[dict[str, object]] = []
    for name, approach in APPROACHES.items():
        records += _records(name, "individual", approach(features, k), features, chosen)
    for name, approach in common_approaches.items():
        if takes_phase(name):
            records += _records(name, "common", approach(common, k), common, chosen)
    return pd.DataFrame.from_records(records, columns=list(ESTIMATE_COLUMNS))


def _records(
    name: str, phase: str, rows: Rows, features: Features, chosen: Sequence[Pair]
) -> list[dict[str, object]]:
    """The lines of the table for one approach: its pairs, their mean and deviation, the least squares."""
    swing = features.X + features.X_s
    head: dict[str, object] = {"approach": name, "phase": phase, "note": ""}
    records: list[dict[str, object]] = []
    estimates = []
    for i, j in chosen:
        line = head | {"kind": "pair", "pair": pair_label(i, j), "levels": 2}
        try:
            estimates.append(pair(rows, i, j))
            line |= _numbers(estimates[-1], swing[[i, j]])
        except ValueError as error:
            line |= {"levels": 0, "note": str(error)}
        records.append(line)

    head |= {"pair": "all", "levels": int(np.count_nonzero(rows.usable))}
    if estimates:
        F_k_mean, c_mean, F_k_std, c_std = mean_and_deviation(estimates)
        records.append(head | {"kind": "mean", "F_k_N": F_k_mean, "c_N_s_per_m": c_mean})
        records.append(head | {"kind": "std", "F_k_N": F_k_std, "c_N_s_per_m": c_std})

    left_out = ", ".join(str(level + 1) for level in np.flatnonzero(~rows.usable))
    fit = head | {"kind": "least_squares", "note": f"without level {left_out}" if left_out else ""}
    try:
        fit |= _numbers(least_squares(rows), swing[rows.usable])
    except ValueError as error:
        fit |= {"note": str(error)}
    return [*records, fit]


def _numbers(estimate: Estimate, swing: NDArray[np.float64]) -> dict[str, object]:
    """An estimate as columns of the table; `swing` are the lengths X + X_s of its responses' microstick lines, m."""
    F_k_error, c_error = estimate.standard_errors
    length = float(swing.mean())  # read-outs with few digits may have lost it
    K_z = float(contact_stiffness(estimate.F_k, length, 0.0)) if length > 0.0 else math.nan
    return {
        "F_k_N": estimate.F_k,
        "c_N_s_per_m": estimate.c,
        "F_k_standard_error_N": F_k_error,
        "c_standard_error_N_s_per_m": c_error,
        "residual": estimate.residual if estimate.n > 2 else math.nan,  # of a pair: rounding only
        "K_z_N_per_m": K_z,
    }
