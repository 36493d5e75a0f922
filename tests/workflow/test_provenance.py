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
from dampbalance.publishing.provenance import archive
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


def test_every_result_is_in_the_manifest_with_its_digest(built, stated):
    listed = {result["path"]: result for result in stated["reproducible"]["results"]}
    there = {f"{RESULTS}/{name}": data for name, data in built.files("small").items()}
    assert set(listed) == set(there) - {MANIFEST}
    for path, result in listed.items():
        assert result["sha256"] == hashlib.sha256(there[path]).hexdigest()
        assert result["bytes"] == len(there[path])


@pytest.mark.parametrize(
    ("file", "rule", "script"),
    [
        ("orbits/resonance.json", "simulate_exact", "simulate/simulate_exact.py"),
        (
            "features/as_published/resonance.csv",
            "features_as_published",
            "features/features_as_published.py",
        ),
        ("tables/table3.md", "tables", "tables/tables.py"),
        ("figures/figure2.png", "figures", "figures/figures.py"),
    ],
)
def test_the_rule_and_the_job_of_a_result_are_named(stated, file, rule, script):
    path = f"{RESULTS}/{file}"
    results = {result["path"]: result["rule"] for result in stated["reproducible"]["results"]}
    assert results[path] == rule
    (job,) = [job for job in stated["reproducible"]["jobs"] if path in job["outputs"]]
    assert job["rule"] == rule
    assert job["script"] == f"workflow/scripts/{script}"
    assert (ROOT / job["script"]).is_file()


def test_inputs_of_jobs_are_results_or_sources(stated):
    made = stated["reproducible"]
    results = {result["path"] for result in made["results"]}
    (job,) = [job for job in made["jobs"] if job["rule"] == "estimate_exact"]
    names = ("above", "resonance")
    assert job["inputs"] == [f"{RESULTS}/features/exact/{name}.csv" for name in names]
    assert {file for job in made["jobs"] for file in job["inputs"]} <= results | set(
        made["sources"]
    )


def test_the_configuration_is_the_merged_one(stated):
    made = stated["reproducible"]
    assert made["configuration"]["case"] == "small"
    assert made["configuration"]["as_published"]["cycles"] == 6  # from small.yaml
    assert made["configuration"]["oscillator"]["m_kg"] == 2.42  # from config.yaml
    assert made["configuration_files"] == ["config/config.yaml", "small.yaml"]
    assert made["configuration_sha256"] == digest_of(made["configuration"])


def test_sources_are_listed_with_their_digests(built, stated):
    sources = stated["reproducible"]["sources"]
    wanted = {"Snakefile", "config/config.yaml", "small.yaml", "src/dampbalance/motion/flow.py"}
    assert wanted | {"paper/published/printed.csv", "requirements.lock"} <= set(sources)
    for file in wanted:
        assert sources[file] == sha256(built.folder / file)


def test_packages_and_python_are_those_that_run(stated):
    run = stated["run"]
    assert run["python"] == ".".join(map(str, sys.version_info[:3]))
    assert run["packages"]["numpy"] == metadata.version("numpy")
    assert run["code"] == {
        "version": metadata.version("dampbalance"),
        "commit": None,
        "committed": None,
        "modified": None,
        "known_from": "nothing",
    }


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
def test_every_caption_is_there(rules):
    for name in re.findall(r'caption=f?"([^"]+)"', rules.read_text(encoding="utf-8")):
        assert list(rules.parent.glob(re.sub(r"{.*?}", "*", name))), name


@pytest.mark.parametrize(
    "rules", sorted((ROOT / "workflow/rules").glob("*.smk")), ids=lambda p: p.stem
)
def test_every_entry_of_the_report_has_a_title_in_words(rules):
    text = rules.read_text(encoding="utf-8")
    assert len(re.findall(r"\breport\(", text)) == len(re.findall(r"\blabels=", text))
    for title in re.findall(r'labels={"result": "([^"]*)"}', text):
        assert " " in title, title
    for title in re.findall(r'figure_files\("\w+"(?:, "([^"]*)")?\)', text):
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


def test_the_digests_are_those_of_the_files(unpacked):
    lines = (unpacked.folder / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    listed = {path: digest for digest, path in (line.split("  ", 1) for line in lines)}
    assert set(contents(unpacked.folder)) == {*listed, "SHA256SUMS"}
    for path, digest in listed.items():
        assert sha256(unpacked.folder / path) == digest, path


def test_the_whole_project_and_all_results_are_in_it(built, unpacked):
    inside = set(files_of(unpacked.folder))
    assert inside == set(files_of(built.folder))
    assert {
        "tests/workflow/test_provenance.py",
        "LICENSE",
        "requirements.lock",
        "paper/published/printed.csv",
        "Makefile",
    } <= inside
    assert unpacked.files("small") == built.files("small")


def test_executable_files_stay_executable(unpacked):
    assert os.access(unpacked.folder / ".ci/run", os.X_OK)
    assert not os.access(unpacked.folder / "README.md", os.X_OK)


def test_its_readme_tells_how_to_verify_and_rebuild(unpacked):
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


def test_packing_again_gives_the_same_bytes_and_makes_nothing_else(built):
    first = sha256(built.folder / ARCHIVE)
    (built.folder / ARCHIVE).unlink()
    readme = built.folder / "README.md"  # a later time, the same contents
    os.utime(readme, (readme.stat().st_atime, readme.stat().st_mtime + 10))
    assert built.jobs("archive", *SMALL) == {"archive": 1, "total": 1}
    built.made("archive", *SMALL, cores=1)
    assert sha256(built.folder / ARCHIVE) == first


def test_its_entries_tell_no_time_and_no_person(built):
    with gzip.open(built.folder / ARCHIVE) as stream:
        stream.read(1)
        assert stream.mtime == 0
    with tarfile.open(built.folder / ARCHIVE) as tar:
        entries = tar.getmembers()
    # level by level
    assert entries == sorted(entries, key=lambda entry: entry.name.split("/"))
    assert {(e.uid, e.gid, e.uname, e.gname, e.mtime) for e in entries} == {
        (0, 0, "", "", archive.TIME)
    }
