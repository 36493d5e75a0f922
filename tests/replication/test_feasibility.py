"""What is accepted can be solved: the energy balance closes wherever numbers are taken from."""

from __future__ import annotations

import math
import random

from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.motion.orbit import MOST_EVENTS, RANGES


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
        if orbit.regime is not Regime.NO_SLIP:
            slipped += 1
            spent = orbit.a * F + orbit.b * 2.0 * zeta
            assert abs(orbit.W - spent) <= 1e-6 * spent  # what `check_feasible` lets rounding take
    assert slipped > 50
