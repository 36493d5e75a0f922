"""What each number is worth, and what limits it: decided once, said once."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dampbalance.balance import Rows
from dampbalance.identification.limits import Limit, limits, shown
from dampbalance.identification.notes import forbidden, with_notes
from dampbalance.identification.oscillator import Whole
from dampbalance.identification.result import ApproachResult, Interval, ParameterEstimate
from dampbalance.identification.showing import with_interval
from dampbalance.identification.verdicts import in_one, verdicts_of
from dampbalance.project.wording import listed, times

NOTHING = ParameterEstimate(math.nan, math.nan, math.nan, Interval(math.nan, math.nan))


def parameter(value, half):
    return ParameterEstimate(value, half / 2.0, half / 2.0, Interval(value - half, value + half))


SOUND = ApproachResult(
    approach="direct",
    coefficients={"F_k": parameter(1.28, 0.01), "c": parameter(90.0, 0.1)},
    equal={"F_k": parameter(1.28, 0.02), "c": parameter(90.0, 0.2)},
    K_z=parameter(208e3, 2e3),
    shape_bias={},
    correlations={},
    residual=1e-4,
    misfit=1.0,
    rows=Rows({"F_k": np.ones(2), "c": np.ones(2)}, np.ones(2)),
    row_errors=np.ones(2),
)


def words(estimated):
    return {s: v.verdict for s, v in verdicts_of(estimated).items()}


def test_sound_numbers_are_usable_without_a_reason():
    verdicts = verdicts_of(SOUND)
    assert list(verdicts) == ["F_k", "c", "K_z"]
    assert {(v.verdict, v.reason) for v in verdicts.values()} == {("usable", "")}
    assert in_one(verdicts) == "usable"


def test_a_note_makes_every_number_of_its_approach_doubtful():
    noted = verdicts_of(replace(SOUND, notes=("off by 16 %",)))
    assert {(v.verdict, v.reason) for v in noted.values()} == {("doubtful", "off by 16 %")}
    assert in_one(noted) == "doubtful"


def test_a_number_that_is_not_there_has_the_reason():
    without = verdicts_of(replace(SOUND, K_z=NOTHING))
    assert in_one(without) == "usable: F_k, c; none: K_z"
    assert "do not tell K_z" in without["K_z"].reason
    nothing = {"F_k": NOTHING, "c": NOTHING}
    unsolved = replace(SOUND, coefficients=nothing, K_z=NOTHING, notes=("needs two levels",))
    assert {tuple(v) for v in verdicts_of(unsolved).values()} == {("none", "needs two levels")}


@pytest.mark.parametrize(("half", "verdict"), [(0.63, "usable"), (0.65, "doubtful")])
def test_an_interval_wider_than_the_value_is_a_reason(half, verdict):
    wide = replace(SOUND, coefficients={**SOUND.coefficients, "F_k": parameter(1.28, half)})
    assert words(wide) == {"F_k": verdict, "c": "usable", "K_z": "usable"}


def test_a_lower_limit_is_doubtful_and_says_the_limit():
    limit = ParameterEstimate(math.inf, math.nan, math.nan, Interval(41234.5, math.inf))
    verdict = verdicts_of(replace(SOUND, K_z=limit))["K_z"]
    assert verdict.verdict == "doubtful"
    assert "above 4.123e+04 N/m" in verdict.reason


SOURCES = ["data/a.csv", "data/b.csv", "data/c.csv"]


def identified(warnings=(), notes=None, sources=SOURCES):
    readings = tuple(SimpleNamespace(steady=SimpleNamespace(source=s)) for s in sources)
    estimates = {name: replace(SOUND, notes=of) for name, of in (notes or {}).items()}
    whole = Whole(fit=None, linear=False, delayed=None)
    return SimpleNamespace(
        readings=readings, warnings=tuple(warnings), estimates=estimates, whole=whole
    )


def sentences(**given):
    return [shown(limit, given.get("sources", SOURCES)) for limit in limits(identified(**given))]


def test_the_same_warning_on_several_records_is_one_sentence_with_its_range():
    drift = "{}: drifts by {} % in {} s: let it warm up"
    said = [drift.format(SOURCES[0], 3.5, 20), drift.format(SOURCES[1], "1e-05", 20)]
    assert sentences(warnings=said) == [
        "a.csv and b.csv: drifts by 1e-05 to 3.5 % in 20 s: let it warm up"
    ]
    said.append(drift.format(SOURCES[2], -2, 20))
    assert sentences(warnings=said) == [
        "all 3 records: drifts by -2 to 3.5 % in 20 s: let it warm up"
    ]


def test_different_warnings_stay_apart_and_names_keep_their_numbers():
    said = [f"{SOURCES[0]}: acc1 is clipped", f"{SOURCES[0]}: acc2 is clipped", "too alike"]
    assert sentences(warnings=said) == [
        "a.csv: acc1 is clipped",
        "a.csv: acc2 is clipped",
        "too alike",
    ]


def test_factors_beyond_a_thousand_go_into_the_range():
    said = [
        f"{s}: {times(x)} worse" for s, x in zip(SOURCES, (450.2, 3883747.0, 12.4), strict=True)
    ]
    assert sentences(warnings=said) == ["all 3 records: 12 to more than 1000 times worse"]


def test_records_of_one_name_are_told_apart_by_their_folders():
    sources = ["one/a.csv", "two/a.csv", "three/b.csv"]
    said = [f"{source}: clipped" for source in sources[:2]]
    assert sentences(warnings=said, sources=sources) == ["one/a.csv and two/a.csv: clipped"]


def test_many_records_are_counted():
    sources = [f"{i}.csv" for i in range(20)]
    said = [f"{source}: clipped" for source in sources[:9]]
    assert sentences(warnings=said, sources=sources) == [
        "9 of 20 records (0.csv, 1.csv, 2.csv, 3.csv, 4.csv …): clipped"
    ]


def test_notes_of_approaches_go_together():
    found = limits(identified(notes={"X_s": ("F_k by -16 %",), "t_s": ("F_k by -17 %",)}))
    assert found == [Limit("approaches", ("X_s", "t_s"), "F_k by -17 to -16 %")]


def test_words_in_a_row():
    assert [listed(["a", "b", "c"][:n]) for n in (1, 2, 3)] == ["a", "a and b", "a, b and c"]
    assert listed(["a", "b"], "or") == "a or b"


@pytest.mark.parametrize(
    ("factor", "said"),
    [(1.44, "1.4 times"), (99.6, "100 times"), (450.2, "450 times"), (1e9, "more than 1000 times")],
)
def test_a_factor_in_words(factor, said):
    assert times(factor) == said


def read(source, **clipped):
    """A reading of channels that are clipped in these parts of their cycles."""
    channels = {quantity: SimpleNamespace(clipped=part) for quantity, part in clipped.items()}
    return SimpleNamespace(steady=SimpleNamespace(source=source, channels=channels))


def test_a_coefficient_that_physics_forbids_is_named_with_the_likely_cause():
    negative = replace(SOUND, coefficients={"F_k": parameter(-0.1, 0.2), "c": parameter(-6.0, 1.0)})
    linear = Whole(None, True, None)
    for readings, cause in (
        ([read("a", force=0.0)], "a sign, a gain, a channel or the stiffness may be wrong"),
        (
            [read("a", force=0.2, velocity=0.9), read("b", velocity=1.0)],
            "clipping is the likely cause (velocity of a and velocity of b); raise the measuring range",
        ),
    ):
        first, *_ = with_notes({"direct": negative}, readings, linear)["direct"].notes
        assert first == f"c = -6 N s/m is negative, which physics forbids: {cause}"
    assert forbidden(SOUND.coefficients, [], "all") == []


@pytest.mark.parametrize(
    ("value", "half", "expected"),
    [
        (1.2785, 0.0039, "1.2785 [1.2746, 1.2824]"),
        (207_400.0, 1650.0, "207400 [205800, 209000]"),
        (0.001, 2e-6, "0.0010000 [0.0009980, 0.0010020]"),
        (2.94e-24, 1e-67, "2.94e-24 [2.94e-24, 2.94e-24]"),
        (2.9e-24, 1e-26, "2.900e-24 [2.890e-24, 2.910e-24]"),
        (1e300, 2e299, "1.00e+300 [8.0e+299, 1.20e+300]"),
        (1e12, 1.0, "1.000000e+12 [1.000000e+12, 1.000000e+12]"),
        (5.0, 1e15, "0 [-1.0e+15, 1.0e+15]"),
        (0.0, 5e-324, "0 [-4.9e-324, 4.9e-324]"),
    ],
)
def test_a_number_of_any_size_fits_its_cell(value, half, expected):
    assert with_interval(parameter(value, half)) == expected
