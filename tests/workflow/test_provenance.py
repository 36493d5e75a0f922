"""The manifest says what is so, a commit alone rebuilds nothing but it, and the archive rebuilds itself.

The build of the small case, and a second one on one core, from what the archive holds alone, serve all tests here.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import os
import re
import shutil
import sys
import tarfile
from importlib import metadata

import pytest

from dampbalance.project.files import sha256
from dampbalance.publishing.provenance.archive import TIME
from dampbalance.publishing.provenance.manifest import digest_of, files_of
from folders import ROOT, contents
from processes import git
from workflow.copies import ARCHIVE, SMALL, Checkout, keep_kernels, unpacked_archive

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
        ("orbits/resonance.json", "simulate_exact", "simulate/simulate_exact"),
        (
            "features/as_published/resonance.csv",
            "features_as_published",
            "features/features_as_published",
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


def test_the_report_of_snakemake_has_captions_and_needs_no_network(built):
    built.made("--report", "report.html", *SMALL)
    html = (built.folder / "report.html").read_text(encoding="utf-8")
    (built.folder / "report.html").unlink()
    for name in ("page", "manifest"):
        caption = (ROOT / f"workflow/report/{name}.rst").read_text(encoding="utf-8")
        assert " ".join(caption.split()[:4]) in html, name
    for title in ("The page of the case", "Table 1: amplitudes, slip onset and phase, at 9 Hz"):
        assert title in html
    assert re.findall(r"<(?:script|link|img)[^>]* (?:src|href)=[\"']https?:", html) == []


@pytest.mark.parametrize(
    "rules", sorted((ROOT / "workflow/rules").glob("*.smk")), ids=lambda p: p.stem
)
def test_every_entry_of_the_report_has_a_caption_and_a_title_in_words(rules):
    text = rules.read_text(encoding="utf-8")
    for name in re.findall(r'caption=f?"([^"]+)"', text):
        assert list(rules.parent.glob(re.sub(r"{.*?}", "*", name))), name
    assert len(re.findall(r"\breport\(", text)) == len(re.findall(r"\blabels=", text))
    for title in re.findall(r'(?:labels={"result": |figure_files\("\w+", )"([^"]*)"', text):
        assert " " in title, title


# --- the archive ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def unpacked(built, tmp_path_factory):
    folder = tmp_path_factory.mktemp("elsewhere")
    return Checkout(unpacked_archive(built.folder / ARCHIVE, folder))


@pytest.fixture(scope="module")
def rebuilt(built, unpacked):
    """The results that the archive had, by path; they are deleted, and built again by its own sources, on one core.

    With kernels that are compiled already, which a digest of the sources admits."""
    packed = unpacked.files("small")
    keep_kernels(built.folder, unpacked.folder)
    shutil.rmtree(unpacked.folder / "results/small")
    unpacked.made("all", *(f"results/small/{name}" for name in packed), *SMALL, cores=1)
    return packed


def test_the_whole_project_and_all_results_are_in_it_with_digests_and_a_guide(built, unpacked):
    lines = (unpacked.folder / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    listed = {path: digest for digest, path in (line.split("  ", 1) for line in lines)}
    assert set(contents(unpacked.folder)) == {*listed, "SHA256SUMS"}
    for path, digest in listed.items():
        assert sha256(unpacked.folder / path) == digest, path
    inside = set(files_of(unpacked.folder))
    assert inside == set(files_of(built.folder))
    assert {
        "tests/workflow/test_provenance.py",
        "LICENSE",
        "requirements.lock",
        "Makefile",
    } <= inside
    assert unpacked.files("small") == built.files("small")
    assert os.access(unpacked.folder / ".ci/run", os.X_OK)
    assert not os.access(unpacked.folder / "README.md", os.X_OK)
    text = (unpacked.folder / "ARCHIVE.md").read_text(encoding="utf-8")
    assert "sha256sum --check --quiet SHA256SUMS" in text
    assert "snakemake --cores all --configfile small.yaml" in text
    assert "requirements.lock" in text
    assert "{" not in text.replace("```", "")  # nothing left to fill in


def test_it_rebuilds_its_results_from_itself_alone_and_on_one_core_the_same(unpacked, rebuilt):
    again = unpacked.files("small")
    assert again.keys() == rebuilt.keys()
    different = [name for name in again if again[name] != rebuilt[name]]
    assert set(different) <= {"manifest.json"}
    before, after = (json.loads(files["manifest.json"]) for files in (rebuilt, again))
    assert after["reproducible"] == before["reproducible"]
    assert after["run"]["code"]["known_from"] == "archive"


def test_packing_again_gives_the_same_bytes_without_a_time_or_a_person(built):
    archive = built.folder / ARCHIVE
    with gzip.open(archive) as stream:
        stream.read(1)
        assert stream.mtime == 0
    with tarfile.open(archive) as tar:
        entries = tar.getmembers()
    assert {(e.uid, e.gid, e.uname, e.gname, e.mtime) for e in entries} == {(0, 0, "", "", TIME)}
    first = sha256(archive)
    archive.unlink()
    readme = built.folder / "README.md"  # a later time, the same contents
    os.utime(readme, (readme.stat().st_atime, readme.stat().st_mtime + 10))
    assert built.jobs("archive", *SMALL) == {"archive": 1, "total": 1}
    built.made("archive", *SMALL, cores=1)
    assert sha256(archive) == first
