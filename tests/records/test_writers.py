"""Records written as text or for MATLAB are read back to the last bit, and have the same bytes each time."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.io

from dampbalance.records.channel import Channel
from dampbalance.records.errors import RecordError
from dampbalance.records.readers import read
from dampbalance.records.record import Record
from dampbalance.records.writers import write

SUFFIXES = (".csv", ".tsv", ".mat")


def measurement(rate=5000.0, n=300, start=0.0, seed=7):
    """Arbitrary numbers of many magnitudes: what matters is that they come back."""
    random = np.random.default_rng(seed)
    t = start + np.arange(n) / rate
    values = random.standard_normal((3, n)) * 10.0 ** random.integers(-9, 3, (3, n))
    quantities = ("base_displacement", "displacement", "acceleration")
    return Record.of("made up", list(map(Channel, quantities, [t] * 3, values)))


FAST, SLOW = measurement(44100.0, 300), measurement(1000.0, 61, seed=8)
RECORDS = {
    "an even rate": FAST,
    # a rate and a start that no short number holds
    "no simple grid": measurement(rate=1234.567, start=0.1234567890123),
    "times of its own for each": Record.of("", [FAST["base_displacement"], SLOW["acceleration"]]),
}


def assert_comes_back(file, record):
    found = read(write(file, record))
    assert list(found) == list(record)
    for quantity in record:
        np.testing.assert_array_equal(found[quantity].t, record[quantity].t)
        np.testing.assert_array_equal(found[quantity].values, record[quantity].values)
    assert found.name == str(file)


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("record", RECORDS.values(), ids=RECORDS)
def test_records_come_back(tmp_path, suffix, record):
    file = tmp_path / f"run{suffix}"
    assert_comes_back(file, record)
    assert list(tmp_path.iterdir()) == [file]  # nothing temporary is left


def test_others_read_our_matlab_files(tmp_path):
    write(tmp_path / "run.mat", FAST)
    found = scipy.io.loadmat(tmp_path / "run.mat")
    assert found["displacement_m"].shape == (300, 1)  # a column, as in MATLAB
    np.testing.assert_array_equal(found["displacement_m"][:, 0], FAST["displacement"].values)
    # without the time of day
    assert (tmp_path / "run.mat").read_bytes()[:116].rstrip().endswith(b"written by dampbalance")


def test_a_suffix_that_is_not_written_is_refused(tmp_path):
    with pytest.raises(RecordError, match=r"records are not written as .*, but as \.csv, .*\.mat"):
        write(tmp_path / "run.parquet", FAST)
    assert not list(tmp_path.iterdir())
