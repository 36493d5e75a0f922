"""The steady response to harmonic base motion under any law: an exact orbit, and what other terms add to it.

Terms that are linear in ẋ and ẏ only change the numbers of an oscillator that has an exact orbit:

    c ẋ + c_r(ẋ − ẏ) + η(k/ω)ẋ + …  :   damper c + c_r + ηk/ω,   base Re (1 + iωc_r/k) Y e^{iωt}

For the others, N(ẋ) = Σ p_j h_j(ẋ), the orbit x is that with a linear damper of nearly the same work, c_l + c_e, c_l
of the linear terms. Turned by an angle β, so that both reverse at one time, δ = Re Σ δ_n e^{inωt}, n odd, comes to it:

    (k − n²ω²m + inωc_l)δ_n + f_n[x + δ] − f_n[x] + N_n[ẋ + δ̇] − inωc_e x_n = kY(e^{iβ} − 1) of n = 1,   δ̇ = 0 at −X,

solved by Newton's method with the exact derivative: f is the force of the contact, −F_k + K_z(x − x_r) from a reversal
at x_r on until it reaches F_k, and F_k to the next one. The onset of slip is located in the motion x + δ itself: no
kink is sampled, and the jumps of a stiff contact are in x. What is left out are harmonics of δ beyond the 63rd.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Self

import numpy as np

from ..arrays import Array, Complexes
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..motion.regime import Regime
from .terms import KNOWN_TERMS

_HARMONICS = 32  # odd ones of δ
_POINTS = 256  # of half a cycle, where N is taken
_NODES = (
    40  # of Gauss's rule in the stick phase: exact for the 63rd harmonic over half a cycle and more
)
_RIGID = 1e-11  # of X: microstick lines below it are rounding
_MOST, _CHORDS = 30, 3  # steps, and how many of them with the matrix of another response
_REACHED = 1e-13  # of the amplitude
_ROUNDING = 1e-15  # of X: what the displacement at an onset is known to
_EQUIVALENCES = 3  # repetitions that bring c_e near that of the response


@dataclass(frozen=True, eq=False)
class Response:
    """The steady response of an oscillator with a law.

    orbit : exact, of the oscillator with the equivalent linear damper.   advance : phase by which the base of that
    orbit is before the real one, rad.   change : δ_n, n = 1, 3, 5 …, with the phases of the orbit, m; None where there
    is none.   turned : β, rad.   onset : phase ωt of the onset of slip after the reversal at −X, in those of the orbit,
    rad; NaN without slip.   matrix : of the last of Newton's steps that led to it.
    """

    orbit: Orbit
    advance: float
    change: Complexes | None = None
    turned: float = 0.0
    onset: float = math.nan
    matrix: Array | None = field(default=None, repr=False)

    @property
    def slips(self) -> bool:
        """Whether the contact slips."""
        return self.orbit.regime in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS)

    @property
    def X(self) -> float:
        """Peak displacement, m."""
        return self.orbit.X if self.change is None else -float(self._at(self.orbit.theta)[0])

    @property
    def V_s(self) -> float:
        """Velocity at the first onset of slip after the reversal at −X, m/s; NaN without slip."""
        return self.orbit.V_s if self.change is None else float(self._at(self.onset)[1])

    @property
    def t_s(self) -> float:
        """Time from that reversal to the onset, s; NaN without slip."""
        if self.change is None:
            return self.orbit.t_s
        return (self.onset - self.orbit.theta) / self.orbit.motion.omega

    @property
    def taken(self) -> float:
        """λ = 4X − a, m: what sticking takes from the travel of a cycle."""
        if self.change is None:
            return 4.0 * self.orbit.X - self.orbit.a
        return 4.0 * self.orbit.oscillator.Z_m

    def harmonics(self, count: int) -> Complexes:
        """x_n of x = Re Σ x_n e^{inωt}, n = 1, 3 … 2 count − 1, m, shape (count,); y = Y cos ωt."""
        n = np.arange(1, 2 * count, 2)
        x = self.orbit.harmonics(count)
        if self.change is not None:
            x = x + np.pad(self.change, (0, max(0, count - _HARMONICS)))[:count]
        turned: Complexes = x * np.exp(1j * n * self.advance)
        return turned

    def _at(self, theta: float) -> tuple[float, float]:
        """x and ẋ at a phase of the orbit, m and m/s."""
        assert self.change is not None
        x, v = _Motion(self.orbit).at(np.array([theta]), self.change)
        return float(x[0]), float(v[0])


def steady_response(
    oscillator: Oscillator,
    motion: BaseMotion,
    law: Mapping[str, float],
    near: Response | None = None,
) -> Response:
    """The steady response of an oscillator under a law.

    law : symbol → coefficient of the terms besides friction and c, which are the oscillator's, SI.
    near : a response from which to start.

    Raises NoSteadyOrbit where there is none, or none with one onset of slip per half cycle under quadratic or cubic
    damping.
    """
    omega, k = motion.omega, oscillator.k
    linear, to_base, others = oscillator.c, 0.0, {}
    for symbol, p in law.items():
        force = KNOWN_TERMS[symbol].force
        if force is not None and KNOWN_TERMS[symbol].linear:
            linear += p * float(force(1.0, 0.0, k, omega))
            to_base -= p * float(force(0.0, 1.0, k, omega))
        elif force is not None and p:
            others[symbol] = p
    base = BaseMotion(motion.Y * math.hypot(1.0, omega * to_base / k), omega)
    advance = math.atan2(omega * to_base, k)
    if not others:
        return Response(steady_orbit(replace(oscillator, c=linear), base), advance)
    if near is not None and near.change is not None:
        extra = near.orbit.oscillator.c - linear
        orbit = steady_orbit(replace(oscillator, c=linear + max(extra, 0.0)), base)
        found = _solved(orbit, linear, others, near)
    else:
        orbit = _equivalent(replace(oscillator, c=linear), base, others)
        found = _solved(orbit, linear, others, None)
    return replace(found, advance=advance - found.turned)


def _equivalent(oscillator: Oscillator, base: BaseMotion, others: Mapping[str, float]) -> Orbit:
    """The orbit with the linear damper that takes nearly the work of the other terms."""
    extra, X = 0.0, base.Y
    for repetition in range(_EQUIVALENCES):
        work = sum(
            p * harmonic(base.omega, X, 0.0, 0.0, oscillator.k)
            for p, harmonic in ((p, KNOWN_TERMS[s].harmonic) for s, p in others.items())
            if harmonic is not None
        )
        found = float(work) / (math.pi * base.omega * X**2)
        extra = 0.5 * (extra + found) if repetition else found
        orbit = steady_orbit(replace(oscillator, c=oscillator.c + extra), base)
        X = orbit.X
    return orbit


@cache
def _tables() -> tuple[Array, Array, Complexes, Array, Array]:
    """n; phases of half a cycle; e^{inθ} there; nodes and weights of Gauss's rule on (0, 1)."""
    n: Array = np.arange(1.0, 2.0 * _HARMONICS, 2.0)
    theta: Array = np.linspace(0.0, math.pi, _POINTS, endpoint=False)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    turns: Complexes = np.exp(1j * np.outer(theta, n))
    halves: Array = 0.5 * (1.0 + np.asarray(nodes, dtype=np.float64))
    return n, theta, turns, halves, 0.5 * weights


@dataclass(frozen=True, eq=False)
class _Motion:
    """x + δ at any phases: the orbit without truncation, and the harmonics of δ."""

    orbit: Orbit

    def at(self, theta: Array, change: Complexes) -> tuple[Array, Array]:
        """x, ẋ, m, m/s."""
        omega, n = self.orbit.motion.omega, _tables()[0]
        state = self.orbit.state(theta / omega)
        turn = np.exp(1j * np.outer(theta, n)) * change
        return state.x + turn.real.sum(axis=1), state.v + (turn @ (1j * n * omega)).real

    @cached_property
    def velocity(self) -> Array:
        """ẋ of the orbit at the phases of half a cycle, m/s."""
        return self.orbit.state(_tables()[1] / self.orbit.motion.omega).v


def _solved(
    orbit: Orbit, linear: float, others: Mapping[str, float], near: Response | None
) -> Response:
    """The response, by Newton's method on δ and β; beside another with its matrix, as long as that leads there."""
    system = _System.of(orbit, linear, others)
    change, turned, matrix = np.zeros(_HARMONICS, dtype=np.complex128), 0.0, None
    if near is not None and near.change is not None:
        change, turned, matrix = near.change, near.turned, near.matrix
    for repetition in range(_MOST):
        if matrix is None or repetition >= _CHORDS:
            right, matrix = system.equations(change, turned)
        else:
            right = system.residual(change, turned)
        step = np.linalg.solve(matrix, right)
        size = float(np.abs(step[:-1]).max())
        if not size < 10.0 * orbit.X:
            break
        change, turned = change + system.basis @ step[:-1], turned + float(step[-1])
        if size < _REACHED * orbit.X:
            return _checked(orbit, change, turned, system.contact, matrix)
    raise NoSteadyOrbit(f"the response under {dict(others)} was not found from {orbit.oscillator}")


@dataclass(frozen=True, eq=False)
class _System:
    """The equations of δ and β, and of δ̇ = 0 at −X.

    linear : c_l, N s/m.   others : the other terms.   basis : δ = basis @ (its real parts A, B).   impedance : of δ_n,
    N/m.   contact : None where it sticks.
    """

    orbit: Orbit
    linear: float
    others: Mapping[str, float]
    basis: Complexes
    impedance: Complexes
    contact: _Contact | None

    @classmethod
    def of(cls, orbit: Orbit, linear: float, others: Mapping[str, float]) -> Self:
        """The equations of the response near an orbit. Raises NoSteadyOrbit for one of a kind that is not followed."""
        osc, omega, n = orbit.oscillator, orbit.motion.omega, _tables()[0]
        if orbit.regime not in (Regime.ONE_SLIP, Regime.NO_SLIP):
            raise NoSteadyOrbit(
                "under quadratic or cubic damping only one onset of slip per half cycle can be followed, not: "
                f"{orbit.regime}"
            )
        slips = orbit.regime == Regime.ONE_SLIP
        basis = np.hstack([np.eye(n.size), -1j * np.eye(n.size)])
        stiffness = osc.k if slips else osc.k + osc.K_z
        impedance = stiffness - (n * omega) ** 2 * osc.m + 1j * n * omega * linear
        contact = _Contact(orbit, basis) if slips else None
        return cls(orbit, linear, others, basis, impedance, contact)

    @cached_property
    def _rate(self) -> Complexes:
        return np.asarray(1j * _tables()[0] * self.orbit.motion.omega)

    @cached_property
    def _at_reversal(self) -> Array:
        """Of δ̇ at −X, by the real parts of δ."""
        turn = np.exp(1j * _tables()[0] * self.orbit.theta)
        return np.asarray(((self._rate * turn) @ self.basis).real)

    @cached_property
    def _velocity(self) -> Array:
        return _Motion(self.orbit).velocity

    def residual(self, change: Complexes, turned: float) -> Array:
        """What is left of the equations, its sign changed."""
        of_contact = 0.0 if self.contact is None else self.contact.force(change)
        return self._right(change, turned, of_contact, self._forces(change, slopes=False)[0])

    def equations(self, change: Complexes, turned: float) -> tuple[Array, Array]:
        """The same, and the matrix of its derivatives."""
        n, _, turns, _, _ = _tables()
        force, slope = self._forces(change, slopes=True)
        rates = ((turns * self._rate) @ self.basis).real
        jacobian = self.impedance[:, None] * self.basis
        jacobian = jacobian + (2.0 / _POINTS) * (turns.conj().T @ (slope[:, None] * rates))
        matrix: Array = np.eye(2 * n.size + 1)
        of_contact: Complexes = np.zeros(n.size, dtype=np.complex128)
        if self.contact is not None:
            of_contact, by_change = self.contact.force_and_slope(change)
            jacobian = jacobian + by_change
            by_turn = -1j * self.orbit.oscillator.k * self.orbit.motion.Y * np.exp(1j * turned)
            matrix[0, -1], matrix[n.size, -1] = by_turn.real, by_turn.imag
            matrix[-1] = np.append(self._at_reversal, 0.0)
        matrix[: n.size, :-1], matrix[n.size : -1, :-1] = jacobian.real, jacobian.imag
        return self._right(change, turned, of_contact, force), matrix

    def _forces(self, change: Complexes, *, slopes: bool) -> tuple[Array, Array]:
        """N − c_e ẋ of the orbit, and ∂N/∂ẋ, at the phases of half a cycle."""
        turns, osc, omega = _tables()[2], self.orbit.oscillator, self.orbit.motion.omega
        v = self._velocity + (turns @ (self._rate * change)).real
        force, slope = -(osc.c - self.linear) * self._velocity, np.zeros_like(v)
        for symbol, p in self.others.items():
            of_term = KNOWN_TERMS[symbol]
            assert of_term.force is not None
            assert of_term.slope is not None
            force = force + p * of_term.force(v, 0.0, osc.k, omega)
            if slopes:
                slope = slope + p * of_term.slope(v, 0.0, osc.k, omega)
        return force, slope

    def _right(
        self, change: Complexes, turned: float, of_contact: Complexes | float, force: Array
    ) -> Array:
        projected = (2.0 / _POINTS) * (_tables()[2].conj().T @ force)
        residual = self.impedance * change + projected + of_contact
        last = 0.0
        if self.contact is not None:
            residual[0] -= self.orbit.oscillator.k * self.orbit.motion.Y * np.expm1(1j * turned)
            last = float(self._at_reversal @ np.concatenate([change.real, -change.imag]))
        return -np.concatenate([residual.real, residual.imag, [last]])


def _checked(
    orbit: Orbit, change: Complexes, turned: float, contact: _Contact | None, matrix: Array
) -> Response:
    """The response, if it is one of the kind that was assumed."""
    motion = _Motion(orbit)
    if contact is None:
        if np.abs(motion.at(_tables()[1], change)[0]).max() > orbit.oscillator.Z_m:
            raise NoSteadyOrbit("the contact begins to slip under quadratic or cubic damping")
        return Response(orbit, 0.0, change, turned, matrix=matrix)
    between = orbit.theta + np.linspace(0.0, math.pi, 66)[1:-1]
    if not (motion.at(between, change)[1] > 0.0).all():
        raise NoSteadyOrbit("the velocity changes its sign inside a half cycle")
    return Response(orbit, 0.0, change, turned, contact.onset(change), matrix)


@dataclass(frozen=True, eq=False)
class _Contact:
    """The force of the contact in a motion with one onset of slip per half cycle, less that in the orbit.

    basis : of δ, from its real parts.
    """

    orbit: Orbit
    basis: Complexes

    @property
    def rigid(self) -> bool:
        """Whether the microstick lines are but rounding."""
        return self.orbit.oscillator.Z_m < _RIGID * self.orbit.X

    @cached_property
    def motion(self) -> _Motion:
        """Whose contact it is."""
        return _Motion(self.orbit)

    def onset(self, change: Complexes) -> float:
        """Phase of the onset of slip after the reversal at −X, rad."""
        osc, omega, reversal = self.orbit.oscillator, self.orbit.motion.omega, self.orbit.theta
        if self.rigid:
            return reversal
        x_r = self.motion.at(np.array([reversal]), change)[0][0]
        length = omega * self.orbit.t_s
        for _ in range(40):
            x, v = self.motion.at(np.array([reversal + length]), change)
            step = omega * float((x[0] - x_r - 2.0 * osc.Z_m) / v[0]) if v[0] > 0.0 else -length
            step = min(max(step, -length), 0.5 * length)
            length = min(length - step, math.pi)
            if abs(step) <= max(1e-14 * length, _ROUNDING * abs(omega * x_r / v[0])):
                break
        if not 0.0 < length < math.pi:
            raise NoSteadyOrbit("the contact does not slip in every half cycle")
        return reversal + length

    @cached_property
    def _of_orbit(self) -> Complexes:
        return self._harmonics(np.zeros(_HARMONICS, dtype=np.complex128))[0]

    def force(self, change: Complexes) -> Complexes:
        """f_n[x + δ] − f_n[x], N, (h,)."""
        if self.rigid:
            return np.zeros_like(change)
        return self._harmonics(change)[0] - self._of_orbit

    def force_and_slope(self, change: Complexes) -> tuple[Complexes, Complexes]:
        """The same, and its derivatives by the real parts of δ_n, (h, 2h)."""
        if self.rigid:
            return np.zeros_like(change), np.zeros_like(self.basis)
        f, turns, weighted = self._harmonics(change)
        moved = (turns @ self.basis).real
        by_change = self.orbit.oscillator.K_z * weighted.T @ (moved[:-1] - moved[-1])
        return f - self._of_orbit, by_change

    def _harmonics(self, change: Complexes) -> tuple[Complexes, Complexes, Complexes]:
        """(2/π) ∫ (f − F_k) e^{−inθ} dθ over the stick phase, N, (h,): the rest is the same in both; e^{inθ} at the
        nodes and at the reversal; the weights of the nodes in the integral."""
        osc, reversal, (n, _, _, nodes, weights) = (
            self.orbit.oscillator,
            self.orbit.theta,
            _tables(),
        )
        length = self.onset(change) - reversal
        theta = reversal + length * np.append(nodes, 0.0)
        x = self.motion.at(theta, change)[0]
        turns = np.exp(1j * np.outer(theta, n))
        weighted = (2.0 / math.pi) * length * weights[:, None] * turns[:-1].conj()
        return (osc.K_z * (x[:-1] - x[-1]) - 2.0 * osc.F_k) @ weighted, turns, weighted
