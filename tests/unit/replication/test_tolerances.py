"""Tolerances: each from elsewhere than the number it judges, and none that a shift of all levels widens."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.replication.claims.tolerances import (
    cycle_chosen,
    of_the_others,
    phase_read,
    propagated,
    time_read,
)
from dampbalance.replication.verdicts import PROPAGATED, READING, SCATTER
from paper.routes import CASE

OMEGA = 2.0 * math.pi * 4.92
PRINTED = ["1.001", "1.999", "3.003", "3.998", "5.002"]


def test_a_phase_is_read_to_a_tenth_of_a_millisecond():
    tolerance = phase_read(1.52, OMEGA)
    assert tolerance.verdict is READING
    assert tolerance.high - 1.52 == pytest.approx(OMEGA * 1e-4)
    assert "0.1 ms" in tolerance.reason


def test_a_time_is_cut_to_a_tenth_of_a_millisecond_a_step_in_from_either_end():
    tolerance = time_read(2.98e-3, 5e-6)
    assert (tolerance.low, tolerance.high) == pytest.approx((2.87e-3, 2.98e-3))
    assert tolerance.holds(2.9e-3)
    assert not tolerance.holds(3.0e-3)


def test_a_range_that_print_allows_is_rounded_like_print():
    (tolerance,) = propagated((1.2798, 1.2802), "1.280", "Table 3")
    assert tolerance.verdict is PROPAGATED
    assert tolerance.holds(1.280)
    assert tolerance.holds(1.2797)  # half a unit further
    assert not tolerance.holds(1.281)
    assert propagated(None, "1.280", "Table 3") == ()


def test_the_scatter_of_the_others_is_a_prediction_interval():
    """Levels 1 to 4 deviate by +1, −1, +3, −2 units: s = 2.217, t₀.₉₇₅ with 3 degrees of freedom 3.182, √1.25."""
    (tolerance,) = of_the_others([1.0, 2.0, 3.0, 4.0, 5.0], PRINTED, 4, relative=False)
    assert tolerance.verdict is SCATTER
    assert tolerance.high - 5.0 == pytest.approx(3.182 * 2.2174e-3 * math.sqrt(1.25), rel=1e-3)
    assert tolerance.low + tolerance.high == pytest.approx(10.0)


def test_a_number_does_not_widen_its_own_range():
    far = [*PRINTED[:4], "9.000"]
    ranges = [
        of_the_others([1.0, 2.0, 3.0, 4.0, 5.0], column, 4, relative=False)[0]
        for column in (PRINTED, far)
    ]
    assert ranges[0].high == ranges[1].high
    assert not ranges[1].holds(9.0)


def test_a_shift_of_all_levels_alike_is_not_scatter():
    """A computation 1 % off at every level: print lies far outside, however alike the deviations are."""
    computed = 1.01 * np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    for level in range(5):
        (tolerance,) = of_the_others(computed, PRINTED, level, relative=True)
        assert not tolerance.holds(float(PRINTED[level]))


def test_two_others_are_enough():
    """They deviate by +1 and −1 units: s = √2, t₀.₉₇₅ with one degree of freedom 12.706, √1.5."""
    (tolerance,) = of_the_others([1.0, 2.0, 3.0], PRINTED[:3], 2, relative=False)
    assert tolerance.high - 3.0 == pytest.approx(
        12.706 * math.sqrt(2.0) * 1e-3 * math.sqrt(1.5), rel=1e-4
    )


def test_no_scatter_of_one_other_level_or_of_none():
    assert of_the_others([1.0, 2.0], PRINTED[:2], 0, relative=True) == ()
    assert of_the_others([math.nan, 2.0, 3.0], PRINTED[:3], 0, relative=True) == ()


def test_the_choice_of_the_cycle_leaves_a_thirtieth_of_a_sample():
    """T/h = 40650.4065: five periods are 0.0325 of a step more than whole steps, and no fewer come closer."""
    (tolerance,) = cycle_chosen(0.024, 0.01174, OMEGA, CASE.numerics, "0.024000000")
    assert tolerance.verdict is PROPAGATED
    reach = 2.0 * 0.01174 * 5e-6 * 0.03252
    assert tolerance.high - 0.024 == pytest.approx(reach + 0.5e-9, rel=1e-3)
    assert "5 periods away" in tolerance.reason
    coarse = cycle_chosen(0.024, 0.01174, OMEGA, replace(CASE.numerics, cycles=6), "0.024000000")
    assert coarse[0].high > tolerance.high  # of few periods simulated none comes as close
    assert cycle_chosen(math.nan, 0.01, OMEGA, CASE.numerics, "0.024") == ()
