"""Records in memory are read as files are: the same numbers, the same errors; simulated ones are the exact motion plus
the noise asked."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from dampbalance import BaseMotion, RecordError, measured_orbit, read_records, steady_orbit
from dampbalance.records.channel import Channel, sample_times
from dampbalance.records.record import Record
from paper_case import NEAR, OMEGA, PAPER

BOTH = ("base_displacement", "acceleration")
ORBIT = steady_orbit(PAPER, BaseMotion(Y=0.004, omega=7.0 * math.pi))
MADE = measured_orbit(ORBIT, rate_hz=1000.0, cycles=4.0, noise=0.01, channels=BOTH)
T, Y, A = MADE["acceleration"].t, MADE["base_displacement"].values, MADE["acceleration"].values
ARRAYS = {"time_s": T, "base_displacement_mm": 1e3 * Y, "acceleration_g": A / 9.80665}


def same(record, exact=0.0):
    """Whether a record holds the signals made: to rounding of a change of units, unless exact."""
    assert record.quantities == BOTH
    for quantity, values in zip(BOTH, (Y, A), strict=True):
        np.testing.assert_allclose(record[quantity].values, values, rtol=1e-15, atol=0.0)
        np.testing.assert_allclose(record[quantity].t - T, 0.0, atol=exact)
    return True


FRAMES = {
    "arrays": ARRAYS,
    "frame": pd.DataFrame(ARRAYS),
    "index": pd.DataFrame(ARRAYS).set_index("time_s"),
    "rate": {k: v for k, v in ARRAYS.items() if k != "time_s"} | {"sample_rate_hz": 1000.0},
    "series": {name: pd.Series(values) for name, values in ARRAYS.items()},
    "fields": np.rec.fromarrays(list(ARRAYS.values()), names=list(ARRAYS)),
    "measurement": MADE,
}


@pytest.mark.parametrize("form", FRAMES)
def test_signals_in_memory_are_those_of_a_file(form):
    assert same(read_records(FRAMES[form])[0], exact=1e-15)


SIGNALS = {name: ARRAYS[name] for name in ("base_displacement_mm", "acceleration_g")}
HIDDEN = np.arange(T.size) == 7
MISSING = {
    "masked": np.ma.array(A, mask=HIDDEN),
    "masked list": [np.ma.masked if hidden else a for a, hidden in zip(A, HIDDEN, strict=True)],
    "NA": pd.array(A, dtype="Float64"),
    "whole NA": pd.array(np.round(1e6 * A).astype(int), dtype="Int64"),
    "Arrow": pd.array(A, dtype="float64[pyarrow]"),
    "objects": A.astype(object),
}
for _name in ("NA", "whole NA", "Arrow", "objects"):
    MISSING[_name][7] = pd.NA


@pytest.mark.parametrize("form", MISSING)
def test_a_masked_sample_is_missing(form):
    """100 masked samples were once read as data."""
    table = dict if form.startswith("masked") else pd.DataFrame  # which makes NaN of a mask itself
    (record,) = read_records(table(ARRAYS | {"acceleration_g": MISSING[form]}))
    assert np.array_equal(record["acceleration"].missing, HIDDEN)
    assert record["base_displacement"].missing is None
    (said,) = record.warnings
    assert said.code == "no numbers"
    assert (said.numbers["count"], said.numbers["places"]) == (1, "sample 8")


def test_masked_times_are_missing_too():
    stamps = np.datetime64("2026-01-01") + (1e9 * T).astype("timedelta64[ns]")
    for times in (T, stamps):
        hidden = np.ma.array(times, mask=HIDDEN)
        (record,) = read_records({"time" + "_s" * (times is T): hidden} | SIGNALS)
        for quantity in BOTH:
            assert np.array_equal(record[quantity].missing, HIDDEN)
            np.testing.assert_allclose(record[quantity].t, T, rtol=0.0, atol=2e-9)
        assert record.to_frame().isna().sum().tolist() == [1, 1]


def test_points_in_time_are_seconds_from_the_first():
    zones = pd.to_datetime("2026-03-29T01:59:59+01:00") + pd.to_timedelta(T, unit="s")
    for stamps in (zones, zones.tz_convert(None), pd.to_timedelta(T, unit="s")):
        frame = pd.DataFrame(ARRAYS | {"time_s": 0.0}, index=stamps).drop(columns="time_s")
        for index in (frame.rename_axis("time"), frame):
            assert same(read_records(index)[0], exact=1e-9)  # stamps are in ns


def test_what_the_caller_does_later_to_an_array_changes_no_record():
    own = {"time_s": T, "base_displacement_m": Y.copy(), "acceleration_m_per_s2": A}
    (record,) = read_records(own)
    own["base_displacement_m"][:] = 0.0
    assert same(record)


def test_names_tell_records_apart():
    named = pd.DataFrame(ARRAYS)
    named.attrs["name"] = "4 mm"
    read = read_records([named, ARRAYS, named, MADE, MADE])
    made = "simulated, Y = 0.004 m"
    assert [record.name for record in read] == ["4 mm", "record 2", "4 mm (2)", made, f"{made} (2)"]
    assert read_records(read) == read
    assert "1,143 samples from 0 s to 1.142 s at 1000 Hz" in repr(read[1])


def test_a_record_goes_back_to_a_table():
    frame = read_records(ARRAYS)[0].to_frame()
    assert list(frame.columns) == ["base_displacement_m", "acceleration_m_per_s2"]
    assert frame.index.name == "time_s"
    assert same(read_records(frame)[0], exact=1e-15)


RATED = {"time_s": None, "fs": 1000.0}
SPOILED = {
    "record 1: finds no response": {"acceleration_g": None},
    "record 1: sample 8: .*acceleration": {
        "acceleration_g": np.where(np.arange(T.size) % 25 == 7, np.nan, A)
    },
    "'acceleration' has .*, its time 'time' has": {"acceleration_g": A[:-3]},
    "unequal lengths: channel 'base_disp.* channel 'acc": RATED | {"acceleration_g": A[:-3]},
    "fs of channel .* not a number within .*; give sample_rate_hz": RATED | {"fs": 0.0},
    r"'acceleration_g' has the shape \(1, 2, ": {"acceleration_g": np.stack([[A, A]])},
    "'acceleration_g' holds complex numbers": {"acceleration_g": A + 1j},
    "'acceleration_g' holds texts": {"acceleration_g": ["1.0"] * T.size},
    "'acceleration_g' holds what are not numbers": {"acceleration_g": [{}] * T.size},
    "'acceleration_g' is a single value": {"acceleration_g": 9.81},
    "in which unit is .acceleration.. Say it in mapp": {"acceleration_g": None, "acceleration": A},
    r"'S' is a unit of a conductance \(.* s\?\)": {"time_s": None, "TIME [S]": T},
}


NO_RECORDS = {
    message: {name: of for name, of in (ARRAYS | spoiled).items() if of is not None}
    for message, spoiled in SPOILED.items()
} | {
    "record 1 is a float; give the path": [3.0],
    "(?s)record 2: .*'column.3.'": [ARRAYS, np.zeros((9, 3))],
    "two columns 'x'": pd.DataFrame(np.zeros((4, 2)), columns=["x", "x"]),
    "nowhere.csv": "nowhere.csv",
}


@pytest.mark.parametrize("message", NO_RECORDS)
def test_what_is_no_record_is_refused(message):
    with pytest.raises(RecordError, match=message):
        read_records(NO_RECORDS[message])


def test_a_folder_is_its_records_in_order(tmp_path):
    """A file that holds channels of others, and what is no record, are none."""
    with pytest.raises(RecordError, match=r"holds no records, whose files end in \.csv"):
        read_records(tmp_path)
    for name in ("run10.csv", "run9.csv", "table.dat", "notes.md", "found"):
        pd.DataFrame(ARRAYS).to_csv(tmp_path / name, index=False)
    base = "base_displacement: {channel: base_displacement, file: table.dat}"
    text = f"channels:\n  {base}\n  acceleration: {{channel: acceleration}}\n"
    (tmp_path / "run10.yaml").write_text(text, encoding="utf-8")
    read = read_records([tmp_path, ARRAYS])
    assert [record.label for record in read] == ["run9.csv", "run10.csv", "record 3"]


# Channels, and simulated records

STEADY = steady_orbit(PAPER, BaseMotion(0.008, OMEGA))
FIVE = np.arange(5) / 100.0


def channel(quantity="displacement", t=FIVE, values=None, name="A1"):
    return Channel(quantity, t, np.sin(t) if values is None else values, name)


def test_a_channel_is_read_only_and_leaves_the_array_it_came_from_alone():
    values = np.sin(FIVE)
    made = channel(values=values)
    with pytest.raises(ValueError, match="read-only"):
        made.values[0] = 1.0
    values[0] = 2.0  # still the caller's to write


WRONG = {
    "its quantity must be one of .*, got 'jerk'": {"quantity": "jerk"},
    "4 values at 5 times": {"values": np.zeros(4)},
    "1 samples": {"t": FIVE[:1], "values": FIVE[:1]},
    "value 2 .* is nan": {"values": np.array([0, 1, np.nan, 3, 4.0])},
    "value 1 .* is 1e.16, beyond": {"values": np.array([0, 1e16, 2, 3, 4.0])},
    "time 2 .* is inf": {"t": np.array([0, 1, np.inf, 3, 4.0]), "values": FIVE},
    "not in equal steps: 0 s from sample 1 to 2": {"t": np.array([0, 1, 1, 3, 4.0])},
}


@pytest.mark.parametrize("message", WRONG)
def test_a_channel_that_is_no_signal_is_refused_by_name(message):
    with pytest.raises(ValueError, match=f"channel 'A1'.*{message}"):
        channel(**WRONG[message])


SETS = {
    "found base_displacement and force": ["force", "base_displacement", "velocity"],
    "needs a response": ["force"],
    "both hold velocity": ["force", "velocity", "velocity"],
}


@pytest.mark.parametrize("message", SETS)
def test_a_measurement_has_one_excitation_at_most_and_a_response(message):
    with pytest.raises(ValueError, match=f"run7: .*{message}"):
        Record.of("run7", [channel(q, name=f"c{i}") for i, q in enumerate(SETS[message])])
    free = Record.of("run7", [channel("displacement")])
    with pytest.raises(ValueError, match=r"run7: needs one excitation .* found none"):
        _ = free.excitation


def test_the_simulated_signals_are_those_of_the_exact_orbit():
    channels = ("force", "displacement", "velocity", "acceleration")
    made = measured_orbit(STEADY, rate_hz=997.0, cycles=3.5, channels=channels, start=0.7)
    t = made["force"].t
    assert t[0] == 0.7
    assert len(t) == round(3.5 / NEAR * 997.0)
    state = STEADY.state(t)
    truth = {"displacement": state.x, "velocity": state.v, "acceleration": state.acceleration}
    for quantity, values in truth.items():
        np.testing.assert_array_equal(made[quantity].values, values)
    np.testing.assert_allclose(
        made["force"].values, PAPER.k * BaseMotion(0.008, OMEGA).y(t), rtol=1e-14
    )
    assert [c.quantity for c in made.responses] == [*truth]


@pytest.mark.parametrize(("start", "rate_hz"), [(0.1, 1000.0), (0.02, 100.0), (-0.2, 5000.0)])
def test_times_are_the_decimal_numbers_that_they_stand_for(start, rate_hz):
    """0.102 at 1 kHz from 0.1 s on, and not 0.10200000000000001: Python writes the shortest number of each float."""
    at = [round(start * 10_000) + round(10_000 / rate_hz) * i for i in range(3000)]
    assert sample_times(rate_hz, start, 0, 3000).tolist() == [n / 10_000 for n in at]


def test_the_noise_is_white_of_the_size_asked_for_and_the_same_for_the_same_seed():
    options = {"rate_hz": 5000.0, "cycles": 40.0, "channels": ("base_displacement", "velocity")}
    clean = measured_orbit(STEADY, **options)
    noisy, again = (
        measured_orbit(STEADY, noise={"velocity": 0.02}, seed=3, **options) for _ in range(2)
    )
    for quantity, one in (("velocity", again), ("base_displacement", clean)):
        np.testing.assert_array_equal(noisy[quantity].values, one[quantity].values)
    added = noisy["velocity"].values - clean["velocity"].values
    size, n = 0.02 * math.sqrt(np.mean(clean["velocity"].values ** 2)), added.size
    # the standard deviation of n normal values scatters by 1/√(2n), its autocorrelation by 1/√n: four sigma each
    assert abs(added.std() / size - 1.0) < 4.0 / math.sqrt(2.0 * n)
    assert abs(np.corrcoef(added[1:], added[:-1])[0, 1]) < 4.0 / math.sqrt(n)
