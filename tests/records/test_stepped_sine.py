"""Tables of steady responses to a stepped sine: the same lines however a laboratory writes them, and every error.

The truth is the closed form of a linear oscillator, (F/X) e^{iφ} = k − mω² + iωc, at two levels of force.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy.io import savemat

from dampbalance import RecordError, read_records
from dampbalance.records.readers import mapping_to_start_from
from records.drafts import filled, shown
from records.formats import row, uff_set, write_uff, xlsx

M, C, K = 2.0, 10.0, 5000.0
HZ = np.linspace(6.0, 10.0, 21)
OMEGA = 2.0 * np.pi * HZ
Z = K - M * OMEGA**2 + 1j * OMEGA * C
PHI = np.angle(Z)
FORCES = (1.0, 3.0)
LINES = 2 * HZ.size
ORDERS = {"displacement (mm)": (0, 1e3), "velocity (mm/s)": (1, 1e3)}
ORDERS["acceleration (g)"] = (2, 1 / 9.80665)


def table(response="displacement (mm)", quarters=0, sign=-1, unit="rad"):
    """Columns of a laboratory that counts phases so: φ = n π/2 − s p."""
    order, factor = ORDERS[response]
    p = sign * (0.5 * np.pi * quarters - PHI) * (180.0 / np.pi if unit == "deg" else 1.0)
    return {
        "Frequency [Hz]": np.tile(HZ, 2),
        "Force amplitude [N]": np.repeat(FORCES, HZ.size),
        response: np.concatenate([F / abs(Z) * OMEGA**order * factor for F in FORCES]),
        f"phase ({unit})": np.tile(p, 2),
        "level": np.repeat([1.0, 2.0], HZ.size),
    }


def written(path, columns):
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


@pytest.mark.parametrize(("sign", "unit"), [(1, "rad"), (-1, "deg")])
@pytest.mark.parametrize("quarters", range(3))
@pytest.mark.parametrize("response", ORDERS)
def test_phases_are_understood_however_they_are_counted(response, quarters, sign, unit):
    columns, random = table(response, quarters, sign, unit), np.random.default_rng(quarters)
    (record,) = read_records(columns)
    require_truth(record.levels)
    for name in ("Force amplitude [N]", response):  # noise of 1 % lets none be taken for another
        columns[name] *= 1.0 + 0.01 * random.standard_normal(LINES)
    size = 0.01 if unit == "rad" else math.degrees(0.01)
    columns[f"phase ({unit})"] += size * random.standard_normal(LINES)
    for level in levels_of(columns):
        np.testing.assert_allclose(level.phi, PHI, atol=0.06)  # six standard deviations
    way = f"the {MOTIONS[quarters]} {'leads' if sign > 0 else 'lags'} the force"
    assert record.convention == f"its phases are those by which {way}"
    with pytest.raises(RecordError, match="is a table of steady responses, without samples"):
        record.corrected()


@pytest.mark.parametrize("order", range(3))
@pytest.mark.parametrize("response", ORDERS)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_base_may_be_given_by_any_motion(order, response, sign):
    columns = table(response, (ORDERS[response][0] - order) % 4, sign)
    drive = 1e-3 * columns.pop("Force amplitude [N]") * np.tile(OMEGA, 2) ** order
    unit, factor = (("mm", 1e3), ("mm/s", 1e3), ("m/s²", 1.0))[order]
    columns[f"base {MOTIONS[order]} ({unit})"] = drive * factor
    (record,) = read_records(columns)
    assert not record.by_force
    require_truth(record.levels, drive=1e-3)


def test_every_file_of_a_table_gives_the_same_lines(tmp_path):
    columns = table()
    lines = np.column_stack(list(columns.values())).tolist()
    xlsx(tmp_path / "a.xlsx", map(row, [list(columns), *lines]))
    for path in (written(tmp_path / "a.csv", columns), tmp_path / "a.xlsx"):
        require_truth(levels_of(path))
    frame = read_records(pd.DataFrame(columns))[0].to_frame()
    assert list(frame) == ["level", "frequency_Hz", "force_N", "displacement_m", "phase_rad"]
    assert set(frame["level"]) == {"level 1", "level 2"}
    of = [pd.DataFrame(columns).query(f"level == {n}").drop(columns="level") for n in (1, 2)]
    levels = levels_of(*(written(tmp_path / f"level{n}.csv", one) for n, one in enumerate(of, 1)))
    require_truth(levels)
    assert [of.name for of in levels] == ["level1.csv", "level2.csv"]


TABLE = {
    "frequency": {"channel": "f", "unit": "Hz"},
    "force": {"channel": "F", "unit": "N"},
    "displacement": {"channel": "X", "unit": "mm"},
    "phase": {"channel": "p", "unit": "deg"},
}
X = 1e3 * np.outer(1.0 / abs(Z), FORCES)
P = np.degrees(np.outer(PHI, np.ones(2)))
SHORT = {"f": HZ, "F": np.outer(np.ones(HZ.size), FORCES), "X": X, "p": P}


def test_structures_of_levels(tmp_path):
    """As a control system leaves them: an array of structures under each name."""
    levels = [tuple(v if v.ndim == 1 else v[:, n] for v in SHORT.values()) for n in (0, 1)]
    held = np.array(levels, dtype=[(name, object) for name in SHORT])
    savemat(tmp_path / "a.mat", {"data": {"one": held, "two": held[::-1]}})
    (record,) = read_records(tmp_path / "a.mat", mapping={"table": TABLE})
    require_truth(record.levels, [1.0, 3.0, 3.0, 1.0])
    assert [of.name for of in record.levels] == ["one 1", "one 2", "two 1", "two 2"]


@pytest.mark.parametrize(("kind", "order", "unit"), [(8, 0, "m"), (11, 1, "m/s"), (12, 2, "m/s^2")])
def test_frequency_responses_of_universal_files(tmp_path, kind, order, unit):
    of = {"binary": 0, "func_type": 4, "ord_data_type": 6, "abscissa_spec_data_type": 18}
    of |= {"ordinate_spec_data_type": kind, "ordinate_axis_units_lab": unit, "id1": "NONE"}
    of |= {"orddenom_spec_data_type": 13, "orddenom_axis_units_lab": "N", "abscissa_spacing": 1}
    path = tmp_path / "run.uff"
    write_uff(path, [uff_set(HZ, "force_N", (1j * OMEGA) ** order / Z) | of])
    with pytest.raises(RecordError, match=r"finds nothing for the force \(or force_N"):
        read_records(path)
    (level,) = levels_of(path, mapping={"force_N": 3.0})
    # pyuff writes the abscissa and the values with six digits
    np.testing.assert_allclose(level.X, 3.0 / abs(Z), rtol=1e-5)
    np.testing.assert_allclose(level.phi, PHI, atol=1e-5)


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
    for force in FORCES:
        file = written(tmp_path / f"level {force:g}.csv", of)
        file.with_suffix(".csv.yaml").write_text(f"force_N: {force}", encoding="utf-8")
    require_truth(levels_of(*sorted(tmp_path.glob("*.csv"))))
    require_truth(levels_of({"force (N)": np.full(HZ.size, 3.0), **of}), (3.0,))
    with pytest.raises(RecordError, match="dB of what"):
        levels_of({"force (N)": HZ, "receptance (dB)": of.pop(name), **of})


def test_a_coherence_gives_the_error_of_each_line():
    """1/SNR = (1 − γ²)/γ², of n averages: √((1 − γ²)/(2γ²n)) of |H| and of its phase (Bendat & Piersol)."""
    columns, coherence = table(), np.tile(np.linspace(0.8, 0.99, HZ.size), 2)
    error = np.sqrt((1.0 - coherence) / (2.0 * coherence))
    (known,) = read_records({**columns, "coherence": coherence, "averages": np.full(42, 20.0)})
    (weighed,) = read_records({**columns, "coherence": coherence})
    for own, level, weight in zip(np.split(error, 2), known.levels, weighed.levels, strict=True):
        np.testing.assert_allclose(level.error, own / math.sqrt(20.0), rtol=1e-12)
        np.testing.assert_allclose(weight.error / own, weight.error[0] / own[0], rtol=1e-9)
        assert weight.error.max() < 1e-5  # weights alone: the scatter has the size


def test_standard_errors_are_taken_as_one():
    """2 % of the response, 1 % of the force, 0.03 rad of the phase: √((0.02² + 0.01² + 0.03²)/2)."""
    columns = table()
    columns["displacement standard error (mm)"] = 0.02 * columns["displacement (mm)"]
    columns["Force std [N]"] = 0.01 * columns["Force amplitude [N]"]
    columns["phase error (rad)"] = np.full(LINES, 0.03)
    for level in levels_of(columns):
        expected = math.sqrt((0.02**2 + 0.01**2 + 0.03**2) / 2.0)
        np.testing.assert_allclose(level.error, expected, rtol=1e-12)
    aside = table() | {"velocity std [mm/s]": np.ones(LINES)}  # of nothing
    for columns in (table(), aside):
        require_truth(levels_of(columns))
        assert all(level.error is None for level in levels_of(columns))


def test_angular_frequencies_root_mean_squares_and_phases_over_a_turn():
    columns = table("acceleration (g)", 2)
    of = {
        "omega": 2.0 * np.pi * columns.pop("Frequency [Hz]"),
        "Force rms [N]": columns.pop("Force amplitude [N]") / math.sqrt(2.0),
        "acc rms [g]": columns.pop("acceleration (g)") / math.sqrt(2.0),
        "phase (rad)": columns.pop("phase (rad)") - 2.0 * np.pi,
    }
    require_truth(levels_of(of | columns))


def changed(name, at, value):
    columns = table()
    columns[name][at] = value
    return columns


def renamed(old, new, unit="rad"):
    return {new if name == old else name: of for name, of in table(unit=unit).items()}


def without(name):
    return {key: of for key, of in table().items() if key != name}


# a level whose amplitudes and phases hardly change is near several oscillators
FAR = {"frequency [Hz]": np.linspace(1.0, 1.2, 5), "force [N]": [1.0, 1.01, 0.99, 1.0, 1.01]}
FAR |= {"displacement [mm]": np.full(5, 0.2), "phase [rad]": 0.5 * np.pi + 1e-3 * np.arange(5)}
ERRORS = {
    "line 6: column 'phase', nan, is empty or not a number": changed("phase (rad)", 4, math.nan),
    "line 6: column 'displacement', -1, is not positive": changed("displacement (mm)", 4, -1.0),
    "line 6: column 'Freq.*turns back or stands": changed("Frequency [Hz]", 4, HZ[3]),
    "line 23: column 'Frequency'.*name a column of levels": without("level"),
    r"line 1\d: a displacement of \d.* m is too large": renamed("displacement (mm)", "x (m)"),
    "may be leads or lags; give lines on both sides": FAR,
    "90, is no coherence": table() | {"coherence": np.full(LINES, 90.0)},
    "its phase is the same": table() | {"phase (rad)": np.ones(LINES)},
    "finds nothing for a force or the base": without("Force amplitude [N]"),
    "finds nothing for a response": without("displacement (mm)"),
    "displacement and velocity for a response": table() | table("velocity (mm/s)"),
    "both taken for force": table() | {"input force (N)": np.ones(LINES)},
    "'force': has no unit: state it at table.force": renamed("Force amplitude [N]", "force"),
    "they are in deg; state it at table.phase.unit": renamed("phase (deg)", "phase (rad)", "deg"),
    "they are in rad; state it at table.phase.unit": renamed("phase (rad)", "phase (deg)"),
    "line 32: the phase .* another convention": changed("phase (rad)", 30, -PHI[9]),
    "level 1 has 2 lines": {name: of[[0, 1, 21, 22, 23]] for name, of in table().items()},
}


@pytest.mark.parametrize("message", ERRORS)
def test_what_is_wrong_is_named_with_its_line_and_a_remedy(tmp_path, message):
    path = written(tmp_path / "a.csv", ERRORS[message])
    with pytest.raises(RecordError, match=f"^{path}: .*{message}"):
        read_records(path)


def test_a_mapping_says_what_a_table_does_not(tmp_path):
    columns = dict(zip("abcde", table(unit="deg").values(), strict=True))
    path = written(tmp_path / "a.csv", columns)
    places = zip(TABLE, ("a", 2, "c", "d"), strict=True)
    mapping = {q: TABLE[q] | {"channel": place} for q, place in places}
    mapping["level"] = {"channel": "e"}
    require_truth(levels_of(path, mapping={"table": mapping}))
    with pytest.raises(RecordError, match=r"force\.channel: .* no channel 'x'"):
        read_records(path, mapping={"table": mapping | {"force": {"channel": "x"}}})


UNCLEAR = {
    "all clear": {},
    "a transducer": {"Force amplitude [N]": "Load cell [N]"},
    "a response without a name": {"displacement (mm)": "probe 1 [mm]"},
    "units": {"Frequency [Hz]": "a [Hz]", "Force amplitude [N]": "b [N]", "phase (rad)": "d [rad]"},
    "a frequency by its samples": {"Frequency [Hz]": "column 1", "level": "coherence"},
    "no unit of phase": {"phase (rad)": "phase"},
}


@pytest.mark.parametrize("names", UNCLEAR.values(), ids=UNCLEAR)
def test_the_draft_of_a_mapping_reads_the_table(tmp_path, names):
    size = HZ.size if "level" in names else LINES
    columns = {names.get(name, name): of[:size] for name, of in table().items()}
    path = written(tmp_path / "a.csv", columns)
    draft = yaml.safe_load(mapping_to_start_from(path, stepped=True))
    named = {"displacement": "probe 1", "force": ("b", "Load cell"), "phase": "d"}
    named["frequency"] = "a", "column 1"
    mapping = filled(draft, named, units={"frequency": "Hz"})
    require_truth(levels_of(path, mapping=mapping), FORCES[: size // HZ.size])
    if columns.keys() & {"Load cell [N]", "probe 1 [mm]", "phase"}:
        with pytest.raises(RecordError) as refused:
            levels_of(path)
        assert shown(refused.value) == draft


def test_the_draft_of_a_mapping_names_matrices_and_groups_once(tmp_path):
    path, names = tmp_path / "a.mat", ("frequency_Hz", "force_N", "displacement_mm", "phase_deg")
    held = dict(zip(names, SHORT.values(), strict=True))
    first = {key: of.T[0] if of.ndim > 1 else of for key, of in held.items()}
    for matrices, forces in (({"one": first}, FORCES[:1]), (held, FORCES)):
        savemat(path, matrices)
        draft = yaml.safe_load(mapping_to_start_from(path))
        levels = levels_of(path, mapping=draft)
        require_truth(levels, forces)
    assert [of.name for of in levels] == ["level 1", "level 2"]
    savemat(path, held | {"displacement_mm": np.outer(1e3 / abs(Z), [1.0, 2.0, 3.0])})
    with pytest.raises(RecordError, match="are not in the same groups"):
        read_records(path, mapping=draft)
