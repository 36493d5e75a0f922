"""A result as the files of a folder: their names, whether there is room for them, and how they are written."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.resources import files
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from ..arguments import flag, path
from ..project.files import UNFINISHED, write_json, write_rows, write_text

if TYPE_CHECKING:
    from .result import Result

TABLES = ("identification.json", "identification.csv", "summary.txt")
"""The document with everything; the estimates; the table of the screen."""

REPORT = "report.html"
"""All of it on a page, for a reader."""

OVERVIEW = ESTIMATES, SUMMARY = TABLES[1:]
"""Names of the files of all sets, and of their like of each set."""

PICTURES: dict[str, dict[str, str]] = tomllib.loads(
    files(__package__).joinpath("pictures.toml").read_text(encoding="utf-8")
)
"""Kind of records → its pictures by name, the most telling first → what each shows."""


def pictures_of(figures: Iterable[str]) -> tuple[str, ...]:
    """Return the files of figures of those names."""
    return tuple(f"{name}.{suffix}" for name in figures for suffix in ("svg", "png"))


def outputs_of(kind: str) -> tuple[str, ...]:
    """Return the files that an identification of records of a kind is written to."""
    return (*TABLES, *pictures_of(PICTURES[kind]), REPORT)


OUTPUTS = outputs_of("forced")
ALL_PICTURES = (*pictures_of(dict.fromkeys(chain(*PICTURES.values()))), REPORT)
"""The files that show pictures of any kind of records."""


@contextmanager
def _written_together(folder: Path, names: Iterable[str]) -> Iterator[Path]:
    """Yield an empty folder in `folder` for results, which move out in the order of their names when the block ends,
    and replace all that an earlier identification left; nothing changes if it fails."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=UNFINISHED, dir=folder) as unfinished:
        yield Path(unfinished)
        for name in {*ALL_PICTURES} - {*names}:
            (folder / name).unlink(missing_ok=True)
        for name in names:
            (Path(unfinished) / name).replace(folder / name)


def require_room(folder: Path, names: Iterable[str], permission: str) -> None:
    """Raise ValueError where results of those names could not be written to a folder, or would replace others.

    permission : the option that allows a caller to replace them; empty where it was given.
    """
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise ValueError(f"{there} is a file: choose a folder for the results")
    if not os.access(there, os.W_OK):
        raise ValueError(f"{there} cannot be written to: choose another folder for the results")
    held = next((name for name in names if (folder / name).exists()), None)
    if held and permission:
        raise ValueError(
            f"{folder} already contains {held}: choose another folder, or add {permission}"
        )


def save(
    found: Result[Any], folder: str | Path, *, figures: bool = True, overwrite: bool = False
) -> list[Path]:
    """Write a result to a folder: see `Result.save`."""
    from .document import table

    folder = path("folder", folder, "the path of a folder")
    remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
    require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
    pictures = (*pictures_of(found.figures), REPORT) if flag("figures", figures) else ()
    with _written_together(folder, (*pictures, *reversed(TABLES))) as new:
        if figures:
            from .report import report  # slow to import

            write_text(new / REPORT, report(found, new))
        write_rows(new / ESTIMATES, table(found))
        write_text(new / SUMMARY, found.text())
        write_json(new / TABLES[0], found.document())
    return [folder / name for name in (*TABLES, *pictures)]
