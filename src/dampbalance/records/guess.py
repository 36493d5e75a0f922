"""What each column of a table holds and why, judged by heading, unit and samples.

A record is read if nothing is left to ask. Otherwise the same guesses make the mapping that a refusal shows and that
`--write-mapping` writes, with a blank for every drive, unit or rate that the file does not state.
"""

from __future__ import annotations

import itertools
import math
import re
import warnings
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..findings.finding import Finding
from ..project.wording import shortened
from . import samples
from .channel import ABSOLUTE, ACCOMPANYING, EXCITATIONS, OF_LOOP, ORDERS, RESPONSES
from .coordinate import ROTATION, TRANSLATION, Coordinate
from .errors import RecordError, RecordWarning
from .headings import (
    axis_of,
    by_unit,
    column_of,
    full_name,
    holds_time,
    is_stepped_sine,
    key_of,
    names_time,
    of_level,
    quantity_of,
    unit_of,
    unusable,
    without_number,
    words_of,
)
from .mapping import ChannelRule, RecordMapping, Which
from .table import RawChannel, Table
from .units import (
    DIMENSIONS,
    PER_FORCE,
    TABLE_DIMENSIONS,
    UNITS,
    find_motion,
    find_other,
    find_unit,
    slot,
    split_label,
)
from .vocabulary import WORDS

LISTED = 20  # columns in a message
_OF_AXES = "absolute abs absolut total magnitude norm resultant resultierende"
_UNNAMED = re.compile(r"(unnamed: \d+)?", re.IGNORECASE)  # by pandas
_OF_SENSOR = ("a", "gf")  # before the axes of an accelerometer: ax, gFx
ANGLE = 6.3  # rad; an angle that swings by more is in degrees
# s; times without a unit are in seconds if their steps lie between these and their span is below the last
_STEPS, _LONGEST = (5e-6, 0.2), 3600.0
_SAME = 0.05  # relative deviation of gravity or of a slope from the one that a unit gives
_BY_NAME, _BY_A_WORD, BY_UNIT = "by its name", "by a word of its name", "by its unit"
_BY_NOTHING = "neither name nor unit says what it is"
LEVELS = (_BY_NAME, _BY_A_WORD, BY_UNIT, _BY_NOTHING)
UNNAMED = (BY_UNIT, _BY_NOTHING)
_OF_MASS = {*WORDS["bodies"]["mass"]}
_ROLES = EXCITATIONS, RESPONSES
_TAKEN = "other channels are taken for drive and response"
_ONE = 0.1  # relative deviation of a derivative, by its units
_GOES_ROUND = "they go round as the loop of a contact does"
_DECAYS = "the motion dies out, and nothing names it the drive"


@dataclass(frozen=True, slots=True)
class Guess:
    """What a column holds.

    quantity : of `QUANTITIES` or `TABLE_DIMENSIONS`; "" for a column that is not read.   reason : why, in words.
    unit : in which it is read; "" if unknown.   may : the quantities to choose from if it must be asked.
    said : what is reported about it.   axis : whether it is one of the axes of a sensor.
    """

    quantity: str
    reason: str
    unit: str = ""
    may: tuple[str, ...] = ()
    said: Finding | None = None
    axis: bool = False


def first_of(names: Sequence[str]) -> str:
    """Return the first 20 names as a text, and how many follow."""
    more = len(names) - LISTED
    return ", ".join(names[:LISTED]) + f" and {more} more" * (more > 0)


class Guesses:
    """The guesses for the columns of a table.

    keys : normalized names of the columns.   where : the file of the mapping, or the one to write.
    stepped : whether it is a table of steady responses to a stepped sine.
    """

    def __init__(
        self, file: Table, mapping: RecordMapping, *, stepped: bool | None = False
    ) -> None:
        self.file, self.path, self.channels, self.mapping = file, file.path, file.channels, mapping
        self.stepped = is_stepped_sine(file, mapping) if stepped is None else stepped
        self.where = mapping.source or f"{file.path}.yaml"
        self.keys = [key_of(raw.name) for raw in self.channels]
        if self.stepped:
            self.keys = [without_number(key) for key in self.keys]
        self.names = [shortened(full_name(raw)) for raw in self.channels]

    @cached_property
    def empty(self) -> set[int]:
        """The columns without a name and without values, as a delimiter at the end of each row makes them."""
        unnamed = [i for i, raw in enumerate(self.channels) if _UNNAMED.fullmatch(raw.label)]
        held = self.values if unnamed else {}
        return {i for i in unnamed if held[i].size and not np.isfinite(held[i]).any()}

    @property
    def overview(self) -> str:
        """The columns, for messages."""
        named = (f"{i + 1} {name}" for i, name in enumerate(self.names) if i not in self.empty)
        return first_of([*named]) or "none"

    # --- what is known of each column ------------------------------------------------------------------------------

    @cached_property
    def values(self) -> dict[int, Array]:
        """The samples of each column in the unit of its signal; empty for a column that cannot be read."""
        everything, held = range(len(self.channels)), dict[int, Array]()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RecordWarning)  # comes where the record is read
            # if some column holds text, the first 20 are read one by one
            for some in (everything, *([i] for i in everything[:20])):
                with suppress(RecordError):
                    held |= self.file.columns([i for i in some if i not in held])
        scales = {i: self.channels[i].scale for i in held if self.channels[i].scale > 0.0}
        held |= {i: scale * held[i] for i, scale in scales.items() if scale != 1.0}
        return {i: held.get(i, np.empty(0)) for i in everything}

    @cached_property
    def times(self) -> list[int]:
        """The columns of times, by the mapping, by name, by unit, or because they alone rise evenly."""
        if self.mapping.time is not None:
            return self.find(self.mapping.time, "time.channel")
        named = [i for i, raw in enumerate(self.channels) if names_time(raw)]
        clocks = [i for i, raw in enumerate(self.channels) if holds_time(replace(raw, name=""))]
        if {*named} - {*clocks} and len({*named, *clocks}) > 1:  # T1 beside time_s is a temperature
            even = [i for i in named + clocks if samples.equal_step(self.values[i]) is not None]
            stated = [i for i in clocks if i in named or i in even]
            named = stated or [i for i in named if i in even] or named
        named = named or [i for i, raw in enumerate(self.channels) if holds_time(raw)]
        known = self.mapping.channels or self.mapping.sample_rate_hz or self.stepped
        if named or known or any(raw.rate_hz or raw.fault for raw in self.channels):
            return named
        unnamed = (not (quantity_of(raw) or by_unit(raw)) for raw in self.channels)
        others = [i for i, nothing in enumerate(unnamed) if nothing]
        rising = [i for i in others if samples.equal_step(self.values[i]) is not None]
        return [i for i in rising if not samples.counts(self.values[i])]

    def time_of(self, index: int) -> int | None:
        """Return the time channel of a column: the one named after it, else the nearest to its left, else the first."""
        key = self.keys[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(self.keys) if name in own]
        before = [i for i in self.times if i < index]
        return next(iter(named or before[-1:] or self.times), None)

    def unit_of_time(self, index: int) -> str | None:
        """Return the unit of a time channel. If none is stated, its steps tell seconds from days, hours and ms; None
        where they do not."""
        if (text := self.mapping.time_unit or unit_of(self.channels[index])) is not None:
            return text
        values = self.values[index]
        values = values[np.isfinite(values)]
        steps = np.diff(values)
        likely = steps.size and _STEPS[0] < np.median(np.abs(steps)) < _STEPS[1]
        return "s" if likely and np.ptp(values) < _LONGEST else None

    def step(self, index: int) -> float:
        """Return the sampling interval of a column, s; NaN if unknown."""
        if rate := self.mapping.sample_rate_hz or self.channels[index].rate_hz:
            return 1.0 / rate
        time = self.time_of(index)
        unit = None if time is None else find_unit(self.unit_of_time(time) or "")
        if time is None or unit is None or unit.dimension != "time" or self.values[time].size < 2:
            return math.nan
        return float(np.nanmedian(np.diff(self.values[time]))) * unit.factor

    def find(self, which: Which, key: str) -> list[int]:
        """Return the column with a name or number, as a list; in a table of steady responses those of all levels.

        key : of the mapping, for messages.
        """
        at, path = f"{self.where}: {key}:", self.path
        if isinstance(which, int) and not 1 <= which <= len(self.channels):
            remedy = f"{path} has {len(self.channels)}: {self.overview}"
            raise RecordError(f"{at} there is no channel {which}; {remedy}")
        if isinstance(which, int):
            return [which - 1]
        labels = [(raw, raw.label or raw.name) for raw in self.channels]
        names = [(raw.name, full_name(raw), of, split_label(of)[0]) for raw, of in labels]
        spellings = (str, without_number, of_level) if self.stepped else (str, key_of)
        for spelt in spellings:  # verbatim, else without regard to case, blanks and path
            found = [i for i, own in enumerate(names) if spelt(which) in map(spelt, own)]
            if len(found) > 1 and not self.stepped:
                numbers = " and ".join(str(i + 1) for i in found[:LISTED])
                which = f"{shortened(which)}, numbers {numbers}"
                raise RecordError(f"{at} {path} has {len(found)} channels {which}; give one")
            if found:
                return found
        raise RecordError(f"{at} {path} has no channel {shortened(which)}; it has {self.overview}")

    def _words(self, i: int) -> set[str]:
        """The words of the heading of a column."""
        return {*words_of(self.channels[i].name)}

    @cached_property
    def axes(self) -> dict[int, Guess]:
        """The guesses for sensors with axes x, y and z, and their absolute value. The axis with the largest standard
        deviation is read, unless the motion is oblique to all of them."""
        groups: dict[tuple[str, str, str | None], dict[str, int]] = {}
        for i, raw in enumerate(self.channels):
            for axis, before, behind in axis_of(raw.name):
                groups.setdefault((before, behind, raw.unit), {})[axis] = i
        found: dict[int, Guess] = {}
        for (before, behind, unit), group in groups.items():
            own, held = [*group.values()], [self.values[i] for i in group.values()]
            named = quantity_of(self.channels[own[0]]) or by_unit(self.channels[own[0]])
            named = named or "acceleration" * (len(own) == 3 and before in _OF_SENSOR)
            if not named or len(own) < 2 or not all(of.size for of in held):
                continue
            spread = [float(np.nanstd(of)) for of in held]
            most = int(np.argmax(spread))
            if len(own) == 2 and not (before + behind and self._dies(own[most])):
                continue  # x and y in mm are the mass and the base
            other = f"an axis that moves less than {shortened(self.channels[own[most]].name)}"
            found |= dict.fromkeys(own, Guess("", other, axis=True))
            raw = self.channels[own[most]]
            along = samples.along(held[most], held)
            found[own[most]] = Guess(named, _BY_NAME, axis=True)
            if along > 1.0 + _SAME:
                oblique = f"the motion is {along:.3g} times as large, along no axis: say scale: {along:.3g}"
                found[own[most]] = Guess("", oblique, may=(named,))
            total = np.sqrt(np.sum(np.square(held), axis=0))
            for i, raw in enumerate(self.channels):
                of = self.values[i] if raw.unit == unit and i not in own else np.empty(0)
                # 1e-3: relative, of the absolute value of three axes
                near = of.size == total.size and np.allclose(of, total, rtol=1e-3, equal_nan=True)
                if near or (of.size and self._words(i) & {*_OF_AXES.split()}):
                    found[i] = Guess("", "the absolute value of several axes")
        return found

    def _dies(self, i: int) -> bool:
        """Return whether the record is of a free decay, by the mapping or by this column."""
        return self.mapping.free or samples.dies_out(self.values[i])

    # --- what each column holds ------------------------------------------------------------------------------------

    @cached_property
    def all(self) -> dict[int, Guess]:
        """The guess for each column except times."""
        if self.stepped:
            return self._of_lines()
        found = {i: self._by_heading(i) for i in range(len(self.channels)) if i not in self.times}
        named = {i: guess.quantity for i, guess in found.items() if guess.reason == _BY_NAME}
        driving, answering = ([i for i, q in named.items() if q in of] for of in _ROLES)
        clear = len({*named.values()}) == len(named) and all(self.channels[i].unit for i in named)
        rest = [i for i, of in found.items() if of.reason in LEVELS and i not in named]
        alone = len(named) == 1 and not rest
        driven = len(driving) == 1 and self._words(driving[0]) != {"y"}
        held = {i: of.quantity for i, of in found.items() if of.quantity}
        speeds = {quantity: i for i, quantity in held.items()}
        if len(speeds) == len(held) and self.are_steady_speeds(speeds):
            self._leave(found, found.keys() - held.keys(), _TAKEN)
        elif clear and answering and (driven or alone):
            self._leave(found, found.keys() - named.keys(), _TAKEN)
        else:
            self._look(found)
        if self.mapping.free:  # a drive with a known unit is read, to see that it stands still
            drives = [i for i, guess in found.items() if guess.quantity in EXCITATIONS]
            known = [i for i in drives if by_unit(self.channels[i])]
            self._leave(found, {*drives} - {*known[:1]}, _DECAYS)
        for i in [*found, *found]:  # one may tell the unit of one before it
            if found[i].quantity and not found[i].unit:
                found[i] = self._with_unit(i, found)
        return found

    def _by_heading(self, i: int) -> Guess:
        """Return the guess that name and unit of a column give."""
        raw, unit = self.channels[i], by_unit(self.channels[i])
        if other := unusable(raw):
            return Guess("", other)
        whole, part = quantity_of(raw), quantity_of(raw, all_words=False)
        named = whole or part or ""
        if named == "base_displacement" and self._may_be_in_inches(raw):
            if not self.mapping.free:
                may = named, "displacement"
                return Guess("", 'the "in" at its end stands for inches or for the input', may=may)
            named = whole = "displacement"
        if named and unit and DIMENSIONS[unit] != DIMENSIONS[named]:
            return Guess("", f"its name says {named}, its unit {unit}", may=(unit,))
        if named:
            return Guess(named, _BY_NAME if whole else _BY_A_WORD)
        if raw.unit and not unit and not find_other(raw.unit):
            return Guess("", f"its unit, {shortened(raw.unit)}, is no unit of motion or force")
        return Guess(unit or "", BY_UNIT if unit else _BY_NOTHING)

    def _may_be_in_inches(self, raw: RawChannel) -> bool:
        """Return whether "in" at the end of a name may be a unit, as in displacement_in: the name says nothing else of
        the base, and no column is named an output."""
        *words, last = words_of(raw.name)
        others = replace(raw, name=" ".join(words))
        named = last == "in" and not raw.unit and quantity_of(others, all_words=False)
        bodies = any(self._words(i) & _OF_MASS for i in range(len(self.channels)))
        return named == "displacement" and not bodies

    @staticmethod
    def _leave(found: dict[int, Guess], columns: Iterable[int], why: str) -> None:
        """Leave columns aside that are not yet, and note why."""
        for i in columns:
            known = found[i].quantity in ACCOMPANYING
            if not known and (found[i].reason in LEVELS or found[i].may):
                found[i] = Guess("", why)

    def _look(self, found: dict[int, Guess]) -> None:
        """Refine the guesses by the samples: which columns are no motion, which show the same body, which one drives,
        and what must be asked."""
        found |= self.axes
        level = {i: LEVELS.index(of.reason) for i, of in found.items() if of.reason in LEVELS}
        level = {i: at for i, at in level.items() if found[i].quantity not in ACCOMPANYING}
        still = {i: why for i in level if (why := samples.aside(self.values[i]))}
        moving = [i for i in level if i not in still]
        answered = any(found[i].quantity in RESPONSES for i in moving)
        for i, why in still.items():  # what is named and has a unit is read as it is
            named = level[i] == 0 and (self.channels[i].unit or not answered)
            if not named or (answered and found[i].quantity in RESPONSES):
                found[i] = Guess("", why)
        self._one_body(found, moving)
        live = [i for i in level if found[i].reason in LEVELS]
        answers = [i for i in live if found[i].quantity in RESPONSES]
        dies = self.mapping.free or any(samples.dies_out(self.values[i]) for i in answers)
        if dies:
            y = [i for i in live if self._words(i) == {"y"} and i not in self.axes]
            swing = [i for i in y if self._may_drive(i, answers)]
            found |= {i: replace(found[i], quantity="displacement") for i in swing}
            self._ask(found, swing)
            self._leave(found, {*y} - {*swing}, _DECAYS)
            live = [i for i in live if found[i].reason in LEVELS]
        alone = live if len(live) == 1 and not any(of.may for of in found.values()) else []
        if any(level[i] for i in alone) and (unit := by_unit(self.channels[live[0]])):
            found[live[0]] = Guess(unit, "the only signal")
            return
        drives = [i for i in live if found[i].quantity in EXCITATIONS]
        drives = [i for i in drives if level[i] == min(level[j] for j in drives)]
        answers = [i for i in live if found[i].quantity in RESPONSES]
        answers = [i for i in answers if not level[i]] or answers
        if len(drives) > 1 and not self.mapping.free:
            self._ask(found, drives)
        known = bool(drives) or dies
        chosen = self._apart(found, answers, known)
        held = [found[i].quantity for i in chosen]
        unsure = [i for i in chosen if held.count(found[i].quantity) > 1]
        if any(level[i] for i in chosen) and len(live) > 1:
            sure = self._are_one(found, chosen) if len(chosen) > 1 else known
            unsure = [] if sure and not unsure else chosen
        if not drives:
            unsure = [*unsure, *self._scaled(found, chosen)]
        self._ask(found, unsure, drives)
        chosen = [i for i in chosen if i not in unsure]
        for i in live if chosen and known else ():
            new = i not in (*drives, *chosen) and found[i].quantity not in held
            if new and found[i].reason in LEVELS and self._are_one(found, [chosen[0], i]):
                chosen.append(i)
        if chosen and known:
            why = _TAKEN if drives else _DECAYS
            swing = [i for i in live if not drives and i not in chosen]
            swing = [i for i in swing if level[i] and self._may_drive(i, chosen)]
            self._ask(found, [i for i in swing if found[i].reason in LEVELS])
            asked = [i for i in live if found[i].may]
            self._leave(found, found.keys() - {*drives, *chosen, *asked}, why)
        rest = [i for i in live if i not in (*drives, *chosen) and found[i].reason in LEVELS]
        self._ask_of_loop(found, [i for i in rest if level[i] == LEVELS.index(_BY_NOTHING)])
        self._ask(found, rest, drives)

    def _may_drive(self, i: int, responses: Sequence[int]) -> bool:
        """Return whether a column may drive one of the others, by their samples; never in a free decay."""
        others = (j for j in responses if j != i)
        return not self.mapping.free and any(
            samples.may_drive(self.values[i], self.values[j]) for j in others
        )

    def _ask_of_loop(self, found: dict[int, Guess], unnamed: Sequence[int]) -> None:
        """Ask which of two unnamed columns that trace a loop is the force."""
        known = self.times or self.mapping.sample_rate_hz or self.mapping.free
        if known or len(unnamed) != 2 or any(of.quantity for of in found.values()):
            return
        if samples.go_round(*(self.values[i] for i in unnamed)):
            found |= dict.fromkeys(unnamed, Guess("", _GOES_ROUND, may=OF_LOOP))

    def _ask(
        self, found: dict[int, Guess], columns: Iterable[int], drives: Sequence[int] = ()
    ) -> None:
        """Ask what columns hold.   drives : columns that are known to drive."""
        for i in [i for i in columns if not found[i].may]:
            of = found[i].quantity
            may = (of,) if of else tuple(EXCITATIONS | ABSOLUTE)
            if (base := f"base_{of}") in EXCITATIONS:
                may = (base, of)
            if (drives and i not in drives) or self.mapping.free:
                may = tuple(q for q in may if q not in EXCITATIONS)
            found[i] = Guess("", found[i].reason, may=may)

    def _one_body(self, found: dict[int, Guess], moving: Sequence[int]) -> None:
        """Leave aside the coordinates of a bob whose angle is recorded, and its height above another coordinate."""
        for i in moving:
            others = [j for j in moving if j != i and found[j].reason in LEVELS]
            turns = [j for j in others if self._turns(j) and not self._turns(i)]
            for j in turns:
                if samples.same_motion(self.values[i], self.values[j]):
                    found[i] = Guess("", f"moves as {self.names[j]}: one body")
            for j in others if found[i].reason != _BY_NAME or self._words(i) == {"y"} else turns:
                if samples.is_arc(self.values[i], self.values[j]):
                    found[i] = Guess("", f"an arc over {self.names[j]}: the height of a bob")

    def _turns(self, i: int) -> bool:
        """Return whether a column holds a rotation, by its unit or name."""
        unit = find_motion(self.channels[i].unit or "")
        return (
            unit.coordinate == ROTATION
            if unit
            else bool(self._words(i) & {*WORDS["others"]["rotation"]})
        )

    def _apart(self, found: dict[int, Guess], answers: Sequence[int], same: bool) -> list[int]:
        """Return one response of each quantity, leaving aside the others if they move with it; otherwise all.

        same : whether columns that move together show the same body, because another one drives or none.
        """
        chosen: list[int] = []
        for quantity in dict.fromkeys(found[i].quantity for i in answers):
            alike = [i for i in answers if found[i].quantity == quantity]
            bodies = [i for i in alike if self._words(i) & _OF_MASS]
            first, *others = bodies if len(bodies) == 1 else alike
            values = self.values if others else {}
            if same and all(samples.same_motion(values[first], values[i]) for i in others):
                far = [] if len(bodies) == 1 else [i for i in others if self._far(first, i)]
                self._leave(found, {*others} - {*far}, f"moves as {self.names[first]}")
                others = far
            chosen += [first, *others]
        return chosen

    def _far(self, first: int, other: int) -> bool:
        """Return whether two columns differ in size by more than a tenth."""
        units = ((i, find_motion(unit_of(self.channels[i]) or "")) for i in (first, other))
        sizes = [of.factor * np.nanstd(self.values[i]) for i, of in units if of]
        return len(sizes) == 2 and bool(abs(sizes[1] / sizes[0] - 1.0) > _ONE)

    def _are_one(self, found: dict[int, Guess], columns: Sequence[int]) -> bool:
        """Return whether each column is the time derivative of the one before, so that all show one body."""
        ratios = self._ratios(found, columns).values()
        moves = all(found[i].quantity in ORDERS for i in columns)
        return moves and all(r is not None and abs(r - 1.0) <= _ONE for r in ratios)

    def _ratios(self, found: dict[int, Guess], columns: Sequence[int]) -> dict[int, float | None]:
        """Return the ratio of each column to the time derivative of the one before, in SI units; 0 if they are not
        proportional, None if they cannot be compared."""
        order = {i: ORDERS.get(found[i].quantity, -1) for i in columns}
        ratios: dict[int, float | None] = {}
        for i, j in itertools.pairwise(sorted(columns, key=order.__getitem__)):
            first, second = (find_motion(unit_of(self.channels[at]) or "") for at in (i, j))
            same_clock = self.step(i) > 0.0 and self.values[i].size == self.values[j].size
            ratios[j], n = None, order[j] - order[i]
            if first and second and first.coordinate == second.coordinate and n and same_clock:
                ratios[j] = abs(self._slope(i, j, n) or 0.0) * second.factor / first.factor
        return ratios

    def _scaled(self, found: dict[int, Guess], columns: Sequence[int]) -> list[int]:
        """Return the columns that contradict another, being in a wrong unit or of another body, and note why."""
        ratios = self._ratios(found, columns)
        for i, r in ratios.items():
            if r is not None and abs(r - 1.0) > _ONE:
                in_g = found[i].quantity == "acceleration" and abs(9.80665 * r - 1.0) < _SAME
                why = "unit: g? It is " * in_g + (f"{r:.3g} times the" if r else "not a")
                found[i] = replace(found[i], reason=f"{why} derivative of another column")
        return [i for i in ratios if found[i].reason not in LEVELS]

    def _slope(self, i: int, j: int, order: int) -> float | None:
        """Return the ratio of column j to a time derivative of column i; None if they are not proportional."""
        step = self.step(i)
        if order < 1 or not step > 0.0:
            return None
        return samples.slope(self.values[i], self.values[j], step, order)

    def _with_unit(self, i: int, found: dict[int, Guess]) -> Guess:
        """Return a guess with its unit, from the file, or inferred from gravity, the size of an angle or another
        column."""
        guess, name = found[i], {"channel": self.names[i]}
        if (text := unit_of(self.channels[i])) is not None:
            return replace(guess, unit=text)
        order = ORDERS.get(guess.quantity, -1)
        for j, other in found.items() if guess.quantity in ABSOLUTE else ():
            known = find_motion(other.unit or unit_of(self.channels[j]) or "")
            if known is None or other.quantity not in ABSOLUTE:
                continue
            after = ORDERS[other.quantity] > order
            first, second = (i, j) if after else (j, i)
            s = self._slope(first, second, abs(ORDERS[other.quantity] - order))
            factor = s and known.factor * (abs(s) if after else 1.0 / abs(s))
            if unit := _near(factor or 0.0, DIMENSIONS[known.coordinate.key(guess.quantity)]):
                said = Finding("unit by slope", name | {"unit": unit, "other": self.names[j]})
                return replace(guess, unit=unit, said=said)
        if guess.quantity == "displacement" and self._turns(i):
            values = self.values[i]
            size = float(np.nanmax(np.abs(values), initial=0.0))
            swing = 0.5 * (np.nanmax(values, initial=-size) - np.nanmin(values, initial=size))
            counted = np.array_equal(values, np.rint(values))  # by an encoder
            # rad: what goes farther may be in degrees as well
            unit = "rad" if size <= 1.6 else "deg" if swing > ANGLE and not counted else ""
            said = Finding("unit by size", name | {"unit": unit, "size": size})
            return replace(guess, unit=unit, said=said if unit else None)
        if guess.quantity == "acceleration":
            own = [j for j in self.axes if self.channels[j].unit is None] if i in self.axes else [i]
            means = [float(np.nanmean(self.values[j])) for j in own]
            gravity = math.hypot(*means[:3])
            # of gravity in m/s²
            unit = _near(9.80665 / gravity, "acceleration") if gravity else ""
            if unit and (i in self.axes or unit != "g"):  # a sensor's offset may be about 1
                said = Finding("unit by gravity", name | {"unit": unit, "size": gravity})
                return replace(guess, unit=unit, said=said)
        return guess

    # --- tables of steady responses ----------------------------------------------------------------------------------

    @cached_property
    def per_force(self) -> bool:
        """Whether a table has a column of responses per force."""
        return bool({*map(column_of, self.channels)} & {*PER_FORCE})

    def _of_lines(self) -> dict[int, Guess]:
        """Return the guesses for a table of steady responses. A column without a clear name is asked for if its unit
        fits something that the table lacks."""
        named = [column_of(raw) or "" for raw in self.channels]
        held = {*map(slot, named)} | ({"drive"} if self.per_force else set())
        complete = {"frequency", "drive", "response", "phase"} <= held
        found: dict[int, Guess] = {}
        for i, (raw, name) in enumerate(zip(self.channels, named, strict=True)):
            unit, why = find_unit(raw.unit or ""), ""
            if not (name or raw.unit or samples.equal_step(self.values[i])):
                why = samples.aside(self.values[i])
            fits = (
                q for q, of in TABLE_DIMENSIONS.items() if (unit.dimension == of if unit else of)
            )
            may = tuple(q for q in fits if slot(q) not in held)
            if name or complete or why or not may:
                found[i] = Guess(name, _BY_NAME if name else why or _BY_NOTHING, raw.unit or "")
            else:
                found[i] = Guess("", BY_UNIT if unit else _BY_NOTHING, may=may)
        return found

    # --- what is read, and what is asked ---------------------------------------------------------------------------

    def are_steady_speeds(self, columns: Mapping[str, int]) -> bool:
        """Return whether a record of these columns, by quantity, is a table of forces at steady speeds, without times:
        as the mapping says, or by its velocities."""
        if {*columns} - {*ACCOMPANYING} != {"velocity", "force"} or self.mapping.free:
            return False
        rate = self.mapping.sample_rate_hz or self.channels[columns["force"]].rate_hz
        untimed = not (rate or self.times)
        velocities = self.values[columns["velocity"]] if untimed else np.empty(0)
        return self.mapping.steady or samples.steady_speeds(velocities)

    def coordinate(self, i: int) -> Coordinate:
        """Return whether a column rotates, by the unit that it is read in."""
        unit = find_motion(self.all[i].unit)
        return unit.coordinate if unit else ROTATION if self._turns(i) else TRANSLATION

    @cached_property
    def rules(self) -> dict[str, ChannelRule]:
        """The columns that are read, as rules of a mapping."""
        return {
            of.quantity: ChannelRule(
                i + 1, of.unit or None, self.channels[i].scale, coordinate=self.coordinate(i)
            )
            for i, of in self.all.items()
            if of.quantity
        }


def _near(factor: float, dimension: str) -> str:
    """Return the one unit of a dimension with about this factor; "" for none, or several."""
    near = [u for u in UNITS if u.dimension == dimension and abs(factor / u.factor - 1.0) < _SAME]
    return near[0].name if len(near) == 1 else ""
