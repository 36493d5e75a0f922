"""Would a wrong digit be noticed? Every computed number, its last digit one up and one down, is judged anew.

A mutant is caught where its own verdict gets worse. Two kinds are not, and each stands below with its reason: SAME, for
which print leaves the digit open, and BETTER, for which the other digit happens to be the one that a route gives.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import pandas as pd
import pytest

from dampbalance.replication.claim_ids import part_of
from dampbalance.replication.claims import claims_table, of_tables, of_text, read_published
from dampbalance.replication.claims.from_print import from_print
from dampbalance.replication.claims.inputs import Sources
from dampbalance.replication.claims.judging import Claim, verdict
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
    ("table3.X_s.F_k.3-4", -1): BY_EXACT,
    ("table3.X_s.F_k.4-5", -1): BY_EXACT,
    ("table3.X_s.c.2-3", -1): BY_EXACT,
    ("text.c_Xs_ls", +1): "print is cut off; the digit above is the rounded one",
}
CAUGHT = {"parameter": 1.0, "table1": 1.0, "table2": 0.78, "table3": 0.95, "text": 0.97}
"""The share of mutants whose own verdict gets worse, by part of the paper, at least."""


PARTS = {
    "parameters": [of_text.parameters],
    "table1": [of_tables.table1],
    "table2_integrals": [of_tables.table2_integrals],
    "table2_pairs": [of_tables.table2_pairs],
    "table3": [of_tables.table3],
    "text_values": [of_text.least_squares, of_text.means],
}
"""Printed numbers by file → what makes the claims on them."""


def judged(published, file) -> dict[str, Claim]:
    """The claims on the computed numbers of a file, by id."""
    routes = exact(), as_published(), from_print(published, CASE)
    sources = Sources(published, CASE, *routes, unrounded())
    claims = [claim for part in PARTS[file] for claim in part(sources)]
    return {claim.id: claim for claim in claims if claim.kind == "computed"}


@pytest.fixture(scope="module")
def verdicts():
    """A line per mutant of a computed number: id, step, verdict before and after, by how many ranks it is worse."""
    lines = []
    for file in PARTS:
        frame, before = getattr(PRINT, file), judged(PRINT, file)
        columns = ["printed"] if "printed" in frame else frame.columns.drop("Y_m", errors="ignore")
        for line, column, step in itertools.product(frame.index, columns, (+1, -1)):
            if not Printed(frame[column][line]).is_number:
                continue
            changed = frame.copy()
            changed.loc[line, column] = Printed(frame[column][line]).moved(step)
            after = judged(replace(PRINT, **{file: changed}), file)
            for name, claim in after.items():
                if claim.printed != before[name].printed:
                    was, now = verdict(before[name]).name, verdict(claim).name
                    lines.append((name, step, was, now, RANKS.index(now) - RANKS.index(was)))
    return pd.DataFrame(lines, columns=["id", "step", "was", "now", "worse"])


def test_all_computed_numbers_are_mutated_both_ways(verdicts):
    routes = exact(), as_published(), unrounded()
    claims = claims_table(PRINT, CASE, *routes).set_index("id")["kind"]
    computed = set(claims.index[claims == "computed"])
    assert set(verdicts["id"]) == computed
    assert len(verdicts) == 2 * len(computed)


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
