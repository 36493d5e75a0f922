"""Spreadsheets: the first sheet that holds rows of numbers, read whole in a process of limited memory and time."""

from __future__ import annotations

import datetime
import math
import pickle
import subprocess
import sys
import zipfile
from collections.abc import Generator, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError, library
from .record_file import RecordFile, Sliced, intact, require_channels, too_large
from .text import columns_of

_DAYS = (datetime.datetime, datetime.date, datetime.time, datetime.timedelta)
_EPOCH = datetime.datetime(1900, 1, 1)
_PART = 16  # numbers that may be read of another record, for each cell that may be read of a spreadsheet
_CELL, _TEXT = 160, 64  # bytes of memory that a cell takes at the most, and of the file, unpacked
# bytes of memory, and of the file, unpacked, without any cell
_BASE, _REST = 256_000_000, 1_000_000
_BYTE = 32  # bytes of memory that a byte of the file, unpacked, explains
_SECONDS, _SPEED = 30, 2_000_000  # of processor time, and bytes read in a second at the least


def spreadsheet_file(path: Path, largest: int) -> RecordFile:
    """A spreadsheet: the columns of its first sheet that holds rows of at least two numbers. Names and units stand
    above the first such row, as in a text file; points in time are read as s from the first on."""
    library("python_calamine", "a spreadsheet")
    most = largest // _PART
    rows: list[Sequence[Any]] = []
    with closing(_cells(path, most)) as messages:
        for kind, content in messages:
            if kind == "rows":
                rows += content
            elif any(map(_is_row, rows)):
                break
            else:
                rows, (height, width) = [], content
                require_channels(path, width)
                if height * width > most:
                    holds = f"a sheet of {height:,} × {width:,} cells"
                    raise _too_large(path, holds, height * width)
    first = next((i for i, row in enumerate(rows) if _is_row(row)), None)
    if first is None:
        raise RecordError(f"{path}: no sheet holds rows of at least two numbers")
    width = max(i for i, cell in enumerate(rows[first], start=1) if cell != "")
    last = max(i for i, row in enumerate(rows, start=1) if any(cell != "" for cell in row[:width]))
    table = [row[:width] for row in rows[first:last]]
    header = [[" ".join(str(cell).split()) for cell in row[:width]] for row in rows[:first]]
    for names in header:
        names[0] = names[0].lstrip("#% ")
    channels = columns_of(path, header, width)
    for i, (raw, cell) in enumerate(zip(channels, table[0], strict=True)):
        stamps = isinstance(cell, _DAYS)
        unit = "s" if stamps else raw.unit
        channels[i] = replace(raw, unit=unit, size=len(table), stamps=stamps)

    @cache
    def column(i: int) -> Array:
        cells = [row[i] for row in table]
        if channels[i].stamps:
            # from the first point in time of the column, or its first span
            spans = (_span(c) - _span(cells[0]) if isinstance(c, _DAYS) else None for c in cells)
            return np.array([math.nan if s is None else s.total_seconds() for s in spans])
        for number, cell in enumerate(cells, start=first + 1):
            if not _is_number(cell) and cell != "":
                where = f"row {number}, column {shortened(channels[i].name)}"
                raise RecordError(f"{path}: {where}: {shortened(str(cell))} is not a number")
        return np.array([math.nan if cell == "" else float(cell) for cell in cells])

    return Sliced(path, channels, lambda i, a, b: column(i)[a:b], "a spreadsheet")


def _cells(path: Path, most: int) -> Generator[tuple[str, Any], None, None]:
    """What `cells.py` sends of a file, from a process that may take the memory of `most` cells, and no more than a file
    of this size can fill. Raises RecordError where that is too little, or the file cannot be read."""
    size = path.stat().st_size
    if zipfile.is_zipfile(path):
        with intact(path, "a spreadsheet"), zipfile.ZipFile(path) as packed:
            size = sum(part.file_size for part in packed.infolist())
    if size > most * _TEXT + _REST:
        raise _too_large(path, f"{size:,} bytes, unpacked", size // _TEXT)
    memory = _BASE + min(most * _CELL, size * _BYTE)
    command = [sys.executable, "-P", str(Path(__file__).with_name("cells.py"))]
    command += [str(path), str(memory), str(_SECONDS + size // _SPEED)]
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, stdin=quiet, stdout=subprocess.PIPE, stderr=quiet) as child:
        try:
            assert child.stdout is not None
            with suppress(EOFError, pickle.UnpicklingError):  # its end
                while True:
                    kind, content = pickle.load(child.stdout)
                    if kind == "error":
                        with intact(path, "a spreadsheet"):
                            raise ValueError(content)
                    yield kind, content
            if child.wait():
                raise RecordError(
                    f"{path}: takes more memory or time than what it holds explains: a cell far from all others, or "
                    "one that repeats; delete the rows and columns behind the record, or save it as CSV"
                )
        finally:
            child.kill()


def _too_large(path: Path, what: str, cells: int) -> RecordError:
    return too_large(path, f"holds {what}", "a spreadsheet", _PART * cells, ", save it as CSV")


def _is_row(row: Sequence[Any]) -> bool:
    """Whether a row has at least two cells, numbers or points in time, and a number among them."""
    cells = [cell for cell in row if cell != ""]
    numbers = sum(map(_is_number, cells))
    return len(cells) > 1 and 0 < numbers == sum(not isinstance(cell, _DAYS) for cell in cells)


def _is_number(cell: Any) -> bool:
    return isinstance(cell, int | float) and not isinstance(cell, bool)


def _span(cell: Any) -> datetime.timedelta:
    """A point in time or a span as a span; a day alone is its midnight."""
    if isinstance(cell, datetime.time):
        cell = datetime.datetime.combine(_EPOCH, cell)
    elif isinstance(cell, datetime.date) and not isinstance(cell, datetime.datetime):
        cell = datetime.datetime.combine(cell, datetime.time())
    return cell if isinstance(cell, datetime.timedelta) else cell - _EPOCH
