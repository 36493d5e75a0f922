"""The figure that shows how the printed digits arose: the paper's numbers beside what each cause would make of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..balance import TERMS
from ..model import Oscillator
from .looks import LOOKS, SCHEME_LOOKS, SPARE
from .series import SignedScale
from .style import DOUBLE_COLUMN, FAINT, INK, STICK, page, panel_letter, place, styled

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALT = (
    "Six panels. Integrals of Table 2 lie on the curves of backward Euler and off those of other schemes; the "
    "identified damping grows with the step and meets the printed value at the step of the rebuild, while explicit "
    "Euler takes away as much; rounded coefficients bring the input work onto the print; printed phases follow the "
    "velocity reversal, not the zero crossing; printed slip times are whole tenths of a millisecond; a plus sign gives "
    "the printed pairs by slip velocity, a minus does not."
)

PRINTED: dict[str, Any] = {"marker": "o", "ls": "none", "color": STICK, "ms": 4.2, "zorder": 5}
REBUILT, OTHER, THIRD = LOOKS["X_s"].colour, LOOKS["V_s"].colour, SPARE[0].colour
_OF_SCHEME = {
    "backward-euler": (REBUILT, "o"),
    "explicit-euler": (OTHER, "D"),
    "trapezoidal": (FAINT, "v"),
    "rk4": (FAINT, "^"),
}
LEFT, WIDTH, GAP = 15.0, 42.0, 17.0  # mm
BOTTOM, HEIGHT, ROW_GAP, TOP = 11.0, 38.0, 20.0, 6.0


class Evidence(NamedTuple):
    """What the figure is drawn from, all at the first frequency.

    claims : the table of claims, as text (id, printed).   exact : features.   estimates : as published.
    schemes : of `article.schemes.scheme_table`.   steps : cases of the study of the step, with columns scheme, step_s,
    c_N_s_per_m and c_relative_error__direct__least_squares.
    """

    claims: pd.DataFrame
    exact: pd.DataFrame
    estimates: pd.DataFrame
    schemes: pd.DataFrame
    steps: pd.DataFrame

    def printed(self, prefix: str) -> np.ndarray:
        """The printed numbers whose identifier begins so, in order."""
        return self._texts(prefix).astype(float).to_numpy()

    def last_digit(self, prefix: str) -> float:
        """One unit in the last digit of the printed numbers whose identifier begins so."""
        places = max(len(text.partition(".")[2]) for text in self._texts(prefix))
        return math.pow(10.0, -places)

    def slip_times(self, step_s: float, unit_s: float) -> np.ndarray:
        """The exact t_s, without a step at each end, in whole units, s."""
        inside = self.exact["t_s_s"].to_numpy() - 2.0 * step_s
        return np.asarray(np.floor(inside / unit_s + 1e-9) * unit_s)

    def _texts(self, prefix: str) -> pd.Series:
        return self.claims.loc[self.claims["id"].str.startswith(prefix), "printed"]


@styled()
def numerics(
    evidence: Evidence, oscillator: Oscillator, step_s: float, t_s_unit_s: float
) -> Figure:
    """Six panels (a)–(f): scheme, step, rounded coefficients, phase, slip time, sign.

    step_s : of the rebuilt simulation, s.   t_s_unit_s : the unit in which t_s was read, s.
    """
    figure = page(DOUBLE_COLUMN, BOTTOM + 2 * HEIGHT + ROW_GAP + TOP)
    axes = [
        place(figure, LEFT + n * (WIDTH + GAP), bottom, WIDTH, HEIGHT)
        for bottom in (BOTTOM + HEIGHT + ROW_GAP, BOTTOM)
        for n in range(3)
    ]
    _integrals(axes[0], evidence)
    _steps(axes[1], evidence, oscillator, step_s)
    _coefficients(axes[2], evidence)
    _phase(axes[3], evidence)
    _slip_time(axes[4], evidence, step_s, t_s_unit_s)
    _sign(axes[5], evidence)
    for panel in (axes[0], axes[2], axes[3], axes[4]):
        panel.set_xticks(1e3 * evidence.exact["Y_m"])
    for panel, letter in zip(axes, "abcdef", strict=True):
        panel_letter(panel, letter)
    return figure


def _integrals(axes: Axes, e: Evidence) -> None:
    """(a) W and b: deviation from exact, printed and by each scheme."""
    Y = 1e3 * e.exact["Y_m"]
    schemes = e.schemes[e.schemes["coefficients"] == "rounded"]
    for scheme, rows in schemes.groupby("scheme", sort=False):
        chosen = scheme == "backward-euler"
        for column, style in (("W_J", "-"), ("b_m2_per_s", "--")):
            look: dict[str, Any] = {"color": REBUILT, "lw": 1.0, "zorder": 3}
            look = look if chosen else {"color": FAINT, "lw": 0.6, "zorder": 2}
            name = f"${column[0]}$, {SCHEME_LOOKS[str(scheme)][0]}"
            axes.plot(Y, deviation(rows[column], e.exact[column]), style, gid=name, **look)
    for name, column, marker in (("W", "W_J", "o"), ("b", "b_m2_per_s", "s")):
        off = deviation(e.printed(f"table2.{name}."), e.exact[column])
        look = PRINTED | {"marker": marker, "label": f"${name}$ printed"}
        axes.plot(Y, off, gid=look["label"], **look)
    # Named beside the level where the lines of W and b are clear of each other.
    for text, at in (("backward Euler", -1.9), ("explicit Euler", 1.95), ("the others", 0.6)):
        axes.text(8.0, at, text, ha="center", va="center", size=7.5, color=INK)
    axes.set_ylim(-4.6, 3.2)
    axes.legend(loc="lower center", ncols=2, fontsize=7.5, handletextpad=0.1, columnspacing=0.8)
    axes.set(xlabel="$Y$ (mm)", ylabel="deviation from exact ($10^{-4}$)")


def deviation(values: pd.Series | np.ndarray, exact: pd.Series) -> np.ndarray:
    """How far values lie from the exact ones, in 1e-4 of these."""
    return np.asarray(1e4 * (np.asarray(values) / exact.to_numpy() - 1.0))


def _steps(axes: Axes, e: Evidence, oscillator: Oscillator, step_s: float) -> None:
    """(b) The error of c by direct integration against the step, with the law mω²h and the printed c."""
    from .grid import signed_axis  # of matplotlib, and the page takes the evidence alone

    error = e.steps["c_N_s_per_m"] * e.steps["c_relative_error__direct__least_squares"]
    h = 1e6 * e.steps["step_s"]
    for scheme, rows in e.steps.groupby("scheme", sort=False):
        colour, marker = _OF_SCHEME.get(str(scheme), (FAINT, "x"))
        look: dict[str, Any] = {"ls": "none", "marker": marker, "ms": 3.4, "color": colour}
        look |= {"mew": 0.8} | ({"zorder": 4} if marker == "o" else {"zorder": 3, "mfc": "none"})
        name, _ = SCHEME_LOOKS[str(scheme)]
        axes.plot(h[rows.index], error[rows.index], gid=name, **look)
    line = np.geomspace(h.min(), h.max(), 50)
    omega = float(e.exact["omega_rad_per_s"].iloc[0])
    for sign in (1.0, -1.0):
        axes.plot(line, sign * 1e-6 * oscillator.m * omega**2 * line, color=FAINT, lw=0.8)
    names = (
        (r"backward Euler, $m\omega^2h$", 0.9),
        ("semi-implicit Euler", 3e-4),
        ("trapezoidal, Runge–Kutta", -2e-5),
        (r"explicit Euler, $-m\omega^2h$", -0.9),
    )
    for text, at in names:
        axes.text(12.0, at, text, ha="center", va="center", size=7.5)
    printed = float(e.printed("text.c_direct_ls")[0]) - oscillator.c
    star = {"marker": "*", "ms": 8.0, "gid": "printed"}
    axes.plot([1e6 * step_s], [printed], **(PRINTED | star))
    axes.set_xscale("log")
    signed_axis(axes, SignedScale(1e-6, -10.0, 10.0))
    axes.set_xticks([2, 5, 10, 20, 40, 80], ["2", "5", "10", "20", "40", "80"])
    axes.minorticks_off()
    axes.set(xlabel=r"step $h$ (µs)", ylabel="error of $c$ (N s/m)")
    axes.yaxis.labelpad = 0.0


def _coefficients(axes: Axes, e: Evidence) -> None:
    """(c) What is left of the printed W beside the simulation, with rounded and with exact coefficients."""
    Y = 1e3 * e.exact["Y_m"]
    euler = e.schemes[e.schemes["scheme"] == "backward-euler"]
    for name, marker, colour in (("rounded", "o", REBUILT), ("exact", "^", OTHER)):
        W = euler.loc[euler["coefficients"] == name, "W_J"].to_numpy()
        off = 1e6 * (e.printed("table2.W.") / W - 1.0)
        label = f"{name} $c/m$, $k/m$"
        axes.plot(Y, off, marker=marker, color=colour, lw=0.8, label=label, gid=label)
    axes.axhline(0.0, color=PRINTED["color"], lw=0.6, ls=":")
    axes.set_ylim(-0.7, 3.9)
    axes.legend(loc="upper center", fontsize=7.5, handletextpad=0.4, labelspacing=0.2)
    axes.set(xlabel="$Y$ (mm)", ylabel="$W$ printed over rebuilt $-1$ ($10^{-6}$)")


def _phase(axes: Axes, e: Evidence) -> None:
    """(d) The printed φ and the three phases it might be."""
    from matplotlib import ticker  # slow to import, and the page takes the evidence alone

    Y = 1e3 * e.exact["Y_m"]
    for phase, text, colour, style in (
        ("zero_crossing", "zero crossing", OTHER, "--"),
        ("fundamental", "fundamental", THIRD, "-."),
        ("reversal", "reversal", REBUILT, "-"),
    ):
        axes.plot(Y, e.exact[f"phi_{phase}_rad"], style, color=colour, label=text, gid=text)
    axes.plot(Y, e.printed("table1.phi."), **(PRINTED | {"label": "printed", "gid": "printed"}))
    axes.legend(loc="lower right", fontsize=7.5, labelspacing=0.2, handlelength=1.6)
    axes.yaxis.set_major_locator(ticker.MaxNLocator(5))
    axes.set(xlabel="$Y$ (mm)", ylabel=r"$\varphi$ (rad)")


def _slip_time(axes: Axes, e: Evidence, step_s: float, unit_s: float) -> None:
    """(e) t_s exact, without a step at each end, in whole units; and as printed."""
    Y = 1e3 * e.exact["Y_m"].to_numpy()
    t = e.exact["t_s_s"].to_numpy()
    whole = e.slip_times(step_s, unit_s)
    axes.plot(Y, 1e3 * t, color=OTHER, ls="--", label="exact", gid="exact")
    label = f"whole {1e3 * unit_s:g} ms inside"
    bar: dict[str, Any] = {"marker": "_", "ms": 9.0, "mew": 1.4, "ls": "none", "color": REBUILT}
    axes.plot(Y, 1e3 * whole, label=label, gid=label, **bar)
    t_s = 1e3 * e.printed("table1.t_s.")
    axes.plot(Y, t_s, **(PRINTED | {"label": "printed", "gid": "printed"}))
    axes.legend(loc="upper right", fontsize=7.5, labelspacing=0.2, handlelength=1.6)
    axes.set(xlabel="$Y$ (mm)", ylabel="$t_s$ (ms)")


def _sign(axes: Axes, e: Evidence) -> None:
    """(f) The pairs by V_s, as computed with either sign, less the printed number, in units of its last digit."""
    pairs = e.estimates[(e.estimates["kind"] == "pair") & (e.estimates["phase"] == "common")]
    looks = {"V_s": ("o", REBUILT, "+"), "V_s with minus": ("^", OTHER, "−")}
    terms = [term for term in TERMS.values() if e.printed(f"table3.V_s.{term.symbol}.").size]
    labels: list[str] = []
    axes.axhspan(-0.5, 0.5, color=STICK, alpha=0.2, lw=0, zorder=0)
    for name, (marker, colour, sign) in looks.items():
        rows = pairs[pairs["approach"] == name]
        labels = list(rows["pair"])
        for n, term in enumerate(terms):
            printed = f"table3.V_s.{term.symbol}."
            off = (rows[term.column].to_numpy() - e.printed(printed)) / e.last_digit(printed)
            places = np.arange(len(labels)) + 0.28 * (n - 0.5 * (len(terms) - 1))
            look: dict[str, Any] = {"ls": "none", "marker": marker, "ms": 4.0, "color": colour}
            look |= {"mfc": "none"} if n else {}
            label = f"${term.symbol}$, {sign}"
            axes.plot(places, off, label=label, gid=label, **look)
    axes.set_yscale("asinh", linear_width=0.5)
    axes.set_ylim(-150.0, 900.0)
    axes.set_yticks([-100, -10, -1, 0, 1, 10], ["−100", "−10", "−1", "0", "1", "10"])
    axes.minorticks_off()
    axes.set_xticks(range(len(labels)), labels)
    axes.set_xlim(-0.6, len(labels) - 0.4)
    tight = {"columnspacing": 0.6, "handletextpad": 0.1, "labelspacing": 0.15}
    axes.legend(loc="upper right", ncols=2, fontsize=7.0, **tight)
    axes.set_xlabel("pair of levels, columns by $V_s$")
    axes.set_ylabel("off by units of last digit", labelpad=1.0)
