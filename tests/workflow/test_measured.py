"""Identification from measured records through the workflow."""

from __future__ import annotations

import json
import os
import re
import time
from contextlib import chdir

import pandas as pd
import pytest
import yaml

from dampbalance import identify
from dampbalance.commands.main import main
from dampbalance.identification.outputs import OUTPUTS, OVERVIEW, outputs_of
from folders import ROOT, restored
from workflow.copies import EXAMPLE, PROFILE, copied, dump, edited, read

pytestmark = pytest.mark.slow

SET = "measured/below_resonance"
IDENTIFY = "F_k, c and K_z from the records of below_resonance"
ALL_SETS = "Estimates of all sets of records"


@pytest.fixture(scope="module")
def built(example, tmp_path_factory):
    return copied(example, tmp_path_factory.mktemp("built"), "results", ".snakemake", "example.txt")


def document_of(folder, records, **options):
    """What the package says of records in a folder, as the workflow writes it."""
    with chdir(folder):
        return json.loads(json.dumps(identify(records, **options).document()))


def test_everything_is_made_and_shown_and_is_what_the_package_says(built):
    files = built.files("example")
    of_the_set = {f"{SET}/{name}" for name in (*OUTPUTS, ".complete")}
    assert set(files) == {f"measured/{name}" for name in OVERVIEW} | of_the_set
    summary = files[f"{SET}/summary.txt"].decode()
    assert summary.splitlines()[3] in (built.folder / "example.txt").read_text(encoding="utf-8")
    records = [f"config/records/example/level{i}.csv" for i in range(1, 6)]
    options = {"stiffness": 2310.0, "frequency": 3.5, "mass": 2.42}
    direct = document_of(built.folder, records, **options)
    assert json.loads(files[f"{SET}/identification.json"]) == direct
    table = pd.read_csv(built.folder / "results/example/measured/identification.csv")
    assert [*table["set"]] == ["below_resonance"] * 2  # the fit, and the balance that checks it


def test_what_is_missing_or_changed_is_made_again(built):
    missing = built.folder / "results/example" / SET / "cycles.png"
    record = built.folder / "config/records/example/level3.csv"
    with edited(record, {"\n0.1,": "\n0.1000,"}), restored(missing):
        missing.unlink()
        jobs = built.jobs(*EXAMPLE)
    assert jobs.keys() == {IDENTIFY, ALL_SETS, "Everything is rebuilt"}
    assert "cycles.png" in jobs[IDENTIFY]
    assert "level3.csv" in jobs[IDENTIFY]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"terms": ["F_k", "c_9"]}, "measured[1].terms[2]: 'c_9' is not a term"),
        ({"records": ["none*.csv"]}, "measured[1].records[1]: no file none*.csv: name"),
        ({"records": ["data"]}, "measured[1].records[1]: data is a folder"),
        ({"mapping": "none.yaml"}, "measured[1].mapping: no file or folder none.yaml"),
        ({"mapping": "data"}, "measured[1].mapping: the folder data has no mapping of level1"),
        ({"mapping": "parts.yaml"}, "parts.yaml: line 2: channels.displacement.file: no file"),
        ({"kind": "ring-down"}, "measured[1].frequency_hz: is for forced records"),
        ({"mass_kg": None, "mass_standard_error_kg": 0.01}, "has no effect without mass_kg"),
        ({"given": {"c_2": 1.0}, "terms": ["F_k", "c"]}, "c_2 is given and no term of the law"),
        ({"groups": {"F_k": ["a", "b"]}}, "the groups of F_k have 2 labels for 5 records"),
    ],
)
def test_a_set_that_contradicts_itself_or_lacks_a_file_is_refused(built, change, message):
    (built.folder / "data").mkdir(exist_ok=True)
    channels = "channels:\n  displacement: {file: none.csv, channel: 1, unit: mm}\n"
    (built.folder / "parts.yaml").write_text(channels, encoding="utf-8")
    document = read(built.folder / EXAMPLE[1])
    sets = [document["measured"][0] | change]
    dump(built.folder / "mine.yaml", document | {"case": "mine", "measured": sets})
    assert message in built.refused("--configfile", "mine.yaml")
    assert not (built.folder / "results/mine").exists()


NAMED = {
    "data/one.csv": "1\n",
    "data/base.csv": "1\n",
    "maps/one.yaml": """
channels:
  base_displacement: {file: base.csv, channel: 1, unit: mm}
  displacement: {channel: 1, unit: mm}
sample_rate_hz: 100
""",
}
CASE = """
case: named
published: null
measured:
  - {name: set, records: [data/one.csv], mapping: maps/one.yaml, stiffness_N_per_m: 2310.0}
"""


def test_every_file_that_a_set_names_is_read_again_when_it_changes(checkout):
    """All results are there, newer than what they are made of: there is nothing to do."""
    made = [f"results/named/measured/set/{name}" for name in (*OUTPUTS, ".complete")]
    made += [f"results/named/measured/{name}" for name in OVERVIEW]
    for name, text in (NAMED | {"named.yaml": CASE} | dict.fromkeys(made, "1\n")).items():
        (checkout.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (checkout.folder / name).write_text(text, encoding="utf-8")
    assert checkout.jobs("--configfile", "named.yaml") == {}
    soon = time.time() + 60.0
    for name in NAMED:
        os.utime(checkout.folder / name, (soon, soon))
    reason, *_ = checkout.jobs("--configfile", "named.yaml").values()
    assert {*re.search(r"Updated input files: ([^;]+)", reason)[1].split(", ")} == {*NAMED}


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


def test_a_table_of_a_stepped_sine_is_a_set(checkout):
    checkout.made(*PROFILE, "--configfile", "config/stepped.yaml")
    files = checkout.files("stepped")
    assert {f"measured/joint/{name}" for name in outputs_of("stepped-sine")} <= files.keys()
    records = "config/records/stepped/levels.csv"
    document = document_of(checkout.folder, records, kind="stepped-sine")
    assert json.loads(files["measured/joint/identification.json"]) == document


def test_a_set_that_fails_stands_with_its_error_beside_the_others_until_it_is_left_out(checkout):
    """The example of several sets in the README of configurations, with a set before them whose record is broken."""
    text = (ROOT / "config/README.md").read_text(encoding="utf-8")
    text = text[text.index("## Measured records") :]
    with chdir(checkout.folder):
        for line in re.findall(r"^dampbalance (.+)", text, re.MULTILINE)[:4]:
            assert main(line.split()) == 0
    document = yaml.safe_load(re.search(r"```yaml\n(.+?)```", text, re.DOTALL)[1])
    dump(checkout.folder / "rig.yaml", document)
    decay = (checkout.folder / "decay.csv").read_text(encoding="utf-8")
    broken = decay.replace("\n0.1,", "\nnothing,", 1)
    (checkout.folder / "broken.csv").write_text(broken, encoding="utf-8")
    wrong = document["measured"][1] | {"name": "broken", "records": ["broken.csv"]}
    document["measured"].insert(0, wrong)
    dump(checkout.folder / "all.yaml", document)
    # on one core: without the profile, those that wait for the core would not be identified
    done = checkout.run(*PROFILE, "--configfile", "all.yaml", cores=1)
    assert done.returncode != 0
    files = checkout.files("rig")
    assert files["measured/summary.txt"].decode() in done.stdout
    assert "2 of 3 sets of records identified" in done.stdout
    assert "\nbroken: broken.csv: line" in done.stdout
    for name, kind in (("steady", "forced"), ("released", "ring-down")):
        assert {f"measured/{name}/{file}" for file in outputs_of(kind)} <= files.keys()
    assert not any(name.startswith("measured/broken") for name in files)
    table = pd.read_csv(checkout.folder / "results/rig/measured/identification.csv")
    assert dict(table["set"].value_counts()) == {"steady": 2, "released": 2, "broken": 1}
    without = ("--configfile", "rig.yaml")
    assert checkout.jobs(*without).keys() == {ALL_SETS, "Everything is rebuilt"}
    checkout.made(*without)
    assert "2 of 2 sets" in checkout.files("rig")["measured/summary.txt"].decode()
    assert checkout.jobs(*without) == {}
