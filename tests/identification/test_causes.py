"""Records in the wrong frame, of a wrong gain or unit, or on a contact that yields gradually: named, and the answer
freed of it or doubted. Motions on gradual contacts come from an integrator of its own (trials/blind/gradual.py)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from blind.decays import Decay
from blind.gradual import CONTACTS, ring_down_on, steady_on
from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
from dampbalance.findings.finding import Finding, within
from dampbalance.identification.causes import GRADUAL
from dampbalance.identification.forced import identify_readings
from dampbalance.model import Parameters
from dampbalance.motion.law_decays import ADDED, DECAY_UNKNOWNS, law_decay
from dampbalance.motion.law_steady import Further, steady_response
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.signals.mean_harmonics import read_features
from identification.gradual_contacts import OMEGA, contact_of, harmonics_on
from identification.levels import THREE, changed, measured
from paper_case import LEVELS, PAPER


def in_frame(channel, taken_for, hz=3.5, base="base_displacement"):
    """Readings of a channel of the mass that was taken for another."""
    records = measured(LEVELS[:3], hz, cycles=25.0, channels=(base, channel))
    return [read_features(changed(r, channel, quantity=taken_for), PAPER.k) for r in records]


@pytest.mark.parametrize(
    ("channel", "taken_for", "hz", "base"),
    [
        ("relative_displacement", "displacement", 3.5, "base_displacement"),
        ("velocity", "relative_velocity", 4.92, "base_displacement"),
        ("displacement", "displacement", 3.5, "base_displacement"),  # right
    ],
)
def test_a_motion_in_the_wrong_frame_is_named_and_the_answer_is_that_of_the_right_one(
    channel, taken_for, hz, base
):
    found = identify_readings(in_frame(channel, taken_for, hz, base), PAPER.k)
    said = [one.numbers["what"] for one in found.findings if one.numbers.get("clear")]
    frame = Finding("frame", {"absolute": not channel.startswith("relative")})
    assert said == [(frame,)] * (channel != taken_for)
    for symbol in ("F_k", "c"):
        assert found.values[symbol] == pytest.approx(getattr(PAPER, symbol), rel=0.02)
        assert found.verdicts[symbol].verdict == "usable"


def test_a_wrong_gain_is_said_with_its_size_and_what_only_a_calibration_tells():
    records, base, gain = measured(LEVELS, 3.5, cycles=40.0, noise=0.003), "base_displacement", 0.01
    records = [changed(r, base, values=(1.0 + gain) * r[base].values) for r in records]
    found = identify(records, PAPER.k)
    (said,) = (one for one in found.findings if one.numbers.get("clear"))
    assert [one.code for one in said.numbers["what"]] == ["gain"]
    for symbol in ("F_k", "c"):
        low, high = found.intervals[symbol]
        assert low < getattr(PAPER, symbol) < high
    # F_k is in proportion to the motion: whether drive or response is wrong, the records do not tell
    assert found.verdicts["F_k"].within > 0.9 * gain
    assert found.verdicts["c"].verdict == "usable"


STIFF = 2.0 * (2.0 * math.pi * 10.0) ** 2
RARE = {
    # k, c, F_k, f, levels, rate: Q = 220; eleven times the natural frequency; 150 g
    "Q": (Oscillator(2.0, 0.50, STIFF, 20.0 * STIFF, 0.05), 10.0, (2e-5, 4e-5, 6e-5), 1000.0),
    "fast": (Oscillator(2.0, 5.0, STIFF, 20.0 * STIFF, 0.5), 110.0, (2e-3, 4e-3, 6e-3), 2e4),
    "100 g": (
        Oscillator(0.05, 10.0, 1.26e6, 20.0 * 1.26e6, 0.1),
        *(800.0, (1e-6, 2e-6, 3e-6), 160e3),
    ),
}


@pytest.mark.parametrize(
    ("name", "noise", "factor"),
    [
        *(("Q", 1e-2, 1.0), ("fast", 1e-4, 1.0), ("100 g", 1e-2, 1.0)),
        *(("Q", 1e-3, 1000.0), ("fast", 1e-3, 1e-3)),
    ],
)
def test_the_unit_of_one_channel_is_asked_for_where_another_fits_and_not_of_a_rare_rig(
    name, noise, factor
):
    osc, hz, levels, rate = RARE[name]
    records, options = [], {"rate_hz": rate, "cycles": 40.0, "noise": noise}
    for i, Y in enumerate(levels):
        orbit = steady_orbit(osc, BaseMotion(Y, 2.0 * math.pi * hz))
        one = measured_orbit(orbit, channels=THREE[:2], seed=i, **options)
        x = factor * one["displacement"].values  # read in a unit that is so much smaller
        records.append(changed(one, "displacement", values=x))
    found = identify(records, osc.k)
    asked = {one.numbers["confused"] for one in found.findings if one.code == "unit"}
    if factor == 1.0:
        assert not asked
        assert found.verdicts["F_k"].verdict == "usable"
        assert found.values["F_k"] == pytest.approx(osc.F_k, rel=max(1e-4, 2.0 * noise))
    else:
        assert asked == {"mm taken for m"}
        assert {v.verdict for v in found.verdicts.values()} <= {"doubtful", "none"}


SOFT = replace(PAPER, K_z=20_000.0)


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


def test_a_contact_that_yields_gradually_is_named_and_its_K_z_is_that_after_a_reversal():
    """Records of displacements at five levels, 60 cycles of 100 samples."""
    random, records, contact = np.random.default_rng(1), [], CONTACTS["Iwan"](SOFT.K_z, SOFT.F_k)
    t = np.arange(6000) * (2.0 * math.pi / OMEGA / 100.2)
    for Y in LEVELS:
        motion = steady_on(contact, SOFT.m, SOFT.c, SOFT.k, Y, OMEGA)
        x = motion(np.mod(OMEGA * t, 2.0 * math.pi))[0]
        y = Y * np.cos(OMEGA * t)
        y, x = (of + 0.003 * of.std() * random.standard_normal(t.size) for of in (y, x))
        channels = [Channel("base_displacement", t, y), Channel("displacement", t, x)]
        records.append(Record.of(f"level {Y}", channels))
    found = identify_readings([read_features(one, SOFT.k) for one in records], SOFT.k)
    said = {one.code for of in found.findings for one in within(of.numbers.values())}
    assert "gradual" in said
    low, high = found.intervals["K_z"]
    assert low < SOFT.K_z < high
    assert {s for s, one in found.verdicts.items() if one.verdict != "usable"} == {"K_z"}
