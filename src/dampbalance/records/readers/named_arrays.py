"""Files of named arrays: Parquet, and what HDF5 and MATLAB have in common."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError, library
from .record_file import (
    RawChannel,
    RecordFile,
    Sliced,
    described,
    intact,
    require_channels,
    unit_among,
)


class ParquetFile(RecordFile):
    """A Parquet file; the unit of a column from its field's metadata, else from its name."""

    def __init__(self, path: Path, largest: int) -> None:
        parquet = library("pyarrow.parquet", "Parquet")
        self.path = path
        with intact(path, "Parquet"):
            self._file = parquet.ParquetFile(path)
        size = self._file.metadata.num_rows
        channels = []
        self._ticks: dict[str, float] = {}  # seconds, by column of points in time or spans of it
        for field in self._file.schema_arrow:
            if (tick := _tick(field.type)) is not None:
                self._ticks[field.name] = tick
                channels.append(RawChannel(field.name, "s", size, label=field.name, stamps=True))
                continue
            metadata = {k.decode(errors="replace"): v for k, v in (field.metadata or {}).items()}
            channels.append(described(path, field.name, size, {}, unit_among(metadata)))
        self.channels = tuple(channels)

    def blocks(self, wanted: Sequence[int], size: int | None) -> Iterator[list[Array]]:
        """The wanted columns, `size` rows at a time; a missing value is NaN."""
        names = [self._file.schema_arrow.names[i] for i in wanted]
        rows = size or max(1, self._file.metadata.num_rows)
        with intact(self.path, "Parquet"):
            origins = {name: self._origin(name) for name in names if name in self._ticks}
            pending: list[list[Array]] = []
            for batch in self._file.iter_batches(batch_size=rows, columns=sorted(set(names))):
                pending.append(
                    [
                        self._seconds(batch.column(name), origins[name], self._ticks[name])
                        if name in origins
                        else _floats(self.path, name, batch.column(name))
                        for name in names
                    ]
                )
                if sum(parts[0].size for parts in pending) == rows:
                    yield [np.concatenate(parts) for parts in zip(*pending, strict=True)]
                    pending = []
            if pending:
                yield [np.concatenate(parts) for parts in zip(*pending, strict=True)]

    def _origin(self, name: str) -> Any:
        """The first point in time of a column, in its ticks; for spans, which have an origin of their own, 0."""
        field = self._file.schema_arrow.field(name)
        arrow, types = (library(of, "Parquet") for of in ("pyarrow", "pyarrow.types"))
        if types.is_duration(field.type):
            return arrow.scalar(0, arrow.int64())
        first = next(self._file.iter_batches(batch_size=1, columns=[name]), None)
        ticks = None if first is None else first.column(name).cast(arrow.int64())
        return arrow.scalar(0, arrow.int64()) if ticks is None or not len(ticks) else ticks[0]

    @staticmethod
    def _seconds(column: Any, origin: Any, tick: float) -> Array:
        arrow, compute = (library(of, "Parquet") for of in ("pyarrow", "pyarrow.compute"))
        ticks = compute.subtract(column.cast(arrow.int64()), origin)  # exact: 19 digits
        return tick * np.asarray(ticks.to_numpy(zero_copy_only=False), dtype=np.float64)

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


def signals_in(
    path: Path,
    what: str,
    arrays: Iterable[tuple[str, Any, dict[str, object], str | None]],
    close: Callable[[], None] = lambda: None,
) -> Sliced:
    """The signals in arrays (name, array, attributes, unit): each array itself, or its rows or columns if it has two.

    A signal runs along the longer side.
    """
    channels: list[RawChannel] = []
    signals = []
    for name, data, attributes, unit in arrays:
        if data.size < 2 or data.ndim > 2:
            continue
        several = data.ndim == 2 and min(data.shape) > 1
        require_channels(path, len(channels) + (min(data.shape) if several else 1))
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


def _tick(kind: Any) -> float | None:
    """Seconds per unit of points in time, or spans of it; None for any other type."""
    types = library("pyarrow.types", "Parquet")
    timed = types.is_timestamp(kind) or types.is_duration(kind)
    return {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit] if timed else None


def _floats(path: Path, name: str, column: Any) -> Array:
    types = library("pyarrow.types", "Parquet")
    held = column.type.value_type if types.is_dictionary(column.type) else column.type
    if not (types.is_integer(held) or types.is_floating(held) or types.is_decimal(held)):
        what = shortened(str(column.type))[1:-1]
        raise RecordError(f"{path}: column {shortened(name)} holds {what}, not numbers")
    return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)
