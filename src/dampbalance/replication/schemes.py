"""What the integrals of Table 2 would have been with other schemes and coefficients than those the print points to.

If the numbers singled out backward Euler on rounded coefficients only because nothing else was tried, they would prove
little. So everything else that one would have written is tried, too.
"""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from ..balance import direct
from ..motion.fixed_step import SCHEMES
from ..project.case import Case
from ..solver import least_squares
from .as_published import features_of, simulate_levels


def scheme_table(case: Case, frequency: str) -> pd.DataFrame:
    """a, b, W of every scheme on rounded and on exact coefficients c/m, k/m, and the F_k, c they give together.

    One row per scheme, coefficients ("rounded" or "exact") and level; F_k_N and c_N_s_per_m (least squares of the
    levels) are the same in the rows of one simulation.
    """
    exact = replace(case.numerics, c_over_m_decimals=None, k_over_m_decimals=None)
    tables = []
    for scheme in SCHEMES:
        for coefficients, numerics in (("rounded", case.numerics), ("exact", exact)):
            tried = replace(case, numerics=replace(numerics, scheme=scheme))
            features = features_of(simulate_levels(tried, frequency), tried, frequency, "sample")
            estimate = least_squares(direct(features, case.oscillator.k))
            tables.append(
                pd.DataFrame(
                    {
                        "scheme": scheme,
                        "coefficients": coefficients,
                        "level": range(1, len(features) + 1),
                        "a_m": features.a,
                        "b_m2_per_s": features.b,
                        "W_J": features.W,
                        "F_k_N": estimate["F_k"],
                        "c_N_s_per_m": estimate["c"],
                    }
                )
            )
    return pd.concat(tables, ignore_index=True)
