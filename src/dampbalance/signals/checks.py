"""Checks for the faults that a record may have; a good record passes all of them.

A fault that makes the record useless raises ValueError; one that only lowers its accuracy yields a finding with its
size. A difference counts if it is significant against the scatter between cycles and large enough to matter.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy import special

from ..arrays import Array, Complexes
from ..findings.finding import UNBOUNDED, Finding
from ..findings.words import sentence
from ..project.spelling import spelled
from ..project.wording import signed
from ..records.coordinate import TRANSLATION, Coordinate
from .bursts import Burst, Signal
from .cycles import FEWEST_CYCLES, CycleHarmonics
from .thresholds import NEVER, P_DRIFT, SIGNIFICANT

FEW_CYCLES = 10
"""Number of cycles below which the scatter between cycles gives no reliable interval."""

# Smallest change of a frequency or an amplitude (both relative) or of a phase (rad) that is reported and widens
# intervals: at a loss factor of 2 % it changes the loss by a per mille.
_SMALLEST_CHANGE = 2e-5
# relative; beyond it channels contradict each other, or a record has no steady motion
_AMPLITUDE_WRONG = 0.1
_UNITS = {
    **{1000.0: "mm taken for m", 100.0: "cm taken for m", 25.4: "mm taken for inches"},
    9.80665: "g taken for m/s², or the other way round",
}
_NEAR = 0.03  # relative deviation from the factor between two units
# cycles of a decay in which channels are compared, and the ratio of their motions from which on units differ
_COMPARED, _OTHER_UNIT = 3.0, 3.0

_FINE = 1 << 12  # steps of a converter of 12 bits, and number of samples that show them
ROUNDING = 1e-9  # relative to a signal; rounding differs by less between two copies of it

_UNCONNECTED = "the transducer was not connected, or it is another column: name it in the mapping"
_TURNED = "if one of them points in the opposite direction, say sign: -1 for it in the mapping"
_UNCALIBRATED = "correct unit: … or scale: … of one in the mapping, or leave one of the two out"


def require_signal(quantity: str, values: Array) -> None:
    """Raise ValueError if all values are equal."""
    if not np.ptp(values) > 0.0:
        raise ValueError(f"{quantity} is constant ({values[0]:.6g}): {_UNCONNECTED}")


def require_distinct(quantity: str, values: Array, driving: str, drive: Array) -> None:
    """Raise ValueError if a response is the excitation itself, with another scale or offset."""
    count = min(values.size, drive.size)
    x, y = values[:count] - values[:count].mean(), drive[:count] - drive[:count].mean()
    square = float(y @ y)
    factor = float(x @ y) / square if square > 0.0 else 0.0
    if np.abs(x - factor * y).max() < ROUNDING * np.abs(x).max():
        raise ValueError(
            f"{quantity} is {driving} times {factor:.6g}: both were read from one channel; name the channel of each in "
            "the mapping"
        )


def frequency(
    omega: float, error: float, cycles: int, frequency_hz: float | None
) -> Iterator[Finding]:
    """Compare the frequency of the excitation with the stated one. Raises ValueError if they differ by over 5 %.

    Every difference that the record resolves is reported if it exceeds 20 ppm, by which the quartz clocks of two sound
    devices may differ. A relative error e of the recorder's clock changes times, frequencies and c by e. As a record
    cannot distinguish this from rounding of the stated frequency, the finding names both.

    omega, error : measured frequency and its standard error, from a line through the phases of all cycles, rad/s.
    """
    if frequency_hz is None:
        return
    if not (math.isfinite(frequency_hz) and frequency_hz > 0.0):
        raise ValueError(f"the drive frequency must be positive, got {frequency_hz} Hz")
    hertz, spread = omega / (2.0 * math.pi), error / (2.0 * math.pi)
    off = hertz / frequency_hz - 1.0
    numbers = {"measured": hertz, "error": spread, "given": frequency_hz, "off": off}
    # no clock is off by 5 %; a wrong column or rate is by more
    if abs(off) > 0.05:
        raise ValueError(sentence(Finding("other frequency", numbers), TRANSLATION))
    if abs(off) > max(_SMALLEST_CHANGE, _significant_for(max(1, cycles - 2)) * spread / hertz):
        yield Finding("frequency", numbers, {"": abs(off)})


def _significant_for(freedom: int) -> float:
    """Return the number of standard errors as rare as SIGNIFICANT if they are known with some degrees of freedom."""
    return float(-special.stdtrit(freedom, NEVER))


def checked_cycles(
    channels: Mapping[str, CycleHarmonics], weights: Array, omega: float, coordinate: Coordinate
) -> Iterator[Finding]:
    """Yield findings on cycles that are left out, and on the signals in the others.

    channels : by their names in the coordinate.   weights : cycles in each row that all channels have.   omega : of the
    drive, rad/s.

    Raises ValueError if fewer than three cycles can be used, or if a channel does not oscillate with the drive.
    """
    left_out = []
    for quantity, harmonics in channels.items():
        if bad := harmonics.bad_cycles:
            number, time, why = bad[0]
            of = {"quantity": quantity, "count": len(bad), "first": number + 1, "time": time}
            left_out.append(Finding("spikes", {**of, "why": why}))
    yield from left_out
    count, hertz = int(weights.sum()), omega / (2.0 * math.pi)
    if min(count, int(np.count_nonzero(weights))) < FEWEST_CYCLES:
        raise ValueError(
            f"only {count} usable whole cycles of {hertz:.5g} Hz are common to all channels, and at least "
            f"{FEWEST_CYCLES} are needed: record longer, or skip fewer ({spelled('skip_cycles')})"
            + "".join(f"; {sentence(one, coordinate)}" for one in left_out)
        )
    if count < FEW_CYCLES:
        yield Finding("few cycles", {"cycles": count, "enough": FEW_CYCLES})
    for quantity, harmonics in channels.items():
        if not harmonics.span > 0.0:
            raise ValueError(f"{quantity} is constant: {_UNCONNECTED}")
        fundamental = harmonics.coefficients[harmonics.weights > 0.0, 1]
        amplitude = abs(fundamental.mean())
        scatter = float(fundamental.std()) / math.sqrt(fundamental.size)
        if amplitude < SIGNIFICANT * scatter:
            raise ValueError(
                f"{quantity} does not oscillate at the drive frequency of {hertz:.5g} Hz: amplitude {amplitude:.3g} ± "
                f"{scatter:.2g}; name another column for it in the mapping, or raise the excitation"
            )
        if is_clipped(harmonics):
            of = {"quantity": quantity, "cycles": harmonics.clipped}
            yield Finding("clipped", of, UNBOUNDED)


def is_clipped(harmonics: CycleHarmonics) -> bool:
    """Return whether the signal is clipped in at least half of the cycles."""
    return harmonics.clipped >= 0.5


def consistency(
    moved: dict[str, Complexes], weights: Array, omega: float, coordinate: Coordinate = TRANSLATION
) -> Iterator[Finding]:
    """Yield findings if displacement, velocity and acceleration are not those of one motion.

    moved : harmonics of each response as displacements, rows × harmonics. A channel with a significant delay or gain is
    corrected in place to agree with the first.

    Raises ValueError if the difference is too large for a delay or a gain.
    """
    first, *others = moved
    reference = moved[first][:, 1]
    mean = weighted_mean(reference, weights)
    for name in others:
        ratio = weighted_mean(moved[name][:, 1], weights) / mean
        rest = np.abs(moved[name][:, 1] - ratio * reference)
        error = math.sqrt(float(weights @ rest**2) / (2.0 * (len(rest) - 1)) / weights.sum())
        error /= abs(mean)
        gain, phase = abs(ratio), math.atan2(ratio.imag, ratio.real)
        names = {"quantity": coordinate.noun(name), "other": coordinate.noun(first)}
        # 0.5 rad is no delay of a channel, but a sign or another quantity
        if abs(gain - 1.0) > _AMPLITUDE_WRONG or abs(phase) > 0.5:
            of = names["quantity"], names["other"]
            raise ValueError(_contradiction(*of, "the drive frequency", gain, phase))
        late = abs(phase) > max(SIGNIFICANT * error, _SMALLEST_CHANGE)
        # F_k and c have the same relative error as the gain
        scaled = abs(gain - 1.0) > max(SIGNIFICANT * error, 1e-4)
        if late:
            by = {"lags": phase < 0.0, "by": abs(phase) / omega, "error": error / omega}
            yield Finding("late", {**names, **by}, {"": abs(phase)})
        if scaled:
            yield Finding("scaled", {**names, "gain": gain}, {"": abs(gain - 1.0)})
        n = np.arange(moved[name].shape[1])
        moved[name] = moved[name] * np.exp(-1j * n * phase * late) / (gain if scaled else 1.0)


def contradiction_in(signals: Sequence[Signal], burst: Burst, coordinate: Coordinate) -> str:
    """Return how the channels of a free decay contradict each other by a sign or by a factor of two units, which no fit
    of all of them explains; empty if they do not.

    Their lines at the frequency of the decay are compared over its first cycles. Friction and damping change these by
    less.
    """
    omega, end = 2.0 * math.pi / burst.period, burst.turn + _COMPARED * burst.period

    def line(signal: Signal) -> complex:
        """Return the line of the displacement that the channel shows, m s."""
        part = signal.between(burst.turn, end)
        turns = np.exp(-1j * omega * (part.t - burst.turn)) * np.hanning(part.t.size)
        return complex(turns @ part.values) * signal.dt / (1j * omega) ** signal.order

    first, *others = signals
    for other in others:
        ratio = line(other) / (line(first) or 1.0)
        gain, phase = abs(ratio), math.atan2(ratio.imag, ratio.real)
        if not 1.0 / _OTHER_UNIT < gain < _OTHER_UNIT or abs(phase) > 0.75 * math.pi:
            names = coordinate.noun(other.quantity), coordinate.noun(first.quantity)
            return _contradiction(*names, f"{1.0 / burst.period:.3g} Hz", gain, phase)
    return ""


def _contradiction(quantity: str, other: str, where: str, gain: float, phase: float) -> str:
    """Return how two channels of one motion are reported that contradict each other.

    where : the frequency at which they are compared.   gain, phase : of the quantity relative to the other one.
    """
    size = max(gain, 1.0 / gain) if gain else math.inf
    confused = (f" ({of}?)" for by, of in _UNITS.items() if abs(size / by - 1.0) < _NEAR)
    return (
        f"{quantity} contradicts {other}: at {where} it shows {gain:.4g} times the motion{next(confused, '')}, "
        f"{signed(math.degrees(phase), 1)}° apart; {_TURNED if abs(phase) > 0.75 * math.pi else _UNCALIBRATED}"
    )


class _Change(NamedTuple):
    """A slow change of the fundamental during a record.

    chance : probability of a change as large in noise.   size : of the amplitude, relative to the mean.   turn : of
    the phasor, relative to the mean.   noise : variance of the real and of the imaginary part of a row.
    shows : whether the change is significant and large enough to matter.   bends : whether it is significantly more
    than a line, as that of a motion that settles.
    """

    chance: float
    size: float
    turn: float
    noise: float
    shows: bool
    bends: bool


def _change(rows: Complexes, weights: Array, parts: float) -> _Change:
    """Return the change of the rows along a line, a parabola and the difference between the first eighth and the rest.

    Under white noise, the sum of squares of the real and imaginary parts along these three, over the variance, has an F
    distribution. The variance is that of successive differences, which a slow change does not affect, in the quieter
    half of the record, as a transient is loud at its start.   parts : 2 for complex rows, 1 for real ones.
    """
    size, mean = len(rows), weighted_mean(rows, weights)
    basis = _slow(size)
    along = basis.T @ rows
    halves = rows[: size // 2], rows[size // 2 :]
    noise = min(float(np.mean(np.abs(np.diff(half)) ** 2)) for half in halves) / (2.0 * parts)
    squares = np.abs(along) ** 2 / max(noise, 1e-300)
    # successive differences determine the variance as well as two thirds as many independent rows; choosing the
    # quieter of two halves doubles the chance
    freedom = parts * max(1.0, 2.0 * (size // 2 - 1) / 3.0)

    def chance_of(squares: Array) -> float:
        own = parts * squares.size
        return 2.0 * float(special.fdtrc(own, freedom, float(np.sum(squares)) / own))

    chance = chance_of(squares)
    change = basis @ along
    grown, turned = float(np.ptp(np.abs(change + mean))), float(np.abs(change).max())
    matters = max(grown, turned) >= _SMALLEST_CHANGE * abs(mean)
    shows = matters and chance <= P_DRIFT
    # with a chance below 1 % the change is more than a line
    bends = chance_of(squares[1:]) < 0.01
    return _Change(chance, grown / abs(mean), turned / abs(mean), noise, shows, bends)


def _slow(size: int) -> Array:
    """Return an orthonormal basis of slow changes, orthogonal to a constant, (rows, 3)."""
    s, first = np.linspace(-1.0, 1.0, size), np.arange(size) < max(1, size // 8)
    return np.linalg.qr(np.column_stack([np.ones(size), s, s**2, first]))[0][:, 1:]


def few_bits(quantity: str, values: Array, noise: float) -> Iterator[Finding]:
    """Yield a finding if a converter with coarse steps recorded a signal: its rounding errors repeat in each cycle and
    do not show as scatter. Noise of at least half a step makes them random.

    noise : standard deviation, in the unit of the values.
    """
    span, steps = float(np.ptp(values)), np.diff(np.unique(values[:_FINE]))
    if not steps.size or not (step := float(steps.min())) * _FINE > span or noise > 0.5 * step:
        return
    whole = np.round(steps / step)
    # all steps are multiples of the smallest one, to rounding
    if (np.abs(steps / step - whole) <= 0.01 * whole).all():
        of = {"quantity": quantity, "bits": math.log2(span / step)}
        yield Finding("bits", of, {"": step / span})


class Unsettled(ValueError):
    """A record whose amplitude changes too much.   finding : says how."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(sentence(finding, TRANSLATION))
        self.finding = finding

    @property
    def skip(self) -> int:
        """Number of cycles to leave out at the start; 0 if that does not help."""
        return int(self.finding.numbers["skip"])


def steadiness(
    Y: Complexes, X: Complexes, times: Array, weights: Array, period: float, skipped: int = 0
) -> tuple[tuple[float, float], list[Finding]]:
    """Return the relative standard deviations over the record of the fundamentals of base and response, 0 for a steady
    one, and findings on those that are not steady, judged by the scatter from cycle to cycle (`_change`).

    skipped : cycles left out already.

    Raises Unsettled if an amplitude changes by more than a tenth.
    """
    size, parts_of, warnings = len(Y), [0.0, 0.0], list[Finding]()
    if size < 4:
        return (0.0, 0.0), warnings
    # phases count from the excitation, so that only its amplitude varies
    amplitude = np.abs(Y)
    both = (amplitude + 0j, 1.0), (X / (Y / amplitude), 2.0)
    for i, (rows, parts) in enumerate(both):
        change = _change(rows, weights, parts)
        if not change.shows:
            continue
        # standard deviations of a linear change from end to end, and to either side of the mean
        parts_of[i] = max(change.size / math.sqrt(12.0), change.turn / math.sqrt(3.0))
        # it has settled once the phasor stays within its scatter about the mean of the second half
        late = rows[size // 2 :].mean()
        scatter = 4.0 * math.sqrt(parts * change.noise) + 1e-6 * abs(late)
        outside = 1 + np.flatnonzero(np.abs(rows - late) > scatter)
        settles = bool(change.bends and outside.size and outside[-1] < size // 2)
        after = round(outside[-1] * (times[-1] - times[0]) / (size - 1) / period) if settles else 0
        numbers = {
            **{"drive": i == 0, "change": change.size, "turn": change.turn},
            **{"chance": change.chance, "after": after, "skip": skipped + after if settles else 0},
            # a phase that changes more than the amplitude indicates two clocks, or a growing friction force
            "phase": change.turn > 5.0 * change.size,
            "large": change.size > _AMPLITUDE_WRONG and not settles,
        }
        said = Finding("unsettled", numbers, {"": parts_of[i]})
        # a response that follows an unsteady drive is no transient and may be averaged
        if change.size > _AMPLITUDE_WRONG and not (i and parts_of[0] and not settles):
            raise Unsettled(said)
        warnings.append(said)
    return (parts_of[0], parts_of[1]), warnings


def plausible(Y: float, X: float, omega: float, driven_by: str) -> Iterator[Finding]:
    """Yield findings if the amplitudes Y, X (m) are not those of a test bench, so that a unit may be wrong.

    A wrong unit of all channels scales F_k and nothing else, so that only the size can reveal it. Accelerations above
    100 g are usual at high frequencies, but speeds of tens of m/s are not. For a force, Y is no motion.
    """
    for base, amplitude in ((True, Y),) * (driven_by != "force") + ((False, X),):
        # 0.5 m is about ten times the stroke of long shakers, 10 m/s three times the speed of the fastest
        if amplitude > 0.5 or omega * amplitude > 10.0:
            numbers = {"base": base, "amplitude": amplitude, "speed": omega * amplitude}
            yield Finding("implausible", numbers, UNBOUNDED)


def ratio(Y: float, X: float, driven_by: str, coordinate: Coordinate) -> Iterator[Finding]:
    """Yield a finding if the amplitudes of mass and base differ so much that the unit of one may be wrong.

    A ratio from 100 to 300 is rare, but may be explained by the oscillator that is fitted: a Q of 300 and a drive at 17
    times the natural frequency are at the limit. A larger ratio puts all numbers in doubt.
    """
    gain = X / Y
    size = max(gain, 1.0 / gain)
    if size > 100.0:
        nearest = min(_UNITS, key=lambda factor: abs(math.log(size / factor)))
        of = {"gain": gain, "confused": _UNITS[nearest], "by_force": driven_by == "force"}
        angle = coordinate != TRANSLATION
        rare = size < 300.0
        yield Finding("unit", {**of, "angle": angle, "rare": rare}, {} if rare else UNBOUNDED)


def harmonic_drive(mean: Complexes, error: Array, driven_by: str) -> Iterator[Finding]:
    """Yield a finding if the base motion or the force has harmonics, which not all approaches take into account."""
    relative = _significant(mean, error)[2:]
    if relative.any():
        distortion = math.hypot(*relative)
        largest = {"order": int(np.argmax(relative)) + 2, "share": float(relative.max())}
        of = {"by_force": driven_by == "force", "distortion": distortion, **largest}
        yield Finding("base", of, {"": distortion})


def highest_of_base(mean: Complexes, error: Array) -> int:
    """Return the highest significant harmonic of the base, at least 1.

    Its work is of first order in the harmonic, so that even those far too small for a finding count.
    """
    # 1e-6 of the fundamental may be rounding of a file or a time
    clear = np.abs(mean) > np.maximum(SIGNIFICANT * error, 1e-6 * abs(mean[1]))
    return max(1, int(np.flatnonzero(clear)[-1]))


def symmetry(
    mean: Complexes, error: Array, base: Complexes, base_error: Array
) -> Iterator[Finding]:
    """Yield a finding if the response has even harmonics. Friction or stiffness then differ between the directions,
    unless the base has even harmonics, too, which act on odd ones only in second order."""
    even = _significant(mean, error)[2::2]
    order = 2 if _significant(base, base_error)[2::2].any() else 1
    if even.any():
        of = {"order": 2 * int(np.argmax(even)) + 2, "share": float(even.max())}
        yield Finding("asymmetric", of, {"": float(even.max()) ** order})


def _significant(mean: Complexes, error: Array) -> Array:
    """Return the size of each harmonic relative to the fundamental; 0 if it is below 1e-3 or not significant."""
    relative = np.abs(mean) / abs(mean[1])
    real = (relative > 1e-3) & (np.abs(mean) > SIGNIFICANT * error)
    return np.where(real, relative, 0.0)


def work(Y: complex, X: complex, Y_error: float, X_error: float) -> Iterator[Finding]:
    """Yield a finding if the base does no work on the mass."""
    sine = -math.sin(math.atan2((X / Y).imag, (X / Y).real))
    error = math.hypot(X_error / abs(X), Y_error / abs(Y))
    if sine <= -SIGNIFICANT * error:
        yield Finding("exchanged", {"sine": sine}, UNBOUNDED)


def weighted_mean(rows: Complexes | Array, weights: Array) -> Any:
    """Return the weighted mean of the rows: a number for rows (n,), an array (h,) for rows (n, h)."""
    return weights @ rows / weights.sum()
