"""Files of named arrays: HDF5, also as MATLAB 7.3 has it, each group visited once; MATLAB 5, arrays and structures of
them, packed or not, whose numbers are counted before they are read.
"""

from __future__ import annotations

import itertools
import math
import struct
import zlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...project.wording import dotted, shortened
from ..errors import RecordError, library
from .record_file import (
    TIMING_NAMES,
    UNIT_NAMES,
    RecordFile,
    intact,
    require_channels,
    signals_in,
    too_large,
    unit_among,
)

_MOST_LINKS = 20_000
_DEEPEST = 64  # groups, or arrays, inside each other
_LARGEST_CHUNK = 256_000_000  # bytes that are unpacked at once
_LARGEST_ATTRIBUTE = 4096  # bytes
_NO_NUMBERS = (b"char", b"logical", "char", "logical")  # classes of MATLAB

# MATLAB 5
_HEADER = 128  # bytes
_ARRAY, _PACKED = 14, 15  # types of an element: an array, and one that is compressed
_TYPES = range(1, 19)
_BYTES = {3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8, 17: 2, 18: 4}  # of a number; others: 1
_PIECE = 1 << 20  # bytes unpacked at once


def hdf5_file(path: Path, largest: int) -> RecordFile:
    """An HDF5 file, or one of MATLAB 7.3: every array of numbers in it is a channel, by its path.

    Unit and sampling rate are attributes of the array, or of the groups that hold it, or scalars next to it.

    Raises RecordError for a file that would have others read: external links, external storage, virtual data sets.
    """
    h5py = library("h5py", "HDF5")
    with intact(path, "HDF5"):
        file = h5py.File(path, "r")
    with intact(path, "HDF5", file.close):
        datasets = list(_datasets(h5py, path, file))
        scalars = {
            last: d[()].item()
            for name, d, _ in datasets
            if d.size == 1 and (last := name.rpartition("/")[2]).lower() in TIMING_NAMES
        }
        owned = [(name, data, above, _attributes(data)) for name, data, above in datasets]
        arrays = [(n, d, scalars | above | own, unit_among(own)) for n, d, above, own in owned]
        return signals_in(path, "HDF5", arrays, file.close)


def _datasets(h5py: Any, path: Path, file: Any) -> Iterator[tuple[str, Any, dict[str, object]]]:
    """Every array of real numbers in a file, which is not left: its path, itself and the attributes of its groups."""
    links, visited = itertools.count(1), set[int]()  # addresses of groups

    def below(
        group: Any, prefix: str, inherited: dict[str, object], depth: int
    ) -> Iterator[tuple[str, Any, dict[str, object]]]:
        address = h5py.h5o.get_info(group.id).addr
        if address in visited:
            return
        visited.add(address)
        if depth > _DEEPEST:
            raise RecordError(f"{path}: has groups more than {_DEEPEST} deep; flatten it")
        here = inherited | _attributes(group)
        for name in group:
            if next(links) > _MOST_LINKS:
                remedy = "keep those of one record"
                raise RecordError(f"{path}: holds more than {_MOST_LINKS:,} objects; {remedy}")
            if name.startswith("#"):  # MATLAB's own: #refs#, #subsystem#
                continue
            where = f"{prefix}{name}"
            item = _linked(h5py, file, group, name, f"{path}: {shortened(where)}")
            if isinstance(item, h5py.Group):
                yield from below(item, f"{where}/", here, depth + 1)
            elif isinstance(item, h5py.Dataset) and (
                item.dtype.kind in "fiu"  # real numbers: no truth values, no enumeration, no text
                and item.size
                and h5py.check_enum_dtype(item.dtype) is None
                and item.attrs.get("MATLAB_class") not in _NO_NUMBERS
            ):
                _require_own(item, f"{path}: {shortened(where)}")
                yield where, item, here

    yield from below(file, "", {}, 0)


def _linked(h5py: Any, file: Any, group: Any, name: str, what: str) -> Any:
    """What a link leads to; None for a soft link that leads to no data set by hard links alone."""
    link = group.get(name, getlink=True)
    if isinstance(link, h5py.HardLink):
        return group[name]
    if isinstance(link, h5py.ExternalLink):
        raise RecordError(
            f"{what} is a link into another file, {shortened(link.filename)}; copy what it leads to into the record"
        )
    target = file if link.path.startswith("/") else group
    for part in filter(None, link.path.split("/")[:_DEEPEST]):
        inside = isinstance(target, h5py.Group) and target.get(part, None, getlink=True)
        if not isinstance(inside, h5py.HardLink):
            return None
        target = target[part]
    return target if isinstance(target, h5py.Dataset) else None


def _require_own(data: Any, what: str) -> None:
    """RecordError for an array that lies in other files, or in pieces too large to unpack."""
    if data.is_virtual:
        remedy = "copy its values into the record"
        raise RecordError(f"{what} is put together from other data sets; {remedy}")
    if data.external:
        raise RecordError(f"{what} lies in another file; copy its values into the record")
    if data.chunks and math.prod(data.chunks) * data.dtype.itemsize > _LARGEST_CHUNK:
        raise RecordError(
            f"{what} is stored in chunks of {math.prod(data.chunks):,} numbers, too large to unpack; store it in "
            "smaller ones"
        )


def _attributes(item: Any) -> dict[str, object]:
    """The attributes that may tell unit or timing, unless they are too long for that."""
    return {
        name: item.attrs[name]
        for name in item.attrs
        if name.lower() in TIMING_NAMES or name.lower() in UNIT_NAMES
        if item.attrs.get_id(name).get_storage_size() <= _LARGEST_ATTRIBUTE
    }


def matlab_file(path: Path, largest: int) -> RecordFile:
    """A MATLAB 5 file: every real array in it is a channel, a field of a structure by "structure.field", with [1], [2],
    … behind it where there is an array of structures. Raises RecordError when it holds more numbers than may be read
    whole, a quarter of `largest`."""
    from scipy.io import whosmat  # slow to import

    reader = library("pymatreader", "MATLAB")
    with intact(path, "MATLAB"):
        _require_readable(path, largest // 4)
        truths = {name for name, _, kind in whosmat(path) if kind == "logical"}
        document = reader.read_mat(str(path))
    held = {n: v for n, v in document.items() if not n.startswith("__") and n not in truths}
    fields: dict[str, Any] = {
        name: value
        for name, value in _unrolled(dotted(held))
        if np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu")
    }
    scalars = {n.rpartition(".")[2]: value for n, value in fields.items() if np.size(value) == 1}
    arrays = [(n, v, scalars, None) for n, v in fields.items() if isinstance(v, np.ndarray)]
    return signals_in(path, "MATLAB", arrays)


def _unrolled(fields: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Fields by name; those of an array of structures are lists, of which each array is field[1], field[2], …"""
    for name, value in fields:
        if isinstance(value, list) and all(isinstance(one, np.ndarray) for one in value):
            yield from ((f"{name}[{i}]", one) for i, one in enumerate(value, start=1))
        else:
            yield name, value


def _require_readable(path: Path, most: int) -> None:
    """RecordError for a file whose arrays hold more than `most` numbers, or each other too deeply. What is beyond them
    is not counted: it has a number in each byte at the most."""
    numbers = elements = 0
    with open(path, "rb") as stream:
        order = ">" if stream.read(_HEADER).endswith(b"MI") else "<"
        while len(tag := stream.read(8)) == 8:
            kind, size = struct.unpack(f"{order}II", tag)
            end = stream.tell() + size
            elements += 1
            require_channels(path, elements)
            read: Callable[[int], bytes] = stream.read
            if kind == _PACKED:
                read = _Unpacked(stream, size).read
                kind, size = struct.unpack(f"{order}II", read(8))
            if kind == _ARRAY and numbers <= most:
                for count in _counts(read, order, size):
                    numbers += count
                    if numbers > most:
                        break
            if kind == _ARRAY and numbers > most:
                numbers += size
            stream.seek(end)
    if numbers > most:
        holds = f"holds more than {most:,} numbers"
        raise too_large(path, holds, "MATLAB 5", 4 * numbers, ", save it as -v7.3")


def _counts(read: Callable[[int], bytes], order: str, left: int, depth: int = 1) -> Iterator[int]:
    """How many numbers each part of an array of `left` bytes says it has, before they are read. Raises ValueError for
    parts that do not fit into what holds them."""
    if depth > _DEEPEST:
        raise ValueError(f"arrays more than {_DEEPEST} deep")
    while left >= 8:
        kind, count = struct.unpack(f"{order}II", read(8))
        left -= 8
        if kind >> 16:  # a part that stands in its tag
            continue
        if kind not in _TYPES:
            raise ValueError(f"a part of no known type ({kind})")
        if count > left:
            raise ValueError("a part is larger than what holds it")
        padded = min(count + -count % 8, left)
        left -= padded
        if kind == _ARRAY:
            yield from _counts(read, order, padded, depth + 1)
        else:
            yield count // _BYTES.get(kind, 1)
            _skip(read, padded)
    _skip(read, left)


def _skip(read: Callable[[int], bytes], count: int) -> None:
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
