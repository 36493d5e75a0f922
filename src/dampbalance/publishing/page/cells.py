"""The paper's tables for the page: rows of results/<case>/tables/*.csv to rows of cells with verdicts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from ...project.wording import minus, number, unit_of
from .verdicts import BY_NAME, Verdict

ROUTES = {"as_published": "as published", "exact": "exact"}
_STATISTICS = {"least squares": "ls", "mean": "mean", "std": "std"}


@dataclass(frozen=True, slots=True)
class Cell:
    """One number: as text, and for a printed one its verdict and the claim that gives the reason."""

    text: str
    verdict: Verdict | None = None
    claim: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """The numbers of one route in one row of a table; label is that of the printed row."""

    label: str
    route: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True, slots=True)
class Block:
    """Rows with the same columns: (symbol, unit) each. `groups` holds the routes of one printed row together."""

    columns: tuple[tuple[str, str], ...]
    groups: tuple[tuple[Row, ...], ...]


def blocks(table: pd.DataFrame, name: str, claims: Mapping[str, Mapping[str, str]]) -> list[Block]:
    """The table as the paper lays it out, a line per route, in blocks of rows that share their quantities.

    table : a frame of `tables.COLUMNS`, `printed` as text.   name : table1, table2, table3 or statistics.
    claims : id → row of the table of claims, from which the printed cells take their digits on the way, {} for none.
    """
    labels = list(dict.fromkeys(table["row"]))
    quantities = table.groupby("row", sort=False)["quantity"].agg(tuple)
    made = []
    for columns in dict.fromkeys(quantities):
        rows = [label for label in labels if quantities[label] == columns]
        first = table[table["row"] == rows[0]]
        groups = tuple(
            tuple(_lines(table[table["row"] == label], name, labels.index(label) + 1, claims))
            for label in rows
        )
        units = (unit_of(unit) for unit in first["unit"])
        made.append(Block(tuple(zip(columns, units, strict=True)), groups))
    return made


def claim_of(name: str, row: str, place: int, quantity: str) -> str:
    """The id of the claim on a cell. place : of the row in the table, from 1; what a level is counted by."""
    symbol, _, approach = quantity.partition(" by ")
    if name == "statistics":
        approach, _, kind = row.partition(", ")
        return f"text.{symbol}_{approach.replace('_', '')}_{_STATISTICS.get(kind, kind)}"
    line = row.removeprefix("pair ") if row.startswith("pair ") else str(place)
    return ".".join(part for part in (name, approach, symbol, line) if part)


def _lines(
    cells: pd.DataFrame, name: str, place: int, claims: Mapping[str, Mapping[str, str]]
) -> list[Row]:
    """The printed line, if there is one, and a line per route."""
    records = cells.to_dict("records")
    label = str(records[0]["row"])
    ids = [claim_of(name, label, place, str(record["quantity"])) for record in records]
    lines = []
    if any(record["printed"] for record in records):
        printed = tuple(
            Cell(minus(record["printed"]), BY_NAME[record["verdict"]], claim)
            if record["printed"]
            else Cell("")
            for record, claim in zip(records, ids, strict=True)
        )
        lines.append(Row(label, "printed", printed))
    for route, words in ROUTES.items():
        shown = (
            claims.get(claim, {}).get(route, "") or number(float(record[route]))
            for record, claim in zip(records, ids, strict=True)
        )
        lines.append(Row(label, words, tuple(Cell(minus(text)) for text in shown)))
    return lines
