"""Stated uncertainties: intervals hold what they do to records, and a report says on what its numbers depend."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from dampbalance import identify, measured_ring_down
from dampbalance.records.measurement import Correction
from paper_case import PAPER
from unit.identification.levels import SYMBOLS, changed, measured

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
    return [answer.standard_errors[s] / answer.values[s] for s in SYMBOLS]


@pytest.mark.parametrize(("records", "check"), [(forced, "direct"), (free, "balance")])
def test_all_numbers_are_in_proportion_to_the_stiffness(records, check):
    found = identify(records(), stiffness=(2310.0, 23.1), replicates=20)
    # noise of 1e-5 leaves errors of less than 0.1 %
    for name in ("maximum likelihood", check):
        assert relative(found, name) == pytest.approx([0.01] * 3, rel=5e-3), name
    assert found.covariance.loc["F_k", "c"] == pytest.approx(
        1e-4 * found.values["F_k"] * found.values["c"], rel=1e-2
    )
    merit = found.document()["maximum_likelihood"]
    assert merit["m_standard_error_kg"] / merit["m_kg"] == pytest.approx(0.01, rel=5e-3)


def test_a_force_does_not_ask_for_the_stiffness():
    """m ẍ + c ẋ + k x + F = f: with one frequency k and m are told apart by nothing but harmonics."""
    found = identify(forced(drive="force"), stiffness=(2310.0, 23.1), replicates=20)
    assert relative(found)[0] < 2e-3
    assert relative(found, "direct")[1] < 2e-3


@pytest.mark.parametrize("fault", ["drive", "response", "late"])
def test_an_interval_is_what_such_records_scatter_by(fault):
    """Records that are off by one standard uncertainty give numbers off by what the errors say."""
    quantity = "base_displacement" if fault == "drive" else "displacement"
    uncertain = {"delay_error": 1e-5} if fault == "late" else {"gain_error": 1e-3}
    off = {"delay": 1e-5} if fault == "late" else {"gain": 1.001}
    # so much that the fault does not show
    plain, stated, faulty = (
        identify(forced(errors, noise=1e-3), stiffness=PAPER.k, replicates=20)
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
    off = 1.004 * PAPER.k
    without = identify(forced(), stiffness=off, mass=PAPER.m, replicates=20)
    assert "contradicts" in without.approaches["direct"].verdicts["F_k"].reason
    found = identify(forced(), stiffness=(off, 0.004 * off), mass=PAPER.m, replicates=20)
    assert not any("contradicts" in v.reason for v in found.verdicts.values())
    low, high = found.intervals["F_k"]
    assert low < PAPER.F_k < high


@pytest.mark.parametrize("records", [forced, free])
def test_a_report_says_once_on_what_its_numbers_depend(records):
    words = "All numbers are conditional on the stiffness and the gains"
    known = {"mass": PAPER.m}
    for given, asked in (
        ({}, ("--stiffness 2310±10", "--mass")),
        (known, ("--stiffness 2310±10",)),
        ({"stiffness": "2310±10"}, ("--mass",)),
        ({"stiffness": "2310+-10", **known}, ()),
    ):
        report = identify(records(), **{"stiffness": 2310.0, **given}, replicates=1000).text()
        assert report.count(words) == bool(asked)
        remedies = report.partition(words)[2].partition("To be sure")[2].partition("\n")[0]
        for one in ("2310±10", "--mass"):
            assert (one in remedies) == any(one in a for a in asked)
        if asked:
            assert "1 % in the stiffness changes F_k by +1 %, c by +1 %" in report or known == given


@pytest.mark.parametrize(
    "wrong", [(2310.0, -1.0), (2310.0, 2310.0), "2310±x", (1.0, 2.0, 3.0), "±1"]
)
def test_an_uncertainty_that_is_none_is_refused(wrong):
    with pytest.raises(ValueError, match="stiffness must be a positive number"):
        identify(forced(), stiffness=wrong)
