"""Identification from measured records through the workflow."""

from __future__ import annotations

import json

import pandas as pd
import pytest
import yaml

from dampbalance import identify
from dampbalance.identification.outputs import OUTPUTS
from folders import restored

pytestmark = pytest.mark.slow

EXAMPLE = "config/measured.yaml"
SET = "measured/below_resonance"


@pytest.fixture(scope="module")
def built(checkout):
    copy = checkout()
    return copy, copy.made("--configfile", EXAMPLE)


def test_everything_is_made_and_shown(built):
    copy, said = built
    files = copy.files("example")
    of_the_set = {f"{SET}/{name}" for name in (*OUTPUTS, ".complete")}
    assert set(files) == {"measured/identification.csv", *of_the_set}
    summary = files[f"{SET}/summary.txt"].decode()
    assert summary.splitlines()[3] in said


def test_the_workflow_says_what_the_package_says(built, monkeypatch):
    copy, _ = built
    monkeypatch.chdir(copy.folder)
    records = [f"config/records/example/level{i}.csv" for i in range(1, 6)]
    direct = identify(records, 2310.0, frequency=3.5, mass=2.42)
    assert json.loads(copy.files("example")[f"{SET}/identification.json"]) == json.loads(
        json.dumps(direct.document())
    )
    table = pd.read_csv(copy.folder / "results/example/measured/identification.csv")
    assert set(table["set"]) == {"below_resonance"}
    assert len(table) == 6  # the fit, and five approaches


def test_a_bad_record_leaves_the_results_as_they_are_and_fails_until_it_is_mended(built):
    copy, _ = built
    results = {f: data for f, data in copy.files("example").items() if not f.endswith(".complete")}
    record = copy.folder / "config/records/example/level2.csv"
    good = record.read_text(encoding="utf-8")
    lines = good.splitlines(keepends=True)
    lines[499] = "0.598,none here,0,0\n"
    record.write_text("".join(lines), encoding="utf-8")
    for _ in range(2):  # the second time, every result is there and newer than the record
        assert "level2.csv: line 500, column" in copy.refused("--configfile", EXAMPLE)
        assert copy.files("example") == results
    record.write_text(good, encoding="utf-8")
    copy.made("--configfile", EXAMPLE)
    assert copy.files("example") == results | {f"{SET}/.complete": b""}


@pytest.mark.parametrize("name", ["identification.csv", "summary.txt", "cycles.png", ".complete"])
def test_a_result_that_is_missing_is_made(built, name):
    copy, _ = built
    result = copy.folder / "results/example" / SET / name
    with restored(result):
        result.unlink()
        assert copy.jobs("--configfile", EXAMPLE)["identify"] == 1


def test_nothing_is_done_twice_and_a_record_that_changes_is_read_again(built):
    copy, _ = built
    assert copy.jobs("--configfile", EXAMPLE) == {}
    record = copy.folder / "config/records/example/level3.csv"
    lines = record.read_text(encoding="utf-8").splitlines()
    record.write_text("\n".join(lines[:-100]) + "\n", encoding="utf-8")
    assert copy.jobs("--configfile", EXAMPLE) == {
        "all": 1,
        "identify": 1,
        "measured": 1,
        "total": 3,
    }


def against(copy, change):
    """What is said against a case of one's own: the example with a change of its set of records."""
    document = yaml.safe_load((copy.folder / EXAMPLE).read_text(encoding="utf-8"))
    document["case"] = "mine"
    document["measured"][0] |= change
    (copy.folder / "mine.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    return copy.refused("--configfile", "mine.yaml")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"records": ["data/none*.csv"]},
            "measured[1].records[1]: no file data/none*.csv: name files",
        ),
        ({"stiffness_N_per_m": 0.0}, "measured[1].stiffness_N_per_m"),
        ({"stiffness": 2310.0}, "stiffness"),
        ({"approaches": ["best"]}, "measured[1].approaches[1]"),
        ({"name": "two words"}, "measured[1].name"),
        ({"terms": ["F_k", "c_9"]}, "measured[1].terms[2]: 'c_9' is not a term"),
        ({"given": {"c_2": 1.0}, "terms": ["F_k", "c"]}, "c_2 is given and no term of the law"),
        ({"groups": {"F_k": ["a", "b"]}}, "the groups of F_k name 2 records, and there are 5"),
    ],
)
def test_a_wrong_configuration_is_refused_before_anything_runs(built, change, message):
    copy, _ = built
    said = against(copy, change)
    assert "mine.yaml" in said
    assert message in said
    assert not (copy.folder / "results/mine").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequency_hz": 7.0}, "level1.csv: the excitation oscillates at 3.49999"),
        ({"largest": 1000}, "numbers, more than 1,000; give a part of the record"),
    ],
)
def test_a_record_that_cannot_be_used_is_named(built, change, message):
    said = against(built[0], change)
    assert "error: config/records/example/level1.csv: " in said
    assert message in said
