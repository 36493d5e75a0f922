"""Headings of channels as instruments and people write them: the quantity and its unit, a time, or nothing of use."""

from __future__ import annotations

import pytest

from dampbalance.records.headings import holds_time, quantity_of, unit_of, unusable
from dampbalance.records.table import RawChannel
from dampbalance.records.units import DIMENSIONS, find_motion, find_unit, split_label


def channel(heading):
    """The channel of a column with a heading."""
    name, unit = split_label(heading)
    return RawChannel(name, unit, label=heading)


HEADINGS = {
    "base_displacement": ("base displacement [mm]", "Weg Tisch/mm", "TableDisp (um)", "ground, mm"),
    "base_acceleration": (
        "Base [g]",
        "Fußpunktbeschleunigung in m/s^2",
        "FUSSPUNKT-BESCHLEUNIGUNG/g",
    ),
    "force": ("Erregung (N)", "shaker force/N", "Kraft in N", "F [N]", "forc (N)"),
    "displacement": ("x/mm", "Data Set 1:Angle(rad)", "pitch [deg]", "Auslenkung Masse (mm)"),
    "velocity": ("velocity_5 (m/s)", "Geschwindigkeit (mm/s)", "v/(m/s)", "v/m/s"),
    "acceleration": ("acc y [g]", "accel_x (mm/s²)", "Beschleunigung/g", "Antwort [m/s²]"),
    "relative_displacement": ("relative displacement [mm]", "Relativweg/mm", "x_rel_mm"),
    "relative_velocity": ("rel vel (m/s)",),
    "relative_acceleration": ("Relative [g]",),
}


@pytest.mark.parametrize("quantity", HEADINGS)
def test_quantities(quantity):
    channels = [*map(channel, HEADINGS[quantity])]
    assert {quantity_of(raw) for raw in channels} == {quantity}
    assert {find_motion(raw.unit).counterpart for raw in channels} == {DIMENSIONS[quantity]}
    assert not any(map(holds_time, channels))


GUESSES = {
    "Table laser 2 [mm]": "base_displacement",
    "mass minus base (mm)": "relative_displacement",
    "Auslenkung Masse relativ zum Tisch (mm)": "relative_displacement",
    "base velocity [m/s]": None,  # drives nothing here
    "response": "displacement",
    **dict.fromkeys(["CH1 [mm]", "mass force [N]", "CH1/V"]),
}


@pytest.mark.parametrize("heading", GUESSES)
def test_what_is_guessed_at_the_most(heading):
    assert quantity_of(channel(heading)) is None
    assert quantity_of(channel(heading), all_words=False) == GUESSES[heading]


TIMES = {
    **dict.fromkeys(["Zeit/s", "Data Set 1:Time(s)", "Elapsed Time (s)", "X_Value", "second"], "s"),
    **{"t [ms]": "ms", "relative time (µs)": "µs", "Zeit  1 - Standardmessrate [s]": "s"},
    **dict.fromkeys(["x-axis", "TIME", "Date/Time"]),
}


@pytest.mark.parametrize("heading", TIMES)
def test_times(heading):
    raw = channel(heading)
    assert holds_time(raw)
    assert (unit_of(raw) and find_unit(unit_of(raw)).name) == TIMES[heading]


NO_MOTION = {
    **dict.fromkeys(["Temperatur/°C", "T [K]", "TEMP1", "room (degC)"], "a temperature"),
    **{"I/A": "a current", "oil (bar)": "a pressure"},
    **dict.fromkeys(["n/1/min", "T [Nm]", "CH1 [V]", "template", "K [mm]", "acceleration/g"]),
}


@pytest.mark.parametrize("heading", NO_MOTION)
def test_what_is_no_motion(heading):
    assert unusable(channel(heading)) == NO_MOTION[heading]
