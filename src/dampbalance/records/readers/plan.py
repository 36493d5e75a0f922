"""Which channel of a file holds what: from its mapping, or from the names and units in it."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from ...project.wording import shortened
from ..errors import RecordError, RecordWarning
from ..mapping import ChannelRule, RecordMapping, Which
from ..measurement import EXCITATIONS, QUANTITIES, RESPONSES, Correction
from ..units import DIMENSIONS, Unit, UnitError, find_unit, unit_for
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

# words that YAML takes for others
_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
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
    driving, answering = ([q for q in of if q in chosen] for of in (EXCITATIONS, RESPONSES))
    if entire and len(driving) > 1:
        raise plan.unclear(f"finds {' and '.join(driving)}")
    # a channel without a name may drive: only where there is none left is it a free decay
    lacking = not mapping.channels and plan.unnamed(chosen.values())
    if entire and not driving and (lacking or not answering):
        raise plan.unclear("finds no excitation")
    if entire and not answering:
        raise plan.unclear("finds no response")
    picks = tuple(plan.pick(q, chosen[q], rules[q]) for q in QUANTITIES if q in chosen)
    if not mapping.channels:
        plan.warn_of_unused(picks)
    return picks


class _Plan:
    """The channels of a file, as its mapping and their names tell them apart."""

    def __init__(self, file: RecordFile, mapping: RecordMapping) -> None:
        self.path, self.channels, self.mapping = file.path, file.channels, mapping
        self.where = mapping.source or f"{file.path}.yaml"
        self.keys = [_key(raw.name) for raw in self.channels]
        named = [f"{i} {shortened(_full(raw))}" for i, raw in enumerate(self.channels, start=1)]
        self.overview = _first_of(named) or "none"

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
        which, key = rule.time, f"channels.{quantity}.time"
        if which is None:
            which, key = self.mapping.time, "time.channel"
        time = self.time_of(index) if which is None else self.find(which, key)
        if time == index:
            raise RecordError(f"{self.path}: channel {raw.name!r} cannot be its own time")
        if time is not None:
            seconds = self.unit(self.channels[time], self.mapping.time_unit, "time")
            return replace(pick, time=time, time_factor=seconds)
        if raw.rate_hz is not None:
            return replace(pick, rate_hz=raw.rate_hz, start=raw.start)
        raise RecordError(
            f"{self.path}: channel {raw.name!r} has no times: no channel is called time or t, and the file gives "
            f"no sampling rate; write time: {{channel: 1, unit: s}}, or sample_rate_hz: 1000, as recorded, into "
            f"{self.where}"
        )

    def recognised(self) -> dict[str, int]:
        """Quantity → channel, by the names; of a single signal by its unit, if that is one of a response."""
        chosen: dict[str, int] = {}
        for i, key in enumerate(self.keys):
            quantity = _QUANTITIES.get(key)
            if quantity in chosen:
                both = [shortened(self.channels[at].name) for at in (chosen[quantity], i)]
                raise self.unclear(f"takes both {' and '.join(both)} for {quantity}")
            if quantity:
                chosen[quantity] = i
        signals = [i for i, raw in enumerate(self.channels) if not _holds_time(raw)]
        if not chosen and len(signals) == 1 and (unit := _unit(self.channels[signals[0]])):
            chosen = {q: signals[0] for q in RESPONSES if DIMENSIONS[q] == unit.dimension}
        return chosen

    def time_of(self, index: int) -> int | None:
        """The time channel of another: the one named after it, else the nearest before it, else the first."""
        key = self.keys[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(self.keys) if name in own]
        times = [i for i, raw in enumerate(self.channels) if _named_time(raw)]
        before = [i for i in times if i < index]
        return next(iter(named or before[-1:] or times), None)

    def warn_of_unused(self, picks: Sequence[Pick]) -> None:
        """Warn of signals as long as those read that no name told apart.

        A mapping that names channels leaves the others out on purpose.
        """
        sizes = {self.channels[pick.index].size for pick in picks}
        used = {i for pick in picks for i in (pick.index, pick.time)}
        used |= {i for i, raw in enumerate(self.channels) if raw.size not in sizes}
        if names := self.unnamed(used):
            warnings.warn(
                f"{self.path}: channels not used: {_first_of(names)}; say in {self.where} what they "
                "hold, if it is needed",
                RecordWarning,
                stacklevel=2,
            )

    def unnamed(self, used: Collection[int | None]) -> list[str]:
        """The signals that are not used."""
        others = [raw for i, raw in enumerate(self.channels) if i not in used]
        return [shortened(_full(raw)) for raw in others if not _holds_time(raw)]

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
        """A mapping to write that is complete, and holds for these channels if the guesses do."""
        guesses = suggestion(self.channels)
        if len(guesses) < 2:
            return (
                "A record has two signals at least: give one that holds both, or name the file of each in "
                f"{self.where}"
            )
        lines = [f"{what} in {self.where}, for example", "  channels:"]
        for quantity, index in guesses.items():
            unit, comment, own = (
                QUANTITIES[quantity],
                "  # or as recorded",
                _unit(self.channels[index]),
            )
            if own and own.dimension == DIMENSIONS[quantity]:
                unit, comment = own.name, ""
            entry = f"{quantity}: {{channel: {self.which(index)}, unit: {unit}}}"
            lines.append(f"    {entry}{comment}")
        first = next((i for i, raw in enumerate(self.channels) if _holds_time(raw)), None)
        if first is None:
            if not any(raw.rate_hz for raw in self.channels):
                lines.append("  sample_rate_hz: 1000  # as recorded")
        elif not _unit(self.channels[first]):
            lines.append(f"  time: {{channel: {self.which(first)}, unit: s}}  # or ms, µs")
        elif not _named_time(self.channels[first]):
            lines.append(f"  time: {{channel: {self.which(first)}}}")
        return "\n".join(lines)

    def which(self, index: int) -> str:
        """A channel as a mapping names it: by its name, or by its number where that is long or not its alone."""
        name = self.channels[index].name
        if self.keys.count(self.keys[index]) > 1 or len(name) > 60:
            return str(index + 1)
        plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _WORDS
        return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())


def suggestion(channels: Sequence[RawChannel]) -> dict[str, int]:
    """Quantity → channel, a guess for every signal that there is room for: by names, then units, then their order.

    One of EXCITATIONS and at least one of RESPONSES, if there are two signals at all.
    """
    signals = [i for i, raw in enumerate(channels) if not _holds_time(raw)]
    by_name = {i: _QUANTITIES.get(_key(channels[i].name)) for i in signals}
    chosen: dict[str, int] = {}
    # those whose name says what they are go first; a channel whose unit is of nothing here fits nowhere
    for i in sorted(signals, key=lambda i: by_name[i] is None):
        driven, unit = any(q in chosen for q in EXCITATIONS), _unit(channels[i])
        fitting = [q for q in QUANTITIES if unit is None or unit.dimension == DIMENSIONS[q]]
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


def _holds_time(raw: RawChannel) -> bool:
    """Whether a channel holds times, by its name or unit."""
    unit = _unit(raw)
    return _named_time(raw) or (unit is not None and unit.dimension == "time")


def _unit(raw: RawChannel) -> Unit | None:
    return find_unit(raw.unit or "")


def _full(raw: RawChannel) -> str:
    return f"{raw.name} [{raw.unit}]" if raw.unit else raw.name


def _first_of(names: Sequence[str]) -> str:
    more = len(names) - _LISTED
    return ", ".join(names[:_LISTED]) + f" and {more} more" * (more > 0)


def _key(name: str) -> str:
    """The last part of a path, in lower case, with "_" for what separates words."""
    return re.sub(r"[\s\-]+", "_", re.split(r"[/.](?=[^/.])", name.strip())[-1].strip().lower())
