"""One oscillator for the harmonics of several records: exact in every regime, with the errors that noise makes."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.fit import steady_search as fitting
from dampbalance.fit.climb import climb
from dampbalance.fit.multistart import Trail
from dampbalance.fit.parameters import Parameters
from dampbalance.fit.steady_search import fit_records, refit
from dampbalance.fit.waveforms import HarmonicProblem, WaveformFit
from dampbalance.law.law import Law
from dampbalance.motion.law_steady import Response, steady_response
from dampbalance.motion.regime import Regime
from fit.sampled import covariance
from paper_case import FREQUENCIES_HZ, LEVELS, NEAR, PAPER, motions_at, orbits_at
from signals.harmonics import lines_of

WEAK = Oscillator(m=2.42, c=3.0, k=2310.0, K_z=69_300.0, F_k=1.28)  # ζ = 0.02: slips several times
NAMES = ("F_k", "c", "rho", "m")
EXACT = 1e-8  # m
# standard errors: the climb ends where a step would gain 5e-8 of half of χ², 3e-4 of one
CLOSE = 1e-3


def off(fit: WaveformFit, osc: Oscillator) -> np.ndarray:
    """F_k, c, K_z^{−1/2} and, unless it was given, m of the fit less the truth, in standard errors."""
    true = (osc.F_k, osc.c, osc.K_z**-0.5, osc.m)
    known = [(name, at) for name, at in zip(NAMES, true, strict=True) if fit.error(name)]
    return np.array([(fit.value(name) - at) / fit.error(name) for name, at in known])


@pytest.mark.parametrize(
    ("osc", "at", "regimes"),
    [
        *[(PAPER, [(hz, Y) for Y in LEVELS], {1}) for hz in FREQUENCIES_HZ.values()],
        (PAPER, [(3.5, 0.004), (4.92, 0.008), (11.1, 0.012)], {1}),
        (PAPER, [(4.92, 0.012)], {1}),
        (PAPER, [(4.92, 0.0003), (4.92, 0.004), (4.92, 0.012)], {1, 3}),
        (replace(WEAK, c=10.0), [(1.6, 0.0008), (1.6, 0.0014)], {1, 2}),
        (WEAK, [(1.6, 0.0008), (1.6, 0.0014)], {2}),
        (replace(PAPER, K_z=2e8), [(4.92, Y) for Y in LEVELS], {1}),  # sticks for 1e-3 of a cycle
        (replace(PAPER, c=400.0), [(4.92, Y) for Y in LEVELS], {1}),  # over-damped in slip
    ],
    ids=["4.92", "3.5", "11.1", "mixed", "one", "stuck level", "slips differ", "slips", "hard", "ζ>1"],
)  # fmt: skip
def test_exact_harmonics_give_the_exact_oscillator_in_every_regime(osc, at, regimes):
    orbits = [steady_orbit(osc, BaseMotion(Y, 2.0 * math.pi * hz)) for hz, Y in at]
    assert {int(orbit.regime) for orbit in orbits} == regimes
    fit = fit_records([lines_of(orbit, EXACT) for orbit in orbits], osc.k)
    assert np.abs(off(fit, osc)).max() < CLOSE
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


@pytest.mark.parametrize(
    ("osc", "hz", "regime"),
    [
        *((PAPER, hz, Regime.ONE_SLIP) for hz in FREQUENCIES_HZ.values()),
        (Oscillator(m=2.0, c=30.0, k=2000.0, K_z=6000.0, F_k=4.0), 6.0, Regime.ONE_SLIP),  # soft
        (Oscillator(2.42, 3.0, 2310.0, 2e4, 5.0), 0.8, Regime.SEVERAL_SLIPS),
    ],
)
def test_a_fit_holds_from_starts_that_need_no_orbits(osc, hz, regime):
    orbits = orbits_at(hz, (0.004, 0.008, 0.012), osc)
    assert orbits[-1].regime == regime
    fit = fit_records([lines_of(orbit, EXACT) for orbit in orbits], osc.k)
    assert fit.adequate
    assert np.abs(off(fit, osc)).max() < 1e-2


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


@pytest.mark.parametrize(
    ("error", "hidden"),
    [
        (ZeroDivisionError("float division by zero"), True),
        (OverflowError("math range error"), True),
        (np.linalg.LinAlgError("Singular matrix"), True),
        (ValueError("operands could not be broadcast together"), False),
        (IndexError("index 3 is out of bounds"), False),
    ],
)
def test_a_defect_is_not_taken_for_a_point_without_motion(error, hidden, monkeypatch):
    def failing(*_, **__):
        raise error

    of, at = residuals()
    monkeypatch.setattr("dampbalance.motion.law_steady.steady_orbit_near", failing)
    if hidden:
        assert evaluated(of, at) is None
    else:
        with pytest.raises(type(error)):
            evaluated(of, at)


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
        for j in np.flatnonzero(fit.parameters.free):
            step = 1e-5 * (fit.point[j] or 1.0)
            beside = np.zeros(fit.point.size)
            beside[j] = step
            high, low = of(fit.point + beside, i), of(fit.point - beside, i)
            for slope, above, below in zip(
                (
                    waveform.tail_slope[:count, j],
                    waveform.onset_slope[:, j],
                    waveform.length_slope[j],
                ),
                high,
                low,
                strict=True,
            ):
                expected = (above - below) / (2.0 * step)
                # one-sided differences of 1e-6 times the curvature, a few to some tens
                scale = np.abs(above).max() / abs(fit.point[j] or 1.0)
                assert np.abs(slope - expected).max() < 5e-5 * max(np.abs(expected).max(), scale)


def test_what_moves_a_datum_moves_the_answer_as_the_response_says():
    """Against fits to the moved data."""
    lines = [lines_of(orbit, 1e-6) for orbit in orbits_at(3.5, (0.006, 0.012))]
    fit = fit_records(lines, PAPER.k)
    for i, place in enumerate(fit.problem.places):
        for datum, change in (
            (0, {"Y": 1e-6}),
            (2, {"x": np.eye(1, 12)[0] * 1e-6}),
            (3, {"x": np.eye(1, 12, 1)[0] * 1e-6}),
            (2 + 12, {"x": np.eye(1, 12)[0] * 1e-6j}),
            (2 + 13, {"x": np.eye(1, 12, 1)[0] * 1e-6j}),
        ):
            moved = list(lines)
            moved[i] = replace(
                lines[i], **{name: getattr(lines[i], name) + by for name, by in change.items()}
            )
            beside = fit_records(moved, PAPER.k)
            expected = fit.response[:, place][:, datum]
            errors = np.sqrt(np.diag(fit.covariance))
            free = errors > 0.0
            # a standard deviation is within the straight part, to 1 % of what moves
            assert np.abs((beside.point - fit.point - expected)[free] / errors[free]).max() < 0.01


@pytest.fixture(scope="module")
def draws() -> list[WaveformFit]:
    """Fits to 60 sets of three noisy records."""
    rng = np.random.default_rng(12)
    orbits = orbits_at(3.5, (0.004, 0.008, 0.012))
    return [
        fit_records([lines_of(o, 2e-5, rng, count=8) for o in orbits], PAPER.k) for _ in range(60)
    ]


def test_the_misfit_is_that_of_noise(draws):
    freedom = 3 * 16 + 3 * 2 - 4 - 3 * 2
    assert {fit.freedom for fit in draws} == {freedom}
    # χ² of f degrees of freedom scatters by √(2f); 60 draws: three standard errors of the mean, 25 % for the scatter
    misfits = np.array([fit.misfit for fit in draws])
    assert misfits.mean() == pytest.approx(1.0, abs=3.0 * math.sqrt(2.0 / freedom / 60))
    assert misfits.std() == pytest.approx(math.sqrt(2.0 / freedom), rel=0.3)
    assert all(fit.adequate for fit in draws)
    for fit in draws[:3]:
        assert fit.chi_square == pytest.approx(float(fit.residual @ fit.residual))
        sizes = [place.stop - place.start for place in fit.problem.places]
        assert fit.misfits @ sizes == pytest.approx(fit.chi_square)


def test_estimates_scatter_about_the_truth_as_their_errors_say(draws):
    z = np.array([off(fit, PAPER) for fit in draws])
    # 60 draws: three standard errors of mean and scatter
    assert np.abs(z.mean(axis=0)).max() < 3.0 / math.sqrt(60)
    assert np.abs(z.std(axis=0, ddof=1) - 1.0).max() < 3.0 / math.sqrt(2 * 59)
    held = [low < PAPER.K_z < high for low, high in (fit.K_z_interval for fit in draws)]
    assert np.mean(held) > 0.95 - 3.0 * math.sqrt(0.95 * 0.05 / 60)


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


@pytest.mark.parametrize("hz", FREQUENCIES_HZ.values())
@pytest.mark.parametrize("free", [("m",), ()], ids=["m free", "m given"])
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


def test_a_mass_that_is_given_sharpens_what_it_agrees_with_and_contradicts_what_it_does_not():
    rng = np.random.default_rng(2)
    free = fit_records([lines_of(o, 1e-5, rng) for o in orbits_at(11.1)], PAPER.k)
    right, wrong = (refit(free, given={"m": m}) for m in (PAPER.m, 1.1 * PAPER.m))
    assert (right.m, right.error("m")) == (PAPER.m, 0.0)
    assert right.freedom == free.freedom + 1
    for name in ("F_k", "c", "rho"):
        assert right.error(name) <= free.error(name) * (1.0 + 1e-6)
    # χ² rises by the square of the distance in standard errors, near the minimum
    z = (PAPER.m - free.m) / free.error("m")
    assert right.chi_square - free.chi_square == pytest.approx(z**2, rel=0.02, abs=1e-3)
    assert wrong.chi_square - free.chi_square > 100.0


@pytest.mark.parametrize(
    ("late", "mass"), [(2e-4, None), (-2e-4, PAPER.m)], ids=["m free", "m given"]
)
def test_a_delay_between_the_channels_is_found(late, mass):
    rng = np.random.default_rng(7)
    late_lines = [lines_of(o, 5e-8, rng, late=late) for o in orbits_at(4.92, (0.004, 0.01))]
    fit = fit_records(late_lines, PAPER.k)
    if mass is not None:
        fit = refit(fit, given={"m": mass})
    assert fit.value("delay") == 0.0
    delayed = refit(fit, ["delay"])
    assert delayed.freedom == fit.freedom - 1
    assert delayed.adequate
    assert abs(delayed.value("delay") - late) < 4.0 * delayed.error("delay")
    assert delayed.error("delay") < 0.2 * abs(late)
    assert np.abs(off(delayed, PAPER)).max() < 4.0
    assert (delayed.error("m") == 0.0) == (mass is not None)
    assert fit.chi_square - delayed.chi_square > 50.0  # what the free delay explains


def test_limits_are_reached_and_said():
    rng = np.random.default_rng(3)
    orbits = orbits_at(11.1, (0.006, 0.012), replace(PAPER, c=0.0))
    fits = [fit_records([lines_of(o, 1e-6, rng) for o in orbits], PAPER.k) for _ in range(8)]
    assert all(fit.c >= 0.0 for fit in fits)
    assert {fit.c == 0.0 for fit in fits} == {True, False}  # noise puts c on either side
    hard = [
        fit_records(
            [lines_of(o, 2e-5, rng) for o in orbits_at(NEAR, osc=replace(PAPER, K_z=1e9))], PAPER.k
        )
        for _ in range(8)
    ]
    assert {fit.rigid for fit in hard} == {True, False}
    for fit in hard:
        assert math.isinf(fit.K_z) == fit.rigid
        assert math.isinf(fit.K_z_error) == fit.rigid
        assert fit.K_z_interval[0] < 1e9 < fit.K_z_interval[1] == math.inf
        assert abs(fit.F_k - PAPER.F_k) < 4.0 * fit.error("F_k")


@pytest.mark.parametrize("apart", [0.6, 1.5])
def test_from_a_side_minimum_along_the_stiffness_the_search_goes_on(apart, monkeypatch):
    """The stuck mass rings several times: a K_z with which it rings once more, or less, is a minimum of χ², too."""
    osc, rng = replace(WEAK, F_k=2.5), np.random.default_rng(11)
    motions = [BaseMotion(Y, osc.omega_n / 5.0) for Y in (0.0012, 0.002)]
    orbits = [steady_orbit(osc, motion) for motion in motions]
    assert max(Response(orbit, 0.0).swings for orbit in orbits) > 3.0
    lines = [lines_of(orbit, 1e-3 * orbit.X, rng) for orbit in orbits]
    # all starts have a wrong K_z
    wrong = np.array([[osc.F_k, osc.c, apart * osc.K_z, osc.m]])
    monkeypatch.setattr(fitting, "starts", lambda *_, **options: wrong)
    fit = fit_records(lines, osc.k)
    assert fit.adequate
    assert np.abs(off(fit, osc)).max() < 4.0
    monkeypatch.setattr("dampbalance.fit.multistart.minima_along", lambda *_: [])
    assert not fit_records(lines, osc.k).adequate


def test_a_search_for_a_stiff_contact_with_many_slips_ends():
    """Light damping at a superharmonic resonance, much noise: K_z may run away, and each orbit takes longer."""
    osc, rng = replace(WEAK, c=0.9, F_k=0.6), np.random.default_rng(7)
    motions = [BaseMotion(Y, osc.omega_n / 5.0) for Y in (0.0006, 0.0009)]
    orbits = [steady_orbit(osc, motion) for motion in motions]
    assert orbits[0].regime is Regime.SEVERAL_SLIPS
    lines = [lines_of(orbit, 0.02 * orbit.X, rng) for orbit in orbits]
    began = time.process_time()
    fit = fit_records(lines, osc.k)
    assert time.process_time() - began < 60.0  # it takes a few seconds; each orbit alone could
    assert fit.converged == (fit.promise < 5e-3)
    assert fit.K_z_interval[0] < osc.K_z


def test_records_of_another_kind_are_not_adequate():
    orbits = orbits_at(NEAR, (0.004, 0.012))
    odd = [lines_of(orbit, 1e-6) for orbit in orbits]
    x = odd[0].x.copy()
    x[2] += 2e-5  # twenty standard deviations, of one harmonic
    fit = fit_records([replace(odd[0], x=x), odd[1]], PAPER.k)
    assert not fit.adequate
    assert fit.misfits[0] > 3.0 * fit.misfits[1]


def test_a_search_that_leads_nowhere_ends_and_keeps_the_nearest(monkeypatch):
    orbits = orbits_at(3.5, (0.004, 0.008, 0.012))
    lines = [lines_of(orbit, 1e-6) for orbit in orbits]
    turned = [lines[0], replace(lines[1], x=-lines[1].x), lines[2]]
    made = []

    def counted(evaluate, *arguments, **options):
        return climb(lambda *at: made.append(1) or evaluate(*at), *arguments, **options)

    monkeypatch.setattr("dampbalance.fit.multistart.climb", counted)
    fit = fit_records(turned, PAPER.k)
    assert not fit.adequate
    # twice 600 and the climb under way, three that are refined, 600 along K_z, one to its optimum
    assert len(made) < 2500
    assert fit.evaluations == pytest.approx(len(made), rel=0.1)
    assert np.argmax(fit.misfits) == 1
    made.clear()
    assert fit_records(lines, PAPER.k).adequate
    assert len(made) < 60


def test_nothing_is_found_where_the_response_gives_energy_to_the_base():
    (orbit,) = orbits_at(NEAR, (0.008,))
    lines = lines_of(orbit, EXACT)
    assert fit_records([replace(lines, x=lines.x.conj())], PAPER.k) is None


def test_a_mass_with_which_nothing_slips_gives_nothing():
    (orbit,) = orbits_at(NEAR, (0.008,))
    fit = fit_records([lines_of(orbit, EXACT)], PAPER.k)
    assert refit(fit, given={"m": 1e6}) is None


def test_the_errors_that_harmonics_have_decide_what_they_weigh():
    rng = np.random.default_rng(6)
    orbits = orbits_at(NEAR, (0.006, 0.012))
    sure = [lines_of(orbit, 1e-7) for orbit in orbits]
    worse = [lines_of(orbit, 1e-4, rng) for orbit in orbits]  # a thousand times
    both = fit_records([*sure, *worse], PAPER.k)
    alone = fit_records(sure, PAPER.k)
    assert np.abs(off(both, PAPER)).max() < 0.02  # moved by 1e-3 of its noise, in standard errors
    assert both.error("c") == pytest.approx(alone.error("c"), rel=1e-5)


def test_the_damping_that_is_given_has_no_share_in_the_search():
    """Where nothing but friction is free, every record has a share of one; next to quadratic damping, whose shares
    differ by level, a coefficient that is given changes nothing."""
    lines = tuple(lines_of(orbit, EXACT) for orbit in orbits_at(NEAR))

    def shares(law: Law) -> np.ndarray:
        return HarmonicProblem(law, lines, PAPER.k).shares.damping

    alone, quadratic = shares(Law(("F_k", "c"), given={"c": 20.0})), shares(Law(("F_k", "c_2")))
    both = shares(Law(("F_k", "c", "c_2"), given={"c": 20.0}))
    assert alone.tolist() == [1.0] * len(lines)
    assert both == pytest.approx(quadratic)
    assert np.ptp(quadratic) > 0.1


@pytest.mark.parametrize("Y", [0.0003, 0.008])
def test_the_swings_of_the_stuck_mass_are_counted(Y):
    """While the mass sticks, it swings at the frequency of spring and contact together: half a period of the drive
    where it never slips, else from the turning point to the onset of slip."""
    (motion,) = motions_at(NEAR, (Y,))
    orbit = steady_orbit(PAPER, motion)
    stuck = 0.5 * motion.period if orbit.regime == Regime.NO_SLIP else orbit.t_s
    hertz = math.sqrt((PAPER.k + PAPER.K_z) / PAPER.m) / (2.0 * math.pi)
    assert Response(orbit, 0.0).swings == pytest.approx(stuck * hertz, rel=1e-9)


def test_a_law_without_viscous_damping_has_none():
    law, motion = Law(("F_k", "c_2")), motions_at(NEAR, (0.008,))[0]
    problem = HarmonicProblem(law, (lines_of(steady_orbit(PAPER, motion), EXACT),), PAPER.k)
    values = {"F_k": 1.28, "c_2": 400.0, "rho": PAPER.K_z**-0.5, "m": PAPER.m}
    point = problem.parameters.moved(**values).values
    expected = steady_response(replace(PAPER, c=0.0), motion, {"c_2": 400.0})
    found = problem.response(point, 0)
    np.testing.assert_allclose(found.harmonics(5), expected.harmonics(5), rtol=1e-9)
