"""Stated uncertainties: intervals hold what they do to records, and a report says on what its numbers depend."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import Oscillator, identify, measured_ring_down
from dampbalance.project.options import OPTIONS, configured, contradictions
from dampbalance.records.channel import Correction
from dampbalance.records.quantities import with_error
from identification.levels import changed, measured
from paper_case import PAPER

DECAYING = replace(PAPER, c=1.5, F_k=0.5)


def corrected(records, errors):
    """The records whose channels of these quantities have gains or delays of these standard uncertainties."""
    for quantity, of in errors.items():
        records = [changed(one, quantity, correction=Correction(**of)) for one in records]
    return records


def forced(errors=None, drive="base_displacement", noise=1e-5):
    """Records of three levels."""
    records = measured(rate_hz=2000.0, noise=noise, channels=(drive, "displacement"))
    return corrected(records, errors or {})


def free(errors=None):
    decay = measured_ring_down(DECAYING, x=0.012, rate_hz=1000.0, duration=3.0, noise=1e-5)
    return corrected([decay], errors or {})


def relative(found, name=None):
    """Standard error of each number over its value."""
    answer = found.answer if name is None else found.approaches[name]
    return [answer.standard_errors[s] / value for s, value in answer.values.items()]


@pytest.mark.parametrize(("records", "check"), [(forced, "direct"), (free, "balance")])
def test_all_numbers_are_in_proportion_to_the_stiffness(records, check):
    found = identify(records(), stiffness=(2310.0, 23.1))
    # noise of 1e-5 leaves errors of less than 0.1 %
    for name in ("maximum likelihood", check):
        assert all(of == pytest.approx(0.01, rel=5e-3) for of in relative(found, name)), name
    both = found.values["F_k"] * found.values["c"]
    assert found.covariance.loc["F_k", "c"] == pytest.approx(1e-4 * both, rel=1e-2)
    merit = found.document()["maximum_likelihood"]
    assert merit["m_standard_error_kg"] / merit["m_kg"] == pytest.approx(0.01, rel=5e-3)


def test_a_force_does_not_ask_for_the_stiffness():
    """m ẍ + c ẋ + k x + F = f: with one frequency k and m are told apart by nothing but harmonics."""
    found = identify(forced(drive="force"), stiffness=(2310.0, 23.1))
    assert relative(found)[0] < 2e-3
    assert relative(found, "direct")[1] < 2e-3


@pytest.mark.parametrize("fault", ["drive", "response", "late"])
def test_an_interval_is_what_such_records_scatter_by(fault, monkeypatch):
    """Records that are off by one standard uncertainty give numbers off by what the errors say."""
    # a fault that shows is fitted along, and then changes nothing
    candidates = "dampbalance.identification.oscillator.candidates"
    monkeypatch.setattr(candidates, lambda *_, **__: ())
    quantity = "base_displacement" if fault == "drive" else "displacement"
    uncertain = {"delay_error": 1e-5} if fault == "late" else {"gain_error": 1e-3}
    off = {"delay": 1e-5} if fault == "late" else {"gain": 1.001}
    # so much that the fault does not show
    plain, stated, faulty = (
        identify(forced(errors, noise=1e-3), stiffness=PAPER.k)
        for errors in ({}, {quantity: uncertain}, {quantity: off})
    )
    assert stated.values == pytest.approx(plain.values, rel=1e-9)
    for name in ("maximum likelihood", "direct"):
        one, two = faulty.approaches[name].values, plain.approaches[name].values
        for symbol, error in stated.approaches[name].standard_errors.items():
            noise = plain.approaches[name].standard_errors[symbol]
            added = math.sqrt(error**2 - noise**2)
            # to first order, and as far as the weights of the rows stay as they are
            off_by = abs(one[symbol] - two[symbol])
            assert added == pytest.approx(off_by, rel=0.05, abs=2e-5 * two[symbol]), (name, symbol)


def test_a_gain_of_a_decay_scales_friction_alone():
    found = identify(free({"displacement": {"gain_error": 0.02}}), stiffness=2310.0)
    F_k, *others = relative(found)
    assert F_k == pytest.approx(0.02, rel=1e-2)
    assert max(others) < 2e-3


def test_a_mass_within_the_uncertainty_of_the_stiffness_contradicts_nothing():
    off, mass = 1.004 * PAPER.k, (PAPER.m, 0.0)
    without = identify(forced(), stiffness=off, mass=mass)
    (said,) = (one.numbers["masses"] for one in without.findings if one.code == "mass")
    assert said[1] / said[0] - 1.0 == pytest.approx(-0.004, abs=5e-5)
    # all numbers may be off by as much, which makes none of them useless
    assert without.verdicts["F_k"].verdict == "usable"
    assert without.verdicts["F_k"].within > 0.0039
    found = identify(forced(), stiffness=(off, 0.004 * off), mass=mass)
    assert "mass" not in {one.code for one in found.findings}
    low, high = found.intervals["F_k"]
    assert low < PAPER.F_k < high


@pytest.mark.parametrize(
    ("given", "asked"),
    [
        ({"stiffness": 2310.0}, ["2310 ± 1 %", "--mass"]),
        ({"stiffness": 2310.0, "mass": (PAPER.m, 0.0)}, ["2310 ± 1 %"]),
        ({"stiffness": "2310±10"}, ["--mass"]),
        ({"stiffness": "2310+-10", "mass": (PAPER.m, 0.0)}, []),
    ],
)
def test_a_report_says_once_on_what_its_numbers_depend(given, asked):
    words, report = (
        "All numbers are conditional on the stiffness",
        identify(forced(), **given).text(),
    )
    assert report.count(words) == bool(asked)
    hint = report.partition(words)[2].partition("\n")[0]
    assert [one for one in ("2310 ± 1 %", "--mass") if one in hint] == asked


def test_a_mass_that_the_fit_takes_adds_its_uncertainty():
    """The error of each number is what a mass that is off by one standard uncertainty does to it."""
    errors = 0.5 * identify(forced(), PAPER.k).reference.merit["m_standard_error_kg"]
    exact, off, stated = (
        identify(forced(), PAPER.k, mass=mass)
        for mass in ((PAPER.m, 0.0), (PAPER.m + errors, 0.0), (PAPER.m, errors))
    )
    assert stated.values == exact.values
    for symbol, error in stated.standard_errors.items():
        added = math.sqrt(max(error**2 - exact.standard_errors[symbol] ** 2, 0.0))
        moved = abs(off.values[symbol] - exact.values[symbol])
        # to first order; numbers that hardly move drown in rounding
        assert added == pytest.approx(moved, rel=0.03, abs=1e-3 * error), symbol
    merit = stated.document()["maximum_likelihood"]
    assert merit["m_standard_error_kg"] == pytest.approx(errors)


@pytest.mark.parametrize("noise", [1e-3, 1e-2])
def test_a_weighed_mass_doubts_nothing_that_it_does_not_move(noise):
    """3.098 kg on scales for 3.1 kg: half a per cent is what such a mass is known to."""
    records = forced(noise=noise)
    free = identify(records, PAPER.k)
    weighed, wrong = (identify(records, PAPER.k, mass=m) for m in (2.418, 2.0))
    for found in (free, weighed):
        assert {v.verdict for v in found.verdicts.values()} == {"usable"}
    if not weighed.basis.common.mass_taken:
        assert weighed.values == free.values
        (said,) = (one.numbers["masses"] for one in weighed.rig if one.code == "masses")
        assert said == pytest.approx((2.42, 2.418), abs=5e-3)
    # beside the noise of K_z a sixth of it is nothing
    for symbol, v in wrong.verdicts.items():
        assert v.verdict == "doubtful" or (symbol == "K_z" and v.within > 1.0 - 2.0 / 2.42)
    (why,) = (one for one in wrong.verdicts["F_k"].findings if one.code == "mass")
    assert why.effect[""] == pytest.approx(1.0 - 2.0 / 2.42, abs=0.01)


@pytest.mark.parametrize("drift", [1e-3, 0.04])
def test_a_drift_is_in_the_intervals_and_doubts_nothing(drift):
    """One level's response grows by a thousandth, or by 4 %, with time: its numbers hold within their intervals."""
    records = forced(noise=1e-3)
    t, x = records[0]["displacement"].t, records[0]["displacement"].values
    grown = x * (1.0 + drift * (t / t[-1] - 0.5))
    plain = identify(records, PAPER.k)
    found = identify([changed(records[0], "displacement", values=grown), *records[1:]], PAPER.k)
    assert {"unsettled", "settles"} & {one.code for one in found.findings}
    assert {found.verdicts[s].verdict for s in ("F_k", "c")} == {"usable"}
    for name in ("maximum likelihood", "direct"):
        answer, before = found.approaches[name], plain.approaches[name].standard_errors
        for symbol in ("F_k", "c"):
            low, high = answer.intervals[symbol]
            assert low < getattr(PAPER, symbol) < high, (name, symbol)
            assert answer.standard_errors[symbol] > 1.5 * before[symbol]


@pytest.mark.parametrize(
    ("name", "value", "number", "error"),
    [
        ("mass", "3.1", 3.1, 0.0155),
        ("mass", "0.001 kg", 0.001, 5e-6),
        ("mass", 2, 2.0, 0.01),
        ("mass", np.float64(3.098), 3.098, 0.01549),
        ("mass", "3.1±0.01", 3.1, 0.01),
        ("mass", (3.1, 0.0), 3.1, 0.0),
        ("stiffness", "2310", 2310.0, 0.0),
        ("stiffness", "2310+-10", 2310.0, 10.0),
    ],
)
def test_a_mass_alone_is_known_to_half_a_per_cent_however_it_is_written(name, value, number, error):
    of = OPTIONS[name]
    assert with_error(name, value, of.bounds, of.uncertainty) == pytest.approx((number, error))


@pytest.mark.parametrize(
    "wrong", [(3.1, 3.1), "3.1±x", "±1", "x", "-3", True, (3.1, -0.1), [1.0, 0.1, 0.1]]
)
def test_a_mass_or_an_uncertainty_that_is_none_is_refused(wrong):
    for name in ("stiffness", "mass"):
        with pytest.raises(ValueError, match=f"{name} must be a positive number"):
            identify(measured(), **{"stiffness": 2310.0, name: wrong})


@pytest.mark.parametrize(
    ("of", "error"),
    [
        ("mass_kg", "mass_standard_error_kg"),
        ("stiffness_N_per_m", "stiffness_standard_error_N_per_m"),
    ],
)
def test_a_configuration_states_uncertainties_with_their_numbers(of, error):
    name = of.partition("_")[0]
    assert configured({of: 20.0})[name] == 20.0
    assert configured({of: 20.0, error: 10.0})[name] == (20.0, 10.0)
    assert error not in dict(contradictions({of: 20.0, error: 10.0}))
    for wrong, why in (
        ({"kind": "loops"}, "is for"),
        ({of: None}, of),
        ({of: 10.0}, "must be below"),
    ):
        assert why in dict(contradictions({error: 10.0, **wrong}))[error]


def test_a_light_damping_asks_more_of_the_frequency():
    """Q = 220 at resonance: a frequency that is off by 4e-7 turns the response by more than the noise does."""
    k, levels, sizes = 2.0 * (20.0 * math.pi) ** 2, (2e-5, 4e-5, 6e-5), []
    osc = Oscillator(2.0, 0.5, k, 20.0 * k, 0.05)
    for seed in range(6):
        at = np.random.default_rng(seed)
        records = measured(levels, 10.0, osc, seed=at, cycles=40.0, noise=3e-3)
        merit = identify(records, k).reference.merit
        sizes.append((merit["m_kg"] - osc.m) / merit["m_standard_error_kg"])
    # rms of six normal numbers: above 1.7 once in 400 times
    assert math.sqrt(np.mean(np.square(sizes))) < 1.7
