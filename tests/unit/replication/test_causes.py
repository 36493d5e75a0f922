"""Why a number differs: each cause from numbers worked out by hand, named where it explains and not elsewhere."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from dampbalance.replication.claims import causes
from paper.routes import CASE, PRINT

LABELS = ["1-2", "2-3", "3-4", "4-5", "1-5"]


def test_an_input_is_held_to_all_its_digits():
    assert causes.held(1.28, "1.280") == "The configuration holds this value."
    assert causes.held(1.2801, "1.28") == "The configuration holds 1.2801, the paper states 1.28."


def test_backward_euler_adds_m_omega_squared_h():
    values = {"exact": 2.0, "as_published": 2.0002}
    effective = 90.0 + 2.42 * (2.0 * math.pi * 4.92) ** 2 * 5e-6
    assert causes.backward_euler(CASE, values) == (
        f"Backward Euler, 5 µs: c acts as c + mω²h = {effective:.4f}; as published lies +1.0e-04 of itself from exact."
    )
    other = replace(CASE, numerics=replace(CASE.numerics, scheme="rk4"))
    assert causes.backward_euler(other, values) == ""
    assert causes.backward_euler(CASE, {"exact": 2.0, "as_published": math.nan}) == ""
    assert causes.backward_euler(CASE, {"exact": 0.0, "as_published": 1.0}) == ""


@pytest.mark.parametrize("level", ["1", "4"])
def test_the_b_that_a_pair_implies_is_as_sharp_as_what_is_printed(level):
    """b = (W − a F_k)/c over all corners of the rounding of a, W, F_k and c, and half a unit of b itself."""
    b, a, W = (PRINT[f"table2.{symbol}.{level}"] for symbol in "baW")
    implied = causes._implied(PRINT, level, LABELS)
    for label, (value, slack) in zip(LABELS, implied, strict=True):
        F_k, c = (PRINT[f"table2.{symbol}.{label}"] for symbol in ("F_k", "c"))
        corners = [
            (W.value + w * W.unit - (a.value + x * a.unit) * (F_k.value + f * F_k.unit))
            / (c.value + d * c.unit)
            for w, x, f, d in itertools.product((-0.5, 0.5), repeat=4)
        ]
        assert value == pytest.approx(sum(corners) / len(corners), rel=1e-9)
        # products of two roundings, 1e-6 of the first
        furthest = max(corners) - value + 0.5 * b.unit
        assert slack == pytest.approx(furthest, rel=1e-3)


@pytest.mark.parametrize(
    ("units", "said"), [(0, ""), (3, "It contradicts Table 2 itself: "), (-3, "It ")]
)
def test_a_printed_b_that_its_own_pairs_refute_is_a_contradiction(units, said):
    moved = PRINT.changed({"table2.b.3": PRINT["table2.b.3"].moved(units)})
    note, evidence = causes.implied_b(moved, "3")
    assert note == ""
    assert evidence.startswith(said)
    assert bool(evidence) == bool(said)
    assert not said or "the printed pairs 2-3 and 3-4 give b = 0.00356" in evidence


def test_a_b_that_the_other_pairs_do_not_want_is_noted():
    note, evidence = causes.implied_b(PRINT, "1")
    assert evidence == ""
    assert note.startswith("The printed pairs 1-2 and 1-5 were computed with b_1 = 0.0007272")
    assert "the others want 0.0007272" in note


def test_the_papers_own_inputs_may_contradict_what_it_prints():
    assert causes.printed_inputs_differ({"from_print": 90.04025}, "90.0402") == ""
    assert causes.printed_inputs_differ({"from_print": 90.05}, "90.0402") == (
        "It contradicts the paper's own inputs, which give 90.05000000."
    )


def test_a_time_is_read_between_the_first_and_the_last_sample():
    words = causes.slip_time(2.984e-3, 5e-6, "2.9E-3")
    assert "lasts 2.984 ms, without a step of 5 µs at each end 2.974 ms" in words
    assert causes.slip_time(2.904e-3, 5e-6, "2.9E-3") == ""  # 2.894 ms: tenths would be 2.8
    assert causes.slip_time(3.009e-3, 5e-6, "2.9E-3") != ""
    assert causes.slip_time(3.011e-3, 5e-6, "2.9E-3") == ""
    assert causes.slip_time(math.nan, 5e-6, "2.9E-3") == ""


def test_a_velocity_is_read_to_half_a_division():
    read = "Read at the corner of the acceleration-velocity plot: the first slipping sample has "
    assert causes.slip_velocity(0.0113, "0.01135") == (
        f"{read}11.300 mm/s, to the nearest 0.05 mm/s 11.30, not as printed."
    )
    assert causes.slip_velocity(0.01134, "0.01135") == (
        f"{read}11.340 mm/s, to the nearest 0.05 mm/s 11.35, as printed."
    )
    assert causes.slip_velocity(math.nan, "0.01135") == ""


def test_the_phase_is_the_nearer_of_the_two():
    assert causes.phase(1.54, 1.57, "1.541") == (
        "It is the phase of the velocity reversal (+0.0010 rad), not of the zero crossing that the text names "
        "(-0.0290 rad)."
    )
    assert causes.phase(1.57, 1.54, "1.541") == ""
    assert causes.phase(math.nan, 1.54, "1.541") == ""


def test_the_slip_of_sign_is_where_the_two_roots_differ():
    slip = causes.sign({"as_published": 1.3}, 1.29431, "N", "They share X.")
    assert slip.endswith("it would be 1.2943 N. They share X.")
    assert "be 90.023 N s/m." in causes.sign({"as_published": 90.1}, 90.0231, "N s/m", "")
    assert causes.sign({"as_published": 1.3}, 1.3, "N", "They share X.") == ""
    assert causes.sign({"as_published": 1.3}, math.nan, "N", "They share X.") == ""


def test_the_proof_of_the_sign_states_its_premise():
    misfits = {"plus": 0.4, "minus": 4.03, "minus alone": 0.34}
    assert causes.premise_of_sign(misfits) == (
        "Where the columns share X and phi, print excludes the minus (4.0 units off at best; the plus 0.4); "
        "the V_s columns alone do not (0.34)."
    )


def test_where_an_integral_begins():
    numerics = CASE.numerics
    for place in range(5):
        count = numerics.after_slip(place)
        samples = "a sample" if count == 1 else f"{count} samples"
        assert causes.starting_sample(CASE, place) == (
            f"Begun {samples} after slip is seen, in the cycle that starts in period {numerics.cycles - 2}."
        )


def test_a_number_outside_what_its_table_allows():
    allowed = (1.274, 1.286)
    for printed in ("1.27", "1.28", "1.29"):  # within half a unit of the range
        assert causes.outside(allowed, printed, "Table 2") == ""
    assert causes.outside(None, "1.30", "Table 2") == ""
    words = "The rest of Table 2, within its rounding, allows 1.27400 to 1.28600 only."
    for printed in ("1.273", "1.287"):
        assert causes.outside(allowed, printed, "Table 2") == words


def test_how_far_printed_inputs_move_a_result():
    words = causes.printed_inputs({"from_print": 1.2850, "exact": 1.2889}, "Table 1", "1.285022")
    assert words == "Table 1, as printed, move it by -0.003900 from exact."
    words = causes.printed_inputs({"from_print": 90.05, "exact": 90.04}, "Table 1", "90.0402")
    assert words == "Table 1, as printed, move it by +0.0100 from exact."
    assert causes.printed_inputs({"from_print": math.nan, "exact": 1.0}, "Table 1", "1.0") == ""


@pytest.mark.parametrize(
    ("value", "printed", "is_cut"),
    [(90.040254, "90.0402", True), (90.040244, "90.0402", False), (90.04034, "90.0402", False)],
)
def test_digits_cut_off_are_those_that_rounding_would_change(value, printed, is_cut):
    assert bool(causes.cut_off(value, printed)) == is_cut


def test_a_pair_without_a_simulated_b_has_no_other():
    """Where a level does not slip, one of the features is missing."""

    def feature(column, level):
        return math.nan if (column, level) == ("b_m2_per_s", 1) else 1e-3 * level

    sources = SimpleNamespace(as_published=SimpleNamespace(feature=feature), published=PRINT)
    allowed = {f"table2.b.{level}": (1e-3, 2e-3) for level in (1, 2)}
    assert causes.other_b(sources, allowed, SimpleNamespace(line="1-2")) == ""
