"""The figure of a study: errors along one axis, the error of c against the step of fixed-step schemes, laws chosen, or
what `maps` and `scatter` draw."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from ...balance import TERMS
from ...figures.grid import NAMED, clear_labels, grid, signed_axis
from ...figures.looks import SCHEME_LOOKS, in_maths, label_of, look_of, named
from ...figures.series import COMMON, INDIVIDUAL, signed_scale
from ...figures.style import (
    DASHED,
    DOTTED,
    DOUBLE_COLUMN,
    FAINT,
    INK,
    PAPER,
    SINGLE_COLUMN,
    note,
    omega_of,
    page,
    place,
    styled,
)
from ...project.wording import in_figure, listed
from ..parameters import PARAMETERS, in_tex
from ..routes import NONE
from ..settings import Study
from . import error_curves as curves
from .confusion import confusion, laws_in
from .logarithmic import logarithmic_ticks
from .maps import error_map
from .scatter import errors_of_runs

LEAST_BIAS = 1e-6  # N s/m: a smaller error of c is drawn on a linear axis
LEFT, BOTTOM, TOP, CELL = 34.0, 4.0, 20.0, 9.0  # mm, around and in the matrix of laws
_WORDS = 33.0  # mm, of a column of words next to the cells
_DARK = 0.5  # share of a row from which on its number is white


def study_figure(study: Study, cases: str | Path) -> Figure:
    """The figure that the study's file asks for, from its table of cases."""
    kinds = {"curves": error_curves, "steps": error_of_steps}
    kinds |= {"map": error_map, "scatter": errors_of_runs, "confusion": confusion_matrix}
    return kinds[study.figure["kind"]](study, cases)


def alternative_text(study: Study) -> str:
    """What the figure shows, in one sentence."""
    identified, figure = f"the identified {listed(list(TERMS))}", study.figure
    x, y = (PARAMETERS[figure.get(axis, figure["x"])].meaning for axis in ("x", "y"))
    shown = {
        "curves": f"error of {identified} against {x}",
        "steps": f"error of {identified} against {x}",
        "map": f"error of {identified} over {x} and {y}, with lines at powers of ten",
        "scatter": f"size that 95 % of the errors of {identified} do not exceed, and coverage, against {x}",
        "confusion": "how often each law is chosen for records of each true law",
    }
    return f"{study.title}: {shown[figure['kind']]}."


@styled()
def error_curves(study: Study, cases: str | Path) -> Figure:
    """Relative error, %, with its sign, along the axis x; a row of panels per term, a curve per approach.

    Columns of panels: phase definitions, or the values of another axis. Solid: φ and t_s common to the levels, where
    it has such curves; dashed: of each level.
    """
    shown = curves.error_curves(study, cases)
    panels = grid(len(shown.symbols), len(shown.panels))
    lowest = []
    for row, symbol in enumerate(shown.symbols):
        scale = shown.scale(symbol)
        for column, panel in enumerate(shown.panels):
            axes = panels.panel(row, column)
            for curve in shown.curves[symbol, column]:
                second = curve.sharing == INDIVIDUAL and len(shown.sharings) > 1
                _curve(axes, panel, curve, shown.approaches.index(curve.approach), second)
            _x_axis(axes, shown, last=column == len(shown.panels) - 1)
            signed_axis(axes, scale)
            axes.tick_params(labelbottom=row == len(shown.symbols) - 1, labelleft=column == 0)
            lowest += [axes] if row == len(shown.symbols) - 1 else []
            if row == 0 and panel.value:
                axes.set_title(_title(panel), pad=12.0 if study.figure.get("marks") else 4.0)
            if column == 0:
                panels.name_row(axes, f"error of ${symbol}$ (%)")
            _marks(axes, study, label=row == 0)
    clear_labels(lowest)
    panels.text_below(curves.axis_label(shown.name))
    # the approaches by colour, those that are not drawn by the bound of their error; φ and t_s by the line
    handles = []
    for key in shown.approaches:
        look, bound = look_of(key), shown.exact.get(key)
        style: dict[str, Any] = (
            {"lw": 0.0} if bound is not None else {"lw": 1.2, "marker": look.marker, "ms": 3.2}
        )
        label = curves.bounded_label(key, bound) if bound is not None else in_maths(label_of(key))
        handles.append(Line2D([], [], color=look.colour, label=label, **style))
    for name, fill in ((COMMON, FAINT), (INDIVIDUAL, PAPER)) if len(shown.sharings) > 1 else ():
        style = {"ls": DASHED if name == INDIVIDUAL else "-", "marker": "o", "ms": 3.2, "mfc": fill}
        label = rf"{name} $\varphi$, $t_s$"
        handles.append(Line2D([], [], color=FAINT, lw=0.9, label=label, **style))
    panels.legend_below(handles, columnspacing=1.2, handlelength=1.8, handletextpad=0.5)
    return panels.figure


@styled()
def error_of_steps(study: Study, cases: str | Path) -> Figure:
    """Error of c, N s/m, by direct integration against the step of each scheme, with the lines ±m ω² h."""
    shown = curves.error_of_steps(study, cases)
    first, last = shown.steps[[0, -1]]
    figure = page(SINGLE_COLUMN + 35.0, 76.0)
    axes = place(figure, 16.0, 12.0, SINGLE_COLUMN - 20.0, 60.0)
    h = np.geomspace(first, last, 50)  # s; drawn in µs
    bias: dict[str, Any] = {"color": FAINT, "lw": 2.5, "alpha": 0.45}
    for sign in (1.0, -1.0):
        axes.plot(1e6 * h, sign * shown.line(h), zorder=0, **bias)
    handles = [Line2D([], [], label=r"$\pm m\omega^2 h$", **bias)]
    for name, (steps, errors) in shown.errors.items():
        label, look = SCHEME_LOOKS[name]
        style: dict[str, Any] = {"color": look.colour, "marker": look.marker, "lw": 0.7}
        style |= {"ms": 3.4, "mfc": "white", "mew": 0.7}
        axes.plot(1e6 * steps, errors, gid=label, **style)
        handles.append(Line2D([], [], label=label, **style))
    logarithmic_ticks(axes, "x", 1e6 * first, 1e6 * last)
    if len(shown.steps) <= NAMED:
        axes.set_xticks(1e6 * shown.steps, [f"{1e6 * step:g}" for step in shown.steps])
    axes.set_xlim(0.9e6 * first, 1.1e6 * last)
    errors_of = [errors for _, errors in shown.errors.values()]
    signed_axis(axes, signed_scale(errors_of, LEAST_BIAS, math.inf))
    axes.set_xlabel("step $h$ (µs)")
    axes.set_ylabel(r"$c_\mathrm{identified} - c$ (N s/m)")
    clear_labels([axes])
    _marks(axes, study, label=True, factor=1e6)
    figure.legend(handles=handles, loc="center left", bbox_to_anchor=(0.71, 0.55))
    return figure


@styled()
def confusion_matrix(study: Study, cases: str | Path) -> Figure:
    """Numbers of cases, a row for each true law and a column for each that is chosen; shares in words next to them.

    The shade of a cell is its share of the row. Right choices are framed.
    """
    summary = confusion(cases)
    laws, chosen = list(summary["law"]), laws_in(summary)
    rows, columns = len(laws), len(chosen)
    cell = min(CELL, (DOUBLE_COLUMN - LEFT - 2.0 * _WORDS) / columns)
    figure = page(LEFT + columns * cell + 2.0 * _WORDS, BOTTOM + rows * CELL + TOP)
    axes = place(figure, LEFT, BOTTOM, columns * cell, rows * CELL)
    shares = summary[chosen].to_numpy(dtype=float) / summary["cases"].to_numpy(dtype=float)[:, None]
    axes.pcolormesh(
        np.arange(columns + 1), np.arange(rows + 1), shares, cmap="Blues", vmin=0.0, vmax=1.2
    )
    for i, j in np.ndindex(rows, columns):
        count, share = summary[chosen[j]].iloc[i], shares[i, j]
        colour = "white" if share >= _DARK else INK if count else FAINT
        axes.text(j + 0.5, i + 0.5, f"{count}", ha="center", va="center", color=colour)
        if chosen[j] == laws[i]:
            axes.add_patch(
                Rectangle((j, i), 1.0, 1.0, fill=False, ec=INK, lw=0.9, clip_on=False, zorder=3)
            )
    # names of the laws at the cells
    axes.set_ylim(rows, 0.0)
    named = [law if law == NONE else f"${in_tex(law).replace(' ', '')}$" for law in chosen]
    axes.set_yticks(np.arange(rows) + 0.5, named[:rows])  # the true ones come first
    axes.set_xticks(np.arange(columns) + 0.5, named, rotation=50)
    axes.tick_params(length=0.0, labelbottom=False, labeltop=True)
    for label in axes.get_xticklabels():
        label.set(ha="left", rotation_mode="anchor")
    axes.set_ylabel("true law")
    note(axes, "law chosen", (0.0, 1.0), (-8.0, 8.0), ha="right", xycoords="axes fraction")
    for i in range(1, rows):
        axes.axhline(i, color="white", lw=0.8)
    for place_at, (name, head) in enumerate((("right", "right"), ("extra", "a term too many"))):
        left = columns + (0.12 + place_at) * _WORDS / cell
        axes.text(left, -0.25, head, ha="left", va="bottom", clip_on=False)
        for i, row in enumerate(summary.to_dict("records")):
            part, low, high = (row[f"{name}{end}_percent"] for end in ("", "_low", "_high"))
            text = f"{part:.3g} % ({low:.3g} to {high:.3g})"
            axes.text(left, i + 0.5, text, va="center", size=7.5)
    return figure


def _title(panel: curves.Panel) -> str:
    if panel.axis is None:
        return panel.value
    symbol = panel.axis.symbol
    return f"${symbol}$ = {panel.value}" if symbol else f"{panel.axis.meaning}: {panel.value}"


def _curve(axes: Axes, panel: curves.Panel, curve: curves.Curve, number: int, second: bool) -> None:
    """A curve with the marks of its approach: at every case, or at places apart from those of the other approaches.

    second : whether it is the dashed one of two of this approach.
    """
    look = look_of(curve.approach)
    style: dict[str, Any] = {"ls": "-", "mfc": look.colour, "ms": 3.2, "mew": 0.7, "lw": look.width}
    style |= {"ls": DASHED, "mfc": PAPER} if second else {}
    style |= {"color": look.colour, "marker": look.marker}
    if not panel.few:  # with an edge, which keeps them visible on curves that coincide
        edge = look.colour if second else PAPER
        style |= {"markevery": (0.03 + 0.04 * number, 0.2), "ms": 4.0, "mec": edge}
    axes.plot(panel.x, curve.error, gid=named(curve.approach, curve.sharing), **style)


def _x_axis(axes: Axes, shown: curves.ErrorCurves, last: bool) -> None:
    first_place, last_place = shown.places[[0, -1]]
    margin = 0.0
    if PARAMETERS[shown.name].whole and len(shown.places) <= curves.FEW:
        axes.set_xticks(shown.places)
        axes.minorticks_off()
        margin = 0.4
    elif shown.is_logarithmic:
        logarithmic_ticks(axes, "x", first_place, last_place, ends=last)
    axes.set_xlim(first_place - margin, last_place + margin)


def _marks(axes: Axes, study: Study, label: bool, factor: float = 1.0) -> None:
    """The places on x, times a factor, that the study's figure names, above the frame."""
    for name, value in study.figure.get("marks", {}).items():
        value *= factor
        axes.axvline(value, color=FAINT, lw=0.6, ls=DOTTED, zorder=0)
        if label:
            omega = omega_of(name)
            text = f"${omega}$" if omega else in_figure(name)
            at = ("data", "axes fraction")
            note(axes, text, (value, 1.0), (0.0, 1.5), "center", size=7.5, color=FAINT, xycoords=at)
