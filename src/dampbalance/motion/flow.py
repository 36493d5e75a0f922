"""The exact motion within one phase, slip or stick, where the oscillator is linear.

Between two events the mass obeys  m ẍ + c ẋ + κ x = g + Re[k Y e^{iω(t₀+t)}]  with κ = k in slip, k + K_z in stick,
and g constant. Everything is built on the step response J of the phase,

    J̈ + 2δ J̇ + Ω² J = 1,   J(0) = J̇(0) = 0,   δ = c/(2m),   Ω² = κ/m,

its derivative S = J̇ (the impulse response) and R = J̈ = 1 − 2δS − Ω²J, and on the response P to a unit harmonic force,

    P̈ + 2δ Ṗ + Ω² P = e^{iωt},   P(0) = Ṗ(0) = 0.

With u = x − x(0), v₀ = ẋ(0), f₀ the constant part of the force per mass at u = 0, and A = (kY/m) e^{iωt₀} the harmonic
part of it,

    u(t) = v₀ S + f₀ J + Re[A P],   u̇(t) = v₀ R + f₀ S + Re[A Ṗ]

Every term vanishes with t, so that the displacement of a short stick phase (micrometres) keeps its relative
accuracy beside a motion of millimetres; and none grows without bound at resonance. All kernels take and return
scalars in SI units.

The state of the contact is a number s: +1 or −1 while it slips that way, 0 while it sticks.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..jit import jit
from ..model import Parameters

_CRITICAL_BELOW = 1e-3  # of |δ² − Ω²| t²: four terms of the series in it are then exact to rounding


@jit
def unit(angle: float) -> complex:
    """Return e^{i angle}; angle : rad."""
    return complex(math.cos(angle), math.sin(angle))


@jit
def inverse(real: float, imaginary: float) -> complex:
    """Return 1/(real + i imaginary), without the scaling of a complex division: its square must not over- or
    underflow."""
    square = real * real + imaginary * imaginary
    return complex(real / square, -imaginary / square)


@jit
def step_response(t: float, delta: float, Omega2: float) -> tuple[float, float, float]:
    """Return the step response J, impulse response S = J̇ and R = J̈ of J̈ + 2δJ̇ + Ω²J = 1 at time t ≥ 0.

    Under-, critically and over-damped alike. t : s.   delta : 1/s, ≥ 0.   Omega2 : 1/s², > 0.
    """
    # 0.2 of (Ω + δ) t: twelve terms of the Taylor series are then exact to rounding
    if (math.sqrt(Omega2) + delta) * t < 0.2:
        J, S = _step_response_series(t, delta, Omega2)
    else:
        J, S = _step_response_closed(t, delta, Omega2)
    return J, S, 1.0 - 2.0 * delta * S - Omega2 * J


@jit
def _step_response_series(t: float, delta: float, Omega2: float) -> tuple[float, float]:
    """Return J and J̇ from the Taylor series, n(n−1) jₙ = −2δ (n−1) jₙ₋₁ − Ω² jₙ₋₂ after j₂ = ½."""
    before, term = 0.0, 0.5 * t * t
    J, S_t = term, 2.0 * term
    for n in range(3, 14):
        rest = -2.0 * delta * t * (n - 1) * term - Omega2 * t * t * before
        before, term = term, rest / (n * (n - 1))
        J += term
        S_t += n * term
    return J, (S_t / t if t > 0.0 else 0.0)


@jit
def _step_response_closed(t: float, delta: float, Omega2: float) -> tuple[float, float]:
    """Return J = (1 − e^{−δt} cosh σt − δJ̇)/Ω² and J̇ = e^{−δt} sinh(σt)/σ, σ² = δ² − Ω² of either sign, without
    overflow."""
    z = (delta * delta - Omega2) * t * t
    if z > _CRITICAL_BELOW:  # by the decay rates δ ± σ, whose product is Ω²
        sigma = math.sqrt(z) / t
        fast = delta + sigma
        slow = Omega2 / fast
        slow_decay, fast_decay = math.expm1(-slow * t), math.expm1(-fast * t)
        S = -(1.0 + slow_decay) * math.expm1(-2.0 * sigma * t) / (2.0 * sigma)
        if sigma > 0.5 * delta:
            return (fast_decay / fast - slow_decay / slow) / (2.0 * sigma), S
        return (-0.5 * (slow_decay + fast_decay) - delta * S) / Omega2, S
    decay = math.expm1(-delta * t)
    if z < -_CRITICAL_BELOW:
        w = math.sqrt(-z)
        sine, cosine = math.sin(0.5 * w), math.cos(0.5 * w)
        cosh_minus_1, sinhc = -2.0 * sine * sine, 2.0 * sine * cosine / w
    else:
        cosh_minus_1 = z / 2.0 * (1.0 + z / 12.0 * (1.0 + z / 30.0 * (1.0 + z / 56.0)))
        sinhc = 1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0 * (1.0 + z / 72.0)))
    S = (1.0 + decay) * sinhc * t
    return (-decay - (1.0 + decay) * cosh_minus_1 - delta * S) / Omega2, S


@jit
def harmonic_response(
    t: float, omega: float, delta: float, Omega2: float, J: float, S: float
) -> tuple[complex, complex]:
    """Return the response P to a unit harmonic force and its derivative Ṗ at time t ≥ 0; J, S from `step_response`.

    P = [(e^{iωt} − 1) + Ω²J − iωS] / D,  D = Ω² − ω² + 2iδω, unless that would cancel: D or t is small.
    """
    D = complex(Omega2 - omega * omega, 2.0 * delta * omega)
    D_squared = D.real * D.real + D.imag * D.imag
    # 0.1 of |Ω² − ω² + 2iδω| / (Ω² + ω²): more than a digit would cancel in P
    resonant = 0.1 * (Omega2 + omega * omega)
    if D_squared < resonant * resonant or D_squared * t * t < 0.01 * omega * omega:
        Omega = math.sqrt(Omega2)
        radians = (Omega + delta + omega) * t
        if radians < 1.0:  # the last term is below rounding
            last = 20 if radians > 0.1 else 12 if radians > 1e-3 else 7
            return _harmonic_response_series(t, last, omega, delta, Omega2)
        if delta < 0.5 * Omega:
            return _harmonic_response_resonant(t, omega, delta, Omega2)
    sine, cosine = math.sin(0.5 * omega * t), math.cos(0.5 * omega * t)
    turn = complex(-2.0 * sine * sine, 2.0 * sine * cosine)  # e^{iωt} − 1 without cancellation
    over_D = inverse(D.real, D.imag)
    P = complex(turn.real + Omega2 * J, turn.imag - omega * S) * over_D
    rate = complex(
        Omega2 * S - omega * turn.imag, omega * (turn.real + 2.0 * delta * S + Omega2 * J)
    )
    return P, rate * over_D


@jit
def _harmonic_response_series(
    t: float, last: int, omega: float, delta: float, Omega2: float
) -> tuple[complex, complex]:
    """Return P and Ṗ from the Taylor series, n(n−1) pₙ = (iω)ⁿ⁻²/(n−2)! − 2δ (n−1) pₙ₋₁ − Ω² pₙ₋₂ after p₂ = ½."""
    before, term = 0j, complex(0.5 * t * t, 0.0)
    force = complex(t * t, 0.0)
    P, P_t = term, 2.0 * term
    for n in range(3, last + 1):
        force *= complex(0.0, omega * t / (n - 2))
        rest = force - 2.0 * delta * t * (n - 1) * term - Omega2 * t * t * before
        before, term = term, rest / (n * (n - 1))
        P += term
        P_t += n * term
    return P, (P_t / t if t > 0.0 else 0j)


@jit
def _harmonic_response_resonant(
    t: float, omega: float, delta: float, Omega2: float
) -> tuple[complex, complex]:
    """Return P and Ṗ, under-damped, by the roots λ, λ̄ = −δ ± iσ:  P = (∫ e^{λ(t−s)+iωs} ds − ∫ e^{λ̄(t−s)+iωs} ds) /
    (2iσ).

    The first integral is t e^{λt} (e^w − 1)/w with w = (iω − λ) t, regular at resonance.
    """
    sigma = math.sqrt(Omega2 - delta * delta)
    decay, growth = math.exp(-delta * t), math.expm1(delta * t)
    detuning = (omega * omega - Omega2 + delta * delta) / (omega + sigma)  # ω − σ
    w = complex(delta * t, detuning * t)
    half, grown = math.sin(0.5 * w.imag), 1.0 + growth
    # e^w − 1
    w_minus_1 = complex(growth - grown * 2.0 * half * half, grown * math.sin(w.imag))
    turn = unit(sigma * t)
    near = t * decay * turn * (w_minus_1 / w if w != 0j else 1.0 + 0j)
    drive = unit(omega * t)
    far = (drive - decay * turn.conjugate()) / complex(delta, omega + sigma)
    root = complex(-delta, sigma)
    between = complex(0.0, 2.0 * sigma)
    return (near - far) / between, (root * near - root.conjugate() * far) / between


class Phase(NamedTuple):
    """Numbers that determine the motion within one phase.

    v0 : initial velocity, m/s.   f0, A : constant and harmonic force per mass at the start, m/s².
    delta : 1/s.   Omega2 : 1/s².   omega : rad/s.
    """

    v0: float
    f0: float
    A: complex
    delta: float
    Omega2: float
    omega: float


@jit
def phase_start(s: float, x: float, v: float, z: float, turn: complex, par: Parameters) -> Phase:
    """Return the phase that starts at (x, ẋ, z) with the contact in state s, when the base is at Re[Y turn].

    x, z : m.   v : m/s.   turn : e^{iθ}; y = Y cos(θ + ωt) from the start of the phase on.
    """
    contact, kappa = (par.K_z * z, par.k + par.K_z) if s == 0.0 else (s * par.F_k, par.k)
    f0 = -(par.k * x + contact) / par.m
    drive = par.k * par.Y / par.m
    A = complex(drive * turn.real, drive * turn.imag)
    return Phase(v, f0, A, par.c / (2.0 * par.m), kappa / par.m, par.omega)


@jit
def move(t: float, phase: Phase) -> tuple[float, float]:
    """Return the displacement gained u, m, and velocity, m/s, a time t after the start of a phase."""
    v0, f0, A, delta, Omega2, omega = phase
    J, S, R = step_response(t, delta, Omega2)
    if A == 0j:  # the base is at rest
        return v0 * S + f0 * J, v0 * R + f0 * S
    P, P_rate = harmonic_response(t, omega, delta, Omega2, J, S)
    return (
        v0 * S + f0 * J + A.real * P.real - A.imag * P.imag,
        v0 * R + f0 * S + A.real * P_rate.real - A.imag * P_rate.imag,
    )
