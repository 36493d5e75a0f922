"""Parquet, HDF5 and MATLAB: files of named arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ..errors import RecordError, library
from ..units import split_label
from .record_file import (
    RATE_NAMES,
    START_NAMES,
    STEP_NAMES,
    RawChannel,
    RecordFile,
    Sliced,
    described,
    intact,
    unit_among,
)


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
            name, unit = split_label(field.name)
            metadata = {k.decode(): v for k, v in (field.metadata or {}).items()}
            channels.append(RawChannel(name, unit_among(metadata) or unit, size, label=field.name))
        self.channels = tuple(channels)

    def blocks(self, wanted: Sequence[int], size: int | None) -> Iterator[list[Array]]:
        """The wanted columns, `size` rows at a time; a missing value is NaN."""
        names = [self._file.schema_arrow.names[i] for i in wanted]
        rows = size or max(1, self._file.metadata.num_rows)
        with intact(self.path, "Parquet"):
            pending: list[list[Array]] = [[] for _ in names]
            for batch in self._file.iter_batches(batch_size=rows, columns=sorted(set(names))):
                for parts, name in zip(pending, names, strict=True):
                    parts.append(_floats(self.path, name, batch.column(name)))
                if size is not None and sum(part.size for part in pending[0]) == rows:
                    yield [np.concatenate(parts) for parts in pending]
                    pending = [[] for _ in names]
            if pending[0]:
                yield [np.concatenate(parts) for parts in pending]

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
    datasets: dict[str, Any] = {}
    with intact(path, "HDF5", file.close):
        _collect(h5py, file, "", {}, datasets)
    scalars = {n.rpartition("/")[2]: d[()].item() for n, (d, _) in datasets.items() if d.size == 1}
    channels, arrays = [], []
    for name, (data, inherited) in datasets.items():
        if data.size < 2:
            continue
        for column in _columns(data.shape):
            attributes = scalars | inherited | dict(data.attrs)
            label = name if column is None else f"{name}[{column + 1}]"
            unit = unit_among(dict(data.attrs))
            channels.append(described(path, label, max(data.shape), attributes, unit))
            arrays.append((data, column))

    def read(i: int, begin: int, end: int) -> Array:
        data, column = arrays[i]
        with intact(path, "HDF5"):
            if data.ndim == 1:
                part = data[begin:end]
            elif data.shape[0] >= data.shape[1]:
                part = data[begin:end, column or 0]
            else:
                part = data[column or 0, begin:end]
        return np.asarray(part, dtype=np.float64)

    return Sliced(path, channels, read, file.close)


def matlab_file(path: Path) -> RecordFile:
    """A MATLAB 5 file: every real array in it is a channel, a field of a structure by "structure.field"."""
    reader = library("pymatreader", "MATLAB")
    with intact(path, "MATLAB"):
        document = reader.read_mat(str(path))
    fields = dict(_flat({k: v for k, v in document.items() if not k.startswith("__")}, ""))
    attributes: dict[str, object] = {
        name.rpartition(".")[2]: value
        for name, value in fields.items()
        if np.size(value) == 1
        and name.rpartition(".")[2].lower() in (*RATE_NAMES, *STEP_NAMES, *START_NAMES)
    }
    channels, arrays = [], []
    for name, value in fields.items():
        if not isinstance(value, np.ndarray) or value.size < 2:
            continue
        for column in _columns(value.shape):
            label = name if column is None else f"{name}[{column + 1}]"
            if column is None:
                data = value.reshape(-1)
            else:
                data = value[:, column] if value.shape[0] >= value.shape[1] else value[column]
            channels.append(described(path, label, data.size, attributes))
            arrays.append(data)
    return Sliced(path, channels, lambda i, a, b: np.asarray(arrays[i][a:b], dtype=np.float64))


def _floats(path: Path, name: str, column: Any) -> Array:
    try:
        return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)
    except (TypeError, ValueError):
        raise RecordError(f"{path}: column {name!r} holds {column.type}, not numbers") from None


def _collect(
    h5py: Any, group: Any, prefix: str, inherited: dict[str, object], datasets: dict[str, Any]
) -> None:
    """Every array of real numbers below a group, by its path, with the attributes of the groups that hold it."""
    here = inherited | dict(group.attrs)
    for name in group:
        if name.startswith("#"):  # MATLAB's own: #refs#, #subsystem#
            continue
        item = group[name]
        if isinstance(item, h5py.Group):
            _collect(h5py, item, f"{prefix}{name}/", here, datasets)
        elif isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            text = item.attrs.get("MATLAB_class") in (b"char", b"logical", "char", "logical")
            if not text and item.size and (item.ndim <= 2):
                datasets[f"{prefix}{name}"] = (item, here)


def _columns(shape: tuple[int, ...]) -> Sequence[int | None]:
    """The signals that an array holds: itself, or each row or column along its longer side."""
    if len(shape) < 2 or min(shape) == 1:
        return [None]
    return range(min(shape)) if len(shape) == 2 else []


def _flat(values: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        elif np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu"):
            yield f"{prefix}{name}", value
