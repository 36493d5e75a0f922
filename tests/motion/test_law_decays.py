"""Free decays that are not linear: against the exact motion where they are, an independent integrator, differences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from blind.decays import Decay
from blind.other_motion import Departure, one_slider, ring_down_on
from dampbalance.model import Parameters
from dampbalance.motion import law_decays
from dampbalance.motion.events import run
from dampbalance.motion.law_decays import ADDED, DECAY_UNKNOWNS, LINEAR_UNKNOWNS
from dampbalance.motion.states import states_in_phases
from identification.pendulums import Release

M, K, PERIOD = 2.0, 800.0, 2.0 * math.pi * math.sqrt(2.0 / 800.0)
NOTHING, NO_PHASES = np.zeros(len(ADDED)), np.empty((0, 5))
# each takes 5 to 30 % of the loss, or of the force of the spring, of a decay from 5 mm
COEFFICIENTS = np.array([8.0, 2e6, 0.05, 0.02, 0.1, 0.3])


def law_decay(*of, gravity: float = 0.0, phases: np.ndarray = NO_PHASES):
    return law_decays.law_decay(*of, gravity, 10.0, phases)


def oscillator(F_k: float = 0.2, c: float = 1.0, stiffness: float = 30.0) -> Parameters:
    return Parameters(M, c, K, stiffness * K, F_k, 0.0, 0.0)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize(
    ("F_k", "c", "stiffness", "x", "v", "w"),
    [
        (0.2, 1.0, 30.0, 5e-3, 0.0, 1.7),
        (0.2, 1.0, 3.0, 5e-3, 0.02, 0.4),  # sticks at the end, and rings
        (0.2, 0.0, 300.0, -5e-3, -0.05, 1.0),
        (0.2, 1.0, 30.0, 5e-3, 0.1, 2.0),  # slips at once
    ],
)
def test_without_further_terms_the_motion_is_exact(order, F_k, c, stiffness, x, v, w):
    """The flow of each phase is then exact; its derivatives are those of differences of exact motions, except near
    events, which a difference moves."""
    times = np.linspace(0.0, 6.0 * PERIOD, 401)[1:]

    def exact(point: np.ndarray) -> np.ndarray:
        F_k, c, rho, m, x, v, w = point.tolist()
        par = Parameters(m, c, K, rho**-2, F_k, 0.0, 0.0)
        rows = np.empty((200, 5))
        count, *_ = run(x, v, (w - 1.0) * F_k / par.K_z, 0.0, times[-1], 0.0, par, rows)
        return states_in_phases(times, rows[:count], 0.0, par)[order]

    point = np.array([F_k, c, (stiffness * K) ** -0.5, M, x, v, w])
    par = oscillator(F_k, c, stiffness)
    found = law_decay(times, order, x, v, w, par, NOTHING, LINEAR_UNKNOWNS)
    expected = exact(point)
    np.testing.assert_allclose(found[:, 0], expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    for j, size in enumerate((0.2, 1.0, point[2], M, 5e-3, 0.05, 1.0)):
        # at the ends of what it may be, and without damping, one side alone is a motion of the model
        step = 1e-6 * size * (-1.0 if DECAY_UNKNOWNS[j] == "w" and w == 2.0 else 1.0)
        moved = point.copy()
        moved[j] += step
        slope = (exact(moved) - expected) / step
        off = np.abs(found[:, 1 + j] - slope) > 1e-3 * np.abs(slope).max() + 1e-9
        assert off.mean() < 0.02, DECAY_UNKNOWNS[j]
    # half of the derivatives are those of all
    every = law_decay(times, order, x, v, w, par, NOTHING, len(DECAY_UNKNOWNS))
    size = np.abs(every).max(axis=0)[: 1 + LINEAR_UNKNOWNS]
    off = np.abs(found - every[:, : 1 + LINEAR_UNKNOWNS]) > 1e-4 * size
    assert off.mean() < 0.01


@pytest.mark.parametrize("F_k", [0.2, 0.0], ids=["friction", "no friction"])
@pytest.mark.parametrize("j", range(2), ids=ADDED[:2])  # the others are no functions of the state
def test_the_motion_is_that_of_an_independent_integrator(j, F_k):
    par, p = oscillator(F_k), NOTHING.copy()
    p[j] = COEFFICIENTS[j]

    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v, f = y
        f = min(max(f, -F_k), F_k)
        force = par.c * v + p[0] * abs(v) * v + par.k * x + p[1] * x**3 + f
        held = F_k == 0.0 or (abs(f) >= F_k and f * v > 0.0)
        return [v, -force / par.m, 0.0 if held else par.K_z * v]

    times = np.linspace(0.0, 5.0 * PERIOD, 201)[1:]
    # kinks of the contact lie within a thousandth of a period
    grid = {"rtol": 1e-9, "atol": 1e-13, "max_step": 1e-3 * PERIOD, "t_eval": times}
    expected = solve_ivp(rate, (0.0, times[-1]), [5e-3, 0.0, F_k], **grid).y[0]
    found = law_decay(times, 0, 5e-3, 0.0, 2.0, par, p, LINEAR_UNKNOWNS)[:, 0]
    moved = found - law_decay(times, 0, 5e-3, 0.0, 2.0, par, NOTHING, LINEAR_UNKNOWNS)[:, 0]
    assert np.abs(moved).max() > 2e-5
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-8)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("j", range(len(ADDED)), ids=ADDED)
def test_derivatives_by_further_coefficients_are_those_of_differences(j, order):
    """To 1e-2 of the largest, by differences that are large beside what another step changes; off the samples between
    two events that a difference moves."""
    par, times = oscillator(), np.linspace(0.0, 4.0 * PERIOD, 401)[1:]
    coefficients, sides = COEFFICIENTS.copy(), []
    # a contact that has not yielded to the end has no rounding: not both
    coefficients[-1 if ADDED[j].startswith("falling") else 2] = 0.0
    for sign in (1.0, -1.0):
        p = coefficients.copy()
        p[j] *= 1.0 + sign * 1e-2
        sides.append(law_decay(times, order, 5e-3, 0.0, 1.5, par, p, LINEAR_UNKNOWNS)[:, 0])
    expected = (sides[0] - sides[1]) / (2e-2 * COEFFICIENTS[j])
    every = law_decay(times, order, 5e-3, 0.0, 1.5, par, coefficients, len(DECAY_UNKNOWNS))
    found = every[:, 1 + LINEAR_UNKNOWNS + j]
    off = np.abs(found - expected) > 1e-2 * np.abs(expected).max()
    assert off.mean() < 0.03


@pytest.mark.parametrize(("preload", "falling"), [(2.0, 0.05), (1.4, 0.05), (2.0, -0.15)])
def test_friction_that_changes_with_the_speed_is_that_of_an_independent_integrator(
    preload, falling
):
    """Of the trials: Runge–Kutta in 8192 steps of a period, the force clipped to its limit, whose kinks between steps
    take 1e-4 of the motion from it with a fall by a quarter of F_k, and more with more. That changes the motion by
    5 % of it."""
    par, rate, p = oscillator(), 40.0 / PERIOD, NOTHING.copy()
    p[2], p[3] = falling, 0.02
    decay = Decay(0, M, 1.0, K, par.K_z, 0.2, (), (), (), (), rate, (), 0.0, 0.0)
    start = np.array([(preload - 1.0) * (0.2 + falling)])
    departure = Departure(falling=falling / 0.2, speed=0.02)
    contact, lasts = one_slider(par.K_z, 0.2), 4.0 * PERIOD
    expected = ring_down_on(contact, decay, 5e-3, 0.0, start, 1.0 / rate, lasts, departure)[0]
    times = np.arange(expected.size) / rate
    found = law_decay(times, 0, 5e-3, 0.0, preload, par, p, LINEAR_UNKNOWNS)[:, 0]
    without = law_decay(times, 0, 5e-3, 0.0, preload, par, NOTHING, LINEAR_UNKNOWNS)[:, 0]
    assert np.abs(found - without).max() > 2e-4
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-5 * abs(falling))


@pytest.mark.parametrize(("A", "F_k"), [(2.0, 0.002), (2.5, 0.0)])
def test_a_pendulum_is_that_of_an_independent_integrator_over_forty_cycles(A, F_k):
    release = Release(A, F_k, c=5e-4)
    par = Parameters(release.m, release.c, release.k, release.K_z, F_k, 0.0, 0.0)
    times, phases = np.arange(1.0, 2000.0) / 45.0, np.full((200, 5), np.nan)
    of = (times, 0, A, 0.0, 2.0, par, NOTHING, LINEAR_UNKNOWNS)
    found = law_decay(*of, gravity=1.0, phases=phases)[:, 0]
    np.testing.assert_allclose(found, release.angles(times), rtol=0, atol=3e-6 * A)
    # each phase begins where its time says
    starts = phases[1:200:7]
    starts = starts[np.isfinite(starts[:, 0])]
    again = law_decay(starts[:, 0], *of[1:], gravity=1.0)[:, 0]
    np.testing.assert_allclose(again, starts[:, 2], rtol=0, atol=3e-6 * A)
