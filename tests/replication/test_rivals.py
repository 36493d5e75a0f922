"""The recorded rivals are those that the simulations give, and stand for no other case."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

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
    for name in ("scheme_table", "trial_table"):
        monkeypatch.setattr(rivals, name, lambda *simulated: simulated)

    def served(frame, case=CASE):
        return rivals.rivals(PUBLISHED, case, "omega1", Features.from_frame(frame))

    own, other = unrounded(), replace(CASE, oscillator=replace(CASE.oscillator, c=90.001))
    for table, recorded in zip(served(own), RECORDED, strict=True):
        pd.testing.assert_frame_equal(table, recorded)
    one = 1e-8 * (own.index == 2)
    for frame in (own.head(4), *(own.assign(**{n: own[n] * (1.0 + one)}) for n in ("a_m", "W_J"))):
        assert served(frame) == ((CASE, "omega1"),) * 2
    assert served(own, other) == ((other, "omega1"),) * 2
