"""CSV, TSV and other delimited text: encoding, delimiter, decimal mark, header, and names and units of columns are
inferred from the first lines.
"""

from __future__ import annotations

import codecs
import csv
import itertools
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TextIO, TypeAlias

import numpy as np

from ...arrays import Array
from ...findings.finding import Finding
from ...project.wording import shortened
from ..errors import RecordError
from ..headings import has_word, names_time
from ..mapping import RecordMapping
from ..table import LONGEST_TAIL, RawChannel, Table
from ..units import find_other, find_unit, split_label
from .header import described, keyed, stated_rate

WHITESPACE = "whitespace"
_Cells: TypeAlias = Sequence[list[str]]
_ROWS_TO_AGREE = 20
_COMMENTS = "#%"
_BRACKETS = "[](){} "
# first cells of the lines of names and of units in the header of a logger
_NAMES, _UNITS = ("channel_name", "channel_names", "name", "channel"), ("unit", "units")
_MISSING = {"", "na", "n/a", "null", "none"} | {
    sign + word for sign in ("", "+", "-") for word in ("nan", "inf", "infinity")
}
# times: 2026-03-01T12:00:00.0005+01:00; 12:00:00,0005 of a day; 0 days 00:00:00.0005, as pandas writes a span
_CLOCK = r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?"
_POINT = re.compile(rf"\d{{4}}-\d{{2}}-\d{{2}}[T ]{_CLOCK} ?(Z|[+-]\d{{2}}(:?\d{{2}})?)?")
_SPAN = re.compile(rf"(-?\d+ days? \+?)?{_CLOCK}")
_STAMP = re.compile(f"{_POINT.pattern}|{_SPAN.pattern}")
_DATE = re.compile(r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}([T ].{1,30})?")
_DAY = 86400.0  # s
_NUMBER = {
    mark: re.compile(rf"[+-]?(\d+({re.escape(mark)}\d*)?|{re.escape(mark)}\d+)([eE][+-]?\d+)?")
    for mark in ".,"
}

# Tried in this order; of two that fit equally many rows the first is taken. The semicolon precedes the comma because of
# "1,5;2,5".
_DELIMITERS = ("\t", ";", "|", ",", WHITESPACE)


def _halved(lines: Sequence[str]) -> bool:
    """Return whether 0,5 is one number and not two, since the heading above is a single one with a unit."""
    at = next((i for i, text in enumerate(lines) if re.fullmatch(r"-?\d+,\d+", text.strip())), 0)
    unit = split_label(lines[at - 1].strip())[1] if at else None
    return bool(unit and find_unit(unit) and not re.search("[,;|\t]", lines[at - 1]))


class NoRows(RecordError):
    """A text that holds no rows of at least two numbers."""


def cells_of(line: str, delimiter: str, comment: str) -> list[str]:
    """Return the cells of a line without its comment; none for a blank line."""
    line = line.split(comment, 1)[0].rstrip("\r\n")
    if not line.strip(" " if delimiter == "\t" else None):  # tabs alone are a row of empty cells
        return []
    return line.split() if delimiter == WHITESPACE else _split(line, delimiter)


def _split(line: str, delimiter: str) -> list[str]:
    quoted = '"' in line or not line
    cells = next(csv.reader([line], delimiter=delimiter), []) if quoted else line.split(delimiter)
    return [cell.strip() for cell in cells]


def _first_row(
    table: _Cells, decimal: str, header: int | None, least: int
) -> tuple[int, int, int, int] | None:
    """Return how many lines are rows with this decimal mark, the number of the first one, counted from 0, and its
    number of cells, without and with empty ones at the end; None if there are no rows.

    A row has at least `least` cells, a number in one of them and a number, a time or nothing in the others.
    """
    number = _NUMBER[decimal]

    def row(cells: Sequence[str]) -> tuple[int, int]:
        """Return the number of cells, and that up to the last that is not empty; (0, 0) if it is no row."""
        if len(cells) < least:
            return 0, 0
        others = [cell for cell in cells if not number.fullmatch(cell)]
        texts = (c.lower() for c in others if not (_STAMP.fullmatch(c) or _DATE.fullmatch(c)))
        if len(others) == len(cells) or set(texts) - _MISSING:
            return 0, 0
        return len(cells), max(i for i, cell in enumerate(cells, start=1) if cell)

    first = (i for i, cells in enumerate(table) if row(cells)[0])
    start = next(first, len(table)) if header is None else header
    sizes = [row(cells) for cells in table[start:] if cells]
    counts = Counter(cells for cells, _ in sizes[:_ROWS_TO_AGREE] if cells)
    if not counts:
        return None
    usual = max(counts, key=lambda cells: (counts[cells], cells))
    # A delimiter at the end of every row makes no column; a shorter channel's empty cells do.
    width = max(filled for cells, filled in sizes if cells == usual)
    return (counts[usual], start, width, usual) if width >= least else None


def _header_table(lines: Sequence[str], delimiter: str, width: int, most: int) -> list[list[str]]:
    """Return the cells of each line of a header, separated like the rows or, if no line then has as many cells, by
    another delimiter with which the last line has."""
    table = _header_cells(lines, delimiter, width, most)
    if width < 2 or any(len(cells) == width for cells in table):
        return table
    others = (_header_cells(lines, mark, width, most) for mark in _DELIMITERS[:-1])
    return next((of for of in others if of and len(of[-1]) == width), table)


def _header_cells(lines: Sequence[str], delimiter: str, width: int, most: int) -> list[list[str]]:
    """Return the cells of each line of a header, without those above columns that are empty in every row and without
    LabVIEW's column of comments. Where blanks separate cells, only lines with as many cells as the rows count."""
    table = []
    for line in lines:
        bare = line.strip()
        text = bare.lstrip(_COMMENTS).strip() if bare.startswith(tuple(_COMMENTS)) else line
        cells = _split(text, delimiter) if delimiter != WHITESPACE else text.split()
        if delimiter == WHITESPACE:  # "x [mm]" is one name, where the number of cells allows
            ways = (re.split(way, text.strip()) for way in (r"\s{2,}|\t", r"\s+(?![\[(])"))
            cells = next((apart for apart in ways if len(apart) == width), cells)
        while len(cells) > most and not cells[0]:
            del cells[0]
        dropped = ("", "comment", "kommentar")
        while len(cells) > width and (len(cells) <= most or cells[-1].lower() in dropped):
            cells.pop()
        if cells and (delimiter != WHITESPACE or len(cells) == width):
            table.append(cells)
    return table


def columns_of(path: Path, table: _Cells, width: int) -> list[RawChannel]:
    """Return names and units of the columns, from the last lines of the header that have as many cells as the rows."""
    fitting = [cells for cells in table if len(cells) == width and any(cells)]
    if not fitting and table and len(table[-1]) > 1:
        raise RecordError(
            f"{path}: its header has {len(table[-1])} names, its rows have {width} cells; give each column a name; if "
            "it has 0,5 for 0.5 and commas between the columns, export it with another delimiter, such as ;"
        )
    units = fitting.pop() if len(fitting) > 1 and _are_units(fitting[-1]) else [""] * width
    labels, stated = fitting[-1] if fitting else [""] * width, keyed(table)
    named, measured = (next(filter(None, map(stated.get, keys)), []) for keys in (_NAMES, _UNITS))
    # a column below the key, or one column of each pair, holds times
    pairs = len(named) == len(measured) == width
    times = {i for i, cell in enumerate(named) if cell == named[0]} if pairs else set[int]()
    if pairs:
        labels = ["" if i in times else cell for i, cell in enumerate(named)]
        units = ["s" if cell == measured[0] else cell for cell in measured]
    columns = []
    for i, label in enumerate(labels):
        name, own = split_label(label)
        unit = units[i].strip(_BRACKETS) or own
        unnamed = "time" if i in times else f"column {i + 1}"
        columns.append(RawChannel(name or unnamed, unit, label=label))
    # headings of an oscilloscope
    for key, along in (("horizontal_units", True), ("vertical_units", False)):
        places = [i for i, raw in enumerate(columns) if names_time(raw) == along and not raw.unit]
        for i, unit in zip(places, stated.get(key, [])[1:], strict=False):
            columns[i] = replace(columns[i], unit=unit or None)
    return columns


def timed(
    columns: Sequence[RawChannel], clock: Mapping[str, Any], rows: _Cells, decimal: str
) -> list[RawChannel]:
    """Return the columns with the rate `clock` that a header states. A column that counts samples in its first rows is
    no time if the header states another interval, or if only its place in the header made it one."""
    rate = clock.get("rate_hz")
    timed_columns = [replace(raw, **clock) for raw in columns]
    for i, raw in enumerate(timed_columns):
        whole = [row[i].partition(decimal)[0] for row in rows if i < len(row)]
        doubtful = rate != 1.0 and (rate is not None or not raw.label)
        counts = all(map(str.isdecimal, whole)) and {*np.diff([*map(int, whole)])} == {1}
        if doubtful and counts and names_time(raw) and raw.unit in (None, "s"):
            timed_columns[i] = replace(raw, name=f"sample {i + 1}", unit=None)
    return timed_columns


def _are_units(cells: Sequence[str]) -> bool:
    """Return whether a line holds units: each cell is a unit, empty, "-" or in brackets, and at least one is known."""
    bare = [cell.strip(_BRACKETS) for cell in cells]
    return any(find_unit(text) or find_other(text) for text in bare) and all(
        text in ("", "-", "1") or text != cell or find_unit(text) or find_other(text)
        for text, cell in zip(bare, cells, strict=True)
    )


def _no_rows(path: Path, lines: Sequence[str], comment: str, mapping: RecordMapping) -> str:
    if not any(line.strip() for line in lines):
        return f"{path}: is empty"
    cells = [line.split(comment, 1)[0].strip() for line in lines]
    if any(sum(bool(mark.fullmatch(cell)) for cell in cells) > 1 for mark in _NUMBER.values()):
        return f"{path}: has one column only; a record needs an excitation and a response"
    skipped = mapping.header_lines
    where = "" if skipped is None else f" after {skipped} header lines"
    return (
        f"{path}: holds no rows of at least two numbers{where}; neither texts nor dates are read, except "
        "2026-03-01T12:00:00.5: export the times in seconds, or state delimiter, decimal and header_lines in a mapping"
    )


def _encoding(path: Path) -> str:
    """Return the encoding of a file: UTF-16 by its byte order mark, else UTF-8 if it is valid, else Shift-JIS or GB
    18030 if these give words of headings, else the code page of Windows (µ and ² in a header)."""
    with open(path, "rb") as stream:
        head = stream.read(65536)
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    for encoding in ("utf-8-sig", "cp932", "gb18030"):
        with suppress(UnicodeDecodeError):  # the end may cut a character in two
            text = codecs.getincrementaldecoder(encoding)().decode(head)
            if encoding == "utf-8-sig" or has_word(text):
                return encoding
    return "cp1252"


def _seconds(cells: Any) -> Array:
    """Return the times of a column in seconds from the first one on, NaN for an empty cell. Raises ValueError for a
    cell that is no time."""
    import pandas as pd  # slow to import

    texts = pd.Index(cells).str.replace(",", ".").str.strip()
    kind = _POINT if _POINT.fullmatch(texts[0]) else _SPAN
    # pandas accepts more texts as time spans
    if not texts.dropna().str.fullmatch(kind.pattern).all():
        raise ValueError("a cell is no time")
    times: Any = pd.TimedeltaIndex(pd.to_timedelta(texts)) if kind is _SPAN else None
    if times is None:
        times = pd.DatetimeIndex(pd.to_datetime(texts, format="ISO8601", utc=True))
    t = np.asarray((times - times[0]) / pd.Timedelta(seconds=1), dtype=np.float64)
    if kind is _SPAN and "day" not in texts[0]:  # midnight may pass
        t = t + _DAY * np.cumsum(np.diff(t, prepend=0.0) < -0.5 * _DAY)
    return t


@dataclass(frozen=True)
class _Layout:
    """Layout of a delimited text: delimiter, decimal mark, mark of comments, number of header lines.

    opened : opens the text.   line : word for a line, for messages.   left : empty cells before each row.
    odd : list that receives what is odd about the rows.
    """

    path: Path
    opened: Callable[[], TextIO]
    line: str
    delimiter: str
    decimal: str
    comment: str
    header_lines: int
    left: int
    channels: Sequence[RawChannel]
    odd: list[Finding]

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield the line number, counted from 1, and the cells of every row; slow, used to locate faults."""
        with self.opened() as stream:
            for number, line in itertools.islice(enumerate(stream, 1), self.header_lines, None):
                if cells := cells_of(line, self.delimiter, self.comment):
                    yield number, cells[self.left :]

    def place(self, sample: int) -> str:
        """Return the line of a row, counted from 1."""
        row = next(itertools.islice(self.rows(), sample, None), None)
        return f"{self.line} {row[0]}" if row else f"row {sample + 1}"

    def load(self, wanted: Sequence[int]) -> list[Array]:
        """Return the wanted columns; an empty cell is NaN."""
        try:
            return self._columns(wanted, None)
        except (ValueError, OverflowError, KeyError) as error:  # pandas' own errors are ValueErrors
            return self._columns(wanted, self._rows_before_text(wanted, str(error)))

    def _columns(self, wanted: Sequence[int], most: int | None) -> list[Array]:
        import pandas as pd  # slow to import

        stamps = {i + self.left: self.channels[i].stamps for i in wanted}
        # No `names` and no `usecols`: with them pandas silently drops the surplus cells of a row.
        with self.opened() as stream:
            table = pd.read_csv(
                stream,
                header=None,
                dtype={i: str if of else np.float64 for i, of in stamps.items()},
                low_memory=False,
                skiprows=self.header_lines,
                nrows=most,
                comment=self.comment,
                decimal=self.decimal,
                skipinitialspace=True,
                sep=r"\s+" if self.delimiter == WHITESPACE else self.delimiter,
            )
        return [_seconds(table[i]) if of else np.asarray(table[i]) for i, of in stamps.items()]

    def _rows_before_text(self, wanted: Sequence[int], fallback: str) -> int:
        """Return the number of rows before the text at the end of a file, and note the text as odd.

        Raises RecordError for the first row that cannot be read, if rows of numbers follow it.
        """
        faults = list[tuple[int, int, str]]()  # row, line, what is wrong with it
        for row, (line, cells) in enumerate(self.rows()):
            fault = self._fault(wanted, cells)
            if fault:
                faults.append((row, line, fault))
            elif faults:
                break
        else:
            if 0 < len(faults) <= LONGEST_TAIL and (ends := faults[0][0]):
                lines = {"rows": self.line, "first": faults[0][1], "last": faults[-1][1]}
                self.odd.append(Finding("text after numbers", lines | {"many": len(faults) > 1}))
                return ends
        if faults:
            raise RecordError(f"{self.path}: {self.line} {faults[0][1]}{faults[0][2]}")
        raise RecordError(f"{self.path}: cannot be read: {shortened(fallback, 200)[1:-1]}")

    def _fault(self, wanted: Sequence[int], cells: Sequence[str]) -> str:
        """Return what is wrong with the cells of a row; "" if nothing is."""
        width = len(self.channels)
        if any(cells[width:]) or len(cells) <= max(wanted):
            remedy = "repair it, or cut the file before it"
            return f" has {len(cells)} cells, the others {width}; {remedy}"
        for i in wanted:
            cell, raw = cells[i], self.channels[i]
            number = _NUMBER[self.decimal].fullmatch(cell) or cell.lower() in _MISSING
            if _STAMP.fullmatch(cell) if raw.stamps else number:
                continue
            what = f"is not a {'time' if raw.stamps else 'number'}"
            if _DATE.fullmatch(cell):
                ways = "write 2026-03-01T12:00:00.5, or give sample_rate_hz instead"
                what = f"is a date that can be read in several ways: {ways}"
            return f", column {shortened(raw.name)}: {shortened(cell)} {what}"
        return ""


def text_file(path: Path, mapping: RecordMapping) -> Table:
    """Return the table of a delimited text file: see `text_table`."""
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 4))
        ended = file.read().replace(b"\x00", b"").endswith((b"\n", b"\r"))
    opened = partial(open, path, encoding=_encoding(path), errors="replace")
    table = text_table(path, opened, mapping)
    table.odd.extend([Finding("no line end")] * (not ended))
    return table


def text_table(
    path: Path,
    opened: Callable[[], TextIO],
    mapping: RecordMapping,
    line: str = "line",
    comment: str = "",
) -> Table:
    """Return the table of a delimited text; its layout follows from its first lines and from the mapping.

    opened : opens the text.   line : word for a line, for messages.   comment : mark of comments; "" if unknown.

    Raises RecordError if there are no rows of numbers, only one column, or a header that does not fit the rows. Loading
    the table raises RecordError, naming line and column, for a cell that is no number and for a row with too many or
    too few cells. Lines of text after the last row are ignored, with a warning.
    """
    with opened() as stream:
        # enough for any header and some rows
        lines = stream.readlines(2_000_000)[:400]
    begun = (line.lstrip()[:1] for line in lines)
    comment = comment or next((mark for mark in begun if mark in [*_COMMENTS]), "#")
    possible = [mapping.delimiter] if mapping.delimiter else _DELIMITERS
    if mapping.sample_rate_hz is None:  # a row has two cells at least
        text = "".join(lines)
        possible = [mark for mark in possible if mark in text or mark == WHITESPACE]
    tables = {mark: [cells_of(line, mark, comment) for line in lines] for mark in possible}
    halved = _halved(lines)
    fits = [
        (fit, delimiter, decimal)
        # a single column is enough if times may be missing
        for least in ([2] if mapping.sample_rate_hz is None and not halved else [2, 1])
        for delimiter, table in tables.items()
        for decimal in (mapping.decimal or ".,")
        if decimal != delimiter and not (halved and delimiter == ",")
        if (fit := _first_row(table, decimal, mapping.header_lines, least))
    ]
    if not fits:
        raise NoRows(_no_rows(path, lines, comment, mapping))
    (_, header, width, cells), delimiter, decimal = max(
        fits, key=lambda fit: (fit[0][2] > 1, fit[0][0])
    )
    rows = [*filter(None, tables[delimiter][header:])][:_ROWS_TO_AGREE]
    # a delimiter before or after each row makes no column
    left = min(next(i for i, cell in enumerate(row) if cell) for row in rows if any(row))
    head = _header_table(lines[:header], delimiter, width - left, cells - left)
    rows = [row[left:width] for row in rows]
    above = [text for text in lines[:header] if len(text) < 500]  # longer lines are no sentences
    sensitivities = keyed(head).get("sensitivity", [])[1:]
    channels = described(columns_of(path, head, width - left), above, sensitivities, decimal)
    channels = timed(channels, stated_rate(above, decimal, delimiter), rows, decimal)
    for i, cell in enumerate(rows[0]):
        if _STAMP.fullmatch(cell) or (_DATE.fullmatch(cell) and ":" in cell):
            channels[i] = replace(channels[i], unit="s", stamps=True)
    table = Table(path, channels)
    of = line, delimiter, decimal, comment, header, left, channels, table.odd
    layout = _Layout(path, opened, *of)
    return replace(table, load=layout.load, place=layout.place)
