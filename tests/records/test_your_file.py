"""The page "Your file" of the site: each head that it lists is read as it says."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from dampbalance import read_records
from dampbalance.records.errors import RecordError
from folders import ROOT

G = 9.80665
RATE, HERTZ = 200.0, 2.0
T = np.arange(0.0, 12.0, 1.0 / RATE)
OMEGA = 2.0 * math.pi * HERTZ
S = complex(-0.1, OMEGA)
# a decay in closed form, Re X e^{st}, and its derivatives
D, V, A = ((0.05 * S**n * np.exp(S * T)).real for n in range(3))
DRIVE, STEADY = 0.004 * np.cos(OMEGA * T), 0.02 * np.cos(OMEGA * T - 1.0)
RANDOM = np.random.default_rng(28)
NOISE = [1e-3 * RANDOM.standard_normal(T.size) for _ in range(3)]
ROUND = 10.0 * np.sin(OMEGA * T) + 2.0 * np.cos(OMEGA * T)  # N; with D₀ a loop that loses energy
SWING = 0.01 * np.sin(OMEGA * T)
DECAY, RATE_OF, OF_A = {"displacement": D}, {"velocity": V}, {"acceleration": A}
ROTATION, TURN = {"displacement": 4.0 * D}, {"displacement": 4.0 * D, "velocity": 4.0 * V}
ANSWER = -(OMEGA**2) * STEADY
BASE = {"base_displacement": DRIVE, "acceleration": ANSWER}
FORCE = {"force": 1e4 * DRIVE, "displacement": STEADY}
BLOW = np.where(T < 0.02, 50.0, 0.0) + NOISE[0]
FREQUENCY = np.linspace(2.5, 2000.0, T.size)
RESPONSE = 1.0 / (1.0 - (FREQUENCY / 440.0) ** 2 + 0.02j)
LOOP = {"force": ROUND, "displacement": SWING}
SPEED = np.linspace(0.01, 0.3, 30) * (-1.0) ** np.arange(30)
TORQUE = 0.9 * np.sign(SPEED) + 3.4 * SPEED

# head → columns, and what is read of them, or asked
FILES: dict[str, tuple[tuple[np.ndarray, ...], object]] = {
    "time_s,displacement_m": ((T, D), DECAY),
    "Time (s),Position (m),Velocity (m/s),Acceleration (m/s²)": (
        (T, D, V, A),
        DECAY | RATE_OF | OF_A,
    ),
    "Data Set 1:Time(s),Data Set 1:Position(m)": ((T, D), DECAY),
    "Latest: Time (s),Latest: Position (m),Latest: Velocity (m/s)": ((T, D, V), DECAY | RATE_OF),
    "Zeit [s];Weg [mm]": ((T, 1e3 * D), DECAY),
    "time,displacement (mm)": ((T, 1e3 * D), DECAY),
    "time_s,ax (m/s^2),ay (m/s^2),az (m/s^2)": ((T, NOISE[0], A, G + NOISE[1]), OF_A),
    "#time,accel_x,accel_y,accel_z": ((T, 1e3 * A, NOISE[0], 1e3 * (G + NOISE[1])), OF_A),
    "time (s),angle (rad),angular velocity (rad/s)": ((T, 4.0 * D, 4.0 * V), TURN),
    "time (s),roll": ((T, np.degrees(4.0 * D)), ROTATION),
    "t,x,y,θ": ((T, 0.4 * np.sin(4.0 * D), -0.4 * np.cos(4.0 * D), 4.0 * D), ROTATION),
    "time_s,ch2,displacement_m": ((T, 30.189 + 0.6 * NOISE[0], D), DECAY),
    "time_s,in1,displacement_m": ((T, BLOW, D), DECAY),
    "Time (s),Position (m),,Time (s),Position (m)": ((T, D, np.nan * T, T, D), DECAY),
    "time [s],base displacement [mm],acceleration [g]": ((T, 1e3 * DRIVE, ANSWER / G), BASE),
    "time [s],Load cell [N],x [mm]": ((T, 1e4 * DRIVE, 1e3 * STEADY), FORCE),
    "time (s),displacement (m),force (N),velocity 1 (m/s),velocity 2 (m/s)": (
        (T, SWING, ROUND, np.gradient(SWING, T), 1.001 * np.gradient(SWING, T)),
        LOOP | {"velocity": np.gradient(SWING, T)},
    ),
    "displacement (mm),force (kN)": ((1e3 * SWING, 1e-3 * ROUND), LOOP),
    "velocity (rad/s),torque (N m)": ((SPEED, TORQUE), {"force": TORQUE, "velocity": SPEED}),
    "time_s,displacement": ((T, D), "in which unit is 'displacement'"),
    "time_s,sensor": ((T, D), "what does the column 'sensor' hold"),
    "Frequency (Hz),Magnitude,Phase": (
        (FREQUENCY, abs(RESPONSE), np.degrees(np.angle(RESPONSE))),
        "frequency response",
    ),
}


def test_the_page_lists_these_files():
    text = (ROOT / "paper/site/howto/files.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `([^`]+)`", text, re.MULTILINE) == list(FILES)


@pytest.mark.filterwarnings("ignore::dampbalance.records.errors.RecordWarning")
@pytest.mark.parametrize("head", FILES)
def test_a_file_is_read_as_the_page_says(tmp_path, head):
    columns, held = FILES[head]
    path, mark = tmp_path / "run.csv", ";" if ";" in head else ","
    rows = np.column_stack(columns).tolist()
    cells = (["" if math.isnan(value) else f"{value:.12g}" for value in row] for row in rows)
    lines = [mark.join(row) for row in cells]
    path.write_text("\n".join([head, *lines, ""]), encoding="utf-8")
    if isinstance(held, str):
        with pytest.raises(RecordError, match=re.escape(held)) as error:
            read_records(path)
        # nothing that the file lacks is assumed in the draft
        assert not re.search(r"base_\w+: \{|sample_rate_hz: \d|unit: m", str(error.value))
        return
    records = read_records(path)
    assert len(records) == head.count("Position (m)") or len(records) == 1
    for record in records:
        assert {*record} == {*held}
        for quantity, values in held.items():
            # the texts have 12 digits; accelerations in g may be divided once more
            np.testing.assert_allclose(record[quantity].values, values, rtol=1e-9, atol=1e-9)
