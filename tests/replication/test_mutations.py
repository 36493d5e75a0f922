"""Would a wrong digit be noticed? Every computed number, its last digit one up and one down, is judged anew.

A mutant is caught where its own verdict gets worse. Two kinds are not, and each stands below with its reason: SAME, for
which print leaves the digit open or which differ anyway, and BETTER, for which the other digit happens to be the one
that a better route gives, with its verdict.
"""

from __future__ import annotations

import pandas as pd
import pytest

from dampbalance.replication.claims.verdicts import part_of
from replication.mutants import of_print, originals

pytestmark = pytest.mark.slow

OPEN = (
    "computed from digits that are not printed: the rest of Table 2 leaves room for this one, too"
)
WORST = "differs as it is"
BY_AUTHORS = "the as-published simulation is one unit off print, and this is the digit it gives"
CLOSER = "the as-published simulation is two units off print, and one of this digit"

SAME = {
    ("table2.b.1", +1): WORST,
    ("table2.b.1", -1): WORST,
    ("table2.c.1-2", +1): WORST,
    ("table2.c.1-2", -1): WORST,
    ("table2.F_k.1-2", +1): WORST,
    ("table2.F_k.1-2", -1): WORST,
    ("table2.F_k.1-5", +1): WORST,
    ("table2.F_k.1-5", -1): WORST,
    ("table2.c.1-5", +1): WORST,
    ("table2.c.1-5", -1): WORST,
    ("table2.F_k.2-3", +1): OPEN,
    ("table2.F_k.2-3", -1): OPEN,
    ("table2.F_k.3-4", -1): OPEN,
}
BETTER = {
    ("table2.a.3", +1): (CLOSER, "last digit"),
    ("table2.F_k.3-4", +1): (CLOSER, "last digit"),
    ("table2.c.4-5", -1): (BY_AUTHORS, "simulated"),
    ("table2.F_k.4-5", +1): (BY_AUTHORS, "simulated"),
    **dict.fromkeys(
        [("table3.X_s.c.2-3", -1), ("table3.X_s.F_k.3-4", -1), ("table3.X_s.F_k.4-5", -1)],
        ("the exact solution is a unit off print, and this is the digit it gives", "reproduced"),
    ),
    ("text.c_Xs_ls", +1): ("print is cut off; the digit above is the rounded one", "from print"),
}
CAUGHT = {"parameter": 1.0, "table1": 1.0, "table2": 0.66, "table3": 0.95, "text": 0.97}
"""The share of mutants whose own verdict gets worse, by part of the paper, at least."""


@pytest.fixture(scope="module")
def verdicts():
    """A line per mutant of a computed number: id, step, verdict after, by how many ranks it is worse."""
    lines = [(m.before.row.id, m.step, m.verdicts[1], m.worse) for m in of_print(+1, -1)]
    return pd.DataFrame(lines, columns=["id", "step", "now", "worse"])


def test_all_computed_numbers_are_mutated_both_ways(verdicts):
    computed = {claim.row.id for claim in originals()}
    assert set(verdicts["id"]) == computed
    assert len(verdicts) == 2 * len(computed) == 200


def test_wrong_digits_are_caught_in_every_part(verdicts):
    caught = (verdicts["worse"] > 0).groupby(verdicts["id"].map(part_of)).mean()
    for part, share in CAUGHT.items():
        assert caught[part] >= share, caught.to_dict()


def test_every_survivor_has_its_reason(verdicts):
    for group, known in ((verdicts["worse"] == 0, SAME), (verdicts["worse"] < 0, BETTER)):
        survivors = set(zip(verdicts.loc[group, "id"], verdicts.loc[group, "step"], strict=True))
        assert survivors == set(known)


def test_a_mutant_improves_only_as_its_reason_says(verdicts):
    now = verdicts.set_index(["id", "step"])["now"]
    for mutant, (_, verdict) in BETTER.items():
        assert now[mutant] == verdict
