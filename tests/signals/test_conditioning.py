"""Records with a fault are told from those without, and every channel gives the harmonics of the motion, corrected for
what it does to them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from dampbalance import BaseMotion, steady_orbit
from dampbalance.findings.finding import within
from dampbalance.records.channel import Channel
from dampbalance.records.errors import RecordError
from dampbalance.records.mapping import mapping_from
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.records.writers import write
from dampbalance.signals.conditioning import _bandwidth, condition
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
ORDERS = np.array([1, 3, 5])
HARMONICS = ORBIT.harmonics(3)
ALL = ("base_displacement", "displacement", "velocity", "acceleration")


def measured(channels=ALL[:2], noise=0.01, cycles=30.4, seed=11):
    taken = {"rate_hz": 2000.0, "cycles": cycles, "noise": noise, "seed": seed}
    return measured_orbit(ORBIT, channels=channels, **taken)


def spoiled(record: Record, quantity: str, change) -> Record:
    """The record with one channel changed: a function of its t and values gives new ones of both."""
    t, values = change(record[quantity].t, record[quantity].values)
    changed = replace(record[quantity], t=t, values=values)
    return Record.of(record.name, list({**record.channels, quantity: changed}.values()))


def ratio_of(steady, n=1):
    """Harmonic n of the response over that power of the base, for a base of the amplitude and phase of MOTION."""
    return steady.mean(steady.X)[n] / (steady.mean(steady.Y)[1] / MOTION.Y) ** n


@pytest.mark.parametrize(
    "channels",
    [
        *((ALL[0], response) for response in ALL[1:]),
        *((ALL[0], f"relative_{response}") for response in ALL[1:]),
        ("base_acceleration", "displacement"),
        ("base_acceleration", "relative_acceleration"),
        ("force", "displacement"),
    ],
)
def test_each_pair_of_channels_gives_the_harmonics_of_the_motion(channels):
    steady = condition(measured(channels, 0.0), PAPER.k)
    assert abs(steady.mean(steady.Y)[1]) == pytest.approx(MOTION.Y, rel=1e-9)
    # harmonics beyond those fitted leak into them, most in the acceleration, which has a corner
    assert ratio_of(steady, ORDERS) == pytest.approx(HARMONICS, abs=2e-6 * ORBIT.X)


def test_a_force_leaves_the_base_at_rest():
    """Motions against it and against the ground are the same, as they are simulated and as they are read."""
    record, other = (measured(("force", f"{of}displacement"), 0.0) for of in ("", "relative_"))
    np.testing.assert_array_equal(
        other["relative_displacement"].values, record["displacement"].values
    )
    np.testing.assert_array_equal(condition(other, PAPER.k).X, condition(record, PAPER.k).X)


@pytest.mark.parametrize(("noise", "seed"), [(0.0, 0), (0.001, 1), (0.01, 2), (0.05, 0)])
def test_a_good_record_gives_no_warning(noise, seed):
    assert condition(measured(ALL, noise, seed=seed), PAPER.k, frequency_hz=NEAR).warnings == ()


def test_noise_is_measured_and_never_taken_for_less_than_rounding():
    clean, record = measured(ALL, 0.0), measured(ALL, 0.01, cycles=60.0)
    noisy, still = condition(record, PAPER.k), condition(clean, PAPER.k)
    for quantity in ALL:
        # pooled over more than 18 harmonics of 60 cycles: known to about 2 %; the median adds as much
        expected = 0.01 * math.sqrt(np.mean(clean[quantity].values ** 2))
        assert noisy.noise_rms[quantity] == pytest.approx(expected, rel=0.08)
    # of each of the three responses, which are averaged: less by √3 at most
    floor = 1e-9 * abs(still.mean(still.X)[1])
    assert np.all(still.X_error[np.isfinite(still.X_error)] >= 0.999 * floor / math.sqrt(3.0))
    assert still.Y_error.min() == pytest.approx(1e-9 * MOTION.Y, rel=1e-3)


def test_times_of_their_own_offset_and_drift_of_a_channel_leave_the_features_alone():
    clean = measured(noise=0.0)
    slow = measured_orbit(ORBIT, rate_hz=613.0, cycles=30.0, start=0.0371, noise=0.0)
    mixed = condition(Record.of("mixed", [slow[ALL[0]], clean[ALL[1]]]), PAPER.k)
    drifting = spoiled(clean, ALL[1], lambda t, s: (t, s + 0.01 + 1e-4 * t - 5e-6 * t**2))
    a, b = condition(drifting, PAPER.k), condition(clean, PAPER.k)
    assert a.warnings == ()
    assert mixed.start == pytest.approx(0.0371)
    assert ratio_of(mixed) == pytest.approx(ratio_of(b), rel=1e-9)
    # the drift, 0.25 X over the record, is taken off
    np.testing.assert_allclose(a.mean(a.X)[1:6], b.mean(b.X)[1:6], atol=1e-6 * ORBIT.X)


@pytest.mark.parametrize(("jitter", "told"), [(0.04, False), (0.3, True)])
def test_jitter_of_the_times_is_reported_and_equal_steps_are_taken(jitter, told):
    even = measured(noise=0.0)
    off = 5e-4 * jitter * (np.random.default_rng(4).random(even[ALL[1]].t.size) - 0.5)
    off[[0, -1]] = 0.0
    noisy = spoiled(even, ALL[1], lambda t, s: (t + off, s))
    a, b = condition(noisy, PAPER.k), condition(even, PAPER.k)
    assert [one.code for one in a.warnings] == ["uneven times"] * told
    np.testing.assert_allclose(a.mean(a.X), b.mean(b.X), rtol=1e-4, atol=1e-9)


def test_the_bandwidth_ends_where_three_harmonics_in_a_row_are_hidden():
    error = np.full(20, 1.0)
    for clear, last in (((1, 3, 5), 5), ((1, 3, 9), 9), ((1, 3, 11), 3), ((1, 7, 13), 13), ((), 1)):
        mean = np.zeros(20)
        mean[list(clear)] = 4.1
        mean[[2, 4, 6, 8]] = 100.0  # even ones are another matter
        assert _bandwidth(mean.astype(complex), error) == last
        assert _bandwidth(0.95 * mean.astype(complex), error) == 1


# --- faults of a record -------------------------------------------------------------------------------------------


def wave(order, size):
    return lambda t, s: (t, s + size * np.cos(order * MOTION.omega * t))


def times(factor):
    return lambda t, s: (t, s * factor)


def growing(part):
    return lambda t, s: (t, s * (1.0 + part * t / t[-1]))


def held(t, s):
    return t, np.where(np.arange(s.size) // 80 == 64, s[5119], s)


def spiked(t, s):
    return t, np.where(np.arange(s.size) == 5100, 0.5, s)


@pytest.mark.parametrize(
    ("quantity", "change", "refusal"),
    [
        (ALL[0], times(0.0), "base_displacement is constant"),
        (ALL[1], growing(0.3), "not steady"),
        (ALL[3], times(1.0 / 9.81), "acceleration contradicts displacement"),
        (ALL[1], lambda t, s: (t[:800], s[:800]), "at least 3 are needed"),
        (ALL[1], lambda t, s: (t[::50], s[::50]), "samples per cycle are too few"),
    ],
)
def test_a_record_that_says_nothing_is_refused_with_its_name(quantity, change, refusal):
    record = replace(measured(ALL if quantity == ALL[3] else ALL[:2]), name="level4.csv")
    with pytest.raises(ValueError, match=rf"^level4\.csv: .*{refusal}"):
        condition(spoiled(record, quantity, change), PAPER.k)
    for k in (0.0, math.nan):
        with pytest.raises(ValueError, match="stiffness k must be positive"):
            condition(record, k)


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize(
    ("quantity", "change", "code", "numbers"),
    [
        (ALL[1], lambda t, s: (t, np.minimum(s, 0.97 * ORBIT.X)), "clipped", {}),
        (ALL[1], held, "drop-out", {"samples": 81}),
        (ALL[1], spiked, "spikes", {"count": 1, "first": 13}),
        (ALL[1], growing(0.006), "unsettled", {"drive": False}),
        (ALL[0], wave(3, 0.01 * MOTION.Y), "base", {"order": 3}),
        (ALL[1], wave(2, 0.01 * ORBIT.X), "asymmetric", {"order": 2}),
        (ALL[1], times(-1.0), "exchanged", {}),
        (ALL[2], times(1.02), "scaled", {"quantity": "velocity"}),
        (ALL[2], lambda t, s: (t + 1.5e-4, s), "late", {"lags": True}),
    ],
)
def test_a_fault_is_reported(quantity, change, code, numbers, noise):
    record = measured(ALL if quantity in ALL[2:] else ALL[:2], noise)
    steady = condition(spoiled(record, quantity, change), PAPER.k)
    inner = [one for of in steady.warnings for one in within(of.numbers.values())]
    found = {one.code: one.numbers for one in (*inner, *steady.warnings)}[code]
    assert {name: found[name] for name in numbers} == numbers
    assert steady.cycles == 30 - (change in (held, spiked))


def test_a_clock_that_is_off_is_told():
    record = measured(noise=1e-4, cycles=100.0)
    (one,) = condition(record, PAPER.k, frequency_hz=NEAR / (1.0 + 5e-5)).warnings
    assert one.numbers["off"] == pytest.approx(5e-5, abs=1.5e-6)  # five times what the noise makes


def test_a_phase_that_drifts_is_reported_with_what_drifts_like_that():
    """The response is sampled by another clock than the excitation."""
    record, part = measured(noise=0.001, cycles=60.0), -5e-5
    steady = condition(spoiled(record, ALL[1], lambda t, s: (t * (1.0 + part), s)), PAPER.k)
    (one,) = steady.warnings
    assert (one.code, one.numbers["drive"], one.numbers["phase"]) == ("unsettled", False, True)
    # over 60 cycles it turns by 60 · 2π ε, evenly: a standard deviation of that over √12
    spread = 120.0 * math.pi * abs(part) / math.sqrt(12.0)
    assert steady.X_hidden[1] / abs(ratio_of(steady)) == pytest.approx(spread, rel=0.05)


# --- what a channel does to its signal, given in the mapping, is taken off its harmonics exactly -------------------

RATES = {"displacement": 0, "base_displacement": 0, "velocity": 1, "acceleration": 2}
T = np.arange(0.0, 20.0 * MOTION.period, 1.0 / 2000.0)


def _filter(zeros, poles, gain):
    """H(iω) of a filter of these zeros and poles, rad/s."""
    return lambda omega: signal.freqs_zpk(zeros, poles, gain, omega)[1]


def _butterworth(order, corner_hz, kind):
    corner = 2.0 * math.pi * corner_hz
    return _filter(*signal.butter(order, corner, kind, analog=True, output="zpk"))


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


LOW = _filter([], [-300.0, -200.0 + 150.0j, -200.0 - 150.0j], 300.0 * abs(200.0 + 150.0j) ** 2)
HIGH = _filter([0.0, 0.0, 0.0], [-3.0, -1.0 + 2.0j, -1.0 - 2.0j], 1.0)
CORRECTED = [
    ("displacement", {"delay": 2e-4}, lambda w: np.exp(-2e-4j * w)),
    ("velocity", {"delay": "-1.5 ms"}, lambda w: np.exp(1.5e-3j * w)),
    ("acceleration", {"gain": 1.02}, lambda w: np.full(w.shape, 1.02 + 0j)),
    ("acceleration", {"high_pass": {"corner_hz": 1.5, "order": 4}}, _butterworth(4, 1.5, "high")),
    ("displacement", {"low_pass": {"corner_hz": 100, "order": 5}}, _butterworth(5, 100.0, "low")),
    ("velocity", {"low_pass": {"poles_rad_per_s": [-300, [-200.0, 150.0]]}}, LOW),
    ("displacement", {"high_pass": {"poles_rad_per_s": [-3.0, [-1.0, 2.0]]}}, HIGH),
]


@pytest.mark.parametrize(("quantity", "told", "response"), CORRECTED)
@pytest.mark.parametrize("of_base", [False, True])
def test_gain_delay_and_filters_are_taken_off(quantity, told, response, of_base):
    channel, plain = ("base_displacement", quantity)[:: 1 if of_base else -1]
    made = [_channel(channel, told, response), _channel(plain, {})]
    steady = condition(Record.of("made", made), PAPER.k)
    assert steady.warnings == ()
    assert abs(steady.mean(steady.Y)[1]) == pytest.approx(MOTION.Y, rel=1e-9)
    # rounding, times what a filter takes away of a harmonic: 1/H is 100 at the most here
    assert ratio_of(steady, ORDERS) == pytest.approx(HARMONICS, abs=1e-10 * abs(HARMONICS[0]))


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
        ({"high_pass": {}}, "high_pass: {} is not allowed. Needs corner_hz, with its order"),
        ({"low_pass": {"corner_hz": 5, "poles_rad_per_s": [-3]}}, "one of the two"),
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
