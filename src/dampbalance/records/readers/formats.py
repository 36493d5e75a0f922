"""The formats of records: the suffixes of each, the first bytes of its files, and the function that reads them."""

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


class Format(NamedTuple):
    """A format of records.

    title : its usual name.   suffixes : of its files.   read : the function that reads it, which imports the library.
    begins : pattern of the first bytes.   others : other formats, by short names, that these suffixes may have.
    """

    title: str
    suffixes: tuple[str, ...]
    read: Callable[..., Table]
    begins: bytes
    others: tuple[str, ...] = ()


_SHEETS = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
_TEXTS = (".csv", ".tsv", ".txt", ".dat", ".asc")
# with a byte order mark, or without control bytes
_TEXT = rb"\xff\xfe|\xfe\xff|\xef\xbb\xbf|[\t-\r\x1b -\xff]*\Z"

# after a user block, if any
_HDF5 = rb"(.{512}|.{1024}|.{2048}|)\x89HDF\r\n\x1a\n"
_LVM, _NPZ = rb"(\xef\xbb\xbf)?LabVIEW Measurement", rb"PK\x03\x04.{26}[^\0]*?\.npy"
_SHEET = rb"PK\x03\x04|\xd0\xcf\x11\xe0"

FORMATS = {
    "text": Format("delimited text", _TEXTS, text_file, _TEXT),
    "parquet": Format("Parquet", (".parquet", ".pq"), parquet_file, b"PAR1"),
    "matlab": Format("MATLAB", (".mat",), matlab_file, b"MATLAB 5.0", ("matlab73", "hdf5")),
    "matlab73": Format("MATLAB 7.3", (".mat",), hdf5_file, b"MATLAB 7.3"),
    "hdf5": Format("HDF5", (".h5", ".hdf5", ".hdf"), hdf5_file, _HDF5, ("matlab73",)),
    "uff": Format("a universal file", (".uff", ".unv", ".58"), uff_file, rb"[\r\n]*    -1"),
    "tdms": Format("TDMS", (".tdms",), tdms_file, b"TDS[mh]"),
    "wav": Format("WAV", (".wav", ".wave"), wav_file, b"(RIFF|RIFX|RF64).{4}WAVE"),
    "lvm": Format("a text file of LabVIEW", (".lvm",), lvm_file, _LVM, ("text",)),
    "npy": Format("an array of NumPy", (".npy",), numpy_file, rb"\x93NUMPY"),
    "npz": Format("arrays of NumPy", (".npz",), numpy_file, _NPZ),
    "spreadsheet": Format("a spreadsheet", _SHEETS, spreadsheet_file, _SHEET),
    "json": Format("JSON", (".json",), json_file, b"(?!)", ("text",)),
}
"""The formats read, by short name."""

SUFFIXES = tuple(dict.fromkeys(end for of in FORMATS.values() for end in of.suffixes))
"""Suffixes of all formats."""


def checked_format(path: Path) -> Format:
    """Return the format of a file. Raises RecordError if it is no regular file, is empty or too large, or if its
    content does not agree with its suffix."""
    named = next((n for n, f in FORMATS.items() if path.suffix.lower() in f.suffixes), None)
    try:
        size = path.stat().st_size
        if not path.is_file():
            what = "a pipe or a device, not a file"
            what = "a folder; give the files in it" if path.is_dir() else what
            raise RecordError(f"{path}: is {what}")
        with open(path, "rb") as stream:
            # a user block of a few kB may precede HDF5
            head = stream.read(4096)
    except OSError as error:
        name = shortened(str(path), 200)[1:-1]
        raise RecordError(f"{name}: {str(error.strerror).lower()}") from None
    if named is None:
        raise RecordError(
            f"{path}: unknown suffix {shortened(path.suffix)}; records end in {', '.join(SUFFIXES)}"
        )
    if size == 0:
        raise RecordError(f"{path}: is empty")
    if size > LARGEST_FILE:
        much = f"{size / 1e9:.3g} GB, more than the {LARGEST_FILE / 1e9:g} GB"
        raise RecordError(f"{path}: has {much} that are read; give a part of the record")
    kind = FORMATS[named]
    # every format except text has characteristic first bytes
    shown = [n for n, of in FORMATS.items() if n != "text" and re.match(of.begins, head, re.DOTALL)]
    content, *_ = *shown, "text" if re.match(_TEXT, head) else ""
    if content in (named, *kind.others):
        return FORMATS["json" if named == "json" else content]
    remedy = "; its first bytes are those of no known format; it may be damaged"
    if content:
        renamed = path.with_suffix(FORMATS[content].suffixes[0]).name
        remedy = f", but {FORMATS[content].title}; rename it to {renamed}"
    raise RecordError(f"{path}: is not {kind.title}, as its name says{remedy}")
