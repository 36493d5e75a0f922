"""A contact that yields gradually: the exact motion on several Jenkins elements in parallel.

Element j is a spring κ_j in series with a slider that gives way under κ_j r_j; z_j is the deflection of its spring:

    m ẍ + c ẋ + k x + Σ κ_j z_j = k y,      ż_j = ẋ while |z_j| < r_j;   z_j = r_j sgn ẋ in slip

From one event to the next the mass moves as a linear oscillator on k and the springs that stick, by the closed form of
`motion/flow.py`. An event is the onset of slip of one more element, or a reversal, after which all of them stick.

What `motion/period_map.py` shows for one element holds for each: two motions under the same excitation approach each
other. With c > 0 the steady velocity is therefore unique and its own mirror image half a period later, and the orbit
is the fixed point of s ↦ −Φ(s), s = (x, ẋ, z_1 … z_n), in which an element that never slips is centred on zero.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import instance, numbers
from ..arrays import Array
from ..jit import jit
from ..model import BaseMotion, Oscillator, Parameters, parameters
from .events import MOST_RADIANS, PHASE_S, PHASE_T, PHASE_V, PHASE_X, PHASE_Z, leaving
from .flow import Phase, move, step_response, unit
from .orbit import NoSteadyOrbit
from .states import State

MOST_SLIDERS = 200
"""Largest number of elements; an orbit on that many takes a tenth of a second, and the time grows as the cube."""

_ACCEPTED = 1e-12
"""Energy norm of s + Φ(s), relative to that of s, below which a step that does not help is blamed on rounding."""


class Sliding(NamedTuple):
    """Numbers that kernels take: the oscillator and its excitation, r_j, m, and κ_j, N/m, of the elements, (n,)."""

    par: Parameters
    r: Array
    kappa: Array


@jit
def _slip(state: Array, theta: float, of: Sliding) -> float:
    """Return ±1 where elements slip that way, or are about to, at a state and base phase θ; 0 where all of them
    stick."""
    par, way = of.par, state[1]
    if way == 0.0:
        way = par.k * (par.Y * math.cos(theta) - state[0])
        for j in range(of.r.size):
            way -= of.kappa[j] * state[2 + j]
    for j in range(of.r.size):
        if abs(state[2 + j]) >= of.r[j] and state[2 + j] * way > 0.0:
            return math.copysign(1.0, way)
    return 0.0


@jit
def _phase(state: Array, s: float, theta: float, of: Sliding) -> Phase:
    """Return the phase that starts at a state and base phase θ, in which the elements with z_j = s r_j slip."""
    par, stiffness, force = of.par, of.par.k, -of.par.k * state[0]
    for j in range(of.r.size):
        force -= of.kappa[j] * state[2 + j]
        if s * state[2 + j] < of.r[j]:
            stiffness += of.kappa[j]
    A = par.k * par.Y / par.m * unit(theta)
    return Phase(state[1], force / par.m, A, par.c / (2.0 * par.m), stiffness / par.m, par.omega)


@jit
def _pass(state: Array, s: float, theta: float, limit: float, of: Sliding, carried: Array) -> float:
    """Take a state to the end of its phase, or to `limit`, s; return the duration.   carried : as for `follow`."""
    par, z, changes = of.par, state[2:], carried[2:]
    phase = _phase(state, s, theta, of)
    # bounds of the displacement gained, while no other element slips
    lower, upper = -math.inf, math.inf
    for j in range(z.size):
        if s * z[j] < of.r[j]:
            lower, upper = max(lower, -of.r[j] - z[j]), min(upper, of.r[j] - z[j])
    turns, slips, t, level = False, False, limit, 0.0
    if s > 0.0:
        turns, t, _ = leaving(1, 0.0, math.inf, limit, phase)
        lower = -math.inf
    elif s < 0.0:
        turns, t, _ = leaving(1, -math.inf, 0.0, limit, phase)
        upper = math.inf
    if upper < math.inf or lower > -math.inf:
        slips, t, level = leaving(0, lower, upper, t, phase)
    side = 1.0 if level == upper else -1.0
    u, rate = move(t, phase)
    J, S, R = step_response(t, phase.delta, phase.Omega2)
    for i in range(carried.shape[1]):
        dx, dv = carried[0, i], carried[1, i]
        pull = par.k / par.m * dx
        for j in range(z.size):
            if s * z[j] < of.r[j]:
                pull += of.kappa[j] / par.m * changes[j, i]
        gained = S * dv - J * pull
        carried[0, i], carried[1, i] = dx + gained, R * dv - S * pull
        for j in range(z.size):
            changes[j, i] = changes[j, i] + gained if s * z[j] < of.r[j] else 0.0
    for j in range(z.size):
        if s * z[j] < of.r[j]:
            edge = side * of.r[j]
            z[j] = edge if slips and side * (edge - z[j] - level) <= 0.0 else z[j] + u
    state[0] += level if slips else u
    state[1] = 0.0 if turns and not slips else rate
    return t if turns or slips else limit


@jit
def follow(
    state: Array, theta: float, end: float, of: Sliding, phases: Array, carried: Array
) -> int:
    """Take a state on for a time `end`, s, from the base phase θ; return the number of phases, 0 where their rows run
    out.

    state : (x, ẋ, z_1 … z_n), changed in place.   phases : row i receives (t, s, x, ẋ, z_1 … z_n) at the start of phase
    i.   carried : changes of the state, (2 + n, any number), taken along to its end. The forces are continuous across
    events, so that changes pass these as they are, except those of z_j, which slip wipes out.
    """
    t, count = 0.0, 0
    while t < end:
        if count == phases.shape[0]:
            return 0
        now = theta + of.par.omega * t
        s = _slip(state, now, of)
        phases[count, PHASE_T], phases[count, PHASE_S], phases[count, PHASE_X:] = t, s, state
        duration = _pass(state, s, now, end - t, of, carried)
        t = end if duration >= end - t else t + duration
        count += 1
    return count


@jit
def _states(times: Array, phases: Array, theta: float, of: Sliding) -> Array:
    """Return x, ẋ, ẍ and Σ κ_j z_j / Σ κ_j at `times` (n,), the rows of an array (4, n); θ at the time zero."""
    par, out, last = of.par, np.empty((4, times.size)), -1
    rows = np.searchsorted(phases[:, PHASE_T], times, side="right") - 1
    for i in range(times.size):
        if rows[i] != last:
            last = rows[i]
            start, state = phases[last, PHASE_T], phases[last, PHASE_X:]
            phase = _phase(state, phases[last, PHASE_S], theta + par.omega * start, of)
        u, v = move(times[i] - start, phase)
        x, contact = state[0] + u, -phase.f0 * par.m - par.k * state[0]
        contact += (phase.Omega2 * par.m - par.k) * u
        force = par.k * (par.Y * math.cos(theta + par.omega * times[i]) - x) - contact
        out[0, i], out[1, i], out[2, i] = x, v, (force - par.c * v) / par.m
        out[3, i] = contact / np.sum(of.kappa)
    return out


def _mirrored_state(
    closure: Callable[[Array], tuple[Array, Array]], start: Array, weights: Array, most: int
) -> Array | None:
    """Return the state s with Φ(s) = −s; None if it is not found within `most` steps, or any amplitude would do.

    A Newton step that leads away is replaced by −Φ(s), which is never farther from the orbit than s.

    closure : gives s + Φ(s), (n,), and its derivative, (n, n).   weights : whose product with a state has the root of
    twice its energy as its norm, (n,).
    """
    s, (residual, derivative) = start, closure(start)
    for _ in range(most):
        size, error = np.linalg.norm(weights * s), np.linalg.norm(weights * residual)
        # relative energy norm, to rounding
        if error <= 1e-14 * size:
            break
        trial = s - np.linalg.lstsq(derivative, residual)[0]
        nearer = closure(trial)
        left = np.linalg.norm(weights * nearer[0])
        if error <= _ACCEPTED * size and left >= 0.5 * error:
            break  # rounding keeps it from going lower
        if left < error:
            s, (residual, derivative) = trial, nearer
        else:
            s = s - residual
            residual, derivative = closure(s)
    else:
        return None
    scaled = derivative * weights[:, None] / weights
    # least singular value of 1 + ∂Φ/∂s, about π times the damping ratio: less is rounding
    return s if np.linalg.svd(scaled, compute_uv=False)[-1] >= 1e-9 else None


def _reversal(phases: Sequence[Array], period: float) -> tuple[float, list[float]] | None:
    """Return (t, state) of the reversal at −X, s, among the phases of a period; None where the velocity has no zero at
    the start of one.   phases : rows (t, s, x, ẋ, z …).

    Within a period both extremes occur, unless one is at its start: the other, mirrored, gives the reversal at −X.
    """
    turns = [row for row in phases[1:] if row[PHASE_V] == 0.0]
    if not turns:
        return None
    row = max(turns, key=lambda row: abs(row[PHASE_X]))
    side = math.copysign(1.0, row[PHASE_X])
    t = float(row[PHASE_T]) + 0.5 * period * (side > 0.0)
    return t % period, (-side * row[PHASE_X:]).tolist()


@dataclass(frozen=True, eq=False)
class SlidersOrbit:
    """Steady response on several Jenkins elements, in place of an `Orbit` where a motion is sampled.

    The half cycle from the reversal at x = −X on; the other half is the mirror image, x(t + T/2) = −x(t).

    oscillator, motion : what moves, and its base.   r, kappa : of the elements, m, N/m, (n,), the oscillator's last.
    theta : phase of the base, ωt, at the reversal at −X, rad.
    phases : (any, 4 + n), rows (t, s, x, ẋ, z_1 … z_n) at the start of each phase; t from the reversal, s; s = ±1 where
    the elements with z_j = s r_j slip, 0 where all stick.
    """

    oscillator: Oscillator
    motion: BaseMotion
    r: Array
    kappa: Array
    theta: float
    phases: Array = field(repr=False)

    @property
    def X(self) -> float:
        """Peak displacement, m."""
        return -float(self.phases[0, PHASE_X])

    @property
    def friction_loss(self) -> float:
        """Energy that the sliders take per cycle, J: each κ_j r_j times the distance that it slides, which is 4 (X −
        r_j), or zero for r_j > X, where the mass reverses once per half cycle."""
        gained = np.abs(np.diff(np.append(self.phases[:, PHASE_X], self.X)))
        slips = self.phases[:, [PHASE_S]] * self.phases[:, PHASE_Z:] >= self.r
        return 2.0 * float(gained @ slips @ (self.kappa * self.r))

    def state(self, t: ArrayLike) -> State:
        """Return (x, ẋ, ẍ, z) at the times t, s, any shape; y = Y cos ωt.   z : Σ κ_j z_j / Σ κ_j, m."""
        times, half = numbers("t", t), 0.5 * self.motion.period
        since = np.mod(times.ravel() - self.theta / self.motion.omega, 2.0 * half)
        mirrored = since >= half
        since[mirrored] -= half
        of = Sliding(parameters(self.oscillator, self.motion), self.r, self.kappa)
        rows = _states(since, self.phases, self.theta, of)
        return State(*(row.reshape(times.shape) for row in np.where(mirrored, -rows, rows)))


def sliders_orbit(
    oscillator: Oscillator, motion: BaseMotion, r: ArrayLike, kappa: ArrayLike
) -> SlidersOrbit:
    """Return the exact steady response to harmonic base motion of an oscillator on several Jenkins elements in
    parallel.

    Use it for a contact that yields gradually, as bolted joints do, in place of `steady_orbit`. The elements stand next
    to the oscillator's own K_z and F_k; give that F_k = 0 where they are the whole contact, and its K_z has no effect.

    r : deflections at which they slip, r_j, m, (n,).   kappa : their stiffnesses κ_j, N/m, (n,). Element j slips under
    the force κ_j r_j; the friction force of the whole is their sum.

    Raises ValueError naming the argument, NoSteadyOrbit where there is none (nothing is lost, at resonance) or none was
    found.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, sliders_orbit
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=0.0)
    >>> motion = BaseMotion(Y=0.004, omega=2 * math.pi * 4.92)
    >>> orbit = sliders_orbit(osc, motion, r=[1e-4, 3e-4, 9e-4], kappa=[4000.0, 1300.0, 500.0])
    >>> f"X = {1000 * orbit.X:.3f} mm, {1000 * orbit.friction_loss:.2f} mJ per cycle"
    'X = 2.848 mm, 11.88 mJ per cycle'
    """
    par = parameters(oscillator, instance("motion", motion, BaseMotion))
    r, kappa = np.atleast_1d(numbers("r", r)), np.atleast_1d(numbers("kappa", kappa))
    if r.ndim != 1 or r.shape != kappa.shape or not 1 <= r.size <= MOST_SLIDERS:
        wanted = f"r and kappa must be lists of one length, 1 to {MOST_SLIDERS}"
        raise ValueError(f"{wanted}, got shapes {r.shape} and {kappa.shape}")
    if oscillator.F_k > 0.0:
        r, kappa = np.append(r, oscillator.Z_m), np.append(kappa, oscillator.K_z)
    of, half, n = Sliding(par, r, kappa), 0.5 * motion.period, r.size
    phases, nothing = np.empty((256 + 8 * n, 4 + n)), np.empty((2 + n, 0))

    def closure(state: Array) -> tuple[Array, Array]:
        end, carried = state.copy(), np.eye(2 + n)
        end[2:] = np.clip(end[2:], -r, r)
        followed = follow(end, 0.0, half, of, phases, carried)
        return (state + end if followed else np.full(2 + n, np.inf)), np.eye(2 + n) + carried

    fastest = max(math.sqrt((par.k + kappa.sum()) / par.m), par.c / par.m, par.omega)
    # 2,000 pairs of half periods; Newton's method takes ten or so
    most = min(2000, int(0.5 * MOST_RADIANS / (half * fastest)))
    state = _mirrored_state(closure, np.zeros(2 + n), np.sqrt([par.k, par.m, *kappa]), most)
    if state is None:
        raise NoSteadyOrbit(f"found no steady orbit of {oscillator} on {n} sliders under {motion}")
    count = follow(state, 0.0, 2.0 * half, of, phases, nothing)
    if turned := _reversal([*phases[:count]], motion.period):
        theta, state = par.omega * turned[0], np.array(turned[1])
    else:  # nothing slips: a linear oscillator
        stiffness = par.k + kappa.sum() - par.m * par.omega**2
        x = par.k * par.Y / complex(stiffness, par.c * par.omega)
        theta, state = math.pi - cmath.phase(x), np.full(2 + n, -abs(x))
        state[1] = 0.0
    count = follow(state, theta, half, of, phases, nothing)
    # 1e-12 relative to half a period: a shorter last phase is the rounding of the half period
    while count > 1 and half - phases[count - 1, PHASE_T] < 1e-12 * half:
        count -= 1
    return SlidersOrbit(oscillator, motion, r, kappa, theta, phases[:count].copy())


def spread_contact(oscillator: Oscillator, ratio: float, count: int = 32) -> tuple[Array, Array]:
    """Return (r, κ) of elements that share the K_z and F_k of an oscillator and slip one after the other.

    κ_j = K_z/n each, ln r_j evenly spaced, r_n/r_1 = ratio, and Σ κ_j r_j = F_k > 0. With ratio 1 they are its contact.
    """
    lengths = np.geomspace(1.0, ratio, count)
    return oscillator.Z_m * lengths / lengths.mean(), np.full(count, oscillator.K_z / count)
