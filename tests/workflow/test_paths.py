"""Folders and files with blanks and other marks in their paths, and a home folder that cannot be written."""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import sys
import tarfile

import pytest

from folders import ROOT, contents
from processes import git, output_of, run
from workflow.copies import copied

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
    for file in (ROOT / "pyproject.toml", ROOT / "Makefile", *ROOT.glob("requirements*.lock")):
        shutil.copy(file, folder)
    python.write_text(STUB, encoding="utf-8")
    python.chmod(0o755)
    (folder / ".venv/locked").write_text(str(folder), encoding="utf-8")
    for mark in ("ready", "tools"):
        (folder / ".venv" / mark).touch()
    return folder


def make(folder, *arguments, **environment):
    """What `make` does in a folder: (the run, the arguments of each call of its Python)."""
    # to the run of make that these tests may be part of
    given = ("PYTEST_ARGS", "CONFIG", "WITH", "ARCHIVE")
    handed_down = dict.fromkeys(n for n in os.environ if n.startswith("MAKE") or n in given)
    command = ("make", "--no-print-directory", *arguments)
    done = run(*command, folder=folder, timeout=60, **handed_down | environment)
    calls = folder / "calls"
    text = calls.read_text(encoding="utf-8") if calls.exists() else ""
    return done, [call.split("\n") for call in text.split("\nend\n")[:-1]]


READ = ["-m", "dampbalance.project.documents", "config/config.yaml"]
RUN = ["-m", "snakemake", "--workflow-profile", "workflow/profiles/default", "--cores", "all"]
CASE = "it's a $x $(y).yaml"


@pytest.mark.parametrize(
    ("arguments", "called"),
    [
        (["check"], [READ, [*RUN, "check"]]),
        (["check", f"CONFIG={CASE}"], [[*READ, CASE], [*RUN, f"--configfile={CASE}", "check"]]),
        (["compare", "WITH=../o'th er/$re"], [["-m", "same_results", "results", "../o'th er/$re"]]),
    ],
)
def test_make_tells_python_every_path_as_it_is(odd, arguments, called):
    done, calls = make(odd, *arguments)
    assert done.returncode == 0, done.stderr
    assert [call[1:] for call in calls] == called


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_an_archive_holds_sources_and_results_with_digests_in_the_same_bytes(odd):
    (odd / ".gitignore").write_text("/.venv\n/results\n/calls\n", encoding="utf-8")
    (odd / "results/paper").mkdir(parents=True)
    (odd / "results/paper/a.csv").write_text("1\n", encoding="utf-8")
    git(odd, "init", "--quiet")
    git(odd, "add", "--all")
    git(odd, "commit", "--quiet", "--message=all")
    packed = []
    for _ in range(2):
        done, calls = make(odd, "archive", "ARCHIVE=an $archive.tar.gz")
        assert done.returncode == 0, done.stderr
        assert calls[-1][1:] == RUN
        packed.append((odd / "an $archive.tar.gz").read_bytes())
        (odd / "an $archive.tar.gz").unlink()
    assert packed[0] == packed[1]
    with tarfile.open(fileobj=io.BytesIO(packed[0])) as tar:
        tar.extractall(odd / "results/unpacked", filter="data")
    (top,) = (odd / "results/unpacked").iterdir()
    lines = (top / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    listed = {path: digest for digest, path in (line.split("  ", 1) for line in lines)}
    assert {"results/paper/a.csv", "Makefile", "pyproject.toml"} <= set(listed)
    there = {path: hashlib.sha256(data).hexdigest() for path, data in contents(top).items()}
    del there["SHA256SUMS"]
    assert listed == there
    (odd / "new.yaml").touch()
    done, _ = make(odd, "archive")
    assert done.returncode != 0
    assert "error: results belong to committed sources" in done.stderr


def test_a_folder_in_which_no_environment_works_is_refused_before_anything(odd):
    done, calls = make(odd.rename(odd.with_name("a:b")), "check")
    assert (done.returncode != 0, calls) == (True, [])
    assert "a:b: in a folder with one of" in done.stderr


@pytest.mark.parametrize(
    "environment", [{"HOME": "/dev/null/x"}, {"HOME": ""}, {"XDG_CACHE_HOME": "/dev/null/y"}]
)
def test_where_home_cannot_be_written_a_folder_of_the_project_serves(odd, environment):
    there = {"HOME": str(odd), "XDG_CACHE_HOME": ""}
    for given, home in ((there, odd), (there | environment, odd / ".snakemake/home")):
        assert home.is_dir() == (home == odd)
        done, calls = make(odd, "check", **given)
        assert done.returncode == 0, done.stderr
        assert calls[-1][0] == f"HOME={home}"


@pytest.mark.slow
def test_jobs_run_by_a_python_with_an_odd_path(tmp_path):
    """The environment is a link, whose path Snakemake writes into the command lines of its jobs."""
    folder = tmp_path / ODD
    copied(ROOT, folder)
    (folder / ".venv").symlink_to(sys.prefix)
    shutil.copy(ROOT / "tests/workflow/small.yaml", folder / "s m.yaml")
    target = "results/small/orbits/above.json"
    command = (folder / ".venv/bin/python", "-m", "snakemake", "--cores=1", "--configfile=s m.yaml")
    output_of(*command, target, folder=folder, PYTHONPATH=str(ROOT / "src"))
    assert (folder / target).is_file()
