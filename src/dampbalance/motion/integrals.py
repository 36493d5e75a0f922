"""Features of an exact orbit: extremes, slip onset, energy terms and harmonics, phase by phase.

An orbit is given by the phases of its half cycle from the reversal at −X: rows (t, s, x, ẋ, z). Within a phase the
velocity is ẋ = Re[V e^{iψ}] + q̇(t), ψ = θ + ωt the phase of the base and q the free motion, q̈ + 2δq̇ + Ω²q = 0. Its
integrals are closed forms in the values of q and q̇ at the two ends,

    ∫ q̇ e^{iσt} dt = [e^{iσt} (iσ q̇ + Ω² q)] / (Ω² − σ² − 2iδσ),      ∫ q̇² dt = −[½ (q̇² + Ω² q²)] / 2δ,

so that under-, critically and over-damped phases need no separate treatment. Where digits would cancel (hardly any
damping, or a motion that is small beside its forced and free parts, as near resonance), Gauss's rule takes their place.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..jit import jit
from ..model import Parameters
from .events import PHASE_V, PHASE_X, PHASE_Z, locate, read_phase
from .flow import Phase, inverse, move, phase_start, unit

PANEL = 8.0
"""Radians of the fastest oscillation of an integrand: 12 Gauss points are then exact to rounding."""

GAUSS_NODES, GAUSS_WEIGHTS = (np.ascontiguousarray(a) for a in np.polynomial.legendre.leggauss(12))
"""Gauss's rule on [−1, 1]."""


class Measures(NamedTuple):
    """Exact features of an orbit; units and meaning as in `dampbalance.motion.orbit.Orbit`."""

    X: float
    X_s: float
    V_s: float
    t_s: float
    phi: float
    phi_zero_crossing: float
    a: float
    b: float
    W: float
    X_1: float
    phi_1: float
    X_3: float
    phi_3: float
    X_5: float
    phi_5: float


@jit
def measure(phases: Array, count: int, theta: float, par: Parameters) -> Measures:
    """Return features of the orbit whose half cycle from the reversal at −X has the given phases.

    phases : (≥ count, 5), rows (t, s, x, ẋ, z), SI.   theta : phase of the base at the reversal, rad.

    a = ∮ |ẋ| over the slip phases, b = ∮ ẋ² dt, W = ∮ k y ẋ dt, each over a whole cycle: Eqs. (5)–(7) of Liang &
    Feeny (2010). X_s, V_s, t_s belong to the first forward slip onset after the reversal, `phi_zero_crossing` to the
    first upward zero of x. The harmonics are those of the velocity over inω.
    """
    omega = par.omega
    half = math.pi / omega
    X = -phases[0, PHASE_X]
    X_s = V_s = t_s = t_zero = math.nan
    a = b = 0.0
    first = third = fifth = 0j  # ∫ ẋ e^{inψ} dt over the half cycle, ψ = θ + ωt
    start = turn = unit(theta)  # e^{iψ}
    for i in range(count):
        t, s, x, v, z = read_phase(phases, i)
        if i + 1 < count:
            t_end, _, x_end, v_end, z_end = read_phase(phases, i + 1)
            turn_end = unit(theta + omega * t_end)
        else:  # the mirror image of the beginning
            t_end, x_end = half, X
            v_end, z_end = -phases[0, PHASE_V], -phases[0, PHASE_Z]
            turn_end = -start
        if s > 0.0 and math.isnan(X_s):
            X_s, V_s, t_s = x, v, t
        if s != 0.0:
            a += 2.0 * abs(x_end - x)
        duration = t_end - t
        phase = phase_start(s, x, v, z, turn, par)
        if x < 0.0 <= x_end and math.isnan(t_zero):
            t_zero = t + locate(0, -x, 0.0, duration, 0.0, phase)
        # 1e-3 of 2δt
        undamped = 2.0 * phase.delta * duration < 1e-3
        forced = square = 0.0
        one = three = five = 0j
        if not undamped:
            gained = z_end - z if s == 0.0 else x_end - x  # z keeps the digits of a short stick
            ends, turns, drive = (gained, v_end), (turn, turn_end), par.k * par.Y / par.m
            forced, square, one, three, five = _by_ends(duration, phase, ends, turns, drive)
        # 1e-2 of ∫ ẋ² beside the same integral of the forced motion
        cancelled = square < 1e-2 * forced
        if undamped or (cancelled and phase.delta * phase.delta < phase.Omega2):
            square, one, three, five = _by_gauss(duration, phase, turn)
        b += 2.0 * square
        first += one
        third += three
        fifth += five
        turn = turn_end
    scale = complex(0.0, -2.0 / math.pi)  # 4/T over iω
    X_1, phi_1 = _amplitude_and_lag(scale * first.conjugate())
    X_3, phi_3 = _amplitude_and_lag(scale * third.conjugate() / 3.0)
    X_5, phi_5 = _amplitude_and_lag(scale * fifth.conjugate() / 5.0)
    phi, W = wrapped(theta + math.pi), 2.0 * par.k * par.Y * first.real
    crossing = wrapped(theta + omega * t_zero + 0.5 * math.pi)
    return Measures(X, X_s, V_s, t_s, phi, crossing, a, b, W, X_1, phi_1, X_3, phi_3, X_5, phi_5)


@jit
def write_measures(
    out: Array, i: int, phases: Array, count: int, theta: float, par: Parameters
) -> None:
    """Write column i of `out`: the measures of an orbit with `count` phases in its half cycle, NaN where there is
    none."""
    if count == 0:
        for row in range(len(out)):
            out[row, i] = np.nan
    else:
        for row, value in enumerate(measure(phases, count, theta, par)):
            out[row, i] = value


@jit
def _amplitude_and_lag(harmonic: complex) -> tuple[float, float]:
    """Return X_n and φ_n of X_n e^{−iφ_n}."""
    return abs(harmonic), -math.atan2(harmonic.imag, harmonic.real)


@jit
def _by_ends(
    duration: float,
    phase: Phase,
    end: tuple[float, float],
    turns: tuple[complex, complex],
    drive: float,
) -> tuple[float, float, complex, complex, complex]:
    """Return ∫ ẋ² dt of the forced motion and of the whole, and ∫ ẋ e^{inψ} dt, n = 1, 3, 5, over a phase, from the
    values at its ends.

    end : displacement gained, m, and ẋ, m/s, at the end.   turns : e^{iψ} at the start and end, ψ phase of the base.
    drive : kY/m, m/s².
    """
    v0, f0, _, delta, Omega2, omega = phase
    (u1, v1), (turn0, turn1) = end, turns
    over_D = inverse(Omega2 - omega * omega, 2.0 * delta * omega)
    B = complex(drive * over_D.real, drive * over_D.imag)  # forced motion Re[B e^{iψ}] about `rest`
    V = complex(-omega * B.imag, omega * B.real)
    rest = f0 / Omega2
    q0, w0 = -rest - (B * turn0).real, v0 - (V * turn0).real
    q1, w1 = u1 - rest - (B * turn1).real, v1 - (V * turn1).real

    square0, square1 = turn0 * turn0, turn1 * turn1
    cube0, cube1 = square0 * turn0, square1 * turn1
    second = _over_i(square1 - square0, 2.0 * omega)  # ∫ e^{2iψ} dt
    fourth = _over_i(square1 * square1 - square0 * square0, 4.0 * omega)
    sixth = _over_i(cube1 * cube1 - cube0 * cube0, 6.0 * omega)
    back = V.conjugate()
    ends = (q0, w0, q1, w1)
    free_1 = _free_integral(ends, turn0, turn1, omega, phase)
    free_3 = _free_integral(ends, cube0, cube1, 3.0 * omega, phase)
    free_5 = _free_integral(ends, cube0 * square0, cube1 * square1, 5.0 * omega, phase)

    free_square = (w0 * w0 - w1 * w1 + Omega2 * (q0 * q0 - q1 * q1)) / (4.0 * delta)
    speed_squared = V.real * V.real + V.imag * V.imag
    forced_square = 0.5 * (speed_squared * duration + (V * V * second).real)
    return (
        forced_square,
        free_square + 2.0 * (V * free_1).real + forced_square,
        free_1 + 0.5 * (V * second + back * duration),
        free_3 + 0.5 * (V * fourth + back * second),
        free_5 + 0.5 * (V * sixth + back * fourth),
    )


@jit
def _over_i(z: complex, rate: float) -> complex:
    """Return z / (i · rate)."""
    return complex(z.imag / rate, -z.real / rate)


@jit
def _free_integral(
    ends: tuple[float, float, float, float],
    turn0: complex,
    turn1: complex,
    sigma: float,
    phase: Phase,
) -> complex:
    """Return ∫ q̇ e^{iσt} dt over a phase, from q, q̇ and e^{iσt} at its start and end."""
    q0, w0, q1, w1 = ends
    delta, Omega2 = phase.delta, phase.Omega2
    difference = turn1 * complex(Omega2 * q1, sigma * w1) - turn0 * complex(Omega2 * q0, sigma * w0)
    return difference * inverse(Omega2 - sigma * sigma, -2.0 * delta * sigma)


@jit
def _by_gauss(
    duration: float, phase: Phase, start: complex
) -> tuple[float, complex, complex, complex]:
    """Return the integrals of `_by_ends`, except that of the forced motion, by Gauss's rule; not for over-damped
    phases.

    start : e^{iψ} at the start.
    """
    omega = phase.omega
    panels = 1 + int(duration * (2.0 * math.sqrt(phase.Omega2) + 6.0 * omega) / PANEL)
    h = duration / panels
    square = 0.0
    one = three = five = 0j
    for i in range(panels):
        for node, weight in zip(GAUSS_NODES, GAUSS_WEIGHTS):  # noqa: B905 (no strict= in compiled code)
            t = h * (i + 0.5 + 0.5 * node)
            _, v = move(t, phase)
            turn = start * unit(omega * t)
            turn2 = turn * turn
            weighted = 0.5 * h * weight * v
            square += weighted * v
            one += weighted * turn
            three += weighted * turn * turn2
            five += weighted * turn * turn2 * turn2
    return square, one, three, five


@jit
def wrapped(angle: float) -> float:
    """Return the angle plus a multiple of 2π, in [−π/2, 3π/2)."""
    return (angle + 0.5 * math.pi) % (2.0 * math.pi) - 0.5 * math.pi
