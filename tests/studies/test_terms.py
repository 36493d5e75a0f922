"""Studies of oscillators with further damping, and of balances with further terms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.integrals import input_work, of_motion
from analytic.law_response import law_orbit
from dampbalance import BaseMotion, Oscillator
from dampbalance.features import FEATURE_COLUMNS, of_orbit
from dampbalance.law.terms import KNOWN_TERMS
from dampbalance.motion.law_steady import steady_response
from dampbalance.motion.orbit import steady_orbit
from dampbalance.studies.parameters import OF_LAW
from dampbalance.studies.responses import of_response
from dampbalance.studies.shown import summary
from paper_case import PAPER
from studies.documents import document

WITHOUT, WITH = "direct__F_k+c__least_squares", "direct__F_k+c+c_2__least_squares"


@pytest.mark.parametrize(
    ("hz", "law"),
    [
        (4.92, {"c_2": 100.0}),
        (11.1, {"c_3": 300.0}),
        (11.1, {"c_r": 20.0, "c_2": 40.0, "c_3": 50.0, "eta": 0.1}),
    ],
)
def test_features_of_a_response_are_those_of_the_integrated_motion(hz, law):
    """Against the integrator of `analytic/law_response.py`, exact to 1e-12. `steady_response` cuts harmonics off beyond
    the 63rd: measured 5e-8 of X at these levels, so that what follows from X is held to 1e-6; the velocity at the onset
    is where they matter most, 3e-4 of it."""
    motion = BaseMotion(0.008, 2.0 * math.pi * hz)
    found = of_response(steady_response(PAPER, motion, law), motion, PAPER.k, list(KNOWN_TERMS)[2:])
    orbit = law_orbit(PAPER, motion, law)
    ((t_s, X_s, V_s),) = orbit.phases[orbit.phases[:, 1] != 0.0][:, [0, 2, 3]]
    expected = {"X": orbit.X, "X_s": X_s, "V_s": V_s, "t_s": t_s, "a": orbit.a}
    expected |= {"b": of_motion("c", orbit), "W": input_work(orbit)}
    for feature, value in expected.items():
        rel = 1e-3 if feature in ("V_s", "t_s") else 1e-6
        assert getattr(found, feature)[0] == pytest.approx(value, rel=rel), feature
    assert set(found.integrals) == {"c_r", "c_2", "c_3", "eta"}
    for symbol, integral in found.integrals.items():
        assert integral[0] == pytest.approx(of_motion(symbol, orbit), rel=1e-6), symbol
    # x is at its peak at phi; the other phases and harmonics come the same way without further damping
    at_peak = orbit.state(found.phi / motion.omega).x
    assert at_peak == pytest.approx(orbit.X, rel=1e-9)


@pytest.mark.parametrize("F_k", [PAPER.F_k, 1e4])
def test_features_without_further_damping_are_those_of_the_orbit(F_k):
    osc = Oscillator(PAPER.m, PAPER.c, PAPER.k, PAPER.K_z, F_k)
    motion = BaseMotion(0.008, 2.0 * math.pi * 3.5)
    found = of_response(steady_response(osc, motion, {}), motion, PAPER.k)
    expected = of_orbit(steady_orbit(osc, motion))
    assert found.regime[0] == expected.regime[0]
    for name in ("omega", *FEATURE_COLUMNS):
        # what is cut off beyond 255 harmonics: 1e-9, and more in a phase
        within = {"rel": 1e-7 if name.startswith(("phi", "X_")) else 1e-8, "abs": 1e-12}
        assert getattr(found, name) == pytest.approx(getattr(expected, name), nan_ok=True, **within)


def test_a_term_left_out_is_shared_out_and_a_term_taken_in_is_found(computed):
    study, table, path = computed("terms")
    # without quadratic damping both balances are right; 1e-6 of it is what the responses are computed to
    assert abs(table[f"F_k_relative_error__{WITHOUT}"][0]) < 1e-6
    assert np.isnan(table[f"c_2_relative_error__{WITH}"][0])  # of a true zero
    for symbol in ("F_k", "c", "c_2"):
        assert table[f"{symbol}_relative_error__{WITH}"][1:].abs().max() < 1e-5
    np.testing.assert_allclose(table[f"c_2_N_s2_per_m2__{WITH}"], [0.0, 10.0, 100.0], atol=1e-4)
    assert f"c_2_relative_error__{WITHOUT}" not in table
    # A p = W of two terms, with W = A p_true + b_2 c_2, from the integrator's motion
    motions = [BaseMotion(Y, 2.0 * math.pi * 4.92) for Y in study.levels]
    orbits = [law_orbit(PAPER, motion, {"c_2": 100.0}) for motion in motions]
    *rows, c_2 = np.array([[of.a, of_motion("c", of), of_motion("c_2", of)] for of in orbits]).T
    extra = np.linalg.lstsq(np.transpose(rows), 100.0 * c_2)[0]
    errors = [table[f"{s}_relative_error__{WITHOUT}"][2] for s in ("F_k", "c")]
    np.testing.assert_allclose(errors, extra / [PAPER.F_k, PAPER.c], rtol=1e-4)
    # two coefficients by the one list of terms, three by the other
    counts = summary.summary_of(path, study)["terms"].value_counts()
    assert counts.to_dict() == {"F_k, c": 2, "F_k, c, c_2": 3}


def test_fixed_further_damping_is_a_column_and_other_studies_have_none(computed):
    axes = {"axes": [{"frequency_hz": {"values": [4.92, 11.1]}}]}
    _, table, _ = computed(document("terms") | axes | {"base": {"eta": 0.2}})
    assert table["eta"].tolist() == [0.2, 0.2]
    plain, table, _ = computed(axes)
    assert not set(OF_LAW) & set(table.columns)
    assert all(fit.terms == () for fit in plain.fits)


def test_a_case_without_a_steady_response_says_so(computed):
    # a contact that hardly slips, with strong cubic damping: the response is not one of those that are followed
    axes = [{"F_k_N": {"values": [1.28, 300.0]}}]
    base = {"c_3_N_s3_per_m3": 1e3, "frequency_hz": 0.9}
    _, table, _ = computed(document("terms") | {"axes": axes, "base": base})
    assert "one_slip" not in table["regime"][1]
    assert np.isnan(table[f"F_k_relative_error__{WITHOUT}"][1])
