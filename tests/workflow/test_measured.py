"""Identification from measured records through the workflow."""

from __future__ import annotations

import json
import re
from contextlib import chdir

import pandas as pd
import pytest
import yaml

from dampbalance import identify
from dampbalance.commands.main import main
from dampbalance.identification.outputs import OUTPUTS, OVERVIEW, outputs_of
from folders import ROOT, restored
from workflow.copies import EXAMPLE, PROFILE, copied

pytestmark = pytest.mark.slow

SET = "measured/below_resonance"


@pytest.fixture(scope="module")
def built(example, tmp_path_factory):
    return copied(example, tmp_path_factory.mktemp("built"), "results/example", ".snakemake")


def test_everything_is_made_and_shown(built, example):
    files = built.files("example")
    of_the_set = {f"{SET}/{name}" for name in (*OUTPUTS, ".complete")}
    of_all = {f"measured/{name}" for name in OVERVIEW}
    assert set(files) == of_all | of_the_set
    summary = files[f"{SET}/summary.txt"].decode()
    assert summary.splitlines()[3] in (example / "example.txt").read_text(encoding="utf-8")


def test_the_workflow_says_what_the_package_says(built, monkeypatch):
    monkeypatch.chdir(built.folder)
    records = [f"config/records/example/level{i}.csv" for i in range(1, 6)]
    direct = identify(records, 2310.0, frequency=3.5, mass=2.42)
    assert json.loads(built.files("example")[f"{SET}/identification.json"]) == json.loads(
        json.dumps(direct.document())
    )
    table = pd.read_csv(built.folder / "results/example/measured/identification.csv")
    assert set(table["set"]) == {"below_resonance"}
    assert len(table) == 2  # the fit, and the balance that checks it


def test_a_bad_record_leaves_the_results_as_they_are_and_fails_until_it_is_mended(built):
    before = built.files("example")
    record = built.folder / "config/records/example/level2.csv"
    good = record.read_text(encoding="utf-8")
    lines = good.splitlines(keepends=True)
    lines[499] = "0.598,none here,0,0\n"
    record.write_text("".join(lines), encoding="utf-8")
    for _ in range(2):  # the second time, every result is there and newer than the record
        assert "level2.csv: line 500, column" in built.refused(*EXAMPLE)
        kept = built.files("example")
        assert {f: kept[f] for f in kept if f.startswith(SET)} == {
            f: before[f] for f in before if f.startswith(SET) and not f.endswith(".complete")
        }
        assert b"below_resonance: config/records/example/level2" in kept["measured/summary.txt"]
    record.write_text(good, encoding="utf-8")
    built.made(*EXAMPLE)
    assert built.files("example") == before


def test_what_is_missing_or_changed_is_made_again_and_nothing_is_done_twice(built):
    assert built.jobs(*EXAMPLE) == {}
    again = {"all": 1, "identify_forced": 1, "measured": 1, "total": 3}
    missing = built.folder / "results/example" / SET / "cycles.png"
    with restored(missing):
        missing.unlink()
        assert built.jobs(*EXAMPLE)["identify_forced"] == 1
    package = "src/dampbalance"
    for name in (
        f"{package}/identification/templates/report.css",
        f"{package}/project/schemas/mapping.schema.yaml",
        "config/records/example/level3.csv",
    ):
        file = built.folder / name
        with restored(file):
            file.write_text(file.read_text(encoding="utf-8") + "\n", encoding="utf-8")
            assert built.jobs(*EXAMPLE) == again


def test_a_table_of_a_stepped_sine_is_a_set(checkout, monkeypatch):
    copy = checkout()
    said = copy.made(*PROFILE, "--configfile", "config/stepped.yaml")
    files = copy.files("stepped")
    assert {f"measured/joint/{name}" for name in outputs_of("stepped-sine")} <= files.keys()
    monkeypatch.chdir(copy.folder)
    direct = identify("config/records/stepped/levels.csv", kind="stepped-sine")
    assert direct.text().splitlines()[3] in said
    document = json.loads(files["measured/joint/identification.json"])
    assert document == json.loads(json.dumps(direct.document()))


@pytest.fixture(scope="module")
def rig(checkout):
    """The example of several sets in the README of records, with a set before them whose record is broken."""
    copy = checkout()
    text = (ROOT / "config/records/README.md").read_text(encoding="utf-8")
    text = text[text.index("### Several sets at once") :]
    with chdir(copy.folder):
        for line in re.findall(r"^dampbalance (.+)", text, re.MULTILINE)[:4]:
            assert main(line.split()) == 0
    (copy.folder / "rig.yaml").write_text(re.search(r"```yaml\n(.+?)```", text, re.DOTALL)[1])
    decay = (copy.folder / "decay.csv").read_text(encoding="utf-8")
    (copy.folder / "broken.csv").write_text(
        decay.replace("\n0.1,", "\nnothing,", 1), encoding="utf-8"
    )
    document = yaml.safe_load((copy.folder / "rig.yaml").read_text(encoding="utf-8"))
    broken = document["measured"][1] | {"name": "broken", "records": ["broken.csv"]}
    document["measured"].insert(0, broken)
    text = yaml.safe_dump(document, sort_keys=False)
    (copy.folder / "all.yaml").write_text(text, encoding="utf-8")
    return copy


def test_a_set_that_fails_stands_with_its_error_beside_the_others(rig):
    """On one core: without it, those that wait for the core would not be identified."""
    done = rig.run(*PROFILE, "--configfile", "all.yaml", cores=1)
    assert done.returncode != 0
    files = rig.files("rig")
    shown = files["measured/summary.txt"].decode()
    assert shown in done.stdout
    assert "2 of 3 sets of records identified" in shown
    (error,) = (line for line in shown.splitlines() if line.startswith("broken:"))
    assert re.fullmatch(
        r"broken: broken\.csv: line \d+, column 'time': 'nothing' is not a number", error
    )
    for name, kind in (("steady", "forced"), ("released", "ring-down")):
        assert {f"measured/{name}/{file}" for file in outputs_of(kind)} <= files.keys()
    assert not any(name.startswith("measured/broken") for name in files)
    assert [line.split()[0] for line in shown.splitlines()[3:6]] == ["broken", "steady", "released"]
    table = pd.read_csv(rig.folder / "results/rig/measured/identification.csv")
    assert dict(table["set"].value_counts()) == {"steady": 2, "released": 2, "broken": 1}
    assert table["error"].notna().tolist() == (table["set"] == "broken").tolist()
    # the decay is that of 0.5 N and 1 N s/m: each interval holds its value, or all but does
    decays = table[table["set"] == "released"]
    assert decays["F_k_N"].to_numpy() == pytest.approx(0.5, rel=0.02)
    assert decays["c_N_s_per_m"].to_numpy() == pytest.approx(1.0, rel=0.1)


def test_without_the_set_that_failed_nothing_is_left_of_it(rig):
    own = ("--configfile", "rig.yaml")
    assert rig.jobs(*own) == {"all": 1, "measured": 1, "total": 2}  # the others are not repeated
    rig.made(*own)
    shown = rig.files("rig")["measured/summary.txt"].decode()
    assert "2 of 2 sets" in shown
    assert "broken" not in shown
    assert rig.jobs(*own) == {}


def against(copy, *changes):
    """Messages about a case of one's own: the example with changes of its set of records, a set for each."""
    document = yaml.safe_load((copy.folder / EXAMPLE[1]).read_text(encoding="utf-8"))
    (one,) = document["measured"]
    sets = [one | {"name": f"set{n}"} | change for n, change in enumerate(changes, 1)]
    text = yaml.safe_dump(document | {"case": "mine", "measured": sets})
    (copy.folder / "mine.yaml").write_text(text, encoding="utf-8")
    return copy.refused("--configfile", "mine.yaml")


def test_what_the_schema_forbids_is_refused_at_once_before_anything_runs(built):
    wrong = (
        ({"stiffness_N_per_m": 0.0}, "measured[1].stiffness_N_per_m: 0.0 is not allowed"),
        ({"stiffness": 2310.0}, "measured[2].stiffness: unknown key"),
        (
            {"kind": "decay"},
            "measured[3].kind: 'decay' is not allowed. forced (forced records), ring",
        ),
        ({"name": "two words"}, "measured[4].name: 'two words' cannot be a name"),
        ({"terms": ["F_k", "c_9"]}, "measured[5].terms[2]: 'c_9' is not a term"),
    )
    said = against(built, *(change for change, _ in wrong))
    for _, message in wrong:
        assert message in said
    assert said.count("mine.yaml: line ") == len(wrong)
    assert not (built.folder / "results/mine").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"records": ["data/none*.csv"]}, "measured[1].records[1]: no file data/none*.csv: name"),
        ({"kind": "ring-down"}, "measured[1].frequency_hz: is for forced records"),
        (
            {"mass_kg": None, "mass_standard_error_kg": 0.01},
            "measured[1].mass_standard_error_kg: has no effect without mass_kg",
        ),
        ({"given": {"c_2": 1.0}, "terms": ["F_k", "c"]}, "c_2 is given and no term of the law"),
        ({"groups": {"F_k": ["a", "b"]}}, "the groups of F_k have 2 labels for 5 records"),
    ],
)
def test_a_set_that_contradicts_itself_is_refused_before_anything_runs(built, change, message):
    said = against(built, change)
    assert "mine.yaml: line " in said
    assert message in said
    assert not (built.folder / "results/mine").exists()


def test_a_record_that_cannot_be_used_is_named(built):
    said = against(built, {"frequency_hz": 7.0})
    assert "error: config/records/example/level1.csv: the excitation oscillates at 3.49999" in said
