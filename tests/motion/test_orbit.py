"""The steady orbit as an object: features, states at any times, round trip, and what it says when there is none."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot

from analytic.cases import SEVERAL_SLIPS, case
from dampbalance import BaseMotion, NoSteadyOrbit, Orbit, Oscillator, Regime, steady_orbit
from dampbalance.motion.events import PHASE_T
from paper_case import PAPER

CASES = [
    (0.6, 1.0, 90.0, 0.14),
    (3.0, 0.7, 30.0, 0.1),
    (0.3, 0.7, 5.0, 3.0),  # no slip
    (0.4, 0.8, 10.0, 0.0),  # no friction
    (0.0, 0.21, 24.0, 0.5),  # undamped and slow: many free oscillations in a cycle
    *[*SEVERAL_SLIPS][::3],
]


@pytest.fixture(scope="module", params=CASES, ids=str)
def orbit(request):
    return steady_orbit(*case(*request.param))


def test_reversals_and_onset(orbit):
    X, omega = orbit.X, orbit.motion.omega
    assert orbit.t_2 - orbit.t_1 == pytest.approx(0.5 * orbit.motion.period, rel=1e-14)
    assert -0.5 * math.pi <= orbit.phi < 1.5 * math.pi
    # rounding of t times the largest rates: ω_stick² / ω² of the size of the motion at most
    for time, sign in ((orbit.t_1, -1.0), (orbit.t_2, 1.0)):
        state = orbit.state(time)
        assert float(state.x) == pytest.approx(sign * X, rel=1e-14)
        assert float(state.v) == pytest.approx(0.0, abs=1e-10 * omega * X)
    if orbit.regime in (Regime.NO_SLIP, Regime.NO_FRICTION):
        return
    state = orbit.state(orbit.t_1 + orbit.t_s)
    assert float(state.x) == pytest.approx(orbit.X_s, rel=0, abs=1e-12 * X)
    assert float(state.v) == pytest.approx(orbit.V_s, rel=1e-10)  # rounding of t times the jerk
    assert float(state.z) == pytest.approx(orbit.oscillator.Z_m, rel=1e-10)
    before = orbit.state(orbit.t_1 + orbit.t_s * np.linspace(0.0, 0.999, 50))
    assert np.all(before.z < orbit.oscillator.Z_m)  # it is the first onset, from the reversal on


def sampled(orbit, n=2001):
    t = np.linspace(-0.3, 1.4, n) * orbit.motion.period
    return t, orbit.state(t)


def test_states_satisfy_the_equation_of_motion(orbit):
    o, motion = orbit.oscillator, orbit.motion
    t, (x, v, acceleration, z) = sampled(orbit)
    spring = o.k * x + o.c * v + o.K_z * z
    residual = o.m * acceleration + spring - o.k * motion.y(t)
    # an identity of the force balance: rounding of the sum
    np.testing.assert_allclose(residual, 0.0, rtol=0, atol=1e-13 * o.k * (orbit.X + motion.Y))
    assert np.all(np.abs(x) <= orbit.X * (1.0 + 1e-13))
    assert np.all(np.abs(z) <= o.Z_m * (1.0 + 1e-12))


def test_velocity_and_acceleration_are_the_derivatives(orbit):
    # central differences within phases: the state is one smooth motion, not four unrelated curves
    o, t_1 = orbit.oscillator, orbit.t_1
    edges = [*orbit.phases[:, PHASE_T], 0.5 * orbit.motion.period]
    fastest = max(math.sqrt((o.k + o.K_z) / o.m), o.c / o.m, orbit.motion.omega)
    for start, end in itertools.pairwise(edges):
        h = 1e-4 * min(end - start, 1.0 / fastest)
        x, v, acceleration, _ = orbit.state(t_1 + 0.5 * (start + end) + h * np.array([-1, 0, 1]))
        # truncation: h²/6 times two more derivatives; and the rounding of x, t over h
        rounding = 1e-15 * orbit.X * (1.0 + orbit.motion.omega * orbit.motion.period) / h
        slack = 1e-7 * (np.abs(v).max() + np.abs(acceleration).max() / fastest) + rounding
        assert (x[2] - x[0]) / (2.0 * h) == pytest.approx(v[1], rel=0, abs=slack)
        slack = 1e-7 * (np.abs(acceleration).max() + fastest * np.abs(v).max()) + fastest * rounding
        assert (v[2] - v[0]) / (2.0 * h) == pytest.approx(acceleration[1], rel=0, abs=slack)


def test_harmonics_by_the_discrete_fourier_transform(orbit):
    n = 4096
    x = orbit.state(np.arange(n) / n * orbit.motion.period).x
    spectrum = 2.0 / n * np.fft.rfft(x)
    assert np.abs(spectrum[0:8:2]).max() <= 1e-13 * orbit.X  # half-wave symmetry: odd ones only
    # of any period: the rounding of t, three periods off, at rates of up to some thousand ω
    late = orbit.state(-3.0 * orbit.motion.period + 0.1).x
    assert late == pytest.approx(orbit.state(0.1).x, rel=0, abs=2e-11 * orbit.X)
    for order in (1, 3, 5):
        X_n, phi_n = orbit.harmonic(order)
        # aliases: X_n falls as n⁻⁴ (ẍ is continuous, the jerk jumps) from 4096 on
        exact = X_n * np.exp(-1j * phi_n)
        assert abs(spectrum[order] - exact) <= 1e-11 * orbit.X
    # the phase of a DFT counts from the first sample, t = 0, where y is at its peak
    series = orbit.harmonics(40)
    assert np.abs(series - spectrum[1:80:2]).max() <= 1e-11 * orbit.X
    assert orbit.harmonics(3) == pytest.approx(series[:3], rel=1e-12)
    # the energy of all harmonics is that of the velocity; the squares of n x_n beyond n leave n⁻³ or so
    squares, omega = np.abs(orbit.harmonics(400)) ** 2, orbit.motion.omega
    assert math.pi * omega * squares @ np.arange(1, 800, 2) ** 2 == pytest.approx(orbit.b, rel=1e-7)
    if orbit.regime is Regime.NO_SLIP:
        assert not series[1:].any()


def test_an_orbit_that_takes_long_is_given_up_on_request():
    # far below resonance and lightly damped: several slips per half cycle, which alone has 9,000 rad
    stiff = Oscillator(m=2.42, c=4.0, k=2310.0, K_z=1e9, F_k=2.0), BaseMotion(0.004, 7.0)
    with pytest.raises(NoSteadyOrbit):
        steady_orbit(*stiff, most_radians=1e4)
    # the closed form follows nothing
    one = replace(PAPER, K_z=1e9), BaseMotion(0.006, 31.0)
    assert steady_orbit(*one, most_radians=1e4).regime is Regime.ONE_SLIP


def test_round_trip_bit_for_bit(orbit):
    again = Orbit.from_dict(json.loads(json.dumps(orbit.to_dict())))
    assert (again.oscillator, again.motion, again.regime) == (
        orbit.oscillator,
        orbit.motion,
        orbit.regime,
    )
    assert again.to_dict() == orbit.to_dict()
    t, state = sampled(orbit, 101)
    for first, second in zip(state, again.state(t), strict=True):
        assert first.tobytes() == second.tobytes()
    with pytest.raises(ValueError, match="read-only"):
        again.phases[0, PHASE_T] = 1.0


def test_what_makes_no_sense_is_refused():
    orbit = steady_orbit(*case(*CASES[0]))
    for n in (0, 2, 7, 1.5):
        with pytest.raises(ValueError, match=f"n must be .*, got {n}"):
            orbit.harmonic(n)
    data = orbit.to_dict()
    with pytest.raises(ValueError, match=r"Oscillator\.m must be a positive number of kg"):
        Orbit.from_dict(data | {"oscillator": data["oscillator"] | {"m": -1.0}})
    with pytest.raises(ValueError, match=r"quantity must be one of t, x, v, .* got 'force'"):
        orbit.plot("force")


@pytest.mark.parametrize("Y", [0.004, 0.0002])
def test_it_shows_values_first_and_draws_itself(Y):
    orbit = steady_orbit(PAPER, BaseMotion(Y, 22.0))
    assert repr(orbit).startswith(f"Orbit  X = {orbit.X:.4g} m, φ = {orbit.phi:.4g} rad, W = ")
    assert f"{orbit.b:.6g}" in orbit._repr_html_()
    (row,) = orbit.to_frame().to_dict("records")
    assert (row["k_N_per_m"], row["X_m"], row["regime"]) == (PAPER.k, orbit.X, str(orbit.regime))
    axes = orbit.plot("acceleration", "x", color="r")
    whole, *stick = axes.get_lines()
    assert {line.get_color() for line in (whole, *stick)} == {"r"}
    x, acceleration = whole.get_data()
    assert x.max() == pytest.approx(orbit.X, rel=1e-12)
    assert acceleration[0] == pytest.approx(acceleration[-1], rel=1e-9)
    assert len(stick) == 2
    if orbit.regime is Regime.ONE_SLIP:  # the microstick line runs from −X to X_s
        assert stick[0].get_xdata()[[0, -1]] == pytest.approx([-orbit.X, orbit.X_s], rel=1e-9)
    assert orbit.plot(ax=axes) is axes
    pyplot.close("all")
