"""Far beyond any measured system every case has an orbit, and what is NaN has its reason: README.md, section 10."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from analytic.cases import dimensions, drawn, orbit_of, spread
from dampbalance import BaseMotion, Regime, steady_orbit, steady_orbits
from paper_case import PAPER

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


@settings(max_examples=150)
@given(*drawn(*RANGES), st.booleans())
@example(1.0, 1.0, 1.0, 1.0, False)
@example(1.0, 1.0, 1.0, 1.0, True)
@example(1.0, 2.0, 3.0, 0.25, True)  # the stick phase at resonance
@example(1.0, 0.2, 24.0, 0.5, True)  # both phases at a multiple of the drive
@example(1.0, 1.0 / 3.0, 8.0, 0.5, True)
def test_each_case_is_solved_and_fits_its_own_claims(zeta, r, K, F, undamped):
    # friction below πkY/4 does not hold an undamped resonance (test_limits), and amplitudes beyond 10⁴ Y are not sought
    assume(not (undamped and abs(r - 1.0) < 1e-4 and math.pi / 4.0 + 1e-4 > F))
    numbers = dimensions(0.0 if undamped else zeta, r, K, F)
    orbits = steady_orbits(**numbers)
    assert_nan_has_its_reason(orbits)
    orbit = orbit_of(**numbers)
    motion = orbit.motion
    assert orbit.regime == orbits.regime

    t = orbit.t_1 + np.linspace(0.0, 1.0, 200) * motion.period
    state = orbit.state(t)
    assert np.all(np.abs(state.x) <= orbit.X * (1.0 + 1e-12))  # X is the peak; rounding
    assert np.all(np.abs(state.z) <= orbit.oscillator.Z_m * (1.0 + 1e-12))
    # the contact force is bounded, so is the acceleration
    assert np.all(np.isfinite(state.acceleration))


@pytest.mark.parametrize("scale", [1e-27, 1e-12, 1e12, 1e28])
def test_units_far_from_the_metre(scale):
    # Only ratios matter: no threshold in metres or newtons hides anywhere. 1e-10: many roundings of a cancelling kind
    base, scaled = (
        steady_orbit(
            replace(PAPER, F_k=1.28 * s),
            BaseMotion(Y=0.004 * s, omega=30.9),
        )
        for s in (1.0, scale)
    )
    assert scaled.X / scale == pytest.approx(base.X, rel=1e-13)
    assert scaled.a / scale == pytest.approx(base.a, rel=1e-13)
    assert scaled.t_s == pytest.approx(base.t_s, rel=1e-13)
