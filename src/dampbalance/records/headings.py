"""What the heading and the unit of a channel say about what it holds.

A heading is read word by word: "Weg Tisch", "table displacement", "BaseDisp" and "base_displacement" all stand for the
displacement of the base. If it names a body but no quantity, "Base [g]", the unit tells the quantity.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterator
from dataclasses import replace
from itertools import pairwise

from .channel import ABSOLUTE, EXCITATIONS
from .mapping import RecordMapping
from .table import RawChannel, Table
from .units import (
    DIMENSIONS,
    PER_FORCE,
    TABLE_DIMENSIONS,
    VOLTAGE,
    find_motion,
    find_other,
    find_unit,
    per_force,
)
from .vocabulary import WORDS

STANDARD_ERROR = "_standard_error"
"""End of the name of a column that holds the standard error of a quantity."""

AXES = {"x", "y", "z"}
"""Letters that are directions if they stand next to another word, or have a unit other than that of a displacement."""

_BODIES, _OTHERS = WORDS["bodies"], WORDS["others"]
_MEANINGS = {
    word: meaning
    for meanings in (WORDS["quantities"], _BODIES)
    for meaning, words in meanings.items()
    for word in words
}
_HINTS = dict.fromkeys(_OTHERS["force"], "force")
_OF_ERRORS = {*_OTHERS["standard_error"]}
# fewest letters of a part of a compound (one in Chinese or Japanese), and most of a compound
_SHORTEST, _LONGEST = 3, 60
_SIGNS = "\u3040-\u30ff\u4e00-\u9fff"  # kana, and Chinese characters
_TIME = re.compile(
    r"((elapsed|relative|rel|running|test|record|recording|measurement|date|abs|absolute|sample)_?)?"
    r"(time|zeit|t|messzeit|zeitstempel|uhrzeit|timestamps?|(row)?times|temps|時間|時刻|时间)"
    r"(_?(stamps?|axis|value|achse|\d+))?"
)
_COUNTED_IN = {  # unit of times → names that imply it, as LabVIEW, oscilloscopes and microcontrollers write them
    "s": re.compile(r"x_values?|(elapsed_)?seconds?(_elapsed)?|sekunden?"),
    "ms": re.compile(r"millis|milliseconds?"),
    "µs": re.compile(r"micros|microseconds?"),
}
_NAMED_TIME = re.compile(r"x_axis|date_?times?(_?\d+)?")


# before the names of a run, as programs of schools write it
_RUN = re.compile(
    r"(?i)^\s*(?:latest|(?:data ?set|run|trial|series|lauf|messung|versuch)\W?\d*)\s*:\s*"
)


def last_part(name: str) -> str:
    """Return the last part of a path of groups or structures; a slash in brackets, x [m/s], and the point of an
    abbreviation, rel. to table, separate nothing."""
    name = _RUN.sub("", name.strip())
    return re.split(r"(?:/|\.(?!\s))(?=[^/.])(?![^\[(]*[\])])", name)[-1].strip()


def axis_of(name: str) -> Iterator[tuple[str, str, str]]:
    """Yield each letter of a heading that may be an axis, x, y or z, with the text before and after it."""
    name = name.lower()
    for axis in re.finditer("[xyz]", name):
        yield axis[0], name[: axis.start()], name[axis.end() :]


def without_number(name: str) -> str:
    """Return a name without the number of a column of a matrix: force for force[2]."""
    return re.sub(r"\[\d+\]$", "", name)


def of_level(name: str) -> str:
    """Return the name that the columns of all levels share: force for one.force[2]."""
    return without_number(last_part(name))


def key_of(name: str) -> str:
    """Return the last part of a path in lower case, its words separated by "_"."""
    return re.sub(r"[\s\-]+", "_", last_part(name).lower())


def names_time(raw: RawChannel) -> bool:
    """Return whether a channel holds times by its name, its unit not contradicting, or holds points in time."""
    key, unit = key_of(raw.name), find_unit(raw.unit or "")
    other = find_other(raw.unit or "") or (unit and unit.dimension != "time")
    return raw.stamps or (
        not other and any(p.fullmatch(key) for p in (_TIME, _NAMED_TIME, *_COUNTED_IN.values()))
    )


def holds_time(raw: RawChannel) -> bool:
    """Return whether a channel holds times, by its name or unit."""
    unit = find_unit(raw.unit or "")
    return names_time(raw) or bool(unit and unit.dimension == "time")


def full_name(raw: RawChannel) -> str:
    """Return name and unit of a channel, x [mm]."""
    return f"{raw.name} [{raw.unit}]" if raw.unit else raw.name


def unit_of(raw: RawChannel, *, table: bool = False) -> str | None:
    """Return the unit of a channel as the file spells it or its name implies it; None if there is none.

    table : whether it is a column of a table of steady responses, in which ω is a frequency in rad/s.
    """
    key, omega = key_of(raw.name), table and {*words_of(raw.name)} & {"omega", "ω"}
    implied = "rad/s" if omega else None
    return raw.unit or next((s for s, of in _COUNTED_IN.items() if of.fullmatch(key)), implied)


def has_word(text: str) -> bool:
    """Return whether a text has a Chinese or Japanese word of a heading, of at least two signs."""
    words = {*_MEANINGS, "時間", "時刻", "时间"}
    return any(word in text for word in words if re.match(f"[{_SIGNS}]{{2}}", word))


def unusable(raw: RawChannel) -> str | None:
    """Return what a channel is instead of a motion or a force, by its name or unit; None if they do not tell."""
    if {*_OTHERS["temperature"]} & {*words_of(raw.name)}:
        return "a temperature"
    other = find_other(raw.unit or "")
    return None if other == VOLTAGE else other


def quantity_of(
    raw: RawChannel, *, all_words: bool = True, among: Container[str] = DIMENSIONS
) -> str | None:
    """Return the quantity that the heading of a channel names; None if it names none or several.

    all_words : whether every word must be known. Otherwise unknown words and single letters, which may be directions,
    are ignored; base and mass together give a relative motion, and a body alone a displacement.
    among : the quantities to look for.
    """
    words, meanings = words_of(raw.name), _MEANINGS if all_words else _HINTS | _MEANINGS
    if {*words} & {*_OTHERS["normal_force"]} and by_unit(raw) == "force":
        return "normal_force"
    if {*words} & _OF_ERRORS:
        others = [word for word in words if word not in _OF_ERRORS]
        if quantity_of(replace(raw, name=" ".join(others))) == "force":
            return f"force{STANDARD_ERROR}"
    words = [
        word for word in words if word not in _OTHERS["ignored"] and not word.isdigit()
    ] or words
    words = [word for word in words if not _contradicts(word, raw)]
    rest = [word for word in words if word not in AXES]  # an axis next to a quantity
    words = rest if {meanings.get(word) for word in rest} & DIMENSIONS.keys() else words
    words = ["" if word == "in" else word for word in words[:-1]] + words[-1:]  # a preposition
    if not (all_words or len(words) == 1):
        # no letter of a direction
        words = [w for w in words if w in meanings and not re.fullmatch(f"[^{_SIGNS}]", w)]
    roles = {meanings.get(word, "") for word in words}
    bodies, quantities = roles & {*_BODIES}, roles - {*_BODIES}
    if not all_words and len(bodies) > 1:
        bodies = {"relative"}
    if len(bodies) > 1 or len(quantities) > 1 or not roles or "" in roles:
        return None
    body, quantity = "".join(bodies), "".join(quantities) or by_unit(raw)
    if quantity is None and (body == "base" or not all_words):
        quantity = "displacement"
    if body == "base" and quantity in ("force", "base_displacement"):
        return quantity
    named = quantity if body in ("", "mass") else f"{body}_{quantity}"
    return named if named in among and (body, named) != ("mass", "force") else None


def _contradicts(letter: str, raw: RawChannel) -> bool:
    """Return whether a single letter cannot be a quantity because of the unit, as x in Table X [g], a direction."""
    unit, meant = find_motion(raw.unit or ""), DIMENSIONS.get(_MEANINGS.get(letter, ""))
    return bool(len(letter) == 1 and unit and meant and unit.counterpart != meant)


def column_of(raw: RawChannel) -> str | None:
    """Return the quantity of a column of a table of steady responses, by heading and unit, with `STANDARD_ERROR` at its
    end for a column of standard errors; None if they do not tell."""
    words = [word for word in words_of(raw.name) if not word.isdigit()]
    ending = STANDARD_ERROR if {*words} & _OF_ERRORS else ""
    unit = find_unit(raw.unit or "")
    for quantity, known in WORDS["tables"].items():
        fits = not unit or quantity in PER_FORCE or unit.dimension == TABLE_DIMENSIONS[quantity]
        if fits and {*known} & {*words}:
            return quantity + ending
    words = [w for w in words if w not in _OTHERS["amplitude"] and w not in _OF_ERRORS]
    words = [w for w in words if len(w) > 1 or w in _MEANINGS]  # F [N], A [g]
    if unit and unit.dimension == TABLE_DIMENSIONS["phase"]:
        return None if words else f"phase{ending}"
    named = replace(raw, name=" ".join(words))
    amplitude = quantity_of(named, among=TABLE_DIMENSIONS) if words else per_force(raw.unit or "")
    amplitude = amplitude or (None if words else by_unit(raw))
    return amplitude and amplitude + ending


def is_stepped_sine(file: Table, rules: RecordMapping) -> bool:
    """Return whether a file is a table of steady responses, by its mapping, or because it has columns of frequency and
    phase but no times."""
    if rules.table or rules.channels:
        return bool(rules.table)
    held = {column_of(raw) for raw in file.channels}
    return {"frequency", "phase"} <= held and not any(map(names_time, file.channels))


def by_unit(raw: RawChannel) -> str | None:
    """Return the first quantity with the unit of a channel, an angle counting as a displacement; None if it has no unit
    of a motion or a force."""
    unit = find_motion(raw.unit or "")
    fitting = (*ABSOLUTE, *EXCITATIONS)
    return next((q for q in fitting if unit and DIMENSIONS[q] == unit.counterpart), None)


def words_of(name: str) -> list[str]:
    """Return the words of a heading in lower case, with compounds split: relativ and weg for Relativweg."""
    name = unicodedata.normalize("NFC", last_part(name))
    signs = rf"(?<=[{_SIGNS}])(?=[A-Za-z])|(?<=[A-Za-z])(?=[{_SIGNS}])|(?<=[{_SIGNS}])[の的](?=[{_SIGNS}])"
    spaced = re.sub(rf"(?<=[a-zß-ÿ])(?=[A-Z])|(?<=\D)(?=\d)|(?<=\d)(?=\D)|{signs}", " ", name)
    spaced = spaced.lower().replace("_", " ").replace("fusspunkt", "fußpunkt")
    return [part for word in re.findall(r"\w+", spaced) for part in _parts(word)]


def _parts(word: str) -> list[str]:
    """Return the words of a compound; the word itself if it is none."""
    least = 1 if re.match(f"[{_SIGNS}]", word) else _SHORTEST
    if word in _MEANINGS or len(word) > _LONGEST:
        return [word]
    for i in range(least, len(word) - least + 1):
        if word[:i] in _MEANINGS and (rest := _parts(word[i:])) and {*rest} <= _MEANINGS.keys():
            return [word[:i], *rest]
    return [word]


def runs_of(file: Table) -> list[Table]:
    """Return a table for each run in a file, if there are several side by side: blocks of columns with the same names,
    times first."""
    held = [i for i, raw in enumerate(file.channels) if raw.label]  # an empty column has no name
    times = [n for n, i in enumerate(held) if names_time(file.channels[i])]
    blocks = [held[a:b] for a, b in pairwise([*times, len(held)])]
    names = [
        [(key_of(raw.name), raw.unit) for raw in map(file.channels.__getitem__, of)]
        for of in blocks
    ]
    if len(blocks) < 2 or times[0] or len(names[0]) < 2 or any(of != names[0] for of in names):
        return [file]
    return [file.part(block) for block in blocks]
