"""From the columns of a file to a Measurement in SI: finite, within bounds, in equal steps, not constant, no overflow.
Times that were rounded to too few digits are put in equal steps."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import Array
from ...project.wording import Remark
from ...record import GRID_TOLERANCE
from .. import errors
from ..errors import RecordError, RecordWarning
from ..measurement import QUANTITIES, Channel, sample_times
from ..table import Table
from .channels import Pick

_BITS = (8, 16, 24, 32, 64)  # of the integers that converters and files have
# of their range: no oscillation passes through so much of it from one sample to the next
_WRAPPED = 0.9
_INTEGER = 0.01  # of the resolution: room for the rounding of its multiples to floats
_WITHIN = 1.5  # resolutions; rounding, and what the line is off by itself
_ACCURATE = 1e-3  # of the rate, that it may be off by at the most: c is then off by as much


def whole(file: Table, picks: Sequence[Pick]) -> list[Channel]:
    """All samples of the picked channels.

    Raises RecordError naming channel and line or sample: a value that is missing, not finite or beyond all bounds,
    times that do not increase, have a gap or unequal steps, a constant channel, an integer that ran over, channels of
    unequal lengths.
    """
    columns = file.columns(wanted_of(picks))
    first_of: dict[tuple[object, ...], Pick] = {}  # of the channels that share their times
    channels: list[Channel] = []
    for pick in picks:
        first = first_of.setdefault((pick.time, pick.rate_hz, pick.start), pick)
        size, others = columns[pick.index].size, columns[first.index].size
        if pick.time is not None and columns[pick.time].size != size:
            raise RecordError(
                f"{file.path}: channel {pick.name!r} has {size} samples, its time "
                f"{file.channels[pick.time].name!r} has {columns[pick.time].size}; each sample needs its time"
            )
        if others != size:
            raise RecordError(
                f"{file.path}: channel {first.name!r} has {others} samples, {pick.name!r} has {size}; channels "
                "that share their times have equal lengths"
            )
        own = {i: columns[i] for i in wanted_of([pick])}
        if pick.time is not None:
            own = _without_empty_end(own)
        channels.append(_checked(file, pick, own))
    return channels


def _checked(file: Table, pick: Pick, columns: Mapping[int, Array]) -> Channel:
    """The channel of these columns, checked. Raises RecordError as `whole`."""
    values = columns[pick.index]
    if values.size < 3:
        remedy = "that is no record"
        raise RecordError(f"{file.path}: channel {pick.name!r} has {values.size} samples; {remedy}")
    unit = pick.coordinate.unit(QUANTITIES[pick.quantity])
    signal = _in_si(file, pick.index, values, pick.factor, errors.LARGEST_VALUE, unit)
    _require_no_overflow(file, pick, values)
    if pick.time is None:
        t = sample_times(pick.rate_hz, pick.start, 0, values.size)
    else:
        where = f"{file.path}: time channel {file.channels[pick.time].name!r}"
        t = _in_si(file, pick.time, columns[pick.time], pick.time_factor, errors.LATEST, "s")
        t = _in_equal_steps(t, where)
        _require_rate(t, where)
    _require_moving(f"{file.path}: channel {pick.name!r}", pick, values, unit)
    try:
        of = pick.name, pick.correction, pick.coordinate
        return Channel(pick.quantity, t, signal, *of)
    except ValueError as error:
        raise RecordError(f"{file.path}: {error}") from None


def _require_moving(channel: str, pick: Pick, values: Array, unit: str) -> None:
    """RecordError for a channel that is constant, or as good as that."""
    low, high = float(values.min()), float(values.max())
    span, constant = high - low, f"{low:g} in all {values.size} samples"
    if not span:
        raise RecordError(f"{channel} is constant, {constant}; check transducer and mapping")
    if (swing := span * abs(pick.factor)) < errors.SMALLEST_RANGE:
        raise RecordError(
            f"{channel} moves by {swing:.3g} {unit} in all, too little to mean anything; check its unit and scale"
        )
    if span < errors.FINEST * max(abs(low), abs(high)):
        remedy = "check transducer and mapping, or take off its offset"
        raise RecordError(f"{channel} is constant except for rounding, {constant}; {remedy}")


def _in_si(file: Table, index: int, values: Array, factor: float, bound: float, unit: str) -> Array:
    """The values in SI, finite and within the bound either way."""
    with np.errstate(over="ignore", invalid="ignore"):  # a damaged file has signalling NaN, too
        signal = values * factor
    bad = np.flatnonzero(~(np.abs(signal) <= bound))
    if not bad.size:
        return signal
    i, remedy = int(bad[0]), "cut the record before it"
    what = "empty or not a number (NaN)" if np.isnan(values[i]) else "infinite"
    if np.isfinite(values[i]):
        what, remedy = f"{values[i]:.6g}, beyond {bound:g} {unit}", "check its unit and scale"
    more = f", and so are {bad.size - 1} more" if bad.size > 1 else ""
    raise RecordError(
        f"{file.path}: {file.place(i)}: channel {file.channels[index].name!r} is {what}{more}; "
        f"{remedy}, or repair it"
    )


def _require_no_overflow(file: Table, pick: Pick, values: Array) -> None:
    """No jump through nearly the whole range of an integer type, from its one end to the other."""
    jumps = np.abs(np.diff(values))
    i = int(np.argmax(jumps))
    bits = next((bits for bits in _BITS if np.ptp(values) < 2.0**bits), 0)
    if not bits or jumps[i] <= _WRAPPED * 2.0**bits or np.any(values != np.round(values)):
        return
    raise RecordError(
        f"{file.path}: {file.place(i + 1)}: channel {pick.name!r} "
        f"goes from {values[i]:g} to {values[i + 1]:g}: an integer of {bits} bits ran over; record "
        "with a wider range"
    )


def _require_rate(t: Array, where: str) -> None:
    """RecordError for times in steps that no recorder has.   where : file and channel."""
    step = float(np.median(np.diff(t)))
    if step > 0.0 and not errors.LOWEST_RATE <= 1.0 / step <= errors.HIGHEST_RATE:
        raise RecordError(
            f"{where} has steps of {step:g} s, which no recorder has; check its unit, or give sample_rate_hz"
        )


def wanted_of(picks: Sequence[Pick]) -> list[int]:
    """The channels to read, signals and times."""
    return sorted({i for pick in picks for i in (pick.index, pick.time) if i is not None})


def _without_empty_end(columns: Mapping[int, Array]) -> dict[int, Array]:
    """The columns without the rows at the end that are empty in all, as a shorter time base leaves them."""
    present = np.flatnonzero(~np.all([np.isnan(column) for column in columns.values()], axis=0))
    end = int(present[-1]) + 1 if present.size else 0
    return {i: column[:end] for i, column in columns.items()}


def _in_equal_steps(t: Array, where: str) -> Array:
    """The times of a channel: t_i = t_0 + i Δt by least squares, where it holds these rounded to too few digits, as
    stamps in ms of 20,000 samples a second are.

    It does if all are multiples of a decimal resolution q apart and none is further than that from the line. Rounding
    errors of up to q/2 put the slope off by 3q/2T at the most, T being the length of the record; they rarely conspire
    like that, and a hundredth of it is common. A warning states the bound. Any other times are returned as they are.

    t : s.   where : file and channel, for the warning.
    """
    steps = np.diff(t)
    if t.size < 3 or not steps.min() >= 0.0 or not t[-1] > t[0]:
        return t
    even = np.linspace(t[0], t[-1], t.size)
    if np.abs(t - even).max() <= GRID_TOLERANCE * (even[1] - even[0]):
        return t
    q = next((q for n in range(13) if _are_multiples(steps, q := 10.0**-n)), np.inf)
    i = np.arange(t.size) - 0.5 * (t.size - 1)
    middle = float(t.mean())
    step = float(i @ (t - middle)) / float(i @ i)
    line = np.asarray(middle + step * i)
    if not step > 0.0:  # underflow
        return t
    bound = 1.5 * q / (step * t.size)
    if np.ptp(t - line) > _WITHIN * q or bound > _ACCURATE:
        return t
    rounded = Remark(
        "{} is rounded to {:.3g} s, its samples are {:.3g} s apart: {:.9g} samples a second are taken, from the line "
        "through it, off by {:.3g} ppm at the most; give sample_rate_hz if known",
        *(where, q, step, 1.0 / step, 1e6 * bound),
        doubts={"": bound},
    )
    warnings.warn(RecordWarning(rounded), stacklevel=2)
    return line


def _are_multiples(steps: Array, q: float) -> bool:
    """Whether all steps are multiples of q, none but zero being lost."""
    multiples = np.round(steps / q)
    lost = (multiples == 0.0) & (steps > 0.0)
    return not lost.any() and bool(np.abs(steps / q - multiples).max() < _INTEGER)
