"""The paper's tables, rebuilt: for each cell what is printed, what the as-published route gives, and what is exact.

A table is a frame with a row per cell (columns COLUMNS), which is what the CSV holds; `markdown` lays it out as the
paper does, with a line per route. The printed numbers come from the claims, so a case without a paper to compare
with has none.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import pandas as pd

from ..balance import TERMS
from ..project.wording import markdown_table
from .claim_ids import of_cell, of_text, statistic
from .verdicts import VERDICTS

COLUMNS = ("row", "quantity", "unit", "printed", "as_published", "exact", "verdict")
SHOWN_ROUTES = ("as_published", "exact")

Frames = Mapping[str, pd.DataFrame]


TITLES = {
    "table1": "Table 1: amplitudes, slip onset and phase",
    "table2": "Table 2: energy integrals and estimates by direct integration",
    "table3": "Table 3: estimates of the harmonic approaches, phase and slip time common to all levels",
    "statistics": "Least squares, and mean and standard deviation of the pairs",
    "approaches": "Errors of F_k and c by every approach, phase and frequency",
}
"""The title of each table, wherever it is shown."""


class Quantity(NamedTuple):
    """A column of a printed table: symbol, what it is, unit, column in the result file and the digits to show of it."""

    symbol: str
    words: str
    unit: str
    column: str
    format: str


TABLE_1 = (
    Quantity("X", "peak displacement", "m", "X_m", ".7f"),
    Quantity("X_s", "displacement at forward slip onset", "m", "X_s_m", ".7f"),
    Quantity("V_s", "velocity at forward slip onset", "m/s", "V_s_m_per_s", ".7f"),
    Quantity("phi", "phase between input and output", "rad", "phi_rad", ".5f"),
    Quantity("t_s", "time of forward slip onset", "s", "t_s_s", ".4e"),
)
TABLE_2 = (
    Quantity("a", "friction travel", "m", "a_m", ".9f"),
    Quantity("b", "viscous integral", "m^2/s", "b_m2_per_s", ".10f"),
    Quantity("W", "input work", "J", "W_J", ".9f"),
)
UNKNOWNS = tuple(
    Quantity(symbol, TERMS[symbol].words, TERMS[symbol].unit, TERMS[symbol].column, digits)
    for symbol, digits in (("F_k", ".6f"), ("c", ".4f"))
)
RESIDUAL = Quantity("residual", "residual", "1", "residual", ".4e")
PRINTED_APPROACHES = ("direct", "t_s", "X_s", "V_s")  # in the order of Tables 2 and 3
_FORMATS = {q.symbol: q.format for q in (*TABLE_1, *TABLE_2, *UNKNOWNS, RESIDUAL)}


def table1(features: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """Table 1: X, X_s, V_s, φ and t_s of every level.

    features : `Features.to_frame` by route.   claims : their table, for the printed numbers, or None.
    """
    return _frame("table1", _levels(features, TABLE_1), claims)


def table2(features: Frames, estimates: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """Table 2: a, b, W of every level, and F_k and c of every pair by direct integration.

    estimates : `estimates.estimate_table` by route; the others as in `table1`.
    """
    cells = [*_levels(features, TABLE_2), *_pairs(estimates, "direct")]
    return _frame("table2", cells, claims)


def table3(estimates: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """Table 3: F_k and c of every pair by the three harmonic approaches, with φ and t_s common to all levels."""
    cells = [cell for name in PRINTED_APPROACHES[1:] for cell in _pairs(estimates, name)]
    return _frame("table3", cells, claims)


def statistics(estimates: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """The statistics of the text: least squares with its residual, and mean and standard deviation over the pairs."""
    cells = []
    for approach in PRINTED_APPROACHES:
        pairwise = "individual" if approach == "direct" else "common"
        for kind, phase, quantities in (
            ("least_squares", "individual", (*UNKNOWNS, RESIDUAL)),
            ("mean", pairwise, UNKNOWNS),
            ("std", pairwise, UNKNOWNS),
        ):
            chosen = {
                route: _lines(estimates[route], approach, kind, phase) for route in SHOWN_ROUTES
            }
            row = f"{approach}, {kind.replace('_', ' ')}"
            for q in quantities:
                values = {route: _only(frame, q.column) for route, frame in chosen.items()}
                cells.append(_Cell(row, q.symbol, q.unit, values))
    return _frame("statistics", cells, claims)


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


def _levels(features: Frames, quantities: Iterable[Quantity]) -> Iterator[_Cell]:
    for i, Y in enumerate(features["exact"]["Y_m"]):
        for q in quantities:
            values = {route: float(features[route][q.column].iloc[i]) for route in SHOWN_ROUTES}
            yield _Cell(f"{1e3 * Y:g} mm", q.symbol, q.unit, values)


def _pairs(estimates: Frames, approach: str) -> Iterator[_Cell]:
    phase = "individual" if approach == "direct" else "common"
    chosen = {route: _lines(estimates[route], approach, "pair", phase) for route in SHOWN_ROUTES}
    for pair in chosen["exact"]["pair"]:
        for q in UNKNOWNS:
            values = {
                r: _only(frame[frame["pair"] == pair], q.column) for r, frame in chosen.items()
            }
            quantity = q.symbol if approach == "direct" else f"{q.symbol} by {approach}"
            yield _Cell(f"pair {pair}", quantity, q.unit, values)


def _lines(estimates: pd.DataFrame, approach: str, kind: str, phase: str) -> pd.DataFrame:
    wanted = (estimates["approach"] == approach) & (estimates["kind"] == kind)
    return estimates[wanted & (estimates["phase"] == phase)]


def _only(frame: pd.DataFrame, column: str) -> float:
    return float(frame[column].iloc[0]) if len(frame) else float("nan")


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
