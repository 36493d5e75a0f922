"""The steady orbit with one slip onset per half cycle, from a single scalar equation in the stick duration τ.

Time runs from the reversal at x = −X, where the contact spring is deflected by −Z_m and the base moves as
y = Re[p e^{iωt}], p = p₁ + i p₂ = Y e^{iθ}. The half cycle, of duration H = π/ω, is a stick phase of duration τ and
a slip phase of duration H − τ; the other half is its mirror image. For a given τ the flow is affine in q = (X, p₁,
p₂), so that

    x(τ) = −X + 2 Z_m,   x(H) = X,   ẋ(H) = 0          three linear equations, M q = r
    |p(τ)| = Y                                        one scalar equation in τ

log |p| is close to linear in log τ (|p| ~ τ⁻² for short sticks), which makes Newton's method converge in a few
steps. As the contact force is continuous at slip onset, moving τ changes only the first equation, which gives dq/dτ
from M at no cost.

The orbit exists where its velocity keeps its sign inside the half cycle: `velocity_keeps_sign` checks that.
"""

from __future__ import annotations

import math

from ..jit import jit
from ..model import Parameters
from .events import MOST_RADIANS
from .flow import Phase, harmonic_response, phase_start, step_response, unit


@jit
def solve_one_slip(par: Parameters) -> tuple[bool, float, float, float, float]:
    """Return (found, τ, X, θ, V_s) of the one-slip orbit; `found` is False where Newton finds no such orbit or it is
    not valid.

    τ : s.   X : m.   θ : phase of the base at the reversal at −X, rad.   V_s : velocity at slip onset, m/s.
    """
    half_cycle = math.pi / par.omega
    tau = _first_guess(par)
    if not 0.0 < tau < half_cycle:
        return False, 0.0, 0.0, 0.0, 0.0
    log_Y = math.log(par.Y)
    smallest = math.inf
    stalled = 0
    X = p1 = p2 = V_s = 0.0
    # 40 steps of Newton's method at most
    for _ in range(40):
        X, p1, p2, V_s, dp1, dp2 = _half_cycle(tau, par)
        p_squared = p1 * p1 + p2 * p2
        if not p_squared > 0.0:
            return False, 0.0, 0.0, 0.0, 0.0
        error = 0.5 * math.log(p_squared) - log_Y
        slope = tau * (p1 * dp1 + p2 * dp2) / p_squared
        # 4e-15 of log |p|/Y: a few units of rounding
        if abs(error) <= 4e-15:
            break
        stalled = stalled + 1 if abs(error) >= smallest else 0
        if stalled > 2 and smallest < 1e-12:  # rounding keeps it from going lower
            break
        smallest = min(smallest, abs(error))
        step = min(max(-error / slope, -1.0), 1.0) if slope < 0.0 else math.copysign(0.5, error)
        following = tau * math.exp(step)
        tau = following if following < half_cycle else 0.5 * (tau + half_cycle)
    else:
        return False, 0.0, 0.0, 0.0, 0.0
    theta = math.atan2(p2, p1)
    valid = par.F_k / par.K_z < X and V_s > 0.0 and _is_forward(tau, X, theta, V_s, par)
    return valid, tau, X, theta, V_s


@jit
def _first_guess(par: Parameters) -> float:
    """Return τ of a harmonic motion of amplitude X: 1 − cos ωτ = 2 Z_m/X, X from harmonic balance with a rigid Coulomb
    contact.

    (k − mω²)² X² + (cωX + 4F_k/π)² = (kY)²; where that has no solution, X of the linear oscillator that never slips.
    """
    m, c, k, K_z, F_k, Y, omega = par
    reactance, resistance, friction = k - m * omega * omega, c * omega, 4.0 * F_k / math.pi
    A = reactance * reactance + resistance * resistance
    B = resistance * friction
    C = friction * friction - k * k * Y * Y
    discriminant = B * B - A * C
    X = (-B + math.sqrt(discriminant)) / A if discriminant > 0.0 and A > 0.0 else 0.0
    inverse = math.hypot(reactance + K_z, resistance) / (k * Y)  # 1/X of one that never slips
    if X > 0.0:
        inverse = min(inverse, 1.0 / X)
    cosine = 1.0 - 2.0 * F_k / K_z * inverse
    return math.acos(max(cosine, -0.999)) / omega


@jit
def _half_cycle(tau: float, par: Parameters) -> tuple[float, float, float, float, float, float]:
    """Solve M q = r for a given τ: (X, p₁, p₂, V_s, dp₁/dτ, dp₂/dτ), all zero where M is singular."""
    m, c, k, K_z, F_k, _, omega = par
    delta = c / (2.0 * m)
    half_cycle = math.pi / omega
    travel = 2.0 * F_k / K_z
    drive = k / m  # harmonic force per mass of a base motion of unit amplitude

    # stick from rest at −X: u(τ) = 2 Z_m; the force at its start is kX + F_k
    Omega2 = (k + K_z) / m
    J, S, R = step_response(tau, delta, Omega2)
    P, P_rate = harmonic_response(tau, omega, delta, Omega2, J, S)
    gu, gv = drive * P, drive * P_rate
    m11, m12, m13, r1 = k * J / m, gu.real, -gu.imag, travel - F_k * J / m
    # V_s = v1 X + v2 p₁ + v3 p₂ + v0
    v1, v2, v3, v0 = k * S / m, gv.real, -gv.imag, F_k * S / m

    # slip from −X + 2 Z_m at V_s: x(H) = X, ẋ(H) = 0; the force at its start is k (X − 2 Z_m) − F_k
    Omega2 = k / m
    J, S, R = step_response(half_cycle - tau, delta, Omega2)
    P, P_rate = harmonic_response(half_cycle - tau, omega, delta, Omega2, J, S)
    turned = drive * unit(omega * tau)
    gu, gv = turned * P, turned * P_rate
    f0 = -(k * travel + F_k) / m
    m21, m22, m23 = v1 * S + k * J / m - 2.0, v2 * S + gu.real, v3 * S - gu.imag
    m31, m32, m33 = v1 * R + k * S / m, v2 * R + gv.real, v3 * R - gv.imag
    r2, r3 = -travel - v0 * S - f0 * J, -v0 * R - f0 * S

    c1, c2, c3 = m22 * m33 - m23 * m32, m13 * m32 - m12 * m33, m12 * m23 - m13 * m22
    det = m11 * c1 + m21 * c2 + m31 * c3
    if det == 0.0 or not math.isfinite(det):
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    b1, b2, b3 = m23 * m31 - m21 * m33, m11 * m33 - m13 * m31, m13 * m21 - m11 * m23
    a1, a2, a3 = m21 * m32 - m22 * m31, m12 * m31 - m11 * m32, m11 * m22 - m12 * m21
    X = (c1 * r1 + c2 * r2 + c3 * r3) / det
    p1 = (b1 * r1 + b2 * r2 + b3 * r3) / det
    p2 = (a1 * r1 + a2 * r2 + a3 * r3) / det
    V_s = v1 * X + v2 * p1 + v3 * p2 + v0

    # a later slip onset adds V_s dτ to x(τ) alone; through the slip phase, 1 − Ω²J and −Ω²S carry it to x(H) and ẋ(H)
    d2, d3 = 1.0 - Omega2 * J, -Omega2 * S
    dp1 = -V_s * (b1 - b2 * d2 - b3 * d3) / det
    dp2 = -V_s * (a1 - a2 * d2 - a3 * d3) / det
    return X, p1, p2, V_s, dp1, dp2


@jit
def _is_forward(tau: float, X: float, theta: float, V_s: float, par: Parameters) -> bool:
    """Return whether ẋ > 0 between the two ends of the half cycle of a solution."""
    omega, Z_m = par.omega, par.F_k / par.K_z
    stick = phase_start(0.0, -X, 0.0, -Z_m, unit(theta), par)
    if not velocity_keeps_sign(tau, stick, V_s):
        return False
    slip = phase_start(1.0, -X + 2.0 * Z_m, V_s, Z_m, unit(theta + omega * tau), par)
    return velocity_keeps_sign(math.pi / omega - tau, slip, omega * X)


@jit
def velocity_keeps_sign(duration: float, phase: Phase, scale: float) -> bool:
    """Return whether the velocity of a phase stays positive between its ends, of which either may be a rest.

    The phase is sampled at least 2.5 times per radian; between samples, the cubic through velocities and
    accelerations bounds it. A minimum above zero by less than 1e-6 of `scale` counts as a change of sign, which
    sends the case to the event-located simulation: the safe side.
    """
    v0, f0, A, delta, Omega2, omega = phase
    radians = duration * max(omega, math.sqrt(Omega2))
    if radians > MOST_RADIANS:  # nor does the simulation follow it
        return False
    n = max(6, math.ceil(2.5 * radians))
    h = duration / n
    J, S, R = step_response(h, delta, Omega2)
    P, P_rate = harmonic_response(h, omega, delta, Omega2, J, S)
    hold = 1.0 - Omega2 * J
    turn = unit(omega * h)
    u, v_before, a_before = 0.0, v0, f0 + A.real - 2.0 * delta * v0
    for i in range(1, n + 1):
        forced_u, forced_v = A * P, A * P_rate
        A *= turn
        u, v = (
            hold * u + S * v_before + f0 * J + forced_u.real,
            -Omega2 * S * u + R * v_before + f0 * S + forced_v.real,
        )
        a = f0 + A.real - 2.0 * delta * v - Omega2 * u
        if i < n and v <= 0.0:
            return False
        if a_before < 0.0 < a and _cubic_minimum(v_before, a_before, v, a, h) < 1e-6 * scale:
            return False
        v_before, a_before = v, a
    return True


@jit
def _cubic_minimum(f0: float, d0: float, f1: float, d1: float, h: float) -> float:
    """Return the minimum on [0, h] of the cubic with values f0, f1 and slopes d0 < 0 < d1 at its ends."""
    secant = (f1 - f0) / h
    A = 3.0 * (d0 + d1 - 2.0 * secant)  # slope of the cubic: d0 + B s + A s², s = t/h
    B = d1 - d0 - A
    s = -2.0 * d0 / (B + math.sqrt(max(B * B - 4.0 * A * d0, 0.0)))
    return f0 + h * s * (d0 + s * (B / 2.0 + s * A / 3.0))
