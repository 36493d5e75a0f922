"""The figure of a study of noisy records: how large the errors are over many runs, and how large they are stated."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from ...arrays import Array
from ...figures.grid import Grid, decades_axis, grid
from ...figures.looks import in_maths, label_of, look_of
from ...figures.series import decades
from ...figures.style import DASHED, FAINT, styled
from ..parameters import PARAMETERS
from ..settings import Fit, Study
from .groups import Spread, groups, spread_of, terms_of
from .series import symbol_of, with_unit

# Ratio by which the curves of two approaches are moved apart, so that all can be seen.
_BESIDE = 1.06


@styled()
def errors_of_runs(study: Study, cases: str | Path) -> Figure:
    """Rms error over the runs, %, along the axis x: a row of panels per term, a curve and markers per approach.

    Columns of panels: the values of another axis. Dashed: the standard error that the runs state. Where the two part,
    the approach has an error of its own, which no number of cycles lowers.
    """
    settings = study.figure
    fits = study.fits_of(settings)
    by = settings.get("panels")
    kept = list(groups(study, cases, [settings["x"], *([by] if by else [])]))
    values: list[Any] = list(dict.fromkeys(where[by] for where, _ in kept)) if by else [None]
    symbols = terms_of(cases)
    panels = grid(len(symbols), len(values))
    for row, symbol in enumerate(symbols):
        drawn = []
        for column, value in enumerate(values):
            axes = panels.panel(row, column)
            axes.set_label(f"{symbol} {value}")
            places = [(w[settings["x"]], mask) for w, mask in kept if not by or w[by] == value]
            for index, fit in enumerate(fits):
                spreads = [(x, spread_of(study, cases, symbol, fit, mask)) for x, mask in places]
                _draw(axes, fit, spreads, _BESIDE ** (index - 0.5 * (len(fits) - 1)))
            drawn.append(axes)
            _x_axis(axes, np.array([x for x, _ in places]))
            axes.tick_params(labelbottom=row == len(symbols) - 1, labelleft=column == 0)
            if row == 0 and by:
                axes.set_title(f"{symbol_of(by)} = {with_unit(by, value, 6)}", pad=4.0)
        lines = [line for axes in drawn for line in axes.lines]
        limits = decades([np.asarray(line.get_ydata(), float) for line in lines])
        for axes in drawn:
            decades_axis(axes, limits)
        panels.name_row(drawn[0], f"error of ${symbol}$ (%)")
    panels.text_below(f"{PARAMETERS[settings['x']].meaning} (%)")
    _legend(panels, fits)
    return panels.figure


def _draw(axes: Axes, fit: Fit, spreads: list[tuple[float, Spread]], beside: float) -> None:
    """One approach: its rms error, and the standard error that it states."""
    look = look_of(fit.approach)
    x = beside * 100.0 * np.array([place for place, _ in spreads])
    for name, style, filled in (("rms", "-", True), ("standard_error", DASHED, False)):
        size = 100.0 * np.array([getattr(spread, name) for _, spread in spreads])
        marks: dict[str, Any] = {"marker": look.marker, "ms": 3.2, "mew": 0.7} if filled else {}
        size = np.where(size > 0.0, size, np.nan)
        label = f"{fit.label} {name}"
        axes.plot(x, size, color=look.colour, ls=style, lw=0.8, label=label, **marks)


def _x_axis(axes: Axes, places: Array) -> None:
    """A logarithmic axis of x in %, with a tick at each place."""
    axes.set_xscale("log")
    axes.set_xticks(100.0 * places, [f"{100.0 * place:g}" for place in places])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(axis="x", which="minor", bottom=False, top=False)
    axes.set_xlim(100.0 * places.min() / 1.8, 100.0 * places.max() * 1.8)


def _legend(panels: Grid, fits: list[Fit]) -> None:
    handles = []
    for fit in fits:
        look, label = look_of(fit.approach), in_maths(label_of(fit.approach))
        marks: dict[str, Any] = {"marker": look.marker, "ms": 3.2}
        handles.append(Line2D([], [], color=look.colour, lw=0.8, label=label, **marks))
    for style, label in (("-", "rms error"), (DASHED, "standard error")):
        handles.append(Line2D([], [], color=FAINT, lw=0.8, ls=style, label=label))
    panels.legend_below(handles, columnspacing=1.2, handlelength=2.2, handletextpad=0.5)
