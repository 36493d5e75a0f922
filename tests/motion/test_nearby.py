"""Steady orbits from those of oscillators nearby are the steady orbits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.cases import SEVERAL_SLIPS, dimensions
from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.motion import nearby
from dampbalance.motion.nearby import steady_orbit_near


def of(numbers):
    Y, omega = numbers.pop("Y"), numbers.pop("omega")
    return Oscillator(**numbers), BaseMotion(Y, omega)


# from what rounding leaves to other patterns of slip
@pytest.mark.parametrize(("part", "followed"), [(1e-6, 1.0), (0.01, 0.8), (0.5, 0.1)])
def test_it_is_the_orbit_from_anywhere(part, followed, monkeypatch):
    searched = []

    def search(*case, **options):
        searched.append(case)
        return steady_orbit(*case, **options)

    monkeypatch.setattr(nearby, "steady_orbit", search)
    random = np.random.default_rng(3)
    count = 0
    for numbers in SEVERAL_SLIPS:
        near = steady_orbit(*of(dimensions(*numbers)))
        assert near.regime is Regime.SEVERAL_SLIPS
        for _ in range(10):
            moved = np.array(numbers) * np.exp(part * random.standard_normal(4))
            osc, motion = of(dimensions(*moved.tolist()))
            found, wanted = steady_orbit_near(osc, motion, near), steady_orbit(osc, motion)
            count += 1
            assert found.regime is wanted.regime
            off = math.remainder(found.theta - wanted.theta, 2.0 * math.pi)
            assert [found.X / wanted.X - 1.0, off] == pytest.approx([0.0, 0.0], abs=1e-8)
            scale = [2.0 * math.pi / motion.omega, 1.0, wanted.X, wanted.X * motion.omega, osc.Z_m]
            assert np.allclose(found.phases / scale, wanted.phases / scale, rtol=0.0, atol=1e-8)
    assert len(searched) <= (1.0 - followed) * count
