"""The harmonics that an oscillator is fitted to, with their errors and what folds onto them."""

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
from dampbalance.signals.thresholds import CERTAIN
from paper_case import NEAR, PAPER, orbits_at

(ORBIT,) = orbits_at(NEAR, (0.008,))


def of_record(noise: float, start: float = 0.0, seed: int = 1) -> RecordHarmonics:
    taken = {"rate_hz": 2000.0, "cycles": 40.0, "noise": noise, "seed": seed, "start": start}
    return RecordHarmonics.of(condition(measured_orbit(ORBIT, **taken), PAPER.k))


def test_they_are_those_of_the_motion_wherever_the_record_begins():
    for start in (0.0, 0.0317, 0.15):
        lines = of_record(0.0, start)
        assert lines.n.tolist() == list(range(1, 2 * lines.n.size, 2))
        # phases count from the peak of the base; rounding, and the aliases of the harmonics beyond
        off = np.abs(lines.x - ORBIT.harmonics(lines.n.size)) / abs(lines.x[0])
        assert off.max() < 2e-6
        assert abs(lines.Y / 0.008 - 1.0) < 1e-9
        assert abs(lines.omega / (2.0 * math.pi * NEAR) - 1.0) < 1e-9
        assert lines.interval == 5e-4


def test_their_errors_are_those_of_the_scatter():
    read = [of_record(0.01, seed=seed) for seed in range(40)]
    count = min(lines.n.size for lines in read)
    x = np.array([lines.x[:count] for lines in read]) - ORBIT.harmonics(count)
    errors = np.sqrt(np.mean([lines.x_error[:count] ** 2 for lines in read], axis=0))
    scatter = np.sqrt(np.mean(np.abs(x) ** 2 / 2.0, axis=0))
    # small ones, which the phase of the base does not move; 40 draws of two parts know a scatter to 8 %
    np.testing.assert_allclose(scatter[2:], errors[2:], rtol=0.3)
    amplitudes = np.array([lines.Y for lines in read])
    # a scatter of 40 draws is known to 11 %
    assert abs(amplitudes.std() / read[0].Y_error - 1.0) < 0.4
    assert 38 <= read[0].rows <= 42


def test_what_stands_out_of_the_noise_is_clear_and_the_fundamental_always_is():
    x = np.array([0.5, CERTAIN * 1.01, CERTAIN * 0.99, 30.0])
    lines = RecordHarmonics(1.0, 1.0, 0.1, np.arange(1, 8, 2), x.astype(complex), np.ones(4), 10)
    assert lines.clear.tolist() == [True, True, False, True]
    # of x_1 = 0.5 ± 1, and of Y = 1 ± 0.1, once and where it was added to x
    assert lines.relative_error == math.hypot(2.0, 0.1)


# --- beyond half the sampling rate: with a whole number of samples to the cycle, onto the same phases in every cycle -

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
    n = np.array([401, 503])
    for law, close in (({}, 1e-9), ({"c_2": 5.0}, 1e-3)):
        response = steady_response(OSC, BaseMotion(LEVELS[-1], 8.0 * math.pi), law)
        assert response.high_harmonics(n) == pytest.approx(
            response.harmonics(300)[n // 2], rel=close
        )


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
