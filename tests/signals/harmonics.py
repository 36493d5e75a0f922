"""Harmonics of exact orbits, with noise of a given size: what a record with that noise would give."""

from __future__ import annotations

import numpy as np

from dampbalance import Orbit
from dampbalance.signals.record_harmonics import RecordHarmonics


def lines_of(
    orbit: Orbit,
    error: float,
    rng: np.random.Generator | None = None,
    *,
    count: int = 12,
    late: float = 0.0,
    rows: int = 50,
) -> RecordHarmonics:
    """The first `count` odd harmonics of an orbit and its base, each part with a standard deviation `error`, m.

    rng : noise of that size is added.   late : by how much the response lags in the record, s.
    """
    omega, Y = orbit.motion.omega, orbit.motion.Y
    n = np.arange(1, 2 * count, 2)
    x, turned = orbit.harmonics(count) * np.exp(-1j * n * omega * late), 0.0
    if rng is not None:
        x = x + error * (rng.standard_normal(count) + 1j * rng.standard_normal(count))
        turned = error / Y * rng.standard_normal()
        Y = Y + error * rng.standard_normal()
    return RecordHarmonics(
        omega, Y, error, n, x * np.exp(-1j * n * turned), np.full(count, error), rows
    )
