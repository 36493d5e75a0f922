"""Why a number differs: each cause from numbers worked out by hand, named where it explains and not elsewhere."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pandas as pd
import pytest

from dampbalance.replication.claims import RouteTables, causes
from dampbalance.replication.claims.of_text import held
from dampbalance.replication.claims.sources import Sources
from dampbalance.replication.printed import Printed
from paper.routes import CASE, PRINT

NO_ROUTE = RouteTables({}, {})
SOURCES = Sources(PRINT, CASE, NO_ROUTE, NO_ROUTE, pd.DataFrame())
LABELS = ["1-2", "2-3", "3-4", "4-5", "1-5"]


def test_an_input_is_held_to_all_its_digits():
    row = PRINT.rows["parameter.F_k"]
    for F_k, words in (
        (1.28, "The configuration holds this value."),
        (1.2801, "The configuration holds 1.2801, the paper states 1.28."),
    ):
        osc = replace(CASE.oscillator, F_k=F_k)
        assert held(replace(SOURCES, case=replace(CASE, oscillator=osc)), row).cause == words


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
    number = Printed("90.0402")
    assert causes.printed_inputs_differ({"from_print": 90.04025}, number) == ""
    assert causes.printed_inputs_differ({"from_print": 90.05}, number) == (
        "It contradicts the paper's own inputs, which give 90.05000000."
    )


@pytest.mark.parametrize(
    ("t_s", "explained"),
    [
        (2.984e-3, True),
        (2.904e-3, False),  # 2.894 ms: tenths would be 2.8
        (3.009e-3, True),
        (3.011e-3, False),
        (math.nan, False),
    ],
)
def test_a_time_is_read_between_the_first_and_the_last_sample(t_s, explained):
    words = causes.slip_time(t_s, 5e-6, Printed("2.9E-3"))
    inside = (
        f"lasts {1e3 * t_s:.3f} ms, without a step of 5 µs at each end {1e3 * t_s - 0.01:.3f} ms"
    )
    assert (inside in words) == bool(words) == explained


def test_a_velocity_is_read_to_half_a_division():
    read = "Read at the corner of the acceleration-velocity plot: the first slipping sample has "
    for sample, words in (
        (0.0113, f"{read}11.300 mm/s, to the nearest 0.05 mm/s 11.30, not as printed."),
        (0.01134, f"{read}11.340 mm/s, to the nearest 0.05 mm/s 11.35, as printed."),
        (math.nan, ""),
    ):
        assert causes.slip_velocity(sample, Printed("0.01135")) == words


def test_the_phase_is_the_nearer_of_the_two():
    number = Printed("1.541")
    assert causes.phase(1.54, 1.57, number) == (
        "It is the phase of the velocity reversal (+0.0010 rad), not of the zero crossing that the text names "
        "(-0.0290 rad)."
    )
    assert causes.phase(1.57, 1.54, number) == causes.phase(math.nan, 1.54, number) == ""


def test_the_slip_of_sign_is_where_the_two_roots_differ_and_states_its_premise():
    misfits = {"plus": 0.4, "minus": 4.03, "minus alone": 0.34}
    premise = (
        "Where the columns share X and phi, print excludes the minus (4.0 units off at best; the plus 0.4); "
        "the V_s columns alone do not (0.34)."
    )
    assert causes.sign(1.3, 1.29431, "N", misfits).endswith(f"it would be 1.2943 N. {premise}")
    assert "be 90.023 N s/m. Where" in causes.sign(90.1, 90.0231, "N s/m", misfits)
    for correct in (1.3, math.nan):
        assert causes.sign(1.3, correct, "N", misfits) == ""


def test_where_an_integral_begins():
    numerics = CASE.numerics
    for level, count in enumerate(numerics.slip_samples, 1):
        samples = "a sample" if count == 1 else f"{count} samples"
        assert causes.starting_sample(CASE, level) == (
            f"Begun {samples} after slip is seen, in the cycle that starts in period {numerics.cycles - 2}."
        )


def test_a_number_outside_what_its_table_allows():
    allowed = (1.274, 1.286)
    words = "The rest of Table 2, within its rounding, allows 1.27400 to 1.28600 only."
    for printed, said in (
        *(("1.27", ""), ("1.28", ""), ("1.29", "")),  # within half a unit of the range
        *(("1.273", words), ("1.287", words)),
    ):
        assert causes.outside(allowed, Printed(printed), "Table 2") == said
    assert causes.outside(None, Printed("1.30"), "Table 2") == ""


@pytest.mark.parametrize(
    ("from_print", "exact", "printed", "words"),
    [
        (1.2850, 1.2889, "1.285022", "Table 1, as printed, move it by -0.003900 from exact."),
        (90.05, 90.04, "90.0402", "Table 1, as printed, move it by +0.0100 from exact."),
        (math.nan, 1.0, "1.0", ""),
    ],
)
def test_how_far_printed_inputs_move_a_result(from_print, exact, printed, words):
    values = {"from_print": from_print, "exact": exact}
    assert causes.printed_inputs(values, "Table 1", Printed(printed)) == words


@pytest.mark.parametrize(
    ("value", "is_cut"), [(90.040254, True), (90.040244, False), (90.04034, False)]
)
def test_digits_cut_off_are_those_that_rounding_would_change(value, is_cut):
    assert bool(causes.cut_off(value, Printed("90.0402"))) == is_cut
