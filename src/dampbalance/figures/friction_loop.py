"""Figure 2: the friction force over one cycle, against velocity."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ..motion.orbit import Orbit
from .cycle import LEFT, RIGHT, RING, WIDTH, arrow_along, branches, name_regime
from .style import DOUBLE_COLUMN, FAINT, SLIP, STICK, arrow, note, page, panel_letter, place, styled


@styled()
def friction_velocity_loop(orbit: Orbit) -> Figure:
    """Figure 2: friction force f = K_z z against velocity ẋ over one cycle, (a) whole, (b) around ẋ = 0.

    Marked as in the paper are the onsets C (t_1) of forward microstick, D (t_s) of forward slip, A (t_2) of
    backward microstick and B (t_r) of backward slip. Without slip there is nothing to mark: the loop is drawn
    as it is, and the regime named.
    """
    figure = page(DOUBLE_COLUMN, 72.0)
    whole, zoom = (place(figure, left, 12.0, WIDTH, 53.0) for left in (LEFT, RIGHT))
    cycle = branches(orbit)
    f_max = orbit.oscillator.F_k or 1.0  # without friction f is zero; any scale will do
    v_max = max(float(np.max(branch.state.v)) for branch in cycle)
    for axes, letter in ((whole, "a"), (zoom, "b")):
        panel_letter(axes, letter)
        for branch in cycle:
            force = orbit.oscillator.K_z * branch.state.z
            axes.plot(branch.state.v, force, color=branch.colour, lw=1.4)
        axes.axhline(0.0, color=FAINT, lw=0.4, zorder=0)
        axes.axvline(0.0, color=FAINT, lw=0.4, zorder=0)
        axes.set_xlabel(r"velocity $\dot{x}$ (m/s)")
        axes.set_ylabel(r"friction force $f$ (N)")
        axes.set_xlim(-1.15 * v_max, 1.15 * v_max)
        axes.set_ylim(-1.55 * f_max, 1.55 * f_max)
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    if np.isnan(orbit.V_s) or orbit.V_s == 0.0:
        name_regime(zoom, orbit)
        return figure

    reach = 2.5 * orbit.V_s
    zoom.set_xlim(-reach, reach)
    # each slip line is run through out and back, shown by an arrow on either side
    for sign, text in ((1.0, "forward slip"), (-1.0, "backward slip")):
        v, F = sign * v_max, sign * f_max
        arrow(whole, (0.4 * v, 1.11 * F), (0.7 * v, 1.11 * F), SLIP)
        arrow(whole, (0.7 * v, 0.89 * F), (0.4 * v, 0.89 * F), SLIP)
        whole.text(0.55 * v, 1.3 * F, text, ha="center", va="center", color=SLIP)
    low, tall = -1.2 * f_max, 2.4 * f_max
    frame = Rectangle((-reach, low), 2 * reach, tall, fill=False, ec=FAINT, lw=0.6, ls=(0, (3, 2)))
    whole.add_patch(frame)
    note(whole, "(b)", (reach, low), (3, 0), color=FAINT)
    # points A to D, the lines ±F_k, and the two microstick branches with their sense and duration
    F_k, V_s = orbit.oscillator.F_k, orbit.V_s
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
        zoom.plot(v, f, label=letter, ls="none", **RING)
        ha, va = "left" if shift[0] > 0 else "right", "bottom" if shift[1] > 0 else "top"
        note(zoom, rf"$\mathbf{{{letter}}}$, ${instant}$", (v, f), shift, ha, va)
    sticks = [branch.state for branch in cycle if branch.stick]
    for sign, state, name, side in (
        (1.0, sticks[0], "forward", "left"),
        (-1.0, sticks[len(sticks) // 2], "backward", "right"),
    ):
        arrow_along(zoom, state.v, orbit.oscillator.K_z * state.z, 0.55, STICK)
        words = f"{name}\nmicrostick\n{orbit.t_s * 1e3:.3g} ms"
        x, y = 1.2 * sign * V_s, -0.55 * sign * F_k
        zoom.text(x, y, words, ha=side, va="center", color=STICK, linespacing=1.3)
    return figure
