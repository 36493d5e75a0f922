"""Records of six laws that the package has not made: their oscillators, their motion, and the table of laws chosen."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest

from analytic.law_response import law_orbit
from blind import laws
from blind.other_motion import Departure, steady
from dampbalance import BaseMotion, Oscillator

pytestmark = pytest.mark.slow

drawn = functools.cache(laws.draw)


@pytest.mark.parametrize("law", laws.LAWS)
def test_a_set_is_as_it_is_said_to_be(law):
    truth = drawn(law, 3)
    for part in truth.shares().values():
        assert ((part >= 0.2) & (part <= 0.6)).any()
    assert set(truth.coefficients) == set(laws.LAWS[law])
    assert 10.0 <= truth.K_z / truth.k <= 200.0
    ratios = sorted({omega / math.sqrt(truth.k / truth.m) for _, omega in truth.levels})
    assert len(ratios) == 2
    assert ratios[0] < 0.95
    assert ratios[1] > 1.05
    Y = sorted({round(Y, 12) for Y, _ in truth.levels})
    assert Y[-1] / Y[0] == pytest.approx(4.0)
    assert len(Y) * len(ratios) == len(truth.levels) == 6


@pytest.mark.parametrize("law", laws.LAWS)
def test_its_motion_is_that_of_the_law(law):
    # two integrators of different make, on forces written down twice; fixed steps are of order 2 at the kinks of the
    # contact: measured 1e-7 of the motion. The mass slips once in every half cycle.
    truth = drawn(law, 3)
    others = dict(truth.coefficients)
    oscillator = Oscillator(truth.m, others.pop("c", 0.0), truth.k, truth.K_z, truth.F_k)
    for (Y, omega), motion in zip(truth.levels, truth.motions, strict=True):
        orbit = law_orbit(oscillator, BaseMotion(Y, omega), others)
        assert np.count_nonzero(orbit.phases[:, 1]) == 1  # one onset of slip
        phase = np.linspace(0.0, 2.0 * math.pi, 400)
        state, found = orbit.state(phase / omega), motion(phase)
        assert np.abs(found[0] - state.x).max() < 1e-6 * orbit.X
        assert np.abs(found[1] - state.v).max() < 1e-5 * omega * orbit.X


def test_every_term_of_other_motion_has_its_force():
    # alone, at resonance, without a contact: what harmonic balance gives, to the third harmonic of Y/8X
    m, k, Y, omega = 2.0, 800.0, 1e-4, 20.0
    drive, phase = k * Y, np.linspace(0.0, 2.0 * math.pi, 400, endpoint=False)
    expected = {
        "quadratic": (0.5, math.sqrt(3.0 * math.pi * drive / (8.0 * 0.5 * omega**2))),
        "third_power": (2.0, (4.0 * drive / (3.0 * 2.0 * omega**3)) ** (1.0 / 3.0)),
        "structural": (0.02, drive / (0.02 * k)),
        "relative": (0.8, drive * math.hypot(1.0, omega * 0.8 / k) / (omega * 0.8)),
    }
    for field, (p, X) in expected.items():
        x = steady((m, 0.0, k, 10.0 * k, 0.0, Y, omega), Departure(**{field: p}))(phase)[0]
        fundamental = 2.0 * abs(np.mean(x * np.exp(-1j * phase)))
        assert fundamental == pytest.approx(X, rel=Y / X / 8.0 + 1e-6), field


def test_records_are_the_motion_with_noise_and_nothing_but_their_number_draws_them():
    law = "F_k + c_2"
    truth, records = laws.draw(law, 1), laws.law_records(law, 1)
    again, other = laws.law_records(law, 1), laws.law_records(law, 2)
    assert len(records) == 6
    for record, same, (Y, omega) in zip(records, again, truth.levels, strict=True):
        base, x = record["base_displacement"], record["displacement"]
        np.testing.assert_array_equal(x.values, same["displacement"].values)
        cycles = base.t[-1] * omega / (2.0 * math.pi)
        assert cycles == pytest.approx(100.0, abs=0.02)
        assert 189.0 < base.t.size / cycles < 211.0
        # the fundamental of the base is Y, and what is left of it is the noise: four standard errors of both
        turn = np.exp(-1j * omega * base.t)
        amplitude = 2.0 * np.mean(base.values * turn)
        assert abs(amplitude) == pytest.approx(Y, rel=0.001)
        noise = base.values - np.real(amplitude / turn)
        assert noise.std() == pytest.approx(0.01 * Y / math.sqrt(2.0), rel=0.03)
    assert truth != laws.draw(law, 2)
    assert records[0]["displacement"].values.size != other[0]["displacement"].values.size
