"""Records in the wrong frame, of a wrong gain or unit: named, and the answer freed of it or doubted."""

from __future__ import annotations

import math

import pytest

from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
from dampbalance.findings.finding import Finding
from dampbalance.identification.forced import identify_readings
from dampbalance.signals.mean_harmonics import read_features
from identification.levels import THREE, changed, measured
from paper_case import LEVELS, PAPER


def in_frame(channel, taken_for, hz=3.5, base="base_displacement"):
    """Readings of a channel of the mass that was taken for another."""
    records = measured(LEVELS[:3], hz, cycles=25.0, channels=(base, channel))
    return [read_features(changed(r, channel, quantity=taken_for), PAPER.k) for r in records]


@pytest.mark.parametrize(
    ("channel", "taken_for", "hz", "base"),
    [
        ("relative_acceleration", "acceleration", 3.5, "base_acceleration"),
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
