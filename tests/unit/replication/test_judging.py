"""What a claim says of itself: how far its routes are off, in words that can be checked by hand."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claims.judging import Tolerance, explanation
from dampbalance.replication.verdicts import SCATTER
from paper.routes import claim


def test_routes_are_those_that_give_a_number():
    made = claim("1.28", from_print=1.3, exact=1.2, as_published=math.nan)
    assert made.routes == ["exact", "from_print"]
    assert made.show("as_published") == ""
    assert made.show("exact") == "1.200000"
    assert made.off("exact") == pytest.approx(-8.0)
    assert made.giving == []


@pytest.mark.parametrize(
    ("printed", "value", "words"),
    [
        ("1.28", 1.299, "1.9 units of the last digit above print"),
        ("1.28", 1.261, "1.9 units of the last digit below print"),
        ("1.28", 1.47, "19 units of the last digit above print"),
        ("1.000", 1.025, "2.5 % above print"),
        ("1.000", 0.975, "2.5 % below print"),
        ("1.00", 1.25, "25 % above print"),
        ("1.000", 0.9, "10 % below print"),
    ],
)
def test_a_distance_is_in_units_of_the_last_digit_if_there_are_few(printed, value, words):
    assert explanation(claim(printed, exact=value)) == (
        f"Exact: {words}. Unexplained: no other number of the paper contradicts it."
    )


def test_the_route_that_comes_closest_is_named():
    made = claim("1.28", exact=1.35, as_published=1.25, from_print=1.33)
    assert explanation(made).startswith("As published: 3 units of the last digit below print.")


def test_digits_that_are_obtained_say_by_what():
    assert explanation(claim("1.28", exact=1.2801)) == "Exactly 1.280100, which rounds to 1.28."
    other = claim("1.28", exact=1.31, as_published=1.2801, from_print=1.28, cause="So read.")
    assert explanation(other) == (
        "Obtained as published and from print (exact: 3 units of the last digit above print). So read."
    )
    assert explanation(claim("1.28", as_published=1.28)) == "Obtained as published."


def test_a_last_digit_needs_no_tolerance_and_another_does():
    wide = Tolerance(1.2, 1.4, "the others scatter as far", SCATTER)
    near = claim("1.28", exact=1.294, tolerances=(wide,), cause="So read.")
    assert explanation(near) == "Exact: 1.4 units of the last digit above print. So read."
    far = claim("1.28", exact=1.31, tolerances=(wide,), cause="So read.")
    assert explanation(far) == (
        "Exact: 3 units of the last digit above print; the others scatter as far. So read."
    )


def test_what_differs_is_contradicted_by_the_paper_or_unexplained():
    text = "Exact: 3 units of the last digit above print. "
    assert explanation(claim("1.28", exact=1.31, evidence="W says 1.31.")) == f"{text}W says 1.31."
    both = claim("1.28", exact=1.31, evidence="W says 1.31.", contradiction="The mean needs 1.31.")
    assert explanation(both) == f"{text}The mean needs 1.31."
    assert explanation(claim("1.28")) == "No route gives a value."
