"""Fixed-step simulation, as one would have written it in 2010: stick or slip is decided at step ends.

While the contact sticks, and while it slips, the oscillator is linear, and every scheme is a linear map from one step
to the next,

    u' = A u + (0, p),   u = (x, v),   A = [[0, 1], [−K, −C]],

with C = c/m, K = k/m in slip and (k + K_z)/m in stick, p the force per mass. After each step the contact is checked:

    slip   and v has changed sign     → stick from here on, X_t = x, the spring starting at ±Z_m        (3)
    stick  and |K_z z| > F_k          → slip from here on, in the direction of z                         (1)

An event is thus detected up to one step late, which makes the contact force wrong by O(h) for a time h: an error of
O(h²) in the motion, whatever the scheme. With stick and slip, Runge–Kutta 4 is therefore of second order, too, and its
error depends on where the samples fall.

Numerical dissipation. To first order in h a scheme solves, instead of the given problem, one with

    c → c + d m ω² h          d = +1 backward Euler, −1 explicit Euler, 0 otherwise

in steady motion at ω: backward Euler adds damping, explicit Euler takes it away. The three Euler schemes also return
the velocity of half a step earlier (backward, semi-implicit) or later (explicit), because they advance x by h v with
only one of the two velocities of a step. A velocity that is `lag` steps old is partly in phase with the forces of
spring and inertia, so that the balance of the samples, W = b c, shows c + m h [d ω² − lag (ω² − ω_n²)]: near resonance
again c + d m ω² h. `tests/replication/test_fixed_step.py` measures all of this, and the orders.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arguments import instance, number, one_of, whole
from ..arrays import Array
from ..jit import jit
from ..model import BaseMotion, Oscillator, Parameters, parameters
from .record import SimulatedRecord

MIN_STICK_SAMPLES = 20
"""Fewest samples of a stick phase that reaches from −Z_m to +Z_m.

x departs from the reversal as t², so the last of N steps stretches the spring by up to 2 Z_m (2N − 1)/N² ≈ 4 Z_m/N:
with 20 samples the force overshoots F_k by up to a fifth, for one step, and t_s is accurate to 5 %.
"""

MOST_STEPS = 100_000_000
"""Most steps of all levels at one frequency, which take seconds; the paper's case has 7 million at its lowest one."""

_MOST_SAMPLES = 5e7


class StepTooCoarse(ValueError):
    """The step is too long for the scheme or for the stick phases of the contact."""


@dataclass(frozen=True)
class Scheme:
    """A fixed-step scheme.

    code : its number in `one_step`.   dissipation : d above, of the damping c + d m ω² h that its steady motion has.
    """

    code: int
    dissipation: float = 0.0


_BACKWARD, _TRAPEZOIDAL, _SEMI_IMPLICIT, _RK4, _EXPLICIT = range(5)

SCHEMES: dict[str, Scheme] = {
    "backward-euler": Scheme(_BACKWARD, dissipation=+1.0),
    "trapezoidal": Scheme(_TRAPEZOIDAL),
    "semi-implicit-euler": Scheme(_SEMI_IMPLICIT),
    "rk4": Scheme(_RK4),
    "explicit-euler": Scheme(_EXPLICIT, dissipation=-1.0),
}


@jit
def one_step(
    code: int, u: tuple[float, float], p: tuple[float, float, float], C: float, K: float, h: float
) -> tuple[float, float]:
    """Return u = (x, v) after a step h of the scheme with this code, from u at its start.

    p : force per mass at the start, middle and end of the step, m/s².   C : 1/s.   K : 1/s².   h : s.
    """
    (x, v), (at_start, at_middle, at_end) = u, p
    if code == _RK4:
        v1, a1 = v, at_start - C * v - K * x
        v2, a2 = v + 0.5 * h * a1, at_middle - C * (v + 0.5 * h * a1) - K * (x + 0.5 * h * v1)
        v3, a3 = v + 0.5 * h * a2, at_middle - C * (v + 0.5 * h * a2) - K * (x + 0.5 * h * v2)
        v4, a4 = v + h * a3, at_end - C * (v + h * a3) - K * (x + h * v3)
        return (
            x + h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4),
            v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4),
        )
    acceleration = at_start - C * v - K * x
    if code == _SEMI_IMPLICIT:
        v += h * acceleration
        return x + h * v, v
    # u' − g (A u' + p') = u + (h − g) (A u + p), g the implicit part of the step
    implicit = h if code == _BACKWARD else 0.5 * h if code == _TRAPEZOIDAL else 0.0
    x += (h - implicit) * v
    v += (h - implicit) * acceleration
    v = (v + implicit * (at_end - K * x)) / (1.0 + implicit * C + implicit * implicit * K)
    return x + implicit * v, v


def simulate(
    osc: Oscillator,
    motion: BaseMotion,
    *,
    scheme: str = "backward-euler",
    step: float,
    cycles: float,
    keep_cycles: float,
    c_over_m: float | None = None,
    k_over_m: float | None = None,
    stick_samples: int = MIN_STICK_SAMPLES,
) -> SimulatedRecord:
    """Return the response from rest, computed by a fixed-step scheme: the samples of the last `keep_cycles` cycles.

    Use it to reproduce a published simulation with its numerical errors; `steady_orbit` gives the exact steady motion.
    At t = 0 the mass is at rest at x = 0, the contact relaxed and sticking, the base at its peak (y = Y cos ωt).
    Sample n is at t = n · step. The acceleration is that of Eqs. (1), (2) at the sample, with the law of the step that
    ended there: at the sample where slip is detected, the contact force is still K_z z, a little above F_k.

    osc, motion : the oscillator, and the motion of its base.
    scheme : a key of SCHEMES; backward Euler is the one behind the printed tables.
    step : s.
    cycles, keep_cycles : periods of the base motion, not necessarily whole.
    c_over_m, k_over_m : coefficients c/m (1/s) and k/m (1/s²) in place of the exact quotients, for an equation of
    motion that was divided by m and rounded; F_k/m, K_z/m and Z_m stay exact.
    stick_samples : fewest samples that a stick phase must have.

    Raises ValueError for an unknown scheme or a number outside its range, StepTooCoarse when the solution grows
    without bound or a stick phase has fewer than `stick_samples` samples.
    """
    one_of("scheme", scheme, SCHEMES)
    parameters(osc, instance("motion", motion, BaseMotion))
    if not number("step", step) < motion.period:
        raise ValueError(f"step must be below the period {motion.period:g} s, got {step!r} s")
    if not number("keep_cycles", keep_cycles) <= number("cycles", cycles):
        raise ValueError(
            f"keep_cycles must be no more than the cycles, {cycles!r}, got {keep_cycles!r}"
        )
    C = osc.c / osc.m if c_over_m is None else number("c_over_m", c_over_m)
    K = osc.k / osc.m if k_over_m is None else number("k_over_m", k_over_m)
    K_z, F = osc.K_z / osc.m, osc.F_k / osc.m
    unit_mass = Parameters(1.0, C, K, K_z, F, motion.Y, motion.omega)
    per_cycle = motion.period / step
    if cycles * per_cycle > _MOST_SAMPLES:
        raise ValueError(
            f"{cycles:g} cycles are {cycles * per_cycle:.2g} steps of {step:g} s, more than {_MOST_SAMPLES:g}: take "
            "fewer cycles or a longer step"
        )
    first, last = math.floor((cycles - keep_cycles) * per_cycle), math.ceil(cycles * per_cycle)
    signals = np.empty((4, last - first + 1))
    shortest = march(SCHEMES[scheme].code, unit_mass, step, first, signals)
    _, x, *_ = signals
    if not np.all(np.isfinite(x)) or np.max(np.abs(x)) > 1e6 * motion.Y:
        raise StepTooCoarse(
            f"{scheme} with a step of {step:g} s is unstable here: take a smaller step"
        )
    if shortest < whole("stick_samples", stick_samples):
        wanted = 0.9 * step * max(shortest, 1) / stick_samples
        raise StepTooCoarse(
            f"a step of {step:g} s leaves {shortest} samples in a stick phase, {stick_samples} are needed: "
            f"take a step of at most {wanted:.2g} s"
        )
    t: Array = step * np.arange(first, last + 1, dtype=np.float64)
    return SimulatedRecord(t, *signals)


def largest_growth(
    scheme: str, step: float, c_over_m: float, k_over_m: float, contact_over_m: float = 0.0
) -> float:
    """Return the factor by which a free oscillation grows in a step, the spectral radius of its map; 1 if it decays.

    step : s.   c_over_m : 1/s.   k_over_m, contact_over_m : k/m and, in stick, K_z/m, 1/s².
    """
    law = _linear_map(SCHEMES[scheme].code, c_over_m, k_over_m + contact_over_m, step)
    return max(1.0, float(np.max(np.abs(np.linalg.eigvals(law[:, :2])))))


@jit
def _linear_map(code: int, C: float, K: float, h: float) -> Array:
    """Return the (2, 5) matrix of one step, on (u, p): its columns are the steps of unit vectors."""
    law, unit = np.empty((2, 5)), np.zeros(5)
    for i in range(5):
        unit[:] = 0.0
        unit[i] = 1.0
        law[0, i], law[1, i] = one_step(
            code, (unit[0], unit[1]), (unit[2], unit[3], unit[4]), C, K, h
        )
    return law


class _Contact(NamedTuple):
    """The contact between two steps: whether it sticks, the direction of the last slip (0 before any), and where the
    last stick began: displacement X_t and deflection z_0, m."""

    sticks: bool
    direction: float
    X_t: float
    z_0: float


@jit
def _after(x: float, v: float, contact: _Contact, Z_m: float) -> _Contact:
    """Return the contact after a step that ended at x and v: sticking, slipping, or switched from one to the other."""
    sticks, direction, X_t, z_0 = contact
    z = z_0 + x - X_t
    if sticks and abs(z) > Z_m:
        return _Contact(False, 1.0 if z > 0.0 else -1.0, X_t, z_0)
    if not sticks and v * direction < 0.0:
        return _Contact(True, direction, x, direction * Z_m)
    return contact


@jit
def march(code: int, par: Parameters, h: float, first: int, out: Array) -> int:
    """Step an oscillator of unit mass from rest and return the number of samples of its shortest stick phase.

    A stick phase counts if it begins among the kept samples and ends with the spring stretched the other way. The
    number returned is MIN_STICK_SAMPLES at most.

    code : of the scheme.   h : step, s.   out (4, n) : receives y, x, ẋ, ẍ at the samples from `first` on.
    """
    Z_m, drive = par.F_k / par.K_z, par.k * par.Y
    slip = _linear_map(code, par.c, par.k, h)
    stick = _linear_map(code, par.c, par.k + par.K_z, h)
    uses_middle = code == _RK4
    x = v = p_middle = 0.0
    p_end = drive
    contact = _Contact(par.F_k > 0.0, 0.0, 0.0, 0.0)
    began, shortest = -1, MIN_STICK_SAMPLES
    if first == 0:
        out[0, 0], out[1, 0], out[2, 0], out[3, 0] = par.Y, x, v, drive
    for n in range(1, first + out.shape[1]):
        sticks, direction, X_t, z_0 = contact
        force = -par.K_z * (z_0 - X_t) if sticks else -direction * par.F_k
        turn = math.cos(par.omega * (n * h))
        p_start, p_end = p_end, drive * turn
        if uses_middle:
            p_middle = drive * math.cos(par.omega * ((n - 0.5) * h))
        q0, q1, q2 = p_start + force, p_middle + force, p_end + force
        m = stick if sticks else slip
        x, v = (
            m[0, 0] * x + m[0, 1] * v + m[0, 2] * q0 + m[0, 3] * q1 + m[0, 4] * q2,
            m[1, 0] * x + m[1, 1] * v + m[1, 2] * q0 + m[1, 3] * q1 + m[1, 4] * q2,
        )
        if n >= first:
            stiffness = par.k + par.K_z if sticks else par.k
            out[0, n - first], out[1, n - first], out[2, n - first] = par.Y * turn, x, v
            out[3, n - first] = q2 - par.c * v - stiffness * x
        contact = _after(x, v, contact, Z_m)
        if contact.sticks and not sticks:
            began = n
        elif sticks and not contact.sticks and began >= first and contact.direction == -direction:
            shortest = min(shortest, n - began)
    return shortest
