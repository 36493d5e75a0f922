"""What measured loops show without a model, with and without times, against closed forms."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from dampbalance import identify, identify_loops, read_records
from dampbalance.identification.loops import loop_history
from fit.test_loops import F_K, K_Z, SINE, K, T, X, loop, stepped

GROWN = np.repeat([0.4, 0.7, 1.0], 2500) * SINE[:7500]


def written(folder, x, force, head="displacement (mm),force (kN)"):
    """A file of a test machine without times."""
    file = folder / "loops.csv"
    np.savetxt(
        file, np.column_stack([1e3 * x, 1e-3 * force]), delimiter=",", header=head, comments=""
    )
    return file


def numbers_in(value, of=""):
    """Each number of a document with its key."""
    if isinstance(value, dict):
        for key, one in value.items():
            yield from numbers_in(one, key)
    elif isinstance(value, list):
        for one in value:
            yield from numbers_in(one, of)
    elif isinstance(value, float | int) and not isinstance(value, bool):
        yield of, value


def test_levels_have_the_loss_stiffness_damping_and_backbone_of_a_slider_and_a_spring():
    """W = 4F_k(X − Z), k_s = F_k/X + k, ζ_eq = W/(2π k_s X²), a force of F_k + kX at X."""
    force = K_Z * stepped(GROWN, F_K / K_Z) + K * GROWN + 5.0
    levels = identify_loops({"time_s": T[:7500], "displacement_m": GROWN, "force_N": force}).levels
    shown = [level.document(math.nan, math.nan) for level in levels]
    assert [one["cycles"] for one in shown] == [4, 5, 5]  # the first cycle begins at rest
    for part, one in zip((0.4, 0.7, 1.0), shown, strict=True):
        x = part * X
        W, k_s = 4.0 * F_K * (x - F_K / K_Z), F_K / x + K
        true = {"X_m": x, "W_over_4X_N": W / (4.0 * x), "secant_stiffness_N_per_m": k_s}
        true |= {"W_J": W, "equivalent_damping_ratio": W / (2.0 * math.pi * k_s * x**2)}
        true |= {"loss_factor": W / (math.pi * k_s * x**2), "frequency_Hz": 1.0}
        ends = (("largest", 1.0), ("smallest", -1.0))
        true |= {f"{end}_displacement_m": way * x for end, way in ends}
        true |= {f"force_at_{end}_displacement_N": way * (F_K + K * x) + 5.0 for end, way in ends}
        for key, value in true.items():
            assert one[key] == pytest.approx(value, rel=0.012), key


def test_without_times_nothing_has_a_time(tmp_path):
    record = loop(c=0.0)
    timed = identify_loops({"time_s": T, "displacement_m": SINE, "force_N": record.f})
    found = identify(written(tmp_path, SINE, record.f))
    assert found.options["kind"] == "loops"
    for symbol, true in {"F_k": F_K, "K_z": K_Z}.items():
        low, high = found.intervals[symbol]
        assert low < true < high, symbol
        assert found.verdicts[symbol].verdict == "usable"
    assert [one.code for one in found.verdicts["c"].findings] == ["no times"]
    for own, other in zip(found.levels, timed.levels, strict=True):
        assert own.more["equivalent_damping_ratio"] == pytest.approx(
            other.more["equivalent_damping_ratio"], rel=1e-3
        )
    document = json.loads(json.dumps(found.document()))
    of_time = "_s", "Hz", "_W", "s_per_m", "per_s"
    named = [key for key, value in numbers_in(document) if key.endswith(of_time) and value == value]
    assert named == []
    said = found.text() + found.screen() + repr(found.records[0])
    assert not [unit for unit in (" Hz", " s ", "N s/m =", "m/s") if unit in said]
    found.save(tmp_path / "out")


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("swapped", "head"), [(False, ""), (True, ""), (False, "displacement,force")]
)
def test_two_columns_are_asked_for_what_they_lack_and_nothing_else(tmp_path, swapped, head, sign):
    """No head: which of them lies ahead of the other one follows from the sign of the force as well."""
    force = sign * loop(c=0.0).f
    first, second = (force, SINE) if swapped else (SINE, force)
    file = tmp_path / "loops.csv"
    columns = np.column_stack([first, second])
    np.savetxt(file, columns, delimiter=",", header=head, comments="")
    asked = "in which units are" if head else "hold: displacement or force"
    with pytest.raises(ValueError, match=asked) as refused:
        identify(file)
    draft = str(refused.value)
    assert not [word for word in ("sample_rate", "unit: m", "unit: N") if word in draft]
    draft = draft[draft.index("channels:") :].replace("\n  ", "\n")
    for quantity, unit, at in (("displacement", "m", swapped), ("force", "N", not swapped)):
        name = quantity if head else f'"what is column {1 + at}?"'
        (line,) = re.findall(f"^ *{re.escape(name)}: .*", draft, re.MULTILINE)
        known = line.replace(f"{name}:", f"{quantity}:").replace('unit: "?"', f"unit: {unit}")
        draft = draft.replace(line, known)
    (tmp_path / "loops.csv.yaml").write_text(draft)
    assert identify(file).values["F_k"] == pytest.approx(F_K, rel=0.01)


@pytest.mark.parametrize(("drift", "known"), [(0.1, True), (1.5, False)])
def test_a_motion_whose_mean_drifts_by_more_than_its_amplitude_has_none(drift, known):
    x = SINE + drift * X * T  # in a cycle of 1 s
    force = K_Z * stepped(x, F_K / K_Z)
    for level in identify_loops({"time_s": T, "displacement_m": x, "force_N": force}).levels:
        shown = level.document(math.nan, math.nan)
        assert shown["W_J"] > 0.0
        for key in ("X_m", "secant_stiffness_N_per_m", "equivalent_damping_ratio"):
            assert math.isnan(shown[key]) != known


def test_two_columns_that_do_not_go_round_are_no_loop(tmp_path):
    file = tmp_path / "records.csv"
    columns = np.column_stack([SINE, np.sin(5.1 * np.pi * T)])
    np.savetxt(file, columns, delimiter=",")
    with pytest.raises(ValueError, match="what do the columns"):
        identify(file)


def test_times_are_asked_for_where_a_motion_needs_them(tmp_path):
    file = written(tmp_path, SINE, loop().f)
    with pytest.raises(ValueError, match="has no times, which forced records need"):
        identify(file, stiffness=2310.0)
    channels = {
        "displacement": {"channel": 1, "unit": "mm"},
        "force": {"channel": 2, "unit": "kN", "delay": 1e-3},
    }
    with pytest.raises(ValueError, match="'force' needs it: say sample_rate_hz"):
        read_records(file, mapping={"channels": channels})


@pytest.mark.parametrize("cycles", [1, 2, 4])
def test_few_cycles_have_their_levels_and_no_fit(cycles, tmp_path):
    own = slice(0, 500 * cycles + 1)
    force = K_Z * stepped(SINE[own], F_K / K_Z)
    found = identify(written(tmp_path, SINE[own], force), normal_force=20.0)
    assert [one.code for one in found.answer.notes] == ["few loops"]
    assert found.no_answer
    table = loop_history(found)
    assert len(table) == cycles
    # a quarter of the first cycle is that from rest: half of the stick distance less is travelled
    Z, first = F_K / K_Z, table["W_J"][0]
    np.testing.assert_allclose(table["W_J"][1:], 4.0 * F_K * (X - Z), rtol=2e-3)
    assert 0.9 < first / (4.0 * F_K * (X - Z)) < 1.0
    assert table["F_k_N"].isna().all()
    found.save(tmp_path / "out")
    assert len(found.rows) == cycles


def test_noise_is_no_other_shape():
    force = loop(noise=0.08, seed=3).f
    found = identify_loops({"time_s": T, "displacement_m": SINE, "force_N": force})
    assert "other shape" not in [one.code for one in found.findings]
    low, high = found.intervals["F_k"]
    assert low < F_K < high
    assert found.verdicts["F_k"].verdict == "usable"


def rocking(x, F=10.0):
    """A wall that rocks: stiff until it lifts off, at other forces to either side, and a slider of F within it."""
    up, down = np.minimum(1e6 * x, 80.0 + 1e4 * x), np.maximum(1e6 * x, -60.0 + 1e4 * x)
    return np.where(x > 0.0, up, down) + 1e6 * stepped(x, F / 1e6)


def test_a_rocking_wall_has_its_loss_and_no_friction_force_of_a_fit(tmp_path):
    noise = 0.1 * np.random.default_rng(6).normal(size=GROWN.size)
    found = identify(written(tmp_path, GROWN, rocking(GROWN) + noise))
    for level in found.levels:
        true = 10.0 * (1.0 - 10.0 / 1e6 / level.X)
        assert level.more["W_over_4X_N"] == pytest.approx(true, rel=0.02)
    assert found.no_answer
    assert "other shape" in [one.code for one in found.findings]


def test_rest_drift_and_skipped_cycles(tmp_path):
    rest, drift = np.zeros(1100), SINE + 0.05 * X * T
    for x in (np.concatenate([rest, SINE, np.full(900, SINE[-1])]), drift):
        noise = 0.01 * F_K * np.random.default_rng(7).normal(size=x.size)
        file = written(tmp_path, x, K_Z * stepped(x, F_K / K_Z) + noise)
        for skipped in (0, 3):
            found = identify(file, skip_cycles=skipped)
            for symbol, true in {"F_k": F_K, "K_z": K_Z}.items():
                error = found.standard_errors[symbol]
                assert abs(found.values[symbol] - true) < 5.0 * error, symbol
            cycles = loop_history(found)
            assert cycles["cycle"].iloc[0] == 1 + skipped
            np.testing.assert_allclose(cycles["W_J"][1:], 4.0 * F_K * (X - F_K / K_Z), rtol=0.04)
    with pytest.raises(ValueError, match=r"complete cycles, .* and 41 are needed"):
        identify(file, skip_cycles=40)


def test_a_stiffness_that_noise_hides_has_no_limit_below_zero():
    t = np.arange(0.0, 7.0, 1.0 / 60.0)
    x = X * np.sin(2.0 * np.pi * t)
    for seed in (0, 3):  # where value less half an interval is negative
        noise = F_K * np.random.default_rng(seed).normal(size=t.size)
        force = F_K / (0.05 * X) * stepped(x, 0.05 * X) + noise
        found = identify_loops({"time_s": t, "displacement_m": x, "force_N": force})
        assert found.intervals["K_z"].low > 0.0
