"""Numbers that the article argues with and computes itself, against cases whose answer is known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dampbalance.features import Features
from dampbalance.figures.numerics import Evidence, glance
from dampbalance.project.files import read_csv
from dampbalance.publishing.article import derived_numbers as derived
from dampbalance.replication.authors_route import (
    cycle_table,
    effective_damping,
    features_of,
    simulate_levels,
)
from folders import PUBLISHED
from replication.routes import CASE, PAPER, as_published, exact, numbers


def values_of(rows) -> dict:
    """The values of derived numbers by their ids."""
    return {name: value for name, (value, _) in rows.items()}


@pytest.fixture(scope="module")
def coarse():
    """A case with a step of 50 µs: the same motion in a tenth of the time."""
    numerics = replace(CASE.numerics, step_s=5e-5, slip_samples=(1, 1, 1, 1, 1))
    return replace(CASE, numerics=numerics)


def claims_of(name: str, values) -> pd.DataFrame:
    """Numbers with the printed a or W of Table 2."""
    printed = [repr(float(value)) for value in values]
    return pd.DataFrame({"quantity": name, "kind": "level", "printed": printed})


def test_the_last_cycle_is_the_one_that_features_are_read_from(coarse):
    table = cycle_table(coarse, "omega1")
    last = table[table["cycle"] == table["cycle"].max()]
    records = simulate_levels(coarse, "omega1")
    read = features_of(records, coarse, "omega1", "sample")
    # the same samples; their times are divided by another length of record
    np.testing.assert_allclose(last["a_m"], read.a, rtol=1e-14)
    assert table["cycle"].nunique() == 12
    assert not table["a_m"].isna().any()


def test_a_period_of_whole_steps_samples_each_cycle_alike(coarse):
    """Then a is the same in all of them, to what is left of the transient; otherwise it moves by fractions of V_s h."""
    period = 2.0 * math.pi / coarse.omega("omega1")
    whole = replace(coarse, numerics=replace(coarse.numerics, step_s=period / 4096))

    def moved(case):
        table = cycle_table(case, "omega1")
        per_step = 2.0 * table["V_s_m_per_s"] * case.numerics.step_s
        first = table["a_m"].groupby(table["level"]).transform("first")
        return float(((table["a_m"] - first) / per_step).abs().max())

    assert moved(whole) < 1e-6  # ζ = 0.6: a transient loses a factor of 100 in a cycle
    assert 0.1 < moved(coarse) < 1.5


def trial_of(trial: str, a: np.ndarray, V_s: np.ndarray, **columns) -> pd.DataFrame:
    """Two cycles of two levels of a trial."""
    setting = {"trial": trial, "scheme": "rk4", "step_s": CASE.numerics.step_s, "c_N_s_per_m": 90.0}
    setting |= {"k_over_m_per_s2": 954.545}
    levels = {"cycle": [0, 0, -1, -1], "level": [1, 2, 1, 2]}
    numbers = levels | {"a_m": a, "V_s_m_per_s": [*V_s, *V_s]}
    return pd.DataFrame(setting | numbers | {"W_J": 1.0} | columns)


def test_instants_agree_to_what_they_were_moved_by():
    """Whole steps do not count; of a part of a step, what differs between the levels of a cycle."""
    V_s = np.array([0.01, 0.02])
    a = np.array([0.0109, 0.0175])
    per_step = 2.0 * V_s * CASE.numerics.step_s
    moved = np.array([*(a - per_step * [0.3, 2.34]), *(a - per_step * [1.7, -0.32])])
    further = np.array([*(a - per_step * [0.3, 0.5]), *(a - per_step * [0.3, 0.4])])
    cycles = pd.concat(
        [
            trial_of("as_published", moved, V_s),
            trial_of("other_steps", further, V_s, step_s=CASE.numerics.step_s),
            trial_of("other_damping", further, V_s, c_N_s_per_m=90.2),
            trial_of("other_damping", moved, V_s, c_N_s_per_m=90.1, W_J=[1.01, 1.0, 1.0, 0.98]),
        ],
        ignore_index=True,
    )
    claims = pd.concat([claims_of("a", a), claims_of("W", [1.0, 1.0])])
    instants = derived.sampling_instants(cycles, claims)
    assert instants["instant"][:2].tolist() == pytest.approx([-0.02, 0.02], rel=1e-6)
    agreement = values_of(derived.agreement_of_instants(instants, claims))
    expected = {
        **{"cycles.count": 2, "cycles.steps": 1},
        # half of 0.34 − 0.30 and of 0.70 − 0.68
        **{"instants.as_published.min": 0.01, "instants.as_published.max": 0.02},
        **{"instants.other_steps.min": 0.05, "instants.other_steps.max": 0.1},
        **{"other_damping.c": 90.1, "other_damping.spread": 0.02, "other_damping.W": 0.02},
    }
    assert {key: agreement[key] for key in expected} == pytest.approx(expected, rel=1e-6)


@pytest.fixture(scope="module")
def printed():
    """What is printed, with what the routes give for it."""
    return numbers()


@pytest.fixture(scope="module")
def schemes():
    return read_csv(PUBLISHED / "schemes.csv")


@pytest.fixture(scope="module")
def trials():
    return read_csv(PUBLISHED / "cycles.csv")


STEPS = [("rounded", 4.987, 5.003), ("c_over_m", 5.008, 5.023), ("exact", 4.922, 4.937)]


@pytest.mark.parametrize(("rounding", "low", "high"), STEPS)
def test_the_steps_of_W_are_those_of_an_independent_computation(
    schemes, trials, printed, rounding, low, high
):
    """W scatters by 2e-8 of itself with where the grid of samples falls, which is 0.001 µs."""
    steps = values_of(derived.step_from_work(printed, schemes, CASE))
    found = [steps[f"step_from_W.{rounding}.{end}"] for end in ("min", "max")]
    assert found == pytest.approx([low, high], abs=1e-3)
    tried = trials.loc[trials["trial"] == f"step_of_W_{rounding}", "step_s"].unique()
    assert len(tried) == (rounding != "rounded")
    assert all(found[0] < 1e6 * step < found[1] for step in tried)


def test_W_fits_the_exact_solver_with_the_damping_put_in_by_hand(schemes, printed):
    """Better than the simulation: numbers of an independent computation, to half a unit of their last digit."""
    of_exact, rebuilt = (
        Features.from_frame(route.features["omega1"]) for route in (exact(), as_published())
    )
    off = values_of(derived.integral_deviations(of_exact, rebuilt, printed, schemes))
    assert off["by_hand.W"] == pytest.approx(2.3e-7, abs=0.05e-7)
    assert off["rebuilt.W"] == pytest.approx(3.4e-7, abs=0.05e-7)
    assert off["c_over_m.W"] == pytest.approx(5.9e-7, abs=0.05e-7)


RIVALS = [
    ("by_hand_unrounded", 0.2369, 0.2398),
    ("by_hand_k", 0.2780, 0.3023),
    ("semi_implicit", 0.2284, 0.2594),
    ("explicit", 0.3669, 0.4109),
]
"""By an independent computation: the smallest and the largest deviation of an instant, in steps."""


def test_the_samples_of_a_tell_backward_euler(trials, printed):
    """Against an independent computation: backward Euler 0.020–0.023 of a step, without dissipation 0.26–0.27."""
    instants = derived.sampling_instants(trials, printed)
    agreement = values_of(derived.agreement_of_instants(instants, printed))
    # which read a as a displacement, and not by Simpson's rule: an instant moves by up to 0.005 of a step
    for scheme, low, high in (("as_published", 0.020, 0.023), ("by_hand", 0.26, 0.27)):
        assert agreement[f"instants.{scheme}.min"] > low - 0.0055
        assert agreement[f"instants.{scheme}.max"] < high + 0.0055
    # the rivals that are as damped; 0.001 steps for the rules by which a is read
    for rival, low, high in RIVALS:
        assert agreement[f"instants.{rival}.min"] == pytest.approx(low, abs=0.0025)
        assert agreement[f"instants.{rival}.max"] == pytest.approx(high, abs=0.0025)
    # no damping makes up for it: the best for the instants is off in W by 3.0e-6, against 3.4e-7 of backward Euler
    assert agreement["other_damping.spread"] > 2.0 * agreement["instants.as_published.max"]
    assert agreement["other_damping.W"] > 8.0 * 3.4e-7


def test_one_rule_tells_where_the_printed_a_begin(trials):
    """By an independent computation slip is detected 0.2443, 0.6785, 0.0124, 0.6187 and 0.2414 steps after its onset; a
    begins 1, 1, 2, 1, 2 samples later: at the first sample that is 1.2414 to 1.2443 steps after the onset."""
    found = values_of(derived.starts(trials, CASE))
    expected = {"starts.alike": 0.0029, "starts.rule.low": 1.2414, "starts.rule.high": 1.2443}
    # 0.0003 steps for the polynomials through the samples
    assert found == pytest.approx(expected, abs=3e-4)
    # levels that begin in another order of samples fit no rule
    numerics = replace(CASE.numerics, slip_samples=(1, 2, 2, 1, 1))
    other = values_of(derived.starts(trials, replace(CASE, numerics=numerics)))
    assert other["starts.rule.low"] > other["starts.rule.high"]


# By independent code from exact orbits in closed form, %, lowest and highest level.
CAUSES = {
    "omega1": {"which": (-0.132, -0.013), "shared": (0.091, -0.029), "peak": (-0.277, -0.096)},
    "omega2": {"which": (-3.930, -1.346), "shared": (-0.296, 0.179), "peak": (-0.946, -0.275)},
    "omega3": {"which": (3.244, 1.495), "shared": (-8.313, 5.937), "peak": (0.226, 0.029)},
}


@pytest.mark.parametrize("frequency", CAUSES)
def test_errors_of_the_work_are_the_product_of_those_by_single_causes(frequency):
    features = Features.from_frame(exact(PAPER).features[frequency])
    found = values_of(derived.balance_terms(frequency, features, PAPER))

    def ends(name):
        return np.array([found[f"W_{name}.{frequency}.{end}"] for end in ("first", "last")])

    for cause, expected in CAUSES[frequency].items():
        assert ends(cause) == pytest.approx(expected, abs=0.0005)  # half a unit of their last digit
    which, shared, peak = (1.0 + ends(cause) / 100.0 for cause in ("which", "shared", "peak"))
    assert ends("common") == pytest.approx(100.0 * (which * shared * peak - 1.0), abs=1e-9)
    assert ends("individual") == pytest.approx(100.0 * (which * peak - 1.0), abs=1e-9)


def test_the_errors_of_a_fit_have_their_sign():
    """b from the fundamental alone is too small, so that F_k by least squares comes out too large."""
    features = Features.from_frame(exact(PAPER).features["omega2"])
    errors = values_of(derived.lock_in_errors("omega2", features, PAPER, CASE.pairs))
    assert len(errors) == 4
    fit = {term: errors[f"error.omega2.{term}.least_squares.lock_in"] for term in ("F_k", "c")}
    assert fit["F_k"] > 0.0 > fit["c"]
    assert errors["error.omega2.F_k.largest.lock_in"] >= fit["F_k"]


def test_the_figure_shows_what_it_is_given():
    """Errors from independent computations: least squares by X_s, which the paper does with each level's phase of the
    reversal, and never with the mean phase of its pairs; a scheme without damping is drawn at the truth."""
    table, none = numbers().copy(), pd.DataFrame()
    table.loc[table["id"] == "text.c_direct_ls", ["as_published", "printed"]] = [90.0, "90.005"]
    effective = effective_damping(CASE, CASE.omega("omega1"))
    axes = glance(Evidence(table, none, none, none), PAPER.c, effective).axes
    marks = [line.get_xdata() for line in axes[0].lines if len(line.get_xdata()) == 1]
    # c/m to two decimals times m, 37.19 · 2.42 = 89.9998, and mω²h = 0.011563: to the last digit given here
    assert [float(of[0]) for of in marks[:2]] == pytest.approx([90.0, 90.01136], abs=5e-6)
    assert [float(of[0]) for of in marks[2:4]] == [90.0, 90.005]
    errors = [[tip for _, (_, tip) in of.get_segments()] for of in axes[1].collections]
    assert errors[0] == pytest.approx([0.68, -16.2, 11.8], abs=0.05)
    assert errors[1] == pytest.approx([1.37, -19.5, -65.8], abs=0.05)
