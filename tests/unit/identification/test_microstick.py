"""Features of all records with one microstick line: what moves it in one record moves it in all."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance.identification.oscillator import (
    JointFit,
    joined,
    joint_fit,
    microstick,
    read_samples,
)
from paper_case import PAPER, orbits_at
from unit.identification.levels import read


@pytest.fixture(scope="module")
def readings():
    return read(orbits_at(3.5, (0.004, 0.008, 0.012)))


@pytest.fixture(scope="module")
def samples(readings):
    whole = joint_fit([reading.lines for reading in readings], PAPER.k)
    return read_samples(joined(readings, whole), 2000, np.random.default_rng(1))


def test_there_is_one_line_in_every_replicate(samples):
    for sample in (samples.point, samples.drawn, *samples.left):
        f = sample.features
        length = f.X + f.X_s
        # lengths differ among replicates, not among records; where rows of one are left out, the others follow to
        # first order: ρ moves by 1e-2 of itself at most
        first_order = sample in samples.left
        np.testing.assert_allclose(
            length, length[:1] * np.ones_like(length), rtol=2e-4 if first_order else 1e-9
        )
        # with one slip onset per half cycle a = 4X − 2L, whatever moves; slopes by differences of 1e-6
        np.testing.assert_allclose(f.a, 2.0 * (f.X - f.X_s), rtol=1e-8)
        np.testing.assert_allclose(f.X_r, -f.X_s, rtol=1e-12)
        np.testing.assert_allclose(f.V_r, -f.V_s, rtol=1e-12)
    assert samples.drawn.features.X_s.std(axis=1).min() > 0.0
    assert len(samples.left) == 3


@pytest.mark.parametrize("name", ["X_s", "V_s", "t_s", "a"])
def test_leaving_out_rows_of_every_record_gives_the_scatter_of_replicates(samples, name):
    drawn = getattr(samples.drawn.features, name).std(axis=1, ddof=1)
    variance = np.zeros(3)
    for part in samples.left:
        values = getattr(part.features, name)
        g = values.shape[1]
        variance += (g - 1) / g * np.sum((values - values.mean(axis=1, keepdims=True)) ** 2, axis=1)
    # 2,000 replicates know it to 1.6 %; bootstrap and jackknife agree to first order
    assert np.sqrt(variance) == pytest.approx(drawn, rel=0.08)


def test_the_length_of_the_line_and_its_errors(samples):
    line = microstick(samples)
    assert line.resolved
    assert abs(line.length - 2.0 * PAPER.F_k / PAPER.K_z) < 4.0 * line.standard_error
    lengths = samples.drawn.features.X[0] + samples.drawn.features.X_s[0]
    assert line.standard_error == pytest.approx(lengths.std(ddof=1), rel=0.02)
    # 97.5 % of a distribution that is nearly normal
    assert line.bound - line.length == pytest.approx(1.96 * line.standard_error, rel=0.05)


def test_without_an_oscillator_there_is_no_line(readings):
    without = joined(readings, JointFit(None, False, None))
    samples = read_samples(without, 20, np.random.default_rng(1), jackknife=False)
    assert samples.left == ()
    line = microstick(samples)
    assert not line.resolved
    assert math.isnan(line.length)
    assert math.isnan(line.bound)
    assert np.isnan(samples.drawn.features.X_s).all()
    np.testing.assert_array_equal(samples.drawn.features.a, 4.0 * samples.drawn.features.X)
