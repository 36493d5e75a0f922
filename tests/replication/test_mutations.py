"""Would a wrong digit be noticed? Every computed number, its last digit one up and one down, is judged anew.

A mutant is caught where its own verdict gets worse. Two kinds are not, and each stands below with its reason: SAME, for
which print leaves the digit open or which differ anyway, and BETTER, for which the other digit happens to be the one
that a better route gives, with its verdict.
"""

from __future__ import annotations

import itertools

import pandas as pd
import pytest

from dampbalance.replication.claims.verdicts import part_of
from replication.mutants import of_print, originals

pytestmark = pytest.mark.slow

DIFFERS = (
    *("table2.b.1", "table2.F_k.1-2", "table2.c.1-2"),
    *("table2.F_k.1-5", "table2.c.1-5"),
)
OPEN = ("table2.F_k.2-3", +1), ("table2.F_k.2-3", -1), ("table2.F_k.3-4", -1)
SAME = {
    **dict.fromkeys(itertools.product(DIFFERS, (+1, -1)), "differs as it is"),
    **dict.fromkeys(OPEN, "of digits that are not printed: the rest of Table 2 leaves room for it"),
}
BY_AUTHORS = "the as-published simulation is one unit off print, and this is the digit it gives"
CLOSER = "the as-published simulation is two units off print, and one of this digit"
EXACT = "the exact solution is a unit off print, and this is the digit it gives"
BETTER = {
    ("table2.a.3", +1): (CLOSER, "last digit"),
    ("table2.F_k.3-4", +1): (CLOSER, "last digit"),
    ("table2.c.4-5", -1): (BY_AUTHORS, "simulated"),
    ("table2.F_k.4-5", +1): (BY_AUTHORS, "simulated"),
    ("table3.X_s.c.2-3", -1): (EXACT, "reproduced"),
    ("table3.X_s.F_k.3-4", -1): (EXACT, "reproduced"),
    ("table3.X_s.F_k.4-5", -1): (EXACT, "reproduced"),
    ("text.c_Xs_ls", +1): ("print is cut off; the digit above is the rounded one", "from print"),
}
CAUGHT = {"parameter": 1.0, "table1": 1.0, "table2": 0.66, "table3": 0.95, "text": 0.97}
"""The share of mutants whose own verdict gets worse, by part of the paper, at least."""


@pytest.fixture(scope="module")
def verdicts():
    """(id, step) of a mutant of a computed number → verdict after, by how many ranks it is worse."""
    return {(m.before.row.id, m.step): (m.verdicts[1], m.worse) for m in of_print(+1, -1)}


def test_wrong_digits_are_caught_in_every_part(verdicts):
    assert {name for name, _ in verdicts} == {claim.row.id for claim in originals()}
    assert len(verdicts) == 200
    worse = pd.Series([worse > 0 for _, worse in verdicts.values()])
    caught = worse.groupby([part_of(name) for name, _ in verdicts]).mean()
    for part, share in CAUGHT.items():
        assert caught[part] >= share, caught.to_dict()


def test_every_survivor_has_its_reason(verdicts):
    assert {mutant for mutant, (_, worse) in verdicts.items() if worse == 0} == set(SAME)
    better = {mutant: now for mutant, (now, worse) in verdicts.items() if worse < 0}
    assert better == {mutant: now for mutant, (_, now) in BETTER.items()}
