"""What the balance says of the fit where it cannot have what the fit has, and what stands behind a delay."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from blind.decays import record
from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.identification.decays import identify_decay_records
from identification.levels import changed, measured
from identification.levels import clipped as cut
from identification.releases import PLUCKED

RIG = Oscillator(m=1.7, c=17.0, k=2700.0, K_z=85_000.0, F_k=2.1)
HZ = 5.1
OMEGA = 2.0 * math.pi * HZ
LEVELS = (0.003, 0.006, 0.011)


def records(by=1.0, osc=RIG, levels=LEVELS, hz=HZ, quantity="displacement"):
    """Records whose response is that to the base times `by`, a complex number."""
    options = {"rate_hz": 1000.0, "cycles": 25.0, "noise": 0.003}
    late = cmath.phase(by) / (2.0 * math.pi * hz)
    driven = measured([abs(by) * Y for Y in levels], hz, osc, start=late, **options)
    pairs = zip(measured(levels, hz, osc, **options), driven, strict=True)
    of = "displacement"
    return [changed(one, of, values=x[of].values, quantity=quantity) for one, x in pairs]


def said(found, code):
    """The departure of this code that the records show."""
    return next(
        w for f in found.odd if f.code == "weighs" for w in f.numbers["what"] if w.code == code
    )


def test_a_delay_and_a_gain_are_taken_off_the_rows_before_they_are_compared():
    late = 1.1e-3
    found = identify(records(cmath.exp(-1j * OMEGA * late)), RIG.k)
    check = found.check[0]
    assert (check.numbers["corrected"], check.numbers["times"]) == (("delay",), 0.0)
    # 1 % of its own is what the delay's error of 40 µs leaves; without correction it is off by more
    off = {symbol: off / value for symbol, value, off in check.numbers["changes"]}
    assert abs(off["c"]) < 0.01 < abs(found.approaches["direct"].values["c"] / RIG.c - 1.0)


def test_no_difference_is_shown_where_the_rows_lack_a_filter():
    hertz, given = np.fft.rfftfreq(records()[0]["displacement"].values.size, 1e-3), []
    for one in records():
        lines = np.fft.rfft(one["displacement"].values) * hertz / (hertz - 0.4j)
        given.append(changed(one, "displacement", values=np.fft.irfft(lines, 2 * hertz.size - 2)))
    found = identify(given, RIG.k)
    assert abs(found.approaches["direct"].values["c"] / RIG.c - 1.0) > 0.05
    assert found.check[0].numbers == {"lacks": ("corner",)}


def test_the_difference_of_a_number_that_may_be_zero_is_not_relative():
    found = identify(records(osc=replace(RIG, c=0.0), levels=(0.002, 0.0024, 0.003), hz=3.9), RIG.k)
    changes = {symbol: (value, off) for symbol, value, off in found.check[0].numbers["changes"]}
    assert changes["c"][0] == 0.0 < changes["F_k"][0]
    errors = [one.standard_errors["c"] for one in found.approaches.values()]
    assert abs(changes["c"][1]) < 4.0 * sum(errors)


@pytest.mark.parametrize("c_r", [3.0, 7.0])
def test_a_lead_is_the_damper_between_base_and_mass_that_the_law_lacks(c_r):
    given = records(1.0 + 1j * OMEGA * c_r / RIG.k, replace(RIG, c=RIG.c + c_r))
    of = said(identify(given, RIG.k), "delay").numbers
    size, error = of["damper"]
    # a lead is such a damper to the first order in ωc_r/k, 0.08
    assert size == pytest.approx(c_r, abs=4.0 * error + 0.02 * c_r)
    found = identify(given, RIG.k, terms=of["law"])
    for symbol, truth in {"c": RIG.c, "c_r": c_r}.items():
        assert abs(found.values[symbol] - truth) < 4.0 * found.standard_errors[symbol]


def test_a_lag_is_a_damper_to_the_ground_beside_a_mount():
    ground = 2.5
    by = (RIG.m * OMEGA**2 - 1j * OMEGA * ground) / RIG.k
    given = records(by, quantity="relative_displacement")
    of = said(identify(given, RIG.k, mass=RIG.m, contact_to="base"), "delay").numbers
    # other departures share what the higher harmonics show
    assert of["damper"][0] == pytest.approx(ground, rel=0.2)


def test_the_balance_does_not_judge_clipped_decays():
    found = identify_decay_records([cut(record(PLUCKED)[0], "displacement", 0.4)], PLUCKED.k)
    assert abs(found.estimates["balance"].values["c"] / PLUCKED.c - 1.0) > 0.3
    assert found.check[0].numbers == {"lacks": ("clipped",)}
    assert "contradicts" not in {one.code for one in found.odd}


def test_a_second_mode_is_named_where_it_widens_the_intervals():
    given, _ = record(PLUCKED)
    t, x = given["displacement"].t, given["displacement"].values
    hertz = 2.4 * math.sqrt(PLUCKED.k / PLUCKED.m) / (2.0 * math.pi)
    mode = 0.001 * (t > 0.2) * np.exp(-1.2 * (t - 0.2)) * np.cos(2.0 * math.pi * hertz * t)
    found = identify_decay_records([changed(given, "displacement", values=x + mode)], PLUCKED.k)
    (note,) = (one for one in found.reference.notes if one.code == "other motion")
    # a line of 5 s is 0.2 Hz wide
    assert note.numbers["hertz"] == pytest.approx(hertz, abs=0.2)
    for symbol, (low, high) in found.intervals.items():
        assert low < getattr(PLUCKED, symbol) < high


def test_a_departure_that_changes_no_number_has_no_size():
    osc = Oscillator(m=2.2, c=1.4, k=3500.0, K_z=60_000.0, F_k=0.9)
    found = identify(measured_ring_down(osc, x=0.014, rate_hz=800.0, duration=2.5), osc.k)
    assert {one.name: (one.size, one.error) for one in found.weighed}["c_2"] == (0.0, 0.0)


def test_what_looks_like_a_gain_may_be_a_structure_that_moves_along_and_bounds_no_damping():
    y, given = "base_displacement", records()
    found = identify([changed(one, y, values=1.06 * one[y].values) for one in given], RIG.k)
    size, error = said(found, "gain").numbers["size"]
    assert size == pytest.approx(0.06, abs=4.0 * error)
    for symbol in ("F_k", "c"):
        assert found.verdicts[symbol].verdict == "doubtful"
        assert found.verdicts[symbol].within == pytest.approx(0.06, rel=0.1)
