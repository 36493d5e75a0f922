"""Which channel of a file holds what: from its mapping, or from the names and units in it."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from ...project.wording import shortened
from ..correction import Correction
from ..errors import RecordError, RecordWarning
from ..mapping import ChannelRule, RecordMapping, Which
from ..measurement import EXCITATIONS, QUANTITIES, RESPONSES
from ..units import DIMENSIONS, UnitError, find_unit, unit_for
from .record_file import RawChannel, RecordFile

NAMES = {
    "base_displacement": ("base_displacement", "base", "ground", "ground_displacement", "y"),
    "base_acceleration": ("base_acceleration", "base_acc", "ground_acceleration"),
    "force": ("force", "excitation_force"),
    "displacement": ("displacement", "disp", "x"),
    "velocity": ("velocity", "vel", "v"),
    "acceleration": ("acceleration", "acc", "accel"),
}
"""Names by which a channel is recognised without a mapping, in lower case; blanks and hyphens count as "_"."""

_WORDS = (
    "y",
    "n",
    "yes",
    "no",
    "on",
    "off",
    "true",
    "false",
    "null",
)  # which YAML takes for others
_LISTED = 20  # channels, in a message
_QUANTITIES = {name: quantity for quantity, names in NAMES.items() for name in names}
_TIME = re.compile(r"(time|zeit|t|time_?stamps?|date_?time)(_?\d+)?")
_DRIVING = {"displacement": "base_displacement", "acceleration": "base_acceleration"}


@dataclass(frozen=True, slots=True)
class Pick:
    """One quantity of the record: value in SI = factor · what channel `index` holds.

    time : index of its time channel, None for equal steps at `rate_hz` from `start` (s) on; time_factor : seconds per
    unit of that channel.   correction : that its harmonics need.
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


def picks_of(file: RecordFile, mapping: RecordMapping, *, entire: bool = True) -> tuple[Pick, ...]:
    """What to read from a file, in the order of QUANTITIES.

    entire : whether it holds all of the record, a response and an excitation; none of these in a free decay, if no
    channel is left that could be one, or the mapping names none.

    Raises RecordError naming the channel and the remedy: one that is not there, is there twice or has no unit or no
    time, a unit that does not fit; channels that cannot be told apart, with the mapping to write.
    """
    plan = _Plan(file, mapping)
    rules: Mapping[str, ChannelRule] = mapping.channels
    if rules:
        chosen = {q: plan.find(rule.channel, f"channels.{q}.channel") for q, rule in rules.items()}
    else:
        chosen = plan.recognised()
        rules = {quantity: ChannelRule(channel=index + 1) for quantity, index in chosen.items()}
    driving = [q for q in EXCITATIONS if q in chosen]
    if entire and len(driving) > 1:
        raise plan.unclear(f"finds {' and '.join(driving)}")
    answered = any(q in chosen for q in RESPONSES)
    # a channel without a name may drive: only where there is none left is it a free decay
    lacking = not mapping.channels and plan.unnamed(chosen.values())
    if entire and not driving and (lacking or not answered):
        raise plan.unclear("finds no excitation")
    if entire and not answered:
        raise plan.unclear("finds no response")
    picks = tuple(plan.pick(q, chosen[q], rules[q]) for q in QUANTITIES if q in chosen)
    if not mapping.channels:
        plan.tell_unused(picks)
    return picks


class _Plan:
    """The channels of a file, as its mapping and their names tell them apart."""

    def __init__(self, file: RecordFile, mapping: RecordMapping) -> None:
        self.path, self.channels, self.mapping = file.path, file.channels, mapping
        self.where = mapping.source or f"{file.path}.yaml"
        listed = file.channels[:_LISTED]
        named = [f"{i} {shortened(_full(raw))}" for i, raw in enumerate(listed, start=1)]
        more = len(file.channels) - len(listed)
        self.overview = (", ".join(named) or "none") + (f" and {more} more" if more else "")

    def pick(self, quantity: str, index: int, rule: ChannelRule) -> Pick:
        """The pick of a channel with the times that the mapping or the file gives it."""
        raw = self.channels[index]
        if raw.stamps:
            raise RecordError(
                f"{self.path}: channel {shortened(raw.name)} holds points in time, no {quantity}; give another"
            )
        factor = rule.sign * rule.scale * self.unit(raw, rule.unit, quantity)
        pick = Pick(quantity, index, raw.name, factor, correction=rule.correction)
        if self.mapping.sample_rate_hz is not None:
            return replace(pick, rate_hz=self.mapping.sample_rate_hz)
        if rule.time is not None:
            time = self.find(rule.time, f"channels.{quantity}.time")
        elif self.mapping.time is not None:
            time = self.find(self.mapping.time, "time.channel")
        elif (nearest := self.time_of(index)) is not None:
            time = nearest
        elif raw.rate_hz is not None:
            return replace(pick, rate_hz=raw.rate_hz, start=raw.start)
        else:
            raise RecordError(
                f"{self.path}: channel {raw.name!r} has no times: no channel is called time or t, and the file gives "
                f"no sampling rate; write time: {{channel: 1, unit: s}}, or sample_rate_hz: 1000, as recorded, into "
                f"{self.where}"
            )
        if time == index:
            raise RecordError(f"{self.path}: channel {raw.name!r} cannot be its own time")
        seconds = self.unit(self.channels[time], self.mapping.time_unit, "time")
        return replace(pick, time=time, time_factor=seconds)

    def recognised(self) -> dict[str, int]:
        """Quantity → channel, by the names."""
        chosen: dict[str, int] = {}
        for i, raw in enumerate(self.channels):
            quantity = _QUANTITIES.get(_key(raw.name))
            if quantity in chosen:
                first = self.channels[chosen[quantity]].name
                raise self.unclear(
                    f"takes both {shortened(first)} and {shortened(raw.name)} for {quantity}"
                )
            if quantity:
                chosen[quantity] = i
        return chosen

    def time_of(self, index: int) -> int | None:
        """The time channel of another: the one named after it, else the nearest before it, else the first."""
        names = [_key(raw.name) for raw in self.channels]
        key = names[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(names) if name in own]
        times = [i for i, raw in enumerate(self.channels) if _named_time(raw)]
        before = [i for i in times if i < index]
        return next(iter(named or before[-1:] or times), None)

    def tell_unused(self, picks: Sequence[Pick]) -> None:
        """Warn of signals as long as those read that no name told apart.

        A mapping that names channels leaves the others out on purpose.
        """
        used = [i for pick in picks for i in (pick.index, pick.time) if i is not None]
        names = self.unnamed(used, {self.channels[pick.index].size for pick in picks})
        if names:
            more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
            warnings.warn(
                f"{self.path}: channels not used: {', '.join(names[:_LISTED])}{more}; say in {self.where} what they "
                "hold, if it is needed",
                RecordWarning,
                stacklevel=2,
            )

    def unnamed(
        self, used: Iterable[int], sizes: Collection[int | None] | None = None
    ) -> list[str]:
        """The signals that are not used, of one of some sizes if these are given."""
        known = set(used)
        return [
            shortened(_full(raw))
            for i, raw in enumerate(self.channels)
            if i not in known and (sizes is None or raw.size in sizes) and not _tells_time(raw)
        ]

    def find(self, which: Which, key: str) -> int:
        """The channel of that name or number."""
        said, path, channels = f"{self.mapping.source}: {key}:", self.path, self.channels
        if isinstance(which, int):
            if 1 <= which <= len(channels):
                return which - 1
            raise RecordError(
                f"{said} there is no channel {which}; {path} has {len(channels)}: {self.overview}"
            )
        for spelt in (str, _key):  # as it stands, else without regard to case, blanks and path
            matches = [
                i
                for i, raw in enumerate(channels)
                if spelt(which) in map(spelt, (raw.name, _full(raw), raw.label or raw.name))
            ]
            if len(matches) == 1:
                return matches[0]
            if matches:
                numbers = " and ".join(str(i + 1) for i in matches[:_LISTED])
                raise RecordError(
                    f"{said} {path} has {len(matches)} channels {shortened(which)}, numbers {numbers}; give one"
                )
        raise RecordError(
            f"{said} {path} has no channel {shortened(which)}; it has {self.overview}"
        )

    def unit(self, raw: RawChannel, given: str | None, quantity: str) -> float:
        """SI units per unit of the channel."""
        text = given or raw.unit
        channel = f"{self.path}: channel {shortened(raw.name)}"
        if text is None:
            raise RecordError(f"{channel} has no unit. {self.suggested('Give it')}")
        try:
            return unit_for(text, quantity).factor
        except UnitError as error:
            raise RecordError(f"{channel}: {error}") from None

    def unclear(self, what: str) -> RecordError:
        """The error for channels that cannot be told apart, with what to write."""
        return RecordError(
            f"{self.path}: {what}; it needs one of {', '.join(EXCITATIONS)}, unless it is a free decay, and at least"
            f" one of {', '.join(RESPONSES)}. Its channels are {self.overview}. {self.suggested('Say which is which')}"
        )

    def suggested(self, what: str) -> str:
        """What to write into the mapping: one that is complete, and holds for these channels if the guesses do."""
        guesses = suggestion(self.channels)
        if len(guesses) < 2:
            return (
                "A record has two signals at least: give one that holds both, or name the file of each in "
                f"{self.where}"
            )
        lines = [f"{what} in {self.where}, for example", "  channels:"]
        for quantity, index in guesses.items():
            own = find_unit(self.channels[index].unit or "")
            fits = own is not None and own.dimension == DIMENSIONS[quantity]
            unit = own.name if own and fits else QUANTITIES[quantity]
            entry = f"    {quantity}: {{channel: {self.which(index)}, unit: {unit}}}"
            lines.append(entry if fits else f"{entry}  # or as recorded")
        times = [i for i, raw in enumerate(self.channels) if _tells_time(raw)]
        first = times[0] if times else None
        if first is None and not any(raw.rate_hz for raw in self.channels):
            lines.append("  sample_rate_hz: 1000  # as recorded")
        elif first is not None and not find_unit(self.channels[first].unit or ""):
            lines.append(f"  time: {{channel: {self.which(first)}, unit: s}}  # or ms, µs")
        elif first is not None and not _named_time(self.channels[first]):
            lines.append(f"  time: {{channel: {self.which(first)}}}")
        return "\n".join(lines)

    def which(self, index: int) -> str:
        """A channel as a mapping names it: by its name, or by its number where that is long or not its alone."""
        name = self.channels[index].name
        alone = [_key(raw.name) for raw in self.channels].count(_key(name)) == 1
        return _yaml(name) if alone and len(name) <= 60 else str(index + 1)


def suggestion(channels: Sequence[RawChannel]) -> dict[str, int]:
    """Quantity → channel, a guess for every signal that there is room for: by names, then units, then their order.

    One of EXCITATIONS and at least one of RESPONSES, if there are two signals at all.
    """
    signals = [i for i, raw in enumerate(channels) if not _tells_time(raw)]
    by_name = {i: _QUANTITIES.get(_key(channels[i].name)) for i in signals}
    units = {i: find_unit(channels[i].unit or "") for i in signals}
    dimensions = {i: unit.dimension for i, unit in units.items() if unit}
    # those whose name says what they are go first; a channel whose unit is of nothing here fits nowhere
    order = sorted(signals, key=lambda i: by_name[i] is None)
    chosen: dict[str, int] = {}
    for i in order:
        driven = any(q in chosen for q in EXCITATIONS)
        fitting = [q for q in QUANTITIES if dimensions.get(i) in (None, DIMENSIONS[q])]
        wanted = [by_name[i], *fitting]
        room = (q for q in wanted if q and q not in chosen and not (driven and q in EXCITATIONS))
        if (quantity := next(room, None)) is not None:
            chosen[quantity] = i
    if chosen and not any(q in chosen for q in EXCITATIONS):  # one of the responses must drive
        for response, excitation in _DRIVING.items():
            if response in chosen:
                chosen[excitation] = chosen.pop(response)
                break
    return {q: chosen[q] for q in QUANTITIES if q in chosen}


def _named_time(raw: RawChannel) -> bool:
    return raw.stamps or _TIME.fullmatch(_key(raw.name)) is not None


def _tells_time(raw: RawChannel) -> bool:
    """Whether a channel holds times, by its name or unit."""
    unit = find_unit(raw.unit or "")
    return _named_time(raw) or (unit is not None and unit.dimension == "time")


def _full(raw: RawChannel) -> str:
    return f"{raw.name} [{raw.unit}]" if raw.unit else raw.name


def _yaml(name: str) -> str:
    """The name as YAML takes it."""
    plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name)
    return (
        name
        if plain and name.lower() not in _WORDS
        else json.dumps(name, ensure_ascii=not name.isprintable())
    )


def _key(name: str) -> str:
    """The last part of a path, in lower case, with "_" for what separates words."""
    return re.sub(r"[\s\-]+", "_", re.split(r"[/.](?=[^/.])", name.strip())[-1].strip().lower())
