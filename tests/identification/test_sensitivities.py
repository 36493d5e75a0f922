"""What faults do to an identification: against records that have them, and against what scaling the equations says."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from dampbalance import Oscillator, identify, measured_ring_down, steady_orbits
from dampbalance.fit.loops import slider
from dampbalance.fit.select import select
from dampbalance.identification.answer import REFERENCE
from dampbalance.identification.sensitivities import FAULTS, Fault
from identification.levels import SYMBOLS, THREE, changed, identified, measured, read
from paper_case import PAPER, orbits_at

OSC = Oscillator(m=2.42, c=9.0, k=2310.0, K_z=2310.0, F_k=1.28)
HZ = 22.0 / (2.0 * np.pi)


@pytest.fixture(autouse=True)
def unexplained(monkeypatch):
    """A fault that shows is fitted along, and then changes nothing."""
    monkeypatch.setattr("dampbalance.identification.oscillator.candidates", lambda *_, **__: ())
    alone = "dampbalance.identification.loops.weigh"
    monkeypatch.setattr(alone, lambda design, **_: select(slider(design), (), ("F_k", "c", "rho")))


def larger(record, quantity, gain):
    return changed(record, quantity, values=(1.0 + gain) * record[quantity].values)


def forced(osc, fault):
    """Records of three levels, whose delay is that of the response and whose gains are those of all channels."""
    starts = 0.3, 0.3 - fault.late - fault.angle / 22.0
    made = (measured(hz=HZ, osc=osc, rate_hz=8000.0, start=start) for start in starts)
    for drive, response in zip(*made, strict=True):
        both = changed(drive, "displacement", values=response["displacement"].values)
        yield larger(larger(both, "displacement", fault.response), "base_displacement", fault.drive)


def decay(osc, fault):
    """A release, which no drive precedes."""
    one = measured_ring_down(osc, x=0.01, rate_hz=500.0, duration=3.0, noise=3e-3)
    yield larger(one, "displacement", fault.response)


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


@cache
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
def test_records_with_a_fault_change_as_is_said(make, what):
    """A fault is put into the samples, or into what is stated, and so is its opposite; too small to show."""
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
def test_gains_of_a_motion_against_the_base_change_as_is_said(at_fault):
    """The response is base + relative: a gain of the base is one of a part of it."""
    part = 1e-4  # beyond, it shows, and scales the errors
    channels = ("base_displacement", "relative_displacement")
    records = measured(cycles=25.0, noise=1e-4, seed=3, channels=channels)
    before, after = (
        identify([larger(one, at_fault, gain) for one in records], PAPER.k) for gain in (0.0, part)
    )
    name = "drive" if at_fault == "base_displacement" else "response"
    for answer in ("direct", REFERENCE):
        told = before.shifts(FAULTS, answer)[f"{name}_gain_1_percent"]
        one, other = (of.approaches[answer].values for of in (before, after))
        for symbol in ("F_k", "c"):
            change = (other[symbol] / one[symbol] - 1.0) / part * 0.01
            assert told[symbol] == pytest.approx(change, rel=0.1, abs=1e-4)


@pytest.mark.parametrize("hz", [3.5, 11.1])
def test_gains_and_stiffness_scale_the_equations(hz):
    # so fast that nothing folds: where it hardly shows it stays at its bound, and the first order does not hold
    orbits = orbits_at(hz, (0.004, 0.008, 0.012))
    found = identified(read(orbits, noise=0.001, seed=7, rate_hz=8000.0, channels=THREE))
    name, told = found.sensitivities()
    assert name == REFERENCE == next(iter(found.approaches)) == found.document()["sensitivities_of"]
    # m, c, k, K_z and F_k times a number are an oscillator of the same motion
    assert [told["stiffness_1_percent"][s] for s in SYMBOLS] == pytest.approx([0.01] * 3, rel=1e-6)
    shown = found.document()["sensitivities"]["stiffness_1_percent"]
    assert [shown[f"{s}_percent"] for s in (*SYMBOLS, "m")] == pytest.approx([1.0] * 4, rel=1e-6)
    # drive and response times a number are a motion of the same oscillator with F_k times that number
    both = [told["drive_gain_1_percent"][s] + told["response_gain_1_percent"][s] for s in SYMBOLS]
    # second order, and noise taken off squares
    assert both == pytest.approx([0.01, 0.0, 0.0], abs=2e-5)
    balance = replace(found, reference=None)
    assert balance.sensitivities() == ("direct", found.shifts(FAULTS, "direct"))
