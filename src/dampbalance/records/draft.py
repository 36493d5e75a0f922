"""The guesses about a file as a mapping in YAML, each line with its reason and a blank where nothing tells what to
write: what `--write-mapping` writes and a refusal shows."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator

import numpy as np

from ..project.wording import listed
from .channel import ABSOLUTE, EXCITATIONS, QUANTITIES
from .errors import RecordError
from .guess import ANGLE, LISTED, RESPONSE, UNNAMED, Guesses
from .headings import STANDARD_ERROR, of_level, unit_of
from .mapping import BLANK
from .stepped_tables import is_response
from .units import DIMENSIONS, PER_FORCE, TABLE_DIMENSIONS, find_motion, find_other, find_unit
from .untimed import is_loop, of_speeds

# words that YAML takes for others
_YAML_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
_KEPT = "delimiter decimal header_lines sample_rate_hz frequency_hz level notes force_N"
"""Keys of a mapping that stay in the one suggested."""


def unclear(of: Guesses, what: str) -> RecordError:
    """Return the error for a file that something must be said of: what it is, and the mapping to write."""
    if of.stepped:
        what = f"{RESPONSE} ({what})" if is_response(of) else what
        what += f"; a table has a frequency, a drive, a response and a phase. Its columns are {of.overview}."
    shown = [] if what.startswith(RESPONSE) else [*draft(of)]
    here = "" if of.mapping.source else " (--write-mapping writes it)"
    if shown:
        what = "\n  ".join([f"{what} Say it in {of.where}{here}, for example", *shown])
    return RecordError(f"{of.path}: {what}")


def draft(of: Guesses) -> Iterator[str]:
    """Yield the lines of the mapping, and the columns left out; nothing where no column may be of use."""
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
        yield from _time(of, loop or of_speeds(of, may_be))
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
    """Return the unit and scale of a column in the mapping, and a remark on them."""
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
    """Yield the line about times, if one is needed."""
    known = untimed or of.mapping.sample_rate_hz or any(c.rate_hz for c in of.channels)
    if not of.times and not known:
        yield f'sample_rate_hz: "{BLANK}"  # samples per second: the file has no times'
    if of.mapping.sample_rate_hz is None and len(of.times) == 1:
        unit = find_unit(of.unit_of_time(of.times[0]) or "")
        stated = unit.name if unit and unit.dimension == "time" else f'"{BLANK}"'
        yield f"time: {{channel: {_which(of, of.times[0])}, unit: {stated}}}"


def _which(of: Guesses, i: int) -> str:
    """Return a column as a mapping names it: by its name, or by its number where that is long or not its alone."""
    name, alone = of.channels[i].name, of.keys.count(of.keys[i]) == 1
    if not alone and of.stepped:  # one column for each level
        name = of_level(name)
    elif not alone or len(name) > 60:  # a longer name is none
        return str(i + 1)
    plain = re.fullmatch(r"[A-Za-z]\w*( \w+)*", name) and name.lower() not in _YAML_WORDS
    return name if plain else json.dumps(name, ensure_ascii=not name.isprintable())
