"""The figure of a study of noisy records: how large the errors are over many runs, and how large they are stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from ...figures.style import APPROACH_LOOKS, DOUBLE_COLUMN, FAINT, MM, page, place, styled
from ..parameters import PARAMETERS
from ..settings import Fit, Study, chosen
from .groups import QUANTITIES, Spread, groups, spread_of

Array = NDArray[np.float64]

LEFT, RIGHT, BOTTOM, TOP = 15.0, 3.0, 19.0, 7.0  # mm, margins of the page
HEIGHT, ROW_GAP, COLUMN_GAP = 44.0, 4.0, 3.5  # mm

_BESIDE = 1.06  # ratio by which the curves of two approaches are moved apart: all can be seen


@styled()
def errors_of_runs(study: Study, cases: str | Path) -> Figure:
    """Rms error of F_k (top) and c (bottom) over the runs, %, along the axis x; a curve and markers per approach.

    Columns of panels: the values of another axis. Dashed: the standard error that the runs state. Where the two part,
    the approach has an error of its own, which no number of cycles lowers.
    """
    settings = study.figure
    fits = chosen(study.fits, {"fit": "least_squares"} | dict(settings))
    by = settings.get("panels")
    names = [settings["x"], *([by] if by else [])]
    kept = list(groups(study, cases, names))
    titles = list(dict.fromkeys(where[by] for where, _ in kept)) if by else [None]
    width = (DOUBLE_COLUMN - LEFT - RIGHT - (len(titles) - 1) * COLUMN_GAP) / len(titles)
    figure = page(DOUBLE_COLUMN, BOTTOM + 2 * HEIGHT + ROW_GAP + TOP)
    for bottom, quantity in zip((BOTTOM + HEIGHT + ROW_GAP, BOTTOM), QUANTITIES, strict=True):
        row = []
        for column, value in enumerate(titles):
            axes = place(figure, LEFT + column * (width + COLUMN_GAP), bottom, width, HEIGHT)
            axes.set_label(f"{quantity} {value}")
            row.append(axes)
            places = [(w[settings["x"]], mask) for w, mask in kept if not by or w[by] == value]
            for index, fit in enumerate(fits):
                found = [(x, spread_of(study, cases, quantity, fit, mask)) for x, mask in places]
                _draw(axes, fit, found, _BESIDE ** (index - 0.5 * (len(fits) - 1)))
            _frame(axes, np.array([x for x, _ in places]))
            axes.tick_params(labelbottom=quantity == QUANTITIES[-1], labelleft=column == 0)
            if quantity == QUANTITIES[0] and by:
                p = PARAMETERS[by]
                unit = "" if p.unit in ("", "1") else f" {p.unit}"
                axes.set_title(f"${p.symbol}$ = {value:g}{unit}", pad=4.0)
        _share_decades(row)
        row[0].set_ylabel(f"error of ${quantity}$ (%)")
        row[0].yaxis.set_label_coords(-11.0 / width, 0.5)
    figure.text(*_centre(figure, 11.0), _axis(settings["x"]), ha="center", va="center")
    _legend(figure, fits)
    return figure


def _draw(axes: Axes, fit: Fit, found: list[tuple[float, Spread]], beside: float) -> None:
    """One approach: its rms error, and the standard error that it states."""
    look = APPROACH_LOOKS[fit.approach]
    x = beside * 100.0 * np.array([place for place, _ in found])
    for name, style, filled in (("rms", "-", True), ("standard_error", (0, (4, 2)), False)):
        size = 100.0 * np.array([getattr(spread, name) for _, spread in found])
        axes.plot(
            x,
            np.where(size > 0.0, size, np.nan),
            color=look.colour,
            ls=style,
            lw=0.8,
            marker=look.marker if filled else None,
            ms=3.2,
            mfc=look.colour,
            mew=0.7,
            label=f"{fit.label} {name}",
        )


def _frame(axes: Axes, places: Array) -> None:
    """A logarithmic axis of x in %, with a tick at each place, and one of the errors."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(100.0 * places, [f"{100.0 * place:g}" for place in places])
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.tick_params(axis="x", which="minor", bottom=False, top=False)
    axes.set_xlim(100.0 * places.min() / 1.8, 100.0 * places.max() * 1.8)
    axes.yaxis.set_major_locator(LogLocator(base=10.0, numticks=20))
    axes.grid(axis="y", color="#E4E4E4", lw=0.4)


def _share_decades(row: list[Axes]) -> None:
    """The same whole decades on all panels of a row."""
    limits = [axes.dataLim for axes in row]
    low = np.floor(np.log10(min(box.y0 for box in limits)))
    high = np.ceil(np.log10(max(box.y1 for box in limits)))
    for axes in row:
        axes.set_ylim(10.0**low, 10.0 ** max(high, low + 1.0))


def _legend(figure: Figure, fits: list[Fit]) -> None:
    handles = []
    for fit in fits:
        look = APPROACH_LOOKS[fit.approach]
        handles.append(
            Line2D([], [], color=look.colour, marker=look.marker, ms=3.2, lw=0.8, label=look.label)
        )
    handles.append(Line2D([], [], color=FAINT, lw=0.8, label="rms error"))
    handles.append(Line2D([], [], color=FAINT, lw=0.8, ls=(0, (4, 2)), label="standard error"))
    figure.legend(
        handles=handles,
        loc="center",
        bbox_to_anchor=_centre(figure, 4.0),
        ncols=len(handles),
        columnspacing=1.2,
        handlelength=2.2,
        handletextpad=0.5,
    )


def _axis(name: str) -> str:
    return f"{PARAMETERS[name].meaning} (%)"


def _centre(figure: Figure, level: float) -> tuple[float, float]:
    height = float(figure.get_size_inches()[1]) / MM
    return (LEFT + 0.5 * (DOUBLE_COLUMN - LEFT - RIGHT)) / DOUBLE_COLUMN, level / height
