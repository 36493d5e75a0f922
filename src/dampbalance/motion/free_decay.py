"""Free decays with their exact derivatives by the oscillator and the start state, and the products of these.

The base is at rest. Within a phase u = x − x(0) follows u = v₀ S + f₀ J with the step response J and the impulse
response S = J̇ of `flow`, which depend on δ = c/(2m) and Ω² = κ/m; their derivatives are closed forms as well. From one
phase to the next the derivatives of x and ẋ at a fixed time are continuous, since the force of the contact is; where
the mass turns, that of the contact spring becomes ±∂(F_k/K_z).

A fit needs JᵀJ, Jᵀr and rᵀr alone, r = (model − sample)/σ: the products of the samples' derivatives and residuals.
Samples are evenly spaced, and e^{−δt} cos and sin are advanced from one to the next by a rotation.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..model import Parameters
from .events import read_phase, run
from .flow import Phase, phase_start, step_response
from .jit import jit
from .unknowns import F_K, OSCILLATOR_UNKNOWNS, RHO, C, M

DECAY_UNKNOWNS = (*OSCILLATOR_UNKNOWNS, "x", "v", "w")
"""The unknowns by which derivatives are taken: those of the oscillator, and the start state,
z = (w − 1) F_k/K_z with the preload w of the contact spring."""

COMMON_UNKNOWNS, STATE_UNKNOWNS = 4, 3
"""How many of these belong to the oscillator, and to the start state."""

_X, _V, _PRELOAD = range(4, 7)
_CRITICAL_BELOW = 0.05  # of |Ω² − δ²| t²: four terms of the series in it are then exact to 1e-11

MOST_PHASES = 4096
"""Phases after which a motion is rejected."""

DECAY, ORDER, OFFSET, FIRST, SAMPLING_STEP, NOISE, BEGIN, END, UNTIL, FRICTION_NUMBER = range(10)
"""Columns of the table of channels: number of the decay, order of the derivative, number of the offset, time of the
first sample after the start of the decay, s, interval, s, standard deviation of the noise, the samples' places, time of
the last sample of the decay in any channel, s, and place of the decay's friction force in the point."""

_UNDER = 0.999  # of the critical damping: below it the responses are advanced by a rotation
_CHORD = 3e-2  # of ρ√k, K_z = 1100 k


@jit
def contact_chord(rho: float, k: float) -> float:
    """The step in ρ over which its derivative is taken; 0 where that is the derivative itself.

    Close to a rigid contact the motion depends on K_z^{−1} = ρ², and a chord replaces the slope, which vanishes.
    """
    chord = _CHORD / math.sqrt(k)
    return chord if rho < 0.3 * chord else 0.0


@jit
def _weights(
    t: float, order: int, response: tuple[float, float, float, float], phase: Phase
) -> tuple[float, float, float, float, float]:
    """At time t of a phase, u, ẋ or ẍ (order 0, 1, 2), and its derivatives by ẋ(0), f₀, δ and Ω².

    response : J, S, R and ∂S/∂Ω².
    """
    (J, S, R, S_O), (v0, f0, _, delta, Omega2, _) = response, phase
    S_d = -t * S - 2.0 * delta * S_O
    J_O = (0.5 * t * S - delta * S_O - J) / Omega2
    J_d = (t * R - S - delta * S_d) / Omega2
    u, u_d, u_O = v0 * S + f0 * J, v0 * S_d + f0 * J_d, v0 * S_O + f0 * J_O
    if order == 0:
        return u, S, J, u_d, u_O
    R_O = -2.0 * delta * S_O - J - Omega2 * J_O
    R_d = -2.0 * (S + delta * S_d) - Omega2 * J_d
    v, v_d, v_O = v0 * R + f0 * S, v0 * R_d + f0 * S_d, v0 * R_O + f0 * S_O
    if order == 1:
        return v, R, S, v_d, v_O
    return (
        f0 - 2.0 * delta * v - Omega2 * u,
        -2.0 * delta * R - Omega2 * S,
        R,
        -2.0 * (v + delta * v_d) - Omega2 * u_d,
        -u - 2.0 * delta * v_O - Omega2 * u_O,
    )


@jit
def _response(t: float, phase: Phase) -> tuple[float, float, float, float]:
    """J, S, R and ∂S/∂Ω² at time t ≥ 0 of a phase."""
    delta, Omega2 = phase.delta, phase.Omega2
    J, S, R = step_response(t, delta, Omega2)
    q = Omega2 - delta * delta
    z = q * t * t
    if abs(z) < _CRITICAL_BELOW:
        series = -1.0 / 6.0 + z * (1.0 / 60.0 - z * (1.0 / 1680.0 - z / 90720.0))
        return J, S, R, math.exp(-delta * t) * t**3 * series
    return J, S, R, (t * (R + delta * S) - S) / (2.0 * q)


@jit
def phase_slopes(phases: Array, w: float, par: Parameters) -> Array:
    """Derivatives of the start of each phase by `DECAY_UNKNOWNS`, shape (phases, 5, 7): of x, ẋ, f₀, δ and Ω².

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
        phase = phase_start(s, x0, v0, z0, 1.0 + 0.0j, par)
        _, f0, _, delta, Omega2, _ = phase
        here[2] = -par.k / m * here[0]
        here[3, C], here[3, M] = 0.5 / m, -delta / m
        here[4, M] = -Omega2 / m
        here[2, M] -= f0 / m
        if s == 0.0:  # the force of the contact at the start is that of the turn before, side F_k
            here[2, F_K] -= side / m
            here[2, _PRELOAD] -= K_z * by_w / m
            here[4, RHO] = by_rho / m
        else:
            here[2, F_K] -= s / m
        if i + 1 == phases.shape[0]:
            break
        t = phases[i + 1, 0] - phases[i, 0]
        for order in range(2):
            _, v, f, d, O = _weights(t, order, _response(t, phase), phase)
            slopes[i + 1, order] = v * here[1] + f * here[2] + d * here[3] + O * here[4]
        slopes[i + 1, 0] += here[0]
        _, s, x0, v0, z0 = read_phase(phases, i + 1)
        side, by_w = 1.0 if z0 > 0.0 else -1.0, 0.0
    return slopes


@jit
def decay_samples(
    grid: tuple[float, float, int], order: int, phases: Array, slopes: Array, par: Parameters
) -> Array:
    """x, ẋ or ẍ (order 0, 1, 2) of a free decay at even times, derivatives by `DECAY_UNKNOWNS`, and 1, shape (n, 9).

    grid : time of the first sample, s, interval, s, and number of samples.   slopes : of `phase_slopes`.
    Use it where residuals of samples and their derivatives are needed together; values alone come from
    `states_in_phases`.
    """
    first, step, count = grid
    out = np.ones((count, 9))
    n = 0
    for i in range(phases.shape[0]):
        begin, s, x0, v0, z0 = read_phase(phases, i)
        stop = count
        if i + 1 < phases.shape[0]:
            stop = min(max(math.ceil((phases[i + 1, 0] - first) / step), n), count)
        phase = phase_start(s, x0, v0, z0, 1.0 + 0.0j, par)
        delta, Omega2 = phase.delta, phase.Omega2
        t = first + n * step - begin
        under = delta < _UNDER * math.sqrt(Omega2)
        w = math.sqrt(Omega2 - delta * delta) if under else 1.0
        decay = math.exp(-delta * t)
        cosine, sine = decay * math.cos(w * t), decay * math.sin(w * t)
        decay = math.exp(-delta * step)
        turn_c, turn_s = decay * math.cos(w * step), decay * math.sin(w * step)
        here, moved = slopes[i], 1.0 if order == 0 else 0.0
        while n < stop:
            if under:
                S = sine / w
                J, S_O = (1.0 - cosine - delta * S) / Omega2, (t * cosine - S) / (2.0 * w * w)
                response = (J, S, cosine - delta * S, S_O)
                cosine, sine = cosine * turn_c - sine * turn_s, cosine * turn_s + sine * turn_c
            else:
                response = _response(t, phase)
            value, v, f, d, O = _weights(t, order, response, phase)
            out[n, 0] = moved * x0 + value
            for j in range(7):
                by_start = v * here[1, j] + f * here[2, j] + moved * here[0, j]
                out[n, j + 1] = by_start + d * here[3, j] + O * here[4, j]
            t += step
            n += 1
    return out


@jit
def decay_products(
    point: Array, k: float, offsets: int, channels: Array, values: Array, rows: Array, out: Array
) -> bool:
    """Set out (p + 1, p + 1) to the products of the derivatives of all residuals (model − sample)/σ by unknowns and
    of the residuals: JᵀJ, Jᵀr and, in the last corner, χ². False where the contact rattles on.

    point : F_k, c, ρ, m, the offsets of the channels, further friction forces, and the start state x, ẋ, w of each
    decay.   offsets : number of offsets and further friction forces.   channels : table, decay by decay.   values :
    samples of all of them.
    rows : room for phases.
    """
    p, decay, state, count = point.size, -1, 0, 0
    out[:] = 0.0
    rho = point[RHO]
    par = Parameters(point[M], point[C], k, rho**-2, point[F_K], 0.0, 0.0)
    places = np.array([p, F_K, C, RHO, M, 0, 0, 0, 0])
    slopes = np.empty((0, 5, 7))
    stretch = 1.0 + 0.5 * contact_chord(rho, k) / rho
    for i in range(channels.shape[0]):
        channel = channels[i]
        begin, end, until = int(channel[BEGIN]), int(channel[END]), channel[UNTIL]
        if channel[DECAY] != decay:
            decay = int(channel[DECAY])
            state = COMMON_UNKNOWNS + offsets + STATE_UNKNOWNS * decay
            x, v, w = point[state], point[state + 1], point[state + 2]
            places[1] = int(channel[FRICTION_NUMBER])
            par = Parameters(point[M], point[C], k, rho**-2, point[places[1]], 0.0, 0.0)
            Z_m = par.F_k / par.K_z
            z = min(max((w - 1.0) * Z_m, -Z_m), Z_m)
            count, reached, _, _, _ = run(x, v, z, 0.0, until, 0.0, par, rows)
            if not reached >= until:
                return False
            slopes = phase_slopes(rows[:count], w, par)
        grid, order = (channel[FIRST], channel[SAMPLING_STEP], end - begin), int(channel[ORDER])
        block = decay_samples(grid, order, rows[:count], slopes, par)
        places[5:8] = np.arange(state, state + STATE_UNKNOWNS)
        places[8] = COMMON_UNKNOWNS + int(channel[OFFSET])
        block[:, 0] += point[places[8]] - values[begin:end]
        block[:, 1 + RHO] *= stretch
        own = block.T @ block
        for a in range(9):
            for b in range(9):
                out[places[a], places[b]] += own[a, b] / channel[NOISE] ** 2
    return math.isfinite(out.sum())
