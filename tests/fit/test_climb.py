"""The climb on sums of squares whose minimum is known: limits, kinks, and where it ends; and the one search, on wells
of known depth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from dampbalance.fit.climb import climb
from dampbalance.fit.fit import Fit
from dampbalance.fit.multistart import multistart
from dampbalance.fit.parameters import Parameter, Parameters

H = np.array([[4.0, 1.0], [1.0, 2.0]])  # of a parabola
J = np.linalg.cholesky(H).T


def start_at(values, low=-math.inf, high=math.inf, free=True, scale=1.0):
    """A start with limits, each given for all parameters or one by one."""
    columns = (np.broadcast_to(of, len(values)).tolist() for of in (low, high, free, scale))
    rows = zip(map(float, values), *columns, strict=True)
    return Parameters.of(Parameter(f"p{i}", *row) for i, row in enumerate(rows))


def products_of(read):
    """The products of derivatives and residuals, as `climb` takes them, of a function that gives both or None."""

    def evaluate(p, out):
        here = read(p)
        if here is not None:
            both = np.column_stack([here[1], here[0]])
            out[:] = both.T @ both
        return here is not None

    return evaluate


def parabola(best, seen=None):
    """Residuals of ½ (p − best)ᵀ H (p − best); the points where it was asked for go to `seen`."""

    def read(p):
        if seen is not None:
            seen.append(p.copy())
        return J @ (p - best), J

    return products_of(read)


@pytest.mark.parametrize(
    ("best", "start", "lower", "upper", "free", "expected"),
    [
        ((3.0, -2.0), (1.0, 1.0), -math.inf, math.inf, True, (3.0, -2.0)),
        ((1.0, 5.0), (1.0, 1.0), -math.inf, math.inf, True, (1.0, 5.0)),  # one is right already
        # with p₀ at 2 the other unknown follows: H₁₁ (p₁ − 5) = −H₁₀ (2 − best₀)
        ((1.0, 5.0), (4.0, 0.0), 2.0, math.inf, True, (2.0, 4.5)),
        # a start below the limit begins at it, and one that is held there is let go again
        ((3.0, 5.0), (0.0, 0.0), 2.0, math.inf, True, (3.0, 5.0)),
        ((3.0, 5.0), (1.0, 1.0), -math.inf, 2.0, True, (2.0, 5.5)),
        # one that is not free keeps its value beyond its limits
        ((1.0, 5.0), (0.0, 1.0), 2.0, math.inf, False, (0.0, 5.5)),
    ],
    ids=["both", "one", "lower", "released", "upper", "held"],
)
def test_it_finds_the_least_value_of_a_parabola_within_limits(
    best, start, lower, upper, free, expected
):
    start = start_at(start, (lower, -math.inf), (upper, math.inf), (free, True))
    end = climb(parabola(np.array(best)), start)
    # a full step gains less than 5e-8: within 3e-4 of a standard error, of which the larger is 0.8
    assert end.point == pytest.approx(expected, abs=3e-4)


@pytest.mark.parametrize(("least", "lowest"), [(1e-6, 0.2), (0.0, 0.0)])
def test_a_positive_unknown_falls_to_a_fifth_in_a_step_and_one_that_may_be_zero_at_once(
    least, lowest
):
    seen: list[np.ndarray] = []
    start = start_at((1.0, 12.0), (least, -math.inf), scale=1e-9)
    climb(parabola(np.array([-50.0, 0.0]), seen), start)
    assert seen[1][0] == pytest.approx(lowest, abs=1e-12)


def test_it_gives_chi_square_the_products_and_what_a_further_step_promises():
    best, start = np.array([3.0, -2.0]), start_at(np.zeros(2))
    end = climb(parabola(best), start, most=1)
    assert end.chi_square == pytest.approx(best @ H @ best)
    assert end.products[:-1, :-1] == pytest.approx(H)
    assert end.products[:-1, -1] == pytest.approx(-H @ best)
    # of a parabola a full step gains all that there is
    assert end.promise == pytest.approx(0.5 * best @ H @ best)
    assert climb(parabola(best), start).promise < 5e-8


def test_columns_that_hardly_differ_are_told_apart():
    columns, best = np.array([[1.0, 1.0], [1.0, 1.001], [1.0, 0.999]]), np.array([0.5, 2.0])
    end = climb(products_of(lambda p: (columns @ (p - best), columns)), start_at(np.zeros(2)))
    # standard errors, by the columns' difference of 1e-3: 700
    assert end.point == pytest.approx(best, abs=3e-4 * 700.0)


def test_a_climb_ends_where_no_step_helps_and_after_so_many_evaluations():
    """|p| + ½, with a gradient that promises a way down on either side of the kink at 0."""
    made = []

    def read(p):
        made.append(p[0])
        towards = 0.2 if p[0] <= 0.0 else -0.2
        rest = math.sqrt(1.0 + 2.0 * abs(p[0]) - towards**2)
        return np.array([-towards, rest]), np.array([[1.0], [0.0]])

    kink = products_of(read)
    assert climb(kink, start_at(np.array([0.0]))).point[0] == 0.0
    assert len(made) < 30
    # from afar: the best point on the way, before the last of the evaluations
    made.clear()
    end = climb(kink, start_at(np.array([9.0])), most=4)
    assert end.evaluations == len(made) == 4
    assert end.point[0] in made


def test_places_where_the_model_does_not_apply_are_stepped_back_from():
    inner = parabola(np.array([3.0, -2.0]))

    def evaluate(p, out):
        return p[0] < 3.2 and p[1] > -2.5 and inner(p, out)

    end = climb(evaluate, start_at(np.array([-9.0, 3.0])))
    assert end.point == pytest.approx([3.0, -2.0], abs=1e-4)
    assert climb(evaluate, start_at(np.array([4.0, 0.0]))) is None


# χ² where a softened climb in a well ends → where it ends once refined: the best is not the nearest at first
WELLS = ((900, 800), (500, 450), (510, 440), (510.1, 440), (520, 300), (530, 200))
OFF = 0.2  # by which a softened well lies off


@dataclass(frozen=True)
class Wells:
    """Parabolas along x, one about each whole number; softened, all are as deep, and hopeless."""

    made: list[float]
    softening: float = 0.0
    samples: int = 1

    def products(self, values, free, trail, out):
        trail.left -= 1.0
        self.made.append(self.softening)
        first, depth = WELLS[round(values[0]) % len(WELLS)]
        off, part = values[0] - round(values[0]), (first - depth) / OFF**2
        if self.softening:
            off, depth, part = off - OFF, 100.0, 1.0
        out[:] = [[part, part * off], [part * off, depth + part * off**2]]
        return True

    def thinned(self):
        return self

    def softened(self, part):
        return replace(self, softening=part)

    def fit(self, end):
        return Fit(end.parameters, np.eye(1), end.chi_square, 1.0, self, (), end.evaluations)


STARTS = [Parameters.of([Parameter("x", float(i))]) for i in range(len(WELLS))]


def searched(starts=STARTS, enough=10.0, **options):
    """What a search finds, and the evaluations that it made."""
    made = []
    options = {"softening": (1e-2,), "hopeless": 4.0, **options}
    return multistart(
        Wells(made), starts, enough=lambda end: end.chi_square < enough, **options
    ), made


def test_of_climbs_that_end_far_away_the_three_nearest_are_refined():
    fits, made = searched(refined=3)
    assert fits[0].chi_square == pytest.approx(300.0)  # of two that end alike at first one is taken
    assert fits[0].evaluations == len(made)


def test_unless_asked_none_that_is_hopeless_is_refined():
    fits, made = searched()
    assert fits[0].chi_square == pytest.approx(500.0, rel=1e-3)
    assert made.count(0.0) == len(WELLS)
    # not softened to its end, all are refined
    assert searched(hopeless=math.inf)[0][0].chi_square == pytest.approx(200.0)


def test_a_search_ends_with_its_budget_and_with_what_is_enough():
    fits, made = searched(budget=2.0)
    assert [one.chi_square for one in fits] == pytest.approx([900.0], rel=1e-3)
    assert len(made) <= 8
    assert len(searched(enough=1e3, softening=())[1]) <= 3


def test_what_all_agree_in_is_one_minimum():
    fits, _ = searched([STARTS[5], STARTS[5].moved(x=4.9)], hopeless=math.inf)
    assert len(fits) == 1
