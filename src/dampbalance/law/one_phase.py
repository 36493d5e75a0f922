"""One phase of motion under any damping law, by DOP853 with located events: what `response.py` puts together.

    m ẍ + k(x − y) + Σ p_j h_j(ẋ, ẏ) + K_z z = 0,      ż = ẋ in stick, |z| ≤ Z_m;   z = Z_m sgn ẋ in slip

A phase lasts to the next velocity reversal or onset of slip: the mass moves one way, and no force has a kink.
Displacement is carried as the gain since its start, so that micrometres of stick are resolved beside millimetres of
motion; time in units of 1/ω_n, so that a root finder's smallest step is small beside the period.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq

from ..arguments import instance, mapping, number
from ..arrays import Array
from ..model import BaseMotion, Oscillator
from .terms import FRICTION, Term, parted, term

_RTOL, _ATOL = 1e-13, 1e-15  # of a step; the latter of the size of the motion
_STEP = 0.1  # rad of the fastest oscillation: dense output, of order 7, is then good to 1e-14
_SHORTER = 0.1  # what a step is multiplied by where a phase would end as it begins
_ROUNDING = 8.0 * np.finfo(float).eps  # of the forces: no more is their sum where they balance
_LATER = 1e-3  # rad

Point = tuple[float, float, float]
"""(x, ẋ, z); m, m/s, m."""


@dataclass(frozen=True, eq=False)
class Equation:
    """The equation of motion.

    oscillator : what moves.   motion : of the base; None at rest.   law : (p_j, term) besides friction.
    """

    oscillator: Oscillator
    motion: BaseMotion | None
    law: tuple[tuple[float, Term], ...]

    @property
    def omega(self) -> float:
        """ω, rad/s; 0 with the base at rest."""
        return self.motion.omega if self.motion else 0.0

    @property
    def Y(self) -> float:
        """Amplitude of the base, m; 0 with the base at rest."""
        return self.motion.Y if self.motion else 0.0

    def damping(self, v: Array | float, w: Array | float) -> Any:
        """Σ p_j h_j at velocities ẋ and ẏ, N."""
        k, total = self.oscillator.k, 0.0
        for p, one in self.law:
            assert one.force is not None
            total = total + p * one.force(v, w, k, self.omega)
        return total

    def slope(self, v: float, w: float) -> float:
        """Σ p_j ∂h_j/∂ẋ, N s/m."""
        k, total = self.oscillator.k, 0.0
        for p, one in self.law:
            assert one.slope is not None
            total += p * float(one.slope(v, w, k, self.omega))
        return total

    def base(self, theta: Array | float) -> tuple[Array, Array]:
        """y and ẏ at a phase of the base, m, m/s."""
        return self.Y * np.cos(theta), -self.omega * self.Y * np.sin(theta)

    def acceleration(
        self, x: Array | float, v: Array | float, z: Array | float, theta: Array | float
    ) -> Array:
        """ẍ at a phase of the base, m/s²."""
        o, (y, w) = self.oscillator, self.base(theta)
        return (o.k * (y - x) - o.K_z * z - self.damping(v, w)) / o.m


def equation(
    oscillator: Oscillator, motion: BaseMotion | None, law: Mapping[str, float]
) -> Equation:
    """The equation of motion under a law: symbol → coefficient of the terms besides friction and the oscillator's c.

    Raises ValueError naming the term: unknown, a coefficient that is negative or no number, one that the oscillator has
    already, structural damping with the base at rest.
    """
    instance("oscillator", oscillator, Oscillator)
    if motion is not None:
        instance("motion", motion, BaseMotion)
    coefficients = mapping("law", law, "a mapping of symbols to coefficients")
    for symbol, p in coefficients.items():
        words = term(symbol).words
        if parted(symbol)[1] is not None:
            raise ValueError(f"{symbol} is the {words} of a group of records: name the term alone")
        if symbol in (FRICTION, "c"):
            raise ValueError(
                f"the {words} is that of the oscillator: set Oscillator.{symbol}, not the law's"
            )
        coefficients[symbol] = number("given", p, f"{symbol} ({words})")
    if motion is None and coefficients.get("eta", 0.0) > 0.0:
        raise ValueError(
            "structural damping eta is a force at the frequency of a drive, and the base is at rest: set Oscillator.c "
            "to eta k/ω of the frequency that is meant"
        )
    coefficients = {"c": oscillator.c, **coefficients}
    terms = tuple((p, term(symbol)) for symbol, p in coefficients.items() if p > 0.0)
    return Equation(oscillator, motion, terms)


@dataclass(frozen=True, eq=False)
class Piece:
    """One phase of motion.

    s : state of the contact, ±1 in slip, 0 in stick.   z : at the start, m.   duration : s.   end : state at its end.
    derivative : of the state at the end by that at the start, times what was given to be carried along, (3, n).
    """

    s: float
    z: float
    duration: float
    end: Point
    derivative: Array
    _solution: OdeSolution | None
    _clock: float

    def gain(self, since: Array) -> tuple[Array, Array]:
        """Displacement since the start and velocity, m, m/s, at times since the start, s, (n,)."""
        if self._solution is None:
            return np.zeros_like(since), np.zeros_like(since)
        u, v = self._solution(self._clock * since)[:2]
        return u, v


def follow(eq: Equation, start: Point, theta: float, limit: float, carried: Array) -> Piece:
    """The phase that starts at a state and base phase θ, rad, to its event, or to `limit`, s.

    carried : changes of the state at the start, (3, n), n ≥ 0, that are followed along.
    """
    x, v, z = start
    o, clock, per_radian = eq.oscillator, eq.oscillator.omega_n, eq.omega / eq.oscillator.omega_n
    d = _direction(eq, start, theta)
    if d == 0.0:
        return Piece(0.0, z, limit, (x, 0.0, z), carried, None, clock)
    s = d if d * z >= o.Z_m else 0.0
    sticks = s == 0.0
    z, kappa = (z, o.k + o.K_z) if sticks else (s * o.Z_m, o.k)
    n = carried.shape[1]
    apart = (carried[2] - carried[0]) * sticks  # z − x keeps its change in stick

    def acceleration(tau: float, q: Array) -> float:
        deflection = z + q[0] if sticks else z
        return float(eq.acceleration(x + q[0], q[1], deflection, theta + per_radian * tau))

    def rate(tau: float, q: Array) -> Array:
        rates = np.empty_like(q)
        rates[0], rates[1] = q[1], acceleration(tau, q)
        if n:
            dx, dv = q[2 : 2 + n], q[2 + n :]
            slope = eq.slope(q[1], float(eq.base(theta + per_radian * tau)[1]))
            rates[2 : 2 + n] = dv
            rates[2 + n :] = -(kappa * dx + o.K_z * apart + slope * dv) / o.m
        return rates / clock

    turn = _Event(lambda tau, q: d * q[1], direction=-1.0)
    onset = _Event(lambda tau, q: d * (z + q[0]) - o.Z_m if sticks else -1.0, direction=1.0)
    fastest = max(eq.omega, math.sqrt(kappa / o.m))
    size = max(abs(x), abs(v) / fastest, o.k * eq.Y / (kappa + o.m * eq.omega**2))
    size = min(size, 2.0 * o.Z_m) if sticks else size
    longest = _STEP * clock / fastest
    while True:
        found: Any = solve_ivp(
            rate,
            (0.0, limit * clock),
            np.concatenate([[0.0, v], carried[0], carried[1]]),
            method="DOP853",
            rtol=_RTOL,
            atol=_ATOL * np.concatenate([[size, size * fastest], np.ones(n), np.full(n, fastest)]),
            max_step=longest,
            dense_output=True,
            events=(turn, onset, acceleration),
        )
        if not found.success:
            raise ArithmeticError(f"the motion of {o} could not be followed: {found.message}")
        (turns, onsets, extrema), tau = found.t_events, found.t[-1]
        missed = _turn_before(extrema, tau, d, found.sol)
        tau = missed or tau
        if tau > 0.0:
            break
        longest *= _SHORTER
    q = found.sol(tau)
    turned, slipped = missed is not None or turns.size > 0, missed is None and onsets.size > 0
    z_end = d * o.Z_m if slipped else float(z + q[0] * sticks)
    end = float(x + q[0]), 0.0 if turned else float(q[1]), z_end
    dx, dv = q[2 : 2 + n], q[2 + n :]
    dz = (dx + apart) * sticks
    ended = turned or slipped
    duration = float(tau) / clock if ended else limit  # exactly: no phase of rounding is to follow
    return Piece(s, z, duration, end, np.stack([dx, dv, dz]), found.sol, clock)


@dataclass(frozen=True)
class _Event:
    """An event that ends a phase: a function of (τ, q) that passes zero in one direction."""

    function: Callable[[float, Array], float]
    direction: float
    terminal: bool = True

    def __call__(self, tau: float, q: Array) -> float:
        return float(self.function(tau, q))


def _turn_before(extrema: Array, end: float, d: float, sol: OdeSolution) -> float | None:
    """The reversal of a velocity that changes its sign and back within a step, by its extremum on the other side; None
    where there is none.   extrema : their times.   d : direction of the motion."""
    before = 0.0
    for at in extrema[extrema < end]:
        if d * sol(at)[1] < 0.0:
            return float(brentq(lambda tau: sol(tau)[1], before, at, xtol=1e-300))
        before = at
    return None


def _direction(eq: Equation, start: Point, theta: float) -> float:
    """The way in which the mass moves on, +1 or −1; 0 where it rests for good."""
    (x, v, z), o = start, eq.oscillator
    if v != 0.0:
        return math.copysign(1.0, v)
    a = float(eq.acceleration(x, v, z, theta))
    if o.m * abs(a) <= _ROUNDING * (o.k * (abs(x) + eq.Y) + o.K_z * abs(z)):
        if eq.motion is None:
            return 0.0
        a = float(eq.acceleration(x, v, z, theta + _LATER))  # in balance, until the base moves on
    return math.copysign(1.0, a)
