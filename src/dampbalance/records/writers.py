"""Writing a measurement in every format that `readers` reads: complete or not at all, the same bytes every time.

Values are written in SI units, as 64-bit floats, with names that `read` recognises (displacement_m). Times are written
as such, or as first time and sampling rate where these give every time to the last bit. Only WAV cannot hold names,
units and a sampling rate that is no whole number: a mapping is written beside it.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from ..arrays import Array
from ..project.files import replacing, write_text
from .errors import RecordError, library
from .measurement import QUANTITIES, Measurement
from .readers.formats import FORMATS, format_by_suffix
from .readers.record_file import times
from .units import DIMENSIONS, header_suffix

MATLAB_73 = "matlab73"
_MATLAB_TEXT = 116  # bytes of description at the start of a MATLAB file
_UFF_TYPES = {"length": 8, "velocity": 11, "acceleration": 12, "force": 13}
_TDMS_SEGMENT = 65_536  # samples per segment: a reader takes at least one into memory
_WAV_NOTE = "a WAV has neither names nor units; its samples are 64-bit floats in these units"
_UFF_TIME_RESPONSE = 1  # function type
_UFF_TIME = 17  # specific data type of the abscissa
_UFF_DOUBLE = 4  # ordinate data type: real, double precision


def write(
    path: str | Path, measurement: Measurement, format: str | None = None
) -> tuple[Path, ...]:
    """Write a measurement in the format of the suffix; returns the files written (for WAV, its mapping too).

    format : a key of `readers.FORMATS` or "matlab73", for a suffix that stands for several; .mat is MATLAB 5 by itself.

    Raises RecordError when the format cannot hold the measurement, before anything is written.
    """
    path = Path(path)
    by_suffix = format_by_suffix(path)
    name = format or by_suffix
    if name not in _WRITERS:
        raise RecordError(f"{path}: unknown format {name!r}; known are {', '.join(_WRITERS)}")
    if path.suffix.lower() not in FORMATS["matlab" if name == MATLAB_73 else name].suffixes:
        raise RecordError(f"{path}: its suffix does not fit the format {name}")
    return _WRITERS[name](path, measurement)


def columns_of(measurement: Measurement) -> dict[str, Array]:
    """The signals by column name, times first: time_s for all channels, or displacement_time_s before each."""
    channels = [measurement[q] for q in QUANTITIES if q in measurement]
    if all(np.array_equal(channel.t, channels[0].t) for channel in channels):
        return {"time_s": channels[0].t} | {_label(c.quantity): c.values for c in channels}
    columns: dict[str, Array] = {}
    for channel in channels:
        columns[f"{channel.quantity}_time_s"] = channel.t
        columns[_label(channel.quantity)] = channel.values
    return columns


def _write_text(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    delimiter = "," if path.suffix.lower() == ".csv" else "\t"
    with replacing(path) as temporary:
        _frame(measurement).to_csv(temporary, sep=delimiter, index=False, lineterminator="\n")
    return (path,)


def _write_parquet(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    arrow = library("pyarrow", "Parquet")
    parquet = library("pyarrow.parquet", "Parquet")
    # A missing row of a shorter channel is a null, as it is an empty cell in text.
    columns = {
        name: arrow.array(series.to_numpy(), from_pandas=True)
        for name, series in _frame(measurement).items()
    }
    with replacing(path) as temporary:
        parquet.write_table(arrow.table(columns), temporary, compression="zstd")
    return (path,)


def _write_matlab(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    from scipy.io import savemat

    with replacing(path) as temporary:
        savemat(temporary, columns_of(measurement), appendmat=False, oned_as="column")
        with open(temporary, "r+b") as stream:  # the library puts the time of day here
            stream.write(_matlab_text("MATLAB 5.0 MAT-file, written by dampbalance"))
    return (path,)


def _write_matlab73(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    h5py = library("h5py", "MATLAB 7.3")
    with replacing(path) as temporary:
        with h5py.File(temporary, "w", userblock_size=512) as file:
            for name, values in columns_of(measurement).items():
                # A column of MATLAB, n × 1, is stored 1 × n.
                data = file.create_dataset(name, data=values[np.newaxis, :], track_times=False)
                data.attrs["MATLAB_class"] = np.bytes_("double")
        with open(temporary, "r+b") as stream:
            text = _matlab_text("MATLAB 7.3 MAT-file, written by dampbalance")
            stream.write(text + bytes(8) + struct.pack("<H", 0x0200) + b"IM")
    return (path,)


def _write_hdf5(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    h5py = library("h5py", "HDF5")
    with replacing(path) as temporary, h5py.File(temporary, "w") as file:
        for name, values in columns_of(measurement).items():
            data = file.create_dataset(name, data=values, track_times=False)
            data.attrs["unit"] = _unit_of(name)
    return (path,)


def _write_uff(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    """Binary data sets 58. The header has five decimals for the step: where these are too few, every time is stored.

    Put together here: pyuff, which reads them, overwrites the header of a binary set in a new file.
    """
    sets = []
    for number, quantity in enumerate((q for q in QUANTITIES if q in measurement), start=1):
        channel = measurement[quantity]
        start = float(f"{channel.t[0]:.5e}")
        step = float(f"{channel.t[1] - channel.t[0]:.5e}")
        even = np.array_equal(times(1.0 / step, start, 0, len(channel)), channel.t)
        data = channel.values if even else np.stack([channel.t, channel.values], axis=1)
        unit = header_suffix(channel.unit).replace("_per_", "/")
        header = [
            f"{-1:6}",
            # little-endian, IEEE; 11 lines of text follow, then the bytes
            f"{58:6}b{1:6}{2:6}{11:12}{data.nbytes:12}{0:6}{0:6}{0:12}{0:12}",
            *(f"{text:80}" for text in (_label(quantity), "NONE", "NONE", "NONE", "NONE")),
            f"{_UFF_TIME_RESPONSE:5}{number:10}{0:5}{0:10} {'NONE':10}{number:10}{0:4} {'NONE':10}{0:10}{0:4}",
            f"{_UFF_DOUBLE:10}{len(channel):10}{even:10}{even * start:13.5e}{even * step:13.5e}{0:13.5e}",
            f"{_UFF_TIME:10}{0:5}{0:5}{0:5} {'time':20} {'s':20}",
            f"{_UFF_TYPES[DIMENSIONS[quantity]]:10}{0:5}{0:5}{0:5} {quantity:20} {unit:20}",
            *[f"{0:10}{0:5}{0:5}{0:5} {'NONE':20} {'NONE':20}"] * 2,
        ]
        text = "".join(f"{line}\n" for line in header).encode("ascii")
        sets.append(text + data.astype("<f8").tobytes() + f"\n{-1:6}\n".encode("ascii"))
    with replacing(path) as temporary:
        temporary.write_bytes(b"".join(sets))
    return (path,)


def _write_tdms(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    nptdms = library("nptdms", "TDMS")
    columns = columns_of(measurement)
    channels = [measurement[q] for q in QUANTITIES if q in measurement]
    waveform: dict[str, dict[str, float]] = {}
    for channel in channels:
        start, step = float(channel.t[0]), float(channel.t[1] - channel.t[0])
        if np.array_equal(times(1.0 / step, start, 0, len(channel)), channel.t):
            waveform[_label(channel.quantity)] = {"wf_increment": step, "wf_start_offset": start}
    if len(waveform) == len(channels):
        columns = {name: values for name, values in columns.items() if name in waveform}
    with replacing(path) as temporary, nptdms.TdmsWriter(str(temporary)) as file:
        for begin in range(0, max(values.size for values in columns.values()), _TDMS_SEGMENT):
            file.write_segment(
                [
                    nptdms.ChannelObject(
                        "record",
                        name,
                        values[begin : begin + _TDMS_SEGMENT],
                        {"unit_string": _unit_of(name), **waveform.get(name, {})},
                    )
                    for name, values in columns.items()
                    if values.size > begin
                ]
            )
    return (path,)


def _write_wav(path: Path, measurement: Measurement) -> tuple[Path, ...]:
    from scipy.io import wavfile

    channels = [measurement[q] for q in QUANTITIES if q in measurement]
    t = channels[0].t
    rate = round((t.size - 1) / float(t[-1] - t[0]))
    if not all(np.array_equal(channel.t, t) for channel in channels):
        raise RecordError(
            f"{path}: a WAV has one time base for all channels, the record has several"
        )
    if rate < 1 or not np.allclose(t, np.arange(t.size) / rate, rtol=0.0, atol=1e-6 / max(rate, 1)):
        raise RecordError(
            f"{path}: a WAV begins at time 0 and has a whole number of samples per second, not {_rate_text(t)}; "
            "use another format"
        )
    beside = path.with_name(f"{path.name}.yaml")
    rules = [
        f"  {c.quantity}: {{channel: {i}, unit: {c.unit}}}" for i, c in enumerate(channels, start=1)
    ]
    with replacing(path) as temporary:
        wavfile.write(temporary, rate, np.stack([c.values for c in channels], axis=1))
    write_text(beside, "\n".join(["channels:", *rules, f"notes: {_WAV_NOTE}", ""]))
    return path, beside


def _frame(measurement: Measurement) -> pd.DataFrame:
    """The columns side by side; the shorter ones are empty at the end."""
    return pd.DataFrame(
        {name: pd.Series(values) for name, values in columns_of(measurement).items()}
    )


def _label(quantity: str) -> str:
    return f"{quantity}_{header_suffix(QUANTITIES[quantity])}"


def _unit_of(column: str) -> str:
    return next((unit for q, unit in QUANTITIES.items() if column == _label(q)), "s")


def _matlab_text(text: str) -> bytes:
    return text.encode("ascii").ljust(_MATLAB_TEXT)


def _rate_text(t: Array) -> str:
    return f"{t[0]:g} s and {(t.size - 1) / float(t[-1] - t[0]):.9g} Hz"


_WRITERS: dict[str, Callable[[Path, Measurement], tuple[Path, ...]]] = {
    "text": _write_text,
    "parquet": _write_parquet,
    "matlab": _write_matlab,
    MATLAB_73: _write_matlab73,
    "hdf5": _write_hdf5,
    "uff": _write_uff,
    "tdms": _write_tdms,
    "wav": _write_wav,
}
