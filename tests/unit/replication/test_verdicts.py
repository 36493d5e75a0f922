"""Counts of verdicts, and ids of claims."""

from __future__ import annotations

import pandas as pd
import pytest

from dampbalance.replication.claim_verdicts import (
    VERDICTS,
    counts,
    of_cell,
    of_text,
    part_of,
    statistic,
)


def test_counts_per_part_and_of_all():
    claims = pd.DataFrame(
        [
            ("text.a", "computed", "reading"),
            ("table1.X.1", "computed", "differs"),
            ("text.b", "computed", "reading"),
            ("text.c", "statement", "reconstructed"),
            ("text.d", "statement", "differs"),
            ("table1.Y.1", "given", "reproduced"),
        ],
        columns=["id", "kind", "verdict"],
    )
    found = counts(claims)
    assert [(count.part, count.computed) for count in found] == [
        ("Text", 2),
        ("Table 1", 1),
        ("all", 3),
    ]
    assert list(found[0].of_verdict) == list(VERDICTS)
    assert found[-1].of_verdict["reading"] == 2
    assert found[-1].of_verdict["reconstructed"] == 0  # a statement is not a computed number
    assert (found[0].statements, found[0].statements_held) == (2, 1)
    assert (found[1].given, found[1].given_held) == (1, 1)


def test_ids():
    assert of_cell("table2", "F_k", "1-5") == "table2.F_k.1-5"
    assert of_cell("table3", "c", "1-2", "V_s") == "table3.V_s.c.1-2"
    assert of_text(statistic("c", "X_s", "least_squares")) == "text.c_Xs_ls"
    assert "table2.W.3".startswith(of_cell("table2", "W"))


def test_an_id_of_no_part_is_refused():
    with pytest.raises(KeyError, match=r"'table9.X.1' belongs to no part of the paper"):
        part_of("table9.X.1")
