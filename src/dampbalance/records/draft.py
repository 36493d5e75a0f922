"""What is asked about a file, and the guesses about it as a mapping in YAML: each line has a reason, and a blank stands
for what the file does not state. A refusal shows both; `--write-mapping` writes the mapping."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator

import numpy as np

from ..project.spelling import spelled
from ..project.wording import listed
from . import samples
from .channel import ABSOLUTE, EXCITATIONS, QUANTITIES, RESPONSES, is_loop
from .errors import RecordError
from .guess import ANGLE, LEVELS, LISTED, UNNAMED, Guesses
from .headings import STANDARD_ERROR, by_unit, column_of, names_time, of_level, unit_of
from .mapping import BLANK
from .units import (
    DIMENSIONS,
    PER_FORCE,
    TABLE_DIMENSIONS,
    TABLE_DRIVES,
    find_motion,
    find_other,
    find_unit,
)

# words that YAML takes for others
_YAML_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
_KEPT = "delimiter decimal header_lines sample_rate_hz frequency_hz level notes force_N"
"""Keys that a draft takes over from the mapping that there is."""

_RESPONSE = (
    "this is a frequency response, one level of a stepped sine: state the amplitude of its force, force_N, in a "
    "mapping for each level, or give the records in time"
)
_HALF_TURN = 181.0  # deg, up to which a phase goes


def question(of: Guesses) -> str:
    """Return what must be answered first before a file can be read; "" where nothing is open."""
    held = {g.quantity: i for i, g in of.all.items() if g.quantity}
    asked = [i for i, g in of.all.items() if g.may]
    if _is_response(of):
        return _RESPONSE
    if not held.keys() & {*RESPONSES} and not asked:
        return (
            f"finds no response: name one of {', '.join(ABSOLUTE)}; its columns are {of.overview}."
        )
    if asked:
        may = listed([*dict.fromkeys(q for i in asked for q in of.all[i].may)], "or")
        why = dict.fromkeys(of.all[i].reason for i in asked if of.all[i].reason not in LEVELS)
        because = f" ({'; '.join(why)})" if why else ""
        names = listed([of.names[i] for i in asked[:LISTED]])
        verb = "do the columns" if len(asked) > 1 else "does the column"
        free = f" If it is a free decay, give {spelled('kind', 'ring-down')}."
        return f"what {verb} {names} hold: {may}{because}?" + free * ("base_" in may)
    if unknown := [of.names[i] for i in held.values() if not of.all[i].unit]:
        return f"in which unit{'s are' if len(unknown) > 1 else ' is'} {listed(unknown)}?"
    unknown = [of.names[i] for i in held.values() if math.isnan(of.channels[i].scale)]
    return f"what is the scale of {listed(unknown)}?" if unknown else ""


def _is_response(of: Guesses) -> bool:
    """Return whether the columns are a frequency response: frequencies and phases, but no times and no drive."""
    named = [column_of(raw) for raw in of.channels]
    driven = TABLE_DRIVES.keys() & {*named} or "force" in map(by_unit, of.channels)
    if driven or of.mapping.force_N or any(map(names_time, of.channels)):
        return False
    frequency = phase = False
    for i, values in of.values.items():
        values = values[np.isfinite(values)]
        even = samples.equal_step(values) is not None
        if even or not of.per_force:  # or else a stepped sine at a force to be stated
            rises = even and of.channels[i].unit is None and len(named) > 2
            # a frequency response goes up to 1 kHz or more
            frequency |= named[i] == "frequency" or (rises and bool(values[-1] >= 1000.0))
        turns = values.size and np.abs(values).max() <= _HALF_TURN
        turns = turns and np.ptp(values) > 0.5 * _HALF_TURN and not even
        phase |= named[i] == "phase" or bool(turns)
    return frequency and phase


def unclear(of: Guesses, what: str) -> RecordError:
    """Return the error for a file that leaves something open: what that is, and the mapping to write."""
    response = _is_response(of)
    if of.stepped:
        what = f"{_RESPONSE} ({what})" if response else what
        what += f". Its columns are {of.overview}."
    shown = [] if response else [*draft(of)]
    here = "" if of.mapping.source else " (--write-mapping writes it)"
    if shown:
        what = "\n  ".join([f"{what} Say it in {of.where}{here}, for example", *shown])
    return RecordError(f"{of.path}: {what}")


def draft(of: Guesses) -> Iterator[str]:
    """Yield the lines of the mapping and comments on the columns left out; nothing if no column can be used."""
    chosen = {g.quantity: i for i, g in reversed(of.all.items()) if g.quantity}
    driving, asked = {*chosen} & {*EXCITATIONS}, [i for i, g in of.all.items() if g.may]
    if not (chosen or asked):
        return
    free = "" if driving or asked else "  # a free decay, without an excitation"
    yield "table:" if of.stepped else f"channels:{free}"
    for quantity in filter(chosen.__contains__, TABLE_DIMENSIONS if of.stepped else QUANTITIES):
        i = chosen[quantity]
        name = quantity if of.stepped else of.coordinate(i).key(quantity)
        stated, remark = _in_unit(of, i, quantity)
        error = chosen.get(quantity + STANDARD_ERROR)
        if of.stepped and error is not None:
            stated += f", standard_error: {_which(of, error)}"
        if quantity in ABSOLUTE and driving - {"force"} and of.all[i].reason in UNNAMED:
            remark = f"; relative_{name} if measured against the base{remark}"
        yield f"  {name}: {{channel: {_which(of, i)}{stated}}}  # {of.all[i].reason}{remark}"
    for i in asked:
        which, may = _which(of, i), of.all[i].may
        unit = find_motion(unit_of(of.channels[i]) or "")
        fits = (q for q in may if unit and not of.stepped and DIMENSIONS[q] == unit.counterpart)
        stated, remark = _in_unit(of, i, next(fits, may[0]))
        key = json.dumps(f"what is {which.strip(chr(34))}{BLANK}", ensure_ascii=False)
        words = f"{listed(may, 'or')}, or leave the line out; {of.all[i].reason}{remark}"
        yield f"  {key}: {{channel: {which}{stated}}}  # {words}"
    for key in _KEPT.split():
        if (value := getattr(of.mapping, key)) not in (None, ""):
            yield f"{key}: {json.dumps(value, ensure_ascii=False)}"
    if not of.stepped:
        may_be = {q: i for i, g in of.all.items() for q in (g.quantity, *g.may) if q}
        loop = is_loop(may_be) and not of.mapping.free
        yield from _time(of, loop or of.are_steady_speeds(may_be))
    elif of.per_force and not driving and not of.mapping.force_N:
        yield f'force_N: "{BLANK}"  # the amplitude of the force: the file has none'
    read = {of.keys[i] for i in chosen.values()} if of.stepped else set()  # of all levels
    aside = [
        f"# left aside: {of.names[i]}: {guess.reason}"
        for i, guess in of.all.items()
        if not (guess.quantity or guess.may or i in of.empty) and of.keys[i] not in read
    ]
    yield from aside[:LISTED]
    if len(aside) > LISTED:
        yield f"# and {len(aside) - LISTED} more"


def _in_unit(of: Guesses, i: int, quantity: str) -> tuple[str, str]:
    """Return unit and scale of a column as keys of the mapping, and a remark on them."""
    raw = of.channels[i]
    text = of.all[i].unit or unit_of(raw, table=of.stepped) or ""
    own, dimension = find_motion(text), DIMENSIONS.get(quantity)
    size = np.format_float_positional(raw.scale, 12, fractional=False, trim="0")
    size = f'"{BLANK}"' if math.isnan(raw.scale) else size
    scale, remark = f", scale: {size}" * (raw.scale != 1.0), f"; {raw.described}".rstrip("; ")
    if of.stepped:
        own, dimension = find_unit(text), TABLE_DIMENSIONS[quantity]
    if not dimension:  # a level
        return "", ""
    if own and dimension in (own.dimension, own.counterpart):
        unsaid = "; the file has no unit" * (of.all[i].said is not None)
        return f", unit: {own.name}{scale}", remark + unsaid
    if text and quantity in PER_FORCE:
        return f", unit: {text}", ""
    if find_other(text):
        what = f"; recorded in {text}: state a unit, and how much of it 1 {text} is"
        return f', unit: "{BLANK}", scale: "{BLANK}"', what
    if quantity == "phase" and not text and (values := of.values[i]).size:
        unit = "rad" if np.nanmax(np.abs(values)) <= ANGLE else "deg"
        return f", unit: {unit}", "; by its size, the file has no unit"
    remark += f"; recorded in {text}" if text else "; the file has no unit"
    return f', unit: "{BLANK}"{scale}', remark


def _time(of: Guesses, untimed: bool) -> Iterator[str]:
    """Yield the line on times, if one is needed."""
    known = untimed or of.mapping.sample_rate_hz or any(c.rate_hz for c in of.channels)
    if not of.times and not known:
        yield f'sample_rate_hz: "{BLANK}"  # samples per second: the file has no times'
    if of.mapping.sample_rate_hz is None and len(of.times) == 1:
        unit = find_unit(of.unit_of_time(of.times[0]) or "")
        stated = unit.name if unit and unit.dimension == "time" else f'"{BLANK}"'
        yield f"time: {{channel: {_which(of, of.times[0])}, unit: {stated}}}"


def _which(of: Guesses, i: int) -> str:
    """Return a column as a mapping names it: by its name, or by its number if the name is long or not unique."""
    name, alone = of.channels[i].name, of.keys.count(of.keys[i]) == 1
    if not alone and of.stepped:  # one column for each level
        name = of_level(name)
    elif not alone or len(name) > 60:  # a longer name is none
        return str(i + 1)
    plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _YAML_WORDS
    return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())
