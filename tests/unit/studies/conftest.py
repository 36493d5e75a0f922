"""Studies made of documents, for the tests of this folder."""

from __future__ import annotations

import pytest
import yaml

from dampbalance.studies import checking
from folders import PAPER_FILE, STUDY_SCHEMA


@pytest.fixture(scope="session")
def make(tmp_path_factory):
    """Makes the study of a document: make({"axes": …}) -> Study; a title is added where there is none."""

    def study(document, name="test"):
        path = tmp_path_factory.mktemp("study") / f"{name}.yaml"
        path.write_text(yaml.safe_dump({"title": "Test"} | document), encoding="utf-8")
        return checking.read_study(path, STUDY_SCHEMA, PAPER_FILE)

    return study
