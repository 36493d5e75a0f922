"""A result as the files of a folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arguments import flag, path
from ..project.files import write_json, write_rows, write_text
from .document import table
from .outputs import (
    ALL_PICTURES,
    ESTIMATES,
    REPORT,
    SUMMARY,
    TABLES,
    pictures_of,
    require_room,
    written_together,
)

if TYPE_CHECKING:
    from .result import Result


def save(found: Result[Any], folder: str | Path, *, figures: bool, overwrite: bool) -> list[Path]:
    """Write a result to a folder: see `Result.save`."""
    folder = path("folder", folder, "the path of a folder")
    remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
    require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
    pictures = (*pictures_of(found.figures), REPORT) if flag("figures", figures) else ()
    with written_together(folder, (*pictures, *reversed(TABLES))) as new:
        if figures:
            from .report import report  # slow to import

            write_text(new / REPORT, report(found, new))
        write_rows(new / ESTIMATES, table(found))
        write_text(new / SUMMARY, found.text())
        write_json(new / TABLES[0], found.document())
    return [folder / name for name in (*TABLES, *pictures)]
