"""What identifications of free decays say of other laws, on records of an integrator of another make."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from blind.decays import departing, falling, record
from blind.field import Rig, follow
from dampbalance import identify
from dampbalance.fit.decay_departures import departures_of
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
        assert value == pytest.approx(result.basis.fit.value(symbol), abs=1e-2 * error)
        assert error == pytest.approx(result.basis.fit.error(symbol), rel=0.1)


def holds(result, decay):
    """Whether the intervals of F_k and c hold the truth, by symbol."""
    ends = {s: result.reference.intervals[s] for s in ("F_k", "c")}
    return {s: low <= getattr(decay, s) <= high for s, (low, high) in ends.items()}


def named(result):
    """The departures that a sentence names."""
    said = [one for one in result.findings if one.code == "weighs"]
    return {one.numbers["what"][0].code for one in said}


def test_damping_that_grows_with_the_speed_is_found_and_the_numbers_are_right():
    decay = departing(SOUND, "quadratic", 2, 0.4)
    result = found_in(decay, laws=True)
    assert "c_2" in named(result)
    assert holds(result, decay) == {"F_k": True, "c": True}
    assert result.laws.chosen == ("F_k", "c", "c_2")
    truth = {"F_k": decay.F_k, "c": decay.c, "c_2": decay.departure.quadratic}
    for name, (value, error) in result.laws.laws[0].coefficients.items():
        assert abs(value - truth[name]) < FAR * error


def test_what_no_law_of_damping_explains_is_named_and_fitted_along():
    decay = departing(SOUND, "cubic", 3, 0.1)
    found = found_in(decay)
    assert "k_3" in named(found)
    assert holds(found, decay) == {"F_k": True, "c": True}


def test_decays_without_friction_support_a_law_without():
    decay = replace(SOUND, F_k=1e-9, K_z=1.0, lasts=(6.0,))
    result = found_in(decay, laws=True)
    assert "F_k" not in result.laws.chosen
    assert result.laws.laws[0].coefficients["c"][0] == pytest.approx(decay.c, rel=0.02)


MOVES = 1.4
"""Time for which `SOUND` moves after its release, s."""


def faded(share, heights):
    """Return records of `SOUND` from some heights, of an integrator in fixed steps: friction falls by a share of F_k
    within the longest of them, about F_k, and as fast in all."""
    random, records = np.random.default_rng(3), []
    # the middle of a slow sine is straight to a hundredth
    slow = Rig(SOUND.m, SOUND.c, SOUND.k, varying=share / 0.4, rate=-0.4 / MOVES, phase=0.2)
    contact = np.array([(SOUND.K_z, SOUND.F_k, 0.0)])
    step, finer = 1.0 / SOUND.rate_hz, 40
    for height in heights:
        x = height * SOUND.starts[0][1]
        state, force = np.array([x, 0.0, 0.0, 0.0]), np.array([(1.0 + 0.5 * share) * SOUND.F_k])
        out = np.empty((3, round(2.0 * MOVES / step)))
        follow(slow, contact, state, force, 0.0, step / finer, finer, out)
        noisy = out[0] + 0.001 * x * random.standard_normal(out.shape[1])
        channel = Channel("displacement", step * np.arange(noisy.size), noisy)
        records.append(Record.of(f"from {height}", [channel]))
    return records


@pytest.mark.parametrize("heights", [(1.0,), (1.0, 0.6, 0.35)], ids=["one", "three"])
def test_friction_that_fades_is_found_and_not_taken_for_damping(heights):
    found = identify_decay_records(faded(0.2, heights), SOUND.k)
    assert "fading" in named(found)
    assert holds(found, SOUND) == {"F_k": True, "c": True}
    assert found.verdicts["F_k"].verdict == USABLE


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
    assert "falling" in named(found)
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
    assert "corner" in named(found)
    assert found.basis.fit.value("corner") == pytest.approx(corner, rel=0.05)
    for symbol in ("F_k", "c"):
        assert found.verdicts[symbol].verdict == USABLE
        off = found.reference.values[symbol] - getattr(SOUND, symbol)
        assert abs(off) < FAR * found.reference.standard_errors[symbol]


def test_laws_of_decays_can_be_asked_of_identify():
    measured, _ = record(SOUND)
    channel = measured.responses[0]
    data = {"time_s": channel.t, "displacement_m": channel.values}
    found = identify(data, stiffness=SOUND.k, laws=True)
    assert found.options["laws"]
    assert found.document()["laws"]["chosen"] == ["F_k", "c"]
    assert {one["name"] for one in found.document()["weights"]} >= {"", "c_2", "k_3"}


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
