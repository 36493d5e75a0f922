"""The channels of a record in SI units from an open table: the one place where a record is checked.

Mapping, headings, units and samples say which channel holds what; each must have its unit and its times, and samples
that are finite, within bounds, in equal steps, not constant, and no integers that ran over. Times that were rounded to
too few digits are put in equal steps. Single samples that are missing, empty or not a number are left out of what is
fitted, and rows that are there twice are dropped, with a warning that says how many and where. A table that cannot be
used is refused with what is missing, and with the mapping to write where that is the remedy.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Integers, Mask
from ..findings.finding import Finding
from ..project.wording import shortened
from . import errors
from .channel import (
    EXCITATIONS,
    QUANTITIES,
    RESPONSES,
    Channel,
    Correction,
    sample_times,
)
from .clock import GRID_TOLERANCE, uneven
from .coordinate import TRANSLATION, Coordinate
from .draft import unclear
from .errors import RecordError, RecordWarning
from .guess import BY_UNIT, Guesses, first_of, is_loop
from .headings import unit_of
from .mapping import ChannelRule, RecordMapping
from .record import Record
from .table import RawChannel, Table
from .units import DIMENSIONS, UNITS, UnitError, unit_for

_BITS = (8, 16, 24, 32, 64)  # integers that converters and files have
# part of their range: no oscillation passes through so much of it from one sample to the next
_WRAPPED = 0.9
# part of the resolution: room for the rounding of its multiples to floats
_MULTIPLE_TOLERANCE = 0.01
_LINE_TOLERANCE = 1.5  # resolutions; rounding, and what the line is off by itself
_MAX_RATE_ERROR = (
    1e-2  # largest relative error of the rate, a hundred times a common one; c has the same
)
_MOST_MISSING = 0.03  # of the samples of a channel: more is a gap, or another clock
_LONG = 10  # steps, from which on the clock may have jumped instead
_AROUND = 8  # samples on either side of a gap, which a parabola describes
_GAPS = 100  # that are looked at
_CLEAR = 5.0  # log-likelihood ratio of a decision
_EXACT = 1e-20  # sum of squares relative to that of the signal: less is rounding
_PLACES = 3  # that a warning lists


@dataclass(frozen=True, slots=True)
class Pick:
    """One quantity of the record: value in SI = factor · what channel `index` holds.

    time : index of its time channel, None for equal steps at `rate_hz` from `start` (s) on, at a rate of 0 without
    times; time_factor : seconds per unit of that channel.   correction : that its harmonics need.
    coordinate : whether it rotates.
    """

    quantity: str
    index: int
    name: str
    factor: float
    time: int | None = None
    time_factor: float = 1.0
    rate_hz: float = 0.0
    start: float = 0.0
    correction: Correction | None = None
    coordinate: Coordinate = TRANSLATION


def recognise(table: Table, mapping: RecordMapping, *others: tuple[Table, RecordMapping]) -> Record:
    """Return the record in an open table, in SI units.

    mapping : what the table does not say.   others : more tables that hold channels of the record, with their parts of
    the mapping.

    Raises RecordError for a record that cannot be used, naming what is missing or wrong and the remedy: channels that
    cannot be distinguished, as `picks_of`; channel and line or sample of a value that is infinite or beyond all bounds,
    of more than a few that are missing, times that do not increase, have a long gap or unequal steps, a constant
    response, an integer that ran over, channels of unequal lengths. Warns of what looks odd, and of what is left out
    (RecordWarning).
    """
    order, channels = list(QUANTITIES), list[Channel]()
    for file, of in ((table, mapping), *others):
        channels += _channels(file, picks_of(file, of))
    channels.sort(key=lambda channel: order.index(channel.quantity))
    return Record.of(str(table.path), channels)


def picks_of(file: Table, mapping: RecordMapping) -> tuple[Pick, ...]:
    """Return what to read from a file, in the order of QUANTITIES.

    Raises RecordError naming the channel and the remedy: one that is not there, is there twice or has no unit or no
    time, a unit that does not fit; channels that cannot be distinguished, with the mapping to write.
    """
    guesses = Guesses(file, mapping)
    rules: Mapping[str, ChannelRule] = mapping.channels
    if not rules:
        for question in guesses.questions():
            raise unclear(guesses, question)
        rules = guesses.rules
    found = {q: guesses.find(of.channel, f"channels.{q}.channel")[0] for q, of in rules.items()}
    loop = is_loop(found) and not mapping.free
    picks = tuple(_pick(guesses, q, found[q], rules[q], loop) for q in QUANTITIES if q in found)
    for said in () if mapping.channels else _said(guesses, picks):
        warnings.warn(RecordWarning(guesses.path, said), stacklevel=2)
    return picks


def _pick(guesses: Guesses, quantity: str, index: int, rule: ChannelRule, untimed: bool) -> Pick:
    """Return the pick of a channel with the times that the mapping or the file gives it.

    untimed : whether it does without, as a measured loop.
    """
    raw = guesses.channels[index]
    if raw.stamps:
        raise RecordError(
            f"{guesses.path}: channel {shortened(raw.name)} holds points in time, no {quantity}; give another"
        )
    factor = rule.sign * rule.scale
    factor *= _unit(guesses, raw, rule.unit or unit_of(raw), rule.coordinate.key(quantity))
    pick = Pick(
        *(quantity, index, raw.name, factor),
        correction=rule.correction,
        coordinate=rule.coordinate,
    )
    if guesses.mapping.sample_rate_hz is not None:
        return replace(pick, rate_hz=guesses.mapping.sample_rate_hz)
    own, key = rule.time, f"channels.{quantity}.time"
    time = guesses.time_of(index) if own is None else guesses.find(own, key)[0]
    if time == index:
        raise RecordError(f"{guesses.path}: channel {raw.name!r} cannot be its own time")
    if time is not None:
        seconds = _unit(guesses, guesses.channels[time], guesses.unit_of_time(time), "time")
        return replace(pick, time=time, time_factor=seconds)
    if raw.fault:
        raise RecordError(f"{guesses.path}: {raw.fault}")
    if raw.rate_hz is not None:
        return replace(pick, rate_hz=raw.rate_hz, start=raw.start)
    if untimed and not (rule.correction and rule.correction.of_time):
        return pick
    raise RecordError(
        f"{guesses.path}: channel {raw.name!r} has no times: no channel is called time or t, and the file gives "
        f"no sampling rate; say sample_rate_hz in {guesses.where}"
    )


def _said(guesses: Guesses, picks: Sequence[Pick]) -> Iterator[Finding]:
    """Yield what is told of the channels read and left out: how a unit or an axis was found; signals as long as those
    read; a displacement or velocity that only its unit shows, which may be that against a base that moves."""
    names, where = guesses.names, {"where": guesses.where}
    yield from (of.said for of in guesses.all.values() if of.said)
    for time in {pick.time for pick in picks if pick.time is not None}:
        if unit_of(guesses.channels[time]) is None and not guesses.mapping.time_unit:
            yield Finding("seconds", {"channel": names[time]} | where)
    sizes = {guesses.channels[pick.index].size for pick in picks}
    if unused := [
        f"{names[i]} ({of.reason})"
        for i, of in guesses.all.items()
        if not of.quantity and guesses.channels[i].size in sizes
    ]:
        yield Finding("not used", {"channels": first_of(unused)} | where)
    chosen = {pick.quantity: pick.index for pick in picks}
    moving = "force" not in chosen and any(q in EXCITATIONS for q in chosen)
    for quantity in ("displacement", "velocity"):
        i = chosen.get(quantity)
        if moving and i is not None and guesses.all[i].reason == BY_UNIT:
            of = {"channel": names[i], "quantity": quantity}
            yield Finding("against the ground", of | where)


def _unit(guesses: Guesses, raw: RawChannel, text: str | None, quantity: str) -> float:
    """Return SI units per unit of the channel."""
    channel = f"{guesses.path}: channel {shortened(raw.name)}"
    key = "time" if quantity == "time" else f"channels.{quantity}"
    si = next((u.name for u in UNITS if u.dimension == DIMENSIONS[quantity]), "s")
    stated = f"say unit: {si}, or as recorded, at {key} in {guesses.where}"
    if text is None:
        raise RecordError(f"{channel} has no unit: {stated}")
    try:
        return unit_for(text, quantity).factor
    except UnitError as error:
        raise RecordError(f"{channel}: {error}; if the file is wrong: {stated}") from None


def _channels(file: Table, picks: Sequence[Pick]) -> Iterator[Channel]:
    """Yield all samples of the picked channels, checked as `recognise` says."""
    columns = file.columns(_wanted(picks))
    sharing: dict[tuple[object, ...], Pick] = {}  # the first of those that share their times
    for pick in picks:
        first = sharing.setdefault((pick.time, pick.rate_hz, pick.start), pick)
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
        own = {i: columns[i] for i in _wanted([pick])}
        if pick.time is not None:
            own = _without_empty_end(own)
        beside = [columns[other.index] for other in picks if other.time == pick.time]
        yield _checked(file, pick, own, beside)


def _checked(
    file: Table, pick: Pick, columns: Mapping[int, Array], beside: Sequence[Array]
) -> Channel:
    """Return the channel of these columns, checked.   beside : the channels that share its times.

    Raises RecordError as `recognise`.
    """
    values = columns[pick.index]
    if values.size < 3:
        remedy = "that is no record"
        raise RecordError(f"{file.path}: channel {pick.name!r} has {values.size} samples; {remedy}")
    unit, this = pick.coordinate.unit(QUANTITIES[pick.quantity]), f"channel {pick.name!r}"
    signal = _in_si(file, pick.index, values, pick.factor, errors.LARGEST_VALUE, unit)
    present = np.flatnonzero(~np.isnan(values))
    _warn_of("no numbers", file, this, np.flatnonzero(np.isnan(values)))
    _require_no_overflow(file, pick, values, present)
    if pick.time is None:
        t = sample_times(pick.rate_hz or 1.0, pick.start, 0, values.size)
    else:
        time = f"time channel {file.channels[pick.time].name!r}"
        t = _in_si(file, pick.time, columns[pick.time], pick.time_factor, errors.LATEST, "s")
        _require_rate(t, f"{file.path}: {time}")
        rows, number = _numbered(t, [one[: t.size] for one in beside if one.size >= t.size])
        again = np.setdiff1d(np.flatnonzero(np.isfinite(t)), rows)
        _warn_of("rows twice", file, time, again)
        gaps, size = np.flatnonzero(np.diff(number) > 1), int(number[-1]) + 1
        _warn_of("rows missing", file, time, rows[gaps + 1], size - rows.size)
        if size != t.size or gaps.size:
            t, recorded = np.interp(np.arange(size), number, t[rows]), signal[rows]
            signal = np.full(size, np.nan)
            signal[number] = recorded
        t = _in_equal_steps(t, file.path, time)
    if pick.quantity in RESPONSES:  # a base may be at rest, a dead weight presses evenly
        _require_moving(f"{file.path}: {this}", pick, values[present], unit)
    missing = np.isnan(signal)
    try:
        of = pick.name, pick.correction, pick.coordinate
        timed = pick.time is not None or pick.rate_hz > 0.0
        if not missing.any():
            return Channel(pick.quantity, t, signal, *of, timed=timed)
        return Channel(pick.quantity, t, _filled(signal, missing), *of, missing, timed)
    except ValueError as error:
        raise RecordError(f"{file.path}: {error}") from None


def _require_moving(channel: str, pick: Pick, values: Array, unit: str) -> None:
    """Raise RecordError for a channel that is constant, exactly or except for rounding."""
    low, high = float(values.min()), float(values.max())
    span, constant = high - low, f"{low:g} in all {values.size} samples"
    if not span:
        raise RecordError(f"{channel} is constant, {constant}; check transducer and mapping")
    if (swing := span * abs(pick.factor)) < errors.SMALLEST_RANGE:
        raise RecordError(
            f"{channel} moves by {swing:.3g} {unit} in all, less than a transducer resolves; check its unit and scale"
        )
    if span < errors.FINEST * max(abs(low), abs(high)):
        remedy = "check transducer and mapping, or take off its offset"
        raise RecordError(f"{channel} is constant except for rounding, {constant}; {remedy}")


def _in_si(file: Table, index: int, values: Array, factor: float, bound: float, unit: str) -> Array:
    """Return the values in SI, finite and within the bound either way; a few may be missing, NaN."""
    with np.errstate(over="ignore", invalid="ignore"):  # a damaged file has signalling NaN, too
        signal = values * factor
    beyond, missing = np.abs(signal) > bound, np.isnan(values)
    bad = np.flatnonzero(beyond | missing if missing.mean() > _MOST_MISSING else beyond)
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


def _require_no_overflow(file: Table, pick: Pick, values: Array, present: Integers) -> None:
    """Raise RecordError for a jump through nearly the whole range of an integer type, from its one end to the other.

    present : numbers of the samples that are not missing.
    """
    values = values[present]
    jumps = np.abs(np.diff(values))
    i = int(np.argmax(jumps))
    bits = next((bits for bits in _BITS if np.ptp(values) < 2.0**bits), 0)
    if not bits or jumps[i] <= _WRAPPED * 2.0**bits or np.any(values != np.round(values)):
        return
    raise RecordError(
        f"{file.path}: {file.place(int(present[i + 1]))}: channel {pick.name!r} "
        f"goes from {values[i]:g} to {values[i + 1]:g}: an integer of {bits} bits ran over; record "
        "with a wider range"
    )


def _require_rate(t: Array, where: str) -> None:
    """Raise RecordError for times in steps that no recorder has.   where : file and channel."""
    step = float(np.median(np.diff(t)))
    if step > 0.0 and not errors.LOWEST_RATE <= 1.0 / step <= errors.HIGHEST_RATE:
        raise RecordError(
            f"{where} has steps of {step:g} s, which no recorder has; check its unit, or give sample_rate_hz"
        )


def _wanted(picks: Sequence[Pick]) -> list[int]:
    """Return the channels to read, signals and times."""
    return sorted({i for pick in picks for i in (pick.index, pick.time) if i is not None})


def _without_empty_end(columns: Mapping[int, Array]) -> dict[int, Array]:
    """Return the columns without the rows at the end that are empty in all, as a shorter time base leaves them."""
    present = np.flatnonzero(~np.all([np.isnan(column) for column in columns.values()], axis=0))
    end = int(present[-1]) + 1 if present.size else 0
    return {i: column[:end] for i, column in columns.items()}


def _numbered(t: Array, signals: Sequence[Array]) -> tuple[Integers, Integers]:
    """Return the rows that count and the numbers of their samples, which have gaps where samples are missing.

    Rows without a time do not count, nor those that are there twice, if these are all whose time does not move on. A
    recorder that loses rows leaves a whole number of steps. Times that were rounded, and a clock that jumps, may look
    like that as well: there the signals say which it is, as they go on smoothly where nothing is missing. All rows
    count where more than a few would not.

    t : s.   signals : that share these times.
    """
    rows, kept = np.arange(t.size), np.flatnonzero(np.isfinite(t))
    if kept.size < 3 or (kept.size == t.size and not uneven(t, GRID_TOLERANCE)[0]):
        return rows, rows
    stops = np.diff(t[kept], prepend=np.nan) == 0.0
    again = stops & np.all([one[kept] == np.roll(one[kept], 1) for one in signals], axis=0)
    if np.array_equal(again, stops):
        kept = kept[~again]
    if kept.size < 2:
        return rows, rows
    steps = np.diff(t[kept])
    usual = np.abs(steps - steps.mean()) < 0.5 * steps.mean()
    if not usual.any() or np.ptp(t[kept]) > 2.0 * t.size * steps[usual].mean():
        return rows, rows
    at = (t[kept] - t[kept[0]]) / steps[usual].mean()
    at = np.rint(np.polyval(np.polyfit(at, np.rint(at), 1), at))
    number = (at - at[0]).astype(np.intp)
    gaps = np.flatnonzero(np.diff(number) > 1)
    changed = int(number[-1]) + 1 - kept.size + t.size - kept.size
    if changed > _MOST_MISSING * t.size or np.diff(number).min() < 1:
        return rows, rows
    if gaps.size:
        evidence = math.fsum(_evidence(one[kept], number, gaps[:_GAPS]) for one in signals)
        rounded, long = _rounded(t[kept]) is not None, bool(np.diff(number).max() > _LONG)
        least = _CLEAR if rounded and gaps.size > 1 else -_CLEAR  # rounding seldom makes one step
        if (rounded or long) and evidence < least:
            return rows, rows
    return kept, number


def _evidence(signal: Array, number: Integers, gaps: Integers) -> float:
    """Return by how much the samples around gaps are likelier with them than without, as a log-likelihood ratio.

    number : of the samples, as the times have them.   gaps : indices of the samples after which some are missing.
    """
    total = 0.0
    for j in gaps.tolist():
        own = slice(max(0, j + 1 - _AROUND), j + 1 + _AROUND)
        values = signal[own] - signal[j]
        if np.abs(values).max() > 0.0 and values.size > _AROUND:  # NaN is not
            values = values / np.abs(values).max()
            ways = (np.arange(values.size), number[own] - number[j])
            with_gap, without = (np.polyfit(at, values, 2, full=True)[1].sum() for at in ways[::-1])
            total += 0.5 * values.size * math.log((without + _EXACT) / (with_gap + _EXACT))
    return total


def _filled(signal: Array, missing: Mask) -> Array:
    """Return a signal with values for the samples that are missing, which pictures and spectra need: those of a cubic
    spline through the others, at the ends the nearest."""
    from scipy.interpolate import CubicSpline  # slow to import

    at, present = np.arange(signal.size), np.flatnonzero(~missing)
    inside = np.clip(at[missing], present[0], present[-1])
    signal[missing] = CubicSpline(present, signal[present])(inside)
    return signal


def _warn_of(code: str, file: Table, channel: str, rows: Integers, count: int = 0) -> None:
    """Warn of rows that are left out of a channel, with their number and where they stand.

    code : of the finding.   count : number of the samples, where it is not that of the rows.
    """
    count = count or rows.size
    if count:
        places = [file.place(int(i)) for i in rows[:_PLACES]] + ["…"] * (rows.size > _PLACES)
        of = {"channel": channel, "count": count, "many": count > 1, "places": ", ".join(places)}
        warnings.warn(RecordWarning(file.path, Finding(code, of)), stacklevel=2)


def _in_equal_steps(t: Array, path: object, channel: str) -> Array:
    """Return the times of a channel: the line through them where they are rounded, with a warning that states its
    bound; any other times as they are.

    t : s.   path, channel : for the warning.
    """
    if (rounded := _rounded(t)) is None:
        return t
    line, q, step, bound = rounded
    of = {"where": channel, "resolution": q, "step": step, "rate": 1.0 / step, "bound": bound}
    said = Finding("rounded times", of, {"": bound})
    warnings.warn(RecordWarning(path, said), stacklevel=2)
    return line


def _rounded(t: Array) -> tuple[Array, float, float, float] | None:
    """Return t_i = t_0 + i Δt by least squares, the resolution q and Δt, s, and the bound on the relative error of Δt,
    for times in equal steps that are rounded to too few digits, as stamps in ms of 20,000 samples a second are; None
    for any others.

    They are if all are multiples of a decimal resolution q apart and none is further than that from the line. Rounding
    errors of up to q/2 put the slope off by 3q/2T at the most, T being the length of the record; they rarely conspire
    like that, and a hundredth of it is common.
    """
    steps = np.diff(t)
    if t.size < 3 or not steps.min() >= 0.0 or not t[-1] > t[0]:
        return None
    even = np.linspace(t[0], t[-1], t.size)
    if np.abs(t - even).max() <= GRID_TOLERANCE * (even[1] - even[0]):
        return None
    q = next((q for n in range(13) if _are_multiples(steps, q := 10.0**-n)), np.inf)
    i = np.arange(t.size) - 0.5 * (t.size - 1)
    middle = float(t.mean())
    step = float(i @ (t - middle)) / float(i @ i)
    line = np.asarray(middle + step * i)
    if not step > 0.0:  # underflow
        return None
    bound = 1.5 * q / (step * t.size)
    if np.ptp(t - line) > _LINE_TOLERANCE * q or bound > _MAX_RATE_ERROR:
        return None
    return line, q, step, bound


def _are_multiples(steps: Array, q: float) -> bool:
    """Return whether all steps are multiples of q, none but zero being lost."""
    multiples = np.round(steps / q)
    lost = (multiples == 0.0) & (steps > 0.0)
    return not lost.any() and bool(np.abs(steps / q - multiples).max() < _MULTIPLE_TOLERANCE)
