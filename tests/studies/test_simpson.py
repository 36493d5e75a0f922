"""Plain direct integration: Simpson's rule between any places, against primitives, exact orbits and known noise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, steady_orbit
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.simpson import integrals
from dampbalance.studies.simpson import cycle_integrals, replicates_of
from paper_case import OMEGA, PAPER

ORBIT = steady_orbit(PAPER, BaseMotion(0.008, OMEGA))


def of_record(rate_hz, cycles=6, **options):
    record = measured_orbit(ORBIT, rate_hz=rate_hz, cycles=cycles, start=0.031, **options)
    y, x = (record[name].values for name in ("base_displacement", "displacement"))
    return cycle_integrals(y, x, 1.0 / rate_hz, OMEGA, PAPER.k)


def test_a_parabola_is_integrated_exactly_between_any_places():
    dt, places = 0.5, np.array([0.0, 0.3, 1.0, 1.7, 2.0, 5.5, 8.0])
    t = dt * np.arange(10)  # an even number: the last interval belongs to no pair
    f = np.array([3.0 - 2.0 * t + 0.7 * t**2, t**2])
    primitives = [3.0 * u - u**2 + 0.7 * u**3 / 3.0 for u in dt * places], (dt * places) ** 3 / 3.0
    found = integrals(f, dt, places)
    assert found == pytest.approx(np.diff(np.array(primitives), axis=1), rel=1e-13, abs=1e-13)


def test_without_noise_the_exact_integrals_are_the_limit_and_errors_of_second_order():
    """a is that of the rigid contact, 4X; b and W are the orbit's. Central differences and the corners of |ẋ| make
    errors of second order."""
    exact = np.array([4.0 * ORBIT.X, ORBIT.b, ORBIT.W])
    coarse, fine = (
        np.abs(of_record(rate_hz).mean(axis=1) / exact - 1.0) for rate_hz in (500.0, 4000.0)
    )
    assert np.all(fine < 1e-4)
    assert np.all(coarse / fine > 0.6 * 8.0**2)
    assert of_record(4000.0).shape == (3, 5)  # the velocity lacks the two samples at the ends
    with pytest.raises(ValueError, match="no whole cycle of 203"):
        cycle_integrals(np.ones(150), np.ones(150), 1e-3, OMEGA, PAPER.k)


def test_noise_adds_its_variance_to_the_viscous_integral():
    rate_hz, part, cycles = 1000.0, 0.02, 400
    a, b, W = of_record(rate_hz, cycles, noise=part, seed=1)
    rms = np.linalg.norm(ORBIT.harmonics(3)) / math.sqrt(2.0)
    added = ORBIT.motion.period * (part * rms * rate_hz) ** 2 / 2.0
    assert added > 0.1 * ORBIT.b
    # four standard errors of the mean of the cycles
    for found, expected in ((b, ORBIT.b + added), (W, ORBIT.W)):
        assert abs(found.mean() - expected) < 4.0 * found.std(ddof=1) / math.sqrt(len(found))
    assert a.mean() > 4.0 * ORBIT.X * 1.01
    drawn = replicates_of(np.array([a, b, W]), 4000, np.random.default_rng(2))
    for found, of_means in zip((a, b, W), drawn, strict=True):
        assert of_means.mean() == pytest.approx(found.mean(), abs=4.0 * of_means.std() / 63.0)
        # a standard deviation from 4,000 numbers is good to 1.1 %
        assert of_means.std() == pytest.approx(found.std(ddof=1) / math.sqrt(len(found)), rel=0.05)
