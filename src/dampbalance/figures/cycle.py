"""One steady cycle as curves: its phases, and what Figures 2 and 3 share to draw them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from ..motion.events import PHASE_S, PHASE_T
from ..motion.orbit import Array, Orbit
from ..motion.states import State
from .style import INK, SLIP, STICK, arrow

POINTS = {False: 240, True: 90}  # instants drawn per slip phase, per microstick phase
LEFT, RIGHT, WIDTH = 15.0, 104.0, 72.0  # mm: the two columns of panels
RING: dict[str, Any] = {
    "marker": "o",
    "ms": 4.0,
    "mfc": "white",
    "mec": INK,
    "mew": 0.9,
    "zorder": 5,
}


class Branch(NamedTuple):
    """One phase of the cycle: its states from beginning to end, and whether it is microstick."""

    state: State
    stick: bool

    @property
    def colour(self) -> str:
        """The colour of its kind."""
        return STICK if self.stick else SLIP


def branches(orbit: Orbit) -> list[Branch]:
    """The phases of one cycle, in order, from the reversal at −X at time t_1 on; neighbours share an instant."""
    half = 0.5 * orbit.motion.period
    edges = np.append(orbit.phases[:, PHASE_T], half)
    found = []
    for start in (orbit.t_1, orbit.t_1 + half):
        for n, sign in enumerate(orbit.phases[:, PHASE_S]):
            stick = bool(sign == 0.0)
            times = start + np.linspace(edges[n], edges[n + 1], POINTS[stick])
            found.append(Branch(orbit.state(times), stick))
    return found


def arrow_along(axes: Axes, x: Array, y: Array, share: float, colour: str) -> None:
    """An arrow head on a curve, at this share of its way along x."""
    target = x[0] + share * (x[-1] - x[0])
    n = max(1, int(np.argmin(np.abs(x - target))))
    arrow(axes, (float(x[n - 1]), float(y[n - 1])), (float(x[n]), float(y[n])), colour)


def name_regime(axes: Axes, orbit: Orbit) -> None:
    """Say in a panel why there is nothing to mark."""
    axes.text(0.5, 0.9, str(orbit.regime), transform=axes.transAxes, ha="center", va="center")
