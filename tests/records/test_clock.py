"""Times as loggers write them: samples in equal steps are those of the exact signal, within the bound that is said, and
what is identified from them holds the truth."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from dampbalance import Oscillator, RecordError, identify, measured_ring_down, read_records

OSC = Oscillator(m=2.1, c=0.12, k=240.0, K_z=5000.0, F_k=0.05)
TICK = 2.0 * np.pi / 4096


def motion(t):
    """A decay of two harmonics, m."""
    return 0.02 * np.exp(-0.1 * t) * (np.sin(9.3 * t) + 0.1 * np.cos(28.1 * t + 0.4))


def edges(of, duration):
    """Times and counts of an encoder with a row for each tick."""
    t = np.arange(0.0, duration, 5e-5)
    counts = np.round(of(t) / TICK)
    at = np.flatnonzero(np.diff(counts)) + 1
    return t[at], counts[at] * TICK


def times(name, random):
    """Times of a logger, s, up to 20 s."""
    even = np.arange(0.0, 20.0, 0.02)
    jitter = np.cumsum(random.uniform(0.018, 0.022, 1000))
    return {
        "jitter": np.insert(jitter[jitter < 20.0], 400, jitter[400] - 1e-3),
        "steps of all sizes": np.cumsum(random.uniform(0.008, 0.03, 1000)),
        "a long step": even + 0.008 * (even > 7.0),
        "drift": even + 1e-3 * even**2 / 20.0,
        "two rates": np.concatenate([even[:600], 12.0 + np.arange(250) * 0.03]),
        "rounded jitter": np.round(jitter, 3),
    }[name]


def seen(record, x):
    return read_records({"time_s": record, "displacement_m": x})[0]


@pytest.mark.parametrize(
    "name", ["jitter", "steps of all sizes", "a long step", "drift", "two rates", "rounded jitter"]
)
def test_samples_in_equal_steps_are_those_of_the_signal(name):
    t = times(name, np.random.default_rng(1))
    record = seen(t, motion(t))
    channel = record["displacement"]
    (odd,) = (one for one in record.warnings if one.code == "uneven steps")
    assert odd.shift("") < 0.01
    off = channel.values - motion(channel.t)
    assert np.sqrt(np.mean(off**2)) < odd.shift("") * channel.values.std()
    assert np.ptp(np.diff(channel.t)) < 1e-9
    assert channel.missing is None
    assert channel.t.size > 0.9 * t.size


def test_the_bound_counts_what_lies_between_the_samples():
    random = np.random.default_rng(5)
    t = np.cumsum(random.uniform(0.009, 0.011, 3000))
    bounds = []
    for omega in (20.0, 60.0, 180.0):
        record = seen(t, np.sin(omega * t))
        off = record["displacement"].values - np.sin(omega * record["displacement"].t)
        (odd,) = record.warnings
        bounds.append(odd.shift(""))
        assert np.sqrt(2.0 * np.mean(off**2)) < bounds[-1]
    np.testing.assert_allclose(np.diff(np.log(bounds)), 4.0 * np.log(3.0), rtol=0.1)


def test_long_stretches_without_rows_are_missing():
    t = np.cumsum(np.random.default_rng(6).uniform(0.018, 0.022, 1000))
    t = t[(t < 5.0) | (t > 6.3)]
    channel = seen(t, motion(t))["displacement"]
    inside = (channel.t > 5.02) & (channel.t < 6.28)
    assert channel.missing is not None
    assert np.all(channel.missing[inside])
    assert channel.missing.sum() <= inside.sum() + 3


def test_an_encoder_with_a_row_for_each_tick_is_known_to_half_a_tick_at_rest_as_well():
    def turns(t):
        return 0.3 * np.sin(6.0 * np.minimum(t, 4.0)) + 0.2 * np.sin(3.0 * np.maximum(t - 9.0, 0.0))

    t, x = edges(turns, 14.0)
    record = seen(t, x)
    channel = record["displacement"]
    assert channel.missing is None
    assert np.abs(channel.values - turns(channel.t)).max() < 1.05 * TICK
    moving = (channel.t < 3.9) | (channel.t > 9.1)
    # at its rows it is much better known
    off = (channel.values - turns(channel.t))[moving]
    assert off.std() < 0.1 * TICK
    assert record.warnings[0].shift("") == pytest.approx(0.5 * TICK / channel.values.std(), rel=0.1)


@pytest.mark.parametrize("clock", ["drift", "ticks", "jitter of stamps"])
def test_what_is_identified_holds_the_truth(clock):
    X = 0.2 if clock == "ticks" else 0.02
    options = {"rate_hz": 2000.0, "duration": 20.5, "channels": ("displacement",)}
    fine = measured_ring_down(OSC, x=X, noise=0.0, **options)["displacement"]
    exact, random = CubicSpline(fine.t, fine.values), np.random.default_rng(8)
    if clock == "ticks":
        t, x = edges(exact, 20.0)
    else:
        t = np.arange(0.0, 20.0, 0.01) if "stamps" in clock else times(clock, random)
        x = exact(t) + 1e-3 * X * random.standard_normal(t.size)
    if "stamps" in clock:  # the samples are in equal steps
        t += 0.002 * random.uniform(-1.0, 1.0, t.size)
    found = identify({"time_s": t, "displacement_m": x}, OSC.k)
    for symbol in ("F_k", "c"):
        off = abs(found.values[symbol] - getattr(OSC, symbol))
        assert off < 4.0 * found.standard_errors[symbol]
        assert found.verdicts[symbol].verdict == "usable"


ENDS = {
    "a lone last line": (lambda t, x: (np.append(t, t[-1] + 31.0), np.append(x, x[-1])), "rows apart"),
    "a lone first line": (lambda t, x: (np.append(t[0] - 31.0, t), np.append(x[0], x)), "rows apart"),
    "a padded export": (lambda t, x: [np.append(one, np.full(700, one[-1])) for one in (t, x)], "rows twice"),
    "every row twice": (lambda t, x: [np.repeat(one, 2) for one in (t, x)], "rows twice"),
}  # fmt: skip


@pytest.mark.parametrize("name", ENDS)
def test_rows_that_are_no_samples_are_dropped_and_said(name):
    t = np.arange(500) * 0.02
    change, code = ENDS[name]
    record = seen(*change(t, motion(t)))
    np.testing.assert_array_equal(record["displacement"].t, t)
    np.testing.assert_array_equal(record["displacement"].values, motion(t))
    assert [one.code for one in record.warnings] == [code]


def test_rounded_stamps_of_a_quiet_end_are_no_copies():
    t = np.arange(4000) * 5e-4
    x = np.round(motion(np.minimum(t, 1.8)), 5)
    record = seen(np.round(t, 2), x)
    assert [one.code for one in record.warnings] == ["rounded times"]
    assert record["displacement"].t.size == t.size


T = np.arange(400) * 0.02
WRONG = {
    "a second run": (np.append(T, T), "a second run begins at sample 401; .* from sample 1 to sample 400"),
    "a clock set back": (T - 0.5 * (T > 4.0), "goes back from 4 s to 3.52 s at sample 202;"),
    "both": (np.r_[T, T[:200], T[200:] + 5.0], "goes back .* at sample 401 and pauses .* at sample 601: a sec"),
    "no order": (np.random.default_rng(1).permutation(T), "goes back .* times more"),
    "a jump": (T + 5.0 * (T > 4.0), "jumps, .* from 4 s to 9.02 s at sample 202"),
    "a gap of an hour": (np.r_[T, T + 3600.0], "has a gap .* at sample 401"),
    "no time": (0.0 * T, "steps of 0 s"),
    "a second as resolution": (np.floor(10.0 * T), "has too few digits"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_all_that_is_wrong_with_a_clock_is_said_with_its_place(name):
    t, message = WRONG[name]
    true = t if name == "a gap of an hour" else np.arange(t.size) * 0.02
    with pytest.raises(RecordError, match=message):
        seen(t, motion(true % 30.0))
