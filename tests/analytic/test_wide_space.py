"""Far beyond any measured system every case has an orbit, and what is NaN has its reason: README.md, section 10."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.cases import dimensions, spread
from dampbalance import Regime, steady_orbits

FINITE = ("X", "phi", "a", "b", "W", "X_1", "phi_1", "X_3", "phi_3", "X_5", "phi_5")
OF_SLIP = ("X_s", "V_s", "t_s")
RANGES = ((1e-4, 10.0), (0.05, 10.0), (0.01, 1e5), (1e-4, 10.0))  # ζ, ω/ω_n, K_z/k, F_k/kY


def assert_nan_has_its_reason(orbits):
    regime = np.atleast_1d(orbits.regime)
    assert not np.any(regime == Regime.NOT_FOUND)
    for name in FINITE:
        assert np.all(np.isfinite(getattr(orbits, name))), name
    for name in OF_SLIP:
        missing = np.atleast_1d(np.isnan(getattr(orbits, name)))
        np.testing.assert_array_equal(missing, regime == Regime.NO_SLIP, name)


@pytest.mark.parametrize("damping", [1.0, 0.0])
def test_thousands_of_cases(damping):
    zeta, r, K, F = spread(2048, 1, *RANGES)
    orbits = steady_orbits(**dimensions(damping * zeta, r, K, F))
    assert_nan_has_its_reason(orbits)
    counts = np.bincount(orbits.regime, minlength=5)
    assert np.all(counts[[Regime.ONE_SLIP, Regime.SEVERAL_SLIPS, Regime.NO_SLIP]] > 100)
    assert np.all(orbits.X > 0.0)
    # no energy can come out; without damping and slip W is nought, and rounding of πkYX₁
    nought = orbits.W <= 0.0
    assert np.all(np.abs(orbits.W[nought]) <= 1e-14 * math.pi * orbits.X_1[nought])
    assert np.all(orbits.regime[nought] == Regime.NO_SLIP)


def test_slow_and_stiff_with_hundreds_of_events():
    # the contact chatters at its own frequency, some 6000 times that of the drive
    orbits = steady_orbits(**dimensions(np.array([1e-4, 1e-2]), 0.05, 1e5, np.array([0.5, 0.2])))
    assert_nan_has_its_reason(orbits)
    assert np.all(orbits.regime == Regime.SEVERAL_SLIPS)


def test_exact_resonances_are_solved():
    # of both phases, of the stick phase alone, and at multiples of the drive; with damping and without
    r, K = np.array([(1.0, 1.0), (2.0, 3.0), (0.2, 24.0), (1.0 / 3.0, 8.0)]).T
    for zeta in (1.0, 0.0):
        assert_nan_has_its_reason(steady_orbits(**dimensions(zeta, r, K, [1.0, 0.25, 0.5, 0.5])))
