"""The steady response under any law: exact orbits where it is linear, harmonic limits, and a run from rest."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.cases import SEVERAL_SLIPS, case
from analytic.integrator import integrate
from analytic.law_response import law_orbit
from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.motion.law_response import law_response

# What is asked for is 1e-10 of the motion. Measured: 1e-12 or better.
TOLERANCE = 1e-10

# ζ, ω/ω_n, K_z/k, F_k/kY
REGIMES = {
    (0.6, 1.0, 90.0, 0.14): Regime.ONE_SLIP,
    (0.05, 1.2, 1e6, 0.2): Regime.ONE_SLIP,  # a contact that is all but rigid
    (2.0, 0.7, 30.0, 0.1): Regime.ONE_SLIP,  # over-damped slip phase
    (0.3, 0.7, 20.0, 0.98): Regime.NO_SLIP,
    (0.4, 0.8, 10.0, 0.0): Regime.NO_FRICTION,
    next(iter(SEVERAL_SLIPS)): Regime.SEVERAL_SLIPS,
}


@pytest.mark.parametrize("numbers", REGIMES, ids=str)
def test_linear_terms_give_an_exact_orbit(numbers):
    """η k/ω is a damper at its frequency; c_r(ẋ − ẏ) + k(x − y) the spring and damper of a base k y + c_r ẏ."""
    osc, motion = case(*numbers)
    turn = complex(1.0, motion.omega * osc.c / osc.k)
    eta = 0.7 * osc.c * motion.omega / osc.k
    for c, law, base, lead in (
        (osc.c, {}, motion, 0.0),
        (0.3 * osc.c, {"eta": eta}, motion, 0.0),
        (0.0, {"c_r": osc.c}, replace(motion, Y=motion.Y * abs(turn)), np.angle(turn)),
    ):
        orbit, t = steady_orbit(osc, base), np.linspace(-1.3, 2.1, 300) * motion.period
        assert orbit.regime is REGIMES[numbers] or lead > 0.0  # a larger base
        expected = orbit.state(t + lead / motion.omega)
        # K_z z is all but a jump where the contact is stiff
        force = osc.k * orbit.X + osc.F_k
        scales = [orbit.X, motion.omega * orbit.X, force / osc.m, osc.Z_m]
        for one in (law_orbit, law_response):
            found = one(replace(osc, c=c), motion, law)
            off = [
                np.abs(of - true).max() for of, true in zip(found.state(t), expected, strict=True)
            ]
            assert np.all(off <= TOLERANCE * np.array(scales))
            assert pytest.approx(orbit.X, rel=TOLERANCE) == found.X


@pytest.mark.parametrize(("symbol", "force"), [("c_2", 8.0 / (3.0 * math.pi)), ("c_3", 3.0 / 4.0)])
def test_the_amplitude_at_resonance_is_that_of_harmonic_balance(symbol, force):
    # ω = ω_n: the dampers balance kY at a velocity of 1 m/s. The third harmonic of their force, a third of it or less,
    # meets the impedance 8k: a velocity of Y/8X of the fundamental's at most, and so much less the fundamental.
    oscillator = Oscillator(m=1.0, c=0.2, k=400.0, K_z=4000.0, F_k=0.0)
    p, X = 0.3, 1.0 / oscillator.omega_n
    motion = BaseMotion(Y=(oscillator.c + force * p) / oscillator.k, omega=oscillator.omega_n)
    third = motion.Y / 8.0 / X
    assert third < 4e-3
    for one in (law_orbit, law_response):
        t = np.arange(256) / 256.0 * motion.period
        x = one(oscillator, motion, {symbol: p}).state(t).x
        fundamental = 2.0 * np.mean(x * np.exp(-1j * motion.omega * t))
        assert abs(fundamental) == pytest.approx(X, rel=third)
        assert np.angle(fundamental) == pytest.approx(-math.pi / 2.0, abs=third)


@pytest.mark.parametrize(
    ("law", "numbers"),
    [
        ({"c_2": 300.0}, (0.3, 0.8, 30.0, 0.1)),
        ({"c_3": 3000.0, "c_r": 9.0}, (0.4, 1.4, 12.0, 0.2)),
        ({"c_2": 100.0, "c_3": 1e3}, (0.3, 1.1, 5.0, 3.0)),  # nothing slips
    ],
    ids=["quadratic", "cubic and relative", "no slip"],
)
def test_a_run_from_rest_ends_on_the_steady_response(law, numbers):
    # nothing of the response enters the run; 24 time constants of c alone leave 4e-11 of the start
    oscillator, motion = case(*numbers)
    end = motion.period * math.ceil(24.0 * numbers[1] / (2.0 * math.pi * numbers[0]))
    run, state = integrate(oscillator, motion, end, law=law), law_response(oscillator, motion, law)
    x, v, _, z = state.state(end)
    assert run.x == pytest.approx(x, rel=0, abs=1e-9 * state.X)
    assert run.v == pytest.approx(v, rel=0, abs=1e-9 * motion.omega * state.X)
    assert run.z == pytest.approx(z, rel=0, abs=1e-9 * state.X)
