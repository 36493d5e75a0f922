"""Numbers with units: what a text means in SI, and which texts are refused."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import constants

from dampbalance.records.coordinate import ROTATION, TRANSLATION
from dampbalance.records.quantities import quantity, read_quantity, with_error

POUND_PER_INCH = constants.lbf / constants.inch
NEWTON_MM_PER_DEGREE = 1e-3 / constants.degree


# Products and quotients of a few constants, each rounded: 1e-14.
@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        *(("k", f"29.7 {u}", 29.7 * POUND_PER_INCH) for u in ("lbf/in", "lb/in")),
        *(("k", text, 5200.0) for text in ("5.2 N/mm", "5,2 kN/m", "5.2N/mm", "5,2e3")),
        *(("k", text, 5200.0) for text in ("5 200", "5'200 N/m", "5.2·10³", "5,200.0")),
        ("k", "3 kgf/mm", 3000.0 * constants.kgf),
        *(("k", f"20 {u}", 20 * NEWTON_MM_PER_DEGREE) for u in ("Nmm/deg", "N mm/°")),
        *(("m", f"6.8 {unit}", 6.8 * constants.lb) for unit in ("lb", "lbs", "LBM")),
        ("m", "2420 g", 2.42),
        ("m", "12 kg cm^2", 12e-4),
        ("m", "0,3 kg·m²", 0.3),
        ("m", "5 lb ft²", 5.0 * constants.lb * constants.foot**2),
        ("m", "2 slug", 2.0 * constants.slug),
        *(("frequency", text, 3.5) for text in ("210 rpm", "3,5 Hz", "210 1/min", "0.0035 kHz")),
        ("omega", "210 rpm", 210.0 * 2.0 * constants.pi / constants.minute),
        *(("c", f"90 {unit}", 90.0) for unit in ("N s/m", "Ns/m", "N/(m/s)", "kg/s")),
        ("c", "0.5 lbf s/in", 0.5 * POUND_PER_INCH),
        ("c", "0.2 N m/(rad/s)", 0.2),
        ("noise", "1 %", 0.01),
        ("Y", '0.16"', 0.16 * constants.inch),
    ],
)
def test_a_number_with_a_unit_is_read_in_si(name, text, value):
    assert quantity(name, text) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "value", "error"),
    [
        ("2310 ± 10 N/m", 2310.0, 10.0),
        ("(2310 ± 10) N/m", 2310.0, 10.0),
        ("2.31 kN/m ± 10 N/m", 2310.0, 10.0),
        ("2,31 N/mm ± 0,5 %", 2310.0, 11.55),
        ("2310+-10", 2310.0, 10.0),
        ("2.31 N/mm ± 0.01", 2310.0, 10.0),
    ],
)
def test_an_uncertainty_has_its_own_unit_or_that_of_its_number(text, value, error):
    assert with_error("k", text) == pytest.approx((value, error), rel=1e-14)


@given(st.floats(1e-12, 1e12), st.sampled_from([1.0, 1e3, POUND_PER_INCH]), st.booleans())
def test_a_number_comes_back_from_a_text(value, factor, comma):
    unit = {1.0: "N/m", 1e3: "N/mm"}.get(factor, "lbf/in")
    text = f"{value / factor:.17e} {unit}"
    read = quantity("k", text.replace(".", ",") if comma else text)
    assert read == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("2,310", r"k = 2,310 is ambiguous: write 2\.310 or 2310"),
        ("1,2,3", "is no number"),
        ("2310 N", "'N' is no unit for N/m"),
        ("29.7 lbf/foo", "'lbf/foo' is no unit for N/m"),
        ("5.2 N/mm/s", "is no unit for N/m"),
        ("-5 N/m", "must be a positive number of N/m"),
        *((text, '"5.2 N/mm" or "29.7 lbf/in", got') for text in ("", "abc", "1±2±3", "nan")),
    ],
)
def test_a_text_that_is_no_stiffness_is_refused(text, words):
    with pytest.raises(ValueError, match=words):
        with_error("k", text)


def test_a_unit_says_whether_it_is_of_a_rotation():
    units = {"2 N/m": TRANSLATION, "2 N m/rad": ROTATION, "2": None}
    assert {text: read_quantity("k", text).coordinate for text in units} == units
