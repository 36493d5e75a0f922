"""What a manifest is made of, without a run of the workflow; and what CITATION.cff states."""

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
    software,
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
    (tmp_path / "unpacked").mkdir()  # an archive: the repository around it says nothing of it
    assert code_version(tmp_path / "unpacked", "1.0")["known_from"] == "nothing"


@needs_git
@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a git checkout")
def test_the_files_of_the_project_are_those_under_version_control():
    def listed(*options):
        return set(filter(None, git(ROOT, "ls-files", "-z", *options).split("\0")))

    found = set(files_of(ROOT, PROJECT))
    tracked = {file for file in listed() if (ROOT / file).exists()}
    assert tracked - found == set()
    assert found - tracked - listed("--others", "--exclude-standard") == set()


def test_a_manifest_names_what_made_each_file_and_packages_that_are_not_as_locked(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    for file in ("src/a.py", "src/__pycache__/a.pyc", "src/a.py~", "out"):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
        Path(file).write_text("1", encoding="utf-8")
    sources = {name: name for name in files_of(".", ["src"])}  # caches are none
    job = {"rule": "of_out", "script": "s.py", "inputs": ["src/a.py"], "outputs": ["out"]}
    code = {"version": "1", "commit": "c0ffee", "committed": "2026-01-02", "modified": False}
    made = []
    for version in (metadata.version("numpy"), "0.1"):
        Path("lock").write_text(f"numpy=={version} \\\n    --hash=sha256:00\n", encoding="utf-8")
        made.append(manifest("one", {"a": 1.0}, [], sources, [job], code, "lock"))
    right, other = made
    assert right["run"]["packages_not_as_locked"] == []
    assert other["run"]["packages_not_as_locked"] == ["numpy"]
    assert "BSD" in right["run"]["licences"]["numpy"]
    assert right["reproducible"] == other["reproducible"]  # what differs is in its own part
    assert [*right["reproducible"]["sources"]] == ["src/a.py"]
    (result,) = right["reproducible"]["results"]
    assert (result["path"], result["bytes"], result["rule"]) == ("out", 1, "of_out")
    assert result["sha256"] == right["reproducible"]["sources"]["src/a.py"]  # of the same content


def test_a_digest_depends_on_every_value_and_not_on_the_order_of_keys():
    assert digest_of({"a": 1.0, "b": [2]}) == digest_of({"b": [2], "a": 1.0})
    assert digest_of({"a": 1.0}) != digest_of({"a": 1.0000000000000002})


def test_authors_and_addresses_are_those_of_the_citation():
    person = {"given-names": "Ada", "name-particle": "de", "family-names": "Vries"}
    stated = {"version": "1.2.0", "license": "BSD-3-Clause", "authors": [person, {"name": "some"}]}
    found = {"version": "1.2.0", "licence": "BSD-3-Clause", "authors": ["Ada de Vries", "some"]}
    assert software(stated) == found | {"addresses": {}}
    stated |= {"repository-code": "a place", "doi": "", "contact": [{"name": "me", "email": "a@b"}]}
    assert software(stated)["addresses"] == {"repository": "a place", "contact": "me a@b"}
