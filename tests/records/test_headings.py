"""Headings of channels as instruments and people write them: the quantity and its unit, a time, or nothing of use."""

from __future__ import annotations

import pytest

from dampbalance.records.headings import holds_time, quantity_of, unit_of, unusable
from dampbalance.records.table import RawChannel
from dampbalance.records.units import find_unit, split_label


def channel(heading):
    """The channel of a column with a heading."""
    name, unit = split_label(heading)
    return RawChannel(name, unit, label=heading)


@pytest.mark.parametrize(
    ("heading", "quantity", "unit"),
    [
        ("base displacement [mm]", "base_displacement", "mm"),
        ("Weg Tisch/mm", "base_displacement", "mm"),
        ("TableDisp (um)", "base_displacement", "µm"),
        ("ground, mm", "base_displacement", "mm"),
        ("y_mm", "base_displacement", "mm"),
        ("base acceleration/g", "base_acceleration", "g"),
        ("Base [g]", "base_acceleration", "g"),
        ("Fußpunktbeschleunigung in m/s^2", "base_acceleration", "m/s²"),
        ("FUSSPUNKT-BESCHLEUNIGUNG / m/s²", "base_acceleration", "m/s²"),
        ("Erregung (N)", "force", "N"),
        ("shaker force/N", "force", "N"),
        ("Kraft in N", "force", "N"),
        ("x/mm", "displacement", "mm"),
        ("acc y [g]", "acceleration", "g"),
        ("accel_x (mm/s²)", "acceleration", "mm/s²"),
        ("velocity_5 (m/s)", "velocity", "m/s"),
        ("Latest: Position (m)", "displacement", "m"),
        ("Data Set 1:Angle(rad)", "displacement", "rad"),
        ("F [N]", "force", "N"),
        ("forc (N)", "force", "N"),
        ("pitch [deg]", "displacement", "deg"),
        ("dist/mm", "displacement", "mm"),
        ("Response [mm]", "displacement", "mm"),
        ("Auslenkung Masse (mm)", "displacement", "mm"),
        ("Geschwindigkeit (mm/s)", "velocity", "mm/s"),
        ("v/(m/s)", "velocity", "m/s"),
        ("v/m/s", "velocity", "m/s"),
        ("Beschleunigung/g", "acceleration", "g"),
        ("acceleration/g", "acceleration", "g"),
        ("Antwort [m/s²]", "acceleration", "m/s²"),
        ("relative displacement [mm]", "relative_displacement", "mm"),
        ("Relativweg/mm", "relative_displacement", "mm"),
        ("x_rel_mm", "relative_displacement", "mm"),
        ("rel vel (m/s)", "relative_velocity", "m/s"),
        ("Relative [g]", "relative_acceleration", "g"),
    ],
)
def test_quantities(heading, quantity, unit):
    raw = channel(heading)
    assert (quantity_of(raw), find_unit(raw.unit).name) == (quantity, find_unit(unit).name)
    assert not holds_time(raw)


@pytest.mark.parametrize(
    ("heading", "guess"),
    [
        ("CH1 [mm]", None),
        ("Table laser 2 [mm]", "base_displacement"),
        ("mass minus base (mm)", "relative_displacement"),
        ("Auslenkung Masse relativ zum Tisch (mm)", "relative_displacement"),
        ("base velocity [m/s]", None),  # drives nothing here
        ("response", "displacement"),
        ("mass force [N]", None),
        ("CH1/V", None),
    ],
)
def test_what_is_guessed_at_the_most(heading, guess):
    assert quantity_of(channel(heading)) is None
    assert quantity_of(channel(heading), all_words=False) == guess


@pytest.mark.parametrize(
    ("heading", "unit"),
    [
        *(
            ("Zeit/s", "s"),
            ("time/s", "s"),
            ("Data Set 1:Time(s)", "s"),
            ("Elapsed Time (s)", "s"),
            ("t [ms]", "ms"),
        ),
        *(("X_Value", "s"), ("x-axis", None), ("second", "s"), ("relative time (µs)", "µs")),
        *(("Zeit  1 - Standardmessrate [s]", "s"), ("TIME", None), ("Date/Time", None)),
    ],
)
def test_times(heading, unit):
    raw = channel(heading)
    assert holds_time(raw)
    assert (unit_of(raw) and find_unit(unit_of(raw)).name) == unit


@pytest.mark.parametrize(
    ("heading", "other"),
    [
        *((text, "a temperature") for text in ("Temperatur/°C", "T [K]", "TEMP1", "room (degC)")),
        ("I/A", "a current"),
        ("oil (bar)", "a pressure"),
        *(
            (text, None)
            for text in ("n/1/min", "T [Nm]", "CH1 [V]", "template", "K [mm]", "acceleration/g")
        ),
    ],
)
def test_what_is_no_motion(heading, other):
    assert unusable(channel(heading)) == other
