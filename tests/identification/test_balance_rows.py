"""The solution of correlated rows of the balance, against closed forms; features of all records with one microstick
line: what moves it in one record moves it in all."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.balance import Rows
from dampbalance.fit.errors import jackknifed
from dampbalance.identification.balance_rows import features_left_out, features_of, solved
from dampbalance.identification.forced import microstick_of
from dampbalance.identification.oscillator import CommonFit, common_fit, with_common_fit
from identification.levels import read
from paper_case import PAPER, orbits_at

TRUTH = np.array([1.3, 90.0])


@pytest.fixture
def case():
    """Columns, (7, 2), of sizes as of records, the covariance of the rows and their work with such an error."""
    random = np.random.default_rng(5)
    A = np.column_stack([np.geomspace(1e-3, 1e-1, 7), np.geomspace(1e-5, 1e-2, 7) ** 1.3])
    scale = 1e-3 * A @ TRUTH
    mixed = random.normal(size=(7, 7)) * scale[:, None]
    C = mixed @ mixed.T + np.diag(scale**2)
    return A, C, A @ TRUTH + np.linalg.cholesky(C) @ random.normal(size=7)


def rows(A, W, **given):
    return Rows({"F_k": A[:, 0], "c": A[:, 1]}, W, given=given)


@pytest.mark.parametrize("correlated", [True, False])
def test_the_solution_is_that_of_the_normal_equations(case, correlated):
    A, C, W = case
    found = solved(rows(A, W), lambda _: [C], [math.inf], correlated=correlated)
    weights = np.linalg.inv(C if correlated else np.diag(np.diag(C)))
    by_rows = np.linalg.solve(A.T @ weights @ A, A.T @ weights)
    p = by_rows @ W
    assert [*found.values.values()] == pytest.approx(p, rel=1e-9)
    np.testing.assert_allclose(found.covariance, by_rows @ C @ by_rows.T, rtol=1e-8)
    off = A @ p - W
    assert found.chi_square == pytest.approx(off @ weights @ off, rel=1e-6)
    assert (found.freedom, found.errors.tolist()) == (5, np.sqrt(np.diag(C)).tolist())
    number = found.estimates["c"]
    assert number.interval.high - number.value == pytest.approx(1.959964 * number.standard_error)


def test_a_covariance_that_depends_on_the_coefficients_is_that_of_the_solution(case):
    """The error of a row is a part of its friction: rows of little friction weigh most."""
    A, _, W = case

    def errors(values):
        return [np.diag((1e-3 * (1e-4 + A[:, 0] * values.get("F_k", 0.0))) ** 2)]

    found = solved(rows(A, W), errors, [math.inf])
    again = solved(rows(A, W), lambda _: errors(found.values), [math.inf])
    assert found.values == pytest.approx(again.values, rel=1e-8)


def test_what_is_given_is_taken_off_and_a_row_without_a_number_is_left_out(case):
    A, C, W = case
    A = A.copy()
    A[2, 0] = math.nan
    found = solved(rows(A, W, F_k=1.3), lambda _: [C], [math.inf])
    kept = np.arange(7) != 2
    weights, b = np.linalg.inv(C[np.ix_(kept, kept)]), A[kept, 1]
    right = W[kept] - 1.3 * A[kept, 0]
    assert found.values == pytest.approx({"c": b @ weights @ right / (b @ weights @ b)}, rel=1e-9)
    assert np.isnan(found.errors[2])


def test_exact_rows_have_no_errors_and_rows_alike_no_solution(case):
    A, C, _ = case
    exact = solved(rows(A, A @ TRUTH), lambda _: [np.zeros((7, 7))], [math.inf])
    assert [*exact.values.values()] == pytest.approx(TRUTH, rel=1e-10)
    assert exact.estimates["F_k"].standard_error == 0.0
    alike = np.column_stack([A[:, 0], 2.0 * A[:, 0]])
    assert solved(rows(alike, A[:, 0]), lambda _: [C], [math.inf]).estimates == {}


@pytest.fixture(scope="module")
def common():
    """Readings, their common fit, the readings with it, and features of 2,000 means of cycles drawn with replacement,
    (3, 2000)."""
    readings, random = read(orbits_at(3.5, (0.004, 0.008, 0.012))), np.random.default_rng(1)
    whole = common_fit([reading.lines for reading in readings], PAPER.k)
    shared = with_common_fit(readings, whole)
    drawn = features_of(shared, [reading.resampled(2000, random) for reading in shared])
    return readings, whole, shared, drawn


def test_there_is_one_line_whatever_is_left_out_and_its_features_scatter_as_cycles_do(common):
    _, _, shared, drawn = common
    left = features_left_out(shared)
    assert len(left) == 3
    for f in (features_of(shared, [reading.mean for reading in shared]), *left):
        length = f.X + f.X_s
        # the other records follow to first order: ρ moves by 1e-2 of itself at most
        np.testing.assert_allclose(length, length[:1] * np.ones_like(length), rtol=2e-4)
        # with one slip onset per half cycle a = 4X − 2L, whatever moves; slopes by differences of 1e-6
        np.testing.assert_allclose(f.a, 2.0 * (f.X - f.X_s), rtol=1e-8)
        np.testing.assert_allclose([f.X_r, f.V_r], [-f.X_s, -f.V_s], rtol=1e-12)
    for name in ("X_s", "V_s", "t_s", "a"):
        covariance = jackknifed([getattr(part, name) for part in left])
        errors = np.sqrt(np.diag(covariance))
        # 2,000 drawings know it to 1.6 %; drawing cycles and leaving them out agree to first order
        assert errors == pytest.approx(getattr(drawn, name).std(axis=1, ddof=1), rel=0.08)
        correlation = covariance / np.outer(errors, errors)
        assert np.corrcoef(getattr(drawn, name)) == pytest.approx(correlation, abs=0.1)


def test_the_length_of_the_line_and_its_errors(common):
    _, whole, _, drawn = common
    line = microstick_of(whole.fit)
    length, error = line["length_m"], line["standard_error_m"]
    assert line["resolved"]
    assert abs(length - 2.0 * PAPER.F_k / PAPER.K_z) < 4.0 * error
    lengths = drawn.X[0] + drawn.X_s[0]
    # as three records of a few dozen cycles know their scatter
    assert error == pytest.approx(lengths.std(ddof=1), rel=0.2)
    # 97.5 % of a distribution that is nearly normal
    assert line["upper_bound_m"] - length == pytest.approx(1.96 * error, rel=0.05)


def test_without_an_oscillator_there_is_no_line(common):
    unfitted = with_common_fit(common[0], CommonFit(None))
    line = microstick_of(None)
    assert not line.pop("resolved")
    assert all(map(math.isnan, line.values()))
    f = features_left_out(unfitted)[0]
    assert np.isnan(f.X_s).all()
    np.testing.assert_array_equal(f.a, 4.0 * f.X)


def test_the_jackknife_of_a_mean_is_the_variance_of_the_mean():
    """The jackknife variance of the mean of n numbers is s²/n, exactly; records add up."""
    records = [np.random.default_rng(i).normal(size=(2, 9)) for i in range(2)]
    left = [(one.sum(axis=1, keepdims=True) - one) / 8.0 for one in records]
    expected = np.cov(records[0]) / 9.0 + np.cov(records[1]) / 9.0
    np.testing.assert_allclose(jackknifed(left), expected, rtol=1e-12)
