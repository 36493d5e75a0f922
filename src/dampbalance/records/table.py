"""The channels of a record as they stand in a file, in arrays or in a table of pandas: names, units, sampling rates,
and the samples as recorded. A reader of a format is a function from a path to a `Table`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import floats
from ..arrays import Array, ReadOnly
from ..findings.finding import Finding
from ..project.wording import shortened
from .errors import HIGHEST_RATE, LATEST, LOWEST_RATE, RecordError, RecordWarning
from .units import split_label

RATE_NAMES = (
    "sample_rate_hz", "sample_rate", "sampling_rate", "samplerate", "sampling_frequency", "fs", "rate_hz",
)  # fmt: skip
STEP_NAMES = (
    "wf_increment", "dt", "dt_s", "delta_t", "time_step", "sample_interval", "increment", "t_increment",
    "sampling_interval", "sampling_time_interval", "sampling_period", "sample_period",
)  # fmt: skip
START_NAMES = ("wf_start_offset", "t0", "t_start", "start_time_s")
UNIT_NAMES = ("unit", "units", "unit_string", "ni_unitdescription")
"""Names, in lower case, under which files keep sampling rate (Hz), step (s), first time (s) and unit."""

TIMING_NAMES = frozenset((*RATE_NAMES, *STEP_NAMES, *START_NAMES))

LONGEST_TAIL = 100
"""Lines of text that may follow on the rows of numbers, as the remarks of a logger do."""


@dataclass(frozen=True, slots=True)
class RawChannel:
    """A channel as the file has it.

    name : without its unit.   label : with it, as it stands there.   unit : as spelt there, or None.
    size : number of samples, or None if it shows only on reading.
    rate_hz : samples per second, or None if the file does not say.   start : time of its first sample, s.
    stamps : whether it holds points in time, or spans of it; read as s from the first on.
    fault : of the rate, the step or the first time that the file states; "" for none.
    """

    name: str
    unit: str | None = None
    size: int | None = None
    rate_hz: float | None = None
    start: float = 0.0
    label: str = ""
    stamps: bool = False
    fault: str = ""


@dataclass(frozen=True, eq=False)
class Table:
    """The channels of a file, or of signals in memory.

    channels : what is known of each.   load : gives all samples of the channels of these numbers, as recorded, NaN for
    an empty cell.   place : where a sample, counted from 0, stands in the file.
    oddity : code of what is odd about the file, warned of when it is read; "" for nothing.
    what : the format, for messages.
    loaded : channels loaded already.
    """

    path: Path
    channels: Sequence[RawChannel]
    load: Callable[[Sequence[int]], Sequence[ArrayLike]]
    place: Callable[[int], str] = lambda sample: f"sample {sample + 1}"
    oddity: str = ""
    what: str = "arrays"
    loaded: dict[int, Array] = field(default_factory=dict)

    def columns(self, wanted: Sequence[int]) -> dict[int, Array]:
        """Return all samples of channels by their numbers. Raises RecordError for a damaged file and for what is no
        number; warns of what is odd about the file."""
        if self.oddity:
            warnings.warn(RecordWarning(self.path, Finding(self.oddity)), stacklevel=2)
        missing = [i for i in wanted if i not in self.loaded]
        with intact(self.path, self.what):
            for i, values in zip(missing, self.load(missing) if missing else (), strict=True):
                try:
                    self.loaded[i] = floats(values)
                except ValueError as error:
                    column = f"{self.path}: column {shortened(self.channels[i].label)}"
                    raise RecordError(f"{column} holds {error}") from None
        return {i: self.loaded[i] for i in wanted}


@contextmanager
def intact(path: Path, what: str) -> Iterator[None]:
    """Turn what a library raises about a file that it cannot read into a RecordError."""
    try:
        yield
    except Exception as error:  # the libraries have errors of many kinds for a damaged file
        if isinstance(error, RecordError | MemoryError):
            raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise RecordError(
            f"{path}: cannot be read as {what}, it is damaged or was cut short ({shortened(reason, 200)[1:-1]})"
        ) from None


class Unread(NamedTuple):
    """An array in a file, of which parts are read when they are asked for."""

    shape: tuple[int, ...]
    read: Callable[[Any], Any]

    def __getitem__(self, part: Any) -> Any:
        return self.read(part)


class Signal(NamedTuple):
    """Samples under a label: an array, or an `Unread` one.

    stated : what is known of them, whatever it is called; unit, rate, step and first time are taken from it.
    folder : that they stand in, up to its last slash.   stamps : whether they are points in time, now in s.
    """

    label: str
    samples: np.ndarray[Any, Any] | Unread
    stated: Mapping[str, object] = ReadOnly({})
    folder: str = ""
    stamps: bool = False


def table_of(path: Path, signals: Iterable[Signal]) -> Table:
    """Return the table of signals. An array of two dimensions is as many channels, y[1], y[2], …, along its longer
    side; that of a single one have no heading."""
    signals = [*signals]
    channels: list[RawChannel] = []
    parts: list[tuple[Any, Any]] = []
    for label, samples, stated, folder, stamps in signals:
        shape = samples.shape
        several = len(shape) == 2 and min(shape) > 1
        for i in range(min(shape) if several else 1):
            name = f"{label}[{i + 1}]" if several else label
            raw = described(path, name, max(shape), stated, folder)
            if several and len(signals) == 1:
                raw = replace(raw, label="")
            channels.append(replace(raw, unit="s", stamps=True) if stamps else raw)
            wide = len(shape) == 2 and shape[0] < shape[1]
            parts.append((samples, (i,) if wide else (..., *[i] * (len(shape) - 1))))
    return Table(path, channels, lambda wanted: [parts[i][0][parts[i][1]] for i in wanted])


def described(
    path: Path, label: str, size: int, stated: Mapping[str, object], folder: str = ""
) -> RawChannel:
    """Return the channel of `size` samples with that label: its unit and timing as stated, or the unit of the label;
    with a fault where a rate, a step or a first time is no number in its range."""
    name, own = split_label(label)
    values = {str(key).lower(): value for key, value in stated.items()}
    raw = RawChannel(f"{folder}{name}", unit_among(values) or own, size, label=f"{folder}{label}")
    channel = f"channel {shortened(raw.label)}"

    def number(key: str) -> float:
        value = np.asarray(values[key])
        if value.size != 1 or value.dtype.kind not in "fiu":
            raise ValueError(f"{key} of {channel} is {shortened(values[key])}, not a number")
        return float(value.reshape(-1)[0])

    try:
        start = next((number(key) for key in START_NAMES if key in values), 0.0)
        if not abs(start) <= LATEST:
            raise ValueError(f"{channel} begins at {start:g} s")
        key = next((key for key in (*RATE_NAMES, *STEP_NAMES) if key in values), None)
        if key is None:
            return replace(raw, start=start)
        value, low, high = number(key), LOWEST_RATE, HIGHEST_RATE
        if key in STEP_NAMES:
            low, high = 1.0 / HIGHEST_RATE, 1.0 / LOWEST_RATE
        if not low <= value <= high:
            raise ValueError(f"{key} of {channel} is {value:g}, not within {low:g} to {high:g}")
    except ValueError as error:
        return replace(raw, fault=f"{path}: {error}; give sample_rate_hz in a mapping")
    return replace(raw, rate_hz=1.0 / value if key in STEP_NAMES else value, start=start)


def unit_among(stated: Mapping[str, object]) -> str | None:
    """Return the unit among what is stated of a channel, or None."""
    units = (of for key, of in stated.items() if key.lower() in UNIT_NAMES and of is not None)
    texts = (u.decode("utf-8", "replace") if isinstance(u, bytes) else str(u) for u in units)
    return next(filter(None, map(str.strip, texts)), None)


if TYPE_CHECKING:
    import pandas as pd

    Signals: TypeAlias = pd.DataFrame | Mapping[str, Any] | np.ndarray[Any, Any]
    """Signals by their names, as the columns of a file are called: displacement_mm, time_s; or a plain array."""


def signals_file(name: str, signals: Signals | Table) -> Table:
    """Return signals in memory as a table of that name.

    signals : a table of pandas, whose index is a column as well if it has a name; an array with named fields, or one of
    columns, (n, k) or (k, n); or arrays by name, with sample_rate_hz, dt or t0 among them as plain numbers. An array
    of several signals is as many channels, y[1], y[2], …, along its longer side. Points in time are read as s from the
    first on. Or a table already made.

    Raises RecordError for an array that holds no signals.
    """
    path = Path(name)
    if isinstance(signals, Table):
        return replace(signals, path=path)
    stated: dict[str, Any] = {}
    several: list[tuple[str, Any, bool]] = []
    for label, values in _columns(signals).items():
        listed = isinstance(values, list | tuple)
        if not listed and label.lower() in TIMING_NAMES and np.size(values) == 1:
            stated[label] = np.asarray(values).reshape(-1)[0]
            continue
        samples, stamps = _samples(values)
        if not listed and not samples.ndim:
            remedy = "a signal is an array of its samples"
            raise RecordError(f"{path}: {shortened(label)} is a single value; {remedy}")
        if samples.ndim > 2:
            remedy = "give each signal its own name"
            raise RecordError(f"{path}: {shortened(label)} has the shape {samples.shape}; {remedy}")
        several.append((label, samples, stamps))
    return table_of(path, [Signal(of, array, stated, "", stamps) for of, array, stamps in several])


def is_table(record: object) -> bool:
    """Return whether something is the signals of a record: a mapping, a table of pandas, an array of numbers or one
    with named fields, a `Table`."""
    of_pandas = all(hasattr(record, name) for name in ("columns", "index", "attrs"))
    array = isinstance(record, np.ndarray) and (record.dtype.kind in "fiu" or _fields(record))
    named = isinstance(record, Mapping | Table) or of_pandas or bool(array)
    return named and not isinstance(record, type)


def _fields(signals: Any) -> tuple[str, ...]:
    """Return the names of the fields of an array; none for anything else."""
    return getattr(getattr(signals, "dtype", None), "names", None) or ()


def _columns(signals: Signals) -> dict[str, Any]:
    if isinstance(signals, Mapping):
        return {
            f"{name}.{field}" if field else str(name): values[field] if field else values
            for name, values in signals.items()
            for field in _fields(values) or ("",)
        }
    if fields := _fields(signals):
        return {name: signals[name] for name in fields}
    if isinstance(signals, np.ndarray):
        return {"column": signals}
    stated = {str(k): v for k, v in signals.attrs.items() if str(k).lower() in TIMING_NAMES}
    index = {} if signals.index.name is None else {str(signals.index.name): signals.index}
    names = [str(name) for name in signals.columns]
    twice = next((name for name in names if names.count(name) > 1 or name in index), None)
    if twice is not None:
        raise RecordError(f"the table has two columns {shortened(twice)}; give each its own name")
    return stated | index | {str(name): signals[name] for name in signals.columns}


def _samples(values: Any) -> tuple[Any, bool]:
    """Return the samples of a signal, and whether they are points in time, then in s from the first on."""
    if isinstance(values, list | tuple):
        values = [None if one is np.ma.masked else one for one in values]
    kind = str(getattr(values, "dtype", ""))
    if kind.startswith(("datetime64", "timestamp")):  # NumPy or pandas; Arrow
        masked = np.ma.getmask(values)
        values = np.array(values, dtype="datetime64[ns]")
        values[masked] = np.datetime64("NaT")
    array = values if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
    return (in_seconds(array), True) if array.dtype.kind in "mM" else (array, False)


def in_seconds(times: Any) -> Any:
    """Return points in time in s from the first on, or spans in s."""
    origin = times[:1] if times.dtype.kind == "M" else np.zeros(1, times.dtype)
    return (times - origin) / np.timedelta64(1, "s")
