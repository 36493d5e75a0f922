"""The harmonics that an oscillator is fitted to, the start of that fit, and whether there is anything to fit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import nnls

from dampbalance.motion.regime import Regime
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.lines import (
    CHANCE,
    CLEAR,
    Lines,
    _not_negative,
    improbable,
    linear_misfit,
    starts,
)
from paper_case import FREQUENCIES_HZ, LEVELS, NEAR, PAPER, orbits_at
from signals.harmonics import lines_of

LINEAR = replace(PAPER, F_k=0.0)


def of_record(noise: float, *, start: float = 0.0, seed: int = 1, Y: float = 0.008) -> Lines:
    (orbit,) = orbits_at(NEAR, (Y,))
    measurement = measured_orbit(
        orbit, rate_hz=2000.0, cycles=40.0, noise=noise, seed=seed, start=start
    )
    return Lines.of(condition(measurement, PAPER.k))


def test_they_are_those_of_the_motion_wherever_the_record_begins():
    exact = orbits_at(NEAR, (0.008,))[0].harmonics(20)
    for start in (0.0, 0.0317, 0.15):
        lines = of_record(0.0, start=start)
        assert lines.n.tolist() == list(range(1, 2 * lines.n.size, 2))
        # phases count from the peak of the base; rounding, and the aliases of the harmonics beyond
        assert lines.x == pytest.approx(exact[: lines.n.size], abs=2e-6 * abs(exact[0]))
        assert abs(lines.Y / 0.008 - 1.0) < 1e-9
        assert lines.omega == pytest.approx(2.0 * math.pi * NEAR, rel=1e-9)


def test_their_errors_are_those_of_the_scatter():
    (orbit,) = orbits_at(NEAR, (0.008,))
    read = [of_record(0.01, seed=seed) for seed in range(40)]
    count = min(lines.n.size for lines in read)
    x = np.array([lines.x[:count] for lines in read]) - orbit.harmonics(count)
    # the phase of the base moves harmonic n by n of its errors: taken off to first order by that of the fundamental
    errors = np.sqrt(np.mean([lines.x_error[:count] ** 2 for lines in read], axis=0))
    beyond = slice(2, None)  # small ones, which that phase does not move
    scatter = np.sqrt(np.mean(np.abs(x) ** 2 / 2.0, axis=0))
    # 40 draws of two parts know a scatter to 8 %
    assert scatter[beyond] == pytest.approx(errors[beyond], rel=0.3)
    assert read[0].rows == pytest.approx(40, abs=2)


def test_what_stands_out_of_the_noise_is_clear_and_the_fundamental_always_is():
    x = np.array([0.5, CLEAR * 1.01, CLEAR * 0.99, 30.0])
    lines = Lines(1.0, 1.0, 0.1, np.arange(1, 8, 2), x.astype(complex), np.ones(4), 10)
    assert lines.clear.tolist() == [True, True, False, True]


# --- where the fit starts --------------------------------------------------------------------------


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


# --- whether there is anything to fit --------------------------------------------------------------


@pytest.mark.parametrize("hertz", [(4.92, 4.92, 4.92), (3.5, 4.92, 11.1)], ids=["one", "three"])
def test_a_linear_oscillator_is_one_whatever_it_weighs(hertz):
    orbits = [orbits_at(hz, (Y,), LINEAR)[0] for hz, Y in zip(hertz, LEVELS, strict=False)]
    exact = [lines_of(orbit, 1e-6) for orbit in orbits]
    chi_square, freedom = linear_misfit(exact, PAPER.k)
    assert chi_square < 1e-6
    # c, and one stiffness of the part in phase where there is one frequency, two where there are more
    unknowns = 2 if len(set(hertz)) == 1 else 3
    assert freedom == 3 * 2 * 12 - unknowns
    other = [replace(exact[0], x=1.01 * exact[0].x), *exact[1:]]
    assert linear_misfit(other, PAPER.k)[0] > 100.0


def test_its_misfit_is_that_of_noise():
    rng = np.random.default_rng(1)
    orbits = [orbits_at(hz, (0.008,), LINEAR)[0] for hz in (3.5, 4.92, 6.0, 11.1)]
    drawn = [linear_misfit([lines_of(o, 2e-5, rng) for o in orbits], PAPER.k) for _ in range(200)]
    misfits = np.array([chi_square / freedom for chi_square, freedom in drawn])
    # χ²: a scatter of √(2/f); 200 draws
    assert misfits.mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(2.0 / drawn[0][1] / 200))


def test_a_contact_that_only_sticks_is_linear_too_and_one_that_slips_is_not():
    stuck = orbits_at(NEAR, (0.0002, 0.0003))
    assert {orbit.regime for orbit in stuck} == {Regime.NO_SLIP}
    assert linear_misfit([lines_of(orbit, 1e-8) for orbit in stuck], PAPER.k)[0] < 1e-6
    slips = [lines_of(orbit, 1e-6) for orbit in orbits_at()]
    assert improbable(*linear_misfit(slips, PAPER.k), slips)


@pytest.mark.parametrize("freedom", [2, 40])
@pytest.mark.parametrize("rows", [8, 60])
def test_a_misfit_is_improbable_where_an_F_distribution_says_so(freedom, rows):
    (orbit,) = orbits_at(NEAR, (0.008,))
    lines = [lines_of(orbit, 1e-6, rows=rows)] * 2
    # six degrees of freedom of the errors a row: that of a harmonic has two, and its neighbours share it
    border = freedom * stats.f.isf(CHANCE, freedom, 2 * 6 * (rows - 1))
    assert improbable(1.001 * border, freedom, lines)
    assert not improbable(0.999 * border, freedom, lines)
    assert not improbable(1e9, 0, lines)
