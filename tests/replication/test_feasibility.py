"""What is accepted can be solved: the energy balance closes wherever numbers are taken from, and steps are stable."""

from __future__ import annotations

import math
import random

import pytest

from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.motion.orbit import MOST_EVENTS, RANGES
from dampbalance.replication.fixed_step import SCHEMES, largest_growth


def test_the_energy_balance_closes_wherever_numbers_are_taken_from():
    draw, slipped = random.Random(2010), 0
    for _ in range(200):
        zeta, r, K, F = (
            10 ** draw.uniform(math.log10(low), math.log10(min(high, 1e8)))
            for low, high in RANGES.values()
        )
        if math.sqrt(1.0 + K) / r > 0.1 * MOST_EVENTS:  # slow ones would take most of the time
            continue
        orbit = steady_orbit(Oscillator(1.0, 2.0 * zeta, 1.0, K, F), BaseMotion(1.0, r))
        if orbit.regime is Regime.NO_SLIP:
            continue
        slipped += 1
        spent = orbit.a * F + orbit.b * 2.0 * zeta
        assert abs(orbit.W - spent) <= 1e-6 * spent  # what `check_feasible` lets rounding take
    assert slipped > 50


@pytest.mark.parametrize("scheme", SCHEMES)
def test_growth_is_that_of_the_free_oscillation(scheme):
    """Explicit Euler multiplies the amplitude of an undamped oscillation by √(1 + ω²h²) in a step, RK4 lets it decay up
    to ωh = √8, the implicit schemes let it never grow, and semi-implicit Euler holds it up to ωh = 2."""
    for omega_h in (0.1, 1.5, 2.5, 3.5):
        growth = largest_growth(scheme, 1.0, 0.0, omega_h**2)
        if scheme == "explicit-euler":
            assert growth == pytest.approx(math.sqrt(1.0 + omega_h**2), rel=1e-12)
        elif scheme == "rk4":
            assert (growth > 1.0) == (omega_h > math.sqrt(8.0))
        elif scheme == "semi-implicit-euler":
            assert (growth > 1.0 + 1e-12) == (omega_h > 2.0)  # rounding of two roots on the circle
        else:
            assert growth <= 1.0 + 1e-12
