"""Parameter studies through the workflow: small variants of the shipped ones, resumed, on one core, and wrong ones."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
import yaml

from dampbalance.studies import evaluate, reading_study
from folders import ROOT, restored

pytestmark = pytest.mark.slow

SMALL = Path(__file__).parent / "studies"
SHIPPED = ROOT / "config/studies"
NAMES = sorted(path.stem for path in SHIPPED.glob("*.yaml"))


def test_every_shipped_study_has_a_small_variant():
    assert sorted(path.stem for path in SMALL.glob("*.yaml")) == NAMES


@pytest.fixture(scope="module")
def studied(checkout):
    """The small variants of all shipped studies, computed on two cores."""
    copy = checkout()
    for name in NAMES:
        documents = [
            yaml.safe_load((folder / f"{name}.yaml").read_text(encoding="utf-8"))
            for folder in (SHIPPED, SMALL)
        ]
        write(copy, name, documents[0] | documents[1])
    copy.made("studies")
    return copy


def write(copy, name, document):
    path = copy.folder / f"config/studies/{name}.yaml"
    path.write_text(yaml.safe_dump(document, allow_unicode=True), encoding="utf-8")


def target(name):
    return f"results/studies/{name}/summary.md"


@pytest.mark.parametrize("name", NAMES)
def test_everything_is_made(studied, name):
    files = studied.files(f"studies/{name}")
    assert set(files) == {
        "cases.parquet",
        "manifest.json",
        "summary.csv",
        "summary.md",
        "figure.svg",
        "figure.png",
    }
    page = files["summary.md"].decode()
    assert "{" not in page  # every number is filled in
    assert " nan " not in page
    manifest = json.loads(files["manifest.json"])
    cases = pq.read_table(studied.folder / f"results/studies/{name}/cases.parquet")
    assert sum(manifest["cases_per_regime"].values()) == manifest["cases"] == cases.num_rows
    assert [column["name"] for column in manifest["columns"]] == cases.column_names
    for column in manifest["columns"]:
        described = cases.schema.field(column["name"]).metadata
        assert described[b"unit"].decode() == column["unit"]


@pytest.mark.parametrize("name", ["map", "frequency", "noise"])
def test_chunks_joined_are_the_study_computed_at_once(studied, name):
    study = reading_study.read_study(studied.folder / f"config/studies/{name}.yaml")
    cases = pd.read_parquet(studied.folder / f"results/studies/{name}/cases.parquet")
    whole = evaluate.evaluate(study, 0, study.cases)
    assert list(cases.columns) == list(whole.columns)
    for column in whole.columns:
        assert np.array_equal(
            cases[column].astype(whole[column].dtype).to_numpy(),
            whole[column].to_numpy(),
            equal_nan=column not in ("regime",),
        )


def test_a_second_run_does_nothing(studied):
    assert studied.jobs("studies") == {}


def test_a_new_title_computes_no_case_again(studied):
    path = studied.folder / "config/studies/map.yaml"
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    with restored(path):
        write(studied, "map", document | {"title": "Another title"})
        jobs = studied.jobs(target("map"))
    assert jobs.keys() - {"total"} == {"study_figure", "study_summary"}


def test_an_interrupted_study_resumes_and_ends_in_the_same_bytes(studied):
    """Two of four chunks are there, from one core; the rest is computed, in another order, and nothing else.

    What is made of the same cases is the same elsewhere: tests of the module and of SLURM compare it."""
    finished = studied.files("studies/map")
    folder = studied.folder / "results/studies/map"
    aside = folder.rename(studied.folder / "map")
    all_cases = "results/studies/map/cases.parquet"
    chunks = [f"results/studies/map/chunks/{i:05d}.parquet" for i in (2, 1)]
    studied.made(*chunks, cores=1)
    assert studied.jobs(all_cases) == {"study_chunk": 2, "study_cases": 1, "total": 3}
    studied.made(all_cases, cores=1)
    again = studied.files("studies/map")
    assert again == {name: finished[name] for name in ("cases.parquet", "manifest.json")}
    shutil.rmtree(folder)
    aside.rename(folder)


def test_a_dry_run_tells_cases_and_bytes(studied):
    said = studied.made("--dry-run", target("map"))
    assert "Study map: 3,500 cases × 3 levels = 10,500 responses, 4 chunks, up to" in said


GOOD = {"title": "Wrong", "axes": [{"zeta": {"values": [0.1, 0.2]}}]}


def test_a_wrong_study_is_refused_and_nothing_is_lost(studied):
    """The messages of one refusal by the schema and one by the size arrive; tests/studies has all of them."""
    drawn = {"method": "random", "count": 10**13, "seed": 1}
    drawn["over"] = {"zeta": {"from": 0.1, "to": 0.2}}
    large = {"axes": [{"sample": drawn}], "chunk_cases": 10**10}
    unknown = "line 2: axes[1].zetta: unknown key (did you mean zeta?)"
    before = studied.files("studies")
    with restored(studied.folder / "config/studies/wrong.yaml"):
        for change, expected in (
            ({"axes": [{"zetta": {"values": [0.1]}}]}, unknown),
            (large, "axes: 10,000,000,000,000 cases would take"),
        ):
            write(studied, "wrong", GOOD | change)
            assert f"wrong.yaml: {expected}" in studied.refused(target("wrong"))
        studied.made("--dry-run", target("map"))  # it stops nothing but itself
    assert studied.files("studies") == before


def test_a_study_whose_name_snakemake_cannot_take_is_told(studied):
    path = studied.folder / f"config/studies/{'a' * 60}.yaml"
    with restored(path):
        write(studied, path.stem, GOOD)
        said = studied.refused("--dry-run", "studies")
    assert "with nothing 20 times in a row at its end; rename the file" in said
    assert "PeriodicWildcardError" not in said


def test_the_site_waits_for_article_page_and_notebook(studied):
    assert {"site", "article", "page", "notebook"} <= studied.jobs("results/site").keys()
