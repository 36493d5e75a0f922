"""The recorded rivals are those that the simulations give, and stand for no other case."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd
import pytest

from dampbalance.features import Features
from dampbalance.project.files import read_csv
from dampbalance.replication.authors_route import scheme_table, trial_table
from dampbalance.replication.claims import rivals
from folders import PUBLISHED
from replication.routes import CASE, unrounded

RECORDED = [read_csv(PUBLISHED / name) for name in rivals.FILES]


def test_what_is_recorded_is_what_is_simulated():
    for recorded, table in zip(RECORDED, (scheme_table, trial_table), strict=True):
        pd.testing.assert_frame_equal(recorded, table(CASE, "omega1"), rtol=1e-11, atol=0.0)


def test_the_records_serve_their_own_case_and_no_other(monkeypatch):
    asked = []
    for name in ("scheme_table", "trial_table"):
        monkeypatch.setattr(rivals, name, lambda case, frequency: asked.append(case))
    for got, recorded in zip(
        rivals.rivals(PUBLISHED, CASE, "omega1", Features.from_frame(unrounded())),
        RECORDED,
        strict=True,
    ):
        pd.testing.assert_frame_equal(got, recorded)
    assert asked == []
    other = replace(CASE, oscillator=replace(CASE.oscillator, c=90.001))
    rivals.rivals(PUBLISHED, other, "omega1", Features.from_frame(unrounded(other.oscillator)))
    rivals.rivals(PUBLISHED, other, "omega1", Features.from_frame(unrounded().head(4)))
    assert asked == [other] * 4


@pytest.mark.parametrize("column", ["a_m", "W_J"])
def test_a_digit_that_differs_is_seen(monkeypatch, column):
    monkeypatch.setattr(rivals, "scheme_table", lambda *_: None)
    monkeypatch.setattr(rivals, "trial_table", lambda *_: None)
    changed = unrounded().copy()
    changed.loc[2, column] *= 1.0 + 1e-8
    assert rivals.rivals(PUBLISHED, CASE, "omega1", Features.from_frame(changed)) == (None, None)
