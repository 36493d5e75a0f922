"""From a measurement to the harmonics of its steady state, with a warning for every fault of the record.

Each channel is worked on in its own times: nothing is resampled, unless its samples are unevenly spaced. The drive
frequency comes from the excitation; the harmonics from least squares, cycle by cycle (`cycles.py`); a slow drift of the
offset is removed with what it adds to the harmonics. Harmonics are then turned into those of displacements,

    y_n = −a_n/(nω)²   of a base acceleration,      y_n = f_n/k   of a force,
    x_n = v_n/(inω)    of a velocity,               x_n = −a_n/(nω)²   of an acceleration,

after the known gain, delay and filters of the channel have been removed (`records/measurement.py`). The harmonics of
several response channels are averaged, each weighted by its inverse variance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from ..arrays import Array, Complexes, Mask
from ..project.wording import Remark, visible
from ..records.errors import RecordError
from ..records.measurement import EXCITATIONS, RESPONSES, Channel, Correction, Measurement
from . import checks
from .checks import weighted_mean
from .cycles import CycleHarmonics, Samples, accumulate
from .frequency import FEWEST_CYCLES, drive_frequency, frequency_offset
from .one_thread import one_thread
from .rounding import converter_step, rounding_error

SampleBlocks = Callable[[], Iterable[Samples]]

MOST_HARMONICS = {"displacement": 31, "velocity": 61, "acceleration": 91}
"""Highest harmonic taken of each response; a quarter of the samples per cycle limits it too."""

_HARMONICS_OF_BASE = 9
_LEADING = 1 << 18  # samples from which the drive frequency is first estimated
_COMPARED = 1 << 12  # samples in which a copy of another channel shows
_FILTERED_OUT = 1e-3  # of a harmonic that passes a filter: below it, the rest is noise
# Rounding as a part of the fundamental; smaller noise cannot be distinguished from it.
_RELATIVE_FLOOR = 1e-9
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
        freed = _steady(_Settled.of(replace(self.gathered, channels=channels)))
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
    try:
        return _condition(source, channels, k, frequency_hz, skip_cycles, corrections)
    except RecordError:  # names the file itself
        raise
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error


def _condition(
    source: str,
    channels: Mapping[str, SampleBlocks],
    k: float,
    frequency_hz: float | None,
    skip_cycles: int,
    corrections: Mapping[str, Correction | None],
) -> SteadyRecord:
    if not (math.isfinite(k) and k > 0.0):
        raise ValueError(f"the stiffness k must be positive, got {k} N/m")

    def gathered(
        channels: Mapping[str, SampleBlocks], of_clocks: Sequence[Remark] = ()
    ) -> Gathered:
        uncorrected, sampling, warnings = _harmonics(channels, frequency_hz, skip_cycles)
        return Gathered(source, k, uncorrected, sampling, corrections, (*of_clocks, *warnings))

    of_record = gathered(channels)
    settled = _Settled.of(of_record)
    apart = {
        q: checks.clock(settled.Y[:, 1], x[:, 1], settled.times, settled.weights, settled.omega)
        for q, x in settled.moved.items()
    }
    faster = {q: ratio for q, ratio in apart.items() if ratio is not None}
    if faster:
        by_one = {q: _by_clock(of, faster.get(q, (0.0,))[0]) for q, of in channels.items()}
        of_record = gathered(by_one, [*itertools.starmap(checks.two_clocks, faster.items())])
        of_record = replace(of_record, clocks=faster)
        settled = _Settled.of(of_record)
    return _steady(settled)


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


@dataclass(frozen=True, eq=False)
class _Settled:
    """The harmonics of base and responses as those of displacements, in the usable rows, m.

    gathered : that they come from.   corrected : harmonics of each channel.   usable : rows in which every channel is.
    times, weights : of these rows, from the start, s.   omega, offset, omega_error : of the drive, rad/s; offset from
    that of the leading part.   warnings : on the cycles.
    """

    gathered: Gathered
    corrected: Mapping[str, CycleHarmonics]
    usable: Mask
    times: Array
    weights: Array
    omega: float
    offset: float
    omega_error: float
    Y: Complexes
    moved: dict[str, Complexes]
    warnings: list[Remark]

    @classmethod
    def of(cls, gathered: Gathered) -> _Settled:
        """The channels, corrected."""
        corrected = {
            q: _corrected(q, h, gathered.corrections.get(q)) for q, h in gathered.channels.items()
        }
        driving = next(q for q in EXCITATIONS if q in corrected)
        base, weights = corrected[driving], _common_weights(corrected)
        warnings = _checked_cycles(corrected, weights, base.omega)
        # a longer look corrects the frequency of the leading part
        offset, omega_error = frequency_offset(base)
        usable, omega = weights > 0.0, base.omega + offset
        times, weights = base.times[: len(weights)][usable] - base.start, weights[usable]
        rows = {
            q: _displacement(q, _settled(h, usable, times, weights, offset), omega, gathered.k)
            for q, h in corrected.items()
        }
        return cls(
            gathered,
            corrected,
            usable,
            times,
            weights,
            omega,
            offset,
            omega_error,
            rows[driving],
            {q: rows[q] for q in RESPONSES if q in rows},
            warnings,
        )


def _steady(settled: _Settled) -> SteadyRecord:
    """The steady record that these harmonics are."""
    gathered, Y, weights, omega = settled.gathered, settled.Y, settled.weights, settled.omega
    driving = next(q for q in EXCITATIONS if q in settled.corrected)
    base, times = settled.corrected[driving], settled.times
    noise_rms = {
        q: _noise_rms(_settled(h, settled.usable, times, weights, settled.offset), weights, h)
        for q, h in gathered.channels.items()
    }
    rounding = {q: _rounding(gathered, q, noise_rms[q]) for q in gathered.channels}
    Y_rounding = rounding[driving][: Y.shape[1]]
    Y_error = np.hypot(_error(Y, weights), Y_rounding)
    moved = dict(settled.moved)
    warnings = [*gathered.warnings, *settled.warnings]
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
        omega_standard_error=settled.omega_error,
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
        channels=settled.corrected,
        noise_rms=noise_rms,
        skew=skew,
        warnings=tuple(warnings),
        gathered=gathered,
    )


def _harmonics(
    channels: Mapping[str, SampleBlocks], frequency_hz: float | None, skip_cycles: int
) -> tuple[dict[str, CycleHarmonics], dict[str, tuple[float, float, float]], list[Remark]]:
    """The harmonics of every channel at the drive frequency of the leading part, `Gathered.sampling`, and warnings
    about that frequency."""
    driving = next(q for q in EXCITATIONS if q in channels)
    leading = {
        q: _leading_samples(blocks(), _LEADING if q == driving else _COMPARED)
        for q, blocks in channels.items()
    }
    steps = {q: _step_of(t if q == driving else t[:64], q) for q, (t, _) in leading.items()}
    omega, error = _drive_frequency(driving, leading[driving], steps[driving])
    for q, (_, values) in leading.items():
        if q != driving:
            checks.require_distinct(q, values, driving, leading[driving][1])
    period = 2.0 * math.pi / omega
    cycles = math.floor(np.ptp(leading[driving][0]) / period)
    warnings = list(checks.frequency(omega, error, cycles, frequency_hz))
    start = max(float(t[0]) for t, _ in leading.values()) + skip_cycles * period
    counts = {q: _harmonics_of(q, period / dt) for q, dt in steps.items()}
    return (
        {
            q: accumulate(blocks(), omega, start=start, dt=steps[q], harmonics=counts[q])
            for q, blocks in channels.items()
        },
        {
            q: (float(t[0]), _step_of(t, q), converter_step(values[:_COMPARED]))
            for q, (t, values) in leading.items()
        },
        warnings,
    )


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
    first = np.zeros((2, 0))
    for block in blocks:
        room = count - first.shape[1]
        first = np.hstack([first, [samples[:room] for samples in block]])
        if first.shape[1] >= count:
            break
    if not first.size:
        raise ValueError("a channel has no samples")
    return first[0], first[1]


def _step_of(t: Array, quantity: str) -> float:
    """Sampling interval, s: the mean over the steps that are no gaps."""
    if t.size < 3:
        raise ValueError(f"{quantity} has only {t.size} samples")
    steps = np.diff(t)
    return float(np.mean(steps[np.abs(steps - np.median(steps)) < 0.5 * np.median(steps)]))


def _corrected(
    quantity: str, harmonics: CycleHarmonics, correction: Correction | None
) -> CycleHarmonics:
    """The harmonics before gain, delay and filters of the channel acted, up to the highest that the filter passes."""
    if correction is None:
        return harmonics
    response = correction.response(harmonics.omega * np.arange(harmonics.coefficients.shape[1]))
    passed = np.abs(response) > _FILTERED_OUT * correction.gain
    if not passed[1]:
        raise ValueError(
            f"{quantity}: its filter leaves less than {_FILTERED_OUT:g} of the {harmonics.omega / (2.0 * math.pi):.4g} "
            "Hz of the drive: check its corner or poles in the mapping"
        )
    count = passed.size if passed.all() else int(np.argmin(passed))
    response = response[:count]
    return replace(
        harmonics,
        coefficients=harmonics.coefficients[:, :count] / response,
        # of an offset that drifts by one unit after the correction: the mean is divided by the gain, too
        drift=harmonics.drift[:, :count] * (correction.gain / response),
        span=harmonics.span / correction.gain,
    )


def _drive_frequency(driving: str, leading: Samples, step: float) -> tuple[float, float]:
    """ω of the excitation and its standard error, rad/s, from its leading samples."""
    checks.require_signal(driving, leading[1])
    try:
        return drive_frequency(*leading, step)
    except ValueError as error:
        raise ValueError(f"{driving}: {error}") from error


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


def _settled(
    harmonics: CycleHarmonics, usable: Mask, times: Array, weights: Array, offset: float
) -> Complexes:
    """The usable rows without drift, turned to the time of their start and to a frequency faster by `offset`, rad/s."""
    rows = harmonics.coefficients[: len(usable)][usable]
    phase = harmonics.omega * harmonics.start - offset * times
    turn = np.exp(1j * np.outer(phase, np.arange(rows.shape[1])))
    return _without_drift(rows, harmonics.drift, times, weights) * turn


def _harmonics_of(quantity: str, per_cycle: float) -> int:
    quarter = math.floor(per_cycle / 4.0)
    if quarter < 3:
        raise ValueError(
            f"{quantity}: {per_cycle:.1f} samples per cycle are too few; at least 12 are needed for a third harmonic"
        )
    return min(MOST_HARMONICS.get(quantity, _HARMONICS_OF_BASE), quarter)


def _displacement(quantity: str, rows: Complexes, omega: float, k: float) -> Complexes:
    """The harmonics of a channel as those of a displacement; the mean of a rate counts as 0."""
    if quantity == "force":
        return rows * (1.0 / k)
    orders = {"velocity": 1, "acceleration": 2, "base_acceleration": 2}
    by_time = np.concatenate([[0.0], 1.0 / (1j * np.arange(1, rows.shape[1]) * omega)])
    return rows * by_time ** orders.get(quantity, 0)


def _without_drift(rows: Complexes, drift: Complexes, times: Array, weights: Array) -> Complexes:
    """The harmonics freed of what a drifting offset adds to them; the drift is a parabola through the means.

    drift : harmonics of τ and τ² in a cycle.   times : middle of the rows, s.
    """
    degree = 2 if len(rows) >= 8 else 1
    span = max(float(np.ptp(times)), 1e-300)
    at = (times - times.mean()) / span
    means = np.polynomial.Polynomial(
        np.polynomial.polynomial.polyfit(at, rows[:, 0].real, degree, w=np.sqrt(weights))
    )
    rate, bend = means.deriv()(at) / span, 0.5 * means.deriv(2)(at) / span**2
    correction = np.outer(rate, drift[0]) + np.outer(bend, drift[1])
    correction[:, 0] = 0.0
    return rows - correction


def _error(rows: Complexes, weights: Array) -> Array:
    """Standard deviation of the real and of the imaginary part of the mean of each harmonic, from its scatter.

    Smoothed over five neighbouring harmonics: of few cycles, each by itself would be a poor estimate.
    """
    smooth = _scatter(rows, weights) / weights.sum()
    higher = np.pad(smooth[2:], 2, constant_values=np.nan)
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


def _rounding(gathered: Gathered, quantity: str, noise_rms: float) -> Array:
    """Standard deviations that the steps of a converter leave in the harmonics of a channel, m."""
    of, (_, dt, step) = gathered.channels[quantity], gathered.sampling[quantity]
    cycles = round(float(of.weights.sum()))
    error = rounding_error(step, of.span, 2.0 * math.pi / (of.omega * dt), cycles, noise_rms)
    ones = replace(of, coefficients=np.full((1, of.coefficients.shape[1]), error + 0j))
    corrected = _corrected(quantity, ones, gathered.corrections.get(quantity))
    return np.abs(_displacement(quantity, corrected.coefficients, of.omega, gathered.k))[0]


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
