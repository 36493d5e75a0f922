"""How far a long computation is: one line of a terminal, drawn again and again; nothing in a log or a pipe.

A job of the workflow, as a chunk of a study is, leaves the seconds that it still needs in a folder where the run looks
for them.
"""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TextIO, TypeVar

Item = TypeVar("Item")

FOLDER = "DAMPBALANCE_PROGRESS"
"""Environment variable: the folder in which jobs leave how long they still take, s, in files <rule>.<process>."""

WIPE = "\r\x1b[K"  # what clears the line of a terminal, in which the cursor stands
_PATIENCE = 2.0  # s, of whoever waits: what is done before says nothing
_PAUSE = 0.2  # s, between two lines
_at_work: list[str] = []  # what is counted, while something is


def duration_in_words(seconds: float) -> str:
    """A duration in a unit that suits it, e.g. 12 s, 4 min, 3.5 h."""
    if seconds < 100.0:
        return f"{seconds:.0f} s"
    if seconds < 6000.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"


def draw(text: str, stream: TextIO) -> None:
    """Put a text into the line of a terminal, cut where the line ends."""
    width = shutil.get_terminal_size().columns - 1
    stream.write(WIPE + (text if len(text) <= width else text[: width - 1] + "…"))
    stream.flush()


def followed(items: Iterable[Item], total: float, what: str) -> Iterator[Item]:
    """The items, one by one, while a line says how many of `total` are done and how long the rest takes.

    Use it around a loop that may take longer than two seconds. what : what is counted, as "records".
    """
    if _at_work:  # within a loop that is followed
        yield from items
        return
    stream, folder = sys.stderr, os.environ.get(FOLDER)
    rule = Path(sys.argv[0]).stem.rpartition(".")[2]  # of a script that Snakemake has copied
    file = Path(folder, f"{rule}.{os.getpid()}") if folder else None
    started = drawn = time.monotonic()
    _at_work.append(what)
    try:
        for done, item in enumerate(items):
            now = time.monotonic()
            if done and now - drawn > _PAUSE:
                drawn, left = now, (now - started) * (total - done) / done
                if file:
                    file.write_text(f"{left:.1f}", encoding="utf-8")
                elif stream.isatty() and now - started > _PATIENCE:
                    draw(
                        f"{done} of {total:g} {what}, about {duration_in_words(left)} left", stream
                    )
            yield item
    finally:
        _at_work.clear()
        if file:
            file.unlink(missing_ok=True)
        elif stream.isatty() and drawn - started > _PATIENCE:
            stream.write(WIPE)
