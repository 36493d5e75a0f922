"""Lines in residuals: hum, further modes and tones are found at their true values, and none in noise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.signals.disturbances import Line, lines_of

DT, SIZE, NOISE = 5e-4, 8000, 0.05
T = DT * np.arange(SIZE)


def noise(seed: int, size: int = SIZE) -> np.ndarray:
    return NOISE * np.random.default_rng(seed).standard_normal(size)


def line(frequency: float, amplitude: float, rate: float = 0.0) -> np.ndarray:
    return amplitude * np.exp(-rate * T) * np.cos(2.0 * math.pi * frequency * T + 0.8)


@pytest.mark.parametrize("size", [500, 3000])
def test_noise_has_no_lines(size):
    """At most 1 % of 300 drawings."""
    assert sum(bool(lines_of(noise(seed, size), DT, 5.0)) for seed in range(300)) <= 3


def test_coloured_noise_has_no_lines():
    """An anti-alias filter shapes the floor, smoothly: at most 1 % of 100 drawings."""
    count = 0
    for seed in range(100):
        spectrum = np.fft.rfft(noise(seed)) / (1.0 + 1j * np.fft.rfftfreq(SIZE, DT) / 150.0) ** 2
        count += bool(lines_of(np.fft.irfft(spectrum), DT, 5.0))
    assert count <= 1


# Cramér–Rao bounds of a steady line: σ√(2/n) of the amplitude A, √(6/n) σ/(πAT) of the frequency. A mode that lives for
# 1/β = T/8 has as many samples as a record an eighth as long: bounds some √8 and 8√8 times as large. Four of them.
@pytest.mark.parametrize(
    ("frequency", "amplitude", "rate", "kind"),
    [
        (49.95, 0.01, 0.0, "mains"),
        (60.05, 0.01, 0.0, "mains"),
        (150.1, 0.01, 0.0, "mains"),
        (33.3, 0.01, 0.0, "tone"),
        (61.3, 0.1, 2.0, "mode"),
        (52.0, 0.1, 2.0, "mode"),
        (412.0, 0.1, 6.0, "mode"),
    ],
)
def test_a_line_is_found_at_its_true_values(frequency, amplitude, rate, kind):
    (found,) = lines_of(noise(1) + line(frequency, amplitude, rate), DT, 5.0)
    assert found.kind == kind
    shorter = max(1.0, rate * SIZE * DT)
    error = NOISE * math.sqrt(2.0 * shorter / SIZE)
    frequency_error = math.sqrt(3.0) * error * shorter / (math.pi * amplitude * SIZE * DT)
    assert found.frequency_hz == pytest.approx(frequency, abs=4.0 * frequency_error)
    assert found.amplitude == pytest.approx(amplitude, abs=8.0 * error)  # it goes with the rate
    assert found.decay_rate == pytest.approx(rate, abs=4.0 * 2.0 * math.pi * frequency_error)


def test_several_lines_and_the_frequencies_of_the_model():
    rest = noise(2) + line(50.0, 0.02) + line(61.3, 0.2, 3.0) + line(15.1, 0.1, 0.3)
    kinds = {round(each.frequency_hz): each.kind for each in lines_of(rest, DT, 5.0)}
    assert kinds == {50: "mains", 61: "mode"}
    assert 15 in {round(each.frequency_hz) for each in lines_of(rest, DT, 6.0)}


def test_a_mode_is_the_same_in_any_unit():
    rest = noise(4) + line(61.3, 0.2, 3.0)
    (one,), (small,) = lines_of(rest, DT, 5.0), lines_of(1e-6 * rest, DT, 5.0)
    # least squares end where the sum of squares changes by 1e-8
    assert small.decay_rate == pytest.approx(one.decay_rate, rel=1e-4)
    assert small.amplitude == pytest.approx(1e-6 * one.amplitude, rel=1e-4)


def test_hum_that_the_sampling_folds_is_hum():
    """150 Hz in 231 samples a second is 81 Hz."""
    t = np.arange(1000) / 231.0
    rest = NOISE * np.random.default_rng(5).standard_normal(t.size)
    (hum,) = lines_of(rest + 0.05 * np.cos(2.0 * math.pi * 150.0 * t), 1.0 / 231.0, 5.3)
    assert (hum.kind, round(hum.frequency_hz)) == ("mains", 81)


def test_words():
    assert Line(49.98, 0.003, 0.0, "mains").words(1.0) == "hum of 50 Hz, 0.30 % of the motion"
    assert (
        Line(24.71, 0.02, 0.0, "tone").words(2.0) == "a steady tone of 24.71 Hz, 1 % of the motion"
    )
    mode = Line(61.3, 0.1, 2.0 * math.pi * 0.613, "mode").words(1.0)
    assert mode == "a further mode of 61.3 Hz with a damping ratio of 1 %, 10 % of the motion"
