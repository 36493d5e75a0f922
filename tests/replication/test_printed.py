"""The printed numbers: their digits, their ids, and a table that is looked at before anything runs, with one error that
names file, row and column."""

from __future__ import annotations

import pytest

from dampbalance.replication.claims.printed import Printed, read_published
from dampbalance.replication.claims.rules import RULES, check_printed
from dampbalance.replication.claims.verdicts import part_of
from folders import PUBLISHED
from replication.routes import PRINT

TEXT = (PUBLISHED / "printed.csv").read_text(encoding="utf-8")
HEAD, *LINES = TEXT.splitlines()


@pytest.mark.parametrize(
    ("text", "value", "unit", "decimals", "significant", "shown", "next_one"),
    [
        ("90.0402", 90.0402, 1e-4, 4, 6, "90.04025418", "90.0403"),
        ("90.000", 90.0, 1e-3, 3, 5, "90.0402542", "90.001"),
        ("2.9E-3", 0.0029, 1e-4, 4, 2, "9.00403e+01", "3.0E-3"),
        ("9.1587e-07", 9.1587e-07, 1e-11, 11, 5, "9.00402542e+01", "9.1588e-07"),
        ("9.9e-7", 9.9e-7, 1e-8, 8, 2, "9.00403e+01", "10.0e-7"),
        ("2310", 2310.0, 1.0, 0, 4, "90.0403", "2311"),
        ("-0.00272", -0.00272, 1e-5, 5, 3, "90.040254180", "-0.00271"),
    ],
)
def test_a_printed_number_knows_its_digits(
    text, value, unit, decimals, significant, shown, next_one
):
    printed = Printed(text)
    assert (printed.value, printed.decimals, printed.significant) == (value, decimals, significant)
    assert printed.unit == pytest.approx(unit, rel=1e-15)
    assert printed.show(90.04025418) == shown
    assert printed.moved(1) == next_one


def test_what_is_no_number_is_known_and_sizes_have_their_limits():
    others = ["1e-31", "1e31", "n/a", "1,5", "nan", "Infinity", "9" * 26, "<b>1</b>", "−1", "1 2"]
    assert [text for text in ("1e-30", "9e30", *others) if Printed(text).is_number] == [
        "1e-30",
        "9e30",
    ]


# ---- The table ------------------------------------------------------------------------------------------------------


@pytest.fixture
def error_of(tmp_path):
    """A function from what the file holds to what is said of it, in one line."""

    def error_of(content):
        if content is not None:
            (tmp_path / "printed.csv").write_bytes(content)
        with pytest.raises(ValueError, match=r"printed\.csv") as caught:
            check_printed(read_published(tmp_path))
        message = str(caught.value)
        assert len(message.splitlines()) == 1
        assert len(message) < 400
        return message

    return error_of


def test_the_printed_numbers_pass():
    check_printed(PRINT)
    assert {row.rule for row in PRINT.rows.values()} == set(RULES)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "missing"),
        (b"x" * 2_000_000, "more than 1,000,000 bytes"),
        (bytes(range(256)), "cannot be read as a table of text"),
        (TEXT.replace(",", ";").encode(), "expected the columns id, where"),
        ((TEXT + LINES[-1]).encode(), r"appears in lines"),
    ],
)
def test_a_file_that_is_no_table_is_named(error_of, content, words):
    assert words in error_of(content)


@pytest.mark.parametrize(("lost", "more"), [(1, False), (8, False), (9, True)])
def test_missing_rows_are_named_at_most_eight_of_them(error_of, lost, more):
    rows = [line for line in LINES if line.startswith("table3")]
    kept = [line for line in LINES if line not in rows[:lost]]
    message = error_of("\n".join([HEAD, *kept]).encode())
    key = PRINT.rows[rows[0].split(",")[0]].key
    assert f"no row for {' '.join(filter(None, key))}" in message
    assert message.count(" pair common ") == min(lost, 8)
    assert (" …;" in message) == more


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (",zeta,,", ",eta,,", "parameter.zeta, column quantity: 'eta' is not known to its rule"),
        ("computed,phase", "computed,faze", "row table1.phi.1, column rule: 'faze'"),
        ("given,parameter", "computed,parameter", "row parameter.m, column claim: 'computed'"),
        (",F_k,direct,", ",F_k,rough,", "row table2.F_k.1-2, column approach: 'rough'"),
        (",0.00605,", ",,", "column printed has an empty cell"),
        (",0.00605,", f",{'9' * 300},", "row table1.X.3, column printed: '9"),
        ("less than", "about", "max_error_F_k: the words must end with 'less than' or 'more than'"),
        (",degraded,", ",unclear,", "the word 'unclear'; known are degraded, improved"),
        (",true,", ",perhaps,", "the word 'perhaps'; known are true, false"),
        (",phi,,mean,", ",phi,,level,", "kind: 'level' is not known to its rule; known are mean"),
        (",m,X: peak", ",s,X: peak", "row table1.X.1, column unit: 's' is not known to its rule"),
    ],
)
def test_a_row_that_cannot_be_judged_is_named(error_of, old, new, message):
    assert old in TEXT
    assert message in error_of(TEXT.replace(old, new, 1).encode())


def test_an_id_belongs_to_a_part():
    assert part_of("table3.V_s.c.1-2") == "table3"
    with pytest.raises(KeyError, match=r"'table9.X.1' belongs to no part of the paper"):
        part_of("table9.X.1")
