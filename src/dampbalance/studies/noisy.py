"""Responses read off noisy records: the exact orbit, sampled, with white noise, as an engineer would have measured it.

Each case is one experiment of its own. Noise and bootstrap come from generators seeded by (seed, number of the case,
level): a case does not depend on the chunk it is computed in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..arrays import Array, Integers
from ..balance import TERMS
from ..features import Features, beside, of_numbers, stack
from ..identification.microstick import read_samples
from ..identification.oscillator import JointFit, joined, joint_fit
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..reading.noisy import Reading, read_features
from ..reading.simpson import cycle_integrals, replicates_of
from ..records.measurement import Measurement
from ..records.synthetic import measured_orbit
from .parameters import oscillator_of
from .responses import NOT_READ, Responses


def measured_responses(
    si: Mapping[str, Array],
    Y: Array,
    numerics: Mapping[str, Any],
    cases: Integers,
    *,
    cycles: int,
    seed: int,
    count: int,
    simpson: bool = False,
) -> Responses:
    """The responses, measured over `cycles` cycles at sampling_hz with noise, and read.

    si : m, c, k, K_z, F_k, omega, each (n,).   Y : m, (L, n).   numerics : sampling_hz (Hz) and noise (standard
    deviation of each channel's noise over the rms of its signal), each (n,).   cases : their numbers in the study,
    (n,).   count : of replicates.   simpson : whether to integrate the signals as they are, too; that changes no
    other number.

    The reader is told the stiffness k alone: frequency, amplitudes and phases are what it finds.
    """
    points, replicates, plain, fitted = [], [], [], []
    for case in range(len(cases)):
        osc = oscillator_of(si, case)
        records: list[tuple[Reading, Measurement] | str] = []
        for level in range(len(Y)):
            motion = BaseMotion(Y=float(Y[level, case]), omega=float(si["omega"][case]))
            random = np.random.default_rng([seed, int(cases[case]), level])
            rate_hz, noise = (float(numerics[name][case]) for name in ("sampling_hz", "noise"))
            records.append(_measured(osc, motion, rate_hz, cycles, noise, random))
        random = np.random.default_rng([seed, int(cases[case]), len(Y)])
        read = [record if isinstance(record, str) else record[0] for record in records]
        point, replicate, whole = _with_one_oscillator(read, osc.k, count, random)
        points.append(point)
        replicates.append(replicate)
        fitted.append(None if whole is None else whole.answer)
        if simpson:
            values, drawn = _by_simpson(records, osc.k, count, random)
            plain.append((point.replaced(**values), replicate.replaced(**drawn)))
    likelihood = {
        symbol: np.array(
            [(a.values[symbol], a.standard_errors[symbol]) if a else (np.nan,) * 2 for a in fitted]
        ).T
        for symbol in TERMS
    }
    by_simpson = tuple(beside(parts) for parts in zip(*plain, strict=True))
    return Responses(beside(points), beside(replicates), by_simpson, likelihood)


def _measured(
    osc: Oscillator,
    motion: BaseMotion,
    rate_hz: float,
    cycles: int,
    noise: float,
    random: np.random.Generator,
) -> tuple[Reading, Measurement] | str:
    """What is read off one record, and the record; in words, why nothing is."""
    try:
        orbit = steady_orbit(osc, motion)
    except NoSteadyOrbit:
        return str(Regime.NOT_FOUND)
    start = random.random() * motion.period  # the record begins anywhere in the cycle
    measurement = measured_orbit(
        orbit, rate_hz=rate_hz, cycles=cycles, noise=noise, seed=random, start=start
    )
    try:
        return read_features(measurement, osc.k), measurement
    except ValueError:  # too few samples or cycles, or nothing but noise
        return NOT_READ


def _with_one_oscillator(
    read: Sequence[Reading | str], k: float, count: int, random: np.random.Generator
) -> tuple[Features, Features, JointFit | None]:
    """Features (L,) and replicates (L, count) of the levels of a case, with the onset of slip that one oscillator gives
    them, as in `identification`, and that oscillator; a level that was not read has NaN and the reason, and where no
    oscillator holds, none has a friction travel."""
    whole = None
    readings = [reading for reading in read if isinstance(reading, Reading)]
    if readings:
        whole = joint_fit([reading.lines for reading in readings], k)
        samples = read_samples(joined(readings, whole), count, random, jackknife=False)
        of_all = samples.point.features, samples.drawn.features
        if not whole.waveforms_hold:
            of_all = of_all[0].replaced(a=np.nan), of_all[1].replaced(a=np.nan)
    points, replicates = [], []
    for reading in read:
        if isinstance(reading, str):
            nothing = of_numbers(np.nan, reading)
            points.append(nothing)
            replicates.append(nothing[:, None][:, [0] * count])
        else:
            at = [readings.index(reading)]
            points.append(of_all[0][at])
            replicates.append(of_all[1][at])
    return stack(points), stack(replicates), whole


def _by_simpson(
    records: Sequence[tuple[Reading, Measurement] | str],
    k: float,
    count: int,
    random: np.random.Generator,
) -> tuple[dict[str, Array], dict[str, Array]]:
    """a, b and W of the levels of a case by `reading.simpson`, (L,) each, and replicates, (L, count); NaN where the
    record was not read."""
    values, drawn = np.full((3, len(records)), np.nan), np.full((3, len(records), count), np.nan)
    for level, record in enumerate(records):
        if isinstance(record, str):
            continue
        reading, measurement = record
        y, x = measurement.excitation, measurement["displacement"]
        dt = float(x.t[-1] - x.t[0]) / (len(x) - 1)
        of_cycles = cycle_integrals(y.values, x.values, dt, reading.steady.omega, k)
        values[:, level] = of_cycles.mean(axis=-1)
        drawn[:, level] = replicates_of(of_cycles, count, random)
    names = ("a", "b", "W")
    return dict(zip(names, values, strict=True)), dict(zip(names, drawn, strict=True))
