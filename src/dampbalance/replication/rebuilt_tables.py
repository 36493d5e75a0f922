"""The paper's tables, rebuilt: for each cell what is printed, what the as-published route gives, and what is exact.

A route, a way in which the paper's numbers are computed, has result tables, in which single numbers are looked up
(`RouteTables`). A table of the paper is a frame with a row per cell (columns COLUMNS), which is what the CSV holds;
`markdown` lays it out as the paper does, with a line per route. The printed numbers come from the claims, so a case
without a paper to compare with has none.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ..balance import TERMS
from ..estimates import estimate_columns
from ..project.wording import label_with_unit, markdown_table
from .claims.verdicts import STATISTICS, VERDICTS, of_cell, of_text, statistic

PRINTED_APPROACHES = ("direct", "t_s", "X_s", "V_s")
"""The approaches that the paper prints estimates of, in the order of Tables 2 and 3."""

HARMONIC = PRINTED_APPROACHES[1:]

_NOTHING = pd.DataFrame(columns=estimate_columns(), dtype=float)


@dataclass(frozen=True)
class RouteTables:
    """The result tables of one route, by frequency name.

    features : `Features.to_frame()`, one row per level.   estimates : `estimates.estimate_table`.

    Estimates are looked up as the paper has them: with φ and t_s common to all levels for the pairs of the harmonic
    approaches, individual for all others. A number that a route does not have is NaN.
    """

    features: Mapping[str, pd.DataFrame]
    estimates: Mapping[str, pd.DataFrame]

    def feature(self, column: str, level: int, frequency: str = "omega1") -> float:
        """Return a feature of the level counted from 1."""
        values = list(self.features.get(frequency, _NOTHING).get(column, ()))
        return float(values[level - 1]) if level <= len(values) else math.nan

    def mean_feature(self, column: str) -> float:
        """Return the mean of a feature at ω1 over the levels that have it."""
        frame = self.features.get("omega1", _NOTHING)
        return float(frame[column].mean()) if column in frame else math.nan

    def estimate(
        self,
        column: str,
        approach: str,
        kind: str = "pair",
        pair: str = "all",
        frequency: str = "omega1",
    ) -> float:
        """Return one number of the estimates."""
        line = self._lines.get((frequency, approach, kind, pair))
        return math.nan if line is None else float(line[column])

    def pairs(
        self, approaches: tuple[str, ...] = HARMONIC, frequency: str = "omega1"
    ) -> pd.DataFrame:
        """Return the estimates of all pairs by some approaches."""
        frame = self._in_paper.get(frequency, _NOTHING)
        return frame[frame["approach"].isin(approaches) & (frame["kind"] == "pair")]

    @cached_property
    def _lines(self) -> dict[tuple[str, ...], dict[Hashable, Any]]:
        """The lines of the estimates by frequency, approach, kind and pair."""
        return {
            (frequency, line["approach"], line["kind"], line["pair"]): line
            for frequency, frame in self._in_paper.items()
            for line in frame.to_dict("records")
        }

    @cached_property
    def _in_paper(self) -> dict[str, pd.DataFrame]:
        """The estimates that are looked up, by frequency."""
        return {frequency: _as_in_paper(frame) for frequency, frame in self.estimates.items()}


def _as_in_paper(frame: pd.DataFrame) -> pd.DataFrame:
    individual = (frame["approach"] == "direct") | (frame["kind"] == "least_squares")
    return frame[frame["phase"] == np.where(individual, "individual", "common")]


COLUMNS = ("row", "quantity", "unit", "printed", "as_published", "exact", "verdict")
SHOWN_ROUTES = ("as_published", "exact")

TITLES = {
    "table1": "Table 1: amplitudes, slip onset and phase",
    "table2": "Table 2: energy integrals and estimates by direct integration",
    "table3": "Table 3: estimates of the harmonic approaches, phase and slip time common to all levels",
    "statistics": "Least squares, and mean and standard deviation of the pairs",
    "approaches": "Errors of F_k and c by every approach, phase and frequency",
}
"""The title of each table, wherever it is shown."""


class Quantity(NamedTuple):
    """A column of a printed table: symbol, unit, its column in the result files and the digits to show of it."""

    symbol: str
    unit: str
    column: str
    format: str


TABLE_1 = (
    Quantity("X", "m", "X_m", ".7f"),
    Quantity("X_s", "m", "X_s_m", ".7f"),
    Quantity("V_s", "m/s", "V_s_m_per_s", ".7f"),
    Quantity("phi", "rad", "phi_rad", ".5f"),
    Quantity("t_s", "s", "t_s_s", ".4e"),
)
TABLE_2 = (
    Quantity("a", "m", "a_m", ".9f"),
    Quantity("b", "m^2/s", "b_m2_per_s", ".10f"),
    Quantity("W", "J", "W_J", ".9f"),
)
IDENTIFIED_QUANTITIES = tuple(
    Quantity(symbol, TERMS[symbol].unit, TERMS[symbol].column, digits)
    for symbol, digits in (("F_k", ".6f"), ("c", ".4f"))
)
RESIDUAL = Quantity("residual", "1", "residual", ".4e")
COLUMN_OF = {q.symbol: q.column for q in (*TABLE_1, *TABLE_2, *IDENTIFIED_QUANTITIES, RESIDUAL)}
_FORMATS = {q.symbol: q.format for q in (*TABLE_1, *TABLE_2, *IDENTIFIED_QUANTITIES, RESIDUAL)}
_FORMATS |= {f"{q.symbol} by {a}": q.format for q in IDENTIFIED_QUANTITIES for a in HARMONIC}


def paper_tables(
    routes: Mapping[str, RouteTables], frequency: str, claims: pd.DataFrame | None = None
) -> dict[str, pd.DataFrame]:
    """Return Tables 1 to 3 and the statistics of the text at one frequency, by the names of TITLES.

    A table is a frame with a row per cell and the columns COLUMNS.
    Table 1 : X, X_s, V_s, φ and t_s of every level.
    Table 2 : a, b and W of every level, and F_k and c of every pair of levels by direct integration.
    Table 3 : F_k and c of every pair by the three harmonic approaches, with φ and t_s common to all levels.
    Statistics : least squares with its residual, and mean and standard deviation of the pairs.

    routes : result tables by the names of SHOWN_ROUTES.
    claims : their table, for printed numbers and verdicts; None for a frequency at which the paper prints no tables.
    """
    levels = routes["exact"].features[frequency]["Y_m"]
    labels = dict.fromkeys(routes["exact"].pairs(("direct",), frequency)["pair"])

    def features(quantities: Iterable[Quantity]) -> list[_Cell]:
        return [
            _Cell(f"{1e3 * Y:g} mm", q.symbol, q, {"level": level})
            for level, Y in enumerate(levels, 1)
            for q in quantities
        ]

    def pairs(approach: str, ending: str = "") -> list[_Cell]:
        return [
            _Cell(f"pair {pair}", f"{q.symbol}{ending}", q, {"approach": approach, "pair": pair})
            for pair in labels
            for q in IDENTIFIED_QUANTITIES
        ]

    cells = {
        "table1": features(TABLE_1),
        "table2": features(TABLE_2) + pairs("direct"),
        "table3": [cell for name in HARMONIC for cell in pairs(name, f" by {name}")],
        "statistics": [
            _Cell(f"{a}, {kind.replace('_', ' ')}", q.symbol, q, {"approach": a, "kind": kind})
            for a in PRINTED_APPROACHES
            for kind in STATISTICS
            for q in (*IDENTIFIED_QUANTITIES, RESIDUAL)
            if q != RESIDUAL or kind == "least_squares"
        ],
    }
    judged = {} if claims is None else claims.set_index("id").to_dict("index")
    tables = {}
    for name, of_table in cells.items():
        places = {row: place for place, row in enumerate(dict.fromkeys(c.row for c in of_table), 1)}
        records = []
        for row, quantity, q, which in of_table:
            claim = judged.get(claim_of(name, row, places[row], quantity), {})
            printed, verdict = (claim.get(column, "") for column in ("printed", "verdict"))
            numbers = (
                (route.feature if "level" in which else route.estimate)(
                    q.column, frequency=frequency, **which
                )
                for route in (routes[shown] for shown in SHOWN_ROUTES)
            )
            records.append((row, quantity, q.unit, printed, *numbers, verdict))
        tables[name] = pd.DataFrame.from_records(records, columns=list(COLUMNS))
    return tables


def claim_of(name: str, row: str, place: int, quantity: str) -> str:
    """Return the id of the claim on a cell, whether or not there is such a claim.

    name : of the table, statistics among them.   place : of the row in it, from 1, which counts the levels.
    """
    symbol, _, approach = quantity.partition(" by ")
    if name == "statistics":
        approach, _, kind = row.partition(", ")
        return of_text(statistic(symbol, approach, kind.replace(" ", "_")))
    pair = row.removeprefix("pair ")
    return of_cell(name, symbol, place if pair == row else pair, approach)


def markdown(table: pd.DataFrame, title: str) -> str:
    """Return the table as the paper lays it out, in Markdown: a line per route, with marks for the verdicts."""
    parts = [f"# {title}", ""]
    for quantities, block in blocks(table):
        units = block["unit"]  # the units of the first row come first
        heads = [label_with_unit(q, unit) for q, unit in zip(quantities, units, strict=False)]
        lines = []
        for row, cells in block.groupby("row", sort=False):
            label = str(row)
            for source in ("printed", *SHOWN_ROUTES):
                if source == "printed" and (cells["printed"] == "").all():
                    continue
                shown = [_shown(cell, source) for _, cell in cells.iterrows()]
                lines.append([label, source.replace("_", " "), *shown])
                label = ""
        parts += [markdown_table(["", "", *heads], lines, "ll" + "r" * len(heads)), ""]
    if (table["verdict"] != "").any():
        marks = ", ".join(f"{verdict.mark} {name}" for name, verdict in VERDICTS.items())
        parts += [f"Marks on printed numbers: {marks}. Reasons: claims.md.", ""]
    return "\n".join(parts)


def blocks(table: pd.DataFrame) -> Iterator[tuple[list[str], pd.DataFrame]]:
    """Return the runs of rows that share their quantities: the upper and lower part of Table 2 have different ones."""
    by_row = table.groupby("row", sort=False)["quantity"].agg(tuple)
    for quantities in dict.fromkeys(by_row):
        rows = by_row.index[by_row == quantities]
        yield list(quantities), table[table["row"].isin(rows)]


class _Cell(NamedTuple):
    row: str
    quantity: str
    column: Quantity
    which: Mapping[str, Any]  # arguments of RouteTables.feature or .estimate


def _shown(cell: pd.Series, source: str) -> str:
    if source == "printed":
        mark = VERDICTS[cell["verdict"]].mark if cell["verdict"] else ""
        return f"{cell['printed']} {mark}".strip()
    value = cell[source]
    return "–" if pd.isna(value) else format(value, _FORMATS[cell["quantity"]])
