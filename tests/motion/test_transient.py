"""The exact response from any initial state, as an object; its truth is tested in tests/analytic."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from analytic.cases import PAPER_MOTIONS, case, drawn
from dampbalance import BaseMotion, Oscillator, transient
from dampbalance.motion.events import PHASE_S, PHASE_T
from paper_case import PAPER

MOTION = PAPER_MOTIONS[0]
END = 3.0 * MOTION.period
unit = st.floats(-1.0, 1.0)


@pytest.mark.parametrize(
    "given", [{}, {"x": 1e-3, "v": -0.02, "z": -0.3 * PAPER.Z_m, "start": 0.1}]
)
def test_the_path_begins_with_its_state_or_at_rest_and_both_ends_belong_to_it(given):
    path, start = transient(PAPER, MOTION, END, **given), given.get("start", 0.0)
    state = path.state([start, END])
    assert [getattr(state, name)[0] for name in "xvz"] == [given.get(name, 0.0) for name in "xvz"]
    assert np.all(np.isfinite(state.acceleration))
    if not given:
        assert state.acceleration[0] == pytest.approx(PAPER.k * MOTION.Y / PAPER.m, rel=1e-15)
    assert (path.phases[0, PHASE_T], path.end) == (start, END)


@settings(max_examples=60)
@given(
    *drawn((1e-3, 5.0), (0.1, 5.0), (0.01, 1e3), (1e-3, 3.0)),
    unit,
    unit,
    st.one_of(unit, st.sampled_from([-1.0, 0.0, 1.0])),
)
# both limits of the spring within a third of a radian
@example(1.0, 1.0, 1.0, math.exp(-5.0), -1.0, -0.125, 0.0)
def test_rules_of_the_contact(zeta, r, K, F, x, v, z):
    o, motion = case(zeta, r, K, F)
    start = {"x": 3 * motion.Y * x, "v": 3 * motion.Y * motion.omega * v, "z": o.Z_m * z}
    path = transient(o, motion, 2.0 * motion.period, **start)
    phases, Z_m = path.phases, o.Z_m
    assert np.all(np.diff(phases[:, PHASE_T]) >= 0.0)
    assert set(phases[:, PHASE_S]) <= {-1.0, 0.0, 1.0}
    # one phase ends where the next begins; no two phases of the same state follow each other
    assert np.all(np.diff(phases[:, PHASE_S]) != 0.0)
    t = np.linspace(phases[0, PHASE_T], path.end, 500)
    state = path.state(t)
    assert np.all(np.abs(state.z) <= Z_m * (1.0 + 1e-12))  # rounding
    s = phases[np.searchsorted(phases[:, PHASE_T], t, side="right") - 1, 1]
    # in slip the spring is at its limit and the mass moves that way; 1e-12 for the instants of reversal
    slips = s != 0.0
    np.testing.assert_array_equal(state.z[slips], s[slips] * Z_m)
    assert np.all((s * state.v)[slips] >= -1e-12 * np.abs(state.v).max())
    # the equation of motion: an identity up to rounding
    forces = o.m * state.acceleration + o.c * state.v + o.k * state.x + o.K_z * state.z
    size = o.k * (motion.Y + np.abs(state.x).max()) + o.c * np.abs(state.v).max() + o.F_k
    np.testing.assert_allclose(forces, o.k * motion.y(t), rtol=0, atol=1e-13 * size)


def test_many_events():
    # some 3000 phases: more than are computed at once
    path = transient(PAPER, MOTION, 700.0 * MOTION.period)
    assert len(path.phases) > 2500
    assert np.all(np.diff(path.phases[:, PHASE_T]) > 0.0)


def test_slider_without_friction():
    o = Oscillator(m=1.0, c=0.2, k=4.0, K_z=10.0, F_k=0.0)
    motion = BaseMotion(Y=0.5, omega=1.0)
    free = transient(o, motion, 30.0, x=0.3, v=-0.1)
    state = free.state(np.linspace(0.0, 30.0, 50))
    assert np.all(state.z == 0.0)
    # the linear oscillator in closed form: steady motion plus what the initial state adds
    delta, sigma = 0.1, math.sqrt(4.0 - 0.01)
    G = 2.0 / (4.0 - 1.0 + 0.2j)
    q, w = 0.3 - G.real, -0.1 + G.imag
    t = np.linspace(0.0, 30.0, 50)
    free_part = q * np.cos(sigma * t) + (w + delta * q) / sigma * np.sin(sigma * t)
    expected = (G * np.exp(1j * t)).real + np.exp(-delta * t) * free_part
    # a slider without friction still has an event at each reversal, whose rounding adds up
    np.testing.assert_allclose(state.x, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("z", [1.0, -1.0])
def test_starts_at_the_limit_of_the_spring(z):
    limit = z * PAPER.Z_m
    onward = transient(PAPER, MOTION, END, v=z * 0.1, z=limit)
    assert onward.phases[0, PHASE_S] == z  # slips at once
    back = transient(PAPER, MOTION, END, v=-z * 0.1, z=limit)
    assert back.phases[0, PHASE_S] == 0.0  # lets go
    # at rest the force decides: the base pulls with kY = 9.24 N at t = 0, seven times F_k
    still = transient(PAPER, MOTION, END, z=limit)
    assert still.phases[0, PHASE_S] == (1.0 if z > 0.0 else 0.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"x": math.nan}, "^x must be a number of .*, got nan"),
        ({"end": math.nan}, "^end must be a number of .*, got nan"),
        ({"z": (1.0 + 1e-12) * PAPER.Z_m}, r"^z must lie within ±Z_m = ±6\.15385e-06 m, got "),
        ({"z": -1.1 * PAPER.Z_m}, "^z must lie within"),
        ({"start": 1.0, "end": 1.0}, r"^end must be later than start = 1\.0, got 1\.0$"),
    ],
    ids=str,
)
def test_states_and_spans_that_make_no_sense_are_refused(given, message):
    with pytest.raises(ValueError, match=message):
        transient(PAPER, MOTION, **{"end": END, **given})


@pytest.mark.parametrize("t", [-1e-9, END * (1.0 + 1e-9), [0.1, -0.1], math.nan])
def test_times_outside_the_path_are_refused(t):
    with pytest.raises(
        ValueError, match=r"^times must lie within \[0\.0, 0\.6|^t must be a number of s"
    ):
        transient(PAPER, MOTION, END).state(t)
