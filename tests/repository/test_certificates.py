"""What others check by machine: the citation file, the licence of every file, the rules of the workflow catalogue."""

from __future__ import annotations

import json

import jsonschema
import pytest
import yaml

from folders import ROOT

CFF_SCHEMA = ROOT / "tests/repository/cff-1.2.0.schema.json"
CATALOGUE = ROOT / ".snakemake-workflow-catalog.yml"


# --- CITATION.cff --------------------------------------------------------------------------------


def citation() -> dict:
    # Dates stay text, as the schema wants them.
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    return yaml.load(text, yaml.BaseLoader)


def wrong_in(document: dict) -> list[str]:
    validator = jsonschema.Draft7Validator(
        json.loads(CFF_SCHEMA.read_text(encoding="utf-8")),
        format_checker=jsonschema.Draft7Validator.FORMAT_CHECKER,
    )
    return [error.json_path for error in validator.iter_errors(document)]


def typed(document: dict) -> dict:
    """With the one number of the file as a number, which the loader of text leaves as text."""
    references = [{**one, "year": int(one["year"])} for one in document["references"]]
    return {**document, "references": references}


def test_the_citation_file_follows_its_schema():
    assert wrong_in(typed(citation())) == []


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"licence": "BSD-3-Clause"}, "$"),  # British spelling: no key of the schema
        ({"license": "BSD 3"}, "$.license"),
        ({"authors": []}, "$.authors"),
        ({"date-released": "May 2026"}, "$['date-released']"),
    ],
)
def test_a_wrong_citation_would_be_seen(change, where):
    assert where in wrong_in({**typed(citation()), **change})


# --- licences ------------------------------------------------------------------------------------


def test_the_text_of_the_licence_is_that_of_the_project():
    text = (ROOT / "LICENSES/BSD-3-Clause.txt").read_text(encoding="utf-8")
    assert text == (ROOT / "LICENSE").read_text(encoding="utf-8")


# --- the workflow catalogue ----------------------------------------------------------------------

# What the page "Adding workflows" of the Snakemake workflow catalogue asks for ("standardized usage"), and the
# keys that its script generate-catalog.py reads.
CATALOGUE_SCHEMA = {
    "type": "object",
    "required": ["usage"],
    "additionalProperties": False,
    "properties": {
        "usage": {
            "type": "object",
            "required": ["software-stack-deployment"],
            "additionalProperties": False,
            "properties": {
                "mandatory-flags": {
                    "type": "object",
                    "additionalProperties": False,
                    "properties": {
                        "desc": {"type": "string"},
                        "flags": {"type": ["string", "array"], "items": {"type": "string"}},
                    },
                },
                "software-stack-deployment": {
                    "type": "object",
                    "propertyNames": {"enum": ["conda", "apptainer", "apptainer+conda"]},
                    "additionalProperties": {"type": "boolean"},
                },
                "report": {"type": "boolean"},
            },
        }
    },
}


def test_the_catalogue_can_read_how_the_workflow_is_used():
    jsonschema.validate(yaml.safe_load(CATALOGUE.read_text(encoding="utf-8")), CATALOGUE_SCHEMA)


def test_the_files_that_the_catalogue_asks_for_are_there():
    for name in ("workflow/Snakefile", "config/README.md", "LICENSE"):
        assert (ROOT / name).is_file(), name
    assert list((ROOT / "workflow/rules").glob("*.smk"))
    readme = (ROOT / "README.md").read_text(encoding="utf-8").lower()
    assert "snakemake" in readme
    assert "workflow" in readme
