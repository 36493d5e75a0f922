"""Damaged and absurd files are read, or refused in one sentence; no code of theirs runs, and nothing is lost."""

from __future__ import annotations

import os
import pickle
import re
import warnings
from pathlib import Path

import h5py
import numpy as np
import pytest

from dampbalance import identify
from dampbalance.model import BaseMotion
from dampbalance.motion.orbit import steady_orbit
from dampbalance.records.errors import LARGEST_FILE, LARGEST_VALUE, RecordError, RecordWarning
from dampbalance.records.mapping import read_mapping
from dampbalance.records.readers import FORMATS as SUFFIXES
from dampbalance.records.readers import read, table
from dampbalance.records.synthetic import measured_orbit
from paper_case import PAPER
from processes import in_time
from records.formats import row, write_columns, xlsx

NAMES = ("time_s", "base_displacement_m", "displacement_m")
UNSHOWABLE = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028-\u202e]")
KINDS = (".csv", ".parquet", ".mat", "73.mat", ".h5", ".tdms", ".wav", ".uff", ".xlsx")


STEADY = steady_orbit(PAPER, BaseMotion(Y=0.004, omega=7.0 * np.pi))
MADE = measured_orbit(STEADY, rate_hz=500.0, cycles=14, noise=0.005, seed=1)
T, Y, X = MADE.excitation.t, MADE.excitation.values, MADE["displacement"].values


def write(path, t=T, y=Y, x=X, names=NAMES):
    """Write columns by their names, in the format of the suffix; give the path."""
    if path.suffix == ".xlsx":
        xlsx(path, map(row, [names, *np.transpose([t, y, x]).tolist()]))
        return path
    columns = dict(zip(names, (t, y, x), strict=True))
    return write_columns(path, columns, matlab_73="73" in path.name)


def said_of(path):
    """Return the one sentence against a file, which names it; "" where its record is read, with finite values."""
    before, said = path.read_bytes(), ""
    with in_time(120), warnings.catch_warnings():  # nothing here takes a tenth of that
        for kind in (RecordWarning, ResourceWarning):  # libraries leave open what they cannot read
            warnings.simplefilter("ignore", kind)
        try:
            record = read(path)
            assert all(np.abs(record[q].values).max() <= LARGEST_VALUE for q in record)
        except RecordError as error:
            said = str(error)
            assert str(path) in said
    assert len(said) < 2000
    assert not UNSHOWABLE.search(said)
    assert before == path.read_bytes()
    return said


def damaged(path, count):
    """Cut a sound file, which is refused unless it is text; then change some of its bytes, or all from one on to zeros,
    again and again: it is read, or refused in one sentence."""
    sound, random = write(path).read_bytes(), np.random.default_rng(62)
    for part in (0.02, 0.3, 0.6, 0.9, 0.999):
        path.write_bytes(sound[: int(part * len(sound))])
        assert said_of(path) or path.suffix == ".csv"
    for n in range(count):
        data = bytearray(sound)
        end = len(sound) if n % 3 else 200  # each third time in the head
        at = random.integers(0, min(end, len(sound)), 4)
        data[at[0] :] = data[at[0] :] if n % 2 else bytes(len(sound) - at[0])
        for place in at:
            data[place] = random.integers(256)
        path.write_bytes(data)
        said_of(path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_file_is_read_or_refused_in_one_sentence(tmp_path, kind):
    damaged(tmp_path / f"run{kind}", 6)


@pytest.mark.parametrize("kind", KINDS)
def test_many_damaged_files_are_read_or_refused(tmp_path, kind):
    damaged(tmp_path / f"run{kind}", 200)


def test_names_and_texts_of_any_characters(tmp_path):
    random, marks = np.random.default_rng(62), [*"0123456789.,;-+eE\t\n \"'#aµ\u202e漢\x00\x1b"]
    path = tmp_path / "run.csv"
    for _ in range(15):
        names = ["".join(random.choice(marks, 20)) for _ in range(3)]
        said_of(write(path, names=[f"{i}{name}" for i, name in enumerate(names)]))
        path.write_text("".join(random.choice(marks, 200)), encoding="utf-8")
        said_of(path)


# Each must be refused

COLUMNS = {
    "huge": ({"y": 1e150 * Y, "x": 1e150 * X}, r"beyond 1e\+15 m, and so are"),
    "the largest": ({"x": np.where(np.arange(X.size) % 2, 1e308, -1e308)}, r"1e\+308, beyond 1e\+15 m"),
    "one value": ({"x": np.where(np.arange(X.size) == 77, 1e160, X)}, r"line 79: .*1e\+160"),
    "tiny": ({"y": 1e-150 * Y, "x": 1e-150 * X}, "less than a transducer resolves"),
    "tiny at odd times": ({"t": T + 2e-4 * np.sin(np.arange(T.size) ** 2), "x": 1e-170 * X}, "less than a tr"),
    "subnormal": ({"x": 5e-322 * X}, "constant|too little"),
    "constant except for rounding": ({"x": 1.0 + 1e-13 * (X > 0)}, "constant except for rounding"),
    "infinite": ({"y": np.where(Y > 0, Y, -np.inf)}, "is infinite"),
    "late": ({"t": T + 1e17}, r"beyond 1e\+12 s"),
    "fast": ({"t": 1e-300 * T}, "which no recorder has"),
    "backwards": ({"t": T[::-1]}, "goes back .* rows in order"),
    "of 8 bits": ({"x": (6e4 * X).astype("i8").astype("i1") * 1.0}, "an integer of 8 bits ran over"),
    "of 16 bits": ({"x": (3e7 * X).astype("i8").astype("i2") * 1.0}, "an integer of 16 bits ran over"),
}  # fmt: skip


@pytest.mark.parametrize("name", COLUMNS)
def test_values_and_times_that_no_rig_gives(name, tmp_path):
    changed, message = COLUMNS[name]
    assert re.search(message, said_of(write(tmp_path / "bad.csv", **changed)))


@pytest.mark.parametrize("step", [0.0, -1e-3, 1e300, np.nan, "often", 1 + 2j, True])
def test_steps_that_no_recorder_has(step, tmp_path):
    path = write(tmp_path / "bad.h5", names=("other", *NAMES[1:]))
    with h5py.File(path, "a") as file:
        file.attrs["dt"] = step
    assert "dt of channel 'base_displacement_m' is" in said_of(path)


def test_a_file_too_large_says_so(tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("time_s,y_m,x_m\n")
    os.truncate(path, LARGEST_FILE + 1)  # takes no room on the disk
    with pytest.raises(RecordError, match="has 4 GB, more than the 4 GB that are read; give a par"):
        read(path)


def test_a_cell_far_from_all_others_says_so(tmp_path):
    """The library would take memory for all cells up to it, and end the process."""
    path, far = tmp_path / "far.xlsx", '<row r="{}"><c r="{}"><v>1</v></c></row>'
    xlsx(path, [far.format(1, "A1"), far.format(1048576, "XFD1048576")])
    assert "XFD1048576, makes a sheet of 1,048,576 × 16,384 cells" in said_of(path)


def test_a_heading_without_end_is_read_at_once(tmp_path):
    path = write(tmp_path / "long.csv", names=(*NAMES[:2], "d [/ in" * 20_000))
    assert "hold: base_displacement" in said_of(path)  # in time


def test_memory_that_runs_out_is_no_damaged_file(tmp_path, monkeypatch):
    def full(*_, **__):
        raise MemoryError

    monkeypatch.setattr(h5py.Dataset, "__getitem__", full)
    with pytest.raises(MemoryError):
        read(write(tmp_path / "run.h5"))


def test_no_code_runs_from_a_file(tmp_path):
    trace = tmp_path / "trace"
    trap = pickle.dumps(Trap(trace))
    pickle.loads(trap)
    assert trace.exists()  # the trap works
    trace.unlink()
    for suffix in [suffix for kind in SUFFIXES.values() for suffix in kind.suffixes]:
        (tmp_path / f"run{suffix}").write_bytes(trap)
        assert said_of(tmp_path / f"run{suffix}")
    objects = np.array([Trap(trace), 1.0], dtype=object)
    np.save(tmp_path / "run.npy", objects)
    assert "holds Python objects alone" in said_of(tmp_path / "run.npy")
    np.savez(tmp_path / "run.npz", notes=objects, time_s=T, y_m=Y, x_m=X)
    assert not said_of(tmp_path / "run.npz")
    (tmp_path / "bad.yaml").write_text("!!python/name:os.system ''\n")
    with pytest.raises(RecordError):
        read_mapping(tmp_path / "bad.yaml")
    assert not trace.exists()


class Trap:
    """An object that, unpickled, leaves a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


# what bounds the reading of YAML is tested in project/test_documents.py
MAPPINGS = [
    "- a\n", "channels: [\n", "\xff\xfe", "level: " + "9" * 5000, "level: .nan\n", "x" * 5000 + ": 1\n",
    "".join(f"k{i}: 1\n" for i in range(100)), "channels: {velocity: {channel: 1, scale: 0.0}}",
]  # fmt: skip


@pytest.mark.parametrize("text", MAPPINGS, ids=range(len(MAPPINGS)))
def test_mappings_that_are_none(text, tmp_path):
    file = tmp_path / "bad.yaml"
    file.write_bytes(text.encode("latin-1"))
    with pytest.raises(RecordError) as error:
        read_mapping(file)
    lines = str(error.value).splitlines()
    assert lines[0].startswith(f"{file}: ")
    assert len(lines) <= 21
    assert max(map(len, lines)) < 400


def test_groups_are_visited_once(tmp_path):
    path = write(tmp_path / "run.h5")
    with h5py.File(path, "a") as file:
        group = file.create_group("g")
        for _ in range(16):
            below = group.create_group("left")
            group["right"], group = below, below
        group["value"] = np.arange(5.0)
        file["g/left/up"] = file["/"]
        file["loop"], file["nowhere"] = h5py.SoftLink("/loop"), h5py.SoftLink("/g/none/at/all")
    assert len(table(path).channels) == 4
    assert not said_of(path)


@pytest.mark.parametrize("suffix", ["csv", "mat"])
def test_one_record_is_one_level(suffix, tmp_path):
    copies = [write(tmp_path / "a.csv"), write(tmp_path / f"b.{suffix}")]
    for paths in (copies, copies[:1] * 2):
        with pytest.raises(ValueError, match="each record is one level"):
            identify(paths, PAPER.k)
