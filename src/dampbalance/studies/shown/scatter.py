"""The figure of a study of noisy records: how large the errors are over many runs, and how many intervals hold."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from ...arrays import Array
from ...figures.grid import Grid, decades_axis, grid
from ...figures.looks import in_maths, label_of, look_of
from ...figures.series import decades
from ...figures.style import DASHED, DOTTED, FAINT, styled
from ...project.wording import in_figure
from ...solver import NORMAL_95
from ..outputs import terms_of
from ..parameters import PARAMETERS
from ..settings import Fit, Study
from .error_curves import axis_label, symbol_of, with_unit
from .statistics import spread_of
from .summary import groups

_APART = 1.13  # ratio by which neighbouring lines are moved apart along x, so that their bars do not overlap
_COVERAGE, _GAP, _ERRORS = 24.0, 3.0, 40.0  # heights in a row of panels, mm
_CONFIDENCE = 95.0  # %
_TRAITS = ("phase", "sharing", "contact", "weights", "kind")


@styled()
def errors_of_runs(study: Study, cases: str | Path) -> Figure:
    """Over the runs, along the axis x: the size that 95 % of the errors do not exceed, %, and below it, where the study
    has intervals, the share of the 95 % intervals that hold the true value, %.

    A row of panels per term, a column per value of another axis, a line per fit. Bars: the uncertainty
    from the number of runs, 1.96 standard errors of the size, and the 95 % interval of the coverage.
    """
    settings, lines = study.figure, _lines(study)
    factor = 100.0 if settings["x"] == "noise" else 1.0  # a part of the signal, in %
    by, intervals = settings.get("panels"), "intervals" in study.columns
    kept = list(groups(cases, [settings["x"], *([by] if by else [])]))
    values: list[Any] = list(dict.fromkeys(where[by] for where, _ in kept)) if by else [None]
    symbols = terms_of(cases)
    low = _COVERAGE + _GAP if intervals else 0.0
    panels = grid(len(symbols), len(values), height=low + _ERRORS)
    for row, symbol in enumerate(symbols):
        drawn = []
        for column, value in enumerate(values):
            places = [(w[settings["x"]], mask) for w, mask in kept if not by or w[by] == value]
            x = factor * np.array([x for x, _ in places])
            styles = _styles(lines, _between(x))
            errors = panels.panel(row, column, low)
            below = [panels.panel(row, column, 0.0, _COVERAGE)] if intervals else []
            for axes, name in zip([errors, *below], ("errors", "coverage"), strict=False):
                axes.set_label(f"{symbol} {value} {name}")
                _x_axis(axes, x)
                axes.tick_params(labelbottom=False, labelleft=column == 0)
            axes.tick_params(labelbottom=row == len(symbols) - 1)
            for (label, fit), (shift, style) in zip(lines.items(), styles, strict=True):
                spreads = [spread_of(study, cases, symbol, fit, mask) for _, mask in places]
                runs = pd.DataFrame(spreads)
                style |= {"label": label, "gid": label}
                size = 100.0 * runs["p95"].to_numpy()
                reach = np.nan_to_num(100.0 * NORMAL_95 * runs["p95_error"].to_numpy())
                bars = [np.minimum(reach, 0.9 * size), reach]  # of a logarithmic axis
                errors.errorbar(shift * x, np.where(size > 0.0, size, np.nan), yerr=bars, **style)
                for axes in below:
                    names = ["coverage_low", "coverage", "coverage_high"]
                    ends, share = 100.0 * runs[names[::2]].to_numpy().T, 100.0 * runs["coverage"]
                    axes.axhline(_CONFIDENCE, color=FAINT, lw=0.5, zorder=0)
                    axes.set_ylim(-6.0, 106.0)
                    axes.set_yticks([0.0, 50.0, _CONFIDENCE])
                    # without lines, which would cross each other
                    look = style | {"ls": ""}
                    axes.errorbar(shift * x, share, yerr=np.abs(share.to_numpy() - ends), **look)
            drawn.append(errors)
            if column == 0:
                panels.name_row(errors, f"95 % of errors of ${symbol}$ below (%)")
                for axes in below:
                    panels.name_row(axes, "coverage (%)")
            if row == 0 and by:
                errors.set_title(f"{symbol_of(by)} = {with_unit(by, value, 6)}", pad=4.0)
        sizes = [np.asarray(line.get_ydata(), float) for axes in drawn for line in axes.lines]
        for axes in drawn:
            decades_axis(axes, decades(sizes))
    label = axis_label(settings["x"])
    panels.text_below(f"{PARAMETERS['noise'].meaning} (%)" if settings["x"] == "noise" else label)
    _legend(panels, lines)
    return panels.figure


def _lines(study: Study) -> dict[str, Fit]:
    """The fits to draw, by the label in the legend: the one given, or the approach and how it differs from others."""
    fits = study.fits_of(study.figure)
    if "lines" in study.figure:
        labels = [in_maths(in_figure(label)) for label in study.figure["lines"]]
        return dict(zip(labels, fits, strict=True))
    differing = [key for key in _TRAITS if len({getattr(fit, key) for fit in fits} - {""}) > 1]
    named = {}
    for fit in fits:
        traits = [getattr(fit, key).replace("_", " ") for key in differing]
        words = [in_maths(label_of(fit.approach)), *(trait for trait in traits if trait)]
        named[", ".join(words)] = fit
    return named


def _styles(
    lines: Mapping[str, Fit], between: float = math.inf
) -> Iterator[tuple[float, dict[str, Any]]]:
    """The ratio by which each line is moved along x, and its style. The lines of one approach have its colour: the
    first has filled marks, the second open ones, the third crosses.   between : least ratio of neighbouring places."""
    looks: Sequence[tuple[Any, dict[str, Any]]]
    looks = (("-", {}), (DASHED, {"mfc": "white"}), (DOTTED, {"marker": "x"}))
    apart = min(_APART, between ** (0.7 / len(lines)))
    seen: list[str] = []
    for index, fit in enumerate(lines.values()):
        look = look_of(fit.approach)
        ls, marks = looks[min(seen.count(fit.approach), 2)]
        seen.append(fit.approach)
        style: dict[str, Any] = {"color": look.colour, "marker": look.marker, "ls": ls}
        style |= {"ms": 3.4, "mew": 0.7, "lw": 0.6, "elinewidth": 0.7} | marks
        yield apart ** (index - 0.5 * (len(lines) - 1)), style


def _x_axis(axes: Axes, places: Array) -> None:
    """A logarithmic axis with a tick at each place."""
    axes.set_xscale("log")
    axes.set_xticks(places, [f"{place:g}" for place in places])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(axis="x", which="minor", bottom=False, top=False)
    margin = min(1.8, _between(places) ** 0.6)
    axes.set_xlim(places.min() / margin, places.max() * margin)


def _between(places: Array) -> float:
    """The least ratio of neighbouring places."""
    ordered = np.unique(places)
    return float(np.min(ordered[1:] / ordered[:-1], initial=10.0))


def _legend(panels: Grid, lines: Mapping[str, Fit]) -> None:
    handles = []
    for label, (_, style) in zip(lines, _styles(lines), strict=True):
        del style["elinewidth"]
        handles.append(Line2D([], [], label=label, **style))
    panels.legend_below(handles, columnspacing=1.2, handlelength=2.4, handletextpad=0.5)
