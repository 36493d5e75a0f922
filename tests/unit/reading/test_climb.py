"""The climb on sums of squares whose minimum is known: limits, kinks, and where it ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.reading.climb import Evaluation, climb

BOTH = np.arange(2)
FREE = np.full(2, -math.inf)
ONES = np.ones(2)
H = np.array([[4.0, 1.0], [1.0, 2.0]])  # of a parabola
J = np.linalg.cholesky(H).T


def parabola(best, seen=None):
    """Residuals of ½ (p − best)ᵀ H (p − best); the points where it was asked for go to `seen`."""

    def evaluate(p):
        if seen is not None:
            seen.append(p.copy())
        return Evaluation(J @ (p - best), J)

    return evaluate


@pytest.mark.parametrize("best", [(3.0, -2.0), (1.0, 5.0), (-4.0, 1.0), (1.0, 1.0)])
def test_it_finds_the_least_value_of_a_parabola(best):
    # one unknown may be right from the start
    end = climb(parabola(np.array(best)), np.ones(2), BOTH, FREE, ONES)
    # a full step gains less than 5e-8: within 3e-4 of a standard error, of which the larger is 0.8
    assert end.point == pytest.approx(best, abs=3e-4)


@pytest.mark.parametrize(
    ("best", "start", "lower", "upper", "expected"),
    [
        # with p₀ at 2 the other unknown follows: H₁₁ (p₁ − 5) = −H₁₀ (2 − best₀)
        ((1.0, 5.0), (4.0, 0.0), 2.0, math.inf, (2.0, 4.5)),
        # a start below the limit begins at it, and one that is held there is let go again
        ((3.0, 5.0), (0.0, 0.0), 2.0, math.inf, (3.0, 5.0)),
        ((3.0, 5.0), (1.0, 1.0), -math.inf, 2.0, (2.0, 5.5)),
    ],
    ids=["lower", "released", "upper"],
)
def test_limits_hold(best, start, lower, upper, expected):
    limits = np.array([lower, -math.inf]), ONES, np.array([upper, math.inf])
    end = climb(parabola(np.array(best)), np.array(start), BOTH, *limits)
    assert end.point == pytest.approx(expected, abs=1e-4)


def test_an_unknown_that_is_not_free_keeps_its_value_beyond_its_limits():
    start = np.array([0.0, 1.0])
    end = climb(parabola(np.array([1.0, 5.0])), start, BOTH[1:], np.array([2.0, -math.inf]), ONES)
    assert end.point[0] == 0.0
    # H₁₁ (p₁ − 5) = −H₁₀ (0 − 1)
    assert end.point[1] == pytest.approx(5.5, abs=1e-4)
    assert end.evaluation.jacobian.shape == (2, 2)
    assert start.tolist() == [0.0, 1.0]


def test_a_positive_unknown_falls_to_a_fifth_in_a_step_and_one_that_may_be_zero_at_once():
    for least, lowest in ((1e-6, 0.2), (0.0, 0.0)):
        seen: list[np.ndarray] = []
        lower, start = np.array([least, -math.inf]), np.array([1.0, 12.0])
        climb(parabola(np.array([-50.0, 0.0]), seen), start, BOTH, lower, 1e-9 * ONES)
        assert seen[1][0] == pytest.approx(lowest, abs=1e-12)


def test_residuals_give_value_and_gradient():
    J, r = np.array([[1.0, 2.0], [0.0, 3.0], [1.0, 1.0]]), np.array([1.0, -2.0, 0.5])
    here = Evaluation(r, J)
    assert here.value == 0.5 * (1.0 + 4.0 + 0.25)
    assert here.gradient == pytest.approx(-J.T @ r)
    assert here.lengths == pytest.approx(np.linalg.norm(J, axis=0))


def test_columns_that_hardly_differ_are_told_apart():
    J, best = np.array([[1.0, 1.0], [1.0, 1.001], [1.0, 0.999]]), np.array([0.5, 2.0])
    end = climb(lambda p: Evaluation(J @ (p - best), J), np.zeros(2), BOTH, FREE, ONES)
    # standard errors, by the columns' difference of 1e-3: 700
    assert end.point == pytest.approx(best, abs=3e-4 * 700.0)


def test_a_climb_ends_where_no_step_helps_and_after_so_many_evaluations():
    """|p| + ½, with a gradient that promises a way down on either side of the kink at 0."""
    made = []

    def evaluate(p):
        made.append(p[0])
        towards = 0.2 if p[0] <= 0.0 else -0.2
        rest = math.sqrt(1.0 + 2.0 * abs(p[0]) - towards**2)
        return Evaluation(np.array([-towards, rest]), np.array([[1.0], [0.0]]))

    ways = BOTH[:1], FREE[:1], ONES[:1]
    assert climb(evaluate, np.array([0.0]), *ways).point[0] == 0.0
    assert len(made) < 30
    # from afar: the best point on the way, before the last of the evaluations
    made.clear()
    end = climb(evaluate, np.array([9.0]), *ways, most=4)
    assert end.iterations == 4
    assert len(made) == 5
    assert end.point[0] in made[:-1]


def test_places_where_the_model_does_not_apply_are_stepped_back_from():
    inner = parabola(np.array([3.0, -2.0]))

    def evaluate(p):
        return inner(p) if p[0] < 3.2 and p[1] > -2.5 else None

    end = climb(evaluate, np.array([-9.0, 3.0]), BOTH, FREE, ONES)
    assert end.point == pytest.approx([3.0, -2.0], abs=1e-4)
    assert climb(evaluate, np.array([4.0, 0.0]), BOTH, FREE, ONES) is None


def test_it_says_what_a_further_step_promises():
    best, start = np.array([3.0, -2.0]), np.zeros(2)
    one = climb(parabola(best), start, BOTH, FREE, ONES, most=1)
    # of a parabola a full step gains all that there is
    assert one.promise == pytest.approx(0.5 * best @ H @ best)
    assert climb(parabola(best), start, BOTH, FREE, ONES).promise < 5e-8
