"""Channel names × units → quantity; and what a mapping to start from proposes, given back, reads the same."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import pyuff
import yaml

from dampbalance import read_records
from dampbalance.records.errors import RecordError, RecordWarning
from dampbalance.records.readers import mapping_to_start_from, read
from dampbalance.records.units import column_name, find_unit, split_label
from records.drafts import filled, shown
from records.formats import write_columns

T = np.arange(400) / 1000.0
SIGNALS = [np.cos(40.0 * T + i) + 0.3 * np.sin(91.0 * i * T) for i in range(4)]
BASE_D, BASE_A, FORCE = "base_displacement", "base_acceleration", "force"
X, V, A, R = "displacement", "velocity", "acceleration", "relative_displacement"
IGNORED = "ignore:.*(channels not used|is taken for the)"


def record(tmp_path, headings):
    """A text file with times and a signal under each heading, separated by tabs."""
    columns = [T, *SIGNALS[: len(headings)]]
    rows = ["\t".join(f"{v:.9g}" for v in row) for row in zip(*columns, strict=True)]
    path = tmp_path / "run.txt"
    path.write_text("\n".join(["\t".join(["time [s]", *headings]), *rows, ""]), encoding="utf-8")
    return path


def held(measurement):
    """Quantity → which of the signals it is."""
    of = {}
    for q in measurement:
        values = measurement[q].values
        close = [np.corrcoef(values, signal)[0, 1] > 0.999999 for signal in SIGNALS]
        of[q] = close.index(True)
    return of


def read_twice(path):
    """The record, once as its names say, once by the mapping to start from: the same."""
    plain = read(path)
    mapped = read(path, yaml.safe_load(mapping_to_start_from(path)))
    assert list(mapped) == list(plain)
    for q in plain:
        np.testing.assert_array_equal(mapped[q].values, plain[q].values)
        np.testing.assert_array_equal(mapped[q].t, plain[q].t)
    return plain


READ = [
    # a unit of force drives, next to a response
    (["Hammer [N]", "Acc [g]"], {FORCE: 0, A: 1}),
    (["Acc [g]", "Hammer [N]"], {FORCE: 1, A: 0}),
    (["Load cell [lbf]", "Accel [g]"], {FORCE: 0, A: 1}),
    (["load [kN]", "CH [m/s²]"], {FORCE: 0, A: 1}),
    (["LC1 (N)", "Laser (mm)"], {FORCE: 0, X: 1}),
    # the only one left answers
    (["Shaker Table Accel (g)", "Payload Accel (g)"], {BASE_A: 0, A: 1}),
    (["Payload Accel (g)", "Shaker Table Accel (g)"], {BASE_A: 1, A: 0}),
    (["base [mm]", "sensor 3 [g]"], {BASE_D: 0, A: 1}),
    (["force [N]", "Polytec (mm/s)"], {FORCE: 0, V: 1}),
    (["base [mm]", "Payload Accel (g)", "spare [N]"], {BASE_D: 0, A: 1}),
    (["base [mm]", "x [m/s]"], {BASE_D: 0, V: 1}),  # a direction
    # input and output
    (["disp_in [mm]", "disp_out [mm]"], {BASE_D: 0, X: 1}),
    (["disp_out_mm", "disp_in_mm"], {BASE_D: 1, X: 0}),
    (["ACC_IN/g", "ACC_OUT/g"], {BASE_A: 0, A: 1}),
    (["Weg Eingang/mm", "Weg Ausgang/mm"], {BASE_D: 0, X: 1}),
    (["force in [N]", "output [g]"], {FORCE: 0, A: 1}),
    # names and units in full, as ever
    (["base displacement [mm]", "displacement [mm]"], {BASE_D: 0, X: 1}),
    (["Weg Tisch/mm", "Relativweg/mm"], {BASE_D: 0, R: 1}),
    (["y [MM]", "acc [G]"], {BASE_D: 0, A: 1}),
    (["y [in]", "x in inches"], {BASE_D: 0, X: 1}),
    (["Laser [mm]"], {X: 0}),
    (["Table laser 2 [mm]"], {X: 0}),  # the only signal
    (["x [mm]", "Conductance [S]"], {X: 0}),
    (["x [mm]", "wind [kn]"], {X: 0}),
]


@pytest.mark.filterwarnings(IGNORED)
@pytest.mark.parametrize(("headings", "quantities"), READ, ids=lambda of: " + ".join(of))
def test_what_names_and_units_say_is_read_and_the_mapping_reads_the_same(
    tmp_path, headings, quantities
):
    path = record(tmp_path, headings)
    assert held(read_twice(path)) == quantities


REFUSED = [
    # no unit: neither inches nor anything else
    (["disp_in", "disp_out"], "in which units are 'disp_", {BASE_D: 0, X: 1}),
    (["disp_out", "disp_in"], "in which units are 'disp_", {BASE_D: 1, X: 0}),
    # either may drive
    (["x [mm]", "CH [m/s²]"], "hold: base_acceleration or acceleration", {BASE_A: 1, X: 0}),
    (["Laser 1 [mm]", "Laser 2 [mm]"], "hold: base_displacement or disp", {BASE_D: 0, X: 1}),
    (["Hammer [N]", "A1 [g]", "A2 [g]"], r"A2 \[g\]' hold: acceleration\?", {FORCE: 0, A: 1}),
    # alike: nothing says which of them drives
    (["acc 1 [g]", "acc 2 [g]"], "'acc 1 .g.' and 'acc 2 .g.' hold", {BASE_A: 0, A: 1}),
    (["acc [g]", "acc [g]"], "'acc .g.' and 'acc .g.' hold", {BASE_A: 1, A: 0}),
    (["mass acc 1 [g]", "acc 2 [g]"], "does the column 'acc 2 .g.' hold", {BASE_A: 1, A: 0}),
    (["disp 1", "disp 2", "acc 1", "acc 2"], "what do the columns", {BASE_D: 0, X: 1, A: 3}),
    (["Signal [g]", "Reference [g]"], "hold: base_acceleration or", {BASE_A: 1, A: 0}),
    (["Hammer [V]", "Acc [g]"], "the scale of 'Hammer .V.'", {FORCE: 0, A: 1}),
    # case counts
    (["y [mm]", "x [Nm]"], "its name says displacement, its unit force", None),
    # one record rotates or moves along a line
    (["Laser [mm]", "Torque [Nm]"], r"'Torque' rotates and 'Laser' moves along a line", None),
    (["x [mm]", "force [N]", "angle [deg]"], "what do the columns", {FORCE: 1, X: 0}),
    (["base [mm]", "speed [rpm]"], r"'speed' rotates and 'base' moves along a line", None),
    (["y [mm]", "x [MN]"], r"unknown unit 'MN' \(did you mean mN\?\)", None),
    (["y [mm]", "force [KN]", "x [mm]"], "'y .mm.' and 'force .KN.' hold", {BASE_D: 0, X: 2}),
    (["force [KN]", "x [mm]"], r"unknown unit 'KN' \(did you mean kN\?\)", {FORCE: 0, X: 1}),
    (["base [mm]", "disp [m/s]"], r"'disp \[m/s\]' hold: velocity", {BASE_D: 0, V: 1}),
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
        with pytest.raises(RecordError, match="is not allowed"):
            read(path, draft)
        names = {q: (split_label(headings[i])[0], i + 2) for q, i in quantities.items()}
        assert held(read(path, filled(draft, names))) == quantities


def test_a_displacement_that_nothing_but_its_unit_names_may_be_against_the_base(tmp_path):
    path = record(tmp_path, ["base [mm]", "LVDT [mm]"])
    with pytest.warns(
        RecordWarning, match=r"'LVDT \[mm\]' is taken for the displacement of the mass"
    ) as told:
        read(path)
    assert "say relative_displacement in" in str(told[0].message)
    mapping = mapping_to_start_from(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(path, yaml.safe_load(mapping))  # said
        read(record(tmp_path, ["force [N]", "LVDT [mm]"]))  # the base is at rest


def test_a_unit_in_the_wrong_case_is_mended_by_what_the_message_says(tmp_path):
    path = record(tmp_path, ["y [mm]", "x [mm]"])
    path.write_text(path.read_text().replace("time [s]", "TIME [S]"))
    with pytest.raises(
        RecordError, match=r"'S' is a unit of a conductance \(did you mean s\?\)"
    ) as of:
        read(path)
    assert held(read(path, filled(shown(of.value)))) == {BASE_D: 0, X: 1}
    path.write_text(path.read_text().replace("TIME [S]", "t [s]").replace("x [mm]", "x [furlong]"))
    with pytest.raises(RecordError, match="unknown unit 'furlong'") as of:
        read(path, {"channels": {BASE_D: {"channel": "y"}, X: {"channel": "x"}}})
    assert "say unit: m, or as recorded, at channels.displacement in mapping" in str(of.value)


def test_a_channel_with_another_name_and_a_quotient_for_its_unit_is_not_the_one_asked_for(tmp_path):
    path = record(tmp_path, ["base [mm]", "w [m/s]"])
    named = {BASE_D: {"channel": "base"}, V: {"channel": "v [m/s]"}}
    with pytest.raises(RecordError, match=r"has no channel 'v \[m/s\]'; it has 1 'time \[s\]'"):
        read(path, {"channels": named})
    named[V]["channel"] = "W [m/s]"
    assert held(read(path, {"channels": named})) == {BASE_D: 0, V: 1}


def test_a_time_that_another_column_in_seconds_precedes_is_still_the_time(tmp_path):
    path = record(tmp_path, ["pulse [ms]", "CH1 [mm]", "CH2 [g]"])
    path.write_text(path.read_text().replace("time [s]\tpulse [ms]", "pulse [ms]\ttime"))
    swapped = [line.split("\t") for line in path.read_text().splitlines()]
    swapped[1:] = [[row[1], row[0], *row[2:]] for row in swapped[1:]]
    path.write_text("\n".join("\t".join(row) for row in swapped) + "\n")
    mapping = yaml.safe_load(mapping_to_start_from(path))
    assert mapping["time"] == {"channel": "time", "unit": "s"}
    mapping = filled(mapping, {BASE_D: "CH1", A: "CH2"})
    assert read(path, mapping)[A].t[-1] == pytest.approx(T[-1])


def test_known_free_decays_need_no_drive():
    signals = {
        "time_s": T,
        "Acc [g]": SIGNALS[0],
        "Hammer [V]": SIGNALS[1],
        "Base [mm]": SIGNALS[2],
    }
    for left, quantities in (("Base [mm]", [A]), ("Hammer [V]", [BASE_D, A])):
        given = {name: of for name, of in signals.items() if name != left}
        (one,) = read_records(given, free=True)
        assert list(one.quantities) == quantities
    given = {"time_s": T, "Ch 1 [g]": SIGNALS[0], "Hammer [V]": SIGNALS[1], "Ch 3": SIGNALS[2]}
    (one,) = read_records(given, free=True)
    assert list(one.quantities) == [A]
    both = signals | {"Force [N]": SIGNALS[3]}
    (one,) = read_records(both, free=True)
    assert list(one.quantities) == [BASE_D, A]


@pytest.mark.parametrize("suffix", [".csv", ".tsv", ".parquet", ".mat", ".h5", ".uff", ".tdms"])
@pytest.mark.parametrize("quantities", [(FORCE, A), (BASE_A, R, V), (X,)])
def test_in_every_format_the_mapping_reads_the_same(tmp_path, suffix, quantities):
    columns = dict(zip(map(column_name, quantities), SIGNALS, strict=False))
    path = write_columns(tmp_path / f"run{suffix}", {"time_s": T, **columns})
    assert set(read_twice(path)) == {*quantities}


# Universal files: a channel is what its ID lines, its component and its node say.

NODE = {"rsp_node": 0, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3}
UNIVERSAL = {
    "ID lines": (
        [{"id1": "Payload", "rsp_node": 2}, {"id1": "Table", "rsp_node": 1}],
        ["Payload Acceleration at node 2 +Z", "Table Acceleration"],
        True,
    ),
    "second ID lines": (
        [{"id1": "Test 4", "id2": "Mass"}, {"id1": "Test 4", "id2": "Shaker"}],
        ["Mass Acceleration", "Shaker Acceleration"],
        True,
    ),
    "components": (
        [{"rsp_ent_name": "Mass", "rsp_node": 7}, {"rsp_ent_name": "Base", "rsp_node": 7}],
        ["Mass Acceleration", "Base Acceleration"],
        True,
    ),
    "a reference node": (
        [{"rsp_node": 2}, {"rsp_node": 1}],
        ["Acceleration at node 2 +Z", "Acceleration at node 1 +Z, the reference"],
        False,
    ),
    "a title and a reference node": (
        [{"id1": "Run 3", "rsp_node": 5, "ref_dir": -1}, {"id1": "Run 3", "rsp_node": 1, "rsp_dir": -1, "ref_dir": -1}],
        ["Run 3 Acceleration at node 5 +Z", "Run 3 Acceleration at node 1 -X, the reference"],
        False,
    ),
    "a date": (
        [{"id3": "01-MAR-26 10:00:05", "rsp_node": 2}, {"id3": "01-MAR-26 10:00:00", "rsp_node": 1}],
        ["Acceleration at node 2 +Z", "Acceleration at node 1 +Z, the reference"],
        False,
    ),
}  # fmt: skip


def universal(path, sets):
    """A universal file with data sets of accelerations in g, both labelled alike; the mass first."""
    common = {
        "type": 58, "binary": 0, "func_type": 1, "abscissa_spacing": 1, "abscissa_spec_data_type": 17,
        "orddenom_spec_data_type": 0, "ordinate_spec_data_type": 12, "ordinate_axis_lab": "Acceleration",
        "ordinate_axis_units_lab": "g", "x": T, "id1": "NONE",
    }  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # pyuff leaves closing to the collector
        pyuff.UFF(str(path)).write_sets(
            [common | NODE | own | {"data": s} for own, s in zip(sets, SIGNALS, strict=False)],
            mode="add",
        )
    return path


@pytest.mark.parametrize("kind", UNIVERSAL)
def test_channels_of_universal_files_are_told_apart(tmp_path, kind):
    sets, names, recognised = UNIVERSAL[kind]
    path = universal(tmp_path / "run.uff", sets)
    mapping = yaml.safe_load(mapping_to_start_from(path))
    mapped = read(path, filled(mapping, {BASE_A: names[1], A: names[0]}))
    assert held(mapped) == {BASE_A: 1, A: 0}
    assert [mapped[A].name, mapped[BASE_A].name] == names
    if recognised:
        assert held(read(path)) == held(mapped)
    else:
        with pytest.raises(RecordError, match="hold: base_acceleration or acceleration"):
            read(path)


# The whole table of units: no other unit differs from one of them in case alone.

PREFIXES = ("", *"TGMkhdcmµnp", "da")
NAMED = [
    "m", "g", "s", "A", "K", "mol", "cd", "Hz", "N", "Pa", "J", "W", "C", "V", "F", "Ω", "S", "Wb", "T", "H",
    "lm", "lx", "Bq", "Gy", "Sv", "kat", "rad", "bar", "Nm", "Ns", "min", "h", "d", "kn", "L", "t",
]  # fmt: skip
# Nobody measures these: megametres, giganewtons, gigaradians, mega-inches.
OF_NO_RIG = ["Mm", "GN", "Grad", "Min"]


def test_no_unit_is_read_as_another_that_differs_in_case_alone():
    symbols = {p + unit for p in PREFIXES for unit in NAMED} - {*OF_NO_RIG}
    known = {s: unit for s in symbols if (unit := find_unit(s)) is not None}
    folded = {s: unit.name for s, unit in known.items() if s != unit.name.replace(" ", "")}
    assert not folded
    # S/s are samples
    rates = {f"{s}/s": find_unit(f"{s}/s") for s in symbols - {"s", "S"}}
    assert not {s: unit.name for s, unit in rates.items() if unit and s != unit.name}
    assert {"m", "mm", "µm", "nm", "N", "kN", "mN", "s", "ms", "µs", "ns", "g", "mg", "Hz"} <= {
        *known
    }


@pytest.mark.parametrize("text", ["NM", "MNm", "kn", "S", "MS", "mS", "µS", "nS", "Ns", "NS", "H"])
def test_units_that_case_tells_apart(text):
    assert find_unit(text) is None
