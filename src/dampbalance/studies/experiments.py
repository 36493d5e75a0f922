"""Responses identified from noisy records: the exact orbit, sampled, with white noise, as in a measurement.

Each case is a separate experiment. Noise and bootstrap come from generators seeded by (seed, number of the case,
level): a case does not depend on the chunk in which it is computed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..balance import TERMS
from ..features import Features, beside, of_numbers, stack
from ..identification.oscillator import JointFit, joined, joint_fit, read_samples
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit, steady_orbit
from ..motion.regime import Regime
from ..project.progress import followed
from ..reading.mean_harmonics import Reading, read_features
from ..reading.simpson import cycle_integrals, replicates_of
from ..records.measurement import Measurement
from ..records.synthetic import measured_orbit
from .parameters import oscillator_of
from .responses import NOT_READ, Cases, Responses
from .settings import SIMPSON


def measured_responses(cases: Cases) -> Responses:
    """The responses, measured over the cycles of the study at sampling_hz with noise in each channel, and read.

    The reader is given the stiffness k alone: frequency, amplitudes and phases are identified. Where a fit of the study
    asks for it, the signals are integrated as they are, by Simpson's rule; that changes no other number.
    """
    study = cases.study
    by_simpson = any(fit.approach == SIMPSON for fit in study.fits)
    points, replicates, plain = [], [], []
    fitted = np.full((2, len(TERMS), len(cases.numbers)), np.nan)
    for case, number in enumerate(
        followed(cases.numbers.tolist(), len(cases.numbers), "experiments")
    ):
        osc = oscillator_of(cases.si, case)
        records = [_measured(cases, osc, case, level) for level in range(len(cases.Y))]
        random = np.random.default_rng([study.seed, number, len(cases.Y)])
        read = [record if isinstance(record, str) else record[0] for record in records]
        point, replicate, whole = _with_one_oscillator(read, osc.k, study.replicates, random)
        points.append(point)
        replicates.append(replicate)
        if whole is not None and (answer := whole.answer):
            for row, of in zip(fitted, (answer.values, answer.standard_errors), strict=True):
                row[:, case] = [of[symbol] for symbol in TERMS]
        if by_simpson:
            integrals = _by_simpson(records, osc.k, study.replicates, random)
            pairs = zip((point, replicate), integrals, strict=True)
            plain.append([seen.replaced(**dict(zip("abW", of, strict=True))) for seen, of in pairs])
    values, errors = (dict(zip(TERMS, of, strict=True)) for of in fitted)
    simpson = tuple(beside(parts) for parts in zip(*plain, strict=True))
    return Responses(beside(points), beside(replicates), simpson, (values, errors))


def _measured(
    cases: Cases, osc: Oscillator, case: int, level: int
) -> tuple[Reading, Measurement] | str:
    """The reading of one record, and the record; the reason, in words, where it cannot be read."""
    study = cases.study
    motion = BaseMotion(float(cases.Y[level, case]), float(cases.si["omega"][case]))
    random = np.random.default_rng([study.seed, int(cases.numbers[case]), level])
    rate_hz, noise = (float(cases.values[name][case]) for name in ("sampling_hz", "noise"))
    try:
        orbit = steady_orbit(osc, motion)
    except NoSteadyOrbit:
        return str(Regime.NOT_FOUND)
    start = random.random() * motion.period  # a record begins anywhere in the cycle
    measurement = measured_orbit(
        orbit, rate_hz=rate_hz, cycles=study.cycles, noise=noise, seed=random, start=start
    )
    try:
        return read_features(measurement, osc.k), measurement
    except ValueError:  # too few samples or cycles, or nothing but noise
        return NOT_READ


def _with_one_oscillator(
    read: Sequence[Reading | str], k: float, count: int, random: np.random.Generator
) -> tuple[Features, Features, JointFit | None]:
    """Features (L,) and replicates (L, count) of the levels of a case, and the oscillator fitted to all of them.

    The onsets of slip are those of that oscillator, as in `identification`. A level that was not read has NaN and the
    reason; where no oscillator fits the records, no level has a friction travel.
    """
    readings = [reading for reading in read if isinstance(reading, Reading)]
    points = [of_numbers(np.nan, reason) for reason in read if isinstance(reason, str)]
    replicates = [nothing[:, None][:, [0] * count] for nothing in points]
    whole = None
    if readings:
        whole = joint_fit([reading.lines for reading in readings], k)
        samples = read_samples(joined(readings, whole), count, random, jackknife=False)
        of_all = samples.point.features, samples.drawn.features
        if not whole.waveforms_hold:
            of_all = of_all[0].replaced(a=np.nan), of_all[1].replaced(a=np.nan)
        points, replicates = [of_all[0], *points], [of_all[1], *replicates]
    last = [isinstance(reading, str) for reading in read]  # of the parts
    levels = np.argsort(np.argsort(last, kind="stable"))
    return stack(points)[levels], stack(replicates)[levels], whole


def _by_simpson(
    records: Sequence[tuple[Reading, Measurement] | str],
    k: float,
    count: int,
    random: np.random.Generator,
) -> tuple[Array, Array]:
    """a, b and W of the levels of a case by `reading.simpson`, (3, L), and replicates, (3, L, count); NaN where the
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
    return values, drawn
