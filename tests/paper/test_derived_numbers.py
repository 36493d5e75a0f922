"""Numbers that the article argues with and computes itself, against cases whose answer is known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dampbalance.features import Features
from dampbalance.figures.numerics import Damping, Evidence, glance
from dampbalance.publishing.article.derived_numbers import (
    at_a_glance,
    lock_in_errors,
    sampling_instants,
    step_from_work,
)
from dampbalance.replication.as_published import cycle_table, features_of, simulate_levels
from paper.routes import CASE, PAPER, approaches, as_published, exact

STEP_US = 1e6 * CASE.numerics.step_s


@pytest.fixture(scope="module")
def coarse():
    """A case with a step of 50 µs: the same motion in a tenth of the time."""
    numerics = replace(CASE.numerics, step_s=5e-5, slip_samples=(1, 1, 1, 1, 1))
    return replace(CASE, numerics=numerics)


def claims_of(name: str, values) -> pd.DataFrame:
    """Claims with the printed a or W of Table 2."""
    ids = [f"table2.{name}.{level}" for level in range(1, len(values) + 1)]
    return pd.DataFrame({"id": ids, "printed": [repr(float(value)) for value in values]})


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


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.002])
def test_the_step_is_found_from_the_work_that_it_gave(factor):
    """W is linear in h: W printed for another step is on the line through h = 0 and the simulated one."""
    limit = np.array([0.08, 0.2])
    euler = limit * (1.0 - np.array([1.2e-4, 1.3e-4]))
    table = pd.DataFrame(
        {
            "scheme": ["rk4", "rk4", "backward-euler", "backward-euler"],
            "coefficients": "rounded",
            "W_J": [*limit, *euler],
        }
    )
    step = step_from_work(claims_of("W", limit + factor * (euler - limit)), table, CASE)
    assert step["min"] == pytest.approx(factor * STEP_US, rel=1e-9)
    assert step["max"] == pytest.approx(factor * STEP_US, rel=1e-9)


def test_instants_agree_to_what_they_were_moved_by():
    """Whole steps do not count; of a part of a step, what differs between the levels of a cycle."""
    V_s = np.array([0.01, 0.02])
    a = np.array([0.0109, 0.0175])
    per_step = 2.0 * V_s * CASE.numerics.step_s
    cycles = pd.DataFrame(
        {
            "cycle": [0, 0, -1, -1],
            "level": [1, 2, 1, 2],
            "a_m": [*(a - per_step * [0.3, 2.34]), *(a - per_step * [1.7, -0.32])],
            "V_s_m_per_s": [*V_s, *V_s],
        }
    )
    instants = sampling_instants(cycles, claims_of("a", a), CASE)
    assert instants["count"] == 2
    assert instants["spread"] == pytest.approx(0.02, rel=1e-6)  # half of 0.34 − 0.30


def test_the_errors_of_a_fit_have_their_sign():
    """b from the fundamental alone is too small, so that F_k by least squares comes out too large."""
    features = exact(PAPER).features["omega2"]
    errors = lock_in_errors(Features.from_frame(features), PAPER, CASE.pairs)
    assert errors["least_squares"]["F_k"] > 0.0 > errors["least_squares"]["c"]
    assert errors["pair"]["F_k"] >= errors["least_squares"]["F_k"]


def test_the_figure_shows_what_it_is_given():
    features = exact(PAPER).features
    claims = pd.DataFrame({"id": ["text.c_direct_ls"], "printed": ["90.0115"]})
    none = pd.DataFrame()
    evidence = Evidence(
        claims, features["omega1"], as_published(PAPER).estimates["omega1"], none, none
    )
    damping, errors, hz = at_a_glance(evidence, approaches(), CASE)
    assert damping.true == 90.0
    assert damping.rebuilt == pytest.approx(90.0114, abs=5e-5)
    assert damping.added == pytest.approx(PAPER.m * CASE.omega("omega1") ** 2 * 5e-6, rel=1e-12)
    # from independent computations, half a unit of their last digit: least squares by X_s, which the paper does with
    # each level's phase of the reversal, and never with the mean phase of its pairs
    assert errors["paper’s fit"] == pytest.approx([0.68, -16.2, 11.8], abs=0.05)
    assert errors["paper’s fit"][0] == pytest.approx(0.68, abs=0.005)
    assert errors["mean $\\varphi$ (ours)"] == pytest.approx([1.37, -19.5, -65.8], abs=0.05)
    figure = glance(damping, errors, hz)
    shown = {text.get_text() for axes in figure.axes for text in axes.texts}
    assert {"90.0000", "90.0115", "−66", "+4.0"} <= shown


def test_a_scheme_without_damping_is_drawn_at_the_truth():
    figure = glance(Damping(90.0, 0.01, 90.0, 90.005), {"a": [1.0]}, [4.92])
    left = figure.axes[0]
    places = {
        round(float(line.get_xdata()[0]), 4) for line in left.lines if len(line.get_xdata()) == 1
    }
    assert places == {90.0, 90.01, 90.005}
