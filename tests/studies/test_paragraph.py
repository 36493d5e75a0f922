"""Paragraphs of studies: their numbers, each about cases that exist; and templates that ask for what is not there."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from dampbalance.balance import APPROACHES
from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.project.wording import number_text, percent, signed_percent
from dampbalance.solver import least_squares
from dampbalance.studies import reading_study
from dampbalance.studies.shown.paragraph import paragraph
from folders import ROOT
from paper_case import LEVELS, PAPER, features_at


def zeta(**more):
    """A study over the damping ratio, with whatever else its axis holds."""
    return {"axes": [{"zeta": {"from": 0.1, "to": 0.9, "count": 9, **more}}]}


PAIRED = {"axes": [{"zeta": {"values": [0.1, 0.2]}, "K_z_over_k": {"values": [50.0, 90.0]}}]}
SAMPLE = {"method": "random", "count": 5, "seed": 1, "over": {"zeta": {"from": 0.1, "to": 0.2}}}
SAMPLED = {"axes": [{"sample": SAMPLE}]}
SCHEMES = {
    "axes": [{"scheme": {"values": ["rk4"]}}],
    "route": {"kind": "fixed_step", "step_s": 1e-4, "cycles": 4},
}
F = "errors('F_k', 'X_s')"


@pytest.mark.parametrize(
    ("study", "asked", "words"),
    [
        (zeta(), F + ".at(zeta=0.31)", "zeta: 0.31 is not among the 9 values of zeta, whose nearest are 0.3 and 0.4"),
        (zeta(), F + ".at(zeta='rk4')", "zeta: 'rk4' is not a number"),
        (zeta(), F + ".between(zeta=[0.5, 0.2])", "are not two bounds of zeta, the lower one first"),
        (zeta(), F + ".signed", "is the error of one case, and 9 are left"),
        (PAIRED, F + ".at(zeta=0.1, K_z_over_k=90.0)", "selects no case"),
        (SAMPLED, F + ".at(zeta=0.1)", "sampled: take the cases between two"),
        (SAMPLED, F + ".between(zeta=[0.3, 0.4]).largest", "no case is left: a sampled axis"),
        (SCHEMES, F + ".at(scheme='rk5')", "scheme: 'rk5' is not among its values: rk4"),
        (zeta(), F + ".__class__", "is unsafe"),
        (zeta(), "errors('F_k', 'fit')", "selects no fit of this study: see estimation"),
        (zeta(), "errors('c_3', 'direct')", "c_3 is not identified, or the oscillator has none: see estimation.terms"),
        (zeta(), "errors('F_k', phases='reversal')", "errors takes approach, contact, fit, phase, sharing, terms"),
        (zeta(), "errors('F_k').p95", "p95 refers to one fit, but direct__least_squares, X_s"),
    ],
)  # fmt: skip
def test_a_number_that_does_not_exist_is_refused_with_its_line(computed, says, study, asked, words):
    made, _, path = computed(study)
    with pytest.raises(ConfigurationError, match=r"test\.md\.j2: line 2: ") as caught:
        says(made, path, f"A paragraph,\n{{{{ {asked} }}}}")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_numbers_are_taken_from_the_cases_they_name(computed, says):
    template = """{% set F = errors("F_k", "X_s") %}{{ F.largest | percent }}; {{ F.at(zeta=0.3).signed | signed }};
        {{ F.between(zeta=[0.0, 0.45]).within(0.002) | percent }}; {{ F.rms | percent }}; {{ cases }}"""
    made, frame, path = computed(zeta())
    error = frame["F_k_relative_error__X_s__reversal__individual__least_squares"]
    expected = [percent(error.abs().max()), signed_percent(error[2])]
    expected += [percent((error[:4].abs() <= 0.002).mean()), percent((error**2).mean() ** 0.5), "9"]
    assert says(made, path, template).split("; ") == expected
    with pytest.raises(ConfigurationError, match="error: unknown name; a template has errors"):
        says(made, path, "{{ error }}")
    assert paragraph(made, path) == ("", {})  # without a template


def test_what_cannot_be_identified_is_said(computed, says):
    names = [name for name in computed(zeta())[1] if name.startswith("F_k_relative_error__direct")]
    made, _, path = computed(zeta(), **dict.fromkeys(names, np.nan))
    template = "{{ errors('F_k', 'direct').largest | percent }}"
    assert says(made, path, template) == "nothing (it cannot be identified there)"


def test_an_axis_takes_further_values_in_their_places(make):
    values = make(zeta(also=[0.31, 0.05, 0.3, 2.0])).blocks[0].axes["zeta"]
    assert values == sorted(values)
    assert len(values) == 12  # 0.3 is a value of the range already


# --- the shipped texts -----------------------------------------------------------------------------


def error_of_F_k(hz, approach="X_s", levels=LEVELS, phase="reversal", rigid=False, **other):
    """Relative error of F_k by least squares, from single orbits."""
    osc = replace(PAPER, **other)
    seen = features_at(hz, levels, osc).with_phase(phase)
    rows = APPROACHES[approach](seen.rigid() if rigid else seen, osc.k)
    return float(least_squares(rows)["F_k"]) / osc.F_k - 1.0


@pytest.fixture(scope="module")
def shipped(computed):
    """The numbers that the template of a study sets as it is shipped, from all of its cases."""

    @functools.cache
    def numbers(name):
        file = ROOT / f"config/studies/{name}.yaml"
        _, _, path = computed(read_yaml(file))
        return paragraph(reading_study.read_study(file), path)[1]

    return numbers


@pytest.mark.parametrize(
    ("name", "what", "of"),
    [
        ("contact_stiffness", "paper", {"hz": 4.92}),
        ("contact_stiffness", "off_soft", {"hz": 11.1, "K_z": 2.0 * PAPER.k}),
        ("level", "low", {"hz": 4.92, "levels": (0.004, 0.006)}),
        # at the paper's frequencies, as `results/paper/tables/approaches.csv` and the page have them
        ("frequency", "below_fundamental", {"hz": 3.5, "phase": "fundamental"}),
        ("frequency", "above_individual", {"hz": 11.1}),
        ("rigid_contact", "soft_omega1", {"hz": 4.92, "approach": "direct", "rigid": True, "K_z": 2.0 * PAPER.k}),
    ],
)  # fmt: skip
def test_numbers_are_at_the_parameters_that_they_name(shipped, name, what, of):
    assert shipped(name)[what] == signed_percent(error_of_F_k(**of))
    # by chance in order in one process of 40,000
    assert list(shipped(name)) == sorted(shipped(name))


# Derived by independent code from exact orbits, to half a unit of the digits given: the worst pair of the Fourier
# balance at 11.1 Hz and 3.5 Hz where the features named are rounded, X, X_s and X_n to 10 µm, φ_1 to three decimals.
@pytest.mark.parametrize(
    ("what", "error", "half"),
    [
        ("fourier_five", 0.773, 0.0005),  # X, X_s
        ("fourier_six", -0.0747, 0.00005),  # X, X_s to one more
        ("fourier_phase", 2.8, 0.05),  # φ_1 as well
        ("fourier_table_1", 6.5, 0.05),  # X_1, X_3, X_5 as well
        ("fourier_table_1_below", 3.1, 0.05),
        ("fourier_one_more", 0.35, 0.005),  # all of them to one more
    ],
)
def test_the_fourier_balance_needs_the_decimals_of_all_that_it_reads(shipped, what, error, half):
    stated = shipped("read_out")[what].removesuffix(" %").replace("−", "-")
    assert float(stated) == pytest.approx(error, abs=half * (1.0 + 1e-9))


@pytest.mark.parametrize(("number_of", "hz"), [(1, 4.92), (2, 3.5), (3, 11.1)])
def test_thresholds_of_a_rigid_model_are_where_its_error_is_one_per_cent(shipped, number_of, hz):
    def excess(K):
        return abs(error_of_F_k(hz, "direct", rigid=True, K_z=K * PAPER.k)) - 0.01

    expected = number_text(brentq(excess, 5.0, 200.0, rtol=1e-6), 3)
    assert shipped("rigid_contact")[f"from_omega{number_of}"] == expected
