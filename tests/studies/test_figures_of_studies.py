"""Figures of studies: the one that a file without any gets, and the errors on maps and curves."""

from __future__ import annotations

import numpy as np
import pytest

from dampbalance.figures import looks
from dampbalance.studies.shown import maps
from dampbalance.studies.shown.study_figure import study_figure

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
        # not drawn: too many cases for curves; nothing that varies; as the file wants it
        ({"axes": [{"sample": SAMPLE | {"count": 10**6}}]}, {}),
        ({"axes": [{"zeta": {"values": [0.1]}}]}, {}),
        ({"axes": [LONG], "figure": None}, {}),
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
    np.testing.assert_allclose(y[x < 2.49], np.abs(x[x < 2.49] - 1.6), atol=1e-9)
    assert np.isnan(y[x > 2.51]).all()
    for name in factors:  # from the last place where all agree
        alone = next(line for line in axes.lines if line.get_color() == looks.LOOKS[name].colour)
        seen = x[np.isfinite(np.asarray(alone.get_ydata(), float))]
        assert (seen[0], seen[-1]) == pytest.approx((2.48, 3.0))
    for line in marks:
        assert np.all((line.get_xdata() > 1.6) == (line.get_markerfacecolor() == colour))
