"""The files of the project agree with each other and hold nothing that belongs to one machine."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

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
def test_lock_names_packages_and_no_place_to_fetch_them_from(lock):
    text = (ROOT / lock).read_text(encoding="utf-8")
    assert not re.findall(r".*(?:://|--(?:extra-)?index-url|--find-links|--trusted-host).*", text)


@pytest.mark.parametrize("lock", LOCKS)
def test_every_locked_package_has_one_version_and_a_hash(lock):
    lines = (ROOT / lock).read_text(encoding="utf-8").replace("\\\n", " ").splitlines()
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


@pytest.mark.parametrize("prefix", ["work", "root", "home", "Users"])
def test_machine_paths_are_recognised(prefix):
    assert MACHINE_PATH.search(f"open('/{prefix}/someone/data.csv')")
    assert not MACHINE_PATH.search(f"see docs/{prefix}/someone and ./{prefix}/x")


@needs_git
def test_no_file_holds_a_path_of_one_machine():
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in project_files()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if MACHINE_PATH.search(line)
    ]
    assert found == []


@needs_git
def test_results_are_ignored_but_for_their_readme():
    def ignored(path: str) -> bool:
        command = ["git", "check-ignore", "--quiet", "--no-index", path]
        return subprocess.run(command, cwd=ROOT, check=False).returncode == 0

    assert ignored("results/paper/claims.csv")
    assert ignored(".venv/pyvenv.cfg")
    assert not ignored("results/README.md")
    assert not ignored("src/dampbalance/__init__.py")


# --- one version, one licence --------------------------------------------------------------------


def test_version_is_the_same_everywhere():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert pyproject()["project"]["version"] == citation["version"] == dampbalance.__version__


def test_licence_is_the_same_everywhere():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert pyproject()["project"]["license"] == citation["license"] == "BSD-3-Clause"
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("BSD 3-Clause License")


# --- make ----------------------------------------------------------------------------------------


def make(*arguments: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    handed_down = dict.fromkeys(name for name in os.environ if "MAKE" in name)  # by an outer make
    return run("make", "--no-print-directory", *arguments, folder=folder, **handed_down)


def documented_targets() -> list[str]:
    return re.findall(r"^  make (\S+) ", make("help").stdout, re.MULTILINE)


def test_make_help_shows_the_targets_people_are_told_about():
    assert {"all", "test", "check", "clean", "lock", "help"} <= set(documented_targets())


def test_every_documented_target_can_be_made():
    # GNU make runs a line that refers to this variable in a dry run, too
    assert "$(MAKE)" not in (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in documented_targets():
        plan = make("--dry-run", target)
        assert plan.returncode == 0, f"make {target}: {plan.stderr}"


def test_every_phony_target_is_documented():
    phony = re.search(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert phony
    assert set(phony[1].split()) - {"stale"} == set(documented_targets())


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
