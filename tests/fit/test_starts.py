"""The oscillators that a fit starts from: they balance the work, and the first is near the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls

from dampbalance.fit.starts import _not_negative, starts
from paper_case import FREQUENCIES_HZ, NEAR, PAPER, orbits_at
from signals.harmonics import lines_of


@pytest.mark.parametrize("hz", FREQUENCIES_HZ.values())
def test_the_first_start_is_near_the_oscillator_and_slips(hz):
    lines = [lines_of(orbit, 1e-6) for orbit in orbits_at(hz)]
    first = starts(lines, PAPER.k)[0]
    true = np.array([PAPER.F_k, PAPER.c, PAPER.K_z, PAPER.m])
    # the grid of stiffnesses has steps of 2.15; the others follow from the work and the part in phase
    assert np.abs(np.log(first / true))[[0, 1, 3]].max() < 0.1
    assert 0.4 < first[2] / PAPER.K_z < 2.5


def test_starts_balance_the_work_of_the_base():
    lines = [lines_of(orbit, 1e-6) for orbit in orbits_at(NEAR)]
    found = starts(lines, PAPER.k)
    assert np.all(found >= 0.0)
    F_k, c, K_z, _ = found[:20].T  # the closest
    X, b, W = np.array([(orbit.X, orbit.b, orbit.W) for orbit in orbits_at(NEAR)]).T
    lost = 4.0 * np.maximum(X[:, None] - F_k / K_z, 0.0) * F_k + b[:, None] * c
    # each takes as much energy from the records, all together, as went in, as nearly as least squares can
    assert lost.sum(axis=0) / W.sum() == pytest.approx(1.0, abs=2e-3)


def test_the_wide_search_starts_once_from_each_stiffness_with_masses_beyond_the_fundamental():
    lines = [lines_of(orbit, 1e-6) for orbit in orbits_at(NEAR, (0.008,))]
    few, many = (starts(lines, PAPER.k, wide=wide) for wide in (False, True))
    assert len(np.unique(many[:, 2])) == len(many) < len(few)
    # three decades of masses on the grid, each compared by its exact orbit
    of_fundamental = {round(np.log(mass), 6) for mass in few[:, 3]}
    assert any(round(np.log(mass), 6) not in of_fundamental for mass in many[:, 3])


def test_no_start_where_no_work_goes_in():
    (orbit,) = orbits_at(NEAR, (0.008,))
    lines = lines_of(orbit, 1e-6)
    assert starts([replace(lines, x=lines.x.conj())], PAPER.k).shape == (0, 4)


def test_neither_of_two_numbers_is_below_zero():
    rng = np.random.default_rng(3)
    signs = set()
    for _ in range(200):
        columns = rng.random((4, 2)) * [1.0, rng.choice([0.1, 1.0, 10.0])]
        expected, _ = nnls(columns, np.ones(4))
        found = np.concatenate(_not_negative(*columns.T))
        assert tuple(found) == pytest.approx(tuple(expected), rel=1e-9, abs=1e-12)
        signs.add(tuple(expected > 0.0))
    assert len(signs) == 3  # both, and each alone
