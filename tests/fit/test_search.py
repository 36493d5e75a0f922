"""The search for the oscillator of free decays: where they begin and end, from side minima to the lowest, and intervals
over those as good."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from blind.decays import draw, record
from dampbalance.fit.decay import Decay, DecayFit
from dampbalance.fit.multistart import multistart
from dampbalance.fit.search import in_the_band, to_the_end
from dampbalance.fit.swings import Swings
from dampbalance.identification.decays import identify_decay_records
from dampbalance.signals.bursts import Burst
from fit.exact import decay_of, fitted, off

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


@pytest.mark.parametrize("cycles", [-3, 2])
def test_a_side_minimum_is_left_for_the_lowest(cycles):
    whole, point = decay(1e-3)
    truth = fitted(whole, K, point)
    side = fitted(whole, K, off_by_cycles(point, truth, cycles))
    assert not side.adequate  # a climb alone ends there
    assert side.chi_square > truth.chi_square + 100.0
    (lowest, *_) = multistart(side.problem, [side.parameters], scan="rho")
    assert lowest.chi_square < truth.chi_square + 0.1


def test_a_climb_may_start_without_friction():
    """An earlier climb may end there: F_k then has no size of its own."""
    whole, point = decay(1e-3)
    assert np.isfinite(fitted(whole, K, np.append(0.0, point[1:])).point).all()


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


def test_an_interval_holds_every_contact_that_explains_the_decay_as_well():
    """χ² has several minima along K_z where noise hides the ringing: held there, climbs from the truth are as good."""
    noisy = replace(draw(14, 91), answers=("velocity",), noise=0.05)
    fit = identify_decay_records([record(noisy, 14)[0]], noisy.k).basis.fit
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


def test_the_swings_tell_friction_damping_and_mass():
    """They tell them to a few per cent, from 24 half cycles in the band of the mode."""
    (signal,) = long_decay(1e-3)[0].signals
    burst = Burst(HALF, 1.9 * START, 1.1 * PERIOD, 0.0, float(signal.t[-1]), last=True)
    F_k, c, m = Swings(signal, burst).oscillator(K)
    assert F_k == pytest.approx(0.03, rel=0.1)
    assert c == pytest.approx(0.3, rel=0.15)
    assert m == pytest.approx(M, rel=0.01)


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


@pytest.mark.parametrize("cycles", [3.6, 4.0])
def test_a_hand_that_catches_the_ringing_mass_ends_its_decay(cycles):
    """The ringing that is missing would look like damping; the first fit ends after 3.44 cycles."""
    fit, longer = with_what_follows(0.01, cycles * PERIOD)
    whole = replace(fit.problem, decays=(fit.decays[0].recut(0.0, math.inf),))
    assert whole.climb(fit.parameters).c - 0.3 > 6.0 * whole.climb(fit.parameters).error("c")
    assert longer.decays[0].end < cycles * PERIOD
    assert off(longer, F_k=F_K, c=0.3, rho=(60.0 * K) ** -0.5, m=M) < 4.0


def test_noise_after_the_mass_came_to_rest_tells_nothing():
    fit, longer = with_what_follows(0.01, order=0)
    assert longer is fit


def long_decay(noise, seed=5):
    """A decay of some twelve cycles, and its point."""
    t = np.arange(0.0, 12.0 * PERIOD, PERIOD / 60.0)
    point = np.array([0.03, 0.3, (30.0 * K) ** -0.5, M, 0.0, START, 0.0, 2.0])
    return decay_of(point, K, t, noise * START, seed=seed), point


T = np.arange(0.0, 12.0, 1.0 / 60.0)  # periods
MORE = {
    "drift": 0.05 * T / T[-1],
    "hum": 0.003 * np.sin(2.0 * math.pi * 7.3 * T),
    "second mode": 0.03 * np.exp(-T) * np.sin(2.0 * math.pi * 5.2 * T),
}
"""What a record may hold besides its motion, in parts of its start."""


@pytest.mark.parametrize("kind", MORE)
def test_what_lies_outside_the_band_of_the_mode_moves_no_number(kind):
    whole, point = long_decay(1e-3)
    (signal,) = whole.signals
    signal = replace(signal, values=signal.values + START * MORE[kind][: signal.values.size])
    wide = fitted(replace(whole, signals=(signal,)), K, point)
    assert not wide.adequate
    fit = in_the_band(wide)
    assert off(fit, F_k=0.03, c=0.3, m=M) < 4.0
    assert fit.error("F_k") < 0.01 * F_K
    assert fit.error("c") < 0.03 * 0.3


def test_intervals_in_the_band_hold_the_truth():
    """They hold it in 95 % of 20 records with white noise: in at least 15 of 20 with a probability of 0.9997."""
    held = np.zeros(2)
    for seed in range(20):
        whole, point = long_decay(1e-2, seed)
        fit = in_the_band(fitted(whole, K, point))
        ends = [fit.interval(name) for name in ("F_k", "c")]
        held += [low < truth < high for (low, high), truth in zip(ends, point[:2], strict=True)]
    assert (held >= 15).all()
