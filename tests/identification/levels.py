"""Records and readings of exact responses with noise, and their identification."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dampbalance.identification.forced import identify_readings
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.mean_harmonics import read_features
from paper_case import PAPER, orbits_at

THREE = ("base_displacement", "displacement", "acceleration")
"""Channels of a record."""
SYMBOLS = ("F_k", "c", "K_z")


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


def identified(readings, **options):
    """What is found in readings."""
    return identify_readings(readings, PAPER.k, **options)


def measured(levels=(0.004, 0.008, 0.012), hz=3.5, osc=PAPER, **options):
    """A record of each level, whose noise has the seed 0, 1 …"""
    options = {"rate_hz": 1000.0, "cycles": 20.0, "noise": 0.01, "channels": THREE[:2]} | options
    orbits = orbits_at(hz, levels, osc)
    return [measured_orbit(orbit, **{"seed": i, **options}) for i, orbit in enumerate(orbits)]


def changed(record, which, /, **changes):
    """The record with another channel of this quantity: other values, another name, a correction."""
    channels = [replace(record[q], **changes) if q == which else record[q] for q in record]
    return Record.of(record.name, channels)


def clipped(record, quantity, part):
    """The record with a channel cut at a part of its peak."""
    values = record[quantity].values
    peak = part * np.abs(values).max()
    return changed(record, quantity, values=np.clip(values, -peak, peak))


def close(found, truth, symbols=SYMBOLS, errors=4.0):
    """Whether numbers of an answer lie within so many standard errors of the truth; four are exceeded by chance once in
    16,000."""
    off = {s: abs(found.values[s] - getattr(truth, s)) for s in symbols}
    return all(off[s] < errors * found.standard_errors[s] for s in symbols)
