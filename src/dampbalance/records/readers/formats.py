"""The format of a file, from its suffix, checked against its first bytes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from ...project.wording import shortened
from ..errors import LARGEST_FILE, RecordError

_BEGINNINGS: dict[str, bytes | tuple[bytes, ...]] = {
    "matlab": b"MATLAB 5.0",
    "matlab73": b"MATLAB 7.3",
    "parquet": b"PAR1",
    "tdms": (b"TDSm", b"TDSh"),
    "spreadsheet": (b"PK\x03\x04", b"\xd0\xcf\x11\xe0"),
    "lvm": (b"LabVIEW Measurement", b"\xef\xbb\xbfLabVIEW Measurement"),
    "npy": b"\x93NUMPY",
}
_HEAD = 4096  # bytes that are examined: a user block of a few kB may precede HDF5


class Format(NamedTuple):
    """A format: what people call it, its suffixes, and the kinds of content that it may have."""

    title: str
    suffixes: tuple[str, ...]
    contents: tuple[str, ...]


FORMATS = {
    "text": Format("delimited text", (".csv", ".tsv", ".txt", ".dat", ".asc"), ("text",)),
    "parquet": Format("Parquet", (".parquet", ".pq"), ("parquet",)),
    "matlab": Format("MATLAB", (".mat",), ("matlab", "matlab73", "hdf5")),
    "hdf5": Format("HDF5", (".h5", ".hdf5", ".hdf"), ("hdf5", "matlab73")),
    "uff": Format("a universal file", (".uff", ".unv", ".58"), ("uff",)),
    "tdms": Format("TDMS", (".tdms",), ("tdms",)),
    "wav": Format("WAV", (".wav", ".wave"), ("wav",)),
    "lvm": Format("a text file of LabVIEW", (".lvm",), ("lvm",)),
    "spreadsheet": Format(
        "a spreadsheet", (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods"), ("spreadsheet",)
    ),
    "npy": Format("an array of NumPy", (".npy",), ("npy",)),
    "npz": Format("arrays of NumPy", (".npz",), ("npz",)),
    "json": Format("JSON", (".json",), ("text",)),
}
"""The formats read, by short name."""


def format_by_suffix(path: Path) -> str:
    """Return the short name of the format that the suffix stands for. Raises RecordError naming the suffixes known."""
    for name, kind in FORMATS.items():
        if path.suffix.lower() in kind.suffixes:
            return name
    every = ", ".join(suffix for kind in FORMATS.values() for suffix in kind.suffixes)
    raise RecordError(f"{path}: unknown suffix {shortened(path.suffix)}; records end in {every}")


def content_of(path: Path) -> str | None:
    """Return the format that the first bytes of a file show, matlab73 or a key of FORMATS; None for another format."""
    with open(path, "rb") as stream:
        head = stream.read(_HEAD)
    if re.match(rb"PK\x03\x04.{26}[^\x00]*?\.npy", head, re.DOTALL):
        return "npz"  # the name of the first file in it shows that
    for content, beginnings in _BEGINNINGS.items():
        if head.startswith(beginnings):
            return content
    if any(head[at:].startswith(b"\x89HDF\r\n\x1a\n") for at in (0, 512, 1024, 2048)):
        return "hdf5"
    if head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE":
        return "wav"
    if head.lstrip(b"\r\n").startswith(b"    -1"):
        return "uff"
    marked = head.startswith((b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"))  # the byte order
    control = any(byte < 9 or 13 < byte < 27 or 27 < byte < 32 for byte in head)
    return None if control and not marked else "text"


def checked_format(path: Path) -> str:
    """Return the content (`content_of`) of a regular file that is there, not empty, and what its name says it is.
    Raises RecordError otherwise."""
    try:
        if path.is_dir():
            raise RecordError(f"{path}: is a folder; give the files in it")
        size = path.stat().st_size
        if not path.is_file():
            raise RecordError(f"{path}: is a pipe or a device, not a file")
        kind = FORMATS[format_by_suffix(path)]
        content = content_of(path)
    except FileNotFoundError:
        raise RecordError(f"{path}: no such file") from None
    except OSError as error:
        name = shortened(str(path), 200)[1:-1]
        raise RecordError(f"{name}: cannot be opened: {error.strerror}") from None
    if size == 0:
        raise RecordError(f"{path}: is empty")
    if size > LARGEST_FILE:
        much = f"{size / 1e9:.3g} GB, more than the {LARGEST_FILE / 1e9:g} GB"
        raise RecordError(f"{path}: has {much} that are read; give a part of the record")
    if content is None:
        remedy = "its first bytes are those of no known format; it may be damaged"
        raise RecordError(f"{path}: is not {kind.title}, as its name says; {remedy}")
    if content not in kind.contents:
        known = FORMATS["matlab" if content == "matlab73" else content]
        version = {"matlab": " 5", "matlab73": " 7.3"}.get(content, "")
        raise RecordError(
            f"{path}: is not {kind.title}, as its name says, but {known.title}{version}; rename it to "
            f"{path.with_suffix(known.suffixes[0]).name}"
        )
    return "json" if kind is FORMATS["json"] else content
