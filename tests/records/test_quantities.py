"""Numbers with units: what a text means in SI, and which texts are refused."""

from __future__ import annotations

import pytest
from scipy import constants

from dampbalance.records.coordinate import ROTATION, TRANSLATION
from dampbalance.records.quantities import quantity, read_quantity, with_error

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


@pytest.mark.parametrize(
    ("text", "error"),
    [
        *((text, 10.0) for text in ("2310 ± 10 N/m", "(2310 ± 10) N/m", "2.31 kN/m ± 10 N/m")),
        *(("2,31 N/mm ± 0,5 %", 11.55), ("2310+-10", 10.0), ("2.31 N/mm ± 0.01", 10.0)),
    ],
)
def test_an_uncertainty_has_its_own_unit_or_that_of_its_number(text, error):
    assert with_error("k", text) == pytest.approx((2310.0, error), rel=1e-14)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("2,310", r"k = 2,310 is ambiguous: write 2\.310 or 2310"),
        ("1,2,3", "is no number"),
        ("2310 N", "'N' is no unit for N/m"),
        ("29.7 lbf/foo", "'lbf/foo' is no unit for N/m"),
        ("5.2 N/mm/s", "is no unit for N/m"),
        ("-5 N/m", "must be a positive number of N/m"),
        ("5 ± 5 N/m", "an uncertainty below it"),
        *((text, '"5.2 N/mm" or "29.7 lbf/in", got') for text in ("", "abc", "1±2±3", "nan")),
    ],
)
def test_a_text_that_is_no_stiffness_is_refused(text, words):
    with pytest.raises(ValueError, match=words):
        with_error("k", text)


def test_a_unit_says_whether_it_is_of_a_rotation():
    units = {"2 N/m": TRANSLATION, "2 N m/rad": ROTATION, "2": None}
    assert {text: read_quantity("k", text).coordinate for text in units} == units
