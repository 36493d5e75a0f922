"""Reading records of every format that laboratories have into a `Measurement` in SI units.

measurement = read("level1.mat")                    # mapping next to it, or names and units in the file
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ... import arguments
from ..errors import RecordError, RecordWarning
from ..mapping import MappingLike, RecordMapping, mapping_for, parts_of
from ..measurement import QUANTITIES, Channel, Measurement
from ..table import RawChannel, Table, require_nameable, signals_file
from .array_files import hdf5_file, json_file, matlab_file, numpy_file
from .assemble import whole
from .channels import Pick, picks_of, suggested_mapping
from .containers import lvm_file, parquet_file, tdms_file, uff_file, wav_file
from .formats import FORMATS, checked_format
from .spreadsheets import spreadsheet_file
from .text import text_file

if TYPE_CHECKING:
    from ..table import Signals

__all__ = [
    "FORMATS",
    "RecordError",
    "RecordWarning",
    "channels",
    "mapping_to_start_from",
    "opened",
    "quantities_of",
    "read",
    "read_signals",
    "table",
]


def read(path: str | Path, mapping: MappingLike = None) -> Measurement:
    """The measurement in a file, in SI units.

    path : its suffix names the format, its content must agree.   mapping : what the file does not say.

    Raises RecordError naming the file, what is wrong with it, and the remedy; warns of what looks odd (RecordWarning).
    """
    path, rules = _named(path, mapping)
    channels: list[Channel] = []
    for file, picks in _files(path, rules):
        channels += whole(file, picks)
    order = list(QUANTITIES)
    return Measurement.of(str(path), sorted(channels, key=lambda one: order.index(one.quantity)))


def read_signals(name: str, signals: Signals | Table, rules: RecordMapping) -> Measurement:
    """The measurement in arrays or a table of pandas (`signals_file`), in SI units.

    name : of the record, for messages.   rules : what the names of the signals do not say.

    Raises RecordError and warns as `read`.
    """
    file = signals_file(name, signals)
    return Measurement.of(name, whole(file, picks_of(file, rules)))


def quantities_of(path: str | Path, mapping: MappingLike = None) -> tuple[str, ...]:
    """The quantities that names, units and mapping give the channels of a file, without a look at its samples. Raises
    RecordError as `read`."""
    picked = [pick.quantity for _, picks in _files(*_named(path, mapping)) for pick in picks]
    return tuple(q for q in QUANTITIES if q in picked)


def table(path: str | Path, mapping: MappingLike = None) -> Table:
    """The table of a file: names, units and rates of its channels, and their samples as recorded, which are loaded
    where they are asked for. Raises RecordError as `read`."""
    return opened(*_named(path, mapping))


def channels(path: str | Path, mapping: MappingLike = None) -> tuple[RawChannel, ...]:
    """The channels of a file, with names, units and sampling rates as it has them. Raises RecordError."""
    return tuple(table(path, mapping).channels)


def mapping_to_start_from(path: str | Path, mapping: MappingLike = None) -> str:
    """A mapping in YAML that names the channels of a file as far as headings, units and samples show them.

    It can be read as it stands; comments say what each line comes from, and why the other channels are left aside.
    Write it next to the record and correct what is wrong.

    mapping : what is known already, such as delimiter or sampling rate.

    Raises RecordError where the mapping names channels already, or nothing in the file can be a response.
    """
    path, rules = _named(path, mapping)
    return suggested_mapping(opened(path, rules), rules)


def _named(path: str | Path, mapping: MappingLike) -> tuple[Path, RecordMapping]:
    file = arguments.path("path", path, "the path of a record")
    return file, mapping_for(file, mapping)


def _files(path: Path, rules: RecordMapping) -> Iterator[tuple[Table, tuple[Pick, ...]]]:
    """Each file of a record, with what to read from it."""
    parts = parts_of(path, rules)
    for part, of in parts.items():
        file = opened(part, of)
        yield file, picks_of(file, of, entire=len(parts) == 1)


def opened(path: Path, rules: RecordMapping) -> Table:
    """The channels of a file, read as its mapping says. Raises RecordError as `read`."""
    content = checked_format(path)
    file = text_file(path, rules) if content == "text" else _OPENERS[content](path)
    require_nameable(path, file.channels)
    return file


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
