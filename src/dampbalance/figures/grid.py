"""Panels of equal size in rows and columns, a row per term of the balance, with text and a legend below them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter

from .series import SignedScale
from .style import DOUBLE_COLUMN, FAINT, MM, page, place

RIGHT, TOP, ROW_GAP, COLUMN_GAP = 3.0, 8.0, 4.0, 3.5  # mm
ENTRIES = 7  # of a legend that fit into a line
NAMED = 10  # labels of an axis that fit one above the other
TEXT_LEVEL, LEGEND_LEVEL = 11.0, 4.0  # mm above the lower edge of the page


@dataclass(frozen=True, slots=True)
class Grid:
    """A page of panels.

    figure : the page.   left, bottom : its margins, mm.   rows : how many.   width, height : of a panel, mm.
    """

    figure: Figure
    left: float
    bottom: float
    rows: int
    width: float
    height: float

    def panel(self, row: int, column: int, low: float = 0.0, high: float | None = None) -> Axes:
        """Axes in a row (from the top) and a column, all of the panel or what lies between two levels of it, mm."""
        left = self.left + column * (self.width + COLUMN_GAP)
        bottom = self.bottom + (self.rows - 1 - row) * (self.height + ROW_GAP)
        tall = (self.height if high is None else high) - low
        return place(self.figure, left, bottom + low, self.width, tall)

    def name_row(self, axes: Axes, label: str) -> None:
        """What the panels of a row show, beside the first of them."""
        axes.set_ylabel(label)
        axes.yaxis.set_label_coords(-11.0 / self.width, 0.5)

    def text_below(self, text: str) -> None:
        """A line of text below the panels."""
        self.figure.text(*self._middle(TEXT_LEVEL), text, ha="center", va="center")

    def legend_below(self, handles: Sequence[Any], **options: Any) -> None:
        """The legend of all panels at the foot of the page, in as few lines as it fits into."""
        lines = math.ceil(len(handles) / ENTRIES)
        self.figure.legend(
            handles=handles,
            loc="center",
            bbox_to_anchor=self._middle(LEGEND_LEVEL),
            ncols=math.ceil(len(handles) / lines),
            **options,
        )

    def _middle(self, level: float) -> tuple[float, float]:
        """The point below the middle of the panels, `level` mm above the edge, in shares of the page."""
        middle = self.left + 0.5 * (DOUBLE_COLUMN - self.left - RIGHT)
        return middle / DOUBLE_COLUMN, level * MM / self.figure.get_figheight()


def grid(
    rows: int, columns: int, *, left: float = 15.0, bottom: float = 19.0, height: float = 44.0
) -> Grid:
    """An empty page for so many panels of this height, mm, over its whole width."""
    width = (DOUBLE_COLUMN - left - RIGHT - (columns - 1) * COLUMN_GAP) / columns
    figure = page(DOUBLE_COLUMN, bottom + rows * height + (rows - 1) * ROW_GAP + TOP)
    return Grid(figure, left, bottom, rows, width, height)


def signed_axis(axes: Axes, scale: SignedScale) -> None:
    """An axis of errors of either sign, with a line at zero and a faint one at each power of ten."""
    axes.set_yscale("asinh", linear_width=0.2 * scale.linear)  # to ±linear as far as a decade
    axes.set_ylim(scale.low, scale.high)
    ticks = scale.ticks
    every = math.ceil(len(ticks) / NAMED)
    named = {0.0, *(tick for tick in ticks if tick and _steps(tick, scale) % every == 0)}
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: _power(y) if y in named else ""))
    axes.yaxis.set_minor_locator(FixedLocator([]))
    axes.grid(axis="y", color="#E4E4E4", lw=0.4)
    axes.axhline(0.0, color=FAINT, lw=0.5, zorder=0.5)


def _steps(tick: float, scale: SignedScale) -> int:
    """How many decades the larger end of an axis lies beyond a tick."""
    return round(math.log10(max(scale.high, -scale.low) / abs(tick)))


def _power(value: float) -> str:
    """A power of ten with its sign, or zero."""
    sign = "-" if value < 0.0 else ""
    return rf"${sign}10^{{{round(math.log10(abs(value)))}}}$" if value else "$0$"


def decades_axis(axes: Axes, limits: tuple[float, float]) -> None:
    """A logarithmic axis of sizes between limits, with a tick and a faint line at each power of ten."""
    axes.set_yscale("log")
    axes.set_ylim(*limits)
    axes.yaxis.set_major_locator(LogLocator(base=10.0, numticks=20))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(axis="y", color="#E4E4E4", lw=0.4)
