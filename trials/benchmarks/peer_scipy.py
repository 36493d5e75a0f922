"""Steady states by scipy's DOP853: with events until two half cycles agree, and by shooting over half a period."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from dampbalance import BaseMotion

from .cases import PAPER, Sweep, good_guess, wrapped
from .shooting import broyden

RTOL = 1e-10
AGREE = 1e-10  # relative, of two successive half cycles
MOST_HALF_CYCLES = 400


def _integrate(motion, t, end, x, v, z, s, events=True):
    """Return one phase from (x, ẋ, z) at time t in state s: (t, gain u, ẋ, ∫ẋ² dt, ∫k y ẋ dt) at its end, and whether
    an event ended it."""
    o, Y, omega = PAPER, motion.Y, motion.omega
    kappa, base = (o.k + o.K_z, o.k * x + o.K_z * z) if s == 0 else (o.k, o.k * x + s * o.F_k)

    def rate(t, q):
        drive = o.k * Y * math.cos(omega * t)
        v = q[1]
        return v, (drive - o.c * v - base - kappa * q[0]) / o.m, v * v, drive * v

    sticks = [lambda t, q: z + q[0] - o.Z_m, lambda t, q: -z - q[0] - o.Z_m]
    conditions = sticks if s == 0 else [lambda t, q: -s * q[1]]
    for condition in conditions:
        condition.terminal, condition.direction = True, 1.0
    result = solve_ivp(
        rate,
        (t, end),
        (0.0, v, 0.0, 0.0),
        method="DOP853",
        rtol=RTOL,
        atol=1e-15,
        events=conditions if events else None,
    )
    return float(result.t[-1]), *result.y[:, -1], result.status == 1


def _features(motion, t_0, onset, t_1, x_1, b, W):
    """Return FEATURES of the half cycle from the reversal at t_0 to that at (t_1, x_1), with slip onset (t, x, ẋ)."""
    t, x, v = onset
    phi = wrapped(motion.omega * t_1 + (0.0 if x_1 > 0.0 else math.pi))
    return abs(x_1), abs(v), t - t_0, phi, 2.0 * abs(x_1 - x), 2.0 * b, 2.0 * W


def settle(motion: BaseMotion, t: float, x: float, z: float) -> tuple[float, ...]:
    """Follow the motion, event by event, from rest at (x, z) at time t until two half cycles agree."""
    half = math.pi / motion.omega
    for _ in range(MOST_HALF_CYCLES):
        t_start, x_start = t, x
        t, u, v, b, W, _ = _integrate(motion, t, math.inf, x, 0.0, z, 0)
        x += u
        s = 1 if v > 0.0 else -1
        onset = t, x, v
        t, u, _, slip_b, slip_W, _ = _integrate(motion, t, math.inf, x, v, s * PAPER.Z_m, s)
        x += u
        z = s * PAPER.Z_m
        if abs(x + x_start) <= AGREE * abs(x) and abs(t - t_start - half) <= AGREE * half:
            return _features(motion, t_start, onset, t, x, b + slip_b, W + slip_W)
    raise ArithmeticError(f"not steady after {MOST_HALF_CYCLES} half cycles: {motion}")


def events_from_rest(cases: Sweep) -> np.ndarray:
    return np.array([settle(motion, 0.0, 0.0, 0.0) for motion in cases.motions()])


def events_from_guess(cases: Sweep) -> np.ndarray:
    rows = []
    for motion in cases.motions():
        guess = good_guess(motion)
        rows.append(settle(motion, guess.theta / motion.omega, -guess.X, -PAPER.Z_m))
    return np.array(rows)


def shooting(cases: Sweep) -> np.ndarray:
    rows = []
    for motion in cases.motions():
        guess, omega = good_guess(motion), motion.omega
        half = math.pi / omega

        def half_cycle(u, theta, motion=motion, guess=guess, half=half):
            x, t_0 = -u * guess.X, theta / motion.omega
            t, gain, v, b, W, _ = _integrate(motion, t_0, t_0 + half, x, 0.0, -PAPER.Z_m, 0)
            onset = t, x + gain, v
            _, gain, v, slip_b, slip_W, _ = _integrate(
                motion, t, t_0 + half, onset[1], v, PAPER.Z_m, 1, events=False
            )
            return onset, onset[1] + gain, v, b + slip_b, W + slip_W

        def residual(u, theta, half_cycle=half_cycle, guess=guess, omega=omega):
            _, x, v, _, _ = half_cycle(u, theta)
            return x / guess.X - u, v / (omega * guess.X)

        u, theta = broyden(residual, 1.0, guess.theta, _settled)
        onset, x, _, b, W = half_cycle(u, theta)
        t_0 = theta / omega
        rows.append(_features(motion, t_0, onset, t_0 + half, x, b, W))
    return np.array(rows)


def _settled(f, g):
    return abs(f) <= RTOL and abs(g) <= RTOL
