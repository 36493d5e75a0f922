"""The solver: pairs, least squares, statistics, contact stiffness and the table of all of them."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dampbalance.balance import APPROACHES, Approach, Rows, slip_velocity_as_printed
from dampbalance.estimates import estimate_columns, estimate_table
from dampbalance.solver import (
    Estimate,
    contact_stiffness,
    least_squares,
    mean_and_deviation,
    pair,
    solve,
)
from paper_case import FREQUENCIES_HZ, PAIRS, PAPER, features_at


def rows_of(amplitudes, F_k, c):
    """Rows of a rigid contact at the amplitudes: a ∝ X, b ∝ X²."""
    X = np.asarray(amplitudes, dtype=float)
    a, b = 4.0 * X, 97.0 * X**2
    return Rows({"F_k": a, "c": b}, a * F_k + b * c)


def matrix(rows):
    return np.column_stack(list(rows.terms.values()))


def exact_least_squares(rows):
    """(9) in rational arithmetic, from the binary numbers as they are: AᵀA by Gauss–Jordan elimination."""
    A = [[Fraction(float(x)) for x in column] for column in rows.terms.values()]
    W = [Fraction(float(x)) for x in rows.W]
    w = [Fraction(1)] * len(W) if rows.weights is None else [Fraction(x) for x in rows.weights]
    normal = [[sum(map(math.prod, zip(w, u, v, strict=True))) for v in (*A, W)] for u in A]
    for j, pivot in enumerate(normal):
        for line in normal:
            if line is not pivot:
                factor = line[j] / pivot[j]
                line[:] = [x - factor * y for x, y in zip(line, pivot, strict=True)]
    return [float(line[-1] / line[j]) for j, line in enumerate(normal)]


@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
def test_exact_orbits_give_back_the_parameters(hertz):
    rows = APPROACHES["direct"](features_at(hertz), PAPER.k)
    for estimate in [least_squares(rows), *(pair(rows, *two) for two in combinations(range(5), 2))]:
        # Integrals good to 1e-14 times the condition number of a pair, up to 100 off resonance.
        assert estimate["F_k"] == pytest.approx(1.28, rel=1e-10)
        assert estimate["c"] == pytest.approx(90.0, rel=1e-10)


def test_a_small_row_keeps_its_digits_beside_a_large_one():
    """0.2 mm, where nothing slips, with 12 mm: the rows differ by a factor 1e4, and each is exact to rounding.

    The solution is as good as that of the equations divided by their own W: condition number (about 10) times rounding.
    """
    features = features_at(levels=(0.0002, 0.012))
    estimate = pair(APPROACHES["direct"](features, PAPER.k), 0, 1)
    assert estimate["c"] == pytest.approx(90.0, rel=1e-13)
    assert estimate["F_k"] == pytest.approx(1.28, rel=1e-13)


# --- any number of terms, rows and cases ------------------------------------------------------------

THREE = ("F_k", "c", "c_2")


def drawn_rows(seed, shape, symbols=THREE):
    """Rows that fit no coefficients in particular, with columns of sizes that differ by up to 1e8."""
    rng = np.random.default_rng(seed)
    terms = {s: 10.0 ** rng.uniform(-4.0, 4.0) * rng.standard_normal(shape) for s in symbols}
    return Rows(terms, rng.standard_normal(shape))


def assert_same_bits(found, expected):
    assert list(found.values) == list(expected.values)
    for symbol, values in expected.values.items():
        np.testing.assert_array_equal(found[symbol], values)
    np.testing.assert_array_equal(found.residual, expected.residual)
    np.testing.assert_array_equal(found.covariance, expected.covariance)
    np.testing.assert_array_equal(found.n, expected.n)


def of_case(found, *case):
    """The estimate of one case among many."""
    values = {symbol: numbers[case] for symbol, numbers in found.values.items()}
    return Estimate(values, found.residual[case], found.covariance[:, :, *case], found.n[case])


seeds = st.integers(0, 2**32 - 1)


@given(seed=seeds, terms=st.integers(2, 3), levels=st.integers(3, 8), weighted=st.booleans())
def test_least_squares_solve_the_normal_equations(seed, terms, levels, weighted):
    """Against rational arithmetic, columns of very different sizes, all rows alike or of weights up to 1e6 apart."""
    rows = drawn_rows(seed, levels, THREE[:terms])
    if weighted:
        rng = np.random.default_rng(seed + 1)
        rows = replace(rows, weights=10.0 ** rng.uniform(-3.0, 3.0, levels))
    root = 1.0 if rows.weights is None else np.sqrt(rows.weights)
    A, W = (matrix(rows).T * root).T, rows.W * root
    size = np.linalg.norm(A, axis=0)
    condition = np.linalg.cond(A / size)
    assume(condition < 1e4)
    estimate = least_squares(rows)
    expected = np.array(exact_least_squares(rows))
    error = np.abs(np.array(list(estimate.values.values())) - expected)
    # W is far from the fit: the square of the condition number counts in full.
    epsilon = np.finfo(float).eps
    assert np.all(error <= 30.0 * epsilon * (condition + condition**2) * np.linalg.norm(W) / size)
    misfit = np.linalg.norm(A @ expected - W) / np.linalg.norm(W)
    assert estimate.residual == pytest.approx(misfit, abs=30.0 * epsilon * condition)


@given(seed=seeds, levels=st.integers(4, 8))
def test_the_covariance_of_three_terms_is_that_of_least_squares(seed, levels):
    """s² (AᵀA)⁻¹ by an inverse of unscaled columns of one size, s² = ‖A p − W‖²/(n − 3)."""
    rng = np.random.default_rng(seed)
    A, W = rng.standard_normal((levels, 3)), rng.standard_normal(levels)
    assume(np.linalg.cond(A) < 30.0)
    estimate = least_squares(Rows(dict(zip(THREE, A.T, strict=True)), W))
    left = np.linalg.lstsq(A, W)[1]
    expected = left[0] / (levels - 3) * np.linalg.inv(A.T @ A)
    assert estimate.covariance == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())
    errors = [estimate.standard_error(s) for s in THREE]
    assert errors == pytest.approx(np.sqrt(np.diag(expected)), rel=1e-9)


@pytest.mark.parametrize("known", [{"c": 90.0}, {"c_2": -3.0, "F_k": 1.28}], ids=str)
def test_given_values_go_to_the_right_side(known):
    rows = drawn_rows(3, (5, 4))
    known = {s: p * float(np.std(rows.W) / np.std(rows.terms[s])) for s, p in known.items()}
    estimate = solve(replace(rows, given=known))
    open_terms = {s: g for s, g in rows.terms.items() if s not in known}
    moved = rows.W - sum(p * rows.terms[s] for s, p in known.items())
    expected = solve(Rows(open_terms, moved))
    assert list(estimate.values) == [s for s in THREE if s not in known]
    for symbol in open_terms:
        assert estimate[symbol] == pytest.approx(expected[symbol], rel=1e-12)
        assert estimate.standard_error(symbol) == pytest.approx(
            expected.standard_error(symbol), rel=1e-12
        )
    # the residual is still relative to all of W
    misfit = np.linalg.norm(rows.misfit(estimate.values | known), axis=0)
    assert estimate.residual == pytest.approx(misfit / np.linalg.norm(rows.W, axis=0), rel=1e-12)


@given(seed=seeds, levels=st.integers(2, 6))
def test_each_of_many_cases_is_the_case_alone_bit_for_bit(seed, levels):
    """Behind the first axis any shape, here (2, 150). Among them a case without one row, and one whose rows are one and
    the same."""
    rows = drawn_rows(seed, (levels, 2, 150), THREE[:2])
    rows.terms["F_k"][0, 1, 7] = np.nan
    rows.W[levels - 1, 0, 0] = np.nan
    rows.terms["F_k"][:, 1, 8], rows.terms["c"][:, 1, 8] = 1.0, 2.0
    found = solve(rows)
    assert found["c"].shape == found.residual.shape == found.n.shape == (2, 150)
    assert found.covariance.shape == (2, 2, 2, 150)
    assert np.isnan(found["F_k"][1, 8])
    for case in ((0, 0), (1, 7), (1, 8), (0, 3), (1, 105), (1, 106), (1, 149)):
        part = Rows({s: g[:, *case] for s, g in rows.terms.items()}, rows.W[:, *case])
        alone = solve(part)
        assert_same_bits(of_case(found, *case), alone)
        assert alone.n == np.count_nonzero(part.usable)


def test_rows_without_a_feature_are_left_out_case_by_case():
    """As if they were not there, to the last bit, whichever of their numbers is missing."""
    rows = drawn_rows(5, (6, 4))
    rows.terms["F_k"][1, 0] = np.nan
    rows.terms["c_2"][5, 1] = np.inf
    rows.W[0, 2] = np.nan
    rows.terms["c"][2:, 3] = np.nan
    found = solve(rows)
    assert found.n.tolist() == [5, 5, 5, 2]
    for case in range(3):
        alone = rows[:, case]
        assert_same_bits(of_case(found, case), solve(alone[alone.usable]))
    for numbers in (*found.values.values(), found.residual):
        assert np.isnan(numbers).tolist() == [False, False, False, True]  # two rows, three unknowns


SINGULAR = {
    "parallel": {"c_2": lambda a, b: 3.0 * a},
    "in the plane": {"c_2": lambda a, b: 0.3 * a - 1e-5 * b},
    "but for rounding": {"c_2": lambda a, b: a * (1.0 + 1e-14 * np.sign(b))},
    "none": {"c_2": lambda a, b: 0.0 * a},
    "first": {"F_k": lambda a, b: 0.0 * a},
}


@pytest.mark.parametrize("name", SINGULAR)
def test_three_columns_of_which_one_says_nothing_are_not_solved(name):
    rows = drawn_rows(7, 5)
    a, b = rows.terms["F_k"], rows.terms["c"]
    rows = replace(rows, terms=rows.terms | {s: of(a, b) for s, of in SINGULAR[name].items()})
    estimate = solve(rows)
    assert np.isnan([*estimate.values.values(), estimate.residual]).all()
    assert np.isnan(estimate.covariance).all()
    with pytest.raises(ValueError, match="in any of them: F_k, c and c_2 cannot be distinguished"):
        least_squares(rows)


def test_columns_that_are_nearly_one_are_solved_as_long_as_they_differ():
    rows = drawn_rows(7, 5)
    a, b, c_2 = rows.terms.values()
    near = a + b + 1e-6 * c_2 * np.linalg.norm(a + b) / np.linalg.norm(c_2)
    rows = Rows({"F_k": a, "c": b, "c_2": near}, 2.0 * a - 3.0 * b + 0.5 * near)
    estimate = least_squares(rows)
    for symbol, true in (("F_k", 2.0), ("c", -3.0), ("c_2", 0.5)):
        size = np.linalg.norm(rows.W) / np.linalg.norm(rows.terms[symbol])
        assert estimate[symbol] == pytest.approx(true, abs=1e-8 * size)  # 1e6 times rounding


# --- statistics, contact stiffness and the table ---------------------------------------------------


def test_mean_and_deviation_divide_by_n_minus_1():
    estimates = [{"F_k": F_k, "c": c} for F_k, c in ((1.0, 80.0), (2.0, 90.0), (3.0, 130.0))]
    mean, deviation = mean_and_deviation(estimates)
    assert mean == pytest.approx({"F_k": 2.0, "c": 100.0}, rel=1e-15)
    assert deviation == pytest.approx({"F_k": 1.0, "c": math.sqrt(700.0)}, rel=1e-15)
    assert math.isnan(mean_and_deviation(estimates[:1])[1]["c"])


def test_a_microstick_line_without_length_takes_no_other_case_along():
    # of 10 µm, of none, of less than none, and of one that was not read
    X, X_s = [0.004, 0.006, 0.006, 0.004], [-0.00399, -0.006, -0.0061, np.nan]
    K_z = contact_stiffness(1.28, X, X_s)
    assert K_z[0] == pytest.approx(2.56 / 1e-5, rel=1e-10)  # of 10 µm, 4 mm in doubles leave 1e-13
    assert np.isnan(K_z[1:]).all()


def test_table_has_one_line_per_estimate():
    features = features_at()
    table = estimate_table(features, PAPER.k, PAIRS)
    assert list(table.columns) == estimate_columns()
    # Direct and Fourier once, three harmonic approaches with individual and with common phase; each five pairs, mean,
    # std, fit.
    assert len(table) == 8 * 8
    assert set(table.loc[table["approach"] == "fourier", "phase"]) == {"individual"}
    assert not table.duplicated(["approach", "kind", "phase", "pair"]).any()
    assert (table["note"] == "").all()
    fit = table[(table["approach"] == "direct") & (table["kind"] == "least_squares")].iloc[0]
    assert fit["F_k_N"] == pytest.approx(1.28, rel=1e-10)
    assert fit["K_z_N_per_m"] == pytest.approx(208000.0, rel=1e-9)
    # two rows for two unknowns leave no residual but rounding
    assert table.loc[table["kind"] == "pair", "residual"].isna().all()
    assert fit["residual"] < 1e-10


def test_table_takes_the_mean_phase_or_what_is_given_and_other_row_functions():
    features = features_at()
    by_mean = estimate_table(features, PAPER.k, PAIRS)
    mean = features.replaced(phi=features.phi.mean(), t_s=features.t_s.mean())
    assert by_mean.equals(estimate_table(features, PAPER.k, PAIRS, common=mean))
    line = by_mean[(by_mean["approach"] == "X_s") & (by_mean["phase"] == "common")].iloc[0]
    assert line["F_k_N"] == pair(APPROACHES["X_s"](mean, PAPER.k), 0, 1)["F_k"]
    slipped = Approach("slipped", slip_velocity_as_printed, takes_phase=True)
    table = estimate_table(features, PAPER.k, PAIRS, common_approaches=[slipped])
    assert set(table.loc[table["phase"] == "common", "approach"]) == {"slipped"}
    assert set(table["approach"]) == {*APPROACHES, "slipped"}


def test_table_goes_on_without_a_level_that_does_not_slip():
    """X of the lowest level stays below Z_m: it has no slip onset, and the others are estimated without it."""
    osc = replace(PAPER, F_k=8.0)
    features = features_at(levels=(0.001, 0.008, 0.010), osc=osc)
    table = estimate_table(features, osc.k, [(0, 1), (1, 2)])
    X_s = table[(table["approach"] == "X_s") & (table["phase"] == "individual")].set_index("kind")
    assert np.isfinite(X_s.loc["pair", "F_k_N"]).tolist() == [False, True]
    assert "level 1" in X_s.loc["pair", "note"].iloc[0]
    assert X_s.loc["least_squares", "levels"] == 2
    assert "without level 1" in X_s.loc["least_squares", "note"]
    nowhere = estimate_table(features_at(osc=replace(PAPER, F_k=60.0)), PAPER.k, [(0, 1)])
    assert nowhere.loc[nowhere["approach"] != "direct", "F_k_N"].isna().all()
    assert (
        nowhere["note"].str.contains("nothing sl").all()
    )  # "slips"; direct: a = 0, "nothing slides"


def test_no_rows_and_no_cases():
    rows = rows_of([0.004, 0.006, 0.008], 1.28, 90.0)
    assert math.isnan(solve(rows[[]])["F_k"])
    none = solve(Rows({"F_k": np.empty((5, 0)), "c": np.empty((5, 0))}, np.empty((5, 0))))
    assert none["c"].shape == (0,)


# --- refusals ------------------------------------------------------------------------------------


def lost(symbol, number):
    """Two rows, one of which lacks a feature."""
    rows = rows_of([0.004, 0.006], 1.28, 90.0)
    rows.terms[symbol][number] = np.nan
    return rows


def empty(symbol):
    return Rows({symbol: np.full(2, np.nan)}, np.ones(2))


TWO, EQUAL = (rows_of(levels, 1.28, 90.0) for levels in ([0.004, 0.006], [0.004, 0.006, 0.006]))
STUCK = Rows({"F_k": np.zeros(3), "c": np.array([1.0, 2.0, 3.0])}, np.array([90.0, 180.0, 270.0]))
REFUSED = {
    "at least two usable responses, got 1 of 2": lambda: least_squares(lost("F_k", 0)),
    "pair 1-2: level 2 lacks a feature": lambda: pair(lost("c", 1), 0, 1),
    "levels 2 and 3 give the same response": lambda: pair(EQUAL, 1, 2),
    "2 usable responses are one and the same": lambda: least_squares(EQUAL[[1, 2]]),
    "nothing slides": lambda: least_squares(STUCK),
    "F_k, c and c_2 need at least three usable responses, got 2 of 2": lambda: least_squares(
        drawn_rows(9, 4)[[0, 1]]
    ),
    "pair 2-4: two levels do not distinguish F_k, c and c_2; give all but two of them": lambda: (
        pair(drawn_rows(9, 4), 1, 3)
    ),
    "^F_k need at least one usable": lambda: least_squares(empty("F_k")),
    r"given \['eta'\] are no terms of these rows": lambda: replace(TWO, given={"eta": 0.1}),
    "no estimates": lambda: mean_and_deviation([]),
    "without a covariance": lambda: TWO.weighted({"F_k": 5.0, "c": 20.0}),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_cannot_be_solved_is_refused(message):
    with pytest.raises(ValueError, match=message):
        REFUSED[message]()


# --- rows that weigh as much as they are sure ------------------------------------------------------


def uncertain(cases=(), *, seed=0, levels=5, size=1e-3):
    """Rows of a rigid contact with errors whose covariance differs from row to row; (rows, covariance)."""
    rng = np.random.default_rng(seed)
    rows = rows_of(rng.uniform(0.002, 0.02, (levels, *cases)), 1.28, 90.0)
    parts = np.stack([*rows.terms.values(), rows.W])  # (3, L, …)
    roots = rng.standard_normal((3, 3, levels, *cases)) * size * parts
    covariance = np.einsum("ik...,jk...->ij...", roots, roots)
    noisy = parts + np.einsum("ik...,k...->i...", roots, rng.standard_normal(parts.shape))
    return Rows({"F_k": noisy[0], "c": noisy[1]}, noisy[2], covariance=covariance)


def own_weights(rows, F_k, c):
    """1/var(a F_k + b c − W), from the rule for a linear form."""
    form = np.array([F_k, c, -1.0])
    return np.array([1.0 / (form @ rows.covariance[:, :, i] @ form) for i in range(rows.W.size)])


@pytest.mark.parametrize("seed", range(2))
def test_the_weights_are_those_of_the_solution_that_they_give(seed):
    rows = uncertain(seed=seed)
    found = solve(rows)
    weights = own_weights(rows, float(found["F_k"]), float(found["c"]))
    again = exact_least_squares(replace(rows, weights=weights, covariance=None))
    # weights settle to 1e-9 of themselves; an estimate moves by less than that of its distance from the others
    assert [float(found["F_k"]), float(found["c"])] == pytest.approx(again, rel=1e-9)
    plain = solve(replace(rows, covariance=None))
    assert abs(float(plain["F_k"] / found["F_k"]) - 1.0) > 1e-6  # where (9) weighs otherwise
    assert rows.weighted(found.values).weights == pytest.approx(weights, rel=1e-9)
    assert rows.weighted(found.values).covariance is None


@pytest.mark.parametrize("levels", [2, 3, 6])
def test_a_weighted_case_is_the_case_alone_whatever_stands_beside_it(levels):
    rows = uncertain((7,), seed=levels, levels=levels)
    # one that has no answer, and one with rows left out, do not keep the others from settling
    rows.terms["F_k"][:, 3] = np.nan
    rows.W[0, 5] = np.nan
    together = solve(rows)
    for case in range(7):
        assert_same_bits(of_case(together, case), solve(rows[:, case]))
    assert np.isnan(together["F_k"][3])
    assert np.isfinite(together["F_k"][[0, 1, 2, 4, 6]]).all()
    # a row that is left out changes nothing of the others
    if levels > 2:
        without = solve(rows[1:, 5])
        for symbol in ("F_k", "c"):
            assert together[symbol][5] == pytest.approx(float(without[symbol]), rel=1e-13)


def test_given_coefficients_weigh_as_if_they_had_been_found():
    rows = uncertain(seed=4)
    known = replace(rows, given={"c": 90.0})
    found = solve(known)
    assert list(found.values) == ["F_k"]
    weights = own_weights(rows, float(found["F_k"]), 90.0)
    assert known.weighted(found.values).weights == pytest.approx(weights, rel=1e-14)
    a, rest = rows.terms["F_k"], rows.W - 90.0 * rows.terms["c"]
    expected = np.sum(weights * a * rest) / np.sum(weights * a**2)
    assert float(found["F_k"]) == pytest.approx(expected, rel=1e-9)
