"""Tails of the distributions of noise against SciPy's."""

import math

import numpy as np
import pytest
from scipy import special

from dampbalance.reading.chances import f_tail, normal_tail, t_quantile, t_tail

DRAWN = np.random.default_rng(7).uniform(size=(300, 3)).tolist()


def relative(freedom: float) -> float:
    """The rounding of ln Γ of so many degrees of freedom, a few times over."""
    return 1e-12 + 1e-14 * freedom


@pytest.mark.parametrize(("u", "v", "w"), DRAWN)
def test_tails_and_quantile_are_those_of_scipy(u: float, v: float, w: float) -> None:
    first, rest = 10.0 ** (4.0 * u), 10.0 ** (4.0 * v)
    ratio, t, chance = 10.0 ** (3.0 * w - 2.0), 12.0 * w - 6.0, 10.0 ** (-0.31 - 6.0 * u)
    within = relative(first + rest)
    assert f_tail(first, rest, ratio) == pytest.approx(
        # what is below 1e-280 is as good as zero
        special.fdtrc(first, rest, ratio),
        rel=1e3 * within,
        abs=1e-280,
    )
    assert t_tail(rest, t) == pytest.approx(special.stdtr(rest, -t), rel=1e2 * within)
    assert t_quantile(rest, chance) == pytest.approx(
        -special.stdtrit(rest, chance), rel=1e2 * within
    )
    assert normal_tail(t) == pytest.approx(special.ndtr(-t), rel=1e-13)


def test_without_end_students_distribution_is_the_normal_one() -> None:
    assert t_tail(math.inf, 1.3) == normal_tail(1.3)
    assert t_quantile(math.inf, 0.025) == pytest.approx(-special.ndtri(0.025), rel=1e-14)


def test_without_freedom_there_is_no_probability() -> None:
    assert all(map(math.isnan, (f_tail(0, 5, 1.0), f_tail(3, 0, 1.0), f_tail(3, 5, math.nan))))
    assert math.isnan(t_quantile(math.nan, 0.025))
    assert f_tail(3, 5, 0.0) == 1.0
    assert f_tail(3, 5, math.inf) < 1e-280
