"""Equations (1) to (7) and (10) to (14) of the paper, each on exact orbits or on a harmonic motion.

The formulas solved for two unknowns, (8) and (15) to (19), are in `test_formulas.py`, the least squares (9) in
`tests/method/test_solver.py`.
"""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.balance import slip_displacement, slip_time, slip_velocity
from dampbalance.features import of_numbers, of_orbit
from dampbalance.motion.orbit import MOST_EVENTS, RANGES
from dampbalance.solver import contact_stiffness
from paper_case import FREQUENCIES_HZ, PAPER, orbits_at


@pytest.fixture(
    params=itertools.product(FREQUENCIES_HZ.values(), (0.004, 0.012)),
    ids=lambda case: f"{case[0]} Hz, {1e3 * case[1]:g} mm",
)
def orbit(request):
    hertz, Y = request.param
    return orbits_at(hertz, [Y])[0]


def phases(orbit):
    """The microstick phase from the reversal t_1 to slip, and the slip phase from there to the reversal t_2."""
    onset = orbit.t_1 + orbit.t_s  # t_s of the orbit counts from the reversal
    return (orbit.t_1, onset), (onset, orbit.t_2)


def integral(orbit, f, start, stop, n=40):
    """∫ f(state, t) dt by Gauss–Legendre; within a phase the motion is analytic: 40 points give it to rounding."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    t = 0.5 * (start + stop) + 0.5 * (stop - start) * nodes
    return 0.5 * (stop - start) * float(np.sum(weights * f(orbit.state(t), t)))


def over_a_period(orbit, f):
    """∫ f(state, t) dt from t_1 to t_1 + T, phase by phase: microstick, slip, and the mirror image of both.

    Good to a few 1e-14 of itself; 1e-11 in the tests leaves room for other machines.
    """
    half, ends = 0.5 * orbit.motion.period, phases(orbit)
    return sum(integral(orbit, f, a + i * half, b + i * half) for i in (0, 1) for a, b in ends)


def test_eq_1_slip_and_eq_2_microstick(orbit):
    """m ẍ + c ẋ + k x + f = k Y cos ωt with f = F_k sgn ẋ in slip and f = K_z z in microstick."""
    for (start, stop), slips in zip(phases(orbit), (False, True), strict=True):
        t = start + (stop - start) * (np.arange(200) + 0.5) / 200  # the ends belong to neither side
        state = orbit.state(t)
        f = PAPER.F_k * np.sign(state.v) if slips else PAPER.K_z * state.z
        force = PAPER.m * state.acceleration + PAPER.c * state.v + PAPER.k * state.x + f
        # Each term is below 2kY or so, and good to a few 1e-15 of that; 1e-12 of kY leaves room.
        rounding = 1e-12 * PAPER.k * orbit.motion.Y
        assert force == pytest.approx(PAPER.k * orbit.motion.y(t), abs=rounding)
        assert np.all(state.v > 0.0)
        assert slips or np.all(np.abs(PAPER.K_z * state.z) < PAPER.F_k)


def test_eq_3_deflection_of_the_contact(orbit):
    """z = Z_m sgn ẋ(t_1⁻) + x − X_t with X_t = −X: before the reversal at −X the mass moves backwards."""
    before = orbit.state(orbit.t_1 - 1e-6 * orbit.motion.period)
    assert before.v < 0.0
    state = orbit.state(np.linspace(*phases(orbit)[0], 200))
    z = PAPER.Z_m * np.sign(before.v) + state.x + orbit.X
    # x − X_t is the difference of two numbers of the size of X, each good to a few 1e-15 of it
    assert state.z == pytest.approx(z, abs=1e-13 * orbit.X)
    assert state.z[-1] == pytest.approx(PAPER.Z_m, abs=1e-13 * orbit.X)


def test_eq_4_and_5_work_of_base_contact_and_damper(orbit):
    """∮ k y ẋ dt = W = ∮ (f + c ẋ) ẋ dt, of which the contact spring returns what it stores: friction works in slip."""
    stick, slip = phases(orbit)
    base = over_a_period(orbit, lambda state, t: PAPER.k * orbit.motion.y(t) * state.v)
    assert base == pytest.approx(orbit.W, rel=1e-11)
    stored = integral(orbit, lambda state, t: PAPER.K_z * state.z * state.v, *stick)
    # from −Z_m to +Z_m; ± F_k Z_m/2 cancel, z is good to 1e-13 X, up to 1e-9 of Z_m = 6 µm at the ends
    assert stored == pytest.approx(0.0, abs=1e-9 * PAPER.F_k * PAPER.Z_m)
    friction = 2.0 * integral(orbit, lambda state, t: PAPER.F_k * np.abs(state.v), *slip)
    damper = over_a_period(orbit, lambda state, t: PAPER.c * state.v**2)
    assert 2.0 * stored + friction + damper == pytest.approx(orbit.W, rel=1e-11)


def test_eq_6_balance_of_the_integrals_of_eq_7(orbit):
    """a = 2 ∫ |ẋ| dt from t_s on, printed t_i, to t_2, and b = ∮ ẋ² dt."""
    assert orbit.a * PAPER.F_k + orbit.b * PAPER.c == pytest.approx(orbit.W, rel=1e-12)
    stick, slip = phases(orbit)
    of_stick, a = (2.0 * integral(orbit, lambda s, t: np.abs(s.v), *of) for of in (stick, slip))
    assert orbit.a == pytest.approx(a, rel=1e-11)
    assert of_stick == pytest.approx(4.0 * PAPER.Z_m, rel=1e-8)  # what t_1 would add
    assert orbit.b == pytest.approx(over_a_period(orbit, lambda s, t: s.v**2), rel=1e-11)


def test_eq_6_closes_wherever_numbers_are_taken_from():
    draw, slipped = random.Random(2010), 0
    for _ in range(200):
        zeta, r, K, F = (
            10 ** draw.uniform(math.log10(low), math.log10(min(high, 1e8)))
            for low, high in RANGES.values()
        )
        if math.sqrt(1.0 + K) / r > 0.1 * MOST_EVENTS:  # slow ones would take most of the time
            continue
        orbit = steady_orbit(Oscillator(1.0, 2.0 * zeta, 1.0, K, F), BaseMotion(1.0, r))
        if orbit.regime is not Regime.NO_SLIP:
            slipped += 1
            spent = orbit.a * F + orbit.b * 2.0 * zeta
            assert abs(orbit.W - spent) <= 1e-6 * spent  # what `check_feasible` lets rounding take
    assert slipped > 50


def test_eq_10_corrected(orbit):
    """K_z = 2F_k/(X_max − X_r) = −2F_k/(X_min − X_s); as printed, (X_max − X_r)/F_k, it is 2/K_z."""
    X_r = of_orbit(orbit).X_r
    for onset in (orbit.X_s, -X_r):
        # 12 µm out of up to 11 mm: 1e-15 · 1000
        stiffness = contact_stiffness(PAPER.F_k, orbit.X, onset)
        assert stiffness == pytest.approx(PAPER.K_z, rel=1e-10)
    assert (orbit.X - X_r) / PAPER.F_k == pytest.approx(2.0 / PAPER.K_z, rel=1e-10)


# ---- The harmonic response: x = X cos(ωt − φ), slip at the phase ψ after the reversal --------------------------------

OMEGA, X, PHI, PSI, Y = 30.0, 0.006, 1.3, 0.08, 0.007
X_S, V_S, T_S = -X * math.cos(PSI), OMEGA * X * math.sin(PSI), PSI / OMEGA
RADICAND = 1.0 - (V_S / (OMEGA * X)) ** 2


@pytest.mark.parametrize(
    ("approach", "travels"),
    [
        # (11): there t_s and t_r are absolute; here they count from the reversals at ωt = φ + π and φ
        (slip_time, [1 - math.cos((PHI + math.pi + PSI) - PHI), 1 + math.cos((PHI + PSI) - PHI)]),
        (slip_velocity, [1 + math.sqrt(RADICAND)]),  # (12)
        (slip_displacement, [1 - X_S / X, 1 + -X_S / X]),  # (13), X_r = −X_s
    ],
)
def test_eq_11_to_14(approach, travels):
    """W_d = 2 F_k X (…) + c π ω X², forward and reverse, and (14): W_a = π k Y X sin φ."""
    onset = {"X_s": X_S, "V_s": V_S, "t_s": T_S, "X_r": -X_S, "V_r": -V_S, "t_r": T_S}
    rows = approach(of_numbers(OMEGA, "harmonic", Y=Y, X=X, phi=PHI, **onset), PAPER.k)
    for travel in travels:
        W_d = 2 * PAPER.F_k * X * travel + PAPER.c * math.pi * OMEGA * X**2
        found = rows.terms["F_k"][0] * PAPER.F_k + rows.terms["c"][0] * PAPER.c
        assert found == pytest.approx(W_d, rel=1e-14)
    assert rows.W[0] == pytest.approx(math.pi * PAPER.k * Y * X * math.sin(PHI), rel=1e-14)
