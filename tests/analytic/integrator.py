"""A stick/slip state machine on scipy's DOP853, independent of the package: README.md, section 3.

The state carries, besides displacement and velocity, the three integrals of the energy balance. Displacement is
integrated as the gain u = x − x₀ since the last event, so that the micrometres of a stick phase are resolved beside
millimetres of motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

_STEP = 0.25  # rad of the fastest oscillation: the dense output, which locates events, is then good to 1e-13
_RTOL = 1e-12


@dataclass
class Motion:
    """Motion over [0, end]: state at the end, integrals over the span, and the events met on the way.

    events : (t, s, x, v) at the start of each phase but the first; s = ±1 in slip, 0 in stick.
    """

    x: float
    v: float
    z: float
    a: float
    b: float
    W: float
    peak: float
    events: list[tuple[float, int, float, float]]


def integrate(oscillator, motion, end, x=0.0, v=0.0, z=0.0, theta=0.0, step=_STEP):
    """Follow the oscillator from (x, ẋ, z) over [0, end] with y = Y cos(θ + ωt).

    step : longest step, rad of the fastest oscillation; an excursion shorter than a step may be missed.
    """
    m, c, k = oscillator.m, oscillator.c, oscillator.k
    K_z, F_k, Z_m = oscillator.K_z, oscillator.F_k, oscillator.Z_m
    Y, omega = motion.Y, motion.omega
    sums = np.zeros(3)
    events, peak, t = [], abs(x), 0.0
    sticks = not (abs(z) >= Z_m and z * v > 0.0)
    s = 0 if sticks else int(math.copysign(1, z))
    while True:
        kappa, contact = (k + K_z, K_z * z) if s == 0 else (k, s * F_k)
        base = k * x + contact

        def rate(t, q, kappa=kappa, base=base, s=s):
            drive = k * Y * math.cos(theta + omega * t)
            v = q[1]
            acceleration = (drive - c * v - base - kappa * q[0]) / m
            return [v, acceleration, s * v, v * v, drive * v]

        if s == 0:
            conditions = [lambda t, q, z=z: z + q[0] - Z_m, lambda t, q, z=z: z + q[0] + Z_m]
            directions = [1.0, -1.0]
        else:
            conditions, directions = [lambda t, q: q[1]], [-float(s)]
        for condition, direction in zip(conditions, directions, strict=True):
            condition.terminal, condition.direction = True, direction
        fastest = max(omega, math.sqrt(kappa / m), c / m)
        scale = max(Z_m, motion.Y * 1e-3)
        result = solve_ivp(
            rate,
            (t, end),
            [0.0, v, 0.0, 0.0, 0.0],
            method="DOP853",
            rtol=_RTOL,
            atol=1e-15 * np.array([scale, scale * fastest, scale, scale**2, scale**2 * k]),
            max_step=step / fastest,
            events=conditions,
        )
        assert result.success, result.message
        u, v_end = result.y[0, -1], result.y[1, -1]
        sums += result.y[2:, -1]
        peak = max(peak, np.abs(x + result.y[0]).max())
        t, x, v = result.t[-1], x + u, v_end
        z = z + u if s == 0 else s * Z_m
        if result.status == 0 or end - t < 1e-12 * end:
            return Motion(x, v, z, *sums, peak, events)
        if s == 0:
            s = 1 if result.t_events[0].size else -1
            z = s * Z_m
        else:
            v, s = 0.0, 0
        events.append((t, s, x, v))
