"""Yardsticks of studies: the bound on errors, and Simpson's rule, against samples, primitives, orbits and noise."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, steady_orbit
from dampbalance.model import Oscillator
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.simpson import integrals
from dampbalance.studies.bound import fit_at_truth
from dampbalance.studies.simpson import cycle_integrals, replicates_of
from fit.sampled import covariance
from paper_case import OMEGA, PAPER, motions_at

# --- the bound ------------------------------------------------------------------------------------


MOTIONS = motions_at()
# slips several times a half cycle
WEAK = Oscillator(m=2.42, c=3.0, k=2310.0, K_z=69_300.0, F_k=1.28)


def bound(osc=PAPER, motions=MOTIONS, y=5e-5, x=5e-5, rate_hz=2000.0, cycles=10.0, free=()):
    samples = [round(rate_hz * cycles * motion.period) for motion in motions]
    sigmas = [np.broadcast_to(sigma, len(motions)) for sigma in (y, x)]
    errors = np.sqrt(2.0 / np.array(samples)) * sigmas  # of a Fourier coefficient of n samples
    return fit_at_truth(osc, motions, errors.T.tolist(), {"m"} - {*free})


def covariance_of(fit, free=()):
    """Covariance of (F_k, c, K_z[, m])."""
    kept = 3 + len(free)
    turn = np.array([1.0, 1.0, -2.0 * fit.K_z**1.5, 1.0])[:kept]  # dK_z/dρ
    return fit.covariance[:kept, :kept] * np.outer(turn, turn)


@pytest.mark.parametrize(
    ("osc", "hz", "free", "levels"),
    [
        (PAPER, 4.92, (), (0.004, 0.012)),
        (PAPER, 11.1, ("m",), (0.004, 0.012)),
        (replace(PAPER, K_z=1e8), 4.92, ("m",), (0.004, 0.012)),
        (replace(PAPER, c=400.0), 3.5, (), (0.004, 0.012)),
        (WEAK, 1.6, ("m",), (8e-4, 14e-4)),
    ],
)
def test_the_bound_is_that_of_every_sample(osc, hz, free, levels):
    motions, noise = motions_at(hz, levels), {"y": 5e-5, "x": (2e-5, 7e-5)}  # a σ for each level
    # whole cycles, and enough samples that the onset of slip falls between all kinds of them
    exact = covariance(osc, motions, 200.0 * hz, 40.0, noise, free)
    found = bound(osc, motions, **noise, rate_hz=200.0 * hz, cycles=40.0, free=free)
    errors = np.sqrt(np.diag(exact))
    # one-sided differences of 1e-6 on this side: that times their curvature, up to some tens
    scaled = covariance_of(found, free) / np.outer(errors, errors)
    np.testing.assert_allclose(scaled, exact / np.outer(errors, errors), atol=2e-4)
    stated = found.error("F_k"), found.error("c"), found.K_z_error
    assert stated == pytest.approx(errors[:3], rel=1e-4)
    values = (found.F_k, found.c, found.K_z, found.m)
    assert values == pytest.approx((osc.F_k, osc.c, osc.K_z, osc.m), rel=1e-12)


def test_information_adds_and_an_unknown_mass_costs_some():
    known, free = bound(), bound(free=("m",))
    other = motions_at(11.1)
    both = np.linalg.inv(covariance_of(bound(motions=MOTIONS + other)))
    apart = sum(np.linalg.inv(covariance_of(of)) for of in (known, bound(motions=other)))
    assert both == pytest.approx(apart, rel=1e-8)  # rounding of I⁻¹
    assert free.K_z_error > 1.2 * known.K_z_error  # K_z and m both add stiffness
    assert known.error("m") == 0.0
    assert bound(replace(PAPER, F_k=60.0)) is None  # where nothing slips


# --- plain direct integration ---------------------------------------------------------------------


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
