"""The paper's tables, rebuilt: for each cell what is printed, what the as-published route gives, and what is exact.

A table is a frame with a row per cell (columns COLUMNS), which is what the CSV holds; `markdown` lays it out as the
paper does, with a line per route. The printed numbers come from the claims, so a case without a paper to compare
with has none.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import pandas as pd

from ..balance import TERMS
from ..project.wording import markdown_table
from .claim_ids import of_cell, of_text, statistic
from .claim_verdicts import VERDICTS
from .route_tables import HARMONIC, PRINTED_APPROACHES, RouteTables

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
UNKNOWNS = tuple(
    Quantity(symbol, TERMS[symbol].unit, TERMS[symbol].column, digits)
    for symbol, digits in (("F_k", ".6f"), ("c", ".4f"))
)
RESIDUAL = Quantity("residual", "1", "residual", ".4e")
COLUMN_OF = {q.symbol: q.column for q in (*TABLE_1, *TABLE_2, *UNKNOWNS, RESIDUAL)}
_FORMATS = {q.symbol: q.format for q in (*TABLE_1, *TABLE_2, *UNKNOWNS, RESIDUAL)}


def paper_tables(
    routes: Mapping[str, RouteTables], frequency: str, claims: pd.DataFrame | None = None
) -> dict[str, pd.DataFrame]:
    """Tables 1 to 3 and the statistics of the text at one frequency, by the names of TITLES.

    A table is a frame with a row per cell and the columns COLUMNS.
    Table 1 : X, X_s, V_s, φ and t_s of every level.
    Table 2 : a, b and W of every level, and F_k and c of every pair of levels by direct integration.
    Table 3 : F_k and c of every pair by the three harmonic approaches, with φ and t_s common to all levels.
    Statistics : least squares with its residual, and mean and standard deviation of the pairs.

    routes : result tables by the names of SHOWN_ROUTES.
    claims : their table, for printed numbers and verdicts; None for a frequency at which the paper prints no tables.
    """
    at = _At(routes, frequency)
    cells = {
        "table1": at.levels(TABLE_1),
        "table2": [*at.levels(TABLE_2), *at.pairs("direct")],
        "table3": [cell for approach in HARMONIC for cell in at.pairs(approach)],
        "statistics": at.statistics(),
    }
    return {name: _frame(name, of_table, claims) for name, of_table in cells.items()}


def claim_of(name: str, row: str, place: int, quantity: str) -> str:
    """The id of the claim on a cell, whether or not there is such a claim.

    name : of the table, statistics among them.   place : of the row in it, from 1, which counts the levels.
    """
    symbol, _, approach = quantity.partition(" by ")
    if name == "statistics":
        approach, _, kind = row.partition(", ")
        return of_text(statistic(symbol, approach, kind.replace(" ", "_")))
    pair = row.removeprefix("pair ")
    return of_cell(name, symbol, place if pair == row else pair, approach)


def markdown(table: pd.DataFrame, title: str) -> str:
    """The table as the paper lays it out, a line per route, with marks for the verdicts; GitHub-flavoured Markdown."""
    parts = [f"# {title}", ""]
    for quantities, block in blocks(table):
        units = [block.loc[block["quantity"] == q, "unit"].iloc[0] for q in quantities]
        heads = [
            q if unit == "1" else f"{q} ({unit})" for q, unit in zip(quantities, units, strict=True)
        ]
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
    """Runs of rows that share their quantities: the upper and lower part of Table 2 have different ones."""
    by_row = table.groupby("row", sort=False)["quantity"].agg(tuple)
    for quantities in dict.fromkeys(by_row):
        rows = by_row.index[by_row == quantities]
        yield list(quantities), table[table["row"].isin(rows)]


class _Cell(NamedTuple):
    row: str
    quantity: str
    unit: str
    values: dict[str, float]


@dataclass(frozen=True, slots=True)
class _At:
    """Cells of tables at a frequency, by the routes that are shown."""

    routes: Mapping[str, RouteTables]
    frequency: str

    def levels(self, quantities: Iterable[Quantity]) -> Iterator[_Cell]:
        """The quantities at every level."""
        for level, Y in enumerate(self.routes["exact"].features[self.frequency]["Y_m"], 1):
            for q in quantities:
                values = {
                    name: self.routes[name].feature(q.column, level, self.frequency)
                    for name in SHOWN_ROUTES
                }
                yield _Cell(f"{1e3 * Y:g} mm", q.symbol, q.unit, values)

    def pairs(self, approach: str) -> Iterator[_Cell]:
        """F_k and c of every pair by an approach."""
        estimates = self.routes["exact"].estimates[self.frequency]
        for pair in dict.fromkeys(estimates.loc[estimates["kind"] == "pair", "pair"]):
            for q in UNKNOWNS:
                quantity = q.symbol if approach == "direct" else f"{q.symbol} by {approach}"
                values = self._estimate(q, approach, "pair", pair)
                yield _Cell(f"pair {pair}", quantity, q.unit, values)

    def statistics(self) -> Iterator[_Cell]:
        """The statistics over all levels or pairs, approach by approach."""
        for approach in PRINTED_APPROACHES:
            for kind in ("least_squares", "mean", "std"):
                row = f"{approach}, {kind.replace('_', ' ')}"
                for q in (*UNKNOWNS, RESIDUAL) if kind == "least_squares" else UNKNOWNS:
                    yield _Cell(row, q.symbol, q.unit, self._estimate(q, approach, kind))

    def _estimate(
        self, q: Quantity, approach: str, kind: str, pair: str = "all"
    ) -> dict[str, float]:
        common = approach != "direct" and kind != "least_squares"
        which = {"kind": kind, "phase": "common" if common else "individual", "pair": pair}
        return {
            name: self.routes[name].estimate(q.column, approach, frequency=self.frequency, **which)
            for name in SHOWN_ROUTES
        }


def _frame(name: str, cells: Iterable[_Cell], claims: pd.DataFrame | None) -> pd.DataFrame:
    judged: dict[str, tuple[str, str]] = {}
    if claims is not None:
        judged = dict(
            zip(claims["id"], zip(claims["printed"], claims["verdict"], strict=True), strict=True)
        )
    places: dict[str, int] = {}
    records = []
    for row, quantity, unit, values in cells:
        place = places.setdefault(row, len(places) + 1)
        printed, verdict = judged.get(claim_of(name, row, place, quantity), ("", ""))
        head = {"row": row, "quantity": quantity, "unit": unit}
        records.append({**head, **values, "printed": printed, "verdict": verdict})
    return pd.DataFrame.from_records(records, columns=list(COLUMNS))


def _shown(cell: pd.Series, source: str) -> str:
    if source == "printed":
        mark = VERDICTS[cell["verdict"]].mark if cell["verdict"] else ""
        return f"{cell['printed']} {mark}".strip()
    value = cell[source]
    return "–" if pd.isna(value) else format(value, _FORMATS[cell["quantity"].split(" by ")[0]])
