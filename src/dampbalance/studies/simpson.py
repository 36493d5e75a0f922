"""The rows of the balance by plain Simpson integration of noisy signals, with nothing fitted and nothing filtered.

The velocity is the central difference of the displacement, and each cycle is integrated by Simpson's rule:

    a = ∮ |ẋ| dt        b = ∮ ẋ² dt (7b)        W = ∮ k y ẋ dt (5)

The onset of slip shows in the acceleration, whose noise hides it, and cannot be seen without a model of the motion: a
counts the whole travel, as for a rigid contact. The noise of ẋ has the variance σ²/2dt² where that of x has σ²; it adds
to b, and around the reversals to a, by amounts that no number of cycles lowers.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..signals.cycles import bootstrap
from ..signals.simpson import integrals


def cycle_integrals(y: Array, x: Array, dt: float, omega: float, k: float) -> Array:
    """Return (a, b, W) of every whole cycle, m, m²/s and J, shape (3, cycles).

    y, x : displacements of base and mass, m, (n,), the first cycle beginning with the second sample.   dt : s.
    omega : drive frequency, rad/s.   k : stiffness, N/m.   Raises ValueError when there is no whole cycle.
    """
    v = (x[2:] - x[:-2]) / (2.0 * dt)
    per_cycle = 2.0 * math.pi / (omega * dt)
    cycles = math.floor((v.size - 1) // 2 * 2 / per_cycle)
    if cycles < 1:
        raise ValueError(f"{x.size} samples hold no whole cycle of {per_cycle:.1f} samples")
    places = per_cycle * np.arange(cycles + 1.0)
    return integrals(np.stack([np.abs(v), v**2, k * y[1:-1] * v]), dt, places)


def replicates_of(of_cycles: Array, count: int, rng: np.random.Generator) -> Array:
    """Return bootstrap replicates of the means over the cycles, (…, count), as `mean_harmonics.Reading.resampled` draws
    them.

    of_cycles : a number of each cycle, (…, cycles).
    """
    cycles = of_cycles.shape[-1]
    drawn, stretch = bootstrap(cycles, count, rng)
    mean = of_cycles.mean(axis=-1, keepdims=True)
    return mean + stretch * (of_cycles @ drawn.T / cycles - mean)
