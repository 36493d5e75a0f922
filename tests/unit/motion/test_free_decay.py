"""Free decays: the base at rest. Without friction a damped cosine; with it, the turns that the energy balance gives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from blind.decays import clean, draw
from dampbalance import Oscillator, transient
from dampbalance.motion.events import PHASE_S, PHASE_T, PHASE_V, PHASE_X


def test_without_friction_it_is_a_damped_cosine():
    osc = Oscillator(m=2.0, c=0.8, k=500.0, K_z=5000.0, F_k=0.0)
    delta = osc.c / (2.0 * osc.m)
    omega = math.sqrt(osc.omega_n**2 - delta**2)
    t = np.linspace(0.0, 3.0, 400)
    x = 0.01 * np.exp(-delta * t) * (np.cos(omega * t) + delta / omega * np.sin(omega * t))
    found = transient(osc, None, 3.0, x=0.01).state(t)
    np.testing.assert_allclose(found.x, x, rtol=0, atol=1e-13)  # rounding of 0.01 over 24 radians


@pytest.mark.parametrize("index", [0, 2, 6, 11, 21])
def test_it_is_the_motion_of_an_integrator_of_another_make(index):
    decay = draw(index)
    osc = Oscillator(decay.m, decay.c, decay.k, decay.K_z, decay.F_k)
    signals, free = clean(decay)
    first = round(free[0] * decay.rate_hz)
    count = round(decay.lasts[0] * decay.rate_hz) - 1
    kind, size = decay.starts[0]
    start = {"x": size, "z": math.copysign(osc.Z_m, size)} if kind == "pluck" else {"v": size}
    t = np.arange(count) / decay.rate_hz
    found = transient(osc, None, t[-1] + 1.0, **start).state(t)
    truth = signals[:, first : first + count]
    # 8192 steps of order 2 to a cycle at the kinks of the contact
    for one, other in zip((found.x, found.v, found.acceleration), truth, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=3e-5 * np.abs(other).max())


def test_energy_between_turns_is_that_of_friction_and_damper():
    osc = Oscillator(m=1.0, c=0.0, k=400.0, K_z=4000.0, F_k=0.4)
    phases = transient(osc, None, 20.0, x=0.02, z=osc.Z_m).phases
    turns = phases[(phases[:, PHASE_V] == 0.0), PHASE_X]
    lost = 0.5 * osc.k * (turns[:-1] ** 2 - turns[1:] ** 2)
    travel = np.abs(np.diff(turns)) - 2.0 * osc.Z_m
    assert len(turns) > 5
    np.testing.assert_allclose(lost, osc.F_k * travel, rtol=1e-12)  # rounding


def test_a_mass_that_rings_on_its_contact_is_followed_at_once():
    # a million swings on the contact, which has too little energy to slip again
    osc = Oscillator(m=1.0, c=1e-3, k=100.0, K_z=1e10, F_k=1.0)
    path = transient(osc, None, 100.0, x=0.012, z=osc.Z_m)
    assert path.phases[-1, PHASE_S] == 0.0
    assert path.phases[-1, PHASE_T] < 1.0
    assert abs(path.state(100.0).z) <= osc.Z_m
