"""Whether the friction force of a record changes from its first cycle to its last.

Intervals by the bootstrap take the cycles of a record to be alike: where the force drifts, they hold for its mean over
the record, and neither for the force at its beginning nor for that at its end.

A delay between base and response that grows, as between two clocks, looks like such a drift, and the other way round:
where the mass stops at its turns, a friction force that grows delays all harmonics of the response nearly alike, and
its amplitude hardly changes. The conditioning of records takes such a delay for two clocks and corrects it
(`reading.checks.clock`); `as_recorded` puts it back. Two clocks differ alike in all records of a rig.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Array
from ...balance import APPROACHES
from ...features import Features
from ...identification.remarks import DIRECT
from ...law.terms import FRICTION
from ...reading.mean_harmonics import Reading


@dataclass(frozen=True)
class Drift:
    """The straight line through forces at equal steps.

    slope, error : per step, and its standard error, N.
    p : probability of a slope as large as this if there were none, by Student's t.
    significant : whether p is small enough where several such tests are made together.
    reach : half the width of the interval about the middle of the line, N.
    steps : number of forces.
    """

    slope: float
    error: float
    p: float
    significant: bool
    reach: float
    steps: int

    @property
    def over_record(self) -> float:
        """By how much the line rises from the first force to the last, N."""
        return self.slope * (self.steps - 1)


def as_recorded(reading: Reading, since: float) -> Reading:
    """The reading without the correction for two clocks, which started together at the time `since`, s."""
    steady = reading.steady
    faster = [part for part, _ in steady.gathered.clocks.values()]
    if not faster:
        return reading
    rows, orders = steady.X.shape
    period = 2.0 * math.pi / steady.omega
    at = steady.start - since + (np.arange(rows) + 0.5) * steady.cycles_per_row * period
    turn = steady.omega * float(np.mean(faster)) * np.outer(at, np.arange(orders))
    return replace(reading, steady=replace(steady, X=steady.X * np.exp(-1j * turn)))


def friction_of_rows(reading: Reading, others: Mapping[str, float]) -> Array:
    """The friction force in each row (a cycle, or several) of a record by direct integration, N, (rows,).

    others : coefficients of the terms other than friction, by symbol; the reading has their integrals.

    The forces are pseudo-values of the jackknife, n F − (n − 1) F₋ᵢ: the levels of the rests are read off a mean of
    n − 1 cycles, as they are off all of them, and not off a single noisy cycle.
    """

    def friction(features: Features) -> Array:
        rows = APPROACHES[DIRECT](features, reading.steady.k, (FRICTION, *others))
        work = np.sum([p * rows.terms[symbol] for symbol, p in others.items()], axis=0)
        return np.asarray((rows.W - work) / rows.terms[FRICTION])

    left = friction(reading.features_of(reading.left_out()))
    return left.size * friction(reading.features) - (left.size - 1) * left


def drift(forces: Array, confidence: float, tests: int) -> Drift:
    """The straight line through forces, (n,) with n ≥ 3, by least squares.

    confidence : of the interval, and of so many `tests` together, each at (1 − confidence)/tests (Bonferroni).
    """
    from scipy import special  # slow to import

    step = np.arange(forces.size) - 0.5 * (forces.size - 1)
    slope = float(step @ forces / (step @ step))
    off, freedom = forces - forces.mean() - slope * step, forces.size - 2
    scatter = math.sqrt(float(off @ off) / freedom)
    error = scatter / math.sqrt(float(step @ step))
    p = 2.0 * float(special.stdtr(freedom, -abs(slope) / error)) if error > 0.0 else 1.0
    quantile = float(special.stdtrit(freedom, 0.5 + 0.5 * confidence))
    reach = quantile * scatter / math.sqrt(forces.size)
    return Drift(slope, error, p, p < (1.0 - confidence) / tests, reach, forces.size)
