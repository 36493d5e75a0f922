"""What the identification from free decays looks like: each decay, the motion fitted to it, and what that leaves."""

from __future__ import annotations

import math
from typing import Any

from matplotlib.figure import Figure

from ..figures.style import DOUBLE_COLUMN, FAINT, SLIP, STICK, page, place, styled
from ..project.wording import cut
from .ringdown import RingDown

_POINTS = 6000  # samples drawn at most
_SHOWN = {
    "displacement": ("x", 1e3, "mm"),
    "velocity": (r"\dot x", 1.0, "m/s"),
    "acceleration": (r"\ddot x", 1.0, "m/s²"),
}
_MOST = 24  # panels
_LONGEST_TITLE = 60  # characters
_HEIGHT, _LEFT_OVER, _GAP, _BOTTOM, _TOP = 30.0, 9.0, 12.0, 11.0, 7.0  # mm


@styled()
def decays(result: RingDown) -> Figure:
    """Each decay (dots), the motion of the oscillator of largest likelihood (line) and the turns read for the balance
    (rings); below, what the fit leaves, over the standard deviation of the noise. A panel per decay, the first 24."""
    stretches = result.fit.stretches[:_MOST]
    rows = math.ceil(len(stretches) / 3)
    height = _BOTTOM + rows * (_HEIGHT + _LEFT_OVER + _GAP) - _GAP + _TOP
    figure = page(DOUBLE_COLUMN, height)
    dots: dict[str, Any] = {"color": FAINT, "markersize": 1.0, "rasterized": True}
    for i, (one, residuals) in enumerate(zip(stretches, result.fit.residuals(), strict=False)):
        row, column = divmod(i, 3)
        bottom = height - _TOP - _HEIGHT - row * (_HEIGHT + _LEFT_OVER + _GAP)
        left = 13.0 + 60.0 * column
        axes = place(figure, left, bottom, 44.0, _HEIGHT)
        below = place(figure, left, bottom - _LEFT_OVER, 44.0, _LEFT_OVER)
        signal, residual = one.signals[-1], residuals[-1]
        symbol, factor, unit = _SHOWN[signal.quantity]
        kept = slice(None, None, max(1, signal.t.size // _POINTS))
        t = signal.t[kept]
        axes.plot(t, factor * signal.values[kept], ".", **dots)
        model = signal.values + residual * signal.noise
        axes.plot(t, factor * model[kept], color=SLIP, linewidth=0.6)
        if signal.order == 0:
            turns, _ = result.rows.turns[i]
            offset = float(result.fit.point[4 + one.offsets[-1]])
            axes.plot(
                turns[:, 0],
                factor * (turns[:, 1] + offset),
                "o",
                color=STICK,
                markersize=2.5,
                fillstyle="none",
            )
        below.plot(t, residual[kept], ".", **dots)
        below.axhline(0.0, color=SLIP, linewidth=0.6)
        for frame in (axes, below):
            frame.set_xlim(one.start, one.end)
        axes.set_xticklabels([])
        axes.set_ylabel(f"${symbol}$ ({unit})", labelpad=1.0)
        axes.set_title(cut(one.source, _LONGEST_TITLE), pad=3.0, y=1.0, parse_math=False)
        below.set_xlabel("$t$ (s)", labelpad=1.0)
    return figure


def alternative_text(result: RingDown) -> str:
    """What the figure shows, in words."""
    return f"{len(result.fit.stretches)} free decays with the motion fitted to them, their turns and the residual"
