"""Forced records or free decays: which of the two the records are, and what is done with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..balance import TERMS
from .loading import NotDriven
from .outputs import ALL_PICTURES, PICTURES, RING_DOWN_PICTURES
from .ringdown_run import (
    RingDownRun,
    ring_down_files,
    write_ring_down_figures,
    write_ring_down_tables,
)
from .run import IdentificationRun, digests, identify_files, require_different
from .run import write_figures as write_forced_figures
from .run import write_tables as write_forced_tables

RECOGNISED, FORCED, RING_DOWN = "recognised", "forced", "ring-down"

KINDS = (RECOGNISED, FORCED, RING_DOWN)
"""Of records: as the first of them is recognised, driven, or free decays."""

Run = IdentificationRun | RingDownRun

_OF_FORCED: Mapping[str, Any] = {
    "frequency_hz": None,
    "skip_cycles": 0,
    "approaches": None,
    "phase": "reversal",
}
"""Options that would say something else to free decays, and what they are where nobody gave them."""

_COMMON = ("mapping", "mass", "largest")


def identify_records(
    paths: Sequence[str | Path], k: float, kind: str = RECOGNISED, **options: Any
) -> Run:
    """F_k, c and K_z from record files, forced or of free decays.

    k : stiffness, N/m.   kind : one of KINDS.   options : of `identify_files`.

    Raises RecordError and ValueError naming the file, what is wrong, and the remedy; ValueError for an option that a
    free decay has no use for.
    """
    if kind != RING_DOWN:
        try:
            return identify_files(paths, k, **options)
        except NotDriven:
            if kind == FORCED:
                raise
    for name, value in options.items():
        terms = name == "terms" and value is not None and tuple(value) != tuple(TERMS)
        unknown = name in ("given", "groups", "laws") and value
        if terms or unknown or (name in _OF_FORCED and value != _OF_FORCED[name]):
            raise ValueError(
                f"{name} = {value!r} is for forced records, and these are free decays, which tell F_k, c and K_z: "
                "leave it out"
            )
    named = [Path(path) for path in paths]
    require_different(named)
    used = {name: options[name] for name in _COMMON if name in options}
    files = [digests(path, used.get("mapping")) for path in named]
    return ring_down_files(named, k, files=files, **used)


def write_tables(run: Run, folder: str | Path) -> None:
    """Write the tables of a run to a folder, the document last."""
    if isinstance(run, RingDownRun):
        write_ring_down_tables(run, folder)
    else:
        write_forced_tables(run, folder)


def write_figures(run: Run, folder: str | Path) -> None:
    """Write the pictures of a run to a folder."""
    if isinstance(run, RingDownRun):
        write_ring_down_figures(run, folder)
    else:
        write_forced_figures(run, folder)


def pictures_of(run: Run) -> tuple[str, ...]:
    """Names of the pictures of a run."""
    return RING_DOWN_PICTURES if isinstance(run, RingDownRun) else PICTURES


__all__ = [
    "ALL_PICTURES",
    "KINDS",
    "RECOGNISED",
    "identify_records",
    "pictures_of",
    "write_figures",
    "write_tables",
]
