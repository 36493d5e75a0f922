"""Features of noisy records: exact without noise, with standard errors that are those of the scatter."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.features import FEATURE_COLUMNS, of_orbit
from dampbalance.fit.steady_search import fit_records
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.mean_harmonics import Reading, read_features
from dampbalance.solver import NORMAL_95
from paper_case import FREQUENCIES_HZ, NEAR, OMEGA, PAPER, orbits_at
from signals.harmonics import with_own_fit

DISPLACEMENT = ("base_displacement", "displacement")
BOTH = (*DISPLACEMENT, "acceleration")


def _orbit(frequency_hz=NEAR, Y=0.004, **changed):
    (orbit,) = orbits_at(frequency_hz, [Y], replace(PAPER, **changed))
    return orbit


def _measured(orbit, noise, channels=DISPLACEMENT, seed=3, cycles=40.0, rate_hz=3000.0):
    taken = {"rate_hz": rate_hz, "cycles": cycles, "noise": noise, "seed": seed}
    return measured_orbit(orbit, channels=channels, **taken)


def _read(orbit, noise, *given, **more):
    return with_own_fit(read_features(_measured(orbit, noise, *given, **more), PAPER.k))


def onset_resolved(reading):
    """Whether the contact slips and the length of its microstick line stands out of the noise."""
    fit = reading.waveform
    return bool(reading.slips) and fit.rho > NORMAL_95 * fit.rho_error


@pytest.mark.parametrize("channels", [DISPLACEMENT, BOTH], ids=["x", "x+a"])
@pytest.mark.parametrize("frequency_hz", FREQUENCIES_HZ.values())
def test_without_noise_the_features_are_exact(frequency_hz, channels):
    orbit = _orbit(frequency_hz)
    reading, exact = _read(orbit, 0.0, channels), of_orbit(orbit)
    assert reading.warnings == ()
    assert onset_resolved(reading)
    for name in FEATURE_COLUMNS:
        # waveform sampled at 1,024 points of half a cycle, harmonics beyond those fitted: parts in a million
        expected = getattr(exact, name)[0]
        assert getattr(reading.features, name)[0] == pytest.approx(expected, rel=3e-6), name
    cycle = reading.averaged_cycle(200)
    t = cycle["phase"] / orbit.motion.omega
    np.testing.assert_allclose(cycle["x"], orbit.state(t).x, atol=1e-5 * orbit.X)
    np.testing.assert_allclose(cycle["v"], orbit.state(t).v, atol=1e-4 * cycle["v"].max())
    np.testing.assert_allclose(cycle["y"], orbit.motion.y(t), atol=1e-8)


def test_standard_errors_are_those_of_the_scatter():
    orbit = _orbit()
    readings = [_read(orbit, 0.01, BOTH, seed=s, rate_hz=1500.0, cycles=25.0) for s in range(50)]
    names = "X X_s V_s t_s phi_fundamental phi_reversal X_1 X_3 X_5 a b W"
    for name in names.split():
        values = np.array([getattr(r.features, name)[0] for r in readings])
        error = np.sqrt(np.mean([r.standard_errors[name] ** 2 for r in readings]))
        # 50 runs know the scatter to 10 %, its mean to 14 % of it: three times that, and a little for the jackknife
        assert values.std(ddof=1) == pytest.approx(error, rel=0.35), name
        assert abs(values.mean() - getattr(of_orbit(orbit), name)[0]) < 0.5 * error, name


def test_replicates_scatter_as_the_standard_errors_say_about_the_estimate():
    reading = _read(_orbit(), 0.01, BOTH)
    replicates = reading.features_of(reading.resampled(2000, np.random.default_rng(1)))
    for name in ("X", "X_s", "t_s", "X_1", "X_3", "a", "b", "W", "phi_fundamental"):
        values, error = getattr(replicates, name), reading.standard_errors[name]
        # bootstrap and jackknife agree to first order; 2,000 replicates know the scatter to 1.6 %
        assert values.std() == pytest.approx(error, rel=0.08), name
        assert abs(values.mean() - getattr(reading.features, name)[0]) < 0.12 * error, name
        off = getattr(reading.features, name)[0] - getattr(of_orbit(_orbit()), name)[0]
        assert abs(off) < 4.0 * error, name


def test_an_error_that_all_cycles_share_enters_replicates_and_a_jackknife():
    """(g − 1)/g of the squares about the mean are the squares of the errors, whatever their number."""
    reading = _read(_orbit(), 0.01)
    assert reading.with_hidden_errors() == []
    steady, n = reading.steady, reading.lines.n
    hidden = 1e-6 * np.arange(1.0, steady.X_hidden.size + 1.0)
    base = np.where(np.arange(steady.Y_hidden.size) == 1, 3e-6, 0.0)
    more = Reading(replace(steady, X_hidden=hidden, Y_hidden=base))
    (means,) = more.with_hidden_errors()
    expected = np.concatenate([hidden[n], hidden[n], [3e-6]])

    def squares(means):
        parts = np.column_stack([means.x.real, means.x.imag, means.Y])
        return np.sum((parts - parts.mean(axis=0)) ** 2, axis=0)

    groups, count = len(means.Y), 4000
    np.testing.assert_allclose(squares(means) * (groups - 1) / groups, expected**2, rtol=1e-9)
    drawn = [of.resampled(count, np.random.default_rng(5)) for of in (reading, more)]
    added = (squares(drawn[1]) - squares(drawn[0])) / count
    # 4,000 draws know a variance to 2.2 %, and how two draws go together to 1/63 of both
    spread = (squares(drawn[0]) / count) ** 0.5
    assert np.all(np.abs(added - expected**2) < 0.1 * expected**2 + 8.0 / 63.0 * spread * expected)


def test_squares_of_harmonics_are_freed_of_noise():
    reading = _read(_orbit(11.1, 0.012), 0.02, cycles=20.0)
    steady, f = reading.steady, reading.features
    plain = np.abs(steady.mean(steady.X)) ** 2
    bias = 2.0 * steady.X_error**2  # E|x̂|² = |x|² + variance, of the real and of the imaginary part
    assert bias[3] > 0.01 * plain[3]
    assert f.X_1[0] ** 2 == pytest.approx(plain[1] - bias[1], rel=1e-12)
    assert f.X_3[0] ** 2 == pytest.approx(plain[3] - bias[3], rel=1e-12)
    # replicates have the noise of the mean and their own
    square = reading.features_of(reading.resampled(4000, np.random.default_rng(5))).X_3 ** 2
    # 4,000 replicates know the mean of X_3² to 1/60 of its scatter: four of these
    assert square.mean() == pytest.approx(f.X_3[0] ** 2, abs=4.0 * square.std() / 60.0)


def test_an_onset_that_noise_hides_enters_with_its_error():
    reading = _read(_orbit(Y=0.012, K_z=2e7), 0.05)
    assert reading.slips
    assert not onset_resolved(reading)
    length, slope = reading.waveform.length, reading.waveform.length_slope
    covariance = fit_records([reading.lines], PAPER.k).covariance
    f = reading.features
    assert f.X[0] + f.X_s[0] == pytest.approx(length, rel=1e-9)
    assert abs(length - 2.0 * PAPER.F_k / 2e7) < 4.0 * math.sqrt(slope @ covariance @ slope)
    assert 0.0 < reading.standard_errors["t_s"] < math.inf


def test_a_linear_response_has_no_onset():
    reading = _read(_orbit(F_k=0.0), 0.01)
    assert not onset_resolved(reading)
    # W = b c: the rows of a linear oscillator say that there is no friction
    assert reading.features.W[0] == pytest.approx(90.0 * reading.features.b[0], rel=1e-3)


def test_another_waveform_has_no_onset_and_its_harmonics_are_its_own():
    base, channel = _measured(_orbit(), 0.001).channels.values()
    added = 2e-5
    wrong = channel.values + added * np.cos(5.0 * OMEGA * channel.t + 1.0)
    record = Record.of("distorted", [base, replace(channel, values=wrong)])
    reading = with_own_fit(read_features(record, PAPER.k))
    assert (reading.waveform, reading.slips) == (None, None)
    f = reading.features
    assert (f.X_s[0], f.t_s[0], f.V_s[0]) == (-f.X[0], 0.0, 0.0)
    assert f.a[0] == 4.0 * f.X[0]  # the rest is W_0 of the balance
    assert math.isnan(reading.standard_errors["t_s"])
    # the fifth harmonic is what the record holds: the oscillator's, and what was added
    total = abs(_orbit().harmonics(3)[2] + added * np.exp(1j))
    assert f.X_5[0] == pytest.approx(total, abs=4.0 * reading.steady.X_error[5])
