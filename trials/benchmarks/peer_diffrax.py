"""Steady states by diffrax's Dopri8 with events, vmapped over the cases and compiled by JAX for the processor.

Settling: half cycle after half cycle, each a stick and a slip phase that an event ends, until all cases of the batch
are steady. Shooting: Broyden's method on one such half cycle, until all cases of the batch are found.
"""

from __future__ import annotations

import diffrax
import equinox
import jax
import numpy as np
import optimistix

from .cases import PAPER, Sweep, good_guess, wrapped
from .shooting import MOST_STEPS, broyden_update, first_jacobian, newton_step

jax.config.update("jax_enable_x64", True)
jnp = jax.numpy

RTOL = 1e-10
AGREE = 1e-10  # relative, of two successive half cycles; of the residual of shooting
MOST_HALF_CYCLES = 400
BATCH = 256  # cases solved together, of neighbouring frequencies; the fastest of 16, 64 and 256


def _rate(t, y, args):
    (u, v, _, _), (kappa, force, drive, omega, _, _) = y, args
    base = drive * jnp.cos(omega * t)
    return v, base - PAPER.c / PAPER.m * v - force - kappa * u, v * v, PAPER.m * base * v


def _end(t, y, args, **_):
    """Return what rises through zero at the end of a phase: −s ẋ in slip, (z + u)² − Z_m² in stick, over Z_m²."""
    (u, v, _, _), (_, _, _, _, s, z) = y, args
    u = u / PAPER.Z_m
    return jnp.where(s == 0.0, z * z - 1.0 + u * (2.0 * z + u), -s * v)


_SOLVER = diffrax.Dopri8()
_CONTROLLER = diffrax.PIDController(rtol=RTOL, atol=1e-15)
_EVENT = diffrax.Event(_end, optimistix.Newton(rtol=1e-11, atol=1e-12), direction=True)


def _phase(t, until, x, v, z, s, Y, omega, event=_EVENT):
    """Return (t, gain u, ẋ, ∫ẋ² dt, ∫kyẋ dt) at the end of the phase from (x, ẋ, z Z_m) at time t in state s."""
    o = PAPER
    kappa = jnp.where(s == 0.0, o.k + o.K_z, o.k) / o.m
    force = (o.k * x + o.F_k * jnp.where(s == 0.0, z, s)) / o.m
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(_rate),
        _SOLVER,
        t,
        until,
        0.01 * jnp.pi / omega,
        (jnp.zeros_like(v), v, jnp.zeros_like(v), jnp.zeros_like(v)),
        args=(kappa, force, o.k * Y / o.m, omega, s, z),
        stepsize_controller=_CONTROLLER,
        event=event,
        max_steps=4096,
    )
    return solution.ts[-1], *(component[-1] for component in solution.ys)


def _settle(t, x, z, Y, omega):
    half = jnp.pi / omega

    def half_cycle(carry):
        n, t_0, x_0, z, _, _ = carry
        rest = jnp.zeros_like(t_0)
        t_s, u, V_s, b_1, W_1 = _phase(t_0, t_0 + 4.0 * half, x_0, rest, z, rest, Y, omega)
        s, x_s = jnp.sign(V_s), x_0 + u
        t_1, u, _, b_2, W_2 = _phase(t_s, t_s + 4.0 * half, x_s, V_s, s, s, Y, omega)
        x_1 = x_s + u
        steady = (jnp.abs(x_1 + x_0) <= AGREE * jnp.abs(x_1)) & (
            jnp.abs(t_1 - t_0 - half) <= AGREE * half
        )
        phi = omega * t_1 + jnp.where(s > 0.0, 0.0, jnp.pi)
        features = (
            *(jnp.abs(x_1), jnp.abs(V_s), t_s - t_0, phi),
            *(2.0 * jnp.abs(u), 2.0 * (b_1 + b_2), 2.0 * (W_1 + W_2)),
        )
        return n + 1, t_1, x_1, s, steady, jnp.stack(features)

    def unsteady(carry):
        return ~carry[4] & (carry[0] < MOST_HALF_CYCLES)

    start = (0, t, x, z, jnp.array(False), jnp.zeros(7))
    return jax.lax.while_loop(unsteady, half_cycle, start)[-1]


def _shoot(t, x, _, Y, omega):
    """Return the orbit found from the guess: rest at x = −X at time t."""
    half, X_guess = jnp.pi / omega, -x

    def half_cycle(u, theta):
        t_0, x_0, rest = theta / omega, -u * X_guess, jnp.zeros_like(theta)
        t_s, gain, V_s, b_1, W_1 = _phase(t_0, t_0 + half, x_0, rest, rest - 1.0, rest, Y, omega)
        one = rest + 1.0
        _, slip, v, b_2, W_2 = _phase(
            t_s, t_0 + half, x_0 + gain, V_s, one, one, Y, omega, event=None
        )
        x = x_0 + gain + slip
        phi = theta + jnp.pi
        features = (x, V_s, t_s - t_0, phi, 2.0 * slip, 2.0 * (b_1 + b_2), 2.0 * (W_1 + W_2))
        return (x / X_guess - u, v / (omega * X_guess)), jnp.stack(features)

    def residual(u, theta):
        return half_cycle(u, theta)[0]

    def step(carry):
        n, u, theta, (f, g), jacobian, _ = carry
        du, dtheta = newton_step(jacobian, f, g)
        u, theta = u + du, theta + dtheta
        (f, g), features = half_cycle(u, theta)
        return n + 1, u, theta, (f, g), broyden_update(jacobian, du, dtheta, f, g), features

    def not_found(carry):
        n, (f, g) = carry[0], carry[3]
        return (jnp.maximum(jnp.abs(f), jnp.abs(g)) > AGREE) & (n < MOST_STEPS)

    u, theta = jnp.ones_like(t), t * omega
    at_guess = residual(u, theta)
    jacobian = first_jacobian(residual, u, theta, *at_guess)
    start = (0, u, theta, at_guess, jacobian, jnp.zeros(7))
    return jax.lax.while_loop(not_found, step, start)[-1]


_settle_all = equinox.filter_jit(jax.vmap(_settle))
_shoot_all = equinox.filter_jit(jax.vmap(_shoot))


def _solve(solve_all, cases: Sweep, starts: np.ndarray) -> np.ndarray:
    """Return the orbits of cases.   starts : (n, 3), (t, x, z/Z_m) of each case at rest."""
    features = np.empty((len(cases), 7))
    order = np.argsort(cases.omega)
    for first in range(0, len(order), BATCH):
        members = order[first : first + BATCH]
        padded = np.resize(members, BATCH)  # one shape, compiled once
        found = solve_all(*starts[padded].T, cases.Y[padded], cases.omega[padded])
        features[members] = np.asarray(found)[: len(members)]
    features[:, 3] = wrapped(features[:, 3])
    return features


def _guesses(cases: Sweep) -> np.ndarray:
    guesses = [(good_guess(motion), motion) for motion in cases.motions()]
    return np.array([(g.theta / m.omega, -g.X, -1.0) for g, m in guesses])


def from_rest(cases: Sweep) -> np.ndarray:
    return _solve(_settle_all, cases, np.zeros((len(cases), 3)))


def from_guess(cases: Sweep) -> np.ndarray:
    return _solve(_settle_all, cases, _guesses(cases))


def shooting(cases: Sweep) -> np.ndarray:
    return _solve(_shoot_all, cases, _guesses(cases))
