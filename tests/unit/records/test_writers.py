"""Every format: what is written is read back, to the last bit where the format allows, and the same bytes each time."""

from __future__ import annotations

import time

import h5py
import numpy as np
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st

from dampbalance.records.errors import RecordError
from dampbalance.records.measurement import Channel, Measurement
from dampbalance.records.readers import open_channels, read
from dampbalance.records.writers import write

FORMATS = {
    "csv": (".csv", None),
    "tsv": (".tsv", None),
    "parquet": (".parquet", None),
    "matlab 5": (".mat", None),
    "matlab 7.3": (".mat", "matlab73"),
    "hdf5": (".h5", None),
    "uff": (".uff", None),
    "tdms": (".tdms", None),
    "wav": (".wav", None),
}
every_format = pytest.mark.parametrize(("suffix", "kind"), FORMATS.values(), ids=FORMATS)


def measurement(rate=5000.0, n=300, start=0.0, seed=7):
    """Arbitrary numbers of many magnitudes: what matters is that they come back."""
    random = np.random.default_rng(seed)
    t = start + np.arange(n) / rate
    values = random.standard_normal((3, n)) * 10.0 ** random.integers(-9, 3, (3, n))
    quantities = ("base_displacement", "displacement", "acceleration")
    return Measurement.of("made up", list(map(Channel, quantities, [t] * 3, values)))


def assert_same(found, expected):
    assert list(found) == list(expected)
    for quantity in expected:
        np.testing.assert_array_equal(found[quantity].t, expected[quantity].t)
        np.testing.assert_array_equal(found[quantity].values, expected[quantity].values)


@every_format
@pytest.mark.parametrize("rate", [5000.0, 44100.0, 51200.0])
def test_round_trip(tmp_path, suffix, kind, rate):
    record = measurement(rate)
    files = write(tmp_path / f"run{suffix}", record, kind)
    assert sorted(tmp_path.iterdir()) == sorted(files)  # nothing temporary is left
    found = read(tmp_path / f"run{suffix}")
    assert_same(found, record)
    assert found.source == str(tmp_path / f"run{suffix}")


FAST, SLOW = measurement(5000.0, 300), measurement(1000.0, 61, seed=8)
TIMES = {
    # a rate and a start that no header with six digits holds: the times themselves are stored
    r"whole number of samples per second": measurement(rate=1234.567, start=0.1234567890123),
    "one time base": Measurement.of("made up", [FAST["base_displacement"], SLOW["acceleration"]]),
}


@every_format
@pytest.mark.parametrize("message", TIMES, ids=["no simple grid", "times of its own for each"])
def test_times_that_a_wav_alone_cannot_hold(tmp_path, suffix, kind, message):
    path, record = tmp_path / f"run{suffix}", TIMES[message]
    if suffix == ".wav":
        with pytest.raises(RecordError, match=message):
            write(path, record, kind)
        assert not list(tmp_path.iterdir())
    else:
        write(path, record, kind)
        assert_same(read(path), record)


@every_format
@pytest.mark.parametrize("block", [3, 37, 299, 300, 1000])
def test_blocks_make_up_the_whole(tmp_path, suffix, kind, block):
    # 300 = 8 · 37 + 4: the last block is short; 299 leaves one sample, which joins the block before.
    record = measurement()
    path = tmp_path / f"run{suffix}"
    write(path, record, kind)
    for quantity, blocks in open_channels(path, block=block).items():
        t, values = zip(*blocks(), strict=True)
        assert all(len(part) == block for part in t[:-1])
        np.testing.assert_array_equal(np.concatenate(t), record[quantity].t)
        np.testing.assert_array_equal(np.concatenate(values), record[quantity].values)


def test_same_bytes_at_another_time(tmp_path):
    record = measurement()

    def written(folder):
        for suffix, kind in FORMATS.values():
            write(tmp_path / folder / f"{kind or 'run'}{suffix}", record, kind)
        return {file.name: file.read_bytes() for file in (tmp_path / folder).iterdir()}

    first = written("first")
    time.sleep(1.1)  # time stamps in files count whole seconds
    assert written("second") == first
    assert len(first) == len(FORMATS) + 1  # and the mapping of the WAV


def test_others_read_our_matlab_files(tmp_path):
    record = measurement()
    write(tmp_path / "run.mat", record)
    found = scipy.io.loadmat(tmp_path / "run.mat")
    assert found["displacement_m"].shape == (300, 1)  # a column, as in MATLAB
    np.testing.assert_array_equal(found["displacement_m"][:, 0], record["displacement"].values)
    assert found["__header__"].startswith(b"MATLAB 5.0 MAT-file, written by dampbalance")


def test_units_are_in_the_file(tmp_path):
    write(tmp_path / "run.h5", measurement())
    with h5py.File(tmp_path / "run.h5") as file:
        assert {name: data.attrs["unit"] for name, data in file.items()} == {
            "time_s": "s",
            "base_displacement_m": "m",
            "displacement_m": "m",
            "acceleration_m_per_s2": "m/s²",
        }


def test_a_wav_brings_its_mapping(tmp_path):
    files = write(tmp_path / "run.wav", measurement())
    assert files == (tmp_path / "run.wav", tmp_path / "run.wav.yaml")
    assert "acceleration: {channel: 3, unit: m/s²}" in files[1].read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "kind", "message"),
    [
        ("run.xyz", None, r"unknown suffix '\.xyz'; records end in \.csv"),
        ("run.csv", "hdf", "unknown format 'hdf'; known are text"),
        ("run.csv", "hdf5", "its suffix does not fit the format hdf5"),
    ],
)
def test_what_cannot_be_written(tmp_path, name, kind, message):
    with pytest.raises(RecordError, match=message):
        write(tmp_path / name, measurement(), kind)
    assert not list(tmp_path.iterdir())


def test_a_failure_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "run.parquet"
    write(path, measurement())
    before = path.read_bytes()

    def fail(*_, **__):
        raise OSError("disk full")

    monkeypatch.setattr("pyarrow.parquet.write_table", fail)
    with pytest.raises(OSError, match="disk full"):
        write(path, measurement(seed=9))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


# whole numbers may be integers that ran over, which a reader refuses
sound = st.floats(-1e15, 1e15, width=64).filter(lambda value: value == 0 or value % 1)


def moves(column):
    """Whether values differ by more than rounding."""
    low, high = min(column), max(column)
    return high - low > max(1e-15, 1e-9 * max(-low, high))


@settings(max_examples=15)  # each example writes and reads nine files
@given(
    rate=st.integers(1, 200_000),
    values=st.lists(st.tuples(sound, sound), min_size=3, max_size=40).filter(
        lambda rows: all(map(moves, zip(*rows, strict=True)))
    ),
)
def test_any_sound_values_come_back(tmp_path_factory, rate, values):
    columns = np.array(values).T
    t = np.arange(columns.shape[1]) / rate
    record = Measurement.of(
        "made up", [Channel("force", t, columns[0]), Channel("velocity", t, columns[1])]
    )
    folder = tmp_path_factory.mktemp("round_trip")
    for suffix, kind in FORMATS.values():
        path = folder / f"{kind or 'run'}{suffix}"
        write(path, record, kind)
        assert_same(read(path), record)
