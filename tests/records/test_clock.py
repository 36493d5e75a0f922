"""Times as loggers write them, with samples that are missing or there twice, and text after the data: samples in equal
steps are those of the exact signal, within the bound that is said; what is identified from them holds the truth, and a
sentence says what was left out."""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import CubicSpline

from dampbalance import (
    BaseMotion,
    Oscillator,
    RecordError,
    identify,
    measured_orbit,
    measured_ring_down,
    read_records,
    steady_orbit,
)
from records.formats import row, xlsx

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


EVEN = np.arange(0.0, 20.0, 0.02)
JITTER = np.cumsum(np.random.default_rng(1).uniform(0.018, 0.022, 999))
LOGGERS = {
    "jitter": np.insert(JITTER, 400, JITTER[400] - 1e-3),
    "steps of all sizes": np.cumsum(np.random.default_rng(1).uniform(0.008, 0.03, 1000)),
    "a long step": EVEN + 0.008 * (EVEN > 7.0),
    "drift": EVEN + 1e-3 * EVEN**2 / 20.0,
    "two rates": np.concatenate([EVEN[:600], 12.0 + np.arange(250) * 0.03]),
    "rounded jitter": np.round(JITTER, 3),
}


def seen(record, x):
    return read_records({"time_s": record, "displacement_m": x})[0]


@pytest.mark.parametrize("name", LOGGERS)
def test_samples_in_equal_steps_are_those_of_the_signal(name):
    t = LOGGERS[name]
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
    # at its rows it is much better known
    off = (channel.values - turns(channel.t))[(channel.t < 3.9) | (channel.t > 9.1)]
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
        t = np.arange(0.0, 20.0, 0.01) if "stamps" in clock else LOGGERS[clock]
        x = exact(t) + 1e-3 * X * random.standard_normal(t.size)
    if "stamps" in clock:  # the samples are in equal steps
        t = t + 0.002 * random.uniform(-1.0, 1.0, t.size)
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


# Samples that are missing

RIG = Oscillator(m=3.1, c=9.0, k=5200.0, K_z=160_000.0, F_k=2.1)


def forced():
    """Three levels of 20 cycles at 4.013 Hz, as columns."""
    options = {"rate_hz": 1000.0, "cycles": 20.0, "noise": 0.002}
    options["channels"] = ("base_displacement", "displacement")
    orbits = [steady_orbit(RIG, BaseMotion(Y, 25.2144)) for Y in (0.002, 0.003, 0.0045)]
    return [measured_orbit(of, seed=i, **options).columns() for i, of in enumerate(orbits)]


def decay(quantity, noise=0.001):
    """A decay of two seconds at 500 Hz, as columns."""
    options = {"rate_hz": 500.0, "duration": 2.0, "noise": noise, "channels": (quantity,)}
    return [measured_ring_down(RIG, x=0.01, **options).columns()]


def rows(change):
    """What changes all columns of records alike."""
    return lambda records: [{n: change(v) for n, v in one.items()} for one in records]


def lacking(at, last=True):
    """What makes some samples of the last column NaN, or of the first."""

    def lost(one):
        name = [*one][-1 if last else 0]
        gap = np.isin(np.arange(one[name].size), at)
        return one | {name: np.where(gap, np.nan, one[name])}

    return lambda records: [lost(one) for one in records]


ONE, TWELVE = rows(lambda v: np.delete(v, 300)), rows(lambda v: np.delete(v, np.arange(280, 292)))
TWICE = rows(lambda v: np.insert(v, 300, v[300]))
NAN, START = lacking([77, 301, 702]), lacking(np.arange(12))
STARTS = "sample 1, sample 2, sample 3, …"
PLACES = "sample 78, sample 302, sample 703"
DEFECTS = {
    "a row is missing": ("forced", ONE, ("rows missing", 1, "sample 301")),
    "a row is there twice": ("forced", TWICE, ("rows twice", 1, "sample 302")),
    "a time is NaN": ("forced", lacking([411], last=False), ("rows missing", 1, "sample 413")),
    "12 rows are missing": ("velocity", TWELVE, ("rows missing", 12, "sample 281")),
    "three are NaN": ("displacement", NAN, ("no numbers", 3, PLACES)),
    "the first are NaN": ("acceleration", START, ("no numbers", 12, STARTS)),
}


@cache
def of_whole(kind):
    """Records without a defect, and what is identified from them."""
    records = forced() if kind == "forced" else decay(kind)
    return records, identify(records, RIG.k)


@pytest.mark.parametrize("defect", DEFECTS)
def test_what_is_missing_is_left_out_and_said(defect):
    kind, change, said = DEFECTS[defect]
    records, whole = of_whole(kind)
    found = identify(change(records), RIG.k)
    for symbol in ("F_k", "c"):
        error, own = whole.standard_errors[symbol], found.standard_errors[symbol]
        assert abs(found.values[symbol] - getattr(RIG, symbol)) < 4.0 * own
        # the first of a thousand samples say most of a decay
        assert abs(found.values[symbol] - whole.values[symbol]) < 2.0 * error
        # and tell its departures apart, whose share is in the error
        assert own < 3.0 * error
    assert found.verdicts["F_k"].verdict == "usable"
    of = {(one.code, one.numbers.get("count"), one.numbers.get("places")) for one in found.findings}
    assert said in of
    assert said[0] not in {one.code for one in whole.findings}


@pytest.mark.parametrize(("quantity", "first"), [("displacement", 92), ("acceleration", 281)])
def test_the_balance_of_a_decay_with_a_gap_is_that_without(quantity, first):
    """A quarter of a cycle on a turn: a line through the gap is off by a tenth of the motion, 40 errors."""
    record = decay(quantity, noise=5e-4)
    gap = rows(lambda v: np.delete(v, np.arange(first, first + 25)))(record)
    whole, found = (identify(r, RIG.k).approaches["balance"].parameters for r in (record, gap))
    for symbol in ("F_k", "c"):
        off = found[symbol].value - whole[symbol].value
        assert abs(off) < whole[symbol].standard_error


def test_stamps_of_a_millisecond_do_not_hide_a_row():
    """At 1 kHz a missing row and a clock of 999.7 Hz with rounded stamps have the same times: the signals say which."""
    whole = forced()[0]
    whole["time_s"] = np.round(whole["time_s"], 3)
    (lost,) = rows(lambda v: np.delete(v, 2600))([whole])
    (record,) = read_records(lost)
    gap = np.arange(whole["time_s"].size) == 2600
    assert np.array_equal(record["displacement"].missing, gap)
    (record,) = read_records(whole | {"time_s": np.round(np.arange(gap.size) / 999.7, 3)})
    assert record["displacement"].missing is None
    assert record.warnings[0].numbers["resolution"] == pytest.approx(0.001)


@pytest.mark.parametrize(
    ("each", "message"),
    [(25, "sample 10: .*and so are 198 more"), (100, "only 0 usable .*: 20 of its cycles")],
)
def test_more_than_a_few_is_refused(each, message):
    with pytest.raises(ValueError, match=message):
        identify(lacking(np.arange(9, 5000, each))(forced()), RIG.k)


TAIL = [["", "", ""], ["End of record"], ["Operator", "Miller"], ["Maximum", 1.2, 3.4, 7.0]]


@pytest.mark.parametrize("suffix", ["csv", "xlsx"])
def test_text_after_the_data_is_left_aside(suffix, tmp_path):
    frame, file = pd.DataFrame(forced()[0]), tmp_path / f"run.{suffix}"
    if suffix == "xlsx":
        xlsx(file, [row(cells) for cells in ([*frame], *frame.to_numpy().tolist(), *TAIL)])
    else:
        tail = "\n".join(",".join(map(str, line)).rstrip(",") for line in TAIL)
        file.write_text(frame.to_csv(index=False) + tail + "\n", encoding="utf-8")
    (found,) = read_records(file)
    np.testing.assert_allclose(found.to_frame(), frame.set_index("time_s"), rtol=1e-15)
    last = len(frame) + 1  # after the header
    (said,) = found.warnings
    assert said.code == "text after numbers"
    assert (said.numbers["first"], said.numbers["last"]) == (last + 2, last + 4)


@pytest.mark.parametrize(("kind", "swing"), [("forced", 0.01), ("displacement", 0.0)])
def test_a_normal_force_and_a_base_at_rest_are_not_in_the_way(kind, swing):
    records, whole = of_whole(kind)
    load = 5.0 + swing * np.sin(np.arange(records[0]["time_s"].size) ** 2)
    rest = {} if kind == "forced" else {"base_displacement_m": 0.25 + 0.0 * load}
    more = [one | {"normal_force_N": load} | rest for one in records]
    assert identify(more, RIG.k).values == whole.values
