"""What every format looks like to the rest: named channels that are read in blocks; signals in memory, in arrays or a
table of pandas, as well.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import floats
from ...arrays import Array
from ...project.wording import shortened
from ..errors import HIGHEST_RATE, LATEST, LONGEST_NAME, LOWEST_RATE, MOST_CHANNELS, RecordError
from ..units import split_label

RATE_NAMES = (
    "sample_rate_hz", "sample_rate", "sampling_rate", "samplerate", "sampling_frequency", "fs", "rate_hz",
)  # fmt: skip
STEP_NAMES = (
    "wf_increment", "dt", "dt_s", "delta_t", "time_step", "sample_interval", "increment", "t_increment",
)  # fmt: skip
START_NAMES = ("wf_start_offset", "t0", "t_start", "start_time_s")
UNIT_NAMES = ("unit", "units", "unit_string", "ni_unitdescription")
"""Names, in lower case, under which files keep sampling rate (Hz), step (s), first time (s) and unit."""

TIMING_NAMES = frozenset((*RATE_NAMES, *STEP_NAMES, *START_NAMES))


@dataclass(frozen=True, slots=True)
class RawChannel:
    """A channel as the file has it.

    name : without its unit.   label : with it, as it stands there.   unit : as spelt there, or None.
    size : number of samples, or None if only reading tells.
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


class RecordFile(ABC):
    """An open file of channels."""

    path: Path
    channels: Sequence[RawChannel]
    rows_stated: int = 0  # about, where a channel has no size

    @abstractmethod
    def blocks(self, wanted: Sequence[int], size: int) -> Iterator[list[Array]]:
        """The wanted channels, `size` samples of each at a time."""

    def place(self, channel: int, sample: int) -> str:
        """Where a sample, counted from 0, stands in the file."""
        return f"sample {sample + 1}"

    def close(self) -> None:  # noqa: B027
        """Let go of the file."""


@dataclass(frozen=True, eq=False)
class Sliced(RecordFile):
    """A file whose channels are read from any sample to any other: read(channel, begin, end).

    what : the format, for messages.   close : lets go of the file.
    """

    path: Path
    channels: Sequence[RawChannel]
    read: Callable[[int, int, int], ArrayLike]
    what: str
    close: Callable[[], None] = lambda: None

    def blocks(self, wanted: Sequence[int], size: int) -> Iterator[list[Array]]:
        """The wanted channels, `size` samples of each at a time."""
        lengths = [self.channels[i].size or 0 for i in wanted]
        for start in range(0, max(lengths), size):
            ends = [(min(start, n), min(start + size, n)) for n in lengths]
            with intact(self.path, self.what):
                parts = [self.read(i, *end) for i, end in zip(wanted, ends, strict=True)]
                yield [np.asarray(part, dtype=np.float64) for part in parts]


@contextmanager
def intact(path: Path, what: str, close: Callable[[], None] = lambda: None) -> Iterator[None]:
    """What a library raises about a file that it cannot read becomes a RecordError; `close` lets go of the file."""
    try:
        yield
    except Exception as error:  # the libraries have errors of many kinds for a damaged file
        close()
        if isinstance(error, RecordError):
            raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise RecordError(
            f"{path}: cannot be read as {what}, it is damaged or was cut short ({shortened(reason, 200)[1:-1]})"
        ) from None


def require_nameable(path: Path, channels: Sequence[RawChannel]) -> None:
    """RecordError for a file of more channels, or with longer names of channels, than any record has."""
    require_channels(path, len(channels))
    for number, channel in enumerate(channels, start=1):
        longest = max(channel.label or channel.name, channel.unit or "", key=len)
        if len(longest) > LONGEST_NAME:
            raise RecordError(
                f"{path}: the name of channel {number} has {len(longest):,} characters, {shortened(longest, 40)}; "
                f"a name has {LONGEST_NAME:,} at most"
            )


def require_channels(path: Path, count: int) -> None:
    """RecordError for a file of more channels than any record has."""
    if count > MOST_CHANNELS:
        raise RecordError(
            f"{path}: holds {count:,} channels, more than {MOST_CHANNELS:,}; a table has its samples along the longer "
            "side: keep the channels of one record"
        )


def signals_in(
    path: Path,
    what: str,
    arrays: Iterable[tuple[str, Any, dict[str, object], str | None]],
    close: Callable[[], None] = lambda: None,
) -> Sliced:
    """The signals in arrays (name, array, attributes, unit): each array itself, or its rows or columns if it has two.
    A signal runs along the longer side."""
    channels: list[RawChannel] = []
    signals = []
    for name, data, attributes, unit in arrays:
        if data.size < 2 or data.ndim > 2:
            continue
        several = data.ndim == 2 and min(data.shape) > 1
        count = min(data.shape) if several else 1
        require_channels(path, len(channels) + count)
        for i in range(count):
            folder, slash, last = name.rpartition("/")
            label = f"{last}[{i + 1}]" if several else last
            channels.append(
                described(path, label, max(data.shape), attributes, unit, folder + slash)
            )
            signals.append((data, i))

    def read(channel: int, begin: int, end: int) -> Any:
        data, i = signals[channel]
        if data.ndim == 1:
            return data[begin:end]
        return data[begin:end, i] if data.shape[0] >= data.shape[1] else data[i, begin:end]

    return Sliced(path, channels, read, what, close)


def described(
    path: Path,
    label: str,
    size: int,
    attributes: dict[str, object],
    unit: str | None = None,
    folder: str = "",
) -> RawChannel:
    """The channel of `size` samples with that label, its timing among the attributes, whatever they are called; with
    a fault where a rate, a step or a first time is none.

    unit : instead of the label's.   folder : that it stands in, up to its last slash.
    """
    name, own = split_label(label)
    name, label = f"{folder}{name}", f"{folder}{label}"
    values = {str(key).lower(): value for key, value in attributes.items()}
    channel, remedy = f"channel {shortened(label)}", "give sample_rate_hz in a mapping"
    raw = RawChannel(name, unit or own, size, label=label)

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
        return replace(raw, fault=f"{path}: {error}; {remedy}")
    return replace(raw, rate_hz=1.0 / value if key in STEP_NAMES else value, start=start)


def unit_among(attributes: dict[str, object]) -> str | None:
    """The unit among attributes of a channel, or None."""
    units = (value for key, value in attributes.items() if str(key).lower() in UNIT_NAMES)
    texts = (u.decode("utf-8", "replace") if isinstance(u, bytes) else str(u) for u in units)
    return next(filter(None, map(str.strip, texts)), None)


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
            remedy = "a signal is an array of its samples"
            raise RecordError(f"{path}: {shortened(label)} is a single value; {remedy}")
    channels, arrays = [], []
    for label, values in several.items():
        array, stamps = _samples(values)
        if array.ndim != 1:
            remedy = "give each signal a name of its own"
            raise RecordError(f"{path}: {shortened(label)} has the shape {array.shape}; {remedy}")
        time = RawChannel(label, "s", array.size, label=label, stamps=True)
        channels.append(time if stamps else described(path, label, array.size, stated))
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
