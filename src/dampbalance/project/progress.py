"""Shows how far a long computation is: one line of a terminal, drawn again and again; nothing in a log or a pipe."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

Item = TypeVar("Item")

WIPE = "\r\x1b[K"  # clears the line of a terminal in which the cursor stands
_PATIENCE = 2.0  # s; shorter computations show no line
_PAUSE = 0.2  # s, between two lines
_at_work: list[str] = []  # noun of the items that are counted just now


def duration_in_words(seconds: float) -> str:
    """Return a duration in a unit that suits it, e.g. 12 s, 4 min, 3.5 h."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    if seconds < 6000.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"


def followed(items: Iterable[Item], total: float, what: str) -> Iterator[Item]:
    """Yield the items, one by one, while a line says how many of `total` are done and how long the rest takes.

    Use it around a loop that may take longer than two seconds. what : what is counted, as "records".
    """
    if _at_work:  # within a loop that is followed
        yield from items
        return
    stream = sys.stderr
    started = drawn = time.monotonic()
    _at_work.append(what)
    try:
        for done, item in enumerate(items):
            now = time.monotonic()
            if done and now - drawn > _PAUSE and now - started > _PATIENCE and stream.isatty():
                drawn, left = now, duration_in_words((now - started) * (total - done) / done)
                line = f"{done} of {total:g} {what}, about {left} left"
                stream.write(WIPE + line[: shutil.get_terminal_size().columns - 1])
                stream.flush()
            yield item
    finally:
        _at_work.clear()
        if drawn > started:
            stream.write(WIPE)
