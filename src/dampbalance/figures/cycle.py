"""One steady cycle as curves, and Figures 2 and 3, which show where its features are read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ..arrays import Array
from ..motion.events import PHASE_S, PHASE_T
from ..motion.orbit import Orbit
from ..motion.states import State
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

_LEFT_COLUMN, _RIGHT_COLUMN, _WIDTH = 15.0, 104.0, 72.0  # mm: the two columns of panels
_RING: dict[str, Any] = {"marker": "o", "ms": 4.0, "mfc": "white", "mec": INK, "mew": 0.9}
_RING |= {"ls": "none", "zorder": 5}
_VELOCITY = r"velocity $\dot{x}$ (m/s)"


class Branch(NamedTuple):
    """The states of one phase of the cycle, and whether it is microstick."""

    state: State
    stick: bool

    @property
    def colour(self) -> str:
        """The colour of its kind."""
        return STICK if self.stick else SLIP


def branches(orbit: Orbit) -> list[Branch]:
    """Return the phases of one cycle, in order, from the reversal at −X at time t_1 on; neighbours share an instant."""
    half = 0.5 * orbit.motion.period
    edges = np.append(orbit.phases[:, PHASE_T], half)
    cycle = []
    for begin in (0.0, half):
        for n, sign in enumerate(orbit.phases[:, PHASE_S]):
            stick = bool(sign == 0.0)
            # 240 instants for each slip phase, 90 for each microstick phase
            since = np.linspace(edges[n], edges[n + 1], {False: 240, True: 90}[stick])
            cycle.append(Branch(orbit.state(orbit.t_1 + begin + since), stick))
    return cycle


def whole_cycle(cycle: Sequence[Branch]) -> State:
    """Return the states of all phases, one after the other."""
    return State(*map(np.concatenate, zip(*(branch.state for branch in cycle), strict=True)))


@styled()
def friction_velocity_loop(orbit: Orbit) -> Figure:
    """Draw figure 2: friction force f = K_z z against velocity ẋ over one cycle, (a) whole, (b) around ẋ = 0.

    Marked as in the paper are the onsets C (t_1) of forward microstick, D (t_s) of forward slip, A (t_2) of
    backward microstick and B (t_r) of backward slip. Without slip there is nothing to mark: the loop is drawn
    as it is, and the regime named.
    """
    figure = page(DOUBLE_COLUMN, 62.0)
    full, zoom = (place(figure, left, 11.0, _WIDTH, 45.0) for left in (_LEFT_COLUMN, _RIGHT_COLUMN))
    cycle, (F_k, K_z) = branches(orbit), (orbit.oscillator.F_k, orbit.oscillator.K_z)
    f_max = F_k or 1.0  # without friction f is zero; any scale will do
    v_max = max(float(np.max(branch.state.v)) for branch in cycle)
    for axes, letter in ((full, "a"), (zoom, "b")):
        panel_letter(axes, letter)
        for branch in cycle:
            axes.plot(branch.state.v, K_z * branch.state.z, color=branch.colour, lw=1.4)
        axes.axhline(0.0, color=FAINT, lw=0.4, zorder=0)
        axes.axvline(0.0, color=FAINT, lw=0.4, zorder=0)
        axes.set(xlabel=_VELOCITY, ylabel=r"friction force $f$ (N)")
        axes.set(xlim=(-1.15 * v_max, 1.15 * v_max), ylim=(-1.55 * f_max, 1.55 * f_max))
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    V_s = orbit.V_s
    if np.isnan(V_s) or V_s == 0.0:
        _name_regime(zoom, orbit)
        return figure

    reach = 2.5 * V_s
    zoom.set_xlim(-reach, reach)
    # each slip line is run through out and back, shown by an arrow on either side
    for sign, text in ((1.0, "forward slip"), (-1.0, "backward slip")):
        v, F = sign * v_max, sign * f_max
        arrow(full, (0.4 * v, 1.11 * F), (0.7 * v, 1.11 * F), SLIP)
        arrow(full, (0.7 * v, 0.89 * F), (0.4 * v, 0.89 * F), SLIP)
        full.text(0.55 * v, 1.3 * F, text, ha="center", va="center", color=SLIP)
    low, tall = -1.2 * f_max, 2.4 * f_max
    frame = Rectangle((-reach, low), 2 * reach, tall, fill=False, ec=FAINT, lw=0.6, ls=(0, (3, 2)))
    full.add_patch(frame)
    note(full, "(b)", (reach, low), (3, 0), color=FAINT)
    # points A to D, the lines ±F_k, and the two microstick branches with their sense and duration
    zoom.plot([-reach, 0.0], [F_k, F_k], color=FAINT, lw=0.6, ls=(0, (1, 2)))
    zoom.plot([0.0, reach], [-F_k, -F_k], color=FAINT, lw=0.6, ls=(0, (1, 2)))
    zoom.text(-0.95 * reach, 1.08 * F_k, "$F_k$", ha="left", va="bottom")
    zoom.text(0.95 * reach, -1.08 * F_k, "$-F_k$", ha="right", va="top")
    for letter, instant, v, f, shift in (
        ("A", "t_2", 0.0, F_k, (-4, 4)),
        ("B", "t_r", -V_s, -F_k, (-4, -4)),
        ("C", "t_1", 0.0, -F_k, (4, -4)),
        ("D", "t_s", V_s, F_k, (4, 4)),
    ):
        zoom.plot(v, f, label=letter, **_RING)
        ha, va = "left" if shift[0] > 0 else "right", "bottom" if shift[1] > 0 else "top"
        note(zoom, rf"$\mathbf{{{letter}}}$, ${instant}$", (v, f), shift, ha, va)
    sticks = [branch.state for branch in cycle if branch.stick]
    for sign, state, name, side in (
        (1.0, sticks[0], "forward", "left"),
        (-1.0, sticks[len(sticks) // 2], "backward", "right"),
    ):
        _arrow_along(zoom, state.v, K_z * state.z, 0.55, STICK)
        words = f"{name}\nmicrostick\n{orbit.t_s * 1e3:.3g} ms"
        x, y = 1.2 * sign * V_s, -0.55 * sign * F_k
        zoom.text(x, y, words, ha=side, va="center", color=STICK, linespacing=1.3)
    return figure


@styled()
def figure3(orbits: Sequence[Orbit]) -> Figure:
    """Draw figure 3: acceleration against (a) displacement, (b) its microsticking line, (c) velocity, (d) its corner.

    orbits : the responses of one frequency, one per excitation level. (b) and (d) enlarge the first that slips
    and mark where −X, X_s and V_s are read: the microsticking line runs from −X to X_s, the corner stands at V_s.
    Where nothing slips they name the regime instead.
    Raises ValueError when there is no orbit.
    """
    if not orbits:
        raise ValueError("Figure 3 needs at least one orbit: give the responses of one frequency")
    figure = page(DOUBLE_COLUMN, 146.0)
    a, b = (place(figure, left, 87.0, _WIDTH, 53.0) for left in (_LEFT_COLUMN, _RIGHT_COLUMN))
    c, d = (place(figure, left, 12.0, _WIDTH, 56.0) for left in (_LEFT_COLUMN, _RIGHT_COLUMN))
    for axes, letter in zip((a, b, c, d), "abcd", strict=True):
        panel_letter(axes, letter)
        axes.set_xlabel("displacement $x$ (mm)" if axes in (a, b) else _VELOCITY)
        axes.set_ylabel(r"acceleration $\ddot{x}$ (m/s$^2$)")
    for orbit in orbits:
        _name_loop(a, c, orbit, _draw(a, c, orbit), first=orbit is orbits[0])
    onset = next((orbit for orbit in orbits if orbit.X_s > -orbit.X), None)
    if onset is None:
        for axes in (b, d):
            axes.set(xticks=[], yticks=[])
            _name_regime(axes, orbits[0])
        return figure
    slips = [branch.state for branch in _draw(b, d, onset, lw=1.4) if not branch.stick]
    top, bottom = onset.state([onset.t_1, onset.t_1 + onset.t_s]).acceleration.tolist()
    x_reversal, x_slip, V_s, drop = -onset.X * 1e3, onset.X_s * 1e3, onset.V_s, top - bottom
    length = (onset.X_s + onset.X) * 1e3  # of the microstick line, mm
    for axes, limits, ticks in (
        (b, (x_reversal - 0.9 * length, x_slip + 2.4 * length), 7),
        (d, (-1.6 * V_s, 3.2 * V_s), 5),
    ):
        axes.set(xlim=limits, ylim=(bottom - 0.6 * drop, top + 0.25 * drop))
        axes.xaxis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 5, 10]))
    # (b): the line from −X to X_s and its length, which with one slip onset is 2 Z_m
    _mark(b, x_reversal, top, "$-X$", "-X", "right")
    _mark(b, x_slip, bottom, "$X_s$", "X_s", "left")
    span = bottom - 0.2 * drop
    arrow(b, (x_reversal, span), (x_slip, span), INK, "<->,head_length=0.2,head_width=0.12")
    words = f"$X + X_s$ = {length * 1e3:.4g} µm"
    note(b, words, (x_slip, span), (4, 0), va="center")
    x, words = x_reversal + 0.8 * length, "microstick,\n" r"slope $\approx {-}(k + K_z)/m$"
    b.text(x, bottom + 0.5 * drop, words, color=STICK, va="center", linespacing=1.3)
    # (d): the corner where microstick gives way to slip, at V_s
    _mark(d, V_s, bottom, "$V_s$", "V_s", "left")
    d.text(V_s, bottom + 0.6 * drop, "microstick", color=STICK, va="center")
    for state, name in ((slips[-1], "backward slip"), (slips[0], "forward slip")):
        _name_and_arrow(b, state.x * 1e3, state.acceleration, name)
        _name_and_arrow(d, state.v, state.acceleration, name)
    # The frame of (b) is too narrow for its name to stand next to it.
    line = {"arrowstyle": "-", "lw": 0.5, "color": INK, "shrinkA": 0, "shrinkB": 0}
    _show_where(a, b, "b", shift=(-10, -8), va="top", arrowprops=line)
    _show_where(c, d, "d", shift=(-2, 0))
    return figure


def _draw(over_x: Axes, over_v: Axes, orbit: Orbit, **look: Any) -> list[Branch]:
    """Draw a loop over displacement and over velocity, and return its branches."""
    cycle = branches(orbit)
    for state, colour in ((branch.state, branch.colour) for branch in cycle):
        over_x.plot(state.x * 1e3, state.acceleration, color=colour, **look)
        over_v.plot(state.v, state.acceleration, color=colour, **look)
    return cycle


def _mark(axes: Axes, x: float, y: float, text: str, label: str, side: str) -> None:
    """Draw a ring on the curve at (x, y), and a dashed line down to the axis with its symbol."""
    low = axes.get_ylim()[0]
    axes.plot([x, x], [low, y], color=FAINT, lw=0.7, ls=DASHED, zorder=1, label=label)
    axes.plot(x, y, **_RING)
    note(axes, text, (x, low), (-3 if side == "right" else 3, 3), ha=side)


def _name_loop(a: Axes, c: Axes, orbit: Orbit, cycle: Sequence[Branch], first: bool) -> None:
    """Write the level of a loop: in (a) above its right end, in (c) inside it where ẍ = 0."""
    level, states = f"{orbit.motion.Y * 1e3:g}", whole_cycle(cycle)
    text, x, ha = (f"$Y$ = {level} mm", -6, "left") if first else (level, 0, "center")
    end = orbit.X * 1e3, float(np.max(states.acceleration[states.x > 0.98 * orbit.X]))
    note(a, text, end, (x, 2), ha=ha, size=8)
    if first:
        c.text(0.0, 0.0, text, ha="center", va="center", size=8)
        return
    forward = np.flatnonzero(states.v > 0.5 * np.max(states.v))
    crossing = forward[np.argmin(np.abs(states.acceleration[forward]))]
    note(c, level, (float(states.v[crossing]), 0.0), (-3, 0), ha="right", va="center", size=8)


def _show_where(axes: Axes, zoomed: Axes, letter: str, **place: Any) -> None:
    """Mark in a panel what its neighbour enlarges, and name it."""
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
    x, y = x[seen[0] : seen[-1] + 1], y[seen[0] : seen[-1] + 1]
    _arrow_along(axes, x, y, 0.5, SLIP)
    middle = int(np.argmin(np.abs(x - 0.5 * (x[0] + x[-1]))))
    note(axes, name, (float(x[middle]), float(y[middle])), (0, 6), ha="center", color=SLIP)


def _arrow_along(axes: Axes, x: Array, y: Array, share: float, colour: str) -> None:
    """Draw an arrow head on a curve, at this share of its way along x."""
    target = x[0] + share * (x[-1] - x[0])
    n = max(1, int(np.argmin(np.abs(x - target))))
    arrow(axes, (float(x[n - 1]), float(y[n - 1])), (float(x[n]), float(y[n])), colour)


def _name_regime(axes: Axes, orbit: Orbit) -> None:
    """Write into a panel why there is nothing to mark."""
    axes.text(0.5, 0.9, str(orbit.regime), transform=axes.transAxes, ha="center", va="center")
