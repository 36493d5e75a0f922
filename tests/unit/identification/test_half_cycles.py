"""Rows and fits of free decays, against closed forms and motions that are known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from dampbalance.identification.half_cycles import _basis, _columns, _course
from dampbalance.likelihood.decay import Decay, fit_decays, numbers_of
from dampbalance.likelihood.search import (
    _before,
    _until_disturbed,
    _until_grasped,
)
from dampbalance.motion.events import PHASE_X
from dampbalance.motion.jit import interpreted
from dampbalance.motion.states import states_in_phases
from dampbalance.reading.bursts import Signal
from unit.likelihood.exact import exact_samples

M, K, F_K, START = 2.0, 800.0, 0.2, 5e-3
HALF = math.pi * math.sqrt(M / K)  # between two turns, s
POINT = np.array([F_K, 0.0, 1.0 / math.sqrt(1e8 * K), M, 0.0])  # the contact is all but rigid
STATE = np.array([START, 0.0, 2.0])


@pytest.mark.parametrize(("cycles", "halves"), [(3.4, 3), (3.6, 4), (4.1, 4)])
def test_a_half_cycle_counts_if_half_of_it_is_recorded(cycles, halves):
    """Under friction alone the turns lie at half periods of the mass on its spring, x_n = (−1)^n (x_0 − 2n F_k/k), and
    ∫ ẋ² dt between them is that of a cosine of amplitude x_n − F_k/k."""
    with interpreted():
        course = _course(POINT, STATE, K, Decay("", 0.0, cycles * HALF, (), 2.0 * HALF))
    n = np.arange(halves + 1)
    turns = (-1.0) ** n * (START - 2.0 * n * F_K / K)
    # the contact gives way by 1e-8 of the spring
    assert [half.t_b for half in course.halves] == pytest.approx(n[1:] * HALF, rel=1e-4)
    assert course.turns == pytest.approx(turns, rel=1e-6)
    W, a, b = _columns(POINT, K, course, course.turns).T
    amplitudes = abs(turns[:-1]) - F_K / K
    assert a == pytest.approx(2.0 * amplitudes, rel=1e-6)
    assert b == pytest.approx(0.5 * math.pi * math.sqrt(K / M) * amplitudes**2, rel=1e-6)
    assert pytest.approx(F_K * a, rel=1e-6) == W


def test_the_state_a_step_earlier_is_that_of_the_damped_motion():
    """m ẍ + c ẋ + k x = −F_k while the mass slips forwards: the matrix exponential of a step back in time."""
    c, step, now = 30.0, 2.0 * HALF / 24.0, np.array([1e-3, 0.05])
    rest = np.array([-F_K / K, 0.0])
    exact = rest + expm(-step * np.array([[0.0, 1.0], [-K / M, -c / M]])) @ (now - rest)
    point = np.concatenate([[F_K, c], POINT[2:]])
    x, v, w = _before(np.concatenate([point, now, [2.0]]), K, step)[-3:]
    # of second order; 16 steps of (ωh, hc/m) = (0.016, 0.012) leave 1.3e-3
    assert [x, v] == pytest.approx(exact, rel=3e-3)
    assert w == 2.0


def decay(last, k_z=30.0 * K, noise=1e-6):
    """A decay of exact samples with a little noise, `last` half cycles long, and the fit of its offset alone."""
    t = np.arange(0.0, last * HALF, HALF / 20.0)
    unread = Decay("", 0.0, t[-1], (Signal("displacement", 0, t, t, noise),), 2.0 * HALF)
    point = np.concatenate([[F_K, 0.3, k_z**-0.5, M, 0.0], STATE])
    exact = exact_samples(point, K, unread)
    values = exact + noise * np.random.default_rng(8).standard_normal(t.size)
    return replace(unread, signals=(replace(unread.signals[0], values=values),)), point


def changed(whole, since, values):
    """The decay with other values from a time on."""
    (signal,) = whole.signals
    late = signal.t >= since
    return replace(whole, signals=(replace(signal, values=np.where(late, values, signal.values)),))


def test_a_fit_ends_where_something_else_moves_the_mass():
    whole, point = decay(9.0)
    disturbed = 6.3 * HALF
    whole = changed(whole, disturbed, whole.signals[0].values + 1e-4)
    good = disturbed - 2.0 * HALF
    with interpreted():
        fit = fit_decays([whole.cut(0.0, good)], K, point, given={7})
        found = _until_disturbed(fit, whole, whole.end)
    end = found.decays[0].end
    # bisected to a twentieth of a half cycle, then half a cycle less: where a disturbance began may show late
    assert disturbed - 1.3 * HALF < end < disturbed - 0.8 * HALF
    assert found.adequate


@pytest.mark.parametrize("grasped", [None, 17.3])
def test_a_decay_ends_where_a_hand_holds_the_mass_that_rang(grasped):
    """The mass sticks after ten half cycles, and rings on the contact until it is held."""
    whole, point = decay(20.0)
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


@pytest.mark.parametrize("order", [0, 1, 2])
def test_samples_of_the_ringing_change_with_the_last_turn_as_the_motion_does(order):
    """Against the motion from a last turn that lies a little farther out."""
    whole, point = decay(20.0)
    (signal,) = whole.signals
    whole = replace(whole, signals=(replace(signal, order=order),))
    with interpreted():
        course = _course(point, STATE, K, whole)
        block, seen = _basis(point, K, whole, course)
        step, par = 1e-7, numbers_of(point, K)
        late = signal.t > course.rings_from
        farther = course.phases.copy()
        farther[-1, PHASE_X] += step
        exact, moved = (
            states_in_phases(signal.t[late], phases, 0.0, par)[order]
            for phases in (course.phases, farther)
        )
    assert late.sum() > 50
    assert seen[late].all()
    expected = (moved - exact) / step / signal.noise
    np.testing.assert_allclose(block[late, -1], expected, atol=1e-6 * np.abs(expected).max())
