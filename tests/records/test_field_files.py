"""Files as instruments, laboratories and Python write them, each made anew of the same two signals: read, or refused
with a mapping that reads them."""

from __future__ import annotations

import json
import math
import re
from functools import partial

import numpy as np
import pandas as pd
import pytest
import scipy.io
import yaml

from dampbalance import read_records
from dampbalance.records.coordinate import ROTATION
from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import mapping_to_start_from, read
from records.drafts import UNITS, filled, shown
from records.formats import row, text_file, uff_set, write_uff, xlsx

RATE, N = 20000.0, 2400
T = np.arange(N) / RATE
Y = np.round(4.0 * np.cos(70.0 * math.pi * T), 6)  # mm
A = np.round(1.5 * np.sin(70.0 * math.pi * T) + 0.2 * np.sin(210.0 * math.pi * T), 6)  # g
G = 9.80665  # m/s²
BOTH = {"base_displacement": 1e-3 * Y, "acceleration": G * A}
TWO = {"base_displacement": 1e-3 * Y, "displacement": 1e-3 * A}


def same(measurement, **signals):
    """Compare what was read with signals in SI units at the times T; a point in time has nine digits of a second at the
    most, values are products of a few numbers."""
    assert set(measurement) == set(signals)
    for quantity, values in signals.items():
        channel = measurement[quantity]
        np.testing.assert_allclose(channel.values, values, rtol=1e-14, atol=0)
        np.testing.assert_allclose(channel.t - channel.t[0], T, rtol=0, atol=1e-9)


def proposed(path, match, **columns):
    """The measurement of a file that is refused with that message, read by the mapping proposed in it with its blanks
    filled in: what columns hold."""
    with pytest.raises(RecordError, match=match) as refused:
        read(path)
    draft = shown(refused.value)
    assert draft == yaml.safe_load(mapping_to_start_from(path))
    rate = {"sample_rate_hz": RATE} if draft.get("sample_rate_hz") == "?" else {}
    return read(path, filled(draft, columns, units=UNITS | {"acceleration": "g"}, **rate))


# Files of laboratories: times, sheets, LabVIEW


def _csv(folder, stamps, name="time"):
    frame = pd.DataFrame({name: stamps, "base [mm]": Y, "acc [g]": A})
    frame.to_csv(folder / "run.csv", index=False)
    return folder / "run.csv"


def _parquet(folder, index):
    pd.DataFrame({"base_mm": Y, "acc_g": A}, index=index).to_parquet(folder / "run.parquet")
    return folder / "run.parquet"


SPANS = pd.to_timedelta(np.round(T * 1e9), unit="ns")
START = pd.Timestamp("2026-03-01T23:59:59.95")
POINTS = pd.DatetimeIndex(START + SPANS).as_unit("us")
ISO = [point.isoformat(timespec="microseconds") for point in POINTS]
OF_DAY = [text.partition("T")[2] for text in ISO]


def _german(folder):
    path = _csv(folder, [text.replace("T", " ") for text in ISO], "Zeit")
    text = path.read_text(encoding="utf-8").replace(",", ";").replace(".", ",")
    path.write_text(text.replace("[mm]", "[µm]"), encoding="cp1252")
    return path


def _two_columns(folder):
    dates = [text.partition("T")[0] for text in ISO]
    frame = pd.DataFrame({"date": dates, "time": OF_DAY, "base [mm]": Y, "acc [g]": A})
    frame.to_csv(folder / "run.txt", index=False, sep="\t")
    return folder / "run.txt"


def _xlsx(folder, rows, stamps=False):
    """A workbook as spreadsheets write it: a sheet of text alone, then one of text and numbers."""
    notes = [row(["Rig 3"]), row(["second run", "by hand"])]
    record = [row(cells, style=int(stamps and not isinstance(cells[0], str))) for cells in rows]
    xlsx(folder / "run.xlsx", notes, record)
    return folder / "run.xlsx"


LINES = np.column_stack([T, Y, A]).tolist()
LABVIEW = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t{mark}\n"
    "Multi_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tRelative\nOperator\tlab\nDate\t2026/03/01\n"
    "Time\t10:00:00\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t2400\t2400\t\n"
    "Date\t2026/03/01\t2026/03/01\t\nTime\t10:00:00\t10:00:00\t\nY_Unit_Label\tmm\tg\t\n"
    "X_Dimension\tTime\tTime\t\nX0\t0{mark}0E+0\t0{mark}0E+0\t\nDelta_X\t5{mark}0E-5\t5{mark}0E-5\t\n"
    "***End_of_Header***\t\t\t\nX_Value\tbase\tacc\tComment\n"
)


def _labview(folder, columns, mark):
    with_times = columns == "One"
    rows = (f"{f'{t:.6f}' if with_times else ''}\t{y:.6f}\t{a:.6f}\t\n" for t, y, a in LINES)
    text = LABVIEW.format(mark=mark, columns=columns) + "".join(rows).replace(".", mark)
    (folder / "run.lvm").write_text(text, encoding="utf-8")
    return folder / "run.lvm"


def _several(folder):
    """A file for each channel: times and values, values alone."""
    (folder / "acc").mkdir()
    pd.DataFrame({"time [s]": T, "base [mm]": Y}).to_csv(folder / "run.csv", index=False)
    pd.Series(A).to_csv(folder / "acc/run.dat", index=False, header=False)
    (folder / "run.yaml").write_text(
        "channels:\n  base_displacement: {channel: base}\n"
        "  acceleration: {file: acc/run.dat, channel: 1, unit: g}\nsample_rate_hz: 20000\n",
        encoding="utf-8",
    )
    return folder / "run.csv"


# Heads of instruments


def write(folder, head, columns, *layout):
    return text_file(folder / "run.csv", head, columns, *layout)


def oscilloscope(folder, *units):
    names, commas = [f"CH{i + 1}" for i in range(len(units))], "," * (len(units) - 1)
    head = ["Model,SCOPE54", "", "Horizontal Units,s", f"Sample Interval,{1 / RATE!r}"]
    head += [f"Vertical Units,{','.join(units)}", f"Vertical Scale,2{commas}", "", "Label,"]
    columns = [T - 0.5, Y, A] if commas else [T - 0.5, A]
    return write(folder, [*head, ",".join(["TIME", *names])], columns)


def servo(folder, names, units, interval="Sampling time interval(ms),0.05"):
    return write(folder, ["Number of sampling data,2400", interval, names, units], [Y, A])


def logger(folder, delimiter=";"):
    """A file with times of their own for each channel."""
    head = [["Timestamp", "2026-03-01 10:00:00"] * 2, ["Interval", "0.00005"] * 2]
    head += [["Channel name", "Base displacement", "Channel name", "Acceleration"]]
    lines = [delimiter.join(cells) for cells in [*head, ["Unit", "mm", "Unit", "g"]]]
    return write(folder, lines, [T, Y, T, A], delimiter, ".", "utf-8-sig", "\r\n")


def counter(folder, *head, name="Channel"):
    """A file whose first column counts samples."""
    head = [*head, f"{name},Base displacement,Acceleration", "Unit,mm,g"]
    return write(folder, head, [np.arange(float(N)), Y, A])


# MATLAB and Python


def matlab(folder, **held):
    scipy.io.savemat(folder / "run.mat", {"data": held})
    return folder / "run.mat"


def numpy(folder, held, suffix="npy"):
    path = folder / f"run.{suffix}"
    if suffix == "npy":
        np.save(path, held)
    else:
        np.savez_compressed(path, **held)
    return path


def written(folder, text):
    (folder / "run.json").write_text(text, encoding="utf-8")
    return folder / "run.json"


def objects(*texts):
    return np.array(texts, dtype=object)


MATRIX = {"t": T, "y": np.column_stack([Y, A])}
LABELS = ("Base displacement (mm)", "Acceleration [g]")
SIGNALS = [{"values": v[:, None], "label": of} for v, of in zip((Y, A), LABELS, strict=True)]
QUANTITIES = objects("Base displacement", "Acceleration")
FRAME = pd.DataFrame({"time_s": T, "base_displacement_mm": Y, "acceleration_g": A})
FIELDS, LISTS = FRAME.to_records(index=False), FRAME.to_dict("list")
RATED = {"fs": RATE, "base_displacement_mm": Y.tolist(), "acceleration_g": A.tolist()}
STAMPED = LISTS | {"time_s": [f"{text}Z" for text in ISO], "notes": "rig 3"}

# What is read at once: name → what makes the file

CORPUS = {
    "ISO 8601": partial(_csv, stamps=ISO, name="timestamp"),
    "ISO 8601 with a zone": partial(_csv, stamps=[f"{text}+01:00" for text in ISO]),
    "time of day over midnight": partial(_csv, stamps=OF_DAY),
    "date and time of day": _two_columns,
    "spans of pandas": partial(_csv, stamps=[str(span) for span in SPANS]),
    "Parquet, points with a zone": partial(_parquet, index=POINTS.tz_localize("Europe/Berlin")),
    "a file for each channel": _several,
    "spreadsheet": partial(_xlsx, rows=[["Rig 3"], ["t", "base", "acc"], ["s", "mm", "g"], *LINES]),
    "LabVIEW without times": partial(_labview, columns="No", mark="."),
    "LabVIEW with times, decimal comma": partial(_labview, columns="One", mark=","),
    "a logger": logger,
    "a counter": lambda at: counter(at, "Interval,0.00005", name="Channel name"),
    "a struct with labels": partial(matlab, **MATRIX, labels=objects(*LABELS)),
    "a struct with names and units": partial(
        matlab, **MATRIX, names=QUANTITIES, Units=objects("mm", "g")
    ),
    "signals of Simulink": partial(matlab, time=T[:, None], signals=SIGNALS),
    "arrays of NumPy": partial(numpy, held=RATED, suffix="npz"),
    "named fields": partial(numpy, held=FIELDS),
    "JSON": partial(written, text=json.dumps(LISTS)),
    "JSON with a rate": partial(written, text=json.dumps(RATED)),
    "JSON with points in time": partial(written, text=json.dumps(STAMPED)),
    **{
        f"JSON of pandas, {of}": partial(
            written, text=FRAME.to_json(orient=of, double_precision=15)
        )
        for of in ("columns", "records", "split")
    },
}
SPEED, TURNING = {"velocity": 1e-3 * Y, "force": A}, {"velocity": Y * math.pi / 30}
OTHERS = {
    "decimal commas, a code page of Windows": (_german, BOTH | {"base_displacement": 1e-6 * Y}),
    "an oscilloscope with a unit": (lambda at: oscilloscope(at, "g"), {"acceleration": G * A}),
    "an interval in ms": (lambda at: servo(at, "Speed,Force", "mm/s,N"), SPEED),
    "a rate": (lambda at: servo(at, "Speed,Force", "mm/s,N", "Sampling rate [kHz],20"), SPEED),
    "r/min": (lambda at: servo(at, "Motor speed,Torque", "r/min,%"), TURNING),
    "x of the mass, y of the base": (lambda at: write(at, ["t [s],x [mm],y [mm]"], [T, A, Y]), TWO),
}


@pytest.mark.filterwarnings("ignore::dampbalance.records.errors.RecordWarning")
@pytest.mark.parametrize("kind", [*CORPUS, *OTHERS])
def test_a_file_gives_its_signals(tmp_path, kind):
    make, held = OTHERS.get(kind) or (CORPUS[kind], BOTH)
    found = read(make(tmp_path))
    same(found, **held)
    assert (found.coordinate is ROTATION) == (kind == "r/min")


# What is refused with a mapping that reads it: what makes the file, the message, what columns hold, and the signals

IN_ORDER = ("base_displacement", "displacement")
MATRICES = ("column[2]", "column[3]")
OPEN = "what do the columns"
PROPOSED = {
    "volts": (lambda at: oscilloscope(at, "V", "V"), "'CH1 .V.' and 'CH2 .V.'", ("CH1", "CH2")),
    "a struct": (partial(matlab, **MATRIX), OPEN, ("data.y[1]", "data.y[2]")),
    "rows": (partial(matlab, time=T, values=[Y, A]), OPEN, ("data.values[1]", "data.values[2]")),
    "an array": (partial(numpy, held=LINES), OPEN, MATRICES),
    "an array, turned": (partial(numpy, held=np.transpose(LINES)), OPEN, MATRICES),
    "JSON of rows": (partial(written, text=json.dumps(LINES)), OPEN, MATRICES),
}


@pytest.mark.parametrize("kind", PROPOSED)
def test_a_file_is_refused_with_a_mapping_that_reads_it(tmp_path, kind):
    make, message, names = PROPOSED[kind]
    found = proposed(make(tmp_path), message, **dict(zip(IN_ORDER, names, strict=True)))
    same(found, **TWO)


def test_a_column_that_counts_below_the_word_channel_is_no_time(tmp_path):
    same(proposed(counter(tmp_path), "at which rate was it sampled"), **BOTH)
    # an interval of no unit may be in ms
    proposed(counter(tmp_path, "Interval,0.9765625"), "at which rate was it sampled")


# What is odd, or refused


def test_dates_of_a_spreadsheet_give_the_rate(tmp_path):
    """They are parts of a day, with 15 digits: microseconds; the library rounds them to milliseconds."""
    epoch = (START - pd.Timestamp("1899-12-30")) / pd.Timedelta(days=1)
    days = np.column_stack([epoch + 10.0 * T / 86400.0, Y, A]).tolist()
    path = _xlsx(tmp_path, [["when", "base [mm]", "acc [g]"], *days], stamps=True)
    with pytest.warns(RecordWarning, match=r"rounded to 0\.001 s at steps of 0\.0005 s"):
        measurement = read(path)
    t = measurement["base_displacement"].t
    # what the warning says is off at the most: 1.5 ms in the 1.2 s of the record
    assert (t.size - 1) / (t[-1] - t[0]) == pytest.approx(0.1 * RATE, rel=1.25e-3)
    np.testing.assert_allclose(measurement["base_displacement"].values, 1e-3 * Y, rtol=1e-15)


@pytest.mark.parametrize("rate", [12800.0, 999.7, 600.0])
@pytest.mark.parametrize("cut", [np.round, np.trunc])
def test_rounded_times_give_the_rate_within_the_bound_that_is_told(rate, cut):
    t = np.arange(round(3.0 * rate)) / rate + 0.1234
    y, x = np.cos(22.0 * t), np.sin(22.0 * t)
    (record,) = read_records({"time [s]": cut(1e3 * t) / 1e3, "y [mm]": y, "x [mm]": x})
    (told,) = record.warnings
    found, bound = record["displacement"].t, told.shift("")
    assert bound == pytest.approx(1.5e-3 / 3.0, rel=0.05)
    assert (found.size - 1) / (found[-1] - found[0]) == pytest.approx(rate, rel=bound)
    np.testing.assert_allclose(found, t, atol=1.5e-3)


def test_cells_of_text_among_numbers(tmp_path):
    """A number in one counts, an error of a sheet is a missing sample, and any other is named."""
    rows = [["t [s]", "base [mm]", "acc [g]"], *(line.copy() for line in LINES)]
    rows[100][2], rows[101][2] = "0.25", "#N/A"
    with pytest.warns(RecordWarning, match="'acc': 1 sample is empty .*: row 102"):
        found = read(_xlsx(tmp_path, rows))["acceleration"]
    assert found.values[99] == 0.25 * G
    assert np.flatnonzero(found.missing).tolist() == [100]
    rows[100][2] = "off"
    with pytest.raises(RecordError, match=r"xlsx: row 101, column 'acc': 'off' is not a number"):
        read(_xlsx(tmp_path, rows))


def test_several_segments_of_labview_are_refused(tmp_path):
    path = _labview(tmp_path, "No", ".")
    text = path.read_text(encoding="utf-8")
    path.write_text(text + text.split("***End_of_Header***\t\n", 1)[1], encoding="utf-8")
    with pytest.raises(RecordError, match=r"lvm: holds 2 segments; a record has one"):
        read(path)


def test_channels_of_several_files_are_looked_for_where_the_mapping_says(tmp_path):
    path, mapping = _several(tmp_path), tmp_path / "run.yaml"
    text = mapping.read_text(encoding="utf-8")
    for old, new, message in (
        ("acc/run.dat", "acc/none.dat", r"acc/none\.dat: no such file"),
        ("channel: 1", "channel: 2", r"acceleration\.channel: there is no channel 2; .*run\.dat"),
        ("acceleration:", "force:", r"run\.yaml: line 1: channels: needs one of .*, and at least"),
    ):
        mapping.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(RecordError, match=message):
            read(path)


UNIVERSAL = {
    "blanks after the last number": (0, rb"\n    -1\n(?!    58)", b"     \n    -1\n"),
    "CRLF": (0, b"\n", b"\r\n"),
    "CRLF before -1": (1, b"\n    -1", b"\r\n    -1"),
    "blanks after -1": (0, b"    -1\n", b"    -1   \n"),
}


@pytest.mark.parametrize("kind", UNIVERSAL)
@pytest.mark.parametrize("even", [1, 0])
def test_universal_files_as_programs_write_them(tmp_path, kind, even):
    path, (binary, old, new) = tmp_path / "run.uff", UNIVERSAL[kind]
    more = {"binary": binary, "abscissa_spacing": even, "id2": "rig 3"}
    columns = {"base_displacement_m": 1e-3 * Y, "acceleration_m_per_s2": A}
    sets = [uff_set(T, name, of) | more | {"id4": name} for name, of in columns.items()]
    write_uff(path, [*sets, sets[0] | {"func_type": 4}])  # a frequency response is no record
    path.write_bytes(re.sub(old, new, path.read_bytes()))
    measurement = read(path)
    assert set(measurement) == {*BOTH}
    # six digits in text
    np.testing.assert_allclose(measurement["acceleration"].values, A, rtol=1e-5, atol=1e-9)


NO_RECORDS = {
    '{"time_s": [0, 1': "cannot be read as JSON",
    "[" * 100_000: "cannot be read as JSON",
    "3.0": "neither columns nor rows",
    '{"time_s": [0, 1, 2], "y_mm": [0, "a", 2], "x_mm": [1, 2, 0]}': "holds texts",
    '{"time_s": [0, 1, 2], "y_mm": [0, null, 2], "x_mm": [1, 2, 0]}': r"\(NaN\)",
    '{"time_s": [0, 1, 2, 3], "y_mm": [0, 1, 2], "x_mm": [1, 2, 0, 1]}': "'y' has 3, ",
    "[1e400, 2]": "finds no response",
    '{"time_s": {"0": 0.0, "1": 0.1}, "x_m": {"0": 1.0}}': "finds no response",
}


@pytest.mark.parametrize("text", NO_RECORDS, ids=range(len(NO_RECORDS)))
def test_json_that_holds_no_record(tmp_path, text):
    path = tmp_path / "run.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError, match=NO_RECORDS[text]):
        read(path)
