"""Files as instruments in the field write them, each made anew: read, or refused with a mapping that reads them."""

from __future__ import annotations

import contextlib
import json
import math
import warnings

import numpy as np
import pandas as pd
import pytest
import scipy.io
import yaml

from dampbalance import read_records
from dampbalance.records.coordinate import ROTATION
from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import mapping_to_start_from, read, table
from records.drafts import UNITS, filled, shown
from records.formats import uff_set, write_uff
from records.workbooks import row, xlsx

RATE = 1024.0
T = np.arange(1500) / RATE
Y = np.round(4.0 * np.cos(40.0 * T), 6)
A = np.round(1.5 * np.sin(40.0 * T) + 0.2 * np.sin(120.0 * T), 6)
G = 9.80665  # m/s²


def write(path, head, columns, delimiter=",", encoding="utf-8", end="\n"):
    """A text file of a head and rows."""
    rows = (delimiter.join(map(repr, row)) for row in np.column_stack(columns).tolist())
    path.write_bytes(end.join([*head, *rows, ""]).encode(encoding))
    return path


def same(measurement, **signals):
    """Compare what was read with signals in SI units at the times T; times in text have 17 digits."""
    assert set(measurement) == set(signals)
    for quantity, values in signals.items():
        channel = measurement[quantity]
        np.testing.assert_allclose(channel.values, values, rtol=1e-14, atol=0)
        np.testing.assert_allclose(channel.t - channel.t[0], T - T[0], rtol=0, atol=1e-9)


def proposed(path, match, **columns):
    """The measurement of a file that is refused with that message, read by the mapping proposed in it with its blanks
    filled in: what columns hold."""
    with pytest.raises(RecordError, match=match) as refused:
        read(path)
    draft = shown(refused.value)
    assert draft == yaml.safe_load(mapping_to_start_from(path))
    units = UNITS | {"acceleration": "g"}
    rate = {"sample_rate_hz": RATE} if draft.get("sample_rate_hz") == "?" else {}
    return read(path, filled(draft, columns, units=units, **rate))


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_a_logger_with_times_of_their_own_for_each_channel(tmp_path, delimiter):
    head = [
        ["Timestamp", "2026-03-01 10:00:00"] * 2,
        ["Interval", "0.0009765625"] * 2,
        ["Channel name", "Base displacement", "Channel name", "Acceleration"],
        ["Unit", "mm", "Unit", "g"],
    ]
    lines = [delimiter.join(cells) for cells in head]
    path = write(tmp_path / "run.csv", lines, [T, Y, T, A], delimiter, "utf-8-sig", "\r\n")
    same(read(path), base_displacement=1e-3 * Y, acceleration=G * A)


def oscilloscope(folder, units, names, columns):
    head = [
        "Model,SCOPE54", "Firmware Version,1.2.3", "", "Waveform Type,ANALOG", "Point Format,Y", "Horizontal Units,s",
        "Horizontal Scale,0.2", "Horizontal Delay,0", f"Sample Interval,{1 / RATE!r}", "Record Length,1500",
        "Gating,0.0% to 100.0%", "Probe Attenuation,1" + ",1" * (len(units) - 1),
        "Vertical Units," + ",".join(units), "Vertical Offset,0" + ",0" * (len(units) - 1),
        "Vertical Scale,2" + ",2" * (len(units) - 1), "", "", "Label,", ",".join(["TIME", *names]),
    ]  # fmt: skip
    return write(folder / "run.csv", head, columns)


def test_an_oscilloscope_of_one_channel_that_shows_the_unit(tmp_path):
    same(read(oscilloscope(tmp_path, ["g"], ["CH1"], [T - 0.5, A])), acceleration=G * A)


def test_an_oscilloscope_in_volts_is_refused_with_a_mapping_that_reads_it(tmp_path):
    path = oscilloscope(tmp_path, ["V", "V"], ["CH1", "CH2"], [T - 0.5, Y, A])
    measurement = proposed(
        path, "'CH1 .V.' and 'CH2 .V.' hold", base_displacement="CH1", displacement="CH2"
    )
    same(measurement, base_displacement=Y, displacement=A)  # 1 m/V


AXES = {
    "phyphox": ["Time (s)", *(f"Linear Acceleration {a} (m/s^2)" for a in "xyz"), "Absolute acceleration (m/s^2)"],
    "letters": ["time (s)", "ax (m/s^2)", "ay (m/s^2)", "az (m/s^2)", "aT (m/s^2)"],
    "with g": ["time [s]", "gFx [g]", "gFy [g]", "gFz [g]", "TgF [g]"],
    "words": ["seconds_elapsed", "z [m/s²]", "y [m/s²]", "x [m/s²]", "abs [m/s²]"],
    "plain": ["t [s]", *(f"Acceleration {a} (m/s^2)" for a in "xyz"), "Absolute (m/s^2)"],
}  # fmt: skip


@pytest.mark.parametrize("most", [0, 1, 2])
@pytest.mark.parametrize("headings", AXES.values(), ids=AXES)
def test_of_the_axes_of_a_phone_that_with_the_most_motion_is_read(tmp_path, headings, most):
    axes = [0.1 * Y, 0.05 * Y + 9.81, 0.02 * A]
    axes[most] = A
    total = np.sqrt(axes[0] ** 2 + axes[1] ** 2 + axes[2] ** 2)
    head = [",".join(f'"{name}"' for name in headings)]
    path = write(tmp_path / "run.csv", head, [T, *axes, total])
    with pytest.warns(RecordWarning, match=r"an axis that moves less than"):
        measurement = read(path)
    unit = G if "[g]" in headings[1] else 1.0
    same(measurement, acceleration=unit * A)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        same(read(path, yaml.safe_load(mapping_to_start_from(path))), acceleration=unit * A)


def test_axes_of_which_two_are_names_of_quantities_stay_what_they_are(tmp_path):
    """x and y in mm are the mass and the base."""
    path = write(tmp_path / "run.csv", ["t [s],x [mm],y [mm]"], [T, A, Y])
    same(read(path), base_displacement=1e-3 * Y, displacement=1e-3 * A)


def servo(folder, names, units, columns, interval="Sampling time interval(ms),0.9765625"):
    head = ["Number of sampling data,1500", interval, ",".join(names), ",".join(units)]
    return write(folder / "run.csv", head, columns)


def test_of_a_servo_amplifier_the_speed_is_read_and_a_torque_in_percent_named(tmp_path):
    path = servo(tmp_path, ["Motor speed", "Torque"], ["r/min", "%"], [Y, A])
    with pytest.warns(RecordWarning, match=r"not used: 'Torque \[%\]' \(a part\)"):
        measurement = read(path)
    assert measurement.coordinate == ROTATION
    same(measurement, velocity=math.pi / 30.0 * Y)


def test_what_stands_above_the_columns_gives_their_rate(tmp_path):
    path = servo(tmp_path, ["Speed", "Force"], ["mm/s", "N"], [Y, A])
    same(read(path), velocity=1e-3 * Y, force=A)
    path = servo(tmp_path, ["Speed", "Force"], ["mm/s", "N"], [Y, A], "Sampling rate [kHz],1.024")
    same(read(path), velocity=1e-3 * Y, force=A)


STRUCTS = {
    "a vector and a matrix": {"data": {"t": T, "y": np.column_stack([Y, A])}},
    "a matrix by rows": {"out": {"time": T, "values": np.vstack([Y, A])}},
    "of Simulink": {
        "out": {"time": T, "signals": {"values": np.column_stack([Y, A]), "dimensions": 2.0}}
    },
}


@pytest.mark.parametrize("held", STRUCTS.values(), ids=STRUCTS)
def test_a_matlab_struct_of_times_and_a_matrix(tmp_path, held):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, held)
    one, two = [raw.name for raw in table(path).channels if raw.name.endswith("]")]
    measurement = proposed(path, "what do the columns", base_displacement=one, displacement=two)
    same(measurement, base_displacement=1e-3 * Y, displacement=1e-3 * A)


@pytest.mark.parametrize(("names", "units"), [("names", "units"), ("labels", "Units")])
def test_a_matlab_struct_that_names_its_channels(tmp_path, names, units):
    path = tmp_path / "run.mat"
    cells = {
        names: np.array(["Base displacement", "Acceleration"], dtype=object),
        units: np.array(["mm", "g"], dtype=object),
    }
    scipy.io.savemat(path, {"data": {"t": T, "y": np.column_stack([Y, A])} | cells})
    with pytest.warns(RecordWarning, match="'data.t' has no unit: it is taken to be in seconds"):
        same(read(path), base_displacement=1e-3 * Y, acceleration=G * A)


def test_signals_of_simulink_are_called_by_their_labels(tmp_path):
    signals = [
        {"values": values[:, None], "dimensions": 1.0, "label": label, "blockName": "model/Scope"}
        for label, values in (("base displacement (mm)", Y), ("acceleration [g]", A))
    ]
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"out": {"time": T[:, None], "signals": signals}})
    with pytest.warns(RecordWarning, match="'out.time' has no unit: it is taken to be in seconds"):
        same(read(path), base_displacement=1e-3 * Y, acceleration=G * A)


def blanks(text):
    """Blanks after the last number of the data."""
    lines = text.split(b"\n")
    ends = [i for i, line in enumerate(lines) if line.strip() == b"-1"][1::2]
    for end in ends:
        lines[end - 1] = lines[end - 1].ljust(80)
    return b"\n".join(lines)


UNIVERSAL = {
    "blanks after the last number": blanks,
    "CRLF": lambda text: text.replace(b"\n", b"\r\n"),
    "CRLF before -1": lambda text: text.replace(b"\n    -1", b"\r\n    -1"),
    "a head in Latin-1": lambda text: text.replace(b"rig 3", "Prüfstand µ²".encode("latin-1")),
    "blank lines at its end": lambda text: text + b"\n\n",
    "blanks after -1": lambda text: text.replace(b"    -1\n", b"    -1   \n"),
}


@pytest.mark.parametrize("change", UNIVERSAL.values(), ids=UNIVERSAL)
@pytest.mark.parametrize("even", [1, 0])
@pytest.mark.parametrize("binary", [0, 1])
def test_universal_files_as_programs_write_them(tmp_path, change, even, binary):
    if binary and change in (blanks, UNIVERSAL["CRLF"], UNIVERSAL["blanks after -1"]):
        pytest.skip("binary data have no lines")
    sets = [
        uff_set(T, name, values) | {"binary": binary, "abscissa_spacing": even, "id2": "rig 3", "id4": f"{name}"}
        for name, values in (("base_displacement_m", 1e-3 * Y), ("acceleration_m_per_s2", A))
    ]  # fmt: skip
    path = tmp_path / "run.uff"
    write_uff(path, sets)
    path.write_bytes(change(path.read_bytes()))
    measurement = read(path)
    assert set(measurement) == {"base_displacement", "acceleration"}
    np.testing.assert_allclose(measurement["acceleration"].values, A, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("binary", [0, 1])
def test_units_and_names_in_latin_1_of_a_universal_file(tmp_path, binary):
    sets = [
        uff_set(T, "base_displacement_m", 4.0 * Y) | {"ordinate_axis_units_lab": "?m"},
        uff_set(T, "acceleration_m_per_s2", A) | {"id1": "acceleration Pr?fstand"},
    ]
    path = tmp_path / "run.uff"
    write_uff(path, [one | {"binary": binary, "abscissa_spacing": 1} for one in sets])
    text = path.read_bytes().replace(b"?m", b"\xb5m").replace(b"Pr?f", b"Pr\xfcf")
    path.write_bytes(text)
    opened = table(path)
    assert [raw.unit for raw in opened.channels] == ["µm", "m/s2"]
    assert "Prüfstand" in opened.channels[1].name


@pytest.mark.parametrize(
    ("headings", "chosen"),
    [
        (["speed", "ch2"], {"velocity": Y}),
        (["torque", "displacement"], {"displacement": A}),
        (["friction", "displacement"], {"force": Y, "displacement": A}),
        (["displacement", "friction"], {"force": A, "displacement": Y}),
        (["Friction force", "Motor speed"], {"force": Y, "velocity": A}),
        (["Reibkraft", "Geschwindigkeit"], {"force": Y, "velocity": A}),
    ],
)
def test_a_name_decides_before_the_order_of_columns(tmp_path, headings, chosen):
    """Whatever is proposed for columns without units: speed moves, friction is a force, and nothing is the base."""
    path = write(tmp_path / "run.csv", [",".join(["t [s]", *headings])], [T, Y, A])
    rules = yaml.safe_load(mapping_to_start_from(path))
    held = {rule["channel"]: q for q, rule in rules["channels"].items()}
    for q, values in chosen.items():
        assert held[headings[0 if values is Y else 1]] == q
    assert not any(q.startswith("base") for q in held.values())


COLUMNS = {"time_s": T, "base_displacement_mm": Y, "acceleration_g": A}


def structured():
    held = np.empty(T.size, dtype=[(name, float) for name in COLUMNS])
    for name, values in COLUMNS.items():
        held[name] = values
    return held


def lists():
    return {name: values.tolist() for name, values in COLUMNS.items()}


PYTHON = {
    "columns.json": lambda path: path.write_text(json.dumps(lists())),
    "rate.json": lambda path: path.write_text(
        json.dumps({"sample_rate_hz": RATE} | {k: v for k, v in lists().items() if k != "time_s"})
    ),
    "rows.json": lambda path: path.write_text(
        json.dumps([dict(zip(COLUMNS, row, strict=True)) for row in zip(*lists().values(), strict=True)])
    ),
    "arrays.npz": lambda path: np.savez(path, **COLUMNS),
    "compressed.npz": lambda path: np.savez_compressed(path, base_displacement_mm=Y, acceleration_g=A, fs=RATE),
    "one.npz": lambda path: np.savez(path, record=structured()),
    "structured.npy": lambda path: np.save(path, structured()),
}  # fmt: skip


@pytest.mark.parametrize("name", PYTHON)
def test_files_of_python(tmp_path, name):
    PYTHON[name](tmp_path / name)
    same(read(tmp_path / name), base_displacement=1e-3 * Y, acceleration=G * A)
    (record,) = read_records(tmp_path / name)
    assert set(record.quantities) == {"base_displacement", "acceleration"}


@pytest.mark.parametrize("turned", [False, True])
def test_a_plain_array_is_refused_with_a_mapping_that_reads_it(tmp_path, turned):
    table = np.column_stack([T, Y, A])
    np.save(tmp_path / "run.npy", table.T if turned else table)
    columns = {"base_displacement": "column[2]", "displacement": "column[3]"}
    measurement = proposed(tmp_path / "run.npy", "what do the columns", **columns)
    same(measurement, base_displacement=1e-3 * Y, displacement=1e-3 * A)
    (record,) = read_records(
        table.T if turned else table,
        mapping={
            "channels": {
                "base_displacement": {"channel": 2, "unit": "mm"},
                "acceleration": {"channel": 3, "unit": "g"},
            },
            "time": {"channel": 1, "unit": "s"},
        },
    )
    same(record, base_displacement=1e-3 * Y, acceleration=G * A)


class Hostile:
    """An object whose pickle makes a file when it is loaded."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return open, (str(self.mark), "w")


def test_no_pickle_is_loaded(tmp_path):
    mark = tmp_path / "mark"
    objects = np.array([Hostile(mark), 1.0], dtype=object)
    np.save(tmp_path / "run.npy", objects)
    np.savez(tmp_path / "run.npz", objects)
    for name in ("run.npy", "run.npz"):
        with pytest.raises(RecordError, match="holds Python objects alone"):
            read(tmp_path / name)
    np.savez(tmp_path / "run.npz", notes=objects, **COLUMNS)
    same(read(tmp_path / "run.npz"), base_displacement=1e-3 * Y, acceleration=G * A)
    assert not mark.exists()


FRAME = pd.DataFrame(COLUMNS)


@pytest.mark.parametrize("orient", ["columns", "records", "split", "index"])
def test_json_of_pandas(tmp_path, orient):
    held = FRAME.T.to_json(double_precision=15) if orient == "index" else None
    text = held or FRAME.to_json(orient=orient, double_precision=15)
    (tmp_path / "run.json").write_text(text, encoding="utf-8")
    if orient == "index":  # a name for each sample
        with pytest.raises(RecordError, match="'0'"):
            read(tmp_path / "run.json")
    else:
        same(read(tmp_path / "run.json"), base_displacement=1e-3 * Y, acceleration=G * A)


def test_json_of_rows_without_names_and_of_points_in_time(tmp_path):
    rows = np.column_stack([T, Y, A]).tolist()
    path = tmp_path / "run.json"
    path.write_text(json.dumps(rows), encoding="utf-8")
    columns = {"base_displacement": "column[2]", "displacement": "column[3]"}
    measurement = proposed(path, "what do the columns", **columns)
    same(measurement, base_displacement=1e-3 * Y, displacement=1e-3 * A)
    points = pd.Timestamp("2026-03-01T12:00:00Z") + pd.to_timedelta(np.round(T * 1e9), unit="ns")
    stamped = lists() | {"time_s": [point.isoformat() for point in points], "notes": "rig 3"}
    path.write_text(json.dumps(stamped), encoding="utf-8")
    same(read(path), base_displacement=1e-3 * Y, acceleration=G * A)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"time_s": [0, 1', "cannot be read as JSON"),
        ("[" * 100_000, "cannot be read as JSON"),
        ("3.0", "neither columns nor rows"),
        ('{"time_s": [0, 1, 2, 3], "y_mm": [0, 1, "a", 2], "x_mm": [1, 2, 0, 1]}', "holds texts"),
        ('{"time_s": [0, 1, 2, 3], "y_mm": [0, 1, null, 2], "x_mm": [1, 2, 0, 1]}', r"\(NaN\)"),
        ('{"time_s": [0, 1, 2, 3], "y_mm": [0, 1, 2], "x_mm": [1, 2, 0, 1]}', "'y' has 3, "),
        ("{}", "finds no response"),
        ("[]", "finds no response"),
        ("[1e400, 2]", "finds no response"),
    ],
)
def test_json_that_holds_no_record(tmp_path, text, message):
    path = tmp_path / "run.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError, match=message):
        read(path)


def test_a_logger_that_counts_samples(tmp_path):
    """Whole numbers from sample to sample are no times where the head gives another interval."""
    head = ["Interval,0.0009765625", "Channel name,Base displacement,Acceleration", "Unit,mm,g"]
    path = write(tmp_path / "run.csv", head, [np.arange(1500.0), Y, A])
    with pytest.warns(RecordWarning, match="not used: 'sample 1'"):
        measurement = read(path)
    same(measurement, base_displacement=1e-3 * Y, acceleration=G * A)


def test_a_column_that_counts_below_the_word_channel_is_no_time(tmp_path):
    head = ["Channel,Base displacement,Acceleration", "Unit,mm,g"]
    path = write(tmp_path / "run.csv", head, [np.arange(1500.0), Y, A])
    columns = {"base_displacement": 1e-3 * Y, "acceleration": G * A}
    same(proposed(path, "at which rate was it sampled"), **columns)
    path = write(tmp_path / "run.csv", ["Interval,0.9765625", *head], [np.arange(1500.0), Y, A])
    proposed(path, "at which rate was it sampled")  # of no unit: it may be in ms


def test_a_sheet_of_a_logger(tmp_path):
    head = [
        ["Interval", 1 / RATE],
        ["Channel name", "Base displacement", "Acceleration"],
        ["Unit", "mm", "g"],
    ]
    for times in (T, np.arange(1500.0)):
        rows = [row(cells) for cells in (*head, *np.column_stack([times, Y, A]).tolist())]
        xlsx(tmp_path / "run.xlsx", rows)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", ".*channels not used: 'sample 1'")
            same(read(tmp_path / "run.xlsx"), base_displacement=1e-3 * Y, acceleration=G * A)


def test_a_table_is_a_record(tmp_path):
    """A file is loaded once, also where names do not suffice."""
    path = tmp_path / "run.csv"
    FRAME.rename(columns={"acceleration_g": "payload [g]"}).to_csv(path, index=False)
    opened = table(path)
    (record,) = read_records(opened)
    path.unlink()  # nothing is left to be read
    (record,) = read_records(opened)
    same(record, base_displacement=1e-3 * Y, acceleration=G * A)
    assert record.name == str(path)


@pytest.mark.parametrize("name", PYTHON)
def test_damaged_files_of_python_are_read_or_refused(tmp_path, name):
    path = tmp_path / name
    PYTHON[name](path)
    whole = path.read_bytes()
    for part in (0.02, 0.3, 0.6, 0.9, 0.99):
        path.write_bytes(whole[: int(part * len(whole))])
        with pytest.raises(RecordError):
            read(path)
    random = np.random.default_rng(5)
    for _ in range(30):
        damaged = bytearray(whole)
        for at in random.integers(0, min(len(whole), 400), 3):
            damaged[at] = random.integers(256)
        path.write_bytes(damaged)
        with warnings.catch_warnings(), contextlib.suppress(RecordError):
            warnings.simplefilter("ignore", RecordWarning)
            read(path)
