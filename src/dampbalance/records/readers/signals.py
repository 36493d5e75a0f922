"""Signals that are in memory, in arrays or a table of pandas, read as those of a file are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ...arguments import floats
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
    stated: dict[str, Any] = {}
    several: dict[str, Any] = {}
    for label, values in _columns(signals).items():
        single = not isinstance(values, list | tuple) and not np.ndim(values)
        (stated if single else several)[label] = values
        if single and label.lower() not in TIMING_NAMES:
            raise RecordError(
                f"{path}: {shortened(label)} is a single value; a signal is an array of its samples"
            )
    channels, arrays = [], []
    for label, values in several.items():
        array, stamps = _samples(values)
        if array.ndim != 1:
            raise RecordError(
                f"{path}: {shortened(label)} has the shape {array.shape}; give each signal a name of its own"
            )
        plain = RawChannel(label, "s", array.size, label=label, stamps=True)
        channels.append(plain if stamps else described(path, label, array.size, stated))
        arrays.append(array)
    require_nameable(path, channels)

    def read(i: int, begin: int, end: int) -> Array:
        try:
            return floats(arrays[i][begin:end]).copy()  # the caller's may change
        except ValueError as error:
            raise RecordError(
                f"{path}: column {shortened(channels[i].label)} holds {error}"
            ) from None

    return Sliced(path, channels, read, "arrays")


def is_table(record: object) -> bool:
    """Whether something is signals by their names: a mapping, a table of pandas, an array with named fields."""
    of_pandas = all(hasattr(record, name) for name in ("columns", "index", "attrs"))
    named = isinstance(record, Mapping) or of_pandas or bool(_fields(record))
    return named and not isinstance(record, type)


def _fields(signals: Any) -> tuple[str, ...]:
    return getattr(getattr(signals, "dtype", None), "names", None) or ()


def _columns(signals: Signals) -> dict[str, Any]:
    if isinstance(signals, Mapping):
        return {str(name): values for name, values in signals.items()}
    if fields := _fields(signals):
        return {name: signals[name] for name in fields}
    stated = {str(k): v for k, v in signals.attrs.items() if str(k).lower() in TIMING_NAMES}
    index = {} if signals.index.name is None else {str(signals.index.name): signals.index}
    names = [str(name) for name in signals.columns]
    twice = next((name for name in names if names.count(name) > 1 or name in index), None)
    if twice is not None:
        raise RecordError(f"the table has two columns {shortened(twice)}; give each its own name")
    return stated | index | {str(name): signals[name] for name in signals.columns}


def _samples(values: Any) -> tuple[Any, bool]:
    """The samples of a signal, and whether they are points in time, then in s from the first on."""
    if isinstance(values, list | tuple):
        values = [None if one is np.ma.masked else one for one in values]
    kind = str(getattr(values, "dtype", ""))
    if kind.startswith(("datetime64", "timestamp")):  # of NumPy or pandas, of Arrow
        masked = np.ma.getmask(values)
        values = np.array(values, dtype="datetime64[ns]")
        values[masked] = np.datetime64("NaT")
    array = values if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
    if array.dtype.kind not in "mM":
        return array, False
    origin = array[:1] if array.dtype.kind == "M" else np.zeros(1, array.dtype)
    return (array - origin) / np.timedelta64(1, "s"), True
