"""A mapping to start from: what each channel of a file may hold, and why, by its heading, its unit and its samples."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...arrays import Array
from ...project.wording import shortened
from ..errors import RecordError, RecordWarning
from ..mapping import RecordMapping
from ..measurement import ABSOLUTE, EXCITATIONS, QUANTITIES, RESPONSES
from ..units import DIMENSIONS, find_other, find_unit
from .headings import holds_time, key_of, quantity_of, unit_of, unusable
from .record_file import RawChannel, RecordFile

# words that YAML takes for others
_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
LISTED = 20
"""Channels that a message lists at the most."""

_LONGEST = 60  # characters of a name; a channel with a longer one is called by its number
_NUMBERS = 4_000_000  # that are looked at
_FEWEST = 4  # samples of which it shows that they rise in equal steps
_ROUNDED = 0.6  # of a step, by which times with too few digits are off
_IN_MM = 0.05  # half the range of a displacement: more is in mm, less in m
# by the least step: nothing is sampled at less than 20 Hz
_TIME_UNITS = {"µs": 50.0, "ms": 0.05, "s": 0.0}
_BY_NAME = "by its name"
_RESPONSE_OF = {"base_displacement": "displacement", "base_acceleration": "acceleration"}
_LAYOUT = (
    *("delimiter", "decimal", "header_lines"),
    *("sample_rate_hz", "frequency_hz", "level", "notes"),
)  # fmt: skip
"""Keys of a mapping that are kept."""


def full_name(raw: RawChannel) -> str:
    """Name and unit of a channel."""
    return f"{raw.name} [{raw.unit}]" if raw.unit else raw.name


def first_of(names: Sequence[str]) -> str:
    """Names in a row, the first 20 of them."""
    more = len(names) - LISTED
    return ", ".join(names[:LISTED]) + f" and {more} more" * (more > 0)


@dataclass(frozen=True, eq=False)
class Samples:
    """The first samples of each channel, or none of one that cannot be read.

    aside : channels that are no motion and no force, by name, unit or samples, with what they are instead.
    rising : steps of those that rise in equal steps and are no counters.
    """

    values: Sequence[Array]
    aside: Mapping[int, str]
    rising: Mapping[int, float]


def look_at(file: RecordFile) -> Samples:
    """The first samples of the channels of a file, and what they show."""
    channels = file.channels
    if not channels:
        return Samples([], {}, {})
    everything, none = range(len(channels)), np.empty(0)
    values = _first(file, everything)
    aside, rising = {}, {}
    if values is None:  # a text in some column
        alone = [_first(file, [i]) for i in everything[:LISTED]]
        aside = {i: "it holds what is no number" for i, one in enumerate(alone) if one is None}
        values = [none if one is None else one[0] for one in alone]
        values += [none] * (len(channels) - len(values))
    for i, raw in enumerate(channels):
        if (other := unusable(raw)) is not None:
            aside[i] = other
            continue
        known = values[i][np.isfinite(values[i])]
        if holds_time(raw) or known.size < _FEWEST:
            continue
        if not np.ptp(known):
            aside[i] = f"constant, {known[0]:g}"
        elif (step := _equal_step(known)) is not None:
            counts = step == 1.0 and not np.any(known % 1.0)
            aside[i] = f"rises by {step:.6g} from sample to sample: " + (
                "a counter" if counts else "a time"
            )
            if not counts:
                rising[i] = step
    return Samples(values, aside, rising)


def _first(file: RecordFile, wanted: Sequence[int]) -> list[Array] | None:
    """The first samples of some channels; None where they cannot be read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # comes where the record is read
        try:
            blocks = file.blocks(wanted, max(_NUMBERS // len(file.channels), _FEWEST))
            return next(iter(blocks), [np.empty(0)] * len(wanted))
        except RecordError:
            return None


def _equal_step(values: Array) -> float | None:
    """The step of values that rise in equal steps, as times and counters do; None for others."""
    if values.size < _FEWEST:
        return None
    line = np.linspace(values[0], values[-1], values.size)
    step = float(line[1] - line[0])
    rises = step > 0.0 and np.diff(values).min() >= 0.0
    return step if rises and np.abs(values - line).max() < _ROUNDED * step else None


@dataclass(eq=False)
class Suggestion:
    """A guess for every channel that there is room for, one excitation at the most.

    mapping : what is known already.   chosen : quantity → channel.   why : by channel, what the guess comes from, or
    why there is none.
    """

    channels: Sequence[RawChannel]
    samples: Samples
    mapping: RecordMapping
    chosen: dict[str, int] = field(default_factory=dict)
    why: dict[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.why |= self.samples.aside
        signals = [
            i for i, raw in enumerate(self.channels) if not (i in self.why or holds_time(raw))
        ]
        # what names say goes first, then units
        names = {i: self._named(i) for i in signals}
        for i in sorted(signals, key=lambda i: (names[i] is None, self._unit(i) is None)):
            self._take(i, names[i])
        driving = [q for q in self.chosen if q in EXCITATIONS]
        if driving and len(self.chosen) == 1 and names[self.chosen[driving[0]]] is None:
            (quantity, i), *_ = self.chosen.items()
            if quantity in _RESPONSE_OF:
                self.chosen = {_RESPONSE_OF[quantity]: i}
                self.why[i] = "the only signal"

    @property
    def complete(self) -> bool:
        """Whether there is a response."""
        return any(q in RESPONSES for q in self.chosen)

    def lines(self) -> list[str]:
        """The mapping in YAML, each line with its reason, and what is left aside."""
        driving = [q for q in self.chosen if q in EXCITATIONS]
        lines = ["channels:" if driving else "channels:  # none that drives: those of a free decay"]
        for quantity in (q for q in QUANTITIES if q in self.chosen):
            i = self.chosen[quantity]
            unit, scale, remark = self._in_unit(i, quantity)
            entry = f"{quantity}: {{channel: {self._which(i)}, unit: {unit}{scale}}}"
            if quantity in ABSOLUTE and driving not in ([], ["force"]) and self.why[i] != _BY_NAME:
                remark = f"; relative_{quantity} if measured against the base{remark}"
            lines.append(f"  {entry}  # {self.why[i]}{remark}")
        for key in _LAYOUT:
            if (value := getattr(self.mapping, key)) not in (None, ""):
                lines.append(f"{key}: {json.dumps(value, ensure_ascii=False)}")
        lines += self._time()
        aside = [
            f"# left aside: {shortened(full_name(raw))}: {self.why[i]}"
            for i, raw in enumerate(self.channels)
            if i not in self.chosen.values() and not self._is_time(i)
        ]
        more = [f"# and {len(aside) - LISTED} more"] if len(aside) > LISTED else []
        return [*lines, *aside[:LISTED], *more]

    def _named(self, i: int) -> str | None:
        """The quantity that a heading names, if its unit is not of another one."""
        raw, unit = self.channels[i], self._unit(i)
        quantity = quantity_of(raw) or quantity_of(raw, all_words=False)
        fits = quantity and (unit is None or DIMENSIONS[unit] == DIMENSIONS[quantity])
        return quantity if fits else None

    def _unit(self, i: int) -> str | None:
        """A quantity that has the unit of a channel; None where it has none, or that of nothing here."""
        unit = find_unit(self.channels[i].unit or "")
        return next((q for q in QUANTITIES if unit and DIMENSIONS[q] == unit.dimension), None)

    def _take(self, i: int, named: str | None) -> None:
        """Choose a quantity for a channel, or say why there is none."""
        raw, of_unit = self.channels[i], self._unit(i)
        driven = any(q in EXCITATIONS for q in self.chosen)
        if of_unit is None and raw.unit and not find_other(raw.unit):
            self.why[i] = f"its unit, {shortened(raw.unit)}, is that of no motion and no force"
            return
        if of_unit is None:
            fitting = ["base_displacement"] * (not driven) + ["displacement"] * (not self.complete)
            reason = "neither name nor unit says what it is"
        else:
            dimension = DIMENSIONS[of_unit]
            fitting = [q for q in (*EXCITATIONS, *ABSOLUTE) if DIMENSIONS[q] == dimension]
            reason = "by its unit"
        for quantity in filter(None, [named, *fitting]):
            taken = driven if quantity in EXCITATIONS else quantity in self.chosen
            if not taken:
                self.chosen[quantity] = i
                self.why[i] = _BY_NAME if quantity == named else reason
                if quantity != named and quantity in EXCITATIONS:
                    self.why[i] += "; taken as the drive, as it comes first"
                return
        wanted = next(filter(None, [named, *fitting]), None)
        self.why[i] = f"another channel is taken for {wanted}" if wanted else reason

    def _in_unit(self, i: int, quantity: str) -> tuple[str, str, str]:
        """Unit, scale and remark of a channel in the mapping."""
        raw, unit, values = self.channels[i], QUANTITIES[quantity], self.samples.values[i]
        own = find_unit(raw.unit or "")
        if own and own.dimension == DIMENSIONS[quantity]:
            return own.name, "", ""
        if raw.unit:
            unit = "mm" if unit == "m" else unit
            remark = f"; recorded in {raw.unit}: replace 1.0 by the {unit} per {raw.unit}"
            return unit, ", scale: 1.0", remark
        if unit == "m" and values.size and 0.5 * np.ptp(values) > _IN_MM:
            unit = "mm"
        return unit, "", "; unit guessed, the file has none"

    def _time(self) -> list[str]:
        """The line about times, if one is needed."""
        if self.mapping.sample_rate_hz is not None:
            return []
        times = [i for i in range(len(self.channels)) if self._is_time(i)]
        if not times:
            if any(raw.rate_hz for raw in self.channels):
                return []
            return ["sample_rate_hz: 1000  # the file has no times: replace by the rate"]
        first = times[0]
        known = find_unit(self.mapping.time_unit or unit_of(self.channels[first]) or "")
        if known is not None and known.dimension == "time":
            alone = len(times) == 1
            return [f"time: {{channel: {self._which(first)}, unit: {known.name}}}"] if alone else []
        values = self.samples.values[first]
        step = self.samples.rising.get(first) or _equal_step(values)
        unit = next(unit for unit, least in _TIME_UNITS.items() if (step or 0.0) >= least)
        shows = f"rises by {step:.6g} from sample to sample; " if step else ""
        line = f"time: {{channel: {self._which(first)}, unit: {unit}}}"
        return [f"{line}  # {shows}unit guessed, the file has none"]

    def _is_time(self, i: int) -> bool:
        """Whether a channel is taken for the times: by the mapping, name or unit, or as the only one that rises."""
        if self.mapping.time is not None:
            return self.mapping.time in (i + 1, self.channels[i].name)
        if any(map(holds_time, self.channels)):
            return holds_time(self.channels[i])
        return i in self.samples.rising

    def _which(self, i: int) -> str:
        """A channel as a mapping names it: by its name, or by its number where that is long or not its alone."""
        name = self.channels[i].name
        keys = [key_of(raw.name) for raw in self.channels]
        if keys.count(keys[i]) > 1 or len(name) > _LONGEST:
            return str(i + 1)
        plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _WORDS
        return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())
