"""Steady orbits against the same orbits solved to forty digits: README.md, section 2."""

from __future__ import annotations

import math

import mpmath as mp
import pytest

from analytic.cases import PAPER_MOTIONS, SEVERAL_SLIPS, case, spread
from analytic.forty_digits import keeps_its_pattern, solve
from dampbalance import Regime, steady_orbit
from dampbalance.model import parameters
from dampbalance.motion.events import PHASE_S, PHASE_T
from paper_case import PAPER

# Rounding is 2e-16; the worst measured over a thousand cases of the range below is 1e-13 (V_s) and 6e-14 (b, W).
RELATIVE = 5e-13


def compare(oscillator, motion, relative=RELATIVE):
    """Check every feature, each relative to itself but for those that may vanish: X_s to X, the phases to a turn."""
    orbit = steady_orbit(oscillator, motion)
    states = [int(s) for s in orbit.phases[:, PHASE_S]]
    events = list(orbit.phases[1:, PHASE_T])
    exact = solve(parameters(oscillator, motion), orbit.X, orbit.theta, events, states)
    assert keeps_its_pattern(exact, oscillator.Z_m)
    for name in ("X", "V_s", "t_s", "a", "b", "W"):
        value = getattr(exact, name)
        assert abs(getattr(orbit, name) - value) <= relative * abs(value), name
    assert abs(orbit.X_s - exact.X_s) <= relative * exact.X
    for name in ("phi", "phi_zero_crossing"):
        turns = (getattr(orbit, name) - getattr(exact, name)) / (2 * mp.pi)
        assert abs(turns - mp.nint(turns)) <= relative, name
    for n in (1, 3, 5):
        X_n, phi_n = orbit.harmonic(n)
        error = abs(mp.mpf(X_n) * mp.exp(-1j * mp.mpf(phi_n)) - exact.harmonics[n])
        # the higher ones are what is left of motions of the size of X: they carry its rounding, some 10 units
        assert error <= relative * abs(exact.harmonics[n]) + 2e-15 * exact.X, n
    for time, value in zip(orbit.phases[1:, PHASE_T], exact.events, strict=True):
        assert abs(time - value) <= relative * value
    return orbit


@pytest.mark.parametrize("motion", PAPER_MOTIONS, ids=str)
def test_cases_of_the_paper(motion):
    orbit = compare(PAPER, motion)
    assert orbit.regime is Regime.ONE_SLIP


# ζ 0.02–2, ω/ω_n 0.3–2.5, K_z/k 2–300, F_k/kY 0.01–0.5, all spread by their logarithms
RANGES = ((0.02, 2.0), (0.3, 2.5), (2.0, 300.0), (0.01, 0.5))
WIDE = [*zip(*spread(16, 2010, *RANGES), strict=True)]


@pytest.mark.parametrize("numbers", WIDE, ids=lambda n: "-".join(f"{x:.3g}" for x in n))
def test_wide_range(numbers):
    orbit = compare(*case(*numbers))
    assert orbit.regime in (Regime.ONE_SLIP, Regime.SEVERAL_SLIPS)


CORNERS = [
    (0.02, 1.0, 300.0, 0.01),  # the shortest stick phase beside the largest amplitude
    (0.02, 1.001, 300.0, 0.5),
    (2.0, 0.3, 300.0, 0.01),
    (2.0, 2.5, 2.0, 0.01),
]
# the drive at the resonance of the stick phase: its forced and free motion nearly cancel
STICK_RESONANCE = [
    (zeta, math.sqrt(1.0 + K) * (1.0 + detuning), K, F)
    for zeta, K, F in ((0.02, 2.0, 0.01), (0.2, 5.0, 0.3))
    for detuning in (0.0, 1e-9, -1e-4)
]
DISTANCES = (0.0, 1e-12, -1e-9, -1e-7, 1e-5, -1e-3)
CRITICAL = [(1.0 + off, 0.7, 30.0, 0.1) for off in DISTANCES]  # damping of the slip phase
CRITICAL += [(math.sqrt(3.5) * (1.0 + off), 0.7, 2.5, 0.05) for off in DISTANCES]  # of the stick


@pytest.mark.parametrize("numbers", [*CORNERS, *STICK_RESONANCE, *CRITICAL], ids=str)
def test_where_formulas_cancel_or_change(numbers):
    compare(*case(*numbers))


@pytest.mark.parametrize("order", [1, 3, 5])
@pytest.mark.parametrize("detuning", [0.0, 1e-7, 3e-3])
def test_hardly_damped_free_motion_near_a_harmonic_of_the_drive(order, detuning):
    # ω_n = nω: the integrals of the free motion over the slip phase would divide by Ω² − n²ω² − 2iδnω. Such a motion is
    # amplified 1/2ζ = 500 times, and the rounding of the parameters with it.
    F = 0.9 if order == 1 else 0.3
    compare(*case(1e-3, (1.0 + detuning) / order, 20.0, F), relative=1e-11)


@pytest.mark.parametrize("numbers", SEVERAL_SLIPS, ids=str)
def test_several_slip_onsets_per_half_cycle(numbers):
    orbit = compare(*case(*numbers))
    assert orbit.regime is Regime.SEVERAL_SLIPS
    assert len(orbit.phases) == SEVERAL_SLIPS[numbers]


@pytest.mark.parametrize(
    "numbers",
    [
        (0.0, 1.3, 3.0, 0.8),
        (0.0, 1.0 + 1e-9, 100.0, 0.9),  # friction alone limits the resonance
        (0.0, 0.5, 100.0, 0.79),  # several slips
        (0.0, 2.0 * (1.0 + 1e-9), 3.0, 0.3),  # the stick phase at resonance
        # almost no slip: the motion is small beside its forced part
        (0.03579, 1.712, 284.8, 0.9986),
    ],
    ids=str,
)
def test_without_damping_and_near_the_end_of_slip(numbers):
    # Near resonance the orbit depends on its parameters hundreds of times more strongly than elsewhere (measured
    # 4e-13), and a motion that is small beside Y loses digits in b (measured 2e-12).
    compare(*case(*numbers), relative=5e-12)
