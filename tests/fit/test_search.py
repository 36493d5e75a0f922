"""The search for the oscillator of free decays: where they begin and end, from side minima to the lowest, and intervals
over those as good."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.linalg import expm

from blind.decays import draw, record
from dampbalance.fit.decay import Decay, DecayFit, DecayProblem
from dampbalance.fit.multistart import multistart
from dampbalance.fit.search import _before, in_the_band, to_the_end
from dampbalance.fit.swings import Swings
from dampbalance.identification.decays import identify_decay_records
from dampbalance.signals.bursts import Burst
from fit.exact import decay_of, fitted, start_of

M, K, F_K, START = 2.0, 800.0, 0.4, 5e-3
PERIOD = 2.0 * math.pi * math.sqrt(M / K)
HALF = 0.5 * PERIOD  # between two turns, s
LEVEL = 3.84  # of χ²: a 95 % interval


def decay(noise: float, stiffness: float = 60.0, order: int = 0) -> tuple[Decay, np.ndarray]:
    """A decay that comes to rest after four half cycles and rings on, and its point."""
    t = np.arange(0.0, 5.0 * PERIOD, PERIOD / 90.0)
    point = np.array([F_K, 0.3, (stiffness * K) ** -0.5, M, 0.0, START, 0.0, 1.8])
    return decay_of(point, K, t, noise if order else noise * START, order), point


def off_by_cycles(point: np.ndarray, truth: DecayFit, cycles: int) -> np.ndarray:
    """The point with as many more cycles of ringing."""
    ringing = truth.decays[0].end - truth.sticks_from(0)
    Omega = math.sqrt((K + point[2] ** -2) / M) + 2.0 * math.pi * cycles / ringing
    return np.concatenate([point[:2], [(M * Omega**2 - K) ** -0.5], point[3:]])


@pytest.mark.parametrize(
    ("made", "wrong"),
    [
        ((1e-3,), partial(off_by_cycles, cycles=-3)),
        ((1e-3,), partial(off_by_cycles, cycles=2)),
    ],
    ids=["slower ringing", "faster ringing"],
)
def test_a_side_minimum_is_left_for_the_lowest(made, wrong):
    whole, point = decay(*made)
    truth = fitted(whole, K, point)
    side = fitted(whole, K, wrong(point, truth))
    assert not side.adequate  # a climb alone ends there
    assert side.chi_square > truth.chi_square + 100.0
    (lowest, *_) = multistart(side.problem, [side.parameters], scan="rho")
    assert lowest.chi_square < truth.chi_square + 0.1


def test_a_part_of_a_decay_has_the_unknowns_of_the_whole():
    """Climbs go on from one window to the next, and from one decay alone to all of them, by the names of unknowns."""
    whole, point = decay(1e-3)
    later = replace(whole, start=9.0)
    parts = (whole.cut(HALF, 3.0 * HALF), whole.cut(0.0, HALF).recut(0.1, 2.0).thinned())
    assert {one.key("v") for one in parts} == {whole.key("v")} != {later.key("v")}
    alone = start_of(DecayProblem((whole,), K), point)
    both = DecayProblem((whole, replace(later, friction="other")), K).parameters(
        alone.by_key | {"F_k[other]": 0.5}, ["F_k", "c"]
    )
    assert [one.key for one in both if one.free and one.name in ("F_k", "c", "rho")] == [
        "F_k",
        "F_k[other]",
        "c",
    ]
    assert both["F_k"].value == F_K
    assert both["F_k[other]"].value == 0.5
    assert both[whole.key("x")].value == START
    assert both[later.key("x")].value == 0.0


def test_a_period_that_the_spectrum_doubled_does_not_hold_the_mass():
    """The mass is bounded below by the period; records of several pulls may show a line at half the frequency."""
    whole, point = decay(1e-2)
    start = point.copy()
    start[3] *= 1.02
    right, doubled = (
        fitted(replace(whole, period=factor * PERIOD), K, start) for factor in (1.0, 2.1)
    )
    assert doubled.m == pytest.approx(right.m, rel=1e-6)
    assert abs(right.m - M) < 4.0 * right.error("m")


def test_an_interval_ends_where_chi_square_has_risen_by_that_of_its_probability():
    whole, point = decay(3e-3)
    fit = fitted(whole, K, point)
    for name in ("F_k", "c", "rho"):
        j = fit.parameters.places[name]
        for end in fit.interval(name):
            start = fit.point + fit.covariance[:, j] * ((end - fit.point[j]) / fit.covariance[j, j])
            start[j] = end
            held = fit.parameters.held(name).at(start)
            rise = fit.problem.climb(held).chi_square - fit.chi_square
            # χ² is no parabola; a kink of it lies where an event passes a sample
            assert rise == pytest.approx(LEVEL, rel=0.2)


def test_an_interval_covers_all_minima_that_are_as_good():
    whole, point = decay(1e-3)
    best = fitted(whole, K, point)
    moved = best.parameters.moved(rho=1.1 * best.rho)

    def raised(by: float) -> DecayFit:
        """The fit with another minimum, so much higher."""
        other = replace(best, parameters=moved, chi_square=best.chi_square + by)
        return replace(best, minima=(other,))

    alone, near = (raised(by).interval("rho") for by in (12.0, 1.0))
    assert alone == best.interval("rho")
    assert near[0] == alone[0]
    reach = math.sqrt(LEVEL - 1.0) * best.error("rho")
    assert near[1] == pytest.approx(1.1 * best.rho + reach, rel=1e-3)


@pytest.mark.parametrize("index", [2, 14])
def test_an_interval_holds_every_contact_that_explains_the_decay_as_well(index):
    """χ² has several minima along K_z where noise hides the ringing: held there, climbs from the truth are as good."""
    drawn = draw(index, 91)
    noisy = replace(drawn, answers=("velocity",), noise=0.05)
    fit = identify_decay_records([record(noisy, index)[0]], noisy.k).basis.fit
    low, high = fit.K_z_interval
    likely = []
    for stiffness in noisy.K_z * np.geomspace(0.25, 4.0, 9):
        truth = {"F_k": noisy.F_k, "c": noisy.c, "rho": stiffness**-0.5, "m": noisy.m}
        end = fit.problem.climb(fit.parameters.moved(**truth).held("rho"))
        if end is not None and end.chi_square < fit.chi_square + 0.7 * LEVEL:
            likely.append(stiffness)
    assert likely
    # half a standard error from one point of the profile to the next
    margin = 0.5 * fit.error("rho")
    assert all(low**-0.5 + margin > s**-0.5 > high**-0.5 - margin for s in likely)


def test_the_state_a_step_earlier_is_that_of_the_damped_motion():
    """m ẍ + c ẋ + k x = −F_k while the mass slips forwards: the matrix exponential of a step back in time."""
    c, step, now = 30.0, 2.0 * HALF / 24.0, np.array([1e-3, 0.05])
    rest = np.array([-F_K / K, 0.0])
    exact = rest + expm(-step * np.array([[0.0, 1.0], [-K / M, -c / M]])) @ (now - rest)
    whole, _ = decay(1e-3)
    start = start_of(DecayProblem((whole,), K), np.array([F_K, c, 1e-6, M, 0.0, *now, 2.0]))
    x, v, w = _before(start, whole, K, step).values[-3:]
    # of second order; 16 steps of (ωh, hc/m) = (0.016, 0.012) leave 1.3e-3
    assert [x, v] == pytest.approx(exact, rel=3e-3)
    assert w == 2.0


def test_the_swings_tell_friction_damping_and_mass():
    """They tell them to a few per cent, from 30 half cycles of a rigid contact in the band of the mode."""
    t = np.arange(0.0, 16.0 * PERIOD, PERIOD / 60.0)
    point = np.array([0.03, 0.3, (1e4 * K) ** -0.5, M, 0.0, START, 0.0, 2.0])
    (signal,) = decay_of(point, K, t, 1e-3 * START).signals
    burst = Burst(HALF, 1.9 * START, 1.1 * PERIOD, 0.0, float(t[-1]), last=True)
    F_k, c, m = Swings(signal, burst).oscillator(K)
    assert F_k == pytest.approx(0.03, rel=0.1)
    assert c == pytest.approx(0.3, rel=0.15)
    assert m == pytest.approx(M, rel=0.01)


def test_a_single_swing_tells_the_size_of_friction():
    """Of a motion that rests after four half cycles the first two show one swing: friction a fifth to five times so
    large is a start from which a climb arrives, at any size of the motion."""
    whole, _ = decay(1e-3)
    (signal,) = whole.signals
    for size in (1.0, 1e-3):
        smaller = replace(signal, values=size * signal.values, noise=size * signal.noise)
        burst = Burst(HALF, 1.8 * size * START, PERIOD, 0.0, 1.6 * HALF, last=True)
        swings = Swings(smaller, burst)
        assert swings.sizes.size < 2
        assert 0.2 < swings.oscillator(K)[0] / (size * F_K) < 5.0


def with_what_follows(
    noise: float, caught: float = math.inf, order: int = 2
) -> tuple[DecayFit, DecayFit]:
    """The fit of a decay up to a cycle after it came to rest, and with what follows.

    caught : when a hand takes the ringing off, s.
    """
    whole, point = decay(noise, order=order)
    (signal,) = whole.signals
    random = np.random.default_rng(1)
    held = noise * random.standard_normal(signal.t.size)
    signal = replace(signal, values=np.where(signal.t < caught, signal.values, held))
    whole = replace(whole, signals=(signal,))
    rest = whole.start + fitted(whole, K, point).sticks_from(0) + PERIOD
    fit = fitted(whole.cut(whole.start, rest), K, point)
    return fit, to_the_end(fit)


def test_the_ringing_of_the_mass_at_rest_tells_the_contact():
    """The error of a frequency falls with the time to the power 3/2: over 2.6 cycles for 1, four times, less
    what the ringing has decayed by."""
    fit, longer = with_what_follows(0.05)
    assert longer.decays[0].end > fit.decays[0].end + 1.5 * PERIOD
    assert longer.error("rho") < 0.45 * fit.error("rho")
    assert abs(longer.value("rho") - (60.0 * K) ** -0.5) < 4.0 * longer.error("rho")


@pytest.mark.parametrize("cycles", [3.6, 3.8, 4.0])
def test_a_hand_that_catches_the_ringing_mass_ends_its_decay(cycles):
    """The ringing that is missing would look like damping; the first fit ends after 3.44 cycles."""
    fit, longer = with_what_follows(0.01, cycles * PERIOD)
    disturbed = replace(fit.problem, decays=(fit.decays[0].recut(0.0, math.inf),)).climb(
        fit.parameters
    )
    assert disturbed.c - 0.3 > 6.0 * disturbed.error("c")
    assert longer.decays[0].end < cycles * PERIOD
    for name, truth in zip(
        ("F_k", "c", "rho", "m"), (F_K, 0.3, (60.0 * K) ** -0.5, M), strict=True
    ):
        assert abs(longer.value(name) - truth) < 4.0 * longer.error(name), name


def test_noise_after_the_mass_came_to_rest_tells_nothing():
    fit, longer = with_what_follows(0.01, order=0)
    assert longer is fit


def disturbed(kind: str) -> tuple[Decay, np.ndarray]:
    """A decay whose record holds more than its motion, and the point of that motion."""
    t = np.arange(0.0, 12.0 * PERIOD, PERIOD / 60.0)
    point = np.array([0.03, 0.3, (30.0 * K) ** -0.5, M, 0.0, START, 0.0, 2.0])
    whole = decay_of(point, K, t, 1e-3 * START)
    (signal,) = whole.signals
    more = {
        "drift": 0.05 * START * t / t[-1],
        "hum": 0.003 * START * np.sin(2.0 * math.pi * 7.3 / PERIOD * t),
        "second mode": 0.03
        * START
        * np.exp(-t / PERIOD)
        * np.sin(2.0 * math.pi * 5.2 / PERIOD * t),
    }[kind]
    return replace(whole, signals=(replace(signal, values=signal.values + more),)), point


@pytest.mark.parametrize("kind", ["drift", "hum", "second mode"])
def test_what_lies_outside_the_band_of_the_mode_moves_no_number(kind):
    whole, point = disturbed(kind)
    wide = fitted(whole, K, point)
    assert not wide.adequate
    fit = in_the_band(wide)
    for name, truth in zip(("F_k", "c", "m"), point[[0, 1, 3]], strict=True):
        assert abs(fit.value(name) - truth) < 4.0 * fit.error(name), name
    assert fit.error("F_k") < 0.01 * F_K
    assert fit.error("c") < 0.03 * 0.3


def test_intervals_in_the_band_hold_the_truth():
    """They hold it in 95 % of 40 records with white noise: in at least 33 of 40 with a probability of 0.998."""
    t = np.arange(0.0, 12.0 * PERIOD, PERIOD / 60.0)
    point = np.array([0.03, 0.3, (30.0 * K) ** -0.5, M, 0.0, START, 0.0, 2.0])
    held = np.zeros(2)
    for seed in range(40):
        whole = decay_of(point, K, t, 1e-2 * START, seed=seed)
        fit = in_the_band(fitted(whole, K, point))
        ends = [fit.interval(name) for name in ("F_k", "c")]
        held += [low < truth < high for (low, high), truth in zip(ends, point[:2], strict=True)]
    assert (held >= 33).all()


def test_clipped_samples_are_left_out():
    """The first peaks are cut off at half: what is left tells the rest."""
    t = np.arange(0.0, 12.0 * PERIOD, PERIOD / 60.0)
    point = np.array([0.03, 0.3, (30.0 * K) ** -0.5, M, 0.0, START, 0.0, 2.0])
    whole = decay_of(point, K, t, 1e-3 * START)
    (signal,) = whole.signals
    top = 0.5 * START
    cut = replace(signal, values=np.clip(signal.values, -top, top), limits=(-top, top))
    assert cut.left_out.sum() > 50
    for fit in (wide := fitted(replace(whole, signals=(cut,)), K, point), in_the_band(wide)):
        for name, truth in zip(("F_k", "c", "m"), point[[0, 1, 3]], strict=True):
            assert abs(fit.value(name) - truth) < 4.0 * fit.error(name), name


def test_a_mass_that_rests_at_once_is_no_longer_decay():
    """Three plucks of hardly more than the noise: what starts there may stick after its first sample."""
    plucked = draw(151, 1795560035)
    measured, _ = record(plucked, 1795560035)
    found = identify_decay_records([measured], plucked.k)
    assert found.intervals["F_k"][0] < plucked.F_k < found.intervals["F_k"][1]
