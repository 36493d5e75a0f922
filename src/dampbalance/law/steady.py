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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complexes
from ..model import BaseMotion, Oscillator
from ..motion.events import MOST_RADIANS
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..motion.regime import Regime
from ..motion.steady_slopes import onset_slopes
from .terms import FRICTION, KNOWN_TERMS

HARMONICS = 32
"""Odd harmonics of δ."""

_POINTS = 256  # of half a cycle, where N is taken
# Of Gauss's rule in the stick phase: exact for the 63rd harmonic over half a cycle and more.
_NODES = 40
_RIGID = 1e-11  # of X: microstick lines below it are rounding
_ROUNDING = 1e-15  # of X: what the displacement at an onset is known to


@cache
def tables() -> tuple[Array, Array, Complexes, Array, Array]:
    """n; phases of half a cycle; e^{inθ} there; nodes and weights of Gauss's rule on (0, 1)."""
    n = np.arange(1.0, 2.0 * HARMONICS, 2.0)
    theta = np.linspace(0.0, math.pi, _POINTS, endpoint=False)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    return n, theta, np.exp(1j * np.outer(theta, n)), 0.5 * (1.0 + nodes), 0.5 * weights


def motion_at(
    orbit: Orbit, theta: Array, change: Complexes, turns: Complexes | None = None
) -> tuple[Array, Array]:
    """x + δ and its velocity at any phases, m, m/s: the orbit without truncation, and the harmonics of δ.

    turns : e^{inθ} there, if they are known.
    """
    omega, n = orbit.motion.omega, tables()[0]
    x, v, _, _ = orbit.states(theta / omega)
    turn = (np.exp(1j * np.outer(theta, n)) if turns is None else turns) * change
    return x + turn.real.sum(axis=1), v + (turn @ (1j * n * omega)).real


def _by_parts(turns: Complexes) -> Array:
    """Derivatives of Re Σ e_n δ_n by the real parts A, B of δ_n = A_n − iB_n, (…, 2h).   turns : e_n, (…, h)."""
    return np.concatenate([turns.real, turns.imag], axis=-1)


@dataclass(frozen=True, eq=False)
class System:
    """The equations of δ and β, and of δ̇ = 0 at −X.

    linear : c_l, N s/m.   others : the other terms.   basis : δ = basis @ (its real parts A, B).   impedance : of δ_n,
    N/m.   contact : None where it sticks.
    """

    orbit: Orbit
    linear: float
    others: Mapping[str, float]
    basis: Complexes
    impedance: Complexes
    contact: Contact | None

    @classmethod
    def of(cls, orbit: Orbit, linear: float, others: Mapping[str, float]) -> Self:
        """The equations of the response near an orbit. Raises NoSteadyOrbit for one of a kind that is not followed."""
        osc, omega, n = orbit.oscillator, orbit.motion.omega, tables()[0]
        if orbit.regime not in (Regime.ONE_SLIP, Regime.NO_SLIP):
            raise NoSteadyOrbit(
                "under quadratic or cubic damping only one onset of slip per half cycle can be followed, not: "
                f"{orbit.regime}"
            )
        slips = orbit.regime == Regime.ONE_SLIP
        basis = np.hstack([np.eye(n.size), -1j * np.eye(n.size)])
        stiffness = osc.k if slips else osc.k + osc.K_z
        impedance = stiffness - (n * omega) ** 2 * osc.m + 1j * n * omega * linear
        contact = Contact(orbit, basis) if slips else None
        return cls(orbit, linear, others, basis, impedance, contact)

    @cached_property
    def _rate(self) -> Complexes:
        return np.asarray(1j * tables()[0] * self.orbit.motion.omega)

    @cached_property
    def _at_reversal(self) -> Array:
        """Of δ̇ at −X, by the real parts of δ."""
        turn = np.exp(1j * tables()[0] * self.orbit.theta)
        return np.asarray(((self._rate * turn) @ self.basis).real)

    @cached_property
    def _velocity(self) -> Array:
        """ẋ of the orbit at the phases of half a cycle, m/s."""
        return self.orbit.state(tables()[1] / self.orbit.motion.omega).v

    def residual(self, change: Complexes, turned: float) -> Array:
        """What is left of the equations, its sign changed."""
        of_contact = 0.0 if self.contact is None else self.contact.force(change)[0]
        return self._right(change, turned, of_contact, self._forces(change)[0])

    def equations(self, change: Complexes, turned: float) -> tuple[Array, Array]:
        """`residual`, and the matrix of the derivatives of the equations."""
        n, _, turns, _, _ = tables()
        force, slope = self._forces(change)
        rates = _by_parts(turns * self._rate)
        jacobian = self.impedance[:, None] * self.basis
        jacobian = jacobian + (2.0 / _POINTS) * (turns.conj().T @ (slope[:, None] * rates))
        matrix = np.eye(2 * n.size + 1)
        of_contact = np.zeros(n.size, dtype=np.complex128)
        if self.contact is not None:
            of_contact, by_change = self.contact.force(change)
            jacobian = jacobian + by_change
            by_turn = -1j * self.orbit.oscillator.k * self.orbit.motion.Y * np.exp(1j * turned)
            matrix[0, -1], matrix[n.size, -1] = by_turn.real, by_turn.imag
            matrix[-1] = np.append(self._at_reversal, 0.0)
        matrix[: n.size, :-1], matrix[n.size : -1, :-1] = jacobian.real, jacobian.imag
        return self._right(change, turned, of_contact, force), matrix

    def slopes(
        self, change: Complexes, lag: float, Y: float, matrix: Array, symbols: Sequence[str]
    ) -> dict[str, tuple[Complexes, float]]:
        """Derivatives of the response: name → (∂x_n, m, (h,), ∂lag) by the coefficients of terms, K_z and m.

        lag : phase by which the base follows that of the orbit, in which x_n are, rad.   Y : of the base, m.
        matrix : of the equations there.   The harmonics of the orbit beyond the 63rd are held.
        """
        (n, _, turns, _, _), osc, omega = tables(), self.orbit.oscillator, self.orbit.motion.omega
        x = self.orbit.harmonics(HARMONICS) + change
        v = self._velocity + (turns @ (self._rate * change)).real
        stuck = {"K_z": x, FRICTION: np.zeros_like(x)}
        by = stuck if self.contact is None else self.contact.slopes(change)
        by["m"] = -((n * omega) ** 2) * x
        for symbol in symbols:
            force = KNOWN_TERMS[symbol].force
            if force is None:
                continue
            if KNOWN_TERMS[symbol].linear:
                by[symbol] = float(force(1.0, 0.0, osc.k, omega)) * self._rate * x
                of_base = float(force(0.0, 1.0, osc.k, omega))
                by[symbol][0] += of_base * 1j * omega * Y * np.exp(1j * lag)
            else:
                by[symbol] = (2.0 / _POINTS) * (turns.conj().T @ force(v, 0.0, osc.k, omega))
        right = np.array([np.concatenate([r.real, r.imag, [0.0]]) for r in by.values()]).T
        moved = -np.linalg.solve(matrix, right).T
        return {
            name: (self.basis @ step[:-1], float(step[-1]))
            for name, step in zip(by, moved, strict=True)
        }

    def _forces(self, change: Complexes) -> tuple[Array, Array]:
        """N − c_e ẋ of the orbit, and ∂N/∂ẋ, at the phases of half a cycle."""
        turns, osc, omega = tables()[2], self.orbit.oscillator, self.orbit.motion.omega
        v = self._velocity + (turns @ (self._rate * change)).real
        force, slope = -(osc.c - self.linear) * self._velocity, np.zeros_like(v)
        for symbol, p in self.others.items():
            of_term = KNOWN_TERMS[symbol]
            assert of_term.force is not None
            force = force + p * of_term.force(v, 0.0, osc.k, omega)
            slope = slope + p * of_term.slope(v, 0.0, osc.k, omega)
        return force, slope

    def _right(
        self, change: Complexes, turned: float, of_contact: Complexes | float, force: Array
    ) -> Array:
        projected = (2.0 / _POINTS) * (tables()[2].conj().T @ force)
        residual = self.impedance * change + projected + of_contact
        last = 0.0
        if self.contact is not None:
            residual[0] -= self.orbit.oscillator.k * self.orbit.motion.Y * np.expm1(1j * turned)
            last = float(self._at_reversal @ np.concatenate([change.real, -change.imag]))
        return -np.concatenate([residual.real, residual.imag, [last]])


@dataclass(frozen=True, eq=False)
class Contact:
    """The force of the contact in a motion with one onset of slip per half cycle, less that in the orbit.

    basis : of δ, from its real parts.
    """

    orbit: Orbit
    basis: Complexes

    @property
    def rigid(self) -> bool:
        """Whether the microstick lines are but rounding."""
        return self.orbit.oscillator.Z_m < _RIGID * self.orbit.X

    def onset(self, change: Complexes) -> float:
        """Phase of the onset of slip after the reversal at −X, rad."""
        osc, omega, reversal = self.orbit.oscillator, self.orbit.motion.omega, self.orbit.theta
        if self.rigid:
            return reversal
        x_r = motion_at(self.orbit, np.array([reversal]), change)[0][0]
        length = omega * self.orbit.t_s
        for _ in range(40):
            x, v = motion_at(self.orbit, np.array([reversal + length]), change)
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
        return self._harmonics(np.zeros(HARMONICS, dtype=np.complex128))[0]

    def force(self, change: Complexes) -> tuple[Complexes, Complexes]:
        """f_n[x + δ] − f_n[x], N, (h,), and its derivatives by the real parts of δ_n, (h, 2h)."""
        if self.rigid:
            return np.zeros_like(change), np.zeros_like(self.basis)
        f, turns, weighted = self._harmonics(change)
        moved = _by_parts(turns)
        by_change = self.orbit.oscillator.K_z * weighted.T @ (moved[:-1] - moved[-1])
        return f - self._of_orbit, by_change

    def slopes(self, change: Complexes) -> dict[str, Complexes]:
        """∂f_n/∂F_k and ∂f_n/∂K_z in a motion that is held, (h,)."""
        n = tables()[0]
        by_friction = 4.0 / math.pi * np.exp(-1j * n * self.orbit.theta) / (1j * n)
        if self.rigid:
            return {FRICTION: by_friction, "K_z": np.zeros_like(by_friction)}
        f, _, weighted = self._harmonics(change)
        osc = self.orbit.oscillator
        of_onset = weighted.sum(axis=0)
        return {
            FRICTION: by_friction - 2.0 * of_onset,
            "K_z": (f + 2.0 * osc.F_k * of_onset) / osc.K_z,
        }

    def _harmonics(self, change: Complexes) -> tuple[Complexes, Complexes, Complexes]:
        """(2/π) ∫ (f − F_k) e^{−inθ} dθ over the stick phase, N, (h,): the rest is the same in both; e^{inθ} at the
        nodes and at the reversal; the weights of the nodes in the integral."""
        osc, reversal = self.orbit.oscillator, self.orbit.theta
        n, _, _, nodes, weights = tables()
        length = self.onset(change) - reversal
        theta = reversal + length * np.append(nodes, 0.0)
        turns = np.exp(1j * np.outer(theta, n))
        x = motion_at(self.orbit, theta, change, turns)[0]
        weighted = (2.0 / math.pi) * length * weights[:, None] * turns[:-1].conj()
        return (osc.K_z * (x[:-1] - x[-1]) - 2.0 * osc.F_k) @ weighted, turns, weighted


_MOST, _CHORDS = 30, 3  # steps, and how many of them with the matrix of another response
_REACHED = 1e-13  # of the amplitude
_FAR = 0.5  # of the amplitude: a step as long may lead away
_SHORTEST = 1.0 / 64.0  # part of such a step
_EQUIVALENCES = 3  # repetitions that bring c_e near that of the response


@dataclass(frozen=True, eq=False)
class Response:
    """The steady response of an oscillator with a law.

    orbit : exact, of the oscillator with the equivalent linear damper.   advance : phase by which the base of that
    orbit is before the real one, rad.   change : δ_n, n = 1, 3, 5 …, with the phases of the orbit, m; None where there
    is none.   turned : β, rad.   onset : phase ωt of the onset of slip after the reversal at −X, in those of the orbit,
    rad; NaN without slip.   matrix : of the last of Newton's steps that led to it.
    system : the equations that δ and β solve.   Y : amplitude of the base, m, where there are such.
    """

    orbit: Orbit
    advance: float
    change: Complexes | None = None
    turned: float = 0.0
    onset: float = math.nan
    matrix: Array | None = field(default=None, repr=False)
    system: System | None = field(default=None, repr=False)
    Y: float = math.nan

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
        x = self.orbit.harmonics(count)
        if not self.advance and self.change is None:
            return x
        n = np.arange(1, 2 * count, 2)
        if self.change is not None:
            x = x + _first(count, self.change)
        return x * np.exp(1j * n * self.advance)

    @property
    def swings(self) -> float:
        """How often the mass swings on contact and spring in half a cycle, while it sticks."""
        (t, s), par = self.orbit.phases.T[:2].tolist(), self.orbit.parameters
        ends = zip(t, [*t[1:], math.pi / par.omega], s, strict=True)
        stuck = math.fsum(end - start for start, end, slips in ends if not slips)
        return stuck * math.sqrt((par.k + par.K_z) / par.m) / (2.0 * math.pi)

    def with_slopes(
        self, count: int, symbols: Sequence[str]
    ) -> tuple[Complexes, dict[str, Complexes] | None]:
        """`harmonics` and their derivatives by the coefficients of these terms, rho = K_z^{−1/2} and m, (count,).

        They are exact where all terms are linear. Else they follow from the equations of δ, for nothing of the motion
        is computed again, and are accurate to 1e-3 or so: choose that during a search, and differences of neighbouring
        responses for standard errors. None where there are no such equations.
        """
        n = np.arange(1, 2 * count, 2)
        turn = np.exp(1j * n * self.advance)
        if self._closed(symbols):
            by = self.orbit.harmonics_with_slopes(count) * turn
            return by[0], self._by_coefficients(by, symbols, 1.0, 1j * n * by[0])
        x = self.harmonics(count)
        if self.system is None or self.change is None or self.matrix is None:
            return x, None
        moved = self.system.slopes(self.change, -self.advance, self.Y, self.matrix, symbols)
        slopes = {
            name: _first(count, of) * turn - 1j * n * lag * x for name, (of, lag) in moved.items()
        }
        slopes["rho"] = -2.0 * self.orbit.oscillator.K_z**1.5 * slopes.pop("K_z")
        return x, slopes

    def onset_slopes(self, symbols: Sequence[str]) -> dict[str, Array] | None:
        """Derivatives of (V_s, t_s, λ), SI, by the coefficients of these terms, rho and m, (3,); None where not all of
        them are linear."""
        if not self._closed(symbols):
            return None
        by = onset_slopes(self.orbit.phases, self.orbit.theta, self.orbit.parameters)
        onset = np.array([self.V_s, self.t_s, self.taken])
        return self._by_coefficients([onset, *by.T], symbols, np.array([1.0, 0.0, 1.0]), 0.0)

    def moved_by(self, force: Complexes) -> Complexes | None:
        """Change of the harmonics, m, (32,), by a small further force against the motion, f_n in the phases of the
        orbit, N, (32,), which moves the onsets of slip as well; None where the orbit is of a kind that is not followed.
        """
        if self._linearised is None:
            return None
        n, (basis, matrix, x) = tables()[0], self._linearised
        moved = np.linalg.solve(matrix, -np.concatenate([force.real, force.imag, [0.0]]))
        turned = 1j * n * moved[-1] * x
        return np.asarray(basis @ moved[:-1] * np.exp(1j * n * self.advance) - turned)

    @cached_property
    def _linearised(self) -> tuple[Complexes, Array, Complexes] | None:
        """Basis and matrix of the equations at the motion, and its harmonics; None where it is not followed."""
        try:
            system = self.system or System.of(self.orbit, self.orbit.oscillator.c, {})
        except NoSteadyOrbit:
            return None
        matrix, x = self.matrix, self.harmonics(HARMONICS)
        if matrix is None:
            matrix = system.equations(np.zeros_like(x), 0.0)[1]
        return system.basis, matrix, x

    def _closed(self, symbols: Sequence[str]) -> bool:
        """Whether the motion is that of the orbit, and would be with other coefficients of these terms."""
        terms = [KNOWN_TERMS[s] for s in symbols if s != FRICTION]
        return self.change is None and all(term.linear for term in terms)

    def _by_coefficients(
        self, by: Any, symbols: Sequence[str], degree: Any, by_phase: Any
    ) -> dict[str, NDArray[Any]]:
        """Derivatives of what has the value and the derivatives `by`, (5, …), under the law of the orbit.

        degree : in (Y, F_k).   by_phase : derivative by the phase of the base.

        Terms that are linear in ẋ and ẏ change c, ln Y and the phase of the base that drives the orbit.
        """
        value, by_friction, by_c, by_rho, by_m = by
        omega, k = self.orbit.motion.omega, self.orbit.oscillator.k
        by_base = degree * value - self.orbit.oscillator.F_k * by_friction
        slopes = {FRICTION: by_friction, "rho": by_rho, "m": by_m}
        to_base = math.tan(self.advance)  # of ω/k
        for symbol in symbols:
            force = KNOWN_TERMS[symbol].force
            if force is not None:
                turned = -float(force(0.0, 1.0, k, omega)) * omega / k / (1.0 + to_base**2)
                damping = float(force(1.0, 0.0, k, omega))
                slopes[symbol] = damping * by_c + turned * (to_base * by_base + by_phase)
        return slopes

    def _at(self, theta: float) -> tuple[float, float]:
        """x and ẋ at a phase of the orbit, m and m/s."""
        assert self.change is not None
        x, v = motion_at(self.orbit, np.array([theta]), self.change)
        return float(x[0]), float(v[0])


def _first(count: int, change: Complexes) -> Complexes:
    """So many harmonics of δ; those beyond the 63rd are zero."""
    return np.pad(change, (0, max(0, count - HARMONICS)))[:count]


def steady_response(
    oscillator: Oscillator,
    motion: BaseMotion,
    law: Mapping[str, float],
    near: Response | None = None,
    *,
    most_radians: float = MOST_RADIANS,
) -> Response:
    """The steady response of an oscillator under a law.

    law : symbol → coefficient of the terms besides friction and c, which are the oscillator's, SI.
    near : a response from which to start.
    most_radians : as for `steady_orbit`, of a law with linear terms only.

    Raises NoSteadyOrbit where there is none, or none with one onset of slip per half cycle under quadratic or cubic
    damping.
    """
    if not law:
        return Response(steady_orbit(oscillator, motion, most_radians=most_radians), 0.0)
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
        own = replace(oscillator, c=linear)
        return Response(steady_orbit(own, base, most_radians=most_radians), advance)
    if near is not None and near.change is not None:
        extra = near.orbit.oscillator.c - linear
        orbit = steady_orbit(replace(oscillator, c=linear + max(extra, 0.0)), base)
    else:
        orbit, near = _equivalent(replace(oscillator, c=linear), base, others), None
    found = _solved(orbit, linear, others, near)
    return replace(found, advance=advance - found.turned, Y=motion.Y)


def _equivalent(oscillator: Oscillator, base: BaseMotion, others: Mapping[str, float]) -> Orbit:
    """The orbit with the linear damper that takes nearly the work of the other terms."""
    extra, X = 0.0, base.Y
    for repetition in range(_EQUIVALENCES):
        work = math.fsum(
            float(p * KNOWN_TERMS[s].harmonic(base.omega, X, 0.0, 0.0, oscillator.k))
            for s, p in others.items()
        )
        found = work / (math.pi * base.omega * X**2)
        extra = 0.5 * (extra + found) if repetition else found
        orbit = steady_orbit(replace(oscillator, c=oscillator.c + extra), base)
        X = orbit.X
    return orbit


def _solved(
    orbit: Orbit, linear: float, others: Mapping[str, float], near: Response | None
) -> Response:
    """The response, by Newton's method on δ and β; beside another with its matrix, as long as that leads there."""
    system = System.of(orbit, linear, others)
    change, turned, matrix = np.zeros(HARMONICS, dtype=np.complex128), 0.0, None
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
        if size > _FAR * orbit.X:
            step = _shortened(system, change, turned, step, right)
        change, turned = change + system.basis @ step[:-1], turned + float(step[-1])
        if size < _REACHED * orbit.X:
            return Response(orbit, 0.0, change, turned, _onset(system, change), matrix, system)
    raise NoSteadyOrbit(f"the response under {dict(others)} was not found from {orbit.oscillator}")


def _shortened(
    system: System, change: Complexes, turned: float, step: NDArray[Any], right: Array
) -> NDArray[Any]:
    """The step, or the longest of its halves, quarters … that brings the equations nearer to balance."""
    before, part = float(np.linalg.norm(right)), 1.0
    while part > _SHORTEST:
        shorter = part * step
        after = system.residual(change + system.basis @ shorter[:-1], turned + float(shorter[-1]))
        if float(np.linalg.norm(after)) < (1.0 - 0.1 * part) * before:
            return shorter
        part *= 0.5
    return step


def _onset(system: System, change: Complexes) -> float:
    """Phase of the onset of slip of a response, rad; NaN without slip.

    Raises NoSteadyOrbit if the response is not of the kind that was assumed.
    """
    orbit, contact = system.orbit, system.contact
    if contact is None:
        if np.abs(motion_at(orbit, tables()[1], change)[0]).max() > orbit.oscillator.Z_m:
            raise NoSteadyOrbit("the contact begins to slip under quadratic or cubic damping")
        return math.nan
    between = orbit.theta + np.linspace(0.0, math.pi, 66)[1:-1]
    if not (motion_at(orbit, between, change)[1] > 0.0).all():
        raise NoSteadyOrbit("the velocity changes its sign inside a half cycle")
    return contact.onset(change)
