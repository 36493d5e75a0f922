"""Figures of studies: the one that a file without any gets, the errors on a map, labels that keep apart."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from matplotlib import colormaps, colors

from dampbalance.figures import looks
from dampbalance.figures.style import STYLE
from dampbalance.studies.shown import maps
from dampbalance.studies.shown.study_figure import study_figure

LONG = {"omega_over_omega_n": {"from": 0.5, "to": 3.0, "count": 31}}
STIFF = {"K_z_over_k": {"from": 5.0, "to": 500.0, "count": 21, "spacing": "log"}}
FEW = {"zeta": {"values": [0.05, 0.1, 0.5]}}
SAMPLE = {"method": "sobol", "seed": 1, "over": {"zeta": {"from": 0.01, "to": 1.0}}}
SIMULATED = {"route": {"kind": "fixed_step", "cycles": 4}, "levels_m": [0.004, 0.012]}
NOISY = {"route": {"kind": "measured", "sampling_hz": 1000, "noise": 0.01, "seed": 1}}
RUN = {"run": {"from": 0, "to": 9, "count": 10}}


CURVES = {"kind": "curves", "x": "omega_over_omega_n"}
MILLION = {"sample": SAMPLE | {"count": 10**6}}
SCHEME = {"scheme": {"values": ["rk4"]}}
SCHEMES = {"scheme": {"values": ["rk4", "backward-euler"]}}
STEPS = {"step_s": {"values": [2e-5, 4e-5]}}


@pytest.mark.parametrize(
    ("document", "figure"),
    [
        ({"axes": [LONG]}, CURVES),
        ({"axes": [LONG], "estimation": {"phases": ["reversal", "fundamental"]}}, CURVES | {"panels": "phase"}),
        ({"axes": [FEW, LONG]}, CURVES | {"panels": "zeta"}),
        (
            {"axes": [FEW, {"K_z_over_k": {"values": [10, 20, 30]}}, LONG]},
            CURVES | {"panels": "zeta", "at": {"K_z_over_k": 20}},
        ),
        ({"axes": [STIFF, LONG]}, {"kind": "map", "x": "omega_over_omega_n", "y": "K_z_over_k"}),
        ({"axes": [{"sample": SAMPLE | {"count": 64}}]}, {"kind": "curves", "x": "zeta"}),
        ({"axes": [MILLION, STIFF]}, {"kind": "map", "x": "zeta", "y": "K_z_over_k"}),
        (NOISY | {"axes": [{"noise": {"values": [0.01, 0.1]}}, RUN]}, {"kind": "scatter", "x": "noise"}),
        (
            NOISY | {"axes": [{"frequency_hz": {"values": [3.5, 6.0]}}, FEW, RUN]},
            {"kind": "scatter", "x": "frequency_hz", "panels": "zeta"},
        ),
        (NOISY | {"axes": [RUN]}, {"kind": "curves", "x": "run"}),
        (SIMULATED | {"axes": [SCHEMES, STEPS]}, {"kind": "curves", "x": "step_s", "panels": "scheme"}),
        # not drawn: too many cases for curves; words only; nothing that varies; as the file wants it
        ({"axes": [MILLION]}, {}),
        ({"axes": [SCHEME], "route": {"kind": "fixed_step", "step_s": 1e-5}}, {}),
        ({"axes": [{"zeta": {"values": [0.1]}}]}, {}),
        ({"axes": [LONG], "figure": None}, {}),
    ],
)  # fmt: skip
def test_a_study_without_a_figure_gets_one_by_its_axes(make, document, figure):
    assert make(document).figure == figure


@pytest.fixture(scope="module")
def single(computed):
    """A map of which each place is one case, the table, and the axes of the panel of F_k by X_s."""
    study, table, path = computed({"axes": [STIFF, LONG]})
    return table, next(a for a in study_figure(study, path).axes if a.get_title() == "$X_s$")


def test_a_map_of_single_cases_shows_their_errors_with_zero_in_the_middle(single):
    table, panel = single
    mesh, lines = panel.collections[:2]
    errors = 100.0 * table["F_k_relative_error__X_s__reversal__individual__least_squares"]
    assert np.array_equal(mesh.get_array(), errors.to_numpy().reshape(21, 31))
    assert mesh.norm(0.0) == 0.5
    assert mesh.norm(-3.0) == pytest.approx(1.0 - mesh.norm(3.0), rel=1e-12)
    # along the upper edge, the error grows through 0: the lines cross where it has their level
    upper, x = errors.to_numpy()[-31:], table["omega_over_omega_n"].to_numpy()[-31:]
    level = int(np.flatnonzero(lines.levels == 1.0)[0])
    ends = lines.get_paths()[level].vertices
    place = ends[np.isclose(ends[:, 1], ends[:, 1].max()), 0]
    # linear in a bin, to its size
    assert place.min() == pytest.approx(np.interp(1.0, upper, x), abs=0.1)
    assert "1 %" in {text.get_text() for text in panel.texts}


def test_a_map_of_many_cases_shows_what_nine_of_ten_do_not_exceed():
    random = np.random.default_rng(5)
    errors = 10.0 ** random.uniform(-6.0, 1.0, 1000)
    places = (np.log10(errors) - maps._LOWEST_BIN) * maps._BINS_PER_DECADE
    counts = np.bincount(places.astype(int), minlength=maps._BINS)[None]
    shown = maps._quantiles(np.array([counts[0], 0 * counts[0]]).astype(float))
    true = 100.0 * np.quantile(errors, 0.9, method="inverted_cdf")
    assert shown[0] == pytest.approx(true, rel=0.05)  # half a bin: 10^(1/48) − 1 = 4.9 %
    assert np.isnan(shown[1])  # no case at all
    counts[0, -1] += 200  # not identified, in more than one of ten
    assert np.isnan(maps._quantiles(counts.astype(float)))[0]


def lightness(name):
    """L* of the colours of a map: CIE 1976, of the relative luminance of sRGB."""
    rgb = colormaps[name](np.linspace(0.0, 1.0, 101))[:, :3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    luminance = linear @ [0.2126, 0.7152, 0.0722]
    return np.where(luminance > 0.008856, 116.0 * np.cbrt(luminance) - 16.0, 903.3 * luminance)


def test_the_colours_of_maps_grow_darker_with_the_error_also_without_colour():
    """Monotone lightness is what a colour-blind reader, or a print in grey, is left with."""
    assert (np.diff(lightness(maps.SIZES)) < 0.0).all()
    signed = lightness(maps.SIGNED)
    assert (np.diff(signed[:50]) > 0.0).all()
    assert (np.diff(signed[51:]) < 0.0).all()
    red, _, blue = colors.to_rgb(colormaps[maps.SIGNED](1.0))
    assert red > blue  # too large is red


X, T, V = "X_s", "t_s", "V_s"
ERRORS = {
    X: lambda x: 0.01 * (x - 1.6),
    T: lambda x: 0.0102 * (x - 1.6),  # 2 % larger: 0.009 of a decade
    V: lambda x: np.where(x < 2.5, 0.01, 0.02) * (x - 1.6),  # agrees up to 2.5
    "fourier": lambda x: np.full_like(x, -0.002),
}


@pytest.fixture(scope="module")
def curves(make, computed):
    """The axes of F_k of a figure of curves with errors that are given, and the labels of its legend."""
    document = {"axes": [{"omega_over_omega_n": {"from": 0.5, "to": 3.0, "count": 126}}]}
    document |= {"estimation": {"approaches": [*ERRORS]}}
    x = np.linspace(0.5, 3.0, 126)
    columns = {
        f"F_k_relative_error__{fit.label}": ERRORS[fit.approach](x) for fit in make(document).fits
    }
    study, _, path = computed(document, **columns)
    figure = study_figure(study, path)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    return figure.axes[0], labels


def shown_lines(axes, look):
    """The lines of a colour that are seen: the curve, and then its marks."""
    lines = [line for line in axes.lines if line.get_color() == look.colour]
    return lines[0], lines[1:]


def test_one_curve_stands_for_harmonic_approaches_where_they_agree(curves):
    axes, labels = curves
    assert labels[:4] == ["$X_s$, $t_s$, $V_s$", "$X_s$", "$t_s$", "$V_s$"]
    common, _ = shown_lines(axes, looks.HARMONIC_LOOK)
    x, y = (np.asarray(of) for of in common.get_data())
    np.testing.assert_allclose(y[x < 2.49], np.abs(x[x < 2.49] - 1.6), atol=1e-9)
    assert np.isnan(y[x > 2.51]).all()
    for name in (X, T, V):  # from the last place where all agree
        alone, _ = shown_lines(axes, looks.LOOKS[name])
        seen = x[np.isfinite(alone.get_ydata())]
        assert (seen[0], seen[-1]) == pytest.approx((2.48, 3.0))


def test_open_marks_show_that_an_estimate_is_too_small(curves):
    axes, labels = curves
    assert labels[-2:] == ["too large", "too small"]
    for look, large in (
        (looks.HARMONIC_LOOK, lambda x: x > 1.6),
        (looks.LOOKS["fourier"], lambda x: 0 * x > 1),
    ):
        _, marks = shown_lines(axes, look)
        assert marks
        for line in marks:
            filled = line.get_markerfacecolor() == look.colour
            assert np.all(large(line.get_xdata()) == filled)
            assert np.all(line.get_ydata() > 0.0)


def test_the_axis_of_curves_holds_all_sizes(curves):
    axes, _ = curves
    assert axes.get_yscale() == "log"
    low, high = axes.get_ylim()
    assert low <= 0.2  # of Fourier; sizes next to the change of sign may lie below
    assert high > 2.8


ALONG = {
    "Y_m": {"from": 0.004, "to": 0.012, "count": 5},
    "K_z_over_k": {"from": 10.0, "to": 1000.0, "count": 5, "spacing": "log"},
}


@pytest.mark.parametrize("panels", range(2, 7))
@pytest.mark.parametrize("name", ALONG)
def test_labels_of_neighbouring_panels_keep_apart(computed, name, panels):
    hertz = {"frequency_hz": {"values": [3.5, 5.0, 6.0, 8.0, 11.0, 13.0][:panels]}}
    changed = {"axes": [hertz, {name: ALONG[name]}], "levels_of_Y": [1, 2]}
    changed |= {"figure": {"kind": "curves", "x": name, "panels": "frequency_hz"}}
    study, _, path = computed(changed | {"estimation": {"approaches": ["X_s"]}})
    figure = study_figure(study, path)
    figure.draw_without_rendering()
    boxes = []
    for axes in figure.axes[-panels:]:
        low, high = axes.get_xlim()
        ticks = [tick for tick in axes.xaxis.get_major_ticks() if low <= tick.get_loc() <= high]
        labels = [tick.label1 for tick in ticks if tick.label1.get_text()]
        assert labels  # every panel keeps a label
        boxes += [label.get_window_extent() for label in labels]
    assert all(one.x1 < other.x0 for one, other in itertools.pairwise(boxes))
    assert boxes[-1].x1 < figure.get_figwidth() * STYLE["figure.dpi"]
