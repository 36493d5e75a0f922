"""The check fails, naming the rows, when a parameter or a printed digit is changed; on the paper's case it passes."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace

import pandas as pd
import pytest

from dampbalance.replication.claims.table import CLAIM_COLUMNS, WORSE
from dampbalance.replication.claims.verdicts import ROUTE_NAMES
from folders import PUBLISHED
from workflow.copies import edited

pytestmark = pytest.mark.slow

FEW = "{case: mine, excitation: {levels_m: [0.004, 0.006]}, estimation: {pairs: [[1, 2]]}}"


def assert_told(done, *rows):
    """A failed run ends with ten rows that are worse at most, these among them, and the file that has all."""
    assert done.returncode != 0
    lines = done.stdout.splitlines()
    _, remedy, _, *shown, where = lines[next(i for i, line in enumerate(lines) if WORSE in line) :]
    assert "published: null" in remedy
    assert len(shown) <= 10
    assert [row for row in rows if not any(line.startswith(f"  {row} ") for line in shown)] == []
    assert "results/paper/summary.txt" in where


def test_a_run_fails_where_a_verdict_is_worse_than_on_record(checkout):
    """Claims as on record but for two. What they follow from is not there: only the comparison runs."""
    printed = pd.read_csv(PUBLISHED / "printed.csv", dtype=str, keep_default_na=False)
    recorded = pd.read_csv(PUBLISHED / "verdicts.csv", dtype=str)
    claims = printed.drop(columns="kind").rename(columns={"claim": "kind"})
    claims = claims.merge(recorded).reindex(columns=CLAIM_COLUMNS, fill_value="")
    claims["judged"] = ROUTE_NAMES["exact"]
    worse = ["table1.X.2", "table3.X_s.F_k.1-2"]
    folder = checkout.folder / "results/paper"
    folder.mkdir()
    claims.loc[claims["id"].isin(worse), "verdict"] = "differs"
    claims.to_csv(folder / "claims.csv", index=False)
    assert_told(checkout.run("check"), *worse)


def test_a_digit_a_sign_and_a_parameter_that_change_fail_the_check_and_are_named(checkout):
    own = replace(checkout, package=checkout.folder)  # its balance is another one
    with ExitStack() as undone:
        for file, old, new in (
            ("paper/published/printed.csv", "0.00439", "0.00449"),
            (
                "src/dampbalance/balance.py",
                "features.X - features.X_s",
                "features.X + features.X_s",
            ),
            ("config/config.yaml", "c_N_s_per_m: 90.0", "c_N_s_per_m: 91.0"),
        ):
            undone.enter_context(edited(own.folder / file, {old: new}))
        for _ in range(2):  # the second time, all is there, and only compared again
            assert_told(own.run("check", "tables"))
        listed = (own.folder / "results/paper/summary.txt").read_text(encoding="utf-8")
    for row in (
        "table1.X.2: printed 0.00439 on record, now read as 0.00449",
        "parameter.c: printed 90.0",
        "table3.X_s.F_k.1-2: printed",
        "text.accuracy_omega2: printed degraded",  # a word may be worse off, too
    ):
        assert f"\n  {row}" in listed, row
    said = own.made("check")
    assert (WORSE in said, said.count("133 verdicts as on record.")) == (False, 1)


def test_what_cannot_be_compared_is_refused(checkout):
    for override, words, expected in (
        ("{case: mine, published: papers}", {}, "is not a folder with printed numbers"),
        (FEW, {}, "has numbers for 5 levels"),
        ("{oscillator: {F_k_N: 1.5}}", {}, "mine.yaml: case: is missing"),
        ("{case: mine}", {",degraded,": ",unclear,"}, "cannot judge the word 'unclear'"),
    ):
        (checkout.folder / "mine.yaml").write_text(override, encoding="utf-8")
        with edited(checkout.folder / "paper/published/printed.csv", words):
            assert expected in checkout.refused("--configfile", "mine.yaml")
    assert [path.name for path in (checkout.folder / "results").iterdir()] == ["README.md"]
