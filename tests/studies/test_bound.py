"""The Cramér–Rao bound against the information of every sample, and its own laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dampbalance.model import Oscillator
from dampbalance.studies.bound import fit_at_truth
from fit.sampled import covariance
from paper_case import PAPER, motions_at

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
