"""What the integrals of Table 2 would have been with other schemes and coefficients than those the print points to.

If the numbers singled out backward Euler on rounded coefficients only because nothing else was tried, they would prove
little. So everything else that one would have written is tried, too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from ..balance import direct
from ..features import stack
from ..model import BaseMotion, Oscillator
from ..motion.fixed_step import SCHEMES, simulate
from ..reading.clean import of_record
from ..solver import least_squares

KEPT_CYCLES = 3  # one to wait for the reversal, one to read, one for the lock-in


def scheme_table(
    oscillator: Oscillator,
    frequency_hz: float,
    levels_m: Sequence[float],
    numerics: Mapping[str, Any],
) -> pd.DataFrame:
    """a, b, W of every scheme on rounded and on exact coefficients c/m, k/m, and the F_k, c they give together.

    numerics : the section `as_published` of the configuration: step, cycles, decimals of the rounded coefficients.
    One row per scheme, coefficients ("rounded" or "exact") and level; F_k_N and c_N_s_per_m (least squares of the
    levels) are the same in the rows of one simulation.
    """
    omega = 2.0 * math.pi * frequency_hz
    C, K = oscillator.c / oscillator.m, oscillator.k / oscillator.m
    coefficients = {
        "rounded": (
            _rounded(C, numerics["c_over_m_decimals"]),
            _rounded(K, numerics["k_over_m_decimals"]),
        ),
        "exact": (C, K),
    }
    tables = []
    for scheme in SCHEMES:
        for name, (c_over_m, k_over_m) in coefficients.items():
            features = stack(
                [
                    of_record(
                        simulate(
                            oscillator,
                            BaseMotion(Y=Y, omega=omega),
                            scheme=scheme,
                            step=numerics["step_s"],
                            cycles=numerics["cycles"],
                            keep_cycles=KEPT_CYCLES,
                            c_over_m=c_over_m,
                            k_over_m=k_over_m,
                        ),
                        omega,
                        oscillator.k,
                        "sample",
                    )
                    for Y in levels_m
                ]
            )
            estimate = least_squares(direct(features, oscillator.k))
            tables.append(
                pd.DataFrame(
                    {
                        "scheme": scheme,
                        "coefficients": name,
                        "level": range(1, len(levels_m) + 1),
                        "a_m": features.a,
                        "b_m2_per_s": features.b,
                        "W_J": features.W,
                        "F_k_N": estimate["F_k"],
                        "c_N_s_per_m": estimate["c"],
                    }
                )
            )
    return pd.concat(tables, ignore_index=True)


def _rounded(value: float, decimals: int | None) -> float:
    return value if decimals is None else round(value, decimals)
