"""Bounds and words of the paper: what is printed decides, on both sides of a bound."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claims.statements import LOOSEST, bound, change, truth


@pytest.mark.parametrize(
    ("printed", "holds"),
    [
        ("1.4", False),  # the value is not below it
        ("1.5", True),
        ("4.5", True),  # within half a decade
        ("4.6", False),  # says too little
        ("50", False),
    ],
)
def test_a_bound_from_above_is_judged_on_both_sides(printed, holds):
    judged = bound("max", "largest error: less than", printed, {"exact": 1.45})
    assert judged.holds == {"exact": holds}
    assert "from above" in judged.how


@pytest.mark.parametrize(
    ("printed", "holds"), [("80", False), ("70", True), ("25", True), ("24", False), ("5", False)]
)
def test_a_bound_from_below_is_judged_on_both_sides(printed, holds):
    judged = bound("max", "highest error: more than", printed, {"as_published": 77.0})
    assert judged.holds == {"as_published": holds}
    assert "from below" in judged.how


def test_the_loosest_bound_is_half_a_decade_away():
    assert math.log10(LOOSEST) == pytest.approx(0.5)
    assert bound("max", "less than", "3.1", {"exact": 1.0}).holds["exact"]
    assert not bound("max", "less than", "3.2", {"exact": 1.0}).holds["exact"]


def test_a_route_without_a_value_supports_no_bound():
    values = {"exact": math.nan, "as_published": 1.4}
    assert bound("max", "less than", "1.5", values).holds == {"exact": False, "as_published": True}


def test_a_bound_must_say_on_which_side_it_is():
    with pytest.raises(ValueError, match=r"text_values\.csv: max: .*'less than' or 'more than'"):
        bound("max", "largest error", "1.5", {"exact": 1.4})


def test_the_printed_word_decides():
    errors, near = {"exact": 19.6, "as_published": 1.0}, {"exact": 1.5, "as_published": 1.5}
    assert change("off", "degraded", errors, near).holds == {"exact": True, "as_published": False}
    assert change("off", "improved", errors, near).holds == {"exact": False, "as_published": True}
    assert truth("best", "true", {"exact": True}).holds == {"exact": True}
    assert truth("best", "false", {"exact": True}).holds == {"exact": False}


def test_an_unknown_word_is_refused():
    with pytest.raises(
        ValueError, match=r"off: cannot judge the word 'unclear'; known are degraded, improved"
    ):
        change("off", "unclear", {"exact": 1.0}, {"exact": 1.0})
    with pytest.raises(
        ValueError, match=r"best: cannot judge the word 'perhaps'; known are true, false"
    ):
        truth("best", "perhaps", {"exact": True})
