"""Accelerations whose harmonics fold back: freed of them the oscillator is the true one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.likelihood.base_harmonics import fit_records
from dampbalance.likelihood.mean_harmonics import read_features
from dampbalance.likelihood.unfolding import unfolded
from dampbalance.records.measurement import Channel, Correction, Measurement
from dampbalance.records.synthetic import measured_orbit

STIFF = Oscillator(m=2.42, c=15.0, k=2310.0, K_z=125.0 * 2310.0, F_k=1.28)
OMEGA, LEVELS, CYCLES = 40.0, (0.003, 0.006, 0.012), 80
POINTS = 8192


def records(samples, noise=1e-3, seed=5, highest=math.inf, poles=()):
    """Base displacement and acceleration with so many samples to the cycle.

    highest : harmonic beyond which an anti-alias filter without delay passes nothing.   poles : of a low-pass filter
    that the mapping names, rad/s.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(int(samples * CYCLES) + 2) * (2.0 * math.pi / (OMEGA * samples))
    n = np.arange(POINTS // 2 + 1)
    correction = Correction(low_pass=poles) if poles else None
    readings = []
    for level, Y in enumerate(LEVELS):
        orbit = steady_orbit(STIFF, BaseMotion(Y, OMEGA))
        cycle = orbit.state(np.arange(POINTS) * (orbit.motion.period / POINTS)).acceleration
        spectrum = np.where(n <= highest, np.fft.rfft(cycle), 0.0)
        if correction is not None:
            spectrum = spectrum * correction.response(n * OMEGA)
        fine = np.fft.irfft(spectrum, 16 * POINTS) * 16.0
        a = np.interp(
            np.mod(OMEGA * t, 2.0 * math.pi),
            np.arange(fine.size + 1) * (2.0 * math.pi / fine.size),
            np.append(fine, fine[0]),
        )
        y = Y * np.cos(OMEGA * t)
        a, y = (s + noise * s.std() * rng.standard_normal(t.size) for s in (a, y))
        channels = [
            Channel("base_displacement", t, y),
            Channel("acceleration", t, a, correction=correction),
        ]
        readings.append(read_features(Measurement.of(f"level {level}", channels), STIFF.k))
    return readings


def lines(readings):
    return [reading.lines for reading in readings]


@pytest.mark.parametrize("samples", [100.0, 100.37])
@pytest.mark.parametrize("poles", [(), (-3000.0 + 0j,)])
def test_freed_records_are_those_of_the_true_oscillator(samples, poles):
    readings = records(samples, poles=poles)
    freed, fit = unfolded(readings, STIFF.k)
    assert fit is not None
    assert fit.adequate
    for name, true in (("F_k", STIFF.F_k), ("c", STIFF.c), ("rho", STIFF.K_z**-0.5)):
        assert abs(fit.value(name) - true) < 4.0 * fit.error(name), name
    assert all(reading.steady.unfolded for reading in freed)


@pytest.mark.parametrize("corner", [5.0, 7.0])
def test_a_low_pass_of_the_mapping_that_ends_before_the_harmonics_that_are_fitted(corner):
    # Butterworth, of order 8 and a corner at so many times the drive: of harmonic 25, the last, 10⁻⁶ and 10⁻⁵ pass
    poles = corner * OMEGA * np.exp(1j * math.pi * (2 * np.arange(8) + 9) / 16)
    readings = records(100.37, poles=tuple(poles))
    assert readings[0].steady.X.shape[1] < 26
    assert unfolded(readings, STIFF.k) == (readings, None)
    fit = fit_records(lines(readings), STIFF.k)
    assert fit is not None
    assert fit.adequate
    for name, true in (("F_k", STIFF.F_k), ("c", STIFF.c), ("rho", STIFF.K_z**-0.5)):
        assert abs(fit.value(name) - true) < 4.0 * fit.error(name), name


def test_what_folds_back_differently_in_each_cycle_no_longer_counts_as_noise():
    readings = records(100.37)
    freed, fit = unfolded(readings, STIFF.k)
    assert fit is not None
    for before, after in zip(readings, freed, strict=True):
        # white noise of 1e-3 of the rms: the mean of harmonic n has that times √(2/samples), over (nω)²
        rms = after.steady.noise_rms["acceleration"]
        a = before.steady.gathered.channels["acceleration"].span / 2.0
        assert rms == pytest.approx(1e-3 * a / math.sqrt(2.0), rel=0.15)
        assert before.steady.noise_rms["acceleration"] > 1.2 * rms
    raw = fit_records(lines(readings), STIFF.k)
    assert raw is not None
    assert fit.error("rho") < 0.9 * raw.error("rho")


@pytest.mark.parametrize("samples", [100.0, 100.37])
def test_records_behind_a_filter_that_nobody_names_stay_as_they_are(samples):
    readings = records(samples, highest=0.5 * samples)
    freed, _ = unfolded(readings, STIFF.k)
    assert not any(reading.steady.unfolded for reading in freed)


def test_displacements_need_nothing():
    orbit = steady_orbit(STIFF, BaseMotion(0.006, OMEGA))
    record = measured_orbit(
        orbit, rate_hz=100.37 * OMEGA / (2.0 * math.pi), cycles=50.0, noise=1e-3, seed=1
    )
    readings = [read_features(record, STIFF.k)]
    assert unfolded(readings, STIFF.k) == (readings, None)
