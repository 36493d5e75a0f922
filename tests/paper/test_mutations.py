"""Would a wrong digit be noticed? Every computed number, its last digit one up and one down, is judged anew.

A mutant is caught where its own verdict gets worse. Two kinds are not, and each stands below with its reason: SAME, for
which print leaves the digit open, and BETTER, for which the other digit happens to be the one that a route gives.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pandas as pd
import pytest

from dampbalance.replication.claim_ids import part_of
from dampbalance.replication.claims import claims_table, read_published
from dampbalance.replication.printed import Printed
from dampbalance.replication.verdicts import RECONSTRUCTED, REPRODUCED, VERDICTS
from paper.routes import CASE, PUBLISHED, as_published, exact, unrounded

pytestmark = pytest.mark.slow

PRINT = read_published(PUBLISHED)
RANKS = list(VERDICTS)

OPEN = (
    "computed from digits that are not printed: the rest of Table 2 leaves room for this one, too"
)
BY_EXACT = (
    "the printed digit bears a reading or a simulation; moved, it is the one of the exact solution"
)
BY_AUTHORS = (
    "the as-published simulation is one or two units off print, and this is the digit it gives"
)

SAME = {
    ("table2.c.1-2", +1): OPEN,
    (
        "table2.c.4-5",
        -1,
    ): "the as-published simulation gives this digit, the printed integrals the printed one",
    ("table2.F_k.1-2", +1): OPEN,
    ("table2.F_k.1-2", -1): OPEN,
    ("table2.F_k.2-3", +1): OPEN,
    ("table2.F_k.2-3", -1): OPEN,
    ("table2.F_k.3-4", -1): OPEN,
    ("table2.F_k.1-5", +1): OPEN,
}
BETTER = {
    ("table2.a.3", +1): BY_AUTHORS,
    ("table2.F_k.3-4", +1): BY_AUTHORS,
    ("table2.F_k.4-5", +1): BY_AUTHORS,
    ("table3.t_s.F_k.2-3", -1): BY_EXACT,
    ("table3.t_s.F_k.3-4", -1): BY_EXACT,
    ("table3.t_s.c.2-3", -1): BY_EXACT,
    ("table3.t_s.c.3-4", -1): BY_EXACT,
    ("table3.t_s.c.4-5", -1): BY_EXACT,
    ("table3.X_s.F_k.3-4", -1): BY_EXACT,
    ("table3.X_s.F_k.4-5", -1): BY_EXACT,
    ("table3.X_s.F_k.1-5", +1): BY_EXACT,
    ("table3.X_s.c.2-3", -1): BY_EXACT,
    ("text.c_Xs_ls", +1): "print is cut off; the digit above is the rounded one",
}
CAUGHT = {"parameter": 1.0, "table1": 1.0, "table2": 0.78, "table3": 0.85, "text": 0.97}
"""The share of mutants whose own verdict gets worse, by part of the paper, at least."""


def judged(published) -> pd.DataFrame:
    return claims_table(published, CASE, exact(), as_published(), unrounded()).set_index("id")


def mutants() -> Iterator[tuple[str, int, str, str]]:
    """Every printed number, moved: file, step, line, column."""
    for file in (
        "parameters",
        "table1",
        "table2_integrals",
        "table2_pairs",
        "table3",
        "text_values",
    ):
        frame = getattr(PRINT, file)
        columns = ["printed"] if "printed" in frame else frame.columns.drop("Y_m", errors="ignore")
        for line in frame.index:
            for column in columns:
                if Printed(frame[column][line]).is_number:
                    yield from ((file, step, line, column) for step in (+1, -1))


@pytest.fixture(scope="module")
def verdicts():
    """A line per mutant of a computed number: id, step, rank of its verdict before and after."""
    before = judged(PRINT)
    lines = []
    for file, step, line, column in mutants():
        frame = getattr(PRINT, file).copy()
        frame.loc[line, column] = Printed(frame[column][line]).moved(step)
        after = judged(replace(PRINT, **{file: frame}))
        (name,) = after.index[after["printed"] != before["printed"]]
        if before["kind"][name] == "computed":
            was, now = before["verdict"][name], after["verdict"][name]
            lines.append((name, step, was, now, RANKS.index(now) - RANKS.index(was)))
    return pd.DataFrame(lines, columns=["id", "step", "was", "now", "worse"])


def test_all_computed_numbers_are_mutated_both_ways(verdicts):
    computed = judged(PRINT)["kind"].eq("computed").sum()
    assert len(verdicts) == 2 * computed
    assert verdicts["id"].nunique() == computed


def test_wrong_digits_are_caught_in_every_part(verdicts):
    caught = (verdicts["worse"] > 0).groupby(verdicts["id"].map(part_of)).mean()
    for part, share in CAUGHT.items():
        assert caught[part] >= share, caught.to_dict()


def test_every_survivor_has_its_reason(verdicts):
    for group, known in ((verdicts["worse"] == 0, SAME), (verdicts["worse"] < 0, BETTER)):
        survivors = set(zip(verdicts.loc[group, "id"], verdicts.loc[group, "step"], strict=True))
        assert survivors == set(known)


def test_a_mutant_improves_only_by_the_route_that_its_reason_names(verdicts):
    now = verdicts.set_index(["id", "step"])["now"]
    for mutant, reason in BETTER.items():
        if reason == BY_EXACT:
            assert now[mutant] == REPRODUCED.name
        elif reason != BY_AUTHORS:
            assert now[mutant] == RECONSTRUCTED.name
