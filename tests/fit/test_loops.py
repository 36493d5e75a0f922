"""The fit of measured loops, against loops whose contact was written down."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import t as student

from dampbalance.fit.loop_design import Design
from dampbalance.fit.loops import slider, weigh
from dampbalance.signals.loops import Loop, corners, middles, turning_points
from fit.exact import off

F_K, K_Z, K, C, X, RATE = 10.0, 5e4, 300.0, 3.0, 1e-3, 500.0
FAR = 5.0  # standard errors are exceeded once in 20,000 cases of 18 degrees of freedom
TRUTH = {"F_k": F_K, "K_z": K_Z, "c": C}
T = np.arange(0.0, 20.0, 1.0 / RATE)
SINE = X * np.sin(2.0 * np.pi * T)
TRIANGLE = X * (4.0 * np.abs((T + 0.25) % 1.0 - 0.5) - 1.0)


def stepped(x, r):
    """Deflection of a slider, sample by sample."""
    z = np.zeros(x.size)
    for i in range(1, x.size):
        z[i] = min(max(z[i - 1] + x[i] - x[i - 1], -r), r)
    return z


def loop(x=SINE, *, seed=0, noise=0.01, c=C, gap=0.0, sign=1.0, contact=((K_Z, F_K / K_Z),)):
    """A loop with noise, an offset and a drift."""
    force = K * x + c * np.gradient(x, T) + 0.7 + 0.02 * T
    for kappa, r in contact:
        z = stepped(x, r + gap)
        force = force + kappa * np.sign(z) * np.maximum(np.abs(z) - gap, 0.0)
    noisy = force + noise * F_K * np.random.default_rng(seed).normal(size=T.size)
    return Loop.of("loop", T, x, sign * noisy)


def fitted(*loops):
    return slider(Design(loops))


@pytest.mark.parametrize("late", [0.0, 0.2, 0.5, 0.9])
def test_corners_between_samples_are_found(late):
    """A triangle of unit slope whose samples come late by a part of a step; of a sine there is no corner."""
    t = np.arange(400.0) + late
    x = 50.0 * (4.0 * np.abs((t / 200.0 + 0.25) % 1.0 - 0.5) - 1.0)
    for motion, near in ((x, 1e-9), (50.0 * np.sin(np.pi * t / 100.0), 1e-5)):
        through = corners(motion, turning_points(motion, 4.0), 0.0)
        assert np.abs(through).max() == pytest.approx(50.0, abs=near)


def test_reversals_are_returns_by_more_than_noise():
    x = SINE + 1e-5 * np.random.default_rng(2).normal(size=T.size)
    turns = turning_points(x, 0.04 * 2 * X)
    assert turns.size == 40
    # a peak of a sine is flat: the noise moves it by √(2·10⁻⁵·3.5/X)/2π of a period, 0.04 s, at the most
    assert np.abs(T[turns] - (0.25 + 0.5 * np.arange(40))).max() < 0.05


@pytest.mark.parametrize("x", [SINE, 0.5 * SINE], ids=["full", "half"])
def test_a_slider_with_spring_and_damper_is_identified(x):
    fit = fitted(loop(x))
    # requirement at 1 % of noise: F_k within 1 %, K_z within 5 %
    assert fit.value("F_k") == pytest.approx(F_K, rel=0.01)
    assert fit.value("K_z") == pytest.approx(K_Z, rel=0.05)
    assert off(fit, F_k=F_K, K_z=K_Z, k=K, c=C) < FAR


def test_intervals_hold_the_truth_as_often_as_they_say():
    inside = []
    for seed in range(20):
        fit = fitted(loop(seed=seed))
        reach = student.ppf(0.975, fit.freedom)
        inside += [off(fit, **{s: true}) < reach for s, true in TRUTH.items()]
    # 60 with a probability of 95 %, three of a fit being one: 4 σ = 4·√(0.95·0.05/20) is 19 %
    assert np.mean(inside) > 0.76


@pytest.mark.parametrize("x", [SINE, TRIANGLE], ids=["sine", "triangle"])
def test_noise_of_the_displacement_rounds_no_corner(x):
    """Of 0.2 % of its range, of which 1 % of the way to slip is left: a slider that reverses with it is 20 % off."""
    noisy = x + 0.004 * X * np.random.default_rng(6).normal(size=T.size)
    fit = fitted(Loop.of("noisy", T, noisy, loop(x, c=0.0).f).settled())
    assert fit.value("F_k") == pytest.approx(F_K, rel=0.005)
    assert off(fit, F_k=F_K, K_z=K_Z) < FAR


V = np.gradient(SINE, T)
V_0 = 0.3 * 2.0 * np.pi * X


@pytest.mark.parametrize(
    ("force", "name", "truth"),
    [
        (loop(contact=()).f + F_K * np.tanh(V / V_0), "rounded", {"F_k": F_K, "v_0": V_0}),
        (loop().f + 5.0 * (SINE / X) ** 3, "k_3", {"F_k": F_K, "K_z": K_Z, "k_3": 5.0 / X**3}),
        (loop().f, "", TRUTH),
        (loop(gap=1e-4).f, "gap", TRUTH | {"g": 1e-4}),
    ],
)
def test_what_the_loops_hold_is_told_from_a_slider(force, name, truth):
    found = weigh(Design([Loop.of(name, T, SINE, force).settled()]))
    assert found.names == ((name,) if name else ())
    assert off(found.fit, **truth) < FAR


def test_a_force_of_the_other_sign_is_turned():
    own, other = loop(), loop(sign=-1.0)
    assert (own.flipped, other.flipped) == (False, True)
    np.testing.assert_array_equal(own.f, other.f)


def test_a_triangle_determines_c_at_two_speeds_only():
    design = Design([loop(TRIANGLE)])
    assert not design.with_c
    fit = weigh(design).fit
    assert fit.value("F_k") == pytest.approx(F_K + C * 4.0 * X, rel=0.01)
    assert fit.value("K_z") == pytest.approx(K_Z, rel=0.05)
    slow = np.interp(0.5 * T, T, TRIANGLE)
    design = Design([loop(TRIANGLE, c=300.0), loop(slow, c=300.0, seed=1)])
    assert design.with_c
    fit = weigh(design).fit
    assert fit.value("c") == pytest.approx(300.0, rel=0.05)
    assert fit.value("F_k") == pytest.approx(F_K, rel=0.02)


def test_many_sliders_are_chosen_where_there_are_many():
    contact = [(1e4, 1e-5 * 60 * 0.7**j) for j in range(8)]
    weighed = weigh(Design([loop(contact=contact)]))
    assert weighed.names == ("gradual",)
    assert weighed.fit.value("F_k") == pytest.approx(sum(a * r for a, r in contact), rel=0.02)
    assert weighed.fit.value("K_z") == pytest.approx(8e4, rel=0.05)


def test_a_contact_that_only_sticks_has_no_friction_force():
    assert not fitted(loop(0.15 * SINE, noise=1e-3)).slips


def test_a_motion_without_a_complete_cycle_is_refused():
    with pytest.raises(ValueError, match=r"makes 0 complete cycles, .* and 1 are needed"):
        Loop.of("short", T[:450], SINE[:450], SINE[:450])


def test_cycles_begin_in_the_middle_after_rest_and_follow_a_mean_that_drifts():
    """To half a sample; an amplitude that grows moves no middle."""
    rest, grown = np.zeros(700), np.repeat([0.3, 0.6, 1.0, 1.0], 500) * SINE[:2000]
    for x, first in ((grown, 0), (np.concatenate([rest, grown, rest]), 699), (-grown, 0)):
        np.testing.assert_allclose(
            middles(x, turning_points(x, 0.08 * X)), first + 500 * np.arange(5), atol=2
        )
    drifting = SINE + 0.1 * X * T
    begins = middles(drifting, turning_points(drifting, 0.08 * X))
    assert np.abs(begins[:20] - 500 * np.arange(20)).max() < 10
