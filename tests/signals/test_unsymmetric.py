"""Records with even harmonics, a base of several harmonics and long stops: what is read of them balances all the same.

The motion comes from an integrator outside the package (`stopping.py`), with the integrals over its period.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.signals.conditioning import condition
from dampbalance.signals.mean_harmonics import Reading
from signals.stopping import Stopping, steady

TWO = {1: 1.82e-3, 2: 2e-5j, 3: 2e-4}
MOTIONS = {
    "stops": Stopping(),
    "position": Stopping(slope=100.0),
    "base": Stopping(base=TWO),
    "both": Stopping(base=TWO, slope=50.0, forward=1.1, back=0.9, omega=2.0 * math.pi * 1.0013),
}


def record(name: str, noise=0.0, seed=0, step=0.0, cycles=10.2) -> Record:
    """Base and mass with noise (rms over that of each signal), rounded to steps of a converter, m."""
    of = steady(MOTIONS[name])
    t = 0.013 + np.arange(int(cycles * 250.0 * 2.0 * math.pi / of.of.omega)) / 250.0
    clean = np.array([of.of.y(t), of.x(t)])
    own = (
        noise
        * clean.std(axis=1)[:, None]
        * np.random.default_rng(seed).standard_normal(clean.shape)
    )
    y, x = step * np.round((clean + own) / step) if step else clean + own
    channels = [Channel("base_displacement", t, y), Channel("displacement", t, x)]
    return Record.of(str(seed), channels)


def reading(name: str, *args, **more) -> Reading:
    """Read without a waveform: no oscillator of the package moves like that."""
    return Reading(condition(record(name, *args, **more), MOTIONS[name].k), terms=("c_r",))


@pytest.mark.parametrize("name", MOTIONS)
def test_without_noise_the_balance_is_exact(name):
    of, f = steady(MOTIONS[name]), reading(name).features
    assert of.stopped > 0.25  # of the period: what these records are about
    # acceleration jumps where the mass stops, so x_n falls as n^−3 beyond the 31 harmonics: b lacks some 1e-5, and in
    # the middle of a rest they ring by less; W lacks nothing but what samples fold back
    assert f.X[0] == pytest.approx(0.5 * of.range, rel=1e-5)
    assert f.a[0] == pytest.approx(of.travel, rel=1e-5)
    assert f.b[0] == pytest.approx(of.b, rel=5e-5)
    assert f.integrals["c_r"][0] == pytest.approx(of.b - of.relative, rel=1e-4)
    assert f.W[0] == pytest.approx(of.W, rel=2e-7)


def test_of_a_symmetric_record_nothing_even_is_read():
    read = reading("stops", 1e-3)
    assert read.mean.even.shape == read.mean.base.shape == (1, 0)
    assert read.warnings == ()


def test_replicates_scatter_about_the_estimate_as_the_standard_errors_say():
    read = reading("both", 0.01, 1)
    drawn = read.features_of(read.resampled(3000, np.random.default_rng(1)))
    for feature in ("X", "a", "b", "W"):
        values, error = getattr(drawn, feature), read.standard_errors[feature]
        # bootstrap and jackknife agree to first order, of ten rows to a tenth
        assert values.std() == pytest.approx(error, rel=0.15), feature
        assert abs(values.mean() - getattr(read.features, feature)[0]) < 0.15 * error, feature


def test_one_step_of_gain_and_time_turns_every_harmonic():
    read, cycle = reading("both"), steady(MOTIONS["both"])
    angle, omega = 1e-3, read.steady.omega
    f = read.features_of(read.mean.followed_by(read.mean.changed(1.0, 1.0, angle, 1.0)))
    # neither the range of a motion nor b knows when it is, to first order; the work does
    assert f.b[1] == pytest.approx(f.b[0], rel=1e-5)
    # the middle of a rest is found to a thousandth of the cycle, and the harmonics ring there
    assert f.X[1] == pytest.approx(f.X[0], rel=1e-5)
    t = np.arange(4096) / 4096 * 2.0 * math.pi / omega
    mean_power = float(np.mean(cycle.of.y(t, 1) * cycle.x(t - angle / omega)))
    assert f.W[1] == pytest.approx(-cycle.of.k * mean_power * 2.0 * math.pi / omega, rel=1e-5)


@pytest.mark.parametrize(("name", "step"), [("stops", 1e-7), ("stops", 1e-6), ("both", 1e-6)])
def test_a_motion_that_stops_is_neither_clipped_nor_dropped_out(name, step):
    kept = condition(record(name, 1e-3, 3, step), 1191.0)
    assert kept.cycles == 10
    assert not {"clipped", "spikes"} & {one.code for one in kept.warnings}
