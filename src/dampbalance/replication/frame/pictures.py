"""The figures of the frame: the loops with the cycles predicted below them, and the friction force against the load
with what is left of the straight line."""

from __future__ import annotations

from string import ascii_lowercase
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...figures import style
from ...figures.looks import LOOKS
from ...figures.style import DASHED, FAINT, SLIP, STICK, page, place, styled
from .findings import Findings

_WIDE, _HIGH, _LEFT, _STEP = 33.5, 34.0, 13.5, 43.5  # mm
OTHER = LOOKS["V_s"].colour  # apart from SLIP and STICK for colour-blind readers, too
_LEGEND, _UPPER, _LOWER, _BLOCK, _PER_ROW = 8.0, 54.0, 6.0, 96.0, 4  # mm; loads in a row

ALTERNATIVE_TEXTS = {
    "loops": "friction force against displacement at each load, with the rectangle of the identified friction force, "
    "and below it the displacement of the held-out cycles, as measured and as two laws of friction predict it",
    "load": "friction force against load with the straight line through it, and below it what the forces are off that "
    "line, with their intervals, for two conventions of the travel",
}


@styled()
def loops(findings: Findings) -> Figure:
    """Friction force against displacement, measured and by the identified law, a panel for each load, four in a row.

    The law is drawn with a rigid contact, because the records do not determine K_z. Below each panel: the held-out
    cycles, measured and predicted by a constant friction force and by the law that predicts best.
    """
    rows = findings.document["loads"]
    below = (len(rows) - 1) // _PER_ROW
    errors = findings.document["speed_laws"]
    laws = dict.fromkeys(["constant", min(errors, key=errors.__getitem__)])
    looks: list[dict[str, Any]] = [{"color": STICK, "ls": DASHED}, {"color": OTHER}]
    figure = page(style.DOUBLE_COLUMN, _LEGEND + _BLOCK * (below + 1))
    for i, (row, loop, cycles) in enumerate(
        zip(rows, findings.loops, findings.predictions, strict=True)
    ):
        down, column = divmod(i, _PER_ROW)
        left, bottom = _LEFT + _STEP * column, _LEGEND + _BLOCK * (below - down)
        upper, lower = (
            place(figure, left, bottom + above, _WIDE, _HIGH) for above in (_UPPER, _LOWER)
        )
        for axes, number in ((upper, i), (lower, len(rows) + i)):
            style.panel_letter(axes, ascii_lowercase[number])
        F_k, ends = row["F_k_N"], [1e3 * loop.x.min(), 1e3 * loop.x.max()]
        rectangle = np.repeat(ends, 2)[[0, 1, 2, 3, 0]], F_k * np.array([-1, 1, 1, -1, -1])
        upper.plot(*rectangle, color=STICK, lw=0.8, ls=DASHED)
        upper.plot(*(np.append(of, of[0]) for of in (1e3 * loop.x, loop.force)), color=SLIP)
        upper.set(xlabel="$x$ (mm)", ylim=(-1.5 * F_k, 1.5 * F_k))
        upper.set_title(row["record"], pad=3.0)
        t = cycles.t - cycles.t[0]
        lower.plot(t, 1e3 * cycles.measured, color=SLIP, zorder=3, label="measured")
        for law, look in zip(laws, looks, strict=False):
            x = 1e3 * cycles.predicted[law]
            lower.plot(t, x, label=f"predicted, {law} friction", **look)
        lower.set(xlabel="time (s)", xlim=(0.0, float(t[-1])))
        if not column:
            upper.set_ylabel("friction force (N)", labelpad=1.0)
            lower.set_ylabel("$x$ (mm)", labelpad=1.0)
    _legend(figure, lower, 3)
    return figure


@styled()
def load(findings: Findings) -> Figure:
    """F_k against the load and the line; below, what each is off the line, %: thick, with the interval of the
    identification, thin, with that for drift and travel; open, with the travel from the Fourier series."""
    figure = page(style.SINGLE_COLUMN, 100.0)
    upper, lower = (
        place(figure, 13.0, bottom, 72.0, high) for bottom, high in ((58.0, 39.0), (19.0, 33.0))
    )
    line, rows = findings.document["line"], findings.document["loads"]
    load_kg, F_k, by_series = (
        np.array([row[name] for row in rows]) for name in ("load_kg", "F_k_N", "F_k_by_series_N")
    )
    ends = np.array([0.0, 1.1 * load_kg.max()])
    on_line, expected = (
        line["intercept_N"] + line["slope_N_per_kg"] * load for load in (ends, load_kg)
    )
    upper.plot(ends, on_line, color=FAINT)
    upper.axhline(0.0, color=FAINT, lw=0.4, zorder=0)
    upper.set_ylabel("$F_k$ (N)", labelpad=1.0)
    upper.tick_params(labelbottom=False)
    lower.axhline(0.0, color=FAINT)
    lower.set_ylabel("off the line (%)", labelpad=1.0)
    lower.set_xlabel("load (kg)")
    bars: dict[str, Any] = {"fmt": "none", "color": SLIP, "capsize": 2.0}
    for name, width, label in (
        ("interval_N", 2.0, "95 % interval"),
        ("robust_interval_N", 0.8, "with drift, travel"),
    ):
        bars["elinewidth"] = width
        reach = np.abs(np.array([row[name] for row in rows]).T - F_k)
        upper.errorbar(load_kg, F_k, yerr=reach, **bars)
        off = 100.0 * (F_k / expected - 1.0)
        lower.errorbar(load_kg, off, yerr=100.0 * reach / expected, label=label, **bars)
    look: dict[str, Any] = {"ls": "none", "marker": "o", "ms": 3.5, "mec": SLIP, "mew": 0.8}
    for forces, fill, label in (
        (F_k, SLIP, "travel from rests"),
        (by_series, "white", "travel from series"),
    ):
        look |= {"mfc": fill, "zorder": 3}
        upper.plot(load_kg, forces, **look)
        lower.plot(load_kg, 100.0 * (forces / expected - 1.0), label=label, **look)
    for axes in (upper, lower):
        axes.set_xlim(*ends)
    _legend(figure, lower, 2)
    return figure


def _legend(figure: Figure, axes: Axes, columns: int) -> None:
    """The legend of one panel at the foot of the page."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=columns, borderaxespad=0.2)
