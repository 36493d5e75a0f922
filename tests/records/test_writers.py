"""Records written as text or for MATLAB are read back to the last bit, and have the same bytes each time."""

from __future__ import annotations

import time

import numpy as np
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st

from dampbalance.records.channel import Channel
from dampbalance.records.errors import RecordError
from dampbalance.records.readers import read
from dampbalance.records.record import Record
from dampbalance.records.writers import write

SUFFIXES = (".csv", ".tsv", ".txt", ".mat")
every_format = pytest.mark.parametrize("suffix", SUFFIXES)


def measurement(rate=5000.0, n=300, start=0.0, seed=7):
    """Arbitrary numbers of many magnitudes: what matters is that they come back."""
    random = np.random.default_rng(seed)
    t = start + np.arange(n) / rate
    values = random.standard_normal((3, n)) * 10.0 ** random.integers(-9, 3, (3, n))
    quantities = ("base_displacement", "displacement", "acceleration")
    return Record.of("made up", list(map(Channel, quantities, [t] * 3, values)))


def assert_same(found, expected):
    assert list(found) == list(expected)
    for quantity in expected:
        np.testing.assert_array_equal(found[quantity].t, expected[quantity].t)
        np.testing.assert_array_equal(found[quantity].values, expected[quantity].values)


@every_format
@pytest.mark.parametrize("rate", [5000.0, 44100.0, 51200.0])
def test_round_trip(tmp_path, suffix, rate):
    record = measurement(rate)
    file = write(tmp_path / f"run{suffix}", record)
    assert list(tmp_path.iterdir()) == [file]  # nothing temporary is left
    found = read(tmp_path / f"run{suffix}")
    assert_same(found, record)
    assert found.name == str(tmp_path / f"run{suffix}")


FAST, SLOW = measurement(5000.0, 300), measurement(1000.0, 61, seed=8)
TIMES = {
    # a rate and a start that no short number holds
    "no simple grid": measurement(rate=1234.567, start=0.1234567890123),
    "times of its own for each": Record.of(
        "made up", [FAST["base_displacement"], SLOW["acceleration"]]
    ),
}


@every_format
@pytest.mark.parametrize("record", TIMES.values(), ids=TIMES)
def test_any_times_come_back(tmp_path, suffix, record):
    assert_same(read(write(tmp_path / f"run{suffix}", record)), record)


def test_same_bytes_at_another_time(tmp_path):
    record = measurement()

    def written(folder):
        for suffix in SUFFIXES:
            write(tmp_path / folder / f"run{suffix}", record)
        return {file.name: file.read_bytes() for file in (tmp_path / folder).iterdir()}

    first = written("first")
    time.sleep(1.1)  # time stamps in files count whole seconds
    assert written("second") == first
    assert len(first) == len(SUFFIXES)


def test_others_read_our_matlab_files(tmp_path):
    record = measurement()
    write(tmp_path / "run.mat", record)
    found = scipy.io.loadmat(tmp_path / "run.mat")
    assert found["displacement_m"].shape == (300, 1)  # a column, as in MATLAB
    np.testing.assert_array_equal(found["displacement_m"][:, 0], record["displacement"].values)
    assert found["__header__"].startswith(b"MATLAB 5.0 MAT-file, written by dampbalance")


@pytest.mark.parametrize("name", ["run.xyz", "run.parquet", "run"])
def test_a_suffix_that_is_not_written_is_refused_in_a_sentence(tmp_path, name):
    with pytest.raises(RecordError, match=r"records are not written as .*, but as \.csv, .*\.mat"):
        write(tmp_path / name, measurement())
    assert not list(tmp_path.iterdir())


# whole numbers may be integers that ran over, which a reader refuses
sound = st.floats(-1e15, 1e15, width=64).filter(lambda value: value == 0 or value % 1)


def moves(column):
    """Whether values differ by more than rounding."""
    low, high = min(column), max(column)
    return high - low > max(1e-15, 1e-9 * max(-low, high))


@settings(max_examples=15)  # each example writes and reads four files
@given(
    rate=st.integers(1, 200_000),
    values=st.lists(st.tuples(sound, sound), min_size=3, max_size=40).filter(
        lambda rows: all(map(moves, zip(*rows, strict=True)))
    ),
)
def test_any_sound_values_come_back(tmp_path_factory, rate, values):
    columns = np.array(values).T
    t = np.arange(columns.shape[1]) / rate
    record = Record.of(
        "made up", [Channel("force", t, columns[0]), Channel("velocity", t, columns[1])]
    )
    folder = tmp_path_factory.mktemp("round_trip")
    for suffix in SUFFIXES:
        assert_same(read(write(folder / f"run{suffix}", record)), record)
