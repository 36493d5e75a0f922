"""The paper's tables for the page: rows of results/<case>/tables/*.csv to rows of cells with verdicts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from ...project.wording import minus, number, unit_of
from ...replication import printed_tables
from ...replication.claim_verdicts import ROUTE_NAMES, VERDICTS, ClaimVerdict


@dataclass(frozen=True, slots=True)
class Cell:
    """One number: as text, and for a printed one its verdict and the claim that gives the reason."""

    text: str
    verdict: ClaimVerdict | None = None
    claim: str = ""


@dataclass(frozen=True, slots=True)
class Line:
    """The numbers of one route in one row of a table; label is that of the printed row."""

    label: str
    route: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True, slots=True)
class Subtable:
    """Rows with the same columns: (symbol, unit) each. `groups` holds the routes of one printed row together."""

    columns: tuple[tuple[str, str], ...]
    groups: tuple[tuple[Line, ...], ...]

    @property
    def claims(self) -> set[str]:
        """The claims on its printed numbers."""
        lines = (line for group in self.groups for line in group)
        return {cell.claim for line in lines for cell in line.cells if cell.verdict}


def subtables(
    table: pd.DataFrame, name: str, claims: Mapping[str, Mapping[str, str]]
) -> tuple[Subtable, ...]:
    """The table as the paper lays it out, a line per route, in parts whose rows share their quantities.

    table : a frame of `printed_tables.COLUMNS`, `printed` as text.   name : table1, table2, table3 or statistics.
    claims : id → row of the table of claims, from which the printed cells take their digits on the way, {} for none.
    """
    places = {row: place for place, row in enumerate(dict.fromkeys(table["row"]), start=1)}
    return tuple(
        Subtable(
            tuple(zip(quantities, map(unit_of, block["unit"]), strict=False)),
            tuple(
                tuple(_lines(cells, name, places[row], claims))
                for row, cells in block.groupby("row", sort=False)
            ),
        )
        for quantities, block in printed_tables.blocks(table)
    )


def _lines(
    cells: pd.DataFrame, name: str, place: int, claims: Mapping[str, Mapping[str, str]]
) -> list[Line]:
    """The printed line, if there is one, and a line per route."""
    records = cells.to_dict("records")
    label = str(records[0]["row"])
    ids = [
        printed_tables.claim_of(name, label, place, str(record["quantity"])) for record in records
    ]
    printed = tuple(
        Cell(minus(record["printed"]), VERDICTS[record["verdict"]], claim)
        if record["printed"]
        else Cell("")
        for record, claim in zip(records, ids, strict=True)
    )
    lines = [Line(label, "printed", printed)] if any(cell.text for cell in printed) else []
    for route in printed_tables.SHOWN_ROUTES:
        texts = (
            claims.get(claim, {}).get(route, "") or number(float(record[route]))
            for record, claim in zip(records, ids, strict=True)
        )
        lines.append(Line(label, ROUTE_NAMES[route], tuple(Cell(minus(text)) for text in texts)))
    return lines
