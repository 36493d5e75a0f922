"""Steady states by heyoka's Taylor method with events: one compiled integrator, its mode (stick, slip) in parameters.

Settling: the one terminal event is the end of the phase, its callback sets the parameters of the next one; one case
after the other, as batches of them are not faster. Shooting: the one event is slip onset; a batch of cases at a time,
one in each lane of the processor's vector unit, of neighbouring frequencies.
"""

from __future__ import annotations

import math

import heyoka as hy
import numpy as np

from .cases import PAPER, Sweep, good_guess, wrapped
from .shooting import broyden

TOLERANCE = 1e-14
AGREE = 1e-12  # relative, of two successive half cycles; of the residual of shooting
_LONGEST = 400  # half cycles
# of the runtime parameters: stiffness and constant force per mass, the coefficients of the event, ω, kY/m
_Z_M, _STIFFNESS, _CONTACT = PAPER.Z_m, PAPER.k / PAPER.m, PAPER.F_k / PAPER.m
_KAPPA, _FORCE, _E_V, _E_UU, _E_U, _E_1, _OMEGA, _DRIVE = range(8)


def _system():
    """Return equations for (u, ẋ, ∫ẋ² dt, ∫kyẋ dt), u gained since the phase began, and what is zero at its end."""
    u, v, b, W = hy.make_vars("u", "v", "b", "W")
    par, o = hy.par, PAPER
    drive = par[_DRIVE] * hy.cos(par[_OMEGA] * hy.time)
    equations = [
        (u, v),
        (v, drive - (o.c / o.m) * v - par[_FORCE] - par[_KAPPA] * u),
        (b, v * v),
        (W, o.m * drive * v),
    ]
    return equations, par[_E_V] * v + par[_E_UU] * u * u + par[_E_U] * u + par[_E_1]


def _scalar_integrator(callback):
    equations, end = _system()
    event = hy.t_event(end, callback=callback, direction=hy.event_direction.positive)
    return hy.taylor_adaptive(equations, [0.0] * 4, pars=[0.0] * 8, t_events=[event], tol=TOLERANCE)


def _batch_integrator(callback, lanes):
    equations, end = _system()
    event = hy.t_event_batch(end, callback=callback, direction=hy.event_direction.positive)
    state, pars = np.zeros((4, lanes)), np.ones((8, lanes))
    return hy.taylor_adaptive_batch(equations, state, pars=pars, t_events=[event], tol=TOLERANCE)


def _stick(pars, x, z):
    """Make the phase from x, z, which ends where (z + u)² = Z_m²."""
    r = z / _Z_M
    force = _STIFFNESS * x + _CONTACT * r
    pars[:6] = _STIFFNESS + _CONTACT / _Z_M, force, 0.0, _Z_M**-2, 2.0 * r / _Z_M, r * r - 1.0


def _slip(pars, x, s, ends):
    """Make the phase from x, which ends where −s ẋ = 0, or never."""
    force = _STIFFNESS * x + s * _CONTACT
    pars[:6] = _STIFFNESS, force, -s if ends else 0.0, 0.0, 0.0, 0.0 if ends else -1.0


def _batches(cases: Sweep, lanes: int):
    """Yield members of each batch, by frequency, and the same padded to its width: the last batch repeats its cases."""
    order = np.argsort(cases.omega)
    for first in range(0, len(order), lanes):
        members = order[first : first + lanes]
        yield members, np.resize(members, lanes)


class _Case:
    """State that the callback of one settling case keeps from phase to phase."""

    def __init__(self, motion, from_rest: bool) -> None:
        self.half = math.pi / motion.omega
        self.omega, self.drive = motion.omega, PAPER.k * motion.Y / PAPER.m
        self.features = None
        if from_rest:
            self.start = 0.0, 0.0, 0.0  # t, x, z
        else:
            guess = good_guess(motion)
            self.start = guess.theta / motion.omega, -guess.X, -_Z_M

    def begin(self, pars, state):
        self.t_reversal, self.x, z = self.start
        self.x_reversal, self.b_reversal, self.W_reversal = self.x, 0.0, 0.0
        pars[_OMEGA], pars[_DRIVE] = self.omega, self.drive
        state[:] = 0.0
        self.s = 0
        _stick(pars, self.x, z)

    def phase_ends(self, t, pars, state):
        """Begin the next phase; False once two half cycles agree."""
        self.x += state[0]
        state[0] = 0.0
        if self.s == 0:
            self.onset = t, self.x, state[1]
            self.s = 1 if state[1] > 0.0 else -1
            _slip(pars, self.x, self.s, ends=True)
            return True
        s, x = self.s, self.x
        steady = abs(x + self.x_reversal) <= AGREE * abs(x) and (
            abs(t - self.t_reversal - self.half) <= AGREE * self.half
        )
        if steady and self.features is None:
            t_s, x_s, v_s = self.onset
            self.features = (
                abs(x),
                abs(v_s),
                t_s - self.t_reversal,
                wrapped(self.omega * t + (0.0 if s > 0 else math.pi)),
                2.0 * abs(x - x_s),
                2.0 * (state[2] - self.b_reversal),
                2.0 * (state[3] - self.W_reversal),
            )
        self.t_reversal, self.x_reversal = t, x
        self.b_reversal, self.W_reversal = state[2], state[3]
        state[1] = 0.0
        self.s = 0
        _stick(pars, x, s * _Z_M)
        return not steady


class Settling:
    """Event by event until two half cycles agree, one case after the other."""

    def __init__(self, from_rest: bool) -> None:
        self._from_rest = from_rest
        self._case = None
        self._integrator = _scalar_integrator(self._ends)
        self._pars, self._state = self._integrator.pars, self._integrator.state  # views

    def __deepcopy__(self, memo):  # the integrator copies its callbacks
        return self

    def _ends(self, integrator, sign):
        return self._case.phase_ends(integrator.time, self._pars, self._state)

    def __call__(self, cases: Sweep) -> np.ndarray:
        rows, integrator = [], self._integrator
        for motion in cases.motions():
            self._case = case = _Case(motion, self._from_rest)
            integrator.time = case.start[0]
            case.begin(self._pars, self._state)
            integrator.reset_cooldowns()
            integrator.propagate_until(case.start[0] + _LONGEST * case.half)
            rows.append(case.features)
        return np.array(rows)


class Shooting:
    """X and θ of the reversal by shooting over half a period; a batch ends when its last case is found."""

    def __init__(self) -> None:
        self._lanes = hy.recommended_simd_size()
        self._x, self._onset = np.zeros(self._lanes), np.zeros((3, self._lanes))
        self._integrator = _batch_integrator(self._slips, self._lanes)
        self._pars, self._state = self._integrator.pars, self._integrator.state
        self._lane_pars = list(self._pars.T)

    def __deepcopy__(self, memo):
        return self

    def _slips(self, integrator, sign, i):
        x = self._x[i] + self._state[0, i]
        self._x[i], self._state[0, i] = x, 0.0
        self._onset[:, i] = integrator.time[i], x, self._state[1, i]
        _slip(self._lane_pars[i], x, 1, ends=False)
        return True

    def _half_cycles(self, X, t, half):
        integrator = self._integrator
        self._x[:] = -X
        for i, pars in enumerate(self._lane_pars):
            _stick(pars, -X[i], -_Z_M)
        self._state[:] = 0.0
        integrator.set_time(t)
        integrator.reset_cooldowns()
        integrator.propagate_until(t + half)
        return self._x + self._state[0], self._state[1].copy()

    def __call__(self, cases: Sweep) -> np.ndarray:
        features = np.empty((len(cases), 7))
        guesses = [good_guess(motion) for motion in cases.motions()]
        X_guess, theta_guess = (np.array(values) for values in zip(*guesses, strict=True))
        for members, padded in _batches(cases, self._lanes):
            omega, scale = cases.omega[padded], X_guess[padded]
            half = math.pi / omega
            self._pars[_OMEGA], self._pars[_DRIVE] = omega, PAPER.k * cases.Y[padded] / PAPER.m

            def residual(u, theta, omega=omega, scale=scale, half=half):
                x, v = self._half_cycles(u * scale, theta / omega, half)
                return x / scale - u, v / (omega * scale)

            u, theta = broyden(residual, np.ones(self._lanes), theta_guess[padded], _settled)
            X, (t_s, X_s, V_s), (_, _, b, W) = u * scale, self._onset, self._state
            phi = wrapped(theta + math.pi)
            rows = np.array([X, V_s, t_s - theta / omega, phi, 2.0 * (X - X_s), 2.0 * b, 2.0 * W])
            features[members] = rows.T[: len(members)]
        return features


def _settled(f, g):
    return bool(np.all((np.abs(f) <= AGREE) & (np.abs(g) <= AGREE)))
