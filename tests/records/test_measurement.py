"""Channels and measurements refuse what is not a signal; simulated ones are the exact motion plus the noise asked."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, steady_orbit
from dampbalance.records.channel import Channel, sample_times
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(0.008, OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
T = np.arange(5) / 100.0


def channel(quantity="displacement", t=T, values=None, name="A1"):
    return Channel(quantity, t, np.sin(t) if values is None else values, name)


def test_a_channel_is_read_only_and_leaves_the_array_it_came_from_alone():
    values = np.sin(T)
    made = channel(values=values)
    with pytest.raises(ValueError, match="read-only"):
        made.values[0] = 1.0
    values[0] = 2.0  # still the caller's to write


WRONG = {
    "its quantity must be one of .*, got 'jerk'": {"quantity": "jerk"},
    "4 values at 5 times": {"values": np.zeros(4)},
    "1 samples": {"t": T[:1], "values": T[:1]},
    "value 2 .* is nan": {"values": np.array([0, 1, np.nan, 3, 4.0])},
    "value 1 .* is 1e.16, beyond": {"values": np.array([0, 1e16, 2, 3, 4.0])},
    "time 2 .* is inf": {"t": np.array([0, 1, np.inf, 3, 4.0]), "values": T},
    "not in equal steps: 0 s from sample 1 to 2": {"t": np.array([0, 1, 1, 3, 4.0])},
}


@pytest.mark.parametrize("message", WRONG)
def test_a_channel_that_is_no_signal_is_refused_by_name(message):
    with pytest.raises(ValueError, match=f"channel 'A1'.*{message}"):
        channel(**WRONG[message])


@pytest.mark.parametrize(
    ("quantities", "message"),
    [
        (["force", "base_displacement", "velocity"], "found base_displacement and force"),
        (["force"], "needs a response"),
        (["force", "velocity", "velocity"], "both hold velocity"),
    ],
)
def test_a_measurement_has_one_excitation_at_most_and_a_response(quantities, message):
    with pytest.raises(ValueError, match=f"run7: .*{message}"):
        Record.of("run7", [channel(q, name=f"c{i}") for i, q in enumerate(quantities)])


def test_a_free_decay_has_no_excitation():
    free = Record.of("run7", [channel("displacement")])
    assert not free.driven
    with pytest.raises(ValueError, match=r"run7: needs one excitation .* found none"):
        _ = free.excitation


def test_the_simulated_signals_are_those_of_the_exact_orbit():
    channels = ("force", "displacement", "velocity", "acceleration")
    made = measured_orbit(ORBIT, rate_hz=997.0, cycles=3.5, channels=channels, start=0.7)
    t = made["force"].t
    assert t[0] == 0.7
    assert len(t) == round(3.5 / NEAR * 997.0)
    state = ORBIT.state(t)
    truth = {"displacement": state.x, "velocity": state.v, "acceleration": state.acceleration}
    for quantity, values in truth.items():
        np.testing.assert_array_equal(made[quantity].values, values)
    np.testing.assert_allclose(made["force"].values, PAPER.k * MOTION.y(t), rtol=1e-14)
    assert [c.quantity for c in made.responses] == [*truth]


@pytest.mark.parametrize(
    ("start", "rate_hz"), [(0.1, 1000.0), (0.02, 100.0), (-0.2, 5000.0), (3.0, 500.0)]
)
def test_times_are_the_decimal_numbers_that_they_stand_for(start, rate_hz):
    """0.102 at 1 kHz from 0.1 s on, and not 0.10200000000000001: Python writes the shortest number of each float."""
    at = [round(start * 10_000) + round(10_000 / rate_hz) * i for i in range(3000)]
    assert sample_times(rate_hz, start, 0, 3000).tolist() == [n / 10_000 for n in at]


def test_the_noise_is_white_of_the_size_asked_for_and_the_same_for_the_same_seed():
    options = {"rate_hz": 5000.0, "cycles": 40.0, "channels": ("base_displacement", "velocity")}
    clean = measured_orbit(ORBIT, **options)
    noisy, again = (
        measured_orbit(ORBIT, noise={"velocity": 0.02}, seed=3, **options) for _ in range(2)
    )
    for quantity, one in (("velocity", again), ("base_displacement", clean)):
        np.testing.assert_array_equal(noisy[quantity].values, one[quantity].values)
    added = noisy["velocity"].values - clean["velocity"].values
    size, n = 0.02 * math.sqrt(np.mean(clean["velocity"].values ** 2)), added.size
    # the standard deviation of n normal values scatters by 1/√(2n), its autocorrelation by 1/√n: four sigma each
    assert abs(added.std() / size - 1.0) < 4.0 / math.sqrt(2.0 * n)
    assert abs(np.corrcoef(added[1:], added[:-1])[0, 1]) < 4.0 / math.sqrt(n)
