"""Free decays to F_k, c and K_z, on records of an integrator of another make, and against the forced result."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lsim, lti

from blind.decays import _pulled, clean, draw, record
from dampbalance import BaseMotion, Oscillator, identify, steady_orbit
from dampbalance.commands.main import main
from dampbalance.findings.finding import Finding
from dampbalance.fit.decay import Decay, DecayProblem
from dampbalance.identification.answer import USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.half_cycles import rows_of
from dampbalance.records.channel import Channel, Correction
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit, measured_ring_down
from dampbalance.records.writers import write
from dampbalance.signals.bursts import Signal
from dampbalance.signals.cycles import clipped, flat_tops
from dampbalance.signals.mean_harmonics import read_features
from fit.exact import fitted, start_of
from identification.levels import SYMBOLS, changed
from identification.levels import clipped as cut
from identification.releases import FAR, PLUCKED, struck
from signals.exact_decays import decay as exact_decay

QUANTITIES = ("displacement", "velocity", "acceleration")
OSCILLATOR = Oscillator(PLUCKED.m, PLUCKED.c, PLUCKED.k, PLUCKED.K_z, PLUCKED.F_k)


def holds(result, decay):
    """Whether F_k, c and K_z of the fit, and of the balance where it has numbers, are those of the truth within their
    errors."""
    assert all(math.isfinite(value) for value in result.reference.values.values())
    for found in result.approaches.values():
        for symbol in ("F_k", "c"):
            off = found.values[symbol] - getattr(decay, symbol)
            assert not abs(off) >= FAR * found.standard_errors[symbol], symbol
    high, low = (1.0 / math.sqrt(end) for end in result.reference.K_z.interval)
    assert abs(decay.K_z**-0.5 - 0.5 * (low + high)) < FAR / 1.96 * 0.5 * (high - low)


def steady(Y=2e-3, seed=0):
    """A forced record of the oscillator."""
    orbit = steady_orbit(OSCILLATOR, BaseMotion(Y, 0.7 * OSCILLATOR.omega_n))
    return measured_orbit(orbit, rate_hz=500.0, cycles=60.0, noise=0.01, seed=seed)


@cache
def plucked(**options):
    """What a release of the oscillator gives."""
    return identify_decay_records([record(PLUCKED)[0]], PLUCKED.k, **options)


@pytest.mark.parametrize("index", [10, 13])
def test_decays_do_not_overlap_and_none_is_that_of_a_hand(index):
    """Strikes of another seed, a hand pulling the mass from one to the next, which moves like half a cycle."""
    seed = 1795443154
    decay = draw(index, seed)
    measured, free = record(decay, seed)
    found = identify_decay_records([measured], decay.k)
    period = 2.0 * math.pi / decay.omega_n
    starts = [one.start for one in found.basis.fit.decays]
    np.testing.assert_allclose(starts, free, rtol=0, atol=0.1 * period)
    ends = [one.end for one in found.basis.fit.decays]
    assert all(end <= start for end, start in zip(ends, starts[1:], strict=False))
    holds(found, decay)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_release_tells_friction_damping_and_contact(quantity):
    decay = replace(PLUCKED, answers=(quantity,))
    whole = decay == PLUCKED
    result = plucked() if whole else identify_decay_records([record(decay)[0]], decay.k)
    holds(result, decay)
    assert result.basis.fit.adequate
    # 1 % noise over 12 half cycles leaves 2 % to the fit; see below for the balance
    assert result.basis.fit.error("F_k") < 0.02 * decay.F_k
    assert result.estimates["balance"].standard_errors["F_k"] < 0.08 * decay.F_k
    assert result.basis.fit.m == pytest.approx(decay.m, abs=FAR * result.basis.fit.error("m"))


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_record_without_noise_gives_the_oscillator_back(quantity):
    clean = measured_ring_down(
        OSCILLATOR, x=5e-3, rate_hz=500.0, duration=5.0, held=0.2, channels=(quantity,)
    )
    result = identify_decay_records([clean], OSCILLATOR.k)
    assert result.basis.fit.adequate
    for symbol in SYMBOLS:
        truth = getattr(OSCILLATOR, symbol)
        # where a climb ends: 1e-4 of the errors that the least noise assumed, 3e-6 of the swing, leaves: 3e-5 of c
        assert result.reference.values[symbol] == pytest.approx(truth, rel=1e-8)
        # smoothing over a twelfth of a cycle: 1e-4 of the swings, a tenth of which is lost in half a cycle; where an
        # acceleration jumps is known to a sample
        rel = 1e-2 if quantity == "acceleration" else 3e-3
        assert result.estimates["balance"].values[symbol] == pytest.approx(truth, rel=rel)


def test_the_balance_has_errors_a_few_times_those_of_the_fit():
    """It leaves out the first and the last of 12 half cycles, and does not know where the spring is at rest."""
    result = plucked()
    balance, bound = result.estimates["balance"], result.reference.standard_errors
    for symbol in ("F_k", "c"):
        assert 1.0 < balance.standard_errors[symbol] / bound[symbol] < 10.0
    # χ² of rows that share half cycles: their covariance is full
    assert 0.1 < balance.misfit < 3.0


def test_what_held_the_mass_before_is_left_out():
    """From the sample of the release on, and within an eighth of a cycle of it."""
    ((after,),) = np.subtract(
        [one.start for one in plucked().basis.fit.decays], [record(PLUCKED)[1]]
    )
    assert -1.0 / PLUCKED.rate_hz < after < 0.125 * 2.0 * math.pi / PLUCKED.omega_n


def test_records_go_together():
    records = [record(replace(PLUCKED, index=i))[0] for i in range(3)]
    all_of_them = identify_decay_records(records, PLUCKED.k)
    holds(all_of_them, PLUCKED)
    error, of_one = (each.basis.fit.error("F_k") for each in (all_of_them, plucked()))
    # the starts are found within a tenth of a cycle, the first tenth of the largest of 12 half cycles
    assert error / of_one == pytest.approx(3.0**-0.5, rel=0.12)
    assert len(all_of_them.sources) == 3


SCATTERING = (1.541, 1.599, 1.540, 1.344, 1.609)  # N, of five releases of one rig
RIG = replace(
    PLUCKED,
    **{"m": 2.42, "c": 4.0, "k": 2310.0, "K_z": 208000.0},
    **{"starts": (("pluck", 6e-3),), "lasts": (3.0,), "noise": 20e-6 / 6e-3},
)


def released(frictions):
    """A record of a release for each friction force."""
    return [record(replace(RIG, index=i, F_k=F_k))[0] for i, F_k in enumerate(frictions)]


@pytest.fixture(scope="module")
def scattering():
    return identify_decay_records(released(SCATTERING), RIG.k)


def test_releases_that_scatter_have_friction_forces_of_their_own(scattering):
    found = scattering
    assert not found.findings  # nothing is left out
    mean, scatter = float(np.mean(SCATTERING)), float(np.std(SCATTERING, ddof=1))
    answer = found.reference  # the balance has a row a decay, five for six unknowns
    assert answer.verdicts["F_k"].verdict == answer.verdicts["c"].verdict == USABLE
    p = answer.parameters["F_k"]
    # the forces of all five are known: the mean is theirs, to what the noise leaves
    assert p.value == pytest.approx(mean, abs=0.01)
    # Student's t of 4 degrees of freedom at 95 %, of which the noise adds little
    reach = 2.776 * scatter / math.sqrt(5)
    assert 0.5 * (p.interval.high - p.interval.low) == pytest.approx(reach, rel=0.1)
    for symbol in ("c", "K_z"):
        off = answer.values[symbol] - getattr(RIG, symbol)
        assert abs(off) < FAR * answer.standard_errors[symbol]
    check = found.estimates["balance"]
    assert check.verdicts["F_k"].verdict == "none"
    assert "few half cycles" in {one.code for one in check.verdicts["F_k"].findings}
    document = found.document()
    decays = [decay for entry in document["records"] for decay in entry["decays"]]
    for decay, F_k in zip(decays, SCATTERING, strict=True):
        assert abs(decay["F_k_N"] - F_k) < FAR * decay["F_k_standard_error_N"]
    assert document["F_k_scatter_N"] == pytest.approx(scatter, rel=0.05)
    (said,) = (one.numbers for one in found.rig if one.code == "friction differs")
    assert said["scatter"] == pytest.approx(scatter, rel=0.05)
    assert "do not share one friction force" in found.report()


def test_releases_of_one_record_may_scatter():
    """A hand pulls the mass to the next release, in which friction is another; the pulls are left out."""
    frictions, parts = (0.1, 0.112, 0.093), []
    for F_k, x in zip(frictions, (5e-3, -4e-3, 4.5e-3), strict=True):
        of_one = replace(PLUCKED, F_k=F_k, starts=(("pluck", x),), lasts=(4.0,))
        if parts:
            parts.append(_pulled(float(parts[-1][0, -1]), x, 0.4, 1.0 / PLUCKED.rate_hz))
        parts.append(clean(of_one)[0])
    values = np.hstack(parts)[0]
    values += 2e-5 * np.random.default_rng(0).standard_normal(values.size)
    channel = Channel("displacement", np.arange(values.size) / PLUCKED.rate_hz, values)
    fit = identify_decay_records([Record.of("three", [channel])], PLUCKED.k).basis.fit
    for one, F_k in zip(fit.decays, frictions, strict=True):
        force = one.key("F_k")
        assert abs(fit.value(force) - F_k) < FAR * fit.error(force)


def test_releases_that_share_a_friction_force_have_one():
    found = identify_decay_records(released([1.5] * 2), RIG.k)
    assert found.basis.fit.frictions.size == 1
    assert found.document()["F_k_scatter_N"] == 0.0
    assert "friction differs" not in {one.code for one in found.rig}


def test_derivatives_by_friction_forces_are_those_of_the_samples(scattering):
    fit = scattering.basis.fit
    for key in [one.key("F_k") for one in fit.decays]:
        j = fit.parameters.places[key]
        step = 1e-6 * fit.point[j]
        either = []
        for side in (step, -step):
            point = fit.point.copy()
            point[j] += side
            either.append(fit.problem.columns(point)[:, -1])
        slope = (either[0] - either[1]) / (2.0 * step)
        # central differences of exact motions
        np.testing.assert_allclose(
            fit.problem.columns(fit.point)[:, j], slope, atol=1e-5 * np.abs(slope).max()
        )


# the middle of the pulse was taken for a turn where it lay within half a window of smoothing of the first sample
@pytest.mark.parametrize(
    ("decay", "lasts"),
    [(RIG, 0.02), (replace(PLUCKED, rate_hz=640.0), 0.05)],
    ids=["rig", "plucked"],
)
def test_a_blow_soon_after_the_first_sample_is_identified(decay, lasts):
    for instant in (0.0, 0.06):
        measured = struck(replace(decay, F_k=0.1), instant, lasts)
        found = identify_decay_records([measured], decay.k)
        assert found.basis.fit.adequate, instant
        off = found.values["F_k"] - 0.1
        assert abs(off) < FAR * found.standard_errors["F_k"], instant


def sampled(spc, kind="pluck", quantity="displacement"):
    """A decay with so many samples a cycle."""
    hz = PLUCKED.omega_n / (2.0 * math.pi)
    start = {"pluck": ("pluck", 5e-3), "blow": ("blow", 0.1)}[kind]
    return replace(PLUCKED, starts=(start,), answers=(quantity,), rate_hz=spc * hz, noise=3e-3)


@pytest.mark.parametrize(
    ("spc", "kind", "quantity"),
    [
        *((10, kind, q) for kind in ("pluck", "blow") for q in QUANTITIES),
        *((12, "pluck", "acceleration"), (14, "pluck", "acceleration")),
        *((16, "pluck", "acceleration"), (20, "blow", "velocity"), (28, "pluck", "displacement")),
    ],
)
def test_few_samples_a_cycle_suffice(spc, kind, quantity):
    decay = sampled(spc, kind, quantity)
    found = identify_decay_records([record(decay)[0]], decay.k)
    assert found.basis.fit.adequate
    for symbol in ("F_k", "c"):
        off = found.values[symbol] - getattr(decay, symbol)
        assert abs(off) < FAR * found.standard_errors[symbol]


@pytest.mark.parametrize(("index", "spc"), [(9, 10), (14, 14), (4, 16), (16, 20)])
def test_few_samples_a_cycle_of_a_ringing_contact_suffice(index, spc):
    """The mass rings on the contact with so few samples a cycle that the kinks of the motion lie between them."""
    drawn = draw(index, 4321)
    size = drawn.starts[0][1] / (drawn.omega_n if drawn.starts[0][0] == "blow" else 1.0)
    one = {"starts": (("pluck", size),), "lasts": drawn.lasts[:1], "lead": drawn.lead[:1]}
    rate = spc * drawn.omega_n / (2.0 * math.pi)
    decay = replace(drawn, **one, answers=("acceleration",), rate_hz=rate, noise=3e-3)
    found = identify_decay_records([record(decay, index)[0]], decay.k)
    assert abs(found.values["F_k"] / decay.F_k - 1.0) < 0.02
    ringing = math.sqrt((decay.k + decay.K_z) / decay.m) / (2.0 * math.pi)
    if ringing > 0.5 * rate:
        verdict = found.approaches["maximum likelihood"].verdicts["K_z"]
        assert "rings" in {one.code for one in verdict.findings}


@pytest.mark.parametrize("height", [3.6, 5.2])
@pytest.mark.parametrize("lead", [0.3, 1.3])
def test_a_decay_of_two_half_cycles_is_identified(height, lead):
    """The step from where the mass was held to where it stops has more energy than the motion between."""
    period = 2.0 * math.pi / PLUCKED.omega_n
    of = {"F_k": PLUCKED.k * 0.005 / height, "lead": (lead * period,), "lasts": (2.2 * period,)}
    decay = replace(PLUCKED, **of, noise=1e-3)
    found = identify_decay_records([record(decay)[0]], decay.k)
    assert abs(found.values["F_k"] - decay.F_k) < FAR * found.standard_errors["F_k"]
    assert found.standard_errors["F_k"] < 0.1 * decay.F_k


def closed_form(hertz, cycles, samples, order=0, noise=1e-3, m=0.1, **of):
    """A release from 1 mm without a contact spring, and its k, c and F_k."""
    k, t = m * (2.0 * math.pi * hertz) ** 2, np.arange(cycles * samples) / (samples * hertz)
    values = 1e-3 * exact_decay(t, hertz, of["zeta"], of["stick"], order)
    values += noise * np.abs(values).max() * np.random.default_rng(1).standard_normal(t.size)
    truth = {"c": 2.0 * of["zeta"] * math.sqrt(k * m), "F_k": 1e-3 * of["stick"] * k}
    return Record.of("closed form", [Channel(QUANTITIES[order], t, values)]), k, truth


@pytest.mark.parametrize(
    ("cycles", "samples", "order", "of"),
    [
        (1100, 13.7, 0, {"zeta": 4e-4, "stick": 5e-5}),  # excerpts are fitted
        (80, 7.13, 2, {"zeta": 4e-3, "stick": 1e-3}),
    ],
)
def test_very_many_cycles_and_few_samples_of_each_are_identified(cycles, samples, order, of):
    decay, k, truth = closed_form(2.8, cycles, samples, order, **of)
    found = identify(decay, k, kind="ring-down")
    for symbol, value in truth.items():
        assert abs(found.values[symbol] - value) < FAR * found.standard_errors[symbol]
        assert found.standard_errors[symbol] < 0.1 * value
    assert found.natural_frequency == pytest.approx(2.8, rel=1e-5)


def test_a_contact_without_a_spring_is_no_stiffness():
    decay, k, _ = closed_form(11.5, 10, 600, 2, 5e-3, zeta=0.02, stick=0.03)
    found = identify_decay_records([decay], k)
    assert math.isinf(found.intervals["K_z"].high)
    assert found.verdicts["K_z"].verdict != USABLE


def test_a_decay_that_is_refused_shows_its_damping():
    decay, _, _ = closed_form(2.8, 30, 50.0, zeta=5e-3, stick=2e-3)
    with pytest.raises(ValueError, match="stiffness") as refused:
        identify(decay)
    assert refused.value.__notes__


def test_too_few_samples_a_cycle_are_counted():
    decay = replace(draw(7, 77), answers=("acceleration",), noise=3e-3)
    decay = replace(decay, rate_hz=4.0 * decay.omega_n / (2.0 * math.pi))
    with pytest.raises(
        ValueError, match=r"it has 3\.8 samples a cycle, 10 are needed: sample faster"
    ):
        identify_decay_records([record(decay)[0]], decay.k)


def test_it_agrees_with_the_forced_result_for_the_same_oscillator():
    levels = enumerate((1e-3, 2e-3, 4e-3))
    forced = [read_features(steady(Y=Y, seed=i), PLUCKED.k) for i, Y in levels]
    driven = identify_readings(forced, PLUCKED.k).estimates["direct"]
    free = plucked().estimates["balance"]
    for symbol in ("F_k", "c"):
        off = driven.values[symbol] - free.values[symbol]
        error = math.hypot(*(one.standard_errors[symbol] for one in (driven, free)))
        assert abs(off) < FAR * error


def test_a_mass_that_is_known_sharpens_and_one_that_is_wrong_is_named():
    free, given, wrong = (plucked(mass=m) for m in (None, PLUCKED.m, 1.3 * PLUCKED.m))
    assert given.basis.fit.m == PLUCKED.m
    # of the heaviest model: others may have another weight with the mass
    assert given.basis.fit.error("rho") < free.basis.fit.error("rho")
    assert wrong.basis.fit.m == pytest.approx(free.basis.fit.m)
    assert wrong.findings[0].numbers["masses"] == pytest.approx(
        (PLUCKED.m, 1.3 * PLUCKED.m), rel=0.01
    )
    assert given.estimates["balance"].verdicts["F_k"][:2] == ("usable", "")
    verdict = wrong.verdicts["F_k"]
    assert (verdict.verdict, verdict.findings) == ("doubtful", tuple(wrong.findings[:1]))
    assert [each.rig[0].numbers["given"] for each in (given, free, wrong)] == [True, False, False]


def test_a_weighed_mass_changes_no_number_that_the_decay_knows_better():
    """The decay knows the mass to far less than 0.3 %, and scales do not."""
    free, weighed = (plucked(mass=m, mass_error=0.005) for m in (None, 1.003 * PLUCKED.m))
    assert weighed.values == free.values
    assert weighed.verdicts == free.verdicts
    assert "masses" in {one.code for one in weighed.rig}
    # known to a millionth, it contradicts, and may move all numbers by 0.3 %: their intervals hold that, too
    exact = plucked(mass=1.003 * PLUCKED.m, mass_error=1e-6)
    assert exact.values == free.values
    assert {s: v.verdict for s, v in exact.verdicts.items()} == {
        s: v.verdict for s, v in free.verdicts.items()
    }
    for symbol, ends in exact.intervals.items():
        value = free.values[symbol]
        reach = np.hypot(np.array(free.intervals[symbol]) - value, 0.003 * value)
        # the decay knows the mass to some 0.1 %, a few percent of this difference
        assert np.abs(np.array(ends) - value) == pytest.approx(reach, rel=0.05)


def test_a_sensor_that_is_not_linear_is_left_for_the_band_of_the_mode():
    """x + 30|x|x, 15 % at the first peak: in all the band the samples are not those of the model."""
    measured, _ = record(replace(PLUCKED, noise=0.001))
    x = measured["displacement"].values
    bent = changed(measured, "displacement", values=x + 30.0 * np.abs(x) * x)
    result = identify_decay_records([bent], PLUCKED.k)
    assert result.basis.fit.problem.band is not None
    # swings 15 % too large at first decay faster: c is too large by about 15 % of the loss, and something is said of it
    assert "damping" in result.text()


def test_a_clipped_decay_is_named_and_its_samples_at_the_limit_left_out():
    sound = measured_ring_down(OSCILLATOR, x=0.005, rate_hz=200.0, duration=3.0, noise=0.005)
    found = identify([replace(cut(sound, "displacement", 0.5), name="decay")], OSCILLATOR.k)
    clipped = Finding("clipped decay", {"quantity": "displacement"}, of="decay")
    assert clipped in found.findings
    for symbol in ("F_k", "c"):
        low, high = found.reference.intervals[symbol]
        assert low < getattr(OSCILLATOR, symbol) < high


@pytest.mark.parametrize("end", [1, -1])
def test_what_a_decay_begins_or_ends_at_is_not_clipped(end):
    t = np.arange(800) / 200.0
    decaying = np.exp(-t) * np.cos(20.0 * t)
    assert not clipped(decaying)
    assert not clipped(
        np.concatenate([np.full(50, 1.0), decaying, np.full(50, decaying[-1])])[::end]
    )
    assert not clipped(np.concatenate([decaying[:30], np.full(50, decaying[:30].min())])[::end])
    for level in (0.9, 0.6, 0.3):
        highest = level * decaying[20:].max()
        assert flat_tops(np.minimum(decaying, highest)[::end]) == (-np.inf, highest)
        assert clipped(np.minimum(decaying, highest)[::end])
        assert clipped(np.maximum(decaying, level * decaying[20:].min())[::end])


def test_a_decay_without_a_half_cycle_that_slips_has_no_row():
    stuck = measured_ring_down(
        replace(OSCILLATOR, F_k=100.0, c=3.0), x=0.005, rate_hz=400.0, duration=0.8, noise=0.005
    )["displacement"]
    signal = Signal("displacement", 0, stuck.t, stuck.values, 2.5e-5)
    start = np.array([100.0, 3.0, 6000.0**-0.5, 1.0, 0.0, 0.005, 0.0, 1.3])
    fit = fitted(Decay("a", 0.0, 0.8, (signal,), 0.08), 400.0, start, held="F_k")
    rows = rows_of(fit)
    assert rows.halves == len(rows.decay) == 0
    ((turns, errors),) = rows.turns
    assert len(turns) == len(errors) == 0


def test_a_climb_may_start_without_friction():
    """An earlier climb may end there; with no size of its own F_k stopped the next one with a division by zero."""
    sound = measured_ring_down(
        replace(OSCILLATOR, c=3.0), x=0.005, rate_hz=400.0, duration=0.8, noise=0.005
    )["displacement"]
    signal = Signal("displacement", 0, sound.t, sound.values, 2.5e-5)
    osc = OSCILLATOR
    start = np.array([0.0, 3.0, osc.K_z**-0.5, osc.m, 0.0, 0.005, 0.0, 1.0])
    problem = DecayProblem((Decay("a", 0.0, 0.8, (signal,), 0.3),), osc.k)
    fit = problem.climb(start_of(problem, start))
    assert fit is None or np.isfinite(fit.point).all()


def test_gain_delay_and_filters_are_taken_off():
    measured, _ = record(PLUCKED)
    measured = replace(measured, name="run")
    channel = measured["displacement"]
    x, dt = channel.values, 1.0 / PLUCKED.rate_hz

    def corrected(correction, values):
        other = {"values": values, "name": "x", "correction": correction}
        record = changed(measured, "displacement", **other).corrected()
        return identify_decay_records([record], PLUCKED.k)

    plain = plucked().reference
    gained = corrected(Correction(gain=1.25, delay=0.01), 1.25 * x).reference
    one, other = (answer.parameters["F_k"] for answer in (plain, gained))
    # the start may be found at another sample; without the gain F_k would be 25 % off, 20 standard errors
    assert abs(one.value - other.value) < 0.5 * one.standard_error
    # of first order, by SciPy: a low-pass at twice the natural frequency, an AC coupling at a tenth of it
    for analog, poles in (
        (([40.0], [1.0, 40.0]), {"low_pass": (-40.0 + 0j,)}),
        (([1.0, 0.0], [1.0, 2.0]), {"high_pass": (-2.0 + 0j,)}),
    ):
        system = lti(*analog)
        fine = np.linspace(0.0, (x.size - 1) * dt, x.size)
        y = lsim(system, x - x[0], fine)[1] + (x[0] if "low_pass" in poles else 0.0)
        filtered = corrected(Correction(**poles), y).reference
        for symbol in ("F_k", "c"):
            p = filtered.parameters[symbol]
            assert abs(p.value - getattr(PLUCKED, symbol)) < FAR * p.standard_error, symbol
            # in the band of the mode, from later on
            assert p.standard_error < 30.0 * plain.standard_errors[symbol]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (lambda t, x: 1e-3 * np.sin(14.0 * t), "swings as far at its end as at its start"),
        (
            lambda t, x: np.random.default_rng(1).standard_normal(t.size),
            "no oscillation in it exceeds the noise",
        ),
        (lambda t, x: x[-1] + 1e-6 * np.random.default_rng(1).standard_normal(t.size), "noise"),
    ],
)
def test_a_record_without_a_decay_is_refused_in_a_sentence(values, message):
    measured = replace(record(PLUCKED)[0], name="run")
    t, x = measured["displacement"].t, measured["displacement"].values
    none = changed(measured, "displacement", values=values(t, x))
    with pytest.raises(
        ValueError, match=rf"run: the excitation channel is missing .* no free decay .*{message}"
    ):
        identify_decay_records([none], PLUCKED.k)


def test_stamps_rounded_to_milliseconds_are_no_obstacle_to_a_short_decay(tmp_path):
    decay = replace(PLUCKED, rate_hz=2000.0, lasts=(1.1,), noise=2e-3)
    channel = record(decay)[0]["displacement"]
    table = {"t (s)": np.round(channel.t, 3), "x (m)": channel.values}
    pd.DataFrame(table).to_csv(tmp_path / "decay.csv", index=False)
    found = identify(tmp_path / "decay.csv", decay.k)
    assert found.findings[0].numbers["resolution"] == 0.001
    assert abs(found.values["F_k"] - decay.F_k) < FAR * found.standard_errors["F_k"]


def test_a_camera_that_follows_x_and_y_sees_a_decay(tmp_path):
    """In a free decay no base moves: y is the other axis."""
    channel = record(PLUCKED)[0]["displacement"]
    table = {"t (s)": channel.t, "x (m)": channel.values, "y (m)": 0.3 * channel.values}
    pd.DataFrame(table).to_csv(tmp_path / "camera.csv", index=False)
    found = identify(tmp_path / "camera.csv", PLUCKED.k, kind="ring-down")
    assert abs(found.values["F_k"] - PLUCKED.F_k) < FAR * found.standard_errors["F_k"]


def test_a_forced_record_is_not_taken_for_a_decay(tmp_path):
    path, free = tmp_path / "level.csv", tmp_path / "decay.csv"
    write(path, steady())
    write(free, record(PLUCKED)[0])
    for names in ([path], [free, path], [path, free]):
        with pytest.raises(ValueError, match=r"level\.csv: .* moves: .* not identified together"):
            identify(names, PLUCKED.k, kind="ring-down" if len(names) == 1 else "recognised")
    with pytest.raises(ValueError, match=r"decay\.csv: the excitation channel is missing"):
        identify([free], PLUCKED.k, kind="forced")


def test_a_drive_that_stands_still_is_none(tmp_path):
    measured, _ = record(PLUCKED)
    t = measured["displacement"].t
    still = 1e-6 * np.random.default_rng(3).standard_normal(t.size)
    both = [Channel("base_displacement", t, still), measured["displacement"]]
    write(tmp_path / "run.csv", Record.of("run", both))
    result = identify([tmp_path / "run.csv"], PLUCKED.k)
    holds(result, PLUCKED)


@pytest.mark.parametrize(
    ("heading", "kind"),
    [
        ("Hammer [N]", "recognised"),
        ("force_N", "recognised"),
        ("Hammer [N]", "ring-down"),
        # in no unit of a force: nothing says that it only strikes
        ("Hammer [V]", "ring-down"),
        ("CH 2 [mm]", "ring-down"),
    ],
)
def test_a_hammer_is_no_obstacle_to_a_decay(heading, kind):
    struck = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208000.0, F_k=0.5)
    options = {"rate_hz": 1000.0, "duration": 3.0, "noise": 0.002, "seed": 3}
    a = measured_ring_down(struck, v=0.3, channels=("acceleration",), **options)["acceleration"]
    begin = a.t[int(np.argmax(np.abs(a.values) > 1.0))]
    since = (a.t - begin + 0.005) / 0.005  # a blow of 5 ms
    blow = np.where((since > 0.0) & (since < 1.0), 200.0 * np.sin(math.pi * since), 0.0)
    # noise of 1 % and the undershoot of a charge amplifier
    blow += 2.0 * np.random.default_rng(1).standard_normal(a.t.size)
    blow -= np.where(a.t > begin, np.exp(begin - a.t), 0.0)
    record = {"time_s": a.t, heading: blow, "Acc [m/s²]": a.values}
    found = identify(record, struck.k, kind=kind)
    for symbol, (low, high) in found.intervals.items():
        assert low < getattr(struck, symbol) < high, symbol


@pytest.mark.parametrize("options", [{"frequency": 3.0}, {"skip_cycles": 2}])
def test_options_of_forced_records_are_refused(tmp_path, options):
    write(tmp_path / "decay.csv", record(PLUCKED)[0])
    with pytest.raises(ValueError, match="is for forced records"):
        identify([tmp_path / "decay.csv"], PLUCKED.k, **options)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "needs a displacement x or a velocity v"),
        (
            {"x": 1e-3, "channels": ("force",)},
            r"unknown channels \['force'\]; known are displacement, ",
        ),
        ({"x": 1e-3, "duration": 0.001}, "at least 2 are needed"),
    ],
)
def test_a_release_that_makes_no_sense_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        measured_ring_down(OSCILLATOR, **({"rate_hz": 500.0, "duration": 2.0} | arguments))


def test_a_written_release_is_identified(tmp_path, capsys):
    path = tmp_path / "decay.csv"
    told = "--damping 1 --friction 0.5 --noise 0.01 --rate 1000 --seed 3"
    blow = ["--velocity", "0.3", "--channel", "velocity", *told.split()]
    assert main(["release", str(path), *blow]) == 0
    assert main(["release", str(path), *blow]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["identify", str(path), "--stiffness", "2310", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)["maximum_likelihood"]
    for key, truth in (("F_k{}_N", 0.5), ("c{}_N_s_per_m", 1.0)):
        error = found[key.format("_standard_error")]
        assert abs(found[key.format("")] - truth) < FAR * error


def test_the_command_writes_everything_and_the_same_bytes(tmp_path, capsys):
    write(tmp_path / "decay.csv", record(PLUCKED)[0])
    arguments = ["identify", str(tmp_path / "decay.csv"), "--stiffness", "400", "--output"]
    for folder in ("one", "other"):
        assert main([*arguments, str(tmp_path / folder)]) == 0
    said = capsys.readouterr().out
    assert said.startswith("F_k = ")
    assert "\nCheck: the energy balance differs by " in said
    one, other = (
        {path.name: path.read_bytes() for path in (tmp_path / folder).iterdir()}
        for folder in ("one", "other")
    )
    assert one == other
    assert {"decays.svg", "decays.png", "identification.json"} <= set(one)
    found = json.loads(one["identification.json"])
    balance = found["approaches"]["balance"]
    low, high = balance["F_k_interval_N"]
    assert low < PLUCKED.F_k < high
    assert len(found["records"][0]["decays"][0]["turns_m"]) > 5
