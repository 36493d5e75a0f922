"""Exact derivatives of a steady orbit by its oscillator: of its harmonics and of its first onset of slip.

At a fixed phase of the base, changes δx and δẋ pass every event unchanged, since the force of the contact is
continuous; where the mass turns, that force becomes s F_k + K_z(x − x_r), x_r the place of the turn, which moves by δx.
Within a phase the motion obeys a linear equation and its derivatives the same equation, differentiated: both are
followed by Taylor's series, a few radians of the fastest motion at a time, which is exact to rounding at resonance, in
the shortest stick and whatever the damping. Half a period later

    δs(T/2) = A δs(0) + B δp        s = (x, ẋ) at the reversal at −X, p = (F_k, c, ρ, m), ρ = K_z^{−1/2}

and, as the orbit is its own mirror image, δs(T/2) = −δs(0), so that by the implicit function theorem

    δs(0) = −(1 + A)⁻¹ B δp

with any number of slips in the half cycle. The derivative by the amplitude Y of the base follows from homogeneity,
x(αY, αF_k) = α x(Y, F_k).
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Complexes
from ..model import Parameters
from .events import PHASE_S, PHASE_T, PHASE_Z, read_phase
from .flow import inverse, unit
from .integrals import GAUSS_NODES, GAUSS_WEIGHTS, PANEL
from .jit import jit
from .regime import Regime

# Columns of all that is followed: the motion, its derivatives by OSCILLATOR_UNKNOWNS, and by x and ẋ at the start.
_BY_F_K, _BY_C, _BY_RHO, _BY_M, _BY_X, _BY_V = range(1, 7)
_COLUMN_COUNT = 7
_AT_X, _AT_V, _GAIN = range(3)  # rows of a phase: x and ẋ at its start, and what x gains in it

_RADIANS = 4.0  # of the fastest of Ω, 2δ and ω: a series so long loses two digits at most
_TERMS = 36
_PLACES = 0.5 * (1.0 + GAUSS_NODES)
# Of a series of the gain over a panel: the velocity there, times the weight of Gauss's rule, (places, terms).
_RATES = np.arange(_TERMS) * _PLACES[:, None] ** np.maximum(np.arange(_TERMS) - 1.0, 0.0)
_RATES *= 0.5 * GAUSS_WEIGHTS[:, None]
_ONE_SLIP, _SEVERAL_SLIPS, _NO_SLIP = map(
    int, (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS, Regime.NO_SLIP)
)


@jit
def steady_harmonics(
    phases: Array, theta: float, par: Parameters, regime: int, count: int
) -> Complexes:
    """The harmonics x_n, n = 1, 3 … 2 count − 1, m, of an orbit and the derivatives by `OSCILLATOR_UNKNOWNS`,
    (5, count).

    phases, theta : as of an `Orbit`.   regime : code of `Regime`.   The contact force K_z z changes in stick alone,
    where ż = ẋ, and the equation of motion does the rest:

        (k − n²ω²m + inωc) x_n = kY δ_n1 − f_n,      f_n = 2K_z/(iπn) ∫ ẋ e^{−inωt} dt over stick in half a cycle
    """
    out = np.zeros((5, count), dtype=np.complex128)
    if regime in (_ONE_SLIP, _SEVERAL_SLIPS):
        _set_contact(phases, theta, par, out)
    for i in range(count):
        rate, stuck = (2 * i + 1) * par.omega, i == 0 and regime == _NO_SLIP
        stiff = par.k + (par.K_z if stuck else 0.0)
        over = inverse(stiff - rate * rate * par.m, rate * par.c)
        if i == 0:
            out[0, i] += par.k * par.Y
        if stuck:
            out[_BY_RHO, i] = 2.0 * par.K_z * math.sqrt(par.K_z) * out[0, i] * over
        for j in range(5):
            out[j, i] *= over
        out[_BY_C, i] -= complex(0.0, rate) * over * out[0, i]
        out[_BY_M, i] += rate * rate * over * out[0, i]
    return out


def onset_slopes(phases: Array, theta: float, par: Parameters) -> Array:
    """Derivatives by `OSCILLATOR_UNKNOWNS` of V_s and t_s at the first onset of slip after the reversal at −X, and of
    λ = 4X − a, the travel that sticking takes; (3, 4), zero where nothing slips.   phases, theta : as of an `Orbit`."""
    slopes, (t, s, x, v, z) = np.zeros((3, 4)), phases.T
    if par.F_k == 0.0 or not s.any():
        return slopes
    states, _, _, shifts, start = _follow(phases, theta, par, 1)
    at = states[..., _BY_F_K:_BY_X] + states[..., _BY_X:] @ start
    shifted = iter(shifts[:, _BY_F_K:_BY_X] + shifts[:, _BY_X:] @ start)
    # the force is continuous: the acceleration at the start of each phase
    force = par.k * (par.Y * np.cos(theta + par.omega * t) - x) - par.c * v - par.K_z * z
    acceleration = force / par.m
    before, first = 1.0, True
    for i, (_, s, _, v, _) in enumerate(phases.tolist()):
        if s != 0.0:
            gained = at[i, _GAIN]
            if before == 0.0:  # the onset moves
                shift = next(shifted)
                gained = gained - shift
                if s > 0.0 and first:
                    first = False
                    slopes[0] = at[i, _AT_V] + acceleration[i] * shift / v
                    slopes[1] = shift / v + at[0, _AT_V] / acceleration[0]
            slopes[2] -= 2.0 * s * gained
        before = s
    slopes[2] -= 4.0 * at[0, _AT_X]
    return slopes


@jit
def _set_contact(phases: Array, theta: float, par: Parameters, out: Complexes) -> None:
    """Set out (5, count) to −f_n of `steady_harmonics` and its derivatives by UNKNOWNS."""
    count = out.shape[1]
    _, series, places, shifts, start = _follow(phases, theta, par, count)
    nodes, panels = _PLACES.size, places.shape[0]
    size = panels * nodes + shifts.shape[0]
    values, turns = np.zeros((5, size), dtype=np.complex128), np.empty(size, dtype=np.complex128)
    for panel in range(panels):
        rates, at = np.dot(_RATES, series[panel]), panel * nodes
        for node in range(nodes):
            turns[at + node] = unit(-places[panel, 0] - places[panel, 1] * _PLACES[node])
            values[0, at + node] = rates[node, 0]
            for j in range(1, 5):
                values[j, at + node] = _total(rates[node], start, j)
    for onset in range(shifts.shape[0]):
        at = panels * nodes + onset
        turns[at] = unit(-shifts[onset, 0])
        for j in range(1, 5):  # that an onset moves adds to the derivatives alone
            values[j, at] = _total(shifts[onset], start, j)
    squares = turns * turns
    for i in range(count):
        sums = np.dot(values, turns)
        sums[_BY_RHO] -= 2.0 * math.sqrt(par.K_z) * sums[0]
        for j in range(5):
            out[j, i] = complex(0.0, 2.0 * par.K_z / (math.pi * (2 * i + 1))) * sums[j]
        turns *= squares


@jit
def _total(row: Array, start: Array, j: int) -> float:
    """The derivative by unknown j of what has this row of `_follow`, with that of the start."""
    return row[j] + row[_BY_X] * start[0, j - 1] + row[_BY_V] * start[1, j - 1]


@jit
def _follow(
    phases: Array, theta: float, par: Parameters, count: int
) -> tuple[Array, Array, Array, Array, Array]:
    """The motion of half a cycle and its derivatives at fixed phases of the base.

    Returns, of each phase, the rows x, ẋ at its start and the gain of x, (phases, 3, 7); the Taylor series in stick,
    panel by panel, (panels, terms, 7), of the gain over the part of the panel that has passed; the phase ψ of the base
    at the start of each panel and its advance, (panels, 2); for each onset of slip, ψ and the shifts ẋ δt,
    (onsets, 7); and δs(0) by UNKNOWNS, (2, 4).
    """
    half = math.pi / par.omega
    number, onsets, longest = 0, 0, len(phases)
    panels = np.ones(longest, dtype=np.int64)
    for i in range(longest):
        t, s, _, _, _ = read_phase(phases, i)
        duration = (phases[i + 1, PHASE_T] if i + 1 < longest else half) - t
        stiff = par.k + par.K_z if s == 0.0 else par.k
        radians = duration * max(math.sqrt(stiff / par.m), par.c / par.m, par.omega)
        panels[i] += int(radians / _RADIANS)
        if s == 0.0:
            fastest = 2.0 * math.sqrt((par.k + par.K_z) / par.m) + 2.0 * count * par.omega
            panels[i] = max(panels[i], 1 + int(duration * fastest / PANEL))
            number += panels[i]
            if i + 1 < longest and phases[i + 1, PHASE_S] != 0.0:
                onsets += 1
    states = np.zeros((longest, 3, _COLUMN_COUNT))
    series, places = np.zeros((number, _TERMS, _COLUMN_COUNT)), np.empty((number, 2))
    shifts, scratch = np.zeros((onsets, _COLUMN_COUNT)), np.zeros((_TERMS, _COLUMN_COUNT))
    ends = np.zeros((2, _COLUMN_COUNT))
    ends[0, _BY_X] = ends[1, _BY_V] = 1.0
    at = onset = 0
    for i in range(longest):
        t, s, x, v, z = read_phase(phases, i)
        last = i + 1 == longest
        h = ((half if last else phases[i + 1, PHASE_T]) - t) / panels[i]
        for j in range(1, _COLUMN_COUNT):
            states[i, _AT_X, j], states[i, _AT_V, j] = ends[0, j], ends[1, j]
        states[i, _AT_X, 0], states[i, _AT_V, 0] = x, v
        phase = _equation(s, z, states[i], par)
        gained = np.zeros((2, _COLUMN_COUNT))
        for j in range(_COLUMN_COUNT):
            gained[1, j] = states[i, _AT_V, j]
        for panel in range(panels[i]):
            psi = theta + par.omega * (t + panel * h)
            into = series[at] if s == 0.0 else scratch
            _taylor(h, psi, phase, gained, par, into)
            if s == 0.0:
                places[at, 0], places[at, 1] = psi, par.omega * h
                at += 1
        states[i, _GAIN, 0] = gained[0, 0]
        for j in range(1, _COLUMN_COUNT):
            states[i, _GAIN, j] = gained[0, j]
            ends[0, j], ends[1, j] = states[i, _AT_X, j] + gained[0, j], gained[1, j]
        if s == 0.0 and not last and phases[i + 1, PHASE_S] != 0.0:
            _set_shift(i, phases, gained[0], par, shifts[onset])
            shifts[onset, 0] = theta + par.omega * phases[i + 1, PHASE_T]
            onset += 1
    # (1 + A) δs(0) = −B
    start = np.empty((2, 4))
    a, b, c, d = 1.0 + ends[0, _BY_X], ends[0, _BY_V], ends[1, _BY_X], 1.0 + ends[1, _BY_V]
    det = a * d - b * c
    for j in range(4):
        start[0, j] = -(d * ends[0, j + 1] - b * ends[1, j + 1]) / det
        start[1, j] = -(a * ends[1, j + 1] - c * ends[0, j + 1]) / det
    return states, series, places, shifts, start


@jit
def _equation(s: float, z: float, state: Array, par: Parameters) -> Array:
    """The equation of a phase, ü = f + Re[A e^{iψ}] − 2δu̇ − Ω²u of the gain u, and its derivatives: rows f, |A|, 2δ,
    Ω², (4, 7)."""
    sticks = s == 0.0
    m, x = par.m, state[_AT_X, 0]
    contact, stiff = (par.K_z * z, par.k + par.K_z) if sticks else (s * par.F_k, par.k)
    rows = np.zeros((4, _COLUMN_COUNT))
    rows[0, 0], rows[1, 0] = -(par.k * x + contact) / m, par.k * par.Y / m
    rows[2, 0], rows[3, 0] = par.c / m, stiff / m
    for j in range(1, _COLUMN_COUNT):
        rows[0, j] = -par.k / m * state[_AT_X, j]
    for row in range(4):
        rows[row, _BY_M] -= rows[row, 0] / m
    # where it sticks, the force at the start is that of the turn before
    rows[0, _BY_F_K] -= _side(s, z) / m
    rows[2, _BY_C] = 1.0 / m
    if sticks:
        rows[3, _BY_RHO] = -2.0 * par.K_z * math.sqrt(par.K_z) / m
    return rows


@jit
def _side(s: float, z: float) -> float:
    """The way, ±1, of the slip that this one is, or that was before this stick."""
    if s != 0.0:
        return s
    return 1.0 if z > 0.0 else -1.0


@jit
def _taylor(
    h: float, psi: float, phase: Array, gained: Array, par: Parameters, series: Array
) -> None:
    """Carry gain and velocity, `gained` (2, 7), over a time h from the base phase ψ on.   phase : of `_equation`.

    series : (terms, 7), receives the coefficients of the gain over the part of h that has passed,

        n(n−1) uₙ = h² fₙ₋₂ − 2δh (n−1) uₙ₋₁ − Ω²h² uₙ₋₂,   differentiated
    """
    damping, square = phase[2, 0] * h, phase[3, 0] * h * h
    radians = max(damping, math.sqrt(square), par.omega * h)
    terms = min(_TERMS, 12 + int(6.0 * radians))
    turn, advance = unit(psi), par.omega * h
    force = h * h
    for j in range(_COLUMN_COUNT):
        series[0, j], series[1, j] = gained[0, j], h * gained[1, j]
        gained[0, j], gained[1, j] = series[0, j] + series[1, j], series[1, j]
    # number by number: rows take Numba three times as long to compile, and to compute
    for n in range(2, terms):
        drive, damped, part = force * turn.real, damping * (n - 1), 1.0 / (n * (n - 1))
        slower, softer = h * (n - 1) * series[n - 1, 0], h * h * series[n - 2, 0]
        for j in range(_COLUMN_COUNT):
            u = drive * phase[1, j] - damped * series[n - 1, j] - square * series[n - 2, j]
            if j > 0:
                u -= slower * phase[2, j] + softer * phase[3, j]
            if n == 2:
                u += h * h * phase[0, j]
            u *= part
            series[n, j] = u
            gained[0, j] += u
            gained[1, j] += n * u
        force *= advance / (n - 1)
        turn = complex(-turn.imag, turn.real)
    for j in range(_COLUMN_COUNT):
        gained[1, j] /= h


@jit
def _set_shift(i: int, phases: Array, gained: Array, par: Parameters, shift: Array) -> None:
    """Set `shift` (7,) to ẋ δt at the onset of slip that ends the stick phase i.   gained : δx − δx_r there.

    z = ±Z_m there: δx + ẋ δt = δx_r + (s − side) δZ_m, side Z_m the deflection at the turn x_r where the phase began.
    """
    swing = phases[i + 1, PHASE_S] - _side(0.0, phases[i, PHASE_Z])
    for j in range(_COLUMN_COUNT):
        shift[j] = -gained[j]
    shift[_BY_F_K] += swing / par.K_z
    shift[_BY_RHO] += swing * 2.0 * par.F_k / math.sqrt(par.K_z)
