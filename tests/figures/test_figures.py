"""Figures: the same bytes each time, marks where the numbers are, nothing clipped and nothing on top of another."""

from __future__ import annotations

import ast
import functools
import math
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from dampbalance import BaseMotion, balance, figures, steady_orbit
from dampbalance.estimates import estimate_table
from dampbalance.figures import looks, style
from dampbalance.figures.cycle import branches
from dampbalance.figures.series import signed_scale
from dampbalance.law.terms import Term
from legible import faults
from paper_case import FREQUENCIES_HZ, LEVELS, NEAR, OMEGA, PAIRS, PAPER, features_at, orbits_at
from processes import output_of

NAMES = ("figure1", "figure2", "figure3", "estimation_error")


@pytest.fixture(scope="module")
def orbits() -> list:
    return orbits_at()


@pytest.fixture(scope="module")
def estimates() -> dict[str, pd.DataFrame]:
    return {
        name: estimate_table(features_at(hz), PAPER.k, PAIRS) for name, hz in FREQUENCIES_HZ.items()
    }


@pytest.fixture(scope="module")
def make(orbits, estimates):
    """Name of a figure → a new one."""
    return {
        "figure1": figures.schematic,
        "figure2": lambda: figures.friction_velocity_loop(orbits[0]),
        "figure3": lambda: figures.figure3(orbits),
        "estimation_error": lambda: figures.estimation_error(
            estimates, PAPER, FREQUENCIES_HZ, LEVELS
        ),
    }


def written(figure: Figure, folder: Path) -> tuple[bytes, bytes]:
    svg, png = folder / "figure.svg", folder / "figure.png"
    figures.save(figure, svg, png, "What it shows: φ − 1.")
    return svg.read_bytes(), png.read_bytes()


@pytest.fixture(scope="module")
def saved(make, tmp_path_factory):
    """Name of a figure → the folder with its files, written once for all tests."""

    @functools.cache
    def folder_of(name: str) -> Path:
        folder = tmp_path_factory.mktemp(name)
        written(make[name](), folder)
        return folder

    return folder_of


def panels(figure: Figure) -> dict:
    return dict(zip("abcd", figure.axes, strict=False))


def line(axes, label: str):
    (found,) = [line for line in axes.lines if line.get_label() == label]
    return found


# --- files ---------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_same_figure_gives_the_same_bytes(make, saved, name, tmp_path):
    first = tuple((saved(name) / file).read_bytes() for file in ("figure.svg", "figure.png"))
    figure = make[name]()
    assert written(figure, tmp_path / "new") == first
    assert written(figure, tmp_path / "again") == first


def test_the_settings_of_the_user_change_nothing(make, tmp_path):
    usual = written(make["figure2"](), tmp_path / "usual")
    theirs = {"font.size": 20.0, "svg.hashsalt": None, "savefig.dpi": 50, "axes.grid": True}
    with matplotlib.rc_context(theirs):
        before = dict(matplotlib.rcParams)
        assert written(make["figure2"](), tmp_path / "theirs") == usual
        assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize(
    ("name", "width"),
    [("figure1", 90), ("figure2", 180), ("figure3", 180), ("estimation_error", 180)],
)
def test_files_fit_a_column_and_say_what_they_show_but_not_when_or_with_what(saved, name, width):
    text = (saved(name) / "figure.svg").read_text(encoding="utf-8")
    assert "<dc:description>What it shows: φ − 1.</dc:description>" in text
    assert matplotlib.__version__ not in text
    assert not {"dc:date", "dc:creator"} & {word.strip("</ >") for word in text.split(">")}
    with Image.open(saved(name) / "figure.png") as image:
        assert set(image.info) == {"Description", "dpi"}
        assert image.info["dpi"] == pytest.approx((300, 300), abs=0.01)  # PNG counts in dots per m
        assert image.width == int(width / 25.4 * 300)  # whole pixels


def test_a_failing_save_leaves_what_was_there(tmp_path, monkeypatch):
    svg, png = tmp_path / "figure.svg", tmp_path / "figure.png"
    svg.write_text("old")

    def fails(_, path, **__):
        Path(path).write_text("half a fi")
        raise OSError("disk full")

    monkeypatch.setattr(Figure, "savefig", fails)
    with pytest.raises(OSError, match="disk full"):
        figures.save(Figure(), svg, png)
    assert svg.read_text() == "old"
    assert list(tmp_path.iterdir()) == [svg]


# --- legibility ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_no_text_is_clipped_or_overlaps_another(make, name):
    assert faults(make[name]()) == []
    text = figures.ALT[name]
    assert text.endswith(".")
    assert text.count(". ") == 0


def lightness(colour: str) -> float:
    """CIE L* of a colour: what is left of it in grey."""
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return 116.0 * np.cbrt(float(linear @ [0.2126, 0.7152, 0.0722])) - 16.0


def test_approaches_stay_apart_in_grey():
    # a yardstick takes the colour of a spare one; no two of those that have a look look alike
    for of_look in ("colour", "series"):
        assert len({getattr(look, of_look) for look in looks.LOOKS.values()}) == len(looks.LOOKS)
    every = [*(looks.LOOKS[name] for name in balance.APPROACHES), *looks.SPARE]
    for of_look in ("marker", "shape", "series"):
        assert len({getattr(look, of_look) for look in every}) == len(every)
    values = sorted(lightness(looks.LOOKS[name].colour) for name in balance.APPROACHES)
    # A step of 2 is just seen side by side; 8 is seen between markers that are apart.
    assert min(np.diff(values)) > 8.0
    assert abs(lightness(style.SLIP) - lightness(style.STICK)) > 25.0


def test_an_approach_needs_no_more_than_its_entry_to_have_a_look(monkeypatch):
    assert set(balance.APPROACHES) | {"simpson", "fit"} == set(looks.LOOKS)
    for name in ("new", "newer"):
        new = balance.Approach(name, balance.direct, f"{name} t_s", takes_phase=True)
        monkeypatch.setitem(balance.APPROACHES, name, new)
    assert [looks.look_of(name) for name in ("new", "newer")] == list(looks.SPARE[:2])
    assert looks.label_of("new") == "new t_s"
    assert looks.in_maths(looks.label_of("new")) == "new $t_s$"
    assert looks.label_of("unregistered") == "unregistered"
    assert looks.look_of("unregistered") == looks.SPARE[2]
    own = [balance.Approach(name, balance.direct, f"{name} of ours") for name in ("one", "other")]
    assert [looks.label_of(one) for one in own] == ["one of ours", "other of ours"]
    assert looks.in_maths("direct integration") == "direct integration"


def test_figures_leave_the_global_state_of_pyplot_alone():
    program = (
        "import sys; from dampbalance.figures.style import page; page(40.0, 30.0); "
        "print('matplotlib.pyplot' in sys.modules)"
    )
    assert output_of(sys.executable, "-c", program) == "False\n"
    for module in Path(figures.__file__).parent.glob("*.py"):
        if module.name == "style.py":  # where a notebook is told how to show figures
            continue
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            names = [alias.name for alias in getattr(node, "names", [])]
            assert "pyplot" not in f"{getattr(node, 'module', '')} {names}", module.name


# --- Figure 2 ------------------------------------------------------------------------------------


def test_branches_make_one_closed_cycle(orbits):
    orbit = orbits[0]
    cycle = branches(orbit)
    assert [branch.stick for branch in cycle] == [True, False, True, False]
    Z_m = PAPER.F_k / PAPER.K_z
    for here, following in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
        for end, start, scale in zip(
            here.state, following.state, (orbit.X, 0.1, 3.0, Z_m), strict=True
        ):
            # rounding of the instant, carried by the steepest change (acceleration: 5e2 m/s³)
            assert end[-1] == pytest.approx(start[0], abs=1e-11 * scale)
        deflection = np.abs(here.state.z[1:-1])
        if here.stick:
            assert np.all(deflection < Z_m)
        else:
            assert deflection == pytest.approx(Z_m, rel=1e-12)


def test_figure2_marks_the_four_instants_where_they_are(make, orbits):
    zoom = panels(make["figure2"]())["b"]
    orbit, F_k = orbits[0], PAPER.F_k
    written_there = " ".join(text.get_text() for text in zoom.texts)
    for letter, instant, v, f in (
        ("A", "t_2", 0.0, F_k),
        ("B", "t_r", -orbit.V_s, -F_k),
        ("C", "t_1", 0.0, -F_k),
        ("D", "t_s", orbit.V_s, F_k),
    ):
        assert line(zoom, letter).get_xydata()[0] == pytest.approx((v, f))
        assert rf"\mathbf{{{letter}}}$, ${instant}$" in written_there


def test_figure2_draws_the_friction_force_of_the_orbit(make, orbits):
    orbit = orbits[0]
    whole = panels(make["figure2"]())["a"]
    curve = [line.get_xydata() for line in whole.lines if len(line.get_xydata()) > 2]
    v, f = np.concatenate(curve).T
    # The work of the friction force over the cycle is what slip takes: ∮ f ẋ dt = ∮ f dx = F_k a, Eq. (6).
    x = np.concatenate([branch.state.x for branch in branches(orbit)])
    work = np.trapezoid(f, x)
    # z is linear in x in stick and constant in slip: the trapezoidal rule is exact but for rounding.
    assert work == pytest.approx(PAPER.F_k * orbit.a, rel=1e-9)
    assert v.max() < whole.get_xlim()[1]
    assert np.abs(f).max() == pytest.approx(PAPER.F_k)
    assert whole.get_ylim()[1] > PAPER.F_k


# --- Figure 3 ------------------------------------------------------------------------------------


def test_figure3_has_four_lettered_panels_with_units(make):
    for letter, axes in panels(make["figure3"]()).items():
        assert f"({letter})" in [text.get_text() for text in axes.texts]
        x = "displacement $x$ (mm)" if letter in "ab" else r"velocity $\dot{x}$ (m/s)"
        assert axes.get_xlabel() == x
        assert axes.get_ylabel() == r"acceleration $\ddot{x}$ (m/s$^2$)"


def test_figure3_marks_what_table_1_lists(make, orbits):
    figure, orbit = make["figure3"](), orbits[0]
    b, d = (panels(figure)[letter] for letter in "bd")
    # Each mark ends on the curve: the acceleration follows from the equation of motion, Eqs. (1), (2).
    m, c, k, F_k = PAPER.m, PAPER.c, PAPER.k, PAPER.F_k
    force = k * orbit.motion.y(orbit.t_1 + orbit.t_s)
    at_slip = (force - c * orbit.V_s - k * orbit.X_s - F_k) / m
    at_reversal = (k * orbit.motion.y(orbit.t_1) + k * orbit.X + F_k) / m
    for axes, label, x, acceleration in (
        (b, "-X", -orbit.X * 1e3, at_reversal),
        (b, "X_s", orbit.X_s * 1e3, at_slip),
        (d, "V_s", orbit.V_s, at_slip),
    ):
        mark = line(axes, label)
        assert mark.get_xdata() == pytest.approx([x] * 2)
        assert mark.get_ydata()[1] == pytest.approx(acceleration, rel=1e-9)
    labels = {text.get_text() for axes in (b, d) for text in axes.texts}
    assert {"$-X_{1}$", "$X_{1s}$", "$V_{1s}$", "$X_{1} + X_{1s}$ = 12.31 µm"} <= labels


def test_the_microsticking_line_is_straight_and_as_steep_as_the_contact(make, orbits):
    b = panels(make["figure3"]())["b"]
    curves = [line.get_xydata() for line in b.lines if line.get_color() == style.STICK]
    stick = next(curve for curve in curves if curve[0, 0] < 0.0)
    x, acceleration = stick[:, 0] * 1e-3, stick[:, 1]
    # m dẍ/dx = −(k + K_z) + (kẏ − cẍ)/ẋ. At the reversal kẏ and cẍ all but cancel, being at resonance; at slip onset
    # the last term is (285 − 174 N/s)/0.0077 m/s = 14 kN/m, 7 % of k + K_z.
    slope = np.polyfit(x, acceleration, 1)[0]
    assert slope == pytest.approx(-(PAPER.k + PAPER.K_z) / PAPER.m, rel=0.07)
    bend = acceleration - np.polyval(np.polyfit(x, acceleration, 1), x)
    assert np.abs(bend).max() < 0.02 * np.ptp(acceleration)  # less than the width of the line


def test_figure3_shows_and_names_every_level(make, orbits):
    figure = make["figure3"]()
    a, c = (panels(figure)[letter] for letter in "ac")
    for axes, of_state in ((a, lambda o: o.X * 1e3), (c, lambda o: o.V_s)):
        ends = {round(float(line.get_xdata()[n]), 9) for line in axes.lines for n in (0, -1)}
        assert {round(of_state(orbit), 9) for orbit in orbits} <= ends
        names = {text.get_text() for text in axes.texts}
        assert {"$Y$ = 4 mm", "6", "8", "10", "12"} <= names


@pytest.mark.parametrize(
    ("zoomed", "whole"), [("b", "a"), ("d", "c")], ids=["microsticking line", "corner"]
)
def test_figure3_frames_what_it_enlarges(make, zoomed, whole):
    figure = panels(make["figure3"]())
    (frame,) = figure[whole].patches
    assert frame.get_bbox().intervalx == pytest.approx(figure[zoomed].get_xlim())
    assert frame.get_bbox().intervaly == pytest.approx(figure[zoomed].get_ylim())


def test_figure3_enlarges_the_first_level_that_slips(orbits):
    stuck = steady_orbit(PAPER, BaseMotion(1e-4, orbits[0].motion.omega))
    assert math.isnan(stuck.X_s)
    d = panels(figures.figure3([stuck, *orbits[1:]]))["d"]
    assert line(d, "V_s").get_xdata()[0] == pytest.approx(orbits[1].V_s)
    assert "$V_{2s}$" in [text.get_text() for text in d.texts]


@pytest.mark.parametrize(
    ("F_k", "words"),
    [
        (50.0, "no slip: the contact only sticks"),
        (0.0, "no friction: the contact slips all the time"),
    ],
)
def test_where_nothing_is_to_be_marked_the_regime_is_named(F_k, words, tmp_path):
    some = orbits_at(osc=replace(PAPER, F_k=F_k))
    for figure in (figures.friction_velocity_loop(some[0]), figures.figure3(some)):
        assert words in [text.get_text() for axes in figure.axes for text in axes.texts]
        written(figure, tmp_path)


def test_several_slip_onsets_are_drawn(tmp_path):
    oscillator = replace(PAPER, c=10.0, K_z=20000.0, F_k=3.0)
    orbit = steady_orbit(oscillator, BaseMotion(0.004, 0.25 * OMEGA))
    assert len(orbit.phases) > 2
    written(figures.friction_velocity_loop(orbit), tmp_path)
    written(figures.figure3([orbit]), tmp_path)


def test_figure3_needs_an_orbit():
    with pytest.raises(ValueError, match="at least one orbit"):
        figures.figure3([])


# --- estimation error ----------------------------------------------------------------------------


@pytest.fixture
def stand_in() -> pd.DataFrame:
    """A table whose errors are plain: F_k off by 1 %, 0, missing and 10 %; c off by twice that."""
    off = np.array([0.01, 0.0, math.nan, 0.1])
    return pd.DataFrame(
        {
            "approach": "X_s",
            "kind": ["pair", "pair", "pair", "least_squares"],
            "phase": "common",
            "pair": ["1-2", "2-3", "1-3", "all"],
            "F_k_N": PAPER.F_k * (1.0 - off),
            "c_N_s_per_m": 90.0 * (1.0 + 2.0 * off),
        }
    )


def off_by(factor: float):
    """The errors of the stand-in, %, times a factor."""
    expected = [factor, 0.0, math.nan, 10.0 * factor]
    return pytest.approx(expected, rel=1e-12, abs=1e-12, nan_ok=True)


def texts(artists) -> list[str]:
    return [artist.get_text() for artist in artists]


def labelled(figure: Figure, name: str):
    (found,) = [axes for axes in figure.axes if axes.get_label() == name]
    return found


def drawn(figure: Figure, axes: str, label: str) -> np.ndarray:
    """The errors drawn with a label in the named axes, in the order of the pairs, then all."""
    lines = labelled(figure, axes).lines
    return np.concatenate([line.get_ydata() for line in lines if line.get_label() == label])


def test_errors_are_relative_to_the_truth(stand_in):
    figure = figures.estimation_error({"omega1": stand_in}, PAPER, {"omega1": NEAR}, LEVELS)
    # neighbouring pairs 1-2, 2-3 first; then 1-3, which is missing; then least squares
    for symbol, factor in (("F_k", -1.0), ("c", 2.0)):
        assert drawn(figure, f"{symbol} omega1", "X_s common") == off_by(factor)
    assert "$\\omega_{1}/2\\pi$ = 4.92 Hz" in [axes.get_title() for axes in figure.axes]
    ticks = labelled(figure, "c omega1").get_xticklabels()
    assert texts(ticks) == ["4–6", "6–8", "4–8", "all"]


@pytest.mark.parametrize("name", FREQUENCIES_HZ)
@pytest.mark.parametrize("phase", ["common", "individual"])
def test_every_estimate_is_in_the_picture(make, estimates, name, phase):
    figure = make["estimation_error"]()
    frame = estimates[name]
    for approach in ("X_s", "t_s", "V_s", "fourier"):
        if phase == "common" and approach == "fourier":
            continue  # it takes no choice of phase
        chosen = frame[(frame["approach"] == approach) & (frame["phase"] == phase)]
        chosen = chosen[chosen["kind"].isin(["pair", "least_squares"])]
        for symbol, column, true in (("F_k", "F_k_N", PAPER.F_k), ("c", "c_N_s_per_m", PAPER.c)):
            shown = drawn(figure, f"{symbol} {name}", f"{approach} {phase}")
            assert shown == pytest.approx(100.0 * (chosen[column] / true - 1.0), rel=1e-12)
            low, high = labelled(figure, f"{symbol} {name}").get_ylim()
            assert low < shown.min()
            assert shown.max() < high


def test_what_is_exact_lies_on_zero_and_the_legend_states_its_bound(make):
    figure = make["estimation_error"]()
    for symbol in ("F_k", "c"):
        shown = drawn(figure, f"{symbol} omega1", "direct individual")
        assert len(shown) == len(PAIRS) + 1
        # exact to 1e-10 relative is what direct integration promises, 1e-8 %
        assert np.abs(shown).max() < 1e-8
    (name,) = [name for name in texts(figure.legends[0].get_texts()) if "direct" in name]
    assert name in {rf"direct integration (${{<}}10^{{{n}}}$ %)" for n in range(-11, -7)}


def test_the_axis_of_errors_shows_both_signs(make):
    axes = labelled(make["estimation_error"](), "F_k omega1")
    assert axes.get_yscale() == "asinh"
    assert axes.get_ylim() == pytest.approx((-140.0, 140.0))  # no mark at a power of ten is cut
    assert {"$-10^{2}$", "$0$", "$10^{2}$"} <= set(texts(axes.get_yticklabels()))


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ([-3.0, 0.2, math.nan], (0.1, -10.0, 1.0)),
        ([5.0, 70.0], (1.0, -1.0, 100.0)),
        ([-0.02], (0.01, -0.1, 0.01)),
        ([], (0.1, -0.1, 0.1)),
    ],
)
def test_a_signed_scale_holds_the_errors_of_either_sign(errors, expected):
    scale = signed_scale([np.array(errors)], 1e-3, math.inf)
    assert scale == pytest.approx(expected)
    assert scale.ticks == sorted(scale.ticks)
    assert {scale.low, 0.0, scale.high} <= set(scale.ticks)


def test_direct_integration_that_is_not_exact_is_drawn_like_the_others(estimates):
    frame = estimates["omega1"].copy()
    frame.loc[frame["approach"] == "direct", ["F_k_N", "c_N_s_per_m"]] *= 1.0001
    figure = figures.estimation_error({"omega1": frame}, PAPER, {"omega1": NEAR}, LEVELS)
    assert len(figure.axes) == 2
    # 0.01 %, on top of errors of 1e-12 %
    shown = drawn(figure, "c omega1", "direct individual")
    assert shown == pytest.approx([0.01] * (len(PAIRS) + 1), rel=1e-6)


def test_a_new_approach_and_a_new_term_are_drawn_like_the_others(stand_in, monkeypatch, tmp_path):
    new = balance.Approach("new", balance.direct)
    monkeypatch.setitem(balance.APPROACHES, "new", new)
    monkeypatch.setitem(
        balance.TERMS, "d", Term("d", lambda v, w, k, omega: abs(v) * v, "", "kg/m", "", "", 2)
    )
    both = pd.concat([stand_in, stand_in.replace({"approach": "X_s", "phase": "common"}, "new")])
    both["phase"] = both["phase"].replace("new", "individual")
    oscillator = SimpleNamespace(F_k=1.28, c=90.0, d=2.0)
    both["d_kg_per_m"] = 2.0 * (1.0 + 3.0 * (1.0 - both["F_k_N"] / 1.28))
    figure = figures.estimation_error({"omega1": both}, oscillator, {"omega1": 4.92}, LEVELS)
    for symbol, factor in (("F_k", -1.0), ("c", 2.0), ("d", 3.0)):
        assert drawn(figure, f"{symbol} omega1", "new individual") == off_by(factor)
    assert "new" in texts(figure.legends[0].get_texts())
    written(figure, tmp_path)


def test_a_missing_frequency_is_named(stand_in):
    for tables, wanted, words in (
        ({"omega1": stand_in}, {"omega2": 3.5}, "omega2"),
        ({}, {}, "freq"),
    ):
        with pytest.raises(ValueError, match=words):
            figures.estimation_error(tables, PAPER, wanted, LEVELS)
