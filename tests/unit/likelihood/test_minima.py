"""The search for all minima of free decays: from side minima to the lowest, and intervals over those as good."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.likelihood.decay import COMMON, Decay, RingFit, fit_decays
from dampbalance.likelihood.minima import minima_of, with_intervals
from dampbalance.reading.bursts import Signal
from unit.likelihood.exact import exact_samples

M, K, F_K, START = 2.0, 800.0, 0.4, 5e-3
PERIOD = 2.0 * math.pi * math.sqrt(M / K)
LEVEL = 3.84  # of χ²: a 95 % interval


def decay(noise: float, stiffness: float = 60.0, order: int = 0) -> tuple[Decay, np.ndarray]:
    """A decay that comes to rest after four half cycles and rings on, and its point."""
    t = np.arange(0.0, 5.0 * PERIOD, PERIOD / 90.0)
    point = np.array([F_K, 0.3, (stiffness * K) ** -0.5, M, 0.0, START, 0.0, 1.8])
    empty = Signal("displacement", order, t, np.zeros(t.size), 1.0)
    whole = Decay("", 0.0, float(t[-1]), (empty,), PERIOD)
    exact = exact_samples(point, K, whole)
    sigma = noise * np.abs(exact).max()
    values = exact + sigma * np.random.default_rng(5).standard_normal(t.size)
    return replace(whole, signals=(replace(empty, values=values, noise=sigma),)), point


@pytest.mark.parametrize("cycles", [-3, 2])
def test_a_fit_whose_ringing_is_some_cycles_off_is_left_for_the_right_one(cycles):
    whole, point = decay(1e-3)
    truth = fit_decays([whole], K, point)
    ringing = whole.end - truth.sticks_from(0)
    Omega = math.sqrt((K + point[2] ** -2) / M) + 2.0 * math.pi * cycles / ringing
    beside = point.copy()
    beside[2] = (M * Omega**2 - K) ** -0.5
    side = fit_decays([whole], K, beside)
    assert side.chi_square > truth.chi_square + 100.0  # a climb alone ends there
    assert minima_of(side)[0].chi_square < truth.chi_square + 0.1


def test_a_fit_with_another_loss_is_left_for_the_right_one():
    """Accelerations of a stiff contact: with another number of half cycles χ² has another minimum."""
    whole, point = decay(1e-2, 180.0, order=2)
    truth = fit_decays([whole], K, point)
    wrong = point.copy()
    wrong[:2] = 1.15 * F_K, 0.0
    side = fit_decays([whole], K, wrong)
    assert not side.adequate
    assert minima_of(side)[0].chi_square < truth.chi_square + 0.1


def test_a_fit_with_another_mass_that_rings_as_fast_is_left_for_the_right_one():
    """Accelerations after a short slip: the ringing, which most samples show, fixes (k + K_z)/m alone."""
    whole, point = decay(1e-2, 240.0, order=2)
    truth = fit_decays([whole], K, point)
    wrong = point.copy()
    wrong[3] *= 1.12
    wrong[2] = (1.12 * (K + point[2] ** -2) - K) ** -0.5
    side = fit_decays([whole], K, wrong)
    assert not side.adequate
    assert minima_of(side)[0].chi_square < truth.chi_square + 0.1


def test_a_period_that_the_spectrum_doubled_does_not_hold_the_mass():
    """The mass is bounded below by the period; records of several pulls may show a line at half the frequency."""
    whole, point = decay(1e-2)
    start = point.copy()
    start[3] *= 1.02
    right, doubled = (
        fit_decays([replace(whole, period=factor * PERIOD)], K, start) for factor in (1.0, 2.1)
    )
    assert doubled.m == pytest.approx(right.m, rel=1e-6)
    assert abs(right.m - M) < 4.0 * right.error("m")


def test_ringing_that_noise_nearly_hides_leaves_many_contacts():
    """At 5 % noise the contact of the truth counts, however many cycles of ringing it is off the lowest minimum."""
    stiffness = 60.0
    whole, point = decay(5e-2, stiffness)
    fit = with_intervals(minima_of(fit_decays([whole], K, point)))
    low, high = fit.K_z_interval
    assert low < stiffness * K < high
    assert high > 2.0 * low


def test_an_interval_of_a_rigid_contact_reaches_as_far_as_the_samples_allow():
    """χ² is flat from a rigid contact on: its slope there says nothing of where it rises."""
    whole, point = decay(5e-2, 3e3)
    held_there = point.copy()
    held_there[2] = (1e8 * K) ** -0.5
    rigid = fit_decays([whole], K, held_there, given={2})
    free = fit_decays([whole], K, rigid.point, most=1)
    free = replace(free, point=rigid.point, chi_square=rigid.chi_square)
    ranges = with_intervals([free]).ranges
    assert ranges["rho"][0] <= 0.0
    rigid.point[2] = ranges["rho"][1]
    there = fit_decays([whole], K, rigid.point, given={2}).chi_square - free.chi_square
    # found to a tenth of the distance, a fifth of the rise
    assert there == pytest.approx(LEVEL, rel=0.25)


def held(fit: RingFit, name: str, value: float) -> float:
    """χ² with one unknown held and the others fitted, relative to that of the fit."""
    j = COMMON.index(name)
    start = fit.point + fit.covariance[:, j] * ((value - fit.point[j]) / fit.covariance[j, j])
    start[j] = value
    return fit_decays(fit.decays, K, start, given={j}).chi_square - fit.chi_square


def test_an_interval_ends_where_chi_square_has_risen_by_that_of_its_probability():
    whole, point = decay(3e-3)
    fit = with_intervals(minima_of(fit_decays([whole], K, point)))
    assert fit.minima == 1
    assert set(fit.ranges) == {"F_k", "c", "rho"}
    for name, (low, high) in fit.ranges.items():
        assert low < fit.value(name) < high
        for end in (low, high):  # found to a tenth of the distance, a fifth of the rise
            assert held(fit, name, end) == pytest.approx(LEVEL, rel=0.2)


def test_an_interval_covers_all_minima_that_are_as_good():
    whole, point = decay(1e-3)
    best = fit_decays([whole], K, point)
    moved = best.point.copy()
    moved[2] *= 1.1

    def raised(by: float) -> RingFit:
        """The other minimum, so much higher."""
        return replace(best, point=moved, chi_square=best.chi_square + by)

    # e^{−12/2} is 2.5e-3 of the likelihood, e^{−5/2} 0.08
    alone, near = with_intervals([best, raised(12.0)]), with_intervals([best, raised(5.0)])
    several = with_intervals([best, raised(1.0)])
    assert (alone.minima, near.minima, several.minima) == (1, 2, 2)
    assert several.ranges["rho"][0] == alone.ranges["rho"][0]
    assert alone.ranges["rho"][1] < moved[2]
    assert near.ranges["rho"][1] == moved[2]
    reach = math.sqrt(LEVEL - 1.0) * best.error("rho")
    assert several.ranges["rho"][1] == pytest.approx(moved[2] + reach, rel=1e-3)
    # the standard error is that of the whole interval
    assert several.error("rho") > 10.0 * alone.error("rho")
    assert several.K_z_interval[0] == pytest.approx(several.ranges["rho"][1] ** -2)
