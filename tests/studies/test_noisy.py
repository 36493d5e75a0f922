"""Studies of noisy records: that a case is one experiment as one would do it, what many of them say together, and the
yardsticks of their errors, the least that is possible and that of Simpson's rule."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from dampbalance import BaseMotion, steady_orbit
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import common_fit
from dampbalance.motion.sliders import spread_contact
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.studies import evaluate
from dampbalance.studies.bound import fit_at_truth
from dampbalance.studies.cases import case_columns, cases_between
from dampbalance.studies.shown import statistics, summary
from dampbalance.studies.shown.statistics import bounds_of
from dampbalance.studies.shown.study_figure import study_figure
from dampbalance.studies.simpson import cycle_integrals, replicates_of
from fit.sampled import covariance, noise_of_rms
from paper_case import FREQUENCIES_HZ, OMEGA, PAPER, motions_at
from studies.documents import document

SMALL = document("noisy")
TRUE = {"F_k": ("F_k_N", PAPER.F_k), "c": ("c_N_s_per_m", PAPER.c)}
DIRECT, X_S = "direct__least_squares", "X_s__fundamental__individual__least_squares"


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
    signals = [[channel.values for channel in record.channels.values()] for record in records]
    of_cycles = [
        cycle_integrals(*pair, 1e-3, reading.steady.omega, PAPER.k)
        for pair, reading in zip(signals, readings, strict=True)
    ]
    *rows, W = np.mean(of_cycles, axis=2).T
    columns = [f"{column}__{label}" for column, _ in TRUE.values()]
    expected = np.linalg.solve(np.transpose(rows), W)
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
    # four standard errors of each, from n runs: σ/√n, σ/√2n, √(0.95 · 0.05/n)
    root = math.sqrt(n)
    assert found.bias == pytest.approx(bias, abs=4.0 * scatter / root)
    assert found.bias_error == pytest.approx(scatter / root, rel=0.05)
    assert found.scatter == pytest.approx(scatter, rel=4.0 / math.sqrt(2.0) / root)
    assert found.rms == pytest.approx(math.hypot(bias, scatter), rel=0.03)
    # of σ² (1 ± 0.2) the rms is known to 0.1/√n
    assert found.standard_error == pytest.approx(scatter, rel=4.0 * 0.1 / root)
    assert found.standard_error_error == pytest.approx(0.1 * scatter / root, rel=0.05)
    assert found.coverage == pytest.approx(0.95, abs=4.0 * math.sqrt(0.95 * 0.05) / root)
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
    of_runs = {"bias": errors.mean(), "scatter": errors.std(), "coverage": covered.mean()}
    for name, expected in of_runs.items():
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
        share = at[f"c_covered__{label}"].mean()
        for name, expected in (("errors", sizes), ("coverage", share)):
            points, _, (bars,) = axes[f"c $\\omega/\\omega_n$ = 0.712 (3.5 Hz) {name}"].containers[
                i
            ]
            assert points.get_ydata() == pytest.approx(100.0 * expected.to_numpy())
            ends = np.array(bars.get_segments())[:, :, 1]
            assert np.all((ends[:, 0] < points.get_ydata()) & (points.get_ydata() < ends[:, 1]))
        bounds = [statistics.share_interval(round(30 * of), 30) for of in share]
        assert ends == pytest.approx(100.0 * np.array(bounds))


# --- a contact that yields gradually: the records are those of several sliders, the fit that of one --

FIT = "fit__F_k+c+K_z__maximum_likelihood"
GRADUAL = {
    "axes": [{"slip_range": {"values": [1, 10]}}],
    "base": {"K_z_over_k": 10.0},
    "levels_m": [0.004, 0.008],
    "route": {**document("noisy")["route"], "noise": 0.001},
    "estimation": {"approaches": ["direct"], "yardsticks": ["K_z"]},
    "figure": None,
}


def test_the_elements_share_stiffness_and_friction():
    r, kappa = spread_contact(PAPER, 30.0)
    assert np.sum(kappa) == pytest.approx(PAPER.K_z, rel=1e-14)
    assert kappa @ r == pytest.approx(PAPER.F_k, rel=1e-14)
    np.testing.assert_allclose(np.diff(np.log(r)), np.log(30.0) / 31.0, rtol=1e-10)


def test_one_slider_is_as_stiff_as_takes_the_same_energy(computed):
    """Its loss 4F_k(X − F_k/K_z) is Σ 4κ_j r_j (X − r_j) for F_k = Σ κ_j r_j and K_z = F_k²/Σ κ_j r_j²."""
    _, table, _ = computed(GRADUAL)
    axes = [{"K_z_over_k": {"values": [10.0]}}]
    _, plain, _ = computed(GRADUAL | {"axes": axes, "base": {}})
    for symbol in ("F_k", "c", "K_z"):
        column = f"{symbol}_relative_error__{FIT}"
        # the records of r_max = r_min differ from those of one slider by rounding: 1e-9 is what a fit makes of that
        assert table[column][0] == pytest.approx(plain[column][0], abs=1e-7)
    r = np.geomspace(1.0, 10.0, 32)
    # of the loss alone; the waveforms have their say, which makes 0.07 at most of K_z/k = 2 to 90 (the study)
    expected = r.mean() ** 2 / np.mean(r**2) - 1.0
    assert table[f"K_z_relative_error__{FIT}"][1] == pytest.approx(expected, abs=0.07)
    assert abs(table[f"F_k_relative_error__{FIT}"][1]) < 0.01


def test_a_contact_that_yields_gradually_has_no_bound_of_one_slider(make):
    run = {"run": {"values": [1, 2]}}
    of_axes = make(GRADUAL | {"axes": [*GRADUAL["axes"], run]})
    of_route = make(GRADUAL | {"axes": [run], "route": GRADUAL["route"] | {"slip_range": 10.0}})
    for study, cases in ((of_axes, [2, 3]), (of_route, [0, 1])):
        assert np.isnan([*bounds_of(study, np.array(cases)).values()]).all()
    assert 0.0 < bounds_of(of_axes, np.array([0, 1]))["F_k"] < 1.0


# --- the bound ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("osc", "hz", "free", "levels"),
    [
        (PAPER, 11.1, ("m",), (0.004, 0.012)),
        (replace(PAPER, K_z=1e8), 4.92, ("m",), (0.004, 0.012)),
        # slips several times a half cycle
        (replace(PAPER, c=3.0, K_z=69_300.0), 1.6, ("m",), (8e-4, 14e-4)),
    ],
)
def test_the_bound_is_that_of_every_sample(osc, hz, free, levels):
    motions, noise = motions_at(hz, levels), {"y": (5e-5, 5e-5), "x": (2e-5, 7e-5)}
    # whole cycles, and enough samples that the onset of slip falls between all kinds of them
    exact = covariance(osc, motions, 200.0 * hz, 40.0, noise, free)
    of_lines = math.sqrt(2.0 / 8000.0) * np.transpose([*noise.values()])  # of 8000 samples
    found = fit_at_truth(osc, motions, of_lines.tolist(), {"m"} - {*free})
    errors = np.sqrt(np.diag(exact))
    kept = errors.size
    units = np.array([1.0, 1.0, -2.0 * osc.K_z**1.5, 1.0])[:kept] / errors  # dK_z/dρ
    # one-sided differences of 1e-6 on this side: that times their curvature, up to some tens
    scaled = found.covariance[:kept, :kept] * np.outer(units, units)
    np.testing.assert_allclose(scaled, exact / np.outer(errors, errors), atol=2e-4)
    stated = found.error("F_k"), found.error("c"), found.K_z_error
    assert stated == pytest.approx(errors[:3], rel=1e-4)
    values = (found.F_k, found.c, found.K_z, found.m)
    assert values == pytest.approx((osc.F_k, osc.c, osc.K_z, osc.m), rel=1e-12)
    assert (found.error("m") > 0.0) == bool(free)
    stuck = replace(osc, F_k=60.0)  # nothing slips
    assert fit_at_truth(stuck, motions, of_lines.tolist()) is None


# --- plain direct integration ---------------------------------------------------------------------


ORBIT = steady_orbit(PAPER, BaseMotion(0.008, OMEGA))


def of_record(rate_hz, cycles=6, **options):
    record = measured_orbit(ORBIT, rate_hz=rate_hz, cycles=cycles, start=0.031, **options)
    signals = [channel.values for channel in record.channels.values()]
    return cycle_integrals(*signals, 1.0 / rate_hz, OMEGA, PAPER.k)


def test_without_noise_the_exact_integrals_are_the_limit_and_errors_of_second_order():
    """a is that of the rigid contact, 4X; b and W are the orbit's. Central differences and the corners of |ẋ| make
    errors of second order."""
    exact = np.array([4.0 * ORBIT.X, ORBIT.b, ORBIT.W])
    coarse, fine = of_record(500.0), of_record(4000.0)
    assert fine.shape == (3, 5)  # the velocity lacks the two samples at the ends
    off, least = (np.abs(of.mean(axis=1) / exact - 1.0) for of in (coarse, fine))
    assert np.all(least < 1e-4)
    assert np.all(off / least > 0.6 * 8.0**2)
    with pytest.raises(ValueError, match="no whole cycle of 203"):
        cycle_integrals(np.ones(150), np.ones(150), 1e-3, OMEGA, PAPER.k)


def test_noise_adds_its_variance_to_the_viscous_integral():
    rate_hz, part, cycles = 1000.0, 0.02, 400
    a, b, W = of_record(rate_hz, cycles, noise=part, seed=1)
    rms = np.linalg.norm(ORBIT.harmonics(3)) / math.sqrt(2.0)
    added = ORBIT.motion.period * (part * rms * rate_hz) ** 2 / 2.0
    assert added > 0.1 * ORBIT.b
    # four standard errors of the mean of the cycles
    for found, expected in ((b, ORBIT.b + added), (W, ORBIT.W)):
        assert abs(found.mean() - expected) < 4.0 * found.std(ddof=1) / math.sqrt(len(found))
    assert a.mean() > 4.0 * ORBIT.X * 1.01
    drawn = replicates_of(np.array([a, b, W]), 4000, np.random.default_rng(2))
    error = np.std([a, b, W], axis=1, ddof=1) / math.sqrt(len(a))
    # 4,000 numbers: their mean is good to 1/63 of the standard deviation, and this to 1.1 %
    off = drawn.mean(axis=1) - np.mean([a, b, W], axis=1)
    assert np.all(np.abs(off) < 4.0 * error / 63.0)
    assert drawn.std(axis=1) == pytest.approx(error, rel=0.05)
