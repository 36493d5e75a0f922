"""The fast steady response under a law, against the integrator and against limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.cases import case
from analytic.law_response import law_orbit
from dampbalance import BaseMotion, NoSteadyOrbit, steady_orbit
from dampbalance.motion.events import PHASE_T, PHASE_V
from dampbalance.motion.law_response import law_response
from dampbalance.motion.law_steady import steady_response
from paper_case import PAPER

MOTION = BaseMotion(0.004, 2.0 * math.pi * 4.92)
BARE = replace(PAPER, c=0.0)
LAWS = {
    "c_2": {"c_2": 400.0},
    "c_3": {"c_3": 8000.0},
    "all": {"c_r": 10.0, "c_2": 300.0, "c_3": 1000.0, "eta": 0.05},
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("K_z", [2e3, 208_000.0, 1e7])
def test_it_is_that_of_the_integrator(law, K_z):
    tolerance = 1e-11  # to which the integrator closes its orbit, and ten times that
    osc = replace(BARE, K_z=K_z, c=20.0)
    found, exact = steady_response(osc, MOTION, LAWS[law]), law_orbit(osc, MOTION, LAWS[law])
    x = exact.state(np.arange(4096) * (MOTION.period / 4096)).x
    expected = (2.0 / 4096 * np.fft.fft(x))[1:32:2]
    off = np.abs(found.harmonics(16) - expected).max()
    assert off < tolerance * abs(expected[0])
    # and not what a linear damper makes of it
    third = abs(found.orbit.harmonics(2)[1]) / abs(found.orbit.harmonics(1)[0])
    assert abs(abs(expected[1] / expected[0]) - third) > 1e-5
    assert pytest.approx(exact.X, rel=tolerance) == found.X
    assert pytest.approx(4.0 * exact.X - exact.a, rel=1e-9) == found.stick_travel
    # the stick phase is located to 1e-11 or better by both
    assert (found.t_s, found.V_s) == pytest.approx(exact.phases[1, [PHASE_T, PHASE_V]], rel=1e-10)


STATES = {
    "one slip": (replace(BARE, c=20.0), LAWS["all"]),
    "no slip": (replace(BARE, F_k=60.0), LAWS["c_3"]),
    "no friction": (replace(BARE, F_k=0.0), LAWS["c_2"]),
}


@pytest.mark.parametrize("kind", STATES)
def test_its_states_are_those_of_the_integrated_motion(kind):
    osc, law = STATES[kind]
    found, exact = law_response(osc, MOTION, law), law_orbit(osc, MOTION, law)
    t = np.linspace(-1.3, 2.1, 301).reshape(7, 43) * MOTION.period
    one, other = found.state(t), exact.state(t)
    force = osc.k * exact.X + osc.F_k  # of which z may be a jump
    omega = MOTION.omega
    scales = {"x": exact.X, "v": omega * exact.X, "z": max(osc.Z_m, 1e-12 * exact.X)}
    for name, scale in {**scales, "acceleration": force / osc.m}.items():
        parts = (getattr(of, name) for of in (one, other))
        np.testing.assert_allclose(*parts, rtol=0, atol=1e-9 * scale, err_msg=name)
    assert (found.motion.Y, found.motion.omega) == pytest.approx((MOTION.Y, omega), rel=1e-14)


def test_several_onsets_under_a_law_that_is_not_linear_are_refused():
    oscillator, motion = case(0.02, 0.31, 70.0, 0.34)
    with pytest.raises(NoSteadyOrbit, match="only one onset of slip per half cycle"):
        law_response(oscillator, motion, {"c_2": 3.0})


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ({"c_7": 1.0}, "unknown term 'c_7'; known are F_k, c"),
        ({"F_k": 1.0}, "friction force belongs to the oscillator"),
        ({"c": 1.0}, "set Oscillator.c"),
        ({"c_2": -1.0}, "c_2 .quadratic damping. must be a number, 0 to .*, got -1"),
        ({"c_3": math.inf}, "c_3 .* must be a number, 0 to .*, got inf"),
        ({"c_2[a]": 1.0}, "name the term alone"),
    ],
)  # fmt: skip
def test_a_law_that_makes_no_sense_is_refused(law, message):
    with pytest.raises(ValueError, match=message):
        law_response(PAPER, BaseMotion(1.0, 1.0), law)


def test_a_strong_law_is_found_where_a_whole_step_from_the_linear_damper_leads_away():
    law = {"c_3": 1000.0}
    found, exact = steady_response(BARE, MOTION, law), law_orbit(BARE, MOTION, law)
    assert pytest.approx(exact.X, rel=1e-11) == found.X


def test_a_contact_that_is_all_but_rigid_is_the_limit_of_stiffer_and_stiffer_ones():
    oscillators = (replace(BARE, K_z=K_z) for K_z in (1e10, 1e12, 1e15))
    X = [steady_response(osc, MOTION, {"c_2": 400.0}).X for osc in oscillators]
    # the microstick line is 2F_k/K_z long, and the time it takes grows with its root
    assert abs(X[1] / X[2] - 1.0) < 2e-6
    assert abs(X[1] / X[2] - 1.0) < abs(X[0] / X[2] - 1.0)


def test_no_law_is_the_orbit_of_the_oscillator_itself():
    found, orbit = steady_response(PAPER, MOTION, {"c_2": 0.0}), steady_orbit(PAPER, MOTION)
    np.testing.assert_array_equal(found.harmonics(20), orbit.harmonics(20))
    assert (found.X, found.V_s, found.t_s) == (orbit.X, orbit.V_s, orbit.t_s)


def test_from_a_response_beside_it_the_way_leads_to_the_same():
    there = steady_response(BARE, MOTION, {"c_2": 400.0})
    near = steady_response(replace(BARE, F_k=1.2801), MOTION, {"c_2": 400.04}, there)
    straight = steady_response(replace(BARE, F_k=1.2801), MOTION, {"c_2": 400.04})
    # both end where a step of Newton's method is shorter than 1e-11
    assert np.abs(near.harmonics(20) - straight.harmonics(20)).max() < 1e-11 * near.X
