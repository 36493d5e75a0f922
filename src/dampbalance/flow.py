"""The exact motion within one phase, slip or stick, where the oscillator is linear.

Between two events the mass obeys  m ẍ + c ẋ + κ x = g + Re[k Y e^{iω(t₀+t)}]  with κ = k in slip, k + K_z in stick,
and g constant. Everything is built on the step response J of the phase,

    J̈ + 2δ J̇ + Ω² J = 1,   J(0) = J̇(0) = 0,   δ = c/(2m),   Ω² = κ/m,

its derivative S = J̇ (the impulse response) and R = J̈ = 1 − 2δS − Ω²J. With u = x − x(0), v₀ = ẋ(0), f₀ the
constant part of the force per mass at u = 0, and B the complex amplitude of the steady forced response of the phase
at its start,

    u(t) = v₀ S + f₀ J + Re[B ((e^{iωt} − 1) + Ω²J − iωS)]
    u̇(t) = v₀ R + f₀ S + Re[B (iω (e^{iωt} − 1) + Ω²S + iω (2δS + Ω²J))]

Every term vanishes with t, so that the displacement of a short stick phase (micrometres) keeps its relative
accuracy beside a motion of millimetres. All kernels take and return scalars in SI units.

The state of the contact is a number s: +1 or −1 while it slips that way, 0 while it sticks.
"""

from __future__ import annotations

import math

from ._jit import jit
from .model import Parameters

_SERIES_BELOW = 0.02  # of (Ω + δ) t: nine terms of the Taylor series are then exact to rounding
_CRITICAL_BELOW = 1e-3  # of |δ² − Ω²| t²: four terms of the series in it are then exact to rounding


@jit
def step_response(t: float, delta: float, Omega2: float) -> tuple[float, float, float]:
    """Step response J, impulse response S = J̇ and R = J̈ of J̈ + 2δJ̇ + Ω²J = 1 at time t ≥ 0.

    Under-, critically and over-damped alike. t : s.   delta : 1/s, ≥ 0.   Omega2 : 1/s², > 0.
    """
    if (math.sqrt(Omega2) + delta) * t < _SERIES_BELOW:
        J, S = _step_response_series(t, delta, Omega2)
    else:
        one_minus_C, S = _decayed_pair(t, delta, Omega2)
        J = (one_minus_C - delta * S) / Omega2
    return J, S, 1.0 - 2.0 * delta * S - Omega2 * J


@jit
def _step_response_series(t: float, delta: float, Omega2: float) -> tuple[float, float]:
    """J and J̇ from the Taylor series, n(n−1) jₙ = −2δ (n−1) jₙ₋₁ − Ω² jₙ₋₂ after j₂ = ½."""
    before, term = 0.0, 0.5 * t * t
    J, S_t = term, 2.0 * term
    for n in range(3, 12):
        before, term = (
            term,
            (-2.0 * delta * t * (n - 1) * term - Omega2 * t * t * before) / (n * (n - 1)),
        )
        J += term
        S_t += n * term
    return J, (S_t / t if t > 0.0 else 0.0)


@jit
def _decayed_pair(t: float, delta: float, Omega2: float) -> tuple[float, float]:
    """1 − e^{−δt} cosh σt and e^{−δt} sinh(σt)/σ with σ² = δ² − Ω² of either sign, without cancellation or overflow."""
    z = (delta * delta - Omega2) * t * t
    if z < -_CRITICAL_BELOW:
        w = math.sqrt(-z)
        decay = math.expm1(-delta * t)
        sine, cosine = math.sin(0.5 * w), math.cos(0.5 * w)
        return -decay + (1.0 + decay) * 2.0 * sine * sine, (
            1.0 + decay
        ) * 2.0 * sine * cosine * t / w
    if z <= _CRITICAL_BELOW:
        decay = math.expm1(-delta * t)
        cosh_minus_1 = z / 2.0 * (1.0 + z / 12.0 * (1.0 + z / 30.0 * (1.0 + z / 56.0)))
        sinhc = 1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0 * (1.0 + z / 72.0)))
        return -decay - (1.0 + decay) * cosh_minus_1, (1.0 + decay) * sinhc * t
    sigma = math.sqrt(z) / t
    fast = delta + sigma
    slow = Omega2 / fast
    slow_decay, fast_decay = math.expm1(-slow * t), math.expm1(-fast * t)
    return -0.5 * (slow_decay + fast_decay), (slow_decay - fast_decay) / (2.0 * sigma)


@jit
def forced_amplitude(force: float, m: float, c: float, kappa: float, omega: float) -> complex:
    """Complex amplitude of the steady displacement of m ẍ + c ẋ + κ x = force · cos ωt:  force / (κ − mω² + icω), m."""
    return force / complex(kappa - m * omega * omega, c * omega)


@jit
def forced_start(
    t: float, omega: float, delta: float, Omega2: float, J: float, S: float
) -> tuple[complex, complex]:
    """What multiplies B in u(t) and u̇(t) above: the forced motion less the free one, together starting from rest."""
    half = math.sin(0.5 * omega * t)
    turn = complex(-2.0 * half * half, math.sin(omega * t))  # e^{iωt} − 1 without cancellation
    u = turn + complex(Omega2 * J, -omega * S)
    v = complex(0.0, omega) * turn + complex(Omega2 * S, omega * (2.0 * delta * S + Omega2 * J))
    return u, v


@jit
def move(
    t: float,
    v0: float,
    f0: float,
    B: complex,
    delta: float,
    Omega2: float,
    omega: float,
) -> tuple[float, float]:
    """Displacement gained u, m, and velocity, m/s, a time t after the start of a phase.

    v0 : initial velocity, m/s.   f0 : constant force per mass at the start, m/s².   B : forced amplitude times
    e^{iωt₀}, m.
    """
    J, S, R = step_response(t, delta, Omega2)
    u, v = forced_start(t, omega, delta, Omega2, J, S)
    return (
        v0 * S + f0 * J + B.real * u.real - B.imag * u.imag,
        v0 * R + f0 * S + B.real * v.real - B.imag * v.imag,
    )


@jit
def phase_start(
    s: float, x: float, z: float, theta: float, par: Parameters
) -> tuple[float, complex, float]:
    """(f₀, B, Ω²) of a phase that starts at displacement x and contact deflection z when the base is at phase θ.

    s : state of the contact.   x, z : m.   theta : rad, y = Y cos(θ + ωt) from the start of the phase on.
    """
    contact, kappa = (par.K_z * z, par.k + par.K_z) if s == 0.0 else (s * par.F_k, par.k)
    f0 = -(par.k * x + contact) / par.m
    forced = forced_amplitude(par.k * par.Y, par.m, par.c, kappa, par.omega)
    return f0, forced * complex(math.cos(theta), math.sin(theta)), kappa / par.m
