"""Records with samples that are missing or there twice, and text after the data: the answer is near that without the
defect and holds the truth, and a sentence says what was left out."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from dampbalance import (
    BaseMotion,
    Oscillator,
    identify,
    measured_orbit,
    measured_ring_down,
    read_records,
    steady_orbit,
)
from records.workbooks import row, xlsx

OSC = Oscillator(m=3.1, c=9.0, k=5200.0, K_z=160_000.0, F_k=2.1)


def forced():
    """Three levels of 20 cycles at 4.013 Hz, as columns."""
    options = {"rate_hz": 1000.0, "cycles": 20.0, "noise": 0.002}
    options["channels"] = ("base_displacement", "displacement")
    orbits = [steady_orbit(OSC, BaseMotion(Y, 25.2144)) for Y in (0.002, 0.003, 0.0045)]
    return [measured_orbit(of, seed=i, **options).columns() for i, of in enumerate(orbits)]


def decay(quantity, noise=0.001):
    """A decay of two seconds at 500 Hz, as columns."""
    options = {"rate_hz": 500.0, "duration": 2.0, "noise": noise, "channels": (quantity,)}
    return [measured_ring_down(OSC, x=0.01, **options).columns()]


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


@pytest.mark.parametrize("defect", DEFECTS)
def test_what_is_missing_is_left_out_and_said(defect):
    kind, change, said = DEFECTS[defect]
    records = forced() if kind == "forced" else decay(kind)
    whole, found = identify(records, OSC.k), identify(change(records), OSC.k)
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


@pytest.mark.parametrize(
    ("quantity", "first"), [("displacement", 92), ("velocity", 130), ("acceleration", 281)]
)
def test_the_balance_of_a_decay_with_a_gap_is_that_without(quantity, first):
    """A quarter of a cycle on a turn: a line through the gap is off by a tenth of the motion, 40 errors."""
    record = decay(quantity, noise=5e-4)
    gap = rows(lambda v: np.delete(v, np.arange(first, first + 25)))(record)
    whole, found = (identify(r, OSC.k).approaches["balance"].parameters for r in (record, gap))
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
        identify(lacking(np.arange(9, 5000, each))(forced()), OSC.k)


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


@pytest.mark.parametrize(("kind", "swing"), [("forced", 0.01), ("decay", 0.0)])
def test_a_normal_force_is_not_in_the_way(kind, swing):
    records = forced() if kind == "forced" else decay("displacement")
    load = 5.0 + swing * np.sin(np.arange(records[0]["time_s"].size) ** 2)
    more = [one | {"normal_force_N": load} for one in records]
    assert identify(more, OSC.k).values == identify(records, OSC.k).values


def test_a_base_at_rest_is_not_in_the_way_of_a_decay():
    (record,) = decay("displacement")
    more = record | {"base_displacement_m": np.full(record["time_s"].size, 0.25)}
    assert identify(more, OSC.k).values == identify(record, OSC.k).values
