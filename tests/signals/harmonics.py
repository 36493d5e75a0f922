"""Harmonics of exact orbits, with noise of a given size: what a record with that noise would give."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dampbalance import Orbit
from dampbalance.fit.steady_search import fit_records
from dampbalance.signals.mean_harmonics import Reading
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


def with_own_fit(reading: Reading) -> Reading:
    """The reading with the waveform that is fitted to its record alone; without one where none fits."""
    fit = fit_records([reading.lines], reading.steady.k)
    return (
        reading if fit is None or not fit.adequate else replace(reading, waveform=fit.waveforms[0])
    )
