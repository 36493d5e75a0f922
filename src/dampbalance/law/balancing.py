"""The equations of harmonic balance for what a nonlinear term adds to an exact orbit: see `steady.py`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Self

import numpy as np

from ..arrays import Array, Complexes
from ..motion.orbit import NoSteadyOrbit, Orbit
from ..motion.regime import Regime
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


def motion_at(orbit: Orbit, theta: Array, change: Complexes) -> tuple[Array, Array]:
    """x + δ and its velocity at any phases, m, m/s: the orbit without truncation, and the harmonics of δ."""
    omega, n = orbit.motion.omega, tables()[0]
    state = orbit.state(theta / omega)
    turn = np.exp(1j * np.outer(theta, n)) * change
    return state.x + turn.real.sum(axis=1), state.v + (turn @ (1j * n * omega)).real


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
        of_contact = 0.0 if self.contact is None else self.contact.force(change)
        return self._right(change, turned, of_contact, self._forces(change, slopes=False)[0])

    def equations(self, change: Complexes, turned: float) -> tuple[Array, Array]:
        """The same, and the matrix of its derivatives."""
        n, _, turns, _, _ = tables()
        force, slope = self._forces(change, slopes=True)
        rates = ((turns * self._rate) @ self.basis).real
        jacobian = self.impedance[:, None] * self.basis
        jacobian = jacobian + (2.0 / _POINTS) * (turns.conj().T @ (slope[:, None] * rates))
        matrix = np.eye(2 * n.size + 1)
        of_contact = np.zeros(n.size, dtype=np.complex128)
        if self.contact is not None:
            of_contact, by_change = self.contact.force_and_slope(change)
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
        by: dict[str, Complexes] = {"m": -((n * omega) ** 2) * x}
        if self.contact is None:
            by |= {"K_z": x, FRICTION: np.zeros_like(x)}
        else:
            by |= self.contact.slopes(change)
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

    def _forces(self, change: Complexes, *, slopes: bool) -> tuple[Array, Array]:
        """N − c_e ẋ of the orbit, and ∂N/∂ẋ, at the phases of half a cycle."""
        turns, osc, omega = tables()[2], self.orbit.oscillator, self.orbit.motion.omega
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
        x = motion_at(self.orbit, theta, change)[0]
        turns = np.exp(1j * np.outer(theta, n))
        weighted = (2.0 / math.pi) * length * weights[:, None] * turns[:-1].conj()
        return (osc.K_z * (x[:-1] - x[-1]) - 2.0 * osc.F_k) @ weighted, turns, weighted
