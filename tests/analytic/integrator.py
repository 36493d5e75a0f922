"""A stick/slip state machine on scipy's DOP853 under any damping law, independent of the package: README.md, section 3.

The state carries, besides displacement and velocity, the three integrals of the energy balance. Displacement is
integrated as the gain u = x − x₀ since the last event, so that the micrometres of a stick phase are resolved beside
millimetres of motion.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from dampbalance.law.terms import term

_STEP = 0.25  # rad of the fastest oscillation: the dense output, which locates events, is then good to 1e-13
_RTOL = 1e-12


class Phase(NamedTuple):
    """From one event to the next: the state at its start, t since that of the motion, and what SciPy found.

    s : ±1 in slip, 0 in stick.   end : (x, ẋ, z).
    """

    t: float
    s: float
    x: float
    v: float
    z: float
    end: tuple[float, float, float]
    found: Any

    def state(self, t):
        """(x, ẋ, z) at times of this phase."""
        u, v = self.found.sol(t)[:2]
        return self.x + u, v, self.z + u * (self.s == 0.0)


def acceleration(oscillator, motion, law, x, v, z, angle):
    """ẍ where the base has the phase `angle`; y = Y cos angle."""
    o, omega, of = oscillator, motion.omega, math if isinstance(angle, float) else np
    force = o.k * (motion.Y * of.cos(angle) - x) - o.c * v - o.K_z * z
    for symbol, p in law.items():
        w = -omega * motion.Y * of.sin(angle)
        force = force - p * term(symbol).force(v, w, o.k, omega)
    return force / o.m


def _phase(o, motion, t, end, x, v, z, theta, law, step, dense):
    """The phase that starts at time t: a turn of the motion ends it, an onset of slip, or the end of all."""

    def rate(t, q, s):
        u, v, *_ = q.tolist()
        angle = theta + motion.omega * t
        moved = acceleration(o, motion, law, x + u, v, z + u * (s == 0.0), angle)
        return [v, moved, s * v, v * v, o.k * motion.Y * math.cos(angle) * v]

    d = math.copysign(1.0, v or rate(t, np.zeros(2), 0.0)[1])
    s = d if d * z >= o.Z_m else 0.0
    z = s * o.Z_m if s else z

    def turn(t, q, s):
        return d * q[1]

    def onset(t, q, s):
        return -1.0 if s else d * (z + q[0]) - o.Z_m

    turn.terminal, turn.direction = True, -1.0
    onset.terminal, onset.direction = True, 1.0
    fastest = max(motion.omega, math.sqrt((o.k + o.K_z * (s == 0.0)) / o.m), o.c / o.m)
    scale = max(o.Z_m, motion.Y * 1e-3)
    found = solve_ivp(
        rate,
        (t, end),
        [0.0, v, 0.0, 0.0, 0.0],
        method="DOP853",
        rtol=_RTOL,
        atol=1e-15 * np.array([scale, scale * fastest, scale, scale**2, scale**2 * o.k]),
        max_step=step / fastest,
        events=(turn, onset),
        dense_output=dense,
        args=(s,),
    )
    assert found.success, found.message
    turned, slipped = (times.size > 0 for times in found.t_events)
    u, last = found.y[:2, -1]
    reached = d * o.Z_m if slipped else z + u * (s == 0.0)
    return Phase(t, s, x, v, z, (x + u, 0.0 if turned else last, reached), found)


def phases(
    oscillator, motion, end, x=0.0, v=0.0, z=0.0, theta=0.0, law=None, step=_STEP, dense=False
):
    """The phases of the motion from (x, ẋ, z) over [0, end] with y = Y cos(θ + ωt); a turn in stick begins one, too.

    law : symbol → coefficient of terms besides friction and c.   step : longest step, rad of the fastest oscillation;
    an excursion shorter than a step may be missed.   dense : whether states between the steps are wanted.
    """
    t = 0.0
    while end - t > 1e-12 * end:
        phase = _phase(oscillator, motion, t, end, x, v, z, theta, law or {}, step, dense)
        yield phase
        t, (x, v, z) = phase.found.t[-1], phase.end


@dataclass
class Motion:
    """Motion over [0, end]: state at the end, integrals over the span, and the events met on the way.

    events : (t, s, x, v) at the start of each phase but the first in another state than the one before.
    """

    x: float
    v: float
    z: float
    a: float
    b: float
    W: float
    peak: float
    events: list[tuple[float, float, float, float]]


def integrate(*given, **options):
    """Follow the oscillator; arguments as for `phases`."""
    rows = [*phases(*given, **options)]
    sums = np.sum([row.found.y[2:, -1] for row in rows], axis=0)
    peak = max(np.abs(row.x + row.found.y[0]).max() for row in rows)
    changes = itertools.pairwise(rows)
    events = [(b.t, b.s, b.x, b.v) for a, b in changes if b.s != a.s]
    return Motion(*rows[-1].end, *sums, peak, events)
