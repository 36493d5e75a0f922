"""What a channel does to its signal, given in the mapping, is taken off its harmonics exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from dampbalance import BaseMotion, steady_orbit
from dampbalance.records.channel import Channel
from dampbalance.records.errors import RecordError
from dampbalance.records.mapping import mapping_from
from dampbalance.records.record import Record
from dampbalance.records.writers import write
from dampbalance.signals.conditioning import condition
from paper_case import OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
ORDERS = np.array([1, 3, 5])
HARMONICS = ORBIT.harmonics(3)
RATES = {"displacement": 0, "base_displacement": 0, "velocity": 1, "acceleration": 2}
T = np.arange(0.0, 20.0 * MOTION.period, 1.0 / 2000.0)


def _butterworth(order, corner_hz, kind):
    """H(iω) of SciPy's analog filter."""
    b, a = signal.butter(order, 2.0 * math.pi * corner_hz, kind, analog=True)
    return lambda omega: signal.freqs(b, a, omega)[1]


def _poles(zeros, poles):
    """H(iω) of a filter of these zeros and poles (rad/s), of gain 1 at ω = 0 or, with zeros, at infinity."""
    gain = 1.0 if zeros else np.prod(-np.array(poles)).real
    return lambda omega: signal.freqs_zpk(zeros, poles, gain, omega)[1]


def _channel(quantity, told, response=np.ones_like, drift=0.0):
    """A channel with this H(iω) that the mapping tells so of."""
    other = "displacement" if quantity == "base_displacement" else "force"
    rules = {quantity: {"channel": 1, **told}, other: {"channel": 2}}
    correction = mapping_from({"channels": rules}).channels[quantity].correction
    amplitudes = np.array([MOTION.Y]) if quantity == "base_displacement" else HARMONICS
    n = ORDERS[: amplitudes.size]
    c = amplitudes * (1j * n * OMEGA) ** RATES[quantity] * response(n * OMEGA)
    samples = (np.exp(1j * np.outer(T, n) * OMEGA) @ c).real + drift
    return Channel(quantity, T, samples, quantity, correction)


def _conditioned(displacement: Channel):
    return condition(Record.of("x", [_channel("base_displacement", {}), displacement]), PAPER.k)


CORRECTED = [
    ("displacement", {"delay": 2e-4}, lambda w: np.exp(-2e-4j * w)),
    ("velocity", {"delay": "-1.5 ms"}, lambda w: np.exp(1.5e-3j * w)),
    ("acceleration", {"gain": 1.02}, lambda w: np.full(w.shape, 1.02 + 0j)),
    ("displacement", {"high_pass": {"corner_hz": 0.5}}, _butterworth(1, 0.5, "high")),
    ("acceleration", {"high_pass": {"corner_hz": 1.5, "order": 4}}, _butterworth(4, 1.5, "high")),
    ("displacement", {"low_pass": {"corner_hz": 100, "order": 5}}, _butterworth(5, 100.0, "low")),
    (
        "velocity",
        {"low_pass": {"poles_rad_per_s": [-300, [-200.0, 150.0]]}},
        _poles([], [-300.0, -200.0 + 150.0j, -200.0 - 150.0j]),
    ),
    (
        "displacement",
        {"high_pass": {"poles_rad_per_s": [-3.0, [-1.0, 2.0]]}},
        _poles([0.0, 0.0, 0.0], [-3.0, -1.0 + 2.0j, -1.0 - 2.0j]),
    ),
]


@pytest.mark.parametrize(("quantity", "told", "response"), CORRECTED)
@pytest.mark.parametrize("of_base", [False, True])
def test_gain_delay_and_filters_are_taken_off(quantity, told, response, of_base):
    channel, plain = ("base_displacement", quantity)[:: 1 if of_base else -1]
    made = [_channel(channel, told, response), _channel(plain, {})]
    steady = condition(Record.of("made", made), PAPER.k)
    assert steady.warnings == ()
    Y = steady.mean(steady.Y)[1]
    assert abs(Y) == pytest.approx(MOTION.Y, rel=1e-9)
    found = steady.mean(steady.X)[ORDERS] * (abs(Y) / Y) ** ORDERS
    # rounding, times what a filter takes away of a harmonic: 1/H is 100 at the most here
    assert found == pytest.approx(HARMONICS, abs=1e-10 * abs(HARMONICS[0]))


def test_noise_is_that_of_the_samples_and_errors_are_those_of_the_signal():
    noise = 1e-5 * np.random.default_rng(1).standard_normal(T.size)
    a = _conditioned(_channel("displacement", {"gain": 2}, lambda w: 2.0 + 0.0 * w, 2.0 * noise))
    b = _conditioned(_channel("displacement", {}, drift=noise))
    assert a.noise_rms["displacement"] == pytest.approx(2.0 * b.noise_rms["displacement"])
    np.testing.assert_allclose(a.X_error, b.X_error, rtol=1e-9)


def test_a_drifting_offset_leaves_a_corrected_channel_alone():
    """The drift is in the samples, after all that the channel does to the signal."""
    told = {"gain": 1.5, "delay": 3e-3, "low_pass": {"corner_hz": 30.0, "order": 2}}
    through = _channel("displacement", told).correction.response
    a, b = (_conditioned(_channel("displacement", told, through, drift)) for drift in (0, 1e-4 * T))
    np.testing.assert_allclose(a.mean(a.X)[1:8], b.mean(b.X)[1:8], atol=1e-6 * ORBIT.X)


def test_harmonics_that_a_filter_does_not_pass_are_none():
    # 1e-3 at 47 Hz: the ninth harmonic
    steady = _conditioned(_channel("displacement", {"low_pass": {"corner_hz": 20.0, "order": 8}}))
    assert steady.X.shape[1] == 1 + math.floor(20.0 * 1e3 ** (1 / 8) / (OMEGA / (2.0 * math.pi)))
    with pytest.raises(ValueError, match=r"x: displacement: its filter passes less than 0\.001 of"):
        _conditioned(_channel("displacement", {"low_pass": {"corner_hz": 0.01, "order": 3}}))


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ({"delay": "3 mm"}, "delay: the delay must be a number of s, or one with its unit"),
        ({"gain": 0}, "gain"),
        ({"high_pass": {}}, "high_pass: {} is not allowed. Needs corner_hz, with its order"),
        ({"low_pass": {"corner_hz": 5, "poles_rad_per_s": [-3]}}, "one of the two"),
        ({"low_pass": {"poles_rad_per_s": [-3], "order": 1}}, "order: 1 is not allowed. Belongs"),
        ({"low_pass": {"poles_rad_per_s": [[0, 3]]}}, "low_pass.poles_rad_per_s[1]"),
    ],
)
def test_nonsense_is_named(told, said):
    with pytest.raises(RecordError) as error:
        _channel("displacement", told)
    assert "channels.displacement." in str(error.value)
    assert said in str(error.value)


def test_what_needs_a_correction_yet_is_not_written(tmp_path):
    with pytest.raises(RecordError, match="cannot store the correction of the displacement"):
        write(tmp_path / "out.csv", Record.of("x", [_channel("displacement", {"gain": 2})]))
    assert not list(tmp_path.iterdir())
