"""The steady orbit to forty digits, solved with mpmath independently of the package: README.md, section 2.

Within a phase, x is a sum of exponentials, x = Σ c_j e^{λ_j t} (t from the start of the half cycle): a constant, the
forced pair e^{±iωt} and the free pair from the two roots of λ² + (c/m) λ + κ/m = 0. So are ẋ and y, and every
integral of a product of them is a sum of e^{(λ_j + λ_k) t}/(λ_j + λ_k). Only the pattern of slips and sticks and a
starting point for the root finder come from outside; neither can bias a root that is found to forty digits.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp

DIGITS = 40
_WORKING_DIGITS = 55


@dataclass(frozen=True)
class Phase:
    """One phase of a half cycle: x = Σ coefficient · e^{rate t} for start ≤ t ≤ end."""

    start: mp.mpf
    end: mp.mpf
    s: int
    terms: tuple[tuple[mp.mpc, mp.mpc], ...]  # (coefficient, rate)
    z_start: mp.mpf

    def x(self, t):
        return mp.re(mp.fsum(c * mp.exp(rate * t) for c, rate in self.terms))

    def v(self, t):
        return mp.re(mp.fsum(c * rate * mp.exp(rate * t) for c, rate in self.terms))


def _unit(angle):
    return mp.exp(1j * angle)


def phase_from(par, theta, start, end, s, x, v, z):
    """The phase that starts at (x, ẋ, z) with the contact in state s; y = Y cos(θ + ωt)."""
    m, c, k, K_z, F_k, Y, w = par
    kappa = k + K_z if s == 0 else k
    constant = K_z * (x - z) / kappa if s == 0 else -s * F_k / kappa
    forced = k * Y * _unit(theta) / (kappa - m * w * w + 1j * c * w)
    half = c / (2 * m)
    root = mp.sqrt(mp.mpc(half * half - kappa / m))
    fast, slow = -half - root, -half + root
    x_free = x - constant - mp.re(forced * _unit(w * start))
    v_free = v - mp.re(1j * w * forced * _unit(w * start))
    slow_part = (v_free - fast * x_free) / (slow - fast)
    fast_part = x_free - slow_part
    terms = (
        (mp.mpc(constant), mp.mpc(0)),
        (forced / 2, 1j * w),
        (mp.conj(forced) / 2, -1j * w),
        (slow_part * mp.exp(-slow * start), slow),
        (fast_part * mp.exp(-fast * start), fast),
    )
    return Phase(start, end, s, terms, z)


def half_cycle(par, X, theta, events, states):
    """The phases from the reversal at −X, and what must vanish for them to be an orbit.

    That is: the condition of each event, x(H) − X and ẋ(H).
    """
    Z_m = par[4] / par[3]
    times = [mp.mpf(0), *events, mp.pi / par[6]]
    x, v, z = -X, mp.mpf(0), -Z_m
    phases, equations = [], []
    for i, s in enumerate(states):
        phase = phase_from(par, theta, times[i], times[i + 1], s, x, v, z)
        phases.append(phase)
        gained = phase.x(times[i + 1]) - x
        x, v = x + gained, phase.v(times[i + 1])
        z = z + gained if s == 0 else s * Z_m
        if i + 1 < len(states):
            if s == 0:  # slip onset: the spring is at its limit on the side the mass moves to
                equations.append((z - states[i + 1] * Z_m) / Z_m)
                z = states[i + 1] * Z_m
            else:  # reversal
                equations.append(v / (par[6] * X))
                v = mp.mpf(0)
    return phases, [*equations, (x - X) / Z_m, v / (par[6] * X)]


@dataclass(frozen=True)
class ExactOrbit:
    """Features of an orbit, as in `dampbalance.Orbit`, to forty digits; harmonics as X_n e^{−iφ_n}."""

    X: mp.mpf
    X_s: mp.mpf
    V_s: mp.mpf
    t_s: mp.mpf
    phi: mp.mpf
    a: mp.mpf
    b: mp.mpf
    W: mp.mpf
    phi_zero_crossing: mp.mpf
    harmonics: dict[int, mp.mpc]
    events: list[mp.mpf]
    phases: list[Phase]


def solve(parameters, X, theta, events, states):
    """The orbit with the given pattern of states (s of each phase of a half cycle), by Newton from a starting point.

    parameters : (m, c, k, K_z, F_k, Y, omega).
    X, theta, events : starting point; inner event times from the reversal at −X.
    """
    with mp.workdps(_WORKING_DIGITS):
        par = [mp.mpf(p) for p in parameters]
        H = mp.pi / par[6]

        def residual(u):
            inner = [H * e for e in u[2:]]
            return mp.matrix(half_cycle(par, u[0] * mp.mpf(X), u[1], inner, states)[1])

        root = mp.matrix([1, mp.mpf(theta), *(mp.mpf(e) / H for e in events)])
        left, smallest = residual(root), mp.inf
        # the start holds fifteen digits or so, and with its derivatives every step gains about as many
        step, matrix = mp.mpf(10) ** (-_WORKING_DIGITS // 2), mp.matrix(len(root))
        for j, moved in enumerate(step * mp.eye(len(root)).column(j) for j in range(len(root))):
            matrix[:, j] = (residual(root + moved) - left) / step
        inverse = matrix**-1
        while mp.norm(left) < 0.1 * smallest:
            smallest, root = mp.norm(left), root - inverse * left
            left = residual(root)
        if not smallest < mp.mpf(10) ** -DIGITS:
            raise ValueError(f"no orbit near: {mp.nstr(smallest)}")
        X, theta, events = root[0] * mp.mpf(X), root[1], [H * e for e in root[2:]]
        phases, _ = half_cycle(par, X, theta, events, states)
        return _features(par, X, theta, events, states, phases)


def _product_integral(first, second, start, end):
    """∫ of the product of two sums of exponentials."""
    total = mp.mpc(0)
    for c1, r1 in first:
        for c2, r2 in second:
            rate = r1 + r2
            if abs(rate) < mp.mpf(10) ** (-DIGITS) * (abs(r1) + abs(r2)) or rate == 0:
                total += c1 * c2 * (end - start)
            else:
                total += c1 * c2 * (mp.exp(rate * end) - mp.exp(rate * start)) / rate
    return total


def _features(par, X, theta, events, states, phases):
    k, Y, w = par[2], par[5], par[6]
    onset = next(i for i, s in enumerate(states) if s == 1)
    V_s = phases[onset].v(phases[onset].start) if onset else mp.mpf(0)
    t_s = phases[onset].start
    a, b, W = mp.mpf(0), mp.mpf(0), mp.mpf(0)
    harmonics = {1: mp.mpc(0), 3: mp.mpc(0), 5: mp.mpc(0)}
    base = ((k * Y / 2 * _unit(theta), 1j * w), (k * Y / 2 * _unit(-theta), -1j * w))
    for phase in phases:
        start, end = phase.start, phase.end
        velocity = [(c * r, r) for c, r in phase.terms]
        if phase.s != 0:
            a += 2 * abs(phase.x(end) - phase.x(start))
        b += 2 * mp.re(_product_integral(velocity, velocity, start, end))
        W += 2 * mp.re(_product_integral(velocity, base, start, end))
        for n in harmonics:
            wave = ((_unit(-n * theta), -1j * n * w),)
            harmonics[n] += 2 * w / mp.pi * _product_integral(phase.terms, wave, start, end)
    rising = next(p for p in phases if p.x(p.start) < 0 <= p.x(p.end))
    crossing = mp.findroot(rising.x, (rising.start, rising.end), solver="anderson")
    return ExactOrbit(
        X,
        phases[onset].x(t_s),
        V_s,
        t_s,
        theta + mp.pi,
        a,
        b,
        W,
        theta + w * crossing + mp.pi / 2,
        harmonics,
        events,
        phases,
    )


def keeps_its_pattern(exact, Z_m, samples=40):
    """Whether the mass moves the way it slips, and |z| ≤ Z_m while it sticks, at all samples."""
    with mp.workdps(25):
        for phase in exact.phases:
            x_start = phase.x(phase.start)
            for i in range(1, samples):
                t = phase.start + (phase.end - phase.start) * i / samples
                if phase.s and phase.s * phase.v(t) <= 0:
                    return False
                if not phase.s and abs(phase.z_start + phase.x(t) - x_start) > Z_m:
                    return False
    return True
