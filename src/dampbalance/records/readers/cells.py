"""Run as a script by `spreadsheets.py`: sends the cells of a sheet from a process whose memory and time are limited.

The library allocates a sheet from its first cell to its last before it says how large that is: a file of 2 kB can ask
for more than a machine has. The script imports nothing of the package, and so starts at once.

Usage: cells.py FILE BYTES SECONDS. To the standard output go pickled pairs: ("sheet", (rows, columns)) for each sheet,
each followed by its cells, ("rows", lists of cells), some rows at a time; ("error", why) where a file is damaged.
"""

from __future__ import annotations

import pickle
import sys
from contextlib import suppress

import python_calamine

_CELLS = 1 << 16  # sent at once


def limit(memory: int, seconds: int) -> None:
    """Bound what this process may take, where the system can."""
    with suppress(ImportError):  # Windows
        import resource

        for name, most in {"CORE": 0, "CPU": seconds, "AS": memory}.items():
            with suppress(ValueError, OSError):  # macOS knows no limit of addresses
                resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (most, most))


def send(kind: str, content: object) -> None:
    """A message to who reads the cells."""
    pickle.dump((kind, content), sys.stdout.buffer)


def main(path: str, memory: str, seconds: str) -> None:
    """Send the sheets of a file."""
    limit(int(memory), int(seconds))
    try:
        book = python_calamine.CalamineWorkbook.from_path(path)
        for name in book.sheet_names:
            sheet = book.get_sheet_by_name(name)
            if sheet.start is None or sheet.end is None:
                continue
            send("sheet", (sheet.end[0] + 1, sheet.end[1] + 1))
            left, rows = [""] * sheet.start[1], []  # columns before the first that holds something
            for row in sheet.iter_rows():
                rows.append(left + row)
                if len(rows) * len(rows[-1]) >= _CELLS:
                    send("rows", rows)
                    rows = []
            send("rows", rows)
    except Exception as error:  # of many kinds
        send("error", str(error))
    sys.stdout.buffer.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
