"""Features of a clean sampled record, read as from the plots of acceleration against x, v and t.

Use this reader for simulated records without noise. The acceleration separates the phases: at the onset of slip its
slope breaks (the corner of Figure 3) because the contact spring stops following the mass from one instant to the next.
At a reversal, where v = 0, it does not break.

Two ways to read an event:

    "sample"        the first sample at or after the event: what one picks off a listing
    "interpolated"  between samples: the phase that ends at the event is extrapolated, by the cubic through its last
                    four accelerations, to v = 0, or to its intersection with the next phase, extrapolated backwards

The interpolated reading of an exact record converges to the exact features: see `tests/method/test_features.py`. The
second difference of a noisy acceleration is useless: `mean_harmonics.py` reads noisy records.
"""

from __future__ import annotations

import cmath
import math
from typing import Literal, get_args

import numpy as np

from ..arguments import one_of
from ..arrays import Array
from ..features import Features, of_numbers
from ..motion.integrals import wrapped
from ..motion.regime import Regime
from .record import SimulatedRecord
from .sampled import LATE, NO_CORNER, NO_CYCLE, REVERSALS, SHORT_STICK, integral, read_cycle

ReadAt = Literal["interpolated", "sample"]
"""Ways to locate an event: between samples, or at the first sample after it."""

CYCLES_TO_READ = 3
"""Periods that a record of a steady response needs: one to wait for the reversal, one to read, one for the lock-in."""

_TROUBLES = {
    REVERSALS: "no single slip onset: the velocity reverses {} times a cycle",
    NO_CORNER: "no slip onset: the acceleration has no corner",
    SHORT_STICK: "no slip onset read: {} samples of stick phase are too few",
    LATE: "no friction travel read: {} samples after slip onset x has reversed",
}


def of_record(
    record: SimulatedRecord,
    omega: float,
    k: float,
    reading: ReadAt = "interpolated",
    slip_samples: int = 1,
) -> Features:
    """Return features of one steady response, read off a clean record of y, x, v and acceleration.

    Choose "interpolated" for the features of the motion itself, and "sample" to reproduce values picked off a listing.
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
    X_s … t_r and a are NaN and the regime says why. Raises ValueError for a record without a whole cycle from reversal
    to reversal, or without base motion at ω.
    """
    one_of("reading", reading, get_args(ReadAt))
    if not omega > 0.0:
        raise ValueError(f"omega must be positive, got {omega!r} rad/s")
    t0, dt, between = float(record.t[0]), record.dt, reading == "interpolated"
    per_cycle = 2.0 * math.pi / (omega * dt)
    cycle = read_cycle(record.signals, t0, dt, omega, k, between, slip_samples)
    if cycle.trouble == NO_CYCLE:
        raise ValueError(
            "the record holds no whole cycle from one forward velocity reversal to the next; "
            "two cycles and a few samples always do"
        )

    def lock_in(signal: Array, n: int) -> complex:
        """Return X_n e^{−iφ_n} of the signal over all whole cycles from the reversal on."""
        duration = per_cycle * math.floor((signal.size - 1 - cycle.start) / per_cycle)
        first = math.floor(cycle.start)
        kept = signal[first : math.ceil(cycle.start + duration) + 1]
        turns = np.exp(-1j * n * omega * (t0 + dt * (first + np.arange(kept.size))))
        begin = cycle.start - first
        return complex(2.0 * integral(kept * turns, 1.0, begin, begin + duration) / duration)

    base = lock_in(record.y, 1)
    if not abs(base) > 0.0:
        raise ValueError(f"the base does not move at ω = {omega:g} rad/s: y has no fundamental")
    lag = -cmath.phase(base)  # y lags cos ωt by it; zero in a simulation
    harmonics = {n: lock_in(record.x, n) for n in (1, 3, 5)}
    numbers = cycle._asdict()
    trouble, how_many, _ = (numbers.pop(name) for name in ("trouble", "how_many", "start"))
    phases = {"phi": cycle.phi, "phi_zero_crossing": cycle.phi_zero_crossing}
    phases |= {"phi_reversal": cycle.phi, "phi_fundamental": -cmath.phase(harmonics[1])}
    numbers |= {name: wrapped(phase - lag) for name, phase in phases.items()}
    numbers |= {"Y": abs(base)} | {f"X_{n}": abs(x_n) for n, x_n in harmonics.items()}
    regime = _TROUBLES[trouble].format(how_many) if trouble else str(Regime.ONE_SLIP)
    return of_numbers(omega, regime, **numbers)
