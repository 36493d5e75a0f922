"""One oscillator for the harmonics of several records: exact in every regime, with the errors that noise makes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.fit.goodness import improbable, linear_fit
from dampbalance.fit.multistart import Trail
from dampbalance.fit.parameters import Parameters
from dampbalance.fit.starts import starts
from dampbalance.fit.steady_search import fit_records, refit
from dampbalance.fit.waveforms import HarmonicProblem, WaveformFit
from dampbalance.law.law import Law
from dampbalance.motion.regime import Regime
from dampbalance.signals.thresholds import P_OF_THE_MODEL
from fit import exact
from fit.sampled import covariance
from paper_case import FREQUENCIES_HZ, LEVELS, NEAR, PAPER, motions_at, orbits_at
from signals.harmonics import lines_of

WEAK = Oscillator(m=2.42, c=3.0, k=2310.0, K_z=69_300.0, F_k=1.28)  # ζ = 0.02: slips several times
EXACT = 1e-8  # m
# standard errors: the climb ends where a step would gain 5e-8 of half of χ², 3e-4 of one
CLOSE = 1e-3


def off(fit: WaveformFit, osc: Oscillator) -> float:
    """How far the unknowns are from the truth, in standard errors: the farthest of them."""
    return exact.off(fit, F_k=osc.F_k, c=osc.c, rho=osc.K_z**-0.5, m=osc.m)


@pytest.mark.parametrize(
    ("osc", "at", "regimes"),
    [
        (PAPER, [(4.92, Y) for Y in LEVELS], {1}),
        (PAPER, [(3.5, 0.004), (4.92, 0.008), (11.1, 0.012)], {1}),
        (PAPER, [(4.92, 0.012)], {1}),
        (PAPER, [(4.92, 0.0003), (4.92, 0.004), (4.92, 0.012)], {1, 3}),
        (replace(WEAK, c=10.0), [(1.6, 0.0008), (1.6, 0.0014)], {1, 2}),
        (replace(PAPER, K_z=2e8), [(4.92, Y) for Y in LEVELS], {1}),  # sticks for 1e-3 of a cycle
        (replace(PAPER, c=400.0), [(4.92, Y) for Y in LEVELS], {1}),  # over-damped in slip
        (Oscillator(2.0, 30.0, 2000.0, 6000.0, 4.0), [(6.0, Y) for Y in LEVELS[::2]], {1}),
    ],
    ids=["near", "mixed", "one", "stuck level", "slips differ", "hard", "ζ>1", "soft"],
)
def test_exact_harmonics_give_the_exact_oscillator_in_every_regime(osc, at, regimes):
    orbits = [steady_orbit(osc, BaseMotion(Y, 2.0 * math.pi * hz)) for hz, Y in at]
    assert {int(orbit.regime) for orbit in orbits} == regimes
    fit = fit_records([lines_of(orbit, EXACT) for orbit in orbits], osc.k)
    assert off(fit, osc) < CLOSE
    assert fit.chi_square < 1e-5
    assert fit.adequate
    assert not fit.rigid
    slips = [one.slips for one in fit.responses]
    assert slips == [orbit.regime != Regime.NO_SLIP for orbit in orbits]
    assert fit.freedom == len(at) * (2 + 2 * 12) - 4 - 2 * len(at)
    assert fit.natural_frequency_hz == pytest.approx(osc.omega_n / (2.0 * math.pi), rel=1e-5)
    for waveform, orbit in zip(fit.waveforms, orbits, strict=True):
        if orbit.regime == Regime.NO_SLIP:
            continue
        travel = 4.0 * orbit.X - orbit.a  # that sticking takes
        assert waveform.onset == pytest.approx([orbit.V_s, orbit.t_s, travel], rel=2e-4)
        # odd harmonics beyond those that were given
        beyond = orbit.harmonics(30)[12:]
        assert waveform.tail[12:30] == pytest.approx(beyond, abs=1e-4 * abs(beyond[0]) + EXACT)


def residuals() -> tuple[HarmonicProblem, Parameters]:
    """Residuals of one record, and the unknowns of its oscillator."""
    (orbit,) = orbits_at(NEAR, [0.004])
    problem = HarmonicProblem(Law(), (lines_of(orbit, EXACT),), PAPER.k)
    rho = PAPER.K_z**-0.5
    return problem, problem.parameters.moved(F_k=PAPER.F_k, c=PAPER.c, rho=rho, m=PAPER.m)


def evaluated(of: HarmonicProblem, at: Parameters) -> np.ndarray | None:
    """What the problem gives there, from nothing."""
    return of.evaluate(at.values, at.free, Trail())


@pytest.mark.parametrize(
    ("name", "value"),
    [("m", -1.0), ("F_k", math.nan), ("c", math.inf), ("rho", 0.0), ("rho", 1e-200)],
)
def test_numbers_that_no_oscillator_has_are_no_motion(name, value):
    of, at = residuals()
    assert evaluated(of, at) is not None
    assert evaluated(of, at.moved(**{name: value})) is None


def test_what_was_evaluated_before_changes_no_residual():
    """A motion is the same whether it is found from nothing or from another one."""
    of, at = residuals()
    trail, alone = Trail(), evaluated(of, at)
    of.evaluate(at.moved(F_k=0.5 * PAPER.F_k, c=2.0 * PAPER.c).values, at.free, trail)
    again = of.evaluate(at.values, at.free, trail)
    assert again[:, -1] == pytest.approx(alone[:, -1], abs=1e-3)  # standard errors
    trail.left = 0.0
    assert of.evaluate(at.values, at.free, trail) is None


def test_slopes_are_those_of_orbits_beside():
    """Against central differences of exact orbits, by every unknown."""
    at = [(1.6, 0.0014), (2.0, 0.0014)]
    orbits = [steady_orbit(WEAK, BaseMotion(Y, 2.0 * math.pi * hz)) for hz, Y in at]
    fit = fit_records([lines_of(orbit, EXACT) for orbit in orbits], WEAK.k)
    count = 20

    def of(point: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray, float]:
        F_k, c, rho, m = point[:4]
        Y, psi = (point[fit.parameters.places[f"{name}[{i + 1}]"]] for name in ("Y", "psi"))
        osc = Oscillator(m=m, c=c, k=WEAK.k, K_z=rho**-2, F_k=F_k)
        orbit = steady_orbit(osc, BaseMotion(Y, fit.lines[i].omega))
        n = np.arange(1, 2 * count, 2)
        onset = np.array([orbit.V_s, orbit.t_s, 4.0 * orbit.X - orbit.a])
        return orbit.harmonics(count) * np.exp(1j * n * psi), onset, 2.0 * F_k * rho**2

    for i, waveform in enumerate(fit.waveforms):
        slopes = (waveform.tail_slope[:count], waveform.onset_slope, waveform.length_slope[None])
        for j in np.flatnonzero(fit.parameters.free):
            size = abs(fit.point[j] or 1.0)
            beside = 1e-5 * size * np.eye(fit.point.size)[j]
            high, low = of(fit.point + beside, i), of(fit.point - beside, i)
            for slope, above, below in zip(slopes, high, low, strict=True):
                expected = (above - below) / (2.0 * beside[j])
                # one-sided differences of 1e-6 times the curvature, a few to some tens
                scale = max(np.abs(expected).max(), np.abs(above).max() / size)
                assert np.abs(slope[:, j] - expected).max() < 5e-5 * scale


def test_what_moves_a_datum_moves_the_answer_as_the_response_says():
    """Against fits to the moved data."""
    lines = [lines_of(orbit, 1e-6) for orbit in orbits_at(3.5, (0.006, 0.012))]
    fit = fit_records(lines, PAPER.k)
    errors = np.sqrt(np.diag(fit.covariance))
    free, by = errors > 0.0, 1e-6 * np.eye(2, 12)
    for i, place in enumerate(fit.problem.places):
        # real parts of the twelve harmonics, and imaginary ones, follow on the amplitude and the phase of the base
        for datum, name, change in ((0, "Y", 1e-6), (3, "x", by[1]), (2 + 12, "x", 1j * by[0])):
            moved = list(lines)
            moved[i] = replace(lines[i], **{name: getattr(lines[i], name) + change})
            away = fit_records(moved, PAPER.k).point - fit.point - fit.response[:, place][:, datum]
            # a standard deviation is within the straight part, to 1 % of what moves
            assert np.abs(away[free] / errors[free]).max() < 0.01


def test_the_length_of_the_line_is_freed_of_its_bias():
    # 10,000 N/mm: ρ stands three standard errors above zero
    stiff, rng = replace(PAPER, K_z=1e7), np.random.default_rng(4)
    orbits = orbits_at(NEAR, (0.004, 0.012), stiff)
    fits = [
        fit_records([lines_of(o, 7e-7, rng, count=8) for o in orbits], stiff.k) for _ in range(60)
    ]
    lengths = np.array([fit.waveforms[0].length for fit in fits])
    true, error = 2.0 * stiff.F_k / stiff.K_z, lengths.std(ddof=1) / math.sqrt(60)
    assert abs(lengths.mean() - true) < 3.0 * error
    rho = np.array([fit.rho for fit in fits])
    # what is taken off is what the scatter of ρ adds to ρ²; 60 draws know it to 18 %
    off = np.mean([2.0 * fit.F_k * fit.rho**2 for fit in fits]) - lengths.mean()
    assert off == pytest.approx(2.0 * stiff.F_k * rho.var(ddof=1), rel=0.55)
    assert off > 0.02 * true
    slopes = np.array([fit.waveforms[0].length_slope for fit in fits])
    variances = [slope @ fit.covariance @ slope for slope, fit in zip(slopes, fits, strict=True)]
    assert math.sqrt(np.mean(variances)) == pytest.approx(lengths.std(ddof=1), rel=0.3)


@pytest.mark.parametrize(("hz", "free"), [(4.92, ("m",)), (3.5, ()), (11.1, ("m",))])
def test_errors_are_those_of_the_cramer_rao_bound(hz, free):
    rate_hz, cycles, sigma = 4000.0, 50.0, 1e-6
    # standard deviation of a Fourier coefficient of n samples: σ √(2/n)
    error = sigma * math.sqrt(2.0 / round(rate_hz * cycles / hz))
    levels = (0.006, 0.012)
    fit = fit_records([lines_of(o, error, count=40) for o in orbits_at(hz, levels)], PAPER.k)
    if "m" not in free:
        fit = refit(fit, given={"m": PAPER.m})
    noise = {"y": sigma, "x": sigma}
    bound = covariance(PAPER, motions_at(hz, levels), rate_hz, cycles, noise, free)
    # 40 odd harmonics hold all but 1e-3 of what the onset of slip tells; differences of the derivatives 1e-6
    errors = [fit.error("F_k"), fit.error("c"), fit.K_z_error, fit.error("m")][: len(bound)]
    assert errors == pytest.approx(np.sqrt(np.diag(bound)), rel=0.01)
    known = [2.0 * (one.rows - 1) for one in fit.lines] + [one.error_freedom for one in fit.lines]
    assert min(known) <= fit.freedom_of("F_k") <= sum(known)  # Welch–Satterthwaite


def test_limits_are_reached_and_said():
    rng = np.random.default_rng(3)
    orbits = orbits_at(11.1, (0.006, 0.012), replace(PAPER, c=0.0))
    fits = [fit_records([lines_of(o, 1e-6, rng) for o in orbits], PAPER.k) for _ in range(8)]
    assert all(fit.c >= 0.0 for fit in fits)
    assert {fit.c == 0.0 for fit in fits} == {True, False}  # noise puts c on either side
    stiff = orbits_at(NEAR, osc=replace(PAPER, K_z=1e9))
    hard = [fit_records([lines_of(o, 2e-5, rng) for o in stiff], PAPER.k) for _ in range(8)]
    assert {fit.rigid for fit in hard} == {True, False}
    for fit in hard:
        assert math.isinf(fit.K_z) == math.isinf(fit.K_z_error) == fit.rigid
        assert fit.K_z_interval[0] < 1e9 < fit.K_z_interval[1] == math.inf
        assert abs(fit.F_k - PAPER.F_k) < 4.0 * fit.error("F_k")


def test_records_of_another_kind_are_not_adequate():
    orbits = orbits_at(NEAR, (0.004, 0.012))
    odd = [lines_of(orbit, 1e-6) for orbit in orbits]
    x = odd[0].x.copy()
    x[2] += 2e-5  # twenty standard deviations, of one harmonic
    fit = fit_records([replace(odd[0], x=x), odd[1]], PAPER.k)
    assert not fit.adequate
    assert fit.misfits[0] > 3.0 * fit.misfits[1]
    assert fit.chi_square == pytest.approx(float(fit.residual @ fit.residual))
    sizes = [place.stop - place.start for place in fit.problem.places]
    assert fit.misfits @ sizes == pytest.approx(fit.chi_square)


def test_nothing_is_found_where_the_response_gives_energy_or_nothing_slips():
    lines = lines_of(*orbits_at(NEAR, (0.008,)), EXACT)
    assert fit_records([replace(lines, x=lines.x.conj())], PAPER.k) is None
    assert refit(fit_records([lines], PAPER.k), given={"m": 1e6}) is None


@pytest.mark.parametrize("hz", FREQUENCIES_HZ.values())
def test_the_first_start_is_near_the_oscillator(hz):
    first = starts([lines_of(orbit, 1e-6) for orbit in orbits_at(hz)], PAPER.k)[0]
    true = np.array([PAPER.F_k, PAPER.c, PAPER.K_z, PAPER.m])
    # the grid of stiffnesses has steps of 2.15; the others follow from the work and the part in phase
    assert np.abs(np.log(first / true))[[0, 1, 3]].max() < 0.1
    assert 0.4 < first[2] / PAPER.K_z < 2.5


def test_the_wide_search_starts_once_from_each_stiffness_with_masses_beyond_the_fundamental():
    lines = [lines_of(orbit, 1e-6) for orbit in orbits_at(NEAR, (0.008,))]
    few, many = (starts(lines, PAPER.k, wide=wide) for wide in (False, True))
    assert len(np.unique(many[:, 2])) == len(many) < len(few)
    # three decades of masses on the grid, each compared by its exact orbit
    assert not np.isclose(many[:, 3, None], few[:, 3], rtol=1e-6).any(axis=1).all()


LINEAR = replace(PAPER, F_k=0.0)


@pytest.mark.parametrize("hertz", [(4.92, 4.92, 4.92), (3.5, 4.92, 11.1)], ids=["one", "three"])
def test_a_linear_oscillator_is_one_whatever_it_weighs(hertz):
    orbits = [orbits_at(hz, (Y,), LINEAR)[0] for hz, Y in zip(hertz, LEVELS, strict=False)]
    exact = [lines_of(orbit, 1e-6) for orbit in orbits]
    fit = linear_fit(exact, PAPER.k)
    assert fit.chi_square < 1e-6
    # c, and one stiffness of the part in phase where there is one frequency, two where there are more
    unknowns = 2 if len(set(hertz)) == 1 else 3
    assert fit.freedom == 3 * 2 * 12 - unknowns
    other = [replace(exact[0], x=1.01 * exact[0].x), *exact[1:]]
    assert linear_fit(other, PAPER.k).chi_square > 100.0


def test_a_contact_that_only_sticks_has_the_stiffness_it_has():
    rng = np.random.default_rng(5)
    stuck = [lines_of(o, 1e-9, rng) for o in orbits_at(NEAR, (0.0002, 0.0003))]
    loose = [lines_of(o, 1e-6, rng) for o in orbits_at(NEAR, LEVELS, LINEAR)]
    # one frequency tells a stiffness from an inertia where the mass is known
    assert linear_fit(stuck, PAPER.k).sticks is None
    of_stuck, of_loose = (linear_fit(of, PAPER.k, m=PAPER.m) for of in (stuck, loose))
    assert of_stuck.sticks is True
    assert abs(of_stuck.contact - PAPER.K_z) < 4.0 * of_stuck.contact_error < 0.1 * PAPER.K_z
    assert of_loose.sticks is False
    assert abs(of_loose.contact) < 4.0 * of_loose.contact_error < 0.01 * PAPER.k
    # of a mass that is 10 % off, K is off by ω² times that
    wrong = linear_fit(loose, PAPER.k, m=0.9 * PAPER.m, m_error=0.1 * PAPER.m)
    omega = 2.0 * math.pi * NEAR
    assert wrong.contact == pytest.approx(-0.1 * PAPER.m * omega**2, rel=0.01)
    assert wrong.contact_error == pytest.approx(-wrong.contact, rel=0.01)


@pytest.mark.parametrize(("freedom", "rows"), [(2, 8), (40, 60)])
def test_a_misfit_is_improbable_where_an_F_distribution_says_so(freedom, rows):
    (orbit,) = orbits_at(NEAR, (0.008,))
    lines = [lines_of(orbit, 1e-6, rows=rows)] * 2
    # six degrees of freedom of the errors a row: that of a harmonic has two, and its neighbours share it
    border = freedom * stats.f.isf(P_OF_THE_MODEL, freedom, 2 * 6 * (rows - 1))
    assert improbable(1.001 * border, freedom, lines)
    assert not improbable(0.999 * border, freedom, lines)
    assert not improbable(1e9, 0, lines)
