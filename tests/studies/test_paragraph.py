"""Paragraphs of studies: their numbers, each about cases that exist; and templates that
ask for what is not there."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from dampbalance.balance import APPROACHES
from dampbalance.figures.looks import LOOKS
from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.project.wording import number_text, signed_percent
from dampbalance.solver import least_squares
from dampbalance.studies import case_files, evaluate, reading_study
from dampbalance.studies.shown.paragraph import paragraph
from dampbalance.studies.shown.study_figure import study_figure
from dampbalance.studies.study_file import PAPER_CASE
from folders import ROOT
from paper_case import LEVELS, PAPER, features_at


def zeta(**more):
    """A study over the damping ratio, with whatever else its axis holds."""
    return {"axes": [{"zeta": {"from": 0.1, "to": 0.9, "count": 9, **more}}]}


PAIRED = {"axes": [{"zeta": {"values": [0.1, 0.2]}, "K_z_over_k": {"values": [50.0, 90.0]}}]}
SAMPLE = {"method": "random", "count": 5, "seed": 1, "over": {"zeta": {"from": 0.1, "to": 0.2}}}
SCHEMES = {
    "axes": [{"scheme": {"values": ["rk4"]}}],
    "route": {"kind": "fixed_step", "step_s": 1e-4, "cycles": 4},
}


@pytest.mark.parametrize(
    ("study", "asked", "words"),
    [
        (zeta(), ".at(zeta=0.31)", "zeta: 0.31 is not among the 9 values of zeta, whose nearest are 0.3 and 0.4"),
        (zeta(), ".at(zeta=5.0)", "are 0.8 and 0.9; take one of them, or add it"),
        (zeta(also=[0.31]), ".at(zeta=0.3100001)", "nearest are 0.3 and 0.31"),
        (zeta(), ".at(zeta='rk4')", "zeta: 'rk4' is not a number"),
        (zeta(), ".at(m_kg=1.0)", "m_kg: not an axis of this study"),
        (zeta(), ".between(zeta=[0.5, 0.2])", "are not two bounds of zeta, the lower one first"),
        (zeta(), ".signed", "is the error of one case, and 9 are left"),
        (PAIRED, ".at(zeta=0.1, K_z_over_k=50.0).signed", ""),
        (PAIRED, ".at(zeta=0.1, K_z_over_k=90.0)", "selects no case"),
        ({"axes": [{"sample": SAMPLE}]}, ".at(zeta=0.1)", "sampled: take the cases between two"),
        ({"axes": [{"sample": SAMPLE}]}, ".between(zeta=[0.3, 0.4]).largest", "no case is left: a sampled axis"),
        ({"axes": [{"sample": SAMPLE}]}, ".between(zeta=[0.3, 0.4]).within(0.01)", "no case is left: a sampled axis"),
        (SCHEMES, ".at(scheme='rk5')", "scheme: 'rk5' is not among its values: rk4"),
        (zeta(), ".deviation", "has no attribute 'deviation'"),
        (zeta(), ".__class__", "is unsafe"),
    ],
)  # fmt: skip
def test_a_number_that_does_not_exist_is_refused_with_its_line(computed, says, study, asked, words):
    made, _, path = computed(study)
    template = f"A paragraph,\n{{{{ errors('F_k', 'X_s'){asked} }}}}"
    if not words:
        says(made, path, template)
        return
    with pytest.raises(ConfigurationError, match=r"test\.md\.j2: line 2: ") as caught:
        says(made, path, template)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("template", "words"),
    [
        ("{{ error }}", "test.md.j2: error: unknown name; a template has errors(coefficient, approach, …), cases"),
        ("1\n\n{{ errors('F_k' }}", "test.md.j2: line 3: "),
        ("{% if cases %}", "test.md.j2: line 1: "),
        ("{{ errors('F_k', 'fit') }}", "selects no fit of this study: see estimation"),
        ("{{ errors('F_k', 'X_s', fit='pairs') }}", "selects no fit of this study"),
        ("{{ errors('c_3', 'direct') }}", "c_3 is not identified, or the oscillator has none: see estimation.terms"),
        ("{{ errors('F_k', phases='reversal') }}", "errors takes approach, contact, fit, phase, sharing, terms"),
        ("{{ errors('F_k').p95 }}", "p95 refers to one fit, but direct__least_squares, X_s"),
        ("{{ 1 / 0 }}", "test.md.j2: line 1: division by zero"),
    ],
)  # fmt: skip
def test_a_wrong_template_is_refused(computed, says, template, words):
    made, _, path = computed(zeta())
    with pytest.raises(ConfigurationError) as caught:
        says(made, path, template)
    assert words in str(caught.value)


def test_a_study_without_a_template_has_no_paragraph(computed):
    made, _, path = computed(zeta())
    assert paragraph(made, path) == ("", {})


def test_what_cannot_be_identified_is_said(computed, says):
    made, frame, _ = computed(zeta())
    made, _, path = computed(zeta(), **{
        name: np.nan for name in frame if name.startswith("F_k_relative_error__direct")
    })  # fmt: skip
    template = "{{ errors('F_k', 'direct').largest | percent }}"
    assert says(made, path, template) == "nothing (it cannot be identified there)"


def test_an_axis_takes_further_values_in_their_places(make):
    (block,) = make(zeta(also=[0.31, 0.05, 0.3, 2.0])).blocks
    values = block.axes["zeta"]
    assert values == sorted(values)
    assert len(values) == 12  # 0.3 is a value of the range already
    assert {0.05, 0.3, 0.31, 2.0} <= set(values)


def test_a_figure_of_curves_takes_the_cases_that_it_names(make, computed):
    axes = [{"zeta": {"from": 0.1, "to": 0.9, "count": 9}}, {"K_z_over_k": {"values": [9.0, 90.0]}}]
    figure = {"kind": "curves", "x": "zeta", "at": {"K_z_over_k": 9.0}}
    study, frame, path = computed(
        {"axes": axes, "figure": figure, "estimation": {"approaches": ["X_s"]}}
    )
    lines = study_figure(study, path).axes[0].lines
    curve = next(line for line in lines if line.get_color() == LOOKS["X_s"].colour)
    drawn = frame[frame["K_z_over_k"] == 9.0].sort_values("zeta")
    assert curve.get_xdata().tolist() == drawn["zeta"].tolist()
    errors = 100.0 * drawn["F_k_relative_error__X_s__reversal__individual__least_squares"]
    assert curve.get_ydata().tolist() == errors.abs().tolist()
    with pytest.raises(ConfigurationError, match=r"figure\.at\.K_z_over_k: 8\.0 is not among"):
        make({"axes": axes, "figure": figure | {"at": {"K_z_over_k": 8.0}}})


# --- the shipped texts -----------------------------------------------------------------------------


def error_of_F_k(
    hz, approach="X_s", levels=LEVELS, phase="reversal", rigid=False, common=False, **other
):
    """Relative error of F_k by least squares, from single orbits."""
    osc = replace(PAPER, **other)
    seen = features_at(hz, levels, osc).with_phase(phase)
    seen = seen.with_common("phi", "t_s") if common else seen
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


def test_numbers_are_in_an_order_that_does_not_differ_between_processes(shipped):
    names = list(shipped("level"))
    assert len(names) >= 8  # by chance in order in one process of 40,000
    assert names == sorted(names)


@pytest.mark.parametrize(
    ("name", "what", "of"),
    [
        ("contact_stiffness", "paper", {"hz": 4.92}),
        ("contact_stiffness", "soft", {"hz": 4.92, "K_z": 2.0 * PAPER.k}),
        ("contact_stiffness", "off_soft", {"hz": 11.1, "K_z": 2.0 * PAPER.k}),
        ("level", "low", {"hz": 4.92, "levels": (0.004, 0.006)}),
        # at the paper's frequencies, as `results/paper/tables/approaches.csv` and the page have them
        ("frequency", "below_individual", {"hz": 3.5}),
        ("frequency", "below_fundamental", {"hz": 3.5, "phase": "fundamental"}),
        ("frequency", "above_individual", {"hz": 11.1}),
        ("rigid_contact", "soft_omega1", {"hz": 4.92, "approach": "direct", "rigid": True, "K_z": 2.0 * PAPER.k}),
    ],
)  # fmt: skip
def test_numbers_are_at_the_parameters_that_they_name(shipped, name, what, of):
    assert shipped(name)[what] == signed_percent(error_of_F_k(**of))


def test_frequencies_of_the_paper_are_theirs_with_another_mass(tmp_path):
    """A study takes oscillator and levels from the configuration, and its paragraph names ω₁, ω₂ and ω₃."""
    paper = {**PAPER_CASE, "base": PAPER_CASE["base"] | {"m_kg": 3.0}}
    study = reading_study.read_study(ROOT / "config/studies/frequency.yaml", paper)
    table = evaluate.evaluate(study, 0, study.cases)
    case_files.write_parts(tmp_path / "cases.parquet", [table], study, "0")
    _, numbers = paragraph(study, tmp_path / "cases.parquet")
    for what, hz in (("below_individual", 3.5), ("above_individual", 11.1)):
        assert numbers[what] == signed_percent(error_of_F_k(hz, m=3.0))


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


@pytest.mark.parametrize("sharing", ["common", "individual"])
def test_the_band_of_the_harmonic_approach_ends_where_its_error_is_five_per_cent(shipped, sharing):
    def excess(hz):
        return abs(error_of_F_k(hz, common=sharing == "common")) - 0.05

    ends = brentq(excess, 3.8, 4.6), brentq(excess, 5.2, 6.2)
    assert shipped("frequency")[f"band_{sharing}"] == "{:.2f} to {:.2f}".format(*ends)
