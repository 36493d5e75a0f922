"""The mean force of friction at steady speeds, and its fit:

    T = [F_k + F_S e^{−(v/v_S)²}] sgn v + c v + T_0

with the Coulomb friction F_k, the viscous damping c, an offset T_0 (of the sensor, or gravity) and, where the data show
it clearly, a friction that falls with the speed by F_S over v_S (Stribeck). No mass moves and no spring is deflected:
the mean is that of the law alone. The scatter about the law gives the errors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy import special

from ..arrays import Array, Mask
from .climb import Climb
from .errors import inverse_information
from .fit import Fit
from .multistart import Trail, climb_on, multistart
from .parameters import Parameter, Parameters

P_FALL, P_HINT = 1e-3, 0.05
"""Probability that scatter alone looks like a fall, below which it is taken; and below which intervals include it."""

_SPEEDS = 7  # v_S from which climbs start
_FEWEST = 5  # sizes of speeds that may show a fall
_EXACT = 1e-9  # of the range of the force: a scatter below is rounding
_ONE_SPEED = 1e-3  # relative: sizes of speeds that differ by less are one


@dataclass(frozen=True, eq=False)
class SteadySpeeds:
    """Mean forces at steady speeds, (n,) each.

    v : m/s, none of them zero.   F : N.   error : standard errors of F, N, as stated, or all of them one size.
    stated : whether they are.
    """

    v: Array
    F: Array
    error: Array
    stated: bool

    @property
    def both_ways(self) -> bool:
        """Whether some speeds are positive and others negative; else friction and offset are one number."""
        return bool((self.v > 0.0).any() and (self.v < 0.0).any())

    @property
    def sizes(self) -> Array:
        """Sizes of the speeds, m/s, each once, from the smallest on."""
        sizes = np.sort(np.abs(self.v))
        return sizes[np.append(True, np.diff(sizes) > _ONE_SPEED * sizes[1:])]


class SpeedFit(Fit):
    """A fit of the law; χ² counts in the standard errors of the data."""

    @property
    def errors_hold(self) -> bool:
        """Whether the standard errors are stated and cover the scatter, which else gives them."""
        return bool(self.problem.data.stated and self.misfit <= 1.0)

    def freedom_of(self, key: str) -> float:
        """Return the degrees of freedom of the error of a parameter."""
        return math.inf if self.errors_hold else self.freedom


class SpeedProblem(NamedTuple):
    """The law at some steady speeds; its parameters are F_k, c, T_0, F_S and v_S."""

    data: SteadySpeeds

    @property
    def samples(self) -> int:
        """Number of forces."""
        return self.data.v.size

    def thinned(self) -> SpeedProblem:
        """Return the problem: it is small."""
        return self

    def products(self, values: Array, free: Mask, trail: Trail, out: Array) -> bool:
        """Set JᵀJ bordered by Jᵀr and χ², see `fit.multistart`."""
        slopes, left = law(values, self.data.v)[1] * free, self.residuals(values)
        rows = np.column_stack([slopes / self.data.error[:, None], left])
        np.matmul(rows.T, rows, out=out)
        return True

    def residuals(self, values: Array) -> Array:
        """Return model − data in standard errors, (n,)."""
        return (law(values, self.data.v)[0] - self.data.F) / self.data.error

    def fit(self, end: Climb) -> SpeedFit:
        """Return the fit where a climb ended."""
        of = end.parameters
        freedom = self.samples - int(np.count_nonzero(of.free))
        covariance = inverse_information(end.products[:-1, :-1], of.prior)
        rest = end.chi_square, freedom, self, (), end.evaluations, end.promise
        fit = SpeedFit(of, covariance, *rest)
        return fit if fit.errors_hold else replace(fit, covariance=fit.misfit * covariance)


def law(values: Array, v: Array) -> tuple[Array, Array]:
    """Return the force at some speeds, N, (n,), and its derivatives, (n, 5).

    values : F_k, c, T_0, F_S, v_S.   v : m/s, (n,).
    """
    F_S, v_S = values[3:]
    ratio, way = (v / v_S) ** 2, np.sign(v)
    fallen = way * np.exp(-ratio)
    columns = [way, v, np.ones(v.size), fallen, 2.0 * F_S / v_S * ratio * fallen]
    slopes = np.column_stack(columns)
    return slopes[:, :4] @ values[:4], slopes


def starts(data: SteadySpeeds, *, falls: bool) -> list[Parameters]:
    """Return where climbs start, without a force; of a friction that falls at several v_S, each a possible minimum.

    v_S lies between the second speed, so that more than one point shows the fall, and the largest.
    """
    sizes, size = data.sizes, float(np.abs(data.F).max())
    low, high = float(sizes[min(1, sizes.size - 1)]), float(sizes[-1])
    line = Parameters.of(
        [
            Parameter("F_k", 0.0, scale=_EXACT * size),
            Parameter("c", 0.0, free=sizes.size > 1, scale=_EXACT * size / high),
            Parameter("T_0", 0.0, free=data.both_ways, scale=_EXACT * size),
            Parameter("F_S", 0.0, low=0.0, free=falls, scale=_EXACT * size),
            Parameter("v_S", high, low=low, high=high, free=falls, scale=high),
        ]
    )
    if not falls:
        return [line]
    return [line.moved(v_S=v_S) for v_S in np.geomspace(low, high, _SPEEDS).tolist()]


def fit_speeds(data: SteadySpeeds) -> tuple[SpeedFit, SpeedFit | None, float]:
    """Return the fit without a fall of the friction, the one with it, and the probability that scatter alone gains as
    much, by an F test of two parameters; None and 1 where too few speeds show it.

    That the best v_S is looked for makes gains by scatter larger, and that friction only falls makes every other one
    zero: together the test rejects as often as it says.
    """
    problem = SpeedProblem(data)
    (line, *_) = multistart(problem, starts(data, falls=False))
    if data.sizes.size < _FEWEST or line.freedom < 3.0:
        return line, None, 1.0
    (fall, *_) = multistart(problem, starts(data, falls=True))
    gain = (line.chi_square - fall.chi_square) / 2.0
    exact = _EXACT * float(np.abs(data.F).max() / data.error.min())
    left = max(fall.misfit, exact**2)
    p = float(special.fdtrc(2.0, fall.freedom, max(0.0, gain / left)))
    if not data.stated:  # the climb is to end close to the optimum in terms of the scatter about it
        own = SpeedProblem(replace(data, error=data.error * math.sqrt(left)))
        end = climb_on(own, fall.parameters)
        fall = fall if end is None else own.fit(end)
    return line, fall, p


def with_scatter(v: Array, F: Array, stated: Array | None) -> SteadySpeeds:
    """Return data with their standard errors: as stated, else the scatter about the line."""
    data = SteadySpeeds(v, F, np.ones(v.size) if stated is None else stated, stated is not None)
    if stated is None:
        slopes = law(np.array([0.0, 0.0, 0.0, 0.0, 1.0]), v)[1][:, : 2 + data.both_ways]
        left = F - slopes @ np.linalg.lstsq(slopes, F)[0]
        scatter = float(np.linalg.norm(left)) / math.sqrt(max(1, v.size - slopes.shape[1]))
        size = max(scatter, _EXACT * float(np.abs(F).max()))
        data = SteadySpeeds(v, F, np.full(v.size, size), stated=False)
    return data
