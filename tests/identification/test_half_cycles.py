"""Rows of free decays, against closed forms and motions that are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.fit.decay import Decay, numbers_of
from dampbalance.identification.half_cycles import _basis, _columns, _course
from dampbalance.motion.events import PHASE_X
from dampbalance.motion.jit import interpreted
from dampbalance.motion.states import states_in_phases
from fit.exact import decay_of

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


@pytest.mark.parametrize("order", [0, 1, 2])
def test_samples_of_the_ringing_change_with_the_last_turn_as_the_motion_does(order):
    """Against the motion from a last turn that lies a little farther out."""
    point = np.concatenate([[F_K, 0.3, (30.0 * K) ** -0.5, M, 0.0], STATE])
    whole = decay_of(point, K, np.arange(0.0, 20.0 * HALF, HALF / 20.0), 1e-6, order)
    (signal,) = whole.signals
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
