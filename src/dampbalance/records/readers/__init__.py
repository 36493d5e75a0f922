"""Readers of the formats of records, into a `Record` in SI units.

record = read("level1.mat")                         # with a mapping next to it, or names and units in the file
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from ... import arguments
from ..channel import QUANTITIES
from ..draft import draft, unclear
from ..errors import RecordError
from ..guess import Guesses
from ..mapping import MappingLike, RecordMapping, mapping_for, parts_of
from ..recognise import picks_of, recognise
from ..record import Record
from ..table import Table, intact
from .formats import FORMATS, checked_format
from .text import text_file

__all__ = ["FORMATS", "mapping_to_start_from", "opened", "quantities_of", "read", "table"]


def read(path: str | Path, mapping: MappingLike = None) -> Record:
    """Return the record in a file, in SI units.

    path : its suffix names the format, and its content must agree.   mapping : what the file does not say.

    Raises RecordError naming the file, what is wrong with it, and the remedy; warns of what looks odd (RecordWarning).
    """
    first, *others = opened(*_named(path, mapping))
    return recognise(*first, *others)


def opened(path: Path, rules: RecordMapping) -> Iterator[tuple[Table, RecordMapping]]:
    """Yield the table of each file of a record, with its part of the mapping. Raises RecordError as `read`."""
    for file, of in parts_of(path, rules).items():
        yield table(file, of), of


def quantities_of(path: str | Path, mapping: MappingLike = None) -> tuple[str, ...]:
    """Return the quantities of the channels of a file by names, units and mapping. Raises RecordError as `read`."""
    picks = [pick for part in opened(*_named(path, mapping)) for pick in picks_of(*part)]
    picked = {pick.quantity for pick in picks}
    return tuple(q for q in QUANTITIES if q in picked)


def table(path: str | Path, mapping: MappingLike = None) -> Table:
    """Return the table of a file: names, units and rates of its channels, and their samples as recorded, loaded on
    demand. Raises RecordError as `read`."""
    path, rules = _named(path, mapping)
    kind = checked_format(path)
    with intact(path, kind.title):
        file = text_file(path, rules) if kind.read is text_file else kind.read(path)
    return replace(file, what=kind.title)


def mapping_to_start_from(
    path: str | Path, mapping: MappingLike = None, stepped: bool | None = None
) -> str:
    """Return a draft of a mapping, in YAML, that names the channels of a file as far as headings, units and samples
    show them.

    Comments give the reason for each line, and for leaving out other channels; "?" stands for what the file does not
    state. Write it next to the record, fill it in, and correct it.

    mapping : what is known already, such as delimiter or sampling rate.
    stepped : whether the file is a table of steady responses to a stepped sine; None if its columns decide.

    Raises RecordError if the mapping names channels already, or if no column can be a motion or a force.
    """
    path, rules = _named(path, mapping)
    if rules.channels or rules.table:
        raise RecordError(f"{rules.source} names the channels of {path} already")
    guesses = Guesses(table(path, rules), rules, stepped=stepped)
    if not (lines := [*draft(guesses)]):
        raise unclear(guesses, "finds no column that may be a motion or a force.")
    return "\n".join([*lines, ""])


def _named(path: str | Path, mapping: MappingLike) -> tuple[Path, RecordMapping]:
    file = arguments.path("path", path, "the path of a record")
    return file, mapping_for(file, mapping)
