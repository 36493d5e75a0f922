"""Motion of oscillators that are not of the model, in fixed steps: what the fault table disturbs the mechanics with,
and the records of other damping laws.

    m x″ + c x′ + c_r (x′ − y′) + c₂ |x′| x′ + c₃ x′³ + η (k/ω) x′ + k x + k₂ x² + k₃ x³ + K_z z
    = k (y + y₃),   y = Y cos ωt,   y₃ = Y₂ cos 2ωt + Y₃ cos 3ωt

z′ = x′ within |z| ≤ (F_k/K_z)(1 + s e^(−|x′|/v_s)), a Jenkins contact whose friction falls with speed where s > 0;
or z′ = x′ (1 − |z K_z/F_k|ⁿ (1 + sgn(z x′))/2), a Bouc–Wen contact. Runge–Kutta of order 4, 8192 steps a period; at the
kinks of the contact that is of order 2, 1e-6 of the motion, far below any fault.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from .truths import Truth

STEPS = 8192
_MOST_PERIODS = 3000
_REPEATS = 1e-9  # of the displacement


class Departure(NamedTuple):
    """Departures from the model.

    quadratic : c₂, N s²/m².   even, cubic : k₂, N/m², k₃, N/m³.   third, second : Y₃/Y, Y₂/Y.
    falling, speed : s and v_s, m/s.   bouc_wen : n, 0 for a Jenkins contact.
    relative : c_r, N s/m.   third_power : c₃, N s³/m³.   structural : η.
    """

    quadratic: float = 0.0
    even: float = 0.0
    cubic: float = 0.0
    third: float = 0.0
    falling: float = 0.0
    speed: float = 1.0
    bouc_wen: float = 0.0
    relative: float = 0.0
    third_power: float = 0.0
    structural: float = 0.0
    second: float = 0.0


NO_DEPARTURE = Departure()


@njit(cache=True)
def _limit(v, numbers, departure):
    """Return largest |z| of a Jenkins contact at a speed."""
    falling = departure[4] * math.exp(-abs(v) / departure[5]) if departure[4] != 0.0 else 0.0
    return numbers[4] / numbers[3] * (1.0 + falling)


@njit(cache=True)
def _rate(t, x, v, z, numbers, departure):
    m, c, k, K_z, F_k, Y, omega = numbers
    quadratic, even, cubic, third, _, _, n, relative, third_power, structural, second = departure
    slope = v
    if n > 0.0:
        if z * v > 0.0:
            slope = v * (1.0 - abs(z * K_z / F_k) ** n)
    else:
        limit = _limit(v, numbers, departure)
        z = min(max(z, -limit), limit)
    drive = math.cos(omega * t)
    if second != 0.0 or third != 0.0:
        drive += second * math.cos(2.0 * omega * t) + third * math.cos(3.0 * omega * t)
    drive *= k * Y
    base = 0.0
    if relative != 0.0:
        base = math.sin(omega * t) + 2.0 * second * math.sin(2.0 * omega * t)
        base = -omega * Y * (base + 3.0 * third * math.sin(3.0 * omega * t))
    damping = c + structural * k / omega + quadratic * abs(v) + third_power * v * v
    force = (damping * v + relative * (v - base)) + K_z * z
    force += (k + even * x + cubic * x * x) * x
    return v, (drive - force) / m, slope


@njit(cache=True)
def _after(h, rate, t, x, v, z, numbers, departure):
    return _rate(t + h, x + h * rate[0], v + h * rate[1], z + h * rate[2], numbers, departure)


@njit(cache=True)
def _run(numbers, departure, state, periods, out):
    """Follow (x, v, z) over whole periods; (x, v, x″) of each step of the last ones into out, (3, n)."""
    h = 2.0 * math.pi / numbers[6] / STEPS
    total, kept = periods * STEPS, out.shape[1]
    x, v, z = state
    for i in range(total):
        t = (i % STEPS) * h
        k1 = _rate(t, x, v, z, numbers, departure)
        if i >= total - kept:
            place = i - (total - kept)
            out[0, place], out[1, place], out[2, place] = x, v, k1[1]
        k2 = _after(h / 2, k1, t, x, v, z, numbers, departure)
        k3 = _after(h / 2, k2, t, x, v, z, numbers, departure)
        k4 = _after(h, k3, t, x, v, z, numbers, departure)
        x += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        v += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        z += h / 6 * (k1[2] + 2 * k2[2] + 2 * k3[2] + k4[2])
        if departure[6] == 0.0:
            limit = _limit(v, numbers, departure)
            z = min(max(z, -limit), limit)
    return x, v, z


def _numbers(truth: Truth, level: int) -> tuple[float, ...]:
    t = truth
    return (t.m, t.c, t.k, t.K_z, t.F_k, t.Y[level], t.omega)


def steady_signals(truth: Truth, level: int, departure: Departure) -> CubicSpline:
    """Return (x, x′, x″) of the steady period of a level as a periodic function of ωt, SI."""
    return steady(_numbers(truth, level), departure)


def steady(numbers: tuple[float, ...], departure: Departure) -> CubicSpline:
    """Return what `steady_signals` does, of (m, c, k, K_z, F_k, Y, ω)."""
    state = (0.0, 0.0, 0.0)
    out = np.empty((3, STEPS))
    for _ in range(_MOST_PERIODS):
        after = _run(numbers, departure, state, 1, out)
        if abs(after[0] - state[0]) < _REPEATS * np.abs(out[0]).max():
            break
        state = after
    else:
        raise ArithmeticError(f"no steady motion with {departure}")
    phases = np.linspace(0.0, 2.0 * math.pi, STEPS + 1)
    return CubicSpline(phases, np.column_stack([out, out[:, 0]]), axis=1, bc_type="periodic")


def from_rest(truth: Truth, level: int, periods: int) -> CubicSpline:
    """Return (x, x′, x″) from rest at ωt = 0 on, over `periods` periods, as a function of ωt, SI."""
    out = np.empty((3, periods * STEPS))
    _run(_numbers(truth, level), Departure(), (0.0, 0.0, 0.0), periods, out)
    phases = np.arange(periods * STEPS) * (2.0 * math.pi / STEPS)
    return CubicSpline(phases, out, axis=1)


def ring_down(
    truth: Truth,
    x: float,
    step: float,
    duration: float,
    v: float = 0.0,
    z: float | None = None,
    departure: Departure = NO_DEPARTURE,
) -> np.ndarray:
    """Return (x, x′, x″) of a free motion from (x, v) on, sampled each `step` seconds, (3, n), SI; no drive.

    z : deflection of the contact; by default that after a pull to x > 0.
    """
    finer = max(1, math.ceil(step * truth.omega_n * STEPS / (2.0 * math.pi)))
    count = math.ceil(duration / step) * finer
    out = np.empty((3, -(-count // STEPS) * STEPS))
    # the period of a drive that does not move only sets the step
    omega = 2.0 * math.pi * finer / (STEPS * step)
    numbers = (truth.m, truth.c, truth.k, truth.K_z, truth.F_k, 0.0, omega)
    state = (x, v, min(x, truth.F_k / truth.K_z) if z is None else z)
    _run(numbers, departure, state, out.shape[1] // STEPS, out)
    return out[:, :count:finer]
