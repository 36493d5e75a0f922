"""The formats of records: for each its suffixes, the first bytes of its files, and the function that reads them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from ...project.wording import shortened
from ..errors import LARGEST_FILE, RecordError
from ..table import Table
from .array_files import hdf5_file, json_file, matlab_file, numpy_file
from .containers import lvm_file, parquet_file, tdms_file, uff_file, wav_file
from .spreadsheets import spreadsheet_file
from .text import text_file

_HEAD = 4096  # bytes that are examined: a user block of a few kB may precede HDF5


class Format(NamedTuple):
    """A format: what people call it, its suffixes, what reads it (each imports its library), and how its files begin.

    others : formats, by their short names, that files with these suffixes may have as well.
    """

    title: str
    suffixes: tuple[str, ...]
    read: Callable[..., Table]
    begins: tuple[bytes, ...] = ()
    others: tuple[str, ...] = ()


_LVM, _SHEETS = b"LabVIEW Measurement", (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")

FORMATS = {
    "text": Format("delimited text", (".csv", ".tsv", ".txt", ".dat", ".asc"), text_file),
    "parquet": Format("Parquet", (".parquet", ".pq"), parquet_file, (b"PAR1",)),
    "matlab": Format("MATLAB", (".mat",), matlab_file, (b"MATLAB 5.0",), ("matlab73", "hdf5")),
    "matlab73": Format("MATLAB 7.3", (".mat",), hdf5_file, (b"MATLAB 7.3",)),
    "hdf5": Format("HDF5", (".h5", ".hdf5", ".hdf"), hdf5_file, (), ("matlab73",)),
    "uff": Format("a universal file", (".uff", ".unv", ".58"), uff_file),
    "tdms": Format("TDMS", (".tdms",), tdms_file, (b"TDSm", b"TDSh")),
    "wav": Format("WAV", (".wav", ".wave"), wav_file),
    "lvm": Format(
        *("a text file of LabVIEW", (".lvm",), lvm_file, (_LVM, b"\xef\xbb\xbf" + _LVM), ("text",))
    ),
    "spreadsheet": Format(
        "a spreadsheet", _SHEETS, spreadsheet_file, (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
    ),
    "npy": Format("an array of NumPy", (".npy",), numpy_file, (b"\x93NUMPY",)),
    "npz": Format("arrays of NumPy", (".npz",), numpy_file),
    "json": Format("JSON", (".json",), json_file, (), ("text",)),
}
"""The formats read, by short name."""


def content_of(path: Path) -> str | None:
    """Return the format that the first bytes of a file show, a key of FORMATS; None for another one."""
    with open(path, "rb") as stream:
        head = stream.read(_HEAD)
    if re.match(rb"PK\x03\x04.{26}[^\x00]*?\.npy", head, re.DOTALL):
        return "npz"  # the name of the first file in it shows that
    for name, kind in FORMATS.items():
        if head.startswith(kind.begins):
            return name
    if any(head[at:].startswith(b"\x89HDF\r\n\x1a\n") for at in (0, 512, 1024, 2048)):
        return "hdf5"
    if head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE":
        return "wav"
    if head.lstrip(b"\r\n").startswith(b"    -1"):
        return "uff"
    marked = head.startswith((b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"))  # the byte order
    control = any(byte < 9 or 13 < byte < 27 or 27 < byte < 32 for byte in head)
    return None if control and not marked else "text"


def checked_format(path: Path) -> Format:
    """Return the format of a regular file that is there, not empty, and what its name says it is. Raises RecordError
    otherwise."""
    try:
        if path.is_dir():
            raise RecordError(f"{path}: is a folder; give the files in it")
        size = path.stat().st_size
        if not path.is_file():
            raise RecordError(f"{path}: is a pipe or a device, not a file")
        named = next((n for n, f in FORMATS.items() if path.suffix.lower() in f.suffixes), None)
        if named is None:
            every = ", ".join(dict.fromkeys(end for of in FORMATS.values() for end in of.suffixes))
            unknown = f"unknown suffix {shortened(path.suffix)}"
            raise RecordError(f"{path}: {unknown}; records end in {every}")
        content = content_of(path)
    except FileNotFoundError:
        raise RecordError(f"{path}: no such file") from None
    except OSError as error:
        name = shortened(str(path), 200)[1:-1]
        raise RecordError(f"{name}: cannot be opened: {error.strerror}") from None
    kind = FORMATS[named]
    if size == 0:
        raise RecordError(f"{path}: is empty")
    if size > LARGEST_FILE:
        much = f"{size / 1e9:.3g} GB, more than the {LARGEST_FILE / 1e9:g} GB"
        raise RecordError(f"{path}: has {much} that are read; give a part of the record")
    wrong = f"{path}: is not {kind.title}, as its name says"
    if content is None:
        raise RecordError(
            f"{wrong}; its first bytes are those of no known format; it may be damaged"
        )
    if content not in (named, *kind.others):
        of = FORMATS[content]
        renamed = path.with_suffix(of.suffixes[0]).name
        raise RecordError(f"{wrong}, but {of.title}; rename it to {renamed}")
    return FORMATS["json" if named == "json" else content]
