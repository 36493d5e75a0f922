"""What is shown of studies: the errors on maps and curves, and paragraphs whose numbers are about cases that exist."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from dampbalance.balance import APPROACHES
from dampbalance.figures import looks
from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.project.wording import number_text, percent, signed_percent
from dampbalance.solver import least_squares
from dampbalance.studies import reading_study
from dampbalance.studies.shown import maps
from dampbalance.studies.shown.paragraph import paragraph
from dampbalance.studies.shown.study_figure import study_figure
from folders import ROOT
from paper_case import LEVELS, PAPER, features_at

LONG = {"omega_over_omega_n": {"from": 0.5, "to": 3.0, "count": 31}}
STIFF = {"K_z_over_k": {"from": 5.0, "to": 500.0, "count": 21, "spacing": "log"}}
FEW = {"zeta": {"values": [0.05, 0.1, 0.5]}}
SAMPLE = {"method": "sobol", "seed": 1, "over": {"zeta": {"from": 0.01, "to": 1.0}}}
NOISY = {"route": {"kind": "measured", "sampling_hz": 1000, "noise": 0.01, "seed": 1}}
RUN = {"run": {"from": 0, "to": 9, "count": 10}}
CURVES = {"kind": "curves", "x": "omega_over_omega_n"}


@pytest.mark.parametrize(
    ("document", "figure"),
    [
        ({"axes": [LONG], "estimation": {"phases": ["reversal", "fundamental"]}}, CURVES | {"panels": "phase"}),
        ({"axes": [FEW, STIFF, LONG][::2]}, CURVES | {"panels": "zeta"}),
        ({"axes": [STIFF, LONG]}, {"kind": "map", "x": "omega_over_omega_n", "y": "K_z_over_k"}),
        ({"axes": [{"sample": SAMPLE | {"count": 64}}]}, {"kind": "curves", "x": "zeta"}),
        (NOISY | {"axes": [FEW, RUN]}, {"kind": "scatter", "x": "zeta"}),
        (NOISY | {"axes": [RUN]}, {"kind": "curves", "x": "run"}),
        # not drawn: too many cases for curves; nothing that varies
        ({"axes": [{"sample": SAMPLE | {"count": 10**6}}]}, {}),
        ({"axes": [{"zeta": {"values": [0.1]}}]}, {}),
    ],
)  # fmt: skip
def test_a_study_without_a_figure_gets_one_by_its_axes(make, document, figure):
    assert make(document).figure == figure


def test_a_map_of_single_cases_shows_their_errors_with_zero_in_the_middle(computed):
    study, table, path = computed({"axes": [STIFF, LONG]})
    panel = next(a for a in study_figure(study, path).axes if a.get_title() == "$X_s$")
    mesh = panel.collections[0]
    errors = 100.0 * table["F_k_relative_error__X_s__reversal__individual__least_squares"]
    assert np.array_equal(mesh.get_array(), errors.to_numpy().reshape(21, 31))
    assert mesh.norm(0.0) == 0.5
    assert mesh.norm(-3.0) == pytest.approx(1.0 - mesh.norm(3.0), rel=1e-12)


def test_a_map_of_many_cases_shows_what_nine_of_ten_do_not_exceed():
    errors = 10.0 ** np.random.default_rng(5).uniform(-6.0, 1.0, 1000)
    places = (np.log10(errors) - maps._LOWEST_BIN) * maps._BINS_PER_DECADE
    counts = np.tile(np.bincount(places.astype(int), minlength=maps._BINS), (3, 1)).astype(float)
    counts[1] = 0.0  # no case at all
    counts[2, -1] += 200.0  # not identified, in more than one of ten
    true = 100.0 * np.quantile(errors, 0.9, method="inverted_cdf")
    shown = maps._quantiles(counts)
    # half a bin: 10^(1/48) − 1 = 4.9 %
    assert shown == pytest.approx([true, np.nan, np.nan], rel=0.05, nan_ok=True)


def test_a_map_of_one_approach_has_a_panel_for_each_phase_and_term_in_a_row(computed):
    document = {"axes": [STIFF, LONG], "estimation": {"phases": ["reversal", "fundamental"]}}
    document["figure"] = {
        "kind": "map",
        "x": "omega_over_omega_n",
        "y": "K_z_over_k",
        "approach": "t_s",
    }
    study, table, path = computed(document)
    *panels, _ = study_figure(study, path).axes  # and the scale of colours
    assert len({panel.get_position().y0 for panel in panels}) == 1
    panels.sort(key=lambda panel: panel.get_position().x0)
    shown = [(symbol, phase) for symbol in ("F_k", "c") for phase in ("reversal", "fundamental")]
    for panel, (symbol, phase) in zip(panels, shown, strict=True):
        errors = table[f"{symbol}_relative_error__t_s__{phase}__individual__least_squares"]
        drawn = panel.collections[0].get_array()
        assert np.array_equal(drawn, 100.0 * errors.to_numpy().reshape(21, 31))


def test_the_legend_of_curves_has_the_marks_of_the_panels_and_no_others(computed):
    """F_k always too large by X_s; c too small; direct integration exact, and so neither drawn nor in the legend."""
    document = {"axes": [LONG], "estimation": {"approaches": ["direct", "X_s"]}, "figure": CURVES}
    fit = "X_s__reversal__individual__least_squares"
    columns = {f"F_k_relative_error__{fit}": 0.01, f"c_relative_error__{fit}": -0.01}
    study, _, path = computed(document, **columns)
    figure = study_figure(study, path)
    marks = {
        (line.get_marker(), line.get_markerfacecolor())
        for axes in figure.axes
        for line in axes.lines
        if line.get_marker() not in ("", "None")
    }
    legend = figure.legends[0]
    named = {(line.get_marker(), line.get_markerfacecolor()) for line in legend.get_lines()}
    assert named == marks
    assert len(legend.get_texts()) == 3  # the approach, and either sign


def test_one_curve_stands_for_approaches_that_agree_and_open_marks_for_too_small(make, computed):
    x = np.linspace(0.5, 3.0, 126)
    document = {"axes": [{"omega_over_omega_n": {"from": 0.5, "to": 3.0, "count": 126}}]}
    document |= {"estimation": {"approaches": ["X_s", "t_s", "V_s"]}}
    # 2 %, 0.009 of a decade, are no difference; V_s agrees up to 2.5
    factors = {"X_s": 0.01, "t_s": 0.0102, "V_s": np.where(x < 2.5, 0.01, 0.02)}
    fits = make(document).fits
    columns = {f"F_k_relative_error__{of.label}": factors[of.approach] * (x - 1.6) for of in fits}
    study, _, path = computed(document, **columns)
    axes = study_figure(study, path).axes[0]
    colour = looks.HARMONIC_LOOK.colour
    curve, *marks = (line for line in axes.lines if line.get_color() == colour)
    y = np.asarray(curve.get_ydata(), float)
    expected = np.where(x < 2.49, np.abs(x - 1.6), np.nan)
    away = np.abs(x - 2.5) > 0.01
    np.testing.assert_allclose(y[away], expected[away], atol=1e-9)
    for name in factors:  # from the last place where all agree
        alone = next(line for line in axes.lines if line.get_color() == looks.LOOKS[name].colour)
        seen = x[np.isfinite(np.asarray(alone.get_ydata(), float))]
        assert (seen[0], seen[-1]) == pytest.approx((2.48, 3.0))
    for line in marks:
        assert np.all((line.get_xdata() > 1.6) == (line.get_markerfacecolor() == colour))


@pytest.mark.parametrize(
    ("axis", "values"),
    [("frequency_hz", [5.0, 12.0]), ("omega_over_omega_n", [5.0 / 8.0, 12.0 / 8.0])],
)
def test_a_frequency_is_shown_as_a_ratio_and_in_hz_however_it_is_given(computed, axis, values):
    levels = {"Y_m": {"from": 0.002, "to": 0.2, "count": 9, "spacing": "log"}}
    document = {
        "base": {"m_kg": 1.5, "k_N_per_m": 1.5 * (2.0 * math.pi * 8.0) ** 2},  # ω_n/2π = 8 Hz
        **{"axes": [{axis: {"values": values}}, levels], "levels_of_Y": [1.0, 1.5]},
        "estimation": {"approaches": ["X_s"]},
        "figure": {"kind": "curves", "x": "Y_m", "panels": axis, "marks": {"here": 0.02}},
    }
    study, _, path = computed(document)
    figure = study_figure(study, path)
    titles = [axes.get_title() for axes in figure.axes[:2]]
    assert titles == [rf"$\omega/\omega_n$ = {r} ({f} Hz)" for r, f in ((0.625, 5), (1.5, 12))]
    assert figure.texts[0].get_text().startswith("$Y$ (mm)")
    mark, curve = (of.get_xdata() for of in figure.axes[0].lines[-1:] + figure.axes[0].lines[:1])
    assert mark[0] == pytest.approx(20.0)  # mm
    assert curve == pytest.approx(np.geomspace(2.0, 200.0, 9))
    along = {"kind": "curves", "x": axis, "panels": "Y_m"}
    figure = study_figure(replace(study, figure=along), path)
    assert "8 Hz" in figure.texts[0].get_text()
    assert figure.axes[0].lines[0].get_xdata() == pytest.approx([0.625, 1.5])


def test_without_one_natural_frequency_a_frequency_is_shown_as_it_is_given(computed):
    masses = {"m_kg": {"values": [1.0, 2.0]}}
    axes = [masses, {"frequency_hz": {"values": [3.0, 4.0, 6.0]}}]
    figure = {"kind": "curves", "x": "frequency_hz", "panels": "m_kg"}
    study, _, path = computed({"axes": axes, "figure": figure})
    drawn = study_figure(study, path)
    assert drawn.texts[0].get_text().startswith("$f$ (Hz)")
    assert drawn.axes[0].lines[0].get_xdata() == pytest.approx([3.0, 4.0, 6.0])


def test_of_two_curves_that_coincide_the_lower_one_is_wider(make, computed):
    document = {"axes": [STIFF], "estimation": {"approaches": ["direct", "X_s", "fourier"]}}
    # 3 % are 0.013 of a decade
    errors, fits = {"direct": 0.01, "X_s": 0.0103, "fourier": 0.1}, make(document).fits
    columns = {f"F_k_relative_error__{of.label}": np.full(21, errors[of.approach]) for of in fits}
    study, _, path = computed(document, **columns)
    lines = [
        one for one in study_figure(study, path).axes[0].lines if one.get_linestyle() != "None"
    ]
    width = {one.get_color(): one.get_linewidth() for one in lines}
    direct, X_s, fourier = (width[looks.LOOKS[name].colour] for name in errors)
    assert direct > 2.0 * X_s == 2.0 * fourier


# --- paragraphs -----------------------------------------------------------------------------------


def zeta(**more):
    """A study over the damping ratio, with whatever else its axis holds."""
    return {"axes": [{"zeta": {"from": 0.1, "to": 0.9, "count": 9, **more}}]}


PAIRED = {"axes": [{"zeta": {"values": [0.1, 0.2]}, "K_z_over_k": {"values": [50.0, 90.0]}}]}
BOX = {"method": "random", "count": 5, "seed": 1, "over": {"zeta": {"from": 0.1, "to": 0.2}}}
SAMPLED = {"axes": [{"sample": BOX}]}
SCHEMES = {
    "axes": [{"scheme": {"values": ["rk4"]}}],
    "route": {"kind": "fixed_step", "step_s": 1e-4, "cycles": 4},
}
F = "errors('F_k', 'X_s')"


@pytest.mark.parametrize(
    ("study", "asked", "words"),
    [
        (zeta(), F + ".at(zeta=0.31)", "zeta: 0.31 is not among the 9 values of zeta, whose nearest are 0.3 and 0.4"),
        (zeta(), F + ".between(zeta=[0.5, 0.2])", "are not two bounds of zeta, the lower one first"),
        (zeta(), F + ".signed", "is the error of one case, and 9 are left"),
        (PAIRED, F + ".at(zeta=0.1, K_z_over_k=90.0)", "selects no case"),
        (SAMPLED, F + ".at(zeta=0.1)", "sampled: take the cases between two"),
        (SAMPLED, F + ".between(zeta=[0.3, 0.4]).largest", "no case is left: a sampled axis"),
        (SCHEMES, F + ".at(scheme='rk5')", "scheme: 'rk5' is not among its values: rk4"),
        (zeta(), F + ".__class__", "is unsafe"),
        (zeta(), "errors('F_k', 'fit')", "selects no fit of this study: see estimation"),
        (zeta(), "errors('c_3', 'direct')", "c_3 is not identified, or the oscillator has none: see estimation.terms"),
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
    made, _, path = computed(zeta(), F_k_relative_error__direct__least_squares=np.nan)
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
        ("contact_stiffness", "off_soft", {"hz": 11.1, "K_z": 2.0 * PAPER.k}),
        ("level", "low", {"hz": 4.92, "levels": (0.004, 0.006)}),
        # at the paper's frequencies, as `results/paper/tables/approaches.csv` and the page have them
        ("frequency", "below_fundamental", {"hz": 3.5, "phase": "fundamental"}),
        ("frequency", "above_individual", {"hz": 11.1}),
        ("frequency", "far_below", {"hz": 2.4586}),  # −44.6 % by independent code, at half ω_n
        ("frequency", "near_below", {"hz": 4.4255}),  # −3.48 %, at 0.9 ω_n
        ("rigid_contact", "soft_omega1", {"hz": 4.92, "approach": "direct", "rigid": True, "K_z": 2.0 * PAPER.k}),
    ],
)  # fmt: skip
def test_numbers_are_at_the_parameters_that_they_name(shipped, name, what, of):
    assert shipped(name)[what] == signed_percent(error_of_F_k(**of))
    # by chance in order in one process of 40,000
    assert list(shipped(name)) == sorted(shipped(name))


# Derived by independent code from exact orbits, to half a unit of the digits given: the worst pair of the Fourier
# balance at 11.1 Hz where X and X_s, φ_1, and X_1, X_3 and X_5 keep these decimals.
@pytest.mark.parametrize(
    ("X", "phi", "X_n", "error", "half"),
    [(5, 15, 15, 0.773, 0.0005), (5, 3, 15, 2.8, 0.05), (5, 3, 5, 6.5, 0.05), (6, 4, 6, 0.35, 0.005)],
)  # fmt: skip
def test_the_fourier_balance_needs_the_decimals_of_all_that_it_reads(
    computed, says, X, phi, X_n, error, half
):
    made, _, path = computed(read_yaml(ROOT / "config/studies/read_out.yaml"))
    at = f"X_decimals={X}, phi_decimals={phi}, X_n_decimals={X_n}, frequency_hz=11.1"
    stated = says(made, path, f"{{{{ errors('F_k', 'fourier', fit='pairs').at({at}).signed }}}}")
    assert 100.0 * float(stated) == pytest.approx(error, abs=half * (1.0 + 1e-9))


@pytest.mark.parametrize(("number_of", "hz"), [(1, 4.92), (3, 11.1)])
def test_thresholds_of_a_rigid_model_are_where_its_error_is_one_per_cent(shipped, number_of, hz):
    def excess(K):
        return abs(error_of_F_k(hz, "direct", rigid=True, K_z=K * PAPER.k)) - 0.01

    expected = number_text(brentq(excess, 5.0, 200.0, rtol=1e-6), 3)
    assert shipped("rigid_contact")[f"from_omega{number_of}"] == expected
