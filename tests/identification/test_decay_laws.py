"""What identifications of free decays say of other laws, on records of an integrator of another make."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from blind.decays import departing, falling, record
from dampbalance import identify
from dampbalance.fit.decay import departures_of
from dampbalance.identification.answer import DOUBTFUL, USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.identification.law_comparison import fit_law
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from fit.exact import decay_of, fitted
from identification.releases import FAR, PLUCKED

SOUND = replace(PLUCKED, lasts=(3.5,), rate_hz=250.0, noise=0.003)


def found_in(decay, **options):
    return identify_decay_records([record(decay, 1)[0]], decay.k, **options)


def test_sound_decays_raise_no_doubt_and_keep_friction_and_viscous_damping():
    result = found_in(SOUND, laws=True)
    assert result.verdicts["F_k"].verdict == result.verdicts["c"].verdict == USABLE
    assert result.laws.chosen == ("F_k", "c")
    for symbol, (value, error) in result.laws.laws[0].coefficients.items():
        assert value == pytest.approx(result.reference.values[symbol], abs=1e-2 * error)
        assert error == pytest.approx(result.basis.fit.error(symbol), rel=0.1)


def test_decays_under_another_law_are_doubtful_and_its_coefficients_found():
    decay = departing(SOUND, "quadratic", 2, 0.4)
    result = found_in(decay, laws=True)
    for of_law in ("F_k", "c"):
        verdict = result.verdicts[of_law]
        assert verdict.verdict == DOUBTFUL
        (why,) = verdict.findings
        assert (why.code, why.numbers["value"][0]) == ("other law", "c_2")
    assert result.laws.chosen == ("F_k", "c", "c_2")
    truth = {"F_k": decay.F_k, "c": decay.c, "c_2": decay.departure.quadratic}
    for name, (value, error) in result.laws.laws[0].coefficients.items():
        assert abs(value - truth[name]) < FAR * error


def test_what_no_law_of_damping_explains_is_named_and_fitted_along():
    decay = departing(SOUND, "cubic", 3, 0.1)
    found = found_in(decay)
    assert [one.numbers["value"][0] for one in found.findings if one.code == "included"] == ["k_3"]
    for name in ("F_k", "c"):
        off = found.reference.values[name] - getattr(decay, name)
        assert abs(off) < FAR * found.reference.standard_errors[name]


def test_decays_without_friction_support_a_law_without():
    decay = replace(SOUND, F_k=1e-9, K_z=1.0, lasts=(6.0,))
    result = found_in(decay, laws=True)
    assert "F_k" not in result.laws.chosen
    assert result.laws.laws[0].coefficients["c"][0] == pytest.approx(decay.c, rel=0.02)


def test_what_the_decays_hint_at_is_in_the_interval_and_raises_no_doubt():
    """Some of 12 decays in noise of 5 % under damping with a quadratic share of 20 % hint at it and none shows it."""
    hinted = 0
    for i in range(12):
        decay = departing(replace(SOUND, index=i, noise=0.03), "quadratic", 2, 0.2)
        result = found_in(decay)
        said = [one for one in result.rig if one.code == "hints of another law"]
        if not said:
            continue
        hinted += 1
        p = result.reference.parameters["c"]
        (stated,) = (abs(by) for symbol, _, by in said[0].numbers["changes"] if symbol == "c")
        assert p.value - p.interval.low > stated
        assert p.interval.high - p.value > stated
    assert hinted >= 1


def test_friction_that_falls_with_speed_is_no_silent_error_where_it_shows():
    """Ten sets of another integrator, friction 5 to 15 % higher at rest, in noise of 0.3 %: convex in the speed, as
    quadratic damping is."""
    random, right = np.random.default_rng(0), 0
    for i in range(10):
        part, speed = random.uniform(0.05, 0.15), random.uniform(0.05, 0.3)
        decay = falling(replace(SOUND, index=i), part, speed)
        found = found_in(decay)
        for symbol in ("F_k", "c"):
            low, high = found.reference.intervals[symbol]
            truth = getattr(decay, symbol)
            near = abs(found.reference.values[symbol] / truth - 1.0) < 0.1
            right += low <= truth <= high or near or found.verdicts[symbol].verdict == DOUBTFUL
    assert right >= 14


def test_friction_that_falls_with_the_speed_is_named_and_fitted_along():
    """Of another integrator, 25 % higher at rest: F_k is the force at high speed, and F_k + p that at rest."""
    decay = falling(SOUND, 0.25, 0.15)
    found = found_in(decay)
    assert "falls along" in {one.code for one in found.findings}
    for symbol in ("F_k", "c"):
        assert found.verdicts[symbol].verdict == USABLE
        assert found.reference.values[symbol] == pytest.approx(getattr(decay, symbol), rel=0.1)
    assert found.basis.fit.F_k + found.basis.fit.value("falling") == pytest.approx(
        1.25 * decay.F_k, rel=0.02
    )


def test_an_ac_coupling_of_a_decay_is_named_and_fitted_along():
    """A high-pass of first order, whose corner is 0.15 of the natural frequency, at rest before the release."""
    measured, _ = record(replace(SOUND, rate_hz=1000.0))
    channel = measured.responses[0]
    corner = 0.15 * SOUND.omega_n / (2.0 * np.pi)
    poles = butter(1, corner, "high", fs=1000.0, output="sos")
    values = sosfilt(poles, channel.values - channel.values[0])
    found = identify_decay_records(
        [Record.of("coupled", [Channel(channel.quantity, channel.t, values)])], SOUND.k
    )
    assert "corner along" in {one.code for one in found.findings}
    assert found.basis.fit.value("corner") == pytest.approx(corner, rel=0.05)
    for symbol in ("F_k", "c"):
        assert found.verdicts[symbol].verdict == USABLE
        off = found.reference.values[symbol] - getattr(SOUND, symbol)
        assert abs(off) < FAR * found.reference.standard_errors[symbol]


def test_the_verdict_on_a_stiffness_agrees_with_what_is_said_of_the_contact():
    """K_z is conditional on a contact that yields at once, and the sentence says so: no doubt follows from it."""
    found = found_in(replace(SOUND, noise=0.01))
    assert "contact taken as sudden" in {one.code for one in found.rig}
    assert found.reference.verdicts["K_z"].verdict == USABLE


def test_laws_of_decays_can_be_asked_of_identify():
    measured, _ = record(SOUND)
    channel = measured.responses[0]
    data = {"time_s": channel.t, "displacement_m": channel.values}
    found = identify(data, stiffness=SOUND.k, laws=True)
    assert found.options["laws"]
    assert found.document()["laws"]["chosen"] == ["F_k", "c"]
    assert {one["symbol"] for one in found.document()["departures"]} >= {"c_2", "k_3"}


def test_in_noise_the_coefficients_that_are_missing_have_the_errors_that_they_state():
    """60 drawings: the scatter of value over error is 1 within 3 of its own standard errors, 0.1."""
    point = np.array([0.1, 0.3, 6000.0**-0.5, 1.0, 0.0, 0.005, 0.0, 2.0])
    times = np.arange(0.0, 4.0, 0.005)
    drawn = []
    for seed in range(60):
        fit = fitted(decay_of(point, 400.0, times, 1e-5, seed=seed), 400.0, point)
        drawn.append([other.value / other.error for other in departures_of(fit)[:3]])
    scatter = np.std(drawn, axis=0)
    assert np.all(np.abs(scatter - 1.0) < 0.3)


def test_the_law_of_the_fit_is_the_fit():
    measured, _ = record(SOUND)
    fit = identify_decay_records([measured], SOUND.k).basis.fit
    law = fit_law(fit, ("F_k", "c"))
    assert law is not None
    assert law.chi_square == pytest.approx(fit.chi_square, rel=1e-6)
    assert law.error("c") == pytest.approx(fit.error("c"), rel=0.1)
