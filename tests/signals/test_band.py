"""The band about a mode against SciPy's analogue and digital Butterworth filters, sines and white noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from dampbalance.signals.band import NOISE_PASSED, Band, filtered, freedom

DT = 1e-3
BAND = Band.about(5.0, DT)
T = DT * np.arange(8000)


def test_corners():
    assert (BAND.low, BAND.high) == pytest.approx((1.75, 13.0))
    assert Band.about(5.0, 1.0 / 30.0).high == pytest.approx(12.0)
    with pytest.raises(ValueError, match="too few for a mode at 5 Hz"):
        Band.about(5.0, 0.1)
    with pytest.raises(ValueError, match="low < high"):
        Band(2.0, 2.0)


def test_the_gain_is_that_of_an_analogue_butterworth_run_twice():
    f = np.geomspace(0.01, 400.0, 300)
    poles = signal.butter(3, [BAND.low, BAND.high], "bandpass", analog=True)
    _, response = signal.freqs(*poles, worN=f)
    np.testing.assert_allclose(BAND.gain(f), np.abs(response) ** 2, rtol=1e-9)


@pytest.mark.parametrize("frequency", [2.0, 5.0, 12.5])
def test_a_sine_keeps_its_phase_and_has_the_gain_at_its_frequency(frequency):
    # whole half cycles, so that the mirror image goes on smoothly: exact up to rounding
    wave = np.cos(2.0 * np.pi * frequency * (T + 0.5 * DT))
    gain = BAND.gain(np.array(frequency))
    np.testing.assert_allclose(filtered(wave, DT, BAND), gain * wave, atol=1e-12)
    # of any other start: away from the ends by three periods of the lower corner, 1e-3
    wave = np.sin(2.0 * np.pi * frequency * T + 0.7)
    inner = slice(1714, -1714)
    np.testing.assert_allclose(filtered(wave, DT, BAND)[inner], (gain * wave)[inner], atol=1e-3)


def test_it_agrees_with_scipy_forwards_and_back():
    rng = np.random.default_rng(44)
    # the digital filter is warped by the sampling, here by π²/3 (13 Hz/1000 Hz)² = 6e-4
    noise = rng.standard_normal(T.size)
    sections = signal.butter(3, [BAND.low, BAND.high], "bandpass", output="sos", fs=1.0 / DT)
    mirrored = np.pad(noise, T.size, mode="symmetric")
    theirs = signal.sosfiltfilt(sections, mirrored, padtype=None)[T.size : -T.size]
    ours = filtered(noise, DT, BAND)
    np.testing.assert_allclose(ours, theirs, atol=2e-3 * np.std(theirs))


def test_it_is_linear_along_the_first_axis_and_takes_offsets_away():
    rng = np.random.default_rng(44)
    several = rng.standard_normal((500, 2, 3))
    whole = filtered(several, DT, BAND)
    np.testing.assert_allclose(filtered(several[:, 1, 2], DT, BAND), whole[:, 1, 2], atol=1e-14)
    sums = filtered(several @ np.array([1.0, -2.0, 0.5]) + 7.0, DT, BAND)
    np.testing.assert_allclose(sums, whole @ np.array([1.0, -2.0, 0.5]), atol=1e-12)


def test_the_start_of_a_decay_stays_where_it_is():
    # a decay from a turn: the mirror image goes on like the motion, so that the first swing is as large as later ones
    decay = np.exp(-0.3 * T) * np.cos(2.0 * np.pi * 5.0 * T)
    ratio = filtered(decay, DT, BAND)[:4000:200] / decay[:4000:200]
    assert np.ptp(ratio) < 0.01  # the gain at 5 Hz with a kink of 0.3/(2π · 5) = 1 % in the slope


def test_the_noise_and_its_freedom():
    rng = np.random.default_rng(44)
    sigma, sizes = 0.3, []
    for _ in range(400):
        noise = filtered(sigma * rng.standard_normal(1000), DT, BAND)
        sizes.append(np.sum(noise**2) / (NOISE_PASSED * freedom(BAND, 1.0)))
    expected = freedom(BAND, 1.0)
    assert expected == pytest.approx(22.5)
    # relative variance 2/n of a variance with n degrees of freedom; five standard errors
    assert np.mean(sizes) == pytest.approx(sigma**2, rel=5.0 * np.sqrt(2.0 / expected / 400))
    assert 2.0 * sigma**4 / np.var(sizes) == pytest.approx(expected, rel=5.0 * np.sqrt(2.0 / 400))
