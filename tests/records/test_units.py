"""Units: their spellings, their size in SI, what they fit, and where headers hide them."""

from __future__ import annotations

import math

import pytest

from dampbalance.model import named_with_unit
from dampbalance.records.units import DIMENSIONS, UNITS, UnitError, find_unit, split_label, unit_for

# The definitions: the inch is 25.4 mm, standard gravity 9.80665 m/s², the pound-force 0.45359237 kg under it.
_LENGTHS = {
    "m": 1.0,
    "cm": 0.01,
    "mm": 0.001,
    "µm": 1e-6,
    "nm": 1e-9,
    "in": 0.0254,
    "ft": 0.3048,
    "mil": 25.4e-6,
}
IN_SI = {
    **_LENGTHS,
    **{f"{name}/s": factor for name, factor in _LENGTHS.items()},
    **{f"{name}/s²": _LENGTHS[name] for name in ("m", "cm", "mm", "in", "ft")},
    "g": 9.80665,
    "mg": 0.00980665,
    "N": 1.0,
    "mN": 0.001,
    "µN": 1e-6,
    "daN": 10.0,
    "kN": 1000.0,
    "kgf": 9.80665,
    "lbf": 0.45359237 * 9.80665,
    "ozf": 0.45359237 * 9.80665 / 16,
    "kip": 453.59237 * 9.80665,
    "s": 1.0,
    "ms": 0.001,
    "µs": 1e-6,
    "ns": 1e-9,
    "min": 60.0,
    "h": 3600.0,
    "Hz": 1.0,
    "kHz": 1000.0,
    "MHz": 1e6,
    "rad/s": 0.5 / math.pi,  # Hz
    "rad": 1.0,
    "mrad": 0.001,
    "deg": math.pi / 180.0,
    "deg/s": math.pi / 180.0,
    "rpm": math.pi / 30.0,
    "rad/s²": 1.0,
    "deg/s²": math.pi / 180.0,
    "N m": 1.0,
    "N cm": 0.01,
    "N mm": 0.001,
    "mN m": 0.001,
    "kN m": 1000.0,
    "ozf in": 0.45359237 * 9.80665 / 16.0 * 0.0254,
    "lbf in": 0.45359237 * 9.80665 * 0.0254,
    "lbf ft": 0.45359237 * 9.80665 * 0.3048,
}


def test_units_in_si():
    # a product of decimals, rounded up to three times
    factors = {unit.name: find_unit(unit.name).factor for unit in UNITS}
    assert factors == pytest.approx(IN_SI, rel=1e-15)
    assert unit_for("rad/s", "angular_velocity").factor == 1.0


@pytest.mark.parametrize(
    ("spelling", "name"),
    [
        *(("um", "µm"), ("μm", "µm")),  # the Greek letter, not the micro sign
        *(("[mm]", "mm"), (" MM ", "mm"), ("inch", "in"), ("G", "g"), ("Sec", "s"), ("usec", "µs")),
        *((text, "m/s²") for text in ("m/s^2", "m/s2", "m/s**2", "m s-2", "m·s⁻²", "m_per_s2")),
        *(("m/s/s", "m/s²"), ("m/sec^2", "m/s²"), ("m s^-1", "m/s"), ("um/s", "µm/s")),
        ("1/s", "Hz"),
        *(("uN", "µN"), ("KIPS", "kip"), ("feet", "ft"), ("thou", "mil")),
        *(("°", "deg"), ("°/s", "deg/s"), ("deg/s^2", "deg/s²"), ("1/min", "rpm"), ("RPM", "rpm")),
        *((text, "N m") for text in ("Nm", "N·m", "N*m", "N_m", "N.m", "N-m")),
        *((text, "ozf in") for text in ("ozf·in", "oz-in", "oz in", "ozf_in", "in-ozf")),
        *(("Nmm", "N mm"), ("mNm", "mN m"), ("lb-in", "lbf in"), ("ft-lb", "lbf ft")),
    ],
)
def test_spellings(spelling, name):
    assert find_unit(spelling).name == name


@pytest.mark.parametrize("text", ["", "V", "MN", "Mg", "mhz", "furlong", "m/m", "s2", "Mhz"])
def test_what_is_no_unit(text):
    # MN is not mN: where the case decides, it must be right
    assert find_unit(text) is None


def test_every_unit_is_found_by_its_name_and_its_header_suffix():
    for unit in UNITS:
        assert find_unit(unit.name, unit.dimension) is unit
        suffix = named_with_unit("", unit.name)[1:].replace("µ", "u")
        assert find_unit(suffix, unit.dimension) is unit


@pytest.mark.parametrize("quantity", DIMENSIONS)
def test_only_units_of_the_dimension_fit(quantity):
    for unit in UNITS:
        if unit.dimension == DIMENSIONS[quantity]:
            assert unit_for(unit.name, quantity) is unit
        else:
            dimension = find_unit(unit.name, DIMENSIONS[quantity]).dimension  # rad/s has two
            if dimension == DIMENSIONS[quantity]:
                continue
            with pytest.raises(UnitError, match=f"is a unit of {dimension}, but"):
                unit_for(unit.name, quantity)


def test_an_unknown_unit_names_the_nearest_and_those_that_fit():
    with pytest.raises(UnitError, match=r"unknown unit 'mmm' \(did you mean mm\?\).*length: m, cm"):
        unit_for("mmm", "displacement")


@pytest.mark.parametrize(
    ("label", "parts"),
    [
        ("x [mm]", ("x", "mm")),
        ("x(mm)", ("x", "mm")),
        ("x / mm", ("x", "mm")),
        ("x/mm", ("x", "mm")),
        ("a/(m/s²)", ("a", "m/s²")),
        ("Temperatur/°C", ("Temperatur", "°C")),
        ("on/off", ("on/off", None)),
        ("signals[2]", ("signals[2]", None)),
        ("x, mm", ("x", "mm")),
        ("base displacement in µm", ("base displacement", "µm")),
        ("acc_m_per_s2", ("acc", "m_per_s2")),
        ("base_displacement_m", ("base_displacement", "m")),
        ("time_s", ("time", "s")),
        ("x", ("x", None)),
        ("x_rel", ("x_rel", None)),
        ("CH1 [V]", ("CH1", "V")),  # unknown, but clearly meant as one
        ("x []", ("x", None)),
        ("m", ("m", None)),  # a name is never empty
    ],
)
def test_labels(label, parts):
    assert split_label(label) == parts
