"""Tolerances: each from elsewhere than the number it judges, and none that a wrong rebuild widens."""

from __future__ import annotations

import math

import pytest

from dampbalance.replication.claim_verdicts import PROPAGATED, READING, UNEXPLAINED
from dampbalance.replication.claims.judging import (
    phase_read,
    propagated,
    simulated,
    velocity_read,
)
from dampbalance.replication.claims.published import Printed
from paper.routes import CASE

OMEGA = 2.0 * math.pi * 4.92


def verdict_of(tolerances, value):
    return next((t.verdict for t in tolerances if t.low <= value <= t.high), None)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("tolerances", "middle", "step", "words"),
    [
        (phase_read(Printed("1.522"), OMEGA), 1.522, OMEGA * 1e-4, "0.1 ms"),
        # the velocity of the first slipping sample, to half a mark
        (velocity_read(Printed("0.01330"), 2e-5), 0.01330 - 2e-5, 2.5e-5, "0.05 mm/s"),
    ],
    ids=["phase", "velocity"],
)
def test_what_was_read_lies_within_its_resolution(side, tolerances, middle, step, words):
    for off, verdict in ((0.99, READING), (1.01, UNEXPLAINED), (1.99, UNEXPLAINED), (2.01, None)):
        assert verdict_of(tolerances, middle + side * off * step) is verdict
    assert words in tolerances[0].reason
    assert "nothing says why" in tolerances[1].reason


def test_a_range_that_print_leaves_is_one_of_the_rebuilt_number_itself():
    (tolerance,) = propagated((1.2798, 1.2802), Printed("1.280"))
    assert tolerance.verdict is PROPAGATED
    # not 1.2797, though print would round it to the same digits
    assert (tolerance.low, tolerance.high) == (1.2798, 1.2802)
    assert propagated(None, Printed("1.280")) == ()


@pytest.mark.parametrize(
    ("printed", "reach"),
    [
        ("0.81655453", 10e-8),  # ten units; a step in a period is two hundred times as much
        # a step in a period; ten units are five times as much
        ("0.00072729", 0.00072729 * 4.92 * 5e-6),
    ],
)
def test_what_a_simulation_gives_is_near_within_ten_units_and_a_step_in_a_period(printed, reach):
    (tolerance,) = simulated(Printed(printed), CASE)
    assert tolerance.verdict is UNEXPLAINED
    ends = tolerance.low - float(printed), tolerance.high - float(printed)
    assert ends == pytest.approx((-reach, reach), rel=1e-3)
