"""The motion under a base of several harmonics, against an integrator in fixed steps and the closed form of sticking,
and the oscillator that records of it determine."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from blind.other_motion import STEPS, Departure, steady
from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.fit.goodness import linear_fit
from dampbalance.fit.steady_search import fit_records
from dampbalance.law.law import Law
from dampbalance.motion.distorted import distorted_harmonics
from dampbalance.motion.law_steady import added_by_base, steady_response
from signals.harmonics import lines_of

# m, c, k, K_z, F_k, Y, ω: near resonance, above it, and below with several slips per half cycle
CASES = {
    "near resonance": (2.42, 90.0, 2310.0, 208000.0, 1.28, 0.004, 31.0),
    "above": (2.42, 20.0, 2310.0, 20000.0, 3.0, 0.004, 70.0),
    "several slips": (2.42, 6.0, 2310.0, 40000.0, 1.28, 0.004, 9.0),
}
BASES = {"third": Departure(third=0.05), "second": Departure(second=0.05)}
# Kinks make the integrator's error of second order in its step, (2π/8192)² beside a stick phase ten times faster than
# the drive; several slips follow each other ten times faster again.
BOUNDS = {"near resonance": 1e-6, "above": 1e-6, "several slips": 1e-5}


def base_of(Y: float, departure: Departure) -> np.ndarray:
    return Y * np.array([1.0, departure.second, departure.third], dtype=np.complex128)


def harmonics_of(numbers: tuple[float, ...], departure: Departure, count: int) -> np.ndarray:
    x = steady(numbers, departure)(np.arange(STEPS) * (2.0 * math.pi / STEPS))[0]
    return 2.0 * np.fft.rfft(x)[1 : count + 1] / STEPS


def orbit_of(numbers: tuple[float, ...]):
    m, c, k, K_z, F_k, Y, omega = numbers
    return steady_orbit(Oscillator(m, c, k, K_z, F_k), BaseMotion(Y, omega))


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("name", CASES)
def test_the_harmonics_are_those_of_an_integrator_in_fixed_steps(name, base):
    numbers, departure = CASES[name], BASES[base]
    orbit = orbit_of(numbers)
    x = distorted_harmonics(orbit, base_of(numbers[5], departure), 9)
    expected = harmonics_of(numbers, departure, 9)
    bound = BOUNDS[name] * abs(expected[0])
    assert np.abs(x - expected).max() < bound
    # what the base changes is far larger than that
    mono = np.zeros(9, dtype=np.complex128)
    mono[::2] = orbit.harmonics(5)
    assert np.abs(mono - expected).max() > 100.0 * bound


def test_a_contact_that_sticks_is_a_spring():
    m, c, k, K_z, _, Y, omega = CASES["above"]
    base = np.array([Y, 0.0, 0.1j * Y])
    x = distorted_harmonics(orbit_of((m, c, k, K_z, 1e4, Y, omega)), base, 3)
    n = np.arange(1, 4)
    assert x == pytest.approx(k * base / (k + K_z - (n * omega) ** 2 * m + 1j * n * omega * c))


def test_a_damper_to_the_base_passes_its_harmonics_on():
    m, c, k, K_z, F_k, Y, omega = numbers = CASES["above"]
    departure = Departure(third=0.05, relative=0.5 * c)
    motion = BaseMotion(Y, omega)
    response = steady_response(Oscillator(m, c, k, K_z, F_k), motion, {"c_r": 0.5 * c})
    x = response.harmonics(5) + added_by_base(base_of(Y, departure)[1:], response, 5)
    expected = harmonics_of(numbers, departure, 9)[::2]
    assert np.abs(x - expected).max() < BOUNDS["above"] * abs(expected[0])


def lines_under(base: str, error: float, Ys=(0.002, 0.004, 0.008)):
    """Lines of the integrator's harmonics under a distorted base at several levels, without noise."""
    for Y in Ys:
        numbers = (*CASES["above"][:5], Y, CASES["above"][6])
        lines = lines_of(orbit_of(numbers), error * Y, count=8)
        x = harmonics_of(numbers, BASES[base], 15)[::2]
        yield replace(lines, x=x, base=base_of(Y, BASES[base])[1:])


@pytest.mark.parametrize("base", BASES)
def test_an_oscillator_on_a_distorted_base_is_identified(base):
    m, c, _, K_z, F_k, *_ = CASES["above"]
    error = 1e-4  # of the base: the fundamental of the response is about 0.7 of it
    fit = fit_records(list(lines_under(base, error)), CASES["above"][2], Law())
    assert fit is not None
    assert fit.adequate
    # without noise what is left is the integrator's error, 1e-6 of the motion: a hundredth of the error given
    for name, value in (("F_k", F_k), ("c", c), ("rho", K_z**-0.5), ("m", m)):
        assert abs(fit.value(name) - value) < 0.05 * fit.error(name)
    assert fit.chi_square < 0.01


def test_a_linear_oscillator_on_a_distorted_base_is_linear():
    m, c, k, K_z, _, Y, omega = CASES["above"]
    sticks = (m, c, k, K_z, 1e4, Y, omega)
    base = base_of(Y, BASES["third"])
    lines = lines_of(orbit_of(sticks), 1e-6 * Y)
    x = lines.x + 0.0
    x[1] = distorted_harmonics(orbit_of(sticks), base, 3)[2]
    chi_square = linear_fit([replace(lines, x=x, base=base[1:])], k).chi_square
    assert chi_square < 1e-6  # no noise
    assert linear_fit([replace(lines, x=x)], k).chi_square > 1e3
