"""The table of estimates at one frequency: every approach, pair by pair and by least squares."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import Array
from .balance import APPROACHES, TERMS, Approach, Rows, approach
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


def estimate_columns() -> list[str]:
    """Return the columns of a table of estimates, in order."""
    return [
        "approach",  # a key of APPROACHES
        "kind",  # pair, mean, std (of the pairs: columns of coefficients hold the deviations) or least_squares
        "phase",  # individual φ and t_s of each level, or common to all levels
        "pair",  # "1-2" …; "all" for the other kinds
        "levels",  # number of responses that entered
        *(term.column for term in TERMS.values()),
        # least squares of more levels than terms only
        *(term.error_column for term in TERMS.values()),
        "residual",  # ‖A p − W‖ / ‖W‖
        "K_z_N_per_m",  # F_k over the mean length of the microstick line
        "note",  # why a number is missing
    ]


def estimate_table(
    features: Features,
    k: float,
    chosen: Sequence[Pair],
    *,
    common: Features | None = None,
    approaches: Sequence[str] = (),
    common_approaches: Sequence[Approach] = (),
) -> pd.DataFrame:
    """Return the estimates of one frequency by each approach, pair-wise and by least squares, one row each.

    features : of n responses with their individual φ and t_s.   k : stiffness, N/m.   chosen : pairs, counted from 0.
    common : the same responses with one φ and one t_s; default, the means over the responses that slip.
    approaches : objects, or names of built-in ones; default, all built-in ones.
    common_approaches : those to use with `common`; default, the same.

    Approaches that do not depend on φ and t_s (`Approach.takes_phase`) appear as "individual" only. An estimate that
    does not exist, because a level lacks a feature, is NaN, with the reason as its note.
    Columns: `estimate_columns()`; the order of the rows is fixed.
    """
    import pandas as pd  # slow to import, and needed for tables only

    if common is None:
        common = features.with_common("phi", "t_s")
    records: list[dict[str, object]] = []
    ways = tuple(map(approach, approaches or APPROACHES))
    for way in ways:
        records += _records(way, "individual", way(features, k), features, chosen)
    for way in common_approaches or ways:
        if way.takes_phase:
            records += _records(way, "common", way(common, k), common, chosen)
    return pd.DataFrame.from_records(records, columns=estimate_columns())


def _records(
    name: str, phase: str, rows: Rows, features: Features, chosen: Sequence[Pair]
) -> list[dict[str, object]]:
    """Return the rows of the table for one approach: its pairs, their mean and deviation, the least squares."""
    swing = features.X + features.X_s
    head: dict[str, object] = {"approach": name, "phase": phase, "note": ""}
    records, estimates = [], []
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
        mean, deviation = mean_and_deviation([estimate.values for estimate in estimates])
        for kind, values in (("mean", mean), ("std", deviation)):
            records.append(head | {"kind": kind} | _in_columns(values))

    left_out = ", ".join(str(level + 1) for level in np.flatnonzero(~rows.usable))
    fit = head | {"kind": "least_squares", "note": f"without level {left_out}" if left_out else ""}
    try:
        fit |= _numbers(least_squares(rows), swing[rows.usable])
    except ValueError as error:
        fit |= {"note": str(error)}
    return [*records, fit]


def _in_columns(values: Mapping[str, Any]) -> dict[str, object]:
    return {TERMS[symbol].column: value for symbol, value in values.items()}


def _numbers(estimate: Estimate, swing: Array) -> dict[str, object]:
    """Return an estimate as columns of the table.   swing : lengths X + X_s of the microstick lines, m."""
    K_z = math.nan
    if "F_k" in estimate.values:
        K_z = float(contact_stiffness(estimate["F_k"], float(swing.mean()), 0.0))
    errors = {TERMS[s].error_column: estimate.standard_error(s) for s in estimate.values}
    overdetermined = estimate.n > len(estimate.values)
    return {
        **_in_columns(estimate.values),
        **errors,
        "residual": estimate.residual if overdetermined else math.nan,  # else rounding only
        "K_z_N_per_m": K_z,
    }
