"""A mapping to start from, for a table that headings and units do not suffice for: what each channel may hold, and why.

Every refusal of a table says what is missing, and proposes that mapping.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..project.wording import shortened
from .channel import ABSOLUTE, EXCITATIONS, QUANTITIES, RESPONSES
from .errors import RecordError
from .headings import (
    WORDS,
    by_unit,
    coordinate_of,
    full_name,
    holds_time,
    names_time,
    quantity_of,
    unit_of,
    unusable,
    words_of,
)
from .mapping import RecordMapping
from .roles import LISTED, Roles, equal_step
from .table import Table
from .units import DIMENSIONS, find_motion, find_other, find_unit

# words that YAML takes for others
_YAML_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
_LONGEST = 60  # characters of a name; a channel with a longer one is called by its number
_IN_MM = 0.05  # half the range of a displacement: more is in mm, less in m
# least step in each unit, as nothing is sampled at less than 20 Hz
_TIME_UNITS = {"µs": 50.0, "ms": 0.05, "s": 0.0}
_BY_NAME, _BY_UNIT = "by its name", "by its unit"
_RESPONSE_OF = {"base_displacement": "displacement", "base_acceleration": "acceleration"}
_MOTIONS = {word for quantity in ABSOLUTE for word in WORDS[quantity]}
_KEPT = ("delimiter", "decimal", "header_lines", "sample_rate_hz", "frequency_hz", "level", "notes")
"""Keys of a mapping that stay in the one suggested."""


class Proposal:
    """A guess for every channel that there is room for, one excitation at the most.

    chosen : quantity → channel.   why : by channel, what the guess comes from, or why there is none.
    """

    def __init__(self, roles: Roles) -> None:
        self.channels, self.mapping, self.keys = roles.channels, roles.mapping, roles.keys
        self.samples, self.chosen = roles.samples, dict[str, int]()
        self.why = dict(self.samples.aside) | {i: why for i, why in roles.axes.items() if why}
        ways = (names_time, holds_time)
        self.is_time = next((way for way in ways if any(map(way, self.channels))), None)
        # names take precedence over units
        names = {i: roles.named(i) for i in range(len(self.channels)) if roles.may_move(i)}
        chosen, twice = roles.by_names
        for quantity, i in ({} if twice else chosen).items():
            unit = by_unit(self.channels[i])
            fits = unit and DIMENSIONS[unit] == DIMENSIONS[quantity]
            if i in names and names[i] != quantity and fits:
                names[i], self.why[i] = quantity, _BY_UNIT
        names |= self._first_drives(names)
        for i in sorted(names, key=lambda i: (names[i] is None, by_unit(self.channels[i]) is None)):
            self._take(i, names[i])
        for i, raw in enumerate(self.channels):  # at the last, what names say against their units
            quantity = quantity_of(raw) or quantity_of(raw, all_words=False) or ""
            other = find_other(raw.unit or "") and not unusable(replace(raw, unit=None))
            moves = {*words_of(raw.name)} & _MOTIONS and quantity in RESPONSES
            if moves and other and not self.complete:
                self.chosen[quantity], self.why[i] = i, _BY_NAME
        if len(self.chosen) == 1:
            ((quantity, i),) = self.chosen.items()
            if quantity in _RESPONSE_OF and names[i] is None:
                self.chosen, self.why[i] = {_RESPONSE_OF[quantity]: i}, "the only signal"

    @property
    def complete(self) -> bool:
        """Whether there is a response."""
        return any(q in RESPONSES for q in self.chosen)

    def lines(self) -> list[str]:
        """Return the mapping in YAML, each line with its reason, and the channels left out."""
        driving = [q for q in self.chosen if q in EXCITATIONS]
        lines = ["channels:" if driving else "channels:  # a free decay, without an excitation"]
        for quantity in (q for q in QUANTITIES if q in self.chosen):
            i = self.chosen[quantity]
            unit, scale, remark = self._in_unit(i, quantity)
            name = coordinate_of(self.channels[i]).key(quantity)
            entry = f"{name}: {{channel: {self._which(i)}, unit: {unit}{scale}}}"
            if quantity in ABSOLUTE and driving not in ([], ["force"]) and self.why[i] != _BY_NAME:
                remark = f"; relative_{name} if measured against the base{remark}"
            lines.append(f"  {entry}  # {self.why[i]}{remark}")
        for key in _KEPT:
            if (value := getattr(self.mapping, key)) not in (None, ""):
                lines.append(f"{key}: {json.dumps(value, ensure_ascii=False)}")
        lines += self._time()
        aside = [
            f"# left aside: {shortened(full_name(raw))}: {self.why[i]}"
            for i, raw in enumerate(self.channels)
            if i not in self.chosen.values() and not holds_time(raw) and not self._is_time(i)
        ]
        more = [f"# and {len(aside) - LISTED} more"] * (len(aside) > LISTED)
        return [*lines, *aside[:LISTED], *more]

    def _first_drives(self, names: Mapping[int, str | None]) -> dict[int, str]:
        """Make the first of several channels that names call alike, none the mass, the drive where no name says one."""
        first: dict[int, str] = {}
        if any(name in EXCITATIONS for name in names.values()):
            return first
        for driving, quantity in _RESPONSE_OF.items():
            alike = [i for i, name in names.items() if name == quantity]
            bare = [i for i in alike if not {*words_of(self.channels[i].name)} & {*WORDS["mass"]}]
            if len(alike) > 1 and bare:
                first[bare[0]] = driving
                self.why[bare[0]] = f"{_BY_NAME}; taken as the drive, as it comes first"
        return first

    def _take(self, i: int, named: str | None) -> None:
        """Choose a quantity for a channel, or say why there is none."""
        raw, of_unit = self.channels[i], by_unit(self.channels[i])
        driven = any(q in EXCITATIONS for q in self.chosen)
        if of_unit is None and raw.unit and not find_other(raw.unit):
            self.why[i] = f"its unit, {shortened(raw.unit)}, is no unit of motion or force"
            return
        fitting = ["base_displacement"] * (not driven) + ["displacement"] * (not self.complete)
        reason = "neither name nor unit says what it is"
        if of_unit is not None:
            reason, one = _BY_UNIT, DIMENSIONS[of_unit]
            fitting = [q for q in (*EXCITATIONS, *ABSOLUTE) if DIMENSIONS[q] == one]
        if named in EXCITATIONS:  # an excitation is no response
            fitting = []
        for quantity in filter(None, [named, *fitting]):
            taken = driven if quantity in EXCITATIONS else quantity in self.chosen
            if not taken:
                self.chosen[quantity] = i
                first = "; taken as the drive, as it comes first" * (quantity in EXCITATIONS)
                by_name = self.why.get(i, _BY_NAME)
                self.why[i] = by_name if quantity == named else reason + first
                return
        wanted = next(filter(None, [named, *fitting]), None)
        self.why[i] = f"another channel is taken for {wanted}" if wanted else reason

    def _in_unit(self, i: int, quantity: str) -> tuple[str, str, str]:
        """Return the unit, scale and remark of a channel in the mapping."""
        raw, unit, values = self.channels[i], QUANTITIES[quantity], self.samples.values[i]
        own = find_motion(raw.unit or "")
        if own and own.counterpart == DIMENSIONS[quantity]:
            return own.name, "", ""
        if raw.unit:
            unit = "mm" if unit == "m" else unit
            remark = f"; recorded in {raw.unit}: replace 1.0 by the {unit} per {raw.unit}"
            return unit, ", scale: 1.0", remark
        large = unit == "m" and values.size and 0.5 * np.ptp(values) > _IN_MM
        return "mm" if large else unit, "", "; unit guessed, the file has none"

    def _time(self) -> list[str]:
        """Return the line about times, if one is needed."""
        if self.mapping.sample_rate_hz is not None:
            return []
        times = [i for i in range(len(self.channels)) if self._is_time(i)]
        if not times:
            stated = any(raw.rate_hz for raw in self.channels)
            line = "sample_rate_hz: 1000  # the file has no times: replace by the rate"
            return [] if stated else [line]
        first, line = times[0], f"time: {{channel: {self._which(times[0])}, unit: "
        known = find_unit(self.mapping.time_unit or unit_of(self.channels[first]) or "")
        if known is not None and known.dimension == "time":
            return [f"{line}{known.name}}}"] if len(times) == 1 else []
        step = self.samples.rising.get(first) or equal_step(self.samples.values[first])
        unit = next(unit for unit, least in _TIME_UNITS.items() if (step or 0.0) >= least)
        shows = f"rises by {step:.6g} from sample to sample; " if step else ""
        return [f"{line}{unit}}}  # {shows}unit guessed, the file has none"]

    def _is_time(self, i: int) -> bool:
        """Return whether a channel is taken for the times: by the mapping, name or unit, or as the only one that
        rises."""
        if self.mapping.time is not None:
            return self.mapping.time in (i + 1, self.channels[i].name)
        if self.is_time is None:
            return i in self.samples.rising
        return self.is_time(self.channels[i])

    def _which(self, i: int) -> str:
        """Return a channel as a mapping names it: by its name, or by its number where that is long or not its alone."""
        name = self.channels[i].name
        if self.keys.count(self.keys[i]) > 1 or len(name) > _LONGEST:
            return str(i + 1)
        plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _YAML_WORDS
        return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())


def proposed(roles: Roles, what: str) -> str:
    """Say `what` to write, with a mapping that is complete, and holds for these channels if the guesses do."""
    proposal = Proposal(roles)
    if not proposal.complete:
        remedy = "give one that holds both, or name the file of each in"
        return f"A record has two signals at least: {remedy} {roles.where}"
    here = "" if roles.mapping.source else " (--write-mapping writes it)"
    return "\n  ".join([f"{what} in {roles.where}{here}, for example", *proposal.lines()])


def unclear(roles: Roles, what: str) -> RecordError:
    """Return the error for channels that cannot be distinguished: what is missing, and the mapping to write."""
    return RecordError(
        f"{roles.path}: {what}; it needs one of {', '.join(EXCITATIONS)}, unless it is a free decay (--kind "
        f"ring-down), and at least one of {', '.join(ABSOLUTE)} (relative_displacement, … if measured against the "
        f"base). Its channels are {roles.overview}. {proposed(roles, 'Say which is which')}"
    )


def suggested_mapping(file: Table, mapping: RecordMapping) -> str:
    """Return a mapping in YAML for a table whose mapping, so far, names no channels: each line with its reason. Raises
    RecordError where the mapping names channels already, or the table has no response."""
    roles = Roles(file, mapping)
    if mapping.channels:
        raise RecordError(f"{mapping.source} names the channels of {file.path} already")
    proposal = Proposal(roles)
    if not proposal.complete:
        raise unclear(roles, "finds no response")
    return "\n".join([*proposal.lines(), ""])
