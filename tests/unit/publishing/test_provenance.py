"""What a manifest, a crate and an archive are made of, without a run of the workflow."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import tarfile
from importlib import metadata
from pathlib import Path

import pytest
import yaml

from dampbalance.publishing.provenance import archive
from dampbalance.publishing.provenance.crate import CrateFolder, crate
from dampbalance.publishing.provenance.manifest import (
    PROJECT,
    code_version,
    digest_of,
    files_of,
    manifest,
)
from folders import ROOT
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
    stated = {"commit": "abc", "committed": "2026-01-02", "modified": False}
    (inner / "VERSION.json").write_text(json.dumps(stated), encoding="utf-8")
    assert code_version(inner, "1.0") == {"version": "1.0", **stated, "known_from": "archive"}


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
    assert files_of(tmp_path) == ["src/a.py"]


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


def test_the_date_of_a_crate_is_that_of_the_release(tmp_path, monkeypatch):
    made = manifest_of(tmp_path, monkeypatch, out="2")
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    citation.pop("date-released", None)

    def date(citation):
        graph = crate(made, "manifest.json", citation)["@graph"]
        return next(entity for entity in graph if entity["@id"] == "./")["datePublished"]

    assert date(citation) == "2026-01-02"  # not released: of the commit
    assert date(citation | {"date-released": "2027-05-06"}) == "2027-05-06"


@pytest.mark.parametrize(
    ("path", "beside", "away"),
    [
        ("results/it/a b.csv", "a%20b.csv", "a%20b.csv"),
        ("results/studies/x.csv", "../studies/x.csv", "../studies/x.csv"),
        ("config/c.yaml", "../../config/c.yaml", "#config/c.yaml"),
    ],
)
def test_sources_in_another_folder_are_described_and_results_are_found(path, beside, away):
    assert CrateFolder("results/it").name(path) == beside
    assert CrateFolder("results/it", beside_sources=False).name(path) == away


def test_large_results_stay_out_and_are_named(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "LARGEST_PACKED", 10)
    made = manifest_of(tmp_path, monkeypatch, small="123", large="x" * 11)
    for name in ("source", "manifest.json", "crate.json"):
        (tmp_path / name).write_text("{}", encoding="utf-8")
    citation = {"title": "t", "abstract": "a", "license": "BSD-3-Clause"}
    given = (["source"], made, "manifest.json", "crate.json", citation)
    archive.pack("it.tar.gz", *given, rebuild="make")
    with tarfile.open("it.tar.gz") as tar:
        names = {name.removeprefix("it/") for name in tar.getnames()}
        text = tar.extractfile("it/ARCHIVE.md").read().decode()
    assert {"small", "source"} <= names
    assert "large" not in names
    assert "- `large`" in text
    assert "commit c0ffee" in text

    def edited_meanwhile(*_, **__):
        (tmp_path / "source").write_text("{ }", encoding="utf-8")
        return {}

    monkeypatch.setattr(archive, "crate", edited_meanwhile)
    with pytest.raises(ValueError, match="source changed while it was packed"):
        archive.pack("other.tar.gz", *given, rebuild="make")
    assert not (tmp_path / "other.tar.gz").exists()


def packed(path, *entries):
    """An archive of entries: a name, with the kind of tarfile and what it links to where it is no file."""
    with tarfile.open(path, "w:gz") as tar:
        for name, *of in entries:
            entry = tarfile.TarInfo(name)
            entry.type, entry.linkname = (*of, "")[:2] if of else (tarfile.REGTYPE, "")
            entry.size, entry.mode = (4, 0o6755) if entry.isfile() else (0, 0o755)
            tar.addfile(entry, io.BytesIO(b"text"))
    return path


def test_an_archive_is_unpacked_as_it_was_packed(tmp_path):
    entries = ("dampbalance-1", tarfile.DIRTYPE), ("dampbalance-1/a b/c..d",), ("dampbalance-1/e",)
    archive.unpack(packed(tmp_path / "a.tar.gz", *entries), tmp_path / "new")
    files = [file for file in (tmp_path / "new").rglob("*") if file.is_file()]
    top = tmp_path / "new/dampbalance-1"
    assert set(files) == {top / "a b/c..d", top / "e"}
    assert {(file.read_text(), file.stat().st_mode & 0o7777) for file in files} == {("text", 0o755)}


@pytest.mark.parametrize(
    ("entry", "expected"),
    [
        (("../x",), "'../x' leads out of the folder"),
        (("dampbalance-1/a/../../../x",), "leads out of the folder"),
        (("/tmp/x",), "leads out of the folder"),
        (("dampbalance-1\\..\\x",), "leads out of the folder"),
        (("dampbalance-1/x", tarfile.SYMTYPE, "../.."), "is a link or a device"),
        (("dampbalance-1/x", tarfile.LNKTYPE, "dampbalance-1/a"), "is a link or a device"),
        (("dampbalance-1/x", tarfile.CHRTYPE), "is a link or a device"),
        (("dampbalance-1/x", tarfile.FIFOTYPE), "is a link or a device"),
        (("other/x",), "does not hold one folder dampbalance-…"),
        (("dampbalance-2/x",), "does not hold one folder dampbalance-…"),
    ],
)
def test_an_archive_that_leads_elsewhere_is_refused_before_anything_is_written(
    tmp_path, entry, expected
):
    file = packed(tmp_path / "a.tar.gz", ("dampbalance-1/a",), entry)
    with pytest.raises(ValueError, match=re.escape(expected)) as caught:
        archive.unpack(file, tmp_path / "new")
    assert str(caught.value).startswith(f"{file}: ")
    assert os.listdir(tmp_path) == ["a.tar.gz"]


@pytest.mark.parametrize("keep", [0, 10, 60])
def test_an_archive_that_is_cut_off_is_refused(tmp_path, keep):
    file = packed(tmp_path / "a.tar.gz", ("dampbalance-1/a",))
    file.write_bytes(file.read_bytes()[:keep])
    with pytest.raises(ValueError, match="cannot be read as an archive"):
        archive.unpack(file, tmp_path / "new")
