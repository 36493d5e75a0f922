"""Which channel of a file holds what: from its mapping, or from the names and units in it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ...project.wording import shortened
from ..correction import Correction
from ..errors import RecordError
from ..mapping import ChannelRule, RecordMapping, Which
from ..measurement import EXCITATIONS, QUANTITIES, RESPONSES
from ..units import UnitError, find_unit, unit_for
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

_LISTED = 20  # channels, in a message
_QUANTITIES = {name: quantity for quantity, names in NAMES.items() for name in names}
_TIME = re.compile(r"(time|zeit|t)(_?\d+)?")


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


def picks_of(file: RecordFile, mapping: RecordMapping) -> tuple[Pick, ...]:
    """What to read from a file, in the order of QUANTITIES.

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
    if len(driving) != 1:
        raise plan.unclear(f"finds {' and '.join(driving) or 'no excitation'}")
    if not any(q in chosen for q in RESPONSES):
        raise plan.unclear("finds no response")
    return tuple(plan.pick(q, chosen[q], rules[q]) for q in QUANTITIES if q in chosen)


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
                f"no sampling rate; write sample_rate_hz, or time, into {self.where}"
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
        times = [i for i, name in enumerate(names) if _TIME.fullmatch(name)]
        before = [i for i in times if i < index]
        return next(iter(named or before[-1:] or times), None)

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
            timed = quantity == "time"
            key = "time: {channel: …, unit: …}" if timed else f"channels.{quantity}.unit"
            raise RecordError(f"{channel} has no unit; write {key} into {self.where}")
        try:
            return unit_for(text, quantity).factor
        except UnitError as error:
            raise RecordError(f"{channel}: {error}") from None

    def which(self, raw: RawChannel) -> str:
        """A channel as a mapping names it: by its name, or by its number where that is long."""
        return _yaml(raw.name) if len(raw.name) <= 60 else str(self.channels.index(raw) + 1)

    def unclear(self, what: str) -> RecordError:
        """The error for channels that cannot be told apart, with what to write."""
        signals = [raw for raw in self.channels if not _TIME.fullmatch(_key(raw.name))]
        examples = zip(
            ("base_displacement", "displacement"), [*signals, *self.channels], strict=False
        )
        lines = [
            f"{self.path}: {what}; it needs one of {', '.join(EXCITATIONS)} and at least one of {', '.join(RESPONSES)}."
            f" Its channels are {self.overview}. Say which is which in {self.where}, for example",
            "  channels:",
            *(
                f"    {q}: {{channel: {self.which(c)}, unit: {_known(c.unit)}}}"
                for q, c in examples
            ),
        ]
        if len(signals) == len(self.channels) and not any(raw.rate_hz for raw in signals):
            lines.append("  sample_rate_hz: …")
        return RecordError("\n".join(lines))


def _full(raw: RawChannel) -> str:
    return f"{raw.name} [{raw.unit}]" if raw.unit else raw.name


def _known(unit: str | None) -> str:
    return unit if unit and find_unit(unit) else "…"


def _yaml(name: str) -> str:
    """The name as YAML takes it."""
    plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name)
    return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())


def _key(name: str) -> str:
    """The last part of a path, in lower case, with "_" for what separates words."""
    return re.sub(r"[\s\-]+", "_", re.split(r"[/.](?=[^/.])", name.strip())[-1].strip().lower())
