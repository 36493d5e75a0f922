"""How an oscillator moves under any damping law: integrated phase by phase, its steady response by Newton's method.

    m ẍ + k(x − y) + Σ p_j h_j(ẋ, ẏ) + K_z z = 0,      ż = ẋ in stick, |z| ≤ Z_m;   z = Z_m sgn ẋ in slip

A phase lasts to the next velocity reversal or onset of slip, which DOP853 locates: the mass moves one way, and no force
has a kink. Displacement is carried as the gain since its start, so that micrometres of stick are resolved beside
millimetres of motion; time in units of 1/ω_n, so that a root finder's smallest step is small beside the period.

Every known h grows with ẋ. The difference of two motions under the same excitation therefore loses energy whatever the
law, as `motion/period_map.py` shows for h = cẋ, and what follows there holds here: one steady velocity, which is its
own mirror image half a period later, and Newton's method on  s ↦ −Φ(s)  to find it, Φ the motion over half a period.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq

from ..arguments import SMALLEST, instance, mapping, number, numbers
from ..arrays import Array
from ..model import BaseMotion, Oscillator
from ..motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.states import State
from ..motion.transient import start_and_span
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


_MOST_PHASES = 16384  # of half a period
_MOST_STEPS = 50  # Newton's method takes four or so, and ten from a state far off
_CONVERGED = 1e-14  # energy norm of s + Φ(s), relative to that of s
_ACCEPTED = 1e-12  # like `_CONVERGED`, where rounding stops the descent
_SINGULAR = 1e-9  # of 1 + ∂Φ/∂s, about π times the damping ratio: less is rounding
_EQUIVALENCES = 12  # repetitions of the equivalent damper, each of which halves its error or better
_NOTHING = np.empty((3, 0))
_MOST_RADIANS = 3e5  # a few minutes of computing


@dataclass(frozen=True, eq=False)
class LawTrajectory:
    """Motion from an initial state under any law, phase by phase.

    oscillator, motion : what moves, and its base; None for a base at rest.   law : symbol → coefficient, SI, of the
    terms besides friction and c, which are the oscillator's.   theta : phase of the base at t = 0, rad.
    phases : (n, 5), rows (t, s, x, ẋ, z) at the start of each phase as in `motion.transient.Trajectory`, except that a
    reversal within stick begins a phase as well.   end : time up to which the motion was computed, s.
    """

    oscillator: Oscillator
    motion: BaseMotion | None
    law: Mapping[str, float]
    theta: float
    phases: Array = field(repr=False)
    end: float
    _pieces: tuple[Piece, ...] = field(repr=False)

    def __post_init__(self) -> None:
        self.phases.flags.writeable = False

    @cached_property
    def _equation(self) -> Equation:
        return equation(self.oscillator, self.motion, self.law)

    @property
    def turns(self) -> Array:
        """The rows of `phases` that begin with a velocity reversal: the turning points."""
        return self.phases[1:][self.phases[1:, PHASE_V] == 0.0]

    @property
    def onsets(self) -> Array:
        """The rows of `phases` that begin with an onset of slip."""
        slips = self.phases[:, PHASE_S] != 0.0
        return self.phases[1:][slips[1:] & ~slips[:-1]]

    def state(self, t: ArrayLike) -> State:
        """(x, ẋ, ẍ, z) at the times t, s, any shape, within the span of the trajectory; ValueError outside it."""
        times = numbers("t", t)
        start = self.phases[0, PHASE_T]
        if times.size and not (times.min() >= start and times.max() <= self.end):
            raise ValueError(f"times must lie within [{start}, {self.end}] s")
        flat = times.ravel()
        x, v, z = np.empty((3, flat.size))
        rows = np.searchsorted(self.phases[:, PHASE_T], flat, side="right") - 1
        for i in np.unique(rows):
            here, began, piece = rows == i, self.phases[i, PHASE_T], self._pieces[i]
            gain, v[here] = piece.gain(flat[here] - began)
            x[here] = self.phases[i, PHASE_X] + gain
            z[here] = piece.z + gain * (piece.s == 0.0)
        theta = self.theta + self._equation.omega * flat
        acceleration = self._equation.acceleration(x, v, z, theta)
        return State(*(row.reshape(times.shape) for row in (x, v, acceleration, z)))


@dataclass(frozen=True, eq=False)
class LawOrbit(LawTrajectory):
    """Steady response under any law, in place of an `Orbit` where a motion is sampled or integrated.

    The fields are those of its half cycle from the reversal at x = −X on, with times from there; the other half is the
    mirror image, x(t + T/2) = −x(t).
    """

    motion: BaseMotion

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
        times = numbers("t", t)
        half = 0.5 * self.motion.period
        since = np.mod(times - self.theta / self.motion.omega, 2.0 * half)
        mirrored = since >= half
        state = super().state(np.clip(since - half * mirrored, 0.0, self.end))
        return State(*(np.where(mirrored, -row, row) for row in state))


def law_transient(
    oscillator: Oscillator,
    motion: BaseMotion | None,
    law: Mapping[str, float],
    end: float,
    *,
    x: float = 0.0,
    v: float = 0.0,
    z: float = 0.0,
    start: float = 0.0,
) -> LawTrajectory:
    """The motion under a law from the state (x, ẋ, z) at time `start` to `end`, s.

    motion : y = Y cos ωt; None for a base at rest.
    law : symbol → coefficient, SI, of the terms besides friction and c, which are the oscillator's.
    x : displacement, m.   v : velocity, m/s.   z : deflection of the contact spring, m, |z| ≤ Z_m.

    Raises ValueError for a law that makes no sense (see `equation`), what is no number, a state that the
    contact cannot have, an end before the start, a motion that takes too long to follow.
    """
    eq = equation(oscillator, motion, law)
    (x, v, z), span = start_and_span(oscillator, (x, v, z), (start, end))
    x, v = (one if abs(one) > SMALLEST else 0.0 for one in (x, v))  # else it underflows
    speed = max(abs(v), abs(x) * oscillator.omega_n, eq.omega * eq.Y)
    _require_followed(eq, span[1] - span[0], speed)
    return _trajectory(eq, law, (x, v, z), span, 0.0)


def law_orbit(oscillator: Oscillator, motion: BaseMotion, law: Mapping[str, float]) -> LawOrbit:
    """The steady response under a law, in any regime, closed to 1e-12 of its size or better.

    law : symbol → coefficient, SI, of the terms besides friction and c, which are the oscillator's.

    Raises NoSteadyOrbit where there is none (nothing is lost, at resonance) or none was found, ValueError for a law
    that makes no sense (see `equation`) and a motion that takes too long to follow.
    """
    eq = equation(oscillator, instance("motion", motion, BaseMotion), law)
    _require_followed(eq, motion.period, eq.omega * eq.Y)
    state = _fixed_point(eq, motion, _nearby(eq, motion))
    if state is None:
        raise NoSteadyOrbit(
            f"found no steady response, mirrored half a period later, of {oscillator} under {motion} "
            f"and the law {dict(law)}: there is one wherever energy is lost; add damping, or leave the resonance"
        )
    # within a period both extremes occur, unless one is at its start: the other, mirrored, gives the reversal at −X
    turns = _trajectory(eq, law, state, (0.0, motion.period), 0.0).turns
    t, _, x, _, z = (float(one) for one in turns[np.argmax(np.abs(turns[:, PHASE_X]))])
    side = math.copysign(1.0, x)
    theta = motion.omega * (t if side < 0.0 else (t + 0.5 * motion.period) % motion.period)
    reversal = -side * x, 0.0, -side * z
    half = _trajectory(eq, law, reversal, (0.0, 0.5 * motion.period), theta)
    return LawOrbit(**vars(_until_closed(half)))


def _until_closed(half: LawTrajectory) -> LawTrajectory:
    """The half cycle without the phases at its end that start when it has closed: rounding lets the reversal come
    early, or leaves a velocity at the end, and neither is a phase of the motion."""
    weights = _weights(half.oscillator)
    states = half.phases[:, [PHASE_X, PHASE_V, PHASE_Z]] * weights
    size = np.linalg.norm(states[0])
    away = np.linalg.norm(states + states[0], axis=1) > _ACCEPTED * size
    n = 1 + int(np.flatnonzero(away)[-1])
    return replace(half, phases=half.phases[:n], _pieces=half._pieces[:n])


def _require_followed(eq: Equation, duration: float, speed: float) -> None:
    """ValueError for a motion of so many seconds, and about such a speed, m/s, that takes too long to integrate."""
    o = eq.oscillator
    fastest = max(eq.omega, math.sqrt((o.k + o.K_z) / o.m), eq.slope(speed, 0.0) / o.m)
    if duration * fastest > _MOST_RADIANS:
        raise ValueError(
            f"{duration:g} s are {duration * fastest:.2g} radians of the fastest motion of this oscillator, and no "
            f"more than {_MOST_RADIANS:g} are followed under a law: give it more mass, or less damping and stiffness"
        )


def _trajectory(
    eq: Equation, law: Mapping[str, float], state: Point, span: tuple[float, float], theta: float
) -> LawTrajectory:
    """The motion over a span of time from a state at its start.   theta : phase of the base at t = 0, rad."""
    rows, pieces = [], []
    for t, (x, v, _), piece in _phases(eq, state, span, theta, _NOTHING):
        rows.append((t, piece.s, x, v, piece.z))
        pieces.append(piece)
    return LawTrajectory(
        eq.oscillator, eq.motion, dict(law), theta, np.array(rows), span[1], tuple(pieces)
    )


def _phases(
    eq: Equation, state: Point, span: tuple[float, float], theta: float, carried: Array
) -> Iterator[tuple[float, Point, Piece]]:
    """The phases of the motion over a span of time: when each starts, its state there, and the phase itself."""
    t, end = span
    while t < end:
        piece = follow(eq, state, theta + eq.omega * t, end - t, carried)
        yield t, state, piece
        state, carried = piece.end, piece.derivative
        t = end if piece.duration >= end - t else t + piece.duration


def _nearby(eq: Equation, motion: BaseMotion) -> Point:
    """State at base phase 0 of the steady response with the linear damper that takes as much as the law does from a
    harmonic motion: exact for linear laws, some percent off for others."""
    o, omega, X = eq.oscillator, motion.omega, motion.Y
    # damping that goes with the velocity of the base turns and enlarges what drives
    dragged = -omega * float(eq.damping(0.0, 1.0)) / o.k
    base = BaseMotion(motion.Y * math.hypot(1.0, dragged), omega)
    try:
        for _ in range(_EQUIVALENCES):
            work = 0.0
            for p, one in eq.law:
                assert one.harmonic is not None
                work += p * float(one.harmonic(omega, X, 0.0, 0.0, o.k))
            orbit = steady_orbit(replace(o, c=work / (math.pi * omega * X**2)), base)
            X = math.sqrt(X * orbit.X)
    except (NoSteadyOrbit, OverflowError):
        return 0.0, 0.0, 0.0
    state = orbit.state(math.atan(dragged) / omega)
    return float(state.x), float(state.v), float(np.clip(state.z, -o.Z_m, o.Z_m))


def _fixed_point(eq: Equation, motion: BaseMotion, start: Point) -> Point | None:
    """The state s at base phase 0 with Φ(s) = −s, by Newton's method from there; None if it is not found."""
    weights = _weights(eq.oscillator)
    s = np.array(start)
    residual, derivative = _closure(eq, motion, s)
    for _ in range(_MOST_STEPS):
        size, error = np.linalg.norm(weights * s), np.linalg.norm(weights * residual)
        if error <= _CONVERGED * size:
            break
        trial = s - np.linalg.lstsq(derivative, residual)[0]
        nearer = _closure(eq, motion, trial)
        if error <= _ACCEPTED * size and np.linalg.norm(weights * nearer[0]) >= 0.5 * error:
            break  # rounding keeps it from going lower
        s, (residual, derivative) = trial, nearer
    else:
        return None
    scaled = derivative * weights[:, None] / weights
    if np.linalg.svd(scaled, compute_uv=False)[-1] < _SINGULAR:
        return None  # any amplitude would do
    return float(s[0]), float(s[1]), float(s[2])


def _closure(eq: Equation, motion: BaseMotion, s: Array) -> tuple[Array, Array]:
    """s + Φ(s) and its derivative, (3, 3). The forces are continuous across events, so that changes of the state pass
    them as they are, except that of z, which slip wipes out."""
    start = float(s[0]), float(s[1]), float(s[2])
    phases = _phases(eq, start, (0.0, 0.5 * motion.period), 0.0, np.eye(3))
    pieces = [piece for *_, piece in islice(phases, _MOST_PHASES + 1)]
    if len(pieces) > _MOST_PHASES:
        raise NoSteadyOrbit(f"more than {_MOST_PHASES} events in half a period of {eq.oscillator}")
    return s + np.array(pieces[-1].end), np.eye(3) + pieces[-1].derivative


def _weights(o: Oscillator) -> Array:
    """What makes the norm of a state (x, ẋ, z) the root of twice its energy."""
    return np.sqrt([o.k, o.m, o.K_z])
