"""What identifications of free decays say of other laws, on records of an integrator of another make."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from blind.decays import departing, falling, record
from blind.field import Rig, follow
from dampbalance import identify
from dampbalance.identification.answer import USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from identification.releases import FAR, PLUCKED

SOUND = replace(PLUCKED, lasts=(3.5,), rate_hz=250.0, noise=0.003)
MOVES = 1.4
"""Time for which `SOUND` moves after its release, s."""


def test_sound_decays_raise_no_doubt_and_keep_friction_and_viscous_damping():
    channel = record(SOUND)[0].responses[0]
    data = {"time_s": channel.t, "displacement_m": channel.values}
    result = identify(data, SOUND.k, laws=True)
    assert result.verdicts["F_k"].verdict == result.verdicts["c"].verdict == USABLE
    assert result.document()["laws"]["chosen"] == ["F_k", "c"]
    assert {one["name"] for one in result.document()["weights"]} >= {"", "c_2", "k_3"}
    for symbol, (value, error) in result.laws.laws[0].coefficients.items():
        assert value == pytest.approx(result.basis.fit.value(symbol), abs=1e-2 * error)
        assert error == pytest.approx(result.basis.fit.error(symbol), rel=0.1)


def faded():
    """Records of `SOUND` from three heights, of an integrator in fixed steps: friction falls by a fifth of F_k within
    the longest of them, about F_k, and as fast in all."""
    random, records, share = np.random.default_rng(3), [], 0.2
    # the middle of a slow sine is straight to a hundredth
    slow = Rig(SOUND.m, SOUND.c, SOUND.k, varying=share / 0.4, rate=-0.4 / MOVES, phase=0.2)
    contact = np.array([(SOUND.K_z, SOUND.F_k, 0.0)])
    step, finer = 1.0 / SOUND.rate_hz, 40
    for height in (1.0, 0.6, 0.35):
        x = height * SOUND.starts[0][1]
        state, force = np.array([x, 0.0, 0.0, 0.0]), np.array([(1.0 + 0.5 * share) * SOUND.F_k])
        out = np.empty((3, round(2.0 * MOVES / step)))
        follow(slow, contact, state, force, 0.0, step / finer, finer, out)
        noisy = out[0] + 0.001 * x * random.standard_normal(out.shape[1])
        channel = Channel("displacement", step * np.arange(noisy.size), noisy)
        records.append(Record.of(f"from {height}", [channel]))
    return records


CORNER = 0.15 * SOUND.omega_n
"""Of a high-pass of first order, at rest before the release, rad/s."""


def coupled():
    channel = record(replace(SOUND, rate_hz=500.0))[0].responses[0]
    poles = butter(1, CORNER / (2.0 * np.pi), "high", fs=500.0, output="sos")
    values = sosfilt(poles, channel.values - channel.values[0])
    return [Record.of("coupled", [Channel(channel.quantity, channel.t, values)])]


QUADRATIC, CUBIC = departing(SOUND, "quadratic", 2, 0.4), departing(SOUND, "cubic", 3, 0.1)
SMOOTH = replace(SOUND, F_k=1e-9, K_z=1.0, lasts=(6.0,))


@pytest.mark.parametrize(("decay", "chosen"), [(QUADRATIC, ("F_k", "c", "c_2")), (SMOOTH, ("c",))])
def test_the_law_that_a_decay_has_is_chosen(decay, chosen):
    laws = identify_decay_records([record(decay, 1)[0]], decay.k, laws=True).laws
    assert laws.chosen == chosen
    truth = {"F_k": decay.F_k, "c": decay.c, "c_2": decay.departure.quadratic}
    for name, (value, error) in laws.laws[0].coefficients.items():
        assert abs(value - truth[name]) < FAR * error < 0.7 * truth[name]


MADE = {
    "c_2": (lambda: [record(QUADRATIC, 1)[0]], QUADRATIC.departure.quadratic),
    "k_3": (lambda: [record(CUBIC, 1)[0]], CUBIC.departure.cubic),
    # F_k is the force at high speed, and F_k + p that at rest
    "falling": (lambda: [record(falling(SOUND, 0.25, 0.15), 1)[0]], 0.25 * SOUND.F_k),
    "fading": (faded, 0.2),
    "corner": (coupled, CORNER / (2.0 * np.pi)),
}


@pytest.mark.parametrize("name", MADE)
def test_a_departure_is_named_and_fitted_along(name):
    made, size = MADE[name]
    found = identify_decay_records(made(), SOUND.k)
    said = [one for one in found.findings if one.code == "weighs"]
    assert name in {one.numbers["what"][0].code for one in said}
    fit = found.basis.fit
    assert abs(fit.value(name) - size) < FAR * fit.error(name) < 0.5 * size
    for symbol in ("F_k", "c"):
        assert found.verdicts[symbol].verdict == USABLE
        low, high = found.reference.intervals[symbol]
        assert low <= getattr(SOUND, symbol) <= high, symbol
