"""Used by another workflow as a module, from a folder that is not the project's, the results are the same bytes."""

from __future__ import annotations

import json
import os

import pytest

from folders import restored
from workflow.copies import SMALL, Checkout, dump, read

pytestmark = pytest.mark.slow

FOREIGN = """\
configfile: "config.yaml"


rule mine:
    input:
        "results/small/tables/table1.csv",
    output:
        "mine.txt",
    shell:
        "head -n 1 {{input}} > {{output}}"


module small:
    snakefile: "{project}/workflow/Snakefile"
    config: config["small"]


use rule * from small
"""
TARGETS = ("mine", "tables", "manifest")


@pytest.fixture(scope="module")
def foreign(whole, tmp_path_factory):
    """A folder with a workflow and a configuration of its own, and part of what could be made there, on one core."""
    folder = tmp_path_factory.mktemp("foreign")
    dump(folder / "config.yaml", {"small": read(whole.folder / SMALL[1])})
    text = FOREIGN.format(project=os.path.relpath(whole.folder, folder))
    (folder / "Snakefile").write_text(text, encoding="utf-8")
    before = {path for path in whole.folder.rglob("*") if path.is_file()}
    foreign = Checkout(folder)
    foreign.made(*TARGETS, cores=1)
    assert {path for path in whole.folder.rglob("*") if path.is_file()} == before
    return foreign


def test_the_results_are_those_of_the_project_itself(foreign, whole):
    files, there = foreign.files("small"), whole.files("small")
    assert {"tables/table3_above.csv", "report.html", "estimates/exact/above.csv"} <= set(files)
    assert [name for name in files if files[name] != there[name]] == ["manifest.json"]
    mine, theirs = (json.loads(of["manifest.json"])["reproducible"] for of in (files, there))
    # What differs from the paper's case stands in a file of the other project, and here as merged.
    different = {key for key in theirs if mine[key] != theirs[key]}
    assert different == {"configuration_files", "sources", "sources_sha256"}
    assert theirs["sources"].keys() - mine["sources"].keys() == {"small.yaml"}


def test_nothing_is_made_twice_and_the_rule_of_the_other_workflow_stays_its_default(foreign):
    assert foreign.jobs(*TARGETS) == {}
    said = foreign.made("--dry-run", "--force")
    assert "rule mine:" in said
    assert "Everything is rebuilt" not in said


def test_a_wrong_value_that_the_other_workflow_sets_is_named(foreign):
    file = foreign.folder / "config.yaml"
    with restored(file):
        dump(file, {"small": read(file)["small"] | {"oscillator": {"F_k_N": -1.0}}})
        said = foreign.refused("--dry-run", "mine")
    assert "configuration: oscillator.F_k_N: -1.0 is not allowed." in said
