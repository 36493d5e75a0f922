"""Recordings as they are made: all levels in one file, from switching on, a sweep, an overload at a blow, in another
frame, of a wrong unit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify, measured_ring_down, transient
from dampbalance.findings.finding import Finding
from dampbalance.identification.forced import identify_readings
from dampbalance.signals.mean_harmonics import read_features
from identification.levels import THREE, changed, close, measured
from paper_case import PAPER

RATE = 2000.0
LEVELS = (0.003, 0.005, 0.008, 0.012)
ERRORS = 4.0  # standard errors: chance leaves one of three numbers outside in one seed of 5,000


def staircase(osc, hertz, levels, cycles, noise, rng):
    """Accelerations of the exact motion from rest under a base whose amplitude steps, with noise."""
    count, omega, parts = round(cycles / hertz * RATE), 2.0 * math.pi * hertz, []
    state = {"x": 0.0, "v": 0.0, "z": 0.0}
    for i, Y in enumerate(levels):
        t = 0.75 / hertz + np.arange(i * count, (i + 1) * count + 1) / RATE
        moved = transient(osc, BaseMotion(Y, omega), t[-1], start=t[0], **state).state(t)
        parts.append((-(omega**2) * Y * np.cos(omega * t[:-1]), moved.acceleration[:-1]))
        z = np.clip(moved.z[-1], -osc.Z_m, osc.Z_m)
        state = {"x": moved.x[-1], "v": moved.v[-1], "z": z}
    y, x = (of + noise * np.std(of) * rng.standard_normal(of.size) for of in np.hstack(parts))
    names = ("time_s", "base_acceleration_m_per_s2", "acceleration_m_per_s2")
    return dict(zip(names, (np.arange(y.size) / RATE, y, x), strict=True))


def right(found, osc, *, symbols=("F_k", "c", "K_z"), within):
    """Whether the numbers are usable, and the truth within their errors, which are a part of it at most."""
    for symbol in symbols:
        assert found.verdicts[symbol].verdict == "usable"
        assert found.standard_errors[symbol] < within / ERRORS * getattr(osc, symbol), symbol
    return close(found, osc, symbols, ERRORS)


def test_all_levels_in_one_file_are_split_at_the_steps():
    osc = replace(PAPER, c=20.0)
    found = identify(staircase(osc, 3.5, LEVELS, 25, 0.01, np.random.default_rng(0)), osc.k)
    assert right(found, osc, symbols=("F_k", "c"), within=0.02)
    assert abs(found.mass - osc.m) < ERRORS * found.mass_error
    assert found.sources == tuple(f"record 1 (level {i})" for i in (1, 2, 3, 4))
    assert [level.name for level in found.levels] == [*found.sources]


@pytest.mark.parametrize(("hertz", "seed"), [(5.0, 0), (5.37, 1)])
def test_what_is_said_to_settle_is_left_out_however_small_it_is(hertz, seed):
    osc, rng = (
        Oscillator(m=3.1, c=20.0, k=5200.0, K_z=160_000.0, F_k=2.1),
        np.random.default_rng(seed),
    )
    found = identify([staircase(osc, hertz, [Y], 95, 0.0005, rng) for Y in LEVELS], osc.k)
    assert not any(one.numbers.get("skip") for one in found.findings)
    assert found.basis.common.clear == ()
    assert right(found, osc, within=0.002)


def test_a_sweep_is_refused_with_the_remedy():
    t = np.arange(40_000) / 1000.0
    y = 0.005 * np.sin(2.0 * np.pi * (2.0 * t + 0.125 * t**2))
    swept = {"time_s": t, "base_displacement_m": y, "displacement_m": np.roll(1.2 * y, 20)}
    with pytest.raises(ValueError, match=r"record 1: the drive sweeps from .* to .* Hz.*dwell"):
        identify(swept, PAPER.k)


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


@pytest.mark.parametrize(
    ("channel", "taken_for", "hz"),
    [
        ("relative_displacement", "displacement", 3.5),
        ("velocity", "relative_velocity", 4.92),
    ],
)
def test_a_motion_in_the_wrong_frame_is_named_and_the_answer_is_that_of_the_right_one(
    channel, taken_for, hz
):
    records = measured(LEVELS[1:], hz, cycles=25.0, channels=(THREE[0], channel))
    read = [read_features(changed(r, channel, quantity=taken_for), PAPER.k) for r in records]
    found = identify_readings(read, PAPER.k)
    (said,) = (one.numbers["what"] for one in found.findings if one.numbers.get("clear"))
    assert said == (Finding("frame", {"absolute": taken_for == "relative_velocity"}),)
    for symbol in ("F_k", "c"):
        assert found.values[symbol] == pytest.approx(getattr(PAPER, symbol), rel=0.02)
        assert found.verdicts[symbol].verdict == "usable"


@pytest.mark.parametrize("factor", [1.0, 1000.0])
def test_the_unit_of_one_channel_is_asked_for_where_another_fits_and_not_of_a_rare_rig(factor):
    """The amplitudes of mass and base differ by a Q of 220, or by a unit in which the mass's was read."""
    k = 2.0 * (20.0 * math.pi) ** 2
    rare = Oscillator(m=2.0, c=0.5, k=k, K_z=20.0 * k, F_k=0.05)
    records = measured((2e-5, 4e-5, 6e-5), 10.0, rare, cycles=40.0)
    x = "displacement"
    found = identify([changed(r, x, values=factor * r[x].values) for r in records], k)
    asked = {one.numbers["confused"] for one in found.findings if one.code == "unit"}
    assert asked == ({"mm taken for m"} if factor > 1.0 else set())
    usable = found.verdicts["F_k"].verdict == "usable"
    assert usable == (factor == 1.0)
    # 1 % of noise
    assert found.values["F_k"] == pytest.approx(rare.F_k, rel=0.02) or not usable
