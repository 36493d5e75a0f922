"""The search for the oscillator of free decays: where they begin and end, from side minima to the lowest, and intervals
over those as good."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.linalg import expm

from blind.decays import draw, record
from dampbalance.fit.decay import Decay, RingFit, fit_decays, with_intervals
from dampbalance.fit.search import _before, _grown, _until_grasped, minima_of
from dampbalance.identification.decays import identify_ring_downs
from dampbalance.motion.jit import interpreted
from dampbalance.motion.unknowns import OSCILLATOR_UNKNOWNS
from dampbalance.signals.bursts import Burst
from fit.exact import changed, decay_of

M, K, F_K, START = 2.0, 800.0, 0.4, 5e-3
PERIOD = 2.0 * math.pi * math.sqrt(M / K)
HALF = 0.5 * PERIOD  # between two turns, s
LEVEL = 3.84  # of χ²: a 95 % interval


def decay(noise: float, stiffness: float = 60.0, order: int = 0) -> tuple[Decay, np.ndarray]:
    """A decay that comes to rest after four half cycles and rings on, and its point."""
    t = np.arange(0.0, 5.0 * PERIOD, PERIOD / 90.0)
    point = np.array([F_K, 0.3, (stiffness * K) ** -0.5, M, 0.0, START, 0.0, 1.8])
    return decay_of(point, K, t, noise if order else noise * START, order), point


def long(last: float) -> tuple[Decay, np.ndarray]:
    """A decay that slips for ten half cycles, `last` half cycles long, with hardly any noise, and its point."""
    t = np.arange(0.0, last * HALF, HALF / 20.0)
    point = np.array([0.5 * F_K, 0.3, (30.0 * K) ** -0.5, M, 0.0, START, 0.0, 2.0])
    return decay_of(point, K, t, 1e-6), point


def off_by_cycles(point: np.ndarray, truth: RingFit, cycles: int) -> np.ndarray:
    """The point with as many more cycles of ringing."""
    ringing = truth.decays[0].end - truth.sticks_from(0)
    Omega = math.sqrt((K + point[2] ** -2) / M) + 2.0 * math.pi * cycles / ringing
    return np.concatenate([point[:2], [(M * Omega**2 - K) ** -0.5], point[3:]])


def with_another_loss(point: np.ndarray, truth: RingFit) -> np.ndarray:
    """With another number of half cycles χ² has another minimum."""
    return np.concatenate([[1.15 * F_K, 0.0], point[2:]])


def with_another_mass(point: np.ndarray, truth: RingFit) -> np.ndarray:
    """After a short slip the ringing, which most samples show, fixes (k + K_z)/m alone."""
    stiffness = 1.12 * (K + point[2] ** -2) - K
    return np.concatenate([point[:2], [stiffness**-0.5, 1.12 * M], point[4:]])


@pytest.mark.parametrize(
    ("made", "wrong"),
    [
        ((1e-3,), partial(off_by_cycles, cycles=-3)),
        ((1e-3,), partial(off_by_cycles, cycles=2)),
        ((1e-2, 180.0, 2), with_another_loss),
        ((1e-2, 240.0, 2), with_another_mass),
    ],
    ids=["slower ringing", "faster ringing", "loss", "mass"],
)
def test_a_side_minimum_is_left_for_the_lowest(made, wrong):
    whole, point = decay(*made)
    truth = fit_decays([whole], K, point)
    side = fit_decays([whole], K, wrong(point, truth))
    assert not side.adequate  # a climb alone ends there
    assert side.chi_square > truth.chi_square + 100.0
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
    j = OSCILLATOR_UNKNOWNS.index(name)
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


def test_the_state_a_step_earlier_is_that_of_the_damped_motion():
    """m ẍ + c ẋ + k x = −F_k while the mass slips forwards: the matrix exponential of a step back in time."""
    c, step, now = 30.0, 2.0 * HALF / 24.0, np.array([1e-3, 0.05])
    rest = np.array([-F_K / K, 0.0])
    exact = rest + expm(-step * np.array([[0.0, 1.0], [-K / M, -c / M]])) @ (now - rest)
    point = np.array([F_K, c, 1e-6, M, 0.0, *now, 2.0])
    x, v, w = _before(point, K, step)[-3:]
    # of second order; 16 steps of (ωh, hc/m) = (0.016, 0.012) leave 1.3e-3
    assert [x, v] == pytest.approx(exact, rel=3e-3)
    assert w == 2.0


def test_a_fit_ends_where_something_else_moves_the_mass():
    whole, _ = long(9.0)
    disturbed = 6.3 * HALF
    whole = changed(whole, disturbed, whole.signals[0].values + 1e-4)
    burst = Burst(0.0, 1.0, 1.9 * START, PERIOD, 0.0, whole.end, last=False)
    found = _grown(whole, burst, whole.signals[0], K, None)
    end = found.decays[0].end
    # bisected to a twentieth of a half cycle, then half a cycle less: where a disturbance began may show late
    assert disturbed - 1.3 * HALF < end < disturbed - 0.8 * HALF
    assert found.adequate


@pytest.mark.parametrize("grasped", [None, 17.3])
def test_a_decay_ends_where_a_hand_holds_the_mass_that_rang(grasped):
    """The mass sticks after ten half cycles, and rings on the contact until it is held."""
    whole, point = long(20.0)
    if grasped is not None:
        rng = np.random.default_rng(9)
        held = whole.signals[0].values[-1] + 1e-6 * rng.standard_normal(whole.signals[0].t.size)
        whole = changed(whole, grasped * HALF, held)
    with interpreted():
        fit = fit_decays([whole], K, point, given={0, 1, 2, 3, 5, 6, 7})
        found = _until_grasped(fit)
    if grasped is None:
        assert found is fit
    else:
        # the ringing, of a few times the noise, tells the instant to some samples
        assert found.decays[0].end == pytest.approx(grasped * HALF, abs=0.3 * HALF)


def test_a_mass_that_rests_at_once_is_no_longer_decay():
    """Three plucks of hardly more than the noise: what starts there may stick after its first sample."""
    plucked = draw(151, 1795560035)
    measured, _ = record(plucked, 1795560035)
    with interpreted(False):
        found = identify_ring_downs([measured], plucked.k)
    assert found.intervals["F_k"][0] < plucked.F_k < found.intervals["F_k"][1]
