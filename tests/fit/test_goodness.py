"""χ² of records about a linear oscillator, and whether noise makes one as large."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from dampbalance.fit.goodness import improbable, linear_fit
from dampbalance.motion.regime import Regime
from dampbalance.signals.thresholds import P_OF_THE_MODEL
from paper_case import LEVELS, NEAR, PAPER, orbits_at
from signals.harmonics import lines_of

LINEAR = replace(PAPER, F_k=0.0)


@pytest.mark.parametrize("hertz", [(4.92, 4.92, 4.92), (3.5, 4.92, 11.1)], ids=["one", "three"])
def test_a_linear_oscillator_is_one_whatever_it_weighs(hertz):
    orbits = [orbits_at(hz, (Y,), LINEAR)[0] for hz, Y in zip(hertz, LEVELS, strict=False)]
    exact = [lines_of(orbit, 1e-6) for orbit in orbits]
    fit = linear_fit(exact, PAPER.k)
    assert fit.chi_square < 1e-6
    # c, and one stiffness of the part in phase where there is one frequency, two where there are more
    unknowns = 2 if len(set(hertz)) == 1 else 3
    assert fit.freedom == 3 * 2 * 12 - unknowns
    other = [replace(exact[0], x=1.01 * exact[0].x), *exact[1:]]
    assert linear_fit(other, PAPER.k).chi_square > 100.0


def test_a_contact_that_only_sticks_is_linear_too_and_one_that_slips_is_not():
    stuck = orbits_at(NEAR, (0.0002, 0.0003))
    assert {orbit.regime for orbit in stuck} == {Regime.NO_SLIP}
    assert linear_fit([lines_of(orbit, 1e-8) for orbit in stuck], PAPER.k).chi_square < 1e-6
    slips = [lines_of(orbit, 1e-6) for orbit in orbits_at()]
    fit = linear_fit(slips, PAPER.k)
    assert improbable(fit.chi_square, fit.freedom, slips)


def test_a_contact_that_only_sticks_has_the_stiffness_it_has():
    rng = np.random.default_rng(5)
    stuck = [lines_of(o, 1e-9, rng) for o in orbits_at(NEAR, (0.0002, 0.0003))]
    loose = [lines_of(o, 1e-6, rng) for o in orbits_at(NEAR, LEVELS, LINEAR)]
    # one frequency tells a stiffness from an inertia where the mass is known
    assert linear_fit(stuck, PAPER.k).sticks is None
    of_stuck, of_loose = (linear_fit(of, PAPER.k, m=PAPER.m) for of in (stuck, loose))
    assert of_stuck.sticks is True
    assert abs(of_stuck.contact - PAPER.K_z) < 4.0 * of_stuck.contact_error < 0.1 * PAPER.K_z
    assert of_loose.sticks is False
    assert abs(of_loose.contact) < 4.0 * of_loose.contact_error < 0.01 * PAPER.k
    # of a mass that is 10 % off, K is off by ω² times that
    wrong = linear_fit(loose, PAPER.k, m=0.9 * PAPER.m, m_error=0.1 * PAPER.m)
    omega = 2.0 * math.pi * NEAR
    assert wrong.contact == pytest.approx(-0.1 * PAPER.m * omega**2, rel=0.01)
    assert wrong.contact_error == pytest.approx(-wrong.contact, rel=0.01)


@pytest.mark.parametrize(("freedom", "rows"), [(2, 8), (40, 60)])
def test_a_misfit_is_improbable_where_an_F_distribution_says_so(freedom, rows):
    (orbit,) = orbits_at(NEAR, (0.008,))
    lines = [lines_of(orbit, 1e-6, rows=rows)] * 2
    # six degrees of freedom of the errors a row: that of a harmonic has two, and its neighbours share it
    border = freedom * stats.f.isf(P_OF_THE_MODEL, freedom, 2 * 6 * (rows - 1))
    assert improbable(1.001 * border, freedom, lines)
    assert not improbable(0.999 * border, freedom, lines)
    assert not improbable(1e9, 0, lines)
