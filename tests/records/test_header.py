"""What the lines above the rows of a text state, in several languages and encodings: rate, channels, sensitivities; and
files that need no mapping although something beside their columns says what they hold."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import scipy.io

from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, read_records, steady_orbit
from dampbalance.records.errors import RecordError
from dampbalance.records.readers import mapping_to_start_from, read
from records.drafts import filled, shown
from records.formats import text_file

RATE, G = 2500.0, 9.80665
T = np.arange(1500) / RATE
BASE, MASS = np.cos(31.0 * T), 1.7 * np.cos(31.0 * T - 0.6) + 0.1 * np.cos(93.0 * T)
GRAVITY, NOISE = np.ones(T.size), 0.004 * np.random.default_rng(64).standard_normal((4, T.size))
MM = {"base_displacement": 1e-3 * BASE, "displacement": 1e-3 * MASS}
IN_G = {"base_acceleration": G * BASE, "acceleration": G * MASS}
MIXED = {"base_acceleration": G * BASE, "displacement": 1e-3 * MASS}
F_DRIVES = {"force": BASE, "displacement": 1e-3 * MASS}


def write(folder, head, columns, *layout):
    return text_file(folder / "run.txt", [head], columns, *layout)


def same(path, held, rate=RATE, **options):
    """Compare what is read with signals, to the twelve digits of a scale in a draft; and its rate."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        (record,) = read_records(path, **options)
    assert {*record} == {*held}
    for quantity, values in held.items():
        np.testing.assert_allclose(record[quantity].values, values, rtol=1e-11, atol=1e-15)
        assert np.median(np.diff(record[quantity].t)) * rate == pytest.approx(1.0, rel=1e-9)
    return record


# line → rate, and how the file is written
RATES = {
    "Sample rate: 2560 Hz": 2560.0,
    "Sampling Frequency (Hz): 800": 800.0,
    "# fs = 12800 Hz": 12800.0,
    "Abtastrate: 5 kHz": 5000.0,
    "Abtastfrequenz: 5,12 kHz": (5120.0, ";", ","),
    "Messfrequenz\t2,400 Hz": (2400.0, "\t"),
    "dt = 0.00025 s": 4000.0,
    "Sample interval: 0.8 ms": 1250.0,
    "Pas de temps : 0,4 ms": (2500.0, ";", ","),
    "Run 7; sampled at 10 kS/s; by hand": 10000.0,
    "Scan rate [scans/s],1024": 1024.0,
    "Acquisition rate 640 samples per second": (640.0, "\t"),
    "Fréquence d'échantillonnage : 6 400 Hz": (6400.0, ";", ","),
    "采样频率: 512 Hz": 512.0,
    "サンプリング周波数,4096,Hz": 4096.0,
    "Sample rate: 2048 Hz\ndt: 0.000488": 2048.0,  # rounded
    "Sample rate: 640 Hz, resampling: off": (640.0, ";"),
}
# nothing is taken: which of two, kHz or MHz, of what
NO_RATES = {
    "Sample rate: 2000 Hz\nSample interval: 1 ms": ",.",
    "Sample rate: 2.048 kHz": ";,",
    "Sample rate divider: 40": ",.",
    "Calibration interval: 12 h": ",.",
    "Sampling rate (Hz),2,000": ",.",
    "Sample interval: 0.97": ",.",
    "FS = 5000": ",.",
    "Sample rate 40960 Hz, decimated to 2560 Hz": ";.",
    "Sample rate: 10 kHz\nDecimation: 4": ";.",
}


@pytest.mark.parametrize("line", RATES)
def test_a_line_of_the_header_gives_the_rate(tmp_path, line):
    rate, *layout = RATES[line] if isinstance(RATES[line], tuple) else (RATES[line], ",")
    head = f"{line}\nbase [mm]{layout[0]}mass [mm]"
    record = same(write(tmp_path, head, [BASE, MASS], *layout), MM, rate)
    (told,) = (of for of in record.warnings if of.code == "taken")
    assert f"{rate:,g}" in told.numbers["what"]


@pytest.mark.parametrize("line", NO_RATES)
def test_a_rate_that_is_not_clear_is_asked_for(tmp_path, line):
    delimiter, decimal = NO_RATES[line]
    head = f"{line}\nbase [mm]{delimiter}mass [mm]"
    path = write(tmp_path, head, [BASE, MASS], delimiter, decimal)
    with pytest.raises(RecordError, match="sample_rate_hz"):
        read(path)
    same(path, MM, 777.0, mapping={"sample_rate_hz": 777})


# head → columns, and what they hold
SENSORS = {
    "Channel 1: Table, sensitivity 98.7 mV/g\nChannel 2: Mass, sensitivity 10.4 mV/g\nt [s],Ch1 [V],Ch2 [V]":
        ([T, 0.0987 * BASE, 0.0104 * MASS], IN_G),
    "CH 1 (Base accelerometer) = 51 mV/g\nCH 2 = Mass laser, 0.4 mm/V\nt [s],CH 1 (mV),CH 2 (V)":
        ([T, 51.0 * BASE, MASS / 0.4], MIXED),
    "Kanal 1: Tisch, 10.06 mV/(m/s²)\nKanal 2: Masse, 0.5 m/s²/mV\nZeit [s],Kanal 1 [mV],Kanal 2 [mV]":
        ([T, 10.06 * G * BASE, G * MASS / 0.5], IN_G),
    "Base: 98.7 mV/g\nMass: 2.4 kg\nt [s],Base [V],Mass [g]": ([T, 0.0987 * BASE, MASS], IN_G),
    "Name,Base,Mass\nSensitivity,98.7 mV/g,10.4 mV/g\nt [s],Base [V],Mass [V]":
        ([T, 0.0987 * BASE, 0.0104 * MASS], IN_G),
    "Channel 1: Base, 98.7 mV/g, gain 1\nChannel 2: Mass, 10.4 mV/g, 0 dB\nt [s],Ch1 [V],Ch2 [V]":
        ([T, 0.0987 * BASE, 0.0104 * MASS], IN_G),
    "Channel 1: Base (g)\nChannel 2: Mass (mm)\nt [s],1,2": ([T, BASE, MASS], MIXED),
    "Channel 1: Base (g)\nChannel 2: Mass (mm)\nSample rate: 2500 Hz": ([BASE, MASS], MIXED),
}  # fmt: skip


@pytest.mark.parametrize("head", SENSORS)
def test_a_line_of_the_header_says_what_a_channel_is(tmp_path, head):
    columns, held = SENSORS[head]
    path = write(tmp_path, head, columns)
    same(path, held)
    same(path, held, mapping=filled(_draft(path)))  # the draft says the same


def _draft(path):
    return shown(f", for example\n{mapping_to_start_from(path)}")


def test_a_sensitivity_of_a_channel_without_a_unit_leaves_its_scale_to_be_filled_in(tmp_path):
    """The logger may have used it already."""
    head = "Channel 1: Base, 98.7 mV/g\nChannel 2: Mass, 10.4 mV/g\nt [s],Ch1,Ch2"
    path = write(tmp_path, head, [T, BASE, MASS])
    with pytest.raises(RecordError, match=r"the scale of 'Base .g.' and 'Mass .g.'.*(?s:.)*10.13"):
        read(path)
    same(path, IN_G, mapping=filled(_draft(path), scale=1.0))


@pytest.mark.parametrize(
    "gain", ["Gain: 20\n{}{}", "{}, gain x20{}, gain 20", "{}, 26 dB{}, 26 dB"]
)
def test_a_sensitivity_of_volts_behind_a_gain_is_asked_for(tmp_path, gain):
    """It gave channels 20 times too large, and F_k with them."""
    head = gain.format("Channel 1: Base, 98.7 mV/g", "\nChannel 2: Mass, 10.4 mV/g")
    volts = [T, 20 * 0.0987 * BASE, 20 * 0.0104 * MASS]
    path = write(tmp_path, f"{head}\nt [s],Ch1 [V],Ch2 [V]", volts)
    with pytest.raises(RecordError, match="what is the scale of"):
        read(path)
    draft = filled(_draft(path), scale=1.0)
    for of, size in zip(draft["channels"].values(), (0.0987, 0.0104), strict=True):
        of["scale"] = 1.0 / (20 * size)
    same(path, IN_G, mapping=draft)


def test_one_column_with_decimal_commas_is_one_channel(tmp_path):
    path = tmp_path / "vib.csv"
    rows = "\n".join(f"{x:.9f}".replace(".", ",") for x in 30.0 * MASS)
    path.write_text(f"Fréquence d'échantillonnage : 2500 Hz\nVitesse (mm/s)\n{rows}\n")
    (record,) = read_records(path, free=True)
    # half a unit of the last digit
    np.testing.assert_allclose(record["velocity"].values, 0.03 * MASS, atol=5e-13)


def test_volts_and_parts_of_full_scale_have_neither_unit_nor_scale_in_a_draft(tmp_path):
    """Drafts that guessed a unit, used as they were, gave numbers off by a factor."""
    path = write(tmp_path, "t [s],base [V],mass [V]", [T, BASE, MASS])
    rules = {q: {"channel": i, "unit": "mm"} for i, q in enumerate(MM, 2)}
    with pytest.raises(RecordError, match=r"what is the scale of 'base \[V\]'"):
        read(path, {"channels": rules})
    same(path, MM, mapping={"channels": {q: of | {"scale": 1.0} for q, of in rules.items()}})
    scipy.io.wavfile.write(
        tmp_path / "run.wav", 2500, (9e3 * np.stack([BASE, MASS], 1)).astype("i2")
    )
    for draft in map(_draft, (path, tmp_path / "run.wav")):
        assert {(of["unit"], of["scale"]) for of in draft["channels"].values()} == {("?", "?")}
        with pytest.raises(RecordError) as refused:
            read(path, draft)
        (line,) = str(refused.value).splitlines()  # one for all blanks
        assert all(key in line for key in draft["channels"])


# Headings of other languages, encodings and delimiters: head → what they hold, and the layout

HEADINGS = {
    "Zeit [s];Basis [mm];Masse [mm]": (MM, "\t"),
    "t [s],base [mm],mass [mm]": (MM, ";", ","),
    "t [s],base [g],mass [g],": (IN_G, " "),
    "時間 [s],台 変位 [mm],変位 [mm]": (MM, ",", ".", "shift_jis"),
    "時刻(s),加振台加速度(G),質量の変位(mm)": (MIXED, ",", ".", "cp932"),
    "时间（秒）\t基座加速度（g）\t位移（毫米）": (MIXED, "\t", ".", "gb18030"),
    "时间(s);激振力(N);质量块位移(mm)": (F_DRIVES, ";", ",", "gb18030"),
    "時間（s）,加振力（N）,変位（mm）": (F_DRIVES, ",", ".", "utf-16"),
    "Temps (s);Déplacement socle (mm);Déplacement de la masse (mm)": (MM, ";", ",", "cp1252"),
    "temps [s];accélération pot vibrant [g];accéléromètre masse [g]": (IN_G, ";", ","),
    # two bytes in a row that may be a Chinese sign are none, and a unit beats a letter
    "Größe (s);Basis (g);Maß éé (mm)": (MIXED, ";", ",", "cp1252"),
    "t [s],Table X [g],Mass X [g]": (IN_G,),
    "t [s],Base V (g),F (mm)": (MIXED,),
    "t [s],Base (g),Mass rel. to table (mm)": (
        {"base_acceleration": G * BASE, "relative_displacement": 1e-3 * MASS},
    ),
}


@pytest.mark.parametrize("head", HEADINGS)
def test_headings_of_a_laboratory(tmp_path, head):
    held, *layout = HEADINGS[head]
    same(write(tmp_path, head, [T, BASE, MASS], *layout), held)


# Sensors of three axes

AXES = {
    "t [s],Base X (g),Base Y (g),Base Z (g),Mass X (g),Mass Y (g),Mass Z (g)": (3, 3),
    "t_s,table_acc_x_g,table_acc_y_g,table_acc_z_g,acc_x_g,acc_y_g,acc_z_g": (3, 3),
    "t [s],Base (g),ax (g),ay (g),az (g)": (1, 3),
}


@pytest.mark.parametrize("head", AXES)
def test_the_axes_with_the_most_motion_are_read_of_a_forced_record(tmp_path, head):
    still = [0.02 * BASE + NOISE[0], GRAVITY + NOISE[1]], [NOISE[2], GRAVITY + NOISE[3]]
    base, mass = AXES[head]
    columns = [T, BASE, *still[0][: base - 1], MASS, *still[1][: mass - 1]]
    record = same(write(tmp_path, head, columns), IN_G)
    # one line names the axes that are read, and none the others
    (told,) = record.warnings
    assert told.code == "taken"
    same(tmp_path / "run.txt", IN_G, mapping=_draft(tmp_path / "run.txt"))


# MATLAB: timetables saved as what they consist of

DATA, NAMES, UNITS = np.column_stack([BASE, MASS]), ["Base", "Mass"], ["g", "mm"]
STATED = {"VariableNames": np.array(NAMES, dtype=object), "VariableUnits": np.array(UNITS, object)}
MATLAB = {
    "times": {"run": {"Data": DATA, "RowTimes": T, **STATED}},
    "rate": {"run": {"Data": DATA, "SampleRate": RATE, **STATED}},
    "properties": {"Data": DATA, "Properties": {"RowTimes": T, **STATED}},
    "fields": {"run": {"Time": T, "Base": BASE, "Mass": MASS, "Properties": STATED}},
}


@pytest.mark.parametrize("form", MATLAB)
def test_a_timetable_saved_as_arrays_has_its_names_and_units(tmp_path, form):
    scipy.io.savemat(tmp_path / "run.mat", MATLAB[form])
    same(tmp_path / "run.mat", MIXED)


# A set of files

OSCILLATOR = Oscillator(m=3.2, c=14.0, k=2600.0, K_z=90000.0, F_k=2.1)


def test_a_folder_of_records_is_identified_and_says_once_what_is_not_used(tmp_path):
    """Volts, sensitivities and a rate in the header; four columns that are not used, one of them empty."""
    head = "Sample rate: 1250 Hz\nChannel 1: Table, 98.7 mV/g\nChannel 2: Mass, 10.4 mV/g"
    for n, Y in enumerate((0.004, 0.007, 0.011)):
        orbit = steady_orbit(OSCILLATOR, BaseMotion(Y, 2.0 * math.pi * 4.1))
        of = {"rate_hz": 1250.0, "cycles": 20, "noise": 0.003, "seed": n, "channels": (*IN_G,)}
        y, x = (channel.values / G for channel in measured_orbit(orbit, **of).channels.values())
        columns = [0.0987 * y, 0.0104 * x, 20.0 + y, 0.0 * y, 3.6 + 0.1 * n + 0.0 * y]
        path = write(tmp_path, f"{head}\nCh1 [V],Ch2 [V],oil (°C),I (A),battery (V),", columns)
        text = path.read_text(encoding="utf-8").replace("\n", ",\n")
        (tmp_path / f"level{n}.csv").write_text(text, encoding="utf-8")
        path.unlink()
    (tmp_path / "notes.txt").write_text("Rig 2, 14 March, mass 3.2 kg\n", encoding="utf-8")
    found = identify(tmp_path, stiffness=OSCILLATOR.k)
    assert [of.name for of in found.records] == [str(tmp_path / f"level{n}.csv") for n in range(3)]
    pattern = read_records(str(tmp_path / "level*.csv"))  # as Windows gives it
    assert [of.name for of in pattern] == [of.name for of in found.records]
    # 1 %: four times the half width of the intervals, which noise of 0.3 % leaves
    truth = {"F_k": OSCILLATOR.F_k, "c": OSCILLATOR.c}
    assert {symbol: found.values[symbol] for symbol in truth} == pytest.approx(truth, rel=0.01)
    ((_, (_, said)),) = {of.kind for of in found.findings if of.code == "not used"}
    assert all(name in said for name in ("oil", "'I", "battery"))
    assert "column 6" not in said
