"""The friction force itself against the displacement, from records, and how it departs from the law.

    f = k(y − x) − mẍ − Σ p_j h_j(ẋ, ẏ)

of the mean cycle, from its harmonics. Each displacement transducer has an unknown zero, and so has f: it is chosen so
that friction does the same work in both directions. A true difference between them cannot be separated from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Mask
from ...law.terms import KNOWN_TERMS
from ...reading.mean_harmonics import Means, Reading

_POINTS = 4096  # of a cycle
AT_REST = 0.02
"""Share of the largest speed below which the mass counts as at rest: 31 harmonics do not resolve less."""

_SLIDING = 0.25  # of the largest speed: above it neither the onset nor the end of slip plays a part
# a pass takes a sixth of a second: slower ones are trends
_RIPPLES_HZ = np.linspace(8.0, 30.0, 221)


@dataclass(frozen=True, eq=False)
class Loop:
    """Displacement, velocity and friction force over the mean cycle at equal steps of phase; m, m/s, N, (p,).

    level : N, that was taken off the force.   omega : rad/s.   X : half the range of x, m.
    """

    omega: float
    x: Array
    v: Array
    force: Array
    level: float

    @property
    def X(self) -> float:
        """Half the way from the lowest to the highest point, m."""
        return 0.5 * float(np.ptp(self.x))

    @property
    def at_rest(self) -> Mask:
        """Where the mass stands."""
        return np.abs(self.v) < AT_REST * np.abs(self.v).max()

    @property
    def sliding(self) -> Mask:
        """Where it slides, well away from the ends of slip."""
        return np.abs(self.v) > _SLIDING * np.abs(self.v).max()


def friction_loop(
    reading: Reading, m: float, damping: Mapping[str, float], mean: Means | None = None
) -> Loop:
    """The loop of the mean cycle of a record.

    m : kg.   damping : coefficients of terms other than friction, SI.   mean : of some cycles; default, of all.
    """
    steady, mean = reading.steady, reading.mean if mean is None else mean
    odd, even = reading.series(mean)
    n = np.concatenate([odd.n, even.n])
    x_n = np.concatenate([odd.x[0], even.x[0]])
    y_n = np.concatenate([mean.Y, mean.base[0]])
    theta = np.linspace(0.0, 2.0 * math.pi, _POINTS, endpoint=False)
    x, v, acceleration = (_series(theta, n, x_n, steady.omega, order) for order in range(3))
    y, w = (_series(theta, np.arange(1.0, y_n.size + 1.0), y_n, steady.omega, i) for i in range(2))
    force = steady.k * (y - x) - m * acceleration
    force = force - viscous(damping, v, w, steady.k, steady.omega)
    level = float(np.sum(force * np.abs(v)) / np.sum(np.abs(v)))
    return Loop(steady.omega, x, v, force - level, level)


def viscous(
    damping: Mapping[str, float], v: Array, w: Array, k: float, omega: float
) -> Array | float:
    """Σ p_j h_j, N, of the velocities v of the mass and w of the base, m/s."""
    terms = ((p, KNOWN_TERMS[symbol].force) for symbol, p in damping.items())
    return sum(p * force(v, w, k, omega) for p, force in terms if force is not None)


def shape(loop: Loop, F_k: float) -> dict[str, float | list[float]]:
    """How the loop departs from that of a contact of constant friction force F_k, N.

    Where the mass slides, well away from its stops: `rms`, `highest` and `lowest` of |f|/F_k − 1, the first per length;
    `along` and `speed`, by how much it changes from one end to the other and from rest to the largest speed, by least
    squares; `ripple_hz`, the frequency that, next to a constant in each direction, explains most of it, with its
    amplitude `ripple` and the `explained` share of the mean square. `part_at_rest` of the cycle is spent at rest;
    `given_way_m`: by how far the mass moves there, at the lower and at the upper stop, while the force grows by 2F_k,
    by least squares; an elastic contact gives way by 2F_k/K_z.
    """
    slid = np.abs(loop.v)
    off = np.sign(loop.v) * loop.force / F_k - 1.0
    on = loop.sliding
    ends = np.column_stack([np.ones(on.sum()), loop.x[on] / loop.X, slid[on] / slid.max()])
    _, along, speed = np.linalg.lstsq(ends, off[on])[0]
    frequency, amplitude, explained = _ripple(loop, off)
    stops = [loop.at_rest & (sign * loop.x > 0.0) for sign in (-1.0, 1.0)]
    return {
        "rms": math.sqrt(float(np.sum(off[on] ** 2 * slid[on]) / np.sum(slid[on]))),
        "highest": float(off[on].max()),
        "lowest": float(off[on].min()),
        "along": 2.0 * float(along),
        "speed": float(speed),
        "ripple_hz": frequency,
        "ripple": amplitude,
        "explained": explained,
        "part_at_rest": float(np.mean(loop.at_rest)),
        "given_way_m": [
            2.0 * F_k * float(np.polynomial.polynomial.polyfit(loop.force[at], loop.x[at], 1)[1])
            for at in stops
        ],
    }


def _ripple(loop: Loop, off: Array) -> tuple[float, float, float]:
    """Frequency, Hz, amplitude and share of the mean square of the oscillation that explains `off` best in slip."""
    t = np.arange(loop.x.size) * (2.0 * math.pi / loop.omega / loop.x.size)
    best = (math.nan, 0.0, 0.0)
    passes = [loop.sliding & (sign * loop.v > 0.0) for sign in (1.0, -1.0)]
    total = math.fsum(float(np.sum((off[on] - off[on].mean()) ** 2)) for on in passes)
    for hz in _RIPPLES_HZ:
        left, square = 0.0, 0.0
        for on in passes:  # each with a separate phase
            angle = 2.0 * math.pi * hz * t[on]
            columns = np.column_stack([np.ones(angle.size), np.cos(angle), np.sin(angle)])
            fit = np.linalg.lstsq(columns, off[on])[0]
            left += float(np.sum((off[on] - columns @ fit) ** 2))
            square += float(fit[1] ** 2 + fit[2] ** 2)
        explained = 1.0 - left / total
        if explained > best[2]:
            best = (float(hz), math.sqrt(square / len(passes)), explained)
    return best


def _series(theta: Array, n: Array, x: Array, omega: float, order: int) -> Array:
    """The derivative of that order by time of Re Σ x_n e^{inθ}."""
    return (np.exp(1j * np.outer(theta, n)) @ ((1j * n * omega) ** order * x)).real
