"""Results are written whole or not at all, and read back as they were."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from dampbalance.project.files import (
    READ_OUT_DIGITS,
    STATISTICAL_DIGITS,
    read_csv,
    remove_unfinished,
    replacing,
    write_csv,
    write_json,
    write_parquet,
    write_rows,
    write_text,
)


def test_a_failed_write_leaves_the_old_file_and_no_rest(tmp_path):
    file = tmp_path / "result.txt"
    write_text(file, "old")

    def fail():
        with replacing(file) as temporary:
            temporary.write_text("new")
            raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        fail()
    assert file.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["result.txt"]


def test_folders_are_made_and_permissions_are_the_users_own(tmp_path):
    file = tmp_path / "a/b/result.txt"
    plain = tmp_path / "plain.txt"
    plain.write_text("x")
    write_text(file, "x")
    assert file.stat().st_mode == plain.stat().st_mode


def test_a_csv_keeps_fifteen_digits_and_missing_values(tmp_path):
    # Fifteen significant digits: half a unit of the last is at most 5e-15 of the value.
    frame = pd.DataFrame({"a": [1 / 3, math.nan, 1e-300], "n": [1, 2, 3], "w": ["x", "", "z, w"]})
    write_csv(tmp_path / "t.csv", frame)
    back = read_csv(tmp_path / "t.csv")
    assert back["a"][0] == pytest.approx(1 / 3, rel=5e-15)
    assert math.isnan(back["a"][1])
    assert back["a"][2] == 1e-300
    assert list(back["n"]) == [1, 2, 3]
    assert list(back["w"]) == ["x", "", "z, w"]
    assert (tmp_path / "t.csv").read_bytes().splitlines()[1] == b"0.333333333333333,1,x"


@pytest.mark.parametrize(
    "names", [["1", "01", "1e3"], ["nan", "NA", "null"], ["true", "false"], ["inf", "-0", "2"]]
)
def test_names_stay_text_whatever_they_look_like(tmp_path, names):
    numbers = [*range(len(names) - 1), math.nan]
    frame = pd.DataFrame({"frequency": names, "printed": names, "x": numbers})
    write_csv(tmp_path / "t.csv", frame)
    back = read_csv(tmp_path / "t.csv")
    assert list(back["frequency"]) == list(back["printed"]) == names
    assert list(back["x"][:-1]) == numbers[:-1]
    assert math.isnan(list(back["x"])[-1])
    assert list(read_csv(tmp_path / "t.csv", str)["x"]) == [*map(str, map(float, numbers[:-1])), ""]


def test_fewer_digits_hide_what_a_processor_changes(tmp_path):
    # The furthest that read-outs and statistics were seen to move; away from a tie, where any difference decides.
    for digits, moved in ((READ_OUT_DIGITS, 5e-14), (STATISTICAL_DIGITS, 3e-7)):
        for name, factor in (("a.csv", 1.0), ("b.csv", 1.0 + moved)):
            frame = pd.DataFrame({"x": [factor * 0.01234567890123, math.nan], "n": [1, 2]})
            write_csv(tmp_path / name, frame, digits)
        assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert (tmp_path / "a.csv").read_text() == "x,n\n0.0123457,1\n,2\n"


def test_rows_are_written_as_the_same_table_is(tmp_path):
    columns = {
        "a": np.array([1 / 3, math.nan, -math.inf]),
        "n": [1, 2, 3],
        "w": ["x, y", "", 'a "quote"'],
    }
    write_csv(tmp_path / "frame.csv", pd.DataFrame(columns))
    rows = [{name: values[i] for name, values in columns.items()} for i in range(3)]
    write_rows(tmp_path / "rows.csv", rows)
    assert (tmp_path / "rows.csv").read_bytes() == (tmp_path / "frame.csv").read_bytes()


def test_a_second_trip_changes_nothing(tmp_path):
    frame = pd.DataFrame({"a": [math.pi, math.e * 1e-7]})
    write_csv(tmp_path / "1.csv", frame)
    write_csv(tmp_path / "2.csv", read_csv(tmp_path / "1.csv"))
    assert (tmp_path / "1.csv").read_bytes() == (tmp_path / "2.csv").read_bytes()


def test_json_keeps_every_bit_and_refuses_nan(tmp_path):
    write_json(tmp_path / "a.json", {"x": 0.1 + 0.2})
    assert "0.30000000000000004" in (tmp_path / "a.json").read_text()
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(tmp_path / "a.json", {"x": math.nan})
    assert "0.30000000000000004" in (tmp_path / "a.json").read_text()


def test_parquet_has_the_same_bytes_each_time(tmp_path):
    frame = pd.DataFrame({"t_s": [0.0, 0.1], "x_m": [1.0, 2.0]})
    for name in ("a.parquet", "b.parquet"):
        write_parquet(tmp_path / name, frame)
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "a.parquet"), frame)


def test_what_was_left_unfinished_is_removed(tmp_path):
    (tmp_path / "site").mkdir()
    (tmp_path / "site/index.html").touch()
    (tmp_path / "paper/.~site-x/ready").mkdir(parents=True)
    (tmp_path / "paper/.~claims-y.csv").touch()
    remove_unfinished(tmp_path)
    assert {path.name for path in tmp_path.rglob("*")} == {"site", "index.html", "paper"}
