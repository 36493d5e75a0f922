"""What a claim says of itself: its verdict, and how far its routes are off, in words that can be checked by hand."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claim_verdicts import READING, UNEXPLAINED
from dampbalance.replication.claims.judging import WRITTEN, Tolerance, explanation, verdict
from paper.routes import claim

NEAR = Tolerance(1.26, 1.30, "read so", READING)
WIDE = Tolerance(1.2, 1.4, "nothing says why", UNEXPLAINED)
ELSEWHERE = {"exact": 1.28, "nearby": {"as_published": 1.325}}
READ = {"reach": math.nan, "tolerances": (NEAR,)}
"""A column that was read off a plot: what is read agrees by chance at best, and has no last digit."""


def by_authors(value: float, **parts: object) -> dict[str, object]:
    return {"route": "as_published", "as_published": value, **parts}


@pytest.mark.parametrize(
    ("printed", "parts", "expected"),
    [
        ("1.28", {"exact": 1.2849}, "reproduced"),
        ("1.28", {"exact": 1.275}, "reproduced"),  # half a unit away: rounds either way
        ("1.28", by_authors(1.2801), "reconstructed"),
        ("1.28", {"route": "from_print", "from_print": 1.2849}, "reconstructed"),
        ("1.28", {"exact": 1.2949}, "last digit"),
        ("1.28", {"route": "from_print", "from_print": 1.2651}, "last digit"),
        ("1.28", {"exact": 1.2951, "tolerances": (NEAR,)}, "reading"),
        ("1.28", {"exact": 1.3, "tolerances": (NEAR,)}, "reading"),
        ("1.28", {"exact": 1.3001, "tolerances": (NEAR,)}, "differs"),
        ("1.28", {"exact": math.nan, "tolerances": (NEAR,)}, "differs"),
        # digits of another route are chance
        ("1.280", by_authors(1.283, exact=1.28), "differs"),
        ("1.280", {"exact": 1.28, "as_published": 1.283}, "reproduced"),
        # another route must not be far off: half a per cent of 1.280 is 0.0064
        ("1.280", {"exact": 1.28, "as_published": 1.2863}, "reproduced"),
        ("1.280", {"exact": 1.28, "as_published": 1.2737}, "reproduced"),
        ("1.280", {"exact": 1.28, "as_published": 1.2865}, "differs"),
        (
            "1.280",
            {"exact": 1.28, "as_published": 1.2865, "apart": ("as_published",)},
            "reproduced",
        ),
        ("1.280", ELSEWHERE | {"as_published": 1.33}, "reproduced"),
        ("1.280", ELSEWHERE | {"as_published": 1.34}, "differs"),
        ("1.28", READ | {"exact": 1.28}, "reading"),
        ("1.28", READ | {"exact": 1.29}, "reading"),
        ("1.28", READ | {"exact": 1.31}, "differs"),
        # what a route writes itself must be the same
        ("2.9E-3", {"exact": 2.9e-3, "reach": WRITTEN}, "reproduced"),
        ("2.9E-3", {"exact": 2.901e-3, "reach": WRITTEN}, "differs"),
        # one unit of two digits is no near miss, nor where print shows what was rounded
        ("1.28", {"exact": 1.29}, "last digit"),
        ("1.3", {"exact": 1.4}, "differs"),
        ("1.28", {"exact": 1.29, "allowed": (1.27, 1.286)}, "last digit"),
        ("1.28", {"exact": 1.29, "allowed": (1.279, 1.2799)}, "differs"),
        # the best tolerance that holds decides
        ("1.28", {"exact": 1.298, "tolerances": (NEAR, WIDE)}, "reading"),
        ("1.28", {"exact": 1.31, "tolerances": (NEAR, WIDE)}, "unexplained"),
        ("1.28", {"exact": 1.41, "tolerances": (NEAR, WIDE)}, "differs"),
        # what the paper itself refutes differs whatever the routes give
        ("1.28", {"exact": 1.2801, "contradiction": "1.29 only."}, "differs"),
        # statements; a route that is silent supports none
        ("less", {"holds": True, "exact": 1.0}, "reproduced"),
        ("less", by_authors(1.0, exact=1.0, holds=True), "reconstructed"),
        ("less", by_authors(1.0, exact=1.0, holds=False), "differs"),
        ("less", by_authors(math.nan, exact=1.0, holds=True), "differs"),
    ],
)
def test_a_number_earns_its_verdict_by_the_route_that_judges(printed, parts, expected):
    made = claim(printed, **parts)
    assert verdict(made).name == expected
    assert "holds" in parts or explanation(made)


def test_routes_are_those_that_give_a_number():
    made = claim("1.28", from_print=1.3, exact=1.2, as_published=math.nan)
    assert made.routes == ["exact", "from_print"]
    assert made.show("as_published") == ""
    assert made.show("exact") == "1.200000"
    assert made.off("exact") == pytest.approx(-8.0)
    assert made.off("from_print") == pytest.approx(2.0)
    assert made.off_relative("exact") == pytest.approx(-0.0625)


def above(units: str) -> str:
    return f"{units} of the last digit above print"


NOTHING = "No bound reaches so far, and no other number of the paper contradicts it."
EXPLAINED = {"exact": 1.31, "tolerances": (WIDE,), "cause": "So read."}


@pytest.mark.parametrize(
    ("printed", "parts", "words"),
    [
        # a distance is in units of the last digit if there are few
        ("1.28", {"exact": 1.299}, f"Exact: {above('1.9 units')}. {NOTHING}"),
        ("1.28", {"exact": 1.261}, f"Exact: 1.9 units of the last digit below print. {NOTHING}"),
        ("1.28", {"exact": 1.47}, f"Exact: {above('19 units')}. {NOTHING}"),
        ("1.000", {"exact": 1.025}, f"Exact: 2.5 % above print. {NOTHING}"),
        ("1.000", {"exact": 0.975}, f"Exact: 2.5 % below print. {NOTHING}"),
        ("1.00", {"exact": 1.25}, f"Exact: 25 % above print. {NOTHING}"),
        ("1.000", {"exact": 0.9}, f"Exact: 10 % below print. {NOTHING}"),
        # the route that judges is named however close another comes
        ("1.280", by_authors(1.285, exact=1.283), f"As published: {above('5 units')}. {NOTHING}"),
        ("1.28", {"exact": 1.29}, f"Exact: {above('1 unit')}."),
        # digits that are obtained say by what
        ("1.28", {"exact": 1.2801}, "Exactly 1.280100, which rounds to 1.28."),
        (
            "1.280",
            by_authors(1.2801, exact=1.283, cause="So read."),
            f"Obtained as published (exact: {above('3 units')}). So read.",
        ),
        (
            "1.280",
            by_authors(1.2801, exact=1.2799),
            "Obtained as published (exact: rounds to print as well, by chance).",
        ),
        ("1.28", by_authors(1.2801), "Obtained as published."),
        # a last digit needs no tolerance and another does
        ("1.28", EXPLAINED | {"exact": 1.294}, f"Exact: {above('1.4 units')}. So read."),
        ("1.28", EXPLAINED, f"Exact: {above('3 units')}; nothing says why. So read."),
        # what differs is contradicted by the paper, or says that it is not
        ("1.28", {"exact": 1.31, "evidence": "W."}, f"Exact: {above('3 units')}. W."),
        (
            "1.28",
            {"exact": 1.31, "evidence": "W.", "contradiction": "The mean needs 1.31."},
            f"Exact: {above('3 units')}. The mean needs 1.31.",
        ),
        ("1.28", {}, "No number exact."),
        (
            "1.280",
            {"exact": 1.28, "as_published": 1.2935},
            "Exact: 0 units of the last digit below print. Too far for the deviation that is named: as published "
            f"{above('14 units')}.",
        ),
    ],
)
def test_an_explanation_says_how_far_off_and_why(printed, parts, words):
    assert explanation(claim(printed, **parts)) == words
