"""Fixed-step simulation, as one would have written it in 2010: stick or slip is decided at step ends.

While the contact sticks or slips the oscillator is linear, so every scheme is a linear map from one step to the next,

    u' = A u + (0, p),   u = (x, v),   A = [[0, 1], [−K, −C]],

with C = c/m, K = k/m in slip and (k + K_z)/m in stick, p the force per mass. After each step the contact is looked at:

    slip   and v has changed sign     → stick from here on, X_t = x, the spring starting at ±Z_m        (3)
    stick  and |K_z z| > F_k          → slip from here on, in the direction of z                         (1)

An event is thus seen up to one step late, which makes the contact force wrong by O(h) for a time h: an error of O(h²)
in the motion, whatever the scheme. With stick and slip Runge–Kutta 4, too, is of second order, and its error depends on
where the sampling grid happens to fall.

Numerical dissipation. To first order in h a scheme solves, instead of the given problem, one with

    c → c + d m ω² h          d = +1 backward Euler, −1 explicit Euler, 0 otherwise

in steady motion at ω: backward Euler damps, explicit Euler feeds. The three Euler schemes also return the velocity of
half a step earlier (backward, semi-implicit) or later (explicit), because they advance x by h v with only one of the
two velocities of a step. The energy balance of their samples, W = b c, then shows c + `Scheme.balance_bias`: near
resonance the same d m ω² h. `tests/unit/motion/test_fixed_step.py` measures all of this, and the orders.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..model import BaseMotion, Oscillator
from ..record import Record
from .jit import jit

Step = Callable[[Array, Array, Array, float], Array]
"""One step (u, p, A, h) → u at its end; p : force per mass at its start, middle and end, m/s², shape (3,)."""

MIN_STICK_SAMPLES = 20
"""Fewest samples of a stick phase that reaches from −Z_m to +Z_m.

x leaves the reversal as t², so the last of N steps stretches the spring by up to 2 Z_m (2N − 1)/N² ≈ 4 Z_m/N: with 20
samples the force overshoots F_k by up to a fifth, for one step, and t_s is read to 5 %.
"""


class StepTooCoarse(ValueError):
    """The step is too long for the scheme or for the stick phases of the contact."""


@dataclass(frozen=True)
class Scheme:
    """A fixed-step scheme and what it does to a smooth solution.

    step : one step of it.   order : of its error at a fixed time, error ∝ h^order.
    dissipation : d above, the damping c + d m ω² h that its steady motion has.
    velocity_lag : how many steps the velocity it returns is older than the displacement.
    """

    step: Step
    order: int
    dissipation: float = 0.0
    velocity_lag: float = 0.0

    def balance_bias(self, osc: Oscillator, omega: float, h: float) -> float:
        """What W/b of the sampled x, v of a linear steady motion exceeds c by, N s/m, to first order in h.

        W/b = ∮ky v/∮v² = c + m h [d ω² − lag (ω² − ω_n²)]: damping of the scheme, and the part of the velocity that
        its lag turns into phase with the spring and inertia forces. omega : rad/s.   h : s.
        """
        lagging = self.velocity_lag * (omega**2 - osc.omega_n**2)
        return osc.m * h * (self.dissipation * omega**2 - lagging)


def _explicit_euler(u: Array, p: Array, A: Array, h: float) -> Array:
    return u + h * _rate(u, p[0], A)


def _semi_implicit_euler(u: Array, p: Array, A: Array, h: float) -> Array:
    v = u[1] + h * _rate(u, p[0], A)[1]
    return np.array([u[0] + h * v, v])


def _backward_euler(u: Array, p: Array, A: Array, h: float) -> Array:
    return _solved(np.eye(2) - h * A, u + h * np.array([0.0, p[2]]))


def _trapezoidal(u: Array, p: Array, A: Array, h: float) -> Array:
    right = u + 0.5 * h * (_rate(u, p[0], A) + np.array([0.0, p[2]]))
    return _solved(np.eye(2) - 0.5 * h * A, right)


def _runge_kutta_4(u: Array, p: Array, A: Array, h: float) -> Array:
    k1 = _rate(u, p[0], A)
    k2 = _rate(u + 0.5 * h * k1, p[1], A)
    k3 = _rate(u + 0.5 * h * k2, p[1], A)
    k4 = _rate(u + h * k3, p[2], A)
    return u + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def _solved(matrix: Array, right: Array) -> Array:
    return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)


def _rate(u: Array, p: float, A: Array) -> Array:
    rate: Array = A @ u + np.array([0.0, p])
    return rate


SCHEMES: dict[str, Scheme] = {
    "backward-euler": Scheme(_backward_euler, order=1, dissipation=+1.0, velocity_lag=+0.5),
    "trapezoidal": Scheme(_trapezoidal, order=2),
    "semi-implicit-euler": Scheme(_semi_implicit_euler, order=1, velocity_lag=+0.5),
    "rk4": Scheme(_runge_kutta_4, order=4),
    "explicit-euler": Scheme(_explicit_euler, order=1, dissipation=-1.0, velocity_lag=-0.5),
}


def simulate(
    osc: Oscillator,
    motion: BaseMotion,
    *,
    scheme: str = "backward-euler",
    step: float,
    cycles: float,
    keep_cycles: float,
    c_over_m: float | None = None,
    k_over_m: float | None = None,
) -> Record:
    """The response from rest, by a fixed-step scheme: t, y, x, v and acceleration of the last `keep_cycles` cycles.

    At t = 0 the mass is at rest at x = 0, the contact relaxed and sticking, the base at its peak (y = Y cos ωt).
    Sample n is at t = n · step. The acceleration is that of Eqs. (1), (2) at the sample, with the law of the step that
    ended there: at the sample where slip is seen the contact force still is K_z z, a little above F_k.

    scheme : a key of SCHEMES.   step : s.   cycles, keep_cycles : periods of the base motion, not necessarily whole.
    c_over_m, k_over_m : coefficients c/m (1/s) and k/m (1/s²) in place of the exact quotients, for an equation of
    motion that was divided by m and rounded; F_k/m, K_z/m and Z_m stay exact.

    Raises ValueError for an unknown scheme or a number outside its range, StepTooCoarse when the solution grows
    without bound or a stick phase has fewer than MIN_STICK_SAMPLES samples.
    """
    if scheme not in SCHEMES:
        raise ValueError(f"unknown scheme {scheme!r}; known are {', '.join(SCHEMES)}")
    if not 0.0 < step < motion.period:
        raise ValueError(
            f"step must be positive and below the period {motion.period:g} s, got {step!r} s"
        )
    if not 0.0 < keep_cycles <= cycles < math.inf:
        raise ValueError(
            f"need 0 < keep_cycles ≤ cycles, got keep_cycles {keep_cycles!r}, cycles {cycles!r}"
        )
    C = osc.c / osc.m if c_over_m is None else c_over_m
    K = osc.k / osc.m if k_over_m is None else k_over_m
    K_z, F = osc.K_z / osc.m, osc.F_k / osc.m

    per_cycle = motion.period / step
    first, last = math.floor((cycles - keep_cycles) * per_cycle), math.ceil(cycles * per_cycle)
    laws = [_linear_map(SCHEMES[scheme].step, C, stiffness, step) for stiffness in (K, K + K_z)]
    x, v, acceleration = (np.empty(last - first + 1) for _ in range(3))
    stick_samples = _march(
        np.stack([m for m, _ in laws]),
        np.stack([w for _, w in laws]),
        (C, K, K_z, F, K * motion.Y, motion.omega, step),
        (first, last),
        x,
        v,
        acceleration,
    )
    if not np.all(np.isfinite(x)) or np.max(np.abs(x)) > 1e6 * motion.Y:
        raise StepTooCoarse(
            f"{scheme} with a step of {step:g} s is unstable here: take a smaller step"
        )
    if 0 <= stick_samples < MIN_STICK_SAMPLES:
        wanted = 0.9 * step * max(stick_samples, 1) / MIN_STICK_SAMPLES
        raise StepTooCoarse(
            f"a step of {step:g} s leaves {stick_samples} samples in a stick phase, {MIN_STICK_SAMPLES} are needed: "
            f"take a step of at most {wanted:.2g} s"
        )
    t: Array = step * np.arange(first, last + 1, dtype=np.float64)
    return Record(t, motion.y(t), x, v, acceleration)


def _linear_map(step: Step, C: float, K: float, h: float) -> tuple[Array, Array]:
    """The (2, 2) matrix on u and (2, 3) weights on p of one step; their columns are the steps of unit vectors."""
    A = np.array([[0.0, 1.0], [-K, -C]])
    matrix = np.column_stack([step(u, np.zeros(3), A, h) for u in np.eye(2)])
    weights = np.column_stack([step(np.zeros(2), p, A, h) for p in np.eye(3)])
    return matrix, weights


@jit
def _march(
    matrices: Array,
    weights: Array,
    coefficients: tuple[float, float, float, float, float, float, float],
    kept: tuple[int, int],
    x_out: Array,
    v_out: Array,
    acceleration_out: Array,
) -> int:
    """Step from rest to sample kept[1] and write the samples from kept[0] on; return those of the shortest stick phase.

    matrices (2, 2, 2), weights (2, 2, 3) : of a step in slip [0] and in stick [1].   coefficients : c/m, k/m, K_z/m,
    F_k/m, kY/m, ω, h.   A stick phase counts when it begins among the kept samples and ends on the other side of the
    spring; −1 if there is none.
    """
    C, K, K_z, F, drive, omega, h = coefficients
    first, last = kept
    Z_m = F / K_z
    uses_middle = weights[0, 0, 1] != 0.0 or weights[0, 1, 1] != 0.0
    x = v = z_0 = X_t = 0.0
    direction = 0.0
    sticks = F > 0.0
    began, shortest = -1, -1
    p_end, p_middle = drive, 0.0
    if first == 0:
        x_out[0], v_out[0], acceleration_out[0] = x, v, drive
    for n in range(1, last + 1):
        law = 1 if sticks else 0
        contact = -K_z * (z_0 - X_t) if sticks else -direction * F
        p_start = p_end
        p_end = drive * math.cos(omega * (n * h))
        if uses_middle:
            p_middle = drive * math.cos(omega * ((n - 0.5) * h))
        m, w = matrices[law], weights[law]
        q0, q1, q2 = p_start + contact, p_middle + contact, p_end + contact
        x, v = (
            m[0, 0] * x + m[0, 1] * v + w[0, 0] * q0 + w[0, 1] * q1 + w[0, 2] * q2,
            m[1, 0] * x + m[1, 1] * v + w[1, 0] * q0 + w[1, 1] * q1 + w[1, 2] * q2,
        )
        if n >= first:
            i = n - first
            stiffness = K + K_z if sticks else K
            x_out[i], v_out[i] = x, v
            acceleration_out[i] = q2 - C * v - stiffness * x

        if F == 0.0:
            continue
        if sticks:
            z = z_0 + x - X_t
            if abs(z) > Z_m:
                if (
                    began >= first
                    and z * direction < 0.0
                    and (shortest < 0 or n - began < shortest)
                ):
                    shortest = n - began
                sticks = False
                direction = 1.0 if z > 0.0 else -1.0
        elif v * direction < 0.0:
            sticks, began = True, n
            X_t, z_0 = x, direction * Z_m
    return shortest
