"""The law of friction at steady speeds: its derivatives, its errors, and how its departures weigh.

The truth is T = F_k tanh(v/v_0) + F_S e^{−|v/v_S|^δ} sgn v + c v + c_2 v|v| + T_0 with white noise of known size.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom

from dampbalance.fit.friction_speed import SteadySpeeds, fit_speeds, law
from dampbalance.fit.multistart import Trail

TRUE = {"F_k": 0.9, "c": 3.4, "T_0": -0.3}
NOISE = 0.03


def table(seed, pairs=60, noise=NOISE, F_S=0.0, v_S=0.02, c_2=0.0, v_0=0.0, delta=2.0):
    """Pairs of speeds from 0.001 to 0.31 rad/s, and their torques, N m."""
    speeds = np.linspace(0.001, 0.31, pairs)
    v = np.concatenate([speeds, -speeds])
    exact = law(np.array([*TRUE.values(), F_S, v_S, c_2, v_0, delta]), v)[0]
    return v, exact + noise * np.random.default_rng(seed).normal(size=v.size)


def speeds(seed, *of, **more):
    v, F = table(seed, *of, **more)
    return SteadySpeeds(v, F, np.ones(v.size))


def held(found, key):
    """Whether the interval of 95 % over all laws holds the truth."""
    at = found.keys.index(key)
    reach = 1.96 * np.sqrt(found.covariance[at, at])
    return bool(abs(found.values[at] - TRUE[key]) < reach)


@pytest.mark.parametrize("delta", [1.0, 2.0])
def test_the_law_is_that_of_the_docstring(delta):
    v = np.array([-0.3, -0.01, 0.02, 0.2])
    values = np.array([0.9, 3.4, -0.3, 0.5, 0.02, 1.7, 0.03, delta])
    F_k, c, T_0, F_S, v_S, c_2, v_0, _ = values
    expected = F_k * np.tanh(v / v_0) + c * v + T_0
    expected += (F_S * np.exp(-(np.abs(v / v_S) ** delta)) + c_2 * v**2) * np.sign(v)
    np.testing.assert_allclose(law(values, v)[0], expected, rtol=1e-14)
    for j, step in enumerate(1e-6 * np.eye(8)[:7]):
        slope = (law(values + step, v)[0] - law(values - step, v)[0]) / 2e-6
        np.testing.assert_allclose(law(values, v)[1][:, j], slope, atol=1e-7)
    sharp, nearly = (np.array([*values[:-2], v_0, delta]) for v_0 in (0.0, 1e-6))
    assert law(sharp, v)[0] == pytest.approx(law(nearly, v)[0])


def test_what_is_held_has_no_part_in_the_products():
    problem, out = speeds(0), np.empty((9, 9))
    values, free = np.array([1.0, 3.0, 0.0, 0.1, 0.1, 0.0, 0.0, 2.0]), np.arange(8) % 3 != 2
    assert problem.products(values, free, Trail(), out)
    left = law(values, problem.v)[0] - problem.F
    assert out[-1, -1] == pytest.approx(left @ left, rel=1e-14)
    assert not out[[2, 5]].any()
    assert out[:-1, -1][free & (np.arange(8) < 6)].all()


@pytest.mark.parametrize(
    ("pairs", "departure", "stated"),
    [(60, {}, False), (5, {}, True), (60, {"F_S": 0.5}, False), (60, {"v_0": 0.02}, True)],
)
def test_intervals_hold_the_truth_as_often_as_they_say(pairs, departure, stated):
    runs, count = 40, np.zeros(2)
    for seed in range(runs):
        data = speeds(seed, pairs, **departure)
        error = np.full(data.v.size, NOISE)
        found = fit_speeds(data._replace(error=error, stated=True) if stated else data)
        count += [held(found, "F_k"), held(found, "c")]
    # not more than chance takes away; laws that are not there make intervals wider
    assert (count >= binom.ppf(1e-4, runs, 0.92 if pairs == 5 else 0.95)).all()


@pytest.mark.parametrize("departure", [{}, {"F_S": 0.5}, {"v_0": 0.02}, {"c_2": 6.0}])
def test_a_departure_that_is_there_has_the_weight_and_where_none_is_none_has(departure):
    names = ("F_S", "exponential") if "F_S" in departure else departure or ("",)
    found = [fit_speeds(speeds(seed, **departure)) for seed in range(10)]
    # noise may make one of ten curves look like another, and three of ten straight lines like a curve
    assert np.mean([sum(map(one.weight, names)) for one in found]) > (0.8 if departure else 0.7)


@pytest.mark.parametrize("departure", [{}, {"F_S": 0.5, "v_S": 0.1}])
def test_a_table_without_noise_gives_its_law_in_any_units(departure):
    data = speeds(0, 12, 0.0, **departure)
    found = fit_speeds(data)
    for key, true in {**TRUE, **departure}.items():
        assert found.fit.value(key) == pytest.approx(true, rel=1e-7), key
    other = fit_speeds(data._replace(v=1e4 * data.v, F=1e-6 * data.F))
    np.testing.assert_allclose(other.values, np.array([1e-6, 1e-10]) * found.values, rtol=1e-4)


def test_a_quadratic_damper_is_in_the_intervals_where_it_looks_like_a_fall():
    count = sum(held(fit_speeds(speeds(seed, 60, 0.1, c_2=6.0)), "F_k") for seed in range(20))
    assert count >= binom.ppf(1e-4, 20, 0.95)
