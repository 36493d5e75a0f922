"""Frequency and damping over the amplitude follow from the swings of a decay, without a law."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.signals.bursts import NoDecay, Signal, bursts_of, noise_of
from dampbalance.signals.log_decrement import damping_of
from signals.exact_decays import decay

NOISE = 2e-3  # of the largest sample


def rows_of(t, values, order=0):
    """The damping in ranges of the amplitude of these samples, which hold one decay."""
    signal = Signal("", order, t, values, noise_of(values))
    (burst,) = bursts_of(signal)
    return damping_of(signal, [burst])


def noisy(values, seed):
    return values + NOISE * np.abs(values).max() * np.random.default_rng(seed).normal(
        size=values.size
    )


@pytest.mark.parametrize("order", [0, 2])
@pytest.mark.parametrize("samples", [7.13, 60.0])
def test_the_swings_show_the_damping_of_friction_and_damper_at_each_amplitude(order, samples):
    """The ratio of a viscous damper and of friction is ζ + 2F_k/(πkX), to first order."""
    hertz, zeta, stick = 2.8, 0.004, 0.004
    t = np.arange(0.0, 60.0 / hertz, 1.0 / (samples * hertz))
    rows = rows_of(t, noisy(decay(t, hertz, zeta, stick, order), 1), order)
    assert len(rows) > 2
    assert rows[0].X > 3.0 * rows[-1].X
    assert {one.mode for one in rows} == {1}
    for one in rows:
        truth = zeta + 2.0 * stick / (math.pi * one.X)
        assert abs(one.ratio - truth) < 4.0 * one.ratio_error + 0.02 * truth
        assert one.ratio_error < 0.25 * truth
        assert abs(one.hertz - hertz) < 4.0 * one.hertz_error


def test_close_modes_have_damping_of_their_own_and_a_third_harmonic_is_no_mode():
    t = np.arange(0.0, 20.0, 0.005)
    both = decay(t, 5.0, 0.004, 0.0) + 0.6 * decay(t, 5.6, 0.006, 0.0)
    values = noisy(both, 2)
    signal = Signal("", 0, t, values, noise_of(values))
    rows = damping_of(signal, bursts_of(signal))  # a burst for each beat
    for mode, hertz, zeta in ((1, 5.0, 0.004), (2, 5.6, 0.006)):
        own = [one for one in rows if one.mode == mode]
        assert own
        for one in own:
            assert abs(one.hertz - hertz) < 0.01 * hertz
            assert abs(one.ratio - zeta) < 4.0 * one.ratio_error
    bent = decay(t, 5.0, 0.004, 0.0)
    assert {one.mode for one in rows_of(t, noisy(bent + 0.8 * bent**3, 3))} == {1}


@pytest.mark.parametrize("seed", range(3))
def test_a_fall_of_some_percent_is_a_decay_and_a_settling_or_a_beat_is_none(seed):
    random = np.random.default_rng(seed)
    t = np.arange(0.0, random.uniform(3.5, 12.0), 1.0 / random.uniform(15.0, 60.0))
    part, wave = t / t[-1], np.sin(2.0 * math.pi * t + random.uniform(0.0, 6.0))

    def bursts(size):
        values = noisy(size * wave, seed)
        return bursts_of(Signal("", 0, t, values, noise_of(values)))

    assert len(bursts(0.92**part)) == 1
    for size in (1.0, 1.0 + 0.08 * np.exp(-6.0 * part), 1.0 + 0.03 * np.cos(9.0 * part)):
        with pytest.raises(NoDecay):
            bursts(size)


@pytest.mark.parametrize("samples", [7.3, 11.9, 19.3])
def test_a_long_decay_of_few_samples_a_cycle_is_one_burst(samples):
    t = np.arange(0.0, 2000.0, 1.0 / samples)
    assert rows_of(t, noisy(decay(t, 1.0, 3e-4, 1e-5), 4))
