"""The flow of one linear phase against 60-digit arithmetic: README.md, section 1."""

from __future__ import annotations

import itertools

import mpmath as mp
import numpy as np
import pytest

from dampbalance.motion.flow import Phase, move, step_response

EPS = np.finfo(float).eps

# δ/Ω: undamped, hardly damped, on both sides of critical, very over-damped
DAMPING = [0.0, 1e-9, 0.02, 0.9, *(1.0 + d for d in (-1e-2, -1e-6, -1e-12, 0, 1e-9, 1e-4))]
DAMPING += [1.2, 30.0, 1e3]
# Ωt: decades, and both sides of every place where the implementation may change its formula
TIMES = [10.0**n for n in range(-9, 4)]
TIMES += [0.019, 0.05, 0.1, 0.199, 0.201, 0.5, 0.99, 1.01, 2.0, 3.0, 30.0]
DRIVES = [0.01, 0.9, 1.0 - 1e-9, 1.0, 1.05, 3.0, 50.0]  # ω/Ω
OMEGAS = [1.0, 17.3]  # Ω, 1/s
FORCED_TIMES = [1e-9, 1e-6, 1e-3, 0.05, 0.2, 0.5, 0.99, 1.01, 3.0, 30.0, 1e3]


@pytest.fixture(autouse=True)
def sixty_digits():
    with mp.workdps(60):
        yield


def exact_step_response(t, delta, Omega2):
    """J, J̇, J̈ of J̈ + 2δJ̇ + Ω²J = 1 from rest, by the roots of the characteristic polynomial."""
    t, delta, Omega2 = mp.mpf(t), mp.mpf(delta), mp.mpf(Omega2)
    sigma2 = delta * delta - Omega2
    if sigma2 == 0:
        C, sinhc = mp.mpf(1), t
    else:
        sigma = mp.sqrt(mp.mpc(sigma2))
        C, sinhc = mp.re(mp.cosh(sigma * t)), mp.re(mp.sinh(sigma * t) / sigma)
    decay = mp.exp(-delta * t)
    S = decay * sinhc
    return (1 - decay * C - delta * S) / Omega2, S, decay * C - delta * S


def exact_harmonic_response(t, omega, delta, Omega2):
    """P and Ṗ of P̈ + 2δṖ + Ω²P = e^{iωt} from rest: steady response less the free motion with its initial values."""
    J, S, R = exact_step_response(t, delta, Omega2)
    t, delta, Omega2, omega = mp.mpf(t), mp.mpf(delta), mp.mpf(Omega2), mp.mpf(omega)
    if delta == 0 and omega * omega == Omega2:
        omega *= 1 + mp.mpf(10) ** -25  # the limit: an error of 1e-25, and 35 digits left
    D = Omega2 - omega * omega + 2j * delta * omega
    wave = mp.exp(1j * omega * t)
    free, free_rate = 1 - Omega2 * J, -Omega2 * S
    return (wave - free - 1j * omega * S) / D, (1j * omega * wave - free_rate - 1j * omega * R) / D


def harmonic_response(t, omega, delta, Omega2):
    """P and Ṗ as the flow has them: Re[A P] for A = 1 and A = −i."""
    real = move(t, Phase(0.0, 0.0, 1.0 + 0.0j, delta, Omega2, omega))
    imaginary = move(t, Phase(0.0, 0.0, 0.0 - 1.0j, delta, Omega2, omega))
    return complex(real[0], imaginary[0]), complex(real[1], imaginary[1])


@pytest.mark.parametrize("ratio", DAMPING)
def test_step_response(ratio):
    for Omega, x in itertools.product(OMEGAS, TIMES):
        t, delta, Omega2 = x / Omega, ratio * Omega, Omega * Omega
        J, S, R = step_response(t, delta, Omega2)
        exact_J, exact_S, exact_R = exact_step_response(t, delta, Omega2)
        # J starts as t²/2 and stays positive: relative. The rounding of the argument Ωt turns a phase by Ωt units;
        # 40 units are what the longest cancellation (Ωt = 0.1 at critical damping) leaves.
        tolerance = (40.0 + 2.0 * x) * EPS
        assert abs(J - exact_J) <= tolerance * exact_J, (Omega, x)
        # S and R change sign: relative to their largest values, t or 1/Ω and 1
        assert abs(S - exact_S) <= tolerance * min(t, 1.0 / Omega), (Omega, x)
        assert abs(R - exact_R) <= tolerance, (Omega, x)


@pytest.mark.parametrize("ratio", DAMPING)
def test_response_to_a_harmonic_force(ratio):
    Omega = OMEGAS[1]
    for x, drive in itertools.product(FORCED_TIMES, DRIVES):
        t, delta, Omega2, omega = x / Omega, ratio * Omega, Omega * Omega, drive * Omega
        P, rate = harmonic_response(t, omega, delta, Omega2)
        exact_P, exact_rate = exact_harmonic_response(t, omega, delta, Omega2)
        # 100 units: one digit is let go near resonance and one in short times; ωt units from rounding its argument
        tolerance = (100.0 + 4.0 * x * max(1.0, drive)) * EPS
        assert abs(P - exact_P) <= tolerance * abs(exact_P), (x, drive)
        size = max(abs(exact_rate), abs(exact_P) / t)
        assert abs(rate - exact_rate) <= tolerance * size, (x, drive)


def test_everything_vanishes_at_the_start():
    for ratio, drive in itertools.product(DAMPING, DRIVES):
        assert step_response(0.0, ratio, 1.0) == (0.0, 0.0, 1.0)
        assert harmonic_response(0.0, drive, ratio, 1.0) == (0j, 0j)
        assert move(0.0, Phase(0.3, 2.0, 1.5 + 0.5j, ratio, 1.0, drive)) == (0.0, 0.3)
