"""Universal files, TDMS and WAV: files of sampled signals."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np

from ...arrays import Array
from ..errors import RecordError, library
from .record_file import (
    RawChannel,
    RecordFile,
    Sliced,
    described,
    intact,
    require_bytes,
    unit_among,
)

_TIME_RESPONSE = 1  # function type of a data set 58
_SPECIFIC_TYPES = {8: "displacement", 9: "force", 11: "velocity", 12: "acceleration", 13: "force"}
_NO_SIZE = (0, 0xFFFFFFFF)  # what a program writes that does not know how long a WAV will become


def uff_file(path: Path, largest: int) -> RecordFile:
    """A universal file: its time responses, data sets 58, with even or uneven abscissa, in text or binary.

    A channel is called by its ordinate's label, else by its first ID line, else by what the data type says.
    """
    pyuff = library("pyuff", "a universal file")
    require_bytes(path, "a universal file", largest)
    channels, arrays = [], []
    with intact(path, "a universal file"):
        file = pyuff.UFF(str(path))
        marks = path.read_bytes().count(b"    -1\n") + path.read_bytes().count(b"    -1\r")
        sets = [file.read_sets(i) for i, kind in enumerate(file.get_set_types()) if int(kind) == 58]
        sets = [item for item in sets if item["func_type"] == _TIME_RESPONSE]
        for item in sets:
            n = int(item["num_pts"])
            label = _stated(item, "ordinate_axis_lab", "id1") or _SPECIFIC_TYPES.get(
                int(item["ordinate_spec_data_type"]), "data"
            )
            values = np.asarray(item["data"])
            if values.size != n or np.iscomplexobj(values):
                raise RecordError(
                    f"{path}: data set {label!r} has {values.size} of its {n} values; it was cut short or is no real "
                    "signal"
                )
            even = item["abscissa_spacing"] == 1
            timing = {"dt": item["abscissa_inc"], "t0": item["abscissa_min"]} if even else {}
            channel = described(path, label, n, timing, _stated(item, "ordinate_axis_units_lab"))
            if not even:  # its times stand in it, in front of it here
                seconds = _stated(item, "abscissa_axis_units_lab") or "s"
                channels.append(RawChannel(f"{channel.name} time", seconds, n))
                arrays.append(np.asarray(item["x"]))
            channels.append(channel)
            arrays.append(values)
    if marks % 2:
        raise RecordError(f"{path}: its last data set has no end; it was cut short")
    if not sets:
        raise RecordError(f"{path}: holds no time response (data set 58)")
    return Sliced(path, channels, lambda i, a, b: arrays[i][a:b], "a universal file")


def tdms_file(path: Path, largest: int) -> RecordFile:
    """A TDMS file: its channels, "group/channel" if there are several groups; step and unit are properties."""
    nptdms, log = library("nptdms", "TDMS"), library("nptdms.log", "TDMS").log_manager
    # what the library complains about, and would read nevertheless; nothing of it reaches the screen
    complaints = io.StringIO()
    log.console_handler.setStream(complaints)
    log.console_handler.setFormatter(None)  # the bare messages
    # the file alone, not an index that may lie beside it; the reader closes it
    stream = open(path, "rb")  # noqa: SIM115
    with intact(path, "TDMS", stream.close):
        file = nptdms.TdmsFile.open(stream)
        every = (channel for group in file.groups() for channel in group.channels())
        signals = [c for c in every if c.dtype.kind in "fiu" and len(c)]
        if not signals:
            raise RecordError(
                f"{path}: holds no channel of numbers; it was cut short, or the recording was not closed"
            )
        if file.file_status.incomplete_final_segment:
            raise RecordError(
                f"{path}: its last segment is incomplete: the file was cut short, or the recording was not closed"
            )
        if first := complaints.getvalue().partition("\n")[0]:
            raise RecordError(f"{path}: is damaged or was cut short ({first})")
        several = len({c.group_name for c in signals}) > 1
        channels = [
            described(
                *(path, c.name, len(c), dict(c.properties), unit_among(c.properties)),
                folder=f"{c.group_name}/" if several else "",
            )
            for c in signals
        ]
    return Sliced(path, channels, lambda i, a, b: signals[i][a:b], "TDMS", stream.close)


def wav_file(path: Path, largest: int) -> RecordFile:
    """A WAV file: its channels are "channel 1", …, without unit; integers become parts of full scale, −1 to 1."""
    from scipy.io import wavfile

    with open(path, "rb") as stream:
        kind, stated = stream.read(4), stream.read(4)
    count = int.from_bytes(stated, "big" if kind == b"RIFX" else "little")
    size = path.stat().st_size
    if kind != b"RF64" and count not in _NO_SIZE and count + 8 > size:
        raise RecordError(
            f"{path}: has {size} of the {count + 8} bytes that its header says; it was cut short"
        )
    with intact(path, "WAV"), warnings.catch_warnings():
        # chunks of notes that hold no samples
        warnings.simplefilter("ignore", wavfile.WavFileWarning)
        try:
            rate, data = wavfile.read(path, mmap=True)
        except ValueError:  # 24-bit samples cannot be mapped
            rate, data = wavfile.read(path)
    table = data.reshape(len(data), -1)
    full = 2.0 ** (8 * data.dtype.itemsize - 1) if data.dtype.kind in "iu" else 1.0
    zero = full if data.dtype.kind == "u" else 0.0
    names = [f"channel {i + 1}" for i in range(table.shape[1])]
    channels = [RawChannel(name, size=len(table), rate_hz=float(rate)) for name in names]

    def read(i: int, begin: int, end: int) -> Array:
        return (np.asarray(table[begin:end, i], dtype=np.float64) - zero) / full

    return Sliced(path, channels, read, "WAV")


def _stated(item: dict[str, str], *keys: str) -> str | None:
    """The first text under these keys; a universal file says NONE for nothing."""
    texts = (item[key].strip() for key in keys)
    return next((text for text in texts if text.upper() not in ("", "NONE")), None)
