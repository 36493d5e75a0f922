"""Harmonics beyond half the sampling rate, which fold onto others: with a whole number of samples to the cycle, onto
the same phases in every cycle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify_forced, steady_orbit
from dampbalance.motion.law_steady import steady_response
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.record_harmonics import RecordHarmonics

OSC = Oscillator(m=3.1, c=9.0, k=5200.0, K_z=160_000.0, F_k=2.1)
LEVELS = (0.003, 0.005, 0.008, 0.012)


def orbit_at(hertz: float, Y: float = 0.005):
    return steady_orbit(OSC, BaseMotion(Y, 2.0 * math.pi * hertz))


@pytest.mark.parametrize(
    ("quantity", "hertz", "rate", "start"),
    [
        ("acceleration", 4.0, 2000.0, 0.0),
        ("relative_acceleration", 5.0, 2000.0, 0.0317),
        ("velocity", 5.0, 2000.0, 0.2),
        ("displacement", 20.0, 400.0, 0.013),
        # 399 samples to the cycle, onto which 2 × 399 ± n fold
        ("acceleration", 4.0, 1596.0, 0.1),
        # what folds turns in the record, by 1.2 of a turn
        ("acceleration", 4.0, 1999.85, 0.1),
    ],
)
def test_what_is_added_is_that_of_the_exact_motion(quantity, hertz, rate, start):
    orbit = orbit_at(hertz)
    taken = {"rate_hz": rate, "cycles": 33.3, "start": start}
    record = measured_orbit(orbit, channels=("base_displacement", quantity), **taken)
    lines = RecordHarmonics.of(condition(record, OSC.k))
    response = steady_response(OSC, orbit.motion, {})
    added = lines.x - response.harmonics(lines.n.size)
    folded = lines.folds.of(response.high_harmonics(lines.folds.orders))
    assert np.abs(added - folded).max() < 0.1 * np.abs(added).max()


def test_high_harmonics_are_those_of_the_orbit_and_near_them_of_other_motions():
    n = np.array([401, 503, 955, 1601])
    for Y, law, close in (
        (LEVELS[0], {}, 1e-9),
        (LEVELS[-1], {}, 1e-9),
        (0.012, {"c_2": 5.0}, 1e-3),
    ):
        response = steady_response(OSC, BaseMotion(Y, 8.0 * math.pi), law)
        known = n[: 2 if law else 4]
        expected = response.harmonics(300 if law else 900)[known // 2]
        assert response.high_harmonics(known) == pytest.approx(expected, rel=close)


def behind_a_filter(orbit, t: np.ndarray, rate: float) -> np.ndarray:
    """Accelerations behind a filter that takes off all above half the rate."""
    omega = orbit.motion.omega
    n = np.arange(1, math.ceil(math.pi * rate / omega), 2)
    return (
        np.exp(1j * np.outer(omega * t, n)) @ (orbit.harmonics(n.size) * -((n * omega) ** 2))
    ).real


@pytest.mark.parametrize("filtered", [False, True])
def test_the_oscillator_is_found_with_a_filter_and_without(filtered):
    rng, records = np.random.default_rng(5), []
    for i, Y in enumerate(LEVELS):
        orbit = orbit_at(4.0, Y)
        t, motion = 0.0123 * i + np.arange(16_000) / 2000.0, orbit.motion
        x = behind_a_filter(orbit, t, 2000.0) if filtered else orbit.state(t).acceleration
        signals = {"base_acceleration": -(motion.omega**2) * motion.y(t), "acceleration": x}
        channels = [
            Channel(q, t, s + 0.002 * np.sqrt(np.mean(s**2)) * rng.standard_normal(t.size))
            for q, s in signals.items()
        ]
        records.append(Record.of(f"level {i}", channels))
    found = identify_forced(records, stiffness=OSC.k)
    fit = found.basis.common.fit
    assert found.basis.common.clear == ()
    assert abs(fit.value("folded") - (not filtered)) < 4.0 * fit.error("folded") < 0.5
    for symbol in ("F_k", "c", "K_z"):
        low, high = found.intervals[symbol]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        # four standard errors, twice the interval
        assert abs(getattr(OSC, symbol) - middle) < 2.0 * half < 0.01 * middle, symbol
        assert found.verdicts[symbol].verdict == "usable"
