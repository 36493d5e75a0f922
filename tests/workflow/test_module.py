"""Used by another workflow as a module, from a folder that is not the project's, the results are the same bytes."""

from __future__ import annotations

import json
import os
import re

import pytest
import yaml

from folders import contents, restored
from workflow.copies import EXAMPLE, SMALL, Checkout

pytestmark = pytest.mark.slow

IDENTIFIED = "example/measured/below_resonance"
# Three uses of one workflow: a small case below db/, measured records below example/, and the paper's case, whose rules
# alone have other names.
FOREIGN = """\
configfile: "config/config.yaml"


rule mine:
    input:
        "db/results/small/tables/table1.csv",
    output:
        "mine.txt",
    shell:
        "head -n 1 {{input}} > {{output}}"


module small:
    snakefile: "{project}/workflow/Snakefile"
    config: config["small"]
    prefix: "db"


use rule * from small as db_*


module example:
    snakefile: "{project}/workflow/Snakefile"
    config: config["example"]
    prefix: "example"


use rule * from example as example_*


module paper:
    snakefile: "{project}/Snakefile"


use rule * from paper as paper_*
"""
STUDY = """\
title: A study of the other project
axes:
  - omega_over_omega_n: {values: [1.0, 2.0]}
"""


@pytest.fixture(scope="module")
def foreign(built, tmp_path_factory):
    """A folder with a workflow, a configuration and a study of its own."""
    folder = tmp_path_factory.mktemp("foreign")
    project = os.path.relpath(built.folder, folder)
    (folder / "Snakefile").write_text(FOREIGN.format(project=project), encoding="utf-8")
    (folder / "config/studies").mkdir(parents=True)
    (folder / "config/studies/ours.yaml").write_text(STUDY, encoding="utf-8")
    small, example = (
        yaml.safe_load((built.folder / name).read_text(encoding="utf-8"))
        for name in (SMALL[1], EXAMPLE[1])
    )
    config = {"small": small, "example": example}
    (folder / "config/config.yaml").write_text(
        yaml.safe_dump(config, sort_keys=False), encoding="utf-8"
    )
    return Checkout(folder, built.folder)


@pytest.fixture(scope="module")
def made(foreign):
    """Part of what could be made there, by names of files and of rules, and by a rule of the folder's own."""
    before = {path for path in foreign.project.rglob("*") if path.is_file()}
    targets = ("mine", "db_tables", "db_manifest", "db/results/studies/ours/summary.md")
    foreign.made(*targets, f"example/results/{IDENTIFIED}/summary.txt")
    kept = {path for path in foreign.project.rglob("*") if path.is_file()}
    # In the project's folder appear compiled modules and kernels, and nothing else.
    assert {path.suffix for path in kept - before} <= {".pyc", ".nbi", ".nbc"}
    return foreign


def test_the_results_are_those_of_the_project_itself(made, built):
    files = contents(made.folder / "db/results/small")
    there = built.files("small")
    assert {f"tables/{name}.csv" for name in ("table1", "table3_above", "approaches")} <= set(files)
    assert {"report.html", "figures/figure3.svg", "estimates/exact/above.csv"} <= set(files)
    assert [name for name in files if files[name] != there[name]] == ["manifest.json"]


def test_the_manifest_names_files_as_the_project_does(made, built):
    here, there = (
        json.loads((folder / "results/small/manifest.json").read_text(encoding="utf-8"))
        for folder in (made.folder / "db", built.folder)
    )
    assert here["run"] == there["run"]
    here, there = here["reproducible"], there["reproducible"]
    different = {key for key in there if here[key] != there[key]}
    # What differs from the paper's case stands in a file of the other project, and here as merged.
    assert different == {"configuration_files", "sources", "sources_sha256"}
    assert here["configuration_files"] == ["config/config.yaml"]
    del there["sources"]["small.yaml"]
    assert here["sources"] == there["sources"]


def test_a_study_of_its_own_is_made_beside_those_of_the_project(made, built):
    ours = built.folder / "config/studies/ours.yaml"
    with restored(ours):
        ours.write_text(STUDY, encoding="utf-8")
        built.made("results/studies/ours/summary.md")
    assert contents(made.folder / "db/results/studies/ours") == built.files("studies/ours")
    assert made.jobs("db/results/studies/damping/summary.md")["db_small_studies"] == 1


def test_records_that_the_project_brings_along_are_identified(made, example):
    files = contents(made.folder / "example/results" / IDENTIFIED)
    # Records are named by their paths from the folder of the run on.
    way = os.path.relpath(made.project, made.folder).encode() + b"/"
    assert way in files["features.csv"]
    same = {name: data.replace(way, b"") for name, data in files.items()}
    assert same == contents(example / "results" / IDENTIFIED)


def test_nothing_is_made_twice(made):
    assert made.jobs("mine", "db_tables", "db_manifest") == {}


def test_the_rule_of_the_other_workflow_stays_its_default(made):
    assert made.jobs() == {}
    assert made.jobs("--force") == {"mine": 1, "total": 1}


def test_everything_of_the_paper_could_be_made(made):
    jobs = made.jobs("paper_all")
    wanted = {"all", "article", "check", "claims", "crate", "manifest", "notebook", "page"}
    assert {f"paper_{name}" for name in wanted} <= set(jobs)


@pytest.mark.parametrize(
    ("name", "change", "expected"),
    [
        ("small", {"oscillator": {"F_k_N": -1.0}}, "small.oscillator.F_k_N: -1.0 is not allowed."),
        ("small", {"levels": [1.0]}, "small.levels: unknown key"),
        (
            "example",
            {"measured": [{"name": "a b"}]},
            "example.measured[1].name: 'a b' cannot be a name",
        ),
    ],
)
def test_a_wrong_value_is_named_where_the_other_workflow_sets_it(foreign, name, change, expected):
    file = foreign.folder / "config/config.yaml"
    with restored(file):
        config = yaml.safe_load(file.read_text(encoding="utf-8"))
        config[name] |= change
        file.write_text(yaml.safe_dump(config, sort_keys=False), encoding="utf-8")
        lines = file.read_text(encoding="utf-8").splitlines()
        said = foreign.refused("--dry-run", "mine")
    line = int(
        re.search(rf"^config/config\.yaml: line (\d+): {re.escape(expected)}", said, re.MULTILINE)[
            1
        ]
    )
    assert expected.split(":")[0].rpartition(".")[2] in lines[line - 1]


def test_a_wrong_value_in_a_snakefile_is_named_with_that(foreign):
    file = foreign.folder / "Snakefile"
    with restored(file):
        text = file.read_text(encoding="utf-8")
        own = 'config: {"case": "small", "oscillator": {"F_k_N": -1.0}}'
        file.write_text(text.replace('config: config["small"]', own), encoding="utf-8")
        said = foreign.refused("--dry-run", "mine")
    assert re.search(r"^Snakefile: oscillator\.F_k_N: -1\.0 is not allowed", said, re.MULTILINE)


def test_a_prefix_for_some_paths_only_is_refused(made, tmp_path):
    project = os.path.relpath(made.project, tmp_path)
    (tmp_path / "Snakefile").write_text(
        f'module m:\n    snakefile: "{project}/Snakefile"\n'
        '    replace_prefix: {"results/": "ours/"}\n\nuse rule * from m\n',
        encoding="utf-8",
    )
    done = Checkout(tmp_path, made.project).run("--dry-run")
    assert done.returncode == 1
    assert "use prefix instead" in done.stdout + done.stderr


def test_the_workflow_runs_in_another_folder(built, tmp_path):
    snakefile = ("--snakefile", str(built.folder / "Snakefile"))
    small = ("--configfile", str(built.folder / SMALL[1]))
    elsewhere = Checkout(tmp_path, built.folder)
    elsewhere.made("estimates", *snakefile, *small)
    assert elsewhere.files("small/estimates") == built.files("small/estimates")
