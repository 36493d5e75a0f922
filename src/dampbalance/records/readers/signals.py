"""Signals that are in memory, in arrays or a table of pandas, read as those of a file are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError
from .record_file import TIMING_NAMES, RawChannel, Sliced, described, require_nameable

if TYPE_CHECKING:
    import pandas as pd

    Signals: TypeAlias = pd.DataFrame | Mapping[str, Any]
    """Signals by their names, as the columns of a file are called: displacement_mm, time_s."""


def signals_file(name: str, signals: Signals) -> Sliced:
    """Signals in memory as an open file of that name.

    signals : a table of pandas, whose index is a column as well if it has a name; or arrays by name, (n,), with
    sample_rate_hz, dt or t0 among them as plain numbers. Points in time are read as s from the first on.

    Raises RecordError for an array that is not one signal.
    """
    path = Path(name)
    columns = _columns(signals)
    told = {key: value for key, value in columns.items() if np.ndim(value) == 0}
    unknown = [key for key in told if key.lower() not in TIMING_NAMES]
    if unknown:
        raise RecordError(
            f"{path}: {shortened(unknown[0])} is a single value; a signal is an array of its samples"
        )
    channels: list[RawChannel] = []
    arrays: list[Callable[[int, int], Array]] = []
    for label, values in columns.items():
        if label in told:
            continue
        array, stamps = _samples(values)
        if array.ndim != 1:
            raise RecordError(
                f"{path}: {shortened(label)} has the shape {array.shape}; give each signal a name of its own"
            )
        if stamps:
            channels.append(RawChannel(label, "s", array.size, label=label, stamps=True))
        else:
            channels.append(described(path, label, array.size, told))
        arrays.append(_reader(path, label, array))
    require_nameable(path, channels)
    return Sliced(path, channels, lambda i, begin, end: arrays[i](begin, end), "arrays")


def _columns(signals: Signals) -> dict[str, Any]:
    if isinstance(signals, Mapping):
        return {str(name): values for name, values in signals.items()}
    attributes = {str(key): value for key, value in signals.attrs.items()}
    told = {key: value for key, value in attributes.items() if key.lower() in TIMING_NAMES}
    index = {} if signals.index.name is None else {str(signals.index.name): signals.index}
    names = [str(name) for name in signals.columns]
    twice = next((name for name in names if names.count(name) > 1 or name in index), None)
    if twice is not None:
        raise RecordError(f"the table has two columns {shortened(twice)}; give each its own name")
    return told | index | {str(name): signals[name] for name in signals.columns}


def _samples(values: Any) -> tuple[Any, bool]:
    """The samples of a signal, and whether they are points in time, then in s from the first on."""
    kind = str(getattr(values, "dtype", ""))
    if kind.startswith("datetime64"):
        values = np.asarray(values, dtype="datetime64[ns]")
    array = np.asarray(values)
    if array.dtype.kind not in "mM":
        return array, False
    origin = array[:1] if array.dtype.kind == "M" else np.zeros(1, array.dtype)
    return (array - origin) / np.timedelta64(1, "s"), True


def _reader(path: Path, label: str, array: Any) -> Callable[[int, int], Array]:
    kind = array.dtype.kind
    # NumPy would drop an imaginary part, and takes texts for numbers
    texts = kind in "SU" or (kind == "O" and any(isinstance(value, str) for value in array))
    held = "complex numbers" if kind == "c" else "texts" if texts else ""

    def read(begin: int, end: int) -> Array:
        if not held:
            try:
                return np.array(
                    array[begin:end], dtype=np.float64
                )  # a copy: the caller's may change
            except (TypeError, ValueError):
                pass
        what = held or "what are not numbers"
        raise RecordError(f"{path}: column {shortened(label)} holds {what}")

    return read
