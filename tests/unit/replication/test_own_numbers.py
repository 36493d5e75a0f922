"""What the paper's numbers say of each other: ranges that Table 2 allows, and least squares as checksums."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dampbalance.balance import Rows
from dampbalance.replication import as_published as authors
from dampbalance.replication.claims import read_published
from dampbalance.replication.claims.allowed import by_table_2, by_table_3, misfits
from dampbalance.replication.claims.checksums import agrees, refuted
from dampbalance.replication.claims.inputs import PAIR_LABELS, PAIRS
from dampbalance.replication.claims.published import numbers
from dampbalance.replication.printed import Printed
from dampbalance.solver import pair
from paper.routes import CASE, PAPER, PUBLISHED, as_read

PRINT = read_published(PUBLISHED)


def with_cell(table, line, column, text):
    frame = getattr(PRINT, table).copy()
    frame.loc[line, column] = text
    return replace(PRINT, **{table: frame})


@pytest.fixture(scope="module")
def of_print():
    return by_table_2(PRINT)


def test_a_table_made_from_more_digits_is_allowed():
    """Table 2 of a known F_k and c, everything rounded as in print: each range holds what was rounded."""
    generator = np.random.default_rng(2010)
    integrals, pairs = PRINT.table2_integrals.copy(), PRINT.table2_pairs.copy()
    a, b = (numbers(integrals, column) for column in ("a_m", "b_m2_per_s"))
    # digits beyond the printed ones, and errors of W that make the pairs differ as they do in print
    a += 1e-9 * generator.uniform(-0.5, 0.5, 5)
    b += 1e-8 * generator.uniform(-0.5, 0.5, 5)
    W = (1.28 * a + 90.0114 * b) * (1.0 + 3e-7 * generator.standard_normal(5))
    true = {}
    for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True):
        estimate = pair(Rows({"F_k": a, "c": b}, W), i, j)
        true |= {(label, symbol): float(estimate[symbol]) for symbol in ("F_k", "c")}
        pairs.loc[label, "direct_F_k_N"] = f"{true[label, 'F_k']:.6f}"
        pairs.loc[label, "direct_c_N_s_per_m"] = f"{true[label, 'c']:.4f}"
    for column, values, decimals in (("a_m", a, 9), ("b_m2_per_s", b, 8), ("W_J", W, 8)):
        integrals[column] = [f"{value:.{decimals}f}" for value in values]
    of_pairs, of_b = by_table_2(replace(PRINT, table2_integrals=integrals, table2_pairs=pairs))
    for name, value in true.items():
        low, high = of_pairs[name]
        assert low - 1e-9 <= value <= high + 1e-9, name
        assert high - low < (1e-3 if name[1] == "c" else 1e-4)
    for level, value in enumerate(b, 1):
        low, high = of_b[level]
        assert low - 1e-14 <= value <= high + 1e-14


def test_the_printed_table_2_agrees_with_itself(of_print):
    assert None not in of_print[0].values()
    for (label, symbol), (low, high) in of_print[0].items():
        column = {"F_k": "direct_F_k_N", "c": "direct_c_N_s_per_m"}[symbol]
        printed = Printed(PRINT.table2_pairs[column][label])
        assert low <= printed.value + 0.5 * printed.unit
        assert high >= printed.value - 0.5 * printed.unit


def test_a_range_leaves_its_own_print_out(of_print):
    other, _ = by_table_2(with_cell("table2_pairs", "1-5", "direct_F_k_N", "1.279990"))
    assert other["1-5", "F_k"] == pytest.approx(of_print[0]["1-5", "F_k"], abs=1e-9)
    assert other["1-2", "F_k"] is None  # nothing fits the changed one


def test_the_pairs_with_level_1_need_one_b_1_that_the_simulation_does_not_have(of_print):
    low, high = of_print[1][1]
    assert low == pytest.approx(7.2728872e-4, abs=1e-11)  # print: 7.2729e-4
    assert low > 1.00001 * 7.27278636e-4  # the simulated one
    assert high - low < 5e-10  # twenty times finer than it is printed


def test_the_printed_table_3_agrees_with_itself_and_with_table_1():
    """Thirty numbers of seventeen inputs, all within their rounding, with the plus in the V_s columns."""
    assert by_table_3(PRINT, CASE) == {}


@pytest.mark.parametrize(
    ("approach", "label", "symbol", "step"),
    [("t_s", "2-3", "F_k", -1), ("X_s", "1-5", "F_k", +1), ("t_s", "1-2", "c", +1)],
)
def test_a_changed_digit_of_table_3_is_not_allowed(approach, label, symbol, step):
    """The range of the changed number itself does not reach it; of the others some have none left."""
    column = f"{approach}_{'F_k_N' if symbol == 'F_k' else 'c_N_s_per_m'}"
    wrong = Printed(Printed(PRINT.table3[column][label]).moved(step))
    found = by_table_3(with_cell("table3", label, column, wrong.text), CASE)
    low, high = found[approach, label, symbol]
    nearest = low if step < 0 else high
    assert step * (wrong.value - nearest) > 0.5 * wrong.unit
    assert None in found.values()


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
    made = PRINT.table3.copy()
    for approach in ("t_s", "X_s", "V_s"):
        rows = authors.APPROACHES_OF_TABLE_3[approach](features, PAPER.k)
        for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True):
            for symbol, column in (("F_k", "F_k_N"), ("c", "c_N_s_per_m")):
                value = float(pair(rows, i, j)[symbol])
                text = made.loc[label, f"{approach}_{column}"]
                made.loc[label, f"{approach}_{column}"] = f"{value:.{Printed(text).decimals}f}"
    assert by_table_3(replace(PRINT, table3=made), CASE) == {}
    for label, (i, j) in zip(PAIR_LABELS, PAIRS, strict=True):
        wrong = made.copy()
        wrong.loc[label, "t_s_F_k_N"] = Printed(wrong.loc[label, "t_s_F_k_N"]).moved(3)
        low, high = by_table_3(replace(PRINT, table3=wrong), CASE)["t_s", label, "F_k"]
        true = float(pair(authors.APPROACHES_OF_TABLE_3["t_s"](features, PAPER.k), i, j)["F_k"])
        slack = 0.01 * (high - low)  # what is left of the curvature
        assert low - slack <= true <= high + slack, label


def test_the_printed_tables_give_the_printed_least_squares():
    assert refuted(PRINT, CASE, "table1") == {}
    assert refuted(PRINT, CASE, "table2_integrals") == {}


@pytest.mark.parametrize(
    ("table", "line", "column", "right"),
    [
        ("table1", "3", "phi_rad", "1.550"),
        ("table1", "4", "t_s_s", "1.7E-3"),
        ("table2_integrals", "2", "W_J", "0.19139123"),
        ("table2_integrals", "5", "a_m", "0.037445013"),
    ],
)
@pytest.mark.parametrize("step", [-3, 1])
def test_a_changed_digit_is_found_and_put_right(table, line, column, right, step):
    """An error-locating code: only the changed cell, and only its own digit, restores all that is printed."""
    found = refuted(with_cell(table, line, column, Printed(right).moved(step)), CASE, table)
    assert right in found[column, line]
    assert list(found) == [(column, line)]


def test_a_cell_of_little_weight_is_found_among_others():
    """V_s of level 1 hardly moves the least squares: cells that could restore their digits as well are named, too."""
    found = refuted(with_cell("table1", "1", "V_s_m_per_s", "0.00775"), CASE, "table1")
    assert "0.00774" in found["V_s_m_per_s", "1"]
    assert {column for column, _ in found} == {"V_s_m_per_s"}


def test_a_changed_result_refutes_no_cell():
    """Where the printed least squares themselves are off, no one cell explains it."""
    text = PRINT.text_values.copy()
    text.loc["residual_Xs_ls", "printed"] = "7.77e-05"
    assert refuted(replace(PRINT, text_values=text), CASE, "table1") == {}


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
    assert agrees(value, printed) is expected


def test_a_moved_last_digit_is_written_as_before():
    moved = [Printed(text).moved(1) for text in ("2.9E-3", "-0.00272", "90.000", "2310", "9.9e-7")]
    assert moved == ["3.0E-3", "-0.00271", "90.001", "2311", "10.0e-7"]
    assert isinstance(pd.Series(moved).iloc[0], str)
