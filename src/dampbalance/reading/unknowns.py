"""The unknowns of a fit of one oscillator to n records: their places in a point, and the motion that follows.

Common to all records, or to a group of them, are the coefficients of the law, ρ = K_z^{−1/2}, the mass m and a delay; Y
and the phase ψ of the base are each record's own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, Complexes
from ..law.law import Law
from ..law.steady import Response, steady_response
from ..law.terms import FRICTION, KNOWN_TERMS
from ..model import BaseMotion, Oscillator
from .lines import Lines

OTHERS = ("rho", "m", "delay")
"""Common unknowns in addition to the coefficients of the law."""

_STEP = 1e-6  # of the finite differences: orbits are exact to 1e-13
_LEAST = 2e-2  # of √(km): damping that sets the step where that of the point is smaller


@dataclass(frozen=True)
class Unknowns:
    """Names and places of the unknowns of `law` for so many records; the stiffness k, N/m, is given."""

    law: Law
    records: int
    k: float

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the common unknowns: the keys of the coefficients, and `OTHERS`."""
        return (*self.law.keys, *OTHERS)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.names) + 2 * self.records

    @cached_property
    def _places(self) -> list[dict[str, int]]:
        places = []
        for i in range(self.records):
            common = {s: self.names.index(self.law.key(s, i)) for s in self.law.terms}
            others = {name: self.names.index(name) for name in OTHERS}
            own = len(self.names) + 2 * i
            places.append(common | others | {"Y": own, "psi": own + 1})
        return places

    @cached_property
    def _further(self) -> tuple[str, ...]:
        return tuple(symbol for symbol in self.law.terms if symbol not in (FRICTION, "c"))

    def at(self, record: int) -> dict[str, int]:
        """Places of the unknowns of a record: those of its law by symbol, rho, m, delay, Y and psi."""
        return self._places[record]

    def friction(self, points: Array) -> Array:
        """F_k of points, (p, …), N; the mean over the groups, where it has some."""
        places = [self.names.index(key) for key in self.law.keys_of(FRICTION)]
        return points[places].mean(axis=0)

    def response(
        self, point: Array, record: int, omega: float, near: Response | None = None
    ) -> Response:
        """The motion of a record at ω, rad/s.   near : a motion from which to start."""
        at, value = self.at(record), point.tolist()
        c = value[at["c"]] if "c" in at else 0.0
        oscillator = Oscillator(
            m=value[at["m"]], c=c, k=self.k, K_z=value[at["rho"]] ** -2, F_k=value[at[FRICTION]]
        )
        law = {symbol: value[at[symbol]] for symbol in self._further}
        return steady_response(oscillator, BaseMotion(value[at["Y"]], omega), law, near)

    def steps(self, point: Array, record: int, one: Lines) -> dict[str, float]:
        """Steps of differences by the common unknowns of a record: a part of each, or of what matters near zero."""
        at = self.at(record)
        m, rho = float(point[at["m"]]), float(point[at["rho"]])
        shortest = 1e-2 / (one.omega * math.sqrt(m))  # sticks for about 1e-2 of a cycle
        parts = {FRICTION: float(point[at[FRICTION]]), "rho": max(rho, shortest), "m": m}
        small = _LEAST * math.sqrt(self.k * m)
        for symbol in self.law.terms:
            if symbol != FRICTION:
                least = small * equivalent_coefficient(symbol, one, self.k)
                parts[symbol] = max(float(point[at[symbol]]), least)
        return {name: _STEP * part for name, part in parts.items()}

    def harmonics(
        self,
        point: Array,
        record: int,
        one: Lines,
        response: Response,
        count: int,
        *,
        quickly: bool,
    ) -> tuple[Complexes, Complexes]:
        """Harmonics n = 1, 3 … of a record, turned by ψ, m, (count,), and their derivatives, (count, unknowns).

        By the common unknowns from neighbouring motions. By Y because x is homogeneous: of degree one in Y and in
        p_j^{1/(1 − d_j)}, d_j the order of the term, so that Y ∂x/∂Y = x − Σ (1 − d_j) p_j ∂x/∂p_j.

        quickly : from the equations of a nonlinear law where there are some, accurate to 1e-3 or so. Choose that during
        a search, and differences for standard errors.
        """
        at = self.at(record)
        n = np.arange(1, 2 * count, 2)
        turn = np.exp(1j * n * point[at["psi"]])
        x = response.harmonics(count)
        slope = np.zeros((count, point.size), dtype=np.complex128)
        known = response.slopes(count, self.law.terms) if quickly else None
        if known is not None:
            known["rho"] = -2.0 * point[at["rho"]] ** -3 * known.pop("K_z")
            for name, by in known.items():
                slope[:, at[name]] = by
        else:
            for name, step in self.steps(point, record, one).items():
                neighbour = self.response(
                    _moved(point, at[name], step), record, one.omega, response
                )
                slope[:, at[name]] = (neighbour.harmonics(count) - x) / step
        slope[:, at["Y"]] = self._by_base(point, record, x, slope)
        slope[:, at["psi"]] = 1j * n * x
        return x * turn, slope * turn[:, None]

    def onset(
        self, point: Array, record: int, one: Lines, response: Response
    ) -> tuple[Array, Array]:
        """(V_s, t_s, λ), SI, λ = 4X − a, and their derivatives, (3, unknowns)."""
        at = self.at(record)
        onset, slope = onset_of(response), np.zeros((3, point.size))
        for name, step in self.steps(point, record, one).items():
            neighbour = self.response(_moved(point, at[name], step), record, one.omega, response)
            slope[:, at[name]] = (onset_of(neighbour) - onset) / step
        degree = np.array([1.0, 0.0, 1.0])
        slope[:, at["Y"]] = self._by_base(point, record, degree * onset, slope)
        return onset, slope

    def _by_base(self, point: Array, record: int, value: Any, slope: Any) -> Any:
        at = self.at(record)
        for symbol in self.law.terms:
            power = 1 - KNOWN_TERMS[symbol].order
            if power:
                value = value - power * point[at[symbol]] * slope[:, at[symbol]]
        return value / point[at["Y"]]

    def start(self, lines: Sequence[Lines], candidate: Array, relative: Array) -> Array:
        """The point of an oscillator (F_k, c, K_z, m) of `lines.starts`.

        relative : friction of each record over F_k.   The work of c is shared out among the terms that are not given.
        """
        F_k, c, K_z, m = candidate.tolist()
        law, point = self.law, np.zeros(self.size)
        free = [s for s in law.terms if s != FRICTION and s not in law.given]
        equivalents = {
            s: float(np.median([equivalent_coefficient(s, one, self.k) for one in lines]))
            for s in law.terms
        }
        known = math.fsum(p / equivalents[s] for s, p in law.given.items() if s != FRICTION)
        for i, one in enumerate(lines):
            at = self.at(i)
            point[at[FRICTION]] = law.given.get(FRICTION, F_k * relative[i])
            for s in law.terms[1:]:
                share = max(c - known, 0.0) / max(1, len(free)) * equivalents[s]
                point[at[s]] = law.given.get(s, share)
            point[at["rho"]], point[at["m"]], point[at["Y"]] = K_z**-0.5, m, one.Y
        return point

    def lower(self, point: Array, lines: Sequence[Lines], rigid: float) -> Array:
        """Least values of the unknowns around a point.   rigid : least ρ."""
        least = np.full(self.size, -math.inf)
        for i, one in enumerate(lines):
            at = self.at(i)
            for symbol in self.law.terms:
                least[at[symbol]] = 0.0
            least[at[FRICTION]] = 1e-9 * point[at[FRICTION]]
            least[at["rho"]], least[at["m"]] = rigid, 1e-6 * point[at["m"]]
            least[at["Y"]] = 1e-3 * one.Y
        return least

    def scale(self, point: Array, lines: Sequence[Lines]) -> Array:
        """Sizes below which the unknowns count as zero."""
        scale = np.ones(self.size)
        for i, one in enumerate(lines):
            at = self.at(i)
            m = point[at["m"]]
            for symbol in self.law.terms[1:]:
                scale[at[symbol]] = (
                    1e-3 * math.sqrt(self.k * m) * equivalent_coefficient(symbol, one, self.k)
                )
            for name, size in ((FRICTION, 1.0), ("rho", 1e-3), ("m", 1.0)):
                scale[at[name]] = size * point[at[name]]
            scale[at["Y"]] = one.Y
        scale[self.names.index("delay")] = 1e-3 / max(one.omega for one in lines)
        return scale


def equivalent_coefficient(symbol: str, one: Lines, k: float) -> float:
    """Coefficient of a term that dissipates about as much in a record as a damper of 1 N s/m, from its fundamental."""
    harmonic = KNOWN_TERMS[symbol].harmonic
    if harmonic is None:
        return 1.0
    X = abs(one.x[0])
    viscous: float = math.pi * one.omega * X**2
    return viscous / float(harmonic(one.omega, X, 0.0, 0.0, k))


def onset_of(response: Response) -> Array:
    """(V_s, t_s, λ), SI."""
    return np.array([response.V_s, response.t_s, response.taken])


def _moved(point: Array, j: int, step: float) -> Array:
    """The point with one unknown changed."""
    moved = point.copy()
    moved[j] += step
    return moved
