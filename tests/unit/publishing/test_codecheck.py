"""The report for a CODECHECK says what the outputs are and how the printed numbers fare, and no more than that."""

from __future__ import annotations

import hashlib

import pandas as pd
import pytest

from dampbalance.publishing.codecheck import report

CONFIGURATION = {
    "paper": {
        "title": "A paper",
        "authors": [{"name": "A. Author"}, {"name": "B. Author"}],
        "reference": "https://doi.org/10.1/a",
    },
    "source": "Rebuilt from print.",
    "manifest": [
        {"file": "results/paper/figures/figure1.svg", "comment": "Figure 1: a line"},
        {"file": "results/paper/tables/table1.csv", "comment": "Table 1: some X_s"},
    ],
}
CLAIMS = pd.DataFrame(
    [
        ("table1.X.1", "Table 1, level 1", "X: peak", "m", "1.0", "1.02", "", "", "reproduced", "Fits.", "computed"),
        ("table1.X.2", "Table 1, level 2", "X: peak", "m", "2.0", "2.31", "", "", "differs", "Off.", "computed"),
        ("parameter.m", "Text", "mass", "kg", "3.0", "3.00", "", "", "reproduced", "Held.", "given"),
    ],
    columns=[
        *("id", "where", "quantity", "unit", "printed", "exact", "as_published", "from_print"),
        *("verdict", "explanation", "kind"),
    ],
)  # fmt: skip


@pytest.fixture
def written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("figures", "tables"):
        (tmp_path / "results/paper" / folder).mkdir(parents=True)
    (tmp_path / "results/paper/figures/figure1.svg").write_bytes(b"<svg/>")
    (tmp_path / "results/paper/tables/table1.csv").write_bytes(b"X\n1\n")
    (tmp_path / "results/paper/tables/table1.md").write_bytes(b"# Table 1\n\n| X |\n")
    path = "results/paper/codecheck/report.md"
    return lambda more: report(CONFIGURATION | more, CLAIMS, "9.9", path)


def test_outputs_have_their_sizes_and_digests(written):
    digest = hashlib.sha256(b"<svg/>").hexdigest()
    assert "| Figure 1: a line | 6 |" in written({})
    assert f"\n{digest}  results/paper/figures/figure1.svg\n" in written({})
    assert "[`results/paper/figures/figure1.svg`](../figures/figure1.svg)" in written({})


def test_verdicts_are_counted_and_what_is_off_is_told_with_its_reason(written):
    text = written({})
    counted, rest = text.split("## What no route gives, or the paper refutes")
    assert "| Table 1 | 2 | 1 | 0 | 0 | 0 | 0 | 0 | 0 | 0 | 1 |" in counted
    assert "the configuration holds 1." in counted
    assert "| Table 1, level 2 | X: peak (m) | 2.0 | 2.31 |  |  | differs | Off. |" in rest
    assert "Fits." not in text


def test_figures_and_tables_are_shown(written):
    assert "![Figure 1: a line](../figures/figure1.svg)" in written({})
    assert "### Table 1\n\n| X |" in written({})


def test_it_claims_no_certificate_that_is_not_there(written):
    assert "No codechecker has run this workflow" in written({})
    checker = {"codechecker": [{"name": "C. Checker"}], "report": "https://doi.org/10.2/b"}
    checked = written({"certificate": "2020-001", **checker})
    assert "Certificate 2020-001 by C. Checker: https://doi.org/10.2/b." in checked
    assert "No codechecker" not in checked
