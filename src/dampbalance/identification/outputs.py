"""The files that an identification is written to, and whether there is room for them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
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

_RESIDUAL = (
    "below, the residual, in standard deviations of the noise. A pattern there is what the model "
    "does not explain."
)
_BALANCE = (
    "Energy balance: each marker is a cycle, and the line is what friction and damping take. Right: the residual of "
    "each row, in standard deviations."
)
_SLIDERS = (
    "The contact: the stiffness of its sliders over the amplitude at which each begins to slip."
)

PICTURES = {
    "forced": {
        "cycles": f"Each record folded onto one cycle of the drive, with the fitted oscillator; {_RESIDUAL}",
        "friction": "Friction {force} over {displacement}: the recorded cycle less spring, inertia and viscous "
        "damping, and the loop of the fitted oscillator. A dot marks where slip begins.",
        "balance": _BALANCE,
    },
    "ring-down": {
        "decays": f"Each decay with the fitted oscillator; {_RESIDUAL}",
        "balance": _BALANCE,
    },
    "stepped-sine": {
        "loss": "Energy lost per cycle over the amplitude: a dot is a line of the table, darker at higher levels, and "
        "a curve with its band of 95 % is what a contact and the damping take.",
        "stiffness": "Stiffness over the amplitude: a contact that slips is softer. Dots are lines of the table; "
        "curves, with bands of 95 %, are the laws.",
        "distribution": _SLIDERS,
    },
    "loops": {
        "loops": "The {force} over the {displacement} of each loop, and the contact fitted.",
        "loss": "Energy lost per cycle over the amplitude: a dot is a cycle, and a curve with its band of 95 % is "
        "what the contact takes.",
        "history": "The friction {force} that makes up for the loss of each cycle, and the stiffness of the contact.",
    },
}
"""The pictures of each kind of records, the most telling first, and what each shows."""


def pictures_of(figures: Iterable[str]) -> tuple[str, ...]:
    """Return the files of figures of those names."""
    return tuple(f"{name}.{suffix}" for name in figures for suffix in ("svg", "png"))


def outputs_of(kind: str) -> tuple[str, ...]:
    """Return the files that an identification of records of a kind is written to."""
    return (*TABLES, *pictures_of(PICTURES[kind]), REPORT)


OUTPUTS = outputs_of("forced")
ALL_PICTURES = (*pictures_of(dict.fromkeys(chain(*PICTURES.values()))), REPORT)
"""The files that show pictures of any kind of records."""


def save(found: Result[Any], folder: str | Path, *, figures: bool, overwrite: bool) -> list[Path]:
    """Write a result to a folder: see `Result.save`."""
    from .document import (
        table,
    )  # these are slow to import, and names of files are needed without them

    folder = path("folder", folder, "the path of a folder")
    remedy = "" if flag("overwrite", overwrite) else "overwrite=True"
    require_room(folder, (*TABLES, *ALL_PICTURES), remedy)
    pictures = (*pictures_of(found.figures), REPORT) if flag("figures", figures) else ()
    with written_together(folder, (*pictures, *reversed(TABLES))) as new:
        if figures:
            from .report import report

            write_text(new / REPORT, report(found, new))
        write_rows(new / ESTIMATES, table(found))
        write_text(new / SUMMARY, found.text())
        write_json(new / TABLES[0], found.document())
    return [folder / name for name in (*TABLES, *pictures)]


@contextmanager
def written_together(folder: Path, names: Iterable[str]) -> Iterator[Path]:
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
