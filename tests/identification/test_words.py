"""No sentence of an identification has words that slip out of a program, whatever the numbers in it are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import identify, measured_ring_down
from dampbalance.identification.screen import limiting
from dampbalance.law.contact import Sliders
from dampbalance.records.synthetic import stepped_sine
from identification.levels import changed, measured
from paper_case import PAPER
from slips import slips


def said(found):
    """Everything that an identification says, as one text, in which nothing slips out."""
    text = "\n".join([str(found), found.text(), found._repr_html_(), *limiting(found)])
    assert slips(text) == []
    return text


def altered(seconds=0.0, factor=1.0, loud=0.0, F_k=PAPER.F_k, **options):
    """Records whose displacement is later and larger, and whose first channel has a second harmonic, a part of its
    amplitude."""
    for record in measured(osc=replace(PAPER, F_k=F_k), **options):
        drive, x = (record[q] for q in record)
        wave = loud * np.abs(drive.values).max() * np.cos(14.0 * math.pi * drive.t)
        record = changed(record, drive.name, values=drive.values + wave)
        yield changed(record, x.name, t=x.t + seconds, values=factor * x.values)


@pytest.mark.parametrize(
    ("alteration", "words", "others"),
    [
        ({"seconds": -1753e-6}, "a response that leads the drive by 17", "lags the drive"),
        ({"seconds": 1753e-6}, "a response that lags the drive by 17", "leads the drive"),
        (
            {"loud": 0.2, "channels": ("force", "displacement")},
            "the force is not harmonic: 20 % distortion",
            "base motion",
        ),
        ({"factor": -1.0}, "", "e+"),
        ({"F_k": 5.0, "levels": (0.004, 0.005, 0.006)}, "", "e+"),
    ],
    ids=str,
)
def test_what_is_said_of_forced_records(alteration, words, others):
    text = said(identify([*altered(**alteration)], PAPER.k))
    assert words in text
    assert others not in text


def test_what_is_said_of_another_law_and_a_wrong_mass():
    said(identify([*altered(F_k=1e-9)], PAPER.k, terms=["F_k", "eta"], mass=1.0))


@pytest.mark.parametrize("F_k", [0.5, 1e-9])
def test_what_is_said_of_free_decays(F_k):
    osc = replace(PAPER, m=2.0, c=1.5, F_k=F_k)
    free = measured_ring_down(osc, x=0.02, rate_hz=500.0, duration=4.0, noise=0.01)
    said(identify(free, osc.k))


def test_what_is_said_of_a_stepped_sine():
    lines = stepped_sine(
        {"m": 2.0, "c": 6.0, "k": 180_000.0},
        Sliders(np.array([7e-5]), np.array([4.0])),
        amplitudes=(5e-5, 1e-4, 4e-4),
        frequencies_hz=np.linspace(46.0, 56.0, 6),
        noise=0.003,
        seed=1,
    )
    said(identify(lines))
