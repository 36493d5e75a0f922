"""Causes of a misfit: the one that is in the records is named, and none where there is none."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion
from dampbalance.identification.causes import departures, words_of
from dampbalance.identification.causes import likeliest as likeliest_of
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import joint_fit
from dampbalance.law.law import Law
from dampbalance.law.response import law_orbit
from dampbalance.likelihood.mean_harmonics import Reading, read_features
from paper_case import LEVELS, PAPER, orbits_at
from unit.identification.levels import changed, measured, read


def likeliest(fit):
    return likeliest_of(fit, departures(fit))


def readings(osc=PAPER, levels=LEVELS, hz=3.5, **options):
    return read(orbits_at(hz, levels, osc), **options)


def in_frame(channel, taken_for, hz=3.5, base="base_displacement"):
    """Readings of a channel of the mass that was taken for another."""
    records = measured(LEVELS[:3], hz, cycles=25.0, channels=(base, channel))
    return [read_features(changed(r, channel, quantity=taken_for), PAPER.k) for r in records]


def of_unequal_friction():
    """Levels whose friction forces rise by 4 % from one to the next."""
    forces = (1.18, 1.23, 1.28, 1.33, 1.38)
    pairs = [(replace(PAPER, F_k=F_k), Y) for F_k, Y in zip(forces, LEVELS, strict=True)]
    return [readings(osc, (Y,), seed=i)[0] for i, (osc, Y) in enumerate(pairs)]


def behind(response, seed=1):
    """Readings of a response channel that multiplies harmonics by a function of their frequencies, rad/s."""
    of_records = (one.steady for one in readings(noise=0.001, seed=seed))
    return [
        Reading(replace(one, X=one.X * response(one.omega * np.arange(one.X.shape[1]))))
        for one in of_records
    ]


@pytest.mark.parametrize(
    ("made", "cause"),
    [
        (of_unequal_friction, "a friction force that changes with the level"),
        (lambda: behind(lambda w: np.exp(-2e-3j * w)), "a delay between the channels"),
        # a single pole at 0.1 rad/s
        (lambda: behind(lambda w: w / (w - 0.1j * (w > 0) - 1e-9j)), "an AC coupling"),
    ],
)
def test_the_cause_in_the_records_is_the_likeliest(made, cause):
    fit = joint_fit([one.lines for one in made()], PAPER.k).fit
    found = likeliest(fit)
    assert words_of(found).startswith(cause)
    # it explains most of what noise does not
    assert found.size**2 > 0.3 * (fit.chi_square - fit.freedom)


def test_a_term_that_the_law_lacks_is_named_as_damping():
    """Quadratic damping, fitted by a linear damper; with the right law nothing is left to explain."""
    bare, motions = replace(PAPER, c=15.0), [BaseMotion(Y, 2.0 * math.pi * 3.5) for Y in LEVELS]
    lines = [one.lines for one in read([law_orbit(bare, y, {"c_2": 150.0}) for y in motions])]
    assert words_of(likeliest(joint_fit(lines, PAPER.k).fit)).startswith("damping that grows")
    assert likeliest(joint_fit(lines, PAPER.k, law=Law(("F_k", "c", "c_2"))).fit) is None


@pytest.mark.parametrize(
    ("channel", "taken_for", "hz", "base"),
    [
        ("relative_displacement", "displacement", 3.5, "base_displacement"),
        ("relative_displacement", "displacement", 4.92, "base_acceleration"),
        ("relative_acceleration", "acceleration", 3.5, "base_acceleration"),
        ("displacement", "relative_displacement", 3.5, "base_displacement"),
        ("velocity", "relative_velocity", 4.92, "base_displacement"),
    ],
)
def test_a_motion_in_the_wrong_frame_is_named(channel, taken_for, hz, base):
    answer = identify_readings(in_frame(channel, taken_for, hz, base), PAPER.k, replicates=20)
    said = next(w for w in answer.warnings if "was taken for" in w)
    assert f"name it {channel} in the mapping" in said
    assert ("added to" in said) == channel.startswith("relative")
    numbers = {key: float(value) for key, value in re.findall(r"(F_k|c|m) = ([\d.]+)", said)}
    assert numbers == pytest.approx({"F_k": PAPER.F_k, "c": PAPER.c, "m": PAPER.m}, rel=0.02)
    assert not any("likeliest of the causes" in w for w in answer.warnings)


@pytest.mark.parametrize("channel", ["displacement", "relative_displacement"])
def test_a_motion_in_its_own_frame_is_not_doubted(channel):
    answer = identify_readings(in_frame(channel, channel), PAPER.k, replicates=20)
    assert not any("taken for" in w for w in answer.warnings)
    assert answer.approaches["direct"].verdicts["F_k"].verdict == "usable"


@pytest.mark.parametrize("seed", range(4))
def test_records_of_the_oscillator_show_no_cause(seed):
    """By chance one in 200 sets shows one."""
    fit = joint_fit([one.lines for one in readings(seed=seed)], PAPER.k).fit
    assert fit.adequate
    assert likeliest(fit) is None


def test_the_report_names_it_first_and_what_it_changes_is_doubtful():
    found = identify_readings(of_unequal_friction(), PAPER.k, replicates=20)
    warning = next(w for w in found.warnings if "a friction force that changes with the level" in w)
    assert warning.index("the likeliest of the causes") < warning.index("a channel may be skewed")
    verdicts = {v.verdict for a in found.approaches.values() for v in a.verdicts.values()}
    assert verdicts <= {"doubtful", "none"}
