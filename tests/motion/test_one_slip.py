"""The closed form of the orbit with one slip: where it is valid it serves, and no fall-back hides an error in it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.cases import dimensions, spread
from dampbalance import Regime, steady_orbits
from dampbalance.model import Parameters
from dampbalance.motion.flow import Phase
from dampbalance.motion.one_slip import solve_one_slip, velocity_keeps_sign
from dampbalance.motion.states import states_in_phases

LABORATORY = ((0.01, 1.0), (0.3, 3.0), (3.0, 1e3), (3e-3, 0.6))  # ζ, ω/ω_n, K_z/k, F_k/kY


def of_case(zeta, r, K, F):
    return Parameters(**{name: float(v) for name, v in dimensions(zeta, r, K, F).items()})


def test_it_serves_wherever_the_velocity_keeps_its_sign_and_nowhere_else():
    """Of oscillators that a laboratory may meet: 492 in 512 have one slip, and it finds 480."""
    zeta, r, K, F = np.array(spread(256, 1, *LABORATORY))
    orbits = steady_orbits(**dimensions(zeta, r, K, F))
    served = 0
    for i in range(zeta.size):
        par = of_case(zeta[i], r[i], K[i], F[i])
        found = solve_one_slip(par)[0]
        if orbits.regime[i] != Regime.ONE_SLIP:
            assert not found
            continue
        stick = [0.0, 0.0, -orbits.X[i], 0.0, -F[i] / K[i]]
        slip = [orbits.t_s[i], 1.0, orbits.X_s[i], orbits.V_s[i], F[i] / K[i]]
        t = np.linspace(0.01, 0.99, 99) * math.pi / r[i]
        v = states_in_phases(t, np.array([stick, slip]), orbits.phi[i] - math.pi, par)[1]
        assert found == bool(np.all(v > 0.0)), i
        served += found
    assert served >= 230


@pytest.mark.parametrize(
    ("lowest", "kept"), [(0.5, True), (0.01, True), (1e-3, True), (-1e-3, False), (-0.5, False)]
)
@pytest.mark.parametrize("at", [0.3, 0.37, 0.5, 0.69])
def test_a_dip_of_the_velocity_is_seen_between_samples(lowest, kept, at):
    # u̇ = 1 − d cos ω(t − at) over one turn, so ü = Re[−i d ω e^{iω(t − at)}]: no damping, hardly any stiffness
    omega, d = 2.0 * math.pi, 1.0 - lowest
    A = complex(-d * omega * math.sin(omega * at), -d * omega * math.cos(omega * at))
    phase = Phase(1.0 - d * math.cos(omega * at), 0.0, A, 0.0, 1e-12, omega)
    assert velocity_keeps_sign(1.0, phase, 1.0) == kept
