"""Bounds and words of the paper: what is printed decides, on both sides of a bound."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claims.published import Row
from dampbalance.replication.claims.rules import bound_holds, word_holds


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
