"""Writing a measurement in every format that `readers` reads: complete or not at all, the same bytes every time.

Values are written in SI units, as 64-bit floats, with names that `read` recognises (displacement_m). Times are written
as such, or as first time and sampling rate where these give every time to the last bit. Only WAV cannot hold names,
units and a sampling rate that is no whole number: a mapping is written next to it.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from .. import arguments
from ..arguments import instance, text
from ..arrays import Array
from ..project.files import replacing, write_text
from ..project.wording import shortened
from .errors import RecordError, library
from .measurement import QUANTITIES, Channel, Measurement, mean_rate, sample_times
from .readers.formats import FORMATS, format_by_suffix, require_showable
from .units import DIMENSIONS, column_name

MATLAB_73 = "matlab73"
_MATLAB_TEXT = 116  # bytes of description at the start of a MATLAB file
# of universal files: function type, specific data types of abscissa and ordinate, double precision
_UFF_TIME_RESPONSE, _UFF_TIME, _UFF_DOUBLE = 1, 17, 4
_UFF_TYPES = {"length": 8, "velocity": 11, "acceleration": 12, "force": 13}
_TDMS_SEGMENT = 65_536  # samples per segment: a reader takes at least one into memory
_WAV_NOTE = "a WAV has neither names nor units; its samples are 64-bit floats in these units"


def write(
    path: str | Path, measurement: Measurement, format: str | None = None
) -> tuple[Path, ...]:
    """Write a measurement in the format of the suffix; returns the files written (for WAV, its mapping too).

    format : a key of `readers.FORMATS` or "matlab73", for a suffix that stands for several; .mat is MATLAB 5 by itself.

    Raises RecordError when the format cannot hold the measurement, before anything is written.
    """
    path = arguments.path("path", path, "the path of a file")
    instance("measurement", measurement, Measurement)
    require_showable(path)
    by_suffix = format_by_suffix(path)
    name = by_suffix if format is None else text("format", format)
    if name not in _WRITERS:
        remedy = f"known are {', '.join(_WRITERS)}"
        raise RecordError(f"{path}: unknown format {shortened(name)}; {remedy}")
    if path.suffix.lower() not in FORMATS["matlab" if name == MATLAB_73 else name].suffixes:
        raise RecordError(f"{path}: its suffix does not fit the format {name}")
    if corrected := [q for q in measurement if measurement[q].correction]:
        raise RecordError(
            f"{path}: cannot hold that the {corrected[0]} is to be corrected for gain, delay or filters; keep the "
            "original with its mapping"
        )
    mapping = _wav_mapping(path, measurement) if name == "wav" else ""
    with replacing(path) as temporary:
        _WRITERS[name](temporary, measurement)
    if not mapping:
        return (path,)
    mapping_file = path.with_name(f"{path.name}.yaml")
    write_text(mapping_file, mapping)
    return path, mapping_file


def _columns_of(measurement: Measurement) -> dict[str, Array]:
    """The signals by column name, times first: time_s for all channels, or displacement_time_s before each."""
    channels = _channels(measurement)
    shared = all(np.array_equal(channel.t, channels[0].t) for channel in channels)
    columns: dict[str, Array] = {}
    for c in channels:
        times = "time_s" if shared else f"{c.quantity}_time_s"
        columns |= {times: c.t, column_name(c.quantity): c.values}
    return columns


def _write_text(path: Path, measurement: Measurement) -> None:
    delimiter = "," if path.suffix.lower() == ".csv" else "\t"
    _frame(measurement).to_csv(path, sep=delimiter, index=False, lineterminator="\n")


def _write_parquet(path: Path, measurement: Measurement) -> None:
    arrow, parquet = (library(name, "Parquet") for name in ("pyarrow", "pyarrow.parquet"))
    # A missing row of a shorter channel is a null, as it is an empty cell in text.
    table = arrow.Table.from_pandas(_frame(measurement), preserve_index=False)
    parquet.write_table(table.replace_schema_metadata(), path, compression="zstd")


def _write_matlab(path: Path, measurement: Measurement) -> None:
    from scipy.io import savemat

    savemat(path, _columns_of(measurement), appendmat=False, oned_as="column")
    _describe(path, "MATLAB 5.0")  # the library puts the time of day here


def _write_matlab73(path: Path, measurement: Measurement) -> None:
    h5py = library("h5py", "MATLAB 7.3")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in _columns_of(measurement).items():
            # A column of MATLAB, n × 1, is stored 1 × n.
            data = file.create_dataset(name, data=values[np.newaxis, :], track_times=False)
            data.attrs["MATLAB_class"] = np.bytes_("double")
    _describe(path, "MATLAB 7.3", bytes(8) + struct.pack("<H", 0x0200) + b"IM")


def _write_hdf5(path: Path, measurement: Measurement) -> None:
    h5py = library("h5py", "HDF5")
    with h5py.File(path, "w") as file:
        for name, values in _columns_of(measurement).items():
            data = file.create_dataset(name, data=values, track_times=False)
            data.attrs["unit"] = _unit_of(name)


def _write_uff(path: Path, measurement: Measurement) -> None:
    """Binary data sets 58. The header has five decimals for the step: where these are too few, every time is stored.
    Put together here: pyuff, which reads them, writes a wrong number of bytes where times are stored, and is slow."""
    sets = []
    for number, channel in enumerate(_channels(measurement), start=1):
        quantity = channel.quantity
        start = float(f"{channel.t[0]:.5e}")
        step = float(f"{channel.t[1] - channel.t[0]:.5e}")
        even = _is_even(channel, start, step)
        data = channel.values if even else np.stack([channel.t, channel.values], axis=1)
        unit = channel.unit.replace("²", "2")
        header = [
            f"{-1:6}",
            # little-endian, IEEE; 11 lines of text follow, then the bytes
            f"{58:6}b{1:6}{2:6}{11:12}{data.nbytes:12}{0:6}{0:6}{0:12}{0:12}",
            *(f"{text:80}" for text in (column_name(quantity), "NONE", "NONE", "NONE", "NONE")),
            f"{_UFF_TIME_RESPONSE:5}{number:10}{0:5}{0:10} {'NONE':10}{number:10}{0:4} {'NONE':10}{0:10}{0:4}",
            f"{_UFF_DOUBLE:10}{len(channel):10}{even:10}{even * start:13.5e}{even * step:13.5e}{0:13.5e}",
            f"{_UFF_TIME:10}{0:5}{0:5}{0:5} {'time':20} {'s':20}",
            f"{_UFF_TYPES[DIMENSIONS[quantity]]:10}{0:5}{0:5}{0:5} {quantity[:20]:20} {unit:20}",
            *[f"{0:10}{0:5}{0:5}{0:5} {'NONE':20} {'NONE':20}"] * 2,
        ]
        text = "".join(f"{line}\n" for line in header).encode("ascii")
        sets.append(text + data.astype("<f8").tobytes() + f"\n{-1:6}\n".encode("ascii"))
    path.write_bytes(b"".join(sets))


def _write_tdms(path: Path, measurement: Measurement) -> None:
    nptdms = library("nptdms", "TDMS")
    columns, channels = _columns_of(measurement), _channels(measurement)
    properties: dict[str, dict[str, Any]] = {n: {"unit_string": _unit_of(n)} for n in columns}
    even = []
    for channel in channels:
        start, step = float(channel.t[0]), float(channel.t[1] - channel.t[0])
        if _is_even(channel, start, step):
            even.append(column_name(channel.quantity))
            properties[even[-1]] |= {"wf_increment": step, "wf_start_offset": start}
    if len(even) == len(channels):
        columns = {name: columns[name] for name in even}
    with nptdms.TdmsWriter(str(path)) as file:
        for begin in range(0, max(values.size for values in columns.values()), _TDMS_SEGMENT):
            part = slice(begin, begin + _TDMS_SEGMENT)
            longer = [(name, v) for name, v in columns.items() if v.size > begin]
            file.write_segment(
                [nptdms.ChannelObject("record", n, v[part], properties[n]) for n, v in longer]
            )


def _write_wav(path: Path, measurement: Measurement) -> None:
    from scipy.io import wavfile

    channels = _channels(measurement)
    samples = np.stack([channel.values for channel in channels], axis=1)
    wavfile.write(path, round(mean_rate(channels[0].t)), samples)


def _wav_mapping(path: Path, measurement: Measurement) -> str:
    """The mapping next to a WAV. Raises RecordError when a WAV cannot hold the times."""
    channels = _channels(measurement)
    t = channels[0].t
    rate = round(mean_rate(t))
    if not all(np.array_equal(channel.t, t) for channel in channels):
        raise RecordError(
            f"{path}: a WAV has one time base for all channels, the record has several"
        )
    if rate < 1 or not np.allclose(t, np.arange(t.size) / rate, rtol=0.0, atol=1e-6 / rate):
        raise RecordError(
            f"{path}: a WAV begins at time 0 and has a whole number of samples per second, not {t[0]:g} s and "
            f"{mean_rate(t):.9g} Hz; use another format"
        )
    entries = enumerate(channels, start=1)
    rules = [f"  {c.quantity}: {{channel: {i}, unit: {c.unit}}}" for i, c in entries]
    return "\n".join(["channels:", *rules, f"notes: {_WAV_NOTE}", ""])


def _channels(measurement: Measurement) -> list[Channel]:
    return [measurement[q] for q in QUANTITIES if q in measurement]


def _frame(measurement: Measurement) -> pd.DataFrame:
    """The columns side by side; the shorter ones are empty at the end."""
    columns = _columns_of(measurement)
    return pd.DataFrame({name: pd.Series(values) for name, values in columns.items()})


def _unit_of(column: str) -> str:
    return next((unit for q, unit in QUANTITIES.items() if column == column_name(q)), "s")


def _is_even(channel: Channel, start: float, step: float) -> bool:
    """Whether first time and step give every time to the last bit."""
    return np.array_equal(sample_times(1.0 / step, start, 0, len(channel)), channel.t)


def _describe(path: Path, version: str, rest: bytes = b"") -> None:
    """Put the description that opens a MATLAB file over what is there, and the rest behind it."""
    text = f"{version} MAT-file, written by dampbalance".encode("ascii")
    with open(path, "r+b") as stream:
        stream.write(text.ljust(_MATLAB_TEXT) + rest)


_WRITERS: dict[str, Callable[[Path, Measurement], None]] = {
    "text": _write_text,
    "parquet": _write_parquet,
    "matlab": _write_matlab,
    MATLAB_73: _write_matlab73,
    "hdf5": _write_hdf5,
    "uff": _write_uff,
    "tdms": _write_tdms,
    "wav": _write_wav,
}
