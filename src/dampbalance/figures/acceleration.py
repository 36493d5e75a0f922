"""Figure 3: where X_i, X_is and V_is are read off the acceleration."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ..motion.orbit import Array, Orbit
from ..motion.states import State
from .cycle import LEFT, RIGHT, RING, WIDTH, arrow_along, branches, name_regime
from .style import (
    DOUBLE_COLUMN,
    FAINT,
    HALO,
    INK,
    SLIP,
    STICK,
    arrow,
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
    if not orbits:
        raise ValueError("Figure 3 needs at least one orbit: give the responses of one frequency")
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
        for state, stick in branches(orbit):
            colour = STICK if stick else SLIP
            a.plot(state.x * 1e3, state.acceleration, color=colour)
            c.plot(state.v, state.acceleration, color=colour)
    _label_levels(a, c, orbits)

    level = next((i for i, orbit in enumerate(orbits) if orbit.X_s > -orbit.X), None)
    if level is None:
        for axes in (b, d):
            axes.set(xticks=[], yticks=[])
            name_regime(axes, orbits[0])
        return figure
    orbit = orbits[level]
    for branch in branches(orbit):
        state = branch.state
        b.plot(state.x * 1e3, state.acceleration, color=branch.colour, lw=1.4)
        d.plot(state.v, state.acceleration, color=branch.colour, lw=1.4)
    _microstick_line(b, orbit, level + 1)
    _corner(d, orbit, level + 1)
    _show_where(a, b, "b", beside=False)
    _show_where(c, d, "d", beside=True)
    return figure


def _microstick_line(axes: Axes, orbit: Orbit, i: int) -> None:
    """Window and marks of panel (b) for level i: the line from −X_i to X_is, of length 2 Z_m."""
    x_reversal, x_slip, length = -orbit.X * 1e3, orbit.X_s * 1e3, (orbit.X_s + orbit.X) * 1e3
    top, bottom = _ends_of_microstick(orbit)
    drop = top - bottom
    axes.set_xlim(x_reversal - 0.9 * length, x_slip + 2.4 * length)
    axes.set_ylim(bottom - 0.6 * drop, top + 0.25 * drop)
    axes.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
    _mark(axes, x_reversal, top, f"$-X_{{{i}}}$", "-X", "right")
    _mark(axes, x_slip, bottom, f"$X_{{{i}s}}$", "X_s", "left")

    span = bottom - 0.2 * drop
    arrow(axes, (x_reversal, span), (x_slip, span), INK, "<->,head_length=0.2,head_width=0.12")
    axes.annotate(
        f"$2Z_m$ = {length * 1e3:.4g} µm",
        xy=(x_slip, span),
        xytext=(4, 0),
        textcoords="offset points",
        va="center",
    )
    axes.text(
        x_reversal + 0.8 * length,
        bottom + 0.5 * drop,
        "microstick,\n" r"slope $\approx {-}(k + K_z)/m$",
        color=STICK,
        va="center",
        linespacing=1.3,
    )
    backward, forward = _slip_around(orbit)
    _name_and_arrow(axes, backward.x * 1e3, backward.acceleration, "backward slip")
    _name_and_arrow(axes, forward.x * 1e3, forward.acceleration, "forward slip")


def _corner(axes: Axes, orbit: Orbit, i: int) -> None:
    """Window and marks of panel (d) for level i: the corner where microstick gives way to slip, at V_is."""
    V_s = orbit.V_s
    top, bottom = _ends_of_microstick(orbit)
    drop = top - bottom
    axes.set_xlim(-1.6 * V_s, 3.2 * V_s)
    axes.set_ylim(bottom - 0.6 * drop, top + 0.25 * drop)
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    _mark(axes, V_s, bottom, f"$V_{{{i}s}}$", "V_s", "left")
    axes.text(V_s, bottom + 0.6 * drop, "microstick", color=STICK, va="center")
    backward, forward = _slip_around(orbit)
    _name_and_arrow(axes, backward.v, backward.acceleration, "backward slip")
    _name_and_arrow(axes, forward.v, forward.acceleration, "forward slip")


def _ends_of_microstick(orbit: Orbit) -> tuple[float, float]:
    """Acceleration at the reversal t_1 and at the slip onset that follows, m/s²."""
    reversal, slip = orbit.state([orbit.t_1, orbit.t_1 + orbit.t_s]).acceleration
    return float(reversal), float(slip)


def _slip_around(orbit: Orbit) -> tuple[State, State]:
    """The slip phases before and after the microstick phase at −X."""
    slips = [branch.state for branch in branches(orbit) if not branch.stick]
    return slips[-1], slips[0]


def _mark(axes: Axes, x: float, y: float, text: str, label: str, side: str) -> None:
    """A ring on the curve at (x, y) and a dashed line down to the axis with its symbol beside it."""
    low = axes.get_ylim()[0]
    axes.plot([x, x], [low, y], color=FAINT, lw=0.7, ls=(0, (4, 2)), zorder=1, label=label)
    axes.plot(x, y, ls="none", **RING)
    axes.annotate(
        text,
        xy=(x, low),
        xytext=(-3 if side == "right" else 3, 3),
        textcoords="offset points",
        ha=side,
        va="bottom",
    )


def _label_levels(a: Axes, c: Axes, orbits: Sequence[Orbit]) -> None:
    """Which loop belongs to which level: in (a) above its right end, in (c) on the loop where ẍ = 0."""
    for n, orbit in enumerate(orbits):
        level = f"{orbit.motion.Y * 1e3:g}"
        states = [branch.state for branch in branches(orbit)]
        x, v, acceleration = (
            np.concatenate([getattr(state, name) for state in states])
            for name in ("x", "v", "acceleration")
        )
        a.annotate(
            f"$Y$ = {level} mm" if n == 0 else level,
            xy=(orbit.X * 1e3, float(np.max(acceleration[x > 0.98 * orbit.X]))),
            xytext=(-6 if n == 0 else 0, 2),
            textcoords="offset points",
            ha="left" if n == 0 else "center",
            va="bottom",
            size=8,
        )
        forward = np.flatnonzero(v > 0.5 * np.max(v))
        crossing = forward[np.argmin(np.abs(acceleration[forward]))]
        c.text(float(v[crossing]), 0.0, level, ha="center", va="center", size=8, bbox=HALO)
    c.text(0.0, 0.0, "$Y$ in mm:", ha="center", va="center", size=8)


def _show_where(axes: Axes, zoomed: Axes, letter: str, beside: bool) -> None:
    """Frame in a panel what its neighbour enlarges; name it beside the frame, or from afar if that is narrow."""
    (left, right), (low, high) = zoomed.get_xlim(), zoomed.get_ylim()
    axes.add_patch(
        Rectangle((left, low), right - left, high - low, fill=False, ec=INK, lw=0.5, zorder=4)
    )
    axes.annotate(
        f"({letter})",
        xy=(left, low),
        xytext=(-2, 0) if beside else (-10, -8),
        textcoords="offset points",
        ha="right",
        va="bottom" if beside else "top",
        size=8,
        arrowprops=None
        if beside
        else {"arrowstyle": "-", "lw": 0.5, "color": INK, "shrinkA": 0, "shrinkB": 0},
    )


def _name_and_arrow(axes: Axes, x: Array, y: Array, name: str) -> None:
    """Name the part of a slip curve that the window shows, above it, and show its sense."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    seen = np.flatnonzero((x > left) & (x < right) & (y > low) & (y < high))
    if seen.size < 4:
        return
    first, last = seen[0], seen[-1] + 1
    arrow_along(axes, x[first:last], y[first:last], 0.5, SLIP)
    middle = int(np.argmin(np.abs(x[first:last] - 0.5 * (x[first] + x[last - 1])))) + first
    axes.annotate(
        name,
        xy=(float(x[middle]), float(y[middle])),
        xytext=(0, 6),
        textcoords="offset points",
        ha="center",
        va="bottom",
        color=SLIP,
    )
