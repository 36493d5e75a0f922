"""The roles of the channels of a table, by headings and units, and by samples where these do not say it: constants,
counters, times, the axes of an accelerometer."""

from __future__ import annotations

import re
import warnings
from collections.abc import Collection, Sequence
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..project.wording import shortened
from .channel import ABSOLUTE, EXCITATIONS, RESPONSES, require_one_coordinate
from .errors import RecordError, RecordWarning
from .headings import (
    WORDS,
    by_unit,
    coordinate_of,
    full_name,
    holds_time,
    key_of,
    names_time,
    quantity_of,
    unusable,
    words_of,
)
from .mapping import RecordMapping
from .table import Table
from .units import DIMENSIONS

LISTED = 20  # channels in a message
# words for the absolute value of three axes, and its relative rounding error
_OF_AXES = (
    *("absolute", "abs", "absolut", "total", "magnitude", "norm"),
    *("resultant", "resultierende"),
)
_ABSOLUTE = 1e-3
_FEWEST = 4  # samples of which it shows that they rise in equal steps
_ROUNDED = 0.6  # steps; times with too few digits are off by less
_TRIED = 20  # channels that are read one by one where some column holds a text


class Samples:
    """The samples of each channel (`values`), or none of one that cannot be read.

    aside : channels that are no motion and no force, by name, unit or samples, with what they are instead.
    rising : steps of those that rise in equal steps and are no counters.
    """

    def __init__(self, file: Table) -> None:
        everything = range(len(file.channels))
        self.aside: dict[int, str] = {}
        self.rising: dict[int, float] = {}
        self.values = _samples(file, everything) or {}
        if not self.values:  # a text in some column
            for i in everything[:_TRIED]:
                self.values |= _samples(file, [i]) or {i: np.empty(0)}
                if not self.values[i].size:
                    self.aside[i] = "it does not hold numbers"
        for i, values in self.values.items():
            raw, finite = file.channels[i], values[np.isfinite(values)]
            if (other := unusable(raw)) is not None:
                self.aside[i] = other
            elif holds_time(raw) or finite.size < _FEWEST:
                continue
            elif not np.ptp(finite):
                self.aside[i] = f"constant, {finite[0]:g}"
            elif (step := equal_step(finite)) is not None:
                counts = step == 1.0 and not np.any(finite % 1.0)
                kind = "a counter" if counts else "a time"
                self.aside[i] = f"rises by {step:.6g} from sample to sample: {kind}"
                if not counts:
                    self.rising[i] = step


def _samples(file: Table, wanted: Sequence[int]) -> dict[int, Array] | None:
    """Return the samples of some channels; None where they cannot be read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # comes where the record is read
        try:
            return file.columns(wanted)
        except RecordError:
            return None


def equal_step(values: Array) -> float | None:
    """Return the step of values that rise in equal steps, as times and counters do; None for others."""
    if values.size < _FEWEST:
        return None
    line = np.linspace(values[0], values[-1], values.size)
    step = float(line[1] - line[0])
    rises = step > 0.0 and np.diff(values).min() >= 0.0
    return step if rises and np.abs(values - line).max() < _ROUNDED * step else None


def first_of(names: Sequence[str]) -> str:
    """Return names in a row, the first 20 of them."""
    more = len(names) - LISTED
    return ", ".join(names[:LISTED]) + f" and {more} more" * (more > 0)


class Roles:
    """The channels of a table, distinguished by their names, units and samples.

    keys : their names, to compare.   overview : of them, for messages.   where : the file of the mapping, or the one to
    write.
    """

    def __init__(self, file: Table, mapping: RecordMapping) -> None:
        self.file, self.path, self.channels, self.mapping = file, file.path, file.channels, mapping
        self.where = mapping.source or f"{file.path}.yaml"
        self.keys = [key_of(raw.name) for raw in self.channels]
        named = [f"{i} {shortened(full_name(raw))}" for i, raw in enumerate(self.channels, 1)]
        self.overview = first_of(named) or "none"

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

    @cached_property
    def by_names(self) -> tuple[dict[str, int], str]:
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
            if self.mapping.free and {*words_of(raw.name)} & {*WORDS["base_displacement"]}:
                continue  # the other axis of a camera: no base moves in a free decay
            if quantity in chosen:
                self.require_one_coordinate([chosen[quantity], i])
                both = [shortened(self.channels[at].name) for at in (chosen[quantity], i)]
                return chosen, f"takes both {' and '.join(both)} for {quantity}"
            if quantity:
                chosen[quantity] = i
        answering, driving = ({*chosen} & {*of} for of in (RESPONSES, EXCITATIONS))
        if answering and driving:
            return chosen, ""
        left = self.spare(chosen.values())
        kinds = {coordinate_of(self.channels[i]) for i in chosen.values()}
        alike = [i for i in left if not kinds or coordinate_of(self.channels[i]) in kinds]
        if left and not alike:
            self.require_one_coordinate([*chosen.values(), *left])
        left = alike
        forces = [i for i in left if by_unit(self.channels[i]) == "force"]
        if not driving and len(forces) == 1 and len(left) == 2 - bool(answering):
            chosen["force"] = forces[0]
        if not chosen and len(left) == 1 and (q := by_unit(self.channels[left[0]])) in ABSOLUTE:
            return {str(q): left[0]}, ""  # the record is a free decay
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
        require_one_coordinate(str(self.path), coordinates)

    def named(self, i: int) -> str | None:
        """Return the quantity that a heading names, also in other words, if its unit is not of another one."""
        raw, unit = self.channels[i], by_unit(self.channels[i])
        if i in self.axes:
            return "acceleration"
        quantity = quantity_of(raw) or quantity_of(raw, all_words=False)
        fits = quantity and (unit is None or DIMENSIONS[unit] == DIMENSIONS[quantity])
        return quantity if fits else None

    def time_of(self, index: int) -> int | None:
        """Return the time channel of another: the one named after it, else the nearest before it, else the first."""
        key = self.keys[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(self.keys) if name in own]
        is_time = names_time if any(map(names_time, self.channels)) else holds_time
        times = [i for i, raw in enumerate(self.channels) if is_time(raw)]
        before = [i for i in times if i < index]
        return next(iter(named or before[-1:] or times), None)

    def spare(self, used: Collection[int]) -> list[int]:
        """Return the channels that are not used and may hold a motion or a force."""
        return [i for i in range(len(self.channels)) if i not in used and self.may_move(i)]

    def may_move(self, i: int) -> bool:
        """Return whether a channel may hold a motion or a force: no time, no temperature, no counter, nothing
        constant."""
        if holds_time(self.channels[i]):
            return False
        return i not in self.samples.aside and not self.axes.get(i)
