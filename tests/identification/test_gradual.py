"""A contact that yields gradually is named where the records show it, and stated where they cannot; it is not seen in a
contact that yields at once. The motions come from an integrator of its own (trials/blind/gradual.py)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from blind.decays import Decay
from blind.gradual import CONTACTS, ring_down_on, steady_on
from dampbalance import BaseMotion, Oscillator
from dampbalance.findings.finding import within
from dampbalance.identification.causes import GRADUAL, doubts_of
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import common_fit
from dampbalance.model import Parameters
from dampbalance.motion.law_decays import ADDED, DECAY_UNKNOWNS, law_decay
from dampbalance.motion.law_steady import Further, steady_response
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.signals.record_harmonics import RecordHarmonics
from identification.gradual_contacts import OMEGA, contact_of, harmonics_on
from paper_case import LEVELS, PAPER

SOFT = replace(PAPER, K_z=20_000.0)
NOISE = {"two sliders": 0.002, "Dahl": 0.01}
HIGHEST = 2 * 14  # harmonics of a record that a fit takes


def lines_of(clean, noise, random):
    """Harmonics with the noise that 100 cycles of 100 samples leave of them."""
    lines = []
    for Y, x in clean:
        sizes = [noise * part * math.sqrt(0.5) * math.sqrt(2.0 / 10_000) for part in (Y, abs(x[0]))]
        drawn = random.standard_normal((2, x.size)) * sizes[1]
        n = np.arange(1, 2 * x.size, 2)
        read = (Y + sizes[0] * random.standard_normal(), sizes[0], n, x + drawn[0] + 1j * drawn[1])
        lines.append(RecordHarmonics(OMEGA, *read, np.full(n.size, sizes[1]), 100))
    return lines


def shown(lines, osc):
    """The fit of a contact that yields at once, the gradual one to first order, and what explains the records."""
    fit = common_fit(lines, osc.k, departures=False).fit
    return fit, fit.departures[GRADUAL], common_fit(lines, osc.k)


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


@pytest.mark.parametrize("kind", NOISE)
def test_a_soft_contact_that_yields_gradually_is_named(kind):
    contact = CONTACTS[kind](SOFT.K_z, SOFT.F_k)
    clean = [(Y, harmonics_on(contact, SOFT, Y, HIGHEST // 2)) for Y in LEVELS]
    fit, gradual, whole = shown(lines_of(clean, NOISE[kind], np.random.default_rng(3)), SOFT)
    assert gradual.size > 3.0
    # χ² does not notice what the test of one direction does
    assert fit.adequate
    assert whole.selection.weight(GRADUAL) > 0.5
    # K_z is too small by many standard errors, and known to be
    assert fit.K_z < 0.9 * SOFT.K_z
    assert doubts_of(whole.selection, GRADUAL)["K_z"] > 0.1


def records_on(osc, kind, noise, seed):
    """Records of displacements at five levels, 60 cycles of 100 samples."""
    random, records = np.random.default_rng(seed), []
    for Y in LEVELS:
        motion = steady_on(CONTACTS[kind](osc.K_z, osc.F_k), osc.m, osc.c, osc.k, Y, OMEGA)
        t = np.arange(6000) * (2.0 * math.pi / OMEGA / 100.2)
        x = motion(np.mod(OMEGA * t, 2.0 * math.pi))[0]
        channels = [
            Channel(name, t, values + noise * values.std() * random.standard_normal(t.size))
            for name, values in (("base_displacement", Y * np.cos(OMEGA * t)), ("displacement", x))
        ]
        records.append(Record.of(f"level {Y}", channels))
    return records


def said_of(records, k):
    found = identify_readings([read_features(one, k) for one in records], k)
    inner = {one.code for of in found.findings for one in within(of.numbers.values())}
    return found, "gradual" in inner


def test_where_it_shows_K_z_alone_is_doubtful_and_that_after_a_reversal():
    found, shown = said_of(records_on(SOFT, "Iwan", 0.003, 1), SOFT.k)
    assert shown
    low, high = found.intervals["K_z"]
    assert low < SOFT.K_z < high
    assert {s for s, one in found.verdicts.items() if one.verdict != "usable"} == {"K_z"}
