"""Studies made of documents, for the tests of this folder."""

from __future__ import annotations

import functools
from dataclasses import replace

import pytest
import yaml

from dampbalance import __version__
from dampbalance.studies import case_files, evaluate, reading_study
from dampbalance.studies.shown.paragraph import paragraph
from studies.documents import document


@pytest.fixture(scope="session")
def make(tmp_path_factory):
    """Makes the study of a document: make({"axes": …}) -> Study; a title is added where there is none."""

    def study(document, name="test"):
        path = tmp_path_factory.mktemp("study") / f"{name}.yaml"
        path.write_text(yaml.safe_dump({"title": "Test"} | document), encoding="utf-8")
        return reading_study.read_study(path)

    return study


@pytest.fixture
def says(tmp_path):
    """Makes the paragraph of a study from a template: says(study, its file of cases, template)."""

    def text(study, cases, template):
        file = tmp_path / "test.md.j2"
        file.write_text(template, encoding="utf-8")
        return paragraph(replace(study, text=file), cases)[0]

    return text


@pytest.fixture(scope="session")
def computed(make, tmp_path_factory):
    """Makes a study and computes it: computed({"axes": …}) -> (Study, its table of cases, the file that holds it).

    The name of one of documents.yaml stands for it, and is computed once. Columns that are given stand for computed
    ones; a table that is given stands for the computed one.
    """

    @functools.cache
    def named(name):
        return run(document(name))

    def run(given, table=None, **columns):
        if isinstance(given, str):
            return named(given)
        study = make(given)
        table = evaluate.evaluate(study, 0, study.cases) if table is None else table
        path = tmp_path_factory.mktemp("cases") / "cases.parquet"
        case_files.write_parts(path, [table.assign(**columns)], study, __version__)
        return study, table, path

    return run
