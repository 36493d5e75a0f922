"""Studies of noisy records: that a case is one experiment as one would do it, and what many of them say together."""

from __future__ import annotations

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from dampbalance import steady_orbit
from dampbalance.balance import Rows
from dampbalance.fit.waveforms import WaveformFit
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import common_fit
from dampbalance.project.wording import percent
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.solver import least_squares
from dampbalance.studies import evaluate
from dampbalance.studies.cases import case_columns, cases_between
from dampbalance.studies.shown import statistics, summary
from dampbalance.studies.shown.statistics import bounds_of
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from dampbalance.studies.simpson import cycle_integrals
from fit.sampled import covariance, noise_of_rms
from paper_case import FREQUENCIES_HZ, PAPER, motions_at
from studies.documents import document

SMALL = document("noisy")
TRUE = {"F_k": ("F_k_N", PAPER.F_k), "c": ("c_N_s_per_m", PAPER.c)}
DIRECT, X_S = "direct__least_squares", "X_s__fundamental__individual__least_squares"


def experiment(case):
    """The records of a case at 3.5 Hz with 0.1 % of noise, as one would take them, and what is read off them."""
    for level, motion in enumerate(motions_at(3.5, (0.004, 0.012))):
        random = np.random.default_rng([7, case, level])
        taken = {"rate_hz": 1000, "cycles": 20, "noise": 0.001, "start": random.random() / 3.5}
        measurement = measured_orbit(steady_orbit(PAPER, motion), seed=random, **taken)
        yield measurement, read_features(measurement, PAPER.k)


def test_a_case_is_an_experiment_as_one_would_do_it(computed):
    _, table, _ = computed("noisy")
    case = 7  # 3.5 Hz, 0.1 %, run 2
    assert table.loc[case, ["frequency_hz", "noise", "run"]].tolist() == [3.5, 0.001, 2]
    readings = [reading for _, reading in experiment(case)]
    # what `identify` makes of them, whose errors are those of the jackknife
    expected = identify_readings(readings, PAPER.k).estimates
    found = table.loc[case]
    for label in (DIRECT,):
        for name, (column, true) in TRUE.items():
            parameter = expected[label.partition("__")[0]].coefficients[name]
            # The same records, rows and solver: sin and cos of longer arrays may round otherwise, no more.
            assert found[f"{column}__{label}"] == pytest.approx(parameter.value, rel=1e-11)
            stated = true * found[f"{name}_relative_standard_error__{label}"]
            # 25 replicates know a standard error to 14 %: three of these
            assert stated == pytest.approx(parameter.standard_error, rel=0.45)
            held = abs(found[f"{column}__{label}"] - true) <= 1.959964 * stated
            assert found[f"{name}_covered__{label}"] == float(held)


def test_departures_that_no_column_shows_are_not_tested(make, monkeypatch):
    """They would take a quarter of the time of a study of noisy records."""
    more = make(SMALL | {"estimation": SMALL["estimation"] | {"yardsticks": ["fit", "K_z"]}})
    monkeypatch.delattr(WaveformFit, "departures")
    table = evaluate.evaluate(more, 7, 8)
    assert np.isfinite(table["F_k_relative_standard_error__fit__maximum_likelihood"]).all()


def test_yardsticks_are_added_and_change_nothing_else(computed, make):
    (study, table, _), case = computed("noisy"), 7
    more = make(SMALL | {"estimation": SMALL["estimation"] | {"yardsticks": ["simpson", "fit"]}})
    with_them = evaluate.evaluate(more, case, case + 1)
    before = table.iloc[[case]].reset_index(drop=True)
    pd.testing.assert_frame_equal(with_them[before.columns], before, check_exact=True)
    simpson, fit = (of.label for of in more.fits if of not in study.fits)
    assert (simpson, fit) == ("simpson__rigid__equal__least_squares", "fit__maximum_likelihood")
    found, records = with_them.iloc[0], list(experiment(case))

    # the fit is that of `identify` to the same records, before departures are weighed
    answer = common_fit([reading.lines for _, reading in records], PAPER.k, departures=False).answer
    for symbol, (column, true) in TRUE.items():
        value, error = answer.values[symbol], answer.standard_errors[symbol]
        assert found[f"{column}__{fit}"] == pytest.approx(value, rel=1e-11)
        stated = found[f"{symbol}_relative_standard_error__{fit}"]
        assert stated == pytest.approx(error / true, rel=1e-9)
        low, high = answer.intervals[symbol]
        assert found[f"{symbol}_covered__{fit}"] == float(low <= true <= high)

    # Two levels are met exactly by what Simpson's rule makes of their signals; its replicates are other drawings.
    of_cycles = [
        cycle_integrals(m["base_displacement"].values, m["displacement"].values, 1e-3, r.steady.omega, PAPER.k)
        for m, r in records
    ]  # fmt: skip
    a, b, W = np.mean(of_cycles, axis=2).T
    columns = [f"{column}__{simpson}" for column, _ in TRUE.values()]
    expected = np.linalg.solve(np.column_stack([a, b]), W)
    assert found[columns].tolist() == pytest.approx(expected, rel=1e-9)
    rng = np.random.default_rng(1)
    means = [np.array(rows)[:, rng.integers(0, 19, (19, 4000))].mean(axis=1) for rows in of_cycles]
    (a1, b1, W1), (a2, b2, W2) = means
    drawn = (W1 * b2 - W2 * b1) / (a1 * b2 - a2 * b1)
    # stretched by √(19/18); 25 replicates know a standard error to 14 %: three of these
    stated = PAPER.F_k * found[f"F_k_relative_standard_error__{simpson}"]
    assert stated == pytest.approx(drawn.std() * math.sqrt(19.0 / 18.0), rel=0.45)


def test_a_case_does_not_depend_on_its_chunk(computed):
    study, table, _ = computed("noisy")
    expected = table.iloc[5:8].reset_index(drop=True)
    pd.testing.assert_frame_equal(evaluate.evaluate(study, 5, 8), expected, check_exact=True)


def test_runs_differ_and_seeds_too(computed, make):
    _, table, _ = computed("noisy")
    column = f"F_k_relative_error__{DIRECT}"
    assert table[column].nunique() == len(table)
    other = make(SMALL | {"route": SMALL["route"] | {"seed": 8}})
    assert other.seeds == [8]
    assert evaluate.evaluate(other, 0, 1)[column][0] != table[column][0]


def test_without_noise_the_truth_comes_back(computed):
    axes = [{"frequency_hz": {"values": [*FREQUENCIES_HZ.values()]}}]
    route = SMALL["route"] | {"noise": 0.0, "sampling_hz": 5000}
    changed = document("noisy", axes=axes, route=route, summary_by=None, figure=None)
    _, table, _ = computed(changed)
    # Direct integration of the record's harmonics and of the waveform beyond: what is left is the waveform's fit.
    assert table[f"F_k_relative_error__{DIRECT}"].abs().max() < 1e-4
    assert table[f"c_relative_error__{DIRECT}"].abs().max() < 1e-5
    # The Fourier balance: what it leaves out, 0.08 % of F_k for the two levels at 3.5 Hz (tests of balance.py).
    assert table["F_k_relative_error__fourier__least_squares"].abs().max() < 1e-3
    assert (table["regime"] == "one_slip").all()


def test_a_record_that_cannot_be_read_says_so(computed):
    route = SMALL["route"] | {"sampling_hz": 6, "cycles": 3}  # hardly a sample per cycle
    _, table, _ = computed(SMALL | {"route": route})
    assert table["regime"][0] == "not_read"
    assert math.isnan(table[f"F_k_relative_error__{DIRECT}"][0])
    assert math.isnan(table[f"F_k_covered__{DIRECT}"][0])


# --- many runs together ----------------------------------------------------------------------------


def test_the_spread_of_known_errors():
    rng = np.random.default_rng(3)
    n, bias, scatter = 20_000, 0.02, 0.05
    errors = bias + scatter * rng.standard_normal(n)
    stated = np.full(n, scatter)
    covered = (np.abs(errors - bias) <= 1.959964 * stated).astype(float)
    errors[::100], stated[::100], covered[::100] = np.nan, np.nan, np.nan
    found = SimpleNamespace(**statistics.spread(errors, stated, covered))
    assert (found.runs, found.identified) == (n, n - n // 100)
    # Four standard errors of each, from n runs: σ/√n, σ/√2n, √(0.95 · 0.05/n).
    assert found.bias == pytest.approx(bias, abs=4.0 * scatter / math.sqrt(n))
    assert found.bias_error == pytest.approx(scatter / math.sqrt(n), rel=0.05)
    assert found.scatter == pytest.approx(scatter, rel=4.0 / math.sqrt(2.0 * n))
    assert found.rms == pytest.approx(math.hypot(bias, scatter), rel=0.03)
    assert found.standard_error == pytest.approx(scatter, rel=1e-12)
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
        again = np.quantile(rng.choice(values, (20_000, n)), 0.95, axis=1, method="inverted_cdf")
        # a standard deviation from 20,000 numbers is good to 0.5 % or, as their tails are light, less
        assert statistics.quantile_error(values, 0.95) == pytest.approx(again.std(), rel=0.02)
    assert math.isnan(statistics.quantile_error(np.arange(19.0), 0.95))  # the largest of them
    assert math.isfinite(statistics.quantile_error(np.arange(20.0), 0.95))


def test_the_error_of_a_quantile_is_right_on_average():
    """Of n numbers uniform in 0 … 1, x_(k) has the variance k(n − k + 1)/((n + 1)²(n + 2)). From n = 50 the estimate is
    a few per cent too large, and scatters by 40 %."""
    rng, n, k = np.random.default_rng(5), 50, 48
    exact = math.sqrt(k * (n - k + 1) / ((n + 1) ** 2 * (n + 2)))
    found = [statistics.quantile_error(rng.random(n), 0.95) for _ in range(2000)]
    assert np.mean(found) == pytest.approx(exact, rel=0.1)
    assert np.std(found) == pytest.approx(0.4 * exact, rel=0.25)


def test_the_error_of_the_stated_error_is_that_of_their_scatter():
    """σ² of n runs that state σ² (1 ± 0.2): their rms is known to 0.1/√n."""
    rng, n = np.random.default_rng(6), 5000
    stated = 0.03 * np.sqrt(1.0 + 0.2 * rng.standard_normal(n).clip(-4.0, 4.0))
    found = statistics.spread(np.zeros(n), stated)["standard_error_error"]
    assert found == pytest.approx(0.1 * 0.03 / math.sqrt(n), rel=0.05)


def test_equal_weights_are_distinguished(computed):
    axes = {"frequency_hz": [4.92], "noise": [0.01, 0.02], "run": [1]}
    changed = SMALL | {
        "levels_m": [0.004, 0.008, 0.012],  # two levels are met exactly, whatever they weigh
        "axes": [{name: {"values": values}} for name, values in axes.items()],
        "estimation": {"approaches": ["direct"], "weights": ["weighted", "equal"]},
    }
    study, table, _ = computed(changed)
    fits = study.fits_of({"approach": "direct"})
    fits += study.fits_of({"approach": "direct", "weights": "equal"})
    assert [fit.label for fit in fits] == [DIRECT, "direct__equal__least_squares"]
    errors = [float(table[f"F_k_relative_standard_error__{fit.label}"][0]) for fit in fits]
    # 16 % of the information is a standard error 2.5 times as large; 25 replicates know it to 14 %
    assert 1.5 < errors[1] / errors[0] < 4.0


def test_the_summary_separates_the_groups(computed):
    study, table, path = computed("noisy")
    found = summary.summary_of(path, study)
    assert len(found) == 4 * 2 * len(study.fits)
    # in the order of the study's axes
    by = ["frequency_hz", "noise"]
    assert [*found.groupby(by, sort=False).groups] == [
        *itertools.product((4.92, 3.5), (0.001, 0.01))
    ]
    of_c = found[(found["quantity"] == "c") & (found["approach"] == "X_s")]
    errors = table.groupby(by, sort=False)[f"c_relative_error__{X_S}"]
    covered = table.groupby(by, sort=False)[f"c_covered__{X_S}"]
    of_runs = {"bias": errors.mean(), "scatter": errors.std(), "coverage": covered.mean()}
    for name, expected in of_runs.items():
        assert of_c[f"{name}_percent"].to_numpy() == pytest.approx(100.0 * expected.to_numpy())
    # the bound is in proportion to the noise; the information its square over that of the rms error
    bound = found.drop_duplicates(["frequency_hz", "noise", "quantity"])["bound_percent"].to_numpy()
    np.testing.assert_allclose(bound[2:4] / bound[:2], 10.0, rtol=1e-9)
    motions = motions_at(levels=study.levels)
    noise = noise_of_rms(PAPER, motions, 0.001)
    least = np.sqrt(np.diag(covariance(PAPER, motions, 1000.0, 20.0, noise)))[:2]
    # derivatives by differences, and 20 cycles less a 4000th: 1e-4
    np.testing.assert_allclose(bound[:2], 100.0 * least / (PAPER.F_k, PAPER.c), rtol=3e-4)
    used = 100.0 * (found["bound_percent"] / found["rms_percent"]) ** 2
    np.testing.assert_allclose(found["information_percent"], used)
    page = summary.summary_markdown(study, found, "", "")
    assert page.count("## frequency_hz = 3.5, noise = 0.01") == 1
    assert "nan" not in page


def test_no_bound_where_it_would_mean_nothing(computed, make):
    study, table, _ = computed("noisy")
    of_all = study, table["case"].to_numpy()  # four groups at once
    for one, numbers in (of_all, (study, np.arange(0)), (make(document("good")), np.array([0]))):
        assert np.isnan([*bounds_of(one, numbers).values()]).all()


def test_numbers_of_many_runs(computed, says):
    study, table, path = computed("noisy")
    takes = ("bias | signed", "rms | percent", "standard_error | percent")
    takes += ("coverage | percent", "p95 | percent", "bias_error | percent")
    template = '{% set some = errors("F_k", "direct").at(frequency_hz=4.92, noise=0.01) %}'
    template += "; ".join(f"{{{{ some.{take} }}}}" for take in takes)
    cases = table[(table["frequency_hz"] == 4.92) & (table["noise"] == 0.01)]
    errors = cases[f"F_k_relative_error__{DIRECT}"]
    stated = cases[f"F_k_relative_standard_error__{DIRECT}"]
    bias, rms, error, coverage, p95, bias_error = says(study, path, template).split("; ")
    assert bias_error == percent(errors.std(ddof=1) / math.sqrt(3))
    assert bias == ("−" if errors.mean() < 0.0 else "+") + percent(abs(errors.mean()))
    assert rms == percent(math.sqrt((errors**2).mean()))
    assert error == percent(math.sqrt((stated**2).mean()))
    assert coverage == percent(cases[f"F_k_covered__{DIRECT}"].mean())
    assert p95 == percent(errors.abs().max())  # of three runs the largest


@pytest.mark.parametrize("hz", FREQUENCIES_HZ.values())
def test_without_noise_the_plain_rule_errs_as_a_rigid_contact(hz):
    """So that the bias that a rigid model has from exact features is the part of its bias that noise does not make."""
    orbits = [steady_orbit(PAPER, motion) for motion in motions_at(hz)]
    taken = {"rate_hz": 1000, "cycles": 20, "noise": 0.0, "start": 0.3 / hz, "seed": 1}
    records = [measured_orbit(orbit, **taken) for orbit in orbits]
    a, b, W = np.transpose([
        cycle_integrals(m["base_displacement"].values, m["displacement"].values, 1e-3, 2.0 * math.pi * hz, PAPER.k)
        .mean(axis=-1)
        for m in records
    ])  # fmt: skip
    error = 100.0 * (least_squares(Rows({"F_k": a, "c": b}, W))["F_k"] / PAPER.F_k - 1.0)
    # a rigid contact from exact features, derived by independent code; 90 samples a cycle at 11.1 Hz cut corners, which
    # moves it by less than a fiftieth of a per cent
    assert error == pytest.approx({4.92: -0.22, 3.5: -0.18, 11.1: -0.846}[hz], abs=0.02)


def test_the_figure_shows_95_percent_of_the_errors_and_the_coverage_of_each_line(make, computed):
    """Of 30 invented runs a cell: 95 % lie below the 29th, and so many intervals hold as are said to."""
    lines = {"X_s, rigid": {"approach": "X_s", "contact": "rigid"}}
    lines |= {"direct": {"approach": "direct"}, "fit alone": {"approach": "fit"}}
    changed = document("noisy")
    changed["axes"][2] = {"run": {"from": 1, "to": 30, "count": 30}}
    changed["estimation"] |= {"contact": ["compliant", "rigid"], "yardsticks": ["fit"]}
    changed["columns"] = ["errors", "intervals"]
    changed["figure"]["lines"] = lines
    study = make(changed)
    rng, n = np.random.default_rng(8), study.cases
    values = cases_between(study, 0, n).values | {"case": np.arange(n), "regime": "one_slip"}
    table = pd.DataFrame({c.name: values.get(c.name, 0.0) for c in case_columns(study)})
    for name in table:
        if "relative" in name:
            table[name] = rng.standard_normal(n) * table["noise"]
        if "covered" in name:
            table[name] = (rng.random(n) < 0.8).astype(float)
    rigid = X_S.replace("X_s", "X_s__rigid")
    table.loc[table["noise"] == table["noise"].min(), f"c_covered__{rigid}"] = 0.0
    _, _, path = computed(changed, table)

    figure = study_figure(study, path)
    axes = {axes.get_label(): axes for axes in figure.axes}
    places = itertools.product(("F_k", "c"), (4.92, 3.5), ("errors", "coverage"))
    assert list(axes) == ["{} $f$ = {} Hz {}".format(*place) for place in places]
    fits = study.fits_of(study.figure)
    assert [fit.label for fit in fits] == [rigid, DIRECT, "fit__maximum_likelihood"]
    at = table[table["frequency_hz"] == 3.5].groupby("noise")
    drawn = {what: axes[f"c $f$ = 3.5 Hz {what}"].containers for what in ("errors", "coverage")}
    for i, fit in enumerate(fits):
        sizes = at[f"c_relative_error__{fit.label}"].apply(lambda e: np.sort(np.abs(e))[28])
        points, _, (bars,) = drawn["errors"][i]
        assert points.get_ydata() == pytest.approx(100.0 * sizes.to_numpy())
        ends = np.array(bars.get_segments())[:, :, 1]
        assert np.all(ends[:, 0] < points.get_ydata())
        assert np.all(points.get_ydata() < ends[:, 1])
        share = at[f"c_covered__{fit.label}"].mean().to_numpy()
        points, _, (bars,) = drawn["coverage"][i]
        assert points.get_ydata() == pytest.approx(100.0 * share)
        marked = points.get_markevery()  # a share of zero has a tick in place of mark and bar
        assert marked == np.flatnonzero(share).tolist()
        bounds = [statistics.share_interval(round(30 * of), 30) for of in share[marked]]
        ends = np.array([bars.get_segments()[place] for place in marked])[:, :, 1]
        assert ends == pytest.approx(100.0 * np.array(bounds))
        # neighbouring lines stand apart
        assert i == 0 or np.all(points.get_xdata() > drawn["coverage"][i - 1][0].get_xdata() * 1.05)
    ticks = [line for line in axes["c $f$ = 3.5 Hz coverage"].lines if line.get_marker() == "|"]
    assert [line.get_ydata().tolist() for line in ticks] == [[0.0], [], []]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["$X_s$, rigid", "direct", "fit alone"]
    assert "95 % of the errors" in alternative_text(study)


def test_without_intervals_or_lines_the_figure_shows_the_errors_of_all_fits(computed, make):
    _, _, path = computed("noisy")
    study = make(SMALL | {"columns": ["errors"]})
    axes = {axes.get_label(): axes for axes in study_figure(study, path).axes}
    places = itertools.product(("F_k", "c"), (4.92, 3.5))
    assert list(axes) == ["{} $f$ = {} Hz errors".format(*place) for place in places]
    # three runs do not tell how far the largest of their errors may be off: no bars
    for points, _, (bars,) in axes["c $f$ = 3.5 Hz errors"].containers:
        ends = np.array(bars.get_segments())[:, :, 1]
        assert ends == pytest.approx(np.column_stack([points.get_ydata()] * 2))
