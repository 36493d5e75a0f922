"""Spreadsheets: the first sheet that holds rows of numbers, read as the text that it would be exported as."""

from __future__ import annotations

import datetime
import io
import re
import zipfile
from functools import partial
from pathlib import Path
from typing import Any

from ..errors import RecordError, library
from ..mapping import RecordMapping
from ..table import Table
from .text import NoRows, text_table

_MOST_CELLS = 12_500_000  # cells of a sheet, with some 100 bytes of memory for each
_CELL = re.compile(rb'<c r="([A-Z]{1,3})([0-9]{1,7})"')
_LAYOUT = RecordMapping(delimiter="\t", decimal=".")


def spreadsheet_file(path: Path) -> Table:
    """Return the table of a spreadsheet: the columns of its first sheet that holds rows of at least two numbers. Names
    and units stand above the first such row, as in a text file; points in time are read as s from the first on."""
    calamine = library("python_calamine", "a spreadsheet")
    _require_dense(path)
    book = calamine.CalamineWorkbook.from_path(path)
    for name in book.sheet_names:
        sheet = book.get_sheet_by_name(name)
        if sheet.start is None or sheet.end is None:
            continue
        left = "\t" * sheet.start[1]  # columns before the first that holds something
        rows = [left + "\t".join(map(_text, row)) for row in sheet.iter_rows()]
        opened = partial(io.StringIO, "\n".join(rows).rstrip() + "\n")
        try:
            return text_table(path, opened, _LAYOUT, "row", comment="\x1f")
        except NoRows:
            continue
    raise RecordError(f"{path}: no sheet holds rows of at least two numbers")


def _text(cell: Any) -> str:
    """Return a cell as a text, in one line; a day alone is its midnight."""
    if isinstance(cell, datetime.timedelta):
        days, rest = divmod(cell, datetime.timedelta(days=1))
        return f"{days} days {rest!s:0>8}"
    if isinstance(cell, datetime.date) and not isinstance(cell, datetime.datetime):
        cell = datetime.datetime.combine(cell, datetime.time())
    if isinstance(cell, datetime.datetime | datetime.time):
        return cell.isoformat()
    return " ".join(str(cell).split())


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
