"""Bounds and words of the paper: what is printed decides, on both sides of a bound."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claims.statements import bound, change, truth


@pytest.mark.parametrize(
    ("word", "value", "printed", "holds"),
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
def test_a_bound_is_the_rounded_value_or_one_unit_looser(word, value, printed, holds):
    judged = bound("max", f"largest error: {word}", printed, {"as_published": value})
    assert judged.holds is holds
    assert ("It holds." in judged.how) == holds


def test_one_route_judges_every_statement():
    values = {"exact": 1.45, "as_published": 1.9, "from_print": 1.45}
    assert not bound("max", "less than", "1.5", values).holds
    assert not bound("max", "less than", "1.5", {"exact": 1.45}).holds
    assert not truth("best", "true", {"exact": True, "as_published": False}).holds
    for judged in (
        bound("max", "less than", "1.5", values),
        truth("best", "true", {}),
        change("off", "degraded", {}, {}),
    ):
        assert judged.how.startswith("Judged as published, by ")


def test_a_bound_must_say_on_which_side_it_is():
    with pytest.raises(ValueError, match=r"printed\.csv: max: .*'less than' or 'more than'"):
        bound("max", "largest error", "1.5", {"exact": 1.4})


@pytest.mark.parametrize(("error", "word"), [(19.6, "degraded"), (1.0, "improved")])
def test_the_printed_word_decides(error, word):
    errors, near = {"as_published": error}, {"as_published": 1.5}
    for printed in ("degraded", "improved"):
        assert change("off", printed, errors, near).holds is (printed == word)
    facts = {"as_published": word == "degraded"}
    assert truth("best", "true", facts).holds is (word == "degraded")
    assert truth("best", "false", facts).holds is (word == "improved")


def test_an_unknown_word_is_refused():
    with pytest.raises(
        ValueError, match=r"off: cannot judge the word 'unclear'; known are degraded, improved"
    ):
        change("off", "unclear", {"exact": 1.0}, {"exact": 1.0})
    with pytest.raises(
        ValueError, match=r"best: cannot judge the word 'perhaps'; known are true, false"
    ):
        truth("best", "perhaps", {"exact": True})
