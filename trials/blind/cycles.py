"""The steady cycle of the oscillator by piecewise exact flow with bracketed events: nothing of the package is used.

In units of m, k and the base's amplitude, time in 1/ω_n:

    x″ + 2ζ x′ + x + f = cos(r t),   f = K z in stick (z′ = x′, |z| ≤ F/K),   f = F sgn x′ in slip

Between events the motion is a constant, a forced and a decaying oscillation. Events are bracketed on a grid that is
fine beside the fastest oscillation (with a look at the extremum inside each step, so that no excursion is missed) and
bisected to the last bit. The state runs on, period by period, until it repeats.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

_GRID = 40  # steps in a radian-period 2π of the fastest oscillation
_LIMIT_LEFT = (
    1.0 - 1e-9
)  # of Z: a contact that stops at Z, rounded, slips on only after it has left, or is clearly beyond
_MOST_EVENTS = 400  # of a period
_MOST_PERIODS = 20_000
# The state repeats when its change over a period, as a part of its size, is small and falls no further: only rounding
# is left then. Measured: 2e-14 to 1e-13.
_SMALL, _STALLS = 1e-12, 5

# Columns of a phase: start, state (0 stick, ±1 slip), damped frequency, then u = offset + forced + decaying oscillation
# with x = u + shift; forced amplitude as a complex number.
START, SLIPS, FREQUENCY, OFFSET, SHIFT, REAL, IMAGINARY, COSINE, SINE = range(9)


@njit(cache=True)
def _phase(zeta, r, K, F, t, x, v, z, s, row):
    """Set the constants of the phase that starts at time t."""
    kappa = 1.0 + K if s == 0.0 else 1.0
    shift = x - z if s == 0.0 else 0.0
    offset = -shift / kappa if s == 0.0 else -s * F
    stiff, viscous = kappa - r * r, 2.0 * zeta * r
    square = stiff * stiff + viscous * viscous
    re, im = stiff / square, -viscous / square
    frequency = math.sqrt(kappa - zeta * zeta)
    cosine, sine = math.cos(r * t), math.sin(r * t)
    p = x - shift - offset - (re * cosine - im * sine)
    q = (v + r * (re * sine + im * cosine) + zeta * p) / frequency
    row[START], row[SLIPS], row[FREQUENCY], row[OFFSET], row[SHIFT] = t, s, frequency, offset, shift
    row[REAL], row[IMAGINARY], row[COSINE], row[SINE] = re, im, p, q


@njit(cache=True)
def _motion(zeta, r, row, t):
    """Return (u, u′, u″) in a phase at time t; u is z in stick, x in slip."""
    since, w = t - row[START], row[FREQUENCY]
    cosine, sine = math.cos(r * t), math.sin(r * t)
    forced = row[REAL] * cosine - row[IMAGINARY] * sine
    turned = row[REAL] * sine + row[IMAGINARY] * cosine
    decay, c, s = math.exp(-zeta * since), math.cos(w * since), math.sin(w * since)
    p, q = row[COSINE], row[SINE]
    h = decay * (p * c + q * s)
    rate = decay * ((q * w - zeta * p) * c - (p * w + zeta * q) * s)
    bend = -2.0 * zeta * rate - (w * w + zeta * zeta) * h
    return row[OFFSET] + forced + h, -r * turned + rate, -r * r * forced + bend


@njit(cache=True)
def _bisected(zeta, r, row, low, high, which, level, sign):
    """Return last time at which sign·(motion[which] − level) is not yet positive, in a bracket where it becomes so."""
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return high
        if sign * (_motion(zeta, r, row, middle)[which] - level) > 0.0:
            high = middle
        else:
            low = middle


@njit(cache=True)
def _advance(zeta, r, K, F, state, begin, end, rows):
    """Follow the state (x, v, z, s) over [begin, end]; phases into rows; how many there are."""
    x, v, z, s = state
    Z = F / K
    t, count = begin, 0
    while True:
        if count == len(rows):
            raise RuntimeError("too many events in a period")
        row = rows[count]
        count += 1
        _phase(zeta, r, K, F, t, x, v, z, s, row)
        longest = 2.0 * math.pi / (max(row[FREQUENCY], r) * _GRID)
        step = longest / 64.0  # what starts at rest may end soon
        here = _motion(zeta, r, row, t)
        event, direction = end, 0.0
        left = 0.0 if s != 0.0 or abs(z) < _LIMIT_LEFT * Z else math.copysign(1.0, z)
        while t < end:
            after = min(t + step, end)
            there = _motion(zeta, r, row, after)
            for sign in (1.0, -1.0):
                if s == 0.0:  # |z| beyond Z, at the end of the step or at a maximum inside
                    top = after
                    if sign * here[1] > 0.0 and sign * there[1] < 0.0:
                        top = _bisected(zeta, r, row, t, after, 1, 0.0, -sign)
                    limit = Z * (2.0 - _LIMIT_LEFT) if sign == left else Z
                    if sign * _motion(zeta, r, row, top)[0] > limit:
                        event = _bisected(zeta, r, row, t, top, 0, sign * limit, sign)
                        direction = sign
                        break
                elif sign == s:  # sv below zero, at the end of the step or at a minimum inside
                    low = after
                    if s * here[2] < 0.0 and s * there[2] > 0.0:
                        low = _bisected(zeta, r, row, t, after, 2, 0.0, s)
                    if s * _motion(zeta, r, row, low)[1] < 0.0:
                        event = _bisected(zeta, r, row, t, low, 1, 0.0, -s)
                        direction = s
                        break
            if direction != 0.0:
                break
            if left * there[0] < _LIMIT_LEFT * Z:
                left = 0.0
            t, here, step = after, there, min(2.0 * step, longest)
        t = event
        u, v, _ = _motion(zeta, r, row, t)
        x = u + row[SHIFT]
        z = u if s == 0.0 else s * Z
        if direction == 0.0:
            return count, (x, v, z, s)
        if s == 0.0:
            s = direction
            z = s * Z
        else:
            z, v, s = s * Z, 0.0, 0.0


@njit(cache=True)
def _settle(zeta, r, K, F, rows):
    """Return phases of the steady period from ωt = 0 on, and the state at its start; −1 phases where it does not
    repeat."""
    period = 2.0 * math.pi / r
    # the motion of a contact that sticks: the answer where it does, a start where not
    _phase(zeta, r, K, F, 0.0, 0.0, 0.0, 0.0, 0.0, rows[0])
    x, v = rows[0][REAL], -r * rows[0][IMAGINARY]
    Z = F / K
    z, s = x, 0.0
    if abs(z) > Z:
        z = math.copysign(Z, x)
    state, least, stalls = (x, v, z, s), math.inf, 0
    for _ in range(_MOST_PERIODS):
        count, new = _advance(zeta, r, K, F, state, 0.0, period, rows)
        size, change = 0.0, abs(new[2] - state[2])
        for j in range(2):
            size += abs(new[j])
            change += abs(new[j] - state[j])
        stalls = 0 if change < least else stalls + 1
        least = min(least, change)
        if new[3] == state[3] and change <= _SMALL * size and (stalls >= _STALLS or change == 0.0):
            return count, state
        state = new
    return -1, state


@njit(cache=True)
def _sampled(zeta, r, rows, times, out):
    """Write (x, x′, x″) at times within [0, T], any order, into out (3, n)."""
    starts = rows[:, START]
    for i in range(len(times)):
        row = rows[max(np.searchsorted(starts, times[i], "right") - 1, 0)]
        out[0, i], out[1, i], out[2, i] = _motion(zeta, r, row, times[i])
        out[0, i] += row[SHIFT]


@dataclass(frozen=True, eq=False)
class Cycle:
    """A steady cycle from the base's peak on, in units of m, k and the base's amplitude.

    phases : (n, 9), the columns named above.   start : (x, x′, z) at the peak of the base.
    """

    zeta: float
    r: float
    start: tuple[float, float, float]
    phases: np.ndarray

    @property
    def slips(self) -> int:
        """Slip phases of a half cycle."""
        state = self.phases[:, SLIPS]
        began = (state != 0.0) & (np.roll(state, 1) != state)
        if (state != 0.0).all():
            raise AssertionError("a contact that slips reverses, and sticks then")
        return round(int(began.sum()) / 2)

    @property
    def sticking(self) -> float:
        """Part of the cycle in which the contact sticks."""
        period = 2.0 * math.pi / self.r
        lasts = np.diff(self.phases[:, START], append=period)
        return float(lasts[self.phases[:, SLIPS] == 0.0].sum() / period)

    def state(self, phase: np.ndarray) -> np.ndarray:
        """Return (x, x′, x″), (3, n), at phases ωt, rad."""
        times = np.mod(phase, 2.0 * math.pi) / self.r
        out = np.empty((3, times.size))
        _sampled(self.zeta, self.r, self.phases, times, out)
        return out


def steady_cycle(zeta: float, r: float, K: float, F: float) -> Cycle:
    """Return the steady cycle at damping ratio ζ < 1, ω/ω_n = r, K_z/k = K and F_k/kY = F > 0."""
    rows = np.empty((_MOST_EVENTS, 9))
    count, start = _settle(zeta, r, K, F, rows)
    if count < 0:
        raise ArithmeticError(f"no steady cycle: {zeta=}, {r=}, {K=}, {F=}")
    return Cycle(zeta, r, start[:3], rows[:count].copy())
