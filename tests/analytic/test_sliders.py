"""Several Jenkins elements in parallel: README.md, section 11."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.cases import SEVERAL_SLIPS, case
from dampbalance import BaseMotion, NoSteadyOrbit, Oscillator, steady_orbit
from dampbalance.motion.events import PHASE_S, PHASE_V
from dampbalance.motion.sliders import MOST_SLIDERS, sliders_orbit
from paper_case import FREQUENCIES_HZ, LEVELS, PAPER, motions_at

# Of the motion. Measured: 1e-13 or better; of the deflection of a contact spring 6e-14 of Z_m.
TOLERANCE = 1e-12
BARE = replace(PAPER, F_k=0.0)
GRADUAL = (np.array([1e-4, 2.5e-4, 7e-4, 5e-3]), np.array([6000.0, 2500.0, 900.0, 300.0]))
SIMPLE = [(0.6, 1.0, 90.0, 0.14), (0.3, 0.7, 20.0, 0.98), (2.0, 0.7, 30.0, 0.1)]


def assert_same(orbit, other):
    """Two orbits move alike, and turn at the same base phase."""
    t = np.linspace(0.0, orbit.motion.period, 501)
    for here, there in zip(orbit.state(t), other.state(t), strict=True):
        np.testing.assert_allclose(here, there, rtol=0, atol=TOLERANCE * np.abs(there).max())
    assert pytest.approx(other.X, rel=TOLERANCE) == orbit.X
    apart = (orbit.theta - other.theta + math.pi) % (2.0 * math.pi) - math.pi
    assert abs(apart) < 1e-9  # a reversal is a maximum: half of its digits are lost at worst


@pytest.mark.parametrize("numbers", [*SIMPLE, *[*SEVERAL_SLIPS][::2]])
def test_one_element_is_the_contact_of_the_paper_and_several_of_one_length_are_one(numbers):
    oscillator, motion = case(*numbers)
    exact, bare = steady_orbit(oscillator, motion), replace(oscillator, F_k=0.0)
    for shares in (np.ones(1), np.array([0.5, 0.3, 0.2])):
        r = np.full(shares.size, oscillator.Z_m)
        orbit = sliders_orbit(bare, motion, r, shares * oscillator.K_z)
        assert_same(orbit, exact)
        assert orbit.friction_loss == pytest.approx(oscillator.F_k * exact.a, rel=1e-11)


def test_the_contact_of_the_oscillator_is_one_of_them():
    (motion,) = motions_at(levels=LEVELS[:1])
    apart = sliders_orbit(PAPER, motion, *GRADUAL)
    r, kappa = (np.append(of, one) for of, one in zip(GRADUAL, (PAPER.Z_m, PAPER.K_z), strict=True))
    assert_same(apart, sliders_orbit(BARE, motion, r, kappa))
    assert len(apart.r) == len(GRADUAL[0]) + 1
    without = sliders_orbit(replace(BARE, K_z=1.0), motion, *GRADUAL)
    assert_same(without, sliders_orbit(BARE, motion, *GRADUAL))  # K_z has no effect without F_k


def test_an_element_that_never_slips_is_a_spring_to_the_ground():
    """k y drives, k + κ pulls back: an oscillator on k + κ, its base at k/(k + κ) of y."""
    (motion,) = motions_at(levels=LEVELS[:1])
    kappa = 700.0
    stiffer = replace(PAPER, k=PAPER.k + kappa)
    smaller = replace(motion, Y=motion.Y * PAPER.k / stiffer.k)
    exact, never = steady_orbit(stiffer, smaller), sliders_orbit(PAPER, motion, 1.0, kappa)
    t = np.linspace(0.0, motion.period, 301)
    for here, there in zip(never.state(t)[:3], exact.state(t)[:3], strict=True):
        np.testing.assert_allclose(here, there, rtol=0, atol=TOLERANCE * np.abs(there).max())
    # nor does the contact where it sticks: the response is linear
    stuck = sliders_orbit(BARE, motion, [1.0, 2.0], [1000.0, 500.0])
    stiffness = PAPER.k + 1500.0 - PAPER.m * motion.omega**2
    x = PAPER.k * motion.Y / complex(stiffness, PAPER.c * motion.omega)
    expected = (x * np.exp(1j * motion.omega * t)).real
    np.testing.assert_allclose(stuck.state(t).x, expected, rtol=0, atol=TOLERANCE * abs(x))
    np.testing.assert_allclose(stuck.state(t).z, expected, rtol=0, atol=TOLERANCE * abs(x))
    assert (stuck.X, stuck.friction_loss) == (pytest.approx(abs(x), rel=TOLERANCE), 0.0)


def several_reversals():
    """An oscillator that reverses several times per half cycle on elements of different lengths."""
    oscillator, motion = case(0.02036, 0.3119, 254.3, 0.07134)
    r = oscillator.Z_m * np.array([0.3, 1.0, 2.0])
    return replace(oscillator, F_k=0.0), motion, r, oscillator.K_z * np.array([0.4, 0.35, 0.25])


CASES = {
    **{f"paper, {name}": (BARE, BaseMotion(0.004, 2.0 * math.pi * hertz), *GRADUAL)
       for name, hertz in FREQUENCIES_HZ.items()},
    "several reversals": several_reversals(),
}  # fmt: skip


@pytest.mark.parametrize("name", ["paper, omega1", "several reversals"])
def test_an_independent_integrator_moves_alike(name):
    """Runge and Kutta's steps through one period from the state of the orbit: the sliders as differential equations,
    z_j held at r_j. An event within a step costs about the square of the step: measured, 3e-7 of the amplitude."""
    o, motion, r, kappa = CASES[name]
    orbit = sliders_orbit(o, motion, r, kappa)

    def rate(t, q):
        z = q[2:]
        force = o.k * (motion.Y * math.cos(motion.omega * t) - q[0]) - o.c * q[1] - kappa @ z
        held = (np.abs(z) >= r) & (z * q[1] > 0.0)
        return np.concatenate([[q[1], force / o.m], np.where(held, 0.0, q[1])])

    q, h = [orbit.phases[0, 2:]], motion.period / 12_000
    times = orbit.theta / motion.omega + h * np.arange(12_001)
    for t in times[:-1]:
        k1 = rate(t, q[-1])
        k2 = rate(t + 0.5 * h, q[-1] + 0.5 * h * k1)
        k3 = rate(t + 0.5 * h, q[-1] + 0.5 * h * k2)
        k4 = rate(t + h, q[-1] + h * k3)
        end = q[-1] + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        q.append(np.append(end[:2], np.clip(end[2:], -r, r)))
    np.testing.assert_allclose(np.array(q)[:, 0], orbit.state(times).x, rtol=0, atol=1e-6 * orbit.X)


@pytest.mark.parametrize("name", CASES)
def test_what_is_put_in_is_lost(name):
    """∮ k y ẋ dt = c ∮ ẋ² dt + what the sliders take, by Gauss's rule over each phase."""
    oscillator, motion, r, kappa = CASES[name]
    orbit = sliders_orbit(oscillator, motion, r, kappa)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    ends = np.append(orbit.phases[:, 0], 0.5 * motion.period)
    W = b = 0.0
    for low, high in itertools.pairwise(ends):
        t = orbit.theta / motion.omega + low + (high - low) * 0.5 * (1.0 + nodes)
        v, of = orbit.state(t).v, (high - low) * weights  # two half cycles, half the interval
        W, b = W + of @ (oscillator.k * motion.y(t) * v), b + of @ v**2
    assert pytest.approx(oscillator.c * b + orbit.friction_loss, rel=1e-12) == W
    if name != "several reversals":
        masing = np.sum(4.0 * kappa * r * np.maximum(orbit.X - r, 0.0))
        assert orbit.friction_loss == pytest.approx(masing, rel=1e-12)
        assert np.count_nonzero(orbit.phases[:, PHASE_S]) == np.count_nonzero(r < orbit.X)
    else:
        assert np.count_nonzero(orbit.phases[:, PHASE_V] == 0.0) > 1


def test_there_is_no_orbit_where_nothing_is_lost():
    osc = Oscillator(m=1.0, c=0.0, k=1000.0, K_z=1.0, F_k=0.0)
    with pytest.raises(NoSteadyOrbit, match="3 sliders"):
        sliders_orbit(osc, BaseMotion(0.001, osc.omega_n), [1e-6, 1e-5, 1e-4], [1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("r", "kappa", "message"),
    [
        ([1e-4, 2e-4], [1.0], r"one length, 1 to 200, got shapes \(2,\) and \(1,\)"),
        ([1e-4] * (MOST_SLIDERS + 1), [1.0] * (MOST_SLIDERS + 1), "1 to 200"),
        ([], [], r"got shapes \(0,\)"),
        (-1e-4, 1.0, "r must be a positive number of m"),
        (1e-4, 0.0, "kappa must be a positive number of N/m"),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(r, kappa, message):
    with pytest.raises(ValueError, match=message):
        sliders_orbit(BARE, motions_at()[0], r, kappa)
