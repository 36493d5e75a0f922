"""Limits with a closed form of their own: README.md, sections 4–6."""

from __future__ import annotations

import math

import pytest

from analytic.cases import case
from dampbalance import BaseMotion, NoSteadyOrbit, Oscillator, Regime, steady_orbit

ROUNDING = 1e-14  # a closed form against another closed form: some 50 units of rounding


def linear(oscillator, motion, kappa):
    """Amplitude and lag of m ẍ + c ẋ + κ x = kY cos ωt."""
    reactance = kappa - oscillator.m * motion.omega**2
    resistance = oscillator.c * motion.omega
    X = oscillator.k * motion.Y / math.hypot(reactance, resistance)
    return X, math.atan2(resistance, reactance)


def check_harmonic(orbit, X, phi):
    """The orbit is X cos(ωt − φ)."""
    k, Y, omega = orbit.oscillator.k, orbit.motion.Y, orbit.motion.omega
    assert pytest.approx(X, rel=ROUNDING) == orbit.X
    for name in ("phi", "phi_zero_crossing"):
        assert getattr(orbit, name) == pytest.approx(phi, rel=0, abs=ROUNDING)
    assert orbit.harmonic(1) == pytest.approx((X, phi), rel=ROUNDING, abs=ROUNDING)
    for n in (3, 5):
        assert orbit.harmonic(n)[0] == pytest.approx(0.0, abs=ROUNDING * X)
    assert orbit.b == pytest.approx(math.pi * omega * X**2, rel=ROUNDING)
    assert pytest.approx(math.pi * k * Y * X * math.sin(phi), rel=ROUNDING) == orbit.W
    for turns in (0.0, 0.1, 0.7, 12.3):
        t = turns * orbit.motion.period
        state, angle = orbit.state(t), omega * t - phi
        # the rounding of ωt grows with t
        error = ROUNDING * (1.0 + turns)
        assert float(state.x) == pytest.approx(X * math.cos(angle), rel=0, abs=error * X)
        assert float(state.v) == pytest.approx(
            -omega * X * math.sin(angle), rel=0, abs=error * omega * X
        )


@pytest.mark.parametrize("zeta", [0.02, 0.6, 1.0, 3.0])
@pytest.mark.parametrize("r", [0.3, 1.0, 2.5])
def test_no_friction_is_the_linear_oscillator(zeta, r):
    oscillator, motion = case(zeta, r, 90.0, 0.0)
    orbit = steady_orbit(oscillator, motion)
    assert orbit.regime is Regime.NO_FRICTION
    check_harmonic(orbit, *linear(oscillator, motion, oscillator.k))
    assert orbit.a == pytest.approx(4.0 * orbit.X, rel=ROUNDING)
    assert orbit.X_s == -orbit.X  # the contact gives way at once
    assert (orbit.t_s, orbit.V_s) == (0.0, 0.0)


@pytest.mark.parametrize("zeta", [0.02, 0.6, 3.0])
@pytest.mark.parametrize("r", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("excess", [1.0 + 1e-12, 1.5, 1e6])
def test_no_slip_is_the_linear_oscillator_on_both_springs(zeta, r, excess):
    oscillator, motion = case(zeta, r, 20.0, 1.0)
    X, phi = linear(oscillator, motion, oscillator.k + oscillator.K_z)
    F_k = excess * oscillator.K_z * X  # the spring force of the linear motion is at most K_z X
    held = Oscillator(m=oscillator.m, c=oscillator.c, k=oscillator.k, K_z=oscillator.K_z, F_k=F_k)
    orbit = steady_orbit(held, motion)
    assert orbit.regime is Regime.NO_SLIP
    check_harmonic(orbit, X, phi)
    assert orbit.a == 0.0
    assert all(math.isnan(value) for value in (orbit.X_s, orbit.V_s, orbit.t_s))
    assert float(orbit.state(0.3).z) == float(orbit.state(0.3).x)


# --- rigid contact: Den Hartog (1931) ------------------------------------------------------------

RIGID = [(0.6, 1.0, 0.14), (0.1, 0.8, 0.1), (1.5, 0.9, 0.05), (0.05, 1.3, 0.3)]  # ζ, ω/ω_n, F_k/kY


def den_hartog(oscillator, motion):
    """(X, θ, R) of the non-stop motion with a rigid contact; R is the force on the mass just before its reversal at −X.

    Derived in README.md, section 6.
    """
    m, c, k, F_k = oscillator.m, oscillator.c, oscillator.k, oscillator.F_k
    omega, delta, H = motion.omega, c / (2.0 * m), math.pi / motion.omega
    sigma2 = k / m - delta * delta
    sigma = math.sqrt(abs(sigma2))
    sine, cosine = (
        (math.sin(sigma * H) / sigma, math.cos(sigma * H))
        if sigma2 > 0.0
        else (math.sinh(sigma * H) / sigma, math.cosh(sigma * H))
    )
    denominator = math.cosh(delta * H) + cosine
    A = (math.sinh(delta * H) - delta * sine) / denominator
    B = k / m * sine / (omega * denominator)
    G, psi = linear(oscillator, motion, k)
    X = -A * F_k / k + math.sqrt(G**2 - (B * F_k / k) ** 2)
    theta = psi + math.atan2(B * F_k / k, -X - A * F_k / k)
    return X, theta, k * X + k * motion.Y * math.cos(theta) + F_k


@pytest.mark.parametrize(("zeta", "r", "F"), RIGID)
def test_rigid_contact_is_den_hartogs_solution(zeta, r, F):
    def miss(K):
        oscillator, motion = case(zeta, r, K, F)
        orbit = steady_orbit(oscillator, motion)
        X, theta, _ = den_hartog(oscillator, motion)
        turn = math.remainder(orbit.theta - theta, 2.0 * math.pi)
        return orbit.X / X - 1.0, turn, orbit.a / (4.0 * X) - 1.0

    # The stick phase lasts a time ∝ K_z^(−1/2), by which the change of sign of the friction force is late: order ½.
    softer, stiffer = miss(1e6), miss(1e8)
    for before, after in zip(softer, stiffer, strict=True):
        order = math.log(before / after) / math.log(1e2)
        assert order == pytest.approx(0.5, abs=0.005)  # the next term is of order 1
        # extrapolated to a rigid contact, what is left is of order 1/K_z times coefficients of some tens
        assert (10.0 * after - before) / 9.0 == pytest.approx(0.0, abs=1e-5 * abs(before) + 1e-7)

    # During so short a stick the force R on the mass is constant: u = (R/K_z)(1 − cos Ωt) reaches 2F_k/K_z at
    # t_s = √(m/K_z) arccos(1 − 2F_k/R). The relative error is of the order of ωt_s, 1e-4.
    oscillator, motion = case(zeta, r, 1e8, F)
    orbit, (_, _, R) = steady_orbit(oscillator, motion), den_hartog(oscillator, motion)
    expected = math.sqrt(oscillator.m / oscillator.K_z) * math.acos(1.0 - 2.0 * oscillator.F_k / R)
    assert orbit.t_s == pytest.approx(expected, rel=5e-4)
    assert orbit.X + orbit.X_s == pytest.approx(2.0 * oscillator.Z_m, rel=1e-6)  # K_z cancels


# --- no viscous damping, at resonance ------------------------------------------------------------


def undamped(F_k, *, k=1.0, K_z=10.0, omega=1.0):
    return steady_orbit(
        Oscillator(m=1.0, c=0.0, k=k, K_z=K_z, F_k=F_k), BaseMotion(Y=1.0, omega=omega)
    )


def test_friction_holds_the_resonance_from_pi_quarters_on():
    # At ω = ω_n, per cycle: work at most πkYX, friction 4F_k(X − Z_m). Below F_k = πkY/4 nothing stops the growth.
    for F_k in (0.0, 0.3, math.pi / 4 - 1e-3):
        with pytest.raises(NoSteadyOrbit, match="no steady orbit found"):
            undamped(F_k)
    amplitudes = [undamped(math.pi / 4 + excess).X for excess in (1e-2, 1e-1, 0.2)]
    assert amplitudes == sorted(amplitudes, reverse=True)
    # through every regime
    assert undamped(0.79).regime is Regime.ONE_SLIP
    assert undamped(0.85).regime is Regime.SEVERAL_SLIPS
    held = undamped(1.1)
    assert held.regime is Regime.NO_SLIP
    assert pytest.approx(0.1, rel=ROUNDING) == held.X  # kY / K_z


@pytest.mark.parametrize(
    ("k", "K_z", "omega"), [(1.0, 3.0, 2.0), (9.0, 10.0, 1.0), (25.0, 10.0, 1.0)]
)
def test_a_resonance_of_the_free_motion_is_harmless(k, K_z, omega):
    # ω² = (k + K_z)/m in stick; ω = ω_n/3 and ω_n/5 in slip, the frequency of a harmonic, whose integral is no quotient
    orbit = undamped(0.3, k=k, K_z=K_z, omega=omega)
    beside = undamped(0.3, k=k, K_z=K_z, omega=omega * (1.0 + 1e-9))
    for name in ("X", "a", "b", "W"):
        assert getattr(orbit, name) == pytest.approx(getattr(beside, name), rel=1e-6)
    assert pytest.approx(orbit.a * 0.3, rel=1e-11) == orbit.W
