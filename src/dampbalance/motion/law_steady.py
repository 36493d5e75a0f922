"""The steady response to harmonic base motion under any law: an exact orbit, or a motion by collocation.

Terms that are linear in ẋ and ẏ only change the numbers of an oscillator that has an exact orbit:

    c ẋ + c_r(ẋ − ẏ) + η(k/ω)ẋ + …  :   damper c + c_r + ηk/ω,   base Re (1 + iωc_r/k) Y e^{iωt}

With others, N(ẋ) = Σ p_j h_j(ẋ), the half cycle from the reversal at −X on solves

    m ẍ + c_l ẋ + N(ẋ) + k x + f = kY cos(ωt + θ),   x = −X, ẋ = 0 at t = 0,   x = X, ẋ = 0 at t = π/ω,

c_l of the linear terms; f = −F_k + K_z(x + X) until it reaches F_k at t_s, and F_k from there. Unknown are X, θ, t_s
and ẍ at Gauss's points of both phases, whose integrals are ẋ and x (collocation: Hairer, Nørsett & Wanner, Solving
Ordinary Differential Equations I, II.7). No kink is inside a phase. Newton's method starts from the orbit with a linear
damper of nearly the same work, c_l + c_e.

Forces of a spring and a contact that are not those of the oscillator (`Further`) are solved for in the same way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from ..arguments import numbers
from ..arrays import Array, Complexes, Integers, Mask
from ..law.terms import term
from ..model import BaseMotion, Oscillator
from .distorted import distorted_harmonics
from .events import MOST_RADIANS
from .nearby import steady_orbit_near
from .orbit import NoSteadyOrbit, Orbit, steady_orbit
from .regime import Regime
from .states import State
from .steady_harmonics import high_harmonics

# Points of a phase: exact for the 63rd harmonic over half a cycle and more.
_POINTS = 40


@cache
def _rule(points: int) -> tuple[Array, Array, Array]:
    """Return Gauss's points and weights on (0, 1), and the integrals from 0 to each point by the values at all of
    them."""
    nodes, weights, coefficients = _polynomials(points)
    integrals = legendre.legval(nodes, legendre.legint(coefficients, lbnd=-1)).T
    return 0.5 * (1.0 + nodes), 0.5 * weights, np.asarray(0.5 * integrals, dtype=np.float64)


@cache
def _integrals(points: int) -> tuple[Array, Array, Array]:
    """Return Gauss's points and the end, 1, and the first and second integrals from 0 to each by the values at the
    points."""
    nodes, weights, integral = _rule(points)
    once = np.vstack([integral, weights])
    return np.append(nodes, 1.0), once, once @ integral


@cache
def _finer(points: int, more: int) -> tuple[Array, Array, Array]:
    """Return points and weights of a finer rule, and the values at its points by those at the points of a coarse
    one."""
    nodes, weights, _ = _polynomials(more)
    values = legendre.legval(nodes, _polynomials(points)[2])
    return 0.5 * (1.0 + nodes), 0.5 * weights, np.asarray(values.T)


@cache
def _polynomials(points: int) -> tuple[Array, Array, Array]:
    """Return Gauss's points and weights on (−1, 1), and the coefficients of Legendre's polynomials by values at the
    points."""
    nodes, weights = (np.asarray(of, dtype=np.float64) for of in legendre.leggauss(points))
    n = np.arange(points)
    values = np.asarray(legendre.legvander(nodes, points - 1).T, dtype=np.float64)
    return nodes, weights, (n[:, None] + 0.5) * values * weights


class Further(NamedTuple):
    """Forces that an oscillator lacks, zero by default.

    k_3 : of a spring that is not linear, k_3 x³, N/m³.
    gradual : of a contact that yields gradually, the part of `rounding`: 1 for that of Iwan.
    falling, speed : of a friction force that falls with the speed, F_k(1 + p e^{−|ẋ|/v}): p, and v, m/s.
    """

    k_3: float = 0.0
    gradual: float = 0.0
    falling: float = 0.0
    speed: float = 1.0

    def force(
        self, u: Array, v: Array, X: float, sticks: Mask, o: Oscillator
    ) -> tuple[Array, Array, Array, Array]:
        """Return the forces at x + X = u and ẋ = v ≥ 0 after the reversal at −X, N, and their derivatives by u, v and
        X, (n,) each. In stick, friction acts the way that it did before the turn."""
        part = 0.5 * o.K_z / o.F_k * u * sticks
        falling = o.F_k * self.falling * np.exp(np.minimum(-v / self.speed, 0.0))
        by_x = 3.0 * self.k_3 * (u - X) ** 2
        force = self.k_3 * (u - X) ** 3 + self.gradual * 2.0 * o.F_k * part * (1.0 - part)
        force += np.where(sticks, -o.F_k * self.falling, falling)
        by_u = by_x + self.gradual * o.K_z * (1.0 - 2.0 * part) * sticks
        return force, by_u, np.where(sticks, 0.0, -falling / self.speed), -by_x


NOTHING = Further()
"""No further forces."""


class HalfCycle(NamedTuple):
    """A half cycle from the reversal at −X on: t, x + X, ẋ, ẍ at all points, and their derivatives by the unknowns.

    t, u, v, a : (n,).   by_t, by_u, by_v : (n, q).   at : (t, x + X, ẋ) at the onset of slip and at the end, (2, 3).
    by_at : their derivatives, (2, 3, q).
    """

    t: Array
    u: Array
    v: Array
    a: Array
    by_t: Array
    by_u: Array
    by_v: Array
    at: Array
    by_at: Array


@dataclass(frozen=True, eq=False)
class System:
    """The equations of a half cycle with one onset of slip, or with none.

    orbit : a motion near, whose phases count from its own base.   linear : c_l, N s/m.   others : the other terms.
    lengths : number of points of each phase: in stick and slip, or of the only one.   further : other forces.

    The unknowns q are ẍ at the points, m/s², X, m, β = θ less that of the orbit, rad, and t_s, s, with two phases.
    """

    orbit: Orbit
    linear: float
    others: Mapping[str, float]
    lengths: tuple[int, ...]
    further: Further = NOTHING

    @classmethod
    def of(
        cls, orbit: Orbit, linear: float, others: Mapping[str, float], further: Further = NOTHING
    ) -> Self:
        """Return the equations of the response near an orbit. Raises NoSteadyOrbit for one of a kind that is not
        followed."""
        o, half = orbit.oscillator, 0.5 * orbit.motion.period
        if orbit.regime not in (Regime.ONE_SLIP, Regime.NO_SLIP, Regime.NO_FRICTION):
            raise NoSteadyOrbit(
                "under quadratic or cubic damping, or a spring or contact that is not the oscillator's, only one onset "
                f"of slip per half cycle can be followed, not: {orbit.regime}; raise the excitation, or give linear "
                "terms only"
            )
        stiff, soft = math.sqrt((o.k + o.K_z) / o.m), math.sqrt(o.k / o.m)
        phases = [(half, stiff if orbit.regime == Regime.NO_SLIP else soft)]
        # 1e-11 relative to X: shorter microstick lines are rounding
        if orbit.regime == Regime.ONE_SLIP and o.Z_m >= 1e-11 * orbit.X:
            phases.insert(0, (orbit.t_s, stiff))
        swings = (length * (rate + o.c / o.m) / (2.0 * math.pi) for length, rate in phases)
        points = (_POINTS + 20 * int(min(s, 1e3) / 3.0) for s in swings)
        return cls(orbit, linear, others, tuple(min(n, 400) for n in points), further)

    @property
    def slips(self) -> bool:
        """Whether the contact slips."""
        return self.orbit.regime != Regime.NO_SLIP

    def start(self) -> Array:
        """Return the unknowns in the motion of the orbit."""
        omega, ends = self.orbit.motion.omega, [0.0, 0.5 * self.orbit.motion.period]
        if len(self.lengths) == 2:
            ends.insert(1, self.orbit.t_s)
        t = [ends[i] + (ends[i + 1] - ends[i]) * _rule(n)[0] for i, n in enumerate(self.lengths)]
        a = self.orbit.states(np.concatenate(t) + self.orbit.theta / omega)[2]
        return np.concatenate([a, [self.orbit.X, 0.0], ends[1:-1]])

    def half_cycle(self, q: Array, *, slopes: bool = True) -> HalfCycle:
        """Return the motion that the unknowns describe, from rest.   slopes : whether its derivatives are wanted; else
        none have columns."""
        half, size, first = 0.5 * self.orbit.motion.period, q.size if slopes else 0, 0
        two = len(self.lengths) == 2
        ends = [0.0, q[-1], half] if two else [0.0, half]
        begun, by = np.zeros(3), np.zeros((3, size))
        rows, at, by_at = [], [], []
        for i, n in enumerate(self.lengths):
            tau, once, twice = _integrals(n)
            own, h = slice(first, first + n), ends[i + 1] - ends[i]
            a, by_h = q[own], (1.0 - 2.0 * i) * two
            gained, moved = once @ a, twice @ a
            v, u = begun[2] + h * gained, begun[1] + h * tau * begun[2] + h**2 * moved
            by_t, by_v = np.empty((2, n + 1, size))
            by_t[:], by_v[:] = by[0], by[2]
            by_u = by[1] + (h * tau)[:, None] * by[2]
            if slopes:
                by_v[:, own] += h * once
                by_u[:, own] += h**2 * twice
                by_v[:, -1] += by_h * gained
                by_u[:, -1] += by_h * (tau * begun[2] + 2.0 * h * moved)
                by_t[:, -1] += by_h * tau
            t = ends[i] + h * tau
            whole = (t, u, v, by_t, by_u, by_v)
            rows.append([*(of[:-1] for of in whole), a])
            begun, by = np.array([t[-1], u[-1], v[-1]]), np.stack([by_t[-1], by_u[-1], by_v[-1]])
            at.append(begun)
            by_at.append(by)
            first += n
        t, u, v, by_t, by_u, by_v, a = (np.concatenate(of) for of in zip(*rows, strict=True))
        return HalfCycle(t, u, v, a, by_t, by_u, by_v, np.array(at), np.array(by_at))

    def equations(self, q: Array, *, slopes: bool = True) -> tuple[Array, Array]:
        """Return the residuals of the equations, N, and, where they are wanted, their derivatives."""
        o, motion = self.orbit.oscillator, self.orbit.motion
        of = self.half_cycle(q, slopes=slopes)
        n, X, ends, by_ends = of.t.size, q[of.t.size], of.at, of.by_at
        force, slope = self.linear * of.v, np.full(n, self.linear)
        for symbol, p in self.others.items():
            one = term(symbol)
            assert one.force is not None
            force = force + p * one.force(of.v, 0.0, o.k, motion.omega)
            slope = slope + p * one.slope(of.v, 0.0, o.k, motion.omega)
        contact, stiffness, by_X = self._contact(of, X)
        if self.further != NOTHING:
            sticks = stiffness > 0.0
            # a contact that never slips has no friction that could fall
            what = self.further if self.slips else self.further._replace(falling=0.0)
            more, by_u, by_v, by_more = what.force(of.u, of.v, X, sticks, o)
            contact, stiffness = contact + more, stiffness + by_u
            slope, by_X = slope + by_v, by_X + by_more
        phase = motion.omega * of.t + self.orbit.theta + q[n + 1]
        drive, by_phase = o.k * motion.Y * np.cos(phase), o.k * motion.Y * np.sin(phase)
        left = o.m * of.a + force + o.k * (of.u - X) + contact - drive
        last = [o.k * (ends[-1, 1] - 2.0 * X), o.k / motion.omega * ends[-1, 2]]
        falling = o.Z_m * self.further.falling * math.exp(-ends[0, 2] / self.further.speed)
        if len(self.lengths) == 2:
            limits = 2.0 * o.Z_m + o.Z_m * self.further.falling + falling
            last.append(o.k * (ends[0, 1] - limits))
        left = np.append(left, last)
        if not slopes:
            return left, np.empty((left.size, 0))
        matrix = (o.k + stiffness)[:, None] * of.by_u + slope[:, None] * of.by_v
        matrix += (motion.omega * by_phase)[:, None] * of.by_t
        matrix[:, :n] += o.m * np.eye(n)
        matrix[:, n] += by_X - o.k
        matrix[:, n + 1] += by_phase
        by_last = [o.k * by_ends[-1, 1], o.k / motion.omega * by_ends[-1, 2]]
        by_last[0][n] -= 2.0 * o.k
        if len(self.lengths) == 2:
            by_last.append(o.k * (by_ends[0, 1] + falling / self.further.speed * by_ends[0, 2]))
        return left, np.vstack([matrix, *by_last])

    def harmonics(self, q: Array, count: int) -> Complexes:
        """Return x_n, n = 1, 3 … 2 count − 1, in the phases of the orbit, m, (count,)."""
        omega, half, first = self.orbit.motion.omega, 0.5 * self.orbit.motion.period, 0
        n, x = np.arange(1.0, 2.0 * count, 2.0), np.zeros(count, complex)
        ends = [0.0, q[-1], half] if len(self.lengths) == 2 else [0.0, half]
        for i, points in enumerate(self.lengths):
            # e^{iκs} over (−1, 1) takes κ/2 points and a few, κ < πn/2
            tau, weights, values = _finer(points, points + int(1.7 * count))
            h = ends[i + 1] - ends[i]
            turns = np.exp(-1j * np.outer(n, omega * (ends[i] + h * tau) + self.orbit.theta))
            turns *= -2.0 / (math.pi * omega) / n[:, None] ** 2 * weights
            x += h * turns @ (values @ q[first : first + points])
            first += points
        return x

    def state(self, q: Array, t: Array) -> tuple[Array, Array, Array, Array]:
        """Return (x, ẋ, ẍ, z) at times t after the reversal at −X, 0 to π/ω, s, (n,)."""
        o, at, first = self.orbit.oscillator, self.half_cycle(q, slopes=False).at, 0
        X, begun = q[sum(self.lengths)], np.vstack([np.zeros(3), at])
        x, v, a, z = np.empty((4, t.size))
        phase = np.searchsorted(at[:-1, 0], t, side="right")
        for i, points in enumerate(self.lengths):
            here, h, (start, u_0, v_0) = phase == i, at[i, 0] - begun[i, 0], begun[i]
            tau = (t[here] - start) / h
            series = _polynomials(points)[2] @ q[first : first + points]
            once, twice = (legendre.legint(series, times, lbnd=-1) for times in (1, 2))
            a[here] = legendre.legval(2.0 * tau - 1.0, series)
            v[here] = v_0 + h / 2.0 * legendre.legval(2.0 * tau - 1.0, once)
            gained = h * tau * v_0 + h**2 / 4.0 * legendre.legval(2.0 * tau - 1.0, twice)
            x[here] = u_0 - X + gained
            z[here] = x[here] if not self.slips else o.Z_m
            if i == 0 and len(self.lengths) == 2:
                z[here] = gained - o.Z_m
            first += points
        return x, v, a, z

    def _contact(self, of: HalfCycle, X: float) -> tuple[Array, Array, Array | float]:
        """Return the force of the contact at the points, N, and its derivatives by x + X and X, N/m."""
        o, n = self.orbit.oscillator, of.t.size
        if not self.slips:
            return o.K_z * (of.u - X), np.full(n, o.K_z), -o.K_z
        sticks = np.arange(n) < (self.lengths[0] if len(self.lengths) == 2 else 0)
        force = np.where(sticks, o.K_z * of.u - o.F_k, o.F_k)
        return force, np.asarray(o.K_z * sticks, dtype=np.float64), 0.0


class Solution(NamedTuple):
    """The equations of a response, the unknowns that solve them, and their derivatives there, or near."""

    system: System
    unknowns: Array
    matrix: Array


@dataclass(frozen=True, eq=False)
class Response:
    """The steady response of an oscillator with a law.

    orbit : exact, of the oscillator with the equivalent linear damper.   advance : phase by which the base of that
    orbit leads the real one, rad.   solution : of the equations of the response; None where the orbit is the response.
    """

    orbit: Orbit
    advance: float
    solution: Solution | None = field(default=None, repr=False)

    @property
    def turned(self) -> float:
        """Phase of the base at the reversal less that of the orbit, β, rad."""
        return 0.0 if self._at is None else self._at[1]

    @cached_property
    def _at(self) -> tuple[float, float, float, float] | None:
        """X, β, V_s and t_s of a response that is not its orbit; else None."""
        if self.solution is None:
            return None
        system, q, _ = self.solution
        X, beta, *onset = q[sum(system.lengths) :].tolist()
        V_s = system.half_cycle(q, slopes=False).at[0, 2] if onset else 0.0
        t_s = onset[0] if onset else 0.0
        return (X, beta, float(V_s), t_s) if self.slips else (X, beta, math.nan, math.nan)

    @property
    def slips(self) -> bool:
        """Whether the contact slips."""
        return self.orbit.regime in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS)

    @property
    def X(self) -> float:
        """Peak displacement, m."""
        return self.orbit.X if self._at is None else self._at[0]

    @property
    def V_s(self) -> float:
        """Velocity at the first onset of slip after the reversal at −X, m/s; NaN without slip."""
        return self.orbit.V_s if self._at is None else self._at[2]

    @property
    def t_s(self) -> float:
        """Time from that reversal to the onset, s; NaN without slip."""
        return self.orbit.t_s if self._at is None else self._at[3]

    @property
    def stick_travel(self) -> float:
        """λ = 4X − a, m: what sticking takes from the travel of a cycle."""
        if self.solution is None:
            return 4.0 * self.orbit.X - self.orbit.a
        system, q, _ = self.solution
        if len(system.lengths) == 1:
            return 4.0 * self.orbit.oscillator.Z_m
        return 2.0 * float(system.half_cycle(q, slopes=False).at[0, 1])

    def harmonics(self, count: int) -> Complexes:
        """Return x_n of x = Re Σ x_n e^{inωt}, n = 1, 3 … 2 count − 1, m, shape (count,); y = Y cos ωt."""
        turn = np.exp(1j * np.arange(1, 2 * count, 2) * self.advance)
        if self.solution is not None:
            return self.solution.system.harmonics(self.solution.unknowns, count) * turn
        x = self.orbit.harmonics(count)
        return x * turn if self.advance else x

    def high_harmonics(self, n: Integers) -> Complexes:
        """Return x_n as `harmonics` does, of any odd orders far above the swings of the stuck mass: where this is no
        orbit, those of the orbit with the jump of the jerk that this has at the onset of slip."""
        if not self.slips:
            return np.zeros(n.shape, dtype=np.complex128)
        of, turn = self.orbit, self.advance
        x = high_harmonics(of.phases, of.theta, of.parameters, n)
        if self.solution is not None:
            x *= self.V_s / of.V_s * (1.0 - self.solution.system.further.gradual)
            turn -= of.motion.omega * (self.t_s - of.t_s)
        return x * np.exp(1j * turn * n)

    @property
    def oscillator(self) -> Oscillator:
        """The oscillator with the equivalent linear damper."""
        return self.orbit.oscillator

    @property
    def motion(self) -> BaseMotion:
        """The motion of the base."""
        base = self.orbit.motion
        return BaseMotion(base.Y * math.cos(self.advance + self.turned), base.omega)

    def state(self, t: ArrayLike) -> State:
        """Return (x, ẋ, ẍ, z) at the times t, s, any shape; y = Y cos ωt."""
        times, omega = numbers("t", t), self.orbit.motion.omega
        if self.solution is None:
            return self.orbit.state(times + self.advance / omega)
        half = math.pi / omega
        since = np.mod(times.ravel() + (self.advance - self.orbit.theta) / omega, 2.0 * half)
        mirrored = since >= half
        system, q, _ = self.solution
        state = system.state(q, np.clip(since - half * mirrored, 0.0, half))
        return State(*(np.where(mirrored, -of, of).reshape(times.shape) for of in state))

    @property
    def swings(self) -> float:
        """Number of swings of the mass on contact and spring in half a cycle, while it sticks."""
        (t, s), par = self.orbit.phases.T[:2].tolist(), self.orbit.parameters
        ends = zip(t, [*t[1:], math.pi / par.omega], s, strict=True)
        stuck = math.fsum(end - start for start, end, slips in ends if not slips)
        return stuck * math.sqrt((par.k + par.K_z) / par.m) / (2.0 * math.pi)


def steady_response(
    oscillator: Oscillator,
    motion: BaseMotion,
    law: Mapping[str, float],
    near: Response | None = None,
    *,
    further: Further = NOTHING,
    most_radians: float = MOST_RADIANS,
) -> Response:
    """Return the steady response of an oscillator under a law.

    law : symbol → coefficient of the terms besides friction and c, which are the oscillator's, SI.
    near : a response from which to start.   further : forces besides those of the law and the oscillator.
    most_radians : as for `steady_orbit`, of a law with linear terms only.

    Raises NoSteadyOrbit where there is none, or none with one onset of slip per half cycle under quadratic or cubic
    damping or further forces.
    """
    start = None if near is None else near.orbit
    if not law and further == NOTHING:
        return Response(
            steady_orbit_near(oscillator, motion, start, most_radians=most_radians), 0.0
        )
    omega, k = motion.omega, oscillator.k
    linear, to_base, others = oscillator.c, 0.0, {}
    for symbol, p in law.items():
        one = term(symbol)
        if one.force is not None and one.linear:
            linear += p * float(one.force(1.0, 0.0, k, omega))
            to_base -= p * float(one.force(0.0, 1.0, k, omega))
        elif one.force is not None and p:
            others[symbol] = p
    base = BaseMotion(motion.Y * math.hypot(1.0, omega * to_base / k), omega)
    advance = math.atan2(omega * to_base, k)
    if not others and further == NOTHING:
        own = replace(oscillator, c=linear)
        return Response(steady_orbit_near(own, base, start, most_radians=most_radians), advance)
    if near is not None and near.solution is not None:
        extra = near.orbit.oscillator.c - linear
        orbit = steady_orbit(replace(oscillator, c=linear + max(extra, 0.0)), base)
    else:
        orbit, near = _equivalent(replace(oscillator, c=linear), base, others), None
    system = System.of(orbit, linear, others, further)
    solution = _solved(system, near)
    return Response(orbit, advance - solution.unknowns[sum(system.lengths) + 1], solution)


def _equivalent(oscillator: Oscillator, base: BaseMotion, others: Mapping[str, float]) -> Orbit:
    """Return the orbit with the linear damper that takes nearly the work of the other terms."""
    extra, X = 0.0, base.Y
    # three repetitions bring c_e near that of the response
    for repetition in range(3):
        work = math.fsum(
            float(p * term(s).harmonic(base.omega, X, 0.0, 0.0, oscillator.k))
            for s, p in others.items()
        )
        coefficient = work / (math.pi * base.omega * X**2)
        extra = 0.5 * (extra + coefficient) if repetition else coefficient
        orbit = steady_orbit(replace(oscillator, c=oscillator.c + extra), base)
        X = orbit.X
    return orbit


@np.errstate(over="ignore")  # a step that leads so far is halved like any other
def _solved(system: System, near: Response | None) -> Solution:
    """Return the unknowns of the response and the derivatives of its equations, by Newton's method from the orbit, or
    from a response near; from one that is very near, with its derivatives."""
    orbit, q, n = system.orbit, system.start(), sum(system.lengths)
    if near is not None and near.solution and near.solution.unknowns.size == q.size:
        _, q, matrix = near.solution
        q = q.copy()
        q[n + 1] -= math.remainder(orbit.theta - near.orbit.theta, 2.0 * math.pi)
        step = -np.linalg.solve(matrix, system.equations(q, slopes=False)[0])
        # relative to the unknowns: a step as short, with derivatives from there, leaves its square, 1e-10
        if float(np.abs(step / _scale(q, n)).max()) < 1e-5:
            _require_kind(system, q + step)
            return Solution(system, q + step, matrix)
    left, matrix = system.equations(q)
    # 40 steps
    for _ in range(40):
        step, before, part = -np.linalg.solve(matrix, left), np.linalg.norm(left), 1.0
        size = float(np.abs(step / _scale(q, n)).max())
        if not size < 1e3:
            break
        # relative to the unknowns: a step as short leaves its square, which is rounding
        if size < 1e-8:
            q = q + step
            _require_kind(system, q)
            return Solution(system, q, matrix)
        left, matrix = system.equations(q + step)
        # a step as long is halved until it brings the equations nearer to balance
        # 0.3 relative to the unknowns: a step as long may lead away
        while size > 0.3 and part > 1.0 / 256.0:
            if np.linalg.norm(left) < (1.0 - 0.1 * part) * before and (q + part * step)[n] > 0.0:
                break
            part *= 0.5
            left, matrix = system.equations(q + part * step)
        q = q + part * step
    raise NoSteadyOrbit(
        f"the response under {dict(system.others)} was not found from {orbit.oscillator}"
    )


def _scale(q: Array, n: int) -> Array:
    """Return sizes of the unknowns, of which n are accelerations."""
    return np.append(np.full(n, np.abs(q[:n]).max()), [q[n], 1.0, *q[n + 2 :]])


def _require_kind(system: System, q: Array) -> None:
    """Raise NoSteadyOrbit if a response is not of the kind that was assumed."""
    of, n = system.half_cycle(q, slopes=False), sum(system.lengths)
    if not system.slips and q[n] > system.orbit.oscillator.Z_m:
        raise NoSteadyOrbit("the contact begins to slip under quadratic or cubic damping")
    if not (np.diff(of.t) > 0.0).all():
        raise NoSteadyOrbit("the contact does not slip in every half cycle")
    if not (of.v > 0.0).all():
        raise NoSteadyOrbit("the velocity changes its sign inside a half cycle")


def added_by_base(base: Complexes, response: Response, count: int) -> Complexes:
    """Return Δ_n, n = 1, 3 … 2 count − 1, m: what harmonics of the base add to those of a motion, (count,).

    base : y_n, n = 2, 3 …, m, phases counted from the peak of the fundamental.   response : the motion under the
    fundamental alone.
    """
    n = np.arange(1, 2 * count, 2)
    if not base.any():
        return np.zeros(count, dtype=np.complex128)
    orbit, order = response.orbit, np.arange(2, base.size + 2)
    # a damper to the base moves the mass as well: the base of the orbit is (1 + inω c_r/k) y_n
    to_base = 1.0 + 1j * order * math.tan(response.advance + response.turned)
    y = np.append(orbit.motion.Y, base * to_base * np.exp(-1j * order * response.advance))
    try:
        change = distorted_harmonics(orbit, y, 2 * count)[::2] - orbit.harmonics(count)
    except NoSteadyOrbit:
        # approximately, with a contact that always slips
        own, rates = orbit.oscillator, n * orbit.motion.omega
        forced = np.zeros(2 * count, dtype=np.complex128)
        forced[1 : y.size] = own.k * y[1 : forced.size]
        change = forced[::2] / (own.k - rates**2 * own.m + 1j * rates * own.c)
    return change * np.exp(1j * n * response.advance)
