"""Responses read off noisy records: the exact orbit, sampled, with white noise, as an engineer would have measured it.

Each case is one experiment of its own. Noise and bootstrap come from generators seeded by (seed, number of the case,
level): a case does not depend on the chunk it is computed in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..features import COLUMNS, Features
from ..identification.microstick import Lengths, microstick_of, weights_of, with_length
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from ..motion.regime import Regime
from ..reading.noisy import Reading, read_features
from ..records.synthetic import measured_orbit
from .responses import NOT_READ, RIGID_LIMIT, Responses

Array = NDArray[np.float64]


class Measured(NamedTuple):
    """What was read: of n cases at L levels, (L, n), and bootstrap replicates of it, (L, n·count), case by case."""

    responses: Responses
    replicates: Responses


def measured_responses(
    si: Mapping[str, Array],
    Y: Array,
    numerics: Mapping[str, Any],
    cases: NDArray[np.int64],
    *,
    cycles: int,
    seed: int,
    count: int,
) -> Measured:
    """The responses, measured over `cycles` cycles at sampling_hz with noise, and read by `measured.read_features`.

    si : m, c, k, K_z, F_k, omega, each (n,).   Y : m, (L, n).   numerics : sampling_hz (Hz) and noise (standard
    deviation of each channel's noise over the rms of its signal), each (n,).   cases : their numbers in the study,
    (n,).   count : of replicates.

    The reader is told the stiffness k alone: frequency, amplitudes and phases are what it finds.
    """
    levels, n = Y.shape
    read = {name: np.full((levels, n), np.nan) for name in ("omega", *COLUMNS)}
    drawn = {name: np.full((levels, n, count), np.nan) for name in ("omega", *COLUMNS)}
    regime = np.zeros((levels, n), dtype=np.uint8)
    for case in range(n):
        osc = Oscillator(*(float(si[name][case]) for name in ("m", "c", "k", "K_z", "F_k")))
        readings: dict[int, Reading] = {}
        drawings: list[Features] = []
        for level in range(levels):
            motion = BaseMotion(Y=float(Y[level, case]), omega=float(si["omega"][case]))
            try:
                orbit = steady_orbit(osc, motion)
            except NoSteadyOrbit:
                regime[level, case] = Regime.NOT_FOUND
                continue
            random = np.random.default_rng([seed, int(cases[case]), level])
            reading = _measured(
                orbit,
                float(numerics["sampling_hz"][case]),
                cycles,
                float(numerics["noise"][case]),
                random,
            )
            if reading is None:
                regime[level, case] = NOT_READ
                continue
            readings[level] = reading
            drawings.append(reading.resampled(count, random, onset=True))
        for level, found, replicates, resolved in _shared(readings, drawings):
            regime[level, case] = Regime.ONE_SLIP if resolved else RIGID_LIMIT
            for name in ("omega", *COLUMNS):
                read[name][level, case] = np.atleast_1d(getattr(found, name))[0]
                drawn[name][level, case] = getattr(replicates, name)
    return Measured(
        Responses(regime=regime, **read),
        Responses(
            regime=np.repeat(regime, count, axis=1),
            **{name: array.reshape(levels, -1) for name, array in drawn.items()},
        ),
    )


def _measured(
    orbit: Orbit, rate_hz: float, cycles: int, noise: float, random: np.random.Generator
) -> Reading | None:
    """What is read off one record; None for one that cannot be read."""
    start = random.random() * orbit.motion.period  # the record begins anywhere in the cycle
    measurement = measured_orbit(
        orbit, rate_hz=rate_hz, cycles=cycles, noise=noise, seed=random, start=start
    )
    try:
        return read_features(measurement, orbit.oscillator.k)
    except ValueError:  # too few samples or cycles, or nothing but noise
        return None


def _shared(
    readings: Mapping[int, Reading], drawn: Sequence[Features]
) -> Iterator[tuple[int, Features, Features, bool]]:
    """(level, features, replicates, whether the slip onset is resolved), with one length of the microstick line for all
    levels, as `measured.identification` takes it."""
    if not readings:
        return
    each = list(readings.values())
    points = [reading.with_onset(True) for reading in each]
    lengths = Lengths.of(points, drawn, (), weights_of(each))
    resolved = microstick_of(each, lengths).resolved
    if not resolved:
        lengths = Lengths.rigid(lengths)
    for level, reading, point, drawing in zip(readings, each, points, drawn, strict=True):
        known = reading.waveform is not None
        yield (
            level,
            with_length(point, lengths.point, known),
            with_length(drawing, lengths.drawn, known),
            resolved,
        )
