"""The steady orbit of any pattern of slips and sticks: Newton's method on the half-period map.

The equations keep their form under x → −x, t → t + T/2. Moreover the difference of any two motions under the same
excitation loses energy,

    d/dt [½ m Δẋ² + ½ k Δx² + ½ K_z Δz²] ≤ −c Δẋ²,

because slip, too, brings z₁ and z₂ together (the slider is monotone). With c > 0 the steady velocity is therefore
unique and attracts every motion; being unique it equals its own mirror image half a period later. So no steady
orbit of another symmetry exists, and the orbit is the fixed point of  s ↦ −Φ(s),  Φ the exact flow over half a
period; this map never expands, and Newton's method with the exact derivative of Φ finds its fixed point; where a
Newton step does not help, plain iteration moves on. (In full stick the position of the contact point stays
arbitrary: the fixed point is the orbit centred on zero.)
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..jit import jit
from ..model import Parameters
from .events import MOST_RADIANS, PHASE_S, PHASE_T, PHASE_X, run
from .flow import step_response


@jit
def half_period_map(
    x: float, v: float, z: float, theta: float, par: Parameters, phases: Array, jacobian: Array
) -> tuple[int, float, float, float]:
    """Return (number of phases, x, ẋ, z) after half a period; `jacobian` (3, 3) receives the derivative. The number is
    0 on overflow.

    The vector field is continuous across slip onset and reversal, so that perturbations pass events unchanged,
    except δz, which slip wipes out.
    """
    half = math.pi / par.omega
    count, t, x, v, z = run(x, v, z, 0.0, half, theta, par, phases)
    if t < half:
        return 0, x, v, z
    delta = par.c / (2.0 * par.m)
    for i in range(3):
        for j in range(3):
            jacobian[i, j] = 1.0 if i == j else 0.0
    for i in range(count):
        duration = (phases[i + 1, PHASE_T] if i + 1 < count else half) - phases[i, PHASE_T]
        sticks = phases[i, PHASE_S] == 0.0
        Omega2 = (par.k + par.K_z if sticks else par.k) / par.m
        J, S, R = step_response(duration, delta, Omega2)
        for j in range(3):
            dx, dv, dz = jacobian[0, j], jacobian[1, j], jacobian[2, j]
            offset = dz - dx if sticks else 0.0  # of the contact point: constant in stick
            pull = par.K_z / par.m * offset
            jacobian[0, j] = (1.0 - Omega2 * J) * dx + S * dv - J * pull
            jacobian[1, j] = -Omega2 * S * dx + R * dv - S * pull
            jacobian[2, j] = jacobian[0, j] + offset if sticks else 0.0
    return count, x, v, z


@jit
def _newton_step(D: Array, r0: float, r1: float, r2: float) -> tuple[float, float, float]:
    """Solve (1 + D) d = −r for the 3 × 3 derivative D of the half-period map, by Cramer's rule."""
    a, b, c = 1.0 + D[0, 0], D[0, 1], D[0, 2]
    d, e, f = D[1, 0], 1.0 + D[1, 1], D[1, 2]
    g, h, i = D[2, 0], D[2, 1], 1.0 + D[2, 2]
    A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
    det = a * A + b * B + c * C
    return (
        -(A * r0 + (c * h - b * i) * r1 + (b * f - c * e) * r2) / det,
        -(B * r0 + (a * i - c * g) * r1 + (c * d - a * f) * r2) / det,
        -(C * r0 + (b * g - a * h) * r1 + (a * e - b * d) * r2) / det,
    )


@jit
def _energy_norm(x: float, v: float, z: float, par: Parameters) -> float:
    return math.sqrt(par.k * x * x + par.m * v * v + par.K_z * z * z)


@jit
def solve_period_map(
    x: float,
    v: float,
    z: float,
    theta: float,
    par: Parameters,
    phases: Array,
    most_radians: float = MOST_RADIANS,
) -> tuple[bool, float, float, float]:
    """Return (found, x, ẋ, z): the state at base phase θ of the steady orbit, by Newton from the given state.

    phases : scratch rows for `events.run`; their number bounds the events in half a period.
    most_radians : of the fastest motion of the oscillator, that are followed in search of the state.
    """
    Z_m = par.F_k / par.K_z
    fastest = max(math.sqrt((par.k + par.K_z) / par.m), par.c / par.m, par.omega)
    # 4,000 half periods; Newton's method takes ten or so
    most = min(4e3, most_radians * par.omega / (math.pi * fastest))
    if most < 1.0:
        return False, x, v, z
    jacobian, trial_jacobian = np.empty((3, 3)), np.empty((3, 3))
    count, x1, v1, z1 = half_period_map(x, v, z, theta, par, phases, jacobian)
    residual = _energy_norm(x + x1, v + v1, z + z1, par)
    plain = 1  # plain iterations after the next Newton step that does not help
    used = 0
    while count > 0 and used < most:
        size = _energy_norm(x, v, z, par)
        # energy norm of s + Φ(s), relative to that of s
        if residual <= 1e-14 * size:
            return True, x, v, z
        dx, dv, dz = _newton_step(jacobian, x + x1, v + v1, z + z1)
        trial = (x + dx, v + dv, min(max(z + dz, -Z_m), Z_m))
        count, x2, v2, z2 = half_period_map(*trial, theta, par, phases, trial_jacobian)
        used += 1
        trial_residual = _energy_norm(trial[0] + x2, trial[1] + v2, trial[2] + z2, par)
        if count > 0 and trial_residual < 0.5 * residual:
            x, v, z = trial
            x1, v1, z1, residual = x2, v2, z2, trial_residual
            jacobian, trial_jacobian = trial_jacobian, jacobian
            continue
        if residual <= 1e-12 * size:  # rounding keeps it from going lower
            return True, x, v, z
        for _ in range(plain):
            x, v, z = -x1, -v1, -z1
            count, x1, v1, z1 = half_period_map(x, v, z, theta, par, phases, jacobian)
            used += 1
        residual = _energy_norm(x + x1, v + v1, z + z1, par)
        plain = min(2 * plain, 64)
    return False, x, v, z


@jit
def solve_general(par: Parameters, phases: Array, most_radians: float) -> tuple[bool, int, float]:
    """Return (found, number of phases, θ) of the steady orbit from its reversal at −X; `phases` receives half a cycle.

    θ : phase of the base at that reversal, rad. `found` is False, too, for an orbit that never slips.
    most_radians : as for `solve_period_map`.
    """
    half, Z_m = math.pi / par.omega, par.F_k / par.K_z
    found, x, v, z = solve_period_map(0.0, 0.0, 0.0, 0.0, par, phases, most_radians)
    if not found:
        return False, 0, 0.0
    # the extreme of x is where a slip phase ends; over a whole period both extremes occur
    count = run(x, v, z, 0.0, 2.0 * half, 0.0, par, phases)[0]
    peak, theta = 0.0, 0.0
    for i in range(1, count):
        if phases[i - 1, PHASE_S] != 0.0 and phases[i, PHASE_X] < peak:
            peak, theta = phases[i, PHASE_X], par.omega * phases[i, PHASE_T]
    if peak == 0.0:
        return False, 0, 0.0
    found, x, _, _ = solve_period_map(peak, 0.0, -Z_m, theta, par, phases, most_radians)
    count = run(x, 0.0, -Z_m, 0.0, half, theta, par, phases)[0]
    return found, count, theta
