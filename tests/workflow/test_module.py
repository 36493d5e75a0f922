"""Used by another workflow as a module, from a folder that is not the project's, the results are the same bytes."""

from __future__ import annotations

import json
import os

import pytest
import yaml

from folders import restored
from workflow.copies import SMALL, Checkout

pytestmark = pytest.mark.slow

FOREIGN = """\
configfile: "config/config.yaml"


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
# The rules have other names, and the case is the paper's.
PAPER = """\
module paper:
    snakefile: "{project}/Snakefile"


use rule * from paper as paper_*
"""


@pytest.fixture(scope="module")
def foreign(built, tmp_path_factory):
    """A folder with a workflow and a configuration of its own."""
    folder = tmp_path_factory.mktemp("foreign")
    project = os.path.relpath(built.folder, folder)
    (folder / "Snakefile").write_text(FOREIGN.format(project=project), encoding="utf-8")
    (folder / "config").mkdir()
    small = yaml.safe_load((built.folder / SMALL[1]).read_text(encoding="utf-8"))
    text = yaml.safe_dump({"small": small}, sort_keys=False)
    (folder / "config/config.yaml").write_text(text, encoding="utf-8")
    return Checkout(folder, built.folder)


@pytest.fixture(scope="module")
def made(foreign):
    """Part of what could be made there, by a rule of the folder's own and by names of rules."""
    before = {path for path in foreign.project.rglob("*") if path.is_file()}
    foreign.made("mine", "tables", "manifest")
    kept = {path for path in foreign.project.rglob("*") if path.is_file()}
    # In the project's folder appear compiled modules and kernels, and nothing else.
    assert {path.suffix for path in kept - before} <= {".pyc", ".nbi", ".nbc"}
    return foreign


def test_the_results_are_those_of_the_project_itself(made, built):
    files, there = made.files("small"), built.files("small")
    assert {f"tables/{name}.csv" for name in ("table1", "table3_above", "approaches")} <= set(files)
    assert {"report.html", "figures/figure3.svg", "estimates/exact/above.csv"} <= set(files)
    different = [name for name in files if files[name] != there[name]]
    assert different == ["manifest.json"]


def test_the_manifest_names_files_as_the_project_does(made, built):
    here, there = (
        json.loads((copy.folder / "results/small/manifest.json").read_text(encoding="utf-8"))
        for copy in (made, built)
    )
    assert here["run"] == there["run"]
    here, there = here["reproducible"], there["reproducible"]
    different = {key for key in there if here[key] != there[key]}
    # What differs from the paper's case stands in a file of the other project, and here as merged.
    assert different == {"configuration_files", "sources", "sources_sha256"}
    assert here["configuration_files"] == ["config/config.yaml"]
    del there["sources"]["small.yaml"]
    assert here["sources"] == there["sources"]


def test_nothing_is_made_twice_and_the_rule_of_the_other_workflow_stays_its_default(made):
    assert made.jobs("mine", "tables", "manifest") == {}
    assert made.jobs() == {}
    assert made.jobs("--force") == {"mine": 1, "total": 1}


def test_everything_of_the_paper_could_be_made(made, tmp_path):
    project = os.path.relpath(made.project, tmp_path)
    (tmp_path / "Snakefile").write_text(PAPER.format(project=project), encoding="utf-8")
    jobs = Checkout(tmp_path, made.project).jobs("paper_all")
    wanted = {"all", "article", "check", "claims", "manifest", "notebook", "page"}
    assert {f"paper_{name}" for name in wanted} <= set(jobs)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"oscillator": {"F_k_N": -1.0}}, "oscillator.F_k_N: -1.0 is not allowed."),
        ({"levels": [1.0]}, "levels: unknown key"),
    ],
)
def test_a_wrong_value_that_the_other_workflow_sets_is_named(foreign, change, expected):
    file = foreign.folder / "config/config.yaml"
    with restored(file):
        config = yaml.safe_load(file.read_text(encoding="utf-8"))
        config["small"] |= change
        file.write_text(yaml.safe_dump(config, sort_keys=False), encoding="utf-8")
        said = foreign.refused("--dry-run", "mine")
    assert f"configuration: {expected}" in said


def test_the_workflow_runs_in_another_folder(built, tmp_path):
    snakefile = ("--snakefile", str(built.folder / "Snakefile"))
    small = ("--configfile", str(built.folder / SMALL[1]))
    elsewhere = Checkout(tmp_path, built.folder)
    elsewhere.made("estimates", *snakefile, *small)
    assert elsewhere.files("small/estimates") == built.files("small/estimates")
