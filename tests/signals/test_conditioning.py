"""Every check on a record: set off by a record with the fault, silent on one without."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, steady_orbit, transient
from dampbalance.findings.finding import within
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.checks import Unsettled, few_bits
from dampbalance.signals.conditioning import _bandwidth, condition
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
ALL = ("base_displacement", "displacement", "velocity", "acceleration")


def _measured(channels=("base_displacement", "displacement"), noise=0.01, cycles=30.4, seed=11):
    return measured_orbit(
        ORBIT, rate_hz=2000.0, cycles=cycles, noise=noise, seed=seed, channels=channels
    )


def _with(measurement: Record, quantity: str, **changed) -> Record:
    channels = {**measurement.channels, quantity: replace(measurement[quantity], **changed)}
    return Record.of(measurement.name, list(channels.values()))


def _pair(t, y, x) -> Record:
    return Record.of("pair", [Channel(ALL[0], t, y), Channel(ALL[1], t, x)])


def found_in(record, **known):
    """The findings on a record by their codes, and those in them."""
    findings = condition(record, PAPER.k, **known).warnings
    inner = [one for of in findings for one in within(of.numbers.values())]
    return {one.code: one for one in (*inner, *findings)}


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
    relative = condition(Record.of("relative", [record["force"], renamed]), PAPER.k)
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
    mixed = Record.of("mixed", [slow["base_displacement"], fast["displacement"]])
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


@pytest.mark.parametrize(("jitter", "told"), [(0.04, False), (0.3, True)])
def test_jitter_of_the_times_is_reported_and_equal_steps_are_taken(jitter, told):
    t = np.arange(0.0, 6.0, 5e-4)
    noisy = t + 5e-4 * jitter * (np.random.default_rng(4).random(t.size) - 0.5)
    noisy[[0, -1]] = t[[0, -1]]
    y, x = MOTION.Y * np.cos(MOTION.omega * t), ORBIT.state(t).x
    steady, even = (condition(_pair(of, y, x), PAPER.k) for of in (noisy, t))
    assert [one.code for one in steady.warnings] == ["uneven times"] * 2 * told
    np.testing.assert_allclose(steady.mean(steady.X), even.mean(even.X), rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "refusal"),
    [
        (
            lambda t: np.where(t > 1.0, t + 5e-4, t),
            "is not in equal steps: 0.001 s from sample 2000",
        ),
        (lambda t: np.where(t == t[7], t[6], t), "is not in equal steps: 0 s from sample 6 to 7"),
        (lambda t: t + 1e-3 * t**2, "is not in equal steps"),
    ],
)
def test_times_with_a_gap_or_in_other_steps_are_refused(change, refusal):
    t = np.arange(4001) * 5e-4
    with pytest.raises(ValueError, match=f"channel 'x': its time {refusal}"):
        Channel("displacement", change(t), np.cos(t), "x")


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
    ("quantity", "change", "code", "numbers", "cycles"),
    [
        ("displacement", lambda t, s: np.minimum(s, 0.97 * ORBIT.X), "clipped", {}, 30),
        ("displacement", held, "spikes", {"count": 1, "first": 13}, 29),
        ("displacement", held, "drop-out", {"samples": 81}, 29),
        ("displacement", spiked, "spike", {"value": 0.5}, 29),
        ("displacement", growing(0.006), "unsettled", {"drive": False}, 30),
        (
            "base_displacement",
            wave(3, 0.01 * MOTION.Y),
            "base",
            {"order": 3, "distortion": pytest.approx(0.01, rel=0.05)},
            30,
        ),
        ("displacement", wave(2, 0.01 * ORBIT.X), "asymmetric", {"order": 2}, 30),
        ("displacement", lambda t, s: -s, "exchanged", {}, 30),
        ("velocity", lambda t, s: 1.02 * s, "scaled", {"quantity": "velocity"}, 30),
    ],
)
def test_a_fault_is_reported(quantity, change, code, numbers, cycles, noise):
    record = _spoiled(quantity, change, noise)
    found = found_in(record)[code]
    assert {name: found.numbers[name] for name in numbers} == numbers
    assert condition(record, PAPER.k).cycles == cycles


def test_a_converter_with_coarse_steps_is_not_clipping():
    step = ORBIT.X / 100.0
    found = found_in(_spoiled("displacement", lambda t, s: step * np.round(s / step), 0.0))
    assert "clipped" not in found
    assert "drop-out" not in found


def test_a_clock_that_is_off_is_told_as_far_as_the_record_resolves_it():
    for cycles, noise, told in ((100.0, 1e-4, True), (6.0, 0.05, False)):
        for seed in range(10):
            record = _measured(noise=noise, cycles=cycles, seed=seed)
            found = found_in(record, frequency_hz=NEAR * (1.0 - 50e-6))
            assert ("frequency" in found) == told
            off = found["frequency"].numbers["off"] if told else 50e-6
            assert off == pytest.approx(50e-6, abs=1.5e-6)


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
    assert found_in(_measured(cycles=6.2))["few cycles"].numbers["cycles"] == 6


def test_skew_between_responses_is_measured():
    delay = 1.5e-4
    channels = ("force", "acceleration")
    options = {"rate_hz": 2000.0, "cycles": 30.4, "noise": 0.01, "seed": 8, "channels": channels}
    late = measured_orbit(ORBIT, start=-delay, **options)["acceleration"]
    late = replace(late, t=late.t + delay)
    both = Record.of("skewed", [*_measured().channels.values(), late])
    steady = condition(both, PAPER.k)
    (late,) = (one.numbers for one in steady.warnings if one.code == "late")
    assert (late["quantity"], late["lags"], late["other"]) == ("acceleration", True, "displacement")
    # white noise of 1 % in two channels of 12,360 samples: 13e-5 rad, 4 µs
    assert late["by"] == pytest.approx(delay, abs=1.2e-5)
    assert ratio_of(steady, 3) == pytest.approx(exact(3), abs=0.02 * abs(exact(3)))


def test_transient_at_the_start_is_reported_and_can_be_skipped():
    t = np.arange(0.0, 30.4 * MOTION.period, 5e-4)
    x = transient(PAPER, MOTION, float(t[-1])).state(t).x
    rng = np.random.default_rng(6)
    y = MOTION.y(t) + 3e-5 * rng.standard_normal(t.size)
    record = _pair(t, y, x + 2e-5 * rng.standard_normal(t.size))
    try:
        codes = {*found_in(record)}
    except ValueError as error:
        codes = {"unsettled"} if isinstance(error.__cause__, Unsettled) else set()
    assert "unsettled" in codes
    assert condition(record, PAPER.k, skip_cycles=5).warnings == ()


@pytest.mark.parametrize("part", [2e-4, -5e-5])
def test_a_phase_that_drifts_is_reported_with_what_drifts_like_that(part):
    """The response is sampled by another clock than the excitation."""
    measured = _measured(noise=0.001, cycles=60.0)
    late = _with(measured, "displacement", t=measured["displacement"].t * (1.0 + part))
    steady = condition(late, PAPER.k)
    (one,) = steady.warnings
    assert (one.code, one.numbers["drive"], one.numbers["phase"]) == ("unsettled", False, True)
    # over 60 cycles it turns by 60 · 2π ε, evenly: a standard deviation of that over √12
    spread = 120.0 * math.pi * abs(part) / math.sqrt(12.0)
    assert steady.X_hidden[1] / abs(ratio_of(steady)) == pytest.approx(spread, rel=0.05)


def test_a_start_from_rest_is_not_taken_for_a_clock():
    # at a damping of a tenth of the paper's the start fades within ten cycles or so
    slow = replace(PAPER, c=9.0)
    t = np.arange(0.0, 40.0 * MOTION.period, 1e-3)
    x = transient(slow, MOTION, float(t[-1])).state(t).x
    late = t > 12.0 * MOTION.period
    y = MOTION.Y * np.cos(MOTION.omega * t)
    steady = condition(_pair(t[late], y[late], x[late]), slow.k)
    assert [one.numbers["phase"] for one in steady.warnings if one.code == "unsettled"] == [False]


@pytest.mark.parametrize(
    ("step", "noise", "bits"),
    [(1e-3, 0.0, 11.0), (1e-3, 4e-4, 11.0), (1e-3, 6e-4, 0.0), (4e-4, 0.0, 0.0), (0.02, 0.0, 6.6)],
)
def test_a_converter_below_12_bits_without_noise_is_reported(step, noise, bits):
    values = 0.3 + np.cos(0.0237 * np.arange(5000))
    for made, expected in ((step * np.round(values / step), bits), (values, 0.0)):
        found = list(few_bits("displacement", made, noise))
        assert bool(found) == bool(expected)
        for one in found:
            assert one.numbers["bits"] == pytest.approx(expected, abs=0.05)
            assert one.effect[""] == pytest.approx(step / 2.0, rel=0.02)
