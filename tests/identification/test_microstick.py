"""Features of all records with one microstick line: what moves it in one record moves it in all."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.fit.errors import jackknifed
from dampbalance.identification.balance_rows import features_left_out, features_of
from dampbalance.identification.forced import microstick_of
from dampbalance.identification.oscillator import CommonFit, common_fit, with_common_fit
from identification.levels import read
from paper_case import PAPER, orbits_at


@pytest.fixture(scope="module")
def readings():
    return read(orbits_at(3.5, (0.004, 0.008, 0.012)))


@pytest.fixture(scope="module")
def whole(readings):
    return common_fit([reading.lines for reading in readings], PAPER.k)


@pytest.fixture(scope="module")
def shared(readings, whole):
    return with_common_fit(readings, whole)


@pytest.fixture(scope="module")
def left(shared):
    """Features without one group of rows of one record after the other."""
    return features_left_out(shared)


@pytest.fixture(scope="module")
def drawn(shared):
    """Features of 2,000 means of cycles drawn with replacement, (3, 2000)."""
    random = np.random.default_rng(1)
    return features_of(shared, [reading.resampled(2000, random) for reading in shared])


def test_there_is_one_line_whatever_is_left_out(shared, left):
    for f in (features_of(shared, [reading.mean for reading in shared]), *left):
        length = f.X + f.X_s
        # the other records follow to first order: ρ moves by 1e-2 of itself at most
        np.testing.assert_allclose(length, length[:1] * np.ones_like(length), rtol=2e-4)
        # with one slip onset per half cycle a = 4X − 2L, whatever moves; slopes by differences of 1e-6
        np.testing.assert_allclose(f.a, 2.0 * (f.X - f.X_s), rtol=1e-8)
        np.testing.assert_allclose(f.X_r, -f.X_s, rtol=1e-12)
        np.testing.assert_allclose(f.V_r, -f.V_s, rtol=1e-12)
    assert len(left) == 3


@pytest.mark.parametrize("name", ["X_s", "V_s", "t_s", "a"])
def test_leaving_out_rows_of_every_record_gives_the_scatter_of_drawn_cycles(left, drawn, name):
    covariance = jackknifed([getattr(part, name) for part in left])
    # 2,000 drawings know it to 1.6 %; drawing cycles and leaving them out agree to first order
    scatter = getattr(drawn, name).std(axis=1, ddof=1)
    assert np.sqrt(np.diag(covariance)) == pytest.approx(scatter, rel=0.08)
    assert np.corrcoef(getattr(drawn, name)) == pytest.approx(
        covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance))), abs=0.1
    )


def test_the_length_of_the_line_and_its_errors(whole, drawn):
    line = microstick_of(whole.fit)
    length, error = line["length_m"], line["standard_error_m"]
    assert line["resolved"]
    assert abs(length - 2.0 * PAPER.F_k / PAPER.K_z) < 4.0 * error
    lengths = drawn.X[0] + drawn.X_s[0]
    # as three records of a few dozen cycles know their scatter
    assert error == pytest.approx(lengths.std(ddof=1), rel=0.2)
    # 97.5 % of a distribution that is nearly normal
    assert line["upper_bound_m"] - length == pytest.approx(1.96 * error, rel=0.05)


def test_without_an_oscillator_there_is_no_line(readings):
    unfitted = with_common_fit(readings, CommonFit(None))
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
