"""Which channel of a file holds what: by its mapping, else by its heading, its unit and its samples.

Where headings do not suffice, a mapping to start from says what each channel may hold, and why.
"""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...project.wording import shortened
from ..coordinate import TRANSLATION, Coordinate
from ..errors import RecordError, RecordWarning
from ..mapping import ChannelRule, RecordMapping, Which
from ..measurement import (
    ABSOLUTE,
    EXCITATIONS,
    QUANTITIES,
    RESPONSES,
    Correction,
    require_one_coordinate,
)
from ..table import RawChannel, Table
from ..units import (
    DIMENSIONS,
    UNITS,
    VOLTAGE,
    UnitError,
    find_motion,
    find_other,
    find_unit,
    unit_for,
)
from .headings import (
    WORDS,
    by_unit,
    coordinate_of,
    full_name,
    holds_time,
    key_of,
    names_time,
    quantity_of,
    unit_of,
    unusable,
    words_of,
)
from .samples import Samples, equal_step

# words that YAML takes for others
_YAML_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
_LISTED = 20  # channels in a message
_LONGEST = 60  # characters of a name; a channel with a longer one is called by its number
_IN_MM = 0.05  # half the range of a displacement: more is in mm, less in m
# by the least step: nothing is sampled at less than 20 Hz
_TIME_UNITS = {"µs": 50.0, "ms": 0.05, "s": 0.0}
_BY_NAME, _BY_UNIT = "by its name", "by its unit"
_RESPONSE_OF = {"base_displacement": "displacement", "base_acceleration": "acceleration"}
_MOTIONS = {word for quantity in ABSOLUTE for word in WORDS[quantity]}
# words of the absolute value of three axes, and by what part of itself that is rounded
_OF_AXES = (
    "absolute",
    "abs",
    "absolut",
    "total",
    "magnitude",
    "norm",
    "resultant",
    "resultierende",
)
_ABSOLUTE = 1e-3
_KEPT = ("delimiter", "decimal", "header_lines", "sample_rate_hz", "frequency_hz", "level", "notes")
"""Keys of a mapping that stay in the one suggested."""


@dataclass(frozen=True, slots=True)
class Pick:
    """One quantity of the record: value in SI = factor · what channel `index` holds.

    time : index of its time channel, None for equal steps at `rate_hz` from `start` (s) on; time_factor : seconds per
    unit of that channel.   correction : that its harmonics need.
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


def picks_of(file: Table, mapping: RecordMapping, *, entire: bool = True) -> tuple[Pick, ...]:
    """What to read from a file, in the order of QUANTITIES.

    entire : whether it holds all of the record, a response and an excitation; none of these in a free decay, if no
    channel is left that could be one, the mapping names none, or it is known to be `free`.

    Raises RecordError naming the channel and the remedy: one that is not there, is there twice or has no unit or no
    time, a unit that does not fit; channels that cannot be distinguished, with the mapping to write.
    """
    plan = _Plan(file, mapping)
    rules: Mapping[str, ChannelRule] = mapping.channels
    if rules:
        chosen = {q: plan.find(rule.channel, f"channels.{q}.channel") for q, rule in rules.items()}
    else:
        chosen = plan.recognised()
        if mapping.free:
            # what may drive is read, where its unit says how, to see that it stands still
            moving = [q for q in EXCITATIONS if q in chosen and by_unit(plan.channels[chosen[q]])]
            chosen = {q: i for q, i in chosen.items() if q in (*RESPONSES, *moving[:1])}
        rules = {quantity: ChannelRule(channel=index + 1) for quantity, index in chosen.items()}
    driving, answering = ([q for q in of if q in chosen] for of in (EXCITATIONS, RESPONSES))
    if entire and len(driving) > 1:
        raise plan.unclear(f"finds {' and '.join(driving)}")
    # a channel without a name may drive: only where there is none left is it a free decay
    known = mapping.channels or mapping.free
    unnamed = answering and not known and plan.unnamed(chosen.values())
    if entire and not driving and (unnamed or not answering):
        raise plan.unclear("finds no excitation")
    if entire and not answering:
        raise plan.unclear("finds no response")
    picks = tuple(plan.pick(q, chosen[q], rules[q]) for q in QUANTITIES if q in chosen)
    if not mapping.channels:
        plan.require_one_coordinate([*chosen.values()])
        plan.warn_of_axes()
        plan.warn_of_unused(picks)
        plan.warn_of_guess(chosen)
    return picks


def suggested_mapping(file: Table, mapping: RecordMapping) -> str:
    """A mapping in YAML for a file whose mapping, so far, names no channels: each line with its reason. Raises
    RecordError where the mapping names channels already, or the file has no response."""
    plan = _Plan(file, mapping)
    if mapping.channels:
        raise RecordError(f"{mapping.source} names the channels of {file.path} already")
    suggestion = _Suggestion(plan)
    if not suggestion.complete:
        raise plan.unclear("finds no response")
    return "\n".join([*suggestion.lines(), ""])


class _Plan:
    """The channels of a file, as its mapping and their names tell them apart."""

    def __init__(self, file: Table, mapping: RecordMapping) -> None:
        self.file, self.path, self.channels, self.mapping = file, file.path, file.channels, mapping
        self.where = mapping.source or f"{file.path}.yaml"
        self.keys = [key_of(raw.name) for raw in self.channels]
        named = [f"{i} {shortened(full_name(raw))}" for i, raw in enumerate(self.channels, 1)]
        self.overview = _first_of(named) or "none"

    @cached_property
    def samples(self) -> Samples:
        """The first samples of the channels: needed where their names do not suffice."""
        return Samples(self.file)

    @cached_property
    def axes(self) -> dict[int, str]:
        """The channels of the one accelerometer of three axes, x, y and z, and their absolute value: why each is not
        read, or "" for the axis with the most motion, by its standard deviation. Nothing where there is none."""
        names = {
            (raw.name.lower(), raw.unit): i
            for i, raw in enumerate(self.channels)
            if by_unit(raw) == "acceleration"
        }
        threes = []
        for name, unit in names:
            for x in re.finditer("x", name):
                alike = [f"{name[: x.start()]}{axis}{name[x.end() :]}" for axis in "xyz"]
                three = [names[key, unit] for key in alike if (key, unit) in names]
                threes += [three] if len(three) == len("xyz") else []
        if len(threes) != 1 or any(not self.samples.values[i].size for i in threes[0]):
            return {}
        values = {i: self.samples.values[i] for i in threes[0]}
        moved = {i: float(np.nanstd(v)) for i, v in values.items()}
        most = max(moved, key=lambda i: moved[i])
        why = {i: f"it moves less than {shortened(self.channels[most].name)}" for i in moved}
        absolute = np.sqrt(np.sum(np.square([*values.values()]), axis=0))
        for i in names.values():
            other = self.samples.values[i]
            words = {*words_of(self.channels[i].name)}
            near = other.size and np.allclose(other, absolute, rtol=_ABSOLUTE, equal_nan=True)
            if i not in moved and (near or words & {*_OF_AXES}):
                why[i] = "the absolute value of three axes"
        return why | {most: ""}

    def pick(self, quantity: str, index: int, rule: ChannelRule) -> Pick:
        """The pick of a channel with the times that the mapping or the file gives it."""
        raw = self.channels[index]
        if raw.stamps:
            raise RecordError(
                f"{self.path}: channel {shortened(raw.name)} holds points in time, no {quantity}; give another"
            )
        coordinate = rule.coordinate if self.mapping.channels else coordinate_of(raw)
        factor = rule.sign * rule.scale * self.unit(raw, rule.unit, coordinate.key(quantity))
        pick = Pick(
            *(quantity, index, raw.name, factor), correction=rule.correction, coordinate=coordinate
        )
        if self.mapping.sample_rate_hz is not None:
            return replace(pick, rate_hz=self.mapping.sample_rate_hz)
        which, key = rule.time, f"channels.{quantity}.time"
        if which is None:
            which, key = self.mapping.time, "time.channel"
        time = self.time_of(index) if which is None else self.find(which, key)
        if time == index:
            raise RecordError(f"{self.path}: channel {raw.name!r} cannot be its own time")
        if time is not None:
            seconds = self.unit(self.channels[time], self.mapping.time_unit, "time")
            return replace(pick, time=time, time_factor=seconds)
        if raw.fault:
            raise RecordError(raw.fault)
        if raw.rate_hz is not None:
            return replace(pick, rate_hz=raw.rate_hz, start=raw.start)
        raise RecordError(
            f"{self.path}: channel {raw.name!r} has no times: no channel is called time or t, and the file gives "
            f"no sampling rate. {self.suggested('Say when it was sampled')}"
        )

    def recognised(self) -> dict[str, int]:
        """Quantity → channel as `told_apart`. Raises RecordError where two are taken for the same quantity."""
        chosen, twice = self.told_apart
        if twice:
            raise self.unclear(twice)
        return chosen

    @cached_property
    def told_apart(self) -> tuple[dict[str, int], str]:
        """Quantity → channel, by the names; of a single signal by its unit, if that is one of a response. And which
        two are taken for the same quantity, if any.

        A force is no response: where nothing that drives is named, the only other signal drives if it is in a unit of
        force. Where something drives and no response is named, the only signal left with a motion, by name or unit, is
        the response.
        """
        chosen: dict[str, int] = {}
        for i, raw in enumerate(self.channels):
            quantity = None if holds_time(raw) or unusable(raw) else quantity_of(raw)
            if i in self.axes:
                quantity = None if self.axes[i] else "acceleration"
            if quantity in chosen:
                self.require_one_coordinate([chosen[quantity], i])
                both = [shortened(self.channels[at].name) for at in (chosen[quantity], i)]
                return chosen, f"takes both {' and '.join(both)} for {quantity}"
            if quantity:
                chosen[quantity] = i
        answering, driving = ({*chosen} & {*of} for of in (RESPONSES, EXCITATIONS))
        if answering and driving:
            return chosen, ""
        left = [i for i in self.unused(chosen.values()) if self.may_move(i)]
        kinds = {coordinate_of(self.channels[i]) for i in chosen.values()}
        alike = [i for i in left if not kinds or coordinate_of(self.channels[i]) in kinds]
        if left and not alike:
            self.require_one_coordinate([*chosen.values(), *left])
        left = alike
        forces = [i for i in left if by_unit(self.channels[i]) == "force"]
        if not driving and len(forces) == 1 and len(left) == 2 - bool(answering):
            chosen["force"] = forces[0]
        if not chosen and len(left) == 1 and (q := by_unit(self.channels[left[0]])) in ABSOLUTE:
            return {str(q): left[0]}, ""  # of a free decay
        others = {i: self.named(i) or by_unit(self.channels[i]) for i in left if i not in forces}
        answers = {q: i for i, q in others.items() if q in RESPONSES}
        single = len([q for q in others.values() if q in answers]) == 1 and not answering
        nothing_else = {*others.values()} <= {*answers, None}
        if single and (self.mapping.free or (chosen and nothing_else)):
            chosen |= answers
        return chosen, ""

    def require_one_coordinate(self, channels: Collection[int]) -> None:
        """Raise RecordError where some channels rotate and others move along a line."""
        coordinates = {self.channels[i].name: coordinate_of(self.channels[i]) for i in channels}
        try:
            require_one_coordinate(str(self.path), coordinates)
        except ValueError as error:
            raise RecordError(str(error)) from None

    def named(self, i: int) -> str | None:
        """The quantity that a heading names, also in other words, if its unit is not of another one."""
        raw, unit = self.channels[i], by_unit(self.channels[i])
        if i in self.axes:
            return "acceleration"
        quantity = quantity_of(raw) or quantity_of(raw, all_words=False)
        fits = quantity and (unit is None or DIMENSIONS[unit] == DIMENSIONS[quantity])
        return quantity if fits else None

    def time_of(self, index: int) -> int | None:
        """The time channel of another: the one named after it, else the nearest before it, else the first."""
        key = self.keys[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(self.keys) if name in own]
        is_time = names_time if any(map(names_time, self.channels)) else holds_time
        times = [i for i, raw in enumerate(self.channels) if is_time(raw)]
        before = [i for i in times if i < index]
        return next(iter(named or before[-1:] or times), None)

    def warn_of_axes(self) -> None:
        """Warn of the axis that was taken of three."""
        if axis := [i for i, why in self.axes.items() if not why]:
            name = shortened(full_name(self.channels[axis[0]]))
            said = (
                f"{name} is taken for the acceleration of the mass, the axis with the most motion"
            )
            remedy = f"name another in {self.where} if the mass moves along it"
            warnings.warn(RecordWarning(f"{self.path}: {said}; {remedy}"), stacklevel=2)

    def warn_of_unused(self, picks: Sequence[Pick]) -> None:
        """Warn of signals as long as those read that no name distinguished. A mapping that names channels leaves the
        others out on purpose."""
        sizes = {self.channels[pick.index].size for pick in picks}
        used = {i for pick in picks for i in (pick.index, pick.time)}
        if names := [
            shortened(full_name(raw)) + f" ({unusable(raw)})" * (unusable(raw) is not None)
            for i, raw in enumerate(self.channels)
            if i not in used and i not in self.axes and raw.size in sizes and not holds_time(raw)
        ]:
            said = f"{_first_of(names)}; say in {self.where} what they hold, if it is needed"
            unused = RecordWarning(f"{self.path}: channels not used: {said}")
            warnings.warn(unused, stacklevel=2)

    def warn_of_guess(self, chosen: Mapping[str, int]) -> None:
        """Warn of a displacement or velocity that only its unit tells: it may be that against a base that moves."""
        moving = "force" not in chosen and any(q in EXCITATIONS for q in chosen)
        for quantity in ("displacement", "velocity"):
            if moving and quantity in chosen and self.named(chosen[quantity]) is None:
                name = shortened(full_name(self.channels[chosen[quantity]]))
                said = f"{name} is taken for the {quantity} of the mass against the ground, as nothing else is left"
                remedy = (
                    f"say relative_{quantity} in {self.where} if it is measured against the base"
                )
                warnings.warn(RecordWarning(f"{self.path}: {said}; {remedy}"), stacklevel=2)

    def unused(self, used: Collection[int | None]) -> list[int]:
        """The channels that are not used."""
        return [i for i in range(len(self.channels)) if i not in used]

    def unnamed(self, used: Collection[int | None]) -> bool:
        """Whether there are signals that are not used."""
        return any(map(self.may_move, self.unused(used)))

    def may_move(self, i: int) -> bool:
        """Whether a channel may hold a motion or a force: no time, no temperature, no counter, nothing constant."""
        if holds_time(self.channels[i]):
            return False
        return i not in self.samples.aside and not self.axes.get(i)

    def find(self, which: Which, key: str) -> int:
        """The channel of that name or number."""
        said, path, channels = f"{self.mapping.source}: {key}:", self.path, self.channels
        if isinstance(which, int):
            if 1 <= which <= len(channels):
                return which - 1
            remedy = f"{path} has {len(channels)}: {self.overview}"
            raise RecordError(f"{said} there is no channel {which}; {remedy}")
        names = [(raw.name, full_name(raw), raw.label or raw.name) for raw in channels]
        for spelt in (str, key_of):  # as it stands, else without regard to case, blanks and path
            matches = [i for i, own in enumerate(names) if spelt(which) in map(spelt, own)]
            if len(matches) == 1:
                return matches[0]
            if matches:
                numbers = " and ".join(str(i + 1) for i in matches[:_LISTED])
                raise RecordError(
                    f"{said} {path} has {len(matches)} channels {shortened(which)}, numbers {numbers}; give one"
                )
        remedy = f"it has {self.overview}"
        raise RecordError(f"{said} {path} has no channel {shortened(which)}; {remedy}")

    def unit(self, raw: RawChannel, given: str | None, quantity: str) -> float:
        """SI units per unit of the channel."""
        text = given or unit_of(raw)
        channel = f"{self.path}: channel {shortened(raw.name)}"
        key = "time" if quantity == "time" else f"channels.{quantity}"
        si = next((u.name for u in UNITS if u.dimension == DIMENSIONS[quantity]), "s")
        stated = f": say unit: {si}, or as recorded, at {key} in {self.where}"
        if text is None:
            shown = stated if self.mapping.channels else f". {self.suggested('Give it')}"
            raise RecordError(f"{channel} has no unit{shown}")
        if find_other(text) == VOLTAGE and not self.mapping.channels:
            raise RecordError(f"{channel} is in {text}. {self.suggested('Give its scale')}")
        try:
            return unit_for(text, quantity).factor
        except UnitError as error:
            remedy = "" if given else f"; if the file is wrong{stated}"
            if not (self.mapping.channels or given) and _Suggestion(self).complete:
                remedy = f". {self.suggested('Say what it is')}"
            raise RecordError(f"{channel}: {error}{remedy}") from None

    def unclear(self, what: str) -> RecordError:
        """The error for channels that cannot be distinguished, with what to write."""
        return RecordError(
            f"{self.path}: {what}; it needs one of {', '.join(EXCITATIONS)}, unless it is a free decay (--kind "
            f"ring-down), and at least one of {', '.join(ABSOLUTE)} (relative_displacement, … if measured against the "
            f"base). Its channels are {self.overview}. {self.suggested('Say which is which')}"
        )

    def suggested(self, what: str) -> str:
        """A mapping to write that is complete, and holds for these channels if the guesses do."""
        suggestion = _Suggestion(self)
        if not suggestion.complete:
            remedy = "give one that holds both, or name the file of each in"
            return f"A record has two signals at least: {remedy} {self.where}"
        here = "" if self.mapping.source else " (--write-mapping writes it)"
        return "\n  ".join([f"{what} in {self.where}{here}, for example", *suggestion.lines()])


def _first_of(names: Sequence[str]) -> str:
    """Names in a row, the first 20 of them."""
    more = len(names) - _LISTED
    return ", ".join(names[:_LISTED]) + f" and {more} more" * (more > 0)


class _Suggestion:
    """A guess for every channel that there is room for, one excitation at the most.

    chosen : quantity → channel.   why : by channel, what the guess comes from, or why there is none.
    """

    def __init__(self, plan: _Plan) -> None:
        self.channels, self.mapping, self.keys = plan.channels, plan.mapping, plan.keys
        self.samples, self.chosen = plan.samples, dict[str, int]()
        self.why = dict(self.samples.aside) | {i: why for i, why in plan.axes.items() if why}
        ways = (names_time, holds_time)
        self.is_time = next((way for way in ways if any(map(way, self.channels))), None)
        # what names say goes first, then units
        names = {i: plan.named(i) for i in range(len(self.channels)) if plan.may_move(i)}
        chosen, twice = plan.told_apart
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
        """The mapping in YAML, each line with its reason, and what is left aside."""
        driving = [q for q in self.chosen if q in EXCITATIONS]
        lines = ["channels:" if driving else "channels:  # none that drives: those of a free decay"]
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
        more = [f"# and {len(aside) - _LISTED} more"] * (len(aside) > _LISTED)
        return [*lines, *aside[:_LISTED], *more]

    def _first_drives(self, names: Mapping[int, str | None]) -> dict[int, str]:
        """The first of several channels that names call alike, none the mass, is the base's where no name drives."""
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
            self.why[i] = f"its unit, {shortened(raw.unit)}, is that of no motion and no force"
            return
        fitting = ["base_displacement"] * (not driven) + ["displacement"] * (not self.complete)
        reason = "neither name nor unit says what it is"
        if of_unit is not None:
            reason, one = _BY_UNIT, DIMENSIONS[of_unit]
            fitting = [q for q in (*EXCITATIONS, *ABSOLUTE) if DIMENSIONS[q] == one]
        if named in EXCITATIONS:  # what drives is no response
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
        """Unit, scale and remark of a channel in the mapping."""
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
        """The line about times, if one is needed."""
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
        """Whether a channel is taken for the times: by the mapping, name or unit, or as the only one that rises."""
        if self.mapping.time is not None:
            return self.mapping.time in (i + 1, self.channels[i].name)
        if self.is_time is None:
            return i in self.samples.rising
        return self.is_time(self.channels[i])

    def _which(self, i: int) -> str:
        """A channel as a mapping names it: by its name, or by its number where that is long or not its alone."""
        name = self.channels[i].name
        if self.keys.count(self.keys[i]) > 1 or len(name) > _LONGEST:
            return str(i + 1)
        plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _YAML_WORDS
        return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())
