"""Studies made of documents, for the tests of this folder."""

from __future__ import annotations

import pytest
import yaml

from dampbalance import __version__
from dampbalance.studies import checking, evaluate, outputs
from folders import PAPER_FILE, STUDY_SCHEMA


@pytest.fixture(scope="session")
def make(tmp_path_factory):
    """Makes the study of a document: make({"axes": …}) -> Study; a title is added where there is none."""

    def study(document, name="test"):
        path = tmp_path_factory.mktemp("study") / f"{name}.yaml"
        path.write_text(yaml.safe_dump({"title": "Test"} | document), encoding="utf-8")
        return checking.read_study(path, STUDY_SCHEMA, PAPER_FILE)

    return study


@pytest.fixture(scope="session")
def computed(make, tmp_path_factory):
    """Makes a study and computes it: computed({"axes": …}) -> (Study, its table of cases, the file that holds it).

    Columns that are given stand for computed ones; a table that is given stands for the computed one.
    """

    def run(document, table=None, **columns):
        study = make(document)
        table = evaluate.evaluate(study, 0, study.cases) if table is None else table
        path = tmp_path_factory.mktemp("cases") / "cases.parquet"
        outputs.write_parts(path, [table.assign(**columns)], study, __version__)
        return study, table, path

    return run
