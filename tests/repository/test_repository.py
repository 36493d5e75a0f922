"""The files of the project agree with each other and hold nothing that belongs to one machine."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import jsonschema
import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import dampbalance
from folders import ROOT
from processes import git, run

LOCKS = sorted(path.name for path in ROOT.glob("requirements*.lock"))
MODULES = sorted((ROOT / "src").rglob("*.py"))
LONGEST_MODULE = 600  # lines; a file is a concept that an expert names


def pyproject() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def pins(lock: str) -> dict[str, set[str]]:
    """Each locked package → its versions (several where they depend on the Python version)."""
    found: dict[str, set[str]] = {}
    text = (ROOT / lock).read_text()
    for name, version in re.findall(r"^([A-Za-z0-9._-]+)==([^\s;]+)", text, re.MULTILINE):
        found.setdefault(canonicalize_name(name), set()).add(version)
    return found


# --- locks ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_names_packages_with_hashes_and_no_place_to_fetch_them_from(lock):
    text = (ROOT / lock).read_text(encoding="utf-8").replace("\\\n", " ")
    entries = [line for line in text.splitlines() if line.strip() and line.strip()[0] != "#"]
    assert entries
    assert "://" not in text
    assert [of for of in entries if not re.match(r"\S+==\S+ .*--hash=sha256:", of)] == []


def test_locks_hold_what_pyproject_asks_for_and_agree():
    settings = pyproject()
    extras, groups = settings["project"]["optional-dependencies"], settings["dependency-groups"]
    rebuild = pins("requirements.lock")
    for name, wanted in {
        "": [*settings["project"]["dependencies"], *extras["workflow"], *extras["article"]],
        "-dev": [*extras["records"], *extras["slurm"], *groups["dev"], *groups["docs"]],
        "-build": [*groups["build"], *settings["build-system"]["requires"]],
        "-engine": groups["engine"],
    }.items():
        locked = pins(f"requirements{name}.lock")
        for requirement in map(Requirement, wanted):
            of = canonicalize_name(requirement.name)
            versions = locked.get(of) or rebuild[of]  # which the tools come in addition to
            assert all(map(requirement.specifier.contains, versions)), f"{requirement}: make lock"
        shared = locked.keys() & rebuild.keys()
        assert [of for of in shared if locked[of] != rebuild[of]] == []
        assert name in ("", "-build") or not shared


# --- nothing of one machine ----------------------------------------------------------------------


# Put together here, so that this file does not hold what it looks for.
MACHINE_PATH = re.compile(
    rb"(?<![\w.~}])/(?:" + b"|".join((b"work", b"root", b"home", b"Users")) + rb")/\w"
)


@pytest.mark.skipif(
    shutil.which("git") is None or not (ROOT / ".git").exists(),
    reason="not a git checkout: which files belong to the project is unknown",
)
def test_no_file_holds_a_path_of_one_machine():
    assert MACHINE_PATH.search(b"open('/" + b"home/someone/data.csv')")
    listed = git(ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard")
    texts = {name: ROOT / name for name in listed.split("\0") if (ROOT / name).is_file()}
    texts = {name: text for name, path in texts.items() if b"\0" not in (text := path.read_bytes())}
    assert [name for name, text in texts.items() if MACHINE_PATH.search(text)] == []


# --- the citation and its licence ----------------------------------------------------------------


def test_the_citation_follows_its_schema_and_has_the_version_and_the_licence_of_the_project():
    # dates stay text, as the schema wants them
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    citation = yaml.load(text, yaml.BaseLoader)
    for reference in citation["references"]:
        reference["year"] = int(reference["year"])
    schema = json.loads((ROOT / "tests/repository/cff-1.2.0.schema.json").read_text("utf-8"))
    dates = jsonschema.Draft7Validator.FORMAT_CHECKER
    validator = jsonschema.Draft7Validator(schema, format_checker=dates)
    assert [error.json_path for error in validator.iter_errors(citation)] == []
    project = pyproject()["project"]
    assert project["version"] == citation["version"] == dampbalance.__version__
    assert project["license"] == citation["license"] == "BSD-3-Clause"
    licence = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert licence == (ROOT / "LICENSES/BSD-3-Clause.txt").read_text(encoding="utf-8")


# --- make ----------------------------------------------------------------------------------------


def make(*arguments: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    handed_down = dict.fromkeys(name for name in os.environ if "MAKE" in name)  # by an outer make
    return run("make", "--no-print-directory", *arguments, folder=folder, **handed_down)


def test_every_target_is_documented_and_can_be_made():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    # GNU make runs a line that refers to this variable in a dry run, too
    assert "$(MAKE)" not in makefile
    targets = re.findall(r"^  make (\S+) ", make("help").stdout, re.MULTILINE)
    phony = re.search(r"^\.PHONY: (.*)$", makefile, re.MULTILINE)
    assert {*phony[1].split()} - {"stale"} == {*targets}
    plan = make("--dry-run", *targets)
    assert plan.returncode == 0, plan.stderr


def test_a_set_up_that_fails_says_why_and_is_not_taken_for_a_finished_one(tmp_path):
    for name in ("Makefile", "pyproject.toml", *LOCKS):
        shutil.copy(ROOT / name, tmp_path)
    for python, words in (
        ("false", "Python 3.11 or newer is needed"),
        ("true", "Setting up .venv"),
    ):
        done = make("setup", f"PYTHON={python}", folder=tmp_path)  # "true" makes no environment
        assert done.returncode != 0
        assert words in done.stdout + done.stderr
        assert not (tmp_path / ".venv/locked").exists()


# --- the sources ---------------------------------------------------------------------------------


def test_modules_are_short_and_know_nothing_of_snakemake():
    for module in MODULES:
        text = module.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= LONGEST_MODULE, f"divide {module}"
        assert not re.search(r"^ *(?:import|from) .*\bsnakemake\b", text, re.MULTILINE), module
