"""The climb on functions whose minimum is known: limits, kinks, and when it gives up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.reading.climb import Evaluation, NoConvergence, NoStart, climb

FREE = np.full(2, -math.inf)
ONES = np.ones(2)
H = np.array([[4.0, 1.0], [1.0, 2.0]])  # of a parabola


def parabola(best, seen=None):
    """½ (p − best)ᵀ H (p − best); the points where it was asked for go to `seen`."""

    def evaluate(p):
        if seen is not None:
            seen.append(p.copy())
        d = p - best
        return Evaluation(0.5 * float(d @ H @ d), H, -H @ d)

    return evaluate


@pytest.mark.parametrize("best", [(3.0, -2.0), (1.0, 5.0), (-4.0, 1.0), (1.0, 1.0)])
def test_it_finds_the_least_value_of_a_parabola(best):
    # one unknown may be right from the start
    found = climb(parabola(np.array(best)), np.ones(2), FREE, ONES)
    # a full step gains less than 1e-8: within 1e-4 of a standard error, of which the larger is 0.8
    assert found.point == pytest.approx(best, abs=1e-4)
    assert not found.active.any()


def test_a_limit_holds_and_is_reported():
    lower = np.array([2.0, -math.inf])
    found = climb(parabola(np.array([1.0, 5.0])), np.array([4.0, 0.0]), lower, ONES)
    # with p₀ at 2 the other unknown follows: H₁₁ (p₁ − 5) = −H₁₀ (2 − 1)
    assert found.point == pytest.approx([2.0, 4.5], abs=1e-4)
    assert found.active.tolist() == [True, False]
    # a start below the limit begins at it, and one that is held there is let go again
    found = climb(parabola(np.array([3.0, 5.0])), np.array([0.0, 0.0]), lower, ONES)
    assert found.point == pytest.approx([3.0, 5.0], abs=1e-4)


def test_a_positive_unknown_falls_to_a_fifth_in_a_step_and_one_that_may_be_zero_at_once():
    for least, lowest in ((1e-6, 0.2), (0.0, 0.0)):
        seen: list[np.ndarray] = []
        lower = np.array([least, -math.inf])
        climb(parabola(np.array([-50.0, 0.0]), seen), np.array([1.0, 12.0]), lower, 1e-9 * ONES)
        assert seen[1][0] == pytest.approx(lowest, abs=1e-12)


def test_residuals_give_value_information_and_gradient():
    J, r = np.array([[1.0, 2.0], [0.0, 3.0], [1.0, 1.0]]), np.array([1.0, -2.0, 0.5])
    made = Evaluation.of_residuals(r, J)
    assert made.value == 0.5 * (1.0 + 4.0 + 0.25)
    assert made.information == pytest.approx(J.T @ J)
    assert made.gradient == pytest.approx(-J.T @ r)


def test_half_a_sum_of_squares_is_climbed_by_its_residuals():
    J, best = np.array([[1.0, 1.0], [1.0, 1.001], [1.0, 0.999]]), np.array([0.5, 2.0])
    found = climb(lambda p: Evaluation.of_residuals(J @ (p - best), J), np.zeros(2), FREE, ONES)
    # standard errors, by the columns' difference of 1e-3: 700
    assert found.point == pytest.approx(best, abs=0.07)


def test_a_kink_that_promises_little_is_an_end():
    """|p| beside a parabola that promises g²/2I: 0.0045 is a tenth of a standard error, 0.02 is not."""
    for slope, ends in ((0.095, True), (0.2, False)):

        def evaluate(p, slope=slope):
            towards = slope if p[0] <= 0.0 else -slope
            return Evaluation(abs(float(p[0])), np.eye(1), np.array([towards]))

        start = np.array([0.0])
        if ends:
            assert climb(evaluate, start, -np.inf * np.ones(1), np.ones(1)).point[0] == 0.0
        else:
            with pytest.raises(NoConvergence, match="did not converge") as stuck:
                climb(evaluate, start, -np.inf * np.ones(1), np.ones(1))
            assert stuck.value.best.point[0] == 0.0


def test_places_where_the_model_does_not_apply_are_stepped_back_from():
    inner = parabola(np.array([3.0, -2.0]))

    def evaluate(p):
        return inner(p) if p[0] < 3.2 and p[1] > -2.5 else None

    found = climb(evaluate, np.array([-9.0, 3.0]), FREE, ONES)
    assert found.point == pytest.approx([3.0, -2.0], abs=1e-4)
    with pytest.raises(NoStart, match="does not apply where the climb starts"):
        climb(evaluate, np.array([4.0, 0.0]), FREE, ONES)


def test_an_upper_limit_holds_and_is_reported():
    found = climb(parabola(np.array([3.0, 5.0])), np.ones(2), FREE, ONES, np.array([2.0, math.inf]))
    # along p_0 = 2 the least value is where H_10 (2 − 3) + H_11 (p_1 − 5) = 0
    assert found.point == pytest.approx((2.0, 5.5), abs=1e-4)
    assert found.active.tolist() == [True, False]
