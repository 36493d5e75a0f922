"""The harmonics of the steady state of a measurement, with a finding for every fault of the record.

Each channel keeps its own times; nothing is resampled. The excitation gives the drive frequency, and least squares,
cycle by cycle, give the harmonics (`cycles.py`). A slow drift of the offset is removed from them. Harmonics are then
converted to those of displacements,

    y_n = v_n/(inω)    of a base velocity,          y_n = −a_n/(nω)²   of a base acceleration,
    y_n = f_n/k        of a force,
    x_n = v_n/(inω)    of a velocity,               x_n = −a_n/(nω)²   of an acceleration,
    x_n = y_n + r_n    of a motion r relative to the base,

after the known gain, delay and filters of the channel have been removed (`records/channel.py`). If contact, spring and
damper all act between the mass m and the base, the mass moves relative to the base as under a force −mÿ (Inman,
Engineering Vibration, Sec. 2.4):

    y_n → m(nω)² y_n/k,      x_n → r_n = x_n − y_n.

The harmonics of several response channels are averaged with inverse-variance weights.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ..arrays import Array, Complexes, Integers
from ..findings.finding import Finding
from ..project.wording import visible
from ..records.channel import (
    ABSOLUTE,
    ACCOMPANYING,
    ORDERS,
    RELATIVE,
    RESPONSES,
    Channel,
    Correction,
)
from ..records.coordinate import TRANSLATION
from ..records.equal_steps import GRID_TOLERANCE
from ..records.record import Record
from . import checks
from .checks import ROUNDING, weighted_mean
from .cycles import CycleHarmonics, cycle_harmonics, frequency_offset, powers
from .drive import LEADING, frequency_of, step_of
from .one_thread import one_thread
from .thresholds import CERTAIN

_MOST_HARMONICS = (31, 61, 91)
"""Highest harmonic of a displacement, a velocity and an acceleration of the mass; at most a quarter of the samples per
cycle."""

_FILTERED_OUT = 1e-3  # smallest gain of a filter; a harmonic that passes with less is noise


@dataclass(frozen=True, eq=False)
class SteadyRecord:
    """The steady state of one response: harmonics of base and mass per row (one or several cycles), and their noise.

    Each signal is Re Σ s_n e^{inω(t − start)}.

    source : name of the record.   k : N/m.   omega, omega_standard_error : rad/s.   start : of the first cycle, s.
    cycles : whole cycles that were used.   cycles_per_row : cycles that a row averages.
    Y : y_n of the base displacement, rows × (n = 0 … ), m.   X : x_n of the displacement, rows × (0 … N), m.
    weights : usable cycles in each row.
    X_error, Y_error : standard deviation of the real and of the imaginary part of the mean of each harmonic, m;
    infinite if no channel contains it.
    shares : weight of each response in X, by quantity, (0 … N).
    X_hidden, Y_hidden : part of these errors that the scatter between cycles does not show, for an unsteady channel.
    bandwidth : highest significant odd harmonic.   even_bandwidth : highest significant even one, 0 for a symmetric
    response.   base_bandwidth : highest harmonic of the base, 1 if it is harmonic.
    channels : corrected harmonics of each channel, by quantity.
    noise_rms : of the samples, by quantity, in the unit of the channel.
    of_base : multiple of the drive Y that was added to each measured response to obtain the displacement, by quantity;
    1 for one measured against the base.   base_mass : as for `condition`.
    warnings : findings on the record.
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
    shares: Mapping[str, Array]
    X_hidden: Array
    Y_hidden: Array
    bandwidth: int
    even_bandwidth: int
    base_bandwidth: int
    channels: Mapping[str, CycleHarmonics]
    noise_rms: Mapping[str, float]
    of_base: Mapping[str, float]
    base_mass: float | None
    warnings: tuple[Finding, ...]

    @property
    def frequency_hz(self) -> float:
        """Drive frequency, Hz."""
        return self.omega / (2.0 * math.pi)

    @property
    def added(self) -> float:
        """The multiple of Y in `of_base` that all responses share; 0 if they differ."""
        multiples = set(self.of_base.values())
        return multiples.pop() if len(multiples) == 1 else 0.0

    def mean(self, rows: Complexes) -> Complexes:
        """Return the weighted mean of the rows."""
        return weighted_mean(rows, self.weights)

    def x_of(self, n: Integers) -> Complexes:
        """Return harmonics x_n of any orders, m, (h,), with phases counted from the peak of the base."""
        base = self.mean(self.Y[:, 1:2])[0]
        return self.mean(self.X)[n] * np.exp(-1j * n * np.angle(base))


@one_thread
def condition(
    measurement: Record,
    k: float,
    *,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    base_mass: float | None = None,
) -> SteadyRecord:
    """Return the steady state of a measurement.

    k : stiffness, N/m.   frequency_hz : nominal drive frequency, compared with that of the excitation.
    skip_cycles : cycles to leave out at the start, before the motion has settled.   base_mass : m, kg, if the contact
    acts between the mass and the base, as spring and damper do; default, it acts on the ground.

    Raises ValueError naming the source if the record cannot be used: a constant channel, too few cycles, another
    frequency, contradictory signals.
    """
    warnings: list[Finding] = []
    source, driving = measurement.name, measurement.excitation.quantity
    if not (math.isfinite(k) and k > 0.0):
        raise ValueError(f"{source}: the stiffness k must be positive, got {k}")
    kept = [q for q in measurement if q not in ACCOMPANYING]
    samples = {q: in_equal_steps(measurement[q], warnings) for q in kept}
    try:
        channels = _harmonics_of(samples, driving, frequency_hz, skip_cycles, warnings)
        return _steady(source, k, samples, channels, driving, skip_cycles, base_mass, warnings)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error


def in_equal_steps(channel: Channel, warnings: list[Finding]) -> Channel:
    """Return the channel with times in equal steps, and note a finding if they are off by more than rounding."""
    t = np.linspace(channel.t[0], channel.t[-1], channel.t.size)
    off = float(np.abs(channel.t - t).max()) / (t[1] - t[0])
    if off <= 1e-6:
        return channel
    if off > GRID_TOLERANCE:
        of = {"channel": visible(channel.name), "off": off}
        warnings.append(Finding("uneven times", of))
    return replace(channel, t=t)


def _steady(
    source: str,
    k: float,
    samples: Mapping[str, Channel],
    channels: Mapping[str, CycleHarmonics],
    driving: str,
    skipped: int,
    base_mass: float | None,
    warnings: list[Finding],
) -> SteadyRecord:
    """Return the steady record: harmonics in the rows that all channels have, in the time and at the frequency of the
    drive, without drift, as displacements.

    skipped : cycles that the user left out at the start.   warnings : findings on the samples; others are added.
    """
    base = channels[driving]
    # the whole record refines the frequency of the leading part
    offset, omega_error = frequency_offset(base)
    omega = base.omega + offset
    per_row = {q: h.cycles_per_row for q, h in channels.items()}
    if len(set(per_row.values())) > 1:
        raise ValueError(f"the channels differ too much in length: cycles per row are {per_row}")
    common = min(len(h.weights) for h in channels.values())
    weights = np.min([h.weights[:common] for h in channels.values()], axis=0)
    coordinate = samples[driving].coordinate
    passed = {
        q: _passed(coordinate.noun(q), h, omega)
        for q, h in channels.items()
        if h.correction is not None
    }
    named = {coordinate.noun(q): h for q, h in channels.items()}
    warnings += checks.checked_cycles(named, weights, base.omega, coordinate)
    usable = weights > 0.0
    times, weights = base.times[:common][usable] - base.start, weights[usable]
    rows = {q: h.coefficients[:common][usable] for q, h in channels.items()}
    slopes = _drifts([of[:, 0].real for of in rows.values()], times, weights)
    count = max(of.shape[1] for of in rows.values())
    turn = powers(np.exp(1j * (base.omega * base.start - offset * times)), count)
    noise_rms, moved = {}, {}
    for (q, of), slope in zip(rows.items(), slopes, strict=True):
        channel = channels[q]
        of[:, 1:] -= slope @ channel.drift[:, 1:]
        of *= turn[:, : of.shape[1]]
        # the scatter of the harmonics between rows gives the size of the white noise of the samples
        per_cycle = 2.0 * math.pi / (channel.omega * channel.dt)
        noise_rms[q] = math.sqrt(float(np.median(_scatter(of, weights)[1:])) * 0.5 * per_cycle)
        warnings += checks.few_bits(coordinate.noun(q), samples[q].values, noise_rms[q])
        response = passed.get(q, np.ones(of.shape[1]))
        scale = _of_displacement(q, response.size, omega, k) / response
        moved[q] = of[:, : scale.size] * scale
    Y = moved.pop(driving)
    moved = {q: moved[q] for q in RESPONSES if q in moved}
    # a force leaves the base at rest
    sign, others = (1.0, RELATIVE) if base_mass is None else (-1.0, ABSOLUTE)
    of_base = {q: sign * (q in others and driving != "force") for q in moved}
    own = {q: _error(of, weights)[1] for q, of in moved.items()}
    # higher harmonics of the base are noise
    highest = checks.highest_of_base(weighted_mean(Y, weights), _error(Y, weights))
    for q in moved:
        count = min(highest + 1, moved[q].shape[1])
        moved[q][:, 1:count] += of_base[q] * Y[:, 1:count]
    if base_mass is not None:
        ratio = base_mass * omega**2 / k
        Y = Y * (ratio * np.arange(Y.shape[1]) ** 2.0)
        of_base = {q: of / ratio for q, of in of_base.items()}
    warnings += checks.consistency(moved, weights, omega, coordinate)
    errors = {q: _error(of, weights) for q, of in moved.items()}
    if len(set(of_base.values())) == 1:  # otherwise only some contain the error of the base
        for q, error in own.items():
            errors[q][1] = error
    X, X_error, shares = _combined(moved, errors)
    mean_Y, mean_X = weighted_mean(Y, weights), weighted_mean(X, weights)
    if coordinate == TRANSLATION:  # an angle has no bounds
        warnings += checks.plausible(abs(mean_Y[1]), abs(mean_X[1]), omega, driving)
    warnings += checks.ratio(abs(mean_Y[1]), abs(mean_X[1]), driving, coordinate)
    period = 2.0 * math.pi / base.omega
    parts, unsteady = checks.steadiness(Y[:, 1], X[:, 1], times, weights, period, skipped)
    warnings += unsteady
    # the mean of an unsteady record represents its motion only to this
    Y_hidden, X_hidden = parts[0] * np.abs(mean_Y), parts[1] * np.abs(mean_X)
    Y_error = np.hypot(_error(Y, weights), Y_hidden)
    # the frequency has an error, too: ∂ln x/∂ω = 2mω x/(kY) with mω² = k − Re kY/x, large where the damping is light
    gain = mean_X[1] / mean_Y[1]
    by_frequency = 2.0 * abs(mean_X[1] * gain) * abs(1.0 - (1.0 / gain).real) * omega_error / omega
    # below 0.3 of the noise of the fundamental it widens intervals by less than 5 %
    if by_frequency > 0.3 * X_error[1]:
        X_hidden[1] = math.hypot(X_hidden[1], by_frequency)
    X_error = np.hypot(X_error, X_hidden)
    warnings += checks.harmonic_drive(mean_Y, Y_error, driving)
    asymmetry = list(checks.symmetry(mean_X, X_error, mean_Y, Y_error))
    warnings += asymmetry
    warnings += checks.work(mean_Y[1], mean_X[1], Y_error[1], X_error[1])
    corrected = {
        q: replace(channels[q], coefficients=channels[q].coefficients[:, : of.size] / of)
        for q, of in passed.items()
    }
    return SteadyRecord(
        source=source,
        k=k,
        omega=omega,
        omega_standard_error=omega_error,
        start=base.start,
        cycles=int(weights.sum()),
        cycles_per_row=base.cycles_per_row,
        Y=Y,
        X=X,
        weights=weights,
        X_error=X_error,
        Y_error=Y_error,
        shares=shares,
        X_hidden=X_hidden,
        Y_hidden=Y_hidden,
        bandwidth=_bandwidth(mean_X, X_error),
        even_bandwidth=_bandwidth(mean_X, X_error, lowest=2) if asymmetry else 0,
        base_bandwidth=checks.highest_of_base(mean_Y, Y_error),
        channels=dict(channels) | corrected,
        noise_rms=noise_rms,
        of_base=of_base,
        base_mass=base_mass,
        warnings=tuple(warnings),
    )


def _harmonics_of(
    channels: Mapping[str, Channel],
    driving: str,
    frequency_hz: float | None,
    skip_cycles: int,
    warnings: list[Finding],
) -> dict[str, CycleHarmonics]:
    """Return the harmonics of each channel, by quantity, at the drive frequency of the leading part of the record."""
    drive = channels[driving]
    noun = drive.coordinate.noun
    omega, error, cycles, begin = frequency_of(drive.t, drive.values, noun(driving))
    period = 2.0 * math.pi / omega
    if begin > -math.inf:
        warnings.append(Finding("starts late", {"quantity": noun(driving), "begin": begin}))
    warnings += checks.frequency(omega, error, cycles, frequency_hz)
    first = {q: int(np.searchsorted(channel.t, begin)) for q, channel in channels.items()}
    start = max(float(channels[q].t[i]) for q, i in first.items()) + skip_cycles * period
    harmonics = {}
    for q, channel in channels.items():
        leading = slice(first[q], first[q] + LEADING)
        step = step_of(channel.t[leading], noun(q))
        if q != driving:
            of_drive = drive.values[first[driving] :]
            checks.require_distinct(noun(q), channel.values[leading], noun(driving), of_drive)
        per_cycle = period / step
        if per_cycle < 12.0:
            raise ValueError(
                f"{noun(q)}: {per_cycle:.1f} samples per cycle are too few: sample at {12.0 / period:.3g} Hz or more"
            )
        # distortion by amplifiers and shakers lies in the nine lowest harmonics
        most = _MOST_HARMONICS[ORDERS[q]] if q in RESPONSES else 9
        highest = min(most, math.floor(per_cycle / 4.0))
        of_cycles = cycle_harmonics(
            *(channel.t, channel.values, omega),
            start=start,
            dt=step,
            harmonics=highest,
            missing=channel.missing,
        )
        harmonics[q] = replace(of_cycles, correction=channel.correction)
    return harmonics


def _passed(quantity: str, harmonics: CycleHarmonics, omega: float) -> Complexes:
    """Return the response H of a channel at each harmonic, up to the highest that its filters pass."""
    correction = harmonics.correction or Correction()
    response = correction.response(omega * np.arange(harmonics.coefficients.shape[1]))
    passed = np.abs(response) > _FILTERED_OUT * correction.gain
    if not passed[1]:
        raise ValueError(
            f"{quantity}: its filter passes less than {_FILTERED_OUT:g} of the drive, {omega / (2.0 * math.pi):.4g} "
            "Hz; check its corner or poles in the mapping"
        )
    return response if passed.all() else response[: int(np.argmin(passed))]


def _of_displacement(quantity: str, count: int, omega: float, k: float) -> Complexes:
    """Return the factors from the harmonics of a quantity to those of a displacement, m per unit; 0 for the mean of a
    velocity or an acceleration."""
    if quantity == "force":
        return np.full(count, 1.0 / k + 0j)
    by_time = np.concatenate([[0.0], 1.0 / (1j * omega * np.arange(1, count))])
    return by_time ** ORDERS[quantity]


def _drifts(means: Sequence[Array], times: Array, weights: Array) -> Array:
    """Return slope and half the second derivative of the offset in each row, per s and s², (channels, rows, 2).

    means : of each channel, (rows,), to which a parabola is fitted.   times : middle of the rows, s.
    """
    degree, at = 2 if len(times) >= 8 else 1, times - times.mean()
    fitted = np.polyfit(at, np.transpose(means), degree, w=np.sqrt(weights))
    bend = fitted[0][:, None] * (degree == 2) * np.ones(at.size)
    return np.stack([fitted[-2][:, None] + 2.0 * bend * at, bend], axis=-1)


def _error(rows: Complexes, weights: Array) -> Array:
    """Return the standard deviation of the real and of the imaginary part of the mean of each harmonic, from the
    scatter of the rows, smoothed over five neighbouring harmonics, since few cycles give a poor estimate for each."""
    smooth = _scatter(rows, weights) / weights.sum()
    higher = np.pad(smooth[2:], 2, constant_values=math.nan)
    smooth[2:] = np.nanmedian(sliding_window_view(higher, 5), axis=1)
    floor = (ROUNDING * abs(weighted_mean(rows, weights)[1])) ** 2
    return np.sqrt(np.maximum(smooth, floor))


def _scatter(rows: Complexes, weights: Array) -> Array:
    """Return the variance of the real and of the imaginary part of each harmonic in one cycle."""
    off = np.abs(rows - weighted_mean(rows, weights)) ** 2
    return weights @ off / (2.0 * (len(rows) - 1))


def _combined(
    moved: Mapping[str, Complexes], errors: Mapping[str, Array]
) -> tuple[Complexes, Array, dict[str, Array]]:
    """Return the mean of the harmonics of all responses, weighted by inverse variance, its standard deviations, and the
    weight of each response.

    errors : standard deviations of the mean of each harmonic.
    """
    count = max(rows.shape[1] for rows in moved.values())
    total = np.zeros((len(next(iter(moved.values()))), count), dtype=np.complex128)
    weights = {q: np.zeros(count) for q in moved}
    for q, rows in moved.items():
        size = rows.shape[1]
        weights[q][:size] = errors[q] ** -2.0
        total[:, :size] += weights[q][:size] * rows
    precision = np.sum(list(weights.values()), axis=0)
    shares = {q: weight / precision for q, weight in weights.items()}
    return total / precision, 1.0 / np.sqrt(precision), shares


def _bandwidth(mean: Complexes, error: Array, lowest: int = 1) -> int:
    """Return the highest odd (lowest = 1) or even (2) significant harmonic (`CERTAIN`); two successive ones may be
    hidden in the noise."""
    orders = np.arange(lowest, len(mean), 2)
    clear = orders[(orders == lowest) | (np.abs(mean[orders]) > CERTAIN * error[orders])]
    ends = clear[np.diff(clear, append=math.inf) > 6]
    return int(ends[0])
