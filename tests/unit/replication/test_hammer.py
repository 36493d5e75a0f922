"""The damping of a mode from its decay, against decays with a closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.replication.beam.hammer import filter_bias, modal_decay

BAND = (60.0, 110.0)
WINDOWS = {"start": 0.25, "window": 0.2}
OMEGA = 2.0 * math.pi * 80.0
T = np.arange(0.0, 5.0, 1.0 / 12_800.0)


def decay(zeta_0: float, slope: float, X_0: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration and amplitude of Ẋ = −(ζ_0 + slope·X) ω X from X_0 on:
    X = ζ_0 X_0 e^{−ζ_0 ωt}/(ζ_0 + slope·X_0 (1 − e^{−ζ_0 ωt}))."""
    gone = np.exp(-zeta_0 * OMEGA * T)
    X = zeta_0 * X_0 * gone / (zeta_0 + slope * X_0 * (1.0 - gone))
    return OMEGA**2 * X * np.sin(OMEGA * T), X


def test_a_viscous_mode_has_one_damping_ratio_and_its_frequency():
    acceleration, X = decay(1.5e-3, 0.0)
    found = modal_decay(T, acceleration, BAND, **WINDOWS)
    # The filter has forgotten the blow where a fifth of a second has passed, to 0.3 % of the damping.
    assert found.zeta == pytest.approx(1.5e-3, rel=3e-3)
    # the end of the record, where the filter runs out, moves the phase
    assert found.frequency_hz == pytest.approx(80.0, rel=5e-5)
    # the mean of ln X over a window is that at its middle
    assert pytest.approx(np.interp(found.t, T, X), rel=1e-3) == found.X


def test_damping_that_grows_with_the_amplitude_is_followed():
    acceleration, _ = decay(1e-3, 12.0)
    found = modal_decay(T, acceleration, BAND, **WINDOWS)
    # A window in which X falls by 10 % sees the mean over it: 1 %.
    assert found.zeta == pytest.approx(1e-3 + 12.0 * found.X, rel=1e-2)
    assert found.zeta[0] > 1.5 * found.zeta[-1]


def test_another_mode_and_the_blow_are_left_out():
    acceleration, _ = decay(1.5e-3, 0.0)
    other = 400.0 * np.exp(-3.0 * T) * np.sin(2.0 * math.pi * 297.7 * T)
    found = modal_decay(T, acceleration + other, BAND, **WINDOWS)
    assert found.zeta == pytest.approx(1.5e-3, rel=3e-3)


def test_the_bias_of_the_filter_is_what_it_makes_of_known_damping():
    acceleration, _ = decay(1e-3, 12.0)
    found = modal_decay(T, acceleration, BAND, **WINDOWS)
    off = filter_bias(found, T, BAND, **WINDOWS)
    assert np.abs(off[1:-1]).max() < 0.01
    # Too early, while the filter still rings with the blow, it is far larger, and says so.
    early = {"start": 0.0, "window": 0.02}
    hasty = modal_decay(T, acceleration, BAND, **early)
    assert np.abs(filter_bias(hasty, T, BAND, **early)[:2]).max() > 0.1


@pytest.mark.parametrize(
    ("band", "start", "window", "message"),
    [
        ((60.0, 7000.0), 0.25, 0.2, "half the sampling rate, 6400 Hz"),
        (BAND, 4.7, 0.2, "no two windows of 0.2 s after 4.7 s: shorten window_s or start_s"),
        # no sample, one sample, and a cycle of 60 Hz less a little
        (BAND, 0.25, 1e-6, "window_s must be a cycle .* at least, 0.0167 s, .* got 1e-06"),
        (BAND, 0.25, 8e-5, "window_s must be a cycle"),
        (BAND, 0.25, 0.0166, "window_s must be a cycle"),
    ],
)
def test_what_cannot_be_done_is_refused(band, start, window, message):
    with pytest.raises(ValueError, match=message):
        modal_decay(T, decay(1e-3, 0.0)[0], band, start=start, window=window)
