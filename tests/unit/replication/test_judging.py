"""A claim: its verdict and how far its routes are off, in words that can be checked by hand; its tolerances, each from
elsewhere than the number it judges; and statements, of which the print decides."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claim_verdicts import PROPAGATED, READING, UNEXPLAINED
from dampbalance.replication.claims.judging import (
    WRITTEN,
    Tolerance,
    explanation,
    phase_read,
    propagated,
    simulated,
    velocity_read,
    verdict,
)
from dampbalance.replication.claims.published import Printed, Row
from dampbalance.replication.claims.rules import bound_holds, word_holds
from paper.routes import CASE, claim

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


# ---- Tolerances: none that a wrong rebuild widens ------------------------------------------------------------------

OMEGA = 2.0 * math.pi * 4.92


def verdict_of(tolerances, value):
    return next((t.verdict for t in tolerances if t.low <= value <= t.high), None)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("tolerances", "middle", "step", "words"),
    [
        (phase_read(Printed("1.522"), OMEGA), 1.522, OMEGA * 1e-4, "0.1 ms"),
        # the velocity of the first slipping sample, to half a mark
        (velocity_read(Printed("0.01330"), 2e-5), 0.01330 - 2e-5, 2.5e-5, "0.05 mm/s"),
    ],
    ids=["phase", "velocity"],
)
def test_what_was_read_lies_within_its_resolution(side, tolerances, middle, step, words):
    for off, expected in ((0.99, READING), (1.01, UNEXPLAINED), (1.99, UNEXPLAINED), (2.01, None)):
        assert verdict_of(tolerances, middle + side * off * step) is expected
    assert words in tolerances[0].reason
    assert "nothing says why" in tolerances[1].reason


def test_a_range_that_print_leaves_is_one_of_the_rebuilt_number_itself():
    (tolerance,) = propagated((1.2798, 1.2802), Printed("1.280"))
    assert tolerance.verdict is PROPAGATED
    # not 1.2797, though print would round it to the same digits
    assert (tolerance.low, tolerance.high) == (1.2798, 1.2802)
    assert propagated(None, Printed("1.280")) == ()


@pytest.mark.parametrize(
    ("printed", "reach"),
    [
        ("0.81655453", 10e-8),  # ten units; a step in a period is two hundred times as much
        # a step in a period; ten units are five times as much
        ("0.00072729", 0.00072729 * 4.92 * 5e-6),
    ],
)
def test_what_a_simulation_gives_is_near_within_ten_units_and_a_step_in_a_period(printed, reach):
    (tolerance,) = simulated(Printed(printed), CASE)
    assert tolerance.verdict is UNEXPLAINED
    ends = tolerance.low - float(printed), tolerance.high - float(printed)
    assert ends == pytest.approx((-reach, reach), rel=1e-3)


# ---- Statements -----------------------------------------------------------------------------------------------------


def row(rule: str, printed: str, quantity: str = "") -> Row:
    return Row("name", "where", "", "", quantity, "", printed, "statement", rule)


@pytest.mark.parametrize(
    ("side", "value", "printed", "holds"),
    [
        ("less than", 1.45, "1.4", False),  # the value is not below it
        ("less than", 1.45, "1.5", True),  # rounded
        ("less than", 1.46, "1.6", True),  # one unit looser
        ("less than", 1.46, "1.7", False),  # says too little
        ("less than", 1.44, "1.5", True),  # 1.4, one unit looser
        ("less than", 1.44, "1.6", False),
        ("less than", 1.53, "1.5", False),  # rounded, but not below it
        ("less than", 0.0794, "0.1", True),
        ("less than", 0.0794, "0.3", False),
        ("less than", 66.46, "70", False),  # "less than 70 %" of an error of 66 %
        ("less than", math.nan, "1.5", False),
        ("more than", 66.46, "70", False),
        ("more than", 66.46, "66", True),
        ("more than", 66.46, "65", True),
        ("more than", 66.46, "64", False),
        ("more than", 66.54, "67", False),  # rounded, but not above it
        ("more than", 77.25, "77", True),
        ("more than", 77.25, "76", True),
        ("more than", 77.25, "70", False),
        ("more than", 77.25, "24", False),
    ],
)
def test_a_bound_is_the_rounded_value_or_one_unit_looser(side, value, printed, holds):
    assert bound_holds(row("bound", printed, f"largest error: {side}"), value)[0] is holds


@pytest.mark.parametrize(
    ("rule", "printed", "if_larger"),
    [
        ("change", "degraded", True),
        ("change", "improved", False),
        ("truth", "false", True),
        ("truth", "true", False),
    ],
)
def test_the_printed_word_decides(rule, printed, if_larger):
    for one, other in ((19.6, 1.5), (1.0, 1.5)):
        assert word_holds(row(rule, printed), one, other)[0] is ((one > other) == if_larger)
