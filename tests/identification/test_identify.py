"""F_k, c and K_z from measured responses: against the truth, with intervals that hold."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from blind.gradual import CONTACTS, steady_on
from dampbalance.fit.errors import jackknifed
from dampbalance.fit.steady_search import fit_records
from dampbalance.identification.answer import REFERENCE, USELESS
from dampbalance.identification.balance_rows import estimate_of, features_left_out, rows_of
from dampbalance.identification.diagnosis import on_the_oscillator
from dampbalance.identification.document import table as rows_of_table
from dampbalance.identification.forced import identify_readings
from dampbalance.law.law import Law
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.signals.mean_harmonics import read_features
from dampbalance.solver import NORMAL_95, solve
from fit.sampled import covariance, noise_of_rms
from identification.levels import SYMBOLS, THREE, close, identified, read
from paper_case import FREQUENCIES_HZ, LEVELS, NEAR, PAPER, motions_at, orbits_at


def readings(hz=NEAR, noise=0.0, levels=LEVELS, osc=PAPER, **options):
    options = {"rate_hz": 2000.0, "channels": THREE} | options
    return read(orbits_at(hz, levels, osc), noise=noise, **options)


def holds(answer, osc=PAPER, symbols=SYMBOLS):
    """Whether the intervals of an answer hold the truth."""
    return all(low < getattr(osc, s) < high for s in symbols for low, high in [answer.intervals[s]])


@pytest.mark.parametrize("hz", FREQUENCIES_HZ.values())
def test_exact_records_give_the_truth_off_resonance_too(hz):
    found = identified(readings(hz))
    direct = found.estimates["direct"]
    # of the velocity 1e-6 lies beyond the 128 odd harmonics of a waveform; F_k takes up the small errors of large rows
    assert direct.values["F_k"] == pytest.approx(PAPER.F_k, rel=2e-5)
    assert direct.values["c"] == pytest.approx(PAPER.c, rel=2e-6)
    assert found.reference.K_z.value == pytest.approx(PAPER.K_z, rel=2e-5)
    assert found.basis.common.fit.m == pytest.approx(PAPER.m, rel=1e-6)
    assert found.findings == [*direct.notes] == []


def test_records_of_several_frequencies_go_together():
    each = (0.005, 4.92), (0.011, 3.5), (0.011, 11.1)
    mixed = [readings(hz, 0.005, levels=(Y,), seed=i)[0] for i, (Y, hz) in enumerate(each)]
    assert holds(identified(mixed).estimates["direct"])


def test_the_records_share_what_no_single_one_resolves():
    single = readings(4.92, 0.05, rate_hz=1500.0, cycles=20.0, channels=THREE[:2])
    fits = [fit_records([reading.lines], PAPER.k) for reading in single]
    assert any(fit.rho < NORMAL_95 * fit.error("rho") for fit in fits)
    found = identified(single)
    assert found.document()["microstick"]["resolved"]
    assert holds(found.estimates["direct"], symbols=("K_z", "F_k"))
    # one length for all: X + X_s is freed of the square of the error of ρ, L itself is not
    lengths = found.basis.features.X + found.basis.features.X_s
    assert lengths == pytest.approx([lengths[0]] * 5, rel=1e-9)
    off = 2.0 * found.basis.common.fit.F_k * found.basis.common.fit.error("rho") ** 2
    assert lengths[0] == pytest.approx(found.document()["microstick"]["length_m"] - off, rel=1e-9)
    assert found.findings == []


def test_an_onset_that_is_not_resolved_enters_with_its_error_and_K_z_has_a_limit():
    # 20,000 N/mm: a microstick line of 0.13 µm beside 24 µm of noise
    stiff = replace(PAPER, K_z=2e7)
    found = identified(readings(noise=0.03, rate_hz=1000.0, channels=THREE[:2], osc=stiff))
    assert not found.document()["microstick"]["resolved"]
    # one noise leaves it open whether friction changes with the speed
    assert found.findings[0].code == "unresolved"
    assert {one.code for one in found.findings[1:]} <= {"weighs"}
    K_z = found.answer.K_z
    assert K_z.interval.high == math.inf
    assert 0.0 < K_z.interval.low < stiff.K_z
    # no more than noise in F_k, for the length and its error are in the rows
    assert holds(found.estimates["direct"], stiff, ["F_k"])
    assert found.document()["maximum_likelihood"]["K_z_interval_N_per_m"][1] is None
    assert found.verdicts["K_z"].verdict == "doubtful"


def test_the_balance_is_not_judged_and_the_delay_is_that_of_the_fit():
    found = identified(readings(noise=0.01))
    verdicts = [bool(row["F_k_verdict"]) for row in rows_of_table(found)]
    assert verdicts == [True, False]
    (timing,) = (one.numbers for one in found.rig if one.code == "timing")
    assert timing["late"] == found.basis.common.delay
    with pytest.raises(ValueError, match="level 1 was read with k = 2310, not with 2400"):
        identify_readings(found.basis.readings, 2400.0)


def test_one_level_is_identified_by_its_waveform_alone():
    found = identified(readings(noise=0.01, levels=LEVELS[1:2]))
    first, answer = next(iter(found.approaches.items()))
    assert first == REFERENCE
    assert holds(answer)
    for verdict in answer.verdicts.values():
        assert verdict.verdict == "doubtful"
        assert "fewer levels" in {one.code for one in verdict.findings}
    assert np.isnan([*found.approaches["direct"].values.values()]).all()
    # nothing slips: the fundamental alone tells nothing apart
    with pytest.raises(ValueError, match="two levels or more, got 1: add records"):
        identified(readings(noise=0.01, levels=(2e-4,)))


def test_no_number_of_levels_that_are_alike_is_usable():
    found = identified(readings(noise=0.01, levels=(0.0100, 0.0101)))
    for symbol in ("F_k", "c"):
        verdict = found.verdicts[symbol]
        assert verdict.verdict == "doubtful"
        assert "alike" in {one.code for one in verdict.findings}


def test_levels_that_hardly_slip_beside_one_that_slips_far_are_not_alike():
    osc = replace(PAPER, c=1.0)
    found = identified(readings(NEAR, 0.002, (3e-4, 6e-4, 1.2e-3), osc, rate_hz=500.0, cycles=15.0))
    X = found.basis.features.X
    assert X.max() > 1000.0 * X.min()
    assert "alike" not in {one.code for one in found.findings}
    assert {verdict.verdict for verdict in found.verdicts.values()} == {"usable"}
    assert close(found, osc)


def test_rows_that_weigh_as_they_are_sure_use_what_the_records_hold():
    hz, options = 3.5, {"rate_hz": 1000.0, "channels": THREE[:2]}
    motions = motions_at(hz)
    noise = noise_of_rms(PAPER, motions, 0.01)
    bound = np.sqrt(np.diag(covariance(PAPER, motions, 1000.0, 25.0, noise, ("m",))))
    runs = [identified(readings(hz, 0.01, seed=50 + i, **options)) for i in range(4)]
    weighted = [[run.estimates["direct"].standard_errors[s] for s in ("F_k", "c")] for run in runs]
    alike = []
    for run in runs:  # Eq. (9) as published
        features = features_left_out(run.basis.readings)
        left = [solve(rows_of(of, Law(), PAPER.k)) for of in features]
        alike.append(np.diag(jackknifed([np.stack([*of.values.values()]) for of in left])))
    # 87 to 97 % and 12 to 28 %; four runs of 25 cycles know a variance to 15 %
    efficiency = bound[:2] ** 2 / np.mean(np.square(weighted), axis=0)
    assert np.all((efficiency > 0.8) & (efficiency < 1.15))
    assert np.all(bound[:2] ** 2 / np.mean(alike, axis=0) < 0.4)


def test_where_no_level_slips_there_is_no_friction_force():
    stuck = readings(noise=0.01, levels=(0.0002, 0.0003, 0.0004))
    found = identified(stuck, mass=PAPER.m)
    assert found.basis.common.stuck is not None
    assert "stuck" in {one.code for one in found.findings}
    direct, told = found.estimates["direct"], found.document()
    assert [direct.verdicts[symbol].verdict for symbol in ("F_k", "K_z")] == ["none", "none"]
    assert told["approaches"]["direct"]["F_k_N"] is told["maximum_likelihood"] is None
    assert holds(direct, symbols=["c"])
    assert np.ptp(direct.intervals["c"]) < 0.05 * PAPER.c
    # without the mass, one frequency does not tell it from a contact that slips under hardly any force
    either = identified(stuck)
    verdict = either.verdicts["F_k"]
    assert (verdict.verdict, verdict.within) == ("doubtful", math.inf)
    why = verdict.findings[0]
    assert (why.code, why.numbers["unsure"]) == ("hardly any friction", True)
    assert close(either, PAPER, symbols=["c"])


def test_hardly_any_friction_has_a_bound():
    friction = 1e-3
    found = identified(readings(noise=0.01, osc=replace(PAPER, F_k=friction), seed=3), mass=PAPER.m)
    assert found.basis.common.stuck is not None
    F_k = found.verdicts["F_k"]
    assert (F_k.verdict, F_k.within) == ("usable", math.inf)
    assert [one.code for one in F_k.findings] == ["upper limit"]
    assert friction < found.intervals["F_k"].high < 0.02
    # a contact without friction has any stiffness
    assert found.verdicts["K_z"].verdict == "none"


def test_friction_that_hides_in_the_noise_is_in_the_interval_of_the_damping():
    """Taken for damping, its work makes c 5 to 10 % too large, twice what the interval of W = b c holds."""
    osc = replace(PAPER, c=1.0, F_k=2e-3, K_z=1e6)
    found = identified(readings(6.0, 0.1, (2e-4, 4e-4, 1e-3), osc))
    assert found.basis.common.stuck is not None
    assert close(found, osc, symbols=("F_k", "c"), errors=3.0)


def test_a_level_that_does_not_slip_leaves_the_balance_without_a_star():
    found = identified(readings(noise=0.01, levels=(0.0003, 0.004, 0.008, 0.012)))
    assert [reading.slips for reading in found.basis.readings] == [False, True, True, True]
    (warning,) = found.findings
    assert (warning.code, warning.numbers["records"]) == ("only sticks", "1")
    direct = found.estimates["direct"]
    assert direct.notes == ()
    assert direct.balance.rows.usable.tolist() == [False, True, True, True]
    assert close(direct, PAPER)


# --- contacts of other kinds, harmonics that fold, and degrees of freedom ---------------------------


def followed(contact, osc, hz, noise, echo=0.0, late=0.0):
    """Readings of the independent integrator's motion on a contact, and of its echo: a part of it, so late, s."""
    omega, random = 2.0 * math.pi * hz, np.random.default_rng(4)
    t, of = np.arange(2000) / 500.0, []
    for Y in (0.004, 0.008, 0.012):
        motion = steady_on(contact, osc.m, osc.c, osc.k, Y, omega)
        x, delayed = (motion(np.mod(omega * s, 2.0 * math.pi))[0] for s in (t, t - late))
        both = (
            one + noise * one.std() * random.normal(size=t.size)
            for one in (Y * np.cos(omega * t), x + echo * delayed)
        )
        record = Record.of("followed", [*map(Channel, THREE[:2], (t, t), both)])
        of.append(read_features(record, osc.k))
    return of


def test_a_contact_that_no_departure_explains_keeps_F_k_and_c_and_its_K_z_is_doubted():
    """That of Bouc and Wen next to a noise that shows what one of Iwan lacks."""
    osc = replace(PAPER, K_z=20_000.0)
    of = followed(CONTACTS["Bouc–Wen, n = 1"](osc.K_z, osc.F_k), osc, NEAR, 2e-4)
    found = identified(of)
    for symbol in ("F_k", "c"):
        assert found.values[symbol] == pytest.approx(getattr(PAPER, symbol), rel=0.003)
    assert "far from all" in {one.code for one in found.findings}
    assert [found.verdicts[s].verdict for s in SYMBOLS] == ["usable", "usable", "doubtful"]
    off = abs(found.values["K_z"] / osc.K_z - 1.0)
    assert found.verdicts["K_z"].within is None or found.verdicts["K_z"].within > off


def test_an_error_from_a_residual_far_above_the_noise_is_a_bound_only_where_it_is_small():
    """As of records with a strong quadratic damper whose best fit has none: c = 21.3 [9.7, 25.1], and is 7.5."""
    of = readings(3.5, 0.01)
    fit = identified(of).basis.common.fit
    assert 2.0 * fit.error("c") < USELESS * fit.value("c")
    for times, scale, unbounded in (
        (1.0, 20.0, {"K_z"}),
        (1e3, 2.0, {"K_z"}),
        (1e3, 20.0, {*SYMBOLS}),
    ):
        problem = replace(fit.problem, scales=(scale, scale))
        far = replace(fit, problem=problem, covariance=times**2 * fit.covariance)
        common = SimpleNamespace(
            **{"stuck": None, "fit": far, "selection": None, "mass": None, "clear": ()},
            waveforms_hold=False,
        )
        (one,) = (x for x in on_the_oscillator(of, common) if x.code == "far from all")
        assert {s for s, size in one.effect.items() if math.isinf(size)} == unbounded


def test_an_echo_in_the_response_doubts_the_damping_that_it_looks_like():
    osc = replace(PAPER, c=9.0)
    contact = np.array([(osc.K_z, osc.F_k, 0.0)])
    found = identified(followed(contact, osc, 3.5, 1e-3, echo=0.05, late=0.06))
    off, verdict = abs(found.values["c"] / osc.c - 1.0), found.verdicts["c"]
    assert off > 0.1
    (far,) = (one for one in found.findings if one.code == "far from all")
    assert verdict.verdict == "doubtful"
    assert 0.5 * off < far.effect["c"] < 2.0 * off
    # the levels differ in the share of friction, which a gain and a turn of all of them do not change
    assert found.values["F_k"] == pytest.approx(osc.F_k, rel=0.01)
    assert found.verdicts["F_k"].verdict == "usable"


def test_harmonics_above_half_the_sampling_rate_move_no_number():
    # a contact that sticks for a sample or two, accelerations sampled a whole number of times in a cycle
    osc = replace(PAPER, c=3.0, F_k=1.0)
    for per_cycle in (250.0, 4000.0):
        sampled = {"rate_hz": 6.9 * per_cycle, "cycles": 60.0, "osc": osc}
        sampled["channels"] = ("base_acceleration", "acceleration")
        found = identified(readings(6.9, 2e-4, **sampled))
        assert found.basis.common.clear == ()
        for symbol in SYMBOLS:
            low, high = found.intervals[symbol]
            off = abs(getattr(osc, symbol) - 0.5 * (low + high))
            assert off < high - low < 0.06 * low, symbol  # four standard errors
            assert found.verdicts[symbol].verdict == "usable"


def test_the_interval_of_K_z_is_that_of_its_inverse_root():
    """K_z^{−1/2} has an interval that is symmetric about its estimate, as far as light models leave it so, and K_z
    takes its ends over."""
    K_z = identify_readings(readings(noise=0.003), PAPER.k).answer.K_z
    low, high = K_z.interval
    assert low < K_z.value < high < math.inf
    ends = high**-0.5, low**-0.5
    assert 0.5 * sum(ends) == pytest.approx(K_z.value**-0.5, abs=1e-3 * (ends[1] - ends[0]))


@pytest.mark.parametrize(
    ("scales", "groups", "freedom"),
    [((1.0, 0.0), (6, 9), 5.0), ((1.0, 1.0), (9, 9), 16.0), ((1.0, 1.0, 1.0), (5, 5, 5), 12.0)],
)
def test_the_degrees_of_freedom_lie_between_those_of_one_record_and_of_all(scales, groups, freedom):
    """The Welch–Satterthwaite formula gives g − 1 where one record contributes all variance, Σ(g − 1) where each does
    alike."""
    number = estimate_of(3.0, np.array(scales), [g - 1.0 for g in groups])
    low, high = number.interval
    assert 0.5 * (low + high) == pytest.approx(3.0)
    assert number.standard_error == pytest.approx(math.sqrt(sum(scales)))
    reach = 0.5 * (high - low) / math.sqrt(sum(scales))
    assert stats.t.cdf(reach, freedom) == pytest.approx(0.975, abs=1e-9)
