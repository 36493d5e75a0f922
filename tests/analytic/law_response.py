"""The steady response under any damping law, by the integrator and Newton's method.

Every known force grows with ẋ: README.md, section 9, holds under any law. There is one steady velocity, its own mirror
image half a period later, and s ↦ −Φ(s), Φ the motion over half a period, has one fixed point. The package's answer is
where the search begins; no start can bias a fixed point that is found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.optimize import root

from analytic.integrator import Phase, acceleration, phases
from dampbalance import BaseMotion, Oscillator, State
from dampbalance.motion.law_response import law_response

_CLOSED = 1e-12  # of the energy norm
_STEP = 0.1  # rad of the fastest oscillation: between events, too, the dense output is then good to 1e-14


@dataclass(frozen=True, eq=False)
class LawOrbit:
    """Steady response under any law, in place of an `Orbit` where a motion is sampled or integrated.

    theta : phase of the base at the reversal at −X, rad.   parts : of the half cycle from there on; the other half is
    the mirror image.   phases : (n, 5), rows (t, s, x, ẋ, z) of their starts.
    """

    oscillator: Oscillator
    motion: BaseMotion
    law: Mapping[str, float]
    theta: float
    parts: list[Phase]

    @property
    def phases(self):
        return np.array([part[:5] for part in self.parts])

    @property
    def X(self):
        """Peak displacement, m."""
        return -self.parts[0].x

    @property
    def a(self):
        """Distance slid per cycle, m: Eq. (7a)."""
        return 2.0 * sum(abs(part.end[0] - part.x) for part in self.parts if part.s)

    def state(self, t):
        """(x, ẋ, ẍ, z) at the times t, s, any shape; y = Y cos ωt."""
        omega, half = self.motion.omega, 0.5 * self.motion.period
        since = np.mod(np.ravel(t) - self.theta / omega, 2.0 * half)
        sign, since = np.where(since < half, 1.0, -1.0), since % half
        state, rows = np.empty((3, since.size)), np.searchsorted(self.phases[:, 0], since, "right")
        for row in np.unique(rows):
            state[:, rows == row] = self.parts[row - 1].state(since[rows == row])
        x, v, z = state
        angle = self.theta + omega * since
        moved = acceleration(self.oscillator, self.motion, self.law, x, v, z, angle)
        return State(*((sign * of).reshape(np.shape(t)) for of in (x, v, moved, z)))


def law_orbit(oscillator, motion, law) -> LawOrbit:
    """The steady response.   law : symbol → coefficient of the terms besides friction and c, which are the
    oscillator's."""
    half, Z_m = 0.5 * motion.period, oscillator.Z_m
    claimed = law_response(oscillator, motion, law).state(0.0)
    root_of_energy = np.sqrt([oscillator.k, oscillator.m, oscillator.K_z])
    start = np.array([claimed.x, claimed.v, claimed.z]) * root_of_energy
    units = np.linalg.norm(start) / root_of_energy

    def ahead(q):
        x, v, z = q * units
        return [*phases(oscillator, motion, half, x, v, np.clip(z, -Z_m, Z_m), 0.0, law, _STEP)]

    def closure(q):
        return q + ahead(q)[-1].end / units

    q = start / np.linalg.norm(start)
    if np.linalg.norm(closure(q)) > _CLOSED:
        q = root(closure, q, tol=0.01 * _CLOSED).x
        assert np.linalg.norm(closure(q)) < _CLOSED
    turns = [part for part in ahead(q)[1:] if part.v == 0.0] or ahead(q)[:1]
    turn = max(turns, key=lambda part: abs(part.x))
    side = -np.copysign(1.0, turn.x)
    theta = motion.omega * (turn.t + half * (side < 0.0))
    start = side * turn.x, 0.0, side * turn.z
    parts = phases(oscillator, motion, half, *start, theta, law, _STEP, dense=True)
    return LawOrbit(oscillator, motion, law, theta, [*parts])
