"""Panels of equal size in rows and columns, a row per term of the balance, with text and a legend below them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter

from .series import SignedScale
from .style import DOUBLE_COLUMN, FAINT, GRID, MM, page, place

RIGHT, TOP, ROW_GAP, COLUMN_GAP = 3.0, 8.0, 4.0, 3.5  # mm
APART, ASIDE = 2.0, 6.0  # points, at least, between labels, and between those of two panels
ROOM = 1.4  # ratio by which a signed axis goes beyond its last power of ten, so that no mark is cut there
CLEAR = 6.5  # points from the frame to labels along x, below the lowest one along y
LINEAR_SHARE = 0.2  # of the linear part of a signed axis, the width of the asinh: there it takes as much as a decade
NAMED = 10  # labels of an axis that fit one above the other
TEXT_LEVEL = 11.0  # mm above the lower edge of the page


@dataclass(frozen=True, slots=True)
class Grid:
    """A page of panels.

    figure : the page.   left, right, bottom : its margins, mm.   rows : how many.   width, height : of a panel, mm.
    """

    figure: Figure
    left: float
    right: float
    bottom: float
    rows: int
    width: float
    height: float

    def panel(
        self, row: int, column: int, low: float = 0.0, high: float | None = None, rows: int = 1
    ) -> Axes:
        """Return axes in a row (from the top) and a column, all of the panel or what lies between two levels of it, mm.

        rows : how many of them, upwards, the panel covers.
        """
        left = self.left + column * (self.width + COLUMN_GAP)
        bottom = self.bottom + self.tall(self.rows - 1 - row) + ROW_GAP * (row < self.rows - 1)
        top = self.tall(rows) if high is None else high
        return place(self.figure, left, bottom + low, self.width, top - low)

    def tall(self, rows: int) -> float:
        """Return the height of so many rows with the gaps between them, mm."""
        return max(0.0, rows * (self.height + ROW_GAP) - ROW_GAP)

    def name_row(self, axes: Axes, label: str) -> None:
        """Name what the panels of a row show, to the left of the first."""
        axes.set_ylabel(label)
        axes.yaxis.set_label_coords(-11.0 / self.width, 0.5)

    def text_below(self, text: str, level: float = TEXT_LEVEL) -> None:
        """Write a line of text below the panels, so many mm above the lower edge of the page."""
        self.figure.text(*self._middle(level), text, ha="center", va="center")

    def legend_below(self, handles: Sequence[Any], **options: Any) -> None:
        """Draw the legend of all panels, if they show anything, at the foot of the page, in as few lines as it fits."""
        if not handles:
            return
        # seven entries of a legend fit into a line
        lines = math.ceil(len(handles) / 7)
        self.figure.legend(
            handles=handles,
            loc="center",
            # mm above the lower edge of the page
            bbox_to_anchor=self._middle(4.0),
            ncols=math.ceil(len(handles) / lines),
            **options,
        )

    def _middle(self, level: float) -> tuple[float, float]:
        """Return the point below the middle of the panels, `level` mm above the edge, in shares of the page."""
        middle = self.left + 0.5 * (DOUBLE_COLUMN - self.left - self.right)
        return middle / DOUBLE_COLUMN, level * MM / self.figure.get_figheight()


def grid(
    rows: int,
    columns: int,
    *,
    left: float = 15.0,
    right: float = RIGHT,
    bottom: float = 19.0,
    height: float = 44.0,
    most: float = math.inf,
) -> Grid:
    """Return an empty page for panels of this height, mm, over its whole width.

    most : if given, panels are square instead, but at most this high, mm.
    """
    width = (DOUBLE_COLUMN - left - right - (columns - 1) * COLUMN_GAP) / columns
    height = height if math.isinf(most) else min(width, most)
    figure = page(DOUBLE_COLUMN, bottom + rows * height + (rows - 1) * ROW_GAP + TOP)
    return Grid(figure, left, right, bottom, rows, width, height)


def clear_labels(row: Sequence[Axes]) -> None:
    """Leave out labels along x that would touch others, of the same panel or the next, or the edge of the page."""
    figure: Any = row[0].figure
    for axes in row:
        axes.xaxis.get_ticklabels()  # sets their texts and places, without drawing all else
    apart, aside = (points / 72.0 * figure.dpi for points in (APART, ASIDE - APART))
    limit = figure.bbox.width
    for axes in reversed(row):
        axes.tick_params(axis="x", pad=CLEAR)
        low, high = axes.get_xlim()
        end = high + 1e-9 * (
            high - low
        )  # an edge that was computed may lie just below the tick at it
        ticks = [tick for tick in axes.xaxis.get_major_ticks() if low <= tick.get_loc() <= end]
        ticks = [tick for tick in ticks if tick.label1.get_text()]
        boxes = [tick.label1.get_window_extent() for tick in ticks]
        every = next(
            n
            for n in itertools.count(1)
            if all(a.x1 + apart <= b.x0 for a, b in itertools.pairwise(boxes[::n]))
        )
        shown = [i for i in range(0, len(ticks), every) if boxes[i].x1 + apart <= limit]
        if len(shown) < len(ticks):
            texts = [t.label1.get_text() if i in shown else "" for i, t in enumerate(ticks)]
            axes.set_xticks([tick.get_loc() for tick in ticks], texts)
            axes.set_xlim(low, high)
        limit = (boxes[shown[0]].x0 if shown else axes.bbox.x0) - aside


def signed_axis(axes: Axes, scale: SignedScale) -> None:
    """Make an axis of errors of either sign, with a line at zero and a faint one at each power of ten."""
    axes.set_yscale(
        "asinh", linear_width=LINEAR_SHARE * scale.linear
    )  # to ±linear as far as a decade
    axes.set_ylim(ROOM * scale.low, ROOM * scale.high)
    ticks = scale.ticks
    every = math.ceil(len(ticks) / NAMED)
    end = math.log10(max(scale.high, -scale.low))
    steps = {tick: round(end - math.log10(abs(tick))) for tick in ticks if tick}
    named = {0.0, *(tick for tick, decades in steps.items() if decades % every == 0)}
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: _power(y) if y in named else ""))
    axes.yaxis.set_minor_locator(FixedLocator([]))
    axes.grid(axis="y", color=GRID, lw=0.4)
    axes.axhline(0.0, color=FAINT, lw=0.5, zorder=0.5)


def _power(value: float) -> str:
    """Return a power of ten with its sign, or zero."""
    sign = "-" if value < 0.0 else ""
    return rf"${sign}10^{{{round(math.log10(abs(value)))}}}$" if value else "$0$"


def decades_axis(axes: Axes, limits: tuple[float, float]) -> None:
    """Make a logarithmic axis of sizes between limits, with a tick and a faint line at each power of ten."""
    axes.set_yscale("log")
    axes.set_ylim(*limits)
    axes.yaxis.set_major_locator(LogLocator(base=10.0, numticks=20))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(axis="y", color=GRID, lw=0.4)


def logarithmic_ticks(axes: Axes, which: str, low: float, high: float, ends: bool = True) -> None:
    """Make an axis from low to high logarithmic, with labels at powers of ten, or at 1, 2, 3, 5 if it is short.

    ends : whether a tick at the upper end has a label (where no panel follows with which it would collide).
    """
    axes.set(**{f"{which}scale": "log"})
    axis = axes.xaxis if which == "x" else axes.yaxis
    # ratio of the ends of an axis up to which 1, 2, 3, 5 are labelled as well as powers of ten
    short = high / low <= 12.0
    plain = short or (low >= 1e-2 and high <= 1e3)
    subs = (1.0, 2.0, 3.0, 5.0) if short else (1.0,)
    axis.set_major_locator(LogLocator(base=10.0, subs=subs, numticks=20))
    axis.set_minor_locator(LogLocator(base=10.0, subs=np.arange(2.0, 10.0).tolist(), numticks=200))
    axis.set_minor_formatter(NullFormatter())

    def label(value: float, _: int) -> str:
        if not ends and value > 0.97 * high:
            return ""
        return f"{value:g}" if plain else f"$10^{{{round(math.log10(value))}}}$"

    axis.set_major_formatter(FuncFormatter(label))
