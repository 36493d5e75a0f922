"""What the paper's numbers say of each other: printed results that follow from printed inputs to the last digit, ranges
that Table 2 allows, and least squares as checksums."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.balance import APPROACHES, Rows, slip_velocity_as_printed
from dampbalance.replication import authors_route as authors
from dampbalance.replication.claims import cross_checks, printed
from dampbalance.replication.claims.causes import Sources
from dampbalance.replication.claims.cross_checks import refuted, table_2, table_3
from dampbalance.replication.claims.printed import PAIR_LABELS, PAIRS, Printed
from dampbalance.replication.numbers import Key
from dampbalance.solver import least_squares, pair
from replication.routes import CASE, PAPER, PRINT, as_read


def ranges(table):
    """The range of each number that has one, by id."""
    return {name: table.range(name) for name in sorted(table.ranged)}


@pytest.fixture(scope="module")
def of_print():
    return ranges(table_2(PRINT))


def rounded(values):
    """The print with other numbers, by id, each with as many decimals as the printed one."""
    return PRINT.changed({id_: f"{value:.{PRINT[id_].decimals}f}" for id_, value in values.items()})


def of_pairs(start, rows):
    """F_k and c of all pairs, by id."""
    estimates = {label: pair(rows, i, j) for (i, j), label in zip(PAIRS, PAIR_LABELS, strict=True)}
    return {f"{start}.{s}.{label}": float(e[s]) for label, e in estimates.items() for s in e.values}


# ---- Arithmetic on printed numbers ----------------------------------------------------------------------------------


def test_largest_errors_of_table_3():
    of_print = printed.from_print(PRINT, CASE)
    largest = Key("omega1", "", "harmonic", "largest", "", "common", unit="%")
    F_k, c = (of_print[largest._replace(quantity=symbol)] for symbol in ("F_k", "c"))
    assert F_k == pytest.approx(100.0 * (1.299 / 1.28 - 1.0), rel=1e-12)  # X_s, pair 2-3
    assert c == pytest.approx(100.0 * (90.071 / 90.0 - 1.0), rel=1e-12)  # V_s, pair 1-2


def test_the_sign_slip_is_not_in_the_least_squares():
    """The text's V_s least squares use the minus of (19): with the plus of Table 3 they come out elsewhere."""
    features, text = (
        printed.printed_features(PRINT, CASE.omega("omega1")),
        PRINT["text.F_k_Vs_ls"].text,
    )
    minus = least_squares(APPROACHES["V_s"](features, 2310.0))["F_k"]
    plus = least_squares(slip_velocity_as_printed(features, 2310.0))["F_k"]
    assert f"{minus:.{Printed(text).decimals}f}" == text
    assert abs(plus - Printed(text).value) > 5e-3


# ---- Table 2 --------------------------------------------------------------------------------------------------------


def test_a_table_made_from_more_digits_is_allowed():
    """Table 2 of a known F_k and c, everything rounded as in print: each range holds what was rounded."""
    generator = np.random.default_rng(2010)
    a, b = (PRINT.values(symbol) for symbol in ("a", "b"))
    # digits beyond the printed ones, and errors of W that make the pairs differ as they do in print
    a += 1e-9 * generator.uniform(-0.5, 0.5, 5)
    b += 1e-8 * generator.uniform(-0.5, 0.5, 5)
    W = (1.28 * a + 90.0114 * b) * (1.0 + 3e-7 * generator.standard_normal(5))
    true = of_pairs("table2", Rows({"F_k": a, "c": b}, W))
    for symbol, values in (("a", a), ("b", b), ("W", W)):
        true |= {f"table2.{symbol}.{level}": value for level, value in enumerate(values, 1)}
    for name, (low, high) in ranges(table_2(rounded(true))).items():
        slack, width = {"F": (1e-9, 1e-4), "c": (1e-9, 1e-3), "b": (1e-14, 1.0)}[name[7]]
        assert low - slack <= true[name] <= high + slack, name
        assert high - low < width


def test_the_printed_table_2_agrees_with_itself(of_print):
    for name, (low, high) in of_print.items():
        half = 0.5 * PRINT[name].unit
        assert low - half <= PRINT[name].value <= high + half


def test_a_range_leaves_its_own_print_out(of_print):
    other = table_2(PRINT.changed({"table2.F_k.1-5": "1.279990"}))
    assert other.range("table2.F_k.1-5") == pytest.approx(of_print["table2.F_k.1-5"], abs=1e-9)
    assert other.range("table2.F_k.1-2") is None  # nothing fits the changed one


def test_the_pairs_with_level_1_need_one_b_1_that_the_simulation_does_not_have(of_print):
    low, high = of_print["table2.b.1"]
    assert low == pytest.approx(7.2728872e-4, abs=1e-11)  # print: 7.2729e-4
    assert low > 1.00001 * 7.27278636e-4  # the simulated one
    assert high - low < 5e-10  # twenty times finer than it is printed


# ---- Table 3 --------------------------------------------------------------------------------------------------------


def test_the_printed_table_3_agrees_with_itself_and_with_table_1_by_the_slip_of_sign(monkeypatch):
    """Thirty numbers of seventeen inputs, all within their rounding, with the plus in the V_s columns; with the minus
    that (19) states, no inputs that round to Table 1 give them."""
    assert table_3(PRINT, CASE).misfit < 0.5
    assert Sources(PRINT, CASE, {}).allowed("table3.V_s.c.1-2") is None
    stated = authors.APPROACHES_OF_TABLE_3["V_s with minus"]
    monkeypatch.setitem(authors.APPROACHES_OF_TABLE_3, "V_s", stated)
    assert set(ranges(table_3(PRINT, CASE)).values()) == {None}


def test_the_proof_of_the_sign_needs_that_the_columns_share_their_inputs():
    """All columns fit with the plus and miss the minus, by units of the last digit; the V_s columns alone fit both."""
    found = cross_checks.misfits(PRINT, CASE)
    expected = {"plus": 0.40, "minus": 4.03, "minus alone": 0.34}
    assert found == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize(("name", "step"), [("table3.t_s.F_k.2-3", -1), ("table3.X_s.F_k.1-5", +1)])
def test_a_changed_digit_of_table_3_is_not_allowed(name, step):
    """The range of the changed number itself does not reach it; of the others some have none left."""
    wrong = Printed(PRINT[name].moved(step))
    allowed = ranges(table_3(PRINT.changed({name: wrong.text}), CASE))
    nearest = allowed[name][0 if step < 0 else 1]
    assert step * (wrong.value - nearest) > 0.5 * wrong.unit
    assert None in allowed.values()


def test_ranges_made_linear_are_those_of_the_equations():
    """Table 3 of known inputs, one digit of it wrong: the range of that number holds what was rounded."""
    features, true = as_read()["omega1"].two_point, {}
    for approach in ("t_s", "X_s", "V_s"):
        rows = authors.APPROACHES_OF_TABLE_3[approach](features, PAPER.k)
        true |= of_pairs(f"table3.{approach}", rows)
    made = rounded(true)
    assert table_3(made, CASE).misfit < 0.5
    for label in ("1-2", "4-5", "1-5"):
        name = f"table3.t_s.F_k.{label}"
        low, high = table_3(made.changed({name: made[name].moved(3)}), CASE).range(name)
        slack = 0.01 * (high - low)  # what is left of the curvature
        assert low - slack <= true[name] <= high + slack, label


# ---- Checksums ------------------------------------------------------------------------------------------------------


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
    refutations = refuted(PRINT.changed({name: Printed(right).moved(step)}), CASE)
    assert right in refutations[name]
    assert list(refutations) == [name]


def test_a_cell_of_little_weight_is_found_among_others_and_none_where_there_is_no_wrong_one():
    """V_s of level 1 hardly moves the least squares: cells that could restore their digits as well are named, too."""
    refutations = refuted(PRINT.changed({"table1.V_s.1": "0.00775"}), CASE)
    assert "0.00774" in refutations["table1.V_s.1"]
    assert all(name.startswith("table1.V_s.") for name in refutations)
    assert refuted(PRINT, CASE) == {}
    # where the printed least squares themselves are off, no one cell explains it
    assert refuted(PRINT.changed({"text.residual_Xs_ls": "7.77e-05"}), CASE) == {}


@pytest.mark.parametrize(
    ("value", "text", "expected"),
    [
        (90.04025, "90.0402", True),  # cut off
        (90.04025, "90.0403", True),  # rounded
        (90.04025, "90.0401", False),
        (-0.00271, "-0.0028", False),
    ],
)
def test_digits_rounded_or_cut_off_agree(value, text, expected):
    assert bool(cross_checks.agrees(value, Printed(text))) is expected
