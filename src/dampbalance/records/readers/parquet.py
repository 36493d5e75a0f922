"""Parquet: columns of numbers, of points in time and of spans of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError, library
from .record_file import RawChannel, RecordFile, described, intact, unit_among

_TICKS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}  # s


class ParquetFile(RecordFile):
    """A Parquet file; the unit of a column from its field's metadata, else from its name."""

    def __init__(self, path: Path, largest: int) -> None:
        names = ("pyarrow", "pyarrow.compute", "pyarrow.types", "pyarrow.parquet")
        self._arrow, self._compute, self._types, parquet = (library(n, "Parquet") for n in names)
        self.path = path
        with intact(path, "Parquet"):
            self._file = parquet.ParquetFile(path)
        self.channels = [self._channel(field) for field in self._file.schema_arrow]

    def _channel(self, field: Any) -> RawChannel:
        size = self._file.metadata.num_rows
        if self._is_time(field.type):
            return RawChannel(field.name, "s", size, label=field.name, stamps=True)
        metadata = {k.decode(errors="replace"): v for k, v in (field.metadata or {}).items()}
        return described(self.path, field.name, size, {}, unit_among(metadata))

    def blocks(self, wanted: Sequence[int], size: int) -> Iterator[list[Array]]:
        """The wanted columns, `size` rows at a time; a missing value is NaN."""
        fields = [self._file.schema_arrow.field(i) for i in wanted]
        names = sorted({field.name for field in fields})
        with intact(self.path, "Parquet"):
            origins = [self._origin(field) for field in fields]
            pending: list[list[Array]] = []
            for batch in self._file.iter_batches(batch_size=size, columns=names):
                pending.append(list(map(self._numbers, fields, [batch] * len(fields), origins)))
                if sum(parts[0].size for parts in pending) == size:
                    yield [np.concatenate(parts) for parts in zip(*pending, strict=True)]
                    pending = []
            if pending:
                yield [np.concatenate(parts) for parts in zip(*pending, strict=True)]

    def _is_time(self, kind: Any) -> bool:
        return bool(self._types.is_timestamp(kind) or self._types.is_duration(kind))

    def _origin(self, field: Any) -> Any:
        """The first point in time of a column, in its ticks; 0 for spans, which have their own, and for numbers."""
        if self._types.is_timestamp(field.type):
            for batch in self._file.iter_batches(batch_size=1, columns=[field.name]):
                if len(batch):
                    return batch.column(field.name).cast(self._arrow.int64())[0]
        return self._arrow.scalar(0, self._arrow.int64())

    def _numbers(self, field: Any, batch: Any, origin: Any) -> Array:
        column, types = batch.column(field.name), self._types
        if self._is_time(field.type):
            # exact: 19 digits
            ticks = self._compute.subtract(column.cast(self._arrow.int64()), origin)
            return _TICKS[field.type.unit] * _floats(ticks)
        held = column.type.value_type if types.is_dictionary(column.type) else column.type
        if not (types.is_integer(held) or types.is_floating(held) or types.is_decimal(held)):
            what = shortened(str(column.type))[1:-1]
            raise RecordError(
                f"{self.path}: column {shortened(field.name)} holds {what}, not numbers"
            )
        return _floats(column)

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


def _floats(column: Any) -> Array:
    return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)
