"""What the paper's numbers say of each other: ranges that Table 2 allows, and least squares as checksums."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.balance import Rows
from dampbalance.replication import authors_route as authors
from dampbalance.replication.claims.cross_checks import (
    agrees,
    by_table_2,
    by_table_3,
    misfits,
    refuted,
)
from dampbalance.replication.claims.printed import PAIR_LABELS, PAIRS, Printed
from dampbalance.solver import pair
from replication.routes import CASE, PAPER, PRINT, as_read


@pytest.fixture(scope="module")
def of_print():
    return by_table_2(PRINT)


def rounded(values):
    """The print with other numbers, by id, each with as many decimals as the printed one."""
    return PRINT.changed({id_: f"{value:.{PRINT[id_].decimals}f}" for id_, value in values.items()})


def test_a_table_made_from_more_digits_is_allowed():
    """Table 2 of a known F_k and c, everything rounded as in print: each range holds what was rounded."""
    generator = np.random.default_rng(2010)
    a, b = (PRINT.values(symbol) for symbol in ("a", "b"))
    # digits beyond the printed ones, and errors of W that make the pairs differ as they do in print
    a += 1e-9 * generator.uniform(-0.5, 0.5, 5)
    b += 1e-8 * generator.uniform(-0.5, 0.5, 5)
    W = (1.28 * a + 90.0114 * b) * (1.0 + 3e-7 * generator.standard_normal(5))
    true = {}
    for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True):
        estimate = pair(Rows({"F_k": a, "c": b}, W), i, j)
        true |= {f"table2.{symbol}.{label}": float(estimate[symbol]) for symbol in ("F_k", "c")}
    for symbol, values in (("a", a), ("b", b), ("W", W)):
        true |= {f"table2.{symbol}.{level}": value for level, value in enumerate(values, 1)}
    ranges = by_table_2(rounded(true))
    for name, (low, high) in ranges.items():
        slack, width = {"F": (1e-9, 1e-4), "c": (1e-9, 1e-3), "b": (1e-14, 1.0)}[name[7]]
        assert low - slack <= true[name] <= high + slack, name
        assert high - low < width


def test_the_printed_table_2_agrees_with_itself(of_print):
    assert None not in of_print.values()
    for name, (low, high) in of_print.items():
        printed = PRINT[name]
        assert low <= printed.value + 0.5 * printed.unit
        assert high >= printed.value - 0.5 * printed.unit


def test_a_range_leaves_its_own_print_out(of_print):
    other = by_table_2(PRINT.changed({"table2.F_k.1-5": "1.279990"}))
    assert other["table2.F_k.1-5"] == pytest.approx(of_print["table2.F_k.1-5"], abs=1e-9)
    assert other["table2.F_k.1-2"] is None  # nothing fits the changed one


def test_the_pairs_with_level_1_need_one_b_1_that_the_simulation_does_not_have(of_print):
    low, high = of_print["table2.b.1"]
    assert low == pytest.approx(7.2728872e-4, abs=1e-11)  # print: 7.2729e-4
    assert low > 1.00001 * 7.27278636e-4  # the simulated one
    assert high - low < 5e-10  # twenty times finer than it is printed


def test_the_printed_table_3_agrees_with_itself_and_with_table_1():
    """Thirty numbers of seventeen inputs, all within their rounding, with the plus in the V_s columns."""
    assert by_table_3(PRINT, CASE) == {}


@pytest.mark.parametrize(
    ("name", "step"),
    [("table3.t_s.F_k.2-3", -1), ("table3.X_s.F_k.1-5", +1), ("table3.t_s.c.1-2", +1)],
)
def test_a_changed_digit_of_table_3_is_not_allowed(name, step):
    """The range of the changed number itself does not reach it; of the others some have none left."""
    wrong = Printed(PRINT[name].moved(step))
    ranges = by_table_3(PRINT.changed({name: wrong.text}), CASE)
    low, high = ranges[name]
    nearest = low if step < 0 else high
    assert step * (wrong.value - nearest) > 0.5 * wrong.unit
    assert None in ranges.values()


def test_the_proof_of_the_sign_needs_that_the_columns_share_their_inputs():
    """All columns fit with the plus and miss the minus, by units of the last digit; the V_s columns alone fit both."""
    found = misfits(PRINT, CASE)
    assert found["plus"] == pytest.approx(0.40, abs=0.005)
    assert found["minus"] == pytest.approx(4.03, abs=0.005)
    assert found["minus alone"] == pytest.approx(0.34, abs=0.005)


def test_with_the_minus_that_19_states_nothing_agrees_with_table_3(monkeypatch):
    """The slip of sign follows from print alone: no inputs that round to Table 1 give the V_s columns without it."""
    stated = authors.APPROACHES_OF_TABLE_3["V_s with minus"]
    monkeypatch.setitem(authors.APPROACHES_OF_TABLE_3, "V_s", stated)
    assert set(by_table_3(PRINT, CASE).values()) == {None}


def test_ranges_made_linear_are_those_of_the_equations():
    """Table 3 of known inputs, one digit of it wrong: the range of that number holds what was rounded."""
    features = as_read()["omega1"].two_point
    true = {}
    for approach in ("t_s", "X_s", "V_s"):
        rows = authors.APPROACHES_OF_TABLE_3[approach](features, PAPER.k)
        for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True):
            estimate, start = pair(rows, i, j), f"table3.{approach}"
            true |= {f"{start}.{s}.{label}": float(estimate[s]) for s in ("F_k", "c")}
    made = rounded(true)
    assert by_table_3(made, CASE) == {}
    for label in PAIR_LABELS:
        name = f"table3.t_s.F_k.{label}"
        low, high = by_table_3(made.changed({name: made[name].moved(3)}), CASE)[name]
        slack = 0.01 * (high - low)  # what is left of the curvature
        assert low - slack <= true[name] <= high + slack, label


def test_the_printed_tables_give_the_printed_least_squares():
    assert refuted(PRINT, CASE) == {}


@pytest.mark.parametrize(
    ("name", "right"),
    [
        ("table1.phi.3", "1.550"),
        ("table1.t_s.4", "1.7E-3"),
        ("table2.W.2", "0.19139123"),
        ("table2.a.5", "0.037445013"),
    ],
)
@pytest.mark.parametrize("step", [-3, 1])
def test_a_changed_digit_is_found_and_put_right(name, right, step):
    """An error-locating code: only the changed cell, and only its own digit, restores all that is printed."""
    wrong = PRINT.changed({name: Printed(right).moved(step)})
    refutations = refuted(wrong, CASE)
    assert right in refutations[name]
    assert list(refutations) == [name]


def test_a_cell_of_little_weight_is_found_among_others():
    """V_s of level 1 hardly moves the least squares: cells that could restore their digits as well are named, too."""
    refutations = refuted(PRINT.changed({"table1.V_s.1": "0.00775"}), CASE)
    assert "0.00774" in refutations["table1.V_s.1"]
    assert all(name.startswith("table1.V_s.") for name in refutations)


def test_a_changed_result_refutes_no_cell():
    """Where the printed least squares themselves are off, no one cell explains it."""
    assert refuted(PRINT.changed({"text.residual_Xs_ls": "7.77e-05"}), CASE) == {}


@pytest.mark.parametrize(
    ("value", "printed", "expected"),
    [
        (90.04025, "90.0402", True),  # cut off
        (90.04025, "90.0403", True),  # rounded
        (90.04025, "90.0401", False),
        (1.5424, "1.542", True),
        (-0.00271, "-0.0028", False),
    ],
)
def test_digits_rounded_or_cut_off_agree(value, printed, expected):
    assert bool(agrees(value, Printed(printed))) is expected
