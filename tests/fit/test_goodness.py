"""χ² of records about a linear oscillator, and whether noise makes one as large."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from dampbalance.fit.goodness import improbable, linear_misfit
from dampbalance.motion.regime import Regime
from dampbalance.signals.thresholds import P_OF_THE_MODEL
from paper_case import LEVELS, NEAR, PAPER, orbits_at
from signals.harmonics import lines_of

LINEAR = replace(PAPER, F_k=0.0)


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
    border = freedom * stats.f.isf(P_OF_THE_MODEL, freedom, 2 * 6 * (rows - 1))
    assert improbable(1.001 * border, freedom, lines)
    assert not improbable(0.999 * border, freedom, lines)
    assert not improbable(1e9, 0, lines)
