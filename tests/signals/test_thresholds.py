"""The table of thresholds: every probability that decides, and the budget of false alarms that they share."""

from __future__ import annotations

import math

from scipy import special

from dampbalance.signals import thresholds

TESTS = {
    "NEVER": 1000,  # harmonics, cycles and channels of ten records
    "P_DRIFT": 20,  # base and response of ten records
    "P_OF_THE_MODEL": 7,  # forced records, the residual of decays, half cycles, four steps that join decays
    "P_SHOWN": 4,  # slip, mass, F_k and c of the balance
    "P_STEP_BACK": 0,
}
"""Number of times that each is asked, with the power to cast a doubt, in a usual set of records."""


def test_all_tests_together_keep_to_the_budget():
    assert {name for name in vars(thresholds) if name.startswith(("P_", "NEVER"))} == {*TESTS}
    shares = [getattr(thresholds, name) * times for name, times in TESTS.items()]
    assert 0.0 < math.fsum(shares) <= 0.05


def test_standard_errors_are_as_rare_as_the_table_says():
    assert abs(thresholds.SIGNIFICANT - 5.0) < 0.01
    assert abs(thresholds.CERTAIN - 4.0) < 0.01
    assert abs(special.ndtr(-5.0) / thresholds.NEVER - 1.0) < 0.02
    assert abs(special.chdtrc(1, 16.0) / thresholds.P_SHOWN - 1.0) < 0.02
    assert abs(math.exp(-thresholds.RARE_LINE) / thresholds.NEVER - 1.0) < 1e-12
