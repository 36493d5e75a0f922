"""Records as laboratories write them, made here by other programs' rules; and one clear error for each bad one."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

import h5py
import nptdms
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io
from scipy.io import wavfile

from dampbalance.records.channel import Channel
from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import read, table
from dampbalance.records.record import Record
from dampbalance.records.writers import write
from records.formats import write_columns

RATE = 1000.0
N = 8
T = np.arange(N) / RATE  # s
Y = np.array([0.0, 1.0, 2.0, 1.5, 0.25, -1.0, -2.0, -0.5])  # base displacement, mm
A = np.array([0.5, -0.25, 1.25, 3.0, -1.5, 0.75, 0.125, -2.0])  # acceleration, g
G = 9.80665

# Numbers with few digits, so that text holds them exactly; a product with a unit is rounded once here and there alike.
EXPECTED = {"base_displacement": Y * 1e-3, "acceleration": A * G}


def assert_expected(found):
    assert list(found) == list(EXPECTED)
    for quantity, values in EXPECTED.items():
        np.testing.assert_array_equal(found[quantity].values, values)
        # ms become s by one more rounding
        np.testing.assert_allclose(found[quantity].t, T, rtol=1e-15, atol=0.0)


@pytest.fixture
def csv(tmp_path):
    """Writes a text to a file that the test reads, and gives its path."""

    def written(text):
        path = tmp_path / "run.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def two(base, acceleration, scale=1.0, **more):
    """A mapping that says which channel is which, and more about the record."""
    given = {"base_displacement": (base, "mm"), "acceleration": (acceleration, "g")}
    rules = {q: {"channel": c, "unit": unit, "scale": scale} for q, (c, unit) in given.items()}
    return {"channels": rules} | more


def rows(delimiter=",", decimal=".", columns=(T, Y, A), end="\n"):
    lines = (
        delimiter.join(repr(float(v)).replace(".", decimal) for v in row)
        for row in zip(*columns, strict=True)
    )
    return end.join(lines) + end


HEADER = "time [s],base displacement [mm],acc [g]\n"

LAYOUTS = {
    "units in brackets": HEADER + rows(),
    "units after a slash": "t / s;y / mm;acc / g\n" + rows(";"),
    "units in the names": "time_s,base_displacement_mm,acceleration_g\n" + rows(),
    "a line of units": "time,base,acc\ns,mm,g\n" + rows(),
    "a line of units in brackets": "time,base,acc\n[s],[mm],[g]\n" + rows(),
    "many header lines": "Rig 3, second run\nDate: 4.5.2021\n\nOperator,N. N.\n" + HEADER + rows(),
    "comments": "% made by hand\n% time [s], base [mm], acc [g]\n" + rows() + "% the end\n",
    "a comment between the rows": HEADER + rows().replace("\n0.004", " # hit\n\n# pause\n0.004"),
    "semicolon and decimal comma": HEADER.replace(",", ";") + rows(";", ","),
    "tab and decimal comma": HEADER.replace(",", "\t") + rows("\t", ","),
    "a tab before each line": re.sub(r"(?m)^(?=.)", "\t", HEADER.replace(",", "\t") + rows("\t")),
    "bar": HEADER.replace(",", "|") + rows("|"),
    "blanks, names in two words": "time [s]  base displacement [mm]  acc [g]\n" + rows(" "),
    "blanks and decimal comma": "time_s base_mm acc_g\n" + rows(" ", ","),
    "aligned": "time_s base_mm acc_g\n" + re.sub(r"(?m)^", "   ", rows("   ").rstrip("\n")) + "\n",
    "quoted numbers": HEADER + re.sub(r"[^,\n]+", r'"\g<0>"', rows()),
    "delimiters at the end": "time [s],base [mm],acc [g],\n" + rows().replace("\n", ",\n"),
    "Windows line ends": HEADER.replace("\n", "\r\n") + rows(end="\r\n"),
    "milliseconds": HEADER.replace("[s]", "[ms]") + rows(columns=(T * 1e3, Y, A)),
    "exponents": HEADER + "".join(f"{t:.3e},{y:.4E},{a:+.6e}\n" for t, y, a in zip(T, Y, A, strict=True)),
}  # fmt: skip


@pytest.mark.parametrize(("name", "text"), LAYOUTS.items(), ids=LAYOUTS)
def test_text_layouts(tmp_path, name, text):
    path = tmp_path / ("run.lvm" if "tab" in name else "run.txt")
    path.write_bytes(text.encode())
    assert_expected(read(path))


OWN_TIMES = (
    "t1 [s],base [mm],t2 [s],acc [g]\n",  # the nearest to the left
    "base_time [s],base [mm],acc_time [s],acc [g]\n",  # or by name
    "time,base,time,acc\ns,mm,s,g\n",
)


@pytest.mark.parametrize("header", OWN_TIMES)
def test_each_channel_takes_its_own_times(csv, header):
    found = read(csv(header + rows(columns=(T, Y, T + 0.25, A))))
    np.testing.assert_array_equal(found["base_displacement"].t, T)
    np.testing.assert_array_equal(found["acceleration"].t, T + 0.25)


def test_mapping_by_name_and_number(csv):
    path = csv("clock,CH1 [V],CH2 [V]\n" + rows(columns=(T * 1e3, Y / 2, -A)))
    mapping = two("CH1", 3)
    mapping["channels"]["base_displacement"]["scale"] = 2.0
    mapping["channels"]["acceleration"]["sign"] = -1
    assert_expected(read(path, mapping | {"time": {"channel": "clock", "unit": "ms"}}))
    assert_expected(read(path, mapping | {"sample_rate_hz": RATE}))
    path = csv(rows(columns=(Y, A)))  # no header, no times
    assert_expected(read(path, two(1, 2, sample_rate_hz=RATE)))


def test_mapping_of_the_layout(csv):
    # Rows of numbers above the header: only the mapping can tell that they are no samples.
    path = csv("1;2;3\n4;5;6\n" + HEADER.replace(",", ";") + rows(";", ","))
    with pytest.raises(RecordError):
        read(path)
    assert_expected(read(path, {"header_lines": 3, "delimiter": ";", "decimal": ","}))


@pytest.mark.parametrize("rate", [{"sample_rate": RATE}, {"dt": 1 / RATE}], ids=["rate", "step"])
@pytest.mark.parametrize("place", ["array", "group", "file"])
def test_hdf5_attributes(tmp_path, rate, place):
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        group = file.create_group("run 1")
        for name, values, unit in (("base", Y, "mm"), ("acc", A, b"g")):
            data = group.create_dataset(name, data=values)
            data.attrs.update({"unit": unit} | (rate if place == "array" else {}))
        {"array": data, "group": group, "file": file}[place].attrs.update(rate)
    assert_expected(read(path))


def test_tdms_groups_and_segments(tmp_path):
    path, waveform = tmp_path / "run.tdms", {"wf_increment": 1 / RATE, "wf_start_offset": 0.0}
    of_base, of_mass = ({"unit_string": unit} | waveform for unit in ("mm", "g"))
    with nptdms.TdmsWriter(str(path)) as file:
        for part in (slice(0, 5), slice(5, N)):  # a logger writes piece by piece
            base = nptdms.ChannelObject("base", "y", Y[part], of_base)
            acc = nptdms.ChannelObject("mass", "acc", A[part].astype(np.float32), of_mass)
            file.write_segment([base, acc])
    assert_expected(read(path))
    assert [raw.name for raw in table(path).channels] == ["base/y", "mass/acc"]


WAV = {"<i2": (2**15, 0), "<i4": (2**31, 0), "u1": (128, 128), "<f4": (1, 0), "<f8": (1, 0)}


@pytest.mark.parametrize("dtype", WAV)
def test_wav_in_parts_of_full_scale(tmp_path, dtype):
    path, (full, zero) = tmp_path / "run.wav", WAV[dtype]
    parts = np.stack([Y, A], axis=1) / 4.0  # multiples of 1/32, which eight bits resolve
    wavfile.write(path, int(RATE), (parts * full + zero).astype(dtype))
    assert_expected(read(path, two(1, "channel 2", scale=4.0)))


def test_parquet_units_in_metadata(tmp_path):
    path, units = tmp_path / "run.parquet", {"t": "s", "y": "mm", "acc": "g"}
    fields = [pa.field(n, pa.float64(), metadata={"unit": u}) for n, u in units.items()]
    pq.write_table(pa.table([T, Y, A], schema=pa.schema(fields)), path, row_group_size=3)
    assert_expected(read(path))


# Bad input: one error each, which names the file.


def refused(path, match):
    with pytest.raises(RecordError, match=match) as error:
        read(path)
    assert str(path) in str(error.value)


SPOILED = {
    "line 4: channel 'acc' is empty or not a number": rows().replace("2.0,1.25", "2.0,nan"),
    "line 4: channel 'acc' is empty": rows().replace("2.0,1.25", "2.0"),
    "line 4: channel 'base displacement' is infinite": rows().replace("2.0,1.25", "inf,1.25"),
    "line 4, column 'acc': 'over' is not a number": rows().replace("1.25", "over"),
    "line 4 has 4 cells, the others 3": rows().replace("1.25", "1.25,7"),
    r"goes back from 0\.002 s to 0\.0005 s at line 5": rows().replace("0.003,", "0.0005,"),
    "'acc' is constant, 3 in all 8 samples": rows(columns=(T, Y, 0 * A + 3)),
    "has 2 samples": "0.0,1.0,2.0\n0.001,2.0,3.0\n",
    "holds no rows of at least two numbers": "",
    "line 10: channel .* is empty": rows() + ",,\n" * 7 + "0.015,1.0,1.0\n",
}
BAD = {message: HEADER + text for message, text in SPOILED.items()} | {
    "one column only": "acc [g]\n" + rows(columns=(A,)),
    "is empty$": "\n \n",
    "holds no rows": "Dear reader,\nthere is nothing here.\n",
    "what does the column 'column 2' hold": "2021-05-04 10:00:00,1,2\n2021-05-04 10:00:01,2,2\n",
    r"'4\.5\.2021 10:00' is a date that can be": "time,y [m],x [m]\n" + "4.5.2021 10:00,1,2\n" * 3,
    "neither texts nor dates are read, except 20": "time,y [m],x [m]\n" + "monday,1,2\n" * 3,
    "unknown unit 'gee'.*acceleration needs": HEADER.replace("[g]", "[gee]") + rows(),
    "name says acceleration, its unit velocity": HEADER.replace("[g]", "[mm/s]") + rows(),
    r"(?s)unit is 'time'\?.*time, unit: \"\?": HEADER.replace("[s]", "")
    + rows(columns=(1e3 * T, Y, A)),
    r"(?s)at which rate .*  sample_rate_hz: \"\?\"": "y [mm],acc [g]\n" + rows(columns=(Y, A)),
    "header has 3 names, its rows have 6": "time [s],base,acc\n" + "0,5,0,5,0,5\n1,5,1,5,2,5\n" * 3,
    "finds no response: ": "time [s],base [mm]\n" + rows(columns=(T, Y)),
}


@pytest.mark.parametrize("message", BAD)
def test_bad_text(csv, message):
    refused(csv(BAD[message]), message)


def test_channels_that_are_not_used_are_listed(csv):
    path = csv("time [s],base [mm],acc [g],CH 4 [V],t2 [s]\n" + rows(columns=(T, Y, A, Y, T)))
    with pytest.warns(RecordWarning, match=r"channels not used: 'CH 4 \[V\]' .*; say in a mapping"):
        assert_expected(read(path))
    read(path, two(2, 3))  # on purpose


NO_FILES = {
    "is a folder; give the files in it": ("run.csv", Path.mkdir),
    "no such file": ("no.csv", lambda path: None),
    "is a pipe or a device": ("run.h5", os.mkfifo),
    "is a pipe or a device, not a file": ("run.h5", lambda path: path.symlink_to("/dev/zero")),
    "symbolic links": ("run.h5", lambda path: path.symlink_to(path.name)),
    "is empty$": ("run.h5", Path.touch),
    "cannot be read as a spreadsheet, it is": (
        "run.xlsx",
        lambda at: at.write_bytes(b"PK\x03\x04"),
    ),
    r"unknown suffix '\.mf4'; records end in \.csv": ("run.mf4", Path.touch),
    "those of no known format": ("run.mat", lambda path: path.write_bytes(bytes(range(256)))),
}


@pytest.mark.parametrize("message", NO_FILES)
def test_what_is_no_file(tmp_path, message):
    name, make = NO_FILES[message]
    make(tmp_path / name)
    refused(tmp_path / name, message)


SAMPLES = {".csv": "delimited text", ".parquet": "Parquet", ".mat": "MATLAB", ".h5": "HDF5"}
SAMPLES |= {".uff": "a universal file", ".tdms": "TDMS", ".wav": "WAV"}
KINDS = [*SAMPLES, "73.mat"]
VALUES = np.random.default_rng(3).standard_normal((2, 200))


def sample(path):
    """A file of a force and a velocity; of MATLAB 7.3 where its name says so."""
    columns = dict(zip(("force_N", "velocity_m_per_s"), VALUES, strict=True))
    return write_columns(path, {"time_s": np.arange(200) / RATE} | columns, "73" in path.name)


@pytest.mark.parametrize("kind", KINDS)
def test_every_format_is_read_to_the_last_bit(tmp_path, kind):
    measurement = read(sample(tmp_path / f"run{kind}"))
    for quantity, expected in zip(("force", "velocity"), VALUES, strict=True):
        np.testing.assert_array_equal(measurement[quantity].values, expected)
        np.testing.assert_array_equal(measurement[quantity].t, np.arange(200) / RATE)


@pytest.mark.parametrize("suffix", SAMPLES)
def test_a_file_that_is_not_what_its_name_says(tmp_path, suffix):
    wrong = tmp_path / f"run{suffix}"
    for other in SAMPLES.keys() - {suffix}:
        shutil.copy(sample(tmp_path / f"original{other}"), wrong)
        if (suffix, other) == (".mat", ".h5"):  # MATLAB 7.3 is HDF5: read as such
            assert len(read(wrong)["force"]) == 200
        else:
            message = f"as its name says, but {SAMPLES[other]}; rename it to run{other}$"
            refused(wrong, message)


def test_a_truncated_text(tmp_path):
    path = sample(tmp_path / "run.csv")
    *whole, last = path.read_bytes().splitlines(keepends=True)[:101]
    for end, said in (
        (last.rpartition(b",")[0], "'velocity': 1 sample is empty .*: line 101"),
        (last.rstrip()[:-3], "last line has no end.* if the file was cut, its last number is wr"),
    ):
        path.write_bytes(b"".join([*whole, end]))
        with pytest.warns(RecordWarning) as told:
            read(path)
        assert re.search(said, " ".join(str(one.message) for one in told))


LIBRARIES = {".parquet": "pyarrow", ".mat": "pymatreader", ".h5": "h5py", ".uff": "pyuff"}
LIBRARIES |= {".tdms": "nptdms", ".xlsx": "python_calamine", ".lvm": "lvm_read"}
HEADS = {".xlsx": b"PK\x03\x04", ".lvm": b"LabVIEW Measurement"}


@pytest.mark.parametrize("suffix", LIBRARIES)
def test_a_missing_library_names_the_extra(tmp_path, monkeypatch, suffix):
    path, library = tmp_path / f"run{suffix}", LIBRARIES[suffix]
    path.write_bytes(HEADS[suffix]) if suffix in HEADS else sample(path)
    for name in {library, *(name for name in sys.modules if name.startswith(f"{library}."))}:
        monkeypatch.setitem(sys.modules, name, None)  # which cannot be imported
    with pytest.raises(RecordError, match=rf'package {library}.*"dampbalance\[records\]"'):
        read(path)


def test_padding_of_a_table_is_left_out(csv):
    random = np.random.default_rng(5)
    for n in (3, 20, 39, 40):  # the shorter channel is empty at its end
        force, velocity = random.standard_normal(40), random.standard_normal(n)
        columns = {"force_time_s": np.arange(40) / 1000.0, "force_N": force}
        columns |= {"velocity_time_s": np.arange(n) / 500.0, "velocity_m_per_s": velocity}
        frame = pd.DataFrame({name: pd.Series(values) for name, values in columns.items()})
        found = read(csv(frame.to_csv(index=False)))
        np.testing.assert_array_equal(found["force"].values, force)
        np.testing.assert_array_equal(found["velocity"].values, velocity)
        np.testing.assert_array_equal(found["velocity"].t, columns["velocity_time_s"])
    assert_expected(read(csv(HEADER + rows() + ",,\n" * 7)))  # spreadsheets leave such


# Records that are written are read back to the last bit, and have the same bytes each time.


def made_up(rate=5000.0, n=300, start=0.0, seed=7):
    """Arbitrary numbers of many magnitudes: what matters is that they come back."""
    random = np.random.default_rng(seed)
    t = start + np.arange(n) / rate
    values = random.standard_normal((3, n)) * 10.0 ** random.integers(-9, 3, (3, n))
    quantities = ("base_displacement", "displacement", "acceleration")
    return Record.of("made up", list(map(Channel, quantities, [t] * 3, values)))


FAST, SLOW = made_up(44100.0, 300), made_up(1000.0, 61, seed=8)
RECORDS = {
    "an even rate": FAST,
    # a rate and a start that no short number holds
    "no simple grid": made_up(rate=1234.567, start=0.1234567890123),
    "times of its own for each": Record.of("", [FAST["base_displacement"], SLOW["acceleration"]]),
}


@pytest.mark.parametrize("suffix", [".csv", ".tsv", ".mat"])
@pytest.mark.parametrize("record", RECORDS.values(), ids=RECORDS)
def test_records_come_back(tmp_path, suffix, record):
    file = tmp_path / f"run{suffix}"
    found = read(write(file, record))
    assert list(found) == list(record)
    for quantity in record:
        np.testing.assert_array_equal(found[quantity].t, record[quantity].t)
        np.testing.assert_array_equal(found[quantity].values, record[quantity].values)
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
