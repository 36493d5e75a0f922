"""What is read off an exact orbit: extremes, slip onset, energy terms and harmonics, in closed form phase by phase.

An orbit is given by the phases of its half cycle from the reversal at −X: rows (t, s, x, ẋ, z). Within a phase the
motion is x = x̄ + Re[B e^{iωt}] + q(t), q the free motion of the phase, q̈ + 2δq̇ + Ω²q = 0. Its integrals are
closed forms in the values of q and q̇ at the two ends,

    ∫ q e^{iσt} dt = [e^{iσt} ((2δ − iσ) q + q̇)] / (σ² − Ω² + 2iδσ),      ∫ q̇² dt = −[½ (q̇² + Ω² q²)] / 2δ,

so that under-, critically and over-damped phases need no separate treatment. (For 2δt < 1e-4 the last one loses
digits, and Gauss's rule on short panels takes its place.)
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import jit
from .flow import move, phase_start, step_response
from .model import Parameters

_UNDAMPED_BELOW = 1e-4
_GAUSS_NODES, _GAUSS_WEIGHTS = (
    np.ascontiguousarray(a) for a in np.polynomial.legendre.leggauss(12)
)


class Measures(NamedTuple):
    """Exact features of an orbit with slip; units as in `dampbalance.model`, harmonics as X_n e^{−iφ_n} in m."""

    X: float
    X_s: float
    V_s: float
    t_s: float
    a: float
    b: float
    W: float
    harmonic_1: complex
    harmonic_3: complex
    harmonic_5: complex


@jit
def measure(phases: NDArray[np.float64], count: int, theta: float, par: Parameters) -> Measures:
    """Features of the orbit whose half cycle from the reversal at −X has the given phases.

    phases : (≥ count, 5), rows (t, s, x, ẋ, z), SI.   theta : phase of the base at the reversal, rad.

    a = ∮ |ẋ| over the slip phases, b = ∮ ẋ² dt, W = ∮ k y ẋ dt, each over a whole cycle: Eqs. (5)–(7) of Liang &
    Feeny (2010). X_s, V_s, t_s belong to the first forward slip onset after the reversal.
    """
    omega, delta = par.omega, par.c / (2.0 * par.m)
    half = math.pi / omega
    X = -phases[0, 2]
    X_s = V_s = t_s = math.nan
    a = b = 0.0
    work = harmonic_1 = harmonic_3 = harmonic_5 = 0j
    for i in range(count):
        t, s, x, v, z = phases[i, 0], phases[i, 1], phases[i, 2], phases[i, 3], phases[i, 4]
        duration = (phases[i + 1, 0] if i + 1 < count else half) - t
        if s > 0.0 and math.isnan(X_s):
            X_s, V_s, t_s = x, v, t
        if s != 0.0:
            a += 2.0 * abs((phases[i + 1, 2] if i + 1 < count else X) - x)

        f0, B, Omega2 = phase_start(s, x, z, theta + omega * t, par)
        u_end, v_end = move(duration, v, f0, B, delta, Omega2, omega)
        start, turn = _unit(omega * t), _unit(omega * duration)
        forced_v = complex(0.0, omega) * B
        rest = f0 / Omega2
        q0, w0 = -rest - B.real, v - forced_v.real
        q1, w1 = u_end - rest - (B * turn).real, v_end - (forced_v * turn).real
        ends = (q0, w0, q1, w1)

        second = (turn * turn - 1.0) / complex(0.0, 2.0 * omega)  # ∫ e^{2iωt} dt
        free_v = (
            q1 * turn - q0 - complex(0.0, omega) * _free_integral(ends, turn, omega, delta, Omega2)
        )
        b += 2.0 * (
            _free_square(ends, delta, Omega2, duration)
            + 2.0 * (forced_v * free_v).real
            + 0.5 * (abs(forced_v) ** 2 * duration + (forced_v * forced_v * second).real)
        )
        work += start * (free_v + 0.5 * (forced_v * second + forced_v.conjugate() * duration))

        back, start_back = turn.conjugate(), start.conjugate()
        mean = x + rest
        third, third_start = back * back * back, start_back * start_back * start_back
        harmonic_1 += start_back * (
            mean * (back - 1.0) / complex(0.0, -omega)
            + 0.5 * (B * duration + (B * second).conjugate())
            + _free_integral(ends, back, -omega, delta, Omega2)
        )
        harmonic_3 += third_start * _odd_harmonic(
            3.0, ends, mean, B, back, third, delta, Omega2, omega
        )
        fifth, fifth_start = third * back * back, third_start * start_back * start_back
        harmonic_5 += fifth_start * _odd_harmonic(
            5.0, ends, mean, B, back, fifth, delta, Omega2, omega
        )
    W = 2.0 * par.k * par.Y * (_unit(theta) * work).real
    scale = 2.0 * omega / math.pi  # 4/T
    return Measures(
        X,
        X_s,
        V_s,
        t_s,
        a,
        b,
        W,
        scale * _unit(-theta) * harmonic_1,
        scale * _unit(-3.0 * theta) * harmonic_3,
        scale * _unit(-5.0 * theta) * harmonic_5,
    )


@jit
def _unit(angle: float) -> complex:
    return complex(math.cos(angle), math.sin(angle))


@jit
def _free_integral(
    ends: tuple[float, float, float, float],
    turn: complex,
    sigma: float,
    delta: float,
    Omega2: float,
) -> complex:
    """∫ q e^{iσt} dt over the phase, from q, q̇ at its start and end; turn = e^{iσ · duration}."""
    q0, w0, q1, w1 = ends
    factor = complex(2.0 * delta, -sigma)
    denominator = complex(sigma * sigma - Omega2, 2.0 * delta * sigma)
    return (turn * (factor * q1 + w1) - (factor * q0 + w0)) / denominator


@jit
def _odd_harmonic(
    n: float,
    ends: tuple[float, float, float, float],
    mean: float,
    B: complex,
    back: complex,
    turn: complex,
    delta: float,
    Omega2: float,
    omega: float,
) -> complex:
    """∫ x e^{−inωt} dt over the phase, n = 3, 5; back = e^{−iωD}, turn = e^{−inωD}, D the duration."""
    forced = B * (turn * back.conjugate() - 1.0) / complex(0.0, (1.0 - n) * omega)
    forced += B.conjugate() * (turn * back - 1.0) / complex(0.0, -(1.0 + n) * omega)
    constant = mean * (turn - 1.0) / complex(0.0, -n * omega)
    return constant + 0.5 * forced + _free_integral(ends, turn, -n * omega, delta, Omega2)


@jit
def _free_square(
    ends: tuple[float, float, float, float], delta: float, Omega2: float, duration: float
) -> float:
    """∫ q̇² dt over the phase."""
    q0, w0, q1, w1 = ends
    if 2.0 * delta * duration >= _UNDAMPED_BELOW:
        return (w0 * w0 - w1 * w1 + Omega2 * (q0 * q0 - q1 * q1)) / (4.0 * delta)
    panels = int(duration * math.sqrt(Omega2) / 2.0) + 1
    h = duration / panels
    total = 0.0
    for i in range(panels):
        for node, weight in zip(_GAUSS_NODES, _GAUSS_WEIGHTS):  # noqa: B905 (no strict= in compiled code)
            _, S, R = step_response(h * (i + 0.5 + 0.5 * node), delta, Omega2)
            w = R * w0 - Omega2 * S * q0
            total += 0.5 * h * weight * w * w
    return total


@jit
def wrapped(angle: float) -> float:
    """The angle plus a multiple of 2π, in [−π/2, 3π/2)."""
    return (angle + 0.5 * math.pi) % (2.0 * math.pi) - 0.5 * math.pi
