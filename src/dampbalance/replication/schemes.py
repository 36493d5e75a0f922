"""The integrals of Table 2 by other schemes and coefficients than those that the printed digits point to.

If the numbers singled out backward Euler on rounded coefficients only because nothing else was tried, they would prove
little. So everything else that one would have written is tried, too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import pandas as pd

from ..arrays import Array
from ..balance import direct
from ..motion.fixed_step import SCHEMES
from ..project.case import Case
from ..reading.clean import CYCLES_TO_READ
from ..solver import least_squares
from .as_published import features_of, simulate_levels

_CYCLES = 12
"""Steady cycles in which a is read: a period is no whole number of steps, so that each samples the motion elsewhere."""


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
            head = {"scheme": scheme, "coefficients": coefficients}
            columns = {"a_m": features.a, "b_m2_per_s": features.b, "W_J": features.W}
            fit = {"F_k_N": estimate["F_k"], "c_N_s_per_m": estimate["c"]}
            tables.append(_by_level(head, columns).assign(**fit))
    return pd.concat(tables, ignore_index=True)


def cycle_table(case: Case, frequency: str) -> pd.DataFrame:
    """a (m) and V_s (m/s) of the as-published simulation in each of its last steady cycles.

    One row per cycle, the last one first, and level. Which cycle the authors integrated decides where the samples fall;
    what the printed a say of the step must therefore hold in all of them.
    """
    kept = min(_CYCLES + CYCLES_TO_READ - 1, case.numerics.cycles)
    records = simulate_levels(case, frequency, keep_cycles=kept)
    period = 2.0 * math.pi / case.omega(frequency) / case.numerics.step_s  # in steps
    tables = []
    for cycle in range(kept - CYCLES_TO_READ + 1):
        ends = [len(record) - round(cycle * period) for record in records]
        length = math.ceil(CYCLES_TO_READ * period) + 1
        parts = [r.samples(max(end - length, 0), end) for r, end in zip(records, ends, strict=True)]
        read = features_of(parts, case, frequency, "sample")
        tables.append(_by_level({"cycle": -cycle}, {"a_m": read.a, "V_s_m_per_s": read.V_s}))
    return pd.concat(tables, ignore_index=True)


def _by_level(head: Mapping[str, object], columns: Mapping[str, Array]) -> pd.DataFrame:
    levels = range(1, len(next(iter(columns.values()))) + 1)
    return pd.DataFrame({**head, "level": levels, **columns})
