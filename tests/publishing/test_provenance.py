"""What a manifest is made of, without a run of the workflow."""

from __future__ import annotations

import shutil
from importlib import metadata
from pathlib import Path

import pytest

from dampbalance.publishing.provenance.manifest import (
    code_version,
    digest_of,
    files_of,
    manifest,
)
from folders import PROJECT, ROOT
from processes import git

needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


@needs_git
def test_the_version_is_the_commit_and_whether_files_differ_from_it(tmp_path):
    (tmp_path / "file").write_text("one", encoding="utf-8")
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "--quiet", "--message=one", "--date=2001-02-03T12:00:00Z")
    found = code_version(tmp_path, "9.9")
    assert found["commit"] == git(tmp_path, "rev-parse", "HEAD").strip()
    assert (found["version"], found["known_from"], found["modified"]) == ("9.9", "git", False)
    (tmp_path / "file").write_text("two", encoding="utf-8")
    assert code_version(tmp_path, "9.9")["modified"] is True


@needs_git
def test_a_repository_around_an_unpacked_archive_says_nothing_of_it(tmp_path):
    git(tmp_path, "init", "--quiet")
    (tmp_path / "other").write_text("", encoding="utf-8")
    git(tmp_path, "add", "other")
    git(tmp_path, "commit", "--quiet", "--message=theirs")
    inner = tmp_path / "unpacked"
    inner.mkdir()
    assert code_version(inner, "1.0")["known_from"] == "nothing"


@needs_git
@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a git checkout")
def test_the_files_of_the_project_are_those_under_version_control():
    def listed(*options):
        return set(filter(None, git(ROOT, "ls-files", "-z", *options).split("\0")))

    found = set(files_of(ROOT, PROJECT))
    tracked = {file for file in listed() if (ROOT / file).exists()}
    assert tracked - found == set()
    assert found - tracked - listed("--others", "--exclude-standard") == set()


def test_caches_are_no_sources(tmp_path):
    for file in ("src/a.py", "src/__pycache__/a.pyc", "src/a.py~", "paper/.ipynb_checkpoints/b"):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text("", encoding="utf-8")
    assert files_of(tmp_path, ["src", "paper"]) == ["src/a.py"]


def test_a_digest_does_not_depend_on_the_order_of_keys_and_does_on_every_value():
    assert digest_of({"a": 1.0, "b": [2]}) == digest_of({"b": [2], "a": 1.0})
    assert digest_of({"a": 1.0}) != digest_of({"a": 1.0000000000000002})


def manifest_of(folder, monkeypatch, locked="numpy==0.1", **outputs):
    """The manifest of a run that made these files in a folder, from then on the current one."""
    monkeypatch.chdir(folder)
    lock = f"{locked} \\\n    --hash=sha256:00\n"
    for name, text in {"in": "1", "lock": lock, **outputs}.items():
        Path(name).write_text(text, encoding="utf-8")
    jobs = [{"rule": o, "script": "s.py", "inputs": ["in"], "outputs": [o]} for o in outputs]
    code = {"version": "1", "commit": "c0ffee", "committed": "2026-01-02", "modified": False}
    return manifest("case", {"case": "case"}, [], {"in": "in"}, jobs, code, "lock")


def test_a_package_that_is_not_as_locked_is_named(tmp_path, monkeypatch):
    right = manifest_of(tmp_path, monkeypatch, f"numpy=={metadata.version('numpy')}", out="2")
    assert right["run"]["packages_not_as_locked"] == []
    other = manifest_of(tmp_path, monkeypatch, out="2")
    assert other["run"]["packages_not_as_locked"] == ["numpy"]
    assert right["reproducible"] == other["reproducible"]  # what differs is in its own part
