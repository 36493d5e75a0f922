"""The motion in the sets of records as laboratories have them, against closed forms and other integrators."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from blind import field
from blind.cycles import steady_cycle
from blind.other_motion import ring_down
from blind.truths import ANSWERS

SEED = 11
# Kinks cost 6e-6 of the displacement and 5e-5 of the acceleration with 2048 steps a period, measured against 8192.
MOTION, ACCELERATION = 2e-5, 2e-4


def of_kind(kind: str, forced: bool = False, turn: int = 0) -> field.Field:
    """A set of a kind; forced ones are damped more, so that they settle in 40 cycles."""
    kinds = field.FORCED if forced else field.DECAYS
    one = field.draw(kinds.index(kind) + turn * len(kinds), forced, SEED)
    assert one.kind == kind
    return replace(one, c=2.0 * 0.04 * math.sqrt(one.k * one.m)) if forced else one


def signals(one: field.Field, level: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times since the release or phase 0 of the drive, (x, x′, x″) from the release on, and what the sensor adds."""
    t, moved = field.motion(one, level)
    added = field.sensed(one, t, moved, level) - moved[ANSWERS.index(one.answer)]
    after = t > -1e-12
    return t[after], moved[:, after], added[after]


def test_without_a_contact_a_decay_is_the_closed_form():
    one = replace(of_kind(field.CLEAN), K_z=0.0, F_k=0.0, blow=False, X=0.003)
    t, (x, v, _), _ = signals(one)
    delta = one.c / (2.0 * one.m)
    damped = math.sqrt(one.omega_n**2 - delta**2)
    decays = one.X * np.exp(-delta * t)
    exact = decays * (np.cos(damped * t) + delta / damped * np.sin(damped * t))
    # Runge and Kutta of order 4, (2π/2048)⁴ = 1e-10 a radian
    assert np.abs(x - exact).max() < 1e-8 * one.X
    speed = -decays * one.omega_n**2 / damped * np.sin(damped * t)
    assert np.abs(v - speed).max() < 1e-8 * one.X * one.omega_n


def test_a_clean_decay_is_that_of_another_integrator():
    one = replace(of_kind(field.CLEAN), blow=False)
    t, moved, _ = signals(one)
    z = math.copysign(one.F_k / one.K_z, one.X)
    other = ring_down(one, one.X, t[1] - t[0], t[-1] + t[1], z=z)[:, : t.size]
    scale = np.abs(other).max(axis=1)
    assert (np.abs(moved - other).max(axis=1) < [MOTION, MOTION, ACCELERATION] * scale).all()


def test_a_clean_forced_motion_is_the_steady_cycle():
    one = of_kind(field.CLEAN, forced=True)
    t, moved, _ = signals(one)
    Y = one.Y[0]
    numbers = (one.zeta, one.omega / one.omega_n, one.K_z / one.k, one.F_k / (one.k * Y))
    exact = steady_cycle(*numbers).state(one.omega * t) * (Y * one.omega_n ** np.arange(3))[:, None]
    scale = np.abs(exact).max(axis=1)
    late = t > t[0] + 20.0 * 2.0 * math.pi / one.omega  # where the record begins
    errors = np.abs(moved - exact)[:, late].max(axis=1)
    # of the transient e^(−2π (1.5 + 20 · 0.04/1.6)) = 4e-6 is left besides
    assert (errors < [MOTION, MOTION, ACCELERATION] * scale).all()
