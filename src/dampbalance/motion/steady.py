"""The steady orbit of one oscillator, whatever its regime: the kernels behind `steady_orbit` and `steady_orbits`.

Tried in this order: no friction and no slip, where the oscillator is linear; one slip onset per half cycle, from
its scalar equation; anything else by Newton's method on the event-located half-period map. With c > 0 the steady
velocity is unique (see `dampbalance.motion.period_map`), so whichever answer is valid is the only one.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..jit import jit
from ..model import Parameters
from .events import MOST_RADIANS, PHASE_T, write_phase
from .one_slip import solve_one_slip
from .period_map import solve_general
from .regime import Regime

MAX_PHASES = 16384  # of a period; an orbit with more events is reported as not found
NO_CLOSED_FORM = 255
"""Regime that `solve_closed` returns for an orbit that `solve_otherwise` must find."""

_NOT_FOUND, _ONE_SLIP, _SEVERAL_SLIPS, _NO_SLIP, _NO_FRICTION = map(int, Regime)


def solve_steady(par: Parameters, most_radians: float = MOST_RADIANS) -> tuple[int, Array, float]:
    """Return (regime, phases, θ) of the steady orbit, no phases where none was found.

    phases : of its half cycle from the reversal at −X, rows (t, s, x, ẋ, z), see `dampbalance.motion.events.run`.
    θ : phase of the base at that reversal, rad.
    most_radians : of the fastest motion, that are followed in search of an orbit without a closed form.
    """
    phases = np.empty((2, 5))
    code, count, theta = solve_closed(par, phases)
    if code == NO_CLOSED_FORM:
        phases = np.empty((MAX_PHASES, 5))
        code, count, theta = solve_otherwise(par, phases, most_radians)
    return code, phases[:count].copy(), theta


@jit
def solve_closed(par: Parameters, phases: Array) -> tuple[int, int, float]:
    """Solve as `solve_steady` an orbit without slip, without friction or with one slip onset per half cycle; the regime
    is NO_CLOSED_FORM for any other. A kernel of its own: few need the other, which takes as long to compile."""
    Z_m = par.F_k / par.K_z
    if Z_m == 0.0:
        X, theta = _linear(par, par.k, 1.0, phases)
        return (_NO_FRICTION, 1, theta) if math.isfinite(X) else (_NOT_FOUND, 0, 0.0)
    X, theta = _linear(par, par.k + par.K_z, 0.0, phases)
    if Z_m >= X:
        return _NO_SLIP, 1, theta

    found, tau, X, theta, V_s = solve_one_slip(par)
    if found:
        write_phase(phases, 0, 0.0, 0.0, -X, 0.0, -Z_m)
        write_phase(phases, 1, tau, 1.0, -X + 2.0 * Z_m, V_s, Z_m)
        return _ONE_SLIP, 2, theta
    return NO_CLOSED_FORM, 0, 0.0


@jit
def solve_otherwise(par: Parameters, phases: Array, most_radians: float) -> tuple[int, int, float]:
    """Solve as `solve_steady` an orbit that slips, by its events."""
    found, count, theta = solve_general(par, phases, most_radians)
    if not found:
        return _NOT_FOUND, 0, 0.0
    half = math.pi / par.omega
    # part of half a period: a shorter last phase is the rounding of the half period
    while count > 1 and half - phases[count - 1, PHASE_T] < 1e-12 * half:
        count -= 1
    return (_ONE_SLIP if count == 2 else _SEVERAL_SLIPS), count, theta


@jit
def _linear(par: Parameters, kappa: float, s: float, phases: Array) -> tuple[float, float]:
    """Return (X, θ) of the orbit without events on stiffness κ, and its half cycle written to `phases`; X is infinite
    at the resonance of an undamped oscillator.

    X e^{−iφ} = kY / (κ − mω² + icω);  θ = φ − π is the phase of the base at the reversal at −X.
    """
    reactance, resistance = kappa - par.m * par.omega * par.omega, par.c * par.omega
    impedance = math.hypot(reactance, resistance)
    X = par.k * par.Y / impedance if impedance > 0.0 else math.inf
    write_phase(phases, 0, 0.0, s, -X, 0.0, 0.0 if s != 0.0 else -X)
    return X, math.atan2(resistance, reactance) + math.pi
