"""The figures of the frame: the loops with the cycles predicted below them, and the friction force against the load."""

from __future__ import annotations

from string import ascii_lowercase
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...figures.style import (
    DASHED,
    DOUBLE_COLUMN,
    FAINT,
    INK,
    SINGLE_COLUMN,
    SLIP,
    STICK,
    note,
    page,
    panel_letter,
    place,
    styled,
)
from .findings import Findings, Prediction
from .measured_loop import Loop

_WIDE, _HIGH, _LEFT, _STEP = 33.5, 34.0, 13.5, 43.5  # mm
_LEGEND, _UPPER, _LOWER, _BLOCK, _PER_ROW = 8.0, 54.0, 6.0, 96.0, 4  # mm; loads in a row

ALTERNATIVE_TEXTS = {
    "loops": "friction force against displacement at each load, with the rectangle of the identified friction force, "
    "and below it the displacement of the held-out cycles, as measured and as predicted",
    "load": "friction force against load, with intervals, and the straight line through them",
}


@styled()
def loops(findings: Findings) -> Figure:
    """Friction force against displacement, measured and by the identified law, a panel for each load, four in a row.

    The law is drawn with a rigid contact, because the records do not determine K_z. Below each panel: the held-out
    cycles, measured and predicted.
    """
    rows = findings.document["loads"]
    below = (len(rows) - 1) // _PER_ROW
    figure = page(DOUBLE_COLUMN, _LEGEND + _BLOCK * (below + 1))
    for i, (row, loop, prediction) in enumerate(
        zip(rows, findings.loops, findings.predictions, strict=True)
    ):
        down, column = divmod(i, _PER_ROW)
        left, bottom = _LEFT + _STEP * column, _LEGEND + _BLOCK * (below - down)
        upper, lower = (
            place(figure, left, bottom + above, _WIDE, _HIGH) for above in (_UPPER, _LOWER)
        )
        for axes, number in ((upper, i), (lower, len(rows) + i)):
            panel_letter(axes, ascii_lowercase[number])
        upper.set_title(row["record"], pad=3.0)
        _loop(upper, loop, row["F_k_N"])
        _cycles(lower, prediction)
        if not column:
            upper.set_ylabel("friction force (N)", labelpad=1.0)
            lower.set_ylabel("$x$ (mm)", labelpad=1.0)
    handles, labels = lower.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=2, borderaxespad=0.2)
    return figure


def _loop(axes: Axes, loop: Loop, F_k: float) -> None:
    """The loop of a record over the rectangle of a rigid contact."""
    ends = 1e3 * np.array([loop.x.min(), loop.x.max()])
    low, high = ends
    look: dict[str, Any] = {"color": STICK, "lw": 0.8, "ls": DASHED}
    axes.plot([low, low, high, high, low], F_k * np.array([-1, 1, 1, -1, -1]), **look)
    axes.plot(1e3 * np.append(loop.x, loop.x[0]), np.append(loop.force, loop.force[0]), color=SLIP)
    axes.set_xlabel("$x$ (mm)")
    axes.set_ylim(-1.5 * F_k, 1.5 * F_k)


def _cycles(axes: Axes, prediction: Prediction) -> None:
    """Displacement of the held-out cycles, measured and predicted, from the first of them."""
    t = prediction.t - prediction.t[0]
    axes.plot(t, 1e3 * prediction.measured, color=SLIP, label="measured")
    axes.plot(t, 1e3 * prediction.predicted, color=STICK, ls=DASHED, label="predicted")
    axes.set_xlabel("time (s)")
    axes.set_xlim(0.0, float(t[-1]))


@styled()
def load(findings: Findings) -> Figure:
    """F_k against the load, with 95 % intervals and the line; each point has its relative distance from the line."""
    figure = page(SINGLE_COLUMN, 66.0)
    axes = place(figure, 13.0, 12.0, 72.0, 50.0)
    line, rows = findings.document["line"], findings.document["loads"]
    load_kg, F_k = (np.array([row[name] for row in rows]) for name in ("load_kg", "F_k_N"))
    reach = np.abs(np.array([row["interval_N"] for row in rows]).T - F_k)
    ends = np.array([0.0, 1.1 * load_kg.max()])
    axes.plot(ends, line["intercept_N"] + line["slope_N_per_kg"] * ends, color=FAINT)
    axes.errorbar(load_kg, F_k, yerr=reach, fmt="o", color=SLIP, markersize=3.0, elinewidth=0.8)
    for x, y, row in zip(load_kg, F_k, rows, strict=True):
        off = f"{100.0 * row['off_line']:+.1f} %".replace("-", "−")
        note(axes, off, (x, y), (-3.0, 4.0), ha="right", color=INK)
    axes.axhline(0.0, color=FAINT, lw=0.4, zorder=0)
    axes.set_xlim(*ends)
    axes.set_xlabel("load (kg)")
    axes.set_ylabel("$F_k$ (N)", labelpad=1.0)
    return figure
