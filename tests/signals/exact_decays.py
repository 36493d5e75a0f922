"""Free decays of a linear oscillator with Coulomb friction and no contact spring, exact in each half cycle."""

from __future__ import annotations

import math

import numpy as np


def decay(t, hertz, zeta, stick, order=0):
    """Displacement or acceleration after a release from 1 m: in each half cycle an exact one about ± stick, F_k/k."""
    omega, x, start = 2.0 * math.pi * hertz, 1.0, 0.0
    damped = omega * math.sqrt(1.0 - zeta**2)
    values = np.zeros((2, t.size))
    while abs(x) > stick and start < t[-1]:
        middle = math.copysign(stick, x)
        now = (t >= start) & (t < start + math.pi / damped)
        tau = t[now] - start
        fall, turn = (x - middle) * np.exp(-zeta * omega * tau), damped * tau
        y = fall * (np.cos(turn) + zeta * omega / damped * np.sin(turn))
        v = -fall * omega**2 / damped * np.sin(turn)
        values[:, now] = middle + y, -2.0 * zeta * omega * v - omega**2 * y
        x = 2.0 * middle - x * math.exp(-zeta * math.pi / math.sqrt(1.0 - zeta**2))
        x += middle * (math.exp(-zeta * math.pi / math.sqrt(1.0 - zeta**2)) - 1.0)
        start += math.pi / damped
    return values[order // 2]
