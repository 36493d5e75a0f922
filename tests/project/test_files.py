"""Results are written whole or not at all, and read back as they were."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from dampbalance.project import files


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    file, plain_file = tmp_path / "a/result.txt", tmp_path / "plain.txt"
    files.write_text(file, "old")
    plain_file.write_text("x")
    assert file.stat().st_mode == plain_file.stat().st_mode  # as the user has it

    def fail():
        with files.replacing(file) as temporary:
            temporary.write_text("new")
            raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        fail()
    assert file.read_text() == "old"
    assert [*file.parent.iterdir()] == [file]


def test_a_table_comes_back_to_fifteen_digits_and_the_second_time_as_it_is(tmp_path):
    columns = {"a": np.array([1 / 3, math.nan, 1e-300]), "n": [1, 2, 3], "w": ["x", "", 'z, "w"']}
    files.write_csv(tmp_path / "t.csv", pd.DataFrame(columns))
    back = files.read_csv(tmp_path / "t.csv")
    # Fifteen significant digits: half a unit of the last is at most 5e-15 of the value.
    assert list(back["a"]) == pytest.approx([*columns["a"]], rel=5e-15, abs=0.0, nan_ok=True)
    assert (list(back["n"]), list(back["w"])) == (columns["n"], columns["w"])
    assert (tmp_path / "t.csv").read_bytes().splitlines()[1] == b"0.333333333333333,1,x"
    files.write_csv(tmp_path / "again.csv", back)
    files.write_rows(tmp_path / "rows.csv", pd.DataFrame(columns).to_dict("records"))
    for name in ("again.csv", "rows.csv"):
        assert (tmp_path / name).read_bytes() == (tmp_path / "t.csv").read_bytes()


@pytest.mark.parametrize(
    "names", [["1", "01", "1e3"], ["nan", "NA", "null"], ["true", "inf", "-0"]]
)
def test_names_stay_text_whatever_they_look_like(tmp_path, names):
    frame = pd.DataFrame({"frequency": names, "printed": names, "x": [0, 1, math.nan]})
    files.write_csv(tmp_path / "t.csv", frame)
    back = files.read_csv(tmp_path / "t.csv")
    assert list(back["frequency"]) == list(back["printed"]) == names
    np.testing.assert_array_equal(back["x"], frame["x"])
    assert list(files.read_csv(tmp_path / "t.csv", str)["x"]) == ["0.0", "1.0", ""]


def test_fewer_digits_hide_what_a_processor_changes(tmp_path):
    # The furthest that read-outs and statistics were seen to move; away from a tie, where any difference decides.
    for digits, moved in ((files.READ_OUT_DIGITS, 5e-14), (files.STATISTICAL_DIGITS, 3e-7)):
        for name, factor in (("a.csv", 1.0), ("b.csv", 1.0 + moved)):
            frame = pd.DataFrame({"x": [factor * 0.01234567890123, math.nan], "n": [1, 2]})
            files.write_csv(tmp_path / name, frame, digits)
        assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert (tmp_path / "a.csv").read_text() == "x,n\n0.0123457,1\n,2\n"


def test_json_and_parquet_keep_every_bit_and_json_refuses_nan(tmp_path):
    files.write_json(tmp_path / "a.json", {"x": 0.1 + 0.2})
    with pytest.raises(ValueError, match="not JSON compliant"):
        files.write_json(tmp_path / "a.json", {"x": math.nan})
    assert "0.30000000000000004" in (tmp_path / "a.json").read_text()
    data = {"x": (np.array([1.0, math.inf]), math.nan), "n": np.int64(3)}
    assert files.plain(data) == {"x": [[1.0, None], None], "n": 3}
    frame = pd.DataFrame({"t_s": [0.0, 0.1], "x_m": [1.0, 2.0]})
    for name in ("a.parquet", "b.parquet"):
        files.write_parquet(tmp_path / name, frame)
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "a.parquet"), frame)


def test_what_was_left_unfinished_is_removed(tmp_path):
    (tmp_path / "site").mkdir()
    (tmp_path / "paper/.~site-x/ready").mkdir(parents=True)
    (tmp_path / "paper/.~claims-y.csv").touch()
    files.remove_unfinished(tmp_path)
    assert {path.name for path in tmp_path.rglob("*")} == {"site", "paper"}
