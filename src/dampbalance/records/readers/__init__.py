"""Readers of every record format that laboratories have, into a `Measurement` in SI units.

measurement = read("level1.mat")                    # mapping next to it, or names and units in the file
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ... import arguments
from ..errors import RecordError, RecordWarning
from ..guess import suggested_mapping
from ..mapping import MappingLike, RecordMapping, mapping_for, parts_of
from ..measurement import QUANTITIES, Measurement
from ..recognise import picks_of, recognise
from ..table import Table, intact
from .array_files import hdf5_file, json_file, matlab_file, numpy_file
from .containers import lvm_file, parquet_file, tdms_file, uff_file, wav_file
from .formats import FORMATS, checked_format
from .spreadsheets import spreadsheet_file
from .text import text_file

__all__ = [
    "FORMATS",
    "RecordError",
    "RecordWarning",
    "mapping_to_start_from",
    "quantities_of",
    "read",
    "table",
]


def read(
    path: str | Path, mapping: MappingLike = None, opened_as: Table | None = None
) -> Measurement:
    """Return the measurement in a file, in SI units.

    path : its suffix names the format, its content must agree.   mapping : what the file does not say.   opened_as :
    its table, where it has been opened.

    Raises RecordError naming the file, what is wrong with it, and the remedy; warns of what looks odd (RecordWarning).
    """
    path, rules = _named(path, mapping)
    first, *others = _tables(path, rules, opened_as)
    return replace(recognise(*first, *others), source=str(path))


def quantities_of(path: str | Path, mapping: MappingLike = None) -> tuple[str, ...]:
    """Return the quantities that names, units and mapping give the channels of a file, without a look at its samples.
    Raises RecordError as `read`."""
    tables = _tables(*_named(path, mapping))
    picks = [pick for part in tables for pick in picks_of(*part, entire=len(tables) == 1)]
    picked = {pick.quantity for pick in picks}
    return tuple(q for q in QUANTITIES if q in picked)


def table(path: str | Path, mapping: MappingLike = None) -> Table:
    """Return the table of a file: names, units and rates of its channels, and their samples as recorded, which are
    loaded where they are asked for. Raises RecordError as `read`."""
    path, rules = _named(path, mapping)
    content = checked_format(path)
    what = FORMATS["matlab" if content == "matlab73" else content].title
    with intact(path, what):
        file = text_file(path, rules) if content == "text" else _OPENERS[content](path)
    return replace(file, what=what)


def mapping_to_start_from(
    path: str | Path, mapping: MappingLike = None, stepped: bool | None = None
) -> str:
    """Return a mapping in YAML that names the channels of a file as far as headings, units and samples show them.

    It can be read as it stands; comments say what each line comes from, and why the other channels are left aside.
    Write it next to the record and correct what is wrong.

    mapping : what is known already, such as delimiter or sampling rate.   stepped : whether the file is a table of
    steady responses to a stepped sine; None to see it by its columns.

    Raises RecordError where the mapping names channels already, or nothing in the file can be a response.
    """
    path, rules = _named(path, mapping)
    return suggested_mapping(table(path, rules), rules, stepped)


def _named(path: str | Path, mapping: MappingLike) -> tuple[Path, RecordMapping]:
    file = arguments.path("path", path, "the path of a record")
    return file, mapping_for(file, mapping)


def _tables(
    path: Path, rules: RecordMapping, opened_as: Table | None = None
) -> list[tuple[Table, RecordMapping]]:
    """Return the table of each file of a record, with its part of the mapping."""
    return [
        (opened_as if opened_as and part == path else table(part, of), of)
        for part, of in parts_of(path, rules).items()
    ]


_OPENERS: dict[str, Callable[[Path], Table]] = {  # each imports its library
    "parquet": parquet_file,
    "hdf5": hdf5_file,
    "matlab73": hdf5_file,
    "matlab": matlab_file,
    "uff": uff_file,
    "tdms": tdms_file,
    "wav": wav_file,
    "lvm": lvm_file,
    "spreadsheet": spreadsheet_file,
    "npy": numpy_file,
    "npz": numpy_file,
    "json": json_file,
}
