"""The check fails, naming the rows, when a parameter or a printed digit is changed; on the paper's case it passes."""

from __future__ import annotations

import re

import pytest
import yaml

from dampbalance.replication.claims.verdicts import VERDICTS
from folders import restored

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def paper(checkout):
    """The paper's case, checked."""
    copy = checkout()
    copy.made("check")
    return copy


def changed(copy, file, pattern, replacement):
    """What the check says against one change in a file, which is undone."""
    path = copy.folder / file
    after, count = re.subn(pattern, replacement, path.read_text(encoding="utf-8"), count=1)
    assert count == 1, f"{pattern} is not in {file}"
    with restored(path):
        path.write_text(after, encoding="utf-8")
        return copy.refused("check")


def test_the_summary_is_printed_at_the_end(paper):
    said = paper.made("check", "--forcerun", "check")
    assert "Verdicts on the printed numbers" in said
    table = re.search(r"^all +([\d ]+)$", said, re.MULTILINE)
    computed, *by_verdict, given, statements = map(int, table[1].split())
    assert len(by_verdict) == len(VERDICTS)
    assert computed == sum(by_verdict)
    assert computed + given + statements > 130


def test_a_printed_word_that_cannot_be_judged_is_refused_before_anything_runs(paper):
    claims = paper.folder / "results/paper/claims.csv"
    before = claims.read_bytes()
    said = changed(paper, "paper/published/printed.csv", ",degraded,", ",unclear,")
    assert "cannot judge the word 'unclear'; known are degraded, improved" in said
    assert claims.read_bytes() == before


def test_a_changed_printed_digit_fails_the_check_and_names_the_row(paper):
    said = changed(paper, "paper/published/printed.csv", r"0\.00439", "0.00449")
    assert "table1.X.2: printed 0.00439 on record, now read as 0.00449" in said


def test_a_flipped_sign_in_an_equation_fails_the_check(paper):
    source = "src/dampbalance/balance.py"
    said = changed(paper, source, r"features\.X - features\.X_s", "features.X + features.X_s")
    assert "table3.X_s.F_k.1-2" in said
    assert "text.accuracy_omega2: printed degraded" in said  # a word may be worse off, too


def test_a_changed_parameter_fails_the_check_and_names_the_rows(paper):
    """The rest is built, and the rows are the last thing on the screen; so again in the next run, and not after that.

    After the others: what it leaves behind is the case of another oscillator.
    """
    table = paper.folder / "results/paper/tables/table1.csv"
    file = paper.folder / "config/config.yaml"
    right = file.read_text(encoding="utf-8")
    file.write_text(right.replace("c_N_s_per_m: 90.0", "c_N_s_per_m: 91.0"), encoding="utf-8")
    assert not table.exists()
    for run, quiet in enumerate([(), ("--quiet", "all", "--")]):  # a quiet run leaves no log
        done = paper.run(*quiet, "check", "tables")
        assert done.returncode != 0, f"run {run}"
        assert table.is_file()
        said = done.stdout.splitlines()
        heading = next(i for i, line in enumerate(said) if "worse off than on record" in line)
        assert all(line.startswith("  ") for line in said[heading + 1 :])
        assert any(line.startswith("  parameter.c: printed 90.0") for line in said[heading:])
        assert any(line.startswith("  table3.X_s.c.1-2: printed 90.02") for line in said[heading:])
        assert "Error in rule" not in done.stderr
        assert "Traceback" not in done.stderr
    file.write_text(right, encoding="utf-8")
    assert "worse off" not in paper.made("check")


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("published: papers/published", "papers/published is not a folder with printed numbers"),
        ("excitation: {levels_m: [0.004, 0.006]}", "has numbers for 5 levels at omega1"),
    ],
)
def test_a_case_without_printed_numbers_is_told_so(paper, override, expected):
    (paper.folder / "mine.yaml").write_text(
        f"case: mine\nestimation: {{pairs: [[1, 2]]}}\n{override}\n", encoding="utf-8"
    )
    said = paper.refused("--configfile", "mine.yaml")
    assert expected in said
    assert "published: null" in said or "use null" in said
    assert not (paper.folder / "results/mine").exists()


def test_an_override_that_would_replace_the_results_of_the_paper_is_refused(paper):
    (paper.folder / "mine.yaml").write_text("oscillator: {F_k_N: 1.5}\n", encoding="utf-8")
    summary = paper.folder / "results/paper/summary.txt"
    before = summary.read_bytes()
    said = paper.refused("--configfile", "mine.yaml")
    assert "mine.yaml: case: is missing" in said
    assert "Traceback" not in said
    assert summary.read_bytes() == before


# --- what a codechecker compares -----------------------------------------------------------------


def test_the_outputs_that_codecheck_names_are_made(paper):
    configuration = yaml.safe_load((paper.folder / "codecheck.yml").read_text(encoding="utf-8"))
    files = [item["file"] for item in configuration["manifest"]]
    assert len(files) == 8
    paper.made(*files)
    for file in files:
        assert (paper.folder / file).stat().st_size > 0, file
