"""Files of named arrays: HDF5 and MATLAB 7.3, MATLAB 5, NumPy, JSON."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from contextlib import nullcontext, suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import RecordError, library
from ..table import TIMING_NAMES, UNIT_NAMES, Table, Unread, channels_of, signals_file, table_of
from ..units import split_label

_LARGEST_JSON = 400_000_000  # bytes; the numbers take ten times as much memory
# fields of MATLAB that name the signals next to them, and fields of times
_LABELS = (
    *("names", "name", "labels", "label"),
    *("channels", "channelnames", "channel_names", "signalnames", "variablenames"),
)
_TIMES = ("t", "time", "times", "rowtimes", "timestamp", "timestamps", "zeit")
_NO_NUMBERS = (b"char", b"logical", "char", "logical")  # classes of MATLAB


def hdf5_file(path: Path) -> Table:
    """Return the table of an HDF5 or MATLAB 7.3 file: every array of numbers in it is a channel, named by its path.

    Unit and sampling rate are attributes of the array; the rate may also be one of its groups, or a scalar next to it.
    """
    h5py = library("h5py", "HDF5")

    def read(name: str, part: Any) -> Any:
        with h5py.File(path, "r") as file:
            return file[name][part]

    with h5py.File(path, "r") as file:
        datasets = list(_datasets(h5py, file))
        scalars = {
            last: d[()].item()
            for name, d, _ in datasets
            if d.size == 1 and (last := name.rpartition("/")[2]).lower() in TIMING_NAMES
        }
        signals = []
        for name, data, stated in datasets:
            if data.ndim in (1, 2) and data.size > 1:
                folder, slash, last = name.rpartition("/")
                held = Unread(data.shape, partial(read, name))
                signals.append(channels_of(last, held, scalars | stated, folder + slash))
    return table_of(path, signals)


def _datasets(h5py: Any, file: Any) -> Iterator[tuple[str, Any, dict[str, object]]]:
    """Yield path, data and attributes, also those of its groups, of every array of real numbers in a file, once each:
    soft links are not followed."""
    visited: list[tuple[str, Any]] = []
    file.visititems(lambda name, item: visited.append((name, item)))
    groups = {"": _attributes(file, TIMING_NAMES)}
    for name, item in visited:
        above = groups.get(name.rpartition("/")[0])
        if above is None or name.rpartition("/")[2].startswith("#"):  # MATLAB's own: #refs#
            continue
        if isinstance(item, h5py.Group):
            groups[name] = above | _attributes(item, TIMING_NAMES)
        elif (
            item.dtype.kind in "fiu"  # real numbers; no booleans, enumerations or text
            and item.size
            and h5py.check_enum_dtype(item.dtype) is None
            and item.attrs.get("MATLAB_class") not in _NO_NUMBERS
        ):
            yield name, item, above | _attributes(item, TIMING_NAMES | {*UNIT_NAMES})


def _attributes(item: Any, names: Collection[str]) -> dict[str, object]:
    return {name: item.attrs[name] for name in item.attrs if name.lower() in names}


def matlab_file(path: Path) -> Table:
    """Return the table of a MATLAB 5 file: every real array in it is a channel, named "structure.field" in a structure,
    with [1], [2], … in an array of structures. The signals of a matrix have the names that texts next to it give."""
    from scipy.io import whosmat  # slow to import

    reader = library("pymatreader", "MATLAB")
    truths = {name for name, _, kind in whosmat(path) if kind == "logical"}
    document = reader.read_mat(str(path))
    held = {n: v for n, v in document.items() if not n.startswith("__") and n not in truths}
    fields = {
        name: (value, unit)
        for name, value, unit in _unrolled(held)
        if np.isscalar(value) or (isinstance(value, np.ndarray) and value.dtype.kind in "fiu")
    }
    stated = {
        last: value
        for name, (value, _) in fields.items()
        if np.size(value) == 1 and (last := name.rpartition(".")[2]).lower() in TIMING_NAMES
    }
    signals = [
        channels_of(name, np.asarray(value), stated | {"unit": unit})
        for name, (value, unit) in fields.items()
        if _is_signal(value)
    ]
    return table_of(path, signals)


def _is_signal(value: Any) -> bool:
    """Return whether a value is an array of samples in one or two dimensions."""
    return np.ndim(value) in (1, 2) and np.size(value) > 1


def _unrolled(held: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any, str]]:
    """Yield path, value and unit ("" if unknown) of each field.

    The elements of an array of structures or of arrays have [1], [2], … at the end. The signals of a matrix, or of the
    structure of one signal, have the names next to them, or in `Properties`, as in a timetable.
    """
    properties = held.get("Properties")
    stated = {**held, **(properties if isinstance(properties, Mapping) else {})}
    texts = [(key.lower(), _texts(value)) for key, value in stated.items()]
    labels, units = (
        next((of for key, of in texts if key in keys and of), []) for keys in (_LABELS, UNIT_NAMES)
    )
    for name, value in held.items():
        if isinstance(value, Mapping):
            yield from _unrolled(value, f"{above}{name}.")
        elif isinstance(value, list) and all(
            isinstance(one, np.ndarray | Mapping) for one in value
        ):
            for i, one in enumerate(value, start=1):
                of = one if isinstance(one, Mapping) else {"": one}
                inner = f"{above}{name}[{i}]" + "." * (of is one)
                yield from _unrolled(of, inner)
        elif (
            isinstance(value, np.ndarray)
            and value.ndim in (1, 2)
            and value.dtype.kind in "fiu"
            and len(labels) == len({*labels}) == (1 if value.ndim == 1 else min(value.shape))
            and name.lower() not in _TIMES
        ):
            rows = np.atleast_2d(value if value.shape[0] < value.shape[-1] else value.T)
            for i, (label, row) in enumerate(zip(labels, rows, strict=True)):
                bare, own = split_label(label)
                unit = units[i] if len(units) == len(labels) else own or ""
                yield f"{above}{bare.replace('/', '_')}", row, unit
        else:
            unit = dict(zip(labels, units, strict=False)).get(name, "")
            yield f"{above}{name}", value, unit


def _texts(value: Any) -> list[str]:
    """Return the texts in a field of MATLAB, one or several; none if it holds anything else."""
    several = [value] if isinstance(value, str) else value
    listed = isinstance(several, list | np.ndarray)
    texts = listed and all(isinstance(one, str) for one in several)
    return [str(one).strip() for one in several] if texts else []


def numpy_file(path: Path) -> Table:
    """Return the table of an array of NumPy, or of an archive of several: each array, or each of its fields or columns,
    is a channel; single numbers are rate, step or first time. Pickles are not loaded, so arrays of objects are skipped.
    """
    held = {}
    with open(path, "rb") as stream:
        packed = stream.peek(2).startswith(b"PK")
        with np.load(stream) if packed else nullcontext({"": path}) as arrays:
            for name in arrays:
                try:
                    held[name] = np.array(arrays[name] if name else np.load(path, mmap_mode="r"))
                except ValueError as error:
                    if "bject" not in str(error):  # objects can neither be loaded nor mapped
                        raise
    if not held:
        remedy = "save its signals as arrays of numbers"
        raise RecordError(
            f"{path}: holds Python objects alone, pickled, which are not loaded; {remedy}"
        )
    return _table(path, held.popitem()[1] if len(held) == 1 else held)


def json_file(path: Path) -> Table:
    """Return the table of a JSON file: columns by name, as lists or as pandas writes them, or rows, as mappings of
    names to cells or lists of cells. Points in time are texts, 2026-03-01T12:00:00.5; other texts and single values,
    except a rate, are skipped."""
    import pandas as pd  # slow to import

    if (size := path.stat().st_size) > _LARGEST_JSON:
        much = f"{size / 1e6:.3g} MB, more than the {_LARGEST_JSON / 1e6:g} MB"
        raise RecordError(f"{path}: has {much} that are read as JSON; save it as CSV or HDF5")
    held = json.loads(path.read_bytes())
    if isinstance(held, dict) and {"columns", "data"} <= held.keys():
        held = dict(zip(held["columns"], zip(*held["data"], strict=True), strict=True))
    elif isinstance(held, list) and all(isinstance(row, dict) for row in held):
        names = dict.fromkeys(name for row in held for name in row)
        held = {name: [row.get(name) for row in held] for name in names}
    elif isinstance(held, list):
        held = np.array(held, dtype=np.float64)
    if not isinstance(held, dict | np.ndarray):
        raise RecordError(f"{path}: holds neither columns nor rows; save names and lists")
    for name, values in held.items() if isinstance(held, dict) else ():
        cells = [*values.values()] if isinstance(values, dict) else values
        if isinstance(cells, list | tuple) and cells and isinstance(cells[0], str):
            with suppress(ValueError):  # any other text is no number, where it is needed
                cells = pd.to_datetime(cells, format="ISO8601", utc=True)
        held[name] = cells
    return _table(path, held)


def _table(path: Path, held: Any) -> Table:
    """Return the table of the arrays in a file that are signals or rates."""
    if isinstance(held, Mapping):
        held = {
            str(name): values
            for name, values in held.items()
            if _is_signal(values) or str(name).lower() in TIMING_NAMES
        }
    return signals_file(str(path), held)
