"""Files of acquisition systems and data tools, read by their libraries: Parquet, universal files, TDMS, WAV, and the
text of LabVIEW."""

from __future__ import annotations

import io
import math
import re
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import RecordError, library
from ..headings import quantity_of, words_of
from ..table import RawChannel, Table, Unread, channels_of, samples_of, unit_among
from ..units import split_label

# universal files: quantity of a channel without a name, and of a frequency response
_SPECIFIC_TYPES = {8: "displacement", 9: "force", 11: "velocity", 12: "acceleration", 13: "force"}
_RESPONSE_TYPES = {8: "receptance", 11: "mobility", 12: "accelerance"}
# fields that name a time response, besides the label of its ordinate
_NAMING = ("id1", "id2", "rsp_ent_name", "id4", "id5")
_UFF_HEAD = re.compile(rb"(?m)^    58.*\n(?:.*\n){11}")


def parquet_file(path: Path) -> Table:
    """Return the table of a Parquet file; the unit of a column is in its metadata or its name. Points in time are read
    as s from the first on."""
    parquet = library("pyarrow.parquet", "Parquet")

    def read(name: str, part: Any) -> Any:
        with parquet.ParquetFile(path) as file:
            values = file.read(columns=[name]).column(0).to_numpy()
        return samples_of(values)[0][part]

    rows, channels = (parquet.read_metadata(path).num_rows,), list[RawChannel]()
    for field in parquet.read_schema(path):
        stated = {k.decode(errors="replace"): v for k, v in (field.metadata or {}).items()}
        stamps = str(field.type).startswith(("timestamp", "duration"))
        held = Unread(rows, partial(read, field.name))
        channels += channels_of(field.name, held, {"unit": unit_among(stated)}, "", stamps)
    return Table(path, channels)


def uff_file(path: Path) -> Table:
    """Return the table of a universal file: its time responses, data sets 58, in text or binary, at even or uneven
    times.

    The name of a channel consists of the ID line or component in which the channels differ and the label of the
    ordinate or the data type; also of node and direction, if several names are equal or do not tell what moves. If
    there are no time responses, the frequency responses are read: frequency, receptance, mobility or accelerance, and
    phase; "1/phase" of the first of several.
    """
    pyuff = library("pyuff", "a universal file")
    tidy = _tidied(path.read_bytes())
    if (tidy.count(b"    -1\n") + tidy.count(b"    -1\r")) % 2:
        raise RecordError(f"{path}: its last data set has no end; it was cut short")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "tidy.uff"
        copy.write_bytes(tidy)
        file = pyuff.UFF(str(copy))
        kinds = map(int, file.get_set_types())
        sets = [file.read_sets(i) for i, kind in enumerate(kinds) if kind == 58]
    # time responses
    times = [item for item in sets if item["func_type"] == 1]
    channels = list[RawChannel]()
    for item, label in zip(times, _names(times), strict=True):
        values, n = np.asarray(item["data"]), int(item["num_pts"])
        if values.size != n or np.iscomplexobj(values):
            what = f"data set {label!r} has {values.size} of its {n} values"
            raise RecordError(f"{path}: {what}; it was cut short or is no real signal")
        stated = {"unit": _stated(item, "ordinate_axis_units_lab")}
        if item["abscissa_spacing"] == 1:
            stated |= {"dt": item["abscissa_inc"], "t0": item["abscissa_min"]}
        else:  # its times stand in it, in front of it here
            seconds = {"unit": _stated(item, "abscissa_axis_units_lab") or "s"}
            channels += channels_of(f"{split_label(label)[0]} time", np.asarray(item["x"]), seconds)
        channels += channels_of(label, values, stated)
    # frequency responses
    responses = [item for item in sets if item["func_type"] == 4]
    for number, item in enumerate([] if channels else responses, start=1):
        channels += _frequency_response(item, f"{number}/" * (len(responses) > 1))
    if not channels:
        raise RecordError(f"{path}: holds no time response and no frequency response (data set 58)")
    return Table(path, channels)


def _tidied(raw: bytes) -> bytes:
    """Return the bytes of a universal file in a form that the library reads: heads in UTF-8 and, if no data set is
    binary, lines without blanks at the end, which it would take for numbers, that end in a line feed alone."""

    def in_utf8(head: re.Match[bytes]) -> bytes:
        try:
            head[0].decode()
        except UnicodeDecodeError:
            return head[0].decode("cp1252", "replace").encode()
        return head[0]

    raw = _UFF_HEAD.sub(in_utf8, raw)
    return raw if re.search(rb"(?m)^    58b", raw) else re.sub(rb"[ \t]*\r?\n", b"\n", raw)


def _names(sets: Sequence[dict[str, Any]]) -> list[str]:
    """Return the names of time responses: the first ID line, or the component of the response, in which they differ
    (the third ID line is a date), and the label of the ordinate unless the line contains it."""
    keys = [k for k in _NAMING if len({_stated(item, k) for item in sets}) > 1] or ["id1"]
    raws = []
    for item in sets:
        kind = _SPECIFIC_TYPES.get(int(item["ordinate_spec_data_type"]), "data")
        label = _stated(item, "ordinate_axis_lab") or kind
        own = _stated(item, keys[0]) or ""
        # a label has 20 characters at most
        has = label.casefold() in own.casefold() or {*words_of(label)} <= {*words_of(own)}
        name, unit = split_label(own if has else f"{own} {label}".strip())
        raws.append(RawChannel(name, _stated(item, "ordinate_axis_units_lab") or unit))
    degrees = [(_degree(item, "rsp"), _degree(item, "ref")) for item in sets]
    names = [raw.name for raw in raws]
    for i, (raw, (degree, reference)) in enumerate(zip(raws, degrees, strict=True)):
        alike = [one.name.casefold() for one in raws].count(raw.name.casefold()) > 1
        if degree and (alike or quantity_of(raw) is None):
            others = {degree for degree, other in degrees if other == reference}
            referred = ", the reference" * (degree == reference and len(others) > 1)
            names[i] = f"{raw.name} at {degree}{referred}"
    return names


def _degree(item: dict[str, Any], of: str) -> str:
    """Return the degree of freedom of a response ("rsp") or of its reference ("ref"), node 2 +Z; "" if none is
    stated."""
    node, direction = int(item[f"{of}_node"]), int(item[f"{of}_dir"])
    axis = ("", "X", "Y", "Z", "RX", "RY", "RZ")[min(abs(direction), 6)]
    named = _stated(item, f"{of}_ent_name"), f"node {node}" * bool(node)
    return " ".join(filter(None, (*named, "+-"[direction < 0] + axis if axis else "")))


def _frequency_response(item: dict[str, Any], folder: str) -> list[RawChannel]:
    """Return frequency, amplitude and phase of a frequency response."""
    H, over = np.asarray(item["data"]), _stated(item, "orddenom_axis_units_lab") or "N"
    name = _RESPONSE_TYPES.get(int(item["ordinate_spec_data_type"]), "response")
    unit = _stated(item, "ordinate_axis_units_lab")
    per_force = unit if unit is None or unit.endswith(f"/{over}") else f"{unit}/{over}"
    x, amplitude, phase = np.asarray(item["x"]), np.abs(H), np.angle(H)
    columns = ("frequency", x, "Hz"), (name, amplitude, per_force), ("phase", phase, "rad")
    return [raw for of, x, unit in columns for raw in channels_of(of, x, {"unit": unit}, folder)]


def tdms_file(path: Path) -> Table:
    """Return the table of a TDMS file; a channel is named "group/channel" if there are several groups. Step and unit
    are properties of the channel."""
    nptdms, log = library("nptdms", "TDMS"), library("nptdms.log", "TDMS").log_manager
    # keeps off the screen what the library reports about files that it can read
    complaints = io.StringIO()
    log.console_handler.setStream(complaints)
    log.console_handler.setFormatter(None)  # the bare messages

    def read(group: str, name: str, part: Any) -> Any:
        with open(path, "rb") as stream:
            return nptdms.TdmsFile.open(stream)[group][name][:][part]

    # opened here, so that the library ignores an index next to the file
    with open(path, "rb") as stream:
        file = nptdms.TdmsFile.open(stream)
    held = [
        c for group in file.groups() for c in group.channels() if c.dtype.kind in "fiu" and len(c)
    ]
    wrong = complaints.getvalue().partition("\n")[0]
    if file.file_status.incomplete_final_segment:
        wrong = "its last segment is incomplete"
    if wrong or not held:
        wrong = wrong or "holds no channel of numbers"
        raise RecordError(f"{path}: {wrong}; it was cut short, or the recording was not closed")
    several, channels = len({c.group_name for c in held}) > 1, list[RawChannel]()
    for c in held:
        samples = Unread((len(c),), partial(read, c.group_name, c.name))
        channels += channels_of(c.name, samples, c.properties, f"{c.group_name}/" * several)
    return Table(path, channels)


def wav_file(path: Path) -> Table:
    """Return the table of a WAV file: "channel 1", …, without units; integers become parts of full scale, −1 to 1."""
    from scipy.io import wavfile

    with warnings.catch_warnings():
        # warnings of chunks of notes, and of an early end if the size is a placeholder
        warnings.simplefilter("ignore", wavfile.WavFileWarning)
        warnings.filterwarnings("error", "Reached EOF(?!.* expected 4294967303 )")
        rate, data = wavfile.read(path)
    parts, scale = "", 1.0
    if data.dtype.kind in "iu":
        parts, scale = "recorded as parts of full scale", math.nan
        full = 2.0 ** (8 * data.dtype.itemsize - 1)
        data = data / full - (data.dtype.kind == "u")
    columns, channels = data.reshape(len(data), -1).T, list[RawChannel]()
    for number, column in enumerate(columns, start=1):
        raws = channels_of(f"channel {number}", column, {"sample_rate_hz": rate})
        channels += [replace(raw, scale=scale, described=parts) for raw in raws]
    return Table(path, channels)


def _stated(item: dict[str, str], *keys: str) -> str | None:
    """Return the first text under these keys; a universal file writes NONE for no text."""
    texts = (item[key].strip() for key in keys)
    return next((text for text in texts if text.upper() not in ("", "NONE")), None)


def lvm_file(path: Path) -> Table:
    """Return the table of a text file of LabVIEW: the channels of its only segment, with names, units and steps from
    the header."""
    reader = library("lvm_read", "a text file of LabVIEW")
    document = reader.read(str(path), read_from_pickle=False, dump_file=False)
    if document["Segments"] != 1:
        remedy = "a record has one: keep that of one level"
        raise RecordError(f"{path}: holds {document['Segments']} segments; {remedy}")
    segment, channels = document[0], list[RawChannel]()
    steps = segment.get("Delta_X", [0.0])
    timing = zip(steps, segment.get("X0", [0.0] * len(steps)), strict=False)
    units = iter(segment.get("Y_Unit_Label", []))
    for name, values in zip(
        map(str.strip, segment["Channel names"]), segment["data"].T, strict=False
    ):
        if name == "Comment":
            break
        if name != "X_Value":
            step, start = next(timing, (0.0, 0.0))
            stated = {"dt": step, "t0": start} if min(steps) > 0.0 else {}
            channels += channels_of(name, values, stated | {"unit": next(units, "")})
        elif not min(steps) > 0.0:  # otherwise the steps of the header have more digits
            channels += channels_of(name, values, {"unit": "s"})
    return Table(path, channels)
