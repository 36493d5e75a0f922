"""Parquet, HDF5 and MATLAB: files of named arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ..errors import RecordError, library
from .record_file import RecordFile, Sliced, described, intact, unit_among


class ParquetFile(RecordFile):
    """A Parquet file; the unit of a column from its field's metadata, else from its name."""

    def __init__(self, path: Path) -> None:
        parquet = library("pyarrow.parquet", "Parquet")
        self.path = path
        with intact(path, "Parquet"):
            self._file = parquet.ParquetFile(path)
        size = self._file.metadata.num_rows
        channels = []
        for field in self._file.schema_arrow:
            metadata = {k.decode(): v for k, v in (field.metadata or {}).items()}
            channels.append(described(path, field.name, size, {}, unit_among(metadata)))
        self.channels = tuple(channels)

    def blocks(self, wanted: Sequence[int], size: int | None) -> Iterator[list[Array]]:
        """The wanted columns, `size` rows at a time; a missing value is NaN."""
        names = [self._file.schema_arrow.names[i] for i in wanted]
        rows = size or max(1, self._file.metadata.num_rows)
        with intact(self.path, "Parquet"):
            pending: list[list[Array]] = []
            for batch in self._file.iter_batches(batch_size=rows, columns=sorted(set(names))):
                pending.append([_floats(self.path, name, batch.column(name)) for name in names])
                if sum(parts[0].size for parts in pending) == rows:
                    yield [np.concatenate(parts) for parts in zip(*pending, strict=True)]
                    pending = []
            if pending:
                yield [np.concatenate(parts) for parts in zip(*pending, strict=True)]

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


def hdf5_file(path: Path) -> RecordFile:
    """An HDF5 file, or one of MATLAB 7.3: every array of numbers in it is a channel, by its path.

    Unit and sampling rate are attributes of the array, or of the groups that hold it, or scalars beside it.
    """
    h5py = library("h5py", "HDF5")
    with intact(path, "HDF5"):
        file = h5py.File(path, "r")
    with intact(path, "HDF5", file.close):
        datasets = list(_datasets(h5py, file, "", {}))
    scalars = {n.rpartition("/")[2]: d[()].item() for n, d, _ in datasets if d.size == 1}
    arrays = [
        (name, data, scalars | inherited | dict(data.attrs), unit_among(dict(data.attrs)))
        for name, data, inherited in datasets
    ]
    return _signals(path, "HDF5", arrays, file.close)


def matlab_file(path: Path) -> RecordFile:
    """A MATLAB 5 file: every real array in it is a channel, a field of a structure by "structure.field"."""
    reader = library("pymatreader", "MATLAB")
    with intact(path, "MATLAB"):
        document = reader.read_mat(str(path))
    fields = dict(_flat({k: v for k, v in document.items() if not k.startswith("__")}, ""))
    scalars = {n.rpartition(".")[2]: value for n, value in fields.items() if np.size(value) == 1}
    arrays = [(n, v, scalars, None) for n, v in fields.items() if isinstance(v, np.ndarray)]
    return _signals(path, "MATLAB", arrays)


def _signals(
    path: Path,
    what: str,
    arrays: Iterable[tuple[str, Any, dict[str, object], str | None]],
    close: Callable[[], None] = lambda: None,
) -> Sliced:
    """The signals in arrays (name, array, attributes, unit): each array itself, or its rows or columns if it has two.

    A signal runs along the longer side.
    """
    channels, signals = [], []
    for name, data, attributes, unit in arrays:
        if data.size < 2 or data.ndim > 2:
            continue
        several = data.ndim == 2 and min(data.shape) > 1
        for i in range(min(data.shape) if several else 1):
            label = f"{name}[{i + 1}]" if several else name
            channels.append(described(path, label, max(data.shape), attributes, unit))
            signals.append((data, i))

    def read(channel: int, begin: int, end: int) -> Any:
        data, i = signals[channel]
        if data.ndim == 1:
            return data[begin:end]
        return data[begin:end, i] if data.shape[0] >= data.shape[1] else data[i, begin:end]

    return Sliced(path, channels, read, what, close)


def _floats(path: Path, name: str, column: Any) -> Array:
    try:
        return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)
    except (TypeError, ValueError):
        raise RecordError(f"{path}: column {name!r} holds {column.type}, not numbers") from None


def _datasets(
    h5py: Any, group: Any, prefix: str, inherited: dict[str, object]
) -> Iterator[tuple[str, Any, dict[str, object]]]:
    """Every array of real numbers below a group: its path, itself and the attributes of the groups that hold it."""
    here = inherited | dict(group.attrs)
    for name in group:
        if name.startswith("#"):  # MATLAB's own: #refs#, #subsystem#
            continue
        item = group[name]
        if isinstance(item, h5py.Group):
            yield from _datasets(h5py, item, f"{prefix}{name}/", here)
        elif (
            isinstance(item, h5py.Dataset)
            and item.dtype.kind in "fiu"
            and item.size
            and item.attrs.get("MATLAB_class") not in (b"char", b"logical", "char", "logical")
        ):
            yield f"{prefix}{name}", item, here


def _flat(values: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        elif np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu"):
            yield f"{prefix}{name}", value
