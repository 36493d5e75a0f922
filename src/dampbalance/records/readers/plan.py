"""Which channel of a file holds what: from its mapping, or from the names and units in it."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ...project.wording import shortened
from ..errors import RecordError, RecordWarning
from ..mapping import ChannelRule, RecordMapping, Which
from ..measurement import ABSOLUTE, EXCITATIONS, QUANTITIES, RESPONSES, Correction
from ..units import DIMENSIONS, VOLTAGE, UnitError, find_other, find_unit, unit_for
from .headings import holds_time, key_of, names_time, quantity_of, unit_of, unusable
from .record_file import RawChannel, RecordFile
from .suggestion import LISTED, Samples, Suggestion, first_of, full_name, look_at


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
    if (
        entire
        and not driving
        and (not answering or (not mapping.channels and plan.unnamed(chosen.values())))
    ):
        raise plan.unclear("finds no excitation")
    if entire and not answering:
        raise plan.unclear("finds no response")
    picks = tuple(plan.pick(q, chosen[q], rules[q]) for q in QUANTITIES if q in chosen)
    if not mapping.channels:
        plan.warn_of_unused(picks)
    return picks


def suggested_mapping(file: RecordFile, mapping: RecordMapping) -> str:
    """A mapping in YAML for a file whose mapping, so far, names no channels: each line with its reason.

    Raises RecordError where the mapping names channels already, or the file has no response.
    """
    plan = _Plan(file, mapping)
    if mapping.channels:
        raise RecordError(f"{mapping.source} names the channels of {file.path} already")
    if not plan.suggestion.complete:
        raise plan.unclear("finds no response")
    return "\n".join([*plan.suggestion.lines(), ""])


class _Plan:
    """The channels of a file, as its mapping and their names tell them apart."""

    def __init__(self, file: RecordFile, mapping: RecordMapping) -> None:
        self.file, self.path, self.channels, self.mapping = file, file.path, file.channels, mapping
        self.where = mapping.source or f"{file.path}.yaml"
        self.keys = [key_of(raw.name) for raw in self.channels]
        named = [f"{i} {shortened(full_name(raw))}" for i, raw in enumerate(self.channels, start=1)]
        self.overview = first_of(named) or "none"

    @cached_property
    def samples(self) -> Samples:
        """The first samples of the channels: needed where their names do not suffice."""
        return look_at(self.file)

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
            f"no sampling rate. {self.suggested('Say when it was sampled')}"
        )

    def recognised(self) -> dict[str, int]:
        """Quantity → channel, by the names; of a single signal by its unit, if that is one of a response."""
        chosen: dict[str, int] = {}
        for i, raw in enumerate(self.channels):
            quantity = None if holds_time(raw) or unusable(raw) else quantity_of(raw)
            if quantity in chosen:
                both = [shortened(self.channels[at].name) for at in (chosen[quantity], i)]
                raise self.unclear(f"takes both {' and '.join(both)} for {quantity}")
            if quantity:
                chosen[quantity] = i
        if not chosen:
            signals = [i for i in range(len(self.channels)) if self.may_move(i)]
            unit = find_unit(self.channels[signals[0]].unit or "") if len(signals) == 1 else None
            if unit:
                chosen = {q: signals[0] for q in ABSOLUTE if DIMENSIONS[q] == unit.dimension}
        return chosen

    def time_of(self, index: int) -> int | None:
        """The time channel of another: the one named after it, else the nearest before it, else the first."""
        key = self.keys[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(self.keys) if name in own]
        is_time = names_time if any(map(names_time, self.channels)) else holds_time
        times = [i for i, raw in enumerate(self.channels) if is_time(raw)]
        before = [i for i in times if i < index]
        return next(iter(named or before[-1:] or times), None)

    def warn_of_unused(self, picks: Sequence[Pick]) -> None:
        """Warn of signals as long as those read that no name told apart.

        A mapping that names channels leaves the others out on purpose.
        """
        sizes = {self.channels[pick.index].size for pick in picks}
        used = {i for pick in picks for i in (pick.index, pick.time)}
        reasons = {i: unusable(raw) for i, raw in enumerate(self.channels) if not holds_time(raw)}
        if names := [
            shortened(full_name(self.channels[i])) + f" ({reason})" * (reason is not None)
            for i, reason in reasons.items()
            if i not in used and self.channels[i].size in sizes
        ]:
            warnings.warn(
                f"{self.path}: channels not used: {first_of(names)}; say in {self.where} what they "
                "hold, if it is needed",
                RecordWarning,
                stacklevel=2,
            )

    def unnamed(self, used: Collection[int | None]) -> bool:
        """Whether there are signals that are not used."""
        return any(i not in used and self.may_move(i) for i in range(len(self.channels)))

    def may_move(self, i: int) -> bool:
        """Whether a channel may hold a motion or a force: no time, no temperature, no counter, nothing constant."""
        return not holds_time(self.channels[i]) and i not in self.samples.aside

    def find(self, which: Which, key: str) -> int:
        """The channel of that name or number."""
        said, path, channels = f"{self.mapping.source}: {key}:", self.path, self.channels
        if isinstance(which, int):
            if 1 <= which <= len(channels):
                return which - 1
            raise RecordError(
                f"{said} there is no channel {which}; {path} has {len(channels)}: {self.overview}"
            )
        for spelt in (str, key_of):  # as it stands, else without regard to case, blanks and path
            matches = [
                i
                for i, raw in enumerate(channels)
                if spelt(which) in map(spelt, (raw.name, full_name(raw), raw.label or raw.name))
            ]
            if len(matches) == 1:
                return matches[0]
            if matches:
                numbers = " and ".join(str(i + 1) for i in matches[:LISTED])
                raise RecordError(
                    f"{said} {path} has {len(matches)} channels {shortened(which)}, numbers {numbers}; give one"
                )
        raise RecordError(
            f"{said} {path} has no channel {shortened(which)}; it has {self.overview}"
        )

    def unit(self, raw: RawChannel, given: str | None, quantity: str) -> float:
        """SI units per unit of the channel."""
        text = given or unit_of(raw)
        channel = f"{self.path}: channel {shortened(raw.name)}"
        if text is None and self.mapping.channels:
            key = "time" if quantity == "time" else f"channels.{quantity}"
            raise RecordError(
                f"{channel} has no unit: say unit: {QUANTITIES.get(quantity, 's')}, or as recorded, at {key} in "
                f"{self.where}"
            )
        if text is None:
            raise RecordError(f"{channel} has no unit. {self.suggested('Give it')}")
        if find_other(text) == VOLTAGE and not self.mapping.channels:
            raise RecordError(f"{channel} is in {text}. {self.suggested('Give its scale')}")
        try:
            return unit_for(text, quantity).factor
        except UnitError as error:
            raise RecordError(f"{channel}: {error}") from None

    def unclear(self, what: str) -> RecordError:
        """The error for channels that cannot be told apart, with what to write."""
        return RecordError(
            f"{self.path}: {what}; it needs one of {', '.join(EXCITATIONS)}, unless it is a free decay, and at least"
            f" one of {', '.join(ABSOLUTE)} (relative_displacement, … if measured against the base). Its channels are "
            f"{self.overview}. {self.suggested('Say which is which')}"
        )

    @property
    def suggestion(self) -> Suggestion:
        """What the channels may hold."""
        return Suggestion(self.channels, self.samples, self.mapping)

    def suggested(self, what: str) -> str:
        """A mapping to write that is complete, and holds for these channels if the guesses do."""
        suggestion = self.suggestion
        if not suggestion.complete:
            return (
                "A record has two signals at least: give one that holds both, or name the file of each in "
                f"{self.where}"
            )
        here = "" if self.mapping.source else " (--write-mapping writes it)"
        lines = [f"{what} in {self.where}{here}, for example"]
        return "\n  ".join([*lines, *suggestion.lines()])
