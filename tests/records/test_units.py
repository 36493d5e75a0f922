"""Units: their spellings, their size in SI, what they fit, and where headers hide them; and headings of channels as
instruments and people write them: the quantity and its unit, or a time; and numbers with units."""

from __future__ import annotations

import math

import pytest
from scipy import constants

from dampbalance.model import named_with_unit
from dampbalance.records.coordinate import ROTATION, TRANSLATION
from dampbalance.records.headings import holds_time, quantity_of, unit_of
from dampbalance.records.quantities import quantity, read_quantity, with_error
from dampbalance.records.table import RawChannel
from dampbalance.records.units import DIMENSIONS, UNITS, UnitError, find_unit, split_label, unit_for

# The definitions: the inch is 25.4 mm, standard gravity 9.80665 m/s², the pound-force 0.45359237 kg under it.
G, LBF, INCH, DEGREE = 9.80665, 0.45359237 * 9.80665, 0.0254, math.pi / 180.0
LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9}
LENGTHS |= {"in": INCH, "ft": 12.0 * INCH, "mil": 1e-3 * INCH}
IN_SI = {
    **LENGTHS,
    **{f"{name}/s": factor for name, factor in LENGTHS.items()},
    **{f"{name}/s²": LENGTHS[name] for name in ("m", "cm", "mm", "in", "ft")},
    **{"g": G, "mg": 1e-3 * G},
    **{"N": 1.0, "mN": 1e-3, "µN": 1e-6, "daN": 10.0, "kN": 1e3},
    **{"kgf": G, "lbf": LBF, "ozf": LBF / 16.0, "kip": 1e3 * LBF},
    **{"s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    **{"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "rad/s": 0.5 / math.pi},  # Hz
    **{"rad": 1.0, "mrad": 1e-3, "deg": DEGREE},
    **{"deg/s": DEGREE, "rpm": math.pi / 30.0, "rad/s²": 1.0, "deg/s²": DEGREE},
    **{"N m": 1.0, "N cm": 0.01, "N mm": 1e-3, "mN m": 1e-3, "kN m": 1e3},
    **{"ozf in": LBF / 16.0 * INCH, "lbf in": LBF * INCH, "lbf ft": LBF * 12.0 * INCH},
}


def test_units_in_si():
    # a product of decimals, rounded up to three times
    factors = {unit.name: find_unit(unit.name).factor for unit in UNITS}
    assert factors == pytest.approx(IN_SI, rel=1e-15)
    assert unit_for("rad/s", "angular_velocity").factor == 1.0


SPELLINGS = {
    "µm": ("um", "μm"),  # the Greek letter, not the micro sign
    **{"mm": ("[mm]", " MM "), "in": ("inch",), "ft": ("feet",), "mil": ("thou",), "g": ("G",)},
    **{"s": ("Sec",), "µs": ("usec",), "Hz": ("1/s",), "µN": ("uN",), "kip": ("KIPS",)},
    **{"m/s": ("m s^-1",), "µm/s": ("um/s",), "deg": ("°",), "deg/s": ("°/s",)},
    "m/s²": ("m/s^2", "m/s2", "m/s**2", "m s-2", "m·s⁻²", "m_per_s2", "m/s/s", "m/sec^2"),
    **{"deg/s²": ("deg/s^2",), "rpm": ("1/min", "RPM"), "N mm": ("Nmm",), "mN m": ("mNm",)},
    "N m": ("Nm", "N·m", "N*m", "N_m", "N.m", "N-m"),
    "ozf in": ("ozf·in", "oz-in", "oz in", "ozf_in", "in-ozf"),
    **{"lbf in": ("lb-in",), "lbf ft": ("ft-lb",)},
}
# MN is not mN: where the case decides, it must be right
NONE = ["", "V", "MN", "Mg", "mhz", "furlong", "m/m", "s2", "Mhz", "NM", "MNm", "kn", "MS", "Ns"]


@pytest.mark.parametrize("name", SPELLINGS)
def test_spellings(name):
    assert {find_unit(text).name for text in SPELLINGS[name]} == {name}


@pytest.mark.parametrize("text", NONE)
def test_what_is_no_unit(text):
    assert find_unit(text) is None


def test_every_unit_is_found_by_its_name_and_its_header_suffix():
    for unit in UNITS:
        assert find_unit(unit.name, unit.dimension) is unit
        suffix = named_with_unit("", unit.name)[1:].replace("µ", "u")
        assert find_unit(suffix, unit.dimension) is unit


@pytest.mark.parametrize("quantity", DIMENSIONS)
def test_only_units_of_the_dimension_fit(quantity):
    for unit in UNITS:
        dimension = find_unit(unit.name, DIMENSIONS[quantity]).dimension  # rad/s has two
        if unit.dimension == DIMENSIONS[quantity]:
            assert unit_for(unit.name, quantity) is unit
        elif dimension != DIMENSIONS[quantity]:
            with pytest.raises(UnitError, match=f"is a unit of {dimension}, but"):
                unit_for(unit.name, quantity)


LABELS = {
    ("x", "mm"): ("x [mm]", "x(mm)", "x / mm", "x/mm", "x, mm"),
    ("a", "m/s²"): ("a/(m/s²)",),
    ("Temperatur", "°C"): ("Temperatur/°C",),
    ("base displacement", "µm"): ("base displacement in µm",),
    ("acc", "m_per_s2"): ("acc_m_per_s2",),
    ("base_displacement", "m"): ("base_displacement_m",),
    ("CH1", "V"): ("CH1 [V]",),  # unknown, but clearly meant as one
    **{(name, None): (name,) for name in ("on/off", "signals[2]", "x", "x_rel")},
    ("x", None): ("x", "x []"),
    ("m", None): ("m",),  # a name is never empty
}


@pytest.mark.parametrize("parts", LABELS)
def test_labels(parts):
    assert {split_label(label) for label in LABELS[parts]} == {parts}


# Headings


def channel(heading):
    """The channel of a column with a heading."""
    name, unit = split_label(heading)
    return RawChannel(name, unit, label=heading)


HEADINGS = {
    "base_displacement": ("base displacement [mm]", "Weg Tisch/mm", "TableDisp (um)", "ground, mm"),
    "base_acceleration": ("Fußpunktbeschleunigung in m/s^2", "FUSSPUNKT-BESCHLEUNIGUNG/g"),
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
    assert not any(map(holds_time, channels))


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


# Numbers with units: what a text means in SI, and which texts are refused

POUND_PER_INCH = constants.lbf / constants.inch
WRITTEN = {
    ("k", 29.7 * POUND_PER_INCH): ("29.7 lbf/in", "29.7 lb/in"),
    ("k", 5200.0): ("5.2 N/mm", "5,2 kN/m", "5.2N/mm", "5,2e3", "5 200", "5'200 N/m", "5,200.0"),
    ("k", 5.2e-3): ("5.2·10⁻³", "0.0052"),
    ("k", 3000.0 * constants.kgf): ("3 kgf/mm",),
    ("k", 20e-3 / constants.degree): ("20 Nmm/deg", "20 N mm/°"),
    ("m", 6.8 * constants.lb): ("6.8 lb", "6.8 lbs", "6.8 LBM"),
    **{("m", 2.42): ("2420 g",), ("m", 12e-4): ("12 kg cm^2",), ("m", 0.3): ("0,3 kg·m²",)},
    ("m", 5.0 * constants.lb * constants.foot**2): ("5 lb ft²",),
    ("m", 2.0 * constants.slug): ("2 slug",),
    ("frequency", 3.5): ("210 rpm", "3,5 Hz", "210 1/min", "0.0035 kHz"),
    ("omega", 7.0 * constants.pi): ("210 rpm",),
    ("c", 90.0): ("90 N s/m", "90 Ns/m", "90 N/(m/s)", "90 kg/s"),
    ("c", 0.5 * POUND_PER_INCH): ("0.5 lbf s/in",),
    **{("c", 0.2): ("0.2 N m/(rad/s)",), ("noise", 0.01): ("1 %",)},
    ("Y", 0.16 * constants.inch): ('0.16"',),
}


@pytest.mark.parametrize(("name", "value"), WRITTEN)
def test_a_number_with_a_unit_is_read_in_si(name, value):
    for text in WRITTEN[name, value]:
        # products and quotients of a few constants, each rounded
        assert quantity(name, text) == pytest.approx(value, rel=1e-14), text


ERRORS = {
    **dict.fromkeys(["2310 ± 10 N/m", "(2310 ± 10) N/m", "2.31 kN/m ± 10 N/m", "2310+-10"], 10.0),
    **{"2,31 N/mm ± 0,5 %": 11.55, "2.31 N/mm ± 0.01": 10.0},
}


@pytest.mark.parametrize("text", ERRORS)
def test_an_uncertainty_has_its_own_unit_or_that_of_its_number(text):
    assert with_error("k", text) == pytest.approx((2310.0, ERRORS[text]), rel=1e-14)


NO_STIFFNESS = {
    "2,310": r"k = 2,310 is ambiguous: write 2\.310 or 2310",
    "1,2,3": "is no number",
    "2310 N": "'N' is no unit for N/m",
    "29.7 lbf/foo": "'lbf/foo' is no unit for N/m",
    "5.2 N/mm/s": "is no unit for N/m",
    "-5 N/m": "must be a positive number of N/m",
    "5 ± 5 N/m": "an uncertainty below it",
    **dict.fromkeys(["", "abc", "1±2±3", "nan"], '"5.2 N/mm" or "29.7 lbf/in", got'),
}


@pytest.mark.parametrize("text", NO_STIFFNESS)
def test_a_text_that_is_no_stiffness_is_refused(text):
    with pytest.raises(ValueError, match=NO_STIFFNESS[text]):
        with_error("k", text)


def test_a_unit_says_whether_it_is_of_a_rotation():
    units = {"2 N/m": TRANSLATION, "2 N m/rad": ROTATION, "2": None}
    assert {text: read_quantity("k", text).coordinate for text in units} == units


def test_a_key_of_a_rotation_has_its_noun_and_its_unit():
    keys = {
        **{"K_z_N_per_m": "K_z_N_m_per_rad", "F_k_N": "T_k_N_m", "c_N_s_per_m": "c_N_m_s_per_rad"},
        **{"velocity_m_per_s": "angular_velocity_rad_per_s", "X_m": "X_rad", "m_kg": "J_kg_m2"},
    }
    assert {key: ROTATION.key(key) for key in keys} == keys
    assert [*map(TRANSLATION.key, keys)] == [*keys]
