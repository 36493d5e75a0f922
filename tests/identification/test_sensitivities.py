"""What faults do to an identification: against records that have them, and against what scaling the equations says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dampbalance.identification.answer import REFERENCE
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.sensitivities import FAULTS
from dampbalance.signals.mean_harmonics import Reading, read_features
from identification.levels import SYMBOLS, THREE, changed, identified, measured, read
from paper_case import PAPER, orbits_at


@pytest.fixture(scope="module", params=[3.5, 11.1])
def found(request):
    orbits = orbits_at(request.param, (0.004, 0.008, 0.012))
    # so fast that nothing folds: where it hardly shows it stays at its bound, and the first order does not hold
    readings = read(orbits, noise=0.001, seed=7, rate_hz=8000.0, channels=THREE)
    return readings, identified(readings)


def with_fault(reading, fault, part):
    """The reading of a record that has a part of a fault, in every cycle."""
    steady = reading.steady
    lag = part * (fault.late * steady.omega + fault.angle)
    turn = np.exp(-1j * np.arange(steady.X.shape[1]) * lag)
    return Reading(
        replace(
            steady,
            Y=steady.Y * (1.0 + part * fault.drive),
            X=steady.X * (1.0 + part * fault.response) * turn,
            k=steady.k * (1.0 + part * fault.stiffness),
        )
    )


# a fault that shows is fitted along, and then changes nothing
UNEXPLAINED = "dampbalance.identification.oscillator.explanations", lambda *_, **__: ()


@pytest.mark.parametrize("name", FAULTS)
def test_records_with_the_fault_change_as_is_said(name, found, monkeypatch):
    monkeypatch.setattr(*UNEXPLAINED)
    readings, _ = found
    result = identify_readings(readings, PAPER.k)
    fault, part = FAULTS[name], 0.01
    faulty = [with_fault(reading, fault, part) for reading in readings]
    again = identify_readings(faulty, PAPER.k * (1.0 + part * fault.stiffness))
    for answer in ("direct", REFERENCE):
        told = result.shifts(FAULTS, answer)
        for symbol in SYMBOLS[: 2 if answer == "direct" else 3]:
            before, after = (each.approaches[answer].values[symbol] for each in (result, again))
            # to first order; weights of rows move a little, too, and what noise leaves of the waveforms bends them
            change = (after / before - 1.0) / part
            assert told[name][symbol] == pytest.approx(change, rel=0.1, abs=1e-4), (answer, symbol)


@pytest.mark.parametrize("at_fault", ["base_displacement", "relative_displacement"])
def test_gains_of_a_motion_against_the_base_change_as_is_said(at_fault, monkeypatch):
    """The response is base + relative: a gain of the base is one of a part of it."""
    monkeypatch.setattr(*UNEXPLAINED)
    part = 1e-3
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
