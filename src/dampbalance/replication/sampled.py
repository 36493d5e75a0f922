"""One cycle of a sampled motion: its reversals, slip onsets and energy terms, read off x, v and acceleration.

The slope of the acceleration breaks at slip onset, and not at a reversal. An event is taken at the first sample at or
after it, or located between samples: the phase that ends there is extrapolated, by the cubic through its last four
accelerations, to v = 0, or to its intersection with the next phase, extrapolated backwards. `clean.py` says more.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..jit import jit
from ..motion.integrals import wrapped

PROMINENCE = 10.0
"""Ratio of the largest second difference of the acceleration to its median that counts as a break of slope.

A harmonic reaches √2, white noise about 6; the corner that ends a stick phase of N samples about N times the bend
within it, which in turn exceeds the median.
"""

_SIDE = 4  # samples of one phase through which its acceleration is continued

NO_CYCLE, REVERSALS, NO_CORNER, SHORT_STICK, LATE = range(1, 6)
"""Reasons why a cycle or its slip onsets could not be read."""

_Cubic = tuple[Any, Any, Any, Any]
_Quartic = tuple[float, float, float, float, float]


class Cycle(NamedTuple):
    """Features of one cycle, names and units as in `Features`; NaN for those that could not be read.

    trouble : 0, or the reason why no slip onset was read.   how_many : the count that this reason states.
    start : place of the reversal at −X, counted in samples.
    phi, phi_zero_crossing : lag of the reversal and of the upward zero of x behind cos ωt, rad.
    """

    trouble: int
    how_many: int
    start: float
    X: float
    X_s: float
    V_s: float
    t_s: float
    X_r: float
    V_r: float
    t_r: float
    phi: float
    phi_zero_crossing: float
    a: float
    b: float
    W: float


class _Instant(NamedTuple):
    """An event: its place in the record, counted in samples (whole or not), and x, v there."""

    place: float
    x: float
    v: float


@jit
def read_cycle(
    signals: Array, t0: float, dt: float, omega: float, k: float, between: bool, slip_samples: int
) -> Cycle:
    """Return the features of the first whole cycle of a record that begins with a forward reversal.

    signals : y, x, v and acceleration, (4, n).   t0 : time of the first sample, s.   dt : step, s.
    between : whether events are located between samples.   slip_samples : how many samples after slip onset a begins.
    """
    y, x, v, acceleration = signals[0], signals[1], signals[2], signals[3]
    nan = math.nan
    per_cycle = 2.0 * math.pi / (omega * dt)
    whole = round(per_cycle)
    n_1 = _first_reversal(x, v, per_cycle)
    if n_1 < 0:
        return Cycle(NO_CYCLE, 0, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan)
    start = _reversal(x, v, acceleration, dt, n_1, between)
    stop = start.place + (per_cycle if between else whole)
    b = integral(v * v, dt, start.place, stop)
    W = k * integral(y * v, dt, start.place, stop)
    zero = _upward_zero(x, n_1, n_1 + whole, between)
    crossing = wrapped(omega * (t0 + zero * dt) - 1.5 * math.pi)
    high, low = x[n_1], x[n_1]
    for i in range(n_1, n_1 + whole + 2):
        high, low = max(high, x[i]), min(low, x[i])

    X, phi, n_2 = 0.5 * (high - low), nan, n_1
    X_s = V_s = t_s = X_r = V_r = t_r = a = nan
    trouble, count = 0, 0
    for n in range(n_1 + 1, n_1 + whole - 1):
        if (v[n] >= 0.0) != (v[n + 1] >= 0.0):
            n_2, count = (n, count + 1) if count == 0 else (n_2, count + 1)
    if count != 1:
        trouble, count = REVERSALS, count + 1
    else:
        turn = _reversal(x, v, acceleration, dt, n_2, between)
        X, phi = 0.5 * (turn.x - start.x), wrapped(omega * (t0 + start.place * dt) - math.pi)
        trouble, count, forward = _onset(x, v, acceleration, dt, n_1, n_2, between)
        if trouble == 0:
            trouble, count, reverse = _onset(x, v, acceleration, dt, n_2, n_1 + whole, between)
        begin = forward.place + (0 if between else slip_samples)
        if trouble == 0 and begin >= turn.place:
            trouble, count = LATE, slip_samples
        if trouble == 0:
            X_s, V_s, t_s = forward.x, forward.v, (forward.place - start.place) * dt
            X_r, V_r, t_r = reverse.x, reverse.v, (reverse.place - turn.place) * dt
            a = 2.0 * integral(v, dt, begin, turn.place)
    return Cycle(
        trouble, count, start.place, X, X_s, V_s, t_s, X_r, V_r, t_r, phi, crossing, a, b, W
    )


@jit
def _first_reversal(x: Array, v: Array, per_cycle: float) -> int:
    """Return the last sample before the reversal at −X in the first whole cycle; −1 where there is no whole cycle."""
    found, end = -1, math.inf
    for n in range(_SIDE - 1, v.size - 1 - math.ceil(per_cycle)):
        if n < end and v[n] < 0.0 <= v[n + 1]:
            if found < 0:
                found, end = n, n + per_cycle - 1.0
            elif x[n] < x[found]:
                found = n
    return found


@jit
def _reversal(
    x: Array, v: Array, acceleration: Array, dt: float, n: int, between: bool
) -> _Instant:
    """Return the velocity reversal between samples n and n + 1."""
    if not between:
        return _Instant(n + 1.0, x[n + 1], v[n + 1])
    a0, a1, a2, a3 = _shifted(_through(acceleration, n - _SIDE + 1, n), _SIDE - 1.0)
    rate = v[n], dt * a0, dt * a1 / 2.0, dt * a2 / 3.0, dt * a3 / 4.0
    tau = _root(rate, v[n] / (v[n] - v[n + 1]))
    return _Instant(n + tau, x[n] + dt * tau * _value(_mean(rate), tau), 0.0)


@jit
def _onset(
    x: Array, v: Array, acceleration: Array, dt: float, n_reversal: int, n_next: int, between: bool
) -> tuple[int, int, _Instant]:
    """Return (trouble, its count, slip onset) between two reversals: where the slope of the acceleration breaks."""
    first = n_reversal + 1
    nowhere = _Instant(math.nan, math.nan, math.nan)
    bend = np.empty(max(n_next - first - 1, 0))
    for i in range(bend.size):
        at = acceleration[first + i + 1]
        bend[i] = abs((acceleration[first + i + 2] - at) - (at - acceleration[first + i]))
    largest, corner = 0.0, first
    for i in range(bend.size):
        if bend[i] > largest:
            largest, corner = bend[i], first + 1 + i
    small = 0
    for size in bend:
        if PROMINENCE * size < largest:
            small += 1
    if 2 * small <= bend.size:  # the median is too large
        return NO_CORNER, 0, nowhere
    # fewer than three samples in stick cannot be extrapolated to the corner
    if corner - first < 3 or n_next - corner < _SIDE:
        return SHORT_STICK, corner - first, nowhere
    if not between:
        return 0, 0, _Instant(float(corner), x[corner], v[corner])
    # The corner sample may belong to either phase, and in a simulation it overshoots: neither cubic uses it.
    n = corner - 1
    stick_first = max(first, n - _SIDE + 1)
    stick = _shifted(_through(acceleration, stick_first, n), float(n - stick_first))
    slip = _shifted(_through(acceleration, corner + 1, corner + _SIDE), -2.0)
    (a0, a1, a2, a3), (b0, b1, b2, b3) = stick, slip
    tau = _root((b0 - a0, b1 - a1, b2 - a2, b3 - a3, 0.0), 1.0)
    rate = v[n], dt * a0, dt * a1 / 2.0, dt * a2 / 3.0, dt * a3 / 4.0
    place = x[n] + dt * tau * _value(_mean(rate), tau)
    return 0, 0, _Instant(n + tau, place, _value(rate, tau))


@jit
def _upward_zero(x: Array, first: int, last: int, between: bool) -> float:
    """Return the place of the first upward zero of x after samples `first` to `last`; NaN when x keeps its sign."""
    for n in range(first, last + 1):
        if x[n] < 0.0 <= x[n + 1]:
            if not between:
                return n + 1.0
            c0, c1, c2, c3 = _shifted(_through(x, n - 1, n + 2), 1.0)
            return n + _root((c0, c1, c2, c3, 0.0), x[n] / (x[n] - x[n + 1]))
    return math.nan


@jit
def _through(signal: NDArray[Any], first: int, last: int) -> _Cubic:
    """Return the coefficients of the polynomial through three or four samples, in the steps since `first`."""
    f0, f1, f2 = signal[first], signal[first + 1], signal[first + 2]
    second = f2 - 2.0 * f1 + f0
    third = signal[first + 3] - 3.0 * f2 + 3.0 * f1 - f0 if last - first == 3 else 0.0 * f0
    return f0, f1 - f0 - second / 2.0 + third / 3.0, second / 2.0 - third / 2.0, third / 6.0


@jit
def _shifted(cubic: _Cubic, g: float) -> _Cubic:
    """Return the coefficients of a cubic whose origin is moved g steps later."""
    c0, c1, c2, c3 = cubic
    return (
        c0 + g * (c1 + g * (c2 + g * c3)),
        c1 + g * (2.0 * c2 + g * 3.0 * c3),
        c2 + g * 3.0 * c3,
        c3,
    )


@jit
def _value(p: _Quartic, t: float) -> float:
    p0, p1, p2, p3, p4 = p
    return p0 + t * (p1 + t * (p2 + t * (p3 + t * p4)))


@jit
def _mean(p: _Quartic) -> _Quartic:
    """Return the polynomial whose value at t is the mean of p from 0 to t."""
    p0, p1, p2, p3, p4 = p
    return p0, p1 / 2.0, p2 / 3.0, p3 / 4.0, p4 / 5.0


@jit
def _root(p: _Quartic, near: float) -> float:
    """Return the root that Newton's method finds from `near`, if it lies within two steps; else `near`."""
    _, p1, p2, p3, p4 = p
    t, step = near, 1.0
    for _ in range(50):
        slope = p1 + t * (2.0 * p2 + t * (3.0 * p3 + t * 4.0 * p4))
        step = -_value(p, t) / slope if slope != 0.0 else math.inf
        t += step
        if not 1e-15 < abs(step) < math.inf:
            break
    return t if abs(step) < 1e-9 and abs(t - near) < 2.0 else near


@jit
def integral(f: NDArray[Any], dt: float, start: float, stop: float) -> Any:
    """Return ∫ f dt from place `start` to place `stop`, counted in samples from 0 and not necessarily whole.

    Between whole samples: Simpson's composite rule (an odd number of intervals ends with the three-point rule for
    the last one). The parts of an interval at the two ends: the cubic through the four samples around it. Error
    O(dt⁴) for a smooth f.

    f : samples, real or complex, shape (n ≥ 4,).   dt : s.   Raises ValueError when the range leaves the samples.
    """
    if not 0.0 <= start <= stop <= f.size - 1:
        raise ValueError("the range of an integral leaves the samples")
    first, last = math.ceil(start), math.floor(stop)
    if last <= first + 1:
        return dt * _cubic_part(f, start, stop)
    total = _cubic_part(f, start, first) + _cubic_part(f, last, stop)
    for i in range(first, last - 1, 2):
        total += (f[i] + 4.0 * f[i + 1] + f[i + 2]) / 3.0
    if (last - first) % 2 == 1:
        total += (5.0 * f[last] + 8.0 * f[last - 1] - f[last - 2]) / 12.0
    return dt * total


@jit
def _cubic_part(f: NDArray[Any], start: float, stop: float) -> Any:
    """Return ∫ of the cubic through the four samples around [start, stop], a range within one or two intervals."""
    first = min(max(math.floor(start) - 1, 0), f.size - 4)
    c0, c1, c2, c3 = _through(f, first, first + 3)
    u, w = start - first, stop - first
    at_start = u * (c0 + u * (c1 / 2.0 + u * (c2 / 3.0 + u * c3 / 4.0)))
    return w * (c0 + w * (c1 / 2.0 + w * (c2 / 3.0 + w * c3 / 4.0))) - at_start
