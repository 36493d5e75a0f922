"""Integrals of the terms against exact orbits, quadrature of harmonic motions, and the laws of clean responses."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.integrals import input_work, of_motion
from analytic.law_response import law_orbit
from dampbalance import Oscillator
from dampbalance.balance import Rows
from dampbalance.law.terms import FRICTION, KNOWN_TERMS, Term, of_harmonics
from dampbalance.solver import solve
from paper_case import motions_at

# A power between those of the package, an even share of the base, and a force that depends on k.
OWN = (
    Term("twice_cubed", lambda v, w, k, omega: 2.0 * v**3, "", "N s³/m³", "b", "m⁴/s³", 3),
    Term("to_base", lambda v, w, k, omega: 2.0 * v - 0.5 * w, "", "N s/m", "b", "m²/s", 1),
    Term(
        "of_k",
        lambda v, w, k, omega: k / omega * np.abs(v) ** 1.5 * v,
        "",
        "s^1.5/m^1.5",
        "b",
        "J m^1.5/s^1.5",
        2.5,
    ),
)
OTHERS = (*(term for term in KNOWN_TERMS.values() if term != FRICTION), *OWN)

UNSMOOTH = ("c_2", "of_k")


@pytest.mark.parametrize("term", OTHERS)
def test_the_harmonic_form_of_a_term_is_its_integral_of_a_harmonic_motion(term):
    omega, k, X, Y, phi = 7.0, 300.0, 0.013, 0.02, 0.8
    # equidistant points: exact for trigonometric polynomials, 2e-13 for |cos|³
    theta = np.arange(4096) / 4096.0 * 2.0 * math.pi
    v, w = -omega * X * np.sin(theta - phi), -omega * Y * np.sin(theta)
    expected = 2.0 * math.pi / omega * np.mean(term.force(v, w, k, omega) * v)
    assert term.harmonic(omega, X, Y, phi, k) == pytest.approx(expected, rel=1e-11)
    n, x = np.array([1.0]), np.array([[X * np.exp(-1j * phi)]])
    found = of_harmonics(term, n, x, n, np.array([[Y + 0j]]), omega, k)
    assert found.shape == (1,)
    # of 512 points; |cos|³ loses 1e-9
    assert found[0] == pytest.approx(expected, rel=2e-9 if term in UNSMOOTH else 1e-12)
    v, step = np.array([-1.3, -0.2, 0.4, 2.0]), 1e-6
    high, low = (term.force(v + side * step, 0.3, k, omega) for side in (1.0, -1.0))
    slope = term.slope(v, 0.3, k, omega)
    np.testing.assert_allclose(slope, (high - low) / (2.0 * step), rtol=1e-8)


@pytest.mark.parametrize("term", OTHERS)
def test_harmonics_of_any_motion_give_the_integral_of_its_velocity(term):
    # even ones among them, in the response and in the base
    omega, k, rng = 5.0, 90.0, np.random.default_rng(4)
    n, y_n = np.array([1.0, 2.0, 3.0, 6.0]), np.array([1.0, 2.0, 4.0])
    x = rng.normal(size=(3, 4)) + 1j * rng.normal(size=(3, 4))
    y = rng.normal(size=(3, 3)) + 1j * rng.normal(size=(3, 3))
    theta = np.arange(2**14) / 2**14 * 2.0 * math.pi
    v, w = (
        (np.exp(1j * np.outer(theta, orders)) @ (1j * omega * orders * part).T).real.T
        for orders, part in ((n, x), (y_n, y))
    )
    power = term.force(v, w, k, omega) * v
    expected = 2.0 * math.pi / omega * np.mean(power, axis=1)
    found = of_harmonics(term, n, x, y_n, y, omega, k)
    size = 2.0 * math.pi / omega * np.mean(np.abs(power))
    # |ẋ|³ of six harmonics of one size, which no response has, loses 1.8e-7 at 512 points
    tolerance = 1e-6 if term in UNSMOOTH else 1e-12
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * size)


@pytest.mark.parametrize("term", OTHERS)
def test_what_noise_adds_to_an_integral_is_taken_off(term):
    # in the mean over drawings: within four standard errors of the true integral, beyond which the raw ones are
    omega, k, rng, count = 5.0, 90.0, np.random.default_rng(7), 4000
    n, clean = np.array([1.0, 2.0, 3.0]), np.array([1.0 - 0.5j, 0.02j, 0.05])
    deviation = np.array([0.04, 0.03, 0.03])
    noise = rng.normal(size=(count, 3)) + 1j * rng.normal(size=(count, 3))
    x, y = clean + deviation * noise, np.full((count, 1), 1.3 + 0j)
    (true,) = of_harmonics(term, n, clean[None], n[:1], y[:1], omega, k)
    drawn = of_harmonics(term, n, x, n[:1], y, omega, k, 2.0 * deviation**2)
    raw = of_harmonics(term, n, x, n[:1], y, omega, k)
    error = drawn.std() / math.sqrt(count)
    assert abs(drawn.mean() - true) < 4.0 * error
    assert abs(raw.mean() - true) > 8.0 * error


def test_the_travel_of_friction_is_no_matter_of_harmonics():
    n = np.ones(1)
    with pytest.raises(ValueError, match="F_k has no integral that follows from harmonics"):
        of_harmonics("F_k", n, n[None] + 0j, n, n[None] + 0j, 1.0, 1.0)


@pytest.mark.parametrize("term", [*KNOWN_TERMS.values(), OWN[0]])
def test_a_coefficient_times_its_integral_is_an_energy(term):
    # lengths times 2, times times 3, masses times 5: a work becomes 5·2²/3² of itself, and a unit says how p does
    length, time, mass = 2.0, 3.0, 5.0
    of_unit = {"N": mass * length / time**2, "m": length, "s": time, "kg": mass, "": 1.0}
    of_unit["J"] = of_unit["N"] * length

    def size(unit):
        factor = 1.0
        for i, side in enumerate(unit.split("/")):
            for name in side.split():
                base = name.rstrip("²³⁴")
                power = {"²": 2, "³": 3, "⁴": 4}.get(name[len(base) :], 1)
                factor *= of_unit[base] ** (power if i == 0 else -power)
        return factor

    assert size(term.unit) * size(term.integral_unit) == pytest.approx(of_unit["J"], rel=1e-14)
    if term.force is not None:  # of a harmonic motion: ω, X, Y, φ and k in other units
        of_units = np.array([1.0 / time, length, length, 1.0, mass / time**2])
        here = np.array([7.0, 0.013, 0.02, 0.8, 300.0])
        expected = size(term.integral_unit) * term.harmonic(*here)
        assert term.harmonic(*(of_units * here)) == pytest.approx(expected, rel=1e-12)


# Coefficients that take 20 to 60 % of the work at some level each.
LAWS = {
    "F_k+c": {"c": 12.0},
    "F_k+c_r": {"c_r": 12.0},
    "F_k+c_2": {"c_2": 80.0},
    "F_k+c_3": {"c_3": 600.0},
    "F_k+eta": {"eta": 0.1},
    "F_k+c+c_2": {"c": 6.0, "c_2": 40.0},
}
FREQUENCIES_HZ = (4.0, 6.2)  # below and above the resonance at 4.92 Hz


@pytest.mark.parametrize("name", LAWS)
def test_the_energy_balance_closes_and_its_rows_give_each_law_back(name):
    """From clean responses: two amplitudes at two frequencies."""
    law = dict(LAWS[name])
    oscillator = Oscillator(m=2.42, c=law.pop("c", 0.0), k=2310.0, K_z=70000.0, F_k=1.28)
    motions = [m for hertz in FREQUENCIES_HZ for m in motions_at(hertz, (0.003, 0.012))]
    orbits = [law_orbit(oscillator, motion, law) for motion in motions]
    true = {FRICTION: 1.28, **LAWS[name]}
    integrals = {s: np.array([of_motion(s, orbit) for orbit in orbits]) for s in true}
    rows = Rows(integrals, np.array([input_work(orbit) for orbit in orbits]))
    # each integral by itself; a start that is accepted 1e-12 of its size off leaves some of the work: measured 1e-13
    # of it, and 1.3e-11 as without AVX-512
    assert np.abs(rows.misfit(true) / rows.W).max() < 1e-10
    found = solve(rows)
    for symbol, p in true.items():
        assert float(found[symbol]) == pytest.approx(p, rel=1e-9)
    assert float(found.residual) < 1e-11
