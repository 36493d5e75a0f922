"""Motion under any law against closed forms: exact orbits where the law is linear, turning points, harmonic limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from analytic.cases import SEVERAL_SLIPS, case
from analytic.law_response import _phases, _until_closed, equation, law_orbit
from dampbalance import BaseMotion, NoSteadyOrbit, Oscillator, Regime, steady_orbit, transient
from dampbalance.motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z

# What is asked for is 1e-10 of the motion. Measured: 1e-12 or better.
TOLERANCE = 1e-10

# ζ, ω/ω_n, K_z/k, F_k/kY
REGIMES = {
    (0.6, 1.0, 90.0, 0.14): Regime.ONE_SLIP,
    (0.05, 1.2, 1e6, 0.2): Regime.ONE_SLIP,  # a contact that is all but rigid
    (0.02, 1.0, 2.0, 0.01): Regime.ONE_SLIP,  # large amplitude, hardly damped
    (2.0, 0.7, 30.0, 0.1): Regime.ONE_SLIP,  # over-damped slip phase
    (0.3, 0.7, 20.0, 0.98): Regime.NO_SLIP,
    (0.4, 0.8, 10.0, 0.0): Regime.NO_FRICTION,
    next(iter(SEVERAL_SLIPS)): Regime.SEVERAL_SLIPS,
}


def still(oscillator):
    """A base that all but rests."""
    return BaseMotion(1e-30, oscillator.omega_n)


def run(oscillator, motion, law, end, start=(0.0, 0.0, 0.0), begin=0.0):
    """The rows of the phases from a state (x, ẋ, z) at one time to another, and the state there."""
    eq = equation(oscillator, motion, law)
    rows, pieces = _phases(eq, start, end - begin, motion.omega * begin)
    return np.array(rows) + np.eye(1, 5) * begin, pieces[-1].end


def assert_same_run(found, exact, **scales):
    """Phases, and the end, are those of an exact transient."""
    rows, end = found
    scales = np.array(list(scales.values()))
    at = exact.state(np.append(rows[:, PHASE_T], exact.end))
    expected = np.column_stack([at.x, at.v, at.z])[:, : scales.size]
    seen = np.vstack([rows[:, PHASE_X:], end])[:, : scales.size]
    np.testing.assert_allclose(seen / scales, expected / scales, rtol=0, atol=TOLERANCE)


def turns(rows):
    """The phases that begin with a reversal."""
    return rows[1:][rows[1:, PHASE_V] == 0.0]


def onsets(rows):
    """The phases that begin with an onset of slip."""
    slips = rows[:, PHASE_S] != 0.0
    return rows[1:][slips[1:] & ~slips[:-1]]


def assert_close(one, other, **scales):
    """Each part of two states agrees to 1e-10 of its scale."""
    for name, scale in scales.items():
        parts = getattr(one, name), getattr(other, name)
        np.testing.assert_allclose(*parts, rtol=0, atol=TOLERANCE * scale)


def assert_same_motion(found, orbit, lead=0.0):
    """The motion is that of the orbit, which a base ahead by `lead` (rad) drives."""
    omega = orbit.motion.omega
    t = np.linspace(-1.3, 2.1, 300) * orbit.motion.period
    one, other = found.state(t), orbit.state(t + lead / omega)
    # K_z z is all but a jump where the contact is stiff
    force = orbit.oscillator.k * orbit.X + orbit.oscillator.F_k
    scales = {"x": orbit.X, "v": omega * orbit.X, "z": orbit.oscillator.Z_m}
    assert_close(one, other, **scales, acceleration=force / orbit.oscillator.m)
    assert abs(found.X - orbit.X) < TOLERANCE * orbit.X
    assert abs(np.exp(1j * (found.theta - orbit.theta + lead)) - 1.0) < TOLERANCE


@pytest.mark.parametrize("numbers", REGIMES, ids=str)
def test_friction_and_c_give_the_exact_orbit(numbers):
    oscillator, motion = case(*numbers)
    orbit = steady_orbit(oscillator, motion)
    assert orbit.regime is REGIMES[numbers]
    found = law_orbit(oscillator, motion, {})
    assert_same_motion(found, orbit)
    if oscillator.F_k > 0.0:
        assert found.a == pytest.approx(orbit.a, rel=TOLERANCE)
        assert len(onsets(found.phases)) == np.count_nonzero(
            np.diff(np.abs(orbit.phases[:, 1])) > 0
        )


@pytest.mark.parametrize("numbers", REGIMES, ids=str)
def test_damping_relative_to_the_base_is_another_base(numbers):
    # m ẍ + c_r(ẋ − ẏ) + k(x − y) + … = 0: k y + c_r ẏ drives an oscillator with c = c_r
    oscillator, motion = case(*numbers)
    turn = complex(1.0, motion.omega * oscillator.c / oscillator.k)
    base = replace(motion, Y=motion.Y * abs(turn))
    found = law_orbit(replace(oscillator, c=0.0), motion, {"c_r": oscillator.c})
    assert_same_motion(found, steady_orbit(oscillator, base), np.angle(turn))


@pytest.mark.parametrize("numbers", REGIMES, ids=str)
def test_structural_damping_is_a_damper_at_its_frequency(numbers):
    oscillator, motion = case(*numbers)
    eta = 0.7 * oscillator.c * motion.omega / oscillator.k
    found = law_orbit(replace(oscillator, c=0.3 * oscillator.c), motion, {"eta": eta})
    assert_same_motion(found, steady_orbit(oscillator, motion))


@pytest.mark.parametrize(
    ("symbol", "amplitude"),
    [
        ("c_2", lambda p, force, omega: math.sqrt(3.0 * math.pi * force / (8.0 * p * omega**2))),
        ("c_3", lambda p, force, omega: (4.0 * force / (3.0 * p * omega**3)) ** (1.0 / 3.0)),
    ],
)
def test_the_amplitude_at_resonance_is_that_of_harmonic_balance(symbol, amplitude):
    # ω = ω_n: the damper balances kY. The third harmonic of its force, a third of it or less, meets the impedance 8k:
    # a velocity of Y/8X of the fundamental's at most, and so much less the change of the fundamental.
    oscillator = Oscillator(m=1.0, c=0.0, k=400.0, K_z=4000.0, F_k=0.0)
    motion = BaseMotion(Y=1e-5, omega=20.0)
    p = {"c_2": 0.01, "c_3": 0.05}[symbol]
    expected = amplitude(p, oscillator.k * motion.Y, motion.omega)
    third = motion.Y / 8.0 / expected
    assert third < 1e-4
    found = law_orbit(oscillator, motion, {symbol: p})
    t = np.arange(256) / 256.0 * motion.period
    fundamental = 2.0 * np.mean(found.state(t).x * np.exp(-1j * motion.omega * t))
    assert abs(fundamental) == pytest.approx(expected, rel=third)
    assert np.angle(fundamental) == pytest.approx(-math.pi / 2.0, abs=third)


LAWS = {
    "quadratic": ({"c_2": 60.0}, (0.02, 0.8, 30.0, 0.1)),
    "cubic and relative": ({"c_3": 300.0, "c_r": 9.0}, (0.05, 1.4, 12.0, 0.2)),
    "all, several slips": ({"c_2": 3.0, "c_3": 5.0, "c_r": 2.0, "eta": 0.02}, (0.02, 0.31, 70.0, 0.34)),
    "no friction": ({"c_2": 100.0}, (0.05, 1.0, 5.0, 0.0)),
    "no slip": ({"c_2": 100.0, "c_3": 1e3}, (0.05, 1.1, 5.0, 3.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", LAWS)
def test_a_run_from_rest_ends_on_the_steady_response(name):
    # Newton's method, its derivative and its start do not enter the run
    law, numbers = LAWS[name]
    oscillator, motion = case(*numbers)
    orbit = law_orbit(oscillator, motion, law)
    decay = 2.0 * math.pi * numbers[0] / numbers[1]  # of a period, by c alone
    periods = math.ceil(8.0 / decay) + 1
    end = periods * motion.period
    left = 2.0 * math.exp(-decay * periods) * np.abs(orbit.state(np.linspace(0.0, end, 99)).v).max()
    assert run(oscillator, motion, law, end)[1][1] == pytest.approx(orbit.state(end).v, abs=left)
    # and it repeats, mirrored, after half a period
    begin, state = orbit.theta / motion.omega, orbit.phases[0, PHASE_X:]
    x, v, _ = run(oscillator, motion, law, begin + 0.5 * motion.period, state, begin)[1]
    assert x == pytest.approx(orbit.X, rel=TOLERANCE)
    assert v == pytest.approx(0.0, abs=TOLERANCE * motion.omega * orbit.X)


def test_a_law_that_does_not_damp_at_resonance_has_no_steady_response():
    oscillator, motion = case(0.0, 1.0, 10.0, 0.0)
    with pytest.raises(NoSteadyOrbit, match="add damping"):
        law_orbit(oscillator, motion, {"c_2": 0.0})


def test_phases_begin_at_reversals_and_onsets():
    oscillator, motion = case(*LAWS["quadratic"][1])
    orbit = law_orbit(oscillator, motion, LAWS["quadratic"][0])
    assert list(orbit.phases[:, PHASE_S]) == [0.0, 1.0]
    (onset,) = onsets(orbit.phases)
    assert onset[PHASE_X] == pytest.approx(-orbit.X + 2.0 * oscillator.Z_m, rel=1e-12)
    rows, _ = run(oscillator, motion, orbit.law, 3.0 * motion.period, (0.01, 0.0, 0.0))
    assert len(turns(rows)) == 5
    np.testing.assert_allclose(np.abs(onsets(rows)[:, PHASE_Z]), oscillator.Z_m, rtol=1e-15)


ULPS = np.arange(-4, 5, 2) * np.finfo(float).eps
"""Rounding differs from processor to processor: here units in the last place are added, so that each sees its cases."""


def test_a_reversal_within_rounding_of_the_end_of_a_half_cycle_begins_no_phase():
    (oscillator, motion), law, ends = case(0.02, 0.8, 3.0, 0.1), {"eta": 0.3}, set()
    orbit = law_orbit(oscillator, motion, law)
    begin, state = orbit.theta / motion.omega, orbit.phases[0, PHASE_X:]
    for late in ULPS:
        end = begin + 0.5 * motion.period * (1.0 + late)
        rows, _ = run(oscillator, motion, law, end, state, begin)
        ends.add(len(rows))
        assert [row[PHASE_S] for row in _until_closed(rows, oscillator)] == [0.0, 1.0]
    assert ends > {2}  # some of them did have a phase of rounding at their end


def test_a_reversal_within_rounding_of_the_start_of_the_base_s_period_is_not_missed():
    # undamped above its resonance, the mass reverses with the base, at −X where that is at +Y
    oscillator, motion = case(0.0, 2.0, 10.0, 0.0)
    for more in ULPS:
        moved = replace(motion, Y=motion.Y * (1.0 + more))
        assert_same_motion(law_orbit(oscillator, moved, {}), steady_orbit(oscillator, moved))


def test_turning_points_of_a_quadratic_ring_down():
    # m v dv/dx + k x + c₂v² = 0 from −X_0 to X_1 is linear in v²: e^(aX)(aX − 1) is the same at both, a = 2c₂/m
    m, c_2, start = 2.0, 0.9, -0.5
    oscillator = Oscillator(m=m, c=0.0, k=300.0, K_z=1e4, F_k=0.0)
    rows, _ = run(oscillator, still(oscillator), {"c_2": c_2}, 5.0, (start, 0.0, 0.0))
    a, X = 2.0 * c_2 / m, -start
    for turn in turns(rows)[:8]:
        before = math.exp(-a * X) * (-a * X - 1.0)
        X = brentq(lambda x: math.exp(a * x) * (a * x - 1.0) - before, 0.0, X, xtol=1e-16)  # noqa: B023
        assert abs(turn[PHASE_X]) == pytest.approx(X, rel=1e-11)


def test_a_linear_ring_down_with_friction_is_the_exact_one():
    oscillator, motion = case(0.02, 1.0, 60.0, 0.3)
    end, x, z = 6.0 * motion.period, 5.0 * motion.Y, oscillator.Z_m
    exact = transient(oscillator, still(oscillator), end, x=x, z=z)
    law = {"c_r": oscillator.c}
    found = run(replace(oscillator, c=0.0), still(oscillator), law, end, (x, 0.0, z))
    assert_same_run(found, exact, x=motion.Y, v=motion.Y * motion.omega, z=oscillator.Z_m)


@pytest.mark.parametrize("before", np.linspace(0.5, 0.6, 5))
def test_a_velocity_that_dips_below_zero_within_a_step_is_a_reversal(before):
    # in stick, k + K_z = m = 1: v = cos t − q cos 2t, the base 3q/2 ahead of its displacement, is just below zero for
    # |t| < √(2(q − 1)/3) = 0.01 s; a step lasts 0.05 s
    q, low = 1.00015, math.sqrt(2.0 * 0.00015 / 3.0)
    motion, oscillator = BaseMotion(Y=3.0 * q, omega=2.0), Oscillator(1.0, 0.0, 0.5, 0.5, 2.0)
    x = -math.sin(before) + 0.5 * q * math.sin(2.0 * before)
    v = math.cos(before) - q * math.cos(2.0 * before)
    middle = -0.25 * math.pi  # ωt = −π/2, where the motion has t = 0
    rows, _ = run(oscillator, motion, {}, middle + 0.5, (x, v, x), middle - before)
    first, second = turns(rows)[:, PHASE_T] - middle
    # by the expansion of v to second order, (1 − q) + 3t²/2; the next term is t⁴
    assert first == pytest.approx(-low, rel=1e-3)
    assert second == pytest.approx(low, rel=1e-3)
