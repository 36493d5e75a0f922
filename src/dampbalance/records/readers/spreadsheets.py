"""Spreadsheets: the first sheet with rows of numbers, read like the text to which it would be exported."""

from __future__ import annotations

import datetime
import io
import re
import zipfile
from functools import partial
from pathlib import Path

from ..errors import RecordError, library
from ..mapping import RecordMapping
from ..table import Table
from .text import NoRows, text_table

_MOST_CELLS = 12_500_000  # cells of a sheet, each of which takes about 100 bytes of memory
_CELL = re.compile(rb'<c r="([A-Z]{1,3})([0-9]{1,7})"')
_LAYOUT = RecordMapping(delimiter="\t", decimal=".")


def spreadsheet_file(path: Path) -> Table:
    """Return the table of a spreadsheet: the columns of its first sheet with rows of at least two numbers. Names and
    units are above the first such row, as in a text file; points in time are read as s from the first on."""
    calamine = library("python_calamine", "a spreadsheet")
    _require_dense(path)
    book = calamine.CalamineWorkbook.from_path(path)
    for name in book.sheet_names:
        rows = book.get_sheet_by_name(name).to_python(skip_empty_area=False)
        text = "\n".join("\t".join(map(_text, row)) for row in rows).rstrip() + "\n"
        try:
            return text_table(path, partial(io.StringIO, text), _LAYOUT, "row", comment="\x1f")
        except NoRows:
            continue
    raise RecordError(f"{path}: no sheet holds rows of at least two numbers")


def _text(cell: object) -> str:
    """Return a cell as a text in one line; a date without a time is its midnight."""
    text = f"{cell}T00:00" if type(cell) is datetime.date else str(cell)
    return " ".join(re.sub("(days?),", r"\1", text).split())


def _require_dense(path: Path) -> None:
    """Raise RecordError for a workbook with a cell far from all others: the library allocates all cells up to it, and
    ends the process if memory runs out."""
    if not zipfile.is_zipfile(path):
        return
    with zipfile.ZipFile(path) as packed:
        for part in filter(re.compile("xl/worksheets/[^/]*[.]xml").fullmatch, packed.namelist()):
            columns, last = set[bytes](), 0
            for cell in _CELL.finditer(packed.read(part)):
                columns.add(cell[1])
                last = max(last, int(cell[2]))
            column = max(columns, key=lambda of: of.rjust(3), default=b"").decode()
            width = sum(26**i * (ord(letter) - 64) for i, letter in enumerate(column[::-1]))
            if width * last > _MOST_CELLS:
                raise RecordError(
                    f"{path}: its last cell, {column}{last}, makes a sheet of {last:,} × {width:,} cells, more than "
                    f"{_MOST_CELLS:,}; delete the rows and columns behind the record, or save it as CSV"
                )
