"""The article's own figures: how the printed digits arose, next to what each cause would make of them; and the findings
at a glance, where the excess of c comes from and what goes wrong off resonance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..balance import TERMS
from ..model import Oscillator
from ..replication.comparison import WAY, WAYS_TO_COMPARE
from ..replication.numbers import select
from .looks import LOOKS, SPARE
from .series import SignedScale
from .style import (
    DASHED,
    DOUBLE_COLUMN,
    FAINT,
    GRID,
    INK,
    STICK,
    arrow,
    note,
    page,
    panel_letter,
    place,
    styled,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALT_OF_NUMERICS = (
    "Six panels. The sampling instants that the printed friction travels imply agree at all levels for backward Euler "
    "with rounded coefficients, and disagree by tenths of a step for schemes without damping, whose damping was put in "
    "by hand, and without rounding; integrals of Table 2 lie on the curves of backward Euler and off those of other "
    "schemes with the given damping; the identified damping grows with the step and meets the printed value at the "
    "step of the rebuild, while explicit Euler takes away as much; printed phases follow the velocity reversal, not "
    "the zero crossing; printed slip times are whole tenths of a millisecond; a plus sign gives the printed pairs by "
    "slip velocity, a minus does not."
)
GLANCE_ALT = (
    "Left: on an axis of c, the true value; the rounded coefficient plus the numerical dissipation of backward Euler; "
    "the value that the rebuilt simulation gives; and the printed one. The last three nearly coincide. Right: errors "
    "of the friction force at each drive frequency by least squares: by the paper's fit, which errs by more than ten "
    "per cent off resonance; with one mean phase for all levels, which errs by more; with the phase of the "
    "fundamental of each level, below one per cent at the highest frequency; and far smaller by the Fourier "
    "balance."
)

PRINTED: dict[str, Any] = {"marker": "o", "ls": "none", "color": STICK, "ms": 4.2, "zorder": 5}
REBUILT, OTHER, THIRD = LOOKS["X_s"].colour, LOOKS["V_s"].colour, SPARE[0].colour
_OF_SCHEME: Mapping[str, dict[str, Any]] = {
    "backward-euler": {"marker": "o", "ms": 3.4, "color": REBUILT, "zorder": 4},
    "explicit-euler": {"marker": "D", "ms": 3.4, "color": OTHER, "mfc": "none"},
    "semi-implicit-euler": {"marker": "s", "ms": 3.2, "color": THIRD, "lw": 0.6, "ls": DASHED},
    # a cross inside a ring: the two lie on each other
    "trapezoidal": {"marker": "o", "ms": 5.0, "color": INK, "mfc": "none", "label": "trapezoidal"},
    "rk4": {"marker": "x", "ms": 2.6, "color": FAINT, "zorder": 4, "label": "Runge–Kutta"},
}
"""Scheme → how its errors are drawn against the step."""
_MARKERS: Sequence[Mapping[str, Any]] = (
    {"marker": "o", "color": PRINTED["color"]},
    {"marker": "D", "color": FAINT},
    {"marker": "^", "color": OTHER},
    {"marker": "s", "color": REBUILT},
)
LEFTS, COLUMN_WIDTHS = (15.0, 74.0, 133.0), 42.0  # mm: of the panels
BOTTOMS, ROW_HEIGHTS = (62.5, 10.5), 34.0


class Evidence(NamedTuple):
    """Inputs of the figure, all at the first frequency.

    numbers : of all routes, with what is printed (`replication.numbers.with_claims`).
    schemes : of `replication.authors_route.scheme_table`.   steps : cases of the study of the step, with columns
    scheme, step_s, c_N_s_per_m and c_relative_error__direct__least_squares.
    instants : of `publishing.article.derived_numbers.sampling_instants`.
    """

    numbers: pd.DataFrame
    schemes: pd.DataFrame
    steps: pd.DataFrame
    instants: pd.DataFrame

    def of(self, column: str, quantity: str, kind: str = "level", approach: str = "") -> pd.Series:
        """Return a column of the numbers at the first frequency, line by line."""
        rows = select(self.numbers, quantity=quantity, kind=kind, approach=approach)
        return rows.loc[rows["frequency"].eq("omega1") & rows["unit"].ne("%"), column]

    def printed(self, quantity: str, kind: str = "level", approach: str = "") -> np.ndarray:
        """Return the printed numbers among them."""
        texts = self.of("printed", quantity, kind, approach)
        return texts[texts != ""].astype(float).to_numpy()

    @property
    def omega(self) -> float:
        """The drive frequency, rad/s."""
        return 2.0 * math.pi * float(self.of("exact", "omega", "parameter").iloc[0])

    @property
    def Y(self) -> np.ndarray:
        """Amplitudes of the base, mm."""
        return 1e3 * self.of("exact", "Y").to_numpy()


@styled()
def numerics(
    evidence: Evidence, oscillator: Oscillator, step_s: float, t_s_unit_s: float
) -> Figure:
    """Draw six panels (a)–(f): sampling instants, integrals by scheme, step, phase, slip time, sign.

    step_s : of the rebuilt simulation, s.   t_s_unit_s : the unit in which t_s was read, s.
    """
    figure = page(DOUBLE_COLUMN, BOTTOMS[0] + ROW_HEIGHTS + 6.0)
    axes = [place(figure, x, y, COLUMN_WIDTHS, ROW_HEIGHTS) for y in BOTTOMS for x in LEFTS]
    _instants(axes[0], evidence)
    _integrals(axes[1], evidence)
    _steps(axes[2], evidence, oscillator, step_s)
    _phase(axes[3], evidence)
    _slip_time(axes[4], evidence, step_s, t_s_unit_s)
    _sign(axes[5], evidence)
    for panel in (axes[0], axes[1], axes[3], axes[4]):
        panel.set(xticks=evidence.Y, xlabel="$Y$ (mm)")
    for panel, letter in zip(axes, "abcdef", strict=True):
        panel_letter(panel, letter)
    return figure


def _instants(axes: Axes, e: Evidence) -> None:
    """Draw (a): where within a step each printed a is sampled, by the rebuild and its rivals, in the last cycle."""
    last = e.instants[e.instants["cycle"] == 0]
    # The first simulation of each trial: Runge–Kutta, the second by hand, lies on the trapezoidal rule.
    first = {str(name): rows.iloc[: len(e.Y)] for name, rows in last.groupby("trial")}
    step_us = 1e6 * float(first["step_of_W_exact"]["step_s"].iloc[0])
    looks: dict[str, tuple[str, dict[str, Any]]] = {
        "as_published": ("backward Euler, rounded", {"marker": "o", "color": REBUILT}),
        "step_of_W_exact": (f"unrounded, {step_us:.3g} µs", {"marker": "s", "color": THIRD}),
        "by_hand": ("trapezoidal, $c$ by hand", {"marker": "^", "color": OTHER}),
    }
    for trial, (name, look) in looks.items():
        instants = first[trial]["instant"]
        axes.plot(e.Y, instants, label=name, lw=0.8, ms=4.0, **look)
    axes.axhline(0.0, color=PRINTED["color"], lw=0.6, ls=":")
    axes.set_ylim(-0.42, 0.62)
    axes.legend(loc="upper center", fontsize=7.5, handletextpad=0.4, labelspacing=0.2)
    axes.set_ylabel("sampling instant of $a$ (steps)")


def _integrals(axes: Axes, e: Evidence) -> None:
    """Draw (b) W and b: deviation from exact, 1e-4 of it, printed and by each scheme."""

    def off(values: Any, symbol: str) -> np.ndarray:
        return np.asarray(1e4 * (np.asarray(values) / e.of("exact", symbol).to_numpy() - 1.0))

    schemes = e.schemes[e.schemes["coefficients"] == "rounded"]
    chosen, other = {"color": REBUILT, "lw": 1.0}, {"color": FAINT, "lw": 0.6, "zorder": 2}
    for scheme, rows in schemes.groupby("scheme", sort=False):
        look: dict[str, Any] = chosen | {"zorder": 3} if scheme == "backward-euler" else other
        for symbol, column, style in (("W", "W_J", "-"), ("b", "b_m2_per_s", "--")):
            axes.plot(e.Y, off(rows[column], symbol), style, **look)
    for symbol, marker in (("W", "o"), ("b", "s")):
        printed = off(e.printed(symbol), symbol)
        axes.plot(e.Y, printed, label=f"${symbol}$ printed", **PRINTED | {"marker": marker})
    # Named near the level where the lines of W and b are clear of each other.
    _words(axes, 8.0, {"backward Euler": -1.9, "explicit Euler": 1.95, "other schemes": 0.6})
    axes.set_ylim(-4.6, 3.2)
    axes.legend(loc="lower center", ncols=2, fontsize=7.5, handletextpad=0.1, columnspacing=0.8)
    axes.set_ylabel("deviation from exact ($10^{-4}$)")


def _words(axes: Axes, x: float, at: Mapping[str, float]) -> None:
    """Write words for the curves, each at its height."""
    for words, y in at.items():
        axes.text(x, y, words, ha="center", va="center", size=7.5, color=INK)


def _steps(axes: Axes, e: Evidence, oscillator: Oscillator, step_s: float) -> None:
    """Draw (c): the error of c by direct integration against the step, with the law mω²h and the printed c."""
    from .grid import signed_axis  # of matplotlib, and the page takes the evidence alone

    error = e.steps["c_N_s_per_m"] * e.steps["c_relative_error__direct__least_squares"]
    h = 1e6 * e.steps["step_s"]
    for scheme, rows in e.steps.groupby("scheme", sort=False):
        look: dict[str, Any] = {
            "ls": "none",
            "marker": "x",
            "color": FAINT,
            "mew": 0.8,
            "zorder": 3,
        }
        look |= _OF_SCHEME.get(str(scheme), {})
        axes.plot(h[rows.index], error[rows.index], **look)
    line = np.geomspace(h.min(), h.max(), 50)
    for sign in (1.0, -1.0):
        axes.plot(line, sign * 1e-6 * oscillator.m * e.omega**2 * line, color=FAINT, lw=0.8)
    names = {
        r"backward Euler, $m\omega^2h$": 1.2,
        "semi-implicit Euler": 6e-4,
        r"explicit Euler, $-m\omega^2h$": -1.2,
    }
    _words(axes, 11.0, names)
    printed = float(e.printed("c", "least_squares", "direct")[0]) - oscillator.c
    star = {"marker": "*", "ms": 8.0}
    axes.plot([1e6 * step_s], [printed], **(PRINTED | star))
    axes.set_xscale("log")
    signed_axis(axes, SignedScale(1e-6, -10.0, 10.0))
    axes.set_xticks([2, 5, 10, 20, 40, 80], ["2", "5", "10", "20", "40", "80"])
    axes.minorticks_off()
    look = {"columnspacing": 0.5, "handletextpad": 0.1, "handlelength": 1.2, "borderpad": 0.15}
    look |= {"frameon": True, "fancybox": False, "edgecolor": GRID, "framealpha": 1.0}
    axes.legend(loc="center left", bbox_to_anchor=(-0.01, 0.3), ncols=2, fontsize=7.0, **look)
    axes.set(xlabel=r"step $h$ (µs)", ylabel="error of $c$ (N s/m)")
    axes.yaxis.labelpad = 0.0


def _phase(axes: Axes, e: Evidence) -> None:
    """Draw (d): the printed φ and the three phases it might be."""
    from matplotlib import ticker  # slow to import, and the page takes the evidence alone

    for phase, colour, style in (
        ("zero_crossing", OTHER, "--"),
        ("fundamental", THIRD, "-."),
        ("reversal", REBUILT, "-"),
    ):
        values = e.of("exact", f"phi_{phase}")
        axes.plot(e.Y, values, label=phase.replace("_", " "), ls=style, color=colour)
    axes.plot(e.Y, e.printed("phi"), label="printed", **PRINTED)
    axes.legend(loc="lower right", fontsize=7.5, labelspacing=0.2, handlelength=1.6)
    axes.yaxis.set_major_locator(ticker.MaxNLocator(5))
    axes.set_ylabel(r"$\varphi$ (rad)")


def _slip_time(axes: Axes, e: Evidence, step_s: float, unit_s: float) -> None:
    """Draw (e): t_s exact, without a step at each end, in whole units; and as printed."""
    Y, t = e.Y, e.of("exact", "t_s").to_numpy()
    inside = np.floor((t - 2.0 * step_s) / unit_s + 1e-9) * unit_s
    bar: dict[str, Any] = {"marker": "_", "ms": 9.0, "mew": 1.4, "ls": "none", "color": REBUILT}
    axes.plot(Y, 1e3 * t, label="exact", color=OTHER, ls="--")
    axes.plot(Y, 1e3 * inside, label="reconstructed", **bar)
    axes.plot(Y, 1e3 * e.printed("t_s"), label="printed", **PRINTED)
    axes.legend(loc="upper right", fontsize=7.5, labelspacing=0.2, handlelength=1.6)
    axes.set_ylabel("$t_s$ (ms)")


def _sign(axes: Axes, e: Evidence) -> None:
    """Draw (f): the pairs by V_s, as computed with either sign, less the printed number, in units of its last digit."""

    def pairs(column: str, symbol: str, approach: str) -> pd.Series:
        return e.of(column, symbol, "pair", approach)[e.numbers["sharing"] == "common"]

    terms = [term for term in TERMS.values() if (pairs("printed", term.symbol, "V_s") != "").any()]
    labels: list[str] = []
    axes.axhspan(-0.5, 0.5, color=STICK, alpha=0.2, lw=0, zorder=0)
    for name, marker, colour, sign in (
        ("V_s", "o", REBUILT, "+"),
        ("V_s with minus", "^", OTHER, "−"),
    ):
        for n, term in enumerate(terms):
            labels = list(pairs("line", term.symbol, name))
            printed = pairs("printed", term.symbol, "V_s")
            unit = math.pow(10.0, -max(len(text.partition(".")[2]) for text in printed))
            obtained = pairs("as_published", term.symbol, name)
            off = (obtained.to_numpy() - printed.astype(float).to_numpy()) / unit
            places = np.arange(len(labels)) + 0.28 * (n - 0.5 * (len(terms) - 1))
            look: dict[str, Any] = {"ls": "none", "marker": marker, "ms": 4.0, "color": colour}
            look |= {"mfc": "none"} if n else {}
            axes.plot(places, off, label=f"${term.symbol}$, {sign}", **look)
    axes.set_yscale("asinh", linear_width=0.5)
    axes.set_ylim(-150.0, 900.0)
    axes.set_yticks([-100, -10, -1, 0, 1, 10], ["−100", "−10", "−1", "0", "1", "10"])
    axes.minorticks_off()
    axes.set_xticks(range(len(labels)), labels)
    axes.set_xlim(-0.6, len(labels) - 0.4)
    tight = {"columnspacing": 0.6, "handletextpad": 0.1, "labelspacing": 0.15}
    axes.legend(loc="upper right", ncols=2, fontsize=7.0, **tight)
    axes.set_xlabel("pair of levels, columns by $V_s$")
    axes.set_ylabel("deviation (units of last digit)", labelpad=1.0)


GLANCE = {
    "paper’s fit": "reversal",
    r"mean $\varphi$ (ours)": "mean",
    r"own $\varphi_1$": "fundamental",
    "Fourier balance": "fourier",
}
"""Label → its way of `comparison.WAYS_TO_COMPARE`. The fit with a mean φ is ours: the paper takes that phase in its
pairs, and each level's φ in its least squares."""


@styled()
def glance(evidence: Evidence, c: float, effective_c: float) -> Figure:
    """Draw two panels: (a) the damping: the true one, the one that the simulated motion shows, and those by direct
    integration from the rebuilt simulation and in print; (b) the errors of F_k by least squares at each frequency.

    c : true damping, N s/m.   effective_c : `replication.authors_route.effective_damping`, N s/m.
    """
    e, fit = evidence, ("c", "least_squares", "direct")
    rebuilt, printed = float(e.of("as_published", *fit).iloc[0]), float(e.printed(*fit)[0])
    frequencies = select(e.numbers, quantity="omega", kind="parameter")["exact"].to_list()
    fits = select(e.numbers, quantity="F_k", kind="least_squares", unit="%")
    figure = page(DOUBLE_COLUMN, 53.0)
    left, right = (place(figure, x, 11.0, wide, 36.0) for x, wide in ((28.0, 50.0), (96.0, 82.0)))
    rows = {
        "true $c$": (c, {"marker": "D", "color": INK}),
        r"rounded $c + m\omega^2h$": (effective_c, {"marker": "^", "color": FAINT}),
        "rebuilt": (rebuilt, {"marker": "s", "color": REBUILT}),
        "printed": (printed, {"marker": "o", "color": PRINTED["color"]}),
    }
    for n, (value, mark) in enumerate(rows.values()):
        left.plot([value], [n], ls="none", ms=4.5, zorder=3, **mark)
        note(left, f"{value:.4f}", (value, n), (5.0, 0.0), "left", "center", size=8.0)
    arrow(left, (c, 1.0), (c + 0.96 * (effective_c - c), 1.0), FAINT)
    left.axvline(c, color=FAINT, lw=0.5, ls=":")
    left.axvline(printed, color=PRINTED["color"], lw=0.5, ls=":")
    left.set_yticks(range(len(rows)), list(rows))
    left.set_ylim(len(rows) - 0.5, -0.6)
    reach = max(abs(effective_c - c), abs(printed - c))
    left.set_xlim(c - 0.25 * reach, c + 1.6 * reach)
    left.ticklabel_format(axis="x", useOffset=False)
    left.locator_params(axis="x", nbins=4)
    left.tick_params(axis="y", length=0)
    left.set_xlabel("$c$ by direct integration, all levels (N s/m)")
    # (b) on an axis that is linear about zero, so that the sign shows
    for n, ((label, way), look) in enumerate(zip(GLANCE.items(), _MARKERS, strict=True)):
        values = select(fits, **dict(zip(WAY, WAYS_TO_COMPARE[way], strict=True)))["exact"]
        places = [f + 0.24 * (n - 1.5) for f in range(len(frequencies))]
        right.vlines(places, 0.0, values, color=look["color"], lw=1.2)
        right.plot(places, values, ls="none", ms=4.5, label=label, **look)
        for at in zip(places, values, strict=True):
            text = f"{at[1]:+#.2g}".rstrip(".").replace("-", "−")
            # below the last mark, clear of the stems of the others
            up = at[1] > 0.0 and n < len(_MARKERS) - 1
            shift, va = (4.0, "bottom") if up else (-4.0, "top")
            note(right, text, at, (0.0, shift), "center", va, size=7.0)
    right.axhline(0.0, color=INK, lw=0.6)
    right.set_yscale("asinh", linear_width=0.05)
    right.set_ylim(-1500.0, 4000.0)
    ticks = [-100, -10, -1, 0, 1, 10, 100]
    right.set_yticks(ticks, [f"{tick:+d}".replace("-", "−") if tick else "0" for tick in ticks])
    right.minorticks_off()
    right.set_xlim(-0.55, len(frequencies) - 0.4)
    right.set_xticks(range(len(frequencies)), [f"{hz:g} Hz" for hz in frequencies])
    right.tick_params(axis="x", length=0)
    right.legend(loc="upper center", ncols=4, fontsize=7.2, handletextpad=0.1, columnspacing=0.7)
    right.set_ylabel("error of $F_k$ (%)", labelpad=1.0)
    for axes, letter in ((left, "a"), (right, "b")):
        panel_letter(axes, letter)
    return figure
