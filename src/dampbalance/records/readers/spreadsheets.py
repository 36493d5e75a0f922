"""Spreadsheets: the first sheet that holds rows of numbers, read whole."""

from __future__ import annotations

import datetime
import math
import re
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError, library
from ..table import LONGEST_TAIL, Table, tail
from .text import columns_of, timed

_DAYS = (datetime.datetime, datetime.date, datetime.time, datetime.timedelta)
_EPOCH = datetime.datetime(1900, 1, 1)
_MOST_CELLS = 12_500_000  # cells of a sheet, with some 100 bytes of memory for each
_CELL = re.compile(rb'<c r="([A-Z]{1,3})([0-9]{1,7})"')
_ROWS_THAT_COUNT = 20  # rows that distinguish a column of times from one that counts samples


def spreadsheet_file(path: Path) -> Table:
    """Return the table of a spreadsheet: the columns of its first sheet that holds rows of at least two numbers. Names
    and units stand above the first such row, as in a text file; points in time are read as s from the first on."""
    calamine = library("python_calamine", "a spreadsheet")
    rows: list[Sequence[Any]] = []
    _require_dense(path)
    book = calamine.CalamineWorkbook.from_path(path)
    for name in book.sheet_names:
        sheet = book.get_sheet_by_name(name)
        if sheet.start is None or sheet.end is None:
            continue
        left = [""] * sheet.start[1]  # columns before the first that holds something
        rows = [left + row for row in sheet.iter_rows()]
        if any(map(_is_row, rows)):
            break
    first = next((i for i, row in enumerate(rows) if _is_row(row)), None)
    if first is None:
        raise RecordError(f"{path}: no sheet holds rows of at least two numbers")
    width = max(i for i, cell in enumerate(rows[first], start=1) if cell != "")
    filled = [i for i, row in enumerate(rows, start=1) if any(cell != "" for cell in row[:width])]
    last = max(i for i in filled if not any(map(_is_text, rows[i - 1][:width])))
    aside = [i for i in filled if i > last]
    if len(aside) > LONGEST_TAIL:
        last, aside = filled[-1], []
    table = [row[:width] for row in rows[first:last]]
    header = [[" ".join(str(cell).split()) for cell in row[:width]] for row in rows[:first]]
    for names in header:
        names[0] = names[0].lstrip("#% ")
    rows_of_text = [[str(cell) for cell in row] for row in table[:_ROWS_THAT_COUNT]]
    channels = timed(columns_of(path, header, width), header, rows_of_text, ".")
    for i, (raw, cell) in enumerate(zip(channels, table[0], strict=True)):
        stamps = isinstance(cell, _DAYS)
        unit = "s" if stamps else raw.unit
        channels[i] = replace(raw, unit=unit, size=len(table), stamps=stamps)

    def column(i: int) -> Array:
        cells = [row[i] for row in table]
        if channels[i].stamps:
            # times count from the first point in time of the column, or its first span
            spans = (_span(c) - _span(cells[0]) if isinstance(c, _DAYS) else None for c in cells)
            return np.array([math.nan if s is None else s.total_seconds() for s in spans])
        for number, cell in enumerate(cells, start=first + 1):
            if _is_text(cell):
                where = f"row {number}, column {shortened(channels[i].name)}"
                raise RecordError(f"{path}: {where}: {shortened(str(cell))} is not a number")
        return np.array([math.nan if cell == "" else float(cell) for cell in cells])

    oddity = tail(path, "row", aside[0], aside[-1]) if aside else ""
    return Table(path, channels, lambda wanted: [column(i) for i in wanted], oddity=oddity)


def _require_dense(path: Path) -> None:
    """Raise RecordError for a workbook with a cell far from all others: the library takes memory for all cells up to
    it, and ends the process where there is too little."""
    if not zipfile.is_zipfile(path):
        return
    with zipfile.ZipFile(path) as packed:
        for part in filter(re.compile("xl/worksheets/[^/]*[.]xml").fullmatch, packed.namelist()):
            column, last = b"  A", 0
            for cell in _CELL.finditer(packed.read(part)):
                column, last = max(column, cell[1].rjust(3)), max(last, int(cell[2]))
            letters = column.strip().decode()
            width = sum(26**i * (ord(of) - 64) for i, of in enumerate(reversed(letters)))
            if width * last > _MOST_CELLS:
                raise RecordError(
                    f"{path}: its last cell, {letters}{last}, makes a sheet of {last:,} × {width:,} cells, more than "
                    f"{_MOST_CELLS:,}; delete the rows and columns behind the record, or save it as CSV"
                )


def _is_row(row: Sequence[Any]) -> bool:
    """Return whether a row has at least two cells, numbers or points in time, and a number among them."""
    cells = [cell for cell in row if cell != ""]
    numbers = sum(map(_is_number, cells))
    return len(cells) > 1 and 0 < numbers == sum(not isinstance(cell, _DAYS) for cell in cells)


def _is_number(cell: Any) -> bool:
    return isinstance(cell, int | float) and not isinstance(cell, bool)


def _is_text(cell: Any) -> bool:
    return not (_is_number(cell) or isinstance(cell, _DAYS) or cell == "")


def _span(cell: Any) -> datetime.timedelta:
    """Return a point in time or a span as a span; a day alone is its midnight."""
    if isinstance(cell, datetime.time):
        cell = datetime.datetime.combine(_EPOCH, cell)
    elif isinstance(cell, datetime.date) and not isinstance(cell, datetime.datetime):
        cell = datetime.datetime.combine(cell, datetime.time())
    return cell if isinstance(cell, datetime.timedelta) else cell - _EPOCH
