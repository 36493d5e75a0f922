"""The mean of numbers that scatter by more than the errors of their fit: friction from one release to the next."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import special

from ..arrays import Array
from ..solver import NORMAL_95


class ScatteringMean(NamedTuple):
    """The mean of friction forces that differ from one decay to the next.

    error : its standard error, of the fit and of the scatter together.   interval : of 95 %, with Student's t for the
    scatter.   scatter : standard deviation of the forces; 0 for one.
    """

    value: float
    error: float
    interval: tuple[float, float]
    scatter: float

    @classmethod
    def of(cls, values: Array, covariance: Array) -> ScatteringMean:
        """Return the mean of values with this covariance of their fit, (n, n).

        The error of the fit that is common to all does not show in their scatter, and the scatter is not in the
        covariance: both are added in quadrature, which counts what is independent in the fit twice.
        """
        n, value = values.size, float(values.mean())
        own = math.sqrt(max(float(covariance.sum()), 0.0)) / n
        if n == 1:
            return cls(value, own, (value - NORMAL_95 * own, value + NORMAL_95 * own), 0.0)
        scatter = float(np.std(values, ddof=1))
        of_mean = scatter / math.sqrt(n)
        reach = math.hypot(NORMAL_95 * own, special.stdtrit(n - 1, 0.975) * of_mean)
        return cls(value, math.hypot(own, of_mean), (value - reach, value + reach), scatter)
