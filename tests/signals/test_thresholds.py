"""The table of thresholds: every probability that decides, and the budget of false alarms that they share."""

from __future__ import annotations

import math
import re

import pytest
from scipy import special

from dampbalance.signals import thresholds
from folders import ROOT

TESTS = {
    "NEVER": 1000,  # harmonics, cycles and channels of ten records
    "P_DRIFT": 20,  # base and response of ten records
    "P_OF_THE_MODEL": 7,  # forced records, the residual of decays, half cycles, four steps that join decays
    "P_SHOWN": 4,  # slip, mass, F_k and c of the balance
    "P_STEP_BACK": 0,
}
"""Number of times that each is asked, with the power to cast a doubt, in a usual set of records."""


def test_all_tests_together_keep_to_the_budget():
    shares = [getattr(thresholds, name) * times for name, times in TESTS.items()]
    assert 0.0 < math.fsum(shares) <= 0.05


def test_every_probability_has_a_share_and_a_reason():
    text = (ROOT / "src/dampbalance/signals/thresholds.py").read_text(encoding="utf-8")
    named = re.findall(r'^((?:P_\w+|NEVER)) = [\d.e-]+\n"""\S', text, re.MULTILINE)
    assert sorted(named) == sorted(TESTS)


def test_five_standard_errors_are_as_rare_as_the_table_says():
    assert special.ndtr(-5.0) == pytest.approx(thresholds.NEVER, rel=0.02)
    assert abs(thresholds.SIGNIFICANT - 5.0) < 0.01
    assert special.chdtrc(1, 16.0) == pytest.approx(thresholds.P_SHOWN, rel=0.02)
    assert abs(thresholds.SHOWS - 16.0) < 0.05
