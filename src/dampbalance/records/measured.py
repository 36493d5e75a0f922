"""Records from files of any format, tables of pandas or arrays, as an identification takes them."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ..arguments import items, path
from ..findings.finding import Finding
from ..project.files import sha256
from ..project.wording import visible
from .coordinate import ROTATION, TRANSLATION
from .errors import RecordError, RecordWarning
from .headings import runs_of
from .mapping import MappingLike, RecordMapping, mapping_file, mapping_for, parts_of
from .readers import opened, table
from .readers.formats import SUFFIXES
from .readers.text import NoRows
from .recognise import recognise
from .record import Record
from .table import Table, is_table, signals_file

if TYPE_CHECKING:
    from .table import Signals

    RecordLike: TypeAlias = "str | Path | Signals | Table | Record"


ReaderOfTables: TypeAlias = Callable[[Table, RecordMapping, str], Record | None]
"""Reader of the record in an open table, given its mapping and the label of a level without a name."""


def as_records(
    records: RecordLike | Sequence[RecordLike],
    *,
    mapping: MappingLike = None,
    kind: str = "",
    reader: ReaderOfTables | None = None,
) -> tuple[Record, ...]:
    """Return records as `dampbalance.read_records` does, with the same arguments and:

    kind : of the records; "" if unknown.
    reader : returns the record of an open table if it is of the kind of this reader, otherwise None; tried before
    channels are looked for.
    """
    single = isinstance(records, str | Path | Record) or is_table(records)
    wanted = "the path of a file, a pandas DataFrame, a mapping of names to arrays, or a sequence of them"
    several = [records] if single else items("records", records, wanted)
    made: list[Record] = []
    for number, one in enumerate(files_of(several, mapping), start=1):
        taken = {record.name for record in made}
        if isinstance(one, str | Path):
            file = path("each record", one, "a file")
            rules = replace(mapping_for(file, mapping), kind=kind)
            read = _read(str(file), file.name, opened(file, rules), rules, reader)
            files = _digests(file, rules, mapping)
            runs = [{"run": n} if len(read) > 1 else {} for n in range(1, len(read) + 1)]
            made += [replace(of, files=files | run) for of, run in zip(read, runs, strict=True)]
        elif not isinstance(one, Record) or (one.files is None and one.rules == RecordMapping()):
            made += _in_memory(one, number, taken, mapping, kind, reader)
        else:
            made.append(one)
    return tuple(made)


def files_of(records: Iterable[Any], mapping: MappingLike = None) -> Iterator[Any]:
    """Yield records, with folders and patterns replaced by their files.

    Of a folder these are the files with a suffix of `FORMATS`, in the order of the numbers in their names, except those
    that hold channels of another record and texts without numbers, such as notes.txt next to files of another suffix. A
    pattern, level*.csv, is expanded if no shell has done so.

    Raises RecordError for a folder without such files.
    """
    for one in _expanded(records):
        if not isinstance(one, str | Path) or not Path(one).is_dir():
            yield one
            continue
        files = [of for of in Path(one).iterdir() if of.is_file() and of.suffix.lower() in SUFFIXES]
        if not files:
            raise RecordError(f"{one}: holds no records, whose files end in {', '.join(SUFFIXES)}")
        files.sort(key=_numbered)
        parts = {of: {*parts_of(of, mapping_for(of, mapping))} - {of} for of in files}
        files = [of for of in files if not any(of in others for others in parts.values())]
        texts = [of for of in files if of.suffix.lower() == ".txt"]
        notes = [of for of in texts if texts != files and _is_of_words(of, mapping)]
        yield from (of for of in files if of not in notes)


def _expanded(records: Iterable[Any]) -> Iterator[Any]:
    """Yield records, and for a pattern its files, in the order of the numbers in their names."""
    for one in records:
        pattern = isinstance(one, str | Path) and "*" in str(one) and not Path(one).exists()
        yield from (sorted(glob(str(one)), key=_numbered) if pattern else ()) or [one]


def _numbered(file: str | Path) -> list[str]:
    """Return the name of a file with its numbers padded, to sort by."""
    return [part.zfill(9) for part in re.split(r"(\d+)", Path(file).name)]


def _is_of_words(file: Path, mapping: MappingLike) -> bool:
    """Return whether a text holds no rows of numbers."""
    try:
        table(file, mapping_for(file, mapping))
    except RecordError as error:
        return isinstance(error, NoRows)
    return False


def _in_memory(
    signals: Signals | Table | Record,
    number: int,
    taken: set[str],
    mapping: MappingLike,
    kind: str,
    reader: ReaderOfTables | None,
) -> tuple[Record, ...]:
    """Return the records in signals in memory, the `number`-th of several, under a name that is not `taken`."""
    if not isinstance(signals, Record) and not is_table(signals):
        remedy = "give the path of a file, a pandas DataFrame, or a mapping of names to arrays"
        raise RecordError(f"record {number} is a {type(signals).__name__}; {remedy}")
    stated = getattr(signals, "attrs", {}).get("name") or getattr(signals, "name", None)
    stated = signals.path if isinstance(signals, Table) else stated
    own = visible(str(stated or f"record {number}"))
    names = itertools.chain([own], (f"{own} ({count})" for count in itertools.count(2)))
    name = next(name for name in names if name not in taken)
    rules = RecordMapping("mapping") if mapping is None else mapping_for("", mapping)
    rules = replace(rules, kind=kind)
    if isinstance(signals, Record):
        return (replace(signals, name=name, label=visible(rules.level or name), rules=rules),)
    return _read(name, name, [(signals_file(name, signals), rules)], rules, reader)


def _read(
    name: str,
    label: str,
    parts: Iterable[tuple[Table, RecordMapping]],
    rules: RecordMapping,
    reader: ReaderOfTables | None,
) -> tuple[Record, ...]:
    """Return the record in open tables, each with its part of the mapping; if a table holds several runs side by side,
    one for each."""
    (file, of), *others = parts
    label = visible(rules.level or label)
    runs = [file] if others or rules.channels or rules.table else runs_of(file)
    read: list[Record] = []
    for n, run in enumerate(runs, start=1):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", RecordWarning)
            if reader is not None and (of_its_kind := reader(run, of, label)) is not None:
                return (of_its_kind,)
            record = recognise(run, of, *others)
        said = [w.message.finding for w in caught if isinstance(w.message, RecordWarning)]
        warned = [one for i, one in enumerate(said) if one not in said[:i]]
        record = replace(record, name=name, label=label, rules=rules, warnings=tuple(warned))
        if len(runs) > 1:
            several = Finding("several runs", {"runs": len(runs)})
            record = replace(record, label=f"{label} (run {n})", warnings=(*warned, several))
            record = replace(record, name=f"{name} (run {n})")
        read.append(record)
    return tuple(read)


def _digests(path: Path, rules: RecordMapping, mapping: MappingLike) -> dict[str, Any]:
    """Return digests of a file, of its mapping, and of other files that hold channels of the record."""
    file = mapping_file(path, mapping)
    others = [part for part in parts_of(path, rules) if part != path]
    more = [{"file": str(part), "sha256": sha256(part)} for part in others]
    return ({"others": more} if more else {}) | {
        "sha256": sha256(path),
        "mapping": None if file is None else {"file": str(file), "sha256": sha256(file)},
    }


def require_different(records: Sequence[Record]) -> None:
    """Raise ValueError if there are no records, if they have different coordinates, or if a file is named twice, even
    by a link or another spelling of its path."""
    if not records:
        raise ValueError("no records are given; give one for each level, or one of a free decay")
    first = {record.coordinate: record.name for record in reversed(records)}
    if len(first) > 1:
        rotating, other = first[ROTATION], first[TRANSLATION]
        raise RecordError(
            f"{rotating} rotates and {other} moves along a line: identify them separately"
        )
    known: dict[tuple[object, ...], str] = {}
    for record in records:
        if record.files is None:
            continue
        held = record.files["sha256"], record.files.get("run")
        other = known.setdefault(held, record.name)
        if other is not record.name:
            twice = f"{other} is named twice"
            named = twice if other == record.name else f"{other} and {record.name} are one file"
            raise ValueError(f"{visible(named)}: each record is one level")
