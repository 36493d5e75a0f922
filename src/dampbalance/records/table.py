"""The channels of a record as they are in a file, in arrays or in a table of pandas: names, units, sampling rates and
samples as recorded. A reader of a format is a function from a path to a `Table`.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
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
from .vocabulary import WORDS

RATE_NAMES, STEP_NAMES, START_NAMES, UNIT_NAMES = map(
    WORDS["fields"].__getitem__, ("rate", "step", "start", "unit")
)
"""Names, in lower case, under which files state sampling rate (Hz), step (s), first time (s) and unit."""

TIMING_NAMES = frozenset((*RATE_NAMES, *STEP_NAMES, *START_NAMES))

LONGEST_TAIL = 100
"""Most lines of text that may follow the rows of numbers, such as remarks of a logger."""


@dataclass(frozen=True, slots=True)
class RawChannel:
    """A channel as the file has it.

    name : without its unit.   label : the heading, with the unit.   unit : as spelt in the file, or None.
    size : number of samples, or None if it is known only after reading.
    rate_hz : samples per second, or None if the file does not state it.   start : time of the first sample, s.
    stamps : whether it holds points in time or time spans; read as s from the first on.
    fault : of the rate, the step or the first time that the file states; "" for none.
    scale : units per reading that the file states; NaN if it is unclear whether the readings are scaled already.
    described, rate_line : lines of the header that describe the channel and the rate; "" for none.
    load : returns its samples as recorded, unless its table loads them.
    """

    name: str
    unit: str | None = None
    size: int | None = None
    rate_hz: float | None = None
    start: float = 0.0
    label: str = ""
    stamps: bool = False
    fault: str = ""
    scale: float = 1.0
    described: str = ""
    rate_line: str = ""
    load: Callable[[], ArrayLike] = list


@dataclass(frozen=True, eq=False)
class Table:
    """The channels of a file, or of signals in memory.

    channels : what is known of each.   load : returns the samples of the channels with these indices, as recorded, NaN
    for an empty cell; None if each channel loads its own.   place : gives the place in the file of a sample, counted
    from 0.   what : the format, for messages.   odd : what is odd about the file; a warning whenever it is read.
    loaded : channels loaded already.
    """

    path: Path
    channels: Sequence[RawChannel]
    load: Callable[[Sequence[int]], Sequence[ArrayLike]] | None = None
    place: Callable[[int], str] = lambda sample: f"sample {sample + 1}"
    what: str = "arrays"
    odd: list[Finding] = field(default_factory=list)
    loaded: dict[int, Array] = field(default_factory=dict)

    def columns(self, wanted: Sequence[int]) -> dict[int, Array]:
        """Return the samples of channels by their indices. Raises RecordError for a damaged file and for cells that
        are not numbers; warns of what is odd about the file."""
        missing = [i for i in wanted if i not in self.loaded]
        with intact(self.path, self.what):
            load = self.load or (lambda wanted: [self.channels[i].load() for i in wanted])
            for i, values in zip(missing, load(missing) if missing else (), strict=True):
                try:
                    self.loaded[i] = floats(values)
                except ValueError as error:
                    column = f"{self.path}: column {shortened(self.channels[i].label)}"
                    raise RecordError(f"{column} holds {error}") from None
        for odd in self.odd:
            warnings.warn(RecordWarning(self.path, odd), stacklevel=2)
        return {i: self.loaded[i] for i in wanted}

    def part(self, columns: Sequence[int]) -> Table:
        """Return a table of some of the channels."""
        channels = [self.channels[i] for i in columns]

        def load(wanted: Sequence[int]) -> Sequence[ArrayLike]:
            held = self.columns([columns[i] for i in wanted])
            return [held[columns[i]] for i in wanted]

        return replace(self, channels=channels, load=load, loaded={})


@contextmanager
def intact(path: Path, what: str) -> Iterator[None]:
    """Turn any error of a library that cannot read a file into a RecordError."""
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
    """An array in a file, of which parts are read on demand."""

    shape: tuple[int, ...]
    read: Callable[[Any], Any]

    def __getitem__(self, part: Any) -> Any:
        return self.read(part)


def channels_of(
    label: str,
    samples: np.ndarray[Any, Any] | Unread,
    stated: Mapping[str, object] = ReadOnly({}),
    folder: str = "",
    stamps: bool = False,
) -> list[RawChannel]:
    """Return the channel of samples under a label, or several, y[1], y[2], …, if the samples are a two-dimensional
    array; they run along its longer side.

    stated : attributes in the file, of which unit, rate, step and first time are used.   folder : path of the group,
    with its last slash.   stamps : whether the samples are points in time, converted to s.
    """
    name, own = split_label(label)
    unit = "s" if stamps else unit_among(stated) or own
    timing, shape = _timing(f"{folder}{label}", stated), samples.shape
    wide = len(shape) == 2 and shape[0] < shape[1]
    channels = []
    for i in range(min(shape) if len(shape) == 2 else 1):
        number = f"[{i + 1}]" * (len(shape) == 2 and min(shape) > 1)
        part = (i,) if wide else (..., *[i] * (len(shape) - 1))
        load = partial(samples.__getitem__, part)
        of = timing | {"label": f"{folder}{label}{number}", "stamps": stamps, "load": load}
        channels.append(RawChannel(f"{folder}{name}{number}", unit, max(shape), **of))
    return channels


def table_of(path: Path, signals: Iterable[Sequence[RawChannel]]) -> Table:
    """Return the table of the channels of several signals; the columns of a single matrix have no headings."""
    each = [[*signal] for signal in signals]
    channels = [raw for signal in each for raw in signal]
    if len(each) == 1 and len(channels) > 1:
        channels = [replace(raw, label="") for raw in channels]
    return Table(path, channels)


def _timing(label: str, stated: Mapping[str, object]) -> dict[str, Any]:
    """Return the stated rate and first time of a channel, or a fault if one of them is no number in its range."""
    values = {str(key).lower(): np.asarray(value) for key, value in stated.items()}
    start = next((key for key in START_NAMES if key in values), "")
    rate = next((key for key in (*RATE_NAMES, *STEP_NAMES) if key in values), "")
    low, high = LOWEST_RATE, HIGHEST_RATE
    bounds = {
        start: (-LATEST, LATEST),
        rate: (low, high) if rate in RATE_NAMES else (1.0 / high, 1.0 / low),
    }
    numbers = dict[str, float]()
    for key in filter(None, bounds):
        value, (low, high) = values[key], bounds[key]
        number = value.size == 1 and value.dtype.kind in "fiu"
        numbers[key] = float(value.reshape(-1)[0]) if number else math.nan
        if not low <= numbers[key] <= high:
            wrong = f"{key} of channel {shortened(label)} is {shortened(value.tolist())}"
            remedy = f"not a number within {low:g} to {high:g}; give sample_rate_hz in a mapping"
            return {"fault": f"{wrong}, {remedy}"}
    step = numbers.get(rate)
    per_second = 1.0 / step if step and rate in STEP_NAMES else step
    return {"rate_hz": per_second, "start": numbers.get(start, 0.0)}


def unit_among(stated: Mapping[str, object]) -> str | None:
    """Return the unit among the attributes of a channel, or None."""
    units = (of for key, of in stated.items() if key.lower() in UNIT_NAMES and of is not None)
    texts = (u.decode("utf-8", "replace") if isinstance(u, bytes) else str(u) for u in units)
    return next(filter(None, map(str.strip, texts)), None)


if TYPE_CHECKING:
    import pandas as pd

    Signals: TypeAlias = pd.DataFrame | Mapping[str, Any] | np.ndarray[Any, Any]
    """Signals under names such as displacement_mm and time_s, or a plain array."""


def signals_file(name: str, signals: Signals | Table) -> Table:
    """Return signals in memory as a table of that name.

    signals : a table of pandas, whose index is a column, too, if it has a name or holds points in time; an array with
    named fields, or of columns, (n, k) or (k, n); arrays by name, with sample_rate_hz, dt or t0 as plain numbers; or a
    `Table`. A two-dimensional array gives several channels, y[1], y[2], …, whose samples run along the longer side.
    Points in time are read as s from the first on.

    Raises RecordError for an array that holds no signals.
    """
    path = Path(name)
    if isinstance(signals, Table):
        return replace(signals, path=path)
    held = {label: samples_of(values) for label, values in _flat(signals)}
    timing = {k: v for k, (v, _) in held.items() if k.lower() in TIMING_NAMES and v.size == 1}
    signals = {label: one for label, one in held.items() if label not in timing}
    for label, (samples, _) in signals.items():
        if samples.ndim not in (1, 2):
            what = f"has the shape {samples.shape}" if samples.ndim else "is a single value"
            remedy = "give each signal as an array of its samples, under its own name"
            raise RecordError(f"{path}: {shortened(label)} {what}; {remedy}")
    of = (channels_of(label, one, timing, "", stamps) for label, (one, stamps) in signals.items())
    return table_of(path, of)


def is_table(record: object) -> bool:
    """Return whether an object holds the signals of a record: a mapping, a table of pandas, an array of numbers or with
    named fields, or a `Table`."""
    array = isinstance(record, np.ndarray) and (record.dtype.kind in "fiu" or record.dtype.names)
    return isinstance(record, Mapping | Table) or _is_frame(record) or bool(array)


def _is_frame(record: object) -> bool:
    return hasattr(type(record), "columns") and hasattr(type(record), "attrs")  # of pandas


def _flat(held: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the signals in a table, a mapping or the fields of an array, nested ones by their paths."""
    if _is_frame(held):
        stated = {k: v for k, v in held.attrs.items() if str(k).lower() in TIMING_NAMES}
        timed = held.index.dtype.kind in "mM"  # points in time, which need no name
        named = timed or held.index.name is not None
        frame = held.reset_index(allow_duplicates=True) if named else held
        names = [str(of) for of in frame.columns]
        if twice := [of for of in names if names.count(of) > 1]:
            remedy = "give each its own name"
            raise RecordError(f"the table has two columns {shortened(twice[0])}; {remedy}")
        held = stated | {of: frame.iloc[:, i] for i, of in enumerate(names)}
    elif fields := getattr(getattr(held, "dtype", None), "names", None):
        held = {of: held[of] for of in fields}
    if not isinstance(held, Mapping):
        yield name or "column", held
        return
    for key, values in held.items():
        yield from _flat(values, f"{name}.{key}" if name else str(key))


def samples_of(values: Any) -> tuple[Any, bool]:
    """Return the samples of a signal, and whether they are times, converted to s from the first on."""
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
