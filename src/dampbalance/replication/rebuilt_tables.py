"""The paper's tables, rebuilt: for each cell what is printed, what the as-published route gives, and what is exact.

A table of the paper is a frame with a row per cell (columns COLUMNS), rows of the table of numbers in the order of
print; `markdown` lays it out as the paper does, with a line per route. The printed numbers come from the claims, so a
case without a paper to compare with has none.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import pandas as pd

from ..project.wording import label_with_unit, markdown_table
from .claims.verdicts import VERDICTS
from .numbers import (
    COEFFICIENTS,
    HARMONIC_APPROACHES,
    PRINTED_APPROACHES,
    TABLE_1,
    TABLE_2,
    Numbers,
    key_of,
)

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


_FORMATS = {
    **{"X": ".7f", "X_s": ".7f", "V_s": ".7f", "phi": ".5f", "t_s": ".4e"},
    **{"a": ".9f", "b": ".10f", "W": ".9f"},
    **{"F_k": ".6f", "c": ".4f", "residual": ".4e"},
}
"""Quantity → how to write it."""


def paper_tables(numbers: Numbers, frequency: str) -> dict[str, pd.DataFrame]:
    """Return Tables 1 to 3 and the statistics of the text at one frequency, by the names of TITLES.

    A table is a frame with a row per cell; columns: COLUMNS, the `symbol` of the quantity, the `id` of its claim.
    Table 1 : X, X_s, V_s, φ and t_s of every level.
    Table 2 : a, b and W of every level, and F_k and c of every pair of levels by direct integration.
    Table 3 : F_k and c of every pair by the three harmonic approaches, with φ and t_s common to all levels.
    Statistics : least squares with its residual, and mean and standard deviation of the pairs.

    numbers : with what is printed and its verdict, if anything is (`numbers.with_claims`).
    """
    levels = [key.line for key in numbers if key[:4] == (frequency, "Y", "", "level")]
    labels = [key.line for key in numbers if key[:4] == (frequency, "F_k", "direct", "pair")]

    def cells(
        kind: str, row: str, symbols: Iterable[str], approach: str = "", line: str = "all"
    ) -> Iterator[dict[str, object]]:
        for symbol in symbols:
            key = key_of(frequency, symbol, approach, kind, line)
            found = numbers.get(key, {})
            yield {
                "row": row,
                "quantity": f"{symbol} by {approach}" if kind == "pair" and key.sharing else symbol,
                "unit": key.unit,
                **{column: found.get(column, "") for column in ("printed", "verdict")},
                **{route: found.get(route, math.nan) for route in SHOWN_ROUTES},
                "symbol": symbol,
                "id": found.get("id", ""),
            }

    def of_levels(symbols: Iterable[str]) -> Iterator[dict[str, object]]:
        for level in levels:
            Y = numbers[key_of(frequency, "Y", line=level)]["exact"]
            yield from cells("level", f"{1e3 * Y:g} mm", symbols, line=level)

    def of_pairs(approaches: Iterable[str]) -> Iterator[dict[str, object]]:
        for approach in approaches:
            for label in labels:
                yield from cells("pair", f"pair {label}", COEFFICIENTS, approach, label)

    def of_all() -> Iterator[dict[str, object]]:
        for approach in PRINTED_APPROACHES:
            yield from cells(
                "least_squares", f"{approach}, least squares", (*COEFFICIENTS, "residual"), approach
            )
            for kind in ("mean", "std"):
                yield from cells(kind, f"{approach}, {kind}", COEFFICIENTS, approach)

    tables = {
        "table1": of_levels(TABLE_1),
        "table2": [*of_levels(TABLE_2), *of_pairs(("direct",))],
        "table3": of_pairs(HARMONIC_APPROACHES),
        "statistics": of_all(),
    }
    columns = [*COLUMNS, "symbol", "id"]
    return {name: pd.DataFrame(list(of), columns=columns) for name, of in tables.items()}


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


def _shown(cell: pd.Series, source: str) -> str:
    if source == "printed":
        mark = VERDICTS[cell["verdict"]].mark if cell["verdict"] else ""
        return f"{cell['printed']} {mark}".strip()
    value = cell[source]
    return "–" if pd.isna(value) else format(value, _FORMATS[cell["symbol"]])
