"""What columns hold, as names, units and samples show it: each head that the page "Your file" lists is read as it says,
and nothing is ever invented.

The truth is a decay in closed form, x = X e^{−δt} cos ωt, with its derivatives, and a steady motion of two bodies.
"""

from __future__ import annotations

import math
import re
import warnings

import numpy as np
import pytest

from dampbalance import read_records
from dampbalance.records.channel import EXCITATIONS
from dampbalance.records.errors import RecordError
from folders import ROOT
from records.drafts import shown

RANDOM = np.random.default_rng(590)
T = np.arange(2400) / 200.0
W, D = 2.0 * np.pi * 1.7, 0.3
SPIRAL = 0.2 * np.exp((1j * W - D) * T)
X, V, A = (np.real((1j * W - D) ** n * SPIRAL) for n in range(3))
NOISE = RANDOM.standard_normal((4, T.size))
HUM = np.sin(2.0 * np.pi * 50.03 * T)
DEG, G = np.degrees(1.0), 9.80665
TURN = np.sin(9.0 * T + 1.5)
CLOCK = np.arange(T.size)
HZ = 2.5 * np.arange(1, T.size + 1)
H = 1.0 / (1.0 - (HZ / 440.0) ** 2 + 0.02j)

# The page

AT, RATE_OF, OF_A = {"displacement": X}, {"velocity": V}, {"acceleration": A}
DRIVE, STEADY = 0.004 * np.cos(9.0 * T), 0.02 * np.cos(9.0 * T - 1.0)
ANSWER = -81.0 * STEADY
LOOP = {"force": 10.0 * TURN + 2.0 * HUM, "displacement": 0.01 * np.sin(9.0 * T)}
SWING, MOVED = LOOP["displacement"], np.gradient(LOOP["displacement"], T)
SPEED = np.linspace(0.01, 0.3, 30) * (-1.0) ** np.arange(30)
TORQUE = 0.9 * np.sign(SPEED) + 3.4 * SPEED
SHORT = np.where(T < 10.0, 1.0, np.nan)
Y_DRIVES = {"base_displacement": DRIVE, "acceleration": ANSWER}
F_DRIVES = {"force": 1e4 * DRIVE, "displacement": STEADY}

# head → columns, and what is read of them, or asked
FILES = {
    "time_s,displacement_m": ((T, X), AT),
    "Time (s),Position (m),Velocity (m/s),Acceleration (m/s²)": ((T, X, V, A), AT | RATE_OF | OF_A),
    "Data Set 1:Time(s),Data Set 1:Position(m)": ((T, X), AT),
    "Latest: Time (s),Latest: Position (m),Latest: Velocity (m/s)": ((T, X, V), AT | RATE_OF),
    "Zeit [s];Weg [mm]": ((T, 1e3 * X), AT),
    "time,displacement (mm)": ((T, 1e3 * X), AT),
    "time_s,ax (m/s^2),ay (m/s^2),az (m/s^2)": ((T, 1e-3 * NOISE[0], A, G + 1e-3 * NOISE[1]), OF_A),
    "#time,accel_x,accel_y,accel_z": ((T, 1e3 * A, NOISE[0], 1e3 * G + NOISE[1]), OF_A),
    "time (s),angle (rad),angular velocity (rad/s)": ((T, X, V), AT | RATE_OF),
    "time (s),roll": ((T, DEG * X), AT),
    "t,x,y,θ": ((T, 0.4 * np.sin(X), -0.4 * np.cos(X), X), AT),
    "time_s,ch2,displacement_m": ((T, 30.189 + 6e-4 * NOISE[0], X), AT),
    "time_s,in1,displacement_m": ((T, np.where(T < 0.02, 50.0, 0.0) + 1e-3 * NOISE[0], X), AT),
    "Time (s),Position (m),,Time (s),Position (m)": ((T, X, np.nan * T, SHORT * T, SHORT * X), AT),
    "time [s],base displacement [mm],acceleration [g]": ((T, 1e3 * DRIVE, ANSWER / G), Y_DRIVES),
    "time [s],Load cell [N],x [mm]": ((T, 1e4 * DRIVE, 1e3 * STEADY), F_DRIVES),
    "time (s),displacement (m),force (N),velocity 1 (m/s),velocity 2 (m/s)": (
        (T, SWING, LOOP["force"], MOVED, 1.001 * MOVED),
        LOOP | {"velocity": MOVED},
    ),
    "displacement (mm),force (kN)": ((1e3 * SWING, 1e-3 * LOOP["force"]), LOOP),
    "velocity (rad/s),torque (N m)": ((SPEED, TORQUE), {"force": TORQUE, "velocity": SPEED}),
    "time_s,displacement": ((T, X), "in which unit is 'displacement'"),
    "time_s,sensor": ((T, X), "what does the column 'sensor' hold"),
    "Frequency (Hz),Magnitude,Phase": ((HZ, abs(H), DEG * np.angle(H)), "frequency response"),
}


def test_the_page_lists_these_files():
    text = (ROOT / "config/records/README.md").read_text(encoding="utf-8")
    table = text.partition("| the head of the file")[2].partition("\n\n")[0]
    assert re.findall(r"^\| `([^`]+)`", table, re.MULTILINE) == list(FILES)


@pytest.mark.filterwarnings("ignore::dampbalance.records.errors.RecordWarning")
@pytest.mark.parametrize("head", FILES)
def test_a_file_is_read_as_the_page_says(tmp_path, head):
    columns, held = FILES[head]
    path, mark = tmp_path / "run.csv", ";" if ";" in head else ","
    rows = np.column_stack(columns).tolist()
    cells = (["" if math.isnan(value) else f"{value:.12g}" for value in row] for row in rows)
    path.write_text("\n".join([head, *map(mark.join, cells), ""]), encoding="utf-8")
    if isinstance(held, str):
        with pytest.raises(RecordError, match=re.escape(held)) as error:
            read_records(path)
        # nothing that the file lacks is assumed in the draft
        assert not re.search(r"base_\w+: \{|sample_rate_hz: \d|unit: m", str(error.value))
        return
    records = read_records(path)
    runs = {f"{path} (run {n})": size for n, size in ((1, 2400), (2, 2000))} if ",," in head else {}
    sizes = runs or {str(path): len(columns[0])}
    assert {of.name: next(iter(of.channels.values())).t.size for of in records} == sizes
    for record in records:
        assert {*record} == {*held}
        for quantity, values in held.items():
            # the texts have 12 digits; accelerations in g may be divided once more
            found = record[quantity].values
            np.testing.assert_allclose(found, values[: found.size], rtol=1e-9, atol=1e-9)


# Decays, and what is asked for

DECAYS = {
    "a constant": ({"battery": 0.0 * T + 3.7, "x (m)": X}, {"displacement": X}),
    "noise in mm": ({"ch1 [mm]": NOISE[0], "ch2 [mm]": 1e3 * X}, {"displacement": X}),
    "thermocouples": ({"T1": 0.1 * T - 0.001 * T**2, "T2 (°C)": T, "x (m)": X}, {"displacement": X}),
    "a hammer in volts": ({"Hammer (V)": np.where(T < 0.02, 40.0, 0.0), "acc (m/s²)": A}, {"acceleration": A}),
    "x and v without names": ({"s1 [mm]": 1e3 * X, "s2 [m/s]": V}, {"displacement": X, "velocity": V}),
    "axes of a gyroscope": ({"gx (rad/s)": 0.01 * NOISE[0], "gz (rad/s)": V}, {"velocity": V}),
    "a marker": ({"X (mm)": 812.0 + NOISE[0], "Y (mm)": 1e3 * X, "Z (mm)": NOISE[1]}, {"displacement": X}),
    "an angle and its rate": ({"theta": X, "omega": V}, {"displacement": X, "velocity": V}),
    "an angle in degrees": ({"roll": 45.0 + DEG * X}, {"displacement": np.pi / 4.0 + X}),
    "an angle by its rate": (
        {"pitch": DEG * X / 4.0, "pitch rate": HUM, "angular velocity (deg/s)": DEG * V / 4.0},
        {"displacement": X / 4.0, "velocity": V / 4.0},
    ),
    "a rate by its angle": ({"Winkelgeschwindigkeit": DEG * V, "Winkel": DEG * X}, {"velocity": V, "displacement": X}),
    "g by gravity": (
        {"ax": A / G, "ay": 0.002 * NOISE[0], "az": 1.0 + 0.002 * NOISE[1]},
        {"acceleration": A},
    ),
    "m/s² by gravity": ({"Acc Z": 9.78 + A}, {"acceleration": 9.78 + A}),
}  # fmt: skip


@pytest.mark.parametrize("name", DECAYS)
def test_a_decay_is_read_at_once(name):
    columns, truth = DECAYS[name]
    (record,) = read_records({"time (s)": T, **columns})
    assert not record.driven
    assert {*record.quantities} == {*truth}
    for q, values in truth.items():
        np.testing.assert_allclose(record[q].values, values, rtol=3e-3, atol=1e-12)


ACROSS = np.cos(0.5) * A, 9.81 - np.sin(0.5) * A
RUN_DOWN = np.sin(2.0 * np.pi * np.cumsum(2.5 * np.clip(1.0 - T / 11.0, 0.0, None)) / 200.0)
STOPPED = RUN_DOWN * (T < 4.0)  # through resonance


def answer(drive):
    return np.convolve(drive, SPIRAL.imag)[: T.size]


OF_BODY = r"(does|do) the column"
ASKED = {
    "an offset of one of a single axis": ({"time (s)": T, "acc": 1.0 + A}, "in which unit is 'acc'"),
    "a second body": ({"time_s": T, "x2 (mm)": 400.0 * X, "x (mm)": 1e3 * X}, OF_BODY),
    "a wrong unit of a velocity": ({"time_s": T, "v (m/s)": 3.6 * V, "x (m)": X}, OF_BODY),
    "an acceleration of a table": ({"time_s": T, "acc (m/s²)": np.roll(A, 20), "x (m)": X}, OF_BODY),
    "a table in steady motion": ({"time_s": T, "acc (m/s²)": TURN, "x (m)": np.sin(9.0 * T)}, "does the column 'acc"),
    "whole milliseconds": ({"time": 3.0 + 5.0 * CLOCK, "x (m)": X}, "in which unit is 'time'"),
    "days of a spreadsheet": ({"time": 3.0 + 1e-7 * CLOCK, "x (m)": X}, "in which unit is 'time'"),
    "2.3 degrees, or a turn and a half": ({"time_s": T, "angle": DEG * X / 5.0}, "in which unit is 'angle'"),
    "an angle about another": ({"time_s": T, "roll": 40.0 + DEG * X / 5.0}, "in which unit is 'roll'"),
    "ticks of an encoder": ({"time_s": T, "theta": np.rint(652.0 * X)}, "in which unit is 'theta'"),
    "turns": ({"time_s": T, "phi": 4.0 * np.pi + X}, "in which unit is 'phi'"),
    "a rate": ({"time_s": T, "Winkelgeschwindigkeit": DEG * V}, "in which unit is 'Winkelg"),
    "an angle and its rate": (
        {"time_s": T, "theta": DEG * X / 5.0, "omega": DEG * V / 5.0},
        "in which units are 'theta' and 'omega'",
    ),
    "one in dB": ({"f": HZ, "dB": 20.0 * np.log10(abs(H)), "deg": np.degrees(np.angle(H))}, "frequency response"),
    "a motion between two axes": (
        {"time_s": T, "ax (m/s²)": ACROSS[0], "ay (m/s²)": 0.05 * NOISE[0], "az (m/s²)": ACROSS[1]},
        f"scale: {1.0 / np.cos(0.5):.3g}",
    ),
    "a drive that stops": ({"time_s": T, "ch0": STOPPED, "x (mm)": answer(STOPPED)}, "hold: .*base_"),
    "a drive that runs down": ({"time_s": T, "y (mm)": RUN_DOWN, "x (mm)": answer(RUN_DOWN)}, "hold: .*base_"),
}  # fmt: skip


@pytest.mark.parametrize("name", ASKED)
def test_what_columns_leave_open_is_asked_for(name):
    columns, message = ASKED[name]
    with pytest.raises(RecordError, match=message):
        read_records(columns)


MOVING = [np.sin(9.0 * T + 0.5 * n) + 0.1 * n * np.sin(27.0 * T + n) for n in range(5)]
NAMES = ["ch1", "AI 2", "dist", "velocity_5", "aux", "signal", "column 7", "laser", "acc"]
UNITS = ["", " [mm]", " (V)", " [m/s²]", " (mm/s)", " [g]"]


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_no_drive_no_unit_and_no_rate_is_invented(seed, free):
    """Columns that move, under names and units of which none names a drive."""
    random = np.random.default_rng((59, seed))
    count, times = random.integers(1, 5), random.random() < 0.8
    heads = [a + random.choice(UNITS) for a in random.choice(NAMES, count, replace=False)]
    columns = {"time_s": T} if times else {}
    columns |= dict(zip(heads, MOVING[:count], strict=True))
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
        at = rule["channel"]
        bare = [head.split(" [")[0].split(" (")[0] for head in columns]
        head = [*columns][at - 1 if isinstance(at, int) else bare.index(at)]
        assert rule["unit"] == "?" or rule.get("scale") == "?" or rule["unit"] in head
        assert rule.get("scale", "?") == "?"
    assert ("sample_rate_hz" in draft) == (not times)
    assert draft.get("sample_rate_hz", "?") == "?"
    with pytest.raises(RecordError, match="blanks"):
        read_records(columns, mapping=draft)


@pytest.mark.parametrize("step", [0.05, 0.004, 1e-5])
def test_times_in_parts_of_one_are_seconds(step):
    (record,) = read_records({"time": step * np.arange(T.size), "x (m)": X})
    assert record["displacement"].t[-1] == pytest.approx(step * (T.size - 1))


def test_a_motion_close_to_an_axis_is_that_of_the_axis():
    x, z = np.cos(0.17) * A, 9.81 - np.sin(0.17) * A
    (record,) = read_records({"time_s": T, "ax (m/s²)": x, "az (m/s²)": z})
    assert np.std(record["acceleration"].values) == pytest.approx(np.std(A), rel=0.02)


def test_a_clock_with_a_unit_goes_before_one_without():
    (record,) = read_records({"time": 10.0 * T, "elapsed (s)": T, "x (m)": X})
    np.testing.assert_allclose(record["displacement"].t, T, atol=1e-12)
