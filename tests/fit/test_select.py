"""Weighed models: Bayes factors against integrals, and the numbers of all against closed forms."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import integrate

from dampbalance.fit.score import departures_from
from dampbalance.fit.select import (
    CLEAR,
    Candidate,
    Prior,
    bayes_factor,
    evidence_of,
    noise_of,
    select,
)


def weighted(y, columns):
    """Least squares of y in unit noise, with columns by name, as a fit."""
    A, names = np.column_stack([*columns.values()]), [*columns]
    covariance = np.linalg.inv(A.T @ A)
    values = covariance @ A.T @ y

    def covariance_of(*keys):
        at = [names.index(key) for key in keys]
        return covariance[np.ix_(at, at)]

    return SimpleNamespace(
        y=y,
        columns=columns,
        matrix=A,
        residual=A @ values - y,
        chi_square=float(np.sum((A @ values - y) ** 2)),
        freedom=float(y.size - len(names)),
        covariance_of=covariance_of,
        value=lambda key: float(values[names.index(key)]),
        error=lambda key: math.sqrt(covariance_of(key)[0, 0]),
    )


T = np.linspace(0.0, 1.0, 40)
ADDED = {"square": T**2, "wave": np.sin(40.0 * T)}
OWN = ("level", "slope")


def candidates(fit, prior, *, to_first_order=True):
    left = {name: of for name, of in ADDED.items() if name not in fit.columns}
    tested = departures_from(fit.residual, fit.matrix, left, [*fit.columns], noise_known=True)

    def refit(name):
        return lambda: weighted(fit.y, fit.columns | {name: ADDED[name]})

    return [
        Candidate(one.symbol, prior, refit(one.symbol), one if to_first_order else None)
        for one in tested
    ]


def line(seed, **sizes):
    noise = np.random.default_rng(seed).standard_normal(T.size)
    y = 3.0 + 2.0 * T + noise + sum(size * ADDED[name] for name, size in sizes.items())
    return weighted(y, {"level": np.ones(T.size), "slope": T})


@pytest.mark.parametrize("positive", [False, True])
@pytest.mark.parametrize(("value", "error"), [(0.3, 0.1), (-0.2, 0.15), (0.02, 2.0)])
def test_a_bayes_factor_is_the_ratio_of_two_integrals(positive, value, error):
    prior = Prior(0.03, 0.5, "", positive)
    factor, mean, variance = bayes_factor(value, error, prior)

    def normal(v, mean, sigma):
        return math.exp(-0.5 * ((v - mean) / sigma) ** 2) / (math.sqrt(2.0 * math.pi) * sigma)

    def density(v):
        inside = (v > 0.0) * 2.0 if positive else 1.0
        return inside * normal(v, 0.0, prior.size) * normal(v, value, error)

    def moment(n):
        low = 0.0 if positive else -8.0
        return integrate.quad(lambda v: v**n * density(v), low, 8.0, points=[0.0, value])[0]

    # to the accuracy of the quadrature
    expected = math.log(moment(0) / normal(0.0, value, error))
    assert factor == pytest.approx(expected, abs=1e-6)
    of_one = np.array([value]), np.array([[error**2]]), [prior.size]
    several = evidence_of(value**2 / error**2, *of_one, positive=positive)
    assert several == pytest.approx(factor, rel=1e-12, abs=1e-12)
    assert mean == pytest.approx(moment(1) / moment(0), rel=1e-6)
    assert variance == pytest.approx(moment(2) / moment(0) - mean**2, rel=1e-5)


def test_first_order_and_fit_agree_where_the_model_is_linear():
    fit, prior = line(1, square=1.5), Prior(0.03, 3.0, "")
    first, fitted = (
        select(fit, candidates(fit, prior, to_first_order=to), OWN) for to in (True, False)
    )
    for name in ("", "square", "wave"):
        # but for the prior, which pulls what is known to first order a little
        assert first.weight(name) == pytest.approx(fitted.weight(name), rel=1e-6, abs=1e-9)
    assert math.fsum(first.weights) == pytest.approx(1.0)


def test_a_departure_that_is_there_takes_all_and_a_second_one_is_found_from_it():
    fit, prior = line(2, square=30.0, wave=8.0), Prior(0.03, 10.0, "")
    found = select(
        *(fit, candidates(fit, prior), OWN),
        further=lambda end, names: candidates(end, prior),
    )
    assert {*found.names} == {"square", "wave"}
    assert found.fit.value("slope") == pytest.approx(2.0, abs=4.0 * found.fit.error("slope"))
    assert found.weight(found.departures[0]) == 1.0
    assert found.plain is fit


def test_what_is_not_told_apart_widens_the_numbers_by_the_distance_of_the_models():
    fit, prior = line(3), Prior(0.2, 3.0, "")
    found = select(fit, candidates(fit, prior), OWN)
    off = np.array([model.values - found.values for model in found.models])
    own = np.array([model.covariance for model in found.models])
    w = np.array(found.weights)
    assert found.values == pytest.approx(
        sum(a * m.values for a, m in zip(w, found.models, strict=True))
    )
    expected = np.einsum("j,jab->ab", w, own) + np.einsum("j,ja,jb->ab", w, off, off)
    assert found.covariance == pytest.approx(expected)
    assert found.covariance[1, 1] > fit.covariance_of("slope")[0, 0]
    assert max(found.weight(name) for name in ADDED) < CLEAR


def test_what_no_model_explains_scales_the_errors():
    assert noise_of(40.0, 40.0) == 1.0
    assert noise_of(4000.0, 40.0) == pytest.approx(100.0)
    assert noise_of(4000.0, 40.0, independent=4.0) == pytest.approx(1.0 + 99.0 * 10.0)
    rough = line(4)
    rough = weighted(rough.y + 10.0 * np.sign(np.sin(170.0 * T)), rough.columns)
    found = select(rough, candidates(rough, Prior(0.03, 3.0, "")), OWN)
    assert found.noise > 50.0
    assert found.covariance[0, 0] >= found.noise * rough.covariance_of("level")[0, 0]
    # a departure is there for certain, and the plain model has no better a claim than all candidates
    assert found.models[0].share == pytest.approx(sum(one.share for one in found.models[1:]))
