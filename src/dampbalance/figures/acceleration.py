"""Figure 3: where X_i, X_is and V_is are read off the acceleration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ..arrays import Array
from ..motion.orbit import Orbit
from .cycle import (
    LEFT,
    RIGHT,
    RING,
    WIDTH,
    Branch,
    arrow_along,
    branches,
    first_onset,
    name_regime,
    right_end,
    whole,
)
from .style import (
    DASHED,
    DOUBLE_COLUMN,
    FAINT,
    INK,
    SLIP,
    STICK,
    arrow,
    note,
    page,
    panel_letter,
    place,
    styled,
)


@styled()
def figure3(orbits: Sequence[Orbit]) -> Figure:
    """Figure 3: acceleration against (a) displacement, (b) its microsticking line, (c) velocity, (d) its corner.

    orbits : the responses of one frequency, one per excitation level. (b) and (d) enlarge the first that slips
    and mark where −X_i, X_is and V_is are read: the microsticking line runs from −X_i to X_is, the corner
    stands at V_is. Where nothing slips they name the regime instead.
    Raises ValueError when there is no orbit.
    """
    onset = first_onset(orbits)
    figure = page(DOUBLE_COLUMN, 146.0)
    a, b = (place(figure, left, 87.0, WIDTH, 53.0) for left in (LEFT, RIGHT))
    c, d = (place(figure, left, 12.0, WIDTH, 56.0) for left in (LEFT, RIGHT))
    for axes, letter in ((a, "a"), (b, "b"), (c, "c"), (d, "d")):
        panel_letter(axes, letter)
        axes.set_ylabel(r"acceleration $\ddot{x}$ (m/s$^2$)")
    for axes in (a, b):
        axes.set_xlabel("displacement $x$ (mm)")
    for axes in (c, d):
        axes.set_xlabel(r"velocity $\dot{x}$ (m/s)")

    for orbit in orbits:
        cycle = branches(orbit)
        _draw(a, c, cycle, gid=f"$Y$ = {1e3 * orbit.motion.Y:g} mm")
        _name_loop(a, c, orbit, cycle, first=orbit is orbits[0])
    if onset is None:
        for axes in (b, d):
            axes.set(xticks=[], yticks=[])
            name_regime(axes, orbits[0])
        return figure
    cycle = branches(onset.orbit)
    _draw(b, d, cycle, gid=f"$Y$ = {1e3 * onset.orbit.motion.Y:g} mm", lw=1.4)
    slips = [branch.state for branch in cycle if not branch.stick]
    for axes, limits, ticks in ((b, onset.x_limits, 7), (d, onset.v_limits, 5)):
        axes.set_xlim(*limits)
        axes.set_ylim(*onset.acceleration_limits)
        axes.xaxis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 5, 10]))
    (x_reversal, x_slip), (top, bottom), i = onset.x, onset.acceleration, onset.level + 1
    drop = top - bottom
    # (b): the line from −X_i to X_is and its length, which with one slip onset is 2 Z_m
    _mark(b, x_reversal, top, f"$-X_{{{i}}}$", "-X", "right")
    _mark(b, x_slip, bottom, f"$X_{{{i}s}}$", "X_s", "left")
    span = bottom - 0.2 * drop
    arrow(b, (x_reversal, span), (x_slip, span), INK, "<->,head_length=0.2,head_width=0.12")
    length = f"$X_{{{i}}} + X_{{{i}s}}$ = {onset.length * 1e3:.4g} µm"
    note(b, length, (x_slip, span), (4, 0), va="center")
    x, words = x_reversal + 0.8 * onset.length, "microstick,\n" r"slope $\approx {-}(k + K_z)/m$"
    b.text(x, bottom + 0.5 * drop, words, color=STICK, va="center", linespacing=1.3)
    # (d): the corner where microstick gives way to slip, at V_is
    _mark(d, onset.V_s, bottom, f"$V_{{{i}s}}$", "V_s", "left")
    d.text(onset.V_s, bottom + 0.6 * drop, "microstick", color=STICK, va="center")
    for state, name in ((slips[-1], "backward slip"), (slips[0], "forward slip")):
        _name_and_arrow(b, state.x * 1e3, state.acceleration, name)
        _name_and_arrow(d, state.v, state.acceleration, name)
    # The frame of (b) is too narrow to be named beside it.
    line = {"arrowstyle": "-", "lw": 0.5, "color": INK, "shrinkA": 0, "shrinkB": 0}
    _show_where(a, b, "b", shift=(-10, -8), va="top", arrowprops=line)
    _show_where(c, d, "d", shift=(-2, 0))
    return figure


def _draw(over_x: Axes, over_v: Axes, cycle: Sequence[Branch], **style: Any) -> None:
    """A loop over the displacement, and over the velocity."""
    for branch in cycle:
        state = branch.state
        over_x.plot(state.x * 1e3, state.acceleration, color=branch.colour, **style)
        over_v.plot(state.v, state.acceleration, color=branch.colour, **style)


def _mark(axes: Axes, x: float, y: float, text: str, label: str, side: str) -> None:
    """A ring on the curve at (x, y) and a dashed line down to the axis with its symbol beside it."""
    low = axes.get_ylim()[0]
    axes.plot([x, x], [low, y], color=FAINT, lw=0.7, ls=DASHED, zorder=1, label=label)
    axes.plot(x, y, ls="none", **RING)
    note(axes, text, (x, low), (-3 if side == "right" else 3, 3), ha=side)


def _name_loop(a: Axes, c: Axes, orbit: Orbit, cycle: Sequence[Branch], first: bool) -> None:
    """Which level a loop belongs to: in (a) above its right end, in (c) inside it where ẍ = 0."""
    level = f"{orbit.motion.Y * 1e3:g}"
    text, x, ha = (f"$Y$ = {level} mm", -6, "left") if first else (level, 0, "center")
    note(a, text, right_end(orbit), (x, 2), ha=ha, size=8)
    states = whole(cycle)
    forward = np.flatnonzero(states.v > 0.5 * np.max(states.v))
    crossing = forward[np.argmin(np.abs(states.acceleration[forward]))]
    if first:
        c.text(0.0, 0.0, text, ha="center", va="center", size=8)
    else:
        note(c, level, (float(states.v[crossing]), 0.0), (-3, 0), ha="right", va="center", size=8)


def _show_where(axes: Axes, zoomed: Axes, letter: str, **place: Any) -> None:
    """Frame in a panel what its neighbour enlarges, and name it."""
    (left, right), (low, high) = zoomed.get_xlim(), zoomed.get_ylim()
    size = right - left, high - low
    axes.add_patch(Rectangle((left, low), *size, fill=False, ec=INK, lw=0.5, zorder=4))
    note(axes, f"({letter})", (left, low), ha="right", size=8, **place)


def _name_and_arrow(axes: Axes, x: Array, y: Array, name: str) -> None:
    """Name the part of a slip curve that the window shows, above it, and show its sense."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    seen = np.flatnonzero((x > left) & (x < right) & (y > low) & (y < high))
    if seen.size < 4:
        return
    first, last = seen[0], seen[-1] + 1
    arrow_along(axes, x[first:last], y[first:last], 0.5, SLIP)
    middle = int(np.argmin(np.abs(x[first:last] - 0.5 * (x[first] + x[last - 1])))) + first
    note(axes, name, (float(x[middle]), float(y[middle])), (0, 6), ha="center", color=SLIP)
