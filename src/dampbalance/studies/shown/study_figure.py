"""The figure of a study: errors along one axis, the error of c against the step of fixed-step schemes, laws chosen, or
what `maps` and `scatter` draw."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from ...balance import TERMS
from ...figures.grid import Grid, grid, signed_axis
from ...figures.looks import SCHEME_LOOKS, in_maths, label_of, look_of
from ...figures.series import SHARINGS
from ...figures.style import (
    DASHED,
    DOTTED,
    DOUBLE_COLUMN,
    FAINT,
    INK,
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
from .maps import share_map
from .scatter import errors_of_runs

LEFT, BOTTOM, TOP, CELL = 34.0, 4.0, 20.0, 9.0  # mm, around and in the matrix of laws
_WORDS = 33.0  # mm, of a column of words next to the cells
_DARK = 0.5  # share of a row from which on its number is white


def study_figure(study: Study, cases: str | Path) -> Figure:
    """The figure that the study's file asks for, from its table of cases."""
    kinds = {"curves": error_curves, "steps": error_of_steps}
    kinds |= {"map": share_map, "scatter": errors_of_runs, "confusion": confusion_matrix}
    return kinds[study.figure["kind"]](study, cases)


def alternative_text(study: Study) -> str:
    """What the figure shows, in one sentence."""
    identified, figure = f"the identified {listed(list(TERMS))}", study.figure
    x, y = (PARAMETERS[figure.get(axis, figure["x"])].meaning for axis in ("x", "y"))
    shown = {
        "curves": f"error of {identified} against {x}",
        "steps": f"size of the error of {identified} against {x}",
        "map": f"share of the cases with a small error, over {x} and {y}",
        "scatter": f"size that 95 % of the errors of {identified} do not exceed, and coverage, against {x}",
        "confusion": "how often each law is chosen for records of each true law",
    }
    return f"{study.title}: {shown[figure['kind']]}."


@styled()
def error_curves(study: Study, cases: str | Path) -> Figure:
    """Relative error, %, with its sign, along the axis x; a row of panels per term, a curve per approach.

    Columns of panels: phase definitions, or the values of another axis. Solid: φ and t_s of each level; dashed: common
    to the levels.
    """
    shown = curves.error_curves(study, cases)
    panels = grid(len(shown.symbols), len(shown.panels))
    for row, symbol in enumerate(shown.symbols):
        scale = shown.scale(symbol)
        for column, panel in enumerate(shown.panels):
            axes = panels.panel(row, column)
            for curve in shown.curves[symbol, column]:
                _curve(axes, panel, curve, shown.approaches.index(curve.approach))
            _x_axis(axes, shown, last=column == len(shown.panels) - 1)
            signed_axis(axes, scale)
            axes.tick_params(labelbottom=row == len(shown.symbols) - 1, labelleft=column == 0)
            if row == 0 and panel.value:
                axes.set_title(_title(panel), pad=12.0 if study.figure.get("marks") else 4.0)
            if column == 0:
                panels.name_row(axes, f"error of ${symbol}$ (%)")
            _marks(axes, study, label=row == 0)
    panels.text_below(curves.axis_label(shown.name))
    _legend(panels, shown)
    return panels.figure


@styled()
def error_of_steps(study: Study, cases: str | Path) -> Figure:
    """Size of the error of c, N s/m, by direct integration against the step of each scheme, with the line m ω² h."""
    shown = curves.error_of_steps(study, cases)
    first, last = shown.steps[[0, -1]]
    figure = page(SINGLE_COLUMN + 35.0, 76.0)
    axes = place(figure, 16.0, 12.0, SINGLE_COLUMN - 20.0, 60.0)
    h = np.geomspace(first, last, 50)
    bias: dict[str, Any] = {"color": FAINT, "lw": 2.5, "alpha": 0.45}
    axes.plot(h, shown.line(h), zorder=0, **bias)
    handles = [Line2D([], [], label=r"$m\omega^2 h$", **bias)]
    for name, (steps, errors) in shown.errors.items():
        label, look = SCHEME_LOOKS[name]
        style: dict[str, Any] = {"color": look.colour, "marker": look.marker, "lw": 0.7}
        style |= {"ms": 3.4, "mfc": "white", "mew": 0.7}
        axes.plot(steps, errors, **style)
        handles.append(Line2D([], [], label=label, **style))
    logarithmic_ticks(axes, "x", first, last)
    axes.set_yscale("log")
    axes.grid(color="#E4E4E4", lw=0.4)
    axes.set_xlabel("step $h$ (s)")
    axes.set_ylabel(r"$|c_\mathrm{identified} - c|$ (N s/m)")
    _marks(axes, study, label=True)
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
    _law_axes(axes, laws, chosen)
    for place_at, (name, head) in enumerate((("right", "right"), ("extra", "a term too many"))):
        left = columns + (0.12 + place_at) * _WORDS / cell
        axes.text(left, -0.25, head, ha="left", va="bottom", clip_on=False)
        for i, row in enumerate(summary.to_dict("records")):
            part, low, high = (row[f"{name}{end}_percent"] for end in ("", "_low", "_high"))
            text = f"{part:.3g} % ({low:.3g} to {high:.3g})"
            axes.text(left, i + 0.5, text, va="center", size=7.5)
    return figure


def _law_axes(axes: Axes, laws: list[str], chosen: list[str]) -> None:
    """Names of the laws at the cells."""
    axes.set_ylim(len(laws), 0.0)
    rows, columns = (
        [law if law == NONE else f"${in_tex(law).replace(' ', '')}$" for law in some]
        for some in (laws, chosen)
    )
    axes.set_yticks(np.arange(len(laws)) + 0.5, rows)
    axes.set_xticks(np.arange(len(chosen)) + 0.5, columns, rotation=50)
    axes.tick_params(length=0.0, labelbottom=False, labeltop=True)
    for label in axes.get_xticklabels():
        label.set(ha="left", rotation_mode="anchor")
    axes.set_ylabel("true law")
    note(axes, "law chosen", (0.0, 1.0), (-8.0, 8.0), ha="right", xycoords="axes fraction")
    for i in range(1, len(laws)):
        axes.axhline(i, color="white", lw=0.8)


def _title(panel: curves.Panel) -> str:
    if panel.axis is None:
        return panel.value
    symbol = panel.axis.symbol
    return f"${symbol}$ = {panel.value}" if symbol else f"{panel.axis.meaning}: {panel.value}"


def _curve(axes: Axes, panel: curves.Panel, curve: curves.Curve, number: int) -> None:
    """A curve with the marks of its approach: at every case, or at places apart from those of the other approaches."""
    look = look_of(curve.approach)
    style: dict[str, Any] = {"ls": "-", "mfc": look.colour, "ms": 3.2, "mew": 0.7, "lw": look.width}
    style |= {"ls": DASHED, "mfc": "white"} if curve.sharing == "common" else {}
    style |= {"color": look.colour, "marker": look.marker}
    if not panel.few:  # with an edge, which keeps them visible on curves that coincide
        edge = look.colour if curve.sharing == "common" else "white"
        style |= {"markevery": (0.03 + 0.04 * number, 0.2), "ms": 4.0, "mec": edge}
    axes.plot(panel.x, curve.error, **style)


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


def _marks(axes: Axes, study: Study, label: bool) -> None:
    """The places on x that the study's figure names, above the frame."""
    for name, value in study.figure.get("marks", {}).items():
        axes.axvline(value, color=FAINT, lw=0.6, ls=DOTTED, zorder=0)
        if label:
            omega = omega_of(name)
            text = f"${omega}$" if omega else in_figure(name)
            at = ("data", "axes fraction")
            note(axes, text, (value, 1.0), (0.0, 1.5), "center", size=7.5, color=FAINT, xycoords=at)


def _legend(panels: Grid, shown: curves.ErrorCurves) -> None:
    """The approaches by colour, those that are not drawn by the bound of their error; φ and t_s by the line."""
    handles = [_handle(key, shown.exact) for key in shown.approaches]
    if len(shown.sharings) > 1:
        for name, style in zip(SHARINGS, ("-", DASHED), strict=True):
            label = rf"{name} $\varphi$, $t_s$"
            handles.append(Line2D([], [], color=FAINT, lw=0.9, ls=style, label=label))
    panels.legend_below(handles, columnspacing=1.2, handlelength=1.8, handletextpad=0.5)


def _handle(key: str, exact: Mapping[str, float]) -> Line2D:
    label, colour = in_maths(label_of(key)), look_of(key).colour
    if key not in exact:
        return Line2D([], [], color=colour, lw=1.2, marker=look_of(key).marker, ms=3.2, label=label)
    power = math.ceil(math.log10(max(exact[key], 1e-14)))
    return Line2D([], [], color=colour, lw=0.0, label=rf"{label} (below $10^{{{power}}}$ %)")
