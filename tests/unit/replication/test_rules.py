"""The table of printed numbers is looked at before anything runs: one error, naming file, row and column."""

from __future__ import annotations

import random

import pytest

from dampbalance.replication.claims.published import Printed, read_published
from dampbalance.replication.claims.rules import RULES, _few, check_printed
from folders import PUBLISHED

TEXT = (PUBLISHED / "printed.csv").read_text(encoding="utf-8")
PRINT = read_published(PUBLISHED)
NOT_NUMBERS = [
    *("n/a", "1,5", "nan", "Infinity", "1E400", "1e-99", "9" * 300, "<b>1</b>", "−1", "1 2")
]


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


def replaced(old, new):
    assert old in TEXT
    return TEXT.replace(old, new, 1).encode()


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
    assert f"rows and claims do not match: {lost.split(',')[0]};" in message


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (",zeta,,", ",eta,,", "row parameter.zeta, column symbol: 'eta' is not known to its rule"),
        ("computed,phase", "computed,faze", "row table1.phi.1, column rule: 'faze'"),
        ("given,held", "computed,held", "row parameter.m, column kind: 'computed'"),
        (",F_k,direct,", ",F_k,rough,", "row table2.F_k.1-2, column approach: 'rough'"),
        (",0.00605,", ",,", "column printed has an empty cell"),
        (
            "less than",
            "about",
            "max_error_F_k: the quantity must end with 'less than' or 'more than'",
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
        ("text.phi_mean", "text.phi_middle", "do not match: text.phi_mean, text.phi_middle;"),
    ],
)
def test_a_row_that_cannot_be_judged_is_named(error_of, old, new, message):
    assert message in error_of(replaced(old, new))


def test_sizes_of_numbers_and_of_lists_have_their_limits():
    for text, fits in (("1e-30", True), ("1e-31", False), ("9e30", True), ("1e31", False)):
        assert Printed(text).is_number == fits
    assert _few("01234567") == "0, 1, 2, 3, 4, 5, 6, 7"
    assert _few("012345678") == "0, 1, 2, 3, 4, 5, 6, 7 …"
