"""Features of a clean sampled record, read as from the plots of acceleration against x, v and t.

Use this reader for simulated records without noise. The acceleration separates the phases: at the onset of slip its
slope breaks (the corner of Figure 3) because the contact spring stops following the mass from one instant to the next.
At a reversal, where v = 0, it does not break.

Two ways to read an event:

    "sample"        the first sample at or after the event: what one picks off a listing
    "interpolated"  between samples: the phase that ends at the event is continued, by the cubic through its last four
                    accelerations, up to v = 0, or up to where the next phase, continued backwards, meets it

The interpolated reading of an exact record converges to the exact features: see `tests/unit/test_features.py`. The
second difference of a noisy acceleration is useless: `mean_harmonics.py` reads noisy records.
"""

from __future__ import annotations

import cmath
import math
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from ..arrays import Array
from ..features import Features, of_numbers, wrapped
from ..motion.regime import Regime
from ..record import Record

ReadAt = Literal["interpolated", "sample"]
"""How an event is located: between samples, or at the first sample after it."""

PROMINENCE = 10.0
"""Ratio of the largest second difference of the acceleration to its median that counts as a break of slope.

A harmonic reaches √2, white noise about 6; the corner that ends a stick phase of N samples about N times the bend
within it, which in turn exceeds the median.
"""

CYCLES_TO_READ = 3
"""Periods that a record of a steady response needs: one to wait for the reversal, one to read, one for the lock-in."""

_SIDE = 4  # samples of one phase through which its acceleration is continued
_FEWEST = 3  # stick samples below which there is no line to meet the corner


def of_record(
    record: Record,
    omega: float,
    k: float,
    reading: ReadAt = "interpolated",
    slip_samples: int = 1,
) -> Features:
    """Features of one steady response, read off a clean record of y, x, v and acceleration.

    The cycle read is the first whole one that begins with a forward reversal (v from − to +, at x = −X).

        X          half the distance from the reversal t_1 to the next, t_2
        X_s, V_s   x, v at the break of slope between t_1 and t_2; t_s from t_1 on.   X_r, V_r, t_r: likewise, from t_2
        φ          of the reversal t_1, of the upward zero of x, of the fundamental; each against the fundamental of y
        X_1, X_3, X_5, φ_1   lock-in (2/T) ∫ x e^{−inωt} dt over all whole cycles from t_1 on
        a, b, W    by Simpson's rule: 2∫|ẋ| from t_s to t_2 (7a); ∫ẋ² (7b) and ∫k y ẋ (5) over the cycle

    In the "sample" reading b and W run over round(T/dt) whole steps from the first sample after the reversal, and a
    starts `slip_samples` samples after the break: "right after the abrupt jump".

    omega : drive frequency, rad/s.   k : stiffness, N/m, for W.   slip_samples : of the "sample" reading only.

    Without a slip onset (nothing slips, nothing sticks, or the velocity reverses more often than twice a cycle)
    X_s … t_r and a are NaN and the regime says why. Raises ValueError for a record without v or acceleration, without a
    whole cycle from reversal to reversal, or without base motion at ω.
    """
    s = _signals(record, omega, reading)
    n_1 = _first_reversal(s)
    start = _reversal(s, n_1)
    stop = start.place + (s.per_cycle if s.between_samples else round(s.per_cycle))
    base = _lock_in(s, s.y, 1, start.place)
    if not abs(base) > 0.0:
        raise ValueError(f"the base does not move at ω = {omega:g} rad/s: y has no fundamental")
    lag = -cmath.phase(base)  # of y behind cos ωt, zero in a simulation
    harmonics = {f"X_{n}": _lock_in(s, s.x, n, start.place) for n in (1, 3, 5)}
    numbers: dict[str, Any] = {
        "Y": abs(base),
        "X": 0.5 * float(np.ptp(s.x[n_1 : n_1 + round(s.per_cycle) + 2])),
        "phi_fundamental": wrapped(-cmath.phase(harmonics["X_1"]) - lag),
        "phi_zero_crossing": wrapped(_phase(s, _upward_zero(s, n_1)) - 1.5 * math.pi - lag),
        **{name: abs(amplitude) for name, amplitude in harmonics.items()},
        "b": integral(s.v**2, s.dt, start.place, stop),
        "W": integral(k * s.y * s.v, s.dt, start.place, stop),
    }
    try:
        n_2 = _other_reversal(s, n_1)
        turn = _reversal(s, n_2)
        phi = wrapped(_phase(s, start.place) - math.pi - lag)
        numbers |= {"X": 0.5 * (turn.x - start.x), "phi": phi, "phi_reversal": phi}
        forward, reverse = _onset(s, n_1, n_2), _onset(s, n_2, n_1 + round(s.per_cycle))
    except _NoOnset as reason:
        return of_numbers(omega, str(reason), **numbers)
    begin = forward.place + (0 if s.between_samples else slip_samples)
    if begin >= turn.place:
        late = f"no friction travel read: {slip_samples} samples after slip onset x has reversed"
        return of_numbers(omega, late, **numbers)
    numbers |= {
        "X_s": forward.x,
        "V_s": forward.v,
        "t_s": (forward.place - start.place) * s.dt,
        "X_r": reverse.x,
        "V_r": reverse.v,
        "t_r": (reverse.place - turn.place) * s.dt,
        "a": 2.0 * integral(s.v, s.dt, begin, turn.place),
    }
    return of_numbers(omega, str(Regime.ONE_SLIP), **numbers)


class _Signals(NamedTuple):
    """A record as reading it needs it: signals, time of sample 0 and step (s), ω, samples per cycle."""

    y: Array
    x: Array
    v: Array
    acceleration: Array
    t0: float
    dt: float
    omega: float
    per_cycle: float
    between_samples: bool


class _Instant(NamedTuple):
    """An event: its place in the record, counted in samples (whole or not), and x, v there."""

    place: float
    x: float
    v: float


class _NoOnset(Exception):
    """Why no slip onset can be read, in words for the regime."""


def _signals(record: Record, omega: float, reading: ReadAt) -> _Signals:
    if reading not in ("interpolated", "sample"):
        raise ValueError(f'reading must be "interpolated" or "sample", got {reading!r}')
    if record.v is None or record.acceleration is None:
        missing = "velocity" if record.v is None else "acceleration"
        raise ValueError(f"this reader needs v and acceleration, but the record has no {missing}")
    if not omega > 0.0:
        raise ValueError(f"omega must be positive, got {omega!r} rad/s")
    signals = (record.y, record.x, record.v, record.acceleration)
    t0, dt = float(record.t[0]), record.dt
    per_cycle = 2.0 * math.pi / (omega * dt)
    return _Signals(*signals, t0, dt, omega, per_cycle, reading == "interpolated")


def _phase(s: _Signals, place: float) -> float:
    """ωt at a place of the record, rad."""
    return s.omega * (s.t0 + place * s.dt)


def _lock_in(s: _Signals, signal: Array, n: int, start: float) -> complex:
    """X_n e^{−iφ_n} of the signal over all whole cycles from the place `start` on."""
    duration = s.per_cycle * math.floor((signal.size - 1 - start) / s.per_cycle)
    first = math.floor(start)
    kept = signal[first : math.ceil(start + duration) + 1]
    phase = n * (_phase(s, first) + s.omega * s.dt * np.arange(kept.size))
    whole = integral(kept * np.exp(-1j * phase), s.dt, start - first, start - first + duration)
    return 2.0 * whole / (duration * s.dt)


def _first_reversal(s: _Signals) -> int:
    """The last sample before the reversal at −X in the first whole cycle."""
    upward = np.flatnonzero((s.v[:-1] < 0.0) & (s.v[1:] >= 0.0))
    last = s.v.size - 2 - math.ceil(s.per_cycle)
    usable = upward[(upward >= _SIDE - 1) & (upward <= last)]
    if usable.size == 0:
        raise ValueError(
            "the record holds no whole cycle from one forward velocity reversal to the next; "
            "two cycles and a few samples always do"
        )
    in_one_cycle = usable[usable < usable[0] + s.per_cycle - 1.0]
    return int(in_one_cycle[np.argmin(s.x[in_one_cycle])])


def _other_reversal(s: _Signals, n_1: int) -> int:
    """The last sample before the reversal at +X, the only other one of the cycle."""
    forward = s.v[n_1 + 1 : n_1 + round(s.per_cycle)] >= 0.0
    changes = np.flatnonzero(forward[:-1] != forward[1:])
    if changes.size != 1:
        raise _NoOnset(
            f"no single slip onset: the velocity reverses {changes.size + 1} times a cycle"
        )
    return n_1 + 1 + int(changes[0])


def _reversal(s: _Signals, n: int) -> _Instant:
    """The velocity reversal between samples n and n + 1."""
    if not s.between_samples:
        return _Instant(n + 1.0, float(s.x[n + 1]), float(s.v[n + 1]))
    x, v = _continued(s, n - _SIDE + 1, n)
    tau = _root(v, near=s.v[n] / (s.v[n] - s.v[n + 1]))
    return _Instant(n + tau, float(x(tau)), 0.0)


def _onset(s: _Signals, n_reversal: int, n_next: int) -> _Instant:
    """The slip onset between two reversals: where the slope of the acceleration breaks."""
    first = n_reversal + 1
    bend = np.abs(np.diff(s.acceleration[first : n_next + 1], 2))
    if not np.max(bend) > PROMINENCE * np.median(bend):
        raise _NoOnset("no slip onset: the acceleration has no corner")
    corner = first + 1 + int(np.argmax(bend))
    if corner - first < _FEWEST or n_next - corner < _SIDE:
        raise _NoOnset(f"no slip onset read: {corner - first} samples of stick phase are too few")
    if not s.between_samples:
        return _Instant(float(corner), float(s.x[corner]), float(s.v[corner]))
    # The corner sample may belong to either phase, and in a simulation overshoots: neither cubic uses it.
    n = corner - 1
    stick_first = max(first, n - _SIDE + 1)
    stick = _through(s.acceleration, stick_first, n, origin=n)
    slip = _through(s.acceleration, corner + 1, corner + _SIDE, origin=n)
    tau = _root(slip - stick, near=1.0)
    x, v = _continued(s, stick_first, n)
    return _Instant(n + tau, float(x(tau)), float(v(tau)))


def _upward_zero(s: _Signals, n_1: int) -> float:
    """Place of the first upward zero of x after the reversal at −X; NaN when x keeps its sign."""
    x = s.x[n_1 : n_1 + round(s.per_cycle) + 2]
    upward = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    if upward.size == 0:
        return math.nan
    n = n_1 + int(upward[0])
    if not s.between_samples:
        return n + 1.0
    return n + _root(_through(s.x, n - 1, n + 2, origin=n), near=s.x[n] / (s.x[n] - s.x[n + 1]))


def _continued(s: _Signals, first: int, n: int) -> tuple[Polynomial, Polynomial]:
    """x and v of the phase that samples first … n belong to, as polynomials in the steps since n.

    The acceleration through those samples, integrated from x, v at n.
    """
    acceleration = _through(s.acceleration, first, n, origin=n)
    v = s.dt * acceleration.integ() + float(s.v[n])
    return s.dt * v.integ() + float(s.x[n]), v


def _through(signal: Array, first: int, last: int, origin: int) -> Polynomial:
    """The polynomial through samples first … last (both included), in the steps since sample `origin`."""
    steps = np.arange(first - origin, last - origin + 1, dtype=np.float64)
    return Polynomial(np.linalg.solve(np.vander(steps, increasing=True), signal[first : last + 1]))


def _root(polynomial: Polynomial, near: float) -> float:
    """The real root nearest to `near`, if there is one within two steps; else `near` itself."""
    roots = polynomial.trim().roots()
    real = roots.real[np.abs(roots.imag) < 1e-6]
    if real.size == 0:
        return near
    nearest = float(real[np.argmin(np.abs(real - near))])
    return nearest if abs(nearest - near) < 2.0 else near


def integral(f: NDArray[Any], dt: float, start: float, stop: float) -> Any:
    """∫ f dt from place `start` to place `stop`, counted in samples from 0 and not necessarily whole.

    Between whole samples: Simpson's composite rule (an odd number of intervals ends with the three-point rule for
    the last one). The parts of an interval at the two ends: the cubic through the four samples around it. Error
    O(dt⁴) for a smooth f.

    f : samples, real or complex, shape (n ≥ 4,).   dt : s.   Raises ValueError when the range leaves the samples.
    """
    if not 0 <= start <= stop <= f.size - 1:
        raise ValueError(f"range {start:g} … {stop:g} leaves the samples 0 … {f.size - 1}")
    first, last = math.ceil(start), math.floor(stop)
    if last <= first:
        total = dt * _cubic_part(f, start, stop)
    else:
        from scipy.integrate import simpson  # slow to import

        total = simpson(f[first : last + 1], dx=dt)
        total += dt * (_cubic_part(f, start, first) + _cubic_part(f, last, stop))
    return complex(total) if np.iscomplexobj(f) else float(total)


def _cubic_part(f: NDArray[Any], start: float, stop: float) -> Any:
    """∫ of the cubic through the four samples around [start, stop], a range within one or two intervals."""
    if start == stop:
        return 0.0
    first = min(max(math.floor(start) - 1, 0), f.size - 4)
    coefficients = np.linalg.solve(np.vander(np.arange(4.0), increasing=True), f[first : first + 4])
    powers = np.arange(1, 5)
    return coefficients @ (((stop - first) ** powers - (start - first) ** powers) / powers)
