"""Every check on a record: set off by a record with the fault, silent on one without."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from dampbalance import BaseMotion, steady_orbit, transient
from dampbalance.reading.conditioning import (
    _bandwidth,
    condition,
    converter_step,
    evenly_sampled,
    rounding_error,
)
from dampbalance.reading.cycles import accumulate
from dampbalance.records.measurement import Channel, Measurement
from dampbalance.records.synthetic import measured_orbit
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
ALL = ("base_displacement", "displacement", "velocity", "acceleration")


def _measured(channels=("base_displacement", "displacement"), noise=0.01, cycles=30.4, seed=11):
    return measured_orbit(
        ORBIT, rate_hz=2000.0, cycles=cycles, noise=noise, seed=seed, channels=channels
    )


def _with(measurement: Measurement, quantity: str, **changed) -> Measurement:
    channels = {**measurement.channels, quantity: replace(measurement[quantity], **changed)}
    return Measurement.of(measurement.source, list(channels.values()))


def _pair(t, y, x) -> Measurement:
    return Measurement.of("pair", [Channel(ALL[0], t, y), Channel(ALL[1], t, x)])


def warnings_of(record, **known) -> str:
    return " ".join(condition(record, PAPER.k, **known).warnings)


def ratio_of(steady, n=1):
    """Harmonic n of the response over that power of the base, for a base of the amplitude and phase of MOTION."""
    return steady.mean(steady.X)[n] / (steady.mean(steady.Y)[1] / MOTION.Y) ** n


def exact(n):
    X_n, phi_n = ORBIT.harmonic(n)
    return X_n * np.exp(-1j * phi_n)


@pytest.mark.parametrize("base", ["base_displacement", "base_acceleration"])
@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_a_motion_against_the_base_is_that_of_the_base_and_more(quantity, base):
    against = [
        condition(_measured((base, q), 0.0), PAPER.k) for q in (quantity, f"relative_{quantity}")
    ]
    own, sum_of_both = (steady.mean(steady.X)[1:] for steady in against)
    assert np.abs(sum_of_both - own).max() < 1e-9 * abs(own[0])


def test_a_force_leaves_the_base_at_rest():
    """Against it and against the ground are the same; both are averaged where both were measured."""
    record = _measured(("force", "displacement"), 0.0)
    renamed = replace(record["displacement"], quantity="relative_displacement")
    relative = condition(Measurement.of("relative", [record["force"], renamed]), PAPER.k)
    np.testing.assert_array_equal(relative.X, condition(record, PAPER.k).X)


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01, 0.05])
@pytest.mark.parametrize("seed", range(3))
def test_a_good_record_gives_no_warning(noise, seed):
    assert condition(_measured(ALL, noise, seed=seed), PAPER.k, frequency_hz=NEAR).warnings == ()


def test_noise_is_measured():
    steady = condition(_measured(ALL, 0.01, cycles=60.0), PAPER.k)
    for quantity in ALL:
        values = _measured(ALL, 0.0)[quantity].values
        # pooled over more than 18 harmonics of 60 cycles: known to about 2 %; the median adds as much
        expected = 0.01 * math.sqrt(np.mean(values**2))
        assert steady.noise_rms[quantity] == pytest.approx(expected, rel=0.08)


def test_noise_of_the_mean_harmonics_is_measured():
    found = [condition(_measured(seed=s, cycles=20.0), PAPER.k) for s in range(60)]
    # phases count from the start: those scatter with ω
    means = np.abs([s.mean(s.X)[1] for s in found])
    error = np.mean([s.X_error[1] for s in found])
    # 60 amplitudes: their scatter is known to 9 %
    assert means.std(ddof=1) == pytest.approx(error, rel=0.27)


@pytest.mark.parametrize("base", ["base_acceleration", "force"])
def test_base_acceleration_and_force_stand_for_the_base_motion(base):
    steady = condition(_measured((base, "displacement"), 0.0), PAPER.k)
    direct = condition(_measured(noise=0.0), PAPER.k)
    assert abs(steady.mean(steady.Y)[1]) == pytest.approx(MOTION.Y, rel=1e-9)
    assert ratio_of(steady) == pytest.approx(ratio_of(direct), rel=1e-7)


@pytest.mark.parametrize("response", ["displacement", "velocity", "acceleration"])
def test_each_response_gives_the_same_harmonics(response):
    steady = condition(_measured(("base_displacement", response), 0.0), PAPER.k)
    for n in (1, 3, 5):
        # harmonics beyond those fitted leak into them, most in the acceleration, which has a corner
        assert ratio_of(steady, n) == pytest.approx(exact(n), abs=2e-6 * ORBIT.X)


def test_channels_may_have_different_times():
    slow = measured_orbit(ORBIT, rate_hz=613.0, cycles=30.0, start=0.0371, noise=0.0)
    fast = _measured(noise=0.0)
    mixed = Measurement.of("mixed", [slow["base_displacement"], fast["displacement"]])
    a, b = condition(mixed, PAPER.k), condition(fast, PAPER.k)
    assert a.start == pytest.approx(0.0371)
    assert ratio_of(a) == pytest.approx(ratio_of(b), rel=1e-9)


def test_offset_and_drift_leave_the_features_alone():
    clean = _measured(noise=0.0)
    t, x = clean["displacement"].t, clean["displacement"].values
    drifting = _with(clean, "displacement", values=x + 0.01 + 1e-4 * t - 5e-6 * t**2)
    a, b = condition(drifting, PAPER.k), condition(clean, PAPER.k)
    assert a.warnings == ()
    # the drift, 0.25 X over the record, is taken off
    np.testing.assert_allclose(a.mean(a.X)[1:6], b.mean(b.X)[1:6], atol=1e-6 * ORBIT.X)


def test_uneven_sampling_is_resampled_and_said():
    rng = np.random.default_rng(4)
    t = np.sort(np.arange(0.0, 6.0, 5e-4) + 2e-4 * rng.random(12000))
    record = _pair(t, MOTION.Y * np.cos(MOTION.omega * t), ORBIT.state(t).x)
    steady = condition(record, PAPER.k)
    assert "unevenly sampled" in " ".join(steady.warnings)
    assert steady.start == t[0]
    assert abs(ratio_of(steady)) == pytest.approx(abs(exact(1)), rel=1e-6)


def test_what_is_resampled_lies_between_the_first_sample_and_the_last():
    t = np.array([0.3, 0.4, 0.52, 0.6, 0.71, 0.8, 0.88, 1.0, 1.1, 1.23])
    even = evenly_sampled(Channel("displacement", t, 2.0 * t), "uneven", [])
    dt = np.median(np.diff(t))
    assert even.t == pytest.approx(0.3 + dt * np.arange(even.t.size), rel=1e-12)
    assert t[-1] - dt < even.t[-1] <= t[-1]
    assert even.values == pytest.approx(2.0 * even.t, rel=1e-12)  # a cubic spline keeps a line


def test_the_error_that_resampling_is_said_to_make_is_the_one_it_makes():
    rng = np.random.default_rng(4)
    dt = MOTION.period / 30.3
    t = np.sort(np.arange(0.0, 8.0, dt) + 0.4 * dt * rng.random(math.ceil(8.0 / dt)))
    x = 0.01 * np.cos(MOTION.omega * t - 1.0)
    record = _pair(t, MOTION.Y * np.cos(MOTION.omega * t), x)
    (words,) = (w for w in condition(record, PAPER.k).warnings if w.startswith("displacement"))
    digits, power = re.search(r"error about (\S+)·10⁻(\S) m in addition", words).groups()
    said = float(digits) * 10.0 ** -unicodedata.digit(power)
    grid = np.arange(t[1], t[-2], np.median(np.diff(t)))
    off = CubicSpline(t, x)(grid) - 0.01 * np.cos(MOTION.omega * grid - 1.0)
    # the error of a spline of half as many samples over 2⁴: an estimate, of steps that differ
    assert 0.3 < said / np.sqrt(np.mean(off**2)) < 3.0


def test_no_error_is_taken_for_less_than_rounding():
    steady = condition(_measured(ALL, 0.0), PAPER.k)
    # of each of the three responses, which are averaged: less by √3 at most
    floor = 1e-9 * abs(steady.mean(steady.X)[1])
    assert np.all(steady.X_error[np.isfinite(steady.X_error)] >= 0.999 * floor / math.sqrt(3.0))
    assert steady.Y_error.min() == pytest.approx(1e-9 * MOTION.Y, rel=1e-3)


def test_the_bandwidth_ends_where_three_harmonics_in_a_row_are_hidden():
    error = np.full(20, 1.0)
    for clear, last in (((1, 3, 5), 5), ((1, 3, 9), 9), ((1, 3, 11), 3), ((1, 7, 13), 13), ((), 1)):
        mean = np.zeros(20)
        mean[list(clear)] = 4.1
        mean[[2, 4, 6, 8]] = 100.0  # even ones are another matter
        assert _bandwidth(mean.astype(complex), error) == last
        assert _bandwidth(0.95 * mean.astype(complex), error) == 1


# --- faults of a record -------------------------------------------------------------------------------------------


def _spoiled(quantity, change, noise=0.01, cycles=30.4):
    """A record with one channel changed: a function of its t and values gives new values, or both."""
    channels = ALL if quantity in ALL[2:] else ALL[:2]
    record = _measured(channels, noise, cycles)
    changed = change(record[quantity].t, record[quantity].values)
    t, values = changed if isinstance(changed, tuple) else (record[quantity].t, changed)
    return _with(record, quantity, t=t, values=values)


def wave(order, size):
    return lambda t, s: s + size * np.cos(order * MOTION.omega * t)


def growing(part):
    return lambda t, s: s * (1.0 + part * t / t[-1])


def constant(t, s):
    return np.full(s.size, 0.25)


def held(t, s):
    return np.where(np.arange(s.size) // 80 * 80 == 5120, s[5119], s)


def spiked(t, s):
    return np.where(np.arange(s.size) == 5100, 0.5, s)


def cut(t, s):
    kept = np.arange(s.size) // 60 != 5000 // 60
    return t[kept], s[kept]


def random(t, s):
    return np.random.default_rng(5).standard_normal(s.size)


@pytest.mark.parametrize(
    ("quantity", "change", "refusal"),
    [
        ("base_displacement", constant, "base_displacement is constant"),
        ("displacement", constant, "displacement is constant"),
        ("displacement", random, "displacement does not oscillate at the drive"),
        ("displacement", growing(0.3), "not steady"),
        # a wrong unit of one response
        ("acceleration", lambda t, s: s / 9.81, "acceleration contradicts displacement"),
    ],
)
def test_a_record_that_says_nothing_is_refused(quantity, change, refusal):
    with pytest.raises(ValueError, match=refusal):
        condition(_spoiled(quantity, change), PAPER.k)


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize(
    ("quantity", "change", "said", "cycles"),
    [
        ("displacement", lambda t, s: np.minimum(s, 0.97 * ORBIT.X), "t is clipped", 30),
        ("displacement", held, "displacement: 1 cycle left out; first cycle 13", 29),
        ("displacement", held, "81 samples hold", 29),
        ("displacement", spiked, "a spike: 0.5", 29),
        ("displacement", cut, "a gap", 29),
        ("displacement", growing(0.006), "the response is not steady", 30),
        (
            "base_displacement",
            wave(3, 0.01 * MOTION.Y),
            "1 % distortion, most of it harmonic 3",
            30,
        ),
        ("displacement", wave(2, 0.01 * ORBIT.X), "not symmetric: harmonic 2", 30),
        ("displacement", lambda t, s: -s, "no work is put in", 30),
        ("velocity", lambda t, s: 1.02 * s, "velocity stands for 1.0", 30),
    ],
)
def test_a_fault_is_reported(quantity, change, said, cycles, noise):
    steady = condition(_spoiled(quantity, change, noise), PAPER.k)
    assert said in " ".join(steady.warnings)
    assert steady.cycles == cycles


def test_a_converter_with_coarse_steps_is_not_clipping():
    step = ORBIT.X / 100.0
    found = warnings_of(_spoiled("displacement", lambda t, s: step * np.round(s / step), 0.0))
    assert "clipped" not in found
    assert "drop-out" not in found


def test_how_long_the_motion_takes_to_settle_is_said_in_cycles():
    record = _spoiled(
        "displacement",
        lambda t, s: np.where(t < t[0] + 5.0 * MOTION.period, 1.02, 1.0) * s,
        0.001,
    )
    assert "it settles after about 5 cycles: leave those out" in warnings_of(record)


def test_another_frequency_is_refused_with_both_numbers_and_one_nearby_reported():
    with pytest.raises(ValueError, match=r"4\.9\d* ± .* not at the 3\.5 Hz given"):
        condition(_measured(), PAPER.k, frequency_hz=3.5)
    assert "not at the 4.85 Hz given" in warnings_of(_measured(), frequency_hz=4.85)


def test_a_clock_that_is_off_is_told_as_far_as_the_record_resolves_it():
    for cycles, noise, told in ((100.0, 1e-4, True), (6.0, 0.05, False)):
        for seed in range(10):
            record = _measured(noise=noise, cycles=cycles, seed=seed)
            words = warnings_of(record, frequency_hz=NEAR * (1.0 - 50e-6))
            assert bool(re.search(r"\+(49|50|51) ppm", words)) == told


@pytest.mark.parametrize(
    ("rate_hz", "cycles", "k", "refusal"),
    [
        (2000.0, 2.7, PAPER.k, "at least 3 are needed"),
        (40.0, 50.0, PAPER.k, "samples per cycle are too few"),
        *((2000.0, 30.4, k, "stiffness k must be positive") for k in (0.0, -1.0, math.nan)),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_name(rate_hz, cycles, k, refusal):
    record = measured_orbit(ORBIT, rate_hz=rate_hz, cycles=cycles, source="level4.csv")
    with pytest.raises(ValueError, match=rf"^level4\.csv: .*{refusal}"):
        condition(record, k)


def test_few_cycles_are_reported():
    assert "only 6 cycles" in warnings_of(_measured(cycles=6.2))


def test_skew_between_responses_is_measured():
    delay = 1.5e-4
    channels = ("force", "acceleration")
    options = {"rate_hz": 2000.0, "cycles": 30.4, "noise": 0.01, "seed": 8, "channels": channels}
    late = measured_orbit(ORBIT, start=-delay, **options)["acceleration"]
    late = replace(late, t=late.t + delay)
    both = Measurement.of("skewed", [*_measured().channels.values(), late])
    steady = condition(both, PAPER.k)
    assert "acceleration lags displacement" in " ".join(steady.warnings)
    # white noise of 1 % in two channels of 12,360 samples: 13e-5 rad, 4 µs
    assert steady.skew["acceleration"] == pytest.approx(delay, abs=1.2e-5)
    assert ratio_of(steady, 3) == pytest.approx(exact(3), abs=0.02 * abs(exact(3)))


def test_transient_at_the_start_is_reported_and_can_be_skipped():
    t = np.arange(0.0, 30.4 * MOTION.period, 5e-4)
    x = transient(PAPER, MOTION, float(t[-1])).state(t).x
    rng = np.random.default_rng(6)
    y = MOTION.y(t) + 3e-5 * rng.standard_normal(t.size)
    record = _pair(t, y, x + 2e-5 * rng.standard_normal(t.size))
    try:
        found = warnings_of(record)
    except ValueError as error:
        found = str(error)
    assert "the response is not steady" in found
    assert condition(record, PAPER.k, skip_cycles=5).warnings == ()


# --- two clocks -----------------------------------------------------------------------------------


def _stretched(part: float, noise: float = 0.01, cycles: float = 60.0) -> Measurement:
    """A record whose response was sampled by a clock that is fast by that part."""
    measured = _measured(noise=noise, cycles=cycles)
    return _with(measured, "displacement", t=measured["displacement"].t * (1.0 + part))


@pytest.mark.parametrize("part", [2e-4, -5e-5])
def test_two_clocks_are_recognised_and_their_times_corrected(part):
    steady = condition(_stretched(part), PAPER.k)
    (words,) = steady.warnings
    assert "seems to be sampled by another clock" in words
    assert ("fast" if part > 0.0 else "slow") in words
    assert words.doubts
    found, error = map(float, re.findall(r"([\d.e-]+) ± ([\d.e-]+) ppm", words)[0])
    # the error is printed with one digit
    assert abs(found - 1e6 * abs(part)) < 5.0 * error
    true = condition(_measured(cycles=60.0), PAPER.k)
    # the phase in the middle of the record, 30 cycles from the start of the clocks, is known as well as the clocks are
    bound = 6.0 * (1e-6 * error * math.pi * 60.0 + steady.X_error[1] / abs(true.mean(true.X)[1]))
    assert abs(ratio_of(steady) / ratio_of(true) - 1.0) < bound


def test_a_start_from_rest_is_not_taken_for_a_clock():
    # at a damping of a tenth of the paper's the start fades within ten cycles or so
    slow = replace(PAPER, c=9.0)
    t = np.arange(0.0, 40.0 * MOTION.period, 1e-3)
    x = transient(slow, MOTION, float(t[-1])).state(t).x
    late = t > 12.0 * MOTION.period
    y = MOTION.Y * np.cos(MOTION.omega * t)
    steady = condition(_pair(t[late], y[late], x[late]), slow.k)
    assert any("not steady" in words for words in steady.warnings)
    assert not any("another clock" in words for words in steady.warnings)


# --- rounding: the error that a converter leaves in harmonics, against what rounding does to many signals -----------

CYCLES, HARMONICS = 50, 20


def harmonics_of(values, t, dt):
    record = accumulate(iter([(t, values)]), 2.0 * math.pi, start=0.0, dt=dt, harmonics=HARMONICS)
    return record.coefficients[:CYCLES]


def errors(amplitude, samples, noise):
    """Rms of what rounding to steps of 1 leaves in each part of the harmonics above the third, and what is foretold."""
    rng = np.random.default_rng(7)
    dt = 1.0 / samples
    t = np.arange(int(samples * CYCLES) + 2) * dt
    squares, expected = [], []
    for _ in range(20):
        size, phase = amplitude * rng.uniform(0.97, 1.03), rng.uniform(0.0, 6.28)
        clean = size * np.cos(2.0 * math.pi * t + phase) + rng.uniform(-0.5, 0.5)
        clean += 0.05 * size * np.cos(6.0 * math.pi * t + rng.uniform(0.0, 6.28))
        clean += noise * rng.standard_normal(t.size)
        rows = harmonics_of(np.round(clean), t, dt)
        off = (rows - harmonics_of(clean, t, dt)).mean(axis=0)[4:]
        squares.append(np.mean(np.abs(off) ** 2) / 2.0)
        scatter = math.sqrt(float(np.median(rows[:, 4:].var(axis=0))) / 2.0 * samples / 2.0)
        expected.append(rounding_error(1.0, np.ptp(clean), samples, CYCLES, scatter))
    return math.sqrt(np.mean(squares)), float(np.mean(expected))


@pytest.mark.parametrize("amplitude", [10.3, 50.7, 300.2, 1500.0])
@pytest.mark.parametrize("samples", [100.0, 100.37, 100.5, 353.3])
def test_the_error_is_that_of_signals_without_noise(amplitude, samples):
    found, expected = errors(amplitude, samples, 0.0)
    # 20 drawings of 17 harmonics, neighbours not independent; near-coincident phases of few steps are counted twice
    assert 0.7 * found < expected < 1.6 * found


def test_noise_of_half_a_step_makes_it_random():
    _, expected = errors(50.7, 100.0, 0.5)
    # e^{−2π²/4} of an amplitude of 0.04, beside 0.006 of rounding that scatters
    assert expected < 1e-3


def test_averaging_does_not_reduce_what_repeats():
    same = [rounding_error(1.0, 100.0, 100.0, cycles, 0.0) for cycles in (1, 10, 1000)]
    assert same == pytest.approx([math.sqrt(2.0 / 12.0 / 100.0)] * 3)
    assert rounding_error(1.0, 1e6, 100.37, 100, 0.0) == pytest.approx(same[0] / 10.0, rel=0.01)


def test_the_step_is_found_where_there_is_one():
    rng = np.random.default_rng(3)
    values = 0.3 + 0.01 * rng.standard_normal(4096)
    assert converter_step(values) == 0.0
    assert converter_step(2e-4 * np.round(values / 2e-4)) == pytest.approx(2e-4)
    assert converter_step(np.ones(100)) == 0.0
    assert rounding_error(0.0, 1.0, 100.0, 10, 0.1) == 0.0
