"""Folders and files with blanks and other marks in their paths, and a home folder that cannot be written."""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import sys
import tarfile

import pytest

from dampbalance import __version__
from folders import ROOT, contents
from processes import git, output_of, run
from workflow.copies import copied

LOCKS = sorted(path.name for path in ROOT.glob("requirements*.lock"))
ODD = "ä b'c & (e) [f] #h %i"
STUB = """#!/bin/sh
printf '%s\\n' "HOME=$HOME" "$@" end >>"$HERE/calls"
"""


@pytest.fixture
def odd(tmp_path):
    """A folder with an odd path, and an environment whose Python only writes down how `make` calls it."""
    folder = tmp_path / ODD
    python = folder / ".venv/bin/python"
    python.parent.mkdir(parents=True)
    for name in ("pyproject.toml", "Makefile", *LOCKS):
        shutil.copy(ROOT / name, folder)
    python.write_text(STUB, encoding="utf-8")
    python.chmod(0o755)
    (folder / ".venv/locked").write_text(str(folder), encoding="utf-8")
    (folder / ".venv/ready").touch()
    (folder / ".venv/tools").touch()
    return folder


def make(folder, *arguments, **environment):
    """What `make` does in a folder: (the run, the arguments of each call of its Python)."""
    given = (
        "PYTEST_ARGS",
        "CONFIG",
        "WITH",
        "ARCHIVE",
    )  # to the run of make that these tests may be part of
    handed_down = dict.fromkeys(n for n in os.environ if n.startswith("MAKE") or n in given)
    command = ("make", "--no-print-directory", *arguments)
    done = run(*command, folder=folder, timeout=60, **handed_down | environment)
    calls = folder / "calls"
    text = calls.read_text(encoding="utf-8") if calls.exists() else ""
    return done, [call.split("\n") for call in text.split("\nend\n")[:-1]]


PARALLEL = [
    "--numprocesses",
    "auto",
    "--dist",
    "loadscope",
    "--no-loadscope-reorder",
    "-m",
    "not nightly",
]
READ = ["-m", "dampbalance.project.documents", "config/config.yaml"]
PROFILE = ["--workflow-profile", "workflow/profiles/default"]
RUN = ["-m", "snakemake", *PROFILE, "--cores", "all"]


@pytest.mark.parametrize(
    ("arguments", "called"),
    [
        (["check"], [READ, [*RUN, "check"]]),
        *(
            (["check", f"CONFIG={case}"], [[*READ, case], [*RUN, f"--configfile={case}", "check"]])
            for case in ("a b.yaml", "it's $x $(y).yaml")
        ),
        (["unit"], [["-m", "pytest", *PARALLEL]]),
        (["compare", "WITH=../o'th er/$re"], [["-m", "same_results", "results", "../o'th er/$re"]]),
    ],
)  # fmt: skip
def test_make_tells_python_every_path_as_it_is(odd, arguments, called):
    done, calls = make(odd, *arguments)
    assert done.returncode == 0, done.stderr
    assert [call[1:] for call in calls] == called


@pytest.fixture
def committed(odd):
    """The same under version control, with a result that is not."""
    (odd / ".gitignore").write_text("/.venv\n/results\n/calls\n", encoding="utf-8")
    (odd / "results/paper").mkdir(parents=True)
    (odd / "results/paper/a.csv").write_text("1\n", encoding="utf-8")
    git(odd, "init", "--quiet")
    git(odd, "add", "--all")
    git(odd, "commit", "--quiet", "--message=all")
    return odd


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
@pytest.mark.parametrize("name", ["an $archive.tar.gz", None])
def test_an_archive_holds_sources_and_results_with_digests_in_the_same_bytes(committed, name):
    arguments = [f"ARCHIVE={name}"] if name else []
    file = committed / (name or f"results/archive/dampbalance-{__version__}.tar.gz")
    packed = []
    for _ in range(2):
        done, calls = make(committed, "archive", *arguments)
        assert done.returncode == 0, done.stderr
        assert calls[-1][1:] == RUN
        packed.append(file.read_bytes())
        file.unlink()
    assert packed[0] == packed[1]
    with tarfile.open(fileobj=io.BytesIO(packed[0])) as tar:
        tar.extractall(committed / "results/unpacked", filter="data")
    (top,) = (committed / "results/unpacked").iterdir()
    lines = (top / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    listed = {path: digest for digest, path in (line.split("  ", 1) for line in lines)}
    assert listed == {
        path: hashlib.sha256(data).hexdigest()
        for path, data in contents(top).items()
        if path != "SHA256SUMS"
    }
    assert {"results/paper/a.csv", "Makefile", "pyproject.toml"} <= set(listed)


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
@pytest.mark.parametrize("name", ["Makefile", "new.yaml"])
def test_results_of_sources_that_are_not_committed_are_not_archived(committed, name):
    with (committed / name).open("a", encoding="utf-8") as file:
        file.write("\n")
    done, calls = make(committed, "archive")
    assert done.returncode != 0
    assert "error: results belong to committed sources" in done.stderr
    assert calls == []


def test_the_python_that_is_named_is_told_as_it_is(odd):
    (odd / ".venv/locked").write_text("/elsewhere", encoding="utf-8")
    done, _ = make(odd, "setup", "PYTHON=no such/$python")
    assert done.returncode != 0
    assert done.stderr.startswith("error: Python 3.11 or newer is needed, and no such/$python is ")


@pytest.mark.parametrize("name", ["a:b", "a$b", "a\\b", 'a"b', "a`b"])
def test_a_folder_in_which_no_environment_works_is_refused_before_anything(odd, name):
    folder = odd.rename(odd.with_name(name))
    before = sorted(folder.rglob("*"))
    done, calls = make(folder, "check")
    assert done.returncode != 0
    (line,) = done.stderr.splitlines()
    assert f"{folder}: in a folder with one of" in line
    assert "move the project to another one" in line
    assert calls == []
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    ("environment", "own"),
    [
        ({"HOME": "/dev/null/x"}, True),
        ({"HOME": ""}, True),
        ({"HOME": "there", "XDG_CACHE_HOME": "/dev/null/y"}, True),
        ({"HOME": "there", "XDG_CACHE_HOME": ""}, False),
    ],
)
def test_where_home_cannot_be_written_a_folder_of_the_project_serves(odd, environment, own):
    there = odd / "there"
    there.mkdir()
    given = {name: str(there) if value == "there" else value for name, value in environment.items()}
    done, calls = make(odd, "check", **given)
    assert done.returncode == 0, done.stderr
    assert calls[0][0] == f"HOME={odd / '.snakemake/home' if own else there}"
    assert (odd / ".snakemake/home").is_dir() == own


@pytest.mark.slow
def test_jobs_run_by_a_python_with_an_odd_path(tmp_path):
    """The environment is a link, whose path Snakemake writes into the command lines of its jobs."""
    folder = tmp_path / ODD
    folder.mkdir()
    copied(ROOT, folder)
    (folder / ".venv").symlink_to(sys.prefix)
    case = folder / "s m.yaml"
    shutil.copy(ROOT / "tests/workflow/small.yaml", case)
    target = "results/small/orbits/above.json"
    command = ("-m", "snakemake", "--cores=1", f"--configfile={case.name}", target)
    python = folder / ".venv/bin/python"
    output_of(python, *command, folder=folder, PYTHONPATH=str(folder / "src"))
    assert (folder / target).is_file()
