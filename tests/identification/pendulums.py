"""Releases of a pendulum by SciPy's integrator, whose contact is a spring that slips, located by events."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class Release:
    """J θ̈ + c θ̇ + k sin θ + f = 0, or k θ of a spring, ḟ = K_z θ̇ within |f| ≤ T_k, from an angle A at rest on, the
    contact having slipped up to there."""

    A: float
    F_k: float = 0.002
    c: float = 2e-3
    k: float = 1.5
    m: float = 0.04
    K_z: float = 60.0
    spring: bool = False

    def angles(self, times: np.ndarray) -> np.ndarray:
        found, t, y, s = np.empty(times.size), 0.0, np.array([self.A, 0.0, self.F_k]), 0.0

        def rate(_: float, y: np.ndarray) -> list[float]:
            back = self.k * (y[0] if self.spring else math.sin(y[0]))
            stiffness = self.K_z if s == 0.0 and self.F_k > 0.0 else 0.0
            return [y[1], -(self.c * y[1] + back + y[2]) / self.m, stiffness * y[1]]

        def slips(_: float, y: np.ndarray) -> float:
            return abs(y[2]) - self.F_k if s == 0.0 else -s * y[1]

        slips.terminal, slips.direction = self.F_k > 0.0, 1.0
        some = {"events": slips, "dense_output": True, "max_step": 0.05}
        while t < times[-1]:
            part = solve_ivp(rate, (t, times[-1]), y, "DOP853", rtol=1e-11, atol=1e-14, **some)
            inside = (times > t) & (times <= part.t[-1])
            if inside.any():
                found[inside] = part.sol(times[inside])[0]
            t, y = part.t[-1], part.y[:, -1]
            y[1] *= s == 0.0
            s = math.copysign(1.0, y[2]) if s == 0.0 else 0.0
            y[2] = np.clip(y[2], -self.F_k, self.F_k)
        return found

    def record(self, seed: int) -> dict[str, np.ndarray]:
        """Return a record of the angle from before the release on, with noise of 1 mrad."""
        times = np.arange(1.0, 1500.0) / 60.0
        angles = np.append(np.full(40, self.A), self.angles(times))
        noise = 1e-3 * np.random.default_rng(seed).standard_normal(angles.size)
        return {"time_s": np.arange(angles.size) / 60.0, "angle_rad": angles + noise}
