"""Recordings as they are made: all levels in one file, from switching on, a sweep, an overload at a blow."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify, measured_ring_down, transient
from identification.levels import close
from paper_case import PAPER

OSC = replace(PAPER, c=20.0)
HERTZ, RATE = 3.5, 1000.0
LEVELS = (0.003, 0.005, 0.008, 0.012)
ERRORS = 4.0  # standard errors: chance leaves one of three numbers outside in one seed of 5,000


def staircase(levels, cycles, noise=0.01, seed=0):
    """The exact motion from rest under a base whose amplitude steps, with noise."""
    count, omega, parts = round(cycles / HERTZ * RATE), 2.0 * math.pi * HERTZ, []
    state = {"x": 0.0, "v": 0.0, "z": 0.0}
    for i, Y in enumerate(levels):
        t = 0.75 / HERTZ + np.arange(i * count, (i + 1) * count + 1) / RATE
        moved = transient(OSC, BaseMotion(Y, omega), t[-1], start=t[0], **state).state(t)
        parts.append((Y * np.cos(omega * t[:-1]), moved.x[:-1]))
        z = np.clip(moved.z[-1], -OSC.Z_m, OSC.Z_m)
        state = {"x": moved.x[-1], "v": moved.v[-1], "z": z}
    rng = np.random.default_rng(seed)
    y, x = (of + noise * np.std(of) * rng.standard_normal(of.size) for of in np.hstack(parts))
    return {"time_s": np.arange(y.size) / RATE, "base_displacement_m": y, "displacement_m": x}


def right(found, osc, *, symbols=("F_k", "c", "K_z"), within):
    """Whether the numbers are usable, and the truth within their errors, which are a part of it at most."""
    for symbol in symbols:
        assert found.verdicts[symbol].verdict == "usable"
        assert found.standard_errors[symbol] < within / ERRORS * getattr(osc, symbol), symbol
    return close(found, osc, symbols, ERRORS)


def test_all_levels_in_one_file_are_split_at_the_steps():
    found = identify(staircase(LEVELS, 25), OSC.k)
    assert right(found, OSC, symbols=("F_k", "c"), within=0.02)
    assert abs(found.mass - OSC.m) < ERRORS * found.mass_error
    assert found.sources == tuple(f"record 1 (level {i})" for i in (1, 2, 3, 4))
    assert [level.name for level in found.levels] == [*found.sources]


def switched_on(osc, hertz, noise, cycles, seed):
    """Accelerations under four levels of the base from rest on, exact but for noise."""
    rng, omega = np.random.default_rng(seed), 2.0 * math.pi * hertz
    t, begin = np.arange(round(cycles / hertz * 2000.0)) / 2000.0, 0.75 / hertz
    for Y in LEVELS:
        end = float(t[-1]) + begin + 0.01
        x = transient(osc, BaseMotion(Y, omega), end, start=begin).state(t + begin).acceleration
        y = -(omega**2) * Y * np.cos(omega * (t + begin))
        x, y = (of + noise * np.std(of) * rng.standard_normal(of.size) for of in (x, y))
        yield {"time_s": t, "base_acceleration_m_per_s2": y, "acceleration_m_per_s2": x}


@pytest.mark.parametrize(("hertz", "seed"), [(5.0, 0), (5.37, 1)])
def test_what_is_said_to_settle_is_left_out_however_small_it_is(hertz, seed):
    osc = Oscillator(m=3.1, c=20.0, k=5200.0, K_z=160_000.0, F_k=2.1)
    found = identify([*switched_on(osc, hertz, 0.0005, 95, seed)], osc.k)
    assert not any(one.numbers.get("skip") for one in found.findings)
    assert found.basis.common.clear == ()
    assert right(found, osc, within=0.002)


def test_a_sweep_is_refused_with_the_remedy():
    t = np.arange(40_000) / 1000.0
    y = 0.005 * np.sin(2.0 * np.pi * (2.0 * t + 0.125 * t**2))
    swept = {"time_s": t, "base_displacement_m": y, "displacement_m": np.roll(1.2 * y, 20)}
    with pytest.raises(ValueError, match=r"record 1: the drive sweeps from .* to .* Hz.*dwell"):
        identify(swept, OSC.k)


@pytest.mark.parametrize("recovers", [0.0, 0.5])
def test_an_overload_at_a_blow_is_left_out(recovers):
    osc = replace(PAPER, c=9.0)
    options = {"rate_hz": 2000.0, "duration": 3.0, "noise": 0.003, "channels": "acceleration"}
    a = measured_ring_down(osc, v=0.8, **options)["acceleration"]
    values, top = a.values.copy(), 1.1 * float(np.abs(a.values).max())
    struck = int(np.argmax(np.abs(values) > 0.3 * top))
    values[max(0, struck - 6) : struck + 2] = top  # the range of the amplifier
    values[struck + 2 : struck + 42] += recovers * top * np.exp(-np.arange(40.0) / 12.0)
    found = identify({"time_s": a.t, "acceleration_m_per_s2": values}, osc.k)
    # a contact that yields gradually stays possible, as without the overload: 0.7 % of K_z
    assert right(found, osc, within=0.03)
