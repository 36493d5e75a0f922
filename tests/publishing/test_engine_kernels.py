"""The engine of the page is what its sources make."""

from __future__ import annotations

import hashlib
import json
import shutil

import pytest

from dampbalance.publishing import engine as builder
from folders import ROOT
from processes import output_of
from processors import PROCESSORS

ENGINE = builder.FOLDER / builder.ENGINE
BUILDER = ROOT / ".venv-engine/bin/python"


@pytest.fixture(scope="module")
def record():
    return json.loads((builder.FOLDER / builder.RECORD).read_text("utf-8"))


def test_the_engine_is_made_of_the_sources_here(record):
    stale = "a kernel was edited: run `make engine`, and commit what it writes"
    assert record["sources"] == builder.source_digests(list(record["sources"])), stale
    assert record["engine"] == hashlib.sha256(ENGINE.read_bytes()).hexdigest()
    assert {"motion/one_slip.py", "motion/flow.py"} <= record["sources"].keys()


def test_an_edited_kernel_would_be_seen(record, tmp_path, monkeypatch):
    shutil.copytree(builder._PACKAGE / "motion", tmp_path / "motion")
    shutil.copytree(builder._PACKAGE / "publishing", tmp_path / "publishing")
    monkeypatch.setattr(builder, "_PACKAGE", tmp_path)
    assert record["sources"] == builder.source_digests(list(record["sources"]))
    with (tmp_path / "motion/flow.py").open("a", encoding="utf-8") as file:
        file.write("# edited\n")
    assert record["sources"] != builder.source_digests(list(record["sources"]))


@pytest.mark.slow
@pytest.mark.skipif(not BUILDER.exists(), reason="no environment of the engine: make engine")
def test_its_sources_make_the_same_bytes_on_another_processor(record, tmp_path):
    other = PROCESSORS["without-avx2"] | {"PYTHONPATH": str(ROOT / "src")}
    output_of(BUILDER, "-m", "dampbalance.publishing.engine", tmp_path, folder=tmp_path, **other)
    made = json.loads((tmp_path / builder.RECORD).read_text("utf-8"))
    if any(made[name] != record[name] for name in ("python", "tools")):
        pytest.skip("the engine here was made with another Python or other tools")
    assert (tmp_path / builder.ENGINE).read_bytes() == ENGINE.read_bytes()
