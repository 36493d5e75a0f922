"""What the columns of a table may hold, each with a reason, by heading, unit and samples.

A record is read where the guesses are certain and no two columns compete. Where they are not, the same guesses are the
mapping that a refusal shows and that `--write-mapping` writes.
"""

from __future__ import annotations

import json
import math
import re
import warnings
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..project.wording import shortened
from .channel import ABSOLUTE, EXCITATIONS, QUANTITIES, RESPONSES, require_one_coordinate
from .errors import RecordError, RecordWarning
from .headings import (
    STANDARD_ERROR,
    WORDS,
    by_unit,
    column_of,
    coordinate_of,
    full_name,
    holds_time,
    key_of,
    names_time,
    of_level,
    quantity_of,
    unit_of,
    unusable,
    without_number,
    words_of,
)
from .mapping import RecordMapping, Which
from .table import Table
from .units import (
    DIMENSIONS,
    PER_FORCE,
    TABLE_DIMENSIONS,
    find_motion,
    find_other,
    find_unit,
)

LISTED = 20  # columns in a message
_OF_AXES = "absolute abs absolut total magnitude norm resultant resultierende"
_ROUNDING = 1e-3  # relative, of the absolute value of three axes
_FEWEST = 4  # samples of which it shows that they rise in equal steps
_ROUNDED = 0.6  # steps; times with too few digits are off by less
_TRIED = 20  # columns that are read one by one where some column holds a text
# words that YAML takes for others
_YAML_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
_LONGEST = 60  # characters of a name; a column with a longer one is called by its number
_TURNS = 2.0 * math.pi  # half the range of phases: more is in degrees, less in rad
_IN_MM = 0.05  # half the range of a displacement: more is in mm, less in m
# least step in each unit, as nothing is sampled at less than 20 Hz
_TIME_UNITS = {"µs": 50.0, "ms": 0.05, "s": 0.0}
_BY_NAME, _BY_UNIT = "by its name", "by its unit"
_BY_NOTHING = "neither name nor unit says what it is"
_FIRST = "; taken as the drive, as it comes first"
_RESPONSE_OF = {"base_displacement": "displacement", "base_acceleration": "acceleration"}
_MOTIONS = {word for quantity in ABSOLUTE for word in WORDS[quantity].split()}
_DRIVES = (*EXCITATIONS, "base_velocity")
_RESPONSES = (*ABSOLUTE, *PER_FORCE)  # of a table
_UNITS = {
    **QUANTITIES,
    **{"frequency": "Hz", "phase": "rad", "base_velocity": "m/s"},
    **{"receptance": "m/N", "mobility": "m/s/N", "accelerance": "m/s²/N"},
}
_KEPT = "delimiter decimal header_lines sample_rate_hz frequency_hz level notes force_N"
"""Keys of a mapping that stay in the one suggested."""


CERTAIN, LIKELY, POSSIBLE, UNSAID, AGAINST_ITS_UNIT = range(5)
"""How sure a guess is: by a whole name, or as no other column can be it; by part of a name; by its unit; by nothing;
by a name that the unit contradicts."""


@dataclass(frozen=True, slots=True)
class Guess:
    """What a column may hold.

    quantity : of `QUANTITIES` or `TABLE_DIMENSIONS`; "" for nothing that is read.   reason : what says so, in words.
    doubt : CERTAIN, …; a record is read by guesses that are certain.
    """

    quantity: str
    reason: str
    doubt: int = CERTAIN


class Samples:
    """The samples of each column (`values`), or none of one that cannot be read.

    aside : columns that are no motion and no force, by name, unit or samples, with what they are instead.
    rising : those of them that rise in equal steps and are no counters.
    """

    def __init__(self, file: Table) -> None:
        everything = range(len(file.channels))
        self.values = _samples(file, everything)
        for i in () if self.values else everything[:_TRIED]:  # a text in some column
            self.values |= _samples(file, [i]) or {i: np.empty(0)}
        self.aside: dict[int, str] = {}
        self.rising: list[int] = []
        for i, values in self.values.items():
            raw, finite = file.channels[i], values[np.isfinite(values)]
            if (other := unusable(raw)) or not values.size:
                self.aside[i] = other or "it does not hold numbers"
            elif holds_time(raw) or finite.size < _FEWEST:
                continue
            elif not np.ptp(finite):
                self.aside[i] = f"constant, {finite[0]:g}"
            elif (step := _equal_step(finite)) is not None:
                counts = step == 1.0 and not np.any(finite % 1.0)
                kind = "a counter" if counts else "a time"
                self.aside[i] = f"rises by {step:.6g} from sample to sample: {kind}"
                self.rising += [i] * (not counts)


def _samples(file: Table, wanted: Sequence[int]) -> dict[int, Array]:
    """Return the samples of some columns; nothing where they cannot be read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # comes where the record is read
        try:
            return file.columns(wanted)
        except RecordError:
            return {}


def _equal_step(values: Array) -> float | None:
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


class Guesses:
    """The guesses for the columns of a table.

    keys : names of the columns, to compare.   overview : of them, for messages.   where : the file of the mapping, or
    the one to write.   stepped : whether it is a table of steady responses to a stepped sine.
    """

    def __init__(
        self, file: Table, mapping: RecordMapping, *, stepped: bool | None = False
    ) -> None:
        self.file, self.path, self.channels, self.mapping = file, file.path, file.channels, mapping
        self.stepped = is_table_of_lines(file, mapping) if stepped is None else stepped
        self.where = mapping.source or f"{file.path}.yaml"
        self.keys = [key_of(raw.name) for raw in self.channels]
        if self.stepped:
            self.keys = [without_number(key) for key in self.keys]
        self.names = [shortened(full_name(raw)) for raw in self.channels]
        self.overview = first_of([f"{i} {name}" for i, name in enumerate(self.names, 1)]) or "none"

    @cached_property
    def samples(self) -> Samples:
        """The samples of the columns: needed where their names do not suffice."""
        return Samples(self.file)

    @cached_property
    def axes(self) -> dict[int, str]:
        """The channels of the one accelerometer of three axes, x, y and z, and their absolute value: why each is not
        read, or "" for the axis with the most motion, by its standard deviation. Nothing where there is none."""
        groups: dict[tuple[str, str, str | None], dict[str, int]] = {}
        ours = {i: raw for i, raw in enumerate(self.channels) if by_unit(raw) == "acceleration"}
        for i, raw in ours.items():
            name = raw.name.lower()
            for axis in re.finditer("[xyz]", name):
                group = name[: axis.start()], name[axis.end() :], raw.unit
                groups.setdefault(group, {})[axis[0]] = i
        threes = [{*of.values()} for of in groups.values() if len(of) == len("xyz")]
        if len(threes) != 1 or not all(self.samples.values[i].size for i in threes[0]):
            return {}
        values = self.samples.values
        most = max(threes[0], key=lambda i: float(np.nanstd(values[i])))
        why = dict.fromkeys(threes[0], f"it moves less than {shortened(self.channels[most].name)}")
        total = np.sqrt(np.sum(np.square([values[i] for i in threes[0]]), axis=0))
        for i in ours.keys() - why.keys():
            near = values[i].size and np.allclose(values[i], total, rtol=_ROUNDING, equal_nan=True)
            if near or self._words(i) & {*_OF_AXES.split()}:
                why[i] = "the absolute value of three axes"
        return why | {most: ""}

    def _words(self, i: int) -> set[str]:
        """The words of the heading of a column."""
        return {*words_of(self.channels[i].name)}

    @cached_property
    def times(self) -> list[int]:
        """The columns of times: by their names; where no name says it, by their units."""
        named = [i for i, raw in enumerate(self.channels) if names_time(raw)]
        return named or [i for i, raw in enumerate(self.channels) if holds_time(raw)]

    def time_of(self, index: int) -> int | None:
        """Return the time channel of another: the one named after it, else the nearest before it, else the first."""
        key = self.keys[index]
        own = {f"{key}_time", f"time_{key}", f"time_of_{key}", f"t_{key}", f"{key}_t"}
        named = [i for i, name in enumerate(self.keys) if name in own]
        before = [i for i in self.times if i < index]
        return next(iter(named or before[-1:] or self.times), None)

    def find(self, which: Which, key: str) -> list[int]:
        """Return the column with a name or number; of a table of steady responses, those of all levels.   key : of the
        mapping that names it."""
        at, path = f"{self.where}: {key}:", self.path
        if isinstance(which, int) and not 1 <= which <= len(self.channels):
            remedy = f"{path} has {len(self.channels)}: {self.overview}"
            raise RecordError(f"{at} there is no channel {which}; {remedy}")
        if isinstance(which, int):
            return [which - 1]
        names = [(raw.name, full_name(raw), raw.label or raw.name) for raw in self.channels]
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

    def spare(self, used: Collection[int]) -> list[int]:
        """Return the channels that are not used and may hold a motion or a force: no time, no temperature, no counter,
        nothing constant."""
        left = [i for i, raw in enumerate(self.channels) if i not in used and not holds_time(raw)]
        return [i for i in left if i not in self.samples.aside and not self.axes.get(i)]

    def named(self, i: int) -> Guess | None:
        """Return the guess that a heading gives, if its unit is not of another quantity."""
        raw, unit = self.channels[i], by_unit(self.channels[i])
        if i in self.axes:
            return Guess("acceleration", _BY_NAME)
        quantity = (whole := quantity_of(raw)) or quantity_of(raw, all_words=False)
        fits = quantity and (unit is None or DIMENSIONS[unit] == DIMENSIONS[quantity])
        return Guess(str(quantity), _BY_NAME, CERTAIN if whole else LIKELY) if fits else None

    @cached_property
    def certain(self) -> tuple[dict[int, Guess], str]:
        """The guesses that are certain, by their channels. And which two channels compete for a quantity, if any.

        A force is no response: where nothing that drives is named, the only other signal drives if it is in a unit of
        force. Where something drives and no response is named, the only signal left with a motion, by name or unit, is
        the response; so is the only signal of all, the record being a free decay.
        """
        names: dict[str, int] = {}
        for i, raw in enumerate(self.channels):
            quantity = None if holds_time(raw) or unusable(raw) else quantity_of(raw)
            if i in self.axes:
                quantity = None if self.axes[i] else "acceleration"
            if self.mapping.free and WORDS["base_displacement"] in self._words(i):
                quantity = None  # the other axis of a camera: no base moves in a free decay
            if quantity and (other := names.setdefault(quantity, i)) != i:
                self.require_one_coordinate([other, i])
                both = [shortened(self.channels[at].name) for at in (other, i)]
                return {}, f"takes both {' and '.join(both)} for {quantity}"
        certain = {i: Guess(quantity, _BY_NAME) for quantity, i in names.items()}
        answering, driving = (bool({*names} & {*of}) for of in (RESPONSES, EXCITATIONS))
        if answering and driving:
            return certain, ""
        kinds = {coordinate_of(self.channels[i]) for i in certain}
        others = self.spare(certain)
        left = [i for i in others if not kinds or coordinate_of(self.channels[i]) in kinds]
        if others and not left:
            self.require_one_coordinate([*certain, *others])
        units = {i: Guess(q, _BY_UNIT) for i in left if (q := by_unit(self.channels[i]))}
        forces = [i for i, guess in units.items() if guess.quantity == "force"]
        if not certain and len(left) == len(units) == 1 and not forces:
            return units, ""
        if not driving and len(forces) == 1 and len(left) == 2 - answering:
            certain[forces[0]] = units[forces[0]]
        may = {i: g for i in left if i not in forces and (g := self.named(i) or units.get(i))}
        answers = {i: guess for i, guess in may.items() if guess.quantity in RESPONSES}
        if (
            len(answers) == 1
            and not answering
            and (self.mapping.free or (certain and len(may) == 1))
        ):
            certain |= answers
        return certain, ""

    def require_one_coordinate(self, channels: Collection[int]) -> None:
        """Raise RecordError where some channels rotate and others move along a line."""
        coordinates = {self.channels[i].name: coordinate_of(self.channels[i]) for i in channels}
        require_one_coordinate(str(self.path), coordinates)

    @cached_property
    def draft(self) -> dict[int, Guess]:
        """The guess for each column but times: the surest of a quantity, or of an excitation, that no other is taken
        for."""
        of = {i: self._of(i) for i, raw in enumerate(self.channels) if not holds_time(raw)}
        if not self.stepped:
            self._prefer(of)
        taken: dict[int, Guess] = {}
        ranks = {i: (max(of[i][0].doubt, LIKELY), by_unit(self.channels[i]) is None) for i in of}
        for i in sorted(of, key=ranks.__getitem__):
            held = {guess.quantity for guess in taken.values()} - {""}
            slots, full = {*map(self._slot, held)}, self._complete(held)
            free = (guess for guess in of[i] if self._slot(guess.quantity) not in slots)
            drives = () if self.stepped else EXCITATIONS
            taken[i] = next(g for g in free if not full or g.doubt < UNSAID or g.quantity in drives)
        if len(only := [(i, g) for i, g in taken.items() if g.quantity]) == 1:
            ((i, guess),) = only
            if guess.doubt > LIKELY and guess.quantity in _RESPONSE_OF:
                taken[i] = Guess(_RESPONSE_OF[guess.quantity], "the only signal")
        return {i: taken[i] for i in of}

    def _prefer(self, of: dict[int, list[Guess]]) -> None:
        """Put first what is certain as no other column can be it; and where names call several alike and none a drive,
        take the first of them that is not the mass for it."""
        for i, guess in self.certain[0].items():
            if (
                guess.reason == _BY_UNIT
                and replace(guess, reason=_BY_NAME, doubt=LIKELY) != of[i][0]
            ):
                of[i].insert(0, guess)
        sure = {i: guesses[0].quantity for i, guesses in of.items() if guesses[0].doubt <= LIKELY}
        if {*sure.values()} & {*EXCITATIONS}:
            return
        for driving, quantity in _RESPONSE_OF.items():
            alike = [i for i, q in sure.items() if q == quantity]
            bare = [i for i in alike if not self._words(i) & {*WORDS["mass"].split()}]
            if len(alike) > 1 and bare:
                of[bare[0]] = [Guess(driving, _BY_NAME + _FIRST, LIKELY), of[bare[0]][-1]]

    def _of(self, i: int) -> list[Guess]:
        """Return the guesses for a column by itself, from the surest on; the last says why there is no other."""
        if self.stepped:
            return self._of_lines(i)
        raw, unit, named = self.channels[i], by_unit(self.channels[i]), self.named(i)
        if i in self.samples.aside or self.axes.get(i):
            moves = self._words(i) & _MOTIONS and unusable(raw)
            against = named and moves and named.quantity in RESPONSES
            found = [replace(named, doubt=AGAINST_ITS_UNIT)] if named and against else []
            return [*found, Guess("", self.samples.aside.get(i) or self.axes[i])]
        if raw.unit and unit is None and not find_other(raw.unit):
            return [Guess("", f"its unit, {shortened(raw.unit)}, is no unit of motion or force")]
        found, one = [named] if named else [], DIMENSIONS.get(unit or "")
        fitting = [q for q in (*EXCITATIONS, *ABSOLUTE) if DIMENSIONS[q] == one]
        reason, doubt = (_BY_UNIT, POSSIBLE) if fitting else (_BY_NOTHING, UNSAID)
        fitting = fitting or ["base_displacement", "displacement"]
        found += [Guess(q, reason + _FIRST * (q in EXCITATIONS), doubt) for q in fitting]
        if named and named.quantity in EXCITATIONS:  # which is no response
            found = [named]
        other = f"another channel is taken for {found[0].quantity}" if found else _BY_UNIT
        return [*found, Guess("", _BY_NOTHING if found and found[0].doubt == UNSAID else other)]

    @cached_property
    def per_force(self) -> bool:
        """Whether a table has a column of responses per force."""
        return bool({*map(column_of, self.channels)} & {*PER_FORCE})

    def _of_lines(self, i: int) -> list[Guess]:
        """Return the guesses for a column of a table of steady responses, from the surest on."""
        raw, named = self.channels[i], column_of(self.channels[i])
        unit = find_unit(raw.unit or "")
        fitting = [q for q in TABLE_DIMENSIONS if unit and TABLE_DIMENSIONS[q] == unit.dimension]
        found = [Guess(q, _BY_UNIT, POSSIBLE) for q in fitting]
        if named:
            found = [Guess(named, _BY_NAME)]
        elif i in self.samples.rising:
            found = [Guess("frequency", "rises in equal steps", POSSIBLE)]
        elif not raw.unit and i not in self.samples.aside:
            found = [Guess(q, _BY_NOTHING, UNSAID) for q in ("force", "displacement", "phase")]
        said = found and found[0].doubt < UNSAID
        other = f"another column is taken for {found[0].quantity}" if said else _BY_NOTHING
        if self.per_force:  # no base drives
            found = [guess for guess in found if not guess.quantity.startswith("base_")]
        return [*found, Guess("", other)]

    def _slot(self, quantity: str) -> str:
        """Return what a record, or a table, has one of: of all excitations one, of responses one in a table."""
        if quantity in _DRIVES:
            return "drive"
        return "response" if self.stepped and quantity in _RESPONSES else quantity

    def _complete(self, held: Collection[str]) -> bool:
        """Return whether a record, or a table, can be read with these quantities."""
        if not self.stepped:
            return bool({*held} & {*RESPONSES})
        needed = ["frequency", "response", "phase", *["drive"] * (not {*held} & {*PER_FORCE})]
        return {*needed} <= {*map(self._slot, held)}

    @property
    def complete(self) -> bool:
        """Whether the draft has a response, and all else that a table of steady responses needs."""
        return self._complete({guess.quantity for guess in self.draft.values()})

    def lines(self) -> list[str]:
        """Return the draft as a mapping in YAML, each line with its reason, and the columns left out."""
        chosen = {g.quantity: i for i, g in reversed(self.draft.items()) if g.quantity}
        driving = {*chosen} & {*EXCITATIONS}
        head = "channels:" if driving else "channels:  # a free decay, without an excitation"
        lines, times = ["table:" if self.stepped else head], self._times()
        order = TABLE_DIMENSIONS if self.stepped else QUANTITIES
        for quantity in filter(chosen.__contains__, order):
            i, reason = chosen[quantity], self.draft[chosen[quantity]].reason
            stated, remark = self._in_unit(i, quantity)
            name = quantity if self.stepped else coordinate_of(self.channels[i]).key(quantity)
            if (error := chosen.get(quantity + STANDARD_ERROR)) is not None:
                stated += f", standard_error: {self._which(error)}"
            relative = quantity in ABSOLUTE and driving - {"force"} and reason != _BY_NAME
            if relative and not self.stepped:
                remark = f"; relative_{name} if measured against the base{remark}"
            lines.append(f"  {name}: {{channel: {self._which(i)}{stated}}}  # {reason}{remark}")
        for key in _KEPT.split():
            if (value := getattr(self.mapping, key)) not in (None, ""):
                lines.append(f"{key}: {json.dumps(value, ensure_ascii=False)}")
        if not self.stepped:
            lines += self._time(times)
        elif self.per_force and not driving and not self.mapping.force_N:
            lines.append("force_N: 1.0  # the file has no force: replace by its amplitude")
        read = {self.keys[i] for i in chosen.values()} if self.stepped else set()  # of all levels
        aside = [
            f"# left aside: {self.names[i]}: {guess.reason}"
            for i, guess in self.draft.items()
            if not guess.quantity and i not in times and self.keys[i] not in read
        ]
        more = [f"# and {len(aside) - LISTED} more"] * (len(aside) > LISTED)
        return [*lines, *aside[:LISTED], *more]

    def _in_unit(self, i: int, quantity: str) -> tuple[str, str]:
        """Return the unit and scale of a column in the mapping, and a remark on them."""
        values, text = self.samples.values[i], unit_of(self.channels[i]) or ""
        unit, large = _UNITS.get(quantity, ""), values.size and 0.5 * np.ptp(values)
        own, dimension = find_motion(text), DIMENSIONS.get(quantity)
        if self.stepped:
            own, dimension = find_unit(text), TABLE_DIMENSIONS[quantity]
        if not unit:  # a level
            return "", ""
        if own and dimension in (own.dimension, own.counterpart):
            return f", unit: {own.name}", ""
        if text and quantity in PER_FORCE:
            return f", unit: {text}", ""
        if unit == "m" and (text or large > _IN_MM):
            unit = "mm"
        if text:
            remark = f"; recorded in {text}: replace 1.0 by the {unit} per {text}"
            return f", unit: {unit}, scale: 1.0", remark
        unit = "deg" if quantity == "phase" and large > _TURNS else unit
        return f", unit: {unit}", "; unit guessed, the file has none"

    def _times(self) -> list[int]:
        """Return the columns of times in the draft: by the mapping, name or unit, or as the only ones that rise."""
        if self.mapping.time is not None:
            which = self.mapping.time
            return [i for i, raw in enumerate(self.channels) if which in (i + 1, raw.name)]
        return self.times or self.samples.rising

    def _time(self, times: Sequence[int]) -> list[str]:
        """Return the line about times, if one is needed."""
        if self.mapping.sample_rate_hz is not None:
            return []
        if not times:
            stated = any(raw.rate_hz for raw in self.channels)
            line = "sample_rate_hz: 1000  # the file has no times: replace by the rate"
            return [] if stated else [line]
        first, line = times[0], f"time: {{channel: {self._which(times[0])}, unit: "
        known = find_unit(self.mapping.time_unit or unit_of(self.channels[first]) or "")
        if known is not None and known.dimension == "time":
            return [f"{line}{known.name}}}"] if len(times) == 1 else []
        values = self.samples.values[first]
        step = _equal_step(values[np.isfinite(values)])
        unit = next(unit for unit, least in _TIME_UNITS.items() if (step or 0.0) >= least)
        shows = f"rises by {step:.6g} from sample to sample; " if step else ""
        return [f"{line}{unit}}}  # {shows}unit guessed, the file has none"]

    def _which(self, i: int) -> str:
        """Return a column as a mapping names it: by its name, or by its number where that is long or not its alone."""
        name = self.channels[i].name
        if self.keys.count(self.keys[i]) > 1 and self.stepped:  # one column for each level
            name = of_level(name)
        elif self.keys.count(self.keys[i]) > 1 or len(name) > _LONGEST:
            return str(i + 1)
        plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _YAML_WORDS
        return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())

    def proposed(self, what: str) -> str:
        """Say `what` to write, with the draft, which is complete, and holds for these columns if the guesses do."""
        if not self.complete and self.stepped:
            return f"A table has a frequency, a drive, a response and a phase: name the column of each in {self.where}"
        if not self.complete:
            remedy = "give one that holds both, or name the file of each in"
            return f"A record has two signals at least: {remedy} {self.where}"
        here = "" if self.mapping.source else " (--write-mapping writes it)"
        return "\n  ".join([f"{what} in {self.where}{here}, for example", *self.lines()])

    def unclear(self, what: str) -> RecordError:
        """Return the error for columns that cannot be distinguished: what is missing, and the mapping to write."""
        needed = (
            f"it needs one of {', '.join(EXCITATIONS)}, unless it is a free decay (--kind ring-down), and at least one "
            f"of {', '.join(ABSOLUTE)} (relative_displacement, … if measured against the base). Its channels"
        )
        needed = "a table has one of each. Its columns" if self.stepped else needed
        shown = f"{self.overview}. {self.proposed('Say which is which')}"
        return RecordError(f"{self.path}: {what}; {needed} are {shown}")


def is_table_of_lines(file: Table, rules: RecordMapping) -> bool:
    """Return whether a file is a table of steady responses: by its mapping, or by columns of frequency and phase, and
    none of times."""
    if rules.table or rules.channels:
        return bool(rules.table)
    held = {column_of(raw) for raw in file.channels}
    return {"frequency", "phase"} <= held and not any(map(names_time, file.channels))


def suggested_mapping(file: Table, mapping: RecordMapping, stepped: bool | None = None) -> str:
    """Return a mapping in YAML for a table whose mapping, so far, names no channels: each line with its reason.

    stepped : whether it holds steady responses to a stepped sine; None to see it by its columns.

    Raises RecordError where the mapping names channels already, or the draft lacks a response, or another column.
    """
    if mapping.channels or mapping.table:
        raise RecordError(f"{mapping.source} names the channels of {file.path} already")
    guesses = Guesses(file, mapping, stepped=stepped)
    if not guesses.complete:
        raise guesses.unclear("finds too few columns" if guesses.stepped else "finds no response")
    return "\n".join([*guesses.lines(), ""])
