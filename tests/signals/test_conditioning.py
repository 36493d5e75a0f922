"""Records with a fault are told from those without, and every channel gives the harmonics of the motion."""

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
from dampbalance.signals.conditioning import _bandwidth, condition
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)
ORBIT = steady_orbit(PAPER, MOTION)
ALL = ("base_displacement", "displacement", "velocity", "acceleration")


def measured(channels=ALL[:2], noise=0.01, cycles=30.4, seed=11):
    taken = {"rate_hz": 2000.0, "cycles": cycles, "noise": noise, "seed": seed}
    return measured_orbit(ORBIT, channels=channels, **taken)


def spoiled(record: Record, quantity: str, change) -> Record:
    """The record with one channel changed: a function of its t and values gives new ones of both."""
    t, values = change(record[quantity].t, record[quantity].values)
    changed = replace(record[quantity], t=t, values=values)
    return Record.of(record.name, list({**record.channels, quantity: changed}.values()))


def pair(t, y, x) -> Record:
    return Record.of("pair", [Channel(ALL[0], t, y), Channel(ALL[1], t, x)])


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
    for n in (1, 3, 5):
        X_n, phi_n = ORBIT.harmonic(n)
        # harmonics beyond those fitted leak into them, most in the acceleration, which has a corner
        assert ratio_of(steady, n) == pytest.approx(X_n * np.exp(-1j * phi_n), abs=2e-6 * ORBIT.X)


def test_a_force_leaves_the_base_at_rest():
    """Motions against it and against the ground are the same."""
    record = measured(("force", "displacement"), 0.0)
    renamed = replace(record["displacement"], quantity="relative_displacement")
    relative = condition(Record.of("relative", [record["force"], renamed]), PAPER.k)
    np.testing.assert_array_equal(relative.X, condition(record, PAPER.k).X)


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


def test_channels_may_have_different_times():
    slow = measured_orbit(ORBIT, rate_hz=613.0, cycles=30.0, start=0.0371, noise=0.0)
    fast = measured(noise=0.0)
    mixed = Record.of("mixed", [slow["base_displacement"], fast["displacement"]])
    a, b = condition(mixed, PAPER.k), condition(fast, PAPER.k)
    assert a.start == pytest.approx(0.0371)
    assert ratio_of(a) == pytest.approx(ratio_of(b), rel=1e-9)


def test_offset_and_drift_leave_the_features_alone():
    clean = measured(noise=0.0)
    drifting = spoiled(clean, ALL[1], lambda t, s: (t, s + 0.01 + 1e-4 * t - 5e-6 * t**2))
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
    steady, even = (condition(pair(of, y, x), PAPER.k) for of in (noisy, t))
    assert [one.code for one in steady.warnings] == ["uneven times"] * 2 * told
    np.testing.assert_allclose(steady.mean(steady.X), even.mean(even.X), rtol=1e-4, atol=1e-9)


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
        (ALL[1], lambda t, s: (t, np.sin(900.0 * t)), "displacement does not oscillate at the"),
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


@pytest.mark.parametrize(("cycles", "noise", "told"), [(100.0, 1e-4, True), (6.0, 0.05, False)])
def test_a_clock_that_is_off_is_told_as_far_as_the_record_resolves_it(cycles, noise, told):
    steady = condition(measured(ALL[:2], noise, cycles), PAPER.k, frequency_hz=NEAR / (1.0 + 5e-5))
    off = [one.numbers["off"] for one in steady.warnings if one.code == "frequency"]
    assert off == pytest.approx([5e-5] * told, abs=1.5e-6)  # five times what the noise makes of it


def test_transient_at_the_start_is_reported_and_can_be_skipped():
    t = np.arange(0.0, 30.4 * MOTION.period, 5e-4)
    x = transient(PAPER, MOTION, float(t[-1])).state(t).x
    noise = np.random.default_rng(6).standard_normal((2, t.size))
    record = pair(t, MOTION.y(t) + 3e-5 * noise[0], x + 2e-5 * noise[1])
    assert "unsettled" in {one.code for one in condition(record, PAPER.k).warnings}
    assert condition(record, PAPER.k, skip_cycles=5).warnings == ()


@pytest.mark.parametrize("part", [2e-4, -5e-5])
def test_a_phase_that_drifts_is_reported_with_what_drifts_like_that(part):
    """The response is sampled by another clock than the excitation."""
    record = measured(noise=0.001, cycles=60.0)
    steady = condition(spoiled(record, ALL[1], lambda t, s: (t * (1.0 + part), s)), PAPER.k)
    (one,) = steady.warnings
    assert (one.code, one.numbers["drive"], one.numbers["phase"]) == ("unsettled", False, True)
    # over 60 cycles it turns by 60 · 2π ε, evenly: a standard deviation of that over √12
    spread = 120.0 * math.pi * abs(part) / math.sqrt(12.0)
    assert steady.X_hidden[1] / abs(ratio_of(steady)) == pytest.approx(spread, rel=0.05)
