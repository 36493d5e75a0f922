"""Motion of rigs in fixed steps, by nothing of the package: other damping laws, springs, contacts and frames.

A mass on a spring, a damper and a contact, which stand on a frame that moves by s (x = s = 0 at rest):

    m x″ + c (x′ − s′) + c₂ |x′| x′ + c₃ x′³ + g (x − σs) + Σ f_j = k (y + y₂₃) + c_r y′,   g(d) = k d + k₂ d² + k₃ d³
    m_s s″ + c_s s′ + k_s s = c (x′ − s′) + σ g (x − σs) + Σ f_j
    y = Y cos ωt,   y₂₃ = Y₂ cos 2ωt + Y₃ cos 3ωt

σ = 1 in a free decay, whose spring stands on the frame, and wherever the frame is rigid; 0 where a shaker moves the
other end of the spring.

A contact is a list of elements of the stiffness K_j and the friction force F_j. A slider has f_j′ = K_j v within
± F_j (1 + S e^(−|v|/v_s) ± A + B sin(Ωt + ψ) + D x), v = x′ − s′ (Jenkins). An element of Dahl's kind has
f_j′ = ½K_j v (1 − f_j sgn(v)/F_j), one of Bouc's and Wen's f_j′ = K_j v (1 − |f_j/F_j|ⁿ (1 + sgn(f_j v))/2), n = 1, 2.
Between two reversals the force of an element is a function of the displacement alone, which is followed exactly over a
step; x is followed by the method of Runge and Kutta of order 4. At the kinks of a slider that is of order 2: with 8192
steps a period 1e-6 of the motion, far below any fault.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from .truths import Linear, Truth

STEPS = 8192
"""Of a period of the drive, or of a natural period."""

_MOST_PERIODS = 3000
_REPEATS = 1e-9  # of the displacement

Contact = np.ndarray
"""Rows (K_j, F_j, kind) of the elements of a contact; kind 0: a slider, 1: Dahl's, 1 + n: Bouc's and Wen's."""


class Departure(NamedTuple):
    """Departures from the model.

    quadratic : c₂, N s²/m².   even, cubic : k₂, N/m², k₃, N/m³.   third, second : Y₃/Y, Y₂/Y.
    falling, speed : S and v_s, m/s.   relative : c_r, N s/m.   third_power : c₃, N s³/m³.
    structural : η, a damper of η k/ω.
    """

    quadratic: float = 0.0
    even: float = 0.0
    cubic: float = 0.0
    third: float = 0.0
    falling: float = 0.0
    speed: float = 1.0
    relative: float = 0.0
    third_power: float = 0.0
    structural: float = 0.0
    second: float = 0.0


NO_DEPARTURE = Departure()


class Rig(NamedTuple):
    """Numbers of the equations, SI units; sigma : σ.   falling, speed : S, v_s.   sided : A.   varying, rate, phase :
    B, Ω, ψ.   sloping : D.   quadratic, third_power, relative : c₂, c₃, c_r.   second, third : Y₂/Y, Y₃/Y."""

    m: float
    c: float
    k: float
    k_3: float = 0.0
    Y: float = 0.0
    omega: float = 0.0
    m_s: float = 0.0
    c_s: float = 0.0
    k_s: float = 0.0
    sigma: float = 1.0
    falling: float = 0.0
    speed: float = 1.0
    sided: float = 0.0
    varying: float = 0.0
    rate: float = 0.0
    phase: float = 0.0
    sloping: float = 0.0
    k_2: float = 0.0
    quadratic: float = 0.0
    third_power: float = 0.0
    relative: float = 0.0
    second: float = 0.0
    third: float = 0.0

    def departing(self, how: Departure) -> Rig:
        """Return the rig with a departure."""
        structural = how.structural and how.structural * self.k / self.omega
        own = how._asdict()
        k_2, k_3 = own.pop("even"), own.pop("cubic")
        del own["structural"]
        return self._replace(c=self.c + how.relative + structural, k_2=k_2, k_3=k_3, **own)


def one_slider(K_z: float, F_k: float) -> Contact:
    """Return the contact of the model."""
    return np.array([(K_z, F_k, 0.0)])


@njit(cache=True)
def moved(f, u, element):
    """Return the force of an element after a displacement u one way, whatever the speed."""
    K, F, kind = element
    if kind == 0.0:
        return min(max(f + K * u, -F), F)
    end = F if u > 0.0 else -F
    if kind == 1.0:
        return end + (f - end) * math.exp(-0.5 * K * abs(u) / F)
    # the force in the direction of motion; elastic until it is zero
    part, way = f / end, K * abs(u) / F
    elastic = min(max(-part, 0.0), way)
    part, way = part + elastic, way - elastic
    if kind == 2.0:
        return end * (1.0 - (1.0 - part) * math.exp(-way))
    return end * (part + math.tanh(way)) / (1.0 + part * math.tanh(way))


@njit(cache=True)
def _pushed(f, u, t, x, v, rig, element):
    """Return the force of an element after a displacement u one way, at the time t, the displacement x and the speed
    v."""
    K, F, kind = element
    if kind > 0.0:
        return moved(f, u, element)
    limit = 1.0 + rig.sloping * x
    if rig.varying != 0.0:
        limit += rig.varying * math.sin(rig.rate * t + rig.phase)
    if rig.falling != 0.0:
        limit += rig.falling * math.exp(-abs(v) / rig.speed)
    return min(max(f + K * u, -F * (limit - rig.sided)), F * (limit + rig.sided))


@njit(cache=True)
def _drive(t, rig):
    """Return the force of the base, N."""
    if rig.Y == 0.0:
        return 0.0
    turn = rig.omega * t
    y, w = math.cos(turn), 0.0
    if rig.second != 0.0 or rig.third != 0.0:
        y += rig.second * math.cos(2.0 * turn) + rig.third * math.cos(3.0 * turn)
    if rig.relative != 0.0:
        w = math.sin(turn) + 2.0 * rig.second * math.sin(2.0 * turn)
        w = -rig.omega * (w + 3.0 * rig.third * math.sin(3.0 * turn))
    return (rig.k * y + rig.relative * w) * rig.Y


@njit(cache=True)
def _accelerations(t, state, u, f, rig, contact):
    """Return x″ and s″ of a state (x, x′, s, s′), the contact moved by u since its forces were f."""
    x, v, s, w = state
    force = rig.c * (v - w) + (rig.quadratic * abs(v) + rig.third_power * v * v) * v
    for j in range(f.size):
        force += _pushed(f[j], u, t, x, v - w, rig, contact[j])
    stretch = x - rig.sigma * s
    spring = (rig.k + rig.k_2 * stretch + rig.k_3 * stretch * stretch) * stretch
    of_mass = (_drive(t, rig) - spring - force) / rig.m
    if rig.m_s == 0.0:
        return of_mass, 0.0
    return of_mass, (force + rig.sigma * spring - rig.c_s * w - rig.k_s * s) / rig.m_s


@njit(cache=True)
def follow(rig, contact, state, f, t, h, every, out):
    """Follow a state (x, x′, s, s′), which changes like the forces f of the contact; (x, x′, x″) of each step number
    0, every, 2 every, … into out, (3, n).   t : s, at the start.   h : step, s.   Returns the time at the end."""
    x, v, s, w = state
    start = t
    for i in range(out.shape[1] * every):
        t = start + i * h
        a1, b1 = _accelerations(t, (x, v, s, w), 0.0, f, rig, contact)
        if i % every == 0:
            out[0, i // every], out[1, i // every], out[2, i // every] = x, v, a1
        g = 0.5 * h
        v2, w2 = v + g * a1, w + g * b1
        u = g * (v - w)
        a2, b2 = _accelerations(t + g, (x + g * v, v2, s + g * w, w2), u, f, rig, contact)
        v3, w3 = v + g * a2, w + g * b2
        u = g * (v2 - w2)
        a3, b3 = _accelerations(t + g, (x + g * v2, v3, s + g * w2, w3), u, f, rig, contact)
        v4, w4 = v + h * a3, w + h * b3
        u = h * (v3 - w3)
        a4, b4 = _accelerations(t + h, (x + h * v3, v4, s + h * w3, w4), u, f, rig, contact)
        dx, ds = h / 6.0 * (v + 2.0 * (v2 + v3) + v4), h / 6.0 * (w + 2.0 * (w2 + w3) + w4)
        x, s = x + dx, s + ds
        v += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
        w += h / 6.0 * (b1 + 2.0 * (b2 + b3) + b4)
        for j in range(f.size):
            f[j] = _pushed(f[j], dx - ds, t + h, x, v - w, rig, contact[j])
    state[:] = x, v, s, w
    return start + out.shape[1] * every * h


def steady_motion(rig: Rig, contact: Contact) -> CubicSpline:
    """Return (x, x′, x″) of the steady period as a periodic function of ωt, SI."""
    out, f, state = np.empty((3, STEPS)), np.zeros(len(contact)), np.zeros(4)
    for _ in range(_MOST_PERIODS):
        before = state[0]
        follow(rig, contact, state, f, 0.0, 2.0 * math.pi / rig.omega / STEPS, 1, out)
        if abs(state[0] - before) < _REPEATS * np.abs(out[0]).max():
            break
    else:
        raise ArithmeticError(f"no steady motion of {rig}")
    phases = np.linspace(0.0, 2.0 * math.pi, STEPS + 1)
    return CubicSpline(phases, np.column_stack([out, out[:, 0]]), axis=1, bc_type="periodic")


def steady(numbers: tuple[float, ...], departure: Departure) -> CubicSpline:
    """Return the `steady_motion` of (m, c, k, K_z, F_k, Y, ω) with a departure."""
    m, c, k, K_z, F_k, Y, omega = numbers
    return steady_motion(Rig(m, c, k, Y=Y, omega=omega).departing(departure), one_slider(K_z, F_k))


def numbers_of(truth: Truth, level: int) -> tuple[float, ...]:
    """Return (m, c, k, K_z, F_k, Y, ω) of a level."""
    t = truth
    return (t.m, t.c, t.k, t.K_z, t.F_k, t.Y[level], t.omega)


def in_units(departure: Departure, truth: Truth) -> Departure:
    """Return a departure that is given in units of c, k, the displacement of a linear oscillator at the highest level,
    and its speed."""
    t = truth
    X = t.k * t.Y[-1] / abs(complex(t.k - t.m * t.omega**2, t.c * t.omega))
    return departure._replace(
        quadratic=departure.quadratic * t.c / (X * t.omega),
        even=departure.even * t.k / X,
        cubic=departure.cubic * t.k / X**2,
        speed=departure.speed * X * t.omega,
    )


def from_rest(truth: Truth, level: int, periods: int) -> CubicSpline:
    """Return (x, x′, x″) from rest at ωt = 0 on, over `periods` periods, as a function of ωt, SI."""
    m, c, k, K_z, F_k, Y, omega = numbers_of(truth, level)
    out, phases = np.empty((3, periods * STEPS)), np.arange(periods * STEPS) * 2.0 * math.pi / STEPS
    rig, contact = Rig(m, c, k, Y=Y, omega=omega), one_slider(K_z, F_k)
    follow(rig, contact, np.zeros(4), np.zeros(1), 0.0, phases[1] / omega, 1, out)
    return CubicSpline(phases, out, axis=1)


def ring_down_on(
    contact: Contact,
    oscillator: Linear,
    x: float,
    v: float,
    f: np.ndarray,
    step: float,
    lasts: float,
    departure: Departure = NO_DEPARTURE,
) -> np.ndarray:
    """Return (x, x′, x″) of a free motion from (x, v) on, sampled each `step` seconds, (3, n), SI.

    f : forces of the elements at the start, N.   lasts : s.
    """
    every = max(1, math.ceil(step * oscillator.omega_n * STEPS / (2.0 * math.pi)))
    out, state = np.empty((3, math.ceil(lasts / step))), np.array([x, v, 0.0, 0.0])
    rig = Rig(oscillator.m, oscillator.c, oscillator.k).departing(departure)
    follow(rig, contact, state, f.copy(), 0.0, step / every, every, out)
    return out
