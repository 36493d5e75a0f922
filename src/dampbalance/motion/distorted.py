"""The exact steady motion under a base that moves at several harmonics, y = Re Σ y_n e^{inωt}, n = 1, 2, 3 …

Use it where the motion of a shaker is distorted and the distortion is measured. Within a phase the oscillator is
linear, so that the motion is the sum of the free motion and of the responses of `flow.py` to each harmonic. Even
harmonics break the symmetry of the half cycles: the steady motion is the fixed point of the flow over a whole period,
found by Newton's method from the motion under the fundamental alone. Events are bracketed by steps shorter than every
time scale of the phase, and located by false position; an excursion that begins and ends within one step is missed.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Complexes
from ..jit import jit
from ..model import Parameters, parameters
from .events import PHASE_V, PHASE_X, PHASE_Z, write_phase
from .flow import harmonic_response, step_response, unit
from .orbit import NoSteadyOrbit, Orbit
from .regime import Regime
from .steady_harmonics import stick_integrals

_MOST_STEPS = 100_000  # steps in a phase: a contact that takes more is as good as rigid


@jit
def _step(h: float, of_phase: tuple[float, float, float], count: int) -> Complexes:
    """Return what a step of length h adds to (displacement, velocity) by ẋ, by the constant force and by each harmonic
    of the drive, per mass, (2, 2 + count); the effect of a harmonic is the real part of its product with this."""
    delta, Omega2, omega = of_phase
    J, S, R = step_response(h, delta, Omega2)
    by = np.empty((2, 2 + count), dtype=np.complex128)
    by[0, 0], by[0, 1], by[1, 0], by[1, 1] = S, J, R, S
    for i in range(count):
        by[0, 2 + i], by[1, 2 + i] = harmonic_response(h, (i + 1) * omega, delta, Omega2, J, S)
    return by


@jit
def _after(here: tuple[float, float], by: Complexes, drive: Complexes) -> tuple[float, float]:
    """Return displacement and velocity after a step, from (ẋ, constant force per mass) at its start."""
    u = here[0] * by[0, 0].real + here[1] * by[0, 1].real
    v = here[0] * by[1, 0].real + here[1] * by[1, 1].real
    for i in range(drive.size):
        A, P, rate = drive[i], by[0, 2 + i], by[1, 2 + i]
        u += A.real * P.real - A.imag * P.imag
        v += A.real * rate.real - A.imag * rate.imag
    return u, v


@jit
def _motion(
    t: float, start: tuple[float, float], of_phase: tuple[float, float, float], drive: Complexes
) -> tuple[float, float]:
    """Return the displacement gained, m, and velocity, m/s, a time t after the start of a phase.

    start : ẋ, m/s, and constant force per mass, m/s², at the start.   of_phase : δ, Ω², ω.   drive : harmonic force per
    mass at the start, n = 1, 2, 3 …, m/s².
    """
    return _after(start, _step(t, of_phase, drive.size), drive)


@jit
def _crossing(
    level: tuple[float, float, float],
    end: tuple[float, float],
    here: tuple[float, float],
    of_phase: tuple[float, float, float],
    drive: Complexes,
    sticks: bool,
) -> float:
    """Return the time in a step at which the deflection, in stick, or the velocity, in slip, passes a level, by the
    rule of false position with Illinois weights.

    level : z at the start of the step, in stick, the sign of the level, and its size.   end : length of the step and
    how far beyond the level it ends.   Others are as for `_motion`.
    """
    z, side, size = level
    low, (high, at_high), kept, t = 0.0, end, 0, 0.0
    at_low = side * (z if sticks else here[0]) - size
    # 1e-14 relative to the change of an event's quantity in a step
    small = 1e-14 * (abs(at_high) + abs(at_low))
    if at_low >= 0.0:  # it begins at the level
        at_low = -at_high
    # trials for the time of an event; about eight are needed
    for _ in range(60):
        t = high - at_high * (high - low) / (at_high - at_low)
        gained, rate = _motion(t, here, of_phase, drive)
        off = side * (z + gained if sticks else rate) - size
        if abs(off) <= small:
            break
        # an end that stays twice counts half
        if off > 0.0:
            high, at_high, at_low, kept = t, off, at_low * (0.5 if kept == 1 else 1.0), 1
        else:
            low, at_low, at_high, kept = t, off, at_high * (0.5 if kept == -1 else 1.0), -1
    return t


@jit
def _turned(y: Complexes, turn: complex, scale: float) -> Complexes:
    """Return scale · y_n turnⁿ, n = 1, 2, 3 …"""
    turned, power = np.empty_like(y), turn
    for i in range(y.size):
        turned[i] = scale * y[i] * power
        power *= turn
    return turned


@jit
def _period(
    x: float,
    v: float,
    z: float,
    theta: float,
    y: Complexes,
    par: Parameters,
    phases: Array,
    jacobian: Array,
) -> tuple[int, float, float, float]:
    """Return (number of phases, x, ẋ, z) after a period from base phase θ on; `jacobian` (3, 3) receives the
    derivative.

    Rows of `phases` receive (t, s, x, ẋ, z). The number is 0 where there are more phases, or steps in one, than can be
    followed. Perturbations pass events as in `period_map.half_period_map`.
    """
    end, Z_m = 2.0 * math.pi / par.omega, par.F_k / par.K_z
    delta, count, t = par.c / (2.0 * par.m), 0, 0.0
    for i in range(3):
        for j in range(3):
            jacobian[i, j] = 1.0 if i == j else 0.0
    while t < end:
        if count == len(phases):
            return 0, x, v, z
        drive = _turned(y, unit(theta + par.omega * t), par.k / par.m)
        s = 0.0
        if abs(z) >= Z_m:
            side = 1.0 if z > 0.0 else -1.0
            pushed = side * (par.m * drive.sum().real - par.k * x) > par.F_k
            s = side if side * v > 0.0 or (v == 0.0 and pushed) else 0.0
        write_phase(phases, count, t, s, x, v, z)
        count += 1
        sticks = s == 0.0
        contact, kappa = (par.K_z * z, par.k + par.K_z) if sticks else (s * par.F_k, par.k)
        start, of_phase = (v, -(par.k * x + contact) / par.m), (delta, kappa / par.m, par.omega)
        fastest = max(math.sqrt(kappa / par.m), delta, y.size * par.omega)
        # 4.0 steps per radian of the fastest motion
        steps = max(8, math.ceil(4.0 * fastest * (end - t)))
        if steps > _MOST_STEPS and not sticks:
            return 0, x, v, z
        h, gained, rate, high, event = (end - t) / steps, 0.0, v, end - t, False
        turns, limit = _turned(np.ones_like(y), unit(par.omega * h), 1.0), Z_m if sticks else 0.0
        by_step = _step(h, of_phase, y.size)
        for i in range(steps):
            if i == _MOST_STEPS:
                return 0, x, v, z
            here = rate, start[1] - kappa / par.m * gained
            further, rate_after = _after(here, by_step, drive)
            after = z + gained + further if sticks else rate_after
            side = math.copysign(1.0, after) if sticks else -s
            off = side * after - limit
            if off > 0.0:
                level = z + gained, side, limit
                since = _crossing(level, (h, off), here, of_phase, drive, sticks)
                further, rate = _motion(since, here, of_phase, drive)
                gained, high, event = gained + further, i * h + since, True
                break
            gained, rate = gained + further, rate_after
            drive *= turns
        J, S, R = step_response(high, delta, kappa / par.m)
        for j in range(3):
            dx, dv, dz = jacobian[0, j], jacobian[1, j], jacobian[2, j]
            offset = dz - dx if sticks else 0.0  # the contact point stays in stick
            pull = par.K_z / par.m * offset
            jacobian[0, j] = (1.0 - kappa / par.m * J) * dx + S * dv - J * pull
            jacobian[1, j] = -kappa / par.m * S * dx + R * dv - S * pull
            jacobian[2, j] = jacobian[0, j] + offset if sticks else 0.0
        x += gained
        if sticks:
            v, z = rate, (math.copysign(Z_m, z + gained) if event else z + gained)
        else:
            v, z = (0.0 if event else rate), s * Z_m
        t = t + high if event else end
    return count, x, v, z


@jit
def _steady(
    state: tuple[float, float, float], theta: float, y: Complexes, par: Parameters, phases: Array
) -> int:
    """Return number of phases of the steady period from base phase θ on, written to `phases`; 0 where it was not
    found."""
    x, v, z = state
    Z_m, jacobian = par.F_k / par.K_z, np.empty((3, 3))
    size = abs(x)
    # 40 steps of Newton's method at most
    for _ in range(40):
        count, x1, v1, z1 = _period(x, v, z, theta, y, par, phases, jacobian)
        if count == 0:
            return 0
        off = np.array([x1 - x, v1 - v, z1 - z])
        # 1e-11 relative to the displacement: change of the state over a period
        if abs(off[0]) + abs(off[1]) / par.omega + abs(off[2]) < 1e-11 * size:
            return count
        step = np.linalg.solve(np.eye(3) - jacobian, off)
        if not abs(step[0]) + abs(step[1]) / par.omega < size:  # NaN is not
            step = off
        x, v, z = x + step[0], v + step[1], min(max(z + step[2], -Z_m), Z_m)
    return 0


def distorted_harmonics(orbit: Orbit, base: Complexes, count: int) -> Complexes:
    """Return x_n, n = 1, 2 … count, m, of the steady motion of an orbit's oscillator under a base of several harmonics.

    orbit : the motion under Re base[0] e^{iωt} alone, from which the search starts.   base : y_n, n = 1, 2 …, m; y_1 is
    real.   count : number of harmonics, even ones among them.

    Raises NoSteadyOrbit where the motion was not found.
    """
    par, first = parameters(orbit.oscillator, orbit.motion), orbit.phases[0]
    n, y = np.arange(1.0, count + 1.0), np.zeros(count, dtype=np.complex128)
    y[: base.size] = base[:count]
    impedance = par.k - (n * par.omega) ** 2 * par.m + 1j * n * par.omega * par.c
    if orbit.regime not in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS):
        # a contact that only sticks is a spring, one without friction is nothing
        return par.k * y / (impedance + (par.K_z if par.F_k > 0.0 else 0.0))
    # 512 phases at most
    phases = np.empty((512, 5))
    state = float(first[PHASE_X]), float(first[PHASE_V]), float(first[PHASE_Z])
    found = _steady(state, orbit.theta, base, par, phases)
    if not found:
        raise NoSteadyOrbit(f"no steady motion found under {base.size} harmonics of the base")
    period = orbit.motion.period
    integrals = stick_integrals(phases[:found], period, orbit.theta, base, par, count)
    harmonics: Complexes = (par.k * y + 1j * par.K_z / (math.pi * n) * integrals) / impedance
    return harmonics
