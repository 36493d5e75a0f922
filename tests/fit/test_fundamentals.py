"""The fit to the fundamentals alone, on motions of an independent integrator that are not those of the model."""

from __future__ import annotations

import math

import numpy as np
import pytest

from blind.gradual import steady_on
from blind.other_motion import Departure, steady
from dampbalance.fit.contacts import fit_contact
from dampbalance.fit.fundamentals import fit_fundamentals, stiffness_lines
from dampbalance.law.contact import Sliders
from dampbalance.signals.record_harmonics import RecordHarmonics

M, C, K, K_Z, F_K, HZ = 2.0, 4.0, 2000.0, 30000.0, 0.4, 4.6
LEVELS = (1e-3, 1.6e-3, 2.5e-3, 4e-3)
NOISE = 2e-5  # of the fundamental: a per cent in each of some thousand samples


def lines_of(departure, levels=LEVELS, turn=0.0, second_mode=0.0, seed=0):
    """Harmonics of each level under a departure, with noise.   turn : lag of the fundamental, rad, n times that at
    harmonic n.   second_mode : size of what a further mode adds to harmonics beyond the first, over X."""
    random, omega, lines = np.random.default_rng(seed), 2.0 * math.pi * HZ, []
    for Y in levels:
        cycle = steady((M, C, K, K_Z, F_K, Y, omega), departure)
        phases = np.arange(4096) * (2.0 * math.pi / 4096)
        n = np.arange(1, 14, 2)
        x = 2.0 * np.fft.rfft(cycle(phases)[0])[n] / phases.size
        x[1:] += second_mode * abs(x[0]) / n[1:]
        x *= np.exp(-1j * n * turn)
        error = NOISE * abs(x[0])
        x += error * (random.standard_normal(n.size) + 1j * random.standard_normal(n.size))
        lines.append(RecordHarmonics(omega, Y, NOISE * Y, n, x, np.full(n.size, error), 40))
    return lines


CUBIC = Departure(cubic=0.03 * K / 4e-3**2)
"""A spring that is 3 % stiffer or so at the highest level."""


@pytest.mark.parametrize(
    ("lines", "freed"),
    [
        (lines_of(Departure()), ()),
        (lines_of(Departure(), second_mode=0.02), ()),
        (lines_of(CUBIC, (*LEVELS, 3e-3)), ("k_3",)),
        (lines_of(Departure(), (*LEVELS, 3e-3), turn=0.05), ("delay",)),
    ],
    ids=["model", "second mode", "cubic spring", "delay"],
)
def test_the_truth_lies_in_the_intervals_and_departures_are_found(lines, freed):
    fit = fit_fundamentals(lines, K)
    assert fit.departures == freed
    # ¾k_3X² leaves out the third harmonic of such a spring, which moves c by half a per cent
    slack = 0.01 if freed == ("k_3",) else 0.0
    for name, truth in (("F_k", F_K), ("c", C), ("m", M), ("rho", K_Z**-0.5)):
        low, high = fit.interval(name)
        assert low - slack * truth < truth < high + slack * truth, name
    low, high = fit.interval("F_k")
    assert high - low < 0.1 * F_K
    if freed == ("delay",):
        assert fit.value("delay") == pytest.approx(0.05 / (2.0 * math.pi * HZ), rel=0.2)


@pytest.mark.parametrize("c", [4.0, 20.0])
def test_lines_that_no_friction_explains_have_a_fit(c):
    """A spring that stiffens and a loss below that of c: the friction is at its limit, on a rigid contact."""
    omega, lines = 2.0 * math.pi * HZ, []
    for X in np.geomspace(5e-4, 4e-3, 3):
        Z = K + 7.5e6 * X**2 - M * omega**2 + 1j * (omega * c - 0.4 / (math.pi * X))
        x, error = np.array([X * np.exp(-1j * np.angle(Z))]), np.array([NOISE * X])
        Y = abs(Z) * X / K
        lines.append(RecordHarmonics(omega, Y, NOISE * Y, np.array([1]), x, error, 40))
    fit = fit_fundamentals(lines, K)
    assert fit.rigid
    assert 0.0 < fit.F_k < 1e-6
    assert [abs(of.harmonics(1)[0]) for of in fit.responses] == pytest.approx(
        [abs(one.x[0]) for one in lines], rel=0.3
    )


def test_two_levels_show_no_scatter():
    assert fit_fundamentals(lines_of(Departure(), LEVELS[::3]), K) is None


def test_few_levels_have_wide_intervals():
    """Student's t of one degree of freedom is 12.7, of three 3.2."""
    widths = []
    for levels in (LEVELS[1:], (*LEVELS, 3e-3)):
        low, high = fit_fundamentals(lines_of(Departure(), levels), K).interval("F_k")
        widths.append(high - low)
    assert widths[0] > 2.0 * widths[1]


def test_fundamentals_have_the_loss_of_a_contact_that_yields_gradually():
    """A single slider loses as much at one amplitude only; truth: 16 sliders, integrated independently."""
    contact = Sliders(np.geomspace(3e-5, 3e-3, 16), np.linspace(400.0, 100.0, 16))
    rows = np.column_stack([contact.kappa, contact.kappa * contact.r, np.zeros(16)])
    omega, phases, lines = 2.0 * math.pi * HZ, np.arange(4096) * (2.0 * math.pi / 4096), []
    for Y in np.geomspace(2e-4, 4e-3, 8).tolist():
        motion = steady_on(rows, M, C, K, Y, omega)
        x = 2.0 * np.fft.rfft(motion(phases)[0])[1:2] / 4096
        lines.append(RecordHarmonics(omega, Y, NOISE * Y, np.array([1]), x, NOISE * np.abs(x), 40))
    each = stiffness_lines(lines, K)
    known = {"given": {"c": C}, "stiffness": K, "mass": M, "hardening": False}
    fit = fit_contact(each, contact="gradual", **known)
    X = np.geomspace(*fit.X_range, 9)
    true = contact.loss(X) + math.pi * C * omega * X**2
    assert math.pi * X**2 * fit.law(X, omega)[0].imag == pytest.approx(true, rel=0.04)
    one = fit_contact(each, contact="one slider", **known)
    loss = math.pi * X**2 * one.law(X, omega)[0].imag
    assert np.max(np.abs(loss / true - 1.0)) > 0.15
