"""One steady cycle as curves: its phases, and what Figures 2 and 3 share to draw them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..motion.events import PHASE_S, PHASE_T
from ..motion.orbit import Orbit
from ..motion.states import State
from .style import INK, SLIP, STICK, arrow

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
    """One phase of the cycle: times since the reversal at −X, s, its states at these, and whether it is microstick."""

    t: Array
    state: State
    stick: bool

    @property
    def colour(self) -> str:
        """The colour of its kind."""
        return STICK if self.stick else SLIP


class Onset(NamedTuple):
    """The microstick phase that begins at a reversal at −X, and the stretch around it that Figure 3 enlarges.

    level : number of the orbit among its like, from 0.   x : displacement at its beginning and end, mm.
    acceleration : the same, m/s².   V_s : velocity at its end, m/s.
    """

    level: int
    orbit: Orbit
    x: tuple[float, float]
    acceleration: tuple[float, float]
    V_s: float

    @property
    def length(self) -> float:
        """Length X + X_s of the microstick line, mm."""
        return (self.orbit.X_s + self.orbit.X) * 1e3

    @property
    def x_limits(self) -> tuple[float, float]:
        """Displacements to show, mm."""
        return self.x[0] - 0.9 * self.length, self.x[1] + 2.4 * self.length

    @property
    def v_limits(self) -> tuple[float, float]:
        """Velocities to show, m/s."""
        return -1.6 * self.V_s, 3.2 * self.V_s

    @property
    def acceleration_limits(self) -> tuple[float, float]:
        """Accelerations to show, m/s²."""
        top, bottom = self.acceleration
        drop = top - bottom
        return bottom - 0.6 * drop, top + 0.25 * drop


def branches(orbit: Orbit) -> list[Branch]:
    """The phases of one cycle, in order, from the reversal at −X at time t_1 on; neighbours share an instant."""
    half = 0.5 * orbit.motion.period
    edges = np.append(orbit.phases[:, PHASE_T], half)
    cycle = []
    for begin in (0.0, half):
        for n, sign in enumerate(orbit.phases[:, PHASE_S]):
            stick = bool(sign == 0.0)
            since = np.linspace(edges[n], edges[n + 1], POINTS[stick])
            cycle.append(Branch(begin + since, orbit.state(orbit.t_1 + begin + since), stick))
    return cycle


def whole(cycle: Sequence[Branch]) -> State:
    """The states of all phases, one after the other."""
    return State(*map(np.concatenate, zip(*(branch.state for branch in cycle), strict=True)))


def right_end(orbit: Orbit) -> tuple[float, float]:
    """Where a loop over the displacement ends on the right: (mm, largest acceleration there, m/s²)."""
    states = whole(branches(orbit))
    return orbit.X * 1e3, float(np.max(states.acceleration[states.x > 0.98 * orbit.X]))


def first_onset(orbits: Sequence[Orbit]) -> Onset | None:
    """The slip onset of the first orbit that has one: what Figure 3 enlarges.

    orbits : the responses of one frequency, one per excitation level. Raises ValueError when there is none.
    """
    if not orbits:
        raise ValueError("Figure 3 needs at least one orbit: give the responses of one frequency")
    for level, orbit in enumerate(orbits):
        if orbit.X_s > -orbit.X:
            reversal, slip = orbit.state([orbit.t_1, orbit.t_1 + orbit.t_s]).acceleration
            x = (-orbit.X * 1e3, orbit.X_s * 1e3)
            return Onset(level, orbit, x, (float(reversal), float(slip)), orbit.V_s)
    return None


def arrow_along(axes: Axes, x: Array, y: Array, share: float, colour: str) -> None:
    """An arrow head on a curve, at this share of its way along x."""
    target = x[0] + share * (x[-1] - x[0])
    n = max(1, int(np.argmin(np.abs(x - target))))
    arrow(axes, (float(x[n - 1]), float(y[n - 1])), (float(x[n]), float(y[n])), colour)


def name_regime(axes: Axes, orbit: Orbit) -> None:
    """Say in a panel why there is nothing to mark."""
    axes.text(0.5, 0.9, str(orbit.regime), transform=axes.transAxes, ha="center", va="center")
