"""The rows of each approach, against the integrals they stand for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from dampbalance.balance import (
    APPROACHES,
    Rows,
    direct,
    slip_displacement,
    slip_time,
    slip_velocity,
    slip_velocity_as_printed,
)
from dampbalance.features import of_orbit, single, stack
from dampbalance.model import BaseMotion, Oscillator
from dampbalance.orbit import steady_orbit

K = 2310.0


def harmonic(X, psi, omega=30.0, Y=0.006, phi=1.3):
    """Features of x = X cos(ωt − φ) that begins to slip at the phase ψ = ωt_s after the reversal at −X."""
    return single(
        omega,
        "harmonic",
        Y=Y,
        X=X,
        X_s=-X * math.cos(psi),
        V_s=omega * X * math.sin(psi),
        t_s=psi / omega,
        phi=phi,
    )


amplitudes = st.floats(1e-5, 10.0)
onsets = st.floats(0.0, 1.5)


@given(X=amplitudes, psi=onsets)
def test_harmonic_approaches_agree_on_a_harmonic_motion(X, psi):
    features = harmonic(X, psi)
    rows = [approach(features, K) for name, approach in APPROACHES.items() if name != "direct"]
    for other in rows[1:]:
        # A few roundings, of which the root of 1 − sin²ψ makes up to 1/cos²ψ = 200, but of a term below cos ψ = 0.07.
        assert other.a == pytest.approx(rows[0].a, rel=1e-13)
        assert np.array_equal(other.b, rows[0].b)
        assert np.array_equal(other.W, rows[0].W)


@given(X=amplitudes, psi=onsets, phi=st.floats(0.1, 3.0))
def test_harmonic_rows_are_the_integrals_of_the_balance(X, psi, phi):
    omega, Y = 30.0, 0.006
    t_1 = (phi + math.pi) / omega
    t_2, end = t_1 + math.pi / omega, t_1 + 2.0 * math.pi / omega

    def velocity(t):
        return -omega * X * math.sin(omega * t - phi)

    a, _ = quad(lambda t: 2.0 * abs(velocity(t)), t_1 + psi / omega, t_2)
    b, _ = quad(lambda t: velocity(t) ** 2, t_1, end)
    W, _ = quad(lambda t: K * Y * math.cos(omega * t) * velocity(t), t_1, end)
    rows = slip_time(harmonic(X, psi, omega, Y, phi), K)
    # quad is asked for 1.5e-8 of the integral; on smooth integrands it gives 1e-13. W nearly cancels for φ near 0 and
    # π, hence the comparison with its largest value, π k Y X.
    assert rows.a[0] == pytest.approx(a, rel=1e-12)
    assert rows.b[0] == pytest.approx(b, rel=1e-12)
    assert rows.W[0] == pytest.approx(W, abs=1e-12 * math.pi * K * Y * X)


@given(X=amplitudes)
def test_rigid_contact_is_the_limit_of_every_harmonic_approach(X):
    features = harmonic(X, 0.0)
    for name, approach in APPROACHES.items():
        if name != "direct":
            assert approach(features, K).a[0] == 4.0 * X


@pytest.mark.parametrize("hertz", [3.5, 4.92, 11.1])
def test_direct_rows_of_exact_orbits_close_the_balance(hertz):
    osc = Oscillator(m=2.42, c=90.0, k=K, K_z=208000.0, F_k=1.28)
    omega = 2.0 * math.pi * hertz
    features = stack([of_orbit(steady_orbit(osc, BaseMotion(Y, omega))) for Y in (0.004, 0.012)])
    a, b, W = direct(features, K)
    # The orbit is exact to rounding and the three integrals are closed forms: 1e-12 leaves room for a few hundred ulp.
    assert a * osc.F_k + b * osc.c == pytest.approx(W, rel=1e-12)


def test_direct_and_X_s_share_the_friction_travel_of_an_exact_orbit():
    """∫|ẋ| from slip onset to reversal telescopes to X − X_s, whatever the shape of x(t)."""
    osc = Oscillator(m=2.42, c=90.0, k=K, K_z=208000.0, F_k=1.28)
    features = of_orbit(steady_orbit(osc, BaseMotion(0.008, 2.0 * math.pi * 3.5)))
    assert direct(features, K).a == pytest.approx(slip_displacement(features, K).a, rel=1e-12)


def test_velocity_beyond_a_harmonic_motion_has_no_row():
    features = stack([harmonic(0.01, 0.1), harmonic(0.01, 0.1).replaced(V_s=0.31)])  # ωX = 0.30
    rows = slip_velocity(features, K)
    assert rows.usable.tolist() == [True, False]


def test_missing_feature_makes_the_row_unusable():
    features = harmonic(0.01, 0.1).replaced(X_s=np.nan, V_s=np.nan, t_s=np.nan)
    for name in ("X_s", "t_s", "V_s"):
        assert not APPROACHES[name](features, K).usable[0]


def test_the_slip_of_sign_is_no_approach_and_slides_too_far():
    assert slip_velocity_as_printed not in APPROACHES.values()
    features = harmonic(0.01, 0.1)
    assert slip_velocity_as_printed(features, K).a[0] > 4.0 * 0.01 > slip_velocity(features, K).a[0]


def test_each_approach_reads_its_own_feature_only():
    """A change of X_s, t_s, V_s, or of a, b, W, moves the rows of that approach and of no other."""
    before = harmonic(0.01, 0.1).replaced(a=0.04, b=0.01, W=1.0)
    for changed, affected in {
        "X_s": {"X_s"},
        "t_s": {"t_s"},
        "V_s": {"V_s"},
        "a": {"direct"},
    }.items():
        after = replace(before, **{changed: 0.5 * getattr(before, changed)})
        moved = {n for n, f in APPROACHES.items() if f(after, K).a[0] != f(before, K).a[0]}
        assert moved == affected


def test_rows_are_taken_in_order():
    rows = Rows(*(np.arange(3.0) + 10 * i for i in range(3)))
    assert rows.take([2, 0]).b.tolist() == [12.0, 10.0]
