"""The law of friction at steady speeds: its derivatives, its errors, and when a fall is taken.

The truth is T = [F_k + F_S e^{−(v/v_S)²}] sgn v + c v + T_0 with white noise of known size.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom

from dampbalance.fit.friction_speed import SteadySpeeds, fit_speeds, law
from dampbalance.fit.multistart import Trail

TRUE = {"F_k": 0.9, "c": 3.4, "T_0": -0.3}
NOISE = 0.03


def table(seed, pairs=60, noise=NOISE, F_S=0.0, v_S=0.02, c_2=0.0):
    """Pairs of speeds from 0.001 to 0.31 rad/s, and their torques, N m."""
    speeds = np.linspace(0.001, 0.31, pairs)
    v = np.concatenate([speeds, -speeds])
    exact = law(np.array([*TRUE.values(), F_S, v_S, c_2]), v)[0]
    return v, exact + noise * np.random.default_rng(seed).normal(size=v.size)


def speeds(seed, *of, **more):
    v, F = table(seed, *of, **more)
    return SteadySpeeds(v, F, np.ones(v.size))


def test_the_law_is_that_of_the_docstring():
    v = np.array([-0.3, -0.01, 0.02, 0.2])
    F_k, c, T_0, F_S, v_S, c_2 = values = np.array([0.9, 3.4, -0.3, 0.5, 0.02, 1.7])
    expected = (F_k + F_S * np.exp(-((v / v_S) ** 2)) + c_2 * v**2) * np.sign(v) + c * v + T_0
    np.testing.assert_allclose(law(values, v)[0], expected, rtol=1e-14)
    for j, step in enumerate(1e-6 * np.eye(6)):
        slope = (law(values + step, v)[0] - law(values - step, v)[0]) / 2e-6
        np.testing.assert_allclose(law(values, v)[1][:, j], slope, atol=1e-7)


def test_what_is_held_has_no_part_in_the_products():
    problem, out = speeds(0), np.empty((7, 7))
    values, free = np.array([1.0, 3.0, 0.0, 0.1, 0.1, 0.0]), np.arange(6) % 3 != 2
    assert problem.products(values, free, Trail(), out)
    left = law(values, problem.v)[0] - problem.F
    assert out[-1, -1] == pytest.approx(left @ left, rel=1e-14)
    assert not out[[2, 5]].any()
    assert out[:-1, -1][free].all()


@pytest.mark.parametrize("stated", [False, True], ids=["scatter", "stated"])
@pytest.mark.parametrize(("pairs", "F_S"), [(60, 0.0), (5, 0.0), (60, 0.5)])
def test_intervals_hold_the_truth_as_often_as_they_say(pairs, F_S, stated):
    runs, held = 150, dict.fromkeys(TRUE, 0)
    for seed in range(runs):
        data = speeds(seed, pairs, F_S=F_S)
        error = np.full(data.v.size, NOISE)
        fit, _, p = fit_speeds(data._replace(error=error, stated=True) if stated else data)
        assert fit.has("F_S") == bool(F_S) or p > 1e-5
        for key, true in TRUE.items():
            low, high = fit.interval(key)
            held[key] += low < true < high
    # stated errors are widened to the scatter where that is larger: they hold a little more often
    least, most = binom.ppf([1e-4, 1.0 - 1e-4], runs, 0.95)
    assert all(least <= n <= (runs if stated else most) for n in held.values()), held


def test_scatter_looks_like_a_fall_as_rarely_as_the_test_says():
    chances = [fit_speeds(speeds(seed, 20))[2] for seed in range(300)]
    low, high = binom.ppf([1e-4, 1.0 - 1e-4], 300, [0.02, 0.06])
    assert low <= np.count_nonzero(np.array(chances) < 0.05) <= high
    assert min(chances) > 1e-6


@pytest.mark.parametrize("F_S", [0.0, 0.5])
def test_a_table_without_noise_gives_its_law(F_S):
    fit, others, _ = fit_speeds(speeds(0, 12, 0.0, F_S, 0.1))
    assert not others
    assert fit.has("F_S") == bool(F_S)
    for key, true in {**TRUE, **({"F_S": F_S, "v_S": 0.1} if F_S else {})}.items():
        assert fit.value(key) == pytest.approx(true, rel=1e-7), key


def test_the_units_of_the_data_do_not_matter():
    data = speeds(1, 20, F_S=0.5, v_S=0.05)
    one, _, p = fit_speeds(data)
    other, _, p_other = fit_speeds(data._replace(v=1e4 * data.v, F=1e-6 * data.F))
    assert other.value("F_k") == pytest.approx(1e-6 * one.value("F_k"), rel=1e-4)
    assert other.value("c") == pytest.approx(1e-10 * one.value("c"), rel=1e-4)
    assert other.error("c") == pytest.approx(1e-10 * one.error("c"), rel=1e-3)
    assert np.log(p_other) == pytest.approx(np.log(p), rel=1e-3)


def test_a_quadratic_damper_is_in_the_intervals_where_it_looks_like_a_fall():
    held = 0
    for seed in range(20):
        fit, others, _ = fit_speeds(speeds(seed, 60, 0.1, c_2=6.0))
        low, high = np.transpose([one.interval("F_k") for one in (fit, *others)])
        held += low.min() < TRUE["F_k"] < high.max()
    assert held >= binom.ppf(1e-4, 20, 0.95)
