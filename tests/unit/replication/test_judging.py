"""What a claim says of itself: how far its routes are off, in words that can be checked by hand."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claim_verdicts import UNEXPLAINED
from dampbalance.replication.claims.judging import Tolerance, explanation
from paper.routes import claim


def test_routes_are_those_that_give_a_number():
    made = claim("1.28", from_print=1.3, exact=1.2, as_published=math.nan)
    assert made.routes == ["exact", "from_print"]
    assert made.show("as_published") == ""
    assert made.show("exact") == "1.200000"
    assert made.off("exact") == pytest.approx(-8.0)
    assert made.off("from_print") == pytest.approx(2.0)
    assert made.off_relative("exact") == pytest.approx(-0.0625)


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
        f"Exact: {words}. No bound reaches so far, and no other number of the paper contradicts it."
    )


def test_the_route_that_judges_is_named_however_close_another_comes():
    made = claim("1.280", exact=1.283, as_published=1.285, route="as_published")
    assert explanation(made).startswith("As published: 5 units of the last digit above print.")
    assert explanation(claim("1.28", exact=1.29)) == "Exact: 1 unit of the last digit above print."


def test_digits_that_are_obtained_say_by_what():
    assert explanation(claim("1.28", exact=1.2801)) == "Exactly 1.280100, which rounds to 1.28."
    authors = {"route": "as_published", "as_published": 1.2801}
    assert explanation(claim("1.280", exact=1.283, cause="So read.", **authors)) == (
        "Obtained as published (exact: 3 units of the last digit above print). So read."
    )
    assert explanation(claim("1.280", exact=1.2799, **authors)) == (
        "Obtained as published (exact: rounds to print as well, by chance)."
    )
    assert explanation(claim("1.28", **authors)) == "Obtained as published."


def test_a_last_digit_needs_no_tolerance_and_another_does():
    near = Tolerance(1.2, 1.4, "nothing says why", UNEXPLAINED)
    one = claim("1.28", exact=1.294, tolerances=(near,), cause="So read.")
    assert explanation(one) == "Exact: 1.4 units of the last digit above print. So read."
    more = claim("1.28", exact=1.31, tolerances=(near,), cause="So read.")
    assert explanation(more) == (
        "Exact: 3 units of the last digit above print; nothing says why. So read."
    )


def test_what_differs_is_contradicted_by_the_paper_or_says_that_it_is_not():
    text = "Exact: 3 units of the last digit above print. "
    assert explanation(claim("1.28", exact=1.31, evidence="W says 1.31.")) == f"{text}W says 1.31."
    both = claim("1.28", exact=1.31, evidence="W says 1.31.", contradiction="The mean needs 1.31.")
    assert explanation(both) == f"{text}The mean needs 1.31."
    assert explanation(claim("1.28")) == "No number exact."
    far = claim("1.280", exact=1.28, as_published=1.2935)
    assert explanation(far).endswith(
        "Too far for the deviation that is named: as published 14 units of the last digit above print."
    )
