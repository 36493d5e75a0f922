"""The harmonics of a steady orbit, to rounding at resonance, in the shortest stick and whatever the damping.

The contact force K_z z changes in stick alone, where ż = ẋ, and the equation of motion does the rest:

    (k − n²ω²m + inωc) x_n = kY δ_n1 − f_n,      f_n = 2K_z/(iπn) ∫ ẋ e^{−inωt} dt over stick in half a cycle

Within a stick phase the motion obeys a linear equation: it is followed by Taylor's series, a few radians of its fastest
motion at a time, which no small divisor spoils.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Complexes, Integers
from ..jit import jit
from ..model import Parameters
from .events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z, read_phase
from .flow import unit
from .integrals import GAUSS_NODES, GAUSS_WEIGHTS, PANEL
from .regime import Regime

_TERMS = 36  # terms of such a series, the last below rounding
_PLACES = 0.5 * (1.0 + GAUSS_NODES)
# Velocity of a series of the displacement over a panel, times the weight of Gauss's rule, (terms, places).
_RATES = (np.arange(_TERMS) * _PLACES[:, None] ** np.maximum(np.arange(_TERMS) - 1.0, 0.0)).T
_RATES *= 0.5 * GAUSS_WEIGHTS


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
        series, places = _stuck(phases, theta, par, count)
        values = (series @ _RATES).ravel()
        turns = np.exp(-1j * (places[:, :1] + places[:, 1:] * _PLACES)).ravel()
        squares = turns * turns
        for i in range(count):
            force[i] += 2j * par.K_z / (math.pi * n[i]) * (values @ turns)
            turns *= squares
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


@jit
def _stuck(phases: Array, theta: float, par: Parameters, count: int) -> tuple[Array, Array]:
    """Return the Taylor series of the displacement in stick over the part of each panel that has passed, (panels,
    terms), and the phase ψ of the base at the start of the panel and its advance, (panels, 2)."""
    half, longest, stiff = math.pi / par.omega, len(phases), par.k + par.K_z
    fastest = max(math.sqrt(stiff / par.m), par.c / par.m, par.omega)
    integrand = 2.0 * math.sqrt(stiff / par.m) + 2.0 * count * par.omega
    panels, durations = np.zeros(longest, dtype=np.int64), np.zeros(longest)
    for i in range(longest):
        t, s, _, _, _ = read_phase(phases, i)
        durations[i] = (phases[i + 1, PHASE_T] if i + 1 < longest else half) - t
        if s == 0.0:
            # four radians of the fastest of Ω, 2δ and ω: a series over more loses more than two digits
            panels[i] = 1 + int(durations[i] * max(fastest / 4.0, integrand / PANEL))
    series, places = np.zeros((panels.sum(), _TERMS)), np.empty((panels.sum(), 2))
    at = 0
    for i in range(longest):
        t, _, x, v, z = read_phase(phases, i)
        gained, rate, force = 0.0, v, -(par.k * x + par.K_z * z) / par.m
        for panel in range(panels[i]):
            h = durations[i] / panels[i]
            psi = theta + par.omega * (t + panel * h)
            places[at, 0], places[at, 1] = psi, par.omega * h
            gained, rate = _follow(h, psi, gained, rate, force, par, series[at])
            at += 1
    return series, places


@jit
def _follow(
    h: float, psi: float, gained: float, rate: float, force: float, par: Parameters, series: Array
) -> tuple[float, float]:
    """Return (u, u̇) a time h after the base phase ψ, from u̇̇ = f + Re[A e^{iψ}] − 2δu̇ − Ω²u, whose series goes to
    `series`:

    n(n−1) uₙ = h² fₙ₋₂ − 2δh (n−1) uₙ₋₁ − Ω²h² uₙ₋₂
    """
    damping, square = par.c / par.m * h, (par.k + par.K_z) / par.m * h * h
    radians = max(damping, math.sqrt(square), par.omega * h)
    turn, advance, drive = unit(psi), par.omega * h, par.k * par.Y / par.m * h * h
    series[0], series[1] = gained, h * rate
    before, last = gained, h * rate
    u, v = before + last, last
    for n in range(2, min(_TERMS, 12 + int(6.0 * radians))):
        term = drive * turn.real - damping * (n - 1) * last - square * before
        if n == 2:
            term += h * h * force
        term /= n * (n - 1)
        series[n] = term
        u += term
        v += n * term
        before, last = last, term
        drive *= advance / (n - 1)
        turn = complex(-turn.imag, turn.real)
    return u, v / h
