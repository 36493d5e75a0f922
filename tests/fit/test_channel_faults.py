"""A response behind a capacitor is recognised by its harmonics, and no other is."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, steady_orbit
from dampbalance.fit.channel_faults import ac_coupling, drive_gain
from dampbalance.fit.steady_search import fit_oscillator
from paper_case import OMEGA, PAPER
from signals.harmonics import lines_of

SHOWS = 16.0


def fitted(corner_hz, seed, error=1e-7):
    rng = np.random.default_rng(seed)
    lines = []
    for Y in (0.004, 0.006, 0.008, 0.010, 0.012):
        one = lines_of(steady_orbit(PAPER, BaseMotion(Y, OMEGA)), error, rng)
        passed = 1j * one.n * OMEGA / (1j * one.n * OMEGA + 2.0 * math.pi * corner_hz)
        lines.append(replace(one, x=one.x * passed))
    fit = fit_oscillator(lines, PAPER.k)
    assert fit is not None
    return fit


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("corner_hz", [0.02, 0.1])
def test_the_corner_is_found_and_the_oscillator_behind_it(corner_hz, seed):
    fit = fitted(corner_hz, seed)
    coupling = ac_coupling(fit, SHOWS)
    assert coupling is not None
    assert fit.chi_square - coupling.fit.chi_square > SHOWS
    assert abs(coupling.size - corner_hz) < 4.0 * coupling.error
    assert coupling.fit.adequate
    # near resonance the coupling passes for another mass, whose error is that of the corner then
    off = abs(fit.m - PAPER.m)
    slack = 4.0 * coupling.error / corner_hz * off + 4.0 * fit.error("m")
    assert abs(coupling.fit.m - PAPER.m) < slack < off


def test_a_response_that_is_not_coupled_is_not_suspected():
    assert [ac_coupling(fitted(0.0, seed), SHOWS) for seed in range(6)] == [None] * 6


@pytest.mark.parametrize("relative", [False, True])
@pytest.mark.parametrize("gain", [0.01, -0.01])
def test_the_gain_of_the_drive_is_found_and_the_oscillator_behind_it(gain, relative):
    """The drive reads 1 % too much or too little; of a transducer between base and mass, the sum is off as well."""
    rng, lines = np.random.default_rng(3), []
    for Y in (0.004, 0.006, 0.008, 0.010, 0.012):
        one = lines_of(steady_orbit(PAPER, BaseMotion(Y, 2.0 * math.pi * 3.5)), 1e-7, rng)
        x = one.x + gain * one.Y * relative * (one.n == 1)
        lines.append(replace(one, Y=(1.0 + gain) * one.Y, x=x, relative=relative))
    fit = fit_oscillator(lines, PAPER.k)
    fault = drive_gain(fit, SHOWS)
    assert abs(fault.size - gain) < 4.0 * fault.error < 0.5 * abs(gain)
    assert fault.fit.adequate
    for name in ("F_k", "c", "m"):
        # the errors of the fit and that of the gain, in proportion to which all of them follow
        error = math.hypot(fault.fit.error(name), 2.0 * fault.error * getattr(PAPER, name))
        assert abs(getattr(fault.fit, name) - getattr(PAPER, name)) < 4.0 * error, name
    # some 6 % of K_z for 1 % of gain; of a motion relative to the base, whose gain is that of the sum, much more
    error = math.hypot(fault.fit.K_z_error / fault.fit.K_z, 8.0 * fault.error)
    assert abs(fault.fit.K_z / PAPER.K_z - 1.0) < 4.0 * error or relative
    assert abs(fault.fit.K_z - PAPER.K_z) < abs(fit.K_z - PAPER.K_z) or relative


def test_a_drive_that_reads_right_is_not_suspected():
    assert [drive_gain(fitted(0.0, seed), SHOWS) for seed in range(6)] == [None] * 6
