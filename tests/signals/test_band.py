"""The band about a mode against SciPy's analogue Butterworth filter, sines and white noise."""

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
        Band.about(5.0, 0.08)  # the corner is at the mode


def test_the_gain_is_that_of_an_analogue_butterworth_run_twice():
    f = np.geomspace(0.01, 400.0, 300)
    poles = signal.butter(3, [BAND.low, BAND.high], "bandpass", analog=True)
    np.testing.assert_allclose(BAND.gain(f), np.abs(signal.freqs(*poles, f)[1]) ** 2, rtol=1e-9)


@pytest.mark.parametrize("frequency", [2.0, 5.0, 12.5])
def test_a_sine_keeps_its_phase_and_has_the_gain_at_its_frequency(frequency):
    # whole half cycles, so that the mirror image goes on smoothly: exact up to rounding; offsets vanish
    wave = np.cos(2.0 * np.pi * frequency * (T + 0.5 * DT))
    of_both = filtered(np.column_stack([wave, 7.0 - 2.0 * wave]), DT, BAND)
    gain = BAND.gain(np.array(frequency))
    np.testing.assert_allclose(of_both, gain * np.outer(wave, [1.0, -2.0]), atol=1e-12)


def test_the_noise_and_its_freedom():
    sigma, expected = 0.3, freedom(BAND, 1.0)
    assert expected == pytest.approx(22.5)
    noise = filtered(sigma * np.random.default_rng(44).standard_normal((1000, 400)), DT, BAND)
    sizes = np.sum(noise**2, axis=0) / (NOISE_PASSED * expected)
    # relative variance 2/n of a variance with n degrees of freedom; five standard errors
    assert np.mean(sizes) == pytest.approx(sigma**2, rel=5.0 * np.sqrt(2.0 / expected / 400))
    assert 2.0 * sigma**4 / np.var(sizes) == pytest.approx(expected, rel=5.0 * np.sqrt(2.0 / 400))
