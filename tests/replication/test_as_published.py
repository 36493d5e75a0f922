"""The simulation and the read-outs behind the printed Tables 1–3, and which printed digits they give.

Nothing here feeds a printed number back: the simulation has the paper's parameters, and the printed tables are compared
at the very end. Scheme, step, cycle and rules of reading were chosen so that they agree.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from dampbalance.features import Features
from dampbalance.project.files import read_csv
from dampbalance.replication import authors_route as authors
from dampbalance.replication.claims import rivals
from dampbalance.replication.clean import of_record
from dampbalance.replication.read_out import ReadOut
from folders import PUBLISHED
from paper_case import FREQUENCIES_HZ, OMEGA, PAPER
from replication.by_hand import missed
from replication.routes import CASE, PRINT, unrounded

STEP = 5.0e-6
PERIOD = 1.0 / FREQUENCIES_HZ["omega1"] / STEP  # steps
numbers = PRINT.values


def records(**changed):
    """The last cycles at every level, as configured but for some of the numerics."""
    case = replace(CASE, numerics=replace(CASE.numerics, **changed))
    return authors.simulate_levels(case, "omega1")


def read(of, reading="sample"):
    return authors.features_of(of, CASE, "omega1", reading)


@pytest.fixture(scope="module")
def simulated():
    return records()


@pytest.fixture(scope="module")
def interpolated(simulated):
    return read(simulated, "interpolated")


@pytest.fixture(scope="module")
def sampled(simulated):
    return read(simulated)


def test_the_coefficients_are_those_of_the_equation_divided_by_m():
    assert authors.printed_coefficients(CASE) == {"c_over_m": 37.19, "k_over_m": 954.545}


def misses(features, **rules):
    """The numbers of Table 3 that features do not give.   rules : of reading, where they are not as configured."""
    read = ReadOut.from_config(CASE.numerics.two_point | rules).common(features)
    inputs = {"X": read.X, "V_s": read.V_s, "phi": read.phi[0], "t_s": read.t_s[0]}
    return missed(way=read.X + read.X_s, **inputs)


# ---- Table 2 --------------------------------------------------------------------------------------------------------


def test_W_of_table_2(sampled):
    assert np.max(np.abs(sampled.W / numbers("W") - 1.0)) < 4e-7
    # With the unrounded coefficients it is five times as far, at every level the same way.
    unrounded = read(records(c_over_m_decimals=None, k_over_m_decimals=None))
    assert np.all(unrounded.W / numbers("W") - 1.0 < -1.5e-6)


def off_print_in_samples(features):
    """a less the printed a, in samples: one moves a by 2 V_s h."""
    return (features.a - numbers("a")) / (2.0 * features.V_s * STEP)


def test_a_of_table_2_to_a_thirtieth_of_a_sample(sampled):
    assert np.max(np.abs(off_print_in_samples(sampled))) < 0.034
    # Half a unit of print is 0.003 to 0.007 of a sample: three of the five are within a unit.
    units = (sampled.a - numbers("a")) / 1e-9
    assert np.count_nonzero(np.abs(units) < 1.0) == 3


@pytest.mark.parametrize("cycles", [22, 25])
def test_no_neighbouring_cycle_gives_a(cycles):
    """Whichever sample a begins at: the grid of samples lies elsewhere in the periods before."""
    off = off_print_in_samples(read(records(cycles=cycles)))
    assert np.min(np.abs(off - np.round(off))) > 0.1


def test_print_lies_between_what_the_19th_and_the_24th_period_give(sampled):
    """Five periods are 0.0325 of a step more than whole steps: no other period simulated is as close to this one."""
    assert 5.0 * PERIOD - round(5.0 * PERIOD) == pytest.approx(0.0325, abs=1e-4)
    half_a_unit = 0.5e-9 / (2.0 * sampled.V_s * STEP)
    assert np.all(off_print_in_samples(read(records(cycles=21))) < half_a_unit)
    assert np.all(off_print_in_samples(sampled) > -half_a_unit)


def test_displacements_of_the_8th_period_give_a_as_well():
    """The cycle is not unique: 2 (x(t_2) − x) there, begun 0, 1, 1, 1, 1 samples after slip is seen, is as close."""
    off = []
    for record, begun, a in zip(records(cycles=10), (0, 1, 1, 1, 1), numbers("a"), strict=True):
        features = of_record(record, OMEGA, PAPER.k, "sample")
        corner = int(np.flatnonzero(record.x == features.X_s[0])[0])
        peak = np.max(record.x[corner : corner + round(0.5 * PERIOD)])
        off.append((2.0 * (peak - record.x[corner + begun]) - a) / (2.0 * features.V_s[0] * STEP))
    assert np.max(np.abs(off)) < 0.034


@pytest.mark.parametrize("scheme", ["rk4", "trapezoidal", "semi-implicit-euler", "explicit-euler"])
def test_no_other_scheme_gives_table_2(scheme):
    """After 6 cycles, in which a transient decays by e⁻²²."""
    features = read(records(scheme=scheme, cycles=6))
    assert np.min(np.abs(features.W / numbers("W") - 1.0)) > 1e-4


# ---- Table 3 --------------------------------------------------------------------------------------------------------


def test_each_rule_decides_a_digit_of_table_3(interpolated):
    assert misses(interpolated) == []
    assert misses(interpolated, common_phi_decimals=None) == ["V_s c 3-4"]
    assert misses(interpolated, X_s_mark_m=None, X_s_decimals=6) == ["X_s c 1-2"]


def test_table_3_hangs_on_the_numerical_dissipation_and_not_on_the_cycle():
    assert len(misses(read(records(scheme="rk4", cycles=6), "interpolated"))) > 20
    for cycles in (11, 20):
        assert misses(read(records(cycles=cycles), "interpolated")) == []


# ---- Recorded rivals: those that the simulations give, which stand for no other case --------------------------------

RECORDED = [read_csv(PUBLISHED / name) for name in rivals.FILES]


def test_what_is_recorded_is_what_is_simulated():
    for recorded, table in zip(RECORDED, (authors.scheme_table, authors.trial_table), strict=True):
        pd.testing.assert_frame_equal(recorded, table(CASE, "omega1"), rtol=1e-11, atol=0.0)


def test_the_records_serve_their_own_case_and_no_other(monkeypatch):
    for name in ("scheme_table", "trial_table"):
        monkeypatch.setattr(rivals, name, lambda *simulated: simulated)

    def served(frame, case=CASE):
        return rivals.rivals(PUBLISHED, case, "omega1", Features.from_frame(frame))

    own, other = unrounded(), replace(CASE, oscillator=replace(CASE.oscillator, c=90.001))
    for table, recorded in zip(served(own), RECORDED, strict=True):
        pd.testing.assert_frame_equal(table, recorded)
    one = 1e-8 * (own.index == 2)
    for frame in (own.head(4), *(own.assign(**{n: own[n] * (1.0 + one)}) for n in ("a_m", "W_J"))):
        assert served(frame) == ((CASE, "omega1"),) * 2
    assert served(own, other) == ((other, "omega1"),) * 2
