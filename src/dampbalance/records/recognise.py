"""The channels of a record in SI units from an open table: the one place where a record is checked.

Mapping, headings, units and samples say which channel holds what. Each channel needs a unit, times, and samples that
are finite, within bounds, in equal steps, not constant and free of integer overflow. Times with too few digits are put
in equal steps. Single samples that are missing or not a number are left out of the fit, and repeated rows are dropped,
with a warning that says how many and where. A table that cannot be used is refused with a message that names what is
missing, and the mapping to write if that is the remedy.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Integers
from ..findings.finding import Finding
from ..project.spelling import spelled
from ..project.wording import listed, shortened
from . import errors
from .channel import EXCITATIONS, QUANTITIES, RESPONSES, Channel, is_loop, sample_times
from .clock import Clock, clock_of, left_out
from .draft import question, unclear
from .errors import RecordError, RecordWarning
from .guess import BY_UNIT, Guesses, first_of
from .headings import unit_of
from .mapping import ChannelRule, RecordMapping
from .record import Record
from .table import Table
from .units import DIMENSIONS, SI, VOLTAGE, UnitError, find_other, unit_for


@dataclass(frozen=True, slots=True)
class Pick:
    """The channel to read for a quantity: value in SI = factor · reading of channel `index`.

    rule : of the mapping or the guesses.   time : index of its time channel; None for equal steps at `rate_hz` from
    `start` (s) on, or without times if the rate is 0.   time_factor : seconds per unit of the time channel.
    steady : whether its rows are steady states instead of samples of a signal.
    """

    quantity: str
    index: int
    name: str
    factor: float
    rule: ChannelRule
    time: int | None = None
    time_factor: float = 1.0
    rate_hz: float = 0.0
    start: float = 0.0
    steady: bool = False


def recognise(table: Table, mapping: RecordMapping, *others: tuple[Table, RecordMapping]) -> Record:
    """Return the record in an open table, in SI units.

    mapping : what the table does not say.   others : more tables that hold channels of the record, with their parts of
    the mapping.

    Raises RecordError for a record that cannot be used, naming what is wrong, where, and the remedy: channels that
    cannot be distinguished (see `picks_of`), infinite or absurd values, many missing ones, times that do not increase
    or have a long gap or unequal steps, a constant response, integer overflow, channels of unequal lengths. Warns
    (RecordWarning) of what looks odd and of what is left out.
    """
    order, channels = list(QUANTITIES), list[Channel]()
    for file, of in ((table, mapping), *others):
        channels += _channels(file, picks_of(file, of))
    channels.sort(key=lambda channel: order.index(channel.quantity))
    return Record.of(str(table.path), channels)


def picks_of(file: Table, mapping: RecordMapping) -> tuple[Pick, ...]:
    """Return what to read from a file, in the order of QUANTITIES.

    Raises RecordError naming the channel and the remedy: one that is missing, is there twice or lacks a unit or times,
    a unit that does not fit; for channels that cannot be distinguished, with the mapping to write.
    """
    guesses = Guesses(file, mapping)
    rules: Mapping[str, ChannelRule] = mapping.channels
    if not rules:
        if open_question := question(guesses):
            raise unclear(guesses, open_question)
        rules = guesses.rules
    found = {q: guesses.find(of.channel, f"channels.{q}.channel")[0] for q, of in rules.items()}
    untimed = is_loop(found) and not mapping.free, guesses.are_steady_speeds(found)
    picks = tuple(_pick(guesses, q, found[q], rules[q], *untimed) for q in QUANTITIES if q in found)
    for said in () if mapping.channels else _said(guesses, picks):
        warnings.warn(RecordWarning(guesses.path, said), stacklevel=2)
    return picks


def _pick(
    guesses: Guesses, quantity: str, index: int, rule: ChannelRule, untimed: bool, steady: bool
) -> Pick:
    """Return the pick of a channel, with the times that the mapping or the file gives it.

    untimed : whether it needs no times, as in a measured loop.   steady : whether it is of a table of steady speeds.
    """
    raw = guesses.channels[index]
    if raw.stamps:
        raise RecordError(
            f"{guesses.path}: channel {shortened(raw.name)} holds points in time, no {quantity}; give another"
        )
    scale = raw.scale if rule.scale is None else rule.scale
    # if the file has volts or a scale, a unit alone does not tell the scale
    unscaled = find_other(raw.unit or "") == VOLTAGE or raw.scale != 1.0
    if math.isnan(scale) or (rule.unit and rule.scale is None and unscaled):
        what = f"what is the scale of {guesses.names[index]}?"
        raise _asked(guesses, what, f"Say it at channels.{quantity}")
    factor = rule.sign * scale
    factor *= _unit(guesses, index, rule.unit or unit_of(raw), rule.coordinate.key(quantity))
    pick = Pick(quantity, index, raw.name, factor, rule, steady=steady)
    if steady:
        return pick
    if guesses.mapping.sample_rate_hz is not None:
        return replace(pick, rate_hz=guesses.mapping.sample_rate_hz)
    own, key = rule.time, f"channels.{quantity}.time"
    time = guesses.time_of(index) if own is None else guesses.find(own, key)[0]
    if time == index:
        raise RecordError(f"{guesses.path}: channel {raw.name!r} cannot be its own time")
    if time is not None:
        seconds = _unit(guesses, time, guesses.unit_of_time(time), "time")
        return replace(pick, time=time, time_factor=seconds)
    if raw.fault:
        raise RecordError(f"{guesses.path}: {raw.fault}")
    if raw.rate_hz is not None:
        return replace(pick, rate_hz=raw.rate_hz, start=raw.start)
    if untimed and not (rule.correction and rule.correction.of_time):
        return pick
    rate = (
        "at which rate was it sampled? No channel is called time or t, and the file gives no rate."
    )
    if {*guesses.rules} >= {"force", "velocity"}:
        rate += f" If each row is a steady speed, give {spelled('kind', 'friction-speed')}."
    raise _asked(guesses, rate, f"Channel {shortened(raw.name)} needs it: say sample_rate_hz")


def _said(guesses: Guesses, picks: Sequence[Pick]) -> Iterator[Finding]:
    """Yield findings on the channels: how a unit or an axis was found, which channels are left out, and a displacement
    or velocity known only by its unit, which may be relative to a moving base."""
    names, raws, own = guesses.names, guesses.channels, [pick.index for pick in picks]
    yield from (of.said for of in guesses.all.values() if of.said)
    clocks = {pick.time: pick.index for pick in picks if pick.time is not None}
    for clock, i in clocks.items():
        if unit_of(raws[clock]) is None and not guesses.mapping.time_unit:
            yield Finding("seconds", {"channel": names[clock], "rate": 1.0 / guesses.step(i)})
    told = [(i, raws[i]) for i in own if raws[i].described]
    taken = [f"{shortened(raw.label or f'column {i + 1}')} is {raw.described}" for i, raw in told]
    if axes := [names[i] for i in own if guesses.all[i].axis]:
        taken.append(f"{listed(axes)}, the ax{'es' if axes[1:] else 'is'} with the most motion")
    if (line := raws[own[0]].rate_line) and picks[0].rate_hz == raws[own[0]].rate_hz:
        taken.append(f"{picks[0].rate_hz:,g} samples a second ({line})")
    if taken:
        yield Finding("taken", {"what": shortened("; ".join(taken), 600)[1:-1]})
    sizes, unused = {raws[i].size for i in own}, dict[str, list[str]]()
    for i, of in guesses.all.items():
        if not (of.quantity or of.axis or i in guesses.empty) and raws[i].size in sizes:
            unused.setdefault(of.reason, []).append(names[i])
    if unused:
        channels = [f"{first_of(of)} ({why})" for why, of in unused.items()]
        yield Finding("not used", {"channels": ", ".join(channels)})
    chosen = {pick.quantity: pick.index for pick in picks}
    moving = "force" not in chosen and any(q in EXCITATIONS for q in chosen)
    for quantity in ("displacement", "velocity"):
        at = chosen.get(quantity)
        if moving and at is not None and guesses.all[at].reason == BY_UNIT:
            yield Finding("against the ground", {"channel": names[at], "quantity": quantity})


def _unit(guesses: Guesses, i: int, text: str | None, quantity: str) -> float:
    """Return SI units per unit of a column."""
    what, say = f"in which unit is {guesses.names[i]}?", "Say"
    try:
        if text:
            return unit_for(text, quantity).factor
    except UnitError as error:
        what = f"channel {shortened(guesses.channels[i].name)}: {error}."
        if find_other(text or "") == VOLTAGE:
            what = f"what is the scale of {guesses.names[i]}, which is in {text}?"
        say = "If the file is wrong, say"
    key = "time" if quantity == "time" else f"channels.{quantity}"
    raise _asked(guesses, what, f"{say} unit: {SI[DIMENSIONS[quantity]]}, or as recorded, at {key}")


def _asked(guesses: Guesses, what: str, remedy: str) -> RecordError:
    """Return the error for a channel that needs an answer, with the mapping to write, or the change to the existing
    one."""
    if guesses.mapping.channels:
        return RecordError(f"{guesses.path}: {what} {remedy} in {guesses.where}")
    return unclear(guesses, what)


def _channels(file: Table, picks: Sequence[Pick]) -> Iterator[Channel]:
    """Yield all samples of the picked channels, checked as `recognise` says."""
    columns = file.columns(
        sorted({i for of in picks for i in (of.index, of.time) if i is not None})
    )
    for time, rate, start in dict.fromkeys((of.time, of.rate_hz, of.start) for of in picks):
        own = [of for of in picks if (of.time, of.rate_hz, of.start) == (time, rate, start)]
        named = {of.index: f"channel {of.name!r}" for of in own}
        if time is not None:
            named[time] = f"its time {file.channels[time].name!r}"
        sizes = {columns[i].size for i in named}
        if len(sizes) > 1:
            each = ", ".join(f"{name} has {columns[i].size}" for i, name in named.items())
            raise RecordError(f"{file.path}: channels and times of unequal lengths: {each} samples")
        size = sizes.pop()
        if time is not None:  # a shorter time base leaves rows at the end that are empty
            filled = np.flatnonzero(~np.all([np.isnan(columns[i]) for i in named], axis=0))
            size = int(filled[-1]) + 1 if filled.size else 0
        if size < 3:
            what = f"channel {own[0].name!r} has {size} samples; that is no record"
            raise RecordError(f"{file.path}: {what}")
        signals = {of.index: columns[of.index][:size] for of in own}
        if time is None:
            clock = Clock.plain(sample_times(rate or 1.0, start, 0, size))
        else:
            name = f"time channel {file.channels[time].name!r}"
            t = _in_si(file, time, columns[time][:size], own[0].time_factor, errors.LATEST, "s")
            try:
                clock = clock_of(t, [*signals.values()], name, file.place)
            except RecordError as error:
                raise RecordError(f"{file.path}: {error}") from None
            for odd in clock.findings:
                warnings.warn(RecordWarning(file.path, odd), stacklevel=2)
        for pick in own:
            yield _checked(file, pick, signals[pick.index], clock)


def _checked(file: Table, pick: Pick, values: Array, clock: Clock) -> Channel:
    """Return the checked channel. Raises RecordError as `recognise`."""
    unit, this = pick.rule.coordinate.unit(QUANTITIES[pick.quantity]), f"channel {pick.name!r}"
    signal = _in_si(file, pick.index, values, pick.factor, errors.LARGEST_VALUE, unit)
    empty, present = (np.flatnonzero(np.isnan(values) == lacks) for lacks in (True, False))
    for odd in left_out("no numbers", this, empty, file.place):
        warnings.warn(RecordWarning(file.path, odd), stacklevel=2)
    if not pick.steady:
        _require_no_overflow(file, pick, values, present)
    if pick.quantity in RESPONSES:  # a base may be at rest, a dead weight presses evenly
        _require_moving(f"{file.path}: {this}", pick, values[present], unit)
    try:
        samples, missing = clock.onto(signal)
        of = pick.name, pick.rule.correction, pick.rule.coordinate
        timed = pick.time is not None or pick.rate_hz > 0.0
        return Channel(pick.quantity, clock.t, samples, *of, missing, timed, pick.factor)
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
    """Return values in SI, after checking that they are finite and below the bound; a few may be missing (NaN)."""
    with np.errstate(over="ignore", invalid="ignore"):  # a damaged file has signalling NaN, too
        signal = values * factor
    beyond, missing = np.abs(signal) > bound, np.isnan(values)
    # a record that lacks more than 3 % of its samples is not usable
    bad = np.flatnonzero(beyond | missing if missing.mean() > 0.03 else beyond)
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
    """Raise RecordError for a jump through nearly the whole range of an integer type.

    present : indices of the samples that are not missing.
    """
    values = values[present]
    jumps = np.abs(np.diff(values))
    i = int(np.argmax(jumps))
    # bits of integers in converters and files
    bits = next((bits for bits in (8, 16, 24, 32, 64) if np.ptp(values) < 2.0**bits), 0)
    # no oscillation passes through so much of its range from one sample to the next
    if not bits or jumps[i] <= 0.9 * 2.0**bits or np.any(values != np.round(values)):
        return
    raise RecordError(
        f"{file.path}: {file.place(int(present[i + 1]))}: channel {pick.name!r} "
        f"goes from {values[i]:g} to {values[i + 1]:g}: an integer of {bits} bits ran over; record "
        "with a wider range"
    )
