"""CSV, TSV and other delimited text, read in chunks."""

from __future__ import annotations

import io
import itertools
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError, RecordWarning
from ..mapping import RecordMapping
from .layout import LONGEST_LINE, WHITESPACE, layout_of
from .record_file import RecordFile
from .times import Clock, is_date, is_stamp

_AT_ONCE = 4_000_000  # cells that are parsed at once, wanted or not
_SMALL = 4_000_000  # bytes of a file that NumPy parses in less time than pandas takes to import


class TextFile(RecordFile):
    """A delimited text file; `layout.py` finds out its delimiter, decimal mark, header and columns."""

    def __init__(self, path: Path, mapping: RecordMapping) -> None:
        self.path, self.layout = path, layout_of(path, mapping)
        self.channels = self.layout.columns

    def blocks(self, wanted: Sequence[int], size: int) -> Iterator[list[Array]]:
        """The wanted columns, `size` rows at a time or fewer; an empty cell is NaN.

        Raises RecordError naming line and column for a cell that is no number and a row that has too many or too few.
        """
        layout = self.layout
        if not layout.ends_in_line_end:
            warnings.warn(
                f"{self.path}: its last line has no end; if the file was cut, its last number is wrong",
                RecordWarning,
                stacklevel=2,
            )
        table = self._of_numbers()
        if table is not None:
            for start in range(0, len(table), size):
                yield [table[start : start + size, i].copy() for i in wanted]
            return
        import pandas as pd  # slow to import, and not needed for small files of nothing but numbers

        # No `names` and no `usecols`: with them pandas drops without a word what a row has beyond the others.
        stamped = [i for i in wanted if self.channels[i].stamps]
        try:
            _, first = next(layout.rows(self.path)) if stamped else (0, [])
            seconds = {i: Clock(first[i]).seconds for i in stamped}
            with (
                _bounded(self.path, layout.encoding) as stream,
                pd.read_csv(
                    stream,
                    chunksize=min(size, max(1, _AT_ONCE // len(self.channels))),
                    header=None,
                    dtype=dict.fromkeys(wanted, np.float64) | dict.fromkeys(stamped, str),
                    low_memory=False,
                    skiprows=layout.header_lines,
                    comment=layout.comment,
                    decimal=layout.decimal,
                    skipinitialspace=True,
                    sep=r"\s+" if layout.delimiter == WHITESPACE else layout.delimiter,
                ) as chunks,
            ):
                for chunk in chunks:
                    yield [seconds.get(i, np.asarray)(chunk[i]) for i in wanted]
        except (ValueError, OverflowError) as error:  # pandas' own errors are ValueErrors
            raise RecordError(self._complaint(wanted, str(error))) from None

    def _of_numbers(self) -> Array | None:
        """All cells of a small file in which every one is a number; None for any other: pandas reads or refuses it."""
        layout = self.layout
        if self.path.stat().st_size > _SMALL or layout.decimal != ".":
            return None
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # no rows
                table = np.loadtxt(
                    self.path,
                    delimiter=None if layout.delimiter == WHITESPACE else layout.delimiter,
                    comments=layout.comment,
                    skiprows=layout.header_lines,
                    ndmin=2,
                    encoding=layout.encoding,
                )
        except ValueError:
            return None
        return table if table.shape[1] == len(self.channels) else None

    def place(self, channel: int, sample: int) -> str:
        """The line of a row, counted from 1."""
        row = next(itertools.islice(self.layout.rows(self.path), sample, None), None)
        return f"line {row[0]}" if row else f"row {sample + 1}"

    def _complaint(self, wanted: Sequence[int], fallback: str) -> str:
        """What is wrong with the first row that cannot be read."""
        width = len(self.channels)
        for number, cells in self.layout.rows(self.path):
            if any(cells[width:]) or len(cells) <= max(wanted):
                return (
                    f"{self.path}: line {number} has {len(cells)} cells, the others {width}; mend it, "
                    "or cut the file before it"
                )
            for i in wanted:
                cell, time = cells[i], self.channels[i].stamps
                if is_stamp(cell) if time else self.layout.is_readable(cell):
                    continue
                what = f"is not a {'time' if time else 'number'}"
                if is_date(cell):
                    what = "is a date that can be read in several ways: write 2026-03-01T12:00:00.5, or give "
                    what += "sample_rate_hz instead"
                name = shortened(self.channels[i].name)
                return f"{self.path}: line {number}, column {name}: {shortened(cell)} {what}"
        return f"{self.path}: cannot be read: {shortened(fallback, 200)[1:-1]}"


class _bounded(io.TextIOWrapper):
    """The text of a file, up to a line that is too long to be a row, which a parser would gather in memory."""

    def __init__(self, path: Path, encoding: str) -> None:
        super().__init__(path.open("rb"), encoding, errors="replace", newline="")
        self.without_end = 0

    def read(self, size: int | None = -1, /) -> str:
        """The next characters."""
        text = super().read(size)
        ends = max(text.rfind("\n"), text.rfind("\r"))
        self.without_end = len(text) + (self.without_end if ends < 0 else -ends)
        if self.without_end > LONGEST_LINE + 262_144:  # what pandas reads at once
            raise ValueError("a line has no end")
        return text
