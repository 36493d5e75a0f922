"""How an oscillator moves under any damping law: integrated phase by phase, its steady response by Newton's method.

    m ẍ + k(x − y) + Σ p_j h_j(ẋ, ẏ) + K_z z = 0,      ż = ẋ in stick, |z| ≤ Z_m;   z = Z_m sgn ẋ in slip

A phase lasts to the next velocity reversal or onset of slip, which DOP853 locates: the mass moves one way, and no force
has a kink. Displacement is carried as the gain since its start, so that micrometres of stick are resolved next to
millimetres of motion; time in units of 1/ω_n, so that a root finder's smallest step is small compared with the period.

Every known h grows with ẋ. The difference of two motions under the same excitation therefore loses energy whatever the
law, as `motion/period_map.py` shows for h = cẋ, and what follows there holds here: one steady velocity, which is its
own mirror image half a period later, and Newton's method on  s ↦ −Φ(s)  to find it, Φ the motion over half a period.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq

from dampbalance.arguments import numbers
from dampbalance.arrays import Array
from dampbalance.law.terms import Term, term
from dampbalance.model import BaseMotion, Oscillator
from dampbalance.motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z
from dampbalance.motion.mirrored import ACCEPTED, mirrored_state, reversal
from dampbalance.motion.orbit import NoSteadyOrbit, steady_orbit
from dampbalance.motion.states import State

_RTOL, _ATOL = 1e-13, 1e-15  # of a step; the latter of the size of the motion
_STEP = 0.1  # rad of the fastest oscillation: dense output, of order 7, is then good to 1e-14
_SHORTER = 0.1  # what a step is multiplied by where a phase would end as it begins
_ROUNDING = 8.0 * np.finfo(float).eps  # of the forces: no more is their sum where they balance
_LATER = 1e-3  # rad

Point = tuple[float, float, float]
"""(x, ẋ, z); m, m/s, m."""

Row = tuple[float, float, float, float, float]
"""(t, s, x, ẋ, z) at the start of a phase."""


@dataclass(frozen=True, eq=False)
class Equation:
    """The equation of motion of an oscillator and its base under a law: (p_j, term) besides friction."""

    oscillator: Oscillator
    motion: BaseMotion
    law: tuple[tuple[float, Term], ...]

    def damping(self, v: Array | float, w: Array | float) -> Any:
        """Σ p_j h_j at velocities ẋ and ẏ, N."""
        at, total = (v, w, self.oscillator.k, self.motion.omega), 0.0
        for p, one in self.law:
            assert one.force is not None
            total = total + p * one.force(*at)
        return total

    def slope(self, v: float, w: float) -> float:
        """Σ p_j ∂h_j/∂ẋ, N s/m."""
        at, total = (v, w, self.oscillator.k, self.motion.omega), 0.0
        for p, one in self.law:
            total += p * float(one.slope(*at))
        return total

    def base(self, theta: Array | float) -> tuple[Array, Array]:
        """y and ẏ at a phase of the base, m, m/s."""
        Y, omega = self.motion.Y, self.motion.omega
        # numbers of Python take a fifth of the time of NumPy's
        of: Any = math if isinstance(theta, float) else np
        return Y * of.cos(theta), -omega * Y * of.sin(theta)

    def acceleration(
        self, x: Array | float, v: Array | float, z: Array | float, theta: Array | float
    ) -> Array:
        """ẍ at a phase of the base, m/s²."""
        o, (y, w) = self.oscillator, self.base(theta)
        return (o.k * (y - x) - o.K_z * z - self.damping(v, w)) / o.m


def equation(oscillator: Oscillator, motion: BaseMotion, law: Mapping[str, float]) -> Equation:
    """The equation of motion under a law: symbol → coefficient of the terms besides friction and the oscillator's c."""
    terms = {"c": oscillator.c, **law}.items()
    return Equation(oscillator, motion, tuple((p, term(symbol)) for symbol, p in terms if p > 0.0))


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
    _solution: OdeSolution

    def gain(self, since: Array, clock: float) -> tuple[Array, Array]:
        """Displacement since the start and velocity, m, m/s, at times since the start, s, (n,).   clock : ω_n."""
        u, v = self._solution(clock * since)[:2]
        return u, v


def follow(eq: Equation, start: Point, theta: float, limit: float, carried: Array) -> Piece:
    """The phase that starts at a state and base phase θ, rad, to its event, or to `limit`, s.

    carried : changes of the state at the start, (3, n), n ≥ 0, that are followed along.
    """
    x, v, z = start
    o, clock, omega = eq.oscillator, eq.oscillator.omega_n, eq.motion.omega
    per_radian, d = omega / clock, _direction(eq, start, theta)
    s = d if d * z >= o.Z_m else 0.0
    sticks = s == 0.0
    z, kappa = (z, o.k + o.K_z) if sticks else (s * o.Z_m, o.k)
    n = carried.shape[1]
    apart = (carried[2] - carried[0]) * sticks  # z − x keeps its change in stick

    def acceleration(tau: float, q: Array) -> float:
        u, v = float(q[0]), float(q[1])
        deflection = z + u if sticks else z
        return float(eq.acceleration(x + u, v, deflection, theta + per_radian * tau))

    def rate(tau: float, q: Array) -> Array:
        of_state = np.array((q[1], acceleration(tau, q))) / clock
        if not n:
            return of_state
        dx, dv = q[2 : 2 + n], q[2 + n :]
        slope = eq.slope(float(q[1]), float(eq.base(theta + per_radian * tau)[1]))
        changes = -(kappa * dx + o.K_z * apart + slope * dv) / o.m
        return np.concatenate([of_state, dv / clock, changes / clock])

    turn = _Event(lambda tau, q: d * q[1], direction=-1.0)
    onset = _Event(lambda tau, q: d * (z + q[0]) - o.Z_m if sticks else -1.0, direction=1.0)
    fastest = max(omega, math.sqrt(kappa / o.m))
    size = max(abs(x), abs(v) / fastest, o.k * eq.motion.Y / (kappa + o.m * omega**2))
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
    return Piece(s, z, duration, end, np.stack([dx, dv, dz]), found.sol)


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
    """The way in which the mass moves on, +1 or −1."""
    (x, v, z), o = start, eq.oscillator
    if v != 0.0:
        return math.copysign(1.0, v)
    a = float(eq.acceleration(x, v, z, theta))
    if o.m * abs(a) <= _ROUNDING * (o.k * (abs(x) + eq.motion.Y) + o.K_z * abs(z)):
        a = float(eq.acceleration(x, v, z, theta + _LATER))  # in balance, until the base moves on
    return math.copysign(1.0, a)


_MOST_PHASES = 16384  # of half a period
_MOST_STEPS = 50  # Newton's method takes four or so, and ten from a state far off
_EQUIVALENCES = 12  # repetitions of the equivalent damper, each of which halves its error or better
_NOTHING = np.empty((3, 0))


@dataclass(frozen=True, eq=False)
class LawOrbit:
    """Steady response under any law, in place of an `Orbit` where a motion is sampled or integrated.

    The half cycle from the reversal at x = −X on; the other half is the mirror image, x(t + T/2) = −x(t).

    oscillator, motion : what moves, and its base.   law : symbol → coefficient, SI, of the terms besides friction and
    c, which are the oscillator's.   theta : phase of the base, ωt, at the reversal at −X, rad.
    phases : (n, 5), rows (t, s, x, ẋ, z) as in `Orbit`, except that a reversal within stick begins a phase as well.
    """

    oscillator: Oscillator
    motion: BaseMotion
    law: Mapping[str, float]
    theta: float
    phases: Array = field(repr=False)
    _pieces: tuple[Piece, ...] = field(repr=False)

    def __post_init__(self) -> None:
        self.phases.flags.writeable = False

    @property
    def X(self) -> float:
        """Peak displacement, m."""
        return -float(self.phases[0, PHASE_X])

    @property
    def a(self) -> float:
        """Distance slid per cycle, m: Eq. (7a)."""
        gained = np.diff(np.append(self.phases[:, PHASE_X], self.X))
        return 2.0 * float(np.abs(gained[self.phases[:, PHASE_S] != 0.0]).sum())

    def state(self, t: ArrayLike) -> State:
        """(x, ẋ, ẍ, z) at the times t, s, any shape; y = Y cos ωt."""
        times, eq = numbers("t", t), equation(self.oscillator, self.motion, self.law)
        half, omega = 0.5 * self.motion.period, self.motion.omega
        since = np.mod(times.ravel() - self.theta / omega, 2.0 * half)
        mirrored = since >= half
        since = np.clip(since - half * mirrored, 0.0, half)
        x, v, z = np.empty((3, since.size))
        rows = np.searchsorted(self.phases[:, PHASE_T], since, side="right") - 1
        for i in np.unique(rows):
            here, began, piece = rows == i, self.phases[i, PHASE_T], self._pieces[i]
            gain, v[here] = piece.gain(since[here] - began, self.oscillator.omega_n)
            x[here] = self.phases[i, PHASE_X] + gain
            z[here] = piece.z + gain * (piece.s == 0.0)
        acceleration = eq.acceleration(x, v, z, self.theta + omega * since)
        state = (np.where(mirrored, -row, row) for row in (x, v, acceleration, z))
        return State(*(row.reshape(times.shape) for row in state))


def law_orbit(oscillator: Oscillator, motion: BaseMotion, law: Mapping[str, float]) -> LawOrbit:
    """The steady response under a law, in any regime, closed to 1e-12 of its size or better.

    law : symbol → coefficient, SI, of the terms besides friction and c, which are the oscillator's.

    Raises NoSteadyOrbit where there is none (nothing is lost, at resonance) or none was found.
    """
    eq = equation(oscillator, motion, law)
    state = _fixed_point(eq, _nearby(eq))
    if state is None:
        raise NoSteadyOrbit(
            f"found no steady response, mirrored half a period later, of {oscillator} under {motion} "
            f"and the law {dict(law)}: there is one wherever energy is lost; add damping, or leave the resonance"
        )
    rows = [np.array(row) for row in _phases(eq, state, motion.period, 0.0)[0]]
    turned = reversal(rows, motion.period)
    assert turned is not None, "a phase ends with each reversal"
    t, (x, v, z) = turned
    theta = motion.omega * t
    half_cycle, pieces = _phases(eq, (x, v, z), 0.5 * motion.period, theta)
    phases = np.array(_until_closed(half_cycle, oscillator))
    return LawOrbit(oscillator, motion, dict(law), theta, phases, tuple(pieces[: len(phases)]))


def _until_closed(rows: Sequence[Row], o: Oscillator) -> Sequence[Row]:
    """The phases of a half cycle without those at its end that start when it has closed: rounding lets the reversal
    come early, or leaves a velocity at the end, and neither is a phase of the motion."""
    states = np.array(rows)[:, [PHASE_X, PHASE_V, PHASE_Z]] * _weights(o)
    away = np.linalg.norm(states + states[0], axis=1) > ACCEPTED * np.linalg.norm(states[0])
    return rows[: 1 + int(np.flatnonzero(away)[-1])]


def _phases(
    eq: Equation, state: Point, end: float, theta: float, carried: Array = _NOTHING
) -> tuple[list[Row], list[Piece]]:
    """The phases of the motion up to a time, s, as rows (t, s, x, ẋ, z) of their starts and as pieces.

    state : at t = 0.   theta : phase of the base there, rad.   carried : as for `follow`.
    """
    t, rows, pieces = 0.0, list[Row](), list[Piece]()
    while t < end:
        if len(rows) > _MOST_PHASES:
            raise NoSteadyOrbit(
                f"more than {_MOST_PHASES} events in half a period of {eq.oscillator}"
            )
        piece = follow(eq, state, theta + eq.motion.omega * t, end - t, carried)
        rows.append((t, piece.s, state[0], state[1], piece.z))
        pieces.append(piece)
        state, carried = piece.end, piece.derivative
        t = end if piece.duration >= end - t else t + piece.duration
    return rows, pieces


def _nearby(eq: Equation) -> Point:
    """State at base phase 0 of the steady response with the linear damper that takes as much as the law does from a
    harmonic motion: exact for linear laws, some percent off for others."""
    o, motion = eq.oscillator, eq.motion
    omega, X = motion.omega, motion.Y
    # damping that goes with the velocity of the base turns and enlarges what drives
    dragged = -omega * float(eq.damping(0.0, 1.0)) / o.k
    base = BaseMotion(motion.Y * math.hypot(1.0, dragged), omega)
    try:
        for _ in range(_EQUIVALENCES):
            work = 0.0
            for p, one in eq.law:
                work += p * float(one.harmonic(omega, X, 0.0, 0.0, o.k))
            orbit = steady_orbit(replace(o, c=work / (math.pi * omega * X**2)), base)
            X = math.sqrt(X * orbit.X)
    except (NoSteadyOrbit, OverflowError):
        return 0.0, 0.0, 0.0
    state = orbit.state(math.atan(dragged) / omega)
    return float(state.x), float(state.v), float(np.clip(state.z, -o.Z_m, o.Z_m))


def _fixed_point(eq: Equation, start: Point) -> Point | None:
    """The state s at base phase 0 with Φ(s) = −s, by Newton's method from there; None if it is not found."""
    weights = _weights(eq.oscillator)
    s = mirrored_state(partial(_closure, eq), np.array(start), weights, _MOST_STEPS)
    return None if s is None else (float(s[0]), float(s[1]), float(s[2]))


def _closure(eq: Equation, s: Array) -> tuple[Array, Array]:
    """s + Φ(s) and its derivative, (3, 3). The forces are continuous across events, so that changes of the state pass
    them as they are, except that of z, which slip wipes out."""
    start = float(s[0]), float(s[1]), float(s[2])
    last = _phases(eq, start, 0.5 * eq.motion.period, 0.0, np.eye(3))[1][-1]
    return s + np.array(last.end), np.eye(3) + last.derivative


def _weights(o: Oscillator) -> Array:
    """Return the factors that make the norm of a state (x, ẋ, z) the root of twice its energy."""
    return np.sqrt([o.k, o.m, o.K_z])
