"""Causes of a misfit: the one that is in the records is named, and none where there is none."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from analytic.law_response import law_orbit
from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
from dampbalance.identification.causes import departures, words_of
from dampbalance.identification.causes import likeliest as likeliest_of
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import joint_fit
from dampbalance.law.law import Law
from dampbalance.signals.mean_harmonics import Reading, read_features
from identification.levels import THREE, changed, measured, read
from paper_case import LEVELS, PAPER, orbits_at


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
    answer = identify_readings(in_frame(channel, taken_for, hz, base), PAPER.k)
    said = next(w for w in answer.warnings if "was taken for" in w)
    assert f"name it {channel} in the mapping" in said
    assert ("added to" in said) == channel.startswith("relative")
    numbers = {key: float(value) for key, value in re.findall(r"(F_k|c|m) = ([\d.]+)", said)}
    assert numbers == pytest.approx({"F_k": PAPER.F_k, "c": PAPER.c, "m": PAPER.m}, rel=0.02)
    assert not any("likeliest of the causes" in w for w in answer.warnings)


@pytest.mark.parametrize("channel", ["displacement", "relative_displacement"])
def test_a_motion_in_its_own_frame_is_not_doubted(channel):
    answer = identify_readings(in_frame(channel, channel), PAPER.k)
    assert not any("taken for" in w for w in answer.warnings)
    assert answer.approaches["direct"].verdicts["F_k"].verdict == "usable"


@pytest.mark.parametrize("seed", range(4))
def test_records_of_the_oscillator_show_no_cause(seed):
    """By chance one in 200 sets shows one."""
    fit = joint_fit([one.lines for one in readings(seed=seed)], PAPER.k).fit
    assert fit.adequate
    assert likeliest(fit) is None


def test_the_report_names_it_first_and_what_it_changes_is_doubtful():
    found = identify_readings(of_unequal_friction(), PAPER.k)
    warning = next(w for w in found.warnings if "a friction force that changes with the level" in w)
    assert warning.index("the likeliest of the causes") < warning.index("a channel may be skewed")
    verdicts = {v.verdict for a in found.approaches.values() for v in a.verdicts.values()}
    assert verdicts <= {"doubtful", "none"}
    # by how much is known: the intervals hold the friction of the lowest level, of which it is the largest part, and c
    for symbol, truth in (("F_k", 1.18), ("c", PAPER.c)):
        assert found.verdicts[symbol].reason == warning
        low, high = found.intervals[symbol]
        assert low < truth < high


def under_gain(gain, levels=LEVELS, noise=0.003, **options):
    """Records whose drive reads too much by this part."""
    records = measured(levels, 3.5, cycles=40.0, noise=noise, **options)
    base = "base_displacement"
    return [changed(r, base, values=(1.0 + gain) * r[base].values) for r in records]


@pytest.mark.parametrize("mass", [None, PAPER.m, (PAPER.m, 0.0), (PAPER.m, 0.002)])
@pytest.mark.parametrize("gain", [0.01, -0.01])
def test_a_wrong_gain_of_the_drive_is_the_likeliest_cause_and_its_size_is_right(gain, mass):
    found = identify(under_gain(gain), PAPER.k, mass=mass)
    (said,) = (w for w in found.warnings if "a fault of a channel" in w)
    first = said.partition("likeliest, ")[2]
    size, error, much = re.match(r"the drive reads ([\d.]+) ± ([\d.]+) % too (\w+)", first).groups()
    assert much == ("much" if gain > 0.0 else "little")
    assert abs(float(size) - 1.0) < 4.0 * float(error)
    # the numbers without it, to their errors and the four digits that are printed
    fault = found.joint.faults[0]
    printed = dict(re.findall(r"(F_k|c|K_z) = ([\d.e+]+)", first.partition("without that")[2]))
    for symbol, by_gain in (("F_k", 1.0), ("c", 1.0), ("K_z", 6.0)):
        own = fault.fit.K_z_error if symbol == "K_z" else fault.fit.error(symbol)
        truth = getattr(PAPER, symbol)
        slack = math.hypot(own / truth, by_gain * fault.error)
        assert abs(float(printed[symbol]) / truth - 1.0) < 4.0 * slack + 5e-4, symbol
    assert "calibrate the drive and the response" in said
    assert {v.verdict for v in found.verdicts.values()} <= {"doubtful", "none"}


def test_causes_that_explain_the_records_as_well_are_named_in_the_same_sentence():
    """At so much noise a capacitor explains a wrong gain nearly as well; at a third, and with the mass, it does not."""
    free = identify(under_gain(0.01, noise=0.012), PAPER.k)
    clear = identify(under_gain(0.01, noise=0.004), PAPER.k, mass=(PAPER.m, 1e-3))
    names = {one.name for one in free.joint.faults}
    assert {"gain", "corner"} <= names
    (said,) = (w for w in free.warnings if "a fault of a channel" in w)
    assert "as well, with χ² within 6" in said
    assert "the drive reads" in said
    assert "through a capacitor" in said
    best = min(one.fit.chi_square for one in free.joint.faults)
    assert all(one.fit.chi_square < best + 6.0 for one in free.joint.faults)
    assert [one.name for one in clear.joint.faults] == ["gain"]


@pytest.mark.parametrize("seed", range(3))
def test_drives_that_read_right_are_not_suspected(seed):
    found = identify(under_gain(0.0, seed=seed), PAPER.k)
    assert found.joint.faults == ()
    assert {v.verdict for v in found.verdicts.values()} == {"usable"}


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


def rare(name, noise, factor=1.0):
    """Records of a rare rig, with displacements that were read in a unit that is so much smaller."""
    osc, hz, levels, rate = RARE[name]
    records = []
    for i, Y in enumerate(levels):
        orbit = steady_orbit(osc, BaseMotion(Y, 2.0 * math.pi * hz))
        options = {"rate_hz": rate, "cycles": 40.0, "noise": noise, "seed": i}
        one = measured_orbit(orbit, channels=THREE[:2], **options)
        x = one["displacement"].values
        records.append(changed(one, "displacement", values=factor * x))
    return osc, records


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
@pytest.mark.parametrize("name", RARE)
def test_a_rare_rig_is_not_asked_for_its_units(name, noise):
    osc, records = rare(name, noise)
    found = identify(records, osc.k)
    assert not any("unit" in words for words in found.warnings)
    assert found.verdicts["F_k"].verdict == "usable"
    assert found.values["F_k"] == pytest.approx(osc.F_k, rel=max(1e-4, 2.0 * noise))


@pytest.mark.parametrize(("name", "factor"), [("Q", 1000.0), ("100 g", 1000.0), ("fast", 1e-3)])
def test_a_unit_of_one_channel_is_asked_for_where_another_fits(name, factor):
    osc, records = rare(name, 1e-3, factor)
    found = identify(records, osc.k)
    assert any("of one channel wrong (mm taken for m)?" in words for words in found.warnings)
    assert {v.verdict for v in found.verdicts.values()} <= {"doubtful", "none"}
