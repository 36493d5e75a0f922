"""The rows of each approach, against the integrals they stand for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from dampbalance.balance import APPROACHES, Rows, approach, takes_phase
from dampbalance.features import of_numbers, stack
from dampbalance.law.terms import KNOWN_TERMS
from paper_case import FREQUENCIES_HZ, PAPER, features_at

K = PAPER.k
HARMONIC = ("X_s", "t_s", "V_s")


def harmonic(X, psi, omega=30.0, Y=0.006, phi=1.3):
    """Features of x = X cos(ωt − φ) that begins to slip at the phase ψ = ωt_s after the reversal at −X."""
    X_s, V_s = -X * math.cos(psi), omega * X * math.sin(psi)
    return of_numbers(omega, "harmonic", Y=Y, X=X, X_s=X_s, V_s=V_s, t_s=psi / omega, phi=phi)


amplitudes = st.floats(1e-5, 10.0)
onsets = st.floats(0.0, 1.5)


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
    # quad is asked for 1.5e-8 of the integral; on smooth integrands it gives 1e-13. W nearly cancels for φ near 0 and
    # π, hence the comparison with its largest value, π k Y X.
    for name in HARMONIC:
        rows = APPROACHES[name](harmonic(X, psi, omega, Y, phi), K)
        assert rows.terms["F_k"][0] == pytest.approx(a, rel=1e-12)
        assert rows.terms["c"][0] == pytest.approx(b, rel=1e-12)
        assert rows.W[0] == pytest.approx(W, abs=1e-12 * math.pi * K * Y * X)


@given(X=amplitudes)
def test_rigid_contact_is_the_limit_of_every_harmonic_approach(X):
    features = harmonic(X, 0.0)
    for name in (*HARMONIC, "fourier"):
        assert APPROACHES[name](features, K).terms["F_k"][0] == 4.0 * X


def test_a_feature_that_is_missing_or_beyond_a_harmonic_motion_has_no_row():
    features = stack([harmonic(0.01, 0.1), harmonic(0.01, 0.1).replaced(V_s=0.31)])  # ωX = 0.30
    assert APPROACHES["V_s"](features, K).usable.tolist() == [True, False]
    features = harmonic(0.01, 0.1).replaced(X_s=np.nan, V_s=np.nan, t_s=np.nan)
    for name in (*HARMONIC, "fourier"):
        assert not APPROACHES[name](features, K).usable[0]
    assert {name for name in APPROACHES if takes_phase(name)} == {*HARMONIC}
    with pytest.raises(ValueError, match="unknown approach 'mine'; known are direct, X_s"):
        approach("mine")


# --- the Fourier energy balance ----------------------------------------------------------------------


SOFT = replace(PAPER, c=20.0, K_z=9000.0, F_k=6.0)
"""A soft, strong contact, which distorts x: at 2.4 Hz the third harmonic is 4 % of the fundamental."""


@pytest.mark.parametrize(
    ("osc", "hertz"), [(SOFT, 2.4), *((PAPER, hertz) for hertz in FREQUENCIES_HZ.values())]
)
def test_fourier_takes_work_and_friction_travel_exactly(osc, hertz):
    """The work of every other harmonic against y is zero, and ∫|ẋ| from slip onset to reversal telescopes to X − X_s,
    however unlike a sinusoid x(t) is."""
    features = features_at(hertz, (0.004, 0.012), osc)
    assert (features.X_3 / features.X_1).max() > (0.04 if osc is SOFT else 0.0)
    rows = APPROACHES["fourier"](features, K)
    # Both are closed forms of the same orbit: a few hundred roundings.
    assert pytest.approx(features.W, rel=1e-13) == rows.W
    assert rows.terms["F_k"] == pytest.approx(features.a, rel=1e-12)
    np.testing.assert_array_equal(APPROACHES["X_s"](features, K).terms["F_k"], rows.terms["F_k"])


def test_rows_are_indexed_as_arrays():
    """Two rows in their order, or those of a case; weights and covariance go with them, given values stay."""
    a, b, W = (np.arange(6.0).reshape(3, 2) + 10 * i for i in range(3))
    covariance = np.random.default_rng(4).standard_normal((3, 3, 3, 2))
    rows = Rows({"F_k": a, "c": b}, W, weights=W, covariance=covariance, given={"c": 90.0})
    taken = rows[[2, 0]]
    assert taken.terms["c"].tolist() == [[14.0, 15.0], [10.0, 11.0]]
    assert taken.weights.tolist() == taken.W.tolist() == [[24.0, 25.0], [20.0, 21.0]]
    assert taken.given == rows.given
    assert rows[:, 1].terms["F_k"].tolist() == [1.0, 3.0, 5.0]
    np.testing.assert_array_equal(taken.covariance, covariance[:, :, [2, 0]])
    np.testing.assert_array_equal(rows[:, 1].covariance, covariance[:, :, :, 1])
    used = np.array([True, False, True])
    np.testing.assert_array_equal(rows[used].covariance, covariance[:, :, used])


def test_the_misfit_is_what_the_coefficients_leave_of_the_work():
    rows = Rows({"F_k": np.array([1.0, 2.0]), "c": np.array([3.0, 5.0])}, np.array([7.0, 9.0]))
    assert rows.misfit({"F_k": 2.0, "c": 1.0}).tolist() == [-2.0, 0.0]
    of_each = rows[:, None].misfit({"c": np.array([1.0, 2.0]), "F_k": 0.0})  # two estimates at once
    assert of_each.tolist() == [[-4.0, -1.0], [-4.0, 1.0]]


def test_the_scatter_of_replicates_is_their_covariance():
    rng = np.random.default_rng(3)
    a, b, W = rng.standard_normal((3, 4, 200)) * np.array([1e-2, 1e-3, 0.1])[:, None, None] + 1.0
    found = Rows({"F_k": a, "c": b}, W).scatter()
    assert found.shape == (3, 3, 4)
    for i in range(4):
        np.testing.assert_allclose(found[:, :, i], np.cov([a[i], b[i], W[i]]), rtol=1e-12)


def test_fourier_has_the_integrals_that_three_harmonics_tell():
    """∮ h ẋ dt of x = Σ X_n cos(nωt − φ_n): the rectangle rule is exact on a whole period of a trigonometric sum. The
    other terms depend on how the harmonics lie to each other, which the features do not say."""
    omega, Y, amplitudes = 30.0, 0.006, {1: 0.01, 3: 2e-3, 5: 5e-4}
    X = {f"X_{n}": X_n for n, X_n in amplitudes.items()}
    features = of_numbers(omega, "three harmonics", Y=Y, phi_fundamental=1.3, **X)
    t = np.arange(64) * 2.0 * np.pi / (64 * omega)
    v = -sum(n * omega * X_n * np.sin(n * omega * t - 1.3) for n, X_n in amplitudes.items())
    w = -omega * Y * np.sin(omega * t)
    rows = APPROACHES["fourier"](features, K, ("c", "eta", "c_r", "c_2", "c_3"))
    for symbol in ("c", "eta", "c_r"):
        force = KNOWN_TERMS[symbol].force
        work = 2.0 * np.pi / omega * np.mean(force(v, w, K, omega) * v)
        assert rows.terms[symbol][0] == pytest.approx(work, rel=1e-12)
    for symbol in ("c_2", "c_3"):
        assert np.isnan(rows.terms[symbol]).all()
