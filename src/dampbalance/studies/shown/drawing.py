"""The figure of a study: errors along one axis, or the error of c against the step of fixed-step schemes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from ...balance import takes_phase
from ...figures.style import (
    APPROACH_LOOKS,
    DOUBLE_COLUMN,
    FAINT,
    HALO,
    MM,
    SINGLE_COLUMN,
    page,
    place,
    styled,
)
from ...model import Oscillator
from ...motion.fixed_step import SCHEMES
from ..parameters import PARAMETERS
from ..settings import Study, chosen
from ..stretches import column_of
from .facts import worst_errors
from .logarithmic import is_logarithmic, logarithmic_ticks
from .maps import share_map
from .scatter import errors_of_runs

Array = NDArray[np.float64]

EXACT = 1e-7  # relative error: an approach nowhere worse is exact but for rounding, and named, not drawn
FLOOR, CEILING = 1e-3, 1e3  # %, the least and the largest error an axis reaches to

LEFT, RIGHT, BOTTOM, TOP = 15.0, 3.0, 19.0, 7.0  # mm, margins of the page
HEIGHT, ROW_GAP, COLUMN_GAP = 44.0, 4.0, 3.5  # mm

_WIDTHS = {"X_s": 2.4, "t_s": 1.5, "V_s": 0.7}  # where curves coincide, all can be seen

PHASE_NAMES = {
    "reversal": "phase of the velocity reversal",
    "zero_crossing": "phase of the zero crossing",
    "fundamental": "phase of the fundamental",
}
SCHEME_LOOKS = {
    "backward-euler": ("backward Euler", "#D55E00", "s"),
    "explicit-euler": ("explicit Euler", "#0B4F8A", "o"),
    "semi-implicit-euler": ("semi-implicit Euler", "#B57EDC", "v"),
    "trapezoidal": ("trapezoidal rule", "#3DAA8B", "^"),
    "rk4": ("Runge–Kutta 4", "#000000", "D"),
}


def study_figure(study: Study, cases: str | Path) -> Figure:
    """The figure that the study's file asks for, from its table of cases."""
    kinds = {
        "curves": error_curves,
        "steps": error_of_steps,
        "map": share_map,
        "scatter": errors_of_runs,
    }
    figure: Figure = kinds[study.figure["kind"]](study, cases)
    return figure


def alternative_text(study: Study) -> str:
    """What the figure shows, in one sentence."""
    axis = PARAMETERS[study.figure["x"]].meaning
    if study.figure["kind"] == "map":
        other = PARAMETERS[study.figure["y"]].meaning
        return f"{study.title}: share of the cases with a small error, over {axis} and {other}."
    if study.figure["kind"] == "scatter":
        return f"{study.title}: rms error of the identified F_k and c, and their standard error, against {axis}."
    return f"{study.title}: size of the error of the identified F_k and c against {axis}."


@styled()
def error_curves(study: Study, cases: str | Path) -> Figure:
    """Size of the relative error of F_k (top) and c (bottom), %, along the axis x; a curve per approach.

    Columns of panels: phase definitions, or the values of another axis. Solid: φ and t_s of each level; dashed: common
    to the levels. Where several fits are meant (all pairs) the worst is drawn.
    """
    settings = study.figure
    x = column_of(cases, settings["x"])
    panels = list(_panels(study, cases))
    fits = chosen(study.fits, {"fit": "least_squares"} | dict(settings))
    approaches = list(dict.fromkeys(fit.approach for fit in fits))
    sharings = [name for name in ("individual", "common") if any(f.sharing == name for f in fits)]
    width = (DOUBLE_COLUMN - LEFT - RIGHT - (len(panels) - 1) * COLUMN_GAP) / len(panels)
    figure = page(DOUBLE_COLUMN, BOTTOM + 2 * HEIGHT + ROW_GAP + TOP)
    exact: dict[str, float] = {}
    for bottom, quantity in ((BOTTOM + HEIGHT + ROW_GAP, "F_k"), (BOTTOM, "c")):
        drawn = []
        row = []
        for column, (title, phase, kept) in enumerate(panels):
            axes = place(figure, LEFT + column * (width + COLUMN_GAP), bottom, width, HEIGHT)
            row.append(axes)
            for approach in approaches:
                for sharing in ("",) if not takes_phase(approach) else sharings:
                    spec = {"fit": "least_squares"} | dict(settings)
                    spec |= {"of": quantity, "approach": approach, "sharing": sharing}
                    spec |= {"phase": phase} if phase else {}
                    error = np.abs(worst_errors(study, cases, spec)[kept])
                    worst = _largest(error)
                    if worst < EXACT:
                        exact[approach] = max(worst, exact.get(approach, 0.0))
                        continue
                    drawn.append(100.0 * error)
                    _curve(axes, x[kept], 100.0 * error, approach, dashed=sharing == "common")
            _x_axis(axes, study, x, last=column == len(panels) - 1)
            axes.tick_params(labelbottom=quantity == "c", labelleft=column == 0)
            if quantity == "F_k" and title:
                axes.set_title(title, pad=4.0)
        _decades(row, drawn)
        row[0].set_ylabel(f"error of ${quantity}$ (%)")
        row[0].yaxis.set_label_coords(-11.0 / width, 0.5)
        for axes in row:
            _marks(axes, study, label=quantity == "F_k")
    _text_below(figure, _axis_label(settings["x"]), 11.0)
    _legend(figure, approaches, sharings, exact)
    return figure


@styled()
def error_of_steps(study: Study, cases: str | Path) -> Figure:
    """Size of the error of c, N s/m, by direct integration against the step of each scheme, with the line m ω² h.

    The line is what a first-order scheme adds to c (backward Euler) or takes from it (explicit Euler) near resonance:
    `timestepping.Scheme.balance_bias`.
    """
    h, scheme = column_of(cases, "step_s"), column_of(cases, "scheme")
    error = worst_errors(study, cases, {"of": "c", "approach": "direct"})
    c, m, omega, k = (
        column_of(cases, name) for name in ("c_N_s_per_m", "m_kg", "omega_rad_per_s", "k_N_per_m")
    )
    figure = page(SINGLE_COLUMN + 35.0, 74.0)
    axes = place(figure, 16.0, 12.0, SINGLE_COLUMN - 20.0, 60.0)
    osc = Oscillator(m=m[0], c=c[0], k=k[0], K_z=1.0, F_k=0.0)
    line = np.geomspace(h.min(), h.max(), 50)
    bias = [abs(SCHEMES["backward-euler"].balance_bias(osc, omega[0], step)) for step in line]
    axes.plot(line, bias, color=FAINT, lw=2.5, alpha=0.45, zorder=0)
    handles = [Line2D([], [], color=FAINT, lw=2.5, alpha=0.45, label=r"$m\omega^2 h$")]
    for name, (label, colour, marker) in SCHEME_LOOKS.items():
        kept = scheme == name
        if not kept.any():
            continue
        order = np.argsort(h[kept])
        axes.plot(
            h[kept][order],
            np.abs(error[kept] * c[kept])[order],
            color=colour,
            marker=marker,
            ms=3.4,
            mfc="white",
            mew=0.7,
            lw=0.7,
        )
        handles.append(
            Line2D(
                [],
                [],
                color=colour,
                marker=marker,
                ms=3.4,
                mfc="white",
                mew=0.7,
                lw=0.7,
                label=label,
            )
        )
    logarithmic_ticks(axes, "x", h.min(), h.max())
    axes.set_yscale("log")
    axes.grid(color="#E4E4E4", lw=0.4)
    axes.set_xlabel("step $h$ (s)")
    axes.set_ylabel(r"$|c_\mathrm{identified} - c|$ (N s/m)")
    _marks(axes, study, label=True)
    figure.legend(handles=handles, loc="center left", bbox_to_anchor=(0.71, 0.55))
    return figure


def _panels(study: Study, cases: str | Path) -> Iterator[tuple[str, str, NDArray[np.bool_]]]:
    """(title, phase or "", which cases) of each column of panels."""
    everything = np.ones(study.cases, dtype=bool)
    by = study.figure.get("panels")
    if by is None:
        yield "", str(study.figure.get("phase", "")), everything
    elif by == "phase":
        for phase in dict.fromkeys(fit.phase for fit in study.fits if fit.phase):
            yield PHASE_NAMES[phase], phase, everything
    else:
        values = column_of(cases, by)
        p = PARAMETERS[by]
        unit = "" if p.unit in ("", "1") else f" {p.unit}"
        for value in dict.fromkeys(values.tolist()):
            shown = value if isinstance(value, str) else f"{value:.4g}"
            title = f"${p.symbol}$ = {shown}{unit}" if p.symbol else f"{p.meaning}: {shown}"
            yield title, str(study.figure.get("phase", "")), values == value


def _curve(axes: Axes, x: Array, error: Array, approach: str, dashed: bool) -> None:
    look = APPROACH_LOOKS[approach]
    order = np.argsort(x, kind="stable")
    few = len(x) <= 24
    axes.plot(
        x[order],
        np.maximum(error[order], 1e-2 * FLOOR),
        color=look.colour,
        ls=(0, (4, 2)) if dashed else "-",
        lw=_WIDTHS.get(approach, 0.9),
        marker=look.marker if few else None,
        ms=3.2,
        mfc="white" if dashed else look.colour,
        mew=0.7,
    )


def _x_axis(axes: Axes, study: Study, x: Array, last: bool) -> None:
    name = study.figure["x"]
    places = np.unique(x)
    margin = 0.0
    if PARAMETERS[name].whole:
        axes.set_xticks(places)
        axes.minorticks_off()
        margin = 0.4
    elif is_logarithmic(places):
        logarithmic_ticks(axes, "x", places[0], places[-1], ends=last)
    axes.set_xlim(places[0] - margin, places[-1] + margin)


def _decades(row: Sequence[Axes], drawn: Sequence[Array]) -> None:
    """One logarithmic axis for a row of panels: whole decades around the curves, within FLOOR and CEILING."""
    known = [error[np.isfinite(error) & (error > 0.0)] for error in drawn]
    sizes = np.concatenate(known) if known else np.empty(0)
    low, high = (np.quantile(sizes, 0.02), sizes.max()) if sizes.size else (0.1, 10.0)
    bottom = max(FLOOR, 10.0 ** math.floor(math.log10(low)))
    top = max(10.0 * bottom, min(CEILING, 10.0 ** math.ceil(math.log10(high))))
    for axes in row:
        axes.set_yscale("log")
        axes.set_ylim(bottom, top)
        axes.yaxis.set_major_locator(LogLocator(base=10.0, numticks=20))
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.grid(axis="y", color="#E4E4E4", lw=0.4)


def _marks(axes: Axes, study: Study, label: bool) -> None:
    for name, value in study.figure.get("marks", {}).items():
        axes.axvline(value, color=FAINT, lw=0.6, ls=(0, (1, 1.5)), zorder=0)
        if label:
            to_share = axes.transScale + axes.transLimits  # of the axis, where the mark stands
            at_end = to_share.transform((value, axes.get_ylim()[0]))[0] > 0.85
            axes.annotate(
                _marked(name),
                xy=(value, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(-1.5 if at_end else 1.5, -2.5),
                textcoords="offset points",
                ha="right" if at_end else "left",
                va="top",
                size=7.5,
                color=FAINT,
                bbox=HALO,
            )


def _marked(name: str) -> str:
    number = name.removeprefix("omega")
    return rf"$\omega_{{{number}}}$" if name.startswith("omega") and number.isdigit() else name


def _axis_label(name: str) -> str:
    p = PARAMETERS[name]
    unit = "" if p.unit in ("", "1") else f" ({p.unit})"
    return f"${p.symbol}${unit}" if p.symbol else p.meaning


def _legend(
    figure: Figure, approaches: Sequence[str], sharings: Sequence[str], exact: Mapping[str, float]
) -> None:
    handles: list[Line2D] = []
    for key in approaches:
        look = APPROACH_LOOKS[key]
        label = look.label
        if key in exact:
            power = math.ceil(math.log10(100.0 * max(exact[key], 1e-16)))
            label += rf" (below $10^{{{power}}}$ %)"
        handles.append(
            Line2D([], [], color=look.colour, lw=0.0 if key in exact else 1.2, label=label)
        )
    if len(sharings) > 1:
        for name, style in (("individual", "-"), ("common", (0, (4, 2)))):
            handles.append(
                Line2D([], [], color=FAINT, lw=0.9, ls=style, label=rf"{name} $\phi$, $t_s$")
            )
    figure.legend(
        handles=handles,
        loc="center",
        bbox_to_anchor=_centre(figure, 4.0),
        ncols=len(handles),
        columnspacing=1.2,
        handlelength=1.8,
        handletextpad=0.5,
    )


def _text_below(figure: Figure, text: str, level: float) -> None:
    figure.text(*_centre(figure, level), text, ha="center", va="center")


def _centre(figure: Figure, level: float) -> tuple[float, float]:
    height = float(figure.get_size_inches()[1]) / MM
    return (LEFT + 0.5 * (DOUBLE_COLUMN - LEFT - RIGHT)) / DOUBLE_COLUMN, level / height


def _largest(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else 0.0
