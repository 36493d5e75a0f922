"""The mean force of friction at steady speeds, and its fit:

    T = F_k tanh(v/v_0) + F_S e^{−|v/v_S|^δ} sgn v + c v + c_2 v|v| + T_0

with the Coulomb friction F_k, the viscous damping c and an offset T_0 (of the sensor, or gravity). Departures are
weighed by their evidence (`select.py`): a friction that falls with the speed by F_S over v_S (Stribeck), δ = 2 or 1,
one that is rounded at rest over v_0, else tanh(v/v_0) = sgn v, and a quadratic damper. No mass moves and no spring is
deflected: the mean is that of the law alone. The scatter about the best law gives the errors. With χ² of n rows by the
line and by a law, and ν degrees of freedom of the line, the Bayes factor of that law is

    B = (1 + n)^{(ν − 1)/2} (1 + n χ²/χ_0²)^{−ν/2}

(Zellner's prior with the information of one row; Liang, Paulo, Molina, Clyde & Berger, J. Am. Stat. Assoc. 103, 2008):
the size of a departure counts, and not where it lies, which a small one leaves open.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask
from .errors import inverse_information
from .fit import Fit
from .multistart import Trail, climb_on
from .parameters import Parameter, Parameters
from .select import PRIORS, Candidate, Selection, select

_FALL = "F_S", "v_S"
DEPARTURES = {"F_S": _FALL, "exponential": _FALL, "v_0": ("v_0",), "c_2": ("c_2",)}
"""Departures from the line with their unknowns."""

_SPEEDS = 7  # v_S and v_0 from which climbs start
_SHARP = 0.2  # v_0 over the smallest speed: a smaller one does not show
_FALLEN = 0.33  # v_S over the largest speed, at which an exponential has fallen to 5 %
_FEWEST = 5  # sizes of speeds that may show a departure
_EXACT = 1e-9  # of the range of the force: a scatter below is rounding
_ONE_SPEED = 1e-3  # relative: sizes of speeds that differ by less are one


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

        v_S lies between the second speed, so that more than one point shows the fall, and the largest; v_0 below that.
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
            Parameter("v_0", 0.0, high=high, free=False, scale=high),
            Parameter("delta", 2.0, free=False),
        ]
        return Parameters.of(some).freed(*further)

    def fit(self, start: Parameters) -> SpeedFit:
        """Return the fit that a climb from a start finds."""
        end = climb_on(self, start, gain=0.0)
        assert end is not None
        freedom = self.v.size - int(np.count_nonzero(start.free))
        covariance = inverse_information(end.products[:-1, :-1], start.prior)
        return SpeedFit(end.parameters, covariance, end.chi_square, freedom, self)

    def law_with(self, departure: str) -> SpeedFit:
        """Return the best fit of the law with a departure."""
        unknowns = DEPARTURES[departure]
        blank, speed = self.start(*unknowns), unknowns[-1]
        if departure == "c_2":
            return self.fit(blank)
        own, (low, high) = np.array(blank.names) == speed, (blank[speed].low, blank[speed].high)
        low = max(low, _SHARP * float(self.sizes[0]))
        if departure == "exponential":  # slower ones are a part of c
            high, blank = max(low, _FALLEN * high), blank.moved(delta=1.0)
        blank = replace(
            blank, low=np.where(own, low, blank.low), high=np.where(own, high, blank.high)
        )
        tried = np.geomspace(max(low, float(self.sizes[0])), high, _SPEEDS).tolist()
        ends = [self.fit(blank.moved(**{speed: at})) for at in tried]
        return min(ends, key=lambda fit: fit.chi_square)


class SpeedFit(Fit):
    """A fit of the law; its problem has the data, in whose standard errors χ² counts."""

    def freedom_of(self, key: str) -> float:
        """Return the degrees of freedom of the error of a parameter: none are lost where errors are stated and cover
        the scatter, which else gives them."""
        return math.inf if self.problem.stated else self.freedom

    @property
    def left(self) -> Array:
        """Force of the law less that of the data, N, (n,)."""
        return law(self.point, self.problem.v)[0] - self.problem.F

    def has(self, key: str) -> bool:
        """Return whether the data determine a parameter, by this law."""
        return self.parameters[key].free


def law(values: Array, v: Array) -> tuple[Array, Array]:
    """Return the force at some speeds, N, (n,), and its derivatives, (n, 8).

    values : F_k, c, T_0, F_S, v_S, c_2, v_0, δ.   v : m/s, (n,).
    """
    F_k, c, T_0, F_S, v_S, c_2, v_0, delta = values
    ratio, way, nothing = np.abs(v / v_S) ** delta, np.sign(v), np.zeros(v.size)
    fallen = way * np.exp(-ratio)
    rounded = np.tanh(v / v_0) if v_0 > 0.0 else way
    of_v_0 = -F_k * v / v_0**2 * (1.0 - rounded**2) if v_0 > 0.0 else nothing
    force = F_k * rounded + c * v + T_0 + F_S * fallen + c_2 * v * np.abs(v)
    columns = [rounded, v, np.ones(v.size), fallen, delta * F_S / v_S * ratio * fallen]
    return force, np.column_stack([*columns, v * np.abs(v), of_v_0, nothing])


def fit_speeds(data: SteadySpeeds) -> Selection:
    """Return the line and each law with a departure, with their weights, for F_k and c."""
    line, fits = data.fit(data.start()), dict[str, SpeedFit]()
    if data.sizes.size >= _FEWEST and line.freedom >= 3.0:
        # in one direction the offset may hide any rounding
        shown = [name for name in DEPARTURES if data.both_ways or name != "v_0"]
        fits = {name: data.law_with(name) for name in shown}
    least = (_EXACT * float(np.abs(data.F).max() / data.error.min())) ** 2
    noise = max(min(fit.misfit for fit in (line, *fits.values())), least)
    # stated errors that cover the scatter count
    covered = data.stated and noise <= 1.0
    noise = 1.0 if covered else noise
    data = data._replace(error=data.error * math.sqrt(noise), stated=covered)
    line, *others = (
        replace(
            fit, covariance=noise * fit.covariance, chi_square=fit.chi_square / noise, problem=data
        )
        for fit in (line, *fits.values())
    )
    n = float(data.v.size)

    def evidence(fit: SpeedFit) -> float:
        share = (fit.chi_square + least / noise) / (line.chi_square + least / noise)
        return 0.5 * ((line.freedom - 1.0) * math.log1p(n) - line.freedom * math.log1p(n * share))

    candidates = [
        Candidate(name, PRIORS[f"steady {name}"], partial(replace, fit), evidence=evidence)
        for name, fit in zip(fits, others, strict=True)
    ]
    return select(line, candidates, ("F_k", "c"))
