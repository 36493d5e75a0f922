"""The solver: pairs, least squares, statistics, contact stiffness and the table of all of them."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dampbalance.balance import (
    APPROACHES,
    Rows,
    direct,
    slip_displacement,
    slip_velocity_as_printed,
)
from dampbalance.estimates import ESTIMATE_COLUMNS, estimate_table
from dampbalance.solver import (
    Estimate,
    contact_stiffness,
    least_squares,
    mean_and_deviation,
    pair,
    pairs,
)
from paper_case import FREQUENCIES_HZ, LEVELS, PAIRS, PAPER, features_at


def rows_of(amplitudes, F_k, c):
    """Rows of a rigid contact at the amplitudes: a ∝ X, b ∝ X²."""
    X = np.asarray(amplitudes, dtype=float)
    a, b = 4.0 * X, 97.0 * X**2
    return Rows(a, b, a * F_k + b * c)


def exact_least_squares(rows):
    """(9) in rational arithmetic, from the binary numbers as they are."""
    a, b, W = ([Fraction(float(x)) for x in column] for column in rows)
    aa, ab, bb = (
        sum(x * y for x, y in zip(u, v, strict=True)) for u, v in ((a, a), (a, b), (b, b))
    )
    aW, bW = (sum(x * y for x, y in zip(u, W, strict=True)) for u in (a, b))
    det = aa * bb - ab * ab
    return float((aW * bb - bW * ab) / det), float((bW * aa - aW * ab) / det)


amplitudes = st.lists(st.floats(1e-4, 0.1), min_size=3, max_size=8, unique=True)


@given(X=amplitudes, F_k=st.floats(0.01, 100.0), c=st.floats(0.1, 1000.0))
def test_least_squares_solves_the_normal_equations(X, F_k, c):
    """Rows disturbed by one per cent, against (9) in rational arithmetic."""
    rows = rows_of(X, F_k, c)
    wobble = 1.0 + 0.01 * np.cos(np.arange(len(X)))
    rows = rows._replace(W=rows.W * wobble)
    A = np.column_stack(rows[:2])
    A /= np.linalg.norm(A, axis=0)
    condition = np.linalg.cond(A)
    assume(condition < 1e3)
    estimate = least_squares(rows)
    expected = np.array(exact_least_squares(rows))
    # Least squares amplify rounding by the condition number, and by its square times the residual, here at most 1 %;
    # measured against the larger of the two terms a F_k and b c, in which the unknowns enter.
    scale = np.linalg.norm(rows.W) / np.linalg.norm(np.column_stack(rows[:2]), axis=0)
    error = np.abs(np.array([estimate.F_k, estimate.c]) - expected)
    assert np.all(error <= 30.0 * np.finfo(float).eps * (condition + 0.01 * condition**2) * scale)


def test_close_levels_lose_the_condition_number_not_its_square():
    """Levels one part in a million apart: QR keeps 9 digits, where the normal equations of (9) keep none."""
    rows = rows_of([0.01, 0.010000005, 0.01000001], 1.28, 90.0)
    estimate = least_squares(rows)
    assert estimate.F_k == pytest.approx(1.28, rel=1e-7)
    assert estimate.c == pytest.approx(90.0, rel=1e-7)
    A, W = np.column_stack(rows[:2]), rows.W
    normal = np.linalg.solve(A.T @ A, A.T @ W)
    assert abs(normal[0] / 1.28 - 1.0) > 1e-5


@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
def test_exact_orbits_give_back_the_parameters(hertz):
    rows = APPROACHES["direct"](features_at(hertz), PAPER.k)
    for estimate in [least_squares(rows), *pairs(rows, PAIRS)]:
        # Integrals good to 1e-14 times the condition number of a pair, up to 100 off resonance.
        assert estimate.F_k == pytest.approx(1.28, rel=1e-10)
        assert estimate.c == pytest.approx(90.0, rel=1e-10)


@given(F_k=st.floats(0.0, 100.0), c=st.floats(0.0, 1000.0))
def test_pair_is_the_least_squares_of_two_rows(F_k, c):
    assume(F_k + c > 0.01)
    rows = rows_of([0.004, 0.006, 0.012], F_k, c)
    of_pair, of_two = pair(rows, 0, 2), least_squares(rows.take([2, 0]))
    scale = np.linalg.norm(rows.W)
    # Same system, other order of rows: rounding only, against the larger term.
    assert of_pair.F_k == pytest.approx(of_two.F_k, abs=1e-13 * scale / np.linalg.norm(rows.a))
    assert of_pair.c == pytest.approx(of_two.c, abs=1e-12 * scale / np.linalg.norm(rows.b))


def test_residual_is_the_misfit_over_the_norm_of_W():
    rows = rows_of([0.004, 0.006, 0.008], 1.28, 90.0)
    rows = rows._replace(W=rows.W + np.array([1e-3, -2e-3, 1e-3]))
    estimate = least_squares(rows)
    misfit = rows.a * estimate.F_k + rows.b * estimate.c - rows.W
    assert estimate.residual == pytest.approx(
        math.sqrt(np.sum(misfit**2)) / math.sqrt(np.sum(rows.W**2)), rel=1e-12
    )
    assert estimate.residual > 1e-4


def test_covariance_is_the_scatter_of_repeated_estimates():
    rng = np.random.default_rng(1)
    rows = rows_of(LEVELS, 1.28, 90.0)
    sigma = 1e-4
    estimates = [
        least_squares(rows._replace(W=rows.W + sigma * rng.standard_normal(5))) for _ in range(4000)
    ]
    scatter = np.cov(np.array([(e.F_k, e.c) for e in estimates]).T)
    mean = np.mean([e.covariance for e in estimates], axis=0)
    # 4000 samples give a variance to √(2/4000) = 2.2 %, and its mean estimate (3 degrees of freedom) to 1.3 %; 3 sigma.
    assert mean == pytest.approx(scatter, rel=0.08)


def test_two_rows_have_no_scatter():
    estimate = pair(rows_of([0.004, 0.006], 1.28, 90.0), 0, 1)
    assert estimate.n == 2
    assert np.all(np.isnan(estimate.covariance))


def test_rows_without_features_are_left_out():
    rows = rows_of(LEVELS, 1.28, 90.0)
    gap = Rows(rows.a.copy(), rows.b, rows.W)
    gap.a[1] = np.nan
    estimate = least_squares(gap)
    assert estimate.n == 4
    assert estimate.F_k == pytest.approx(1.28, rel=1e-12)


def test_one_usable_row_is_refused():
    rows = rows_of([0.004, 0.006], 1.28, 90.0)
    rows.a[0] = np.nan
    with pytest.raises(ValueError, match="at least two usable responses, got 1 of 2"):
        least_squares(rows)


def test_pair_without_a_feature_names_the_level():
    rows = rows_of([0.004, 0.006], 1.28, 90.0)
    rows.b[1] = np.nan
    with pytest.raises(ValueError, match="pair 1-2: level 2 lacks a feature"):
        pair(rows, 0, 1)


def test_equal_levels_are_named():
    rows = rows_of([0.004, 0.006, 0.006], 1.28, 90.0)
    with pytest.raises(ValueError, match="levels 2 and 3 give the same response"):
        pair(rows, 1, 2)
    with pytest.raises(ValueError, match="2 usable responses are one and the same"):
        least_squares(rows.take([1, 2]))


def test_nothing_sliding_is_not_an_estimate():
    rows = Rows(np.zeros(3), np.array([1.0, 2.0, 3.0]), np.array([90.0, 180.0, 270.0]))
    with pytest.raises(ValueError, match="nothing slides"):
        least_squares(rows)


def test_a_small_row_keeps_its_digits_beside_a_large_one():
    """0.2 mm, where nothing slips, with 12 mm: the rows differ by a factor 1e4, and each is exact to rounding.

    The solution is as good as that of the equations divided by their own W: condition number (about 10) times rounding.
    """
    features = features_at(levels=(0.0002, 0.012))
    estimate = pair(direct(features, PAPER.k), 0, 1)
    assert estimate.c == pytest.approx(90.0, rel=1e-13)
    assert estimate.F_k == pytest.approx(1.28, rel=1e-13)


def test_mean_and_deviation_divide_by_n_minus_1():
    blank = np.full((2, 2), np.nan)
    estimates = [
        Estimate(F_k, c, 0.0, blank, 2) for F_k, c in ((1.0, 80.0), (2.0, 90.0), (3.0, 130.0))
    ]
    statistics = mean_and_deviation(estimates)
    assert statistics == pytest.approx((2.0, 100.0, 1.0, math.sqrt(700.0)), rel=1e-15)
    assert math.isnan(mean_and_deviation(estimates[:1]).c_std)
    with pytest.raises(ValueError, match="no estimates"):
        mean_and_deviation([])


@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
def test_contact_stiffness_of_exact_orbits(hertz):
    """The microstick line is 12.3 µm long out of 9 mm: X + X_s keeps 1e-16 · 750 ≈ 1e-13 of itself."""
    features = features_at(hertz)
    assert contact_stiffness(1.28, features.X, features.X_s) == pytest.approx(208000.0, rel=1e-9)


def test_contact_stiffness_without_slip_is_nan():
    assert np.isnan(contact_stiffness(1.28, 0.004, np.nan))


def test_contact_stiffness_of_a_lost_line_is_refused():
    with pytest.raises(ValueError, match="X \\+ X_s must be positive"):
        contact_stiffness(1.28, [0.004, 0.006], [-0.00399, -0.006])


def test_table_has_one_line_per_estimate():
    features = features_at()
    table = estimate_table(features, PAPER.k, PAIRS)
    assert tuple(table.columns) == ESTIMATE_COLUMNS
    # Direct and Fourier once, three harmonic approaches with individual and with common phase; each five pairs, mean,
    # std, fit.
    assert len(table) == 8 * 8
    assert set(table.loc[table["approach"] == "fourier", "phase"]) == {"individual"}
    assert not table.duplicated(["approach", "kind", "phase", "pair"]).any()
    assert (table["note"] == "").all()
    fit = table[(table["approach"] == "direct") & (table["kind"] == "least_squares")].iloc[0]
    assert fit["F_k_N"] == pytest.approx(1.28, rel=1e-10)
    assert fit["K_z_N_per_m"] == pytest.approx(208000.0, rel=1e-9)


def test_table_common_phase_is_the_mean_unless_given():
    features = features_at()
    by_mean = estimate_table(features, PAPER.k, PAIRS)
    mean = features.replaced(phi=features.phi.mean(), t_s=features.t_s.mean())
    given_ = estimate_table(features, PAPER.k, PAIRS, common=mean)
    assert by_mean.equals(given_)
    line = by_mean[(by_mean["approach"] == "X_s") & (by_mean["phase"] == "common")].iloc[0]
    assert line["F_k_N"] == pair(slip_displacement(mean, PAPER.k), 0, 1).F_k


def test_table_takes_other_row_functions_for_the_common_phase():
    table = estimate_table(
        features_at(), PAPER.k, PAIRS, common_approaches={"slipped": slip_velocity_as_printed}
    )
    common = table[table["phase"] == "common"]
    assert set(common["approach"]) == {"slipped"}
    assert set(common["kind"]) == {"pair", "mean", "std", "least_squares"}
    assert set(table["approach"]) == {*APPROACHES, "slipped"}


def test_table_goes_on_without_a_level_that_does_not_slip():
    """X of the lowest level stays below Z_m: it has no slip onset, and the others are estimated without it."""
    osc = replace(PAPER, F_k=8.0)
    features = features_at(levels=(0.001, 0.008, 0.010), osc=osc)
    assert features.slipping.tolist() == [False, True, True]
    table = estimate_table(features, osc.k, [(0, 1), (1, 2)])
    X_s = table[(table["approach"] == "X_s") & (table["phase"] == "individual")].set_index("kind")
    assert np.isnan(X_s.loc["pair", "F_k_N"].iloc[0])
    assert "level 1" in X_s.loc["pair", "note"].iloc[0]
    assert np.isfinite(X_s.loc["pair", "F_k_N"].iloc[1])
    assert X_s.loc["least_squares", "levels"] == 2
    assert "without level 1" in X_s.loc["least_squares", "note"]


def test_table_without_any_slip_says_so_and_estimates_nothing():
    osc = replace(PAPER, F_k=60.0)
    features = features_at(levels=(0.004, 0.006), osc=osc)
    assert not features.slipping.any()
    table = estimate_table(features, osc.k, [(0, 1)])
    harmonic = table[table["approach"] != "direct"]
    assert harmonic["F_k_N"].isna().all()
    assert harmonic["note"].str.contains("nothing slips").all()
    assert table["note"].str.contains("nothing sl").all()  # direct: a = 0, "nothing slides"
