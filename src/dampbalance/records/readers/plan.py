"""Which channel of a file holds what: from its mapping, or from the names and units in it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import RecordError
from ..mapping import ChannelRule, RecordMapping, Which
from ..measurement import EXCITATIONS, QUANTITIES, RESPONSES
from ..units import UnitError, unit_for
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

_TIME = re.compile(r"(time|zeit|t)(_?\d+)?")


@dataclass(frozen=True, slots=True)
class Pick:
    """One quantity of the record: value in SI = factor · what channel `index` holds.

    time : index of its time channel, None for equal steps at `rate_hz` from `start` (s) on; time_factor : seconds per
    unit of that channel.
    """

    quantity: str
    index: int
    name: str
    factor: float
    time: int | None
    time_factor: float = 1.0
    rate_hz: float = 0.0
    start: float = 0.0


def picks_of(file: RecordFile, mapping: RecordMapping) -> tuple[Pick, ...]:
    """What to read from a file, in the order of QUANTITIES.

    Raises RecordError naming the channel and the remedy: one that is not there, is there twice or has no unit or no
    time, a unit that does not fit; channels that cannot be told apart, with the mapping to write.
    """
    path, channels = file.path, file.channels
    if mapping.channels:
        rules = dict(mapping.channels)
        chosen = {
            quantity: _find(path, channels, rule.channel, mapping, f"channels.{quantity}.channel")
            for quantity, rule in rules.items()
        }
    else:
        chosen = _recognised(path, channels)
        rules = {quantity: ChannelRule(channel=index + 1) for quantity, index in chosen.items()}
    driving = [q for q in EXCITATIONS if q in chosen]
    if len(driving) != 1 or not any(q in chosen for q in RESPONSES):
        what = (
            f"finds {' and '.join(driving) if driving else 'no excitation'}"
            if len(driving) != 1
            else "finds no response"
        )
        raise RecordError(_ask(path, channels, what, mapping))
    picks = []
    for quantity in (q for q in QUANTITIES if q in chosen):
        index, rule = chosen[quantity], rules[quantity]
        raw = channels[index]
        factor = rule.sign * rule.scale * _unit(path, raw, rule.unit, quantity, mapping)
        picks.append(_timed(path, channels, quantity, index, factor, rule, mapping))
    return tuple(picks)


def _timed(
    path: Path,
    channels: Sequence[RawChannel],
    quantity: str,
    index: int,
    factor: float,
    rule: ChannelRule,
    mapping: RecordMapping,
) -> Pick:
    """The pick of a channel with the times that the mapping or the file gives it."""
    raw = channels[index]
    if mapping.sample_rate_hz is not None:
        return Pick(quantity, index, raw.name, factor, None, rate_hz=mapping.sample_rate_hz)
    if rule.time is not None:
        time = _find(path, channels, rule.time, mapping, f"channels.{quantity}.time")
    elif mapping.time is not None:
        time = _find(path, channels, mapping.time, mapping, "time.channel")
    else:
        nearest = _time_of(channels, index)
        if nearest is None:
            if raw.rate_hz is None:
                raise RecordError(
                    f"{path}: channel {raw.name!r} has no times: no channel is called time or t, and the file gives no "
                    f"sampling rate; write sample_rate_hz, or time, into {_where(path, mapping)}"
                )
            return Pick(
                quantity, index, raw.name, factor, None, rate_hz=raw.rate_hz, start=raw.start
            )
        time = nearest
    if time == index:
        raise RecordError(f"{path}: channel {raw.name!r} cannot be its own time")
    seconds = _unit(path, channels[time], mapping.time_unit, "time", mapping)
    return Pick(quantity, index, raw.name, factor, time, time_factor=seconds)


def _recognised(path: Path, channels: Sequence[RawChannel]) -> dict[str, int]:
    """Quantity → channel, by the names."""
    chosen: dict[str, int] = {}
    for i, raw in enumerate(channels):
        for quantity, names in NAMES.items():
            if _key(raw.name) in names:
                if quantity in chosen:
                    first = channels[chosen[quantity]].name
                    raise RecordError(
                        _ask(
                            path, channels, f"takes both {first!r} and {raw.name!r} for {quantity}"
                        )
                    )
                chosen[quantity] = i
    return chosen


def _time_of(channels: Sequence[RawChannel], index: int) -> int | None:
    """The time channel of another: the one named after it, else the nearest before it, else the first."""
    key = _key(channels[index].name)
    own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
    times = []
    for i, raw in enumerate(channels):
        name = _key(raw.name)
        if name in own:
            return i
        if _TIME.fullmatch(name):
            times.append(i)
    before = [i for i in times if i < index]
    return before[-1] if before else (times[0] if times else None)


def _find(
    path: Path, channels: Sequence[RawChannel], which: Which, mapping: RecordMapping, key: str
) -> int:
    """The channel of that name or number."""
    if isinstance(which, int):
        if 1 <= which <= len(channels):
            return which - 1
        raise RecordError(
            f"{mapping.source}: {key}: there is no channel {which}; {path} has {len(channels)}: {_list(channels)}"
        )
    for spelt in (str, _key):  # as it stands, else without regard to case, blanks and path
        matches = [
            i
            for i, raw in enumerate(channels)
            if spelt(which) in (spelt(raw.name), spelt(_full(raw)), spelt(raw.label or raw.name))
        ]
        if len(matches) == 1:
            return matches[0]
        if matches:
            numbers = " and ".join(str(i + 1) for i in matches)
            raise RecordError(
                f"{mapping.source}: {key}: {path} has {len(matches)} channels {which!r}, numbers {numbers}; give one"
            )
    raise RecordError(
        f"{mapping.source}: {key}: {path} has no channel {which!r}; it has {_list(channels)}"
    )


def _unit(
    path: Path, raw: RawChannel, given: str | None, quantity: str, mapping: RecordMapping
) -> float:
    """SI units per unit of the channel."""
    text = given or raw.unit
    if text is None:
        key = "time: {channel: …, unit: …}" if quantity == "time" else f"channels.{quantity}.unit"
        raise RecordError(
            f"{path}: channel {raw.name!r} has no unit; write {key} into {_where(path, mapping)}"
        )
    try:
        return unit_for(text, quantity).factor
    except UnitError as error:
        raise RecordError(f"{path}: channel {raw.name!r}: {error}") from None


def _ask(
    path: Path, channels: Sequence[RawChannel], what: str, mapping: RecordMapping | None = None
) -> str:
    """The error for channels that cannot be told apart, with what to write."""
    names = [raw for raw in channels if not _TIME.fullmatch(_key(raw.name))]
    examples = zip(("base_displacement", "displacement"), [*names, *channels], strict=False)
    lines = [
        f"    {quantity}: {{channel: {_yaml(raw.name)}, unit: {raw.unit or '…'}}}"
        for quantity, raw in examples
    ]
    timed = any(raw.rate_hz for raw in channels) or len(names) < len(channels)
    return "\n".join(
        [
            f"{path}: {what}; it needs one of {', '.join(EXCITATIONS)} and at least one of {', '.join(RESPONSES)}. "
            f"Its channels are {_list(channels)}. Say which is which in {_where(path, mapping)}, for example",
            "  channels:",
            *lines,
            *([] if timed else ["  sample_rate_hz: …"]),
        ]
    )


def _where(path: Path, mapping: RecordMapping | None) -> str:
    return (mapping and mapping.source) or str(path.with_name(f"{path.name}.yaml"))


def _list(channels: Iterable[RawChannel]) -> str:
    return ", ".join(f"{i} {_full(raw)!r}" for i, raw in enumerate(channels, start=1)) or "none"


def _full(raw: RawChannel) -> str:
    return f"{raw.name} [{raw.unit}]" if raw.unit else raw.name


def _yaml(name: str) -> str:
    return (
        name if re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) else '"' + name.replace('"', '\\"') + '"'
    )


def _key(name: str) -> str:
    """The last part of a path, in lower case, with "_" for what separates words."""
    return re.sub(r"[\s\-]+", "_", re.split(r"[/.](?=[^/.])", name.strip())[-1].strip().lower())
