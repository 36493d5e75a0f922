"""The files of a folder that a result is written to: their names, and whether there is room for them."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.resources import files
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory

from ..project.files import UNFINISHED

TABLES = ("identification.json", "identification.csv", "summary.txt")
"""The document with everything, the table of all numbers, and the text with all sentences."""

REPORT = "report.html"
"""The report, one page for readers."""

OVERVIEW = ESTIMATES, SUMMARY = TABLES[1:]
"""Names of the files for each set of records, and of those for all sets together."""

PICTURES: dict[str, dict[str, str]] = tomllib.loads(
    files(__package__).joinpath("pictures.toml").read_text(encoding="utf-8")
)
"""Kind of records → name of a picture, the most telling first → its caption."""


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
def written_together(folder: Path, names: Iterable[str]) -> Iterator[Path]:
    """Yield an empty folder for results. When the block ends they move into `folder`, in the order of `names`, and
    replace those of an earlier identification; if it fails, nothing changes."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=UNFINISHED, dir=folder) as unfinished:
        yield Path(unfinished)
        for name in {*ALL_PICTURES} - {*names}:
            (folder / name).unlink(missing_ok=True)
        for name in names:
            (Path(unfinished) / name).replace(folder / name)


def require_room(folder: Path, names: Iterable[str], permission: str) -> None:
    """Raise ValueError if files of these names cannot be written to a folder, or would replace others.

    permission : the option that allows to replace them; empty if it was given.
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
