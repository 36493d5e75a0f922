"""The paper's tables, rebuilt: for each cell what is printed, what the as-published route gives, and what is exact.

A table is a frame with a row per cell (columns COLUMNS), which is what the CSV holds; `markdown` lays it out as the
paper does, with a line per route. The printed numbers come from the claims, so a case without a paper to compare
with has none.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import pandas as pd

COLUMNS = ("row", "quantity", "unit", "printed", "as_published", "exact", "verdict")
ROUTES = ("as_published", "exact")
MARKS = {
    "reproduced": "✓",
    "reconstructed": "≈",
    "last digit": "±1",
    "reading": "r",
    "differs": "✗",
}

Frames = Mapping[str, pd.DataFrame]


class _Quantity(NamedTuple):
    """A column of a printed table: its symbol, unit, column in the result file and the digits to show of it."""

    symbol: str
    unit: str
    column: str
    format: str


_TABLE_1 = (
    _Quantity("X", "m", "X_m", ".7f"),
    _Quantity("X_s", "m", "X_s_m", ".7f"),
    _Quantity("V_s", "m/s", "V_s_m_per_s", ".7f"),
    _Quantity("phi", "rad", "phi_rad", ".5f"),
    _Quantity("t_s", "s", "t_s_s", ".4e"),
)
_TABLE_2 = (
    _Quantity("a", "m", "a_m", ".9f"),
    _Quantity("b", "m^2/s", "b_m2_per_s", ".10f"),
    _Quantity("W", "J", "W_J", ".9f"),
)
_UNKNOWNS = (
    _Quantity("F_k", "N", "F_k_N", ".6f"),
    _Quantity("c", "N s/m", "c_N_s_per_m", ".4f"),
)
_RESIDUAL = _Quantity("residual", "1", "residual", ".4e")
_APPROACHES = ("direct", "t_s", "X_s", "V_s")
_FORMATS = {q.symbol: q.format for q in (*_TABLE_1, *_TABLE_2, *_UNKNOWNS, _RESIDUAL)}


def table1(features: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """Table 1: X, X_s, V_s, φ and t_s of every level.

    features : `Features.to_frame` by route.   claims : their table, for the printed numbers, or None.
    """
    return _frame(_levels(features, _TABLE_1, "table1"), claims)


def table2(features: Frames, estimates: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """Table 2: a, b, W of every level, and F_k and c of every pair by direct integration.

    estimates : `identify.estimate_table` by route; the others as in `table1`.
    """
    cells = [*_levels(features, _TABLE_2, "table2"), *_pairs(estimates, "direct", "table2")]
    return _frame(cells, claims)


def table3(estimates: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """Table 3: F_k and c of every pair by the three harmonic approaches, with φ and t_s common to all levels."""
    cells = [c for name in _APPROACHES[1:] for c in _pairs(estimates, name, f"table3.{name}")]
    return _frame(cells, claims)


def statistics(estimates: Frames, claims: pd.DataFrame | None = None) -> pd.DataFrame:
    """The statistics of the text: least squares with its residual, and mean and standard deviation over the pairs."""
    cells = []
    for approach in _APPROACHES:
        pairwise = "individual" if approach == "direct" else "common"
        for kind, phase, quantities in (
            ("least_squares", "individual", (*_UNKNOWNS, _RESIDUAL)),
            ("mean", pairwise, _UNKNOWNS),
            ("std", pairwise, _UNKNOWNS),
        ):
            chosen = {route: _lines(estimates[route], approach, kind, phase) for route in ROUTES}
            for quantity in quantities:
                suffix = {"least_squares": "ls", "mean": "mean", "std": "std"}[kind]
                symbol = quantity.symbol
                values = {r: _only(frame, quantity.column) for r, frame in chosen.items()}
                cells.append(
                    _Cell(
                        f"text.{symbol}_{approach.replace('_', '')}_{suffix}",
                        f"{approach}, {kind.replace('_', ' ')}",
                        symbol,
                        quantity.unit,
                        values,
                    )
                )
    return _frame(cells, claims)


def markdown(table: pd.DataFrame, title: str) -> str:
    """The table as the paper lays it out, a line per route, with marks for the verdicts; GitHub-flavoured Markdown."""
    parts = [f"# {title}", ""]
    for quantities, block in _blocks(table):
        units = [block.loc[block["quantity"] == q, "unit"].iloc[0] for q in quantities]
        heads = [
            q if unit == "1" else f"{q} ({unit})" for q, unit in zip(quantities, units, strict=True)
        ]
        parts += ["| | | " + " | ".join(heads) + " |", "|---|---|" + "---:|" * len(quantities)]
        for row, cells in block.groupby("row", sort=False):
            label = str(row)
            for source in ("printed", *ROUTES):
                if source == "printed" and (cells["printed"] == "").all():
                    continue
                shown = [_shown(cell, source) for _, cell in cells.iterrows()]
                parts.append(f"| {label} | {source.replace('_', ' ')} | {' | '.join(shown)} |")
                label = ""
        parts.append("")
    if (table["verdict"] != "").any():
        marks = ", ".join(f"{mark} {verdict}" for verdict, mark in MARKS.items())
        parts += [f"Marks on printed numbers: {marks}. Reasons: claims.md.", ""]
    return "\n".join(parts)


class _Cell(NamedTuple):
    id: str
    row: str
    quantity: str
    unit: str
    values: dict[str, float]


def _levels(features: Frames, quantities: Iterable[_Quantity], name: str) -> Iterator[_Cell]:
    levels = features["exact"]["Y_m"]
    for i, Y in enumerate(levels):
        for q in quantities:
            values = {route: float(features[route][q.column].iloc[i]) for route in ROUTES}
            yield _Cell(f"{name}.{q.symbol}.{i + 1}", f"{1e3 * Y:g} mm", q.symbol, q.unit, values)


def _pairs(estimates: Frames, approach: str, name: str) -> Iterator[_Cell]:
    phase = "individual" if approach == "direct" else "common"
    chosen = {route: _lines(estimates[route], approach, "pair", phase) for route in ROUTES}
    for pair in chosen["exact"]["pair"]:
        for q in _UNKNOWNS:
            values = {
                r: _only(frame[frame["pair"] == pair], q.column) for r, frame in chosen.items()
            }
            quantity = q.symbol if approach == "direct" else f"{q.symbol} by {approach}"
            yield _Cell(f"{name}.{q.symbol}.{pair}", f"pair {pair}", quantity, q.unit, values)


def _lines(estimates: pd.DataFrame, approach: str, kind: str, phase: str) -> pd.DataFrame:
    wanted = (estimates["approach"] == approach) & (estimates["kind"] == kind)
    return estimates[wanted & (estimates["phase"] == phase)]


def _only(frame: pd.DataFrame, column: str) -> float:
    return float(frame[column].iloc[0]) if len(frame) else float("nan")


def _frame(cells: Iterable[_Cell], claims: pd.DataFrame | None) -> pd.DataFrame:
    printed = (
        {} if claims is None else claims.set_index("id")[["printed", "verdict"]].to_dict("index")
    )
    nothing = {"printed": "", "verdict": ""}
    records = [
        {
            "row": c.row,
            "quantity": c.quantity,
            "unit": c.unit,
            **c.values,
            **printed.get(c.id, nothing),
        }
        for c in cells
    ]
    return pd.DataFrame.from_records(records, columns=list(COLUMNS))


def _blocks(table: pd.DataFrame) -> Iterator[tuple[list[str], pd.DataFrame]]:
    """Runs of rows that share their quantities: the upper and lower part of Table 2 have different ones."""
    by_row = table.groupby("row", sort=False)["quantity"].agg(tuple)
    for quantities in dict.fromkeys(by_row):
        rows = by_row.index[by_row == quantities]
        yield list(quantities), table[table["row"].isin(rows)]


def _shown(cell: pd.Series, source: str) -> str:
    if source == "printed":
        return f"{cell['printed']} {MARKS.get(cell['verdict'], '')}".strip()
    value = cell[source]
    return "–" if pd.isna(value) else format(value, _FORMATS[cell["quantity"].split(" by ")[0]])
