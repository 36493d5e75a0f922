"""The harmonics of a steady orbit, to rounding at resonance, in the shortest stick and whatever the damping.

The contact force K_z z changes in stick alone, where ż = ẋ, and the equation of motion does the rest:

    (k − n²ω²m + inωc) x_n = kY δ_n1 − f_n,      f_n = 2K_z/(iπn) ∫ ẋ e^{−inωt} dt over stick in half a cycle

The integral is taken by Gauss's rule over panels of a few radians, with the velocity of the closed form of the phase
(`flow.py`), which no small divisor spoils.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Complexes, Integers
from ..jit import jit
from ..model import Parameters
from .events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z, read_phase
from .flow import Phase, move, unit
from .integrals import GAUSS_NODES, GAUSS_WEIGHTS, PANEL
from .regime import Regime


@jit
def stick_integrals(
    phases: Array, end: float, theta: float, y: Complexes, par: Parameters, count: int
) -> Complexes:
    """Return ∫ ẋ e^{−inψ} dt over all stick phases, n = 1, 2 … count, m, ψ the phase of the base.

    phases : rows (t, s, x, ẋ, z), the last of which ends at the time `end`, s.   theta : ψ at t = 0, rad.
    y : harmonics of the base, n = 1, 2 …, m.
    """
    Omega2, integrals = (par.k + par.K_z) / par.m, np.zeros(count, dtype=np.complex128)
    fastest = 2.0 * math.sqrt(Omega2) + (count + y.size) * par.omega
    for i in range(len(phases)):
        t, s, x, v, z = read_phase(phases, i)
        if s != 0.0:
            continue
        duration = (end if i + 1 == len(phases) else phases[i + 1, PHASE_T]) - t
        panels = 1 + int(duration * fastest / PANEL)
        h, begin = duration / panels, unit(theta + par.omega * t)
        for panel in range(panels):
            for node, weight in zip(GAUSS_NODES, GAUSS_WEIGHTS):  # noqa: B905 (compiled)
                since, rate, power = h * (panel + 0.5 + 0.5 * node), 0.0, begin
                start, force = v, -(par.k * x + par.K_z * z) / par.m  # free motion, and the first
                for n in range(y.size):
                    A, omega = par.k / par.m * y[n] * power, (n + 1) * par.omega
                    own = Phase(start, force, A, 0.5 * par.c / par.m, Omega2, omega)
                    rate += move(since, own)[1]
                    start, force, power = 0.0, 0.0, power * begin
                turn = begin.conjugate() * unit(-par.omega * since)
                moved = 0.5 * h * weight * rate * turn
                for n in range(count):
                    integrals[n] += moved
                    moved *= turn
    return integrals


def steady_harmonics(
    phases: Array, theta: float, par: Parameters, regime: Regime, count: int
) -> Complexes:
    """Return the harmonics x_n, n = 1, 3 … 2 count − 1, m, of an orbit, (count,).   phases, theta : as of an
    `Orbit`."""
    n = np.arange(1, 2 * count, 2)
    force, stiff = np.zeros(count, dtype=np.complex128), np.full(count, par.k)
    force[:1] = par.k * par.Y
    if regime is Regime.NO_SLIP:
        stiff[:1] += par.K_z
    elif regime in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS):
        base, half = np.array([complex(par.Y)]), math.pi / par.omega
        integrals = stick_integrals(phases, half, theta, base, par, 2 * count)[::2]
        force += 2j * par.K_z / (math.pi * n) * integrals
    harmonics: Complexes = force / (
        stiff - (n * par.omega) ** 2 * par.m + 1j * n * par.omega * par.c
    )
    return harmonics


def high_harmonics(phases: Array, theta: float, par: Parameters, n: Integers) -> Complexes:
    """Return the harmonics x_n, m, of an orbit that slips, of any odd orders far above the swings of the stuck mass:
    the integral of ẋ over stick from the values at its ends, as the equation of motion there has it."""
    half, s = math.pi / par.omega, 1j * n * par.omega
    ends = np.vstack([phases[1:], [half, *-phases[0, 1:]]])
    x = np.zeros(n.shape, dtype=np.complex128)
    for begin, end in zip(phases, ends, strict=True):
        if begin[PHASE_S]:
            continue
        for at, sign in ((begin, -1.0), (end, 1.0)):
            turn, v = np.exp(1j * (theta + par.omega * at[PHASE_T])), at[PHASE_V]
            z = begin[PHASE_Z] + at[PHASE_X] - begin[PHASE_X]
            force = par.k * (par.Y * turn.real - at[PHASE_X]) - par.c * v - par.K_z * z
            drive = par.k * par.Y * par.omega
            # ∫ cos ωt e^{−st} dt by parts, and m ẍ + (ms + c) ẋ
            forced = drive * (s * turn.imag + par.omega * turn.real) / (s**2 + par.omega**2)
            rest = forced - force - (par.m * s + par.c) * v
            x += sign * np.exp(-1j * n * (theta + par.omega * at[PHASE_T])) * rest
    x *= -2.0 * par.omega * par.K_z / (math.pi * s) / (par.m * s**2 + par.c * s + par.k + par.K_z)
    return x / (par.m * s**2 + par.c * s + par.k)
