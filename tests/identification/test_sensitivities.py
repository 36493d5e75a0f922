"""What faults do to an identification: against records that have them, and against what scaling the equations says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dampbalance import (
    BaseMotion,
    Oscillator,
    identify,
    measured_orbit,
    measured_ring_down,
    steady_orbit,
    steady_orbits,
)
from dampbalance.fit.loops import slider
from dampbalance.fit.select import select
from dampbalance.identification.answer import REFERENCE
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.sensitivities import FAULTS, Fault
from dampbalance.signals.mean_harmonics import read_features
from identification.levels import SYMBOLS, THREE, changed, identified, measured, read
from paper_case import PAPER, orbits_at


@pytest.fixture(scope="module", params=[3.5, 11.1])
def found(request):
    orbits = orbits_at(request.param, (0.004, 0.008, 0.012))
    # so fast that nothing folds: where it hardly shows it stays at its bound, and the first order does not hold
    readings = read(orbits, noise=0.001, seed=7, rate_hz=8000.0, channels=THREE)
    return readings, identified(readings)


# a fault that shows is fitted along, and then changes nothing
UNEXPLAINED = "dampbalance.identification.oscillator.candidates", lambda *_, **__: ()


OSC = Oscillator(m=2.42, c=9.0, k=2310.0, K_z=2310.0, F_k=1.28)


def forced(osc, fault):
    """Records of three levels, whose delay is that of the response and whose gains are those of all channels."""
    orbits = [steady_orbit(osc, BaseMotion(Y, 22.0)) for Y in (0.004, 0.008, 0.012)]
    for i, orbit in enumerate(orbits):
        made = [
            measured_orbit(*(orbit,), rate_hz=8000.0, cycles=20.0, noise=1e-2, seed=i, start=start)
            for start in (0.3, 0.3 - fault.late - fault.angle / 22.0)
        ]
        table = [{name: one[name].values for name in one} for one in made]
        yield {
            "time_s": made[0]["displacement"].t,
            "base_displacement_m": (1.0 + fault.drive) * table[0]["base_displacement"],
            "displacement_m": (1.0 + fault.response) * table[1]["displacement"],
        }


def decay(osc, fault):
    """A release, which no drive precedes."""
    one = measured_ring_down(osc, x=0.01, rate_hz=500.0, duration=3.0, noise=3e-3)
    x = (1.0 + fault.response) * one["displacement"].values
    yield {"time_s": one["displacement"].t, "displacement_m": x}


def lines(osc, fault):
    """A table of a stepped sine at three levels."""
    hertz, Y = np.linspace(4.0, 8.0, 17), np.array([[2e-4], [5e-4], [1e-3]])
    orbits = steady_orbits(osc, Y=Y, omega=2.0 * np.pi * hertz)
    omega, Y = (orbits.given[name].ravel() for name in ("omega", "Y"))
    yield {
        "frequency_hz": omega / (2.0 * np.pi),
        "base_displacement_m": (1.0 + fault.drive) * Y,
        "displacement_m": (1.0 + fault.response) * orbits.X_1.ravel(),
        "phase_rad": -orbits.phi_1.ravel() - fault.late * omega - fault.angle,
        "level": Y,
    }


def loops(osc, fault):
    """Cycles of a contact of 10 N and 50 N/mm with a damper, whose displacement is late."""
    t, later = (np.linspace(0.0, 10.0, 4001) - late for late in (0.0, fault.late))
    x, z = 1e-3 * np.sin(2.0 * np.pi * t), np.zeros(t.size)
    for i in range(1, t.size):
        z[i] = np.clip(z[i - 1] + x[i] - x[i - 1], -2e-4, 2e-4)
    f = 5e4 * z + 60.0 * np.gradient(x, t) + 0.01 * np.random.default_rng(1).normal(size=t.size)
    x = 1e-3 * np.sin(2.0 * np.pi * later)
    yield {
        "time_s": t,
        "displacement_m": (1.0 + fault.response) * x,
        "force_N": (1.0 + fault.drive) * f,
    }


ACTS = {
    forced: ("drive", "response", "late", "angle", "stiffness", "mass"),
    decay: ("response", "stiffness", "mass"),
    lines: ("drive", "response", "late", "angle", "stiffness"),
    loops: ("drive", "response", "late"),
}
"""The faults that act on records of each kind."""
LATE = {forced: 5e-6, lines: 5e-6, loops: 1e-4}  # s; other faults are 1e-4
GIVEN = {lines: {"contact": "one slider", "hardening": False}}


def found_with(make, fault, *, mass):
    """What is found in records with a fault.   mass : whether it is given."""
    asked = dict(GIVEN.get(make, {}))
    if make is not loops:
        asked["stiffness"] = OSC.k * (1.0 + fault.stiffness)
    if mass:
        asked["mass"] = (OSC.m * (1.0 + fault.mass), 1e-7)
    return identify([*make(OSC, fault)], **asked)


@pytest.mark.parametrize(
    ("make", "what"), [(make, what) for make, of in ACTS.items() for what in of]
)
def test_records_with_a_fault_change_as_is_said(make, what, monkeypatch):
    """A fault is put into the samples, or into what is stated, and so is its opposite; too small to show."""
    monkeypatch.setattr(*UNEXPLAINED)
    alone = "dampbalance.identification.loops.weigh"
    monkeypatch.setattr(alone, lambda design, **_: select(slider(design), (), ("F_k", "c", "rho")))
    size = LATE[make] if what == "late" else 1e-4
    mass = make in (forced, decay) and what in ("stiffness", "mass")
    sound, less, more = (
        found_with(make, Fault("", **{what: by}), mass=mass) for by in (0.0, -size, size)
    )
    for name in sound.approaches:
        told = sound.shifts({what: Fault("", **{what: size})}, name)[what]
        for symbol, value in sound.approaches[name].values.items():
            low, high = (one.approaches[name].values[symbol] for one in (less, more))
            change = 0.5 * (high - low) / value
            # weights of rows move a little, too, and where climbs end; many sliders for one differ by the corner
            near = {"rel": 0.2, "abs": 2e-4} if name == "gradual" else {"rel": 0.1, "abs": 5e-6}
            assert told[symbol] == pytest.approx(change, **near), (name, symbol)


@pytest.mark.parametrize("at_fault", ["base_displacement", "relative_displacement"])
def test_gains_of_a_motion_against_the_base_change_as_is_said(at_fault, monkeypatch):
    """The response is base + relative: a gain of the base is one of a part of it."""
    monkeypatch.setattr(*UNEXPLAINED)
    part = 1e-4  # beyond, it shows, and scales the errors
    channels = ("base_displacement", "relative_displacement")
    records = measured(cycles=25.0, noise=1e-4, seed=3, channels=channels)
    before, after = (
        identify_readings(
            [
                read_features(changed(one, at_fault, values=one[at_fault].values * gain), PAPER.k)
                for one in records
            ],
            PAPER.k,
        )
        for gain in (1.0, 1.0 + part)
    )
    name = "drive" if at_fault == "base_displacement" else "response"
    for answer in ("direct", REFERENCE):
        told = before.shifts(FAULTS, answer)[f"{name}_gain_1_percent"]
        for symbol in ("F_k", "c"):
            change = (
                after.approaches[answer].values[symbol] / before.approaches[answer].values[symbol]
            )
            assert told[symbol] == pytest.approx((change - 1.0) / part * 0.01, rel=0.1, abs=1e-4)


def test_gains_and_stiffness_scale_the_equations(found):
    name, told = found[1].sensitivities()
    assert name == REFERENCE == next(iter(found[1].approaches))
    # m, c, k, K_z and F_k times a number are an oscillator of the same motion
    assert [told["stiffness_1_percent"][s] for s in SYMBOLS] == pytest.approx([0.01] * 3, rel=1e-6)
    # drive and response times a number are a motion of the same oscillator with F_k times that number
    both = [told["drive_gain_1_percent"][s] + told["response_gain_1_percent"][s] for s in SYMBOLS]
    assert both == pytest.approx(
        [0.01, 0.0, 0.0], abs=2e-5
    )  # second order, and noise taken off squares


def test_the_document_has_them_in_percent(found):
    found_document = found[1].document()
    told = found_document["sensitivities"]
    assert found_document["sensitivities_of"] == REFERENCE
    assert list(told) == list(FAULTS)
    assert told["stiffness_1_percent"] == {
        "fault": "k is given 1 % too large",
        **{f"{symbol}_percent": pytest.approx(1.0, rel=1e-6) for symbol in (*SYMBOLS, "m")},
    }


def test_they_are_of_the_answer_to_use_first(found):
    result = found[1]
    balance = replace(result, reference=None)
    assert balance.sensitivities() == ("direct", result.shifts(FAULTS, "direct"))
    name, last = list(result.estimates.items())[-1]
    assert replace(balance, estimates={name: last}).sensitivities()[0] == name
