"""What columns hold that names and units leave open, as samples show it; and that nothing is ever invented.

The truth is a decay in closed form, x = X e^{−δt} cos ωt, with its derivatives, and a steady motion of two bodies.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from dampbalance import read_records
from dampbalance.commands.main import main
from dampbalance.records.channel import EXCITATIONS, RESPONSES
from dampbalance.records.coordinate import ROTATION
from dampbalance.records.errors import RecordError
from records.drafts import shown

RANDOM = np.random.default_rng(590)
T = np.arange(2400) / 200.0
W, D = 2.0 * np.pi * 1.7, 0.3
ROOT = 0.2 * np.exp((1j * W - D) * T)
X, V, A = (np.real((1j * W - D) ** n * ROOT) for n in range(3))
NOISE = RANDOM.standard_normal((4, T.size))
BLOWS = np.where(np.arange(T.size) < 5, 40.0, 0.0)
HUM = np.sin(2.0 * np.pi * 50.03 * T)
DEG = np.degrees(1.0)

DECAYS = {
    "an empty column": ({"x (m)": X, "aux": np.full(T.size, np.nan)}, {"displacement": X}),
    "a constant": ({"battery": 0.0 * T + 3.7, "x (m)": X}, {"displacement": X}),
    "noise": ({"ch2": 30.189 + 6e-4 * NOISE[0], "pos (cm)": 100.0 * X}, {"displacement": X}),
    "noise in mm": ({"ch1 [mm]": NOISE[0], "ch2 [mm]": 1e3 * X}, {"displacement": X}),
    "thermocouples": ({"T1": 0.1 * T - 0.001 * T**2, "T2 (°C)": T, "x (m)": X}, {"displacement": X}),
    "hum": ({"AI3": HUM, "Position (m)": X}, {"displacement": X}),
    "a hammer": ({"in1": BLOWS + 0.01 * NOISE[0], "weg (mm)": 1e3 * X}, {"displacement": X}),
    "a hammer in volts": ({"Hammer (V)": BLOWS, "acc (m/s²)": A}, {"acceleration": A}),
    "a number in the name": ({"velocity_5 (m/s)": V}, {"velocity": V}),
    "x, v and a": (
        {"Latest: Position (m)": X, "Latest: Velocity (m/s)": V, "Latest: Acceleration (m/s²)": A},
        {"displacement": X, "velocity": V, "acceleration": A},
    ),
    "x, v and a without names": (
        {"s1 [mm]": 1e3 * X, "s2 [mm/s]": 1e3 * V, "s3 [m/s²]": A},
        {"displacement": X, "velocity": V, "acceleration": A},
    ),
    "x and y of a bob": (
        {"x (m)": np.sin(X), "y (m)": -np.cos(X)},
        {"displacement": np.sin(X)},
    ),
    "axes of a gyroscope": (
        {"gx (rad/s)": 0.01 * NOISE[0], "gy (rad/s)": 0.01 * NOISE[1], "gz (rad/s)": V},
        {"velocity": V},
    ),
    "two axes": ({"acc x (m/s²)": A, "acc y (m/s²)": 0.2 * NOISE[0]}, {"acceleration": A}),
    "a marker": (
        {"X (mm)": 812.0 + NOISE[0], "Y (mm)": 1e3 * X, "Z (mm)": NOISE[1]},
        {"displacement": X},
    ),
    "an axis": ({"x (m/s²)": A}, {"acceleration": A}),
    "an angle and its rate": ({"theta": X, "omega": V}, {"displacement": X, "velocity": V}),
    "an angle in degrees": ({"roll": 45.0 + DEG * X}, {"displacement": np.pi / 4.0 + X}),
    "an angle by its rate": (
        {"pitch": DEG * X / 4.0, "pitch rate": HUM, "angular velocity (deg/s)": DEG * V / 4.0},
        {"displacement": X / 4.0, "velocity": V / 4.0},
    ),
    "a rate by its angle": (
        {"Winkelgeschwindigkeit": DEG * V, "Winkel": DEG * X},
        {"velocity": V, "displacement": X},
    ),
    "mm/s² by gravity": (
        {"accel_x": 1e3 * A, "accel_y": 20.0 * NOISE[0], "accel_z": 9810.0 + 20.0 * NOISE[1]},
        {"acceleration": A},
    ),
    "g by gravity": (
        {"ax": A / 9.80665, "ay": 0.002 * NOISE[0], "az": 1.0 + 0.002 * NOISE[1]},
        {"acceleration": A},
    ),
    "m/s² by gravity": ({"Acc Z": 9.78 + A}, {"acceleration": 9.78 + A}),
}  # fmt: skip


def test_an_offset_of_about_one_of_a_single_axis_is_no_gravity():
    with pytest.raises(RecordError, match="in which unit is 'acc'"):
        read_records({"time (s)": T, "acc": 1.0 + A})


@pytest.mark.parametrize("name", DECAYS)
def test_a_decay_is_read_at_once(name):
    columns, truth = DECAYS[name]
    (record,) = read_records({"time (s)": T, **columns})
    assert not record.driven
    assert {*record.quantities} == {*truth}
    for q, values in truth.items():
        np.testing.assert_allclose(record[q].values, values, rtol=3e-3, atol=1e-12)


def test_the_angle_of_a_tracked_bob_is_its_motion():
    (record,) = read_records({"t": T, "x": np.sin(X), "y": 1.0 - np.cos(X), "θ": X})
    assert record.coordinate == ROTATION
    np.testing.assert_array_equal(record["displacement"].values, X)


STEADY = [np.sin(9.0 * T + 0.5 * n) + 0.1 * n * np.sin(27.0 * T + n) for n in range(5)]
NAMES = [
    "ch1",
    "AI 2",
    "dist",
    "velocity_5",
    "aux",
    "signal",
    "Sensor B",
    "column 7",
    "laser",
    "acc",
]
UNITS = ["", " [mm]", " (V)", " [m/s²]", " (mm/s)", " [g]"]


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("seed", range(40))
def test_no_drive_no_unit_and_no_rate_is_invented(seed, free):
    """Columns that move, under names and units of which none names a drive."""
    random = np.random.default_rng((59, seed))
    count, times = random.integers(1, 5), random.random() < 0.8
    heads = [a + random.choice(UNITS) for a in random.choice(NAMES, count, replace=False)]
    columns = {"time_s": T} if times else {}
    columns |= dict(zip(heads, STEADY[:count], strict=True))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            (record,) = read_records(columns, free=free)
        except RecordError as error:
            message, draft = str(error), shown(error)
        else:
            assert times
            assert not record.driven
            assert any("[" in head or "(" in head for head in heads)
            return
    assert not (free and ("--kind" in message or "base_" in message))
    held = draft.get("channels", {})
    assert not {*held} & {*EXCITATIONS}
    for rule in held.values():
        head = next(
            h
            for i, h in enumerate(columns, 1)
            if rule["channel"] in (h.split(" [")[0].split(" (")[0], i)
        )
        assert rule["unit"] == "?" or rule.get("scale") == "?" or rule["unit"] in head
        assert rule.get("scale", "?") == "?"
    assert ("sample_rate_hz" in draft) == (not times)
    assert draft.get("sample_rate_hz", "?") == "?"
    with pytest.raises(RecordError, match="is not allowed"):
        read_records(columns, mapping=draft)


@pytest.mark.parametrize(
    ("drive", "response", "held"),
    [
        ("force (N)", "s2 [mm]", {"force", "displacement"}),
        ("load cell [kN]", "dist/mm", {"force", "displacement"}),
        ("Kraft [N]", "Weg [mm]", {"force", "displacement"}),
        ("F (N)", "pos (m)", {"force", "displacement"}),
        ("y [mm]", "x [mm]", {"base_displacement", "displacement"}),
        ("table 2 [mm]", "laser 1 [mm]", {"base_displacement", "displacement"}),
    ],
)
def test_what_a_name_or_a_unit_calls_a_drive_drives(drive, response, held):
    columns = {"time_s": T, drive: STEADY[0], response: STEADY[2], "ch7": NOISE[0]}
    (record,) = read_records(columns)
    assert {*record.quantities} == held


RUN_DOWN = np.cumsum(2.5 * np.clip(1.0 - T / 11.0, 0.0, None)) / 200.0


@pytest.mark.parametrize("name", ["ch0", "AI3 [mm]", "y (mm)", "AI1 (m/s²)"])
@pytest.mark.parametrize("until", [4.0, 12.0])
def test_a_drive_that_dies_with_its_response_is_not_lost(name, until):
    """A run-down through resonance, to rest or stopped before."""
    drive = np.where(until > T, np.sin(2.0 * np.pi * RUN_DOWN), 0.0)
    response = np.convolve(drive, ROOT.imag)[: T.size]
    with pytest.raises(RecordError, match=r"hold: .*base_"):
        read_records({"time_s": T, name: drive, "x (mm)": response})


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("x2 (mm)", 400.0 * X),
        ("velocity (m/s)", 3.6 * V),
        ("acc (g)", 0.4 * A),
        ("acc (m/s²)", np.roll(A, 20)),  # of a table
    ],
)
def test_a_motion_that_contradicts_another_is_asked_for(name, values):
    """As that of a second body, or in a wrong unit."""
    with pytest.raises(RecordError, match=r"(does|do) the column"):
        read_records({"time_s": T, name: values, "displacement (mm)": 1e3 * X})


def test_the_acceleration_of_a_table_is_not_that_of_the_mass():
    """In a steady motion that nothing names the drive of."""
    x, table = np.sin(9.0 * T), np.sin(9.0 * T + 1.5)
    with pytest.raises(RecordError, match="does the column 'acceleration"):
        read_records({"time_s": T, "acceleration (m/s²)": table, "displacement (m)": x})


def test_readings_of_one_velocity_are_one(tmp_path):
    """As of a damper with three estimates of its velocity: the loops of force and displacement."""
    x, v = np.sin(9.0 * T), 9.0 * np.cos(9.0 * T)
    force = 100.0 * np.tanh(5.0 * v) + 20.0 * v
    columns = {"time (s)": T, "displacement (m)": x, "force (N)": force}
    columns |= {f"velocity {n} (m/s)": np.roll(v, n) for n in range(3)}
    (record,) = read_records(columns)
    assert {*record.quantities} == {"force", "displacement", "velocity"}
    np.testing.assert_array_equal(record["velocity"].values, v)


@pytest.mark.parametrize("step", [0.05, 0.004, 1e-5])
def test_times_in_parts_of_one_are_seconds(step):
    (record,) = read_records({"time": step * np.arange(T.size), "x (m)": X})
    assert record["displacement"].t[-1] == pytest.approx(step * (T.size - 1))


@pytest.mark.parametrize("degrees", [10.0, 25.0, 45.0])
def test_a_motion_between_two_axes_is_not_that_of_one(degrees):
    x, z = np.cos(np.radians(degrees)) * A, 9.81 - np.sin(np.radians(degrees)) * A
    columns = {"time_s": T, "ax (m/s²)": x, "ay (m/s²)": 0.05 * NOISE[0], "az (m/s²)": z}
    if degrees < 15.0:
        (record,) = read_records(columns)
        assert np.std(record["acceleration"].values) == pytest.approx(np.std(A), rel=0.02)
    else:
        with pytest.raises(RecordError, match=f"scale: {np.std(A) / np.std(x):.3g}"):
            read_records(columns)


@pytest.mark.parametrize("step", [5.0, 0.5, 1.6, 0.01 / 3600.0, 0.01 / 86400.0])
def test_times_that_no_recorder_has_in_seconds_are_asked_for(step):
    """ms, whole or in halves, hours, and days of a spreadsheet."""
    with pytest.raises(RecordError, match="in which unit is 'time'"):
        read_records({"time": 3.0 + step * np.arange(T.size), "x (m)": X})


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("angle", DEG * X / 5.0),  # 2.3 degrees, or a turn and a half
        ("roll", 40.0 + DEG * X / 5.0),
        ("theta", np.rint(4096.0 / (2.0 * np.pi) * X)),  # ticks of an encoder
        ("phi", 4.0 * np.pi + X),
        ("omega", V),
        ("Winkelgeschwindigkeit", DEG * V),
    ],
)
def test_a_rotation_in_degrees_or_radians_is_asked_for(name, values):
    with pytest.raises(RecordError, match=f"in which unit is '{name}'"):
        read_records({"time_s": T, name: values})


def test_a_clock_with_a_unit_goes_before_one_without():
    (record,) = read_records({"time": 10.0 * T, "elapsed (s)": T, "x (m)": X})
    np.testing.assert_allclose(record["displacement"].t, T, atol=1e-12)


def test_an_angle_and_its_rate_without_units_rotate():
    with pytest.raises(RecordError, match="in which units are 'theta' and 'omega'"):
        read_records({"time_s": T, "theta": DEG * X / 5.0, "omega": DEG * V / 5.0})


@pytest.mark.parametrize("empty", ["", ","])
def test_runs_side_by_side_are_records(tmp_path, empty):
    path, lines = tmp_path / "runs.csv", [f"Time (s),Position (m),{empty}Time (s),Position (m)"]
    short = T.size - 300
    for i, (t, x) in enumerate(zip(T, X, strict=True)):
        lines.append(f"{t},{x},{empty}" + (f"{t},{2.0 * x}" if i < short else ","))
    path.write_text("\n".join(lines), encoding="utf-8")
    records = read_records(path)
    assert [record.name for record in records] == [f"{path} (run {n})" for n in (1, 2)]
    np.testing.assert_array_equal(records[0]["displacement"].values, X)
    np.testing.assert_array_equal(records[1]["displacement"].values, 2.0 * X[:short])
    assert all(one.files["sha256"] == records[0].files["sha256"] for one in records)


HZ = 2.5 * np.arange(1, 500)
H = 1.0 / (1.0 - (HZ / 440.0) ** 2 + 0.02j)


@pytest.mark.parametrize(
    "columns",
    [
        {"Frequency (Hz)": HZ, "Magnitude": abs(H), "Phase": np.degrees(np.angle(H))},
        {"f": HZ, "dB": 20.0 * np.log10(abs(H)), "deg": np.degrees(np.angle(H))},
        {"Frequency (Hz)": HZ, "Accelerance (m/s²/N)": abs(H), "Phase (rad)": np.angle(H)},
    ],
)
def test_a_frequency_response_is_called_so(columns):
    with pytest.raises(RecordError, match="this is a frequency response"):
        read_records(columns)


def test_a_known_decay_is_drafted_as_one(tmp_path, capsys):
    path, mapping = tmp_path / "a.csv", tmp_path / "a.yaml"
    rows = zip(T, STEADY[0], STEADY[1], strict=True)
    path.write_text(
        "t (s),disp (mm),ch (mm)\n" + "".join(f"{a},{b},{c}\n" for a, b, c in rows),
        encoding="utf-8",
    )
    with pytest.raises(RecordError, match="give --kind ring-down"):
        read_records(path)
    main(["identify", str(path), "--kind", "ring-down", "--write-mapping", str(mapping)])
    assert "?" not in mapping.read_text(encoding="utf-8")
    (record,) = read_records(path)
    assert {*record.quantities} & {*RESPONSES} == {"displacement"}
    assert "ch (mm)" not in capsys.readouterr().err
