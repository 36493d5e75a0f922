"""Where a fit of the oscillator starts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import nnls

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.motion.regime import Regime
from dampbalance.reading import fitting
from dampbalance.reading import lines as lines_module
from dampbalance.reading.lines import Lines, _not_negative, starts
from paper_case import PAPER


def lines_of(osc, hz, levels, error=1e-8):
    """The harmonics of exact orbits, with an error stated, m."""
    lines, regimes = [], []
    for Y in levels:
        omega = 2.0 * math.pi * hz
        orbit = steady_orbit(osc, BaseMotion(Y, omega))
        x = orbit.harmonics(12)
        n = np.arange(1, 24, 2)
        lines.append(Lines(omega, Y, error, n, x, np.full(n.size, error), 50))
        regimes.append(orbit.regime)
    return lines, regimes


CASES = {
    "near resonance": (PAPER, 4.92, Regime.ONE_SLIP),
    "below": (PAPER, 3.5, Regime.ONE_SLIP),
    "above": (PAPER, 11.1, Regime.ONE_SLIP),
    "soft contact": (
        Oscillator(m=2.0, c=30.0, k=2000.0, K_z=6000.0, F_k=4.0),
        6.0,
        Regime.ONE_SLIP,
    ),
    "several slips": (Oscillator(2.42, 3.0, 2310.0, 2e4, 5.0), 0.8, Regime.SEVERAL_SLIPS),
}


@pytest.mark.parametrize("name", CASES)
def test_a_fit_holds_from_starts_that_need_no_orbits(name, monkeypatch):
    osc, hz, regime = CASES[name]
    lines, regimes = lines_of(osc, hz, (0.004, 0.008, 0.012))
    assert regimes[-1] == regime
    monkeypatch.setattr(lines_module, "_all_responses", None)  # the orbits of many candidates
    fit = fitting.fit_oscillator(lines, osc.k)
    assert fit is not None
    assert fit.adequate
    # the harmonics are exact; the climb ends 3e-4 standard errors from the best
    for symbol in ("F_k", "c", "m"):
        off = abs(getattr(fit, symbol) - getattr(osc, symbol))
        assert off < 1e-2 * fit.error(symbol) + 1e-9 * getattr(osc, symbol)


def test_the_closest_start_is_of_the_right_size():
    lines, _ = lines_of(PAPER, 3.5, (0.004, 0.008, 0.012))
    F_k, c, K_z, m = starts(lines, PAPER.k)[0]
    # stiffnesses lie a factor 2.2 apart on the grid; F_k, c and m then follow from balances
    assert K_z == pytest.approx(PAPER.K_z, rel=1.2)
    assert F_k == pytest.approx(PAPER.F_k, rel=0.2)
    assert c == pytest.approx(PAPER.c, rel=0.1)
    assert m == pytest.approx(PAPER.m, rel=0.1)


def test_neither_of_two_numbers_is_below_zero():
    rng = np.random.default_rng(3)
    signs = set()
    for _ in range(200):
        columns = rng.random((4, 2)) * [1.0, rng.choice([0.1, 1.0, 10.0])]
        expected, _ = nnls(columns, np.ones(4))
        assert _not_negative(columns) == pytest.approx(tuple(expected), rel=1e-9, abs=1e-12)
        signs.add(tuple(expected > 0.0))
    assert len(signs) == 3  # both, and each alone
