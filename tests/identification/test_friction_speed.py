"""Friction at steady speeds as a user meets it: columns, units, words, files."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from dampbalance import RecordError, identify, identify_friction_speed, read_records
from dampbalance.commands.main import main
from dampbalance.identification.outputs import outputs_of
from fit.test_friction_speed import NOISE, TRUE, table

SAMPLED = 0.3 * np.sin(np.linspace(0.0, 50.0, 2000))


def columns(seed=0, v="velocity_rad_per_s", F="torque_N_m", by_v=1.0, by_F=1.0, **more):
    speeds, forces = table(seed, **more)
    return {v: speeds / by_v, F: forces / by_F}


def written(path, table):
    head, rows = ",".join(table), np.column_stack([*table.values()])
    np.savetxt(path, rows, "%.9g", delimiter=",", header=head, comments="")
    return str(path)


def codes(found):
    return {one.code for one in found.findings} | {one.code for one in found.check}


def test_a_table_is_recognised_and_its_friction_usable():
    found = identify(columns())
    assert found.options["kind"] == "friction-speed"
    for symbol in ("F_k", "c"):
        low, high = found.intervals[symbol]
        assert low < TRUE[symbol] < high
        assert found.verdicts[symbol].verdict == "usable"
    of = found.answer.merit
    assert abs(of["offset_N"] - TRUE["T_0"]) < 3.0 * of["offset_standard_error_N"]
    assert {"offset", "laws of speed", "no K_z"} <= codes(found)
    assert found.text().count("K_z") == 1
    said = found.text() + json.dumps(found.document())
    assert "the gain of the torque" in said
    assert "the motion reads 1 % too large" in said


@pytest.mark.parametrize(
    ("head", "by_v", "by_F", "unit"),
    [
        (("speed (rpm)", "torque (mN m)"), math.pi / 30.0, 1e-3, "N m"),
        (("speed [deg/s]", "Torque [Nm]"), math.pi / 180.0, 1.0, "N m"),
        (("qd (rad/s)", "tau (N m)"), 1.0, 1.0, "N m"),
        (("velocity_mm_per_s", "friction_force_N"), 1e-3, 1.0, "N"),
        (("v (m/s)", "F (mN)"), 1.0, 1e-3, "N"),
        (("omega_rad_s", "torque_Nm"), 1.0, 1.0, "N m"),
        (("speed_mm_s", "load_N"), 1e-3, 1.0, "N"),
    ],
)
def test_columns_and_units_of_rotations_and_translations(tmp_path, head, by_v, by_F, unit):
    path = written(tmp_path / "table.csv", columns(2, *head, by_v, by_F))
    found = identify(path)
    assert found.coordinate.unit("N") == unit
    reference = identify(columns(2))
    for symbol, value in reference.values.items():
        assert found.values[symbol] == pytest.approx(value, rel=1e-6)
    mapping = tmp_path / "draft.yaml"
    assert main(["identify", path, "--write-mapping", str(mapping)]) == 0
    assert identify(path, mapping=mapping).values == found.values


def test_the_order_of_the_rows_and_their_files_do_not_matter(tmp_path):
    whole = columns(3)
    order = np.random.default_rng(3).permutation(120)
    shuffled = {name: of[order] for name, of in whole.items()}
    ways = [
        {name: of[own] for name, of in whole.items()} for own in (slice(0, 60), slice(60, None))
    ]
    one = identify(whole).values
    for found in (identify(shuffled), identify(ways, kind="friction-speed")):
        assert found.values == pytest.approx(one, rel=1e-9)


def test_a_column_of_standard_errors_weights_the_rows(tmp_path):
    v, F = table(4)
    error = np.where(np.arange(v.size) % 2 == 0, NOISE, 30.0 * NOISE)
    F = F + 30.0 * NOISE * np.random.default_rng(5).normal(size=v.size) * (error > NOISE)
    rows = {"velocity_rad_per_s": v, "torque_N_m": F}
    plain = identify(rows)
    weighted = identify({**rows, "torque_std_N_m": error})
    ratio = plain.standard_errors["F_k"] / weighted.standard_errors["F_k"]
    assert 10.0 < ratio < 30.0  # half of the rows have all of the weight: 30 √½
    low, high = weighted.intervals["F_k"]
    assert low < TRUE["F_k"] < high
    path, mapping = (
        written(tmp_path / "t.csv", {**rows, "torque std (N m)": error}),
        tmp_path / "m.yaml",
    )
    assert main(["identify", path, "--write-mapping", str(mapping)]) == 0
    assert identify(path, mapping=mapping).values == identify(path).values
    # the file has nine digits, and climbs end within 1e-6
    assert identify(path).values == pytest.approx(weighted.values, rel=1e-5)
    some = identify({**rows, "torque_std_N_m": np.where(v > 0.0, error, 0.0)})
    assert "errors not used" in codes(some)
    assert some.values == plain.values


def test_friction_that_falls_with_the_speed_is_taken_and_said():
    found = identify(columns(6, F_S=0.5))
    low, high = found.intervals["F_k"]
    assert low < TRUE["F_k"] < high
    assert "(Stribeck) by F_S = 0." in found.screen()
    of = found.answer.merit
    assert abs(of["v_S_m_per_s"] - 0.02) < 4.0 * of["v_S_standard_error_m_per_s"]


def test_friction_that_is_rounded_at_rest_is_told_from_a_damper():
    found = identify(columns(6, v_0=0.03))
    assert found.answer.name == "rounded"
    for symbol in ("F_k", "c"):
        low, high = found.intervals[symbol]
        assert low < TRUE[symbol] < high
    of = found.answer.merit
    assert abs(of["v_0_m_per_s"] - 0.03) < 4.0 * of["v_0_standard_error_m_per_s"]


def test_one_direction_leaves_friction_and_offset_one_number():
    v, F = table(7)
    found = identify({"v_rad_per_s": v[:60], "torque_N_m": F[:60]}, kind="friction-speed")
    assert found.verdicts["F_k"].verdict == "none"
    assert "all speeds have one direction" in found.verdicts["F_k"].reason
    assert found.verdicts["c"].verdict == "usable"
    (one,) = (one for one in found.findings if one.code == "one direction")
    both, error = one.numbers["sum"]
    assert abs(both - TRUE["F_k"] - TRUE["T_0"]) < 3.0 * error
    assert not found.no_answer
    assert found.sensitivities()[1]["drive_gain_1_percent"] == pytest.approx({"c": 0.01})
    lifted = identify({"v_rad_per_s": v[:60], "torque_N_m": F[:60] - 5.0}, kind="friction-speed")
    assert lifted.values["c"] == pytest.approx(found.values["c"], rel=1e-6)
    turned = identify({"v_rad_per_s": v[:60], "torque_N_m": -F[:60]}, kind="friction-speed")
    assert turned.values["c"] == pytest.approx(found.values["c"], rel=1e-9)


def test_one_size_of_speed_leaves_friction_and_damping_one_number():
    v = np.tile([0.1, -0.1], 6)
    F = 1.2 * np.sign(v) + 0.01 * np.random.default_rng(8).normal(size=12)
    found = identify({"velocity_m_per_s": v, "force_N": F})
    assert found.values["F_k"] == pytest.approx(1.2, abs=0.01)
    assert found.verdicts["c"].verdict == "none"


def test_a_reversed_sign_rows_at_rest_and_another_law_are_said():
    v, F = table(9)
    turned = identify({"v_rad_per_s": v, "torque_N_m": -F})
    assert "flipped" in codes(turned)
    assert turned.values["F_k"] == pytest.approx(identify(columns(9)).values["F_k"], rel=1e-9)
    rest = {"v_rad_per_s": np.append(v, 0.0), "torque_N_m": np.append(F, 5.0)}
    assert "rows at rest" in codes(identify(rest))
    bent = F + 0.4 * np.sign(v) * np.sin(40.0 * v) ** 2
    found = identify({"v_rad_per_s": v, "torque_N_m": bent})
    assert "other law of speed" in codes(found)
    # and the interval holds what that does
    low, high = found.intervals["F_k"]
    assert high - low > 0.2


def test_samples_in_time_are_asked_for_their_rate_and_may_be_said_to_be_speeds():
    sampled = {"v_m_per_s": SAMPLED, "force_N": np.sign(SAMPLED) + SAMPLED}
    with pytest.raises(RecordError, match="give --kind friction-speed"):
        read_records(sampled)
    found = identify_friction_speed(sampled)
    assert found.values == pytest.approx({"F_k": 1.0, "c": 1.0}, rel=1e-6)


def test_integers_of_a_table_are_no_counter_that_ran_over():
    v = np.array([1, -1, 60, -60, 127, -127])
    found = identify({"speed_rpm": v, "torque_mN_m": 2 * v + 100 * np.sign(v)})
    assert found.values["F_k"] == pytest.approx(0.1, rel=1e-6)


def test_too_few_rows_and_other_channels_are_refused():
    with pytest.raises(ValueError, match="need 4 at least"):
        identify({"speed_rpm": [1, -1, 2], "torque_N_m": [3, -3, 4]})
    with pytest.raises(ValueError, match="need a velocity and a force"):
        identify_friction_speed({"time_s": np.arange(9) / 9.0, "x_m": np.arange(9) ** 2 / 9.0})
    with pytest.raises(ValueError, match="these are friction at steady speeds: leave it out"):
        identify(columns(), 2310.0)


def test_a_known_gain_is_taken_off_and_its_uncertainty_in_the_interval():
    gain = {"channel": "torque_N_m", "gain": 2.0, "gain_uncertainty": 0.1}
    mapping = {"channels": {"torque": gain, "angular_velocity": {"channel": "velocity_rad_per_s"}}}
    found, plain = identify(columns(), mapping=mapping), identify(columns())
    assert found.values["F_k"] == pytest.approx(plain.values["F_k"] / 2.0, rel=1e-9)
    expected = math.hypot(plain.standard_errors["F_k"] / 2.0, 0.05 * found.values["F_k"])
    assert found.standard_errors["F_k"] == pytest.approx(expected, rel=1e-6)


def test_command_report_and_document(tmp_path, capsys):
    path = written(tmp_path / "arm.csv", columns(10, "velocity (rad/s)", "torque (N m)"))
    out = tmp_path / "found"
    assert main(["identify", path, "--kind", "friction-speed", "--output", str(out)]) == 0
    assert "T_k = 0." in capsys.readouterr().out
    assert {file.name for file in out.iterdir()} == {*outputs_of("friction-speed")}
    document = json.loads((out / "identification.json").read_text(encoding="utf-8"))
    assert document["kind"] == "friction-speed"
    fit = document["approaches"][document["answer"]]
    assert fit["T_k_interval_N_m"][0] < TRUE["F_k"] < fit["T_k_interval_N_m"][1]
    assert len(document["speeds"]["torque_of_the_law_N_m"]) == 120
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "Other ways of evaluation" not in page
    assert identify(path).rows.empty
