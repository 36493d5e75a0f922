"""Contacts that yield gradually, and the motion of a mass on them: what one Jenkins element is mistaken for.

    m x″ + c x′ + k x + Σ f_j = k Y cos ωt

Each element f_j of a contact is a slider, f_j′ = K_j x′ within |f_j| ≤ F_j (Jenkins), of Dahl's kind,
f_j′ = ½K_j x′ (1 − f_j sgn(x′)/F_j), or of Bouc's and Wen's, f_j′ = K_j x′ (1 − |f_j/F_j|ⁿ (1 + sgn(f_j x′))/2), n = 1
or 2. All have the stiffness K_j after a reversal and the friction F_j in the end, and their force is a function of the
displacement alone between two reversals: it is followed exactly over a step, x by the method of Runge and Kutta of
order 4. Nothing here comes from the package.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from .truths import Linear

STEPS = 2048
"""Of a period."""

_MOST_PERIODS = 3000
_REPEATS = 1e-9  # of the displacement
_SLIDERS = 16  # that stand for a distribution

Contact = np.ndarray
"""Rows (K_j, F_j, kind) of the elements of a contact; kind 0: a slider, 1: Dahl's, 1 + n: Bouc's and Wen's."""


def two_sliders(K_z: float, F_k: float) -> Contact:
    """Return half of the stiffness yields at a quarter of the friction."""
    return np.array([(0.5 * K_z, 0.25 * F_k, 0.0), (0.5 * K_z, 0.75 * F_k, 0.0)])


def iwan(K_z: float, F_k: float) -> Contact:
    """Return sliders of one stiffness whose yield forces are spread evenly between zero and the largest (Iwan 1966)."""
    share = (2.0 * np.arange(_SLIDERS) + 1.0) / _SLIDERS**2
    return np.array([(K_z / _SLIDERS, part * F_k, 0.0) for part in share])


def dahl(K_z: float, F_k: float) -> Contact:
    """Return Dahl's contact, which is LuGre's with a friction that does not depend on the speed."""
    return np.array([(K_z, F_k, 1.0)])


def bouc_wen(n: int) -> Callable[[float, float], Contact]:
    """Return Bouc's and Wen's contact with the exponent n, 1 or 2."""
    return lambda K_z, F_k: np.array([(K_z, F_k, 1.0 + n)])


CONTACTS: dict[str, Callable[[float, float], Contact]] = {
    "Bouc–Wen, n = 1": bouc_wen(1),
    "Bouc–Wen, n = 2": bouc_wen(2),
    "two sliders": two_sliders,
    "Iwan": iwan,
    "Dahl": dahl,
}


@njit(cache=True)
def _moved(f, u, element):
    """Return the force of an element after a displacement u one way."""
    K, F, kind = element
    if kind == 0.0:
        return min(max(f + K * u, -F), F)
    end = F if u > 0.0 else -F
    if kind == 1.0:
        return end + (f - end) * math.exp(-0.5 * K * abs(u) / F)
    part, way = (
        f / end,
        K * abs(u) / F,
    )  # the force in the direction of motion; elastic until it is zero
    elastic = min(max(-part, 0.0), way)
    part, way = part + elastic, way - elastic
    if kind == 2.0:
        return end * (1.0 - (1.0 - part) * math.exp(-way))
    return end * (part + math.tanh(way)) / (1.0 + part * math.tanh(way))


@njit(cache=True)
def _acceleration(x, v, u, phase, f, numbers, contact):
    m, c, k, Y, _ = numbers
    force = 0.0
    for j in range(f.size):
        force += _moved(f[j], u, contact[j])
    return (k * Y * math.cos(phase) - c * v - k * x - force) / m


@njit(cache=True)
def _follow(numbers, contact, start, f, count, h, out):
    """Return steps of h seconds from (x, v) and the forces f, which change; (x, v, x″) of the last ones into out, (3,
    n)."""
    omega, first = numbers[4], count - out.shape[1]
    x, v = start
    for i in range(count):
        phase = (i % STEPS) * h * omega
        half, full = phase + 0.5 * h * omega, phase + h * omega
        a1 = _acceleration(x, v, 0.0, phase, f, numbers, contact)
        if i >= first:
            out[0, i - first], out[1, i - first], out[2, i - first] = x, v, a1
        u2, v2 = 0.5 * h * v, v + 0.5 * h * a1
        a2 = _acceleration(x + u2, v2, u2, half, f, numbers, contact)
        u3, v3 = 0.5 * h * v2, v + 0.5 * h * a2
        a3 = _acceleration(x + u3, v3, u3, half, f, numbers, contact)
        u4, v4 = h * v3, v + h * a3
        a4 = _acceleration(x + u4, v4, u4, full, f, numbers, contact)
        u = h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        x += u
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        for j in range(f.size):
            f[j] = _moved(f[j], u, contact[j])
    return x, v


def steady_on(
    contact: Contact, m: float, c: float, k: float, Y: float, omega: float
) -> CubicSpline:
    """Return (x, x′, x″) of the steady period as a periodic function of ωt, SI."""
    out, f, state = np.empty((3, STEPS)), np.zeros(len(contact)), (0.0, 0.0)
    numbers, step = (m, c, k, Y, omega), 2.0 * math.pi / omega / STEPS
    for _ in range(_MOST_PERIODS):
        after = _follow(numbers, contact, state, f, STEPS, step, out)
        if abs(after[0] - state[0]) < _REPEATS * np.abs(out[0]).max():
            break
        state = after
    else:
        raise ArithmeticError("no steady motion")
    phases = np.linspace(0.0, 2.0 * math.pi, STEPS + 1)
    return CubicSpline(phases, np.column_stack([out, out[:, 0]]), axis=1, bc_type="periodic")


def ring_down_on(
    contact: Contact,
    oscillator: Linear,
    x: float,
    v: float,
    f: np.ndarray,
    step: float,
    lasts: float,
) -> np.ndarray:
    """Return (x, x′, x″) of a free motion from (x, v) on, sampled each `step` seconds, (3, n), SI.

    f : forces of the elements at the start, N.   lasts : s.
    """
    omega_n = oscillator.omega_n
    finer = max(1, math.ceil(step * omega_n * STEPS / (2.0 * math.pi)))
    out = np.empty((3, math.ceil(lasts / step) * finer))
    numbers = (oscillator.m, oscillator.c, oscillator.k, 0.0, omega_n)
    _follow(numbers, contact, (x, v), f.copy(), out.shape[1], step / finer, out)
    return out[:, ::finer]
