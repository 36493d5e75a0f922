"""Features of all records, with the onset of slip of the oscillator fitted to them, and replicates of these features.

The microstick line has one length for all records of a contact, L = X + X_s = 2F_k/K_z (10). It comes from the
waveforms of the joint fit (`oscillator.py`); the errors of all that the waveforms give follow from the data of every
record.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from ..arrays import Array
from ..features import Features, stack
from ..likelihood.mean_harmonics import RESOLVED, Means, Reading
from ..likelihood.waveforms import WaveformFit
from ..solver import NORMAL_95

Of = TypeVar("Of")
To = TypeVar("To")

_UNKNOWN = ("X_s", "V_s", "t_s", "X_r", "V_r", "t_r")


@dataclass(frozen=True, eq=False)
class Sample:
    """Features of n records, (n,) as read or (n, r) of replicates, and two unknowns of their oscillator, (r,).

    F_k : N, the mean over its groups.   rho : K_z^{−1/2}.   NaN where no oscillator holds.
    """

    features: Features
    F_k: Array
    rho: Array


@dataclass(frozen=True, eq=False)
class Samples(Generic[Of]):
    """What n records give, features at first, with what its errors are computed from.

    point : as read.   drawn : of r bootstrap replicates.   left : for each record, without one group of its rows after
    the other.
    """

    point: Of
    drawn: Of
    left: tuple[Of, ...]

    def map(self, of: Callable[[Of], To]) -> Samples[To]:
        """What a function makes of each."""
        return Samples(of(self.point), of(self.drawn), tuple(map(of, self.left)))


@dataclass(frozen=True, slots=True)
class Microstick:
    """Length of the microstick line X + X_s = 2F_k/K_z that all records share, m.

    resolved : whether its root stands out of its noise.   bound : upper bound at 97.5 % confidence.
    All numbers are NaN where the waveforms of the records are not known.
    """

    length: float
    standard_error: float
    resolved: bool
    bound: float


def read_samples(
    readings: Sequence[Reading], count: int, random: np.random.Generator, *, jackknife: bool = True
) -> Samples[Sample]:
    """Features of readings that share the waveforms of a joint fit (`oscillator.joined`), as read and resampled.

    count : of replicates.   random : generator of the drawings.   jackknife : whether groups of rows are left out, too;
    a study that needs no propagated errors saves that time.
    """
    drawn = sample_of(readings, [reading.resampled(count, random) for reading in readings])
    points = [reading.features for reading in readings]
    left = [_left_out(readings, points, j) for j in range(len(readings) if jackknife else 0)]
    fit = _fit(readings)
    nothing = np.zeros((0 if fit is None else fit.point.size, 1))
    return Samples(_sample(readings, stack(points), nothing), drawn, tuple(left))


def sample_of(readings: Sequence[Reading], means: Sequence[Means]) -> Sample:
    """Features of n records from r means of each, (n, r)."""
    moved = np.sum([r.moved(m) for r, m in zip(readings, means, strict=True)], axis=0)
    features = [r.features_of(m, moved)[None] for r, m in zip(readings, means, strict=True)]
    return _sample(readings, stack(features), moved)


def microstick(samples: Samples[Sample]) -> Microstick:
    """The length of the microstick line, and whether it stands out of the scatter of its replicates."""
    F_k, rho = float(samples.point.F_k[0]), float(samples.point.rho[0])
    length = 2.0 * F_k * rho**2
    if not math.isfinite(length):
        return Microstick(math.nan, math.nan, False, math.nan)
    drawn = samples.drawn
    error = float(drawn.rho.std(ddof=1))
    return Microstick(
        length=length,
        standard_error=float((2.0 * drawn.F_k * drawn.rho * np.abs(drawn.rho)).std(ddof=1)),
        resolved=rho > RESOLVED * error,
        bound=2.0 * F_k * (rho + NORMAL_95 * error) ** 2,
    )


def _left_out(readings: Sequence[Reading], points: Sequence[Features], j: int) -> Sample:
    """All records as read, except that record j lacks one group of its rows after the other."""
    means = readings[j].left_out()
    moved = readings[j].moved(means)
    count = len(means.Y)
    parts = [
        readings[i].features_of(means, moved)[None]
        if i == j
        else _followed(readings[i], point[None][:, [0] * count], moved)
        for i, point in enumerate(points)
    ]
    return _sample(readings, stack(parts), moved)


def _followed(reading: Reading, features: Features, moved: Array) -> Features:
    """The features of a record of which only the waveform follows the unknowns of the fit, (1, r)."""
    waveform = reading.waveform
    if waveform is None or not reading.slips:
        return features
    V_s, t_s, taken = waveform.onset_slope @ moved
    length = waveform.length_slope @ moved
    return features.replaced(
        X_s=features.X_s + length,
        X_r=features.X_r - length,
        V_s=features.V_s + V_s,
        V_r=features.V_r - V_s,
        t_s=features.t_s + t_s,
        t_r=features.t_r + t_s,
        a=features.a - taken,
    )


def _sample(readings: Sequence[Reading], features: Features, moved: Array) -> Sample:
    fit = _fit(readings)
    if fit is None:
        unknown = np.full(moved.shape[1], math.nan)
        return Sample(features.replaced(**dict.fromkeys(_UNKNOWN, math.nan)), unknown, unknown)
    rho = fit.rho + moved[fit.unknowns.names.index("rho")]
    return Sample(features, fit.F_k + fit.unknowns.friction(moved), rho)


def _fit(readings: Sequence[Reading]) -> WaveformFit | None:
    """The joint fit whose waveforms the readings share."""
    waveform = readings[0].waveform
    return None if waveform is None else waveform.fit
