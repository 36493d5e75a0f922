"""Files as instruments in the field write them, each made anew: read, or refused with a mapping that reads them."""

from __future__ import annotations

import json
import math

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


def oscilloscope(folder, units, names, columns):
    head = [
        "Model,SCOPE54", "Firmware Version,1.2.3", "", "Waveform Type,ANALOG", "Point Format,Y", "Horizontal Units,s",
        "Horizontal Scale,0.2", "Horizontal Delay,0", f"Sample Interval,{1 / RATE!r}", "Record Length,1500",
        "Gating,0.0% to 100.0%", "Probe Attenuation,1" + ",1" * (len(units) - 1),
        "Vertical Units," + ",".join(units), "Vertical Offset,0" + ",0" * (len(units) - 1),
        "Vertical Scale,2" + ",2" * (len(units) - 1), "", "", "Label,", ",".join(["TIME", *names]),
    ]  # fmt: skip
    return write(folder / "run.csv", head, columns)


def servo(folder, names, units, interval="Sampling time interval(ms),0.9765625"):
    head = ["Number of sampling data,1500", interval, ",".join(names), ",".join(units)]
    return write(folder / "run.csv", head, [Y, A])


def logger(folder, delimiter=",", times=(T, T), interval="0.0009765625"):
    """A file with times of their own for each channel."""
    head = [["Timestamp", "2026-03-01 10:00:00"] * 2, ["Interval", interval] * 2]
    head += [["Channel name", "Base displacement", "Channel name", "Acceleration"]]
    lines = [delimiter.join(cells) for cells in [*head, ["Unit", "mm", "Unit", "g"]]]
    columns = [times[0], Y, times[1], A]
    return write(folder / "run.csv", lines, columns, delimiter, "utf-8-sig", "\r\n")


def counter(folder, *head):
    """A file whose first column counts samples."""
    columns = [np.arange(1500.0), Y, A]
    names = "Channel name" if head else "Channel"
    head = [*head, f"{names},Base displacement,Acceleration", "Unit,mm,g"]
    return write(folder / "run.csv", head, columns)


BOTH = {"base_displacement": 1e-3 * Y, "acceleration": G * A}
SPEED = {"velocity": 1e-3 * Y, "force": A}
READ = {
    "a logger": (lambda at: logger(at), BOTH),
    "a logger, semicolons": (lambda at: logger(at, ";"), BOTH),
    "a logger that counts samples": (lambda at: counter(at, "Interval,0.0009765625"), BOTH),
    "an oscilloscope that shows the unit": (
        lambda at: oscilloscope(at, ["g"], ["CH1"], [T - 0.5, A]),
        {"acceleration": G * A},
    ),
    "an interval in ms above the columns": (
        lambda at: servo(at, ["Speed", "Force"], ["mm/s", "N"]),
        SPEED,
    ),
    "a rate in kHz above the columns": (
        lambda at: servo(at, ["Speed", "Force"], ["mm/s", "N"], "Sampling rate [kHz],1.024"),
        SPEED,
    ),
    "the names x and y of mass and base": (
        lambda at: write(at / "run.csv", ["t [s],x [mm],y [mm]"], [T, A, Y]),
        {"base_displacement": 1e-3 * Y, "displacement": 1e-3 * A},
    ),
}


@pytest.mark.filterwarnings("ignore:.*channels not used. 'sample 1'")
@pytest.mark.parametrize("name", READ)
def test_a_file_of_an_instrument_is_read(tmp_path, name):
    make, held = READ[name]
    same(read(make(tmp_path)), **held)


def test_an_oscilloscope_in_volts_is_refused_with_a_mapping_that_reads_it(tmp_path):
    path = oscilloscope(tmp_path, ["V", "V"], ["CH1", "CH2"], [T - 0.5, Y, A])
    columns = {"base_displacement": "CH1", "displacement": "CH2"}
    measurement = proposed(path, "'CH1 .V.' and 'CH2 .V.' hold", **columns)
    same(measurement, base_displacement=Y, displacement=A)  # 1 m/V


def test_a_column_that_counts_below_the_word_channel_is_no_time(tmp_path):
    same(proposed(counter(tmp_path), "at which rate was it sampled"), **BOTH)
    # an interval of no unit may be in ms
    proposed(counter(tmp_path, "Interval,0.9765625"), "at which rate was it sampled")


AXES = {
    "phyphox": ["Time (s)", *(f"Linear Acceleration {a} (m/s^2)" for a in "xyz"), "Absolute acceleration (m/s^2)"],
    "letters": ["time (s)", "ax (m/s^2)", "ay (m/s^2)", "az (m/s^2)", "aT (m/s^2)"],
    "with g": ["time [s]", "gFx [g]", "gFy [g]", "gFz [g]", "TgF [g]"],
    "words": ["seconds_elapsed", "z [m/s²]", "y [m/s²]", "x [m/s²]", "abs [m/s²]"],
    "plain": ["t [s]", *(f"Acceleration {a} (m/s^2)" for a in "xyz"), "Absolute (m/s^2)"],
}  # fmt: skip


@pytest.mark.parametrize(("kind", "most"), [*zip(AXES, (0, 1, 2, 0, 1), strict=True)])
def test_of_the_axes_of_a_phone_that_with_the_most_motion_is_read(tmp_path, kind, most):
    headings, axes = AXES[kind], [0.1 * Y, 0.05 * Y + 9.81, 0.02 * A]
    axes[most] = A
    total = np.sqrt(axes[0] ** 2 + axes[1] ** 2 + axes[2] ** 2)
    head = [",".join(f'"{name}"' for name in headings)]
    path = write(tmp_path / "run.csv", head, [T, *axes, total])
    with pytest.warns(RecordWarning, match=r"an axis that moves less than"):
        measurement = read(path)
    unit = G if "[g]" in headings[1] else 1.0
    same(measurement, acceleration=unit * A)
    same(read(path, yaml.safe_load(mapping_to_start_from(path))), acceleration=unit * A)


def test_of_a_servo_amplifier_the_speed_is_read_and_a_torque_in_percent_named(tmp_path):
    path = servo(tmp_path, ["Motor speed", "Torque"], ["r/min", "%"])
    with pytest.warns(RecordWarning, match=r"not used: 'Torque \[%\]' \(a part\)"):
        measurement = read(path)
    assert measurement.coordinate == ROTATION
    same(measurement, velocity=math.pi / 30.0 * Y)


STRUCTS = {
    "a vector and a matrix": {"data": {"t": T, "y": np.column_stack([Y, A])}},
    "a matrix by rows": {"out": {"time": T, "values": np.vstack([Y, A])}},
}


@pytest.mark.parametrize("held", STRUCTS.values(), ids=STRUCTS)
def test_a_matlab_struct_of_times_and_a_matrix(tmp_path, held):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, held)
    one, two = [raw.name for raw in table(path).channels if raw.name.endswith("]")]
    measurement = proposed(path, "what do the columns", base_displacement=one, displacement=two)
    same(measurement, base_displacement=1e-3 * Y, displacement=1e-3 * A)


LABELS = ("Base displacement (mm)", "Acceleration [g]")
NAMED = {
    "labels": {"t": T, "y": np.column_stack([Y, A]), "labels": np.array(LABELS, dtype=object)},
    "names and units": {"t": T, "y": np.column_stack([Y, A])}
    | {"names": np.array(["Base displacement", "Acceleration"], dtype=object)}
    | {"Units": np.array(["mm", "g"], dtype=object)},
    "signals of Simulink": {"time": T[:, None]}
    | {"signals": [{"values": v[:, None], "label": of} for v, of in zip((Y, A), LABELS, strict=True)]},
}  # fmt: skip


@pytest.mark.parametrize("held", NAMED.values(), ids=NAMED)
def test_a_matlab_struct_that_names_its_channels(tmp_path, held):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"data": held})
    with pytest.warns(RecordWarning, match="has no unit: it is taken to be in seconds"):
        same(read(path), **BOTH)


def blanks(text):
    """Blanks after the last number of the data."""
    lines = text.split(b"\n")
    ends = [i for i, line in enumerate(lines) if line.strip() == b"-1"][1::2]
    for end in ends:
        lines[end - 1] = lines[end - 1].ljust(80)
    return b"\n".join(lines)


UNIVERSAL = {
    "blanks after the last number": (0, blanks),
    "CRLF": (0, lambda text: text.replace(b"\n", b"\r\n")),
    "CRLF before -1": (1, lambda text: text.replace(b"\n    -1", b"\r\n    -1")),
    "blank lines at its end": (1, lambda text: text + b"\n\n"),
    "blanks after -1": (0, lambda text: text.replace(b"    -1\n", b"    -1   \n")),
}


@pytest.mark.parametrize("kind", UNIVERSAL)
@pytest.mark.parametrize("even", [1, 0])
def test_universal_files_as_programs_write_them(tmp_path, kind, even):
    path, (binary, change) = tmp_path / "run.uff", UNIVERSAL[kind]
    more = {"binary": binary, "abscissa_spacing": even, "id2": "rig 3"}
    columns = {"base_displacement_m": 1e-3 * Y, "acceleration_m_per_s2": A}
    write_uff(path, [uff_set(T, name, of) | more | {"id4": name} for name, of in columns.items()])
    path.write_bytes(change(path.read_bytes()))
    measurement = read(path)
    assert set(measurement) == {*BOTH}
    # six digits in text
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


COLUMNS = {"time_s": T, "base_displacement_mm": Y, "acceleration_g": A}


def structured():
    held = np.empty(T.size, dtype=[(name, float) for name in COLUMNS])
    for name, values in COLUMNS.items():
        held[name] = values
    return held


def lists():
    return {name: values.tolist() for name, values in COLUMNS.items()}


FRAME = pd.DataFrame(COLUMNS)
RATED = {"sample_rate_hz": RATE} | {k: v for k, v in lists().items() if k != "time_s"}
POINTS = pd.Timestamp("2026-03-01T12:00:00Z") + pd.to_timedelta(np.round(T * 1e9), unit="ns")
STAMPED = {"time_s": [one.isoformat() for one in POINTS], "notes": "rig 3"}
PYTHON = {
    "columns.json": lambda path: path.write_text(json.dumps(lists())),
    "rate.json": lambda path: path.write_text(json.dumps(RATED)),
    "points.json": lambda path: path.write_text(json.dumps(lists() | STAMPED)),
    "table.json": lambda path: FRAME.to_json(path, double_precision=15),
    "rows.json": lambda path: FRAME.to_json(path, orient="records", double_precision=15),
    "split.json": lambda path: FRAME.to_json(path, orient="split", double_precision=15),
    "compressed.npz": lambda path: np.savez_compressed(path, base_displacement_mm=Y, acceleration_g=A, fs=RATE),
    "one.npz": lambda path: np.savez(path, record=structured()),
    "structured.npy": lambda path: np.save(path, structured()),
}  # fmt: skip


@pytest.mark.parametrize("name", PYTHON)
def test_files_of_python(tmp_path, name):
    PYTHON[name](tmp_path / name)
    same(read(tmp_path / name), **BOTH)


@pytest.mark.parametrize("kind", ["npy", "turned npy", "json"])
def test_a_plain_array_is_refused_with_a_mapping_that_reads_it(tmp_path, kind):
    held = np.column_stack([T, Y, A])
    path = tmp_path / f"run.{kind.split()[-1]}"
    if kind == "json":
        path.write_text(json.dumps(held.tolist()), encoding="utf-8")
    else:
        np.save(path, held.T if "turned" in kind else held)
    columns = {"base_displacement": "column[2]", "displacement": "column[3]"}
    measurement = proposed(path, "what do the columns", **columns)
    same(measurement, base_displacement=1e-3 * Y, displacement=1e-3 * A)


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
    same(read(tmp_path / "run.npz"), **BOTH)
    assert not mark.exists()


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
        ("[1e400, 2]", "finds no response"),
        ('{"time_s": {"0": 0.0, "1": 0.1}, "x_m": {"0": 1.0}}', "finds no response"),
    ],
)
def test_json_that_holds_no_record(tmp_path, text, message):
    path = tmp_path / "run.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError, match=message):
        read(path)


def test_an_open_table_is_a_record_and_loaded_once(tmp_path):
    path = tmp_path / "run.csv"
    FRAME.rename(columns={"acceleration_g": "payload [g]"}).to_csv(path, index=False)
    opened = table(path)
    read_records(opened)
    path.unlink()  # nothing is left to be read
    (record,) = read_records(opened)
    same(record, **BOTH)
    assert record.name == str(path)
