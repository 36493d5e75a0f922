"""Departures from one oscillator, each made by an integrator of its own: named, fitted, and the answer freed of it."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from blind.other_motion import NO_DEPARTURE, Departure, steady
from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit
from dampbalance.findings.finding import Finding
from dampbalance.findings.words import sentence
from dampbalance.fit.nuisances import NUISANCES
from dampbalance.identification.causes import doubts_of
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.oscillator import common_fit
from dampbalance.identification.weighing import departure
from dampbalance.law.law import Law
from dampbalance.records.coordinate import TRANSLATION
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.signals.record_harmonics import RecordHarmonics
from identification.levels import THREE, changed, measured
from paper_case import LEVELS, PAPER

M, C, K, K_Z, F_K, OMEGA = 2.0, 4.0, 2000.0, 30000.0, 0.4, 2.0 * math.pi * 4.6
BASES = (1e-3, 1.6e-3, 2.5e-3, 4e-3)
NOISE = 2e-5  # of the fundamental: a per cent in each of some thousand samples
FASTEST = 0.62  # m/s, at the highest level, to a per cent


@cache
def clean(F_k, Y, departure, c, omega):
    """Harmonics 1, 3 … 13 of the motion at a level, m."""
    phases = np.arange(4096) * (2.0 * math.pi / 4096)
    x = steady((M, c, K, K_Z, F_k, Y, omega), departure)(phases)[0]
    return 2.0 * np.fft.rfft(x)[1:14:2] / phases.size


def lines_of(
    departure=NO_DEPARTURE,
    reads=lambda n, x, Y: (x, Y),
    forces=(F_K,) * 4,
    seed=0,
    noise=NOISE,
    c=C,
    omega=OMEGA,
):
    """Harmonics of each level, with noise.   reads : what the channels make of the harmonics and of the base."""
    random, lines, n = np.random.default_rng(seed), [], np.arange(1, 14, 2)
    for Y, F_k in zip(BASES, forces, strict=True):
        x, base = reads(n, clean(F_k, Y, departure, c, omega), Y)
        error = noise * abs(x[0])
        x = x + error * (random.standard_normal(n.size) + 1j * random.standard_normal(n.size))
        lines.append(RecordHarmonics(omega, base, noise * Y, n, x, np.full(n.size, error), 40))
    return lines


def of_channel(factor):
    """The response behind a filter with a factor, of iω."""
    return {"reads": lambda n, x, Y: (x * factor(1j * n * OMEGA), Y)}


MADE = {
    "delay": (of_channel(lambda s: np.exp(-1e-3 * s)), 1e-3),
    "corner": (of_channel(lambda s: s / (s + 2.0 * math.pi * 0.2)), 0.2),
    "gain": ({"reads": lambda n, x, Y: (x, 1.05 * Y)}, 0.05),
    "frame": ({"reads": lambda n, x, Y: (x - Y * (n == 1), Y)}, None),
    "friction_level": ({"forces": (0.38, 0.3935, 0.4065, 0.42)}, 0.07),
    "friction_speed": ({"departure": Departure(falling=0.05, speed=0.1 * FASTEST)}, 0.05),
    "c_2": ({"departure": Departure(quadratic=0.4)}, 0.4),
    "k_3": ({"departure": Departure(cubic=0.005 * K / 0.02**2)}, 0.005 * K / 0.02**2),
}
"""The motion or channel that makes each departure, of a laboratory's size, and that size."""


@pytest.mark.parametrize("name", MADE)
def test_a_departure_is_named_and_fitted_and_the_answer_is_freed_of_it(name):
    options, size = MADE[name]
    whole = common_fit(lines_of(**options), K, frames=True)
    answer, best = whole.answer, whole.closest
    assert whole.clear == (name,)
    if size is not None:
        # forces act to first order in their size
        off = abs(best.value(name) - size)
        assert off < 4.0 * best.error(name) + 0.1 * size
        assert best.error(name) < 0.3 * size
    doubts = doubts_of(whole.selection, name)
    for symbol, truth in (("F_k", F_K), ("c", C)):
        low, high = answer.intervals[symbol]
        # of the second order, which nothing bounds but the size of the departure: two parts in a thousand
        slack = 2e-3 * truth + doubts.get(symbol, 0.0) * truth
        assert low - slack < truth < high + slack, symbol


def test_causes_that_explain_the_records_as_well_widen_the_intervals():
    """Next to this noise, the phase that a high-pass filter turns is like what a spring that stiffens adds."""
    behind = of_channel(lambda s: s / (s + 2.0 * math.pi * 0.4))
    whole = common_fit(lines_of(**behind, noise=3e-4), K)
    assert min(whole.selection.weight(name) for name in ("corner", "k_3")) > 0.01
    assert whole.answer.intervals["c"].low < C < whole.answer.intervals["c"].high


@pytest.mark.parametrize("seed", range(3))
def test_a_turn_of_the_phase_that_acts_like_damping_is_followed_to_its_end(seed):
    """Above resonance the phase that an AC coupling turns is like nine times the damping, and only the harmonics, next
    to this noise by three standard errors or so, tell them apart."""
    omega, c = 1.7 * math.sqrt(K / M), 2.0 * 0.004 * math.sqrt(K * M)
    behind = {"reads": lambda n, x, Y: (x * n / (n - 0.06j), Y), "forces": (0.02,) * 4}
    whole = common_fit(lines_of(**behind, seed=seed, noise=1e-5, c=c, omega=omega), K)
    assert whole.selection.weight("corner") > 0.1
    c_found = whole.answer.parameters["c"]
    assert c_found.interval.low < c < c_found.interval.high


def test_a_size_is_said_to_its_error_or_not_to_be_determined():
    for name, value, error, size in (
        ("gradual", 0.3141, 0.0519, "0.314 ± 0.052"),
        ("gradual", 1.0, 6235.0, "about 1 "),
        ("delay", -8e-5, 1.1e-5, " 80 ± 11 µs"),
        ("friction_level", -0.081, 0.011, "−8.1 ± 1.1 %"),
    ):
        one = departure(name, value, error)
        assert size in sentence(one, TRANSLATION)
        assert one.numbers["unsure"] == (error > abs(value))
        assert one.numbers["less"] == (value < 0.0)


@pytest.mark.parametrize("seed", range(2))
def test_records_of_the_oscillator_show_no_departure(seed):
    """By chance one in 100 sets shows one."""
    whole = common_fit(lines_of(seed=seed), K, frames=True)
    assert whole.waveforms_hold
    assert whole.clear == ()


IMPOSSIBLE = {
    "corner": of_channel(lambda s: s / (s - 2.0 * math.pi * 0.2)),
    "friction_speed": {"departure": Departure(falling=-0.1, speed=0.1 * FASTEST)},
    "gain": {"reads": lambda n, x, Y: (x, 1.46 * Y)},
    "delay": of_channel(lambda s: np.exp(-1.7 * s * 2.0 * math.pi / OMEGA)),
}
"""What would take a departure of a size that no rig has: below zero, or of a unit or a channel that was mistaken."""


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_no_cause_is_named_with_a_size_that_it_cannot_have(name):
    whole = common_fit(lines_of(**IMPOSSIBLE[name]), K)
    least, greatest = NUISANCES[name]
    values = [whole.closest.value(name)] if name in whole.clear else []
    unit = {"corner": OMEGA / (2.0 * math.pi), "delay": 1.0 / OMEGA}.get(name, 1.0)
    assert all(least < value / unit < greatest for value in values)


def test_a_term_that_the_law_has_is_no_departure():
    lines = lines_of(departure=Departure(quadratic=0.4))
    assert common_fit(lines, K, law=Law(("F_k", "c", "c_2"))).clear == ()


def in_frame(channel, taken_for, hz=3.5, base="base_displacement"):
    """Readings of a channel of the mass that was taken for another."""
    records = measured(LEVELS[:3], hz, cycles=25.0, channels=(base, channel))
    return [read_features(changed(r, channel, quantity=taken_for), PAPER.k) for r in records]


@pytest.mark.parametrize(
    ("channel", "taken_for", "hz", "base"),
    [
        ("relative_displacement", "displacement", 3.5, "base_displacement"),
        ("relative_acceleration", "acceleration", 3.5, "base_acceleration"),
        ("velocity", "relative_velocity", 4.92, "base_displacement"),
    ],
)
def test_a_motion_in_the_wrong_frame_is_named_and_the_answer_is_that_of_the_right_one(
    channel, taken_for, hz, base
):
    found = identify_readings(in_frame(channel, taken_for, hz, base), PAPER.k)
    (said,) = (one for one in found.findings if one.numbers.get("clear"))
    (frame,) = said.numbers["what"]
    assert frame == Finding("frame", {"absolute": not channel.startswith("relative")})
    for symbol in ("F_k", "c"):
        assert found.values[symbol] == pytest.approx(getattr(PAPER, symbol), rel=0.02)
        assert found.verdicts[symbol].verdict == "usable"


@pytest.mark.parametrize("channel", ["displacement", "relative_displacement"])
def test_a_motion_in_its_own_frame_is_not_doubted(channel):
    answer = identify_readings(in_frame(channel, channel), PAPER.k)
    assert not any(one.numbers.get("clear") for one in answer.findings)
    assert answer.verdicts["F_k"].verdict == "usable"


@pytest.mark.parametrize("gain", [0.01, -0.01])
def test_a_wrong_gain_is_said_with_its_size_and_what_only_a_calibration_tells(gain):
    records = measured(LEVELS, 3.5, cycles=40.0, noise=0.003)
    base = "base_displacement"
    records = [changed(r, base, values=(1.0 + gain) * r[base].values) for r in records]
    found = identify(records, PAPER.k)
    (said,) = (one for one in found.findings if one.numbers.get("clear"))
    assert [one.code for one in said.numbers["what"]] == ["gain"]
    for symbol in ("F_k", "c"):
        low, high = found.intervals[symbol]
        assert low < getattr(PAPER, symbol) < high
    # F_k is in proportion to the motion: whether drive or response is wrong, the records do not tell
    assert found.verdicts["F_k"].within > 0.9 * abs(gain)
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


@pytest.mark.parametrize(
    ("name", "noise"), [("Q", 1e-4), ("Q", 1e-2), ("fast", 1e-4), ("100 g", 1e-2)]
)
def test_a_rare_rig_is_not_asked_for_its_units(name, noise):
    osc, records = rare(name, noise)
    found = identify(records, osc.k)
    assert "unit" not in {one.code for one in found.findings}
    assert found.verdicts["F_k"].verdict == "usable"
    assert found.values["F_k"] == pytest.approx(osc.F_k, rel=max(1e-4, 2.0 * noise))


@pytest.mark.parametrize(("name", "factor"), [("Q", 1000.0), ("fast", 1e-3)])
def test_a_unit_of_one_channel_is_asked_for_where_another_fits(name, factor):
    osc, records = rare(name, 1e-3, factor)
    found = identify(records, osc.k)
    asked = {one.numbers["confused"] for one in found.findings if one.code == "unit"}
    assert asked == {"mm taken for m"}
    assert {v.verdict for v in found.verdicts.values()} <= {"doubtful", "none"}
