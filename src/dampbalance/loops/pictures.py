"""Pictures of measured loops: force against displacement with the contact fitted, loss, and history of the cycles."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import t as student

from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from ..records.coordinate import Coordinate
from .cycles import Loop
from .fit import LoopFit

if TYPE_CHECKING:
    import pandas as pd


_COLOURS = (SLIP, STICK, "0.3", "0.6")  # of records, in turn


@styled()
def loops(loops: Sequence[Loop], fit: LoopFit, of: Coordinate) -> Figure:
    """Return the force against displacement: samples (grey), and the contact fitted to each record, at its median
    amplitude; below, the residual of that cycle."""
    figure = page(DOUBLE_COLUMN, 122.0)
    axes, below = place(figure, 22.0, 50.0, 150.0, 66.0), place(figure, 22.0, 20.0, 150.0, 24.0)
    for number, (loop, model) in enumerate(zip(loops, fit.models, strict=True)):
        own = loop.cycle >= 0
        labels = (None, None) if number else ("measured", "contact fitted")
        x, f = 1e3 * loop.x[own], loop.f[own]
        axes.plot(x, f, ".", color="0.6", markersize=1.5, label=labels[0])
        typical = loop.cycle[own] == np.argsort(loop.amplitudes)[loop.cycles // 2]
        axes.plot(x[typical], model[typical], color=SLIP, label=labels[1])
        below.plot(x[typical], (f - model)[typical], color=SLIP, linewidth=0.6)
    N, mm = map(of.unit, ("N", "mm"))
    axes.set(ylabel=f"{of.noun('force')} ({N})", xticklabels=[])
    below.set(xlabel=f"{of.noun('displacement')} ({mm})", ylabel=f"residual ({N})")
    below.set(xlim=axes.get_xlim())
    return explained(figure, [(axes, axes)], scale=1.0)


@styled()
def loss(loops: Sequence[Loop], fit: LoopFit, of: Coordinate) -> Figure:
    """Return the energy lost per cycle against the amplitude: each cycle (dots), and the contact fitted, with its band
    of 95 %, for a motion like that of each record."""
    figure = page(DOUBLE_COLUMN, 82.0)
    axes = place(figure, 22.0, 20.0, 150.0, 56.0)
    reach = float(student.ppf(0.975, fit.freedom))
    X = np.linspace(0.0, 1.1 * max(float(loop.amplitudes.max()) for loop in loops), 40)[1:]
    size, unit = (1.0, "J") if loops[0].lost.mean() > 1.0 else (1e3, "mJ")
    for loop, colour in zip(loops, itertools.cycle(_COLOURS)):
        W, error = fit.loss(loop, X)
        measured = 1e3 * loop.amplitudes[loop.closed], size * loop.lost[loop.closed]
        axes.plot(*measured, "o", color=colour, markersize=3.0)
        axes.plot(1e3 * X, size * W, color=colour, label=Path(loop.name).name)
        band = size * (W - reach * error), size * (W + reach * error)
        axes.fill_between(1e3 * X, *band, color=colour, alpha=0.25, linewidth=0.0)
    axes.set(
        xlabel=f"amplitude, {of.label('X', 'mm')}", ylabel=f"energy lost per cycle, $W$ ({unit})"
    )
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    return explained(figure, [(axes, axes)], scale=1.0)


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
        records = table.groupby("record", sort=False)
        for (name, own), colour in zip(records, itertools.cycle(_COLOURS)):
            (line,) = axes.plot(
                own["cycle"], size * own[column], "o-", color=colour, markersize=3.0
            )
            line.set_label(Path(str(name)).name)
        axes.set(xlabel="cycle", ylabel=label)
    return explained(figure, [(axes, axes)], scale=1.0)
