"""The figure of a study of laws: true law × chosen law."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ...figures.style import DOUBLE_COLUMN, FAINT, INK, note, page, place, styled
from ..parameters import in_maths
from ..routes import NONE
from ..settings import Study
from .confusion import confusion, laws_in

LEFT, BOTTOM, TOP, CELL = 34.0, 4.0, 20.0, 9.0  # mm
_WORDS = 33.0  # mm, of a column of words next to the cells
_DARK = 0.5  # share of a row from which on its number is white


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
            axes.add_patch(_frame(j, i))
    _axes(axes, laws, chosen)
    for place_at, (name, head) in enumerate((("right", "right"), ("extra", "a term too many"))):
        left = columns + (0.12 + place_at) * _WORDS / cell
        axes.text(left, -0.25, head, ha="left", va="bottom", clip_on=False)
        for i, row in enumerate(summary.to_dict("records")):
            part, low, high = (row[f"{name}{end}_percent"] for end in ("", "_low", "_high"))
            text = f"{part:.3g} % ({low:.3g} to {high:.3g})"
            axes.text(left, i + 0.5, text, va="center", size=7.5)
    return figure


def _frame(x: float, y: float) -> Rectangle:
    """The border of a cell."""
    return Rectangle((x, y), 1.0, 1.0, fill=False, ec=INK, lw=0.9, clip_on=False, zorder=3)


def _axes(axes: Axes, laws: list[str], chosen: list[str]) -> None:
    """Names of the laws at the cells."""
    axes.set_ylim(len(laws), 0.0)
    axes.set_yticks(np.arange(len(laws)) + 0.5, [_in_maths(law) for law in laws])
    axes.set_xticks(np.arange(len(chosen)) + 0.5, [_in_maths(law) for law in chosen], rotation=50)
    axes.tick_params(length=0.0, labelbottom=False, labeltop=True)
    for label in axes.get_xticklabels():
        label.set(ha="left", rotation_mode="anchor")
    axes.set_ylabel("true law")
    note(axes, "law chosen", (0.0, 1.0), (-8.0, 8.0), ha="right", xycoords="axes fraction")
    for i in range(1, len(laws)):
        axes.axhline(i, color="white", lw=0.8)


def _in_maths(law: str) -> str:
    return law if law == NONE else f"${in_maths(law).replace(' ', '')}$"
