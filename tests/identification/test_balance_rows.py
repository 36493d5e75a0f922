"""The solution of correlated rows of the balance, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.balance import Rows
from dampbalance.identification.balance_rows import solved

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
