"""What a channel does to its signal, given in the mapping, is taken off its harmonics exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from dampbalance import BaseMotion, read_records, steady_orbit
from dampbalance.identification.loading import load
from dampbalance.records.channel import Channel
from dampbalance.records.errors import RecordError
from dampbalance.records.mapping import mapping_from
from dampbalance.records.readers import read
from dampbalance.records.record import Record
from dampbalance.records.writers import write
from dampbalance.signals.conditioning import condition
from paper_case import OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
ORDERS = np.array([1, 3, 5])
T = np.arange(0.0, 20.0 * MOTION.period, 1.0 / 2000.0)


def _butterworth(order, corner_hz, kind):
    """H(iω) of SciPy's analog filter."""
    b, a = signal.butter(order, 2.0 * math.pi * corner_hz, kind, analog=True)
    return lambda omega: signal.freqs(b, a, omega)[1]


def _poles(zeros, poles):
    """H(iω) of a filter of these zeros and poles (rad/s), of gain 1 at ω = 0 or, with zeros, at infinity."""
    gain = 1.0 if zeros else np.prod(-np.array(poles)).real
    return lambda omega: signal.freqs_zpk(zeros, poles, gain, omega)[1]


def _sampled(amplitudes, response, quantity):
    """Samples of Σ x_n e^{inωt} after a channel with this H(iω)."""
    n = np.arange(1, 2 * len(amplitudes), 2)
    rate = {"displacement": 0, "base_displacement": 0, "velocity": 1, "acceleration": 2}[quantity]
    c = np.asarray(amplitudes) * (1j * n * OMEGA) ** rate * response(n * OMEGA)
    return (c[:, None] * np.exp(1j * n[:, None] * OMEGA * T)).real.sum(axis=0)


def _correction(**rule):
    """What a mapping with this rule for the displacement corrects."""
    channels = {"displacement": {"channel": 1} | rule, "force": {"channel": 2}}
    return mapping_from({"channels": channels}).channels["displacement"].correction


def _conditioned(displacement, correction=None):
    """The steady state of these samples of the displacement, and a clean base."""
    base = Channel("base_displacement", T, MOTION.Y * np.cos(OMEGA * T))
    x = Channel("displacement", T, displacement, "x", correction)
    return condition(Record.of("x", [base, x]), PAPER.k)


HARMONICS = [X * np.exp(-1j * lag) for X, lag in map(ORBIT.harmonic, ORDERS.tolist())]

CORRECTED = [
    ("displacement", {"delay": 2e-4}, lambda w: np.exp(-2e-4j * w)),
    ("velocity", {"delay": "-1.5 ms"}, lambda w: np.exp(1.5e-3j * w)),
    ("acceleration", {"gain": 1.02}, lambda w: np.full(w.shape, 1.02 + 0j)),
    ("displacement", {"high_pass": {"corner_hz": 0.5}}, _butterworth(1, 0.5, "high")),
    (
        "acceleration",
        {"high_pass": {"corner_hz": 1.5, "order": 4}},
        _butterworth(4, 1.5, "high"),
    ),
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
@pytest.mark.parametrize("of", ["the response", "the base"])
def test_gain_delay_and_filters_are_taken_off(quantity, told, response, of):
    channel, plain = (quantity, "base_displacement")
    if of == "the base":
        channel, plain = plain, quantity
    rules = {q: {"channel": q} | (told if q == channel else {}) for q in (channel, plain)}
    mapping = mapping_from({"channels": rules})
    made = []
    for q in (channel, plain):
        through = response if q == channel else np.ones_like
        amplitudes = [MOTION.Y] if q == "base_displacement" else HARMONICS
        rule = mapping.channels[q]
        made.append(Channel(q, T, _sampled(amplitudes, through, q), q, rule.correction))
    steady = condition(Record.of("made", made), PAPER.k)
    assert steady.warnings == ()
    Y = steady.mean(steady.Y)[1]
    assert abs(Y) == pytest.approx(MOTION.Y, rel=1e-9)
    found = steady.mean(steady.X)[ORDERS] * (abs(Y) / Y) ** ORDERS
    # rounding, times what a filter takes away of a harmonic: 1/H is 100 at the most here
    assert found == pytest.approx(np.array(HARMONICS), abs=1e-10 * abs(HARMONICS[0]))


def test_noise_is_that_of_the_samples_and_errors_are_those_of_the_signal():
    rng = np.random.default_rng(1)
    values = 2.0 * (ORBIT.state(T).x + 1e-5 * rng.standard_normal(T.size))
    a, b = _conditioned(values, _correction(gain=2)), _conditioned(0.5 * values)
    assert a.noise_rms["displacement"] == pytest.approx(2.0 * b.noise_rms["displacement"])
    np.testing.assert_allclose(a.X_error, b.X_error, rtol=1e-9)
    np.testing.assert_allclose(a.X, b.X, rtol=0, atol=1e-15)


def test_a_drifting_offset_leaves_a_corrected_channel_alone():
    """The drift is in the samples, after all that the channel does to the signal."""
    correction = _correction(gain=1.5, delay=3e-3, low_pass={"corner_hz": 30.0, "order": 2})
    x = _sampled(HARMONICS, correction.response, "displacement")
    a, b = (_conditioned(x + drift, correction) for drift in (0.0, 1e-4 * T))
    np.testing.assert_allclose(a.mean(a.X)[1:8], b.mean(b.X)[1:8], atol=1e-6 * ORBIT.X)


def test_harmonics_that_a_filter_does_not_pass_are_none():
    # 1e-3 at 47 Hz: the ninth harmonic
    correction = _correction(low_pass={"corner_hz": 20.0, "order": 8})
    x = _sampled(HARMONICS, correction.response, "displacement")
    count = 1 + math.floor(20.0 * 1e3 ** (1 / 8) / (OMEGA / (2.0 * math.pi)))
    assert _conditioned(x, correction).X.shape[1] == count
    lost = r"x: displacement: its filter passes less than 0\.001 of the drive, 4\.9"
    with pytest.raises(ValueError, match=lost):
        _conditioned(x, _correction(low_pass={"corner_hz": 0.01, "order": 3}))


@pytest.mark.parametrize(
    ("told", "said"),
    [
        (
            "delay: 3 mm",
            "channels.displacement.delay: the delay must be a number of s, or one with its unit",
        ),
        (
            "delay: soon",
            "channels.displacement.delay: the delay must be a number of s, or one with its unit",
        ),
        ("gain: 0", "channels.displacement.gain"),
        ("gain: -1.0", "channels.displacement.gain"),
        ("high_pass: {corner_hz: 0}", "channels.displacement.high_pass.corner_hz"),
        ("high_pass: {corner: 1}", "channels.displacement.high_pass.corner: unknown key"),
        (
            "high_pass: {}",
            "channels.displacement.high_pass: {} is not allowed. Needs corner_hz, with its order",
        ),
        ("low_pass: {order: 2}", "low_pass: {'order': 2} is not allowed. Needs corner_hz"),
        ("low_pass: {corner_hz: 5, order: 0}", "channels.displacement.low_pass.order"),
        ("low_pass: {corner_hz: 5, poles_rad_per_s: [-3]}", "one of the two"),
        (
            "low_pass: {poles_rad_per_s: [-3], order: 1}",
            "low_pass.order: 1 is not allowed. Belongs to corner_hz",
        ),
        ("low_pass: {poles_rad_per_s: [3]}", "channels.displacement.low_pass.poles_rad_per_s[1]"),
        ("low_pass: {poles_rad_per_s: [[0, 3]]}", "low_pass.poles_rad_per_s[1]"),
        ("low_pass: {poles_rad_per_s: [[-1, 2, 3]]}", "low_pass.poles_rad_per_s[1]"),
        ("low_pass: {poles_rad_per_s: []}", "channels.displacement.low_pass.poles_rad_per_s"),
    ],
)
def test_nonsense_is_named(tmp_path, told, said):
    record = tmp_path / "run.csv"
    record.write_text("t_s,y_mm,x_mm\n0,0,0\n1,1,1\n2,0,1\n", encoding="utf-8")
    mapping = tmp_path / "run.yaml"
    text = (
        f"channels:\n  base_displacement: {{channel: y}}\n  displacement: {{channel: x, {told}}}\n"
    )
    mapping.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError) as error:
        read(record)
    assert str(mapping) in str(error.value)
    assert said in str(error.value)


def test_a_mapping_corrects_a_file(tmp_path):
    record = tmp_path / "run.csv"
    late = T - 2e-3
    columns = np.column_stack([T, MOTION.Y * np.cos(OMEGA * T), 1.05 * ORBIT.state(late).x])
    header = "t_s,base_displacement_m,displacement_m"
    np.savetxt(record, columns, delimiter=",", header=header, comments="", fmt="%.17g")
    (tmp_path / "run.yaml").write_text(
        "channels:\n  base_displacement: {channel: 2}\n"
        "  displacement: {channel: 3, delay: 2 ms, gain: 1.05}\n",
        encoding="utf-8",
    )
    exact = ORBIT.harmonic(1)
    steady = load(read_records(record)[0], PAPER.k).steady
    x, y = steady.mean(steady.X)[1], steady.mean(steady.Y)[1]
    # harmonics beyond the 31st leak into it
    assert x / (y / MOTION.Y) == pytest.approx(exact[0] * np.exp(-1j * exact[1]), rel=1e-6)


def test_what_needs_a_correction_yet_is_not_written(tmp_path):
    correction = _correction(gain=2)
    made = [Channel(q, T, np.cos(T), q, correction) for q in ("force", "displacement")]
    with pytest.raises(RecordError, match="cannot store the correction of the force"):
        write(tmp_path / "out.csv", Record.of("x", made))
    assert not list(tmp_path.iterdir())
