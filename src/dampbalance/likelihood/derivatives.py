"""The sampled steady response and its derivatives with respect to every possible unknown of a fit.

A record shows y = Y cos(ωt + ψ) and the steady response to it, x(t), and perhaps ẋ and ẍ. Unknown to all records are
(F_k, c, ρ), ρ = K_z^{−1/2}, and on request the mass m; each record adds (Y, ψ), and on request ω.

Why ρ: a stiff contact sticks for a time t_s ∝ K_z^{−1/2}, in which the contact force swings from −F_k to +F_k instead
of jumping. That takes away the impulse F_k t_s, so that x departs from the rigid limit in proportion to ρ (not to the
compliance ρ²). In ρ the rigid limit ρ = 0 is a regular point with information of its own; in K_z or log K_z it lies at
infinity, and in 1/K_z the derivative grows without bound.

Derivatives, for u any of x, ẋ, ẍ:

    F_k, c, ρ, m, ω   central differences of exact orbits, the last at equal phase ωt + ψ, plus t ∂u/∂ψ
    Y                 ∂u/∂Y = (u − F_k ∂u/∂F_k)/Y: the motion is homogeneous of degree one in (Y, F_k)
    ψ                 ∂u/∂ψ = u̇/ω, with m x⃛ = k ẏ − c ẍ − (k + K_z [stick]) ẋ

The step of the differences is 2e-5 of the parameter. In the paper's case their errors, relative to the rms of the
derivative, are 1e-9 (F_k), 1e-8 (c) and 1e-7 (ρ) for x and ẋ, rounding and truncation together. The jerk jumps at slip
onset: within 2e-5 of t_s from it, ∂ẍ is an average over the jump, which meets about one sample in 10⁴ cycles.
A relative error e of the derivatives moves the estimate by e of a standard error and the covariance by 2e.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..model import BaseMotion, Oscillator
from ..motion.orbit import Orbit, steady_orbit
from ..motion.states import State

CHANNELS = ("y", "x", "v", "acceleration")
"""Signals of a record, in the order of `Record.signals`."""

FREE = ("m", "omega")
"""What may be unknown on request: the mass, common to all records; the frequency, each record its own."""

_STEP = 2e-5
_STIFFEST = 1e12  # of K_z/k: the contact that stands for a rigid one


@dataclass(frozen=True, eq=False)
class Response:
    """Exact signals of one record and their derivatives.

    orbit : the steady orbit.   values : channel → (n,), SI.
    jacobian : channel → (p, n), rows F_k, c, ρ[, m], Y, ψ[, ω].
    """

    orbit: Orbit
    values: dict[str, Array]
    jacobian: dict[str, Array]


def compliance_root(K_z: float) -> float:
    """ρ = K_z^{−1/2}, (m/N)^{1/2}."""
    return 1.0 / math.sqrt(K_z)


def smallest_compliance_root(k: float) -> float:
    """The ρ that stands for a rigid contact: K_z = 10¹² k, which sticks for less than 10⁻⁶ of a cycle."""
    return compliance_root(_STIFFEST * k)


def response(
    osc: Oscillator,
    motion: BaseMotion,
    psi: float,
    tau: Array,
    channels: Sequence[str],
    free: Collection[str] = (),
) -> Response:
    """The steady response to y = Y cos(ωτ + ψ) at the times τ, and its derivatives.

    psi : rad.   tau : s, shape (n,); counted from the middle of the record it keeps ψ and ω apart.
    channels : of `CHANNELS`.   free : of `FREE`.   Raises NoSteadyOrbit.
    """
    phase = motion.omega * tau + psi
    orbit = steady_orbit(osc, motion)
    state = orbit.state(phase / motion.omega)
    by_F_k, *others = (
        _by_oscillator(osc, motion, name, phase)
        for name in ("F_k", "c", "rho", *(("m",) if "m" in free else ()))
    )
    by_psi = State(*(rate / motion.omega for rate in _rates(orbit, state, phase)))
    by_omega = _by_omega(osc, motion, phase) if "omega" in free else None

    values: dict[str, Array] = {}
    jacobian: dict[str, Array] = {}
    for name in channels:
        if name == "y":
            cosine, sine = np.cos(phase), np.sin(phase)
            values[name] = motion.Y * cosine
            rows = [np.zeros_like(cosine)] * (1 + len(others)) + [cosine, -motion.Y * sine]
            if by_omega is not None:
                rows.append(tau * rows[-1])
        else:
            u: Array = getattr(state, name)
            values[name] = u
            slope = getattr(by_F_k, name)
            rows = [slope, *(getattr(other, name) for other in others)]
            rows += [(u - osc.F_k * slope) / motion.Y, getattr(by_psi, name)]
            if by_omega is not None:
                rows.append(getattr(by_omega, name) + tau * rows[-1])
        jacobian[name] = np.array(rows)
    return Response(orbit, values, jacobian)


def _by_oscillator(osc: Oscillator, motion: BaseMotion, name: str, phase: Array) -> State:
    """∂(x, ẋ, ẍ, z) by one parameter of the oscillator: `_STEP` of it, or of what matters where it is close to zero."""
    if name == "rho":
        value, least = compliance_root(osc.K_z), smallest_compliance_root(osc.k)
        matters = 1e-3 / (motion.omega * math.sqrt(osc.m))  # sticks for about 1e-3 of a cycle
    else:
        value, least = getattr(osc, name), 0.0
        weights = {"F_k": 1e-3 * osc.k * motion.Y, "c": 2e-3 * math.sqrt(osc.k * osc.m), "m": osc.m}
        matters = weights[name]
    h = _STEP * max(value, matters)
    low = max(value - h, least)  # one-sided at the edge
    high = low + 2.0 * h
    times = phase / motion.omega
    at_low, at_high = (
        steady_orbit(with_parameter(osc, name, end), motion).state(times) for end in (low, high)
    )
    return _difference(at_low, at_high, high - low)


def with_parameter(osc: Oscillator, name: str, value: float) -> Oscillator:
    """The oscillator with one parameter replaced; "rho" sets K_z = ρ^{−2}."""
    return replace(osc, K_z=value**-2) if name == "rho" else replace(osc, **{name: value})


def _by_omega(osc: Oscillator, motion: BaseMotion, phase: Array) -> State:
    """∂(x, ẋ, ẍ, z)/∂ω at constant phase ωt + ψ."""
    h = _STEP * motion.omega
    low, high = motion.omega - h, motion.omega + h
    at_low, at_high = (
        steady_orbit(osc, BaseMotion(motion.Y, omega)).state(phase / omega) for omega in (low, high)
    )
    return _difference(at_low, at_high, high - low)


def _difference(low: State, high: State, width: float) -> State:
    return State(*((b - a) / width for a, b in zip(low, high, strict=True)))


def _rates(orbit: Orbit, state: State, phase: Array) -> State:
    """Time derivatives of (x, ẋ, ẍ, z)."""
    osc, motion = orbit.oscillator, orbit.motion
    sticks = np.abs(state.z) < osc.Z_m
    contact = np.where(sticks, osc.K_z * state.v, 0.0)
    drive = -osc.k * motion.Y * motion.omega * np.sin(phase)
    jerk = (drive - osc.c * state.acceleration - osc.k * state.v - contact) / osc.m
    return State(state.v, state.acceleration, jerk, np.where(sticks, state.v, 0.0))
