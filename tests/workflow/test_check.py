"""The check fails, naming the rows, when a parameter or a printed digit is changed; on the paper's case it passes."""

from __future__ import annotations

import re
from contextlib import ExitStack

import pytest

from dampbalance.replication.claims.table import WORSE
from dampbalance.replication.claims.verdicts import VERDICTS
from folders import restored

pytestmark = pytest.mark.slow


CHANGES = (
    ("paper/published/printed.csv", r"0\.00439", "0.00449"),
    ("src/dampbalance/balance.py", r"features\.X - features\.X_s", "features.X + features.X_s"),
    ("config/config.yaml", r"c_N_s_per_m: 90\.0", "c_N_s_per_m: 91.0"),
)


@pytest.fixture(scope="module")
def checked(checkout):
    """The paper's case, with what its check said: two runs with CHANGES, their summary, and a run without them."""
    copy = checkout()
    with ExitStack() as undone:
        for file, pattern, replacement in CHANGES:
            undone.enter_context(restored(copy.folder / file))
            change(copy, file, pattern, replacement)
        # a quiet run leaves no log
        wrong = [copy.run(*quiet, "check", "tables") for quiet in ((), ("--quiet", "all", "--"))]
        assert (copy.folder / "results/paper/tables/table1.csv").is_file()
        listed = (copy.folder / "results/paper/summary.txt").read_text(encoding="utf-8")
    return copy, wrong, listed, copy.made("check")


@pytest.fixture
def paper(checked):
    return checked[0]


def change(copy, file, pattern, replacement):
    """Make one change in a file."""
    path = copy.folder / file
    after, count = re.subn(pattern, replacement, path.read_text(encoding="utf-8"), count=1)
    assert count == 1, f"{pattern} is not in {file}"
    path.write_text(after, encoding="utf-8")


def test_one_line_at_the_end_says_that_nothing_is_worse_any_more(checked):
    copy, *_, said = checked
    assert WORSE not in said
    assert said.count("133 verdicts as on record.") == 1
    assert "Verdicts on the printed numbers that" not in said
    text = (copy.folder / "results/paper/summary.txt").read_text(encoding="utf-8")
    table = re.search(r"^all +([\d ]+)$", text, re.MULTILINE)
    computed, *by_verdict, given, statements = map(int, table[1].split())
    assert len(by_verdict) == len(VERDICTS)
    assert computed == sum(by_verdict)
    assert computed + given + statements == 133


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        (
            "case: mine\npublished: papers/published\n",
            ["papers/published is not a folder with printed numbers", "null"],
        ),
        (
            "case: mine\nexcitation: {levels_m: [0.004, 0.006]}\nestimation: {pairs: [[1, 2]]}\n",
            ["has numbers for 5 levels at omega1", "null"],
        ),
        ("oscillator: {F_k_N: 1.5}\n", ["mine.yaml: case: is missing"]),
        (None, ["cannot judge the word 'unclear'; known are degraded, improved"]),
    ],
)
def test_what_cannot_be_compared_is_refused_before_anything_runs(paper, override, expected):
    before = paper.files("paper")
    printed = paper.folder / "paper/published/printed.csv"
    with restored(printed):
        if override is None:
            change(paper, "paper/published/printed.csv", ",degraded,", ",unclear,")
            said = paper.refused("check")
        else:
            (paper.folder / "mine.yaml").write_text(override, encoding="utf-8")
            said = paper.refused("--configfile", "mine.yaml")
    for part in expected:
        assert part in said
    assert paper.files("paper") == before
    assert not (paper.folder / "results/mine").exists()


def test_a_digit_a_sign_and_a_parameter_that_change_fail_the_check_and_are_named(checked):
    """The ten worst are the last thing on the screen, in the next run, too; all are in the summary."""
    _, wrong, listed, _ = checked
    for done in wrong:
        assert done.returncode != 0
        said = done.stdout.splitlines()
        heading = next(i for i, line in enumerate(said) if WORSE in line)
        remedy, *rows, where = said[heading + 1 :]
        assert "published: null" in remedy
        assert len(rows) == 1 + 10
        assert all(line.startswith("  ") and len(line) <= 120 for line in rows)
        assert "results/paper/summary.txt" in where
        assert "Error in rule" not in done.stderr
        assert "Traceback" not in done.stderr
    for row in (
        "table1.X.2: printed 0.00439 on record, now read as 0.00449",
        "parameter.c: printed 90.0",
        "table3.X_s.F_k.1-2: printed",
        "table3.X_s.c.1-2: printed 90.02",
        "text.accuracy_omega2: printed degraded",  # a word may be worse off, too
    ):
        assert f"\n  {row}" in listed, row
