"""Departures of records that are read right: each is found with its size, and the oscillator behind it.

The channels are changed by formulas, the motions made by independent integrators (trials/blind/other_motion.py and,
where a contact yields gradually, gradual.py).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from blind.decays import Decay
from blind.gradual import CONTACTS, steady_on
from blind.other_motion import STEPS, Departure, ring_down_on, steady
from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.fit.multistart import Trail
from dampbalance.fit.nuisances import FALLING, FOLDED, NUISANCES, in_other_frame
from dampbalance.fit.steady_search import fit_records, refit
from dampbalance.fit.waveforms import HarmonicProblem
from dampbalance.identification.causes import GRADUAL, doubts_of
from dampbalance.identification.oscillator import common_fit
from dampbalance.law.law import Law
from dampbalance.model import Parameters
from dampbalance.motion.law_decays import ADDED, DECAY_UNKNOWNS, law_decay
from dampbalance.motion.law_steady import Further, steady_response
from paper_case import LEVELS, PAPER, orbits_at
from signals.harmonics import lines_of

NOISE = 1e-7  # m
HZ = 3.5
OMEGA = 2.0 * math.pi * HZ
SOFT = replace(PAPER, K_z=20_000.0)


def lines(change=lambda one: one, *, seed=1, osc=PAPER, levels=LEVELS):
    """Lines of an oscillator at several levels, each changed, with noise."""
    rng = np.random.default_rng(seed)
    for orbit in orbits_at(HZ, levels, osc):
        yield change(lines_of(orbit, NOISE, rng))


def filtered(response):
    """A change that passes the response through a filter of rates iω, 1/s."""
    return lambda one: replace(one, x=one.x * response(1j * one.n * one.omega))


def drawn(motion, osc, noise, seed=1):
    """Lines of a motion that is not the model's, with noise.   motion : gives harmonics 1, 3 … of a level."""
    rng = np.random.default_rng(seed)
    for orbit in orbits_at(HZ, LEVELS, osc):
        one = lines_of(orbit, noise)
        error = noise * (rng.standard_normal(one.n.size) + 1j * rng.standard_normal(one.n.size))
        yield replace(one, x=motion(one.Y, one.n) + error)


def harmonics_of(osc, Y, omega, departure, n):
    """x_n of a motion that is not the model's, by independent integration."""
    numbers = (osc.m, osc.c, osc.k, osc.K_z, osc.F_k, Y, omega)
    x = steady(numbers, departure)(np.arange(STEPS) * (2.0 * math.pi / STEPS))[0]
    return 2.0 * np.fft.rfft(x)[n] / STEPS


def integrated(departure, noise=5e-7):
    return drawn(lambda Y, n: harmonics_of(SOFT, Y, OMEGA, departure, n), SOFT, noise)


def mild_steps():
    """Levels whose friction grows by 3 % for each e-fold of the level."""
    mean = float(np.mean(np.log(LEVELS)))
    for i, Y in enumerate(LEVELS):
        osc = replace(PAPER, F_k=PAPER.F_k * (1.0 + 0.03 * (math.log(Y) - mean)))
        yield from lines(seed=i, osc=osc, levels=(Y,))


def contact_of(osc, part):
    """A Jenkins element and, in parallel, sliders of twice its stiffness, which have a part of the friction."""
    jenkins = np.array([((1.0 - part) * osc.K_z, (1.0 - part) * osc.F_k, 0.0)])
    if not part:
        return jenkins
    return np.vstack([jenkins, CONTACTS["Iwan"](2.0 * part * osc.K_z, part * osc.F_k)])


def harmonics_on(contact, osc, Y, count):
    """x_n, n = 1, 3 …, of the steady motion, by its independent integration."""
    motion = steady_on(contact, osc.m, osc.c, osc.k, Y, OMEGA)
    phases = np.arange(4096) * (2.0 * math.pi / 4096)
    return 2.0 * np.fft.rfft(motion(phases)[0])[1 : 2 * count : 2] / 4096


def gradual(part):
    """Lines of a contact of which a part yields gradually, by an integrator of sliders."""
    contact = contact_of(SOFT, part)
    return drawn(lambda Y, n: harmonics_on(contact, SOFT, Y, n.size), SOFT, 3e-8)


FASTEST = max(abs(orbit.harmonics(1)[0]) * OMEGA for orbit in orbits_at(HZ, LEVELS, SOFT))
LARGEST = max(orbit.X for orbit in orbits_at(HZ, LEVELS, SOFT))
CUBIC = 0.05 * PAPER.k / LARGEST**2  # the spring is 5 % stiffer at the largest peak
FALLS = Departure(falling=0.2, speed=FALLING * FASTEST)
CASES = {
    "delay": (3e-4, PAPER, lambda: lines(filtered(lambda s: np.exp(-3e-4 * s)))),
    "gain": (0.01, PAPER, lambda: lines(lambda one: replace(one, Y=1.01 * one.Y))),
    "corner": (0.1, PAPER, lambda: lines(filtered(lambda s: s / (s + 0.2 * math.pi)))),
    "friction_level": (0.03, PAPER, mild_steps),
    "friction_speed": (0.2, SOFT, lambda: integrated(FALLS)),
    "c_2": (20.0, SOFT, lambda: integrated(Departure(quadratic=20.0))),
    "gradual": (0.2, SOFT, lambda: gradual(0.2)),
    "k_3": (CUBIC, SOFT, lambda: integrated(Departure(cubic=CUBIC), 5e-6)),
    "frame": (None, PAPER, lambda: lines(lambda one: replace(one, x=one.x - one.Y * (one.n == 1)))),
}


@pytest.mark.parametrize("name", CASES)
def test_each_is_named_and_fitted_and_the_oscillator_behind_it_found(name):
    size, osc, made = CASES[name]
    whole = common_fit(list(made()), osc.k, frames=True)
    assert whole.clear == (name,)
    # after a reversal a contact that yields gradually is stiffer by that part
    stiffer = 1.0 + size if name == "gradual" else 1.0
    truth = {"F_k": osc.F_k, "c": osc.c, "K_z": stiffer * osc.K_z}
    for symbol, true in truth.items():
        low, high = whole.answer.intervals[symbol]
        assert low < true < high, symbol
    # a gain may be that of the response, or of a structure that moves along; K_z is what no fundamental tells
    doubts = doubts_of(whole.selection, name)
    assert [*doubts] == {"gain": ["F_k", "c"], "gradual": ["K_z"]}.get(name, [])
    assert all(off > 0.5 * size for off in doubts.values())
    if size is None:
        return
    fit = whole.selection.plain
    shown, freed = fit.departures[name], refit(fit, [name])
    assert abs(shown.size) > 4.0
    assert shown.value == pytest.approx(size, rel=0.2)
    assert fit.chi_square - freed.chi_square == pytest.approx(shown.size**2, rel=0.2)
    assert freed.adequate
    assert freed.freedom == fit.freedom - 1
    assert abs(freed.value(name) - size) < 4.0 * freed.error(name) < 0.8 * abs(size)
    truth |= {"m": osc.m, "rho": truth.pop("K_z") ** -0.5}
    for symbol, true in truth.items():
        # in a gain's record the amplitude of the base is the fit's own: everything follows it, by its error
        error = math.hypot(freed.error(symbol), 2.0 * true * freed.error("gain"))
        assert abs(freed.value(symbol) - true) < 4.0 * error, symbol
    assert name not in freed.departures


def test_neither_the_oscillator_nor_a_term_that_the_law_has_is_a_departure():
    whole = common_fit(list(lines()), PAPER.k, frames=True)
    assert whole.waveforms_hold
    assert whole.clear == ()
    shown = whole.selection.plain.departures
    assert set(shown) == set(NUISANCES) - {FOLDED}
    assert max(abs(one.size) for one in shown.values()) < 4.0
    quadratic = list(integrated(Departure(quadratic=20.0)))
    assert common_fit(quadratic, SOFT.k, law=Law(("F_k", "c", "c_2"))).clear == ()


# what would take a departure of a size that no rig has: below zero, or of a channel that was mistaken
IMPOSSIBLE = {
    "corner": lambda: lines(filtered(lambda s: s / (s - 0.4 * math.pi))),
    "friction_speed": lambda: integrated(Departure(falling=-0.2, speed=FALLING * FASTEST)),
    "delay": lambda: lines(filtered(lambda s: np.exp(-1.7 * s * 2.0 * math.pi / OMEGA))),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_no_cause_is_named_with_a_size_that_it_cannot_have(name):
    whole = common_fit(list(IMPOSSIBLE[name]()), PAPER.k)
    least, greatest = NUISANCES[name]
    values = [whole.closest.value(name)] if name in whole.clear else []
    unit = {"corner": HZ, "delay": 1.0 / OMEGA}.get(name, 1.0)
    assert all(least < value / unit < greatest for value in values)


@pytest.mark.parametrize(("size", "name"), [(1.0, "k_3"), (0.01, "k_3"), (1.0, "m")])
def test_errors_are_those_of_the_likelihood_whatever_the_size_of_the_motion(size, name):
    """One standard error away χ² is larger by one, a motion of millimetres or of a hundredth of that, in which k_3 has
    ten thousand times the number."""
    osc = replace(PAPER, F_k=size * PAPER.F_k)
    orbits = orbits_at(HZ, [size * Y for Y in LEVELS], osc)
    freed = refit(fit_records([lines_of(one, 5e-8 * size) for one in orbits], osc.k), ["k_3"])
    away = refit(freed, given={name: freed.value(name) + freed.error(name)})
    assert away.chi_square - freed.chi_square == pytest.approx(1.0, abs=0.01)


def test_the_gain_of_a_drive_is_also_that_of_what_is_added_to_a_relative_motion():
    gain = -0.01

    def change(one):
        x = one.x + gain * one.Y * (one.n == 1)
        return replace(one, Y=(1.0 + gain) * one.Y, x=x, of_base=1.0)

    freed = refit(fit_records(list(lines(change, seed=3)), PAPER.k), ["gain"])
    assert abs(freed.value("gain") - gain) < 4.0 * freed.error("gain") < 0.5 * abs(gain)
    assert freed.adequate


def test_the_other_frame_is_left_as_it_was_entered():
    (orbit,) = orbits_at(HZ, (0.004,))
    one = replace(lines_of(orbit, NOISE), base=np.array([0.0, 1e-5 + 2e-5j]))
    other = in_other_frame(one)
    assert other.of_base == 1.0
    assert other.x[0] == one.x[0] + one.Y
    assert other.x[1] == one.x[1] + one.base[1]
    assert np.abs(in_other_frame(other).x - one.x).max() < 1e-15 * one.Y


def test_the_harmonics_of_the_base_read_too_large_are_so_in_the_model():
    """A drive that reads 1 % too much does so at all its harmonics, and the motion is that of the true base."""
    osc, base = Oscillator(2.42, 20.0, 2310.0, 20_000.0, 3.0), 0.05
    one = lines_of(steady_orbit(osc, BaseMotion(0.004, 70.0)), 4e-8, count=8)
    x = harmonics_of(osc, one.Y, 70.0, Departure(third=base), one.n)
    Y = 1.01 * one.Y
    read = replace(one, x=x, Y=Y, base=base * Y * np.array([0.0, 1.0 + 0j]))
    problem = HarmonicProblem(Law(), (read,), osc.k)
    values = {"F_k": osc.F_k, "c": osc.c, "rho": osc.K_z**-0.5, "m": osc.m, "gain": 0.01}
    point = problem.parameters.moved(**values, **{"Y[1]": one.Y})

    def chi_square(at):
        residual = problem.evaluate(at.values, at.free, Trail())[:, -1]
        return residual @ residual

    # the integrator's error is a tenth of the noise stated
    assert chi_square(point) < 0.1
    assert chi_square(point.moved(gain=0.0)) > 1e3


@pytest.mark.parametrize(("osc", "part"), [(PAPER, 0.1), (SOFT, 1.0)], ids=["stiff", "soft"])
def test_the_steady_motion_on_a_contact_that_yields_gradually_is_that_of_an_integrator(osc, part):
    Y = LEVELS[2]
    expected, at_once = (harmonics_on(contact_of(osc, p), osc, Y, 6) for p in (part, 0.0))
    motion = BaseMotion(Y, OMEGA)
    found = steady_response(osc, motion, {}, further=Further(gradual=part)).harmonics(6)
    # 16 sliders stand for the continuum, and 2048 steps of a period locate their kinks
    assert np.abs(found - expected).max() < 0.03 * np.abs(expected - at_once).max()


def ring_down(contact, osc, x, lasts):
    """Samples of a release from x, 500 a second, by independent integration."""
    truth = Decay(0, osc.m, osc.c, osc.k, osc.K_z, osc.F_k, *[()] * 4, 0.0, (), 0.0, 0.0)
    return ring_down_on(contact, truth, x, 0.0, contact[:, 1].copy(), 0.002, lasts)[0]


def test_a_gradual_part_of_the_contact_moves_a_decay_as_an_integrator_finds():
    osc = Oscillator(m=2.42, c=3.0, k=2310.0, K_z=20_000.0, F_k=1.28)
    # as long as it slips in each half cycle: in the last, of part of the corner, the direction is only roughly right
    x, part = 0.02, 1e-3
    at_once, gradual = (ring_down(contact_of(osc, p), osc, x, 1.2) for p in (0.0, part))
    par = Parameters(osc.m, osc.c, osc.k, osc.K_z, osc.F_k, 0.0, 0.0)
    t, none = 0.002 * np.arange(at_once.size), np.empty((0, 5))
    state = (x, 0.0, 2.0)
    count = len(DECAY_UNKNOWNS)
    whole = law_decay(t, 0, *state, par, np.zeros(len(ADDED)), count, 0.0, 1.0, none)
    assert whole[:, 0] == pytest.approx(at_once, abs=1e-5 * x)
    expected = (gradual - at_once) / part
    found = whole[:, 1 + DECAY_UNKNOWNS.index(GRADUAL)]
    assert found == pytest.approx(expected, abs=0.03 * np.abs(expected).max())
