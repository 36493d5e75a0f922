"""MATLAB 5: arrays and structures of them, packed or not. What it unpacks to is counted before it is read."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ..errors import RecordError, library
from .named_arrays import signals_in
from .record_file import RecordFile, intact, require_channels

_HEADER = 128  # bytes
_PACKED = 15  # type of an element: a compressed one
_PIECE = 1 << 20  # bytes unpacked at once


def matlab_file(path: Path, largest: int) -> RecordFile:
    """A MATLAB 5 file: every real array in it is a channel, a field of a structure by "structure.field".

    Raises RecordError when it unpacks to more than `largest` bytes, each of which may stand for a number.
    """
    reader = library("pymatreader", "MATLAB")
    from scipy.io import whosmat

    with intact(path, "MATLAB"):
        _require_unpackable(path, largest)
        truths = {name for name, _, kind in whosmat(path) if kind == "logical"}
        document = reader.read_mat(str(path))
    found = {k: v for k, v in document.items() if not k.startswith("__") and k not in truths}
    fields = dict(_flat(found, ""))
    scalars = {n.rpartition(".")[2]: value for n, value in fields.items() if np.size(value) == 1}
    arrays = [(n, v, scalars, None) for n, v in fields.items() if isinstance(v, np.ndarray)]
    return signals_in(path, "MATLAB", arrays)


def _require_unpackable(path: Path, largest: int) -> None:
    """RecordError for a file whose elements are more than `largest` bytes when they are unpacked."""
    total = 0
    with open(path, "rb") as stream:
        order = ">" if stream.read(_HEADER).endswith(b"MI") else "<"
        elements = 0
        while len(tag := stream.read(8)) == 8:
            kind, size = struct.unpack(f"{order}II", tag)
            end = stream.tell() + size
            elements += 1
            require_channels(path, elements)
            for piece in _unpacked(stream, size) if kind == _PACKED else [size]:
                total += piece
                if total > largest:
                    raise RecordError(
                        f"{path}: unpacks to more than {largest:,} bytes, and MATLAB 5 is read whole; give a part of the "
                        f"record, save it as -v7.3, or raise the limit (--largest {10 * largest})"
                    )
            stream.seek(end)


def _unpacked(stream: BinaryIO, size: int) -> Iterator[int]:
    """The sizes of the pieces, bytes, that an element of `size` packed bytes unpacks to."""
    unpacker = zlib.decompressobj()
    while size > 0 and not unpacker.eof and (packed := stream.read(min(size, _PIECE))):
        size -= len(packed)
        count = _PIECE
        while packed or count == _PIECE:
            count = len(unpacker.decompress(packed, _PIECE))
            packed = unpacker.unconsumed_tail
            yield count


def _flat(values: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        elif np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu"):
            yield f"{prefix}{name}", value
