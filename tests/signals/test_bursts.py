"""Free decays are located in a record by their swing."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from dampbalance.signals.bursts import Signal, bursts_of

F_N, RATE, FALL, NOISE = 2.8, 420.0, 0.3, 1e-3  # Hz, samples per second, 1/s, m


def after(t, blow):
    """The displacement after a blow that makes a swing of ± 1 m, in exact motion of a linear oscillator."""
    since = np.maximum(t - blow, 0.0)
    return np.exp(-FALL * since) * np.sin(2.0 * math.pi * F_N * since)


@pytest.mark.parametrize("lag", [0.75, 0.8])
def test_a_second_blow_soon_after_the_first_begins_a_decay(lag):
    """The first decay is there from the first sample on, and the swing is nowhere much smaller before the second."""
    t, blow = np.arange(0.0, 4.0, 1.0 / RATE), lag / F_N - 0.1
    x = after(t, -0.1) + 0.5 * after(t, blow)
    x += NOISE * np.random.default_rng(0).standard_normal(t.size)
    (burst,) = bursts_of(Signal("displacement", 0, t, x, NOISE))
    # both motions add with their phases; the first turn comes within half a cycle, the next one half a cycle later
    size = abs(cmath.exp((2j * math.pi * F_N - FALL) * lag / F_N) + 0.5)
    low, high = (
        size * (1.0 + math.exp(-FALL * 0.5 / F_N)) * fall
        for fall in (math.exp(-FALL * 0.5 / F_N), 1.0)
    )
    assert low < burst.swing < high
    assert blow < burst.turn < blow + 1.0 / F_N
