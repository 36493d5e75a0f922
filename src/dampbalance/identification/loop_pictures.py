"""Pictures of measured loops: force against displacement with the contact fitted and the backbone, loss and stiffness
over the amplitude, and history of the cycles."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import t as student

from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from ..fit.loops import LoopFit
from ..records.coordinate import Coordinate
from ..signals.loops import Loop
from .level import Level

if TYPE_CHECKING:
    import pandas as pd


_COLOURS = (SLIP, STICK, "0.3", "0.6")  # of records, in turn


@styled()
def loops(
    loops: Sequence[Loop], fit: LoopFit | None, levels: Sequence[Level], of: Coordinate
) -> Figure:
    """Return the force against displacement: samples (grey), the force at the largest displacements of each level
    (dots: the backbone), and the contact fitted to each record, at its median amplitude; below, the residual of that
    cycle."""
    figure = page(DOUBLE_COLUMN, 122.0 if fit else 96.0)
    axes = place(figure, 22.0, 50.0 if fit else 24.0, 150.0, 66.0)
    for loop in loops:
        x, f = 1e3 * loop.x[loop.own], loop.f[loop.own]
        axes.plot(x, f, ".", color="0.6", markersize=1.5, rasterized=True)
    for name in dict.fromkeys(level.name for level in levels):
        for end in ("smallest_displacement", "largest_displacement"):
            own = [level.more for level in levels if level.name == name]
            X, F = ([one[key] for one in own] for key in (f"{end}_m", f"force_at_{end}_N"))
            axes.plot(1e3 * np.array(X), F, "o-", color=STICK, markersize=3.0, linewidth=0.8)
    axes.lines[0].set_label("measured")
    axes.lines[-1].set_label("backbone")
    lowest = place(figure, 22.0, 20.0, 150.0, 24.0) if fit else axes
    if fit:
        first = 0
        for loop in fit.design.loops:
            own = loop.slices[np.argsort(loop.amplitudes)[loop.cycles // 2]]
            x, f = 1e3 * loop.x[loop.own][own], loop.f[loop.own][own]
            left = fit.left[first : first + loop.own.size][own]
            first += loop.own.size
            axes.plot(x, f - left, color=SLIP)
            lowest.plot(x, left, color=SLIP, linewidth=0.6)
        axes.lines[-1].set_label("contact fitted")
        axes.tick_params(labelbottom=False)
        lowest.set(xlim=axes.get_xlim(), ylabel=f"residual ({of.unit('N')})")
    axes.set_ylabel(f"{of.noun('force')} ({of.unit('N')})")
    lowest.set_xlabel(f"{of.noun('displacement')} ({of.unit('mm')})")
    return explained(figure)


def _by_record(axes: Axes, table: pd.DataFrame, x: str, y: str, size: float, look: str) -> None:
    """Plot a column of the history over another one, each record in its colour.   size : of a unit of y."""
    for (name, own), colour in zip(table.groupby("record", sort=False), itertools.cycle(_COLOURS)):
        across = own[x] if x == "cycle" else 1e3 * own[x]
        axes.plot(across, size * own[y], look, color=colour, ms=3.0, label=Path(str(name)).name)


@styled()
def loss(loops: Sequence[Loop], fit: LoopFit | None, table: pd.DataFrame, of: Coordinate) -> Figure:
    """Return W/(4X), the secant stiffness and the equivalent damping ratio of each cycle against its amplitude (dots);
    and W/(4X) of the contact fitted, if any, with its band of 95 %, for a motion like that of each record.

    table : the history of the cycles.
    """
    figure = page(DOUBLE_COLUMN, 62.0)
    X = np.linspace(0.0, 1.1 * float(table["X_m"].max()), 40)[1:]
    for left, column, size, label in (
        (15.0, "W_over_4X_N", 1.0, f"$W/(4X)$ ({of.unit('N')})"),
        (74.0, "secant_stiffness_N_per_m", 1e-3, f"$k_s$ ({of.unit('N/mm')})"),
        (133.0, "equivalent_damping_ratio", 100.0, "$\\zeta_\\mathrm{eq}$ (%)"),
    ):
        axes = place(figure, left, 22.0, 42.0, 36.0)
        _by_record(axes, table, "X_m", column, size, "o")
        for loop, colour in zip(loops, itertools.cycle(_COLOURS)):
            if not fit or column != "W_over_4X_N":
                break
            W, error = fit.loss(loop, X)
            reach = float(student.ppf(0.975, fit.freedom)) * error
            axes.plot(1e3 * X, W / (4.0 * X), color=colour)
            band = (W - reach) / (4.0 * X), (W + reach) / (4.0 * X)
            axes.fill_between(1e3 * X, *band, color=colour, alpha=0.25, linewidth=0.0)
        axes.margins(0.06)
        axes.set(xlabel=f"amplitude, {of.label('X', 'mm')}", ylabel=label)
        axes.set(xlim=(0.0, None), ylim=(0.0, 1.08 * axes.dataLim.ymax))
        axes.ticklabel_format(axis="y", scilimits=(-2, 4), useMathText=True)
        axes.tick_params(axis="x", pad=5.0)  # clear of the zero along y
    return explained(figure)


@styled()
def history(table: pd.DataFrame, of: Coordinate) -> Figure:
    """Return the friction force that makes up for the loss of each cycle, and stiffness of the contact in it, against
    the number of the cycle."""
    figure = page(DOUBLE_COLUMN, 118.0)
    for bottom, column, size, label in (
        (72.0, "F_k_N", 1.0, f"friction {of.noun('force')}, {of.label('F_k', 'N')}"),
        (20.0, "K_z_N_per_m", 1e-3, f"stiffness, {of.label('K_z', 'N/mm')}"),
    ):
        axes = place(figure, 22.0, bottom, 150.0, 40.0)
        _by_record(axes, table, "cycle", column, size, "o-")
        axes.set(xlabel="cycle", ylabel=label)
    return explained(figure)
