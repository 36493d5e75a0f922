"""Derivatives of steady orbits, against differences of orbits, an integrator of another make, and limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.law_response import law_orbit
from dampbalance import BaseMotion, Oscillator, Regime, steady_orbit
from dampbalance.motion.jit import interpreted
from dampbalance.motion.orbit import NoSteadyOrbit
from dampbalance.motion.steady_slopes import onset_slopes
from dampbalance.motion.unknowns import OSCILLATOR_UNKNOWNS

COUNT = 9
STEP = 1e-5  # rounding leaves 1e-13/h of an orbit; extrapolated, curvature leaves h⁴ or so
PAPER = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
MOTION = BaseMotion(0.006, 2.0 * math.pi * 4.92)
# far below resonance and lightly damped: several slips per half cycle
SEVERAL = Oscillator(m=2.42, c=4.0, k=2310.0, K_z=60000.0, F_k=2.0), BaseMotion(0.004, 7.0)


def moved(osc, name, part):
    """The oscillator with one of UNKNOWNS changed by a part of itself."""
    if name == "rho":
        return replace(osc, K_z=osc.K_z * (1.0 + part) ** -2)
    return replace(osc, **{name: getattr(osc, name) * (1.0 + part)})


def value(osc, name):
    return osc.K_z**-0.5 if name == "rho" else getattr(osc, name)


def drawn(seed, count):
    """Random oscillators and motions: ζ 0.005–4, K_z/k 1–10⁶, ω/ω_n 0.2–3, F_k/kY 0.01–1.2."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        m, k, Y = 10.0 ** random.uniform(-1, 1), 10.0 ** random.uniform(2, 4), 0.01
        c = 2.0 * 10.0 ** random.uniform(-2.3, 0.6) * math.sqrt(k * m)
        K_z, F_k = k * 10.0 ** random.uniform(0, 6), k * Y * 10.0 ** random.uniform(-2, 0.08)
        omega = math.sqrt(k / m) * 10.0 ** random.uniform(-0.7, 0.5)
        yield Oscillator(m=m, c=c, k=k, K_z=K_z, F_k=F_k), BaseMotion(Y, omega)


def onset(orbit):
    return np.array([orbit.V_s, orbit.t_s, 4.0 * orbit.X - orbit.a])


def test_derivatives_are_those_of_orbits_beside_in_every_regime():
    seen = dict.fromkeys(Regime, 0)
    for osc, motion in drawn(7, 150):
        orbit = steady_orbit(osc, motion)
        by = orbit.harmonics_with_slopes(COUNT)[1:]
        of_onset = onset_slopes(orbit.phases, orbit.theta, orbit.parameters)
        for name, slope, of_one in zip(OSCILLATOR_UNKNOWNS, by, of_onset.T, strict=True):
            beside = {n: steady_orbit(moved(osc, name, n * STEP), motion) for n in (-2, -1, 1, 2)}
            if any(len(one.phases) != len(orbit.phases) for one in beside.values()):
                continue  # an event appears within the step

            def difference(read, beside=beside):
                a, b, c, d = (read(beside[n]) for n in (-2, -1, 1, 2))
                return (8.0 * (c - b) - (d - a)) / (12.0 * STEP)

            expected = difference(lambda one: one.harmonics(COUNT))
            off = np.abs(value(osc, name) * slope - expected).max()
            assert off < 1e-5 * np.abs(expected).max() + 1e-7 * orbit.X, (name, orbit.regime)
            if orbit.regime in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS):
                size = np.abs(onset(orbit)) + np.array([0.0, 0.0, 1e-3 * orbit.X])
                expected = difference(onset)
                off = np.abs(value(osc, name) * of_one - expected)
                assert (off < 1e-4 * np.abs(expected) + 1e-5 * size).all(), (name, orbit.regime)
            seen[orbit.regime] += 1
    assert min(seen[one] for one in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS, Regime.NO_SLIP)) > 20


@pytest.mark.parametrize(("osc", "motion"), [(PAPER, MOTION), SEVERAL], ids=["one slip", "several"])
def test_derivatives_are_those_of_motions_by_another_integrator(osc, motion):
    """DOP853 with located events, from a room that uses no kernel of this one."""
    orbit = steady_orbit(osc, motion)
    assert (orbit.regime is Regime.SEVERAL_SLIPS) == (osc is SEVERAL[0])
    by = orbit.harmonics_with_slopes(4)[1:]
    times = np.arange(4096) * (motion.period / 4096)

    def harmonics(oscillator):
        x = law_orbit(oscillator, motion, {}).state(times).x
        return 2.0 * np.fft.rfft(x)[1:8:2] / x.size

    for name, slope in zip(OSCILLATOR_UNKNOWNS, by, strict=True):
        h = 1e-4  # closed to 1e-12: 1e-8 of the motion is left, and curvature of h²
        difference = harmonics(moved(osc, name, h)) - harmonics(moved(osc, name, -h))
        expected = difference / (2.0 * h * value(osc, name))
        assert slope == pytest.approx(expected, abs=1e-4 * np.abs(expected).max()), name


def test_the_derivative_by_rho_has_a_limit_where_the_contact_is_rigid():
    # x is smooth in ρ, with a slope at ρ = 0: friction comes late by a time that goes with ρ
    slopes = [
        steady_orbit(replace(PAPER, K_z=K_z), MOTION).harmonics_with_slopes(COUNT)[3]
        for K_z in (1e13, 1e11)
    ]
    size = np.abs(slopes[0]).max()
    assert slopes[0] == pytest.approx(slopes[1], abs=1e-3 * size)
    nearly = [steady_orbit(replace(PAPER, K_z=K_z), MOTION).harmonics(COUNT) for K_z in (1e9, 4e9)]
    chord = (nearly[0] - nearly[1]) / (1e9**-0.5 - 4e9**-0.5)
    assert slopes[0] == pytest.approx(chord, abs=1e-2 * size)


def test_where_nothing_slips_it_is_that_of_a_linear_oscillator():
    osc = replace(PAPER, F_k=1e4)
    orbit = steady_orbit(osc, MOTION)
    assert orbit.regime is Regime.NO_SLIP
    x, by_F, by_c, by_rho, by_m = orbit.harmonics_with_slopes(3)
    omega = MOTION.omega
    impedance = osc.k + osc.K_z - omega**2 * osc.m + 1j * omega * osc.c
    assert x[0] == pytest.approx(osc.k * MOTION.Y / impedance)
    assert by_c[0] == pytest.approx(-1j * omega * x[0] / impedance)
    assert by_m[0] == pytest.approx(omega**2 * x[0] / impedance)
    assert by_rho[0] == pytest.approx(2.0 * osc.K_z**1.5 * x[0] / impedance)
    assert not by_F.any()
    assert not x[1:].any()
    assert not onset_slopes(orbit.phases, orbit.theta, orbit.parameters).any()


def test_interpreted_it_gives_the_same():
    orbit = steady_orbit(PAPER, MOTION)
    compiled = orbit.harmonics_with_slopes(COUNT)
    with interpreted():
        again = orbit.harmonics_with_slopes(COUNT)
    for one, other in zip(compiled, again, strict=True):
        assert one == pytest.approx(other, rel=1e-12)


def test_an_orbit_that_takes_long_is_given_up_on_request():
    stiff = replace(SEVERAL[0], K_z=1e9), SEVERAL[1]
    with pytest.raises(NoSteadyOrbit):
        steady_orbit(*stiff, most_radians=1e4)  # half a cycle alone has 9,000
    # the closed form follows nothing
    assert steady_orbit(replace(PAPER, K_z=1e9), MOTION, most_radians=1e4).regime is Regime.ONE_SLIP
