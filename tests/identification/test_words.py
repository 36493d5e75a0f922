"""No sentence of an identification has words that slip out of a program, whatever the numbers in it are."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify, measured_ring_down, steady_orbit
from dampbalance.identification.screen import limiting
from dampbalance.law.contact import Sliders
from dampbalance.records.synthetic import measured_orbit, stepped_sine
from identification.levels import changed, measured
from paper_case import PAPER
from slips import slips

FORCED = ("force", "displacement")


def texts_of(found):
    """Everything that an identification says, as one text."""
    return "\n".join(
        [
            str(found),
            found.text(),
            found._repr_html_(),
            *limiting(found),
        ]
    )


def late(record, seconds):
    """The record with a displacement that is so much later."""
    channel = record["displacement"]
    return changed(record, "displacement", t=channel.t + seconds)


def loud(record, part):
    """The record with a force that has a second harmonic, a part of its amplitude."""
    channel = record["force"]
    values, omega = channel.values, 2.0 * math.pi * 3.5
    wave = part * np.abs(values).max() * np.cos(2.0 * omega * channel.t)
    return changed(record, "force", values=values + wave)


def turned(record):
    return changed(record, "displacement", values=-record["displacement"].values)


def larger(record, factor):
    return changed(record, "displacement", values=factor * record["displacement"].values)


def slippery(F_k, Y=(0.004, 0.008, 0.012)):
    osc = replace(PAPER, F_k=F_k)
    motions = [BaseMotion(Y=y, omega=2.0 * math.pi * 3.5) for y in Y]
    return [
        measured_orbit(steady_orbit(osc, motion), rate_hz=1000.0, cycles=20.0, noise=0.01, seed=i)
        for i, motion in enumerate(motions)
    ]


RECORDS = {
    "as they are": lambda: measured(),
    "leading": lambda: [late(one, -1753e-6) for one in measured()],
    "lagging": lambda: [late(one, 1753e-6) for one in measured()],
    "a loud force": lambda: [loud(one, 0.2) for one in measured(channels=FORCED)],
    "a louder force": lambda: [loud(one, 0.9) for one in measured(channels=FORCED)],
    "a turned sign": lambda: [turned(one) for one in measured()],
    "a wrong gain": lambda: [larger(one, 1.5) for one in measured()],
    "a wrong unit": lambda: [larger(one, 1e3) for one in measured()],
    "nearly no friction": lambda: slippery(1e-9),
    "little friction": lambda: slippery(1e-2),
    "nothing but friction": lambda: slippery(5.0, (0.004, 0.005, 0.006)),
}


@cache
def identified(name):
    return identify(RECORDS[name](), PAPER.k)


@pytest.mark.parametrize("name", RECORDS)
def test_what_is_said_of_forced_records(name):
    assert slips(texts_of(identified(name))) == []


@pytest.mark.parametrize("name", ["as they are", "nearly no friction"])
def test_what_is_said_of_another_law_and_a_wrong_mass(name):
    found = identify(RECORDS[name](), PAPER.k, terms=["F_k", "eta"], mass=1.0)
    assert slips(texts_of(found)) == []


def test_a_response_that_leads_is_said_to_lead():
    for name, word, other in (("leading", "leads", "lags"), ("lagging", "lags", "leads")):
        text = identified(name).text()
        assert f"a response that {word} the drive by 17" in text
        assert f"a response that {other} the drive" not in text


def test_a_force_that_is_not_harmonic_is_no_base_motion():
    text = identified("a loud force").text()
    assert "the force is not harmonic: 20 % distortion" in text
    assert "base motion" not in text


DECAYING = Oscillator(m=2.0, c=1.5, k=2310.0, K_z=208_000.0, F_k=0.5)


@pytest.fixture(scope="module", params=[0.5, 0.01, 1e-9])
def decay(request):
    osc = replace(DECAYING, F_k=request.param)
    return identify(measured_ring_down(osc, x=0.02, rate_hz=500.0, duration=4.0, noise=0.01), osc.k)


def test_what_is_said_of_free_decays(decay):
    assert slips(texts_of(decay)) == []


def test_what_is_said_of_a_stepped_sine():
    oscillator = {"m": 2.0, "c": 6.0, "k": 180_000.0}
    for sliders in (
        Sliders(np.array([7e-5]), np.array([4e4])),
        Sliders(np.array([7e-5]), np.array([4.0])),
    ):
        lines = stepped_sine(
            oscillator,
            sliders,
            amplitudes=(5e-5, 1e-4, 4e-4),
            frequencies_hz=np.linspace(46.0, 56.0, 6),
            noise=0.003,
            seed=1,
        )
        assert slips(texts_of(identify(lines))) == []
