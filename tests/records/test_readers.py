"""Records as laboratories write them, made here by other programs' rules; and one clear error for each bad one."""

from __future__ import annotations

import importlib
import re
import shutil

import h5py
import nptdms
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io
from scipy.io import wavfile

from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import read, table
from dampbalance.replication.record import SimulatedRecord
from records.drafts import filled, shown
from records.formats import write_columns, write_uff

RATE = 1000.0
N = 8
T = np.arange(N) / RATE  # s
Y = np.array([0.0, 1.0, 2.0, 1.5, 0.25, -1.0, -2.0, -0.5])  # base displacement, mm
A = np.array([0.5, -0.25, 1.25, 3.0, -1.5, 0.75, 0.125, -2.0])  # acceleration, g
G = 9.80665

# Numbers with few digits, so that text holds them exactly; a product with a unit is rounded once here and there alike.
EXPECTED = {"base_displacement": Y * 1e-3, "acceleration": A * G}


def assert_expected(found, t=T):
    assert list(found) == list(EXPECTED)
    for quantity, values in EXPECTED.items():
        np.testing.assert_array_equal(found[quantity].values, values)
        # ms become s by one more rounding
        np.testing.assert_allclose(found[quantity].t, t, rtol=1e-15, atol=0.0)


@pytest.fixture
def csv(tmp_path):
    """Writes a text to a file that the test reads, and gives its path."""

    def written(text):
        path = tmp_path / "run.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return written


def hdf5(folder, attributes=(), **arrays):
    """Write arrays by name, with attributes of the file, and give its path."""
    with h5py.File(folder / "run.h5", "w") as file:
        for name, values in arrays.items():
            file[name] = values
        file.attrs.update(attributes)
    return folder / "run.h5"


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
    "units in parentheses": "Time (s),Base (mm),Acceleration (g)\n" + rows(),
    "units after a slash": "t / s;y / mm;acc / g\n" + rows(";"),
    "units in the names": "time_s,base_displacement_mm,acceleration_g\n" + rows(),
    "a line of units": "time,base,acc\ns,mm,g\n" + rows(),
    "a line of units in brackets": "time,base,acc\n[s],[mm],[g]\n" + rows(),
    "many header lines": "Rig 3, second run\nDate: 4.5.2021\n\nOperator,N. N.\n" + HEADER + rows(),
    "comments": "# made by hand\n# time [s], base [mm], acc [g]\n" + rows() + "# the end\n",
    "comments of MATLAB": "% made by hand\n% time [s], base [mm], acc [g]\n" + rows(),
    "a comment between the rows": HEADER + rows().replace("\n0.004", " # hit\n\n# pause\n0.004"),
    "semicolon and decimal comma": HEADER.replace(",", ";") + rows(";", ","),
    "tab and decimal comma": HEADER.replace(",", "\t") + rows("\t", ","),
    "tab": HEADER.replace(",", "\t") + rows("\t"),
    "a tab before each line": re.sub(r"(?m)^(?=.)", "\t", HEADER.replace(",", "\t") + rows("\t")),
    "a tab before each row": HEADER.replace(",", "\t") + re.sub(r"(?m)^(?=.)", "\t", rows("\t")),
    "bar": HEADER.replace(",", "|") + rows("|"),
    "blanks": "time_s  base_mm  acc_g\n" + rows("   "),
    "blanks, names in two words": "time [s]  base displacement [mm]  acc [g]\n" + rows(" "),
    "blanks and decimal comma": "time_s base_mm acc_g\n" + rows(" ", ","),
    "aligned": "time_s base_mm acc_g\n" + re.sub(r"(?m)^", "   ", rows("   ").rstrip("\n")) + "\n",
    "quoted names": '"time [s]","base displacement [mm]","acc [g]"\n' + rows(),
    "quoted numbers": HEADER + re.sub(r"[^,\n]+", r'"\g<0>"', rows()),
    "delimiters at the end": "time [s],base [mm],acc [g],\n" + rows().replace("\n", ",\n"),
    "Windows line ends": HEADER.replace("\n", "\r\n") + rows(end="\r\n"),
    "milliseconds": HEADER.replace("[s]", "[ms]") + rows(columns=(T * 1e3, Y, A)),
    "another column between": "time [s],base [mm],remark,acc [g]\n"
    + rows(columns=(T, Y, np.arange(N), A)),
    "times of its own for each": "t1 [s],base [mm],t2 [s],acc [g]\n" + rows(columns=(T, Y, T, A)),
    "exponents": HEADER + "".join(f"{t:.3e},{y:.4E},{a:+.6e}\n" for t, y, a in zip(T, Y, A, strict=True)),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:.*channels not used")
@pytest.mark.parametrize("text", LAYOUTS.values(), ids=LAYOUTS)
@pytest.mark.parametrize("suffix", [".csv", ".txt", ".lvm"])
def test_text_layouts(tmp_path, text, suffix):
    path = tmp_path / f"run{suffix}"
    path.write_bytes(text.encode())
    assert_expected(read(path))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings(tmp_path, encoding):
    path = tmp_path / "run.csv"
    path.write_text("time [s],base [µm],acc [m/s²]\n" + rows(), encoding)
    found = read(path)
    np.testing.assert_array_equal(found["base_displacement"].values, Y * 1e-6)
    np.testing.assert_array_equal(found["acceleration"].values, A)


def test_own_columns_of_a_record_are_known(tmp_path):
    path = tmp_path / "run.csv"
    SimulatedRecord(T, Y, A, A, Y).to_frame().to_csv(path, index=False)
    found = read(path)
    assert list(found) == ["base_displacement", "displacement", "velocity", "acceleration"]
    np.testing.assert_array_equal(found["displacement"].values, A)


@pytest.mark.parametrize(
    "header",
    [
        "t1 [s],base [mm],t2 [s],acc [g]\n",  # the nearest to the left
        "base_time [s],base [mm],acc_time [s],acc [g]\n",  # or by name
        "time,base,time,acc\ns,mm,s,g\n",
    ],
)
def test_each_channel_takes_its_own_times(csv, header):
    found = read(csv(header + rows(columns=(T, Y, T + 0.25, A))))
    np.testing.assert_array_equal(found["base_displacement"].t, T)
    np.testing.assert_array_equal(found["acceleration"].t, T + 0.25)


def test_mapping_by_name_and_number(csv):
    path = csv("clock,CH1 [V],CH2 [V]\n" + rows(columns=(T * 1e3, Y / 2, -A)))
    mapping = {
        "channels": {
            "base_displacement": {"channel": "CH1", "unit": "mm", "scale": 2.0},
            "acceleration": {"channel": 3, "unit": "g", "sign": -1},
        },
        "time": {"channel": "clock", "unit": "ms"},
    }
    assert_expected(read(path, mapping))
    del mapping["time"]
    assert_expected(read(path, mapping | {"sample_rate_hz": RATE}))


def test_mapping_beside_the_record(tmp_path, csv):
    path = csv(rows(columns=(Y, A)))  # no header, no times
    (tmp_path / "channels.yaml").write_text(
        "channels:\n  base_displacement: {channel: 1, unit: mm}\n  acceleration: {channel: 2, unit: g}\n"
        "sample_rate_hz: 1000\n"
    )
    assert_expected(read(path))


def test_mapping_of_the_layout(csv):
    # Rows of numbers above the header: only the mapping can tell that they are no samples.
    path = csv("1;2;3\n4;5;6\n" + HEADER.replace(",", ";") + rows(";", ","))
    with pytest.raises(RecordError):
        read(path)
    assert_expected(read(path, {"header_lines": 3, "delimiter": ";", "decimal": ","}))


def test_matlab_structure_and_matrix(tmp_path):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"run": {"y_mm": Y, "acc_g": A}, "fs": RATE, "operator": "N. N."})
    assert_expected(read(path))
    scipy.io.savemat(path, {"data": np.stack([T, Y, A], axis=1)})
    time = {"channel": "data[1]", "unit": "s"}
    assert_expected(read(path, two("data[2]", "data[3]", time=time)))


@pytest.mark.parametrize("rate", [{"sample_rate": RATE}, {"dt": 1 / RATE}], ids=["rate", "step"])
@pytest.mark.parametrize("place", ["array", "group", "file"])
def test_hdf5_attributes(tmp_path, rate, place):
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        group = file.create_group("run 1")
        for name, values, unit in (("base", Y, "mm"), ("acc", A, b"g")):
            data = group.create_dataset(name, data=values)
            data.attrs["unit"] = unit
            if place == "array":
                data.attrs.update(rate)
        if place != "array":
            (group if place == "group" else file).attrs.update(rate)
    assert_expected(read(path))


def test_hdf5_rows_and_columns(tmp_path):
    mapping = two("data[1]", "data[2]", sample_rate_hz=RATE)
    for held in (np.stack([Y, A]), np.stack([Y, A], axis=1)):
        path = hdf5(tmp_path, data=held)
        assert_expected(read(path, mapping))


@pytest.mark.parametrize("binary", [0, 1], ids=["text", "binary"])
@pytest.mark.parametrize("even", [0, 1], ids=["uneven", "even"])
def test_universal_files_of_another_program(tmp_path, binary, even):
    path = tmp_path / "run.uff"
    common = {
        "type": 58, "binary": binary, "func_type": 1, "rsp_node": 1, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3,
        "abscissa_spacing": even, "abscissa_spec_data_type": 17, "orddenom_spec_data_type": 0, "x": T,
    }  # fmt: skip
    sets = [
        common | {"data": Y, "id1": "base displacement", "ordinate_axis_units_lab": "mm", "ordinate_spec_data_type": 8},
        common | {"data": A, "id1": "NONE", "ordinate_axis_units_lab": "g", "ordinate_spec_data_type": 12},
        common | {"data": A, "func_type": 4, "ordinate_spec_data_type": 12},  # a frequency response: no record
    ]  # fmt: skip
    write_uff(path, sets)
    assert_expected(read(path))
    assert len(table(path).channels) == (2 if even else 4)


def test_tdms_groups_and_segments(tmp_path):
    path = tmp_path / "run.tdms"
    waveform = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0}
    with nptdms.TdmsWriter(str(path)) as file:
        for part in (slice(0, 5), slice(5, N)):  # a logger writes piece by piece
            file.write_segment(
                [
                    nptdms.ChannelObject("base", "y", Y[part], {"unit_string": "mm", **waveform}),
                    nptdms.ChannelObject("mass", "acc", A[part].astype(np.float32), {"unit_string": "g", **waveform}),
                ]
            )  # fmt: skip
    assert_expected(read(path))
    assert [raw.name for raw in table(path).channels] == ["base/y", "mass/acc"]


@pytest.mark.parametrize(
    ("dtype", "full"), [("<i2", 2**15), ("<i4", 2**31), ("u1", None), ("<f4", None), ("<f8", None)]
)
def test_wav_in_parts_of_full_scale(tmp_path, dtype, full):
    path = tmp_path / "run.wav"
    parts = np.stack([Y, A], axis=1) / 4.0  # multiples of 1/32, which eight bits resolve
    samples = parts * full if full else (parts * 128 + 128 if dtype == "u1" else parts)
    wavfile.write(path, int(RATE), samples.astype(dtype))
    assert_expected(read(path, two(1, "channel 2", scale=4.0)))


def test_wav_of_24_bits(tmp_path):
    path = tmp_path / "run.wav"
    samples = np.round(np.stack([Y, A], axis=1) / 4.0 * 2**23).astype("<i4")
    data = b"".join(int(v).to_bytes(3, "little", signed=True) for v in samples.reshape(-1))
    rate = int(RATE)
    form = b"fmt " + (16).to_bytes(4, "little") + np.array([1, 2], "<u2").tobytes()
    form += np.array([rate, rate * 6], "<u4").tobytes() + np.array([6, 24], "<u2").tobytes()
    body = b"WAVE" + form + b"data" + len(data).to_bytes(4, "little") + data
    path.write_bytes(b"RIFF" + len(body).to_bytes(4, "little") + body)
    assert_expected(read(path, two(1, 2, scale=4.0)))


def test_parquet_units_in_metadata(tmp_path):
    path = tmp_path / "run.parquet"
    fields = [
        pa.field(n, pa.float64(), metadata={"unit": u})
        for n, u in (("t", "s"), ("y", "mm"), ("acc", "g"))
    ]
    pq.write_table(pa.table([T, Y, A], schema=pa.schema(fields)), path, row_group_size=3)
    assert_expected(read(path))


# Bad input: one error each, which names the file.


def refused(path, match, mapping=None):
    with pytest.raises(RecordError, match=match) as error:
        read(path, mapping)
    assert str(path) in str(error.value)
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADER + rows().replace("2.0,1.25", "2.0,nan"), r"line 4: channel 'acc' is empty or not a number"),
        (HEADER + rows().replace("2.0,1.25", "2.0,"), r"line 4: channel 'acc' is empty"),
        (HEADER + rows().replace("2.0,1.25", "2.0"), r"line 4: channel 'acc' is empty"),
        (HEADER + rows().replace("2.0,1.25", "inf,1.25"), r"line 4: channel 'base displacement' is infinite"),
        (HEADER + rows().replace("1.25", "over"), r"line 4, column 'acc': 'over' is not a number"),
        (HEADER + rows().replace("1.25", "1.25,7"), r"line 4 has 4 cells, the others 3"),
        ("#\n\n" + HEADER + "\n# a\n" + rows().replace("1.25", ""), r"line 8: channel 'acc' is empty"),
        (HEADER + rows().replace("0.003,", "0.002,"), r"has too few digits"),
        (HEADER + rows().replace("0.003,", "0.0005,"), r"goes back from 0\.002 s to 0\.0005 s at line 5"),
        (HEADER + rows(columns=(T, Y, 0 * A + 3)), r"'acc' is constant, 3 in all 8 samples"),
        ("acc [g]\n" + rows(columns=(A,)), r"one column only"),
        ("", r"is empty"),
        ("\n \n", r"is empty"),
        ("time [s],base [mm],acc [g]\n", r"holds no rows of at least two numbers"),
        ("Dear reader,\nthere is nothing here.\n", r"holds no rows of at least two numbers"),
        ("2021-05-04 10:00:00,1,2\n2021-05-04 10:00:01,2,2\n", r"what does the column 'column 2' hold"),
        ("time,y [m],x [m]\n" + "4.5.2021 10:00,1,2\n" * 3, r"'4\.5\.2021 10:00' is a date that can be read in"),
        ("time,y [m],x [m]\n" + "monday,1,2\n" * 3, r"neither texts nor dates are read, except 2026-03-01T12"),
        (HEADER + "0.0,1.0,2.0\n0.001,2.0,3.0\n", r"has 2 samples"),
        (HEADER.replace("[g]", "[gee]") + rows(), r"'acc': unknown unit 'gee'.*acceleration needs one of"),
        (HEADER.replace("[g]", "[mm/s]") + rows(), r"its name says acceleration, its unit velocity"),
        (HEADER.replace("[g]", "") + rows(), r"in which unit is 'acc'\? Say it in .*csv\.yaml .*, for"),
        (HEADER.replace("[s]", "") + rows(columns=(1e3 * T, Y, A)), r"(?s)in which unit is 'time'\?.*time, unit: \"\?"),
        ("base [mm],acc [g]\n" + rows(columns=(Y, A)), r"(?s)at which rate .*  sample_rate_hz: \"\?\""),
        (HEADER.replace("acc [g]", "y [mm]") + rows(), r"'base displacement \[mm\]' and 'y \[mm\]' hold"),
        ("time [s],y [mm],force [N],x [m]\n" + rows(columns=(T, Y, A, A)), r"'y \[mm\]' and 'force \[N\]' hold"),
        (HEADER.replace("acc [g]", "sensor") + rows(), r"the column 'sensor' hold: displacement, velocity"),
        ("time [s],base,acc\n" + "0,5,0,5,0,5\n1,5,1,5,2,5\n" * 3, r"header has 3 names, its rows have 6 cells"),
    ],
)  # fmt: skip
def test_bad_text(csv, text, message):
    refused(csv(text), message)


def test_channels_that_cannot_be_told_apart(csv):
    path = csv("CH0 [s],CH1 [mm],CH2 [g]\n" + rows())
    message = refused(
        path, r"what do the columns 'CH1 \[mm\]' and 'CH2 \[g\]' hold: base_displacement, "
    )
    assert f"Say it in {path}.yaml (--write-mapping writes it), for" in message
    columns = {"base_displacement": "CH1", "acceleration": "CH2"}
    assert read(path, filled(shown(message), columns)).excitation.name == "CH1"


@pytest.mark.parametrize(
    ("header", "chosen"),
    [
        ("T1 [s],a,b", {"base_displacement": "a", "displacement": "b"}),
        ("time [s],base [mm],acc", {"base_displacement": "base", "acceleration": "acc"}),
        ("time [s],base [mm],other [V]", {"base_displacement": "base", "displacement": "other"}),
        ("acc,no,yes", {"base_displacement": "no", "acceleration": "acc"}),
        (
            "time [s],disp mass [V],disp table [V]",
            {"base_displacement": "disp table", "displacement": "disp mass"},
        ),
        ("time [s],laser", {"displacement": "laser"}),
        (
            "time [s],acc [g],pick-up: 2 [g]",
            {"base_acceleration": "pick-up: 2", "acceleration": "acc"},
        ),
        ("time [s],x [mm],CH [m/s²]", {"base_acceleration": "CH", "displacement": "x"}),
        ("time [s],y [mm],force [N],x [mm]", {"base_displacement": "y", "displacement": "x"}),
        ("time [s],laser [mm],laser [mm]", {"base_displacement": 2, "displacement": 3}),
        ("a [in],time [ms],b [g]", {"base_displacement": "a", "acceleration": "b"}),
    ],
)
def test_a_mapping_that_a_message_shows_is_complete_and_read(tmp_path, header, chosen):
    path = tmp_path / "run.csv"
    columns = [T * 1e3 if "[ms]" in label else T if label.lower().startswith("t") else s
               for label, s in zip(header.split(","), (Y - A, Y, A, Y + A), strict=False)]  # fmt: skip
    path.write_text(header + "\n" + rows(columns=columns), encoding="utf-8")
    draft = shown(refused(path, "for example"))
    rate = {"sample_rate_hz": RATE} if "sample_rate_hz" in draft else {}
    measurement = read(path, filled(draft, chosen, **rate))
    names = {q: name if isinstance(name, str) else "laser" for q, name in chosen.items()}
    assert {q: measurement[q].name for q in measurement} == names


def test_a_mapping_that_a_message_shows_for_a_matrix_is_read(tmp_path):
    path = hdf5(tmp_path, signals=np.column_stack([Y, A, Y + A]))
    draft = shown(
        refused(path, r"what do the columns 'signals\[1\]', 'signals\[2\]' and 'signals\[3\]'")
    )
    columns = {"base_displacement": "signals[1]", "displacement": "signals[2]"}
    measurement = read(path, filled(draft, columns, sample_rate_hz=RATE))
    for quantity, values in zip(("base_displacement", "displacement"), (Y, A), strict=True):
        np.testing.assert_allclose(measurement[quantity].values, 1e-3 * values)


def test_nothing_is_shown_where_no_mapping_would_do(csv):
    path = csv("time [s],base [mm]\n" + rows(columns=(T, Y)))
    message = refused(path, r"finds no response: ")
    assert "base_displacement: {channel: base" in message


def test_channels_that_are_not_used_are_listed(csv):
    path = csv("time [s],base [mm],acc [g],CH 4 [V],t2 [s]\n" + rows(columns=(T, Y, A, Y, T)))
    with pytest.warns(
        RecordWarning,
        match=r"csv: channels not used: 'CH 4 \[V\]' \(.*\).*; say in .*yaml what they hold",
    ):
        assert set(read(path)) == {"base_displacement", "acceleration"}
    named = {"base_displacement": {"channel": 2}, "acceleration": {"channel": 3}}
    read(path, {"channels": named})  # on purpose


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        ({"acceleration": {"channel": "CH9"}}, r"channels\.acceleration\.channel: .* has no channel 'CH9'; it has 1 "),
        ({"acceleration": {"channel": 9}}, r"there is no channel 9; .* has 3: 1 'time \[s\]'"),
        ({"acceleration": {"channel": "acc", "time": "t9"}}, r"channels\.acceleration\.time: .* no channel 't9'"),
        ({"acceleration": {"channel": "acc", "time": "acc"}}, r"'acc' cannot be its own time"),
        ({"velocity": {"channel": "acc"}}, r"'g' is a unit of acceleration, but velocity needs"),
    ],
)  # fmt: skip
def test_a_mapping_that_does_not_fit(csv, rules, message):
    refused(
        csv(HEADER + rows()), message, {"channels": {"base_displacement": {"channel": 2}, **rules}}
    )


def test_a_name_that_stands_twice(csv):
    path = csv("time [s],CH [mm],CH [g]\n" + rows())
    rules = {"base_displacement": {"channel": "CH"}, "acceleration": {"channel": 3}}
    refused(path, r"has 2 channels 'CH', numbers 2 and 3; give one", {"channels": rules})


def test_unequal_lengths(tmp_path):
    path = hdf5(tmp_path, time_s=T, base_mm=Y, acc_g=A[:-1])
    refused(path, r"'acc' has 7, its time 'time' has 8 samples")
    refused(
        hdf5(tmp_path, base_mm=Y, acc_g=A[:-1], fs=RATE),
        r"unequal lengths: channel 'base' has 8, channel 'acc' has 7 samples",
    )


@pytest.mark.parametrize("rate", [0.0, -5.0, np.nan, "fast"])
def test_a_rate_that_is_none(tmp_path, rate):
    path = hdf5(tmp_path, {"fs": rate}, base_mm=Y, acc_g=A)
    refused(path, r"fs of channel .* is .*give sample_rate_hz")
    assert_expected(read(path, {"sample_rate_hz": RATE}))


def test_parquet_with_text_and_nulls(tmp_path):
    path = tmp_path / "run.parquet"
    frame = pd.DataFrame({"time_s": T, "base_mm": Y, "acc_g": [*A[:-1], None]})
    frame.to_parquet(path)
    refused(path, r"sample 8: channel 'acc' is empty")
    pd.DataFrame({"time_s": T, "base_mm": Y, "acc_g": list("abcdefgh")}).to_parquet(path)
    refused(path, r"column 'acc_g' holds texts")


def test_matlab_without_numbers(tmp_path):
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"note": "nothing"})
    refused(path, r"finds no response.*its columns are none")


def test_what_is_no_file(tmp_path):
    folder = tmp_path / "run.csv"
    folder.mkdir()
    refused(folder, "is a folder; give the files in it")
    refused(tmp_path / "no.csv", "no such file")
    (tmp_path / "run.xlsx").write_bytes(b"PK\x03\x04")
    refused(tmp_path / "run.xlsx", r"cannot be read as a spreadsheet, it is damaged or was cut")
    (tmp_path / "run.mf4").write_bytes(b"MDF     ")
    refused(tmp_path / "run.mf4", r"unknown suffix '\.mf4'; records end in \.csv")


SAMPLES = {".csv": "delimited text", ".parquet": "Parquet", ".mat": "MATLAB", ".h5": "HDF5"}
SAMPLES |= {".uff": "a universal file", ".tdms": "TDMS", ".wav": "WAV"}


def sample(path, kind=None, n=200):
    random = np.random.default_rng(3)
    t = np.arange(n) / RATE
    values = random.standard_normal((2, n))
    columns = {"time_s": t, "force_N": values[0], "velocity_m_per_s": values[1]}
    return write_columns(path, columns, kind == "matlab73")


@pytest.mark.parametrize(("suffix", "kind"), [*[(s, None) for s in SAMPLES], (".mat", "matlab73")])
def test_every_format_is_read_to_the_last_bit(tmp_path, suffix, kind):
    values = np.random.default_rng(3).standard_normal((2, 200))
    path = sample(tmp_path / f"run{suffix}", kind)
    measurement = read(path)
    for quantity, expected in zip(("force", "velocity"), values, strict=True):
        np.testing.assert_array_equal(measurement[quantity].values, expected)
        np.testing.assert_array_equal(measurement[quantity].t, np.arange(200) / RATE)


@pytest.mark.parametrize("suffix", SAMPLES)
def test_a_file_that_is_not_what_its_name_says(tmp_path, suffix):
    for other, title in SAMPLES.items():
        if other == suffix:
            continue
        wrong = tmp_path / f"run{suffix}"
        shutil.copy(sample(tmp_path / f"original{other}"), wrong)
        message = rf"is not .*, as its name says, but {title}; rename it to run{re.escape(other)}$"
        if (suffix, other) == (".mat", ".h5"):  # MATLAB 7.3 is HDF5: read as such
            assert len(read(wrong)["force"]) == 200
        else:
            refused(wrong, message)


@pytest.mark.parametrize("suffix", [s for s in SAMPLES if s != ".csv"])
def test_bytes_of_no_format(tmp_path, suffix):
    path = tmp_path / f"run{suffix}"
    path.write_bytes(bytes(range(256)) * 20)
    refused(path, "its first bytes are those of no known format")
    path.write_bytes(b"")
    refused(path, "is empty")


CUT_SHORT = r"cut short|damaged|incomplete|no known format"
CUT = [(suffix, None) for suffix in SAMPLES if suffix != ".csv"] + [(".mat", "matlab73")]


@pytest.mark.parametrize(("suffix", "kind"), CUT, ids=[k or s for s, k in CUT])
@pytest.mark.parametrize("part", [0.02, 0.3, 0.6, 0.9, 0.999])
def test_a_truncated_file(tmp_path, suffix, kind, part):
    path = sample(tmp_path / f"run{suffix}", kind)
    content = path.read_bytes()
    path.write_bytes(content[: int(part * len(content))])
    refused(path, CUT_SHORT)


def test_a_truncated_text(tmp_path):
    path = sample(tmp_path / "run.csv")
    lines = path.read_bytes().splitlines(keepends=True)
    whole = b"".join(lines[:100])
    path.write_bytes(whole + lines[100].rpartition(b",")[0])  # in the middle of a row
    with pytest.warns(RecordWarning) as warned:
        read(path)
    said = " ".join(str(one.message) for one in warned)
    assert "its last line has no end" in said
    assert (
        "'velocity': 1 sample is empty or not a number, and left out of what is fitted: line 101"
        in said
    )
    path.write_bytes(whole + lines[100].rstrip()[:-3])  # in the middle of its last number
    with pytest.warns(RecordWarning, match=r"if the file was cut, its last number is wrong"):
        assert len(read(path)["velocity"]) == 100


LIBRARIES = {".parquet": "pyarrow", ".mat": "pymatreader", ".h5": "h5py", ".uff": "pyuff"}
LIBRARIES |= {".tdms": "nptdms"}


@pytest.mark.parametrize(("suffix", "package"), LIBRARIES.items())
def test_a_missing_library_names_the_extra(tmp_path, monkeypatch, suffix, package):
    path = sample(tmp_path / f"run{suffix}")
    present = importlib.import_module

    def absent(name, *rest):
        if name.partition(".")[0] == package:
            raise ModuleNotFoundError(name)
        return present(name, *rest)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(
        RecordError, match=rf'needs the package {package}.*pip install "dampbalance\[records\]"'
    ):
        read(path)


def test_padding_of_a_table_is_left_out(tmp_path):
    # In a table the shorter channel is empty at its end.
    path = tmp_path / "run.csv"
    random = np.random.default_rng(5)
    for n in (3, 20, 39, 40):
        force, velocity = random.standard_normal(40), random.standard_normal(n)
        columns = {"force_time_s": np.arange(40) / 1000.0, "force_N": force}
        columns |= {"velocity_time_s": np.arange(n) / 500.0, "velocity_m_per_s": velocity}
        frame = pd.DataFrame({name: pd.Series(values) for name, values in columns.items()})
        frame.to_csv(path, index=False)
        found = read(path)
        np.testing.assert_array_equal(found["force"].values, force)
        np.testing.assert_array_equal(found["velocity"].values, velocity)
        np.testing.assert_array_equal(found["velocity"].t, columns["velocity_time_s"])


def test_empty_rows_at_the_end_of_a_table(csv):
    path = csv(HEADER + rows() + ",,\n" * 7)  # spreadsheets leave such
    assert_expected(read(path))
    path.write_text(HEADER + rows() + ",,\n" * 7 + "0.015,1.0,1.0\n")
    refused(path, "line 10: channel .* is empty")


def test_a_record_without_a_drive_is_a_free_decay(csv):
    found = read(csv("t (s),x (mm)\n0,1\n1,2\n2,-1\n3,0\n"))
    assert list(found) == ["displacement"]
    assert not found.driven


def test_what_may_drive_a_record_must_be_named_or_left_out(csv):
    path = csv("t (s),x (mm),CH2 (V)\n0,1,0\n1,2,1\n2,-1,0\n3,0,1\n")
    refused(
        path,
        r"what does the column 'CH2 \[V\]' hold: .*If it is a free decay, give --kind ring-down",
    )
    assert list(read(path, {"channels": {"displacement": {"channel": "x"}}})) == ["displacement"]


@pytest.mark.parametrize(
    ("name", "quantity", "factor"),
    [
        ("Laser [mm]", "displacement", 1e-3),
        ("Ch1 (m/s)", "velocity", 1.0),
        ("a0 [g]", "acceleration", G),
    ],
)
def test_a_single_signal_is_a_response_by_its_unit(name, quantity, factor, csv):
    record = read(csv(f"t [s],{name}\n" + rows(columns=(T, Y))))
    assert not record.driven
    np.testing.assert_array_equal(record[quantity].values, factor * Y)


@pytest.mark.parametrize("name", ["Laser", "Ch1 [V]", "load cell [N]"])
def test_a_single_signal_that_no_unit_makes_a_response_is_refused(name, csv):
    refused(csv(f"t [s],{name}\n" + "0.00,1\n0.01,2\n" * 20), "finds no|what does the column")
