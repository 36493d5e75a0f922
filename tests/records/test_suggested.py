"""Channel names × units → quantity; and what a mapping to start from proposes, given back, reads the same."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import yaml

from dampbalance import read_records
from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import mapping_to_start_from, read
from dampbalance.records.units import split_label
from records.drafts import filled, shown
from records.formats import text_file, uff_set, write_uff

T = np.arange(400) / 1000.0
SIGNALS = [np.cos(40.0 * T + i) + 0.3 * np.sin(91.0 * i * T) for i in range(4)]
BASE_D, BASE_V, BASE_A, FORCE = "base_displacement", "base_velocity", "base_acceleration", "force"
X, V, A, R = "displacement", "velocity", "acceleration", "relative_displacement"
IGNORED = "ignore:.*(channels not used|is taken for the)"


def record(tmp_path, headings):
    """A text file with times and a signal under each heading, separated by tabs."""
    columns, head = [T, *SIGNALS[: len(headings)]], "\t".join(["time [s]", *headings])
    return text_file(tmp_path / "run.txt", [head], columns, "\t")


def held(measurement):
    """Quantity → which of the signals it is."""
    of = {}
    for q in measurement:
        values = measurement[q].values
        close = [np.corrcoef(values, signal)[0, 1] > 0.999999 for signal in SIGNALS]
        of[q] = close.index(True)
    return of


READ = [
    # a unit of force drives, next to a response
    (["Acc [g]", "Hammer [N]"], {FORCE: 1, A: 0}),
    (["LC1 (N)", "Laser (mm)"], {FORCE: 0, X: 1}),
    (["Kraft [N]", "Weg [mm]"], {FORCE: 0, X: 1}),
    # the only one left answers
    (["Payload Accel (g)", "Shaker Table Accel (g)"], {BASE_A: 1, A: 0}),
    (["base [mm]", "sensor 3 [g]"], {BASE_D: 0, A: 1}),
    (["table 2 [mm]", "laser 1 [mm]"], {BASE_D: 0, X: 1}),
    (["base [mm]", "Payload Accel (g)", "spare [N]"], {BASE_D: 0, A: 1}),
    (["base [mm]", "x [m/s]"], {BASE_D: 0, V: 1}),  # a direction
    # input and output
    (["disp_out_mm", "disp_in_mm"], {BASE_D: 1, X: 0}),
    (["Weg Eingang/mm", "Weg Ausgang/mm"], {BASE_D: 0, X: 1}),
    (["force in [N]", "output [g]"], {FORCE: 0, A: 1}),
    # names and units in full, as ever
    (["Weg Tisch/mm", "Relativweg/mm"], {BASE_D: 0, R: 1}),
    (["y [MM]", "acc [G]"], {BASE_D: 0, A: 1}),
    (["y [in]", "x in inches"], {BASE_D: 0, X: 1}),
    (["Ch1 (m/s)"], {V: 0}),
    (["Table laser 2 [mm]"], {X: 0}),  # the only signal
    (["x [mm]", "Conductance [S]"], {X: 0}),
    (["x [mm]", "wind [kn]"], {X: 0}),
    (["x [mm]", "oil (bar)", "I/A", "T [K]"], {X: 0}),  # no motion
    (["base [mm]", "mass minus base (mm)"], {BASE_D: 0, R: 1}),
    # two vibrometers
    (["base velocity [mm/s]", "mass velocity [mm/s]"], {BASE_V: 0, V: 1}),
    (["v_base (mm/s)", "v (mm/s)"], {BASE_V: 0, V: 1}),
    (["velocity base (mm/s)", "x/mm"], {BASE_V: 0, X: 1}),
]


@pytest.mark.filterwarnings(IGNORED)
@pytest.mark.parametrize(("headings", "quantities"), READ, ids=lambda of: " + ".join(of))
def test_what_names_and_units_say_is_read_and_the_mapping_reads_the_same(
    tmp_path, headings, quantities
):
    path = record(tmp_path, headings)
    assert held(read(path)) == quantities
    assert held(read(path, yaml.safe_load(mapping_to_start_from(path)))) == quantities


REFUSED = [
    # no unit: neither inches nor anything else
    (["disp_out", "disp_in"], "in which units are 'disp_", {BASE_D: 1, X: 0}),
    (["displacement", "friction"], "in which units are", {FORCE: 1, X: 0}),
    (["Reibkraft", "Geschwindigkeit"], "in which units are", {FORCE: 0, V: 1}),
    (["speed", "ch2"], "what does the column 'ch2'", {V: 0}),
    (["acc", "no", "yes"], "what do the columns 'no' and 'yes'", {BASE_D: 1, A: 0}),
    # inches or the input, unless another column is an output
    (
        ["force [N]", "x_in"],
        r"'x_in' hold: base_displacement or disp.*\(the .in. at",
        {FORCE: 0, X: 1},
    ),
    # either may drive
    (["x [mm]", "CH [m/s²]"], "hold: base_acceleration or acceleration", {BASE_A: 1, X: 0}),
    (["laser [mm]", "laser [mm]"], "hold: base_displacement or disp", {BASE_D: 0, X: 1}),
    (["Hammer [N]", "A1 [g]", "A2 [g]"], r"A2 \[g\]' hold: acceleration\?", {FORCE: 0, A: 1}),
    (["base [mm]", "acc"], "in which unit is 'acc'", {BASE_D: 0, A: 1}),
    (["base [mm]", "other [V]"], "does the column 'other .V.'", {BASE_D: 0, X: 1}),
    # alike: nothing says which of them drives
    (["acc [g]", "pick-up: 2 [g]"], "does the column 'pick-up: 2 .g.' hold", {BASE_A: 1, A: 0}),
    (["mass acc 1 [g]", "acc 2 [g]"], "does the column 'acc 2 .g.' hold", {BASE_A: 1, A: 0}),
    (["disp 1", "disp 2", "acc 1", "acc 2"], "what do the columns", {BASE_D: 0, X: 1, A: 3}),
    (["laser 1 (mm/s)", "laser 2 (mm/s)"], "base_velocity or velocity", {BASE_V: 0, V: 1}),
    (["Hammer [V]", "Acc [g]"], "the scale of 'Hammer .V.'", {FORCE: 0, A: 1}),
    # case counts
    (["y [mm]", "x [Nm]"], "finds no response: .* 'x .Nm.'", None),
    (["y [mm]", "force [KN]", "x [mm]"], "'y .mm.' and 'force .KN.' hold", {BASE_D: 0, X: 2}),
    (["force [KN]", "x [mm]"], r"unknown unit 'KN' \(did you mean kN\?\)", {FORCE: 0, X: 1}),
    (["base [mm]", "disp [m/s]"], r"'disp \[m/s\]' hold: velocity", {BASE_D: 0, V: 1}),
    # one record rotates or moves along a line
    (["Laser [mm]", "Torque [Nm]"], r"'Torque' rotates and 'Laser' moves along a line", None),
    (["x [mm]", "force [N]", "angle [deg]"], "what do the columns", {FORCE: 1, X: 0}),
    (["base [mm]", "speed [rpm]"], r"'speed' rotates and 'base' moves along a line", None),
]


@pytest.mark.filterwarnings(IGNORED)
@pytest.mark.parametrize(("headings", "message", "quantities"), REFUSED)
def test_what_is_unclear_is_refused_with_a_mapping_that_is_read_when_its_blanks_are_filled(
    tmp_path, headings, message, quantities
):
    path = record(tmp_path, headings)
    with pytest.raises(RecordError, match=message) as error:
        read(path)
    if quantities is not None:
        draft = shown(error.value)
        assert draft == yaml.safe_load(mapping_to_start_from(path))
        with pytest.raises(RecordError, match="blanks"):
            read(path, draft)
        names = {q: (split_label(headings[i])[0], i + 2) for q, i in quantities.items()}
        assert held(read(path, filled(draft, names))) == quantities


def test_a_displacement_that_nothing_but_its_unit_names_may_be_against_the_base(tmp_path):
    path = record(tmp_path, ["base [mm]", "LVDT [mm]"])
    with pytest.warns(RecordWarning, match=r"'LVDT \[mm\]' is taken for .*(?s:.)*say relative_d"):
        read(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(path, yaml.safe_load(mapping_to_start_from(path)))  # said
        read(record(tmp_path, ["force [N]", "LVDT [mm]"]))  # the base is at rest


def test_a_time_that_another_column_in_seconds_precedes_is_still_the_time():
    pulse = {"pulse [ms]": 5.0 * SIGNALS[0], "time": T}
    with pytest.raises(RecordError) as asked:
        read_records(pulse | {"CH1 [mm]": SIGNALS[1], "CH2 [mm]": SIGNALS[2]})
    assert shown(asked.value)["time"] == {"channel": "time", "unit": "s"}


FREE = [
    ({"Acc [g]": 0, "Hammer [V]": 1}, [A]),
    ({"Acc [g]": 0, "Base [mm]": 2}, [BASE_D, A]),
    ({"Ch 1 [g]": 0, "Hammer [V]": 1, "Ch 3": 2}, [A]),
    ({"Acc [g]": 0, "Hammer [V]": 1, "Base [mm]": 2, "Force [N]": 3}, [BASE_D, A]),
]


@pytest.mark.parametrize(("columns", "quantities"), FREE)
def test_known_free_decays_need_no_drive(columns, quantities):
    signals = {"time_s": T} | {name: SIGNALS[i] for name, i in columns.items()}
    (one,) = read_records(signals, free=True)
    assert list(one.quantities) == quantities


# Universal files: a channel is what its ID lines, its component and its node say.

UNIVERSAL = {
    "Payload Acceleration at node 2 +Z": {"id1": "Payload", "rsp_node": 2},
    "Table Acceleration": {"id1": "Table", "rsp_node": 1},
    "Mass Acceleration": {"id1": "Test 4", "id2": "Mass"},
    "Shaker Acceleration": {"id1": "Test 4", "id2": "Shaker"},
    "Acceleration at node 2 +Z": {"id3": "01-MAR-26 10:00:05", "rsp_node": 2},
    "Acceleration at node 1 +Z, the reference": {"id3": "01-MAR-26 10:00:00", "rsp_node": 1},
    "Body Acceleration at Body node 7 +Z": {"rsp_ent_name": "Body", "rsp_node": 7},
    "Base Acceleration": {"rsp_ent_name": "Base", "rsp_node": 7},
}  # name → head of the mass and of the base, by turns


@pytest.mark.parametrize("first", range(0, len(UNIVERSAL), 2))
def test_channels_of_universal_files_are_told_apart(tmp_path, first):
    names, path = [*UNIVERSAL][first : first + 2], tmp_path / "run.uff"
    common = {"binary": 0, "abscissa_spacing": 1, "ordinate_axis_lab": "Acceleration"}
    common |= {"ordinate_axis_units_lab": "g", "id1": "NONE", "rsp_node": 0}
    heads = [common | UNIVERSAL[name] for name in names]
    signals = zip(heads, SIGNALS, strict=False)
    write_uff(path, [uff_set(T, "acceleration_m_per_s2", x) | head for head, x in signals])
    mapping = yaml.safe_load(mapping_to_start_from(path))
    mapped = read(path, filled(mapping, {BASE_A: names[1], A: names[0]}))
    assert held(mapped) == {BASE_A: 1, A: 0}
    assert [mapped[A].name, mapped[BASE_A].name] == names
    if "reference" not in names[1]:
        assert held(read(path)) == held(mapped)
    else:
        with pytest.raises(RecordError, match="hold: base_acceleration or acceleration"):
            read(path)
