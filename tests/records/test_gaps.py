"""Records with samples that are missing or there twice, and text after the data: the answer is near that without the
defect and holds the truth, and a sentence says what was left out."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

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
from dampbalance.records.readers import read
from records.workbooks import row, xlsx

OSC = Oscillator(m=3.1, c=9.0, k=5200.0, K_z=160_000.0, F_k=2.1)
UNITS = {"base_displacement": "m", "displacement": "m", "velocity": "m_per_s", "acceleration": "m_per_s2"}  # fmt: skip


def arrays(measurement):
    """Signals of a measurement by the names of columns, their times first."""
    t = next(iter(measurement.channels.values())).t
    return {"time_s": t} | {f"{q}_{UNITS[q]}": measurement[q].values for q in measurement}


def forced(seed=0, rate=1000.0, noise=0.002):
    """Three levels of 20 cycles at 4.013 Hz."""
    both = ("base_displacement", "displacement")
    orbits = [steady_orbit(OSC, BaseMotion(Y, 25.2144)) for Y in (0.002, 0.003, 0.0045)]
    options = {"rate_hz": rate, "cycles": 20.0, "noise": noise, "channels": both}
    return [arrays(measured_orbit(o, seed=seed + i, **options)) for i, o in enumerate(orbits)]


def decay(quantity, seed=0, noise=0.001):
    """A decay of two seconds at 500 Hz."""
    options = {"rate_hz": 500.0, "duration": 2.0, "noise": noise, "channels": (quantity,)}
    return [arrays(measured_ring_down(OSC, x=0.01, seed=seed, **options))]


def loops(seed=0):
    """Twelve cycles of a slider with a damper, of the same F_k, K_z and c."""
    t = np.arange(6000) / 500.0
    x, z = 1e-3 * np.sin(6.365 * t), np.zeros(6000)
    for i in range(1, t.size):
        z[i] = np.clip(z[i - 1] + x[i] - x[i - 1], -OSC.F_k / OSC.K_z, OSC.F_k / OSC.K_z)
    noise = 0.005 * np.random.default_rng(seed).standard_normal(t.size)
    force = OSC.K_z * z + OSC.c * np.gradient(x, t) + noise
    return [{"time_s": t, "displacement_m": x, "force_N": force}]


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


DEFECTS = {
    "a row is missing": (rows(lambda v: np.delete(v, 300)), ("rows missing", 1, "sample 301")),
    "a row is there twice": (rows(lambda v: np.insert(v, 300, v[300])), ("rows twice", 1, "sample 302")),
    "12 rows are missing": (rows(lambda v: np.delete(v, np.arange(280, 292))), ("rows missing", 12, "sample 281")),
    "three are NaN": (lacking([77, 301, 702]), ("no numbers", 3, "sample 78, sample 302, sample 703")),
    "a time is NaN": (lacking([411], last=False), ("rows missing", 1, "sample 413")),
    "the first are NaN": (lacking(np.arange(12)), ("no numbers", 12, "sample 1, sample 2, sample 3, …")),
}  # fmt: skip
KINDS = {
    "forced": (forced, "a row is missing"),
    "decay of displacement": (lambda: decay("displacement"), "three are NaN"),
    "decay of velocity": (lambda: decay("velocity"), "12 rows are missing"),
    "decay of acceleration": (lambda: decay("acceleration"), "the first are NaN"),
    "loops": (loops, "a time is NaN"),
    "forced twice": (forced, "a row is there twice"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_missing_is_left_out_and_said(kind):
    make, defect = KINDS[kind]
    records, (change, said) = make(), DEFECTS[defect]
    k = None if "force_N" in records[0] else OSC.k  # loops hold it
    whole, found = identify(records, k), identify(change(records), k)
    for symbol in ("F_k", "c"):
        error, own = whole.standard_errors[symbol], found.standard_errors[symbol]
        assert abs(found.values[symbol] - getattr(OSC, symbol)) < 4.0 * own
        # the first of a thousand samples say most of a decay
        assert abs(found.values[symbol] - whole.values[symbol]) < 2.0 * error
        # and tell its departures apart, whose share is in the error
        assert own < 3.0 * error
    assert found.verdicts["F_k"].verdict == "usable"
    of = {(one.code, one.numbers.get("count"), one.numbers.get("places")) for one in found.findings}
    before = {one.code for one in whole.findings}
    assert said in of
    assert said[0] not in before
    # a departure that may be there is said from a weight on, which samples left out change
    assert before - {"weighs"} <= {code for code, *_ in of}


def test_the_balance_of_a_decay_with_a_gap_is_that_without():
    """A quarter of a cycle on a turn: a line through the gap is off by a tenth of the motion, 40 errors."""
    for quantity, first in (("displacement", 92), ("velocity", 130), ("acceleration", 281)):
        (record,) = decay(quantity, noise=5e-4)
        whole = identify(record, OSC.k).approaches["balance"].parameters
        gap = rows(lambda v, at=first: np.delete(v, np.arange(at, at + 25)))([record])
        found = identify(gap, OSC.k).approaches["balance"].parameters
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


REFUSED = {
    "one in 25": (lacking(np.arange(9, 5000, 25)), "sample 10: .*and so are 198 more"),
    "one in every cycle": (lacking(np.arange(9, 5000, 100)), "only 0 usable .*: 20 of its cycles"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_more_than_a_few_is_refused(what):
    change, message = REFUSED[what]
    with pytest.raises(ValueError, match=message):
        identify(change(forced()), OSC.k)


TAIL = [["", "", ""], ["End of record"], ["Operator", "Miller"], ["Maximum", 1.2, 3.4, 7.0]]


@pytest.mark.parametrize("suffix", ["csv", "xlsx"])
def test_text_after_the_data_is_left_aside(suffix, tmp_path):
    (record, *_), file = forced(), tmp_path / f"run.{suffix}"
    frame = pd.DataFrame(record)
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


def test_text_after_data_whose_samples_say_what_they_are_is_told(tmp_path):
    (record,), file = decay("displacement"), tmp_path / "run.csv"
    frame = pd.DataFrame(record).set_axis(["time_s", "laser_m"], axis=1)
    file.write_text(f"{frame.to_csv(index=False)}End of record\n", encoding="utf-8")
    (found,) = read_records(file)
    assert [said.code for said in found.warnings] == ["text after numbers"]


def test_text_before_further_data_is_refused(tmp_path):
    (record, *_), file = forced(), tmp_path / "run.csv"
    text = pd.DataFrame(record).to_csv(index=False).splitlines(keepends=True)
    file.write_text("".join([*text[:4000], "pause\n", *text[4000:]]), encoding="utf-8")
    with pytest.raises(RecordError, match="line 4001 has 1 cells, the others 3"):
        read(file)


@pytest.mark.parametrize("swing", [0.0, 0.01])
def test_a_normal_force_is_not_in_the_way_of_forced_records(swing):
    records = forced()
    load = 5.0 + swing * np.sin(np.arange(records[0]["time_s"].size) ** 2)
    more = [one | {"normal_force_N": load} for one in records]
    assert identify(more, OSC.k).values == identify(records, OSC.k).values


@pytest.mark.parametrize("column", ["base_displacement_m", "normal_force_N"])
def test_a_channel_at_rest_is_not_in_the_way_of_a_decay(column):
    (record,) = decay("displacement")
    more = record | {column: np.full(record["time_s"].size, 0.25)}
    assert identify(more, OSC.k).values == identify(record, OSC.k).values
