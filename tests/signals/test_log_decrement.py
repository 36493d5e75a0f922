"""Decays are located by their swing, and its fall gives frequency and damping over the amplitude, without a law."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from dampbalance.signals.bursts import NoDecay, Signal, bursts_of, noise_of
from dampbalance.signals.log_decrement import damping_of
from signals.exact_decays import decay


def noisy(t, values, seed, order=0, noise=2e-3):
    """A channel of these samples with noise, of the largest of them."""
    own = noise * np.abs(values).max() * np.random.default_rng(seed).normal(size=values.size)
    return Signal("", order, t, values + own, noise_of(values + own))


@pytest.mark.parametrize("order", [0, 2])
@pytest.mark.parametrize("samples", [7.13, 60.0])
def test_the_swings_show_the_damping_of_friction_and_damper_at_each_amplitude(order, samples):
    """The ratio of a viscous damper and of friction is ζ + 2F_k/(πkX), to first order."""
    hertz, zeta, stick = 2.8, 0.004, 0.004
    t = np.arange(0.0, 60.0 / hertz, 1.0 / (samples * hertz))
    signal = noisy(t, decay(t, hertz, zeta, stick, order), 1, order)
    rows = damping_of(signal, bursts_of(signal))
    assert rows[0].X > 3.0 * rows[-1].X
    for one in rows:
        truth = zeta + 2.0 * stick / (math.pi * one.X)
        assert one.mode == 1
        assert abs(one.ratio - truth) < 4.0 * one.ratio_error + 0.02 * truth
        assert one.ratio_error < 0.25 * truth
        assert abs(one.hertz - hertz) < 4.0 * one.hertz_error


def test_close_modes_have_damping_of_their_own_and_a_third_harmonic_is_no_mode():
    t = np.arange(0.0, 20.0, 0.005)
    bent = decay(t, 5.0, 0.004, 0.0)
    signal = noisy(t, bent + 0.6 * decay(t, 5.6, 0.006, 0.0), 2)
    rows = damping_of(signal, bursts_of(signal))  # a burst for each beat
    assert {one.mode for one in rows} == {1, 2}
    for one in rows:
        hertz, zeta = ((5.0, 0.004), (5.6, 0.006))[one.mode - 1]
        assert abs(one.hertz - hertz) < 0.01 * hertz
        assert abs(one.ratio - zeta) < 4.0 * one.ratio_error
    signal = noisy(t, bent + 0.8 * bent**3, 3)
    assert {one.mode for one in damping_of(signal, bursts_of(signal))} == {1}


@pytest.mark.parametrize("seed", range(3))
def test_a_fall_of_some_percent_is_a_decay_and_a_settling_or_a_beat_is_none(seed):
    random = np.random.default_rng(seed)
    t = np.arange(0.0, random.uniform(3.5, 12.0), 1.0 / random.uniform(15.0, 60.0))
    part, wave = t / t[-1], np.sin(2.0 * math.pi * t + random.uniform(0.0, 6.0))
    assert len(bursts_of(noisy(t, 0.92**part * wave, seed))) == 1
    for size in (1.0, 1.0 + 0.08 * np.exp(-6.0 * part), 1.0 + 0.03 * np.cos(9.0 * part)):
        with pytest.raises(NoDecay, match="as far at its end"):
            bursts_of(noisy(t, size * wave, seed))


@pytest.mark.parametrize("lag", [0.75, 0.8])
def test_a_second_blow_soon_after_the_first_begins_a_decay(lag):
    """The first decay is there from the first sample on, and the swing is nowhere much smaller before the second."""
    hertz, fall = 2.8, 0.3
    t, blow = np.arange(0.0, 4.0, 1.0 / 420.0), lag / hertz - 0.1
    since = np.maximum([t + 0.1, t - blow], 0.0)
    x = np.array([1.0, 0.5]) @ (np.exp(-fall * since) * np.sin(2.0 * math.pi * hertz * since))
    (burst,) = bursts_of(noisy(t, x, 0, noise=1e-3))
    # both motions add with their phases; the first turn comes within half a cycle, the next one half a cycle later
    size = abs(cmath.exp((2j * math.pi * hertz - fall) * lag / hertz) + 0.5)
    half = math.exp(-0.5 * fall / hertz)
    assert size * (1.0 + half) * half < burst.swing < size * (1.0 + half)
    assert blow < burst.turn < blow + 1.0 / hertz
    assert burst.last
