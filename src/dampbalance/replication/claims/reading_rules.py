"""Which rule of reading is at work in a number of Table 3, and by how much it moves it.

The simulation moves a pair from its exact value; then each rule of the configured `two_point` section is applied alone
to the result of the simulation, and the shift of the pair is its share. The rest is interaction between the rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import pandas as pd

from ...features import Features
from ...project.case import Case
from ..as_published import estimates
from ..printed_tables import COLUMN_OF
from ..readout import ReadOut
from ..route_tables import RouteTables
from .published import PAIRS, Row


class _Read(NamedTuple):
    """A feature that is read: keys of its rules in the configuration; words for how it reads, the columns whose sum
    reads so, scaled, and its format with its unit."""

    keys: tuple[str, ...]
    words: str
    columns: tuple[str, ...]
    scale: float
    shown: str


_READ = (
    _Read(("X_decimals",), "X read as", ("X_m",), 1e3, "{:g} mm"),
    _Read(("X_s_mark_m", "X_s_decimals"), "X + X_s read as", ("X_m", "X_s_m"), 1e6, "{:.4g} µm"),
    _Read(("V_s_decimals",), "V_s read as", ("V_s_m_per_s",), 1e3, "{:g} mm/s"),
    _Read(
        ("t_s_inset_s", "t_s_unit_s", "common_t_s_decimals"),
        "one t_s of",
        ("t_s_s",),
        1e3,
        "{:g} ms",
    ),
    _Read(("phi_decimals", "common_phi_decimals"), "one phi of", ("phi_rad",), 1.0, "{:.6g} rad"),
)


def rules_at_work(
    case: Case, exact_route: RouteTables, unrounded: pd.DataFrame
) -> Callable[[Row], str]:
    """A function of a row that says what moves that number of Table 3 from exact, in a sentence.

    Named are the largest share, and every other that moves the number by half a unit of its last printed digit.
    Arguments as in `Sources`.
    """
    if "omega1" not in exact_route.features or unrounded.empty:
        return lambda row: ""
    configured = case.numerics.two_point

    def pairs(frame: pd.DataFrame, *keys: str) -> RouteTables:
        features = Features.from_frame(frame)
        read = ReadOut.from_config({key: configured.get(key) for key in keys}).common(features)
        table = estimates(features, read, replace(case, pairs=PAIRS))
        return RouteTables({"omega1": read.to_frame()}, {"omega1": table})

    exact, unread = pairs(exact_route.features["omega1"]), pairs(unrounded)
    read = {
        one: pairs(unrounded, *one.keys)
        for one in _READ
        if any(configured.get(key) is not None for key in one.keys)
    }

    def sentence(row: Row) -> str:
        def value(tables: RouteTables) -> float:
            return tables.estimate(COLUMN_OF[row.symbol], row.approach, pair=row.line)

        shifts = {"the simulation": value(unread) - value(exact)}
        for one, tables in read.items():
            shifts[_as_read(one, tables, row.line)] = value(tables) - value(unread)
        if not all(map(math.isfinite, shifts.values())):
            return ""
        in_order = sorted(shifts, key=lambda what: -abs(shifts[what]))
        shares = (
            f"{what} ({shifts[what]:+.{row.number.decimals + 1}f} {row.unit})"
            for what in in_order
            if what == in_order[0] or abs(shifts[what]) >= 0.5 * row.number.unit
        )
        return f"What moves it: {', '.join(shares)}."

    return sentence


def _as_read(one: _Read, tables: RouteTables, label: str) -> str:
    """How a feature reads at the levels of a pair; once if it reads the same."""
    values = (
        one.scale * math.fsum(tables.feature(column, int(level)) for column in one.columns)
        for level in label.split("-")
    )
    return f"{one.words} {' and '.join(dict.fromkeys(map(one.shown.format, values)))}"
