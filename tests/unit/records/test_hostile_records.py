"""Records that someone hostile, or a broken logger, hands over: one clear error, or a sound result; nothing else."""

from __future__ import annotations

import json
import os
import pickle
import re
import struct
import tracemalloc
import warnings
import xml.dom.minidom
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pytest
import scipy.io
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dampbalance.commands.main import main
from dampbalance.model import BaseMotion
from dampbalance.motion.orbit import steady_orbit
from dampbalance.records.errors import LARGEST_FILE, RecordError, RecordWarning
from dampbalance.records.mapping import read_mapping
from dampbalance.records.readers import FORMATS as SUFFIXES
from dampbalance.records.readers import channels, read
from dampbalance.records.synthetic import measured_orbit
from paper_case import PAPER
from processes import in_time
from unit.records.formats import write_columns
from unit.records.workbooks import row, xlsx

pytestmark = pytest.mark.usefixtures("coarse")

RATE = 500.0
NAMES = ("time_s", "base_displacement_m", "displacement_m")
LONGEST = 2000  # characters of an error on a screen
UNSHOWABLE = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028-\u202e]")
CHANNELS = {
    "base_displacement": {"channel": 1, "unit": "m"},
    "displacement": {"channel": 2, "unit": "m"},
}


@pytest.fixture(autouse=True)
def _no_hang():
    with in_time(120):  # nothing here takes a tenth of that
        yield


def signals(Y=0.004, seed=1):
    """Times, base and mass of a sound record."""
    orbit = steady_orbit(PAPER, BaseMotion(Y=Y, omega=2.0 * np.pi * 3.5))
    found = measured_orbit(orbit, rate_hz=RATE, cycles=14, noise=0.005, seed=seed)
    base, mass = found.excitation, found["displacement"]
    return tuple(np.array(a) for a in (base.t, base.values, mass.values))


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A sound record at another level, to go with the hostile one."""
    path = write(tmp_path_factory.mktemp("sound") / "sound.csv", *signals(0.009, seed=2))
    return str(path)


def write(path, *columns, names=NAMES):
    """Write columns by their names, in the format of the suffix. Gives the path."""
    return write_columns(path, dict(zip(names, columns, strict=True)))


def listing(folder):
    return {
        p.relative_to(folder): (p.lstat().st_size, p.lstat().st_mtime_ns)
        for p in folder.rglob("*")
        if not p.is_dir()
    }


def tried(folder, capsys, *arguments):
    """Exit code and what was said: 0 with results, or 2 with a short error and nothing else."""
    before = listing(folder)
    try:
        code = main(["identify", *map(str, arguments), "--stiffness", "2310"])
    except SystemExit as stopped:
        code = stopped.code
    said = capsys.readouterr()
    assert code in (0, 2)
    assert not UNSHOWABLE.search(said.out + said.err)
    if code:
        assert said.out == ""
        assert len(said.err) < LONGEST
        assert listing(folder) == before
    return code, said.out + said.err


def refused(path, message, **options):
    """The one error, which names the file."""
    with pytest.raises(RecordError, match=message) as error:
        read(path, **options)
    assert str(path) in str(error.value)
    assert len(str(error.value)) < LONGEST


# Values


def alternating(x):
    return np.where(np.arange(x.size) % 2, 1e308, -1e308)


VALUES = {
    "huge": (lambda y, x: (1e150 * y, 1e150 * x), r"beyond 1e\+15 m, and so are"),
    "huge in all formats": (lambda y, x: (y, 1e300 * x), r"beyond 1e\+15 m"),
    "the largest": (lambda y, x: (y, alternating(x)), r"1e\+308, beyond 1e\+15 m"),
    "one value": (lambda y, x: (y, np.where(np.arange(x.size) == 77, 1e160, x)), r"(line 79|sample 78): .*1e\+160"),
    "tiny": (lambda y, x: (1e-150 * y, 1e-150 * x), "too little to mean anything"),
    "a drive of next to nothing": (lambda y, x: (1e-300 * y, x), "'base_displacement|'channel 1"),
    "subnormal": (lambda y, x: (y, 5e-322 * x), "constant|too little"),
    "constant except for rounding": (lambda y, x: (y, 1.0 + 1e-13 * (x > 0)), "constant except for rounding"),
    "infinite": (lambda y, x: (np.where(y > 0, y, -np.inf), x), "is infinite"),
}  # fmt: skip


@pytest.mark.parametrize("suffix", ["csv", "h5"])
@pytest.mark.parametrize("name", VALUES)
def test_values_that_no_rig_gives(name, suffix, tmp_path):
    change, message = VALUES[name]
    t, y, x = signals()
    path = write(tmp_path / f"bad.{suffix}", t, *change(y, x))
    refused(path, message)


@pytest.mark.parametrize("change", [lambda y: y, lambda y: -y, lambda y: 3.0 * y + 0.01])
def test_a_response_that_is_the_excitation(change, tmp_path, capsys, sound):
    t, y, _ = signals()
    path = write(tmp_path / "bad.h5", t, y, change(y))
    code, said = tried(tmp_path, capsys, path, sound)
    assert code == 2
    assert "displacement is base_displacement itself, times" in said
    assert "bad.h5" in said


@pytest.mark.parametrize(("dtype", "scale"), [("i1", 6e4), ("u1", 6e4), ("i2", 3e7), ("i4", 1e12)])
@pytest.mark.parametrize("suffix", ["csv", "parquet", "mat", "h5", "tdms"])
def test_an_integer_that_ran_over(dtype, scale, suffix, tmp_path):
    t, y, x = signals()
    counts = (scale * x).astype("i8")
    wrapped = counts.astype(dtype)
    assert not np.array_equal(counts, wrapped)
    path = write(tmp_path / f"bad.{suffix}", t, y, wrapped, names=(*NAMES[:2], "displacement_nm"))
    refused(path, f"an integer of {8 * wrapped.itemsize} bits ran over")


def test_a_full_range_is_no_overflow(tmp_path):
    t, y, x = signals()
    counts = np.round(32767 * x / np.abs(x).max()).astype("i2")
    path = write(tmp_path / "run.h5", t, y, counts, names=(*NAMES[:2], "displacement_nm"))
    np.testing.assert_array_equal(read(path)["displacement"].values, counts * 1e-9)


def test_truth_values_and_dates_are_no_signals(tmp_path):
    t, y, x = signals()
    micros = (1e6 * x).astype("i8")
    for suffix, values in {
        "parquet": [x > 0, pa.array(micros, pa.timestamp("us")), pa.array(micros, pa.duration("us"))],
        "csv": [x > 0, micros.astype("datetime64[us]")],
        "h5": [x > 0],
        "mat": [x > 0],
        "tdms": [x > 0, micros.astype("datetime64[us]")],
    }.items():  # fmt: skip
        for column in values:
            wrong = "not numbers|holds points in time|is not a number|finds no response|texts are"
            refused(write(tmp_path / f"bad.{suffix}", t, y, column), wrong)


# Times


@pytest.mark.parametrize("suffix", ["csv", "h5"])
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: 1e300 * t, r"beyond 1e\+12 s"),
        (lambda t: 1e-300 * t, "which no recorder has"),
        (lambda t: 1e12 * t, r"beyond 1e\+12 s"),
        (lambda t: t + 1e17, r"beyond 1e\+12 s"),
        (lambda t: 1e307 * (t - t.mean()), r"beyond 1e\+12 s"),
    ],
)
def test_times_that_no_recorder_has(change, message, suffix, tmp_path):
    t, y, x = signals()
    path = write(tmp_path / f"bad.{suffix}", change(t), y, x)
    refused(path, message)


@pytest.mark.parametrize("step", [0.0, -1e-3, 1e-300, 1e300, np.nan, np.inf, "often", 1 + 2j, True])
def test_steps_that_no_recorder_has(step, tmp_path):
    path = write(tmp_path / "bad.h5", *signals()[1:], names=NAMES[1:])
    with h5py.File(path, "a") as file:
        file.attrs["dt"] = step
    refused(path, "dt of channel 'base_displacement_m' is")


# Sizes

FAR = '<row r="{}"><c r="{}"><v>1</v></c></row>'


def far_cell(path):
    xlsx(path, [FAR.format(1, "A1"), FAR.format(1048576, "XFD1048576")])


def packed_zeros(path):
    with h5py.File(path, "w") as file:
        for name in NAMES:
            file.create_dataset(name, (10**9,), "f8", chunks=(10**5,), compression="gzip")


def rows_of_zeros(path):
    path.write_text("time_s,y_m,x_m\n")
    os.truncate(path, LARGEST_FILE + 1)  # takes no room on the disk


def many_arrays(path):
    """A head alone: what it says is looked at, not what follows."""
    scipy.io.savemat(path, {"displacement_m": np.zeros((2, 3))})
    small = struct.pack("<ii", 2, 3)
    path.write_bytes(path.read_bytes().replace(small, struct.pack("<ii", 2**15, 2**15)))


@pytest.mark.parametrize(
    ("name", "fill", "message"),
    [
        ("far.xlsx", far_cell, "XFD1048576, makes a sheet of 1,048,576 × 16,384 cells"),
        (
            "bad.h5",
            packed_zeros,
            "would be 3,000,000,000 numbers, more than 200,000,000; give a part",
        ),
        ("bad.csv", rows_of_zeros, "has 4 GB, more than the 4 GB that are read; give a part"),
        ("bad.mat", many_arrays, "would be 1,073,741,824 numbers, more than"),
    ],
)
def test_a_file_too_large_for_memory_says_so(name, fill, message, tmp_path):
    path = tmp_path / name
    fill(path)
    tracemalloc.start()
    refused(path, message)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10e6  # bytes


def test_structures_of_matlab_are_read(tmp_path):
    path = tmp_path / "run.mat"
    t, y, x = signals()
    whole = np.round(1e6 * x)  # stored as smaller integers
    inner = {"base_displacement_m": y, "displacement_um": whole}
    inner |= {"note": "text", "odd": np.arange(3.0)}
    run = {"inner": inner, "cell": np.array([1.0, "a"], object)}
    scipy.io.savemat(path, {"time_s": t, "run": run}, do_compression=True)
    np.testing.assert_array_equal(read(path)["displacement"].values, whole * 1e-6)


# HDF5


def test_groups_are_visited_once(tmp_path):
    def diamonds(file):
        group = file.create_group("g")
        for _ in range(16):
            below = group.create_group("left")
            group["right"] = below
            group = below
        group["value"] = np.arange(5.0)
        file["g/left/up"] = file["/"]
        file["soft"] = h5py.SoftLink("/g")
        file["loop"] = h5py.SoftLink("/loop")
        file["nowhere"] = h5py.SoftLink("/g/none/at/all")

    path = write(tmp_path / "run.h5", *signals())
    with h5py.File(path, "a") as file:
        diamonds(file)
    assert len(channels(path)) == 4
    assert list(read(path)) == ["base_displacement", "displacement"]


# Spreadsheets


@pytest.mark.filterwarnings("ignore:.*channels not used. 'column 1', 'column 2'")
def test_cells_that_do_not_begin_in_the_first_column(tmp_path):
    path = tmp_path / "run.xlsx"
    values = np.random.default_rng(1).standard_normal((200, 2)).tolist()
    table = [NAMES, *((i / RATE, *pair) for i, pair in enumerate(values))]
    xlsx(path, [row(cells, "CDE", i) for i, cells in enumerate(table, start=3)])
    assert read(path)["displacement"].values.tolist() == [pair[1] for pair in values]


# Text and mappings

TEXTS = {
    "a million columns": (",".join(["1"] * 10**6) + "\n") * 3,
    "a long cell": "time_s,y_m,x_m\n0,1,2\n" + "9" * 140_000 + ",1,2\n",
    "a long name": "time_s,y_m," + "x" * 140_000 + "\n0,1,2\n1,2,3\n",
    "a long line at the end": "time_s,y_m,x_m\n" + "0,1,2\n1,2,3\n" * 500 + "1" * 600_000 + "\n",
    "no line ends": "1," * 10**6,
    "a quote that stays open": 'time_s,y_m,x_m\n0,1,2\n"1,2,3\n' + "4,5,6\n" * 1000,
    "NUL": "time_s,y_m,x_m\n0,1,2\n1,\x002,3\n",
    "other digits": "time_s,y_m,x_m\n٠,١,٢\n١,٢,٣\n",
    "hexadecimal": "time_s,y_m,x_m\n0x0,0x1,0x2\n0x1,0x2,0x3\n",
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_text_that_is_no_record(name, tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text(TEXTS[name], encoding="utf-8")
    refused(path, "bad.csv: ")


def test_a_parser_is_not_given_a_line_without_end(tmp_path, monkeypatch):
    path = write(tmp_path / "run.csv", *signals())
    assert read(path)
    monkeypatch.setattr("dampbalance.records.readers.text._SMALL", 0)  # as a large file is read
    monkeypatch.setattr("dampbalance.records.readers.text._WITHOUT_END", 0)
    refused(path, "a line has no end")


@pytest.mark.parametrize("end", ["\n", ""])
def test_a_name_is_quoted_in_part(end, tmp_path, capsys, sound):
    path = tmp_path / "bad.csv"
    write(path, *signals(), names=(*NAMES[:2], "\x1b[31m<b>" + "x" * 900 + end))
    code, said = tried(tmp_path, capsys, path, sound)
    assert code == 2
    assert r"\x1b[31m<b>xxx" in said
    write(path, *signals(), names=(*NAMES[:2], "x" * 5000))
    refused(path, "the name of channel 3 has 5,000 characters")


BOMB = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)
MAPPINGS = [
    "? [1, 2]\n: 3\n", "? {a: 1}\n: 3\n", "- a\n", "5\n", "text\n", "a: b: c\n", "\ta\n",
    "!!python/name:os.system ''\n",
    "&a {level: *a}\n", "channels: &a {force: *a}\n", BOMB, "a: " + "[" * 2000 + "]" * 2000, "level: 2020-13-45\n",
    "level: " + "9" * 5000, "level: .nan\n", "level: [1]\n", "level: " + "L" * 201, "level: " + "L" * 2_000_000,
    "level: a\nlevel: b\n", "k: 1\n", "".join(f"k{i}: 1\n" for i in range(1000)), "x" * 5000 + ": 1\n",
    *(
        f"channels: {{force: {{{rule}}}, velocity: {{channel: 3}}}}\n"
        for rule in (
            "channel: 2.0", "channel: true", "channel: [1]", "channel: " + "c" * 1001, "channel: 1, scale: 1.0e+16",
            "channel: 1, scale: 0.0", "channel: 1, unit: " + "m" * 5000, f"channel: 1, unit: '{'[' * 5000}'",
        )
    ),
    *(f"delimiter: {one}\n" for one in (r'"\n"', r'"\""', '""', "';;'", r'"\0"', "'#'", "e", "5", '"-"', r'";\n"')),
    *(f"sample_rate_hz: {r}\n" for r in ("1.0e-300", "1.0e+300", "0", "-1", "true", ".inf", "'5'", "1e400")),
    *(f"header_lines: {one}\n" for one in ("-1", "1.0", "1000000000000", "9" * 400)),
    *(f"frequency_hz: {one}\n" for one in ("1.0e+308", "5.0e-324", "9" * 400)),
]  # fmt: skip


@pytest.mark.parametrize("text", MAPPINGS, ids=range(len(MAPPINGS)))
def test_mappings_that_are_none(text, tmp_path):
    file = tmp_path / "bad.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError) as error:
        read_mapping(file)
    assert str(error.value).startswith(f"{file}: ")
    assert all(len(line) < 400 for line in str(error.value).splitlines())
    assert len(str(error.value).splitlines()) <= 21


# Files


def fifo(path):
    os.mkfifo(path)


def device(path):
    path.symlink_to("/dev/zero")


def loop(path):
    path.symlink_to(path.name)


@pytest.mark.parametrize("suffix", ["csv", "h5", "uff"])
@pytest.mark.parametrize(
    ("make", "message"),
    [(fifo, "is a pipe or a device"), (device, "is a pipe or a device"), (loop, "cannot be opened")],
)  # fmt: skip
def test_only_regular_files_are_opened(make, message, suffix, tmp_path):
    path = tmp_path / f"bad.{suffix}"
    make(path)
    refused(path, message)


@pytest.mark.parametrize("way", ["twice", "spelling", "symlink", "hard link", "copy", "other format"])  # fmt: skip
def test_one_record_is_one_level(way, tmp_path, capsys):
    path, other = tmp_path / "a.csv", tmp_path / "b.csv"
    write(path, *signals())
    if way == "twice":
        other = path
    elif way == "spelling":
        other = f"{tmp_path}/../{tmp_path.name}/a.csv"
    elif way == "symlink":
        other.symlink_to(path)
    elif way == "hard link":
        os.link(path, other)
    elif way == "copy":
        other.write_bytes(path.read_bytes())
    else:
        other = write(tmp_path / "b.mat", *signals())
    code, said = tried(tmp_path, capsys, path, other)
    assert code == 2
    assert "each record is one level" in said


# One property: a damaged file of each format is refused in a sentence, or read.

FORMATS = ("csv", "parquet", "mat", "mat73", "h5", "tdms", "wav", "uff", "xlsx")


@pytest.fixture(scope="module")
def sound_files(tmp_path_factory):
    """A folder with a sound record in each format."""
    folder, columns = tmp_path_factory.mktemp("formats"), dict(zip(NAMES, signals(), strict=True))
    for kind in FORMATS:
        path = folder / f"{kind}.{kind.removesuffix('73')}"
        if kind == "xlsx":
            xlsx(path, map(row, [NAMES, *np.transpose(list(columns.values())).tolist()]))
        else:
            write_columns(path, columns, matlab_73=kind == "mat73")
    return folder


changes = st.lists(st.tuples(st.floats(-0.1, 1.0), st.integers(0, 255)), min_size=1, max_size=20)
damages = st.one_of(
    st.tuples(st.sampled_from(["cut", "doubled", "zeros"]), st.floats(0.0, 1.0)),
    st.tuples(st.just("bytes"), changes),
)


def damaged(data, kind, of):
    """The bytes, cut, changed, with a part twice, or ending in zeros; below 0 a change is in the first 200 bytes."""
    if kind == "bytes":
        changed = bytearray(data)
        for at, value in of:
            span = 200 if at < 0.0 else len(data) - 1
            changed[int(abs(at) * (10.0 if at < 0.0 else 1.0) * min(span, len(data) - 1))] = value
        return bytes(changed)
    at = int(of * len(data))
    rest = {"cut": b"", "doubled": data[at // 2 :], "zeros": bytes(len(data) - at)}[kind]
    return data[:at] + rest


@pytest.mark.parametrize("kind", FORMATS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(damage=damages)
def test_a_damaged_file_is_refused_in_a_sentence_or_read(kind, damage, sound_files, tmp_path):
    name = f"{kind}.{kind.removesuffix('73')}"
    path = tmp_path / name
    content = damaged((sound_files / name).read_bytes(), *damage)
    path.write_bytes(content)
    said = ""
    with warnings.catch_warnings():
        for warning in (
            RecordWarning,
            ResourceWarning,
        ):  # libraries leave open what they cannot read
            warnings.simplefilter("ignore", warning)
        try:
            read(path, {"channels": CHANNELS} if kind == "wav" else None)
        except RecordError as error:
            said = str(error)
    assert not said or str(path) in said
    assert len(said) < LONGEST
    assert not UNSHOWABLE.search(said)
    assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]


class Trap:
    """An object that, unpickled, leaves a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return Path.touch, (self.path,)


@pytest.mark.parametrize(
    "suffix", [suffix for kind in SUFFIXES.values() for suffix in kind.suffixes]
)
def test_no_code_runs_from_a_file(suffix, tmp_path):
    path, trace = tmp_path / f"run{suffix}", tmp_path / "trace"
    trap = pickle.dumps(Trap(trace))
    pickle.loads(trap)
    assert trace.exists()  # the trap works
    trace.unlink()
    for name in (path, *(tmp_path / f"run{end}" for end in (".pickle", ".pkl"))):
        name.write_bytes(trap)
    path.with_name(f"{path.name}.pkl").write_bytes(trap)
    with pytest.raises(RecordError):
        read(path)
    assert not trace.exists()


# Names

TROUBLE = {
    "script": "<script>alert(1)</script>",
    "markdown": "a|b *c* `d` [e](f)",
    "maths": r"$x_{$ \$ $\frac{1}{2}$ ^_",
    "backslashes": r"a\nb\x1b \\ %s {0}",
    "other scripts": "é漢🎲",
    "entities": "&amp; &lt; ' \"",
}
ACTING = {
    "escape": "\x1b[31mred\x1b[0m",
    "line end": "a\nb",
    "turned": "a\u202eb",
    "eight bits": "a\x9b31m",
    "separator": "a\u2028b",
}


def shown(folder):
    """The texts that were written, each readable as what it is, without characters that act."""
    texts = {}
    for file in folder.iterdir():
        if file.suffix != ".png":
            texts[file.name] = file.read_text(encoding="utf-8")
            assert not UNSHOWABLE.search(texts[file.name]), file.name
    for name, text in texts.items():
        if name.endswith(".svg"):
            xml.dom.minidom.parseString(text)
    return texts, json.loads(texts["identification.json"])


@pytest.mark.parametrize("name", TROUBLE)
def test_names_show_as_they_are(name, tmp_path, capsys, sound):
    name = TROUBLE[name]
    path, output = tmp_path / f"{name.replace('/', '')}.h5", tmp_path / "out"
    t, y, x = signals()
    x[300:340] = x[300]  # a drop-out, of which a warning tells
    write(path, t, y, x, names=("t", "base", name.replace("/", "")))
    rules = {
        "base_displacement": CHANNELS["base_displacement"] | {"channel": "base"},
        "displacement": CHANNELS["displacement"] | {"channel": name.replace("/", "")},
    }
    path.with_name("channels.yaml").write_text(
        json.dumps({"channels": rules, "level": name, "time": {"unit": "s"}}, ensure_ascii=False),
        encoding="utf-8",
    )
    code, said = tried(tmp_path, capsys, path, sound, "--output", output, "--approach", "fourier")
    assert code == 0, said
    assert f"warning: {path.name}: displacement: " in said
    texts, document = shown(output)
    assert document["records"][0]["record"] == str(path)
    assert f"warning: {path.name}: " in texts["summary.txt"]
    assert sorted(os.listdir(tmp_path)) == sorted([path.name, "channels.yaml", "out"])


@pytest.mark.parametrize("name", ACTING)
def test_characters_that_act_are_spelt(name, tmp_path, capsys, sound):
    name = ACTING[name]
    t, y, x = signals()
    bad = tmp_path / f"{name}.csv"
    write(bad, t, y, x)
    code, said = tried(tmp_path, capsys, bad, sound)
    assert code == 2
    assert "characters that cannot be shown" in said
    assert repr(name)[1:-1] in said
    bad.unlink()

    path, output = tmp_path / "run.h5", tmp_path / "out"
    write(path, t, y, x, names=("t", name, f"{name}2"))
    code, said = tried(tmp_path, capsys, path, sound)  # which is which?
    assert code == 2
    assert repr(name)[1:-1] in said
    numbers = {raw.name: number for number, raw in enumerate(channels(path), start=1)}
    rules = {
        "base_displacement": {"channel": numbers[name], "unit": "m"},
        "displacement": {"channel": numbers[f"{name}2"], "unit": "m"},
    }
    mapping = path.with_name("run.yaml")
    document = {"channels": rules, "time": {"unit": "s"}}
    mapping.write_text(json.dumps(document | {"level": name}))
    code, said = tried(tmp_path, capsys, path, sound, "--output", output, "--approach", "fourier")
    if code:
        assert "cannot be shown as text" in said
        mapping.write_text(json.dumps(document))
        code, said = tried(tmp_path, capsys, path, sound, "--output", output)
    assert code == 0, said
    shown(output)


@pytest.mark.parametrize("name", ["../out", "/dev/null/out"])
def test_results_stay_where_they_are_asked_for(name, tmp_path, capsys, sound):
    inner = tmp_path / "inner"
    inner.mkdir()
    path = write(inner / "run.csv", *signals())
    path.with_name("run.yaml").write_text(json.dumps({"level": name}))
    code, _ = tried(tmp_path, capsys, path, sound, "--output", inner / "out")
    assert code == 0
    assert sorted(os.listdir(tmp_path)) == ["inner"]
    assert sorted(os.listdir(inner)) == ["out", "run.csv", "run.yaml"]


@pytest.mark.parametrize("mass", ["1e-12", "1e12"])
def test_a_mass_that_cannot_be_is_refused(mass, tmp_path, capsys, sound):
    path = write(tmp_path / "run.csv", *signals())
    code, said = tried(tmp_path, capsys, path, sound, "--mass", mass)
    assert code == 2
    assert "times in a cycle" in said
    assert "give the mass in kg" in said


def test_results_that_could_not_be_written_are_not_computed(tmp_path, capsys, sound):
    path, mine = tmp_path / "run.csv", tmp_path / "mine"
    write(path, *signals())
    mine.write_text("mine")
    for folder in (mine, mine / "deeper", "a\0b", tmp_path / ("o" * 300)):
        code, _ = tried(tmp_path, capsys, path, sound, "--output", folder)
        assert code == 2
    assert mine.read_text() == "mine"
