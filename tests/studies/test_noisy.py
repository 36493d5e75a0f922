"""Studies of noisy records: that a case is one experiment as one would do it, and what many of them say together."""

from __future__ import annotations

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from dampbalance import steady_orbit
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import common_fit
from dampbalance.motion.sliders import spread_contact
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.studies import evaluate
from dampbalance.studies.cases import case_columns, cases_between
from dampbalance.studies.shown import statistics, summary
from dampbalance.studies.shown.statistics import bounds_of
from dampbalance.studies.shown.study_figure import study_figure
from dampbalance.studies.simpson import cycle_integrals
from fit.sampled import covariance, noise_of_rms
from paper_case import FREQUENCIES_HZ, PAPER, motions_at
from studies.documents import document

SMALL = document("noisy")
TRUE = {"F_k": ("F_k_N", PAPER.F_k), "c": ("c_N_s_per_m", PAPER.c)}
DIRECT, X_S = "direct__least_squares", "X_s__fundamental__individual__least_squares"


def integrals_of(record, omega):
    """a, b and W of each cycle by Simpson's rule."""
    y, x = (record[q].values for q in ("base_displacement", "displacement"))
    return cycle_integrals(y, x, 1e-3, omega, PAPER.k)


def test_a_case_is_an_experiment_as_one_would_do_it_and_yardsticks_change_nothing(computed, make):
    (_, table, _), case = computed("noisy"), 7  # 3.5 Hz, 0.1 %, run 2
    more = make(SMALL | {"estimation": SMALL["estimation"] | {"yardsticks": ["simpson", "fit"]}})
    with_them = evaluate.evaluate(more, case, case + 1)
    before = table.iloc[[case]].reset_index(drop=True)
    pd.testing.assert_frame_equal(with_them[before.columns], before, check_exact=True)
    found, records = with_them.iloc[0], []
    assert found[["frequency_hz", "noise", "run"]].tolist() == [3.5, 0.001, 2]
    for level, motion in enumerate(motions_at(3.5, (0.004, 0.012))):
        random = np.random.default_rng([7, case, level])
        taken = {"rate_hz": 1000, "cycles": 20, "noise": 0.001, "start": random.random() / 3.5}
        records.append(measured_orbit(steady_orbit(PAPER, motion), seed=random, **taken))
    readings = [read_features(record, PAPER.k) for record in records]
    balance = identify_readings(readings, PAPER.k).estimates["direct"].coefficients
    answer = common_fit([one.lines for one in readings], PAPER.k, departures=False).answer
    for symbol, (column, true) in TRUE.items():
        value, low = balance[symbol].value, answer.intervals[symbol][0]
        # the same records, rows and solver: sin and cos of longer arrays may round otherwise, no more
        assert found[f"{column}__{DIRECT}"] == pytest.approx(value, rel=1e-11)
        stated = true * found[f"{symbol}_relative_standard_error__{DIRECT}"]
        # 25 replicates know a standard error to 14 %: three of these
        assert stated == pytest.approx(balance[symbol].standard_error, rel=0.45)
        assert found[f"{symbol}_covered__{DIRECT}"] == float(abs(value - true) <= 1.96 * stated)
        fit = f"{symbol}_{{}}__fit__maximum_likelihood".format
        of_fit = true * (1.0 + found[fit("relative_error")])
        assert of_fit == pytest.approx(answer.values[symbol], rel=1e-11)
        error = true * found[fit("relative_standard_error")]
        assert error == pytest.approx(answer.standard_errors[symbol], rel=1e-9)
        assert found[fit("covered")] == float(low <= true <= answer.intervals[symbol][1])

    # two levels are met exactly by what Simpson's rule makes of their signals
    label = "simpson__rigid__equal__least_squares"
    of_cycles = [integrals_of(m, r.steady.omega) for m, r in zip(records, readings, strict=True)]
    a, b, W = np.mean(of_cycles, axis=2).T
    expected = np.linalg.solve(np.column_stack([a, b]), W)
    columns = [f"{column}__{label}" for column, _ in TRUE.values()]
    assert found[columns].tolist() == pytest.approx(expected, rel=1e-9)


def test_cases_differ_by_number_and_seed_and_not_by_chunk(computed, make):
    study, table, _ = computed("noisy")
    expected = table.iloc[5:8].reset_index(drop=True)
    pd.testing.assert_frame_equal(evaluate.evaluate(study, 5, 8), expected, check_exact=True)
    column = f"F_k_relative_error__{DIRECT}"
    assert table[column].nunique() == len(table)
    other = make(SMALL | {"route": SMALL["route"] | {"seed": 8}})
    assert (study.seeds, other.seeds) == ([7], [8])
    assert evaluate.evaluate(other, 0, 1)[column][0] != table[column][0]


def test_without_noise_the_truth_comes_back(computed):
    axes = [{"frequency_hz": {"values": [*FREQUENCIES_HZ.values()]}}]
    route = SMALL["route"] | {"noise": 0.0, "sampling_hz": 5000}
    changed = document("noisy", axes=axes, route=route, summary_by=None, figure=None)
    changed["estimation"]["contact"] = ["compliant", "rigid"]
    _, table, _ = computed(changed)
    _, exact, _ = computed({key: changed[key] for key in ("axes", "levels_m", "estimation")})
    # Direct integration of the record's harmonics and of the waveform beyond: what is left is the waveform's fit.
    assert table[f"F_k_relative_error__{DIRECT}"].abs().max() < 1e-4
    assert table[f"c_relative_error__{DIRECT}"].abs().max() < 1e-5
    # The Fourier balance: what it leaves out, 0.08 % of F_k for the two levels at 3.5 Hz (tests of balance.py).
    assert table["F_k_relative_error__fourier__least_squares"].abs().max() < 1e-3
    rigid = "F_k_relative_error__direct__rigid__least_squares"
    np.testing.assert_allclose(table[rigid], exact[rigid], atol=1e-4)
    assert (table["regime"] == "one_slip").all()


def test_a_record_that_cannot_be_read_says_so(computed):
    route = SMALL["route"] | {"sampling_hz": 6, "cycles": 3}  # hardly a sample per cycle
    _, table, _ = computed(SMALL | {"route": route})
    assert (table["regime"] == "not_read").all()
    assert table[[f"F_k_relative_error__{DIRECT}", f"F_k_covered__{DIRECT}"]].isna().all(axis=None)


# --- many runs together ----------------------------------------------------------------------------


def test_the_spread_of_known_errors():
    rng = np.random.default_rng(3)
    n, bias, scatter = 20_000, 0.02, 0.05
    errors = bias + scatter * rng.standard_normal(n)
    stated = scatter * np.sqrt(1.0 + 0.2 * rng.standard_normal(n).clip(-4.0, 4.0))
    covered = (np.abs(errors - bias) <= 1.959964 * scatter).astype(float)
    errors[::100], stated[::100], covered[::100] = np.nan, np.nan, np.nan
    found = SimpleNamespace(**statistics.spread(errors, stated, covered))
    assert (found.runs, found.identified) == (n, n - n // 100)
    # Four standard errors of each, from n runs: σ/√n, σ/√2n, √(0.95 · 0.05/n).
    assert found.bias == pytest.approx(bias, abs=4.0 * scatter / math.sqrt(n))
    assert found.bias_error == pytest.approx(scatter / math.sqrt(n), rel=0.05)
    assert found.scatter == pytest.approx(scatter, rel=4.0 / math.sqrt(2.0 * n))
    assert found.rms == pytest.approx(math.hypot(bias, scatter), rel=0.03)
    # of σ² (1 ± 0.2) the rms is known to 0.1/√n
    assert found.standard_error == pytest.approx(scatter, rel=4.0 * 0.1 / math.sqrt(n))
    assert found.standard_error_error == pytest.approx(0.1 * scatter / math.sqrt(n), rel=0.05)
    assert found.coverage == pytest.approx(0.95, abs=4.0 * math.sqrt(0.95 * 0.05 / n))
    assert found.coverage_low < found.coverage < found.coverage_high
    sizes = np.sort(np.abs(errors[np.isfinite(errors)]))
    half, most = (math.ceil(share * len(sizes)) - 1 for share in (0.5, 0.95))
    assert (found.median, found.p95) == (sizes[half], sizes[most])
    runs, identified, *others = statistics.spread(np.full(3, np.nan)).values()
    assert (runs, identified) == (3, 0)
    assert np.isnan(others).all()


def test_the_error_of_a_quantile_is_that_of_drawing_again():
    rng = np.random.default_rng(4)
    for n in (50, 200):
        values = np.abs(rng.standard_normal(n))
        again = np.quantile(rng.choice(values, (5000, n)), 0.95, axis=1, method="inverted_cdf")
        # a standard deviation from 5,000 numbers is good to 1 % or, as their tails are light, less
        assert statistics.quantile_error(values, 0.95) == pytest.approx(again.std(), rel=0.04)
    assert math.isnan(statistics.quantile_error(np.arange(19.0), 0.95))  # the largest of them
    assert math.isfinite(statistics.quantile_error(np.arange(20.0), 0.95))


def test_interval_of_a_share():
    # z² = 3.8415: (p + z²/2n ± z √(p(1 − p)/n + z²/4n²)) / (1 + z²/n), by hand
    by_hand = {(95, 100): (0.88825, 0.97846), (10, 10): (0.72247, 1.0), (0, 50): (0.0, 0.07135)}
    for (count, runs), bounds in (by_hand | {(0, 0): (math.nan, math.nan)}).items():
        found = statistics.share_interval(count, runs)
        assert found == pytest.approx(bounds, abs=1e-5, nan_ok=True)


def test_the_summary_separates_the_groups_and_knows_the_least_error(computed, make):
    study, table, path = computed("noisy")
    found, by = summary.summary_of(path, study), ["frequency_hz", "noise"]
    assert len(found) == 4 * 2 * len(study.fits)
    # in the order of the study's axes
    places = [*itertools.product((4.92, 3.5), (0.001, 0.01))]
    assert [*found.groupby(by, sort=False).groups] == places
    of_c = found[(found["quantity"] == "c") & (found["approach"] == "X_s")]
    errors = table.groupby(by, sort=False)[f"c_relative_error__{X_S}"]
    covered = table.groupby(by, sort=False)[f"c_covered__{X_S}"]
    for name, expected in (
        ("bias", errors.mean()),
        ("scatter", errors.std()),
        ("coverage", covered.mean()),
    ):
        assert of_c[f"{name}_percent"].tolist() == pytest.approx((100.0 * expected).tolist())
    # the bound is in proportion to the noise; the information its square over that of the rms error
    bound = found.drop_duplicates([*by, "quantity"])["bound_percent"].to_numpy()
    np.testing.assert_allclose(bound[2:4] / bound[:2], 10.0, rtol=1e-9)
    motions = motions_at(levels=study.levels)
    noise = noise_of_rms(PAPER, motions, 0.001)
    least = np.sqrt(np.diag(covariance(PAPER, motions, 1000.0, 20.0, noise)))[:2]
    # derivatives by differences, and 20 cycles less a 4000th: 1e-4
    np.testing.assert_allclose(bound[:2], 100.0 * least / (PAPER.F_k, PAPER.c), rtol=3e-4)
    used = 100.0 * (found["bound_percent"] / found["rms_percent"]) ** 2
    np.testing.assert_allclose(found["information_percent"], used)
    # none of four groups at once, of no case, nor of records without noise
    every = table["case"].to_numpy()
    for of, cases in ((study, every), (study, every[:0]), (make(document("good")), every[:1])):
        assert np.isnan([*bounds_of(of, cases).values()]).all()


def test_the_figure_shows_95_percent_of_the_errors_and_the_coverage_of_each_line(make, computed):
    """Of 30 invented runs a cell: 95 % lie below the 29th, and so many intervals hold as are said to."""
    changed = document("noisy", columns=["errors", "intervals"])
    changed["axes"][2] = {"run": {"from": 1, "to": 30, "count": 30}}
    lines = {"X_s": {"approach": "X_s"}, "direct": {"approach": "direct"}}
    changed["figure"]["lines"] = lines
    study, rng = make(changed), np.random.default_rng(8)
    known = cases_between(study, 0, study.cases).values | {"regime": "one_slip"}
    names = [column.name for column in case_columns(study)]
    table = pd.DataFrame({name: known.get(name, rng.random(study.cases)) for name in names})
    covered = [name for name in names if "covered" in name]
    table[covered] = table[covered] < 0.8
    figure = study_figure(study, computed(changed, table.astype({"case": int}))[2])
    axes = {axes.get_label(): axes for axes in figure.axes}
    at = table[table["frequency_hz"] == 3.5].groupby("noise")
    for i, label in enumerate((X_S, DIRECT)):
        sizes = at[f"c_relative_error__{label}"].apply(lambda e: np.sort(e)[28])
        points, _, (bars,) = axes["c $f$ = 3.5 Hz errors"].containers[i]
        assert points.get_ydata() == pytest.approx(100.0 * sizes.to_numpy())
        low, high = np.array(bars.get_segments())[:, :, 1].T
        assert np.all((low < points.get_ydata()) & (points.get_ydata() < high))
        share = at[f"c_covered__{label}"].mean().to_numpy()
        points, _, (bars,) = axes["c $f$ = 3.5 Hz coverage"].containers[i]
        assert points.get_ydata() == pytest.approx(100.0 * share)
        bounds = [statistics.share_interval(round(30 * of), 30) for of in share]
        ends = np.array(bars.get_segments())[:, :, 1]
        assert ends == pytest.approx(100.0 * np.array(bounds))


# --- a contact that yields gradually: the records are those of several sliders, the fit that of one --

FIT = "fit__F_k+c+K_z__maximum_likelihood"
GRADUAL = {
    "axes": [{"slip_range": {"values": [1, 10]}}],
    "base": {"K_z_over_k": 10.0},
    "levels_m": [0.004, 0.008],
    "route": {**document("noisy")["route"], "noise": 0.001},
    "estimation": {"approaches": ["direct"], "yardsticks": ["K_z"]},
    "figure": {"kind": "curves", "x": "slip_range"},
}


def test_the_elements_share_stiffness_and_friction():
    r, kappa = spread_contact(PAPER, 30.0)
    assert np.sum(kappa) == pytest.approx(PAPER.K_z, rel=1e-14)
    assert kappa @ r == pytest.approx(PAPER.F_k, rel=1e-14)
    assert r[-1] / r[0] == pytest.approx(30.0, rel=1e-14)
    np.testing.assert_allclose(np.diff(np.log(r)), np.log(30.0) / 31.0, rtol=1e-10)
    np.testing.assert_allclose(spread_contact(PAPER, 1.0)[0], PAPER.Z_m, rtol=1e-14)


def test_one_slider_is_as_stiff_as_takes_the_same_energy(computed):
    """Its loss 4F_k(X − F_k/K_z) is Σ 4κ_j r_j (X − r_j) for F_k = Σ κ_j r_j and K_z = F_k²/Σ κ_j r_j²."""
    study, table, path = computed(GRADUAL)
    axes = [{"K_z_over_k": {"values": [10.0]}}]
    _, plain, _ = computed(GRADUAL | {"axes": axes, "base": {}, "figure": None})
    for symbol in ("F_k", "c", "K_z"):
        column = f"{symbol}_relative_error__{FIT}"
        # the records of r_max = r_min differ from those of one slider by rounding: 1e-9 is what a fit makes of that
        assert table[column][0] == pytest.approx(plain[column][0], abs=1e-7)
    r = np.geomspace(1.0, 10.0, 32)
    # of the loss alone; the waveforms have their say, which makes 0.07 at most of K_z/k = 2 to 90 (the study)
    expected = r.mean() ** 2 / np.mean(r**2) - 1.0
    assert table[f"K_z_relative_error__{FIT}"][1] == pytest.approx(expected, abs=0.07)
    assert abs(table[f"F_k_relative_error__{FIT}"][1]) < 0.01
    panels = [axes.get_ylabel() for axes in study_figure(study, path).axes]
    assert len(panels) == 3  # of F_k, c and K_z
    rows = summary.summary_of(path, study)
    assert rows.groupby("quantity")["approach"].apply(set)["K_z"] == {"fit"}


@pytest.mark.parametrize("ranges", [[1, 10], [10]])
def test_a_contact_that_yields_gradually_has_no_bound_of_one_slider(make, ranges):
    axes = [{"slip_range": {"values": ranges}}, {"run": {"values": [1, 2]}}]
    of_one = GRADUAL | {"axes": axes[1:], "route": {**GRADUAL["route"], "slip_range": 10.0}}
    study = make((GRADUAL | {"axes": axes} if len(ranges) > 1 else of_one) | {"figure": None})
    *one, gradual = (bounds_of(study, np.array([2 * i, 2 * i + 1])) for i in range(len(ranges)))
    assert np.isnan([*gradual.values()]).all()
    assert all(0.0 < of["F_k"] < 1.0 for of in one)
