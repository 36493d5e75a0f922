"""Free decays with their exact derivatives by the oscillator and the start state.

The base is at rest. Within a phase u = x − x(0) follows u = v₀ S + f₀ J with the step response J and the impulse
response S = J̇ of `flow`, which depend on δ = c/(2m) and Ω² = κ/m; their derivatives are closed forms as well. From one
phase to the next the derivatives of x and ẋ at a fixed time are continuous, since the force of the contact is; where
the mass turns, that of the contact spring becomes ±∂(F_k/K_z).
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..model import Parameters
from .events import read_phase
from .flow import step_response
from .jit import jit

UNKNOWNS = ("F_k", "c", "rho", "m", "x", "v", "w")
"""What derivatives are taken by: the oscillator, with ρ = K_z^{−1/2}, and the start state, z = (w − 1) F_k/K_z."""

COMMON_UNKNOWNS, STATE_UNKNOWNS = 4, 3
"""How many of these belong to the oscillator, and to the start state."""

_F_K, _C, _RHO, _M, _X, _V, _W = range(7)
_CRITICAL_BELOW = 0.05  # of |Ω² − δ²| t²: four terms of the series in it are then exact to 1e-11


@jit
def responses(t: float, delta: float, Omega2: float) -> tuple[float, ...]:
    """J, S, R and their derivatives by δ, then by Ω², at time t ≥ 0."""
    J, S, R = step_response(t, delta, Omega2)
    q = Omega2 - delta * delta
    e_cosine = R + delta * S  # e^{−δt} cos √q t
    z = q * t * t
    if abs(z) < _CRITICAL_BELOW:
        series = -1.0 / 6.0 + z * (1.0 / 60.0 - z * (1.0 / 1680.0 - z / 90720.0))
        S_O = math.exp(-delta * t) * t**3 * series
    else:
        S_O = (t * e_cosine - S) / (2.0 * q)
    S_d = -t * S - 2.0 * delta * S_O
    J_O = (0.5 * t * S - delta * S_O - J) / Omega2
    J_d = (t * e_cosine - delta * t * S - S - delta * S_d) / Omega2
    R_O = -2.0 * delta * S_O - J - Omega2 * J_O
    R_d = -2.0 * S - 2.0 * delta * S_d - Omega2 * J_d
    return J, S, R, J_d, S_d, R_d, J_O, S_O, R_O


@jit
def _weights(
    t: float, order: int, v0: float, f0: float, delta: float, Omega2: float
) -> tuple[float, float, float, float, float, float]:
    """At time t of a phase, u, ẋ or ẍ (order 0, 1, 2), and its derivatives by x(0), ẋ(0), f₀, δ and Ω²."""
    J, S, R, J_d, S_d, R_d, J_O, S_O, R_O = responses(t, delta, Omega2)
    u, u_d, u_O = v0 * S + f0 * J, v0 * S_d + f0 * J_d, v0 * S_O + f0 * J_O
    if order == 0:
        return u, 1.0, S, J, u_d, u_O
    v, v_d, v_O = v0 * R + f0 * S, v0 * R_d + f0 * S_d, v0 * R_O + f0 * S_O
    if order == 1:
        return v, 0.0, R, S, v_d, v_O
    return (
        f0 - 2.0 * delta * v - Omega2 * u,
        0.0,
        -2.0 * delta * R - Omega2 * S,
        R,
        -2.0 * (v + delta * v_d) - Omega2 * u_d,
        -u - 2.0 * delta * v_O - Omega2 * u_O,
    )


@jit
def phase_start_of(s: float, x0: float, z0: float, par: Parameters) -> tuple[float, float, float]:
    """f₀, δ and Ω² of a phase that starts at x0 with the contact spring at z0."""
    contact = par.K_z * z0 if s == 0.0 else s * par.F_k
    stiff = par.k + (par.K_z if s == 0.0 else 0.0)
    return -(par.k * x0 + contact) / par.m, par.c / (2.0 * par.m), stiff / par.m


@jit
def phase_slopes(phases: Array, w: float, par: Parameters) -> Array:
    """Derivatives of the start of each phase by `UNKNOWNS`, shape (phases, 5, 7): of x, ẋ, f₀, δ and Ω².

    phases : rows (t, s, x, ẋ, z) of a free decay, as `events.run` writes them.   w : of its start state.
    """
    slopes = np.zeros((phases.shape[0], 5, 7))
    m, K_z = par.m, par.K_z
    by_rho = -2.0 * K_z * math.sqrt(K_z)  # of K_z
    slopes[0, 0, _X] = slopes[0, 1, _V] = 1.0
    _, s, x0, v0, z0 = read_phase(phases, 0)
    side, by_w = w - 1.0, par.F_k / K_z  # z = side F_k/K_z
    for i in range(phases.shape[0]):
        here = slopes[i]
        f0, delta, Omega2 = phase_start_of(s, x0, z0, par)
        for j in range(7):
            here[2, j] = -par.k / m * here[0, j]
        here[3, _C], here[3, _M] = 0.5 / m, -delta / m
        here[4, _M] = -Omega2 / m
        here[2, _M] -= f0 / m
        if s == 0.0:  # the force of the contact at the start is that of the turn before, side F_k
            here[2, _F_K] -= side / m
            here[2, _W] -= K_z * by_w / m
            here[4, _RHO] = by_rho / m
        else:
            here[2, _F_K] -= s / m
        if i + 1 == phases.shape[0]:
            break
        t = phases[i + 1, 0] - phases[i, 0]
        for order in range(2):
            _, x, v, f, d, O = _weights(t, order, v0, f0, delta, Omega2)
            for j in range(7):
                slopes[i + 1, order, j] = (
                    x * here[0, j]
                    + v * here[1, j]
                    + f * here[2, j]
                    + d * here[3, j]
                    + O * here[4, j]
                )
        _, s, x0, v0, z0 = read_phase(phases, i + 1)
        side, by_w = 1.0 if z0 > 0.0 else -1.0, 0.0
    return slopes


@jit
def decay_samples(times: Array, order: int, phases: Array, slopes: Array, par: Parameters) -> Array:
    """x, ẋ or ẍ (order 0, 1, 2) of a free decay at ascending times, and its derivatives by `UNKNOWNS`, shape (n, 8).

    slopes : of `phase_slopes`.   Use it where residuals of samples and their derivatives are needed together; values
    alone come from `states_in_phases`.
    """
    out = np.empty((times.size, 8))
    i, stop = -1, -math.inf
    start = x0 = v0 = f0 = delta = Omega2 = 0.0
    for n in range(times.size):
        while times[n] >= stop:
            i += 1
            start, s, x0, v0, z0 = read_phase(phases, i)
            f0, delta, Omega2 = phase_start_of(s, x0, z0, par)
            stop = phases[i + 1, 0] if i + 1 < phases.shape[0] else math.inf
        value, x, v, f, d, O = _weights(times[n] - start, order, v0, f0, delta, Omega2)
        out[n, 0] = x0 + value if order == 0 else value
        here = slopes[i]
        for j in range(7):
            out[n, j + 1] = (
                x * here[0, j] + v * here[1, j] + f * here[2, j] + d * here[3, j] + O * here[4, j]
            )
    return out
