"""Equations (1) to (7) and (10) to (14) of the paper, each on exact orbits or on a harmonic motion.

The formulas solved for two unknowns, (8) and (15) to (19), are in `test_formulas.py`, the least squares (9) in
`tests/method/test_solver.py`.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from dampbalance.balance import slip_displacement, slip_time, slip_velocity
from dampbalance.features import of_numbers, of_orbit
from dampbalance.model import BaseMotion
from dampbalance.motion.orbit import steady_orbit
from dampbalance.solver import contact_stiffness
from paper_case import FREQUENCIES_HZ
from replication.routes import PAPER

CASES = [(hertz, Y) for hertz in FREQUENCIES_HZ.values() for Y in (0.004, 0.012)]


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0]} Hz, {1e3 * case[1]:g} mm")
def orbit(request):
    hertz, Y = request.param
    return steady_orbit(PAPER, BaseMotion(Y, 2.0 * math.pi * hertz))


def onset(orbit):
    """The instant of forward slip, absolute: t_s of the orbit counts from the reversal t_1."""
    return orbit.t_1 + orbit.t_s


def inside(start, stop, n=200):
    """Times strictly between two events, which belong to neither side."""
    return start + (stop - start) * (np.arange(n) + 0.5) / n


def forces(orbit, t):
    """State at t and m ẍ + c ẋ + k x − k Y cos ωt, what the contact has to provide; m ẍ is the scale of rounding."""
    state = orbit.state(t)
    drive = PAPER.k * orbit.motion.y(t)
    rest = PAPER.m * state.acceleration + PAPER.c * state.v + PAPER.k * state.x - drive
    # Each term is below 2kY or so, and good to a few 1e-15 of that; 1e-12 of kY leaves room.
    return state, rest, 1e-12 * PAPER.k * orbit.motion.Y


def integral(f, start, stop, n=40):
    """∫ f dt by Gauss–Legendre; within a phase the motion is analytic, and 40 points give it to rounding."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    t = 0.5 * (start + stop) + 0.5 * (stop - start) * nodes
    return 0.5 * (stop - start) * float(np.sum(weights * f(t)))


def over_a_period(orbit, f):
    """∫ f dt from t_1 to t_1 + T, phase by phase: microstick, slip, and the mirror image of both.

    Good to a few 1e-14 of itself; 1e-11 in the tests leaves room for other machines.
    """
    half = 0.5 * orbit.motion.period
    edges = [orbit.t_1, onset(orbit), orbit.t_1 + half, onset(orbit) + half, orbit.t_1 + 2 * half]
    return sum(integral(f, start, stop) for start, stop in itertools.pairwise(edges))


def contact_force(state, slipping):
    """f: F_k sgn ẋ in slip, K_z z in microstick."""
    return np.where(slipping, PAPER.F_k * np.sign(state.v), PAPER.K_z * state.z)


def test_eq_1_slip(orbit):
    t = inside(onset(orbit), orbit.t_2)
    state, rest, rounding = forces(orbit, t)
    assert np.all(state.v > 0.0)
    assert rest + PAPER.F_k * np.sign(state.v) == pytest.approx(0.0, abs=rounding)


def test_eq_2_microstick(orbit):
    t = inside(orbit.t_1, onset(orbit))
    state, rest, rounding = forces(orbit, t)
    assert rest + PAPER.K_z * state.z == pytest.approx(0.0, abs=rounding)
    assert np.all(np.abs(PAPER.K_z * state.z) < PAPER.F_k)


def test_eq_3_deflection_of_the_contact(orbit):
    """z = Z_m sgn ẋ(t_1⁻) + x − X_t with X_t = −X: before the reversal at −X the mass moves backwards."""
    before = orbit.state(orbit.t_1 - 1e-6 * orbit.motion.period)
    assert before.v < 0.0
    state = orbit.state(inside(orbit.t_1, onset(orbit)))
    z = PAPER.Z_m * np.sign(before.v) + state.x + orbit.X
    # x − X_t is the difference of two numbers of the size of X, each good to a few 1e-15 of it
    assert state.z == pytest.approx(z, abs=1e-13 * orbit.X)
    assert orbit.state(onset(orbit)).z == pytest.approx(PAPER.Z_m, abs=1e-13 * orbit.X)


def test_eq_4_work_of_contact_and_damper(orbit):
    """∮ f ẋ dt + ∮ c ẋ² dt, with the stored energy of the contact spring in it, is the work of the base."""
    half = 0.5 * orbit.motion.period

    def power(t):
        state = orbit.state(t)
        since = np.mod(t - orbit.t_1, half)
        return contact_force(state, since > orbit.t_s) * state.v + PAPER.c * state.v**2

    assert over_a_period(orbit, power) == pytest.approx(orbit.W, rel=1e-11)


def test_eq_5_the_contact_spring_returns_what_it_stores(orbit):
    """Over the microstick phase ∫ K_z z ẋ dt is nil: from −Z_m to +Z_m. So friction works in slip only."""

    def spring(t):
        state = orbit.state(t)
        return PAPER.K_z * state.z * state.v

    stored = integral(spring, orbit.t_1, onset(orbit))
    # ± F_k Z_m/2 cancel; z is good to 1e-13 X, which is up to 1e-9 of Z_m = 6 µm at the ends
    assert stored == pytest.approx(0.0, abs=1e-9 * PAPER.F_k * PAPER.Z_m)

    def friction(t):
        state = orbit.state(t)
        return 2.0 * PAPER.F_k * state.v * np.sign(state.v)

    dissipated = integral(friction, onset(orbit), orbit.t_2) + PAPER.c * orbit.b
    assert dissipated == pytest.approx(orbit.W, rel=1e-11)


def test_eq_5_input_work(orbit):
    work = over_a_period(orbit, lambda t: PAPER.k * orbit.motion.y(t) * orbit.state(t).v)
    assert pytest.approx(work, rel=1e-11) == orbit.W


def test_eq_6_balance(orbit):
    assert orbit.a * PAPER.F_k + orbit.b * PAPER.c == pytest.approx(orbit.W, rel=1e-12)


def test_eq_7a_friction_travel(orbit):
    """The lower limit, printed t_i, is t_s."""
    a = 2.0 * integral(lambda t: np.abs(orbit.state(t).v), onset(orbit), orbit.t_2)
    assert orbit.a == pytest.approx(a, rel=1e-11)
    from_reversal = 2.0 * integral(lambda t: np.abs(orbit.state(t).v), orbit.t_1, onset(orbit))
    assert from_reversal == pytest.approx(4.0 * PAPER.Z_m, rel=1e-8)  # what t_1 would add


def test_eq_7b_viscous_integral(orbit):
    assert orbit.b == pytest.approx(
        over_a_period(orbit, lambda t: orbit.state(t).v ** 2), rel=1e-11
    )


def test_eq_10_corrected(orbit):
    """K_z = 2F_k/(X_max − X_r) = −2F_k/(X_min − X_s); as printed, (X_max − X_r)/F_k, it is 2/K_z."""
    features = of_orbit(orbit)
    forward = contact_stiffness(PAPER.F_k, orbit.X, orbit.X_s)
    reverse = contact_stiffness(PAPER.F_k, orbit.X, -features.X_r)
    # 12 µm out of up to 11 mm: 1e-15 · 1000
    assert forward == pytest.approx(PAPER.K_z, rel=1e-10)
    assert reverse == pytest.approx(PAPER.K_z, rel=1e-10)
    as_printed = (orbit.X - features.X_r) / PAPER.F_k
    assert as_printed == pytest.approx(2.0 / PAPER.K_z, rel=1e-10)


# ---- The harmonic response: x = X cos(ωt − φ), slip at the phase ψ after the reversal --------------------------------

OMEGA, X, PHI, PSI, Y = 30.0, 0.006, 1.3, 0.08, 0.007
F_K, C, K = PAPER.F_k, PAPER.c, PAPER.k


@pytest.fixture
def harmonic():
    return of_numbers(
        OMEGA,
        "harmonic",
        Y=Y,
        X=X,
        X_s=-X * math.cos(PSI),
        V_s=OMEGA * X * math.sin(PSI),
        t_s=PSI / OMEGA,
        X_r=X * math.cos(PSI),
        V_r=-OMEGA * X * math.sin(PSI),
        t_r=PSI / OMEGA,
        phi=PHI,
    )


def dissipated(rows):
    return rows.terms["F_k"][0] * F_K + rows.terms["c"][0] * C


def test_eq_11_with_absolute_times(harmonic):
    """There t_s and t_r are absolute; here they count from the reversals at ωt = φ + π and φ."""
    t_s, t_r = (PHI + math.pi + PSI) / OMEGA, (PHI + PSI) / OMEGA
    forward = 2 * F_K * X * (1 - math.cos(OMEGA * t_s - PHI)) + C * math.pi * OMEGA * X**2
    reverse = 2 * F_K * X * (1 + math.cos(OMEGA * t_r - PHI)) + C * math.pi * OMEGA * X**2
    assert dissipated(slip_time(harmonic, K)) == pytest.approx(forward, rel=1e-14)
    assert dissipated(slip_time(harmonic, K)) == pytest.approx(reverse, rel=1e-14)


def test_eq_12(harmonic):
    for V in (harmonic.V_s[0], harmonic.V_r[0]):
        root = math.sqrt((OMEGA * X) ** 2 - V**2)
        W_d = 2 * F_K * X * (1 + root / (OMEGA * X)) + C * math.pi * OMEGA * X**2
        assert dissipated(slip_velocity(harmonic, K)) == pytest.approx(W_d, rel=1e-14)


def test_eq_13(harmonic):
    forward = 2 * F_K * (X - harmonic.X_s[0]) + C * math.pi * OMEGA * X**2
    reverse = 2 * F_K * (X + harmonic.X_r[0]) + C * math.pi * OMEGA * X**2
    assert dissipated(slip_displacement(harmonic, K)) == pytest.approx(forward, rel=1e-14)
    assert dissipated(slip_displacement(harmonic, K)) == pytest.approx(reverse, rel=1e-14)


def test_eq_14(harmonic):
    W_a = math.pi * K * Y * X * math.sin(PHI)
    for approach in (slip_displacement, slip_time, slip_velocity):
        assert approach(harmonic, K).W[0] == pytest.approx(W_a, rel=1e-14)
