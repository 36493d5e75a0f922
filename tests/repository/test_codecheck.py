"""codecheck.yml keeps to its specification, and names every table and figure of the paper that is rebuilt."""

from __future__ import annotations

import re

import pytest
import yaml

from dampbalance.project.documents import against_schema, read_schema, read_yaml
from folders import ROOT

FILE, SCHEMA = (
    ROOT / "codecheck.yml",
    ROOT / "src/dampbalance/project/schemas/codecheck.schema.yaml",
)
PAPER = {"title": "A", "authors": [{"name": "A"}], "reference": "https://doi.org/10.1/a"}


@pytest.fixture
def configuration():
    return read_yaml(FILE)


def problems(configuration):
    return against_schema(configuration, read_schema(SCHEMA))


def test_it_starts_as_the_specification_wants():
    assert FILE.read_bytes().decode("utf-8").startswith("---\n")


def test_what_only_a_codechecker_knows_is_not_made_up(configuration):
    known_later = {"codechecker", "report", "certificate", "check_time", "summary"}
    assert not known_later & set(configuration)


def test_the_paper_is_the_one_that_is_cited(configuration):
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    (cited,) = citation["references"]
    assert configuration["paper"]["title"] == cited["title"]
    assert [author["name"] for author in configuration["paper"]["authors"]] == [
        f"{author['given-names']} {author['family-names']}" for author in cited["authors"]
    ]
    assert configuration["paper"]["reference"].endswith(cited["number"])


def test_every_table_and_figure_of_the_paper_is_named(configuration):
    named = {item["comment"].partition(":")[0]: item["file"] for item in configuration["manifest"]}
    rules = (ROOT / "workflow/rules/figures.smk").read_text(encoding="utf-8")
    printed = (ROOT / "paper/published/printed.csv").read_text(encoding="utf-8")
    figures, tables = re.findall(r'"figure(\d)"', rules), re.findall(r"(?m)^table(\d)", printed)
    wanted = {f"Figure {n}": f"figures/figure{n}.svg" for n in figures}
    wanted |= {f"Table {n}": f"tables/table{n}.csv" for n in tables}
    assert len(wanted) == 6
    wanted["Text"] = "tables/statistics.csv"
    wanted["Every printed number of text and tables"] = "claims.csv"
    assert named == {key: f"results/paper/{file}" for key, file in wanted.items()}


def test_it_keeps_to_the_schema(configuration):
    assert problems(configuration) == []


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"manifest": []}, "manifest"),
        ({"manifest": [{"file": "/a.csv", "comment": "A"}]}, "file"),
        ({"manifest": [{"file": "results/../../a.csv", "comment": "A"}]}, "file"),
        ({"manifest": [{"comment": "A"}]}, "manifest"),
        ({"version": "https://codecheck.org.uk/spec/config/0.9/"}, "version"),
        ({"paper": PAPER | {"authors": []}}, "authors"),
        ({"paper": PAPER | {"title": "FIXME"}}, "title"),
        ({"paper": PAPER | {"reference": "https://a.org/a.pdf"}}, "reference"),
        ({"paper": PAPER | {"authors": [{"name": "A", "ORCID": "https://orcid.org/0"}]}}, "ORCID"),
    ],
)
def test_what_the_rules_of_codecheck_forbid_is_refused(configuration, change, key):
    found = problems(configuration | change)
    assert found
    assert all(key in f"{place} {text}" for place, text in found), found
