"""Studies of oscillators with further damping, and of balances with further terms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.integrals import input_work, of_motion
from analytic.law_response import law_orbit
from dampbalance import BaseMotion, Oscillator
from dampbalance.features import of_orbit
from dampbalance.law.terms import KNOWN_TERMS
from dampbalance.motion.law_steady import steady_response
from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.wording import percent
from dampbalance.studies.parameters import OF_LAW, PARAMETERS
from dampbalance.studies.responses import of_response
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.study_figure import study_figure
from paper_case import PAPER
from studies.documents import document

LEFT_OUT = document("terms")
WITHOUT, WITH = "direct__F_k+c__least_squares", "direct__F_k+c+c_2__least_squares"

LAWS = {
    "c_2": {"c_2": 100.0},
    "c_3": {"c_3": 300.0},
    "c_r": {"c_r": 60.0},
    "eta": {"eta": 0.3},
    "all": {"c_r": 20.0, "c_2": 40.0, "c_3": 50.0, "eta": 0.1},
}


def test_every_term_besides_the_paper_s_two_is_a_parameter_of_the_oscillator():
    assert list(OF_LAW.values()) == [s for s in KNOWN_TERMS if s not in ("F_k", "c")]
    assert all(PARAMETERS[name].kind == "oscillator" for name in OF_LAW)
    assert PARAMETERS["eta"].unit == "1"
    assert PARAMETERS["eta"].symbol == r"\eta"


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("hz", [4.92, 11.1])
def test_features_of_a_response_are_those_of_the_integrated_motion(name, hz):
    """Against the integrator of `analytic/law_response.py`, exact to 1e-12. `steady_response` cuts harmonics off beyond
    the 63rd: measured 5e-8 of X at these levels, so that what follows from X is held to 1e-6; the velocity at the onset
    is where they matter most, 3e-4 of it."""
    motion, law = BaseMotion(0.008, 2.0 * math.pi * hz), LAWS[name]
    found = of_response(steady_response(PAPER, motion, law), motion, PAPER.k, list(KNOWN_TERMS)[2:])
    orbit = law_orbit(PAPER, motion, law)
    ((t_s, X_s, V_s),) = orbit.phases[orbit.phases[:, 1] != 0.0][:, [0, 2, 3]]
    expected = {"X": orbit.X, "X_s": X_s, "V_s": V_s, "t_s": t_s, "a": orbit.a}
    expected |= {"b": of_motion("c", orbit), "W": input_work(orbit)}
    for feature, value in expected.items():
        rel = 1e-3 if feature in ("V_s", "t_s") else 1e-6
        assert getattr(found, feature)[0] == pytest.approx(value, rel=rel), feature
    for symbol, integral in found.integrals.items():
        assert integral[0] == pytest.approx(of_motion(symbol, orbit), rel=1e-6), symbol
    assert set(found.integrals) == {"c_r", "c_2", "c_3", "eta"}
    # x is at its peak at phi, and passes zero upwards at its crossing
    phases = np.array([found.phi[0], found.phi_zero_crossing[0] - 0.5 * math.pi])
    at_peak, at_zero = orbit.state(phases / motion.omega).x
    assert at_peak == pytest.approx(orbit.X, rel=1e-9)
    assert abs(at_zero) < 1e-6 * orbit.X
    # the fundamental of the integrated motion, by the rule of rectangles: 4096 points, an error of 1e-9 at its kinks
    phase = np.arange(4096) * (2.0 * math.pi / 4096)
    x_1 = 2.0 * np.mean(orbit.state(phase / motion.omega).x * np.exp(-1j * phase))
    assert found.X_1[0] == pytest.approx(abs(x_1), rel=1e-6)
    assert found.phi_fundamental[0] == pytest.approx(-np.angle(x_1), abs=1e-6)
    assert found.phi[0] == found.phi_reversal[0]


def test_features_without_further_damping_are_those_of_the_orbit():
    # what is cut off beyond 255 harmonics: 1e-9
    motion = BaseMotion(0.008, 2.0 * math.pi * 3.5)
    found = of_response(steady_response(PAPER, motion, {}), motion, PAPER.k)
    expected = of_orbit(steady_orbit(PAPER, motion))
    assert found.regime[0] == expected.regime[0]
    for name in ("omega", "Y", "X", "X_s", "V_s", "t_s", "a", "b", "W", "X_r", "V_r", "t_r"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-8), name
    for name in ("phi", "phi_zero_crossing", "phi_fundamental", "X_1", "X_3", "X_5"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-7), name


def test_what_only_sticks_has_no_onset_of_slip():
    motion = BaseMotion(0.008, 2.0 * math.pi * 3.5)
    stuck = Oscillator(PAPER.m, PAPER.c, PAPER.k, PAPER.K_z, F_k=1e4)
    found = of_response(steady_response(stuck, motion, {"c_2": 10.0}), motion, stuck.k)
    assert found.regime[0] == of_orbit(steady_orbit(stuck, motion)).regime[0]
    assert np.isnan(found.X_s[0])
    assert np.isfinite(found.X[0])


@pytest.fixture(scope="module")
def done(computed):
    """The study of a term left out, its table of cases, and the file that holds it."""
    return computed(LEFT_OUT | {"figure": {"kind": "curves", "x": "c_2_N_s2_per_m2"}})


def test_a_term_left_out_is_shared_out_and_a_term_taken_in_is_found(done):
    _, table, _ = done
    # without quadratic damping both balances are right; 1e-6 of it is what the responses are computed to
    assert abs(table[f"F_k_relative_error__{WITHOUT}"][0]) < 1e-6
    assert np.isnan(table[f"c_2_relative_error__{WITH}"][0])  # of a true zero
    for symbol in ("F_k", "c", "c_2"):
        assert table[f"{symbol}_relative_error__{WITH}"][1:].abs().max() < 1e-5
    F_k, c = (table[f"{symbol}_relative_error__{WITHOUT}"] for symbol in ("F_k", "c"))
    assert F_k[2] < F_k[1] < -0.1
    assert c[2] > c[1] > 0.03
    np.testing.assert_allclose(table[f"c_2_N_s2_per_m2__{WITH}"], [0.0, 10.0, 100.0], atol=1e-4)
    assert f"c_2_relative_error__{WITHOUT}" not in table


def test_the_error_is_what_the_balance_makes_of_the_work_left_out(done):
    # A p = W of two terms, with W = A p_true + b_2 c_2, from the integrator's motion
    _, table, _ = done
    rows, right = [], []
    for Y in LEFT_OUT["levels_m"]:
        motion = BaseMotion(Y, 2.0 * math.pi * 4.92)
        orbit = law_orbit(PAPER, motion, {"c_2": 100.0})
        rows.append([orbit.a, of_motion("c", orbit)])
        right.append(100.0 * of_motion("c_2", orbit))
    extra = np.linalg.lstsq(np.array(rows), np.array(right))[0]
    errors = [table[f"{s}_relative_error__{WITHOUT}"][2] for s in ("F_k", "c")]
    np.testing.assert_allclose(errors, extra / [PAPER.F_k, PAPER.c], rtol=1e-4)


def test_the_study_separates_the_lists_of_terms(done, says):
    study, table, path = done
    shown = summary.summary_of(path, study)
    assert sorted(set(shown["terms"])) == ["F_k, c", "F_k, c, c_2"]
    assert len(shown) == 5  # two coefficients by the one, three by the other
    page = summary.summary_markdown(study, shown, "", "figure.png")
    assert "| c_2 | direct, F_k, c, c_2 |" in page
    out = table[f"F_k_relative_error__{WITHOUT}"].abs().max()
    within = np.nanmax(table[f"c_2_relative_error__{WITH}"].abs())
    template = """{{ errors("F_k").largest | percent }};
        {{ errors("c_2", terms=["F_k", "c", "c_2"]).largest | percent }}"""
    assert says(study, path, template) == f"{percent(out)}; {percent(within)}"
    panels = study_figure(study, path).axes  # of the first list, without the term: F_k and c
    assert len(panels) == 2
    np.testing.assert_allclose(np.abs(panels[0].lines[0].get_ydata()).max(), 100.0 * out)


def test_fixed_further_damping_is_a_column_and_other_studies_have_none(computed):
    axes = {"axes": [{"frequency_hz": {"values": [4.92, 11.1]}}]}
    _, table, _ = computed(LEFT_OUT | axes | {"base": {"eta": 0.2}})
    assert table["eta"].tolist() == [0.2, 0.2]
    plain, table, _ = computed(axes)
    assert not set(OF_LAW) & set(table.columns)
    assert all(fit.terms == () for fit in plain.fits)


def test_a_case_without_a_steady_response_says_so(computed):
    # a contact that hardly slips, with strong cubic damping: the response is not one of those that are followed
    axes = [{"F_k_N": {"values": [1.28, 300.0]}}]
    base = {"c_3_N_s3_per_m3": 1e3, "frequency_hz": 0.9}
    _, table, _ = computed(LEFT_OUT | {"axes": axes, "base": base})
    assert "one_slip" not in table["regime"][1]
    assert np.isnan(table[f"F_k_relative_error__{WITHOUT}"][1])
