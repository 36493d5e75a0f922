"""Readings of exact responses with noise, and their identification by direct integration alone."""

from __future__ import annotations

import numpy as np

from dampbalance.balance import APPROACHES
from dampbalance.identification.forced import identify_readings
from dampbalance.likelihood.mean_harmonics import read_features
from dampbalance.records.synthetic import measured_orbit
from paper_case import PAPER

DIRECT = {"direct": APPROACHES["direct"]}
THREE = ("base_displacement", "displacement", "acceleration")
"""Channels of a record."""


def read(orbits, *, noise=0.01, seed=1, rate_hz=1000.0, cycles=25.0, channels=THREE[:2]):
    """A reading of each orbit, from a record of any phase named level 1, level 2 …"""
    rng = np.random.default_rng(seed)
    options = {"rate_hz": rate_hz, "cycles": cycles, "noise": noise, "channels": channels}
    return [
        read_features(
            measured_orbit(orbit, seed=rng, start=rng.random(), source=f"level {i + 1}", **options),
            PAPER.k,
        )
        for i, orbit in enumerate(orbits)
    ]


def identified(readings, *, replicates=100, **options):
    """What direct integration finds in readings."""
    return identify_readings(readings, PAPER.k, approaches=DIRECT, replicates=replicates, **options)
