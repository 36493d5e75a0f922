"""A number as printed knows its digits."""

from __future__ import annotations

import pytest

from dampbalance.replication.claims.published import Printed


@pytest.mark.parametrize(
    ("text", "value", "unit", "shown"),
    [
        ("90.0402", 90.0402, 1e-4, "90.04025418"),
        ("2.9E-3", 0.0029, 1e-4, "9.00403e+01"),
        ("9.1587e-07", 9.1587e-07, 1e-11, "9.00402542e+01"),
        ("2310", 2310.0, 1.0, "90.0403"),
        ("-0.00272", -0.00272, 1e-5, "90.040254180"),
    ],
)
def test_printed_number_knows_its_last_digit(text, value, unit, shown):
    printed = Printed(text)
    assert printed.value == value
    assert printed.unit == pytest.approx(unit, rel=1e-15)
    assert printed.show(90.04025418) == shown


def test_printed_text_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match="'1,28' is not a number"):
        _ = Printed("1,28").value


def test_digits_of_a_printed_number():
    texts = ("0.00273", "2.9E-3", "2310")
    assert [Printed(text).decimals for text in texts] == [5, 4, 0]
    assert [Printed(text).significant for text in ("9.1587e-07", "0.050")] == [5, 2]
