"""What stands in the printed tables is looked at before anything runs: one error, naming file, row and column."""

from __future__ import annotations

import random
import shutil

import pytest

from dampbalance.replication.claims import check_cells, read_published
from dampbalance.replication.claims.published import FILES
from folders import ROOT

PUBLISHED = ROOT / "paper/published"
NOT_NUMBERS = [
    "n/a",
    "1,5",
    "nan",
    "Infinity",
    "1E400",
    "1e-99",
    "9" * 300,
    "<b>1</b>",
    "−1",
    "1 2",
]


@pytest.fixture
def folder(tmp_path):
    return shutil.copytree(PUBLISHED, tmp_path / "published")


def error_of(folder):
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - what it says is looked at
        check_cells(read_published(folder))
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert len(message) < 400
    return message


def test_the_printed_tables_pass():
    check_cells(read_published(PUBLISHED))


@pytest.mark.parametrize("seed", range(40))
def test_a_cell_that_is_no_number_is_named(folder, seed):
    draw = random.Random(seed)
    name = draw.choice([name for name in FILES if name.startswith("table")])
    file = folder / f"{name}.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    row = draw.randrange(1, len(lines))
    cells, columns = lines[row].split(","), lines[0].split(",")
    column = draw.randrange(1, len(cells))
    cells[column] = f'"{draw.choice(NOT_NUMBERS)}"'
    lines[row] = ",".join(cells)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    message = error_of(folder)
    assert message.startswith(f"{name}.csv: row {cells[0]}, column {columns[column]}: ")


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize(
    "spoil",
    [
        lambda file: file.unlink(),
        lambda file: file.write_bytes(b""),
        lambda file: file.write_bytes(bytes(range(256))),
        lambda file: file.write_text("a,b\n1,2,3\n1\n", encoding="utf-8"),
        lambda file: file.write_bytes(b"x" * 2_000_000),
        lambda file: (file.unlink(), file.mkdir()),
        lambda file: file.write_bytes(file.read_bytes().replace(b",", b";")),
        lambda file: file.write_bytes(file.read_bytes() + file.read_bytes().split(b"\n")[-2]),
    ],
    ids=["missing", "empty", "binary", "ragged", "large", "folder", "semicolons", "twice"],
)
def test_a_file_that_is_no_table_is_named(folder, name, spoil):
    spoil(folder / f"{name}.csv")
    assert f"{name}.csv" in error_of(folder)


@pytest.mark.parametrize("name", [name for name in FILES if name != "parameters"])
def test_a_missing_row_is_told(folder, name):
    file = folder / f"{name}.csv"
    lines = file.read_text(encoding="utf-8").splitlines()
    file.write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
    assert f"{name}.csv" in error_of(folder)


def test_an_unknown_parameter_is_named(folder):
    file = folder / "parameters.csv"
    file.write_text(file.read_text(encoding="utf-8").replace("zeta,zeta", "zeta,eta"), "utf-8")
    assert "parameters.csv: row zeta, column symbol: 'eta'" in error_of(folder)
