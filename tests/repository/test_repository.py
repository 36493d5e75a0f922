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
from processes import run

LOCKS = (
    "requirements.lock",
    "requirements-dev.lock",
    "requirements-build.lock",
    "requirements-engine.lock",
)
MODULES = sorted((ROOT / "src").rglob("*.py"))
LONGEST_MODULE = 600  # lines; a file is a concept that an expert names


def project_files() -> list[Path]:
    """Every text file of the project: what is or would be under version control."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
    names = {name for name in listing.stdout.decode().split("\0") if name}
    paths = (ROOT / name for name in sorted(names))
    return [path for path in paths if path.is_file() and b"\0" not in path.read_bytes()]


needs_git = pytest.mark.skipif(
    shutil.which("git") is None or not (ROOT / ".git").exists(),
    reason="not a git checkout: which files belong to the project is unknown",
)


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
    text = (ROOT / lock).read_text(encoding="utf-8")
    assert not re.findall(r".*(?:://|--(?:extra-)?index-url|--find-links|--trusted-host).*", text)
    lines = text.replace("\\\n", " ").splitlines()
    entries = [line for line in lines if line.strip() and not line.strip().startswith("#")]
    assert entries
    without = [entry[:60] for entry in entries if not re.match(r"\S+==\S+ .*--hash=sha256:", entry)]
    assert without == []


def locked_requirements() -> list[tuple[str, str]]:
    """(lock, requirement) for all that pyproject.toml asks for and a lock has to hold."""
    settings = pyproject()
    project = settings["project"]
    extras = project["optional-dependencies"]
    wanted = [("requirements.lock", text) for text in project["dependencies"]]
    rebuild = {*extras["workflow"], *extras["article"]}
    wanted += [("requirements.lock", text) for text in rebuild]
    tested = {*extras["records"], *extras["slurm"]} - rebuild
    wanted += [("requirements-dev.lock", text) for text in tested]
    of_group = {
        "dev": "requirements-dev.lock",
        "docs": "requirements-dev.lock",
        "build": "requirements-build.lock",
        "engine": "requirements-engine.lock",
    }
    for group, lock in of_group.items():
        wanted += [(lock, text) for text in settings["dependency-groups"][group]]
    wanted += [("requirements-build.lock", text) for text in settings["build-system"]["requires"]]
    return wanted


def test_locks_hold_what_pyproject_asks_for():
    locked = {lock: pins(lock) for lock in LOCKS}
    for lock, text in locked_requirements():
        requirement = Requirement(text)
        versions = locked[lock].get(canonicalize_name(requirement.name), set())
        assert versions, f"{requirement.name} is missing from {lock}: run `make lock`"
        assert all(requirement.specifier.contains(version) for version in versions), text


def test_the_locks_agree():
    rebuild, tools, build, engine = (pins(lock) for lock in LOCKS)
    assert [name for name in build.keys() & rebuild.keys() if build[name] != rebuild[name]] == []
    assert [name for name in build.keys() & tools.keys() if build[name] != tools[name]] == []
    assert rebuild.keys() & tools.keys() == set()  # the tools come in addition
    assert (rebuild.keys() | tools.keys()) & engine.keys() == set()


# --- nothing of one machine ----------------------------------------------------------------------


# Put together here, so that this file does not hold what it looks for.
MACHINE_PATH = re.compile(
    r"(?<![\w.~}])/(?:" + "|".join(("work", "root", "home", "Users")) + r")/\w"
)


@needs_git
def test_no_file_holds_a_path_of_one_machine():
    assert MACHINE_PATH.search("open('/" + "home/someone/data.csv')")
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in project_files()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if MACHINE_PATH.search(line)
    ]
    assert found == []


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


@pytest.fixture
def bare_copy(tmp_path):
    """What a set-up needs, in a folder of its own that has no environment yet."""
    for name in ("Makefile", "pyproject.toml", *LOCKS):
        shutil.copy(ROOT / name, tmp_path)
    return tmp_path


def fake_python(folder: Path, accepts: str) -> Path:
    """An interpreter that says it is 3.8.0 and succeeds only at code that contains `accepts`."""
    script = folder / "fake-python"
    script.write_text(
        "#!/bin/sh\n"
        'case "$*" in\n'
        "    --version) echo Python 3.8.0 ;;\n"
        f"    *{accepts}*) ;;\n"
        "    *) exit 1 ;;\n"
        "esac\n"
    )
    script.chmod(0o755)
    return script


@pytest.mark.parametrize(
    ("accepts", "words"),
    [
        ("nothing", ["Python 3.11 or newer is needed", "Python 3.8.0", "make PYTHON="]),
        ("version_info", ["lacks the venv module", "python3-venv"]),
    ],
)
def test_set_up_with_an_unfit_python_says_what_to_do(bare_copy, accepts, words):
    outcome = make("setup", f"PYTHON={fake_python(bare_copy, accepts)}", folder=bare_copy)
    assert outcome.returncode != 0
    assert [word for word in words if word not in outcome.stderr] == []
    assert not (bare_copy / ".venv").exists()


@pytest.mark.slow
def test_interrupted_set_up_is_not_taken_for_a_finished_one(bare_copy):
    python = fake_python(bare_copy, accepts="-")  # accepts everything, and makes no environment
    for _ in range(2):
        outcome = make("setup", f"PYTHON={python}", folder=bare_copy)
        assert outcome.returncode != 0
        assert "Setting up .venv" in outcome.stdout
    assert not (bare_copy / ".venv" / "locked").exists()


# --- the sources ---------------------------------------------------------------------------------


def test_modules_are_short_and_know_nothing_of_snakemake():
    for module in MODULES:
        text = module.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= LONGEST_MODULE, f"divide {module}"
        assert not re.search(r"^ *(?:import|from) .*\bsnakemake\b", text, re.MULTILINE), module
