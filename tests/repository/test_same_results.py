"""`make compare`: what it says of two folders of results."""

from __future__ import annotations

import hashlib
import shutil

import pandas as pd
import pytest

from dampbalance.project.files import write_csv, write_json, write_parquet
from same_results import compare, different, digests, furthest


@pytest.fixture
def two(tmp_path):
    """Two folders with the same results."""
    first, second = tmp_path / "first", tmp_path / "second"
    frame = pd.DataFrame({"x": [1.0, 2.0, float("nan")], "word": ["a", "", "b"]})
    write_csv(first / "paper/table.csv", frame)
    write_parquet(first / "paper/cases.parquet", frame)
    write_json(first / "paper/values.json", {"list": [1.0, {"c": 90.0}]})
    write_json(first / "paper/manifest.json", {"reproducible": {"n": 1}, "run": {"python": "a"}})
    shutil.copytree(first, second)
    return first, second


def test_the_same_folders(two, capsys):
    assert different(*two) == []
    assert compare(*two) == 0
    assert capsys.readouterr().out == "4 files, 4 of them with the same bytes\n"


@pytest.mark.parametrize("name", ["table.csv", "cases.parquet"])
def test_a_number_that_differs_is_named_with_how_far(two, name):
    first, second = (folder / "paper" / name for folder in two)
    frame = pd.DataFrame({"x": [1.0, 2.0002, float("nan")], "word": ["a", "", "b"]})
    (write_csv if name.endswith("csv") else write_parquet)(second, frame)
    relative, place = furthest(first, second)
    assert relative == pytest.approx(1e-4, rel=1e-3)  # of the larger one
    assert place == "x"
    assert compare(*two) == 1


def test_a_number_of_a_document_is_named_by_its_pointer(two):
    first, second = (folder / "paper/values.json" for folder in two)
    write_json(second, {"list": [1.0, {"c": 90.009}]})
    relative, place = furthest(first, second)
    assert relative == pytest.approx(1e-4, rel=1e-3)
    assert place == "/list/1/c"


@pytest.mark.parametrize(
    "frame",
    [
        pd.DataFrame({"x": [1.0, 2.0, 3.0], "word": ["a", "", "b"]}),  # a number for none
        pd.DataFrame({"x": [1.0, 2.0], "word": ["a", ""]}),
        pd.DataFrame({"x": [1.0, 2.0, float("nan")], "word": ["a", "c", "b"]}),
        pd.DataFrame({"y": [1.0, 2.0, float("nan")], "word": ["a", "", "b"]}),
    ],
)
def test_more_than_numbers(two, frame, capsys):
    write_csv(two[1] / "paper/table.csv", frame)
    assert compare(*two) == 1
    assert "paper/table.csv: other contents\n" in capsys.readouterr().out


def test_a_file_that_is_missing(two, capsys):
    (two[0] / "paper/table.csv").unlink()
    assert compare(*two) == 1
    assert f"paper/table.csv: only in {two[1]}\n" in capsys.readouterr().out


def test_the_run_itself_may_differ_and_nothing_else_of_a_manifest(two, capsys):
    manifest = two[1] / "paper/manifest.json"
    write_json(manifest, {"reproducible": {"n": 1}, "run": {"python": "b"}})
    assert compare(*two) == 0
    assert "describes the run" in capsys.readouterr().out
    write_json(manifest, {"reproducible": {"n": 2}, "run": {"python": "a"}})
    assert compare(*two) == 1


def test_digests_are_those_that_sha256sum_checks(two):
    (two[0] / "paper/table.csv").rename(two[0] / "paper/approaches.csv")
    (two[0] / "paper").rename(two[0] / "tables")
    data = (two[0] / "tables/approaches.csv").read_bytes()
    assert digests(two[0]) == f"{hashlib.sha256(data).hexdigest()}  tables/approaches.csv\n"
