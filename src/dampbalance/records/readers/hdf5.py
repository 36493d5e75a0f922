"""HDF5, also as MATLAB 7.3 has it: every array of numbers in the file itself, each group visited once."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...project.wording import shortened
from ..errors import RecordError, library
from .record_file import TIMING_NAMES, UNIT_NAMES, RecordFile, intact, signals_in, unit_among

_MOST_LINKS = 20_000
_DEEPEST = 64  # groups inside each other
_LARGEST_CHUNK = 256_000_000  # bytes that are unpacked at once
_LARGEST_ATTRIBUTE = 4096  # bytes
_NO_NUMBERS = (b"char", b"logical", "char", "logical")  # classes of MATLAB


def hdf5_file(path: Path, largest: int) -> RecordFile:
    """An HDF5 file, or one of MATLAB 7.3: every array of numbers in it is a channel, by its path.

    Unit and sampling rate are attributes of the array, or of the groups that hold it, or scalars beside it.

    Raises RecordError for a file that would have others read: external links, external storage, virtual data sets.
    """
    h5py = library("h5py", "HDF5")
    with intact(path, "HDF5"):
        file = h5py.File(path, "r")
    with intact(path, "HDF5", file.close):
        datasets = list(_Contents(h5py, path, file).datasets(file, "", {}, 0))
        scalars = {
            last: d[()].item()
            for name, d, _ in datasets
            if d.size == 1 and (last := name.rpartition("/")[2]).lower() in TIMING_NAMES
        }
        owned = [(name, data, above, _attributes(data)) for name, data, above in datasets]
        arrays = [(n, d, scalars | above | own, unit_among(own)) for n, d, above, own in owned]
        return signals_in(path, "HDF5", arrays, file.close)


class _Contents:
    """What a file holds, found without leaving it."""

    def __init__(self, h5py: Any, path: Path, file: Any) -> None:
        self.h5py, self.path, self.file = h5py, path, file
        self.links = 0
        self.visited: set[int] = set()  # addresses of groups

    def datasets(
        self, group: Any, prefix: str, inherited: dict[str, object], depth: int
    ) -> Iterator[tuple[str, Any, dict[str, object]]]:
        """Every array of real numbers below a group: its path, itself and the attributes of the groups that hold it."""
        address = self.h5py.h5o.get_info(group.id).addr
        if address in self.visited:
            return
        self.visited.add(address)
        if depth > _DEEPEST:
            raise RecordError(f"{self.path}: has groups more than {_DEEPEST} deep; flatten it")
        here = inherited | _attributes(group)
        for name in group:
            self.links += 1
            if self.links > _MOST_LINKS:
                raise RecordError(
                    f"{self.path}: holds more than {_MOST_LINKS:,} objects; keep those of one record"
                )
            if name.startswith("#"):  # MATLAB's own: #refs#, #subsystem#
                continue
            item, where = self.item(group, name, f"{prefix}{name}"), f"{prefix}{name}"
            if isinstance(item, self.h5py.Group):
                yield from self.datasets(item, f"{where}/", here, depth + 1)
            elif isinstance(item, self.h5py.Dataset) and self.holds_numbers(item):
                self.require_own(item, f"{self.path}: {shortened(where)}")
                yield where, item, here

    def item(self, group: Any, name: str, where: str) -> Any:
        """What a link leads to; None for a soft link that leads to no data set by hard links alone."""
        link = group.get(name, getlink=True)
        if isinstance(link, self.h5py.HardLink):
            return group[name]
        if isinstance(link, self.h5py.ExternalLink):
            raise RecordError(
                f"{self.path}: {shortened(where)} is a link into another file, {shortened(link.filename)}; copy what "
                "it leads to into the record"
            )
        target = self.file if link.path.startswith("/") else group
        for part in filter(None, link.path.split("/")[:_DEEPEST]):
            if not isinstance(target, self.h5py.Group) or not isinstance(
                target.get(part, None, getlink=True), self.h5py.HardLink
            ):
                return None
            target = target[part]
        return target if isinstance(target, self.h5py.Dataset) else None

    def holds_numbers(self, data: Any) -> bool:
        """Whether a data set holds real numbers: no truth values, no enumeration, no text."""
        return bool(
            data.dtype.kind in "fiu"
            and data.size
            and self.h5py.check_enum_dtype(data.dtype) is None
            and data.attrs.get("MATLAB_class") not in _NO_NUMBERS
        )

    @staticmethod
    def require_own(data: Any, what: str) -> None:
        """RecordError for an array that lies in other files, or in pieces too large to unpack."""
        if data.is_virtual:
            raise RecordError(
                f"{what} is put together from other data sets; copy its values into the record"
            )
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
