"""A claim: its verdict and how far its routes are off, in words that can be checked by hand; its tolerances, each from
elsewhere than the number it judges; and statements, of which the print decides."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from dampbalance.replication.claims import judging
from dampbalance.replication.claims.judging import WRITTEN, Claim, Tolerance
from dampbalance.replication.claims.printed import Printed, Row
from dampbalance.replication.claims.rules import bound_holds, word_holds
from dampbalance.replication.claims.verdicts import PROPAGATED, READING, ROUTE_NAMES, UNEXPLAINED
from dampbalance.replication.numbers import Key
from paper_case import OMEGA
from replication.routes import CASE, PRINT

NEAR = Tolerance(1.26, 1.30, "read so", READING)
WIDE = Tolerance(1.2, 1.4, "the cause is unknown", UNEXPLAINED)
ELSEWHERE = {"exact": 1.28, "expected": {"as_published": 1.325}}
READ = {"route": "as_published", "half_unit": math.nan, "tolerances": (NEAR,)}
"""A column that was read more coarsely than it is printed: the digits of its own route say nothing."""
FAR = {"exact": 1.28, "as_published": 1.2865}
EXPLAINED = {"exact": 1.31, "tolerances": (WIDE,), "cause": "So read."}
REFUTED = {"contradiction": "The mean needs 1.31."}


def claim(printed: str, **parts) -> Claim:
    """A claim on some number.   parts : values by route and fields of Claim."""
    values = {route: parts.pop(route) for route in ROUTE_NAMES if route in parts}
    return Claim(
        Row("id", "", Key("", "F_k", unit="N"), "", printed, "computed", ""), values, **parts
    )


def by_authors(value: float, **parts: object) -> dict[str, object]:
    return {"route": "as_published", "as_published": value, **parts}


def by_print(value: float) -> dict[str, object]:
    return {"route": "from_print", "from_print": value}


@pytest.mark.parametrize(
    ("printed", "parts", "expected"),
    [
        ("1.28", {"exact": 1.2849}, "reproduced"),
        ("1.28", {"exact": 1.275}, "reproduced"),  # half a unit away: rounds either way
        ("1.28", by_authors(1.2801), "simulated"),
        ("1.28", by_print(1.2849), "from print"),
        ("1.28", {"exact": 1.2949}, "last digit"),
        ("1.28", {"exact": 1.2951, "tolerances": (NEAR,)}, "reading"),
        ("1.28", {"exact": 1.3001, "tolerances": (NEAR,)}, "differs"),
        ("1.28", {"exact": math.nan, "tolerances": (NEAR,)}, "differs"),
        # the best verdict that holds, however the column came about
        ("1.280", by_authors(1.283, exact=1.28), "reproduced"),
        ("1.280", by_authors(1.28, exact=1.282, from_print=1.28), "simulated"),
        ("1.280", by_authors(1.2807, exact=1.282, from_print=1.28), "from print"),
        ("1.280", by_authors(1.282, exact=1.2807), "differs"),
        ("1.280", by_authors(1.282, exact=1.28, shown_only=("exact",)), "differs"),
        # then its own route must not be far off either, nor the best one from where it belongs
        ("1.280", by_authors(1.2865, exact=1.28), "differs"),
        ("1.6", by_authors(1.6, exact=1.626, expected={"exact": 1.642}), "differs"),
        # another route must not be far off: half a per cent of 1.280 is 0.0064
        ("1.280", FAR | {"as_published": 1.2863}, "reproduced"),
        ("1.280", FAR, "differs"),
        ("1.280", FAR | {"shown_only": ("as_published",)}, "reproduced"),
        ("1.280", ELSEWHERE | {"as_published": 1.33}, "reproduced"),
        ("1.280", ELSEWHERE | {"as_published": 1.34}, "differs"),
        ("1.28", READ | {"as_published": 1.28}, "reading"),
        ("1.28", READ | {"as_published": 1.31}, "differs"),
        ("1.28", READ | {"as_published": 1.284, "exact": 1.2801}, "reproduced"),
        # what a route writes itself must be the same
        ("2.9E-3", {"exact": 2.9e-3, "half_unit": WRITTEN}, "reproduced"),
        ("2.9E-3", {"exact": 2.901e-3, "half_unit": WRITTEN}, "differs"),
        # one unit of two digits is no near miss, nor where print shows what was rounded
        ("1.3", {"exact": 1.4}, "differs"),
        ("1.28", {"exact": 1.29, "allowed": (1.27, 1.286)}, "last digit"),
        ("1.28", {"exact": 1.29, "allowed": (1.279, 1.2799)}, "differs"),
        # the best tolerance that holds decides
        ("1.28", {"exact": 1.31, "tolerances": (NEAR, WIDE)}, "unexplained"),
        ("1.28", {"exact": 1.41, "tolerances": (NEAR, WIDE)}, "differs"),
        # what the paper itself refutes differs whatever the routes give
        ("1.28", {"exact": 1.2801, "contradiction": "1.29 only."}, "differs"),
        # statements; a route that is silent supports none
        ("less", {"holds": True, "exact": 1.0}, "reproduced"),
        ("less", by_authors(1.0, exact=1.0, holds=False, undecided=True), "undecided"),
        ("less", by_authors(math.nan, exact=1.0, holds=False, undecided=True), "differs"),
        ("less", by_authors(1.0, exact=1.0, holds=False), "differs"),
        ("less", by_authors(math.nan, exact=1.0, holds=True), "differs"),
    ],
)
def test_a_number_earns_its_verdict_by_the_route_that_judges(printed, parts, expected):
    made = claim(printed, **parts)
    assert judging.verdict(made).name == expected
    assert "holds" in parts or judging.explanation(made)


def test_routes_are_those_that_give_a_number():
    made = claim("1.28", from_print=1.3, exact=1.2, as_published=math.nan)
    assert made.routes == ["exact", "from_print"]
    assert (made.show("as_published"), made.show("exact")) == ("", "1.200000")
    assert (made.off("exact"), made.off("from_print")) == pytest.approx((-8.0, 2.0))
    assert made.off_relative("exact") == pytest.approx(-0.0625)


NOTHING = "It exceeds every bound, and no other number of the paper contradicts the print."
ABOVE, BELOW = (f"of the last digit {side} print" for side in ("above", "below"))
TWO = by_authors(1.2801, exact=1.283)
CHANCE = by_authors(1.285, exact=1.28)


@pytest.mark.parametrize(
    ("printed", "parts", "words"),
    [
        # a distance is in units of the last digit if there are few
        ("1.28", {"exact": 1.299}, f"Exact: 1.9 units {ABOVE}. {NOTHING}"),
        ("1.28", {"exact": 1.29}, f"Exact: 1 unit {ABOVE}."),
        ("1.000", {"exact": 1.025}, f"Exact: 2.5 % above print. {NOTHING}"),
        ("1.000", {"exact": 0.9}, f"Exact: 10 % below print. {NOTHING}"),
        # the route of the column is named however close another comes, unless that one decides
        ("1.280", CHANCE | {"exact": 1.283}, f"As published: 5 units {ABOVE}. {NOTHING}"),
        ("1.280", CHANCE, f"Exactly 1.2800000, .* chance: .* 5 units {ABOVE}."),
        (
            "1.280",
            by_authors(1.283, from_print=1.28),
            "Obtained from print. .* chance: .* 3 units .*",
        ),
        # digits that are obtained say by what
        ("1.28", {"exact": 1.2801}, "Exactly 1.280100, which rounds to 1.28."),
        ("1.280", TWO, rf"Obtained as published \(exact: 3 units {ABOVE}\)."),
        (
            "1.280",
            TWO | {"exact": 1.2799},
            "Exactly 1.2799000, .*, which gives the digits as well.",
        ),
        ("1.28", by_authors(1.2801), "Obtained as published."),
        # a last digit needs no tolerance and another does
        ("1.28", EXPLAINED | {"exact": 1.294}, f"Exact: 1.4 units {ABOVE}. So read."),
        ("1.28", EXPLAINED, f"Exact: 3 units {ABOVE}; the cause is unknown. So read."),
        # what differs is contradicted by the paper, or says that it is not
        ("1.28", REFUTED | {"exact": 1.31}, f"Exact: 3 units {ABOVE}. The mean needs 1.31."),
        ("1.280", REFUTED | CHANCE, f"As published: 5 units {ABOVE}. The mean.*"),
        ("1.28", {}, "The route “exact” gives no number."),
        ("1.280", FAR, f"Exact: 0 units {BELOW}. More .*: as published 6.5 units {ABOVE}."),
    ],
)
def test_an_explanation_says_how_far_off_and_why(printed, parts, words):
    said = judging.explanation(claim(printed, **parts))
    assert re.fullmatch(words, said), said


# ---- Tolerances: none that a wrong rebuild widens ------------------------------------------------------------------


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_phase_lies_within_its_resolution(side):
    tolerances = judging.phase_read(Printed("1.522"), OMEGA)
    verdicts = {0.0499: READING, 0.0501: UNEXPLAINED, 0.199: UNEXPLAINED, 0.201: None}
    for ms, expected in verdicts.items():
        value = 1.522 + side * OMEGA * 1e-3 * ms
        within = (t.verdict for t in tolerances if t.low <= value <= t.high)
        assert next(within, None) is expected
    assert "0.05 ms" in tolerances[0].reason
    assert "the cause is unknown" in tolerances[1].reason


def on_marks(values, half_units, unit):
    """Whether each printed value may be a whole multiple of a unit, within its rounding."""
    off = np.abs(values - unit * np.round(values / unit))
    return (off <= half_units * (1.0 + 1e-9)).tolist()


def test_the_units_of_reading_are_the_coarsest_that_print_allows():
    """φ/ω of the five levels are multiples of 0.05 ms, as rounded, and not of anything coarser; of the velocities,
    levels 2 to 5 are multiples of 0.05 mm/s, the first is not, and nothing coarser than their last digit suits all."""
    times, half = PRINT.values("phi") / OMEGA, 0.5e-3 / OMEGA
    assert all(on_marks(times, half, judging.PHASE_UNIT_S))
    assert not any(all(on_marks(times, half, coarser)) for coarser in (1e-4, 2e-4, 5e-4))
    V_s, rounding = PRINT.values("V_s"), 1e-12
    assert on_marks(V_s, rounding, judging.VELOCITY_MARK) == [False, True, True, True, True]
    assert not any(all(on_marks(V_s, rounding, coarser)) for coarser in (2e-5, 1e-4))
    assert all(on_marks(V_s, rounding, 1e-5))


def test_a_range_that_print_leaves_is_one_of_the_rebuilt_number_itself():
    (tolerance,) = judging.propagated((1.2798, 1.2802), Printed("1.280"))
    # not 1.2797, though print would round it to the same digits
    assert (tolerance.low, tolerance.high, tolerance.verdict) == (1.2798, 1.2802, PROPAGATED)
    assert judging.propagated(None, Printed("1.280")) == ()


@pytest.mark.parametrize(
    ("printed", "reach"),
    [
        ("0.81655453", 10e-8),  # ten units; a step in a period is two hundred times as much
        ("0.00072729", 0.00072729 * 4.92 * 5e-6),  # a step in a period; ten units are five times it
    ],
)
def test_what_a_simulation_gives_is_near_within_ten_units_and_a_step_in_a_period(printed, reach):
    (tolerance,) = judging.simulated(Printed(printed), CASE)
    assert tolerance.verdict is UNEXPLAINED
    ends = tolerance.low - float(printed), tolerance.high - float(printed)
    assert ends == pytest.approx((-reach, reach), rel=1e-3)


# ---- Statements -----------------------------------------------------------------------------------------------------


def row(rule: str, printed: str, quantity: str = "") -> Row:
    return Row("name", "where", Key(), quantity, printed, "statement", rule)


@pytest.mark.parametrize(
    ("side", "value", "printed", "holds"),
    [
        ("less than", 1.45, "1.4", False),  # the value is not below it
        ("less than", 1.45, "1.5", True),  # rounded
        ("less than", 1.46, "1.6", True),  # one unit looser
        ("less than", 1.46, "1.7", False),  # says too little
        ("less than", 1.53, "1.5", False),  # rounded, but not below it
        ("less than", math.nan, "1.5", False),
        ("more than", 66.46, "70", False),
        ("more than", 66.46, "65", True),
        ("more than", 66.46, "64", False),
        ("more than", 66.54, "67", False),  # rounded, but not above it
    ],
)
def test_a_bound_is_the_rounded_value_or_one_unit_looser(side, value, printed, holds):
    assert bound_holds(row("bound", printed, f"largest error: {side}"), value)[0] is holds


@pytest.mark.parametrize(
    ("rule", "if_larger", "if_smaller"),
    [("change", "degraded", "improved"), ("truth", "false", "true")],
)
def test_the_printed_word_decides(rule, if_larger, if_smaller):
    for one, larger in ((19.6, True), (1.0, False)):
        assert word_holds(row(rule, if_larger), one, 1.5)[0] is larger
        assert word_holds(row(rule, if_smaller), one, 1.5)[0] is not larger
