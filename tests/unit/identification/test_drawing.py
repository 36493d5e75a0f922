"""Pictures of an identification: what is drawn lies where the records are."""

from __future__ import annotations

import math

import numpy as np

from dampbalance import BaseMotion, read_records, steady_orbit
from dampbalance.identification import pictures
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.loading import Loaded, load
from dampbalance.records.measurement import Channel, Measurement
from dampbalance.records.synthetic import measured_orbit
from paper_case import PAPER


def _loaded(Y: float, zero: float) -> Loaded:
    """A record whose transducer of displacement has a zero of its own, m."""
    orbit = steady_orbit(PAPER, BaseMotion(Y=Y, omega=2.0 * math.pi * 3.5))
    made = measured_orbit(orbit, rate_hz=1000.0, cycles=20.0, noise=1e-4, seed=1)
    x = made["displacement"]
    channels = [made["base_displacement"], Channel(x.quantity, x.t, x.values + zero)]
    measurement = Measurement.of(str(Y), channels)
    return load(read_records(measurement)[0], PAPER.k)


def test_the_averaged_cycle_lies_on_the_samples_whatever_the_zero_of_the_transducer():
    loaded = [_loaded(0.003, 0.0), _loaded(0.005, 0.02)]
    result = identify_readings([one.reading for one in loaded], PAPER.k, replicates=20)
    for one, axes in zip(loaded, pictures.cycles(loaded, result.readings).axes, strict=True):
        dots, line = axes.get_lines()
        on_line = np.interp(dots.get_xdata(), line.get_xdata(), line.get_ydata(), period=360.0)
        X = 1e3 * one.reading.features.X[0]
        # half a degree between the points of the line, and the noise
        np.testing.assert_allclose(dots.get_ydata(), on_line, atol=1e-3 * X)
