"""A small form of the blind set (`trials/blind`) against its aims: some sets by day, more by night."""

from __future__ import annotations

import pandas as pd

from blind import score

# The first thirteen, and those in which errors have been found: 14 (nothing slips), 31, 33, 149 (starred, though
# sound), 51, 59, 75, 132 (missed waveforms; 59 has several slips per half cycle), 198 (F_k 53 % off: K_z/k = 4).
SMALL = (*range(13), 14, 31, 33, 51, 59, 75, 132, 149, 198)


def judged(sets):
    return score.judged(pd.DataFrame([row for index in sets for row in score.outcome(index)]))


def faults(rows):
    return {name: which for name, (which, _) in score.faults(rows).items() if which}


def test_some_blind_sets_are_free_of_faults():
    assert faults(judged((14, 33, 198))) == {}


def test_the_small_blind_set_is_free_of_faults_and_its_intervals_hold_the_truth():
    small = judged(SMALL)
    assert faults(small) == {}
    slips = small[small["kind"] != "nothing slips"]
    held = (slips["low"] <= slips["true"]) & (slips["true"] <= slips["high"])
    for approach in score.HELD:
        for symbol in ("F_k", "c", "K_z"):
            if (approach, symbol) == ("direct", "K_z"):
                continue  # the balance has none
            own = held[(slips["approach"] == approach) & (slips["symbol"] == symbol)]
            assert len(own) == len(SMALL) - 1
            # of 21 intervals of 95 %, fewer than 17 hold the truth in one case of 300
            assert own.sum() >= 17, (approach, symbol)
