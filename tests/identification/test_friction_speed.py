"""Friction at steady speeds as a user meets it: columns, units, files, and what a table leaves open."""

from __future__ import annotations

import math

import numpy as np
import pytest
import yaml

from dampbalance import RecordError, identify, identify_friction_speed, read_records
from dampbalance.identification.outputs import outputs_of
from dampbalance.records.readers import mapping_to_start_from
from fit.test_friction_speed import NOISE, TRUE, table


def columns(seed=0, v="velocity_rad_per_s", F="torque_N_m", by_v=1.0, by_F=1.0, **more):
    speeds, forces = table(seed, **more)
    return {v: speeds / by_v, F: forces / by_F}


def stated(v, F, **more):
    """What is found in torques at speeds that are said to be steady."""
    return identify({"v_rad_per_s": v, "torque_N_m": F, **more}, kind="friction-speed")


def codes(found):
    return {one.code for one in (*found.findings, *found.check)}


def holds(found, *symbols, **departures):
    """Intervals hold the truth, and further numbers lie within four standard errors of theirs."""
    for symbol in symbols:
        low, high = found.intervals[symbol]
        assert low < TRUE[symbol] < high
    of = found.answer.merit
    for key, true in departures.items():
        name, _, unit = key.partition("_in_")
        assert abs(of[f"{name}_{unit}"] - true) < 4.0 * of[f"{name}_standard_error_{unit}"]


def test_a_table_is_recognised_and_its_friction_usable(tmp_path):
    found = identify(columns())
    assert found.options["kind"] == "friction-speed"
    holds(found, "F_k", "c", offset_in_N=TRUE["T_0"])
    assert {v.verdict for v in found.verdicts.values()} == {"usable"}
    assert {"offset", "laws of speed", "no K_z"} <= codes(found)
    assert {file.name for file in found.save(tmp_path)} == {*outputs_of("friction-speed")}
    document = found.document()
    fit = document["approaches"][document["answer"]]
    assert fit["T_k_interval_N_m"] == pytest.approx(found.intervals["F_k"])
    assert len(document["speeds"]["torque_of_the_law_N_m"]) == 120


@pytest.mark.parametrize(
    ("head", "by_v", "by_F", "unit"),
    [
        (("speed (rpm)", "torque (mN m)"), math.pi / 30.0, 1e-3, "N m"),
        (("v (m/s)", "F (mN)"), 1.0, 1e-3, "N"),
    ],
)
def test_columns_and_units_of_rotations_and_translations(tmp_path, head, by_v, by_F, unit):
    of = columns(2, *head, by_v, by_F)
    path = tmp_path / "table.csv"
    np.savetxt(
        path, [*zip(*of.values(), strict=True)], "%.9g", ",", header=",".join(of), comments=""
    )
    found = identify(path)
    assert found.coordinate.unit("N") == unit
    for symbol, value in identify(columns(2)).values.items():
        assert found.values[symbol] == pytest.approx(value, rel=1e-6)
    draft = yaml.safe_load(mapping_to_start_from(str(path)))
    assert identify(path, mapping=draft).values == found.values


def test_a_column_of_standard_errors_weights_the_rows():
    v, F = table(4)
    error = np.where(np.arange(v.size) % 2 == 0, NOISE, 30.0 * NOISE)
    F = F + 30.0 * NOISE * np.random.default_rng(5).normal(size=v.size) * (error > NOISE)
    plain, weighted = stated(v, F), stated(v, F, torque_std_N_m=error)
    ratio = plain.standard_errors["F_k"] / weighted.standard_errors["F_k"]
    assert 10.0 < ratio < 30.0  # half of the rows have all of the weight: 30 √½
    holds(weighted, "F_k")
    some = stated(v, F, torque_std_N_m=np.where(v > 0.0, error, 0.0))
    assert "errors not used" in codes(some)
    assert some.values == plain.values


def test_friction_that_falls_with_the_speed_or_is_rounded_at_rest_is_taken_and_said():
    falls, rounded = identify(columns(6, F_S=0.5)), identify(columns(6, v_0=0.03))
    holds(falls, "F_k", v_S_in_m_per_s=0.02)
    assert "(Stribeck) by F_S = 0." in falls.screen()
    assert rounded.answer.name == "rounded"
    holds(rounded, "F_k", "c", v_0_in_m_per_s=0.03)


def test_one_direction_or_one_size_of_speed_leaves_two_of_them_one_number():
    v = np.tile([0.1, -0.1], 6)
    one = stated(v, 1.2 * np.sign(v) + 0.01 * np.random.default_rng(8).normal(size=12))
    assert one.values["F_k"] == pytest.approx(1.2, abs=0.01)
    assert one.verdicts["c"].verdict == "none"
    v, F = (of[:60] for of in table(7))
    found = stated(v, F)
    assert [found.verdicts[s].verdict for s in ("F_k", "c")] == ["none", "usable"]
    (one,) = (one for one in found.findings if one.code == "one direction")
    both, error = one.numbers["sum"]
    assert abs(both - TRUE["F_k"] - TRUE["T_0"]) < 3.0 * error
    assert not found.no_answer
    assert found.sensitivities()[1]["drive_gain_1_percent"] == pytest.approx({"c": 0.01})
    for other in (F - 5.0, -F):  # lifted, and turned
        assert stated(v, other).values["c"] == pytest.approx(found.values["c"], rel=1e-6)


def test_a_reversed_sign_rows_at_rest_and_another_law_are_said():
    v, F = table(9)
    turned = stated(v, -F)
    assert "flipped" in codes(turned)
    assert turned.values["F_k"] == pytest.approx(stated(v, F).values["F_k"], rel=1e-9)
    assert "rows at rest" in codes(stated(np.append(v, 0.0), np.append(F, 5.0)))
    bent = stated(v, F + 0.4 * np.sign(v) * np.sin(40.0 * v) ** 2)
    assert "other law of speed" in codes(bent)
    # and the interval holds what that does
    low, high = bent.intervals["F_k"]
    assert high - low > 0.2


def test_too_few_rows_other_channels_and_samples_in_time_are_refused():
    with pytest.raises(ValueError, match="need 4 at least"):
        identify({"speed_rpm": [1, -1, 2], "torque_N_m": [3, -3, 4]})
    with pytest.raises(ValueError, match="need a velocity and a force"):
        identify_friction_speed({"time_s": np.arange(9) / 9.0, "x_m": np.arange(9) ** 2 / 9.0})
    v = 0.3 * np.sin(np.linspace(0.0, 50.0, 2000))
    sampled = {"v_m_per_s": v, "force_N": np.sign(v) + v}
    with pytest.raises(RecordError, match='give kind="friction-speed"'):
        read_records(sampled)
    found = identify_friction_speed(sampled)
    assert found.values == pytest.approx({"F_k": 1.0, "c": 1.0}, rel=1e-6)


def test_a_known_gain_is_taken_off_and_its_uncertainty_in_the_interval():
    gain = {"channel": "torque_N_m", "gain": 2.0, "gain_uncertainty": 0.1}
    mapping = {"channels": {"torque": gain, "angular_velocity": {"channel": "velocity_rad_per_s"}}}
    found, plain = identify(columns(), mapping=mapping), identify(columns())
    assert found.values["F_k"] == pytest.approx(plain.values["F_k"] / 2.0, rel=1e-9)
    expected = math.hypot(plain.standard_errors["F_k"] / 2.0, 0.05 * found.values["F_k"])
    assert found.standard_errors["F_k"] == pytest.approx(expected, rel=1e-6)
