"""The mean force of friction at steady speeds, and its fit:

    T = [F_k + F_S e^{−(v/v_S)²}] sgn v + c v + T_0

with the Coulomb friction F_k, the viscous damping c, an offset T_0 (of the sensor, or gravity) and, where the data show
it clearly, a friction that falls with the speed by F_S over v_S (Stribeck). No mass moves and no spring is deflected:
the mean is that of the law alone. The scatter about the law gives the errors. A quadratic damper, c_2 v|v|, is fitted
in place of the fall to see whether it explains the data as well.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import special

from ..arrays import Array, Mask
from .errors import inverse_information
from .fit import Fit
from .multistart import Trail, climb_on
from .parameters import Parameter, Parameters

_P_FALL, _P_HINT = 1e-3, 0.05  # of scatter: a fall is taken, and the intervals include one
_SPEEDS = 7  # v_S from which climbs start
_FEWEST = 5  # sizes of speeds that may show a fall
_EXACT = 1e-9  # of the range of the force: a scatter below is rounding
_ONE_SPEED = 1e-3  # relative: sizes of speeds that differ by less are one
_ALIKE = 10.0  # of χ²: a law that leaves so much more than another one is as likely as scatter


class SteadySpeeds(NamedTuple):
    """Mean forces at steady speeds, (n,) each, and the law of them.

    v : m/s, none of them zero.   F : N.   error : standard errors of F, N, as stated, else ones.   stated : whether
    they are.
    """

    v: Array
    F: Array
    error: Array
    stated: bool = False

    @property
    def both_ways(self) -> bool:
        """Whether some speeds are positive and others negative; else friction and offset are one number."""
        return bool((self.v > 0.0).any() and (self.v < 0.0).any())

    @property
    def sizes(self) -> Array:
        """Sizes of the speeds, m/s, each once, from the smallest on."""
        sizes = np.sort(np.abs(self.v))
        return sizes[np.append(True, np.diff(sizes) > _ONE_SPEED * sizes[1:])]

    def products(self, values: Array, free: Mask, trail: Trail, out: Array) -> bool:
        """Set JᵀJ bordered by Jᵀr and χ², see `fit.multistart`."""
        force, slopes = law(values, self.v)
        rows = np.column_stack([slopes * free, force - self.F]) / self.error[:, None]
        np.matmul(rows.T, rows, out=out)
        return True

    def start(self, *further: str) -> Parameters:
        """Return where a climb starts, without a force.   further : parameters beyond the line that are free.

        v_S lies between the second speed, so that more than one point shows the fall, and the largest.
        """
        sizes, scale = self.sizes, _EXACT * float(np.abs(self.F).max())
        low, high = float(sizes[min(1, sizes.size - 1)]), float(sizes[-1])
        some = [
            Parameter("F_k", 0.0, scale=scale),
            Parameter("c", 0.0, free=sizes.size > 1, scale=scale / high),
            Parameter("T_0", 0.0, free=self.both_ways, scale=scale),
            Parameter("F_S", 0.0, low=0.0, free=False, scale=scale),
            Parameter("v_S", high, low=low, high=high, free=False, scale=high),
            Parameter("c_2", 0.0, free=False, scale=scale / high**2),
        ]
        return Parameters.of(some).freed(*further)

    def fit(self, start: Parameters) -> SpeedFit:
        """Return the fit that a climb from a start finds."""
        end = climb_on(self, start, gain=0.0)
        assert end is not None
        freedom = self.v.size - int(np.count_nonzero(start.free))
        covariance = inverse_information(end.products[:-1, :-1], start.prior)
        if not self.stated or end.chi_square > freedom:
            covariance = covariance * end.chi_square / max(freedom, 1)
        return SpeedFit(end.parameters, covariance, end.chi_square, freedom, self)


class SpeedFit(Fit):
    """A fit of the law; its problem has the data, in whose standard errors χ² counts."""

    def freedom_of(self, key: str) -> float:
        """Return the degrees of freedom of the error of a parameter: none are lost where errors are stated and cover
        the scatter, which else gives them."""
        return math.inf if self.problem.stated and self.misfit <= 1.0 else self.freedom

    @property
    def left(self) -> Array:
        """Force of the law less that of the data, N, (n,)."""
        return law(self.point, self.problem.v)[0] - self.problem.F

    @property
    def noise(self) -> Array:
        """Standard errors of the forces, N, (n,), as stated, else the scatter about the law, rounding at the least."""
        data = self.problem
        least = _EXACT * float(np.abs(data.F).max())
        return data.error * (1.0 if data.stated else max(math.sqrt(self.misfit), least))

    def has(self, key: str) -> bool:
        """Return whether the data determine a parameter, by this law."""
        return self.parameters[key].free


def law(values: Array, v: Array) -> tuple[Array, Array]:
    """Return the force at some speeds, N, (n,), and its derivatives, (n, 6).

    values : F_k, c, T_0, F_S, v_S, c_2.   v : m/s, (n,).
    """
    F_k, c, T_0, F_S, v_S, c_2 = values
    ratio, way = (v / v_S) ** 2, np.sign(v)
    fallen = way * np.exp(-ratio)
    force = F_k * way + c * v + T_0 + F_S * fallen + c_2 * v * np.abs(v)
    columns = [way, v, np.ones(v.size), fallen, 2.0 * F_S / v_S * ratio * fallen, v * np.abs(v)]
    return force, np.column_stack(columns)


def fit_speeds(data: SteadySpeeds) -> tuple[SpeedFit, list[SpeedFit], float]:
    """Return the fit, others that explain the data about as well and that intervals are to include, and the probability
    that scatter alone gains as much by a fall, by an F test of two parameters; 1 where too few speeds show it.

    That the best v_S is looked for makes gains by scatter larger, and that friction only falls makes every other one
    zero: together the test rejects as often as it says.
    """
    line, blank = data.fit(data.start()), data.start("F_S", "v_S")
    if data.sizes.size < _FEWEST or line.freedom < 3.0:
        return line, [], 1.0
    speeds = np.geomspace(blank["v_S"].low, blank["v_S"].high, _SPEEDS).tolist()
    falls = [data.fit(blank.moved(v_S=v_S)) for v_S in speeds]
    fall = min(falls, key=lambda fit: fit.chi_square)
    left = max(fall.misfit, (_EXACT * float(np.abs(data.F).max() / data.error.min())) ** 2)
    gain = (line.chi_square - fall.chi_square) / 2.0
    p = float(special.fdtrc(2.0, fall.freedom, max(0.0, gain / left)))
    if p >= _P_HINT:
        return line, [], p
    quadratic = data.fit(data.start("c_2"))
    alike = quadratic.chi_square < fall.chi_square + _ALIKE * left
    others = [quadratic] if alike else []
    return (fall, others, p) if p < _P_FALL else (line, [fall, *others], p)
