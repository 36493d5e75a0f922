"""Pictures of measured loops: force against displacement with the contact fitted, and the history of the cycles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ..figures.style import DOUBLE_COLUMN, SLIP, STICK, explained, page, place, styled
from .fit import Loop, LoopFit

if TYPE_CHECKING:
    import pandas as pd


@styled()
def loops(loops: Sequence[Loop], fit: LoopFit) -> Figure:
    """Force against displacement: samples (grey), and the contact fitted to each record, at its median amplitude."""
    figure = page(DOUBLE_COLUMN, 92.0)
    axes = place(figure, 22.0, 20.0, 150.0, 66.0)
    for number, (loop, model) in enumerate(zip(loops, fit.models, strict=True)):
        own = loop.cycle >= 0
        labels = (None, None) if number else ("measured", "contact fitted")
        x = 1e3 * loop.x[own]
        axes.plot(x, loop.f[own], ".", color="0.6", markersize=1.5, label=labels[0])
        typical = loop.cycle[own] == np.argsort(loop.amplitudes)[loop.cycles // 2]
        axes.plot(x[typical], model[typical], color=SLIP, label=labels[1])
    axes.set(xlabel="displacement (mm)", ylabel="force (N)")
    return explained(figure, [(axes, axes)], scale=1.0)


@styled()
def history(table: pd.DataFrame) -> Figure:
    """Friction force of each cycle that makes up for its loss, against the number of the cycle."""
    figure = page(DOUBLE_COLUMN, 82.0)
    axes = place(figure, 22.0, 20.0, 150.0, 56.0)
    for (name, own), colour in zip(
        table.groupby("record", sort=False), (SLIP, STICK, "0.3", "0.6") * len(table), strict=False
    ):
        axes.plot(own["cycle"], own["F_k_N"], "o-", color=colour, markersize=3.0, label=str(name))
    axes.set(xlabel="cycle", ylabel="friction force, $F_k$ (N)")
    return explained(figure, [(axes, axes)], scale=1.0)
