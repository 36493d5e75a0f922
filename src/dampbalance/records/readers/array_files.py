"""Files of named arrays: HDF5, also as MATLAB 7.3 has it; MATLAB 5, arrays and structures of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...project.wording import dotted
from ..errors import library, require_size
from ..table import TIMING_NAMES, UNIT_NAMES, Table, intact, signals_in, unit_among

_NO_NUMBERS = (b"char", b"logical", "char", "logical")  # classes of MATLAB


def hdf5_file(path: Path) -> Table:
    """An HDF5 file, or one of MATLAB 7.3: every array of numbers in it is a channel, by its path.

    Unit and sampling rate are attributes of the array, or of the groups that hold it, or scalars next to it.
    """
    h5py = library("h5py", "HDF5")
    with intact(path, "HDF5"), h5py.File(path, "r") as file:
        datasets = list(_datasets(h5py, file))
        scalars = {
            last: d[()].item()
            for name, d, _ in datasets
            if d.size == 1 and (last := name.rpartition("/")[2]).lower() in TIMING_NAMES
        }
        owned = [(name, data.shape, above, _attributes(data)) for name, data, above in datasets]
        arrays = [
            (n, size, scalars | above | own, unit_among(own)) for n, size, above, own in owned
        ]
        channels, signals = signals_in(path, arrays)

    def load(wanted: Sequence[int]) -> list[Any]:
        with h5py.File(path, "r") as file:
            return [signals[i](file) for i in wanted]

    return Table(path, channels, load, "HDF5")


def _datasets(h5py: Any, file: Any) -> Iterator[tuple[str, Any, dict[str, object]]]:
    """Every array of real numbers in a file: its path, itself and the attributes of its groups. Each is visited once,
    by hard links alone."""
    visited: list[tuple[str, Any]] = []
    file.visititems(lambda name, item: visited.append((name, item)))
    groups = {"": _attributes(file)}
    for name, item in visited:
        above = groups.get(name.rpartition("/")[0])
        if above is None or name.rpartition("/")[2].startswith("#"):  # MATLAB's own: #refs#
            continue
        if isinstance(item, h5py.Group):
            groups[name] = above | _attributes(item)
        elif isinstance(item, h5py.Dataset) and (
            item.dtype.kind in "fiu"  # real numbers: no truth values, no enumeration, no text
            and item.size
            and h5py.check_enum_dtype(item.dtype) is None
            and item.attrs.get("MATLAB_class") not in _NO_NUMBERS
        ):
            yield name, item, above


def _attributes(item: Any) -> dict[str, object]:
    """The attributes that may tell unit or timing."""
    return {
        name: item.attrs[name]
        for name in item.attrs
        if name.lower() in TIMING_NAMES or name.lower() in UNIT_NAMES
    }


def matlab_file(path: Path) -> Table:
    """A MATLAB 5 file: every real array in it is a channel, a field of a structure by "structure.field", with [1], [2],
    … behind it where there is an array of structures. Raises RecordError for arrays too large for memory."""
    from scipy.io import whosmat  # slow to import

    reader = library("pymatreader", "MATLAB")
    with intact(path, "MATLAB"):
        stated = whosmat(path)
        require_size(path, sum(math.prod(shape) for _, shape, _ in stated))
        truths = {name for name, _, kind in stated if kind == "logical"}
        document = reader.read_mat(str(path))
    held = {n: v for n, v in document.items() if not n.startswith("__") and n not in truths}
    fields: dict[str, Any] = {
        name: value
        for name, value in _unrolled(dotted(held))
        if np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu")
    }
    scalars = {n.rpartition(".")[2]: value for n, value in fields.items() if np.size(value) == 1}
    arrays = [(n, v.shape, scalars, None) for n, v in fields.items() if isinstance(v, np.ndarray)]
    channels, signals = signals_in(path, arrays)
    return Table(path, channels, lambda wanted: [signals[i](fields) for i in wanted], "MATLAB")


def _unrolled(fields: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Fields by name; those of an array of structures are lists, of which each array is field[1], field[2], …"""
    for name, value in fields:
        if isinstance(value, list) and all(isinstance(one, np.ndarray) for one in value):
            yield from ((f"{name}[{i}]", one) for i, one in enumerate(value, start=1))
        else:
            yield name, value
