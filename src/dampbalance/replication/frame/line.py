"""Friction force against the load that presses the contact: a straight line, and how far the loads depart from it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

GRAVITY = 9.80665
"""Standard gravity, m/s²."""

_CONFIDENCE = 0.95


def load_line(
    loads: Sequence[float], forces: Sequence[float], errors: Sequence[float]
) -> tuple[dict[str, Any], list[float]]:
    """F_k = F_0 + s·load by unweighted least squares, and the relative distance of each force from the line.

    loads : kg, three or more.   forces : F_k at each, N.   errors : their standard errors from the cycles, N.

    `slope_N_per_kg` s and `intercept_N` F_0, with intervals of 95 % by Student's t from the scatter about the line;
    `coefficient` s/g of friction, if the load alone presses; `scatter`, the scatter about the line relative to
    that which the standard errors predict: 1 where the cycles explain all of it.
    """
    from scipy import special  # slow to import

    load, force = np.asarray(loads, dtype=np.float64), np.asarray(forces, dtype=np.float64)
    columns = np.column_stack([np.ones(load.size), load])
    inverse = np.linalg.inv(columns.T @ columns)
    intercept, slope = (float(part) for part in inverse @ columns.T @ force)
    off = force - intercept - slope * load
    freedom = load.size - 2
    variance = float(off @ off) / freedom
    reach = float(special.stdtrit(freedom, 0.5 + 0.5 * _CONFIDENCE)) * np.sqrt(
        variance * np.diag(inverse)
    )
    left = np.eye(load.size) - columns @ inverse @ columns.T  # residuals of unit errors
    expected = float(np.sum(left**2 @ np.asarray(errors) ** 2)) / freedom
    line = {
        "slope_N_per_kg": slope,
        "slope_interval_N_per_kg": [slope - float(reach[1]), slope + float(reach[1])],
        "coefficient": slope / GRAVITY,
        "intercept_N": intercept,
        "intercept_interval_N": [intercept - float(reach[0]), intercept + float(reach[0])],
        "scatter": math.sqrt(variance / expected),
    }
    return line, [float(part) for part in off / force]
