"""What the records are, taken together: an oscillator, a linear one, one out of time, or nothing of the kind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dampbalance.findings.finding import UNBOUNDED, Finding
from dampbalance.identification.answer import doubted
from dampbalance.identification.oscillator import CommonFit, common_fit, with_common_fit
from identification.levels import read
from paper_case import NEAR, PAPER, orbits_at
from signals.harmonics import lines_of

LEVELS = (0.004, 0.012)
SIGMA = 1e-6  # m


def lines(osc=PAPER, levels=LEVELS, hz=NEAR, seed=1, sigma=SIGMA, **changed):
    rng = np.random.default_rng(seed)
    return [lines_of(orbit, sigma, rng, **changed) for orbit in orbits_at(hz, levels, osc)]


def test_records_of_an_oscillator_are_one_and_nothing_else():
    whole = common_fit(lines(), PAPER.k)
    assert whole.waveforms_hold
    assert whole.stuck is None
    assert whole.clear == ()
    for name in ("F_k", "c", "m"):
        assert abs(getattr(whole.fit, name) - getattr(PAPER, name)) < 4.0 * whole.fit.error(name)


@pytest.mark.parametrize(
    ("osc", "levels"),
    [(replace(PAPER, F_k=0.0), LEVELS), (PAPER, (0.0002, 0.0003))],
    ids=["no friction", "only sticks"],
)
def test_linear_records_are_linear(osc, levels):
    for seed in range(2):
        whole = common_fit(lines(osc, levels, seed=seed), PAPER.k)
        assert whole.stuck is not None
        assert not whole.waveforms_hold


def test_slip_that_shows_is_no_linear_oscillator_and_slip_that_noise_hides_is_one():
    slight = replace(PAPER, F_k=0.1)
    assert common_fit(lines(slight), PAPER.k).stuck is None
    assert common_fit(lines(slight, sigma=1e-3), PAPER.k).stuck is not None


@pytest.mark.parametrize(("mass", "fits"), [(PAPER.m, True), (1.02 * PAPER.m, False)])
def test_a_mass_is_taken_where_the_records_agree_with_it(mass, fits):
    free = common_fit(lines(), PAPER.k).fit
    assert abs(mass - free.m) > 16.0 * free.error("m") or fits
    whole = common_fit(lines(), PAPER.k, mass)
    assert (whole.mass, whole.mass_fits) == (mass, fits)
    assert whole.notes == ()
    assert whole.waveforms_hold
    assert whole.mass_taken == fits
    if fits:
        assert (whole.fit.m, whole.fit.error("m")) == (mass, 0.0)
    else:
        np.testing.assert_array_equal(whole.fit.point, free.point)


def test_the_fit_takes_a_mass_only_where_it_is_known_better_than_the_records_know_it():
    free = common_fit(lines(), PAPER.k).fit
    error = free.error("m")
    for part in (0.5, 2.0):
        whole = common_fit(lines(), PAPER.k, PAPER.m, mass_error=part * error)
        assert whole.mass_taken == (part < 1.0)
        assert whole.mass_fits
    # 8 errors of the records alone, and 3.6 of the difference: √(1 + 2²) times as large
    for uncertain, agrees in ((0.0, False), (2.0 * error, True)):
        mass = free.m + 8.0 * error
        whole = common_fit(lines(), PAPER.k, mass, mass_error=uncertain)
        assert (whole.mass_fits, whole.mass_taken) == (agrees, False)
        np.testing.assert_array_equal(whole.fit.point, free.point)


@pytest.mark.parametrize("mass", [None, PAPER.m])
def test_a_delay_is_said_where_it_explains_more_than_noise_would(mass):
    whole = common_fit(lines(late=1e-3, sigma=1e-7), PAPER.k, mass)
    assert whole.clear == ("delay",)
    value, error = whole.delay
    assert abs(value - 1e-3) < 4.0 * error
    assert abs(whole.fit.c - PAPER.c) < 4.0 * whole.fit.error("c")
    found = [common_fit(lines(seed=seed), PAPER.k, mass) for seed in range(4)]
    assert not any(whole.clear for whole in found)
    assert max(abs(value / error) for value, error in (whole.delay for whole in found)) < 4.0


def test_readings_share_the_waveforms_that_hold_and_have_none_where_none_do():
    readings = read(orbits_at(NEAR, LEVELS))
    whole = common_fit([reading.lines for reading in readings], PAPER.k)
    shared = with_common_fit(readings, whole)
    assert [reading.waveform for reading in shared] == list(whole.fit.waveforms)
    assert all(reading.slips for reading in shared)
    without = with_common_fit(readings, replace(whole, selection=None))
    assert [reading.waveform for reading in without] == [None, None]
    assert [reading.slips for reading in without] == [None, None]


def test_a_search_that_did_not_converge_is_said():
    whole = common_fit(lines(), PAPER.k)
    assert whole.fit.converged
    assert whole.notes == ()
    # 1.4 standard errors further on
    ended = CommonFit.of(replace(whole.fit, promise=1.0))
    early = (Finding("not converged", effect=UNBOUNDED),)
    assert ended.notes == early
    judged = doubted({"fit": ended.answer}, [])["fit"].verdicts["F_k"]
    assert (judged.verdict, judged.findings) == ("doubtful", early)
