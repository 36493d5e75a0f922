"""When the drive of a record moves, and at which frequency: slow drives, fast recorders, still starts, blows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import BaseMotion, identify, steady_orbit, transient
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.drive import frequency_of, onset, stands_still
from paper_case import NEAR, OMEGA, PAPER

MOTION = BaseMotion(Y=0.004, omega=OMEGA)


@pytest.mark.parametrize(
    ("hertz", "rate", "cycles"), [(1.0, 1e5, 11.3), (0.5, 51200.0, 9.6), (0.5, 51200.0, 3.2)]
)
def test_a_slow_drive_is_found_in_a_fast_record(hertz, rate, cycles):
    t = np.arange(round(cycles * rate / hertz)) / rate
    rng = np.random.default_rng(2)
    y = np.cos(2.0 * math.pi * hertz * t + 0.3) + 0.01 * rng.standard_normal(t.size)

    omega, error, used, begin = frequency_of(t, y, "y")
    # the bound of Rife and Boorstyn, of as much noise; of three cycles the error itself is known to half
    T = t[-1] - t[0]
    bound = math.sqrt(24.0 * 0.01**2 / t.size) / T
    assert abs(omega - 2.0 * math.pi * hertz) < 5.0 * bound
    assert bound / 10.0 < error < 10.0 * bound
    assert used >= min(8, math.floor(cycles))
    assert begin == -math.inf


def test_a_slow_drive_of_a_fast_record_is_identified():
    levels = [BaseMotion(Y=Y, omega=2.0 * math.pi) for Y in (0.004, 0.012)]
    records = [
        measured_orbit(steady_orbit(PAPER, motion), rate_hz=1e5, cycles=10.0, noise=0.01, seed=i)
        for i, motion in enumerate(levels)
    ]
    found = identify(records, PAPER.k)
    for symbol in ("F_k", "c"):
        low, high = found.intervals[symbol]
        assert low < getattr(PAPER, symbol) < high
        assert found.verdicts[symbol].verdict == "usable"


def begun(still, *, rate=51200.0, cycles=20.0, noise=0.002, Y=0.004, seed=0) -> Record:
    """A record that begins so many seconds before the drive does, from rest."""
    motion = BaseMotion(Y=Y, omega=OMEGA)
    t = np.arange(round((still + cycles * motion.period) * rate)) / rate
    since = np.maximum(t - still, 0.0)
    x = np.where(t >= still, transient(PAPER, motion, float(since[-1])).state(since).x, 0.0)
    rng = np.random.default_rng(seed)
    signals = {"base_displacement": np.where(t >= still, motion.y(since), 0.0), "displacement": x}
    channels = [
        Channel(q, t, s + noise * np.ptp(s) * rng.standard_normal(t.size) + 1e-3)
        for q, s in signals.items()
    ]
    return Record.of(f"Y = {Y:g} m", channels)


@pytest.mark.parametrize("noise", [0.0, 0.002, 0.02])
@pytest.mark.parametrize(("still", "rate"), [(2.0, 51200.0), (9.0, 51200.0), (2.0, 1000.0)])
def test_a_still_start_is_left_out_and_said(still, rate, noise):
    record = begun(still, rate=rate, noise=noise)
    assert not stands_still(record["base_displacement"].values)
    steady = condition(record, PAPER.k, skip_cycles=5)
    assert steady.frequency_hz == pytest.approx(NEAR, rel=1e-4)
    (late,) = (one for one in steady.warnings if one.code == "starts late")
    assert late.numbers["begin"] == pytest.approx(still, abs=MOTION.period)
    # within a cycle of the onset, and the five that were asked for
    assert still - 1e-3 < steady.start - 5.0 * MOTION.period < still + MOTION.period
    assert steady.cycles == pytest.approx(14.5, abs=0.6)
    assert abs(steady.mean(steady.Y)[1]) == pytest.approx(MOTION.Y, rel=0.01)


def test_a_still_start_does_not_decide_the_kind_of_a_record():
    records = [begun(2.0, Y=Y, seed=i) for i, Y in enumerate((0.004, 0.008, 0.012))]
    with pytest.raises(
        ValueError, match=r"not steady: .* leave out cycles at its start \(--skip-c"
    ):
        identify(records, PAPER.k)
    found = identify(records, PAPER.k, skip_cycles=5)
    for symbol, (low, high) in found.intervals.items():
        assert low < getattr(PAPER, symbol) < high, symbol
        assert found.verdicts[symbol].verdict == "usable"


def test_a_drift_is_no_still_start():
    record = measured_orbit(steady_orbit(PAPER, MOTION), rate_hz=1000.0, cycles=30.0, noise=0.001)
    t, values = record["base_displacement"].t, record["base_displacement"].values
    # half of the range is passed after twelve cycles
    drifting = values + 4.0 * MOTION.Y * np.linspace(0.0, 1.0, t.size) ** 3
    assert t[onset(drifting)] > 10.0 * MOTION.period
    omega, _, cycles, begin = frequency_of(t, drifting, "y")
    assert (cycles, begin) == (30, -math.inf)
    # the drift turns the phase by less than a tenth of a cycle in 30
    assert omega == pytest.approx(OMEGA, rel=0.1 / 30.0)


T = np.arange(40_000) / 5000.0
NOISE = np.random.default_rng(4).standard_normal(T.size)


@pytest.mark.parametrize(
    ("values", "still"),
    [
        (0.0 * T, True),
        (NOISE, True),
        (NOISE + 100.0 * (np.abs(T - 1.0) < 0.005), True),  # a blow
        (NOISE + 100.0 * (np.abs(T % 2.0 - 1.0) < 0.005), True),  # four
        (np.cos(20.0 * T), False),
        (np.cos(2.0 * T) + 0.1 * NOISE, False),
        (np.where(T > 7.0, np.cos(20.0 * T), 0.01 * NOISE), False),
        (np.where(T < 1.0, np.cos(20.0 * T), 0.01 * NOISE), False),
        (np.cos(20.0 * T) + 500.0 * (np.arange(T.size) == 77), False),  # a spike
    ],
)
def test_noise_and_blows_stand_still(values, still):
    assert stands_still(values) == still
    assert stands_still(values * 1e-6 + 3.0) == still


def test_the_number_of_cycles_that_a_message_names_counts_from_the_start_and_suffices():
    measured = measured_orbit(
        steady_orbit(PAPER, MOTION), rate_hz=2000.0, cycles=40.0, noise=0.001, seed=2
    )
    for size in (0.02, 0.3):  # reported, and refused
        x = measured["displacement"]
        settling = 1.0 + size * (x.t < x.t[0] + 8.0 * MOTION.period)
        record = Record.of(
            "run",
            [measured["base_displacement"], Channel("displacement", x.t, x.values * settling)],
        )
        skipped = 0
        for already in (0, 3):
            try:
                (said,) = condition(record, PAPER.k, skip_cycles=already).warnings
                skipped = said.numbers["skip"]
            except ValueError as error:
                skipped = error.__cause__.skip
            assert skipped == 8
        assert condition(record, PAPER.k, skip_cycles=skipped).warnings == ()
