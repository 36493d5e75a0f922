"""The one search, on wells of known depth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from dampbalance.fit.fit import Fit
from dampbalance.fit.multistart import multistart
from dampbalance.fit.parameters import Parameter, Parameters

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
