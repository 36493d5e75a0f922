"""Tables of steady responses to a stepped sine: the same lines however a laboratory writes them, and every error.

The truth is the closed form of a linear oscillator, (F/X) e^{iφ} = k − mω² + iωc, at two levels of force.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy.io import savemat

from dampbalance import RecordError, read_records
from dampbalance.records.readers import mapping_to_start_from
from dampbalance.records.stepped_sine import SteppedRecord
from records.drafts import filled, shown
from records.workbooks import row, xlsx

M, C, K = 2.0, 10.0, 5000.0
HZ = np.linspace(6.0, 10.0, 21)
OMEGA = 2.0 * np.pi * HZ
Z = K - M * OMEGA**2 + 1j * OMEGA * C
PHI = np.angle(Z)
FORCES = (1.0, 3.0)
ORDERS = {
    "displacement (mm)": (0, 1e3),
    "velocity (mm/s)": (1, 1e3),
    "acceleration (g)": (2, 1 / 9.80665),
}


def phases(quarters: int, sign: int) -> np.ndarray:
    """What a laboratory writes that counts phases so: φ = n π/2 − s p."""
    return sign * (0.5 * np.pi * quarters - PHI)


def table(
    response: str = "displacement (mm)", quarters: int = 0, sign: int = -1, unit: str = "rad"
) -> dict[str, np.ndarray]:
    order, factor = ORDERS[response]
    p = phases(quarters, sign) * (180.0 / np.pi if unit == "deg" else 1.0)
    X = np.concatenate([F / abs(Z) * OMEGA**order * factor for F in FORCES])
    return {
        "Frequency [Hz]": np.tile(HZ, 2),
        "Force amplitude [N]": np.repeat(FORCES, HZ.size),
        response: X,
        f"phase ({unit})": np.tile(p, 2),
        "level": np.repeat([1.0, 2.0], HZ.size),
    }


def written(path: Path, columns: dict[str, np.ndarray]) -> Path:
    pd.DataFrame(columns).to_csv(path, index=False)
    return path


def require_truth(levels, forces=FORCES, drive=1.0):
    assert len(levels) == len(forces)
    for level, F in zip(levels, forces, strict=True):
        np.testing.assert_allclose(level.omega, OMEGA, rtol=1e-12)
        np.testing.assert_allclose(level.drive, drive * F, rtol=1e-12)
        # a product and a quotient of floats, written with 17 digits
        np.testing.assert_allclose(level.X, F / abs(Z), rtol=1e-11)
        np.testing.assert_allclose(level.phi, PHI, atol=1e-11)


def levels_of(*records, **options):
    return [of for record in read_records(list(records), **options) for of in record.levels]


MOTIONS = ("displacement", "velocity", "acceleration")


@pytest.mark.parametrize("unit", ["rad", "deg"])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("quarters", range(3))
@pytest.mark.parametrize("response", ORDERS)
def test_phases_are_understood_however_they_are_counted(response, quarters, sign, unit):
    (record,) = read_records(table(response, quarters, sign, unit))
    require_truth(record.levels)
    way = f"the {MOTIONS[quarters]} {'leads' if sign > 0 else 'lags'} the force"
    assert record.convention == f"its phases are those by which {way}"
    assert way in repr(record)
    assert "42 lines at 2 levels" in repr(record)
    with pytest.raises(RecordError, match="is a table of steady responses, without samples"):
        record.corrected()


def test_phases_that_are_counted_on_over_a_turn():
    columns = table("acceleration (g)", 2, -1)
    columns["phase (rad)"] = columns["phase (rad)"] - 2.0 * np.pi
    require_truth(levels_of(columns))


@pytest.mark.parametrize("order", range(3))
@pytest.mark.parametrize("response", ORDERS)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_base_may_be_given_by_any_motion(order, response, sign):
    name = f"base {MOTIONS[order]} ({('mm', 'mm/s', 'm/s²')[order]})"
    n, _ = ORDERS[response]
    columns = table(response, (n - order) % 4, sign)
    Y = 1e-3 * np.repeat(FORCES, HZ.size)
    drive = Y * np.tile(OMEGA, 2) ** order * (1e3 if order < 2 else 1.0)
    del columns["Force amplitude [N]"]
    columns[name] = drive
    (record,) = read_records(columns)
    assert not record.by_force
    require_truth(record.levels, drive=1e-3)


def test_every_file_of_a_table_gives_the_same_lines(tmp_path):
    columns = table()
    pd.DataFrame(columns).to_csv(tmp_path / "a.tsv", sep="\t", index=False)
    lines = np.column_stack(list(columns.values())).tolist()
    xlsx(tmp_path / "a.xlsx", map(row, [list(columns), *lines]))
    for path in (written(tmp_path / "a.csv", columns), tmp_path / "a.tsv", tmp_path / "a.xlsx"):
        require_truth(levels_of(path))
    frame = read_records(pd.DataFrame(columns))[0].to_frame()
    assert list(frame) == ["level", "frequency_Hz", "force_N", "displacement_m", "phase_rad"]
    assert set(frame["level"]) == {"level 1", "level 2"}


def test_one_file_for_each_level(tmp_path):
    columns = table()
    files = []
    for number in (1.0, 2.0):
        own = {q: of[columns["level"] == number] for q, of in columns.items() if q != "level"}
        files.append(written(tmp_path / f"level{number:g}.csv", own))
    levels = levels_of(*files)
    require_truth(levels)
    assert [of.name for of in levels] == ["level1.csv", "level2.csv"]


TABLE = {
    "frequency": {"channel": "f", "unit": "Hz"},
    "force": {"channel": "F", "unit": "N"},
    "displacement": {"channel": "X", "unit": "mm"},
    "phase": {"channel": "p", "unit": "deg"},
}
SHORT = {
    "f": HZ,
    "F": np.outer(np.ones(HZ.size), FORCES),
    "X": 1e3 * np.outer(1.0 / abs(Z), FORCES),
    "p": np.degrees(np.outer(PHI, np.ones(2))),
}


def test_matrices_of_levels(tmp_path):
    savemat(tmp_path / "a.mat", SHORT)
    (record,) = read_records(tmp_path / "a.mat", mapping={"table": TABLE})
    require_truth(record.levels)
    assert [of.name for of in record.levels] == ["level 1", "level 2"]


def test_structures_of_levels(tmp_path):
    """As a control system leaves them: an array of structures under each name."""
    kind = np.dtype([(name, object) for name in SHORT])

    def of(*numbers):
        array = np.empty((1, len(numbers)), dtype=kind)
        for place, n in enumerate(numbers):
            array[0, place] = tuple(v if v.ndim == 1 else v[:, n] for v in SHORT.values())
        return array

    savemat(tmp_path / "a.mat", {"data": {"one": of(0, 1), "two": of(1, 0)}})
    (record,) = read_records(tmp_path / "a.mat", mapping={"table": TABLE})
    require_truth(record.levels, [1.0, 3.0, 3.0, 1.0])
    assert [of.name for of in record.levels] == ["one 1", "one 2", "two 1", "two 2"]


def frequency_response(path: Path, H: np.ndarray, kind: int, unit: str) -> Path:
    """A universal file with one frequency response, data set 58, written by pyuff."""
    pyuff = pytest.importorskip("pyuff")
    keys = {
        **{"type": 58, "binary": 0, "func_type": 4, "func_id": 0, "ord_data_type": 6, "x": HZ},
        **{"data": H, "num_pts": HZ.size, "abscissa_spacing": 1, "abscissa_min": HZ[0]},
        **{"abscissa_inc": HZ[1] - HZ[0], "abscissa_spec_data_type": 18},
        **{"ordinate_spec_data_type": kind, "ordinate_axis_units_lab": unit},
        **{"orddenom_spec_data_type": 13, "orddenom_axis_units_lab": "N"},
    }
    template = pyuff.prepare_58(
        binary=0, func_type=4, rsp_node=1, rsp_dir=1, ref_node=1, ref_dir=1, data=H, x=HZ,
        return_full_dict=True,
    )  # fmt: skip
    words = ("lab", "name", "id1", "id2", "id3", "id4", "id5")
    empty = {
        key: "NONE" if any(word in key for word in words) else 0
        for key, value in template.items()
        if value is None
    }
    pyuff.UFF(str(path)).write_sets(template | empty | keys, "add")
    return path


@pytest.mark.parametrize(("kind", "order", "unit"), [(8, 0, "m"), (11, 1, "m/s"), (12, 2, "m/s^2")])
def test_frequency_responses_of_universal_files(tmp_path, kind, order, unit):
    for F in FORCES:
        H = (1j * OMEGA) ** order / Z
        path = frequency_response(tmp_path / f"at{F:g}N.uff", H, kind, unit)
        Path(f"{path}.yaml").write_text(yaml.safe_dump({"force_N": F}), encoding="utf-8")
    levels = levels_of(*sorted(tmp_path.glob("*.uff")))
    for level, F in zip(levels, FORCES, strict=True):
        # pyuff writes the abscissa and the values with six digits
        np.testing.assert_allclose(level.X, F / abs(Z), rtol=1e-5)
        np.testing.assert_allclose(level.phi, PHI, atol=1e-5)


def test_the_force_of_a_frequency_response_is_asked_for(tmp_path):
    path = frequency_response(tmp_path / "a.uff", -(OMEGA**2) / Z, 12, "m/s^2")
    with pytest.raises(RecordError, match=r"finds nothing for the force \(or force_N"):
        read_records(path)


RATIOS = {
    "accelerance (dB re 1 m/s²/N)": (2, 1.0),
    "Inertance [dB ref. 1e-3 g/lbf]": (2, 4.4482216152605 / 9.80665e-3),
    "FRF magnitude (dB rel m/s/N)": (1, 1.0),
    "magnitude (dB re 1 µm/N)": (0, 1e6),
}


@pytest.mark.parametrize("name", RATIOS)
def test_a_frequency_response_may_be_in_decibels_and_in_a_file_for_each_level(tmp_path, name):
    order, factor = RATIOS[name]
    decibels = 20.0 * np.log10(OMEGA**order / abs(Z) * factor)
    of = {"f (Hz)": HZ, name: decibels, "phase (deg)": np.degrees(order * np.pi / 2 - PHI)}
    files = [written(tmp_path / f"level {i}.csv", of) for i in (1, 2)]
    for file, force in zip(files, FORCES, strict=True):
        file.with_suffix(".csv.yaml").write_text(f"force_N: {force}", encoding="utf-8")
    require_truth(levels_of(*files))
    (both,) = read_records({"force (N)": np.full(HZ.size, 3.0), **of})
    require_truth(both.levels, (3.0,))
    with pytest.raises(RecordError, match="dB of what"):
        levels_of({"force (N)": HZ, "receptance (dB)": of.pop(name), **of})


def test_a_coherence_gives_the_error_of_each_line():
    """1/SNR = (1 − γ²)/γ², of n averages: √((1 − γ²)/(2γ²n)) of |H| and of its phase (Bendat & Piersol)."""
    columns, coherence = table(), np.tile(np.linspace(0.8, 0.99, HZ.size), 2)
    error = np.sqrt((1.0 - coherence) / (2.0 * coherence))
    (known,) = read_records({**columns, "coherence": coherence, "averages": np.full(42, 20.0)})
    (weighed,) = read_records({**columns, "coherence": coherence})
    for own, level in zip(np.split(error, 2), known.levels, strict=True):
        np.testing.assert_allclose(level.error, own / math.sqrt(20.0), rtol=1e-12)
    for own, level in zip(np.split(error, 2), weighed.levels, strict=True):
        assert np.ptp(level.error / own) < 1e-9 * np.max(level.error / own)
        assert level.error.max() < 1e-5  # weights alone: the scatter has the size
    with pytest.raises(RecordError, match="no coherence"):
        read_records({**columns, "coherence": 100.0 * coherence})


def test_standard_errors_are_taken_as_one():
    """2 % of the response, 1 % of the force, 0.03 rad of the phase: √((0.02² + 0.01² + 0.03²)/2)."""
    columns = table()
    columns["displacement standard error (mm)"] = 0.02 * columns["displacement (mm)"]
    columns["Force std [N]"] = 0.01 * columns["Force amplitude [N]"]
    columns["phase error (rad)"] = np.full(2 * HZ.size, 0.03)
    for level in levels_of(columns):
        expected = math.sqrt((0.02**2 + 0.01**2 + 0.03**2) / 2.0)
        np.testing.assert_allclose(level.error, expected, rtol=1e-12)
    assert levels_of(table())[0].error is None


def test_angular_frequencies_and_root_mean_squares():
    columns = table()
    of = {
        "omega": 2.0 * np.pi * columns.pop("Frequency [Hz]"),
        "Force rms [N]": columns.pop("Force amplitude [N]") / math.sqrt(2.0),
        "X rms [mm]": columns.pop("displacement (mm)") / math.sqrt(2.0),
    }
    require_truth(levels_of(of | columns))


def changed(name: str, at: int, value: float) -> dict[str, np.ndarray]:
    columns = {key: of.copy() for key, of in table().items()}
    columns[name][at] = value
    return columns


def without(*names: str) -> dict[str, np.ndarray]:
    return {name: of for name, of in table().items() if name not in names}


ERRORS = {
    "missing": (changed("phase (rad)", 4, math.nan), "line 6: column 'phase', nan, is empty or not a number"),
    "negative": (changed("displacement (mm)", 4, -1.0), "line 6: column 'displacement', -1, is not positive"),
    "duplicate": (changed("Frequency [Hz]", 4, HZ[3]), "line 6: column 'Frequency'.*turns back or stands"),
    "stacked": (without("level"), "line 23: column 'Frequency'.*name a column of levels"),
    "large": (
        {(k if k != "displacement (mm)" else "displacement (m)"): of for k, of in table().items()},
        r"line 1\d: a displacement of \d.* m is too large: is the unit of displacement",
    ),
    "still": (table() | {"phase (rad)": np.ones(2 * HZ.size)}, "its phase is the same in all lines"),
    "no force": (without("Force amplitude [N]"), "finds nothing for a force or the base"),
    "no response": (without("displacement (mm)"), "finds nothing for a response"),
    "two responses": (table() | table("velocity (mm/s)"), "displacement and velocity for a response"),
    "two forces": (table() | {"input force (N)": np.ones(2 * HZ.size)}, "are both taken for force"),
    "no unit": (
        {(k if k[:5] != "Force" else "force"): of for k, of in table().items()},
        "column 'force': has no unit: state it at table.force.unit in .*a.csv.yaml",
    ),
    "degrees as radians": (
        {("phase (rad)" if k == "phase (deg)" else k): of for k, of in table(unit="deg").items()},
        "phases from .* rad do not occur in tables: they are in deg; state it at table.phase.unit",
    ),
    "radians as degrees": (
        {("phase (deg)" if k == "phase (rad)" else k): of for k, of in table().items()},
        "they are in rad; state it at table.phase.unit",
    ),
    "mixed": (changed("phase (rad)", 30, -PHI[9]), "line 32: the phase -.* follows another convention"),
    "few": ({name: of[[0, 1, 21, 22, 23]] for name, of in table().items()}, "level 1 has 2 lines"),
}  # fmt: skip


@pytest.mark.parametrize("kind", ERRORS)
def test_what_is_wrong_is_named_with_its_line_and_a_remedy(tmp_path, kind):
    columns, message = ERRORS[kind]
    path = written(tmp_path / "a.csv", columns)
    with pytest.raises(RecordError, match=message) as error:
        read_records(path)
    assert str(error.value).startswith(f"{path}: ")


def test_lines_far_from_resonance_do_not_tell_a_lead_from_a_lag():
    """A level whose amplitudes and phases hardly change is near several oscillators."""
    far = np.linspace(1.0, 1.2, 5)
    columns = {
        **{"frequency [Hz]": far, "force [N]": np.ones(5), "displacement [mm]": np.full(5, 0.2)},
        "phase [rad]": 0.5 * np.pi + 1e-3 * np.arange(5),
    }
    columns["force [N]"] = np.array([1.0, 1.01, 0.99, 1.0, 1.01])
    with pytest.raises(RecordError, match="may be leads or lags; give lines on both sides"):
        read_records(columns)


def test_a_mapping_says_what_a_table_does_not(tmp_path):
    columns = dict(zip("abcde", table(unit="deg").values(), strict=True))
    path = written(tmp_path / "a.csv", columns)
    mapping = {
        "frequency": {"channel": "a", "unit": "Hz"},
        "force": {"channel": 2, "unit": "N"},
        "displacement": {"channel": "c", "unit": "mm"},
        "phase": {"channel": "d", "unit": "deg"},
        "level": {"channel": "e"},
    }
    require_truth(levels_of(path, mapping={"table": mapping}))
    mapping["force"] = {"channel": "x"}
    with pytest.raises(RecordError, match=r"table\.force\.channel: .* has no channel 'x'"):
        read_records(path, mapping={"table": mapping})
    for wrong, message in (
        ({"table": mapping | {"phase": {"channel": 4, "unit": "m"}}}, "table.phase.unit"),
        ({"table": {q: mapping[q] for q in ("frequency", "force", "displacement")}}, "table.phase: missing"),
        ({"table": mapping, "channels": {"force": {"channel": 1}}}, "Not together with table"),
    ):  # fmt: skip
        with pytest.raises(RecordError, match=message):
            read_records(path, mapping=wrong)


UNCLEAR = {
    "all clear": {},
    "a transducer": {"Force amplitude [N]": "Load cell [N]"},
    "a response without a name": {"displacement (mm)": "probe 1 [mm]"},
    "another angle": {"phase (rad)": "lag [rad]"},
    "only units": {"Frequency [Hz]": "a [Hz]", "Force amplitude [N]": "b [N]", "phase (rad)": "d [rad]"},
    "a frequency by its samples": {"Frequency [Hz]": "column 1", "level": "coherence"},
    "no unit of phase": {"phase (rad)": "phase"},
    "a column left over": {"level": "coherence"},
}  # fmt: skip


@pytest.mark.parametrize("names", UNCLEAR.values(), ids=UNCLEAR)
def test_the_draft_of_a_mapping_reads_the_table(tmp_path, names):
    columns = table("displacement (mm)")
    if "level" in names:
        columns = {name: of[: HZ.size] for name, of in columns.items()}
    path = written(tmp_path / "a.csv", {names.get(name, name): of for name, of in columns.items()})
    draft = yaml.safe_load(mapping_to_start_from(path, stepped=True))
    named = {"displacement": "probe 1", "force": ("b", "Load cell"), "phase": ("d", "lag")}
    named["frequency"] = "a", "column 1"
    mapping = filled(draft, named, units={"frequency": "Hz"})
    require_truth(levels_of(path, mapping=mapping), FORCES[: columns["level"][-1].astype(int)])
    if set(names.values()) & {"Load cell [N]", "probe 1 [mm]", "phase"}:
        with pytest.raises(RecordError) as refused:
            levels_of(path)
        assert shown(refused.value) == draft


def test_the_draft_of_a_mapping_names_matrices_and_groups_once(tmp_path):
    names = dict(
        zip(SHORT, ("frequency_Hz", "force_N", "displacement_mm", "phase_deg"), strict=True)
    )
    held = {names[key]: of for key, of in SHORT.items()}
    savemat(tmp_path / "a.mat", held)
    savemat(
        tmp_path / "b.mat",
        {"one": {key: of.T[0] if of.ndim > 1 else of for key, of in held.items()}},
    )
    for path, forces in ((tmp_path / "a.mat", FORCES), (tmp_path / "b.mat", FORCES[:1])):
        draft = yaml.safe_load(mapping_to_start_from(path))
        require_truth(levels_of(path, mapping=draft), forces)


def test_a_standard_error_of_nothing_is_left_aside():
    columns = table() | {"velocity std [mm/s]": np.ones(2 * HZ.size)}
    require_truth(levels_of(columns))
    assert all(level.error is None for level in levels_of(columns))


def test_a_record_in_time_is_no_table():
    t = np.arange(0.0, 2.0, 1e-3)
    columns = {"time_s": t, "base_displacement_mm": np.cos(22.0 * t), "x_mm": np.sin(22.0 * t)}
    more = {"frequency (Hz)": np.full(t.size, 3.5), "phase (rad)": np.sin(t)}
    (record,) = read_records(columns | more)
    assert not isinstance(record, SteppedRecord)
    assert {*record.corrected()} == {"base_displacement", "displacement"}


def test_columns_of_levels_stand_in_the_same_groups(tmp_path):
    savemat(tmp_path / "a.mat", SHORT | {"X": np.outer(1e3 / abs(Z), [1.0, 2.0, 3.0])})
    with pytest.raises(RecordError, match="are not in the same groups"):
        read_records(tmp_path / "a.mat", mapping={"table": TABLE})


def test_conventions_are_found_with_noise():
    """1 % of noise on everything: every convention in 40 drawings, none taken for another."""
    for seed, (quarters, sign) in enumerate(itertools.product(range(3), (1, -1))):
        random = np.random.default_rng(seed)
        columns = table("acceleration (g)", quarters, sign)
        for name in ("Force amplitude [N]", "acceleration (g)"):
            columns[name] = columns[name] * (1.0 + 0.01 * random.standard_normal(2 * HZ.size))
        columns["phase (rad)"] = columns["phase (rad)"] + 0.01 * random.standard_normal(2 * HZ.size)
        for level in levels_of(columns):
            assert np.abs(level.phi - PHI).max() < 0.06  # six standard deviations
