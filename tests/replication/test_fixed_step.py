"""Fixed-step schemes have the order, the dissipation and the lag of velocity that are known of them, and switch between
stick and slip at the ends of steps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dampbalance.model import BaseMotion
from dampbalance.motion.orbit import steady_orbit
from dampbalance.replication.clean import of_record
from dampbalance.replication.fixed_step import (
    MIN_STICK_SAMPLES,
    SCHEMES,
    StepTooCoarse,
    _linear_map,
    largest_growth,
    one_step,
    simulate,
)
from paper_case import OMEGA, PAPER
from replication.by_hand import backward_euler

RESONANCE = BaseMotion(Y=0.008, omega=OMEGA)
BELOW = BaseMotion(Y=0.008, omega=2.0 * math.pi * 3.5)

# Smooth problems: without friction the mass always slips, under a huge F_k it never does and rides on k + K_z.
ALWAYS_SLIP = replace(PAPER, F_k=0.0)
NO_SLIP = replace(PAPER, K_z=2000.0, F_k=1000.0)
SMOOTH = pytest.mark.parametrize(
    ("osc", "stiffness"), [(ALWAYS_SLIP, 2310.0), (NO_SLIP, 4310.0)], ids=["always-slip", "no-slip"]
)
EACH_SCHEME = pytest.mark.parametrize("scheme", SCHEMES)
ORDER = dict.fromkeys(SCHEMES, 1) | {"trapezoidal": 2, "rk4": 4}
LAG = {"backward-euler": 0.5, "semi-implicit-euler": 0.5, "explicit-euler": -0.5}
"""By how many steps the velocity that a scheme returns is older than the displacement."""


def bias_of(scheme, omega, omega_n, step):
    """The excess of W/b over c, to first order in the step."""
    lagging = LAG.get(scheme, 0.0) * (omega**2 - omega_n**2)
    return PAPER.m * step * (SCHEMES[scheme].dissipation * omega**2 - lagging)


def steady(osc, motion, scheme, step):
    """Three cycles after twelve: the start has decayed by e^(−12 · 2π · 0.6) < 1e-19 (ζ = 0.6)."""
    return simulate(osc, motion, scheme=scheme, step=step, cycles=15, keep_cycles=3)


@SMOOTH
@EACH_SCHEME
@pytest.mark.parametrize("motion", [RESONANCE, BELOW], ids=["resonance", "below"])
def test_steady_motion_has_the_declared_order_dissipation_and_bias(scheme, osc, stiffness, motion):
    omega = motion.omega
    X = osc.k * motion.Y / (stiffness - osc.m * omega**2 + 1j * osc.c * omega)

    def of(step):
        record = steady(osc, motion, scheme, step)
        features = of_record(record, omega, osc.k)
        effective = osc.k * motion.Y * math.sin(features.phi_fundamental[0]) / features.X_1[0]
        excess = (effective / omega - osc.c) / (osc.m * omega**2 * step)
        error = np.max(np.abs(record.x - (X * np.exp(1j * omega * record.t)).real))
        return error, excess, features.W[0] / features.b[0] - osc.c

    step = motion.period / 1600
    (larger, coarse, _), (smaller, fine, bias) = of(2.0 * step), of(step)
    # The next term of the error shifts the order by a per cent or so at 800 steps a cycle.
    assert math.log2(larger / smaller) == pytest.approx(ORDER[scheme], abs=0.05)
    # The remainder is of next order: 0.5 % at 800 steps a cycle, half of that at 1600; extrapolated it is gone.
    assert 2.0 * fine - coarse == pytest.approx(SCHEMES[scheme].dissipation, abs=1e-4)
    # Simpson's rule is good to 1e-10; what is left is of second order, c (ωh)² ≈ 1e-3 at most.
    declared = bias_of(scheme, omega, math.sqrt(stiffness / osc.m), step)
    assert bias == pytest.approx(declared, abs=1e-3)
    assert abs(declared) > 0.1 or not SCHEMES[scheme].dissipation


@pytest.mark.parametrize("scheme", ["trapezoidal", "rk4", "semi-implicit-euler"])
def test_late_events_cost_an_error_of_second_order_at_most(scheme):
    exact = steady_orbit(PAPER, RESONANCE)

    def worst(n):
        errors = []
        for shift in (0.0, 0.21, 0.43, 0.68, 0.87):  # the error depends on where the grid falls
            record = steady(PAPER, RESONANCE, scheme, RESONANCE.period / (n + shift))
            errors.append(abs(of_record(record, RESONANCE.omega, PAPER.k).X_s[0] / exact.X_s - 1.0))
        return max(errors)

    order = math.log2(worst(4000) / worst(64000)) / 4.0
    # The worst of five grids scatters by a factor of two or so over a ratio of 16: ±0.35 in the order.
    assert order == pytest.approx(min(2, ORDER[scheme]), abs=0.35)


@EACH_SCHEME
def test_a_step_solves_the_equations_of_its_scheme(scheme):
    """u' − u is h times the rates that the scheme weighs, written out from what it is called."""
    rng, C, K, h = np.random.default_rng(7), 37.0, 950.0, 1e-3
    A, u, p = np.array([[0.0, 1.0], [-K, -C]]), rng.normal(size=2), rng.normal(size=3)

    def rate(state, force):
        return A @ state + np.array([0.0, force])

    code = SCHEMES[scheme].code
    after = np.array(one_step(code, tuple(u), tuple(p), C, K, h))
    first = rate(u, p[0])
    second = rate(u + 0.5 * h * first, p[1])
    third = rate(u + 0.5 * h * second, p[1])
    rates = {
        "explicit-euler": first,
        "backward-euler": rate(after, p[2]),
        "trapezoidal": (first + rate(after, p[2])) / 2.0,
        "semi-implicit-euler": np.array([after[1], first[1]]),
        "rk4": (first + 2.0 * second + 2.0 * third + rate(u + h * third, p[2])) / 6.0,
    }
    assert after == pytest.approx(u + h * rates[scheme], rel=1e-13)  # rounding
    assert _linear_map(code, C, K, h) @ np.append(u, p) == pytest.approx(after, rel=1e-13)


@EACH_SCHEME
def test_growth_is_that_of_the_free_oscillation(scheme):
    """Explicit Euler multiplies the amplitude of an undamped oscillation by √(1 + ω²h²) in a step, RK4 lets it decay up
    to ωh = √8, the implicit schemes let it never grow, and semi-implicit Euler holds it up to ωh = 2."""
    limit = {"rk4": math.sqrt(8.0), "semi-implicit-euler": 2.0}.get(scheme, math.inf)
    for omega_h in (0.1, 1.5, 2.5, 3.5):
        growth = largest_growth(scheme, 1.0, 0.0, 0.25 * omega_h**2, 0.75 * omega_h**2)
        if scheme == "explicit-euler":
            assert growth == pytest.approx(math.sqrt(1.0 + omega_h**2), rel=1e-12)
        else:
            assert (growth > 1.0 + 1e-12) == (omega_h > limit)  # rounding of roots on the circle
            assert growth >= 1.0


def test_the_march_is_backward_euler_written_out():
    """Sample by sample; stick and slip switch at step ends."""
    C, K, h, n = PAPER.c / PAPER.m, PAPER.k / PAPER.m, 5e-5, 6000
    cycles = n * h / RESONANCE.period
    record = simulate(PAPER, RESONANCE, step=h, cycles=cycles, keep_cycles=cycles)
    x, v, acceleration, _ = np.array([*backward_euler(C, K, RESONANCE.Y, OMEGA, h, n)]).T
    # Both round: 1e-15 a step, not amplified by a damped motion; (v_new − v)/h loses five digits more.
    assert record.x[1 : n + 1] == pytest.approx(x, abs=1e-13)
    assert record.v[1 : n + 1] == pytest.approx(v, abs=1e-12)
    assert record.acceleration[1 : n + 1] == pytest.approx(acceleration, abs=1e-8)
    start = [0, RESONANCE.Y, 0, 0, K * RESONANCE.Y]
    assert [record.t[0], *record.signals[:, 0]] == start


def test_kept_samples_are_the_end_of_the_whole_run():
    whole, end = (
        simulate(PAPER, RESONANCE, step=1e-4, cycles=4, keep_cycles=kept) for kept in (4, 1.5)
    )
    assert whole.t[0] == 0.0
    assert end.t[0] <= 2.5 * RESONANCE.period < end.t[1]
    assert end.t[-2] < 4.0 * RESONANCE.period <= end.t[-1]
    kept = whole.to_frame()[-len(end) :].reset_index(drop=True)
    pd.testing.assert_frame_equal(end.to_frame(), kept, check_exact=True)
    assert whole.y == pytest.approx(RESONANCE.Y * np.cos(OMEGA * whole.t), abs=1e-15)


def test_a_step_too_coarse_for_the_stick_phase_is_refused_with_one_that_is_not():
    with pytest.raises(StepTooCoarse, match=r"samples in a stick phase, 20 are needed") as caught:
        simulate(PAPER, RESONANCE, step=2e-4, cycles=10, keep_cycles=2)
    proposed = float(str(caught.value).split("at most ")[1].split(" s")[0])
    record = simulate(PAPER, RESONANCE, step=proposed, cycles=10, keep_cycles=2)
    t_s = steady_orbit(PAPER, RESONANCE).t_s
    assert MIN_STICK_SAMPLES <= t_s / record.dt < 2 * MIN_STICK_SAMPLES


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"scheme": "leapfrog"}, "scheme must be one of backward-euler, .*, got 'leapfrog'"),
        ({"step": 0.0}, "step must be a positive number of s"),
        ({"step": 1.0}, "below the period"),
        ({"keep_cycles": 0.0}, "keep_cycles must be a positive number"),
        ({"keep_cycles": 4.0}, "keep_cycles must be no more than the cycles"),
        ({"cycles": math.inf}, "^cycles must be a positive number"),
        ({"cycles": 1e6}, "more than 5e.07: take fewer cycles"),
        ({"scheme": "explicit-euler", "step": 0.1, "cycles": 500}, "0.1 s is unstable"),
    ],
)
def test_what_cannot_be_simulated_is_refused(wrong, message):
    given = {"step": 1e-4, "cycles": 3.0, "keep_cycles": 1.0} | wrong
    with pytest.raises(ValueError, match=message):
        simulate(ALWAYS_SLIP, RESONANCE, **given)
