"""Studies: axes, settings, and that the arrays of a chunk are the numbers of one case at a time."""

from __future__ import annotations

import math
import sys
from dataclasses import asdict, replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from matplotlib import pyplot

from dampbalance import BaseMotion, Oscillator, __version__, steady_orbit, steady_orbits, study
from dampbalance.balance import APPROACHES
from dampbalance.features import Features, of_orbit, stack
from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.project.wording import percent
from dampbalance.replication.clean import of_record
from dampbalance.replication.fixed_step import simulate
from dampbalance.replication.read_out import ReadOut
from dampbalance.solver import least_squares, pair, solve
from dampbalance.studies import case_files, cases, evaluate, reading_study
from dampbalance.studies.parameters import in_si
from dampbalance.studies.shown import paragraph, summary
from dampbalance.studies.shown.statistics import Sizes
from dampbalance.studies.study_file import (
    PAPER_CASE,
    Listed,
    Range,
    Sampled,
    case_values,
    paper_defaults,
    spread_values,
)
from folders import PAPER_FILE, ROOT
from paper_case import FREQUENCIES_HZ, LEVELS, OMEGA, PAPER, features_at, orbits_at
from studies.documents import document

FIRST = "reversal__individual__least_squares"

# The estimates come from the same rows by the same solver, but sin and cos of longer arrays may round otherwise: a
# condition number of up to 1000 for levels as close as these, times rounding.
SOLVER = 1e-12

SOBOL = document("sobol")


# --- the numbers -----------------------------------------------------------------------------------


def test_a_chunk_is_its_cases_one_at_a_time(computed):
    (made, table, _), compared = computed("sobol"), 0
    for _, row in table[::2].iterrows():
        osc = Oscillator(*row[["m_kg", "c_N_s_per_m", "k_N_per_m", "K_z_N_per_m", "F_k_N"]])
        motions = [BaseMotion(Y * row["Y_m"], row["omega_rad_per_s"]) for Y in made.levels]
        features = stack([of_orbit(steady_orbit(osc, motion)) for motion in motions])
        words = row["regime"].split(", ")
        stuck = [regime.startswith("no slip") for regime in features.regime]
        assert [word == "no_slip" for word in words * (3 // len(words))] == stuck
        for fit in made.fits:
            seen = features.with_phase(fit.phase) if fit.phase else features
            seen = seen.with_common("phi", "t_s") if fit.sharing == "common" else seen
            rows = APPROACHES[fit.approach](seen, osc.k)
            expected = solve(rows if fit.levels is None else rows[[0, 2]]).values
            for symbol, column in (("F_k", "F_k_N"), ("c", "c_N_s_per_m")):
                found, true = row[f"{column}__{fit.label}"], row[column]
                within = {"rel": SOLVER, "abs": SOLVER * true, "nan_ok": True}
                assert found == pytest.approx(float(expected[symbol]), **within)
                error = row[f"{symbol}_relative_error__{fit.label}"]
                assert error == pytest.approx(found / true - 1.0, abs=1e-15, nan_ok=True)
                compared += math.isfinite(found)
    assert compared > 1000
    assert len(set(table["regime"])) > 2  # levels that slip, and levels that do not


def test_read_out_rules_are_applied_case_by_case(computed):
    axes = [{"X_decimals": {"values": [5, 6]}, "X_s_decimals": {"values": [6, 5]}}]
    given = {"phi_decimals": 3, "common_t_s_decimals": 4}
    changed = {"axes": axes, "levels_m": [0.004, 0.008, 0.012], "read_out": given}
    changed |= {"estimation": {"sharing": ["individual", "common"]}}
    _, table, _ = computed(changed | {"columns": ["errors", "estimates"]})
    features = features_at(levels=(0.004, 0.008, 0.012))
    for case, (X, X_s) in enumerate([(5, 6), (6, 5)]):
        rules = ReadOut(X_decimals=X, X_s_decimals=X_s, **given)
        for sharing, rule in (("individual", rules.apply), ("common", rules.common)):
            expected = least_squares(APPROACHES["t_s"](rule(features), PAPER.k))
            label = f"t_s__reversal__{sharing}__least_squares"
            assert table[f"F_k_N__{label}"][case] == pytest.approx(expected["F_k"], rel=SOLVER)


def test_a_fixed_step_route_reads_its_records_as_one_would(computed):
    axes, levels = [{"scheme": {"values": ["backward-euler", "rk4"]}}], [0.006, 0.012]
    route = {"kind": "fixed_step", "steps_per_cycle": 8000, "cycles": 5}
    columns = ["errors", "estimates"]
    given = {"axes": axes, "levels_m": levels, "route": route, "columns": columns}
    _, table, _ = computed(given)
    omega, h = OMEGA, 2.0 * math.pi / OMEGA / 8000
    taken = {"step": h, "cycles": 5, "keep_cycles": 3}
    records = [simulate(PAPER, BaseMotion(Y, omega), **taken) for Y in levels]
    seen = stack([of_record(record, omega, PAPER.k) for record in records])
    expected = pair(APPROACHES["direct"](seen, PAPER.k), 0, 1)["c"]
    assert table["c_N_s_per_m__direct__least_squares"][0] == pytest.approx(expected, rel=SOLVER)
    # Backward Euler damps, c + m ω² h; Runge–Kutta 4 does not.
    bias = PAPER.m * omega**2 * h
    errors = table["c_relative_error__direct__least_squares"] * PAPER.c
    assert errors[0] == pytest.approx(bias, rel=0.02)  # the next order in ωh, and the events
    assert abs(errors[1]) < 0.02 * bias


def test_a_step_too_coarse_is_a_regime_not_an_error(computed):
    axes = [{"step_s": {"values": [2.0e-5, 2.0e-3, 1.0]}}]
    route = {"kind": "fixed_step", "scheme": "rk4", "cycles": 4}
    _, table, _ = computed({"axes": axes, "levels_m": [0.004, 0.012], "route": route})
    assert table["regime"].tolist() == ["one_slip", "step_too_coarse", "step_too_coarse"]
    missing = table[f"F_k_relative_error__X_s__{FIRST}"].isna()
    assert missing.tolist() == [False, True, True]


def test_a_sampled_route_tends_to_the_exact_one(computed):
    common = {"levels_m": [0.004, 0.012], "columns": ["errors", "estimates"]}
    axes = {"axes": [{"sampling_hz": {"values": [5000.0, 40000.0]}}], "route": {"kind": "sampled"}}
    _, sampled, _ = computed(common | axes)
    _, exact, _ = computed(common | {"axes": [{"m_kg": {"values": [2.42]}}]})
    column = f"F_k_N__t_s__{FIRST}"
    off = np.abs(sampled[column] / exact[column][0] - 1.0)
    assert off[1] < 0.2 * off[0]
    assert off[1] < 1e-4  # 12 samples and more in a stick phase, continued by cubics


# --- axes ------------------------------------------------------------------------------------------


def test_blocks_are_multiplied_and_the_last_runs_fastest():
    blocks = [Listed({"zeta": [0.1, 0.2]}), Listed({"m_kg": [1, 2, 3], "k_N_per_m": [4, 5, 6]})]
    values = np.transpose([*case_values(blocks, 1, 5).values()])
    assert values.tolist() == [[0.1, 2, 5], [0.1, 3, 6], [0.2, 1, 4], [0.2, 2, 5]]


@pytest.mark.parametrize("method", ["sobol", "random"])
def test_any_stretch_of_a_sample_is_part_of_the_whole(method):
    box = {"zeta": Range(0.01, 1.0, "log"), "Y_m": Range(1, 2, "linear")}
    whole = case_values([Sampled(box, method, 100, 7)], 0, 100)
    for start, stop in ((0, 33), (33, 100)):
        part = case_values([Sampled(box, method, 100, 7)], start, stop)
        assert all(np.array_equal(part[name], whole[name][start:stop]) for name in whole)
    # spread evenly, that is in the logarithm: the mean of 100 points is within 3 standard errors, 3·0.289/10
    for share in (np.log(whole["zeta"] / 0.01) / math.log(100.0), whole["Y_m"] - 1.0):
        assert 0.0 <= share.min() < 0.1 < 0.9 < share.max() <= 1.0
        assert abs(share.mean() - 0.5) < 0.09
    other = case_values([Sampled(box, method, 100, 8)], 0, 100)
    assert not np.array_equal(other["zeta"], whole["zeta"])


def test_ranges_hold_both_ends_and_dimensionless_groups_are_what_they_say():
    decades = {"from": 1.0, "to": 100.0, "count": 3, "spacing": "log"}
    assert spread_values({"from": 1.0, "to": 3.0, "count": 3}) == [1.0, 2.0, 3.0]
    assert spread_values(decades) == pytest.approx([1.0, 10.0, 100.0], rel=1e-15)
    given = {"m_kg": 2.0, "k_N_per_m": 50.0, "Y_m": 0.1, "zeta": 0.3, "K_z_over_k": 4.0}
    given |= {"F_k_over_kY": 0.2, "omega_over_omega_n": 3.0}
    si = in_si({name: np.array([value]) for name, value in given.items()})
    expected = [2.0 * 0.3 * 10.0, 200.0, 1.0, 15.0]
    found = [si[name][0] for name in ("c", "K_z", "F_k", "omega")]
    assert found == pytest.approx(expected, rel=1e-15)


# --- settings, sizes and files ---------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted((ROOT / "config/studies").glob("*.yaml")))
def test_shipped_studies_are_in_order(path):
    made = reading_study.read_study(path)
    assert made.figure
    assert paragraph.template_of(made)


def test_the_stated_size_is_an_upper_bound_and_not_far_off(computed, tmp_path):
    changed = document("sobol")
    changed["axes"][0]["sample"]["count"] = 3000
    made, _, path = computed(changed)
    size = cases.size_of(made)
    assert str(size).startswith("3,000 cases × 3 levels = 9,000 responses, 1 chunk, up to ")
    assert 0.6 * size.table_bytes < path.stat().st_size < size.table_bytes
    for few, refusal in ((10**11, "cases would take .* PB"), (1000, "at least 5,000,000,000")):
        large = size._replace(cases=10**14, table_bytes=10**16, chunks=10**14 // few)
        with pytest.raises(ConfigurationError, match=refusal):
            cases.check_size(replace(made, chunk_cases=few), large, tmp_path / "no", "test.yaml")


def test_chunks_of_any_size_and_threads_cover_every_case_once_and_join_to_the_same_table(
    make, computed, tmp_path
):
    made, chunks, file = make(SOBOL | {"chunk_cases": 15}), [], tmp_path / "cases.parquet"
    for i in range(cases.size_of(made).chunks):
        chunks.append(tmp_path / f"{i}.parquet")
        frame = evaluate.evaluate(made, *cases.chunk_bounds(made, i), threads=1)
        case_files.write_parts(chunks[-1], [frame], made, __version__)
    case_files.join_chunks(file, chunks, made)
    joined, whole = pd.read_parquet(file), computed("sobol")[1]
    joined["regime"] = joined["regime"].astype(whole["regime"].dtype)
    pd.testing.assert_frame_equal(joined, whole, check_exact=True)
    assert pq.read_schema(file).field("K_z_N_per_m").metadata[b"unit"] == b"N/m"
    assert pq.ParquetFile(file).num_row_groups == 3


# --- what is shown ---------------------------------------------------------------------------------


def test_the_summary_counts_what_is_there(computed):
    made, frame, path = computed("sobol")
    table = summary.summary_of(path, made)
    assert len(table) == 2 * len(made.fits)
    by = ["quantity", "approach", "phase", "sharing", "fit"]
    line = table.set_index(by).loc[("c", "X_s", "reversal", "individual", "least_squares")]
    error = frame[f"c_relative_error__X_s__{FIRST}"].abs()
    assert line["identified"] == error.notna().sum() < 40
    assert line["max_error_percent"] == pytest.approx(100.0 * error.max(), rel=1e-15)
    assert line["within_1_percent_share"] == (error <= 0.01).sum() / 40
    page = summary.summary_markdown(made, table, "", "")
    assert f"| {percent(error.max())} | {percent((error <= 0.01).sum() / 40)} |" in page


def test_sizes_are_counted_as_if_all_were_there():
    rng = np.random.default_rng(5)
    errors = 10.0 ** rng.uniform(-13.0, 2.0, 5000) * rng.choice([-1.0, 1.0], 5000)
    errors[::7] = np.nan
    sizes = Sizes(errors, 0.01)
    known = np.abs(errors[np.isfinite(errors)])
    found = sizes.cases, sizes.known, sizes.share, sizes.smallest, sizes.largest
    within = np.count_nonzero(known <= 0.01) / 5000
    assert found == (5000, known.size, within, known.min(), known.max())
    for share in (0.0, 0.5, 0.95, 1.0):
        true = np.quantile(known, share, method="inverted_cdf")
        assert sizes.quantile(share) == pytest.approx(true, rel=6e-4)  # half a bin
    assert math.isnan(Sizes(errors[:1], 0.01).quantile(0.5))


# --- a rigid contact: the limit X_s → −X of every approach, whose costs follow in closed form -----


@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
@pytest.mark.parametrize(("fit", "levels"), [("least_squares", range(5)), ("pair_2_5", (1, 4))])
def test_the_cost_in_closed_form(computed, hertz, fit, levels):
    """W = A′p − 4Z_m F_k with A′ of the rigid model: p′ = p − 4Z_m F_k (A′ᵀA′)⁻¹A′ᵀ1."""
    table = computed("rigid")[1].set_index("frequency_hz")
    orbits = [orbits_at(hertz, LEVELS)[i] for i in levels]
    rows = np.array([[orbit.a + 4.0 * PAPER.Z_m, orbit.b] for orbit in orbits])
    # columns of one size: the solution then keeps nine digits
    shift = np.linalg.lstsq(rows / rows[0], np.full(len(rows), -4.0 * PAPER.Z_m * PAPER.F_k))[0]
    shift /= rows[0] * (PAPER.F_k, PAPER.c)
    assert shift[0] < 0.0 < shift[1]
    for symbol, expected in zip(("F_k", "c"), shift, strict=True):
        found = table[f"{symbol}_relative_error__direct__rigid__{fit}"][hertz]
        assert found == pytest.approx(expected, abs=1e-9)
        # with a rigid contact t_s, V_s and X_s see the same onset
        of_onset = f"{symbol}_relative_error__{{}}__{{}}reversal__individual__{fit}".format
        X_s, t_s, V_s = (table[of_onset(name, "rigid__")][hertz] for name in ("X_s", "t_s", "V_s"))
        assert (t_s, V_s) == pytest.approx((X_s, X_s), rel=1e-9)
        assert abs(table[of_onset("X_s", "")][hertz] - X_s) > 1e-6


# --- studies from Python ---------------------------------------------------------------------------


def test_its_numbers_are_those_of_a_file_and_names_and_arrays_stand_for_lists(computed):
    assert paper_defaults(read_yaml(PAPER_FILE)) == PAPER_CASE
    changed = document("curves", figure=None, columns=["errors"])
    changed["estimation"] |= {"terms": [["F_k", "c"]]}
    axes = {"frequency_hz": np.array([3.5, 4.92])} | changed["axes"][1]
    estimation = {"approaches": "direct,X_s", "sharing": "individual,common", "terms": "F_k,c"}
    short = study(axes, base=PAPER, estimation=estimation, columns="errors")
    pd.testing.assert_frame_equal(short.to_frame(), computed(changed)[1])


def test_what_no_study_can_be_is_refused():
    with pytest.raises(ConfigurationError, match=r"^study\(\): axes\.zetta: unknown key \(did you"):
        study({"zetta": [0.1]})
    long = {"from": 0.1, "to": 0.5, "count": 10_000}
    with pytest.raises(ConfigurationError, match=r"^study\(\): axes: 100,000,000 cases with"):
        study({"zeta": long, "F_k_N": long})


def test_the_responses_are_those_that_the_errors_come_from_which_are_shown_first():
    studied = study({"frequency_hz": [3.5, 11.1]}, levels_m=[0.004, 0.008], route="exact")
    responses, omega = studied.responses, 2.0 * np.pi * np.array([[3.5], [11.1]])
    orbits = steady_orbits(**asdict(PAPER), Y=[0.004, 0.008], omega=omega)
    np.testing.assert_array_equal(responses["X_m"], orbits.X.ravel())
    assert responses["level"].tolist() == [1, 2, 1, 2]
    assert responses["frequency_hz"].tolist() == [3.5, 3.5, 11.1, 11.1]
    errors = studied.to_frame()[f"F_k_relative_error__X_s__{FIRST}"]
    for case, of_case in responses.groupby("case"):
        fit = solve(APPROACHES["X_s"](Features.from_frame(of_case), PAPER.k))
        assert fit["F_k"] / PAPER.F_k - 1.0 == pytest.approx(errors[case], rel=1e-12)
    shown, sizes = studied.summary.loc[f"X_s__{FIRST}"], errors.abs()
    expected = [sizes.max(), sizes.median(), 1.0]
    assert shown[["F_k largest", "F_k median", "identified"]].tolist() == expected
    assert f"{sizes.max():.3g}" in repr(studied)


def test_its_plot_draws_the_errors_in_given_axes():
    f_n = np.linspace(3.5, 11.1, 30)
    studied = study({"frequency_hz": f_n}, estimation={"approaches": "X_s"})
    own = pyplot.figure().add_subplot()
    assert studied.plot("curves", ax=own) is own
    line = max(own.lines, key=lambda one: len(one.get_xdata()))
    errors = studied.to_frame()[f"F_k_relative_error__X_s__{FIRST}"]
    np.testing.assert_allclose(line.get_ydata(), 100.0 * errors.abs())
    with pytest.raises(ValueError, match="no figure of the kind map suits"):
        studied.plot("map")
    pyplot.close("all")


def test_a_data_set_has_a_dimension_for_each_axis(monkeypatch):
    paired = {"zeta": [0.1, 0.2, 0.3], "K_z_over_k": [10.0, 20.0, 30.0]}
    estimation = {"approaches": "direct,X_s"}
    studied = study([paired, {"frequency_hz": [3.5, 11.1]}], estimation=estimation)
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ValueError, match="needs the package xarray: install it, or use to_frame"):
        studied.to_xarray()
    # what it would be made from: the package is not among those that are locked
    fake = SimpleNamespace(Dataset=lambda data, coords: (data, coords))
    monkeypatch.setitem(sys.modules, "xarray", fake)
    data, coords = studied.to_xarray()
    assert coords["K_z_over_k"][0] == coords["zeta"][0] == "zeta"
    dims, errors, about = data["F_k_relative_error"]
    assert (dims, about["units"]) == (("zeta", "frequency_hz", "fit"), "1")
    column = studied.to_frame()[f"F_k_relative_error__X_s__{FIRST}"].to_numpy()
    found = errors[..., coords["fit"].index(f"X_s__{FIRST}")]
    np.testing.assert_array_equal(found.ravel(), column)
    assert data["X_m"][0] == ("zeta", "frequency_hz", "level")
    np.testing.assert_array_equal(data["X_m"][1].ravel(), studied.responses["X_m"])
