"""The Cramér–Rao bound against the information of every sample, textbook cases and its own laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dampbalance.model import BaseMotion, Oscillator
from dampbalance.studies.bound import fit_at_truth
from fit.sampled import covariance, derivatives
from paper_case import FREQUENCIES_HZ, LEVELS, OMEGA, PAPER, motions_at

MOTIONS = motions_at()
# slips several times a half cycle
WEAK = Oscillator(m=2.42, c=3.0, k=2310.0, K_z=69_300.0, F_k=1.28)


def bound(osc=PAPER, motions=MOTIONS, noise=None, rate_hz=2000.0, cycles=10.0, free=()):
    sigmas = [
        np.broadcast_to((noise or {"y": 5e-5, "x": 5e-5})[name], len(motions)) for name in "yx"
    ]
    samples = [round(rate_hz * cycles * motion.period) for motion in motions]
    errors = np.sqrt(2.0 / np.array(samples)) * sigmas  # of a Fourier coefficient of n samples
    return fit_at_truth(osc, motions, errors.T.tolist(), {"m"} - {*free})


def standard_errors(fit):
    return fit.error("F_k"), fit.error("c"), fit.K_z_error


def covariance_of(fit, free=()):
    """Covariance of (F_k, c, K_z[, m])."""
    kept = 3 + len(free)
    turn = np.array([1.0, 1.0, -2.0 * fit.K_z**1.5, 1.0])[:kept]  # dK_z/dρ
    return fit.covariance[:kept, :kept] * np.outer(turn, turn)


def in_errors(covariance):
    """Standard errors and correlations, (n, n), for comparison."""
    errors = np.sqrt(np.diag(covariance))
    return errors, covariance / np.outer(errors, errors)


@pytest.mark.parametrize(
    ("osc", "hz", "free"),
    [
        *[(PAPER, hz, free) for hz in FREQUENCIES_HZ.values() for free in ((), ("m",))],
        (replace(PAPER, K_z=1e8), 4.92, ("m",)),
        (replace(PAPER, c=400.0), 3.5, ()),
        (WEAK, 1.6, ("m",)),
    ],
)
def test_the_bound_is_that_of_every_sample(osc, hz, free):
    motions = motions_at(hz, (0.004, 0.012)) if osc is not WEAK else motions_at(hz, (8e-4, 14e-4))
    noise = {"y": 5e-5, "x": (2e-5, 7e-5)}  # a σ for each of two levels
    # whole cycles, and enough samples that the onset of slip falls between all kinds of them
    rate = 200.0 * hz
    errors, correlations = in_errors(covariance(osc, motions, rate, 40.0, noise, free))
    found = bound(osc, motions, noise, rate, 40.0, free)
    stated, between = in_errors(covariance_of(found, free))
    # one-sided differences of 1e-6 on this side: that times their curvature, up to some tens
    assert stated == pytest.approx(errors, rel=1e-4)
    assert between == pytest.approx(correlations, abs=1e-4)
    assert standard_errors(found) == pytest.approx(stated[:3], rel=1e-12)
    values = (found.F_k, found.c, found.K_z, found.m)
    assert values == pytest.approx((osc.F_k, osc.c, osc.K_z, osc.m), rel=1e-12)


def test_records_of_other_lengths_need_many_cycles():
    """Samples of no whole number of cycles: the ends count by one over the number of cycles."""
    noise = {"y": 6e-5, "x": 9e-5}
    for cycles in (10.37, 60.37):
        errors, _ = in_errors(covariance(PAPER, MOTIONS, 1000.0, cycles, noise))
        found = bound(noise=noise, rate_hz=1000.0, cycles=cycles)
        assert standard_errors(found) == pytest.approx(errors, rel=0.2 / cycles)


def test_without_friction_c_has_the_textbook_bound():
    """The yardstick itself: without friction x and y are sinusoids, and c alone, with Y and ψ, is unknown."""
    osc = replace(PAPER, F_k=1e-8)
    motion, sigma, n = BaseMotion(0.008, OMEGA), 4e-5, 1200
    t = np.arange(n) * motion.period / 100.0  # twelve whole cycles
    rows = [1, 4, 5]  # c, Y, ψ
    information = sum(J[rows] @ J[rows].T for J in derivatives(osc, motion, t)) / sigma**2
    variance = np.linalg.inv(information)[0, 0]
    # The lines ŷ, x̂ have the variance 2σ²/n in each part. D = k − mω² + icω = kŷ/x̂, so that c = Im(kŷ/x̂)/ω and
    # var c = (|k/X|² + |D/X|²) (2σ²/n)/ω². That Re D is known does not help: the error of kŷ/x̂ is circular, its parts
    # are uncorrelated.
    D = osc.k - osc.m * OMEGA**2 + 1j * osc.c * OMEGA
    X = osc.k * motion.Y / abs(D)
    textbook = (osc.k**2 + abs(D) ** 2) / X**2 * 2.0 * sigma**2 / n / OMEGA**2
    # differences: 1e-8; twelve whole cycles: exact
    assert variance == pytest.approx(textbook, rel=1e-6)


def test_variances_go_with_noise_squared_and_one_over_samples():
    one, loud = (covariance_of(fit) for fit in (bound(), bound(noise={"y": 1.5e-4, "x": 1.5e-4})))
    assert loud == pytest.approx(9.0 * one, rel=1e-8)  # rounding of I⁻¹
    # 3,252 samples in ten cycles, rounded
    assert covariance_of(bound(cycles=80.0)) == pytest.approx(one / 8.0, rel=2e-4)


def test_bound_does_not_depend_on_the_units():
    """Lengths in mm: m, c, k, K_z in N/mm and the like, forces as they are."""
    mm = Oscillator(*(getattr(PAPER, n) / 1e3 for n in ("m", "c", "k", "K_z")), PAPER.F_k)
    motions = [BaseMotion(1e3 * Y, OMEGA) for Y in LEVELS]
    scaled = np.array(standard_errors(bound(mm, motions, {"y": 5e-2, "x": 5e-2})))
    # rounding of the differences, 1e-13 over 1e-6
    assert scaled * (1.0, 1e3, 1e3) == pytest.approx(standard_errors(bound()), rel=1e-5)


def test_an_unknown_mass_costs():
    known, free = bound(), bound(free=("m",))
    unit = np.outer(standard_errors(known), standard_errors(known))
    # rounding of a pseudo-inverse whose unknowns differ by six decades: 6e-12 was seen
    assert np.linalg.eigvalsh((covariance_of(free) - covariance_of(known)) / unit).min() > -1e-10
    assert free.K_z_error > 1.2 * known.K_z_error  # K_z and m both add stiffness
    assert known.error("m") == 0.0


def test_several_frequencies_add_their_information():
    other = motions_at(11.1)
    both = np.linalg.inv(covariance_of(bound(motions=MOTIONS + other)))
    apart = sum(np.linalg.inv(covariance_of(bound(motions=m))) for m in (MOTIONS, other))
    assert both == pytest.approx(apart, rel=1e-8)  # rounding of I⁻¹


def test_where_nothing_slips_there_is_no_bound():
    assert bound(replace(PAPER, F_k=60.0)) is None
