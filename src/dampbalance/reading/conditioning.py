"""From a measurement to the harmonics of its steady state, with a warning for every fault of the record.

Each channel is worked on in its own times: nothing is resampled, unless its samples are unevenly spaced. The drive
frequency comes from the excitation; the harmonics from least squares, cycle by cycle (`cycles.py`); a slow drift of the
offset is removed with what it adds to the harmonics. Harmonics are then turned into those of displacements,

    y_n = −a_n/(nω)²   of a base acceleration,      y_n = f_n/k   of a force,
    x_n = v_n/(inω)    of a velocity,               x_n = −a_n/(nω)²   of an acceleration,
    x_n = y_n + r_n    of a motion r relative to the base,

after the known gain, delay and filters of the channel have been removed (`records/measurement.py`). The harmonics of
several response channels are averaged, each weighted by its inverse variance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Complexes
from ..project.wording import Remark, visible
from ..records.errors import RecordError
from ..records.measurement import (
    EXCITATIONS,
    ORDERS,
    RELATIVE,
    RESPONSES,
    Channel,
    Correction,
    Measurement,
)
from . import checks
from .checks import weighted_mean
from .cycles import CycleHarmonics, Samples, accumulate, powers
from .frequency import FEWEST_CYCLES, drive_frequency, frequency_offset
from .one_thread import one_thread
from .rounding import converter_step, rounding_error

SampleBlocks = Callable[[], Iterable[Samples]]

_MOST_HARMONICS = (31, 61, 91)
"""Highest harmonic taken of a displacement, a velocity and an acceleration of the mass; a quarter of the samples per
cycle limits it too."""

_HARMONICS_OF_BASE = 9
_LEADING = 1 << 18  # samples from which the drive frequency is first estimated
_COMPARED = 1 << 12  # samples in which a copy of another channel shows
_FILTERED_OUT = 1e-3  # of a harmonic that passes a filter: below it, the rest is noise
# Rounding as a part of the fundamental; smaller noise cannot be distinguished from it.
_RELATIVE_FLOOR = 1e-9
_NO_NEIGHBOURS = (math.nan, math.nan)
_JITTER = 0.05  # of a step: times closer to an even grid than that are on it


@dataclass(frozen=True, eq=False)
class SteadyRecord:
    """The steady state of one response: harmonics of base and mass per row (a cycle, or several), and their noise.

    source : where it comes from.   k : N/m.   omega, omega_standard_error : rad/s.   start : of the first cycle, s.
    cycles : whole cycles that were used.   cycles_per_row : how many a row averages.
    Y : y_n of the base displacement, rows × (n = 0 … ), m.   X : x_n of the displacement, rows × (0 … N), m.
    Each signal is Re Σ s_n e^{inω(t − start)}.
    weights : usable cycles in each row.   X_error, Y_error : standard deviation of the real and of the imaginary part
    of the mean of each harmonic, m; infinite where no channel reaches.
    X_rounding, Y_rounding : part of these that the steps of a converter leave, which no scatter between cycles shows.
    bandwidth : N, the highest odd harmonic that stands out of the noise.   even_bandwidth : the highest even one, 0
    where the response is symmetric.   base_bandwidth : the highest harmonic of the base, 1 where it is harmonic.
    channels : harmonics of each channel, corrected, by quantity.
    noise_rms : of the samples, by quantity, in the unit of the channel.
    skew : by how much each response lags the first, s, as corrected (only where it is significant).
    warnings : what is wrong with the record, one sentence each, which says what it leaves in doubt.
    gathered : what all this comes from.   unfolded : whether harmonics beyond those that are fitted have been removed.
    """

    source: str
    k: float
    omega: float
    omega_standard_error: float
    start: float
    cycles: int
    cycles_per_row: int
    Y: Complexes
    X: Complexes
    weights: Array
    X_error: Array
    Y_error: Array
    X_rounding: Array
    Y_rounding: Array
    bandwidth: int
    even_bandwidth: int
    base_bandwidth: int
    channels: Mapping[str, CycleHarmonics]
    noise_rms: Mapping[str, float]
    skew: Mapping[str, float]
    warnings: tuple[Remark, ...]
    gathered: Gathered
    unfolded: bool = False

    def without(self, beyond: Mapping[str, Complexes]) -> SteadyRecord:
        """The record freed of what harmonics beyond those that were fitted add to these: to the harmonics of a channel
        as it was recorded, by quantity, rows × (0 … N), in the unit of the channel."""
        channels = {
            q: replace(h, coefficients=h.coefficients - beyond[q]) if q in beyond else h
            for q, h in self.gathered.channels.items()
        }
        gathered = replace(self.gathered, channels=channels)
        freed = _steady(gathered, _rows_of(gathered))
        return replace(freed, gathered=self.gathered, unfolded=True)

    @property
    def frequency_hz(self) -> float:
        """Drive frequency, Hz."""
        return self.omega / (2.0 * math.pi)

    def mean(self, rows: Complexes) -> Complexes:
        """Mean of the rows, each with its weight."""
        return weighted_mean(rows, self.weights)


def condition(
    measurement: Measurement,
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
) -> SteadyRecord:
    """The steady state of a measurement.

    k : stiffness, N/m.   frequency_hz : the nominal drive frequency, compared with that of the excitation.
    skip_cycles : cycles left out at the start, when the motion has not settled.

    Raises ValueError naming the source when the record cannot be used: a constant channel, too few cycles, another
    frequency, signals that contradict each other.
    """
    warnings: list[Remark] = []
    blocks: dict[str, SampleBlocks] = {}
    for quantity in measurement:
        channel = evenly_sampled(measurement[quantity], measurement.source, warnings)
        blocks[quantity] = lambda block=(channel.t, channel.values): iter([block])  # type: ignore[misc]
    steady = condition_blocks(
        measurement.source,
        blocks,
        k,
        frequency_hz=frequency_hz,
        skip_cycles=skip_cycles,
        corrections={q: measurement[q].correction for q in measurement},
    )
    return replace(steady, warnings=(*warnings, *steady.warnings))


def evenly_sampled(channel: Channel, source: str, warnings: list[Remark]) -> Channel:
    """The channel itself, or resampled by a cubic spline when its samples are unevenly spaced (gaps apart)."""
    steps = np.diff(channel.t)
    if np.ptp(steps) <= _JITTER * steps[0]:  # nearly always
        return channel
    dt = float(np.median(steps))
    odd = np.abs(steps / dt - np.round(steps / dt)) > 2.0 * _JITTER
    if odd.mean() < 0.01:
        return channel
    from scipy.interpolate import CubicSpline  # rarely needed, slow to import

    name = visible(channel.name)
    if channel.t.size < 8:
        raise ValueError(f"{source}: {name} has only {channel.t.size} samples")
    gap = float(steps.max())
    if gap > 20.0 * dt:
        raise ValueError(
            f"{source}: {name} is unevenly sampled and has a gap of {gap:.3g} s after "
            f"{channel.t[int(np.argmax(steps))]:.6g} s; cut the record there"
        )
    spline = CubicSpline(channel.t, channel.values)
    t = np.arange(channel.t[0], channel.t[-1], dt)
    coarse = CubicSpline(channel.t[::2], channel.values[::2])(channel.t[1:-1:2])
    error = float(np.sqrt(np.mean((coarse - channel.values[1:-1:2]) ** 2))) / 16.0
    warnings.append(
        Remark(
            "{}: unevenly sampled (steps of {:.3g} to {:.3g} s), resampled every {:.3g} s by a cubic spline; error "
            "about {:.2g} {} in addition to the noise",
            *(name, steps.min(), gap, dt, error, channel.unit),
        )
    )
    return Channel(channel.quantity, t, spline(t), channel.name)


@one_thread
def condition_blocks(
    source: str,
    channels: Mapping[str, SampleBlocks],
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    corrections: Mapping[str, Correction | None] = MappingProxyType({}),
) -> SteadyRecord:
    """Like `condition`, for channels that come in blocks: memory stays bounded however long the record is.

    channels : by quantity, a function that starts the blocks (t, values) of the channel from the beginning. It is
    called twice: for the leading 262,144 samples, and for all.   corrections : of their harmonics, by quantity.
    """
    if not (math.isfinite(k) and k > 0.0):
        raise ValueError(f"{source}: the stiffness k must be positive, got {k} N/m")

    def gathered(channels: Mapping[str, SampleBlocks]) -> Gathered:
        return _gathered(source, channels, k, frequency_hz, skip_cycles, corrections)

    try:
        of_record = gathered(channels)
        rows = _rows_of(of_record)
        faster = {
            q: ratio
            for q, x in rows.moved.items()
            if (ratio := checks.clock(rows.Y[:, 1], x[:, 1], rows.times, rows.weights, rows.omega))
        }
        if faster:
            by_one = {q: _by_clock(of, faster.get(q, (0.0,))[0]) for q, of in channels.items()}
            of_record = gathered(by_one)
            words = itertools.starmap(checks.two_clocks, faster.items())
            warnings = (*words, *of_record.warnings)
            of_record = replace(of_record, clocks=faster, warnings=warnings)
            rows = _rows_of(of_record)
        return _steady(of_record, rows)
    except RecordError:  # names the file itself
        raise
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error


@dataclass(frozen=True, eq=False)
class Gathered:
    """What one pass through the samples of a record leaves of them.

    source, k : as for `SteadyRecord`.   channels : harmonics of each channel, as they were recorded.   sampling : time
    of the first sample and sampling interval, s, and step of the converter, by quantity.   corrections : of the
    harmonics.   warnings : on the samples.
    clocks : by how much the clock of a channel was faster than that of the excitation, as a part of it, and the
    standard error, by quantity, where that was corrected.
    """

    source: str
    k: float
    channels: Mapping[str, CycleHarmonics]
    sampling: Mapping[str, tuple[float, float, float]]
    corrections: Mapping[str, Correction | None]
    warnings: tuple[Remark, ...]
    clocks: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def driving(self) -> str:
        """The quantity that drives."""
        return next(q for q in EXCITATIONS if q in self.channels)


class _Rows(NamedTuple):
    """The harmonics in the rows that all channels have, in the time and at the frequency of the drive, without drift.

    omega, omega_error : of the drive, rad/s.   times, weights : of the rows, from the start, s.   recorded : by
    quantity, in the unit of the channel.   passed : by quantity, what gain, delay and filters make of each harmonic.
    scales : by quantity, of the harmonics as displacements, m per unit, (N + 1,).   Y, moved : harmonics of base and,
    by quantity, of the responses as displacements, m.   warnings : on the cycles.
    """

    omega: float
    omega_error: float
    times: Array
    weights: Array
    recorded: dict[str, Complexes]
    passed: dict[str, Complexes]
    scales: dict[str, Complexes]
    Y: Complexes
    moved: dict[str, Complexes]
    warnings: list[Remark]


def _rows_of(gathered: Gathered) -> _Rows:
    channels, base = gathered.channels, gathered.channels[gathered.driving]
    offset, omega_error = frequency_offset(base)  # a longer look corrects that of the leading part
    omega = base.omega + offset
    passed = {
        q: _passed(q, correction, omega, channels[q].coefficients.shape[1])
        for q in channels
        if (correction := gathered.corrections.get(q)) is not None
    }
    weights = _common_weights(channels)
    warnings = _checked_cycles(channels, weights, base.omega)
    usable = weights > 0.0
    times, weights = base.times[: len(weights)][usable] - base.start, weights[usable]
    recorded = {q: h.coefficients[: len(usable)][usable] for q, h in channels.items()}
    slopes = _drifts([rows[:, 0].real for rows in recorded.values()], times, weights)
    turn = np.exp(1j * (base.omega * base.start - offset * times))
    turn = powers(turn, max(rows.shape[1] for rows in recorded.values()))
    scales = {}
    for (q, rows), slope in zip(recorded.items(), slopes, strict=True):
        rows[:, 1:] -= slope @ channels[q].drift[:, 1:]
        rows *= turn[:, : rows.shape[1]]
        response = passed.get(q, np.ones(rows.shape[1]))
        scales[q] = _of_displacement(q, response.size, omega, gathered.k) / response
    moved = {q: recorded[q][:, : scale.size] * scale for q, scale in scales.items()}
    Y, responses = moved[gathered.driving], {q: moved[q] for q in RESPONSES if q in moved}
    if gathered.driving != "force":  # which leaves the base at rest
        for q in RELATIVE.keys() & responses.keys():
            count = min(Y.shape[1], responses[q].shape[1])
            responses[q][:, 1:count] += Y[:, 1:count]
    return _Rows(
        omega, omega_error, times, weights, recorded, passed, scales, Y, responses, warnings
    )


def _steady(gathered: Gathered, rows: _Rows) -> SteadyRecord:
    """The steady record that these harmonics are."""
    Y, weights, omega, driving = rows.Y, rows.weights, rows.omega, gathered.driving
    base, times = gathered.channels[driving], rows.times
    channels = dict(gathered.channels)
    for q, passed in rows.passed.items():
        coefficients = channels[q].coefficients[:, : passed.size] / passed
        channels[q] = replace(channels[q], coefficients=coefficients)
    noise_rms = {q: _noise_rms(rows.recorded[q], weights, h) for q, h in gathered.channels.items()}
    rounding = {
        q: _rounding(gathered, q, noise) * np.abs(rows.scales[q]) for q, noise in noise_rms.items()
    }
    Y_rounding = rounding[driving]
    Y_error = np.hypot(_error(Y, weights), Y_rounding)
    moved = dict(rows.moved)
    warnings = [*gathered.warnings, *rows.warnings]
    skew, inconsistencies = checks.consistency(moved, weights, omega)
    warnings += inconsistencies
    X, X_error, X_rounding = _combined(moved, rounding, weights)
    mean_Y, mean_X = weighted_mean(Y, weights), weighted_mean(X, weights)
    warnings += checks.plausible(abs(mean_Y[1]), abs(mean_X[1]), omega, driving)
    warnings += checks.steadiness(Y[:, 1], X[:, 1], times, weights, 2.0 * math.pi / base.omega)
    warnings += checks.harmonic_base(mean_Y, Y_error)
    asymmetry = list(checks.symmetry(mean_X, X_error))
    warnings += asymmetry
    warnings += checks.work(mean_Y[1], mean_X[1], Y_error[1], X_error[1])
    return SteadyRecord(
        source=gathered.source,
        k=gathered.k,
        omega=omega,
        omega_standard_error=rows.omega_error,
        start=base.start,
        cycles=int(weights.sum()),
        cycles_per_row=base.cycles_per_row,
        Y=Y,
        X=X,
        weights=weights,
        X_error=X_error,
        Y_error=Y_error,
        X_rounding=X_rounding,
        Y_rounding=Y_rounding,
        bandwidth=_bandwidth(mean_X, X_error),
        even_bandwidth=_bandwidth(mean_X, X_error, lowest=2) if asymmetry else 0,
        base_bandwidth=checks.highest_of_base(mean_Y, Y_error),
        channels=channels,
        noise_rms=noise_rms,
        skew=skew,
        warnings=tuple(warnings),
        gathered=gathered,
    )


def _gathered(
    source: str,
    channels: Mapping[str, SampleBlocks],
    k: float,
    frequency_hz: float | None,
    skip_cycles: int,
    corrections: Mapping[str, Correction | None],
) -> Gathered:
    """The harmonics of every channel at the drive frequency of the leading part."""
    driving = next(q for q in EXCITATIONS if q in channels)
    leading = {
        q: _leading_samples(blocks(), _LEADING if q == driving else _COMPARED)
        for q, blocks in channels.items()
    }
    sampling = {
        q: (float(t[0]), _step_of(t, q), converter_step(values[:_COMPARED]))
        for q, (t, values) in leading.items()
    }
    drive = leading[driving]
    checks.require_signal(driving, drive[1])
    try:
        omega, error = drive_frequency(*drive, sampling[driving][1])
    except ValueError as problem:
        raise ValueError(f"{driving}: {problem}") from problem
    for q, (_, values) in leading.items():
        if q != driving:
            checks.require_distinct(q, values, driving, drive[1])
    period = 2.0 * math.pi / omega
    cycles = math.floor(np.ptp(drive[0]) / period)
    warnings = tuple(checks.frequency(omega, error, cycles, frequency_hz))
    start = max(first for first, *_ in sampling.values()) + skip_cycles * period
    counts = {q: _harmonics_of(q, period / dt) for q, (_, dt, _) in sampling.items()}
    harmonics = {
        q: accumulate(blocks(), omega, start=start, dt=sampling[q][1], harmonics=counts[q])
        for q, blocks in channels.items()
    }
    return Gathered(source, k, harmonics, sampling, corrections, warnings)


def _by_clock(blocks: SampleBlocks, faster: float) -> SampleBlocks:
    """The blocks of a channel in the time of a clock that is slower by that part, and started with its own."""

    def blocks_in_time() -> Iterator[Samples]:
        start: float | None = None
        for t, values in blocks():
            start = float(t[0]) if start is None and len(t) else start
            yield (t if start is None else start + (t - start) * (1.0 - faster)), values

    return blocks_in_time if faster else blocks


def _leading_samples(blocks: Iterable[Samples], count: int) -> Samples:
    """The first samples of a channel, at least `count` of them if there are as many."""
    parts, size = [], 0
    for t, values in blocks:
        parts.append((t[: count - size], values[: count - size]))
        size += parts[-1][0].size
        if size >= count:
            break
    if not size:
        raise ValueError("a channel has no samples")
    t, values = parts[0] if len(parts) == 1 else map(np.concatenate, zip(*parts, strict=True))
    return np.asarray(t, dtype=np.float64), np.asarray(values, dtype=np.float64)


def _step_of(t: Array, quantity: str) -> float:
    """Sampling interval, s: the mean over the steps that are no gaps."""
    if t.size < 3:
        raise ValueError(f"{quantity} has only {t.size} samples")
    steps = np.diff(t)
    if np.ptp(steps) >= 0.5 * steps.min():
        median = np.median(steps)
        steps = steps[np.abs(steps - median) < 0.5 * median]
    return float(np.mean(steps))


def _passed(quantity: str, correction: Correction, omega: float, count: int) -> Complexes:
    """What gain, delay and filters of a channel make of each harmonic, up to the highest that the filters pass."""
    response = correction.response(omega * np.arange(count))
    passed = np.abs(response) > _FILTERED_OUT * correction.gain
    if not passed[1]:
        raise ValueError(
            f"{quantity}: its filter leaves less than {_FILTERED_OUT:g} of the {omega / (2.0 * math.pi):.4g} Hz of the "
            "drive: check its corner or poles in the mapping"
        )
    return response if passed.all() else response[: int(np.argmin(passed))]


def _of_displacement(quantity: str, count: int, omega: float, k: float) -> Complexes:
    """What the harmonics of a quantity are multiplied with to be those of a displacement, m per unit; the mean of a
    rate counts as 0."""
    if quantity == "force":
        return np.full(count, 1.0 / k + 0j)
    by_time = np.concatenate([[0.0], 1.0 / (1j * omega * np.arange(1, count))])
    return by_time ** ORDERS[quantity]


def _common_weights(harmonics: Mapping[str, CycleHarmonics]) -> Array:
    """Cycles in each row that are usable in every channel."""
    per_row = {q: h.cycles_per_row for q, h in harmonics.items()}
    if len(set(per_row.values())) > 1:
        raise ValueError(f"the channels differ too much in length: cycles per row are {per_row}")
    rows = min(len(h.weights) for h in harmonics.values())
    return np.min([h.weights[:rows] for h in harmonics.values()], axis=0)


def _checked_cycles(
    harmonics: Mapping[str, CycleHarmonics], weights: Array, omega: float
) -> list[Remark]:
    """Warnings about missing cycles, and about the signals in the remaining ones."""
    warnings = [w for q, h in harmonics.items() for w in checks.bad_cycles(q, h.bad_cycles)]
    cycles = int(weights.sum())
    checks.require_cycles(cycles, int(np.count_nonzero(weights)), omega, FEWEST_CYCLES)
    warnings += checks.few_cycles(cycles)
    for q, h in harmonics.items():
        checks.require_level(q, h)
        warnings += checks.clipping(q, h)
    return warnings


def _harmonics_of(quantity: str, per_cycle: float) -> int:
    quarter = math.floor(per_cycle / 4.0)
    if quarter < 3:
        raise ValueError(
            f"{quantity}: {per_cycle:.1f} samples per cycle are too few; at least 12 are needed for a third harmonic"
        )
    most = _MOST_HARMONICS[ORDERS[quantity]] if quantity in RESPONSES else _HARMONICS_OF_BASE
    return min(most, quarter)


def _drifts(means: Sequence[Array], times: Array, weights: Array) -> Array:
    """Slope and half the second derivative of a drifting offset in each row, 1/s and 1/s², (channels, rows, 2), from a
    parabola through its means, (rows,) for each channel.   times : middle of the rows, s."""
    degree = 2 if len(times) >= 8 else 1
    span = max(float(np.ptp(times)), 1e-300)
    at, root = (times - times.mean()) / span, np.sqrt(weights)[:, None]
    powers_of = np.vander(at, degree + 1, increasing=True)
    fitted = np.linalg.lstsq(powers_of * root, np.transpose(means) * root, rcond=None)[0]
    bend = fitted[2] if degree == 2 else np.zeros(len(means))
    slope = fitted[1][:, None] + 2.0 * np.outer(bend, at)
    return np.stack([slope / span, np.outer(bend, np.ones(at.size)) / span**2], axis=-1)


def _error(rows: Complexes, weights: Array) -> Array:
    """Standard deviation of the real and of the imaginary part of the mean of each harmonic, from its scatter.

    Smoothed over five neighbouring harmonics: of few cycles, each by itself would be a poor estimate.
    """
    smooth = _scatter(rows, weights) / weights.sum()
    higher = np.concatenate([_NO_NEIGHBOURS, smooth[2:], _NO_NEIGHBOURS])
    ordered = np.sort(np.lib.stride_tricks.sliding_window_view(higher, 5), axis=1)  # NaN last
    known, place = np.isfinite(ordered).sum(axis=1), np.arange(len(ordered))
    smooth[2:] = 0.5 * (ordered[place, (known - 1) // 2] + ordered[place, known // 2])
    floor = (_RELATIVE_FLOOR * abs(weighted_mean(rows, weights)[1])) ** 2
    return np.sqrt(np.maximum(smooth, floor))


def _scatter(rows: Complexes, weights: Array) -> Array:
    """Variance of the real and of the imaginary part of each harmonic in one cycle."""
    off = np.abs(rows - weighted_mean(rows, weights)) ** 2
    return weights @ off / (2.0 * (len(rows) - 1))


def _noise_rms(rows: Complexes, weights: Array, of: CycleHarmonics) -> float:
    """Standard deviation of the samples, were all noise white: from the scatter of the harmonics between rows."""
    period = 2.0 * math.pi / of.omega
    return math.sqrt(float(np.median(_scatter(rows, weights)[1:])) * 0.5 * period / of.dt)


def _rounding(gathered: Gathered, quantity: str, noise_rms: float) -> float:
    """Standard deviation that the steps of a converter leave in the harmonics of a channel, in its unit."""
    of, (_, dt, step) = gathered.channels[quantity], gathered.sampling[quantity]
    cycles = round(float(of.weights.sum()))
    return rounding_error(step, of.span, 2.0 * math.pi / (of.omega * dt), cycles, noise_rms)


def _combined(
    moved: Mapping[str, Complexes], rounding: Mapping[str, Array], weights: Array
) -> tuple[Complexes, Array, Array]:
    """The mean of the harmonics of all responses, weighted by inverse variance, its standard deviations, and what
    rounding contributes to them."""
    count = max(rows.shape[1] for rows in moved.values())
    total = np.zeros((len(weights), count), dtype=np.complex128)
    precision, rounded = np.zeros(count), np.zeros(count)
    for q, rows in moved.items():
        size = rows.shape[1]
        weight = 1.0 / (_error(rows, weights) ** 2 + rounding[q][:size] ** 2)
        total[:, :size] += weight * rows
        precision[:size] += weight
        rounded[:size] += (weight * rounding[q][:size]) ** 2
    total /= precision
    return total, 1.0 / np.sqrt(precision), np.sqrt(rounded) / precision


def _bandwidth(mean: Complexes, error: Array, lowest: int = 1) -> int:
    """The highest odd (lowest = 1) or even (2) harmonic that stands out of the noise by four standard deviations; two
    in a row may be hidden."""
    orders = np.arange(lowest, len(mean), 2)
    clear = orders[(orders == lowest) | (np.abs(mean[orders]) > 4.0 * error[orders])]
    ends = clear[np.diff(clear, append=math.inf) > 6]
    return int(ends[0])
