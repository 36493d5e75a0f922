"""One mapping corrects records of every kind: a channel that is distorted gives what the motion itself gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lsim

from dampbalance import identify, measured_ring_down, read_records
from dampbalance.records.channel import Channel
from dampbalance.records.mapping import mapping_from
from dampbalance.records.record import Record
from fit.test_loops import SINE, T, loop
from identification.levels import changed
from paper_case import PAPER

GAIN, DELAY, CORNER = 1.25, 3e-3, 60.0
RULE = {"gain": GAIN, "delay": DELAY, "low_pass": {"corner_hz": CORNER, "order": 1}}
RULES = mapping_from({"channels": {"displacement": {"channel": 1, **RULE}}}).channels


def distorted(record):
    """The record whose displacement has passed the channel, by SciPy's filter; it was at rest before."""
    x, pole = record["displacement"], 2.0 * np.pi * CORNER
    values = x.values[0] + lsim(([pole], [1.0, pole]), x.values - x.values[0], x.t - x.t[0])[1]
    of = {"t": x.t + DELAY, "values": GAIN * values, "correction": RULES["displacement"].correction}
    return changed(record, "displacement", **of)


def free():
    osc = replace(PAPER, c=1.5, F_k=0.5)
    return [measured_ring_down(osc, x=0.012, rate_hz=1000.0, duration=3.0, noise=1e-3)]


def loops():
    force = Channel("force", T, loop(c=30.0).f)
    return [Record.of("loops", [force, Channel("displacement", T, SINE)])]


@pytest.mark.parametrize("kind", [free, loops])
def test_a_mapping_gives_the_truth_back(kind):
    k = None if kind is loops else PAPER.k
    plain, found = identify(kind(), k), identify([distorted(one) for one in kind()], k)
    for symbol in ("F_k", "c"):
        off = found.values[symbol] - plain.values[symbol]
        # the same noise, which a filter that starts from rest and its inverse change; the gain alone would be 25 %
        assert abs(off) < 4.0 * plain.standard_errors[symbol], symbol
        assert off == pytest.approx(0.0, abs=0.03 * plain.values[symbol])


def test_samples_leave_corrected_once():
    """As recorded for harmonics, which are divided by the response exactly; else without gain, delay and filter."""
    (clean,) = loops()
    (record,) = read_records([distorted(clean)])
    x = clean["displacement"]
    whole = record.corrected()["displacement"]
    inside = slice(50, -50)  # the filter starts from rest
    np.testing.assert_allclose(whole.values[inside], x.values[inside], atol=2e-3 * np.ptp(x.values))
    np.testing.assert_allclose(whole.t, x.t, atol=1e-12)
    np.testing.assert_array_equal(whole.corrected().values, whole.values)
    recorded = record["displacement"]
    np.testing.assert_array_equal(recorded.t, x.t + DELAY)
