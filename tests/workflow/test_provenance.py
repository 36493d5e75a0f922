"""The manifest says what is so, a commit alone rebuilds nothing but it, and another folder gives the same bytes."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import sys
from importlib import metadata

import pytest

from dampbalance.project.files import sha256
from dampbalance.publishing.provenance.manifest import digest_of
from folders import ROOT
from processes import git
from workflow.copies import SMALL, copied

pytestmark = pytest.mark.slow

RESULTS = "results/small"
MANIFEST = f"{RESULTS}/manifest.json"
needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


@pytest.fixture(scope="module")
def stated(built):
    return json.loads((built.folder / MANIFEST).read_text(encoding="utf-8"))


# --- the manifest of a run -----------------------------------------------------------------------


def test_the_manifest_states_results_jobs_configuration_sources_and_packages(built, stated):
    made, run = stated["reproducible"], stated["run"]
    listed = {result["path"]: result for result in made["results"]}
    there = {f"{RESULTS}/{name}": data for name, data in built.files("small").items()}
    assert set(listed) == set(there) - {MANIFEST}
    for path, result in listed.items():
        assert result["sha256"] == hashlib.sha256(there[path]).hexdigest()
        assert result["bytes"] == len(there[path])

    jobs = {file: job for job in made["jobs"] for file in job["outputs"]}
    for file, rule, script in (
        ("orbits/resonance.json", "response_exact", "response/response_exact"),
        (
            "features/as_published/resonance.csv",
            "response_as_published",
            "response/response_as_published",
        ),
        ("tables/table3.md", "tables", "tables/tables"),
        ("figures/figure2.png", "figures", "figures/figures"),
    ):
        job = jobs[f"{RESULTS}/{file}"]
        assert listed[f"{RESULTS}/{file}"]["rule"] == job["rule"] == rule
        assert job["script"] == f"workflow/scripts/{script}.py"
        assert (ROOT / job["script"]).is_file()
    names = [f"{RESULTS}/features/exact/{name}.csv" for name in ("above", "resonance")]
    assert jobs[f"{RESULTS}/estimates/exact/above.csv"]["inputs"] == names
    assert {file for job in made["jobs"] for file in job["inputs"]} <= {*listed, *made["sources"]}

    assert made["configuration"]["case"] == "small"
    assert made["configuration"]["as_published"]["cycles"] == 6  # from small.yaml
    assert made["configuration"]["oscillator"]["m_kg"] == 2.42  # from config.yaml
    assert made["configuration_files"] == ["config/config.yaml", "small.yaml"]
    assert made["configuration_sha256"] == digest_of(made["configuration"])
    sources = {"Snakefile", "config/config.yaml", "small.yaml", "src/dampbalance/motion/flow.py"}
    assert {"paper/published/printed.csv", "requirements.lock"} <= set(made["sources"])
    for file in sources:
        assert made["sources"][file] == sha256(built.folder / file)

    assert run["python"] == ".".join(map(str, sys.version_info[:3]))
    assert run["packages"]["numpy"] == metadata.version("numpy")
    assert run["licences"]["numpy"] == metadata.metadata("numpy")["License-Expression"]
    assert run["packages"].keys() == run["licences"].keys()
    nothing = dict.fromkeys(("commit", "committed", "modified"))
    version = metadata.version("dampbalance")
    assert run["code"] == {"version": version, **nothing, "known_from": "nothing"}


@needs_git
def test_a_commit_renews_the_manifest_and_no_result(built):
    git(built.folder, "init", "--quiet")
    try:
        git(built.folder, "add", "--all")
        git(built.folder, "commit", "--quiet", "--message=all")
        jobs = built.jobs(MANIFEST, *SMALL)  # the manifest depends on every result
    finally:
        shutil.rmtree(built.folder / ".git")
    assert jobs == {"manifest": 1, "total": 1}


# --- Snakemake's own report ----------------------------------------------------------------------


def test_the_report_of_snakemake_needs_no_network(built):
    built.made("--report", "report.html", *SMALL)
    html = (built.folder / "report.html").read_text(encoding="utf-8")
    (built.folder / "report.html").unlink()
    for title in ("The page of the case", "Table 1: amplitudes, slip onset and phase, at 9 Hz"):
        assert title in html
    assert re.findall(r"<(?:script|link|img)[^>]* (?:src|href)=[\"']https?:", html) == []


# --- another folder ------------------------------------------------------------------------------


def test_another_copy_gives_the_same_bytes_on_one_core(built, tmp_path):
    """With kernels that are compiled already, which a digest of the sources admits."""
    other = copied(built.folder, tmp_path / "elsewhere", "small.yaml")
    other.made("all", *SMALL, cores=1)
    again, before = other.files("small"), built.files("small")
    assert again.keys() == before.keys()
    assert [name for name in again if again[name] != before[name]] in ([], ["manifest.json"])
    assert (
        json.loads(again["manifest.json"])["reproducible"]
        == json.loads(before["manifest.json"])["reproducible"]
    )
