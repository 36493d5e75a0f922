"""Rows of the half cycles of free decays, against closed forms and records of an independent integrator."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from blind.decays import clean, record
from dampbalance.fit.decay import Decay
from dampbalance.identification.answer import Interval
from dampbalance.identification.balance_check import compared
from dampbalance.identification.decays import balanced, identify_decay_records
from dampbalance.identification.half_cycles import rows_of, swings_of
from dampbalance.signals.bursts import Signal
from identification.releases import PLUCKED

M, C, K, F_K, START = 2.0, 0.5, 800.0, 0.15, 5e-3
DELTA, OMEGA = 0.5 * C / M, math.sqrt(K / M - (0.5 * C / M) ** 2)
HALF = math.pi / OMEGA  # between two turns, s
QUANTITIES = ("displacement", "velocity", "acceleration")


def friction_decay(t: np.ndarray, halves: int) -> tuple[np.ndarray, np.ndarray]:
    """(x, ẋ, ẍ), (3, n), of a mass under viscous damping and rigid friction, and its turns: from each on it follows
    ±F_k/k + A e^{−δτ}(cos ωτ + (δ/ω) sin ωτ) for half a cycle."""
    turns, motion = [START], np.zeros((3, t.size))
    for n in range(halves):
        # the force of friction points from where it goes to
        rest = math.copysign(F_K / K, turns[-1])
        A = turns[-1] - rest
        now = (t >= n * HALF) & (t < (n + 1) * HALF)
        tau = t[now] - n * HALF
        decay, sine, cosine = np.exp(-DELTA * tau), np.sin(OMEGA * tau), np.cos(OMEGA * tau)
        motion[0, now] = rest + A * decay * (cosine + DELTA / OMEGA * sine)
        motion[1, now] = -A * K / M / OMEGA * decay * sine
        motion[2, now] = -A * K / M * decay * (cosine - DELTA / OMEGA * sine)
        turns.append(rest - A * math.exp(-DELTA * HALF))
    return motion, np.array(turns)


def rows_at(par, one, F_k=0.1):
    """Rows of a decay with a fit that is given by hand: its friction force; the decay ends with its samples."""
    fit = SimpleNamespace(
        k=par.k,
        at_once=par.K_z,
        decays=[one],
        value={one.key("F_k"): F_k}.__getitem__,
        at_rest=lambda _: math.inf,
        problem=SimpleNamespace(pendulum=False),
    )
    return rows_of(fit)


def noisy(par, motion, order, seed, start):
    """A decay of PLUCKED with noise, as fits hold it."""
    values = motion[order]
    sigma = par.noise * np.abs(values).max()
    values = values + sigma * np.random.default_rng((seed, order)).standard_normal(values.size)
    t = np.arange(values.size) / par.rate_hz
    signal = Signal(QUANTITIES[order], order, t, values, sigma).between(start, t[-1])
    return Decay("", start, float(t[-1]), (signal,), 2.0 * math.pi / par.omega_n)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_swings_of_an_exact_motion_are_those_of_the_closed_form(order):
    rate, halves = 200 / (2.0 * HALF), 10
    t = np.arange(0.0, halves * HALF, 1.0 / rate)
    motion, turns = friction_decay(t, halves)
    # an offset is none of the motion
    values = motion[order] + 0.2 * np.abs(motion[order]).max()
    found = swings_of(Signal(QUANTITIES[order], order, t, values, 1e-9), 2.0 * HALF, 0.0)
    n = found.D.size
    assert n >= 6
    first = round(found.turns[0, 0] / HALF)
    # sums over 100 samples a cycle, smoothed over a twelfth of it; an acceleration jumps by 2F_k/m between two samples,
    # which a velocity takes for half a step more or less of it, and a swing for as long as it lasts
    size = 1e-3 * START if order < 2 else F_K / M / rate * HALF
    times = HALF * (first + np.arange(n + 1))
    # smoothing rounds off the change of the force where the mass turns, the more it is of the force there
    assert found.turns[:, 0] == pytest.approx(times, abs=5e-3 * HALF)
    turns = turns[first : first + n + 1]
    np.testing.assert_allclose(found.D, np.abs(np.diff(turns)), rtol=0.0, atol=size)
    # the rest position is not measured: the means of turns to both sides determine it
    assert found.turns[:, 1] == pytest.approx(turns, abs=size)
    # ∫ ẋ² dt = A² K²/M² /ω² ∫ e^{−2δτ} sin² ωτ dτ
    decayed = 1.0 - math.exp(-2.0 * DELTA * HALF)
    shape = decayed * (K / M / OMEGA) ** 2 * (1.0 / DELTA - DELTA * M / K) / 4.0
    exact = shape * (np.abs(turns[:-1]) - F_K / K) ** 2
    assert found.b == pytest.approx(exact, abs=2.0 * size / START * exact[0])


def test_noise_does_not_lengthen_the_integral_of_the_square():
    """The noise of a velocity adds its variance times half a cycle, unless that is taken off."""
    t, random = np.arange(0.0, 10 * HALF, HALF / 50), np.random.default_rng(4)
    motion, _ = friction_decay(t, 10)
    sigma = 0.05 * np.abs(motion[0]).max()

    def fourth(values):
        return swings_of(Signal("displacement", 0, t, values, sigma), 2.0 * HALF, 0.0).b[3]

    exact = fourth(motion[0])
    off = [fourth(motion[0] + sigma * random.standard_normal(t.size)) - exact for _ in range(60)]
    error = np.std(off) / math.sqrt(60)
    # the derivative of a polynomial of degree 4 over 8 samples on either side, a twelfth of 100
    derivative = np.linalg.pinv(np.vander(np.arange(-8.0, 9.0), 5, increasing=True))[1]
    added = sigma**2 * np.sum(derivative**2) * (50 / HALF) ** 2 * HALF
    assert added > 8.0 * error
    assert abs(np.mean(off)) < 3.0 * error


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_balance_contradicts_a_fit_that_is_wrong_and_holds_the_truth(order):
    """60 records of an independent integrator. In the fit F_k is 20 % too small and c makes up for it in the loss."""
    par = replace(PLUCKED, noise=0.003)
    motion, (start,) = clean(par)
    v = motion[1]
    loss = par.F_k * np.abs(v).sum(), par.c * np.square(v).sum()
    wrong = np.array([0.8 * par.F_k, par.c * (1.0 + 0.2 * loss[0] / loss[1])])
    truth, scores, apart, misfits = np.array([par.F_k, par.c]), [], [], []
    for seed in range(60):
        of = balanced(rows_at(par, noisy(par, motion, order, seed, start), wrong[0]))
        found, errors = np.array([*of.values.values()]), np.sqrt(np.diag(of.covariance))
        scores.append((found - truth) / errors)
        apart.append((found - wrong) / errors)
        misfits.append(of.misfit)
    # of 120 numbers, in 60 pairs that are nearly one each: 95 % ± 6 %, and 1 % for the stick of the wrong fit
    within = np.mean(np.abs(scores) < 1.96, axis=0)
    assert (within > 0.88).all(), within
    assert np.sqrt(np.mean(np.square(scores), axis=0)) == pytest.approx([1.0, 1.0], abs=0.3)
    # one in 16,000 of normal errors of a right fit
    assert np.mean(np.abs(apart) > 4.0) > 0.9
    assert np.mean(misfits) == pytest.approx(1.0, abs=0.35)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_turns_are_within_their_standard_errors(order):
    motion, (start,) = clean(PLUCKED)
    x, v, _ = motion
    zeros = np.flatnonzero(v[:-1] * v[1:] < 0.0)
    zeros = zeros[zeros / PLUCKED.rate_hz > start + 0.01]
    scores = []
    for seed in range(40):
        rows = rows_at(PLUCKED, noisy(PLUCKED, motion, order, seed, start))
        ((turns, errors),) = rows.turns
        here = zeros[: len(turns)]
        assert turns[:, 0] == pytest.approx(here / PLUCKED.rate_hz, abs=0.02)
        scores.append(((turns[:, 1] - x[here]) / errors)[:4])
    # 40 records with four turns each
    assert np.sqrt(np.mean(np.square(scores))) == pytest.approx(1.0, abs=0.25)


def test_samples_that_show_no_swing_clearly_give_no_row():
    par = replace(PLUCKED, noise=0.3, rate_hz=60.0)
    motion, (start,) = clean(par)
    rows = rows_at(par, noisy(par, motion, 2, 0, start))
    assert rows.halves == len(rows.decay) == rows.free == 0
    assert balanced(rows).values == {}


def test_a_difference_is_told_relative_to_both_errors_and_contradicts_beyond_them():
    measured, _ = record(replace(PLUCKED, noise=0.001))
    answer = identify_decay_records([measured], PLUCKED.k).estimates["balance"]
    F_k, c = answer.values["F_k"], answer.values["c"]

    def against(part, *lacks):
        """What is said of an answer that hardly has an error, and what contradicts it."""
        values = {"F_k": part * F_k, "c": c}
        ends = {s: Interval((1.0 - 1e-6) * v, (1.0 + 1e-6) * v) for s, v in values.items()}
        return compared(answer, SimpleNamespace(values=values, intervals=ends), lacks)

    within = 1.0 - 0.9 * answer.parameters["F_k"].within
    check, doubts = against(within)
    assert (check.numbers["times"], doubts) == (0.0, [])
    changes = {symbol: off for symbol, _, off in check.numbers["changes"]}
    assert changes["F_k"] == pytest.approx((1.0 - within) * F_k)
    check, (found,) = against(0.8)
    # of the two errors that of the answer is 1e-6
    assert check.numbers["times"] == pytest.approx(0.2 / answer.parameters["F_k"].within, rel=1e-2)
    assert found.numbers["changes"] == (("F_k", 0.8 * F_k, pytest.approx(0.2 * F_k)),)
    assert found.effect == {"F_k": pytest.approx(0.25)}
    # rows that lack what the fit has contradict nothing, and no number is shown
    check, doubts = against(0.8, "corner")
    assert (check.code, doubts, check.numbers["lacks"]) == ("no check", [], ("corner",))
    assert against(within, "corner")[0].code == "check"
