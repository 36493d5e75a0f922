"""The reference fit: exact on exact records, as scattered as the bound says on noisy ones, honest about the rest."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import chi2

from dampbalance.likelihood.fit import _Problem, reference_fit
from dampbalance.likelihood.information import NotIdentifiable, cramer_rao, noise_of_rms
from dampbalance.likelihood.residuals import Residual, adequacy
from dampbalance.likelihood.start import lines_of, starting_point
from dampbalance.model import BaseMotion
from dampbalance.motion.orbit import steady_orbit
from dampbalance.reading.climb import Evaluation, NoConvergence, climb
from dampbalance.record import Record
from paper_case import FREQUENCIES_HZ, LEVELS, NEAR, OMEGA, PAPER, motions_at

RATE = 1000.0
SEED = 20100815  # of every record with noise


def record(
    Y,
    osc=PAPER,
    hertz=NEAR,
    cycles=8.3,
    noise=0.0,
    rng=None,
    channels=("y", "x"),
    psi=0.7,
    offset=0.0,
    start=3.0,
    rate=RATE,
):
    """Exact signals, with white noise and an offset as parts of the rms of each."""
    omega = 2.0 * math.pi * hertz
    t = start + np.arange(round(rate * cycles / hertz)) / rate
    motion = BaseMotion(Y, omega)
    state = steady_orbit(osc, motion).state(t + psi / omega)
    signals = {"y": motion.y(t + psi / omega), **state._asdict()}
    made = {}
    for name in channels:
        rms = float(np.sqrt(np.mean(signals[name] ** 2)))
        made[name] = signals[name] + offset * rms
        if noise:
            made[name] = made[name] + noise * rms * rng.standard_normal(t.size)
    return Record(t=t, **made)


def noisy(noise=0.01, seed=SEED, **more):
    rng = np.random.default_rng(seed)
    return [record(Y, noise=noise, rng=rng, **more) for Y in LEVELS]


def fit(records, omega=OMEGA, m=PAPER.m, k=PAPER.k, **more):
    return reference_fit(records, omega, m, k, **more)


def passes(verdict):
    """Whether neither test rejects at the level of 0.1 %; an untested fit passes."""
    return not (verdict.harmonics_p < 1e-3 or verdict.whiteness_p < 1e-3)


@pytest.fixture(scope="module")
def measured():
    return noisy()


# --- exact records -------------------------------------------------------------------------------


@pytest.mark.parametrize("channels", [("y", "x"), ("y", "x", "v", "acceleration")], ids=len)
@pytest.mark.parametrize("hertz", FREQUENCIES_HZ.values())
def test_exact_records_give_back_the_parameters(hertz, channels):
    records = [record(Y, hertz=hertz, channels=channels, offset=0.2) for Y in LEVELS]
    found = fit(records, 2.0 * math.pi * hertz)
    # Rounding, 1e-16 of x, times its gain: 1e-12 for F_k, 1e-11 for K_z.
    assert found.F_k == pytest.approx(PAPER.F_k, rel=1e-9)
    assert found.c == pytest.approx(PAPER.c, rel=1e-9)
    assert found.K_z == pytest.approx(PAPER.K_z, rel=1e-8)
    assert pytest.approx(LEVELS, rel=1e-10) == found.Y
    assert found.psi == pytest.approx([0.7] * 5, abs=1e-10)
    assert found.offsets["x"] == pytest.approx([0.2 * np.std(r.x) for r in records], rel=0.02)
    assert found.warnings == ()


@pytest.mark.parametrize(
    "osc",
    [
        replace(PAPER, K_z=1e9),  # as good as rigid
        replace(PAPER, K_z=2000.0, F_k=5.0),  # sticks for half of the cycle
        replace(PAPER, c=1.0),  # friction does nearly all the work
        replace(PAPER, c=0.0),
        replace(PAPER, F_k=15.0),  # nothing slips at the lowest level
    ],
    ids=["rigid", "soft", "lightly damped", "undamped", "partly sticking"],
)
def test_other_oscillators(osc):
    hertz = 3.5
    found = fit([record(Y, osc, hertz) for Y in LEVELS], 2.0 * math.pi * hertz)
    assert found.F_k == pytest.approx(osc.F_k, rel=1e-8)
    assert found.c == pytest.approx(osc.c, rel=1e-8, abs=1e-8)
    assert found.K_z == pytest.approx(osc.K_z, rel=1e-6)


def test_one_level_is_enough_for_the_whole_waveform():
    found = fit([record(0.008)])
    assert found.F_k == pytest.approx(PAPER.F_k, rel=1e-8)
    assert found.c == pytest.approx(PAPER.c, rel=1e-8)


def test_levels_at_several_frequencies():
    hertz = tuple(FREQUENCIES_HZ.values())
    records = [record(0.008, hertz=f) for f in hertz]
    found = fit(records, [2.0 * math.pi * f for f in hertz])
    assert found.F_k == pytest.approx(PAPER.F_k, rel=1e-9)
    with pytest.raises(ValueError, match="one per record"):
        fit(records, [OMEGA, OMEGA])


def test_mass_and_frequency_can_be_free():
    records = [record(Y) for Y in LEVELS]
    found = fit(records, 1.0005 * OMEGA, m=2.3, free=("m", "omega"))
    assert found.m == pytest.approx(PAPER.m, rel=1e-8)
    assert found.omega == pytest.approx([OMEGA] * 5, rel=1e-9)
    assert found.K_z == pytest.approx(PAPER.K_z, rel=1e-6)
    assert found.psi == pytest.approx([0.7] * 5, abs=1e-8)


# --- noise ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "start",
    [
        replace(PAPER, c=45.0, K_z=2e6, F_k=4.0),
        replace(PAPER, c=200.0, K_z=2e4, F_k=0.1),
        replace(PAPER, c=5.0, K_z=1e9, F_k=2.0),
    ],
    ids=["F_k too large", "F_k too small", "rigid"],
)
def test_a_wrong_start_ends_at_the_same_place(measured, start):
    by_itself, led = fit(measured), fit(measured, start=start)
    errors = by_itself.standard_errors
    for name, error in zip(("F_k", "c", "K_z"), errors, strict=True):
        # The climb ends within 1e-4 of a standard error; the noise, profiled, moves with it.
        assert abs(getattr(led, name) - getattr(by_itself, name)) < 1e-3 * error


def test_scatter_agrees_with_the_bound():
    """60 fits of five records of 325 samples: variances within the 99.9 % interval of χ² with 59 degrees of freedom,
    means within 3.3 standard errors; and the covariance each fit reports is the bound."""
    runs, cycles = 60, 8.0
    motions = motions_at()
    noise = noise_of_rms(PAPER, motions, 0.01, ("y", "x"))
    # The same times and phases as those of the records; few samples per cycle, so that they matter.
    bound = cramer_rao(PAPER, motions, rate_hz=200.0, cycles=cycles, noise=noise)
    fits = [
        fit(noisy(seed=SEED + run, cycles=cycles, rate=200.0, psi=0.0, start=0.0), start=PAPER)
        for run in range(runs)
    ]
    # In ρ, whose distribution is closer to normal than that of K_z = ρ⁻².
    estimates = np.array([(f.F_k, f.c, f.rho) for f in fits])
    truth = np.array([PAPER.F_k, PAPER.c, PAPER.K_z**-0.5])
    sigma = np.array(bound.standard_errors) * [1.0, 1.0, 0.5 * PAPER.K_z**-1.5]
    ratio = estimates.var(axis=0, ddof=1) / sigma**2
    low, high = chi2.ppf((0.0005, 0.9995), runs - 1) / (runs - 1)
    assert np.all((low < ratio) & (ratio < high)), ratio
    shift = (estimates.mean(axis=0) - truth) / sigma * math.sqrt(runs)
    assert np.all(np.abs(shift) < 3.3), shift
    reported = np.median([(*f.standard_errors[:2], f.rho_standard_error) for f in fits], axis=0)
    # The noise of each channel is known from 325 samples to 4 %, over ten of them to 1.3 %; ρ to 20 % of itself.
    assert reported == pytest.approx(sigma, rel=0.06)


def test_noise_is_estimated_per_channel_and_record(measured):
    found = fit(measured)
    for name in ("y", "x"):
        rms = [np.std(getattr(r, name)) for r in measured]
        # 1687 samples: a standard deviation to 1.7 %; four of them.
        assert found.noise[name] == pytest.approx(0.01 * np.array(rms), rel=0.07)
    assert math.isnan(found.chi_square)


def test_given_noise_is_put_to_the_test(measured):
    noise = {name: [0.01 * np.std(getattr(r, name)) for r in measured] for name in ("y", "x")}
    found = fit(measured, noise=noise)
    assert found.chi_square == pytest.approx(1.0, abs=4.0 * math.sqrt(2.0 / 16870))
    assert found.warnings == ()
    half = fit(measured, noise={name: 0.5 * np.array(values) for name, values in noise.items()})
    assert half.F_k == pytest.approx(found.F_k, rel=1e-6)
    assert half.covariance == pytest.approx(found.covariance / 4.0, rel=1e-3)
    assert any("times the noise given" in words for words in half.warnings)
    with pytest.raises(ValueError, match=r"noise lacks the channels \['x'\] of record 1"):
        fit(measured, noise={"y": 1e-5})


def test_units_do_not_matter(measured):
    """Lengths in mm, forces as they are: the start, the steps and the tests see the same problem."""
    mm = [Record(t=r.t, y=1e3 * r.y, x=1e3 * r.x) for r in measured]
    found, scaled = fit(measured), fit(mm, m=PAPER.m / 1e3, k=PAPER.k / 1e3)
    assert scaled.F_k == pytest.approx(found.F_k, rel=1e-6)  # 1e-3 of the standard error, 0.3 %
    assert 1e3 * scaled.c == pytest.approx(found.c, rel=1e-6)
    assert 1e3 * scaled.K_z == pytest.approx(found.K_z, rel=1e-4)
    assert scaled.standard_errors[0] == pytest.approx(found.standard_errors[0], rel=1e-3)


def test_what_counts_as_zero_grows_with_the_forces(measured):
    """All but the lengths 10⁴ times as large: F_k, c, K_z = ρ⁻² and m, and so what is as good as none of each."""
    tau, omegas = [r.t - r.t.mean() for r in measured], [OMEGA] * 5
    lines = lines_of(measured, tau, omegas)
    small, large = (
        _Problem(measured, tau, omegas, f * PAPER.m, f * PAPER.k, None, ("m",)).limits(lines)[1]
        for f in (1.0, 1e4)
    )
    assert large[:4] / small[:4] == pytest.approx([1e4, 1e4, 1e-2, 1e4])
    assert large[4:].tolist() == small[4:].tolist()


def test_a_contact_too_stiff_to_resolve_has_no_upper_limit():
    osc = replace(PAPER, K_z=1e11)
    fits = [fit(noisy(seed=SEED + i, osc=osc)) for i in range(4)]
    for found in fits:
        low, high = found.K_z_interval
        assert math.isinf(high)
        assert 1e6 < low < 1e11
        assert any("do not tell the contact from a rigid one" in words for words in found.warnings)
        # What the records do tell stays: 4 standard errors.
        assert abs(found.F_k - osc.F_k) < 4.0 * found.standard_errors[0]
        assert abs(found.c - osc.c) < 4.0 * found.standard_errors[1]
    rigid = [found for found in fits if math.isinf(found.K_z)]
    assert rigid  # half of the estimates fall on the limit
    assert math.isinf(rigid[0].standard_errors[2])


def test_interval_of_K_z_is_that_of_its_root(measured):
    found = fit(measured)
    low, high = found.K_z_interval
    assert low < found.K_z < high
    assert low**-0.5 - high**-0.5 == pytest.approx(2 * 1.959964 * found.rho_standard_error)
    assert found.standard_errors[2] == pytest.approx(
        2.0 * found.K_z**1.5 * found.rho_standard_error
    )


@pytest.mark.parametrize("share", [0.03, 0.2, 0.5, 0.8])
def test_a_fit_of_one_level_starts_near_its_share_of_friction(share):
    """Of the work: the balance of one level does not tell it, the waveform chooses among those that are tried."""
    motion = BaseMotion(0.008, OMEGA)
    c = 0.5 * PAPER.c * (1.0 - share)

    def excess(F_k):
        orbit = steady_orbit(replace(PAPER, F_k=F_k, c=c), motion)
        return F_k * orbit.a / orbit.W - share

    osc = replace(PAPER, F_k=brentq(excess, 1e-3, 14.0), c=c)
    made = record(0.008, osc)
    found = starting_point(lines_of([made], [made.t], [OMEGA]), [OMEGA], PAPER.m, PAPER.k)
    orbit = steady_orbit(osc, motion)
    # the shares tried are 0.3 apart at most, and less towards both ends
    assert found.F_k * orbit.a / orbit.W == pytest.approx(share, abs=0.12)
    assert found.c * orbit.b / orbit.W == pytest.approx(1.0 - share, abs=0.12)


def test_one_whole_cycle_is_enough_to_start():
    t = np.arange(128) / 128.0
    exact = Record(t=t, y=0.3 * np.cos(2.0 * math.pi * t), x=0.2 * np.sin(2.0 * math.pi * t))
    lines = lines_of([exact], [t], [2.0 * math.pi])
    assert pytest.approx([0.3], rel=1e-13) == lines.Y
    assert lines.X[0] == pytest.approx([-0.2j, 0.0, 0.0], abs=1e-14)
    with pytest.raises(ValueError, match="a fit needs a whole cycle"):
        lines_of([exact.samples(0, 127)], [t[:127]], [2.0 * math.pi])


# --- what is not as assumed ----------------------------------------------------------------------


def test_adequate_records_pass(measured):
    verdict = fit(measured).adequacy
    assert passes(verdict)
    assert verdict.harmonics == pytest.approx(1.0, abs=0.5)  # 169 degrees of freedom: 4 of √(2/169)
    assert verdict.whiteness == pytest.approx(1.0, abs=0.4)  # 200: 4 of √(2/200)


def test_a_third_harmonic_fails_the_check(measured):
    """0.3 % of x at the lowest level, a third of the noise in each sample."""
    spoilt = [
        Record(t=r.t, y=r.y, x=r.x + 2e-5 * np.cos(3.0 * OMEGA * r.t + 1.0)) for r in measured
    ]
    found = fit(spoilt)
    assert found.adequacy.harmonics_p < 1e-6
    assert not passes(found.adequacy)
    assert any("repeat with the drive" in words for words in found.warnings)


def test_a_wrong_frequency_fails_the_check(measured):
    found = fit(measured, 1.0006 * OMEGA)  # loses 0.03 rad over the record
    assert found.adequacy.whiteness_p < 1e-6
    assert any("not white" in words for words in found.warnings)


def test_a_base_without_noise_is_taken_as_exact():
    """A base motion computed, not measured: its noise is rounding, far below that of x."""
    rng = np.random.default_rng(SEED)
    records = [record(Y) for Y in LEVELS]
    records = [Record(t=r.t, y=r.y, x=r.x + 2e-5 * rng.standard_normal(len(r))) for r in records]
    found = fit(records)
    assert pytest.approx(LEVELS, rel=1e-12) == found.Y
    assert abs(found.F_k - PAPER.F_k) < 4.0 * found.standard_errors[0]
    assert found.warnings == ()


def test_filtered_noise_fails_the_check():
    rng = np.random.default_rng(SEED)
    records = []
    for Y in LEVELS:
        r = record(Y)
        noise = np.convolve(rng.standard_normal(len(r) + 1), [0.5, 0.5], mode="valid")
        records.append(Record(t=r.t, y=r.y, x=r.x + 2e-5 * noise))
    assert fit(records).adequacy.whiteness_p < 1e-6


def test_statistics_of_white_noise_are_chi_square():
    """Means and variances of both statistics over 400 draws of noise: four standard errors of χ² moments."""
    rng = np.random.default_rng(SEED)
    phase = 0.05 * np.arange(1500)
    verdicts = []
    for _ in range(400):
        noise = rng.standard_normal(1500)
        verdicts.append(adequacy([Residual(noise, 100.0 * np.cos(phase), phase)], 0))
    for name, dof in (("harmonics", 18), ("whiteness", 20)):
        values = np.array([getattr(v, name) for v in verdicts])
        assert values.mean() == pytest.approx(1.0, abs=4.0 * math.sqrt(2.0 / dof / 400))
        assert values.var() == pytest.approx(2.0 / dof, rel=0.4)  # 4 √(2/400), and excess 12/dof
    assert np.mean([v.harmonics_p < 0.05 for v in verdicts]) == pytest.approx(0.05, abs=0.045)


def test_statistics_of_a_residual_whose_power_is_known():
    """Whole cycles of a cos ωt + b cos 20ωt: n a²/2 at the harmonics, and n b²/2 off them, of n − 1 − 18 freedoms."""
    n, a, b = 128, 0.3, 1.1
    phase = 2.0 * math.pi * 8.0 * np.arange(n) / n
    made = Residual(a * np.cos(phase) + b * np.cos(2.5 * phase), 100.0 * np.cos(phase), phase)
    highest = math.floor(0.9 * math.pi / phase[1])  # fewer than nine fit the sampling
    dof = 2 * highest
    power = (n - 1 - dof) * (a / b) ** 2
    assert adequacy([made], 0).harmonics == pytest.approx(power / dof, rel=1e-12)
    assert adequacy([made], dof - 1).harmonics == pytest.approx(power, rel=1e-12)
    assert adequacy([made], dof - 1).harmonics_p == pytest.approx(chi2.sf(power, 1), rel=1e-9)
    assert math.isnan(adequacy([made], dof).harmonics)
    # a record of less than two cycles adds nothing to what is said of the harmonics
    short = Residual(made.values, made.signal, 0.1 * phase)
    assert adequacy([made, short], 0).harmonics == adequacy([made], 0).harmonics


@pytest.mark.parametrize("noise", [None, {"y": 4e-5, "x": (2e-5, 6e-5)}], ids=["profiled", "known"])
def test_the_gradient_is_the_slope_of_the_likelihood(measured, noise):
    """−log L against steps in every unknown, away from its least value."""
    records = measured[1:4:2]
    tau = [r.t - r.t.mean() for r in records]
    omegas = [1.0001 * OMEGA, OMEGA]
    problem = _Problem(records, tau, omegas, PAPER.m, PAPER.k, noise, ("m", "omega"))
    start = replace(PAPER, F_k=1.4, c=85.0, K_z=1.5e5)
    point = problem.point(start, lines_of(records, tau, omegas))
    there = problem.evaluate(point)
    for i, value in enumerate(point):
        step = np.zeros(point.size)
        step[i] = 1e-5 * (value if i not in (5, 8) else 1.0)  # ψ in radians
        low, high = problem.evaluate(point - step), problem.evaluate(point + step)
        slope = (high.value - low.value) / (2.0 * step[i])
        # 1e-3: the model's derivatives, of which those next to slip onset average a jump
        assert slope == pytest.approx(-there.gradient[i], rel=1e-3)


def test_what_cannot_be_tested_is_not():
    """Fewer than two cycles do not tell harmonics apart; a residual of rounding says nothing of the model."""
    rng = np.random.default_rng(SEED)
    noise, phase = rng.standard_normal(1000), np.linspace(0.0, 3.0 * math.pi, 1000)
    short = adequacy([Residual(noise, 100.0 * np.cos(phase), phase)], 0)
    assert math.isnan(short.harmonics_p)
    assert short.whiteness_p > 0.01
    ramp = np.linspace(-1.0, 1.0, 1000)
    rounding = adequacy([Residual(1e-12 * ramp, np.cos(4.0 * phase), 4.0 * phase)], 0)
    assert passes(rounding)
    assert math.isnan(rounding.whiteness_p)
    assert not passes(adequacy([Residual(ramp, np.cos(4.0 * phase), 4.0 * phase)], 0))


def test_a_contact_that_only_sticks_is_refused():
    osc = replace(PAPER, F_k=60.0)
    for records in (noisy(osc=osc), [record(Y, osc) for Y in LEVELS]):
        with pytest.raises(NotIdentifiable, match="the contact only sticks, or there is no frict"):
            fit(records)


def test_a_record_without_slip_beside_others_is_named():
    osc = replace(PAPER, F_k=15.0)
    found = fit(noisy(osc=osc))
    assert any("nothing slips in record 1, 2:" in words for words in found.warnings)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"start": replace(PAPER, K_z=3000.0, F_k=60.0)}, "nothing slips in any record"),
        ({"omega": 0.0}, "omega must be one positive number"),
        ({"omega": 0.1}, "a fit needs a whole cycle"),
        ({"omega": 2000.0 * math.pi}, "sampled 3 times or more"),
        ({"k": -1.0}, "k must be positive"),
        ({"free": ("F_k",)}, "unknown names"),
        ({"noise": {"z": 1.0}}, "unknown names"),
    ],
)
def test_what_makes_no_sense_is_refused(measured, change, message):
    with pytest.raises(ValueError, match=message):
        fit(measured, **change)


def test_no_records_and_swapped_channels_are_refused(measured):
    with pytest.raises(ValueError, match="at least one record"):
        fit([])
    with pytest.raises(ValueError, match="takes no work from the base"):
        fit([Record(t=r.t, y=r.x, x=r.y) for r in measured])


def test_a_climb_that_goes_nowhere_says_so():
    """A gradient that points the wrong way: no step helps, however short."""

    def evaluate(p):
        return Evaluation(float(p[0] ** 2), np.eye(1), 1e3 * p)

    with pytest.raises(NoConvergence, match="did not converge"):
        climb(evaluate, np.array([1.0]), np.array([1e-9]), np.array([1e-9]))
