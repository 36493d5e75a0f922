"""A corpus of files as laboratories write them, each read and compared with the signals it was made of."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dampbalance import read_records
from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import read
from records.workbooks import row, xlsx

RATE = 20000.0
T = np.arange(4000) / RATE
Y = np.round(4.0 * np.cos(70.0 * math.pi * T), 6)  # mm
A = np.round(1.5 * np.sin(70.0 * math.pi * T) + 0.2 * np.sin(210.0 * math.pi * T), 6)  # g
G = 9.80665
START = pd.Timestamp("2026-03-01T23:59:59.9")


def _frame(stamps, name="time") -> pd.DataFrame:
    return pd.DataFrame({name: stamps, "base [mm]": Y, "acc [g]": A})


def _csv(folder, stamps, name="time"):
    _frame(stamps, name).to_csv(folder / "run.csv", index=False)
    return folder / "run.csv"


def _parquet(folder, index):
    pd.DataFrame({"base_mm": Y, "acc_g": A}, index=index).to_parquet(folder / "run.parquet")
    return folder / "run.parquet"


def _points(unit="ns") -> pd.DatetimeIndex:
    return pd.DatetimeIndex(START + pd.to_timedelta(np.round(T * 1e9), unit="ns")).as_unit(unit)


def _iso(zone="") -> list[str]:
    return [f"{p.isoformat(timespec='microseconds')}{zone}" for p in _points("us")]


def _of_day() -> list[str]:
    return [p.strftime("%H:%M:%S.%f") for p in _points("us")]


def _two_columns(folder: Path) -> Path:
    frame = _frame(_of_day())
    frame.insert(0, "date", [p.date().isoformat() for p in _points("us")])
    frame.to_csv(folder / "run.txt", index=False, sep="\t")
    return folder / "run.txt"


def _german(folder: Path) -> Path:
    frame = _frame([p.replace("T", " ").replace(".", ",") for p in _iso()], "Zeit")
    frame.to_csv(folder / "run.csv", index=False, sep=";", decimal=",", encoding="cp1252")
    return folder / "run.csv"


EXCEL_EPOCH = pd.Timestamp("1899-12-30")


def _xlsx(folder: Path, rows: list[list[object]], stamps: bool = False) -> Path:
    """A workbook as spreadsheets write it: a sheet of text alone, then one of text and numbers."""
    notes = [row(["Rig 3"]), row(["second run", "by hand"])]
    record = [row(cells, style=int(stamps and not isinstance(cells[0], str))) for cells in rows]
    xlsx(folder / "run.xlsx", notes, record)
    return folder / "run.xlsx"


def _sheet_of_numbers(folder: Path) -> Path:
    rows = [["Rig 3"], ["t", "base", "acc"], ["s", "mm", "g"], *np.column_stack([T, Y, A]).tolist()]
    return _xlsx(folder, rows)


def _sheet_of_dates(folder: Path) -> Path:
    days = [((START - EXCEL_EPOCH) / pd.Timedelta(days=1)) + 10.0 * t / 86400.0 for t in T]
    rows = [["when", "base [mm]", "acc [g]"], *np.column_stack([days, Y, A]).tolist()]
    return _xlsx(folder, rows, stamps=True)


def _lvm(folder: Path, columns: str, comma: bool = False) -> Path:
    mark, both = "," if comma else ".", columns == "One"
    head = (
        f"LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t{mark}\n"
        f"Multi_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tRelative\nOperator\tlab\nDate\t2026/03/01\n"
        "Time\t10:00:00\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t4000\t4000\t\n"
        "Date\t2026/03/01\t2026/03/01\t\nTime\t10:00:00\t10:00:00\t\nY_Unit_Label\tmm\tg\t\n"
        f"X_Dimension\tTime\tTime\t\nX0\t0.0E+0\t0.0E+0\t\nDelta_X\t{5e-5:.6E}\t{5e-5:.6E}\t\n"
        "***End_of_Header***\t\t\t\nX_Value\tbase\tacc\tComment\n"
    )
    rows = (
        f"{f'{t:.6f}' if both else ''}\t{y:.6f}\t{a:.6f}\t" for t, y, a in zip(T, Y, A, strict=True)
    )
    text = head.replace(".000000E", f"{mark}000000E") + "\n".join(rows).replace(".", mark) + "\n"
    (folder / "run.lvm").write_text(text, encoding="utf-8")
    return folder / "run.lvm"


def _several(folder: Path) -> Path:
    """A file for each channel: times and values, values alone."""
    (folder / "acc").mkdir()
    frame = _frame(T, "time [s]")
    frame[["time [s]", "base [mm]"]].to_csv(folder / "run.csv", index=False)
    frame["acc [g]"].to_csv(folder / "acc/run.dat", index=False, header=False)
    (folder / "run.yaml").write_text(
        "channels:\n  base_displacement: {channel: base}\n"
        "  acceleration: {file: acc/run.dat, channel: 1, unit: g}\nsample_rate_hz: 20000\n",
        encoding="utf-8",
    )
    return folder / "run.csv"


SPANS = pd.to_timedelta(np.round(T * 1e9), unit="ns")

CORPUS = {
    "ISO 8601": lambda folder: _csv(folder, _iso(), "timestamp"),
    "ISO 8601 with a zone": lambda folder: _csv(folder, _iso("+01:00")),
    "points in time of pandas": lambda folder: _csv(folder, _points("us"), ""),
    "time of day over midnight": lambda folder: _csv(folder, _of_day()),
    "date and time of day": _two_columns,
    "Windows, decimal comma": _german,
    "spans of pandas": lambda folder: _csv(folder, [str(span) for span in SPANS]),
    "Parquet, points in time with a zone": lambda folder: _parquet(folder, _points("us").tz_localize("Europe/Berlin")),
    "Parquet, spans": lambda folder: _parquet(folder, SPANS),
    "a file for each channel": _several,
    "spreadsheet": _sheet_of_numbers,
    "LabVIEW without times": lambda folder: _lvm(folder, "No"),
    "LabVIEW with times, decimal comma": lambda folder: _lvm(folder, "One", comma=True),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:.*channels not used. 'date'")
@pytest.mark.parametrize("kind", CORPUS)
def test_a_file_of_a_laboratory_gives_its_signals(tmp_path, kind):
    path = CORPUS[kind](tmp_path)
    measurement = read(path)
    assert set(measurement) == {"base_displacement", "acceleration"}
    for quantity, values in (("base_displacement", 1e-3 * Y), ("acceleration", G * A)):
        channel = measurement[quantity]
        np.testing.assert_allclose(channel.values, values, rtol=1e-15, atol=0)
        # a point in time has nine digits of a second at the most
        np.testing.assert_allclose(channel.t - channel.t[0], T, rtol=0, atol=1e-9)


def test_dates_of_a_spreadsheet_give_the_rate(tmp_path):
    """They are parts of a day, with 15 digits: microseconds; the library rounds them to milliseconds."""
    with pytest.warns(RecordWarning, match=r"rounded to 0\.001 s at steps of 0\.0005 s.* 1999\.99"):
        measurement = read(_sheet_of_dates(tmp_path))
    t = measurement["base_displacement"].t
    # what the warning says is off at the most: 1.5 ms in the 2 s of the record
    assert (t.size - 1) / (t[-1] - t[0]) == pytest.approx(0.1 * RATE, rel=7.5e-4)
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
    rows = [["t [s]", "base [mm]", "acc [g]"], *np.column_stack([T, Y, A]).tolist()]
    rows[100][2], rows[101][2] = "0.25", "#N/A"
    with pytest.warns(RecordWarning, match="'acc': 1 sample is empty .*: row 102"):
        found = read(_xlsx(tmp_path, rows))["acceleration"]
    assert found.values[99] == 0.25 * G
    assert np.flatnonzero(found.missing).tolist() == [100]
    rows[100][2] = "off"
    with pytest.raises(RecordError, match=r"xlsx: row 101, column 'acc': 'off' is not a number"):
        read(_xlsx(tmp_path, rows))


def test_several_segments_of_labview_are_refused(tmp_path):
    path = _lvm(tmp_path, "No")
    text = path.read_text(encoding="utf-8")
    segment = text.split("***End_of_Header***\t\n", 1)[1]
    path.write_text(text + segment, encoding="utf-8")
    with pytest.raises(RecordError, match=r"lvm: holds 2 segments; a record has one"):
        read(path)


def test_channels_of_several_files_are_looked_for_where_the_mapping_says(tmp_path):
    path = _several(tmp_path)
    mapping = tmp_path / "run.yaml"
    text = mapping.read_text(encoding="utf-8")
    for old, new, message in (
        ("acc/run.dat", "acc/none.dat", r"acc/none\.dat: no such file"),
        ("channel: 1", "channel: 2", r"acceleration\.channel: there is no channel 2; .*run\.dat"),
        ("acceleration:", "force:", r"run\.yaml: line 1: channels: needs one of .*, and at least"),
    ):
        mapping.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(RecordError, match=message):
            read(path)
