"""Features and harmonics of noisy records: exact without noise, with standard errors that are those of the scatter."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import BaseMotion, Oscillator, identify_forced, steady_orbit
from dampbalance.features import FEATURE_COLUMNS, of_orbit
from dampbalance.fit.steady_search import fit_records
from dampbalance.motion.law_steady import steady_response
from dampbalance.records.record import Record
from dampbalance.records.synthetic import measured_orbit
from dampbalance.signals.conditioning import condition
from dampbalance.signals.mean_harmonics import Reading, read_features
from dampbalance.signals.record_harmonics import RecordHarmonics
from dampbalance.signals.thresholds import CERTAIN
from dampbalance.solver import NORMAL_95
from paper_case import FREQUENCIES_HZ, NEAR, OMEGA, PAPER, orbits_at

DISPLACEMENT = ("base_displacement", "displacement")
BOTH = (*DISPLACEMENT, "acceleration")


def _orbit(frequency_hz=NEAR, Y=0.004, **changed):
    (orbit,) = orbits_at(frequency_hz, [Y], replace(PAPER, **changed))
    return orbit


def _measured(orbit, noise, channels=DISPLACEMENT, seed=3, cycles=40.0, rate_hz=3000.0):
    taken = {"rate_hz": rate_hz, "cycles": cycles, "noise": noise, "seed": seed}
    return measured_orbit(orbit, channels=channels, **taken)


def _fitted(record):
    """What is read of the record, with the waveform that is fitted to it alone, where one fits."""
    reading = read_features(record, PAPER.k)
    fit = fit_records([reading.lines], PAPER.k)
    return replace(reading, waveform=fit.waveforms[0]) if fit and fit.adequate else reading


def _read(orbit, noise, *given, **more):
    return _fitted(_measured(orbit, noise, *given, **more))


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
    assert abs(square.mean() - f.X_3[0] ** 2) < 4.0 * square.std() / 60.0


def test_an_onset_that_noise_hides_enters_with_its_error():
    reading = _read(_orbit(Y=0.012, K_z=2e7), 0.05)
    assert (reading.slips, onset_resolved(reading)) == (True, False)
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
    reading = _fitted(record)
    assert (reading.waveform, reading.slips) == (None, None)
    f = reading.features
    assert (f.X_s[0], f.t_s[0], f.V_s[0]) == (-f.X[0], 0.0, 0.0)
    assert f.a[0] == 4.0 * f.X[0]  # the rest is W_0 of the balance
    assert math.isnan(reading.standard_errors["t_s"])
    # the fifth harmonic is what the record holds: the oscillator's, and what was added
    total = abs(_orbit().harmonics(3)[2] + added * np.exp(1j))
    assert f.X_5[0] == pytest.approx(total, abs=4.0 * reading.steady.X_error[5])


# --- the harmonics that an oscillator is fitted to, with their errors and what folds onto them ----------------------

(ORBIT,) = orbits_at(NEAR, (0.008,))


def of_record(noise: float, start: float = 0.0, seed: int = 1) -> RecordHarmonics:
    taken = {"rate_hz": 2000.0, "cycles": 40.0, "noise": noise, "seed": seed, "start": start}
    return RecordHarmonics.of(condition(measured_orbit(ORBIT, **taken), PAPER.k))


def test_they_are_those_of_the_motion_wherever_the_record_begins():
    for start in (0.0, 0.0317, 0.15):
        lines = of_record(0.0, start)
        assert lines.n.tolist() == list(range(1, 2 * lines.n.size, 2))
        # phases count from the peak of the base; rounding, and the aliases of the harmonics beyond
        off = np.abs(lines.x - ORBIT.harmonics(lines.n.size)) / abs(lines.x[0])
        assert off.max() < 2e-6
        assert abs(lines.Y / 0.008 - 1.0) < 1e-9
        assert abs(lines.omega / (2.0 * math.pi * NEAR) - 1.0) < 1e-9
        assert lines.interval == 5e-4


def test_their_errors_are_those_of_the_scatter():
    read = [of_record(0.01, seed=seed) for seed in range(40)]
    count = min(lines.n.size for lines in read)
    x = np.array([lines.x[:count] for lines in read]) - ORBIT.harmonics(count)
    errors = np.sqrt(np.mean([lines.x_error[:count] ** 2 for lines in read], axis=0))
    scatter = np.sqrt(np.mean(np.abs(x) ** 2 / 2.0, axis=0))
    # small ones, which the phase of the base does not move; 40 draws of two parts know a scatter to 8 %
    np.testing.assert_allclose(scatter[2:], errors[2:], rtol=0.3)
    amplitudes = np.array([lines.Y for lines in read])
    # a scatter of 40 draws is known to 11 %
    assert abs(amplitudes.std() / read[0].Y_error - 1.0) < 0.4
    assert 38 <= read[0].rows <= 42


def test_what_stands_out_of_the_noise_is_clear_and_the_fundamental_always_is():
    x = np.array([0.5, CERTAIN * 1.01, CERTAIN * 0.99, 30.0])
    lines = RecordHarmonics(1.0, 1.0, 0.1, np.arange(1, 8, 2), x.astype(complex), np.ones(4), 10)
    assert lines.clear.tolist() == [True, True, False, True]
    # of x_1 = 0.5 ± 1, and of Y = 1 ± 0.1, once and where it was added to x
    assert lines.relative_error == math.hypot(2.0, 0.1)


# --- beyond half the sampling rate: with a whole number of samples to the cycle, onto the same phases in every cycle -

OSC = Oscillator(m=3.1, c=9.0, k=5200.0, K_z=160_000.0, F_k=2.1)


def orbit_at(hertz: float, Y: float = 0.005):
    return steady_orbit(OSC, BaseMotion(Y, 2.0 * math.pi * hertz))


@pytest.mark.parametrize(
    ("quantity", "hertz", "rate", "start"),
    [
        ("acceleration", 4.0, 2000.0, 0.0),
        ("relative_acceleration", 5.0, 2000.0, 0.0317),
        ("velocity", 5.0, 2000.0, 0.2),
        ("displacement", 20.0, 400.0, 0.013),
        # 399 samples to the cycle, onto which 2 × 399 ± n fold
        ("acceleration", 4.0, 1596.0, 0.1),
        # what folds turns in the record, by 1.2 of a turn
        ("acceleration", 4.0, 1999.85, 0.1),
    ],
)
def test_what_is_added_is_that_of_the_exact_motion(quantity, hertz, rate, start):
    orbit = orbit_at(hertz)
    taken = {"rate_hz": rate, "cycles": 33.3, "start": start}
    record = measured_orbit(orbit, channels=("base_displacement", quantity), **taken)
    lines = RecordHarmonics.of(condition(record, OSC.k))
    response = steady_response(OSC, orbit.motion, {})
    added = lines.x - response.harmonics(lines.n.size)
    folded = lines.folds.of(response.high_harmonics(lines.folds.orders))
    assert np.abs(added - folded).max() < 0.1 * np.abs(added).max()


def test_high_harmonics_are_those_of_the_orbit_and_near_them_of_other_motions():
    n = np.array([401, 503])
    for law, close in (({}, 1e-9), ({"c_2": 5.0}, 1e-3)):
        response = steady_response(OSC, BaseMotion(0.012, 8.0 * math.pi), law)
        exact = response.harmonics(300)[n // 2]
        assert response.high_harmonics(n) == pytest.approx(exact, rel=close)


def leveled(Y: float, i: int, filtered: bool) -> Record:
    """A noisy record, behind a filter that takes off all above half the sampling rate, or without one."""
    orbit, channels = orbit_at(4.0, Y), ("base_acceleration", "acceleration")
    taken = {"rate_hz": 2000.0, "cycles": 32.0, "noise": 0.002, "seed": i, "start": 0.0123 * i}
    base, x = measured_orbit(orbit, channels=channels, **taken).channels.values()
    n = np.arange(1, 250, 2)
    rates = 1j * n * orbit.motion.omega
    below = (np.exp(np.outer(x.t, rates)) @ (orbit.harmonics(n.size) * rates**2)).real
    off = (below - orbit.state(x.t).acceleration) * filtered
    return Record.of(f"level {i}", [base, replace(x, values=x.values + off)])


@pytest.mark.parametrize("filtered", [False, True])
def test_the_oscillator_is_found_with_a_filter_and_without(filtered):
    records = [leveled(Y, i, filtered) for i, Y in enumerate((0.003, 0.005, 0.008, 0.012))]
    found = identify_forced(records, stiffness=OSC.k)
    fit = found.basis.common.fit
    assert found.basis.common.clear == ()
    assert abs(fit.value("folded") - (not filtered)) < 4.0 * fit.error("folded") < 0.5
    for symbol in ("F_k", "c", "K_z"):
        low, high = found.intervals[symbol]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        # four standard errors, twice the interval
        assert abs(getattr(OSC, symbol) - middle) < 2.0 * half < 0.01 * middle, symbol
        assert found.verdicts[symbol].verdict == "usable"
