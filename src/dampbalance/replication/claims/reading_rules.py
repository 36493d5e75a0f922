"""Which rule of reading is at work in a number of Table 3, and by how much it moves it.

The simulation moves a pair from its exact value; then each rule of the configured `two_point` section is applied alone
to the result of the simulation, and the shift of the pair is its share. The rest is interaction between the rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from ...estimates import estimate_table
from ...features import Features
from ..as_published import APPROACHES_OF_TABLE_3
from ..printed import Printed
from ..printed_tables import COLUMN_OF
from ..readout import ReadOut
from ..route_tables import RouteTables
from .inputs import Sources
from .published import PAIRS, Row

_RULES = {
    "X": ("X_decimals",),
    "X_s": ("X_s_mark_m", "X_s_decimals"),
    "V_s": ("V_s_decimals",),
    "t_s": ("t_s_inset_s", "t_s_unit_s", "common_t_s_decimals"),
    "phi": ("phi_decimals", "common_phi_decimals"),
}
"""Each feature that is read, with the keys of the configuration for its rules of reading."""


def rules_at_work(sources: Sources) -> Callable[[Row], str]:
    """A function of a row that says what moves that number of Table 3 from exact, in a sentence.

    Named are the largest share, and every other that moves the number by half a unit of its last printed digit.
    """
    if "omega1" not in sources.exact.features or sources.unrounded.empty:
        return lambda row: ""
    k, configured = sources.case.oscillator.k, sources.case.numerics.two_point
    simulated = Features.from_frame(sources.unrounded)
    exact = Features.from_frame(sources.exact.features["omega1"])

    def pairs(features: Features, rules: ReadOut) -> RouteTables:
        read = rules.common(features)
        table = estimate_table(
            features, k, PAIRS, common=read, common_approaches=APPROACHES_OF_TABLE_3
        )
        return RouteTables({"omega1": read.to_frame()}, {"omega1": table})

    by_nobody, unread = pairs(exact, ReadOut()), pairs(simulated, ReadOut())
    read = {
        what: pairs(simulated, ReadOut.from_config({key: configured.get(key) for key in keys}))
        for what, keys in _RULES.items()
        if any(configured.get(key) is not None for key in keys)
    }

    def sentence(row: Row) -> str:
        number = Printed(row.printed)

        def value(tables: RouteTables) -> float:
            column = COLUMN_OF[row.symbol]
            return tables.estimate(column, row.approach, phase="common", pair=row.line)

        shifts = {"the simulation": value(unread) - value(by_nobody)}
        for what, tables in read.items():
            shifts[_as_read(what, tables, row.line)] = value(tables) - value(unread)
        if not all(map(math.isfinite, shifts.values())):
            return ""
        largest = max(shifts, key=lambda what: abs(shifts[what]))
        named = [
            what
            for what, shift in shifts.items()
            if what == largest or abs(shift) >= 0.5 * number.unit
        ]
        shares = (
            f"{what} ({shifts[what]:+.{number.decimals + 1}f} {row.unit})"
            for what in sorted(named, key=lambda what: -abs(shifts[what]))
        )
        return f"What moves it: {', '.join(shares)}."

    return sentence


def _as_read(what: str, tables: RouteTables, label: str) -> str:
    """How a rule reads, with the numbers that come of it, for the levels of a pair."""
    i, j = map(int, label.split("-"))

    def both(column: str) -> tuple[float, float]:
        return tables.feature(column, i), tables.feature(column, j)

    if what == "X":
        return "X read as {:g} mm and {:g} mm".format(*(1e3 * X for X in both("X_m")))
    if what == "X_s":
        lengths = (1e6 * (X + X_s) for X, X_s in zip(both("X_m"), both("X_s_m"), strict=True))
        return f"X + X_s read as {' and '.join(dict.fromkeys(f'{one:.4g} µm' for one in lengths))}"
    if what == "t_s":
        return f"one t_s of {1e3 * both('t_s_s')[0]:g} ms"
    if what == "phi":
        return f"one phi of {both('phi_rad')[0]:.6g} rad"
    return "V_s read as {:g} mm/s and {:g} mm/s".format(*(1e3 * V for V in both("V_s_m_per_s")))
