"""MATLAB 5: arrays and structures of them, packed or not. What it holds is counted before it is read."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from scipy.io import whosmat

from ...project.wording import dotted
from ..errors import library
from .record_file import RecordFile, intact, require_channels, signals_in, too_large

_HEADER = 128  # bytes
_ARRAY, _PACKED = 14, 15  # types of an element: an array, and one that is compressed
_TYPES = range(1, 19)
_BYTES = {3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8, 17: 2, 18: 4}  # of a number; others: 1
_DEEPEST = 64  # arrays inside each other
_PIECE = 1 << 20  # bytes unpacked at once

_Read = Callable[[int], bytes]


def matlab_file(path: Path, largest: int) -> RecordFile:
    """A MATLAB 5 file: every real array in it is a channel, a field of a structure by "structure.field".

    Raises RecordError when it holds more numbers than may be read whole, a quarter of `largest`.
    """
    reader = library("pymatreader", "MATLAB")
    with intact(path, "MATLAB"):
        _require_readable(path, largest // 4)
        truths = {name for name, _, kind in whosmat(path) if kind == "logical"}
        document = reader.read_mat(str(path))
    held = {n: v for n, v in document.items() if not n.startswith("__") and n not in truths}
    fields: dict[str, Any] = {
        name: value
        for name, value in dotted(held)
        if np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu")
    }
    scalars = {n.rpartition(".")[2]: value for n, value in fields.items() if np.size(value) == 1}
    arrays = [(n, v, scalars, None) for n, v in fields.items() if isinstance(v, np.ndarray)]
    return signals_in(path, "MATLAB", arrays)


def _require_readable(path: Path, most: int) -> None:
    """RecordError for a file whose arrays hold more than `most` numbers, or each other too deeply."""
    numbers = elements = 0
    with open(path, "rb") as stream:
        order = ">" if stream.read(_HEADER).endswith(b"MI") else "<"
        while len(tag := stream.read(8)) == 8:
            kind, size = struct.unpack(f"{order}II", tag)
            end = stream.tell() + size
            elements += 1
            require_channels(path, elements)
            read: _Read = stream.read
            if kind == _PACKED:
                read = _Unpacked(stream, size).read
                kind, size = struct.unpack(f"{order}II", read(8))
            for count in _counts(read, order, size) if kind == _ARRAY else [0]:
                numbers += count
                if numbers > most:
                    holds = f"holds more than {most:,} numbers"
                    raise too_large(path, holds, "MATLAB 5", 16 * most, ", save it as -v7.3")
            stream.seek(end)


def _counts(read: _Read, order: str, size: int) -> Iterator[int]:
    """How many numbers each part of an array of `size` bytes says it has, before they are read.

    Raises ValueError for parts that do not fit into what holds them.
    """
    left = [size]  # bytes of each array that holds the next
    while left:
        if left[-1] < 8:
            _skip(read, left.pop())
            continue
        kind, count = struct.unpack(f"{order}II", read(8))
        left[-1] -= 8
        if kind >> 16:  # a part that stands in its tag
            continue
        if kind not in _TYPES:
            raise ValueError(f"a part of no known type ({kind})")
        if count > left[-1]:
            raise ValueError("a part is larger than what holds it")
        padded = min(count + -count % 8, left[-1])
        left[-1] -= padded
        if kind == _ARRAY:
            left.append(padded)
            if len(left) > _DEEPEST:
                raise ValueError(f"arrays more than {_DEEPEST} deep")
        else:
            yield count // _BYTES.get(kind, 1)
            _skip(read, padded)


def _skip(read: _Read, count: int) -> None:
    while count > 0 and (passed := len(read(min(count, _PIECE)))):
        count -= passed


class _Unpacked:
    """The bytes that an element of `size` packed bytes unpacks to, a piece at a time."""

    def __init__(self, stream: BinaryIO, size: int) -> None:
        self.stream, self.left = stream, size
        self.unpacker, self.ready = zlib.decompressobj(), b""

    def read(self, count: int) -> bytes:
        """The next bytes, fewer at the end."""
        while len(self.ready) < count and not self.unpacker.eof:
            packed = self.unpacker.unconsumed_tail or self.stream.read(min(self.left, _PIECE))
            self.left -= len(packed) - len(self.unpacker.unconsumed_tail)
            piece = self.unpacker.decompress(packed, _PIECE)
            if not piece and not packed:
                break
            self.ready += piece
        taken, self.ready = self.ready[:count], self.ready[count:]
        return taken
