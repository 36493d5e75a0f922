"""The printed numbers: their digits, their ids, and a table that is looked at before anything runs, with one error that
names file, row and column."""

from __future__ import annotations

import random

import pandas as pd
import pytest

from dampbalance.replication.claims.printed import Printed, read_published
from dampbalance.replication.claims.rules import RULES, check_printed
from dampbalance.replication.claims.verdicts import (
    VERDICTS,
    counts,
    part_of,
)
from folders import PUBLISHED

TEXT = (PUBLISHED / "printed.csv").read_text(encoding="utf-8")
PRINT = read_published(PUBLISHED)
NOT_NUMBERS = [
    *("n/a", "1,5", "nan", "Infinity", "1E400", "1e-99", "9" * 300, "<b>1</b>", "−1", "1 2")
]


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


@pytest.mark.parametrize(
    ("text", "fits"), [("1e-30", True), ("1e-31", False), ("9e30", True), ("1e31", False)]
)
def test_sizes_of_numbers_have_their_limits(text, fits):
    assert Printed(text).is_number == fits


def test_printed_text_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match="'1,28' is not a number"):
        _ = Printed("1,28").value


# ---- The table ------------------------------------------------------------------------------------------------------


@pytest.fixture
def error_of(tmp_path):
    """A function from what the file holds to what is said of it."""

    def error_of(content):
        if content is not None:
            (tmp_path / "printed.csv").write_bytes(content)
        with pytest.raises(ValueError) as caught:  # noqa: PT011 - what it says is looked at
            check_printed(read_published(tmp_path))
        message = str(caught.value)
        assert len(message.splitlines()) == 1
        assert "printed.csv" in message
        assert len(message) < 400
        return message

    return error_of


def test_the_printed_numbers_pass():
    check_printed(PRINT)
    assert {row.rule for row in PRINT.rows.values()} == set(RULES)


@pytest.mark.parametrize("seed", range(40))
def test_a_text_that_is_no_number_is_named(seed):
    draw = random.Random(seed)
    numbers = [row for row in PRINT.rows.values() if row.rule not in ("change", "truth")]
    name, text = draw.choice(numbers).id, draw.choice(NOT_NUMBERS)
    with pytest.raises(ValueError, match=rf"^printed\.csv: row {name}, column printed: ") as caught:
        check_printed(PRINT.changed({name: text}))
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize(
    "content",
    [
        None,
        b"",
        bytes(range(256)),
        b"a,b\n1,2,3\n1\n",
        b"x" * 2_000_000,
        TEXT.replace(",", ";").encode(),
        (TEXT + TEXT.splitlines()[-1]).encode(),
    ],
    ids=["missing", "empty", "binary", "ragged", "large", "semicolons", "twice"],
)
def test_a_file_that_is_no_table_is_named(error_of, content):
    error_of(content)


def test_a_folder_in_place_of_the_file_is_named(error_of, tmp_path):
    (tmp_path / "printed.csv").mkdir()
    error_of(None)


@pytest.mark.parametrize(
    "start", ["table1.X.1", "table2.a.5", "table2.c.4-5", "table3.V_s.c", "text.phi"]
)
def test_a_missing_row_is_named(error_of, start):
    lines = TEXT.splitlines()
    lost = next(line for line in lines if line.startswith(start))
    message = error_of("\n".join(line for line in lines if line != lost).encode())
    key = PRINT.rows[lost.split(",")[0]].key
    assert f"no row for {' '.join(filter(None, key))};" in message


@pytest.mark.parametrize(("lost", "more"), [(8, False), (9, True)])
def test_of_many_missing_rows_eight_are_named(error_of, lost, more):
    head, *lines = TEXT.splitlines()
    kept = [line for line in lines if not line.startswith("table3")]
    kept += [line for line in lines if line.startswith("table3")][lost:]
    message = error_of("\n".join([head, *kept]).encode())
    assert message.count(" pair common ") == 8
    assert (" …;" in message) == more


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            ",zeta,,",
            ",eta,,",
            "row parameter.zeta, column quantity: 'eta' is not known to its rule",
        ),
        ("computed,phase", "computed,faze", "row table1.phi.1, column rule: 'faze'"),
        (
            "given,parameter",
            "computed,parameter",
            "row parameter.m, column claim: 'computed'",
        ),
        (",F_k,direct,", ",F_k,rough,", "row table2.F_k.1-2, column approach: 'rough'"),
        (",0.00605,", ",,", "column printed has an empty cell"),
        (
            "less than",
            "about",
            "max_error_F_k: the words must end with 'less than' or 'more than'",
        ),
        (
            ",degraded,",
            ",unclear,",
            "accuracy_omega2: cannot judge the word 'unclear'; known are degraded, improved",
        ),
        (
            ",true,",
            ",perhaps,",
            "direct_best: cannot judge the word 'perhaps'; known are true, false",
        ),
        (
            ",phi,,mean,",
            ",phi,,level,",
            "row text.phi_mean, column kind: 'level' is not known to its rule; known are mean",
        ),
        (",m,X: peak", ",s,X: peak", "row table1.X.1, column unit: 's' is not known to its rule"),
        (
            "omega1,b,,level,,,1,m^2/s",
            "omega1,b,,level,,,1,J",
            "row table2.b.1, column unit: 'J' is not known to its rule; known are m^2/s",
        ),
    ],
)
def test_a_row_that_cannot_be_judged_is_named(error_of, old, new, message):
    assert old in TEXT
    assert message in error_of(TEXT.replace(old, new, 1).encode())


# ---- Ids and counts -------------------------------------------------------------------------------------------------


def test_counts_per_part_and_of_all():
    claims = pd.DataFrame(
        [
            ("text.a", "computed", "reading"),
            ("table1.X.1", "computed", "differs"),
            ("text.b", "computed", "reading"),
            ("text.c", "statement", "simulated"),
            ("text.d", "statement", "undecided"),
            ("table1.Y.1", "given", "reproduced"),
        ],
        columns=["id", "kind", "verdict"],
    )
    text, table1, every = counts(claims)
    parts = [(count.part, count.computed) for count in (text, table1, every)]
    assert parts == [("Text", 2), ("Table 1", 1), ("all", 3)]
    assert list(text.of_verdict) == list(VERDICTS)
    assert every.of_verdict["reading"] == 2
    assert every.of_verdict["simulated"] == 0  # a statement is not a computed number
    assert (text.statements, text.statements_held) == (2, 1)
    assert (table1.given, table1.given_held) == (1, 1)


def test_an_id_belongs_to_a_part():
    assert part_of("table3.V_s.c.1-2") == "table3"
    with pytest.raises(KeyError, match=r"'table9.X.1' belongs to no part of the paper"):
        part_of("table9.X.1")
